//! The search for a parallel ray whose exact answer is the answer in question.
//!
//! What it finds is proven by tracing that ray; what it looks at decides only how much it finds. See
//! [`right`](super::right) for the definition.

use enfilade_importers::ElementId;

use super::arrangement::{Arrangement, Point};
use super::shell::Body;
use super::soup::{Nearest, first_t};
use super::triangle::{Corners, Line, closest_point};
use super::vector::{add, basis, cross, distance, dot, length, max_abs, scale, sub, unit};
use super::{TrueAnswer, Truth, start};
use crate::trace::Ray;

/// Triangles near which points are tried for an answer `InSolid`: the nearest ones.
const SOLID_TRIANGLES: usize = 24;

/// Starts this many times as far along the ray from a surface as counts as touching it are clear of it, unless the ray runs
/// along it.
const CLEAR: [f64; 2] = [4.0, 256.0];

/// A ray that after this many times the distance that counts as touching still touches a surface runs along it.
const ALONG: f64 = 1e5;

/// An answer to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sought {
    Hit { t: f64, element: ElementId },
    Escaped,
}

/// A search for witnesses near one ray.
pub(crate) struct Search<'a> {
    truth: &'a Truth,
    ray: &'a Ray,
    line: Line,
    sought: Sought,
    /// Two directions across the ray.
    across: [[f64; 3]; 2],
    /// The least distance at which a witness passes an edge: as small as f64 can tell.
    step: f64,
    /// A start that is no farther than this from a surface is on it.
    touch: f64,
    /// The carving solids whose surface is near the start, so that a shift may matter to what the ray starts in.
    near_solids: Vec<&'a (ElementId, Body)>,
    in_solid: bool,
}

/// The displacement of the nearest point found inside `element` around the start of `ray`; `None` if there is none
/// within the tolerance.
pub(crate) fn inside_near(truth: &Truth, ray: &Ray, element: ElementId) -> Option<f64> {
    let index = truth.solids.binary_search_by_key(&element, |solid| solid.0).ok()?;
    let body = &truth.solids[index].1;
    let origin = start(ray)?;
    let step = touch_at(max_abs(origin));
    let mut surface = body.surface_near(origin, truth.tolerance);
    surface.sort_by(|a, b| distance(a.0, origin).total_cmp(&distance(b.0, origin)));
    let mut shifts = Vec::new();
    for (q, normal) in surface.into_iter().take(SOLID_TRIANGLES) {
        let n = unit(normal);
        for step in [step, 100.0 * step, 1e4 * step] {
            let mut push = |way: [f64; 3]| shifts.push(add(sub(q, origin), scale(way, step)));
            push(n);
            push(scale(n, -1.0));
            // On an edge or in a corner, the way in is oblique to all faces.
            for i in (0..27).filter(|&i| i != 13) {
                push(unit([i % 3, i / 3 % 3, i / 9].map(|k| f64::from(k) - 0.987)));
            }
        }
    }
    shifts.retain(|shift| length(*shift) <= truth.tolerance);
    shifts.sort_by(|a, b| length(*a).total_cmp(&length(*b)));
    let found = shifts.iter().find(|shift| body.contains(add(origin, **shift)));
    found.map(|shift| length(*shift))
}

/// Many roundings of coordinates of this size: 3e-12 m in a building of 30 m.
fn step_at(reach: f64) -> f64 {
    2f64.powi(-43) * reach.max(1.0)
}

/// A nanometre, or more where coordinates are so large that f64 cannot tell.
pub(super) fn touch_at(reach: f64) -> f64 {
    1e-9 * (reach / 1000.0).max(1.0)
}

