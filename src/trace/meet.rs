//! What a ray meets where it passes a cell's face between air and matter: the source's own triangles there, in f64.
//!
//! Cells are rounded to the lattice, and so is where a ray leaves them. What it meets, and where, is said by the
//! triangles that stand behind the face, tested as detail is. Near an edge the ray may pass the face and miss the
//! triangles by a hair: then by those of the cell's other faces; then by the nearest triangle behind the face: the
//! cells are closed where the model has cracks, and a parallel ray less than the tolerance aside meets it. Where the ray
//! runs along that triangle, on which side of it is for the triangles to say, not for the rounded cell: the walk is
//! begun again a little farther from the matter.

use glam::DVec3;

use super::NONE;
use super::kernel::Probe;
use super::path::NEAR;
use super::walk::{Found, Query, Walk};
use crate::format::Views;
use crate::format::records::SourceRecord;

/// Triangles that a ray may test at faces. Only files made to be slow make it more; what they hide is not found.
const MOST_TESTS: u32 = 1 << 16;

/// Normals at a smaller angle than the root of twice this count as one.
const ALIKE: f64 = 1e-6;

/// One ray and the surfaces of cells.
pub(super) struct Surfaces<'a> {
    sources: &'a [SourceRecord],
    triangles: &'a [u32],
    pub(super) tolerance: f64,
    /// Tests that are left.
    left: u32,
}

impl<'a> Surfaces<'a> {
    #[inline]
    pub(super) fn new(tables: &'a Views) -> Surfaces<'a> {
        Surfaces {
            sources: &tables.sources,
            triangles: &tables.surfaces,
            tolerance: tables.scene[0].tolerance,
            left: MOST_TESTS,
        }
    }

    #[inline(always)]
    fn triangles_of(&self, source: &SourceRecord) -> &'a [u32] {
        &self.triangles[source.first as usize..(source.first + source.count) as usize]
    }

    /// Makes `best` the nearest triangle of `source` that the ray meets and `takes`, if that is nearer.
    #[inline]
    pub(super) fn meet<P: Probe>(
        &mut self,
        source: u32,
        walk: &Walk<'_>,
        query: &mut Query,
        best: &mut Found,
        probe: &mut P,
        takes: impl Fn(&Found, &Query) -> bool,
    ) {
        let source = self.sources[source as usize];
        if self.left < source.count.min(SourceRecord::FEW) {
            return;
        }
        self.left -= source.count.min(SourceRecord::FEW);
        if source.root != NONE {
            self.meet_many(source.root, walk, query, best, probe, takes);
            return;
        }
        for &triangle in self.triangles_of(&source) {
            probe.test();
            let mut found = *best;
            if query.test(walk, triangle, &mut found) && takes(&found, query) {
                *best = found;
            }
        }
    }

    /// The same for a source with a hierarchy: hits that are not taken are passed.
    #[cold]
    fn meet_many<P: Probe>(
        &mut self,
        root: u32,
        walk: &Walk<'_>,
        query: &mut Query,
        best: &mut Found,
        probe: &mut P,
        takes: impl Fn(&Found, &Query) -> bool,
    ) {
        /// More surfaces of one source on a ray are not told apart.
        const MOST_PASSED: usize = 16;
        let tmin = query.tmin;
        for _ in 0..MOST_PASSED {
            query.aim(root, best.t);
            let found = probe.nearest(walk, query);
            if found.triangle == NONE {
                break;
            }
            if takes(&found, query) {
                if (found.t, found.triangle) < (best.t, best.triangle) {
                    *best = found;
                }
                break;
            }
            query.tmin = found.t.max(query.tmin).next_up();
        }
        query.tmin = tmin;
    }

    /// The triangle of `source` that is nearest to `point`, where the ray passes a face at `t`, if that is within the
    /// tolerance, and whose plane the ray crosses near there, from the air.
    #[cold]
    pub(super) fn nearly_met(
        &mut self,
        source: u32,
        (t, point): (f64, DVec3),
        outward: DVec3,
        walk: &Walk<'_>,
        query: &Query,
    ) -> Nearly {
        let source = self.sources[source as usize];
        let Some(left) = self.left.checked_sub(source.count) else { return Nearly::Nothing };
        self.left = left;
        let mut best: Option<(Found, f64)> = None;
        let mut grazed: Option<(Found, f64)> = None;
        for &triangle in self.triangles_of(&source) {
            let corners = walk.corners(triangle);
            let normal = normal(corners);
            let height = normal.dot(point - corners[0]);
            let off = distance(corners, point - normal * height).hypot(height);
            let starts_on_it = query.surface.as_ref().is_some_and(|surface| {
                normal.dot(corners[0] - query.origin).abs() <= self.tolerance
                    && normal.dot(surface.normal).abs() >= 1.0 - ALIKE
            });
            if starts_on_it || off > self.tolerance {
                continue;
            }
            let crossing = normal.dot(corners[0] - query.origin) / normal.dot(query.direction);
            // Along the plane there is no crossing, or far away.
            let is_crossed =
                (crossing - t).abs() <= self.tolerance && walk.enters(triangle, outward, query.direction);
            let found = Found { t: if is_crossed { crossing } else { t }.max(query.tmin), triangle };
            let nearest = if is_crossed { &mut best } else { &mut grazed };
            if nearest.is_none_or(|(_, least)| off < least) {
                *nearest = Some((found, off));
            }
        }
        match (best, grazed) {
            (Some((found, _)), _) => Nearly::Met(found),
            (None, Some((found, _))) => Nearly::Grazed(found),
            (None, None) => Nearly::Nothing,
        }
    }
}

/// What [`Surfaces::nearly_met`] found.
pub(super) enum Nearly {
    /// A triangle that a ray hardly aside meets.
    Met(Found),
    /// A triangle that the ray passes along.
    Grazed(Found),
    /// No triangle is near.
    Nothing,
}

/// Whether a hit lies at most `tolerance` from a face that the ray passes at `t`, across the triangle.
pub(super) fn is_near(found: &Found, t: f64, tolerance: f64, walk: &Walk<'_>, query: &Query) -> bool {
    (found.t - t).abs() <= NEAR || {
        let normal = normal(walk.corners(found.triangle));
        ((found.t - t) * normal.dot(query.direction)).abs() <= tolerance
    }
}

/// The triangle's unit normal; 0 if it has none.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The distance of a point in the triangle's plane from the triangle.
fn distance(corners: [DVec3; 3], point: DVec3) -> f64 {
    let normal = normal(corners);
    let (mut inside, mut least) = (true, f64::INFINITY);
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let (edge, from) = (b - a, point - a);
        inside &= normal.dot(edge.cross(from)) >= 0.0;
        let share = (from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        least = least.min((from - edge * share).length());
    }
    if inside { 0.0 } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_a_triangle() {
        let corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
        let at = |x: f64, y: f64| distance(corners, DVec3::new(x, y, 0.0));
        assert_eq!(at(1.0, 1.0), 0.0);
        assert_eq!(at(2.0, -0.5), 0.5);
        assert_eq!(at(-3.0, -4.0), 5.0);
        assert!((at(4.0, 3.0) - 2.4).abs() < 1e-15);
    }
}
