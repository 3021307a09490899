//! What a ray meets where it passes a cell's face between air and matter: the source's own triangles there, in f64.
//!
//! Cells are rounded to the lattice, and so is where a ray leaves them. What it meets, and where, is said by the
//! triangles that stand behind the face, tested as detail is.

use glam::DVec3;

use super::NONE;
use super::kernel::Probe;
use super::path::{NEAR, Prisms};
use super::walk::{Found, Query, Walk};
use crate::format::Views;
use crate::format::records::SourceRecord;

/// Triangles that a ray may test at faces. Only files made to be slow make it more; what they hide is not found.
const MOST_TESTS: u32 = 1 << 16;

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

    /// What a ray meets of `source` where it passes a face at `t`, `outward` being the face's normal of any length: not only up to where the ray
    /// ends, so that what it would meet after that is met, and not missed.
    pub(super) fn behind<P: Probe>(
        &mut self,
        source: u32,
        (t, outward): (f64, DVec3),
        walk: &Walk<'_>,
        query: &mut Query<'_>,
        probe: &mut P,
    ) -> Option<Found> {
        let (mut best, tolerance) = (Found { t: f64::INFINITY, triangle: NONE }, self.tolerance);
        // From the other side comes only a ray that rounding has put into the matter.
        let takes = |found: &Found, query: &Query<'_>| {
            is_near(found, (t, outward), tolerance, walk, query)
                && walk.enters(found.triangle, outward, query.direction)
        };
        self.meet(source, walk, query, &mut best, probe, takes);
        (best.triangle != NONE).then_some(best)
    }

    /// Makes `best` the nearest triangle of `source` that the ray meets and `takes`, if that is nearer.
    #[inline]
    pub(super) fn meet<P: Probe>(
        &mut self,
        source: u32,
        walk: &Walk<'_>,
        query: &mut Query<'_>,
        best: &mut Found,
        probe: &mut P,
        takes: impl Fn(&Found, &Query<'_>) -> bool,
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
        query: &mut Query<'_>,
        best: &mut Found,
        probe: &mut P,
        takes: impl Fn(&Found, &Query<'_>) -> bool,
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
}

/// No ray that is more than this across a face, as a sine, counts as one that runs along it.
const ALONG: f64 = 1.0 / 8.0;

/// Whether a ray runs along a face so much that what is narrower than cells are rounded, which they do not tell, may stand in its way for longer than
/// the tolerance before it comes to the face: the edge of a board on a wall. `outward` is the face's normal, of any length.
#[inline]
pub(super) fn runs_along(prisms: &Prisms<'_>, tolerance: f64, outward: DVec3, direction: DVec3) -> bool {
    let sine = outward.dot(direction).abs() / outward.length();
    let crosses = sine * tolerance >= prisms.rounding().min(ALONG * tolerance);
    !crosses
}

/// Whether a hit lies at most `tolerance` from a face that the ray passes at `t`, across the triangle, and, if it comes after that, across the face:
/// what stands farther behind the face than that is not among the detail of the cell, and may be met before.
fn is_near(
    found: &Found,
    (t, outward): (f64, DVec3),
    tolerance: f64,
    walk: &Walk<'_>,
    query: &Query<'_>,
) -> bool {
    let beyond = found.t - t;
    beyond.abs() <= NEAR || {
        let normal = normal(walk.corners(found.triangle));
        (beyond * normal.dot(query.direction)).abs() <= tolerance
            && beyond * outward.dot(query.direction).abs() <= tolerance * outward.length()
    }
}

/// The triangle's unit normal; 0 if it has none.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}
