//! Where errors come from: an experiment for each source, in which that one alone makes the difference.
//!
//! The rays are random ones from rooms. Each row holds one way to answer them against another that is free of one source of error; the last of
//! them is exact arithmetic on the model's triangles ([`Truth::first`]).

use std::collections::HashSet;

use enfilade_importers::Model;
use glam::DVec3;
use serde::Serialize;

use super::error::{Spread, Sum, shade_of};
use super::speed::random_rays;
use super::table::{aligned, markdown};
use crate::compile::{CompileError, CompileOptions, compile};
use crate::format::records::{CellRecord, PLAIN};
use crate::graph::{At, parts};
use crate::oracle::{First, Truth, TruthOptions};
use crate::roles::roles;
use crate::scene::Scene;
use crate::trace::{Hit, Kernel, NONE, Place, Plate, Prisms, Ray, Start, Want, plate_of};

/// How to measure.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SourceOptions {
    /// Random rays from rooms.
    pub rays: u32,
    /// Seed of the rays.
    pub seed: u64,
    /// How the model is compiled.
    pub compiling: CompileOptions,
}

impl Default for SourceOptions {
    fn default() -> SourceOptions {
        SourceOptions { rays: 1 << 15, seed: 1, compiling: CompileOptions::default() }
    }
}

/// One source of error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SourceRow {
    /// The source.
    pub source: &'static str,
    /// What was held against what.
    pub experiment: &'static str,
    /// Rays, or corners.
    pub count: u64,
    /// Of these, how many came out otherwise: farther off than the tolerance, another element that is not flush with it, nothing instead of
    /// something, or the reverse. `None` where no answers are compared.
    pub differing: Option<u64>,
    /// Whether a ray that came out otherwise is a fault: not so where rays were rounded, which may pass an edge on its other side.
    pub is_fault: bool,
    /// Errors of the others: metres, but of shades, which are between 0 and 1. Escapes have none.
    pub errors: Spread,
}

/// What [`sources`] measured.
#[derive(Clone, Debug, Serialize)]
pub struct SourceReport {
    /// The program's version.
    pub version: &'static str,
    /// The tolerance, metres.
    pub tolerance: f64,
    /// Edge of the lattice's steps, metres.
    pub lattice: f64,
    /// Rays.
    pub rays: u64,
    /// Of these, rays that have several exact answers.
    pub tied: u64,
    /// The sources.
    pub rows: Vec<SourceRow>,
}

/// Measures each source of error by an experiment of its own.
///
/// # Errors
/// Those of [`compile`].
pub fn sources(model: &Model, options: &SourceOptions) -> Result<SourceReport, CompileError> {
    let scene = compile(model, &options.compiling)?.scene();
    let whole = compile(model, &CompileOptions { cells: false, ..options.compiling.clone() })?.scene();
    let roles = roles(model, options.compiling.untagged);
    let truth = Truth::new(
        model,
        |element| roles[element.0 as usize],
        &TruthOptions::default().with_tolerance(scene.tolerance()),
    );
    let rays = random_rays(&scene, options.rays, options.seed);
    let exact = crate::parallel::map(rays.len(), |i| truth.first(&rays[i]));
    let tied = exact.iter().flatten().filter(|first| first.is_tie()).count() as u64;
    let experiment = Experiment { scene: &scene, model, rays: &rays, exact: &exact };
    Ok(SourceReport {
        version: env!("CARGO_PKG_VERSION"),
        tolerance: scene.tolerance(),
        lattice: scene.tables.scene[0].lattice_step(),
        rays: rays.len() as u64,
        tied,
        rows: experiment.rows(&whole, &truth),
    })
}

struct Experiment<'a> {
    scene: &'a Scene,
    model: &'a Model,
    rays: &'a [Ray],
    exact: &'a [Option<First>],
}

/// What a way says: how far, and which element; infinite for nothing.
type Told = (f64, u32);

fn told(hit: &Hit) -> Told {
    (hit.t, hit.element)
}

