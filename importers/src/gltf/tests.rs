//! One test for each behaviour of the reader as a whole.

use serde_json::json;

use super::testing::{GltfText, TRIANGLE, read, triangles};
use crate::error::ImportErrorKind;
use crate::frame::UpAxis;
use crate::import::ImportOptions;
use crate::limits::Limits;
use crate::model::LeftOutReason;
use crate::watch::{CancelToken, Watch};

const STRIP: u32 = 5;
const FAN: u32 = 6;

/// Five corners of a convex polygon, counter-clockwise.
const PENTAGON: [[f32; 3]; 5] =
    [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [-1.0, 1.0, 0.0]];

/// A strip of four triangles over two rows of points.
const ROWS: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [1.0, -1.0, 0.0], [2.0, 0.0, 0.0], [2.0, -1.0, 0.0]];

/// Twice the signed area of a triangle in the plane z = 0.
fn doubled_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn error_of(text: &GltfText) -> crate::ImportError {
    let error = read(text).unwrap_err();
    assert!(error.to_string().starts_with("test.gltf: "), "{error}");
    error
}

#[test]
fn strips_alternate_their_winding() {
    let model = read(&GltfText::primitive(STRIP, &ROWS, None)).unwrap();
    let areas: Vec<f64> = triangles(&model, 0).into_iter().map(doubled_area).collect();
    assert_eq!(areas, [1.0; 4]);
    let first_two = [
        [[0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
        [[0.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
    ];
    assert_eq!(triangles(&model, 0)[..2], first_two);
}

#[test]
fn fans_keep_their_winding() {
    let model = read(&GltfText::primitive(FAN, &PENTAGON, Some(&[0, 1, 2, 3, 4]))).unwrap();
    let areas: Vec<f64> = triangles(&model, 0).into_iter().map(doubled_area).collect();
    assert_eq!(areas.len(), 3);
    assert!(areas.iter().all(|area| *area > 0.0));
    assert_eq!(areas.iter().sum::<f64>(), 14.0);
}

#[test]
fn strips_may_turn_around_in_degenerate_triangles() {
    // 0 1 2 2 3 3 4 5: the four between are counted and left out.
    let model = read(&GltfText::primitive(STRIP, &ROWS, Some(&[0, 1, 2, 2, 3, 3, 4, 5]))).unwrap();
    assert_eq!(model.triangle_count(), 2);
    assert_eq!(model.triangles_read, 6);
    assert_eq!((model.left_out[0].reason, model.left_out[0].count), (LeftOutReason::Degenerate, 4));
}

#[test]
fn indices_of_8_16_and_32_bits_are_the_same() {
    let expected = triangles(&read(&GltfText::primitive(4, &ROWS, Some(&[0, 1, 2, 2, 3, 4]))).unwrap(), 0);
    assert_eq!(expected.len(), 2);
    for (component, bytes) in [
        (5121, vec![0u8, 1, 2, 2, 3, 4]),
        (5123, [0u16, 1, 2, 2, 3, 4].iter().flat_map(|i| i.to_le_bytes()).collect()),
    ] {
        let mut text = GltfText::empty();
        let positions = text.floats(&ROWS);
        let indices = text.accessor(&bytes, component, "SCALAR", 6);
        text.mesh(json!([{ "attributes": { "POSITION": positions }, "indices": indices }]));
        text.json["nodes"][0]["mesh"] = json!(0);
        assert_eq!(triangles(&read(&text).unwrap(), 0), expected);
    }
}

#[test]
fn left_over_indices_are_warned_about() {
    let model = read(&GltfText::primitive(4, &ROWS, Some(&[0, 1, 2, 3, 4]))).unwrap();
    assert_eq!(model.triangle_count(), 1);
    assert_eq!(model.warnings[0].place, "meshes[0].primitives[0]");
    assert!(model.warnings[0].text.contains("last 2"));
}

#[test]
fn sparse_accessors_replace_points() {
    for with_base in [true, false] {
        let mut text = GltfText::triangle();
        let indices = text.view(&[1, 0, 2, 0]);
        let values: Vec<u8> =
            [5.0f32, 0.0, 0.0, 0.0, 7.0, 0.0].iter().flat_map(|c| c.to_le_bytes()).collect();
        let values = text.view(&values);
        text.json["accessors"][0]["sparse"] = json!({
            "count": 2,
            "indices": { "bufferView": indices, "componentType": 5123 },
            "values": { "bufferView": values }
        });
        if !with_base {
            text.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }
        let model = read(&text).unwrap();
        let expected = [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 7.0, 0.0]];
        assert_eq!(triangles(&model, 0), [expected]);
    }
}

#[test]
fn quantized_points_are_read_as_they_are_or_normalized() {
    let cases: [(u32, Vec<u8>, f64); 4] = [
        (
            5120,
            [[0i8, 0, 0], [127, 0, 0], [0, -127, 0]]
                .iter()
                .flat_map(|p| [p[0] as u8, p[1] as u8, p[2] as u8, 0])
                .collect(),
            127.0,
        ),
        (
            5121,
            [[0u8, 0, 0], [255, 0, 0], [0, 255, 0]].iter().flat_map(|p| [p[0], p[1], p[2], 0]).collect(),
            255.0,
        ),
        (5122, points16(&[[0, 0, 0], [32767, 0, 0], [0, -32767, 0]]), 32767.0),
        (5123, points16(&[[0, 0, 0], [-1, 0, 0], [0, -1, 0]]), 65535.0),
    ];
    for (component, bytes, largest) in cases {
        for normalized in [false, true] {
            let mut text = GltfText::empty();
            let positions = text.accessor(&bytes, component, "VEC3", 3);
            text.json["bufferViews"][0]["byteStride"] = json!(bytes.len() / 3);
            text.json["accessors"][0]["normalized"] = json!(normalized);
            text.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            text.mesh(json!([{ "attributes": { "POSITION": positions } }]));
            text.json["nodes"][0]["mesh"] = json!(0);
            let model = read(&text).unwrap();
            let unit = if normalized { 1.0 } else { largest };
            let y = if matches!(component, 5120 | 5122) { -unit } else { unit };
            assert_eq!(triangles(&model, 0), [[[0.0, 0.0, 0.0], [unit, 0.0, 0.0], [0.0, y, 0.0]]]);
        }
    }
}

/// Points of 16-bit components, padded to 8 bytes.
fn points16(points: &[[i16; 3]]) -> Vec<u8> {
    points.iter().flat_map(|p| [p[0], p[1], p[2], 0]).flat_map(i16::to_le_bytes).collect()
}

#[test]
fn interleaved_points_follow_their_stride() {
    let mut text = GltfText::empty();
    let floats: Vec<f32> = TRIANGLE.iter().flat_map(|p| [9.0, p[0], p[1], p[2], 9.0]).collect();
    let bytes: Vec<u8> = floats.iter().flat_map(|c| c.to_le_bytes()).collect();
    let positions = text.accessor(&bytes, 5126, "VEC3", 3);
    text.json["bufferViews"][0]["byteStride"] = json!(20);
    text.json["accessors"][0]["byteOffset"] = json!(4);
    text.mesh(json!([{ "attributes": { "POSITION": positions } }]));
    text.json["nodes"][0]["mesh"] = json!(0);
    assert_eq!(triangles(&read(&text).unwrap(), 0), triangles(&read(&GltfText::triangle()).unwrap(), 0));
}

#[test]
fn negative_scales_turn_triangles_over() {
    let front = |scale: serde_json::Value| {
        let mut text = GltfText::triangle();
        text.json["nodes"][0]["scale"] = scale;
        doubled_area(triangles(&read(&text).unwrap(), 0)[0]).signum()
    };
    // Seen from +z the mirrored triangle lies elsewhere, but still shows its front.
    assert_eq!(front(json!([-2, 1, 1])), 1.0);
    assert_eq!(front(json!([1, -1, 1])), 1.0);
    // Turned by half a turn about z: no mirror.
    assert_eq!(front(json!([-1, -1, 1])), 1.0);
    // Mirrored through the plane that it lies in: it shows its back.
    assert_eq!(front(json!([1, 1, -1])), -1.0);
}

#[test]
fn nodes_on_one_mesh_are_elements_of_their_own() {
    let mut text = GltfText::triangle();
    text.json["nodes"] = json!([
        { "name": "Stuhl", "mesh": 0 },
        { "name": "Stuhl", "mesh": 0, "translation": [10, 0, 0] },
        { "name": "Tisch", "mesh": 0, "translation": [0, 5, 0] }
    ]);
    text.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    text.json["meshes"][0]["name"] = json!("chair");
    let model = read(&text).unwrap();
    let ids: Vec<&str> = model.elements.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["Stuhl", "Stuhl[2]", "Tisch"]);
    assert_eq!(triangles(&model, 1)[0][0], [10.0, 0.0, 0.0]);
    assert_eq!(triangles(&model, 2)[0][0], [0.0, 5.0, 0.0]);
    assert!(model.elements.iter().all(|e| e.other_names == ["chair"]));
}

#[test]
fn instances_are_elements_with_a_number() {
    let mut text = GltfText::triangle();
    let translations = text.floats(&[[0.0; 3], [5.0, 0.0, 0.0]]);
    let scales = text.floats(&[[1.0; 3], [-2.0, 2.0, 2.0]]);
    let half = (32767.0 * 0.5f64.sqrt()).round() as i16;
    let rotations = [0, 0, 0, 32767, 0, 0, half, half].map(i16::to_le_bytes);
    let rotations = text.accessor(rotations.as_flattened(), 5122, "VEC4", 2);
    text.json["accessors"][rotations]["normalized"] = json!(true);
    let attributes = json!({ "TRANSLATION": translations, "SCALE": scales, "ROTATION": rotations });
    text.json["nodes"][0] = json!({
        "name": "Baum", "mesh": 0, "translation": [0, 0, 100], "extras": { "global_id": "g" },
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } }
    });
    text.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let model = read(&text).unwrap();
    let ids: Vec<(&str, &str)> = model.elements.iter().map(|e| (e.id.as_str(), e.path.as_str())).collect();
    assert_eq!(ids, [("g[1]", "Baum[1]"), ("g[2]", "Baum[2]")]);
    assert_eq!(model.elements[1].place, "nodes[0] instance 2");
    assert_eq!(triangles(&model, 0)[0], [[0.0, 0.0, 100.0], [1.0, 0.0, 100.0], [0.0, 1.0, 100.0]]);
    // Mirrored, doubled, turned by a quarter: x to -x to -y; y to y to -x. Turned over for the mirror.
    let expected = [[5.0, 0.0, 100.0], [3.0, 0.0, 100.0], [5.0, -2.0, 100.0]];
    for (corner, expected) in triangles(&model, 1)[0].iter().zip(expected) {
        assert!(corner.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{corner:?}");
    }

    text.json["accessors"][translations]["count"] = json!(1);
    let error = error_of(&text);
    assert_eq!(error.place, "nodes[0].extensions.EXT_mesh_gpu_instancing");
}

#[test]
fn far_translations_are_exact() {
    let mut text = GltfText::triangle();
    text.json["nodes"][0]["translation"] = json!([458123.625, 112.5, -5427891.375]);
    let model = read(&text).unwrap();
    assert_eq!(model.frame.up, UpAxis::Y);
    assert!(model.frame.has_offset());
    let expected = TRIANGLE.map(|p| [f64::from(p[0]) + 458123.625, f64::from(p[1]) + 112.5, -5427891.375]);
    assert_eq!(triangles(&model, 0), [expected]);
    // f32 would have rounded to half metres; and parents compose in f64 too.
    text.json["nodes"] = json!([
        { "translation": [458000.0, 0, -5427000.0], "children": [1] },
        { "translation": [123.625, 112.5, -891.375], "mesh": 0, "name": "a" }
    ]);
    assert_eq!(triangles(&read(&text).unwrap(), 0), [expected]);
}

#[test]
fn matrix_and_parts_give_the_same_model() {
    let mut parts = GltfText::triangle();
    parts.json["nodes"][0]["rotation"] = json!([0, 1, 0, 0]);
    parts.json["nodes"][0]["translation"] = json!([1, 2, 3]);
    parts.json["nodes"][0]["scale"] = json!([2, 3, 4]);
    let mut matrix = GltfText::triangle();
    matrix.json["nodes"][0]["matrix"] = json!([-2, 0, 0, 0, 0, 3, 0, 0, 0, 0, -4, 0, 1, 2, 3, 1]);
    let (parts, matrix) = (read(&parts).unwrap(), read(&matrix).unwrap());
    assert_eq!(triangles(&parts, 0), triangles(&matrix, 0));
}

#[test]
fn data_uri_external_file_and_glb_give_the_same_model() {
    let mut text = GltfText::primitive(STRIP, &ROWS, None);
    text.json["nodes"][0]["extras"] = json!({ "ifc_class": "IfcSlab", "storey": "EG" });
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("data.gltf", text.embedded()),
        ("external.gltf", text.external("sub%20folder/B%C3%BCro.bin")),
        ("binary.glb", text.glb()),
        ("binary.gltf", text.glb()),
    ];
    std::fs::create_dir(folder.path().join("sub folder")).unwrap();
    std::fs::write(folder.path().join("sub folder/Büro.bin"), &text.bin).unwrap();
    let models = files.map(|(name, bytes)| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let mut model = super::read(&path, &ImportOptions::default()).unwrap();
        assert_eq!(model.source, name);
        assert_ne!(model.source_hash, 0);
        model.source.clear();
        model.source_hash = 0;
        model
    });
    assert_eq!(models[0].triangle_count(), 4);
    assert!(models.iter().all(|model| *model == models[0]));
}

