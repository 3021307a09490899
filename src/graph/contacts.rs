//! What touches what: the portals between cells of air, and the faces between air and matter, added up.

use std::collections::{BTreeMap, BTreeSet};

use super::surface::parts;
use super::{Fill, Passage, Place, air};
use crate::format::FaceKind;
use crate::format::records::CellRecord;
use crate::scene::Scene;
use crate::trace::{NONE, Prisms};

/// What fills each cell; voids that do not touch have numbers of their own, in the order of their first cells.
pub(crate) fn fills(prisms: &Prisms<'_>) -> Vec<Fill> {
    let fill = |cell: &CellRecord| match cell.kind {
        CellRecord::AIR => air(cell),
        CellRecord::SOLID => Fill::Solid,
        _ => Fill::Around,
    };
    let mut fills: Vec<Fill> = prisms.cells.iter().map(fill).collect();
    let is_void: Vec<bool> = fills.iter().map(|fill| matches!(fill, Fill::Place(Place::Void(_)))).collect();
    let mut is_known = vec![false; fills.len()];
    let mut count = 0;
    for first in 0..fills.len() {
        if !is_void[first] || is_known[first] {
            continue;
        }
        let mut waiting = vec![first];
        while let Some(cell) = waiting.pop() {
            if std::mem::replace(&mut is_known[cell], true) {
                continue;
            }
            fills[cell] = Fill::Place(Place::Void(count));
            let beyond = prisms.beyond(&prisms.cells[cell]).map(|(cell, ..)| cell as usize);
            waiting.extend(beyond.filter(|&cell| is_void[cell] && !is_known[cell]));
        }
        count += 1;
    }
    fills
}

/// Areas shared.
#[derive(Debug, Default)]
pub(super) struct Contacts {
    /// Of two fills of air, both ways.
    air: BTreeMap<Fill, BTreeMap<Fill, f64>>,
    /// Of places and matter.
    pub(super) faces: BTreeMap<(Place, FaceKind, Option<u32>), f64>,
}

impl Contacts {
    pub(super) fn of(scene: &Scene, prisms: &Prisms<'_>, fills: &[Fill]) -> Contacts {
        let mut contacts = Contacts::default();
        for (cell, fill) in prisms.cells.iter().zip(fills) {
            if !matches!(fill, Fill::Place(_) | Fill::Opening(_)) {
                continue;
            }
            let mut add = |beyond: u32, source: u32, kind: u32, area: f64| {
                let other = fills[beyond as usize];
                match (fill, other) {
                    _ if area <= 0.0 || *fill == other => {}
                    (_, Fill::Place(_) | Fill::Opening(_)) => {
                        *contacts.air.entry(*fill).or_default().entry(other).or_default() += area;
                    }
                    (Fill::Place(place), _) => {
                        let element = shown(scene, prisms, beyond, source);
                        let kind = FaceKind::from_number(kind).unwrap_or(FaceKind::Lining);
                        *contacts.faces.entry((*place, kind, element)).or_default() += area;
                    }
                    _ => {}
                }
            };
            for part in parts(prisms, cell) {
                add(part.beyond, part.source, part.kind, part.area());
            }
        }
        contacts
    }

    /// Where air meets air, openings being what joins and not what is joined; not through those that are `closed`.
    pub(super) fn passages(&self, closed: &BTreeSet<u32>) -> Vec<Passage> {
        let mut passages = Vec::new();
        for (fill, around) in &self.air {
            match *fill {
                Fill::Place(one) => {
                    for (other, &area) in around {
                        if let Fill::Place(other) = *other
                            && one < other
                        {
                            passages.push(Passage { places: [one, other], opening: None, area });
                        }
                    }
                }
                Fill::Opening(element) if closed.contains(&element) => {}
                Fill::Opening(element) => {
                    let direct = self.places(*fill);
                    let led_to = self.led_to(*fill, closed);
                    for (one, own) in &direct {
                        for (&other, &area) in &led_to {
                            // Each pair once: two that both touch the opening come in both orders.
                            if *one == other || (direct.contains_key(&other) && other < *one) {
                                continue;
                            }
                            let places = if *one < other { [*one, other] } else { [other, *one] };
                            passages.push(Passage { places, opening: Some(element), area: own.min(area) });
                        }
                    }
                }
                Fill::Solid | Fill::Around => {}
            }
        }
        passages.sort_by_key(|passage| (passage.places, passage.opening));
        passages
    }

    /// The places that something touches.
    fn places(&self, fill: Fill) -> BTreeMap<Place, f64> {
        let around = self.air.get(&fill).into_iter().flatten();
        around
            .filter_map(
                |(other, &area)| if let Fill::Place(place) = *other { Some((place, area)) } else { None },
            )
            .collect()
    }

    /// The places that an opening leads to, through others that it touches, too: with the least area on the widest way.
    fn led_to(&self, opening: Fill, closed: &BTreeSet<u32>) -> BTreeMap<Place, f64> {
        let mut places = self.places(opening);
        let mut widest = BTreeMap::from([(opening, f64::INFINITY)]);
        let mut waiting = vec![opening];
        while let Some(here) = waiting.pop() {
            let least = widest[&here];
            for (&next, &area) in self.air.get(&here).into_iter().flatten() {
                let least = least.min(area);
                let is_open = matches!(next, Fill::Opening(element) if !closed.contains(&element));
                if is_open && widest.get(&next).is_none_or(|known| least > *known) {
                    widest.insert(next, least);
                    waiting.push(next);
                }
            }
        }
        for (&next, &least) in widest.iter().filter(|(next, _)| **next != opening) {
            for (place, area) in self.places(next) {
                let most = places.entry(place).or_default();
                *most = most.max(area.min(least));
            }
        }
        places
    }
}

/// The element whose surface is seen at a face before cell `beyond`: of the source's triangles the one with most area, the matter's own
/// first.
fn shown(scene: &Scene, prisms: &Prisms<'_>, beyond: u32, source: u32) -> Option<u32> {
    let body = prisms.cells[beyond as usize].element;
    let mut areas: BTreeMap<u32, f64> = BTreeMap::new();
    for &triangle in prisms.triangles_of(source) {
        let element = scene.tables.record(triangle).element;
        if element == body {
            return Some(element);
        }
        let [a, b, c] = scene.triangle(triangle).map(glam::DVec3::from);
        *areas.entry(element).or_default() += (b - a).cross(c - a).length();
    }
    let most = areas.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    most.map(|most| most.0).or((body != NONE).then_some(body))
}
