//! Stacks of labelled intervals over the triangles of a plan, and the thin unlabelled air that joins the room beside it.
//!
//! Rooms are seldom drawn as far as the surfaces around them: between a room's label and its walls are gaps of a tenth of
//! a millimetre to some centimetres. What is that thin and lies beside a room becomes part of it, so that the room's
//! cells end on the surfaces themselves.

use super::cells::Label;
use super::columns::{Columns, Interval};
use super::labels::{Labels, volume};
use super::plan::{NONE, Plan};
use crate::lattice::{FINE, Lattice, Point, double_area};

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

/// Joins thin unlabelled air to the rooms beside it. Nothing is joined that lies farther than [`THIN`] from what was the
/// room's before, so that a shaft or a court does not fill up sliver by sliver.
pub(super) fn join_slivers(
    plan: &Plan,
    columns: &Columns,
    labels: &Labels,
    lattice: &Lattice,
    is_room: &dyn Fn(Label) -> bool,
    stacks: &mut Stacks,
) -> Vec<(Label, Joined)> {
    let mut joiner = Joiner {
        plan,
        columns,
        fills: columns.sets.iter().map(|set| labels.of(set)).collect(),
        thin: lattice.steps(THIN),
        is_room,
        joined: std::collections::BTreeMap::new(),
        seen: Vec::new(),
        last_seen: vec![0; stacks.len()],
        search: 0,
        found: vec![NONE; stacks.len()],
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
    /// By set of bodies.
    fills: Vec<Option<Label>>,
    thin: f64,
    is_room: &'a dyn Fn(Label) -> bool,
    joined: std::collections::BTreeMap<Label, Joined>,
    /// Triangles looked at by [`Joiner::is_near`].
    seen: Vec<u32>,
    /// By triangle: the search that last found it.
    last_seen: Vec<u32>,
    /// Searches so far.
    search: u32,
    /// By triangle: where the last search from it that found a room ended.
    found: Vec<u32>,
}

impl Joiner<'_> {
    fn room(&self, item: &Item) -> Option<Label> {
        item.fill.filter(|&label| (self.is_room)(label))
    }

    /// Heights of a plane over the corners of a triangle, lattice units.
    fn heights(&self, t: u32, plane: u32) -> [f64; 3] {
        let plane = &self.columns.planes[plane as usize];
        self.plan.corners(t).map(|c| plane.height(c) as f64 / FINE as f64)
    }

    /// Height of a plane over the middle of a triangle, lattice units.
    fn height(&self, t: u32, plane: u32) -> f64 {
        self.heights(t, plane).iter().sum::<f64>() / 3.0
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
                    && let Some(parts) = self.parts(t, i, item, &stacks[other as usize])
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

    /// What becomes of an unlabelled item over a triangle: the parts of it that lie beside rooms across edge `edge` are
    /// theirs. `None` if no room lies beside it.
    fn parts(&mut self, t: u32, edge: usize, item: Item, beside: &[Item]) -> Option<Vec<Item>> {
        let mut parts: Vec<Item> = Vec::new();
        let mut floor = item.floor;
        for room in beside {
            let Some(label) = self.room(room) else { continue };
            // Where the room's planes would leave less than a unit, or pass through the item's, the item's serve.
            let Some(gap) = self.gap(t, floor, room.floor) else { continue };
            let Some(rest) = self.gap(t, room.ceiling, item.ceiling) else { continue };
            let part = Item {
                floor: if gap { room.floor } else { floor },
                ceiling: if rest { room.ceiling } else { item.ceiling },
                fill: Some(label),
            };
            if !self.is_open(t, edge, part) || !self.is_all_near(t, edge, part, label) {
                continue;
            }
            if gap {
                parts.push(Item { floor, ceiling: room.floor, fill: None });
            }
            parts.push(part);
            floor = part.ceiling;
            if !rest {
                break;
            }
        }
        if parts.is_empty() {
            return None;
        }
        if floor != item.ceiling {
            parts.push(Item { floor, ceiling: item.ceiling, fill: None });
        }
        Some(parts)
    }

    /// Whether there is a gap between two planes over a triangle, from `low` up to `high`. `None` if they pass through
    /// each other, so that there is one here and none there, and it is not thin.
    fn gap(&self, t: u32, low: u32, high: u32) -> Option<bool> {
        let (low, high) = (self.heights(t, low), self.heights(t, high));
        let rise = [0, 1, 2].map(|i| high[i] - low[i]);
        let (least, most) = (rise[0].min(rise[1]).min(rise[2]), rise[0].max(rise[1]).max(rise[2]));
        if least >= 0.0 && rise.iter().sum::<f64>() > 3.0 * UNIT {
            Some(true)
        } else {
            (most < self.thin).then_some(false)
        }
    }

    /// Whether an item has height: over the triangle, nowhere upside down, and over one of its edges.
    fn is_open(&self, t: u32, edge: usize, item: Item) -> bool {
        let (low, high) = (self.heights(t, item.floor), self.heights(t, item.ceiling));
        let rise = [0, 1, 2].map(|i| high[i] - low[i]);
        rise.iter().all(|&rise| rise > -UNIT)
            && rise.iter().sum::<f64>() > 3.0 * UNIT
            && rise[edge] + rise[(edge + 1) % 3] > 2.0 * UNIT
    }

    /// Whether all of a triangle that `edge` does not bound already lies near what was a room's before.
    fn is_all_near(&mut self, t: u32, edge: usize, item: Item, label: Label) -> bool {
        let at = |p: Point| [f64::from(p.x), f64::from(p.y)];
        let [a, b] = [edge, (edge + 1) % 3].map(|i| at(self.plan.corners(t)[i]));
        let apex = at(self.plan.corners(t)[(edge + 2) % 3]);
        let middle = |p: [f64; 2], q: [f64; 2]| [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0];
        let points = [apex, middle(apex, a), middle(apex, b), middle(apex, middle(a, b))];
        let other = self.plan.across[t as usize][edge];
        points.into_iter().all(|p| self.is_near([t, other], p, item, label))
    }

    /// Whether what was a room's before lies near all of an item that stands over a point of `t`, beside `other`.
    fn is_near(&mut self, [t, other]: [u32; 2], p: [f64; 2], item: Item, label: Label) -> bool {
        let [low, high] = [item.floor, item.ceiling]
            .map(|plane| self.columns.planes[plane as usize].height_f64(p[0], p[1]));
        // Where it was near another point of the triangle, or those of the one beside it, it mostly is near this.
        for guess in [self.found[t as usize], self.found[other as usize], other] {
            if guess != NONE
                && square_between(p, nearest(self.plan.corners(guess), p)) < self.thin * self.thin
                && self.is_rooms_over(guess, p, [low, high], label)
            {
                self.found[t as usize] = guess;
                return true;
            }
        }
        self.seen.clear();
        self.seen.push(t);
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            self.last_seen.fill(0);
            self.search = 1;
        }
        self.last_seen[t as usize] = self.search;
        let mut next = 0;
        while next < self.seen.len().min(MOST_LOOKED_AT) {
            let here = self.seen[next];
            next += 1;
            if self.is_rooms_over(here, p, [low, high], label) {
                self.found[t as usize] = here;
                return true;
            }
            let corners = self.plan.corners(here);
            for i in 0..3 {
                let other = self.plan.across[here as usize][i];
                if other != NONE
                    && self.last_seen[other as usize] != self.search
                    && square_distance(corners[i], corners[(i + 1) % 3], p) < self.thin * self.thin
                {
                    self.last_seen[other as usize] = self.search;
                    self.seen.push(other);
                }
            }
        }
        false
    }

    /// Whether what was a room's before reaches, over a triangle, about as far down and up as `low` and `high`.
    fn is_rooms_over(&self, t: u32, p: [f64; 2], [low, high]: [f64; 2], label: Label) -> bool {
        let is_rooms = |interval: &Interval| self.fills[interval.set as usize] == Some(label);
        let stack = self.columns.stack(t);
        if !stack.iter().any(is_rooms) {
            return false;
        }
        // Heights may differ much over a triangle: those at the place next to the point count.
        let at = nearest(self.plan.corners(t), p);
        let height = |plane: u32| self.columns.planes[plane as usize].height_f64(at[0], at[1]);
        stack.chunk_by(|a, b| is_rooms(a) == is_rooms(b)).any(|part| {
            is_rooms(&part[0])
                && height(part[0].floor) < low + self.thin
                && height(part[part.len() - 1].ceiling) > high - self.thin
        })
    }
}

