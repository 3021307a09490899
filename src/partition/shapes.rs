//! The shapes of cells and of the parts of their surface, in f64 lattice units.

use glam::{DVec2, DVec3};

use super::cells::{Cell, Face, NONE, Partition};
use super::halfspaces::{ACUTE, Bounds, Cutter, HalfSpace};
use crate::lattice::{FINE, Plane, orient};

/// What a part of a surface belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Index in [`Partition::faces`].
    Face(u32),
    /// Index in [`Partition::covers`].
    Cover(u32),
}

/// A part of a cell's surface and what it looks at.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    pub(super) part: Part,
    /// The cell beyond.
    pub(super) beyond: u32,
    /// A convex polygon, in no particular sense of rotation; may lack area.
    pub(super) corners: Vec<DVec3>,
    /// The unit normal away from the cell.
    pub(super) out: DVec3,
}

/// The unit normal of a plane, upwards.
pub(super) fn up(plane: &Plane) -> DVec3 {
    let fine = FINE as f64;
    DVec3::new(-plane.p as f64 / fine, -plane.q as f64 / fine, 1.0).normalize()
}

fn lift(plane: &Plane, at: DVec2) -> DVec3 {
    at.extend(plane.height_f64(at.x, at.y))
}

fn plan(partition: &Partition, cell: &Cell) -> Vec<DVec2> {
    partition.footprint(cell).map(|p| DVec2::new(f64::from(p.x), f64::from(p.y))).collect()
}

/// The direction out of a footprint across its edge from `a` to `b`; `None` between equal points.
fn across(a: DVec2, b: DVec2) -> Option<DVec3> {
    (b - a).try_normalize().map(|along| DVec3::new(along.y, -along.x, 0.0))
}

/// The half-spaces beyond which the cell's footprint ends, one for each of its straight sides.
fn upright_sides(partition: &Partition, cell: &Cell, by: f64, sides: &mut Vec<HalfSpace>) {
    let points: Vec<_> = partition.footprint(cell).collect();
    let count = points.len();
    let corner = |i: usize| DVec2::new(f64::from(points[i].x), f64::from(points[i].y));
    for i in 0..count {
        let (before, next) = ((i + count - 1) % count, (i + 1) % count);
        if orient(points[before], points[i], points[next]) == 0 {
            // Goes on along the side before.
            continue;
        }
        let (from, at, to) = (corner(before), corner(i), corner(next));
        sides.extend(across(at, to).map(|out| HalfSpace::beyond(out, at.extend(0.0), by)));
        let (Some(here), Some(away)) = ((at - from).try_normalize(), (to - at).try_normalize()) else {
            continue;
        };
        if by > 0.0
            && here.dot(away) < ACUTE
            && let Some(out) = (here - away).try_normalize()
        {
            sides.push(HalfSpace::beyond(out.extend(0.0), at.extend(0.0), by));
        }
    }
}

/// The half-spaces of a cell, moved out by `by` (level floors and ceilings by `level`) and held back at acute edges, and
/// the box that holds what counts of them.
pub(super) fn prism(
    partition: &Partition,
    cell: &Cell,
    by: f64,
    level: f64,
    sides: &mut Vec<HalfSpace>,
) -> Bounds {
    let first = sides.len();
    upright_sides(partition, cell, by, sides);
    let upright = first..sides.len();
    let points = plan(partition, cell);
    let ends = [cell.floor, cell.ceiling].map(|plane| &partition.planes[plane as usize]);
    let corners: Vec<DVec3> = ends.iter().flat_map(|plane| points.iter().map(|&p| lift(plane, p))).collect();
    let beyond = |plane: &Plane| if plane.is_level() { level } else { by };
    for (plane, out) in [(ends[0], -up(ends[0])), (ends[1], up(ends[1]))] {
        let Some(&at) = points.first() else { continue };
        sides.push(HalfSpace::beyond(out, lift(plane, at), beyond(plane)));
        for i in upright.clone() {
            if out.dot(sides[i].normal) < ACUTE
                && let Some(normal) = (out + sides[i].normal).try_normalize()
            {
                let offset = corners.iter().map(|&p| normal.dot(p)).fold(f64::NEG_INFINITY, f64::max) + by;
                sides.push(HalfSpace { normal, offset });
            }
        }
    }
    let mut bounds = Bounds::of(&corners).dilated(DVec3::splat(by));
    bounds.low.z -= beyond(ends[0]) - by;
    bounds.high.z += beyond(ends[1]) - by;
    bounds
}

