//! The building's own graph: its rooms, what its openings join, where air meets air, and what bounds each room.
//!
//! All of it is read off a scene ([`Scene::graph`]), so that a scene's file and the model that it was compiled from give the same graph.
//! `docs/GRAPH.md` tells how, and what the numbers mean.

mod contacts;
mod ends;
mod line;
mod measure;
mod sides;
mod surface;

#[cfg(feature = "compile")]
pub(crate) use contacts::fills;
#[cfg(feature = "compile")]
pub(crate) use measure::clipped;
pub(crate) use measure::{area, cut, footprint};
#[cfg(feature = "compile")]
pub(crate) use surface::At;
pub(crate) use surface::{Part, parts};

use std::collections::{BTreeMap, BTreeSet};

use crate::format::FaceKind;
use crate::format::records::CellRecord;
use crate::scene::Scene;
use crate::trace::{NONE, Prisms};
use enfilade_importers::Semantic;

/// The graph of a building. Everything is in metres, internal frame.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Graph {
    /// By room of the scene ([`Scene::room`]).
    pub rooms: Vec<RoomNode>,
    /// The doors, windows and openings that are air, in the order of their elements.
    pub openings: Vec<OpeningNode>,
    /// Where two places touch, or are joined by an opening that is not closed: in the order of their places, then openings.
    pub portals: Vec<Passage>,
    /// What bounds rooms, the open and voids, by kind and element; square metres.
    pub faces: BTreeMap<(Place, FaceKind, Option<u32>), f64>,
    /// Air that neither a label fills nor the open reaches, piece by piece.
    pub voids: Vec<VoidNode>,
}

/// A volume of air that is no opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    /// The room with this index.
    Room(u32),
    /// The open.
    Exterior,
    /// The void with this index.
    Void(u32),
}

/// What lies beyond an end of an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The room with this index.
    Room(u32),
    /// The open.
    Exterior,
    /// Air that neither a room labels nor the open reaches, or no air within half a metre.
    Void,
}

/// A room.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RoomNode {
    /// Index of its element.
    pub element: u32,
    /// Its cells, ascending. None, if it has no air of its own, or the scene has no cells.
    pub cells: Vec<u32>,
    /// Volume of its air, m3: of its cells. Of a scene without cells, and of a room without, that of its label.
    pub volume: f64,
    /// Area in the plan of what its air stands on, m2: matter, or the open or a void where no floor was modelled, but no hole in a floor, and
    /// no other room.
    pub floor_area: f64,
}

/// An opening.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct OpeningNode {
    /// Index of its element.
    pub element: u32,
    /// What is beyond where it begins, and where it ends.
    pub sides: [Side; 2],
    /// The way through it, from its first side to its second; of unit length.
    pub direction: [f64; 3],
    /// The middles of its two ends.
    pub ends: [[f64; 3]; 2],
    /// Its cells, ascending; none where it was not cut from its host, or other labels fill it.
    pub cells: Vec<u32>,
    /// Whether it was closed ([`Scene::set_open`]).
    pub closed: bool,
}

/// A place where air meets air.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Passage {
    /// What it joins, in order.
    pub places: [Place; 2],
    /// Index of the opening's element; `None` where they touch.
    pub opening: Option<u32>,
    /// Square metres: of an opening the lesser of what it shares with the one and with the other.
    pub area: f64,
}

/// A void.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct VoidNode {
    /// Its cells, ascending.
    pub cells: Vec<u32>,
    /// Volume, m3.
    pub volume: f64,
    /// The box around it, internal frame: lower and upper corner.
    pub bounds: [[f64; 3]; 2],
}

/// What fills a cell, or lies around them all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Fill {
    Place(Place),
    /// The opening of this element.
    Opening(u32),
    Solid,
    Around,
}

#[cfg(feature = "compile")]
impl Fill {
    pub(crate) fn is_air(self) -> bool {
        matches!(self, Fill::Place(_) | Fill::Opening(_))
    }
}

/// The place that something is; `None` for openings and matter.
#[cfg(feature = "compile")]
pub(crate) fn place_of(fill: Fill) -> Option<Place> {
    if let Fill::Place(place) = fill { Some(place) } else { None }
}