#[test]
fn the_hash_covers_external_buffers() {
    let mut text = GltfText::triangle();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text.external("a.bin")).unwrap();
    let mut hash = |last: u8| {
        *text.bin.last_mut().unwrap() = last;
        std::fs::write(folder.path().join("a.bin"), &text.bin).unwrap();
        super::read(&path, &ImportOptions::default()).unwrap().source_hash
    };
    let (a, b) = (hash(0), hash(0x40));
    assert_ne!(a, b);
    let mut both = std::fs::read(&path).unwrap();
    both.extend(std::fs::read(folder.path().join("a.bin")).unwrap());
    assert_eq!(twox_hash::XxHash3_64::oneshot(&both), b);
}

#[test]
fn missing_and_short_buffers_are_named() {
    let text = GltfText::triangle();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, text.external("gone.bin")).unwrap();
    let error = super::read(&path, &ImportOptions::default()).unwrap_err();
    assert_eq!((error.file.as_str(), error.place.as_str()), (path.to_str().unwrap(), "buffers[0].uri"));
    assert!(matches!(&error.kind, ImportErrorKind::Io(e) if e.to_string().contains("gone.bin")));

    std::fs::write(folder.path().join("gone.bin"), &text.bin[..35]).unwrap();
    let error = super::read(&path, &ImportOptions::default()).unwrap_err();
    assert_eq!(error.place, "buffers[0]");
    assert!(error.to_string().contains("byteLength is 36, but there are 35"), "{error}");
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_and_folders_are_refused() {
    let text = GltfText::triangle();
    let outer = tempfile::tempdir().unwrap();
    let inner = outer.path().join("model");
    std::fs::create_dir(&inner).unwrap();
    std::fs::write(outer.path().join("secret.bin"), &text.bin).unwrap();
    std::os::unix::fs::symlink("../secret.bin", inner.join("a.bin")).unwrap();
    std::os::unix::fs::symlink("real.bin", inner.join("link.bin")).unwrap();
    std::fs::write(inner.join("real.bin"), &text.bin).unwrap();
    let path = inner.join("a.gltf");
    let read = |uri: &str| {
        std::fs::write(&path, text.external(uri)).unwrap();
        super::read(&path, &ImportOptions::default())
    };
    assert!(matches!(read("a.bin").unwrap_err().kind, ImportErrorKind::LeavesFolder(uri) if uri == "a.bin"));
    assert!(matches!(read("../secret.bin").unwrap_err().kind, ImportErrorKind::LeavesFolder(_)));
    assert!(matches!(read("./sub/..").unwrap_err().kind, ImportErrorKind::Malformed(_)));
    // A link that stays inside is a file like any other.
    assert_eq!(read("link.bin").unwrap().triangle_count(), 1);
    std::fs::create_dir(inner.join("folder")).unwrap();
    assert!(matches!(read("folder").unwrap_err().kind, ImportErrorKind::Unsupported(_)));
}

