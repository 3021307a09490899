//! The loops over rows and pixels, compiled for what the CPU has.

use glam::DVec3;

use super::shade::Shading;
use super::simd;
use crate::trace::Kernel;

/// What the CPU has.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernels(pub(super) Kernel);

/// Adding and taking off this rounds to the nearest whole number; its last bits, as an integer, are those of the number added.
const MAGIC: f64 = 6_755_399_441_055_744.0;

impl Kernels {
    /// The border in each row from the `first` on: the first column that is not left of a line, held between the row's own borders. The line is at `start`
    /// in row 0 and goes by `slope` a row. Returns the least and the greatest of them.
    #[inline]
    pub(super) fn split(
        self,
        borders: [&[i32]; 2],
        border: &mut [i32],
        first: i32,
        line: [f64; 2],
    ) -> [i32; 2] {
        simd::split(self.0, borders, border, first, line)
    }

    /// Fills what is free between the borders of rows, the first of which is the row `first` of the picture.
    #[inline]
    pub(super) fn fill<T: Tint>(self, borders: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, tint: &T) {
        simd::fill(self.0, borders, cover, first, tint);
    }

    /// Draws a triangle between the borders of rows, the first of which is the row `first` of the picture. Returns how many pixels it was the nearest of.
    #[inline]
    pub(super) fn draw<T: Tint>(
        self,
        borders: [&[i32]; 2],
        cover: &mut Cover<'_>,
        first: i32,
        deep: &Deep,
        tint: &T,
    ) -> u32 {
        simd::draw(self.0, borders, cover, first, deep, tint)
    }
}

/// What the pixels of one surface become.
pub(super) trait Tint {
    /// What is the same for all pixels of a row.
    fn row(&self, y: f32) -> [f32; 2];

    /// The pixel of a column.
    fn pixel(&self, row: [f32; 2], x: f32) -> u32;
}

/// All pixels become the same.
pub(super) struct Flat(pub(super) u32);

impl Tint for Flat {
    #[inline(always)]
    fn row(&self, _: f32) -> [f32; 2] {
        [0.0; 2]
    }

    #[inline(always)]
    fn pixel(&self, _: [f32; 2], _: f32) -> u32 {
        self.0
    }
}

impl Tint for Shading {
    #[inline(always)]
    fn row(&self, y: f32) -> [f32; 2] {
        let grows = self.grows[1] * y + self.grows[2];
        let square = (self.square[3] * y + self.square[2]) * y + self.square[0];
        [grows, square]
    }

    #[inline(always)]
    fn pixel(&self, [grows, square]: [f32; 2], x: f32) -> u32 {
        let cosine = (self.grows[0] * x + grows).abs();
        let size = (self.square[4] * x + self.square[1]) * x + square;
        let bright = (cosine / size.sqrt()).sqrt();
        let [red, green, blue] = self.color;
        byte(red * bright) | byte(green * bright) << 8 | byte(blue * bright) << 16 | 0xff00_0000
    }
}

/// Adding this to a small number that is not negative leaves it, rounded, in the lowest bits.
const MAGIC_BYTE: f32 = 8_388_608.0;

/// A number that is no more than 255, rounded: conversions are not done side by side.
#[inline(always)]
fn byte(value: f32) -> u32 {
    (value + MAGIC_BYTE).to_bits() & 0xff
}

/// The number rounded up, and held within what columns may be.
#[inline(always)]
fn first_not_left(column: f64) -> i32 {
    let column = column.max(-1e9).min(1e9);
    let nearest = (column + MAGIC) - MAGIC;
    let up = if nearest < column { 1.0 } else { 0.0 };
    ((nearest + up) + MAGIC).to_bits() as i32
}

#[inline(always)]
pub(super) fn split(
    [lo, hi]: [&[i32]; 2],
    border: &mut [i32],
    first: i32,
    [slope, start]: [f64; 2],
) -> [i32; 2] {
    let (mut least, mut most) = (i32::MAX, i32::MIN);
    for (row, ((border, &lo), &hi)) in border.iter_mut().zip(lo).zip(hi).enumerate() {
        let column = first_not_left(start + slope * f64::from(first + row as i32));
        *border = column.min(hi).max(lo);
        least = least.min(*border);
        most = most.max(*border);
    }
    [least, most]
}

/// A line of the picture as a border of rows: the first column that is not left of it is `start + slope * row`, rounded up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    slope: f64,
    start: f64,
    /// Whether its positive side is the left one.
    is_left: bool,
}

impl Bound {
    /// All are on its positive side.
    pub(super) const NONE: Bound = Bound { slope: 0.0, start: -1e9, is_left: false };

