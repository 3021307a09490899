//! Rays that walk from cell to cell, by the cells' faces alone, in plain f64.

use enfilade::arbitrary::{Finding, Space, cosine};
use enfilade::lattice::{FINE, Plane, Point};
use enfilade::partition::cells::NONE;

use super::points;
use super::truth::{Meshes, Random};

/// Points of the plan are rounded by half a unit, a plane's numbers by less: in units, no crossing of planes moves by more.
const ROUNDED: f64 = 1.0;

/// Rays for each building.
const RAYS: usize = 12;

pub fn check(space: &Space<'_>, meshes: &Meshes<'_>, random: &mut Random) -> Vec<Finding> {
    let mut findings = Vec::new();
    let hull = space.partition.hull;
    for _ in 0..RAYS {
        let from = [0, 1, 2].map(|i| random.between(f64::from(hull[0][i]), f64::from(hull[1][i])));
        let direction = random.direction();
        let start = (0..space.footprints.len()).find(|&c| space.depth(c, from) > 3.0);
        let Some(start) = start.filter(|&c| space.cell(c).label.is_air()) else { continue };
        let mut find = |kind, text| findings.push(Finding { kind, text });
        let walk = walk(space, start, from, direction);
        match walk {
            Walk::Lost(text) => find("ray lost", format!("{from:?} {direction:?}: {text}")),
            Walk::Escaped(t) => along(space, meshes, from, direction, t, random, &mut find),
            Walk::Hit(t, matter) => {
                along(space, meshes, from, direction, t, random, &mut find);
                let at = [0, 1, 2].map(|i| from[i] + t * direction[i]);
                let p = space.partition.lattice.metres(at);
                let far = distance_to_solids(space, meshes, matter, p);
                if far > meshes.margin {
                    find("hit off", format!("{from:?} {direction:?}: hit {far} m from any solid's surface"));
                }
            }
        }
    }
    findings
}

