//! The fixtures, from file to answers: each is read, compiled and verified, and what its truth says holds of the scene.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use enfilade::importers::{ImportOptions, Model, Untagged, import};
use enfilade::inspect::inspect;
use enfilade::roles::roles;
use enfilade::{CompileOptions, Place, Scene, VerifyOptions, compile, verify};
use serde_json::Value;

fn fixtures(ending: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let all = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut wanted: Vec<PathBuf> = all.filter(|path| path.to_str().unwrap().ends_with(ending)).collect();
    wanted.sort();
    assert!(wanted.len() >= 10, "{ending}: {}", wanted.len());
    wanted
}

fn load(path: &Path) -> Model {
    import(path, &ImportOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(model: &Model) -> Scene {
    compile(model, &CompileOptions::default()).unwrap().scene()
}

#[test]
fn every_answer_is_right() {
    for path in fixtures(".glb") {
        let model = load(&path);
        let compiled = compile(&model, &CompileOptions::default()).unwrap();
        let out: u64 = compiled.report.triangles_out.iter().map(|row| row.count).sum();
        assert_eq!(out, compiled.report.triangles_in, "{}", path.display());
        let scene = compiled.scene();
        let roles = roles(&model, Untagged::default());
        let options = VerifyOptions::default().with_rays(2_000).with_grid_rays(200);
        let report = verify(&model, |e| roles[e.0 as usize], &scene, &options).unwrap();
        assert_eq!(report.total.wrong, 0, "{}: {:?}", path.display(), report.wrong);
        assert!(
            report.sight.different == 0 && report.sight.rays > 0,
            "{}: {:?}",
            path.display(),
            report.sight
        );
        assert_eq!(report.grid.different, 0, "{}", path.display());
    }
}

/// The truths of the fixtures, with their models.
fn truths() -> Vec<(Value, Model)> {
    let read = |path: &PathBuf| {
        let truth: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let name = path.to_str().unwrap().replace(".truth.json", ".glb");
        (truth, load(Path::new(&name)))
    };
    fixtures(".truth.json").iter().map(read).collect()
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().unwrap()
}

fn text<'a>(value: &'a Value, name: &str) -> &'a str {
    value[name].as_str().unwrap()
}

#[test]
fn every_element_is_closed() {
    for (truth, model) in truths() {
        let inspection = inspect(&model, Untagged::default(), None);
        for element in &inspection.elements {
            assert_eq!(element.open_edges, 0, "{}: {}", text(&truth, "name"), element.id);
        }
    }
}

#[test]
fn points_lie_where_the_truth_says() {
    let mut count = BTreeMap::new();
    for (truth, model) in truths() {
        let scene = scene(&model);
        let rooms: BTreeMap<&str, &Value> =
            list(&truth, "rooms").iter().map(|r| (text(r, "id"), r)).collect();
        for sample in list(&truth, "points") {
            let (id, point) = (text(sample, "id"), list(sample, "point"));
            let point = [0, 1, 2].map(|i| point[i].as_f64().unwrap());
            let kind = match scene.locate(point) {
                Place::InSolid(element) => {
                    assert_eq!(scene.element(element).id(), id, "{point:?}");
                    "solid"
                }
                Place::Air { room: Some(room), .. } => {
                    assert_eq!(scene.room(room).element().id(), id, "{point:?}");
                    "room"
                }
                Place::Air { label, .. } => {
                    let element = scene.elements().find(|e| e.id() == id).unwrap();
                    // The ground is detail: the exterior's label ends at it, and what is below has none.
                    let is_ground = element.class() == "IfcSite";
                    assert!(element.semantic() == label || is_ground, "{point:?} {id} {label:?}");
                    if is_ground { "ground" } else { "other air" }
                }
                place => panic!("{point:?}: {place:?}"),
            };
            *count.entry(kind).or_insert(0) += 1;
        }
        assert_eq!(scene.rooms().len(), rooms.len());
        for room in scene.rooms() {
            let told = rooms[room.element().id()];
            let volume = room.volume().unwrap();
            assert!((volume - told["volume"].as_f64().unwrap()).abs() < 1e-9 * volume, "{told}");
        }
    }
    assert!(count.values().all(|&n| n > 30) && count.len() == 4, "{count:?}");
}

#[test]
fn styles_leave_the_truth_where_it_was() {
    // One building in many styles: what a file says of its rooms follows the drawing to within what the style does.
    let plain = load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/plain.glb"));
    let volume = |model: &Model| {
        let scene = scene(model);
        scene.rooms().filter_map(|room| room.volume()).sum::<f64>()
    };
    let exact = volume(&plain);
    for (name, least, most) in [
        ("rooms-smaller", 0.97, 0.9999),
        ("rooms-larger", 1.0001, 1.03),
        ("floors-below", 0.98, 0.9999),
        ("turned", 1.0 - 1e-5, 1.0 + 1e-5),
        ("far", 1.0 - 1e-5, 1.0 + 1e-5),
        ("millimetres", 1.0 - 1e-5, 1.0 + 1e-5),
        ("off-grid", 1.0 - 1e-4, 1.0 + 1e-4),
        ("mixed-winding", 1.0 - 1e-9, 1.0 + 1e-9),
        ("doubled-faces", 1.0 - 1e-9, 1.0 + 1e-9),
        ("inside-out", 1.0 - 1e-9, 1.0 + 1e-9),
        ("unwelded", 1.0 - 1e-9, 1.0 + 1e-9),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/{name}.glb"));
        let ratio = volume(&load(&path)) / exact;
        assert!(ratio >= least && ratio <= most, "{name}: {ratio}");
    }
}
