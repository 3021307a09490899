//! What benchmarks of one model have in common: the model, how many rays, how the report is printed.

use std::path::PathBuf;

use clap::Args;
use enfilade::CompileOptions;
use enfilade::importers::Model;
use serde::Serialize;

use super::bench::frozen_model;
use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

#[derive(Args)]
pub struct OneModel {
    /// The model.
    #[arg(required_unless_present = "frozen")]
    model: Option<PathBuf>,
    /// A scene of benches/scenes.toml, compiled with the usual options.
    #[arg(long, value_name = "NAME", conflicts_with = "model")]
    frozen: Option<String>,
    /// Random rays from rooms.
    #[arg(long, value_name = "N")]
    pub rays: Option<u32>,
    /// Where random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Print tables as Markdown.
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

impl OneModel {
    /// Measures the model, which is to be compiled with these options, on the threads that were asked for.
    pub fn measured<R: Send>(
        &self,
        measure: impl FnOnce(&Model, CompileOptions) -> Result<R, Failure> + Send,
    ) -> Result<R, Failure> {
        self.resources.in_pool(|| match (&self.model, &self.frozen) {
            (Some(path), _) => {
                let model = self.reading.model(path, &self.resources)?;
                measure(&model, self.reading.compile_options(&self.resources))
            }
            (None, Some(name)) => measure(&frozen_model(name)?.1, CompileOptions::default()),
            (None, None) => Err(Failure::usage("which model? see --help")),
        })?
    }

    /// Prints a report as it was asked for.
    pub fn print(
        &self,
        report: &impl Serialize,
        text: impl Fn() -> String,
        markdown: impl Fn() -> String,
    ) -> Result<Outcome, Failure> {
        if self.json {
            return output::print_json(report);
        }
        output::print(&if self.markdown { markdown() } else { text() })
    }
}
