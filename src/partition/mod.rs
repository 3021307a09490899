//! The partition of space into labelled convex prisms.
//!
//! `docs/PARTITION.md` tells the method. In short: the hull is cut at a few levels into *slabs*; in each slab the edges
//! of all faces that are not vertical are projected to the plan and rounded until nothing crosses ([`snap`]); over each
//! triangle of the plan the faces stand in order of height: a *column* with a stack of intervals; columns merge into
//! *cells*: prisms with a convex footprint, one floor plane and one ceiling plane.

mod assemble;
mod bodies;
pub mod cells;
mod columns;
mod convex;
mod crossings;
mod faces;
mod labels;
mod overlap;
mod plan;
mod regions;
mod slabs;
pub mod snap;
mod stacks;
mod straighten;

use std::time::Instant;

use enfilade_importers::{ElementId, Model, Untagged};

use assemble::Built;
use bodies::Bodies;
use cells::Partition;
use columns::{Columns, Toggles};
use faces::Triangle;
use labels::Labels;
use plan::Plan;
use stacks::Joined;

pub use bodies::NotCarved;

/// The partition could not be made; the model is to be compiled as one cell.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// Rounding did not settle, or would need more memory than allowed.
    #[error("between the heights {low} m and {high} m: {why}")]
    Slab {
        /// The slab's lower level, internal frame.
        low: f64,
        /// Its upper level.
        high: f64,
        /// What went wrong.
        why: String,
    },
}

/// What was done.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Levels at which the hull was cut, metres, internal frame.
    pub levels: Vec<f64>,
    /// Columns: triangles of all slabs' plans, before merging.
    pub columns: u64,
    /// Intervals of air over them.
    pub air_pieces: u64,
    /// Elements with components that do not carve, and why.
    pub not_carved: Vec<(ElementId, NotCarved)>,
    /// Thin air joined to rooms.
    pub joined: Vec<(ElementId, f64)>,
    /// The farthest that a point was moved in the plan, metres.
    pub largest_displacement: f64,
    /// Seconds of each stage.
    pub stages: Vec<(&'static str, f64)>,
}

/// The hull is larger than the bodies by this on all sides, metres.
const MARGIN: f64 = 1.0;

/// Cuts the space of `model` into cells.
///
/// # Errors
/// [`PartitionError`].
pub fn partition(model: &Model, untagged: Untagged) -> Result<(Partition, Report), PartitionError> {
    let mut report = Report::default();
    let mut clock = Instant::now();
    let mut lap = |report: &mut Report, name| {
        report.stages.push((name, clock.elapsed().as_secs_f64()));
        clock = Instant::now();
    };
    let mut bodies = bodies::gather(model, untagged);
    lap(&mut report, "bodies");
    let triangles = faces::lay(&mut bodies);
    let hull = hull(&bodies);
    let levels = slabs::choose_levels(&triangles, hull, &bodies.lattice);
    lap(&mut report, "faces");
    let lattice = bodies.lattice;
    report.levels = levels.iter().map(|&z| lattice.metres(2, f64::from(z))).collect();
    report.not_carved = bodies.not_carved.clone();

    let ranges: Vec<[i32; 2]> = levels.windows(2).map(|w| [w[0], w[1]]).collect();
    let fail = |levels: [i32; 2], why: String| {
        let [low, high] = levels.map(|z| lattice.metres(2, f64::from(z)));
        PartitionError::Slab { low, high, why }
    };
    let raw =
        each(ranges, |levels| raw_slab(&bodies, &triangles, levels, hull).map_err(|why| fail(levels, why)))?;
    lap(&mut report, "columns");
    let seen: Vec<(&Plan, &Columns)> = raw.iter().map(|r| (&r.plan, &r.columns)).collect();
    let labels = Labels::new(model, &bodies.bodies, &seen);
    report.columns = raw.iter().map(|r| r.plan.triangles.len() as u64).sum();
    report.largest_displacement = raw.iter().map(|r| r.displacement).fold(0.0, f64::max) * lattice.step();
    let is_room = labels.rooms();
    lap(&mut report, "labels");
    let built = each(raw, |raw| {
        let levels = raw.levels;
        merge_slab(raw, &labels, &is_room, &lattice).map_err(|why| fail(levels, why))
    })?;
    lap(&mut report, "merging");
    let mut slabs = Vec::with_capacity(built.len());
    for (slab, joined, pieces) in built {
        report.air_pieces += pieces;
        report.largest_displacement =
            report.largest_displacement.max(slab.simple.displacement * lattice.step());
        for (label, joined) in joined {
            if let cells::Label::Air(element) = label {
                report.joined.push((element, joined.volume * lattice.step().powi(3)));
            }
        }
        slabs.push(slab);
    }
    let partition = assemble::assemble(lattice, hull, &slabs, bodies.detail);
    lap(&mut report, "assembly");
    Ok((partition, report))
}

