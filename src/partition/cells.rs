//! What the partition returns: convex prisms, and what lies beyond each part of their surface.

use std::ops::Range;

use enfilade_importers::ElementId;

use crate::lattice::{Lattice, Plane, Point};

/// What stands for no cell, no source, no plane.
pub const NONE: u32 = u32::MAX;

/// What fills a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Label {
    /// Matter: this element, or several of which this is the first.
    Solid(ElementId),
    /// Air that this element labels: a room, an opening, a stairwell...
    Air(ElementId),
    /// Unlabelled air that reaches the hull.
    Exterior,
    /// Unlabelled air that does not.
    Void,
}

impl Label {
    /// Whether light passes.
    pub fn is_air(&self) -> bool {
        !matches!(self, Label::Solid(_))
    }
}

/// A convex prism: the points over a convex footprint, above one plane and below another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// What fills it.
    pub label: Label,
    /// Index of the plane of its floor.
    pub floor: u32,
    /// Index of the plane of its ceiling.
    pub ceiling: u32,
    /// Its footprint, counter-clockwise: each section starts where the one before ends, the last ends where the first
    /// starts. Exactly convex; neighbouring sections may lie on one line.
    pub sections: Range<u32>,
    /// What lies below the floor, in [`Partition::covers`].
    pub below: Range<u32>,
    /// What lies above the ceiling, in [`Partition::covers`].
    pub above: Range<u32>,
}

/// One vertical side of a cell: over the edge from `start` to the next section's start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// Where it starts.
    pub start: Point,
    /// Its faces from the floor up, in [`Partition::faces`]; never empty.
    pub faces: Range<u32>,
}

/// A part of a section: what lies above the faces before it, between the cell's floor and ceiling, and below its upper
/// edge. Planes may cross over a section, so that a face has only some of its length; at any point of the section, the
/// first face whose upper edge lies above the point is the one that it lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Face {
    /// Index of the plane at its upper edge; [`NONE`] for the last face, which reaches up to the ceiling.
    pub top: u32,
    /// What lies beyond.
    pub cover: Cover,
}

/// What lies beyond a part of a cell's surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cover {
    /// The cell beyond; [`NONE`] outside the hull.
    pub cell: u32,
    /// Between air and matter: index of the triangles that make the surface here, in [`Partition::sources`]; else
    /// [`NONE`].
    pub source: u32,
}

/// The source's own triangles behind a part of a cell's surface: what a ray that arrives there hits.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Triangles, as element and index in its mesh, in ascending order; never empty. Any of them may be met near any
    /// point of the surface. They face the air.
    pub triangles: Vec<(ElementId, u32)>,
    /// Place in `triangles` of one in whose plane all of them lie, to a micrometre: a ray may meet that plane instead of
    /// the triangles. `None` if there is none.
    pub plane: Option<u32>,
}

/// The hull cut into cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Partition {
    /// The grid of all coordinates.
    pub lattice: Lattice,
    /// The box that the cells fill, lattice units.
    pub hull: [[i32; 3]; 2],
    /// Planes of floors, ceilings and faces' upper edges.
    pub planes: Vec<Plane>,
    /// The cells.
    pub cells: Vec<Cell>,
    /// Sides of cells.
    pub sections: Vec<Section>,
    /// Faces of sides.
    pub faces: Vec<Face>,
    /// What lies below floors and above ceilings.
    pub covers: Vec<Cover>,
    /// Surfaces.
    pub sources: Vec<Source>,
    /// Triangles that no cell face stands for, which rays must test: element and index in its mesh, ascending.
    pub detail: Vec<(ElementId, u32)>,
}

impl Partition {
    /// A partition without cells, for what cannot be partitioned: all that rays can meet is detail of one zone, which
    /// need not be listed.
    pub fn whole() -> Partition {
        Partition {
            lattice: Lattice { origin: [0.0; 3], turn: [1.0, 0.0], bits: Lattice::FINEST },
            hull: [[0; 3]; 2],
            planes: Vec::new(),
            cells: Vec::new(),
            sections: Vec::new(),
            faces: Vec::new(),
            covers: Vec::new(),
            sources: Vec::new(),
            detail: Vec::new(),
        }
    }

    /// The footprint of a cell, counter-clockwise.
    pub fn footprint(&self, cell: &Cell) -> impl ExactSizeIterator<Item = Point> + Clone {
        self.sections[cell.sections.start as usize..cell.sections.end as usize].iter().map(|s| s.start)
    }

    /// The cells beyond all parts of a cell's surface, [`NONE`] for the hull's outside; one may come often.
    pub fn neighbours<'a>(&'a self, cell: &Cell) -> impl Iterator<Item = u32> + 'a {
        let sections = &self.sections[cell.sections.start as usize..cell.sections.end as usize];
        let sides = sections
            .iter()
            .flat_map(|s| &self.faces[s.faces.start as usize..s.faces.end as usize])
            .map(|face| face.cover.cell);
        let below = &self.covers[cell.below.start as usize..cell.below.end as usize];
        let above = &self.covers[cell.above.start as usize..cell.above.end as usize];
        sides.chain(below.iter().chain(above).map(|cover| cover.cell))
    }
}
