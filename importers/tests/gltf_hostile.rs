//! Damaged and hostile glTF files: each is an error that names file and place; none panics, hangs or takes memory
//! beyond the limit.
#![cfg(feature = "gltf")]

use enfilade_importers::{ImportError, ImportOptions, Limits, Model, gltf};
use enfilade_testing::wall::{self, bin};
use enfilade_testing::{Random, glb};
use serde_json::{Value, json};

const FILE: &str = "hostile.glb";

/// The most memory that a reader may take here.
const MEMORY: u64 = 64 << 20;

/// The good wall below a moved site, with an image, a light and what identifies it.
fn good() -> Value {
    let mut json = wall::json();
    json["nodes"][0]["translation"] = json!([1.0, 2.0, 3.0]);
    json["nodes"][1]["rotation"] = json!([0.0, 0.6, 0.0, 0.8]);
    json["nodes"][1]["extras"] = json!({ "global_id": "w" });
    json["nodes"][2]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
    json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
    json["textures"] = json!([{ "source": 0 }]);
    json["images"] = json!([{ "uri": "data:image/png;base64,iVBORw0KGgo=" }]);
    json
}

fn read(bytes: &[u8]) -> Result<Model, ImportError> {
    let limits = Limits::default().with_max_memory(MEMORY);
    // `ImportOptions` cannot be written as a literal outside its crate.
    let mut options = ImportOptions::default();
    options.limits = limits;
    gltf::read_slice(bytes, FILE, &options)
}

#[test]
fn the_good_file_is_good() {
    let model = read(&glb::of_json(&good(), &bin())).unwrap();
    assert_eq!((model.elements.len(), model.triangle_count()), (1, 4));
    assert_eq!((model.lights.len(), model.cameras.len()), (1, 1));
    assert_eq!(model.warnings.len(), 1, "the image is cut off: {:?}", model.warnings);
}

/// The good file with another value at a JSON pointer.
fn changed(pointer: &str, value: Value) -> Vec<u8> {
    glb::of_json(&wall::changed(good(), pointer, value), &bin())
}

/// The good file with other bytes in its binary chunk.
fn patched(offset: usize, bytes: &[u8]) -> Vec<u8> {
    glb::of_json(&good(), &wall::patched(offset, bytes))
}

