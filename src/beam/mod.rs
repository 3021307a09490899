//! Pictures by exact beams: what every pixel's ray meets first, without a ray for each.
//!
//! A picture is one beam from the eye. In each convex cell a beam is split by straight lines of the picture into those that leave
//! through each face, kept as one interval of columns a row, and follows the portals (see `docs/BEAMS.md`).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
pub(crate) mod backs;
pub(crate) mod check;
pub(crate) mod cover;
pub(crate) mod cut;
pub(crate) mod detail;
mod facets;
pub(crate) mod fringe;
pub(crate) mod glass;
#[cfg(all(test, feature = "compile"))]
mod glass_tests;
mod hull;
pub(crate) mod joined;
pub(crate) mod kernels;
pub(crate) mod outer;
pub(crate) mod parting;
pub(crate) mod rays;
pub(crate) mod rows;
pub(crate) mod screen;
pub(crate) mod shade;
mod sight;
pub(crate) mod simd;
#[cfg(all(test, feature = "compile"))]
pub(crate) mod tests;
pub(crate) mod told;
mod touch;
pub(crate) mod walk;
pub(crate) mod wide;

use std::ops::{AddAssign, Deref};
use std::sync::{Mutex, PoisonError};

use backs::{Backs, Hidden};
pub use check::Differences;
pub(crate) use check::UNWRITTEN;
use cover::Depths;
use detail::Detail;
use facets::Facets;
use fringe::Edges;
use glass::Layers;
use hull::Hull;
use joined::{Joined, Once};
use kernels::Kernels;
use outer::Outer;
use rays::Rays;
use screen::Screen;
use shade::{Canvas, Looks, Show, square};
pub(crate) use told::Told;
use walk::{AROUND, Around, Known, Space, Walker};

use enfilade_importers::Semantic;
use glam::DVec3;

use crate::format::records::CellRecord;
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, Kernel, NONE, Place, Prisms, Want};

/// Rows that are painted together at most: of fewer what is the same for each band takes longer, of more what is written comes back from a cache farther away.
const BAND: usize = 512;

/// Rows of which is told together what each pixel shows: the same for any number of threads, as `render` counts what that took.
const TOLD: usize = 256;

/// An eye that is farther inside of its cell than so many times what eyes are moved by is at no border, and as far from a surface does not touch it.
const CLEAR: f64 = 13.0;

/// The colour of what lies around.
pub(crate) const SKY_COLOR: u32 = 0xfff5_ddc8;

/// What a picture took. Each band of rows counts by itself, and [`Beams::paint`] makes more of them where more threads share the work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamCounts {
    /// Cells, each as often as a beam came through.
    pub cells: u64,
    /// Parts of rows.
    pub spans: u64,
    /// Triangles drawn.
    pub triangles: u64,
    /// Pixels of which the cells did not tell what they show, or not to a pixel where an edge is: left to rays.
    pub unsure: u64,
}

impl AddAssign for BeamCounts {
    fn add_assign(&mut self, other: BeamCounts) {
        self.cells += other.cells;
        self.spans += other.spans;
        self.triangles += other.triangles;
        self.unsure += other.unsure;
    }
}

/// Makes pictures of one scene, of which it has a reference, or an [`Arc`](std::sync::Arc), with what it needs kept from one to the next.
pub struct Beams<S> {
    scene: S,
    kept: Kept,
    /// The cell of the last eye: the next is likely there, too.
    last: u32,
    many: Many,
}

/// What is worth it only for many pictures.
struct Many {
    /// Pictures so far for which it is of use.
    pictures: u32,
    /// None, too, where it cannot be made.
    facets: Option<Facets>,
}

/// What is kept from picture to picture.
struct Kept {
    kernels: Kernels,
    known: Known,
    looks: Looks,
    /// Not in use.
    works: Mutex<Vec<Work>>,
    joined: Joined,
    outer: Outer,
    hull: Hull,
    backs: Backs,
    /// So that from outside all triangles are drawn, not cell by cell.
    is_cut_up: bool,
}

