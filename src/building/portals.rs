//! Where air is joined to other air.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Building, FaceKind};
use crate::partition::cells::Label;

/// What bears a label; of voids, which have nothing to do with each other, one that hangs together: by a number.
pub(crate) type Place = (Label, u32);

/// All portals between two places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Portal {
    /// Square metres.
    pub(crate) area: f64,
    /// The middle of that area; metres, internal frame.
    pub(crate) middle: DVec3,
}

/// The portals of a building: by place, and the place beyond.
pub(crate) struct Portals(BTreeMap<Place, BTreeMap<Place, Portal>>);

impl Portals {
    pub(crate) fn of(building: &Building) -> Portals {
        let voids = voids(building);
        let place = |volume: u32| Some((building.label(volume)?, voids.get(&volume).copied().unwrap_or(0)));
        let mut portals: BTreeMap<Place, BTreeMap<Place, Portal>> = BTreeMap::new();
        for (face, number) in building.faces.iter().zip(0..) {
            let sewn = &building.topology.faces[number as usize];
            let [Some(one), Some(other)] = [sewn.one, sewn.other].map(place) else { continue };
            if face.kind != FaceKind::Portal || one == other {
                continue;
            }
            let middle = building.middle(number);
            for (from, to) in [(one, other), (other, one)] {
                let sum = portals.entry(from).or_default().entry(to).or_default();
                sum.area += face.area;
                sum.middle += middle * face.area;
            }
        }
        for portal in portals.values_mut().flat_map(BTreeMap::values_mut).filter(|portal| portal.area > 0.0) {
            portal.middle /= portal.area;
        }
        Portals(portals)
    }

    /// All places that have portals.
    pub(crate) fn places(&self) -> impl Iterator<Item = Place> + '_ {
        self.0.keys().copied()
    }

    /// What is beside a place.
    pub(crate) fn around(&self, place: Place) -> impl Iterator<Item = (Place, Portal)> + '_ {
        self.0.get(&place).into_iter().flatten().map(|(beyond, portal)| (*beyond, *portal))
    }
}

/// By volume of a void: the number of what it hangs together with.
fn voids(building: &Building) -> BTreeMap<u32, u32> {
    let mut beside: BTreeMap<u32, Vec<u32>> =
        building.volumes_of(Label::Void).iter().map(|volume| (*volume, Vec::new())).collect();
    for face in &building.topology.faces {
        if beside.contains_key(&face.one) && beside.contains_key(&face.other) {
            for (from, to) in [(face.one, face.other), (face.other, face.one)] {
                beside.entry(from).or_default().push(to);
            }
        }
    }
    let mut numbers = BTreeMap::new();
    for (&first, count) in beside.keys().zip(0..) {
        let mut waiting = vec![first];
        while let Some(volume) = waiting.pop() {
            if let std::collections::btree_map::Entry::Vacant(place) = numbers.entry(volume) {
                place.insert(count);
                waiting.extend(&beside[&volume]);
            }
        }
    }
    numbers
}
