//! From regions to pixels: Lambert's cosine with a lamp at the eye, as eight-bit RGBA.

use super::detail::{Detail, borders_of};
use super::kernels::{Depths, Kernels};
use super::rows::{Arena, Region};
use super::screen::{Plane, Screen};
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
pub(super) struct Canvas<'a, 'd> {
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
    pub(super) detail: &'a mut Detail<'d>,
    /// `1 / t` of the detail of each pixel, 0 where there is none, and which blocks of each row have any.
    pub(super) near: &'a mut [f32],
    pub(super) touched: &'a mut [u64],
    pub(super) block: u32,
    /// Triangles drawn.
    pub(super) triangles: u64,
    /// Parts of rows.
    pub(super) spans: u64,
}

/// The colour of a triangle that faces the lamp, at most 255.
fn color(tables: &Views, triangle: u32) -> [f32; 3] {
    let material = tables.record(triangle).material;
    let base = tables.materials.get(material as usize).map_or([1.0; 3], |look| look.base_color);
    base.map(|c| 255.0 * to_srgb(c) * HEADLIGHT.sqrt())
}

/// The square of the size of a ray, as [`Shading::square`].
pub(super) fn square(screen: &Screen) -> [f32; 5] {
    let (first, across, down) = (screen.first, screen.across, screen.down);
    let square = [
        first.length_squared(),
        2.0 * first.dot(across),
        2.0 * first.dot(down),
        down.length_squared(),
        across.length_squared(),
    ];
    square.map(|c| c as f32)
}

impl Paint for Canvas<'_, '_> {
    fn detail(&mut self, arena: &Arena, region: &Region, root: u32, exits: &[Plane]) {
        let (width, first, tables) = (self.width, self.first, self.tables);
        let square = square(self.screen);
        let mut depths =
            Depths { pixels: self.pixels, near: self.near, touched: self.touched, block: self.block };
        let (kernels, triangles) = (self.kernels, &mut self.triangles);
        self.detail.draw(region, root, exits, |drawn| {
            *triangles += 1;
            let color = color(tables, drawn.triangle);
            let shading = Shading { width, grows: drawn.deep.grows, square, color };
            let borders = borders_of(arena, region, drawn.rows);
            kernels.draw(borders, &mut depths, [drawn.rows[0], first], &drawn.deep, &shading);
        });
    }

    fn paint(&mut self, arena: &Arena, region: &Region, seen: &Seen) {
        let [lo, hi] = arena.borders(region);
        self.spans += lo.len() as u64;
        match seen {
            Seen::Face { source, plane, .. } => {
                let size = plane.normal.length();
                let source = self.tables.sources[*source as usize];
                let color = color(self.tables, self.tables.surfaces[source.first as usize]);
                let shading = Shading {
                    width: self.width,
                    grows: plane.grows.map(|c| (c / size) as f32),
                    square: square(self.screen),
                    color,
                };
                let place = [region.rows[0], self.first];
                if self.near.is_empty() {
                    self.kernels.shade([lo, hi], self.pixels, place, &shading);
                    return;
                }
                let mut depths = Depths {
                    pixels: self.pixels,
                    near: self.near,
                    touched: self.touched,
                    block: self.block,
                };
                self.kernels.shade_behind([lo, hi], &mut depths, place, &shading);
            }
            Seen::Around { .. } => {
                for (row, (&lo, &hi)) in lo.iter().zip(hi).enumerate() {
                    if lo < hi {
                        let start = (region.rows[0] - self.first) as usize + row;
                        let start = start * self.width;
                        let range = start + lo as usize..start + hi as usize;
                        let pixels = &mut self.pixels[range.clone()];
                        if self.near.is_empty() {
                            pixels.fill(self.sky);
                            continue;
                        }
                        for (pixel, &near) in pixels.iter_mut().zip(&self.near[range]) {
                            *pixel = if near == 0.0 { self.sky } else { *pixel };
                        }
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