/// What a thread needs for a band.
struct Work {
    space: Space,
    depths: Depths,
    layers: Layers,
    once: Once,
    unsure: Vec<[i32; 3]>,
    edges: Edges,
    counts: BeamCounts,
}

/// A picture under way.
struct Shot<'s> {
    screen: Screen,
    /// Along the internal frame's axes.
    internal: Screen,
    width: u32,
    height: u32,
    show: Show,
    /// The cell of the eye; none in a solid.
    start: Option<u32>,
    scene: &'s Scene,
    kept: &'s Kept,
    hidden: Hidden<'s>,
    /// The polygons of the scene, if they are to be drawn from these.
    facets: Option<&'s Facets>,
}

impl<S: Deref<Target = Scene>> Beams<S> {
    /// For pictures of this scene.
    pub fn new(scene: S) -> Beams<S> {
        let looks = Looks::new(&scene.tables);
        let kernel = Kernel::avx512().unwrap_or(Kernel::best());
        let kept = Kept {
            kernels: Kernels(kernel),
            known: Known::new(scene.tables.cells.len()),
            works: Mutex::new(Vec::new()),
            joined: Joined::new(scene.tables.runs.len()),
            outer: Outer::new(&scene),
            hull: Hull::new(),
            backs: Backs::new(&scene.tables, &looks),
            looks,
            is_cut_up: is_cut_up(&scene),
        };
        Beams { scene, kept, last: NONE, many: Many { pictures: 0, facets: None } }
    }

    /// The same by this kernel.
    pub fn with_kernel(mut self, kernel: Kernel) -> Beams<S> {
        self.kept.kernels = Kernels(kernel);
        self
    }

    /// The same, with what is behind glass seen through it in [`Beams::paint`]: behind all that has a material that lets light pass, each triangle a layer
    /// that hides a share and takes its colour, as in [`render`](crate::render::render). Else, and in all other pictures, what is seen first counts.
    pub fn through_glass(mut self) -> Beams<S> {
        let tables = &self.scene.tables;
        self.kept.looks = Looks::through_glass(tables);
        self.kept.backs = Backs::new(tables, &self.kept.looks);
        self.many = Many { pictures: 0, facets: None };
        self
    }

