//! Whether a tracer tells what is occluded as it tells what rays meet.

use serde::Serialize;

use super::Tracer;
use crate::oracle::RayKind;
use crate::splitmix::SplitMix64;
use crate::trace::{Answer, Hit, Ray};

/// Segments, and what a tracer said of them. Each is the part of a ray up to a random place before what the ray meets, or to one behind
/// that, as the tracer itself answered it rightly: so it is known whether anything is in its way. Of hits nearer than four times the tolerance it is not,
/// and they are not asked about.
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

    /// Looks along rays of a kind whose answers are right, each with its number among those; at most so many cases are kept.
    pub(super) fn look(
        tracer: &dyn Tracer,
        (kind, seed): (RayKind, u64),
        tolerance: f64,
        most: usize,
        rays: &[(u64, Ray, Answer)],
    ) -> SightTally {
        let ends = rays.iter().map(|(index, ray, answer)| {
            part_of(answer, tolerance, seed ^ index)
                .map(|(tmax, occluded)| (*index, Ray { tmax, ..*ray }, occluded))
        });
        let asked: Vec<(u64, Ray, bool)> = ends.flatten().collect();
        let segments: Vec<Ray> = asked.iter().map(|(_, ray, _)| *ray).collect();
        let mut tally = SightTally::default();
        let Some(said) = tracer.occluded(&segments) else { return tally };
        assert_eq!(said.len(), segments.len(), "as many answers as rays");
        for ((index, Ray { origin, direction, tmax, .. }, occluded), said) in asked.into_iter().zip(said) {
            tally.rays += 1;
            tally.occluded += u64::from(occluded);
            if said != occluded {
                tally.different += 1;
                if tally.cases.len() < most {
                    tally.cases.push(Sight { kind, index, origin, direction, tmax, occluded });
                }
            }
        }
        tally
    }
}

/// Where to end a ray, and whether anything is in the way then; `None` where that is a matter of the tolerance: a ray may start on what it
/// meets, or so near behind a surface that it counts as on the other side of it.
pub(crate) fn part_of(answer: &Answer, tolerance: f64, number: u64) -> Option<(f64, bool)> {
    let mut random = SplitMix64::new(number);
    // Many near the end of the way.
    let near = random.unit().powi(4);
    let is_whole = random.below(2) == 0;
    match answer {
        Answer::Escaped if is_whole => Some((f64::INFINITY, false)),
        // From a centimetre to a hundred metres.
        Answer::Escaped => Some((10f64.powf(random.between(-2.0, 2.0)), false)),
        Answer::InSolid(_) => Some((2.0 * tolerance + near, true)),
        Answer::Hit(Hit { t, .. }) if *t <= 4.0 * tolerance => None,
        Answer::Hit(Hit { t, .. }) if is_whole => Some((t + 2.0 * tolerance + near, true)),
        Answer::Hit(Hit { t, .. }) => Some((tolerance + (1.0 - near) * (t - 3.0 * tolerance), false)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_well_before_or_behind_what_their_rays_meet() {
        let tolerance = 1e-3;
        let hit = |t: f64| Answer::Hit(Hit { t, ..Hit::ESCAPED });
        let ends = |answer: Answer| -> Vec<(f64, bool)> {
            (0..2000).filter_map(|number| part_of(&answer, tolerance, number)).collect()
        };
        // It may start within the tolerance behind a surface, and is free from there on.
        assert!(ends(hit(0.0)).is_empty() && ends(hit(4e-3)).is_empty());
        for t in [5e-3, 0.1, 30.0] {
            let ends = ends(hit(t));
            assert!(ends.iter().all(|&(end, is_met)| if is_met {
                end >= t + 2e-3
            } else {
                end >= tolerance && end <= t - 2e-3 + 1e-12
            }));
            assert!((800..1200).contains(&ends.iter().filter(|end| end.1).count()));
        }
        let escaped = ends(Answer::Escaped);
        assert!(escaped.iter().all(|end| !end.1 && end.0 >= 0.01));
        assert!((800..1200).contains(&escaped.iter().filter(|end| end.0.is_finite()).count()));
        assert!(ends(Answer::InSolid(0)).iter().all(|end| end.1 && end.0 >= 2e-3));
    }
}
