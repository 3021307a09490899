//! `--closed` and `--open` on the command line.

use crate::common;

use common::{Folder, fixture_arg};

/// The house as a scene, and its openings as its graph has them.
fn house() -> (Folder, Vec<serde_json::Value>) {
    let folder = Folder::new();
    let house = fixture_arg("house.glb");
    folder.run(&["compile", &house, "-o", "house.enf", "-q"]).expect(0);
    let graph = folder.run(&["export", "house.enf", "--graph", "-"]).expect(0).json();
    let openings = graph["openings"].as_array().unwrap().clone();
    (folder, openings)
}

#[test]
fn closed_openings_join_nothing_in_the_graph() {
    let (folder, openings) = house();
    let door = openings.iter().find(|o| o["filling"].is_string()).unwrap();
    let id = door["id"].as_str().unwrap();
    let count = |arguments: &[&str]| {
        let graph =
            folder.run(&[&["export", "house.enf", "--graph", "-"], arguments].concat()).expect(0).json();
        let portals = graph["portals"].as_array().unwrap().clone();
        let of_it = portals.iter().filter(|portal| portal["opening"].as_str() == Some(id)).count();
        let closed = graph["openings"].as_array().unwrap().iter().filter(|o| o["closed"] == true).count();
        (of_it, closed, portals.len())
    };
    let (modelled, by_id) = (count(&[]), count(&["--closed", id]));
    assert!(modelled.0 > 0 && modelled.1 == 0);
    assert_eq!((by_id.0, by_id.1), (0, 1));
    // By what fills it: the same.
    assert_eq!(count(&["--closed", door["filling"].as_str().unwrap()]), by_id);
    let all = count(&["--closed", "all"]);
    assert!(all.1 == openings.len() && all.0 == 0 && all.2 < modelled.2);
    // What is named itself counts more, and kinds of openings count more than all, in whatever order.
    assert_eq!(count(&["--closed", "all", "--open", id]).1, openings.len() - 1);
    let doors = openings.iter().filter(|o| o["semantic"] == "DOOR").count();
    assert!(doors > 0 && doors < openings.len());
    assert_eq!(count(&["--closed", "all", "--open", "doors"]).1, openings.len() - doors);
    assert_eq!(count(&["--open", "all", "--closed", "doors"]).1, doors);
    for two in [[id, id], [id, door["filling"].as_str().unwrap()], ["doors", "doors"]] {
        let arguments = ["export", "house.enf", "--graph", "-", "--closed", two[0], "--open", two[1]];
        folder.run(&arguments).expect_failure(2, &["both open and closed"]);
    }
}

#[test]
fn rays_meet_what_is_closed_and_pass_what_is_open() {
    let (folder, _) = house();
    let house = fixture_arg("house.glb");
    for stands in [&["--closed", "all"][..], &["--closed", "doors", "--leaf", "out", "--open", "windows"]] {
        let verify = [&["verify", "house.enf", "--model", &house, "--rays", "20000"], stands].concat();
        folder.run(&verify).expect(0);
    }
    folder
        .run(&["render", "house.enf", "-o", "open.png", "--size", "64x64", "--open", "all", "-q"])
        .expect(0);
    folder
        .run(&["render", "house.enf", "-o", "shut.png", "--size", "64x64", "--closed", "all", "-q"])
        .expect(0);
    assert_ne!(folder.read("open.png"), folder.read("shut.png"));
}

#[test]
fn what_is_no_opening_is_refused() {
    let (folder, _) = house();
    let rays = |arguments: &[&str]| {
        folder.run_with(&[&["trace", "house.enf", "--rays", "-"], arguments].concat(), b"1 1 1 1 0 0\n")
    };
    rays(&["--closed", "nothing of this name"]).expect_failure(2, &["nothing of this name", "doors"]);
    rays(&["--leaf", "out"]).expect_failure(2, &["--leaf"]);
    let graph = folder.run(&["export", "house.enf", "--graph", "-"]).expect(0).json();
    let host = graph["openings"][0]["host"].as_str().unwrap().to_owned();
    rays(&["--closed", &host]).expect_failure(2, &[&host, "no opening"]);
}
