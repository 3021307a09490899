//! Pictures by packets of rays: what every pixel's ray meets first, told for many pixels at once.
//!
//! A packet is a rectangle of pixels. Where the rays of its corners leave a convex cell through one face, all of its rays do; else it is
//! split, and its parts go on from there (see `docs/PACKETS.md`).

mod band;
mod shot;
#[cfg(all(test, feature = "compile"))]
mod tests;
mod tree;
mod waiting;

use std::ops::Deref;
use std::sync::{Mutex, PoisonError};

use glam::DVec3;

pub(crate) use band::Band;
use band::{LARGEST, Packet};
use shot::{Shot, Show};
use tree::Tree;
use waiting::Waiting;

use crate::beam::backs::Backs;
use crate::beam::check::compare;
use crate::beam::cover::Depths;
use crate::beam::detail::Detail;
use crate::beam::fringe::Edges;
use crate::beam::glass::Layers;
use crate::beam::joined::{Joined, Once};
use crate::beam::kernels::Kernels;
use crate::beam::outer::Outer;
use crate::beam::rays::Rays;
use crate::beam::rows::Arena;
use crate::beam::screen::Screen;
use crate::beam::shade::{Canvas, Looks, square};
use crate::beam::walk::{AROUND, Known};
use crate::beam::{Differences, SKY_COLOR, Told, UNWRITTEN, simd, stand};
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, Kernel, NONE, Prisms, Want};

/// What a picture took. Of its pixels each is told by a packet as a whole, apart from others in a leaf, or by a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PacketCounts {
    /// Packets: those that the picture was cut into, and those that others were split into.
    pub packets: u64,
    /// Packets that were split.
    pub splits: u64,
    /// Packets that were too small to be split: whose pixels were told one by one.
    pub leaves: u64,
    /// Cells, each as often as a packet or a part of one came through.
    pub cells: u64,
    /// Pixels told by a packet as a whole, but for the triangles before it.
    pub whole: u64,
    /// Pixels told one by one in leaves, but for the triangles before them.
    pub apart: u64,
    /// Triangles drawn, each as often as a packet may show it.
    pub triangles: u64,
    /// Pixels left to rays.
    pub rays: u64,
}

/// Makes pictures of one scene, of which it has a reference, or an [`Arc`](std::sync::Arc), with what it needs kept from one to the next.
pub struct Packets<S> {
    scene: S,
    kept: Kept,
    /// Pictures made.
    shots: u64,
}

/// What is kept from picture to picture.
struct Kept {
    kernels: Kernels,
    known: Known,
    looks: Looks,
    backs: Backs,
    joined: Joined,
    /// Not in use.
    works: Mutex<Vec<Work>>,
    outer: Outer,
}

/// What a thread needs for a band.
struct Work {
    tree: Tree,
    /// Which picture the tree is of, and where rays start in it.
    shot: u64,
    root: u32,
    arena: Arena,
    waiting: Waiting,
    depths: Depths,
    once: Once,
    stack: Vec<Packet>,
    unsure: Vec<[i32; 3]>,
    edges: Edges,
    counts: PacketCounts,
}

impl<S: Deref<Target = Scene>> Packets<S> {
    /// For pictures of this scene.
    pub fn new(scene: S) -> Packets<S> {
        let looks = Looks::new(&scene.tables);
        let kept = Kept {
            kernels: Kernels(Kernel::avx512().unwrap_or(Kernel::best())),
            known: Known::new(scene.tables.cells.len()),
            backs: Backs::new(&scene.tables, &looks),
            joined: Joined::new(scene.tables.runs.len()),
            looks,
            works: Mutex::new(Vec::new()),
            outer: Outer::new(&scene),
        };
        Packets { scene, kept, shots: 0 }
    }

    /// The same by this kernel.
    pub fn with_kernel(mut self, kernel: Kernel) -> Packets<S> {
        self.kept.kernels = Kernels(kernel);
        self
    }

