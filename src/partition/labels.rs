//! What fills an interval that several bodies claim: matter before air, small rooms before large ones, rooms before the
//! openings that stick into them, but an opening where rooms would leave too little of it.

use std::cmp::Reverse;

use enfilade_importers::{Model, Semantic};

use super::bodies::Body;
use super::cells::Label;
use super::columns::Columns;
use super::plan::Plan;
use crate::lattice::{FINE, double_area};

/// An opening of which rooms would take more than this share wins against them.
const MOST_TAKEN: f64 = 0.7;

/// What a body is among labels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Solid,
    Room,
    Opening,
    Exterior,
}

/// Says what fills an interval.
#[derive(Debug)]
pub(super) struct Labels {
    kinds: Vec<Kind>,
    /// Openings that win against rooms.
    wins: Vec<bool>,
    /// By body: what is smaller wins against what is larger; of labels as large as each other the one that lies deeper in the source's tree,
    /// as a room that is all of its storey's space.
    sizes: Vec<(u64, Reverse<usize>)>,
    labels: Vec<Label>,
}

impl Labels {
    /// The labels of the bodies of `model`, given all columns.
    pub(super) fn new(model: &Model, bodies: &[Body], slabs: &[(&Plan, &Columns)]) -> Labels {
        let kind = |body: &Body| match model.elements[body.element.0 as usize].semantic {
            _ if body.is_solid => Kind::Solid,
            Semantic::Door | Semantic::Window | Semantic::Opening => Kind::Opening,
            Semantic::Exterior => Kind::Exterior,
            _ => Kind::Room,
        };
        let label = |body: &Body| {
            if body.is_solid { Label::Solid(body.element) } else { Label::Air(body.element) }
        };
        let size = |body: &Body| {
            let depth = model.elements[body.element.0 as usize].path.matches('/').count();
            // To some millionths: more is rounding.
            (body.volume.to_bits() >> 32, Reverse(depth))
        };
        let mut labels = Labels {
            kinds: bodies.iter().map(kind).collect(),
            wins: vec![false; bodies.len()],
            sizes: bodies.iter().map(size).collect(),
            labels: bodies.iter().map(label).collect(),
        };
        let mut air = vec![[0.0f64; 2]; bodies.len()];
        for (plan, columns) in slabs {
            for (sum, part) in air.iter_mut().zip(labels.opening_air(plan, columns)) {
                sum[0] += part[0];
                sum[1] += part[1];
            }
        }
        labels.wins = air.iter().map(|[all, taken]| *all > 0.0 && *taken > MOST_TAKEN * all).collect();
        labels
    }

    /// For each opening the volume of its air, and how much of that is in rooms, cubic lattice units.
    fn opening_air(&self, plan: &Plan, columns: &Columns) -> Vec<[f64; 2]> {
        let mut air = vec![[0.0; 2]; self.kinds.len()];
        let openings: Vec<Vec<u32>> = columns.sets.iter().map(|set| self.openings(set)).collect();
        let in_room: Vec<bool> = columns
            .sets
            .iter()
            .map(|set| set.iter().any(|&b| self.kinds[b as usize] == Kind::Room))
            .collect();
        for t in 0..plan.triangles.len() as u32 {
            for interval in columns.stack(t) {
                let openings = &openings[interval.set as usize];
                if openings.is_empty() {
                    continue;
                }
                let volume = volume(plan, columns, t, interval.floor, interval.ceiling);
                for &b in openings {
                    air[b as usize][0] += volume;
                    air[b as usize][1] += if in_room[interval.set as usize] { volume } else { 0.0 };
                }
            }
        }
        air
    }

    /// The openings of a set without matter.
    fn openings(&self, set: &[u32]) -> Vec<u32> {
        if set.iter().any(|&b| self.kinds[b as usize] == Kind::Solid) {
            return Vec::new();
        }
        set.iter().copied().filter(|&b| self.kinds[b as usize] == Kind::Opening).collect()
    }

    /// What a set of bodies, ascending, makes of the space that they share; `None` if they leave it unlabelled.
    pub(super) fn of(&self, set: &[u32]) -> Option<Label> {
        // Less is stronger.
        let strength = |&&body: &&u32| {
            let b = body as usize;
            let rank = match self.kinds[b] {
                Kind::Solid => 0,
                Kind::Opening if self.wins[b] => 1,
                Kind::Room => 2,
                Kind::Opening => 3,
                Kind::Exterior => 4,
            };
            // Of solids the first, of labels the smallest.
            let size = if rank == 0 { (0, Reverse(0)) } else { self.sizes[b] };
            (rank, size, body)
        };
        set.iter().min_by_key(strength).map(|&body| self.labels[body as usize])
    }

    /// Whether a label is a room's.
    pub(super) fn rooms(&self) -> impl Fn(Label) -> bool + '_ {
        let rooms: std::collections::BTreeSet<Label> = self
            .kinds
            .iter()
            .zip(&self.labels)
            .filter(|(kind, _)| **kind == Kind::Room)
            .map(|(_, label)| *label)
            .collect();
        move |label| rooms.contains(&label)
    }
}

/// Volume between two planes over a triangle, cubic lattice units.
pub(super) fn volume(plan: &Plan, columns: &Columns, triangle: u32, floor: u32, ceiling: u32) -> f64 {
    let corners = plan.corners(triangle);
    let (floor, ceiling) = (columns.planes[floor as usize], columns.planes[ceiling as usize]);
    let height: f64 =
        corners.iter().map(|&c| (ceiling.height(c) as f64 - floor.height(c) as f64) / FINE as f64).sum();
    double_area(&corners) as f64 / 2.0 * height / 3.0
}
