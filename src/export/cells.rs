//! Rooms and cells as volumes, in glTF: to look at how space was cut.

use std::collections::BTreeMap;

use glam::DVec3;
use serde_json::json;

use crate::graph::{Fill, Place, fills, footprint};
use crate::scene::Scene;
use crate::trace::Prisms;

/// The cells of rooms, openings and voids as a GLB file: a node for each room or opening, tagged (`extras.semantic`, `extras.global_id`), and below
/// it a node for each of its cells with a closed mesh. With `explode` above 0 they stand apart: what belongs to one place is moved away from the
/// middle of all by that share of its distance, and its cells from its own middle by half of that share.
///
/// Metres, Y up, as glTF has it; the offset of a far model is in the root's translation.
pub fn cells_glb(scene: &Scene, explode: f64) -> Vec<u8> {
    let prisms = Prisms::new(&scene.tables);
    let mut groups: BTreeMap<Fill, Vec<u32>> = BTreeMap::new();
    for (fill, cell) in fills(&prisms).into_iter().zip(0u32..) {
        if matches!(fill, Fill::Opening(_) | Fill::Place(Place::Room(_) | Place::Void(_))) {
            groups.entry(fill).or_default().push(cell);
        }
    }
    let mut file = File::default();
    let meshes: BTreeMap<u32, Volume> =
        groups.values().flatten().map(|&cell| (cell, Volume::of(&prisms, cell))).collect();
    let all = middle(meshes.values());
    let mut roots = Vec::new();
    for (number, (fill, cells)) in groups.iter().enumerate() {
        let (name, extras, color): (String, serde_json::Value, [f64; 3]) = match *fill {
            Fill::Opening(element) => tag(scene, element, [0.55, 0.75, 0.9]),
            Fill::Place(Place::Room(room)) => tag(scene, scene.room(room).element().index(), tint(room)),
            _ => (format!("VOID:{number}"), json!({ "semantic": "EXTERIOR" }), [0.9, 0.5, 0.5]),
        };
        let material = file.material(&name, color);
        let own = middle(cells.iter().map(|cell| &meshes[cell]));
        let moved = (own - all) * explode;
        let children: Vec<usize> = cells
            .iter()
            .filter(|cell| !meshes[cell].triangles.is_empty())
            .map(|cell| {
                let volume = &meshes[cell];
                let mesh = file.mesh(volume, all, material);
                let moved = (volume.middle - own) * (explode / 2.0);
                let id = format!("{} cell {cell}", extras["global_id"].as_str().unwrap_or("VOID"));
                let extras = json!({ "semantic": extras["semantic"], "global_id": id, "cell": cell });
                file.node(json!({ "name": format!("cell {cell}"), "mesh": mesh, "translation": up(moved), "extras": extras }))
            })
            .collect();
        roots.push(
            file.node(
                json!({ "name": name, "translation": up(moved), "children": children, "extras": extras }),
            ),
        );
    }
    let offset = DVec3::from(scene.frame().offset);
    let mut root = json!({ "name": "cells", "translation": up(all + offset) });
    // Empty lists are not allowed.
    if !roots.is_empty() {
        root["children"] = roots.into();
    }
    let root = file.node(root);
    file.finish(root)
}

fn tag(scene: &Scene, element: u32, color: [f64; 3]) -> (String, serde_json::Value, [f64; 3]) {
    let element = scene.element(element);
    let class = if element.class().is_empty() { element.semantic().name() } else { element.class() };
    let name = if element.name().is_empty() { element.id() } else { element.name() };
    let extras = json!({
        "semantic": element.semantic().name(),
        "global_id": element.id(),
        "name": element.name(),
        "storey": element.storey(),
        "ifc_class": element.class(),
    });
    (format!("{class}:{name}"), extras, color)
}

/// Hues as far apart as the golden angle puts them.
fn tint(room: u32) -> [f64; 3] {
    let hue = f64::from(room) * 137.508 % 360.0 / 60.0;
    [5.0, 3.0, 1.0].map(|shift| {
        let k = (shift + hue) % 6.0;
        0.85 - 0.45 * k.min(4.0 - k).clamp(0.0, 1.0)
    })
}

/// Along the axes of glTF: Y up.
fn up(p: DVec3) -> [f64; 3] {
    [p.x, p.z, -p.y]
}

/// A cell's closed mesh, internal frame.
struct Volume {
    triangles: Vec<[DVec3; 3]>,
    middle: DVec3,
}

