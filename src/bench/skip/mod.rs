//! What is skipped, and what each skip saves: the same rays with it and without it, counted and timed in turns.
//!
//! What a scene does not need is not done: triangles of other rooms, triangles behind plain faces, hierarchies of cells with nothing in them, slopes of
//! level floors. Each of these can be turned off here, by taking out of an opened scene what says that it need not be done; the answers
//! stay the same. So can what a caller does not need: where rays start is not looked up if it is known, a record not filled if a brief answer
//! will do, what is behind the nearest thing not asked if anything in the way will do; and of a file what rays do not read.

mod table;
#[cfg(test)]
mod tests;

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use enfilade_importers::{Model, Untagged};
use serde::Serialize;

use super::speed::{machine, median, random_rays};
use crate::compile::{CompileError, CompileOptions, compile};
use crate::format::records::{CellRecord, NodeRecord, PLAIN, Traits};
use crate::format::{FormatError, Storage, Views};
use crate::scene::Scene;
use crate::trace::{Cost, Costs, Hit, NONE, Place, Ray, Start, Want};

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SkipOptions {
    /// Random rays from rooms.
    pub rays: u32,
    /// How often they are traced each way, in turns; the median counts.
    pub repeat: u32,
    /// Seed of the rays.
    pub seed: u64,
    /// As the model was compiled.
    pub untagged: Untagged,
}

impl Default for SkipOptions {
    fn default() -> SkipOptions {
        SkipOptions { rays: 1 << 16, repeat: 7, seed: 1, untagged: Untagged::default() }
    }
}

/// What it takes, for a ray, or for a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Work {
    /// Nanoseconds.
    pub ns: f64,
    /// Prisms crossed.
    pub cells: f64,
    /// Of these, with nothing in them.
    pub empty: f64,
    /// Nodes of hierarchies opened, eight boxes each.
    pub nodes: f64,
    /// Blocks opened, up to eight triangles each.
    pub blocks: f64,
    /// Triangles tested in f64.
    pub tests: f64,
    /// Planes met without a look at triangles.
    pub plain: f64,
    /// Bytes of the file that are read and checked.
    pub bytes: u64,
}

/// A skip: with it, and without it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SkipRow {
    /// What is skipped.
    pub skipped: &'static str,
    /// When.
    pub when: &'static str,
    /// With the skip.
    pub with: Work,
    /// Without it.
    pub without: Work,
    /// Rays whose answers differ: none should.
    pub differing: u64,
}

impl SkipRow {
    /// How many times as long it takes without.
    pub fn ratio(&self) -> f64 {
        self.without.ns / self.with.ns
    }
}

/// What [`skip`] measured.
#[derive(Clone, Debug, Serialize)]
pub struct SkipReport {
    /// The program's version.
    pub version: &'static str,
    /// The processor's architecture and instruction sets.
    pub machine: String,
    /// What the scene holds.
    pub traits: Vec<&'static str>,
    /// Cells of air, and those of them with nothing in them.
    pub cells: [u64; 2],
    /// Faces of cells of air to matter, and those of them that are plain.
    pub faces: [u64; 2],
    /// Random rays.
    pub rays: u64,
    /// What is skipped for rays.
    pub rows: Vec<SkipRow>,
    /// What is skipped in a file that is opened: of its nanoseconds there are as many as of an opening.
    pub files: Vec<SkipRow>,
}

/// Nothing was measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SkipError {
    /// The model cannot be compiled.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// What was just compiled cannot be opened.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// There is nowhere to start from.
    #[error("no ray starts in the air of a cell")]
    NoRays,
}

/// Compiles a model, and measures what rays and openings skip.
///
/// # Errors
/// [`SkipError`].
pub fn skip(model: &Model, options: &SkipOptions) -> Result<SkipReport, SkipError> {
    let compiling =
        CompileOptions { untagged: options.untagged, topology: true, ..CompileOptions::default() };
    let compiled = compile(model, &compiling)?;
    let files = files(&compiled.bytes, options)?;
    let scene = Arc::new(compiled.scene());
    let whole = compile(model, &CompileOptions { cells: false, topology: false, ..compiling })?.scene();
    let rays = random_rays(&scene, options.rays, options.seed);
    let rays: Vec<Started> =
        rays.into_iter().filter_map(|ray| Some(Started { cell: cell(&scene, &ray)?, ray })).collect();
    if rays.is_empty() {
        return Err(SkipError::NoRays);
    }
    let bench = Bench { scene: &scene, rays: &rays, options };
    let air: Vec<&CellRecord> =
        scene.tables.cells.iter().filter(|cell| cell.kind == CellRecord::AIR).collect();
    let faces = scene.tables.faces.iter().map(|face| (face.source, face.flags));
    let covers = scene.tables.covers.iter().map(|cover| (cover.source, cover.flags));
    let walls: Vec<u16> =
        faces.chain(covers).filter(|(source, _)| *source != NONE).map(|(_, flags)| flags).collect();
    Ok(SkipReport {
        version: env!("CARGO_PKG_VERSION"),
        machine: machine(),
        traits: Traits(scene.tables.scene[0].traits).names(),
        cells: [air.len() as u64, air.iter().filter(|cell| cell.root == NONE).count() as u64],
        faces: [walls.len() as u64, walls.iter().filter(|flags| **flags & PLAIN != 0).count() as u64],
        rays: rays.len() as u64,
        rows: bench.rows(&whole),
        files,
    })
}

