//! `enfilade export` and `enfilade plan`, as a reader would run them; and that rays go where the graph says.
#![cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "cli"))]

use crate::common;

use std::collections::{BTreeMap, BTreeSet};

use common::{Folder, fixture_arg};
use enfilade::importers::{ImportOptions, import};
use enfilade::{Answer, CompileOptions, Place, Ray, Scene, compile};
use serde_json::Value;

fn texts<'v>(list: &'v Value, key: &str) -> Vec<&'v str> {
    list.as_array().unwrap().iter().map(|item| item[key].as_str().unwrap()).collect()
}

#[test]
fn a_scene_and_its_model_give_the_same_files() {
    let folder = Folder::new();
    for name in ["house.glb", "oblique-wing.glb", "far.glb", "openings-missing.glb", "rooms-missing.glb"] {
        let model = fixture_arg(name);
        folder.run(&["compile", &model, "-o", "a.enf", "--topology"]).expect(0);
        for (input, output) in [("a.enf", "scene"), (model.as_str(), "model")] {
            let names = ["json", "dot", "obj", "glb", "svg"].map(|kind| format!("{output}.{kind}"));
            let [json, dot, obj, glb, svg] = names.each_ref().map(String::as_str);
            folder
                .run(&[
                    "export",
                    input,
                    "--graph",
                    json,
                    "--obj",
                    obj,
                    "--cells",
                    glb,
                    "--explode",
                    "0.2",
                    "-q",
                ])
                .expect(0);
            folder.run(&["export", input, "--graph", dot, "-q"]).expect(0);
            folder.run(&["plan", input, "-o", svg, "-q"]).expect(0);
        }
        for kind in ["json", "dot", "glb", "svg"] {
            let [a, b] = ["scene", "model"].map(|of| folder.read(&format!("{of}.{kind}")));
            assert!(!a.is_empty() && a == b, "{name} {kind}");
        }
        // The name of the colours beside it differs.
        let [a, b] =
            ["scene", "model"].map(|of| String::from_utf8(folder.read(&format!("{of}.obj"))).unwrap());
        assert_eq!(a.replace("scene.mtl", "model.mtl"), b, "{name}");
    }
}

#[test]
fn the_graph_of_the_house_is_that_of_its_truth() {
    let folder = Folder::new();
    let graph = folder.run(&["export", &fixture_arg("house.glb"), "--graph", "-"]).expect(0).json();
    let truth: Value =
        serde_json::from_slice(&std::fs::read(common::fixture("house.truth.json")).unwrap()).unwrap();
    assert_eq!(texts(&graph["rooms"], "id"), texts(&truth["rooms"], "id"));
    for (room, of) in graph["rooms"].as_array().unwrap().iter().zip(truth["rooms"].as_array().unwrap()) {
        let near = |key: &str, of: f64| (room[key].as_f64().unwrap() - of).abs() < 1e-3 * of;
        assert!(near("volume_m3", of["volume"].as_f64().unwrap()), "{room}");
        assert!(near("floor_area_m2", of["floor_area"].as_f64().unwrap()), "{room}");
        assert!(room["semantic"] == "ROOM" && room["class"] == "IfcSpace" && room["derived"] == false);
        assert!(!room["cells"].as_array().unwrap().is_empty() && room["storey"] == of["storey"]);
        // Faces by kind, portals apart.
        let mut areas: BTreeMap<&str, f64> = BTreeMap::new();
        for face in graph["faces"].as_array().unwrap().iter().filter(|face| face["room"] == room["id"]) {
            *areas.entry(face["semantic"].as_str().unwrap()).or_default() +=
                face["area_m2"].as_f64().unwrap();
        }
        for (kind, area) in of["faces"].as_object().unwrap().iter().filter(|(kind, _)| *kind != "PORTAL") {
            let area = area.as_f64().unwrap();
            assert!((areas[kind.as_str()] - area).abs() < 1e-3 * area, "{kind} {area} {areas:?}");
        }
    }
    let exterior = truth["exterior"]["id"].as_str().unwrap();
    for opening in truth["openings"].as_array().unwrap() {
        let own =
            graph["openings"].as_array().unwrap().iter().find(|own| own["id"] == opening["id"]).unwrap();
        let named =
            |id: &Value| if id == exterior { "EXTERIOR".to_owned() } else { id.as_str().unwrap().to_owned() };
        let joins: BTreeSet<String> =
            opening["joins"].as_array().unwrap().iter().map(|j| named(&j["id"])).collect();
        let sides: BTreeSet<String> = own["sides"].as_array().unwrap().iter().map(named).collect();
        assert_eq!(sides, joins);
        assert!(
            own["host"] == opening["host"] && own["filling"] == opening["filling"] && own["derived"] == false
        );
        let through: Vec<&Value> = graph["portals"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|portal| portal["opening"] == own["id"])
            .collect();
        let [portal] = through[..] else { panic!("{through:?}") };
        let area = opening["joins"]
            .as_array()
            .unwrap()
            .iter()
            .map(|j| j["area"].as_f64().unwrap())
            .fold(f64::MAX, f64::min);
        assert!((portal["area_m2"].as_f64().unwrap() - area).abs() < 1e-3 * area, "{portal} {area}");
    }
    assert_eq!(graph["voids"], Value::Array(Vec::new()));
}

