//! What growing damage does to a generated building: to what its openings join, its cells, compile time, the time of rays, and what they meet.
//!
//! The truth of the building as it was drawn is known ([`Building::truth`]). Each step exports it with one [`Damage`] of one size, compiles
//! that, and holds it against the truth and against the building without damage. Answers are held against the damaged model's own triangles, too
//! ([`verify`]): that a building is drawn badly is no excuse to answer wrongly.

mod chart;
mod table;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::time::Instant;

use enfilade_importers::{Cancelled, Frame, Untagged, Watch};
use serde::Serialize;

use super::error::ErrorFailure;
use super::speed::{Timed, machine, median, random_rays, threads};
use crate::compile::{CompileError, CompileOptions, compile};
use crate::generate::{Building, Style, Truth};
use crate::graph::{Graph, Place, Side};
use crate::roles::roles;
use crate::scene::Scene;
use crate::trace::{Hit, Ray, Want};
use crate::verify::{VerifyOptions, verify};

/// A kind of damage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Damage {
    /// Rooms end before their walls, floors and ceilings.
    RoomGaps,
    /// Rooms reach into them.
    RoomOverlaps,
    /// Walls, slabs and roofs end before each other.
    SolidGaps,
    /// They reach into each other.
    SolidOverlaps,
    /// Every corner of every element is off.
    Jitter,
    /// Every corner of every triangle is: nothing is closed.
    Noise,
}

impl Damage {
    /// All kinds.
    pub const ALL: [Damage; 6] = [
        Damage::RoomGaps,
        Damage::RoomOverlaps,
        Damage::SolidGaps,
        Damage::SolidOverlaps,
        Damage::Jitter,
        Damage::Noise,
    ];

    /// What the command line calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Damage::RoomGaps => "room-gaps",
            Damage::RoomOverlaps => "room-overlaps",
            Damage::SolidGaps => "solid-gaps",
            Damage::SolidOverlaps => "solid-overlaps",
            Damage::Jitter => "jitter",
            Damage::Noise => "noise",
        }
    }

    /// The style that does it, `size` metres far.
    pub fn style(self, size: f64, seed: u64) -> Style {
        let mut style = Style { seed, ..Style::exact() };
        match self {
            Damage::RoomGaps => style.room_gap = size,
            Damage::RoomOverlaps => style.room_gap = -size,
            Damage::SolidGaps => style.solid_gap = size,
            Damage::SolidOverlaps => style.solid_gap = -size,
            Damage::Jitter => style.jitter = size,
            Damage::Noise => style.noise = size,
        }
        style
    }
}

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RobustOptions {
    /// Which kinds of damage.
    pub damages: Vec<Damage>,
    /// How far things are off, metres, ascending.
    pub sizes: Vec<f64>,
    /// Random rays from rooms of the building as it was drawn, which are timed and compared.
    pub rays: u32,
    /// Rays by which answers are verified.
    pub verified: u64,
    /// How often rays are timed, and short compilations up to three times; the median counts.
    pub repeat: u32,
    /// Where random numbers start: rays, and what is off by how much.
    pub seed: u64,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl Default for RobustOptions {
    fn default() -> RobustOptions {
        RobustOptions {
            damages: Damage::ALL.to_vec(),
            sizes: vec![1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2],
            rays: 1 << 15,
            verified: 50_000,
            repeat: 5,
            seed: 1,
            watch: Watch::default(),
        }
    }
}

/// What an export of the building came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RobustRow {
    /// The damage; `None` for the building as it was drawn.
    pub damage: Option<Damage>,
    /// How far things are off, metres.
    pub size: f64,
    /// Seconds to compile it, on all threads of the current pool: the median of up to three where that is short.
    pub compile_seconds: f64,
    /// Cells.
    pub cells: u64,
    /// Volume of air that is no room's, no opening's and not in the open, m3.
    pub void_volume: f64,
    /// Of the pairs of an opening and what it joins, the share that was found.
    pub joins_found: f64,
    /// Of the pairs that were told, the share that is true; `None` if none was told.
    pub joins_right: Option<f64>,
    /// Pairs of rooms, or of a room and the open, that touch without an opening, and do not in the building as it was drawn.
    pub leaky_pairs: u64,
    /// How far rooms' volumes are off, as a share of the true one: the mean, and the most.
    pub volume_error: [f64; 2],
    /// Nanoseconds a ray, one thread, in batches.
    pub ns_per_ray: f64,
    /// The same rays' time in the building as it was drawn, by which that is to be divided: taken in turns.
    pub drawn_ns_per_ray: f64,
    /// Rays that were compared with the building as it was drawn.
    pub rays: u64,
    /// Of these, rays that meet another element, farther off than the tolerance.
    pub other_element: u64,
    /// Rays that escape and did not.
    pub leaks: u64,
    /// Rays that start in a solid now.
    pub in_solid: u64,
    /// How far the others are off: the root of the mean square, metres.
    pub moved_rms: f64,
    /// Rays that were verified by the damaged model's own triangles.
    pub verified: u64,
    /// Of these, wrong by the definition in [`oracle::right`](crate::oracle::right).
    pub wrong: u64,
}

