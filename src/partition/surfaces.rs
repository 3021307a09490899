//! Which triangles of the source make the surface between air and matter.
//!
//! A ray that arrives at matter hits the source's own triangles there, so that its distance is the source's and not the
//! lattice's. The triangles of a part of the surface are, in this order:
//!
//! 1. those that lie nearly parallel to it, look towards the air, are no farther from its plane than the *reach*, and
//!    cover some of it (or its rim within the *seam*);
//! 2. where these leave more than slivers uncovered, all others within the reach of what is uncovered: chamfers, steps,
//!    sheets seen edge-on;
//! 3. where these do, too, even those that look the other way: a ray meets them whichever way they look.
//!
//! What is uncovered then is *false solid*: matter without a surface. A thin cell of matter that has more uncovered than
//! covered surface towards the air is none: rounding made it, a strip beside a real wall. It is given back to the air, and
//! what lies behind it is looked at again.

use std::collections::{BTreeMap, HashMap};

use enfilade_importers::{ElementId, Watch};
use glam::DVec3;

use super::account::Account;
use super::boxes::BoxTree;
use super::cells::{Label, NONE, Partition, Source};
use super::halfspaces::{Body, Bounds, Cutter, HalfSpace, Piece, are_wider, around_triangle};
use super::matter::MatterTriangle;
use super::report::{cubic_metres, six_volume};
use super::shapes::{Part, Wall, parts, walls};
use crate::lattice::FINE;
use crate::parallel;

/// Tolerances of the search for surfaces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfaceOptions {
    /// How far from the surface a triangle that makes it may lie, besides a lattice step, metres.
    pub reach: f64,
    /// How far triangles may end before the part of the surface that they make, besides a lattice step, metres.
    pub seam: f64,
    /// What is not wider than this need not be covered, metres.
    pub sliver: f64,
    /// Triangles whose corners lie no farther than this from one plane share it, metres.
    pub planar: f64,
    /// How many places of false solid the report names.
    pub places: usize,
}

impl Default for SurfaceOptions {
    fn default() -> Self {
        SurfaceOptions { reach: 2e-3, seam: 1e-4, sliver: 5e-5, planar: 1e-6, places: 8 }
    }
}

/// A part of the surface between air and matter that no triangle of the source makes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct FalseSolid {
    /// In its middle; metres, internal frame.
    pub at: [f64; 3],
    /// Its area, m2.
    pub area: f64,
    /// The cell of air.
    pub air: u32,
    /// The cell of matter.
    pub solid: u32,
    /// The element that fills that, as index in reports.
    #[serde(serialize_with = "index")]
    pub element: Option<ElementId>,
}

fn index<S: serde::Serializer>(element: &Option<ElementId>, to: S) -> Result<S::Ok, S::Error> {
    serde::Serialize::serialize(&element.map(|element| element.0), to)
}

/// What the search for surfaces found.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct SurfaceReport {
    /// Parts of air cells' surfaces beyond which there is matter.
    pub faces: u32,
    /// Their area, m2.
    pub area: f64,
    /// Those that parallel triangles do not cover.
    pub patched: u32,
    /// Those that no triangles at all cover, or not all of them.
    pub false_faces: u32,
    /// The area not covered, m2.
    pub false_area: f64,
    /// Those with so many triangles that it would take too long to say what they cover; they have all the parallel ones.
    pub undecided: u32,
    /// Thin cells of matter that were given back to the air, because no triangles cover most of their surface towards it.
    pub given_back: u32,
    /// Their volume, m3.
    pub given_back_volume: f64,
    /// The largest places that are not covered, the largest first.
    pub places: Vec<FalseSolid>,
    /// Different lists of triangles.
    pub sources: u32,
    /// Lists whose triangles share one plane.
    pub planar: u32,
    /// Triangles in the longest list.
    pub longest: u32,
}

/// So many cells are handed to a thread at once.
const CHUNK: usize = 64;
/// A triangle is parallel if the cosine between its normal and the surface's is at least this.
const PARALLEL: f64 = 0.9;
/// A triangle looks the other way if that cosine is less than this: edge-on, it looks neither way.
const AVERTED: f64 = -0.1;

