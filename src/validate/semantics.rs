//! Whether rooms, doors and windows are where such things can be.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use enfilade_importers::{ElementId, Semantic};
use glam::DVec3;

use super::{Code, Finding};
use crate::building::{Building, FaceKind, Place, Portal, Portals};
use crate::partition::cells::Label;

/// Portals smaller than this are none, m2: what rounding leaves open.
const LEAST: f64 = 1e-4;

/// Of a longer chain only so much is told.
const LONGEST: usize = 100;

pub(super) fn check(building: &Building) -> Vec<Finding> {
    let portals = Portals::of(building);
    let mut findings = Vec::new();
    for opening in building.openings() {
        let label = Label::Air(opening);
        let beside: Vec<(Place, Portal)> = around(&portals, (label, 0)).collect();
        if beside.len() < 2 {
            let joined = match beside[..] {
                [(one, _)] => format!("only {}", building.called(one.0)),
                _ => "nothing".to_owned(),
            };
            let area = beside.iter().map(|(_, portal)| portal.area).sum();
            let text = format!("it joins {joined}");
            findings.push(building.finding(Code::S01, Some(opening), building.middle_of(label), area, text));
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
            findings.push(building.finding(Code::S03, Some(room), building.middle_of(label), area, text));
        }
        if !leads_out(&portals, label) {
            let text = "nothing joins it to another room, an opening or the open".to_owned();
            let area = areas.values().sum();
            findings.push(building.finding(Code::S04, Some(room), building.middle_of(label), area, text));
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
    let mut waiting: VecDeque<Place> = portals.places().filter(|place| is_open(*place)).collect();
    while let Some(here) = waiting.pop_front() {
        for (beyond, _) in around(portals, here) {
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
        let links = chain.windows(2).filter_map(|pair| {
            portals.around(pair[0]).find(|(beyond, _)| *beyond == pair[1]).map(|(_, portal)| portal)
        });
        let Some(least) = links.min_by(|a, b| a.area.total_cmp(&b.area)) else { continue };
        let mut names: Vec<String> =
            chain.iter().take(LONGEST).map(|place| building.called(place.0)).collect();
        if chain.len() > LONGEST {
            names.push(format!("{} more", chain.len() - LONGEST));
        }
        let text = format!("its air is joined to the open: {}", names.join(" - "));
        let mut finding = building.finding(Code::S02, Some(room), least.middle.to_array(), least.area, text);
        finding.chain = names;
        findings.push(finding);
    }
    findings
}

/// What is beside a place, but for what rounding leaves open.
fn around(portals: &Portals, place: Place) -> impl Iterator<Item = (Place, Portal)> + '_ {
    portals.around(place).filter(|(_, portal)| portal.area >= LEAST)
}

/// Whether labelled air is joined to any other, be it through voids.
fn leads_out(portals: &Portals, label: Label) -> bool {
    let (mut seen, mut waiting) = (BTreeSet::new(), vec![(label, 0)]);
    while let Some(here) = waiting.pop() {
        for (beyond, _) in around(portals, here).filter(|(beyond, _)| beyond.0 != label) {
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

    /// In the middle of the surface of what bears a label; metres, internal frame.
    fn middle_of(&self, label: Label) -> [f64; 3] {
        let faces =
            self.faces_of(label).iter().map(|&face| (self.middle(face), self.faces[face as usize].area));
        let (sum, area) =
            faces.fold((DVec3::ZERO, 0.0), |sum, (middle, own)| (sum.0 + middle * own, sum.1 + own));
        if area > 0.0 { (sum / area).to_array() } else { [0.0; 3] }
    }
}
