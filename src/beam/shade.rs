//! From regions to pixels: Lambert's cosine with a lamp at the eye, as eight-bit RGBA.

use super::kernels::Kernels;
use super::rows::{Arena, Region};
use super::screen::Screen;
use super::walk::{Paint, Seen};
use crate::format::Views;
use crate::render::to_srgb;

/// Radiance of a perfectly white surface that faces the eye.
const HEADLIGHT: f32 = 0.9;

/// What of a plane's pixels is the same for all of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    /// Pixels in a row.
    pub(super) width: usize,
    /// How the plane's distance grows along the ray through a pixel: with column, row, and in the first.
    pub(super) grows: [f32; 3],
    /// The square of the ray's size: alone, with the column, with the row, with the square of the row, of the column.
    pub(super) square: [f32; 5],
    /// Red, green and blue where the plane faces the eye, at most 255.
    pub(super) color: [f32; 3],
}

/// Pixels of some rows of a picture.
pub(super) struct Canvas<'a> {
    pub(super) tables: &'a Views,
    pub(super) screen: &'a Screen,
    pub(super) kernels: Kernels,
    pub(super) width: usize,
    /// The first row.
    pub(super) first: i32,
    pub(super) pixels: &'a mut [u32],
    pub(super) sky: u32,
    /// Rows of pixels that rays must tell: the row, and from where up to where.
    pub(super) unsure: &'a mut Vec<[i32; 3]>,
    /// Parts of rows.
    pub(super) spans: u64,
}

impl Canvas<'_> {
    fn color(&self, source: u32) -> [f32; 3] {
        let source = self.tables.sources[source as usize];
        let triangle = self.tables.surfaces[source.first as usize];
        let material = self.tables.record(triangle).material;
        let base = self.tables.materials.get(material as usize).map_or([1.0; 3], |look| look.base_color);
        base.map(|c| 255.0 * to_srgb(c))
    }
}

impl Paint for Canvas<'_> {
    fn paint(&mut self, arena: &Arena, region: &Region, seen: &Seen) {
        let [lo, hi] = arena.borders(region);
        self.spans += lo.len() as u64;
        match seen {
            Seen::Face { source, plane, .. } => {
                let screen = self.screen;
                let size = plane.normal.length();
                let (first, across, down) = (screen.first, screen.across, screen.down);
                let square = [
                    first.length_squared(),
                    2.0 * first.dot(across),
                    2.0 * first.dot(down),
                    down.length_squared(),
                    across.length_squared(),
                ];
                let color = self.color(*source).map(|c| c * HEADLIGHT.sqrt());
                let shading = Shading {
                    width: self.width,
                    grows: plane.grows.map(|c| (c / size) as f32),
                    square: square.map(|c| c as f32),
                    color,
                };
                self.kernels.shade([lo, hi], self.pixels, [region.rows[0], self.first], &shading);
            }
            Seen::Around { .. } => {
                for (row, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
                    if lo < hi {
                        let start = (region.rows[0] - self.first) as usize + row;
                        let start = start * self.width;
                        self.pixels[start + lo as usize..start + hi as usize].fill(self.sky);
                    }
                }
            }
            Seen::Unsure { .. } => {
                let rows = lo.iter().zip(hi).enumerate().filter(|(_, (lo, hi))| lo < hi);
                let first = region.rows[0];
                self.unsure.extend(rows.map(|(row, (&lo, &hi))| [first + row as i32, lo, hi]));
            }
        }
    }
}
