//! `enfilade export`.

use std::path::PathBuf;

use clap::Args;
use enfilade::export::{graph_dot, graph_json};

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

/// Write a building for other programs: its graph as JSON or for Graphviz.
///
/// The graph holds rooms, what each opening joins, portals and faces (docs/GRAPH.md). A scene and the model that it was compiled from give
/// the same files.
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade export house.enf --graph house.json
  enfilade export house.glb --graph - | jq '.openings[] | {id, sides}'
  enfilade export house.glb --graph house.dot && dot -Tsvg house.dot -o house.svg")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    input: PathBuf,
    /// Write the graph: for Graphviz if the name ends in .dot or .gv, else as JSON; - for stdout.
    #[arg(long, value_name = "OUT.json|OUT.dot", required = true)]
    graph: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    arguments.resources.in_pool(|| {
        let scene = arguments.reading.scene(&arguments.input, &arguments.resources)?;
        if let Some(path) = &arguments.graph {
            let graph = scene.graph();
            let is_dot = path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("dot") || e.eq_ignore_ascii_case("gv"));
            let text = if is_dot { graph_dot(&scene, &graph) } else { graph_json(&scene, &graph) };
            output::write(Some(path), |out| out.write_all(text.as_bytes()))?;
        }
        Ok(Outcome::Fine)
    })?
}