/// What [`robust`] measured.
#[derive(Clone, Debug, Serialize)]
pub struct RobustReport {
    /// The program's version.
    pub version: &'static str,
    /// The processor's architecture and instruction sets.
    pub machine: String,
    /// The building.
    pub building: String,
    /// Threads on which it was compiled. Rays are timed on one.
    pub threads: usize,
    /// The tolerance, metres.
    pub tolerance: f64,
    /// The building as it was drawn.
    pub drawn: RobustRow,
    /// By damage, sizes ascending.
    pub rows: Vec<RobustRow>,
}

/// Nothing was measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobustError {
    /// An export could not be read.
    #[error("{damage} of {size} m: {why}")]
    Model {
        /// The damage.
        damage: &'static str,
        /// Its size, metres.
        size: f64,
        /// What the reader says.
        why: String,
    },
    /// An export could not be compiled.
    #[error(transparent)]
    Compile(CompileError),
    /// The thread for the rays could not be started.
    #[error(transparent)]
    Thread(#[from] ErrorFailure),
    /// The watch's token was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<CompileError> for RobustError {
    fn from(error: CompileError) -> RobustError {
        match error {
            CompileError::Cancelled(cancelled) => RobustError::Cancelled(cancelled),
            other => RobustError::Compile(other),
        }
    }
}

/// Smaller damage is lost in the numbers of a file, and larger leaves no building, metres.
const SIZES: std::ops::RangeInclusive<f64> = 1e-12..=1e3;

/// Damages a building more and more, and measures what comes of it. Each damage and size counts once; sizes less than a picometre or more than a
/// kilometre are left out.
///
/// # Errors
/// [`RobustError`].
pub fn robust(building: &Building, options: &RobustOptions) -> Result<RobustReport, RobustError> {
    let truth = building.truth();
    let timed = Timed::new(1)?;
    let mut sizes: Vec<f64> = options.sizes.iter().copied().filter(|size| SIZES.contains(size)).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.dedup();
    let damages: Vec<Damage> =
        Damage::ALL.into_iter().filter(|damage| options.damages.contains(damage)).collect();
    // The first is slower: memory is new to the process.
    Step::new(building, None, 0.0, &truth, options)?;
    let drawn = Step::new(building, None, 0.0, &truth, options)?;
    let rays = random_rays(&drawn.scene, options.rays, options.seed);
    let reference = Reference { rays, step: &drawn, timed };
    let first = reference.measured(&drawn, options);
    let mut rows = Vec::new();
    let all = damages.iter().flat_map(|&damage| sizes.iter().map(move |&size| (damage, size)));
    let count = (damages.len() * sizes.len()).max(1) as f64;
    for (number, (damage, size)) in all.enumerate() {
        options.watch.check()?;
        options.watch.report(&format!("{} of {size} m", damage.name()), number as f64 / count);
        let step = Step::new(building, Some(damage), size, &truth, options)?;
        rows.push(reference.measured(&step, options));
    }
    Ok(RobustReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        building: building.name.clone(),
        threads: threads(),
        tolerance: drawn.scene.tolerance(),
        drawn: first,
        rows,
    })
}

