//! Convex polygons in space, and what is left of them outside of convex bodies.
//!
//! All in f64 and lattice units: this serves passes that measure, with tolerances far above its rounding. Nothing here
//! decides the structure of the partition.

use glam::DVec3;

/// The points `x` with `normal . x <= offset`; `normal` is a unit vector.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

impl HalfSpace {
    /// The half-space whose boundary passes `by` beyond `at`.
    pub(super) fn beyond(normal: DVec3, at: DVec3, by: f64) -> HalfSpace {
        HalfSpace { normal, offset: normal.dot(at) + by }
    }

    /// How far outside `p` lies.
    pub(super) fn outside(&self, p: DVec3) -> f64 {
        self.normal.dot(p) - self.offset
    }
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Bounds {
    /// The box around points; of none, an empty box.
    pub(super) fn of(points: &[DVec3]) -> Bounds {
        let empty = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.iter().fold(empty, |b, &p| Bounds { low: b.low.min(p), high: b.high.max(p) })
    }

    pub(super) fn dilated(&self, by: DVec3) -> Bounds {
        Bounds { low: self.low - by, high: self.high + by }
    }

    pub(super) fn meets(&self, other: &Bounds) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// A convex body: an intersection of half-spaces, and a box around the part of it that counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<'a> {
    pub(super) bounds: &'a Bounds,
    pub(super) sides: &'a [HalfSpace],
}

impl Body<'_> {
    /// How the convex hull of `points` lies to it: `Across` also where only two of the half-spaces together keep it off.
    pub(super) fn lie(&self, points: &[DVec3]) -> Lie {
        let mut lie = Lie::Inside;
        for side in self.sides {
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for &p in points {
                let outside = side.outside(p);
                (least, most) = (least.min(outside), most.max(outside));
            }
            if least >= -TOUCH {
                return Lie::Outside;
            }
            if most > TOUCH {
                lie = Lie::Across;
            }
        }
        lie
    }
}

/// How a polygon lies to a half-space or a body; what only touches is not across.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Lie {
    Inside,
    Outside,
    Across,
}

/// A convex polygon and its box.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) corners: Vec<DVec3>,
    pub(super) bounds: Bounds,
}

impl Piece {
    pub(super) fn new(corners: Vec<DVec3>) -> Piece {
        let bounds = Bounds::of(&corners);
        Piece { corners, bounds }
    }

    /// Its area, square lattice units.
    pub(super) fn area(&self) -> f64 {
        area(&self.corners)
    }

    /// The middle of its corners.
    pub(super) fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / self.corners.len().max(1) as f64
    }

    /// The distance of the closest parallel lines between which it fits.
    fn width(&self) -> f64 {
        let count = self.corners.len();
        let across = |i: usize| {
            let start = self.corners[i];
            let along = (self.corners[(i + 1) % count] - start).try_normalize()?;
            Some(self.corners.iter().map(|&p| (p - start).cross(along).length()).fold(0.0, f64::max))
        };
        let width = (0..count).filter_map(across).fold(f64::INFINITY, f64::min);
        if width.is_finite() { width } else { 0.0 }
    }
}

/// The area of a planar polygon.
pub(super) fn area(corners: &[DVec3]) -> f64 {
    let Some(&first) = corners.first() else { return 0.0 };
    let twice: DVec3 = corners.windows(2).map(|w| (w[0] - first).cross(w[1] - first)).sum();
    twice.length() / 2.0
}

/// Whether pieces of one plane are more than slivers: one of them is wider than `width`, or all of them together
/// have more area than a strip of that width along all their extent.
pub(super) fn are_wider(pieces: &[Piece], width: f64) -> bool {
    if pieces.iter().any(|piece| piece.width() > width) {
        return true;
    }
    let all = pieces
        .iter()
        .map(|piece| piece.bounds)
        .reduce(|a, b| Bounds { low: a.low.min(b.low), high: a.high.max(b.high) });
    let extent = all.map_or(0.0, |all| (all.high - all.low).length());
    pieces.iter().map(Piece::area).sum::<f64>() > width * extent
}

