//! From the cells of a partition to a generalized map.
//!
//! `docs/TOPOLOGY.md` tells the method. In short: what two cells have in common, a part of a floor and a ceiling or of two
//! sides, is one face, a convex polygon whose corners are known exactly (`faces`, `upright`); an edge ends at every vertex that
//! lies on it (`split`); then each face becomes darts on both its sides, and edges of a cell that are equal are linked.

mod faces;
mod heights;
mod overlay;
mod split;
#[cfg(test)]
mod tests;
mod upright;
mod vertices;
mod volumes;

use std::collections::HashSet;

use glam::DVec3;

use crate::gmap::{Dart, GMap};
use crate::lattice::{Point, Site};
use crate::partition::cells::{NONE, Partition};
use faces::Polygon;
use heights::Heights;
use vertices::Vertices;

pub use volumes::{VolumeMap, VolumesError, sew_volumes};

/// A face of the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sewn {
    /// The cell on its first side: below, or the one with the lower number.
    pub one: u32,
    /// The cell on its other side; [`NONE`] for the hull's outside.
    pub other: u32,
    /// A dart of it on the first side: at its first corner, on its first edge.
    pub dart: Dart,
    /// How it lies.
    pub way: Way,
    /// Between air and matter: index of the triangles that make the surface there, in [`Partition::sources`], as found from its
    /// first side and from the other; else [`NONE`].
    pub sources: [u32; 2],
}

/// How a face lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// In the plane of this number: the first cell's ceiling, the other's floor.
    Ceiling(u32),
    /// In the plane of this number: the first cell's floor, on the ground of the hull.
    Floor(u32),
    /// Upright over an edge of the plan, with the first cell on its left: over the border of the two cells, of which the face
    /// may have a part.
    Upright([Point; 2]),
}

/// What a face is of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Part {
    /// Of its floor.
    Floor,
    /// Of its sides.
    Side,
    /// Of its ceiling.
    Ceiling,
}

impl Way {
    /// What the face is of the cell on its first side, or on its other.
    pub fn part(self, is_first: bool) -> Part {
        match self {
            Way::Upright(_) => Part::Side,
            Way::Ceiling(_) if is_first => Part::Ceiling,
            Way::Ceiling(_) | Way::Floor(_) => Part::Floor,
        }
    }
}

/// The map of a partition.
#[derive(Clone, Debug, PartialEq)]
pub struct Topology {
    /// The map. Every cell of the partition is a volume.
    pub map: GMap,
    /// Its faces, in the order of their darts.
    pub faces: Vec<Sewn>,
    /// By dart: the number of its vertex.
    pub vertex_of: Vec<u32>,
    /// By dart: the cell.
    pub cell_of: Vec<u32>,
    /// Where the vertices are, lattice units.
    pub points: Vec<[f64; 3]>,
    /// Heights that were made one, because rounding has a ceiling below its floor: how many, and the largest difference,
    /// lattice units.
    pub joined: (u64, f64),
}

/// What does not fit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TopologyError {
    /// The partition is none of the model.
    #[error("{0}")]
    Partition(String),
    /// An edge of a cell does not have two faces.
    #[error("cell {cell}: the edge from {from:?} to {to:?} (lattice units) has {faces} faces")]
    Edge {
        /// The cell.
        cell: u32,
        /// One end.
        from: [f64; 3],
        /// The other.
        to: [f64; 3],
        /// Of how many faces it is an edge.
        faces: usize,
    },
    /// A cell has no face.
    #[error("cell {cell} has no face")]
    NoFace {
        /// The cell.
        cell: u32,
    },
}

/// Builds the map of a partition.
///
/// # Errors
/// [`TopologyError`]: the cells' surfaces are not closed.
///
/// # Panics
/// If an index in the partition is out of range: none is in what [`partition`](crate::partition::partition) makes, and
/// [`Partition::check`] tells of others.
pub fn sew(partition: &Partition) -> Result<Topology, TopologyError> {
    let (levels, borders) = (faces::levels(partition), faces::borders(partition));
    let mut seen = HashSet::new();
    let corners = levels.iter().flat_map(|level| &level.corners).map(|corner| corner.at);
    let crossings = borders.iter().flat_map(|border| upright::crossings(partition, border));
    let sites: Vec<Site> = corners.chain(crossings).filter(|site| seen.insert(*site)).collect();
    let heights = Heights::of(partition, sites);
    let mut vertices = Vertices::new(partition, &heights);
    let mut faces: Vec<Polygon> = Vec::new();
    for border in &borders {
        upright::upright(partition, border, &heights, &mut vertices, &mut faces);
    }
    faces.extend(levels.iter().filter_map(|level| level.polygon(&mut vertices)));
    split::split(&mut faces, &vertices);
    build(partition, faces, vertices, &heights)
}

