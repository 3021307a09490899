//! `enfilade bench sources`.

use std::path::PathBuf;

use clap::Args;
use enfilade::bench::{SourceOptions, sources};

use super::bench::frozen_model;
use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

/// Where errors come from: lattice, f32, f64, traversal, detail, shading, each by an experiment in which it alone makes the difference.
///
/// Ends with exit code 1 if any answer comes out otherwise, but for rays that were rounded.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench sources house.glb\n  enfilade bench sources --frozen build1-cad --markdown"
)]
pub struct Arguments {
    /// The model.
    #[arg(required_unless_present = "frozen")]
    model: Option<PathBuf>,
    /// A scene of benches/scenes.toml.
    #[arg(long, value_name = "NAME", conflicts_with = "model")]
    frozen: Option<String>,
    /// Random rays from rooms.
    #[arg(long, value_name = "N")]
    rays: Option<u32>,
    /// Where random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print the table as Markdown.
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let report = arguments.resources.in_pool(|| {
        let mut options = SourceOptions::default();
        let model = match (&arguments.model, &arguments.frozen) {
            (Some(path), _) => {
                options.untagged = arguments.reading.untagged.untagged();
                arguments.reading.model(path, &arguments.resources)?
            }
            (None, Some(name)) => frozen_model(name)?.1,
            (None, None) => return Err(Failure::usage("which model? see enfilade bench sources --help")),
        };
        options.rays = arguments.rays.unwrap_or(options.rays);
        options.seed = arguments.seed;
        sources(&model, &options).map_err(Failure::input)
    })??;
    if arguments.json {
        output::print_json(&report)?;
    } else {
        output::print(&if arguments.markdown { report.markdown() } else { report.text() })?;
    }
    Ok(if report.passed() { Outcome::Fine } else { Outcome::Findings })
}
