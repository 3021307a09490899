//! Closed surfaces that hide their own backs.
//!
//! From outside of a closed surface that does not cross itself, its front is met before its back; a picture may leave the back out. That is told here of
//! components of meshes, furniture as well as walls, and is noted with their triangles.

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::{Component, Orientation};
use crate::format::records::Facing;
use crate::shells::Edges;
use crate::trace::crossings;

/// A surface that crosses itself by less than this, metres, does not count as crossing.
const DEEP: f64 = 1e-7;

/// So many pairs of triangles whose boxes meet are looked at, for each triangle of a component; of a component with more nothing is said.
const MOST_PAIRS: usize = 256;

/// So many times a triangle is looked at to tell what lies on either side of the patches of a component.
const MOST_LOOKS: usize = 1 << 20;

/// To which side the triangles of a component look, if from outside one side hides the other.
pub(super) fn facing(mesh: &Mesh, component: &Component) -> Facing {
    if !component.closed || component.orientation != Orientation::Consistent {
        return Facing::Any;
    }
    let corners: Vec<[DVec3; 3]> = component.triangles.iter().map(|&t| corners(mesh, t)).collect();
    let edges = Edges::of(mesh, &component.triangles);
    let patches = edges.patches(corners.len()).members;
    let facing = if edges.are_of_two() {
        by_volume(component, &corners, &patches)
    } else if patches.len() * corners.len() <= MOST_LOOKS {
        by_winding(component, &corners, &patches)
    } else {
        Facing::Any
    };
    if facing == Facing::Any || crosses_itself(mesh, component, &corners) { Facing::Any } else { facing }
}

/// Of closed surfaces that do not touch each other.
fn by_volume(component: &Component, corners: &[[DVec3; 3]], patches: &[Vec<u32>]) -> Facing {
    // The middle of the component as origin: volumes are small, and coordinates may be large.
    let [lo, hi] = component.bounds.map(DVec3::from);
    let origin = (lo + hi) / 2.0;
    let volume = |patch: &Vec<u32>| -> f64 {
        let six = |&t: &u32| {
            let [a, b, c] = corners[t as usize].map(|corner| corner - origin);
            a.dot(b.cross(c))
        };
        patch.iter().map(six).sum()
    };
    // What rounding may make of the volume of nothing.
    let nothing = 1e-12 * (hi - lo).element_product().abs() + f64::MIN_POSITIVE;
    let volumes: Vec<f64> = patches.iter().map(volume).collect();
    if volumes.iter().all(|&volume| volume > nothing) {
        Facing::Outward
    } else if volumes.iter().all(|&volume| volume < -nothing) {
        Facing::Inward
    } else {
        Facing::Any
    }
}

/// Of surfaces with edges of four and more triangles: if behind all of them lines wind once around what is on one side, and not around the other.
fn by_winding(component: &Component, corners: &[[DVec3; 3]], patches: &[Vec<u32>]) -> Facing {
    let [lo, hi] = component.bounds.map(DVec3::from);
    // Far enough that rounding does not matter, near enough that thin parts are not stepped through.
    let step = ((hi - lo).length() * 1e-7).max(1e-6);
    let all = || corners.iter().map(|corners| corners.map(|corner| corner.to_array()));
    let sides = |patch: &Vec<u32>| {
        let normal = |t: u32| {
            let [a, b, c] = corners[t as usize];
            (b - a).cross(c - a)
        };
        // The first of equals.
        let largest = patch
            .iter()
            .copied()
            .reduce(|a, b| if normal(b).length_squared() > normal(a).length_squared() { b } else { a })?;
        let [a, b, c] = corners[largest as usize];
        let (middle, out) = ((a + b + c) / 3.0, normal(largest).normalize_or_zero() * step);
        Some([middle + out, middle - out].map(|point| crossings(all(), point.to_array()).winding))
    };
    let sides: Vec<_> = patches.iter().map(sides).collect();
    let are = |front: i32, back: i32| sides.iter().all(|sides| *sides == Some([front, back]));
    if are(0, 1) {
        Facing::Outward
    } else if are(-1, 0) {
        Facing::Inward
    } else {
        Facing::Any
    }
}

fn corners(mesh: &Mesh, triangle: u32) -> [DVec3; 3] {
    mesh.triangles[triangle as usize].map(|v| DVec3::from(mesh.positions[v as usize]))
}

