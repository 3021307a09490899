//! Slabs: the hull cut at the few levels that carry much area, and the faces of the bodies in each.
//!
//! A *face* of a slab is what one body has in one plane; its boundary is a *chain* of signed plan edges. Crossing an edge of
//! the chain in the plan goes on or off the face. Where a body is cut by the slab's lower level, a cap closes it: the
//! cut itself is the cap's chain. Moving vertices keeps every chain closed, whatever it does to the faces' shapes.

use std::collections::{BTreeMap, HashSet};

use super::bodies::Vertex;
use super::faces::{Lie, Triangle};
use crate::lattice::{Lattice, Plane, Point};

/// A face: what one body has in one plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct SlabFace {
    pub(super) plane: Plane,
    pub(super) body: u32,
}

/// What a slab holds, before anything is rounded.
#[derive(Debug)]
pub(super) struct Slab {
    /// Segments of the plan; the first four are the hull's sides.
    pub(super) segments: Vec<[Point; 2]>,
    pub(super) faces: Vec<SlabFace>,
    /// (segment, face, how often the face lies on its left less on its right)
    pub(super) chains: Vec<(u32, u32, i32)>,
    /// Pieces of sloped and level faces, for their intersections: index of the face and the polygon.
    pub(super) pieces: Vec<(u32, Vec<Point>)>,
}

/// A level counts as a storey's if it carries this share of the area of the level that carries most.
const SHARE: f64 = 0.3;
/// Levels are at least so far apart, metres.
const APART: f64 = 0.15;

/// A slab whose triangles have more edges than this in the plan is cut again: in the plans of storeys that are not quite alike every wall
/// crosses every other, so that work grows by the square of their number.
const CROWDED: usize = 24_000;
/// But only where neither half has more than this share of them.
const LESS: f64 = 0.8;

/// By level: how much the faces that look up have in it, twice.
fn level_areas(triangles: &[Triangle]) -> BTreeMap<i32, i128> {
    let mut area: BTreeMap<i32, i128> = BTreeMap::new();
    for t in triangles {
        if let Lie::Flat(plane) = t.lie
            && plane.is_level()
            && t.double_area() > 0
        {
            *area.entry(t.corners[0].z).or_default() += i128::from(t.double_area());
        }
    }
    area
}

/// The levels at which the hull is cut, from its bottom to its top.
pub(super) fn choose_levels(triangles: &[Triangle], hull: [[i32; 3]; 2], lattice: &Lattice) -> Vec<i32> {
    let area = level_areas(triangles);
    let most = area.values().copied().max().unwrap_or(0);
    let mut candidates: Vec<(i128, i32)> = area
        .iter()
        .map(|(&z, &area)| (area, z))
        .filter(|&(area, _)| area as f64 >= SHARE * most as f64)
        .collect();
    candidates.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
    let apart = lattice.steps(APART) as i32;
    let mut levels = vec![hull[0][2], hull[1][2]];
    for (_, z) in candidates {
        if levels.iter().all(|l| (l - z).abs() >= apart) {
            levels.push(z);
        }
    }
    levels.sort_unstable();
    let mut done = vec![levels[0]];
    let mut waiting: Vec<[i32; 2]> = levels.windows(2).rev().map(|w| [w[0], w[1]]).collect();
    while let Some([low, high]) = waiting.pop() {
        let whole = plan_edges(triangles, [low, high]);
        let most = LESS * whole as f64;
        let helps =
            |&z: &i32| [[low, z], [z, high]].iter().all(|half| plan_edges(triangles, *half) as f64 <= most);
        let cut = (whole > CROWDED).then(|| middle_levels(&area, [low, high], apart).into_iter().find(helps));
        match cut.flatten() {
            Some(z) => waiting.extend([[z, high], [low, z]]),
            None => done.push(high),
        }
    }
    done
}

