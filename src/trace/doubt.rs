//! What a ray meets where the quick way is in doubt: with care for where it begins, and by all triangles where these tell sooner.

use glam::DVec3;

use super::NONE;
use super::begin::{Begin, aside};
use super::cells::{Ended, among_all, nearest};
use super::kernel::Probe;
use super::line::{Line, is_away, surface, surface_of};
use super::onward::is_at_start;
use super::path::Prisms;
use super::quick::{is_clear_of, starts_clear, takes};
use super::ray::Ray;
use super::single::Start;
use super::walk::{EDGE_ON_SINE, Found, Surface, Walk};
use crate::scene::Scene;

/// What a ray meets.
pub(super) enum Met {
    /// This, the ray being perhaps another than was asked, with an end farther on.
    At(Line, Ended),
    /// Nothing.
    Nothing,
    /// It starts inside this solid element.
    InSolid(u32),
}

impl Met {
    /// What a ray meets that ends at `tmax`.
    fn before(tmax: f64, line: Line, ended: Ended) -> Met {
        let is_met = ended.found.triangle != NONE && ended.found.t <= tmax;
        if is_met { Met::At(line, ended) } else { Met::Nothing }
    }
}

impl Scene {
    /// What a ray meets that the quick way left in doubt.
    #[inline]
    pub(super) fn meets_in_doubt<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Met {
        self.meets_of_all(start, ray, probe).unwrap_or_else(|| self.meets(start, ray, probe))
    }

    /// What such a ray meets of all triangles, if what is in doubt is not where it starts: of ten of these the careful walk through cells is in doubt about nine, too, and takes
    /// longer to find that out than all triangles to tell.
    pub(super) fn meets_of_all<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Option<Met> {
        let tables = &self.tables;
        if tables.cells.len() == 1 || !takes(tables, ray) {
            return None;
        }
        let Some(line) = Line::new(tables, ray) else { return Some(Met::Nothing) };
        match start {
            Start::Cell(cell) if tables.is_air(cell) => {
                let prisms = Prisms::new(tables);
                if !prisms.nearly_holds(&tables.cells[cell as usize], prisms.local(line.origin), 0.0) {
                    return None;
                }
                probe.unsure();
                Some(Met::before(ray.tmax, line, among_all(tables, &line, None, probe)))
            }
            Start::Hit(hit) => {
                let surface = surface_of(hit, line.origin, line.tmin);
                if !starts_clear(tables, ray, hit.cell, &surface) {
                    return None;
                }
                probe.unsure();
                // Without an end: that it has run into a solid is noticed where it comes out of that.
                let line = Line { tmax: f64::INFINITY, ..line };
                let ended = among_all(tables, &line, Some(&surface), probe);
                let is_told = is_clear_of(&surface, ended.found) && !self.is_back(&line, ended.found);
                is_told.then(|| Met::before(ray.tmax, line, ended))
            }
            _ => None,
        }
    }

