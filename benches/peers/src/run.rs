//! Times and differences of all ways on one scene.

use std::sync::Arc;
use std::time::Instant;

use enfilade::{Answer, Hit, Kernel, Place, Ray, Scene, Start, Want};
use glam::DVec3;
use serde::Serialize;

use crate::embree::{Built, Embree, One, Quality, Sixteen, Stream};
use crate::own::{Batch, Single, Uncut, Whole};
use crate::scenes::Measured;
use crate::way::{Met, Rays, Way, soup};
use crate::{Arguments, crates, median};

/// Of one way on one kind of rays of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    pub scene: String,
    /// `primary`: frames from the scene's views; `random`: from random points in rooms in random directions; `pairs`: whether
    /// random points of rooms see each other; `outside`: from eyes around the building to random points of its box; `facades`: on from what those meet; `onward`: on from what random
    /// rays in rooms meet; `lamps`: whether what those meet sees the point from which it was met, or a random one of a room; `points`: where random points lie.
    pub rays: &'static str,
    pub way: String,
    pub count: usize,
    pub ns_per_ray: f64,
    /// Answers that are not those of the first of enfilade's ways: more than a millimetre and a thousandth nearer or farther.
    pub differing: usize,
}

/// Random numbers: SplitMix64 (Steele, Lea and Flood, 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector, any as likely as any other.
    fn direction(&mut self) -> DVec3 {
        let z = 2.0 * self.next() - 1.0;
        let (sin, cos) = (std::f64::consts::TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    }

    /// A point in the air of a room, and its cell.
    fn point(&mut self, scene: &Scene, rooms: &[[[f64; 3]; 2]]) -> ([f64; 3], u32) {
        loop {
            let [lo, hi] = match rooms.len() {
                0 => scene.hull(),
                n => rooms[((self.next() * n as f64) as usize).min(n - 1)],
            };
            let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * self.next());
            if let Place::Air { cell, room, .. } = scene.locate(point)
                && (rooms.is_empty() || room.is_some())
            {
                return (point, cell);
            }
        }
    }
}

fn frame(scene: &Scene, camera: &enfilade::render::Camera, size: u32) -> Option<Rays> {
    let Place::Air { cell, .. } = scene.locate(camera.eye()) else { return None };
    let pinhole = camera.pinhole(size, size);
    let pixels = (0..size).flat_map(|y| (0..size).map(move |x| (x, y)));
    let rays: Vec<Ray> = pixels.map(|(x, y)| pinhole.ray(x, y)).collect();
    let cells = vec![cell; rays.len()];
    Some(Rays::new(scene, rays, cells))
}

fn random(scene: &Scene, count: usize, pairs: bool) -> Rays {
    let rooms: Vec<[[f64; 3]; 2]> = scene.rooms().filter(|r| r.is_closed()).map(|r| r.bounds()).collect();
    let mut random = Random(7 + u64::from(pairs));
    let mut rays = Vec::with_capacity(count);
    let mut cells = Vec::with_capacity(count);
    while rays.len() < count {
        let (from, cell) = random.point(scene, &rooms);
        if pairs {
            let (to, _) = random.point(scene, &rooms);
            let way = DVec3::from(to) - DVec3::from(from);
            rays.push(Ray::segment(from, way.normalize().to_array(), 0.0, way.length()));
        } else {
            rays.push(Ray::new(from, random.direction().to_array()));
        }
        cells.push(cell);
    }
    Rays::new(scene, rays, cells)
}

