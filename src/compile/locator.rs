//! The locator: a grid of cubes that names, for each, the closed volumes whose inside reaches into it.

use crate::format::WHOLE_BIT;
use crate::format::records::VolumeRecord;

/// The grid and its items, as the sections `locator` and `located` hold them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Locator {
    pub(super) origin: [f64; 3],
    pub(super) step: f64,
    pub(super) dims: [u32; 3],
    pub(super) starts: Vec<u32>,
    pub(super) items: Vec<u32>,
}

/// Cubes a volume, on the average.
const CUBES_PER_VOLUME: f64 = 24.0;
const FEWEST_CUBES: f64 = 512.0;
const MOST_CUBES: f64 = (1 << 20) as f64;

/// Builds the grid over the box around all volumes. `corners` gives a triangle's corners.
pub(super) fn build(volumes: &[VolumeRecord], corners: &dyn Fn(u32) -> [[f64; 3]; 3]) -> Locator {
    let Some((origin, size)) = extent(volumes) else {
        return Locator { step: 1.0, starts: vec![0], ..Locator::default() };
    };
    let cubes = (volumes.len() as f64 * CUBES_PER_VOLUME).clamp(FEWEST_CUBES, MOST_CUBES);
    let longest = size[0].max(size[1]).max(size[2]);
    // Flat and long models get cubes for their area or length: no axis counts as shorter than a thousandth.
    let space: f64 = size.iter().map(|s| s.max(longest * 1e-3)).product();
    let step = (space / cubes).cbrt().max(longest / 1000.0);
    let dims = size.map(|s| (s / step).floor() as u32 + 1);
    let mut grid = Grid { origin, step, dims, pairs: Vec::new(), mark: Vec::new(), stamp: 0 };
    grid.mark = vec![0; dims.iter().map(|&d| d as usize).product()];
    for (index, volume) in volumes.iter().enumerate() {
        grid.add(index as u32, volume, corners);
    }
    grid.finish()
}

fn extent(volumes: &[VolumeRecord]) -> Option<([f64; 3], [f64; 3])> {
    let mut bounds = volumes.first()?.bounds;
    for volume in volumes {
        let [lo, hi] = volume.bounds;
        bounds[0] = [0, 1, 2].map(|axis| bounds[0][axis].min(lo[axis]));
        bounds[1] = [0, 1, 2].map(|axis| bounds[1][axis].max(hi[axis]));
    }
    let size = [0, 1, 2].map(|axis| (bounds[1][axis] - bounds[0][axis]).max(1e-3));
    Some((bounds[0], size))
}

struct Grid {
    origin: [f64; 3],
    step: f64,
    dims: [u32; 3],
    /// (cube, item)
    pairs: Vec<(u32, u32)>,
    /// The last stamp that marked each cube as cut by a surface.
    mark: Vec<u32>,
    stamp: u32,
}

impl Grid {
    /// The cube along `axis` that holds coordinate `c`, held within the grid.
    fn cube(&self, axis: usize, c: f64) -> u32 {
        let cube = ((c - self.origin[axis]) / self.step).floor();
        cube.clamp(0.0, f64::from(self.dims[axis] - 1)) as u32
    }

    fn index(&self, x: u32, y: u32, z: u32) -> usize {
        ((z as usize * self.dims[1] as usize) + y as usize) * self.dims[0] as usize + x as usize
    }

    fn middle(&self, axis: usize, cube: u32) -> f64 {
        self.origin[axis] + (f64::from(cube) + 0.5) * self.step
    }

    fn add(&mut self, index: u32, volume: &VolumeRecord, corners: &dyn Fn(u32) -> [[f64; 3]; 3]) {
        self.stamp += 1;
        // Heights at which the vertical line through the middle of a column of cubes meets the surface.
        let mut met: Vec<(u32, f64, i32)> = Vec::new();
        let triangles = volume.first_triangle..volume.first_triangle + volume.triangle_count;
        for t in triangles {
            let triangle = corners(t);
            self.mark_surface(triangle, index);
            self.meet_columns(triangle, &mut met);
        }
        met.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for column in met.chunk_by(|a, b| a.0 == b.0) {
            let (x, y) = (column[0].0 % self.dims[0], column[0].0 / self.dims[0]);
            let (mut passed, mut winding, mut parity) = (0, 0, 0);
            let top = self.cube(2, column[column.len() - 1].1);
            for z in self.cube(2, column[0].1)..=top {
                let middle = self.middle(2, z);
                while passed < column.len() && column[passed].1 <= middle {
                    winding += column[passed].2;
                    parity ^= 1;
                    passed += 1;
                }
                let inside = if volume.by_winding == 1 { winding != 0 } else { parity == 1 };
                let cube = self.index(x, y, z);
                if inside && self.mark[cube] != self.stamp {
                    self.pairs.push((cube as u32, index | WHOLE_BIT));
                }
            }
        }
    }

    /// Marks the cubes that a triangle cuts.
    fn mark_surface(&mut self, [a, b, c]: [[f64; 3]; 3], index: u32) {
        let pad = self.step * 1e-6;
        let lo = [0, 1, 2].map(|i| self.cube(i, a[i].min(b[i]).min(c[i]) - pad));
        let hi = [0, 1, 2].map(|i| self.cube(i, a[i].max(b[i]).max(c[i]) + pad));
        let (a, b, c) = (glam::DVec3::from(a), glam::DVec3::from(b), glam::DVec3::from(c));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let reach = normal.abs().element_sum() * self.step * 0.5 + pad;
        for z in lo[2]..=hi[2] {
            for y in lo[1]..=hi[1] {
                for x in lo[0]..=hi[0] {
                    let middle = glam::DVec3::new(self.middle(0, x), self.middle(1, y), self.middle(2, z));
                    let cube = self.index(x, y, z);
                    if self.mark[cube] != self.stamp && normal.dot(middle - a).abs() <= reach {
                        self.mark[cube] = self.stamp;
                        self.pairs.push((cube as u32, index));
                    }
                }
            }
        }
    }

    /// Notes where the lines through the middles of the columns meet a triangle.
    fn meet_columns(&self, triangle: [[f64; 3]; 3], met: &mut Vec<(u32, f64, i32)>) {
        let [a, b, c] = triangle;
        let lo = [0, 1].map(|i| self.cube(i, a[i].min(b[i]).min(c[i])));
        let hi = [0, 1].map(|i| self.cube(i, a[i].max(b[i]).max(c[i])));
        let below = a[2].min(b[2]).min(c[2]) - 1.0;
        for y in lo[1]..=hi[1] {
            for x in lo[0]..=hi[0] {
                let point = [self.middle(0, x), self.middle(1, y), below];
                let crossing = crate::trace::crossings(std::iter::once(triangle), point);
                if crossing.count == 1 {
                    let z = crate::trace::height(triangle, point);
                    // Going up through an outward face leaves the volume.
                    met.push((y * self.dims[0] + x, z, -crossing.winding));
                }
            }
        }
    }

    fn finish(mut self) -> Locator {
        self.pairs.sort_unstable();
        let mut starts = vec![0u32; self.mark.len() + 1];
        for &(cube, _) in &self.pairs {
            starts[cube as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let items = self.pairs.iter().map(|&(_, item)| item).collect();
        Locator { origin: self.origin, step: self.step, dims: self.dims, starts, items }
    }
}
