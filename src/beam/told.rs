//! What each pixel shows as a hit, as its ray would tell it.

use super::Surface;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Want};

/// What the beams tell of each pixel of a picture: what it shows, and the cell in which its ray ends.
pub(crate) struct Told {
    pub(super) surfaces: Vec<u32>,
    pub(super) cells: Vec<u32>,
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
}
