//! Images, of which enfilade keeps mean colours only: one decoder, and one way to take means.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageReader, Rgba, RgbaImage};

use crate::error::ImportErrorKind;
use crate::limits::{Budget, Limits};

/// Decodes the images of a model, one after the other.
#[derive(Debug)]
pub(crate) struct Decoder {
    /// All images together may not decode to more than the memory limit: small files can hold huge images, and each
    /// costs time.
    decoded: Budget,
}

/// A decoded image.
#[derive(Debug)]
pub(crate) enum Texels {
    /// 8 bits a channel.
    Eight(RgbaImage),
    /// 16 bits a channel.
    Sixteen(ImageBuffer<Rgba<u16>, Vec<u16>>),
}

/// A mean colour and the share of the surface that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeanColor {
    /// Linear RGB.
    pub(crate) rgb: [f64; 3],
    /// 0 to 1.
    pub(crate) alpha: f64,
}

/// Mean colours of an image, split by opacity. The texels' colours are sRGB, and averaged in linear light.
#[derive(Clone, Debug)]
pub(crate) struct ColorMeans {
    /// By the upper 8 bits of the alpha channel: 256 of them.
    levels: Vec<Level>,
    /// What an alpha channel holds where it is opaque.
    opaque: u16,
}

/// The texels of one opacity.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    count: u64,
    /// Sum of the alpha channel's numbers, of which 16-bit images have several in one level.
    alpha: u64,
    /// Sum of the linear colours.
    color: [f64; 3],
}

impl Decoder {
    /// A decoder under the memory limit of `limits`.
    pub(crate) fn new(limits: &Limits) -> Decoder {
        Decoder { decoded: Budget::new(limits) }
    }

    /// Decodes an image and gives what `keep` makes of it. `name` helps where the first bytes do not tell the format
    /// (TGA). The memory for it is taken from `budget` beforehand, and given back.
    ///
    /// # Errors
    /// [`ImportErrorKind::OverBudget`], or [`ImportErrorKind::Malformed`] with the decoder's words.
    pub(crate) fn decode<T>(
        &mut self,
        bytes: &[u8],
        name: &str,
        budget: &mut Budget,
        keep: impl FnOnce(&Texels) -> T,
    ) -> Result<T, ImportErrorKind> {
        let left = budget.left().min(self.decoded.left());
        let malformed = |error: image::ImageError| match error {
            // How much it would take, the decoder does not say.
            image::ImageError::Limits(error) => ImportErrorKind::Malformed(format!(
                "an image too large for the {left} bytes that are left of --max-memory: {error}"
            )),
            error => ImportErrorKind::Malformed(format!("no image: {error}")),
        };
        let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
        if reader.format().is_none() {
            let Ok(format) = ImageFormat::from_path(name) else {
                return Err(ImportErrorKind::Malformed("no image of a known format".to_owned()));
            };
            reader.set_format(format);
        }
        let mut limits = image::Limits::default();
        limits.max_alloc = Some(left);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(malformed)?;
        let (width, height) = decoder.dimensions();
        // The decoded image, as much again for the decoder, and the RGBA form of at most 16 bits a channel.
        let texels = u64::from(width) * u64::from(height);
        let cost = decoder.total_bytes().saturating_mul(2).saturating_add(texels.saturating_mul(8));
        budget.take(cost, "a texture")?;
        if let Err(error) = self.decoded.take(cost, "all textures") {
            budget.give_back(cost);
            return Err(error.into());
        }
        let image = DynamicImage::from_decoder(decoder).map_err(malformed);
        let kept = image.and_then(|image| match Texels::of(image) {
            texels if texels.count() > 0 => Ok(keep(&texels)),
            _ => Err(ImportErrorKind::Malformed("no image: it has no texels".to_owned())),
        });
        budget.give_back(cost);
        kept
    }
}

