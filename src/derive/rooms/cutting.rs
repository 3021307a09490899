//! Patches cut where rooms meet in the air: the lines, and the edges of triangles that lie on them.

use std::collections::BTreeMap;

use enfilade_importers::{Model, Role};
use glam::DVec2;

use super::super::DeriveOptions;
use super::super::open_plan::{self, Cutting, Place};
use super::Finder;
use crate::lattice::{Lattice, Point};
use crate::partition::storeys::{NONE, Storey, Storeys};

/// A line in the plan along which something is cut, lattice units.
#[derive(Clone, Copy, Debug)]
pub(in crate::derive) struct Line {
    pub(in crate::derive) ends: [Point; 2],
    /// It closes a gap in a wall.
    pub(super) is_gap: bool,
}

/// The edges of triangles of a plan that lie on lines, and whether on such that close gaps.
pub(super) fn edges_on(storey: &Storey, lines: &[Line]) -> BTreeMap<(u32, u8), bool> {
    /// How far rounding may move a line, lattice units.
    const OFF: f64 = 3.0;
    let point = |p: Point| DVec2::new(f64::from(p.x), f64::from(p.y));
    let lines: Vec<([DVec2; 2], bool)> =
        lines.iter().map(|line| (line.ends.map(point), line.is_gap)).collect();
    let is_on = |p: DVec2, [a, b]: [DVec2; 2]| {
        let (length, way) = (a.distance(b), (b - a).normalize_or_zero());
        way.perp_dot(p - a).abs() <= OFF && (-OFF..=length + OFF).contains(&way.dot(p - a))
    };
    let mut edges = BTreeMap::new();
    for t in 0..if lines.is_empty() { 0 } else { storey.triangles.len() as u32 } {
        let corners = storey.corners(t).map(point);
        for edge in 0..3 {
            let ends = [corners[edge], corners[(edge + 1) % 3]];
            let line = lines.iter().find(|line| ends.iter().all(|end| is_on(*end, line.0)));
            if let Some((_, is_gap)) = line {
                edges.insert((t, edge as u8), *is_gap);
            }
        }
    }
    edges
}

impl Finder<'_> {
    /// A patch in metres.
    fn place_of(&self, number: u32) -> Place {
        let patch = &self.patches[number as usize];
        let storey = &self.storeys.storeys[patch.storey];
        let step = self.storeys.lattice.step();
        let at = |v: u32| {
            let p = storey.points[v as usize];
            DVec2::new(f64::from(p.x), f64::from(p.y)) * step
        };
        let mut place = Place { triangles: Vec::new(), border: Vec::new(), area: patch.area };
        for &t in &patch.triangles {
            let corners = storey.triangles[t as usize];
            place.triangles.push(corners.map(at));
            for (edge, other) in storey.across[t as usize].into_iter().enumerate() {
                if other == NONE || self.patch_of[patch.storey][other as usize] != number {
                    let ends = [corners[edge], corners[(edge + 1) % 3]];
                    place.border.push((ends, ends.map(at)));
                }
            }
        }
        place
    }
}

/// By storey: lines along which to cut what would be one room.
pub(in crate::derive) fn cuts(
    model: &Model,
    roles: &[Role],
    storeys: &Storeys,
    options: &DeriveOptions,
) -> Vec<Vec<Line>> {
    let mut cuts = vec![Vec::new(); storeys.storeys.len()];
    if options.widest_corridor <= 0.0 {
        return cuts;
    }
    let finder = Finder::of(model, roles, storeys, &[], options);
    let how = Cutting {
        widest_gap: options.widest_hole,
        widest_corridor: options.widest_corridor,
        open_plan: options.open_plan,
    };
    let rooms: Vec<u32> = (0..finder.patches.len() as u32)
        .filter(|&number| finder.is_room(&finder.patches[number as usize], options.least_area))
        .collect();
    let found = crate::parallel::map(rooms.len(), |i| open_plan::cuts(&finder.place_of(rooms[i]), how));
    let lattice = &storeys.lattice;
    let point = |p: DVec2| {
        let [x, y, _] = Lattice::round([lattice.steps(p.x), lattice.steps(p.y), 0.0]);
        Point::new(x, y)
    };
    for (room, lines) in rooms.into_iter().zip(found) {
        let storey = finder.patches[room as usize].storey;
        cuts[storey]
            .extend(lines.into_iter().map(|cut| Line { ends: cut.ends.map(point), is_gap: cut.is_gap }));
    }
    cuts
}