/// Matter is given back to the air if more than this share of its surface towards the air is uncovered.
const MOST_BARE: f64 = 0.5;
/// And if it is no thicker than this behind what is uncovered, metres.
const THIN: f64 = 0.02;
/// The surface is looked at so many times: what is bare in the last stays matter, and is reported.
const ROUNDS: u32 = 4;

/// Finds the triangles of every part of the surface between air and matter, from both sides, and writes them to
/// [`Partition::sources`] and the covers' indices; what was there is replaced. Matter without a surface becomes air. If the
/// `account` is full or the caller cancels, the search ends early.
///
/// The result does not depend on the number of threads.
pub(super) fn attach(
    partition: &mut Partition,
    matter: &[MatterTriangle],
    options: &SurfaceOptions,
    account: &Account,
    watch: &Watch,
) -> SurfaceReport {
    let (mut given_back, mut six) = (0, 0i128);
    let mut rounds = 1;
    loop {
        // The lists of one round take the place of those of the round before.
        let free = Account::new(u64::MAX);
        let account = if rounds == 1 { account } else { &free };
        let (mut report, bare) = attach_once(partition, matter, options, account, watch);
        if bare.is_empty() || rounds == ROUNDS || account.is_full() || watch.is_cancelled() {
            report.given_back = given_back;
            report.given_back_volume = six as f64 * cubic_metres(&partition.lattice);
            return report;
        }
        for (solid, air) in bare {
            given_back += 1;
            six += six_volume(partition, &partition.cells[solid as usize]);
            partition.cells[solid as usize].label = partition.cells[air as usize].label;
        }
        rounds += 1;
    }
}

/// How much of the surface of a cell of matter looks into air, lattice units.
#[derive(Default)]
struct Shell {
    area: f64,
    uncovered: f64,
    /// The cell of air that the largest uncovered part looks into, and that part's area.
    air: Option<(u32, f64)>,
}

/// One round of [`attach`]: the report, and what has next to no surface, as a cell of matter and one of air beside it.
fn attach_once(
    partition: &mut Partition,
    matter: &[MatterTriangle],
    options: &SurfaceOptions,
    account: &Account,
    watch: &Watch,
) -> (SurfaceReport, Vec<(u32, u32)>) {
    let tree = BoxTree::new(matter.iter().map(MatterTriangle::bounds));
    let finder = Finder::new(partition, matter, &tree, options);
    let chunks = parallel::map(partition.cells.len().div_ceil(CHUNK), |chunk| {
        if account.is_full() || watch.is_cancelled() {
            return Vec::new();
        }
        let found = finder.find(chunk * CHUNK, CHUNK);
        // The account knows if it is too much.
        let _ = account.take(found.iter().map(|found| found.triangles.len() + 32).sum(), 8);
        found
    });
    let mut report = SurfaceReport::default();
    let mut places = Vec::new();
    let step = partition.lattice.step();
    let mut lists = Lists { index: HashMap::new(), sources: Vec::new() };
    for face in &mut partition.faces {
        face.cover.source = NONE;
    }
    for cover in &mut partition.covers {
        cover.source = NONE;
    }
    // What lies between a cell of matter and one of air, and its source.
    let mut seen: Vec<([u32; 2], u32)> = Vec::new();
    let mut shells: BTreeMap<u32, Shell> = BTreeMap::new();
    for found in chunks.into_iter().flatten() {
        report.faces += 1;
        report.area += found.area * step * step;
        report.patched += u32::from(found.is_patched);
        report.undecided += u32::from(found.is_undecided);
        let shell = shells.entry(found.beyond).or_default();
        shell.area += found.area;
        if let Some((at, area)) = found.uncovered {
            shell.uncovered += area;
            if shell.air.is_none_or(|(_, largest)| area > largest) {
                shell.air = Some((found.cell, area));
            }
            let area = area * step * step;
            report.false_faces += 1;
            report.false_area += area;
            places.push(FalseSolid {
                at: partition.lattice.metres(at.to_array()),
                area,
                air: found.cell,
                solid: found.beyond,
                element: match partition.cells[found.beyond as usize].label {
                    Label::Solid(element) => Some(element),
                    _ => None,
                },
            });
        }
        let source = lists.intern(found.triangles);
        *source_of(partition, found.part) = source;
        if source != NONE {
            seen.push(([found.beyond, found.cell], source));
        }
    }
    seen.sort_unstable();
    seen.dedup();
    mirror(partition, matter, &seen, &mut lists);
    places.sort_by(|a, b| b.area.total_cmp(&a.area).then((a.air, a.solid).cmp(&(b.air, b.solid))));
    places.truncate(options.places);
    let within = partition.lattice.steps(options.planar);
    partition.sources = parallel::map(lists.sources.len(), |i| source(matter, &lists.sources[i], within));
    report.places = places;
    report.sources = partition.sources.len() as u32;
    report.planar = partition.sources.iter().filter(|s| s.plane.is_some()).count() as u32;
    report.longest = partition.sources.iter().map(|s| s.triangles.len() as u32).max().unwrap_or(0);
    let thin = partition.lattice.steps(THIN);
    let bare = shells.into_iter().filter(|(solid, shell)| {
        let volume = six_volume(partition, &partition.cells[*solid as usize]) as f64 / (6.0 * FINE as f64);
        shell.uncovered > shell.area * MOST_BARE && volume <= shell.uncovered * thin
    });
    (report, bare.filter_map(|(solid, shell)| Some((solid, shell.air?.0))).collect())
}