/// From eyes around a building and over it, as far from its middle as it is long, a few thousand rays each.
fn outside(scene: &Scene, count: usize) -> Rays {
    /// Rays of an eye.
    const EACH: usize = 1 << 12;
    let mut random = Random(11);
    let [lo, hi] = scene.hull().map(DVec3::from);
    let far = 0.5 * (hi - lo).length() + (hi - lo).max_element();
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let z = random.next();
        let (sin, cos) = (std::f64::consts::TAU * random.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        let eye = 0.5 * (lo + hi) + far * DVec3::new(r * cos, r * sin, z);
        rays.extend((0..EACH.min(count - rays.len())).map(|_| {
            let to = DVec3::from([0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * random.next()));
            Ray::new(eye.to_array(), (to - eye).normalize().to_array())
        }));
    }
    // Around all others.
    let cells = vec![0; rays.len()];
    Rays::new(scene, rays, cells)
}

/// On from what rays from outside meet, from a millimetre before it in random directions on that side: light, radio or sound that a facade sends out.
fn facades(scene: &Scene, count: usize) -> Rays {
    const BEFORE: f64 = 1e-3;
    let mut random = Random(13);
    let (mut rays, mut cells) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for ray in outside(scene, 2 * count).exact {
        let Answer::Hit(hit) = scene.trace(&ray) else { continue };
        let normal = DVec3::from(hit.normal);
        let from = (DVec3::from(hit.point) + normal * BEFORE).to_array();
        let cell = match scene.locate(from) {
            Place::Air { cell, .. } => cell,
            Place::Outside => 0,
            Place::InSolid(_) => continue,
        };
        let way = random.direction();
        let way = if way.dot(normal) < 0.0 { -way } else { way };
        rays.push(Ray::new(from, way.to_array()));
        cells.push(cell);
        if rays.len() == count {
            break;
        }
    }
    Rays::new(scene, rays, cells)
}

/// On from hits: what random rays meet in rooms.
fn onward(scene: &Scene, count: usize, to_lamps: bool) -> Rays {
    /// So many points are tried to find one before a hit.
    const FAR: usize = 64;
    let rooms: Vec<[[f64; 3]; 2]> = scene.rooms().filter(|r| r.is_closed()).map(|r| r.bounds()).collect();
    let mut numbers = Random(15 + u64::from(to_lamps));
    let (mut rays, mut hits) = (Vec::with_capacity(count), Vec::<Hit>::with_capacity(count));
    while rays.len() < count {
        let (from, cell) = numbers.point(scene, &rooms);
        let ray = Ray::new(from, numbers.direction().to_array());
        let hit = scene.trace_from(Start::Cell(cell), &ray, Want::default());
        if !hit.t.is_finite() {
            continue;
        }
        let (at, normal) = (DVec3::from(hit.point), DVec3::from(hit.normal));
        if to_lamps {
            // Half of them to where it was met from, and so seen; the others to points of any room before it.
            let mut way = DVec3::from(from) - at;
            if numbers.next() < 0.5 {
                let mut far = (0..FAR).map(|_| DVec3::from(numbers.point(scene, &rooms).0) - at);
                let Some(found) = far.find(|way| way.dot(normal) > 0.0) else { continue };
                way = found;
            }
            rays.push(Ray::segment(hit.point, way.normalize().to_array(), 0.0, way.length()));
        } else {
            // As a matt surface scatters.
            let way = normal + numbers.direction();
            if way.length() < 1e-3 {
                continue;
            }
            rays.push(Ray::new(hit.point, way.normalize().to_array()));
        }
        hits.push(hit);
    }
    Rays::onward(scene, rays, hits)
}

