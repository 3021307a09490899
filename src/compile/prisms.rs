//! The cells of a partition as the tables of a scene.

use enfilade_importers::{ElementId, Model, Semantic};

use super::geometry::Gathered;
use crate::building::{FaceKind, NamedCells};
use crate::format::Tables;
use crate::format::records::{
    CellRecord, CoverRecord, FaceRecord, PlaneRecord, SideRecord, SourceRecord, Traits,
};
use crate::lattice::{FINE, LARGEST, Point, orient};
use crate::partition::cells::{Cell, Cover, Face, Label, NONE, Partition, Section};

/// The zone of a partition's cells, metres along the lattice's axes from its origin; `None` if it has no cells.
pub(super) fn zone(partition: &Partition) -> Option<[[f64; 3]; 2]> {
    let step = partition.lattice.step();
    let corner = |i: usize| partition.hull[i].map(|c| f64::from(c) * step);
    (!partition.cells.is_empty()).then(|| [corner(0), corner(1)])
}

/// What cells became.
#[derive(Clone, Copy, Debug)]
pub(super) struct Added {
    /// That of sloped cells, if there are any.
    pub(super) traits: Traits,
    /// Parts of surfaces that mean the same to rays as the one beside them, and became one with it.
    pub(super) joined: u64,
}

/// Fills the sections `cells` (without roots), `sides`, `faces`, `covers`, `planes`, `sources` (without roots) and
/// `surfaces`. `hull` is that of the scene.
///
/// # Errors
/// What is wrong with the partition: an index out of range, a cell that is no prism.
pub(super) fn add(
    model: &Model,
    cells: &NamedCells,
    gathered: &Gathered,
    hull: [[f64; 3]; 2],
    tables: &mut Tables,
) -> Result<Added, String> {
    let partition = &cells.partition;
    let around = if partition.cells.is_empty() { Semantic::Unknown } else { Semantic::Exterior };
    tables.cells.push(CellRecord {
        bounds: hull,
        kind: CellRecord::AROUND,
        semantic: around.number() as u16,
        flags: 0,
        element: NONE,
        room: NONE,
        root: NONE,
        floor: NONE,
        ceiling: NONE,
        first_side: 0,
        sides: 0,
        first_cover: 0,
        below: 0,
        above: 0,
    });
    let step = partition.lattice.step();
    tables.planes.extend(partition.planes.iter().map(|plane| PlaneRecord {
        slope: [plane.p as f64 / FINE as f64, plane.q as f64 / FINE as f64],
        height: plane.r as f64 / FINE as f64 * step,
    }));
    let mut rooms = vec![NONE; model.elements.len()];
    for (room, record) in tables.rooms.iter().enumerate() {
        rooms[record.element as usize] = room as u32;
    }
    let mut run = Run { model, cells, partition, rooms: &rooms, sloped: false, joined: 0 };
    for (i, cell) in partition.cells.iter().enumerate() {
        run.cell(cell, tables).map_err(|what| format!("cell {i}: {what}"))?;
    }
    let added = Added { traits: Traits(if run.sloped { Traits::SLOPED } else { 0 }), joined: run.joined };
    for (i, source) in partition.sources.iter().enumerate() {
        let first = tables.surfaces.len();
        for &triangle in &source.triangles {
            let scene = scene_triangle(gathered, triangle).map_err(|what| format!("source {i}: {what}"))?;
            tables.surfaces.push(scene);
        }
        tables.surfaces[first..].sort_unstable();
        if source.triangles.is_empty() {
            return Err(format!("source {i} has no triangle"));
        }
        dedup_from(&mut tables.surfaces, first);
        let count = (tables.surfaces.len() - first) as u32;
        let plane = source.plane.map(|plane| {
            let triangle = source.triangles.get(plane as usize).ok_or("its plane is not there".to_owned());
            triangle.and_then(|&triangle| scene_triangle(gathered, triangle))
        });
        let plane = plane.transpose().map_err(|what| format!("source {i}: {what}"))?.unwrap_or(NONE);
        tables.sources.push(SourceRecord { first: first as u32, count, root: NONE, plane });
    }
    Ok(added)
}