/// The index that a part of a surface has.
fn source_of(partition: &mut Partition, part: Part) -> &mut u32 {
    match part {
        Part::Face(f) => &mut partition.faces[f as usize].cover.source,
        Part::Cover(c) => &mut partition.covers[c as usize].source,
    }
}

/// Gives the parts of the surfaces of cells of matter the sources that the air beyond has there. Two convex cells meet
/// in one plane, so that whatever lies between them has the same triangles.
fn mirror(partition: &mut Partition, matter: &[MatterTriangle], seen: &[([u32; 2], u32)], lists: &mut Lists) {
    for c in 0..partition.cells.len() {
        if partition.cells[c].label.is_air() {
            continue;
        }
        for (part, beyond) in parts(partition, &partition.cells[c]) {
            let pair = [c as u32, beyond];
            let start = seen.partition_point(|entry| entry.0 < pair);
            let count = seen[start..].iter().take_while(|entry| entry.0 == pair).count();
            let source = match &seen[start..start + count] {
                [] => continue,
                [one] => one.1,
                many => {
                    let all = many.iter().flat_map(|entry| lists.sources[entry.1 as usize].iter());
                    lists.intern(in_order(matter, all.copied().collect()))
                }
            };
            *source_of(partition, part) = source;
        }
    }
}

/// Triangles by name, each once.
fn in_order(matter: &[MatterTriangle], mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable_by_key(|&t| (matter[t as usize].name(), t));
    list.dedup_by_key(|t| matter[*t as usize].name());
    list
}

/// Lists of indices of triangles, each once, in the order of their first use.
struct Lists {
    index: HashMap<std::sync::Arc<[u32]>, u32>,
    sources: Vec<std::sync::Arc<[u32]>>,
}

impl Lists {
    fn intern(&mut self, list: Vec<u32>) -> u32 {
        if list.is_empty() {
            return NONE;
        }
        if let Some(&found) = self.index.get(list.as_slice()) {
            return found;
        }
        let list: std::sync::Arc<[u32]> = list.into();
        let next = self.sources.len() as u32;
        self.sources.push(list.clone());
        self.index.insert(list, next);
        next
    }
}

/// The source of a list of indices, by name; `within` in lattice units.
fn source(matter: &[MatterTriangle], list: &[u32], within: f64) -> Source {
    let triangles: Vec<_> = list.iter().map(|&t| matter[t as usize].name()).collect();
    let largest = list
        .iter()
        .enumerate()
        // The first of equals.
        .max_by(|a, b| {
            let area = |t: u32| matter[t as usize].area();
            area(*a.1).total_cmp(&area(*b.1)).then(b.0.cmp(&a.0))
        });
    let plane = largest.and_then(|(place, &t)| {
        let normal = matter[t as usize].normal()?;
        let at = matter[t as usize].points()[0];
        let holds =
            |&t: &u32| matter[t as usize].points().iter().all(|&p| normal.dot(p - at).abs() <= within);
        list.iter().all(holds).then_some(place as u32)
    });
    Source { triangles, plane }
}

