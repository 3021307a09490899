//! Which faces of cells are *plain*: behind which, all over, stand triangles of one plane.
//!
//! A ray that passes a plain face, no nearer to its border than cells tell apart, meets that plane, and no triangle need be
//! tested. That this holds is proved here, once, by taking the triangles away from the face and looking at what is left.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use crate::format::Tables;
use crate::format::records::{CellRecord, PLAIN, SourceRecord};
use crate::graph::{At, Part, area, clipped, cut, parts};
use crate::parallel;
use crate::trace::{BLURRED, NONE, Plate, Prisms, plate_of};

/// No corner of a plain face is farther from its plane than this, metres.
const NEAR: f64 = 2e-4;

/// How much wider triangles count as they are, metres: rays through gaps that narrow are right to meet what is beside them.
const SEAM: f64 = 1e-5;

/// What is left of a face may have this area, square metres, and all such pieces together that: not a place, but what rounding leaves.
const LEAST: f64 = 1e-9;
const LEAST_OF_ALL: f64 = 1e-7;

/// A face with more triangles is not looked at: slabs under corridors have thousands.
const MOST_TRIANGLES: usize = 1 << 14;

/// Triangles are taken away from pieces of a face at most so often; what falls into more is not told to be plain.
const MOST_LOOKS: usize = 1 << 18;

/// What was found out about a part of a cell's surface.
struct Found {
    at: At,
    /// Those of its source's triangles that rays may meet there, ascending.
    triangles: Vec<u32>,
    /// One in whose plane they all lie.
    plane: u32,
    is_plain: bool,
}

/// Drops from the sources of faces and covers what rays cannot meet there, marks those of prisms of air that are plain, and says
/// in which plane they lie. Returns how many are plain.
pub(super) fn add(tables: &mut Tables) -> u64 {
    let found = parallel::map(tables.cells.len(), |index| {
        let (prisms, cell) = (Prisms::of(tables), &tables.cells[index]);
        let parts = parts(&prisms, cell).into_iter();
        let found = parts.filter_map(|part| look(tables, &prisms, &part, cell.kind == CellRecord::AIR));
        found.collect::<Vec<_>>()
    });
    let mut lists = Lists::default();
    let (mut faces, mut covers) = (vec![NONE; tables.faces.len()], vec![NONE; tables.covers.len()]);
    let mut plain = 0;
    for Found { at, triangles, plane, is_plain } in found.into_iter().flatten() {
        let source = lists.number(&triangles, plane);
        plain += u64::from(is_plain);
        let flags = if is_plain { PLAIN } else { 0 };
        match at {
            At::Face(index) => {
                faces[index as usize] = source;
                tables.faces[index as usize].flags = flags;
            }
            At::Cover(index) => {
                covers[index as usize] = source;
                tables.covers[index as usize].flags = flags;
            }
        }
    }
    let Tables { faces: all_faces, covers: all_covers, sources, surfaces, .. } = tables;
    let own = all_faces.iter_mut().map(|face| &mut face.source).zip(&faces);
    for (source, &number) in own.chain(all_covers.iter_mut().map(|cover| &mut cover.source).zip(&covers)) {
        if *source != NONE && number == NONE {
            let SourceRecord { first, count, plane, .. } = sources[*source as usize];
            *source = lists.number(&surfaces[first as usize..(first + count) as usize], plane);
        } else {
            *source = number;
        }
    }
    (tables.sources, tables.surfaces) = (lists.sources, lists.triangles);
    plain
}

/// Lists of triangles, each once.
#[derive(Default)]
struct Lists {
    known: HashMap<Vec<u32>, u32>,
    sources: Vec<SourceRecord>,
    triangles: Vec<u32>,
}

impl Lists {
    fn number(&mut self, triangles: &[u32], plane: u32) -> u32 {
        if let Some(&number) = self.known.get(triangles) {
            return number;
        }
        let number = self.sources.len() as u32;
        let (first, count) = (self.triangles.len() as u32, triangles.len() as u32);
        self.sources.push(SourceRecord { first, count, root: NONE, plane });
        self.triangles.extend_from_slice(triangles);
        self.known.insert(triangles.to_vec(), number);
        number
    }
}

