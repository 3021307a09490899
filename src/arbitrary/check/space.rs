//! Looking at a partition's cells.

use crate::lattice::{FINE, Plane, Point, orient};
use crate::partition::cells::{Cell, Face, Partition, Section};

/// Something that should not be so.
#[derive(Clone, Debug)]
pub struct Finding {
    /// What kind of thing, in a word or two: always the same for the same.
    pub kind: &'static str,
    /// What and where.
    pub text: String,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}: {}", self.kind, self.text)
    }
}

/// Takes note of a kind of finding, and of what and where it is.
pub(super) type Find<'a> = &'a mut dyn FnMut(&'static str, String);

/// A partition with its footprints at hand.
#[derive(Clone, Debug)]
pub struct Space<'a> {
    /// The partition.
    pub partition: &'a Partition,
    /// By cell: the corners of its footprint, lattice units.
    pub footprints: Vec<Vec<Point>>,
}

impl<'a> Space<'a> {
    /// That of `partition`.
    ///
    /// # Panics
    /// If an index in it is not there: [`Partition::check`] tells.
    pub fn new(partition: &'a Partition) -> Space<'a> {
        let footprints = partition.cells.iter().map(|cell| partition.footprint(cell).collect()).collect();
        Space { partition, footprints }
    }

    /// The plane of that index.
    pub fn plane(&self, index: u32) -> &'a Plane {
        &self.partition.planes[index as usize]
    }

    /// The cell of that index.
    pub fn cell(&self, index: usize) -> &'a Cell {
        &self.partition.cells[index]
    }

    /// A cell's sides, counter-clockwise.
    pub fn sections(&self, cell: &Cell) -> &'a [Section] {
        &self.partition.sections[cell.sections.start as usize..cell.sections.end as usize]
    }

    /// The faces of a side, from its foot to its head.
    pub fn faces(&self, section: &Section) -> &'a [Face] {
        &self.partition.faces[section.faces.start as usize..section.faces.end as usize]
    }

    /// The cells below a cell's floor.
    pub fn below(&self, cell: &Cell) -> impl Iterator<Item = u32> + 'a {
        self.covers(cell.below.clone())
    }

    /// The cells above a cell's ceiling.
    pub fn above(&self, cell: &Cell) -> impl Iterator<Item = u32> + 'a {
        self.covers(cell.above.clone())
    }

    fn covers(&self, range: std::ops::Range<u32>) -> impl Iterator<Item = u32> + 'a {
        self.partition.covers[range.start as usize..range.end as usize].iter().map(|cover| cover.cell)
    }

    /// Six times a cell's volume, in [`FINE`] parts of a cubic lattice unit: exactly.
    pub fn six_volumes(&self, cell: usize) -> i128 {
        let footprint = &self.footprints[cell];
        let cell = self.cell(cell);
        (1..footprint.len() - 1)
            .map(|i| {
                let corners = [footprint[0], footprint[i], footprint[i + 1]];
                let heights: i128 = corners.iter().map(|&c| self.height(cell, c)).sum();
                i128::from(orient(corners[0], corners[1], corners[2])) * heights
            })
            .sum()
    }

    /// From floor to ceiling over a point, in [`FINE`] parts.
    pub fn height(&self, cell: &Cell, at: Point) -> i128 {
        i128::from(self.plane(cell.ceiling).height(at)) - i128::from(self.plane(cell.floor).height(at))
    }

    /// A cell's volume, m3.
    pub fn volume(&self, cell: usize) -> f64 {
        self.six_volumes(cell) as f64 / 6.0 / FINE as f64 * self.partition.lattice.step().powi(3)
    }

    /// How far inside of a cell a point lies, lattice units: the distance to the nearest of the planes that bound it,
    /// less than nothing outside.
    pub fn depth(&self, cell: usize, p: [f64; 3]) -> f64 {
        let footprint = &self.footprints[cell];
        let mut depth = f64::INFINITY;
        for i in 0..footprint.len() {
            let (a, b) = (footprint[i], footprint[(i + 1) % footprint.len()]);
            let (dx, dy) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
            let side = dx * (p[1] - f64::from(a.y)) - dy * (p[0] - f64::from(a.x));
            depth = depth.min(side / dx.hypot(dy));
            if depth < -100.0 {
                return depth;
            }
        }
        let cell = self.cell(cell);
        let over = |plane: &Plane| (p[2] - plane.height_f64(p[0], p[1])) * cosine(plane);
        depth.min(over(self.plane(cell.floor))).min(-over(self.plane(cell.ceiling)))
    }

    /// How far inside of the hull a point lies, lattice units; less than nothing outside.
    pub fn depth_in_hull(&self, p: [f64; 3]) -> f64 {
        let [lo, hi] = self.partition.hull.map(|end| end.map(f64::from));
        (0..3).map(|i| (p[i] - lo[i]).min(hi[i] - p[i])).fold(f64::INFINITY, f64::min)
    }

    /// A point of the model in lattice units.
    pub fn local(&self, p: [f64; 3]) -> [f64; 3] {
        self.partition.lattice.local(p)
    }
}

/// Of the angle between a plane and the plan.
pub fn cosine(plane: &Plane) -> f64 {
    let (p, q) = (plane.p as f64 / FINE as f64, plane.q as f64 / FINE as f64);
    1.0 / (1.0 + p * p + q * q).sqrt()
}
