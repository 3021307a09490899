//! `enfilade bench skip`.

use std::path::PathBuf;

use clap::Args;
use enfilade::bench::{SkipOptions, skip};

use super::bench::frozen_model;
use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

/// What is not done for rays and files that do not need it: counted, and timed beside the same rays with that skip turned off.
///
/// Ends with exit code 1 if a skip changes an answer.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench skip house.glb\n  enfilade bench skip --frozen build1 --markdown"
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
    /// How often they are traced each way, in turns; the median counts.
    #[arg(long, value_name = "R", default_value_t = 7)]
    repeat: u32,
    /// Where random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print the tables as Markdown.
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
        let mut options = SkipOptions::default();
        let model = match (&arguments.model, &arguments.frozen) {
            (Some(path), _) => {
                options.untagged = arguments.reading.untagged.untagged();
                arguments.reading.model(path, &arguments.resources)?
            }
            (None, Some(name)) => frozen_model(name)?.1,
            (None, None) => return Err(Failure::usage("which model? see enfilade bench skip --help")),
        };
        options.rays = arguments.rays.unwrap_or(options.rays);
        (options.repeat, options.seed) = (arguments.repeat, arguments.seed);
        skip(&model, &options).map_err(Failure::input)
    })??;
    if arguments.json {
        output::print_json(&report)?;
    } else {
        output::print(&if arguments.markdown { report.markdown() } else { report.text() })?;
    }
    Ok(if report.rows.iter().any(|row| row.differing.unwrap_or(0) > 0) {
        Outcome::Findings
    } else {
        Outcome::Fine
    })
}