/// A polygon that reaches no farther than this beyond a plane does not cross it, lattice units: a nanometre or two.
const TOUCH: f64 = 1e-4;
/// With more bodies near, a piece is halved first, so that each half meets fewer.
const MANY: usize = 12;
/// Halving a piece ends at this depth.
const DEEPEST: u32 = 32;
/// Halving is worth it if it does not raise the number of pairs of halves and bodies beyond this factor.
const SPREAD: f64 = 1.25;
/// Where it is not, one body is taken off instead, so many times in a row: all needles of a fan meet both halves if these
/// meet in the fan's middle, until that is taken off; of bodies in one place, one takes off what all do.
const PATIENCE: u32 = 4;

/// Taking bodies off a polygon ends after so many steps, and [`STEPS_EACH`] for each of the bodies.
const STEPS: usize = 3_000_000;
/// See [`STEPS`].
const STEPS_EACH: usize = 200;

/// Takes convex bodies off convex polygons. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(super) struct Cutter {
    outside: Vec<f64>,
    spare: Vec<Vec<DVec3>>,
    /// Steps left.
    steps: usize,
}

impl Cutter {
    /// The part of `corners` in all of `sides`; empty if they have no more in common than a touch.
    pub(super) fn inside(&mut self, corners: &[DVec3], sides: &[HalfSpace]) -> Vec<DVec3> {
        let mut rest = self.copy(corners);
        for side in sides {
            match self.lie(&rest, side) {
                Lie::Inside => {}
                Lie::Outside => {
                    rest.clear();
                    return rest;
                }
                Lie::Across => {
                    let [inside, outside] = self.split(&rest);
                    self.give_back(rest);
                    self.give_back(outside);
                    rest = inside;
                }
            }
        }
        rest
    }

    /// Whether a polygon and the body have more in common than a touch.
    pub(super) fn meets(&mut self, piece: &Piece, body: Body<'_>) -> bool {
        match lie_near(body, piece) {
            Lie::Outside => false,
            Lie::Inside => true,
            Lie::Across => {
                let inside = self.inside(&piece.corners, body.sides);
                let meets = !inside.is_empty();
                self.give_back(inside);
                meets
            }
        }
    }

