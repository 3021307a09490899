//! Turning the triangles of shells that disagree about the outside.
//!
//! Real exports hold closed meshes whose triangles are wound both ways. [`crate::shells`] tells which agree after turning;
//! here the patches are turned outward: a whole shell by its volume, one of several patches, between edges of four and
//! more triangles, by what lies on either side of one of its triangles. Shells that agree are left as they are: one that
//! looks inward may be a cavity of another.

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::shells::{Inside, Shell};
use crate::trace::crossings;

/// A shell, turned outward.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outward {
    /// Its triangles, turned where they disagreed, as corners in the mesh's positions, in the order of the shell.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many were turned.
    pub(crate) turned: u64,
    /// Volume, m3: negative if the triangles look inward.
    pub(crate) volume: f64,
}

/// Shells with more patches than this are not turned: every patch costs a look at all triangles.
const MOST_PATCHES: usize = 512;

/// The triangles of a shell, made to look outward as far as that can be told.
pub(crate) fn turn_outward(mesh: &Mesh, shell: &Shell, bounds: [[f64; 3]; 2]) -> Outward {
    let mut flip = shell.turned.clone();
    match shell.inside {
        Inside::Together => {}
        Inside::ByWinding => {
            let triangles: Vec<[u32; 3]> = shell.corners(mesh).collect();
            if volume(mesh, &triangles, bounds[0]) < 0.0 {
                flip.iter_mut().for_each(|flip| *flip = !*flip);
            }
        }
        Inside::ByParity if shell.patches.len() <= MOST_PATCHES => {
            let given: Vec<[u32; 3]> = shell.triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
            for patch in &shell.patches {
                if faces_inward(mesh, &given, patch, &flip, bounds) {
                    patch.iter().for_each(|&t| flip[t as usize] ^= true);
                }
            }
        }
        Inside::ByParity => {}
    }
    let turned = flip.iter().filter(|&&flip| flip).count() as u64;
    let shell = Shell { turned: flip, ..shell.clone() };
    let triangles: Vec<[u32; 3]> = shell.corners(mesh).collect();
    let volume = volume(mesh, &triangles, bounds[0]);
    Outward { triangles, turned, volume }
}

/// Whether the patch's triangles, flipped so far as `flip` says, look inward: by the parity of crossings
/// on both sides of its largest triangle.
fn faces_inward(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    patch: &[u32],
    flip: &[bool],
    bounds: [[f64; 3]; 2],
) -> bool {
    let corners = |t: u32| triangles[t as usize].map(|v| DVec3::from(mesh.positions[v as usize]));
    let normal = |t: u32| {
        let [a, b, c] = corners(t);
        (b - a).cross(c - a)
    };
    // Not `max_by` on floats: the first of equals, so that the outcome is the same everywhere.
    let mut largest = patch[0];
    for &t in patch {
        if normal(t).length_squared() > normal(largest).length_squared() {
            largest = t;
        }
    }
    let [a, b, c] = corners(largest);
    let middle = (a + b + c) / 3.0;
    let size = (DVec3::from(bounds[1]) - DVec3::from(bounds[0])).length();
    let out = normal(largest).normalize_or_zero() * if flip[largest as usize] { -1.0 } else { 1.0 };
    let is_inside = |p: DVec3| {
        let all = triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize]));
        crossings(all, p.to_array()).count % 2 == 1
    };
    // Far enough that rounding does not matter, near enough that thin parts are not stepped through.
    let step = (size * 1e-7).max(1e-6);
    is_inside(middle + out * step) && !is_inside(middle - out * step)
}

fn volume(mesh: &Mesh, triangles: &[[u32; 3]], origin: [f64; 3]) -> f64 {
    let origin = DVec3::from(origin);
    let six: f64 = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| DVec3::from(mesh.positions[v as usize]) - origin);
            a.dot(b.cross(c))
        })
        .sum();
    six / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;
    use crate::shells::shells;
    use enfilade_importers::MaterialId;

    fn cube() -> Mesh {
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Mesh {
            positions: (0..8).map(|i| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)]).collect(),
            triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
            materials: vec![MaterialId(0); 12],
        }
    }

    #[test]
    fn any_mixture_of_sides_is_turned_outward() {
        let right = cube();
        for mixture in 0..1u32 << 12 {
            let mut mesh = right.clone();
            for t in 0..12 {
                if mixture >> t & 1 == 1 {
                    mesh.triangles[t].swap(1, 2);
                }
            }
            let component = &components(&mesh)[0];
            let shells = shells(&mesh, component);
            assert_eq!(shells.len(), 1);
            let outward = turn_outward(&mesh, &shells[0], component.bounds);
            if mixture == (1 << 12) - 1 {
                // All inward: they agree.
                assert_eq!((outward.turned, outward.volume), (0, -1.0));
                continue;
            }
            assert_eq!(outward.volume, 1.0);
            assert_eq!(outward.turned, u64::from(mixture.count_ones()));
            assert!(outward.triangles.iter().zip(&right.triangles).all(|(a, b)| a == b), "{mixture:b}");
        }
    }
}
