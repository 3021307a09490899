//! One building in many forms: what it is, how glTF and OBJ may write it, and whether a model is it.

pub mod algebra;
pub mod building;
pub mod compare;
pub mod container;
pub mod gltf;
pub mod mesh;
pub mod numbers;
pub mod obj;

use std::path::PathBuf;

use enfilade::importers::ImportOptions;

/// What computing with f64 may be off by, as a share of the largest coordinate: some tens of roundings.
pub const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A written file, and what its form promises.
pub struct Written {
    pub path: PathBuf,
    pub options: ImportOptions,
    /// Metres in a unit, and whether Y is up.
    pub frame: (f64, bool),
    /// For each part how far a coordinate may be off, metres; 0: not at all.
    pub bounds: Vec<f64>,
    /// The parts in the order of their elements.
    pub order: Vec<usize>,
    /// How polygons were left to the importer: `None`: not; else equal for files with equal polygons.
    pub cut: Option<obj::Polygons>,
}

/// A picture of two texels: one white, one black and of opacity 1/5.
pub fn texture() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let colors = [[255, 255, 255, 255], [0, 0, 0, 51]];
    let texels = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba(colors[x as usize]));
    texels.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// How bright that is in linear light, each texel with its opacity as its weight; and its mean opacity.
pub const TEXTURE_MEANS: [f64; 2] = [1.0 / 1.2, 0.6];

/// With padding.
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word =
            chunk.iter().fold(0u32, |word, byte| word << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for digit in 0..4 {
            let index = word >> (18 - 6 * digit) & 63;
            text.push(if digit <= chunk.len() { DIGITS[index as usize] as char } else { '=' });
        }
    }
    text
}