    /// Puts what is left of `piece` outside of all bodies `list` on `left`. Returns whether that is all that was taken
    /// off: it is not where thousands of bodies crowd so that it would take too long; then too much is left.
    pub(super) fn remove<'b>(
        &mut self,
        piece: Piece,
        list: impl Iterator<Item = u32>,
        body: &impl Fn(u32) -> Body<'b>,
        left: &mut Vec<Piece>,
    ) -> bool {
        let Some(near) = near_of(&piece, list, body) else {
            self.give_back(piece.corners);
            return true;
        };
        self.steps = STEPS + STEPS_EACH * near.len();
        self.remove_near(piece, &near, body, left, [0, PATIENCE]);
        self.steps > 0
    }

    /// Takes off bodies to all of which the piece lies across.
    fn remove_near<'b>(
        &mut self,
        piece: Piece,
        near: &[u32],
        body: &impl Fn(u32) -> Body<'b>,
        left: &mut Vec<Piece>,
        [depth, patience]: [u32; 2],
    ) {
        if near.len() <= MANY || depth >= DEEPEST || self.steps == 0 {
            self.remove_in_turn(piece, near, body, left);
            return;
        }
        let halves = self.halve(&piece).map(|halves| {
            halves.map(|half| {
                let near = near_of(&half, near.iter().copied(), body);
                (half, near)
            })
        });
        self.steps = self.steps.saturating_sub(2 * near.len());
        if let Some(halves) = halves {
            let pairs: usize = halves.iter().filter_map(|half| half.1.as_ref()).map(Vec::len).sum();
            let is_good = pairs as f64 <= SPREAD * near.len() as f64;
            for (half, near) in halves {
                match near {
                    Some(near) if is_good => {
                        self.remove_near(half, &near, body, left, [depth + 1, PATIENCE]);
                    }
                    _ => self.give_back(half.corners),
                }
            }
            if is_good {
                self.give_back(piece.corners);
                return;
            }
        }
        if patience == 0 {
            self.remove_in_turn(piece, near, body, left);
            return;
        }
        let mut parts = Vec::new();
        self.subtract(piece, body(near[near.len() / 2]), &mut parts);
        for part in parts {
            self.steps = self.steps.saturating_sub(near.len());
            match near_of(&part, near.iter().copied(), body) {
                Some(near) => self.remove_near(part, &near, body, left, [depth + 1, patience - 1]),
                None => self.give_back(part.corners),
            }
        }
    }

    /// Takes off one body after the other.
    fn remove_in_turn<'b>(
        &mut self,
        piece: Piece,
        near: &[u32],
        body: &impl Fn(u32) -> Body<'b>,
        left: &mut Vec<Piece>,
    ) {
        let (mut pieces, mut rest) = (vec![piece], Vec::new());
        for &b in near {
            if self.steps == 0 {
                break;
            }
            let body = body(b);
            self.steps = self.steps.saturating_sub(pieces.len());
            for piece in pieces.drain(..) {
                if piece.bounds.meets(body.bounds) {
                    self.subtract(piece, body, &mut rest);
                } else {
                    rest.push(piece);
                }
            }
            std::mem::swap(&mut pieces, &mut rest);
            if pieces.is_empty() {
                return;
            }
        }
        left.append(&mut pieces);
    }

    /// Puts the part of `piece` outside of `body` on `left`, in convex pieces.
    fn subtract(&mut self, piece: Piece, body: Body<'_>, left: &mut Vec<Piece>) {
        match body.lie(&piece.corners) {
            Lie::Outside => {
                left.push(piece);
                return;
            }
            Lie::Inside => {
                self.give_back(piece.corners);
                return;
            }
            Lie::Across => {}
        }
        let start = left.len();
        let mut rest = self.copy(&piece.corners);
        for side in body.sides {
            match self.lie(&rest, side) {
                Lie::Inside => {}
                Lie::Outside => {
                    // The body passes by: the piece stays whole.
                    for fragment in left.drain(start..) {
                        self.spare.push(fragment.corners);
                    }
                    self.give_back(rest);
                    left.push(piece);
                    return;
                }
                Lie::Across => {
                    let [inside, outside] = self.split(&rest);
                    left.push(Piece::new(outside));
                    self.give_back(rest);
                    rest = inside;
                }
            }
        }
        self.give_back(rest);
        self.give_back(piece.corners);
    }

    /// Two halves of a piece, across its longest extent; `None` of one too small.
    fn halve(&mut self, piece: &Piece) -> Option<[Piece; 2]> {
        let extent = piece.bounds.high - piece.bounds.low;
        let normal = if extent.x >= extent.y && extent.x >= extent.z {
            DVec3::X
        } else if extent.y >= extent.z {
            DVec3::Y
        } else {
            DVec3::Z
        };
        let middle = (piece.bounds.low + piece.bounds.high) / 2.0;
        match self.lie(&piece.corners, &HalfSpace::beyond(normal, middle, 0.0)) {
            Lie::Across => Some(self.split(&piece.corners).map(Piece::new)),
            _ => None,
        }
    }

    /// How a polygon lies to a half-space. Leaves each corner's distance in `self.outside` for [`Cutter::split`].
    fn lie(&mut self, corners: &[DVec3], side: &HalfSpace) -> Lie {
        self.outside.clear();
        self.outside.extend(corners.iter().map(|&p| side.outside(p)));
        let (least, most) =
            self.outside.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), &d| (l.min(d), m.max(d)));
        if most <= TOUCH {
            Lie::Inside
        } else if least >= -TOUCH {
            Lie::Outside
        } else {
            Lie::Across
        }
    }

    /// The parts of a polygon inside and outside of the half-space that [`Cutter::lie`] was asked for last.
    fn split(&mut self, corners: &[DVec3]) -> [Vec<DVec3>; 2] {
        let (mut inside, mut outside) = (self.empty(), self.empty());
        for i in 0..corners.len() {
            let next = (i + 1) % corners.len();
            let (here, there) = (self.outside[i], self.outside[next]);
            if here <= 0.0 {
                inside.push(corners[i]);
            }
            if here >= 0.0 {
                outside.push(corners[i]);
            }
            if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
                let at = corners[i].lerp(corners[next], here / (here - there));
                inside.push(at);
                outside.push(at);
            }
        }
        [inside, outside]
    }

    fn empty(&mut self) -> Vec<DVec3> {
        let mut corners = self.spare.pop().unwrap_or_default();
        corners.clear();
        corners
    }

    pub(super) fn copy(&mut self, corners: &[DVec3]) -> Vec<DVec3> {
        let mut copy = self.empty();
        copy.extend_from_slice(corners);
        copy
    }

    pub(super) fn give_back(&mut self, corners: Vec<DVec3>) {
        self.spare.push(corners);
    }
}

