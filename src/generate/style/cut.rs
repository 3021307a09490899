//! Cutting a body in two by an upright plane, exactly on the grid.

use std::collections::BTreeMap;

use super::super::building::{Element, Face};
use super::super::lattice::{Point, units};
use super::super::outline::polygons;
use super::dice::Random;
use super::planes::{Plane, height, plane, reach};

/// How the two halves of a cut body meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Each is closed, and they touch: the cut's face is there twice, once for each half.
    Touching,
    /// Each is closed, and reaches past the other's end.
    Lapped,
    /// The cut's face is there once.
    InnerFace,
}

/// How far lapped halves reach into each other, metres.
const LAP: f64 = 0.02;

/// A body must be so many times longer than it is thick to be cut.
const SLENDER: i128 = 2;

/// Places that are tried for a cut.
const TRIES: i64 = 64;

/// The body cut across its longer horizontal direction, somewhere in its middle third; `None` if it is not slender, or
/// if a cut's corners would not be on the grid.
pub fn in_two(element: &Element, joint: Joint, mut random: Random) -> Option<Element> {
    let normal = long_direction(element)?;
    let [lo, hi] = reach(element, normal);
    let first = lo + (hi - lo) / 3 + ((hi - lo) / 3) * random.below(1024) as i64 / 1024;
    let lap = match joint {
        Joint::Lapped => (units(LAP) as f64 * super::planes::length(normal)).round() as i64,
        _ => 0,
    };
    // Away from the corners, so that each cut goes through edges alone.
    let cut = (0..TRIES).map(|i| first + i).find_map(|at| {
        let behind = half(element, (normal, at + lap))?;
        let before = half(element, (normal.map(|c| -c), -at))?;
        Some((behind, before))
    });
    let (behind, before) = cut?;
    Some(joined(element, behind, before, joint))
}

/// The normal of an upright face along which the body is longest, if it is much longer than across.
fn long_direction(element: &Element) -> Option<[i64; 3]> {
    let mut normals: Vec<[i64; 3]> = element.faces.iter().map(|face| plane(element, face).0).collect();
    normals.retain(|normal| normal[2] == 0);
    // A normal and its opposite cut alike.
    normals.iter_mut().filter(|n| **n < [0; 3]).for_each(|n| *n = n.map(|c| -c));
    normals.sort_unstable();
    normals.dedup();
    // Squares of lengths, times that of the normal: across is a quarter turn, and so has the same factor.
    let span = |direction: [i64; 3]| {
        let [lo, hi] = reach(element, direction);
        i128::from(hi) - i128::from(lo)
    };
    let slender = normals.into_iter().filter(|&n| span(n) >= SLENDER * span([-n[1], n[0], 0]));
    let factor = |n: [i64; 3]| n.iter().map(|&c| i128::from(c) * i128::from(c)).sum::<i128>();
    // The longest: span / length, compared by cross-multiplied squares.
    slender.reduce(|best, n| {
        let (a, b) = (span(best), span(n));
        let longer = b.checked_mul(b).and_then(|bb| bb.checked_mul(factor(best)))
            > a.checked_mul(a).and_then(|aa| aa.checked_mul(factor(n)));
        if longer { n } else { best }
    })
}

/// A part of a body's surface, as polygons of points.
struct Half {
    faces: Vec<(Face, Vec<Vec<Point>>)>,
    /// What closes it.
    caps: Vec<(Face, Vec<Vec<Point>>)>,
}

/// What of a body lies below a plane; `None` if a corner lies on it, or an edge crosses it off the grid.
fn half(element: &Element, (normal, level): Plane) -> Option<Half> {
    let above = |p: Point| height(normal, p.map(i64::from)) - level;
    if element.points.iter().any(|&p| above(p) == 0) {
        return None;
    }
    let mut half = Half { faces: Vec::new(), caps: Vec::new() };
    let mut closing = Vec::new();
    for face in &element.faces {
        let (own, _) = plane(element, face);
        let mut edges: Vec<[Point; 2]> = Vec::new();
        let mut crossings = Vec::new();
        for ring in &face.loops {
            for (i, &from) in ring.iter().enumerate() {
                let [p, q] = [from, ring[(i + 1) % ring.len()]].map(|corner| element.points[corner as usize]);
                match (above(p) < 0, above(q) < 0) {
                    (true, true) => edges.push([p, q]),
                    (false, false) => {}
                    (below, _) => {
                        let on = crossing(p, q, above(p), above(q))?;
                        edges.push(if below { [p, on] } else { [on, q] });
                        crossings.push(on);
                    }
                }
            }
        }
        if !crossings.is_empty() {
            // The cut runs through the face between every other pair of crossings; along this direction the part
            // that is kept lies on its left.
            let forth = cross(own, normal);
            crossings.sort_unstable_by_key(|&p| height(forth, p.map(i64::from)));
            for pair in crossings.chunks_exact(2).filter(|pair| pair[0] != pair[1]) {
                edges.push([pair[0], pair[1]]);
                closing.push([pair[1], pair[0]]);
            }
        }
        if edges.is_empty() {
            continue;
        }
        half.faces.extend(polygons(edges, own).into_iter().map(|loops| (face.clone(), loops)));
    }
    let inside = element.faces.iter().find(|face| face.beyond.is_none()).or(element.faces.first())?;
    let cap = Face { loops: Vec::new(), material: inside.material, beyond: None, seen: false };
    half.caps = polygons(closing, normal).into_iter().map(|loops| (cap.clone(), loops)).collect();
    Some(half)
}

fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Where an edge crosses the plane, if that is on the grid. `a` and `b`: its ends' heights over the plane, of different
/// signs.
fn crossing(p: Point, q: Point, a: i64, b: i64) -> Option<Point> {
    let mut on = [0; 3];
    for i in 0..3 {
        let step = i128::from(q[i]) - i128::from(p[i]);
        let (part, whole) = (step * i128::from(a), i128::from(a) - i128::from(b));
        if part % whole != 0 {
            return None;
        }
        on[i] = i32::try_from(i128::from(p[i]) + part / whole).ok()?;
    }
    Some(on)
}

/// The element with both halves for its mesh.
fn joined(element: &Element, behind: Half, before: Half, joint: Joint) -> Element {
    let mut whole = Element { points: Vec::new(), faces: Vec::new(), ..element.clone() };
    let caps = if joint == Joint::InnerFace { Vec::new() } else { before.caps };
    for part in [[behind.faces, behind.caps].concat(), [before.faces, caps].concat()] {
        let mut known = BTreeMap::new();
        for (face, loops) in part {
            let points = &mut whole.points;
            let mut index = |p: Point| {
                *known.entry(p).or_insert_with(|| {
                    points.push(p);
                    points.len() as u32 - 1
                })
            };
            let loops = loops.into_iter().map(|ring| ring.into_iter().map(&mut index).collect()).collect();
            whole.faces.push(Face { loops, ..face });
        }
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::super::super::{HouseOptions, house};
    use super::super::dice::Dice;
    use super::*;

    /// The directed edges that have no reverse.
    fn open_edges(element: &Element) -> usize {
        let mut edges: BTreeMap<[Point; 2], i32> = BTreeMap::new();
        for ring in element.faces.iter().flat_map(|f| &f.loops) {
            for (i, &from) in ring.iter().enumerate() {
                let [p, q] = [from, ring[(i + 1) % ring.len()]].map(|c| element.points[c as usize]);
                *edges.entry([p, q]).or_default() += 1;
                *edges.entry([q, p]).or_default() -= 1;
            }
        }
        edges.values().filter(|&&sum| sum > 0).map(|&sum| sum as usize).sum()
    }

    #[test]
    fn halves_are_closed_and_add_up() {
        let building = house(&HouseOptions::default());
        let mut cut = 0;
        for wall in building.elements.iter().filter(|e| e.class == "IfcWallStandardCase") {
            for seed in 0..8 {
                let random = Dice::new(seed).draw("cut", &wall.name);
                let touching = in_two(wall, Joint::Touching, random).unwrap();
                assert_eq!((open_edges(&touching), touching.sixfold_volume()), (0, wall.sixfold_volume()));
                let lapped = in_two(wall, Joint::Lapped, random).unwrap();
                assert_eq!(open_edges(&lapped), 0);
                assert!(lapped.sixfold_volume() > wall.sixfold_volume());
                let inner = in_two(wall, Joint::InnerFace, random).unwrap();
                assert!(open_edges(&inner) >= 4 && inner.faces.len() < touching.faces.len());
                // Every face can be cut for a file, and lies in its plane.
                for (body, face) in
                    [&touching, &lapped, &inner].iter().flat_map(|b| b.faces.iter().map(move |f| (b, f)))
                {
                    assert!(!body.triangles(face).is_empty());
                    let (normal, level) = plane(body, face);
                    let corners = face.loops.iter().flatten().map(|&i| body.points[i as usize]);
                    assert!(corners.into_iter().all(|p| height(normal, p.map(i64::from)) == level));
                }
                cut += 1;
            }
        }
        assert_eq!(cut, 14 * 8);
    }

    #[test]
    fn what_is_not_slender_stays_whole() {
        let building = house(&HouseOptions::default());
        let column = building.elements.iter().find(|e| e.class == "IfcColumn").unwrap();
        assert!(in_two(column, Joint::Touching, Dice::new(0).draw("cut", "")).is_none());
    }
}
