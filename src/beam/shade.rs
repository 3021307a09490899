//! From regions to pixels: Lambert's cosine with a lamp at the eye, as eight-bit RGBA; or what each pixel shows, by number.

use super::cover::Cover;
use super::cut::Exits;
use super::detail::{Detail, Drawn, Pen, borders_of};
use super::facets::Facets;
use super::fringe::Edges;
use super::glass::{Layer, Layers, Pane};
use super::joined::Joined;
use super::kernels::{Flat, Kernels, Tint, is_taken};
use super::rows::{Arena, Region, free_parts};
use super::screen::Screen;
use super::sight::Place;
use super::walk::{AROUND, Paint, Seen, Triangles};
use crate::format::Views;
use crate::format::records::SourceRecord;
use crate::render::to_srgb;
use crate::trace::NONE;

/// Radiance of a perfectly white surface that faces the eye.
const HEADLIGHT: f32 = 0.9;

/// What of a plane's pixels is the same for all of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shading {
    /// How the plane's distance grows along the ray through a pixel, for a normal of unit length: with column, row, and in the first.
    pub(super) grows: [f32; 3],
    /// The square of the ray's size: alone, with the column, with the row, with the square of the row, of the column.
    pub(super) square: [f32; 5],
    /// Red, green and blue where the plane faces the eye, at most 255.
    pub(super) color: [f32; 3],
    /// Where the plane is so much farther than this from being seen edge-on, brightness grows evenly along sixteen pixels of a row, as far as one could
    /// see; infinite if it does not for the size of the rays.
    pub(super) steep: f32,
}

impl Shading {
    pub(crate) fn new(grows: [f32; 3], square: [f32; 5], color: [f32; 3]) -> Shading {
        /// With d the pixels along the row to where the plane is seen edge-on, and w those that the eye is before the picture, brightness is the root of
        /// `(x - d)` by the fourth root of `x^2 + w^2`. Between the ends of sixteen pixels it is off an even slope by no more than 8 / d^2 + 18 / w^2 +
        /// 8 / (d w) of itself: here a third of a step.
        const EDGE: f32 = 128.0;
        const AWAY: f32 = 192.0;
        let [alone, column, row, rows, columns] = square;
        let away = alone - row * row / (4.0 * rows) - column * column / (4.0 * columns);
        let is_even = away >= AWAY * AWAY * columns;
        let steep = if is_even { EDGE * grows[0].abs() } else { f32::INFINITY };
        Shading { grows, square, color, steep }
    }
}

/// What pixels become.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Show {
    /// Colours.
    Light,
    /// Numbers of what they show, see [`Surface`](super::Surface).
    Surfaces,
    /// The cells in which their rays end.
    Cells,
}

/// The bit of the number of what pixels show that says: a source of faces, by its number; else a triangle.
pub(crate) const SOURCE: u32 = 1 << 31;
/// The number of what lies around.
pub(crate) const SKY: u32 = u32::MAX;
/// The number of what cells do not tell.
pub(crate) const UNSURE: u32 = u32::MAX - 1;

/// Some rows of a picture being painted.
pub(crate) struct Canvas<'a, 'd> {
    pub(crate) tables: &'a Views,
    pub(crate) kernels: Kernels,
    pub(crate) show: Show,
    pub(crate) cover: Cover<'a>,
    pub(crate) looks: &'a Looks,
    pub(crate) joined: &'a Joined,
    /// All polygons, if they are to be drawn where all triangles are.
    pub(crate) facets: Option<&'a Facets>,
    pub(crate) square: [f32; 5],
    pub(crate) sky: u32,
    /// What is seen through.
    pub(crate) layers: &'a mut Layers,
    /// Parts of rows that rays must tell: the row, and from where up to where.
    pub(crate) unsure: &'a mut Vec<[i32; 3]>,
    pub(crate) edges: &'a mut Edges,
    pub(crate) detail: &'a mut Detail<'d>,
    /// Triangles drawn.
    pub(crate) triangles: u64,
    /// Parts of rows.
    pub(crate) spans: u64,
}

