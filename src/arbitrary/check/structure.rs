//! What must hold whatever the model is: exactly, in integers.

use std::collections::BTreeSet;

use crate::lattice::{FINE, Point, double_area, orient};
use crate::partition::cells::{Label, NONE};

use super::sides;
use super::space::{Find, Finding, Space, cosine};

/// All of it; the partition says that it moved points of the plan by up to `moved` lattice units.
pub fn check(space: &Space<'_>, moved: f64) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |kind, text| findings.push(Finding { kind, text });
    volume(space, &mut find);
    footprints(space, &mut find);
    heights(space, narrow(moved), &mut find);
    sides::check(space, narrow(moved), &mut find);
    floors(space, &mut find);
    exterior(space, &mut find);
    findings
}

/// The cells' volumes sum to the hull's.
fn volume(space: &Space<'_>, find: Find<'_>) {
    let hull = space.partition.hull;
    let sum: i128 = (0..space.footprints.len()).map(|c| space.six_volumes(c)).sum();
    let box_: i128 = (0..3).map(|i| i128::from(hull[1][i]) - i128::from(hull[0][i])).product();
    let rest = sum - box_ * 6 * i128::from(FINE);
    if rest != 0 {
        find("volume", format!("six volumes are off by {} cubic units", rest as f64 / FINE as f64));
    }
}

/// Footprints are exactly convex, counter-clockwise and simple.
fn footprints(space: &Space<'_>, find: Find<'_>) {
    for (c, footprint) in space.footprints.iter().enumerate() {
        let n = footprint.len();
        let turns = (0..n).map(|i| orient(footprint[i], footprint[(i + 1) % n], footprint[(i + 2) % n]));
        let is_convex = n >= 3 && turns.clone().all(|t| t >= 0) && turns.clone().any(|t| t > 0);
        // A convex chain that goes around once has as much area as its fan, all of one sign.
        let once = (1..n.max(1) - 1).all(|i| orient(footprint[0], footprint[i], footprint[i + 1]) >= 0);
        let different = (0..n).all(|i| footprint[i] != footprint[(i + 1) % n]);
        if !(is_convex && once && different) {
            find("not convex", format!("cell {c}: {footprint:?}"));
        }
    }
}

/// Ceilings lie above floors, but for roundings.
fn heights(space: &Space<'_>, narrow: f64, find: Find<'_>) {
    for c in 0..space.footprints.len() {
        if let Some(text) = inversion(space, c, narrow) {
            find("inverted", format!("cell {c} ({:?}): {text}", space.cell(c).label));
        }
    }
}

/// Units, across the steeper of both planes, by which a ceiling may lie below the floor. Points of the plan are rounded, so
/// that two planes that meet over an edge meet up to a unit beside it; and what rises by up to a millimetre is level, so that
/// a corner of it is moved by up to as much, and the edges with it along which sloped faces end at it, and are cut at a slab's level.
pub fn most_inverted(space: &Space<'_>) -> f64 {
    2.0 + space.partition.lattice.steps(1e-3)
}

/// Units: what is no wider than this is rounding. Two lines that were one have come apart by no more, where points are
/// rounded to the lattice and then moved by up to `moved` units, each to its side.
fn narrow(moved: f64) -> f64 {
    2.0 * (std::f64::consts::FRAC_1_SQRT_2 + moved)
}

/// How a cell's ceiling lies too far below its floor: over a part of the footprint that is wider than roundings are.
fn inversion(space: &Space<'_>, c: usize, narrow: f64) -> Option<String> {
    let (cell, footprint) = (space.cell(c), &space.footprints[c]);
    let (floor, ceiling) = (space.plane(cell.floor), space.plane(cell.ceiling));
    let cosine = cosine(floor).min(cosine(ceiling));
    let rise: Vec<f64> = footprint.iter().map(|&p| space.height(cell, p) as f64 / FINE as f64).collect();
    let least = rise.iter().copied().fold(f64::INFINITY, f64::min);
    if least * cosine >= -most_inverted(space) {
        return None;
    }
    // The part that is upside down.
    let at = |i: usize| [f64::from(footprint[i].x), f64::from(footprint[i].y)];
    let mut part: Vec<[f64; 2]> = Vec::new();
    for i in 0..footprint.len() {
        let j = (i + 1) % footprint.len();
        if rise[i] < 0.0 {
            part.push(at(i));
        }
        if (rise[i] < 0.0) != (rise[j] < 0.0) {
            let s = rise[i] / (rise[i] - rise[j]);
            part.push([0, 1].map(|k| at(i)[k] + s * (at(j)[k] - at(i)[k])));
        }
    }
    let width = width(&part);
    (width > narrow).then(|| {
        let across = least * cosine;
        format!("ceiling {least} units below floor, {across} across, {width} wide; {footprint:?} {floor:?} {ceiling:?}")
    })
}

