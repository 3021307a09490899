//! Rooms where none are tagged: air of a storey that walls enclose, its door-sized holes closed.
//!
//! In each storey the plan falls into triangles with a stack of layers over each ([`crate::partition::storeys`]). What one stands in is the
//! lowest layer of air that is high enough. It is *free*, or a *hole* in a wall: above it a lintel, or below it a sill, which are walls; or an
//! opening that is tagged or was found. Free triangles that hang together are a room, unless they reach the open.

mod cutting;
mod halls;
mod meshes;

use std::collections::{BTreeMap, BTreeSet};

use enfilade_importers::{ElementId, Mesh, Model, Role, Semantic};
use glam::DVec3;

use super::DeriveOptions;
use super::matter::Solids;
use super::open_plan::LEAST_PIECE;
use super::passage::{Ground, Union, is_wide};
use crate::lattice::{Plane, Point, double_area};
use crate::partition::storeys::{NONE, Storey, Storeys};
use cutting::edges_on;
pub(super) use cutting::{Line, cuts};
use meshes::{Reach, append};

/// Air lower than this is none to stand in, metres.
const LOW: f64 = 0.4;
/// One stands on what is no higher than this over the storey's floor, metres.
const STEP: f64 = 1.6;
/// A wall below air that is higher than this over the floor is a sill, metres.
const SILL: f64 = 0.25;
/// A wall above air is a lintel if it begins so far below the storey's top, metres.
const LINTEL: f64 = 0.3;
/// Air of neighbours must meet over so much of its height, metres.
const MEETS: f64 = 0.5;
/// Nobody passes what is narrower than this, metres: a gap between walls that do not quite meet.
const SLIT: f64 = 0.25;
/// Walls with holes are thicker than this, metres.
const THINNEST: f64 = 0.05;
/// Air of a room is as wide as this, metres: twice its area by half its border.
const NARROWEST: f64 = 0.4;
/// A room's walls are no lower than this, metres, over most of it.
const LOWEST: f64 = 1.2;
/// What a triangle of the plan is to those who look for rooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Solid,
    Free,
    /// In a wall.
    Hole {
        has_sill: bool,
    },
    /// An opening that is known.
    Opening,
}

/// A triangle: what it is, and the index in its stack of the layer that one stands in.
#[derive(Clone, Copy, Debug)]
struct Spot {
    kind: Kind,
    layer: usize,
    /// From where to where that layer is, over the triangle's middle, lattice units.
    range: [f64; 2],
    /// Between which planes.
    planes: [Plane; 2],
    /// Whether it goes on below the storey, and above it.
    is_open: [bool; 2],
}

/// What fills a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fill {
    Air,
    Opening,
    /// A wall, a column, a beam: what holes are in.
    Wall,
    /// Any other matter.
    Plate,
}

/// Some triangles of a storey that hang together.
#[derive(Clone, Debug, Default)]
struct Patch {
    storey: usize,
    triangles: Vec<u32>,
    /// Square metres.
    area: f64,
    is_outside: bool,
    /// What it has become part of.
    joined: Option<u32>,
}

struct Finder<'a> {
    storeys: &'a Storeys,
    fills: Vec<Vec<Fill>>,
    spots: Vec<Vec<Spot>>,
    /// By storey and triangle: the patch that it is of.
    patch_of: Vec<Vec<u32>>,
    patches: Vec<Patch>,
    /// By storey: edges of triangles that lie on lines along which places are cut, and whether these close gaps in walls.
    cut: Vec<BTreeMap<(u32, u8), bool>>,
}

/// The free part of a storey's plan.
struct Way<'a> {
    finder: &'a Finder<'a>,
    storey: usize,
}

impl Ground for Way<'_> {
    fn corners(&self, triangle: u32) -> [Point; 3] {
        self.finder.storeys.storeys[self.storey].corners(triangle)
    }

    fn beyond(&self, triangle: u32, edge: usize) -> Option<u32> {
        let other = self.finder.storeys.storeys[self.storey].across[triangle as usize][edge];
        let is_free = other != NONE && self.finder.spots[self.storey][other as usize].kind == Kind::Free;
        let is_cut = self.finder.cut[self.storey].contains_key(&(triangle, edge as u8));
        (is_free && !is_cut && self.finder.meet(self.storey, triangle, edge, other)).then_some(other)
    }
}

