//! Rays in the plan: on which side of it a vertical edge lies, and where it enters and leaves a footprint.
//!
//! *The consistent side rule.* A ray's side of a vertical edge is computed from that edge's vertex and the ray's 2-D
//! Pluecker coordinates alone, by [`PlanLine::side`], and its sign is exact. A vertex on the line counts as on its
//! left, for every cell alike, as if the line ran a hair further right. So all cells that share a vertex agree; the
//! line enters a convex footprint through exactly one of its edges and leaves it through exactly one other, or misses
//! it; and the cells that it crosses follow each other without a gap and without a loop.

use glam::DVec3;

use crate::format::records::SideRecord;

/// Shorter than this in the plan, a unit direction is vertical: over a kilometre it moves aside by a picometre.
const VERTICAL: f64 = 1e-15;

/// A ray seen from above, relative to the lattice's origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlanLine {
    /// Where `t` is 0.
    origin: [f64; 2],
    direction: [f64; 2],
    /// The third Pluecker coordinate: direction y times origin x, less direction x times origin y.
    moment: f64,
    /// A side nearer to 0 than this may have the wrong sign.
    doubt: f64,
    /// 1 by the direction's squared length.
    inverse: f64,
    /// The direction's length.
    pub(super) length: f64,
    /// The direction is that of x, and stands for none: the ray is vertical.
    pub(super) vertical: bool,
}

/// Where a line leaves a footprint: the parameter along the ray (for vertical rays: along x), and the side through which.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub(super) leave: f64,
    pub(super) side: usize,
    /// The least side of all corners, in size: how near the line passes a vertical edge, times [`PlanLine::length`].
    pub(super) nearest: f64,
    /// How far the line goes on when it is moved by 1 across the side: 1 at right angles, more if it is aslant.
    pub(super) slant: f64,
}

impl PlanLine {
    /// The line of a ray from `origin` along the unit vector `direction`, for vertices with coordinates of at most `reach`.
    #[inline]
    pub(super) fn new(origin: DVec3, direction: DVec3, reach: f64) -> PlanLine {
        let mut d = [direction.x, direction.y].map(|c| if c.abs() < VERTICAL { 0.0 } else { c });
        let vertical = d == [0.0; 2];
        if vertical {
            d = [1.0, 0.0];
        }
        let moment = d[1] * origin.x - d[0] * origin.y;
        // Two products and two sums, each off by at most 2^-53 of its result: less than this by a half.
        let doubt = (-50f64).exp2() * ((d[0].abs() + d[1].abs()) * reach + moment.abs());
        let squared = d[0] * d[0] + d[1] * d[1];
        let (inverse, length) = (1.0 / squared, squared.sqrt());
        PlanLine { origin: [origin.x, origin.y], direction: d, moment, doubt, inverse, length, vertical }
    }

    /// The vertex's side of the line: negative on its right, else on its left or on it. The sign is exact, the size is
    /// that of the distance times the direction's length, to rounding.
    #[inline(always)]
    pub(super) fn side(&self, vertex: [f32; 2]) -> f64 {
        let [x, y] = vertex.map(f64::from);
        let side = self.direction[0] * y - self.direction[1] * x + self.moment;
        if side.abs() > self.doubt { side } else { self.exact_side(x, y, side) }
    }

    /// The side with the sign of the exact sum.
    #[cold]
    fn exact_side(&self, x: f64, y: f64, rounded: f64) -> f64 {
        // Coordinates of 25 bits and directions no shorter than `VERTICAL`: nothing underflows.
        let (a, a_rest) = product(self.direction[0], y);
        let (b, b_rest) = product(-self.direction[1], x);
        let size = rounded.abs();
        if sum_is_negative([a_rest, a, b_rest, b, self.moment]) { -size.max(f64::MIN_POSITIVE) } else { size }
    }

