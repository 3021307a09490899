//! Rooms that are one over several storeys, as a hall is.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::super::passage::Union;
use super::{Fill, Finder};
use crate::graph::{area, clipped};
use crate::lattice::Point;
use crate::partition::storeys::NONE;

/// Where more of a storey than this has no floor, floors were not modelled.
const BARE: f64 = 0.6;
/// Between two storeys there is one room if so much of the one's area and of the other's is open between them.
const OPEN: f64 = 0.85;

impl Finder<'_> {
    /// Where a storey ends in air.
    fn airy(&self, storey: usize) -> Vec<Piece> {
        let of = &self.storeys.storeys[storey];
        let is_air = |&t: &u32| {
            let last = of.stack(t).last();
            last.is_some_and(|last| {
                matches!(self.fills[storey][last.set as usize], Fill::Air | Fill::Opening)
            })
        };
        let step = self.storeys.lattice.step();
        let mut pieces: Vec<Piece> = (0..of.triangles.len() as u32)
            .filter(is_air)
            .map(|t| Piece::new(of.corners(t), 0, step))
            .collect();
        pieces.sort_by(|a, b| a.bounds[0].total_cmp(&b.bounds[0]));
        pieces
    }

    /// Rooms that are one over several storeys, as a hall is: those with hardly a floor between them.
    pub(super) fn one_above_the_other(&self, rooms: &BTreeSet<u32>) -> Union {
        let mut union = Union::new(self.patches.len());
        let step = self.storeys.lattice.step();
        for lower in 0..self.storeys.storeys.len().saturating_sub(1) {
            let open = |storey: usize, end: usize| -> Vec<Piece> {
                let of = &self.storeys.storeys[storey];
                let is_open = |&t: &u32| {
                    let patch = self.patch_of[storey][t as usize];
                    patch != NONE && rooms.contains(&patch) && self.spots[storey][t as usize].is_open[end]
                };
                let piece = |t: u32| Piece::new(of.corners(t), self.patch_of[storey][t as usize], step);
                let mut pieces: Vec<Piece> =
                    (0..of.triangles.len() as u32).filter(is_open).map(piece).collect();
                pieces.sort_by(|a, b| a.bounds[0].total_cmp(&b.bounds[0]));
                pieces
            };
            let (below, above) = (open(lower, 1), open(lower + 1, 0));
            let on = |storey: usize| {
                rooms.iter().filter(move |room| self.patches[**room as usize].storey == storey)
            };
            // A model without floors at all says nothing about where there is none.
            let all: f64 = on(lower + 1).map(|room| self.patches[*room as usize].area).sum();
            let bare: f64 = overlaps(&self.airy(lower), &above).values().sum();
            if bare > BARE * all {
                continue;
            }
            for ((low, high), shared) in overlaps(&below, &above) {
                let least = |patch: u32| OPEN * self.patches[patch as usize].area;
                if shared >= least(low) && shared >= least(high) {
                    union.join(low, high);
                }
            }
        }
        union
    }
}

/// A triangle of a plan, metres, and the patch that it is of.
struct Piece {
    corners: Vec<DVec2>,
    patch: u32,
    /// From where to where in x, then in y.
    bounds: [f64; 4],
}

impl Piece {
    fn new(corners: [Point; 3], patch: u32, step: f64) -> Piece {
        let corners = corners.map(|p| DVec2::new(f64::from(p.x), f64::from(p.y)) * step);
        let lo = corners[0].min(corners[1]).min(corners[2]);
        let hi = corners[0].max(corners[1]).max(corners[2]);
        Piece { corners: corners.to_vec(), patch, bounds: [lo.x, hi.x, lo.y, hi.y] }
    }
}

/// The area that the pieces of two patches share, by their patches; both lists by the lower end in x.
fn overlaps(below: &[Piece], above: &[Piece]) -> BTreeMap<(u32, u32), f64> {
    let mut shared = BTreeMap::new();
    let mut first = 0;
    let widest = below.iter().map(|piece| piece.bounds[1] - piece.bounds[0]).fold(0.0f64, f64::max);
    for high in above {
        while below.get(first).is_some_and(|low| low.bounds[0] + widest < high.bounds[0]) {
            first += 1;
        }
        for low in below[first..].iter().take_while(|low| low.bounds[0] < high.bounds[1]) {
            let [a, b] = [low.bounds, high.bounds];
            if a[1] > b[0] && a[2] < b[3] && a[3] > b[2] {
                let part = area(&clipped(low.corners.clone(), &high.corners));
                if part > 0.0 {
                    *shared.entry((low.patch, high.patch)).or_insert(0.0) += part;
                }
            }
        }
    }
    shared
}