    /// What a ray meets, `probe` running the walks.
    #[inline]
    pub(super) fn meets<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Met {
        let tables = &self.tables;
        let Some(mut line) = Line::new(tables, ray) else { return Met::Nothing };
        let surface = surface(start, &line);
        if surface.is_some() {
            // Without an end: that it has run into a solid is noticed where it comes out of that.
            line.tmax = f64::INFINITY;
        }
        let away = surface.as_ref().filter(|surface| is_away(surface, &line));
        let onward = self.in_front(away, &line);
        let follow = |tmin: f64, probe: &mut P| {
            let mut ended = nearest(tables, &onward, surface.as_ref(), start.hint(), probe);
            if let Some(away) = away {
                ended = self.past_start(&onward, away, ended, probe);
            }
            // What comes to nothing tells by nothing else that it began in matter, as cells say.
            let start = || onward.origin + onward.direction * onward.tmin;
            let begins_in_matter =
                || ended.in_matter && ended.found.triangle == NONE && !self.is_beside_solids(start());
            let is_in_doubt =
                away.is_some() && (begins_in_matter() || self.came_through_matter(&onward, ended.found));
            ended.found.t = ended.found.t.max(tmin);
            (ended, is_in_doubt)
        };
        // One that starts anywhere is mostly not followed where it is in doubt that it begins there.
        let (mut followed, is_in_doubt) = if surface.is_some() {
            let (ended, is_in_doubt) = follow(line.tmin, probe);
            (Some(ended), is_in_doubt)
        } else {
            (None, matches!(start, Start::Anywhere) && self.may_start_in_solid(&line))
        };
        if is_in_doubt {
            let first = followed.map(|ended| ended.found);
            // By all triangles: where cells are rounded, a surface may be behind a ray that starts beside it.
            let again = |line: &Line, probe: &mut P| among_all(tables, line, surface.as_ref(), probe);
            match self.begin(&line, away, &mut |line| again(line, probe).found) {
                Begin::InSolid(_) if first.is_some_and(|first| is_at_start(&line, first.t)) => {}
                Begin::InSolid(element) => {
                    return Met::InSolid(element);
                }
                Begin::At(tmin) if tmin > line.tmin => {
                    line.tmin = tmin;
                    followed = Some(again(&line, probe));
                }
                Begin::At(_) => {
                    // Only where it passes a side that closely is it let past. Otherwise the hit stands, even on a solid's back: parts of one solid may overlap.
                    if let (Some(first), Some(away)) = (first, away)
                        && first.triangle != NONE
                        && self.is_at_side(away, &onward, first)
                        && self.comes_by_air(&onward, first.t)
                    {
                        followed = Some(self.past_edge(&onward, surface.as_ref(), first, probe));
                    }
                }
                Begin::Beside(way) => {
                    let mut way = away.map_or(way, |surface| self.up_to(surface, &line, way));
                    // Without an end: almost along a plane, it comes there much sooner or later than this ray.
                    let aside = Line { origin: line.origin + way, tmax: f64::INFINITY, ..line };
                    // Aside may be behind the surface, which it does not meet from there either.
                    let behind = surface
                        .as_ref()
                        .map(|surface| Surface { aside: way.dot(surface.normal).abs(), ..*surface });
                    let mut ended = among_all(tables, &aside, behind.as_ref(), probe);
                    if let Some(away) = away
                        && self.came_through_matter(&aside, ended.found)
                    {
                        // Into what meets the surface there: where the ray starts that is not met again, and from aside it is.
                        let met = among_all(tables, &aside, None, probe);
                        // From aside it may come through the surface itself, where there is no air before that.
                        let walk = Walk::new(tables);
                        if !walk.is_part_of(met.found.triangle, away, line.origin) {
                            ended = met;
                        } else if let Some((up, above)) = self.above(away, &line, probe) {
                            (way, ended) = (up, above);
                        } else if let Some(element) = self.solid_before(away, &line) {
                            return Met::InSolid(element);
                        }
                    }
                    // Back from the other ray's origin to this one's.
                    ended.found.t += way.dot(line.direction);
                    ended.found.t = self.in_its_plane(&line, ended.found).max(line.tmin);
                    followed = Some(ended);
                }
            }
        }
        let ended = followed.unwrap_or_else(|| follow(line.tmin, probe).0);
        if ended.in_matter
            && matches!(start, Start::Anywhere)
            && let Some(element) = self.solid_around(line.origin + line.direction * line.tmin)
        {
            return Met::InSolid(element);
        }
        Met::before(ray.tmax, line, ended)
    }

    /// What a ray meets that goes away from a surface, but for what it has passed where it starts: a triangle is looked for behind its origin, where
    /// rounding may have put that. Almost in the triangle's plane, that may be far enough that the triangle ends before the origin.
    fn past_start<P: Probe>(&self, line: &Line, surface: &Surface, mut ended: Ended, probe: &mut P) -> Ended {
        /// More triangles than this behind an origin are not told apart.
        const MOST: usize = 64;
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        for _ in 0..MOST {
            if !self.has_passed(line, surface, ended.found, probe) {
                break;
            }
            let mut query = line.query(tables, Some(surface));
            query.aim(tables.cells[0].root, line.tmax);
            query.follow(ended.found.t, ended.found.triangle + 1);
            ended = Ended { found: probe.nearest(&walk, &query), cell: 0, in_matter: false };
        }
        ended
    }