/// How materials look that face the lamp.
pub(crate) struct Looks {
    /// Red, green and blue, at most 255 each; the last is that of what has no material.
    colors: Vec<[f32; 3]>,
    /// Those that one sees through; empty where all count as opaque.
    panes: Vec<Option<Pane>>,
}

impl Looks {
    /// All opaque.
    pub(crate) fn new(tables: &Views) -> Looks {
        let look = |color: [f32; 3]| color.map(|c| 255.0 * to_srgb(c.clamp(0.0, 1.0)) * HEADLIGHT.sqrt());
        let looks = tables.materials.iter().map(|material| look(material.base_color));
        Looks { colors: looks.chain([look([1.0; 3])]).collect(), panes: Vec::new() }
    }

    /// Glass is seen through.
    pub(super) fn through_glass(tables: &Views) -> Looks {
        let looks = Looks::new(tables);
        let panes = tables.materials.iter().zip(&looks.colors).map(|(look, &color)| Pane::new(look, color));
        let panes: Vec<_> = panes.collect();
        let is_glass = panes.iter().any(Option::is_some);
        Looks { panes: if is_glass { panes } else { Vec::new() }, ..looks }
    }

    /// That of a triangle.
    pub(crate) fn of(&self, tables: &Views, triangle: u32) -> [f32; 3] {
        let material = tables.record(triangle).material as usize;
        self.colors[material.min(self.colors.len() - 1)]
    }

    /// Whether anything is seen through.
    pub(super) fn has_glass(&self) -> bool {
        !self.panes.is_empty()
    }

    /// What a material lets pass, if one sees through it.
    pub(super) fn pane(&self, material: u32) -> Option<&Pane> {
        self.panes.get(material as usize)?.as_ref()
    }

    /// What a triangle lets pass.
    pub(super) fn pane_of(&self, tables: &Views, triangle: u32) -> Option<&Pane> {
        if self.panes.is_empty() { None } else { self.pane(tables.record(triangle).material) }
    }
}

/// The square of the size of a ray, as [`Shading::square`].
pub(crate) fn square(screen: &Screen) -> [f32; 5] {
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

impl<'a, 'd> Canvas<'a, 'd> {
    /// Fills what is free of a region.
    fn fill(&mut self, arena: &Arena, region: &Region, tint: &impl Tint) {
        self.kernels.fill(arena.borders(region), &mut self.cover, region.rows[0], tint);
    }

    /// What finds the triangles of a region, in a cell, and what draws them.
    fn pencil<'c>(
        &'c mut self,
        arena: &'c Arena,
        region: &'c Region,
        cell: u32,
    ) -> (&'c mut Detail<'d>, Pencil<'c, 'a>) {
        let Canvas {
            tables,
            kernels,
            show,
            cover,
            looks,
            square,
            layers,
            triangles,
            detail,
            joined,
            edges,
            ..
        } = self;
        let screen = detail.screen;
        // Where triangles are told, each is drawn; also with what is seen through: that counts once in all cells by its triangle, and a polygon's first triangle is
        // not the same in each. From outside, by facets, there is one cell.
        let joined = (*show == Show::Light && !looks.has_glass()).then_some(*joined);
        let (tables, kernels, show, looks, square) = (*tables, *kernels, *show, *looks, *square);
        (
            detail,
            Pencil {
                tables,
                kernels,
                show,
                cover,
                looks,
                joined,
                square,
                layers,
                screen,
                arena,
                region,
                cell,
                triangles,
                edges,
            },
        )
    }

    /// Mixes what is seen through into what is behind it: when all is painted.
    pub(super) fn melt(&mut self) {
        self.kernels.melt(self.layers, &mut self.cover, &self.square, self.unsure);
    }

    /// Leaves to rays what is free of a region.
    fn doubt(&mut self, arena: &Arena, region: &Region) {
        self.fill(arena, region, &Flat(UNSURE));
        let [lo, hi] = arena.borders(region);
        for (row, (&lo, &hi)) in (region.rows[0]..).zip(lo.iter().zip(hi)) {
            free_parts(
                row,
                [lo, hi],
                |column| self.cover.is_taken(row, column),
                |part| self.unsure.push(part),
            );
        }
    }
}

