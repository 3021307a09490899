//! `enfilade validate`.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use enfilade::Scene;
use enfilade::building::Building;
use enfilade::derive::complete;
use enfilade::importers::Frame;
use enfilade::partition::partition;
use enfilade::validate::{Code, Report, examine};
use serde::Serialize;

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources, is_scene};
use super::output;

/// Check a building: openings that join nothing, rooms that leak, without a floor or a way out; and its map.
///
/// A model, or a scene that was compiled with `--topology`: both give the same, but options for reading models say nothing about a
/// scene. Ends with exit code 1 on any finding.
/// docs/VALIDATION.md tells what each code means.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade validate house.glb\n  enfilade validate house.glb --ignore S03 --ignore S04\n  enfilade validate house.glb --json\n  enfilade compile house.glb --topology -o house.enf && enfilade validate house.enf"
)]
pub struct Arguments {
    /// The model: .glb, .gltf or .obj; or a scene with its map: .enf.
    input: PathBuf,
    /// Do not report this code; may be given more than once.
    #[arg(long, value_name = "CODE", value_parser = code)]
    ignore: Vec<Code>,
    /// Print the findings as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

fn code(name: &str) -> Result<Code, String> {
    Code::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = Code::ALL.iter().map(|code| code.name()).collect();
        format!("no such code; there are {}", names.join(", "))
    })
}

#[derive(Serialize)]
struct Told<'a> {
    version: &'static str,
    source: String,
    volumes: usize,
    faces: usize,
    darts: usize,
    rooms: usize,
    openings: usize,
    #[serde(flatten)]
    report: &'a Report,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let (source, building, report) = arguments.resources.in_pool(|| {
        let (source, building, frame) = building(arguments)?;
        let report = examine(&building).without(&arguments.ignore).to_source(&frame);
        Ok::<_, Failure>((source, building, report))
    })??;
    if arguments.json {
        output::print_json(&Told {
            version: env!("CARGO_PKG_VERSION"),
            source,
            volumes: building.volumes.len(),
            faces: building.faces.len(),
            darts: building.topology.map.len(),
            rooms: building.rooms().count(),
            openings: building.openings().count(),
            report: &report,
        })?;
    } else {
        output::print(&text(&building, &report))?;
    }
    Ok(if report.findings.is_empty() { Outcome::Fine } else { Outcome::Findings })
}

/// The building of a model, or of a scene, with the name of the source and its frame.
fn building(arguments: &Arguments) -> Result<(String, Building, Frame), Failure> {
    let path = &arguments.input;
    if is_scene(path) {
        let scene = Scene::open(path).map_err(Failure::input)?;
        let told = scene.building().map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
        let building = told.ok_or_else(|| {
            let without =
                "the scene was compiled without its map: compile it with --topology, or validate the model";
            Failure::input(format!("{}: {without}", path.display()))
        })?;
        let provenance: serde_json::Value = serde_json::from_str(scene.provenance()).unwrap_or_default();
        let source = provenance["source"].as_str().unwrap_or_default().to_owned();
        return Ok((source, building, scene.frame()));
    }
    let model = arguments.reading.model(path, &arguments.resources)?;
    let source = model.source.clone();
    let failed = |error: &dyn std::fmt::Display| Failure::input(format!("{source}: {error}"));
    let options = arguments.reading.partition_options(&arguments.resources);
    let (model, _) =
        complete(&model, &arguments.reading.derive_options(), &options).map_err(|error| failed(&error))?;
    let (cells, _) = partition(&model, &options).map_err(|error| failed(&error))?;
    let building = Building::new(&model, &cells).map_err(|error| failed(&error))?;
    Ok((source.clone(), building, model.frame))
}

fn text(building: &Building, report: &Report) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, building, report);
    out
}

fn write_text(out: &mut String, building: &Building, report: &Report) -> std::fmt::Result {
    writeln!(
        out,
        "{} rooms, {} openings; {} volumes, {} faces, {} darts",
        building.rooms().count(),
        building.openings().count(),
        building.volumes.len(),
        building.faces.len(),
        building.topology.map.len()
    )?;
    for findings in report.findings.chunk_by(|a, b| a.code == b.code) {
        let code = findings[0].code;
        writeln!(out, "\n{} {}: {}", code.name(), code.title(), findings.len())?;
        for finding in findings {
            let [x, y, z] = finding.at;
            let element = finding.element.and_then(|e| building.elements.get(e.0 as usize));
            let who = element
                .map_or(String::new(), |e| format!("{} ", if e.name.is_empty() { &e.id } else { &e.name }));
            let size = if code.unit().is_empty() {
                String::new()
            } else {
                format!(" {:.4} {}", finding.size, code.unit())
            };
            writeln!(out, "  {who}at {x:.3} {y:.3} {z:.3}{size}: {}", finding.text)?;
        }
    }
    if report.findings.is_empty() {
        writeln!(out, "nothing found")?;
    }
    Ok(())
}
