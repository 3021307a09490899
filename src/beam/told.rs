//! What each pixel shows as a hit, as its ray would tell it.

use enfilade_importers::Role;

use super::fringe::around;
use super::{Surface, shade};
use crate::render::Pinhole;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Starts, Target, Want};

/// What is met at distances that differ by no more than this, for each metre and one, is met in one place.
const SAME: f64 = 1e-9;

/// Pixels that are told together: more would take memory, and no less time.
const TOGETHER: usize = 1 << 14;

/// What the beams tell of each pixel of a picture: what it shows, and the cell in which its ray ends.
pub(crate) struct Told {
    pub(crate) surfaces: Vec<u32>,
    pub(crate) cells: Vec<u32>,
}

/// What pixels show in one cell.
enum Shown<'s> {
    Sky,
    Unsure,
    Surface(Target<'s>),
}

impl Shown<'_> {
    /// What the ray of such a pixel meets; `None` where beams do not tell.
    #[inline]
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        match self {
            Shown::Sky => Some(Hit::ESCAPED),
            Shown::Unsure => None,
            Shown::Surface(target) => target.hit(ray),
        }
    }

    /// Whether such a ray, which comes to the plane of what the pixel shows at `t`, meets that itself.
    fn is_met(&self, ray: &Ray, t: f64) -> bool {
        matches!(self, Shown::Surface(target) if target.is_met(ray, t))
    }
}

impl Told {
    /// What pixels show whose surface and cell are these.
    fn shown<'s>(scene: &'s Scene, (surface, cell): (u32, u32), want: Want) -> Shown<'s> {
        // Where all triangles are drawn, not cell by cell, the cells may be in doubt where the triangles are not.
        if cell as usize >= scene.tables.cells.len() {
            return Shown::Unsure;
        }
        let target = match Surface::of(surface) {
            Surface::Sky => return Shown::Sky,
            Surface::Unsure => None,
            Surface::Source(source) => Target::source(scene, cell, source, want),
            Surface::Triangle(triangle) => Target::triangle(scene, cell, triangle, want),
        };
        target.map_or(Shown::Unsure, Shown::Surface)
    }

    /// What the rays of all pixels of a picture meet: as [`Told::hits`] has it.
    ///
    /// With the feature `rayon` the pixels are shared among the threads of the current pool.
    pub(crate) fn all_hits(
        &self,
        scene: &Scene,
        (pinhole, width): (&Pinhole, u32),
        want: (Want, Starts<'_>),
        hits: &mut [Hit],
    ) {
        let part = |(number, hits): (usize, &mut [Hit])| {
            let first = number * TOGETHER;
            self.hits(scene, pixels(pinhole, width, first..first + hits.len()), want, hits);
        };
        #[cfg(feature = "rayon")]
        {
            use rayon::prelude::*;
            hits.par_chunks_mut(TOGETHER).enumerate().for_each(part);
        }
        #[cfg(not(feature = "rayon"))]
        hits.chunks_mut(TOGETHER).enumerate().for_each(part);
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
        // Mostly that of the pixel before.
        let (mut last, mut shown) = ((shade::UNSURE, NONE), Shown::Unsure);
        for (at, ((index, ray), hit)) in pixels.zip(&mut *hits).enumerate() {
            let own = (self.surfaces[index], self.cells[index]);
            if own != last {
                (last, shown) = (own, Told::shown(scene, own, want));
            }
            match shown.hit(&ray) {
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
    /// The pixels of a picture so many pixels wide that show what no pixel beside does, or border on what does where either is of a wall, floor or ceiling.
    fn borders(&self, scene: &Scene, width: usize) -> Vec<usize> {
        let is_face = |surface: u32| match Surface::of(surface) {
            Surface::Source(_) => true,
            Surface::Triangle(triangle) => {
                scene.tables.elements[scene.triangle_element(triangle) as usize].role == Role::Solid as u32
            }
            Surface::Sky => false,
            // Mostly at the edge of one.
            Surface::Unsure => true,
        };
        let is_border = |index: usize| {
            let own = self.surfaces[index];
            // Its ray is asked anyway.
            if own == shade::UNSURE {
                return false;
            }
            let mut others = around(width, self.surfaces.len(), index).map(|beside| self.surfaces[beside]);
            // By itself it may be through a corner, of what no pixel beside shows.
            let is_alone = others.clone().all(|other| other != own);
            is_alone || others.any(|other| other != own && (is_face(own) || is_face(other)))
        };
        let count = self.surfaces.len();
        let row = |from: usize| &self.surfaces[from..from + width];
        let mut borders = Vec::new();
        for first in (0..count).step_by(width) {
            let own = row(first);
            let above = row(first.saturating_sub(width));
            let below = row(if first + width < count { first + width } else { first });
            for (x, &surface) in own.iter().enumerate() {
                let [left, right] = [own[x.saturating_sub(1)], own[(x + 1).min(width - 1)]];
                let is_uniform = [left, right, above[x], below[x]].iter().all(|&other| other == surface);
                // Most pixels are as all those beside them; one has none beside it.
                if (!is_uniform || count == 1) && is_border(first + x) {
                    borders.push(first + x);
                }
            }
        }
        borders
    }

    /// Leaves to rays what the cells of a picture so many pixels wide tell wrongly, and counts it: cells are rounded, walls that lean by less than a millimetre to
    /// upright ones, so that along their edges pixels may show what is in front of them, or behind, or beside in the same plane. Where walls, floors and ceilings border on something else rays are asked, and for each pixel
    /// that shows what none beside it does, and on from each that shows something else than its ray meets.
    pub(crate) fn settle(&mut self, scene: &Scene, pinhole: &Pinhole, width: u32, starts: Starts<'_>) -> u64 {
        let mut asked = self.borders(scene, width as usize);
        let mut is_asked = vec![false; self.surfaces.len()];
        let (mut rays, mut hits, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
        while !asked.is_empty() {
            asked.iter().for_each(|&index| is_asked[index] = true);
            let mut next = Vec::new();
            for asked in asked.chunks(TOGETHER) {
                rays.clear();
                rays.extend(pixels(pinhole, width, asked.iter().copied()).map(|(_, ray)| ray));
                hits.resize(rays.len(), Hit::ESCAPED);
                scene.trace_many_of(starts, &rays, &mut hits, Want::LEAST);
                for ((&index, ray), hit) in asked.iter().zip(&rays).zip(&hits) {
                    let own = (self.surfaces[index], self.cells[index]);
                    let shown = Told::shown(scene, own, Want::LEAST);
                    let Some(told) = shown.hit(ray) else { continue };
                    // Of what lies on each other either is right; of two things side by side, flush, the one that is there.
                    let is_one = told.element == hit.element && told.material == hit.material;
                    let is_right = is_same(&told, hit) && (is_one || shown.is_met(ray, told.t));
                    if !is_right {
                        wrong.push(index);
                        next.extend(
                            around(width as usize, self.surfaces.len(), index)
                                .filter(|&beside| !is_asked[beside]),
                        );
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

/// Pixels of a picture so many pixels wide by their places in it, each with its ray.
pub(crate) fn pixels(
    pinhole: &Pinhole,
    width: u32,
    places: impl IntoIterator<Item = usize>,
) -> impl Iterator<Item = (usize, Ray)> {
    let width = width as usize;
    let ray = move |index: usize| pinhole.ray((index % width) as u32, (index / width) as u32);
    places.into_iter().map(move |index| (index, ray(index)))
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