    /// Paints the picture that `camera` takes over `pixels`, of which there are `width` by some height: eight-bit RGBA, red in the lowest bits, the
    /// only light a lamp at the eye. What is bright is so to within one of the 255 steps, and may differ by as much from kernel to kernel.
    ///
    /// The fifth picture from outside, or of a large scene one of those that follow, takes some tens of milliseconds longer, and all after that a fourth
    /// to a half less; of more than half a million triangles only where the air around is cut up.
    ///
    /// With the feature `rayon` the rows are shared among the threads of the current pool.
    pub fn paint(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Light)
    }

    /// Writes over `pixels`, of which there are `width` by some height, what each shows: see [`Surface::of`]. Of those nearer to an edge than cells are rounded
    /// that is left to rays: [`Surface::Unsure`].
    pub fn surfaces(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Surfaces)
    }

    /// Writes over `pixels`, of which there are `width` by some height, the cell in which the ray of each ends: 0 where it leaves them all, and
    /// no cell's number where rays are to tell.
    pub fn cells(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> BeamCounts {
        self.show(camera, width, pixels, Show::Cells)
    }

    /// Writes over `hits`, of which there are `width` by some height, what the ray of each pixel meets, as
    /// [`Scene::trace_many_of`] would; those that beams do not tell are traced, and those on edges of walls, floors and ceilings held against their rays. Where triangles
    /// lie on each other, or nearer to each other than f32 tells depths apart, any of them may be told.
    ///
    /// With the feature `rayon` the pixels are shared among the threads of the current pool.
    pub fn hits(&mut self, camera: &Camera, width: u32, want: Want, hits: &mut [Hit]) -> BeamCounts {
        self.hits_as(camera, width, (want, true), hits)
    }

    /// The same of what [`Beams::paint`] shows, which is held against rays only where cells are rounded by as much as pixels are from edges.
    #[cfg(feature = "compile")]
    pub(crate) fn painted_hits(&mut self, camera: &Camera, width: u32, want: Want, hits: &mut [Hit]) {
        self.hits_as(camera, width, (want, false), hits);
    }

    fn hits_as(
        &mut self,
        camera: &Camera,
        width: u32,
        (want, is_settled): (Want, bool),
        hits: &mut [Hit],
    ) -> BeamCounts {
        let height = hits.len().checked_div(width as usize).unwrap_or(0) as u32;
        if height == 0 {
            return BeamCounts::default();
        }
        let (told, counts) = if is_settled {
            self.tell(camera, width, height)
        } else {
            self.tell_roughly(camera, width, height)
        };
        let starts = self.scene.starts_at(camera.eye(), self.last);
        let hits = &mut hits[..told.surfaces.len()];
        told.all_hits(&self.scene, (&camera.pinhole(width, height), width), (want, starts), hits);
        counts
    }

    /// What each pixel of a picture shows, and the cell in which its ray ends.
    pub(crate) fn tell(&mut self, camera: &Camera, width: u32, height: u32) -> (Told, BeamCounts) {
        let (mut told, mut counts) = self.tell_roughly(camera, width, height);
        let starts = self.scene.starts_at(camera.eye(), self.last);
        counts.unsure += told.settle(&self.scene, &camera.pinhole(width, height), width, starts);
        (told, counts)
    }

    /// The same, not held against rays.
    fn tell_roughly(&mut self, camera: &Camera, width: u32, height: u32) -> (Told, BeamCounts) {
        let count = width as usize * height as usize;
        let mut told = Told { surfaces: vec![0; count], cells: vec![0; count] };
        let counts = self.show(camera, width, &mut told.surfaces, Show::Surfaces);
        self.show(camera, width, &mut told.cells, Show::Cells);
        (told, counts)
    }

    fn show(&mut self, camera: &Camera, width: u32, pixels: &mut [u32], show: Show) -> BeamCounts {
        let height = pixels.len().checked_div(width as usize).unwrap_or(0) as u32;
        if height == 0 {
            return BeamCounts::default();
        }
        let prisms = Prisms::new(&self.scene.tables);
        let stand = stand(&self.scene, camera, self.last);
        let (start, aside) = stand.map_or((None, DVec3::ZERO), |(cell, aside)| (Some(cell), aside));
        self.last = start.unwrap_or(NONE);
        let screen = Screen::new(&camera.pinhole(width, height), &prisms, aside);
        let (scene, internal): (&Scene, _) = (&self.scene, screen.internal(&prisms));
        let (kept, hidden) = (&self.kept, self.kept.backs.seen_from(&scene.tables, internal.eye));
        let mut shot =
            Shot { internal, screen, width, height, show, start, scene, kept, hidden, facets: None };
        if show == Show::Light && (shot.is_all() || shot.is_outside() && Many::are_few_enough(scene)) {
            shot.facets = self.many.facets(scene, kept);
        }
        shot.bands(pixels);
        let mut counts = BeamCounts::default();
        let (mut unsure, mut edges) = (Vec::new(), Edges::default());
        for work in self.kept.works.get_mut().unwrap_or_else(PoisonError::into_inner) {
            counts += std::mem::take(&mut work.counts);
            unsure.append(&mut work.unsure);
            edges.append(&mut work.edges);
        }
        let starts = self.scene.starts_at(camera.eye(), self.last);
        let rays = Rays { scene: &self.scene, camera, looks: &self.kept.looks, width, height, starts };
        counts.unsure = rays.tell(&unsure, edges, pixels, show);
        counts
    }
}