/// Those of the bodies to which a piece lies across; `None` if it lies in one.
fn near_of<'b>(
    piece: &Piece,
    list: impl Iterator<Item = u32>,
    body: &impl Fn(u32) -> Body<'b>,
) -> Option<Vec<u32>> {
    let mut near = Vec::new();
    for b in list {
        match lie_near(body(b), piece) {
            Lie::Inside => return None,
            Lie::Across => near.push(b),
            Lie::Outside => {}
        }
    }
    Some(near)
}

fn lie_near(body: Body<'_>, piece: &Piece) -> Lie {
    if piece.bounds.meets(body.bounds) { body.lie(&piece.corners) } else { Lie::Outside }
}

/// Where two neighbouring sides of a body make an angle so acute that moving them outward moves their edge away, a third
/// side holds it back: the greatest cosine of the angle between their normals.
pub(super) const ACUTE: f64 = -0.25;

/// Half-spaces around a triangle seen along the unit vector `axis` (its corners counter-clockwise, seen from where the axis
/// points): its edges moved out by `rim`, and the points over which, along the axis, its plane is no farther than `reach`.
/// `None` if it has no area there.
pub(super) fn around_triangle(
    corners: &[DVec3; 3],
    axis: DVec3,
    rim: f64,
    reach: f64,
    sides: &mut Vec<HalfSpace>,
) -> Option<()> {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).try_normalize()?;
    let slope = normal.dot(axis);
    // Edges along the axis have no direction across it.
    let flat = |v: DVec3| (v - axis * v.dot(axis)).try_normalize();
    let along = [0, 1, 2].map(|i| flat(corners[(i + 1) % 3] - corners[i]));
    let [Some(a), Some(b), Some(c)] = along else { return None };
    let along = [a, b, c];
    for i in 0..3 {
        sides.push(HalfSpace::beyond(along[i].cross(axis), corners[i], rim));
        let before = along[(i + 2) % 3];
        // The normals' angle is the edges'.
        if before.dot(along[i]) < ACUTE
            && let Some(out) = (before - along[i]).try_normalize()
        {
            sides.push(HalfSpace::beyond(out, corners[i], rim));
        }
    }
    sides.push(HalfSpace::beyond(normal, corners[0], reach * slope.abs()));
    sides.push(HalfSpace::beyond(-normal, corners[0], reach * slope.abs()));
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle_bodies(triangles: &[[DVec3; 3]]) -> Vec<(Bounds, Vec<HalfSpace>)> {
        let body = |t: &[DVec3; 3]| {
            let mut sides = Vec::new();
            around_triangle(t, DVec3::Z, 0.0, 1.0, &mut sides).unwrap();
            (Bounds::of(t).dilated(DVec3::ONE), sides)
        };
        triangles.iter().map(body).collect()
    }

    /// What is left of the square of 10,000 units about the origin.
    fn left_of_square(bodies: &[(Bounds, Vec<HalfSpace>)]) -> (bool, Vec<Piece>) {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let square = square.map(|[x, y]| DVec3::new(x, y, 0.0) * 5000.0);
        let mut left = Vec::new();
        let body = |b: u32| Body { bounds: &bodies[b as usize].0, sides: &bodies[b as usize].1 };
        let all = 0..bodies.len() as u32;
        let is_done = Cutter::default().remove(Piece::new(square.to_vec()), all, &body, &mut left);
        (is_done, left)
    }

    #[test]
    fn a_fan_of_needles_leaves_what_is_around_it() {
        let count = 700;
        let rim = |i: usize| {
            let angle = i as f64 / f64::from(count) * std::f64::consts::TAU;
            DVec3::new(angle.cos(), angle.sin(), 0.0) * 4000.0
        };
        let fan: Vec<_> = (0..count as usize).map(|i| [DVec3::ZERO, rim(i), rim(i + 1)]).collect();
        let disc: f64 = fan.iter().map(|t| area(t)).sum();
        let (is_done, left) = left_of_square(&triangle_bodies(&fan));
        assert!(is_done);
        let sum: f64 = left.iter().map(Piece::area).sum();
        assert!((sum - (1e8 - disc)).abs() < 10.0, "{sum} {disc}");
    }

    #[test]
    fn thousands_of_bodies_in_one_place_leave_what_one_does() {
        let one = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0) * 6000.0);
        let (is_done, left) = left_of_square(&triangle_bodies(&vec![one; 20_000]));
        assert!(is_done);
        assert!((left.iter().map(Piece::area).sum::<f64>() - 5e7).abs() < 1.0);
    }

    #[test]
    fn what_would_take_too_long_ends_and_says_so() {
        // Random needles through the whole square: a hundred million crossings.
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let needle = |_| {
            let angle = random() * std::f64::consts::TAU;
            let along = DVec3::new(angle.cos(), angle.sin(), 0.0);
            let across = DVec3::new(-angle.sin(), angle.cos(), 0.0);
            let middle = across * (random() - 0.5) * 9000.0;
            [middle - along * 9000.0, middle + along * 9000.0, middle + along * 9000.0 + across * 0.01]
        };
        let needles: Vec<_> = (0..20_000).map(needle).collect();
        let (is_done, left) = left_of_square(&triangle_bodies(&needles));
        assert!(!is_done);
        let sum = left.iter().map(Piece::area).sum::<f64>();
        assert!(sum > 0.9e8 && sum <= 1e8 + 1.0, "{sum}");
    }

    #[test]
    fn slivers_are_told_by_width_and_by_area() {
        let strip = |at: f64, wide: f64, long: f64| {
            let corner = |x: f64, y: f64| DVec3::new(x, at + y, 0.0);
            let corners = [corner(0.0, 0.0), corner(long, 0.0), corner(long, wide), corner(0.0, wide)];
            Piece::new(corners.to_vec())
        };
        assert!(!are_wider(&[], 1.0));
        assert!(!are_wider(&[strip(0.0, 0.9, 1000.0)], 1.0));
        assert!(are_wider(&[strip(0.0, 1.1, 1000.0)], 1.0));
        // Two narrow strips beside each other are one wide one; a wide crumb is not made narrow by what is far away.
        assert!(are_wider(&[strip(0.0, 0.9, 1000.0), strip(0.9, 0.9, 1000.0)], 1.0));
        assert!(are_wider(&[strip(0.0, 3.0, 3.0), strip(1e6, 0.1, 10.0)], 1.0));
    }

    #[test]
    fn an_acute_corner_moves_out_no_farther_than_two_rims() {
        let needle = [[0.0, 0.0], [1000.0, 0.0], [1000.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let mut sides = Vec::new();
        around_triangle(&needle, DVec3::Z, 1.0, 5.0, &mut sides).unwrap();
        let bounds = Bounds::of(&needle).dilated(DVec3::splat(10.0));
        let body = Body { bounds: &bounds, sides: &sides };
        assert_eq!(body.lie(&[DVec3::new(-0.9, 0.0, 4.9)]), Lie::Inside);
        assert_eq!(body.lie(&[DVec3::new(-2.0, 0.0, 0.0)]), Lie::Outside);
        assert_eq!(body.lie(&[DVec3::new(500.0, 0.0, 5.1)]), Lie::Outside);
    }
}
