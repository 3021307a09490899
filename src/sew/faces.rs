//! What two cells have in common: borders of their sides, and parts of ceilings and floors.

use std::ops::Range;

use super::Way;
use super::overlay;
use super::vertices::Vertices;
use crate::lattice::{Point, orient};
use crate::partition::cells::{Cell, Cover, NONE, Partition, Section};

/// A part of the side of a cell beyond which there is one other cell over or under others, or the outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub(super) one: u32,
    /// [`NONE`] for the outside of the hull.
    pub(super) other: u32,
    /// In the plan, the first cell on the left.
    pub(super) ends: [Point; 2],
    pub(super) sources: [u32; 2],
}

/// A face in the making.
#[derive(Clone, Debug)]
pub(super) struct Polygon {
    pub(super) one: u32,
    pub(super) other: u32,
    pub(super) way: Way,
    pub(super) sources: [u32; 2],
    pub(super) corners: Vec<Corner>,
}

/// A corner, and the edge from it to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) vertex: u32,
    /// Over which line of the plan the edge goes, and in which plane; upright edges go over none.
    pub(super) edge: Option<([Point; 2], u32)>,
}

/// The borders of all cells, each once.
pub(super) fn borders(partition: &Partition) -> Vec<Border> {
    let mut borders = Vec::new();
    let points: Vec<Vec<Point>> =
        partition.cells.iter().map(|cell| partition.footprint(cell).collect()).collect();
    for (one, cell) in partition.cells.iter().enumerate() {
        let own = &points[one];
        for (i, section) in sections(partition, cell).iter().enumerate() {
            let ends = [own[i], own[(i + 1) % own.len()]];
            let mut beyond: Vec<u32> = beside(partition, section).map(|cover| cover.cell).collect();
            beyond.sort_unstable();
            beyond.dedup();
            for other in beyond {
                let (source, one) = (source_of(beside(partition, section), other), one as u32);
                if other == NONE {
                    borders.push(Border { one, other, ends, sources: [NONE; 2] });
                } else if one < other {
                    let theirs = &points[other as usize];
                    let their_sections = sections(partition, &partition.cells[other as usize]);
                    borders.extend((0..theirs.len()).filter_map(|k| {
                        let ends = shared(ends, [theirs[k], theirs[(k + 1) % theirs.len()]])?;
                        let sources = [source, source_of(beside(partition, &their_sections[k]), one)];
                        Some(Border { one, other, ends, sources })
                    }));
                }
            }
        }
    }
    borders
}

fn sections<'p>(partition: &'p Partition, cell: &Cell) -> &'p [Section] {
    &partition.sections[cell.sections.start as usize..cell.sections.end as usize]
}

fn beside<'p>(partition: &'p Partition, section: &Section) -> impl Iterator<Item = Cover> + 'p {
    partition.faces[section.faces.start as usize..section.faces.end as usize].iter().map(|face| face.cover)
}

/// The surface towards a cell.
fn source_of(mut covers: impl Iterator<Item = Cover>, beyond: u32) -> u32 {
    covers.find(|cover| cover.cell == beyond && cover.source != NONE).map_or(NONE, |cover| cover.source)
}

/// What two edges have in common that lie on one line and go opposite ways.
fn shared([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<[Point; 2]> {
    if orient(a, b, c) != 0 || orient(a, b, d) != 0 {
        return None;
    }
    let along = |p: Point| {
        let (ux, uy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
        ux * (i64::from(p.x) - i64::from(a.x)) + uy * (i64::from(p.y) - i64::from(a.y))
    };
    if along(c) <= along(d) {
        return None;
    }
    let from = if along(d) > 0 { d } else { a };
    let to = if along(c) < along(b) { c } else { b };
    (along(from) < along(to)).then_some([from, to])
}

/// The common part of a ceiling and a floor, or of one of these and the hull.
#[derive(Clone, Debug)]
pub(super) struct Level {
    one: u32,
    other: u32,
    way: Way,
    plane: u32,
    sources: [u32; 2],
    pub(super) corners: Vec<overlay::Corner>,
}

/// All level and sloped faces.
pub(super) fn levels(partition: &Partition) -> Vec<Level> {
    let mut levels = Vec::new();
    for (one, cell) in partition.cells.iter().enumerate() {
        let footprint: Vec<Point> = partition.footprint(cell).collect();
        let covers = |range: &Range<u32>| &partition.covers[range.start as usize..range.end as usize];
        let mut add = |other: u32, way: Way, plane: u32, sources: [u32; 2]| {
            let corners = match other {
                NONE => overlay::common(&footprint, &footprint),
                other => {
                    let theirs: Vec<Point> = partition.footprint(&partition.cells[other as usize]).collect();
                    overlay::common(&footprint, &theirs)
                }
            };
            levels.push(Level { one: one as u32, other, way, plane, sources, corners });
        };
        let ceiling = Way::Ceiling(cell.ceiling);
        for cover in covers(&cell.above) {
            let from_above = partition
                .cells
                .get(cover.cell as usize)
                .map_or(NONE, |above| source_of(covers(&above.below).iter().copied(), one as u32));
            add(cover.cell, ceiling, cell.ceiling, [cover.source, from_above]);
        }
        if covers(&cell.below).iter().any(|cover| cover.cell == NONE) {
            add(NONE, Way::Floor(cell.floor), cell.floor, [NONE; 2]);
        }
    }
    levels
}

impl Level {
    /// The face; `None` if nothing is left of it.
    pub(super) fn polygon(&self, vertices: &mut Vertices<'_>) -> Option<Polygon> {
        let corner = |corner: &overlay::Corner| Corner {
            vertex: vertices.at(corner.at, self.plane),
            edge: Some((corner.line, self.plane)),
        };
        let corners = self.corners.iter().map(corner).collect();
        polygon([self.one, self.other], self.way, self.sources, corners)
    }
}

/// The face, if it has three corners.
pub(super) fn polygon(
    [one, other]: [u32; 2],
    way: Way,
    sources: [u32; 2],
    mut corners: Vec<Corner>,
) -> Option<Polygon> {
    // An edge whose ends are one vertex is none.
    for i in (0..corners.len()).rev() {
        if corners.len() > 1 && corners[i].vertex == corners[(i + 1) % corners.len()].vertex {
            corners.remove(i);
        }
    }
    (corners.len() > 2).then_some(Polygon { one, other, way, sources, corners })
}
