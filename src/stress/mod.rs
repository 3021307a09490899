//! Stress: rays that are hard on numbers, through scenes that are, by every way through the library.
//!
//! Each trial is a small scene ([`trials`]): far away, tiny, huge, turned by chance, with slivers, walls of a millimetre, slabs with a
//! micrometre between them, a corridor of thousands of cells. Through each go ten families of rays ([`Family`]). Every ray is answered alone by each
//! kernel, in a batch, in brief, and as a segment; answers must be the same. The answer is judged by the truth of
//! [`crate::oracle`]; where that denies it, by rays a little aside and in exact arithmetic. From a quarter of what is met the ray goes on as from a mirror.
//!
//! What is counted as bad: wrong answers, rays that escape out of a closed room, ways that disagree, surfaces that are met again by a ray that
//! starts on them, panics. That a ray has several exact answers is no fault: ties are counted apart. The report depends on the options alone, but for times.

mod block;
mod judge;
#[cfg(feature = "render")]
mod pictures;
mod rays;
mod report;
pub(crate) mod shape;
mod trials;

use enfilade_importers::{Cancelled, Untagged, Watch};

#[cfg(feature = "render")]
pub use pictures::PictureRow;
pub use rays::Family;
pub use report::{Counts, StressCase, StressReport, StressRow};
pub use trials::{Trial, trials};

use block::{Found, Stage};
use judge::Judge;
use rays::Source;

use crate::compile::{CompileOptions, compile};
use crate::oracle::{Truth, TruthOptions};
use crate::roles::roles;

/// What to send.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StressOptions {
    /// Rays in all, shared evenly among trials and families, but for trials whose rays take much longer ([`Trial::one_in`]). Default 1 million.
    pub rays: u64,
    /// Whether to run the trials of the long mode, too.
    pub long: bool,
    /// Only trials whose name holds one of these; all if there are none.
    pub trials: Vec<String>,
    /// Only these families; all if there are none.
    pub families: Vec<Family>,
    /// Where random numbers start.
    pub seed: u64,
    /// The index of the first ray of each trial and family: with [`StressOptions::rays`] of 1 it is sent alone. Default 0.
    pub first: u64,
    /// Pictures by beams, and by packets, for each trial and family, from where the first rays start: with the feature `render`. Default none.
    pub pictures: u64,
    /// Bad answers that are reported in full, for each trial and family. Default 3.
    pub cases: usize,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl Default for StressOptions {
    fn default() -> StressOptions {
        StressOptions {
            rays: 1_000_000,
            long: false,
            trials: Vec::new(),
            families: Vec::new(),
            seed: 1,
            first: 0,
            pictures: 0,
            cases: 3,
            watch: Watch::default(),
        }
    }
}

impl StressOptions {
    /// The trials that they name.
    pub fn chosen(&self) -> Vec<Trial> {
        let is_chosen = |name: &str| {
            self.trials.is_empty() || self.trials.iter().any(|part| name.contains(part.as_str()))
        };
        trials(self.long, self.seed).into_iter().filter(|trial| is_chosen(&trial.name)).collect()
    }
}

/// Rays of a block, which is sent by one thread.
const BLOCK: u64 = 1 << 10;

/// Blocks whose results are held at once.
const WAVE: u64 = 256;

/// Sends rays, and judges every answer.
///
/// # Errors
/// If the watch's token was cancelled.
pub fn stress(options: &StressOptions) -> Result<StressReport, Cancelled> {
    let trials = options.chosen();
    let families = if options.families.is_empty() { Family::ALL.to_vec() } else { options.families.clone() };
    let each = shares(options.rays, &trials, families.len());
    let mut report = StressReport {
        version: env!("CARGO_PKG_VERSION"),
        seed: options.seed,
        total: Counts::default(),
        refused: Vec::new(),
        rows: Vec::new(),
        cases: Vec::new(),
        #[cfg(feature = "render")]
        pictures: Vec::new(),
    };
    for (number, (trial, each)) in trials.iter().zip(each).enumerate() {
        options.watch.check()?;
        options.watch.report(&trial.name, number as f64 / trials.len() as f64);
        if let Err(why) = run(trial, &families, each, options, &mut report) {
            report.refused.push((trial.name.clone(), why));
        }
        options.watch.check()?;
    }
    Ok(report)
}

/// Rays of each family through each trial, of so many in all.
fn shares(rays: u64, trials: &[Trial], families: usize) -> Vec<u64> {
    let most = trials.iter().map(|trial| trial.one_in).max().unwrap_or(1);
    let parts = |trial: &Trial| u128::from(most / trial.one_in.max(1));
    let whole = trials.iter().map(parts).sum::<u128>() * families.max(1) as u128;
    trials.iter().map(|trial| (u128::from(rays) * parts(trial)).div_ceil(whole) as u64).collect()
}

/// Sends the rays of all families through a trial.
fn run(
    trial: &Trial,
    families: &[Family],
    each: u64,
    options: &StressOptions,
    report: &mut StressReport,
) -> Result<(), String> {
    let model = trial.model().map_err(|error| error.to_string())?;
    let compiling = CompileOptions {
        tolerance: trial.tolerance,
        watch: options.watch.clone(),
        ..CompileOptions::default()
    };
    let scene = compile(&model, &compiling).map_err(|error| error.to_string())?.scene();
    let roles = roles(&model, Untagged::default());
    let truth = Truth::new(
        &model,
        |element| roles[element.0 as usize],
        &TruthOptions::default().with_tolerance(trial.tolerance),
    );
    let inside = trial.inside_of(&model);
    for &family in families {
        let stage = Stage {
            trial: &trial.name,
            judge: Judge { scene: &scene, truth: &truth },
            source: Source::new(&scene, &truth, inside, options.seed),
            // From a surface rays may go out.
            is_closed: inside.is_some() && family.starts_anywhere(),
            most: options.cases,
        };
        let mut found = Found::default();
        let blocks = each.div_ceil(BLOCK);
        for wave in (0..blocks).step_by(WAVE as usize) {
            if options.watch.is_cancelled() {
                return Ok(());
            }
            let parts = crate::parallel::map(WAVE.min(blocks - wave) as usize, |block| {
                let sent = (wave + block as u64) * BLOCK;
                let first = options.first.saturating_add(sent);
                // What is stuck is known by the last that began.
                let place = format!("{} {} from {first} on", trial.name, family.name());
                options.watch.report(&place, (sent as f64 / each as f64).min(0.999));
                stage.block(family, first..first.saturating_add((each - sent).min(BLOCK)))
            });
            parts.into_iter().for_each(|part| found.merge(part, options.cases));
        }
        report.total.add(&found.counts);
        report.cases.extend(found.cases);
        report.rows.push(StressRow {
            trial: trial.name.clone(),
            family,
            triangles: scene.detail_triangle_count(),
            cells: scene.cells().len() as u64,
            counts: found.counts,
        });
    }
    #[cfg(feature = "render")]
    if options.pictures > 0 {
        options.watch.report(&format!("{} pictures", trial.name), 0.999);
        let source = Source::new(&scene, &truth, inside, options.seed);
        let which = (options.first, options.pictures);
        report.pictures.extend(pictures::pictures(
            (&trial.name, &Judge { scene: &scene, truth: &truth }),
            &source,
            families,
            which,
            options.cases,
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
