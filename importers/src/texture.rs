//! The mean colour of a texture: all that enfilade keeps of it.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use crate::error::ImportErrorKind;
use crate::limits::Budget;

/// The mean of all texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mean {
    /// Linear RGB: the texels are taken for sRGB and averaged after linearisation.
    pub(crate) color: [f32; 3],
    /// Opacity; 1 without an alpha channel.
    pub(crate) alpha: f32,
}

/// The mean of an image in an encoded form. `name` helps where the bytes do not tell the format (TGA). Memory is
/// taken from `budget` before the image is decoded, and given back.
///
/// # Errors
/// [`ImportErrorKind::OverBudget`], or [`ImportErrorKind::Malformed`] with the decoder's words.
pub(crate) fn mean(bytes: &[u8], name: &str, budget: &mut Budget) -> Result<Mean, ImportErrorKind> {
    let left = budget.left();
    let malformed = |error: image::ImageError| match error {
        // How much it would take, the decoder does not say.
        image::ImageError::Limits(error) => ImportErrorKind::Malformed(format!(
            "an image too large for the {left} bytes that are left of --max-memory: {error}"
        )),
        error => ImportErrorKind::Malformed(format!("no image: {error}")),
    };
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    if reader.format().is_none()
        && let Ok(format) = ImageFormat::from_path(name)
    {
        reader.set_format(format);
    }
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(budget.left());
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(malformed)?;
    let (width, height) = decoder.dimensions();
    // The decoded image, its RGBA form of at most 16 bits a channel, and as much again for the decoder.
    let texels = u64::from(width) * u64::from(height);
    let cost = decoder.total_bytes().saturating_mul(2).saturating_add(texels.saturating_mul(8));
    budget.take(cost, "a texture")?;
    let image = DynamicImage::from_decoder(decoder);
    let mean = image.map_err(malformed).and_then(|image| {
        mean_of(image).ok_or_else(|| ImportErrorKind::Malformed("no image: it has no texels".to_owned()))
    });
    budget.give_back(cost);
    mean
}

fn mean_of(image: DynamicImage) -> Option<Mean> {
    let is_deep = !matches!(
        image,
        DynamicImage::ImageLuma8(_)
            | DynamicImage::ImageLumaA8(_)
            | DynamicImage::ImageRgb8(_)
            | DynamicImage::ImageRgba8(_)
    );
    let mut sums = [0.0f64; 4];
    let texels;
    if is_deep {
        let image = image.into_rgba16();
        texels = image.pixels().len();
        for texel in image.pixels() {
            for (channel, sum) in sums.iter_mut().enumerate() {
                let value = f64::from(texel[channel]) / 65535.0;
                *sum += if channel < 3 { linear(value) } else { value };
            }
        }
    } else {
        // Counting each value first makes the sum quick, and the same in any order.
        let image = image.into_rgba8();
        texels = image.pixels().len();
        let mut counts = [[0u64; 256]; 4];
        for texel in image.pixels() {
            for (count, value) in counts.iter_mut().zip(texel.0) {
                count[usize::from(value)] += 1;
            }
        }
        for (channel, (sum, count)) in sums.iter_mut().zip(&counts).enumerate() {
            for (value, &count) in count.iter().enumerate() {
                let value = value as f64 / 255.0;
                *sum += count as f64 * if channel < 3 { linear(value) } else { value };
            }
        }
    }
    if texels == 0 {
        return None;
    }
    let [r, g, b, alpha] = sums.map(|sum| (sum / texels as f64) as f32);
    Some(Mean { color: [r, g, b], alpha })
}

/// The sRGB transfer function's inverse.
fn linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    fn checkers() -> DynamicImage {
        let texel =
            |x: u32, y: u32| if (x + y).is_multiple_of(2) { [255, 0, 188, 255] } else { [0, 0, 188, 0] };
        DynamicImage::ImageRgba8(image::RgbaImage::from_fn(8, 4, |x, y| image::Rgba(texel(x, y))))
    }

    #[test]
    fn the_mean_is_linear() {
        let mut budget = Budget::new(&Limits::default());
        for (format, name) in [(ImageFormat::Png, "x"), (ImageFormat::Tga, "x.tga"), (ImageFormat::WebP, "x")]
        {
            let mean = mean(&encoded(&checkers(), format), name, &mut budget).unwrap();
            assert_eq!(mean.alpha, 0.5, "{format:?}");
            assert_eq!(mean.color[..2], [0.5, 0.0], "{format:?}");
            assert!((mean.color[2] - 0.502_886).abs() < 1e-5, "{format:?} {mean:?}");
        }
        let deep = DynamicImage::ImageRgba16(checkers().into_rgba16());
        let mean = mean(&encoded(&deep, ImageFormat::Png), "", &mut budget).unwrap();
        assert_eq!((mean.color[0], mean.alpha), (0.5, 0.5));
        assert_eq!(budget.used(), 0);
    }

    #[test]
    fn bad_and_huge_images_are_errors() {
        let mut budget = Budget::new(&Limits::default().with_max_memory(10_000));
        let png = encoded(&checkers(), ImageFormat::Png);
        assert!(mean(&png, "", &mut budget).is_ok());
        for cut in [0, 3, 20, png.len() / 2] {
            assert!(mean(&png[..cut], "a.png", &mut budget).is_err(), "{cut}");
        }
        assert!(mean(b"no image at all", "", &mut budget).is_err());
        let large = DynamicImage::new_rgb8(100, 100);
        let error = mean(&encoded(&large, ImageFormat::Png), "", &mut budget).unwrap_err();
        assert!(matches!(error, ImportErrorKind::OverBudget(_)), "{error}");
        assert_eq!(budget.used(), 0);
    }
}