impl<'a> Finder<'a> {
    fn new(model: &Model, roles: &[Role], storeys: &'a Storeys, cuts: &[Vec<Line>]) -> Finder<'a> {
        let fill = |set: &Vec<ElementId>| {
            let semantic = |e: &ElementId| model.elements[e.0 as usize].semantic;
            let solids = || set.iter().filter(|e| roles[e.0 as usize] == Role::Solid).map(semantic);
            let is_plate = |s| matches!(s, Semantic::Ground | Semantic::Ceiling | Semantic::Roof);
            if solids().any(is_plate) {
                Fill::Plate
            } else if solids().next().is_some() {
                Fill::Wall
            } else if set
                .iter()
                .map(semantic)
                .any(|s| matches!(s, Semantic::Door | Semantic::Window | Semantic::Opening))
            {
                Fill::Opening
            } else {
                Fill::Air
            }
        };
        let fills = storeys.storeys.iter().map(|storey| storey.sets.iter().map(fill).collect()).collect();
        let count = storeys.storeys.len();
        let patch_of = storeys.storeys.iter().map(|storey| vec![NONE; storey.triangles.len()]).collect();
        let none = Vec::new();
        let cut = (0..count).map(|i| edges_on(&storeys.storeys[i], cuts.get(i).unwrap_or(&none))).collect();
        let mut finder = Finder { storeys, fills, spots: Vec::new(), patch_of, patches: Vec::new(), cut };
        finder.spots = crate::parallel::map(count, |i| finder.spots_of(i));
        finder
    }

    fn metres(&self, steps: f64) -> f64 {
        steps * self.storeys.lattice.step()
    }

    /// Square metres.
    fn area(&self, storey: usize, triangle: u32) -> f64 {
        let step = self.storeys.lattice.step();
        double_area(&self.storeys.storeys[storey].corners(triangle)) as f64 / 2.0 * step * step
    }

    fn spots_of(&self, number: usize) -> Vec<Spot> {
        let storey = &self.storeys.storeys[number];
        (0..storey.triangles.len() as u32).map(|t| self.spot(number, storey, t)).collect()
    }

    fn spot(&self, number: usize, storey: &Storey, triangle: u32) -> Spot {
        let stack = storey.stack(triangle);
        let fill = |i: usize| self.fills[number][stack[i].set as usize];
        let [x, y] = middle(storey.corners(triangle));
        let height = |plane: &Plane| plane.height_f64(x, y);
        let [low, high] = storey.levels.map(f64::from);
        let lattice = &self.storeys.lattice;
        let mut i = 0;
        while i < stack.len() {
            // Air that openings share with other air is one layer to those who stand in it.
            let first = i;
            let is_air = |i: usize| matches!(fill(i), Fill::Air | Fill::Opening);
            while i < stack.len() && is_air(i) {
                i += 1;
            }
            if i == first {
                i += 1;
                continue;
            }
            let range = [height(&stack[first].floor), height(&stack[i - 1].ceiling)];
            if range[0] - low > lattice.steps(STEP) {
                break;
            }
            if range[1] - range[0] < lattice.steps(LOW) {
                continue;
            }
            let layers = first..i;
            let widest = layers.clone().max_by(|&a, &b| {
                let size = |i: usize| height(&stack[i].ceiling) - height(&stack[i].floor);
                size(a).total_cmp(&size(b))
            });
            let opened: f64 = layers
                .filter(|&i| fill(i) == Fill::Opening)
                .map(|i| height(&stack[i].ceiling) - height(&stack[i].floor))
                .sum();
            let has_sill = first > 0 && fill(first - 1) == Fill::Wall && range[0] - low > lattice.steps(SILL);
            let has_lintel =
                i < stack.len() && fill(i) == Fill::Wall && high - range[1] > lattice.steps(LINTEL);
            let kind = if opened > 0.5 * (range[1] - range[0]) {
                Kind::Opening
            } else if has_sill || has_lintel {
                Kind::Hole { has_sill }
            } else {
                Kind::Free
            };
            let planes = [stack[first].floor, stack[i - 1].ceiling];
            let is_open = [first == 0, i == stack.len()];
            return Spot { kind, layer: widest.unwrap_or(first), range, planes, is_open };
        }
        Spot {
            kind: Kind::Solid,
            layer: 0,
            range: [0.0; 2],
            planes: [Plane::level(0); 2],
            is_open: [false; 2],
        }
    }

    /// Whether the air of a triangle meets that of the one beyond an edge.
    fn meet(&self, storey: usize, triangle: u32, edge: usize, other: u32) -> bool {
        let corners = self.storeys.storeys[storey].corners(triangle);
        let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
        let [x, y] = [a.x + b.x, a.y + b.y].map(|c| f64::from(c) / 2.0);
        let [one, two] = [triangle, other].map(|t| {
            let [floor, ceiling] = self.spots[storey][t as usize].planes;
            [floor.height_f64(x, y), ceiling.height_f64(x, y)]
        });
        let least = self.storeys.lattice.steps(MEETS).min(0.5 * (one[1] - one[0]).min(two[1] - two[0]));
        one[1].min(two[1]) - one[0].max(two[0]) >= least.max(1.0)
    }

    /// The length of an edge of a triangle, metres.
    fn edge(&self, storey: usize, triangle: u32, edge: usize) -> f64 {
        let corners = self.storeys.storeys[storey].corners(triangle);
        let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
        self.metres(f64::from(a.x - b.x).hypot(f64::from(a.y - b.y)))
    }

    /// Gathers free triangles into patches: those between which one can pass.
    fn gather(&mut self) {
        self.patches.clear();
        for storey in 0..self.storeys.storeys.len() {
            let mut patch_of = self.united(storey);
            let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
            for (t, of) in patch_of.iter_mut().enumerate() {
                if *of == NONE {
                    continue;
                }
                *of = *numbers.entry(*of).or_insert_with(|| {
                    self.patches.push(Patch { storey, ..Patch::default() });
                    self.patches.len() as u32 - 1
                });
                let area = self.area(storey, t as u32);
                let patch = &mut self.patches[*of as usize];
                patch.triangles.push(t as u32);
                patch.area += area;
                patch.is_outside |= self.storeys.storeys[storey].across[t].contains(&NONE);
            }
            self.patch_of[storey] = patch_of;
        }
    }

    /// By triangle of a storey: a number that is the same for those of one patch; [`NONE`] where it is not free.
    fn united(&self, storey: usize) -> Vec<u32> {
        let way = Way { finder: self, storey };
        let count = self.spots[storey].len();
        let width = self.storeys.lattice.steps(SLIT);
        // Of edges that can be crossed, by the lower of its two triangles.
        let name = |t: u32, edge: usize| -> Option<u32> {
            let other = way.beyond(t, edge)?;
            let back =
                self.storeys.storeys[storey].across[other as usize].iter().position(|&back| back == t)?;
            Some(if t < other { 3 * t + edge as u32 } else { 3 * other + back as u32 })
        };
        let is_free = |t: u32| self.spots[storey][t as usize].kind == Kind::Free;
        let mut union = Union::new(3 * count);
        for t in (0..count as u32).filter(|&t| is_free(t)) {
            for around in 0..3 {
                // The edges that meet in a corner are the one from it, and the one to it.
                if let (Some(from), Some(to)) = (name(t, around), name(t, (around + 2) % 3))
                    && is_wide(&way, t, around, width)
                {
                    union.join(from, to);
                }
            }
        }
        let of = |t: u32| {
            if !is_free(t) {
                return NONE;
            }
            let known = (0..3).filter_map(|edge| Some((self.edge(storey, t, edge), name(t, edge)?)));
            let longest = known.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
            // What leads nowhere is of itself.
            longest.map_or(3 * t, |longest| longest.1)
        };
        let mut united: Vec<u32> = (0..count as u32).map(of).collect();
        for i in united.iter_mut().filter(|i| **i != NONE) {
            *i = union.find(*i);
        }
        united
    }

    /// Gives patches that are too narrow to be rooms, and hang together with others by slits alone, to the one with which they share most; and
    /// what was cut off and is too small to be told apart.
    fn join_narrow(&mut self) {
        // Round by round: what hangs on a narrow patch follows it.
        loop {
            let mut into: BTreeMap<u32, u32> = BTreeMap::new();
            for (patch, number) in self.patches.iter().zip(0u32..) {
                let is_small = patch.area < LEAST_PIECE || self.is_bay(patch);
                let is_narrow = self.width(patch) < NARROWEST;
                if patch.triangles.is_empty() || patch.is_outside || !(is_small || is_narrow) {
                    continue;
                }
                let mut beside: BTreeMap<u32, f64> = BTreeMap::new();
                for &t in &patch.triangles {
                    for (edge, other) in
                        self.storeys.storeys[patch.storey].across[t as usize].into_iter().enumerate()
                    {
                        let of =
                            if other == NONE { NONE } else { self.patch_of[patch.storey][other as usize] };
                        let counts = is_narrow || self.cut[patch.storey].contains_key(&(t, edge as u8));
                        if of != NONE && of != number && counts && self.meet(patch.storey, t, edge, other) {
                            *beside.entry(of).or_default() += self.edge(patch.storey, t, edge);
                        }
                    }
                }
                let best = beside.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
                // One of two that would join each other goes.
                if let Some((best, _)) = best.filter(|best| into.get(&best.0) != Some(&number)) {
                    into.insert(number, best);
                }
            }
            if into.is_empty() {
                self.patches.iter_mut().for_each(|patch| patch.triangles.sort_unstable());
                return;
            }
            for (from, to) in into {
                let triangles = std::mem::take(&mut self.patches[from as usize].triangles);
                let area = std::mem::take(&mut self.patches[from as usize].area);
                let storey = self.patches[from as usize].storey;
                // What it was given to may have gone itself.
                let mut to = to;
                while self.patches[to as usize].triangles.is_empty() {
                    match self.patches[to as usize].joined {
                        Some(next) => to = next,
                        None => break,
                    }
                }
                // Around a circle it has come back to itself.
                if to != from {
                    for &t in &triangles {
                        self.patch_of[storey][t as usize] = to;
                    }
                    self.patches[from as usize].joined = Some(to);
                }
                let patch = &mut self.patches[to as usize];
                patch.triangles.extend(triangles);
                patch.area += area;
            }
        }
    }

    /// Whether a patch was cut off where something narrow ends, and no door leads to it: then it is a bay of what it was cut from.
    fn is_bay(&self, patch: &Patch) -> bool {
        let storey = &self.storeys.storeys[patch.storey];
        let (spots, cut) = (&self.spots[patch.storey], &self.cut[patch.storey]);
        let low = f64::from(storey.levels[0]);
        let mut is_cut = false;
        for &t in &patch.triangles {
            for (edge, other) in storey.across[t as usize].into_iter().enumerate() {
                match cut.get(&(t, edge as u8)) {
                    Some(true) => return false,
                    Some(false) => is_cut = true,
                    None if other != NONE => {
                        let spot = spots[other as usize];
                        let is_way = matches!(spot.kind, Kind::Opening | Kind::Hole { has_sill: false });
                        if is_way
                            && self.metres(spot.range[0] - low) <= SILL
                            && self.meet(patch.storey, t, edge, other)
                        {
                            return false;
                        }
                    }
                    None => {}
                }
            }
        }
        is_cut
    }

    /// How wide a patch is, metres: twice its area by half its border.
    fn width(&self, patch: &Patch) -> f64 {
        let mut border = 0.0;
        for &t in &patch.triangles {
            for (edge, other) in self.storeys.storeys[patch.storey].across[t as usize].into_iter().enumerate()
            {
                if other == NONE
                    || self.patch_of[patch.storey][other as usize] != self.patch_of[patch.storey][t as usize]
                {
                    border += self.edge(patch.storey, t, edge);
                }
            }
        }
        2.0 * patch.area / border.max(1e-9)
    }

    /// The holes of all storeys, each as its triangles, and the patches that they touch with the length of what they share, metres.
    fn holes(&self) -> Vec<(Patch, BTreeMap<u32, f64>, bool)> {
        let mut holes = Vec::new();
        for (storey, spots) in self.spots.iter().enumerate() {
            let mut is_seen = vec![false; spots.len()];
            for first in 0..spots.len() as u32 {
                if is_seen[first as usize] || !matches!(spots[first as usize].kind, Kind::Hole { .. }) {
                    continue;
                }
                let (mut hole, mut touches, mut has_sill) =
                    (Patch { storey, ..Patch::default() }, BTreeMap::new(), false);
                let mut waiting = vec![first];
                is_seen[first as usize] = true;
                while let Some(t) = waiting.pop() {
                    hole.triangles.push(t);
                    hole.area += self.area(storey, t);
                    has_sill |= spots[t as usize].kind == Kind::Hole { has_sill: true };
                    for (edge, other) in
                        self.storeys.storeys[storey].across[t as usize].into_iter().enumerate()
                    {
                        if other == NONE || !self.meet(storey, t, edge, other) {
                            continue;
                        }
                        match spots[other as usize].kind {
                            Kind::Free => {
                                let patch = self.patch_of[storey][other as usize];
                                *touches.entry(patch).or_insert(0.0) += self.edge(storey, t, edge);
                            }
                            Kind::Hole { .. } if !std::mem::replace(&mut is_seen[other as usize], true) => {
                                waiting.push(other)
                            }
                            _ => {}
                        }
                    }
                }
                hole.triangles.sort_unstable();
                holes.push((hole, touches, has_sill));
            }
        }
        holes
    }

    /// Opens holes that are no doors: niches of one room, and passages that are wider than `widest` metres.
    fn open_wide(&mut self, widest: f64) {
        let mut opened = Vec::new();
        for (hole, touches, has_sill) in self.holes() {
            // As much as it shares with the second of what it lies between: with more, slivers along the wall count, too.
            let mut widths: Vec<f64> = touches.values().copied().collect();
            widths.sort_by(|a, b| b.total_cmp(a));
            if widths.len() < 2 || (!has_sill && widths[1] > widest) || hole.area < THINNEST * widths[1] {
                opened.push(hole);
            }
        }
        for hole in opened {
            for t in hole.triangles {
                self.spots[hole.storey][t as usize].kind = Kind::Free;
            }
        }
    }

    /// Whether a patch is a room by its size.
    fn is_room(&self, patch: &Patch, least_area: f64) -> bool {
        if patch.is_outside || patch.area < least_area {
            return false;
        }
        let mut high = 0.0;
        for &t in &patch.triangles {
            let [from, to] = self.spots[patch.storey][t as usize].range;
            if self.metres(to - from) >= LOWEST {
                high += self.area(patch.storey, t);
            }
        }
        self.width(patch) >= NARROWEST && high >= 0.5 * patch.area
    }
}

fn middle(corners: [Point; 3]) -> [f64; 2] {
    let sum = |c: fn(&Point) -> i32| corners.iter().map(|p| f64::from(c(p))).sum::<f64>() / 3.0;
    [sum(|p| p.x), sum(|p| p.y)]
}

/// The rooms and openings of a model as they were found: by storey, in the plan from the upper left to the lower right.
pub(super) struct Found {
    pub(super) rooms: Vec<FoundRoom>,
    pub(super) holes: Vec<FoundHole>,
}

/// A room.
pub(super) struct FoundRoom {
    /// The lowest storey that it is in.
    pub(super) storey: usize,
    pub(super) mesh: Mesh,
}

/// A hole in a wall that nothing fills.
pub(super) struct FoundHole {
    pub(super) storey: usize,
    /// What it is in.
    pub(super) host: Option<ElementId>,
    pub(super) mesh: Mesh,
}

impl<'a> Finder<'a> {
    /// With patches that are told to be rooms or outside.
    fn of(
        model: &Model,
        roles: &[Role],
        storeys: &'a Storeys,
        cuts: &[Vec<Line>],
        options: &DeriveOptions,
    ) -> Finder<'a> {
        let mut finder = Finder::new(model, roles, storeys, cuts);
        finder.gather();
        finder.open_wide(options.widest_hole);
        finder.gather();
        finder.join_narrow();
        finder.tell_courts(model, roles);
        finder
    }
}

