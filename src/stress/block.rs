//! Some rays of one family through all ways to answer them.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use glam::DVec3;

use super::judge::{Judge, Worth};
use super::rays::{Family, Source};
use super::report::{Counts, StressCase};
use crate::oracle::Judgement;
use crate::trace::{Answer, Brief, Hit, Kernel, Ray, Start, Starts, Want};
use crate::verify::part_of;

/// What rays are sent through.
pub(super) struct Stage<'a> {
    pub(super) trial: &'a str,
    pub(super) judge: Judge<'a>,
    pub(super) source: Source<'a>,
    /// No ray from its start may escape.
    pub(super) is_closed: bool,
    /// Cases that are kept.
    pub(super) most: usize,
}

/// What some rays did.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    pub(super) counts: Counts,
    pub(super) cases: Vec<StressCase>,
}

impl Found {
    pub(super) fn merge(&mut self, other: Found, most: usize) {
        self.counts.add(&other.counts);
        self.cases.extend(other.cases);
        self.cases.truncate(most);
    }
}

/// Whether two distances are the same number, or none.
fn is_same_t(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// Whether two records are the same in every bit.
fn is_same(a: &Hit, b: &Hit) -> bool {
    let numbers = |hit: &Hit| {
        let floats =
            [hit.t, hit.point[0], hit.point[1], hit.point[2], hit.normal[0], hit.normal[1], hit.normal[2]];
        (
            floats.map(f64::to_bits),
            [hit.element, hit.semantic, hit.material, hit.cell, hit.room, hit.triangle],
        )
    };
    numbers(a) == numbers(b)
}

/// Rays that go on from what others met.
#[derive(Default)]
struct Onward {
    from: Vec<Hit>,
    rays: Vec<Ray>,
    /// The indices of the rays that met it.
    numbers: Vec<u64>,
}

impl Stage<'_> {
    /// Sends rays of a family. What panics is found by sending them one by one.
    pub(super) fn block(&self, family: Family, indices: std::ops::Range<u64>) -> Found {
        let start = Instant::now();
        let caught = |indices: std::ops::Range<u64>| {
            catch_unwind(AssertUnwindSafe(|| self.send(family, indices))).ok()
        };
        let mut found = caught(indices.clone()).unwrap_or_else(|| {
            let mut found = Found::default();
            for index in indices.clone() {
                let alone = caught(index..index + 1).unwrap_or_else(|| {
                    let mut found = Found::default();
                    (found.counts.rays, found.counts.panics) = (1, 1);
                    found.cases.push(self.case(family, index, None, "panics"));
                    found
                });
                found.merge(alone, self.most);
            }
            found
        });
        let seconds = start.elapsed().as_secs_f64() / (indices.end - indices.start).max(1) as f64;
        found.counts.slowest_us = seconds * 1e6;
        found
    }

    fn case(&self, family: Family, index: u64, ray: Option<&Ray>, what: &str) -> StressCase {
        let ray = ray.copied().unwrap_or(Ray::new([f64::NAN; 3], [f64::NAN; 3]));
        let Ray { origin, direction, tmin, tmax } = ray;
        let (trial, what) = (self.trial.to_owned(), what.to_owned());
        StressCase { trial, family, index, origin, direction, limits: [tmin, tmax], what }
    }

    fn send(&self, family: Family, indices: std::ops::Range<u64>) -> Found {
        let first = indices.start;
        let rays: Vec<Ray> = indices.map(|index| self.source.ray(family, index)).collect();
        let mut found = Found::default();
        let hits: Vec<Hit> =
            rays.iter().map(|ray| self.judge.scene.trace_from(Start::Anywhere, ray, Want::LEAST)).collect();
        let numbers: Vec<u64> = (first..).take(rays.len()).collect();
        self.by_all_ways(family, Starts::Anywhere, &rays, (&hits, &numbers), &mut found);
        let mut onward = [Onward::default(), Onward::default()];
        for (number, (ray, hit)) in rays.iter().zip(&hits).enumerate() {
            let what = self.judge(ray, &hit.answer(), &mut found.counts);
            if let Some(what) = what {
                found.cases.push(self.case(family, first + number as u64, Some(ray), &what));
            } else if let Answer::Hit(hit) = hit.answer()
                && (first + number as u64).is_multiple_of(4)
            {
                for (way, onward) in [mirrored, passing].into_iter().zip(&mut onward) {
                    if let Some(ray) = way(ray, &hit) {
                        onward.from.push(hits[number]);
                        onward.rays.push(ray);
                        onward.numbers.push(first + number as u64);
                    }
                }
            }
        }
        let [back, through] = onward;
        let hits = self.onward_by_all_ways(family, &back, &mut found);
        for (((from, ray), hit), &number) in back.from.iter().zip(&back.rays).zip(&hits).zip(&back.numbers) {
            found.counts.onward += 1;
            if self.is_double(from, hit) {
                found.counts.doubles += 1;
                let what = format!("met again: {:?} from {:?}", hit.answer(), from.answer());
                found.cases.push(self.case(family, number, Some(ray), &what));
            }
            if let Worth::Wrong(Judgement { verdict, truth, .. }) = self.judge.worth(ray, &hit.answer()) {
                found.counts.wrong_onward += 1;
                let (hit, from) = (hit.answer(), from.answer());
                let what = format!("on from {from:?}, {verdict:?}: {hit:?} instead of {truth:?}");
                found.cases.push(self.case(family, number, Some(ray), &what));
            }
        }
        // What is behind a surface hangs on what the ray is in by then: that all ways say the same.
        self.onward_by_all_ways(family, &through, &mut found);
        found.cases.truncate(self.most);
        found
    }

    /// Notes rays that another way answers otherwise than with these hits; `numbers` are their indices.
    fn by_all_ways(
        &self,
        family: Family,
        starts: Starts<'_>,
        rays: &[Ray],
        (hits, numbers): (&[Hit], &[u64]),
        found: &mut Found,
    ) {
        for (place, unlike) in self.unlike(starts, rays, hits, numbers) {
            found.counts.unlike += 1;
            let from = if let Start::Hit(from) = starts.of(place) {
                format!(", on from {:?}", from.answer())
            } else {
                String::new()
            };
            let what = format!("{unlike} than a single ray, that says {:?}{from}", hits[place].answer());
            found.cases.push(self.case(family, numbers[place], rays.get(place), &what));
        }
    }

    /// The same of rays that go on; what they meet, alone.
    fn onward_by_all_ways(&self, family: Family, onward: &Onward, found: &mut Found) -> Vec<Hit> {
        let Onward { from, rays, numbers } = onward;
        let alone = |(from, ray)| self.judge.scene.trace_from(Start::Hit(from), ray, Want::LEAST);
        let hits: Vec<Hit> = from.iter().zip(rays).map(alone).collect();
        self.by_all_ways(family, Starts::Hits(from), rays, (&hits, numbers), found);
        hits
    }

    /// Judges an answer by itself; what is bad about it.
    fn judge(&self, ray: &Ray, answer: &Answer, counts: &mut Counts) -> Option<String> {
        counts.rays += 1;
        let worth = self.judge.worth(ray, answer);
        worth.count(counts);
        let is_leak = self.is_closed && *answer == Answer::Escaped && ray.tmax == f64::INFINITY;
        counts.leaks += u64::from(is_leak);
        match worth {
            Worth::Wrong(Judgement { verdict, truth, .. }) => {
                Some(format!("{verdict:?}: {answer:?} instead of {truth:?}"))
            }
            _ if is_leak => Some("escaped out of a closed room".to_owned()),
            _ => None,
        }
    }

    /// Whether the very plane from which a ray went on was met again.
    fn is_double(&self, from: &Hit, hit: &Hit) -> bool {
        let [one, other] = [from.normal, hit.normal].map(DVec3::from);
        let aside = (DVec3::from(hit.point) - DVec3::from(from.point)).dot(one);
        // Triangles bent by less are one plane for the tracer, too.
        let is_same = one.cross(other).length() < 1e-6 && aside.abs() < 1e-9;
        hit.element == from.element && hit.t < self.judge.truth.tolerance() && is_same
    }

    /// Rays that another way answers otherwise, and which way; `numbers` are their indices.
    fn unlike(
        &self,
        starts: Starts<'_>,
        rays: &[Ray],
        hits: &[Hit],
        numbers: &[u64],
    ) -> Vec<(usize, String)> {
        let mut unlike = Vec::new();
        let scene = self.judge.scene;
        // The scene's own has said what the others are compared with.
        for kernel in Kernel::available().into_iter().filter(|kernel| *kernel != scene.kernel) {
            for (number, (ray, hit)) in rays.iter().zip(hits).enumerate() {
                if !is_same(&scene.trace_with(kernel, starts.of(number), ray, Want::LEAST), hit) {
                    unlike.push((number, format!("{} says something else", kernel.name())));
                }
            }
        }
        let mut many = vec![Hit::ESCAPED; rays.len()];
        scene.trace_many_of(starts, rays, &mut many, Want::LEAST);
        let differ = many.iter().zip(hits).enumerate().filter(|(_, (a, b))| !is_same(a, b));
        unlike.extend(differ.map(|(number, _)| (number, "a batch says something else".to_owned())));
        let mut briefs = vec![Brief { t: 0.0, triangle: 0, cell: 0 }; rays.len()];
        scene.trace_brief_many(starts, rays, &mut briefs);
        for (number, (brief, hit)) in briefs.iter().zip(hits).enumerate() {
            let alone = scene.trace_brief(starts.of(number), &rays[number]);
            let is_same = [brief.t, alone.t].iter().all(|t| is_same_t(*t, hit.t))
                && [brief.triangle, alone.triangle].iter().all(|triangle| *triangle == hit.triangle);
            if !is_same {
                unlike.push((number, "a brief answer says something else".to_owned()));
            }
        }
        // Parts of the rays, and whether anything is in their way.
        let tolerance = self.judge.truth.tolerance();
        let parts: Vec<(usize, Ray, bool)> = rays
            .iter()
            .zip(hits)
            .enumerate()
            .filter(|(_, (ray, hit))| {
                // Of a ray with limits of its own it is known by its answer no more; from a hit, a solid that it starts in is not in its way.
                let is_known =
                    matches!(starts, Starts::Anywhere) || !matches!(hit.answer(), Answer::InSolid(_));
                is_known && ray.tmin == 0.0 && ray.tmax == f64::INFINITY
            })
            .filter_map(|(number, (ray, hit))| {
                let (tmax, is_occluded) = part_of(&hit.answer(), tolerance, numbers[number])?;
                Some((number, Ray { tmax, ..*ray }, is_occluded))
            })
            .collect();
        let mut segments = rays.to_vec();
        parts.iter().for_each(|(number, ray, _)| segments[*number] = *ray);
        let mut occluded = vec![false; segments.len()];
        scene.occluded_many_of(starts, &segments, &mut occluded);
        for (number, ray, is_occluded) in &parts {
            for (is, how) in
                [(occluded[*number], "in a batch"), (scene.occluded_from(starts.of(*number), ray), "alone")]
            {
                if is != *is_occluded {
                    let is = if is { "something" } else { "nothing" };
                    let what = format!("a segment to {:e} {how} has {is} in its way, otherwise", ray.tmax);
                    unlike.push((*number, what));
                }
            }
        }
        unlike
    }
}

/// The ray on from a hit, as from a mirror.
fn mirrored(ray: &Ray, hit: &Hit) -> Option<Ray> {
    let (along, normal) = (way(ray)?, DVec3::from(hit.normal));
    let onward = along - normal * (2.0 * along.dot(normal));
    (normal != DVec3::ZERO && onward.is_finite()).then(|| Ray::new(hit.point, onward.to_array()))
}

/// The ray on from a hit, through what it met.
fn passing(ray: &Ray, hit: &Hit) -> Option<Ray> {
    way(ray).map(|along| Ray::new(hit.point, along.to_array()))
}

/// The direction of a ray of any length, made unit.
fn way(ray: &Ray) -> Option<DVec3> {
    let along = DVec3::from(ray.direction);
    (along / along.abs().max_element()).try_normalize()
}