impl Texels {
    fn of(image: DynamicImage) -> Texels {
        match image {
            DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_) => Texels::Eight(image.into_rgba8()),
            deep => Texels::Sixteen(deep.into_rgba16()),
        }
    }

    /// How many.
    pub(crate) fn count(&self) -> u64 {
        let (width, height) = match self {
            Texels::Eight(image) => image.dimensions(),
            Texels::Sixteen(image) => image.dimensions(),
        };
        u64::from(width) * u64::from(height)
    }

    /// The largest number of a channel.
    pub(crate) fn largest(&self) -> u16 {
        match self {
            Texels::Eight(_) => 255,
            Texels::Sixteen(_) => 65535,
        }
    }

    /// Hands each texel to `take`, as it is in the file: R, G, B, A.
    pub(crate) fn for_each(&self, mut take: impl FnMut([u16; 4])) {
        match self {
            Texels::Eight(image) => image.pixels().for_each(|texel| take(texel.0.map(u16::from))),
            Texels::Sixteen(image) => image.pixels().for_each(|texel| take(texel.0)),
        }
    }
}

impl ColorMeans {
    /// What it takes in memory.
    #[cfg(feature = "gltf")]
    pub(crate) const BYTES: u64 = 256 * size_of::<Level>() as u64;

    /// The means of an image.
    pub(crate) fn of(texels: &Texels) -> ColorMeans {
        let opaque = texels.largest();
        // Of 16-bit numbers a table would take longer than most images.
        let table: Vec<f64> = (0..=255u8).map(|value| linear(f64::from(value) / 255.0)).collect();
        let shift = if opaque > 255 { 8 } else { 0 };
        let mut levels = vec![Level::default(); 256];
        texels.for_each(|[r, g, b, a]| {
            let level = &mut levels[usize::from(a >> shift)];
            level.count += 1;
            level.alpha += u64::from(a);
            for (sum, value) in level.color.iter_mut().zip([r, g, b]) {
                *sum += match texels {
                    Texels::Eight(_) => table[usize::from(value)],
                    Texels::Sixteen(_) => linear(f64::from(value) / 65535.0),
                };
            }
        });
        ColorMeans { levels, opaque }
    }

    /// The mean colour of all texels, each with the weight that `weight` gives its opacity (0 to 1), and the mean
    /// weight. If nothing has weight, the mean of all.
    pub(crate) fn weighted(&self, weight: impl Fn(f64) -> f64) -> MeanColor {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        let mut count = 0;
        for level in self.levels.iter().filter(|level| level.count > 0) {
            let weight = weight(level.alpha as f64 / (level.count * u64::from(self.opaque)) as f64);
            for (sum, channel) in sum.iter_mut().zip(level.color) {
                *sum += weight * channel;
            }
            total += weight * level.count as f64;
            count += level.count;
        }
        if total > 0.0 {
            MeanColor { rgb: sum.map(|sum| sum / total), alpha: total / count as f64 }
        } else {
            MeanColor { rgb: self.color(), alpha: 0.0 }
        }
    }

    /// The mean colour of all texels, linear RGB, whatever their opacity.
    pub(crate) fn color(&self) -> [f64; 3] {
        let count: u64 = self.levels.iter().map(|level| level.count).sum();
        let channel =
            |c: usize| self.levels.iter().map(|level| level.color[c]).sum::<f64>() / count.max(1) as f64;
        [channel(0), channel(1), channel(2)]
    }
}