/// What was found for a part of the surface.
struct Found {
    cell: u32,
    beyond: u32,
    part: Part,
    /// Indices of triangles, by name.
    triangles: Vec<u32>,
    area: f64,
    /// Whether parallel triangles do not suffice.
    is_patched: bool,
    /// Whether it took too long to say what they cover.
    is_undecided: bool,
    /// Where and how much is not covered.
    uncovered: Option<(DVec3, f64)>,
}

struct Finder<'a> {
    partition: &'a Partition,
    matter: &'a [MatterTriangle],
    tree: &'a BoxTree,
    reach: f64,
    seam: f64,
    sliver: f64,
}

impl<'a> Finder<'a> {
    fn new(
        partition: &'a Partition,
        matter: &'a [MatterTriangle],
        tree: &'a BoxTree,
        options: &SurfaceOptions,
    ) -> Finder<'a> {
        let steps = |metres| partition.lattice.steps(metres);
        Finder {
            partition,
            matter,
            tree,
            reach: steps(options.reach) + 1.0,
            seam: steps(options.seam) + 1.0,
            sliver: steps(options.sliver),
        }
    }

    fn find(&self, first: usize, count: usize) -> Vec<Found> {
        let cells = &self.partition.cells;
        let mut scratch = Scratch::default();
        let mut cutter = Cutter::default();
        let mut all = Vec::new();
        for (c, cell) in cells.iter().enumerate().skip(first).take(count) {
            if !cell.label.is_air() {
                continue;
            }
            let is_matter = |beyond: u32| !cells[beyond as usize].label.is_air();
            walls(self.partition, cell, is_matter, &mut cutter, |cutter, wall| {
                all.push(self.wall(c as u32, wall, cutter, &mut scratch));
            });
        }
        all
    }

    /// The triangles of a part of the surface of a cell of air.
    fn wall(&self, cell: u32, wall: Wall, cutter: &mut Cutter, scratch: &mut Scratch) -> Found {
        let to_air = -wall.out;
        let piece = Piece::new(wall.corners);
        let mut found = Found {
            cell,
            beyond: wall.beyond,
            part: wall.part,
            triangles: Vec::new(),
            area: piece.area(),
            is_patched: false,
            is_undecided: false,
            uncovered: None,
        };
        if piece.corners.is_empty() {
            return found;
        }
        scratch.near.clear();
        let bounds = piece.bounds.dilated(DVec3::splat(self.reach));
        self.tree.meeting(&bounds, |t| scratch.near.push(t));
        let mut left = Vec::new();
        found.is_undecided = !self.parallel(&piece, to_air, &mut found.triangles, &mut left, cutter, scratch);
        for averted in [false, true] {
            if found.is_undecided || (!found.triangles.is_empty() && !are_wider(&left, self.sliver)) {
                break;
            }
            found.is_patched = true;
            if left.is_empty() {
                // Without area.
                left.push(piece.clone());
            }
            let patched = self.patch(&mut left, to_air, averted, &mut found.triangles, cutter, scratch);
            found.is_undecided = !patched;
        }
        if !found.is_undecided && (found.triangles.is_empty() || are_wider(&left, self.sliver)) {
            let largest = left.iter().max_by(|a, b| a.area().total_cmp(&b.area()));
            found.uncovered = largest.map(|l| (l.middle(), left.iter().map(Piece::area).sum()));
        }
        left.into_iter().for_each(|piece| cutter.give_back(piece.corners));
        cutter.give_back(piece.corners);
        found.triangles = in_order(self.matter, found.triangles);
        found
    }

    /// Lists the parallel triangles of a part of the surface, and puts on `left` what they do not cover. Returns whether
    /// that could be said.
    fn parallel(
        &self,
        piece: &Piece,
        to_air: DVec3,
        list: &mut Vec<u32>,
        left: &mut Vec<Piece>,
        cutter: &mut Cutter,
        scratch: &mut Scratch,
    ) -> bool {
        let Scratch { near, bodies } = scratch;
        bodies.clear();
        let height = to_air.dot(piece.corners[0]);
        for &t in near.iter() {
            let triangle = &self.matter[t as usize];
            let points = triangle.points();
            let heights = points.map(|p| to_air.dot(p) - height);
            let is_beyond = |side: f64| heights.iter().all(|h| h * side > self.reach);
            if is_beyond(1.0) || is_beyond(-1.0) {
                continue;
            }
            if triangle.normal().is_none_or(|normal| normal.dot(to_air) < PARALLEL) {
                continue;
            }
            let meets = |body: Body<'_>| cutter.meets(piece, body);
            if bodies.add(&points, to_air, self.seam, self.reach, meets) {
                list.push(t);
            }
        }
        let whole = Piece { corners: cutter.copy(&piece.corners), bounds: piece.bounds };
        cutter.remove(whole, bodies.all(), &|b| bodies.get(b), left)
    }

    /// Lists triangles within the reach of what is left of a part of the surface, those that look the other way or all
    /// others, and takes what they cover off `left`. Returns whether that could be said.
    fn patch(
        &self,
        left: &mut Vec<Piece>,
        to_air: DVec3,
        averted: bool,
        list: &mut Vec<u32>,
        cutter: &mut Cutter,
        scratch: &mut Scratch,
    ) -> bool {
        let Scratch { near, bodies } = scratch;
        bodies.clear();
        let tree = BoxTree::new(left.iter().map(|piece| piece.bounds));
        for &t in near.iter() {
            let triangle = &self.matter[t as usize];
            let Some(normal) = triangle.normal() else { continue };
            if (normal.dot(to_air) < AVERTED) != averted {
                continue;
            }
            let meets = |body: Body<'_>| {
                let mut meets = false;
                tree.meeting(body.bounds, |p| meets = meets || cutter.meets(&left[p as usize], body));
                meets
            };
            if bodies.add(&triangle.points(), normal, self.reach, self.reach, meets) {
                list.push(t);
            }
        }
        let mut rest = Vec::new();
        let mut is_said = true;
        for piece in left.drain(..) {
            is_said = is_said && cutter.remove(piece, bodies.all(), &|b| bodies.get(b), &mut rest);
        }
        *left = rest;
        is_said
    }
}

