//! Moving planes of a body along their normals: its corners follow, its other planes stay, and so its faces stay
//! planar and meet in the same edges.

use std::collections::BTreeMap;

use super::super::building::{Element, Face};
use super::super::flush;
use super::super::lattice::metres;

/// An outward normal without common factor, and the plane's height along it, units of the grid.
pub type Plane = ([i64; 3], i64);

/// Normals whose part across those before is shorter count as dependent.
const DEPENDENT: f64 = 1e-6;

/// A corner may miss a plane that does not fix it by so much, metres: it is rounding.
const MISSED: f64 = 1e-9;

/// A corner that would move by more than this many times the farthest plane stays: the planes there are too nearly
/// parallel.
const FARTHEST: f64 = 4.0;

/// The plane of a face.
pub fn plane(element: &Element, face: &Face) -> Plane {
    flush::plane(element, face)
}

/// How far a body reaches along a direction, in multiples of the direction's length: the least and the greatest.
pub fn reach(element: &Element, direction: [i64; 3]) -> [i64; 2] {
    let heights = element.points.iter().map(|p| height(direction, p.map(i64::from)));
    heights.fold([i64::MAX, i64::MIN], |[lo, hi], h| [lo.min(h), hi.max(h)])
}

/// The length of a normal.
pub fn length(normal: [i64; 3]) -> f64 {
    normal.iter().map(|&c| c as f64 * c as f64).sum::<f64>().sqrt()
}

/// How far a body reaches along a direction, metres.
pub fn extent(element: &Element, direction: [i64; 3]) -> f64 {
    let [lo, hi] = reach(element, direction);
    hi.saturating_sub(lo) as f64 * metres(1) / length(direction)
}

/// The height of a point along a direction, in multiples of the direction's length.
pub fn height(direction: [i64; 3], p: [i64; 3]) -> i64 {
    (0..3).map(|i| direction[i] * p[i]).sum()
}

/// Moves the planes of a body outward by what `by` says, metres, and the corners in `points` (of the same body,
/// metres) with them. Says whether it did: it leaves the corners alone if they cannot follow, or if a face would turn
/// over.
pub fn shift(element: &Element, points: &mut [[f64; 3]], by: impl Fn(&Plane) -> f64) -> bool {
    let planes: Vec<Plane> = element.faces.iter().map(|face| plane(element, face)).collect();
    let mut kinds: BTreeMap<Plane, usize> = BTreeMap::new();
    for plane in planes.iter().copied() {
        let next = kinds.len();
        kinds.entry(plane).or_insert(next);
    }
    let mut steps = vec![([0.0; 3], 0.0); kinds.len()];
    for (plane, &kind) in &kinds {
        let length = length(plane.0);
        steps[kind] = (plane.0.map(|c| c as f64 / length), by(plane));
    }
    let farthest = steps.iter().fold(0.0, |most: f64, (_, step)| most.max(step.abs()));
    if farthest == 0.0 {
        return true;
    }
    let mut at: Vec<(u32, usize)> = Vec::new();
    for (face, plane) in element.faces.iter().zip(&planes) {
        at.extend(face.loops.iter().flatten().map(|&corner| (corner, kinds[plane])));
    }
    at.sort_unstable();
    at.dedup();
    let mut moved = points.to_vec();
    for corner in at.chunk_by(|a, b| a.0 == b.0) {
        let around: Vec<_> = corner.iter().map(|&(_, kind)| steps[kind]).collect();
        let Some(step) = meet(&around, farthest) else { return false };
        let p = &mut moved[corner[0].0 as usize];
        *p = [0, 1, 2].map(|i| p[i] + step[i]);
    }
    let stays =
        element.faces.iter().zip(&planes).all(|(face, plane)| faces_along(element, face, plane, &moved));
    if stays {
        points.copy_from_slice(&moved);
    }
    stays
}