    /// Where the line crosses a convex, counter-clockwise footprint; `None` if it misses it.
    #[inline]
    pub(super) fn span(&self, sides: &[SideRecord]) -> Option<Span> {
        let mut before = *sides.last()?;
        let mut from = self.side(before.start);
        let mut leave = None;
        let mut nearest = f64::INFINITY;
        for (i, here) in sides.iter().enumerate() {
            let to = self.side(here.start);
            nearest = nearest.min(to.abs());
            if (from < 0.0) != (to < 0.0) {
                // From its right to its left: the line leaves.
                if from < 0.0 {
                    let t = self.crossing(before.start, here.start, from, to);
                    leave = Some((t, i, slant(before.start, here.start, from - to)));
                }
            }
            (before, from) = (*here, to);
        }
        let (leave, next, slant) = leave?;
        let side = (next + sides.len() - 1) % sides.len();
        Some(Span { leave, side, nearest, slant })
    }

    /// Where the line crosses the edge between two vertices, of which just one is on its right. Never beyond the edge's
    /// ends: so that a line that runs along it crosses it somewhere on it.
    #[inline(always)]
    fn crossing(&self, from: [f32; 2], to: [f32; 2], side_from: f64, side_to: f64) -> f64 {
        let share = (side_from / (side_from - side_to)).clamp(0.0, 1.0);
        let at = |axis: usize| {
            let (a, b) = (f64::from(from[axis]), f64::from(to[axis]));
            (a - self.origin[axis] + share * (b - a)) * self.direction[axis]
        };
        (at(0) + at(1)) * self.inverse
    }
}

/// How far along itself a line crosses an edge later when it is moved by 1 across it; `sides`: the difference of its ends'
/// sides. A little too much: no root.
#[inline(always)]
fn slant(from: [f32; 2], to: [f32; 2], sides: f64) -> f64 {
    let length = f64::from((from[0] - to[0]).abs()) + f64::from((from[1] - to[1]).abs());
    length / sides.abs()
}

