//! The glTF reader on real buildings, against values computed from the same files by other means.
//!
//! Reads the folder named by `ENFILADE_BUILDINGS`; without it these tests are skipped.
#![cfg(feature = "gltf")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Instant;

use enfilade_importers::{ImportOptions, Model, gltf};
use serde_json::Value;

/// The folder of real buildings, if there is one.
fn folder() -> Option<PathBuf> {
    match std::env::var_os("ENFILADE_BUILDINGS") {
        Some(folder) => Some(folder.into()),
        None => {
            println!("SKIPPED: ENFILADE_BUILDINGS is not set");
            None
        }
    }
}

fn glbs(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("ENFILADE_BUILDINGS is a folder");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "glb"));
    paths.sort();
    assert!(!paths.is_empty(), "no .glb in {}", folder.display());
    paths
}

fn read(path: &Path) -> Model {
    gltf::read(path, &ImportOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The JSON of a `.glb`, cut out by hand.
fn json_of(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    assert_eq!(&bytes[16..20], b"JSON");
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

/// Triangles of a mesh by its accessors' counts. All files here use mode 4.
fn triangles_of(json: &Value, mesh: &Value) -> u64 {
    let primitives = json["meshes"][mesh.as_u64().unwrap() as usize]["primitives"].as_array().unwrap();
    primitives
        .iter()
        .map(|primitive| {
            assert_eq!(primitive.get("mode").map_or(Some(4), Value::as_u64), Some(4));
            let accessor = primitive.get("indices").unwrap_or(&primitive["attributes"]["POSITION"]);
            json["accessors"][accessor.as_u64().unwrap() as usize]["count"].as_u64().unwrap() / 3
        })
        .sum()
}

/// Corners of all triangles of an element, in glTF's axes, metres.
fn corners(model: &Model, element: usize) -> impl Iterator<Item = [f64; 3]> {
    let mesh = &model.elements[element].mesh;
    (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)).map(|p| model.frame.point_to_source(p))
}

#[test]
fn elements_triangles_and_names_agree_with_the_json() {
    let Some(folder) = folder() else { return };
    for path in glbs(&folder) {
        let (json, model) = (json_of(&path), read(&path));
        let nodes: Vec<(usize, &Value)> = json["nodes"].as_array().unwrap().iter().enumerate().collect();
        let nodes: Vec<_> = nodes.into_iter().filter(|(_, node)| node.get("mesh").is_some()).collect();
        assert_eq!(model.elements.len(), nodes.len(), "{}", path.display());
        let expected: u64 = nodes.iter().map(|(_, node)| triangles_of(&json, &node["mesh"])).sum();
        let left_out: u64 = model.left_out.iter().filter(|l| l.reason.is_triangles()).map(|l| l.count).sum();
        assert_eq!(model.triangles_read, expected, "{}", path.display());
        assert_eq!(model.triangle_count() + left_out, expected, "{}", path.display());

        let mut ids = BTreeSet::new();
        for (element, (index, node)) in model.elements.iter().zip(nodes) {
            let extras = &node["extras"];
            let text = |key: &str| extras[key].as_str().filter(|s| !s.is_empty());
            assert_eq!(element.place, format!("nodes[{index}]"));
            let id = text("global_id").unwrap();
            let doubled = element.id.strip_prefix(id).is_some_and(|rest| rest.starts_with('~'));
            assert!(element.id == id || doubled && ids.contains(id), "{} for {id}", element.id);
            ids.insert(id);
            assert_eq!(element.source_name, node["name"].as_str().unwrap());
            assert_eq!(element.class.as_deref(), text("ifc_class"));
            assert_eq!(element.storey.as_deref(), text("storey"));
            assert_eq!(element.host.as_deref(), text("host_id"));
            assert_eq!(element.extras.len(), extras.as_object().unwrap().len());
            if let Some(name) = text("name") {
                assert_eq!(element.name, name);
            }
        }
        let again = read(&path);
        assert!(again == model, "{} is read differently the second time", path.display());
    }
}

#[test]
fn each_element_lies_in_the_box_that_its_accessors_state() {
    let Some(folder) = folder() else { return };
    for path in glbs(&folder) {
        let (json, model) = (json_of(&path), read(&path));
        if json["nodes"].as_array().unwrap().iter().any(|node| node.get("children").is_some()) {
            continue; // moved: the next test's
        }
        for (index, element) in model.elements.iter().enumerate() {
            let node = element.place.trim_start_matches("nodes[").trim_end_matches(']');
            let mesh = &json["nodes"][node.parse::<usize>().unwrap()]["mesh"];
            let mut stated = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
            let mut actual = stated;
            for primitive in json["meshes"][mesh.as_u64().unwrap() as usize]["primitives"].as_array().unwrap()
            {
                let position = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
                for axis in 0..3 {
                    let bound = |which: &str| json["accessors"][position][which][axis].as_f64().unwrap();
                    stated[0][axis] = stated[0][axis].min(bound("min"));
                    stated[1][axis] = stated[1][axis].max(bound("max"));
                }
            }
            for corner in corners(&model, index) {
                for axis in 0..3 {
                    actual[0][axis] = actual[0][axis].min(corner[axis]);
                    actual[1][axis] = actual[1][axis].max(corner[axis]);
                }
            }
            // Vertices that only degenerate triangles use may be missing from the actual box.
            for axis in 0..3 {
                assert!(
                    actual[0][axis] >= stated[0][axis] && actual[1][axis] <= stated[1][axis],
                    "{}",
                    element.id
                );
            }
            let degenerate = model.left_out.iter().any(|l| l.element.is_some_and(|e| e.0 as usize == index));
            assert!(degenerate || actual == stated, "{}: {actual:?} {stated:?}", element.id);
        }
    }
}

#[test]
fn a_georeferenced_model_is_the_plain_one_moved() {
    let Some(folder) = folder() else { return };
    let geos: Vec<PathBuf> =
        glbs(&folder).into_iter().filter(|p| p.to_string_lossy().ends_with(".geo.glb")).collect();
    assert!(!geos.is_empty());
    for path in geos {
        let plain = read(Path::new(&path.to_string_lossy().replace(".geo.glb", ".glb")));
        let (json, moved) = (json_of(&path), read(&path));
        let root =
            json["nodes"].as_array().unwrap().iter().find(|node| node.get("children").is_some()).unwrap();
        let numbers = |key: &str| -> Vec<f64> {
            root[key].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        let (t, q) = (numbers("translation"), numbers("rotation"));
        // The rotation undone: by the conjugate, in the form v + 2w(u x v) + 2u x (u x v).
        let undo = |p: [f64; 3]| {
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            };
            let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
            let u = [-q[0] / length, -q[1] / length, -q[2] / length];
            let v = [p[0] - t[0], p[1] - t[1], p[2] - t[2]];
            let once = cross(u, v);
            let twice = cross(u, once);
            [0, 1, 2].map(|i| v[i] + 2.0 * (q[3] / length * once[i] + twice[i]))
        };
        assert!(moved.frame.has_offset() && !plain.frame.has_offset());
        assert_eq!(moved.elements.len(), plain.elements.len());
        let by_id: BTreeMap<&str, usize> =
            plain.elements.iter().enumerate().map(|(index, element)| (element.id.as_str(), index)).collect();
        let mut worst = 0.0f64;
        for (index, element) in moved.elements.iter().enumerate() {
            let twin = by_id[element.id.as_str()];
            assert_eq!(element.mesh.materials, plain.elements[twin].mesh.materials);
            assert_eq!(element.mesh.triangles.len(), plain.elements[twin].mesh.triangles.len());
            for (a, b) in corners(&moved, index).zip(corners(&plain, twin)) {
                worst = undo(a).iter().zip(b).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
            }
        }
        println!("{}: worst corner {worst:e} m", path.display());
        assert!(worst < 1e-6, "{worst}");
    }
}

#[test]
fn an_unwelded_model_has_the_same_geometry() {
    let Some(folder) = folder() else { return };
    let splits: Vec<PathBuf> =
        glbs(&folder).into_iter().filter(|p| p.to_string_lossy().ends_with(".split.glb")).collect();
    assert!(!splits.is_empty());
    for path in splits {
        let welded = read(Path::new(&path.to_string_lossy().replace(".split.glb", ".glb")));
        let split = read(&path);
        assert_eq!(split.materials, welded.materials);
        assert_eq!(split.elements.len(), welded.elements.len());
        for (a, b) in split.elements.iter().zip(&welded.elements) {
            assert_eq!((&a.id, &a.mesh), (&b.id, &b.mesh));
        }
    }
}

#[test]
fn reading_is_quick() {
    let Some(folder) = folder() else { return };
    for path in glbs(&folder) {
        let start = Instant::now();
        let triangles = read(&path).triangle_count();
        let took = start.elapsed();
        println!("{}: {triangles} triangles in {took:?}", path.display());
        // An order of magnitude over what it takes: quadratic loops do not fit.
        assert!(took.as_secs_f64() < 2.0, "{took:?}");
    }
}