/// Compilations that take less are timed as often as rays are, but three times at most; seconds.
const SHORT: f64 = 1.0;

/// A pair of places that touch, by the names of their rooms.
type Pair = [String; 2];

/// An export, compiled, and what the truth says of it.
struct Step {
    scene: Scene,
    touching: BTreeSet<Pair>,
    row: RobustRow,
}

impl Step {
    fn new(
        building: &Building,
        damage: Option<Damage>,
        size: f64,
        truth: &Truth,
        options: &RobustOptions,
    ) -> Result<Step, RobustError> {
        let style = damage.map_or(Style::exact(), |damage| damage.style(size, options.seed));
        let model = building.export(&style).to_model().map_err(|why| RobustError::Model {
            damage: damage.map_or("as drawn", Damage::name),
            size,
            why: why.to_string(),
        })?;
        let mut row = RobustRow { damage, size, ..RobustRow::default() };
        let compiling = CompileOptions { watch: options.watch.clone(), ..CompileOptions::default() };
        let timed = || -> Result<(f64, Scene), CompileError> {
            let start = Instant::now();
            let scene = compile(&model, &compiling)?.scene();
            Ok((start.elapsed().as_secs_f64(), scene))
        };
        let (first, scene) = timed()?;
        let mut times = vec![first];
        let again = if first < SHORT { options.repeat.clamp(1, 3) - 1 } else { 0 };
        for _ in 0..again {
            times.push(timed()?.0);
        }
        row.compile_seconds = median(&mut times);
        row.cells = scene.cells().len() as u64;
        let graph = scene.graph();
        row.void_volume = graph.voids.iter().map(|void| void.volume).sum::<f64>().max(0.0);
        (row.joins_found, row.joins_right) = joins(&scene, &graph, truth);
        row.volume_error = volume_error(&scene, &graph, truth);
        let roles = roles(&model, Untagged::default());
        let verifying = VerifyOptions::default()
            .with_rays(options.verified)
            .with_seed(options.seed)
            .with_tolerance(scene.tolerance())
            .with_watch(options.watch.clone());
        let verified = verify(&model, |element| roles[element.0 as usize], &scene, &verifying)?;
        (row.verified, row.wrong) = (verified.total.rays, verified.total.wrong);
        Ok(Step { touching: touching(&scene, &graph), scene, row })
    }
}

/// The global id of the room with this index.
fn room_id(scene: &Scene, room: u32) -> &str {
    scene.room(room).element().id()
}

/// Of what openings truly join, the share that was found; and of what was found, the share that is true.
fn joins(scene: &Scene, graph: &Graph, truth: &Truth) -> (f64, Option<f64>) {
    let openings = truth.openings.iter();
    let is: BTreeSet<[&str; 2]> = openings
        .flat_map(|opening| opening.joins.iter().map(|join| [opening.air.id.as_str(), join.id.as_str()]))
        .collect();
    let told: BTreeSet<[&str; 2]> = graph
        .openings
        .iter()
        .flat_map(|opening| opening.sides.map(|side| (opening.element, side)))
        .map(|(opening, side)| {
            let side = match side {
                Side::Room(room) => room_id(scene, room),
                Side::Exterior => truth.exterior.id.as_str(),
                Side::Void => "",
            };
            [scene.element(opening).id(), side]
        })
        .collect();
    let both = is.intersection(&told).count() as f64;
    let share = |all: usize| (all > 0).then_some(both / all as f64);
    (share(is.len()).unwrap_or(1.0), share(told.len()))
}

