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
use std::time::Instant;

use enfilade_importers::Model;
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
    /// How the model is compiled; its map is kept, whatever this says.
    pub compiling: CompileOptions,
}

impl Default for SkipOptions {
    fn default() -> SkipOptions {
        SkipOptions { rays: 1 << 16, repeat: 7, seed: 1, compiling: CompileOptions::default() }
    }
}

/// What it takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Work {
    /// Nanoseconds a ray, or of an opening.
    pub ns: f64,
    /// Steps of a ray in the mean; `None` where they are not counted.
    pub steps: Option<Steps>,
    /// Bytes of the file that are checked; `None` of rays.
    pub bytes: Option<u64>,
}

/// Steps of a ray in the mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Steps {
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
    /// Of the prisms, those that were left by the kernel for slopes.
    pub sloped: f64,
}

/// What there is of something, and what is taken of it: the rest is skipped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldRow {
    /// What.
    pub what: &'static str,
    /// The trait of scenes that have any; `None` if all have.
    pub of_trait: Option<&'static str>,
    /// How many there are.
    pub all: u64,
    /// How many of them a ray takes in the mean; of a file's, who opens it for rays.
    pub taken: f64,
}

impl HeldRow {
    /// The part that is left out, in percent; 0 where there are none.
    pub fn skipped(&self) -> f64 {
        if self.all == 0 { 0.0 } else { 100.0 * (1.0 - self.taken / self.all as f64) }
    }
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
    /// Rays whose answers differ: farther off than the tolerance, or another element that is not flush; none should. `None` of files.
    pub differing: Option<u64>,
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
    /// What the scene and its file hold, and what of that rays take.
    pub held: Vec<HeldRow>,
    /// What is skipped for rays.
    pub rows: Vec<SkipRow>,
    /// What is skipped where a file is opened.
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
    let compiling = CompileOptions { topology: true, ..options.compiling.clone() };
    let compiled = compile(model, &compiling)?;
    let files = files(&compiled.bytes, options)?;
    let scene = compiled.scene();
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
        held: bench.held(&compiled.bytes)?,
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

/// What that takes, if it can be counted.
type Count<'a> = Option<&'a dyn Fn(&Started) -> Cost>;

struct Bench<'a> {
    scene: &'a Scene,
    rays: &'a [Started],
    options: &'a SkipOptions,
}

