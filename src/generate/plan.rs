//! Space as a plan of columns: a subdivision of the plane into regions, and over each region a stack of labelled
//! layers.
//!
//! A plan is the drawing from which closed volumes are taken ([`patches`](super::patches::patches)): since every
//! piece of space has one label, the volumes of all labels fill the space exactly and overlap nowhere. Regions may
//! have any outlines with corners on the grid; [`Plan::of_paints`] makes them of rectangles, and
//! [`compose`](super::compose::compose) of several plans.

use std::collections::BTreeMap;

use super::lattice::{Cuboid, Rect};

/// The upper side of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Top {
    /// At this height, units.
    Level(i32),
    /// In a sloped plane.
    Slope(Slope),
}

/// The plane z = (x·`run[0]` + y·`run[1]` + `rise`) / `per`, which is to meet the grid at every corner over which it
/// lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Slope {
    /// Rise along x and y.
    pub run: [i32; 2],
    /// What is added.
    pub rise: i64,
    /// What it all is divided by: not zero, positive.
    pub per: i32,
}

impl Slope {
    /// `per` times the height over a point.
    fn scaled(&self, [x, y]: [i32; 2]) -> i64 {
        i64::from(self.run[0]) * i64::from(x) + i64::from(self.run[1]) * i64::from(y) + self.rise
    }
}

impl Top {
    /// Its height over a point of the plan, units.
    pub fn at(&self, point: [i32; 2]) -> i32 {
        match self {
            Top::Level(z) => *z,
            Top::Slope(slope) => {
                let scaled = slope.scaled(point);
                debug_assert!(scaled % i64::from(slope.per) == 0, "{slope:?} is off the grid at {point:?}");
                scaled.div_euclid(i64::from(slope.per)) as i32
            }
        }
    }

    /// The plane raised by `height`.
    fn raised(self, height: i32) -> Top {
        match self {
            Top::Level(z) => Top::Level(z + height),
            Top::Slope(slope) => {
                Top::Slope(Slope { rise: slope.rise + i64::from(height) * i64::from(slope.per), ..slope })
            }
        }
    }
}

/// A layer of a column, from the top of the layer below it to its own top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Layer {
    /// Its top.
    pub top: Top,
    /// What it belongs to; `None` for space outside the drawing.
    pub label: Option<u32>,
}

/// A region of the plane and the layers over it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its outlines and those of its holes as directed edges, the region to their left, as indices of
    /// [`Plan::points`].
    pub edges: Vec<[u32; 2]>,
    /// From the bottom to the top, tops rising, labels of neighbours different.
    pub layers: Vec<Layer>,
}

/// A subdivision of a part of the plane into columns. Columns meet along whole edges: where one has a corner on
/// the edge of another, the corner is in both.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// Corners, units.
    pub points: Vec<[i32; 2]>,
    /// Height of the bottom of all columns, units.
    pub bottom: i32,
    /// The columns.
    pub columns: Vec<Column>,
}

/// A prism over a rectangle, to be painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Paint {
    /// Its plan.
    pub rect: Rect,
    /// Its lower and its upper side, which do not cross over the rectangle.
    pub sides: [Top; 2],
    /// What it belongs to; `None` takes matter away.
    pub label: Option<u32>,
}

impl From<(Cuboid, Option<u32>)> for Paint {
    fn from((Cuboid { lo, hi }, label): (Cuboid, Option<u32>)) -> Paint {
        let rect = Cuboid { lo, hi }.plan();
        Paint { rect, sides: [Top::Level(lo[2]), Top::Level(hi[2])], label }
    }
}

impl Plan {
    /// The plan that boxes make, painted one over the other: where boxes overlap, the last counts. The label `None`
    /// takes matter away. Empty boxes count for nothing.
    pub fn of_boxes(boxes: &[(Cuboid, Option<u32>)]) -> Plan {
        let paints: Vec<Paint> =
            boxes.iter().filter(|(c, _)| !c.is_empty()).map(|&painted| painted.into()).collect();
        let Some(bottom) = boxes.iter().filter(|(c, _)| !c.is_empty()).map(|(c, _)| c.lo[2]).min() else {
            return Plan::default();
        };
        Plan::of_paints(&paints, bottom)
    }

