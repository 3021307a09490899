//! What is verified.

use crate::scene::Scene;
use crate::trace::{Hit, Ray, Want};

/// What answers rays, from many threads at once: a scene, a function that traces, or that and one that tells what is occluded.
pub trait Tracer: Sync {
    /// Writes the record of `rays[i]`'s answer to `hits[i]`.
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]);

    /// Writes whether anything is in the way of `rays[i]` to `occluded[i]`; false if it cannot tell.
    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) -> bool {
        let _ = (rays, occluded);
        false
    }
}

impl Tracer for Scene {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.trace_many(rays, hits, Want::LEAST);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) -> bool {
        self.occluded_many(rays, occluded);
        true
    }
}

impl<T: Fn(&[Ray], &mut [Hit]) + Sync> Tracer for T {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self(rays, hits);
    }
}

impl<T: Fn(&[Ray], &mut [Hit]) + Sync, O: Fn(&[Ray], &mut [bool]) + Sync> Tracer for (T, O) {
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.0(rays, hits);
    }

    fn occluded(&self, rays: &[Ray], occluded: &mut [bool]) -> bool {
        self.1(rays, occluded);
        true
    }
}