/// Points on the way are what the meshes say.
fn along(
    space: &Space<'_>,
    meshes: &Meshes<'_>,
    from: [f64; 3],
    direction: [f64; 3],
    t: f64,
    random: &mut Random,
    find: &mut dyn FnMut(&'static str, String),
) {
    for _ in 0..3 {
        let s = random.between(0.0, t);
        let local = [0, 1, 2].map(|i| from[i] + s * direction[i]);
        let p = space.partition.lattice.metres(local);
        if meshes.distance_to_solids(p) > meshes.margin && !meshes.labels_at(p).iter().all(|l| l.is_air()) {
            find("ray through matter", format!("{from:?} {direction:?} at {s} of {t}"));
        }
        points::at(space, meshes, local, find);
    }
}

/// The distance of a hit on a cell of matter from any solid's surface. Where a steep plane comes down to a level one, their
/// crossing is rounded to points of the plan, and the matter between may hang down by as much as the steep plane falls over
/// that: a spike some micrometres thin and some millimetres high, all of which is told from its root.
fn distance_to_solids(space: &Space<'_>, meshes: &Meshes<'_>, matter: usize, p: [f64; 3]) -> f64 {
    let cell = space.cell(matter);
    let fall =
        [cell.floor, cell.ceiling].map(|plane| (1.0 / cosine(space.plane(plane)).powi(2) - 1.0).sqrt());
    let spike = fall[0].max(fall[1]) * ROUNDED * space.partition.lattice.step();
    let steps = (2.0 * spike / meshes.margin).ceil().max(1.0);
    let heights = (0..=steps as u32).map(|i| spike * (2.0 * f64::from(i) / steps - 1.0));
    heights
        .chain([0.0])
        .map(|up| meshes.distance_to_solids([p[0], p[1], p[2] + up]))
        .fold(f64::INFINITY, f64::min)
}

enum Walk {
    /// At this distance, on this cell of matter.
    Hit(f64, usize),
    Escaped(f64),
    Lost(String),
}

fn walk(space: &Space<'_>, start: usize, from: [f64; 3], direction: [f64; 3]) -> Walk {
    let side =
        |p: Point| direction[0] * (f64::from(p.y) - from[1]) - direction[1] * (f64::from(p.x) - from[0]);
    let rise = |plane: &Plane| {
        direction[2] - (plane.p as f64 * direction[0] + plane.q as f64 * direction[1]) / FINE as f64
    };
    let reach = |plane: &Plane| (plane.height_f64(from[0], from[1]) - from[2]) / rise(plane);
    let (mut c, mut entered) = (start, 0.0f64);
    for _ in 0..10 * space.footprints.len() + 100 {
        let (cell, footprint) = (space.cell(c), &space.footprints[c]);
        let next = |i: usize| footprint[(i + 1) % footprint.len()];
        // Left by the side that the line crosses from its right to its left.
        let exit = (0..footprint.len()).find(|&i| side(footprint[i]) < 0.0 && side(next(i)) >= 0.0);
        let Some(exit) = exit else {
            return Walk::Lost(format!("the line misses cell {c}, {} from start", space.depth(c, from)));
        };
        let (a, b) = (footprint[exit], next(exit));
        let edge = [f64::from(b.x - a.x), f64::from(b.y - a.y)];
        let across = (f64::from(a.x) - from[0]) * edge[1] - (f64::from(a.y) - from[1]) * edge[0];
        let mut t = across / (direction[0] * edge[1] - direction[1] * edge[0]);
        let (floor, ceiling) = (space.plane(cell.floor), space.plane(cell.ceiling));
        let mut others: Option<Vec<u32>> = None;
        if rise(floor) < 0.0 && reach(floor) < t {
            (t, others) = (reach(floor), Some(space.below(cell).collect()));
        }
        if rise(ceiling) > 0.0 && reach(ceiling) < t {
            (t, others) = (reach(ceiling), Some(space.above(cell).collect()));
        }
        // Where roundings have a ceiling below its floor, a ray is past one before it comes to the other.
        entered = entered.max(t);
        let t = entered;
        let at = [0, 1, 2].map(|i| from[i] + t * direction[i]);
        let beyond = match others {
            None => {
                let faces = space.faces(&space.sections(cell)[exit]);
                let over = |top: u32| top == NONE || space.plane(top).height_f64(at[0], at[1]) > at[2];
                faces.iter().find(|face| over(face.top)).map_or(NONE, |face| face.cover.cell)
            }
            Some(others) => {
                let inside = |c: u32| {
                    let footprint = &space.footprints[c as usize];
                    (0..footprint.len())
                        .map(|i| {
                            let (a, b) = (footprint[i], footprint[(i + 1) % footprint.len()]);
                            let (dx, dy) = (f64::from(b.x - a.x), f64::from(b.y - a.y));
                            let side = dx * (at[1] - f64::from(a.y)) - dy * (at[0] - f64::from(a.x));
                            side / dx.hypot(dy)
                        })
                        .fold(f64::INFINITY, f64::min)
                };
                let best =
                    others.iter().filter(|&&c| c != NONE).max_by(|a, b| inside(**a).total_cmp(&inside(**b)));
                if let Some(&best) = best
                    && inside(best) < -1.0
                {
                    return Walk::Lost(format!("nothing lies beyond cell {c} at {at:?}: {}", inside(best)));
                }
                best.copied().unwrap_or(NONE)
            }
        };
        if beyond == NONE {
            let hull = space.partition.hull;
            let at_hull = (0..3).any(|i| {
                (at[i] - f64::from(hull[0][i])).abs() < 1e-3 || (at[i] - f64::from(hull[1][i])).abs() < 1e-3
            });
            return if at_hull { Walk::Escaped(t) } else { Walk::Lost(format!("left the hull at {at:?}")) };
        }
        if !space.cell(beyond as usize).label.is_air() {
            return Walk::Hit(t, beyond as usize);
        }
        c = beyond as usize;
    }
    Walk::Lost("it does not end".to_owned())
}
