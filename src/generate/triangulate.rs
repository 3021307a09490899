//! Cutting a polygon with holes into triangles, or into strictly convex parts, at its own corners.
//!
//! The shortest diagonals are drawn first, as long as they cross nothing (the *greedy triangulation*). All tests are
//! exact in integers. Corners on straight lines are kept, and get triangles of their own: nothing is left out, so
//! that the parts of neighbouring faces meet edge to edge, and no triangle has zero area.
//!
//! Of all pairs of corners most are told to be no diagonal by a few segments that others from there crossed; for each of the rest all that is drawn is
//! looked at, so that time grows with the third power of the number of corners at worst. A face of a building has tens of them, seldom hundreds.

use std::collections::BTreeMap;

use super::outline::{cross, crosses_rightward, is_further_left, sub};

/// The polygon's triangles, counter-clockwise, as indices of its corners, counted through all its loops. `loops`:
/// the outline, counter-clockwise, then the holes, clockwise; they may touch, but not cross.
pub fn triangles(loops: &[Vec<[i64; 2]>]) -> Vec<[u32; 3]> {
    let net = Net::new(loops);
    let rings = net.parts(&net.diagonals);
    debug_assert!(rings.iter().all(|ring| ring.len() == 3), "a part without a diagonal has three corners");
    rings.iter().flat_map(|ring| ring.windows(2).skip(1).map(|w| [ring[0], w[0], w[1]])).collect()
}

/// The polygon cut into few strictly convex parts, counter-clockwise, as [`triangles`] counts corners: no part has a
/// corner on a straight line.
pub fn convex_parts(loops: &[Vec<[i64; 2]>]) -> Vec<Vec<u32>> {
    let net = Net::new(loops);
    let mut kept = net.diagonals.clone();
    // Long diagonals go first: they make thin parts.
    for index in (0..kept.len()).rev() {
        let mut without = kept.clone();
        let [a, b] = without.remove(index);
        if [a, b].into_iter().all(|corner| net.is_strictly_convex_at(corner, &without)) {
            kept = without;
        }
    }
    net.parts(&kept)
}

/// Whether the polygon can be handed on as a single loop: no holes, no corner twice, none on a straight line.
pub fn is_plain(loops: &[Vec<[i64; 2]>]) -> bool {
    let [ring] = loops else { return false };
    let mut sorted = ring.clone();
    sorted.sort_unstable();
    sorted.dedup();
    let turns = (0..ring.len()).all(|i| {
        let [before, at, after] = [0, 1, 2].map(|k| ring[(i + k) % ring.len()]);
        cross(sub(at, before), sub(after, at)) != 0
    });
    sorted.len() == ring.len() && turns
}

/// For each corner, so many of the edges and diagonals are kept which candidates from there crossed last: most that follow cross one of them.
const FENCES: usize = 6;

/// The polygon's corners, its boundary, and the diagonals of its greedy triangulation.
struct Net {
    points: Vec<[i64; 2]>,
    /// The polygon is on the left.
    boundary: Vec<[usize; 2]>,
    /// The shortest first.
    diagonals: Vec<[usize; 2]>,
}

impl Net {
    fn new(loops: &[Vec<[i64; 2]>]) -> Net {
        let points: Vec<[i64; 2]> = loops.iter().flatten().copied().collect();
        // Loops that touch have a point in common: it counts once, by its first index.
        let mut first = BTreeMap::new();
        let known: Vec<usize> =
            points.iter().enumerate().map(|(i, &p)| *first.entry(p).or_insert(i)).collect();
        let mut boundary = Vec::with_capacity(points.len());
        let mut start = 0;
        for ring in loops {
            let end = start + ring.len();
            boundary.extend((start..end).map(|i| [known[i], known[if i + 1 < end { i + 1 } else { start }]]));
            start = end;
        }
        let mut net = Net { points, boundary, diagonals: Vec::new() };
        net.draw_diagonals(&first.into_values().collect::<Vec<_>>(), loops.len());
        net
    }

