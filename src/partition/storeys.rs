//! The space between some levels as columns, before anything is labelled or merged: for those who look for rooms.

use enfilade_importers::{ElementId, Model};

use super::account::Account;
use super::{Failed, PartitionError, PartitionOptions, bodies, each, faces, hull, raw_slab};
use crate::lattice::{Lattice, Plane, Point};

/// No triangle of the plan.
pub(crate) const NONE: u32 = super::plan::NONE;

/// What one triangle of a plan has over it between two planes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Layer {
    /// The plane below.
    pub(crate) floor: Plane,
    /// The plane above.
    pub(crate) ceiling: Plane,
    /// Index in [`Storey::sets`].
    pub(crate) set: u32,
}

/// The space between two levels.
#[derive(Clone, Debug)]
pub(crate) struct Storey {
    /// The two levels, lattice units.
    pub(crate) levels: [i32; 2],
    /// Points of the plan.
    pub(crate) points: Vec<Point>,
    /// Triangles of the plan: corners, counter-clockwise. They fill the hull.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The triangle beyond the edge from corner i to the next; [`NONE`] beyond the hull.
    pub(crate) across: Vec<[u32; 3]>,
    /// Where the layers over each triangle start; one more at the end.
    pub(crate) starts: Vec<u32>,
    /// From the bottom up.
    pub(crate) layers: Vec<Layer>,
    /// Sets of elements that a layer may lie within, ascending.
    pub(crate) sets: Vec<Vec<ElementId>>,
}

/// The space of a model between levels.
#[derive(Clone, Debug)]
pub(crate) struct Storeys {
    pub(crate) lattice: Lattice,
    /// From the lowest up.
    pub(crate) storeys: Vec<Storey>,
}

impl Storeys {
    /// The levels between which the storeys lie, metres, internal frame, ascending.
    pub(crate) fn levels(&self) -> Vec<f64> {
        let lows = self.storeys.iter().map(|storey| storey.levels[0]);
        let levels = lows.chain(self.storeys.last().map(|storey| storey.levels[1]));
        levels.map(|z| self.lattice.height(f64::from(z))).collect()
    }
}

impl Storey {
    pub(crate) fn stack(&self, triangle: u32) -> &[Layer] {
        &self.layers[self.starts[triangle as usize] as usize..self.starts[triangle as usize + 1] as usize]
    }

    pub(crate) fn corners(&self, triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }
}

/// The space of `model` between each two of `levels` (metres, internal frame, ascending): what carves, and air labels, by the rules of the
/// partition. `lines`, by storey, are edges of its plan, too; lattice units.
///
/// # Errors
/// [`PartitionError`].
pub(crate) fn storeys(
    model: &Model,
    levels: &[f64],
    lines: &[Vec<[Point; 2]>],
    options: &PartitionOptions,
) -> Result<Storeys, PartitionError> {
    let (limits, watch) = (&options.limits, &options.watch);
    let account = Account::new(limits.max_memory);
    let mut bodies = bodies::gather(model, options.untagged);
    let triangles = faces::lay(&mut bodies);
    let hull = hull(&bodies);
    let lattice = bodies.lattice;
    let level = |z: &f64| {
        let z = lattice.local([lattice.origin[0], lattice.origin[1], *z])[2].round();
        z.clamp(f64::from(hull[0][2]), f64::from(hull[1][2])) as i32
    };
    let mut levels: Vec<i32> = levels.iter().map(level).collect();
    levels.dedup();
    let ranges: Vec<([i32; 2], &[[Point; 2]])> = levels
        .windows(2)
        .enumerate()
        .map(|(i, w)| ([w[0], w[1]], lines.get(i).map_or(&[][..], Vec::as_slice)))
        .collect();
    let storeys = each(ranges, |(levels, lines)| {
        watch.check()?;
        let raw = raw_slab(&bodies, &triangles, levels, hull, lines, &account).map_err(|why| match why {
            Failed::Full => PartitionError::TooLarge(limits.max_memory),
            Failed::Because(why) => {
                let [low, high] = levels.map(|z| lattice.height(f64::from(z)));
                PartitionError::Slab { low, high, why }
            }
        })?;
        let of = |set: &Vec<u32>| {
            let mut elements: Vec<ElementId> =
                set.iter().map(|&b| bodies.bodies[b as usize].element).collect();
            elements.dedup();
            elements
        };
        let plane = |index: u32| raw.columns.planes[index as usize];
        let layer = |interval: &super::columns::Interval| Layer {
            floor: plane(interval.floor),
            ceiling: plane(interval.ceiling),
            set: interval.set,
        };
        Ok::<_, PartitionError>(Storey {
            levels,
            layers: raw.columns.intervals.iter().map(layer).collect(),
            sets: raw.columns.sets.iter().map(of).collect(),
            starts: raw.columns.starts,
            points: raw.plan.points,
            triangles: raw.plan.triangles,
            across: raw.plan.across,
        })
    })?;
    Ok(Storeys { lattice, storeys })
}
