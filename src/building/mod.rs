//! The building: its map, with a meaning for every volume and every face.
//!
//! `docs/TOPOLOGY.md` tells how it is made. A volume of the map is a cell of the partition and has its label; a face has a
//! [`FaceKind`], the element and the material whose surface it is, and its area. What users ask of a building is in
//! [`Building::rooms`], [`Building::neighbours`], [`Building::areas`], [`Building::openings_between`], [`Building::way`].

mod cells;
mod kind;
mod looks;
mod portals;
mod queries;
mod stored;
#[cfg(test)]
mod tests;
mod to_model;
mod way;

use std::collections::BTreeMap;
use std::ops::Range;

use enfilade_importers::{ElementId, MaterialId, Model, Semantic};
use glam::DVec3;

use crate::gmap::Dart;
use crate::lattice::{Lattice, Plane, Point, orient};
use crate::partition::cells::{Label, NONE, Partition, Source};
use crate::partition::check_triangles;
use crate::sew::{Sewn, Topology, TopologyError, sew};

use looks::Looks;
pub(crate) use portals::{Place, Portal, Portals};

pub use crate::format::FaceKind;
pub use cells::CellsError;
pub(crate) use cells::NamedCells;
pub use way::{Way, WayOptions};

/// A building.
#[derive(Clone, Debug, PartialEq)]
pub struct Building {
    /// The grid of all coordinates.
    pub lattice: Lattice,
    /// The box that the volumes fill, lattice units.
    pub hull: [[i32; 3]; 2],
    /// Planes of floors and ceilings.
    pub planes: Vec<Plane>,
    /// The map, and where its vertices are.
    pub topology: Topology,
    /// What is known of each volume of the map.
    pub volumes: Vec<Volume>,
    /// Corners of volumes' footprints.
    pub footprints: Vec<Point>,
    /// What is known of each face, in the order of [`Topology::faces`].
    pub faces: Vec<Face>,
    /// The source's own triangles behind faces.
    pub sources: Vec<Source>,
    /// Triangles that no face stands for: element and index in its mesh, ascending.
    pub detail: Vec<(ElementId, u32)>,
    /// The model's elements, by [`ElementId`].
    pub elements: Vec<Element>,
    /// By label: its volumes, and what bounds it.
    labels: BTreeMap<Label, Extent>,
}

/// A volume of the map: a convex prism.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Volume {
    /// What fills it.
    pub label: Label,
    /// Index of the plane of its floor.
    pub floor: u32,
    /// Index of the plane of its ceiling.
    pub ceiling: u32,
    /// The corners of its footprint, in [`Building::footprints`]: counter-clockwise, exactly convex, none on a straight line.
    pub footprint: Range<u32>,
    /// One of its darts.
    pub dart: Dart,
}

/// A face of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// What it separates.
    pub kind: FaceKind,
    /// The element whose surface it is, if it is one.
    pub element: Option<ElementId>,
    /// The material of that surface, if it is known.
    pub material: Option<MaterialId>,
    /// Square metres.
    pub area: f64,
}

/// What a building knows of an element of its model.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// Its identity.
    pub id: String,
    /// Its name; may be empty.
    pub name: String,
    /// Its path in the source.
    pub path: String,
    /// Its meaning.
    pub semantic: Semantic,
    /// The storey's name.
    pub storey: Option<String>,
    /// What it pierces or sits in.
    pub host: Option<ElementId>,
    /// What fills it.
    pub filling: Option<ElementId>,
}

/// What bears one label.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Extent {
    /// Its volumes, ascending.
    volumes: Vec<u32>,
    /// The faces between it and what bears another label, or the outside of the hull, ascending.
    faces: Vec<u32>,
}

/// A normal of a polygon, of twice its area.
fn normal(corners: &[DVec3]) -> DVec3 {
    let Some(&first) = corners.first() else { return DVec3::ZERO };
    corners.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum()
}

