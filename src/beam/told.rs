//! What each pixel shows as a hit, as its ray would tell it.

use enfilade_importers::Role;

use super::{Surface, shade};
use crate::render::{Camera, Pinhole};
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Starts, Want};

/// What is met at distances that differ by no more than this, for each metre and one, is met in one place.
const SAME: f64 = 1e-9;

/// Rays that are asked together: more would take memory, and no less time.
const TOGETHER: usize = 1 << 16;

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

    /// Whether the ray of a pixel, which comes to the plane of what the pixel shows at `t`, meets that itself.
    fn is_met(&self, scene: &Scene, index: usize, ray: &Ray, t: f64) -> bool {
        match Surface::of(self.surfaces[index]) {
            Surface::Source(source) => scene.is_met(ray, t, (NONE, source)),
            Surface::Triangle(triangle) => scene.is_met(ray, t, (triangle, NONE)),
            Surface::Sky | Surface::Unsure => false,
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

impl Told {
    /// Leaves to rays what the cells of a picture so many pixels wide tell wrongly, and counts it: cells are rounded, walls that lean by less than a millimetre to
    /// upright ones, so that along their edges pixels may show what is in front of them, or behind, or beside in the same plane. Where walls, floors and ceilings border on something else rays are asked, and for each pixel
    /// that shows what none beside it does, and on from each that shows something else than its ray meets.
    pub(crate) fn settle(&mut self, scene: &Scene, pinhole: &Pinhole, width: u32, starts: Starts<'_>) -> u64 {
        let around = |index: usize| {
            let (width, count) = (width as usize, self.surfaces.len());
            let left = (!index.is_multiple_of(width)).then(|| index - 1);
            let right = (!(index + 1).is_multiple_of(width)).then(|| index + 1);
            let below = Some(index + width).filter(|&below| below < count);
            [left, right, index.checked_sub(width), below].into_iter().flatten()
        };
        let is_face = |surface: u32| match Surface::of(surface) {
            Surface::Source(_) => true,
            Surface::Triangle(triangle) => {
                scene.tables.elements[scene.triangle_element(triangle) as usize].role == Role::Solid as u32
            }
            Surface::Sky | Surface::Unsure => false,
        };
        let is_border = |&index: &usize| {
            let own = self.surfaces[index];
            // By itself it may be through a corner, of what no pixel beside shows.
            let is_alone = own != shade::UNSURE && around(index).all(|beside| self.surfaces[beside] != own);
            is_alone
                || around(index).any(|beside| {
                    let other = self.surfaces[beside];
                    other != own && (is_face(own) || is_face(other))
                })
        };
        let mut asked: Vec<usize> = (0..self.surfaces.len()).filter(is_border).collect();
        let mut is_asked = vec![false; self.surfaces.len()];
        let (mut rays, mut hits, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
        while !asked.is_empty() {
            asked.iter().for_each(|&index| is_asked[index] = true);
            let mut next = Vec::new();
            for asked in asked.chunks(TOGETHER) {
                rays.clear();
                rays.extend(asked.iter().map(|&index| {
                    pinhole.ray((index % width as usize) as u32, (index / width as usize) as u32)
                }));
                hits.resize(rays.len(), Hit::ESCAPED);
                scene.trace_many_of(starts, &rays, &mut hits, Want::LEAST);
                for ((&index, ray), hit) in asked.iter().zip(&rays).zip(&hits) {
                    let Some(shown) = self.hit(scene, index, ray, Want::LEAST) else { continue };
                    // Of what lies on each other either is right; of two things side by side, flush, the one that is there.
                    let is_one = shown.element == hit.element && shown.material == hit.material;
                    let is_right =
                        is_same(&shown, hit) && (is_one || self.is_met(scene, index, ray, shown.t));
                    if !is_right {
                        wrong.push(index);
                        next.extend(around(index).filter(|&beside| !is_asked[beside]));
                    }
                }
            }
            next.sort_unstable();
            next.dedup();
            asked = next;
        }
        wrong.iter().for_each(|&index| self.surfaces[index] = shade::UNSURE);
        wrong.len() as u64
    }
}

/// Whether two hits are in one place.
fn is_same(one: &Hit, other: &Hit) -> bool {
    // What is infinite is the same as nothing else.
    one.t == other.t || other.t.is_finite() && (one.t - other.t).abs() <= SAME * (1.0 + other.t)
}

/// All pixels of the picture that `camera` takes, so many pixels wide and high, each with its ray.
pub(crate) fn pixels(camera: &Camera, width: u32, height: u32) -> impl Iterator<Item = (usize, Ray)> {
    let pinhole = camera.pinhole(width, height);
    let places = (0..height).flat_map(move |y| (0..width).map(move |x| (x, y)));
    places.map(move |(x, y)| pinhole.ray(x, y)).enumerate()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_escapes_is_not_the_same_as_what_is_met() {
        let met = Hit { t: 3.0, triangle: 1, ..Hit::ESCAPED };
        assert!(!is_same(&met, &Hit::ESCAPED) && !is_same(&Hit::ESCAPED, &met));
        assert!(is_same(&Hit::ESCAPED, &Hit::ESCAPED) && is_same(&met, &Hit { t: 3.0 + 1e-10, ..met }));
        assert!(!is_same(&met, &Hit { t: 3.001, ..met }) && !is_same(&met, &Hit::in_solid(1, 0)));
    }
}
