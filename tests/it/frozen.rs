//! The frozen scenes of benchmarks are still the same.

use std::path::Path;

use enfilade::bench::FrozenScene;
use enfilade::importers::gltf::read_slice;
use enfilade::importers::tagging::tag;
use enfilade::importers::{ElementId, ImportOptions, Role, Semantic, Untagged};
use enfilade::oracle::{Truth, TruthOptions};
use enfilade::render::{parse_cameras, room_views, write_cameras};
use enfilade::roles::roles;
use enfilade::{CompileOptions, compile};

/// How many cameras a scene has at most.
const CAMERAS: usize = 16;

#[test]
fn frozen_scenes_are_what_the_generator_makes() {
    let bless = std::env::var_os("ENFILADE_BLESS").is_some_and(|value| value == "1");
    let mut scenes = FrozenScene::all().unwrap();
    assert!(scenes.len() >= 7);
    for scene in &mut scenes {
        let (glb, hash) = scene.glb_and_hash().unwrap();
        let mut model = read_slice(&glb, &scene.name, &ImportOptions::default()).unwrap();
        tag(&mut model, &ImportOptions::default()).unwrap();
        if bless {
            let compiled = compile(&model, &CompileOptions::default()).unwrap().scene();
            let views = room_views(&compiled, 2);
            assert!(!views.is_empty(), "{}", scene.name);
            let step = views.len().div_ceil(CAMERAS);
            let chosen: Vec<_> = views.into_iter().step_by(step).collect();
            scene.cameras = write_cameras(&chosen, &compiled.frame());
            scene.hash = hash;
        } else {
            assert_eq!(scene.hash, hash, "{}: if that is meant, run this with ENFILADE_BLESS=1", scene.name);
        }
        let cameras = parse_cameras(&scene.cameras, "scenes.toml", &model.frame).unwrap();
        // One room has no more.
        let least = if scene.building == "round-room" { 2 } else { CAMERAS / 2 };
        assert!((least..=CAMERAS).contains(&cameras.len()), "{}: {}", scene.name, cameras.len());
        let roles = roles(&model, Untagged::default());
        let only = |is_meant: &dyn Fn(ElementId) -> bool| {
            let role = |element| if is_meant(element) { Role::Solid } else { Role::Ignore };
            Truth::new(&model, role, &TruthOptions::default())
        };
        let rooms = only(&|element| model.elements[element.0 as usize].semantic == Semantic::Room);
        let solids = only(&|element| roles[element.0 as usize] == Role::Solid);
        for camera in cameras {
            let eye = camera.eye();
            assert!(!rooms.solids_at(eye).is_empty() && solids.solids_at(eye).is_empty(), "{}", scene.name);
        }
    }
    if bless {
        let head = "# Frozen scenes and cameras of benchmarks. Made by tests/it/frozen.rs with ENFILADE_BLESS=1.\n\n";
        let file = head.to_owned() + &FrozenScene::to_file(scenes).unwrap();
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/scenes.toml"), file).unwrap();
    }
}

#[test]
fn unknown_scenes_are_named() {
    let error = FrozenScene::by_name("castle").unwrap_err().to_string();
    assert!(error.contains("'castle'") && error.contains("build3"), "{error}");
    let mut house = FrozenScene::by_name("house").unwrap();
    assert!(house.glb().unwrap().starts_with(b"glTF"));
    house.seed = 7;
    let error = house.glb().unwrap_err().to_string();
    assert!(error.contains(&house.hash), "{error}");
}
