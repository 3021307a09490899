//! What is kept of an image: its mean colour, split by opacity, and the means of images that hold no colours.

use crate::error::ImportErrorKind;
use crate::limits::Budget;
use crate::texture::{ColorMeans, Decoder, Texels};

/// Mean values of an image.
#[derive(Clone, Debug)]
pub(super) struct ImageMeans {
    /// Means of its colours.
    pub colors: ColorMeans,
    /// Mean of the channels as they are, in 0..=1, for images that hold no colours.
    pub plain: [f64; 3],
}

impl ImageMeans {
    /// What it takes in memory.
    pub const BYTES: u64 = ColorMeans::BYTES + 24;

    fn of(texels: &Texels) -> ImageMeans {
        let mut sums = [0u64; 3];
        texels.for_each(|texel| {
            for (sum, value) in sums.iter_mut().zip(texel) {
                *sum += u64::from(value);
            }
        });
        let most = texels.count() as f64 * f64::from(texels.largest());
        ImageMeans { colors: ColorMeans::of(texels), plain: sums.map(|sum| sum as f64 / most) }
    }
}

/// Decodes an image and takes its means; the format is told by the first bytes. Nothing stays taken from `budget`.
///
/// # Errors
/// Not an image of a known format, damaged, or over the budget.
pub(super) fn decode(
    decoder: &mut Decoder,
    bytes: &[u8],
    budget: &mut Budget,
) -> Result<ImageMeans, ImportErrorKind> {
    decoder.decode(bytes, "", budget, ImageMeans::of)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::Limits;
    use image::{ImageFormat, Rgba, RgbaImage};

    #[test]
    fn channels_have_plain_means_too() {
        let pixels = [[0, 51, 255, 0], [255, 51, 0, 9]];
        let image = RgbaImage::from_fn(2, 1, |x, _| Rgba(pixels[x as usize]));
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Png).unwrap();
        let (mut decoder, mut budget) = (Decoder::new(&Limits::default()), Budget::new(&Limits::default()));
        let means = decode(&mut decoder, bytes.get_ref(), &mut budget).unwrap();
        assert_eq!(means.plain, [0.5, 0.2, 0.5]);
        assert_eq!(means.colors.color()[0], 0.5);
    }
}
