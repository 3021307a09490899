//! Many rays at once, into the caller's own buffers.

use super::ray::{Hit, Ray};
use super::single::{Start, Want};
use crate::scene::Scene;

/// Rays that one task takes at a time.
#[cfg(feature = "rayon")]
const CHUNK: usize = 1024;

/// Calls `each` with every pair of the slices, on all threads of the current rayon pool.
fn for_each_pair<R: Sync, A: Send>(rays: &[R], answers: &mut [A], each: impl Fn(&R, &mut A) + Sync) {
    assert_eq!(rays.len(), answers.len(), "as many answers as rays");
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        if rays.len() > CHUNK {
            rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).for_each(|(rays, answers)| {
                rays.iter().zip(answers).for_each(|(ray, answer)| each(ray, answer));
            });
            return;
        }
    }
    rays.iter().zip(answers).for_each(|(ray, answer)| each(ray, answer));
}

impl Scene {
    /// What each ray meets first; `hits[i]` is the record of `rays[i]` (see [`Hit::answer`]).
    ///
    /// With the feature `rayon` the work is shared among the threads of the current pool: call it inside
    /// `ThreadPool::install` to use your own. The answers do not depend on it.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn trace_many(&self, rays: &[Ray], hits: &mut [Hit], want: Want) {
        for_each_pair(rays, hits, |ray, hit| *hit = self.trace_from(Start::Anywhere, ray, want));
    }

    /// What each ray from the air of one cell meets first, as [`Scene::trace_many`]: origins are not looked up.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn trace_many_from(&self, cell: u32, rays: &[Ray], hits: &mut [Hit], want: Want) {
        for_each_pair(rays, hits, |ray, hit| *hit = self.trace_from(Start::Cell(cell), ray, want));
    }

    /// Whether anything stands in the way of each ray, see [`Scene::occluded`].
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        for_each_pair(rays, occluded, |ray, answer| *answer = self.occluded(ray));
    }
}
