//! The two ends of an opening: which way through it leads, and points of where it begins and ends.
//!
//! An opening's mesh says where the hole is, not which of its sides are open. The way through leads across the host where that is known:
//! along the normal that most of the host's surface near the opening has. Else, and where that does not lead from air to air, each direction
//! that the opening's own faces look in is tried, and the one with least matter before its ends is taken.

use glam::DVec3;

/// A triangle, metres, internal frame.
pub(super) type Corners = [DVec3; 3];

/// Where a line along the way through enters and leaves the opening's mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Through {
    pub(super) enters: DVec3,
    pub(super) leaves: DVec3,
}

/// Directions nearer to each other than this (cosine) are one.
const ALIKE: f64 = 0.95;

/// A direction counts if it has this share of the area of the one that has most: round corners look everywhere.
const LEAST: f64 = 0.15;

/// The directions that most of some triangles look in, either way, by their area: no two of them alike. The first is that of the largest area.
pub(super) fn directions(triangles: &[Corners]) -> Vec<DVec3> {
    let normals = triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a));
    let mut normals: Vec<DVec3> = normals.filter(|normal| normal.length_squared() > 0.0).collect();
    normals.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
    // The largest triangle leads, smaller ones that look nearly the same way lend it their area.
    let mut groups: Vec<(DVec3, f64)> = Vec::new();
    for normal in normals {
        let (direction, area) = (normal.normalize(), normal.length());
        match groups.iter_mut().find(|group| group.0.dot(direction).abs() > ALIKE) {
            Some(group) => group.1 += area,
            None => groups.push((direction, area)),
        }
    }
    groups.sort_by(|a, b| b.1.total_cmp(&a.1));
    let most = groups.first().map_or(0.0, |group| group.1);
    groups.into_iter().filter(|group| group.1 >= LEAST * most).map(|group| group.0).collect()
}

/// So many lines to a row, and so many rows.
const LINES: u32 = 7;

/// Lines along `direction` through a mesh, evenly spread over the box around it across that direction.
pub(super) fn lines(triangles: &[Corners], direction: DVec3) -> Vec<Through> {
    let (across, up) = direction.any_orthonormal_pair();
    // Upright where that may be, so that the lines stand in the rows of the mesh's own sides.
    let across = if direction.z.abs() < 0.99 { direction.cross(DVec3::Z).normalize() } else { across };
    let up = if direction.z.abs() < 0.99 { across.cross(direction) } else { up };
    let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for corner in triangles.iter().flatten() {
        for (bound, axis) in bounds.iter_mut().zip([across, up]) {
            let at = corner.dot(axis);
            *bound = [bound[0].min(at), bound[1].max(at)];
        }
    }
    let place = |[from, to]: [f64; 2], i: u32| from + (to - from) * (f64::from(i) + 0.5) / f64::from(LINES);
    let mut lines = Vec::with_capacity((LINES * LINES) as usize);
    for row in 0..LINES {
        for column in 0..LINES {
            let start = across * place(bounds[0], column) + up * place(bounds[1], row);
            let mut ends: Option<[f64; 2]> = None;
            for t in triangles.iter().filter_map(|triangle| crossing(triangle, start, direction)) {
                let [first, last] = ends.get_or_insert([t, t]);
                *first = first.min(t);
                *last = last.max(t);
            }
            if let Some([first, last]) = ends {
                lines.push(Through { enters: start + direction * first, leaves: start + direction * last });
            }
        }
    }
    lines
}

/// Where the line from `start` along `direction` crosses a triangle.
fn crossing([a, b, c]: &Corners, start: DVec3, direction: DVec3) -> Option<f64> {
    let normal = (*b - *a).cross(*c - *a);
    let slant = normal.dot(direction);
    if slant.abs() <= 1e-9 * normal.length() {
        return None;
    }
    let t = normal.dot(*a - start) / slant;
    let point = start + direction * t;
    let side = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal);
    let sides = [side(*a, *b), side(*b, *c), side(*c, *a)];
    sides.iter().all(|side| *side >= 0.0).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box, each face two triangles.
    fn cuboid(lo: DVec3, hi: DVec3) -> Vec<Corners> {
        let mut triangles = Vec::new();
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for end in [lo, hi] {
                let corner = |at: [bool; 2]| {
                    let mut p = end;
                    p[u] = if at[0] { hi[u] } else { lo[u] };
                    p[v] = if at[1] { hi[v] } else { lo[v] };
                    p
                };
                let [a, b, c, d] = [[false, false], [true, false], [true, true], [false, true]].map(corner);
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        triangles
    }

    #[test]
    fn a_door_shows_its_largest_face_first_and_is_crossed_from_end_to_end() {
        let door = cuboid(DVec3::new(1.0, 2.0, 0.0), DVec3::new(1.9, 2.2, 2.0));
        let directions = directions(&door);
        // Its threshold and lintel are too small to count.
        assert_eq!(directions.len(), 2);
        assert!(directions[0].y.abs() > 0.999, "{directions:?}");
        let lines = lines(&door, DVec3::Y);
        assert_eq!(lines.len(), 49);
        for line in lines {
            assert!((line.enters.y - 2.0).abs() < 1e-12 && (line.leaves.y - 2.2).abs() < 1e-12, "{line:?}");
            assert!(line.enters.x > 1.0 && line.enters.x < 1.9 && line.enters.z > 0.0 && line.enters.z < 2.0);
        }
    }

    #[test]
    fn a_hole_in_a_slab_is_crossed_upward() {
        let hole = cuboid(DVec3::ZERO, DVec3::new(1.0, 3.0, 0.3));
        assert!(directions(&hole)[0].z.abs() > 0.999);
        assert_eq!(lines(&hole, DVec3::Z).len(), 49);
    }
}
