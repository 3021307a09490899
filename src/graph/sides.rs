//! What lies beyond each end of an opening.

use enfilade_importers::Role;
use glam::DVec3;

use super::ends::{self, Corners, Through};
use super::line::{Stretch, crossed};
use super::{Fill, Place, Side, air};
use crate::format::records::CellRecord;
use crate::scene::Scene;
use crate::trace::{NONE, Prisms};

/// Air farther than this beyond an end, other openings not counted, is not what the opening leads to: metres.
const FARTHEST: f64 = 0.5;

/// Other openings in line with it take no more than this, metres.
const OTHERS: f64 = 4.0;

/// Air without a room that is thinner than this is passed, metres: a gap behind a frame or under a covering.
const GAP: f64 = 0.1;

/// Where the share of lines that reach air, by how little matter is in their way, is above this at both ends, no other direction is tried.
const CLEAR: f64 = 0.8;

/// What the likeliest direction counts for among others: the host's, or that of the largest faces.
const FIRST: f64 = 0.35;

/// What it counts for that different things are at both ends.
const APART: f64 = 0.2;

/// Any other direction must reach so much.
const LIKELY: f64 = 0.5;

/// Where an opening leads.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leads {
    /// The way through it, of unit length, internal frame.
    pub(super) direction: DVec3,
    /// What is beyond where lines against, and along, that way leave it.
    pub(super) sides: [Side; 2],
    /// Middles of the two ends, internal frame.
    pub(super) ends: [DVec3; 2],
}

/// What one line finds beyond an end.
#[derive(Clone, Copy, Debug)]
struct Found {
    side: Side,
    /// Metres of matter on the way.
    matter: f64,
}

pub(super) struct Prober<'a> {
    pub(super) scene: &'a Scene,
    pub(super) prisms: Prisms<'a>,
}

impl Prober<'_> {
    /// Where the opening of element `opening` leads; `None` if it has no mesh.
    pub(super) fn leads(&self, opening: u32) -> Option<Leads> {
        let record = &self.scene.tables.elements[opening as usize];
        let own = self.mesh(opening);
        let own_directions = ends::directions(&own);
        if own_directions.is_empty() {
            return None;
        }
        let host = if record.host == NONE { None } else { self.host_direction(record.host, &own) };
        // Without a host that is a wall or a slab, what it is least deep along.
        let first = host.or(own_directions.first().copied())?;
        let (reached, leads) = self.try_along(opening, &own, first);
        if host.is_some() && reached > CLEAR {
            return Some(leads);
        }
        let score = |reached: f64, leads: &Leads| {
            reached + if leads.sides[0] != leads.sides[1] { APART } else { 0.0 }
        };
        let mut best = (score(reached, &leads) + FIRST, leads);
        for other in own_directions.into_iter().filter(|other| first.dot(*other).abs() < 0.9) {
            let (reached, leads) = self.try_along(opening, &own, other);
            let score = score(reached, &leads);
            if reached > LIKELY && score > best.0 {
                best = (score, leads);
            }
        }
        Some(best.1)
    }

    fn mesh(&self, element: u32) -> Vec<Corners> {
        let record = &self.scene.tables.elements[element as usize];
        let triangles = record.first_triangle..record.first_triangle + record.triangle_count;
        triangles.map(|triangle| self.scene.triangle(triangle).map(DVec3::from)).collect()
    }

    /// The direction that most of the host's surface near the opening looks in, if that is a solid: a cupboard may be said to be the host, too.
    fn host_direction(&self, host: u32, opening: &[Corners]) -> Option<DVec3> {
        if self.scene.element(host).role() != Role::Solid {
            return None;
        }
        let bounds = |triangles: &[Corners]| {
            let corners = triangles.iter().flatten();
            corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)])
        };
        let [lo, hi] = bounds(opening);
        let near: Vec<Corners> = self
            .mesh(host)
            .into_iter()
            .filter(|triangle| {
                let [from, to] = bounds(&[*triangle]);
                !(from.cmpgt(hi + FARTHEST).any() || to.cmplt(lo - FARTHEST).any())
            })
            .collect();
        ends::directions(&near).first().copied()
    }

    /// How freely lines along a direction come to air at both ends, from 0 to 1, and what they find.
    fn try_along(&self, opening: u32, own: &[Corners], direction: DVec3) -> (f64, Leads) {
        let lines = ends::lines(own, direction);
        let (mut reached, mut sides, mut middles) = (f64::INFINITY, [Side::Void; 2], [DVec3::ZERO; 2]);
        for end in 0..2 {
            let found: Vec<Found> =
                lines.iter().map(|line| self.beyond(opening, line, direction, end == 1)).collect();
            let clear = |found: &Found| match found.side {
                Side::Void => 0.0,
                _ => 1.0 - (found.matter / FARTHEST).min(1.0),
            };
            let share = found.iter().map(clear).sum::<f64>() / found.len().max(1) as f64;
            reached = reached.min(share);
            sides[end] = commonest(&found);
            let point = |line: &Through| if end == 1 { line.leaves } else { line.enters };
            let points: Vec<DVec3> = match lines.as_slice() {
                // A flat mesh, seen from its edge.
                [] => own.iter().flatten().copied().collect(),
                lines => lines.iter().map(point).collect(),
            };
            middles[end] = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        }
        (reached, Leads { direction, sides, ends: middles })
    }

    /// What a line finds beyond an end: the far one, or the near one.
    fn beyond(&self, opening: u32, line: &Through, direction: DVec3, is_far: bool) -> Found {
        let (start, stop) = if is_far { (line.enters, line.leaves) } else { (line.leaves, line.enters) };
        let direction = if is_far { direction } else { -direction };
        let depth = start.distance(stop);
        let stretches = crossed(&self.prisms, start, direction, depth + FARTHEST + OTHERS);
        // The hole itself, where there is one: the longest of what the opening fills.
        let own = stretches.iter().filter(|stretch| self.is_of(stretch, opening));
        let hole = own.max_by(|a, b| (a.to - a.from).total_cmp(&(b.to - b.from)));
        let from = hole.map_or(depth, |hole| hole.to);
        let mut found = Found { side: Side::Void, matter: 0.0 };
        let (mut gone, mut gap) = (0.0, 0.0);
        for stretch in stretches.iter().filter(|stretch| stretch.to > from) {
            let length = stretch.to - stretch.from.max(from);
            let cell = &self.prisms.cells[stretch.cell as usize];
            if cell.kind == CellRecord::SOLID {
                found.matter += length;
                gap = 0.0;
            } else {
                found.side = match air(cell) {
                    Fill::Place(Place::Room(room)) => Side::Room(room),
                    Fill::Place(Place::Exterior) => Side::Exterior,
                    // Another opening: on through it.
                    Fill::Opening(_) => continue,
                    _ => Side::Void,
                };
                if found.side != Side::Void {
                    break;
                }
                gap += length;
                if gap > GAP {
                    break;
                }
            }
            gone += length;
            if gone > FARTHEST {
                break;
            }
        }
        found
    }

    fn is_of(&self, stretch: &Stretch, opening: u32) -> bool {
        let cell = &self.prisms.cells[stretch.cell as usize];
        cell.kind == CellRecord::AIR && cell.element == opening
    }
}

/// What most lines find; of equals a room before the open, and that before voids.
fn commonest(found: &[Found]) -> Side {
    let mut sides: Vec<Side> = found.iter().map(|found| found.side).collect();
    sides.sort_unstable();
    let runs = sides.chunk_by(|a, b| a == b);
    runs.rev().max_by_key(|run| run.len()).map_or(Side::Void, |run| run[0])
}
