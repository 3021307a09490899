//! How often something was moved to make the partition, and how far at most.

use super::bodies::Bodies;
use super::faces::{Lie, Triangle};
use crate::lattice::{FINE, Lattice};

/// What one kind of repair did.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Repair {
    /// What was done.
    pub what: &'static str,
    /// How often.
    pub count: u64,
    /// The farthest that anything was moved by it, metres.
    pub largest_displacement: f64,
}

/// Moves that are counted, in lattice units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moved {
    pub(super) count: u64,
    pub(super) farthest: f64,
}

impl Moved {
    pub(super) fn add(&mut self, distance: f64) {
        self.count += 1;
        self.farthest = self.farthest.max(distance);
    }

    pub(super) fn join(&mut self, other: Moved) {
        self.count += other.count;
        self.farthest = self.farthest.max(other.farthest);
    }

    pub(super) fn repair(self, what: &'static str, lattice: &Lattice) -> Repair {
        Repair { what, count: self.count, largest_displacement: self.farthest * lattice.step() }
    }
}

/// What rounding to the lattice and common planes did to the bodies' triangles.
pub(super) fn of_faces(bodies: &Bodies, triangles: &[Triangle]) -> Vec<Repair> {
    let (mut rounded, mut planes, mut sheets) = (Moved::default(), Moved::default(), Moved::default());
    for body in &bodies.bodies {
        for (vertex, exact) in body.vertices.iter().zip(&body.exact) {
            let off = [f64::from(vertex.at.x) - exact[0], f64::from(vertex.at.y) - exact[1]];
            if off != [0.0; 2] {
                rounded.add(off[0].hypot(off[1]));
            }
        }
    }
    let own = bodies.bodies.iter().flat_map(|body| body.triangles.iter().map(move |t| (body, t)));
    for (triangle, (body, t)) in triangles.iter().zip(own) {
        match triangle.lie {
            Lie::Flat(plane) => {
                let off = t.corners.iter().map(|&v| {
                    let height = plane.height(body.vertices[v as usize].at) as f64 / FINE as f64;
                    (height - body.exact[v as usize][2]).abs()
                });
                let off = off.fold(0.0, f64::max);
                // Half a step is what rounding to the lattice does by itself.
                if off > 0.5 {
                    planes.add(off);
                }
            }
            Lie::Sheet => sheets.add(f64::from(triangle.run)),
            Lie::Vertical => {}
        }
    }
    let lattice = &bodies.lattice;
    vec![
        Repair {
            what: "elements whose open meshes were closed for the cells, by welding and splitting of edges",
            count: bodies.mended,
            largest_displacement: 0.0,
        },
        rounded.repair("points rounded to the lattice in the plan", lattice),
        planes.repair("triangles moved in height to the lattice, a level or a common plane", lattice),
        sheets.repair("triangles so steep that they were made upright", lattice),
    ]
}
