//! Points, to be asked for the pixels that a segment meets.

use super::{Budget, SnapError, pairs};
use crate::lattice::{Point, segment_meets_pixel};

/// Points of a leaf.
const FEW: usize = 8;

/// A tree of boxes, in the order in which they are visited.
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// The points in the order of the leaves, with their indices.
    points: Vec<(Point, u32)>,
}

struct Node {
    low: [i32; 2],
    high: [i32; 2],
    /// The node to go on with if this is not met.
    next: u32,
    /// A leaf's points; none in other nodes.
    from: u32,
    to: u32,
}

impl Tree {
    pub(super) fn new(points: &[Point]) -> Tree {
        let points: Vec<(Point, u32)> = points.iter().enumerate().map(|(i, &p)| (p, i as u32)).collect();
        let nodes = Vec::with_capacity(4 * (points.len() / FEW + 1));
        let mut tree = Tree { nodes, points };
        if !tree.points.is_empty() {
            tree.build(0, tree.points.len());
        }
        tree
    }

    /// Halves the points at each level: as deep as their number has bits.
    fn build(&mut self, from: usize, to: usize) {
        let points = &mut self.points[from..to];
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for (p, _) in points.iter() {
            low = [low[0].min(p.x), low[1].min(p.y)];
            high = [high[0].max(p.x), high[1].max(p.y)];
        }
        let leaf = points.len() <= FEW;
        let node = self.nodes.len();
        let (first, last) = if leaf { (from as u32, to as u32) } else { (0, 0) };
        self.nodes.push(Node { low, high, next: 0, from: first, to: last });
        if !leaf {
            let half = points.len() / 2;
            if high[0] - low[0] >= high[1] - low[1] {
                points.select_nth_unstable_by_key(half, |(p, _)| p.x);
            } else {
                points.select_nth_unstable_by_key(half, |(p, _)| p.y);
            }
            self.build(from, from + half);
            self.build(from + half, to);
        }
        self.nodes[node].next = self.nodes.len() as u32;
    }

    /// Adds to `found` the indices of all points but `a` and `b` whose pixels the segment from `a` to `b` meets,
    /// `a < b`, in no order.
    pub(super) fn met(
        &self,
        a: Point,
        b: Point,
        budget: &mut Budget,
        found: &mut Vec<u32>,
    ) -> Result<(), SnapError> {
        let (bottom, top) = (a.y.min(b.y), a.y.max(b.y));
        let (mut node, mut tests) = (0, 0);
        while let Some(here) = self.nodes.get(node) {
            tests += 1;
            if !pairs::reaches(&[a, b], here.low, here.high) {
                node = here.next as usize;
                continue;
            }
            for &(p, index) in &self.points[here.from as usize..here.to as usize] {
                if (a.x..=b.x).contains(&p.x)
                    && (bottom..=top).contains(&p.y)
                    && p != a
                    && p != b
                    && pairs::straddles(a, b, [p.x, p.y], [p.x, p.y])
                    && segment_meets_pixel(a, b, p)
                {
                    found.push(index);
                }
            }
            node += 1;
        }
        budget.test(tests)
    }
}
