//! Regions: the parts of the plan over which one interval goes on, and the prisms with convex footprints they are cut into.
//!
//! First links between equal stacks are dropped and what is left is straightened: chains are shared by all that lie
//! beside them, so that nothing comes apart. Then the plan is triangulated again, triangles of equal floor, ceiling and
//! fill are united, and each union is cut anew into few convex parts.

use std::collections::HashMap;

use super::cells::Label;
use super::convex::{self, Convexification};
use super::moved::Moved;
use super::plan::{Conflict, NONE, Plan, triangulate};
use super::stacks::{Item, Stacks};
use super::straighten::straighten;
use crate::lattice::{Lattice, Point, is_between, orient};

/// Bends smaller than this are made straight, metres.
const STRAIGHT: f64 = 5e-5;

/// A plan with one stack for each triangle, as few triangles as the stacks allow.
pub(super) struct Simple {
    pub(super) plan: Plan,
    /// Index into `kinds` for each triangle.
    pub(super) kind: Vec<u32>,
    /// Different stacks.
    pub(super) kinds: Vec<Vec<Item>>,
    /// What straightening moved.
    pub(super) straightened: Moved,
}

/// Drops what separates equal stacks, and straightens the rest.
pub(super) fn simplify(plan: &Plan, stacks: Stacks, lattice: &Lattice) -> Result<Simple, Conflict> {
    let mut index: HashMap<Vec<Item>, u32> = HashMap::new();
    let mut kinds: Vec<Vec<Item>> = Vec::new();
    let kind: Vec<u32> = stacks
        .into_iter()
        .map(|stack| {
            *index.entry(stack).or_insert_with_key(|stack| {
                kinds.push(stack.clone());
                kinds.len() as u32 - 1
            })
        })
        .collect();
    // Links between different kinds, with the kinds on the left and right of the link from its lesser vertex.
    let mut borders: Vec<([u32; 2], [u32; 2])> = Vec::new();
    for t in 0..plan.triangles.len() {
        for i in 0..3 {
            let other = plan.across[t][i];
            let (a, b) = (plan.triangles[t][i], plan.triangles[t][(i + 1) % 3]);
            let beyond = if other == NONE { NONE } else { kind[other as usize] };
            if other == NONE || (t < other as usize && beyond != kind[t]) {
                let sides = if a < b { [kind[t], beyond] } else { [beyond, kind[t]] };
                borders.push(([a.min(b), a.max(b)], sides));
            }
        }
    }
    borders.sort_unstable();
    let links: Vec<[u32; 2]> = borders.iter().map(|b| b.0).collect();
    let mut pairs: HashMap<[u32; 2], u32> = HashMap::new();
    let class: Vec<u32> = borders
        .iter()
        .map(|(_, [l, r])| {
            let next = pairs.len() as u32;
            *pairs.entry([*l.min(r), *l.max(r)]).or_insert(next)
        })
        .collect();
    let keep = vec![true; links.len()];
    let straight = straighten(&plan.points, &links, &class, &keep, lattice.steps(STRAIGHT));

    // The kinds beside each new link, seen from its lesser vertex.
    let mut sides = vec![[NONE; 2]; straight.links.len()];
    for (old, step) in straight.of.iter().enumerate() {
        if let Some(step) = step {
            let [l, r] = borders[old].1;
            sides[step.link as usize] = if step.forward { [l, r] } else { [r, l] };
        }
    }
    let mut order: Vec<u32> = (0..straight.links.len() as u32).collect();
    let sorted = |link: u32| {
        let [a, b] = straight.links[link as usize];
        [a.min(b), a.max(b)]
    };
    order.sort_unstable_by_key(|&link| sorted(link));
    let links: Vec<[u32; 2]> = order.iter().map(|&link| sorted(link)).collect();
    let sides: Vec<[u32; 2]> = order
        .iter()
        .map(|&link| {
            let [a, b] = straight.links[link as usize];
            let [l, r] = sides[link as usize];
            if a < b { [l, r] } else { [r, l] }
        })
        .collect();
    let new = triangulate(straight.vertices, &links)?;
    let kind = spread(&new, &sides);
    let straightened = Moved { count: u64::from(straight.removed), farthest: straight.largest_displacement };
    Ok(Simple { plan: new, kind, kinds, straightened })
}

