//! `enfilade compile`.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use enfilade::compile::Report;
use serde::Serialize;

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources, compiled};
use super::{output, space};

/// Compile a model to a scene file (.enf).
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade compile house.glb -o house.enf\n  enfilade compile house.obj --unit mm --up z -o house.enf --json"
)]
pub struct Arguments {
    /// The model: .glb, .gltf or .obj.
    model: PathBuf,
    /// The scene to write.
    #[arg(short, long, value_name = "OUT.enf")]
    output: PathBuf,
    /// Keep the map of the building in the scene, for `validate`.
    #[arg(long, conflicts_with = "no_cells")]
    topology: bool,
    /// Pack nothing: every section is a plain array, for readers that map the file themselves. Of a
    /// large building it is nearly twice as long.
    #[arg(long)]
    plain: bool,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

#[derive(Serialize)]
struct Timed<'a> {
    import_seconds: f64,
    compile_seconds: f64,
    #[serde(flatten)]
    report: &'a Report,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let (compiled, import_seconds, compile_seconds) = arguments.resources.in_pool(|| {
        let start = Instant::now();
        let model = arguments.reading.model(&arguments.model, &arguments.resources)?;
        let imported = start.elapsed();
        let mut options = arguments.reading.compile_options(&arguments.resources);
        options.topology = arguments.topology;
        if arguments.plain {
            options.pack_from = u64::MAX;
        }
        let compiled = compiled(&model, &options)?;
        Ok((compiled, imported.as_secs_f64(), (start.elapsed() - imported).as_secs_f64()))
    })??;
    output::write(Some(&arguments.output), |out| out.write_all(&compiled.bytes))?;
    let timed = Timed { import_seconds, compile_seconds, report: &compiled.report };
    if arguments.json {
        return output::print_json(&timed);
    }
    arguments.resources.warn(&compiled.report.warnings);
    output::print(&text(&timed, &arguments.output.display().to_string()))
}

fn text(timed: &Timed<'_>, path: &str) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, timed, path);
    out
}

fn write_text(out: &mut String, timed: &Timed<'_>, path: &str) -> std::fmt::Result {
    let r = timed.report;
    writeln!(
        out,
        "{path}: {} bytes, {} elements, {} rooms, {} cells",
        r.bytes, r.elements, r.rooms, r.cells
    )?;
    if let Some(g) = &r.graph {
        writeln!(
            out,
            "{} prisms of air, {} of matter: {:.2} sections a cell of air, {:.2} faces a section; {:.0} bytes a cell, {:.1} a face",
            g.air, g.solid, g.sections_per_cell, g.faces_per_section, g.bytes_per_cell, g.bytes_per_face
        )?;
    }
    writeln!(out, "{} triangles in:", r.triangles_in)?;
    for row in &r.triangles_out {
        writeln!(out, "  {:>10} {}", row.count, row.what)?;
    }
    let d = &r.derived;
    if d.openings + d.rooms > 0 {
        writeln!(out, "found: {} openings ({} of them unfilled), {} rooms", d.openings, d.unfilled, d.rooms)?;
    }
    for path in &d.without_hole {
        writeln!(out, "in no hole of anything solid: {path}")?;
    }
    if let Some(why) = &d.failed {
        writeln!(out, "rooms could not be looked for: {why}")?;
    }
    if let Some(partition) = &r.partition {
        space::write(out, partition)?;
    }
    for row in &r.left_out {
        writeln!(out, "left out: {} {}", row.count, row.what)?;
    }
    if !r.findings.is_empty() {
        let counts: Vec<String> = r.findings.iter().map(|(code, count)| format!("{count} {code}")).collect();
        writeln!(out, "validation: {} (enfilade validate tells where)", counts.join(", "))?;
    }
    for repair in r.repairs.iter().filter(|repair| repair.count > 0) {
        writeln!(
            out,
            "repaired: {} {} (largest displacement {} m)",
            repair.count, repair.what, repair.largest_displacement
        )?;
    }
    if r.open_solid_components > 0 {
        writeln!(out, "{} components of solid elements are open, and stay detail", r.open_solid_components)?;
    }
    write!(out, "import {:.3} s, compile {:.3} s (", timed.import_seconds, timed.compile_seconds)?;
    for (i, stage) in r.stages.iter().enumerate() {
        write!(out, "{}{} {:.3}", if i > 0 { ", " } else { "" }, stage.name, stage.seconds)?;
    }
    writeln!(out, ")")
}
