//! Where in the picture boxes and triangles are, eight at a time and roughly, so that those that show nowhere are left out.

use glam::{DMat3, Vec3};

use super::rows::Region;
use crate::format::records::{BlockRecord, LANES, NodeRecord};

/// Boxes are this much larger, metres: what f32 rounds.
pub(super) const SLACK: f32 = 1e-3;

/// What f32 may round in some products and sums, as a share of what is added.
const ROUNDED: f32 = 16.0 * f32::EPSILON;

/// Where something is in the picture, or more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// From which column up to which.
    pub(super) columns: [i32; 2],
    /// From which row up to which.
    pub(super) rows: [i32; 2],
    /// `1 / t` where it is nearest; infinite if it may be anywhere.
    pub(super) near: f32,
}

impl Place {
    pub(super) const ANYWHERE: Place = Place { columns: [0; 2], rows: [0; 2], near: f32::INFINITY };

    pub(super) fn is_anywhere(&self) -> bool {
        self.near == f32::INFINITY
    }
}

/// The places of eight.
pub(super) struct Places {
    columns: [[i32; LANES]; 2],
    rows: [[i32; LANES]; 2],
    near: [f32; LANES],
}

impl Places {
    #[inline(always)]
    pub(super) fn of(&self, lane: usize) -> Place {
        let pair = |of: &[[i32; LANES]; 2]| [of[0][lane], of[1][lane]];
        Place { columns: pair(&self.columns), rows: pair(&self.rows), near: self.near[lane] }
    }
}

/// What is seen of the children of a node.
pub(super) struct Boxes {
    /// Which of them, child i as bit i.
    pub(super) seen: u32,
    pub(super) places: Places,
    /// The squares of how far they are, metres.
    pub(super) away: [f32; LANES],
}

/// The camera in f32, and what rounding may do.
pub(super) struct Sight {
    /// From a point relative to the eye to column, row and 1, each times `t`.
    rows: [Vec3; 3],
    eye: Vec3,
    /// What rounding may do to each of the three.
    off: [f32; 3],
    /// What it may do to a place, metres.
    rounded: f32,
}

/// Of eight points, boxes or triangles: the least and the greatest column and row, and the least `t`.
struct Extent {
    least: [[f32; LANES]; 2],
    most: [[f32; LANES]; 2],
    /// Of all corners.
    first: [f32; LANES],
}

impl Extent {
    const NONE: Extent = Extent {
        least: [[f32::INFINITY; LANES]; 2],
        most: [[f32::NEG_INFINITY; LANES]; 2],
        first: [f32::INFINITY; LANES],
    };

    /// Adds a corner of each: column, row and 1, each times `t`. Where `t` is not positive the others have no meaning.
    #[inline(always)]
    fn add(&mut self, [x, y, t]: [[f32; LANES]; 3]) {
        for lane in 0..LANES {
            let inverse = 1.0 / t[lane];
            let at = [x[lane] * inverse, y[lane] * inverse];
            for (axis, at) in at.into_iter().enumerate() {
                let (least, most) = (self.least[axis][lane], self.most[axis][lane]);
                self.least[axis][lane] = if at < least { at } else { least };
                self.most[axis][lane] = if at > most { at } else { most };
            }
            let first = self.first[lane];
            self.first[lane] = if t[lane] < first { t[lane] } else { first };
        }
    }
}

