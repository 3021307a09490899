//! The building section: elements and rooms.

use std::collections::HashMap;
use std::ops::Range;

use enfilade_importers::{Model, Role, Semantic, TagSource};

use super::geometry::Part;
use crate::format::Tables;
use crate::format::records::{ElementRecord, RoomRecord, Text};
use crate::trace::NONE;

/// Fills the sections `elements` and `rooms`, and the rooms of `volumes`.
pub(super) fn add(model: &Model, parts: &[Part], tables: &mut Tables) {
    let by_id: HashMap<&str, u32> = model.elements.iter().zip(0..).map(|(e, i)| (e.id.as_str(), i)).collect();
    let find = |id: &Option<String>| id.as_deref().and_then(|id| by_id.get(id)).copied().unwrap_or(NONE);
    // Classes and storeys are few and repeat: each is stored once.
    let mut shared: HashMap<String, Text> = HashMap::new();
    let mut intern = |tables: &mut Tables, text: Option<&str>| {
        let text = text.unwrap_or("");
        if let Some(&known) = shared.get(text) {
            return known;
        }
        let new = tables.text(text);
        shared.insert(text.to_owned(), new);
        new
    };
    let mut ranges = vec![(0u32, 0u32); model.elements.len()];
    for (i, run) in tables.runs.iter().enumerate() {
        let end = tables.runs.get(i + 1).map_or(tables.triangles.len() as u32, |next| next.first);
        let (first, count) = &mut ranges[run.element as usize];
        if *count == 0 {
            *first = run.first;
        }
        *count += end - run.first;
    }
    // The volumes of an element stand side by side.
    let mut volumes = vec![0..0; model.elements.len()];
    for (i, volume) in tables.volumes.iter().enumerate() {
        let range = &mut volumes[volume.element as usize];
        *range = if range.start == range.end { i } else { range.start }..i + 1;
    }
    for (i, element) in model.elements.iter().enumerate() {
        let id = tables.text(&element.id);
        let name = if element.name == element.id { id } else { tables.text(&element.name) };
        let path = if element.path == element.id { id } else { tables.text(&element.path) };
        let class = intern(tables, element.class.as_deref());
        let storey = intern(tables, element.storey.as_deref());
        let role = parts[i].pieces.first().map_or(Role::Detail, |piece| piece.role);
        tables.elements.push(ElementRecord {
            id,
            name,
            path,
            class,
            storey,
            semantic: element.semantic.number(),
            role: role as u32,
            first_triangle: ranges[i].0,
            triangle_count: ranges[i].1,
            host: find(&element.host),
            filling: find(&element.filling),
            opening: find(&element.opening),
            flags: if element.tagged_by == TagSource::Derived { ElementRecord::DERIVED } else { 0 },
        });
        if matches!(element.semantic, Semantic::Room | Semantic::Stairwell) {
            add_room(i as u32, &parts[i], volumes[i].clone(), tables);
        }
    }
}

fn add_room(element: u32, part: &Part, volumes: Range<usize>, tables: &mut Tables) {
    let room = tables.rooms.len() as u32;
    // An element without triangles is nowhere; readers leave such out, but a model made by hand may have one.
    let mut bounds = part.pieces.first().map_or([[0.0; 3]; 2], |piece| piece.component.bounds);
    for piece in &part.pieces {
        let [lo, hi] = piece.component.bounds;
        bounds[0] = [0, 1, 2].map(|axis| bounds[0][axis].min(lo[axis]));
        bounds[1] = [0, 1, 2].map(|axis| bounds[1][axis].max(hi[axis]));
    }
    let (mut volume, mut floor_area, mut closed) = (0.0, 0.0, false);
    for record in &mut tables.volumes[volumes] {
        record.room = room;
        closed = true;
        volume += record.measure;
        let first = record.first_triangle as usize;
        let (mut down, mut up) = (0.0, 0.0);
        for triangle in &tables.triangles[first..first + record.triangle_count as usize] {
            let [a, b, c] = triangle.map(|v| tables.vertices[v as usize]);
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            down += (-twice / 2.0).max(0.0);
            up += (twice / 2.0).max(0.0);
        }
        // Of a closed mesh both are equal; of one whose triangles disagree their mean is the better guess.
        floor_area += (down + up) / 2.0;
    }
    tables.rooms.push(RoomRecord { bounds, volume, floor_area, element, closed: u32::from(closed) });
}
