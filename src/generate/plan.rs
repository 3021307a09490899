//! Space as a plan of columns: a subdivision of the plane into polygons, and over each polygon a stack of labelled
//! layers.
//!
//! A plan is the drawing from which closed volumes are taken ([`patches`](super::patches::patches)): since every
//! piece of space has one label, the volumes of all labels fill the space exactly and overlap nowhere. Columns may
//! be any polygons with corners on the grid; [`Plan::of_boxes`] makes rectangles.

use super::lattice::Cuboid;

/// A layer of a column, from the top of the layer below it to its own top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layer {
    /// Height of its top, units.
    pub top: i32,
    /// What it belongs to; `None` for space outside the drawing.
    pub label: Option<u32>,
}

/// A polygon of the plane and the layers over it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Corners, counter-clockwise, as indices of [`Plan::points`].
    pub ring: Vec<u32>,
    /// From the bottom to the top, tops rising, labels of neighbours different.
    pub layers: Vec<Layer>,
}

/// A subdivision of a part of the plane into columns. Columns meet along whole edges: where one has a corner on
/// the edge of another, the corner is in both rings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Corners, units.
    pub points: Vec<[i32; 2]>,
    /// Height of the bottom of all columns, units.
    pub bottom: i32,
    /// The columns.
    pub columns: Vec<Column>,
}

impl Plan {
    /// The plan that boxes make, painted one over the other: where boxes overlap, the last counts. The label `None`
    /// takes matter away. Empty boxes count for nothing.
    pub fn of_boxes(boxes: &[(Cuboid, Option<u32>)]) -> Plan {
        let boxes: Vec<_> = boxes.iter().filter(|(cuboid, _)| !cuboid.is_empty()).collect();
        let xs = cuts(boxes.iter().flat_map(|(c, _)| [c.lo[0], c.hi[0]]));
        let ys = cuts(boxes.iter().flat_map(|(c, _)| [c.lo[1], c.hi[1]]));
        let Some(bottom) = boxes.iter().map(|(c, _)| c.lo[2]).min() else { return Plan::default() };
        let points = ys.iter().flat_map(|&y| xs.iter().map(move |&x| [x, y])).collect();
        let mut columns = Vec::new();
        for (j, y) in ys.windows(2).enumerate() {
            for (i, x) in xs.windows(2).enumerate() {
                let over = boxes.iter().filter(|(c, _)| {
                    c.lo[0] <= x[0] && x[1] <= c.hi[0] && c.lo[1] <= y[0] && y[1] <= c.hi[1]
                });
                let layers = stack(bottom, over.map(|(c, label)| (c.lo[2], c.hi[2], *label)));
                if !layers.is_empty() {
                    let corner = |i: usize, j: usize| (j * xs.len() + i) as u32;
                    let ring = vec![corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                    columns.push(Column { ring, layers });
                }
            }
        }
        Plan { points, bottom, columns }
    }

    /// The plan with its points moved by `place`, which must keep the orientation, and be injective and linear up
    /// to a shift, so that edges that meet still do.
    pub fn moved(mut self, place: impl Fn([i32; 2]) -> [i32; 2]) -> Plan {
        self.points.iter_mut().for_each(|p| *p = place(*p));
        self
    }

    /// The plan raised by `height`.
    pub fn raised(mut self, height: i32) -> Plan {
        self.bottom += height;
        self.columns.iter_mut().flat_map(|c| &mut c.layers).for_each(|layer| layer.top += height);
        self
    }
}

/// The values in order, each once.
fn cuts(values: impl Iterator<Item = i32>) -> Vec<i32> {
    let mut values: Vec<i32> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

/// The layers that spans of height make, painted one over the other; without empty space at the top.
fn stack(bottom: i32, spans: impl Iterator<Item = (i32, i32, Option<u32>)> + Clone) -> Vec<Layer> {
    let heights = cuts(spans.clone().flat_map(|(lo, hi, _)| [lo, hi]).chain([bottom]));
    let mut layers: Vec<Layer> = Vec::new();
    for z in heights.windows(2) {
        let painted = spans.clone().filter(|(lo, hi, _)| *lo <= z[0] && z[1] <= *hi);
        let label = painted.last().and_then(|(_, _, label)| label);
        match layers.last_mut() {
            Some(below) if below.label == label => below.top = z[1],
            _ => layers.push(Layer { top: z[1], label }),
        }
    }
    if layers.last().is_some_and(|top| top.label.is_none()) {
        layers.pop();
    }
    layers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_paint_counts() {
        let all = Cuboid { lo: [0, 0, 0], hi: [10, 10, 10] };
        let inner = Cuboid { lo: [2, 2, 5], hi: [8, 8, 10] };
        let plan =
            Plan::of_boxes(&[(all, Some(1)), (inner, None), (all, None), (all, Some(1)), (inner, Some(2))]);
        assert_eq!(plan.columns.len(), 9);
        let middle = &plan.columns[4];
        assert_eq!(
            middle.ring.iter().map(|&p| plan.points[p as usize]).collect::<Vec<_>>(),
            [[2, 2], [8, 2], [8, 8], [2, 8]]
        );
        assert_eq!(middle.layers, [Layer { top: 5, label: Some(1) }, Layer { top: 10, label: Some(2) }]);
        assert_eq!(plan.columns[0].layers, [Layer { top: 10, label: Some(1) }]);
    }

    #[test]
    fn matter_taken_away_leaves_no_column() {
        let all = Cuboid { lo: [0, 0, 0], hi: [10, 10, 10] };
        let hole = Cuboid { lo: [2, 2, 0], hi: [8, 8, 10] };
        let dent = Cuboid { lo: [0, 0, 4], hi: [2, 2, 10] };
        let plan = Plan::of_boxes(&[(all, Some(1)), (hole, None), (dent, None)]);
        assert_eq!(plan.columns.len(), 8);
        assert_eq!(plan.columns[0].layers, [Layer { top: 4, label: Some(1) }]);
        assert_eq!(Plan::of_boxes(&[]), Plan::default());
        let raised = plan.clone().raised(3);
        assert_eq!((raised.bottom, raised.columns[0].layers[0].top), (3, 7));
    }
}
