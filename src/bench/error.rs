//! How right, beside how fast: every way to answer single rays against the truth, on the pixels of frames.

use std::sync::Arc;
use std::time::Instant;

use enfilade_importers::{Model, Untagged};
use serde::Serialize;

use super::speed::{machine, median, threads, trace};
use super::tracers::Tracer;
use crate::oracle::{Truth, TruthOptions, Verdict};
use crate::render::Camera;
use crate::roles::roles;
use crate::scene::Scene;
use crate::trace::{Hit, Place, Ray};

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ErrorOptions {
    /// Width and height of the frames.
    pub size: (u32, u32),
    /// How often each frame is traced by each way; the median counts.
    pub repeat: u32,
    /// Names of the ways ([`names`](super::names)).
    pub kernels: Vec<String>,
    /// As the model was compiled.
    pub untagged: Untagged,
}

impl Default for ErrorOptions {
    fn default() -> ErrorOptions {
        ErrorOptions { size: (256, 256), repeat: 3, kernels: super::names(), untagged: Untagged::default() }
    }
}

/// One way: its time and its errors. Lengths in metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorRow {
    /// The way.
    pub kernel: String,
    /// Milliseconds for a frame.
    pub frame_ms: f64,
    /// Nanoseconds for a ray.
    pub ns_per_ray: f64,
    /// Pixels whose answer is no exact answer to any parallel ray within the tolerance.
    pub wrong: u64,
    /// The same in millionths of all pixels.
    pub wrong_ppm: f64,
    /// Pixels that are right only by a parallel ray past an edge.
    pub edges: u64,
    /// Largest error of the distance, where the surface is the true one or flush with it.
    pub largest_forward: f64,
    /// Root of the mean square of the same.
    pub rms_forward: f64,
    /// How far away the farthest parallel ray is that had to be taken.
    pub largest_backward: f64,
}

/// What [`error`] measured.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorReport {
    /// The program's version.
    pub version: &'static str,
    /// The processor's architecture and instruction sets.
    pub machine: String,
    /// Threads.
    pub threads: usize,
    /// The tolerance, metres.
    pub tolerance: f64,
    /// Frames.
    pub frames: u64,
    /// Pixels of all frames.
    pub pixels: u64,
    /// The ways.
    pub rows: Vec<ErrorRow>,
}

/// The scene is none of the model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the scene was not compiled from this model: it has {scene} elements, the model {model}")]
pub struct OtherModel {
    /// Elements of the scene.
    pub scene: u32,
    /// Elements of the model.
    pub model: usize,
}

#[derive(Clone, Copy, Default)]
struct Sum {
    wrong: u64,
    edges: u64,
    compared: u64,
    largest: f64,
    squares: f64,
    backward: f64,
}

/// Traces the frames of `views` by every way, and judges every pixel by the triangles of `model`.
///
/// # Errors
/// [`OtherModel`].
pub fn error(
    scene: &Arc<Scene>,
    model: &Model,
    views: &[Camera],
    options: &ErrorOptions,
) -> Result<ErrorReport, OtherModel> {
    if scene.element_count() as usize != model.elements.len() {
        return Err(OtherModel { scene: scene.element_count(), model: model.elements.len() });
    }
    let roles = roles(model, options.untagged);
    let truth = Truth::new(
        model,
        |e| roles[e.0 as usize],
        &TruthOptions::default().with_tolerance(scene.tolerance()),
    );
    let tracers: Vec<Tracer> =
        options.kernels.iter().filter_map(|name| Tracer::by_name(name, scene)).collect();
    let (width, height) = options.size;
    let views: Vec<&Camera> =
        views.iter().filter(|camera| !matches!(scene.locate(camera.eye()), Place::InSolid(_))).collect();
    let mut seconds = vec![0.0; tracers.len()];
    let mut sums = vec![Sum::default(); tracers.len()];
    let mut pixels = 0u64;
    for camera in &views {
        let pinhole = camera.pinhole(width, height);
        let rays: Vec<Ray> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| pinhole.ray(x, y))
            .collect();
        pixels += rays.len() as u64;
        let mut hits: Vec<Vec<Hit>> = tracers.iter().map(|_| vec![Hit::ESCAPED; rays.len()]).collect();
        let mut times = vec![Vec::new(); tracers.len()];
        for _ in 0..options.repeat.max(1) {
            for (i, tracer) in tracers.iter().enumerate() {
                let start = Instant::now();
                trace(tracer, &rays, &mut hits[i]);
                times[i].push(start.elapsed().as_secs_f64());
            }
        }
        for i in 0..tracers.len() {
            seconds[i] += median(&mut times[i]);
            judge(&truth, &rays, &hits[i], &mut sums[i]);
        }
    }
    let row = |(i, tracer): (usize, &Tracer)| ErrorRow {
        kernel: tracer.name().to_owned(),
        frame_ms: seconds[i] * 1e3 / views.len().max(1) as f64,
        ns_per_ray: seconds[i] * 1e9 / pixels.max(1) as f64,
        wrong: sums[i].wrong,
        wrong_ppm: sums[i].wrong as f64 * 1e6 / pixels.max(1) as f64,
        edges: sums[i].edges,
        largest_forward: sums[i].largest,
        rms_forward: (sums[i].squares / sums[i].compared.max(1) as f64).sqrt(),
        largest_backward: sums[i].backward,
    };
    Ok(ErrorReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        threads: threads(),
        tolerance: scene.tolerance(),
        frames: views.len() as u64,
        pixels,
        rows: tracers.iter().enumerate().map(row).collect(),
    })
}

fn judge(truth: &Truth, rays: &[Ray], hits: &[Hit], sum: &mut Sum) {
    for (ray, hit) in rays.iter().zip(hits) {
        let judgement = truth.judge(ray, &hit.answer());
        sum.wrong += u64::from(!judgement.verdict.is_right());
        sum.edges += u64::from(matches!(judgement.verdict, Verdict::Edge { .. }));
        sum.backward = sum.backward.max(judgement.verdict.backward());
        if let (Verdict::Exact | Verdict::Close { .. } | Verdict::Flush { .. }, Some(forward)) =
            (judgement.verdict, judgement.forward)
        {
            sum.compared += 1;
            sum.largest = sum.largest.max(forward);
            sum.squares += forward * forward;
        }
    }
}
