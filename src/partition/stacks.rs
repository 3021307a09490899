//! Stacks of labelled intervals over the triangles of a plan, and the thin unlabelled air that joins the room beside it.
//!
//! Rooms are seldom drawn as far as the surfaces around them: between a room's label and its walls are gaps of a tenth of
//! a millimetre to some centimetres. What is that thin and lies beside a room becomes part of it, so that the room's
//! cells end on the surfaces themselves.

use super::cells::Label;
use super::columns::Columns;
use super::labels::{Labels, volume};
use super::plan::{NONE, Plan};
use crate::lattice::{FINE, Lattice, double_area};

/// Between two planes, filled with one thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Item {
    pub(super) floor: u32,
    pub(super) ceiling: u32,
    /// `None`: air without a label.
    pub(super) fill: Option<Label>,
}

/// Stacks over the triangles of a plan: at least one item each, from the bottom up, no two neighbours of one fill.
pub(super) type Stacks = Vec<Vec<Item>>;

/// The stacks as the labels say, neighbouring intervals of one fill made one.
pub(super) fn label(columns: &Columns, labels: &Labels, triangles: usize) -> Stacks {
    let fills: Vec<Option<Label>> = columns.sets.iter().map(|set| labels.of(set)).collect();
    (0..triangles as u32)
        .map(|t| {
            let items = columns.stack(t).iter().map(|interval| Item {
                floor: interval.floor,
                ceiling: interval.ceiling,
                fill: fills[interval.set as usize],
            });
            let mut stack = Vec::with_capacity(items.len());
            items.for_each(|item| push(&mut stack, item));
            stack
        })
        .collect()
}

fn push(stack: &mut Vec<Item>, item: Item) {
    match stack.last_mut() {
        Some(last) if last.fill == item.fill => last.ceiling = item.ceiling,
        _ => stack.push(item),
    }
}

/// Air thinner than this beside a room joins it, metres.
const THIN: f64 = 0.05;

/// How much was joined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Joined {
    /// Pieces.
    pub(super) pieces: u64,
    /// Cubic lattice units.
    pub(super) volume: f64,
}

/// Joins thin unlabelled air to the rooms beside it.
pub(super) fn join_slivers(
    plan: &Plan,
    columns: &Columns,
    lattice: &Lattice,
    is_room: &dyn Fn(Label) -> bool,
    stacks: &mut Stacks,
) -> Vec<(Label, Joined)> {
    let mut joiner = Joiner {
        plan,
        columns,
        thin: lattice.steps(THIN),
        is_room,
        joined: std::collections::BTreeMap::new(),
    };
    for t in 0..stacks.len() as u32 {
        joiner.join_between(t, stacks);
    }
    // Across the plan: from every triangle to those beside it, until nothing changes.
    let mut waiting: Vec<u32> = (0..stacks.len() as u32).rev().collect();
    let mut is_waiting = vec![true; stacks.len()];
    while let Some(t) = waiting.pop() {
        is_waiting[t as usize] = false;
        if joiner.join_beside(t, stacks) {
            for other in plan.across[t as usize].into_iter().filter(|&other| other != NONE) {
                if !std::mem::replace(&mut is_waiting[other as usize], true) {
                    waiting.push(other);
                }
            }
        }
    }
    joiner.joined.into_iter().collect()
}

struct Joiner<'a> {
    plan: &'a Plan,
    columns: &'a Columns,
    thin: f64,
    is_room: &'a dyn Fn(Label) -> bool,
    joined: std::collections::BTreeMap<Label, Joined>,
}

