//! `enfilade bench sources`.

use clap::Args;
use enfilade::bench::{SourceOptions, sources};

use super::bench_model::OneModel;
use super::failure::{Failure, Outcome};

/// Where errors come from: lattice, f32, f64, traversal, detail, shading, each by an experiment in which it alone makes the difference.
///
/// Ends with exit code 1 if any answer comes out otherwise, but for rays that were rounded.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench sources house.glb\n  enfilade bench sources --frozen build1-cad --markdown"
)]
pub struct Arguments {
    #[command(flatten)]
    model: OneModel,
}

pub fn run(Arguments { model: one }: &Arguments) -> Result<Outcome, Failure> {
    let report = one.measured(|model, compiling| {
        let mut options = SourceOptions::default();
        options.rays = one.rays.unwrap_or(options.rays);
        (options.seed, options.compiling) = (one.seed, compiling);
        sources(model, &options).map_err(Failure::input)
    })?;
    one.print(&report, || report.text(), || report.markdown())?;
    Ok(if report.passed() { Outcome::Fine } else { Outcome::Findings })
}
