//! Cutting a region of the plan into few, fat, exactly convex polygons.
//!
//! The fewest convex polygons without new vertices can be found in polynomial time if the region has no holes (Keil,
//! "Decomposing a polygon into simpler components", SIAM J. Comput. 14, 1985); with holes it is NP-hard. So:
//!
//! - a region that one chain of moderate length bounds is cut in the best way (`best`);
//! - any other is triangulated (constrained Delaunay), and diagonals go, longest first, wherever both their ends stay
//!   convex (Hertel and Mehlhorn, "Fast triangulation of simple polygons", FCT 1983; Fernandez, Toth, Canovas and
//!   Pelegrin, "A practical algorithm for decomposing polygonal domains into convex polygons by diagonals", TOP 16,
//!   2008, on the order); at most four times as many parts as needed. Then neighbouring parts are taken together, as
//!   many as make a patch of moderate length, and each patch is cut in the best way, until no patch gets better.
//!
//! "Best" is fewest parts, and among those the least total length of cuts: a ray that crosses a room crosses a cut
//! as often as the cut is long, and slivers have long sides.
//!
//! Curved walls are put under hoods (`hoods`) where that lowers the expected cost of a ray ([`expected_cost`], the surface area heuristic of
//! Goldsmith and Salmon 1987 as Maria, Horna and Aveneau use it, section 6.2.1). The base line that they compare with is in `diagonals`.

mod best;
#[cfg(test)]
mod curve_tests;
mod diagonals;
mod hoods;
mod parts;
mod patches;
mod region;
#[cfg(test)]
mod tests;

use crate::lattice::{Point, orient};

use parts::Parts;
use region::Region;

/// Why a region cannot be cut: its boundary is not one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RegionError {
    /// A boundary chain has fewer than three vertices.
    #[error("a boundary chain of a region has {0} vertices: at least 3 are needed")]
    ShortChain(usize),
    /// A chain names a vertex that does not exist.
    #[error("a boundary chain of a region names vertex {0}, which does not exist")]
    NoSuchVertex(u32),
    /// Two vertices lie at one place.
    #[error("two vertices of a region's boundary lie at ({}, {})", .0.x, .0.y)]
    SamePlace(Point),
    /// An edge occurs twice, in the same or the other direction.
    #[error("a region's boundary runs twice between ({}, {}) and ({}, {})", .0.x, .0.y, .1.x, .1.y)]
    EdgeTwice(Point, Point),
    /// An edge crosses another or passes through a vertex, or the chains do not have the region on their left.
    #[error("the boundary of a region crosses itself or is turned about near ({}, {})", .0.x, .0.y)]
    Crossing(Point),
}

/// How regions are cut into convex parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Convexification {
    /// By the expected cost of rays: few parts with short cuts between them, hoods over curved walls.
    #[default]
    Cost,
    /// The base line that the paper compares with: by diagonals, one after the other, after Fernandez et al. (2008).
    Diagonals,
}

/// Cuts a region, as [`convex_parts`] takes it. What is cut by cost may have new corners inside, which `points` gets; if it is not `hooded`, there
/// are none.
///
/// # Errors
/// As [`convex_parts`].
pub(crate) fn cut(
    loops: &[Vec<u32>],
    points: &mut Vec<Point>,
    how: Convexification,
    hooded: bool,
) -> Result<Vec<Vec<u32>>, RegionError> {
    if how == Convexification::Diagonals {
        let region = Region::new(loops, points)?;
        // What touches itself so that it falls apart is no polygon.
        if let Ok(parts) = diagonals::cut(&region) {
            let ids = |part: Vec<u32>| part.into_iter().map(|v| region.ids[v as usize]).collect();
            return Ok(parts.into_iter().map(ids).collect());
        }
        return convex_parts(loops, points);
    }
    let mut best = convex_parts(loops, points)?;
    if !hooded || best.len() == 1 || !hoods::has_curve(loops, points) {
        return Ok(best);
    }
    let mut least = expected_cost(&best, points);
    let mut with = None;
    for cosine in ANGLES {
        let Some(hooded) = hoods::hooded(loops, points, cosine) else { continue };
        let cut = |loops: &[Vec<u32>]| convex_parts(loops, &hooded.points);
        let rest = cut(&hooded.chains);
        let under = hooded.corners.into_iter().map(|corner| cut(&[corner]));
        let Ok(parts) = std::iter::once(rest).chain(under).collect::<Result<Vec<_>, _>>() else { continue };
        let parts = parts.concat();
        let cost = expected_cost(&parts, &hooded.points);
        if cost < least {
            (best, least, with) = (parts, cost, Some(hooded.points));
        }
    }
    if let Some(with) = with {
        *points = with;
    }
    Ok(best)
}

