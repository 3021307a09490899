//! The sheet that closes an opening: where it stands, and how far it reaches.
//!
//! It stands across the way through the opening, at a depth where matter is all around the hole, as far as it is: in the middle of the
//! leaf, if that is such a depth and no other opening shares the hole, else in the middle of them. It is what that plane shares with the opening's cells, and with the niches
//! beside them that lead nowhere in that plane (a hole is often cut some millimetres larger than its label), and reaches a little into the
//! matter around.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};

use super::section::{HalfSpace, Plane, crossing, half_spaces};
use crate::format::records::CellRecord;
use crate::graph::{Part, area, opening_of, parts, way_through};
use crate::scene::Scene;
use crate::trace::Prisms;

/// A sheet across an opening.
#[derive(Clone, Debug)]
pub(super) struct Sheet {
    /// Its triangles, internal frame, metres.
    pub(super) triangles: Vec<[[f64; 3]; 3]>,
    /// Square metres.
    pub(super) area: f64,
    /// Its outline, metres.
    outline: f64,
    /// How much of that is on matter.
    on_matter: f64,
    /// How much is within other openings of the same hole.
    shared: BTreeMap<u32, f64>,
    /// Where it stands, along the lattice's axes.
    plane: Plane,
}

impl Sheet {
    /// The share of its outline that is on matter, or on sheets of other openings that stand in its plane.
    pub(super) fn sealed<'a>(&self, closed: impl Fn(u32) -> Option<&'a Sheet>) -> f64 {
        let is_met = |other: u32| closed(other).is_some_and(|other| self.plane.is_that_of(&other.plane));
        let shared = self.shared.iter().filter(|(other, _)| is_met(**other)).map(|(_, length)| length);
        if self.outline > 0.0 {
            ((self.on_matter + shared.sum::<f64>()) / self.outline).min(1.0)
        } else {
            0.0
        }
    }
}

/// How far a sheet reaches into matter, in tolerances: cells are rounded, and the model's own surface is where rays end.
const INTO_MATTER: f64 = 2.0;

/// How far the pieces of a sheet reach over each other, metres.
const LAP: f64 = 1e-6;

/// Air beside the hole that ends within this is a niche of it, metres.
const NICHE: f64 = 0.1;

/// Depths with this share of the matter that is around the hole where most is are as good.
const AS_GOOD: f64 = 0.98;

/// Stretches of depth shorter than this are roundings, metres.
const LEAST_DEPTH: f64 = 1e-3;

/// Pieces with less area are none, m2.
const LEAST_AREA: f64 = 1e-9;

/// Surfaces that look more along the way through than this (cosine) do not bound it.
const ALONG: f64 = 0.5;

/// A leaf deeper than this stands open, metres.
const DEEPEST_LEAF: f64 = 0.4;

/// Why an opening has no sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Missing {
    /// It has no cells.
    Air,
    /// Nothing is around them.
    Matter,
}

