//! Whether rooms, doors and windows are where such things can be.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

use enfilade_importers::{ElementId, Semantic};
use glam::DVec3;

use super::{Code, Finding};
use crate::building::{Building, FaceKind};
use crate::partition::cells::Label;

/// Portals smaller than this are none, m2: what rounding leaves open.
const LEAST: f64 = 1e-4;

pub(super) fn check(building: &Building) -> Vec<Finding> {
    let portals = Portals::of(building);
    let mut findings = Vec::new();
    for opening in building.openings() {
        let label = Label::Air(opening);
        let beside: Vec<(Label, f64)> = portals.beside(label).collect();
        if beside.len() < 2 {
            let joined = match beside[..] {
                [(one, _)] => format!("only {}", building.called(one)),
                _ => "nothing".to_owned(),
            };
            let area = beside.iter().map(|(_, area)| area).sum();
            let text = format!("it joins {joined}");
            findings.push(building.finding(Code::S01, Some(opening), building.middle(label), area, text));
        }
    }
    findings.extend(leaks(building, &portals));
    for room in building.rooms() {
        let label = Label::Air(room);
        let areas = building.areas(label);
        let is_stair = building.semantic(label) == Semantic::Stairwell;
        let lacks = |kind: FaceKind| !is_stair && areas.get(&kind).is_none_or(|area| *area < LEAST);
        let missing: Vec<&str> = [(FaceKind::Floor, "floor"), (FaceKind::Ceiling, "ceiling")]
            .into_iter()
            .filter(|(kind, _)| lacks(*kind))
            .map(|(_, name)| name)
            .collect();
        if !missing.is_empty() {
            let text = format!("it has no {}", missing.join(" and no "));
            let area = areas.get(&FaceKind::Portal).copied().unwrap_or(0.0);
            findings.push(building.finding(Code::S03, Some(room), building.middle(label), area, text));
        }
        if !portals.leads_out(label) {
            let text = "nothing joins it to another room, an opening or the open".to_owned();
            let area = areas.values().sum();
            findings.push(building.finding(Code::S04, Some(room), building.middle(label), area, text));
        }
    }
    findings
}

/// Rooms from which one comes into the open other than by an opening: for each the shortest chain of portals, and the smallest of these.
fn leaks(building: &Building, portals: &Portals) -> Vec<Finding> {
    let is_closed = |place: Place| {
        matches!(building.semantic(place.0), Semantic::Door | Semantic::Window | Semantic::Opening)
    };
    let is_open = |place: Place| building.semantic(place.0) == Semantic::Exterior;
    let mut towards: BTreeMap<Place, Place> = BTreeMap::new();
    let mut waiting: VecDeque<Place> = portals.sums.keys().copied().filter(|place| is_open(*place)).collect();
    while let Some(here) = waiting.pop_front() {
        for (beyond, _) in portals.around(here) {
            if !is_closed(beyond) && !is_open(beyond) && !towards.contains_key(&beyond) {
                towards.insert(beyond, here);
                waiting.push_back(beyond);
            }
        }
    }
    let mut findings = Vec::new();
    for room in building.rooms().filter(|room| towards.contains_key(&(Label::Air(*room), 0))) {
        let mut chain = vec![(Label::Air(room), 0)];
        while let Some(next) = chain.last().and_then(|last| towards.get(last)) {
            chain.push(*next);
        }
        let links = chain.windows(2).filter_map(|pair| portals.between(pair[0], pair[1]));
        let Some(least) = links.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let names: Vec<String> = chain.iter().map(|place| building.called(place.0)).collect();
        let text = format!("its air is joined to the open: {}", names.join(" - "));
        let mut finding = building.finding(Code::S02, Some(room), least.1.to_array(), least.0, text);
        finding.chain = names;
        findings.push(finding);
    }
    findings
}

/// What bears a label; of voids, which have nothing to do with each other, one that hangs together.
type Place = (Label, u32);

