//! Patches as closed meshes.

use std::collections::{BTreeMap, BTreeSet};

use enfilade_importers::{MaterialId, Mesh};

use super::{Fill, Finder, Patch};
use crate::lattice::{FINE, Plane};

/// From where to where a piece of a room is: lattice planes that may lie within matter, which takes its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Reach {
    pub(super) low: Plane,
    pub(super) high: Plane,
}

impl Finder<'_> {
    pub(super) fn reach(&self, storey: usize, triangle: u32) -> Reach {
        let of = &self.storeys.storeys[storey];
        let stack = of.stack(triangle);
        let [low, high] = of.levels.map(Plane::level);
        let at = self.spots[storey][triangle as usize].layer;
        let is_air =
            |i: usize| matches!(self.fills[storey][stack[i].set as usize], Fill::Air | Fill::Opening);
        let below = (0..at).rev().find(|&i| !is_air(i)).is_some_and(|i| (0..i).any(is_air));
        let above = (at..stack.len()).find(|&i| !is_air(i)).is_some_and(|i| (i..stack.len()).any(is_air));
        // The layers of air around it that are one with it.
        let first = (0..=at).rev().take_while(|&i| is_air(i)).last().unwrap_or(at);
        let last = (at..stack.len()).take_while(|&i| is_air(i)).last().unwrap_or(at);
        Reach {
            low: if below { stack[first].floor } else { low },
            high: if above { stack[last].ceiling } else { high },
        }
    }

    /// Triangles between planes as one closed mesh.
    pub(super) fn mesh(&self, patch: &Patch, reach: impl Fn(u32) -> Reach) -> Mesh {
        let storey = &self.storeys.storeys[patch.storey];
        let lattice = &self.storeys.lattice;
        let mut groups: BTreeMap<Reach, BTreeSet<u32>> = BTreeMap::new();
        for &t in &patch.triangles {
            groups.entry(reach(t)).or_default().insert(t);
        }
        let mut mesh = Mesh::default();
        for (reach, triangles) in groups {
            let mut index: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
            let mut corner = |mesh: &mut Mesh, v: u32| {
                *index.entry(v).or_insert_with(|| {
                    [reach.low, reach.high].map(|plane| {
                        let p = storey.points[v as usize];
                        let z = plane.height(p) as f64 / FINE as f64;
                        mesh.positions.push(lattice.metres([f64::from(p.x), f64::from(p.y), z]));
                        mesh.positions.len() as u32 - 1
                    })
                })
            };
            for &t in &triangles {
                let [a, b, c] = storey.triangles[t as usize].map(|v| corner(&mut mesh, v));
                mesh.triangles.push([a[1], b[1], c[1]]);
                mesh.triangles.push([a[0], c[0], b[0]]);
                for i in 0..3 {
                    if !triangles.contains(&storey.across[t as usize][i]) {
                        let [a, b] =
                            [i, (i + 1) % 3].map(|i| corner(&mut mesh, storey.triangles[t as usize][i]));
                        mesh.triangles.extend([[a[0], b[0], b[1]], [a[0], b[1], a[1]]]);
                    }
                }
            }
        }
        mesh.materials = vec![MaterialId(0); mesh.triangles.len()];
        mesh
    }
}

/// Adds a mesh to another.
pub(super) fn append(mesh: &mut Mesh, other: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles.extend(other.triangles.into_iter().map(|t| t.map(|v| v + first)));
    mesh.materials.extend(other.materials);
}