/// The sRGB transfer function's inverse.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn checkers() -> DynamicImage {
        let texel =
            |x: u32, y: u32| if (x + y).is_multiple_of(2) { [255, 0, 188, 255] } else { [0, 0, 188, 51] };
        DynamicImage::ImageRgba8(RgbaImage::from_fn(8, 4, |x, y| Rgba(texel(x, y))))
    }

    fn means(bytes: &[u8], name: &str, budget: &mut Budget) -> Result<ColorMeans, ImportErrorKind> {
        Decoder::new(&Limits::default()).decode(bytes, name, budget, ColorMeans::of)
    }

    #[test]
    fn means_are_taken_of_linear_values() {
        let mut budget = Budget::new(&Limits::default());
        for (format, name) in [(ImageFormat::Png, "x"), (ImageFormat::Tga, "x.tga"), (ImageFormat::WebP, "x")]
        {
            let means = means(&encoded(&checkers(), format), name, &mut budget).unwrap();
            // Mean of the encoded values would decode to 0.21.
            assert_eq!(means.color()[..2], [0.5, 0.0], "{format:?}");
            assert!((means.color()[2] - 0.502_886).abs() < 1e-6, "{format:?} {means:?}");
        }
        assert_eq!(budget.used(), 0);
    }

    #[test]
    fn transparent_texels_weigh_less() {
        let mut budget = Budget::new(&Limits::default());
        let deep = DynamicImage::ImageRgba16(checkers().into_rgba16());
        for image in [checkers(), deep] {
            let means = means(&encoded(&image, ImageFormat::Png), "", &mut budget).unwrap();
            let blended = means.weighted(|alpha| alpha);
            assert!((blended.rgb[0] - 1.0 / 1.2).abs() < 1e-15, "{blended:?}");
            assert!((blended.alpha - 0.6).abs() < 1e-15, "{blended:?}");
            // At a limit that is just an opacity, that opacity is on its upper side.
            let cut = means.weighted(|alpha| if alpha >= 0.2 { 1.0 } else { 0.0 });
            assert_eq!((cut.rgb[0], cut.alpha), (0.5, 1.0));
            let gone = means.weighted(|_| 0.0);
            assert_eq!((gone.rgb, gone.alpha), (means.color(), 0.0));
        }
    }

    #[test]
    fn bits_beyond_the_eighth_count() {
        let texel = |x: u32, _| Rgba([1000 + 3 * x as u16, 0, 65535, 65280 + 5 * x as u16]);
        let deep = DynamicImage::ImageRgba16(ImageBuffer::from_fn(10, 1, texel));
        let mut budget = Budget::new(&Limits::default());
        let mean = means(&encoded(&deep, ImageFormat::Png), "", &mut budget).unwrap().weighted(|a| a);
        // Dark colours are linear.
        assert!((mean.rgb[0] - 1013.5 / 65535.0 / 12.92).abs() < 1e-8, "{mean:?}");
        assert!((mean.alpha - 65302.5 / 65535.0).abs() < 1e-12, "{mean:?}");
    }

    #[test]
    fn bad_and_huge_images_are_errors() {
        let mut budget = Budget::new(&Limits::default().with_max_memory(10_000));
        let png = encoded(&checkers(), ImageFormat::Png);
        assert!(means(&png, "", &mut budget).is_ok());
        for cut in [0, 3, 20, png.len() / 2] {
            assert!(means(&png[..cut], "a.png", &mut budget).is_err(), "{cut}");
        }
        for unknown in [&b"no image at all"[..], b"\xABKTX 20\xBB"] {
            let error = means(unknown, "", &mut budget).unwrap_err();
            assert_eq!(error.to_string(), "no image of a known format");
        }
        let large = DynamicImage::new_rgb8(100, 100);
        let error = means(&encoded(&large, ImageFormat::Png), "", &mut budget).unwrap_err();
        assert!(matches!(error, ImportErrorKind::OverBudget(_)), "{error}");
        // A header that claims 2^30 by 2^30 texels; its checksum is right.
        let mut huge = png.clone();
        huge[16..24].copy_from_slice(&[0x40, 0, 0, 0, 0x40, 0, 0, 0]);
        let crc = crc32(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.to_be_bytes());
        assert!(means(&huge, "", &mut Budget::new(&Limits::default())).is_err());
        assert_eq!(budget.used(), 0);
    }

    #[test]
    fn all_images_together_are_limited() {
        let png = encoded(&checkers(), ImageFormat::Png);
        let limits = Limits::default().with_max_memory(5_000);
        let (mut decoder, mut budget) = (Decoder::new(&limits), Budget::new(&limits));
        // 32 texels of 16 bytes each.
        let fine = (0..100).take_while(|_| decoder.decode(&png, "", &mut budget, |_| ()).is_ok()).count();
        assert_eq!(fine, 9);
        assert_eq!(budget.used(), 0);
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8)
                .fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
        })
    }
}
