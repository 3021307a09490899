//! Points of the plan that need not be on the lattice: where edges of two slabs cross.

use std::cmp::Ordering;

use super::{Plane, Point};

/// The plan point (x / w, y / w), w > 0, in lowest terms, so that equal points are equal. At most 2^24 in size, like all points of
/// the lattice, and with w below 2^52 where it is a crossing of edges between these.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Site {
    x: i128,
    y: i128,
    w: i128,
}

impl From<Point> for Site {
    fn from(p: Point) -> Site {
        Site { x: i128::from(p.x), y: i128::from(p.y), w: 1 }
    }
}

impl Site {
    /// Where the lines through two points each cross; `None` if they are parallel.
    pub fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Site> {
        let way = |from: Point, to: Point| {
            [i128::from(to.x) - i128::from(from.x), i128::from(to.y) - i128::from(from.y)]
        };
        let cross = |u: [i128; 2], v: [i128; 2]| u[0] * v[1] - u[1] * v[0];
        let (along, other) = (way(a, b), way(c, d));
        // Coordinates below 2^25, so w below 2^52 and the rest below 2^79.
        let w = cross(along, other);
        if w == 0 {
            return None;
        }
        let share = cross(way(a, c), other);
        let at = |from: i32, by: i128| i128::from(from) * w + by * share;
        Some(Site::reduced(at(a.x, along[0]), at(a.y, along[1]), w))
    }

    /// The point at the share `part` / `whole` (`whole` > 0, both below 2^64) of the way from `a` to `b`.
    pub fn between([a, b]: [Point; 2], part: i128, whole: i128) -> Site {
        let at = |from: i32, to: i32| i128::from(from) * whole + (i128::from(to) - i128::from(from)) * part;
        Site::reduced(at(a.x, b.x), at(a.y, b.y), whole)
    }

    fn reduced(x: i128, y: i128, w: i128) -> Site {
        // Not 0, as w is not.
        let common = gcd(gcd(x.unsigned_abs(), y.unsigned_abs()), w.unsigned_abs()) as i128;
        let common = if w < 0 { -common } else { common };
        Site { x: x / common, y: y / common, w: w / common }
    }

    /// The lattice point that it is, if it is one.
    pub fn on_lattice(&self) -> Option<Point> {
        // Between lattice points, and so within their range.
        (self.w == 1).then(|| Point::new(self.x as i32, self.y as i32))
    }

    /// On which side of the line from `a` to `b` it lies: positive on the left.
    pub fn side(&self, [a, b]: [Point; 2]) -> i128 {
        let [ux, uy] = [i128::from(b.x) - i128::from(a.x), i128::from(b.y) - i128::from(a.y)];
        ux * (self.y - i128::from(a.y) * self.w) - uy * (self.x - i128::from(a.x) * self.w)
    }

    /// The height of a plane over it, in [`FINE`](super::FINE) parts of a lattice unit, as numerator over [`Site::scale`].
    pub fn height(&self, plane: &Plane) -> i128 {
        // Slopes below 2^37, so below 2^118.
        i128::from(plane.p) * self.x + i128::from(plane.q) * self.y + i128::from(plane.r) * self.w
    }

    /// The denominator of its coordinates and heights.
    pub fn scale(&self) -> i128 {
        self.w
    }

    /// Along one of the axes (0 x, 1 y), in lattice units, rounded.
    pub fn along(&self, axis: usize) -> f64 {
        (if axis == 0 { self.x } else { self.y }) as f64 / self.w as f64
    }

    /// Compares along x, then y: exactly.
    pub fn compare(&self, other: &Site) -> Ordering {
        compare([self.x, self.w], [other.x, other.w]).then(compare([self.y, self.w], [other.y, other.w]))
    }
}

/// Compares fractions with positive denominators below 2^60.
fn compare(a: [i128; 2], b: [i128; 2]) -> Ordering {
    let whole = |[n, d]: [i128; 2]| n.div_euclid(d);
    let rest = |[n, d]: [i128; 2]| n.rem_euclid(d);
    whole(a).cmp(&whole(b)).then_with(|| (rest(a) * b[1]).cmp(&(rest(b) * a[1])))
}

/// The greatest common divisor; 0 of 0 and 0.
pub(crate) fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::lattice::orient;

    const FAR: i32 = 1 << 24;

    fn point() -> impl Strategy<Value = Point> {
        let coordinate = || prop_oneof![-4..5i32, -FAR..FAR + 1];
        (coordinate(), coordinate()).prop_map(|(x, y)| Point::new(x, y))
    }

    #[test]
    fn far_lines_cross_exactly() {
        let ends = [Point::new(-FAR, -FAR), Point::new(FAR, FAR - 1)];
        let others = [Point::new(-FAR, FAR), Point::new(FAR, 1 - FAR)];
        let site = Site::crossing(ends, others).unwrap();
        assert_eq!((site.side(ends), site.side(others)), (0, 0));
        assert_eq!(Site::crossing(others, ends), Some(site));
        assert_eq!(Site::crossing(ends, ends), None);
        let axes = [[Point::new(-3, 0), Point::new(5, 0)], [Point::new(2, -7), Point::new(2, 9)]];
        assert_eq!(Site::crossing(axes[0], axes[1]).unwrap().on_lattice(), Some(Point::new(2, 0)));
        // The origin is in lowest terms too.
        let through = [[Point::new(-6, -3), Point::new(6, 3)], [Point::new(-2, 4), Point::new(2, -4)]];
        assert_eq!(Site::crossing(through[0], through[1]), Some(Point::new(0, 0).into()));
        assert_eq!(Site::between(through[0], 7, 14), Point::new(0, 0).into());
        let half = Site::crossing([Point::new(0, 0), Point::new(1, 1)], [Point::new(0, 1), Point::new(1, 0)]);
        let half = half.unwrap();
        assert_eq!((half.on_lattice(), half.along(0), half.scale()), (None, 0.5, 2));
        assert_eq!(half.height(&Plane { p: 6, q: 10, r: 1 }), 6 + 10 + 2);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn crossings_lie_on_both_lines(a in point(), b in point(), c in point(), d in point(), e in point()) {
            if let Some(site) = Site::crossing([a, b], [c, d]) {
                prop_assert_eq!((site.side([a, b]), site.side([c, d])), (0, 0));
                for (one, other) in [([b, a], [c, d]), ([c, d], [a, b]), ([d, c], [a, b])] {
                    prop_assert_eq!(Site::crossing(one, other), Some(site));
                }
                // Between its neighbours on the lattice.
                for axis in 0..2 {
                    let at = site.along(axis);
                    prop_assert!(at.abs() > f64::from(4 * FAR) || at.is_finite());
                }
                prop_assert_eq!(site.compare(&site), Ordering::Equal);
                prop_assert_eq!(site.compare(&Site::from(e)), Site::from(e).compare(&site).reverse());
            }
            let on_lattice = Site::from(e);
            prop_assert_eq!(on_lattice.on_lattice(), Some(e));
            prop_assert_eq!(on_lattice.side([a, b]).signum(), i128::from(orient(a, b, e).signum()));
            let plane = Plane { p: 12345, q: -6789, r: 1 << 40 };
            prop_assert_eq!(on_lattice.height(&plane), i128::from(plane.height(e)));
        }
    }
}