impl Sight {
    /// Of a camera whose matrix this is, for what is at most `reach` from the eye, metres.
    pub(super) fn new(camera: DMat3, eye: Vec3, reach: f64) -> Sight {
        /// Roundings in the way from a corner to the picture, one after the other, and some more.
        const ROUNDINGS: f64 = 16.0;
        let rows = camera.transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis];
        let off =
            rows.map(|row| (row.abs().element_sum() * reach * ROUNDINGS * f64::from(f32::EPSILON)) as f32);
        let rounded = (reach * 4.0 * f64::from(f32::EPSILON)) as f32;
        Sight { rows: rows.map(|row| row.as_vec3()), eye, off, rounded }
    }

    /// Which of the children of a node show in a region, which has this frustum, and where.
    #[inline(always)]
    pub(super) fn of_boxes(&self, node: &NodeRecord, region: &Region, frustum: &[Vec3; 4]) -> Boxes {
        let mut terms = [[[[0.0f32; LANES]; 2]; 3]; 3];
        for (row, terms) in self.rows.iter().zip(&mut terms) {
            for axis in 0..3 {
                for lane in 0..LANES {
                    terms[axis][0][lane] = row[axis] * (node.lo[axis][lane] - self.eye[axis]);
                    terms[axis][1][lane] = row[axis] * (node.hi[axis][lane] - self.eye[axis]);
                }
            }
        }
        let mut extent = Extent::NONE;
        for corner in 0..8 {
            let mut at = [[0.0f32; LANES]; 3];
            for (at, terms) in at.iter_mut().zip(&terms) {
                for lane in 0..LANES {
                    at[lane] = terms[0][corner & 1][lane]
                        + terms[1][corner >> 1 & 1][lane]
                        + terms[2][corner >> 2][lane];
                }
            }
            extent.add(at);
        }
        let (seen, places) = self.places(&extent, region, reaches(node, self.eye, frustum));
        Boxes { seen, places, away: away(node, self.eye) }
    }

    /// Which of the triangles of a block show in a region, which has this frustum, and where.
    #[inline(always)]
    pub(super) fn of_triangles(
        &self,
        block: &BlockRecord,
        region: &Region,
        frustum: &[Vec3; 4],
    ) -> (u32, Places) {
        let mut extent = Extent::NONE;
        let mut corners = [[[0.0f32; LANES]; 3]; 3];
        for (i, row) in self.rows.iter().enumerate() {
            for lane in 0..LANES {
                let along =
                    |of: &[[f32; LANES]; 3]| row.x * of[0][lane] + row.y * of[1][lane] + row.z * of[2][lane];
                let corner = [0, 1, 2].map(|axis| block.corner[axis][lane] - self.eye[axis]);
                let first = row.x * corner[0] + row.y * corner[1] + row.z * corner[2];
                corners[0][i][lane] = first;
                corners[1][i][lane] = first + along(&block.edge1);
                corners[2][i][lane] = first + along(&block.edge2);
            }
        }
        for corner in corners {
            extent.add(corner);
        }
        // Triangles that rays are not to meet are no numbers: they reach nowhere.
        self.places(&extent, region, triangles_reach(block, self.eye, frustum))
    }

    /// Which of a block's triangles the eye surely sees from that side from which they are left out: of the first they are where their corners go
    /// around to the left, of the second where to the right.
    #[inline(always)]
    pub(super) fn hidden(&self, block: &BlockRecord, [left, right]: [u32; 2]) -> u32 {
        if left | right == 0 {
            return 0;
        }
        let BlockRecord { corner, edge1, edge2, .. } = block;
        let (mut is_left, mut is_right) = ([false; LANES], [false; LANES]);
        for lane in 0..LANES {
            let (u, v) = (
                [edge1[0][lane], edge1[1][lane], edge1[2][lane]],
                [edge2[0][lane], edge2[1][lane], edge2[2][lane]],
            );
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            let size = [
                (u[1] * v[2]).abs() + (u[2] * v[1]).abs(),
                (u[2] * v[0]).abs() + (u[0] * v[2]).abs(),
                (u[0] * v[1]).abs() + (u[1] * v[0]).abs(),
            ];
            let (mut away, mut off) = (0.0, 0.0);
            for axis in 0..3 {
                let from = corner[axis][lane] - self.eye[axis];
                away += from * normal[axis];
                off += size[axis] * (from.abs() * ROUNDED + self.rounded);
            }
            is_left[lane] = away < -off;
            is_right[lane] = away > off;
        }
        let bits = |is: &[bool; LANES]| (0..LANES).fold(0, |bits, lane| bits | u32::from(is[lane]) << lane);
        left & bits(&is_left) | right & bits(&is_right)
    }

    #[inline(always)]
    fn places(&self, extent: &Extent, region: &Region, seen: u32) -> (u32, Places) {
        /// Nearer to the eye than so many times what rounding may do, nothing is told.
        const CLEAR: f32 = 64.0;
        /// What rounding may do to columns and rows by themselves.
        const ASIDE: f32 = 0.02;
        let mut places =
            Places { columns: [[0; LANES]; 2], rows: [[0; LANES]; 2], near: [f32::INFINITY; LANES] };
        let mut shows = 0;
        for lane in 0..LANES {
            let first = extent.first[lane] - self.off[2];
            let is_clear = first > CLEAR * self.off[2];
            let inverse = 1.0 / first;
            let mut is_there = true;
            for (axis, (to, limits)) in
                [(&mut places.columns, region.columns), (&mut places.rows, region.rows)]
                    .into_iter()
                    .enumerate()
            {
                let [lo, hi] = limits.map(|limit| limit as f32);
                // Both `t` and what is divided by it may be off.
                let (least, most) = (extent.least[axis][lane], extent.most[axis][lane]);
                let off = |at: f32| (self.off[axis] + self.off[2] * at.abs()) * inverse + ASIDE;
                let (least, most) = ((least - off(least)).max(lo), (most + off(most)).min(hi));
                // Rounded up both.
                let up = |x: f32| {
                    let down = x as i32;
                    down.saturating_add(i32::from((down as f32) < x))
                };
                let (from, end) = (up(least), up(most).min(limits[1]));
                is_there &= from < end;
                (to[0][lane], to[1][lane]) = (from, end);
            }
            places.near[lane] = if is_clear { inverse * 1.000_001 } else { f32::INFINITY };
            shows |= u32::from(!is_clear || is_there) << lane;
        }
        (seen & shows, places)
    }
}

