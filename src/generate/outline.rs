//! Joining faces of one plane: from the edges of all of them to the outlines of their union.

use super::lattice::Point;

/// The polygons that the edges of adjoining faces in one plane bound: of each its outline, counter-clockwise seen
/// against `normal`, then its holes, clockwise. Edges that occur in both directions are inside and go.
pub fn polygons(mut edges: Vec<[Point; 2]>, normal: [i64; 3]) -> Vec<Vec<Vec<Point>>> {
    edges.sort_unstable();
    edges.dedup();
    let kept: Vec<[Point; 2]> =
        edges.iter().filter(|[p, q]| edges.binary_search(&[*q, *p]).is_err()).copied().collect();
    let mut outlines = Vec::new();
    let mut holes = Vec::new();
    for ring in rings(&kept, normal) {
        let flat: Vec<[i64; 2]> = ring.iter().map(|&p| flatten(p, normal)).collect();
        let area = doubled_area(&flat);
        if area > 0 {
            outlines.push((area, flat, vec![ring]));
        } else {
            holes.push((flat, ring));
        }
    }
    for (flat, ring) in holes {
        // The middle of a hole's edge lies strictly inside the outline around it, even where they touch.
        let middle = [flat[0][0] + flat[1][0], flat[0][1] + flat[1][1]];
        let around = outlines
            .iter_mut()
            .filter(|(_, outline, _)| encloses(outline, middle))
            .min_by_key(|(area, _, _)| *area);
        debug_assert!(around.is_some(), "a hole without an outline around it");
        if let Some((_, _, loops)) = around {
            loops.push(ring);
        }
    }
    outlines.into_iter().map(|(_, _, loops)| loops).collect()
}

/// Closed rings of edges that have no reverse among them. Where several meet at a point, each turns to the left as
/// far as it can, so that rings do not cross and outlines that touch stay apart.
fn rings(edges: &[[Point; 2]], normal: [i64; 3]) -> Vec<Vec<Point>> {
    let mut used = vec![false; edges.len()];
    let mut rings = Vec::new();
    for start in 0..edges.len() {
        if used[start] {
            continue;
        }
        let mut ring = Vec::new();
        let mut at = start;
        while !used[at] {
            used[at] = true;
            let [p, q] = edges[at];
            ring.push(p);
            let along = sub(flatten(q, normal), flatten(p, normal));
            let first = edges.partition_point(|e| e[0] < q);
            let leaving = edges[first..].iter().take_while(|e| e[0] == q).count();
            let turn = |i: usize| sub(flatten(edges[i][1], normal), flatten(q, normal));
            let next = (first..first + leaving)
                .reduce(|best, i| if is_further_left(along, turn(i), turn(best)) { i } else { best });
            debug_assert!(next.is_some(), "an edge that leads nowhere");
            match next {
                Some(next) => at = next,
                None => break,
            }
        }
        rings.push(ring);
    }
    rings
}

/// A point in the plane's own coordinates: the axis along which the plane looks most is dropped, and the two others
/// keep the orientation.
pub fn flatten(p: Point, normal: [i64; 3]) -> [i64; 2] {
    let size = normal.map(i64::abs);
    let drop = if size[2] >= size[0] && size[2] >= size[1] {
        2
    } else if size[0] >= size[1] {
        0
    } else {
        1
    };
    let (a, b) = (i64::from(p[(drop + 1) % 3]), i64::from(p[(drop + 2) % 3]));
    if normal[drop] > 0 { [a, b] } else { [b, a] }
}

/// Twice the area inside a ring; negative if it is clockwise.
pub fn doubled_area(ring: &[[i64; 2]]) -> i64 {
    let around = ring.iter().zip(ring.iter().cycle().skip(1));
    around.map(|(&p, &q)| cross(sub(p, ring[0]), sub(q, ring[0]))).sum()
}

