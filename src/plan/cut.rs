//! What a level plane cuts: of cells polygons, of matter its outlines, of detail lines.

use std::collections::HashMap;

use enfilade_importers::Role;
use glam::{DVec2, DVec3};

use crate::format::records::CellRecord;
use crate::graph::{cut, footprint};
use crate::scene::Scene;
use crate::trace::{NONE, Prisms};

/// A cell that the plane cuts.
pub(super) struct CutCell {
    pub(super) cell: u32,
    /// Counter-clockwise; metres, internal frame's plan.
    pub(super) polygon: Vec<[f64; 2]>,
}

/// The cells that the level `z` (internal frame) cuts.
pub(super) fn cells(prisms: &Prisms<'_>, z: f64) -> Vec<CutCell> {
    let level = prisms.local(DVec3::new(0.0, 0.0, z)).z;
    let mut cells = Vec::new();
    for (record, cell) in prisms.cells.iter().zip(0u32..).skip(1) {
        if record.bounds[0][2] > level || record.bounds[1][2] <= level {
            continue;
        }
        let over = |p: DVec2| level - prisms.height(record.floor, p);
        let under = |p: DVec2| prisms.height(record.ceiling, p) - level;
        let polygon = cut(&cut(&footprint(prisms, record), over), under);
        if polygon.len() >= 3 {
            let polygon = polygon.into_iter().map(|p| plan(prisms, p)).collect();
            cells.push(CutCell { cell, polygon });
        }
    }
    cells
}

fn plan(prisms: &Prisms<'_>, p: DVec2) -> [f64; 2] {
    let p = prisms.global(p.extend(0.0));
    [p.x, p.y]
}

/// Where the air of cut cells ends at what `is_other` says of the cell beyond, as lines.
pub(super) fn borders(
    prisms: &Prisms<'_>,
    cut: &[CutCell],
    z: f64,
    is_border: impl Fn(&CellRecord, &CellRecord) -> bool,
) -> Vec<Vec<[f64; 2]>> {
    let level = prisms.local(DVec3::new(0.0, 0.0, z)).z;
    let mut segments = Vec::new();
    for record in
        cut.iter().map(|cut| &prisms.cells[cut.cell as usize]).filter(|record| record.kind == CellRecord::AIR)
    {
        let corners = footprint(prisms, record);
        for (i, side) in prisms.sides_of(record).iter().enumerate() {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let middle = (a + b) / 2.0;
            if prisms.height(record.floor, middle) > level || prisms.height(record.ceiling, middle) <= level {
                continue;
            }
            let faces = prisms.faces_of(side);
            let face = faces
                .iter()
                .find(|face| face.top == NONE || prisms.height(face.top, middle) > level)
                .or(faces.last());
            if face.is_some_and(|face| is_border(record, &prisms.cells[face.cell as usize])) {
                segments.push([plan(prisms, a), plan(prisms, b)]);
            }
        }
    }
    chained(segments)
}

/// Segments that go on from each other as one line.
fn chained(segments: Vec<[[f64; 2]; 2]>) -> Vec<Vec<[f64; 2]>> {
    let bits = |p: [f64; 2]| p.map(|c| (c * 1e5).round() as i64);
    let mut from: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (i, [a, _]) in segments.iter().enumerate().rev() {
        from.entry(bits(*a)).or_default().push(i);
    }
    let mut is_used = vec![false; segments.len()];
    let mut lines = Vec::new();
    for first in 0..segments.len() {
        if is_used[first] {
            continue;
        }
        let mut line = vec![segments[first][0]];
        let mut next = Some(first);
        while let Some(i) = next {
            is_used[i] = true;
            line.push(segments[i][1]);
            let ahead = from.get_mut(&bits(segments[i][1]));
            next = ahead.and_then(|ahead| {
                while let Some(i) = ahead.pop() {
                    if !is_used[i] {
                        return Some(i);
                    }
                }
                None
            });
        }
        lines.push(line);
    }
    lines
}

/// Where the plane cuts triangles of detail.
pub(super) fn detail(scene: &Scene, z: f64) -> Vec<Vec<[f64; 2]>> {
    let mut segments = Vec::new();
    for element in scene.elements().filter(|element| element.role() == Role::Detail) {
        let record = &scene.tables.elements[element.index() as usize];
        for triangle in record.first_triangle..record.first_triangle + record.triangle_count {
            let corners = scene.triangle(triangle);
            let over = corners.map(|p| p[2] - z);
            if over.iter().all(|o| *o >= 0.0) || over.iter().all(|o| *o < 0.0) {
                continue;
            }
            let mut ends = Vec::with_capacity(2);
            for i in 0..3 {
                let (a, b, s, t) = (corners[i], corners[(i + 1) % 3], over[i], over[(i + 1) % 3]);
                if (s >= 0.0) != (t >= 0.0) {
                    let share = s / (s - t);
                    ends.push([a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]);
                }
            }
            if let [a, b] = ends[..] {
                segments.push([a, b]);
            }
        }
    }
    segments.into_iter().map(|[a, b]| vec![a, b]).filter(|line| far(line[0], line[1])).collect()
}

/// Shorter lines show nothing, metres.
const DOT: f64 = 2e-3;

fn far(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) >= DOT
}
