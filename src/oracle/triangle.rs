//! A line against a triangle: the one test that both the brute force and the grid use.
//!
//! The line pierces the closed triangle `abc` if it passes the three edges on the same side: the signs of
//! `d . (b x c)`, `d . (c x a)`, `d . (a x b)` (corners relative to the ray's origin; the Pluecker products of the
//! line with the edges) do not contradict each other. In f64 they are computed as `d . (b x (c - b))` and so on,
//! which loses less where triangles are small and far. A sign that f64 cannot settle is taken exactly, so that two
//! triangles that share an edge or a vertex never leave a gap, and a line through an edge meets both. A line in the
//! triangle's plane does not pierce it; it meets the neighbours across the edge.

use super::exact;
use super::vector::{cross, dot, max_abs, sub};
use crate::trace::Ray;

/// Three corners.
pub(crate) type Corners = [[f64; 3]; 3];

/// Half the distance from 1 to the next f64.
const U: f64 = f64::EPSILON / 2.0;

/// Times the largest coordinate relative to the origin, times that of the edges: bounds the error of a side that was
/// computed in f64. The sum of the absolute products is at most `2 sqrt(3)` times these, and each carries at most 7
/// roundings; the factor is more than twice that.
const SIDE_ERROR: f64 = 64.0 * U;

/// A computed `t` is at most this times `1 + |t|` from the exact one.
pub(crate) const T_ERROR: f64 = 1e-10;

/// A ray with its direction normalised.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) origin: [f64; 3],
    pub(crate) direction: [f64; 3],
    /// The largest coordinate of `origin`, without its sign.
    pub(crate) reach: f64,
}

impl Line {
    /// `None` for what is no ray, see [`Ray::is_valid`].
    pub(crate) fn new(ray: &Ray) -> Option<Line> {
        if !ray.is_valid() {
            return None;
        }
        // By the largest component first, so that the squares neither overflow nor vanish.
        let largest = max_abs(ray.direction);
        let scaled = ray.direction.map(|c| c / largest);
        let length = dot(scaled, scaled).sqrt();
        let direction = scaled.map(|c| c / length);
        Some(Line { origin: ray.origin, direction, reach: max_abs(ray.origin) })
    }

    /// The point at `t`.
    pub(crate) fn at(&self, t: f64) -> [f64; 3] {
        [0, 1, 2].map(|i| self.origin[i] + t * self.direction[i])
    }
}

/// How large a triangle's numbers are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size {
    /// The largest coordinate of the corners, without its sign.
    pub(crate) reach: f64,
    /// The largest coordinate of the edges, without its sign.
    pub(crate) span: f64,
}

impl Size {
    pub(crate) fn of([a, b, c]: &Corners) -> Size {
        let span = max_abs(sub(*b, *a)).max(max_abs(sub(*c, *b))).max(max_abs(sub(*a, *c)));
        Size { reach: max_abs(*a).max(max_abs(*b)).max(max_abs(*c)), span }
    }

    /// Bounds the error of the triangle's sides, for a line whose origin has this reach.
    #[inline]
    pub(crate) fn side_error(self, origin_reach: f64) -> f64 {
        SIDE_ERROR * (self.reach + origin_reach) * self.span
    }
}

/// Where the whole line (both ways from its origin) pierces the triangle of that size: `t` along the normalised
/// direction, to within [`T_ERROR`].
pub(crate) fn pierce(line: &Line, corners: &Corners, size: Size) -> Option<f64> {
    let sides = sides(line, corners);
    let error = size.side_error(line.reach);
    let low = sides[0].min(sides[1]).min(sides[2]);
    let high = sides[0].max(sides[1]).max(sides[2]);
    if low < -error && high > error {
        return None;
    }
    let (mut left, mut right) = (false, false);
    for (index, side) in sides.into_iter().enumerate() {
        // Written so that a NaN, from origins beyond all measure, goes to the exact road as well.
        let sign = if side > error {
            1
        } else if side < -error {
            -1
        } else {
            sure_side(line, corners[(index + 1) % 3], corners[(index + 2) % 3], side)
        };
        left |= sign > 0;
        right |= sign < 0;
        if left && right {
            return None;
        }
    }
    if left == right { None } else { distance(line, corners, sub(corners[0], line.origin)) }
}

/// The sides of the triangle's edges that the line passes on, each of the edge opposite a corner; off by at most [`Size::side_error`].
pub(crate) fn sides(line: &Line, corners: &Corners) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| sub(corner, line.origin));
    let d = line.direction;
    [
        dot(d, cross(b, sub(corners[2], corners[1]))),
        dot(d, cross(c, sub(corners[0], corners[2]))),
        dot(d, cross(a, sub(corners[1], corners[0]))),
    ]
}

