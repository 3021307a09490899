//! Boxes in a tree, for lines that go on both ways and for boxes that meet them: in f64, and nothing is missed.

use glam::DVec3;

use super::matter::Bounds;

/// Boxes of a leaf.
const FEW: usize = 8;

/// A node: its box, and either its two halves or the boxes of a leaf.
struct Node {
    bounds: Bounds,
    /// Of a leaf the first of its items in [`Index::order`], else of its halves, which follow each other.
    first: u32,
    /// How many items; 0 if it has halves.
    count: u32,
}

/// A tree over boxes: halves of what is sorted along the longest axis, so that it is never deep.
pub(super) struct Index {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Index {
    pub(super) fn new(boxes: &[Bounds]) -> Index {
        let mut index = Index { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        let around =
            |items: &[u32]| items.iter().fold(Bounds::EMPTY, |all, &i| all.union(&boxes[i as usize]));
        index.nodes.push(Node { bounds: around(&index.order), first: 0, count: 0 });
        let mut todo = vec![(0usize, 0usize, boxes.len())];
        while let Some((node, start, end)) = todo.pop() {
            let items = &mut index.order[start..end];
            if items.len() <= FEW {
                (index.nodes[node].first, index.nodes[node].count) = (start as u32, items.len() as u32);
                continue;
            }
            let bounds = index.nodes[node].bounds;
            let size = bounds.hi - bounds.lo;
            let axis = (0..3).fold(0, |best, axis| if size[axis] > size[best] { axis } else { best });
            let middle = |i: u32| boxes[i as usize].lo[axis] + boxes[i as usize].hi[axis];
            let half = items.len() / 2;
            items.select_nth_unstable_by(half, |&a, &b| middle(a).total_cmp(&middle(b)).then(a.cmp(&b)));
            let (one, other) = (around(&items[..half]), around(&items[half..]));
            let first = index.nodes.len();
            index.nodes[node].first = first as u32;
            index.nodes.extend([one, other].map(|bounds| Node { bounds, first: 0, count: 0 }));
            todo.extend([(first, start, start + half), (first + 1, start + half, end)]);
        }
        index
    }

    /// The items of all leaves whose box passes a test, and so do those around it.
    fn visit(&self, passes: impl Fn(&Bounds) -> bool, mut each: impl FnMut(u32)) {
        let mut todo = vec![0u32];
        while let Some(node) = todo.pop() {
            let node = &self.nodes[node as usize];
            if !passes(&node.bounds) {
                continue;
            }
            if node.count > 0 {
                let first = node.first as usize;
                self.order[first..first + node.count as usize].iter().for_each(|&item| each(item));
            } else if node.first > 0 {
                todo.extend([node.first, node.first + 1]);
            }
        }
    }

    /// Items that the line through `start` along `direction` may come to, either way.
    pub(super) fn along(&self, start: DVec3, direction: DVec3, each: impl FnMut(u32)) {
        self.visit(|bounds| bounds.may_be_crossed(start, direction), each);
    }

    /// Items that may meet a box.
    pub(super) fn within(&self, bounds: &Bounds, each: impl FnMut(u32)) {
        self.visit(|own| own.meets(bounds), each);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_missed() {
        let mut state = 1u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut point = || DVec3::new(number(), number(), number());
        let boxes: Vec<Bounds> = (0..500)
            .map(|_| {
                let lo = point() * 10.0;
                Bounds { lo, hi: lo + point() * 0.8 }
            })
            .collect();
        let index = Index::new(&boxes);
        for i in 0..200 {
            let start = point() * 10.0;
            let direction = match i % 4 {
                0 => DVec3::X,
                1 => DVec3::Z,
                _ => (point() - 0.5).normalize(),
            };
            let wanted = |b: &Bounds| b.may_be_crossed(start, direction);
            let mut found = Vec::new();
            index.along(start, direction, |item| {
                if wanted(&boxes[item as usize]) {
                    found.push(item)
                }
            });
            found.sort_unstable();
            let all: Vec<u32> = (0..500).filter(|&i| wanted(&boxes[i as usize])).collect();
            assert_eq!(found, all);
            let around = Bounds { lo: start, hi: start + 1.0 };
            let mut found = Vec::new();
            index.within(&around, |item| {
                if boxes[item as usize].meets(&around) {
                    found.push(item)
                }
            });
            found.sort_unstable();
            let all: Vec<u32> = (0..500).filter(|&i| boxes[i as usize].meets(&around)).collect();
            assert_eq!(found, all);
        }
        Index::new(&[]).within(&boxes[0], |_| panic!("there is nothing"));
    }
}
