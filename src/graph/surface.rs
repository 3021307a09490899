//! The surfaces of cells as polygons.

use glam::DVec3;

use super::measure::{area, covered, footprint};
use crate::format::records::CellRecord;
use crate::trace::{NONE, Prisms};

/// A part of a cell's surface: corners in the internal frame, counter-clockwise seen from outside the cell; the cell beyond, the
/// surface's source, the number of its kind.
pub(crate) struct Part {
    pub(crate) corners: Vec<DVec3>,
    pub(crate) beyond: u32,
    pub(crate) source: u32,
    pub(crate) kind: u32,
    // Only the compiler writes records.
    #[cfg_attr(not(feature = "compile"), allow(dead_code))]
    pub(crate) at: At,
}

/// Which record of a scene a part of a surface has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "compile"), allow(dead_code))]
pub(crate) enum At {
    /// Index into the section `faces`.
    Face(u32),
    /// Index into the section `covers`.
    Cover(u32),
}

/// All parts of a cell's surface that have an area.
pub(crate) fn parts(prisms: &Prisms<'_>, cell: &CellRecord) -> Vec<Part> {
    let own = footprint(prisms, cell);
    let mut parts = Vec::new();
    for (i, side) in prisms.sides_of(cell).iter().enumerate() {
        let ends = [own[i], own[(i + 1) % own.len()]];
        let heights = |plane: u32| ends.map(|p| prisms.height(plane, p));
        let (mut below, ceiling) = (heights(cell.floor), heights(cell.ceiling));
        for (face, number) in prisms.faces_of(side).iter().zip(0..) {
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
                let at = At::Face(side.first_face + number);
                parts.push(Part {
                    corners,
                    beyond: face.cell,
                    source: face.source,
                    kind: face.kind.into(),
                    at,
                });
            }
            below = top;
        }
    }
    let (below, above) = prisms.covers_of(cell);
    for (covers, plane, is_up) in [(below, cell.floor, false), (above, cell.ceiling, true)] {
        for ((cover, mut polygon), number) in covers.iter().zip(covered(prisms, &own, covers)).zip(0..) {
            let at = At::Cover(cell.first_cover + if is_up { cell.below } else { 0 } + number);
            if area(&polygon) <= 0.0 {
                continue;
            }
            if !is_up {
                polygon.reverse();
            }
            let corners =
                polygon.into_iter().map(|p| prisms.global(p.extend(prisms.height(plane, p)))).collect();
            parts.push(Part {
                corners,
                beyond: cover.cell,
                source: cover.source,
                kind: cover.kind.into(),
                at,
            });
        }
    }
    parts
}

impl Part {
    /// Square metres.
    pub(super) fn area(&self) -> f64 {
        let Some(&first) = self.corners.first() else { return 0.0 };
        let twice = self.corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first));
        twice.sum::<DVec3>().length() / 2.0
    }
}