#[test]
fn names_classes_and_metadata_become_an_element() {
    let mut text = GltfText::triangle();
    text.json["meshes"][0]["name"] = json!("IfcX:mesh");
    text.json["nodes"] = json!([
        {
            "name": "Haus", "children": [1],
            "extras": { "owner": "A", "phase": 1, "global_id": "h", "name": "House", "storey": "inherited" }
        },
        {
            "name": "IfcBuildingStorey:EG:1", "children": [2, 3, 4],
            "extras": { "owner": "B", "name": "Erdgeschoß" }
        },
        {
            "name": "IfcWall:Wand:Süd", "mesh": 0,
            "extras": {
                "global_id": "w", "host_id": "H", "filling_id": "F", "opening_id": "O", "load": 2.50, "owner": "C"
            }
        },
        { "name": "Fenster: 東", "mesh": 0, "extras": { "ifc_class": "IfcWindow", "storey": "1. OG", "name": "" } },
        { "mesh": 0, "extras": "no object" }
    ]);
    let model = read(&text).unwrap();
    let [wall, window, unnamed] = &model.elements[..] else { panic!("{}", model.elements.len()) };

    assert_eq!((wall.id.as_str(), wall.name.as_str()), ("w", "Wand:Süd"));
    assert_eq!((wall.source_name.as_str(), wall.class.as_deref()), ("IfcWall:Wand:Süd", Some("IfcWall")));
    assert_eq!(wall.path, "Haus/IfcBuildingStorey:EG:1/IfcWall:Wand:Süd");
    assert_eq!(wall.other_names, ["IfcX:mesh", "IfcBuildingStorey:EG:1", "Haus"]);
    assert_eq!(wall.place, "nodes[2]");
    assert_eq!(wall.storey.as_deref(), Some("Erdgeschoß"));
    let relations = [&wall.host, &wall.filling, &wall.opening].map(|id| id.as_deref());
    assert_eq!(relations, [Some("H"), Some("F"), Some("O")]);
    assert_eq!((wall.extras["load"].as_str(), wall.extras.len()), ("2.5", 6));
    let inherited: Vec<(&str, &str)> = wall.inherited.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
    assert_eq!(inherited, [("owner", "B"), ("phase", "1"), ("storey", "inherited")]);

    assert_eq!((window.name.as_str(), window.class.as_deref()), ("東", Some("IfcWindow")));
    assert_eq!(window.storey.as_deref(), Some("1. OG"));
    assert_eq!(unnamed.id, "Haus/IfcBuildingStorey:EG:1/node[4]");
    assert_eq!((unnamed.name.as_str(), unnamed.class.as_deref()), ("", Some("IfcX")));
    assert!(unnamed.extras.is_empty());
}