/// Finds rooms, and holes between them that nothing fills; `cuts` are lines of the storeys' plans.
pub(super) fn find(
    model: &Model,
    roles: &[Role],
    storeys: &Storeys,
    cuts: &[Vec<Line>],
    options: &DeriveOptions,
) -> Found {
    let finder = Finder::of(model, roles, storeys, cuts, options);
    let is_room = |number: &u32| finder.is_room(&finder.patches[*number as usize], options.least_area);
    let rooms: BTreeSet<u32> = (0..finder.patches.len() as u32).filter(is_room).collect();
    let mut groups: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut union = finder.one_above_the_other(&rooms);
    for &room in &rooms {
        groups.entry(union.find(room)).or_default().push(room);
    }
    let mut found: Vec<((usize, [i64; 2]), FoundRoom)> = Vec::new();
    for group in groups.values() {
        let mut mesh = Mesh::default();
        for &number in group {
            let patch = &finder.patches[number as usize];
            append(&mut mesh, finder.mesh(patch, |t| finder.reach(patch.storey, t)));
        }
        let lowest = &finder.patches[group[0] as usize];
        found.push(((lowest.storey, finder.place(lowest)), FoundRoom { storey: lowest.storey, mesh }));
    }
    found.sort_by_key(|room| room.0);
    let mut holes: Vec<((usize, [i64; 2]), FoundHole)> = Vec::new();
    for (hole, touches, _) in finder.holes() {
        let is_outside = |patch: &u32| finder.patches[*patch as usize].is_outside;
        let leads_to = touches.keys().filter(|patch| rooms.contains(patch)).count();
        if leads_to == 0 || leads_to + usize::from(touches.keys().any(is_outside)) < 2 {
            continue;
        }
        let spots = &finder.spots[hole.storey];
        let mesh = finder.mesh(&hole, |t| {
            let [low, high] = spots[t as usize].planes;
            Reach { low, high }
        });
        let host = finder.host(&hole, roles);
        holes.push(((hole.storey, finder.place(&hole)), FoundHole { storey: hole.storey, host, mesh }));
    }
    holes.sort_by_key(|hole| hole.0);
    Found {
        rooms: found.into_iter().map(|room| room.1).collect(),
        holes: holes.into_iter().map(|hole| hole.1).collect(),
    }
}

