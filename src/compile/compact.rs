//! How compact the graph of cells is: the paper's Table 1 and the averages of its section 4.

use serde::Serialize;

use crate::format::Tables;
use crate::format::records::CellRecord;

/// The cells of a scene, their faces, and the bytes that both take in its file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Graph {
    /// Prisms of air.
    pub air: u64,
    /// Prisms of matter.
    pub solid: u64,
    /// Vertical sides of a prism of air, on average; the paper's vertical sections: 4.37.
    pub sections_per_cell: f64,
    /// Faces of such a side, on average; the paper: 2.11.
    pub faces_per_section: f64,
    /// Faces of all sides, floors and ceilings.
    pub faces: u64,
    /// What the graph takes: cells, sides, faces, covers, planes.
    pub bytes: u64,
    /// The same for each prism.
    pub bytes_per_cell: f64,
    /// The same for each face.
    pub bytes_per_face: f64,
}

impl Graph {
    /// Of a scene with prisms; `None` if there are none.
    pub(super) fn of(tables: &Tables) -> Option<Graph> {
        let prisms = tables.cells.get(1..).filter(|prisms| !prisms.is_empty())?;
        let (mut air, mut sections, mut faces) = (0u64, 0u64, 0u64);
        for cell in prisms.iter().filter(|cell| cell.kind == CellRecord::AIR) {
            air += 1;
            sections += u64::from(cell.sides);
            let sides = &tables.sides[cell.first_side as usize..(cell.first_side + cell.sides) as usize];
            faces += sides.iter().map(|side| u64::from(side.faces)).sum::<u64>();
        }
        let bytes = [
            size_of_val(&tables.cells[..]),
            size_of_val(&tables.sides[..]),
            size_of_val(&tables.faces[..]),
            size_of_val(&tables.covers[..]),
            size_of_val(&tables.planes[..]),
        ];
        let bytes = bytes.into_iter().sum::<usize>() as u64;
        let all = (tables.faces.len() + tables.covers.len()) as u64;
        let ratio = |one: u64, other: u64| one as f64 / other.max(1) as f64;
        Some(Graph {
            air,
            solid: prisms.len() as u64 - air,
            sections_per_cell: ratio(sections, air),
            faces_per_section: ratio(faces, sections),
            faces: all,
            bytes,
            bytes_per_cell: ratio(bytes, prisms.len() as u64),
            bytes_per_face: ratio(bytes, all),
        })
    }
}
