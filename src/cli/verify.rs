//! `enfilade verify`.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use enfilade::importers::Role;
use enfilade::roles::roles;
use enfilade::verify::{Case, MOST_EXCUSED, sees, standing, tell_sheets, without};
use enfilade::{Hit, Ray, VerifyOptions, VerifyReport, Want, verify};
use serde::Serialize;

use super::doors::Doors;
use super::failure::{Failure, Outcome};
use super::hide::Hide;
use super::input::{Reading, Resources, model_of};
use super::output;

/// Check a scene against the model that it was compiled from: random rays against the truth, a second tracer
/// in f64 that shares no code with the first and is itself checked against brute force.
///
/// An answer is right if it is the exact answer to some parallel ray at most the tolerance away. Ends with exit code 1
/// on any wrong ray, on any part of a ray that is called free or occluded otherwise than the whole ray says, or if more than 0.1 % had to be excused (edges, starts in solids).
#[derive(Args)]
#[command(
    after_help = "Examples:\n  enfilade verify house.glb\n  enfilade verify house.enf --model house.glb\n  enfilade verify house.enf --model house.glb --rays 10000000 --seed 7 --json"
)]
pub struct Arguments {
    /// The scene (.enf), or a model, which is compiled on the fly.
    scene: PathBuf,
    /// The model that the scene was compiled from: the truth. Not needed if that is what is compiled on the fly.
    #[arg(long, value_name = "MODEL")]
    model: Option<PathBuf>,
    /// Random rays, from rooms and from outside.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    rays: u64,
    /// Where the random numbers start.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    hide: Hide,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

#[derive(Serialize)]
struct Timed<'a> {
    version: &'static str,
    scene: String,
    model: String,
    passed: bool,
    seconds: f64,
    #[serde(flatten)]
    report: &'a VerifyReport,
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let truth = model_of(&arguments.scene, arguments.model.as_deref())?;
    let (report, seconds) = arguments.resources.in_pool(|| {
        let model = arguments.reading.model(truth, &arguments.resources)?;
        let mut scene = arguments.reading.scene(&arguments.scene, &arguments.resources)?;
        // What was found in the building comes after what the model says.
        let own = scene.elements().filter(|element| !element.is_derived());
        if !own.map(|element| element.id()).eq(model.elements.iter().map(|element| element.id.as_str())) {
            return Err(Failure::input(format!(
                "{} was not compiled from {}: their elements differ",
                arguments.scene.display(),
                truth.display()
            )));
        }
        arguments.doors.apply(&mut scene, &arguments.resources)?;
        let hidden = arguments.hide.apply(&mut scene)?;
        let own = model.elements.len();
        let (model, lacking) = without(model, |element, material| hidden.has(element, material));
        let model = standing(model, &scene);
        let mut roles = roles(&model, arguments.reading.untagged.untagged());
        lacking.into_iter().for_each(|element| roles[element as usize] = Role::Detail);
        roles[own..].fill(Role::Detail);
        let trace = |rays: &[Ray], hits: &mut [Hit]| {
            scene.trace_many(rays, hits, Want::LEAST);
            tell_sheets(&scene, own as u32, hits);
        };
        let tracer = (trace, |rays: &[Ray]| sees(&scene, rays));
        let options = VerifyOptions::default()
            .with_rays(arguments.rays)
            .with_seed(arguments.seed)
            .with_tolerance(scene.tolerance())
            .with_watch(arguments.resources.watch());
        let start = Instant::now();
        let report = verify(&model, |e| roles[e.0 as usize], &tracer, &options).map_err(Failure::input)?;
        Ok((report, start.elapsed().as_secs_f64()))
    })??;
    let passed = report.passed();
    if arguments.json {
        output::print_json(&Timed {
            version: env!("CARGO_PKG_VERSION"),
            scene: arguments.scene.display().to_string(),
            model: truth.display().to_string(),
            passed,
            seconds,
            report: &report,
        })?;
    } else {
        output::print(&text(&report, passed, seconds))?;
    }
    Ok(if passed { Outcome::Fine } else { Outcome::Findings })
}

fn text(report: &VerifyReport, passed: bool, seconds: f64) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, report, passed, seconds);
    out
}

fn write_text(out: &mut String, r: &VerifyReport, passed: bool, seconds: f64) -> std::fmt::Result {
    writeln!(
        out,
        "{} rays on {} triangles, tolerance {} m, {seconds:.1} s",
        r.total.rays, r.triangles, r.tolerance
    )?;
    writeln!(
        out,
        "{:<8} {:>9} {:>9} {:>8} {:>7} {:>7} {:>7} {:>9} {:>7}",
        "from", "rays", "exact", "escaped", "close", "flush", "edge", "in solid", "wrong"
    )?;
    let all = r.kinds.iter().map(|k| (format!("{:?}", k.kind).to_lowercase(), &k.tally));
    for (name, t) in all.chain([("all".to_owned(), &r.total)]) {
        writeln!(
            out,
            "{name:<8} {:>9} {:>9} {:>8} {:>7} {:>7} {:>7} {:>9} {:>7}",
            t.rays,
            t.exact,
            t.escaped,
            t.close,
            t.flush,
            t.edge,
            t.in_solid_agreed + t.in_solid_edge,
            t.wrong
        )?;
    }
    writeln!(
        out,
        "forward error: max {:.3e} m, rms {:.3e} m, 99 % within {:.3e} m; largest backward error {:.3e} m",
        r.forward.max, r.forward.rms, r.forward.p99, r.largest_backward
    )?;
    writeln!(
        out,
        "excused: {:.4} % of the random rays (at most {} %)",
        r.excused * 100.0,
        MOST_EXCUSED * 100.0
    )?;
    writeln!(
        out,
        "the truth's grid against brute force: {} rays, {} differing",
        r.grid.rays, r.grid.different
    )?;
    writeln!(
        out,
        "segments: {}, {} with something in their way, {} told otherwise than their rays",
        r.sight.rays, r.sight.occluded, r.sight.different
    )?;
    for sight in &r.sight.cases {
        let ([ox, oy, oz], [dx, dy, dz]) = (sight.origin, sight.direction);
        writeln!(
            out,
            "segment: {ox} {oy} {oz} {dx} {dy} {dz} up to {} m (internal frame), {}",
            sight.tmax,
            if sight.occluded { "called free" } else { "called occluded" }
        )?;
    }
    for case in &r.wrong {
        write_case(out, "wrong", case)?;
    }
    for case in r.edges.iter().take(3) {
        write_case(out, "edge", case)?;
    }
    writeln!(out, "{}", if passed { "passed" } else { "FAILED" })
}

fn write_case(out: &mut String, what: &str, case: &Case) -> std::fmt::Result {
    let [ox, oy, oz] = case.origin;
    let [dx, dy, dz] = case.direction;
    writeln!(out, "{what}: {ox} {oy} {oz} {dx} {dy} {dz} (internal frame)")?;
    writeln!(out, "    answered {:?}, exact {:?}: {:?}", case.answered, case.expected, case.verdict)
}