fn build(
    partition: &Partition,
    faces: Vec<Polygon>,
    vertices: Vertices<'_>,
    heights: &Heights,
) -> Result<Topology, TopologyError> {
    let count: usize = faces.iter().map(|f| f.corners.len() * if f.other == NONE { 2 } else { 4 }).sum();
    let mut topology = Topology {
        map: GMap::with_capacity(count),
        faces: Vec::with_capacity(faces.len()),
        vertex_of: Vec::with_capacity(count),
        cell_of: Vec::with_capacity(count),
        points: vertices.points(),
        joined: heights.joined(),
    };
    // By cell: the darts at the starts of its faces' edges.
    let mut edges: Vec<Vec<Edge>> = vec![Vec::new(); partition.cells.len()];
    for face in &faces {
        let sides: Vec<u32> = [face.one, face.other].into_iter().filter(|&cell| cell != NONE).collect();
        let firsts: Vec<Dart> = sides.iter().map(|&cell| topology.add(face, cell, &mut edges)).collect();
        if let [one, other] = firsts[..] {
            // Made alike: dart by dart.
            for k in 0..2 * face.corners.len() {
                let dart = |first: Dart| topology.map.dart(first.index() + k);
                if let (Some(a), Some(b)) = (dart(one), dart(other)) {
                    topology.map.link(3, a, b);
                }
            }
        }
        topology.faces.push(Sewn {
            one: face.one,
            other: face.other,
            dart: firsts[0],
            way: face.way,
            sources: face.sources,
        });
    }
    for (cell, mut own) in edges.into_iter().enumerate() {
        if own.is_empty() {
            return Err(TopologyError::NoFace { cell: cell as u32 });
        }
        own.sort_unstable();
        for run in own.chunk_by(|a, b| a.ends == b.ends) {
            // Where a cell has no height, an edge may lie in its floor and in its ceiling: two, over each other.
            let pairs: Vec<&[Edge]> =
                if run.len() == 2 { vec![run] } else { run.chunk_by(|a, b| a.part == b.part).collect() };
            for pair in pairs {
                let [a, b] = pair else {
                    let [from, to] = run[0].ends.map(|v| topology.points[v as usize]);
                    return Err(TopologyError::Edge { cell: cell as u32, from, to, faces: run.len() });
                };
                topology.fold(a, b);
            }
        }
    }
    Ok(topology)
}

/// An edge of a face of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    /// Its vertices, the lower number first.
    ends: [u32; 2],
    /// What the face is of the cell.
    part: Part,
    /// The dart at its start.
    start: Dart,
}

impl Topology {
    /// The area of a face, square lattice units.
    ///
    /// # Panics
    /// If the map never had such a dart.
    pub fn area(&self, dart: Dart) -> f64 {
        let corner = |dart: Dart| DVec3::from(self.points[self.vertex_of[dart.index()] as usize]);
        let mut corners = self.map.around_face(dart).map(corner);
        let Some(first) = corners.next() else { return 0.0 };
        let rest: Vec<DVec3> = corners.map(|corner| corner - first).collect();
        rest.windows(2).map(|pair| pair[0].cross(pair[1])).sum::<DVec3>().length() / 2.0
    }

    /// Adds one side of a face.
    fn add(&mut self, face: &Polygon, cell: u32, edges: &mut [Vec<Edge>]) -> Dart {
        let part = face.way.part(cell == face.one);
        let first = self.map.add_face(face.corners.len());
        for (k, corner) in face.corners.iter().enumerate() {
            let next = face.corners[(k + 1) % face.corners.len()].vertex;
            self.vertex_of.extend([corner.vertex, next]);
            self.cell_of.extend([cell; 2]);
            if let Some(start) = self.map.dart(first.index() + 2 * k) {
                let ends = [corner.vertex.min(next), corner.vertex.max(next)];
                edges[cell as usize].push(Edge { ends, part, start });
            }
        }
        first
    }

    /// Links two faces of a cell along an edge that both have.
    fn fold(&mut self, a: &Edge, b: &Edge) {
        let (a0, b0) = (self.map.alpha(0, a.start), self.map.alpha(0, b.start));
        if self.vertex_of[a.start.index()] == self.vertex_of[b.start.index()] {
            self.map.link(2, a.start, b.start);
            self.map.link(2, a0, b0);
        } else {
            self.map.link(2, a.start, b0);
            self.map.link(2, a0, b.start);
        }
    }
}