/// The sheet of an opening; `cells` are those of all openings.
pub(super) fn sheet(
    scene: &Scene,
    opening: u32,
    cells: &BTreeMap<u32, Vec<u32>>,
    leaves: Option<&BTreeSet<u32>>,
) -> Result<Sheet, Missing> {
    let prisms = Prisms::new(&scene.tables);
    let normal = prisms
        .turned(way_through(scene, opening).filter(|_| cells.contains_key(&opening)).ok_or(Missing::Air)?);
    let of = |opening: u32| -> Vec<Walls> {
        let cells = cells.get(&opening).into_iter().flatten();
        cells.map(|&cell| Walls::new(&prisms, cell)).collect()
    };
    let walls = of(opening);
    // Those that share the hole: all of them stand at one depth, so that their sheets meet.
    let mut hole: BTreeMap<u32, Vec<Rim>> = BTreeMap::new();
    let mut waiting = vec![opening];
    while let Some(here) = waiting.pop() {
        if hole.contains_key(&here) {
            continue;
        }
        let others = if here == opening { None } else { Some(of(here)) };
        let own = others.as_ref().unwrap_or(&walls);
        hole.insert(here, own.iter().flat_map(|cell| cell.rim(&prisms, normal)).collect());
        let beside = own.iter().flat_map(|cell| &cell.parts).filter_map(|part| {
            let other = opening_of(&prisms.cells[part.beyond as usize])?;
            (facing(&part.corners).dot(normal).abs() < ALONG).then_some(other)
        });
        waiting.extend(beside.filter(|other| !hole.contains_key(other)));
    }
    let is_shared = hole.len() > 1;
    let [from, to] = best_depths(hole.into_values().flatten().collect()).ok_or(Missing::Matter)?;
    let middle = (from + to) / 2.0;
    let leaves = leaves.filter(|_| !is_shared);
    let leaf = leaves.and_then(|leaves| leaf_depth(scene, &prisms, leaves, normal));
    let depth = leaf.filter(|depth| (from..=to).contains(depth)).unwrap_or(middle);
    // Not at the very end of the matter around it.
    let inset = (to - from) * 0.1;
    let plane = Plane::new(normal, depth.clamp(from + inset, to - inset));
    Outline { prisms, scene, plane }.sheet(walls).ok_or(Missing::Air)
}

/// The middle of the leaf along the way through, if it stands across it.
fn leaf_depth(scene: &Scene, prisms: &Prisms<'_>, leaves: &BTreeSet<u32>, normal: DVec3) -> Option<f64> {
    let mut span = [f64::INFINITY, f64::NEG_INFINITY];
    for &leaf in leaves {
        let record = &scene.tables.elements[leaf as usize];
        for triangle in record.first_triangle..record.first_triangle + record.triangle_count {
            for corner in scene.triangle(triangle) {
                let depth = normal.dot(prisms.local(DVec3::from(corner)));
                span = [span[0].min(depth), span[1].max(depth)];
            }
        }
    }
    (span[0] <= span[1] && span[1] - span[0] <= DEEPEST_LEAF).then(|| (span[0] + span[1]) / 2.0)
}

/// A stretch of matter along the way through a hole: from where to where, and how much of the hole's outline it makes.
type Rim = (f64, f64, f64);

/// The depths at which most of a hole's outline is matter.
fn best_depths(rims: Vec<Rim>) -> Option<[f64; 2]> {
    let mut ends: Vec<f64> = rims.iter().flat_map(|rim| [rim.0, rim.1]).collect();
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|b, a| *b - *a < LEAST_DEPTH);
    let stretches: Vec<[f64; 2]> = ends.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    // What begins with a stretch, less what has ended before it.
    let mut around = vec![0.0; stretches.len() + 1];
    let after = |depth: f64| stretches.partition_point(|stretch| (stretch[0] + stretch[1]) / 2.0 < depth);
    for (from, to, length) in rims {
        around[after(from)] += length;
        around[after(to)] -= length;
    }
    around.pop();
    let mut sum = 0.0;
    for own in &mut around {
        sum += *own;
        *own = sum;
    }
    let most = (0..around.len()).max_by(|&a, &b| {
        let length = |i: usize| stretches[i][1] - stretches[i][0];
        around[a].total_cmp(&around[b]).then(length(a).total_cmp(&length(b))).then(b.cmp(&a))
    })?;
    let as_good = |i: &usize| around[*i] >= AS_GOOD * around[most];
    let first = (0..most).rev().take_while(as_good).last().unwrap_or(most);
    let last = (most + 1..around.len()).take_while(as_good).last().unwrap_or(most);
    Some([stretches[first][0], stretches[last][1]])
}

/// A cell and its surface, along the lattice's axes from its origin.
struct Walls {
    cell: u32,
    spaces: Vec<HalfSpace>,
    parts: Vec<Part>,
}

