//! `enfilade bench skip`.

use clap::Args;
use enfilade::bench::{SkipOptions, skip};

use super::bench_model::OneModel;
use super::failure::{Failure, Outcome};

/// What is not done for rays and files that do not need it: counted, and timed beside the same rays with that skip turned off.
///
/// Ends with exit code 1 if a skip changes an answer.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench skip house.glb\n  enfilade bench skip --frozen build1 --markdown"
)]
pub struct Arguments {
    #[command(flatten)]
    model: OneModel,
    /// How often rays are traced each way, in turns; the median counts.
    #[arg(long, value_name = "R", default_value_t = 7)]
    repeat: u32,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let Arguments { model: one, repeat } = arguments;
    let report = one.measured(|model, compiling| {
        let mut options = SkipOptions::default();
        options.rays = one.rays.unwrap_or(options.rays);
        (options.repeat, options.seed, options.compiling) = (*repeat, one.seed, compiling);
        skip(model, &options).map_err(Failure::input)
    })?;
    one.print(&report, || report.text(), || report.markdown())?;
    let is_changed = report.rows.iter().any(|row| row.differing.unwrap_or(0) > 0);
    Ok(if is_changed { Outcome::Findings } else { Outcome::Fine })
}
