//! Which triangles are detail of which cells.
//!
//! A triangle is detail of every prism of air that it comes within the tolerance of. The test clips the triangle by the
//! prism's planes, moved outward by the margin: it may keep a little too much at sharp corners, never too little.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use super::cell_grid::CellGrid;
use crate::clip::keep_below;
use crate::format::Tables;
use crate::format::records::{CellRecord, PlaneRecord};
use crate::parallel;
use crate::trace::to_lattice;

/// Triangles that one task takes at a time.
const CHUNK: usize = 256;

/// The cells of each of the triangles `detail`: pairs of cell and triangle, in ascending order. `margin` is how near a
/// triangle must be to a prism of air to be its detail, metres. `None` if there are more than `most`.
pub(super) fn pairs(
    tables: &Tables,
    grid: &CellGrid,
    zone: [[f64; 3]; 2],
    detail: &[u32],
    margin: f64,
    most: u64,
) -> Option<Vec<(u32, u32)>> {
    let count = AtomicU64::new(0);
    let job = |chunk: &[u32]| {
        let mut of =
            Assign { tables, grid, zone, margin, mark: Vec::new(), stamp: 0, scratch: [vec![], vec![]] };
        of.mark.resize(tables.cells.len(), 0);
        let mut pairs = Vec::new();
        for &triangle in chunk {
            if count.load(Ordering::Relaxed) > most {
                break;
            }
            let before = pairs.len();
            of.assign(triangle, &mut pairs);
            count.fetch_add((pairs.len() - before) as u64, Ordering::Relaxed);
        }
        pairs
    };
    let chunks: Vec<&[u32]> = detail.chunks(CHUNK.max(tables.cells.len() / 16)).collect();
    let lists = parallel::map(chunks.len(), |chunk| job(chunks[chunk]));
    if count.load(Ordering::Relaxed) > most {
        return None;
    }
    let mut pairs = lists.concat();
    pairs.sort_unstable();
    Some(pairs)
}

/// The pairs of each cell that has any.
pub(super) fn by_cell(pairs: &[(u32, u32)]) -> Vec<(u32, Range<usize>)> {
    let mut first = 0;
    pairs
        .chunk_by(|a, b| a.0 == b.0)
        .map(|run| {
            let range = first..first + run.len();
            first = range.end;
            (run[0].0, range)
        })
        .collect()
}

struct Assign<'a> {
    tables: &'a Tables,
    grid: &'a CellGrid,
    zone: [[f64; 3]; 2],
    margin: f64,
    /// The last stamp with which each cell was looked at.
    mark: Vec<u32>,
    stamp: u32,
    /// Room for clipped polygons.
    scratch: [Vec<DVec3>; 2],
}

impl Assign<'_> {
    fn assign(&mut self, triangle: u32, pairs: &mut Vec<(u32, u32)>) {
        let tables = self.tables;
        // Along the lattice's axes, as the prisms.
        let scene = &tables.scene[0];
        let local =
            |v: u32| to_lattice(tables.vertices[v as usize], scene.lattice_origin, scene.lattice_turn);
        let corners = tables.triangles[triangle as usize].map(local);
        let [mut lo, mut hi] = [corners[0]; 2];
        for p in corners {
            lo = [0, 1, 2].map(|i| lo[i].min(p[i]));
            hi = [0, 1, 2].map(|i| hi[i].max(p[i]));
        }
        let (margin, zone) = (self.margin, self.zone);
        let apart = (0..3).any(|i| hi[i] < zone[0][i] - margin || lo[i] > zone[1][i] + margin);
        if apart {
            return;
        }
        self.stamp += 1;
        let [a, b, c] = corners.map(DVec3::from);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let half = DVec3::from(self.grid.step) / 2.0;
        let reach = normal.abs().dot(half) + 2.0 * margin;
        let [xs, ys, zs] = self.grid.cubes([lo.map(|c| c - margin), hi.map(|c| c + margin)]);
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    let cube = [x, y, z];
                    // Cubes at the grid's border also stand for what is beyond it.
                    let is_border = (0..3).any(|i| cube[i] == 0 || cube[i] + 1 == self.grid.dims[i]);
                    let middle = DVec3::from(self.grid.middle(cube));
                    if is_border || normal.dot(middle - a).abs() <= reach {
                        self.cube(self.grid.index(cube), [a, b, c], [lo, hi], triangle, pairs);
                    }
                }
            }
        }
    }

    fn cube(
        &mut self,
        cube: u32,
        corners: [DVec3; 3],
        [lo, hi]: [[f64; 3]; 2],
        triangle: u32,
        pairs: &mut Vec<(u32, u32)>,
    ) {
        for &index in self.grid.cells(cube) {
            if std::mem::replace(&mut self.mark[index as usize], self.stamp) == self.stamp {
                continue;
            }
            let cell = &self.tables.cells[index as usize];
            if cell.kind != CellRecord::AIR {
                continue;
            }
            let margin = self.margin;
            let [from, to] = cell.bounds;
            let near = (0..3).all(|i| lo[i] <= to[i] + margin && hi[i] >= from[i] - margin);
            if near && touches(self.tables, cell, corners, margin, &mut self.scratch) {
                pairs.push((index, triangle));
            }
        }
    }
}

/// Whether the triangle comes into the prism whose planes are moved outward by `margin`.
fn touches(
    tables: &Tables,
    cell: &CellRecord,
    corners: [DVec3; 3],
    margin: f64,
    [polygon, next]: &mut [Vec<DVec3>; 2],
) -> bool {
    polygon.clear();
    polygon.extend(corners);
    let mut clip = |normal: DVec3, offset: f64| keep_below(polygon, next, normal, offset);
    for (plane, up) in [(cell.floor, -1.0), (cell.ceiling, 1.0)] {
        let PlaneRecord { slope: [p, q], height } = tables.planes[plane as usize];
        let size = (1.0 + p * p + q * q).sqrt();
        if !clip(DVec3::new(-p, -q, 1.0) * (up / size), up * height / size + margin) {
            return false;
        }
    }
    let sides = &tables.sides[cell.first_side as usize..(cell.first_side + cell.sides) as usize];
    (0..sides.len()).all(|i| {
        let (a, b) = (sides[i].start.map(f64::from), sides[(i + 1) % sides.len()].start.map(f64::from));
        let out = DVec3::new(b[1] - a[1], a[0] - b[0], 0.0).normalize_or_zero();
        clip(out, out.x * a[0] + out.y * a[1] + margin)
    })
}