/// The cell of the eye, and what it is moved by along the lattice's axes, so that it is in no plane: not out of that cell. Where [rays](sees_by_rays) are to tell of
/// every pixel, or it is in a solid, there is none.
/// It is perhaps in the cell `last`.
pub(crate) fn stand(scene: &Scene, camera: &Camera, last: u32) -> Option<(u32, DVec3)> {
    if sees_by_rays(scene, camera) {
        return None;
    }
    let near = scene.free_cell_near(camera.eye(), last);
    let cell = near.or_else(|| match scene.locate(camera.eye()) {
        Place::Air { cell, .. } => Some(cell),
        Place::Outside => Some(AROUND),
        Place::InSolid(_) => None,
    })?;
    let (prisms, aside) = (Prisms::new(&scene.tables), screen::aside(scene));
    let (eye, cells) = (prisms.local(DVec3::from(camera.eye())), prisms.cells);
    let is_within = || {
        let record = &cells[cell as usize];
        record.kind == CellRecord::AIR && prisms.outside(record, eye) < -CLEAR * aside.x
    };
    if cell == AROUND || is_within() {
        return Some((cell, aside));
    }
    // On a border: into that of the eight parts of the space around which is air.
    let sign = |part: u32, axis: u32| if part >> axis & 1 == 0 { 1.0 } else { -1.0 };
    let to = |part: u32| aside * DVec3::new(sign(part, 0), sign(part, 1), sign(part, 2));
    let mut air = (0..8).filter_map(|part| {
        let cell = prisms.place(eye + to(part), 0.0)?;
        (cells[cell as usize].kind == CellRecord::AIR).then_some((cell, to(part)))
    });
    Some(air.next().unwrap_or((cell, aside)))
}

/// Whether rays are to tell of every pixel: where cells are coarser than the tolerance, what they tell of a picture's edges is off by as much; and an eye that
/// touches a surface may be in a cell on its other side.
pub(crate) fn sees_by_rays(scene: &Scene, camera: &Camera) -> bool {
    let step = scene.tables.scene[0].lattice_step();
    let margin = step.max(CLEAR * screen::aside(scene).x);
    scene.tolerance() < 2.0 * step || touch::is_touched(scene, DVec3::from(camera.eye()), margin)
}

/// Whether a cell is of the air around the building, or is all that is around the prisms.
fn is_exterior(prisms: &Prisms<'_>, cell: u32) -> bool {
    let record = &prisms.cells[cell as usize];
    cell == AROUND || record.kind == CellRecord::AIR && record.semantic == Semantic::Exterior as u16
}

/// Whether the air around a building is in so many cells that beams come to each of them from many sides: it takes about the square of how many there are,
/// and to draw all triangles, from near to far, as many as these.
fn is_cut_up(scene: &Scene) -> bool {
    let prisms = Prisms::new(&scene.tables);
    let count = (0..prisms.cells.len() as u32).filter(|&cell| is_exterior(&prisms, cell)).count();
    count.saturating_mul(count) > scene.detail_triangle_count() as usize
}

impl Many {
    /// Before so many pictures no polygons are gathered: that takes as long as some dozens of pictures, and saves a fourth to a half of each that follows.
    fn few(scene: &Scene) -> u32 {
        /// To gather so many takes some ten milliseconds.
        const MANY: u32 = 1 << 14;
        (scene.detail_triangle_count() / MANY).max(4)
    }

    /// Whether to draw all polygons is faster than cell by cell. Of a tower of a million triangles it is not: from outside it shows ten thousands of polygons.
    fn are_few_enough(scene: &Scene) -> bool {
        scene.detail_triangle_count() <= 1 << 19
    }

    fn facets(&mut self, scene: &Scene, kept: &Kept) -> Option<&Facets> {
        self.pictures = self.pictures.saturating_add(1);
        if self.pictures == Many::few(scene) + 1 {
            self.facets = Facets::new(&scene.tables, &kept.joined, &kept.looks, &kept.backs);
        }
        self.facets.as_ref()
    }
}

