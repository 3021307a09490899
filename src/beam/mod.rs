//! Pictures by exact beams: what every pixel's ray meets first, without a ray for each.
//!
//! A picture is one beam from the eye. In each convex cell a beam is split by straight lines of the picture into those that leave
//! through each face, kept as one interval of columns a row, and follows the portals (see `docs/BEAMS.md`).

mod check;
mod detail;
mod kernels;
mod rays;
mod rows;
mod screen;
mod shade;
mod simd;
#[cfg(all(test, feature = "compile"))]
mod tests;
mod walk;

pub use check::Differences;
use detail::Detail;
use kernels::{Cover, Kernels};
use rays::Rays;
use screen::Screen;
use shade::{Canvas, Show, square};
use walk::{Space, Walker};

use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Kernel, NONE, Place, Prisms};

/// Rows that are done together, so that what is written stays in a cache.
const BAND: usize = 256;

/// The colour of what lies around.
const SKY_COLOR: u32 = 0xfff5_ddc8;

/// What a picture took.
#[derive(Clone, Copy, Debug, Default)]
pub struct BeamCounts {
    /// Cells, each as often as a beam came through.
    pub cells: u64,
    /// Parts of rows.
    pub spans: u64,
    /// Triangles drawn.
    pub triangles: u64,
    /// Pixels of which the cells did not tell what they show.
    pub unsure: u64,
}

/// Makes pictures of one scene, with what it needs kept from one to the next.
pub struct Beams<'a> {
    scene: &'a Scene,
    kernels: Kernels,
    space: Space,
    unsure: Vec<[i32; 3]>,
    near: Vec<f32>,
    touched: Vec<u64>,
    has_detail: bool,
    /// Whether there is nothing around the prisms.
    is_whole: bool,
}

/// Whether no triangle reaches out of the prisms' zone.
fn holds_all(scene: &Scene) -> bool {
    let prisms = Prisms::new(&scene.tables);
    scene.tables.vertices.iter().all(|&vertex| prisms.hold(prisms.local(vertex.into())))
}

impl<'a> Beams<'a> {
    /// For pictures of this scene.
    pub fn new(scene: &'a Scene) -> Beams<'a> {
        let kernel = Kernel::avx512().unwrap_or(Kernel::best());
        let is_whole = scene.tables.cells.len() > 1 && holds_all(scene);
        let has_detail = !is_whole || scene.tables.cells.iter().skip(1).any(|cell| cell.root != NONE);
        let (near, touched) = Default::default();
        Beams {
            scene,
            kernels: Kernels(kernel),
            space: Space::new(),
            unsure: Vec::new(),
            near,
            touched,
            has_detail,
            is_whole,
        }
    }

    /// The same by this kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Beams<'a> {
        Beams { kernels: Kernels(kernel), ..self }
    }

    /// Paints the picture that `camera` takes over `pixels`, of which there are `width` by some height: eight-bit RGBA, red in the lowest bits, the
    /// only light a lamp at the eye.
    pub fn paint(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Light)
    }

    /// Writes over `pixels`, of which there are `width` by some height, what each shows: see [`Surface::of`].
    pub fn surfaces(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Surfaces)
    }

    fn show(&mut self, camera: &Camera, width: u32, pixels: &mut [u32], show: Show) -> BeamCounts {
        let mut counts = BeamCounts::default();
        if width == 0 || pixels.is_empty() {
            return counts;
        }
        let height = (pixels.len() / width as usize) as u32;
        let tables = &self.scene.tables;
        let prisms = Prisms::new(tables);
        let screen = Screen::new(&camera.pinhole(width, height), &prisms);
        // Where the eye is in a solid, every pixel is left to rays.
        let start = match self.scene.locate(camera.eye()) {
            Place::Air { cell, .. } => Some(cell),
            Place::Outside => Some(0),
            Place::InSolid(_) => None,
        };
        self.unsure.clear();
        let mut detail = Detail::new(tables, screen.internal(&prisms));
        let mut first = 0;
        for band in pixels.chunks_mut(BAND * width as usize) {
            let end = first + (band.len() / width as usize) as i32;
            self.near.clear();
            self.touched.clear();
            if self.has_detail || start == Some(0) {
                self.near.resize(band.len(), 0.0);
                self.touched.resize(band.len() / width as usize, 0);
            }
            let cover = Cover {
                width: width as usize,
                top: first,
                pixels: band,
                near: &mut self.near,
                touched: &mut self.touched,
                block: width.div_ceil(64).next_power_of_two().trailing_zeros(),
            };
            let mut canvas = Canvas {
                tables,
                kernels: self.kernels,
                show,
                cover,
                square: square(&screen),
                sky: SKY_COLOR,
                unsure: &mut self.unsure,
                detail: &mut detail,
                triangles: 0,
                spans: 0,
            };
            let mut walker = Walker::new(tables, &screen, self.kernels, &mut self.space, &mut canvas);
            walker.around = if self.is_whole && start != Some(0) { NONE } else { tables.cells[0].root };
            walker.band(width as i32, [first, end], start);
            counts.spans += canvas.spans;
            counts.triangles += canvas.triangles;
            counts.cells += self.space.cells;
            first = end;
        }
        if show == Show::Light {
            let rays = Rays { scene: self.scene, camera, width, height, start };
            rays.shade(&self.unsure, pixels, SKY_COLOR);
        }
        counts.unsure = self.unsure.iter().map(|[_, lo, hi]| (hi - lo) as u64).sum();
        counts
    }
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Part of a wall, floor or ceiling of a cell: a triangle of this source of faces, by its number in the section `sources`.
    Source(u32),
    /// This triangle in a cell.
    Triangle(u32),
    /// Nothing.
    Sky,
    /// Cells do not tell.
    Unsure,
}

impl Surface {
    /// What a number of [`Beams::surfaces`] says.
    pub fn of(pixel: u32) -> Surface {
        match pixel {
            shade::SKY => Surface::Sky,
            shade::UNSURE => Surface::Unsure,
            _ if pixel & shade::SOURCE != 0 => Surface::Source(pixel & !shade::SOURCE),
            _ => Surface::Triangle(pixel),
        }
    }
}