fn corners(tables: &Tables, triangle: u32) -> [DVec3; 3] {
    tables.triangles[triangle as usize].map(|v| DVec3::from(tables.vertices[v as usize]))
}

/// What rays can meet at a part of a cell's surface; `None` if it is not between air and matter, or its triangles lie in no one plane
/// near it.
fn look(tables: &Tables, prisms: &Prisms<'_>, part: &Part, is_air: bool) -> Option<Found> {
    let source = tables.sources.get(part.source as usize)?;
    let Plate { normal, offset, .. } = plate_of(&tables.triangles, &tables.vertices, source.plane);
    let normal = DVec3::from(normal);
    let triangles = prisms.triangles_of(part.source);
    let is_there = part.corners.iter().all(|&p| (normal.dot(p) - offset).abs() <= NEAR);
    if normal == DVec3::ZERO || triangles.len() > MOST_TRIANGLES || !is_there {
        return None;
    }
    let (u, v) = normal.any_orthonormal_pair();
    let flat = |p: DVec3| {
        let p = p - part.corners[0];
        DVec2::new(p.dot(u), p.dot(v))
    };
    let border = turned(part.corners.iter().map(|&p| flat(p)).collect());
    let shrunk = |by: f64| {
        edges(&border)
            .filter_map(|[p, q]| Some(((q - p).perp().try_normalize()?, p)))
            .fold(border.clone(), |polygon, (inward, p)| cut(&polygon, |r| inward.dot(r - p) - by))
    };
    // Nearer to the border no ray is asked about.
    let reached = shrunk(BLURRED / 2.0);
    let mut kept: Vec<(u32, Vec<DVec2>)> = Vec::new();
    let mut largest = (0.0, source.plane);
    for &triangle in triangles {
        let corners = corners(tables, triangle).map(flat);
        if is_apart(&reached, &corners) {
            continue;
        }
        let corners = turned(corners.to_vec());
        let shared = area(&clipped(reached.clone(), &corners));
        if shared > LEAST {
            kept.push((triangle, corners));
        }
        if shared > largest.0 {
            largest = (shared, triangle);
        }
    }
    if kept.is_empty() {
        // Hardly wider than its border, or bare.
        return None;
    }
    let looks = |t: u32| (tables.record(t).element, tables.record(t).material);
    let is_one = kept.iter().all(|&(t, _)| looks(t) == looks(largest.1));
    let is_plain = is_air && is_one && cover(shrunk(BLURRED), kept.iter().map(|(_, corners)| corners));
    Some(Found { at: part.at, triangles: kept.iter().map(|&(t, _)| t).collect(), plane: largest.1, is_plain })
}

/// Whether triangles cover a convex polygon; all counter-clockwise.
fn cover<'a>(polygon: Vec<DVec2>, triangles: impl Iterator<Item = &'a Vec<DVec2>>) -> bool {
    let mut pieces = vec![polygon];
    pieces.retain(|piece| area(piece) > LEAST);
    let (mut looks, mut lost) = (0, 0.0);
    for corners in triangles {
        looks += pieces.len();
        if looks > MOST_LOOKS {
            return false;
        }
        let sides: Vec<(DVec2, DVec2)> =
            edges(corners).filter_map(|[p, q]| Some(((q - p).perp().try_normalize()?, p))).collect();
        if sides.len() < 3 {
            continue;
        }
        let mut left = Vec::new();
        for mut piece in pieces {
            if is_apart(&piece, corners) {
                left.push(piece);
                continue;
            }
            for &(inward, p) in &sides {
                let beyond = cut(&piece, |r| -inward.dot(r - p) - SEAM);
                if area(&beyond) > LEAST {
                    left.push(beyond);
                } else {
                    lost += area(&beyond).max(0.0);
                }
                piece = cut(&piece, |r| inward.dot(r - p) + SEAM);
            }
        }
        pieces = left;
    }
    pieces.is_empty() && lost <= LEAST_OF_ALL
}