/// A ray, and the cell of air in which it starts.
struct Started {
    ray: Ray,
    cell: u32,
}

fn cell(scene: &Scene, ray: &Ray) -> Option<u32> {
    match scene.locate(ray.origin) {
        Place::Air { cell, .. } => Some(cell),
        _ => None,
    }
}

/// The scene as it was compiled, but for what says that faces are plain.
fn without_plain_faces(scene: &Scene) -> Scene {
    let mut tables = scene.tables.clone();
    tables.faces.edit(|faces| faces.iter_mut().for_each(|face| face.flags &= !PLAIN));
    tables.covers.edit(|covers| covers.iter_mut().for_each(|cover| cover.flags &= !PLAIN));
    tables.derive();
    Scene::from_views(tables)
}

/// The scene with a hierarchy of nothing in each cell that has none.
fn without_empty_cells(scene: &Scene) -> Scene {
    let mut tables = scene.tables.clone();
    let root = tables.nodes.len() as u32;
    tables.nodes.edit(|nodes| nodes.push(NodeRecord::EMPTY));
    tables
        .cells
        .edit(|cells| cells.iter_mut().filter(|cell| cell.root == NONE).for_each(|cell| cell.root = root));
    tables.derive();
    Scene::from_views(tables)
}

/// The scene whose level floors and ceilings are taken for sloped ones.
fn without_level_planes(scene: &Scene) -> Scene {
    let mut tables = scene.tables.clone();
    tables.steps.edit(|steps| steps.iter_mut().for_each(crate::trace::Step::forget_that_it_is_level));
    Scene::from_views(tables)
}

/// How a ray is answered.
type Ask<'a> = &'a dyn Fn(&Started) -> Hit;

struct Bench<'a> {
    scene: &'a Scene,
    rays: &'a [Started],
    options: &'a SkipOptions,
}

