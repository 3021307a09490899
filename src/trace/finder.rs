//! Which prisms of air may hold a point: a fine grid over their zone, made when a scene is opened.
//!
//! The grid in a file is coarse, and matter is listed in it, too. Here most cubes lie within one prism or nearly so: it comes first, so that the first
//! one asked is the one in nearly all cases, which processors foresee.

use arrayvec::ArrayVec;
use bytemuck::{Pod, Zeroable};

use super::guess::{Guess, guess};
use super::lanes::Wide;
use super::step::Step;
use crate::format::records::{CellRecord, LANES, SceneRecord};

/// Cubes a prism, on the average, unless those are more than a processor's own memory holds; then fewer, but not fewer than these.
const CUBES_PER_CELL: f64 = 64.0;
const MANY_CUBES: f64 = (1 << 16) as f64;
const LEAST_PER_CELL: f64 = 4.0;

/// Cubes along an axis.
const MOST_ALONG: f64 = 1024.0;

/// A file whose prisms lie in each other, so that they are looked at in so many times all cubes, or reach into so many times all cubes, is
/// no partition, and gets no grid. A prism at a corner of cubes may always reach into eight.
const MOST_LOOKS: usize = 64;
const MOST_REACHES: usize = 8;
const ALWAYS: usize = 16;

/// Added to a number from 0 to 2^32 this leaves it, rounded, in the low bits.
const ROUND: f64 = (1u64 << 52) as f64;

/// Prisms are listed where they come as near to a cube as this share of its size, for what rounding does.
pub(super) const MARGIN: f64 = 1e-6;

/// Cubes over the zone of the prisms, along the lattice's axes, from its origin, metres.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct AirGrid {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Cubes in a metre.
    pub(super) per: [f64; 3],
    /// How many; 0 of a grid without cubes.
    dims: [u32; 3],
    /// More than rounding to f32 moves a point of the zone against a line, metres: sixteen roundings.
    pub(super) rounding: f32,
}

impl AirGrid {
    /// A cube: its least corner, and its greatest.
    pub(super) fn bounds(&self, cube: usize) -> [[f64; 3]; 2] {
        let [dx, dy, _] = self.dims.map(|dims| dims as usize);
        let place = [cube % dx, cube / dx % dy, cube / (dx * dy)];
        let corner = |by: usize| [0, 1, 2].map(|i| self.lo[i] + (place[i] + by) as f64 / self.per[i]);
        [corner(0), corner(1)]
    }

    /// Whether a point is in the zone. Written so that NaN is nowhere.
    #[inline(always)]
    pub(super) fn holds(&self, at: [f64; 3]) -> bool {
        let mut is_there = true;
        for axis in 0..3 {
            is_there &= at[axis] >= self.lo[axis] && at[axis] <= self.hi[axis];
        }
        is_there
    }

    /// The cube that holds a point of the zone, or one that it is on the border of; `None` without a grid.
    #[inline(always)]
    pub(super) fn cube(&self, at: [f64; 3]) -> Option<usize> {
        let mut index = 0;
        for axis in (0..3).rev() {
            let cube =
                (((at[axis] - self.lo[axis]) * self.per[axis] - 0.5).max(0.0) + ROUND).to_bits() as u32;
            index = index * self.dims[axis] as usize + cube.min(self.dims[axis].wrapping_sub(1)) as usize;
        }
        (self.dims[0] != 0).then_some(index)
    }

    /// The cubes of points, as [`AirGrid::cube`] tells them, and which of the points (lane i is bit i) are in the zone.
    #[inline(always)]
    pub(super) fn cubes<W: Wide>(&self, at: [W; 3]) -> ([u32; LANES], u32) {
        let (mut index, mut there) = (W::splat(0.0), (1u32 << LANES) - 1);
        for axis in (0..3).rev() {
            let (lo, hi, per) = (W::splat(self.lo[axis]), W::splat(self.hi[axis]), W::splat(self.per[axis]));
            there &= lo.le(at[axis]) & at[axis].le(hi);
            let along = at[axis].sub(lo).mul(per).sub(W::splat(0.5)).max(W::splat(0.0));
            // Whole numbers, and so are their products: exact.
            let cube = along.add(W::splat(ROUND)).sub(W::splat(ROUND));
            let dims = f64::from(self.dims[axis]);
            index = index.mul(W::splat(dims)).add(cube.min(W::splat(dims - 1.0)));
        }
        let bits = index.add(W::splat(ROUND)).store();
        let mut index = [0; LANES];
        for (to, bits) in index.iter_mut().zip(bits) {
            *to = bits.to_bits() as u32;
        }
        (index, there)
    }
}

/// The prisms of air by the cubes that they reach into: those first that have the most of a cube.
pub(crate) struct Finder {
    pub(crate) grid: AirGrid,
    pub(crate) cells: Vec<u32>,
    /// For each cube (x fastest) which of its prisms it is for most points, and where they are listed; then the end of the last.
    pub(crate) guesses: Vec<Guess>,
}

