//! A grid of cubes over the zone of the prisms, which names the prisms that reach into each: for points that are looked
//! up, and for the triangles that cells hold as detail.

use crate::format::Tables;
use crate::format::records::CellRecord;

/// The grid and its items, as the sections `cellgrid` and `gridcells` hold them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CellGrid {
    pub(super) origin: [f64; 3],
    pub(super) step: [f64; 3],
    pub(super) dims: [u32; 3],
    pub(super) starts: Vec<u32>,
    pub(super) items: Vec<u32>,
}

/// Cubes a prism, on the average.
const CUBES_PER_CELL: f64 = 2.0;
const MOST_CUBES: f64 = (1 << 20) as f64;

/// Builds the grid over `zone`: a prism is listed in all cubes that it comes within `margin` of.
///
/// # Errors
/// If there are more items than the format can count.
pub(super) fn build(tables: &Tables, zone: Option<[[f64; 3]; 2]>, margin: f64) -> Result<CellGrid, String> {
    let Some([lo, hi]) = zone else {
        return Ok(CellGrid { step: [1.0; 3], starts: vec![0], ..CellGrid::default() });
    };
    let size = [0, 1, 2].map(|axis| hi[axis] - lo[axis]);
    let prisms = &tables.cells[1..];
    let cubes = (prisms.len() as f64 * CUBES_PER_CELL).clamp(1.0, MOST_CUBES);
    let edge = (size.iter().product::<f64>() / cubes).cbrt();
    let dims = size.map(|s| (s / edge).round().clamp(1.0, 1024.0) as u32);
    let step = [0, 1, 2].map(|axis| size[axis] / f64::from(dims[axis]));
    let mut grid = CellGrid { origin: lo, step, dims, ..CellGrid::default() };
    let mut pairs = Vec::new();
    for (cell, index) in prisms.iter().zip(1u32..) {
        grid.list(tables, cell, margin, &mut |cube| pairs.push((cube, index)));
    }
    if pairs.len() > u32::MAX as usize {
        return Err("the cells reach into too many cubes".to_owned());
    }
    pairs.sort_unstable();
    grid.starts = vec![0; dims.iter().map(|&d| d as usize).product::<usize>() + 1];
    for &(cube, _) in &pairs {
        grid.starts[cube as usize + 1] += 1;
    }
    for i in 1..grid.starts.len() {
        grid.starts[i] += grid.starts[i - 1];
    }
    grid.items = pairs.into_iter().map(|(_, cell)| cell).collect();
    Ok(grid)
}

impl CellGrid {
    /// The cubes along each axis that a box reaches into, held within the grid.
    pub(super) fn cubes(&self, [lo, hi]: [[f64; 3]; 2]) -> [std::ops::RangeInclusive<u32>; 3] {
        let cube = |axis: usize, c: f64| {
            let cube = ((c - self.origin[axis]) / self.step[axis]).floor();
            cube.clamp(0.0, f64::from(self.dims[axis] - 1)) as u32
        };
        [0, 1, 2].map(|axis| cube(axis, lo[axis])..=cube(axis, hi[axis]))
    }

    /// The index of a cube.
    pub(super) fn index(&self, [x, y, z]: [u32; 3]) -> u32 {
        (z * self.dims[1] + y) * self.dims[0] + x
    }

    /// The middle of a cube.
    pub(super) fn middle(&self, cube: [u32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.origin[axis] + (f64::from(cube[axis]) + 0.5) * self.step[axis])
    }

    /// The prisms of a cube.
    pub(super) fn cells(&self, cube: u32) -> &[u32] {
        &self.items[self.starts[cube as usize] as usize..self.starts[cube as usize + 1] as usize]
    }

    /// Calls `add` with every cube that comes within `margin` of the prism: by its box, and by its sides in the plan.
    fn list(&self, tables: &Tables, cell: &CellRecord, margin: f64, add: &mut dyn FnMut(u32)) {
        let [lo, hi] = cell.bounds;
        let [xs, ys, zs] = self.cubes([lo.map(|c| c - margin), hi.map(|c| c + margin)]);
        let sides = &tables.sides[cell.first_side as usize..(cell.first_side + cell.sides) as usize];
        for y in ys {
            for x in xs.clone() {
                let middle = self.middle([x, y, 0]);
                let is_near = (0..sides.len()).all(|i| {
                    let (a, b) = (sides[i].start, sides[(i + 1) % sides.len()].start);
                    let [ax, ay] = a.map(f64::from);
                    let [ex, ey] = [0, 1].map(|axis| f64::from(b[axis]) - f64::from(a[axis]));
                    // How far the column's middle is on the right of the edge, times the edge's length; and the most
                    // that its corners differ from it.
                    let right = ex * (ay - middle[1]) - ey * (ax - middle[0]);
                    let reach = (ex.abs() * self.step[1] + ey.abs() * self.step[0]) / 2.0;
                    right <= reach + margin * (ex * ex + ey * ey).sqrt()
                });
                if is_near {
                    zs.clone().for_each(|z| add(self.index([x, y, z])));
                }
            }
        }
    }
}
