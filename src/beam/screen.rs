//! Planes as a picture sees them.
//!
//! Along the ray through a pixel every plane is met at a `t` whose inverse is linear in the pixel's column and row; so which of two planes is met
//! first is told by a straight line of the picture. No vertex is projected, and nothing is clipped at a near plane.

use glam::{DVec2, DVec3};

use super::rows::Line;
use crate::format::records::PlaneRecord;
use crate::render::Pinhole;
use crate::scene::Scene;
use crate::trace::Prisms;

/// The eye is taken to be so far, metres, from where it is, in a direction that no building has: then it lies in no plane of a cell.
/// Seen from a metre away that is a millionth of a pixel. Less, in a building of millimetres.
const ASIDE: DVec3 = DVec3::new(0.754_877_666e-9, 0.569_840_291e-9, 0.430_159_709e-9);

/// No more than this share of the tolerance.
const ASIDE_SHARE: f64 = 1e-6;

/// No less than this share of a scene's largest coordinate, which are tens of roundings.
const ASIDE_LEAST: f64 = 1e-14;

/// How far eyes are moved along each axis of a scene's lattice.
pub(crate) fn aside(scene: &Scene) -> DVec3 {
    let [lo, hi] = scene.hull().map(|corner| DVec3::from(corner).abs().max_element());
    let most = (ASIDE_SHARE * scene.tolerance()).min(ASIDE.x);
    ASIDE * (most.max(ASIDE_LEAST * lo.max(hi)) / ASIDE.x)
}

/// An eye that is farther outside of its own cell than this, metres, counts as this far inside.
const WITHIN: f64 = 1e-12;

/// A picture's rays, along the lattice's axes from its origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Screen {
    pub(crate) eye: DVec3,
    /// From the eye to the centre of the first pixel, one column on, and one row on.
    pub(crate) first: DVec3,
    pub(crate) across: DVec3,
    pub(crate) down: DVec3,
}

impl Screen {
    /// The eye is moved by `aside` along the lattice's axes.
    pub(crate) fn new(pinhole: &Pinhole, prisms: &Prisms<'_>, aside: DVec3) -> Screen {
        let [eye, corner, across, down] = pinhole.parts();
        let [corner, across, down] = [corner, across, down].map(|d| prisms.turned(d));
        let first = corner + (across + down) * 0.5;
        Screen { eye: prisms.local(eye) + aside, first, across, down }
    }

    /// The same along the internal frame's axes.
    pub(crate) fn internal(&self, prisms: &Prisms<'_>) -> Screen {
        let [first, across, down] = [self.first, self.across, self.down].map(|d| prisms.turned_back(d));
        Screen { eye: prisms.global(self.eye), first, across, down }
    }

    /// How a direction's part along `normal` goes with column and row.
    pub(crate) fn along(&self, normal: DVec3) -> [f64; 3] {
        [self.across, self.down, self.first].map(|d| d.dot(normal))
    }

    /// The floor (`up` is -1) or ceiling (1) of a cell.
    pub(crate) fn level(&self, plane: PlaneRecord, up: f64) -> Plane {
        let PlaneRecord { slope: [p, q], height } = plane;
        let over = self.eye.z - p * self.eye.x - q * self.eye.y - height;
        self.plane(DVec3::new(-p, -q, 1.0) * up, over * up)
    }

    /// The upright plane over a side, which goes from `a` to `b`.
    pub(crate) fn upright(&self, a: DVec2, b: DVec2) -> Plane {
        let (edge, eye) = (b - a, self.eye.truncate());
        let normal = DVec2::new(edge.y, -edge.x);
        self.plane(normal.extend(0.0), normal.dot(eye - a))
    }

    /// The line through the eye's place in the plan and a corner: rays to the left of it, seen from above, are on its positive side.
    pub(crate) fn past(&self, corner: DVec2) -> (DVec2, Line) {
        let way = corner - self.eye.truncate();
        (way, Line(self.along(DVec3::new(-way.y, way.x, 0.0))))
    }

    /// The plane with the outward `normal`, outside of which the eye is by `away` times the normal's length.
    pub(crate) fn plane(&self, normal: DVec3, away: f64) -> Plane {
        Plane { size: normal.length(), grows: self.along(normal), away, off: Off::default() }
    }
}

/// A plane as a picture sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    /// The length of its normal.
    pub(crate) size: f64,
    /// How much farther outside the ray through a pixel comes with each unit of `t`: with column, with row, and in the first pixel.
    pub(crate) grows: [f64; 3],
    /// How far outside the eye is; negative inside.
    pub(crate) away: f64,
    /// How far, metres, it may be off.
    pub(crate) off: Off,
}

/// How far a plane of a cell may be off what it stands for, metres: 0 where that is exact.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Off {
    /// Where it meets other planes.
    pub(crate) at_edges: f64,
    /// The faces in it; 0 if there are none, so that what crosses it goes on beyond.
    pub(crate) faces: f64,
}

impl Plane {
    /// Whether a ray from the eye, which is within, may leave through it.
    pub(crate) fn is_exit(&self) -> bool {
        self.away < 0.0
    }

    /// The same with the outside in.
    pub(crate) fn turned(&self) -> Plane {
        Plane { grows: self.grows.map(|c| -c), away: -self.away, ..*self }
    }

    /// The rays that come nearer to it, of an eye that is outside, are on this line's positive side.
    pub(crate) fn ahead(&self) -> Line {
        Line(self.grows.map(|c| -c))
    }

    /// The same plane, of a cell that holds the eye.
    pub(crate) fn around_eye(self) -> Plane {
        Plane { away: self.away.min(-WITHIN), ..self }
    }

    /// The same plane, off by so much.
    pub(crate) fn off_by(self, off: Off) -> Plane {
        Plane { off, ..self }
    }

    /// Where rays that leave through `exit` do so outside of this plane: there the line's positive side is. Of rays from outside that come through `exit` the
    /// other way it is where they do so inside.
    pub(crate) fn beyond_at(&self, exit: &Plane) -> Line {
        let along = |i: usize| self.away * exit.grows[i] - exit.away * self.grows[i];
        Line([along(0), along(1), along(2)])
    }
}
