//! What a way got right, ray by ray, against exact arithmetic.

use enfilade_importers::Model;
use glam::DVec3;
use serde::Serialize;

use super::image::{self, ImageError};
use crate::oracle::{First, Truth, Verdict};
use crate::trace::{Answer, Hit, Ray};

/// Answers to rays farther aside than this, metres, are not those that rounding tells apart.
const ROUNDING: f64 = 1e-9;

/// Distances less than this, metres, have no units in the last place of their own.
const SHORTEST: f64 = 1e-6;

/// The greatest, the mean and the root of the mean square of errors; zeros of none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// The greatest.
    pub largest: f64,
    /// The mean.
    pub mean: f64,
    /// The root of the mean square.
    pub rms: f64,
}

/// Errors being summed.
#[derive(Clone, Copy, Default)]
pub(in crate::bench) struct Sum {
    count: u64,
    largest: f64,
    sum: f64,
    squares: f64,
}

impl Sum {
    pub(in crate::bench) fn add(&mut self, error: f64) {
        self.count += 1;
        self.largest = self.largest.max(error);
        self.sum += error;
        self.squares += error * error;
    }

    pub(in crate::bench) fn spread(&self) -> Spread {
        let count = self.count.max(1) as f64;
        Spread { largest: self.largest, mean: self.sum / count, rms: (self.squares / count).sqrt() }
    }
}

/// The errors of one way. Lengths in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Answers that are not an exact one: another element, a distance off by more than the tolerance, nothing instead of something, or the reverse.
    pub differing: u64,
    /// Of those, the exact answers to rays no farther aside than rounding is, where a ray has several exact answers: it meets several triangles at the
    /// very place, or one on its border, or runs in a triangle's plane.
    pub ties: u64,
    /// Of those, the others that are right: the exact answer to a parallel ray within the tolerance, or of a surface flush with the exact one. In f64
    /// ([`Truth::judge`]).
    pub beside: u64,
    /// Of those, the others: wrong.
    pub wrong: u64,
    /// The same in millionths of all rays.
    pub wrong_ppm: f64,
    /// Rays that escaped, though exactly they meet something.
    pub leaks: u64,
    /// Rays on from what was met, as from a mirror, that met the very plane again; `None` if the way tells no normals.
    pub double_hits: Option<u64>,
    /// By how much distances are off, of answers that do not differ.
    pub forward: Spread,
    /// The same in units in the last place (f64) of the exact distance.
    pub ulps: Spread,
    /// How far away the parallel ray is whose exact answer was given, of right answers; for one on the ray itself, how far the distance is off.
    pub backward: Spread,
    /// The same in units in the last place (f64) of the exact distance, or, where exactly nothing is met, of the told one; of no
    /// answer without either.
    pub backward_ulps: Spread,
    /// The angle, radians, between the lines of normals and those of the exact triangles; `None` if the way tells none.
    pub normals: Option<Spread>,
    /// How far a picture is off, shaded by a light at the camera, where the way tells a normal; `None` if it tells none.
    pub image: Option<ImageError>,
}

/// A way's errors being summed.
#[derive(Clone, Copy, Default)]
pub(super) struct Score {
    rays: u64,
    ties: u64,
    beside: u64,
    wrong: u64,
    leaks: u64,
    /// Hits of which a normal was told.
    with_normals: u64,
    double_hits: u64,
    forward: Sum,
    ulps: Sum,
    backward: Sum,
    backward_ulps: Sum,
    normals: Sum,
    pub(super) image: image::Sum,
}

/// What rays are judged by.
pub(super) struct Judge<'a> {
    pub(super) truth: &'a Truth,
    pub(super) model: &'a Model,
}