#[test]
fn the_storey_is_inherited_where_no_ancestor_is_one() {
    let mut text = GltfText::triangle();
    text.json["nodes"] =
        json!([{ "children": [1], "extras": { "storey": "UG" } }, { "children": [2] }, { "mesh": 0 }]);
    assert_eq!(read(&text).unwrap().elements[0].storey.as_deref(), Some("UG"));
}

#[test]
fn primitives_of_a_node_are_one_element_with_a_material_per_triangle() {
    let mut text = GltfText::empty();
    let a = text.floats(&TRIANGLE);
    let b = text.floats(&PENTAGON[2..]);
    text.mesh(json!([
        { "attributes": { "POSITION": a }, "material": 1 },
        { "attributes": { "POSITION": b } },
        { "attributes": { "POSITION": a }, "material": 0 }
    ]));
    text.json["materials"] = json!([{ "name": "m0" }, { "name": "m1" }]);
    text.json["nodes"][0]["mesh"] = json!(0);
    let model = read(&text).unwrap();
    let names: Vec<&str> = model.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["m0", "m1", ""]);
    let materials: Vec<u32> = model.elements[0].mesh.materials.iter().map(|m| m.0).collect();
    assert_eq!(materials, [1, 2, 0]);
}

#[test]
fn points_lines_and_hidden_nodes_are_counted() {
    let mut text = GltfText::empty();
    let five = text.floats(&PENTAGON);
    let triangle = text.floats(&TRIANGLE);
    let attributes = json!({ "POSITION": five });
    text.mesh(json!([
        { "attributes": attributes, "mode": 0 }, { "attributes": attributes, "mode": 1 },
        { "attributes": attributes, "mode": 2 }, { "attributes": attributes, "mode": 3 },
        { "attributes": { "POSITION": triangle } }
    ]));
    text.mesh(json!([{ "attributes": attributes, "mode": 6 }]));
    text.mesh(json!([{ "attributes": attributes, "mode": 3 }]));
    text.json["nodes"] =
        json!([{ "name": "a", "mesh": 0 }, { "mesh": 1 }, { "children": [1] }, { "name": "b", "mesh": 2 }]);
    text.json["scenes"][0]["nodes"] = json!([0, 3]);
    let model = read(&text).unwrap();
    assert_eq!(model.triangles_read, 4);
    let left_out: Vec<(Option<u32>, &str, LeftOutReason, u64)> = model
        .left_out
        .iter()
        .map(|l| (l.element.map(|e| e.0), l.place.as_str(), l.reason, l.count))
        .collect();
    let expected = [
        (Some(0), "nodes[0]", LeftOutReason::Points, 5),
        (Some(0), "nodes[0]", LeftOutReason::Lines, 2 + 5 + 4),
        (None, "nodes[3]", LeftOutReason::Lines, 4),
        (None, "nodes[1]", LeftOutReason::NotInScene, 3),
    ];
    assert_eq!(left_out, expected);
}

