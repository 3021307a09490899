//! From a plan of columns to the faces between its labels: planar polygons with holes, as large as they can be.
//!
//! Every column gives small faces where its label meets another one. All their edges are atomic: no other face of
//! the plan has a corner inside one. Small faces of one plane that belong together are joined by striking out the
//! edges that they share.

use std::collections::{BTreeMap, BTreeSet};

use super::flush::gcd;
use super::lattice::Point;
use super::outline::polygons;
use super::plan::{Plan, Slope, Top};
use super::sides::{Sides, Span};

/// Which way a face looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Facing {
    /// Straight up.
    Up,
    /// Straight down.
    Down,
    /// To a side.
    Aside,
}

/// What a face belongs to: only faces with the same surface are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Surface {
    /// The element whose outside it is.
    pub element: u32,
    /// Its material.
    pub material: u32,
    /// The air volume that it looks into, if that is known.
    pub beyond: Option<u32>,
}

/// A face: a planar polygon with holes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// What it belongs to.
    pub surface: Surface,
    /// The outline, counter-clockwise seen from the front, then the holes, clockwise. All atomic edges' ends are
    /// in them: corners may lie on straight lines.
    pub loops: Vec<Vec<Point>>,
}

/// An outward normal without common factor, and the plane's height along it.
type Plane = ([i64; 3], i64);

/// All faces of a plan. `surface` is asked what the face of a label that looks at another label (`None`: outside)
/// belongs to; where it says `None`, there is no face.
pub fn patches(plan: &Plan, surface: &dyn Fn(u32, Option<u32>, Facing) -> Option<Surface>) -> Vec<Patch> {
    let mut groups: BTreeMap<(Surface, Plane), Vec<[Point; 2]>> = BTreeMap::new();
    level_faces(plan, surface, &mut groups);
    upright_faces(plan, surface, &mut groups);
    let mut patches = Vec::new();
    for ((surface, (normal, _)), edges) in groups {
        let joined = polygons(edges, normal);
        patches.extend(joined.into_iter().map(|loops| Patch { surface, loops }));
    }
    patches
}

/// Faces between the layers of each column, and at its bottom and top.
fn level_faces(
    plan: &Plan,
    surface: &dyn Fn(u32, Option<u32>, Facing) -> Option<Surface>,
    groups: &mut BTreeMap<(Surface, Plane), Vec<[Point; 2]>>,
) {
    for column in &plan.columns {
        let label = |i: usize| column.layers.get(i).and_then(|layer| layer.label);
        for above in 0..=column.layers.len() {
            let below = above.checked_sub(1);
            let top = below.map_or(Top::Level(plan.bottom), |i| column.layers[i].top);
            let (under, over) = (below.and_then(label), label(above));
            if under == over {
                continue;
            }
            let at = |i: u32| {
                let [x, y] = plan.points[i as usize];
                [x, y, top.at([x, y])]
            };
            let (normal, height) = top_plane(top);
            if let Some(found) = under.and_then(|own| surface(own, over, Facing::Up)) {
                let edges = column.edges.iter().map(|&[u, v]| [at(u), at(v)]);
                groups.entry((found, (normal, height))).or_default().extend(edges);
            }
            if let Some(found) = over.and_then(|own| surface(own, under, Facing::Down)) {
                let edges = column.edges.iter().map(|&[u, v]| [at(v), at(u)]);
                groups.entry((found, (normal.map(|c| -c), -height))).or_default().extend(edges);
            }
        }
    }
}

