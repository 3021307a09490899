//! Rays that start within the tolerance of a surface that encloses nothing.
//!
//! Such a start counts as on the side that the direction leads to. A parallel ray that starts there may be none to a ray that hardly
//! leaves the surface, and comes through it far off: what else it passes by as narrowly a shift may have in its way.

use enfilade_importers::ElementId;

use super::soup::{Nearest, first_t};
use super::triangle::closest_point;
use super::vector::distance;
use super::witness::Sought;
use super::{Truth, start};
use crate::trace::Ray;

/// How far the start is from the surfaces that the ray leaves unmet, if the answer is exact but for them; `None` if it is not, or if
/// one of them is farther than the tolerance, or of a solid.
pub(super) fn from_surface(truth: &Truth, ray: &Ray, sought: Sought, exact: f64) -> Option<f64> {
    let begin = start(ray)?;
    let to = match sought {
        Sought::Hit { t, .. } => t + exact,
        Sought::Escaped => ray.tmax,
    };
    let encloses = |element: ElementId| truth.solids.binary_search_by_key(&element, |solid| solid.0).is_ok();
    let off = |hit: &Nearest| {
        let index = truth.soup.first[hit.element.0 as usize] + hit.triangle;
        distance(closest_point(&truth.soup.corners[index as usize], begin), begin)
    };
    let mut farthest: Option<f64> = None;
    for hit in truth.hits_between(ray, first_t(ray), to) {
        if let Sought::Hit { t, element } = sought
            && hit.element == element
            && (hit.t - t).abs() <= exact
        {
            return farthest;
        }
        let off = off(&hit);
        if off > truth.tolerance || encloses(hit.element) {
            return None;
        }
        farthest = Some(farthest.map_or(off, |farthest| farthest.max(off)));
    }
    farthest.filter(|_| sought == Sought::Escaped)
}
