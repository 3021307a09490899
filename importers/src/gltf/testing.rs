//! Small glTF files for tests.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};

use crate::error::ImportError;
use crate::import::ImportOptions;
use crate::model::Model;

/// A glTF file in the making: one buffer, and the JSON that describes it.
#[derive(Clone)]
pub(super) struct GltfText {
    pub json: Value,
    pub bin: Vec<u8>,
}

/// Corners of a triangle in the plane z = 0, counter-clockwise.
pub(super) const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

impl GltfText {
    /// One node `a` without a mesh.
    pub fn empty() -> GltfText {
        let json = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": [0] }],
            "nodes": [{ "name": "a" }],
            "meshes": [], "accessors": [], "bufferViews": []
        });
        GltfText { json, bin: Vec::new() }
    }

    /// One node `a` with a mesh of one unindexed triangle ([`TRIANGLE`]).
    pub fn triangle() -> GltfText {
        let mut text = GltfText::empty();
        let positions = text.floats(&TRIANGLE);
        text.mesh(json!([{ "attributes": { "POSITION": positions } }]));
        text.json["nodes"][0]["mesh"] = json!(0);
        text
    }

    /// Node `a` with one primitive of `mode`, with these points and indices.
    pub fn primitive(mode: u32, points: &[[f32; 3]], indices: Option<&[u32]>) -> GltfText {
        let mut text = GltfText::empty();
        let positions = text.floats(points);
        let mut primitive = json!({ "attributes": { "POSITION": positions }, "mode": mode });
        if let Some(indices) = indices {
            let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
            primitive["indices"] = json!(text.accessor(&bytes, 5125, "SCALAR", indices.len()));
        }
        text.mesh(json!([primitive]));
        text.json["nodes"][0]["mesh"] = json!(0);
        text
    }

    /// Adds a buffer view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({ "buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len() });
        self.bin.extend_from_slice(bytes);
        push(&mut self.json["bufferViews"], view)
    }

    /// Adds an accessor with a view of its own.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor =
            json!({ "bufferView": view, "componentType": component, "type": kind, "count": count });
        push(&mut self.json["accessors"], accessor)
    }

    /// Adds an accessor of f32 points.
    pub fn floats(&mut self, points: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = points.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, "VEC3", points.len())
    }

    /// Adds a mesh.
    pub fn mesh(&mut self, primitives: Value) -> usize {
        push(&mut self.json["meshes"], json!({ "primitives": primitives }))
    }

    fn with_buffer(&self, uri: Option<&str>) -> Vec<u8> {
        let mut json = self.json.clone();
        if !self.bin.is_empty() && json.get("buffers").is_none() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
            if let Some(uri) = uri {
                json["buffers"][0]["uri"] = json!(uri);
            }
        }
        serde_json::to_vec(&json).unwrap()
    }

    /// As `.gltf` with a data URI.
    pub fn embedded(&self) -> Vec<u8> {
        let uri = format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(&self.bin));
        self.with_buffer(Some(&uri))
    }

    /// As `.gltf` whose buffer is at `uri`.
    pub fn external(&self, uri: &str) -> Vec<u8> {
        self.with_buffer(Some(uri))
    }

    /// As `.glb`.
    pub fn glb(&self) -> Vec<u8> {
        let glb = gltf::binary::Glb {
            header: gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 },
            json: self.with_buffer(None).into(),
            bin: Some(self.bin.as_slice().into()),
        };
        glb.to_vec().unwrap()
    }
}

fn push(array: &mut Value, item: Value) -> usize {
    let array = array.as_array_mut().unwrap();
    array.push(item);
    array.len() - 1
}

/// Reads it from memory.
pub(super) fn read(text: &GltfText) -> Result<Model, ImportError> {
    crate::gltf::read_slice(&text.embedded(), "test.gltf", &ImportOptions::default())
}

/// The triangles of an element in glTF's axes, as corners.
pub(super) fn triangles(model: &Model, element: usize) -> Vec<[[f64; 3]; 3]> {
    let mesh = &model.elements[element].mesh;
    (0..mesh.triangles.len())
        .map(|triangle| mesh.corners(triangle).map(|corner| model.frame.point_to_source(corner)))
        .collect()
}
