//! Pictures as PNG files.

use std::path::Path;

use image::ImageEncoder;
use image::codecs::png::PngEncoder;

use super::color::to_srgb;
use super::picture::Picture;
use super::write::{WriteError, write};

/// The colours of a picture as sRGB, three bytes a pixel, rows from the top. Radiance over 1 is cut.
pub fn srgb_bytes(picture: &Picture) -> Vec<u8> {
    picture.pixels().iter().flat_map(|p| p.color.map(|c| (to_srgb(c) * 255.0).round() as u8)).collect()
}

/// Writes the colours of a picture to the PNG file `path`, 8 bits sRGB. The file is there whole or not at all; one
/// that was there is replaced.
///
/// # Errors
/// [`WriteError`], which names the file.
pub fn write_png(picture: &Picture, path: &Path) -> Result<(), WriteError> {
    let bytes = srgb_bytes(picture);
    write(path, |writer| {
        PngEncoder::new(writer)
            .write_image(&bytes, picture.width(), picture.height(), image::ExtendedColorType::Rgb8)
            .map_err(std::io::Error::other)
    })
}

/// Pixels of eight-bit RGBA, red in the lowest bits, as bytes.
pub fn rgba_bytes(pixels: &[u32]) -> Vec<u8> {
    pixels.iter().flat_map(|pixel| pixel.to_le_bytes()).collect()
}

/// Writes pixels of eight-bit RGBA, red in the lowest bits, of which there are `width` by some height, to the PNG file `path`, as [`write_png`] does, without
/// their alpha.
///
/// # Errors
/// [`WriteError`], which names the file.
pub fn write_png_rgba(pixels: &[u32], width: u32, path: &Path) -> Result<(), WriteError> {
    let bytes: Vec<u8> = pixels.iter().flat_map(|pixel| pixel.to_le_bytes().into_iter().take(3)).collect();
    let height = pixels.len().checked_div(width as usize).unwrap_or(0) as u32;
    write(path, |writer| {
        PngEncoder::new(writer)
            .write_image(&bytes, width, height, image::ExtendedColorType::Rgb8)
            .map_err(std::io::Error::other)
    })
}
