//! How fast: every way to answer single rays, on the same rays, in one run.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::tracers::Tracer;
use super::way::{Answered, Way};
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, Place, Ray};

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SpeedOptions {
    /// Width and height of the frames.
    pub size: (u32, u32),
    /// How often each frame is traced by each way; the median counts.
    pub repeat: u32,
    /// Random rays, beside the frames.
    pub random_rays: u32,
    /// Seed of the random rays.
    pub seed: u64,
    /// Names of the ways ([`names`](super::names)).
    pub kernels: Vec<String>,
}

impl Default for SpeedOptions {
    fn default() -> SpeedOptions {
        SpeedOptions { size: (512, 512), repeat: 5, random_rays: 1 << 17, seed: 1, kernels: super::names() }
    }
}

/// Times of one way on one kind of rays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpeedRow {
    /// `primary`: the rays of frames; `random`: from random points in rooms in random directions.
    pub rays: &'static str,
    /// The way.
    pub kernel: String,
    /// Rays of a frame.
    pub rays_per_frame: u64,
    /// Frames.
    pub frames: u64,
    /// Milliseconds for a frame: the mean over the frames of each one's median.
    pub frame_ms: f64,
    /// Nanoseconds for a ray.
    pub ns_per_ray: f64,
    /// Millions of rays in a second.
    pub mrays_per_s: f64,
    /// How many times as fast as the first way in the list.
    pub ratio: f64,
    /// Rays on which the distance differs by more than the tolerance from the first way's.
    pub differing: u64,
    /// Which share of the rays, or pixels, exact beams answered.
    pub by_beams: f64,
    /// Which share packets answered.
    pub by_packets: f64,
    /// Which share was answered ray by ray: also what beams and packets left to rays.
    pub by_rays: f64,
}

/// What [`speed`] measured.
#[derive(Clone, Debug, Serialize)]
pub struct SpeedReport {
    /// The program's version.
    pub version: &'static str,
    /// The processor's architecture, and the kernels that it has.
    pub machine: String,
    /// Threads.
    pub threads: usize,
    /// How often each frame was traced.
    pub repeat: u32,
    /// Triangles of the scene.
    pub triangles: u64,
    /// The times.
    pub rows: Vec<SpeedRow>,
}

/// Traces the frames of `views` and a batch of random rays by every way, `repeat` times, one way after the other for
/// each frame so that a noisy machine disturbs all alike.
///
/// With the feature `rayon` each frame is shared among the threads of the current pool.
pub fn speed(scene: &Arc<Scene>, views: &[Camera], options: &SpeedOptions) -> SpeedReport {
    let tracers: Vec<Tracer> =
        options.kernels.iter().filter_map(|name| Tracer::by_name(name, scene)).collect();
    let (width, height) = options.size;
    let frames: Vec<Frame<'_>> = views
        .iter()
        .filter(|camera| matches!(scene.locate(camera.eye()), Place::Air { .. } | Place::Outside))
        .map(|camera| {
            let pinhole = camera.pinhole(width, height);
            let rays = (0..height)
                .flat_map(|y| (0..width).map(move |x| (x, y)))
                .map(|(x, y)| pinhole.ray(x, y))
                .collect();
            Frame { camera: Some((camera, options.size)), rays }
        })
        .collect();
    let random = Frame { camera: None, rays: random_rays(scene, options.random_rays, options.seed) };
    let mut rows = measure("primary", scene, &tracers, &frames, options.repeat);
    // Whole pictures need a camera.
    let singles: Vec<Tracer> = tracers.into_iter().filter(|tracer| !tracer.paints()).collect();
    rows.extend(measure("random", scene, &singles, &[random], options.repeat));
    SpeedReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        threads: threads(),
        repeat: options.repeat,
        triangles: u64::from(scene.detail_triangle_count()),
        rows,
    }
}

/// Rays that are timed together: those of a camera's picture, so many pixels wide and high, or any.
struct Frame<'a> {
    camera: Option<(&'a Camera, (u32, u32))>,
    rays: Vec<Ray>,
}