    fn draw_diagonals(&mut self, corners: &[usize], loops: usize) {
        let mut candidates = Vec::new();
        let wedges = self.wedges();
        for (k, &a) in corners.iter().enumerate() {
            for &b in &corners[k + 1..] {
                if self.is_outward(wedges[a], a, b) || self.is_outward(wedges[b], b, a) {
                    continue;
                }
                let [dx, dy] = sub(self.points[b], self.points[a]);
                candidates.push((dx * dx + dy * dy, [a.min(b), a.max(b)]));
            }
        }
        candidates.sort_unstable();
        // By Euler's formula: with more, some would cross. A loop that touches itself or another may shut off one more face.
        let shut = loops + self.points.len() - corners.len();
        let all = (3 * (corners.len() + shut)).saturating_sub(6 + 2 * self.boundary.len());
        // At first such that nothing crosses.
        let mut fences = vec![[[0; 2]; FENCES]; self.points.len()];
        for (_, candidate) in candidates {
            if self.diagonals.len() == all {
                break;
            }
            let [a, b] = candidate;
            if fences[a].iter().chain(&fences[b]).any(|&fence| self.is_crossed(candidate, fence)) {
                continue;
            }
            if let Some(fence) = self.crossed_by(candidate) {
                for corner in candidate {
                    fences[corner].rotate_right(1);
                    fences[corner][0] = fence;
                }
            } else if self.is_free(candidate, corners) {
                self.diagonals.push(candidate);
            }
        }
    }

    /// The corners before and after each that the boundary passes once.
    fn wedges(&self) -> Vec<Option<[usize; 2]>> {
        let (mut before, mut after) =
            (vec![Vec::new(); self.points.len()], vec![Vec::new(); self.points.len()]);
        for &[a, b] in &self.boundary {
            after[a].push(b);
            before[b].push(a);
        }
        before
            .iter()
            .zip(&after)
            .map(|ends| if let ([a], [b]) = (&ends.0[..], &ends.1[..]) { Some([*a, *b]) } else { None })
            .collect()
    }

    /// Whether the way from a corner to another leads out of the polygon at once: no diagonal does.
    fn is_outward(&self, wedge: Option<[usize; 2]>, corner: usize, to: usize) -> bool {
        let Some([before, after]) = wedge else { return false };
        let [before, after, to] = [before, after, to].map(|end| sub(self.points[end], self.points[corner]));
        if cross(after, before) > 0 {
            cross(after, to) < 0 || cross(to, before) < 0
        } else {
            cross(before, to) > 0 && cross(to, after) > 0
        }
    }

    /// Whether a segment between two corners crosses one that is drawn.
    fn is_crossed(&self, [a, b]: [usize; 2], [c, d]: [usize; 2]) -> bool {
        let (p, q, r, s) = (self.points[a], self.points[b], self.points[c], self.points[d]);
        let is_apart = |i: usize| r[i].max(s[i]) <= p[i].min(q[i]) || r[i].min(s[i]) >= p[i].max(q[i]);
        // Most lie apart, or touch at most.
        if is_apart(0) || is_apart(1) {
            return false;
        }
        let side = |x: [i64; 2], y: [i64; 2], z: [i64; 2]| cross(sub(y, x), sub(z, x)).signum();
        side(p, q, r) * side(p, q, s) < 0 && side(r, s, p) * side(r, s, q) < 0
    }

    /// An edge or a diagonal that a segment crosses.
    fn crossed_by(&self, segment: [usize; 2]) -> Option<[usize; 2]> {
        self.boundary.iter().chain(&self.diagonals).copied().find(|&drawn| self.is_crossed(segment, drawn))
    }

