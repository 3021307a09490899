//! A small glTF file that is right, for tests to damage.

use serde_json::{Value, json};

/// Its JSON: a wall of four triangles below a site, with indexed and sparse points, a material and a camera. Nodes are
/// 0 `site`, 1 `IfcWall:W` and 2 `eye`; accessors 0 the points and 1 the indices.
pub fn json() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "site", "children": [1, 2] },
            { "name": "IfcWall:W", "mesh": 0 },
            { "name": "eye", "camera": 0 }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{}],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }],
        "accessors": [
            {
                "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                "min": [0, 0, 0], "max": [2, 1, 1],
                "sparse": {
                    "count": 2,
                    "indices": { "bufferView": 2, "componentType": 5123 },
                    "values": { "bufferView": 3 }
                }
            },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 76, "byteLength": 24 }
        ],
        "buffers": [{ "byteLength": 100 }]
    })
}

/// Its binary chunk: 0 to 48 four points, 48 to 72 twelve 16-bit indices, 72 to 76 two sparse 16-bit indices, 76 to
/// 100 two sparse points.
pub fn bin() -> Vec<u8> {
    let floats = |values: &[f32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let shorts = |values: &[u16]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    [
        floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 9.0, 9.0, 9.0]),
        shorts(&[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]),
        shorts(&[1, 3]),
        floats(&[2.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
    ]
    .concat()
}

/// `json` with another value at a pointer (RFC 6901). A field may be new; what it is in must be there.
///
/// # Panics
/// If the pointer leads nowhere.
pub fn changed(mut json: Value, pointer: &str, value: Value) -> Value {
    let (parent, key) = pointer.rsplit_once('/').unwrap_or_else(|| panic!("{pointer} is no pointer"));
    let place = match json.pointer_mut(parent) {
        Some(Value::Array(items)) => key.parse::<usize>().ok().and_then(|index| items.get_mut(index)),
        Some(Value::Object(fields)) => Some(fields.entry(key).or_insert(Value::Null)),
        _ => None,
    };
    *place.unwrap_or_else(|| panic!("no {pointer}")) = value;
    json
}

/// [`bin`] with other bytes from `offset` on.
///
/// # Panics
/// If they do not fit.
pub fn patched(offset: usize, bytes: &[u8]) -> Vec<u8> {
    let mut bin = bin();
    bin[offset..offset + bytes.len()].copy_from_slice(bytes);
    bin
}
