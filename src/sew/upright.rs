//! The common part of the sides of two cells: over both floors and under both ceilings.
//!
//! All is linear over the border. Heights over its ends are within the hull, below 2^50 parts of a lattice unit; products of three
//! of them do not occur.

use super::Way;
use super::faces::{Border, Corner, Polygon, polygon};
use super::heights::Heights;
use super::vertices::Vertices;
use crate::lattice::Site;
use crate::partition::cells::{Cell, NONE, Partition};

/// A plane over an edge: its number, and its heights over the ends.
#[derive(Clone, Copy, Debug)]
struct Line {
    plane: u32,
    ends: [i128; 2],
}

/// A share of an edge.
#[derive(Clone, Copy, Debug)]
struct Share {
    part: i128,
    whole: i128,
}

impl Share {
    const START: Share = Share { part: 0, whole: 1 };
    const END: Share = Share { part: 1, whole: 1 };

    fn is_before(&self, other: &Share) -> bool {
        self.part * other.whole < other.part * self.whole
    }
}

impl Line {
    /// The height at a share, times its `whole`.
    fn at(&self, share: &Share) -> i128 {
        self.ends[0] * share.whole + (self.ends[1] - self.ends[0]) * share.part
    }

    /// Where two lines cross between the ends.
    fn crossing(&self, other: &Line) -> Option<Share> {
        let [start, end] = [0, 1].map(|i| self.ends[i] - other.ends[i]);
        let whole = (start - end).abs();
        ((start > 0 && end < 0) || (start < 0 && end > 0)).then(|| Share { part: start.abs(), whole })
    }
}

/// The common part of two upright sides.
pub(super) fn upright(
    partition: &Partition,
    border: &Border,
    heights: &Heights,
    vertices: &mut Vertices<'_>,
) -> Option<Polygon> {
    let line = |plane: u32| {
        let height = |end: Site| heights.at(&end, end.height(&partition.planes[plane as usize]));
        Line { plane, ends: border.ends.map(|end| height(end.into())) }
    };
    let cells = [border.one, border.other].into_iter().filter(|&cell| cell != NONE);
    let cells: Vec<&Cell> = cells.map(|cell| &partition.cells[cell as usize]).collect();
    let floors: Vec<Line> = cells.iter().map(|cell| line(cell.floor)).collect();
    let ceilings: Vec<Line> = cells.iter().map(|cell| line(cell.ceiling)).collect();
    // Where all ceilings are over all floors.
    let (mut from, mut to) = (Share::START, Share::END);
    for floor in &floors {
        for ceiling in &ceilings {
            let [start, end] = [0, 1].map(|i| ceiling.ends[i] - floor.ends[i]);
            if start <= 0 && end <= 0 {
                return None;
            }
            if let Some(crossing) = floor.crossing(ceiling) {
                if start > 0 && crossing.is_before(&to) {
                    to = crossing;
                } else if start < 0 && from.is_before(&crossing) {
                    from = crossing;
                }
            }
        }
    }
    if !from.is_before(&to) {
        return None;
    }
    let bends = |lines: &[Line]| {
        let crossing = match lines {
            [a, b] => a.crossing(b),
            _ => None,
        };
        crossing.filter(|share| from.is_before(share) && share.is_before(&to))
    };
    let low = chain(&floors, [Some(from), bends(&floors), Some(to)], i128::max);
    let high = chain(&ceilings, [Some(to), bends(&ceilings), Some(from)], i128::min);
    let (low_end, high_end) = (low.len() - 1, low.len());
    let mut made = [low, high].concat();
    // Where floor and ceiling meet they are one vertex, which lies on planes of both.
    let last = made.len() - 1;
    let meets = |share: &Share| {
        let floor = floors.iter().map(|l| l.at(share)).max();
        floor == ceilings.iter().map(|l| l.at(share)).min()
    };
    for (a, b, share) in [(low_end, high_end, to), (0, last, from)] {
        if meets(&share) {
            let both = [made[a].planes.clone(), made[b].planes.clone()].concat();
            (made[a].planes, made[b].planes) = (both.clone(), both);
        }
    }
    let corners = made
        .into_iter()
        .map(|bend| Corner {
            vertex: vertices.at(Site::between(border.ends, bend.share.part, bend.share.whole), &bend.planes),
            edge: bend.edge.map(|planes| (border.ends, planes)),
        })
        .collect();
    polygon(border.one, border.other, Way::Upright, corners)
}

/// A corner of the lower or upper edge of a side.
#[derive(Clone, Debug)]
struct Bend {
    share: Share,
    /// What passes it.
    planes: Vec<u32>,
    /// The planes of the edge from it to the next, if that is not upright.
    edge: Option<[u32; 2]>,
}

/// The highest or lowest of some lines, from the first of the shares to the last.
fn chain(lines: &[Line], shares: [Option<Share>; 3], extreme: fn(i128, i128) -> i128) -> Vec<Bend> {
    let through = |share: &Share| -> Vec<u32> {
        let best = lines.iter().map(|line| line.at(share)).reduce(extreme);
        lines.iter().filter(|line| Some(line.at(share)) == best).map(|line| line.plane).collect()
    };
    let shares: Vec<Share> = shares.into_iter().flatten().collect();
    let bend = |(k, &share): (usize, &Share)| {
        let planes = through(&share);
        // Lines that are extreme between two bends are so at both.
        let edge = shares.get(k + 1).and_then(|next| {
            let there = through(next);
            let both = || planes.iter().copied().filter(|plane| there.contains(plane));
            Some([both().next()?, both().next_back()?])
        });
        Bend { share, planes, edge }
    };
    shares.iter().enumerate().map(bend).collect()
}
