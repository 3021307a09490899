//! Pictures by exact beams: what every pixel's ray meets first, without a ray for each.
//!
//! A picture is one beam from the eye. In each convex cell a beam is split by straight lines of the picture into those that leave
//! through each face, kept as one interval of columns a row, and follows the portals (see `docs/BEAMS.md`).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub(crate) mod check;
pub(crate) mod detail;
pub(crate) mod kernels;
pub(crate) mod parting;
pub(crate) mod rays;
pub(crate) mod rows;
pub(crate) mod screen;
pub(crate) mod shade;
pub(crate) mod simd;
#[cfg(all(test, feature = "compile"))]
pub(crate) mod tests;
pub(crate) mod walk;
pub(crate) mod wide;

use std::sync::{Mutex, PoisonError};

pub use check::Differences;
use detail::Detail;
use kernels::{Cover, Kernels};
use parting::Partings;
use rays::Rays;
use screen::Screen;
use shade::{Canvas, Looks, Show, square};
use walk::{Space, Walker};
use wide::WIDE;

use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Kernel, NONE, Place, Prisms};

/// Rows that are done together, so that what is written stays in a cache, and threads share the work.
const BAND: usize = 128;

/// The colour of what lies around.
pub(crate) const SKY_COLOR: u32 = 0xfff5_ddc8;

/// What a picture took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamCounts {
    /// Cells, each as often as a beam came through.
    pub cells: u64,
    /// Parts of rows.
    pub spans: u64,
    /// Triangles drawn.
    pub triangles: u64,
    /// Pixels of which the cells did not tell what they show: left to rays.
    pub unsure: u64,
}

/// Makes pictures of one scene, with what it needs kept from one to the next.
pub struct Beams<'a> {
    scene: &'a Scene,
    kernels: Kernels,
    partings: Partings,
    looks: Looks,
    /// Not in use.
    works: Mutex<Vec<Work>>,
    /// Whether there is nothing around the prisms.
    is_whole: bool,
}

/// What a thread needs for a band.
struct Work {
    space: Space,
    near: Vec<[f32; WIDE]>,
    touched: Vec<bool>,
    rows: Vec<bool>,
    unsure: Vec<[i32; 3]>,
    counts: BeamCounts,
}

/// A picture under way.
struct Shot<'s> {
    screen: Screen,
    /// Along the internal frame's axes.
    internal: Screen,
    width: u32,
    show: Show,
    /// The cell of the eye; none in a solid.
    start: Option<u32>,
    beams: &'s Beams<'s>,
}

/// Whether no triangle reaches out of the prisms' zone.
pub(crate) fn holds_all(scene: &Scene) -> bool {
    let prisms = Prisms::new(&scene.tables);
    scene.tables.vertices.iter().all(|&vertex| prisms.hold(prisms.local(vertex.into())))
}

impl<'a> Beams<'a> {
    /// For pictures of this scene.
    pub fn new(scene: &'a Scene) -> Beams<'a> {
        let kernel = Kernel::avx512().unwrap_or(Kernel::best());
        Beams {
            scene,
            kernels: Kernels(kernel),
            partings: Partings::new(scene.tables.cells.len()),
            looks: Looks::new(&scene.tables),
            works: Mutex::new(Vec::new()),
            is_whole: scene.tables.cells.len() > 1 && holds_all(scene),
        }
    }

    /// The same by this kernel.
    pub fn with_kernel(self, kernel: Kernel) -> Beams<'a> {
        Beams { kernels: Kernels(kernel), ..self }
    }