#[test]
fn indices_out_of_range_name_element_place_and_values() {
    let error = error_of(&GltfText::primitive(4, &TRIANGLE, Some(&[0, 1, 3])));
    assert_eq!(error.place, "meshes[0].primitives[0].indices");
    assert_eq!(error.element.as_deref(), Some("a"));
    let text = error.to_string();
    assert!(text.contains("index 3 (number 3)") && text.contains("3 vertices"), "{text}");
}

#[test]
fn points_that_are_not_finite_name_element_place_and_vertex() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut points = TRIANGLE;
        points[2][1] = value;
        let error = error_of(&GltfText::primitive(4, &points, Some(&[0, 1, 2])));
        assert_eq!(error.place, "meshes[0].primitives[0].attributes.POSITION");
        assert_eq!(error.element.as_deref(), Some("a"));
        assert!(matches!(error.kind, ImportErrorKind::NotFinite { vertex: 2, .. }), "{error}");
    }
}

#[test]
fn huge_counts_cost_nothing_before_they_are_refused() {
    let options = |megabytes: u64| ImportOptions {
        limits: Limits::default().with_max_memory(megabytes << 20),
        ..ImportOptions::default()
    };
    for count in [1u64 << 31, (1 << 32) - 1, 1 << 32, u64::MAX] {
        for bare in [true, false] {
            for attribute in ["POSITION", "indices"] {
                let mut text = GltfText::primitive(4, &TRIANGLE, Some(&[0, 1, 2]));
                let index = usize::from(attribute == "indices");
                text.json["accessors"][index]["count"] = json!(count);
                if bare {
                    text.json["accessors"][index].as_object_mut().unwrap().remove("bufferView");
                }
                if bare && attribute == "POSITION" && count < 1 << 32 {
                    // Legal: one triangle of zeros.
                    let error = super::read_slice(&text.embedded(), "x", &options(1)).unwrap_err();
                    assert!(matches!(error.kind, ImportErrorKind::Empty(_)), "{error}");
                    continue;
                }
                let error = super::read_slice(&text.embedded(), "x", &options(1)).unwrap_err();
                assert!(!error.place.is_empty(), "{error}");
            }
        }
    }
}

