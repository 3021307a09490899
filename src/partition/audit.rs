//! The audit after the partition: matter that no cell stands for becomes detail.
//!
//! A triangle of a body that carves lies on the surface of a solid cell or inside of one, or else the partition has lost
//! it: membranes of no thickness, bodies thinner than the lattice's merging, what lies outside of the hull. The solid
//! cells, moved out by the tolerance, are taken off each triangle; one of which more than a sliver is left is detail as a
//! whole, so that rays meet it.
//!
//! What is left and not wider than a sliver lies along the rim of matter, or else in a crack as narrow as that: a
//! parallel ray a tolerance and a sliver away, together well below a millimetre, does not see it.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, Watch};
use glam::DVec3;

use super::boxes::BoxTree;
use super::cells::Partition;
use super::halfspaces::{Body, Bounds, Cutter, HalfSpace, Piece, are_wider};
use super::matter::MatterTriangle;
use super::shapes::prism;
use crate::parallel;

/// Tolerances of [`audit`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AuditOptions {
    /// How far from a solid cell its triangles may lie, besides a lattice step, metres.
    pub tolerance: f64,
    /// The same above and below solid cells with a level ceiling or floor, metres: triangles that rise a little were
    /// made level.
    pub level: f64,
    /// What is left of a triangle and not wider than this does not count, metres.
    pub sliver: f64,
}

impl Default for AuditOptions {
    fn default() -> Self {
        AuditOptions { tolerance: 3.5e-4, level: 7.5e-4, sliver: 5e-5 }
    }
}

/// Why a triangle became detail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Exposure {
    /// It reaches out of the hull.
    OutsideHull,
    /// Hardly any of it is on or in matter: the body has no cells there.
    NoMatter,
    /// Some of it is on or in matter.
    InPart,
}

/// How many triangles, and how much of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Tally {
    /// Triangles.
    pub triangles: u32,
    /// Their area, m2.
    pub area: f64,
    /// The part of it that is neither on nor in matter, m2.
    pub exposed: f64,
}

impl Tally {
    fn add(&mut self, area: f64, exposed: f64) {
        self.triangles += 1;
        self.area += area;
        self.exposed += exposed;
    }
}

/// What [`audit`] found.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct AuditReport {
    /// All triangles.
    pub triangles: u32,
    /// Their area, m2.
    pub area: f64,
    /// Triangles without area: no ray meets them.
    pub flat: u32,
    /// Triangles that became detail.
    pub detail: Tally,
    /// The same by reason.
    pub reasons: BTreeMap<Exposure, Tally>,
    /// The same by element, as index in reports.
    #[serde(serialize_with = "by_index")]
    pub elements: BTreeMap<ElementId, Tally>,
}

fn by_index<S: serde::Serializer>(of: &BTreeMap<ElementId, Tally>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(of.iter().map(|(element, tally)| (element.0, tally)))
}

/// So many triangles are handed to a thread at once.
const CHUNK: usize = 1024;
/// If more than this share of a triangle is left, it counts however narrow it is.
const HALF: f64 = 0.5;
/// If more than this share of it is left, there is no matter.
const MOST: f64 = 0.99;

/// Adds to [`Partition::detail`], which stays in order and without doubles, all triangles that are neither on the surface
/// of a solid cell nor inside of one.
///
/// The result does not depend on the number of threads. If the caller cancels, it ends early.
pub fn audit(
    partition: &mut Partition,
    matter: &[MatterTriangle],
    options: &AuditOptions,
    watch: &Watch,
) -> AuditReport {
    let auditor = Auditor::new(partition, options);
    let chunks = parallel::map(matter.len().div_ceil(CHUNK), |chunk| {
        if watch.is_cancelled() {
            return Checked::default();
        }
        auditor.check(&matter[chunk * CHUNK..matter.len().min((chunk + 1) * CHUNK)])
    });
    let step = partition.lattice.step();
    let metres = |area: f64| area * step * step;
    let mut report = AuditReport { triangles: matter.len() as u32, ..AuditReport::default() };
    for (chunk, triangles) in chunks.into_iter().zip(matter.chunks(CHUNK)) {
        report.area += metres(chunk.area);
        report.flat += chunk.flat;
        for exposed in chunk.exposed {
            let triangle = &triangles[exposed.triangle];
            let (area, left) = (metres(triangle.area()), metres(exposed.left));
            report.detail.add(area, left);
            report.reasons.entry(exposed.why).or_default().add(area, left);
            report.elements.entry(triangle.element).or_default().add(area, left);
            partition.detail.push(triangle.name());
        }
    }
    partition.detail.sort_unstable();
    partition.detail.dedup();
    report
}