    /// Whether a ray met a triangle behind where it starts, and has passed that there: a solid's, if there is no solid behind its plane where the ray starts, another's, if
    /// nothing of its element is there.
    fn has_passed<P: Probe>(&self, line: &Line, surface: &Surface, found: Found, probe: &mut P) -> bool {
        if found.triangle == NONE || found.t >= line.tmin - surface.near {
            return false;
        }
        let [a, b, c] = Walk::new(&self.tables).corners(found.triangle);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return false };
        let start = line.origin + line.direction * line.tmin;
        if !self.is_of_solid(found.triangle) {
            return !self.is_there(found.triangle, normal, start, probe);
        }
        let behind = normal * aside(start).copysign(normal.dot(line.direction));
        self.solid_at((start + behind).to_array()).is_none()
    }

    /// Whether a triangle's element has a face at a place in the triangle's plane: that triangle, or one beside it.
    #[cold]
    fn is_there<P: Probe>(&self, triangle: u32, normal: DVec3, place: DVec3, probe: &mut P) -> bool {
        /// More surfaces than this at a place are not told apart.
        const MOST: usize = 64;
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let far = aside(place);
        let origin = place - normal * far;
        let across = Line { origin, direction: normal, tmin: 0.0, tmax: 2.0 * far, start: 0.0 };
        let mut query = across.query(tables, None);
        query.aim(tables.cells[0].root, across.tmax);
        for _ in 0..MOST {
            let found = probe.nearest(&walk, &query);
            if found.triangle == NONE {
                return false;
            }
            if walk.are_of_one(found.triangle, triangle) {
                return true;
            }
            query.follow(found.t, found.triangle + 1);
        }
        true
    }

    /// What a ray meets that comes past the edge of what it does not come from within of, which it has met: what is behind that, or, where something else
    /// stands against it, enters that there.
    fn past_edge<P: Probe>(
        &self,
        line: &Line,
        surface: Option<&Surface>,
        edge: Found,
        probe: &mut P,
    ) -> Ended {
        /// More surfaces than this in an edge are not told apart.
        const MOST: usize = 64;
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let aside = aside(line.origin + line.direction * edge.t);
        let mut query = line.query(tables, None);
        query.aim(tables.cells[0].root, line.tmax);
        query.follow((edge.t - aside).max(line.tmin), 0);
        let is_of_solid = self.is_of_solid(edge.triangle);
        for _ in 0..MOST {
            let found = probe.nearest(&walk, &query);
            let enters = |triangle: u32| {
                let [a, b, c] = walk.corners(triangle);
                (b - a).cross(c - a).dot(line.direction) < 0.0
            };
            // What encloses nothing has no inside that it could come out of; but what it starts on it does not meet.
            let is_open = |triangle: u32| {
                let is_own = surface.is_some_and(|own| walk.is_part_of(triangle, own, line.origin));
                let may_be_met = is_of_solid || !walk.are_of_one(triangle, edge.triangle);
                may_be_met && !is_own && !self.is_of_solid(triangle)
            };
            if found.triangle == NONE
                || found.t > edge.t + aside
                || enters(found.triangle) && !walk.are_of_one(found.triangle, edge.triangle)
                || is_open(found.triangle)
            {
                return Ended { found, cell: 0, in_matter: false };
            }
            query.follow(found.t, found.triangle + 1);
        }
        among_all(tables, &Line { tmin: edge.t + aside, ..*line }, None, probe)
    }

    /// What a ray meets that goes away from a surface which is bent more than a ray beside it is told apart: from a little before that, where it meets
    /// nothing through matter; and the way there.
    #[cold]
    fn above<P: Probe>(&self, surface: &Surface, line: &Line, probe: &mut P) -> Option<(DVec3, Ended)> {
        /// Of how far before a surface a ray may start: no farther than it takes.
        const SHARES: [f64; 3] = [1.0 / 16.0, 0.25, 1.0];
        let most = self.most_before(surface, line);
        SHARES.iter().find_map(|share| {
            let way = surface.normal * (share * most);
            let above = Line { origin: line.origin + way, tmax: f64::INFINITY, ..*line };
            let ended = among_all(&self.tables, &above, None, probe);
            (!self.came_through_matter(&above, ended.found)).then_some((way, ended))
        })
    }

    /// The solid that a ray starts in which goes away from the back of that solid's own surface: rounding has let a ray come to that which ran along it.
    #[cold]
    fn solid_before(&self, surface: &Surface, line: &Line) -> Option<u32> {
        if surface.triangle as usize >= self.tables.triangles.len() {
            return None;
        }
        let start = line.origin + line.direction * line.tmin;
        let before = start + surface.normal * self.most_before(surface, line);
        let element = self.tables.record(surface.triangle).element;
        self.solid_at(before.to_array()).filter(|solid| *solid == element)
    }

    /// A way aside from where a ray starts, before the surface that it goes away from, no farther than to that surface: behind it no air begins, be the
    /// gap before it as narrow as it may.
    fn up_to(&self, surface: &Surface, line: &Line, way: DVec3) -> DVec3 {
        if surface.triangle as usize >= self.tables.triangles.len() {
            return way;
        }
        let [corner, ..] = Walk::new(&self.tables).corners(surface.triangle);
        let before = |point: DVec3| surface.normal.dot(point - corner);
        let start = line.origin + line.direction * line.tmin;
        let (here, there) = (before(start), before(start + way));
        if here >= 0.0 && there < 0.0 { way - surface.normal * there } else { way }
    }

    /// Where the ray itself meets the plane of what one beside it met; there, if it runs too much along it.
    fn in_its_plane(&self, line: &Line, found: Found) -> f64 {
        if found.triangle == NONE {
            return found.t;
        }
        let [a, b, c] = Walk::new(&self.tables).corners(found.triangle);
        let normal = (b - a).cross(c - a);
        let toward = normal.dot(line.direction);
        let is_along = toward.abs() <= EDGE_ON_SINE * normal.length();
        if is_along { found.t } else { normal.dot(a - line.origin) / toward }
    }
}
