//! The plan of a slab as triangles: a constrained Delaunay triangulation of links that do not cross.

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::lattice::Point;

/// No triangle, no link.
pub(super) const NONE: u32 = u32::MAX;

/// A triangulated plan.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    pub(super) points: Vec<Point>,
    /// Corners, counter-clockwise.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The triangle beyond the edge from corner i to the next; [`NONE`] beyond the hull.
    pub(super) across: Vec<[u32; 3]>,
    /// The link on that edge; [`NONE`] for an edge of the triangulation alone.
    pub(super) links: Vec<[u32; 3]>,
}

impl Plan {
    pub(super) fn corners(&self, triangle: u32) -> [Point; 3] {
        self.triangles[triangle as usize].map(|v| self.points[v as usize])
    }
}

/// The links conflict: they were not snapped.
#[derive(Debug, thiserror::Error)]
#[error("the plan's links cross")]
pub(super) struct Conflict;

/// Triangulates the convex hull of `points`, which must be different, with `links` as edges, which must be sorted, each
/// from its lesser to its greater index, and must not cross or pass through points.
pub(super) fn triangulate(points: Vec<Point>, links: &[[u32; 2]]) -> Result<Plan, Conflict> {
    // One by one, in an order of their own: bulk loading inserts some in the order of a randomly seeded hash set, and
    // where four points lie on a circle the order decides.
    let order = morton_order(&points);
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handle = vec![FixedVertexHandle::from_index(0); points.len()];
    let mut last: Option<FixedVertexHandle> = None;
    for (k, &v) in order.iter().enumerate() {
        let place = points[v as usize];
        let place = Point2::new(f64::from(place.x), f64::from(place.y));
        let inserted = match last {
            Some(last) => triangulation.insert_with_hint(place, last),
            None => triangulation.insert(place),
        };
        let inserted = inserted.map_err(|_| Conflict)?;
        if inserted.index() != k {
            return Err(Conflict);
        }
        handle[v as usize] = inserted;
        last = Some(inserted);
    }
    for link in links {
        let [from, to] = link.map(|v| handle[v as usize]);
        triangulation.try_add_constraint(from, to);
        if !triangulation.exists_constraint(from, to) {
            return Err(Conflict);
        }
    }
    let count = triangulation.num_inner_faces();
    let mut plan = Plan { points, ..Plan::default() };
    plan.triangles.reserve(count);
    plan.across.reserve(count);
    plan.links.reserve(count);
    for face in triangulation.inner_faces() {
        let edges = face.adjacent_edges();
        plan.triangles.push(edges.map(|edge| order[edge.from().fix().index()]));
        // The outer face has the index 0.
        plan.across.push(edges.map(|edge| match edge.rev().face().fix().index() {
            0 => NONE,
            inner => inner as u32 - 1,
        }));
        plan.links.push(edges.map(|edge| {
            let (a, b) = (order[edge.from().fix().index()], order[edge.to().fix().index()]);
            if !edge.is_constraint_edge() {
                return NONE;
            }
            links.binary_search(&[a.min(b), a.max(b)]).map_or(NONE, |link| link as u32)
        }));
    }
    Ok(plan)
}

/// Points that lie near each other one after another: along Morton's curve.
fn morton_order(points: &[Point]) -> Vec<u32> {
    let spread = |c: i32| {
        let mut bits = u64::from((i64::from(c) + (1 << 31)) as u32);
        for (shift, mask) in [
            (16, 0x0000_ffff_0000_ffff),
            (8, 0x00ff_00ff_00ff_00ff),
            (4, 0x0f0f_0f0f_0f0f_0f0f),
            (2, 0x3333_3333_3333_3333),
            (1, 0x5555_5555_5555_5555u64),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&v| {
        let p = points[v as usize];
        (spread(p.x) | spread(p.y) << 1, v)
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::double_area;

    #[test]
    fn a_square_with_a_cross_wall() {
        let p = |x, y| Point::new(x, y);
        let points = vec![p(0, 0), p(10, 0), p(10, 10), p(0, 10), p(5, 2), p(5, 8)];
        let links = [[0, 1], [0, 3], [1, 2], [2, 3], [4, 5]];
        let plan = triangulate(points, &links).unwrap();
        let area: i64 = (0..plan.triangles.len()).map(|t| double_area(&plan.corners(t as u32))).sum();
        assert_eq!(area, 200);
        let mut seen = [0; 5];
        for t in 0..plan.triangles.len() {
            assert!(double_area(&plan.corners(t as u32)) > 0);
            for i in 0..3 {
                let (a, b) = (plan.triangles[t][i], plan.triangles[t][(i + 1) % 3]);
                if plan.links[t][i] != NONE {
                    seen[plan.links[t][i] as usize] += 1;
                    assert_eq!(links[plan.links[t][i] as usize], [a.min(b), a.max(b)]);
                }
                match plan.across[t][i] {
                    NONE => assert!(plan.links[t][i] != NONE),
                    other => {
                        let back = plan.across[other as usize].iter().position(|&o| o == t as u32).unwrap();
                        assert_eq!(plan.triangles[other as usize][back], b);
                    }
                }
            }
        }
        assert_eq!(seen, [1, 1, 1, 1, 2]);
    }

    #[test]
    fn crossing_links_are_refused() {
        let p = |x, y| Point::new(x, y);
        let points = vec![p(0, 0), p(10, 0), p(10, 10), p(0, 10)];
        assert!(triangulate(points, &[[0, 2], [1, 3]]).is_err());
    }
}
