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
    /// What some rays meet of detail before `t`: of all under a root, or of the leaves that are told to be near.
    #[inline(always)]
    pub(super) fn detail(
        &self,
        ask: Ask,
        rays: u32,
        (root, near): (u32, Option<&[Near]>),
        t: L::Wide,
    ) -> Nearest {
        let herd = Herd::<L> { origin: self.origin, direction: self.direction };
        let (walk, until) = (Walk::new(self.tables), t.add(L::Wide::splat(NEAR)).min(self.limit));
        match near {
            Some(near) => leaves::<L>(ask, &walk, &herd, rays, near, until),
            None => together::<L>(ask, &walk, &herd, rays, root, until),
        }
    }

    /// The rays that may come to that before `until`.
    #[inline(always)]
    pub(super) fn touched(&self, (root, near): (u32, Option<&[Near]>), until: L) -> u32 {
        match (root, near) {
            (NONE, _) | (_, Some([])) => 0,
            (_, Some(_)) => self.under_way,
            (root, None) if root & Leaf::BIT != 0 => self.under_way,
            (root, None) => self.under_way & self.touched_boxes(&self.tables.nodes[root as usize], until),
        }
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