/// Faces between the layers of neighbouring columns.
fn upright_faces(
    plan: &Plan,
    surface: &dyn Fn(u32, Option<u32>, Facing) -> Option<Surface>,
    groups: &mut BTreeMap<(Surface, Plane), Vec<[Point; 2]>>,
) {
    let sides = Sides::of(plan);
    // Heights at which some column around a plan point changes its label: where its vertical line has corners.
    let mut levels: Vec<BTreeSet<i32>> = vec![BTreeSet::new(); plan.points.len()];
    for column in &plan.columns {
        for &u in column.edges.iter().flatten() {
            let tops = column.layers.iter().map(|layer| layer.top.at(plan.points[u as usize]));
            levels[u as usize].extend([plan.bottom].into_iter().chain(tops));
        }
    }
    for ([u, v], spans) in sides.iter() {
        let (p, q) = (plan.points[u as usize], plan.points[v as usize]);
        let plane = upright_plane(p, q);
        for Span { low, high, label, other } in spans {
            let Some(found) = label.and_then(|label| surface(label, other, Facing::Aside)) else { continue };
            let edges = groups.entry((found, plane)).or_default();
            let (at_p, at_q) = (|z| [p[0], p[1], z], |z| [q[0], q[1], z]);
            edges.push([at_p(low[0]), at_q(low[1])]);
            edges.push([at_q(high[1]), at_p(high[0])]);
            edges.extend(steps(&levels[v as usize], low[1], high[1]).map(|(z0, z1)| [at_q(z0), at_q(z1)]));
            edges.extend(steps(&levels[u as usize], low[0], high[0]).map(|(z0, z1)| [at_p(z1), at_p(z0)]));
        }
    }
}

/// The steps between the levels from `z0` to `z1`, which are levels themselves.
fn steps(levels: &BTreeSet<i32>, z0: i32, z1: i32) -> impl Iterator<Item = (i32, i32)> + '_ {
    let within = levels.range(z0..=z1);
    within.clone().copied().zip(within.skip(1).copied())
}

/// The plane of a layer's top, looking up.
fn top_plane(top: Top) -> Plane {
    match top {
        Top::Level(z) => ([0, 0, 1], i64::from(z)),
        Top::Slope(Slope { run, rise, per }) => {
            let normal = [-i64::from(run[0]), -i64::from(run[1]), i64::from(per)];
            let common = normal.iter().chain([&rise]).fold(0, |a, c| gcd(a, c.unsigned_abs())).max(1) as i64;
            (normal.map(|c| c / common), rise / common)
        }
    }
}

/// The plane over the plan edge from `p` to `q`, looking to its right.
fn upright_plane(p: [i32; 2], q: [i32; 2]) -> Plane {
    let (dx, dy) = (i64::from(q[0]) - i64::from(p[0]), i64::from(q[1]) - i64::from(p[1]));
    let common = gcd(dx.unsigned_abs(), dy.unsigned_abs()).max(1) as i64;
    let normal = [dy / common, -dx / common, 0];
    (normal, normal[0] * i64::from(p[0]) + normal[1] * i64::from(p[1]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::lattice::Cuboid;

    fn by_label(own: u32, beyond: Option<u32>, _: Facing) -> Option<Surface> {
        Some(Surface { element: own, material: 0, beyond })
    }

    #[test]
    fn a_box_in_a_box() {
        let outer = Cuboid { lo: [0; 3], hi: [9; 3] };
        let inner = Cuboid { lo: [3; 3], hi: [6; 3] };
        let plan = Plan::of_boxes(&[(outer, Some(0)), (inner, Some(1))]);
        let found = patches(&plan, &by_label);
        // Six faces to the outside, six to the inner box, which has six of its own: no face is cut.
        let count = |element, beyond| {
            found.iter().filter(|p| p.surface.element == element && p.surface.beyond == beyond).count()
        };
        assert_eq!((count(0, None), count(0, Some(1)), count(1, Some(0))), (6, 6, 6));
        assert!(found.iter().all(|p| p.loops.len() == 1));
    }

    #[test]
    fn a_window_makes_a_hole() {
        let wall = Cuboid { lo: [0, 0, 0], hi: [50, 3, 30] };
        let window = Cuboid { lo: [10, 0, 9], hi: [20, 3, 21] };
        let plan = Plan::of_boxes(&[(wall, Some(0)), (window, Some(1))]);
        let found = patches(&plan, &by_label);
        let outside: Vec<_> = found.iter().filter(|p| p.surface.element == 0).collect();
        assert_eq!(outside.iter().filter(|p| p.loops.len() == 2).count(), 2, "front and back");
        assert_eq!(outside.len(), 10, "six sides and four reveals");
    }

    #[test]
    fn oblique_planes_have_one_name() {
        assert_eq!(upright_plane([0, 0], [6, 3]), upright_plane([2, 1], [4, 2]));
        assert_eq!(upright_plane([6, 3], [0, 0]).0, [-1, 2, 0]);
    }
}
