//! How right, beside how fast: every way to answer rays against exact arithmetic on the model's triangles, on the pixels of frames. Whether an answer that
//! is not exact is right by a ray beside is decided in f64, with a witness.

mod chart;
mod image;
mod score;
mod table;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use enfilade_importers::{Model, Untagged};
use glam::DVec3;
use serde::Serialize;

use super::speed::{Timed, machine, median};
use super::tracers::{Tracer, error_names, is_exact};
use super::way::Way;
use crate::compile::CompileError;
use crate::oracle::{First, Truth, TruthOptions};
use crate::render::Camera;
use crate::roles::roles;
use crate::scene::Scene;
use crate::trace::{Hit, Place, Ray};

use image::Shades;
pub(super) use image::shade as shade_of;
pub use image::{Compare, ImageError};
pub(super) use score::Sum;
pub use score::{Errors, Spread};
use score::{Judge, Score};

/// So many rays are answered exactly before the ways' answers to them are judged.
const BLOCK: usize = 1 << 12;

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ErrorOptions {
    /// Width and height of the frames.
    pub size: (u32, u32),
    /// How often each frame is traced by each way; the median counts.
    pub repeat: u32,
    /// Names of the ways ([`error_names`]).
    pub kernels: Vec<String>,
    /// As the model was compiled.
    pub untagged: Untagged,
    /// On so many threads ways are timed; what they told is judged on all of the current pool.
    pub threads: usize,
    /// FLIP (Andersson and others, A Difference Evaluator for Alternating Images, HPG 2020), if the caller brings it: what there is of it is C++, which
    /// this crate does without.
    pub flip: Option<Compare>,
}

impl Default for ErrorOptions {
    fn default() -> ErrorOptions {
        let (size, untagged) = ((256, 256), Untagged::default());
        ErrorOptions { size, repeat: 3, kernels: error_names(), untagged, threads: 1, flip: None }
    }
}

/// One way: its time and its errors.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ErrorRow {
    /// The way.
    pub kernel: String,
    /// Milliseconds for a frame.
    pub frame_ms: f64,
    /// Nanoseconds for a ray.
    pub ns_per_ray: f64,
    /// Its errors.
    #[serde(flatten)]
    pub errors: Errors,
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
    /// Of those, pixels that have several exact answers.
    pub tied: u64,
    /// The ways.
    pub rows: Vec<ErrorRow>,
}

impl ErrorReport {
    /// Whether no answer is wrong that is to be right: of this library's ways, but for rays rounded to f32, and of the truth.
    pub fn passed(&self) -> bool {
        self.rows.iter().filter(|row| is_exact(&row.kernel)).all(|row| row.errors.wrong == 0)
    }
}

/// Nothing was measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ErrorFailure {
    /// The scene is none of the model.
    #[error("the scene was not compiled from this model: their elements differ")]
    OtherModel,
    /// There is nothing to look at.
    #[error("no camera stands in the air, or pictures have no pixels")]
    NoPixels,
    /// The threads could not be started.
    #[error("threads could not be started: {0}")]
    Threads(String),
    /// The model could not be compiled another way.
    #[error(transparent)]
    Compile(#[from] CompileError),
}