#[test]
fn each_damage_is_an_error_that_names_file_and_place() {
    let whole = glb::of_json(&good(), &bin());
    let huge = 1u64 << 31;
    let zeros = |count: u64| json!({ "componentType": 5126, "type": "VEC3", "count": count });
    let instances = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 7 } } });
    let deep = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":{}", "[".repeat(200_000));
    let sparse = "/accessors/0/sparse";
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        // What it is, the bytes, and what the message must hold beside the file's name.
        ("empty", Vec::new(), "JSON line"),
        ("garbage", b"solid cube facet".to_vec(), "JSON line 1 column 1"),
        ("not UTF-8", b"{\"asset\":{\"version\":\"\xff\"}}".to_vec(), "JSON line 1"),
        ("truncated header", whole[..10].to_vec(), "GLB header"),
        ("truncated JSON", whole[..100].to_vec(), "GLB header"),
        (
            "JSON cut, lengths right",
            glb::of_text(&serde_json::to_vec(&good()).unwrap()[..200], &bin()),
            "JSON line",
        ),
        ("GLB version 1", [&whole[..4], &[1], &whole[5..]].concat(), "GLB header"),
        ("nested too deep", deep.into_bytes(), "JSON line"),
        ("root is no object", b"[]".to_vec(), "JSON line"),
        ("no asset", b"{}".to_vec(), "JSON line"),
        ("glTF 1.0", changed("/asset/version", json!("1.0")), "asset.version"),
        (
            "required extension",
            changed("/extensionsRequired", json!(["KHR_draco_mesh_compression"])),
            "KHR_draco_mesh_compression",
        ),
        ("scene out of range", changed("/scene", json!(1)), "scene"),
        ("scene's node out of range", changed("/scenes/0/nodes", json!([3])), "scenes[0].nodes[0]"),
        ("cyclic nodes", changed("/nodes/1/children", json!([0])), "nodes[0]"),
        ("two parents", changed("/nodes/1/children", json!([2])), "nodes[2]"),
        ("negative child", changed("/nodes/1/children", json!([-1])), "JSON line"),
        ("mesh out of range", changed("/nodes/1/mesh", json!(1)), "nodes[1].mesh"),
        ("mesh of 2^32", changed("/nodes/1/mesh", json!(1u64 << 32)), "JSON line"),
        ("zero quaternion", changed("/nodes/1/rotation", json!([0, 0, 0, 0])), "nodes[1]"),
        ("short quaternion", changed("/nodes/1/rotation", json!([0, 0, 1])), "JSON line"),
        (
            "projective matrix",
            changed("/nodes/1/matrix", json!([1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])),
            "nodes[1]",
        ),
        ("infinite translation", changed("/nodes/1/translation", json!([1e300, 0, 0])), "JSON line"),
        ("translation beyond the earth", changed("/nodes/1/translation", json!([1e20, 0, 0])), "nodes[1]"),
        (
            "POSITION out of range",
            changed("/meshes/0/primitives/0/attributes/POSITION", json!(9)),
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        (
            "indices out of range",
            changed("/meshes/0/primitives/0/indices", json!(9)),
            "meshes[0].primitives[0].indices",
        ),
        ("unknown mode", changed("/meshes/0/primitives/0/mode", json!(7)), "meshes[0].primitives[0].mode"),
        (
            "material out of range",
            changed("/meshes/0/primitives/0/material", json!(1)),
            "meshes[0].primitives[0].material",
        ),
        (
            "indices are points",
            changed("/meshes/0/primitives/0/indices", json!(0)),
            "meshes[0].primitives[0].indices",
        ),
        (
            "points are indices",
            changed("/meshes/0/primitives/0/attributes/POSITION", json!(1)),
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        (
            "float indices",
            changed("/accessors/1/componentType", json!(5126)),
            "meshes[0].primitives[0].indices",
        ),
        (
            "signed indices",
            changed("/accessors/1/componentType", json!(5122)),
            "meshes[0].primitives[0].indices",
        ),
        ("32-bit points", changed("/accessors/0/componentType", json!(5125)), "accessors[0]"),
        (
            "unknown component type",
            changed("/accessors/0/componentType", json!(5124)),
            "accessors[0].componentType",
        ),
        ("unknown type", changed("/accessors/0/type", json!("VEC9")), "accessors[0].type"),
        ("count over the view", changed("/accessors/0/count", json!(5)), "accessors[0]"),
        ("count of 2^31", changed("/accessors/0/count", json!(huge)), "accessors[0]"),
        (
            "count of 2^31 indices",
            changed("/accessors/1/count", json!(huge)),
            "meshes[0].primitives[0].indices",
        ),
        (
            "2^31 zeros as indices",
            changed("/accessors/1", json!({ "componentType": 5125, "type": "SCALAR", "count": huge })),
            "nodes[1]",
        ),
        ("2^31 zeros as points", changed("/accessors/0", zeros(huge)), "no triangles"),
        ("count of 2^64 - 1", changed("/accessors/0/count", json!(u64::MAX)), "accessors[0]"),
        ("negative count", changed("/accessors/0/count", json!(-4)), "JSON line"),
        ("offset over the view", changed("/accessors/0/byteOffset", json!(4)), "accessors[0]"),
        ("offset that overflows", changed("/accessors/0/byteOffset", json!(u64::MAX)), "accessors[0]"),
        (
            "stride under the size",
            changed("/bufferViews/0/byteStride", json!(4)),
            "bufferViews[0].byteStride",
        ),
        ("stride over the view", changed("/bufferViews/0/byteStride", json!(16)), "accessors[0]"),
        ("stride that overflows", changed("/bufferViews/0/byteStride", json!(u64::MAX)), "accessors[0]"),
        ("view over the buffer", changed("/bufferViews/0/byteLength", json!(101)), "bufferViews[0]"),
        ("view that overflows", changed("/bufferViews/0/byteOffset", json!(u64::MAX)), "bufferViews[0]"),
        ("view without buffer", changed("/bufferViews/0/buffer", json!(1)), "bufferViews[0].buffer"),
        ("buffer over the chunk", changed("/buffers/0/byteLength", json!(1000)), "buffers[0]"),
        ("buffer outside", changed("/buffers/0/uri", json!("../../x")), "buffers[0].uri"),
        ("buffer by http", changed("/buffers/0/uri", json!("http://x/y.bin")), "buffers[0].uri"),
        ("buffer is no base64", changed("/buffers/0/uri", json!("data:;base64,?")), "buffers[0].uri"),
        ("image outside", changed("/images/0/uri", json!("/etc/passwd")), "images[0].uri"),
        ("no sparse items", changed(&format!("{sparse}/count"), json!(0)), "accessors[0].sparse"),
        ("too many sparse items", changed(&format!("{sparse}/count"), json!(5)), "accessors[0].sparse"),
        (
            "sparse float indices",
            changed(&format!("{sparse}/indices/componentType"), json!(5126)),
            "accessors[0].sparse",
        ),
        (
            "sparse view out of range",
            changed(&format!("{sparse}/values/bufferView"), json!(4)),
            "accessors[0].sparse",
        ),
        (
            "sparse values too short",
            changed(&format!("{sparse}/values/byteOffset"), json!(8)),
            "accessors[0].sparse",
        ),
        ("sparse indices do not rise", patched(72, &[3, 0, 3, 0]), "accessors[0].sparse.indices"),
        ("sparse index out of range", patched(72, &[1, 0, 4, 0]), "accessors[0].sparse.indices"),
        ("vertex index out of range", patched(48, &[4, 0]), "meshes[0].primitives[0].indices"),
        ("NaN", patched(0, &f32::NAN.to_le_bytes()), "meshes[0].primitives[0].attributes.POSITION"),
        (
            "infinity",
            patched(80, &f32::INFINITY.to_le_bytes()),
            "meshes[0].primitives[0].attributes.POSITION",
        ),
        ("zero triangles", patched(48, &[0; 24]), "no triangles"),
        ("camera out of range", changed("/nodes/2/camera", json!(1)), "nodes[2].camera"),
        (
            "light out of range",
            changed("/nodes/2/extensions/KHR_lights_punctual/light", json!(1)),
            "nodes[2].extensions",
        ),
        (
            "instances without accessor",
            changed("/nodes/1/extensions", instances),
            "nodes[1].extensions.EXT_mesh_gpu_instancing",
        ),
    ];
    assert!(cases.len() >= 60);
    for (what, bytes, place) in cases {
        match read(&bytes) {
            Ok(_) => panic!("{what}: no error"),
            Err(error) => {
                let text = error.to_string();
                println!("{what}: {text}");
                assert!(text.starts_with(FILE), "{what}: {text}");
                assert!(text.contains(place), "{what}: {text}");
                assert!(text.len() < 400, "{what}: {text}");
            }
        }
    }
}

