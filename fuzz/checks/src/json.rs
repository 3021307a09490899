//! Mutations of a JSON tree: what comes out is always JSON, so that readers get past their parsers.

use enfilade_testing::Random;
use serde_json::{Map, Number, Value, json};

/// Keys and words of glTF and of the metadata that enfilade reads.
pub const WORDS: [&str; 112] = [
    "accessors",
    "bufferViews",
    "buffers",
    "meshes",
    "nodes",
    "scenes",
    "scene",
    "materials",
    "textures",
    "images",
    "samplers",
    "cameras",
    "skins",
    "animations",
    "extensions",
    "extras",
    "extensionsRequired",
    "extensionsUsed",
    "asset",
    "version",
    "minVersion",
    "generator",
    "children",
    "mesh",
    "camera",
    "skin",
    "matrix",
    "rotation",
    "scale",
    "translation",
    "weights",
    "name",
    "primitives",
    "attributes",
    "POSITION",
    "NORMAL",
    "TEXCOORD_0",
    "COLOR_0",
    "JOINTS_0",
    "WEIGHTS_0",
    "_CUSTOM",
    "TRANSLATION",
    "ROTATION",
    "SCALE",
    "indices",
    "material",
    "mode",
    "targets",
    "bufferView",
    "byteOffset",
    "byteLength",
    "byteStride",
    "target",
    "componentType",
    "count",
    "type",
    "normalized",
    "min",
    "max",
    "sparse",
    "values",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT2",
    "MAT3",
    "MAT4",
    "uri",
    "mimeType",
    "image/png",
    "image/jpeg",
    "image/webp",
    "source",
    "sampler",
    "index",
    "texCoord",
    "pbrMetallicRoughness",
    "baseColorFactor",
    "baseColorTexture",
    "metallicFactor",
    "roughnessFactor",
    "metallicRoughnessTexture",
    "emissiveFactor",
    "emissiveTexture",
    "alphaMode",
    "alphaCutoff",
    "BLEND",
    "MASK",
    "OPAQUE",
    "doubleSided",
    "perspective",
    "orthographic",
    "yfov",
    "znear",
    "zfar",
    "aspectRatio",
    "xmag",
    "ymag",
    "KHR_lights_punctual",
    "lights",
    "light",
    "spot",
    "innerConeAngle",
    "outerConeAngle",
    "EXT_mesh_gpu_instancing",
    "semantic",
    "ifc_class",
    "global_id",
    "storey",
    "host",
    "filling",
];

/// Numbers at the edge of something, as JSON has them.
fn number(old: Option<f64>, random: &mut Random) -> Value {
    const WHOLE: [i64; 26] = [
        0,
        1,
        2,
        3,
        4,
        5,
        6,
        7,
        -1,
        255,
        256,
        5120,
        5121,
        5122,
        5123,
        5125,
        5126,
        34962,
        34963,
        65535,
        65536,
        1 << 31,
        u32::MAX as i64,
        1 << 32,
        i64::MAX,
        i64::MIN,
    ];
    const REAL: [f64; 12] =
        [0.5, -0.0, 1e-9, 5e-324, 1e12, 1e13, -1e13, 3.4e38, 1e39, 1e154, f64::MAX, f64::MIN];
    match (random.below(5), old) {
        (0, Some(old)) => json!(old + 1.0),
        (1, Some(old)) if old.fract() == 0.0 && old.abs() < 1e15 => json!(old as i64 + 1),
        (2, Some(old)) if old.fract() == 0.0 && old.abs() < 1e15 => json!(old as i64 - 1),
        (3, _) => json!(*random.pick(&REAL)),
        (4, _) if random.one_in(4) => json!(u64::MAX),
        _ => Value::Number(Number::from(*random.pick(&WHOLE))),
    }
}

