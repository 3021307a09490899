//! `enfilade bench cells`.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use enfilade::bench::{CrossingOptions, Crossings, crossings};
use enfilade::compile::Graph;
use enfilade::importers::Model;
use enfilade::partition::Convexification;
use enfilade::render::{Camera, parse_cameras};
use enfilade::{Scene, compile};
use serde::Serialize;

use super::bench::{Common, frozen_model};
use super::failure::{Failure, Outcome};
use super::output;

/// Cells of a scene, and how many of them rays cross: cut by cost, and by the base line of the paper.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade bench cells house.glb office.glb\n  enfilade bench cells --frozen build1 --frozen build3-bare --json"
)]
pub struct Arguments {
    /// Models.
    #[arg(required_unless_present = "frozen")]
    models: Vec<PathBuf>,
    /// A scene of benches/scenes.toml.
    #[arg(long, value_name = "NAME")]
    frozen: Vec<String>,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Row {
    scene: String,
    how: &'static str,
    bytes: u64,
    graph: Option<Graph>,
    #[serde(flatten)]
    crossings: Crossings,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    let rows = common.resources.in_pool(|| {
        let mut rows = Vec::new();
        for path in &arguments.models {
            let model = common.reading.model(path, &common.resources)?;
            add(&mut rows, &path.display().to_string(), common, &model, |scene| common.views(scene))?;
        }
        for name in &arguments.frozen {
            let (frozen, model) = frozen_model(name)?;
            add(&mut rows, name, common, &model, |scene| {
                parse_cameras(&frozen.cameras, "benches/scenes.toml", &scene.frame())
                    .map_err(|e| Failure::Input(e.into()))
            })?;
        }
        Ok::<_, Failure>(rows)
    })??;
    if common.json {
        return output::print_json(&rows);
    }
    let mut out = String::from(
        "| scene | cut by | cells of air | of matter | sections a cell | faces a section | bytes | cells a ray of frames | a random ray |\n\
         |---|---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for row in &rows {
        let graph = row.graph.unwrap_or_default();
        let Crossings { primary, random, .. } = row.crossings;
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} | {:.2} | {:.2} | {} | {primary:.3} | {random:.3} |",
            row.scene,
            row.how,
            graph.air,
            graph.solid,
            graph.sections_per_cell,
            graph.faces_per_section,
            row.bytes
        );
    }
    output::print(&out)
}

/// Compiles a model both ways, and counts.
fn add(
    rows: &mut Vec<Row>,
    name: &str,
    common: &Common,
    model: &Model,
    views: impl Fn(&Scene) -> Result<Vec<Camera>, Failure>,
) -> Result<(), Failure> {
    let mut options = CrossingOptions::default();
    options.size = common.size;
    for (how, convexification) in [("cost", Convexification::Cost), ("diagonals", Convexification::Diagonals)]
    {
        let mut compiling = common.reading.compile_options(&common.resources);
        compiling.convexification = convexification;
        let compiled = compile(model, &compiling).map_err(|e| Failure::input(format!("{name}: {e}")))?;
        let scene = compiled.scene();
        let crossings = crossings(&scene, &views(&scene)?, &options);
        let (bytes, graph) = (compiled.report.bytes, compiled.report.graph);
        rows.push(Row { scene: name.to_owned(), how, bytes, graph, crossings });
    }
    Ok(())
}
