//! Ways and daylight: prints the shortest way on foot from one room to another, and the rooms that have windows or doors to the open, with the
//! area of these beside the floor area.
//!
//!     cargo run --release --example ways -- fixtures/house.glb Bedroom Kitchen
//!     cargo run --release --example ways -- house.enf Bedroom Kitchen        # compiled with --topology
//!
//! Rooms are named as in the model, or by identity. Without names only the rooms with daylight are printed.

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write;
use std::path::{Path, PathBuf};

use enfilade::building::{Building, WayOptions};
use enfilade::graph::{Graph, Place, Side};
use enfilade::importers::{ElementId, ImportOptions, import};
use enfilade::partition::cells::Label;
use enfilade::{CompileOptions, Scene, compile};

const USAGE: &str = "usage: ways SCENE.enf|MODEL [FROM TO]";

struct Arguments {
    scene: PathBuf,
    ends: Option<[String; 2]>,
}

fn parse(words: impl IntoIterator<Item = String>) -> Result<Arguments, Box<dyn Error>> {
    let words: Vec<String> = words.into_iter().collect();
    match words.as_slice() {
        [scene] => Ok(Arguments { scene: scene.into(), ends: None }),
        [scene, from, to] => Ok(Arguments { scene: scene.into(), ends: Some([from.clone(), to.clone()]) }),
        _ => Err(USAGE.into()),
    }
}

/// A scene file is opened as it is; a model is compiled first, and its map kept.
fn load(path: &Path) -> Result<Scene, Box<dyn Error>> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("enf")) {
        return Ok(Scene::open(path)?);
    }
    let model = import(path, &ImportOptions::default())?;
    let mut options = CompileOptions::default();
    options.topology = true;
    Ok(compile(&model, &options)?.scene())
}

fn name(scene: &Scene, element: u32) -> &str {
    let element = scene.element(element);
    if element.name().is_empty() { element.id() } else { element.name() }
}

fn room(scene: &Scene, wanted: &str) -> Result<Label, Box<dyn Error>> {
    let element = scene.rooms().map(|room| room.element()).find(|e| e.name() == wanted || e.id() == wanted);
    Ok(Label::Air(ElementId(element.ok_or(format!("there is no room '{wanted}'"))?.index())))
}

fn label(scene: &Scene, label: Label) -> String {
    match label {
        Label::Air(element) | Label::Solid(element) => name(scene, element.0).to_owned(),
        Label::Exterior => "the open".to_owned(),
        Label::Void => "a void".to_owned(),
    }
}

fn way(
    scene: &Scene,
    building: &Building,
    ends: &[String; 2],
    out: &mut dyn Write,
) -> Result<(), Box<dyn Error>> {
    let [from, to] = [room(scene, &ends[0])?, room(scene, &ends[1])?];
    match building.way(from, to, &WayOptions::default()) {
        Some(way) => {
            let through: Vec<String> = way.through.iter().map(|&own| label(scene, own)).collect();
            writeln!(
                out,
                "{} ({:.1} m from the first doorway to the last)",
                through.join(" > "),
                way.length
            )?;
        }
        None => writeln!(out, "no way on foot from {} to {}", ends[0], ends[1])?,
    }
    Ok(())
}

/// By room: the area of its openings to the open, m2.
fn daylight(graph: &Graph) -> BTreeMap<u32, f64> {
    let mut areas = BTreeMap::new();
    for opening in &graph.openings {
        let room = match opening.sides {
            [Side::Room(room), Side::Exterior] | [Side::Exterior, Side::Room(room)] => room,
            _ => continue,
        };
        let passes = graph.portals.iter().filter(|portal| portal.opening == Some(opening.element));
        let open = passes.filter(|portal| portal.places == [Place::Room(room), Place::Exterior]);
        *areas.entry(room).or_default() += open.map(|portal| portal.area).sum::<f64>();
    }
    areas
}

/// Does what the command line asks for, and writes what it found.
pub fn run(words: impl IntoIterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let arguments = parse(words)?;
    let scene = load(&arguments.scene)?;
    if let Some(ends) = &arguments.ends {
        let building = scene.building()?.ok_or("the scene holds no map: compile it with --topology")?;
        way(&scene, &building, ends, out)?;
    }
    let graph = scene.graph();
    for (room, area) in daylight(&graph) {
        let node = &graph.rooms[room as usize];
        let share = 100.0 * area / node.floor_area.max(1e-9);
        writeln!(
            out,
            "{}: {area:.1} m2 to the open, {share:.0} % of {:.1} m2 of floor",
            name(&scene, node.element),
            node.floor_area
        )?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut std::io::stdout().lock())
}
