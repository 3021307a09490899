//! A lidar sweep: rings of rays around a point in the largest room, as x y z and the element's id, in metres.
//!
//! ```sh
//! cargo run --release --example lidar -- fixtures/house.glb > sweep.xyz
//! ```
//!
//! The argument is a model or a compiled scene (.enf).

use std::error::Error;
use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;

use enfilade::importers::{ImportOptions, import};
use enfilade::{CompileOptions, Hit, NONE, Place, Ray, Scene, Want, compile};

/// Rings from 30 degrees below the horizon to 15 above it, and rays in each.
const RINGS: u32 = 32;
const RAYS: u32 = 720;
const LOWEST: f64 = -30.0;
const HIGHEST: f64 = 15.0;
/// Height of the scanner above the floor, metres.
const HEIGHT: f64 = 1.2;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which model or scene?")?;
    let hits = sweep(Path::new(&path), &mut std::io::stdout().lock())?;
    eprintln!("{hits} points");
    Ok(())
}

/// Writes the sweep, and says how many points it has.
pub fn sweep(path: &Path, out: &mut impl Write) -> Result<usize, Box<dyn Error>> {
    let scene = if path.extension().is_some_and(|e| e == "enf") {
        Scene::open(path)?
    } else {
        compile(&import(path, &ImportOptions::default())?, &CompileOptions::default())?.scene()
    };
    let eye = stand(&scene).ok_or("the model has no room to stand in")?;
    let rays: Vec<Ray> = (0..RINGS)
        .flat_map(|ring| (0..RAYS).map(move |i| (ring, i)))
        .map(|(ring, i)| {
            let share = f64::from(ring) / f64::from(RINGS - 1);
            let elevation = (LOWEST + (HIGHEST - LOWEST) * share).to_radians();
            let azimuth = f64::from(i) / f64::from(RAYS) * TAU;
            let (up, out) = elevation.sin_cos();
            Ray::new(eye, [out * azimuth.cos(), out * azimuth.sin(), up])
        })
        .collect();
    let mut hits = vec![Hit::ESCAPED; rays.len()];
    scene.trace_many(&rays, &mut hits, Want::LEAST);
    let mut count = 0;
    for hit in hits.iter().filter(|hit| hit.element != NONE && hit.t.is_finite()) {
        let [x, y, z] = hit.point;
        writeln!(out, "{x:.4} {y:.4} {z:.4} {}", scene.element(hit.element).id())?;
        count += 1;
    }
    Ok(count)
}

/// A point in the air of the largest room, above its floor.
fn stand(scene: &Scene) -> Option<[f64; 3]> {
    let room =
        scene.rooms().max_by(|a, b| a.volume().unwrap_or(0.0).total_cmp(&b.volume().unwrap_or(0.0)))?;
    let [lo, hi] = room.bounds();
    let at = |share: f64, axis: usize| lo[axis] + (hi[axis] - lo[axis]) * share;
    let places = [0.5, 0.3, 0.7, 0.15, 0.85];
    places.iter().flat_map(|&x| places.iter().map(move |&y| (x, y))).find_map(|(x, y)| {
        let point = [at(x, 0), at(y, 1), lo[2] + HEIGHT];
        matches!(scene.locate(point), Place::Air { room: Some(_), .. }).then_some(point)
    })
}
