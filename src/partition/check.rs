//! Whether a partition that someone else may have made is one of a model: all that other stages rely on, but not that its
//! cells fill the hull and agree about their neighbours; that its map tells.

use enfilade_importers::{ElementId, Model};

use super::cells::{Cell, Cover, Label, NONE, Partition, Source};
use super::convex::is_convex;
use crate::lattice::{FINE, LARGEST, Lattice, Plane, Point};

impl Partition {
    /// Checks that the lattice is one, that cells are prisms on it, and that every index is there, those of `model`, too.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn check(&self, model: &Model) -> Result<(), String> {
        self.check_frame()?;
        for (number, cell) in self.cells.iter().enumerate() {
            self.check_cell(model, cell).map_err(|what| format!("cell {number}: {what}"))?;
        }
        check_triangles(model, &self.sources, &self.detail)
    }

    /// Checks what all coordinates hang on.
    ///
    /// # Errors
    /// If the partition's lattice is none, its hull no box on it, or a plane too steep.
    pub(crate) fn check_frame(&self) -> Result<(), String> {
        check_frame(&self.lattice, self.hull, &self.planes, self.cells.is_empty())
    }

    fn check_cell(&self, model: &Model, cell: &Cell) -> Result<(), &'static str> {
        if let Label::Air(element) | Label::Solid(element) = cell.label
            && element.0 as usize >= model.elements.len()
        {
            return Err("its element is not there");
        }
        if [cell.floor, cell.ceiling].iter().any(|&plane| plane as usize >= self.planes.len()) {
            return Err("a plane of it is not there");
        }
        let slice = |range: &std::ops::Range<u32>| range.start as usize..range.end as usize;
        let sections = self.sections.get(slice(&cell.sections)).ok_or("its sections are not there")?;
        let corners: Vec<Point> = sections.iter().map(|section| section.start).collect();
        if corners.iter().any(|p| [p.x, p.y].iter().any(|c| c.unsigned_abs() > LARGEST as u32)) {
            return Err("a corner is beyond the lattice");
        }
        if !is_convex(&corners) {
            return Err("its footprint is not convex: it is no prism");
        }
        for section in sections {
            let faces = self.faces.get(slice(&section.faces)).ok_or("faces are not there")?;
            if faces.is_empty() {
                return Err("a section has no face");
            }
            for face in faces {
                if face.top != NONE && face.top as usize >= self.planes.len() {
                    return Err("a plane of a face is not there");
                }
                self.check_cover(&face.cover)?;
            }
        }
        let below = self.covers.get(slice(&cell.below)).ok_or("what lies below is not there")?;
        let above = self.covers.get(slice(&cell.above)).ok_or("what lies above is not there")?;
        below.iter().chain(above).try_for_each(|cover| self.check_cover(cover))
    }

    fn check_cover(&self, cover: &Cover) -> Result<(), &'static str> {
        let is_known = (cover.cell == NONE || (cover.cell as usize) < self.cells.len())
            && (cover.source == NONE || (cover.source as usize) < self.sources.len());
        if is_known { Ok(()) } else { Err("what lies beyond a face is not there") }
    }
}

/// Checks that all triangles are there, of surfaces and of detail.
///
/// # Errors
/// What is wrong, in words.
pub(crate) fn check_triangles(
    model: &Model,
    sources: &[Source],
    detail: &[(ElementId, u32)],
) -> Result<(), String> {
    let is_triangle = |(element, triangle): &(ElementId, u32)| {
        let mesh = model.elements.get(element.0 as usize).map(|element| &element.mesh);
        mesh.is_some_and(|mesh| (*triangle as usize) < mesh.triangles.len())
    };
    for (number, source) in sources.iter().enumerate() {
        let is_plane = source.plane.is_none_or(|plane| (plane as usize) < source.triangles.len());
        if source.triangles.is_empty() || !is_plane || !source.triangles.iter().all(is_triangle) {
            return Err(format!("source {number} has no triangle, or one that is not there"));
        }
    }
    match detail.iter().find(|triangle| !is_triangle(triangle)) {
        Some((element, triangle)) => {
            Err(format!("triangle {triangle} of element {} is not there", element.0))
        }
        None => Ok(()),
    }
}

/// Checks a lattice, a box on it and planes over it: that no computation with them overflows. An empty box will do if `is_empty`.
///
/// # Errors
/// What is wrong, in words.
pub(crate) fn check_frame(
    lattice: &Lattice,
    hull: [[i32; 3]; 2],
    planes: &[Plane],
    is_empty: bool,
) -> Result<(), String> {
    let is_lattice = (Lattice::COARSEST..=Lattice::FINEST).contains(&lattice.bits)
        && (lattice.turn[0].hypot(lattice.turn[1]) - 1.0).abs() <= 1e-12
        && lattice.origin.iter().all(|c| c.is_finite() && c.fract() == 0.0);
    if !is_lattice {
        return Err("its lattice is none".to_owned());
    }
    let [lo, hi] = hull;
    let on_lattice = |c: &i32| c.unsigned_abs() <= LARGEST as u32;
    let steepest = Plane::STEEPEST as u64 * FINE as u64;
    let fits = |plane: &Plane| {
        plane.p.unsigned_abs() <= steepest
            && plane.q.unsigned_abs() <= steepest
            && plane.r.unsigned_abs() <= 1 << 61
    };
    if let Some(index) = planes.iter().position(|plane| !fits(plane)) {
        return Err(format!("plane {index} is too steep, or too far"));
    }
    let is_box = lo.iter().chain(&hi).all(on_lattice) && (0..3).all(|axis| lo[axis] < hi[axis]);
    if is_box || is_empty { Ok(()) } else { Err("its hull is no box".to_owned()) }
}
