//! A ray as the walks take it: of unit length, no farther than the hull, and what it starts on.

use glam::DVec3;

use super::ray::{Hit, Ray};
use super::single::Start;
use super::walk::{Query, Surface};
use crate::format::Views;

/// Planes nearer to the origin of a restarted ray than this, in metres per metre of coordinate, count as the one
/// that it starts on.
const ON_PLANE: f64 = 1e-11;

/// What a hit is off by, metres for each metre to it: of one far off more than its coordinates tell.
const OFF: f64 = 1e-14;

/// A vector whose squared length is no farther than this from one has unit length: no rounding brings it nearer for
/// sure.
const UNIT: f64 = 4.0 * f64::EPSILON;

/// The vector at unit length, whatever its length was; `None` if that cannot be.
#[inline]
pub(super) fn unit(vector: DVec3) -> Option<DVec3> {
    let squared = vector.length_squared();
    if (squared - 1.0).abs() <= UNIT {
        return Some(vector);
    }
    let unit = if squared > 1e-200 && squared < 1e200 {
        vector / squared.sqrt()
    } else {
        // The square of a very long or very short vector is no number: scaled first.
        (vector / vector.abs().max_element()).normalize()
    };
    unit.is_finite().then_some(unit)
}

/// A ray that meets the hull.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) tmin: f64,
    pub(super) tmax: f64,
    /// Where it enters the hull, or `tmin`.
    pub(super) start: f64,
}

impl Line {
    /// The whole of a ray, wherever it is; `None` for one without a direction.
    #[inline]
    pub(super) fn whole(ray: &Ray) -> Option<Line> {
        let (direction, origin) = (unit(DVec3::from(ray.direction))?, DVec3::from(ray.origin));
        Some(Line { origin, direction, tmin: ray.tmin, tmax: ray.tmax, start: ray.tmin })
    }

    /// `None` for a ray that is none, or that does not meet the hull.
    #[inline]
    pub(super) fn new(tables: &Views, ray: &Ray) -> Option<Line> {
        if !ray.is_valid() {
            return None;
        }
        let direction = unit(DVec3::from(ray.direction))?;
        let origin = DVec3::from(ray.origin);
        let scene = &tables.scene[0];
        let (lo, hi) = (DVec3::from(scene.hull[0]), DVec3::from(scene.hull[1]));
        let tmin = ray.tmin.max(0.0);
        let line = Line { origin, direction, tmin, tmax: ray.tmax, start: tmin };
        if tmin == 0.0 && origin.cmpge(lo).all() && origin.cmple(hi).all() {
            return Some(line);
        }
        let (mut enter, mut leave) = (tmin, ray.tmax);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < lo[axis] || o > hi[axis] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((lo[axis] - o) / d, (hi[axis] - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        // The hull has a margin around all triangles, so that rounding here loses none of them.
        (enter <= leave).then_some(Line { start: enter, ..line })
    }

    #[inline(always)]
    pub(super) fn query<'s>(&self, tables: &Views, surface: Option<&'s Surface>) -> Query<'s> {
        let scene = &tables.scene[0];
        let root = tables.cells[0].root;
        let tmin = surface.map_or(self.tmin, |surface| self.tmin - surface.behind());
        let range = (tmin, self.tmax);
        Query::new(self.origin, self.direction, range, self.start, scene, root, surface)
    }
}

/// What a restarted ray starts on.
#[inline]
pub(super) fn surface(start: Start<'_>, line: &Line) -> Option<Surface> {
    let Start::Hit(hit) = start else { return None };
    Some(surface_of(hit, line.origin, line.tmin))
}

/// The same of a ray from its hit.
#[inline]
pub(super) fn surface_of(hit: &Hit, origin: DVec3, tmin: f64) -> Surface {
    let near = (ON_PLANE * (1.0 + origin.abs().max_element())).max(OFF * hit.t);
    Surface { triangle: hit.triangle, normal: DVec3::from(hit.normal), near, aside: 0.0, tmin }
}

/// Whether a ray goes away from the surface that it starts on: not through it, be that into a solid.
#[inline]
pub(super) fn is_away(surface: &Surface, line: &Line) -> bool {
    line.direction.dot(surface.normal) > 0.0
}