/// The corners counter-clockwise.
fn turned(mut corners: Vec<DVec2>) -> Vec<DVec2> {
    if area(&corners) < 0.0 {
        corners.reverse();
    }
    corners
}

fn edges(corners: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
}

/// Whether the boxes around two polygons are farther apart than triangles count as wider.
fn is_apart(one: &[DVec2], other: &[DVec2]) -> bool {
    let bounds = |polygon: &[DVec2]| {
        let far = DVec2::splat(f64::INFINITY);
        polygon.iter().fold((far, -far), |(lo, hi), &p| (lo.min(p), hi.max(p)))
    };
    let ((lo, hi), (from, to)) = (bounds(one), bounds(other));
    (lo - SEAM).cmpgt(to).any() || (hi + SEAM).cmplt(from).any()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::records::TriangleRecord;

    /// Tables with one source, of these triangles in the plane z = 1, and a square of 1 m there as part of a surface.
    fn is_square_plain(triangles: &[[[f64; 2]; 3]], z: f64) -> bool {
        let mut tables = Tables::default();
        for (i, corners) in triangles.iter().enumerate() {
            let first = 3 * i as u32;
            tables.vertices.extend(corners.map(|[x, y]| [x, y, 1.0]));
            let vertices = [first, first + 1, first + 2];
            tables.push(TriangleRecord { vertices, element: 0, material: 0, volume: NONE, facing: 0 });
            tables.surfaces.push(i as u32);
        }
        tables.sources.push(SourceRecord { first: 0, count: triangles.len() as u32, root: NONE, plane: 0 });
        tables.scene.push(bytemuck::Zeroable::zeroed());
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let corners = corners.map(|(x, y)| DVec3::new(x, y, z)).to_vec();
        let part = Part { corners, beyond: 0, source: 0, kind: 0, at: At::Face(0) };
        look(&tables, &Prisms::of(&tables), &part, true).is_some_and(|found| found.is_plain)
    }

    #[test]
    fn a_face_is_plain_where_its_triangles_cover_it() {
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(is_square_plain(&[[a, b, c], [a, c, d]], 1.0));
        // Whichever way they look, more of them than needed, and larger ones.
        assert!(is_square_plain(&[[a, c, b], [a, c, d], [b, c, d]], 1.0));
        assert!(is_square_plain(&[[[-1.0, -1.0], [4.0, -1.0], [-1.0, 4.0]]], 1.0 + 1e-4));
        // Not where a corner is missing, where there is a slit, or where they lie behind.
        assert!(!is_square_plain(&[[a, b, c]], 1.0));
        assert!(!is_square_plain(&[[a, b, [0.99, 1.0]], [a, [0.99, 1.0], d]], 1.0));
        assert!(!is_square_plain(&[[a, b, c], [[0.0, 0.001], [0.999, 1.0], d]], 1.0));
        assert!(!is_square_plain(&[[a, b, c], [a, c, d]], 1.001));
    }

    #[test]
    fn a_face_of_many_triangles_is_plain_too() {
        // Two fans of slivers over the square, in no order.
        let mut triangles = Vec::new();
        for i in 0..600 {
            let [from, to] = [f64::from(i), f64::from(i + 1)].map(|c| c / 600.0);
            triangles.push([[0.0, 0.0], [1.0, from], [1.0, to]]);
            triangles.push([[0.0, 0.0], [to, 1.0], [from, 1.0]]);
        }
        let mut random = crate::splitmix::SplitMix64::new(3);
        for i in (1..triangles.len()).rev() {
            triangles.swap(i, random.below(i as u64 + 1) as usize);
        }
        assert!(is_square_plain(&triangles, 1.0));
        triangles.pop();
        assert!(!is_square_plain(&triangles, 1.0));
    }

    #[test]
    fn seams_and_borders_within_rounding_do_not_matter() {
        let [a, b, c, d] = [[1e-4, 1e-4], [0.9999, 1e-4], [0.9999, 0.9999], [1e-4, 0.9999]];
        assert!(is_square_plain(&[[a, b, c], [[1e-4, 1.02e-4], [0.99988, 0.9999], d]], 1.0));
    }
}
