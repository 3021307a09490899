//! A hierarchy of boxes over few triangles, made at run time.

use glam::DVec3;

use crate::format::records::{BlockRecord, LANES, Leaf, NodeRecord};
use crate::trace::NONE;

/// A triangle of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    pub(super) triangle: u32,
    pub(super) corners: [DVec3; 3],
}

/// Where nodes and groups of triangles are added.
pub(super) struct Tree<'a> {
    pub(super) nodes: &'a mut Vec<NodeRecord>,
    pub(super) blocks: &'a mut Vec<BlockRecord>,
    /// The scene's.
    pub(super) center: DVec3,
    pub(super) slack: f32,
}

type Bounds = [[f32; 3]; 2];

const NOWHERE: Bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

fn union(one: Bounds, other: Bounds) -> Bounds {
    [[0, 1, 2].map(|i| one[0][i].min(other[0][i])), [0, 1, 2].map(|i| one[1][i].max(other[1][i]))]
}

impl Tree<'_> {
    /// The root of a hierarchy over the items and what is under `old` already, which may be none.
    pub(super) fn grow(&mut self, old: u32, items: &mut [Item]) -> u32 {
        if old == NONE {
            return self.over(items);
        }
        let around = self.around(old);
        let added = self.over(items);
        let bounds = self.bounds(items);
        let mut node = NodeRecord::EMPTY;
        // The boxes of its own children have the slack already.
        node.put(0, old, around, 0.0);
        node.put(1, added, bounds, self.slack);
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// Eighths along the longest axis, each of them in turn, down to eight.
    fn over(&mut self, items: &mut [Item]) -> u32 {
        if items.len() <= LANES {
            let mut block = BlockRecord::EMPTY;
            for (lane, item) in items.iter().enumerate() {
                block.put(lane, item.triangle, item.corners, self.center);
            }
            self.blocks.push(block);
            return Leaf::link((self.blocks.len() - 1) * LANES, items.len());
        }
        let [lo, hi] = self.bounds(items);
        let size = |axis: usize| hi[axis] - lo[axis];
        let longest = (0..3).fold(0, |best, axis| if size(axis) > size(best) { axis } else { best });
        let middle = |item: &Item| item.corners.iter().map(|p| p[longest]).sum::<f64>();
        items.sort_by(|a, b| middle(a).total_cmp(&middle(b)).then(a.triangle.cmp(&b.triangle)));
        let place = self.nodes.len();
        self.nodes.push(NodeRecord::EMPTY);
        for (lane, part) in items.chunks_mut(items.len().div_ceil(LANES)).enumerate() {
            let (bounds, child) = (self.bounds(part), self.over(part));
            let slack = self.slack;
            self.nodes[place].put(lane, child, bounds, slack);
        }
        place as u32
    }

    fn bounds(&self, items: &[Item]) -> Bounds {
        let corners = items.iter().flat_map(|item| item.corners);
        let points = corners.map(|p| (p - self.center).as_vec3().to_array());
        points.fold(NOWHERE, |bounds, p| union(bounds, [p, p]))
    }

    /// A box around all that is under a root, slack included.
    fn around(&self, root: u32) -> Bounds {
        if root & Leaf::BIT == 0 {
            let node = &self.nodes[root as usize];
            let lanes = (0..LANES).filter(|&lane| node.child[lane] != NONE);
            let child = |lane: usize| [node.lo.map(|axis| axis[lane]), node.hi.map(|axis| axis[lane])];
            return lanes.map(child).fold(NOWHERE, union);
        }
        let leaf = Leaf::new(root);
        let block = &self.blocks[leaf.block()];
        let mut bounds = NOWHERE;
        for lane in leaf.lanes().filter(|&lane| block.triangle[lane] != NONE) {
            let corner = block.corner.map(|axis| axis[lane]);
            for edge in [[0.0; 3], block.edge1.map(|axis| axis[lane]), block.edge2.map(|axis| axis[lane])] {
                // Edges were rounded by themselves: twice the slack.
                let p = [0, 1, 2].map(|i| corner[i] + edge[i]);
                let margin = 2.0 * self.slack;
                bounds = union(bounds, [p.map(|c| c - margin), p.map(|c| c + margin)]);
            }
        }
        bounds
    }
}
