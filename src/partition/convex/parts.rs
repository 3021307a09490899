//! The parts of a region, linked along the diagonals that they share.

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::best::Cutter;
use super::region::Region;
use super::{RegionError, is_convex};
use crate::lattice::{Point, double_area, orient};

/// What stands for no part.
pub(super) const NOWHERE: u32 = u32::MAX;

/// A region cut into parts, as half-edges: number `h` runs along its part's boundary with the part on its left, `h ^ 1`
/// is the other side.
#[derive(Default)]
pub(super) struct Parts {
    pub points: Vec<Point>,
    /// The vertex where each half-edge starts.
    pub from: Vec<u32>,
    pub next: Vec<u32>,
    pub previous: Vec<u32>,
    /// The part on its left; [`NOWHERE`] outside the region and for half-edges no longer in use.
    pub part: Vec<u32>,
    /// A half-edge of each part; [`NOWHERE`] for parts no longer in use.
    pub first: Vec<u32>,
}

impl Parts {
    /// The best cut of a region that one chain of moderate length bounds; `None` for any other.
    pub fn whole(region: &Region) -> Option<Parts> {
        /// The longest chain that is cut as a whole.
        const LONGEST: usize = 48;
        let [chain] = &region.chains[..] else { return None };
        if chain.len() > LONGEST {
            return None;
        }
        let mut parts = Parts { points: region.points.clone(), ..Parts::default() };
        let n = chain.len() as u32;
        for (k, &v) in (0..n).zip(chain) {
            let to = chain[((k + 1) % n) as usize];
            parts.pair(v, to);
            parts.next[2 * k as usize] = 2 * ((k + 1) % n);
            parts.previous[2 * k as usize] = 2 * ((k + n - 1) % n);
            parts.part[2 * k as usize] = 0;
        }
        parts.first.push(0);
        let mut cutter = Cutter::default();
        cutter.cut(chain.iter().map(|&v| region.points[v as usize]))?;
        let boundary: Vec<u32> = (0..n).map(|k| 2 * k).collect();
        parts.fill(&boundary, &cutter.parts(), vec![0], Vec::new());
        Some(parts)
    }

    /// The triangles of the constrained Delaunay triangulation inside a region.
    pub fn triangles(region: &Region) -> Result<Parts, RegionError> {
        let at = |v: u32| region.points[v as usize];
        let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
        // One by one, in an order of their own: bulk loading inserts some in the order of a randomly seeded hash set.
        for (k, p) in region.points.iter().enumerate() {
            let handle = triangulation
                .insert(Point2::new(f64::from(p.x), f64::from(p.y)))
                .map_err(|_| RegionError::SamePlace(*p))?;
            if handle.index() != k {
                return Err(RegionError::SamePlace(*p));
            }
        }
        for [a, b] in region.edges() {
            let [from, to] = [a, b].map(|v| FixedVertexHandle::from_index(v as usize));
            triangulation.try_add_constraint(from, to);
            if !triangulation.exists_constraint(from, to) {
                return Err(RegionError::Crossing(at(a)));
            }
        }
        let edges = triangulation.num_directed_edges();
        let mut parts = Parts {
            points: region.points.clone(),
            from: vec![0; edges],
            next: vec![0; edges],
            previous: vec![0; edges],
            part: vec![NOWHERE; edges],
            first: Vec::new(),
        };
        let mut is_outer = vec![false; edges];
        for edge in triangulation.directed_edges() {
            let h = edge.fix().index();
            is_outer[h] = edge.face().is_outer();
            parts.from[h] = edge.from().fix().index() as u32;
            parts.next[h] = edge.next().fix().index() as u32;
            parts.previous[h] = edge.prev().fix().index() as u32;
        }
        // The boundary's left sides, then all triangles that are reached without crossing it.
        let mut open = Vec::new();
        let mut is_boundary = vec![false; edges];
        for [a, b] in region.edges() {
            let [from, to] = [a, b].map(|v| FixedVertexHandle::from_index(v as usize));
            let edge = triangulation.get_edge_from_neighbors(from, to).ok_or(RegionError::Crossing(at(a)))?;
            if edge.face().is_outer() {
                return Err(RegionError::Crossing(at(a)));
            }
            let h = edge.fix().index();
            is_boundary[h] = true;
            open.push(h as u32);
        }
        while let Some(h) = open.pop() {
            if parts.part[h as usize] != NOWHERE {
                continue;
            }
            let part = parts.first.len() as u32;
            parts.first.push(h);
            let mut g = h;
            loop {
                let other = g ^ 1;
                parts.part[g as usize] = part;
                if is_boundary[other as usize] {
                    // The outside lies on the left of this edge.
                    return Err(RegionError::Crossing(at(parts.from[g as usize])));
                }
                if !is_boundary[g as usize] {
                    if is_outer[other as usize] {
                        return Err(RegionError::Crossing(at(parts.from[g as usize])));
                    }
                    open.push(other);
                }
                g = parts.next[g as usize];
                if g == h {
                    break;
                }
            }
        }
        let all: i64 = region
            .chains
            .iter()
            .map(|chain| double_area(&chain.iter().map(|&v| at(v)).collect::<Vec<_>>()))
            .sum();
        let triangles: i64 = parts.first.iter().map(|&h| double_area(&parts.corners(h))).sum();
        if all != triangles {
            return Err(RegionError::Crossing(region.points.first().copied().unwrap_or_default()));
        }
        Ok(parts)
    }