impl<'a> Search<'a> {
    /// `exact` is the exact answer to `ray`.
    pub(crate) fn new(
        truth: &'a Truth,
        ray: &'a Ray,
        sought: Sought,
        exact: &TrueAnswer,
    ) -> Option<Search<'a>> {
        let line = Line::new(ray)?;
        let far = match sought {
            Sought::Hit { t, .. } => max_abs(line.at(t)),
            Sought::Escaped => 0.0,
        };
        let begin = start(ray)?;
        let near_solids = truth
            .solids
            .iter()
            .filter(|(_, body)| !body.surface_near(begin, truth.tolerance).is_empty())
            .collect();
        Some(Search {
            truth,
            ray,
            line,
            sought,
            across: basis(line.direction),
            step: step_at(line.reach.max(far)),
            touch: touch_at(line.reach.max(far)),
            near_solids,
            in_solid: matches!(exact, TrueAnswer::InSolid(_)),
        })
    }

    /// The smallest displacement found, metres; `None` if there is none within the tolerance.
    pub(crate) fn smallest(&self) -> Option<f64> {
        if self.is_hopeless() {
            return None;
        }
        let (near, ends) = self.surroundings();
        let (places, partly) = self.places(&near);
        self.best_of(places, &ends).or_else(|| self.best_of(partly, &ends))
    }

    /// The smallest displacement found at some shifts across the ray, from the smallest to the largest.
    fn best_of(&self, places: Vec<Point>, ends: &[f64]) -> Option<f64> {
        let mut best: Option<f64> = None;
        for w in places {
            let size = (w[0] * w[0] + w[1] * w[1]).sqrt();
            if best.is_some_and(|best| size >= best) {
                break;
            }
            if let Some(found) = self.try_at(w, size, ends) {
                best = Some(best.map_or(found, |best| best.min(found)));
            }
        }
        best
    }

    /// Whether what any witness needs is missing: a surface of the element near the answer's point, and a way out
    /// of the solids around the start.
    fn is_hopeless(&self) -> bool {
        if self.in_solid && self.near_solids.is_empty() {
            return true;
        }
        let Sought::Hit { t, element } = self.sought else { return false };
        let p = self.line.at(t);
        if !p.iter().all(|c| c.is_finite()) {
            return true;
        }
        let soup = &self.truth.soup;
        !self
            .truth
            .grid
            .near_point(p)
            .iter()
            .any(|&index| soup.element(index) == element && self.is_close(&soup.corners[index as usize], p))
    }

    fn is_close(&self, corners: &super::triangle::Corners, p: [f64; 3]) -> bool {
        distance(closest_point(corners, p), p) <= self.truth.tolerance * (1.0 + 1e-6) + self.touch
    }

    /// Where the ray starts and ends.
    fn levels(&self) -> Vec<f64> {
        let mut levels = vec![first_t(self.ray), self.ray.tmax];
        levels.retain(|level| level.is_finite());
        levels
    }

    /// The triangles near the line, as far as they matter, and those of the levels that have some near them.
    fn surroundings(&self) -> (Vec<u32>, Vec<f64>) {
        let tolerance = self.truth.tolerance;
        let from = first_t(self.ray) - tolerance;
        let to = match self.sought {
            Sought::Hit { t, .. } => t + tolerance,
            Sought::Escaped => self.ray.tmax + tolerance,
        };
        let near = self.truth.near_line(&self.line, from, to);
        let close = |p| near.iter().any(|&i| self.is_close(&self.truth.soup.corners[i as usize], p));
        let ends = self.levels().into_iter().filter(|&level| close(self.line.at(level))).collect();
        (near, ends)
    }

    /// Shifts across the ray to try, from the smallest to the largest; and others, if none of these will do.
    fn places(&self, near: &[u32]) -> (Vec<Point>, Vec<Point>) {
        let mut arrangement = Arrangement::new(self.truth.tolerance, self.step);
        let mut levels = self.levels();
        if let Sought::Hit { t, .. } = self.sought {
            levels.push(t);
        }
        let points: Vec<[f64; 3]> = levels.into_iter().map(|level| self.line.at(level)).collect();
        let mut direct = Vec::new();
        for &index in near {
            let corners = &self.truth.soup.corners[index as usize];
            let flat = corners.map(|corner| self.project(sub(corner, self.ray.origin)));
            for i in 0..3 {
                arrangement.add([flat[i], flat[(i + 1) % 3]]);
            }
            // The places where the surface is met exactly at a level: steep there, a small shift moves the hit far.
            for &p in &points {
                if self.is_close(corners, p) {
                    let normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
                    arrangement.add_line(self.project(normal), dot(normal, sub(corners[0], p)));
                    direct.push(self.project(sub(closest_point(corners, p), p)));
                }
            }
        }
        // A part of the way may do: the start, moved along the ray, has left the surface as well, and what is met far off
        // moves by less.
        let shares = [0.25, 0.5, 0.75];
        let mut partly: Vec<Point> =
            direct.iter().flat_map(|way| shares.map(|share| way.map(|c| share * c))).collect();
        // Past more edges than are looked at, all at once: some way up, the ray is past all the tops of a round wall.
        partly.extend(around(self.truth.tolerance));
        let mut places = arrangement.points();
        // None across: a start that is moved along the ray, or a sliver that it passes.
        places.push([0.0; 2]);
        let is_near = |w: &Point| w[0].hypot(w[1]) <= self.truth.tolerance;
        places.extend(direct.into_iter().filter(is_near));
        partly.retain(is_near);
        for places in [&mut places, &mut partly] {
            let square = |p: &Point| p[0] * p[0] + p[1] * p[1];
            places.sort_by(|a, b| square(a).total_cmp(&square(b)));
        }
        (places, partly)
    }

    fn project(&self, v: [f64; 3]) -> Point {
        self.across.map(|axis| dot(axis, v))
    }

    /// The ray shifted by `w` across and by `s` along itself.
    fn shifted(&self, w: Point, s: f64) -> Ray {
        let across = add(scale(self.across[0], w[0]), scale(self.across[1], w[1]));
        let shift = add(across, scale(self.line.direction, s));
        Ray { origin: add(self.ray.origin, shift), ..*self.ray }
    }

    /// The smallest displacement among rays that are shifted by `w` across, whose length is `size`.
    fn try_at(&self, w: Point, size: f64, ends: &[f64]) -> Option<f64> {
        let tolerance = self.truth.tolerance;
        let mut shifts = vec![0.0];
        for level in ends {
            for hit in self.truth.hits_between(&self.shifted(w, 0.0), level - tolerance, level + tolerance) {
                let at = hit.t - level;
                shifts.extend([at - self.step, at, at + self.step]);
                // Off what counts as touching the surface, be it seen from the side.
                for off in CLEAR.map(|times| times * self.touch).into_iter().filter(|off| *off <= tolerance) {
                    shifts.extend([at - off, at + off]);
                }
            }
        }
        shifts.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let mut best: Option<f64> = None;
        for s in shifts {
            if best.is_some_and(|best| size.hypot(s) >= best) {
                break;
            }
            if let Some(off) = self.answers(&self.shifted(w, s), s) {
                let total = size.hypot(s.abs().max(off));
                if total <= tolerance * (1.0 + 1e-9) && best.is_none_or(|best| total < best) {
                    best = Some(total);
                }
            }
        }
        best
    }

    /// Whether the exact answer to `ray`, which is the ray in question shifted by `s` along itself and perhaps
    /// across, is the one sought; and how far along the ray the hit, or the end of a segment, is off.
    fn answers(&self, ray: &Ray, s: f64) -> Option<f64> {
        let tolerance = self.truth.tolerance;
        let first = self.nearest_from_air(ray)?;
        let met = match (self.sought, first) {
            (Sought::Escaped, None) => Some(0.0),
            (Sought::Escaped, Some(hit)) => self.ended_before(ray, hit.t, s),
            (Sought::Hit { t, element }, Some(hit)) => {
                let off = (hit.t + s - t).abs();
                if off > tolerance {
                    None
                } else if hit.element == element {
                    Some(off)
                } else {
                    let flush = self.truth.hits_between(ray, hit.t - self.touch, hit.t + tolerance);
                    flush
                        .iter()
                        .filter(|other| other.element == element)
                        .map(|other| (other.t + s - t).abs())
                        .min_by(f64::total_cmp)
                }
            }
            _ => None,
        };
        match self.sought {
            Sought::Hit { t, element } if met.is_none() => {
                let before = first.map_or(f64::INFINITY, |first| first.t + self.touch);
                self.sliver(ray, t - s, element, before)
            }
            _ => met,
        }
    }

    /// How far the end of a segment, which is shifted by `s` along itself, must be moved for it to end before what it hits at `t`; `None` if it would
    /// end before it starts, or be moved by more than the tolerance.
    fn ended_before(&self, ray: &Ray, t: f64, s: f64) -> Option<f64> {
        let end = t - self.step;
        let off = (ray.tmax - (end + s)).abs();
        (end >= first_t(ray) && off <= self.truth.tolerance).then_some(off)
    }

    /// Whether the ray passes a triangle of `element` nearer than rays can be aimed, at about `t` and not after `before`;
    /// and how far along the ray that is off. It stands for the rays that meet the triangle there.
    fn sliver(&self, ray: &Ray, t: f64, element: ElementId, before: f64) -> Option<f64> {
        let tolerance = self.truth.tolerance;
        let line = Line::new(ray)?;
        let soup = &self.truth.soup;
        let near = self.truth.near_line(&line, t - tolerance, t + tolerance).into_iter();
        let met = near.filter(|&index| soup.element(index) == element).filter_map(|index| {
            let corners = soup.corners[index as usize].map(|corner| sub(corner, ray.origin));
            let [nearest, farthest] = self.narrow(&corners, line.direction, t)?;
            let at = t.clamp(nearest, farthest);
            let off = (at - t).abs();
            (at <= before && off <= tolerance).then_some(off)
        });
        met.min_by(f64::total_cmp)
    }

    /// From where to where along the ray a triangle reaches, its corners relative to the origin, as far as the ray passes it
    /// nearer than rays can be aimed: further than that only if the ray sees it from the side. An answer at `t` is in question.
    fn narrow(&self, corners: &Corners, direction: [f64; 3], t: f64) -> Option<[f64; 2]> {
        /// A side at less of an angle to the ray, in radians, is along it.
        const ALONG_IT: f64 = 1e-3;
        /// A depth of less than this, in metres, is told by rays that can be aimed.
        const STEEP: f64 = 1e-6;
        let narrow = 4.0 * self.step;
        let flat = corners.map(|corner| self.project(corner));
        let way = |from: usize, to: usize| [flat[to][0] - flat[from][0], flat[to][1] - flat[from][1]];
        let square = |v: Point| v[0] * v[0] + v[1] * v[1];
        // The longest side as the ray sees it.
        let (mut from, mut to, mut third) = (0, 1, 2);
        for side in [(1, 2, 0), (2, 0, 1)] {
            if square(way(side.0, side.1)) > square(way(from, to)) {
                (from, to, third) = side;
            }
        }
        let long = way(from, to);
        let length_flat = square(long).sqrt();
        if length_flat == 0.0 {
            return None;
        }
        let is_along = length_flat < ALONG_IT * distance(corners[from], corners[to]);
        // How far along that side and how far across it a point is, seen from its start.
        let place = |p: Point| {
            let along = (p[0] * long[0] + p[1] * long[1]) / (length_flat * length_flat);
            (along, (p[0] * long[1] - p[1] * long[0]) / length_flat)
        };
        let (share_of_third, width) = place(way(from, third));
        let (share, off) = place([-flat[from][0], -flat[from][1]]);
        let beyond = (share - share.clamp(0.0, 1.0)).abs() * length_flat;
        if width.abs() > narrow {
            let seen = [0, 1, 2].map(|i| [flat[i][0], flat[i][1], dot(corners[i], direction)]);
            let near = depths(&clipped(&seen, [narrow, narrow, f64::INFINITY]))?;
            // The tip of a long one: of what would do for an answer, all is narrow.
            let would_do = seen.map(|[x, y, depth]| [x, y, depth - t]);
            let is_tip = || narrower(&clipped(&would_do, [self.truth.tolerance; 3]), narrow);
            let is_steep = near[1] - near[0] > STEEP && !is_along;
            return (is_steep || is_tip()).then_some(near);
        }
        if is_along || off.abs() > narrow || beyond > narrow {
            return None;
        }
        let size = length(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
        let is_sliver = size <= narrow * distance(corners[from], corners[to]);
        if !is_sliver && width.abs() < self.step / 16.0 {
            // As far as roundings tell the ray runs in its plane, and meets none of it.
            return None;
        }
        let share = share.clamp(0.0, 1.0);
        let depth = |corner: usize| dot(corners[corner], direction);
        let between = |from: usize, to: usize, share: f64| depth(from) + share * (depth(to) - depth(from));
        let one = between(from, to, share);
        let other = if share < share_of_third {
            between(from, third, share / share_of_third)
        } else if share_of_third < 1.0 {
            between(to, third, ((1.0 - share) / (1.0 - share_of_third)).min(1.0))
        } else {
            depth(third)
        };
        Some([one.min(other), one.max(other)])
    }

    /// What the ray hits first; `None` if it starts inside a carving solid.
    ///
    /// A start on the surface of a solid is not inside that solid, and does not hit the surface through which it
    /// leaves it.
    fn nearest_from_air(&self, ray: &Ray) -> Option<Option<Nearest>> {
        if self.near_solids.is_empty() {
            return (!self.in_solid).then(|| self.truth.nearest(ray));
        }
        let start = start(ray)?;
        let touches = |body: &Body| !body.surface_near(start, self.touch).is_empty();
        let (touched, others): (Vec<_>, Vec<_>) =
            self.truth.solids.iter().partition(|(_, body)| touches(body));
        if others.iter().any(|(_, body)| body.contains(start)) {
            return None;
        }
        // A little further on, past all that counts as touched; and further, to tell rays that run along a surface:
        // those do not enter it.
        let skin = 8.0 * self.touch;
        let ahead = add(start, scale(self.line.direction, skin));
        let further = add(start, scale(self.line.direction, ALONG * self.touch));
        let enters = |body: &Body| body.contains(ahead) && body.surface_near(further, self.touch).is_empty();
        let (entered, left): (Vec<_>, Vec<_>) = touched.into_iter().partition(|(_, body)| enters(body));
        let begin = first_t(ray);
        if let Some((element, _)) = entered.first() {
            // By rounding, the surface may lie a little behind the start.
            let at = self.truth.hits_between(ray, begin - skin, begin + skin);
            let met = at.into_iter().find(|hit| entered.iter().any(|solid| solid.0 == hit.element));
            return Some(met.or(Some(Nearest { t: begin, element: *element, triangle: 0 })));
        }
        let first = self.truth.nearest(ray);
        if left.is_empty() || first.is_none_or(|first| first.t > begin + skin) {
            return Some(first);
        }
        let near = self.truth.hits_between(ray, begin, (begin + skin).min(ray.tmax));
        let met = near.into_iter().find(|hit| left.iter().all(|solid| solid.0 != hit.element));
        Some(met.or_else(|| self.truth.nearest(&Ray { tmin: begin + skin, ..*ray })))
    }
}

