//! `enfilade bench`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Subcommand};
use enfilade::bench::{ErrorOptions, FrozenScene, SpeedOptions, error, error_names, names, speed};
use enfilade::importers::gltf::read_slice;
use enfilade::importers::tagging::tag;
use enfilade::importers::{ImportOptions, Model};
use enfilade::plan::{Drawing, plan_png, plan_svg};
use enfilade::render::{Camera, parse_cameras, room_views};
use enfilade::{CompileOptions, Scene, compile};

use super::failure::{Failure, Outcome};
use super::input::{Reading, Resources, model_of};
use super::output;
use super::render::{parse_picture_size, read_cameras};

/// Pixels along the longer side of figures.
const FIGURE: u32 = 1400;

/// Measure: time per frame and per ray of every way to answer rays; with `error`, beside what each gets wrong; with `cells`, how many cells rays
/// cross; with `robust`, what growing damage does to all that; with `skip`, what is not done, and what that saves; with
/// `sources`, where errors come from.
#[derive(Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "\
Examples:
  enfilade bench house.enf
  enfilade bench house.enf --cams walk.txt --size 1024x1024 --repeat 9 --json
  enfilade bench --frozen build2
  enfilade bench error house.enf --model house.glb
  enfilade bench error --frozen house --figure house.svg --figure house.png
  enfilade bench cells house.glb
  enfilade bench robust --frozen house --figure robust.svg
  enfilade bench skip house.glb
  enfilade bench sources house.glb

Times are medians of interleaved repeats; compare them within one run only. Ways named enfilade-beams-... and enfilade-packets-... make whole pictures; enfilade-auto
takes beams or rays, as the scene, the eye and the size of the picture have it. These paint colours; enfilade-hits tells of each pixel what its ray would, and asks rays on edges. The share of pixels that beams, packets and rays really answered is in the JSON. Ways named obvhs-... are that library
by itself on the same triangles."
)]
pub struct Arguments {
    #[command(subcommand)]
    what: Option<What>,
    /// The scene (.enf), or a model, which is compiled on the fly.
    #[arg(required_unless_present = "frozen")]
    scene: Option<PathBuf>,
    /// A scene of benches/scenes.toml, made anew and checked by its hash, with its cameras: house, build1, build2,
    /// build3, tower, random, build1-cad, round-room; house-bare to build3-bare without furniture.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["scene", "cams"])]
    frozen: Option<String>,
    #[command(flatten)]
    common: Common,
}

#[derive(Subcommand)]
enum What {
    Cells(super::bench_cells::Arguments),
    /// Time beside error, by exact arithmetic: pixels that are wrong, how far the others are off, leaks, surfaces met twice, pictures.
    ///
    /// Ends with exit code 1 if one of the ways named enfilade-..., but for enfilade-f32-rays, or the truth has a wrong pixel.
    Error(Error),
    Robust(super::bench_robust::Arguments),
    Skip(super::bench_skip::Arguments),
    Sources(super::bench_sources::Arguments),
}

#[derive(Args)]
struct Error {
    /// The scene (.enf), or a model, which is compiled on the fly.
    #[arg(required_unless_present = "frozen")]
    scene: Option<PathBuf>,
    /// The model that the scene was compiled from: the truth. Not needed if that is what is compiled on the fly.
    #[arg(long, value_name = "MODEL")]
    model: Option<PathBuf>,
    /// A scene of benches/scenes.toml, made anew and checked by its hash, with its cameras.
    #[arg(long, value_name = "NAME", conflicts_with_all = ["scene", "model", "cams"])]
    frozen: Option<String>,
    /// Where to draw error against time: .svg, or .png. May be given more than once.
    #[arg(long, value_name = "FILE")]
    figure: Vec<PathBuf>,
    /// Print the tables as Markdown.
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Args)]
struct Common {
    /// A file of cameras; by default two level views from the middle of each room, at most 20 in all.
    #[arg(long, value_name = "FILE")]
    cams: Option<PathBuf>,
    /// Pixels.
    #[arg(long, value_name = "WxH", default_value = "512x512", value_parser = parse_picture_size)]
    size: (u32, u32),
    /// How often each frame is traced; the median counts.
    #[arg(long, value_name = "R", default_value_t = 5)]
    repeat: u32,
    /// Which ways, by name; by default all.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    kernels: Vec<String>,
    /// Print the report as JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    resources: Resources,
}

impl Common {
    fn kernels(&self, known: Vec<String>) -> Result<Vec<String>, Failure> {
        match self.kernels.iter().find(|k| !known.contains(k)) {
            Some(unknown) => {
                Err(Failure::usage(format!("no way '{unknown}' on this machine; there are {known:?}")))
            }
            None if self.kernels.is_empty() => Ok(known),
            None => Ok(self.kernels.clone()),
        }
    }

    fn views(&self, scene: &Scene) -> Result<Vec<Camera>, Failure> {
        views(scene, self.cams.as_deref())
    }

    /// One thread unless asked for more: times of several depend on what else the machine does.
    fn pool(&self) -> Resources {
        let mut resources = self.resources.clone();
        resources.threads = resources.threads.max(1);
        resources
    }

    fn scene(&self, path: &Path) -> Result<Arc<Scene>, Failure> {
        self.reading.scene(path, &self.resources).map(Arc::new)
    }
}

pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    match (&arguments.what, &arguments.scene, &arguments.frozen) {
        (Some(What::Cells(cells)), ..) => super::bench_cells::run(cells),
        (Some(What::Error(error)), ..) => run_error(error),
        (Some(What::Robust(robust)), ..) => super::bench_robust::run(robust),
        (Some(What::Skip(skip)), ..) => super::bench_skip::run(skip),
        (Some(What::Sources(sources)), ..) => super::bench_sources::run(sources),
        (None, Some(scene), _) => run_speed(common, || {
            let scene = common.scene(scene)?;
            let views = common.views(&scene)?;
            Ok((scene, views))
        }),
        (None, None, Some(name)) => run_speed(common, || frozen(name)),
        (None, None, None) => Err(Failure::usage("which scene? see enfilade bench --help")),
    }
}

/// Writes a figure to files, as their names end.
pub fn draw(paths: &[PathBuf], drawing: impl Fn() -> Drawing) -> Result<(), Failure> {
    for path in paths {
        let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        let bytes = if is_png {
            plan_png(&drawing(), FIGURE).map_err(|e| Failure::usage(e.to_string()))?
        } else {
            plan_svg(&drawing()).into_bytes()
        };
        output::write(Some(path), |out| out.write_all(&bytes))?;
    }
    Ok(())
}

/// The cameras of a file; by default two level views from the middle of each room, as many as the documented figures use.
pub fn views(scene: &Scene, cams: Option<&Path>) -> Result<Vec<Camera>, Failure> {
    /// As many as the documented figures use.
    const MOST: usize = 20;
    if let Some(path) = cams {
        return read_cameras(path, &scene.frame());
    }
    let views = room_views(scene, 2);
    if views.is_empty() {
        return Ok(vec![enfilade::render::outside_view(scene)]);
    }
    let step = views.len().div_ceil(MOST);
    Ok(views.into_iter().step_by(step).collect())
}

/// A frozen scene's model, made anew.
pub fn frozen_model(name: &str) -> Result<(FrozenScene, Model), Failure> {
    let frozen = FrozenScene::by_name(name).map_err(|e| Failure::usage(e.to_string()))?;
    let glb = frozen.glb().map_err(|e| Failure::Input(e.into()))?;
    let options = ImportOptions::default();
    let mut model = read_slice(&glb, name, &options).map_err(|e| Failure::Input(e.into()))?;
    tag(&mut model, &options).map_err(|e| Failure::Input(e.into()))?;
    Ok((frozen, model))
}

/// A frozen scene and its cameras.
fn frozen(name: &str) -> Result<(Arc<Scene>, Vec<Camera>), Failure> {
    let (frozen, model) = frozen_model(name)?;
    compiled(&frozen, &model)
}

fn compiled(frozen: &FrozenScene, model: &Model) -> Result<(Arc<Scene>, Vec<Camera>), Failure> {
    let compiled = compile(model, &CompileOptions::default()).map_err(|e| Failure::Input(e.into()))?;
    let scene = Arc::new(compiled.scene());
    let views = parse_cameras(&frozen.cameras, "benches/scenes.toml", &scene.frame())
        .map_err(|e| Failure::Input(e.into()))?;
    Ok((scene, views))
}

fn run_speed(
    common: &Common,
    load: impl FnOnce() -> Result<(Arc<Scene>, Vec<Camera>), Failure> + Send,
) -> Result<Outcome, Failure> {
    common.pool().in_pool(|| {
        let (scene, views) = load()?;
        let mut options = SpeedOptions::default();
        options.size = common.size;
        options.repeat = common.repeat;
        options.kernels = common.kernels(names())?;
        let report = speed(&scene, &views, &options);
        if common.json {
            return output::print_json(&report);
        }
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "{}, {} thread(s), {} triangles, medians of {}",
            report.machine, report.threads, report.triangles, report.repeat
        );
        let _ = writeln!(
            out,
            "{:<8} {:<25} {:>7} {:>11} {:>10} {:>10} {:>7} {:>10}",
            "rays", "kernel", "frames", "frame ms", "ns/ray", "Mrays/s", "ratio", "differing"
        );
        for r in &report.rows {
            let _ = writeln!(
                out,
                "{:<8} {:<25} {:>7} {:>11.3} {:>10.1} {:>10.2} {:>7.2} {:>10}",
                r.rays, r.kernel, r.frames, r.frame_ms, r.ns_per_ray, r.mrays_per_s, r.ratio, r.differing
            );
        }
        output::print(&out)
    })?
}

fn run_error(arguments: &Error) -> Result<Outcome, Failure> {
    let common = &arguments.common;
    // What was told is judged on all cores.
    Resources { threads: 0, ..common.resources.clone() }.in_pool(|| {
        let (name, scene, model, views) = match (&arguments.frozen, &arguments.scene) {
            (Some(name), _) => {
                let (frozen, model) = frozen_model(name)?;
                let (scene, views) = compiled(&frozen, &model)?;
                (name.clone(), scene, model, views)
            }
            (None, Some(path)) => {
                let scene = common.scene(path)?;
                let model =
                    common.reading.model(model_of(path, arguments.model.as_deref())?, &common.resources)?;
                let views = common.views(&scene)?;
                (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), scene, model, views)
            }
            (None, None) => return Err(Failure::usage("which scene? see enfilade bench error --help")),
        };
        let mut options = ErrorOptions::default();
        options.size = common.size;
        options.repeat = common.repeat;
        options.kernels = common.kernels(error_names())?;
        // A frozen scene is compiled with the usual options.
        if arguments.frozen.is_none() {
            options.untagged = common.reading.untagged.untagged();
        }
        options.threads = common.pool().threads;
        let report = error(&scene, &model, &views, &[], &options).map_err(Failure::input)?;
        draw(&arguments.figure, || report.chart(&name))?;
        if common.json {
            output::print_json(&report)?;
        } else {
            output::print(&if arguments.markdown { report.markdown() } else { report.text() })?;
        }
        Ok(if report.passed() { Outcome::Fine } else { Outcome::Findings })
    })?
}
