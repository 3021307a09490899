//! The pyramid that holds a bundle's rays: where they leave prisms, and what of detail they may come to.

use arrayvec::ArrayVec;
use glam::Vec3;

use super::ALL;
use super::bundle::{Bundle, Part, most};
use super::crossing::One;
use super::lines::Lines;
use crate::format::Views;
use crate::format::records::{LANES, Leaf};
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::herd::Near;
use crate::trace::step::Step;

/// The slack of boxes and triangles, in those of the scene.
const SLACK: f32 = 4.0;

/// Leaves that rays of a bundle come to at most: with more it is halved.
pub(super) const LEAVES: usize = 24;

/// Nodes that wait at most.
const WAITING: usize = 32;

/// A pyramid.
pub(super) struct Pyramid<'a, L> {
    pub(super) tables: &'a Views,
    /// Its corners.
    pub(super) corners: Lines<L>,
    /// How far it reaches along the second and the third axis: least, most.
    pub(super) reach: [[f32; 2]; 2],
    pub(super) of: &'a Bundle<L>,
}

impl<L: Entries> Pyramid<'_, L> {
    /// The edge that all rays leave a prism by, where it leads, and a place along them that is no nearer.
    #[inline(always)]
    pub(super) fn way_out(&self, step: &Step, part: Part) -> Option<(usize, u32, f32)> {
        if !step.is_some() {
            return None;
        }
        let [floor, ceiling] = step.height;
        let (floor, ceiling) = (L::splat(floor), L::splat(ceiling));
        let (count, of) = (step.corners.into(), One(step));
        let mut crossed = if part.starts {
            self.corners.cross::<true>(count, &of, [floor, ceiling], ALL)
        } else {
            self.corners.cross::<false>(count, &of, [floor, ceiling], ALL)
        };
        let edges = crossed.edge.store();
        if edges[0].to_bits() < LANES as u32 {
            // As clear for all as for the one of the most blur.
            crossed.blur = L::splat(most(crossed.blur));
            let (blur, height) = (crossed.blur, crossed.height);
            let within = L::and(floor.add(blur).le(height), height.le(ceiling.sub(blur)));
            if L::bits(within) != ALL {
                return None;
            }
        }
        let (edge, link) = self.corners.way_out(self.tables, ALL, step, part.cell, &crossed)?;
        Some((edge, link, most(crossed.t.add(crossed.off))))
    }

    /// The leaves under a root whose triangles rays may meet before `until`, the nearest first; none if these are too many.
    #[inline(always)]
    pub(super) fn gather(&self, root: u32, until: f32) -> Option<ArrayVec<Near, LEAVES>> {
        let mut near = ArrayVec::new();
        if root == NONE {
            return Some(near);
        }
        if root & Leaf::BIT != 0 {
            let triangles = self.triangles(root);
            if triangles != 0 {
                near.push(Near { leaf: root, triangles, node: NONE, child: 0, depth: 0.0 });
            }
            return Some(near);
        }
        let mut waiting = ArrayVec::<u32, WAITING>::new();
        waiting.push(root);
        while let Some(node) = waiting.pop() {
            let (mut touched, depth) = self.touched(node, until);
            let depth = depth.store();
            while touched != 0 {
                let child = touched.trailing_zeros() as usize % LANES;
                touched &= touched - 1;
                let link = self.tables.nodes[node as usize].child[child];
                if link & Leaf::BIT == 0 {
                    waiting.try_push(link).ok()?;
                    continue;
                }
                let triangles = self.triangles(link);
                if triangles != 0 {
                    let found = Near { leaf: link, triangles, node, child: child as u8, depth: depth[child] };
                    near.try_push(found).ok()?;
                    let mut place = near.len() - 1;
                    while place > 0 && near[place - 1].depth > near[place].depth {
                        near.swap(place - 1, place);
                        place -= 1;
                    }
                }
            }
        }
        Some(near)
    }

    /// The normals of the pyramid's sides, which look inward.
    #[inline(always)]
    fn sides(&self) -> [Vec3; 4] {
        let [ahead, aside, over] = self.of.axes;
        let [[a, b], [c, d]] = self.reach;
        [aside - a * ahead, b * ahead - aside, over - c * ahead, d * ahead - over]
    }

    /// The boxes of a node (lane i is bit i) that any ray may come to before `until`; how far along the axis they begin.
    #[inline(always)]
    fn touched(&self, node: u32, until: f32) -> (u32, L) {
        let node = &self.tables.nodes[node as usize];
        let slack = SLACK * self.tables.scene[0].slack + until.min(1e30) * 4e-6;
        let mut rows = [[L::splat(0.0); 2]; 3];
        for (axis, row) in rows.iter_mut().enumerate() {
            let local = L::splat(self.of.local[axis]);
            *row = [L::load(&node.lo[axis]).sub(local), L::load(&node.hi[axis]).sub(local)];
        }
        let mut inside = 0;
        for (lane, &child) in node.child.iter().enumerate() {
            inside |= u32::from(child != NONE) << lane;
        }
        for side in self.sides() {
            let mut farthest = L::splat(2.0 * slack);
            for ([lo, hi], by) in rows.into_iter().zip(side.to_array()) {
                let by = L::splat(by);
                farthest = farthest.add(lo.mul(by).max(hi.mul(by)));
            }
            inside &= L::bits(L::splat(0.0).le(farthest));
        }
        let (mut farthest, mut nearest) = (L::splat(slack), L::splat(-slack));
        for ([lo, hi], by) in rows.into_iter().zip(self.of.axes[0].to_array()) {
            let by = L::splat(by);
            let (lo, hi) = (lo.mul(by), hi.mul(by));
            farthest = farthest.add(lo.max(hi));
            nearest = nearest.add(lo.min(hi));
        }
        let ahead = L::and(L::splat(0.0).le(farthest), nearest.le(L::splat(until)));
        (inside & L::bits(ahead), nearest)
    }

    /// The triangles of a leaf, by their lanes, that any ray may meet.
    #[inline(always)]
    fn triangles(&self, leaf: u32) -> u32 {
        let leaf = Leaf::new(leaf);
        let block = &self.tables.blocks[leaf.block()];
        let slack = SLACK * self.tables.scene[0].slack;
        let mut rows = [[L::splat(0.0); 3]; 3];
        let mut size = L::splat(0.0);
        for (axis, row) in rows.iter_mut().enumerate() {
            let local = L::splat(self.of.local[axis]);
            *row = [
                L::load(&block.corner[axis]).sub(local),
                L::load(&block.edge1[axis]),
                L::load(&block.edge2[axis]),
            ];
            size = size.add(row[0].abs()).add(row[1].abs()).add(row[2].abs());
        }
        let under = L::splat(0.0).sub(size.mul_add(L::splat(2e-6), L::splat(2.0 * slack)));
        let mut may = 0;
        for lane in leaf.lanes() {
            may |= u32::from(block.triangle[lane] != NONE) << lane;
        }
        for side in self.sides() {
            let mut at = [L::splat(0.0); 3];
            for (row, by) in rows.into_iter().zip(side.to_array()) {
                let by = L::splat(by);
                for (at, of) in at.iter_mut().zip(row) {
                    *at = of.mul_add(by, *at);
                }
            }
            let [a, e1, e2] = at;
            let farthest = a.max(a.add(e1)).max(a.add(e2));
            may &= L::bits(under.le(farthest));
        }
        may
    }
}
