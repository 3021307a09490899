//! From prisms to cells: what lies beyond each part of their sides, floors and ceilings.

use std::collections::HashMap;
use std::ops::Range;

use enfilade_importers::ElementId;

use super::cells::{Cell, Cover, Face, Label, NONE, Partition, Section};
use super::overlap::Overlaps;
use super::regions::{Regions, Side, Simple};
use super::stacks::Item;
use crate::lattice::{Lattice, Plane, Point};

/// A slab cut into prisms.
pub(super) struct Built {
    pub(super) simple: Simple,
    pub(super) regions: Regions,
    /// Its own planes: the lower level, the upper level, others.
    pub(super) planes: Vec<Plane>,
}

/// Puts the slabs together, from the lowest to the highest. Air without a label is void until [`tell_exterior`] says otherwise.
pub(super) fn assemble(
    lattice: Lattice,
    hull: [[i32; 3]; 2],
    slabs: &[Built],
    detail: Vec<(ElementId, u32)>,
) -> Partition {
    let mut partition = Partition {
        lattice,
        hull,
        planes: Vec::new(),
        cells: Vec::new(),
        sections: Vec::new(),
        faces: Vec::new(),
        covers: Vec::new(),
        sources: Vec::new(),
        detail,
    };
    let mut index: HashMap<Plane, u32> = HashMap::new();
    let mut firsts = Vec::with_capacity(slabs.len());
    for slab in slabs {
        let planes: Vec<u32> = slab
            .planes
            .iter()
            .map(|plane| {
                *index.entry(*plane).or_insert_with(|| {
                    partition.planes.push(*plane);
                    partition.planes.len() as u32 - 1
                })
            })
            .collect();
        firsts.push(partition.cells.len() as u32);
        Sides::new(slab, partition.cells.len() as u32).add(&planes, &mut partition);
    }
    cover(slabs, &firsts, &mut partition);
    partition
}

/// Finds what lies beyond the sides of a slab's prisms.
struct Sides<'a> {
    slab: &'a Built,
    first: u32,
    /// The prism inside a border's side, by region and side.
    at_side: HashMap<(u32, Side), u32>,
    /// The prism on the left of an edge, by region and edge.
    at_edge: HashMap<(u32, u32, u32), u32>,
}