impl Bench<'_> {
    /// What there is, beside what rays take of it.
    fn held(&self, bytes: &[u8]) -> Result<Vec<HeldRow>, FormatError> {
        let tables = &self.scene.tables;
        let counted =
            |start: &Started| self.scene.trace_cost_from(Start::Cell(start.cell), &start.ray, Want::LEAST).1;
        let taken = self.counted(&counted);
        let air = || (0..tables.cells.len()).filter(|&cell| tables.cells[cell].kind == CellRecord::AIR);
        let count = |cells: &mut dyn Iterator<Item = usize>| cells.count() as u64;
        let with_detail = count(&mut air().filter(|&cell| tables.cells[cell].root != NONE));
        let sloped = count(&mut air().filter(|&cell| tables.steps[cell].is_sloped()));
        let opened = Views::open(Storage::copy(bytes), true)?;
        let (map_sections, map_bytes) = opened.map_sections();
        let (ray_sections, all_bytes) = (Views::ray_sections(), bytes.len() as u64);
        let row = |what, of_trait, all, taken| HeldRow { what, of_trait, all, taken };
        let detail = Some("detail");
        Ok(vec![
            row("cells of air", None, count(&mut air()), taken.cells),
            row("of these, with anything in them", detail, with_detail, taken.cells - taken.empty),
            row("of these, with a sloped floor or ceiling", Some("sloped"), sloped, taken.sloped),
            row("nodes of hierarchies", None, tables.nodes.len() as u64, taken.nodes),
            row("blocks of triangles", None, tables.blocks.len() as u64, taken.blocks),
            row("triangles", None, tables.triangles.len() as u64, taken.tests),
            row("sections of the file", None, ray_sections + map_sections, ray_sections as f64),
            row("bytes of the file", None, all_bytes, (all_bytes - map_bytes) as f64),
        ])
    }

    fn rows(&self, whole: &Scene) -> Vec<SkipRow> {
        let scene = self.scene;
        let from_cell = |start: &Started| scene.trace_from(Start::Cell(start.cell), &start.ray, Want::LEAST);
        let counted =
            |scene: &Scene, start: Start<'_>, ray: &Ray| scene.trace_cost_from(start, ray, Want::LEAST).1;
        let here = |start: &Started| counted(scene, Start::Cell(start.cell), &start.ray);
        let with: (Ask<'_>, Count<'_>) = (&from_cell, Some(&here));
        // Straight to the hierarchy: there are no cells to try.
        let of_all = |start: &Started| whole.careful(Start::Cell(0), &start.ray, Want::LEAST);
        let steps_of_all = |start: &Started| whole.careful_cost(Start::Cell(0), &start.ray, Want::LEAST).1;
        let mut rows = vec![self.row(
            ("triangles of cells that the ray does not cross", "always"),
            with,
            (&of_all, Some(&steps_of_all)),
        )];
        for (skipped, when, other) in [
            ("triangles behind plain faces", "faces are plain", without_plain_faces(scene)),
            ("hierarchies of cells with nothing in them", "cells are empty", without_empty_cells(scene)),
            ("slopes of floors and ceilings", "these are level", without_level_planes(scene)),
        ] {
            let ask = |start: &Started| other.trace_from(Start::Cell(start.cell), &start.ray, Want::LEAST);
            let steps = |start: &Started| counted(&other, Start::Cell(start.cell), &start.ray);
            rows.push(self.row((skipped, when), with, (&ask, Some(&steps))));
        }
        let careful = |start: &Started| scene.careful(Start::Cell(start.cell), &start.ray, Want::LEAST);
        let steps = |start: &Started| scene.careful_cost(Start::Cell(start.cell), &start.ray, Want::LEAST).1;
        rows.push(self.row(
            ("all that settles doubts", "the ray passes no edge closely"),
            with,
            (&careful, Some(&steps)),
        ));
        let anywhere = |start: &Started| scene.trace_from(Start::Anywhere, &start.ray, Want::LEAST);
        let steps = |start: &Started| counted(scene, Start::Anywhere, &start.ray);
        rows.push(self.row(
            ("finding the cell in which a ray starts", "the caller knows it"),
            with,
            (&anywhere, Some(&steps)),
        ));
        let brief = |start: &Started| {
            let brief = scene.trace_brief(Start::Cell(start.cell), &start.ray);
            let element = if brief.triangle == NONE { NONE } else { scene.triangle_element(brief.triangle) };
            Hit { t: brief.t, triangle: brief.triangle, element, ..Hit::ESCAPED }
        };
        let all = Want { room: true, face: true, triangle: true };
        rows.push(self.row(
            ("room, kind of face, very triangle, normal", "a brief answer is asked for"),
            (&brief, Some(&here)),
            (&|start| scene.trace_from(Start::Cell(start.cell), &start.ray, all), None),
        ));
        rows.extend(self.sight());
        rows
    }

    fn row(
        &self,
        (skipped, when): (&'static str, &'static str),
        with: (Ask<'_>, Count<'_>),
        without: (Ask<'_>, Count<'_>),
    ) -> SkipRow {
        let mut told = [vec![Hit::ESCAPED; self.rays.len()], vec![Hit::ESCAPED; self.rays.len()]];
        let times = timed(self.options.repeat, |side| {
            let ask = [with.0, without.0][side];
            for (start, hit) in self.rays.iter().zip(&mut told[side]) {
                *hit = ask(start);
            }
        });
        let differing = told[0].iter().zip(&told[1]).filter(|(a, b)| !self.are_same(a, b)).count() as u64;
        let work = |side: usize, count: Count<'_>| Work {
            ns: times[side] / self.rays.len().max(1) as f64,
            steps: count.map(|count| self.counted(count)),
            bytes: None,
        };
        SkipRow {
            skipped,
            when,
            with: work(0, with.1),
            without: work(1, without.1),
            differing: Some(differing),
        }
    }

    fn are_same(&self, a: &Hit, b: &Hit) -> bool {
        let off = if a.t == b.t { 0.0 } else { (a.t - b.t).abs() };
        off <= FLUSH || (off <= self.scene.tolerance() && a.element == b.element)
    }

    /// Whether anything is in the way, and what is nearest, between the starts of rays; nothing if all start in one point.
    fn sight(&self) -> Option<SkipRow> {
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
        if segments.is_empty() {
            return None;
        }
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
            (&sees, None),
            (&from_cell, Some(&here)),
        );
        // Only whether, not where.
        let is_other = |start: &&Started| sees(start).t.is_finite() != from_cell(start).t.is_finite();
        row.differing = Some(segments.iter().filter(is_other).count() as u64);
        Some(row)
    }

    /// Means of all rays.
    fn counted(&self, count: &dyn Fn(&Started) -> Cost) -> Steps {
        let mut all = Costs::default();
        self.rays.iter().for_each(|start| all.add(&count(start)));
        Steps {
            cells: all.mean(all.cells),
            empty: all.mean(all.empty),
            nodes: all.mean(all.nodes),
            blocks: all.mean(all.blocks),
            tests: all.mean(all.tests),
            plain: all.mean(all.plain),
            sloped: all.mean(all.sloped),
        }
    }
}

/// Nearer surfaces are flush, metres.
const FLUSH: f64 = 1e-6;

/// What opening a file skips.
fn files(bytes: &[u8], options: &SkipOptions) -> Result<Vec<SkipRow>, FormatError> {
    let opened = Views::open(Storage::copy(bytes), true)?;
    opened.check_map()?;
    let (_, map) = opened.map_sections();
    let rays = bytes.len() as u64 - map;
    let row = |skipped, when, checked: [u64; 2], open: &dyn Fn(usize, Storage)| {
        // Copied before the clock runs: a file that is mapped is not copied.
        let storages = (0..2 * options.repeat.max(1)).map(|_| Storage::copy(bytes));
        let mut storages: Vec<Storage> = storages.collect();
        let times = timed(options.repeat, |side| {
            if let Some(storage) = storages.pop() {
                open(side, storage);
            }
        });
        let [with, without] =
            [0, 1].map(|side| Work { ns: times[side], steps: None, bytes: Some(checked[side]) });
        SkipRow { skipped, when, with, without, differing: None }
    };
    // Both went well above.
    let map_too = |side: usize, storage: Storage| {
        let views = Views::open(storage, true);
        black_box(views.is_ok_and(|views| side == 0 || views.check_map().is_ok()));
    };
    let checked = |side: usize, storage: Storage| {
        black_box(Views::open(storage, side == 1).is_ok());
    };
    Ok(vec![
        row("the building's map", "only rays are asked", [rays, rays + map], &map_too),
        row("checks of checksums, indices and numbers", "the bytes are one's own", [0, rays], &checked),
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
