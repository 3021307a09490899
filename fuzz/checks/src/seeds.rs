//! Where fuzzing starts: small files of many forms, written here or cut out of the fixtures.

use std::path::PathBuf;

use enfilade::importers::tagging::Rules;
use enfilade::importers::{ImportOptions, Semantic, import};
use enfilade::{CompileOptions, compile};
use serde_json::{Value, json};

use crate::glb::Parts;
use crate::obj::BETWEEN;

/// Inputs by name.
pub type Seeds = Vec<(String, Vec<u8>)>;

/// The seeds of each target.
pub fn all() -> Vec<(&'static str, Seeds)> {
    let scenes = enf();
    vec![
        ("gltf", gltf()),
        ("obj", obj()),
        ("truth", truth()),
        ("rules", rules()),
        ("enf", scenes.clone()),
        ("enf_sealed", scenes),
    ]
}

/// A grey PNG picture of two texels.
pub const PNG: &[u8] = b"\x89PNG\r\n\x1A\n\0\0\0\rIHDR\0\0\0\x02\0\0\0\x01\x08\0\0\0\0\xD1I V\0\0\0\x0BIDATx\x9Cchp\0\0\x01C\0\xC1_\xD4\x95\r\0\0\0\0IEND\xAEB`\x82";

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name)
}

fn named<T: AsRef<[u8]>>(name: &str, bytes: T) -> (String, Vec<u8>) {
    (name.to_owned(), bytes.as_ref().to_vec())
}

/// glTF files: one with some of everything, its variants, and elements of the generated house.
pub fn gltf() -> Seeds {
    let bin = gltf_bin();
    let with = |name: &str, change: fn(&mut Value)| {
        let mut json = gltf_json();
        change(&mut json);
        named(name, Parts { json: json.to_string().into_bytes(), bin: Some(bin.clone()) }.file())
    };
    let mut seeds = vec![
        with("tetrahedron", |_| {}),
        with("strip", |json| json["meshes"][0]["primitives"][0]["mode"] = json!(5)),
        with("fan", |json| json["meshes"][0]["primitives"][0]["mode"] = json!(6)),
        with("unindexed", |json| {
            json["meshes"][0]["primitives"][0] = json!({ "attributes": { "POSITION": 4 } });
        }),
        with("lines-and-points", |json| {
            let primitives = &mut json["meshes"][0]["primitives"];
            *primitives = json!([primitives[0], { "attributes": { "POSITION": 0 }, "mode": 0 },
                { "attributes": { "POSITION": 0 }, "mode": 3 }]);
        }),
        with("quantized", |json| {
            json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            json["accessors"][0] = json!({ "bufferView": 1, "componentType": 5122, "normalized": true,
                "count": 4, "type": "VEC3" });
        }),
        with("instances", |json| {
            json["nodes"][1]["extensions"] = json!({ "EXT_mesh_gpu_instancing":
                { "attributes": { "TRANSLATION": 0, "SCALE": 0 } } });
        }),
        with("matrix", |json| {
            json["nodes"][0] = json!({ "children": [1, 2],
                "matrix": [0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 5000, 0, 0, 1] });
        }),
        with("old-materials", |json| {
            json["materials"] = json!([{ "alphaMode": "MASK", "alphaCutoff": 0.5,
                "extensions": { "KHR_materials_pbrSpecularGlossiness": { "diffuseFactor": [1, 1, 1, 0.5],
                    "diffuseTexture": { "index": 0 }, "specularFactor": [1, 1, 1], "glossinessFactor": 0.5 } } }]);
        }),
    ];
    let mut text = gltf_json();
    text["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{}", base64(&bin)));
    seeds.push(named("text", text.to_string()));
    for node in [8, 40, 77] {
        seeds.push((format!("house-{node}"), house_node(node)));
    }
    seeds
}