/// Triangles that are looked at to tell whether something is above a patch.
const LOOKED_AT: usize = 24;

impl Finder<'_> {
    /// Where a patch is in the order of rooms: rows from the far end of the plan, metres.
    fn place(&self, patch: &Patch) -> [i64; 2] {
        let (mut sum, mut weight) = ([0.0; 2], 0.0);
        for &t in &patch.triangles {
            let (area, [x, y]) =
                (self.area(patch.storey, t), middle(self.storeys.storeys[patch.storey].corners(t)));
            sum = [sum[0] + area * x, sum[1] + area * y];
            weight += area;
        }
        let [x, y] = sum.map(|c| c / f64::max(weight, 1e-12));
        let [x, y, _] = self.storeys.lattice.metres([x, y, 0.0]);
        [-(y.round() as i64), (x * 1000.0).round() as i64]
    }

    /// The wall that a hole is in: what most of it has above or below.
    fn host(&self, hole: &Patch, roles: &[Role]) -> Option<ElementId> {
        let storey = &self.storeys.storeys[hole.storey];
        let mut areas: BTreeMap<ElementId, f64> = BTreeMap::new();
        for &t in &hole.triangles {
            let (stack, [floor, ceiling]) = (storey.stack(t), self.spots[hole.storey][t as usize].planes);
            let around = stack.iter().filter(|layer| layer.floor == ceiling || layer.ceiling == floor);
            for layer in around.filter(|layer| self.fills[hole.storey][layer.set as usize] == Fill::Wall) {
                for &element in
                    storey.sets[layer.set as usize].iter().filter(|e| roles[e.0 as usize] == Role::Solid)
                {
                    *areas.entry(element).or_default() += self.area(hole.storey, t);
                }
            }
        }
        areas.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|most| most.0)
    }

    /// Patches under the open sky are outside, unless hardly any has a floor or a roof above: suspended ceilings are none.
    fn tell_courts(&mut self, model: &Model, roles: &[Role]) {
        let is_roof =
            |role: &Role, semantic| if semantic == Semantic::Ceiling { Role::Detail } else { *role };
        let roofs: Vec<Role> =
            roles.iter().zip(&model.elements).map(|(role, e)| is_roof(role, e.semantic)).collect();
        let solids = Solids::of(model, &roofs);
        let lattice = &self.storeys.lattice;
        let share = |patch: &Patch| -> f64 {
            let storey = &self.storeys.storeys[patch.storey];
            let mut largest: Vec<(f64, u32)> =
                patch.triangles.iter().map(|&t| (self.area(patch.storey, t), t)).collect();
            largest.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            largest.truncate(LOOKED_AT);
            let (mut covered, mut all) = (0.0, 0.0);
            for (area, t) in largest {
                all += area;
                let [x, y] = middle(storey.corners(t));
                let [low, high] = self.spots[patch.storey][t as usize].range;
                let start = DVec3::from(lattice.metres([x, y, (low + high) / 2.0]));
                if solids.above(start).first(start, DVec3::Z).is_some() {
                    covered += area;
                }
            }
            covered / f64::max(all, 1e-12)
        };
        let inside = |patch: &&Patch| !patch.is_outside && !patch.triangles.is_empty() && patch.area >= 1.0;
        let shares: Vec<Option<f64>> =
            self.patches.iter().map(|patch| inside(&patch).then(|| share(patch))).collect();
        let areas = |least: f64| -> f64 {
            let known = self
                .patches
                .iter()
                .zip(&shares)
                .filter(|(_, share)| share.is_some_and(|share| share >= least));
            known.map(|(patch, _)| patch.area).sum()
        };
        if areas(0.5) < 0.5 * areas(0.0) {
            return;
        }
        for (patch, share) in self.patches.iter_mut().zip(shares) {
            patch.is_outside |= share.is_some_and(|share| share < 0.5);
        }
    }
}
