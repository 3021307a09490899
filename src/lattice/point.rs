//! Plan points and exact predicates on them.

/// A point of the plan, lattice units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Point {
    /// Along x.
    pub x: i32,
    /// Along y.
    pub y: i32,
}

impl Point {
    /// The point at `x`, `y`.
    pub const fn new(x: i32, y: i32) -> Point {
        Point { x, y }
    }
}

/// Which side of the line from `a` to `b` point `c` lies on: positive on the left, 0 on the line. Twice the area of
/// the triangle, exactly: coordinates are at most 2^24 in size, so that no product reaches 2^51.
pub fn orient(a: Point, b: Point, c: Point) -> i64 {
    let (ux, uy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    let (vx, vy) = (i64::from(c.x) - i64::from(a.x), i64::from(c.y) - i64::from(a.y));
    ux * vy - uy * vx
}

/// Twice the area of a polygon, positive if counter-clockwise.
pub fn double_area(polygon: &[Point]) -> i64 {
    let Some(&first) = polygon.first() else { return 0 };
    polygon.windows(2).map(|w| orient(first, w[0], w[1])).sum()
}

/// Whether `p`, known to lie on the line through `a` and `b`, lies strictly between them.
pub fn is_between(a: Point, b: Point, p: Point) -> bool {
    let along = if a.x == b.x { (a.y, b.y, p.y) } else { (a.x, b.x, p.x) };
    along.0.min(along.1) < along.2 && along.2 < along.0.max(along.1)
}

/// Whether the real point `(x / w, y / w)`, `w > 0`, lies in the pixel about `p`: the half-open square
/// [p - 1/2, p + 1/2).
pub fn in_pixel(p: Point, [x, y, w]: [i128; 3]) -> bool {
    let within = |c: i128, centre: i32| {
        let low = (2 * i128::from(centre) - 1) * w;
        low <= 2 * c && 2 * c < low + 2 * w
    };
    within(x, p.x) && within(y, p.y)
}

/// Whether the closed segment from `a` to `b` meets the pixel about `p`: the half-open square [p - 1/2, p + 1/2),
/// whose left and lower sides belong to it without their right and upper ends.
pub fn segment_meets_pixel(a: Point, b: Point, p: Point) -> bool {
    // In half units, about the pixel's centre.
    let half = |c: i32, centre: i32| 2 * (i64::from(c) - i64::from(centre));
    let (ax, ay) = (half(a.x, p.x), half(a.y, p.y));
    let (bx, by) = (half(b.x, p.x), half(b.y, p.y));
    // The part of the segment in -1 <= x < 1, -1 <= y < 1: bounds on s in [0, 1], as fractions, some of them strict.
    let (dx, dy) = (bx - ax, by - ay);
    let mut low = (0i64, 1i64, false);
    let mut high = (1i64, 1i64, false);
    for (c, d) in [(ax, dx), (ay, dy)] {
        if d == 0 {
            if !(-1..1).contains(&c) {
                return false;
            }
            continue;
        }
        // Where the coordinate is -1 (which belongs to the pixel) and 1 (which does not), with positive denominators.
        let (minus, plus) = ((-1 - c) * d.signum(), (1 - c) * d.signum());
        let size = d.abs();
        let (from, to) = if d > 0 {
            ((minus, size, false), (plus, size, true))
        } else {
            ((plus, size, true), (minus, size, false))
        };
        if later(from, low) {
            low = from;
        }
        if earlier(to, high) {
            high = to;
        }
    }
    let order = compare(low, high);
    order == std::cmp::Ordering::Less || (order == std::cmp::Ordering::Equal && !low.2 && !high.2)
}

/// A fraction with a positive denominator, and whether the bound is strict.
type Bound = (i64, i64, bool);

fn compare(a: Bound, b: Bound) -> std::cmp::Ordering {
    (i128::from(a.0) * i128::from(b.1)).cmp(&(i128::from(b.0) * i128::from(a.1)))
}

/// Whether the lower bound `a` leaves less than `b`.
fn later(a: Bound, b: Bound) -> bool {
    let order = compare(a, b);
    order.is_gt() || (order.is_eq() && a.2)
}

/// Whether the upper bound `a` leaves less than `b`.
fn earlier(a: Bound, b: Bound) -> bool {
    let order = compare(a, b);
    order.is_lt() || (order.is_eq() && a.2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn p(x: i32, y: i32) -> Point {
        Point::new(x, y)
    }

    #[test]
    fn sides_are_exact_at_the_ends_of_the_lattice() {
        let far = 1 << 24;
        assert_eq!(orient(p(-far, -far), p(far, far), p(far - 1, far - 1)), 0);
        assert!(orient(p(-far, -far), p(far, far), p(far - 1, far)) > 0);
        assert_eq!(double_area(&[p(-far, -far), p(far, -far), p(far, far), p(-far, far)]), 1 << 51);
    }

    #[test]
    fn pixels_are_half_open() {
        let o = p(0, 0);
        // Through the middle, along the lower side, along the upper side (not its own).
        assert!(segment_meets_pixel(p(-3, 0), p(3, 0), o));
        assert!(!segment_meets_pixel(p(-3, 1), p(3, 1), o));
        // The line x + y = -1 passes the corner (-1/2, -1/2), which belongs to the pixel.
        assert!(segment_meets_pixel(p(-3, 2), p(2, -3), o));
        // x + y = 1 passes the corner (1/2, 1/2), which does not; x - y = 1 the corner (1/2, -1/2), which does not.
        assert!(!segment_meets_pixel(p(-2, 3), p(3, -2), o));
        assert!(!segment_meets_pixel(p(-2, -3), p(3, 2), o));
        // The segment ends before.
        assert!(!segment_meets_pixel(p(-3, 0), p(-1, 0), o));
        assert!(segment_meets_pixel(p(0, 0), p(0, 0), o));
    }

    proptest! {
        #[test]
        fn a_segment_meets_exactly_the_pixels_that_its_points_round_into(
            ends in prop::array::uniform4(-9i32..10), x in -9i32..10, y in -9i32..10,
        ) {
            let (a, b) = (p(ends[0], ends[1]), p(ends[2], ends[3]));
            // Every place where a coordinate is a multiple of 1/2 and the middles between them: if any point is in
            // the pixel then one of these is, for all bounds of the pixel are among them.
            let mut places = vec![(0i128, 1i128), (1, 1)];
            for (from, to) in [(a.x, b.x), (a.y, b.y)] {
                let d = i128::from(to) - i128::from(from);
                if d != 0 {
                    for half in -40..=40i128 {
                        let (s, size) = ((half - 2 * i128::from(from)) * d.signum(), 2 * d.abs());
                        if (0..=size).contains(&s) {
                            places.push((s, size));
                        }
                    }
                }
            }
            places.sort_by(|s, t| (s.0 * t.1).cmp(&(t.0 * s.1)));
            let middles: Vec<(i128, i128)> =
                places.windows(2).map(|w| (w[0].0 * w[1].1 + w[1].0 * w[0].1, 2 * w[0].1 * w[1].1)).collect();
            let expected = places.iter().chain(&middles).any(|&(s, size)| {
                let at = |from: i32, to: i32| i128::from(from) * size + (i128::from(to) - i128::from(from)) * s;
                in_pixel(p(x, y), [at(a.x, b.x), at(a.y, b.y), size])
            });
            prop_assert_eq!(segment_meets_pixel(a, b, p(x, y)), expected);
        }
    }
}