impl Experiment<'_> {
    fn rows(&self, whole: &Scene, truth: &Truth) -> Vec<SourceRow> {
        let scene = self.scene;
        let hits: Vec<Hit> = self.each(|ray| scene.trace_from(start(scene, ray), ray, Want::LEAST));
        let kernel: Vec<Told> = hits.iter().map(told).collect();
        // Without the quick way: of cells, and of one hierarchy, so that cells alone make the difference.
        let careful: Vec<Hit> = self.each(|ray| scene.careful(start(scene, ray), ray, Want::LEAST));
        let all = self.each(|ray| told(&whole.careful(Start::Cell(0), ray, Want::LEAST)));
        let narrow = self.each(|ray| {
            let ray = super::tracers::narrow(ray);
            told(&scene.trace_from(start(scene, &ray), &ray, Want::LEAST))
        });
        let f64s = self.each(|ray| match truth.nearest(ray) {
            Some(nearest) => (nearest.t, nearest.element.0),
            None => (f64::INFINITY, NONE),
        });
        let by = |kernel: Kernel| {
            self.each(|ray| told(&scene.trace_with(kernel, start(scene, ray), ray, Want::LEAST)))
        };
        let solid = scene.tables.cells.iter().filter(|cell| cell.kind == CellRecord::SOLID);
        let solids: HashSet<u32> = solid.map(|cell| cell.element).collect();
        let every: Vec<usize> = (0..hits.len()).collect();
        let ended = every.iter().copied().filter(|&i| hits[i].t.is_finite());
        let (walls, detail): (Vec<usize>, Vec<usize>) =
            ended.partition(|&i| solids.contains(&hits[i].element));
        let [faces, read_off] = self.lattice(&careful);
        let careful: Vec<Told> = careful.iter().map(told).collect();
        let mut rows = vec![
            faces,
            read_off,
            self.between(
                ("lattice", "cells, against one hierarchy of all triangles, both in f64"),
                &careful,
                &all,
            ),
            self.between(
                ("the quick way", "planes for triangles, margins in f32, against f64 and all triangles"),
                &kernel,
                &careful,
            ),
        ];
        let portable = by(Kernel::PORTABLE);
        for other in Kernel::available().into_iter().filter(|kernel| *kernel != Kernel::PORTABLE) {
            let source = match other.name() {
                "avx2" => "AVX2",
                _ => "AVX-512",
            };
            rows.push(self.between((source, "against the portable kernel"), &by(other), &portable));
        }
        let mut rounded = self.to_exact(
            ("f32 in rays", "rays rounded to f32, against exact arithmetic on those as they were"),
            &narrow,
            &every,
        );
        rounded.is_fault = false;
        rows.extend([
            self.to_exact(("f64", "the truth in f64, against exact arithmetic"), &f64s, &every),
            self.to_exact(("traversal", "the kernel, against exact arithmetic"), &kernel, &every),
            self.to_exact(
                ("walls", "the same, of rays that end at what cells were cut around"),
                &kernel,
                &walls,
            ),
            self.to_exact(("detail", "the same, of rays that end at anything else"), &kernel, &detail),
            rounded,
            self.shading(&hits, false),
            self.shading(&hits, true),
        ]);
        rows
    }

    fn each<T: Send>(&self, answer: impl Fn(&Ray) -> T + Sync + Send) -> Vec<T> {
        crate::parallel::map(self.rays.len(), |i| answer(&self.rays[i]))
    }

    fn between(&self, names: Names, one: &[Told], other: &[Told]) -> SourceRow {
        let mut row = Row::new(names);
        for (&(t, element), &(as_much, as_such)) in one.iter().zip(other) {
            if t.is_infinite() && as_much.is_infinite() {
                row.agree();
                continue;
            }
            let off = (t - as_much).abs();
            row.compare(off, off <= self.scene.tolerance() && (element == as_such || off <= FLUSH));
        }
        row.done()
    }

    /// Distances against the exact ones, of some of the rays.
    fn to_exact(&self, names: Names, told: &[Told], which: &[usize]) -> SourceRow {
        let mut row = Row::new(names);
        for &i in which {
            let (t, element) = told[i];
            match &self.exact[i] {
                Some(first) if t.is_finite() && t >= 0.0 => {
                    let off = first.off(t).abs();
                    let is_met = first.met.iter().any(|(met, _)| met.element.0 == element);
                    row.compare(off, off <= self.scene.tolerance() && (is_met || off <= FLUSH));
                }
                None if t.is_infinite() => row.agree(),
                _ => row.compare(f64::INFINITY, false),
            }
        }
        row.done()
    }

    /// How far cells' surfaces are off: the corners of plain faces from the plane behind them; and what distances would be, were they read off
    /// plain faces of cells.
    fn lattice(&self, hits: &[Hit]) -> [SourceRow; 2] {
        let tables = &self.scene.tables;
        let prisms = Prisms::new(tables);
        // Of each cell of air: corners' errors, and its plain faces.
        let cells = crate::parallel::map(tables.cells.len(), |index| {
            let (mut offs, mut plain) = (Vec::new(), Vec::new());
            let cell = &tables.cells[index];
            let parts = if cell.kind == CellRecord::AIR { parts(&prisms, cell) } else { Vec::new() };
            for part in parts.into_iter().filter(|part| part.source != NONE) {
                let flags = match part.at {
                    At::Face(face) => tables.faces[face as usize].flags,
                    At::Cover(cover) => tables.covers[cover as usize].flags,
                };
                // Behind others there may be triangles of many planes, or none.
                if flags & PLAIN == 0 {
                    continue;
                }
                let plane = tables.sources[part.source as usize].plane;
                let plate = plate_of(&tables.triangles, &tables.vertices, plane);
                let off = |p: &DVec3| (DVec3::from(plate.normal).dot(*p) - plate.offset).abs();
                offs.extend(part.corners.iter().map(off));
                plain.push((plate, part.corners));
            }
            (offs, plain)
        });
        let mut corners =
            Row::new(("lattice", "corners of plain faces of cells, from the plane behind them"));
        cells.iter().flat_map(|(offs, _)| offs).for_each(|&off| corners.measure(off));
        let mut read_off = Row::new((
            "lattice",
            "distances, were they read off plain faces of cells, against the triangles",
        ));
        for (ray, hit) in self.rays.iter().zip(hits) {
            let Some((_, plain)) = cells.get(hit.cell as usize).filter(|_| hit.t.is_finite()) else {
                continue;
            };
            let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction).normalize());
            let point = DVec3::from(hit.point);
            // The face behind whose plane the hit lies: in a corner it is as near to others.
            let normal = DVec3::from(hit.normal);
            let off = |plate: &Plate| (DVec3::from(plate.normal).dot(point) - plate.offset).abs();
            let near = plain.iter().find(|(plate, corners)| {
                let is_parallel = DVec3::from(plate.normal).dot(normal).abs() > PARALLEL;
                is_parallel && off(plate) < NEAR && holds(corners, point)
            });
            let Some((_, corners)) = near else { continue };
            let normal = newell(corners);
            let toward = normal.dot(direction);
            if toward.abs() > GRAZING {
                let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
                read_off.measure((normal.dot(middle - origin) / toward - hit.t).abs());
            }
        }
        [corners.done(), read_off.done()]
    }

    /// What a light at the eye gives: of the kernel's normal, in f64, or in 255 steps as in a picture's file, against the exact triangle's.
    fn shading(&self, hits: &[Hit], in_steps: bool) -> SourceRow {
        let experiment = if in_steps {
            "the same in 255 steps, as in a PNG"
        } else {
            "shades by the kernel's normals, against the exact triangles', of rays that meet the same element"
        };
        let mut row = Row::new(("shading", experiment));
        for ((ray, hit), exact) in self.rays.iter().zip(hits).zip(self.exact) {
            let Some(first) = exact else { continue };
            let own = first.met.iter().find(|(met, _)| met.element.0 == hit.element);
            let Some((met, _)) = own.filter(|_| hit.t.is_finite()) else { continue };
            let mesh = &self.model.elements[met.element.0 as usize].mesh;
            let [a, b, c] = mesh.corners(met.triangle as usize).map(DVec3::from);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let mut shade = shade_of(hit.element, DVec3::from(hit.normal), ray);
            if in_steps {
                shade = (shade * 255.0).round() / 255.0;
            }
            row.measure((shade - shade_of(met.element.0, normal, ray)).abs());
        }
        row.done()
    }
}