impl Walls {
    fn new(prisms: &Prisms<'_>, cell: u32) -> Walls {
        let record = &prisms.cells[cell as usize];
        let mut parts = parts(prisms, record);
        for corner in parts.iter_mut().flat_map(|part| &mut part.corners) {
            *corner = prisms.local(*corner);
        }
        Walls { cell, spaces: half_spaces(prisms, record), parts }
    }

    /// The stretches of matter along its sides.
    fn rim(&self, prisms: &Prisms<'_>, normal: DVec3) -> Vec<Rim> {
        let mut rims = Vec::new();
        for part in self.parts.iter().filter(|part| is_matter(prisms, part.beyond)) {
            let [from, to] = extent(&part.corners, normal);
            let plane = Plane::new(normal, (from + to) / 2.0);
            let facing = facing(&part.corners).dot(normal).abs();
            if to - from >= LEAST_DEPTH
                && facing < ALONG
                && let Some([a, b]) = crossing(&part.corners, &plane)
            {
                rims.push((from, to, a.distance(b)));
            }
        }
        rims
    }
}

fn is_matter(prisms: &Prisms<'_>, cell: u32) -> bool {
    prisms.cells[cell as usize].kind == CellRecord::SOLID
}

fn facing(corners: &[DVec3]) -> DVec3 {
    let first = corners[0];
    let twice = corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first));
    twice.sum::<DVec3>().normalize_or_zero()
}

fn extent(corners: &[DVec3], normal: DVec3) -> [f64; 2] {
    corners
        .iter()
        .map(|p| normal.dot(*p))
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], depth| [lo.min(depth), hi.max(depth)])
}

/// A plane through an opening, and the cells that it crosses.
struct Outline<'a> {
    prisms: Prisms<'a>,
    scene: &'a Scene,
    plane: Plane,
}