#[derive(Default)]
struct Scratch {
    near: Vec<u32>,
    bodies: Bodies,
}

/// The bodies around the triangles of one part of the surface.
#[derive(Default)]
struct Bodies {
    sides: Vec<HalfSpace>,
    /// Where each body's sides end, and its box.
    ends: Vec<(usize, Bounds)>,
}

impl Bodies {
    fn clear(&mut self) {
        self.sides.clear();
        self.ends.clear();
    }

    /// Adds the body around a triangle ([`around_triangle`]) if it meets what it should.
    fn add(
        &mut self,
        points: &[DVec3; 3],
        axis: DVec3,
        rim: f64,
        reach: f64,
        meets: impl FnOnce(Body<'_>) -> bool,
    ) -> bool {
        let start = self.sides.len();
        // Acute corners are held back to within 1.6 rims; along the axis the body reaches as far as `reach`.
        let bounds = Bounds::of(points).dilated(DVec3::splat(reach + 2.0 * rim));
        let sides = around_triangle(points, axis, rim, reach, &mut self.sides);
        let adds = sides.is_some() && meets(Body { bounds: &bounds, sides: &self.sides[start..] });
        if adds {
            self.ends.push((self.sides.len(), bounds));
        } else {
            self.sides.truncate(start);
        }
        adds
    }

    fn get(&self, body: u32) -> Body<'_> {
        let body = body as usize;
        let start = body.checked_sub(1).map_or(0, |before| self.ends[before].0);
        let (end, bounds) = &self.ends[body];
        Body { bounds, sides: &self.sides[start..*end] }
    }

    fn all(&self) -> std::ops::Range<u32> {
        0..self.ends.len() as u32
    }
}

#[cfg(test)]
mod tests;