impl Joiner<'_> {
    fn room(&self, item: &Item) -> Option<Label> {
        item.fill.filter(|&label| (self.is_room)(label))
    }

    /// Height of a plane over the middle of a triangle, lattice units.
    fn height(&self, t: u32, plane: u32) -> f64 {
        let plane = &self.columns.planes[plane as usize];
        let sum: f64 = self.plan.corners(t).iter().map(|&c| plane.height(c) as f64).sum();
        sum / 3.0 / FINE as f64
    }

    fn count(&mut self, label: Label, t: u32, floor: u32, ceiling: u32) {
        let joined = self.joined.entry(label).or_default();
        joined.pieces += 1;
        joined.volume += volume(self.plan, self.columns, t, floor, ceiling);
    }

    /// Joins low intervals above and below rooms.
    fn join_between(&mut self, t: u32, stacks: &mut Stacks) {
        let stack = &mut stacks[t as usize];
        let mut changed = false;
        for k in 0..stack.len() {
            let item = stack[k];
            if item.fill.is_some() || self.height(t, item.ceiling) - self.height(t, item.floor) >= self.thin {
                continue;
            }
            let below = k.checked_sub(1).and_then(|k| self.room(&stack[k]));
            let above = stack.get(k + 1).and_then(|item| self.room(item));
            // A step out of a room into the open is no gap: the other side must be matter or a room.
            let closed =
                |k: Option<usize>| k.and_then(|k| stack.get(k)).is_some_and(|item| item.fill.is_some());
            if let Some(label) = below.or(above)
                && closed(k.checked_sub(1))
                && closed(Some(k + 1))
            {
                stack[k].fill = Some(label);
                self.count(label, t, item.floor, item.ceiling);
                changed = true;
            }
        }
        if changed {
            settle(stack);
        }
    }

    /// Joins narrow triangles' intervals to rooms across their edges.
    fn join_beside(&mut self, t: u32, stacks: &mut Stacks) -> bool {
        let corners = self.plan.corners(t);
        let double = double_area(&corners) as f64;
        let mut changed = false;
        for i in 0..3 {
            let other = self.plan.across[t as usize][i];
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let length = (f64::from(b.x) - f64::from(a.x)).hypot(f64::from(b.y) - f64::from(a.y));
            if other == NONE || double >= self.thin * length {
                continue;
            }
            let mut k = 0;
            while k < stacks[t as usize].len() {
                let item = stacks[t as usize][k];
                if item.fill.is_none()
                    && let Some(parts) = self.parts(t, item, &stacks[other as usize])
                {
                    for part in &parts {
                        if let Some(label) = part.fill {
                            self.count(label, t, part.floor, part.ceiling);
                        }
                    }
                    let count = parts.len();
                    stacks[t as usize].splice(k..=k, parts);
                    k += count;
                    changed = true;
                } else {
                    k += 1;
                }
            }
        }
        if changed {
            settle(&mut stacks[t as usize]);
        }
        changed
    }

    /// What becomes of an unlabelled item beside a stack: the parts of it beside rooms are theirs. `None` if no room lies
    /// beside it.
    fn parts(&self, t: u32, item: Item, beside: &[Item]) -> Option<Vec<Item>> {
        let unit = 1.0;
        let (low, high) = (self.height(t, item.floor), self.height(t, item.ceiling));
        let mut parts: Vec<Item> = Vec::new();
        let mut floor = (item.floor, low);
        for room in beside {
            let Some(label) = self.room(room) else { continue };
            let (from, to) = (self.height(t, room.floor).max(low), self.height(t, room.ceiling).min(high));
            if to - from <= unit {
                continue;
            }
            if from - floor.1 > unit {
                parts.push(Item { floor: floor.0, ceiling: room.floor, fill: None });
                floor = (room.floor, from);
            }
            let ceiling = if high - to > unit { room.ceiling } else { item.ceiling };
            parts.push(Item { floor: floor.0, ceiling, fill: Some(label) });
            floor = (ceiling, to);
        }
        if parts.is_empty() {
            return None;
        }
        if floor.0 != item.ceiling {
            parts.push(Item { floor: floor.0, ceiling: item.ceiling, fill: None });
        }
        Some(parts)
    }
}

/// Makes neighbours of one fill one.
fn settle(stack: &mut Vec<Item>) {
    let items = std::mem::take(stack);
    items.into_iter().for_each(|item| push(stack, item));
}
