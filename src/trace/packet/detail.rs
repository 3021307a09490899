//! Detail of the cells in which rays are.

use super::eight::Eight;
use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::herd::{Herd, Near, Nearest, Rounded, leaves, together};
use crate::trace::kernel::Ask;
use crate::trace::lanes::Wide;
use crate::trace::path::NEAR;
use crate::trace::walk::Walk;

impl<L: Entries> Eight<'_, L> {
    /// What some rays meet of detail before `t`.
    #[inline(always)]
    pub(super) fn detail(&self, ask: Ask, rays: u32, root: u32, t: L::Wide) -> Nearest {
        let herd = Herd::<L> { origin: self.origin, direction: self.direction };
        let until = t.add(L::Wide::splat(NEAR)).min(self.limit);
        together::<L>(ask, &Walk::new(self.tables), &herd, rays, root, until)
    }

    /// The rays that come to a box of a root before `until`.
    #[inline(always)]
    pub(super) fn touched_one(&self, root: u32, until: L) -> u32 {
        match root {
            NONE => 0,
            root if root & Leaf::BIT != 0 => self.under_way,
            root => self.under_way & self.touched_boxes(&self.tables.nodes[root as usize], until),
        }
    }

    /// What some rays meet of the leaves that are near, before `t`.
    #[inline(always)]
    pub(super) fn detail_of(&self, near: &[Near], rays: u32, t: L::Wide) -> Nearest {
        let herd = Herd::<L> { origin: self.origin, direction: self.direction };
        let until = t.add(L::Wide::splat(NEAR)).min(self.limit);
        leaves::<L>(&Walk::new(self.tables), &herd, rays, near, until)
    }

    /// The rays that come to any of a node's boxes before `until`.
    #[inline(always)]
    fn touched_boxes(&self, node: &NodeRecord, until: L) -> u32 {
        let scene = &self.tables.scene[0];
        let rays = Rounded::new(scene, &self.origin, &self.direction);
        let slack = L::splat(scene.slack);
        let until = until.mul_add(L::splat(2e-6), until).add(slack);
        let mut touched = 0;
        for child in 0..LANES {
            if node.child[child] == NONE {
                continue;
            }
            let (near, far) = rays.span(node, child, L::splat(0.0).sub(slack), until);
            touched |= L::bits(near.le(far));
        }
        touched
    }
}