/// The sign of `d . ((b - o) x (c - o))`, which f64 takes for `side`: as it says where this edge's own size settles it, which may be far smaller than
/// the triangle's, and the corner far nearer than the farthest.
#[cold]
fn sure_side(line: &Line, b: [f64; 3], c: [f64; 3], side: f64) -> i32 {
    let error = side_error(line, b, c);
    if side > error {
        1
    } else if side < -error {
        -1
    } else {
        exact_side(line, b, c)
    }
}

/// Bounds the error of one edge's side. What underflows is left to exact arithmetic.
fn side_error(line: &Line, b: [f64; 3], c: [f64; 3]) -> f64 {
    const LEAST: f64 = 1e-200;
    SIDE_ERROR * max_abs(sub(b, line.origin)) * max_abs(sub(c, b)) + LEAST
}

/// The sign of `d . ((b - o) x (c - o))`.
fn exact_side(line: &Line, b: [f64; 3], c: [f64; 3]) -> i32 {
    // In one plane across an axis, as with a ray along a floor.
    let is_flat = |i: usize| line.direction[i] == 0.0 && b[i] == line.origin[i] && c[i] == line.origin[i];
    if (0..3).any(is_flat) {
        return 0;
    }
    let twice = |p: [f64; 3]| [0, 1, 2].map(|i| exact::Twice::difference(p[i], line.origin[i]));
    if let Some(sign) = exact::side_in_twice(line.direction, twice(b), twice(c)) {
        return sign;
    }
    let b = exact::difference(b, line.origin);
    let c = exact::difference(c, line.origin);
    exact::dot_f64(&exact::cross(&b, &c), line.direction).sign()
}

/// `t` of the line in the triangle's plane. `a` is the first corner relative to the origin.
fn distance(line: &Line, corners: &Corners, a: [f64; 3]) -> Option<f64> {
    let (e, f) = (sub(corners[1], corners[0]), sub(corners[2], corners[0]));
    let normal = cross(e, f);
    let (numerator, denominator) = (dot(normal, a), dot(normal, line.direction));
    let t = numerator / denominator;
    // Slivers and grazing rays lose digits: a bound on how many.
    let error = 64.0 * U * max_abs(e) * max_abs(f);
    let sure = denominator.abs() - error;
    // Near zero the sign must be right as well: it tells what is ahead from what is behind.
    if sure > 0.0
        && t.abs() > T_ERROR
        && error * (max_abs(a) + t.abs()) <= 0.5 * T_ERROR * (1.0 + t.abs()) * sure
    {
        return Some(t);
    }
    exact_distance(line, corners)
}

#[cold]
fn exact_distance(line: &Line, corners: &Corners) -> Option<f64> {
    let twice = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|i| exact::Twice::difference(p[i], q[i]));
    let [a, b, c] = *corners;
    let from = [twice(b, a), twice(c, a), twice(a, line.origin)];
    if let Some(t) = exact::quotient_in_twice(from, line.direction, 0.5 * T_ERROR)
        && t.abs() > T_ERROR
    {
        return Some(t);
    }
    let e = exact::difference(corners[1], corners[0]);
    let f = exact::difference(corners[2], corners[0]);
    let normal = exact::cross(&e, &f);
    let denominator = exact::dot_f64(&normal, line.direction);
    let numerator = exact::dot(&normal, &exact::difference(corners[0], line.origin));
    let t = numerator.value() / denominator.value();
    t.is_finite().then_some(t)
}

/// Times the product of two edges' lengths: a normal shorter than this is all rounding.
const NORMAL_ERROR: f64 = 16.0 * U;

