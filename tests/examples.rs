//! The examples do what they say, on the shipped house.

#[allow(dead_code)]
#[path = "../examples/lidar.rs"]
mod lidar;
#[allow(dead_code)]
#[path = "../examples/rules.rs"]
mod rules;

use std::path::Path;

#[test]
fn the_lidar_sees_most_of_the_sphere() {
    let mut out = Vec::new();
    let points = lidar::sweep(Path::new("fixtures/house.glb"), &mut out).unwrap();
    assert!(points > 20_000, "{points}");
    assert_eq!(String::from_utf8(out).unwrap().lines().count(), points);
}

#[test]
fn rules_move_elements() {
    let counts = rules::compare(Path::new("fixtures/house.glb")).unwrap();
    assert_eq!(counts["COLUMN"], [3, 0]);
    assert_eq!(counts["EQUIPMENT"], [13, 0]);
    assert_eq!(counts["WALL"][1], counts["WALL"][0] + 3);
    assert_eq!(counts["FURNITURE"][1], counts["FURNITURE"][0] + 13);
}