impl Paint for Canvas<'_, '_> {
    fn detail(&mut self, arena: &Arena, region: &Region, of: (u32, Triangles<'_>), exits: Exits<'_>) {
        let (cell, triangles) = of;
        let kernels = self.kernels;
        let facets = self.facets;
        let (detail, mut pencil) = self.pencil(arena, region, cell);
        match (triangles, facets) {
            (Triangles::All(_), Some(facets)) => detail.draw_facets(region, facets, kernels, &mut pencil),
            (Triangles::Below(root), _) => detail.draw(region, root, exits, &mut pencil),
            (Triangles::All(root), _) => detail.draw_all(region, root, kernels, &mut pencil),
            (Triangles::Outer(outer), _) => detail.draw_outer(region, outer, exits, &mut pencil),
        }
    }

    fn edge(&mut self, row: i32, [from, to]: [i32; 2]) {
        self.edges.add(row, [from, to], |column| self.cover.is_taken(row, column));
    }

    fn is_hidden(&self, arena: &Arena, region: &Region) -> bool {
        is_taken(arena.borders(region), &self.cover, region.rows[0])
    }

    fn paint(&mut self, arena: &Arena, region: &Region, seen: &Seen) {
        self.spans += (region.rows[1] - region.rows[0]) as u64;
        match (seen, self.show) {
            (Seen::Face { source, plane, is_plain: true, .. }, Show::Light) => {
                let source = self.tables.sources[*source as usize];
                let first = self.tables.surfaces[source.first as usize];
                if self.looks.pane_of(self.tables, first).is_some() {
                    // What is beyond it, within the solid and out of it again, rays must tell.
                    self.doubt(arena, region);
                    return;
                }
                let grows = plane.grows.map(|c| (c / plane.size) as f32);
                let shading = Shading::new(grows, self.square, self.looks.of(self.tables, first));
                self.fill(arena, region, &shading);
            }
            (Seen::Face { source, is_plain: true, .. }, Show::Surfaces) => {
                self.fill(arena, region, &Flat(SOURCE | source));
            }
            (Seen::Face { cell, is_plain: true, .. }, Show::Cells) => self.fill(arena, region, &Flat(*cell)),
            (Seen::Face { source, cell, is_plain: false, .. }, _) => {
                // Its own triangles, and rays where they do not fill it.
                let SourceRecord { first, count, root, .. } = self.tables.sources[*source as usize];
                let listed = first as usize..first as usize + count as usize;
                let tables = self.tables;
                let (detail, mut pencil) = self.pencil(arena, region, *cell);
                match root {
                    NONE => detail.draw_listed(region, &tables.surfaces[listed], &mut pencil),
                    root => detail.draw(region, root, Exits::NONE, &mut pencil),
                }
                self.doubt(arena, region);
            }
            (Seen::Nothing, Show::Light) => self.fill(arena, region, &Flat(self.sky)),
            (Seen::Nothing, Show::Surfaces) => self.fill(arena, region, &Flat(SKY)),
            (Seen::Nothing, Show::Cells) => self.fill(arena, region, &Flat(AROUND)),
            (Seen::Unsure, _) => self.doubt(arena, region),
        }
    }
}

/// Draws triangles in a region, in a cell.
struct Pencil<'c, 'a> {
    tables: &'a Views,
    kernels: Kernels,
    show: Show,
    cover: &'c mut Cover<'a>,
    looks: &'a Looks,
    joined: Option<&'a Joined>,
    square: [f32; 5],
    layers: &'c mut Layers,
    screen: Screen,
    arena: &'c Arena,
    region: &'c Region,
    cell: u32,
    triangles: &'c mut u64,
    edges: &'c mut Edges,
}

impl Pen for Pencil<'_, '_> {
    fn hides(&mut self, place: &Place) -> bool {
        self.kernels.hides(self.cover, place.columns, place.rows, place.near)
    }

    fn joined(&self) -> Option<&Joined> {
        self.joined
    }