/// What the triangles of a chunk came to.
#[derive(Default)]
struct Checked {
    area: f64,
    flat: u32,
    exposed: Vec<Exposed>,
}

struct Exposed {
    /// Index in the chunk.
    triangle: usize,
    /// The area that is neither on nor in matter, square lattice units.
    left: f64,
    why: Exposure,
}

/// The solid cells, moved out by the tolerance.
struct Auditor {
    tree: BoxTree,
    bounds: Vec<Bounds>,
    /// Where each cell's sides end.
    ends: Vec<usize>,
    sides: Vec<HalfSpace>,
    hull: Bounds,
    sliver: f64,
}

impl Auditor {
    fn new(partition: &Partition, options: &AuditOptions) -> Auditor {
        let steps = |metres| partition.lattice.steps(metres) + 1.0;
        let tolerance = steps(options.tolerance);
        let level = steps(options.level).max(tolerance);
        let [low, high] = partition.hull.map(|corner| DVec3::from(corner.map(f64::from)));
        let mut auditor = Auditor {
            tree: BoxTree::default(),
            bounds: Vec::new(),
            ends: Vec::new(),
            sides: Vec::new(),
            hull: Bounds { low, high }.dilated(DVec3::splat(tolerance)),
            sliver: partition.lattice.steps(options.sliver),
        };
        let solids: Vec<_> = partition.cells.iter().filter(|cell| !cell.label.is_air()).collect();
        let chunks = parallel::map(solids.len().div_ceil(CHUNK), |chunk| {
            let mut sides = Vec::new();
            let cells = solids[chunk * CHUNK..].iter().take(CHUNK);
            let prisms: Vec<(Bounds, usize)> = cells
                .map(|cell| {
                    let bounds = prism(partition, cell, tolerance, level, &mut sides);
                    (bounds, sides.len())
                })
                .collect();
            (prisms, sides)
        });
        for (prisms, sides) in chunks {
            let start = auditor.sides.len();
            for (bounds, end) in prisms {
                auditor.bounds.push(bounds);
                auditor.ends.push(start + end);
            }
            auditor.sides.extend(sides);
        }
        auditor.tree = BoxTree::new(auditor.bounds.iter().copied());
        auditor
    }

    fn cell(&self, index: u32) -> Body<'_> {
        let index = index as usize;
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        Body { bounds: &self.bounds[index], sides: &self.sides[start..self.ends[index]] }
    }

    fn check(&self, triangles: &[MatterTriangle]) -> Checked {
        let mut checked = Checked::default();
        let mut cutter = Cutter::default();
        let (mut near, mut left) = (Vec::new(), Vec::new());
        for (index, triangle) in triangles.iter().enumerate() {
            let area = triangle.area();
            if area.is_nan() || area <= 0.0 {
                checked.flat += 1;
                continue;
            }
            checked.area += area;
            let points = triangle.points();
            let bounds = Bounds::of(&points);
            near.clear();
            self.tree.meeting(&bounds, |cell| near.push(cell));
            left.clear();
            let piece = Piece { corners: cutter.copy(&points), bounds };
            // If that takes too long, what is left is too much: the triangle becomes detail, which is always right.
            cutter.remove(piece, near.iter().copied(), &|c| self.cell(c), &mut left);
            let exposed: f64 = left.iter().map(Piece::area).sum();
            let is_exposed = exposed > HALF * area || are_wider(&left, self.sliver);
            for piece in left.drain(..) {
                cutter.give_back(piece.corners);
            }
            if is_exposed {
                let is_inside = points.iter().all(|&p| self.hull.meets(&Bounds { low: p, high: p }));
                let why = match () {
                    () if !is_inside => Exposure::OutsideHull,
                    () if exposed >= MOST * area => Exposure::NoMatter,
                    () => Exposure::InPart,
                };
                checked.exposed.push(Exposed { triangle: index, left: exposed, why });
            }
        }
        checked
    }
}

#[cfg(test)]
mod tests;