/// One lattice unit: lower intervals are none.
const UNIT: f64 = 1.0;
/// Triangles looked at around a point: where there are more within a few centimetres, a room is near only if it is where it was found
/// from beside.
const MOST_LOOKED_AT: usize = 256;

/// The point of a segment next to another.
fn nearest_on(a: Point, b: Point, p: [f64; 2]) -> [f64; 2] {
    let (ax, ay) = (f64::from(a.x), f64::from(a.y));
    let (dx, dy) = (f64::from(b.x) - ax, f64::from(b.y) - ay);
    let along = ((p[0] - ax) * dx + (p[1] - ay) * dy) / (dx * dx + dy * dy);
    let along = along.clamp(0.0, 1.0);
    [ax + along * dx, ay + along * dy]
}

/// The square of the distance of a point from a segment.
fn square_distance(a: Point, b: Point, p: [f64; 2]) -> f64 {
    square_between(p, nearest_on(a, b, p))
}

fn square_between(p: [f64; 2], q: [f64; 2]) -> f64 {
    let (x, y) = (p[0] - q[0], p[1] - q[1]);
    x * x + y * y
}

/// The point of a counter-clockwise triangle next to another.
fn nearest(corners: [Point; 3], p: [f64; 2]) -> [f64; 2] {
    let side = |a: Point, b: Point| {
        let (dx, dy) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
        dx * (p[1] - f64::from(a.y)) - dy * (p[0] - f64::from(a.x))
    };
    let sides = [0, 1, 2].map(|i| (corners[i], corners[(i + 1) % 3]));
    if sides.iter().all(|&(a, b)| side(a, b) >= 0.0) {
        return p;
    }
    let on = sides.map(|(a, b)| nearest_on(a, b, p));
    let off = |q: &[f64; 2]| square_between(p, *q);
    on.into_iter().min_by(|q, r| off(q).total_cmp(&off(r))).unwrap_or(p)
}

/// Makes neighbours of one fill one.
fn settle(stack: &mut Vec<Item>) {
    let items = std::mem::take(stack);
    items.into_iter().for_each(|item| push(stack, item));
}