/// A tetrahedron below a site, sparse points, a material with a picture in a data URI and one in a view, lights and
/// cameras, metadata and links.
fn gltf_json() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_ior"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [
            { "name": "Site", "children": [1, 2], "translation": [1.0, 2.0, 3.0] },
            { "name": "IfcWall:W", "mesh": 0, "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [1, 2, 1],
              "extras": { "global_id": "w", "storey": "EG", "ifc_class": "IfcWall", "host": "w", "list": [1, "a"] } },
            { "name": "eye", "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } },
              "children": [3] },
            { "name": "ROOM_a", "mesh": 0, "camera": 1, "extensions": { "KHR_lights_punctual": { "light": 1 } } }
        ],
        "meshes": [{ "name": "m", "primitives": [
            { "attributes": { "POSITION": 0, "TEXCOORD_0": 5 }, "indices": 1, "material": 0 }
        ] }],
        "materials": [{
            "name": "Glass", "doubleSided": true, "alphaMode": "BLEND",
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "baseColorFactor": [1, 0.5, 0, 0.5] },
            "emissiveTexture": { "index": 1 }, "emissiveFactor": [1, 1, 1],
            "extensions": { "KHR_materials_ior": { "ior": 1.4 },
                "KHR_materials_transmission": { "transmissionFactor": 0.5, "transmissionTexture": { "index": 1 } },
                "KHR_materials_emissive_strength": { "emissiveStrength": 2 } }
        }],
        "textures": [{ "source": 0 }, { "source": 1, "extensions": { "EXT_texture_webp": { "source": 1 } } }],
        "images": [{ "uri": format!("data:image/png;base64,{}", base64(PNG)) },
            { "bufferView": 4, "mimeType": "image/png" }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } },
            { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 2, "znear": 0 } }],
        "extensions": { "KHR_lights_punctual": { "lights": [
            { "type": "point", "color": [1, 0.5, 0], "intensity": 10, "range": 5 },
            { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.7 } }
        ] } },
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "sparse": { "count": 2, "indices": { "bufferView": 2, "componentType": 5123 },
                  "values": { "bufferView": 3 } } },
            { "bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR" },
            { "bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR" },
            { "bufferView": 0, "componentType": 5125, "count": 3, "type": "SCALAR", "byteOffset": 4 },
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 12 },
            { "componentType": 5126, "count": 4, "type": "VEC2" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 72, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 76, "byteLength": 24 },
            { "buffer": 0, "byteOffset": 100, "byteLength": PNG.len() }
        ],
        "buffers": [{ "byteLength": 100 + PNG.len() }]
    })
}

/// Four points, twelve indices, two sparse indices, two sparse points, a picture.
fn gltf_bin() -> Vec<u8> {
    let floats = |values: &[f32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let shorts = |values: &[u16]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
    let mut bin = [
        floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 9.0, 9.0, 9.0]),
        shorts(&[0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]),
        shorts(&[1, 3]),
        floats(&[2.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        PNG.to_vec(),
    ]
    .concat();
    bin.resize(bin.len().next_multiple_of(4), 0);
    bin
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0u32, |n, &b| n << 8 | u32::from(b)) << (8 * (3 - three.len()));
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= three.len() { DIGITS[value] as char } else { '=' });
        }
    }
    text
}

/// The generated house with one of its nodes alone. Only what this node's mesh uses is kept.
fn house_node(node: usize) -> Vec<u8> {
    let house = std::fs::read(fixture("house.glb")).expect("the fixture is there");
    let parts = Parts::of(&house);
    let bin = parts.bin.unwrap_or_default();
    let mut json: Value = serde_json::from_slice(&parts.json).expect("the fixture is JSON");
    json["nodes"] = json!([json["nodes"][node]]);
    json["scenes"] = json!([{ "nodes": [0] }]);
    let index = |value: &Value| value.as_u64().expect("an index") as usize;
    let mut mesh = json["meshes"][index(&json["nodes"][0]["mesh"])].clone();
    let (mut views, mut accessors, mut kept) = (Vec::new(), Vec::new(), Vec::new());
    let mut keep = |old: &mut Value| {
        let mut accessor = json["accessors"][index(old)].clone();
        let view = &json["bufferViews"][index(&accessor["bufferView"])];
        let stride = if accessor["type"] == "VEC3" { 12 } else { 2 };
        let start = index(&view["byteOffset"].as_u64().map_or(json!(0), Value::from))
            + index(&accessor["byteOffset"]);
        let length = index(&accessor["count"]) * stride;
        views.push(json!({ "buffer": 0, "byteOffset": kept.len(), "byteLength": length }));
        kept.extend_from_slice(&bin[start..start + length]);
        kept.resize(kept.len().next_multiple_of(4), 0);
        accessor["bufferView"] = json!(views.len() - 1);
        accessor["byteOffset"] = json!(0);
        accessors.push(accessor);
        *old = json!(accessors.len() - 1);
    };
    for primitive in mesh["primitives"].as_array_mut().expect("primitives") {
        keep(&mut primitive["attributes"]["POSITION"]);
        keep(&mut primitive["indices"]);
        primitive["material"] = json!(0);
    }
    json["nodes"][0]["mesh"] = json!(0);
    json["meshes"] = json!([mesh]);
    json["materials"] = json!([json["materials"][0]]);
    json["accessors"] = json!(accessors);
    json["bufferViews"] = json!(views);
    json["buffers"] = json!([{ "byteLength": kept.len() }]);
    for name in ["cameras", "extensions", "extensionsUsed"] {
        json.as_object_mut().expect("an object").remove(name);
    }
    Parts { json: json.to_string().into_bytes(), bin: Some(kept) }.file()
}

