//! What is kept of an image: its mean colour, split by opacity.

use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageReader, Limits, RgbaImage};

use crate::limits::Budget;

/// Wider or higher images are not decoded.
const MAX_SIDE: u32 = 16384;

/// The pixels of one opacity.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    count: u64,
    /// Sum of the linear colours.
    sum: [f64; 3],
}

/// Mean values of an image with sRGB colours.
#[derive(Clone, Debug)]
pub(super) struct ImageMeans {
    /// By the value of the alpha channel: 256 of them.
    levels: Vec<Level>,
    /// Mean of the channels as they are, in 0..=1, for images that hold no colours.
    pub plain: [f64; 3],
}

/// A mean colour and the share of the surface that has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanColor {
    /// Linear RGB.
    pub rgb: [f64; 3],
    /// 0 to 1.
    pub alpha: f64,
}

impl ImageMeans {
    /// What it takes in memory.
    pub const BYTES: u64 = 256 * size_of::<Level>() as u64;

    fn of(image: &RgbaImage) -> ImageMeans {
        let linear: Vec<f64> = (0..=255u8).map(srgb_to_linear).collect();
        let mut levels = vec![Level::default(); 256];
        let mut plain = [0u64; 3];
        for pixel in image.pixels() {
            let [r, g, b, a] = pixel.0;
            let level = &mut levels[usize::from(a)];
            level.count += 1;
            for (channel, value) in [r, g, b].into_iter().enumerate() {
                level.sum[channel] += linear[usize::from(value)];
                plain[channel] += u64::from(value);
            }
        }
        let count = (u64::from(image.width()) * u64::from(image.height())).max(1);
        ImageMeans { levels, plain: plain.map(|sum| sum as f64 / count as f64 / 255.0) }
    }

    /// The mean colour of all pixels, each with the weight that `weight` gives its opacity (0 to 1), and the mean
    /// weight. If nothing has weight, the mean of all.
    pub fn weighted(&self, weight: impl Fn(f64) -> f64) -> MeanColor {
        let mut sum = [0.0; 3];
        let mut total = 0.0;
        let mut count = 0;
        for (alpha, level) in self.levels.iter().enumerate().filter(|(_, level)| level.count > 0) {
            let weight = weight(alpha as f64 / 255.0);
            for (sum, channel) in sum.iter_mut().zip(level.sum) {
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

    /// The mean colour of all pixels, linear RGB, whatever their opacity.
    pub fn color(&self) -> [f64; 3] {
        let count: u64 = self.levels.iter().map(|level| level.count).sum();
        let channel =
            |c: usize| self.levels.iter().map(|level| level.sum[c]).sum::<f64>() / count.max(1) as f64;
        [channel(0), channel(1), channel(2)]
    }
}

/// Decodes an image and takes its means; the format is told by the first bytes. Nothing stays taken from `budget`.
///
/// # Errors
/// In words: not an image of a known format, damaged, too large, or over the budget.
pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<ImageMeans, String> {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut reader = match reader.format() {
        Some(_) => reader,
        None => return Err("the image is of no known format".to_owned()),
    };
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(budget.left());
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions();
    // As decoded, and again with 8 bits and four channels.
    let bytes = decoder.total_bytes().saturating_add(u64::from(width) * u64::from(height) * 4);
    budget.take(bytes, "an image").map_err(|e| e.to_string())?;
    let means = DynamicImage::from_decoder(decoder)
        .map(|image| ImageMeans::of(&image.into_rgba8()))
        .map_err(|e| e.to_string());
    budget.give_back(bytes);
    means
}

fn srgb_to_linear(value: u8) -> f64 {
    let c = f64::from(value) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, Rgba};

    fn png(pixels: &[[u8; 4]]) -> Vec<u8> {
        let image = RgbaImage::from_fn(pixels.len() as u32, 1, |x, _| Rgba(pixels[x as usize]));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        bytes.into_inner()
    }

    fn budget() -> Budget {
        Budget::new(&crate::limits::Limits::default())
    }

    #[test]
    fn means_are_taken_of_linear_values() {
        let means = decode(&png(&[[0, 0, 0, 255], [255, 255, 255, 255]]), &mut budget()).unwrap();
        // Mean of the encoded values would decode to 0.21.
        assert_eq!(means.color(), [0.5; 3]);
        assert_eq!(means.plain, [0.5; 3]);
        let grey = decode(&png(&[[188, 188, 188, 255]]), &mut budget()).unwrap();
        assert!((grey.color()[0] - 0.5029).abs() < 1e-4);
    }

    #[test]
    fn transparent_pixels_weigh_less() {
        let means = decode(&png(&[[255, 0, 0, 255], [0, 0, 255, 0], [0, 0, 255, 0]]), &mut budget()).unwrap();
        let blended = means.weighted(|alpha| alpha);
        assert_eq!(blended.rgb, [1.0, 0.0, 0.0]);
        assert!((blended.alpha - 1.0 / 3.0).abs() < 1e-15);
        let gone = means.weighted(|_| 0.0);
        assert_eq!((gone.rgb, gone.alpha), (means.color(), 0.0));
    }

    #[test]
    fn damaged_and_oversized_images_are_errors() {
        let good = png(&[[1, 2, 3, 4]; 64]);
        assert!(decode(&good[..good.len() / 2], &mut budget()).is_err());
        assert!(decode(b"\xABKTX 20\xBB", &mut budget()).is_err());
        let mut small = Budget::new(&crate::limits::Limits::default().with_max_memory(100));
        assert!(decode(&good, &mut small).is_err());
        // A PNG header that claims 2^30 by 2^30 pixels; its checksum is right.
        let mut huge = good.clone();
        huge[16..24].copy_from_slice(&[0x40, 0, 0, 0, 0x40, 0, 0, 0]);
        let crc = crc32(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.to_be_bytes());
        assert!(decode(&huge, &mut budget()).is_err());
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0u32, |crc, byte| {
            (0..8)
                .fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg()))
        })
    }
}
