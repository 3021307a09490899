//! Turning the triangles of closed components that disagree about the outside.
//!
//! Real exports hold closed meshes whose triangles are wound both ways. Across an edge of exactly two triangles the one
//! tells the other; patches between edges of four and more are turned one by one, by what lies on either side of one of
//! their triangles. Components that agree are left as they are: one that looks inward may be a cavity of another.

use std::collections::BTreeMap;

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::{Component, Orientation};
use crate::trace::crossings;

/// What was found out about a closed component.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outward {
    /// Its triangles, turned where they disagreed, as corners in the mesh's positions, in the order of the component.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// How many were turned.
    pub(crate) turned: u64,
    /// Whether the winding number decides about inside and outside (else the parity of crossings does).
    pub(crate) by_winding: bool,
    /// Volume, m3: negative if the triangles look inward.
    pub(crate) volume: f64,
}

/// Components with more patches than this are not turned: every patch costs a look at all triangles.
const MOST_PATCHES: usize = 512;

/// The triangles of a closed component, made to agree as far as that can be told.
pub(crate) fn turn_outward(mesh: &Mesh, component: &Component) -> Outward {
    let mut triangles: Vec<[u32; 3]> =
        component.triangles.iter().map(|&t| mesh.triangles[t as usize]).collect();
    let mut turned = 0;
    let mut by_winding = true;
    if component.orientation == Orientation::Mixed {
        let flips = flips(mesh, &triangles, component);
        for (triangle, flip) in triangles.iter_mut().zip(&flips) {
            if *flip {
                triangle.swap(1, 2);
                turned += 1;
            }
        }
        by_winding = balanced(&triangles);
    }
    let volume = volume(mesh, &triangles, component.bounds[0]);
    Outward { triangles, turned, by_winding, volume }
}

/// Which triangles to turn.
fn flips(mesh: &Mesh, triangles: &[[u32; 3]], component: &Component) -> Vec<bool> {
    let mut edges: BTreeMap<(u32, u32), Vec<(u32, bool)>> = BTreeMap::new();
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.entry((from.min(to), from.max(to))).or_default().push((t as u32, from < to));
        }
    }
    let mut flip = vec![None; triangles.len()];
    let mut patches: Vec<Vec<u32>> = Vec::new();
    for seed in 0..triangles.len() {
        if flip[seed].is_some() {
            continue;
        }
        flip[seed] = Some(false);
        let mut patch = vec![seed as u32];
        let mut next = 0;
        while next < patch.len() {
            let t = patch[next];
            next += 1;
            let [a, b, c] = triangles[t as usize];
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let [one, two] = edges[&(from.min(to), from.max(to))][..] else { continue };
                let other = if one.0 == t { two.0 } else { one.0 };
                if flip[other as usize].is_none() {
                    // Neighbours agree if they run along their edge in opposite directions.
                    let same_direction = one.1 == two.1;
                    flip[other as usize] = Some(flip[t as usize].unwrap_or(false) != same_direction);
                    patch.push(other);
                }
            }
        }
        patches.push(patch);
    }
    let mut flip: Vec<bool> = flip.into_iter().map(|f| f.unwrap_or(false)).collect();
    if patches.len() <= MOST_PATCHES {
        for patch in &patches {
            if faces_inward(mesh, triangles, patch, &flip, component) {
                patch.iter().for_each(|&t| flip[t as usize] ^= true);
            }
        }
    }
    flip
}

/// Whether the patch's triangles, flipped so far as `flip` says, look into the component: by the parity of crossings
/// on both sides of its largest triangle.
fn faces_inward(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    patch: &[u32],
    flip: &[bool],
    component: &Component,
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
    let size = (DVec3::from(component.bounds[1]) - DVec3::from(component.bounds[0])).length();
    let out = normal(largest).normalize_or_zero() * if flip[largest as usize] { -1.0 } else { 1.0 };
    let is_inside = |p: DVec3| {
        let all = triangles.iter().map(|t| t.map(|v| mesh.positions[v as usize]));
        crossings(all, p.to_array()).count % 2 == 1
    };
    // Far enough that rounding does not matter, near enough that thin parts are not stepped through.
    let step = (size * 1e-7).max(1e-6);
    is_inside(middle + out * step) && !is_inside(middle - out * step)
}

/// Whether every edge is used as often in one direction as in the other.
fn balanced(triangles: &[[u32; 3]]) -> bool {
    let mut sums: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *sums.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    sums.values().all(|&sum| sum == 0)
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
            let outward = turn_outward(&mesh, component);
            assert!(outward.by_winding);
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