/// Nearer surfaces are flush, metres.
const FLUSH: f64 = 1e-6;

/// Of planes with a smaller cosine between their normals one is not the other.
const PARALLEL: f64 = 0.999;

/// A hit lies in the plane of a face from which it is no farther, metres: what walls that are not quite planar are off, and more.
const NEAR: f64 = 1e-5;

/// The sine of angles below which lattices and planes are not compared.
const GRAZING: f64 = 1e-2;

/// A source, and its experiment.
type Names = (&'static str, &'static str);

/// A source whose errors are being summed.
struct Row {
    names: Names,
    count: u64,
    differing: Option<u64>,
    sum: Sum,
}

impl Row {
    fn new(names: Names) -> Row {
        Row { names, count: 0, differing: None, sum: Sum::default() }
    }

    /// An error by itself.
    fn measure(&mut self, error: f64) {
        self.count += 1;
        self.sum.add(error);
    }

    /// An error of two answers, and whether they agree.
    fn compare(&mut self, error: f64, agree: bool) {
        self.agree();
        if agree {
            self.sum.add(error);
        } else {
            self.differing = self.differing.map(|count| count + 1);
        }
    }

    /// Two answers without a distance.
    fn agree(&mut self) {
        self.count += 1;
        self.differing.get_or_insert(0);
    }

    fn done(self) -> SourceRow {
        let Row { names: (source, experiment), count, differing, sum } = self;
        SourceRow { source, experiment, count, differing, is_fault: true, errors: sum.spread() }
    }
}