/// Whether any two triangles cross; also where that is not worth looking for.
fn crosses_itself(mesh: &Mesh, component: &Component, corners: &[[DVec3; 3]]) -> bool {
    let boxes: Vec<[DVec3; 2]> =
        corners.iter().map(|&[a, b, c]| [a.min(b).min(c), a.max(b).max(c)]).collect();
    // Along the longest axis.
    let [lo, hi] = component.bounds.map(DVec3::from);
    let axis = (hi - lo).max_position();
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.sort_by(|&a, &b| boxes[a as usize][0][axis].total_cmp(&boxes[b as usize][0][axis]).then(a.cmp(&b)));
    let (mut pairs, most) = (0, MOST_PAIRS * corners.len());
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
            let [s, t] = [a, b].map(|t| mesh.triangles[component.triangles[t as usize] as usize]);
            let (p, q) = (&corners[a as usize], &corners[b as usize]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;
    use enfilade_importers::MaterialId;

    /// A box from one corner to another.
    fn cuboid(mesh: &mut Mesh, lo: [f64; 3], hi: [f64; 3], is_inward: bool) {
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let first = mesh.positions.len() as u32;
        for i in 0..8usize {
            mesh.positions.push([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] }));
        }
        for [a, b, c, d] in quads {
            for mut corners in [[a, b, c], [a, c, d]] {
                if is_inward {
                    corners.swap(1, 2);
                }
                mesh.triangles.push(corners.map(|corner| corner + first));
                mesh.materials.push(MaterialId(0));
            }
        }
    }

    /// Makes one vertex of those in the same place.
    fn weld(mesh: &mut Mesh) {
        let first = |p: &[f64; 3]| mesh.positions.iter().position(|q| q == p).unwrap() as u32;
        let same: Vec<u32> = mesh.positions.iter().map(first).collect();
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = same[*v as usize]);
    }

    fn of(mesh: &Mesh) -> Vec<Facing> {
        components(mesh).iter().map(|component| facing(mesh, component)).collect()
    }

    fn empty() -> Mesh {
        Mesh { positions: Vec::new(), triangles: Vec::new(), materials: Vec::new() }
    }

    #[test]
    fn boxes_face_outward_or_inward_and_open_ones_any_side() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1e6; 3], [1e6 + 1e-3; 3], true);
        assert_eq!(of(&mesh), [Facing::Outward, Facing::Inward]);
        mesh.triangles.remove(0);
        mesh.materials.remove(0);
        assert_eq!(of(&mesh), [Facing::Any, Facing::Inward]);
        mesh.triangles[0].swap(0, 1);
        assert_eq!(of(&mesh)[0], Facing::Any);
    }

    #[test]
    fn boxes_that_share_an_edge_face_outward_together() {
        for is_inward in [false, true] {
            let mut mesh = empty();
            cuboid(&mut mesh, [0.0; 3], [1.0; 3], is_inward);
            cuboid(&mut mesh, [1.0, 1.0, 0.0], [2.0, 2.0, 1.0], is_inward);
            weld(&mut mesh);
            let expected = if is_inward { Facing::Inward } else { Facing::Outward };
            assert_eq!(of(&mesh), [expected]);
        }
        // One of them is inside out.
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1.0, 1.0, 0.0], [3.0, 3.0, 1.0], true);
        weld(&mut mesh);
        assert_eq!(of(&mesh), [Facing::Any]);
    }

    #[test]
    fn what_crosses_itself_faces_any_side() {
        // A prism over a polygon that winds once around two corners and crosses itself: one end is inside out.
        let corners = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]];
        let mut mesh = empty();
        for z in [0.0, 1.0] {
            mesh.positions.extend(corners.map(|[x, y]| [x, y, z]));
        }
        let mut push = |corners: [u32; 3]| {
            mesh.triangles.push(corners);
            mesh.materials.push(MaterialId(0));
        };
        for i in 0..4u32 {
            let j = (i + 1) % 4;
            push([i, j, j + 4]);
            push([i, j + 4, i + 4]);
        }
        for (a, b, c) in [(0, 1, 2), (0, 2, 3)] {
            push([a, c, b]);
            push([a + 4, b + 4, c + 4]);
        }
        assert!(components(&mesh)[0].closed);
        assert_eq!(of(&mesh), [Facing::Any]);
    }
}
