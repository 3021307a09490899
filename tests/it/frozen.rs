//! The frozen scenes of benchmarks are still the same.

use std::path::Path;

use enfilade::bench::FrozenScene;
use enfilade::components::components;
use enfilade::importers::gltf::read_slice;
use enfilade::importers::tagging::tag;
use enfilade::importers::{ImportOptions, Model, Semantic};
use enfilade::render::{parse_cameras, room_views, write_cameras};
use enfilade::{CompileOptions, Place, compile};

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
        if !bless {
            assert_eq!(scene.hash, hash, "{}: if that is meant, run this with ENFILADE_BLESS=1", scene.name);
        }
        // Of the others it is only asked that eyes are in boxes of rooms: compiling these takes longer than all else.
        let is_small = ["house", "round-room"].contains(&scene.building.as_str());
        let compiled =
            (bless || is_small).then(|| compile(&model, &CompileOptions::default()).unwrap().scene());
        if let Some(compiled) = compiled.as_ref().filter(|_| bless) {
            let views = room_views(compiled, 2);
            assert!(!views.is_empty(), "{}", scene.name);
            let step = views.len().div_ceil(CAMERAS);
            let chosen: Vec<_> = views.into_iter().step_by(step).collect();
            scene.cameras = write_cameras(&chosen, &compiled.frame());
            scene.hash = hash;
        }
        let cameras = parse_cameras(&scene.cameras, "scenes.toml", &model.frame).unwrap();
        // One room has no more.
        let least = if scene.building == "round-room" { 2 } else { CAMERAS / 2 };
        assert!((least..=CAMERAS).contains(&cameras.len()), "{}: {}", scene.name, cameras.len());
        for eye in cameras.iter().map(|camera| camera.eye()) {
            let is_in_room = match &compiled {
                Some(compiled) => matches!(compiled.locate(eye), Place::Air { room: Some(_), .. }),
                None => boxes_of_rooms(&model)
                    .any(|[lo, hi]| (0..3).all(|axis| eye[axis] > lo[axis] && eye[axis] < hi[axis])),
            };
            assert!(is_in_room, "{} {eye:?}", scene.name);
        }
    }
    if bless {
        let head = "# Frozen scenes and cameras of benchmarks. Made by tests/it/frozen.rs with ENFILADE_BLESS=1.\n\n";
        let file = head.to_owned() + &FrozenScene::to_file(scenes).unwrap();
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/scenes.toml"), file).unwrap();
    }
}

/// The boxes of the rooms' parts.
fn boxes_of_rooms(model: &Model) -> impl Iterator<Item = [[f64; 3]; 2]> {
    let rooms = model.elements.iter().filter(|element| element.semantic == Semantic::Room);
    rooms.flat_map(|room| components(&room.mesh)).map(|part| part.bounds)
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