/// Whether a ring goes around a point, given in doubled coordinates, that is not on it.
pub fn encloses(ring: &[[i64; 2]], doubled: [i64; 2]) -> bool {
    let around = ring.iter().zip(ring.iter().cycle().skip(1));
    around.filter(|&(&p, &q)| crosses_rightward(p, q, doubled)).count() % 2 == 1
}

/// Whether the edge from `p` to `q` crosses the ray to the right of a point in doubled coordinates.
pub fn crosses_rightward(p: [i64; 2], q: [i64; 2], doubled: [i64; 2]) -> bool {
    let (p, q) = (p.map(|c| 2 * c), q.map(|c| 2 * c));
    if (p[1] > doubled[1]) == (q[1] > doubled[1]) {
        return false;
    }
    let side = cross(sub(q, p), sub(doubled, p));
    if q[1] > p[1] { side > 0 } else { side < 0 }
}

/// The difference of two plane points.
#[inline]
pub fn sub(a: [i64; 2], b: [i64; 2]) -> [i64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// The cross product of two plane vectors: positive if `b` is to the left of `a`.
#[inline]
pub fn cross(a: [i64; 2], b: [i64; 2]) -> i64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Whether, coming along `along`, direction `a` turns further to the left than `b`. None of them goes straight
/// back.
pub fn is_further_left(along: [i64; 2], a: [i64; 2], b: [i64; 2]) -> bool {
    let (side_a, side_b) = (cross(along, a).signum(), cross(along, b).signum());
    if side_a == side_b { cross(b, a) > 0 } else { side_a > side_b }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: [i64; 3] = [0, 0, 1];

    fn square(x: i32, y: i32) -> Vec<[Point; 2]> {
        let c = [[x, y, 5], [x + 1, y, 5], [x + 1, y + 1, 5], [x, y + 1, 5]];
        (0..4).map(|i| [c[i], c[(i + 1) % 4]]).collect()
    }

    fn squares(cells: &[(i32, i32)]) -> Vec<Vec<Vec<Point>>> {
        polygons(cells.iter().flat_map(|&(x, y)| square(x, y)).collect(), UP)
    }

    #[test]
    fn neighbours_join_and_corners_do_not() {
        assert_eq!(squares(&[(0, 0), (1, 0)]).len(), 1);
        assert_eq!(squares(&[(0, 0), (1, 1)]).len(), 2, "they only touch at a point");
        assert_eq!(squares(&[(0, 0), (2, 0)]).len(), 2);
    }

    #[test]
    fn holes_find_their_outline() {
        let ring = [(0, 0), (1, 0), (2, 0), (0, 1), (2, 1), (0, 2), (1, 2), (2, 2)];
        let found = squares(&[&ring[..], &[(5, 0)]].concat());
        assert_eq!(found.len(), 2);
        let with_hole = found.iter().find(|p| p.len() == 2).unwrap();
        assert_eq!((with_hole[0].len(), with_hole[1].len()), (12, 4));
        let hole: Vec<_> = with_hole[1].iter().map(|&p| flatten(p, UP)).collect();
        assert_eq!(doubled_area(&hole), -2);
    }

    #[test]
    fn planes_keep_their_orientation() {
        // The box's face that looks along each axis, counter-clockwise from outside.
        let faces: [([i64; 3], [Point; 3]); 4] = [
            ([1, 0, 0], [[1, 0, 0], [1, 1, 0], [1, 1, 1]]),
            ([-1, 0, 0], [[0, 0, 0], [0, 0, 1], [0, 1, 1]]),
            ([0, 1, 0], [[0, 1, 0], [0, 1, 1], [1, 1, 1]]),
            ([0, -2, -3], [[0, 0, 0], [0, 3, -2], [1, 0, 0]]),
        ];
        for (normal, points) in faces {
            let flat: Vec<_> = points.iter().map(|&p| flatten(p, normal)).collect();
            assert!(doubled_area(&flat) > 0, "{normal:?}");
        }
    }
}