    fn draw(&mut self, drawn: &Drawn) {
        *self.triangles += drawn.count as u64;
        let (rows, deep) = (drawn.rows, &drawn.deep);
        let (kernels, borders) = (self.kernels, borders_of(self.arena, self.region, rows));
        match self.show {
            Show::Light => {
                let grows = self.screen.along(drawn.normal).map(|c| c as f32);
                let pane =
                    if drawn.is_opaque { None } else { self.looks.pane_of(self.tables, drawn.triangle) };
                if let Some(&pane) = pane {
                    let layer = Layer::new(drawn.triangle, deep, grows, pane);
                    kernels.glaze(borders, self.cover, rows, deep, (layer, self.layers));
                    return;
                }
                let color = drawn.color.unwrap_or_else(|| self.looks.of(self.tables, drawn.triangle));
                let shading = Shading::new(grows, self.square, color);
                kernels.draw(borders, self.cover, rows, deep, &shading);
            }
            Show::Surfaces => kernels.draw(borders, self.cover, rows, deep, &Flat(drawn.triangle)),
            Show::Cells => kernels.draw(borders, self.cover, rows, deep, &Flat(self.cell)),
        }
    }

    fn cut(&mut self, drawn: &Drawn) {
        let of = (&drawn.deep.bounds[..drawn.within], drawn.cuts.as_slice());
        let [across, down, first] = drawn.deep.near;
        for cut in &drawn.cuts {
            let [lo, hi] = self.arena.borders(&self.region.within(cut.rows));
            for (row, (&lo, &hi)) in (cut.rows[0]..).zip(lo.iter().zip(hi)) {
                let [from, to] = cut.part(row, [lo, hi], of);
                if from < to {
                    let start = down * f64::from(row) + first;
                    // Behind what was drawn before nothing is asked: whole regions that are hidden are not come to.
                    let is_behind =
                        |column| self.cover.is_as_near(row, column, across * f64::from(column) + start);
                    self.edges.add(row, [from, to], is_behind);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::cover::Depths;
    use super::super::wide::ROWS;
    use super::*;
    use crate::trace::Kernel;

    proptest! {
        /// Pixels by ramps, too, are no farther than a step from what f64 has: planes near and far from edge-on, eyes near and far before the picture.
        #[test]
        fn pixels_are_right_to_a_step(
            normal in [-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0],
            away in 60.0f64..2000.0,
            color in [0.0f32..241.9, 0.0f32..241.9, 0.0f32..241.9],
        ) {
            const WIDTH: usize = 1000;
            let size = normal.iter().map(|c| c * c).sum::<f64>().sqrt().max(1e-3);
            let normal = normal.map(|c| c / size);
            // The ray through a pixel is (x - middle, y - 30, away).
            let middle = WIDTH as f64 / 2.0;
            let grows = [normal[0], normal[1], away * normal[2] - middle * normal[0] - 30.0 * normal[1]];
            let square = [middle * middle + 900.0 + away * away, -2.0 * middle, -60.0, 1.0, 1.0];
            let shading = Shading::new(grows.map(|c| c as f32), square.map(|c| c as f32), color);
            let (lo, hi) = (vec![3; ROWS], vec![WIDTH as i32 - 2; ROWS]);
            for kernel in Kernel::available() {
                let (mut depths, mut pixels) = (Depths::new(), vec![0; WIDTH * ROWS]);
                let mut cover = depths.cover(WIDTH, 0, &mut pixels);
                Kernels(kernel).fill([&lo, &hi], &mut cover, 0, &shading);
                for (at, pixel) in pixels.iter().enumerate() {
                    let (x, y) = ((at % WIDTH) as f64, (at / WIDTH) as f64);
                    if !(3.0..(WIDTH - 2) as f64).contains(&x) {
                        prop_assert_eq!(*pixel, 0);
                        continue;
                    }
                    let [u, v] = [x - middle, y - 30.0];
                    let cosine = (normal[0] * u + normal[1] * v + normal[2] * away).abs();
                    let bright = (cosine / (u * u + v * v + away * away).sqrt()).sqrt();
                    for (c, byte) in color.iter().zip(pixel.to_le_bytes()) {
                        let off = (f64::from(byte) - f64::from(*c) * bright).abs();
                        prop_assert!(off < 1.0, "{:?} {} {} {} {}", kernel, x, y, byte, f64::from(*c) * bright);
                    }
                }
            }
        }
    }
}
