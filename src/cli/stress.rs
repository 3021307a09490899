//! `enfilade stress`.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use clap::Args;
use enfilade::importers::Watch;
use enfilade::stress::{Family, StressOptions, stress};

use super::failure::{Failure, Outcome};
use super::input::Resources;
use super::output;

/// Send rays that are hard on numbers through scenes that are, by every kernel, alone and in batches, and judge each answer by the
/// truth and in exact arithmetic (docs/STRESS.md).
///
/// Ends with exit code 1 on any wrong answer, leak, panic, disagreement between ways, or where it is stuck. The report depends on the options alone, but for times.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade stress                                       minutes\n  enfilade stress --long                                hours: all trials, a billion rays\n  enfilade stress --trials corridor,slivers --families along-edges --rays 100000\n  enfilade stress --trials house-cad --families edges --first 4711 --rays 1    one ray anew"
)]
pub struct Arguments {
    /// Rays in all, shared evenly among trials and families, but for trials whose rays take much longer, which get fewer.
    /// A million by default; with --long a billion.
    #[arg(long, value_name = "N")]
    rays: Option<u64>,
    /// The long mode: more trials, more rays, nine hours of a core.
    #[arg(long)]
    long: bool,
    /// Only trials whose name holds one of these.
    #[arg(long, value_name = "PART,...", value_delimiter = ',')]
    trials: Vec<String>,
    /// Only these families of rays.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = parse_family)]
    families: Vec<Family>,
    /// Where the random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// The index of the first ray of each trial and family: with one trial, one family and --rays 1, as a report told it, that ray alone.
    #[arg(long, value_name = "INDEX", default_value_t = 0)]
    first: u64,
    /// Pictures by beams, and by packets, for each trial and family, from where its first rays start.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pictures: u64,
    /// Bad answers that are told in full, for each trial and family.
    #[arg(long, value_name = "N", default_value_t = 3)]
    cases: usize,
    /// Without any progress for so long it is stuck.
    #[arg(long, value_name = "SECONDS", default_value_t = 900)]
    stuck_after: u64,
    /// Print the names of the trials, and end.
    #[arg(long)]
    list: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    resources: Resources,
}

fn parse_family(name: &str) -> Result<Family, String> {
    let names = || Family::ALL.map(Family::name).join(", ");
    Family::ALL.into_iter().find(|family| family.name() == name).ok_or_else(|| format!("one of {}", names()))
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let mut options = StressOptions::default();
    options.rays = arguments.rays.unwrap_or(if arguments.long { 1_000_000_000 } else { 1_000_000 });
    options.long = arguments.long;
    options.trials = arguments.trials.clone();
    options.families = arguments.families.clone();
    options.seed = arguments.seed;
    options.pictures = arguments.pictures;
    (options.first, options.cases) = (arguments.first, arguments.cases);
    let names: Vec<String> = options.chosen().into_iter().map(|trial| trial.name).collect();
    if names.is_empty() {
        return Err(Failure::usage("no such trial: see --list, and --long --list"));
    }
    if arguments.list {
        return output::print(&(names.join("\n") + "\n"));
    }
    // What never ends cannot tell so: another thread waits for signs of life.
    let seen = Arc::new(Mutex::new((Instant::now(), String::new())));
    let (bar, signs) = (arguments.resources.watch(), Arc::clone(&seen));
    options.watch = Watch::default().with_progress(move |stage, done| {
        *signs.lock().unwrap_or_else(PoisonError::into_inner) = (Instant::now(), stage.to_owned());
        bar.report(stage, done);
    });
    let (tell, told) = channel();
    let resources = arguments.resources.clone();
    std::thread::spawn(move || {
        // Nobody listens any more where it was called stuck.
        let _ = tell.send(resources.in_pool(|| stress(&options)));
    });
    let report = loop {
        match told.recv_timeout(Duration::from_secs(1)) {
            Ok(report) => break report?.map_err(Failure::input)?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::input("the run ended without a word"));
            }
            Err(RecvTimeoutError::Timeout) => {
                let (last, stage) = &*seen.lock().unwrap_or_else(PoisonError::into_inner);
                if last.elapsed().as_secs() > arguments.stuck_after {
                    output::print(&format!("stuck for {} s: {stage}\n", arguments.stuck_after))?;
                    return Ok(Outcome::Findings);
                }
            }
        }
    };
    if arguments.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    Ok(if report.passed() { Outcome::Fine } else { Outcome::Findings })
}