/// All portals between two places: their area, and the middle of it.
struct Portals {
    sums: BTreeMap<Place, BTreeMap<Place, (f64, DVec3)>>,
}

impl Portals {
    fn of(building: &Building) -> Portals {
        let voids = voids(building);
        let place = |volume: u32| {
            let label = building.label(volume)?;
            Some((label, voids.get(&volume).copied().unwrap_or(0)))
        };
        let mut sums: BTreeMap<Place, BTreeMap<Place, (f64, DVec3)>> = BTreeMap::new();
        for (face, number) in building.faces.iter().zip(0..).filter(|(face, _)| face.kind == FaceKind::Portal)
        {
            let sewn = &building.topology.faces[number as usize];
            let [Some(one), Some(other)] = [sewn.one, sewn.other].map(place) else { continue };
            if one == other {
                continue;
            }
            let corners: Vec<DVec3> = building.corners(number).map(DVec3::from).collect();
            let middle = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
            for (from, to) in [(one, other), (other, one)] {
                let sum = sums.entry(from).or_default().entry(to).or_insert((0.0, DVec3::ZERO));
                sum.0 += face.area;
                sum.1 += middle * face.area;
            }
        }
        for portal in sums.values_mut().flat_map(BTreeMap::values_mut).filter(|portal| portal.0 > 0.0) {
            portal.1 /= portal.0;
        }
        Portals { sums }
    }

    /// What is beside a place.
    fn around(&self, place: Place) -> impl Iterator<Item = (Place, f64)> + '_ {
        let all = self.sums.get(&place).into_iter().flatten();
        all.map(|(beyond, portal)| (*beyond, portal.0)).filter(|(_, area)| *area >= LEAST)
    }

    /// What is beside labelled air.
    fn beside(&self, label: Label) -> impl Iterator<Item = (Label, f64)> + '_ {
        self.around((label, 0)).map(|(beyond, area)| (beyond.0, area))
    }

    /// Whether labelled air is joined to any other, be it through voids.
    fn leads_out(&self, label: Label) -> bool {
        let (mut seen, mut waiting) = (BTreeSet::new(), vec![(label, 0)]);
        while let Some(here) = waiting.pop() {
            for (beyond, _) in self.around(here).filter(|(beyond, _)| beyond.0 != label) {
                if beyond.0 != Label::Void {
                    return true;
                }
                if seen.insert(beyond) {
                    waiting.push(beyond);
                }
            }
        }
        false
    }

    fn between(&self, one: Place, other: Place) -> Option<(f64, DVec3)> {
        self.sums.get(&one)?.get(&other).copied()
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
    let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
    for (&first, count) in beside.keys().zip(0..) {
        let mut waiting = vec![first];
        while let Some(volume) = waiting.pop() {
            if let Entry::Vacant(place) = numbers.entry(volume) {
                place.insert(count);
                waiting.extend(&beside[&volume]);
            }
        }
    }
    numbers
}

impl Building {
    /// What to call what bears a label: the name of its element, or its identity.
    fn called(&self, label: Label) -> String {
        let of = |element: ElementId| {
            let element = self.elements.get(element.0 as usize);
            element.map(|e| if e.name.is_empty() { e.id.clone() } else { e.name.clone() }).unwrap_or_default()
        };
        match label {
            Label::Air(element) | Label::Solid(element) => of(element),
            Label::Exterior => "the open".to_owned(),
            Label::Void => "a void".to_owned(),
        }
    }

    /// In the middle of what bears a label, by the area of its surface; metres, internal frame.
    fn middle(&self, label: Label) -> [f64; 3] {
        let (mut sum, mut area) = (DVec3::ZERO, 0.0);
        for &face in self.faces_of(label) {
            let corners: Vec<DVec3> = self.corners(face).map(DVec3::from).collect();
            let own = self.faces[face as usize].area;
            sum += corners.iter().sum::<DVec3>() / corners.len().max(1) as f64 * own;
            area += own;
        }
        if area > 0.0 { (sum / area).to_array() } else { [0.0; 3] }
    }
}