/// The kind of every triangle, from the kinds beside the links.
fn spread(plan: &Plan, sides: &[[u32; 2]]) -> Vec<u32> {
    let mut kind = vec![NONE; plan.triangles.len()];
    let mut waiting: Vec<u32> = Vec::new();
    for t in 0..plan.triangles.len() {
        for i in 0..3 {
            let link = plan.links[t][i];
            if link != NONE && kind[t] == NONE {
                let forward = plan.triangles[t][i] < plan.triangles[t][(i + 1) % 3];
                kind[t] = sides[link as usize][usize::from(!forward)];
                waiting.push(t as u32);
            }
        }
    }
    while let Some(t) = waiting.pop() {
        for i in 0..3 {
            let other = plan.across[t as usize][i];
            if other != NONE && plan.links[t as usize][i] == NONE && kind[other as usize] == NONE {
                kind[other as usize] = kind[t as usize];
                waiting.push(other);
            }
        }
    }
    kind
}

/// A prism: a convex footprint of a region.
#[derive(Clone, Debug)]
pub(super) struct Prism {
    /// Index of its region.
    pub(super) region: u32,
    /// Its footprint, counter-clockwise, as indices of the plan's points.
    pub(super) footprint: Vec<u32>,
}

/// An edge of a triangle of the plan, seen from one of its items.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Side {
    pub(super) triangle: u32,
    pub(super) edge: u32,
}

/// All regions of a slab and the prisms that they are cut into.
pub(super) struct Regions {
    /// First node of each triangle: node `starts[t] + k` is item k over triangle t.
    starts: Vec<u32>,
    /// The region of each node.
    region: Vec<u32>,
    /// What each region is.
    pub(super) items: Vec<Item>,
    pub(super) prisms: Vec<Prism>,
    /// For each region's border edge (from point, to point): the sides that it runs along, in order.
    pub(super) borders: HashMap<(u32, u32, u32), Vec<Side>>,
}

impl Regions {
    pub(super) fn of(&self, triangle: u32, item: usize) -> u32 {
        self.region[self.starts[triangle as usize] as usize + item]
    }
}

/// Unites the items of neighbouring triangles into regions, and cuts those into prisms. The plan gets the points that this needs.
pub(super) fn unite(simple: &mut Simple, how: Convexification) -> Result<Regions, Conflict> {
    let mut points = simple.plan.points.clone();
    let plan = &simple.plan;
    let stack = |t: u32| -> &[Item] { &simple.kinds[simple.kind[t as usize] as usize] };
    let mut starts = vec![0u32];
    for t in 0..plan.triangles.len() as u32 {
        starts.push(starts[t as usize] + stack(t).len() as u32);
    }
    let count = starts[plan.triangles.len()] as usize;
    let mut region = vec![NONE; count];
    let mut items = Vec::new();
    let mut members: Vec<Vec<u32>> = Vec::new();
    let mut waiting: Vec<(u32, u32)> = Vec::new();
    for t in 0..plan.triangles.len() as u32 {
        for k in 0..stack(t).len() as u32 {
            if region[(starts[t as usize] + k) as usize] != NONE {
                continue;
            }
            let (id, item) = (items.len() as u32, stack(t)[k as usize]);
            items.push(item);
            members.push(Vec::new());
            region[(starts[t as usize] + k) as usize] = id;
            waiting.push((t, k));
            while let Some((t, _)) = waiting.pop() {
                members[id as usize].push(t);
                for other in plan.across[t as usize] {
                    if other == NONE {
                        continue;
                    }
                    if let Some(j) = stack(other).iter().position(|i| *i == item) {
                        let slot = &mut region[(starts[other as usize] + j as u32) as usize];
                        if *slot == NONE {
                            *slot = id;
                            waiting.push((other, j as u32));
                        }
                    }
                }
            }
        }
    }
    let mut regions = Regions { starts, region, items, prisms: Vec::new(), borders: HashMap::new() };
    let mut inside = vec![NONE; plan.triangles.len()];
    for (id, members) in members.iter().enumerate() {
        members.iter().for_each(|&t| inside[t as usize] = id as u32);
        let loops = loops(plan, members, &inside, id as u32);
        let mut chains = Vec::with_capacity(loops.len());
        for sides in loops {
            let (chain, along) = straight_chain(plan, &sides);
            for (i, along) in along.into_iter().enumerate() {
                let (a, b) = (chain[i], chain[(i + 1) % chain.len()]);
                regions.borders.insert((id as u32, a, b), along);
            }
            chains.push(chain);
        }
        let is_air = !matches!(regions.items[id].fill, Some(Label::Solid(_)));
        let parts = convex::cut(&chains, &mut points, how, is_air).map_err(|_| Conflict)?;
        let prisms = parts.into_iter().map(|footprint| Prism { region: id as u32, footprint });
        regions.prisms.extend(prisms);
    }
    simple.plan.points = points;
    Ok(regions)
}