fn hull(bodies: &Bodies) -> [[i32; 3]; 2] {
    let margin = bodies.lattice.steps(MARGIN) as i32;
    let largest = crate::lattice::LARGEST;
    [
        bodies.bounds[0].map(|c| (c - margin).max(-largest)),
        bodies.bounds[1].map(|c| (c + margin).min(largest)),
    ]
}

/// On all cores, in order; the first error wins.
fn each<T: Send, U: Send, E: Send>(
    items: Vec<T>,
    work: impl Fn(T) -> Result<U, E> + Sync + Send,
) -> Result<Vec<U>, E> {
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        let all: Vec<Result<U, E>> = items.into_par_iter().with_max_len(1).map(work).collect();
        all.into_iter().collect()
    }
    #[cfg(not(feature = "rayon"))]
    items.into_iter().map(work).collect()
}

/// A slab before labels are known.
struct Raw {
    levels: [i32; 2],
    plan: Plan,
    columns: Columns,
    displacement: f64,
}

fn raw_slab(
    bodies: &Bodies,
    triangles: &[Triangle],
    levels: [i32; 2],
    hull: [[i32; 3]; 2],
) -> Result<Raw, String> {
    let mut slab = slabs::cut(triangles, levels, hull);
    slab.segments.extend(crossings::crossings(&slab, hull));
    let snapped = snap::snap(&slab.segments).map_err(|e| e.to_string())?;
    let mut toggles = Vec::with_capacity(slab.chains.len() * 2);
    for &(segment, face, times) in &slab.chains {
        for step in snapped.way(segment as usize) {
            toggles.push((step.link() as u32, face, if step.forward() { times } else { -times }));
        }
    }
    let toggles = Toggles::new(snapped.links.len(), toggles);
    let displacement = snapped.displacement;
    let plan = plan::triangulate(snapped.vertices, &snapped.links).map_err(|e| e.to_string())?;
    let columns = columns::build(&columns::Input {
        plan: &plan,
        levels,
        faces: &slab.faces,
        toggles: &toggles,
        by_winding: &|body| bodies.bodies[body as usize].by_winding,
    });
    Ok(Raw { levels, plan, columns, displacement })
}

fn merge_slab(
    raw: Raw,
    labels: &Labels,
    is_room: &(dyn Fn(cells::Label) -> bool + Sync),
    lattice: &crate::lattice::Lattice,
) -> Result<(Built, Vec<(cells::Label, Joined)>, u64), String> {
    let mut stacks = stacks::label(&raw.columns, labels, raw.plan.triangles.len());
    let joined = stacks::join_slivers(&raw.plan, &raw.columns, labels, lattice, is_room, &mut stacks);
    let is_air = |item: &stacks::Item| item.fill.is_none_or(|label| label.is_air());
    let pieces = stacks.iter().flatten().filter(|item| is_air(item)).count() as u64;
    let simple = regions::simplify(&raw.plan, stacks, lattice).map_err(|e| e.to_string())?;
    let regions = regions::unite(&simple).map_err(|e| e.to_string())?;
    Ok((Built { simple, regions, planes: raw.columns.planes }, joined, pieces))
}
