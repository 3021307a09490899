//! Checks of the prisms of an opened scene: that a walk from cell to cell stays within the tables and ends.

use enfilade_importers::Semantic;

use super::records::{CellRecord, PLAIN, SideRecord, SourceRecord};
use super::tables::{Views, ensure, invalid, is_box, within};
use super::{FaceKind, FormatError};
use crate::trace::NONE;

/// No lattice coordinate is larger: what f32 counts exactly.
const LARGEST: f64 = (1 << 24) as f64;

/// No plane is steeper along either axis.
const STEEPEST: f64 = 4096.0;

// What the compiler makes can be opened.
#[cfg(feature = "compile")]
const _: () = assert!(crate::lattice::Plane::STEEPEST <= STEEPEST);

/// Checks cells and all that they are made of. Sides, faces, covers and triangles of sources each belong to one owner, in
/// the order of their owners: so what a ray looks at is no more than the file holds.
pub(super) fn check(v: &Views) -> Result<(), FormatError> {
    cells(v)?;
    sides(v)?;
    beyond(v)?;
    sources(v)?;
    grid(v)
}

fn cells(v: &Views) -> Result<(), FormatError> {
    ensure(!v.cells.is_empty(), "cells", 0, || "there is none".to_owned())?;
    let optional = |index: u32, count: usize| index == NONE || (index as usize) < count;
    let (mut sides, mut covers) = (0u64, 0u64);
    for (i, c) in v.cells.iter().enumerate() {
        ensure(is_box(c.bounds), "cells", i, || "the bounds are no box".to_owned())?;
        ensure(Semantic::from_number(c.semantic.into()).is_some(), "cells", i, || {
            format!("semantic {}", c.semantic)
        })?;
        let is_free = c.flags == CellRecord::FREE && c.kind == CellRecord::AIR;
        ensure(c.flags == 0 || is_free, "cells", i, || format!("flags {}", c.flags))?;
        ensure(optional(c.room, v.rooms.len()), "cells", i, || format!("room {}", c.room))?;
        ensure(optional(c.element, v.elements.len()), "cells", i, || format!("element {}", c.element))?;
        let kind = if i == 0 {
            c.kind == CellRecord::AROUND
        } else {
            c.kind == CellRecord::AIR || c.kind == CellRecord::SOLID
        };
        ensure(kind, "cells", i, || format!("kind {}", c.kind))?;
        let mine = u64::from(c.first_side) == sides && u64::from(c.first_cover) == covers;
        ensure(mine, "cells", i, || "its sides or covers do not follow those of the cell before".to_owned())?;
        sides += u64::from(c.sides);
        covers += u64::from(c.below) + u64::from(c.above);
        let (prism, planes) = (c.kind != CellRecord::AROUND, v.planes.len());
        let ok = if prism {
            (c.floor as usize) < planes
                && (c.ceiling as usize) < planes
                && c.sides >= 3
                && c.below > 0
                && c.above > 0
        } else {
            c.floor == NONE && c.ceiling == NONE && c.sides == 0 && c.below == 0 && c.above == 0
        };
        ensure(ok, "cells", i, || "it is no prism".to_owned())?;
        let fits = sides <= v.sides.len() as u64 && covers <= v.covers.len() as u64;
        ensure(fits, "cells", i, || format!("sides up to {sides}, covers up to {covers}"))?;
        if prism {
            let first = c.first_side as usize;
            let bits = v.scene[0].lattice_bits;
            footprint(&v.sides[first..first + c.sides as usize], bits)
                .map_err(|what| FormatError::Invalid { section: "cells", item: i as u64, what })?;
        }
    }
    let whole = sides == v.sides.len() as u64 && covers == v.covers.len() as u64;
    ensure(whole, "cells", v.cells.len() - 1, || "sides or covers are left over".to_owned())
}

/// Whether the footprint lies on the lattice and is exactly convex, counter-clockwise, and goes around once.
fn footprint(sides: &[SideRecord], bits: u32) -> Result<(), String> {
    let steps = f64::from(bits).exp2();
    let mut points = Vec::with_capacity(sides.len());
    for side in sides {
        let [x, y] = side.start.map(|c| f64::from(c) * steps);
        // The negated form also turns away NaN.
        if !(x.abs() <= LARGEST && y.abs() <= LARGEST) || x != x.round() || y != y.round() {
            return Err(format!("the corner {:?} is not on the lattice", side.start));
        }
        points.push([x as i64, y as i64]);
    }
    let count = points.len();
    let edge = |i: usize| {
        let (a, b) = (points[i % count], points[(i + 1) % count]);
        [b[0] - a[0], b[1] - a[1]]
    };
    let (mut turns, mut bends) = (0, false);
    for i in 0..count {
        let (e, f) = (edge(i), edge(i + 1));
        let turn = e[0] * f[1] - e[1] * f[0];
        let forward = e[0] * f[0] + e[1] * f[1] > 0;
        if turn < 0 || (turn == 0 && !forward) {
            return Err("the footprint is not convex and counter-clockwise".to_owned());
        }
        bends |= turn > 0;
        // An edge that points down, or left, followed by one that does not: once in a turn.
        let down = |e: [i64; 2]| e[1] < 0 || (e[1] == 0 && e[0] < 0);
        turns += u32::from(down(e) && !down(f));
    }
    if turns == 1 && bends { Ok(()) } else { Err("the footprint does not go around once".to_owned()) }
}

