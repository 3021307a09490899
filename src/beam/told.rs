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
        // Where all triangles are drawn, not cell by cell, the cells may be in doubt where the triangles are not.
        let cell = self.cells[index];
        if cell as usize >= scene.tables.cells.len() {
            return None;
        }
        match Surface::of(self.surfaces[index]) {
            Surface::Sky => Some(Hit::ESCAPED),
            Surface::Unsure => None,
            Surface::Source(source) => scene.hit_on_source(ray, cell, source, want),
            Surface::Triangle(triangle) => scene.hit_on_plane(ray, cell, (triangle, NONE), want),
        }
    }

    /// What the rays of some pixels of the picture meet, each with the pixel's place in it: as beams tell, or else by rays that start there.
    pub(crate) fn hits(
        &self,
        scene: &Scene,
        pixels: impl Iterator<Item = (usize, Ray)>,
        (want, starts): (Want, Starts<'_>),
        hits: &mut [Hit],
    ) {
        let (mut rays, mut missing) = (Vec::new(), Vec::new());
        for (at, ((index, ray), hit)) in pixels.zip(&mut *hits).enumerate() {
            match self.hit(scene, index, &ray, want) {
                Some(told) => *hit = told,
                None => {
                    rays.push(ray);
                    missing.push(at);
                }
            }
        }
        let mut traced = vec![Hit::ESCAPED; rays.len()];
        scene.trace_many_of(starts, &rays, &mut traced, want);
        for (at, hit) in missing.into_iter().zip(traced) {
            hits[at] = hit;
        }
    }
}

/// All pixels of the picture that `camera` takes, so many pixels wide and high, each with its ray.
pub(crate) fn pixels(camera: &Camera, width: u32, height: u32) -> impl Iterator<Item = (usize, Ray)> {
    let pinhole = camera.pinhole(width, height);
    let places = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    places.map(move |(x, y)| pinhole.ray(x, y)).enumerate()
}
