//! Where in the picture boxes and triangles are, eight at a time and roughly, so that those that show nowhere are left out.

use glam::{DMat3, Vec3};

use super::facets::Planes;
use super::rows::Region;
use super::wide::MAGIC;
use crate::format::records::{BlockRecord, LANES, NodeRecord};

/// Half-spaces are no less than this much larger, metres: what f32 rounds in buildings of any common size.
const SLACK: f32 = 1e-3;

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
    /// By how much half-spaces are larger, metres.
    pub(super) slack: f32,
}

/// A number for each of eight. Each operation is a loop of its own, which compilers make one or two instructions of.
#[derive(Clone, Copy)]
struct Eight([f32; LANES]);

/// Of each of eight what is made of its place.
macro_rules! each {
    ($zero:expr, |$i:ident| $body:expr) => {{
        let mut out = [$zero; LANES];
        for $i in 0..LANES {
            out[$i] = $body;
        }
        out
    }};
}

impl Eight {
    #[inline(always)]
    fn splat(x: f32) -> Eight {
        Eight([x; LANES])
    }

    #[inline(always)]
    fn add(self, other: Eight) -> Eight {
        Eight(each!(0.0, |i| self.0[i] + other.0[i]))
    }

    #[inline(always)]
    fn sub(self, other: Eight) -> Eight {
        Eight(each!(0.0, |i| self.0[i] - other.0[i]))
    }

    #[inline(always)]
    fn mul(self, other: Eight) -> Eight {
        Eight(each!(0.0, |i| self.0[i] * other.0[i]))
    }

    #[inline(always)]
    fn scale(self, by: f32) -> Eight {
        Eight(each!(0.0, |i| self.0[i] * by))
    }

    #[inline(always)]
    fn inverse(self) -> Eight {
        Eight(each!(0.0, |i| 1.0 / self.0[i]))
    }

    #[inline(always)]
    fn abs(self) -> Eight {
        Eight(each!(0.0, |i| self.0[i].abs()))
    }