    /// The border of a line's positive side. Where the line runs along the rows, it is `rows` that are bounded.
    pub(super) fn new(line: DVec3, rows: &mut [i32; 2]) -> Bound {
        let (slope, start) = (-line.y / line.x, -line.z / line.x);
        if slope.is_finite() && start.is_finite() {
            return Bound { slope, start, is_left: line.x < 0.0 };
        }
        let row = (-line.z / line.y).ceil().clamp(f64::from(rows[0]), f64::from(rows[1]));
        if line.y > 0.0 {
            rows[0] = row as i32;
        } else if line.y < 0.0 {
            rows[1] = row as i32;
        }
        Bound::NONE
    }
}

/// A triangle, ready to be drawn.
pub(super) struct Deep {
    pub(super) bounds: [Bound; Deep::BOUNDS],
    /// How many bounds there are.
    pub(super) count: usize,
    /// `1 / t`: how it grows with column and row, and in the first pixel.
    pub(super) near: [f64; 3],
    /// As [`Shading::grows`].
    pub(super) grows: [f32; 3],
}

impl Deep {
    pub(super) const BOUNDS: usize = 8;
}

/// Rows of a picture being made.
pub(super) struct Cover<'a> {
    pub(super) width: usize,
    /// The first row.
    pub(super) top: i32,
    pub(super) pixels: &'a mut [u32],
    /// `1 / t` of the detail that each pixel shows, 0 where it shows none; empty where there is none at all.
    pub(super) near: &'a mut [f32],
    /// Which blocks of columns of each row show any.
    pub(super) touched: &'a mut [u64],
    /// The logarithm of how many columns a block has.
    pub(super) block: u32,
}

#[inline(always)]
fn blocks([lo, hi]: [i32; 2], block: u32) -> u64 {
    let (first, last) = (lo >> block, (hi - 1) >> block);
    (u64::MAX << first) & (u64::MAX >> (63 - last))
}

#[inline(always)]
pub(super) fn fill<T: Tint>([lo, hi]: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, tint: &T) {
    for (index, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
        if lo >= hi {
            continue;
        }
        let row = first + index as i32;
        let below = (row - cover.top) as usize;
        let range = below * cover.width + lo as usize..below * cover.width + hi as usize;
        let same = tint.row(row as f32);
        let Some(pixels) = cover.pixels.get_mut(range.clone()) else { continue };
        let touched = cover.touched.get(below).is_some_and(|t| t & blocks([lo, hi], cover.block) != 0);
        if !touched {
            for (index, pixel) in pixels.iter_mut().enumerate() {
                *pixel = tint.pixel(same, (lo + index as i32) as f32);
            }
            continue;
        }
        let Some(near) = cover.near.get(range) else { continue };
        for (index, (pixel, &near)) in pixels.iter_mut().zip(near).enumerate() {
            let tinted = tint.pixel(same, (lo + index as i32) as f32);
            *pixel = if near == 0.0 { tinted } else { *pixel };
        }
    }
}

#[inline(always)]
pub(super) fn draw<T: Tint>(
    [lo, hi]: [&[i32]; 2],
    cover: &mut Cover<'_>,
    first: i32,
    deep: &Deep,
    tint: &T,
) -> u32 {
    let mut taken = 0;
    for (index, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
        let row = first + index as i32;
        let (mut lo, mut hi) = (lo, hi);
        for bound in &deep.bounds[..deep.count] {
            let column = first_not_left(bound.start + bound.slope * f64::from(row));
            if bound.is_left { hi = hi.min(column) } else { lo = lo.max(column) }
        }
        if lo >= hi {
            continue;
        }
        let below = (row - cover.top) as usize;
        let range = below * cover.width + lo as usize..below * cover.width + hi as usize;
        let (Some(pixels), Some(depths)) = (cover.pixels.get_mut(range.clone()), cover.near.get_mut(range))
        else {
            continue;
        };
        let same = tint.row(row as f32);
        let near = (deep.near[0] * f64::from(lo) + deep.near[1] * f64::from(row) + deep.near[2]) as f32;
        let step = deep.near[0] as f32;
        let mut nearer = 0;
        for (index, (pixel, depth)) in pixels.iter_mut().zip(depths).enumerate() {
            let tinted = tint.pixel(same, (lo + index as i32) as f32);
            let near = near + step * index as i32 as f32;
            let is_nearer = near > *depth;
            *pixel = if is_nearer { tinted } else { *pixel };
            *depth = if is_nearer { near } else { *depth };
            nearer += u32::from(is_nearer);
        }
        taken += nearer;
        if nearer > 0 {
            cover.touched[below] |= blocks([lo, hi], cover.block);
        }
    }
    taken
}