/// The shortest step of a corner after which it lies on all its planes, given by unit normals and how far they move.
fn meet(planes: &[([f64; 3], f64)], farthest: f64) -> Option<[f64; 3]> {
    let mut step = [0.0; 3];
    let mut basis: Vec<[f64; 3]> = Vec::with_capacity(3);
    for &(normal, by) in planes {
        let missing = by - dot(normal, step);
        // What of the normal is across those before: going along it leaves their planes met.
        let mut across = normal;
        for &axis in &basis {
            let along = dot(across, axis);
            across = [0, 1, 2].map(|i| across[i] - along * axis[i]);
        }
        let square = dot(across, across);
        if basis.len() == 3 || square < DEPENDENT * DEPENDENT {
            if missing.abs() > MISSED {
                return None;
            }
            continue;
        }
        step = [0, 1, 2].map(|i| step[i] + across[i] * (missing / square));
        let length = square.sqrt();
        basis.push(across.map(|c| c / length));
    }
    (dot(step, step) <= (FARTHEST * farthest) * (FARTHEST * farthest)).then_some(step)
}

/// Whether all triangles of a face still look to the side of its plane.
fn faces_along(element: &Element, face: &Face, (normal, _): &Plane, points: &[[f64; 3]]) -> bool {
    let normal = normal.map(|c| c as f64);
    element.triangles(face).into_iter().all(|triangle| {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        let (u, v) = (sub(b, a), sub(c, a));
        dot(normal, [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]) > 0.0
    })
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::super::super::lattice::point_metres;
    use super::super::super::{HouseOptions, house};
    use super::*;

    #[test]
    fn planes_that_meet_in_a_corner_carry_it_along() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let step = meet(&[(axes[0], 1.0), (axes[1], -2.0), (axes[2], 0.5)], 2.0).unwrap();
        assert_eq!(step, [1.0, -2.0, 0.5]);
        // Two planes fix two directions; the third stays.
        let oblique = meet(&[(axes[0], 1.0), ([0.6, 0.8, 0.0], 1.0)], 1.0).unwrap();
        assert!((oblique[1] - 0.5).abs() < 1e-15 && oblique[2] == 0.0, "{oblique:?}");
        // Opposite planes cannot both go outward, and nearly parallel ones not by different steps.
        assert_eq!(meet(&[(axes[0], 1.0), ([-1.0, 0.0, 0.0], 1.0)], 1.0), None);
        assert_eq!(meet(&[(axes[0], 1.0), ([1.0, 1e-3, 0.0], 0.0)], 1.0), None);
        let together = meet(&[(axes[0], 1.0), ([1.0, 1e-3, 0.0], 1.0)], 1.0).unwrap();
        assert!((together[0] - 1.0).abs() < 1e-6 && together[1].abs() < 1e-6, "{together:?}");
    }

    #[test]
    fn a_room_grows_by_its_surface() {
        let building = house(&HouseOptions::default());
        for room in building.elements.iter().filter(|e| e.class == "IfcSpace") {
            let exact: Vec<_> = room.points.iter().map(|&p| point_metres(p)).collect();
            let mut points = exact.clone();
            assert!(shift(room, &mut points, |_| 0.001));
            let area: f64 = room
                .faces
                .iter()
                .flat_map(|face| room.triangles(face))
                .map(|t| {
                    let [a, b, c] = t.map(|i| exact[i as usize]);
                    let (u, v) = (sub(b, a), sub(c, a));
                    let w = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                    dot(w, w).sqrt() / 2.0
                })
                .sum();
            let volume = |points: &[[f64; 3]]| -> f64 {
                let cones = room.faces.iter().flat_map(|face| room.triangles(face)).map(|t| {
                    let [a, b, c] = t.map(|i| points[i as usize]);
                    dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]])
                });
                cones.sum::<f64>() / 6.0
            };
            let grown = volume(&points) - volume(&exact);
            assert!((grown / (0.001 * area) - 1.0).abs() < 0.01, "{}: {grown} by {area}", room.name);
        }
    }

    #[test]
    fn what_would_turn_over_stays() {
        let building = house(&HouseOptions::default());
        let wall = building.elements.iter().find(|e| e.class == "IfcWallStandardCase").unwrap();
        let mut points: Vec<_> = wall.points.iter().map(|&p| point_metres(p)).collect();
        let before = points.clone();
        assert!(!shift(wall, &mut points, |_| -0.5), "the wall is 0.36 m thick");
        assert_eq!(points, before);
        assert!(shift(wall, &mut points, |_| 0.0) && points == before);
    }
}