impl Judge<'_> {
    /// The unit normal of a triangle of the model, on the side that the ray comes from; `None` if it has none.
    fn normal(&self, element: u32, triangle: u32, ray: &Ray) -> Option<DVec3> {
        let mesh = &self.model.elements[element as usize].mesh;
        let [a, b, c] = mesh.corners(triangle as usize).map(DVec3::from);
        toward((b - a).cross(c - a).try_normalize()?, ray)
    }

    /// The normals of the triangles of an element that are met exactly, as [`Judge::normal`].
    fn normals(&self, first: &First, element: u32, ray: &Ray) -> impl Iterator<Item = DVec3> {
        let met = first.met.iter().filter(move |(met, _)| met.element.0 == element);
        met.filter_map(|(met, _)| self.normal(met.element.0, met.triangle, ray))
    }

    /// Judges one answer; `normal` is what the way tells of it. The pixel's shade, as it was told, and exactly.
    pub(super) fn add(
        &self,
        score: &mut Score,
        ray: &Ray,
        exact: Option<&First>,
        hit: &Hit,
        normal: Option<[f64; 3]>,
    ) -> Option<[f64; 2]> {
        score.rays += 1;
        let answer = hit.answer();
        let normal = normal.and_then(|normal| toward(DVec3::from(normal).try_normalize()?, ray));
        score.with_normals += u64::from(normal.is_some());
        let shades = self.look(score, ray, exact, &answer, normal);
        self.add_distance(score, ray, exact, &answer, normal);
        shades
    }

    /// Judges how far off an answer is.
    fn add_distance(
        &self,
        score: &mut Score,
        ray: &Ray,
        exact: Option<&First>,
        answer: &Answer,
        normal: Option<DVec3>,
    ) {
        let off = match (answer, exact) {
            (Answer::Hit(hit), Some(first)) => {
                let is_there = first.met.iter().any(|(met, _)| met.element.0 == hit.element);
                (is_there && hit.t.is_finite() && hit.t >= 0.0).then(|| first.off(hit.t).abs())
            }
            (Answer::Escaped, None) => Some(0.0),
            _ => None,
        };
        if let Some(off) = off.filter(|off| *off <= self.truth.tolerance()) {
            score.add_backward(off, exact, answer);
            if let (Answer::Hit(hit), Some(first)) = (answer, exact) {
                score.forward.add(off);
                score.ulps.add(off / ulp(first.t));
                let angle = normal.and_then(|normal| {
                    self.normals(first, hit.element, ray).map(|exact| angle(normal, exact)).reduce(f64::min)
                });
                angle.into_iter().for_each(|angle| score.normals.add(angle));
            }
            return;
        }
        score.leaks += u64::from(*answer == Answer::Escaped && exact.is_some());
        let verdict = self.truth.judge(ray, answer).verdict;
        if !verdict.is_right() {
            score.wrong += 1;
            return;
        }
        let off = match (verdict, answer, exact) {
            (Verdict::Flush { .. }, Answer::Hit(hit), Some(first)) => first.off(hit.t).abs(),
            _ => verdict.backward(),
        };
        score.add_backward(off, exact, answer);
        let is_tie = off <= ROUNDING && exact.is_some_and(First::is_tie);
        if is_tie { score.ties += 1 } else { score.beside += 1 }
    }

    /// What the answer does to a picture: the pixel's shade, and that which it has exactly; `None` if nothing is told of it.
    fn look(
        &self,
        score: &mut Score,
        ray: &Ray,
        exact: Option<&First>,
        answer: &Answer,
        normal: Option<DVec3>,
    ) -> Option<[f64; 2]> {
        let shade = |element: u32, normal: DVec3| image::shade(element, normal, ray);
        let told = match answer {
            Answer::Hit(hit) => normal.map(|normal| shade(hit.element, normal)),
            _ => Some(image::NOTHING),
        }?;
        // Of several exact ones the one that was told, if it is among them.
        let exactly = exact.and_then(|first| {
            let (met, _) = match answer {
                Answer::Hit(hit) => first.met.iter().find(|(met, _)| met.element.0 == hit.element),
                _ => None,
            }
            .or(first.met.first())?;
            let told = normal.unwrap_or_default();
            let nearer = |a: DVec3, b: DVec3| if angle(told, b) < angle(told, a) { b } else { a };
            Some(shade(met.element.0, self.normals(first, met.element.0, ray).reduce(nearer)?))
        });
        let exactly = exactly.unwrap_or(image::NOTHING);
        score.image.add(told, exactly);
        Some([told, exactly])
    }

    /// Counts rays on from what was met that met the very plane again: the same element, nearer than the tolerance, with the same normal.
    pub(super) fn add_onward(
        &self,
        score: &mut Score,
        from: (&Hit, [f64; 3]),
        hit: &Hit,
        normal: Option<[f64; 3]>,
    ) {
        let is_near = hit.element == from.0.element && hit.t < self.truth.tolerance();
        let is_same =
            normal.is_some_and(|normal| DVec3::from(normal).dot(DVec3::from(from.1)).abs() > 0.999_999);
        score.double_hits += u64::from(is_near && is_same);
    }
}

impl Score {
    fn add_backward(&mut self, off: f64, exact: Option<&First>, answer: &Answer) {
        self.backward.add(off);
        let told = if let Answer::Hit(hit) = answer { Some(hit.t) } else { None };
        let t = exact.map(|first| first.t).or(told);
        t.into_iter().for_each(|t| self.backward_ulps.add(off / ulp(t)));
    }

    pub(super) fn errors(&self) -> Errors {
        let tells_normals = self.with_normals > 0;
        Errors {
            differing: self.ties + self.beside + self.wrong,
            ties: self.ties,
            beside: self.beside,
            wrong: self.wrong,
            wrong_ppm: self.wrong as f64 * 1e6 / self.rays.max(1) as f64,
            leaks: self.leaks,
            double_hits: tells_normals.then_some(self.double_hits),
            forward: self.forward.spread(),
            ulps: self.ulps.spread(),
            backward: self.backward.spread(),
            backward_ulps: self.backward_ulps.spread(),
            normals: tells_normals.then(|| self.normals.spread()),
            image: tells_normals.then(|| self.image.error()),
        }
    }
}

/// The unit in the last place of a distance.
fn ulp(t: f64) -> f64 {
    let t = t.max(SHORTEST);
    t.next_up() - t
}

/// A unit normal on the side that the ray comes from; `None` for no vector.
fn toward(normal: DVec3, ray: &Ray) -> Option<DVec3> {
    let normal = if normal.dot(DVec3::from(ray.direction)) > 0.0 { -normal } else { normal };
    normal.is_finite().then_some(normal)
}

/// The angle between the lines of unit vectors, also where it is small: which side of a plane a ray comes from is in doubt where it runs along it.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b).abs())
}