    /// The half-edges about the part of `first`.
    pub fn about(&self, first: u32) -> impl Iterator<Item = u32> + '_ {
        let step = move |&h: &u32| Some(self.next[h as usize]).filter(|&n| n != first);
        std::iter::successors(Some(first), step)
    }

    pub fn start(&self, h: u32) -> Point {
        self.points[self.from[h as usize] as usize]
    }

    fn corners(&self, first: u32) -> Vec<Point> {
        self.about(first).map(|h| self.start(h)).collect()
    }

    /// Whether parts lie on both sides.
    pub fn is_diagonal(&self, h: u32) -> bool {
        self.part[h as usize] != NOWHERE && self.part[h as usize ^ 1] != NOWHERE
    }

    /// A new half-edge and its other side.
    fn pair(&mut self, from: u32, to: u32) -> u32 {
        let h = self.from.len() as u32;
        self.from.extend([from, to]);
        self.next.extend([NOWHERE; 2]);
        self.previous.extend([NOWHERE; 2]);
        self.part.extend([NOWHERE; 2]);
        h
    }

    /// Takes away diagonals, the longest first, wherever both ends stay convex.
    pub fn dissolve(&mut self) {
        let mut diagonals: Vec<(u64, u32)> = Vec::new();
        for h in (0..self.from.len() as u32).step_by(2) {
            if self.is_diagonal(h) {
                diagonals.push((super::best::cost(self.start(h), self.start(h ^ 1)), h));
            }
        }
        diagonals.sort_unstable_by_key(|&(length, h)| (std::cmp::Reverse(length), h));
        for (_, h) in diagonals {
            // Later removals only widen corners, so that what must stay now must stay for good.
            if self.stays_convex(h) && self.stays_convex(h ^ 1) {
                self.remove(h);
            }
        }
        // Removal left the parts' numbers of one side: number them afresh.
        self.first.clear();
        let mut seen = vec![false; self.from.len()];
        for h in 0..self.from.len() as u32 {
            if self.part[h as usize] == NOWHERE || seen[h as usize] {
                continue;
            }
            let part = self.first.len() as u32;
            self.first.push(h);
            let mut g = h;
            loop {
                seen[g as usize] = true;
                self.part[g as usize] = part;
                g = self.next[g as usize];
                if g == h {
                    break;
                }
            }
        }
    }

    /// Whether the corner where `h` starts is not reflex without it.
    fn stays_convex(&self, h: u32) -> bool {
        let before = self.start(self.previous[h as usize]);
        let after = self.start(self.next[self.next[h as usize ^ 1] as usize]);
        orient(before, self.start(h), after) >= 0
    }

    fn remove(&mut self, h: u32) {
        for g in [h, h ^ 1] {
            let (before, after) = (self.previous[g as usize], self.next[g as usize ^ 1]);
            self.next[before as usize] = after;
            self.previous[after as usize] = before;
        }
        for g in [h, h ^ 1] {
            self.part[g as usize] = NOWHERE;
        }
    }

    /// Replaces what the half-edges `boundary` enclose by `parts`, given by places in `boundary` as [`Cutter::parts`]
    /// returns them. `numbers` are the parts that were there, `spare` the diagonals between them.
    pub fn fill(
        &mut self,
        boundary: &[u32],
        parts: &[Vec<u16>],
        mut numbers: Vec<u32>,
        mut spare: Vec<u32>,
    ) -> Vec<u32> {
        for &h in &spare {
            self.part[h as usize] = NOWHERE;
            self.part[h as usize ^ 1] = NOWHERE;
        }
        for &number in &numbers {
            self.first[number as usize] = NOWHERE;
        }
        numbers.sort_unstable_by_key(|&number| std::cmp::Reverse(number));
        let mut filled = Vec::with_capacity(parts.len());
        // The inner side of each new diagonal, by its ends, until the part behind it comes up.
        let mut cuts: Vec<([u16; 2], u32)> = Vec::new();
        for part in parts {
            let number = numbers.pop().unwrap_or_else(|| {
                self.first.push(NOWHERE);
                self.first.len() as u32 - 1
            });
            let mut round: Vec<u32> = Vec::with_capacity(part.len());
            for ends in part.windows(2) {
                let (a, b) = (boundary[usize::from(ends[0])], boundary[usize::from(ends[1])]);
                round.push(if ends[1] == ends[0] + 1 {
                    a
                } else {
                    let (from, to) = (self.from[a as usize], self.from[b as usize]);
                    let h = match spare.pop() {
                        Some(h) => {
                            self.from[h as usize] = from;
                            self.from[h as usize ^ 1] = to;
                            h
                        }
                        None => self.pair(from, to),
                    };
                    cuts.push(([ends[0], ends[1]], h));
                    h
                });
            }
            // Back from the last corner to the first: the other side of a diagonal of an earlier part.
            let ends = [part[0], part[part.len() - 1]];
            round.push(match cuts.iter().position(|&(cut, _)| cut == ends) {
                Some(at) => cuts.swap_remove(at).1 ^ 1,
                None => boundary[usize::from(ends[1])],
            });
            for (k, &h) in round.iter().enumerate() {
                let next = round[(k + 1) % round.len()];
                self.next[h as usize] = next;
                self.previous[next as usize] = h;
                self.part[h as usize] = number;
            }
            self.first[number as usize] = round[0];
            filled.push(number);
        }
        filled
    }

    /// The parts as polygons, in the caller's vertices `ids`.
    pub fn take(self, ids: &[u32]) -> Vec<Vec<u32>> {
        let used = self.first.iter().copied().filter(|&h| h != NOWHERE);
        used.map(|h| {
            debug_assert!(is_convex(&self.corners(h)));
            self.about(h).map(|g| ids[self.from[g as usize] as usize]).collect()
        })
        .collect()
    }
}
