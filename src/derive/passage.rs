//! How wide the way through a triangulated plan is.
//!
//! Triangles that share an edge need not be one place: where two walls nearly meet, triangles with long edges lead through a gap of a millimetre.
//! The width of the way from one edge of a triangle to another is that of Demyen and Buro (Efficient triangulation-based pathfinding, AAAI
//! 2006): how far the corner around which it leads is from the nearest obstacle beyond.

use crate::lattice::Point;

/// A triangulated plan, of which some edges can be crossed.
pub(super) trait Ground {
    /// The corners of a triangle.
    fn corners(&self, triangle: u32) -> [Point; 3];
    /// The triangle beyond the edge from corner i to the next, if one can go there.
    fn beyond(&self, triangle: u32, edge: usize) -> Option<u32>;
}

/// Triangles that are looked at beyond one; more says that nothing is near.
const DEEPEST: u32 = 32;

/// Whether the way through a triangle, around the corner that two of its edges share, is at least `width` wide, lattice units.
pub(super) fn is_wide(ground: &dyn Ground, triangle: u32, around: usize, width: f64) -> bool {
    let corners = ground.corners(triangle).map(|p| [f64::from(p.x), f64::from(p.y)]);
    let (v, a, b) = (corners[around], corners[(around + 1) % 3], corners[(around + 2) % 3]);
    if distance(v, a) < width || distance(v, b) < width {
        return false;
    }
    is_clear(ground, triangle, (around + 1) % 3, v, width, DEEPEST)
}

/// Whether nothing that blocks is nearer to `v` than `width` on or beyond an edge of a triangle.
fn is_clear(ground: &dyn Ground, triangle: u32, edge: usize, v: [f64; 2], width: f64, left: u32) -> bool {
    let corners = ground.corners(triangle).map(|p| [f64::from(p.x), f64::from(p.y)]);
    let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
    if to_segment(v, a, b) >= width {
        return true;
    }
    let Some(other) = ground.beyond(triangle, edge) else { return false };
    if left == 0 {
        return true;
    }
    // Its ends count: corners are where obstacles are.
    if distance(v, a) < width || distance(v, b) < width {
        return false;
    }
    let first = ground.corners(triangle)[edge];
    let theirs = ground.corners(other);
    // The edge back, and the two others.
    let Some(back) = (0..3).find(|&i| theirs[(i + 1) % 3] == first) else { return true };
    [(back + 1) % 3, (back + 2) % 3].into_iter().all(|edge| is_clear(ground, other, edge, v, width, left - 1))
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

fn to_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = d[0] * d[0] + d[1] * d[1];
    let along = if square > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    distance(p, [a[0] + d[0] * along, a[1] + d[1] * along])
}

/// Sets that grow together.
pub(super) struct Union(Vec<u32>);

impl Union {
    pub(super) fn new(count: usize) -> Union {
        Union((0..count as u32).collect())
    }

    /// The one that stands for the set of `i`: its least.
    pub(super) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    pub(super) fn join(&mut self, i: u32, j: u32) {
        let (i, j) = (self.find(i), self.find(j));
        self.0[i.max(j) as usize] = i.min(j);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles by their corners' numbers; all edges inside can be crossed.
    struct Plan(Vec<Point>, Vec<[usize; 3]>);

    impl Ground for Plan {
        fn corners(&self, triangle: u32) -> [Point; 3] {
            self.1[triangle as usize].map(|i| self.0[i])
        }

        fn beyond(&self, triangle: u32, edge: usize) -> Option<u32> {
            let own = self.1[triangle as usize];
            let (a, b) = (own[edge], own[(edge + 1) % 3]);
            let has = |t: &[usize; 3]| (0..3).any(|i| t[i] == b && t[(i + 1) % 3] == a);
            self.1.iter().position(has).map(|t| t as u32)
        }
    }

    /// A wall's end, 1 unit from a long wall without a corner near: the triangle between them has long edges, and is not wide.
    #[test]
    fn a_gap_is_narrow_though_its_edges_are_long() {
        let p = |x, y| Point::new(x, y);
        let points = vec![p(-1000, 0), p(1000, 0), p(0, 1), p(-1000, 800), p(1000, 800)];
        let plan = Plan(points, vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]]);
        assert!(!is_wide(&plan, 0, 2, 50.0));
        assert!(is_wide(&plan, 0, 2, 1.0));
        assert!(is_wide(&plan, 1, 0, 50.0));
    }

    #[test]
    fn what_is_beyond_an_open_edge_counts() {
        let p = |x, y| Point::new(x, y);
        // A corner that looks over an edge that can be crossed, to a wall 10 units farther.
        let points = vec![p(-100, 10), p(100, 10), p(0, 100), p(0, 0)];
        let open = Plan(points.clone(), vec![[0, 1, 2], [0, 3, 1]]);
        assert!(is_wide(&open, 0, 2, 95.0));
        assert!(!is_wide(&Plan(points, vec![[0, 1, 2]]), 0, 2, 95.0));
        assert!(!is_wide(&open, 0, 2, 101.0));
    }
}