fn ways(measured: &Measured, embree: Option<&Arc<Embree>>, arguments: &Arguments) -> Vec<Box<dyn Way>> {
    let scene = &measured.scene;
    let mut ways: Vec<Box<dyn Way>> = Vec::new();
    let others = Kernel::available().into_iter().filter(|&kernel| kernel != Kernel::best());
    for kernel in std::iter::once(Kernel::best()).chain(others) {
        ways.push(Box::new(Single { scene: Arc::clone(scene), kernel }));
    }
    let pool = || rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be started");
    ways.push(Box::new(Batch { scene: Arc::clone(scene), pool: pool() }));
    ways.push(Box::new(Whole { scene: Arc::clone(scene) }));
    if let Some(uncut) = &measured.uncut {
        for pool in [None, Some(pool())] {
            ways.push(Box::new(Uncut { scene: Arc::clone(uncut), pool }));
        }
    }
    let soup = soup(scene);
    if let Some(embree) = embree {
        for quality in [Quality::High, Quality::Medium] {
            ways.push(Box::new(One(Arc::new(Built::new(embree, &soup, quality, false)))));
        }
        let built = Arc::new(Built::new(embree, &soup, Quality::High, false));
        ways.push(Box::new(One(Arc::new(Built::new(embree, &soup, Quality::High, true)))));
        for coherent in [true, false] {
            ways.push(Box::new(Sixteen { built: Arc::clone(&built), coherent }));
        }
        if let Some(stream) = Stream::new(&built) {
            ways.push(Box::new(stream));
        }
    }
    ways.extend(crates::obvhs(&soup).into_iter().map(|way| Box::new(way) as Box<dyn Way>));
    ways.push(Box::new(crates::Bvh::new(&soup)));
    // The first is what the others' answers are compared with.
    let mut index = 0;
    ways.retain(|way| {
        index += 1;
        index == 1 || arguments.ways.is_empty() || arguments.ways.iter().any(|part| way.name().contains(part))
    });
    ways
}

/// Measures all ways.
pub fn run(measured: &Measured, embree: Option<&Arc<Embree>>, arguments: &Arguments) -> Vec<Row> {
    let scene = &measured.scene;
    let ways = ways(measured, embree, arguments);
    let frames: Vec<Rays> =
        measured.views.iter().filter_map(|camera| frame(scene, camera, arguments.size)).collect();
    let scattered = [random(scene, arguments.random, false)];
    let pairs = random(scene, arguments.random, true);
    let is_asked =
        |kind: &str| arguments.kinds.is_empty() || arguments.kinds.iter().any(|asked| asked == kind);
    let mut rows = Vec::new();
    if is_asked("primary") {
        rows.extend(nearest(&measured.name, "primary", &ways, &frames, arguments.repeat));
    }
    if is_asked("random") {
        rows.extend(nearest(&measured.name, "random", &ways, &scattered, arguments.repeat));
    }
    if is_asked("pairs") {
        rows.extend(occluded(&measured.name, "pairs", &ways, &pairs, arguments.repeat));
    }
    if is_asked("onward") {
        let rays = [onward(scene, arguments.random, false)];
        rows.extend(nearest(&measured.name, "onward", &ways, &rays, arguments.repeat));
    }
    if is_asked("lamps") {
        let rays = onward(scene, arguments.random, true);
        rows.extend(occluded(&measured.name, "lamps", &ways, &rays, arguments.repeat));
    }
    for (kind, make) in [("outside", outside as fn(&Scene, usize) -> Rays), ("facades", facades)] {
        if is_asked(kind) {
            let rays = [make(scene, arguments.random)];
            rows.extend(nearest(&measured.name, kind, &ways, &rays, arguments.repeat));
        }
    }
    if is_asked("points") {
        rows.extend(located(measured, arguments));
    }
    rows
}

/// How long it takes to find where points lie, one by one and many: in rooms, and anywhere in the hull.
fn located(measured: &Measured, arguments: &Arguments) -> Vec<Row> {
    let scene = &measured.scene;
    let mut numbers = Random(9);
    let [lo, hi] = scene.hull();
    let mut anywhere = || {
        (0..arguments.random).map(|_| [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * numbers.next())).collect()
    };
    let of_rooms = random(scene, arguments.random, false).exact.iter().map(|ray| ray.origin).collect();
    let sets: [(&str, Vec<[f64; 3]>); 2] = [("rooms", of_rooms), ("the hull", anywhere())];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be started");
    let mut rows = Vec::new();
    for (what, points) in &sets {
        let mut places = vec![Place::Outside; points.len()];
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..arguments.repeat.max(1) {
            let start = Instant::now();
            for (point, place) in points.iter().zip(&mut places) {
                *place = scene.locate(*point);
            }
            times[0].push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            pool.install(|| scene.locate_many(points, &mut places));
            times[1].push(start.elapsed().as_secs_f64());
        }
        for (way, times) in ["locate", "locate_many"].iter().zip(&mut times) {
            rows.push(Row {
                scene: measured.name.clone(),
                rays: "points",
                way: format!("{way}, {what}"),
                count: points.len(),
                ns_per_ray: median(times) * 1e9 / points.len().max(1) as f64,
                differing: 0,
            });
        }
    }
    rows
}