/// Levels between two, far enough from both, of those that carry at least half as much as the one that carries most: the nearest to their
/// middle, some of them.
fn middle_levels(area: &BTreeMap<i32, i128>, [low, high]: [i32; 2], apart: i32) -> Vec<i32> {
    let inside =
        || area.iter().filter(|(z, _)| **z >= low.saturating_add(apart) && **z <= high.saturating_sub(apart));
    let Some(most) = inside().map(|(_, &area)| area).max() else { return Vec::new() };
    let mut large: Vec<i32> = inside().filter(|(_, area)| **area * 2 >= most).map(|(&z, _)| z).collect();
    large.sort_by_key(|&z| (2 * i64::from(z) - i64::from(low) - i64::from(high)).abs());
    large.truncate(8);
    large
}

/// How many edges the triangles between two levels have in the plan: no fewer than there are segments, but for those of cuts.
fn plan_edges(triangles: &[Triangle], [low, high]: [i32; 2]) -> usize {
    let mut segments = HashSet::new();
    for t in triangles {
        let [bottom, top] = t.rise();
        if bottom < high && top > low {
            for i in 0..3 {
                let [a, b] = [t.corners[i], t.corners[(i + 1) % 3]].map(|c| (c.at.x, c.at.y));
                if a != b {
                    segments.insert([a.min(b), a.max(b)]);
                }
            }
        }
    }
    segments.len()
}

/// The slab between two levels.
pub(super) fn cut(triangles: &[Triangle], levels: [i32; 2], hull: [[i32; 3]; 2]) -> Slab {
    let [lo, hi] = [0, 1].map(|end| Point::new(hull[end][0], hull[end][1]));
    let corners = [lo, Point::new(hi.x, lo.y), hi, Point::new(lo.x, hi.y)];
    let mut draft = Draft::default();
    for i in 0..4 {
        draft.segment(corners[i], corners[(i + 1) % 4]);
    }
    for t in triangles {
        draft.add(t, levels);
    }
    draft.finish()
}

#[derive(Default)]
struct Draft {
    segments: Vec<[Point; 2]>,
    index: BTreeMap<[Point; 2], u32>,
    faces: BTreeMap<SlabFace, u32>,
    chains: Vec<(u32, u32, i32)>,
    pieces: Vec<(u32, Vec<Point>)>,
}

impl Draft {
    /// Index of the segment between two points, and whether it runs as given; `None` between equal points.
    fn segment(&mut self, a: Point, b: Point) -> Option<(u32, bool)> {
        if a == b {
            return None;
        }
        let key = if a < b { [a, b] } else { [b, a] };
        let next = self.segments.len() as u32;
        let index = *self.index.entry(key).or_insert(next);
        if index == next {
            self.segments.push(key);
        }
        Some((index, a < b))
    }

    fn face(&mut self, body: u32, plane: Plane) -> u32 {
        let next = self.faces.len() as u32;
        *self.faces.entry(SlabFace { plane, body }).or_insert(next)
    }

    fn link(&mut self, face: u32, a: Point, b: Point) {
        if let Some((segment, forward)) = self.segment(a, b) {
            self.chains.push((segment, face, if forward { 1 } else { -1 }));
        }
    }

    fn add(&mut self, t: &Triangle, levels: [i32; 2]) {
        let [low, high] = t.rise();
        let [bottom, top] = levels;
        if high <= bottom || low >= top {
            return;
        }
        if low <= bottom {
            self.cap(t, bottom);
        }
        let polygon = clip(t.corners, levels);
        if polygon.len() < 3 {
            return;
        }
        let plane = match t.lie {
            Lie::Flat(plane) => plane,
            // It has no area, but where roundings lead its lower and its upper edge past different sides of a point, it
            // closes what is between them. Without it matter would go on upwards there.
            Lie::Vertical => replacement(t, &polygon, true),
            Lie::Sheet => {
                // Matter shrinks, labels grow.
                let looks_up = t.double_area() > 0;
                replacement(t, &polygon, looks_up == t.is_solid)
            }
        };
        let face = self.face(t.body, plane);
        for i in 0..polygon.len() {
            self.link(face, polygon[i].at, polygon[(i + 1) % polygon.len()].at);
        }
        if t.lie != Lie::Vertical {
            self.pieces.push((face, polygon.iter().map(|v| v.at).collect()));
        }
    }

