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
    /// Whether it contains all of the convex hull of `points`.
    pub(super) fn contains(&self, points: &[DVec3]) -> bool {
        self.sides.iter().all(|side| points.iter().all(|&p| side.outside(p) <= TOUCH))
    }
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
/// Halving must not raise the number of pairs of halves and bodies beyond this factor.
const SPREAD: f64 = 1.25;

/// Takes convex bodies off convex polygons. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(super) struct Cutter {
    outside: Vec<f64>,
    spare: Vec<Vec<DVec3>>,
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
        if !piece.bounds.meets(body.bounds) {
            return false;
        }
        let inside = self.inside(&piece.corners, body.sides);
        let meets = !inside.is_empty();
        self.give_back(inside);
        meets
    }

    /// Puts what is left of `piece` outside of all bodies `list` on `left`.
    pub(super) fn remove<'b>(
        &mut self,
        piece: Piece,
        list: &[u32],
        body: &impl Fn(u32) -> Body<'b>,
        left: &mut Vec<Piece>,
    ) {
        self.remove_at(piece, list, body, left, 0);
    }

    fn remove_at<'b>(
        &mut self,
        piece: Piece,
        list: &[u32],
        body: &impl Fn(u32) -> Body<'b>,
        left: &mut Vec<Piece>,
        depth: u32,
    ) {
        let near: Vec<u32> = list.iter().copied().filter(|&b| body(b).bounds.meets(&piece.bounds)).collect();
        if near.iter().any(|&b| body(b).contains(&piece.corners)) {
            self.give_back(piece.corners);
            return;
        }
        if near.len() > MANY
            && depth < DEEPEST
            && let Some(halves) = self.halve(&piece)
        {
            let meet = |half: &Piece| near.iter().filter(|&&b| body(b).bounds.meets(&half.bounds)).count();
            let pairs: usize = halves.iter().map(meet).sum();
            if pairs as f64 <= SPREAD * near.len() as f64 {
                self.give_back(piece.corners);
                for half in halves {
                    self.remove_at(half, &near, body, left, depth + 1);
                }
                return;
            }
        }
        let (mut pieces, mut rest) = (vec![piece], Vec::new());
        for &b in &near {
            let body = body(b);
            for piece in pieces.drain(..) {
                if piece.bounds.meets(body.bounds) {
                    self.subtract(piece, body.sides, &mut rest);
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

    /// Puts the part of `piece` outside of `sides` on `left`, in convex pieces.
    fn subtract(&mut self, piece: Piece, sides: &[HalfSpace], left: &mut Vec<Piece>) {
        let mut crossed = false;
        for side in sides {
            match self.lie(&piece.corners, side) {
                Lie::Inside => {}
                Lie::Outside => {
                    left.push(piece);
                    return;
                }
                Lie::Across => crossed = true,
            }
        }
        if !crossed {
            self.give_back(piece.corners);
            return;
        }
        let start = left.len();
        let mut rest = self.copy(&piece.corners);
        for side in sides {
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

    fn copy(&mut self, corners: &[DVec3]) -> Vec<DVec3> {
        let mut copy = self.empty();
        copy.extend_from_slice(corners);
        copy
    }

    pub(super) fn give_back(&mut self, corners: Vec<DVec3>) {
        self.spare.push(corners);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lie {
    Inside,
    Outside,
    Across,
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
