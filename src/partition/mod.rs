//! The partition of space into labelled convex prisms.
//!
//! `docs/PARTITION.md` tells the method. In short: the hull is cut at a few levels into *slabs*; in each slab the edges
//! of all faces that are not vertical are projected to the plan and rounded until nothing crosses ([`snap`]); over each
//! triangle of the plan the faces stand in order of height: a *column* with a stack of intervals; columns merge into
//! *cells*: prisms with a convex footprint, one floor plane and one ceiling plane.

mod account;
mod assemble;
pub mod audit;
mod bodies;
mod boxes;
pub mod cells;
mod check;
mod columns;
pub mod convex;
mod crossings;
mod direction;
mod faces;
pub mod figure;
mod halfspaces;
mod labels;
pub mod matter;
mod mend;
mod moved;
mod overlap;
mod plan;
mod regions;
mod report;
mod shapes;
mod slabs;
pub mod snap;
mod stacks;
pub(crate) mod storeys;
pub mod straighten;
pub mod surfaces;
#[cfg(test)]
pub(crate) mod testing;
mod unkink;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use enfilade_importers::{Cancelled, ElementId, Limits, Model, Untagged, Watch};

use account::{Account, Full};
use assemble::Built;
use audit::AuditOptions;
use bodies::{Bodies, Body};
use cells::Partition;
use columns::{Columns, Toggles};
use faces::Triangle;
use labels::Labels;
use matter::MatterTriangle;
use moved::Moved;
use plan::Plan;
use stacks::Joined;
use surfaces::SurfaceOptions;

use crate::parallel;

pub use bodies::NotCarved;
pub(crate) use check::{check_frame, check_triangles};
pub use convex::Convexification;
pub use moved::Repair;
pub use report::{PartitionReport, VoidPlace, kind, six_volume};

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
    /// More memory would be needed than allowed.
    #[error("cells would need more memory than the limit of {0} bytes (raise --max-memory)")]
    TooLarge(u64),
    /// Cancelled through its token.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// How to cut.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct PartitionOptions {
    /// What to make of elements without a tag.
    pub untagged: Untagged,
    /// How what is not convex is cut.
    pub convexification: Convexification,
    /// What it may cost, beside the model itself.
    pub limits: Limits,
    /// Progress and cancellation.
    pub watch: Watch,
}

impl PartitionOptions {
    /// The default, but for what is made of elements without a tag.
    pub fn with_untagged(mut self, untagged: Untagged) -> PartitionOptions {
        self.untagged = untagged;
        self
    }

    /// The default, but for how what is not convex is cut.
    pub fn with_convexification(mut self, how: Convexification) -> PartitionOptions {
        self.convexification = how;
        self
    }

    /// The default, but for what it may cost.
    pub fn with_limits(mut self, limits: Limits) -> PartitionOptions {
        self.limits = limits;
        self
    }

    /// The default, but watched.
    pub fn with_watch(mut self, watch: Watch) -> PartitionOptions {
        self.watch = watch;
        self
    }
}

/// The hull is larger than the bodies by this on all sides, metres.
const MARGIN: f64 = 1.0;