    /// The plan that prisms make, painted one over the other: where they overlap, the last counts. No two of their
    /// sides cross over a piece of plan that all edges of the rectangles cut out. Nothing reaches below `bottom`.
    pub fn of_paints(paints: &[Paint], bottom: i32) -> Plan {
        let paints: Vec<&Paint> = paints.iter().filter(|p| !p.rect.is_empty()).collect();
        let xs = cuts(paints.iter().flat_map(|p| [p.rect.lo[0], p.rect.hi[0]]));
        let ys = cuts(paints.iter().flat_map(|p| [p.rect.lo[1], p.rect.hi[1]]));
        if xs.len() < 2 || ys.len() < 2 {
            return Plan::default();
        }
        Grid { xs, ys }.plan(&paints, bottom, false)
    }

    /// As [`Plan::of_paints`], of a drawing that will be rolled around a center: y counts the `facets`, between which
    /// lines of equal x will bend.
    pub fn of_rolled(paints: &[Paint], bottom: i32, facets: i32) -> Plan {
        let paints: Vec<&Paint> = paints.iter().filter(|p| !p.rect.is_empty()).collect();
        let xs = cuts(paints.iter().flat_map(|p| [p.rect.lo[0], p.rect.hi[0]]));
        if xs.len() < 2 || facets < 1 {
            return Plan::default();
        }
        Grid { xs, ys: (0..=facets).collect() }.plan(&paints, bottom, true)
    }

    /// The plan with its points moved by `place`, which must keep the orientation, and be injective; where it does
    /// not keep lines straight, they bend at corners of the plan only.
    pub fn moved(mut self, place: impl Fn([i32; 2]) -> [i32; 2]) -> Plan {
        self.points.iter_mut().for_each(|p| *p = place(*p));
        self
    }

    /// The plan raised by `height`.
    pub fn raised(mut self, height: i32) -> Plan {
        self.bottom += height;
        self.columns.iter_mut().flat_map(|c| &mut c.layers).for_each(|layer| {
            layer.top = layer.top.raised(height);
        });
        self
    }
}

/// The lines that cut a plan into rectangles.
struct Grid {
    xs: Vec<i32>,
    ys: Vec<i32>,
}

impl Grid {
    /// Rectangles from west to east.
    fn width(&self) -> usize {
        self.xs.len() - 1
    }

    /// The stack over each rectangle, row by row from the south, by its number among all stacks in use.
    fn stacks(&self, paints: &[&Paint], bottom: i32) -> (Vec<u32>, Vec<Vec<Layer>>) {
        let width = self.width();
        let mut over: Vec<Vec<u32>> = vec![Vec::new(); width * (self.ys.len() - 1)];
        let place = |cuts: &[i32], at: i32| cuts.partition_point(|&c| c < at);
        for (index, paint) in paints.iter().enumerate() {
            let Rect { lo, hi } = paint.rect;
            for j in place(&self.ys, lo[1])..place(&self.ys, hi[1]) {
                for i in place(&self.xs, lo[0])..place(&self.xs, hi[0]) {
                    over[j * width + i].push(index as u32);
                }
            }
        }
        let mut numbers: BTreeMap<Vec<Layer>, u32> = BTreeMap::new();
        let mut stacks = Vec::new();
        let cell_stacks = over.iter().enumerate().map(|(cell, over)| {
            let (i, j) = (cell % width, cell / width);
            let corners = [[self.xs[i], self.ys[j]], [self.xs[i + 1], self.ys[j + 1]]];
            let layers = stack(bottom, over.iter().map(|&p| paints[p as usize]), corners);
            *numbers.entry(layers).or_insert_with_key(|layers| {
                stacks.push(layers.clone());
                stacks.len() as u32 - 1
            })
        });
        (cell_stacks.collect(), stacks)
    }