    /// The cut of a triangle at `level`, as part of the cap of what lies above.
    fn cap(&mut self, t: &Triangle, level: i32) {
        let (mut from, mut to) = (None, None);
        for i in 0..3 {
            let (a, b) = (t.corners[i], t.corners[(i + 1) % 3]);
            match (a.z > level, b.z > level) {
                (true, false) => to = Some(crossing(b, a, level)),
                (false, true) => from = Some(crossing(a, b, level)),
                _ => {}
            }
        }
        if let (Some(from), Some(to)) = (from, to) {
            let face = self.face(t.body, Plane::level(level));
            self.link(face, from, to);
        }
    }

    fn finish(mut self) -> Slab {
        self.chains.sort_unstable();
        let mut chains: Vec<(u32, u32, i32)> = Vec::with_capacity(self.chains.len());
        for run in self.chains.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let sum: i32 = run.iter().map(|entry| entry.2).sum();
            if sum != 0 {
                chains.push((run[0].0, run[0].1, sum));
            }
        }
        // Segments inside of faces have cancelled.
        let mut used = vec![false; self.segments.len()];
        used[..4].fill(true);
        chains.iter().for_each(|c| used[c.0 as usize] = true);
        let mut new = vec![u32::MAX; used.len()];
        let mut segments = Vec::new();
        for (i, segment) in self.segments.iter().enumerate() {
            if used[i] {
                new[i] = segments.len() as u32;
                segments.push(*segment);
            }
        }
        chains.iter_mut().for_each(|c| c.0 = new[c.0 as usize]);
        let mut faces: Vec<(u32, SlabFace)> = self.faces.into_iter().map(|(face, i)| (i, face)).collect();
        faces.sort_unstable();
        Slab {
            segments,
            faces: faces.into_iter().map(|(_, face)| face).collect(),
            chains,
            pieces: self.pieces,
        }
    }
}

/// The plane that stands for a part of a steep triangle: at its lower (or upper) edge.
fn replacement(t: &Triangle, polygon: &[Vertex], is_low: bool) -> Plane {
    let heights = polygon.iter().map(|v| v.z);
    let end = if is_low { heights.min() } else { heights.max() }.unwrap_or_default();
    t.leans.then(|| chord(polygon, f64::from(t.run), is_low)).flatten().unwrap_or(Plane::level(end))
}

/// The plane through the lowest (or highest) points at both ends of a part of a steep triangle that runs `run` units, level
/// across it: nowhere below its lower edges, and nowhere above its upper ones. `None` if it is too short.
fn chord(polygon: &[Vertex], run: f64, is_low: bool) -> Option<Plane> {
    let from = |a: &Vertex, b: &Vertex| {
        [f64::from(b.at.x) - f64::from(a.at.x), f64::from(b.at.y) - f64::from(a.at.y)]
    };
    let mut long = [0.0; 2];
    for (i, a) in polygon.iter().enumerate() {
        for b in &polygon[i + 1..] {
            let way = from(a, b);
            if way[0].hypot(way[1]) > f64::hypot(long[0], long[1]) {
                long = way;
            }
        }
    }
    let length = f64::hypot(long[0], long[1]);
    if length <= 4.0 * (run + 1.0) {
        return None;
    }
    // Corners that stand above each other, but for roundings and because the longest way may lead across the run.
    let together = 2.0 + 2.0 * run * run / length;
    let along = long.map(|c| c / length);
    let place = |v: &Vertex| {
        let way = from(&polygon[0], v);
        way[0] * along[0] + way[1] * along[1]
    };
    let places = polygon.iter().map(place);
    let (start, end) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(s, e), p| (s.min(p), e.max(p)));
    let pick = |is_there: &dyn Fn(f64) -> bool| {
        let there = polygon.iter().filter(|v| is_there(place(v)));
        if is_low { there.min_by_key(|v| v.z) } else { there.max_by_key(|v| v.z) }
    };
    let first = pick(&|place| place <= start + together)?;
    let last = pick(&|place| place >= end - together)?;
    let slope = (f64::from(last.z) - f64::from(first.z)) / (place(last) - place(first));
    let at = [first.at.x, first.at.y, first.z].map(f64::from);
    Plane::sloped(along.map(|c| c * slope), at)
}

