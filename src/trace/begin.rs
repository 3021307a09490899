//! Where a ray begins: in the air, inside a solid, or on a surface between the two.
//!
//! An origin within the tolerance of a surface counts as on the air side that the direction enters. So the stretches
//! between the surfaces that a ray meets within the tolerance of its origin are looked at one by one: the ray begins in
//! the first that is air. If none is, it starts inside a solid. Surfaces that touch, a table's foot on the floor, are
//! passed together.

use glam::DVec3;

use super::NONE;
use super::single::Line;
use super::walk::{Found, Query};
use crate::scene::Scene;

/// Where a ray begins.
pub(super) enum Begin {
    /// In the air, this far along: hits before do not count.
    At(f64),
    /// On the side of a solid, along which it runs: in the air this far aside.
    Beside(DVec3),
    /// Inside this solid element.
    InSolid(u32),
}

/// Surfaces no farther apart than this are one, metres, for each metre of coordinate.
const TOUCHING: f64 = 1e-9;

/// To the side of a point, to tell whether it lies between two solids: along no plane that buildings have, farther than
/// f32 coordinates of touching faces may differ by rounding, and far less than the tolerance. Metres, for each metre
/// of coordinate.
const ASIDE: DVec3 = DVec3::new(0.537e-6, 0.683e-6, 0.495e-6);

/// More surfaces than this within the tolerance of an origin are not told apart.
const MOST_SURFACES: usize = 64;

impl Scene {
    /// Whether the ray may start inside a solid or on its surface: quick, and never wrongly no.
    #[inline]
    pub(super) fn may_start_in_solid(&self, line: &Line) -> bool {
        self.may_be_in_solid((line.origin + line.direction * line.tmin).to_array())
    }

    /// Where the ray begins, given the first triangle that it meets.
    pub(super) fn begin(&self, line: &Line, found: Found, nearest: &mut impl FnMut(&Query) -> Found) -> Begin {
        let start = line.origin + line.direction * line.tmin;
        let within = found.triangle != NONE && found.t <= line.tmin + self.tolerance();
        match self.solid_near(start) {
            Some(element) if !within => Begin::InSolid(element),
            Some(element) => self.first_air(line, found, nearest).unwrap_or(Begin::InSolid(element)),
            None if within => self
                .first_air(line, found, nearest)
                .or_else(|| self.solid_near(start + line.direction * self.tolerance()).map(Begin::InSolid))
                .unwrap_or(Begin::At(line.tmin)),
            None => match self.solid_at((start + line.direction * self.tolerance()).to_array()) {
                // It starts on the surface of a solid, which rounding has put a little behind it.
                Some(element) => Begin::InSolid(element),
                None => self.air_beside(line, start).map_or(Begin::At(line.tmin), Begin::Beside),
            },
        }
    }

    /// The first stretch of air within the tolerance; `first` is the first surface.
    fn first_air(&self, line: &Line, first: Found, nearest: &mut impl FnMut(&Query) -> Found) -> Option<Begin> {
        let touching = TOUCHING * (1.0 + line.origin.abs().max_element());
        let end = line.tmin + self.tolerance();
        let at = |t: f64| line.origin + line.direction * t;
        let is_air = |from: f64, to: f64| self.solid_near(at(from + (to - from) / 2.0)).is_none();

        let on_surface = first.t - line.tmin <= touching;
        if on_surface {
            // The ray starts on a surface, and goes through it unless it comes out of a solid there.
            if self.solid_near(at(line.tmin) - line.direction * ASIDE.length()).is_none() {
                return Some(Begin::At(line.tmin));
            }
        } else if is_air(line.tmin, first.t) {
            return Some(Begin::At(line.tmin));
        }
        let mut passed = first.t;
        for _ in 0..MOST_SURFACES {
            let rest = Line { tmin: passed + touching, tmax: line.tmax.min(end), ..*line };
            let next = nearest(&rest.query(&self.tables, None));
            let until = if next.triangle == NONE { end } else { next.t };
            if until - passed > touching && is_air(passed, until) {
                return Some(Begin::At(passed + touching));
            }
            if next.triangle == NONE {
                return None;
            }
            passed = next.t;
        }
        None
    }

    /// If the ray starts on the side of a solid and runs along it: the way to the air beside it. What such a ray meets
    /// is else decided by edges that end in that side, some of them behind it.
    fn air_beside(&self, line: &Line, start: DVec3) -> Option<DVec3> {
        let aside = aside(start);
        let across = aside - line.direction * aside.dot(line.direction);
        let ahead = start + line.direction * self.tolerance();
        let is_solid = |point: DVec3| self.solid_at(point.to_array()).is_some();
        match (is_solid(start + across), is_solid(start - across)) {
            (true, false) if is_solid(ahead + across) && !is_solid(ahead - across) => Some(-across),
            (false, true) if is_solid(ahead - across) && !is_solid(ahead + across) => Some(across),
            _ => None,
        }
    }

    /// The solid that holds `point`, or, where it lies between solids that touch, one of them: such a point is inside
    /// of none, but in no air either.
    fn solid_near(&self, point: DVec3) -> Option<u32> {
        if !self.may_be_in_solid(point.to_array()) {
            return None;
        }
        self.solid_at(point.to_array()).or_else(|| {
            let aside = aside(point);
            let one = self.solid_at((point + aside).to_array())?;
            self.solid_at((point - aside).to_array()).map(|_| one)
        })
    }
}

/// [`ASIDE`] at a point.
fn aside(point: DVec3) -> DVec3 {
    ASIDE * (1.0 + point.abs().max_element())
}