/// The sections of a footprint from the first on at which its border turns.
fn from_a_corner(sections: &[Section]) -> Vec<Section> {
    let count = sections.len();
    let turns = |&i: &usize| {
        let [a, b, c] = [i + count - 1, i, i + 1].map(|i| sections[i % count].start);
        orient(a, b, c) != 0
    };
    let first = (0..count).find(turns).unwrap_or(0);
    sections[first..].iter().chain(&sections[..first]).cloned().collect()
}

/// Drops repeated items of the sorted end of `items`, from `first` on.
fn dedup_from(items: &mut Vec<u32>, first: usize) {
    let mut kept = first;
    for i in first..items.len() {
        if i == first || items[i] != items[kept - 1] {
            items[kept] = items[i];
            kept += 1;
        }
    }
    items.truncate(kept);
}

/// The scene's triangle that a triangle of an element's mesh became.
///
/// # Errors
/// If there is none, or rays do not meet it.
pub(super) fn scene_triangle(
    gathered: &Gathered,
    (element, triangle): (ElementId, u32),
) -> Result<u32, String> {
    let index = gathered.index.get(element.0 as usize).and_then(|of| of.get(triangle as usize)).copied();
    match index {
        Some(index) if index < gathered.detail_triangles => Ok(index),
        _ => Err(format!("triangle {triangle} of element {} is none that rays meet", element.0)),
    }
}

struct Run<'a> {
    model: &'a Model,
    cells: &'a NamedCells,
    partition: &'a Partition,
    /// The room that each element labels.
    rooms: &'a [u32],
    sloped: bool,
    /// Parts of surfaces that became one with another.
    joined: u64,
}