    /// Whether a segment between two corners, which crosses no edge and no diagonal, lies inside the polygon and touches none but at its ends.
    fn is_free(&self, [a, b]: [usize; 2], corners: &[usize]) -> bool {
        let (p, q) = (self.points[a], self.points[b]);
        let along = sub(q, p);
        let is_between = |&c: &usize| {
            let r = sub(self.points[c], p);
            let far = r[0] * along[0] + r[1] * along[1];
            c != a
                && c != b
                && cross(along, r) == 0
                && far > 0
                && far < along[0] * along[0] + along[1] * along[1]
        };
        let is_drawn = |&[c, d]: &[usize; 2]| [c, d] == [a, b] || [d, c] == [a, b];
        if self.boundary.iter().chain(&self.diagonals).any(is_drawn) || corners.iter().any(is_between) {
            return false;
        }
        let middle = [p[0] + q[0], p[1] + q[1]];
        let around = self.boundary.iter();
        around.filter(|&&[c, d]| crosses_rightward(self.points[c], self.points[d], middle)).count() % 2 == 1
    }

    /// The parts between the boundary and some of the diagonals.
    fn parts(&self, diagonals: &[[usize; 2]]) -> Vec<Vec<u32>> {
        let both = diagonals.iter().flat_map(|&[a, b]| [[a, b], [b, a]]);
        let mut edges: Vec<[usize; 2]> = self.boundary.iter().copied().chain(both).collect();
        edges.sort_unstable();
        let mut used = vec![false; edges.len()];
        let mut parts = Vec::new();
        for start in 0..edges.len() {
            let mut part = Vec::new();
            let mut at = start;
            while !used[at] {
                used[at] = true;
                part.push(edges[at][0] as u32);
                at = self.next(&edges, at);
            }
            if !part.is_empty() {
                parts.push(part);
            }
        }
        parts
    }

    /// The edge that follows around the part to the left: the one furthest to the left that does not go back.
    fn next(&self, edges: &[[usize; 2]], at: usize) -> usize {
        let [a, b] = edges[at];
        let along = sub(self.points[b], self.points[a]);
        let turn = |i: usize| sub(self.points[edges[i][1]], self.points[b]);
        let first = edges.partition_point(|e| e[0] < b);
        let leaving = edges[first..].iter().take_while(|e| e[0] == b).count();
        (first..first + leaving)
            .filter(|&i| edges[i][1] != a)
            .reduce(|best, i| if is_further_left(along, turn(i), turn(best)) { i } else { best })
            .unwrap_or(at)
    }