/// A prism that reaches into a cube.
struct Reach {
    cube: u32,
    cell: u32,
    /// The volume that its box and the cube have in common.
    common: f64,
}

impl Finder {
    /// For the cells of a scene, whose zone is a box.
    pub(crate) fn new(scene: &SceneRecord, cells: &[CellRecord], steps: &[Step]) -> Finder {
        let is_air = |cell: &CellRecord| cell.kind == CellRecord::AIR;
        let air: Vec<u32> =
            (0..).zip(cells).filter(|(_, cell)| is_air(cell)).map(|(number, _)| number).collect();
        let [lo, hi] = scene.zone;
        let size = [0, 1, 2].map(|axis| hi[axis] - lo[axis]);
        let count = air.len() as f64;
        let dims = divide(size, (count * CUBES_PER_CELL).min(MANY_CUBES.max(count * LEAST_PER_CELL)));
        let reach = lo.iter().chain(&hi).fold(0.0f64, |reach, c| reach.max(c.abs()));
        let rounding = (reach * (-20f64).exp2()) as f32;
        let mut grid = AirGrid { lo, hi, rounding, ..AirGrid::zeroed() };
        let none = Finder { grid, cells: Vec::new(), guesses: vec![Guess::NOWHERE] };
        let Some(dims) = dims.filter(|_| !air.is_empty()) else { return none };
        grid.dims = dims;
        grid.per = [0, 1, 2].map(|axis| f64::from(grid.dims[axis]) / size[axis]);
        let count: usize = grid.dims.iter().map(|&cubes| cubes as usize).product();
        let mut reaches = Vec::new();
        let mut looks = MOST_LOOKS * count + ALWAYS * air.len();
        let most = MOST_REACHES * count + ALWAYS * air.len();
        for &cell in &air {
            let mut tell = |cube, common| {
                reaches.push(Reach { cube, cell, common });
                (reaches.len() <= most).then_some(())
            };
            if list(&grid, &cells[cell as usize], &steps[cell as usize], &mut looks, &mut tell).is_none() {
                return none;
            }
        }
        let mut starts = vec![0u32; count + 1];
        for reach in &reaches {
            starts[reach.cube as usize + 1] += 1;
        }
        for cube in 0..count {
            starts[cube + 1] += starts[cube];
        }
        let by_size = |a: &Reach, b: &Reach| b.common.total_cmp(&a.common);
        reaches.sort_unstable_by(|a, b| a.cube.cmp(&b.cube).then(by_size(a, b)).then(a.cell.cmp(&b.cell)));
        let found: Vec<u32> = reaches.iter().map(|reach| reach.cell).collect();
        let cubes = starts.windows(2).map(|ends| &found[ends[0] as usize..ends[1] as usize]);
        let guesses = (0..).zip(cubes).map(|(cube, found)| guess(&grid, cube, found, cells, steps));
        let guesses = guesses.chain([Guess::NOWHERE]).zip(&starts);
        let guesses = guesses.map(|(guess, &start)| guess.with_start(start)).collect();
        Finder { grid, cells: found, guesses }
    }
}

/// Into how many cubes a box is cut along each axis, `cubes` at most in all, about as high as wide; `None` of what is no box.
fn divide(size: [f64; 3], cubes: f64) -> Option<[u32; 3]> {
    let mut dims = [1u32; 3];
    // Axes along which it is thinner than a cube are not cut.
    let mut axes: ArrayVec<usize, 3> = (0..3).collect();
    while !axes.is_empty() {
        let volume: f64 = axes.iter().map(|&axis| size[axis]).product();
        let edge = (volume / cubes).powf(1.0 / axes.len() as f64);
        // Also where so small a box has no volume that a number tells.
        if !(edge.is_finite() && edge > 0.0) {
            return None;
        }
        let before = axes.len();
        axes.retain(|axis| size[*axis] > edge);
        if axes.len() == before {
            for &axis in &axes {
                dims[axis] = (size[axis] / edge).floor().clamp(1.0, MOST_ALONG) as u32;
            }
            break;
        }
    }
    Some(dims)
}

/// Tells the cubes that a prism reaches into, and what of each it has; `None` if it has to look at more than `looks` for that, or is
/// told to stop.
fn list(
    grid: &AirGrid,
    cell: &CellRecord,
    step: &Step,
    looks: &mut usize,
    tell: &mut impl FnMut(u32, f64) -> Option<()>,
) -> Option<()> {
    let [lo, hi] = cell.bounds;
    let cube = |axis: usize, c: f64| {
        let most = f64::from(grid.dims[axis] - 1);
        ((c - grid.lo[axis]) * grid.per[axis]).floor().clamp(0.0, most) as u32
    };
    let [xs, ys, zs] = [0, 1, 2].map(|axis| {
        let margin = MARGIN / grid.per[axis];
        cube(axis, lo[axis] - margin)..=cube(axis, hi[axis] + margin)
    });
    // What the box and a cube have in common along an axis.
    let common = |axis: usize, cube: u32| {
        let start = grid.lo[axis] + f64::from(cube) / grid.per[axis];
        (hi[axis].min(start + 1.0 / grid.per[axis]) - lo[axis].max(start)).max(0.0)
    };
    for y in ys {
        for x in xs.clone() {
            *looks = looks.checked_sub(1 + zs.clone().count())?;
            if step.is_some() && !reaches(grid, step, [x, y]) {
                continue;
            }
            let plan = common(0, x) * common(1, y);
            for z in zs.clone() {
                tell((z * grid.dims[1] + y) * grid.dims[0] + x, plan * common(2, z))?;
            }
        }
    }
    Some(())
}

