//! What a verification found.

use std::collections::BTreeMap;

use super::sight::SightTally;
use super::tally::{Account, Errors};
use super::{GridCheck, MOST_EXCUSED, Serialize, Truth, VerifyOptions};
use crate::oracle::right::{Verdict, Why};
use crate::oracle::{RayKind, TrueAnswer};
use crate::trace::Answer;

/// What a verification found. Lengths are in metres, places in the model's internal frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct VerifyReport {
    /// Random rays asked for.
    pub rays: u64,
    /// Where the random numbers started.
    pub seed: u64,
    /// The tolerance.
    pub tolerance: f64,
    /// Triangles that take part.
    pub triangles: u64,
    /// Closed rooms from which rays started.
    pub rooms: u64,
    /// All rays together.
    pub total: Tally,
    /// The rays by kind.
    pub kinds: Vec<KindTally>,
    /// Edge cases and rays in solids, as a share of the random rays from rooms and from outside.
    pub excused: f64,
    /// Forward errors where the answer is the same surface as the truth's, or one flush with it.
    pub forward: ErrorStats,
    /// Forward errors of edge cases: a ray that passes an edge may end metres away.
    pub forward_edges: ErrorStats,
    /// The largest backward error of a right answer, as far as witnesses were found: an upper bound.
    pub largest_backward: f64,
    /// Segments of rays, and whether anything is in their way; none if the tracer cannot tell.
    pub sight: SightTally,
    /// The check of the truth's grid against brute force.
    pub grid: GridCheck,
    /// The first wrong answers.
    pub wrong: Vec<Case>,
    /// The edge cases with the largest displacements.
    pub edges: Vec<Case>,
}

/// Counts of rays.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Tally {
    /// All.
    pub rays: u64,
    /// Answered with a hit.
    pub hits: u64,
    /// Answered with an escape.
    pub escaped: u64,
    /// Answered as starting in a solid.
    pub in_solid: u64,
    /// See [`Verdict::Exact`].
    pub exact: u64,
    /// See [`Verdict::Close`].
    pub close: u64,
    /// See [`Verdict::Flush`].
    pub flush: u64,
    /// See [`Verdict::Edge`].
    pub edge: u64,
    /// See [`Verdict::InSolidAgreed`].
    pub in_solid_agreed: u64,
    /// See [`Verdict::InSolidEdge`].
    pub in_solid_edge: u64,
    /// See [`Verdict::Wrong`].
    pub wrong: u64,
    /// The wrong ones by what is wrong.
    pub wrong_by_kind: BTreeMap<Why, u64>,
}

impl Tally {
    pub(super) fn add(&mut self, other: &Tally) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.escaped += other.escaped;
        self.in_solid += other.in_solid;
        self.exact += other.exact;
        self.close += other.close;
        self.flush += other.flush;
        self.edge += other.edge;
        self.in_solid_agreed += other.in_solid_agreed;
        self.in_solid_edge += other.in_solid_edge;
        self.wrong += other.wrong;
        for (why, count) in &other.wrong_by_kind {
            *self.wrong_by_kind.entry(*why).or_default() += count;
        }
    }

    /// Rays that were right only by another ray, or that start in a solid.
    pub fn excused(&self) -> u64 {
        self.edge + self.in_solid_agreed + self.in_solid_edge
    }
}

/// Counts of one kind of rays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KindTally {
    /// The kind.
    pub kind: RayKind,
    /// The counts.
    pub tally: Tally,
}

/// Statistics of errors, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ErrorStats {
    /// How many errors.
    pub rays: u64,
    /// The largest.
    pub max: f64,
    /// Their mean.
    pub mean: f64,
    /// The root of the mean of their squares.
    pub rms: f64,
    /// 99 % are at most this; rounded up by at most an eighth.
    pub p99: f64,
}

/// One ray in full.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Its kind.
    pub kind: RayKind,
    /// Its index among those.
    pub index: u64,
    /// Its origin.
    pub origin: [f64; 3],
    /// Its direction.
    pub direction: [f64; 3],
    /// What the tracer answered.
    pub answered: Said,
    /// The exact answer.
    pub expected: Said,
    /// The verdict.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// An answer in short.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Said {
    /// A hit.
    Hit {
        /// Distance.
        t: f64,
        /// Index of the element.
        element: u32,
    },
    /// Nothing hit.
    Escaped,
    /// In these solids, by the indices of the elements.
    InSolid(Vec<u32>),
}

impl Said {
    pub(super) fn from_answer(answer: &Answer) -> Said {
        match answer {
            Answer::Hit(hit) => Said::Hit { t: hit.t, element: hit.element },
            Answer::Escaped => Said::Escaped,
            Answer::InSolid(element) => Said::InSolid(vec![*element]),
        }
    }

    pub(super) fn from_truth(truth: &TrueAnswer) -> Said {
        match truth {
            TrueAnswer::Hit(nearest) => Said::Hit { t: nearest.t, element: nearest.element.0 },
            TrueAnswer::Escaped => Said::Escaped,
            TrueAnswer::InSolid(solids) => Said::InSolid(solids.iter().map(|e| e.0).collect()),
        }
    }
}

impl VerifyReport {
    /// Whether no answer is wrong, none about a segment is another than that about its ray, at most [`MOST_EXCUSED`] of the random rays
    /// are excused, and the grid agrees with brute force.
    pub fn passed(&self) -> bool {
        self.total.wrong == 0
            && self.sight.different == 0
            && self.excused <= MOST_EXCUSED
            && self.grid.different == 0
    }
}

pub(super) fn report(
    truth: &Truth,
    rooms: usize,
    options: &VerifyOptions,
    kinds: Vec<(RayKind, Account)>,
    grid: GridCheck,
) -> VerifyReport {
    let mut total = Tally::default();
    let (mut forward, mut forward_edges) = (Errors::default(), Errors::default());
    let (mut largest_backward, mut sight) = (0.0f64, SightTally::default());
    let (mut wrong, mut edges) = (Vec::new(), Vec::new());
    let (mut excused, mut random) = (0, 0);
    let mut tallies = Vec::new();
    for (kind, account) in kinds {
        total.add(&account.tally);
        forward.merge(&account.forward);
        forward_edges.merge(&account.forward_edges);
        largest_backward = largest_backward.max(account.largest_backward);
        wrong.extend(account.wrong);
        edges.extend(account.edges);
        sight.merge(account.sight, options.cases);
        if matches!(kind, RayKind::Room | RayKind::Outside) {
            excused += account.tally.excused();
            random += account.tally.rays;
        }
        tallies.push(KindTally { kind, tally: account.tally });
    }
    wrong.truncate(options.cases);
    edges.sort_by(|a: &Case, b: &Case| b.verdict.backward().total_cmp(&a.verdict.backward()));
    edges.truncate(options.cases);
    VerifyReport {
        rays: options.rays,
        seed: options.seed,
        tolerance: truth.tolerance(),
        triangles: truth.triangle_count() as u64,
        rooms: rooms as u64,
        total,
        kinds: tallies,
        excused: if random == 0 { 0.0 } else { excused as f64 / random as f64 },
        forward: forward.stats(),
        forward_edges: forward_edges.stats(),
        largest_backward,
        sight,
        grid,
        wrong,
        edges,
    }
}