#[test]
fn many_instances_stop_at_the_limit() {
    let mut json = good();
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({ "componentType": 5126, "type": "VEC3", "count": 3_000_000 }));
    json["nodes"][1]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } });
    let error = read(&glb::of_json(&json, &bin())).unwrap_err();
    assert!(error.to_string().contains("--max-memory"), "{error}");
    assert_eq!(error.element.as_deref(), Some("IfcWall:W"));
}

#[test]
fn json_that_swells_is_refused_before_it_is_parsed() {
    let arrays = ["nodes", "materials", "meshes", "accessors", "textures", "images", "samplers", "scenes"];
    for array in arrays {
        let item = match array {
            "meshes" => r#"{"primitives":[]},"#,
            "accessors" => r#"{"componentType":5126,"type":"VEC3","count":0},"#,
            "scenes" => r#"{"nodes":[]},"#,
            _ => "{},",
        };
        let many = 12_000_000 / item.len();
        let items = item.repeat(many);
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"{array}":[{}]}}"#, items.trim_end_matches(','));
        let error = read(text.as_bytes()).unwrap_err();
        assert!(error.to_string().contains("the parsed JSON needs"), "{array}: {error}");
    }
}

/// What a model promises (see `Model`), whatever the file.
fn check(model: &Model) {
    assert!(model.triangle_count() > 0);
    for element in &model.elements {
        assert!(!element.id.is_empty());
        assert!(element.mesh.positions.iter().flatten().all(|c| c.is_finite()));
        assert!(
            element.mesh.triangles.iter().flatten().all(|v| (*v as usize) < element.mesh.positions.len())
        );
        assert!(element.mesh.materials.iter().all(|m| (m.0 as usize) < model.materials.len()));
    }
}

#[test]
fn random_damage_to_bytes_never_panics() {
    let good = glb::of_json(&good(), &bin());
    let mut random = Random::new(1);
    let mut read_well = 0;
    for _ in 0..20_000 {
        let mut bytes = good.clone();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            bytes[at] = random.below(256) as u8;
        }
        match read(&bytes) {
            Ok(model) => {
                read_well += 1;
                check(&model);
            }
            Err(error) => assert!(error.to_string().starts_with(FILE)),
        }
    }
    assert!(read_well > 100, "{read_well}");
}

#[test]
fn random_damage_to_values_never_panics() {
    let numbers = [
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(-1),
        json!(255),
        json!(5121),
        json!(5123),
        json!(65536),
        json!(1u64 << 31),
        json!(1u64 << 32),
        json!(u64::MAX),
        json!(0.5),
        json!(1e38),
        json!(null),
        json!([]),
        json!({}),
        json!(""),
        json!("MASK"),
        json!(true),
    ];
    let mut pointers = Vec::new();
    collect(&good(), String::new(), &mut pointers);
    let mut random = Random::new(2);
    let mut read_well = 0;
    for _ in 0..20_000 {
        let mut json = good();
        for _ in 0..=random.below(3) {
            let pointer = &pointers[random.below(pointers.len())];
            if let Some(value) = json.pointer_mut(pointer) {
                *value = numbers[random.below(numbers.len())].clone();
            }
        }
        match read(&glb::of_json(&json, &bin())) {
            Ok(model) => {
                read_well += 1;
                check(&model);
            }
            Err(error) => assert!(error.to_string().starts_with(FILE)),
        }
    }
    assert!(read_well > 100, "{read_well}");
}

/// Pointers to all values below `value`.
fn collect(value: &Value, pointer: String, pointers: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                collect(item, format!("{pointer}/{index}"), pointers);
            }
        }
        Value::Object(fields) => {
            for (key, item) in fields {
                collect(item, format!("{pointer}/{key}"), pointers);
            }
        }
        _ => {}
    }
    pointers.push(pointer);
}