/// Cuts the space of `model` into cells.
///
/// # Errors
/// [`PartitionError`].
pub fn partition(
    model: &Model,
    options: &PartitionOptions,
) -> Result<(Partition, PartitionReport), PartitionError> {
    let (untagged, watch) = (options.untagged, &options.watch);
    let account = Account::new(options.limits.max_memory);
    let mut report = PartitionReport::default();
    let mut clock = Instant::now();
    let mut lap = |report: &mut PartitionReport, name| -> Result<(), PartitionError> {
        report.stages.push((name, clock.elapsed().as_secs_f64()));
        watch.report(name, 1.0);
        clock = Instant::now();
        if account.is_full() {
            Err(PartitionError::TooLarge(options.limits.max_memory))
        } else {
            Ok(watch.check()?)
        }
    };
    let mut bodies = bodies::gather(model, untagged);
    lap(&mut report, "bodies")?;
    let triangles = faces::lay(&mut bodies);
    let hull = hull(&bodies);
    let levels = slabs::choose_levels(&triangles, hull, &bodies.lattice);
    report.repairs = moved::of_faces(&bodies, &triangles);
    lap(&mut report, "faces")?;
    let lattice = bodies.lattice;
    report.levels = levels.iter().map(|&z| lattice.height(f64::from(z))).collect();
    for (element, why) in &bodies.not_carved {
        *report.not_carved.entry(*why).or_default() += 1;
        report.not_carved_elements.push((model.elements[element.0 as usize].path.clone(), *why));
    }
    report.carved = bodies.bodies.iter().filter(|body| body.is_solid).count() as u64;

    let ranges: Vec<[i32; 2]> = levels.windows(2).map(|w| [w[0], w[1]]).collect();
    let fail = |levels: [i32; 2], why: Failed| match why {
        Failed::Full => PartitionError::TooLarge(options.limits.max_memory),
        Failed::Because(why) => {
            let [low, high] = levels.map(|z| lattice.height(f64::from(z)));
            PartitionError::Slab { low, high, why }
        }
    };
    let raw = each(ranges, |levels| {
        watch.check()?;
        raw_slab(&bodies, &triangles, levels, hull, &[], &account).map_err(|why| fail(levels, why))
    })?;
    lap(&mut report, "columns")?;
    let seen: Vec<(&Plan, &Columns)> = raw.iter().map(|r| (&r.plan, &r.columns)).collect();
    let labels = Labels::new(model, &bodies.bodies, &seen);
    report.columns = raw.iter().map(|r| r.plan.triangles.len() as u64).sum();
    let (mut rounded, mut straightened, mut unkinked) =
        (Moved::default(), Moved::default(), Moved::default());
    raw.iter().for_each(|r| rounded.join(r.rounded));
    let is_room = labels.rooms();
    lap(&mut report, "labels")?;
    let built = each(raw, |raw| {
        let levels = raw.levels;
        watch.check()?;
        merge_slab(raw, &labels, &is_room, &lattice, options.convexification)
            .map_err(|why| fail(levels, Failed::Because(why)))
    })?;
    lap(&mut report, "merging")?;
    let mut slabs = Vec::with_capacity(built.len());
    let mut slivers: BTreeMap<ElementId, f64> = BTreeMap::new();
    for merged in built {
        for (fill, count) in merged.pieces {
            let kind = fill.map_or("unlabelled", |label| kind(label, model));
            *report.pieces.entry(kind).or_default() += count;
        }
        straightened.join(merged.slab.simple.straightened);
        unkinked.join(merged.unkinked);
        report.largest_displacement = report.largest_displacement.max(merged.displacement * lattice.step());
        for (label, joined) in merged.joined {
            if let cells::Label::Air(element) = label {
                *slivers.entry(element).or_default() += joined.volume * lattice.step().powi(3);
            }
        }
        slabs.push(merged.slab);
    }
    report.repairs.extend([
        rounded.repair("edges led around points, where crossings were rounded", &lattice),
        straightened.repair("points left out of edges that are nearly straight", &lattice),
        unkinked.repair("points moved so that air is convex", &lattice),
    ]);
    report.slivers_volume = slivers.values().sum();
    let path = |element: ElementId| model.elements[element.0 as usize].path.clone();
    report.slivers = slivers.into_iter().map(|(element, volume)| (path(element), volume)).collect();
    let mut partition = assemble::assemble(lattice, hull, &slabs, std::mem::take(&mut bodies.detail));
    lap(&mut report, "assembly")?;
    let matter = matter(&bodies);
    report.surfaces = surfaces::attach(&mut partition, &matter, &SurfaceOptions::default(), &account, watch);
    // Not before: matter given back to the air may have shut air off.
    assemble::tell_exterior(&mut partition);
    lap(&mut report, "surfaces")?;
    report.audit = audit::audit(&mut partition, &matter, &AuditOptions::default(), watch);
    lap(&mut report, "audit")?;
    report.read(&partition, model);
    report.share(&partition, model, untagged);
    Ok((partition, report))
}