/// The distance of the closest parallel lines between which a convex polygon fits.
pub fn width(polygon: &[[f64; 2]]) -> f64 {
    let n = polygon.len();
    let across = |i: usize| {
        let (a, b) = (polygon[i], polygon[(i + 1) % n]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        let off = |p: &[f64; 2]| (dx * (p[1] - a[1]) - dy * (p[0] - a[0])).abs() / length;
        (length > 0.0).then(|| polygon.iter().map(off).fold(0.0, f64::max))
    };
    let width = (0..n).filter_map(across).fold(f64::INFINITY, f64::min);
    if width.is_finite() { width } else { 0.0 }
}

/// Floors and ceilings lie on each other without gaps.
fn floors(space: &Space<'_>, find: Find<'_>) {
    let hull = space.partition.hull;
    let mut pairs: BTreeSet<(u32, u32)> = BTreeSet::new();
    let mut back: BTreeSet<(u32, u32)> = BTreeSet::new();
    for c in 0..space.footprints.len() {
        let cell = space.cell(c);
        let whole = double_area(&space.footprints[c]) as f64;
        for (is_above, plane) in [(false, cell.floor), (true, cell.ceiling)] {
            let mut others: Vec<u32> =
                if is_above { space.above(cell).collect() } else { space.below(cell).collect() };
            let at_hull = *space.plane(plane) == crate::lattice::Plane::level(hull[usize::from(is_above)][2]);
            if others.contains(&NONE) != at_hull || (at_hull && others != [NONE]) {
                find("hull floor", format!("cell {c} above {is_above}: {others:?}"));
            }
            others.retain(|&other| other != NONE);
            let count = others.len();
            others.sort_unstable();
            others.dedup();
            if others.len() != count {
                find("cover twice", format!("cell {c}"));
            }
            let mut sum = 0.0;
            for &other in &others {
                let there = space.cell(other as usize);
                if plane_of(is_above, there) != plane {
                    find("floor plane", format!("cells {c}, {other}"));
                }
                if is_above {
                    pairs.insert((other, c as u32));
                } else {
                    back.insert((c as u32, other));
                }
                sum += common_area(&space.footprints[c], &space.footprints[other as usize]);
            }
            // Products of lengths, each rounded.
            let reach = space.footprints[c].iter().map(|p| p.x.abs().max(p.y.abs())).max().unwrap_or(0);
            let rounding = 64.0 * f64::EPSILON * f64::from(reach).powi(2);
            if !at_hull && (sum - whole).abs() > 1e-9 * whole + rounding + 1e-2 {
                find(
                    "floor areas",
                    format!("cell {c} above {is_above}: twice {sum} of {whole} square units"),
                );
            }
        }
    }
    for pair in pairs.symmetric_difference(&back) {
        find("floor one-sided", format!("{pair:?}"));
    }
}

fn plane_of(is_above: bool, there: &crate::partition::cells::Cell) -> u32 {
    if is_above { there.floor } else { there.ceiling }
}

/// Twice the area that two convex polygons have in common.
fn common_area(a: &[Point], b: &[Point]) -> f64 {
    let origin = a[0];
    let local = |p: &Point| [f64::from(p.x - origin.x), f64::from(p.y - origin.y)];
    let mut kept: Vec<[f64; 2]> = a.iter().map(local).collect();
    let by: Vec<[f64; 2]> = b.iter().map(local).collect();
    for i in 0..by.len() {
        let (o, e) = (by[i], by[(i + 1) % by.len()]);
        let side = |p: [f64; 2]| (e[0] - o[0]) * (p[1] - o[1]) - (e[1] - o[1]) * (p[0] - o[0]);
        let mut next = Vec::with_capacity(kept.len() + 1);
        for j in 0..kept.len() {
            let (p, q) = (kept[j], kept[(j + 1) % kept.len()]);
            let (s, t) = (side(p), side(q));
            if s >= 0.0 {
                next.push(p);
            }
            if (s >= 0.0) != (t >= 0.0) {
                let w = s / (s - t);
                next.push([p[0] + (q[0] - p[0]) * w, p[1] + (q[1] - p[1]) * w]);
            }
        }
        kept = next;
    }
    let n = kept.len();
    (0..n).map(|i| kept[i][0] * kept[(i + 1) % n][1] - kept[(i + 1) % n][0] * kept[i][1]).sum()
}

/// Unlabelled air is exterior where it hangs together with the hull, by faces with area, and void elsewhere.
fn exterior(space: &Space<'_>, find: Find<'_>) {
    let is_unlabelled = |c: usize| matches!(space.cell(c).label, Label::Exterior | Label::Void);
    let mut reached = vec![false; space.footprints.len()];
    let mut waiting = Vec::new();
    let neighbours = |c: usize| {
        let (cell, footprint) = (space.cell(c), &space.footprints[c]);
        let mut all: Vec<u32> = space.below(cell).chain(space.above(cell)).collect();
        for (i, section) in space.sections(cell).iter().enumerate() {
            let ends = [footprint[i], footprint[(i + 1) % footprint.len()]];
            let over = |plane: u32| ends.map(|end| space.plane(plane).height(end) as f64);
            let mut lows = vec![over(cell.floor)];
            for face in space.faces(section) {
                let high = over(if face.top == NONE { cell.ceiling } else { face.top });
                if sides::area_between(&lows, &[high, over(cell.ceiling)]) > 0.0 {
                    all.push(face.cover.cell);
                }
                lows.push(high);
            }
        }
        all
    };
    for c in (0..reached.len()).filter(|&c| is_unlabelled(c)) {
        if neighbours(c).contains(&NONE) {
            reached[c] = true;
            waiting.push(c);
        }
    }
    while let Some(c) = waiting.pop() {
        for other in neighbours(c).into_iter().filter(|&other| other != NONE).map(|other| other as usize) {
            if is_unlabelled(other) && !std::mem::replace(&mut reached[other], true) {
                waiting.push(other);
            }
        }
    }
    for c in (0..reached.len()).filter(|&c| is_unlabelled(c)) {
        if (space.cell(c).label == Label::Exterior) != reached[c] {
            find(
                "exterior",
                format!("cell {c} is {:?}, volume {:e} m3", space.cell(c).label, space.volume(c)),
            );
        }
    }
}
