//! The storeys of a scene: those that its rooms are of.

use std::collections::BTreeMap;

use crate::scene::Scene;

/// A storey.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlanStorey {
    /// Its name; empty if the source has none.
    pub name: String,
    /// Its floor: the height on which most of its rooms' area lies. Metres, internal frame.
    pub floor: f64,
    /// The top of its highest room.
    pub top: f64,
    /// How many rooms it has.
    pub rooms: usize,
    /// Their floor area, m2.
    pub area: f64,
}

/// Rooms without a storey's name belong to one storey if their floors are no farther apart than this, metres.
const APART: f64 = 1.2;

/// The storeys of a scene from the lowest up. A scene without rooms is one storey.
pub fn plan_storeys(scene: &Scene) -> Vec<PlanStorey> {
    let mut named: BTreeMap<&str, Vec<([f64; 2], f64)>> = BTreeMap::new();
    let mut nameless: Vec<([f64; 2], f64)> = Vec::new();
    for room in scene.rooms() {
        let [lo, hi] = room.bounds();
        let area = room.floor_area().unwrap_or_else(|| (hi[0] - lo[0]) * (hi[1] - lo[1]));
        let own = ([lo[2], hi[2]], area);
        match room.element().storey() {
            "" => nameless.push(own),
            name => named.entry(name).or_default().push(own),
        }
    }
    let mut storeys: Vec<PlanStorey> = named.into_iter().map(|(name, rooms)| storey(name, &rooms)).collect();
    nameless.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let together = |a: &([f64; 2], f64), b: &([f64; 2], f64)| b.0[0] - a.0[0] < APART;
    storeys.extend(nameless.chunk_by(together).map(|rooms| storey("", rooms)));
    if storeys.is_empty() {
        let [lo, hi] = scene.hull();
        storeys.push(PlanStorey { name: String::new(), floor: lo[2] + 1.0, top: hi[2], rooms: 0, area: 0.0 });
    }
    storeys.sort_by(|a, b| a.floor.total_cmp(&b.floor).then(a.name.cmp(&b.name)));
    storeys
}

fn storey(name: &str, rooms: &[([f64; 2], f64)]) -> PlanStorey {
    // To the centimetre: floors of one level seldom agree to the millimetre.
    let mut areas: BTreeMap<i64, f64> = BTreeMap::new();
    for ([low, _], area) in rooms {
        *areas.entry((low * 100.0).round() as i64).or_default() += area;
    }
    let most = areas.iter().max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
    let level = most.map_or(0, |most| *most.0);
    let on_level =
        rooms.iter().filter(|([low, _], _)| (low * 100.0).round() as i64 == level).map(|([low, _], _)| *low);
    PlanStorey {
        name: name.to_owned(),
        floor: on_level.fold(f64::INFINITY, f64::min),
        top: rooms.iter().map(|([_, high], _)| *high).fold(f64::NEG_INFINITY, f64::max),
        rooms: rooms.len(),
        area: rooms.iter().map(|room| room.1).sum(),
    }
}