    /// Paints the picture that `camera` takes over `pixels`, of which there are `width` by some height: eight-bit RGBA, red in the lowest bits, the
    /// only light a lamp at the eye. What is bright is so to within one of the 255 steps, and may differ by as much from kernel to kernel.
    ///
    /// With the feature `rayon` the rows are shared among the threads of the current pool.
    pub fn paint(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Light)
    }

    /// Writes over `pixels`, of which there are `width` by some height, what each shows: see [`Surface::of`].
    pub fn surfaces(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Surfaces)
    }

    fn show(&mut self, camera: &Camera, width: u32, pixels: &mut [u32], show: Show) -> BeamCounts {
        let height = pixels.len().checked_div(width as usize).unwrap_or(0) as u32;
        if height == 0 {
            return BeamCounts::default();
        }
        let prisms = Prisms::new(&self.scene.tables);
        let screen = Screen::new(&camera.pinhole(width, height), &prisms);
        let start = self.start(camera);
        let shot = Shot { internal: screen.internal(&prisms), screen, width, show, start, beams: self };
        shot.bands(pixels);
        let mut counts = BeamCounts::default();
        let mut unsure = Vec::new();
        for work in self.works.get_mut().unwrap_or_else(PoisonError::into_inner) {
            counts.cells += work.counts.cells;
            counts.spans += work.counts.spans;
            counts.triangles += work.counts.triangles;
            work.counts = BeamCounts::default();
            unsure.append(&mut work.unsure);
        }
        counts.unsure = unsure.iter().map(|[_, lo, hi]| (hi - lo) as u64).sum();
        if show == Show::Light {
            let rays = Rays { scene: self.scene, camera, looks: &self.looks, width, height, start };
            rays.shade(&unsure, pixels, SKY_COLOR);
        }
        counts
    }

    /// The cell of the eye. Where that is in a solid, every pixel is left to rays.
    fn start(&self, camera: &Camera) -> Option<u32> {
        cell_of_eye(self.scene, camera)
    }
}

/// The cell in the air of which the eye is; none in a solid.
pub(crate) fn cell_of_eye(scene: &Scene, camera: &Camera) -> Option<u32> {
    scene.free_cell(camera.eye()).or_else(|| match scene.locate(camera.eye()) {
        Place::Air { cell, .. } => Some(cell),
        Place::Outside => Some(0),
        Place::InSolid(_) => None,
    })
}

impl Shot<'_> {
    /// Paints all rows, by bands.
    fn bands(&self, pixels: &mut [u32]) {
        let size = BAND * self.width as usize;
        #[cfg(feature = "rayon")]
        if rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            pixels.par_chunks_mut(size).enumerate().for_each(|(index, band)| self.band(index, band));
            return;
        }
        pixels.chunks_mut(size).enumerate().for_each(|(index, band)| self.band(index, band));
    }

    fn band(&self, index: usize, pixels: &mut [u32]) {
        let works = || self.beams.works.lock().unwrap_or_else(PoisonError::into_inner);
        let work = works().pop();
        let mut work = work.unwrap_or_else(Work::new);
        work.band(self, (index * BAND) as i32, pixels);
        works().push(work);
    }
}

impl Work {
    fn new() -> Work {
        let (near, touched, rows, unsure) = Default::default();
        Work { space: Space::new(), near, touched, rows, unsure, counts: BeamCounts::default() }
    }

    /// Paints a band of rows from the `first` on.
    fn band(&mut self, shot: &Shot<'_>, first: i32, pixels: &mut [u32]) {
        let beams = shot.beams;
        let (tables, width) = (&beams.scene.tables, shot.width as usize);
        let rows = pixels.len() / width;
        // What is near holds only where it is touched.
        self.near.resize(rows * Cover::blocks(width), [0.0; WIDE]);
        self.touched.clear();
        self.touched.resize(rows * Cover::blocks(width), false);
        self.rows.clear();
        self.rows.resize(rows, false);
        let mut detail = Detail::new(tables, shot.internal);
        let cover = Cover {
            width,
            top: first,
            pixels,
            near: &mut self.near,
            touched: &mut self.touched,
            rows: &mut self.rows,
        };
        let mut canvas = Canvas {
            tables,
            kernels: beams.kernels,
            show: shot.show,
            cover,
            looks: &beams.looks,
            square: square(&shot.screen),
            sky: SKY_COLOR,
            unsure: &mut self.unsure,
            detail: &mut detail,
            triangles: 0,
            spans: 0,
        };
        let mut walker =
            Walker::new(tables, &shot.screen, beams.kernels, &mut self.space, &mut canvas, &beams.partings);
        walker.around = if beams.is_whole && shot.start != Some(0) { NONE } else { tables.cells[0].root };
        walker.band(width as i32, [first, first + rows as i32], shot.start);
        self.counts.spans += canvas.spans;
        self.counts.triangles += canvas.triangles;
        self.counts.cells += self.space.cells;
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
