//! The loops over rows and pixels, compiled for what the CPU has.

use glam::DVec3;

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

    /// [`draw`].
    pub(super) fn draw(
        self,
        borders: [&[i32]; 2],
        depths: &mut Depths<'_>,
        place: [i32; 2],
        deep: &Deep,
        shading: &Shading,
    ) -> u32 {
        super::simd::draw(self.0, borders, depths, place, deep, shading)
    }

    /// [`shade_behind`].
    pub(super) fn shade_behind(
        self,
        borders: [&[i32]; 2],
        depths: &mut Depths<'_>,
        place: [i32; 2],
        shading: &Shading,
    ) {
        super::simd::shade_behind(self.0, borders, depths, place, shading);
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

/// What takes pixels with their depth: colours, `1 / t` of what is there, and in which blocks of columns of each row anything is.
pub(super) struct Depths<'a> {
    pub(super) pixels: &'a mut [u32],
    pub(super) near: &'a mut [f32],
    pub(super) touched: &'a mut [u64],
    /// A bit of `touched` stands for two to this many columns.
    pub(super) block: u32,
}

#[inline(always)]
fn blocks([lo, hi]: [i32; 2], block: u32) -> u64 {
    let (first, last) = (lo >> block, (hi - 1) >> block);
    (u64::MAX << first) & (u64::MAX >> (63 - last))
}

/// Draws a triangle into rows from `first` on, of which those of `depths` begin with the row `top`. Returns how many pixels it was the nearest of.
#[inline(always)]
pub(super) fn draw(
    [lo, hi]: [&[i32]; 2],
    depths: &mut Depths<'_>,
    [first, top]: [i32; 2],
    deep: &Deep,
    shading: &Shading,
) -> u32 {
    let width = shading.width;
    let mut taken = 0;
    for (index, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
        let row = first + index as i32;
        let (mut lo, mut hi) = (lo, hi);
        for bound in &deep.bounds[..deep.count] {
            let column = (bound.start + bound.slope * f64::from(row)).max(-1e9).min(1e9);
            let nearest = (column + MAGIC) - MAGIC;
            let up = if nearest < column { 1.0 } else { 0.0 };
            let column = ((nearest + up) + MAGIC).to_bits() as i32;
            if bound.is_left { hi = hi.min(column) } else { lo = lo.max(column) }
        }
        if lo >= hi {
            continue;
        }
        let place = (row - top) as usize * width;
        let range = place + lo as usize..place + hi as usize;
        let (Some(pixels), Some(depth)) = (depths.pixels.get_mut(range.clone()), depths.near.get_mut(range))
        else {
            continue;
        };
        let y = row as f32;
        let grows = shading.grows[1] * y + shading.grows[2];
        let square = (shading.square[3] * y + shading.square[2]) * y + shading.square[0];
        let [red, green, blue] = shading.color;
        let near = (deep.near[0] * f64::from(lo) + deep.near[1] * f64::from(row) + deep.near[2]) as f32;
        let step = deep.near[0] as f32;
        let mut nearer = 0;
        for (index, (pixel, depth)) in pixels.iter_mut().zip(depth).enumerate() {
            let x = (lo + index as i32) as f32;
            let cosine = (shading.grows[0] * x + grows).abs();
            let size = (shading.square[4] * x + shading.square[1]) * x + square;
            let bright = (cosine / size.sqrt()).sqrt();
            let byte = |color: f32| (color * bright + MAGIC_BYTE).to_bits() & 0xff;
            let color = byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff00_0000;
            let near = near + step * index as i32 as f32;
            let is_nearer = near > *depth;
            *pixel = if is_nearer { color } else { *pixel };
            *depth = if is_nearer { near } else { *depth };
            nearer += u32::from(is_nearer);
        }
        taken += nearer;
        if nearer > 0 {
            depths.touched[(row - top) as usize] |= blocks([lo, hi], depths.block);
        }
    }
    taken
}

/// The same as [`shade`], without what is taken.
#[inline(always)]
pub(super) fn shade_behind(
    [lo, hi]: [&[i32]; 2],
    depths: &mut Depths<'_>,
    [first, top]: [i32; 2],
    shading: &Shading,
) {
    let width = shading.width;
    for (index, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
        if lo >= hi {
            continue;
        }
        let row = first + index as i32;
        let place = (row - top) as usize * width;
        let range = place + lo as usize..place + hi as usize;
        let (Some(pixels), Some(depth)) = (depths.pixels.get_mut(range.clone()), depths.near.get(range)) else {
            continue;
        };
        let y = row as f32;
        let grows = shading.grows[1] * y + shading.grows[2];
        let square = (shading.square[3] * y + shading.square[2]) * y + shading.square[0];
        let [red, green, blue] = shading.color;
        let is_free = depths.touched[(row - top) as usize] & blocks([lo, hi], depths.block) == 0;
        if is_free {
            for (index, pixel) in pixels.iter_mut().enumerate() {
                let x = (lo + index as i32) as f32;
                let cosine = (shading.grows[0] * x + grows).abs();
                let size = (shading.square[4] * x + shading.square[1]) * x + square;
                let bright = (cosine / size.sqrt()).sqrt();
                let byte = |color: f32| (color * bright + MAGIC_BYTE).to_bits() & 0xff;
                *pixel = byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff00_0000;
            }
            continue;
        }
        for (index, (pixel, &depth)) in pixels.iter_mut().zip(depth).enumerate() {
            let x = (lo + index as i32) as f32;
            let cosine = (shading.grows[0] * x + grows).abs();
            let size = (shading.square[4] * x + shading.square[1]) * x + square;
            let bright = (cosine / size.sqrt()).sqrt();
            let byte = |color: f32| (color * bright + MAGIC_BYTE).to_bits() & 0xff;
            let color = byte(red) | byte(green) << 8 | byte(blue) << 16 | 0xff00_0000;
            *pixel = if depth == 0.0 { color } else { *pixel };
        }
    }
}
