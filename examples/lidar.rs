//! A lidar sweep: opens a compiled scene (.enf), or compiles a model, and writes what a scanner would see: the points
//! that rings of beams meet, with the index of the element that each lies on. As PLY if the file's name says so, else
//! as text, `x y z element` a line. Everything is in the model's own frame and unit.
//!
//!     cargo run --release --example lidar -- fixtures/house.glb sweep.ply
//!     cargo run --release --example lidar -- house.enf --rings 32 --azimuths 1800 --from 1,1.6,-3 > sweep.txt
//!
//! The scanner stands at `--from`, or in the middle of the largest room, and looks all around, and from 45 degrees
//! below to 45 degrees above the horizon.

use std::error::Error;
use std::f64::consts::{FRAC_PI_4, TAU};
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use enfilade::importers::{ImportOptions, import};
use enfilade::{Answer, CompileOptions, Hit, Place, Ray, Scene, Want, compile};

const USAGE: &str =
    "usage: lidar SCENE.enf|MODEL [SWEEP.ply|SWEEP.txt] [--rings N] [--azimuths M] [--from X,Y,Z]";

struct Arguments {
    scene: PathBuf,
    sweep: Option<PathBuf>,
    rings: u32,
    azimuths: u32,
    from: Option<[f64; 3]>,
}

fn parse(words: impl IntoIterator<Item = String>) -> Result<Arguments, Box<dyn Error>> {
    let (mut files, mut rings, mut azimuths, mut from) = (Vec::new(), 16, 900, None);
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--rings" => rings = words.next().ok_or(USAGE)?.parse()?,
            "--azimuths" => azimuths = words.next().ok_or(USAGE)?.parse()?,
            "--from" => {
                let numbers: Result<Vec<f64>, _> =
                    words.next().ok_or(USAGE)?.split(',').map(str::parse).collect();
                from = Some(<[f64; 3]>::try_from(numbers?).map_err(|_| USAGE)?);
            }
            option if option.starts_with("--") => return Err(USAGE.into()),
            _ => files.push(PathBuf::from(word)),
        }
    }
    let mut files = files.into_iter();
    let (Some(scene), sweep, None) = (files.next(), files.next(), files.next()) else {
        return Err(USAGE.into());
    };
    Ok(Arguments { scene, sweep, rings, azimuths, from })
}

/// A scene file is opened as it is; a model is compiled first.
fn load(path: &Path) -> Result<Scene, Box<dyn Error>> {
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("enf")) {
        return Ok(Scene::open(path)?);
    }
    let model = import(path, &ImportOptions::default())?;
    Ok(compile(&model, &CompileOptions::default())?.scene())
}

/// The point nearest to the middle of the largest room that lies in that room's air: the middle of a room with wings,
/// or with a table in it, may lie elsewhere.
fn stand(scene: &Scene) -> Option<[f64; 3]> {
    /// Points tried along each axis of the room's box.
    const TRIED: u32 = 16;
    let volume = |room: u32| scene.room(room).volume();
    let rooms = (0..scene.rooms().len() as u32).filter(|&room| volume(room).is_some());
    let largest =
        rooms.max_by(|&a, &b| volume(a).partial_cmp(&volume(b)).unwrap_or(std::cmp::Ordering::Equal))?;
    let [lo, hi] = scene.room(largest).bounds();
    let mut best: Option<(f64, [f64; 3])> = None;
    for index in 0..TRIED.pow(3) {
        let step = [index % TRIED, index / TRIED % TRIED, index / (TRIED * TRIED)];
        // From -0.5 to 0.5, across the box.
        let off = step.map(|s| (f64::from(s) + 0.5) / f64::from(TRIED) - 0.5);
        let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * (0.5 + off[i]));
        let distance = (0..3).map(|i| (off[i] * (hi[i] - lo[i])).powi(2)).sum();
        if matches!(scene.locate(point), Place::Air { room: Some(room), .. } if room == largest)
            && best.is_none_or(|(nearest, _)| distance < nearest)
        {
            best = Some((distance, point));
        }
    }
    best.map(|(_, point)| point)
}

/// The beams: rings from the lowest to the highest, each once around.
fn beams(from: [f64; 3], rings: u32, azimuths: u32) -> Vec<Ray> {
    let mut rays = Vec::new();
    for ring in 0..rings {
        let elevation = FRAC_PI_4 * (2.0 * (f64::from(ring) + 0.5) / f64::from(rings) - 1.0);
        for step in 0..azimuths {
            let azimuth = TAU * f64::from(step) / f64::from(azimuths);
            let flat = elevation.cos();
            rays.push(Ray::new(from, [flat * azimuth.cos(), flat * azimuth.sin(), elevation.sin()]));
        }
    }
    rays
}

fn write_points(points: &[([f64; 3], u32)], is_ply: bool, out: &mut dyn Write) -> io::Result<()> {
    if is_ply {
        writeln!(out, "ply\nformat ascii 1.0\nelement vertex {}", points.len())?;
        writeln!(out, "property double x\nproperty double y\nproperty double z")?;
        writeln!(out, "property int element\nend_header")?;
    } else {
        writeln!(out, "# x y z element")?;
    }
    points.iter().try_for_each(|([x, y, z], element)| writeln!(out, "{x:.6} {y:.6} {z:.6} {element}"))
}

/// Does what the words of a command line say; the sweep goes to `out` if no file is named.
pub fn run(words: impl IntoIterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let arguments = parse(words)?;
    let scene = load(&arguments.scene)?;
    let frame = scene.frame();
    let from = match arguments.from {
        Some(point) => frame.point_to_internal(point),
        None => stand(&scene).ok_or("no room with a closed mesh to stand in: say --from X,Y,Z")?,
    };

    // All beams start in the same air: it is looked up once, not for every beam.
    let cell = match scene.locate(from) {
        Place::Air { cell, .. } => cell,
        Place::InSolid(element) => {
            return Err(format!("the scanner is inside {}", scene.element(element).id()).into());
        }
        Place::Outside => return Err("the scanner is outside of the scene's hull".into()),
    };
    let rays = beams(from, arguments.rings, arguments.azimuths);
    let mut hits = vec![Hit::ESCAPED; rays.len()];
    scene.trace_many_from(cell, &rays, &mut hits, Want::LEAST);

    // A beam that leaves the building gives no point. Glass does: a scanner's beam may think otherwise of it.
    let points: Vec<([f64; 3], u32)> = hits
        .iter()
        .filter_map(|hit| match hit.answer() {
            Answer::Hit(hit) => Some((frame.point_to_source(hit.point), hit.element)),
            _ => None,
        })
        .collect();
    let Some(path) = &arguments.sweep else {
        return Ok(write_points(&points, false, out)?);
    };
    let is_ply = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"));
    let mut file = BufWriter::new(File::create(path)?);
    write_points(&points, is_ply, &mut file)?;
    file.flush()?;
    writeln!(out, "{}: {} points of {} beams", path.display(), points.len(), rays.len())?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut BufWriter::new(io::stdout().lock()))
}