/// The triangles of the bodies that carve.
fn matter(bodies: &Bodies) -> Vec<MatterTriangle> {
    let solid = bodies.bodies.iter().filter(|body| body.is_solid);
    let of = |body: &Body| -> Vec<MatterTriangle> {
        let triangle = |t: &bodies::Corner3| MatterTriangle {
            corners: t.corners.map(|v| body.exact[v as usize]),
            element: body.element,
            triangle: t.source,
        };
        body.triangles.iter().map(triangle).collect()
    };
    solid.flat_map(of).chain(bodies.inner.iter().copied()).collect()
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
    work: impl Fn(T) -> Result<U, E> + Sync,
) -> Result<Vec<U>, E> {
    let items: Vec<Mutex<Option<T>>> = items.into_iter().map(|item| Mutex::new(Some(item))).collect();
    let all = parallel::map(items.len(), |i| {
        let item = items[i].lock().unwrap_or_else(PoisonError::into_inner).take();
        work(item.unwrap_or_else(|| unreachable!("each is taken once")))
    });
    all.into_iter().collect()
}

/// A slab before labels are known.
struct Raw {
    levels: [i32; 2],
    plan: Plan,
    columns: Columns,
    rounded: Moved,
}

/// Why there are no columns.
enum Failed {
    /// They take more memory than there is.
    Full,
    /// Something else.
    Because(String),
}

impl From<Full> for Failed {
    fn from(_: Full) -> Failed {
        Failed::Full
    }
}

fn raw_slab(
    bodies: &Bodies,
    triangles: &[Triangle],
    levels: [i32; 2],
    hull: [[i32; 3]; 2],
    lines: &[[crate::lattice::Point; 2]],
    account: &Account,
) -> Result<Raw, Failed> {
    let mut slab = slabs::cut(triangles, levels, hull);
    slab.segments.extend_from_slice(lines);
    account.take(slab.segments.len() + slab.chains.len() + slab.pieces.len(), 64)?;
    slab.segments.extend(crossings::crossings(&slab, hull, account)?);
    let snapped = snap::snap(&slab.segments).map_err(|e| Failed::Because(e.to_string()))?;
    // The plan, its triangles (twice as many as points) and what merging makes of them.
    account.take(snapped.vertices.len() + snapped.links.len(), 512)?;
    let mut toggles = Vec::with_capacity(slab.chains.len() * 2);
    for &(segment, face, times) in &slab.chains {
        for step in snapped.way(segment as usize) {
            toggles.push((step.link() as u32, face, if step.forward() { times } else { -times }));
        }
    }
    let toggles = Toggles::new(snapped.links.len(), toggles);
    let rounded = Moved { count: snapped.rerouted as u64, farthest: snapped.displacement };
    let plan =
        plan::triangulate(snapped.vertices, &snapped.links).map_err(|e| Failed::Because(e.to_string()))?;
    let input = columns::Input {
        plan: &plan,
        levels,
        faces: &slab.faces,
        toggles: &toggles,
        by_winding: &|body| bodies.bodies[body as usize].by_winding,
    };
    let columns = columns::build(&input, account)?;
    Ok(Raw { levels, plan, columns, rounded })
}

/// A slab cut into prisms, and what was done to it.
struct Merged {
    slab: Built,
    /// No edge was moved farther in the plan, lattice units: by rounding, and then by what makes it straight.
    displacement: f64,
    /// Thin air joined to rooms.
    joined: Vec<(cells::Label, Joined)>,
    /// Intervals over the triangles of the plan before merging, by what fills them.
    pieces: BTreeMap<Option<cells::Label>, u64>,
    unkinked: Moved,
}

fn merge_slab(
    raw: Raw,
    labels: &Labels,
    is_room: &(dyn Fn(cells::Label) -> bool + Sync),
    lattice: &crate::lattice::Lattice,
    how: Convexification,
) -> Result<Merged, String> {
    let mut stacks = stacks::label(&raw.columns, labels, raw.plan.triangles.len());
    let joined = stacks::join_slivers(&raw.plan, &raw.columns, labels, lattice, is_room, &mut stacks);
    let mut pieces = BTreeMap::new();
    for item in stacks.iter().flatten() {
        *pieces.entry(item.fill).or_default() += 1;
    }
    let mut simple = regions::simplify(&raw.plan, stacks, lattice).map_err(|e| e.to_string())?;
    let unkinked = unkink::unkink(&mut simple);
    let displacement = raw.rounded.farthest + simple.straightened.farthest + unkinked.farthest;
    let regions = regions::unite(&mut simple, how).map_err(|e| e.to_string())?;
    let slab = Built { simple, regions, planes: raw.columns.planes };
    Ok(Merged { slab, displacement, joined, pieces, unkinked })
}
