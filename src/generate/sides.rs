//! What lies side by side in a plan: over each edge, the stacks to its left and to its right.

use std::collections::BTreeMap;

use super::plan::{Layer, Plan};

/// The edges of a plan with the columns that they belong to.
pub struct Sides<'a> {
    plan: &'a Plan,
    /// The column to the left of each directed edge.
    left: BTreeMap<[u32; 2], usize>,
}

/// A stretch of height over a directed edge in which what is to its left differs from what is to its right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Its lower ends, over the edge's start and end.
    pub low: [i32; 2],
    /// Its upper ends.
    pub high: [i32; 2],
    /// To the left.
    pub label: Option<u32>,
    /// To the right.
    pub other: Option<u32>,
}

impl<'a> Sides<'a> {
    /// The edges of `plan`.
    pub fn of(plan: &'a Plan) -> Sides<'a> {
        let edges = plan.columns.iter().enumerate();
        Sides { plan, left: edges.flat_map(|(i, c)| c.edges.iter().map(move |&e| (e, i))).collect() }
    }

    /// All directed edges, in order, with what differs over them.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; 2], Vec<Span>)> + '_ {
        self.left.iter().map(|(&[u, v], &own)| {
            let across = self.left.get(&[v, u]).map_or(&[][..], |&other| &self.plan.columns[other].layers);
            let ends = [u, v].map(|i| self.plan.points[i as usize]);
            ([u, v], spans(self.plan.bottom, &self.plan.columns[own].layers, across, ends))
        })
    }

    /// The directed edges without a column to their right.
    pub fn unmatched(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.left.keys().copied().filter(|&[u, v]| !self.left.contains_key(&[v, u]))
    }
}

/// The stretches over the edge from `p` to `q` in which two stacks have different labels. Their layers do not cross
/// over the edge.
fn spans(bottom: i32, own: &[Layer], across: &[Layer], ends: [[i32; 2]; 2]) -> Vec<Span> {
    let at = |layer: &Layer| ends.map(|end| layer.top.at(end));
    let mut spans = Vec::new();
    let (mut i, mut j, mut low) = (0, 0, [bottom; 2]);
    // Above its own top nothing of this column is left to have a face.
    while let Some(layer) = own.get(i) {
        let other = across.get(j);
        let (mine, theirs) = (at(layer), other.map(at));
        let high = theirs.map_or(mine, |t| [mine[0].min(t[0]), mine[1].min(t[1])]);
        debug_assert!(high == mine || Some(high) == theirs, "layers cross over an edge: {mine:?} {theirs:?}");
        let beyond = other.and_then(|o| o.label);
        if high != low && layer.label != beyond {
            spans.push(Span { low, high, label: layer.label, other: beyond });
        }
        low = high;
        i += usize::from(mine == high);
        j += usize::from(theirs == Some(high));
        // Layers that cross: without this there would be no end.
        if mine != high && theirs != Some(high) {
            i += 1;
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::plan::{Slope, Top};

    #[test]
    fn stacks_are_compared_from_the_bottom_up() {
        let layer = |z, label| Layer { top: Top::Level(z), label };
        let own = [layer(10, Some(1)), layer(20, None), layer(30, Some(1))];
        let across = [layer(5, Some(1)), layer(25, Some(2))];
        let ends = [[0, 0], [4, 0]];
        let found: Vec<_> =
            spans(0, &own, &across, ends).iter().map(|s| (s.low[0], s.high[0], s.label, s.other)).collect();
        assert_eq!(
            found,
            [
                (5, 10, Some(1), Some(2)),
                (10, 20, None, Some(2)),
                (20, 25, Some(1), Some(2)),
                (25, 30, Some(1), None)
            ]
        );
        assert_eq!(spans(0, &own, &own, ends), []);
    }

    #[test]
    fn a_slope_that_dies_into_a_level_leaves_a_triangle() {
        let slope = Top::Slope(Slope { run: [1, 0], rise: 10, per: 1 });
        let own = [Layer { top: slope, label: Some(1) }];
        let across =
            [Layer { top: Top::Level(10), label: Some(1) }, Layer { top: Top::Level(30), label: Some(2) }];
        let found = spans(0, &own, &across, [[0, 0], [4, 0]]);
        let triangle = Span { low: [10, 10], high: [10, 14], label: Some(1), other: Some(2) };
        assert_eq!(found, [triangle]);
    }
}