/// The product and what its rounding lost.
fn product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// Whether the exact sum is negative: Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997, figure 6.
fn sum_is_negative(terms: [f64; 5]) -> bool {
    let mut expansion = [0.0f64; 5];
    for (count, term) in terms.into_iter().enumerate() {
        let mut sum = term;
        for part in &mut expansion[..count] {
            let (a, b) = (sum, *part);
            sum = a + b;
            let shadow = sum - a;
            *part = (a - (sum - shadow)) + (b - shadow);
        }
        expansion[count] = sum;
    }
    // The largest part that is not 0 has the sign of the sum.
    expansion.iter().rev().find(|part| **part != 0.0).is_some_and(|part| *part < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Where the line enters a footprint that it crosses, and through which side.
    fn entry(line: &PlanLine, sides: &[SideRecord]) -> (f64, usize) {
        let side = |i: usize| line.side(sides[i % sides.len()].start);
        let i = (0..sides.len()).find(|&i| side(i) >= 0.0 && side(i + 1) < 0.0).unwrap();
        (line.crossing(sides[i].start, sides[(i + 1) % sides.len()].start, side(i), side(i + 1)), i)
    }

    fn footprint(points: &[[f32; 2]]) -> Vec<SideRecord> {
        points.iter().map(|&start| SideRecord { start, first_face: 0, faces: 1 }).collect()
    }

    #[test]
    fn a_square_is_crossed_once() {
        let square = footprint(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let line = |x: f64, y: f64, dx: f64, dy: f64| {
            PlanLine::new(DVec3::new(x, y, 0.0), DVec3::new(dx, dy, 0.0).normalize(), 256.0)
        };
        let through = line(-1.0, 0.25, 1.0, 0.0);
        let span = through.span(&square).unwrap();
        assert_eq!((span.leave, span.side), (2.0, 1));
        assert_eq!(entry(&through, &square), (1.0, 3));
        // Along its lower edge the line counts as running on the right of it: outside. Along the upper edge: inside.
        assert!(line(-1.0, 0.0, 1.0, 0.0).span(&square).is_none());
        assert!(line(-1.0, 1.0, 1.0, 0.0).span(&square).is_some());
        assert!(line(-1.0, -1.0, 1.0, 1.0).span(&square).is_some());
        assert!(line(-1.0, 2.0, 1.0, 0.0).span(&square).is_none());
    }

    proptest! {
        /// Sides of vertices near a line, against whole numbers.
        #[test]
        fn sides_are_exact(
            a in prop::array::uniform2(-1i64 << 24..1 << 24), d in prop::array::uniform2(-4000i64..4000),
            steps in -4000i64..4000, aside in prop::array::uniform2(-2i64..=2),
        ) {
            prop_assume!(d != [0, 0]);
            let v = [a[0] / 4 + d[0] * steps / 2 + aside[0], a[1] / 4 + d[1] * steps / 2 + aside[1]];
            let size = 1.0 / 65536.0;
            let line = PlanLine {
                origin: [0.0; 2],
                direction: d.map(|c| c as f64),
                // At a quarter of what `v` is measured from, so that this is exact too.
                moment: (d[1] * (a[0] / 4) - d[0] * (a[1] / 4)) as f64 * size,
                doubt: 1e30,
                inverse: 1.0,
                length: 1.0,
                vertical: false,
            };
            let exact = i128::from(d[0]) * i128::from(v[1]) - i128::from(d[1]) * i128::from(v[0])
                + i128::from(d[1] * (a[0] / 4) - d[0] * (a[1] / 4));
            let side = line.side(v.map(|c| (c as f64 * size) as f32));
            prop_assert_eq!(side < 0.0, exact < 0, "{} {}", side, exact);
        }

        /// A square cut into four triangles around a point: where a line leaves one through an edge, it enters the other
        /// that has it; and through the square it comes without a gap.
        #[test]
        fn neighbours_agree(
            middle in prop::array::uniform2(1i32..64), from in prop::array::uniform2(-8i32..72),
            to in prop::array::uniform2(-8i32..72), turn in -1e-9f64..1e-9, exactly in any::<bool>(),
        ) {
            prop_assume!(from != to);
            let corner = |x: i32, y: i32| [x as f32 / 8.0, y as f32 / 8.0];
            let ring = [corner(0, 0), corner(64, 0), corner(64, 64), corner(0, 64)];
            let middle = corner(middle[0], middle[1]);
            let origin = DVec3::new(f64::from(from[0]) / 8.0, f64::from(from[1]) / 8.0, 0.0);
            let toward = DVec3::new(f64::from(to[0]) / 8.0, f64::from(to[1]) / 8.0, 0.0);
            let turn = if exactly { 0.0 } else { turn };
            let direction = (toward - origin + DVec3::new(turn, -turn, 0.0)).normalize();
            let line = PlanLine::new(origin, direction, 256.0);
            let whole = line.span(&footprint(&ring));
            let (mut entered, mut left) = ([0; 4], [0; 4]);
            let (mut outer, mut length) = (0, 0.0);
            for i in 0..4 {
                // Sides: from the middle to corner i, along the ring, and back.
                let sides = footprint(&[middle, ring[i], ring[(i + 1) % 4]]);
                let Some(span) = line.span(&sides) else { continue };
                let (enter, side) = entry(&line, &sides);
                length += span.leave - enter;
                match span.side {
                    0 => left[i] += 1,
                    1 => outer += 1,
                    _ => left[(i + 1) % 4] += 1,
                }
                match side {
                    0 => entered[i] += 1,
                    1 => outer += 1,
                    _ => entered[(i + 1) % 4] += 1,
                }
            }
            prop_assert_eq!(entered, left);
            prop_assert_eq!(outer, if whole.is_some() { 2 } else { 0 });
            let expected = whole.map_or(0.0, |span| span.leave - entry(&line, &footprint(&ring)).0);
            prop_assert!((length - expected).abs() < 1e-9, "{} {}", length, expected);
        }

        #[test]
        fn sums_have_the_right_sign(high in -1000i64..1000, low in -1000i64..1000, shift in 0i32..100) {
            // high + low 2^-shift - high, in an order that loses the middle term.
            let small = low as f64 * 2f64.powi(-shift);
            let sum = [small, high as f64 * 1e10, 0.0, -(high as f64) * 1e10, 0.0];
            prop_assert_eq!(sum_is_negative(sum), low < 0);
        }
    }
}
