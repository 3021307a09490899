//! `enfilade plan`.

use std::path::PathBuf;

use clap::Args;
use enfilade::Scene;
use enfilade::format::FormatError;
use enfilade::plan::{Mark, PlanOptions, PlanStorey, floor_plan, plan_png, plan_storeys, plan_svg};
use enfilade::render::numbered;
use enfilade::validate::examine;

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::output;

/// Draw floor plans: what a level plane through a storey cuts, as SVG at a scale of 1:100, or as PNG.
///
/// Walls are solid, rooms tinted and named with their floor area, doors brown, windows blue, other openings white. Findings of `validate` are
/// ringed and listed, of a model or of a scene that was compiled with --topology.
#[derive(Args)]
#[command(after_help = "\
Examples:
  enfilade plan house.enf -o house.svg
  enfilade plan house.glb -o ground.png --storey 'Ground floor' --size 3000
  enfilade plan house.glb -o house.svg --all             house.0001.svg, house.0002.svg...
  enfilade plan house.enf -o cells.svg --cells --no-detail")]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    input: PathBuf,
    /// The plan to write: .svg or .png.
    #[arg(short, long, value_name = "OUT.svg|OUT.png")]
    output: PathBuf,
    /// The storey: its name, or its number from 0, the lowest. Default: the one with most rooms, the lowest of equals.
    #[arg(long, value_name = "STOREY", conflicts_with = "all")]
    storey: Option<String>,
    /// All storeys, each to a numbered file, from the lowest up.
    #[arg(long)]
    all: bool,
    /// How high above the storey's floor to cut, metres.
    #[arg(long, value_name = "METRES", default_value_t = 1.2, value_parser = height)]
    height: f64,
    /// Draw the borders between cells, too.
    #[arg(long)]
    cells: bool,
    /// Leave furniture, door leaves and other detail out.
    #[arg(long)]
    no_detail: bool,
    /// Pixels of the longer side, for PNG.
    #[arg(long, value_name = "PIXELS", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(16..=16384))]
    size: u32,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

fn height(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(height) if height.is_finite() => Ok(height),
        _ => Err("not a number of metres".to_owned()),
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let extension = arguments.output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let is_png = match extension.as_deref() {
        Some("png") => true,
        Some("svg") => false,
        _ => return Err(Failure::usage(format!("{}: a plan is .svg or .png", arguments.output.display()))),
    };
    arguments.resources.in_pool(|| {
        let scene = arguments.reading.scene_with_map(&arguments.input, &arguments.resources)?;
        let options = options(arguments, &scene)
            .map_err(|e| Failure::input(format!("{}: {e}", arguments.input.display())))?;
        let storeys = chosen(arguments, plan_storeys(&scene))?;
        // One after the other: a picture may take a gigabyte.
        for (index, storey) in storeys.iter().enumerate() {
            let drawing = floor_plan(&scene, storey, &options);
            let bytes = if is_png {
                plan_png(&drawing, arguments.size).map_err(|e| Failure::usage(e.to_string()))?
            } else {
                plan_svg(&drawing).into_bytes()
            };
            let path = numbered(&arguments.output, index, storeys.len());
            output::write(Some(&path), |out| out.write_all(&bytes))?;
        }
        Ok(Outcome::Fine)
    })?
}

/// How to draw, with the findings of the building, if the scene has its map.
fn options(arguments: &Arguments, scene: &Scene) -> Result<PlanOptions, FormatError> {
    let mut options = PlanOptions::default();
    options.height = arguments.height;
    options.cells = arguments.cells;
    options.detail = !arguments.no_detail;
    if let Some(building) = scene.building()? {
        let mark = |finding: enfilade::validate::Finding| {
            let element = finding.element.and_then(|e| building.elements.get(e.0 as usize));
            let name = element.map_or("", |e| if e.name.is_empty() { &e.id } else { &e.name });
            let text = format!("{}: {}", finding.code.name(), finding.text);
            Mark { at: finding.at, of: name.to_owned(), text }
        };
        options.marks = examine(&building).findings.into_iter().map(mark).collect();
    }
    Ok(options)
}

fn chosen(arguments: &Arguments, storeys: Vec<PlanStorey>) -> Result<Vec<PlanStorey>, Failure> {
    if arguments.all {
        return Ok(storeys);
    }
    let most = |storeys: Vec<PlanStorey>| {
        // Of equals the first.
        storeys.into_iter().rev().max_by_key(|storey| storey.rooms).into_iter().collect()
    };
    let Some(wanted) = &arguments.storey else { return Ok(most(storeys)) };
    let by_name = storeys.iter().position(|storey| storey.name == *wanted);
    let by_number = wanted.parse::<usize>().ok().filter(|number| *number < storeys.len());
    match by_name.or(by_number) {
        Some(number) => Ok(vec![storeys[number].clone()]),
        None => {
            let names: Vec<String> = storeys
                .iter()
                .zip(0..)
                .map(|(storey, number)| format!("{number} ({})", storey.name))
                .collect();
            Err(Failure::usage(format!("no storey '{wanted}'; there are {}", names.join(", "))))
        }
    }
}
