//! What a cell's side has of another cell is what the other's has of it; only at the hull nothing lies beyond.

use std::collections::BTreeMap;

use crate::lattice::{FINE, Point};
use crate::partition::cells::NONE;

use super::space::{Find, Space, cosine};
use super::structure::{most_inverted, width};

/// Checks the sides of all cells; what is no wider than `narrow` units is rounding.
pub fn check(space: &Space<'_>, narrow: f64, find: Find<'_>) {
    let areas = areas(space, find);
    let near_splinter = near_splinters(space, narrow);
    for (&(a, b), there) in &areas {
        let back = &areas[&(b, a)];
        let slack = there.slack.max(back.slack);
        let beside_splinter = [a, b].iter().any(|&c| near_splinter[c as usize]);
        if a == b {
            find("own neighbour", format!("{a}"));
        }
        if there.beyond > slack && !beside_splinter {
            find("face too large", format!("{a} -> {b}: {} of {}, slack {slack}", there.beyond, there.area));
        }
        if a < b && (there.area - back.area).abs() > slack && !beside_splinter {
            find("side areas", format!("{a} -> {b}: {}; back: {}, slack {slack}", there.area, back.area));
        }
    }
}

/// What one cell's sides have of another, square units along the longer axis.
#[derive(Default)]
struct Shared {
    area: f64,
    /// Where the other is not.
    beyond: f64,
    /// What roundings may make of it.
    slack: f64,
}

/// By (cell, other cell).
fn areas(space: &Space<'_>, find: Find<'_>) -> BTreeMap<(u32, u32), Shared> {
    let hull = space.partition.hull;
    let on_hull = |a: Point, b: Point| {
        (a.x == b.x && (a.x == hull[0][0] || a.x == hull[1][0]))
            || (a.y == b.y && (a.y == hull[0][1] || a.y == hull[1][1]))
    };
    // Beside a steep plane a unit in the plan is many in height.
    let steepest = space.partition.planes.iter().map(cosine).fold(1.0, f64::min);
    let mut areas: BTreeMap<(u32, u32), Shared> = BTreeMap::new();
    for c in 0..space.footprints.len() {
        let (cell, footprint) = (space.cell(c), &space.footprints[c]);
        for (i, section) in space.sections(cell).iter().enumerate() {
            let ends = [footprint[i], footprint[(i + 1) % footprint.len()]];
            let [a, b] = ends;
            // The same on both sides: that along the longer axis.
            let length = f64::from((b.x - a.x).abs().max((b.y - a.y).abs()));
            let over = |plane: u32| ends.map(|end| space.plane(plane).height(end) as f64 / FINE as f64);
            let ceiling = over(cell.ceiling);
            let mut lows = vec![over(cell.floor)];
            let faces = space.faces(section);
            if faces.is_empty() {
                find("no face", format!("cell {c} section {i}"));
            }
            for (k, face) in faces.iter().enumerate() {
                let is_last = k + 1 == faces.len();
                if (face.top == NONE) != is_last {
                    find("face top", format!("cell {c} section {i} face {k}"));
                }
                let high = if face.top == NONE { ceiling } else { over(face.top) };
                let other = face.cover.cell;
                if (other == NONE) != on_hull(a, b) {
                    find("hull side", format!("cell {c} section {i} {ends:?} names {other}"));
                }
                if other != NONE {
                    let there = space.cell(other as usize);
                    let area = area_between(&lows, &[high, ceiling]);
                    lows.push(over(there.floor));
                    let common = area_between(&lows, &[high, ceiling, over(there.ceiling)]);
                    lows.pop();
                    let shared = areas.entry((c as u32, other)).or_default();
                    shared.area += area * length;
                    shared.beyond += (area - common) * length;
                    shared.slack += most_inverted(space) / steepest * length;
                    areas.entry((other, c as u32)).or_default();
                }
                lows.push(high);
            }
        }
    }
    areas
}

/// The area over an edge of length 1 above all of `lows` and below all of `highs`, given by their heights at its ends.
pub fn area_between(lows: &[[f64; 2]], highs: &[[f64; 2]]) -> f64 {
    let at = |line: &[f64; 2], s: f64| line[0] + s * (line[1] - line[0]);
    let all: Vec<&[f64; 2]> = lows.iter().chain(highs).collect();
    let mut places = vec![0.0, 1.0];
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            let (from, to) = (a[0] - b[0], a[1] - b[1]);
            if from * to < 0.0 {
                places.push(from / (from - to));
            }
        }
    }
    places.sort_by(f64::total_cmp);
    let height = |s: f64| {
        let low = lows.iter().map(|line| at(line, s)).fold(f64::NEG_INFINITY, f64::max);
        let high = highs.iter().map(|line| at(line, s)).fold(f64::INFINITY, f64::min);
        (high - low).max(0.0)
    };
    places.windows(2).map(|w| (w[1] - w[0]) * (height(w[0]) + height(w[1])) / 2.0).sum()
}

/// For each cell whether it, or one that it touches, is so thin that roundings are as large as it.
fn near_splinters(space: &Space<'_>, narrow: f64) -> Vec<bool> {
    let is_splinter = |c: usize| {
        let points = space.footprints[c].iter().map(|p| [f64::from(p.x), f64::from(p.y)]);
        width(&points.collect::<Vec<_>>()) <= narrow
    };
    let splinters: Vec<bool> = (0..space.footprints.len()).map(is_splinter).collect();
    let is_near = |c: usize| {
        let cell = space.cell(c);
        let sides =
            space.sections(cell).iter().flat_map(|section| space.faces(section)).map(|f| f.cover.cell);
        let mut touched = sides.chain(space.below(cell)).chain(space.above(cell));
        splinters[c] || touched.any(|other| other != NONE && splinters[other as usize])
    };
    (0..splinters.len()).map(is_near).collect()
}
