//! Counting verdicts, so that partial counts merge to the same whole in any grouping of threads.

use super::report::{Case, ErrorStats, Said, Tally};
use super::sight::SightTally;
use crate::oracle::right::{Judgement, Verdict, Why};
use crate::oracle::{RayKind, Truth};
use crate::trace::{Answer, Hit, Ray};

/// What became of some rays.
#[derive(Clone, Debug)]
pub(super) struct Account {
    pub(super) tally: Tally,
    pub(super) forward: Errors,
    pub(super) forward_edges: Errors,
    pub(super) largest_backward: f64,
    /// The first wrong ones.
    pub(super) wrong: Vec<Case>,
    /// Those displaced farthest.
    pub(super) edges: Vec<Case>,
    pub(super) sight: SightTally,
    cases: usize,
}

impl Account {
    pub(super) fn new(cases: usize) -> Account {
        Account {
            tally: Tally::default(),
            forward: Errors::default(),
            forward_edges: Errors::default(),
            largest_backward: 0.0,
            wrong: Vec::new(),
            edges: Vec::new(),
            sight: SightTally::default(),
            cases,
        }
    }

    /// Adds what `other`, of later rays, found.
    pub(super) fn merge(&mut self, other: Account) {
        self.tally.add(&other.tally);
        self.forward.merge(&other.forward);
        self.forward_edges.merge(&other.forward_edges);
        self.largest_backward = self.largest_backward.max(other.largest_backward);
        self.wrong.extend(other.wrong);
        self.wrong.truncate(self.cases);
        self.edges.extend(other.edges);
        self.keep_worst_edges();
        self.sight.merge(other.sight, self.cases);
    }

    /// Judges one answer; whether it is right.
    pub(super) fn judge(
        &mut self,
        truth: &Truth,
        seen: &[bool],
        kind: RayKind,
        index: u64,
        ray: &Ray,
        hit: &Hit,
    ) -> bool {
        let answer = hit.answer();
        let mut judgement = truth.judge(ray, &answer);
        if judgement.verdict.is_right() && !is_sound(&answer, ray, seen, truth.tolerance()) {
            judgement.verdict = Verdict::Wrong { why: Why::BadRecord };
        }
        self.count(&answer, &judgement);
        let is_wrong = !judgement.verdict.is_right();
        let list = if is_wrong { &self.wrong } else { &self.edges };
        let wanted = match judgement.verdict {
            Verdict::Wrong { .. } => list.len() < self.cases,
            Verdict::Edge { delta } | Verdict::InSolidEdge { delta } => {
                list.len() < self.cases || list.last().is_some_and(|last| delta > last.verdict.backward())
            }
            _ => false,
        };
        if wanted {
            let case = Case {
                kind,
                index,
                origin: ray.origin,
                direction: ray.direction,
                answered: Said::from_answer(&answer),
                expected: Said::from_truth(&judgement.truth),
                verdict: judgement.verdict,
            };
            if is_wrong {
                self.wrong.push(case);
            } else {
                self.edges.push(case);
                self.keep_worst_edges();
            }
        }
        !is_wrong
    }

    fn keep_worst_edges(&mut self) {
        // Stable: of equal ones the earlier stays.
        self.edges.sort_by(|a, b| b.verdict.backward().total_cmp(&a.verdict.backward()));
        self.edges.truncate(self.cases);
    }

    fn count(&mut self, answer: &Answer, judgement: &Judgement) {
        let tally = &mut self.tally;
        tally.rays += 1;
        match answer {
            Answer::Hit(_) => tally.hits += 1,
            Answer::Escaped => tally.escaped += 1,
            Answer::InSolid(_) => tally.in_solid += 1,
        }
        let mut errors = Some(&mut self.forward);
        match judgement.verdict {
            Verdict::Exact => tally.exact += 1,
            Verdict::Close { .. } => tally.close += 1,
            Verdict::Flush { .. } => tally.flush += 1,
            Verdict::Edge { .. } => {
                tally.edge += 1;
                errors = Some(&mut self.forward_edges);
            }
            Verdict::InSolidAgreed => tally.in_solid_agreed += 1,
            Verdict::InSolidEdge { .. } => tally.in_solid_edge += 1,
            Verdict::Wrong { why } => {
                tally.wrong += 1;
                *tally.wrong_by_kind.entry(why).or_default() += 1;
                errors = None;
            }
        }
        if let (Some(errors), Some(forward)) = (errors, judgement.forward) {
            errors.add(forward);
        }
        if judgement.verdict.is_right() {
            self.largest_backward = self.largest_backward.max(judgement.verdict.backward());
        }
    }
}

