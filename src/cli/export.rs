//! `enfilade export`.

use std::path::{Path, PathBuf};

use clap::Args;
use enfilade::building::FaceKind;
use enfilade::export::{cells_glb, faces_obj, graph_dot, graph_json};

use enfilade::render::face_color;

use super::doors::Doors;
use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

/// Write a building for other programs: its graph as JSON or for Graphviz, its faces as OBJ, its rooms and cells as glTF.
///
/// The graph holds rooms, what each opening joins, portals and faces (docs/GRAPH.md). A scene and the model that it was compiled from give
/// the same files.
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade export house.enf --graph house.json
  enfilade export house.glb --graph - | jq '.openings[] | {id, sides}'
  enfilade export house.enf --cells cells.glb --explode 0.2
  enfilade export house.enf --obj faces.obj
  enfilade export house.glb --graph house.dot && dot -Tsvg house.dot -o house.svg")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    input: PathBuf,
    /// Write the graph: for Graphviz if the name ends in .dot or .gv, else as JSON; - for stdout.
    #[arg(long, value_name = "OUT.json|OUT.dot", required_unless_present_any = ["obj", "cells"])]
    graph: Option<PathBuf>,
    /// Write the surfaces of all air, an object for each kind of face of each room, and its colours (.mtl) beside it; in the model's own
    /// frame and unit.
    #[arg(long, value_name = "OUT.obj")]
    obj: Option<PathBuf>,
    /// Write rooms, openings and their cells as tagged volumes; metres, Y up.
    #[arg(long, value_name = "OUT.glb")]
    cells: Option<PathBuf>,
    /// With --cells: move rooms and cells apart by this share of their distance from the middle.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, requires = "cells", value_parser = share)]
    explode: f64,
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

/// The colours of faces, as pictures have them.
fn materials() -> String {
    let material = |kind: FaceKind| {
        let [r, g, b] = face_color(kind.number());
        format!("newmtl {}\nKd {r:.4} {g:.4} {b:.4}\n", kind.name())
    };
    FaceKind::ALL.into_iter().map(material).collect()
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=100.0).contains(&share) => Ok(share),
        _ => Err("not a number from 0 to 100".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let outputs: Vec<&Path> = [&arguments.graph, &arguments.obj, &arguments.cells]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    if (1..outputs.len()).any(|i| outputs[..i].contains(&outputs[i])) {
        return Err(Failure::usage(format!("{}: several outputs cannot be one", outputs[0].display())));
    }
    if arguments
        .obj
        .as_ref()
        .is_some_and(|path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mtl")))
    {
        return Err(Failure::usage("--obj: the colours beside it take the name with .mtl".to_owned()));
    }
    arguments.resources.in_pool(|| {
        let mut scene = arguments.reading.scene(&arguments.input, &arguments.resources)?;
        arguments.doors.apply(&mut scene, &arguments.resources)?;
        if let Some(path) = &arguments.graph {
            let graph = scene.graph();
            let is_dot = path
                .extension()
                .is_some_and(|e| e.eq_ignore_ascii_case("dot") || e.eq_ignore_ascii_case("gv"));
            let text = if is_dot { graph_dot(&scene, &graph) } else { graph_json(&scene, &graph) };
            output::write(Some(path), |out| out.write_all(text.as_bytes()))?;
        }
        if let Some(path) = &arguments.obj {
            let library = path.with_extension("mtl");
            let is_file = path.as_os_str() != "-";
            let name = library.file_name().and_then(|name| name.to_str()).filter(|_| is_file);
            let text = faces_obj(&scene, name);
            output::write(Some(path), |out| out.write_all(text.as_bytes()))?;
            if name.is_some() {
                output::write(Some(&library), |out| out.write_all(materials().as_bytes()))?;
            }
        }
        if let Some(path) = &arguments.cells {
            let bytes = cells_glb(&scene, arguments.explode);
            output::write(Some(path), |out| out.write_all(&bytes))?;
        }
        Ok(Outcome::Fine)
    })?
}