/// What is known of a model's elements.
fn elements(model: &Model) -> Vec<Element> {
    let by_id: BTreeMap<&str, u32> =
        model.elements.iter().zip(0..).map(|(element, i)| (element.id.as_str(), i)).collect();
    let find = |id: &Option<String>| id.as_deref().and_then(|id| by_id.get(id)).map(|&i| ElementId(i));
    let element = |element: &enfilade_importers::Element| Element {
        id: element.id.clone(),
        name: element.name.clone(),
        path: element.path.clone(),
        semantic: element.semantic,
        storey: element.storey.clone().filter(|storey| !storey.is_empty()),
        host: find(&element.host),
        filling: find(&element.filling),
    };
    model.elements.iter().map(element).collect()
}

impl Building {
    /// The building that a model is, its space being cut by `partition`.
    ///
    /// # Errors
    /// [`TopologyError`]: `partition` is not one of `model` ([`Partition::check`]), or its cells' surfaces are not closed.
    pub fn new(model: &Model, partition: &Partition) -> Result<Building, TopologyError> {
        partition.check(model).map_err(TopologyError::Partition)?;
        let topology = sew(partition)?;
        let mut darts = vec![None; partition.cells.len()];
        for (face, beyond) in topology.faces.iter().map(|face| (face, topology.map.alpha(3, face.dart))) {
            darts[face.one as usize].get_or_insert(face.dart);
            if face.other != NONE {
                darts[face.other as usize].get_or_insert(beyond);
            }
        }
        let (mut volumes, mut footprints) = (Vec::with_capacity(darts.len()), Vec::new());
        // Each has one: a cell without a face is not sewn.
        for (cell, dart) in partition.cells.iter().zip(darts).filter_map(|(cell, dart)| Some((cell, dart?))) {
            let first = footprints.len() as u32;
            let corners: Vec<Point> = partition.footprint(cell).collect();
            let count = corners.len();
            let turns = |i: &usize| {
                orient(corners[(i + count - 1) % count], corners[*i], corners[(i + 1) % count]) != 0
            };
            footprints.extend((0..count).filter(turns).map(|i| corners[i]));
            let footprint = first..footprints.len() as u32;
            let (label, floor, ceiling) = (cell.label, cell.floor, cell.ceiling);
            volumes.push(Volume { label, floor, ceiling, footprint, dart });
        }
        let mut building = Building {
            lattice: partition.lattice,
            hull: partition.hull,
            planes: partition.planes.clone(),
            volumes,
            footprints,
            faces: Vec::with_capacity(topology.faces.len()),
            topology,
            sources: partition.sources.clone(),
            detail: partition.detail.clone(),
            elements: elements(model),
            labels: BTreeMap::new(),
        };
        building.faces = building.named(model);
        building.labels = building.gathered();
        Ok(building)
    }

    /// Checks that it is a building of this model: that its elements are the model's, and its faces what the model's surfaces
    /// make them.
    ///
    /// # Errors
    /// What is not, in words.
    pub(crate) fn check_model(&self, model: &Model) -> Result<(), String> {
        check_triangles(model, &self.sources, &self.detail)?;
        if self.elements != elements(model) {
            return Err("its elements are not the model's".to_owned());
        }
        match self.named(model).iter().zip(&self.faces).position(|(own, known)| own != known) {
            Some(face) => Err(format!("face {face} is not called what the model makes it")),
            None => Ok(()),
        }
    }

    /// What the faces are, all their triangles being the model's.
    fn named(&self, model: &Model) -> Vec<Face> {
        let looks: Vec<Looks> = self.sources.iter().map(|source| Looks::of(model, source)).collect();
        self.topology.faces.iter().map(|face| self.name(model, &looks, face)).collect()
    }

    /// The label of a volume; `None` outside the hull.
    pub fn label(&self, volume: u32) -> Option<Label> {
        self.volumes.get(volume as usize).map(|volume| volume.label)
    }

    /// The meaning of what bears a label.
    pub fn semantic(&self, label: Label) -> Semantic {
        match label {
            Label::Air(element) | Label::Solid(element) => {
                self.elements.get(element.0 as usize).map_or(Semantic::Unknown, |element| element.semantic)
            }
            Label::Exterior => Semantic::Exterior,
            Label::Void => Semantic::Void,
        }
    }