impl Volume {
    fn of(prisms: &Prisms<'_>, cell: u32) -> Volume {
        let record = &prisms.cells[cell as usize];
        let corners = footprint(prisms, record);
        let [low, high] = [record.floor, record.ceiling].map(|plane| -> Vec<DVec3> {
            corners.iter().map(|&p| prisms.global(p.extend(prisms.height(plane, p)))).collect()
        });
        let mut triangles = Vec::with_capacity(4 * corners.len());
        for [i, j, k] in (2..corners.len()).map(|i| [0, i - 1, i]) {
            triangles.extend([[low[i], low[k], low[j]], [high[i], high[j], high[k]]]);
        }
        for i in 0..corners.len() {
            let j = (i + 1) % corners.len();
            triangles.extend([[low[i], low[j], high[j]], [low[i], high[j], high[i]]]);
        }
        // Where floor and ceiling meet there is no side.
        triangles.retain(|[a, b, c]| a != b && b != c && c != a);
        let corners = || triangles.iter().flatten();
        let lo = corners().fold(DVec3::INFINITY, |lo, p| lo.min(*p));
        let hi = corners().fold(DVec3::NEG_INFINITY, |hi, p| hi.max(*p));
        let middle = if triangles.is_empty() { DVec3::ZERO } else { (lo + hi) / 2.0 };
        Volume { triangles, middle }
    }
}

fn middle<'a>(volumes: impl Iterator<Item = &'a Volume>) -> DVec3 {
    let (sum, count) =
        volumes.fold((DVec3::ZERO, 0.0), |(sum, count), volume| (sum + volume.middle, count + 1.0));
    if count > 0.0 { sum / count } else { DVec3::ZERO }
}

/// A glTF file that grows.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<serde_json::Value>,
    accessors: Vec<serde_json::Value>,
    meshes: Vec<serde_json::Value>,
    materials: Vec<serde_json::Value>,
    nodes: Vec<serde_json::Value>,
}

impl File {
    fn node(&mut self, node: serde_json::Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn material(&mut self, name: &str, [r, g, b]: [f64; 3]) -> usize {
        let look =
            json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9 });
        self.materials.push(json!({ "name": name, "pbrMetallicRoughness": look, "doubleSided": true }));
        self.materials.len() - 1
    }

    /// Positions relative to `origin`, three for each triangle.
    fn mesh(&mut self, volume: &Volume, origin: DVec3, material: usize) -> usize {
        let offset = self.bytes.len();
        let (mut lo, mut hi) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for corner in volume.triangles.iter().flatten() {
            let p = up(*corner - origin).map(|c| c as f32);
            for axis in 0..3 {
                lo[axis] = lo[axis].min(p[axis]);
                hi[axis] = hi[axis].max(p[axis]);
                self.bytes.extend(p[axis].to_le_bytes());
            }
        }
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.bytes.len() - offset, "target": 34962 }));
        self.accessors.push(json!({
            "bufferView": self.views.len() - 1,
            "componentType": 5126,
            "count": volume.triangles.len() * 3,
            "type": "VEC3",
            "min": lo,
            "max": hi,
        }));
        let position = self.accessors.len() - 1;
        self.meshes.push(
            json!({ "primitives": [{ "attributes": { "POSITION": position }, "material": material }] }),
        );
        self.meshes.len() - 1
    }

    fn finish(self, root: usize) -> Vec<u8> {
        let mut document = json!({
            "asset": { "version": "2.0", "generator": concat!("enfilade ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "nodes": [root] }],
            "nodes": self.nodes,
        });
        // Empty lists are not allowed.
        for (key, list) in [
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("accessors", self.accessors),
            ("bufferViews", self.views),
        ] {
            if !list.is_empty() {
                document[key] = list.into();
            }
        }
        if !self.bytes.is_empty() {
            document["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let chunk = |bytes: &[u8]| if bytes.is_empty() { 0 } else { 8 + bytes.len() };
        let length = 12 + chunk(&text) + chunk(&self.bytes);
        let mut glb = Vec::with_capacity(length);
        glb.extend(b"glTF");
        glb.extend(2u32.to_le_bytes());
        glb.extend((length as u32).to_le_bytes());
        for (kind, bytes) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            if !bytes.is_empty() {
                glb.extend((bytes.len() as u32).to_le_bytes());
                glb.extend(kind);
                glb.extend(bytes);
            }
        }
        glb
    }
}
