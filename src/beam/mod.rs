//! Pictures by exact beams: what every pixel's ray meets first, without a ray for each.
//!
//! A picture is one beam from the eye. In each convex cell a beam is split by straight lines of the picture into those that leave
//! through each face, kept as one interval of columns a row, and follows the portals (see `docs/BEAMS.md`).

mod detail;
mod kernels;
mod rows;
mod screen;
mod shade;
mod simd;
mod walk;

use detail::Detail;
use kernels::Kernels;
use screen::Screen;
use shade::Canvas;
use walk::{Space, Walker};

use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Kernel, NONE, Place, Prisms};

/// Rows that are done together, so that what is written stays in a cache.
const BAND: usize = 256;

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
}

impl<'a> Beams<'a> {
    /// For pictures of this scene.
    pub fn new(scene: &'a Scene) -> Beams<'a> {
        let kernel = Kernel::avx512().unwrap_or(Kernel::best());
        let has_detail = scene.tables.cells.iter().skip(1).any(|cell| cell.root != NONE);
        let (near, touched) = Default::default();
        Beams {
            scene,
            kernels: Kernels(kernel),
            space: Space::new(),
            unsure: Vec::new(),
            near,
            touched,
            has_detail,
        }
    }

    /// The same by this kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Beams<'a> {
        Beams { kernels: Kernels(kernel), ..self }
    }

    /// Paints the picture that `camera` takes over `pixels`, of which there are `width` by some height.
    pub fn paint(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        let height = (pixels.len() / width as usize) as u32;
        let tables = &self.scene.tables;
        let screen = Screen::new(&camera.pinhole(width, height), &Prisms::new(tables));
        let mut counts = BeamCounts::default();
        let Place::Air { cell, .. } = self.scene.locate(camera.eye()) else { return counts };
        self.unsure.clear();
        let mut detail = Detail::new(tables, screen.internal(&Prisms::new(tables)));
        let mut first = 0;
        for band in pixels.chunks_mut(BAND * width as usize) {
            let end = first + (band.len() / width as usize) as i32;
            self.near.clear();
            self.touched.clear();
            if self.has_detail {
                self.near.resize(band.len(), 0.0);
                self.touched.resize(band.len() / width as usize, 0);
            }
            let mut canvas = Canvas {
                tables,
                screen: &screen,
                kernels: self.kernels,
                width: width as usize,
                first,
                pixels: band,
                sky: 0xffff_c8a0,
                unsure: &mut self.unsure,
                detail: &mut detail,
                near: &mut self.near,
                touched: &mut self.touched,
                block: width.div_ceil(64).next_power_of_two().trailing_zeros(),
                triangles: 0,
                spans: 0,
            };
            let mut walker = Walker::new(tables, &screen, self.kernels, &mut self.space, &mut canvas);
            walker.band(width as i32, [first, end], cell);
            counts.spans += canvas.spans;
            counts.triangles += canvas.triangles;
            counts.cells += self.space.cells;
            first = end;
        }
        counts.unsure = self.unsure.iter().map(|[_, lo, hi]| (hi - lo) as u64).sum();
        counts
    }
}
