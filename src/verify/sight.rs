//! Whether a tracer tells what is occluded as it tells what rays meet.

use serde::Serialize;

use super::Tracer;
use crate::oracle::RayKind;
use crate::splitmix::SplitMix64;
use crate::trace::{Answer, Hit, Ray};

/// Segments, and what a tracer said of them. Each is the part of a ray up to a random place before what the ray meets, or to one behind
/// that, as the tracer itself answered it rightly: so it is known whether anything is in its way.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SightTally {
    /// All.
    pub rays: u64,
    /// With something in their way.
    pub occluded: u64,
    /// Of which the tracer said otherwise.
    pub different: u64,
    /// The first of these.
    pub cases: Vec<Sight>,
}

/// A segment of which a tracer said something else than of its ray.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sight {
    /// The ray's kind.
    pub kind: RayKind,
    /// Its index among those.
    pub index: u64,
    /// Where it starts.
    pub origin: [f64; 3],
    /// Its direction.
    pub direction: [f64; 3],
    /// Where the segment ends.
    pub tmax: f64,
    /// Whether anything is in its way, by what the ray meets.
    pub occluded: bool,
}

impl SightTally {
    /// Adds what was found of later rays; at most so many cases are kept.
    pub(super) fn merge(&mut self, other: SightTally, most: usize) {
        self.rays += other.rays;
        self.occluded += other.occluded;
        self.different += other.different;
        self.cases.extend(other.cases);
        self.cases.truncate(most);
    }

    /// Looks along rays of a kind, from the `first` of it on, whose answers are right: `rays[i]` is told as number `first + i`.
    pub(super) fn look(
        tracer: &dyn Tracer,
        kind: RayKind,
        seed: u64,
        tolerance: f64,
        rays: impl Iterator<Item = (u64, Ray, Answer)>,
    ) -> SightTally {
        let mut segments = Vec::new();
        let mut asked = Vec::new();
        for (index, ray, answer) in rays {
            if let Some((tmax, is_occluded)) = end(&answer, tolerance, seed ^ index) {
                segments.push(Ray { tmax, ..ray });
                asked.push((index, is_occluded));
            }
        }
        let mut said = vec![false; segments.len()];
        if !tracer.occluded(&segments, &mut said) {
            return SightTally::default();
        }
        let mut tally = SightTally { rays: segments.len() as u64, ..SightTally::default() };
        for ((ray, (index, occluded)), said) in segments.iter().zip(asked).zip(said) {
            tally.occluded += u64::from(occluded);
            if said != occluded {
                tally.different += 1;
                let Ray { origin, direction, tmax, .. } = *ray;
                tally.cases.push(Sight { kind, index, origin, direction, tmax, occluded });
            }
        }
        tally
    }
}

/// Where to end a ray, and whether anything is in the way then; `None` where that is a matter of the tolerance.
fn end(answer: &Answer, tolerance: f64, number: u64) -> Option<(f64, bool)> {
    let mut random = SplitMix64::new(number);
    // Many near the end of the way.
    let near = random.unit().powi(4);
    match answer {
        Answer::Escaped => Some((f64::INFINITY, false)),
        Answer::InSolid(_) => Some((2.0 * tolerance + near, true)),
        // Which starts on what it meets.
        Answer::Hit(Hit { t, .. }) if *t <= 2.0 * tolerance => None,
        Answer::Hit(Hit { t, .. }) if random.below(2) == 0 => Some((t + 2.0 * tolerance + near, true)),
        Answer::Hit(Hit { t, .. }) => Some(((1.0 - near) * (t - 2.0 * tolerance), false)),
    }
}
