//! Reading models and scenes, and the options that all commands share.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use clap::{Args, ValueEnum};
use enfilade::derive::DeriveOptions;
use enfilade::importers::tagging::Rules;
use enfilade::importers::{ImportOptions, Limits, Model, Untagged, UpAxis, Watch, import};
use enfilade::partition::{Convexification, PartitionOptions};
use enfilade::{CompileOptions, Compiled, Scene, compile};
use indicatif::{ProgressBar, ProgressStyle};

use super::failure::Failure;

/// What every command may spend.
#[derive(Args, Debug, Clone)]
#[command(next_help_heading = "Resources")]
pub struct Resources {
    /// Threads; 0 for all cores.
    #[arg(short = 'j', long = "threads", value_name = "N", default_value_t = 0)]
    pub threads: usize,
    /// Most memory that loading and compiling may use: bytes, or with K, M, G (powers of 1024).
    #[arg(long, value_name = "SIZE", default_value = "8G", value_parser = parse_size)]
    pub max_memory: u64,
    /// Most elements that a model may have.
    #[arg(long, value_name = "N", default_value_t = 4_000_000)]
    pub max_elements: u64,
    /// No progress and no warnings on stderr.
    #[arg(short, long)]
    pub quiet: bool,
}

/// How to read a model.
#[derive(Args, Debug, Clone)]
#[command(next_help_heading = "Reading models")]
pub struct Reading {
    /// Unit of an OBJ file: m, cm, mm, ft, in, or metres in one unit.
    #[arg(long, value_name = "UNIT", value_parser = parse_unit)]
    pub unit: Option<f64>,
    /// Which axis of an OBJ file points up: y (default) or z.
    #[arg(long, value_name = "AXIS", value_parser = parse_up, allow_hyphen_values = true)]
    pub up: Option<Up>,
    /// Tagging rules that go before all others (docs/TAGGING.md).
    #[arg(long, value_name = "FILE")]
    pub rules: Option<PathBuf>,
    /// What to make of elements without a tag: by-mesh makes closed meshes solid and others detail.
    #[arg(long, value_enum, value_name = "WHAT", default_value = "by-mesh")]
    pub untagged: UntaggedAs,
    /// Tolerance of answers, metres.
    #[arg(long, value_name = "METRES", default_value_t = 1e-3)]
    pub tolerance: f64,
    /// What to find in the building where the model does not say it (docs/GRAPH.md): all; openings of doors and windows only; or nothing.
    #[arg(long, value_enum, value_name = "WHAT", default_value = "all")]
    pub derive: DeriveWhat,
    /// Rooms are told apart at holes in walls up to so wide, where no tag names any room; metres.
    #[arg(long, value_name = "METRES", default_value_t = 3.0, value_parser = parse_length)]
    pub widest_hole: f64,
    /// What would be one room larger than this is cut at gaps in walls and where corridors come to halls; square metres.
    #[arg(long, value_name = "M2", default_value_t = 100.0, value_parser = parse_length)]
    pub open_plan: f64,
    /// No corridor is wider than this, metres; 0 leaves open plans whole.
    #[arg(long, value_name = "METRES", default_value_t = 4.5, value_parser = parse_length)]
    pub widest_corridor: f64,
    /// What is found as a room has at least this floor area, square metres.
    #[arg(long, value_name = "M2", default_value_t = 0.7, value_parser = parse_length)]
    pub least_room: f64,
    /// Leave the space one cell, instead of cutting it into convex cells (docs/PARTITION.md): as right, smaller.
    #[arg(long)]
    pub no_cells: bool,
    /// How rooms that are not convex are cut: by the expected cost of rays, or by diagonals alone, the base line of the paper.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Convexify::Cost)]
    pub convexification: Convexify,
}

/// What `--convexification` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Convexify {
    Cost,
    Diagonals,
}

impl Convexify {
    fn how(self) -> Convexification {
        match self {
            Convexify::Cost => Convexification::Cost,
            Convexify::Diagonals => Convexification::Diagonals,
        }
    }
}

/// What `--up` says: an axis of the model, or for `render` what is up in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Up {
    Axis(UpAxis),
    Vector(Point),
}

/// Three numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point(pub [f64; 3]);

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum UntaggedAs {
    ByMesh,
    Solid,
    Detail,
    Error,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum DeriveWhat {
    All,
    Openings,
    Nothing,
}

fn parse_length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(length) if length.is_finite() && length >= 0.0 => Ok(length),
        _ => Err("not a number from 0 up".to_owned()),
    }
}

impl UntaggedAs {
    pub fn untagged(self) -> Untagged {
        match self {
            UntaggedAs::ByMesh => Untagged::ByMesh,
            UntaggedAs::Solid => Untagged::Solid,
            UntaggedAs::Detail => Untagged::Detail,
            UntaggedAs::Error => Untagged::Error,
        }
    }
}