/// How far rooms' volumes are off, as a share: the mean and the most.
fn volume_error(scene: &Scene, graph: &Graph, truth: &Truth) -> [f64; 2] {
    let told = |id: &str| {
        let rooms = (0u32..).zip(&graph.rooms);
        rooms.filter(|(room, _)| room_id(scene, *room) == id).map(|(_, room)| room.volume).sum::<f64>()
    };
    let errors: Vec<f64> = truth
        .rooms
        .iter()
        .filter(|room| room.air.volume > 0.0)
        .map(|room| (told(&room.air.id) / room.air.volume - 1.0).abs())
        .collect();
    let sum: f64 = errors.iter().sum();
    [sum / errors.len().max(1) as f64, errors.iter().copied().fold(0.0, f64::max)]
}

/// What touches without an opening: rooms, and the open.
fn touching(scene: &Scene, graph: &Graph) -> BTreeSet<Pair> {
    let name = |place: Place| match place {
        Place::Room(room) => Some(room_id(scene, room).to_owned()),
        Place::Exterior => Some("the open".to_owned()),
        Place::Void(_) => None,
    };
    let passages = graph.portals.iter().filter(|passage| passage.opening.is_none());
    passages.filter_map(|passage| Some([name(passage.places[0])?, name(passage.places[1])?])).collect()
}

/// The building as it was drawn, and rays in it.
struct Reference<'a> {
    rays: Vec<Ray>,
    /// One thread.
    timed: Timed,
    step: &'a Step,
}

impl Reference<'_> {
    /// The row of a step, with what the rays say.
    fn measured(&self, step: &Step, options: &RobustOptions) -> RobustRow {
        let mut row = step.row;
        let drawn = &self.step.scene;
        let rays: Vec<Ray> =
            self.rays.iter().map(|ray| between(&drawn.frame(), &step.scene.frame(), ray)).collect();
        let mut told = [vec![Hit::ESCAPED; rays.len()], vec![Hit::ESCAPED; rays.len()]];
        let mut times = [Vec::new(), Vec::new()];
        for _ in 0..options.repeat.max(1) {
            for (i, (scene, rays)) in [(drawn, &self.rays), (&step.scene, &rays)].into_iter().enumerate() {
                let start = Instant::now();
                self.timed.install(|| scene.trace_many(rays, &mut told[i], Want::default()));
                times[i].push(start.elapsed().as_secs_f64() * 1e9 / rays.len().max(1) as f64);
            }
        }
        [row.drawn_ns_per_ray, row.ns_per_ray] = times.map(|mut times| median(&mut times));
        row.leaky_pairs = step.touching.difference(&self.step.touching).count() as u64;
        row.rays = rays.len() as u64;
        // What lies flush with it is no other.
        let is_other = |before: &Hit, after: &Hit| (before.t - after.t).abs() > drawn.tolerance();
        let (mut squares, mut same) = (0.0, 0u64);
        for (before, after) in told[0].iter().zip(&told[1]) {
            if after.t.is_nan() {
                row.in_solid += 1;
            } else if after.t.is_infinite() {
                row.leaks += u64::from(before.t.is_finite());
            } else if before.t.is_infinite()
                || (is_other(before, after) && id(drawn, before) != id(&step.scene, after))
            {
                row.other_element += 1;
            } else {
                same += 1;
                squares += (before.t - after.t).powi(2);
            }
        }
        row.moved_rms = (squares / same.max(1) as f64).sqrt();
        row
    }
}

/// The identity of what was met.
fn id<'a>(scene: &'a Scene, hit: &Hit) -> &'a str {
    scene.element(hit.element).id()
}

/// A ray in another scene's frame.
fn between(from: &Frame, to: &Frame, ray: &Ray) -> Ray {
    let origin = to.point_to_internal(from.point_to_source(ray.origin));
    let direction = to.direction_to_internal(from.direction_to_source(ray.direction));
    Ray { origin, direction, ..*ray }
}