    /// One column for each stack in use: rectangles with the same stack are one region.
    fn plan(&self, paints: &[&Paint], bottom: i32, rolled: bool) -> Plan {
        let (cells, stacks) = self.stacks(paints, bottom);
        let (width, height) = (self.width(), self.ys.len() - 1);
        let corner = |i: usize, j: usize| (j * (width + 1) + i) as u32;
        let mut edges: Vec<Vec<[u32; 2]>> = vec![Vec::new(); stacks.len()];
        for j in 0..height {
            for i in 0..width {
                let own = cells[j * width + i];
                let differs = |i: Option<usize>, j: Option<usize>| match (i, j) {
                    (Some(i), Some(j)) if i < width && j < height => cells[j * width + i] != own,
                    _ => true,
                };
                let (here, row) = (Some(i), Some(j));
                let sides = [
                    (differs(here, j.checked_sub(1)), [corner(i, j), corner(i + 1, j)]),
                    (differs(Some(i + 1), row), [corner(i + 1, j), corner(i + 1, j + 1)]),
                    (differs(here, Some(j + 1)), [corner(i + 1, j + 1), corner(i, j + 1)]),
                    (differs(i.checked_sub(1), row), [corner(i, j + 1), corner(i, j)]),
                ];
                let outline = sides.into_iter().filter(|(differs, _)| *differs).map(|(_, edge)| edge);
                edges[own as usize].extend(outline);
            }
        }
        let points = self.ys.iter().flat_map(|&y| self.xs.iter().map(move |&x| [x, y])).collect();
        let columns = edges.into_iter().zip(stacks).map(|(edges, layers)| Column { edges, layers });
        let columns = columns.filter(|column| !column.layers.is_empty()).collect();
        straightened(Plan { points, bottom, columns }, rolled)
    }
}

/// The plan without the points through which only one straight line goes, and without those that no edge uses. If it
/// is to be rolled, lines of equal x keep their points.
fn straightened(plan: Plan, rolled: bool) -> Plan {
    let none = u32::MAX;
    // The two neighbours of each point, or that there are more.
    let mut neighbours = vec![([none; 2], false); plan.points.len()];
    for &[u, v] in plan.columns.iter().flat_map(|c| &c.edges) {
        for (at, other) in [(u, v), (v, u)] {
            let (known, more) = &mut neighbours[at as usize];
            match known.iter_mut().find(|k| **k == none || **k == other) {
                Some(place) => *place = other,
                None => *more = true,
            }
        }
    }
    let is_straight = |at: u32| {
        let ([a, b], more) = neighbours[at as usize];
        let [p, q, r] = [a, at, b].map(|i| plan.points.get(i as usize).map(|p| p.map(i64::from)));
        match (more, p, q, r) {
            (false, Some(p), Some(q), Some(r)) if !rolled || p[0] != q[0] => {
                (q[0] - p[0]) * (r[1] - p[1]) == (q[1] - p[1]) * (r[0] - p[0])
            }
            _ => false,
        }
    };
    let straight: Vec<bool> = (0..plan.points.len() as u32).map(is_straight).collect();
    let mut new_index = vec![none; plan.points.len()];
    let mut points = Vec::new();
    for (i, point) in plan.points.iter().enumerate() {
        if !straight[i] && neighbours[i].0[0] != none {
            new_index[i] = points.len() as u32;
            points.push(*point);
        }
    }
    let end_of = |[u, v]: [u32; 2]| {
        let (mut before, mut at) = (u, v);
        while straight[at as usize] {
            let [a, b] = neighbours[at as usize].0;
            (before, at) = (at, if a == before { b } else { a });
        }
        at
    };
    let columns = plan.columns.iter().map(|column| {
        let starts = column.edges.iter().filter(|[u, _]| !straight[*u as usize]);
        let edges = starts.map(|&edge| [edge[0], end_of(edge)].map(|i| new_index[i as usize])).collect();
        Column { edges, layers: column.layers.clone() }
    });
    Plan { columns: columns.collect(), points, bottom: plan.bottom }
}

/// The values in order, each once.
fn cuts(values: impl Iterator<Item = i32>) -> Vec<i32> {
    let mut values: Vec<i32> = values.collect();
    values.sort_unstable();
    values.dedup();
    values
}