    /// Paints the picture that `camera` takes over `pixels`, of which there are `width` by some height: as
    /// [`Beams::paint`](crate::beam::Beams::paint) does.
    ///
    /// With the feature `rayon` the rows are shared among the threads of the current pool.
    pub fn paint(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> PacketCounts {
        self.show(camera, width, pixels, Show::Light)
    }

    /// Writes over `pixels`, of which there are `width` by some height, what each shows: see [`Surface::of`](crate::beam::Surface::of).
    pub fn surfaces(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> PacketCounts {
        self.show(camera, width, pixels, Show::Surfaces)
    }

    /// Writes over `pixels`, of which there are `width` by some height, the longer edge of the packet that told which face each shows, behind triangles
    /// in cells if there are any, pixels: 1 where it was told apart from others.
    pub fn sizes(&mut self, camera: &Camera, width: u32, pixels: &mut [u32]) -> PacketCounts {
        self.show(camera, width, pixels, Show::Sizes)
    }

    /// Writes over `hits`, of which there are `width` by some height, what the ray of each pixel meets, as
    /// [`Beams::hits`](crate::beam::Beams::hits) does.
    pub fn hits(&mut self, camera: &Camera, width: u32, want: Want, hits: &mut [Hit]) -> PacketCounts {
        self.hits_as(camera, width, (want, true), hits)
    }

    /// The same of what [`Packets::paint`] shows, which is held against rays only where cells are rounded by as much as pixels are from edges.
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
    ) -> PacketCounts {
        let height = hits.len().checked_div(width as usize).unwrap_or(0) as u32;
        if height == 0 {
            return PacketCounts::default();
        }
        let hits = &mut hits[..width as usize * height as usize];
        let mut surfaces = vec![UNWRITTEN; hits.len()];
        let mut counts = self.surfaces(camera, width, &mut surfaces);
        // In which cells rays end is looked for where they do.
        let mut told = Told { cells: vec![AROUND; surfaces.len()], surfaces };
        let starts = self.scene.starts_at(camera.eye(), NONE);
        let pinhole = camera.pinhole(width, height);
        if is_settled {
            counts.rays += told.settle(&self.scene, &pinhole, width, starts);
        }
        told.all_hits(&self.scene, (&pinhole, width), (want, starts), hits);
        counts
    }

    /// The longest edge of a packet, pixels.
    pub const LARGEST: u32 = LARGEST as u32;

    /// Compares the picture that `camera` takes with what the ray of each pixel meets.
    pub fn differences(&mut self, camera: &Camera, width: u32, height: u32) -> Differences {
        let mut pixels = vec![UNWRITTEN; width as usize * height as usize];
        self.surfaces(camera, width, &mut pixels);
        compare(&self.scene, camera, width, &pixels)
    }

    fn show(&mut self, camera: &Camera, width: u32, pixels: &mut [u32], show: Show) -> PacketCounts {
        let height = pixels.len().checked_div(width as usize).unwrap_or(0) as u32;
        if height == 0 {
            return PacketCounts::default();
        }
        self.shots += 1;
        let tables = &self.scene.tables;
        let prisms = Prisms::new(tables);
        let stand = stand(&self.scene, camera, NONE);
        let (start, aside) = stand.map_or((None, DVec3::ZERO), |(cell, aside)| (Some(cell), aside));
        let screen = Screen::new(&camera.pinhole(width, height), &prisms, aside);
        let (kept, internal) = (&self.kept, screen.internal(&prisms));
        let shot = Shot {
            number: self.shots,
            tables,
            prisms,
            internal,
            square: square(&screen),
            screen,
            kernels: kept.kernels,
            known: &kept.known,
            looks: &kept.looks,
            joined: &kept.joined,
            hidden: kept.backs.seen_from(tables, internal.eye),
            width,
            show,
            start,
            outer: &kept.outer,
        };
        kept.bands(&shot, pixels);
        let mut counts = PacketCounts::default();
        let (mut unsure, mut edges) = (Vec::new(), Edges::default());
        for work in self.kept.works.get_mut().unwrap_or_else(PoisonError::into_inner) {
            counts.add(&std::mem::take(&mut work.counts));
            unsure.append(&mut work.unsure);
            edges.append(&mut work.edges);
        }
        let starts = self.scene.starts_at(camera.eye(), NONE);
        let rays = Rays { scene: &self.scene, camera, looks: &self.kept.looks, width, height, starts };
        counts.rays = rays.tell(&unsure, edges, pixels, show.of_canvas());
        counts
    }
}

impl Kept {
    /// Makes all rows, by bands.
    fn bands(&self, shot: &Shot<'_>, pixels: &mut [u32]) {
        let size = LARGEST as usize * shot.width as usize;
        #[cfg(feature = "rayon")]
        if rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            pixels.par_chunks_mut(size).enumerate().for_each(|(index, band)| self.band(shot, index, band));
            return;
        }
        pixels.chunks_mut(size).enumerate().for_each(|(index, band)| self.band(shot, index, band));
    }

    fn band(&self, shot: &Shot<'_>, index: usize, pixels: &mut [u32]) {
        let works = || self.works.lock().unwrap_or_else(PoisonError::into_inner);
        let work = works().pop();
        let mut work = work.unwrap_or_else(|| Work::new(shot.prisms.cells.len()));
        work.band(shot, index as i32 * LARGEST, pixels);
        works().push(work);
    }
}

impl Work {
    fn new(cells: usize) -> Work {
        let (stack, unsure, edges, counts) = Default::default();
        let (tree, arena, waiting) = (Tree::new(cells), Arena::new(), Waiting::new());
        let (depths, once) = (Depths::new(), Once::new());
        Work { tree, shot: 0, root: 0, arena, waiting, depths, once, stack, unsure, edges, counts }
    }

    /// Makes a band of rows from the `first` on.
    fn band(&mut self, shot: &Shot<'_>, first: i32, pixels: &mut [u32]) {
        if self.shot != shot.number {
            self.shot = shot.number;
            self.root = self.tree.begin(shot);
        }
        let width = shot.width as usize;
        let rows = pixels.len() / width;
        self.waiting.begin(rows);
        let cover = self.depths.cover(width, first, pixels);
        let canvas = Canvas {
            tables: shot.tables,
            kernels: shot.kernels,
            show: shot.show.of_canvas(),
            cover,
            looks: shot.looks,
            joined: shot.joined,
            facets: None,
            square: shot.square,
            sky: SKY_COLOR,
            // Glass is opaque.
            layers: &mut Layers::new(),
            unsure: &mut self.unsure,
            edges: &mut self.edges,
            detail: &mut Detail::new(shot.tables, shot.internal, &shot.hidden, &mut self.once),
            triangles: 0,
            spans: 0,
        };
        let mut band = Band {
            shot,
            tree: &mut self.tree,
            canvas,
            arena: &mut self.arena,
            waiting: &mut self.waiting,
            root: self.root,
            stack: &mut self.stack,
            counts: PacketCounts::default(),
        };
        simd::packets(shot.kernels, &mut band);
        let counts = PacketCounts { triangles: band.canvas.triangles, ..band.counts };
        self.counts.add(&counts);
    }
}

impl PacketCounts {
    fn add(&mut self, other: &PacketCounts) {
        self.packets += other.packets;
        self.splits += other.splits;
        self.leaves += other.leaves;
        self.cells += other.cells;
        self.whole += other.whole;
        self.apart += other.apart;
        self.triangles += other.triangles;
        self.rays += other.rays;
    }
}