fn sides(v: &Views) -> Result<(), FormatError> {
    let mut faces = 0u64;
    for (i, side) in v.sides.iter().enumerate() {
        let mine = u64::from(side.first_face) == faces && side.faces > 0;
        ensure(mine, "sides", i, || "its faces do not follow those of the side before".to_owned())?;
        faces += u64::from(side.faces);
        ensure(faces <= v.faces.len() as u64, "sides", i, || format!("faces up to {faces}"))?;
    }
    let last = v.sides.len().saturating_sub(1);
    ensure(faces == v.faces.len() as u64, "sides", last, || "faces are left over".to_owned())
}

fn beyond(v: &Views) -> Result<(), FormatError> {
    let known = |cell: u32, source: u32| {
        (cell as usize) < v.cells.len() && (source == NONE || (source as usize) < v.sources.len())
    };
    let is_kind = |kind: u16, flags: u16, source: u32| {
        let is_planar = || v.sources.get(source as usize).is_some_and(|source| source.plane != NONE);
        FaceKind::from_number(u32::from(kind)).is_some() && (flags == 0 || (flags == PLAIN && is_planar()))
    };
    for (i, face) in v.faces.iter().enumerate() {
        let ok = known(face.cell, face.source)
            && (face.top == NONE || (face.top as usize) < v.planes.len())
            && is_kind(face.kind, face.flags, face.source);
        ensure(ok, "faces", i, || format!("{face:?} refers to what is not there"))?;
    }
    for (i, cover) in v.covers.iter().enumerate() {
        let ok = known(cover.cell, cover.source) && is_kind(cover.kind, cover.flags, cover.source);
        ensure(ok, "covers", i, || format!("{cover:?} refers to what is not there"))?;
    }
    for (i, plane) in v.planes.iter().enumerate() {
        let ok = plane.slope.iter().all(|s| s.abs() <= STEEPEST) && within(plane.height);
        ensure(ok, "planes", i, || "not a plane".to_owned())?;
    }
    Ok(())
}

fn sources(v: &Views) -> Result<(), FormatError> {
    let mut items = 0u64;
    for (i, source) in v.sources.iter().enumerate() {
        let mine = u64::from(source.first) == items && source.count > 0;
        ensure(mine, "sources", i, || "its triangles do not follow those of the source before".to_owned())?;
        let many = source.count > SourceRecord::FEW;
        ensure(many == (source.root != NONE), "sources", i, || {
            format!("{} triangles, root {:#x}", source.count, source.root)
        })?;
        items += u64::from(source.count);
        ensure(items <= v.surfaces.len() as u64, "sources", i, || format!("triangles up to {items}"))?;
        let own = &v.surfaces[source.first as usize..items as usize];
        let is_own = source.plane == NONE || own.contains(&source.plane);
        ensure(is_own, "sources", i, || format!("the plane of triangle {}", source.plane))?;
    }
    let last = v.sources.len().saturating_sub(1);
    ensure(items == v.surfaces.len() as u64, "sources", last, || "triangles are left over".to_owned())?;
    let met = v.scene[0].detail_triangles;
    match v.surfaces.iter().position(|&t| t >= met) {
        Some(i) => invalid("surfaces", i, format!("triangle {}", v.surfaces[i])),
        None => Ok(()),
    }
}

fn grid(v: &Views) -> Result<(), FormatError> {
    let scene = &v.scene[0];
    let ok = scene.grid_step.iter().all(|&s| s > 0.0 && s.is_finite());
    ensure(ok, "scene", 0, || "the grid of cells is none".to_owned())?;
    let cubes = scene.grid_dims.iter().try_fold(1u64, |n, &d| n.checked_mul(u64::from(d)));
    let starts = v.cellgrid.len() as u64;
    ensure(cubes.is_some_and(|n| n < u64::from(u32::MAX) && n + 1 == starts), "cellgrid", 0, || {
        format!("{starts} starts for {:?} cubes", scene.grid_dims)
    })?;
    let ordered = v.cellgrid.windows(2).all(|w| w[0] <= w[1])
        && v.cellgrid[0] == 0
        && v.cellgrid[v.cellgrid.len() - 1] as usize == v.gridcells.len();
    ensure(ordered, "cellgrid", 0, || "the starts do not ascend".to_owned())?;
    for cube in v.cellgrid.windows(2) {
        let (start, end) = (cube[0] as usize, cube[1] as usize);
        let ascending = v.gridcells[start..end].windows(2).all(|cells| cells[0] < cells[1]);
        ensure(ascending, "gridcells", start, || "the cells of a cube do not ascend".to_owned())?;
    }
    match v.gridcells.iter().position(|&cell| cell == 0 || cell as usize >= v.cells.len()) {
        Some(i) => invalid("gridcells", i, format!("cell {}", v.gridcells[i])),
        None => Ok(()),
    }
}
