//! Whether a surface crosses itself.

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::Component;

/// A surface that crosses itself by less than this, metres, does not count as crossing.
const DEEP: f64 = 1e-7;

/// So many pairs of triangles whose boxes meet are looked at, for each triangle of a shell; of a shell with more nothing is said.
const MOST_PAIRS: usize = 256;

/// Whether any two of some triangles of a component, given by their positions in it and with the corners of all, cross; also where that is not worth looking for.
pub(super) fn crosses_itself(mesh: &Mesh, component: &Component, corners: &[[DVec3; 3]], of: &[u32]) -> bool {
    let boxes: Vec<[DVec3; 2]> = of
        .iter()
        .map(|&t| {
            let [a, b, c] = corners[t as usize];
            [a.min(b).min(c), a.max(b).max(c)]
        })
        .collect();
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [lo, hi] = boxes.iter().fold(start, |[lo, hi], other| [lo.min(other[0]), hi.max(other[1])]);
    // Along the longest axis.
    let axis = (hi - lo).max_position();
    let mut order: Vec<u32> = (0..of.len() as u32).collect();
    order.sort_by(|&a, &b| boxes[a as usize][0][axis].total_cmp(&boxes[b as usize][0][axis]).then(a.cmp(&b)));
    let (mut pairs, most) = (0, MOST_PAIRS * of.len());
    for (i, &a) in order.iter().enumerate() {
        let [lo, hi] = boxes[a as usize];
        for &b in &order[i + 1..] {
            let other = boxes[b as usize];
            if other[0][axis] > hi[axis] {
                break;
            }
            pairs += 1;
            if pairs > most {
                return true;
            }
            if other[0].cmpgt(hi).any() || other[1].cmplt(lo).any() {
                continue;
            }
            let [a, b] = [a, b].map(|t| of[t as usize] as usize);
            let [s, t] = [a, b].map(|t| mesh.triangles[component.triangles[t] as usize]);
            let (p, q) = (&corners[a], &corners[b]);
            if is_crossed((s, p), (t, q)) || is_crossed((t, q), (s, p)) {
                return true;
            }
        }
    }
    false
}

/// Whether an edge of one triangle goes through the other, given by their vertices and corners.
fn is_crossed((through, [a, b, c]): ([u32; 3], &[DVec3; 3]), (by, ends): ([u32; 3], &[DVec3; 3])) -> bool {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    if normal == DVec3::ZERO {
        return false;
    }
    let away = ends.map(|end| normal.dot(end - a));
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        let goes_through = away[i] > DEEP && away[j] < -DEEP || away[i] < -DEEP && away[j] > DEEP;
        if !goes_through || through.contains(&by[i]) || through.contains(&by[j]) {
            return false;
        }
        let at = ends[i] + (ends[j] - ends[i]) * (away[i] / (away[i] - away[j]));
        [[a, b], [b, c], [c, a]].iter().all(|[from, to]| {
            let inward = normal.cross(*to - *from).normalize_or_zero();
            inward.dot(at - *from) > -DEEP
        })
    })
}