/// Whether a footprint reaches into the cubes of a place in the plan: never wrongly no.
fn reaches(grid: &AirGrid, step: &Step, cube: [u32; 2]) -> bool {
    let half = [0, 1].map(|axis| (0.5 + MARGIN) / grid.per[axis]);
    let middle = [0, 1].map(|axis| grid.lo[axis] + (f64::from(cube[axis]) + 0.5) / grid.per[axis]);
    let corners = usize::from(step.corners);
    (0..corners).all(|corner| {
        let next = (corner + 1) % corners;
        let [ax, ay] = [f64::from(step.x[corner]), f64::from(step.y[corner])];
        let (ex, ey) = (f64::from(step.x[next]) - ax, f64::from(step.y[next]) - ay);
        let inward = ex * (middle[1] - ay) - ey * (middle[0] - ax);
        inward >= -(ex.abs() * half[1] + ey.abs() * half[0])
    })
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::samples::Sample;
    use crate::splitmix::SplitMix64;

    #[test]
    fn cubes_name_the_cells_of_their_points_and_mostly_first() {
        let scene = Sample::Random(3).scene();
        let tables = &scene.tables;
        let finder = Finder::new(&tables.scene[0], &tables.cells, &tables.steps);
        let [lo, hi] = tables.scene[0].zone;
        let mut random = SplitMix64::new(1);
        let (mut first, mut found) = (0, 0);
        for _ in 0..50_000 {
            let at = [0, 1, 2].map(|axis| random.between(lo[axis], hi[axis]));
            let cube = finder.grid.cube(at).unwrap();
            let [from, to] = [cube, cube + 1].map(|cube| finder.guesses[cube].start as usize);
            let listed = &finder.cells[from..to];
            let holds = (0..tables.cells.len() as u32).filter(|&cell| {
                let record = &tables.cells[cell as usize];
                record.kind == CellRecord::AIR
                    && super::super::Prisms::new(tables).nearly_holds(record, at.into(), -1e-3)
            });
            for cell in holds {
                assert!(listed.contains(&cell), "{at:?} in {cell}, not among {listed:?}");
                found += 1;
                first += u32::from(listed[0] == cell);
            }
        }
        assert!(found > 30_000 && f64::from(first) > 0.75 * f64::from(found), "{first} of {found}");
        for out in [lo.map(|c| c - 1e-9), hi.map(|c| c + 1e-9), [f64::NAN; 3], [f64::INFINITY; 3]] {
            assert!(!finder.grid.holds(out));
        }
        assert!(finder.grid.holds(lo) && finder.grid.holds(hi));
        assert!(finder.grid.cube(lo).is_some() && finder.grid.cube(hi).is_some());
    }

    #[test]
    fn boxes_are_cut_into_no_more_cubes_than_asked_for() {
        let sizes = [0.0, 1e-300, 1e-6, 0.1, 3.0, 500.0, 1e5, 1e300];
        for (x, y, z) in (0..512).map(|i| (sizes[i % 8], sizes[i / 8 % 8], sizes[i / 64])) {
            for cubes in [1.0, 64.0, 65536.0, 4e6] {
                let Some(dims) = divide([x, y, z], cubes) else { continue };
                let count: f64 = dims.iter().map(|&cubes| f64::from(cubes)).product();
                assert!((1.0..=cubes).contains(&count), "{x} {y} {z}: {dims:?} for {cubes}");
            }
        }
        assert_eq!(divide([10.0, 5.0, 0.001], 800.0), Some([40, 20, 1]));
        assert_eq!(divide([4.0, 4.0, 4.0], 64.0), Some([4; 3]));
        assert_eq!(divide([f64::NAN, 1.0, 1.0], 64.0), None);
    }

    #[test]
    fn prisms_that_lie_in_each_other_get_no_grid() {
        let zone = [[0.0; 3], [500.0, 500.0, 1e-6]];
        let scene = SceneRecord { zone, ..SceneRecord::zeroed() };
        let cell = CellRecord {
            kind: CellRecord::AIR,
            flags: CellRecord::FREE,
            bounds: zone,
            ..CellRecord::zeroed()
        };
        let of = |count: usize| Finder::new(&scene, &vec![cell; count], &vec![Step::NONE; count]);
        let few = of(4);
        assert!(few.guesses.len() > 100 && few.cells.len() == 4 * (few.guesses.len() - 1));
        let many = of(32);
        assert_eq!((many.guesses.len(), many.cells.len()), (1, 0));
    }
}
