//! Which prisms of air may hold a point: a fine grid over their zone, made when a scene is opened.
//!
//! The grid in a file is coarse, and names matter too. Here most cubes lie within one prism or nearly so: it comes first, so that the first
//! one asked is the one in nearly all cases, which processors foresee.

use bytemuck::{Pod, Zeroable};

use crate::format::records::{CellRecord, SceneRecord};

use super::step::Step;

/// Cubes a prism, on the average; in all.
const CUBES_PER_CELL: f64 = 64.0;
const MOST_CUBES: f64 = (1 << 16) as f64;

/// Cubes along an axis.
const MOST_ALONG: f64 = 1024.0;

/// A file whose prisms lie in each other, so that they are looked at in more cubes than so many times all there are, is no partition, and
/// gets no grid.
const MOST_LOOKS: usize = 64;

/// Prisms are listed where they come as near to a cube as this share of its size, for what rounding does.
const MARGIN: f64 = 1e-6;

/// Cubes over the zone of the prisms, along the lattice's axes, from its origin, metres.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FreeGrid {
    lo: [f64; 3],
    hi: [f64; 3],
    /// Cubes in a metre.
    per: [f64; 3],
    /// How many; 0 of a grid without cubes.
    dims: [u32; 3],
    /// Zero.
    reserved: u32,
}

impl FreeGrid {
    /// The cube that holds a point, or one that it is on the border of; `None` out of the zone.
    #[inline(always)]
    pub(super) fn cube(&self, at: [f64; 3]) -> Option<usize> {
        /// Added to a number from 0 to 2^32 this leaves it, rounded, in the low bits.
        const ROUND: f64 = (1u64 << 52) as f64;
        let mut index = 0;
        let mut is_there = self.dims[0] != 0;
        for axis in (0..3).rev() {
            // Written so that NaN is nowhere.
            is_there &= at[axis] >= self.lo[axis] && at[axis] <= self.hi[axis];
            let cube =
                (((at[axis] - self.lo[axis]) * self.per[axis] - 0.5).max(0.0) + ROUND).to_bits() as u32;
            index = index * self.dims[axis] as usize + cube.min(self.dims[axis].wrapping_sub(1)) as usize;
        }
        is_there.then_some(index)
    }
}

/// The prisms of air without a closed solid in them, by the cubes that they reach into: those first that have the most of a cube.
pub(crate) struct Finder {
    pub(crate) grid: FreeGrid,
    /// For each cube (x fastest) the first of its prisms, and the end of the last.
    pub(crate) starts: Vec<u32>,
    pub(crate) cells: Vec<u32>,
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
        let is_free = |cell: &CellRecord| cell.kind == CellRecord::AIR && cell.flags == CellRecord::FREE;
        let free: Vec<u32> =
            (0..).zip(cells).filter(|(_, cell)| is_free(cell)).map(|(number, _)| number).collect();
        let [lo, hi] = scene.zone;
        let size = [0, 1, 2].map(|axis| hi[axis] - lo[axis]);
        let cubes = (free.len() as f64 * CUBES_PER_CELL).min(MOST_CUBES);
        let edge = (size.iter().product::<f64>() / cubes).cbrt();
        let mut grid = FreeGrid { lo, hi, ..FreeGrid::zeroed() };
        if free.is_empty() || !(edge.is_finite() && edge > 0.0) {
            return Finder { grid, starts: vec![0], cells: Vec::new() };
        }
        grid.dims = size.map(|size| (size / edge).round().clamp(1.0, MOST_ALONG) as u32);
        grid.per = [0, 1, 2].map(|axis| f64::from(grid.dims[axis]) / size[axis]);
        let count: usize = grid.dims.iter().map(|&cubes| cubes as usize).product();
        let mut reaches = Vec::new();
        let mut looks = MOST_LOOKS * count;
        for &cell in &free {
            let mut tell = |cube, common| reaches.push(Reach { cube, cell, common });
            if list(&grid, &cells[cell as usize], &steps[cell as usize], &mut looks, &mut tell).is_none() {
                grid.dims = [0; 3];
                return Finder { grid, starts: vec![0], cells: Vec::new() };
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
        Finder { grid, starts, cells: reaches.iter().map(|reach| reach.cell).collect() }
    }
}

/// Tells the cubes that a prism reaches into, and what of each it has; `None` if it has to look at more than `looks` for that.
fn list(
    grid: &FreeGrid,
    cell: &CellRecord,
    step: &Step,
    looks: &mut usize,
    tell: &mut impl FnMut(u32, f64),
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
                tell((z * grid.dims[1] + y) * grid.dims[0] + x, plan * common(2, z));
            }
        }
    }
    Some(())
}

/// Whether a footprint reaches into the cubes of a place in the plan: never wrongly no.
fn reaches(grid: &FreeGrid, step: &Step, cube: [u32; 2]) -> bool {
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
    use crate::generate::{OfficeOptions, Style, random};
    use crate::splitmix::SplitMix64;
    use crate::{CompileOptions, compile};

    #[test]
    fn cubes_name_the_cells_of_their_points_and_mostly_first() {
        let building = random(&OfficeOptions { seed: 3, ..OfficeOptions::default() });
        let model = building.export(&Style::exact()).to_model().unwrap();
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        let tables = &scene.tables;
        let finder = Finder::new(&tables.scene[0], &tables.cells, &tables.steps);
        let [lo, hi] = tables.scene[0].zone;
        let mut random = SplitMix64::new(1);
        let (mut first, mut found) = (0, 0);
        for _ in 0..50_000 {
            let at = [0, 1, 2].map(|axis| random.between(lo[axis], hi[axis]));
            let cube = finder.grid.cube(at).unwrap();
            let listed = &finder.cells[finder.starts[cube] as usize..finder.starts[cube + 1] as usize];
            let holds = (0..tables.cells.len() as u32).filter(|&cell| {
                let record = &tables.cells[cell as usize];
                let is_free = record.kind == CellRecord::AIR && record.flags == CellRecord::FREE;
                is_free && super::super::Prisms::new(tables).nearly_holds(record, at.into(), -1e-3)
            });
            for cell in holds {
                assert!(listed.contains(&cell), "{at:?} in {cell}, not among {listed:?}");
                found += 1;
                first += u32::from(listed[0] == cell);
            }
        }
        assert!(found > 30_000 && f64::from(first) > 0.75 * f64::from(found), "{first} of {found}");
        for out in [lo.map(|c| c - 1e-9), hi.map(|c| c + 1e-9), [f64::NAN; 3], [f64::INFINITY; 3]] {
            assert_eq!(finder.grid.cube(out), None);
        }
        assert!(finder.grid.cube(lo).is_some() && finder.grid.cube(hi).is_some());
    }
}
