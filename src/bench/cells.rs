//! How many cells rays cross: what a partition is good for, the same on every machine.

use serde::Serialize;

use super::speed::random_rays;
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Place, Ray, Start, Want};

/// Which rays to count.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CrossingOptions {
    /// Width and height of the frames.
    pub size: (u32, u32),
    /// Random rays, beside the frames.
    pub random_rays: u32,
    /// Seed of the random rays.
    pub seed: u64,
}

impl Default for CrossingOptions {
    fn default() -> CrossingOptions {
        CrossingOptions { size: (256, 256), random_rays: 1 << 17, seed: 1 }
    }
}

/// Prisms that rays come to, the first one included.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Crossings {
    /// Rays of frames from inside.
    pub primary_rays: u64,
    /// Cells a ray of a frame.
    pub primary: f64,
    /// Cells of all rays of frames.
    pub primary_cells: u64,
    /// Cells a random ray in rooms.
    pub random: f64,
    /// Share of the random rays that the cells could not answer.
    pub unsure: f64,
}

/// Counts the cells that rays of the frames of `views` cross, as far as their cameras stand in air, and random rays in rooms.
pub fn crossings(scene: &Scene, views: &[Camera], options: &CrossingOptions) -> Crossings {
    let (width, height) = options.size;
    let mut primary = Tally::default();
    for camera in views {
        let Place::Air { cell, .. } = scene.locate(camera.eye()) else { continue };
        let pinhole = camera.pinhole(width, height);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        pixels.for_each(|(x, y)| primary.count(scene, Start::Cell(cell), &pinhole.ray(x, y)));
    }
    let mut random = Tally::default();
    for ray in random_rays(scene, options.random_rays, options.seed) {
        random.count(scene, Start::Anywhere, &ray);
    }
    Crossings {
        primary_rays: primary.rays,
        primary: primary.mean(),
        primary_cells: primary.cells,
        random: random.mean(),
        unsure: random.unsure as f64 / random.rays.max(1) as f64,
    }
}

#[derive(Default)]
struct Tally {
    rays: u64,
    cells: u64,
    unsure: u64,
}

impl Tally {
    fn count(&mut self, scene: &Scene, start: Start<'_>, ray: &Ray) {
        let (_, cost) = scene.trace_cost_from(start, ray, Want::default());
        self.rays += 1;
        self.cells += u64::from(cost.cells);
        self.unsure += u64::from(cost.unsure > 0);
    }

    fn mean(&self) -> f64 {
        self.cells as f64 / self.rays.max(1) as f64
    }
}