/// The ways that can answer some rays.
fn able<'a>(ways: &'a [Box<dyn Way>], batches: &[Rays]) -> Vec<&'a dyn Way> {
    let go_on = batches.iter().any(|rays| !rays.hits.is_empty());
    ways.iter().map(|way| &**way).filter(|way| way.goes_on() || !go_on).collect()
}

fn nearest(
    scene: &str,
    kind: &'static str,
    ways: &[Box<dyn Way>],
    batches: &[Rays],
    repeat: usize,
) -> Vec<Row> {
    let ways = able(ways, batches);
    let mut seconds = vec![0.0; ways.len()];
    let mut differing = vec![0; ways.len()];
    let count = batches.iter().map(Rays::len).sum::<usize>();
    for batch in batches {
        let mut times = vec![Vec::new(); ways.len()];
        let mut met = vec![vec![Met::NOTHING; batch.len()]; ways.len()];
        let first = batch.first();
        for _ in 0..repeat.max(1) {
            for (i, way) in ways.iter().enumerate() {
                way.nearest(&first, &mut met[i][..first.len()]);
                let start = Instant::now();
                way.nearest(batch, &mut met[i]);
                times[i].push(start.elapsed().as_secs_f64());
            }
        }
        for i in 0..ways.len() {
            seconds[i] += median(&mut times[i]);
            let differ = |(a, b): &(&Met, &Met)| a.t != b.t && (a.t - b.t).abs() > 1e-3 + 1e-3 * a.t.min(b.t);
            differing[i] += met[0]
                .iter()
                .zip(&met[i])
                .filter(|pair| differ(pair) || pair.0.t.is_infinite() != pair.1.t.is_infinite())
                .count();
        }
    }
    let row = |i: usize| Row {
        scene: scene.to_owned(),
        rays: kind,
        way: ways[i].name(),
        count,
        ns_per_ray: seconds[i] * 1e9 / count as f64,
        differing: differing[i],
    };
    if count == 0 { Vec::new() } else { (0..ways.len()).map(row).collect() }
}

fn occluded(scene: &str, kind: &'static str, ways: &[Box<dyn Way>], pairs: &Rays, repeat: usize) -> Vec<Row> {
    let ways = able(ways, std::slice::from_ref(pairs));
    let mut answers = vec![vec![false; pairs.len()]; ways.len()];
    let mut times = vec![Vec::new(); ways.len()];
    let first = pairs.first();
    for _ in 0..repeat.max(1) {
        for (i, way) in ways.iter().enumerate() {
            way.occluded(&first, &mut answers[i][..first.len()]);
            let start = Instant::now();
            if way.occluded(pairs, &mut answers[i]) {
                times[i].push(start.elapsed().as_secs_f64());
            }
        }
    }
    let mut rows = Vec::new();
    for (i, way) in ways.iter().enumerate() {
        if times[i].is_empty() {
            continue;
        }
        rows.push(Row {
            scene: scene.to_owned(),
            rays: kind,
            way: way.name(),
            count: pairs.len(),
            ns_per_ray: median(&mut times[i]) * 1e9 / pairs.len() as f64,
            differing: answers[0].iter().zip(&answers[i]).filter(|(a, b)| a != b).count(),
        });
    }
    rows
}
