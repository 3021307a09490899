//! Where a ray goes on from a surface: its origin, which rounding may have put behind that surface, or into another solid beside it.

use enfilade_importers::Role;
use glam::DVec3;

use super::NONE;
use super::begin::{ASIDE, aside, both_ways};
use super::cells::among_all;
use super::kernel::{Ask, Plain};
use super::line::Line;
use super::walk::{Found, ROUNDING, Surface, Walk};
use crate::format::records::{Facing, VolumeRecord};
use crate::scene::Scene;

/// What a ray came to is off by so much, metres for each metre of coordinate, where it came along it almost.
const DEEP: f64 = 1e-7;

/// What a face that counts as planar is off its plane by, metres, at most.
const UNEVEN: f64 = 2e-6;

/// No farther than so many times the tolerance is an origin moved.
const MOST: f64 = 0.1;

/// Solids out of which an origin is moved: in a corner three planes meet.
const MOST_SOLIDS: usize = 4;

/// Cosine of the angle between the normals of two faces, less than which they are the two sides of a wall, and not a sharp corner.
const OPPOSITE: f64 = -0.99;

/// Surfaces of other elements that are passed on the way out of a solid.
const MOST_PASSED: usize = 8;

/// Whether what a ray meets is so near to where it goes on from that, in a corner, cannot be told what is within what.
pub(super) fn is_at_start(line: &Line, t: f64) -> bool {
    /// Steps aside.
    const NEAR: f64 = 64.0;
    t <= line.tmin + NEAR * aside(line.origin + line.direction * line.tmin)
}

/// A triangle's sides as a ray sees them: from its line to their ends.
fn sides(line: &Line, corners: &[DVec3; 3]) -> [(DVec3, DVec3); 3] {
    let across = corners.map(|corner| (corner - line.origin).reject_from_normalized(line.direction));
    [0, 1, 2].map(|i| (across[i], across[(i + 1) % 3]))
}

/// The way from the ray to the nearest of these sides.
fn way_to_nearest(sides: &[(DVec3, DVec3); 3]) -> DVec3 {
    let [first, second, third] = sides.map(|(from, to)| {
        let way = to - from;
        let share = -from.dot(way) / way.length_squared();
        // A side that is a point has no share.
        from + way * if share > 0.0 { share.min(1.0) } else { 0.0 }
    });
    let nearer =
        |one: DVec3, other: DVec3| if other.length_squared() < one.length_squared() { other } else { one };
    nearer(nearer(first, second), third)
}

/// The parallel ray that meets the nearest point of a triangle's sides, if a ray passes that triangle.
fn beside(line: &Line, corners: &[DVec3; 3]) -> Option<Line> {
    let sides = sides(line, corners);
    let turns = sides.map(|(from, to)| from.cross(to).dot(line.direction));
    if turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0) {
        return None;
    }
    Some(Line { origin: line.origin + way_to_nearest(&sides), ..*line })
}

impl Scene {
    /// The ray, which goes away from a surface, with its origin in the air to which it goes on, where rounding has put it behind that, or into a solid that
    /// meets the surface there: almost along that it would come out of it only much farther on. Without a surface it is the ray itself.
    pub(super) fn in_front(&self, surface: Option<&Surface>, line: &Line) -> Line {
        let Some(surface) = surface else { return *line };
        let Some(&corners) = self.tables.triangles.get(surface.triangle as usize) else { return *line };
        let most = self.most_before(surface, line);
        let mut line = *line;
        let corner = DVec3::from(self.tables.vertices[corners[0] as usize]);
        for number in 0..MOST_SOLIDS {
            let behind = (corner - line.origin).dot(surface.normal);
            if behind > 0.0 && behind <= most {
                line.origin += surface.normal * behind;
            }
            // On the surface by now, or no farther before it than roundings put it.
            let is_on_surface = number == 0 && behind <= most && -behind <= surface.near;
            let may_be_in = line.tmin <= most && self.may_be_in_solid(line.origin.to_array(), 0.0);
            let solid = may_be_in.then(|| self.solid_at(line.origin.to_array())).flatten();
            let Some(solid) = solid else { break };
            let way = if is_on_surface && self.tables.record(surface.triangle).element == solid {
                // In the solid of that very surface, by roundings: out across it, without a search.
                surface.normal * self.clear_of_edges(&line)
            } else if let Some(way) = self.way_out(&line, surface, solid, most) {
                way
            } else {
                break;
            };
            line.origin += way;
        }
        line
    }

    /// How far before a face, metres, a ray starts so that it does not meet its edges for passing beside them.
    fn clear_of_edges(&self, line: &Line) -> f64 {
        let [lo, hi] = self.tables.scene[0].hull.map(|corner| DVec3::from(corner).abs().max_element());
        2.0 * ROUNDING * (line.origin.abs().max_element() + lo.max(hi))
    }

    /// How far, metres, the origin of a ray that goes away from a surface may be moved before it.
    pub(super) fn most_before(&self, surface: &Surface, line: &Line) -> f64 {
        let reach = (DEEP * (1.0 + line.origin.abs().max_element())).max(UNEVEN);
        reach.min(MOST * self.tolerance()).max(surface.near)
    }

