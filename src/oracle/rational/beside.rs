//! Witnesses that no f64 can name: parallel rays aside by less than coordinates are fine.

use enfilade_importers::ElementId;

use super::super::Truth;
use super::super::shell::Body;
use super::super::soup::first_t;
use super::super::triangle::{Corners, Line};
use super::super::vector::{add, dot, length, max_abs, scale, sub};
use super::super::witness::touch_at;
use super::{Exactly, along, minus, rational, vector};
use crate::trace::Ray;

impl Truth {
    /// Whether an answer is that to a parallel ray a little aside, whose origin need be no f64: how far, metres. The answer says that the
    /// ray meets the triangle `corners` of `element` at `t`, a place that the triangle comes within the tolerance of. Finds witnesses where
    /// things are narrower than f64 is fine. What the witness starts inside of is asked in f64: within rounding of a surface that may be either;
    /// it may begin where it comes out of that, or behind a surface that it meets within the tolerance of its start. What the witness meets may be off along it, too: both count as how far. `None` is
    /// no proof that there is none.
    pub fn witness_at(&self, ray: &Ray, corners: &Corners, element: ElementId, t: f64) -> Option<f64> {
        /// Shares of the way to the triangle's middle: at the point itself others may be met as well, and inward of an edge a face before that.
        const INWARD: [f64; 6] = [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-4];
        /// So many surfaces are looked at, from the start on; behind all but the last of them the witness may begin.
        const MOST_MET: usize = 5;
        let line = Line::new(ray)?;
        if !(t >= first_t(ray) && t <= ray.tmax && t.is_finite()) {
            return None;
        }
        let weights = nearest_weights(line.at(t), corners);
        let exactly = Exactly::new(ray);
        INWARD.into_iter().find_map(|share| {
            let weights = weights.map(|weight| rational(weight * (1.0 - share) + share / 3.0));
            let sum = &weights[0] + &weights[1] + &weights[2];
            let exact = corners.map(vector);
            let point = [0, 1, 2].map(|i| {
                (&exact[0][i] * &weights[0] + &exact[1][i] * &weights[1] + &exact[2][i] * &weights[2]) / &sum
            });
            // The answer's `t` in lengths of the direction, to an ulp: exact for the ray that is made of it.
            let place = rational(t / length_of(ray.direction));
            let met = [0, 1, 2].map(|i| &exactly.origin[i] + &exactly.direction[i] * &place);
            let shift = minus(&point, &met);
            let across = along(&shift, &shift).to_f64().value().sqrt();
            let origin = [0, 1, 2].map(|i| &exactly.origin[i] + &shift[i]);
            let start = [0, 1, 2].map(|i| line.at(first_t(ray))[i] + shift[i].to_f64().value());
            let beside = Exactly { origin, ..Exactly::new(ray) };
            let near = Ray { origin: beside.origin.each_ref().map(|c| c.to_f64().value()), ..*ray };
            // Along itself it is moved out of what it starts inside of, and past what it starts on or hardly behind.
            let way_out = self.way_out(&near, start)?;
            let mut ahead = way_out;
            for _ in 0..MOST_MET {
                let aside = across.hypot(ahead);
                if aside > self.tolerance {
                    return None;
                }
                // What it meets is at `t` but for roundings, and so it may begin and end there.
                let rounding = 1e-12 * (1.0 + t);
                let begin = first_t(ray) + ahead;
                let near = Ray { tmin: begin - rounding, tmax: ray.tmax + rounding, ..near };
                let first = self.first_until(&beside, &Line::new(&near)?, &near, t + self.tolerance)?;
                // Behind a surface that it met it may have come into a solid, which is seen where it is deepest in that.
                let halfway = 0.5 * (first.t - begin).max(0.0);
                if begin > first_t(ray) + way_out
                    && !self.solids_at(add(start, scale(line.direction, ahead + halfway))).is_empty()
                {
                    return None;
                }
                let off = first.off(t).abs();
                let displacement = if off <= rounding { aside } else { across.hypot(ahead.max(off)) };
                if first.met.iter().any(|(met, _)| met.element == element) && displacement <= self.tolerance {
                    return Some(displacement);
                }
                ahead += (first.t - begin).max(0.0) + 2.0 * rounding;
            }
            None
        })
    }
}

impl Truth {
    /// How far along a ray that starts at `start` no solid holds it any more, metres: 0, or just past a surface within the tolerance. By
    /// rounding it may be on a surface, which is not inside.
    fn way_out(&self, ray: &Ray, start: [f64; 3]) -> Option<f64> {
        if self.is_out(start) {
            return Some(0.0);
        }
        let (first, direction) = (first_t(ray), Line::new(ray)?.direction);
        let surfaces = self.hits_between(ray, first, first + self.tolerance);
        let mut past = surfaces.into_iter().map(|hit| hit.t - first + 4.0 * touch_at(max_abs(start)));
        past.find(|&ahead| ahead >= 0.0 && self.solids_at(add(start, scale(direction, ahead))).is_empty())
    }

    /// Whether no solid holds a point, but for rounding.
    fn is_out(&self, point: [f64; 3]) -> bool {
        let rounding = 8.0 * f64::EPSILON * max_abs(point);
        let is_deep = |(_, body): &(ElementId, Body)| {
            body.contains(point) && body.surface_near(point, rounding).is_empty()
        };
        !self.solids.iter().any(is_deep)
    }
}

/// The length of a direction of any size.
fn length_of(direction: [f64; 3]) -> f64 {
    let largest = max_abs(direction);
    largest * length(direction.map(|c| c / largest))
}

/// The weights of a triangle's corners that make the point of it nearest to `point`, about.
fn nearest_weights(point: [f64; 3], [a, b, c]: &Corners) -> [f64; 3] {
    let [ab, ac, ap] = [sub(*b, *a), sub(*c, *a), sub(point, *a)];
    let (d00, d01, d11) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
    let (d20, d21) = (dot(ap, ab), dot(ap, ac));
    let det = d00 * d11 - d01 * d01;
    let (v, w) = ((d11 * d20 - d01 * d21) / det, (d00 * d21 - d01 * d20) / det);
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return [1.0 - v - w, v, w];
    }
    // On one of its edges.
    let ends = [(a, b, [0, 1]), (b, c, [1, 2]), (c, a, [2, 0])];
    let on_edges = ends.map(|(p, q, [i, j])| {
        let way = sub(*q, *p);
        let share = (dot(sub(point, *p), way) / dot(way, way)).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        let mut weights = [0.0; 3];
        (weights[i], weights[j]) = (1.0 - share, share);
        let off = sub(point, add(*p, scale(way, share)));
        (dot(off, off), weights)
    });
    let nearest = on_edges.into_iter().min_by(|one, other| one.0.total_cmp(&other.0));
    nearest.map_or([1.0, 0.0, 0.0], |(_, weights)| weights)
}
