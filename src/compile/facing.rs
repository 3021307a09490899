//! Closed surfaces that hide their own backs.
//!
//! From outside of a closed surface that does not cross itself, its front is met before its back; a picture may leave the back out. That is told here of
//! components of meshes, furniture as well as walls, and is noted with their triangles.
//!
//! Each shell of a component ([`joined`](super::joined)) is judged by itself, whatever the others do: lines wind around it once within, and not without, so
//! that from outside of all of them nothing but fronts is met first. Where triangles do not agree about the outside, they are turned to agree with their neighbours, for this
//! alone.

use enfilade_importers::Mesh;
use glam::DVec3;

use super::crossing::crosses_itself;
use super::joined::shells;
use crate::components::Component;
use crate::format::records::Facing;
use crate::shells::{Edges, Patches};
use crate::trace::crossings;

/// So many times a triangle is looked at to tell what lies on either side of the patches of a shell.
const MOST_LOOKS: usize = 1 << 20;

/// To which side each triangle of a component looks, in the component's order, if from outside of its shell one side hides the other.
pub(super) fn facing(mesh: &Mesh, component: &Component) -> Vec<Facing> {
    let count = component.triangles.len();
    let edges = Edges::of(mesh, &component.triangles);
    let patches = edges.patches(count);
    let corners: Vec<[DVec3; 3]> = (0..count)
        .map(|t| {
            let [a, b, c] = corners(mesh, component.triangles[t]);
            if patches.turned[t] { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    let mut facing = vec![Facing::Any; count];
    for shell in shells(mesh, component, &edges, &patches) {
        let side = match &shell.patches[..] {
            _ if !shell.is_closed => Facing::Any,
            [patch] if shell.is_plain => by_volume(&corners, &patches.members[*patch]),
            several => by_winding(&corners, &patches, several),
        };
        if side == Facing::Any || crosses_itself(mesh, component, &corners, &shell.triangles(&patches)) {
            continue;
        }
        for t in shell.triangles(&patches) {
            facing[t as usize] = if patches.turned[t as usize] { side.turned() } else { side };
        }
    }
    facing
}

/// Of a closed surface of one patch.
fn by_volume(corners: &[[DVec3; 3]], patch: &[u32]) -> Facing {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in patch.iter().flat_map(|&t| corners[t as usize]) {
        (lo, hi) = (lo.min(corner), hi.max(corner));
    }
    // Its middle as origin: volumes are small, and coordinates may be large.
    let origin = (lo + hi) / 2.0;
    let six = |&t: &u32| {
        let [a, b, c] = corners[t as usize].map(|corner| corner - origin);
        a.dot(b.cross(c))
    };
    let volume: f64 = patch.iter().map(six).sum();
    // What rounding may make of the volume of nothing.
    let nothing = 1e-12 * (hi - lo).element_product().abs() + f64::MIN_POSITIVE;
    if volume > nothing {
        Facing::Outward
    } else if volume < -nothing {
        Facing::Inward
    } else {
        Facing::Any
    }
}

/// Of a closed surface of several patches: if lines wind once around what is behind each of them, and not around what is before it.
fn by_winding(corners: &[[DVec3; 3]], patches: &Patches, several: &[usize]) -> Facing {
    let all: Vec<[DVec3; 3]> = several
        .iter()
        .flat_map(|&patch| patches.members[patch].iter().map(|&t| corners[t as usize]))
        .collect();
    if several.len() * all.len() > MOST_LOOKS {
        return Facing::Any;
    }
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &corner in all.iter().flatten() {
        (lo, hi) = (lo.min(corner), hi.max(corner));
    }
    // Far enough that rounding does not matter, near enough that thin parts are not stepped through.
    let step = ((hi - lo).length() * 1e-7).max(1e-6);
    let around = |point: DVec3| {
        let all = all.iter().map(|corners| corners.map(|corner| corner.to_array()));
        crossings(all, point.to_array()).winding
    };
    let sides = |&patch: &usize| {
        let normal = |t: u32| {
            let [a, b, c] = corners[t as usize];
            (b - a).cross(c - a)
        };
        // The first of equals.
        let largest = patches.members[patch]
            .iter()
            .copied()
            .reduce(|a, b| if normal(b).length_squared() > normal(a).length_squared() { b } else { a })?;
        let [a, b, c] = corners[largest as usize];
        let (middle, out) = ((a + b + c) / 3.0, normal(largest).normalize_or_zero() * step);
        Some([middle + out, middle - out].map(around))
    };
    let sides: Vec<_> = several.iter().map(sides).collect();
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

    /// Of each component, whose triangles all face alike.
    fn of(mesh: &Mesh) -> Vec<Facing> {
        let alike = |facing: Vec<Facing>| {
            assert!(facing.iter().all(|other| *other == facing[0]), "{facing:?}");
            facing[0]
        };
        components(mesh).iter().map(|component| alike(facing(mesh, component))).collect()
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
        // One of them is inside out: each is a surface by itself.
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1.0, 1.0, 0.0], [3.0, 3.0, 1.0], true);
        weld(&mut mesh);
        let components = components(&mesh);
        let expected: Vec<Facing> =
            [Facing::Outward, Facing::Inward].into_iter().flat_map(|facing| [facing; 12]).collect();
        assert_eq!(facing(&mesh, &components[0]), expected);
    }

    /// Boxes that share a whole face, twice there: all four triangles at its edges are of two boxes.
    #[test]
    fn boxes_that_share_a_face_face_outward_together() {
        for is_inward in [false, true] {
            let mut mesh = empty();
            cuboid(&mut mesh, [0.0; 3], [1.0; 3], is_inward);
            cuboid(&mut mesh, [1.0, 0.0, 0.0], [3.0, 1.0, 1.0], is_inward);
            cuboid(&mut mesh, [1.0, 1.0, 0.0], [3.0, 2.0, 1.0], is_inward);
            weld(&mut mesh);
            let expected = if is_inward { Facing::Inward } else { Facing::Outward };
            assert_eq!(of(&mesh), [expected]);
        }
    }

    #[test]
    fn triangles_that_do_not_agree_face_as_their_neighbours_say() {
        for is_inward in [false, true] {
            for turned in [1, 0b1010_0110_1001, 0xfff] {
                let mut mesh = empty();
                cuboid(&mut mesh, [0.0; 3], [1.0, 2.0, 3.0], is_inward);
                let is_turned = |t: usize| turned >> t & 1 != 0;
                (0..12).filter(|&t| is_turned(t)).for_each(|t| mesh.triangles[t].swap(0, 1));
                let expected: Vec<Facing> = (0..12)
                    .map(|t| if is_turned(t) != is_inward { Facing::Inward } else { Facing::Outward })
                    .collect();
                assert_eq!(facing(&mesh, &components(&mesh)[0]), expected);
            }
        }
    }

    #[test]
    fn closed_parts_of_what_is_open_face_outward() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1.0; 3], [2.0; 3], false);
        mesh.triangles.pop();
        mesh.materials.pop();
        weld(&mut mesh);
        let components = components(&mesh);
        assert!(components.len() == 1 && !components[0].closed);
        let facing = facing(&mesh, &components[0]);
        assert!(facing[..12].iter().all(|facing| *facing == Facing::Outward));
        assert!(facing[12..].iter().all(|facing| *facing == Facing::Any));
    }

    /// Bars that reach into each other, with a corner in common: each hides its own back.
    #[test]
    fn what_crosses_others_faces_outward() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [3.0, 1.0, 1.0], false);
        cuboid(&mut mesh, [0.0; 3], [1.0, 0.5, 3.0], false);
        weld(&mut mesh);
        assert_eq!(of(&mesh), [Facing::Outward]);
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