impl Bench<'_> {
    fn rows(&self, whole: &Scene) -> Vec<SkipRow> {
        let scene = self.scene;
        let from_cell = |start: &Started| scene.trace_from(Start::Cell(start.cell), &start.ray, Want::LEAST);
        let counted =
            |scene: &Scene, start: Start<'_>, ray: &Ray| scene.trace_cost_from(start, ray, Want::LEAST).1;
        let here = |start: &Started| counted(scene, Start::Cell(start.cell), &start.ray);
        let mut rows = Vec::new();
        for (skipped, when, other) in [
            ("triangles of cells that the ray does not cross", "always", None),
            ("triangles behind plain faces", "faces are plain", Some(without_plain_faces(scene))),
            (
                "hierarchies of cells with nothing in them",
                "cells are empty",
                Some(without_empty_cells(scene)),
            ),
            ("slopes of floors and ceilings", "these are level", Some(without_level_planes(scene))),
        ] {
            let other = other.as_ref().unwrap_or(whole);
            // A scene without cells has one, which is that of all.
            let start = |start: &Started| {
                if std::ptr::eq(other, whole) { Start::Cell(0) } else { Start::Cell(start.cell) }
            };
            rows.push(self.row(
                (skipped, when),
                (&from_cell, &here),
                (&|ray| other.trace_from(start(ray), &ray.ray, Want::LEAST), &|ray| {
                    counted(other, start(ray), &ray.ray)
                }),
            ));
        }
        rows.push(self.row(
            ("doubts that f64 and all triangles settle", "the ray passes no edge closely"),
            (&from_cell, &here),
            (&|start| scene.careful(Start::Cell(start.cell), &start.ray, Want::LEAST), &|start| {
                scene.careful_cost(Start::Cell(start.cell), &start.ray, Want::LEAST).1
            }),
        ));
        let anywhere = |start: &Started| scene.trace_from(Start::Anywhere, &start.ray, Want::LEAST);
        rows.push(self.row(
            ("finding the cell in which a ray starts", "the caller knows it"),
            (&from_cell, &here),
            (&anywhere, &|start| counted(scene, Start::Anywhere, &start.ray)),
        ));
        let brief = |start: &Started| {
            let brief = scene.trace_brief(Start::Cell(start.cell), &start.ray);
            Hit { t: brief.t, ..Hit::ESCAPED }
        };
        let all = Want { room: true, face: true, triangle: true };
        rows.push(self.row(
            ("room, kind of face, very triangle, normal", "a brief answer is asked for"),
            (&brief, &here),
            (&|start| scene.trace_from(Start::Cell(start.cell), &start.ray, all), &here),
        ));
        rows.push(self.sight());
        rows
    }

    fn row(
        &self,
        (skipped, when): (&'static str, &'static str),
        (with, count_with): (Ask<'_>, &dyn Fn(&Started) -> Cost),
        (without, count_without): (Ask<'_>, &dyn Fn(&Started) -> Cost),
    ) -> SkipRow {
        let mut told = [vec![Hit::ESCAPED; self.rays.len()], vec![Hit::ESCAPED; self.rays.len()]];
        let times = timed(self.options.repeat, |side| {
            let ask = [with, without][side];
            for (start, hit) in self.rays.iter().zip(&mut told[side]) {
                *hit = ask(start);
            }
        });
        let tolerance = self.scene.tolerance();
        let is_same = |a: f64, b: f64| a == b || (a - b).abs() <= tolerance;
        let is_other = |(a, b): &(&Hit, &Hit)| !is_same(a.t, b.t);
        let differing = told[0].iter().zip(&told[1]).filter(is_other).count() as u64;
        let work = |side: usize, count: &dyn Fn(&Started) -> Cost| Work {
            ns: times[side] / self.rays.len() as f64,
            ..self.counted(count)
        };
        SkipRow { skipped, when, with: work(0, count_with), without: work(1, count_without), differing }
    }

    /// Whether anything is in the way, and what is nearest, between the starts of rays.
    fn sight(&self) -> SkipRow {
        let ends = self.rays.iter().cycle().skip(1);
        let segments: Vec<Started> = self
            .rays
            .iter()
            .zip(ends)
            .filter(|(from, to)| from.ray.origin != to.ray.origin)
            .map(|(from, to)| {
                let way = [0, 1, 2].map(|i| to.ray.origin[i] - from.ray.origin[i]);
                let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
                Started { ray: Ray::segment(from.ray.origin, way, 0.0, length), cell: from.cell }
            })
            .collect();
        let scene = self.scene;
        let bench = Bench { rays: &segments, ..*self };
        let from_cell = |start: &Started| scene.trace_from(Start::Cell(start.cell), &start.ray, Want::LEAST);
        let sees = |start: &Started| {
            let is_occluded = scene.occluded_from(Start::Cell(start.cell), &start.ray);
            Hit { t: if is_occluded { 0.0 } else { f64::INFINITY }, ..Hit::ESCAPED }
        };
        let here =
            |start: &Started| scene.trace_cost_from(Start::Cell(start.cell), &start.ray, Want::LEAST).1;
        let mut row = bench.row(
            ("which of several things is nearest", "only sight is asked for"),
            (&sees, &here),
            (&from_cell, &here),
        );
        // Only whether, not where.
        let is_other = |start: &&Started| sees(start).t.is_finite() != from_cell(start).t.is_finite();
        row.differing = segments.iter().filter(is_other).count() as u64;
        // Its own steps are not counted.
        row.with = Work { ns: row.with.ns, ..Work::default() };
        row
    }

    /// Means of all rays.
    fn counted(&self, count: &dyn Fn(&Started) -> Cost) -> Work {
        let mut all = Costs::default();
        self.rays.iter().for_each(|start| all.add(&count(start)));
        Work {
            cells: all.mean(all.cells),
            empty: all.mean(all.empty),
            nodes: all.mean(all.nodes),
            blocks: all.mean(all.blocks),
            tests: all.mean(all.tests),
            plain: all.mean(all.plain),
            ..Work::default()
        }
    }
}

/// What opening a file skips.
fn files(bytes: &[u8], options: &SkipOptions) -> Result<Vec<SkipRow>, FormatError> {
    let open = |checked: bool| Views::open(Storage::copy(bytes), checked);
    let opened = open(true)?;
    let map: u64 = opened.map_bytes();
    let rays: u64 = bytes.len() as u64 - map;
    let row = |skipped, when, read: [u64; 2], work: &dyn Fn(usize)| {
        let times = timed(options.repeat, work);
        let [with, without] =
            [0, 1].map(|side| Work { ns: times[side], bytes: read[side], ..Work::default() });
        SkipRow { skipped, when, with, without, differing: 0 }
    };
    Ok(vec![
        row("the building's map", "only rays are asked", [rays, rays + map], &|side| {
            if let Ok(views) = open(true)
                && side == 1
            {
                black_box(views.check_map().is_ok());
            }
        }),
        row("checks of checksums, indices and numbers", "the bytes are one's own", [0, rays], &|side| {
            black_box(open(side == 1).is_ok());
        }),
    ])
}

/// Nanoseconds that the two sides of something take, in turns: medians.
fn timed(repeat: u32, mut work: impl FnMut(usize)) -> [f64; 2] {
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..repeat.max(1) {
        for (side, times) in times.iter_mut().enumerate() {
            let start = Instant::now();
            work(side);
            times.push(start.elapsed().as_secs_f64() * 1e9);
        }
    }
    times.map(|mut times| median(&mut times))
}
