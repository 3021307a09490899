//! The graph as DOT, for Graphviz.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{EXTERIOR, VOID, place_id, side_id};
use crate::graph::{Graph, Place, Side};
use crate::scene::Scene;
use enfilade_importers::Semantic;

/// The graph of a scene for Graphviz: rooms by storey, with names and floor areas; an edge for each opening, dotted if it is closed, and a dashed one where rooms
/// meet without.
pub fn graph_dot(scene: &Scene, graph: &Graph) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_dot(&mut out, scene, graph);
    out
}

fn write_dot(out: &mut String, scene: &Scene, graph: &Graph) -> std::fmt::Result {
    writeln!(out, "graph building {{")?;
    writeln!(out, "  node [shape=box, style=rounded];")?;
    let mut storeys: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (room, number) in graph.rooms.iter().zip(0..) {
        storeys.entry(scene.element(room.element).storey()).or_default().push(number);
    }
    for ((storey, rooms), number) in storeys.iter().zip(0..) {
        writeln!(out, "  subgraph cluster_{number} {{")?;
        writeln!(out, "    label={};", quoted(storey))?;
        for &room in rooms {
            let element = scene.element(graph.rooms[room].element);
            let name = if element.name().is_empty() { element.id() } else { element.name() };
            let label = format!("{name}\n{:.1} m2", graph.rooms[room].floor_area);
            writeln!(out, "    {} [label={}];", quoted(element.id()), quoted(&label))?;
        }
        writeln!(out, "  }}")?;
    }
    let sides = graph.openings.iter().flat_map(|opening| opening.sides);
    for (side, name) in [(Side::Exterior, EXTERIOR), (Side::Void, VOID)] {
        if sides.clone().any(|own| own == side) {
            writeln!(out, "  {} [shape=ellipse, style=dashed];", quoted(name))?;
        }
    }
    for opening in &graph.openings {
        let element = scene.element(opening.element);
        let [from, to] = opening.sides.map(|side| quoted(side_id(scene, side)));
        let color = match element.semantic() {
            Semantic::Door => "brown",
            Semantic::Window => "steelblue",
            _ => "gray40",
        };
        let name = if element.name().is_empty() { element.id() } else { element.name() };
        let style = if opening.closed { ", style=dotted" } else { "" };
        writeln!(out, "  {from} -- {to} [color={color}{style}, tooltip={}];", quoted(name))?;
    }
    for portal in graph.portals.iter().filter(|portal| portal.opening.is_none()) {
        if let [Place::Room(_), Place::Room(_)] = portal.places {
            let [from, to] = portal.places.map(|place| quoted(place_id(scene, place)));
            writeln!(out, "  {from} -- {to} [style=dashed, tooltip=\"{:.2} m2\"];", portal.area)?;
        }
    }
    writeln!(out, "}}")
}

/// As DOT writes texts.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            '\n' => quoted.push_str("\\n"),
            '\r' => {}
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