/// Which frame coordinates are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FrameName {
    /// The model's own frame and unit.
    Source,
    /// Metres, Z up, offset taken off.
    Internal,
}

fn parse_size(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor: u64 = match text[digits.len()..].to_ascii_uppercase().as_str() {
        "" | "B" => 1,
        "K" | "KB" | "KIB" => 1 << 10,
        "M" | "MB" | "MIB" => 1 << 20,
        "G" | "GB" | "GIB" => 1 << 30,
        other => return Err(format!("'{other}' is no unit of memory: K, M or G")),
    };
    let number: f64 = digits.parse().map_err(|_| format!("'{digits}' is no number"))?;
    if number > 0.0 && number * factor as f64 <= 1e18 {
        Ok((number * factor as f64) as u64)
    } else {
        Err("must be more than 0 and at most 1e18 bytes".to_owned())
    }
}

/// `1,2,3` or `1 2 3`.
pub fn parse_point(text: &str) -> Result<Point, String> {
    let numbers: Result<Vec<f64>, _> =
        text.split([',', ' ']).filter(|w| !w.is_empty()).map(str::parse::<f64>).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if x.is_finite() && y.is_finite() && z.is_finite() => Ok(Point([x, y, z])),
        _ => Err("not three numbers, as 1,2,3".to_owned()),
    }
}

fn parse_up(text: &str) -> Result<Up, String> {
    match text {
        "y" | "Y" => Ok(Up::Axis(UpAxis::Y)),
        "z" | "Z" => Ok(Up::Axis(UpAxis::Z)),
        vector => parse_point(vector).map(Up::Vector).map_err(|_| "neither y nor z".to_owned()),
    }
}

/// Joins numbers that follow `--eye`, `--target` or `--up` one by one into one value: `--eye 1 2 3` is `--eye 1,2,3`.
pub fn join_points(arguments: impl Iterator<Item = std::ffi::OsString>) -> Vec<std::ffi::OsString> {
    let is_number = |s: &std::ffi::OsStr| s.to_str().is_some_and(|s| s.parse::<f64>().is_ok());
    let arguments: Vec<_> = arguments.collect();
    let mut joined = Vec::with_capacity(arguments.len());
    let mut i = 0;
    while i < arguments.len() {
        joined.push(arguments[i].clone());
        let takes_point = ["--eye", "--target", "--up"].iter().any(|name| arguments[i] == *name);
        i += 1;
        if takes_point && i + 3 <= arguments.len() && arguments[i..i + 3].iter().all(|a| is_number(a)) {
            joined.push(arguments[i..i + 3].join(std::ffi::OsStr::new(",")));
            i += 3;
        }
    }
    joined
}

fn parse_unit(text: &str) -> Result<f64, String> {
    match text {
        "m" => Ok(1.0),
        "cm" => Ok(0.01),
        "mm" => Ok(0.001),
        "ft" => Ok(0.3048),
        "in" => Ok(0.0254),
        number => match number.parse::<f64>() {
            Ok(n) if n.is_finite() && n > 0.0 => Ok(n),
            _ => Err("neither m, cm, mm, ft, in nor a positive number".to_owned()),
        },
    }
}

impl Resources {
    pub fn limits(&self) -> Limits {
        Limits::default().with_max_memory(self.max_memory).with_max_elements(self.max_elements)
    }

    /// Runs `work` on a pool of as many threads as asked for.
    pub fn in_pool<T: Send>(&self, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()
            .map_err(|e| Failure::usage(format!("no {} threads: {e}", self.threads)))?;
        Ok(pool.install(work))
    }

    /// Progress on stderr, if that is a terminal and nobody asked for quiet.
    pub fn watch(&self) -> Watch {
        use std::io::IsTerminal;
        if self.quiet || !std::io::stderr().is_terminal() {
            return Watch::default();
        }
        let bar = ProgressBar::new(1000);
        let style = ProgressStyle::with_template("{msg:>12} [{bar:30}] {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let bar = Arc::new(Mutex::new(bar));
        Watch::default().with_progress(move |stage, done| {
            // A poisoned lock means another thread panicked: its message matters, not this bar.
            if let Ok(bar) = bar.lock() {
                bar.set_message(stage.to_owned());
                bar.set_position((done.clamp(0.0, 1.0) * 1000.0) as u64);
                if done >= 1.0 {
                    bar.set_position(0);
                    bar.set_message(String::new());
                    bar.finish_and_clear();
                }
            }
        })
    }

    /// Prints warnings on stderr.
    pub fn warn(&self, warnings: &[String]) {
        if !self.quiet {
            for warning in warnings {
                eprintln!("enfilade: warning: {warning}");
            }
        }
    }
}

impl Reading {
    pub fn import_options(&self, resources: &Resources) -> Result<ImportOptions, Failure> {
        let mut options = ImportOptions::default();
        options.unit = self.unit;
        options.up = match self.up {
            Some(Up::Axis(axis)) => Some(axis),
            Some(Up::Vector(_)) | None => None,
        };
        options.limits = resources.limits();
        options.rules = self.rules.as_deref().map(Rules::load).transpose().map_err(Failure::input)?;
        options.untagged = self.untagged.untagged();
        options.watch = resources.watch();
        Ok(options)
    }