impl Shot<'_> {
    /// Paints all rows, by bands.
    fn bands(&self, pixels: &mut [u32]) {
        #[cfg(feature = "rayon")]
        if rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            let rows =
                if self.show == Show::Light { self.rows(pixels, rayon::current_num_threads()) } else { TOLD };
            let bands = pixels.par_chunks_mut(rows * self.width as usize).enumerate();
            bands.for_each(|(index, band)| self.band(index * rows, band));
            return;
        }
        let rows = if self.show == Show::Light { BAND } else { TOLD };
        let bands = pixels.chunks_mut(rows * self.width as usize).enumerate();
        bands.for_each(|(index, band)| self.band(index * rows, band));
    }

    /// Rows of a band, where threads share the work: so many that each thread has some bands, which take unlike times.
    #[cfg(feature = "rayon")]
    fn rows(&self, pixels: &[u32], threads: usize) -> usize {
        /// What is the same for each band takes too long for fewer.
        const LEAST: usize = 64;
        // Each band looks at all triangles.
        let bands = if self.is_all() { 2 } else { 4 };
        let height = pixels.len() / self.width as usize;
        height.div_ceil(bands * threads).next_multiple_of(wide::ROWS).clamp(LEAST, BAND)
    }

    /// Whether the eye is in the air around the building.
    fn is_outside(&self) -> bool {
        let prisms = Prisms::new(&self.scene.tables);
        self.start.is_some_and(|cell| is_exterior(&prisms, cell))
    }

    /// Whether all triangles are drawn, not cell by cell.
    fn is_all(&self) -> bool {
        if self.facets.is_some() {
            return true;
        }
        let prisms = Prisms::new(&self.scene.tables);
        let cut_up =
            |cell: u32| self.kept.is_cut_up && self.show != Show::Cells && is_exterior(&prisms, cell);
        self.start.is_some_and(|cell| {
            cut_up(cell) || cell == AROUND && (prisms.hold(self.screen.eye) || prisms.cells.len() == 1)
        })
    }

    fn band(&self, first: usize, pixels: &mut [u32]) {
        let works = || self.kept.works.lock().unwrap_or_else(PoisonError::into_inner);
        let work = works().pop();
        let mut work = work.unwrap_or_else(Work::new);
        work.band(self, first as i32, pixels);
        works().push(work);
    }
}

impl Work {
    fn new() -> Work {
        let (unsure, edges, counts) = Default::default();
        Work {
            space: Space::new(),
            depths: Depths::new(),
            layers: Layers::new(),
            once: Once::new(),
            unsure,
            edges,
            counts,
        }
    }

    /// Paints a band of rows from the `first` on.
    fn band(&mut self, shot: &Shot<'_>, first: i32, pixels: &mut [u32]) {
        let (kept, tables, width) = (shot.kept, &shot.scene.tables, shot.width as usize);
        let rows = pixels.len() / width;
        let mut detail = Detail::new(tables, shot.internal, &shot.hidden, &mut self.once);
        let cover = self.depths.cover(width, first, pixels);
        if kept.looks.has_glass() && shot.show == Show::Light {
            self.layers.resize(&cover);
        }
        let mut canvas = Canvas {
            tables,
            kernels: kept.kernels,
            show: shot.show,
            cover,
            looks: &kept.looks,
            joined: &kept.joined,
            facets: shot.facets,
            square: square(&shot.screen),
            sky: SKY_COLOR,
            layers: &mut self.layers,
            unsure: &mut self.unsure,
            edges: &mut self.edges,
            detail: &mut detail,
            triangles: 0,
            spans: 0,
        };
        let (start, around) = match shot.start {
            _ if shot.is_all() => (Some(AROUND), Around::All(tables.cells[AROUND as usize].root)),
            Some(AROUND) => (shot.start, Around::Entered(&kept.outer, &kept.hull)),
            start => (start, Around::Outer(&kept.outer)),
        };
        let mut walker = Walker::new(
            tables,
            &shot.screen,
            kept.kernels,
            &mut self.space,
            &mut canvas,
            (&kept.known, around),
        );
        walker.band([shot.width, shot.height], [first, first + rows as i32], start);
        canvas.melt();
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