/// OBJ files, with libraries, and objects of the generated house.
pub fn obj() -> Seeds {
    const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    const LIBRARY: &str = "newmtl Glass\nKd 0.5 0.6 0.7\nKe 1 1 1\nd 0.3\nTr 0.7\nNi 1.5\nNs 100\nPr 0.5\nPm 1\n\
        illum 4\nTf 0.9 0.9 0.9\nmap_Kd -s 1 1 1 -o 0 0 0 a.png\nnewmtl b\nKd spectral x.rfl\nmap_Kd b.png\n";
    let with_library = |text: String| [text.as_bytes(), &BETWEEN[1..], LIBRARY.as_bytes()].concat();
    let mut seeds = vec![
        named(
            "cube",
            with_library(format!(
                "# a cube\nmtllib a.mtl\n{CUBE}o IfcWall:W#1\nusemtl Glass\nf 1 4 3 2\nf 5 6 7 8\nusemtl b\n\
                 f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
            )),
        ),
        named(
            "groups",
            format!(
                "{CUBE}vt 0 0\nvn 0 0 1\ng Storey:EG a\ns 1\nf 1/1/1 2/1/1 3/1/1\ng b c\nf -1//1 -2//1 -3//1\n\
                 o x\nl 1 2 3\np 1\nf 1/1 2/1 3/1 4/1\no x\nf 1 2 3\n"
            ),
        ),
        named(
            "concave",
            "v 0 0 0 1\nv 4 0 0\nv 4 0 4\nv 2 0 1\nv 0 0 4\nv 1e3 2.5E-1 -.5\no ROOM_l\nf 1 2 3 \\\n4 5\nf 1 2 6\n",
        ),
        named(
            "free-form",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\ncstype bspline\ndeg 3\ncurv 0 1 1 2 3\nend\nf 1 2 3\n",
        ),
        named("windows", "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\no T\u{fc}r\r\nf 1 2 3\r\n"),
        named("colours", "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nusemtl \"a b\"\nf 1 2 3\n"),
    ];
    for object in ["Column west", "Entrance step"] {
        seeds.push((format!("house-{object}"), house_object(object)));
    }
    seeds
}

/// The lines of one object of the generated house, its corners counted from its own first vertex.
fn house_object(name: &str) -> Vec<u8> {
    let house = std::fs::read_to_string(fixture("house.obj")).expect("the fixture is text");
    let (mut before, mut is_in, mut out) = (0i64, false, String::new());
    for line in house.lines() {
        if line.starts_with("o ") {
            is_in = line.contains(name);
        }
        match (is_in, line.strip_prefix("f ")) {
            (true, Some(corners)) => {
                let corner = |c: &str| (c.parse::<i64>().expect("a corner") - before).to_string();
                let corners: Vec<String> = corners.split(' ').map(corner).collect();
                out += &format!("f {}\n", corners.join(" "));
            }
            (true, None) => out += &format!("{line}\n"),
            (false, _) => before += i64::from(line.starts_with("v ")),
        }
        // Objects behind the one that was sought are not counted in its corners.
        if !is_in && !out.is_empty() {
            break;
        }
    }
    out.into_bytes()
}

/// Models for the comparison with the truth: closed and open, overlapping, nested, turned and flat.
pub fn truth() -> Seeds {
    let text = |lines: &[&str]| lines.join("\n") + "\n";
    const POINTS: &str = "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 0 0 3\nv 3 0 3\nv 3 3 3\nv 0 3 3\nv 1 1 1\nv 2 1 1\n\
                          v 1 2 1\nv 1 1 2\nv 5 1 1";
    const CUBE: &str = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8";
    const PYRAMID: &str = "f 9 11 10\nf 9 10 12\nf 10 11 12\nf 11 9 12";
    const LONG: &str = "f 9 11 13\nf 9 13 12\nf 13 11 12\nf 11 9 12";
    vec![
        named("solid", text(&[POINTS, "o W", CUBE])),
        named("cavity", text(&[POINTS, "o W", CUBE, PYRAMID])),
        named("overlap", text(&[POINTS, "o W1", CUBE, "o W2", LONG])),
        named("room", text(&[POINTS, "o R", CUBE, "o F", PYRAMID, "o x", "f 1 2 7"])),
        named("open", text(&[POINTS, "o W", "f 1 4 3 2\nf 1 2 6 5", "o x", "f 9 10 13\nf 1 7 4"])),
    ]
}