    pub fn compile_options(&self, resources: &Resources) -> CompileOptions {
        let mut options = CompileOptions::default();
        options.tolerance = self.tolerance;
        options.cells = !self.no_cells;
        options.convexification = self.convexification.how();
        options.derive = self.derive_options();
        options.untagged = self.untagged.untagged();
        options.limits = resources.limits();
        options.watch = resources.watch();
        options
    }

    pub fn derive_options(&self) -> DeriveOptions {
        let mut options = DeriveOptions::NOTHING;
        options.openings = !matches!(self.derive, DeriveWhat::Nothing);
        options.rooms = matches!(self.derive, DeriveWhat::All);
        options.widest_hole = self.widest_hole;
        options.least_area = self.least_room;
        options.open_plan = self.open_plan;
        options.widest_corridor = self.widest_corridor;
        options
    }

    /// Reads and tags a model.
    pub fn model(&self, path: &Path, resources: &Resources) -> Result<Model, Failure> {
        import(path, &self.import_options(resources)?).map_err(Failure::input)
    }

    pub fn partition_options(&self, resources: &Resources) -> PartitionOptions {
        PartitionOptions::default()
            .with_convexification(self.convexification.how())
            .with_untagged(self.untagged.untagged())
            .with_limits(resources.limits())
            .with_watch(resources.watch())
    }

    /// Opens a scene, or compiles a model on the fly.
    pub fn scene(&self, path: &Path, resources: &Resources) -> Result<Scene, Failure> {
        self.scene_with(path, resources, false)
    }

    /// The same; of a model its map is kept, too.
    pub fn scene_with_map(&self, path: &Path, resources: &Resources) -> Result<Scene, Failure> {
        self.scene_with(path, resources, true)
    }

    fn scene_with(&self, path: &Path, resources: &Resources, topology: bool) -> Result<Scene, Failure> {
        if is_scene(path) {
            return Scene::open(path).map_err(Failure::input);
        }
        let model = self.model(path, resources)?;
        let mut options = self.compile_options(resources);
        options.topology = topology;
        // Its bytes are read at once.
        options.pack_from = u64::MAX;
        let compiled = compiled(&model, &options)?;
        resources.warn(&compiled.report.warnings);
        Ok(compiled.scene())
    }
}

/// A model compiled.
pub fn compiled(model: &Model, options: &CompileOptions) -> Result<Compiled, Failure> {
    compile(model, options).map_err(|e| Failure::input(format!("{}: {e}", model.source)))
}

/// The model that a scene was compiled from: the one that is told, or the scene itself, if that is a model.
pub fn model_of<'a>(scene: &'a Path, model: Option<&'a Path>) -> Result<&'a Path, Failure> {
    match model {
        Some(model) => Ok(model),
        None if is_scene(scene) => {
            Err(Failure::usage("--model MODEL is needed: what was the scene compiled from?"))
        }
        None => Ok(scene),
    }
}

/// Whether a file is a compiled scene, by its first bytes or, if it has none, by its name.
pub fn is_scene(path: &Path) -> bool {
    use std::io::Read;
    let mut first = [0; 8];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut first));
    match read {
        Ok(()) if first == enfilade::format::MAGIC => true,
        _ => path.extension().is_some_and(|e| e.eq_ignore_ascii_case("enf")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_joined() {
        let join = |line: &str| {
            let joined = join_points(line.split(' ').map(Into::into));
            joined.iter().map(|s| s.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(
            join("render --eye 1 -2 3 a.enf --target 1,2,3 b"),
            "render --eye 1,-2,3 a.enf --target 1,2,3 b"
        );
        assert_eq!(join("render a.obj --up z -o 1"), "render a.obj --up z -o 1");
        assert_eq!(parse_point("1, -2.5 3"), Ok(Point([1.0, -2.5, 3.0])));
        assert!(
            parse_point("1,2").is_err() && parse_point("1,2,x").is_err() && parse_point("1,2,inf").is_err()
        );
    }

    #[test]
    fn sizes_and_units() {
        assert_eq!(parse_size("512"), Ok(512));
        assert_eq!(parse_size("1.5k"), Ok(1536));
        assert_eq!(parse_size("2GiB"), Ok(2 << 30));
        assert!(parse_size("-1").is_err() && parse_size("1T").is_err() && parse_size("x").is_err());
        assert_eq!(parse_unit("mm"), Ok(0.001));
        assert_eq!(parse_unit("0.5"), Ok(0.5));
        assert!(parse_unit("0").is_err() && parse_unit("inf").is_err());
    }
}