impl Scene {
    /// The building's own graph. A scene without cells has rooms and nothing else.
    pub fn graph(&self) -> Graph {
        let prisms = Prisms::new(&self.tables);
        let mut graph =
            Graph { rooms: self.rooms().map(|room| RoomNode::labelled(&room)).collect(), ..Graph::default() };
        if prisms.cells.len() <= 1 {
            return graph;
        }
        let fills = contacts::fills(&prisms);
        graph.gather(&prisms, &fills);
        let prober = sides::Prober { scene: self, prisms };
        let openings: Vec<u32> =
            self.elements().filter(|e| is_opening(e.semantic())).map(|e| e.index()).collect();
        let leads = crate::parallel::map(openings.len(), |i| prober.leads(openings[i]));
        let mut cells: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (fill, cell) in fills.iter().zip(0..) {
            if let Fill::Opening(element) = fill {
                cells.entry(*element).or_default().push(cell);
            }
        }
        let closed = self.closures().iter().map(|closure| closure.opening).collect::<BTreeSet<u32>>();
        for (element, leads) in openings.into_iter().zip(leads) {
            let Some(leads) = leads else { continue };
            graph.openings.push(OpeningNode {
                element,
                sides: leads.sides,
                direction: leads.direction.to_array(),
                ends: leads.ends.map(|end| end.to_array()),
                cells: cells.remove(&element).unwrap_or_default(),
                closed: closed.contains(&element),
            });
        }
        let contacts = contacts::Contacts::of(self, &prisms, &fills);
        graph.portals = contacts.passages(&closed);
        graph.faces = contacts.faces;
        graph
    }
}

impl RoomNode {
    /// As its label says.
    fn labelled(room: &crate::scene::RoomView<'_>) -> RoomNode {
        RoomNode {
            element: room.element().index(),
            cells: Vec::new(),
            volume: room.volume().unwrap_or(0.0),
            floor_area: room.floor_area().unwrap_or(0.0),
        }
    }
}

impl Graph {
    /// Reads off the cells what rooms and voids are made of.
    fn gather(&mut self, prisms: &Prisms<'_>, fills: &[Fill]) {
        for (fill, cell) in fills.iter().zip(0u32..) {
            let Fill::Place(place) = *fill else { continue };
            let record = &prisms.cells[cell as usize];
            let volume = measure::volume(prisms, record);
            match place {
                Place::Room(room) => {
                    let room = &mut self.rooms[room as usize];
                    if room.cells.is_empty() {
                        (room.volume, room.floor_area) = (0.0, 0.0);
                    }
                    room.cells.push(cell);
                    room.volume += volume;
                    let below = prisms.covers_of(record).0;
                    let parts = measure::covered(prisms, &measure::footprint(prisms, record), below);
                    let areas = parts.iter().map(|part| measure::area(part).max(0.0));
                    let is_floor = |cover: u32| {
                        !matches!(fills[cover as usize], Fill::Place(Place::Room(_)) | Fill::Opening(_))
                    };
                    let floors = below.iter().zip(areas).filter(|(cover, _)| is_floor(cover.cell));
                    room.floor_area += floors.map(|(_, area)| area).sum::<f64>();
                }
                Place::Void(void) => {
                    while self.voids.len() <= void as usize {
                        let bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
                        self.voids.push(VoidNode { cells: Vec::new(), volume: 0.0, bounds });
                    }
                    let void = &mut self.voids[void as usize];
                    void.cells.push(cell);
                    void.volume += volume;
                    for corner in measure::corners(prisms, record) {
                        for axis in 0..3 {
                            void.bounds[0][axis] = void.bounds[0][axis].min(corner[axis]);
                            void.bounds[1][axis] = void.bounds[1][axis].max(corner[axis]);
                        }
                    }
                }
                Place::Exterior => {}
            }
        }
    }

    /// The openings that lead from one place to another.
    pub fn openings_between(&self, one: Side, other: Side) -> impl Iterator<Item = &OpeningNode> {
        self.openings
            .iter()
            .filter(move |opening| opening.sides == [one, other] || opening.sides == [other, one])
    }
}

/// The way through an opening, of unit length, internal frame; `None` if it has no mesh.
pub(crate) fn way_through(scene: &Scene, opening: u32) -> Option<glam::DVec3> {
    let prober = sides::Prober { scene, prisms: Prisms::new(&scene.tables) };
    prober.leads(opening).map(|leads| leads.direction)
}

/// The opening that a cell is air of.
pub(crate) fn opening_of(cell: &CellRecord) -> Option<u32> {
    match (cell.kind, air(cell)) {
        (CellRecord::AIR, Fill::Opening(element)) => Some(element),
        _ => None,
    }
}

/// Whether an element is an opening, by its meaning.
pub(crate) fn is_opening(semantic: Semantic) -> bool {
    matches!(semantic, Semantic::Door | Semantic::Window | Semantic::Opening)
}

/// What a cell of air is; voids are not told from each other.
fn air(cell: &CellRecord) -> Fill {
    match Semantic::from_number(cell.semantic.into()).unwrap_or_default() {
        semantic if is_opening(semantic) && cell.element != NONE => Fill::Opening(cell.element),
        Semantic::Exterior => Fill::Place(Place::Exterior),
        _ if cell.room != NONE => Fill::Place(Place::Room(cell.room)),
        _ => Fill::Place(Place::Void(0)),
    }
}