fn start(scene: &Scene, ray: &Ray) -> Start<'static> {
    match scene.locate(ray.origin) {
        Place::Air { cell, .. } => Start::Cell(cell),
        _ => Start::Anywhere,
    }
}

/// The normal of a polygon, of unit length.
fn newell(corners: &[DVec3]) -> DVec3 {
    let next = corners.iter().cycle().skip(1);
    let sum: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - corners[0]).cross(*b - corners[0])).sum();
    sum.normalize_or_zero()
}

/// Whether a point near the plane of a convex polygon lies over it.
fn holds(corners: &[DVec3], point: DVec3) -> bool {
    let normal = newell(corners);
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).all(|(a, b)| normal.cross(*b - *a).dot(point - *a) >= 0.0)
}

impl SourceReport {
    /// Whether no answer came out otherwise that should not have.
    pub fn passed(&self) -> bool {
        self.rows.iter().all(|row| !row.is_fault || row.differing.unwrap_or(0) == 0)
    }

    fn head(&self) -> String {
        format!(
            "{} random rays, {} of them with several exact answers; tolerance {} m, lattice of {:e} m",
            self.rays, self.tied, self.tolerance, self.lattice
        )
    }

    fn lines(&self) -> Vec<Vec<String>> {
        let names = ["source", "experiment", "rays", "otherwise", "largest", "mean", "rms"];
        let line = |row: &SourceRow| {
            let [largest, mean, rms] =
                [row.errors.largest, row.errors.mean, row.errors.rms].map(|error| format!("{error:.1e}"));
            let differing = row.differing.map_or("-".to_owned(), |count| count.to_string());
            let count = row.count.to_string();
            vec![row.source.to_owned(), row.experiment.to_owned(), count, differing, largest, mean, rms]
        };
        [names.map(str::to_owned).to_vec()].into_iter().chain(self.rows.iter().map(line)).collect()
    }

    /// As aligned text.
    pub fn text(&self) -> String {
        self.head() + "\n" + &aligned(&self.lines(), 2)
    }

    /// As a table in Markdown.
    pub fn markdown(&self) -> String {
        self.head() + "\n\n" + &markdown(&self.lines(), 2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{HouseOptions, Style, house};

    #[test]
    fn each_source_has_its_size() {
        let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
        let report = sources(&model, &SourceOptions { rays: 3000, ..SourceOptions::default() }).unwrap();
        for row in &report.rows {
            assert_eq!(row.differing.unwrap_or(0), 0, "{}", report.text());
            assert!(row.count > 300, "{}", report.text());
        }
        let of = |source: &str| report.rows.iter().filter(|row| row.source == source).collect::<Vec<_>>();
        // The house lies on the lattice.
        assert!(of("lattice").iter().all(|row| row.errors.largest < 1e-9), "{}", report.text());
        assert!(of("f64")[0].errors.largest < 1e-13);
        let kernels = report.rows.iter().filter(|row| row.experiment == "against the portable kernel");
        assert_eq!(kernels.clone().count() + 1, Kernel::available().len());
        assert!(kernels.into_iter().all(|row| row.errors.largest == 0.0));
        assert!((1e-8..1e-4).contains(&of("f32 in rays")[0].errors.rms), "{}", report.text());
        // A step of 255 rounds by half of one at most, evenly.
        let steps = of("shading")[1].errors;
        assert!((steps.rms - 1.0 / 255.0 / 12f64.sqrt()).abs() < 1e-4 && steps.largest < 0.5001 / 255.0);
        // All but what escapes.
        let ended = of("walls")[0].count + of("detail")[0].count;
        assert!((2950..=3000).contains(&ended), "{}", report.text());
        let lines = report.text().lines().count();
        assert_eq!(
            (lines, report.markdown().lines().count()),
            (2 + report.rows.len(), 4 + report.rows.len())
        );
    }

    #[test]
    fn a_lattice_that_walls_do_not_lie_on_is_off_by_less_than_its_steps() {
        let mut style = Style::exact();
        (style.turned, style.off_grid) = (true, true);
        let model = house(&HouseOptions::default()).export(&style).to_model().unwrap();
        let report = sources(&model, &SourceOptions { rays: 2000, ..SourceOptions::default() }).unwrap();
        let lattice: Vec<_> = report.rows.iter().filter(|row| row.source == "lattice").collect();
        assert!(lattice[0].errors.rms > 1e-8 && lattice[1].errors.rms > 1e-8, "{}", report.text());
        assert!(report.passed() && lattice[0].errors.largest < 1e-3, "{}", report.text());
    }
}