/// The border of a set of triangles as loops of sides, the set on the left; where loops touch at a point they are
/// taken apart so that each goes around what hangs together by edges.
fn loops(plan: &Plan, members: &[u32], inside: &[u32], id: u32) -> Vec<Vec<Side>> {
    let is_in = |t: u32| t != NONE && inside[t as usize] == id;
    let mut done: std::collections::HashSet<Side> = std::collections::HashSet::new();
    let mut loops = Vec::new();
    let mut sorted = members.to_vec();
    sorted.sort_unstable();
    for &t in &sorted {
        for edge in 0..3 {
            let first = Side { triangle: t, edge };
            if is_in(plan.across[t as usize][edge as usize]) || done.contains(&first) {
                continue;
            }
            let mut sides = Vec::new();
            let mut side = first;
            loop {
                done.insert(side);
                sides.push(side);
                // Turn about the side's end through the set until its border is met again.
                let mut next = Side { triangle: side.triangle, edge: (side.edge + 1) % 3 };
                loop {
                    let other = plan.across[next.triangle as usize][next.edge as usize];
                    if !is_in(other) {
                        break;
                    }
                    let back = plan.across[other as usize].iter().position(|&o| o == next.triangle);
                    // Two triangles may share two edges only if they are one: never in a triangulation.
                    let back = back.unwrap_or(0) as u32;
                    next = Side { triangle: other, edge: (back + 1) % 3 };
                }
                side = next;
                if side == first {
                    break;
                }
            }
            loops.push(sides);
        }
    }
    loops
}

/// A loop without the points on straight lines: its points, and for each edge the sides along it.
fn straight_chain(plan: &Plan, sides: &[Side]) -> (Vec<u32>, Vec<Vec<Side>>) {
    let start = |side: &Side| plan.triangles[side.triangle as usize][side.edge as usize];
    let point = |v: u32| -> Point { plan.points[v as usize] };
    let n = sides.len();
    let mut visits: HashMap<u32, u32> = HashMap::new();
    sides.iter().for_each(|side| *visits.entry(start(side)).or_default() += 1);
    let is_corner = |i: usize| {
        let (before, here, after) =
            (start(&sides[(i + n - 1) % n]), start(&sides[i]), start(&sides[(i + 1) % n]));
        let straight = orient(point(before), point(here), point(after)) == 0
            && is_between(point(before), point(after), point(here));
        !straight || visits[&here] > 1
    };
    let corners: Vec<usize> = (0..n).filter(|&i| is_corner(i)).collect();
    let mut chain = Vec::with_capacity(corners.len());
    let mut along = Vec::with_capacity(corners.len());
    for (c, &i) in corners.iter().enumerate() {
        let end = if c + 1 < corners.len() { corners[c + 1] } else { corners[0] + n };
        chain.push(start(&sides[i]));
        along.push((i..end).map(|j| sides[j % n]).collect());
    }
    (chain, along)
}