    /// The corners of a face in turn, metres in the model's internal frame; seen from its first volume in no certain sense.
    pub fn corners(&self, face: u32) -> impl Iterator<Item = [f64; 3]> + '_ {
        let dart = self.topology.faces[face as usize].dart;
        let vertex = |dart: Dart| self.topology.vertex_of[dart.index()];
        let around = self.topology.map.around_face(dart);
        around.map(move |dart| self.lattice.metres(self.topology.points[vertex(dart) as usize]))
    }

    /// The middle of a face, by area; metres, internal frame.
    pub(crate) fn middle(&self, face: u32) -> DVec3 {
        let corners: Vec<DVec3> = self.corners(face).map(DVec3::from).collect();
        let normal = normal(&corners);
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for pair in corners.windows(2) {
            let own = (pair[0] - corners[0]).cross(pair[1] - corners[0]).dot(normal);
            sum += (corners[0] + pair[0] + pair[1]) / 3.0 * own;
            weight += own;
        }
        // Of a face without area any of its points.
        if weight > 0.0 { sum / weight } else { corners.first().copied().unwrap_or_default() }
    }

    /// Names a face.
    fn name(&self, model: &Model, looks: &[Looks], sewn: &Sewn) -> Face {
        let area = self.topology.area(sewn.dart) * self.lattice.step() * self.lattice.step();
        let Some((_, matter, is_first)) = self.surface(sewn) else {
            return Face { kind: self.kind(sewn, None, false), element: None, material: None, area };
        };
        let body = if let Label::Solid(element) = matter { Some(element) } else { None };
        let source = sewn.sources[if is_first { 0 } else { 1 }];
        let look = looks.get(source as usize).and_then(|looks| looks.before(body));
        let element = look.map(|look| look.element).or(body);
        let material = look.map(|look| look.material);
        let is_glass = material
            .and_then(|material| model.materials.get(material.0 as usize))
            .is_some_and(|material| material.is_see_through());
        Face { kind: self.kind(sewn, element, is_glass), element, material, area }
    }

    /// Of a face between air and matter: what fills the one and the other, and whether its first side is in the air.
    pub(crate) fn surface(&self, sewn: &Sewn) -> Option<(Label, Label, bool)> {
        let [one, other] = [self.label(sewn.one)?, self.label(sewn.other)?];
        match (one.is_air(), other.is_air()) {
            (true, false) => Some((one, other, true)),
            (false, true) => Some((other, one, false)),
            _ => None,
        }
    }

    /// What a face is called; `element` and `is_glass` tell of the surface there, if it is one.
    pub(crate) fn kind(&self, sewn: &Sewn, element: Option<ElementId>, is_glass: bool) -> FaceKind {
        if let Some((air, _, is_first)) = self.surface(sewn) {
            let matter = element.map_or(Semantic::Unknown, |element| self.semantic(Label::Solid(element)));
            return FaceKind::of_surface(self.semantic(air), matter, sewn.way.part(is_first), is_glass);
        }
        match [sewn.one, sewn.other].map(|volume| self.label(volume)) {
            [Some(one), Some(_)] if one.is_air() => FaceKind::Portal,
            [Some(_), Some(_)] => FaceKind::Joint,
            _ => FaceKind::Horizon,
        }
    }

    /// Whether what is kept by label is that of the volumes and faces.
    pub(crate) fn is_gathered(&self) -> bool {
        self.labels == self.gathered()
    }

    /// What bears each label.
    fn gathered(&self) -> BTreeMap<Label, Extent> {
        let mut labels: BTreeMap<Label, Extent> = BTreeMap::new();
        for (volume, number) in self.volumes.iter().zip(0..) {
            labels.entry(volume.label).or_default().volumes.push(number);
        }
        for (face, number) in self.topology.faces.iter().zip(0..) {
            let [one, other] = [face.one, face.other].map(|volume| self.label(volume));
            if one != other {
                for label in [one, other].into_iter().flatten() {
                    labels.entry(label).or_default().faces.push(number);
                }
            }
        }
        labels
    }
}
