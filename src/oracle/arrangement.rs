//! Where to look for witnesses: one point in every face of a small arrangement of segments.
//!
//! Seen along the ray, the edges near it are segments in the plane, and the ray is the origin. Which surfaces a
//! parallel ray meets, and in which order, changes only across these segments, so one point of each face that they cut
//! out of the disc of the tolerance stands for all its points. Every face touches the middle of some segment's
//! nearest part, or a vertex of the arrangement: points on both sides of the former, and between each two neighbours
//! around the latter, are all that is needed.

use std::collections::HashSet;

/// A point of the plane.
pub(crate) type Point = [f64; 2];

/// Segments looked at; the nearest ones if there are more.
const SEGMENTS: usize = 64;

/// Points returned; the nearest ones if there are more.
const POINTS: usize = 4096;

/// The segments that meet a disc around the origin.
#[derive(Clone, Debug)]
pub(crate) struct Arrangement {
    radius: f64,
    step: f64,
    segments: Vec<[Point; 2]>,
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// `a + s b`.
fn along(a: Point, s: f64, b: Point) -> Point {
    [a[0] + s * b[0], a[1] + s * b[1]]
}

fn norm(a: Point) -> f64 {
    (a[0] * a[0] + a[1] * a[1]).sqrt()
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn unit(a: Point) -> Option<Point> {
    let length = norm(a);
    (length > 0.0).then(|| [a[0] / length, a[1] / length])
}

/// The point of the segment that is nearest to `from`.
fn foot([p, q]: [Point; 2], from: Point) -> Point {
    let way = minus(q, p);
    let square = way[0] * way[0] + way[1] * way[1];
    if square == 0.0 {
        return p;
    }
    let to = minus(from, p);
    let share = (to[0] * way[0] + to[1] * way[1]) / square;
    if share <= 0.0 {
        p
    } else if share >= 1.0 {
        q
    } else {
        along(p, share, way)
    }
}

/// The part of a segment that lies within `radius` of the point of it that is nearest to the origin: numbers of the disc's size
/// are rounded by less.
fn clipped(segment: [Point; 2], radius: f64) -> [Point; 2] {
    let middle = foot(segment, [0.0; 2]);
    segment.map(|end| {
        let way = minus(end, middle);
        let length = norm(way);
        if length > radius { along(middle, radius / length, way) } else { end }
    })
}

/// Grows with the angle from the x axis, without the rounding of an arc tangent.
fn turn(d: Point) -> f64 {
    let slope = d[1] / (d[0].abs() + d[1].abs());
    if d[0] < 0.0 { 2.0 - slope } else { slope }
}

impl Arrangement {
    /// The disc. Points keep `step` away from the segments, and greater distances, up to 1e5 times that, as well.
    pub(crate) fn new(radius: f64, step: f64) -> Arrangement {
        Arrangement { radius, step, segments: Vec::new() }
    }

    /// Adds a segment, if it meets the disc.
    pub(crate) fn add(&mut self, segment: [Point; 2]) {
        if norm(foot(segment, [0.0; 2])) <= self.radius {
            self.segments.push(clipped(segment, 2.0 * self.radius));
        }
    }

    /// Adds the part in the disc of the line `normal . x = offset`.
    pub(crate) fn add_line(&mut self, normal: Point, offset: f64) {
        let length = norm(normal);
        let distance = offset / length;
        if length > 1e-9 && distance.abs() <= self.radius {
            let n = [normal[0] / length, normal[1] / length];
            let half = (self.radius * self.radius - distance * distance).max(0.0).sqrt();
            let middle = [n[0] * distance, n[1] * distance];
            let way = [-n[1], n[0]];
            self.segments.push([along(middle, -half, way), along(middle, half, way)]);
        }
    }

    /// The origin, then points of all faces of the disc, from the nearest to the farthest.
    pub(crate) fn points(mut self) -> Vec<Point> {
        let order = |a: &[Point; 2], b: &[Point; 2]| {
            let distance = |s: &[Point; 2]| norm(foot(*s, [0.0; 2]));
            distance(a).total_cmp(&distance(b)).then_with(|| {
                let flat = |s: &[Point; 2]| [s[0][0], s[0][1], s[1][0], s[1][1]];
                flat(a)
                    .iter()
                    .zip(&flat(b))
                    .map(|(x, y)| x.total_cmp(y))
                    .find(|o| o.is_ne())
                    .unwrap_or(std::cmp::Ordering::Equal)
            })
        };
        for segment in &mut self.segments {
            // Shared edges come twice, once each way.
            if (segment[1][0], segment[1][1]) < (segment[0][0], segment[0][1]) {
                segment.swap(0, 1);
            }
        }
        self.segments.sort_by(order);
        self.unite();

        let mut points = vec![[0.0; 2]];
        for &segment in &self.segments {
            let at = foot(segment, [0.0; 2]);
            points.push(at);
            if let Some(way) = unit(minus(segment[1], segment[0])) {
                for step in self.steps() {
                    points.push(along(at, step, [-way[1], way[0]]));
                    points.push(along(at, -step, [-way[1], way[0]]));
                }
            }
        }
        for vertex in self.vertices() {
            self.around(vertex, &mut points);
        }
        points.retain(|p| norm(*p) <= self.radius);
        points.sort_by(|a, b| {
            norm(*a).total_cmp(&norm(*b)).then(a[0].total_cmp(&b[0])).then(a[1].total_cmp(&b[1]))
        });
        let mut known = HashSet::new();
        points.retain(|p| known.insert(self.rounded(*p, 0.25)));
        points.truncate(POINTS);
        points
    }

    /// Makes one of segments of one line that overlap, which cut the same faces: where floors meet, hundreds of edges lie in a
    /// line. Keeps the nearest.
    fn unite(&mut self) {
        let mut united: Vec<[Point; 2]> = Vec::new();
        for segment in std::mem::take(&mut self.segments) {
            let whole =
                united.iter().enumerate().find_map(|(i, other)| Some((i, self.union(*other, segment)?)));
            match whole {
                Some((i, whole)) => united[i] = whole,
                None if united.len() < SEGMENTS => united.push(segment),
                None => {}
            }
        }
        self.segments = united;
    }

    /// What two segments cover, if they lie on one line and overlap, as far as the steps tell: the first, made longer along itself,
    /// so that however many are united, none is farther from it than that.
    fn union(&self, first: [Point; 2], other: [Point; 2]) -> Option<[Point; 2]> {
        let near = self.step / 16.0;
        let length = norm(minus(first[1], first[0]));
        let Some(way) = unit(minus(first[1], first[0])) else {
            // An edge that is seen from its end.
            return other.iter().all(|end| norm(minus(*end, first[0])) <= near).then_some(first);
        };
        // The line of a short one is not known far from it.
        let is_told = length >= 1e-3 * norm(minus(other[1], other[0]));
        if !is_told || other.iter().any(|end| cross(way, minus(*end, first[0])).abs() > near) {
            return None;
        }
        let places = other.map(|p| (p[0] - first[0][0]) * way[0] + (p[1] - first[0][1]) * way[1]);
        let [start, end] = [places[0].min(places[1]), places[0].max(places[1])];
        if start > length + near || end < -near {
            return None;
        }
        let from = if start < 0.0 { along(first[0], start, way) } else { first[0] };
        let to = if end > length { along(first[0], end, way) } else { first[1] };
        Some([from, to])
    }

    /// Tells points apart that are some share of the step from each other.
    fn rounded(&self, p: Point, share: f64) -> [i64; 2] {
        p.map(|c| (c / (share * self.step)).round() as i64)
    }

    fn steps(&self) -> [f64; 3] {
        [1.0, 300.0, 1e5].map(|many| (many * self.step).min(self.radius / 8.0))
    }

    /// Ends and crossings of segments within the disc.
    fn vertices(&self) -> Vec<Point> {
        let mut vertices: Vec<Point> = self.segments.iter().flatten().copied().collect();
        for (i, &[p, q]) in self.segments.iter().enumerate() {
            for &[r, s] in &self.segments[..i] {
                let (a, b) = (minus(q, p), minus(s, r));
                let area = cross(a, b);
                if area != 0.0 {
                    let on_first = cross(minus(r, p), b) / area;
                    let on_second = cross(minus(r, p), a) / area;
                    if (0.0..=1.0).contains(&on_first) && (0.0..=1.0).contains(&on_second) {
                        vertices.push(along(p, on_first, a));
                    }
                }
            }
        }
        // Many edges may cross in one place, and rounding scatters it.
        let mut known = HashSet::new();
        vertices.retain(|v| norm(*v) <= self.radius && known.insert(self.rounded(*v, 1.0 / 16.0)));
        vertices
    }

    /// Points in all sectors around a vertex.
    fn around(&self, vertex: Point, points: &mut Vec<Point>) {
        let mut ways: Vec<Point> = Vec::new();
        for &segment in &self.segments {
            if norm(minus(foot(segment, vertex), vertex)) <= self.step / 16.0 {
                for end in segment {
                    let way = minus(end, vertex);
                    if norm(way) > self.step / 4.0 {
                        ways.extend(unit(way));
                    }
                }
            }
        }
        ways.sort_by(|a, b| turn(*a).total_cmp(&turn(*b)));
        ways.dedup_by(|b, a| turn(*b) - turn(*a) < 1e-7);
        for (i, &from) in ways.iter().enumerate() {
            let to = ways[(i + 1) % ways.len()];
            // The middle of the turn from one way to the next, counter-clockwise.
            let turned = cross(from, to);
            let sum = along(from, 1.0, to);
            let middle = if norm(sum) < 1e-6 {
                Some([-from[1], from[0]])
            } else {
                unit(if turned < 0.0 || ways.len() == 1 { [-sum[0], -sum[1]] } else { sum })
            };
            if let Some(middle) = middle {
                for step in self.steps() {
                    points.push(along(vertex, step, middle));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn side(p: Point, [a, b]: [Point; 2]) -> bool {
        cross(minus(b, a), minus(p, a)) > 0.0
    }

    #[test]
    fn without_segments_one_point_will_do() {
        let mut empty = Arrangement::new(1.0, 1e-6);
        empty.add([[2.0, -1.0], [2.0, 1.0]]);
        assert_eq!(empty.points(), [[0.0; 2]]);
    }

    #[test]
    fn both_sides_and_beyond_an_end() {
        let mut one = Arrangement::new(1.0, 1e-6);
        one.add([[0.25, -0.5], [0.25, 8.0]]);
        let points = one.points();
        assert!(points.iter().any(|p| p[0] > 0.25 && p[1] == 0.0 && p[0] < 0.250_002));
        assert!(points.iter().any(|p| p[1] < -0.5), "{points:?}");
    }

    #[test]
    fn segments_of_one_line_are_one() {
        let mut many = Arrangement::new(1e-3, 1e-9);
        for i in 0..200 {
            let end = f64::from(i) * 1e-6;
            many.add([[-3.0 - end, 1e-6], [end, 1e-6 * (1.0 + f64::EPSILON)]]);
        }
        many.add([[1e-4, -1.0], [1e-4, 1e-6]]);
        // On the same line, but apart; and parallel to it.
        many.add([[5e-4, 1e-6], [3.0, 1e-6]]);
        many.add([[-1.0, 1.1e-6], [1.0, 1.1e-6]]);
        let points = many.clone().points();
        many.unite();
        assert_eq!(many.segments.len(), 4, "{:?}", many.segments);
        let beside =
            |x: f64, y: f64| points.iter().any(|p| (p[0] - x).abs() < 2e-9 && (p[1] - y).abs() < 2e-9);
        assert!(beside(1e-4 + 1e-9, 1e-6 - 1e-9) && beside(1e-4 - 1e-9, 1e-6 - 1e-9));
        assert!(beside(199e-6 + 1e-9, 1e-6) && beside(5e-4 - 1e-9, 1e-6));
    }

    /// Edges that are seen from their ends are points: many of one do not crowd out what is farther.
    #[test]
    fn points_are_one() {
        let mut many = Arrangement::new(1e-3, 1e-9);
        for _ in 0..100 {
            many.add([[1e-5; 2]; 2]);
        }
        many.add([[1e-5, 1e-5], [2e-5, 1e-5]]);
        many.add([[1e-5, 1e-5], [1e-5, 2e-5]]);
        many.add([[5e-4, -1.0], [5e-4, 1.0]]);
        assert!(many.points().iter().any(|p| p[0] > 5e-4));
    }

    proptest! {
        /// Segments of an arc are no line.
        #[test]
        fn united_segments_stay_where_they_were(turns in proptest::collection::vec(-1.0f64..1.0, 1..100)) {
            let mut arrangement = Arrangement::new(1.0, 1e-3);
            let (mut at, mut angle) = ([-0.5, 0.0], 0.0f64);
            let mut all = Vec::new();
            for turn in turns {
                angle += 0.02 * turn;
                let next = along(at, 0.01, [angle.cos(), angle.sin()]);
                all.push([at, next]);
                arrangement.add([at, next]);
                at = next;
            }
            arrangement.unite();
            for end in all.into_iter().flatten() {
                let off = arrangement.segments.iter().map(|s| norm(minus(foot(*s, end), end)));
                prop_assert!(off.fold(f64::INFINITY, f64::min) <= 1.001e-3 / 16.0 || arrangement.segments.len() == SEGMENTS);
            }
        }

        /// Lines that cut the disc: the points' patterns of sides are all that random points have.
        #[test]
        fn every_face_has_a_point(
            lines in proptest::collection::vec((0.0f64..6.3, -0.9f64..0.9), 1..7),
            probes in proptest::collection::vec((0.0f64..6.3, 0.0f64..0.95), 200),
        ) {
            let mut arrangement = Arrangement::new(1.0, 1e-7);
            for &(angle, offset) in &lines {
                arrangement.add_line([angle.cos(), angle.sin()], offset);
            }
            let segments = arrangement.segments.clone();
            let pattern = |p: Point| segments.iter().map(|s| side(p, *s)).collect::<Vec<_>>();
            let covered: std::collections::BTreeSet<_> =
                arrangement.points().into_iter().map(pattern).collect();
            for (angle, radius) in probes {
                let p = [radius * angle.cos(), radius * angle.sin()];
                // Faces too small for the steps are not asked for.
                let clear = segments.iter().all(|s| norm(minus(foot(*s, p), p)) > 1e-3);
                prop_assert!(!clear || covered.contains(&pattern(p)), "{:?}", p);
            }
        }
    }
}
