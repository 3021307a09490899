//! The graph as JSON (docs/GRAPH.md).

use std::collections::BTreeMap;

use serde::Serialize;

use super::{place_id, side_id};
use crate::graph::{Graph, OpeningNode, Passage, Place, RoomNode, VoidNode};
use crate::scene::Scene;

#[derive(Serialize)]
struct Room<'a> {
    id: &'a str,
    name: &'a str,
    class: &'a str,
    semantic: &'a str,
    storey: Option<&'a str>,
    derived: bool,
    volume_m3: f64,
    floor_area_m2: f64,
    cells: &'a [u32],
}

#[derive(Serialize)]
struct Opening<'a> {
    id: &'a str,
    name: &'a str,
    host: Option<&'a str>,
    filling: Option<&'a str>,
    semantic: &'a str,
    storey: Option<&'a str>,
    derived: bool,
    closed: bool,
    sides: [&'a str; 2],
    cells: &'a [u32],
}

#[derive(Serialize)]
struct Portal<'a> {
    rooms: [&'a str; 2],
    area_m2: f64,
    opening: Option<&'a str>,
}

#[derive(Serialize)]
struct Face<'a> {
    room: &'a str,
    semantic: &'a str,
    element: Option<&'a str>,
    area_m2: f64,
}

#[derive(Serialize)]
struct Void<'a> {
    volume_m3: f64,
    bounds: [[f64; 3]; 2],
    cells: &'a [u32],
}

/// To millionths: digits beyond that say nothing, and differ where none should.
fn rounded(number: f64) -> f64 {
    let rounded = (number * 1e6).round() / 1e6;
    if rounded == 0.0 { 0.0 } else { rounded }
}

impl<'a> Room<'a> {
    fn new(scene: &'a Scene, node: &'a RoomNode) -> Room<'a> {
        let own = scene.element(node.element);
        Room {
            id: own.id(),
            name: own.name(),
            class: own.class(),
            semantic: own.semantic().name(),
            storey: known(own.storey()),
            derived: own.is_derived(),
            volume_m3: rounded(node.volume),
            floor_area_m2: rounded(node.floor_area),
            cells: &node.cells,
        }
    }
}

impl<'a> Opening<'a> {
    fn new(scene: &'a Scene, node: &'a OpeningNode) -> Opening<'a> {
        let own = scene.element(node.element);
        Opening {
            id: own.id(),
            name: own.name(),
            host: own.host().map(|host| scene.element(host).id()),
            filling: own.filling().map(|filling| scene.element(filling).id()),
            semantic: own.semantic().name(),
            storey: known(own.storey()),
            derived: own.is_derived(),
            closed: node.closed,
            sides: node.sides.map(|side| side_id(scene, side)),
            cells: &node.cells,
        }
    }
}

fn known(text: &str) -> Option<&str> {
    Some(text).filter(|text| !text.is_empty())
}

/// The graph of a scene as JSON, a line each room, opening, portal, face and void. Bounds of voids are in the source's own frame and unit.
pub fn graph_json(scene: &Scene, graph: &Graph) -> String {
    let frame = scene.frame();
    // Voids have one name: what leads to several is one portal.
    let mut portals: BTreeMap<([Place; 2], Option<u32>), f64> = BTreeMap::new();
    for &Passage { places, opening, area } in &graph.portals {
        let named = places.map(|place| if let Place::Void(_) = place { Place::Void(0) } else { place });
        *portals.entry((named, opening)).or_default() += area;
    }
    let portal = |((places, opening), area): (([Place; 2], Option<u32>), f64)| Portal {
        rooms: places.map(|place| place_id(scene, place)),
        area_m2: rounded(area),
        opening: opening.map(|opening| scene.element(opening).id()),
    };
    let mut faces: BTreeMap<(&str, &str, Option<&str>), f64> = BTreeMap::new();
    for (&(place, kind, element), area) in &graph.faces {
        let element = element.map(|element| scene.element(element).id());
        *faces.entry((place_id(scene, place), kind.name(), element)).or_default() += area;
    }
    let face = |((room, semantic, element), area)| Face { room, semantic, element, area_m2: rounded(area) };
    let voids = graph.voids.iter().map(|VoidNode { cells, volume, bounds }| Void {
        volume_m3: rounded(*volume),
        bounds: frame.box_to_source(*bounds),
        cells,
    });
    let lists = [
        ("rooms", lines(graph.rooms.iter().map(|node| Room::new(scene, node)))),
        ("openings", lines(graph.openings.iter().map(|node| Opening::new(scene, node)))),
        ("portals", lines(portals.into_iter().map(portal))),
        ("faces", lines(faces.into_iter().map(face))),
        ("voids", lines(voids)),
    ];
    let lists: Vec<String> =
        lists.into_iter().map(|(name, lines)| format!("  \"{name}\": [{lines}]")).collect();
    format!("{{\n{}\n}}\n", lists.join(",\n"))
}

/// Each item on a line of its own.
fn lines(items: impl Iterator<Item = impl Serialize>) -> String {
    // No map in them has keys that are no texts, which is all that could fail.
    let lines: Vec<String> = items.map(|item| serde_json::to_string(&item).unwrap_or_default()).collect();
    if lines.is_empty() { String::new() } else { format!("\n    {}\n  ", lines.join(",\n    ")) }
}
