//! `enfilade inspect`.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use enfilade::inspect::{Inspection, inspect};
use enfilade::partition::{figure, partition};

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources};
use super::{output, space};

/// Show what a model holds: elements by class, tag and role, closed or not, extent, what was left out and why; and what
/// cells its space is cut into.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade inspect house.glb\n  enfilade inspect house.obj --unit mm --up z --elements\n  enfilade inspect house.glb --json > house.json\n  enfilade inspect house.glb --figure cells.svg --height 1.5"
)]
pub struct Arguments {
    /// The model: .glb, .gltf or .obj.
    model: PathBuf,
    /// List every element.
    #[arg(long)]
    elements: bool,
    /// Print the whole report as JSON.
    #[arg(long)]
    json: bool,
    /// Draw the cells that a level plane cuts: matter grey, each room in a colour of its own, openings white, void red.
    #[arg(long, value_name = "OUT.svg", conflicts_with = "no_cells")]
    figure: Option<PathBuf>,
    /// Where that plane lies, along the axis that points up, in the model's own frame and unit. Default: 1.2 m above the
    /// floor of the largest room, or the lowest point.
    #[arg(long, value_name = "HEIGHT", requires = "figure", allow_negative_numbers = true)]
    height: Option<f64>,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let (inspection, drawn) = arguments.resources.in_pool(|| {
        let options = arguments.reading.import_options(&arguments.resources)?;
        let model = enfilade::importers::import(&arguments.model, &options).map_err(Failure::input)?;
        let mut inspection = inspect(&model, options.untagged, options.rules.as_ref());
        let mut drawn = None;
        if !arguments.reading.no_cells {
            match partition(&model, &arguments.reading.partition_options(&arguments.resources)) {
                Ok((cells, report)) => {
                    inspection.add_partition(&report, &model);
                    let frame = &model.frame;
                    let z = arguments.height.map(|height| height * frame.unit - frame.offset[2]);
                    let z = z.unwrap_or_else(|| figure::usual_height(&model));
                    drawn = arguments.figure.as_ref().map(|_| figure::svg(&cells, &model, z));
                }
                Err(error) if arguments.figure.is_some() => return Err(Failure::input(error)),
                Err(error) => inspection.warnings.push(format!("no cells: {error}")),
            }
        }
        Ok((inspection, drawn))
    })??;
    if let Some(drawn) = &drawn {
        output::write(arguments.figure.as_deref(), |out| out.write_all(drawn.as_bytes()))?;
    }
    if arguments.json {
        return output::print_json(&inspection);
    }
    arguments.resources.warn(&inspection.warnings);
    output::print(&text(&inspection, arguments.elements))
}

fn text(i: &Inspection, elements: bool) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, i, elements);
    out
}

fn write_text(out: &mut String, i: &Inspection, elements: bool) -> std::fmt::Result {
    writeln!(out, "{}: {} elements, {} triangles", i.source, i.elements.len(), i.triangles)?;
    let [lo, hi] = i.extent;
    writeln!(
        out,
        "extent ({:.3} {:.3} {:.3}) to ({:.3} {:.3} {:.3}), unit {} m, {} up",
        lo[0], lo[1], lo[2], hi[0], hi[1], hi[2], i.unit, i.up
    )?;
    if i.offset != [0.0; 3] {
        writeln!(out, "offset taken off inside: {:?} m (Z up)", i.offset)?;
    }
    writeln!(out, "{} materials, {} lights, {} cameras", i.materials, i.lights, i.cameras)?;
    writeln!(out)?;
    writeln!(
        out,
        "{:<28} {:<13} {:<7} {:>8} {:>10} {:>8}",
        "class", "semantic", "role", "elements", "triangles", "closed"
    )?;
    for g in &i.groups {
        let class = if g.class.is_empty() { "-" } else { &g.class };
        writeln!(
            out,
            "{:<28} {:<13} {:<7} {:>8} {:>10} {:>8}",
            class, g.semantic, g.role, g.elements, g.triangles, g.closed
        )?;
    }
    let open: Vec<_> = i.elements.iter().filter(|e| e.role == "detail" && e.open_edges > 0).collect();
    let open_solids: Vec<_> = open
        .iter()
        .filter(|e| matches!(e.semantic, "WALL" | "GROUND" | "CEILING" | "ROOF" | "COLUMN" | "BEAM"))
        .collect();
    if !open_solids.is_empty() {
        writeln!(out, "\nnot closed, and so detail, though tagged solid:")?;
        for e in open_solids.iter().take(20) {
            let [a, _] = e.open_at.first().copied().unwrap_or_default();
            writeln!(
                out,
                "  {} '{}': {} open edges, one at ({:.3} {:.3} {:.3})",
                e.id, e.name, e.open_edges, a[0], a[1], a[2]
            )?;
        }
        if open_solids.len() > 20 {
            writeln!(out, "  and {} more (--json lists all)", open_solids.len() - 20)?;
        }
    }
    if let Some(partition) = &i.partition {
        writeln!(out)?;
        space::write(out, partition)?;
    }
    if !i.left_out.is_empty() {
        writeln!(out, "\nleft out:")?;
        for l in i.left_out.iter().take(20) {
            writeln!(out, "  {} {} at {} {}", l.count, l.reason, l.place, l.element)?;
        }
        if i.left_out.len() > 20 {
            writeln!(out, "  and {} more (--json lists all)", i.left_out.len() - 20)?;
        }
    }
    if elements {
        writeln!(out)?;
        for e in &i.elements {
            writeln!(
                out,
                "{:>6} {:<24} {:<13} {:<7} {:>7} triangles, {}/{} closed, by {}, '{}'",
                e.index,
                e.id,
                e.semantic,
                e.role,
                e.triangles,
                e.closed_components,
                e.components,
                e.tagged_by,
                e.name
            )?;
        }
    }
    Ok(())
}