#[test]
fn many_instances_of_nothing_are_refused() {
    // Degenerate triangles take no memory: time must be bounded too.
    let mut text = GltfText::primitive(4, &TRIANGLE, Some(&[0; 30_000]));
    let zeros = json!({ "componentType": 5126, "type": "VEC3", "count": 4_000_000 });
    text.json["accessors"].as_array_mut().unwrap().push(zeros);
    text.json["nodes"][0]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } });
    let options =
        ImportOptions { limits: Limits::default().with_max_memory(1 << 28), ..ImportOptions::default() };
    let error = super::read_slice(&text.embedded(), "x", &options).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::OverBudget(_)), "{error}");
    text.json["accessors"][2]["count"] = json!(4_000_001);
    assert!(matches!(error_of(&text).kind, ImportErrorKind::TooManyElements(4_000_000)));
}

#[test]
fn meshes_that_share_an_accessor_read_it_once() {
    // 2,000 primitives on one accessor of 10,000 points: read each time, this would take 20 million points.
    let mut text = GltfText::empty();
    let points: Vec<[f32; 3]> = (0..10_000).map(|i| [i as f32, (i % 2) as f32, 0.0]).collect();
    let positions = text.floats(&points);
    for mesh in 0..2000u32 {
        let bytes: Vec<u8> = (0..3).flat_map(|i| (mesh * 5 + i).to_le_bytes()).collect();
        let indices = text.accessor(&bytes, 5125, "SCALAR", 3);
        text.mesh(json!([{ "attributes": { "POSITION": positions }, "indices": indices }]));
    }
    text.json["nodes"] = (0..2000).map(|mesh| json!({ "mesh": mesh })).collect();
    text.json["scenes"][0]["nodes"] = (0..2000).collect();
    // Room for one copy of the points, not for many.
    let limits = Limits::default().with_max_memory(16 << 20);
    let options = ImportOptions { limits, ..ImportOptions::default() };
    let model = super::read_slice(&text.embedded(), "x", &options).unwrap();
    assert_eq!(model.triangle_count(), 2000);
}