/// Points around the origin, in sixteen directions, up to a radius and nearer by thirds of it.
fn around(radius: f64) -> impl Iterator<Item = Point> {
    const DIRECTIONS: u32 = 16;
    let direction = |number: u32| (f64::from(number) + 0.5) * std::f64::consts::TAU / f64::from(DIRECTIONS);
    let shares = (0..12).map(move |power| radius * (1.0 - 1e-9) / 3f64.powi(power));
    shares.flat_map(move |size| {
        (0..DIRECTIONS).map(move |number| [size * direction(number).cos(), size * direction(number).sin()])
    })
}

/// The part of a convex polygon within the box of these half-widths: two across the ray, and the depth along it.
fn clipped(corners: &[[f64; 3]], half: [f64; 3]) -> Vec<[f64; 3]> {
    let mut polygon = corners.to_vec();
    for axis in (0..3).filter(|&axis| half[axis] < f64::INFINITY) {
        for sign in [-1.0, 1.0] {
            let inside = |p: &[f64; 3]| half[axis] - sign * p[axis];
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (i, a) in polygon.iter().enumerate() {
                let b = &polygon[(i + 1) % polygon.len()];
                let (from, to) = (inside(a), inside(b));
                if from >= 0.0 {
                    kept.push(*a);
                }
                if (from >= 0.0) != (to >= 0.0) {
                    let share = from / (from - to);
                    kept.push([0, 1, 2].map(|i| a[i] + share * (b[i] - a[i])));
                }
            }
            polygon = kept;
        }
    }
    polygon
}