/// The point of the triangle that is nearest to `p`: of those of its three edges, and the foot of the perpendicular if
/// that lies within. Everything is taken relative to `p`, and no two products of areas are compared (Ericson,
/// "Real-Time Collision Detection", 5.1.5, does, and is metres off on a triangle that is kilometres long and
/// millimetres wide).
pub(crate) fn closest_point(corners: &Corners, p: [f64; 3]) -> [f64; 3] {
    let from = corners.map(|corner| sub(corner, p));
    let ways = [0, 1, 2].map(|i| sub(corners[(i + 1) % 3], corners[i]));
    let mut best = from[0];
    let mut least = dot(best, best);
    for i in 0..3 {
        let length = dot(ways[i], ways[i]);
        // An edge without length is its corner.
        let share = if length > 0.0 { (-dot(from[i], ways[i]) / length).clamp(0.0, 1.0) } else { 0.0 };
        // From the corner that is nearer, for the smaller rounding.
        let foot = if share <= 0.5 {
            along(from[i], ways[i], share)
        } else {
            along(from[(i + 1) % 3], ways[i], share - 1.0)
        };
        let square = dot(foot, foot);
        if square < least {
            (best, least) = (foot, square);
        }
    }
    // The normal from the two short edges, the plane from the corner that is nearest.
    let lengths = ways.map(|way| dot(way, way));
    let longest = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap_or(0);
    let (e, f) = ((longest + 1) % 3, (longest + 2) % 3);
    let normal = cross(ways[e], ways[f]);
    let square = dot(normal, normal);
    if square > NORMAL_ERROR * NORMAL_ERROR * lengths[e] * lengths[f] {
        let squares = from.map(|corner| dot(corner, corner));
        let nearest = (0..3).min_by(|&i, &j| squares[i].total_cmp(&squares[j])).unwrap_or(0);
        let foot = normal.map(|n| n * dot(normal, from[nearest]) / square);
        let within = (0..3).all(|i| dot(normal, cross(ways[i], sub(foot, from[i]))) >= 0.0);
        if within && dot(foot, foot) < least {
            best = foot;
        }
    }
    [0, 1, 2].map(|i| p[i] + best[i])
}

