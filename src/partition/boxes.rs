//! An index over boxes: which of them meet a given box.
//!
//! A tree of halves by the median along the longer axis, so that its depth is bounded whatever the boxes; its nodes lie in
//! the order of a walk from the top, each with the place where the walk goes on if its box is missed.

use glam::DVec3;

use super::halfspaces::Bounds;
use crate::parallel;

/// Boxes in a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxTree {
    nodes: Vec<Node>,
    /// Boxes with their numbers, leaf by leaf.
    items: Vec<Item>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Node {
    bounds: Bounds32,
    /// The next node if this one's box is missed.
    skip: u32,
    /// Its first item, of a leaf; else [`INNER`].
    first: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Item {
    bounds: Bounds32,
    number: u32,
}

/// A box that contains the f64 one.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds32 {
    low: [f32; 3],
    high: [f32; 3],
}

impl Bounds32 {
    fn around(bounds: &Bounds) -> Bounds32 {
        let low = bounds.low.to_array().map(|c| (c as f32).next_down());
        let high = bounds.high.to_array().map(|c| (c as f32).next_up());
        Bounds32 { low, high }
    }

    fn meets(&self, other: &Bounds32) -> bool {
        // Without branches between the axes.
        (0..3).fold(true, |meets, i| meets & (self.low[i] <= other.high[i]) & (other.low[i] <= self.high[i]))
    }

    fn join(&self, other: &Bounds32) -> Bounds32 {
        Bounds32 {
            low: [0, 1, 2].map(|i| self.low[i].min(other.low[i])),
            high: [0, 1, 2].map(|i| self.high[i].max(other.high[i])),
        }
    }

    /// Twice its middle along an axis.
    fn middle(&self, axis: usize) -> f32 {
        self.low[axis] + self.high[axis]
    }
}

const INNER: u32 = u32::MAX;
/// Items in a leaf; the last leaf may hold fewer.
const LEAF: usize = 4;
/// Smaller subtrees are built on one thread.
const LARGE: usize = 8192;

impl BoxTree {
    /// The tree over boxes, which are numbered in order. Boxes with a coordinate that is no number are never met.
    pub(super) fn new(boxes: impl Iterator<Item = Bounds>) -> BoxTree {
        let item = |(number, bounds): (usize, Bounds)| Item {
            bounds: Bounds32::around(&bounds),
            number: number as u32,
        };
        let is_number = |bounds: &Bounds| bounds.low.is_finite() && bounds.high.is_finite();
        let mut items: Vec<Item> =
            boxes.enumerate().filter(|(_, bounds)| is_number(bounds)).map(item).collect();
        if items.is_empty() {
            return BoxTree::default();
        }
        let mut nodes = vec![Node::default(); node_count(items.len())];
        build(&mut items, &mut nodes, 0, 0);
        BoxTree { nodes, items }
    }

    /// Calls `each` with the numbers of all boxes that meet `bounds` (or miss it by an f32 rounding), in no useful order.
    pub(super) fn meeting(&self, bounds: &Bounds, mut each: impl FnMut(u32)) {
        let bounds = Bounds32::around(bounds);
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            if !node.bounds.meets(&bounds) {
                next = node.skip as usize;
                continue;
            }
            next += 1;
            if node.first != INNER {
                let items = &self.items[node.first as usize..];
                for item in items.iter().take(LEAF).filter(|item| item.bounds.meets(&bounds)) {
                    each(item.number);
                }
            }
        }
    }
}

/// Nodes of the tree over so many items: every leaf but the last is full.
fn node_count(items: usize) -> usize {
    2 * items.div_ceil(LEAF) - 1
}

/// Builds the tree over `items`, the first of which is number `first`, into `nodes`, the first of which is `place`.
fn build(items: &mut [Item], nodes: &mut [Node], first: usize, place: usize) {
    let all = items.iter().skip(1).fold(items[0].bounds, |all, item| all.join(&item.bounds));
    let skip = (place + nodes.len()) as u32;
    if items.len() <= LEAF {
        nodes[0] = Node { bounds: all, skip, first: first as u32 };
        return;
    }
    nodes[0] = Node { bounds: all, skip, first: INNER };
    let middles = items.iter().fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[low, high], item| {
        let middle = [0, 1, 2].map(|axis| item.bounds.middle(axis));
        [[0, 1, 2].map(|i| low[i].min(middle[i])), [0, 1, 2].map(|i| high[i].max(middle[i]))]
    });
    let spread = DVec3::from([0, 1, 2].map(|i| f64::from(middles[1][i]) - f64::from(middles[0][i])));
    let axis = spread.max_position();
    let half = items.len().div_ceil(LEAF) / 2 * LEAF;
    items.select_nth_unstable_by(half, |a, b| {
        a.bounds.middle(axis).total_cmp(&b.bounds.middle(axis)).then(a.number.cmp(&b.number))
    });
    let count = items.len();
    let (left, right) = items.split_at_mut(half);
    let (left_nodes, right_nodes) = nodes[1..].split_at_mut(node_count(half));
    let right_place = place + 1 + left_nodes.len();
    let mut left = || build(left, left_nodes, first, place + 1);
    let mut right = || build(right, right_nodes, first + half, right_place);
    if count >= LARGE {
        parallel::both(left, right);
    } else {
        left();
        right();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Bounds>> {
        let one = (prop::array::uniform3(-20.0..20.0f64), prop::array::uniform3(0.0..6.0f64));
        prop::collection::vec(
            one.prop_map(|(low, size)| {
                let low = DVec3::from(low).round();
                Bounds { low, high: low + DVec3::from(size).round() }
            }),
            0..70,
        )
    }

    proptest! {
        #[test]
        fn it_finds_what_a_loop_finds(boxes in boxes(), asked in boxes()) {
            let tree = BoxTree::new(boxes.iter().copied());
            for ask in asked {
                // Off the grid, so that the rounding to f32 does not matter.
                let ask = ask.dilated(DVec3::splat(0.25));
                let mut found = Vec::new();
                tree.meeting(&ask, |number| found.push(number));
                found.sort_unstable();
                let expected: Vec<u32> =
                    (0..boxes.len() as u32).filter(|&b| boxes[b as usize].meets(&ask)).collect();
                prop_assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn many_boxes_of_one_place_and_none() {
        let same = Bounds { low: DVec3::ZERO, high: DVec3::ONE };
        let tree = BoxTree::new((0..50_000).map(|_| same));
        let mut count = 0;
        tree.meeting(&same, |_| count += 1);
        assert_eq!(count, 50_000);
        BoxTree::new([].into_iter()).meeting(&same, |_| unreachable!());
        let broken = Bounds { low: DVec3::NAN, high: DVec3::ONE };
        BoxTree::new([broken].into_iter()).meeting(&same, |_| unreachable!());
    }
}
