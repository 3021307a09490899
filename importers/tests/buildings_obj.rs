//! The OBJ reader on real buildings, in the folder that `ENFILADE_BUILDINGS` names, against an independent count.
#![cfg(feature = "obj")]

use std::collections::BTreeMap;
use std::path::PathBuf;

use enfilade_importers::{ImportOptions, Model, obj};

fn buildings() -> Option<Vec<PathBuf>> {
    let Some(folder) = std::env::var_os("ENFILADE_BUILDINGS") else {
        println!("SKIPPED: ENFILADE_BUILDINGS is not set");
        return None;
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "obj"))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "ENFILADE_BUILDINGS has no .obj files");
    Some(files)
}

/// What a line by line look at the text finds in an object.
#[derive(Debug, Default, PartialEq)]
struct Counted {
    class: Option<String>,
    triangles: usize,
    /// Triangles by material.
    looks: BTreeMap<String, usize>,
}

/// Objects by id, for files whose every `o` line is `Class:name#id`, once each, and whose faces are triangles.
fn count(text: &str) -> BTreeMap<String, Counted> {
    let mut objects: BTreeMap<String, Counted> = BTreeMap::new();
    let mut vertices: Vec<Vec<f64>> = Vec::new();
    let mut id = String::new();
    let mut material = String::new();
    for line in text.lines() {
        let (keyword, rest) = line.split_once(' ').unwrap_or((line, ""));
        match keyword {
            "o" => {
                id = rest.rsplit('#').next().unwrap().to_owned();
                let class = rest.split(':').next().map(str::to_owned);
                assert!(objects.insert(id.clone(), Counted { class, ..Counted::default() }).is_none());
            }
            "v" => vertices.push(rest.split(' ').map(|n| n.parse().unwrap()).collect()),
            "usemtl" => material = rest.to_owned(),
            "f" => {
                let corner = |word: &str| {
                    let index: usize = word.split('/').next().unwrap().parse().unwrap();
                    &vertices[index - 1]
                };
                let corners: Vec<_> = rest.split(' ').map(corner).collect();
                assert_eq!(corners.len(), 3);
                let d = |k: usize, i: usize| corners[k][i] - corners[0][i];
                let has_area = (0..3).any(|i| {
                    let (u, v) = ((i + 1) % 3, (i + 2) % 3);
                    d(1, u) * d(2, v) - d(1, v) * d(2, u) != 0.0
                });
                if has_area {
                    let object = objects.get_mut(&id).unwrap();
                    object.triangles += 1;
                    *object.looks.entry(material.clone()).or_default() += 1;
                }
            }
            _ => {}
        }
    }
    objects.retain(|_, o| o.triangles > 0);
    objects
}

fn found(model: &Model) -> BTreeMap<String, Counted> {
    let element = |e: &enfilade_importers::Element| {
        let mut looks = BTreeMap::new();
        for id in &e.mesh.materials {
            *looks.entry(model.materials[id.0 as usize].name.clone()).or_default() += 1;
        }
        (e.id.clone(), Counted { class: e.class.clone(), triangles: e.mesh.triangles.len(), looks })
    };
    model.elements.iter().map(element).collect()
}

#[test]
fn elements_classes_triangles_and_materials_agree_with_a_count() {
    let Some(files) = buildings() else { return };
    for path in files {
        let text = std::fs::read_to_string(&path).unwrap();
        let start = std::time::Instant::now();
        let model = obj::read(&path, &ImportOptions::default()).unwrap();
        println!("{}: {:?}, {} triangles", path.display(), start.elapsed(), model.triangle_count());
        let expected = count(&text);
        let actual = found(&model);
        assert_eq!(model.elements.len(), actual.len());
        for (id, expected) in &expected {
            assert_eq!(actual.get(id), Some(expected), "{} {id}", path.display());
        }
        assert_eq!(actual.len(), expected.len());
        assert_eq!(text.lines().filter(|l| l.starts_with("f ")).count() as u64, model.triangles_read);
        for element in &model.elements {
            let line: usize = element.place.strip_prefix("line ").unwrap().parse().unwrap();
            assert_eq!(text.lines().nth(line - 1), Some(format!("o {}", element.source_name).as_str()));
        }
        // The library has all materials, and they are not all grey.
        assert!(model.warnings.iter().all(|w| !w.text.contains("material")), "{:?}", model.warnings);
        assert!(
            model
                .materials
                .iter()
                .any(|m| m.base_color != enfilade_importers::Material::default().base_color)
        );
    }
}

#[cfg(feature = "gltf")]
#[test]
fn the_same_building_as_gltf_is_the_same() {
    let Some(files) = buildings() else { return };
    let mut compared = 0;
    for path in files {
        let twin = path.with_extension("glb");
        let Ok(gltf) = enfilade_importers::gltf::read(&twin, &ImportOptions::default()) else {
            println!("SKIPPED: {} is not read", twin.display());
            continue;
        };
        let obj = obj::read(&path, &ImportOptions::default()).unwrap();
        let classes = |model: &Model| -> BTreeMap<String, (Option<String>, usize)> {
            let entry =
                |e: &enfilade_importers::Element| (e.id.clone(), (e.class.clone(), e.mesh.triangles.len()));
            model.elements.iter().map(entry).collect()
        };
        assert_eq!(classes(&obj), classes(&gltf), "{}", path.display());
        let (a, b) = (obj.bounds().unwrap(), gltf.bounds().unwrap());
        for corner in 0..2 {
            for axis in 0..3 {
                assert!((a[corner][axis] - b[corner][axis]).abs() < 1e-4, "{}", path.display());
            }
        }
        compared += 1;
    }
    println!("{compared} buildings compared");
}