/// Whether the record of an answer does not contradict itself.
fn is_sound(answer: &Answer, ray: &Ray, seen: &[bool], tolerance: f64) -> bool {
    let is_seen = |element: u32| seen.get(element as usize).copied().unwrap_or(false);
    match answer {
        Answer::Escaped => true,
        Answer::InSolid(element) => is_seen(*element),
        Answer::Hit(hit) => {
            let largest = ray.direction.iter().fold(0.0f64, |a, c| a.max(c.abs()));
            let d = ray.direction.map(|c| c / largest);
            let length = norm(d);
            let off = [0, 1, 2].map(|i| hit.point[i] - (ray.origin[i] + hit.t * (d[i] / length)));
            let facing: f64 = (0..3).map(|i| hit.normal[i] * d[i] / length).sum();
            // Written so that a NaN is unsound.
            is_seen(hit.element)
                && norm(off) <= tolerance + 1e-9 * (1.0 + hit.t.abs())
                && (norm(hit.normal) - 1.0).abs() <= 1e-3
                && facing <= 1e-3
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// Buckets an octave of the histogram.
const OCTAVE_BITS: u32 = 3;

/// Exponent of the least bucket's lower end; lesser errors count as that.
const LEAST: i32 = -64;

/// Octaves of the histogram; greater errors count as the greatest.
const OCTAVES: usize = 104;

/// A running account of errors.
#[derive(Clone, Debug)]
pub(super) struct Errors {
    count: u64,
    sum: f64,
    squares: f64,
    max: f64,
    histogram: Vec<u64>,
}

impl Default for Errors {
    fn default() -> Errors {
        Errors { count: 0, sum: 0.0, squares: 0.0, max: 0.0, histogram: vec![0; OCTAVES << OCTAVE_BITS] }
    }
}

/// The bucket of an error: the exponent and the first bits of the fraction.
fn bucket(error: f64) -> usize {
    let shift = 52 - OCTAVE_BITS;
    let least = (1023 + LEAST as i64) << OCTAVE_BITS;
    let place = (error.abs().to_bits() >> shift) as i64 - least;
    place.clamp(0, (OCTAVES << OCTAVE_BITS) as i64 - 1) as usize
}

/// The upper end of a bucket.
fn upper_end(bucket: usize) -> f64 {
    let (octave, part) = (bucket >> OCTAVE_BITS, bucket & ((1 << OCTAVE_BITS) - 1));
    2f64.powi(octave as i32 + LEAST) * (1.0 + (part + 1) as f64 / f64::from(1u32 << OCTAVE_BITS))
}

impl Errors {
    pub(super) fn add(&mut self, error: f64) {
        self.count += 1;
        self.sum += error;
        self.squares += error * error;
        self.max = self.max.max(error);
        self.histogram[bucket(error)] += 1;
    }

    pub(super) fn merge(&mut self, other: &Errors) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
        self.max = self.max.max(other.max);
        for (mine, theirs) in self.histogram.iter_mut().zip(&other.histogram) {
            *mine += theirs;
        }
    }

    pub(super) fn stats(&self) -> ErrorStats {
        if self.count == 0 {
            return ErrorStats::default();
        }
        let count = self.count as f64;
        let wanted = self.count - self.count / 100;
        let mut below = 0;
        let p99 = self
            .histogram
            .iter()
            .position(|&n| {
                below += n;
                below >= wanted
            })
            .map_or(self.max, upper_end);
        ErrorStats {
            rays: self.count,
            max: self.max,
            mean: self.sum / count,
            rms: (self.squares / count).sqrt(),
            p99: p99.min(self.max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_errors() {
        let mut errors = Errors::default();
        for i in 0..1000 {
            errors.add(if i < 995 { 1e-6 } else { 1.0 });
        }
        let stats = errors.stats();
        assert_eq!((stats.rays, stats.max), (1000, 1.0));
        assert!((stats.mean - 0.005).abs() < 1e-5 && (stats.rms - 0.005f64.sqrt()).abs() < 1e-5);
        assert!((1e-6..1.13e-6).contains(&stats.p99), "{}", stats.p99);
        let (mut low, mut high) = (Errors::default(), Errors::default());
        (0..995).for_each(|_| low.add(1e-6));
        (0..5).for_each(|_| high.add(1.0));
        low.merge(&high);
        assert_eq!(low.histogram, errors.histogram);
        assert_eq!(Errors::default().stats(), ErrorStats::default());
        for error in [0.0, 1e-300, 1e-19, 3e-7, 0.3, 1e5, 1e300] {
            assert!(upper_end(bucket(error)) >= error.min(2f64.powi(39)));
        }
    }
}