#[test]
fn compressed_primitives_are_named() {
    let mut text = GltfText::triangle();
    text.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    text.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": { "POSITION": 0 } } });
    let error = error_of(&text);
    assert!(
        matches!(&error.kind, ImportErrorKind::RequiredExtension(e) if e == "KHR_draco_mesh_compression")
    );
    assert_eq!(error.place, "meshes[0].primitives[0]");
}

#[test]
fn skins_and_morph_targets_are_warned_about() {
    let mut text = GltfText::triangle();
    text.json["nodes"][0]["skin"] = json!(0);
    text.json["skins"] = json!([{ "joints": [0] }]);
    text.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0 }]);
    text.json["animations"] = json!([{ "channels": [], "samplers": [] }]);
    let model = read(&text).unwrap();
    let places: Vec<&str> = model.warnings.iter().map(|w| w.place.as_str()).collect();
    assert_eq!(places, ["meshes[0]", "nodes[0]"]);
}

#[test]
fn files_without_triangles_say_so() {
    let mut text = GltfText::triangle();
    text.json["scenes"] = json!([{ "nodes": [] }]);
    assert!(matches!(error_of(&text).kind, ImportErrorKind::Empty(_)));
    assert!(matches!(error_of(&GltfText::empty()).kind, ImportErrorKind::Empty(_)));
}

#[test]
fn unit_and_axis_are_fixed() {
    let bytes = GltfText::triangle().embedded();
    let read =
        |unit, up| super::read_slice(&bytes, "x", &ImportOptions { unit, up, ..ImportOptions::default() });
    assert!(read(Some(1.0), Some(UpAxis::Y)).is_ok());
    assert!(matches!(read(Some(0.001), None).unwrap_err().kind, ImportErrorKind::Unsupported(_)));
    assert!(matches!(read(None, Some(UpAxis::Z)).unwrap_err().kind, ImportErrorKind::Unsupported(_)));
}

#[test]
fn a_cancelled_import_stops() {
    let cancel = CancelToken::new();
    cancel.cancel();
    let options = ImportOptions { watch: Watch::default().with_cancel(cancel), ..ImportOptions::default() };
    let error = super::read_slice(&GltfText::triangle().embedded(), "x", &options).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::Cancelled(_)));
}

/// A file whose nodes are given; those named in `with_mesh` have a triangle each, all of different places.
fn nodes_with_meshes(nodes: serde_json::Value, with_mesh: &[usize]) -> GltfText {
    let mut text = GltfText::empty();
    text.json["nodes"] = nodes;
    for &node in with_mesh {
        let positions = text.floats(&TRIANGLE.map(|[x, y, z]| [x, y, z + node as f32]));
        let mesh = text.mesh(json!([{ "attributes": { "POSITION": positions } }]));
        text.json["nodes"][node]["mesh"] = json!(mesh);
    }
    text
}

#[test]
fn nodes_without_identity_below_one_with_are_its_parts() {
    let text = nodes_with_meshes(
        json!([
            { "name": "IfcBuildingStorey:EG", "children": [1] },
            {
                "name": "IfcWindow:South",
                "extras": { "global_id": "w1", "ifc_class": "IfcWindow", "host_id": "wall" },
                "children": [2, 3, 5]
            },
            { "name": "IfcWindow:South_1" },
            { "name": "group", "children": [4] },
            { "name": "Glass:clear", "extras": { "opening_id": "hole", "host_id": "other" } },
            { "name": "IfcMember:Handle", "extras": { "global_id": "m1" } }
        ]),
        &[2, 4, 5],
    );
    let model = read(&text).unwrap();
    let found: Vec<_> = model.elements.iter().map(|e| (e.id.as_str(), e.mesh.triangles.len())).collect();
    assert_eq!(found, [("w1", 2), ("m1", 1)]);
    let window = &model.elements[0];
    assert_eq!(window.path, "IfcBuildingStorey:EG/IfcWindow:South");
    assert_eq!((window.name.as_str(), window.source_name.as_str()), ("South", "IfcWindow:South"));
    assert_eq!(window.place, "nodes[1]");
    assert_eq!((window.class.as_deref(), window.storey.as_deref()), (Some("IfcWindow"), Some("EG")));
    // What a part says counts where the element says nothing.
    assert_eq!((window.host.as_deref(), window.opening.as_deref()), (Some("wall"), Some("hole")));
    assert_eq!(window.extras["opening_id"], "hole");
    assert!(window.other_names.iter().any(|name| name == "Glass:clear"));
    assert_eq!(triangles(&model, 0).iter().map(|t| t[0][2]).collect::<Vec<_>>(), [2.0, 4.0]);
}

