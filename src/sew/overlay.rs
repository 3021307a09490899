//! What two convex footprints have in common, exactly.

use crate::lattice::{Point, Site};

/// A corner of a common part, and the line, through two lattice points, of the edge from it to the next corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) at: Site,
    pub(super) line: [Point; 2],
}

/// The common part of two convex polygons, counter-clockwise; empty where they have no area in common. Corners of the first on
/// straight edges stay; those of the second do not come in.
pub(super) fn common(one: &[Point], other: &[Point]) -> Vec<Corner> {
    let next = |polygon: &[Point], i: usize| polygon[(i + 1) % polygon.len()];
    let mut part: Vec<Corner> =
        (0..one.len()).map(|i| Corner { at: one[i].into(), line: [one[i], next(one, i)] }).collect();
    for i in 0..other.len() {
        part = left_of(&part, [other[i], next(other, i)]);
    }
    if has_area(&part) { part } else { Vec::new() }
}

/// The part of a convex polygon on the left of a line.
fn left_of(part: &[Corner], line: [Point; 2]) -> Vec<Corner> {
    let side: Vec<i128> = part.iter().map(|corner| corner.at.side(line).signum()).collect();
    if side.iter().all(|&side| side >= 0) {
        return part.to_vec();
    }
    let mut kept = Vec::with_capacity(part.len() + 1);
    for (i, corner) in part.iter().enumerate() {
        let (here, there) = (side[i], side[(i + 1) % part.len()]);
        match (here, there) {
            (1, -1) => {
                kept.push(*corner);
                kept.extend(Site::crossing(corner.line, line).map(|at| Corner { at, line }));
            }
            // On the line, and the rest of the edge beyond it.
            (0, -1) => kept.push(Corner { at: corner.at, line }),
            (-1, 1) => {
                kept.extend(Site::crossing(corner.line, line).map(|at| Corner { at, line: corner.line }));
            }
            (-1, _) => {}
            _ => kept.push(*corner),
        }
    }
    kept
}

fn has_area(part: &[Corner]) -> bool {
    part.len() > 2 && part.iter().any(|corner| corner.at.side(part[0].line) != 0)
}
