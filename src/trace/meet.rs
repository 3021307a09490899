//! What a ray meets where it passes a cell's face between air and matter: the source's own triangles there, in f64.
//!
//! Cells are rounded to the lattice, and so is where a ray leaves them. What it meets, and where, is said by the
//! triangles that stand behind the face, tested as detail is. Near an edge the ray may pass the face and miss the
//! triangles by a hair: then by those of the cell's other faces; then by the nearest triangle behind the face: the
//! cells are closed where the model has cracks, and a parallel ray less than the tolerance aside meets it.

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

    /// Makes `best` the nearest triangle of `source` that the ray meets, if that is nearer.
    #[inline]
    pub(super) fn meet<P: Probe>(
        &mut self,
        source: u32,
        walk: &Walk<'_>,
        query: &mut Query,
        best: &mut Found,
        probe: &mut P,
    ) {
        let source = self.sources[source as usize];
        if self.left < source.count.min(SourceRecord::FEW) {
            return;
        }
        self.left -= source.count.min(SourceRecord::FEW);
        if source.root != NONE {
            query.aim(source.root, best.t);
            let found = probe.nearest(walk, query);
            if found.triangle != NONE && (found.t, found.triangle) < (best.t, best.triangle) {
                *best = found;
            }
            return;
        }
        for &triangle in self.triangles_of(&source) {
            probe.test();
            query.test(walk, triangle, best);
        }
    }

    /// Whether a hit lies at most the tolerance behind a face that the ray passes at `t`, across the triangle.
    pub(super) fn is_near(&self, found: &Found, t: f64, walk: &Walk<'_>, query: &Query) -> bool {
        found.triangle != NONE
            && (found.t <= t + NEAR || {
                let normal = normal(walk.corners(found.triangle));
                ((found.t - t) * normal.dot(query.direction)).abs() <= self.tolerance
            })
    }

    /// The triangle of `source` that is nearest to `point`, where the ray passes a face at `t`, if that is within the
    /// tolerance; met at its plane, or at the face if the plane is farther, but not after `limit`.
    #[cold]
    pub(super) fn nearly_met(
        &mut self,
        source: u32,
        (t, point): (f64, DVec3),
        limit: f64,
        walk: &Walk<'_>,
        query: &Query,
    ) -> Option<Found> {
        let source = self.sources[source as usize];
        self.left = self.left.checked_sub(source.count)?;
        let mut best: Option<(Found, f64)> = None;
        for &triangle in self.triangles_of(&source) {
            let corners = walk.corners(triangle);
            let normal = normal(corners);
            let height = normal.dot(point - corners[0]);
            let off = distance(corners, point - normal * height).hypot(height);
            if off > self.tolerance || best.is_some_and(|(_, least)| off >= least) {
                continue;
            }
            let starts_on_it = query.surface.as_ref().is_some_and(|surface| {
                normal.dot(corners[0] - query.origin).abs() <= self.tolerance
                    && normal.dot(surface.normal).abs() >= 1.0 - ALIKE
            });
            if starts_on_it {
                continue;
            }
            let crossing = normal.dot(corners[0] - query.origin) / normal.dot(query.direction);
            // Along the plane there is no crossing, or far away.
            let t = if (crossing - t).abs() <= self.tolerance { crossing } else { t };
            if t <= limit {
                best = Some((Found { t: t.max(query.tmin), triangle }, off));
            }
        }
        best.map(|(found, _)| found)
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
