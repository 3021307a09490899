//! From a plan of columns to the faces between its labels: planar polygons with holes, as large as they can be.
//!
//! Every column gives small faces where its label meets another one. All their edges are atomic: no other face of
//! the plan has a corner inside one. Small faces of one plane that belong together are joined by striking out the
//! edges that they share.

use std::collections::{BTreeMap, BTreeSet};

use super::flush::gcd;
use super::lattice::Point;
use super::outline::polygons;
use super::plan::{Layer, Plan};

/// Which way a face looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
        let corners: Vec<[i32; 2]> = column.ring.iter().map(|&p| plan.points[p as usize]).collect();
        let label = |i: usize| column.layers.get(i).and_then(|layer| layer.label);
        for above in 0..=column.layers.len() {
            let below = above.checked_sub(1);
            let z = below.map_or(plan.bottom, |i| column.layers[i].top);
            let (under, over) = (below.and_then(label), label(above));
            if under == over {
                continue;
            }
            let next = |i: usize| (i + 1) % corners.len();
            let at = |i: usize| [corners[i][0], corners[i][1], z];
            if let Some(found) = under.and_then(|own| surface(own, over, Facing::Up)) {
                let edges = (0..corners.len()).map(|i| [at(i), at(next(i))]);
                groups.entry((found, ([0, 0, 1], i64::from(z)))).or_default().extend(edges);
            }
            if let Some(found) = over.and_then(|own| surface(own, under, Facing::Down)) {
                let edges = (0..corners.len()).map(|i| [at(next(i)), at(i)]);
                groups.entry((found, ([0, 0, -1], -i64::from(z)))).or_default().extend(edges);
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
    let mut owner = BTreeMap::new();
    // Heights at which some column around a plan point changes its label: where its vertical line has corners.
    let mut levels: Vec<BTreeSet<i32>> = vec![BTreeSet::new(); plan.points.len()];
    for (index, column) in plan.columns.iter().enumerate() {
        for (&u, &v) in column.ring.iter().zip(column.ring.iter().cycle().skip(1)) {
            owner.insert((u, v), index);
            levels[u as usize].extend([plan.bottom].into_iter().chain(column.layers.iter().map(|l| l.top)));
        }
    }
    for (&(u, v), &index) in &owner {
        let own = &plan.columns[index].layers;
        let across: &[Layer] = owner.get(&(v, u)).map_or(&[], |&other| &plan.columns[other].layers);
        let (p, q) = (plan.points[u as usize], plan.points[v as usize]);
        let plane = upright_plane(p, q);
        for (z0, z1, label, other) in side_by_side(plan.bottom, own, across) {
            let Some(found) = label.and_then(|label| surface(label, other, Facing::Aside)) else { continue };
            let edges = groups.entry((found, plane)).or_default();
            edges.push([[p[0], p[1], z0], [q[0], q[1], z0]]);
            edges.push([[q[0], q[1], z1], [p[0], p[1], z1]]);
            for (low, high) in steps(&levels[v as usize], z0, z1) {
                edges.push([[q[0], q[1], low], [q[0], q[1], high]]);
            }
            for (low, high) in steps(&levels[u as usize], z0, z1) {
                edges.push([[p[0], p[1], high], [p[0], p[1], low]]);
            }
        }
    }
}

/// The spans of height over which two stacks have different labels.
fn side_by_side(bottom: i32, own: &[Layer], across: &[Layer]) -> Vec<(i32, i32, Option<u32>, Option<u32>)> {
    let mut spans = Vec::new();
    let (mut i, mut j, mut z) = (0, 0, bottom);
    // Above its own top nothing of this column is left to have a face.
    while let Some(layer) = own.get(i) {
        let other = across.get(j);
        let top = other.map_or(layer.top, |o| o.top.min(layer.top));
        let beyond = other.and_then(|o| o.label);
        if top > z && layer.label != beyond {
            spans.push((z, top, layer.label, beyond));
        }
        z = z.max(top);
        i += usize::from(layer.top <= top);
        j += usize::from(other.is_some_and(|o| o.top <= top));
    }
    spans
}

/// The steps between the levels from `z0` to `z1`, which are levels themselves.
fn steps(levels: &BTreeSet<i32>, z0: i32, z1: i32) -> Vec<(i32, i32)> {
    let within: Vec<i32> = levels.range(z0..=z1).copied().collect();
    within.windows(2).map(|pair| (pair[0], pair[1])).collect()
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