#[test]
fn parts_are_no_parts_of_what_holds_them() {
    let one_below = |above: serde_json::Value, below: &str| {
        let mut above = above;
        above["children"] = json!([1]);
        let model = read(&nodes_with_meshes(json!([above, { "name": below }]), &[1])).unwrap();
        model.elements[0].path == above["name"].as_str().unwrap()
    };
    let named =
        |name: &str, class: &str| json!({ "name": name, "extras": { "global_id": "g", "ifc_class": class } });
    assert!(one_below(named("wall", "IfcWall"), "brick"));
    assert!(one_below(json!({ "name": "IfcWall:a", "extras": { "global_id": "g" } }), "brick"));
    // Without an identity a node may be a group of walls.
    assert!(!one_below(json!({ "name": "walls", "extras": { "ifc_class": "IfcWall" } }), "brick"));
    assert!(!one_below(json!({ "name": "walls", "extras": { "global_id": "g" } }), "brick"));
    assert!(!one_below(named("ground floor", "IfcBuildingStorey"), "brick"));
    assert!(one_below(named("site", "IfcSite"), "site_1"));
    assert!(!one_below(named("site", "IfcSite"), "fence"));
    // A room has a mesh of its own, and things in it.
    assert!(one_below(named("Kitchen", "IfcSpace"), "Kitchen_1"));
    assert!(one_below(named("Kitchen", "IfcSpace"), ""));
    assert!(!one_below(named("Kitchen", "IfcSpace"), "Table"));
    assert!(!one_below(named("Kitchen", "IfcSpace"), "Kitchen table"));
    assert!(!one_below(named("1", "IfcSpace"), "101"));
    assert!(!one_below(named("bridge", "IfcBridge"), ""));
    // What has a class of its own is an element of its own.
    assert!(!one_below(named("stair", "IfcStair"), "IfcRailing:left"));
    assert!(one_below(named("stair", "IfcStair"), "IfcStair:left"));
    assert!(one_below(named("stair", "IFCSTAIR"), "IfcStair/left"));
    assert!(!one_below(named("wall", "IfcWall"), "IfcDoor.003"));
    assert!(!one_below(named("wall", "IfcWall"), "ifcdoor/left"));
}

#[test]
fn instances_and_damaged_parts_are_no_parts() {
    let nodes = json!([
        { "name": "wall", "extras": { "global_id": "g", "ifc_class": "IfcWall" }, "children": [1, 2] },
        { "name": "brick" },
        { "name": "empty" }
    ]);
    let mut text = nodes_with_meshes(nodes, &[1, 2]);
    let places = text.floats(&[[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]]);
    let mut copies = text.clone();
    copies.json["nodes"][1]["extensions"] =
        json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": places } } });
    copies.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let model = read(&copies).unwrap();
    let ids: Vec<&str> = model.elements.iter().map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["g", "wall/brick[1]", "wall/brick[2]"]);

    // A part of lines is left out, with its place; an error names the element.
    text.json["meshes"][1]["primitives"][0]["mode"] = json!(1);
    let model = read(&text).unwrap();
    assert_eq!(model.elements.len(), 1);
    assert_eq!((model.left_out[0].place.as_str(), model.left_out[0].count), ("nodes[2]", 1));
    assert_eq!(model.left_out[0].element, Some(crate::model::ElementId(0)));
    let far = text.floats(&[[0.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    text.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(far);
    assert_eq!(error_of(&text).element.as_deref(), Some("wall"));
}