fn along(base: [f64; 3], way: [f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| base[i] + share * way[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::vector::distance as apart;

    fn hit(ray: Ray, corners: Corners) -> Option<f64> {
        pierce(&Line::new(&ray).unwrap(), &corners, Size::of(&corners))
    }

    const FLOOR: Corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn inside_edge_vertex_outside() {
        let down = |x: f64, y: f64| hit(Ray::new([x, y, 3.0], [0.0, 0.0, -2.0]), FLOOR);
        assert_eq!(down(1.0, 1.0), Some(3.0));
        assert_eq!(down(2.0, 2.0), Some(3.0), "on the long edge");
        assert_eq!(down(0.0, 0.0), Some(3.0), "on a vertex");
        let next = f64::from_bits(2.0f64.to_bits() + 1);
        assert_eq!(down(2.0, next), None, "one ulp beyond the edge");
        assert_eq!(down(-1e-300, 1.0), None, "less than any f64 spacing beyond the edge");
        // Behind the origin counts as negative t, and back sides are hit as well.
        assert_eq!(hit(Ray::new([1.0, 1.0, -3.0], [0.0, 0.0, -1.0]), FLOOR), Some(-3.0));
    }

    #[test]
    fn lines_in_the_plane_do_not_pierce() {
        assert_eq!(hit(Ray::new([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0]), FLOOR), None);
        let wall = [[-1.0, 0.0, -1.0], [5.0, 0.0, -1.0], [0.0, 0.0, 1.0]];
        let t = hit(Ray::new([1.0, -1.0, 0.0], [0.0, 1.0, 0.0]), wall);
        assert_eq!(t, Some(1.0), "the neighbour does");
    }

    #[test]
    fn shared_oblique_edges_leave_no_gap() {
        // Points on an edge that f64 cannot represent: at least one of the two triangles must be hit.
        let (p, q) = ([0.1, 0.2, 0.3], [7.7, 3.1, 1.9]);
        let one = [p, q, [5.0, -4.0, 0.7]];
        let two = [q, p, [2.0, 9.0, 2.1]];
        for i in 1..2000 {
            let s = f64::from(i) / 2000.0;
            let target = [0, 1, 2].map(|k| p[k] + s * (q[k] - p[k]));
            let origin = [3.3, 2.7, 19.0 + s];
            let ray = Ray::new(origin, sub(target, origin));
            assert!(hit(ray, one).is_some() || hit(ray, two).is_some(), "at {s}");
        }
    }

    #[test]
    fn slivers_and_grazing_rays_keep_their_digits() {
        // A plane z = x / 2^40, in slivers 2^-30 wide; exact t is known.
        let slope = 2f64.powi(-40);
        let w = 2f64.powi(-30);
        let corners = [[0.0, 0.0, 0.0], [1024.0, 0.0, 1024.0 * slope], [1024.0, w, 1024.0 * slope]];
        let height = 2f64.powi(-33);
        let t = hit(Ray::new([0.0, w / 16.0, height], [1.0, 0.0, 0.0]), corners).unwrap();
        assert!((t - 128.0).abs() <= T_ERROR * 129.0, "{t}");
    }

    #[test]
    fn sides_that_are_sure_are_those_of_exact_arithmetic() {
        let mut random = crate::oracle::random::Random::new(5, 0, 0);
        let mut point = |size: f64| [0; 3].map(|_| random.between(-size, size));
        let (mut sure, mut both) = (0, [0, 0]);
        for step in 0..20_000 {
            // Edges of all sizes, the ray's origin near them and far; aimed at the edge but for roundings and a little more.
            let size = 2f64.powi(step % 40 - 30);
            let (base, far) = (point(100.0), point(2f64.powi(step % 23 - 12)));
            let [b, c] = [point(size), point(size)].map(|p| [0, 1, 2].map(|i| base[i] + p[i]));
            let origin = [0, 1, 2].map(|i| b[i] + far[i]);
            let aside = point(size * 2f64.powi(-30 - step % 29));
            let target = [0, 1, 2].map(|i| b[i] + 0.3 * (c[i] - b[i]) + aside[i]);
            let Some(line) = Line::new(&Ray::new(origin, sub(target, origin))) else { continue };
            let side = dot(line.direction, cross(sub(b, origin), sub(c, b)));
            let exact = exact_side(&line, b, c);
            assert_eq!(sure_side(&line, b, c, side), exact, "{line:?} {b:?} {c:?}");
            sure += usize::from(side.abs() > side_error(&line, b, c));
            both[usize::from(exact > 0)] += 1;
        }
        // Neither way alone, and neither sign.
        assert!((2_000..18_000).contains(&sure), "{sure}");
        assert!(both.iter().all(|count| *count > 5_000), "{both:?}");
    }

    #[test]
    fn directions_of_any_length_and_monstrous_origins() {
        for scale in [1e-310, 1e-200, 1.0, 1e200, 1e308] {
            let t = hit(Ray::new([1.0, 1.0, 3.0], [0.0, 0.0, -scale]), FLOOR).unwrap();
            assert_eq!(t, 3.0);
        }
        for big in [1e20, 1e160, f64::MAX] {
            // No claim but that it ends, without NaN.
            let t = hit(Ray::new([big, big, big], [-1.0, -1.0, -1.0]), FLOOR);
            assert!(t.is_none_or(f64::is_finite));
        }
    }

    #[test]
    fn closest_points() {
        assert_eq!(closest_point(&FLOOR, [1.0, 1.0, 5.0]), [1.0, 1.0, 0.0]);
        assert_eq!(closest_point(&FLOOR, [-1.0, -1.0, 5.0]), [0.0, 0.0, 0.0]);
        assert_eq!(closest_point(&FLOOR, [3.0, 3.0, 1.0]), [2.0, 2.0, 0.0]);
        assert_eq!(closest_point(&FLOOR, [2.0, -7.0, 1.0]), [2.0, 0.0, 0.0]);
        assert_eq!(closest_point(&FLOOR, [9.0, -1.0, 0.0]), [4.0, 0.0, 0.0]);
        assert!(apart(closest_point(&FLOOR, [-3.0, 6.0, 0.0]), [0.0, 4.0, 0.0]) < 1e-12);
        // Corners in a line but for their roundings.
        let sliver = [[2.0, -1.0, 1.0], [3.0, -1.0, 3.0], [5.0 / 3.0, -1.0, 1.0 / 3.0]];
        for i in 0..1000 {
            let share = f64::from(i) / 999.0;
            let p = [5.0 / 3.0 + share * 4.0 / 3.0, -1.0, 1.0 / 3.0 + share * 8.0 / 3.0];
            assert!(apart(closest_point(&sliver, p), p) < 1e-12, "{share}");
        }
        // Kilometres long, millimetres wide.
        let long = [[3331.0, 2.0, 1.0], [-3326.0, -1.0, -2.0], [-3332.0, -1.0, -2.0]];
        for i in 0..1000 {
            let (u, v) = (f64::from(i % 40) / 39.0, f64::from(i / 40) / 24.0);
            let (v, w) = ((1.0 - u) * v, (1.0 - u) * (1.0 - v));
            let p = [0, 1, 2].map(|k| u * long[0][k] + v * long[1][k] + w * long[2][k]);
            let at = closest_point(&long, p);
            assert!(apart(at, p) < 1e-8, "{p:?} {at:?}");
        }
        let start = [-1572.6346500434138, -0.20877654913418286, -1.2087765491341829];
        assert!(apart(closest_point(&long, start), start) < 1e-6);
        // A point; nothing but its place is known of it.
        assert_eq!(closest_point(&[[1.0, 2.0, 3.0]; 3], [1.0, 2.0, 7.0]), [1.0, 2.0, 3.0]);
    }
}