/// The part of a triangle strictly between two levels, closed again: counter-clockwise as the triangle is.
fn clip(corners: [Vertex; 3], [bottom, top]: [i32; 2]) -> Vec<Vertex> {
    let mut above = Vec::with_capacity(5);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.z > bottom {
            above.push(a);
        }
        if (a.z > bottom) != (b.z > bottom) {
            let (low, high) = if a.z > bottom { (b, a) } else { (a, b) };
            above.push(Vertex { at: crossing(low, high, bottom), z: bottom });
        }
    }
    let mut kept = Vec::with_capacity(5);
    for i in 0..above.len() {
        let (a, b) = (above[i], above[(i + 1) % above.len()]);
        if a.z < top {
            kept.push(a);
        }
        if (a.z < top) != (b.z < top) {
            let (low, high) = if a.z < top { (a, b) } else { (b, a) };
            kept.push(Vertex { at: crossing(low, high, top), z: top });
        }
    }
    kept
}

/// Where the edge from `low` up to `high` passes `level`, rounded. The same for all triangles on the edge.
fn crossing(low: Vertex, high: Vertex, level: i32) -> Point {
    let (part, whole) = (i64::from(level) - i64::from(low.z), i64::from(high.z) - i64::from(low.z));
    let at = |a: i32, b: i32| {
        let product = (i64::from(b) - i64::from(a)) * part;
        a + (2 * product + whole).div_euclid(2 * whole) as i32
    };
    Point::new(at(low.at.x, high.at.x), at(low.at.y, high.at.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    const METRE: i32 = 1 << 16;

    /// A level triangle, looking up.
    fn level(z: i32, [x, y]: [i32; 2], size: i32) -> Triangle {
        let corner = |x: i32, y: i32| Vertex { at: Point::new(x, y), z };
        Triangle {
            body: 0,
            is_solid: true,
            corners: [corner(x, y), corner(x + size, y), corner(x, y + size)],
            lie: Lie::Flat(Plane::level(z)),
            run: 0.0,
            leans: false,
        }
    }

    /// A site with most of the area, and floors of many rooms at slightly different heights over it.
    fn storeys(count: i32, rooms: i32) -> Vec<Triangle> {
        let mut all = vec![level(0, [0, 0], 200 * METRE)];
        for storey in 1..=count {
            let z = 3 * METRE * storey;
            all.push(level(z, [storey, storey], 20 * METRE));
            all.extend(
                (0..rooms)
                    .map(|i| level(z + METRE / 50 + i % 100, [i * 17 + storey, i * 13 + storey], METRE + i)),
            );
        }
        all
    }

    #[test]
    fn crowded_slabs_are_cut_between_storeys() {
        let lattice = Lattice { origin: [0.0; 3], turn: [1.0, 0.0], bits: 16 };
        let hull = [[-METRE; 3], [201 * METRE, 201 * METRE, 16 * METRE]];
        let chosen = |rooms: i32| choose_levels(&storeys(4, rooms), hull, &lattice);
        let few = chosen(100);
        assert_eq!(few, [-METRE, 0, 16 * METRE]);
        // Nine thousand segments a storey: two and a half fit.
        let many = chosen(3000);
        assert_eq!(many.len(), 4, "{many:?}");
        assert!([6 * METRE, 9 * METRE].contains(&many[2]), "{many:?}");
        // A storey by itself is not cut.
        assert_eq!(chosen(9000).len(), 6);
    }
}