impl<'a> Sides<'a> {
    fn new(slab: &'a Built, first: u32) -> Sides<'a> {
        let mut sides = Sides { slab, first, at_side: HashMap::new(), at_edge: HashMap::new() };
        for (p, prism) in slab.regions.prisms.iter().enumerate() {
            let p = p as u32;
            for (i, &a) in prism.footprint.iter().enumerate() {
                let b = prism.footprint[(i + 1) % prism.footprint.len()];
                let key = (prism.region, a, b);
                sides.at_edge.insert(key, p);
                for &side in slab.regions.borders.get(&key).into_iter().flatten() {
                    sides.at_side.insert((prism.region, side), p);
                }
            }
        }
        sides
    }

    fn add(&self, planes: &[u32], partition: &mut Partition) {
        let regions = &self.slab.regions;
        for prism in &regions.prisms {
            let item = regions.items[prism.region as usize];
            let first_section = partition.sections.len() as u32;
            for (i, &a) in prism.footprint.iter().enumerate() {
                let b = prism.footprint[(i + 1) % prism.footprint.len()];
                match regions.borders.get(&(prism.region, a, b)) {
                    None => {
                        let beyond = self.at_edge.get(&(prism.region, b, a));
                        let cell = beyond.map_or(NONE, |p| self.first + p);
                        let faces = vec![Face { top: NONE, cover: Cover { cell, source: NONE } }];
                        push(partition, self.point(a), &faces);
                    }
                    Some(sides) => {
                        let mut before: Vec<Face> = Vec::new();
                        for &side in sides {
                            let start =
                                self.slab.simple.plan.triangles[side.triangle as usize][side.edge as usize];
                            let faces = self.faces(item, side, planes);
                            // What goes on straight with the same beyond it is one section.
                            if faces != before {
                                push(partition, self.point(start), &faces);
                            }
                            before = faces;
                        }
                    }
                }
            }
            partition.cells.push(Cell {
                label: item.fill.unwrap_or(Label::Void),
                floor: planes[item.floor as usize],
                ceiling: planes[item.ceiling as usize],
                sections: first_section..partition.sections.len() as u32,
                below: 0..0,
                above: 0..0,
            });
        }
    }

    fn point(&self, v: u32) -> Point {
        self.slab.simple.plan.points[v as usize]
    }

    /// What lies beyond a side of an item, from the floor up.
    fn faces(&self, item: Item, side: Side, planes: &[u32]) -> Vec<Face> {
        let simple = &self.slab.simple;
        let other = simple.plan.across[side.triangle as usize][side.edge as usize];
        if other == NONE {
            return vec![Face { top: NONE, cover: Cover { cell: NONE, source: NONE } }];
        }
        let corners = simple.plan.triangles[side.triangle as usize];
        let ends =
            [corners[side.edge as usize], corners[(side.edge as usize + 1) % 3]].map(|v| self.point(v));
        let heights = |plane: u32| heights(&self.slab.planes[plane as usize], ends);
        let (floor, ceiling) = (heights(item.floor), heights(item.ceiling));
        let back = simple.plan.across[other as usize].iter().position(|&t| t == side.triangle).unwrap_or(0);
        let beyond = Side { triangle: other, edge: back as u32 };
        let stack = &simple.kinds[simple.kind[other as usize] as usize];
        let cell = |k: usize| {
            let region = self.slab.regions.of(other, k);
            let prism = self.at_side.get(&(region, beyond)).copied();
            prism.or_else(|| self.prism_about(region, ends)).map_or(NONE, |p| self.first + p)
        };
        // Upwards, all that has some of the side. Planes may cross over the edge.
        let mut faces: Vec<Face> = Vec::new();
        let mut lows = vec![floor];
        for (k, there) in stack.iter().enumerate() {
            let high = heights(there.ceiling);
            let is_last = k + 1 == stack.len() || (0..2).all(|end| high[end] >= ceiling[end]);
            if reaches(&lows, [high, ceiling]) || (is_last && faces.is_empty()) {
                let top = if is_last { NONE } else { planes[there.ceiling as usize] };
                faces.push(Face { top, cover: Cover { cell: cell(k), source: NONE } });
            }
            if is_last {
                break;
            }
            raise(&mut lows, high);
        }
        if let Some(last) = faces.last_mut() {
            last.top = NONE;
        }
        faces
    }

    /// The prism of a region about the middle of an edge inside of the region: what an item that has no height over the
    /// edge touches there.
    fn prism_about(&self, region: u32, [a, b]: [Point; 2]) -> Option<u32> {
        let prisms = &self.slab.regions.prisms;
        let start = prisms.partition_point(|prism| prism.region < region);
        let twice = |p: Point| [2 * i64::from(p.x), 2 * i64::from(p.y)];
        let middle = [i64::from(a.x) + i64::from(b.x), i64::from(a.y) + i64::from(b.y)];
        let is_about = |footprint: &[u32]| {
            (0..footprint.len()).all(|i| {
                let (from, to) = (footprint[i], footprint[(i + 1) % footprint.len()]);
                let (from, to) = (twice(self.point(from)), twice(self.point(to)));
                // Coordinates below 2^26, products below 2^53.
                let along = [to[0] - from[0], to[1] - from[1]];
                along[0] * (middle[1] - from[1]) >= along[1] * (middle[0] - from[0])
            })
        };
        let own = prisms[start..].iter().take_while(|prism| prism.region == region);
        own.enumerate().find(|(_, prism)| is_about(&prism.footprint)).map(|(i, _)| (start + i) as u32)
    }
}

/// Heights over the ends of an edge.
type Heights = [i128; 2];

fn heights(plane: &Plane, ends: [Point; 2]) -> Heights {
    ends.map(|end| i128::from(plane.height(end)))
}

/// Adds one to the heights above which the next part of a side lies. Where roundings have a ceiling below its floor, an item
/// takes nothing from the next: the heights before count on, unless they lie below the new one all along.
fn raise(lows: &mut Vec<Heights>, high: Heights) {
    lows.retain(|low| (0..2).any(|end| low[end] > high[end]));
    if lows.iter().all(|low| (0..2).any(|end| low[end] < high[end])) {
        lows.push(high);
    }
}

/// Whether somewhere over an edge all of `lows` lie below both of `highs`, all of them linear along it.
fn reaches(lows: &[Heights], highs: [Heights; 2]) -> bool {
    let rise = |low: &Heights, high: &Heights| [0, 1].map(|end| high[end] - low[end]);
    let rises = || highs.iter().flat_map(|high| lows.iter().map(move |low| rise(low, high)));
    // Each is positive on a part of the edge that holds one end; parts that have something in common two by two have
    // something in common all together.
    rises().all(|u| {
        rises().all(|v| {
            let both = |end: usize| u[end] > 0 && v[end] > 0;
            let between = |from: usize, to: usize| {
                // u is positive from one end, v from the other: up to and from where they are 0.
                u[from] > 0 && v[to] > 0 && u[from] as f64 * v[to] as f64 > v[from] as f64 * u[to] as f64
            };
            both(0) || both(1) || between(0, 1) || between(1, 0)
        })
    })
}

/// Adds a section with its faces.
fn push(partition: &mut Partition, start: Point, faces: &[Face]) {
    let first = partition.faces.len() as u32;
    partition.faces.extend_from_slice(faces);
    partition.sections.push(Section { start, faces: first..partition.faces.len() as u32 });
}

/// Finds what lies below floors and above ceilings.
fn cover(slabs: &[Built], firsts: &[u32], partition: &mut Partition) {
    // Pairs of (cell above, cell below) that touch.
    let mut touching: Vec<(u32, u32)> = Vec::new();
    for (s, slab) in slabs.iter().enumerate() {
        let prisms = &slab.regions.prisms;
        let mut by_plane: HashMap<u32, [Vec<u32>; 2]> = HashMap::new();
        for (p, prism) in prisms.iter().enumerate() {
            let item = slab.regions.items[prism.region as usize];
            by_plane.entry(item.floor).or_default()[0].push(p as u32 + firsts[s]);
            by_plane.entry(item.ceiling).or_default()[1].push(p as u32 + firsts[s]);
        }
        let mut planes: Vec<u32> = by_plane.keys().copied().collect();
        planes.sort_unstable();
        for plane in planes {
            let [mut above, below] = by_plane.remove(&plane).unwrap_or_default();
            if plane == 0 {
                continue;
            }
            if plane == 1 {
                // The next slab's cells on its own lower level.
                let Some(next) = slabs.get(s + 1) else { continue };
                above = next
                    .regions
                    .prisms
                    .iter()
                    .enumerate()
                    .filter(|(_, prism)| next.regions.items[prism.region as usize].floor == 0)
                    .map(|(p, _)| p as u32 + firsts[s + 1])
                    .collect();
            }
            pair(partition, &above, &below, &mut touching);
        }
    }
    let reversed: Vec<(u32, u32)> = touching.iter().map(|&(above, below)| (below, above)).collect();
    let below = add_covers(partition, touching);
    let above = add_covers(partition, reversed);
    for (cell, (below, above)) in partition.cells.iter_mut().zip(below.into_iter().zip(above)) {
        (cell.below, cell.above) = (below, above);
    }
}

/// Adds the covers that pairs of (cell, cell beyond) are, the hull for cells that have none; returns each cell's.
fn add_covers(partition: &mut Partition, mut pairs: Vec<(u32, u32)>) -> Vec<Range<u32>> {
    pairs.sort_unstable();
    let mut next = 0;
    let mut ranges = Vec::with_capacity(partition.cells.len());
    for cell in 0..partition.cells.len() as u32 {
        let start = partition.covers.len() as u32;
        while next < pairs.len() && pairs[next].0 == cell {
            partition.covers.push(Cover { cell: pairs[next].1, source: NONE });
            next += 1;
        }
        if partition.covers.len() as u32 == start {
            partition.covers.push(Cover { cell: NONE, source: NONE });
        }
        ranges.push(start..partition.covers.len() as u32);
    }
    ranges
}

/// Adds the pairs of cells whose footprints overlap.
fn pair(partition: &Partition, above: &[u32], below: &[u32], touching: &mut Vec<(u32, u32)>) {
    if above.is_empty() || below.is_empty() {
        return;
    }
    let footprint = |cell: u32| -> Vec<Point> {
        // Without points on straight lines: they separate nothing.
        partition.footprint(&partition.cells[cell as usize]).collect()
    };
    let upper: Vec<Vec<Point>> = above.iter().map(|&c| footprint(c)).collect();
    let overlaps = Overlaps::new(&upper);
    for &low in below {
        overlaps.each(&footprint(low), |i| touching.push((above[i], low)));
    }
}

/// Of air without a label what hangs together with the hull is exterior, all other is void.
pub(super) fn tell_exterior(partition: &mut Partition) {
    let is_open = |cell: &Cell| matches!(cell.label, Label::Exterior | Label::Void);
    let unlabelled: Vec<bool> = partition.cells.iter().map(is_open).collect();
    let neighbours = |cell: &Cell| {
        let mut all = Vec::new();
        let covers = [&cell.below, &cell.above].into_iter().flat_map(|r| r.start as usize..r.end as usize);
        all.extend(covers.map(|cover| partition.covers[cover].cell));
        let sections = &partition.sections[cell.sections.start as usize..cell.sections.end as usize];
        for (i, section) in sections.iter().enumerate() {
            let ends = [section.start, sections[(i + 1) % sections.len()].start];
            let [floor, ceiling] =
                [cell.floor, cell.ceiling].map(|plane| heights(&partition.planes[plane as usize], ends));
            let mut lows = vec![floor];
            for face in &partition.faces[section.faces.start as usize..section.faces.end as usize] {
                let high = match face.top {
                    NONE => ceiling,
                    top => heights(&partition.planes[top as usize], ends),
                };
                // Not where they touch by an edge alone.
                if reaches(&lows, [high, ceiling]) {
                    all.push(face.cover.cell);
                }
                raise(&mut lows, high);
            }
        }
        all
    };
    let mut is_exterior = vec![false; partition.cells.len()];
    let mut waiting = Vec::new();
    for (c, cell) in partition.cells.iter().enumerate() {
        if unlabelled[c] && neighbours(cell).contains(&NONE) {
            is_exterior[c] = true;
            waiting.push(c);
        }
    }
    while let Some(c) = waiting.pop() {
        for other in neighbours(&partition.cells[c]) {
            if other != NONE && unlabelled[other as usize] && !is_exterior[other as usize] {
                is_exterior[other as usize] = true;
                waiting.push(other as usize);
            }
        }
    }
    for (c, cell) in partition.cells.iter_mut().enumerate() {
        if unlabelled[c] {
            cell.label = if is_exterior[c] { Label::Exterior } else { Label::Void };
        }
    }
}
