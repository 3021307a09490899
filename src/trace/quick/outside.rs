//! Rays from outside of all prisms: a view of a building from the street, a scan from the air.
//!
//! Such a ray is taken to where it is a little within the prisms' zone, in air that is in no doubt, if it meets nothing before that; from there another goes
//! on as any that starts in the air. What that meets, the ray itself is asked where.

use glam::DVec3;

use super::{Quick, Way, nothing};
use crate::format::Views;
use crate::trace::NONE;
use crate::trace::free::free;
use crate::trace::kernel::Ask;
use crate::trace::lanes::{Lanes, Portable};
use crate::trace::path::{BLURRED, NEAR};
use crate::trace::ray::Ray;
use crate::trace::single::Line;
use crate::trace::walk::{Found, Walk, inverse, open, walk};

/// So far within the zone's side through which it comes a ray is let start, metres, and it is let go no farther than this for that.
const DEEP: f64 = 4.0 * BLURRED;
const FARTHEST: f64 = 0.25;

/// From farther than this, metres, numbers do not tell well enough where a ray comes to the zone.
const FAR: f64 = 1e7;

/// Where a ray from outside goes on within the prisms: the cell, and the ray from there. `None` in doubt, and where it meets something before.
#[inline(always)]
pub(in crate::trace) fn enter<L: Lanes>(tables: &Views, ray: &Ray) -> Option<(u32, Ray)> {
    let way = Way::new(tables, ray)?;
    let (mut first, mut last, mut across) = (0.0, f64::INFINITY, 1.0);
    let [lo, hi] = tables.airgrid[0].zone();
    for axis in 0..3 {
        let inverse = 1.0 / way.along[axis];
        let (a, b) = ((lo[axis] - way.from[axis]) * inverse, (hi[axis] - way.from[axis]) * inverse);
        let (enters, leaves) = if a < b { (a, b) } else { (b, a) };
        if enters > first {
            (first, across) = (enters, way.along[axis].abs());
        }
        last = if leaves < last { leaves } else { last };
    }
    let further = DEEP / across;
    let there = first + further;
    if !(first > 0.0 && first <= FAR && further <= FARTHEST && there < last && there < way.limit) {
        return None;
    }
    let start = way.origin + way.direction * there;
    let (cell, is_clear) = free::<L>(tables, start.to_array(), NONE)?;
    let is_let = is_clear && !way.meets_before::<L>(start, there);
    is_let.then(|| (cell, Ray::new(start.to_array(), way.direction.to_array())))
}

impl Way<'_> {
    /// Whether it meets anything before `there`, which is at `start`.
    #[inline(always)]
    fn meets_before<L: Lanes>(&self, start: DVec3, there: f64) -> bool {
        let (tables, scene) = (self.tables, &self.tables.scene[0]);
        let root = tables.cells[0].root;
        let Some(node) = tables.nodes.get(root as usize) else { return true };
        // From there back.
        let local = (start - DVec3::from(scene.center)).as_vec3().to_array();
        let inverse = inverse(self.direction.as_vec3().to_array());
        let (hits, _) = open::<L>(node, local, inverse, [f32::NEG_INFINITY, scene.slack]);
        hits != 0 && meets_any_before(tables, self.ray, there)
    }
}

/// Whether a ray meets anything before `there`, or just there, which is where the other starts.
#[cold]
#[inline(never)]
fn meets_any_before(tables: &Views, ray: &Ray, there: f64) -> bool {
    let Some(line) = Line::new(tables, &Ray { tmax: there + NEAR, ..*ray }) else { return false };
    walk::<Portable>(Ask::Any, &Walk::new(tables), &line.query(tables, None), None, &mut ()).triangle != NONE
}

/// What a ray meets that goes on as another which met this; `None` where it does not itself meet that.
pub(in crate::trace) fn entered(tables: &Views, ray: &Ray, met: &Quick) -> Option<Quick> {
    let &Quick { found: Found { triangle, .. }, cell, source } = met;
    if triangle == NONE {
        return Some(nothing(ray.tmax, cell));
    }
    let mut found = Found { t: f64::INFINITY, triangle: NONE };
    if source == NONE {
        Line::new(tables, ray)?.whole(tables).test(&Walk::new(tables), triangle, &mut found);
    } else {
        found = Way::new(tables, ray)?.plate(source)?;
    }
    (found.triangle != NONE)
        .then(|| if found.t <= ray.tmax { Quick { found, ..*met } } else { nothing(ray.tmax, cell) })
}