/// By how much sides of a hood turn: cosines of 95, 60, 45 and 30 degrees.
const ANGLES: [f64; 4] = [-0.09, 0.5, std::f64::consts::FRAC_1_SQRT_2, 0.866];

/// What a random ray through a region may expect to pay, but for a factor: it crosses a convex part as often as that is long about (Cauchy and
/// Crofton), and pays for a part's corners where they are more than kernels look at together.
pub(crate) fn expected_cost(parts: &[Vec<u32>], points: &[Point]) -> f64 {
    /// Corners that are looked at together.
    const TOGETHER: usize = 8;
    /// What one more costs, in crossings.
    const MORE: f64 = 0.25;
    let of_part = |part: &Vec<u32>| {
        let n = part.len();
        let at = |k: usize| points[part[k % n] as usize];
        let turning = (0..n).filter(|&k| orient(at(k), at(k + 1), at(k + 2)) != 0).count();
        let length = |k: usize| {
            let (a, b) = (at(k), at(k + 1));
            let (dx, dy) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
            (dx * dx + dy * dy).sqrt()
        };
        let about: f64 = (0..n).map(length).sum();
        about * (1.0 + MORE * turning.saturating_sub(TOGETHER) as f64)
    };
    parts.iter().map(of_part).sum()
}

/// Cuts a region into exactly convex polygons.
///
/// `loops` is its boundary: closed chains of indices into `points` with the region on the left of each, the outer
/// chain counter-clockwise and holes clockwise. Chains may touch each other or themselves at vertices, must not cross
/// or pass through a vertex, and no edge may occur twice.
///
/// Returns polygons as counter-clockwise indices into `points`, which cover the region without overlap. Every vertex is
/// one of the boundary; no corner is reflex, and each polygon keeps the vertices in the middle of its straight sides,
/// so that neighbours share whole edges. The result depends on the arguments alone.
///
/// # Errors
///
/// If the boundary is found not to be one. Crossings are found in regions that are triangulated, not in all.
pub fn convex_parts(loops: &[Vec<u32>], points: &[Point]) -> Result<Vec<Vec<u32>>, RegionError> {
    let region = Region::new(loops, points)?;
    if let [chain] = &region.chains[..] {
        let corners: Vec<Point> = chain.iter().map(|&v| region.points[v as usize]).collect();
        if is_convex(&corners) {
            return Ok(vec![chain.iter().map(|&v| region.ids[v as usize]).collect()]);
        }
    }
    let parts = match Parts::whole(&region) {
        Some(parts) => parts,
        None => {
            let mut parts = Parts::triangles(&region)?;
            parts.dissolve();
            parts.improve();
            parts
        }
    };
    Ok(parts.take(&region.ids))
}

/// Whether a polygon is exactly convex and counter-clockwise; its sides may have vertices in their middle.
pub fn is_convex(polygon: &[Point]) -> bool {
    let n = polygon.len();
    if n < 3 {
        return false;
    }
    // All corners turn left or go straight on, and the direction passes from the lower half turn to the upper once.
    let mut rises = 0;
    for k in 0..n {
        let (a, b, c) = (polygon[k], polygon[(k + 1) % n], polygon[(k + 2) % n]);
        let turn = orient(a, b, c);
        if a == b || turn < 0 || (turn == 0 && is_upward(a, b) != is_upward(b, c)) {
            return false;
        }
        rises += usize::from(!is_upward(a, b) && is_upward(b, c));
    }
    rises == 1
}

/// Whether the direction from `a` to `b` lies in the half turn from +x, included, to -x.
fn is_upward(a: Point, b: Point) -> bool {
    (b.y, b.x) > (a.y, a.x)
}