impl Run<'_> {
    fn cell(&mut self, cell: &Cell, tables: &mut Tables) -> Result<(), String> {
        let partition = self.partition;
        let slice = |range: &std::ops::Range<u32>| range.start as usize..range.end as usize;
        let sections = partition.sections.get(slice(&cell.sections)).ok_or("its sections are not there")?;
        let sections = &from_a_corner(sections)[..];
        let below = partition.covers.get(slice(&cell.below)).ok_or("what lies below is not there")?;
        let above = partition.covers.get(slice(&cell.above)).ok_or("what lies above is not there")?;
        let plane = |index: u32| partition.planes.get(index as usize).ok_or("a plane is not there");
        let (floor, ceiling) = (plane(cell.floor)?, plane(cell.ceiling)?);
        self.sloped |= !floor.is_level() || !ceiling.is_level();
        let step = partition.lattice.step();
        let (first_side, first_cover) = (tables.sides.len() as u32, tables.covers.len() as u32);
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for (number, section) in sections.iter().enumerate() {
            let p = section.start;
            if [p.x, p.y].iter().any(|c| c.unsigned_abs() > LARGEST as u32) {
                return Err("a corner is beyond the lattice".to_owned());
            }
            let faces = partition.faces.get(slice(&section.faces)).ok_or("faces are not there")?;
            if number > 0 && self.goes_on(&sections[number - 1..], sections[0].start) {
                self.joined += 1;
                continue;
            }
            tables.sides.push(SideRecord {
                // Exact: 24 bits and a power of two.
                start: [p.x, p.y].map(|c| (f64::from(c) * step) as f32),
                first_face: tables.faces.len() as u32,
                faces: faces.len() as u32,
            });
            for (face, number) in faces.iter().zip(section.faces.start as usize..) {
                if face.top != NONE {
                    plane(face.top)?;
                }
                let CoverRecord { cell, source, kind, flags } =
                    self.cover(&face.cover, &self.cells.faces, number)?;
                tables.faces.push(FaceRecord { top: face.top, cell, source, kind, flags });
            }
            let [low, high] = [floor, ceiling].map(|plane| plane.height(p) as f64 / FINE as f64);
            for (c, axis) in [(f64::from(p.x), 0), (f64::from(p.y), 1), (low, 2), (high, 2)] {
                let c = c * step;
                bounds[0][axis] = bounds[0][axis].min(c);
                bounds[1][axis] = bounds[1][axis].max(c);
            }
        }
        let below = self.covers(below, cell.below.start as usize, tables)?;
        let above = self.covers(above, cell.above.start as usize, tables)?;
        let (kind, semantic, element) = self.label(cell.label)?;
        tables.cells.push(CellRecord {
            bounds,
            kind,
            semantic: semantic.number() as u16,
            flags: if kind == CellRecord::AIR { CellRecord::FREE } else { 0 },
            element,
            room: self.rooms.get(element as usize).copied().unwrap_or(NONE),
            root: NONE,
            floor: cell.floor,
            ceiling: cell.ceiling,
            first_side,
            sides: tables.sides.len() as u32 - first_side,
            first_cover,
            below,
            above,
        });
        Ok(())
    }

    /// Adds what covers a floor or a ceiling; `first` is the number of the first. Returns how many were added: one, if all mean the same.
    ///
    /// # Errors
    /// What is not there.
    fn covers(&mut self, covers: &[Cover], first: usize, tables: &mut Tables) -> Result<u32, String> {
        let own = tables.covers.len();
        for (cover, number) in covers.iter().zip(first..) {
            let cover = self.cover(cover, &self.cells.covers, number)?;
            tables.covers.push(cover);
        }
        let meaning = |i: usize| self.meaning(&covers[i], self.cells.covers.get(first + i));
        if covers.len() > 1 && meaning(0).is_some() && (1..covers.len()).all(|i| meaning(i) == meaning(0)) {
            self.joined += covers.len() as u64 - 1;
            tables.covers.truncate(own + 1);
        }
        Ok((tables.covers.len() - own) as u32)
    }

    /// What a part of a surface is to rays: the matter behind it, its triangles and its kind. `None` if rays go on there, or have no
    /// triangles to meet.
    fn meaning(&self, cover: &Cover, kind: Option<&FaceKind>) -> Option<(ElementId, u32, FaceKind)> {
        match self.partition.cells.get(cover.cell as usize)?.label {
            Label::Solid(element) if cover.source != NONE => Some((element, cover.source, *kind?)),
            _ => None,
        }
    }

    /// Whether the second of these sections goes straight on from the first and has the same meanings behind it, so that they are one.
    /// `end` is where the last one ends.
    fn goes_on(&self, sections: &[Section], end: Point) -> bool {
        let [before, here, rest @ ..] = sections else { return false };
        if orient(before.start, here.start, rest.first().map_or(end, |next| next.start)) != 0 {
            return false;
        }
        let stack = |section: &Section| section.faces.start as usize..section.faces.end as usize;
        let (before, here) = (stack(before), stack(here));
        let is_same = |(a, b): (usize, usize)| {
            let (Some(one), Some(other)) = (self.partition.faces.get(a), self.partition.faces.get(b)) else {
                return false;
            };
            let kinds = [a, b].map(|number| self.cells.faces.get(number));
            let means = |face: &Face, kind| self.meaning(&face.cover, kind);
            let meaning = means(one, kinds[0]);
            let is_same = meaning.is_some() && meaning == means(other, kinds[1]);
            (one == other && kinds[0] == kinds[1]) || (one.top == other.top && is_same)
        };
        before.len() == here.len() && !here.is_empty() && before.zip(here).all(is_same)
    }

    fn cover(&self, cover: &Cover, kinds: &[FaceKind], number: usize) -> Result<CoverRecord, String> {
        let known = (cover.cell == NONE || (cover.cell as usize) < self.partition.cells.len())
            && (cover.source == NONE || (cover.source as usize) < self.partition.sources.len());
        if !known {
            return Err(format!("{cover:?} is not there"));
        }
        let kind = kinds.get(number).ok_or("what a face is called is not known")?.number() as u16;
        // Cell 0 is what lies around: beyond the hull, or none.
        Ok(CoverRecord { cell: cover.cell.wrapping_add(1), source: cover.source, kind, flags: 0 })
    }

    fn label(&self, label: Label) -> Result<(u32, Semantic, u32), String> {
        let of = |element: ElementId| {
            let found = self.model.elements.get(element.0 as usize);
            found.map(|e| e.semantic).ok_or_else(|| format!("element {} is not there", element.0))
        };
        Ok(match label {
            Label::Solid(element) => (CellRecord::SOLID, of(element)?, element.0),
            Label::Air(element) => (CellRecord::AIR, of(element)?, element.0),
            Label::Exterior => (CellRecord::AIR, Semantic::Exterior, NONE),
            Label::Void => (CellRecord::AIR, Semantic::Void, NONE),
        })
    }
}
