//! What is verified.

use crate::scene::Scene;
use crate::trace::{Hit, Ray, Want};

/// What answers rays, from many threads at once: a scene, a function that traces, or that and one that tells what is occluded.
pub trait Tracer: Sync {
    /// Writes the record of `rays[i]`'s answer to `hits[i]`.
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Whether anything is in the way of each ray, as many answers as rays; `None` if it cannot tell.
    fn occluded(&self, rays: &[Ray]) -> Option<Vec<bool>> {
        let _ = rays;
        None
    }
}

impl Tracer for Scene {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.trace_many(rays, hits, Want::LEAST);
    }

    fn occluded(&self, rays: &[Ray]) -> Option<Vec<bool>> {
        Some(sees(self, rays))
    }
}

impl<T: Fn(&[Ray], &mut [Hit]) + Sync> Tracer for T {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self(rays, hits);
    }
}

impl<T: Fn(&[Ray], &mut [Hit]) + Sync, O: Fn(&[Ray]) -> Vec<bool> + Sync> Tracer for (T, O) {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.0(rays, hits);
    }

    fn occluded(&self, rays: &[Ray]) -> Option<Vec<bool>> {
        Some(self.1(rays))
    }
}

/// Whether anything in a scene is in the way of each ray. Half of them are asked about a few at a time, which scattered rays together are
/// not: so by other ways through the library.
pub fn sees(scene: &Scene, rays: &[Ray]) -> Vec<bool> {
    /// As few as batches take together, wherever they start.
    const FEW: usize = 40;
    let mut occluded = vec![false; rays.len()];
    let half = rays.len() / 2;
    let ((many, few), (to_many, to_few)) = (rays.split_at(half), occluded.split_at_mut(half));
    scene.occluded_many(many, to_many);
    for (rays, to) in few.chunks(FEW).zip(to_few.chunks_mut(FEW)) {
        scene.occluded_many(rays, to);
    }
    occluded
}