/// Changes one value of the tree, a key, or what an array or an object holds.
pub fn mutate(root: &mut Value, random: &mut Random) {
    let size = count(root);
    // Another value of the same file, to be put somewhere else.
    let mut at = random.below(size);
    let other = nth(root, &mut at).map_or(Value::Null, |value| value.clone());
    let mut at = random.below(size);
    let Some(value) = nth(root, &mut at) else { return };
    if random.one_in(12) {
        *value = strange(other, random);
        return;
    }
    match value {
        Value::Array(items) => mutate_array(items, other, random),
        Value::Object(members) => mutate_object(members, other, random),
        Value::String(text) => *text = mutate_text(text, &other, random),
        Value::Number(old) => *value = number(old.as_f64(), random),
        Value::Bool(old) => *value = Value::Bool(!*old),
        Value::Null => *value = other,
    }
}

fn strange(other: Value, random: &mut Random) -> Value {
    match random.below(6) {
        0 => Value::Null,
        1 => json!([]),
        2 => json!({}),
        3 => json!(""),
        4 => json!([other]),
        _ => other,
    }
}

fn mutate_array(items: &mut Vec<Value>, other: Value, random: &mut Random) {
    let at = random.below(items.len());
    match random.below(6) {
        0 if !items.is_empty() => drop(items.remove(at)),
        1 if !items.is_empty() => items.push(items[at].clone()),
        2 if !items.is_empty() => {
            let to = random.below(items.len());
            items.swap(at, to);
        }
        3 => items.truncate(at),
        4 if !items.is_empty() => items[at] = number(None, random),
        _ => items.push(other),
    }
}

fn mutate_object(members: &mut Map<String, Value>, other: Value, random: &mut Random) {
    let keys: Vec<String> = members.keys().cloned().collect();
    let word = (*random.pick(&WORDS)).to_owned();
    if keys.is_empty() {
        members.insert(word, other);
        return;
    }
    let key = random.pick(&keys);
    match random.below(5) {
        0 => drop(members.remove(key)),
        1 => {
            let value = members.remove(key).unwrap_or(Value::Null);
            members.insert(word, value);
        }
        2 => drop(members.insert(word, number(None, random))),
        3 => drop(members.insert(key.clone(), other)),
        _ => drop(members.insert(word, other)),
    }
}

fn mutate_text(text: &str, other: &Value, random: &mut Random) -> String {
    let mut cut = random.below(text.len() + 1);
    while !text.is_char_boundary(cut) {
        cut -= 1;
    }
    match (random.below(5), other) {
        (0, _) => text[..cut].to_owned(),
        (1, Value::String(other)) => other.clone(),
        (2, Value::String(other)) => format!("{}{other}{}", &text[..cut], &text[cut..]),
        (3, _) => {
            const PIECES: [&str; 16] = [
                "#",
                ":",
                "/",
                "..",
                "%2e",
                "~2",
                "[2]",
                "ü",
                "\u{0}",
                "\u{feff}",
                "-",
                "_",
                "WALL",
                "IfcWall:",
                "data:image/png;base64,",
                ",",
            ];
            format!("{}{}{}", &text[..cut], random.pick(&PIECES), &text[cut..])
        }
        _ => (*random.pick(&WORDS)).to_owned(),
    }
}

/// How many values the tree has, itself included.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum(),
        Value::Object(members) => members.values().map(count).sum(),
        _ => 0,
    }
}

/// The value number `at` of the tree, in the order of its text.
fn nth<'a>(value: &'a mut Value, at: &mut usize) -> Option<&'a mut Value> {
    if *at == 0 {
        return Some(value);
    }
    *at -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| nth(item, at)),
        Value::Object(members) => members.values_mut().find_map(|member| nth(member, at)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_can_be_reached_and_changed() {
        let tree = json!({ "a": [1, { "b": "ü", "c": null }], "d": true });
        assert_eq!(count(&tree), 7);
        let all: Vec<Value> = (0..7).map(|i| nth(&mut tree.clone(), &mut { i }).unwrap().clone()).collect();
        assert_eq!(
            all[1..],
            [tree["a"].clone(), json!(1), tree["a"][1].clone(), json!("ü"), json!(null), json!(true)]
        );
        assert_eq!(nth(&mut tree.clone(), &mut 7), None);
        let mut random = Random::new(1);
        let mut changed = 0;
        for _ in 0..1000 {
            let mut copy = tree.clone();
            mutate(&mut copy, &mut random);
            changed += usize::from(copy != tree);
        }
        assert!(changed > 900, "{changed}");
    }
}