/// Rules files: every key, both kinds of conditions, and the head of the shipped table.
pub fn rules() -> Seeds {
    const KEYS: &str = "# every key\n[[rule]]\nname = '(?i)terrace|T\u{fc}r'\nother_name = '^a.*b$'\n\
        class = '^(IfcWall|IfcSlab)$'\nmaterial = '(?ix) ^ ( glass | glas )'\nfilling = '.'\npath = '^Site/(trees|cars)/'\n\
        storey = '^Level [0-9]+$'\nid = '\\A[^\\pL]{1,22}\\z'\nextras.predefined_type = 'FLOOR'\nsemantic = 'GROUND'\n\
        [[rule]]\n[rule.extras]\n'a key' = \"x\\u00e9\"\n[[rule]]\nsemantic = \"unknown\"\n";
    let shipped = Rules::shipped_text();
    let cut = shipped.match_indices("[[rule]]").nth(6).map_or(shipped.len(), |(at, _)| at);
    vec![
        named("keys", KEYS),
        named("catch-all", "[[rule]]\nsemantic = 'WALL'\n"),
        named(
            "inline",
            "rule = [{ name = '''a''', semantic = 'ROOM' }, { class = '^A$', semantic = 'DOOR' }]\n",
        ),
        named("shipped", &shipped[..cut]),
    ]
}

/// Scenes: parts of the generated house.
pub fn enf() -> Seeds {
    let house = import(&fixture("house.glb"), &ImportOptions::default()).expect("the fixture is a model");
    let scene = |name: &str, cells: bool, topology: bool, wanted: &[(Semantic, usize)]| {
        let mut part = house.clone();
        let mut kept = Vec::new();
        for &(semantic, count) in wanted {
            kept.extend(
                house.elements.iter().filter(|e| e.semantic == semantic).take(count).map(|e| e.id.clone()),
            );
        }
        part.elements.retain(|e| kept.contains(&e.id));
        part.materials.truncate(28);
        // Neither names what is not there, nor lights and cameras beyond two.
        part.lights.truncate(2);
        part.cameras.truncate(2);
        let mut options = CompileOptions::default();
        (options.cells, options.topology) = (cells, topology);
        // Of one, even sections as short as these are packed.
        if name == "room" {
            options.pack_from = 0;
        }
        let compiled = compile(&part, &options).expect("a part of the house compiles");
        (name.to_owned(), compiled.bytes)
    };
    vec![
        scene("column", true, false, &[(Semantic::Column, 1)]),
        scene("room", true, false, &[(Semantic::Room, 1), (Semantic::Column, 2)]),
        scene("door", false, false, &[(Semantic::Door, 1), (Semantic::Ground, 1)]),
        scene(
            "glass",
            true,
            false,
            &[(Semantic::Glass, 1), (Semantic::Window, 1), (Semantic::WindowFrame, 1)],
        ),
        scene("map", true, true, &[(Semantic::Window, 1)]),
        scene("hole", true, false, &[(Semantic::Door, 1), (Semantic::Wall, 1)]),
    ]
}

#[cfg(test)]
mod tests {
    use enfilade::Scene;
    use enfilade::importers::{Limits, gltf as reader, obj as obj_reader};

    use super::*;
    use crate::obj::split;
    use crate::{FILE, options};

    #[test]
    fn every_seed_is_taken() {
        for (name, file) in gltf() {
            let read = reader::read_slice(&file, FILE, &options());
            assert!(read.is_ok(), "{name}: {}", read.unwrap_err());
        }
        for (name, file) in obj() {
            let read = obj_reader::read_text(split(&file).0, FILE, None, &options());
            assert!(read.is_ok(), "{name}: {}", read.unwrap_err());
        }
        for (name, file) in enf() {
            assert!(Scene::from_bytes(&file).is_ok(), "{name}");
        }
        let refused = rules()
            .iter()
            .filter(|(_, r)| Rules::parse(std::str::from_utf8(r).unwrap(), FILE).is_err())
            .count();
        assert_eq!(refused, 1, "a rule without a meaning");
    }

    #[test]
    fn every_seed_passes_its_target() {
        for (target, seeds) in all() {
            assert!(!seeds.is_empty());
            for (name, seed) in seeds {
                println!("{target} {name}: {} bytes", seed.len());
                match target {
                    "gltf" => crate::glb::check(&seed),
                    "obj" => crate::obj::check(&seed),
                    "truth" => crate::truth::check(&seed),
                    "rules" => crate::rules::check(&seed),
                    _ => crate::enf::check(&seed),
                }
                assert!(seed.len() < 60_000, "{target} {name}: {} bytes", seed.len());
            }
        }
    }

    #[test]
    fn the_picture_is_one() {
        let mut options = options();
        options.limits = Limits::default();
        let model = reader::read_slice(&gltf()[0].1, FILE, &options).unwrap();
        assert!(model.warnings.is_empty(), "{:?}", model.warnings);
        assert_eq!(base64(b"any carnal pleas"), "YW55IGNhcm5hbCBwbGVhcw==");
    }
}
