//! From regions to pixels: Lambert's cosine with a lamp at the eye, as eight-bit RGBA; or what each pixel shows, by number.

use super::detail::{Detail, borders_of};
use super::kernels::{Cover, Flat, Kernels};
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
    /// How the plane's distance grows along the ray through a pixel, for a normal of unit length: with column, row, and in the first.
    pub(super) grows: [f32; 3],
    /// The square of the ray's size: alone, with the column, with the row, with the square of the row, of the column.
    pub(super) square: [f32; 5],
    /// Red, green and blue where the plane faces the eye, at most 255.
    pub(super) color: [f32; 3],
}

/// What pixels become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Show {
    /// Colours.
    Light,
    /// Numbers of what they show, see [`Surface`](super::Surface).
    Surfaces,
}

/// The bit of the number of what pixels show that says: a source of faces, by its number; else a triangle.
pub(super) const SOURCE: u32 = 1 << 31;
/// The number of what lies around.
pub(super) const SKY: u32 = u32::MAX;
/// The number of what cells do not tell.
pub(super) const UNSURE: u32 = u32::MAX - 1;

/// Some rows of a picture being painted.
pub(super) struct Canvas<'a, 'd> {
    pub(super) tables: &'a Views,
    pub(super) kernels: Kernels,
    pub(super) show: Show,
    pub(super) cover: Cover<'a>,
    pub(super) square: [f32; 5],
    pub(super) sky: u32,
    /// Parts of rows that rays must tell: the row, and from where up to where.
    pub(super) unsure: &'a mut Vec<[i32; 3]>,
    pub(super) detail: &'a mut Detail<'d>,
    /// Triangles drawn.
    pub(super) triangles: u64,
    /// Parts of rows.
    pub(super) spans: u64,
}

/// The colour of a triangle that faces the lamp, at most 255.
pub(super) fn color(tables: &Views, triangle: u32) -> [f32; 3] {
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
        let Canvas { tables, kernels, show, cover, square, triangles, detail, .. } = self;
        detail.draw(region, root, exits, |drawn| {
            *triangles += 1;
            let (borders, first) = (borders_of(arena, region, drawn.rows), drawn.rows[0]);
            match show {
                Show::Light => {
                    let color = color(tables, drawn.triangle);
                    let shading = Shading { grows: drawn.deep.grows, square: *square, color };
                    kernels.draw(borders, cover, first, &drawn.deep, &shading)
                }
                Show::Surfaces => kernels.draw(borders, cover, first, &drawn.deep, &Flat(drawn.triangle)),
            };
        });
    }

    fn paint(&mut self, arena: &Arena, region: &Region, seen: &Seen) {
        let (borders, first) = (arena.borders(region), region.rows[0]);
        let [lo, hi] = borders;
        self.spans += lo.len() as u64;
        match (seen, self.show) {
            (Seen::Face { source, plane, .. }, Show::Light) => {
                let size = plane.normal.length();
                let source = self.tables.sources[*source as usize];
                let shading = Shading {
                    grows: plane.grows.map(|c| (c / size) as f32),
                    square: self.square,
                    color: color(self.tables, self.tables.surfaces[source.first as usize]),
                };
                self.kernels.fill(borders, &mut self.cover, first, &shading);
            }
            (Seen::Face { source, .. }, Show::Surfaces) => {
                self.kernels.fill(borders, &mut self.cover, first, &Flat(SOURCE | source));
            }
            (Seen::Nothing, Show::Light) => {
                self.kernels.fill(borders, &mut self.cover, first, &Flat(self.sky));
            }
            (Seen::Nothing, Show::Surfaces) => {
                self.kernels.fill(borders, &mut self.cover, first, &Flat(SKY));
            }
            (Seen::Unsure, _) => {
                self.kernels.fill(borders, &mut self.cover, first, &Flat(UNSURE));
                let rows = lo.iter().zip(hi).enumerate().filter(|(_, (lo, hi))| lo < hi);
                self.unsure.extend(rows.map(|(row, (&lo, &hi))| [first + row as i32, lo, hi]));
            }
        }
    }
}
