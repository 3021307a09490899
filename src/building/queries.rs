//! What users ask of a building.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, Semantic};

use super::{Building, FaceKind};
use crate::partition::cells::{Label, NONE};

impl Building {
    /// All labels, in their order: matter, air, the open, voids.
    pub fn labels(&self) -> impl Iterator<Item = Label> + '_ {
        self.labels.keys().copied()
    }

    /// The rooms and stairwells, in the order of their elements.
    pub fn rooms(&self) -> impl Iterator<Item = ElementId> + '_ {
        self.air(|semantic| matches!(semantic, Semantic::Room | Semantic::Stairwell))
    }

    /// The doors, windows and openings that are air, in the order of their elements.
    pub fn openings(&self) -> impl Iterator<Item = ElementId> + '_ {
        self.air(|semantic| matches!(semantic, Semantic::Door | Semantic::Window | Semantic::Opening))
    }

    fn air<'a>(&'a self, is_meant: impl Fn(Semantic) -> bool + 'a) -> impl Iterator<Item = ElementId> + 'a {
        self.labels.keys().filter_map(move |label| match label {
            Label::Air(element) if is_meant(self.semantic(*label)) => Some(*element),
            _ => None,
        })
    }

    /// The rooms of a storey, in the order of their elements.
    pub fn rooms_of_storey<'a>(&'a self, storey: &'a str) -> impl Iterator<Item = ElementId> + 'a {
        self.rooms().filter(move |room| self.elements[room.0 as usize].storey.as_deref() == Some(storey))
    }

    /// The volumes that bear a label, ascending.
    pub fn volumes_of(&self, label: Label) -> &[u32] {
        self.labels.get(&label).map_or(&[], |extent| &extent.volumes)
    }

    /// The faces between what bears a label and what bears another, ascending.
    pub fn faces_of(&self, label: Label) -> &[u32] {
        self.labels.get(&label).map_or(&[], |extent| &extent.faces)
    }

    /// What is beyond a face, seen from what bears `label`; `None` for the outside of the hull, and if the face is none of
    /// [`Building::faces_of`] the label.
    pub fn beyond(&self, face: u32, label: Label) -> Option<Label> {
        let sewn = self.topology.faces.get(face as usize)?;
        let [one, other] = [sewn.one, sewn.other].map(|volume| self.label(volume));
        if one == Some(label) {
            other.filter(|_| sewn.other != NONE)
        } else {
            one.filter(|_| other == Some(label))
        }
    }

    /// The surface of what bears a label by kind of face, square metres. Portals within it do not count.
    pub fn areas(&self, label: Label) -> BTreeMap<FaceKind, f64> {
        let mut areas = BTreeMap::new();
        for face in self.faces_of(label).iter().map(|&face| &self.faces[face as usize]) {
            *areas.entry(face.kind).or_default() += face.area;
        }
        areas
    }

    /// What air light reaches from what bears a label, with the area of the portals between them, square metres.
    pub fn neighbours(&self, label: Label) -> BTreeMap<Label, f64> {
        let mut areas = BTreeMap::new();
        for &face in self.faces_of(label) {
            if self.faces[face as usize].kind == FaceKind::Portal
                && let Some(beyond) = self.beyond(face, label)
            {
                *areas.entry(beyond).or_default() += self.faces[face as usize].area;
            }
        }
        areas
    }

    /// The doors, windows and openings that join two rooms, or a room and the open, in the order of their elements.
    pub fn openings_between(&self, one: Label, other: Label) -> Vec<ElementId> {
        let beside = self.neighbours(one);
        let joins = |opening: &ElementId| {
            let label = Label::Air(*opening);
            beside.contains_key(&label) && self.neighbours(label).contains_key(&other)
        };
        self.openings().filter(joins).collect()
    }
}