    /// The lesser of both, or the second if one is no number.
    #[inline(always)]
    fn min(self, other: Eight) -> Eight {
        Eight(each!(0.0, |i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// The greater of both, or the second if one is no number.
    #[inline(always)]
    fn max(self, other: Eight) -> Eight {
        Eight(each!(0.0, |i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// Rounded up: numbers from 0 to four millions.
    #[inline(always)]
    fn up(self) -> [i32; LANES] {
        // The nearest whole number, or that above it.
        let near = Eight(each!(0.0, |i| self.0[i] + MAGIC));
        let whole = each!(0, |i| near.0[i].to_bits() as i32 - MAGIC.to_bits() as i32);
        each!(0, |i| whole[i] + i32::from(near.0[i] - MAGIC < self.0[i]))
    }

    /// Along a direction: of eight vectors.
    #[inline(always)]
    fn along(direction: Vec3, of: &[[f32; LANES]; 3]) -> Eight {
        let [x, y, z] = [Eight(of[0]), Eight(of[1]), Eight(of[2])];
        x.scale(direction.x).add(y.scale(direction.y)).add(z.scale(direction.z))
    }
}

/// The bits of all eight.
const EVERY: u32 = (1 << LANES) - 1;

/// Bits of what is true.
#[inline(always)]
fn bits(is: [bool; LANES]) -> u32 {
    let mut bits = 0;
    for (i, is) in is.into_iter().enumerate() {
        bits |= u32::from(is) << i;
    }
    bits
}

/// Of eight points, boxes or triangles: the least and the greatest column and row, and the least `t`.
struct Extent {
    least: [Eight; 2],
    most: [Eight; 2],
    /// Of all corners.
    first: Eight,
}

impl Extent {
    const NONE: Extent = Extent {
        least: [Eight([f32::INFINITY; LANES]); 2],
        most: [Eight([f32::NEG_INFINITY; LANES]); 2],
        first: Eight([f32::INFINITY; LANES]),
    };

    /// Adds a corner of each: column, row and 1, each times `t`. Where `t` is not positive the others have no meaning.
    #[inline(always)]
    fn add(&mut self, [x, y, t]: [Eight; 3]) {
        let inverse = t.inverse();
        let [x, y] = [x.mul(inverse), y.mul(inverse)];
        self.least = [x.min(self.least[0]), y.min(self.least[1])];
        self.most = [x.max(self.most[0]), y.max(self.most[1])];
        self.first = t.min(self.first);
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
        let slack = SLACK.max(4.0 * rounded);
        Sight { rows: rows.map(|row| row.as_vec3()), eye, off, rounded, slack }
    }

    /// Which of the children of a node show in a region, which has this frustum, and where.
    #[inline(always)]
    pub(super) fn of_boxes(&self, node: &NodeRecord, region: &Region, frustum: &[Vec3; 4]) -> Boxes {
        let mut terms = [[[Eight::splat(0.0); 2]; 3]; 3];
        for (row, terms) in self.rows.iter().zip(&mut terms) {
            for axis in 0..3 {
                let eye = Eight::splat(self.eye[axis]);
                terms[axis] = [
                    Eight(node.lo[axis]).sub(eye).scale(row[axis]),
                    Eight(node.hi[axis]).sub(eye).scale(row[axis]),
                ];
            }
        }
        let mut extent = Extent::NONE;
        for corner in 0..8 {
            let mut at = [Eight::splat(0.0); 3];
            for (at, terms) in at.iter_mut().zip(&terms) {
                *at = terms[0][corner & 1].add(terms[1][corner >> 1 & 1]).add(terms[2][corner >> 2]);
            }
            extent.add(at);
        }
        let (mut seen, clear, places) = self.places(&extent, region);
        // Where it is told where in the picture they are, the half-spaces say nothing more.
        if clear != EVERY {
            seen &= clear | reaches(node, self.eye, frustum, self.slack);
        }
        Boxes { seen, places, away: away(node, self.eye) }
    }

    /// Which of the triangles of a block show in a region, which has this frustum, and where; without those that are [hidden](Sight::hidden).
    #[inline(always)]
    pub(super) fn of_triangles(
        &self,
        block: &BlockRecord,
        backs: [u32; 2],
        region: &Region,
        frustum: &[Vec3; 4],
    ) -> (u32, Places) {
        let corner = [
            Eight(block.corner[0]).sub(Eight::splat(self.eye.x)).0,
            Eight(block.corner[1]).sub(Eight::splat(self.eye.y)).0,
            Eight(block.corner[2]).sub(Eight::splat(self.eye.z)).0,
        ];
        let zero = Eight::splat(0.0);
        let mut corners = [[zero; 3]; 3];
        for (i, &row) in self.rows.iter().enumerate() {
            let first = Eight::along(row, &corner);
            corners[0][i] = first;
            corners[1][i] = first.add(Eight::along(row, &block.edge1));
            corners[2][i] = first.add(Eight::along(row, &block.edge2));
        }
        let mut extent = Extent::NONE;
        for corner in corners {
            extent.add(corner);
        }
        let (mut seen, clear, places) = self.places(&extent, region);
        if clear != EVERY {
            // Triangles that rays are not to meet are no numbers, and not clear: they reach nowhere.
            seen &= clear | triangles_reach(block, self.eye, frustum, self.slack);
        }
        if seen != 0 {
            seen &= !self.hidden(block, backs);
        }
        (seen, places)
    }

    /// Which of a block's triangles the eye surely sees from that side from which they are left out: of the first they are where their corners go
    /// around to the left, of the second where to the right.
    #[inline(always)]
    pub(super) fn hidden(&self, block: &BlockRecord, [left, right]: [u32; 2]) -> u32 {
        if left | right == 0 {
            return 0;
        }
        let [u, v] = [&block.edge1, &block.edge2];
        let (mut away, mut off) = (Eight::splat(0.0), Eight::splat(0.0));
        for axis in 0..3 {
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let [one, other] = [Eight(u[next]).mul(Eight(v[last])), Eight(u[last]).mul(Eight(v[next]))];
            let from = Eight(block.corner[axis]).sub(Eight::splat(self.eye[axis]));
            away = away.add(from.mul(one.sub(other)));
            let rounded = from.abs().scale(ROUNDED).add(Eight::splat(self.rounded));
            off = off.add(one.abs().add(other.abs()).mul(rounded));
        }
        let is_left = each!(false, |i| away.0[i] < -off.0[i]);
        let is_right = each!(false, |i| away.0[i] > off.0[i]);
        left & bits(is_left) | right & bits(is_right)
    }

    /// Which of some polygons the eye surely sees from that side from which they are left out.
    #[inline(always)]
    pub(super) fn behind(&self, planes: &Planes) -> u32 {
        let along = Eight::along(self.eye, &planes.normal);
        let away = Eight(planes.away).sub(along);
        let is_left = each!(false, |i| away.0[i] < -self.slack);
        let is_right = each!(false, |i| away.0[i] > self.slack);
        u32::from(planes.backs[0]) & bits(is_left) | u32::from(planes.backs[1]) & bits(is_right)
    }

    /// Which of eight show in a region, or are not told where, which are told, and where those are.
    #[inline(always)]
    fn places(&self, extent: &Extent, region: &Region) -> (u32, u32, Places) {
        /// Nearer to the eye than so many times what rounding may do, nothing is told.
        const CLEAR: f32 = 64.0;
        /// What rounding may do to columns and rows by themselves.
        const ASIDE: f32 = 0.02;
        let first = extent.first.sub(Eight::splat(self.off[2]));
        let inverse = first.inverse();
        let mut places =
            Places { columns: [[0; LANES]; 2], rows: [[0; LANES]; 2], near: [f32::INFINITY; LANES] };
        // What has no corner that is a number is nowhere.
        let mut is_there = each!(false, |i| extent.first.0[i] < f32::INFINITY);
        for (axis, (to, limits)) in
            [(&mut places.columns, region.columns), (&mut places.rows, region.rows)].into_iter().enumerate()
        {
            let [lo, hi] = [Eight::splat(limits[0] as f32), Eight::splat(limits[1] as f32)];
            // Both `t` and what is divided by it may be off.
            let (least, most) = (extent.least[axis], extent.most[axis]);
            let (own, by) = (Eight::splat(self.off[axis]), self.off[2]);
            let aside = Eight::splat(ASIDE);
            let before = least.abs().scale(by).add(own).mul(inverse).add(aside);
            let after = most.abs().scale(by).add(own).mul(inverse).add(aside);
            to[0] = least.sub(before).max(lo).min(hi).up();
            to[1] = most.add(after).max(lo).min(hi).up();
            is_there = each!(false, |i| is_there[i] & (to[0][i] < to[1][i]));
        }
        let clear = Eight::splat(CLEAR * self.off[2]);
        let is_clear = each!(false, |i| first.0[i] > clear.0[i]);
        places.near = each!(0.0, |i| if is_clear[i] { inverse.0[i] * 1.000_001 } else { f32::INFINITY });
        let clear = bits(is_clear);
        (bits(is_there) | EVERY & !clear, clear, places)
    }
}

/// The triangles of a block that reach into all of the half-spaces, which are larger by `slack` metres, triangle i as bit i.
#[inline(always)]
pub(super) fn triangles_reach(block: &BlockRecord, eye: Vec3, frustum: &[Vec3; 4], slack: f32) -> u32 {
    let mut inside = [true; LANES];
    for &normal in frustum {
        let limit = normal.dot(eye) - slack;
        let [second, third] = [Eight::along(normal, &block.edge1), Eight::along(normal, &block.edge2)];
        let most = second.max(third).max(Eight::splat(0.0)).add(Eight::along(normal, &block.corner));
        inside = each!(false, |i| inside[i] & (most.0[i] >= limit));
    }
    bits(inside)
}

/// The children of a node that reach into all of the half-spaces, which are larger by `slack` metres, child i as bit i.
#[inline(always)]
pub(super) fn reaches(node: &NodeRecord, eye: Vec3, frustum: &[Vec3; 4], slack: f32) -> u32 {
    let mut inside = [true; LANES];
    for normal in frustum {
        let limit = normal.dot(eye) - slack;
        let mut far = Eight::splat(0.0);
        for axis in 0..3 {
            let n = normal[axis];
            far = far.add(Eight(if n > 0.0 { node.hi[axis] } else { node.lo[axis] }).scale(n));
        }
        inside = each!(false, |i| inside[i] & (far.0[i] >= limit));
    }
    bits(inside)
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
