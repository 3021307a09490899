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

use super::bench::{frozen_model, views};
use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;
use super::render::parse_picture_size;

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
    /// A file of cameras; by default two level views from the middle of each room, at most 20 in all.
    #[arg(long, value_name = "FILE", conflicts_with = "frozen")]
    cams: Option<PathBuf>,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "256x256", value_parser = parse_picture_size)]
    size: (u32, u32),
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
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
    let rows = arguments.resources.in_pool(|| {
        let mut rows = Vec::new();
        for path in &arguments.models {
            let model = arguments.reading.model(path, &arguments.resources)?;
            add(&mut rows, &path.display().to_string(), arguments, &model, |scene| {
                views(scene, arguments.cams.as_deref())
            })?;
        }
        for name in &arguments.frozen {
            let (frozen, model) = frozen_model(name)?;
            add(&mut rows, name, arguments, &model, |scene| {
                parse_cameras(&frozen.cameras, "benches/scenes.toml", &scene.frame())
                    .map_err(|e| Failure::Input(e.into()))
            })?;
        }
        Ok::<_, Failure>(rows)
    })??;
    if arguments.json {
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
    arguments: &Arguments,
    model: &Model,
    views: impl Fn(&Scene) -> Result<Vec<Camera>, Failure>,
) -> Result<(), Failure> {
    let mut options = CrossingOptions::default();
    options.size = arguments.size;
    for (how, convexification) in [("cost", Convexification::Cost), ("diagonals", Convexification::Diagonals)]
    {
        let mut compiling = arguments.reading.compile_options(&arguments.resources);
        compiling.convexification = convexification;
        let compiled = compile(model, &compiling).map_err(|e| Failure::input(format!("{name}: {e}")))?;
        let scene = compiled.scene();
        let crossings = crossings(&scene, &views(&scene)?, &options);
        let (bytes, graph) = (compiled.report.bytes, compiled.report.graph);
        rows.push(Row { scene: name.to_owned(), how, bytes, graph, crossings });
    }
    Ok(())
}