impl Outline<'_> {
    fn sheet(&self, own: Vec<Walls>) -> Option<Sheet> {
        let mut bounds = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let (mut pieces, mut area_sum) = (Vec::new(), 0.0);
        for walls in own {
            let polygon = self.plane.within(self.around(walls.cell), walls.spaces.iter().copied());
            if area(&polygon) > LEAST_AREA {
                area_sum += area(&polygon);
                bounds = polygon.iter().fold(bounds, |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
                pieces.push(walls);
            }
        }
        if pieces.is_empty() {
            return None;
        }
        let frame = square([bounds[0] - NICHE, bounds[1] + NICHE]);
        for niche in self.niches(&pieces, &frame) {
            pieces.extend(niche);
        }
        let inside: BTreeSet<u32> = pieces.iter().map(|walls| walls.cell).collect();
        let (mut outline, mut on_matter, mut shared) = (0.0, 0.0, BTreeMap::<u32, f64>::new());
        let mut triangles = Vec::new();
        let deep = INTO_MATTER * self.scene.tolerance();
        for walls in &pieces {
            let mut spaces = walls.spaces.clone();
            for space in &mut spaces {
                space.offset += LAP;
            }
            for (part, ends) in self.crossed(walls) {
                if inside.contains(&part.beyond) {
                    continue;
                }
                let length = ends[0].distance(ends[1]);
                outline += length;
                if let Some(other) = opening_of(&self.prisms.cells[part.beyond as usize]) {
                    *shared.entry(other).or_default() += length;
                }
                if is_matter(&self.prisms, part.beyond) {
                    on_matter += length;
                    let middle = (ends[0] + ends[1]) / 2.0;
                    let nearest = (0..spaces.len()).min_by(|&a, &b| {
                        walls.spaces[a].over(middle).abs().total_cmp(&walls.spaces[b].over(middle).abs())
                    });
                    if let Some(i) = nearest {
                        spaces[i].offset = walls.spaces[i].offset + deep;
                    }
                }
            }
            // No farther than that around an acute corner either.
            let own = self.plane.within(self.around(walls.cell), walls.spaces.iter().copied());
            let polygon = self.plane.within(boxed(&own, deep), spaces);
            self.fan(&polygon, &mut triangles);
        }
        (!triangles.is_empty()).then_some(Sheet {
            triangles,
            area: area_sum,
            outline,
            on_matter,
            shared,
            plane: self.plane,
        })
    }

    /// The parts of a cell's surface that the plane crosses.
    fn crossed<'w>(&self, walls: &'w Walls) -> impl Iterator<Item = (&'w Part, [DVec3; 2])> {
        walls.parts.iter().filter_map(|part| Some((part, crossing(&part.corners, &self.plane)?)))
    }

    /// Air beside the opening in its plane that ends before the frame does, piece by piece. Other openings are none of it.
    fn niches(&self, own: &[Walls], frame: &[DVec2]) -> Vec<Vec<Walls>> {
        let is_inner = |p: &DVec2| p.cmpgt(frame[0] + LAP).all() && p.cmplt(frame[2] - LAP).all();
        // Whether what was seen goes on.
        let mut seen: BTreeMap<u32, bool> = own.iter().map(|walls| (walls.cell, false)).collect();
        let beyond = |walls: &Walls| -> Vec<u32> {
            let parts = self.crossed(walls).map(|(part, _)| part.beyond);
            parts.filter(|cell| self.may_be_niche(*cell)).collect()
        };
        let mut niches = Vec::new();
        for start in own.iter().flat_map(beyond) {
            let (mut todo, mut niche, mut goes_on) = (vec![start], Vec::new(), false);
            while let (Some(cell), false) = (todo.pop(), goes_on) {
                match seen.insert(cell, false) {
                    Some(before) => {
                        seen.insert(cell, before);
                        goes_on |= before;
                    }
                    None => {
                        let walls = Walls::new(&self.prisms, cell);
                        let polygon = self.plane.within(frame.to_vec(), walls.spaces.iter().copied());
                        goes_on |= !polygon.iter().all(is_inner);
                        todo.extend(beyond(&walls));
                        niche.push(walls);
                    }
                }
            }
            if goes_on {
                seen.extend(niche.iter().map(|walls| (walls.cell, true)));
            } else if !niche.is_empty() {
                niches.push(niche);
            }
        }
        niches
    }

    fn may_be_niche(&self, cell: u32) -> bool {
        let record = &self.prisms.cells[cell as usize];
        record.kind == CellRecord::AIR && opening_of(record).is_none()
    }

    /// A square around what the plane may cross of a cell.
    fn around(&self, cell: u32) -> Vec<DVec2> {
        let [lo, hi] = self.prisms.cells[cell as usize].bounds.map(DVec3::from);
        let pick = |i: u32| {
            DVec3::new(
                [lo.x, hi.x][i as usize & 1],
                [lo.y, hi.y][i as usize >> 1 & 1],
                [lo.z, hi.z][i as usize >> 2],
            )
        };
        let corners = (0..8).map(|i| self.plane.project(pick(i)));
        let [lo, hi] =
            corners.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(p), hi.max(p)]);
        square([lo - 1.0, hi + 1.0])
    }

    fn fan(&self, polygon: &[DVec2], triangles: &mut Vec<[[f64; 3]; 3]>) {
        let corner = |p: DVec2| self.prisms.global(self.plane.at(p)).to_array();
        if area(polygon) <= LEAST_AREA {
            return;
        }
        for pair in polygon[1..].windows(2) {
            triangles.push([corner(polygon[0]), corner(pair[0]), corner(pair[1])]);
        }
    }
}

/// The box around a polygon, `by` larger on all sides.
fn boxed(polygon: &[DVec2], by: f64) -> Vec<DVec2> {
    let bounds =
        polygon.iter().fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)]);
    square([bounds[0] - by, bounds[1] + by])
}

fn square([lo, hi]: [DVec2; 2]) -> Vec<DVec2> {
    vec![lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)]
}
