//! What each pixel shows as a hit, as its ray would tell it.

use super::Surface;
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Starts, Want};

/// What the beams tell of each pixel of a picture: what it shows, and the cell in which its ray ends.
pub(crate) struct Told {
    pub(crate) surfaces: Vec<u32>,
    pub(crate) cells: Vec<u32>,
}

impl Told {
    /// What the ray of a pixel, which is `ray`, meets; `None` where beams do not tell.
    pub(crate) fn hit(&self, scene: &Scene, index: usize, ray: &Ray, want: Want) -> Option<Hit> {
        let cell = self.cells[index];
        match Surface::of(self.surfaces[index]) {
            Surface::Sky => Some(Hit::ESCAPED),
            Surface::Unsure => None,
            Surface::Source(source) => scene.hit_on_source(ray, cell, source, want),
            Surface::Triangle(triangle) => scene.hit_on_plane(ray, cell, (triangle, NONE), want),
        }
    }

    /// What the rays of all pixels of the picture meet, which is `width` pixels wide: as beams tell, or else by rays that start there.
    pub(crate) fn hits(
        &self,
        scene: &Scene,
        camera: &Camera,
        width: u32,
        (want, starts): (Want, Starts<'_>),
        hits: &mut [Hit],
    ) {
        let pinhole = camera.pinhole(width, hits.len().checked_div(width as usize).unwrap_or(0) as u32);
        let (mut rays, mut missing) = (Vec::new(), Vec::new());
        for (index, hit) in hits.iter_mut().enumerate() {
            let ray = pinhole.ray(index as u32 % width, index as u32 / width);
            match self.hit(scene, index, &ray, want) {
                Some(told) => *hit = told,
                None => {
                    rays.push(ray);
                    missing.push(index);
                }
            }
        }
        let mut traced = vec![Hit::ESCAPED; rays.len()];
        scene.trace_many_of(starts, &rays, &mut traced, want);
        for (index, hit) in missing.into_iter().zip(traced) {
            hits[index] = hit;
        }
    }
}