/// All parts of a cell's surface beyond which there is a cell, and that cell.
pub(super) fn parts(partition: &Partition, cell: &Cell) -> Vec<(Part, u32)> {
    let sections = &partition.sections[cell.sections.start as usize..cell.sections.end as usize];
    let faces = sections.iter().flat_map(|section| section.faces.clone());
    let faces = faces.map(|f| (Part::Face(f), partition.faces[f as usize].cover.cell));
    let covers = cell.below.clone().chain(cell.above.clone());
    let covers = covers.map(|c| (Part::Cover(c), partition.covers[c as usize].cell));
    faces.chain(covers).filter(|part| part.1 != NONE).collect()
}

/// All parts of a cell's surface beyond which `wanted` cells lie.
pub(super) fn walls(
    partition: &Partition,
    cell: &Cell,
    wanted: impl Fn(u32) -> bool,
    cutter: &mut Cutter,
    mut each: impl FnMut(&mut Cutter, Wall),
) {
    let wanted = |beyond: u32| beyond != NONE && wanted(beyond);
    let sections = &partition.sections[cell.sections.start as usize..cell.sections.end as usize];
    let points = plan(partition, cell);
    for (i, section) in sections.iter().enumerate() {
        let ends = [points[i], points[(i + 1) % points.len()]];
        let Some(out) = across(ends[0], ends[1]) else { continue };
        let mut below = cell.floor;
        for f in section.faces.clone() {
            let Face { top, cover } = partition.faces[f as usize];
            let above = if top == NONE { cell.ceiling } else { top };
            if wanted(cover.cell) {
                let corners = side(partition, cell, ends, [below, above], cutter);
                each(cutter, Wall { part: Part::Face(f), beyond: cover.cell, corners, out });
            }
            below = above;
        }
    }
    for (plane, covers, sense) in [(cell.floor, &cell.below, -1.0), (cell.ceiling, &cell.above, 1.0)] {
        let plane = &partition.planes[plane as usize];
        let whole: Vec<DVec3> = points.iter().map(|&p| lift(plane, p)).collect();
        for c in covers.clone() {
            let beyond = partition.covers[c as usize].cell;
            if !wanted(beyond) {
                continue;
            }
            let corners = if covers.len() == 1 {
                whole.clone()
            } else {
                let mut sides = Vec::new();
                upright_sides(partition, &partition.cells[beyond as usize], 0.0, &mut sides);
                cutter.inside(&whole, &sides)
            };
            each(cutter, Wall { part: Part::Cover(c), beyond, corners, out: up(plane) * sense });
        }
    }
}

/// The part of a cell's side over the edge between `ends` that lies between two planes.
fn side(
    partition: &Partition,
    cell: &Cell,
    ends: [DVec2; 2],
    between: [u32; 2],
    cutter: &mut Cutter,
) -> Vec<DVec3> {
    let plane = |index: u32| &partition.planes[index as usize];
    let [below, above] = between.map(plane);
    if below.is_level() && above.is_level() && between == [cell.floor, cell.ceiling] {
        return vec![lift(below, ends[0]), lift(below, ends[1]), lift(above, ends[1]), lift(above, ends[0])];
    }
    let heights = |plane: &Plane| ends.map(|p| plane.height_f64(p.x, p.y));
    let (floor, ceiling) = (heights(plane(cell.floor)), heights(plane(cell.ceiling)));
    let (low, high) = (floor[0].min(floor[1]), ceiling[0].max(ceiling[1]));
    let whole = [ends[0].extend(low), ends[1].extend(low), ends[1].extend(high), ends[0].extend(high)];
    let at = |plane: &Plane| lift(plane, ends[0]);
    let sides = [
        HalfSpace::beyond(-up(plane(cell.floor)), at(plane(cell.floor)), 0.0),
        HalfSpace::beyond(up(plane(cell.ceiling)), at(plane(cell.ceiling)), 0.0),
        HalfSpace::beyond(-up(below), at(below), 0.0),
        HalfSpace::beyond(up(above), at(above), 0.0),
    ];
    cutter.inside(&whole, &sides)
}