/// The least and largest depth of a polygon; `None` if it has no corners.
fn depths(polygon: &[[f64; 3]]) -> Option<[f64; 2]> {
    let range = |[low, high]: [f64; 2], p: &[f64; 3]| [low.min(p[2]), high.max(p[2])];
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    (!polygon.is_empty()).then(|| polygon.iter().fold(none, range))
}

/// Whether all of a polygon, as the ray sees it, lies within this distance of the line through the two corners that are
/// farthest apart.
fn narrower(polygon: &[[f64; 3]], width: f64) -> bool {
    let way = |from: &[f64; 3], to: &[f64; 3]| [to[0] - from[0], to[1] - from[1]];
    let square = |v: Point| v[0] * v[0] + v[1] * v[1];
    let pairs = polygon.iter().flat_map(|from| polygon.iter().map(move |to| (from, way(from, to))));
    let Some((from, long)) = pairs.max_by(|a, b| square(a.1).total_cmp(&square(b.1))) else { return true };
    let reach = square(long).sqrt();
    polygon.iter().all(|p| {
        let off = way(from, p);
        (off[0] * long[1] - off[1] * long[0]).abs() <= width * reach
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_near_the_ray() {
        let steep = [[-1.0, -1.0, 0.0], [1.0, -1.0, 10.0], [0.0, 1.0, 5.0]];
        let around = |half: f64| [half, half, f64::INFINITY];
        let [low, high] = depths(&clipped(&steep, around(0.1))).unwrap();
        assert!((low - 4.5).abs() < 1e-12 && (high - 5.5).abs() < 1e-12, "{low} {high}");
        assert_eq!(depths(&clipped(&steep.map(|[x, y, depth]| [x + 3.0, y, depth]), around(0.1))), None);
        // All of it.
        assert_eq!(depths(&clipped(&steep, around(2.0))), Some([0.0, 10.0]));
        assert_eq!(depths(&clipped(&steep, [2.0, 2.0, 3.0])), Some([0.0, 3.0]));
    }

    #[test]
    fn tips_are_narrow() {
        let long = [[0.0, 0.0, 0.0], [1000.0, 0.001, 1e6], [1000.0, -0.001, 1e6]];
        let seen = |half: f64| clipped(&long, [half, half, f64::INFINITY]);
        assert!(narrower(&seen(0.001), 1e-8));
        assert!(!narrower(&seen(0.1), 1e-8));
        assert!(narrower(&clipped(&long, [0.1, 0.1, 0.1]), 1e-8), "its depth is another tip");
        let further = long.map(|[x, y, depth]| [x - 9.0, y, depth]);
        assert!(!narrower(&clipped(&further, [0.001, 0.001, 1e6]), 1e-8));
        assert!(narrower(&[], 0.0) && narrower(&[[1.0, 2.0, 3.0]], 0.0));
    }
}
