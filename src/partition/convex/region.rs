//! The boundary of a region, checked and put in order.

use std::cmp::Ordering;

use super::{RegionError, is_upward};
use crate::lattice::{Point, orient};

/// A region: its vertices, numbered afresh, and its boundary.
pub(super) struct Region {
    /// Its vertices.
    pub points: Vec<Point>,
    /// For each vertex the caller's index.
    pub ids: Vec<u32>,
    /// Closed chains of vertices with the region on their left. Where a vertex occurs several times, each occurrence
    /// stands for one wedge of the region: from the edge that leaves counter-clockwise to the edge that arrives.
    pub chains: Vec<Vec<u32>>,
}

impl Region {
    pub fn new(loops: &[Vec<u32>], points: &[Point]) -> Result<Region, RegionError> {
        let mut ids: Vec<u32> = loops.iter().flatten().copied().collect();
        let visits = ids.len();
        ids.sort_unstable();
        ids.dedup();
        if let Some(&last) = ids.last()
            && last as usize >= points.len()
        {
            return Err(RegionError::NoSuchVertex(last));
        }
        let touching = ids.len() < visits;
        let mut region =
            Region { points: ids.iter().map(|&v| points[v as usize]).collect(), ids, chains: Vec::new() };
        for chain in loops {
            if chain.len() < 3 {
                return Err(RegionError::ShortChain(chain.len()));
            }
            // Every vertex is among the ids: they were taken from the chains.
            region
                .chains
                .push(chain.iter().map(|v| region.ids.partition_point(|id| id < v) as u32).collect());
        }
        region.check()?;
        if touching {
            region.part_wedges()?;
        }
        Ok(region)
    }

    /// The edges, in order of their chains.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.chains.iter().flat_map(|chain| {
            let next = chain.iter().skip(1).chain(chain.first());
            chain.iter().zip(next).map(|(&a, &b)| [a, b])
        })
    }

    fn at(&self, vertex: u32) -> Point {
        self.points[vertex as usize]
    }

    fn check(&self) -> Result<(), RegionError> {
        let mut places = self.points.clone();
        places.sort_unstable();
        if let Some(twice) = places.windows(2).find(|w| w[0] == w[1]) {
            return Err(RegionError::SamePlace(twice[0]));
        }
        let mut edges: Vec<[u32; 2]> = self.edges().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        if let Some(&[a, b]) = edges.iter().find(|e| e[0] == e[1]) {
            return Err(RegionError::EdgeTwice(self.at(a), self.at(b)));
        }
        if let Some(twice) = edges.windows(2).find(|w| w[0] == w[1]) {
            return Err(RegionError::EdgeTwice(self.at(twice[0][0]), self.at(twice[0][1])));
        }
        Ok(())
    }

    /// Links the edges anew at vertices that occur several times, so that each occurrence stands for one wedge.
    fn part_wedges(&mut self) -> Result<(), RegionError> {
        let edges: Vec<[u32; 2]> = self.edges().collect();
        // Spokes about each vertex: the vertex, the other end, the edge, whether it arrives.
        let mut spokes: Vec<(u32, u32, u32, bool)> = Vec::with_capacity(2 * edges.len());
        for (k, &[a, b]) in edges.iter().enumerate() {
            spokes.push((a, b, k as u32, false));
            spokes.push((b, a, k as u32, true));
        }
        spokes.sort_by(|s, t| s.0.cmp(&t.0).then_with(|| by_angle(self.at(s.0), self.at(s.1), self.at(t.1))));
        let mut after = vec![0u32; edges.len()];
        for about in spokes.chunk_by(|s, t| s.0 == t.0) {
            for (k, spoke) in about.iter().enumerate() {
                let next = about[(k + 1) % about.len()];
                // Counter-clockwise from an edge that leaves comes the one that arrives, and so on in turn.
                if spoke.3 == next.3 {
                    return Err(RegionError::Crossing(self.at(spoke.0)));
                }
                if next.3 {
                    after[next.2 as usize] = spoke.2;
                }
            }
        }
        self.chains.clear();
        let mut seen = vec![false; edges.len()];
        for start in 0..edges.len() {
            let mut chain = Vec::new();
            let mut edge = start;
            while !seen[edge] {
                seen[edge] = true;
                chain.push(edges[edge][0]);
                edge = after[edge] as usize;
            }
            if !chain.is_empty() {
                self.chains.push(chain);
            }
        }
        Ok(())
    }
}

/// Counter-clockwise order of directions from `o`, exactly, from +x on.
fn by_angle(o: Point, a: Point, b: Point) -> Ordering {
    is_upward(o, b).cmp(&is_upward(o, a)).then_with(|| 0.cmp(&orient(o, a, b)))
}