    /// Whether a ray that goes away from a surface came to what it met through matter: rounding has put its origin there, or so near that it passes an edge.
    pub(super) fn came_through_matter(&self, line: &Line, found: Found) -> bool {
        self.is_back(line, found) || self.comes_through_solids(line, found)
    }

    /// Whether a ray passes a side of the triangle that it met no farther than its origin may have been moved from the surface on which it starts. That
    /// side may be one within a face, where another triangle of it goes on.
    pub(super) fn is_at_side(&self, surface: &Surface, line: &Line, found: Found) -> bool {
        let sides = sides(line, &Walk::new(&self.tables).corners(found.triangle));
        let far = way_to_nearest(&sides).length();
        far <= self.most_before(surface, line).max(aside(line.origin + line.direction * found.t))
    }

    /// Whether a ray that goes on from a surface came to the back of a closed solid, as no ray from the air does: rounding has put its origin into that, or so near
    /// to it that it passes an edge.
    #[inline]
    pub(super) fn is_back(&self, line: &Line, found: Found) -> bool {
        if found.triangle == NONE {
            return false;
        }
        if !self.is_of_solid(found.triangle) {
            return false;
        }
        let record = self.tables.record(found.triangle);
        let [a, b, c] = Walk::new(&self.tables).corners(found.triangle);
        let ahead = (b - a).cross(c - a).dot(line.direction);
        let is_back = match Facing::of(record.facing) {
            Some(Facing::Outward) => ahead > 0.0,
            Some(Facing::Inward) => ahead < 0.0,
            _ => false,
        };
        is_back && !self.is_in_void(line, found.t)
    }

    /// Whether a triangle is one of a closed solid's.
    pub(super) fn is_of_solid(&self, triangle: u32) -> bool {
        let is_solid = |volume: &VolumeRecord| volume.role == Role::Solid as u32;
        self.tables.volumes.get(self.tables.record(triangle).volume as usize).is_some_and(is_solid)
    }

    /// Whether there is air before what a ray met, and matter behind: a void in a solid has walls that are backs of their own surface.
    #[cold]
    fn is_in_void(&self, line: &Line, t: f64) -> bool {
        let behind = t + aside(line.origin + line.direction * t);
        let point = line.origin + line.direction * behind;
        self.comes_by_air(line, t) && self.solid_at(point.to_array()).is_some()
    }

    /// Whether a ray that goes on from a surface came to what it met farther on, if anything, through a solid: that ray, or, where what it met is a little
    /// beside it, the one beside it that meets that.
    #[cold]
    fn comes_through_solids(&self, line: &Line, found: Found) -> bool {
        if found.triangle == NONE || is_at_start(line, found.t) {
            return false;
        }
        let beside = || beside(line, &Walk::new(&self.tables).corners(found.triangle));
        !self.comes_by_air(line, found.t)
            || beside().is_some_and(|beside| !self.comes_by_air(&beside, found.t))
    }

    /// Whether there is air halfway to what a ray met, and just before.
    #[cold]
    pub(super) fn comes_by_air(&self, line: &Line, t: f64) -> bool {
        let step = aside(line.origin + line.direction * t);
        let is_air = |t: f64| self.solid_at((line.origin + line.direction * t).to_array()).is_none();
        is_air(0.5 * (line.tmin + t)) && is_air(t - step)
    }

    /// The shortest way out of a solid across one of its faces, if that is no farther than `most`, and not behind the surface from which the ray goes
    /// on.
    #[cold]
    fn way_out(&self, line: &Line, surface: &Surface, solid: u32, most: f64) -> Option<DVec3> {
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let mut probe = Plain { kernel: self.kernel, ask: Ask::First };
        // Out across a triangle's plane, whichever way it was wound: the unit normal, and how far.
        let out_across = |triangle: u32| {
            let [a, b, c] = walk.corners(triangle);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let out = normal.dot(a - line.origin);
            (out.abs(), if out < 0.0 { -normal } else { normal })
        };
        let is_wanted = |triangle: u32| {
            tables.record(triangle).element == solid && out_across(triangle).1.dot(surface.normal) > OPPOSITE
        };
        let ways = both_ways(&ASIDE).filter_map(|way| {
            // No plane is along all of these.
            let mut probing =
                Line { direction: way.normalize(), tmin: 0.0, tmax: 4.0 * most, start: 0.0, ..*line };
            let mut found = among_all(tables, &probing, None, &mut probe).found;
            for _ in 0..MOST_PASSED {
                if found.triangle == NONE || is_wanted(found.triangle) {
                    break;
                }
                // What stands against the solid, or the face behind.
                probing.tmin = found.t.next_up();
                found = among_all(tables, &probing, None, &mut probe).found;
            }
            if found.triangle == NONE || !is_wanted(found.triangle) {
                return None;
            }
            let (out, normal) = out_across(found.triangle);
            (out <= most && normal != DVec3::ZERO).then_some((out, normal))
        });
        let (out, normal) = ways.reduce(|best, other| if other.0 < best.0 { other } else { best })?;
        Some(normal * (out + self.clear_of_edges(line)))
    }
}