/// Rays from one end of an opening to the other come from a place to another that the graph says it joins, by its cells.
#[test]
fn rays_through_openings_cross_what_the_graph_says() {
    for name in
        ["house.glb", "oblique-wing.glb", "stairwell.glb", "openings-protruding.glb", "openings-shallow.glb"]
    {
        let model = import(fixture_arg(name).as_ref(), &ImportOptions::default()).unwrap();
        let scene: Scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        let graph = scene.graph();
        let mut crossed = 0;
        for opening in &graph.openings {
            let [a, b] = opening.ends;
            let middle = [0, 1, 2].map(|i| (a[i] + b[i]) / 2.0);
            let mut random = enfilade_testing::Random::new(u64::from(opening.element));
            for _ in 0..50 {
                let slant = [0, 1, 2].map(|i| opening.direction[i] + 0.3 * (random.unit() - 0.5));
                // From the middle of the hole both ways, a little farther than its ends.
                let mut places = Vec::new();
                for way in [-1.0, 1.0] {
                    let reach = [0, 1, 2].map(|i| (b[i] - a[i]) / 2.0);
                    let reach = reach.iter().map(|c| c * c).sum::<f64>().sqrt() + 0.05;
                    let ray = Ray::new(middle, slant.map(|c| c * way));
                    if let Answer::Hit(hit) = scene.trace(&ray)
                        && hit.t < reach
                    {
                        break;
                    }
                    let length = slant.iter().map(|c| c * c).sum::<f64>().sqrt();
                    let end = [0, 1, 2].map(|i| middle[i] + slant[i] * way * reach / length);
                    let Place::Air { cell, room, .. } = scene.locate(end) else { break };
                    places.push(match room {
                        Some(room) => {
                            assert!(graph.rooms[room as usize].cells.contains(&cell));
                            enfilade::graph::Place::Room(room)
                        }
                        None => enfilade::graph::Place::Exterior,
                    });
                    let Place::Air { cell, .. } = scene.locate(middle) else {
                        panic!("{name}: a hole is no air")
                    };
                    assert!(opening.cells.contains(&cell), "{name}");
                }
                let [one, other] = places[..] else { continue };
                crossed += 1;
                let places = [one.min(other), one.max(other)];
                let is_known =
                    |p: &&enfilade::graph::Passage| p.opening == Some(opening.element) && p.places == places;
                assert!(
                    graph.portals.iter().find(is_known).is_some_and(|p| p.area > 0.0),
                    "{name}: {opening:?} {places:?}"
                );
            }
        }
        assert!(crossed > 40, "{name}: {crossed}");
    }
}

#[test]
fn what_is_missing_is_found_and_said_to_be_derived() {
    let folder = Folder::new();
    let graph =
        |name: &str| folder.run(&["export", &fixture_arg(name), "--graph", "-", "-q"]).expect(0).json();
    let whole = graph("plain.glb");
    let bare = graph("openings-missing.glb");
    let joins = |graph: &Value| -> BTreeSet<(String, BTreeSet<String>)> {
        let sides =
            |opening: &Value| opening["sides"].as_array().unwrap().iter().map(Value::to_string).collect();
        let all = graph["openings"].as_array().unwrap().iter();
        all.filter(|o| o["filling"].is_string()).map(|o| (o["filling"].to_string(), sides(o))).collect()
    };
    assert_eq!(joins(&whole), joins(&bare));
    assert!(bare["openings"].as_array().unwrap().iter().all(|opening| opening["derived"] == true));
    let rooms = graph("rooms-missing.glb");
    let of = |graph: &Value| -> Vec<i64> {
        let areas = graph["rooms"].as_array().unwrap().iter();
        let mut areas: Vec<i64> =
            areas.map(|room| (room["floor_area_m2"].as_f64().unwrap() * 100.0).round() as i64).collect();
        areas.sort_unstable();
        areas
    };
    assert_eq!(of(&whole), of(&rooms));
    assert!(rooms["rooms"].as_array().unwrap().iter().all(|room| room["derived"] == true));
    assert!(rooms["rooms"][0]["name"].as_str().unwrap().ends_with(" 1"));
    // The truth of rays is the model's own.
    for name in ["openings-missing.glb", "rooms-missing.glb"] {
        folder.run(&["compile", &fixture_arg(name), "-o", "a.enf", "-q"]).expect(0);
        folder.run(&["verify", "a.enf", "--model", &fixture_arg(name), "--rays", "20000", "-q"]).expect(0);
    }
    // And what nobody asks for is not there.
    folder
        .run(&["compile", &fixture_arg("rooms-missing.glb"), "-o", "a.enf", "--derive", "nothing", "-q"])
        .expect(0);
    let bare = folder.run(&["export", "a.enf", "--graph", "-"]).expect(0).json();
    assert_eq!(bare["rooms"], Value::Array(Vec::new()));
}

#[test]
fn plans_show_what_they_cut() {
    let folder = Folder::new();
    let house = fixture_arg("house.glb");
    folder.run(&["plan", &house, "-o", "a.svg", "-q"]).expect(0);
    let svg = String::from_utf8(folder.read("a.svg")).unwrap();
    for word in ["Kitchen", "8.2 m\u{b2}", "Ground floor", "Living room", "4 m", "N (-z)"] {
        assert!(svg.contains(word), "no {word}");
    }
    folder.run(&["plan", &house, "-o", "b.png", "--size", "400", "--cells", "-q"]).expect(0);
    let picture = folder.read("b.png");
    assert!(picture.starts_with(b"\x89PNG"));
    folder.run(&["plan", &fixture_arg("stairwell.glb"), "-o", "c.svg", "--all", "-q"]).expect(0);
    assert_ne!(folder.read("c.0001.svg"), folder.read("c.0002.svg"));
    folder
        .run(&["plan", &house, "-o", "d.svg", "--storey", "Attic", "-q"])
        .expect_failure(2, &["Attic", "Ground floor"]);
    folder.run(&["plan", &house, "-o", "d.pdf", "-q"]).expect_failure(2, &["d.pdf", ".svg"]);
    folder.run(&["export", &house, "-q"]).expect(2);
}