fn measure(
    what: &'static str,
    scene: &Scene,
    tracers: &[Tracer],
    frames: &[Frame<'_>],
    repeat: u32,
) -> Vec<SpeedRow> {
    let mut seconds = vec![0.0; tracers.len()];
    let mut differing = vec![0u64; tracers.len()];
    let mut answered = vec![Answered::default(); tracers.len()];
    let rays: u64 = frames.iter().map(|f| f.rays.len() as u64).sum();
    for frame in frames {
        let mut hits: Vec<Vec<Hit>> = tracers.iter().map(|_| vec![Hit::ESCAPED; frame.rays.len()]).collect();
        let mut times = vec![Vec::new(); tracers.len()];
        for _ in 0..repeat.max(1) {
            for (i, tracer) in tracers.iter().enumerate() {
                let start = Instant::now();
                picture(tracer, frame.camera, &frame.rays, &mut hits[i]);
                times[i].push(start.elapsed().as_secs_f64());
            }
        }
        for (i, tracer) in tracers.iter().enumerate() {
            let all = Answered { rays: frame.rays.len() as u64, ..Answered::default() };
            answered[i] += match frame.camera.and_then(|(camera, size)| tracer.picture(camera, size)) {
                Some(answered) => {
                    if let Some((camera, (width, _))) = frame.camera {
                        tracer.shown(camera, width, &mut hits[i]);
                    }
                    answered
                }
                None => all,
            };
        }
        for i in 0..tracers.len() {
            seconds[i] += median(&mut times[i]);
            let differ = |(a, b): &(&Hit, &Hit)| !agree(a.t, b.t, scene.tolerance());
            differing[i] += hits[i].iter().zip(&hits[0]).filter(differ).count() as u64;
        }
    }
    if rays == 0 {
        return Vec::new();
    }
    let row = |(i, tracer): (usize, &Tracer)| SpeedRow {
        rays: what,
        kernel: tracer.name().to_owned(),
        rays_per_frame: rays / frames.len() as u64,
        frames: frames.len() as u64,
        frame_ms: seconds[i] * 1e3 / frames.len() as f64,
        ns_per_ray: seconds[i] * 1e9 / rays as f64,
        mrays_per_s: rays as f64 / seconds[i] / 1e6,
        ratio: seconds[0] / seconds[i],
        differing: differing[i],
        by_beams: answered[i].beams as f64 / rays as f64,
        by_packets: answered[i].packets as f64 / rays as f64,
        by_rays: answered[i].rays as f64 / rays as f64,
    };
    tracers.iter().enumerate().map(row).collect()
}

/// Whether two distances are the same answer: NaN is that of a ray that starts in a solid.
fn agree(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || (a - b).abs() <= tolerance || (a.is_nan() && b.is_nan())
}

/// Threads on which ways are timed, apart from those that do the rest.
pub(super) struct Timed {
    #[cfg(feature = "rayon")]
    pool: rayon::ThreadPool,
}

impl Timed {
    pub(super) fn new(threads: usize) -> Result<Timed, super::ErrorFailure> {
        #[cfg(feature = "rayon")]
        {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let failed = |e: rayon::ThreadPoolBuildError| super::ErrorFailure::Threads(e.to_string());
            Ok(Timed { pool: pool.map_err(failed)? })
        }
        #[cfg(not(feature = "rayon"))]
        {
            let _ = threads;
            Ok(Timed {})
        }
    }

    pub(super) fn threads(&self) -> usize {
        self.install(threads)
    }

    /// How long a way takes for the picture of a camera, so many pixels wide and high, whose rays are these; seconds.
    pub(super) fn seconds(
        &self,
        way: &dyn Way,
        camera: (&Camera, (u32, u32)),
        rays: &[Ray],
        hits: &mut [Hit],
    ) -> f64 {
        self.install(|| {
            let start = Instant::now();
            picture(way, Some(camera), rays, hits);
            start.elapsed().as_secs_f64()
        })
    }

    pub(super) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        #[cfg(feature = "rayon")]
        return self.pool.install(work);
        #[cfg(not(feature = "rayon"))]
        work()
    }
}

/// The picture of a camera by one way, if that makes pictures; else its rays, or any rays.
fn picture(way: &dyn Way, camera: Option<(&Camera, (u32, u32))>, rays: &[Ray], hits: &mut [Hit]) {
    if camera.and_then(|(camera, size)| way.picture(camera, size)).is_none() {
        trace(way, rays, hits);
    }
}

/// One frame by one way, on all threads of the current pool.
pub(super) fn trace(tracer: &dyn Way, rays: &[Ray], hits: &mut [Hit]) {
    #[cfg(feature = "rayon")]
    if rayon::current_num_threads() > 1 && !tracer.is_batch() {
        use rayon::prelude::*;
        const CHUNK: usize = 4096;
        rays.par_chunks(CHUNK)
            .zip(hits.par_chunks_mut(CHUNK))
            .for_each(|(rays, hits)| tracer.trace(rays, hits));
        return;
    }
    tracer.trace(rays, hits);
}

pub(super) fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    let middle = times.len() / 2;
    if times.len() % 2 == 1 { times[middle] } else { (times[middle - 1] + times[middle]) / 2.0 }
}

pub(super) fn machine() -> String {
    let kernels: Vec<&str> = crate::Kernel::available().into_iter().map(crate::Kernel::name).collect();
    format!("{} with {}", std::env::consts::ARCH, kernels.join(", "))
}

pub(super) fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    1
}

/// Rays from random points in rooms (in the air of the hull if there are none) in random directions.
pub(super) fn random_rays(scene: &Scene, count: u32, seed: u64) -> Vec<Ray> {
    /// Points tried for each ray before the search for air is given up.
    const TRIES: u32 = 1000;
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut random = move || {
        // xorshift64* (Vigna, 2016).
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    };
    let rooms: Vec<[[f64; 3]; 2]> = scene.rooms().filter(|r| r.is_closed()).map(|r| r.bounds()).collect();
    let mut rays = Vec::with_capacity(count as usize);
    let mut tries = 0;
    while rays.len() < count as usize && tries < count.saturating_mul(TRIES) {
        tries += 1;
        let [lo, hi] = match rooms.len() {
            0 => scene.hull(),
            n => rooms[((random() * n as f64) as usize).min(n - 1)],
        };
        let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * random());
        let Place::Air { room, .. } = scene.locate(point) else { continue };
        if !rooms.is_empty() && room.is_none() {
            continue;
        }
        let z = 2.0 * random() - 1.0;
        let angle = std::f64::consts::TAU * random();
        let r = (1.0 - z * z).sqrt();
        rays.push(Ray::new(point, [r * angle.cos(), r * angle.sin(), z]));
    }
    rays
}