/// Traces the frames of `views` by every way that the options name, and by `others`, and judges every pixel by the triangles of `model`.
///
/// # Errors
/// [`ErrorFailure`].
pub fn error(
    scene: &Arc<Scene>,
    model: &Model,
    views: &[Camera],
    others: &[&dyn Way],
    options: &ErrorOptions,
) -> Result<ErrorReport, ErrorFailure> {
    // What was found in the building comes after what the model says.
    let own = scene.elements().filter(|element| !element.is_derived());
    if !own.map(|element| element.id()).eq(model.elements.iter().map(|element| element.id.as_str())) {
        return Err(ErrorFailure::OtherModel);
    }
    let roles = roles(model, options.untagged);
    let truth = Arc::new(Truth::new(
        model,
        |e| roles[e.0 as usize],
        &TruthOptions::default().with_tolerance(scene.tolerance()),
    ));
    let mut tracers = Vec::new();
    for name in &options.kernels {
        tracers.extend(Tracer::of_model(name, scene, model, options.untagged, &truth)?);
    }
    let ways: Vec<&dyn Way> =
        tracers.iter().map(|tracer| tracer as &dyn Way).chain(others.iter().copied()).collect();
    let (width, height) = options.size;
    let views: Vec<&Camera> =
        views.iter().filter(|camera| !matches!(scene.locate(camera.eye()), Place::InSolid(_))).collect();
    if views.is_empty() || width == 0 || height == 0 {
        return Err(ErrorFailure::NoPixels);
    }
    let timed = Timed::new(options.threads)?;
    let mut seconds = vec![0.0; ways.len()];
    let mut scores = vec![Score::default(); ways.len()];
    let judge = Judge { truth: &truth, model };
    let (mut pixels, mut tied) = (0u64, 0u64);
    for camera in &views {
        let pinhole = camera.pinhole(width, height);
        let rays: Vec<Ray> = (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| pinhole.ray(x, y))
            .collect();
        pixels += rays.len() as u64;
        let mut hits: Vec<Vec<Hit>> = ways.iter().map(|_| vec![Hit::ESCAPED; rays.len()]).collect();
        let mut times = vec![Vec::new(); ways.len()];
        for _ in 0..options.repeat.max(1) {
            for (i, way) in ways.iter().enumerate() {
                times[i].push(timed.seconds(*way, (camera, options.size), &rays, &mut hits[i]));
            }
        }
        for (way, hits) in ways.iter().zip(&mut hits) {
            way.shown(camera, width, hits);
        }
        let mut shades = vec![Shades::default(); ways.len()];
        for (first, block) in rays.chunks(BLOCK).enumerate() {
            let exact = crate::parallel::map(block.len(), |ray| truth.first(&block[ray]));
            tied += exact.iter().flatten().filter(|first| first.is_tie()).count() as u64;
            let parts = crate::parallel::map(ways.len(), |i| {
                let hits = &hits[i][first * BLOCK..first * BLOCK + block.len()];
                let (mut sum, mut part) = (scores[i], options.flip.map(|_| Shades::default()));
                score(&judge, ways[i], block, &exact, hits, &mut sum, part.as_mut());
                (sum, part)
            });
            for (i, (sum, part)) in parts.into_iter().enumerate() {
                scores[i] = sum;
                part.into_iter().for_each(|part| shades[i].append(part));
            }
        }
        if let Some(flip) = options.flip {
            let compared = crate::parallel::map(ways.len(), |i| shades[i].compared(options.size, flip));
            scores.iter_mut().zip(compared).for_each(|(score, compared)| score.image.add_compared(compared));
        }
        for (seconds, times) in seconds.iter_mut().zip(&mut times) {
            *seconds += median(times);
        }
    }
    let row = |(i, way): (usize, &&dyn Way)| ErrorRow {
        kernel: way.name().to_owned(),
        frame_ms: seconds[i] * 1e3 / views.len().max(1) as f64,
        ns_per_ray: seconds[i] * 1e9 / pixels.max(1) as f64,
        errors: scores[i].errors(),
    };
    Ok(ErrorReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        threads: timed.threads(),
        tolerance: scene.tolerance(),
        frames: views.len() as u64,
        pixels,
        tied,
        rows: ways.iter().enumerate().map(row).collect(),
    })
}

/// Judges a way's answers, and what it says of the rays that go on from them as from mirrors.
fn score(
    judge: &Judge<'_>,
    way: &dyn Way,
    rays: &[Ray],
    exact: &[Option<First>],
    hits: &[Hit],
    score: &mut Score,
    mut shades: Option<&mut Shades>,
) {
    let (mut from, mut onward, mut normals) = (Vec::new(), Vec::new(), Vec::new());
    for ((ray, hit), exact) in rays.iter().zip(hits).zip(exact) {
        let normal = if hit.t.is_finite() { way.normal(hit) } else { None };
        let pixel = judge.add(score, ray, exact.as_ref(), hit, normal);
        shades.iter_mut().for_each(|shades| shades.add(pixel));
        if let Some(normal) = normal {
            let [origin, along, across] = [ray.origin, ray.direction, normal].map(DVec3::from);
            let (along, across) = (along.normalize(), across.normalize());
            let mirrored = along - across * (2.0 * along.dot(across));
            from.push(*hit);
            normals.push(normal);
            onward.push(Ray::new((origin + along * hit.t).to_array(), mirrored.to_array()));
        }
    }
    let mut found = vec![Hit::ESCAPED; onward.len()];
    way.trace_onward(&from, &onward, &mut found);
    for ((from, normal), found) in from.iter().zip(normals).zip(&found) {
        judge.add_onward(score, (from, normal), found, way.normal(found));
    }
}
