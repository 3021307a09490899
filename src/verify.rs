//! Verification: random rays through a tracer and through the truth.
//!
//! See [`oracle::right`](crate::oracle::right) for what makes an answer right. The report depends on the model, the
//! tracer and the options alone, not on the number of threads.

use std::sync::atomic::{AtomicU64, Ordering};

use enfilade_importers::{Cancelled, ElementId, Model, Role, Watch};
use serde::Serialize;

use crate::oracle::{GridCheck, RayKind, RaySource, Truth, TruthOptions};
use crate::trace::{Answer, Hit, Ray};

mod report;
mod sight;
mod standing;
mod tally;
mod tracer;

pub use report::{Case, ErrorStats, KindTally, Said, Tally, VerifyReport};
pub use sight::{Sight, SightTally};

pub(crate) use sight::part_of;

pub use standing::{standing, tell_sheets, without};
pub use tracer::{Tracer, sees};

use tally::Account;

/// How to verify.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct VerifyOptions {
    /// Random rays: every other one from a room, the rest from outside. Default 1 million.
    pub rays: u64,
    /// Further rays from the boxes of carving solids. Default 20,000.
    pub solid_rays: u64,
    /// Further rays made hard: along axes and edges, at vertices, from surfaces. Default 50,000.
    pub hard_rays: u64,
    /// Rays on which the truth's grid is checked against brute force. Default 10,000.
    pub grid_rays: u64,
    /// Where the random numbers start.
    pub seed: u64,
    /// The tolerance, metres; see [`oracle::right`](crate::oracle::right).
    pub tolerance: f64,
    /// Wrong answers, and as many edge cases and segments, that are reported in full. Default 20.
    pub cases: usize,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl Default for VerifyOptions {
    fn default() -> VerifyOptions {
        VerifyOptions {
            rays: 1_000_000,
            solid_rays: 20_000,
            hard_rays: 50_000,
            grid_rays: 10_000,
            seed: 1,
            tolerance: TruthOptions::default().tolerance,
            cases: 20,
            watch: Watch::default(),
        }
    }
}

impl VerifyOptions {
    /// The same with `rays` random rays, and further ones in proportion: a fiftieth from solids, a twentieth hard.
    pub fn with_rays(mut self, rays: u64) -> VerifyOptions {
        self.rays = rays;
        self.solid_rays = rays / 50;
        self.hard_rays = rays / 20;
        self
    }

    /// The same with another seed.
    pub fn with_seed(mut self, seed: u64) -> VerifyOptions {
        self.seed = seed;
        self
    }

    /// The same with another tolerance, metres.
    pub fn with_tolerance(mut self, tolerance: f64) -> VerifyOptions {
        self.tolerance = tolerance;
        self
    }

    /// The same with another number of rays to check the grid with.
    pub fn with_grid_rays(mut self, rays: u64) -> VerifyOptions {
        self.grid_rays = rays;
        self
    }

    /// The same, watched.
    pub fn with_watch(mut self, watch: Watch) -> VerifyOptions {
        self.watch = watch;
        self
    }
}

/// The most that may be excused, as a share of the random rays, for a verification to pass.
pub const MOST_EXCUSED: f64 = 1e-3;

/// Rays of one job.
const JOB: u64 = 4096;

/// Jobs whose results are held at once.
const WAVE: u64 = 256;

/// Sends random rays through `tracer`, and judges its answers by the triangles of `model`, whose elements have the
/// roles that `role` gives; and asks it whether anything is in the way of parts of those that it answers rightly.
///
/// # Errors
/// If the watch's token was cancelled.
///
/// # Panics
/// As [`Truth::new`].
pub fn verify(
    model: &Model,
    role: impl Fn(ElementId) -> Role,
    tracer: &dyn Tracer,
    options: &VerifyOptions,
) -> Result<VerifyReport, Cancelled> {
    let truth = Truth::new(model, &role, &TruthOptions::default().with_tolerance(options.tolerance));
    options.watch.check()?;
    let seen: Vec<bool> = (0..model.elements.len())
        .map(|index| matches!(role(ElementId(index as u32)), Role::Solid | Role::Detail))
        .collect();
    let grid = truth.check_grid(options.grid_rays, options.seed);
    options.watch.check()?;

    let source = RaySource::new(&truth, options.seed).with_rooms(model);
    let plan = [
        (RayKind::Room, options.rays.div_ceil(2)),
        (RayKind::Outside, options.rays / 2),
        (RayKind::Solid, options.solid_rays),
        (RayKind::Hard, options.hard_rays),
    ];
    let run = Run {
        truth: &truth,
        source: &source,
        seen: &seen,
        tracer,
        options,
        done: AtomicU64::new(0),
        whole: plan.iter().map(|part| part.1).sum(),
    };
    let mut kinds = Vec::new();
    for (kind, count) in plan {
        kinds.push((kind, run.kind(kind, count)?));
    }
    Ok(report::report(&truth, source.room_count(), options, kinds, grid))
}

struct Run<'a> {
    truth: &'a Truth,
    source: &'a RaySource<'a>,
    /// Whether rays see an element.
    seen: &'a [bool],
    tracer: &'a dyn Tracer,
    options: &'a VerifyOptions,
    done: AtomicU64,
    whole: u64,
}

impl Run<'_> {
    fn kind(&self, kind: RayKind, count: u64) -> Result<Account, Cancelled> {
        let mut whole = Account::new(self.options.cases);
        let jobs = count.div_ceil(JOB);
        let mut first = 0;
        while first < jobs {
            let wave = (jobs - first).min(WAVE);
            let accounts = crate::parallel::map(wave as usize, |job| {
                let start = (first + job as u64) * JOB;
                self.job(kind, start, count.min(start + JOB))
            });
            for account in accounts {
                whole.merge(account?);
            }
            first += wave;
        }
        Ok(whole)
    }

    /// Sends the rays from `start` to `end` of a kind.
    fn job(&self, kind: RayKind, start: u64, end: u64) -> Result<Account, Cancelled> {
        self.options.watch.check()?;
        let rays: Vec<Ray> = (start..end).map(|index| self.source.ray(kind, index)).collect();
        let mut hits = vec![Hit::ESCAPED; rays.len()];
        self.tracer.trace(&rays, &mut hits);
        let mut account = Account::new(self.options.cases);
        let mut right: Vec<(u64, Ray, Answer)> = Vec::new();
        for ((index, ray), hit) in (start..end).zip(&rays).zip(&hits) {
            if account.judge(self.truth, self.seen, kind, index, ray, hit) {
                right.push((index, *ray, hit.answer()));
            }
        }
        let (seed, tolerance) = (self.options.seed, self.truth.tolerance());
        account.sight = SightTally::look(self.tracer, (kind, seed), tolerance, self.options.cases, &right);
        let done = self.done.fetch_add(end - start, Ordering::Relaxed) + (end - start);
        self.options.watch.report("verify", done as f64 / self.whole as f64);
        Ok(account)
    }
}

#[cfg(test)]
mod tests;
