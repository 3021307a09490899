//! The surfaces of cells as polygons.

use glam::{DVec2, DVec3};

use crate::format::records::{CellRecord, CoverRecord};
use crate::graph::{area, clipped, footprint};
use crate::trace::{NONE, Prisms};

/// A part of a cell's surface: corners in the internal frame, counter-clockwise seen from outside the cell; the cell beyond, the
/// number of its kind.
pub(super) struct Part {
    pub(super) corners: Vec<DVec3>,
    pub(super) beyond: u32,
    pub(super) kind: u32,
}

/// All parts of a cell's surface that have an area.
pub(super) fn parts(prisms: &Prisms<'_>, cell: &CellRecord) -> Vec<Part> {
    let own = footprint(prisms, cell);
    let mut parts = Vec::new();
    for (i, side) in prisms.sides_of(cell).iter().enumerate() {
        let ends = [own[i], own[(i + 1) % own.len()]];
        let heights = |plane: u32| ends.map(|p| prisms.height(plane, p));
        let (mut below, ceiling) = (heights(cell.floor), heights(cell.ceiling));
        for face in prisms.faces_of(side) {
            let top = if face.top == NONE { ceiling } else { heights(face.top) };
            let top =
                [0, 1].map(|end| top[end].clamp(below[end].min(ceiling[end]), ceiling[end].max(below[end])));
            // Along the edge at the bottom, back along the top; one end may have no height.
            let mut corners = vec![ends[0].extend(below[0]), ends[1].extend(below[1])];
            if top[1] > below[1] {
                corners.push(ends[1].extend(top[1]));
            }
            if top[0] > below[0] {
                corners.push(ends[0].extend(top[0]));
            }
            if corners.len() >= 3 {
                let corners = corners.into_iter().map(|p| prisms.global(p)).collect();
                parts.push(Part { corners, beyond: face.cell, kind: face.kind });
            }
            below = top;
        }
    }
    let (below, above) = prisms.covers_of(cell);
    for (covers, plane, is_up) in [(below, cell.floor, false), (above, cell.ceiling, true)] {
        for cover in covers {
            let mut polygon = covered(prisms, &own, covers.len(), cover);
            if area(&polygon) <= 0.0 {
                continue;
            }
            if !is_up {
                polygon.reverse();
            }
            let corners =
                polygon.into_iter().map(|p| prisms.global(p.extend(prisms.height(plane, p)))).collect();
            parts.push(Part { corners, beyond: cover.cell, kind: cover.kind });
        }
    }
    parts
}

/// What of a footprint one of its covers covers.
fn covered(prisms: &Prisms<'_>, own: &[DVec2], count: usize, cover: &CoverRecord) -> Vec<DVec2> {
    let other = &prisms.cells[cover.cell as usize];
    if count == 1 || other.kind == CellRecord::AROUND {
        return own.to_vec();
    }
    clipped(own.to_vec(), &footprint(prisms, other))
}
