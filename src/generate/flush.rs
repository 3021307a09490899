//! Faces of details that lie flush on a solid and so cannot be seen: a table leg's foot on the floor.

use std::collections::BTreeMap;

use super::building::{Element, Face, Kind};
use super::outline::{cross, encloses, flatten, sub};

/// A face's loops in coordinates of its plane.
type Loops = Vec<Vec<[i64; 2]>>;

/// Marks the faces of details that lie on a seen face of a solid with all their corners and the middles of all
/// their edges.
pub fn mark_flush_details(elements: &mut [Element]) {
    let mut solids: BTreeMap<([i64; 3], i64), Vec<Loops>> = BTreeMap::new();
    for element in elements.iter().filter(|e| e.kind == Kind::Solid) {
        for face in element.faces.iter().filter(|face| face.seen) {
            solids.entry(plane(element, face)).or_default().push(element.flat_loops(face));
        }
    }
    for element in elements.iter_mut().filter(|e| e.kind == Kind::Detail) {
        let is_flush = |face: &Face| {
            let (normal, height) = plane(element, face);
            let opposite = normal.map(|c| -c);
            let Some(behind) = solids.get(&(opposite, -height)) else { return false };
            let outline: Vec<[i64; 2]> =
                face.loops[0].iter().map(|&i| flatten(element.points[i as usize], opposite)).collect();
            behind.iter().any(|loops| lies_within(&outline, loops))
        };
        let flush: Vec<bool> = element.faces.iter().map(is_flush).collect();
        for (face, flush) in element.faces.iter_mut().zip(flush) {
            face.seen &= !flush;
        }
    }
}

/// The plane of a face: its outward normal without common factor, and its height along it.
pub fn plane(element: &Element, face: &Face) -> ([i64; 3], i64) {
    let normal = element.normal(face);
    let common = normal.iter().fold(0, |a, c| gcd(a, c.unsigned_abs())).max(1) as i64;
    let normal = normal.map(|c| c / common);
    let p = element.points[face.loops[0][0] as usize];
    (normal, (0..3).map(|i| normal[i] * i64::from(p[i])).sum())
}

/// The greatest common divisor; that of 0 and `b` is `b`.
pub fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn lies_within(outline: &[[i64; 2]], loops: &Loops) -> bool {
    let around = outline.iter().zip(outline.iter().cycle().skip(1));
    around.flat_map(|(p, q)| [[2 * p[0], 2 * p[1]], [p[0] + q[0], p[1] + q[1]]]).all(|p| covers(loops, p))
}

/// Whether a polygon with holes has a point, given in doubled coordinates, inside or on its boundary.
fn covers(loops: &Loops, doubled: [i64; 2]) -> bool {
    let is_on = |p: [i64; 2], q: [i64; 2]| {
        let (from_p, to_q) = (sub(doubled, p.map(|c| 2 * c)), sub(q.map(|c| 2 * c), doubled));
        cross(from_p, to_q) == 0 && from_p[0] * to_q[0] + from_p[1] * to_q[1] >= 0
    };
    let on_boundary =
        loops.iter().any(|ring| ring.iter().zip(ring.iter().cycle().skip(1)).any(|(&p, &q)| is_on(p, q)));
    on_boundary || loops.iter().filter(|ring| encloses(ring, doubled)).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_covers_its_boundary_but_not_its_hole() {
        let loops = vec![vec![[0, 0], [10, 0], [10, 10], [0, 10]], vec![[4, 4], [4, 6], [6, 6], [6, 4]]];
        assert!(covers(&loops, [0, 0]) && covers(&loops, [8, 10]) && covers(&loops, [2, 2]));
        assert!(!covers(&loops, [10, 10]) && !covers(&loops, [21, 2]) && !covers(&loops, [-2, 0]));
        assert!(lies_within(&[[0, 0], [4, 0], [4, 4], [0, 4]], &loops));
        assert!(!lies_within(&[[5, 3], [7, 5], [5, 7], [3, 5]].map(|[x, y]| [x, y - 2]), &loops));
        assert!(!lies_within(&[[8, 2], [12, 2], [12, 4], [8, 4]], &loops));
    }
}