    /// Whether all angles at a corner are under 180 degrees.
    fn is_strictly_convex_at(&self, corner: usize, diagonals: &[[usize; 2]]) -> bool {
        let both = diagonals.iter().flat_map(|&[a, b]| [[a, b], [b, a]]);
        let edges: Vec<[usize; 2]> = self.boundary.iter().copied().chain(both).collect();
        let mut leaving: Vec<[usize; 2]> = edges.iter().copied().filter(|e| e[0] == corner).collect();
        leaving.sort_unstable();
        edges.iter().filter(|e| e[1] == corner).all(|&[from, _]| {
            let along = sub(self.points[corner], self.points[from]);
            let turn = |to: usize| sub(self.points[to], self.points[corner]);
            let next = leaving
                .iter()
                .map(|e| e[1])
                .filter(|&to| to != from)
                .reduce(|best, to| if is_further_left(along, turn(to), turn(best)) { to } else { best });
            next.is_some_and(|to| cross(along, turn(to)) > 0)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::outline::doubled_area;
    use super::*;
    use proptest::prelude::*;

    fn at(loops: &[Vec<[i64; 2]>], part: &[u32]) -> Vec<[i64; 2]> {
        let points: Vec<_> = loops.iter().flatten().copied().collect();
        part.iter().map(|&i| points[i as usize]).collect()
    }

    /// Parts have positive areas that add up, are convex, and meet edge to edge.
    fn check(loops: &[Vec<[i64; 2]>], parts: &[Vec<u32>]) {
        let whole: i64 = loops.iter().map(|ring| doubled_area(ring)).sum();
        let rings: Vec<_> = parts.iter().map(|part| at(loops, part)).collect();
        assert_eq!(rings.iter().map(|ring| doubled_area(ring)).sum::<i64>(), whole);
        let edges = |ring: &Vec<[i64; 2]>| {
            (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect::<Vec<_>>()
        };
        let mut open: Vec<_> = rings.iter().flat_map(edges).collect();
        open.sort_unstable();
        let doubled = open.windows(2).any(|w| w[0] == w[1]);
        assert!(!doubled, "an edge occurs twice");
        let all = open.clone();
        open.retain(|[p, q]| all.binary_search(&[*q, *p]).is_err());
        let mut boundary: Vec<_> = loops.iter().flat_map(edges).collect();
        boundary.sort_unstable();
        assert_eq!(open, boundary);
        for ring in &rings {
            for i in 0..ring.len() {
                let [a, b, c] = [0, 1, 2].map(|k| ring[(i + k) % ring.len()]);
                assert!(cross(sub(b, a), sub(c, b)) > 0, "{ring:?} is not strictly convex");
            }
        }
    }

    fn check_both(loops: &[Vec<[i64; 2]>]) -> (usize, usize) {
        let triangles: Vec<Vec<u32>> = triangles(loops).into_iter().map(|t| t.to_vec()).collect();
        check(loops, &triangles);
        let parts = convex_parts(loops);
        check(loops, &parts);
        (triangles.len(), parts.len())
    }

    #[test]
    fn a_window_in_a_wall_gives_a_picture_frame() {
        let wall = vec![[0, 0], [50, 0], [50, 30], [0, 30]];
        let window = vec![[20, 9], [20, 21], [30, 21], [30, 9]];
        assert_eq!(check_both(&[wall, window]), (8, 4));
    }

    #[test]
    fn corners_on_straight_lines_stay() {
        let ring = vec![[0, 0], [10, 0], [20, 0], [20, 10], [10, 10], [0, 10]];
        assert!(!is_plain(std::slice::from_ref(&ring)));
        assert_eq!(check_both(&[ring]), (4, 2));
        let triangle = vec![[0, 0], [1, 0], [2, 0], [3, 0], [0, 3]];
        assert_eq!(check_both(&[triangle]), (3, 3));
    }

    #[test]
    fn plain_shapes() {
        let ell = vec![[0, 0], [4, 0], [4, 2], [2, 2], [2, 4], [0, 4]];
        assert!(is_plain(std::slice::from_ref(&ell)));
        assert_eq!(check_both(&[ell]), (4, 2));
        assert_eq!(check_both(&[vec![[0, 0], [4, 0], [0, 4]]]), (1, 1));
        assert_eq!(check_both(&[vec![[0, 0], [4, 0], [4, 4], [0, 4]]]), (2, 1));
    }

    #[test]
    fn a_hole_may_touch_the_outline() {
        let outline = vec![[0, 0], [4, 0], [8, 0], [8, 8], [0, 8]];
        let hole = vec![[4, 0], [3, 4], [5, 4]];
        let loops = [outline, hole];
        assert!(!is_plain(&loops));
        check_both(&loops);
    }

    proptest! {
        #[test]
        fn any_union_of_squares(cells in prop::collection::btree_set((0i32..7, 0i32..7), 1..40)) {
            let corner = |x, y| [3 * x, 5 * y, 0];
            let edges = cells.iter().flat_map(|&(x, y)| {
                let c = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
                (0..4).map(move |i| [c[i], c[(i + 1) % 4]])
            });
            for polygon in super::super::outline::polygons(edges.collect(), [0, 0, 1]) {
                let loops: Vec<Vec<[i64; 2]>> = polygon
                    .iter()
                    .map(|ring| ring.iter().map(|p| [i64::from(p[0]), i64::from(p[1])]).collect())
                    .collect();
                check_both(&loops);
            }
        }
    }
}
