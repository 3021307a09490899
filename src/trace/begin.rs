//! Where a ray begins: in the air, inside a solid, or on a surface between the two.
//!
//! An origin within the tolerance of a surface counts as on the air side that the direction enters.
//!
//! - An origin *on* a surface, or where solids touch, is no point of either side, and what a ray along that surface
//!   would meet hangs on edges that end in it. Such a ray is replaced by a parallel one from the air some nanometres
//!   aside. If there is no air aside, it starts inside a solid.
//! - From an origin *inside* a solid, the stretches between the surfaces that the ray meets within the tolerance are
//!   looked at one by one: it begins in the first that is air. If none is, it starts inside a solid. Surfaces that
//!   touch, a table's foot on the floor, are passed together. So does a segment, wherever it ends: what it starts in does not
//!   hang on that.
//! - An origin in matter by the cells, farther than the tolerance from all their air, lies in a crack of the model, where
//!   solids are meant to touch: it starts inside a solid, if one is within the tolerance.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::NONE;
use super::line::Line;
use super::walk::{Found, Surface};
use crate::scene::Scene;

/// Where a ray begins.
pub(super) enum Begin {
    /// In the air, this far along: hits before do not count.
    At(f64),
    /// On a surface: in the air this far aside.
    Beside(DVec3),
    /// Inside this solid element.
    InSolid(u32),
}

/// Surfaces no farther apart than this are one, metres, for each metre of coordinate.
const TOUCHING: f64 = 1e-9;

/// Ways to the side of a point, in billionths of a metre for each metre of coordinate: along no plane that buildings
/// have, into all octants, farther than rounding reaches, and far less than
/// the tolerance.
pub(super) const ASIDE: [DVec3; 7] = [
    DVec3::new(0.537, 0.683, 0.495),
    DVec3::new(-0.643, 0.461, 0.611),
    DVec3::new(0.479, -0.657, 0.582),
    DVec3::new(0.621, 0.517, -0.589),
    DVec3::new(0.971, 0.173, -0.164),
    DVec3::new(-0.187, 0.967, 0.172),
    DVec3::new(0.158, -0.179, 0.971),
];

/// Each of some ways, and the other way.
pub(super) fn both_ways(ways: &[DVec3]) -> impl Iterator<Item = DVec3> {
    ways.iter().flat_map(|&way| [way, -way])
}

/// The length of a step aside of a point, metres.
pub(super) fn aside(point: DVec3) -> f64 {
    1e-9 * (1.0 + point.abs().max_element())
}

/// The same of where a ray starts, which may be far from its origin: what moves that is to be more than what it is rounded by.
fn aside_of_start(line: &Line, start: DVec3) -> f64 {
    /// Of the largest coordinate: each part of a way is some roundings.
    const FINE: f64 = 64.0 * f64::EPSILON;
    aside(start) + FINE * line.origin.abs().max_element()
}

/// More surfaces than this within the tolerance of an origin are not told apart.
const MOST_SURFACES: usize = 64;

impl Scene {
    /// Whether the ray may start inside a solid or on its surface: quick, and never wrongly no.
    #[inline]
    pub(super) fn may_start_in_solid(&self, line: &Line) -> bool {
        let start = line.origin + line.direction * line.tmin;
        // Twice as far as `begin` looks aside.
        self.may_be_in_solid(start.to_array(), 2.0 * aside_of_start(line, start))
    }

    /// Where the ray begins, be it on a surface, which it goes away from; `nearest` tells the first of all triangles that a ray meets.
    pub(super) fn begin(
        &self,
        line: &Line,
        surface: Option<&Surface>,
        nearest: &mut impl FnMut(&Line) -> Found,
    ) -> Begin {
        let start = line.origin + line.direction * line.tmin;
        let step = aside_of_start(line, start);
        let at = |way: DVec3| self.solid_at((start + way * step).to_array());
        let is_air = |way: DVec3| at(way).is_none();
        let (here, one) = (at(DVec3::ZERO), at(ASIDE[0]));
        // If these differ, it is on a surface.
        let other = if here.is_some() == one.is_some() { at(-ASIDE[0]) } else { None };
        match (here, one, other) {
            (None, None, None) if both_ways(&ASIDE[1..]).all(is_air) => Begin::At(line.tmin),
            (Some(element), Some(_), Some(_)) => {
                let line = Line { tmax: line.tmin + self.tolerance(), ..*line };
                let found = nearest(&line);
                let air = (found.triangle != NONE).then(|| self.first_air(&line, found, nearest)).flatten();
                air.unwrap_or(Begin::InSolid(element))
            }
            _ => {
                // Into the air that the direction enters, and not behind the surface if there is any before it; the first of equals.
                let is_before = |way: DVec3| surface.is_none_or(|surface| way.dot(surface.normal) > 0.0);
                let ahead = |way: DVec3| (is_before(way), way.dot(line.direction));
                let mut ways: ArrayVec<_, { 2 * ASIDE.len() }> =
                    both_ways(&ASIDE).map(|way| (ahead(way), way)).collect();
                // Mostly the best or the second best is in the air: whether one is takes longer than to look for the next.
                while !ways.is_empty() {
                    let best =
                        (1..ways.len()).fold(0, |best, i| if ways[i].0 > ways[best].0 { i } else { best });
                    let (_, way) = ways.remove(best);
                    if is_air(way) {
                        return Begin::Beside(way * step);
                    }
                }
                here.or(one).or(other).map_or(Begin::At(line.tmin), Begin::InSolid)
            }
        }
    }

    /// The first stretch of air on a ray's first tolerance; `first` is the first surface.
    fn first_air(
        &self,
        line: &Line,
        first: Found,
        nearest: &mut impl FnMut(&Line) -> Found,
    ) -> Option<Begin> {
        let touching = TOUCHING * (1.0 + line.origin.abs().max_element());
        let end = line.tmax;
        let at = |t: f64| line.origin + line.direction * t;
        let is_air = |from: f64, to: f64| self.solid_near(at(from + (to - from) / 2.0)).is_none();

        let mut passed = first.t;
        for _ in 0..MOST_SURFACES {
            let rest = Line { tmin: passed + touching, ..*line };
            let next = nearest(&rest);
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

    /// Whether no solid holds a point, nor any of those beside it: at an edge of a solid it is to one side alone.
    #[cold]
    #[inline(never)]
    pub(super) fn is_beside_solids(&self, point: DVec3) -> bool {
        let ways = std::iter::once(DVec3::ZERO).chain(both_ways(&ASIDE));
        let step = aside(point);
        ways.map(|way| point + way * step).all(|point| self.solid_at(point.to_array()).is_none())
    }

    /// A solid that holds a point within the tolerance of `point`.
    #[cold]
    pub(super) fn solid_around(&self, point: DVec3) -> Option<u32> {
        let near =
            both_ways(&ASIDE).flat_map(|way| [1.0 / 64.0, 0.5].map(|share| way * (share * self.tolerance())));
        std::iter::once(DVec3::ZERO).chain(near).find_map(|way| self.solid_at((point + way).to_array()))
    }

    /// The solid that holds `point`, or, where it lies between solids that touch, one of them.
    fn solid_near(&self, point: DVec3) -> Option<u32> {
        self.solid_at(point.to_array()).or_else(|| {
            let way = ASIDE[0] * aside(point);
            let one = self.solid_at((point + way).to_array())?;
            self.solid_at((point - way).to_array()).map(|_| one)
        })
    }
}
