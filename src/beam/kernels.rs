//! The loops over rows and pixels, compiled for what the CPU has.

use super::shade::Shading;
use crate::trace::Kernel;

/// What the CPU has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels(pub(super) Kernel);

/// Adding and taking off this rounds to the nearest whole number; its last bits, as an integer, are those of the number added.
const MAGIC: f64 = 6_755_399_441_055_744.0;

impl Kernels {
    /// The border in each row from the `first` on: the first column that is not left of a line, held between the row's own borders. The line is at `start`
    /// in row 0 and goes by `slope` a row. Returns the least and the greatest of them.
    pub(super) fn split(
        self,
        [lo, hi]: [&[i32]; 2],
        border: &mut [i32],
        first: i32,
        line: [f64; 2],
    ) -> [i32; 2] {
        super::simd::split(self.0, [lo, hi], border, first, line)
    }

    /// Shades the pixels between the borders of rows, the first of which is the row `place[0]` of the picture and of which `pixels` begins with the row
    /// `place[1]`.
    pub(super) fn shade(
        self,
        borders: [&[i32]; 2],
        pixels: &mut [u32],
        place: [i32; 2],
        shading: &Shading,
    ) {
        super::simd::shade(self.0, borders, pixels, place, shading);
    }
}

/// Adding this to a small number that is not negative leaves it, rounded, in the lowest bits.
const MAGIC_BYTE: f32 = 8_388_608.0;

#[inline(always)]
pub(super) fn split(
    [lo, hi]: [&[i32]; 2],
    border: &mut [i32],
    first: i32,
    [slope, start]: [f64; 2],
) -> [i32; 2] {
    let (mut least, mut most) = (i32::MAX, i32::MIN);
    for (row, ((border, &lo), &hi)) in border.iter_mut().zip(lo).zip(hi).enumerate() {
        let column = (start + slope * f64::from(first + row as i32)).max(-1e9).min(1e9);
        let nearest = (column + MAGIC) - MAGIC;
        let up = if nearest < column { 1.0 } else { 0.0 };
        let column = ((nearest + up) + MAGIC).to_bits() as i32;
        *border = column.min(hi).max(lo);
        least = least.min(*border);
        most = most.max(*border);
    }
    [least, most]
}

#[inline(always)]
pub(super) fn shade(
    [lo, hi]: [&[i32]; 2],
    pixels: &mut [u32],
    [first, top]: [i32; 2],
    shading: &Shading,
) {
    let width = shading.width;
    let rows = pixels.chunks_exact_mut(width).skip((first - top) as usize);
    for (index, (row, (&lo, &hi))) in rows.zip(lo.iter().zip(hi)).enumerate() {
        let Some(span) = row.get_mut(lo as usize..hi.max(lo) as usize) else { continue };
        let y = (first + index as i32) as f32;
        let grows = shading.grows[1] * y + shading.grows[2];
        let square = (shading.square[3] * y + shading.square[2]) * y + shading.square[0];
        let [red, green, blue] = shading.color;
        for (index, pixel) in span.iter_mut().enumerate() {
            let x = (lo + index as i32) as f32;
            let cosine = (shading.grows[0] * x + grows).abs();
            let size = (shading.square[4] * x + shading.square[1]) * x + square;
            let bright = (cosine / size.sqrt()).sqrt();
            let byte = |color: f32| (color * bright + MAGIC_BYTE).to_bits() & 0xff;
            *pixel = byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff00_0000;
        }
    }
}