/// The layers that prisms make over a rectangle, painted one over the other; without empty space at the top.
pub fn stack<'a>(
    bottom: i32,
    over: impl Iterator<Item = &'a Paint> + Clone,
    corners: [[i32; 2]; 2],
) -> Vec<Layer> {
    // Planes do not cross over the rectangle: the heights over its middle tell their order, doubled to be whole.
    let [a, b] = corners;
    let middle = |top: &Top| -> (i64, i64) {
        match top {
            Top::Level(z) => (4 * i64::from(*z), 1),
            Top::Slope(s) => {
                let ends = [a, b, [a[0], b[1]], [b[0], a[1]]];
                (ends.iter().map(|&p| s.scaled(p)).sum(), i64::from(s.per))
            }
        }
    };
    let above = |top: &Top| {
        let (scaled, per) = middle(top);
        // Rounded down to a thousandth of a unit: planes that far apart do not occur.
        scaled * 250 / per
    };
    let mut heights: Vec<(i64, Top)> = over
        .clone()
        .flat_map(|p| p.sides)
        .chain([Top::Level(bottom)])
        .map(|top| (above(&top), top))
        .collect();
    heights.sort_unstable();
    heights.dedup_by_key(|(height, _)| *height);
    let spans: Vec<(i64, i64, Option<u32>)> =
        over.map(|p| (above(&p.sides[0]), above(&p.sides[1]), p.label)).collect();
    let mut layers: Vec<Layer> = Vec::new();
    for z in heights.windows(2) {
        let painted = spans.iter().rfind(|(lo, hi, _)| *lo <= z[0].0 && z[1].0 <= *hi);
        let label = painted.and_then(|(_, _, label)| *label);
        let top = z[1].1;
        match layers.last_mut() {
            Some(below) if below.label == label => below.top = top,
            _ => layers.push(Layer { top, label }),
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

    fn corners(plan: &Plan, column: &Column) -> Vec<[i32; 2]> {
        let mut found: Vec<_> = column.edges.iter().map(|e| plan.points[e[0] as usize]).collect();
        found.sort_unstable();
        found
    }

    #[test]
    fn the_last_paint_counts() {
        let all = Cuboid { lo: [0, 0, 0], hi: [10, 10, 10] };
        let inner = Cuboid { lo: [2, 2, 5], hi: [8, 8, 10] };
        let plan =
            Plan::of_boxes(&[(all, Some(1)), (inner, None), (all, None), (all, Some(1)), (inner, Some(2))]);
        // A square, and the frame around it as one region with a hole.
        assert_eq!(plan.columns.len(), 2);
        let (frame, middle) = (&plan.columns[0], &plan.columns[1]);
        assert_eq!(corners(&plan, middle), [[2, 2], [2, 8], [8, 2], [8, 8]]);
        assert_eq!(
            middle.layers,
            [Layer { top: Top::Level(5), label: Some(1) }, Layer { top: Top::Level(10), label: Some(2) }]
        );
        assert_eq!(frame.edges.len(), 8);
        assert_eq!(frame.layers, [Layer { top: Top::Level(10), label: Some(1) }]);
        assert_eq!(plan.points.len(), 8);
    }

    #[test]
    fn matter_taken_away_leaves_no_column() {
        let all = Cuboid { lo: [0, 0, 0], hi: [10, 10, 10] };
        let hole = Cuboid { lo: [2, 2, 0], hi: [8, 8, 10] };
        let dent = Cuboid { lo: [0, 0, 4], hi: [2, 2, 10] };
        let plan = Plan::of_boxes(&[(all, Some(1)), (hole, None), (dent, None)]);
        assert_eq!(plan.columns.len(), 2);
        let low = plan.columns.iter().find(|c| c.edges.len() == 4).unwrap();
        assert_eq!(corners(&plan, low), [[0, 0], [0, 2], [2, 0], [2, 2]]);
        assert_eq!(low.layers, [Layer { top: Top::Level(4), label: Some(1) }]);
        assert_eq!(Plan::of_boxes(&[]), Plan::default());
        let raised = plan.clone().raised(3);
        let low = raised.columns.iter().find(|c| c.edges.len() == 4).unwrap();
        assert_eq!((raised.bottom, low.layers[0].top), (3, Top::Level(7)));
    }

    #[test]
    fn a_roof_slopes() {
        let rect = Rect { lo: [0, 0], hi: [8, 8] };
        let slope = Slope { run: [0, 1], rise: 8, per: 2 };
        let level = |z| Top::Level(z);
        let paints = [
            Paint { rect, sides: [level(0), level(20)], label: Some(0) },
            Paint { rect, sides: [level(2), Top::Slope(slope)], label: Some(1) },
        ];
        let plan = Plan::of_paints(&paints, 0);
        assert_eq!(plan.columns.len(), 1);
        let tops: Vec<_> = plan.columns[0].layers.iter().map(|l| (l.top, l.label)).collect();
        assert_eq!(tops, [(level(2), Some(0)), (Top::Slope(slope), Some(1)), (level(20), Some(0))]);
        assert_eq!((tops[1].0.at([0, 0]), tops[1].0.at([3, 8])), (4, 8));
    }
}