/// The triangles of a block that reach into all of the half-spaces, triangle i as bit i.
#[inline(always)]
pub(super) fn triangles_reach(block: &BlockRecord, eye: Vec3, frustum: &[Vec3; 4]) -> u32 {
    let mut inside = [true; LANES];
    for normal in frustum {
        let limit = normal.dot(eye) - SLACK;
        for lane in 0..LANES {
            let along = |of: &[[f32; LANES]; 3]| {
                normal.x * of[0][lane] + normal.y * of[1][lane] + normal.z * of[2][lane]
            };
            let most = along(&block.edge1).max(along(&block.edge2)).max(0.0);
            inside[lane] &= along(&block.corner) + most >= limit;
        }
    }
    (0..LANES).fold(0, |bits, lane| bits | u32::from(inside[lane]) << lane)
}

/// The children of a node that reach into all of the half-spaces, child i as bit i.
#[inline(always)]
pub(super) fn reaches(node: &NodeRecord, eye: Vec3, frustum: &[Vec3; 4]) -> u32 {
    let mut inside = [true; LANES];
    for normal in frustum {
        let limit = normal.dot(eye) - SLACK;
        for lane in 0..LANES {
            let mut far = 0.0;
            for axis in 0..3 {
                let n = normal[axis];
                far += if n > 0.0 { n * node.hi[axis][lane] } else { n * node.lo[axis][lane] };
            }
            inside[lane] &= far >= limit;
        }
    }
    (0..LANES).fold(0, |bits, lane| bits | u32::from(inside[lane]) << lane)
}

/// The squares of how far the children of a node are, metres.
#[inline(always)]
pub(super) fn away(node: &NodeRecord, eye: Vec3) -> [f32; LANES] {
    let mut away = [0.0f32; LANES];
    for axis in 0..3 {
        let eye = eye[axis];
        for lane in 0..LANES {
            let out = (node.lo[axis][lane] - eye).max(eye - node.hi[axis][lane]).max(0.0);
            away[lane] += out * out;
        }
    }
    away
}
