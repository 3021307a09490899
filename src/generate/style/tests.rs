//! Styles of a building that is oblique to all axes, and how options go together.

use std::collections::BTreeMap;

use super::super::building::{Building, Element, Kind};
use super::super::{HouseOptions, house};
use super::export::Object;
use super::mesh::Cut;
use super::planes::{length, plane};
use super::*;
use crate::importers::Semantic;

/// The house turned by the angle whose tangent is 3/4, and five times as large: on the grid, and no wall along an
/// axis.
fn oblique() -> Building {
    let mut building = house(&HouseOptions::default());
    for p in building.elements.iter_mut().flat_map(|e| &mut e.points) {
        let [x, y, z] = *p;
        *p = [4 * x - 3 * y, 3 * x + 4 * y, 5 * z];
    }
    building
}

/// A mesh's directed edges, by the bits of their ends, that have no reverse.
fn open_edges(object: &Object<'_>) -> usize {
    let mut edges: BTreeMap<[[u64; 3]; 2], i64> = BTreeMap::new();
    for part in object.parts(Cut::Triangles) {
        for ring in part.faces.iter().flat_map(|(_, rings)| rings.iter()) {
            for i in 0..3 {
                let [p, q] = [ring[i], ring[(i + 1) % 3]].map(|c| part.points[c as usize].map(f64::to_bits));
                *edges.entry([p, q]).or_default() += 1;
                *edges.entry([q, p]).or_default() -= 1;
            }
        }
    }
    edges.values().filter(|sum| **sum != 0).count() / 2
}

fn volume(object: &Object<'_>) -> f64 {
    let cones = object.parts(Cut::Triangles).into_iter().flat_map(|part| {
        let triangles: Vec<[[f64; 3]; 3]> = part
            .faces
            .iter()
            .flat_map(|(_, rings)| rings.iter())
            .map(|ring| [0, 1, 2].map(|i| part.points[ring[i] as usize]))
            .collect();
        triangles.into_iter().map(|[a, b, c]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        })
    });
    cones.sum::<f64>() / 6.0
}

/// How many elements of a kind are of another volume in a style; all are closed.
fn changed(building: &Building, style: &Style, wanted: impl Fn(&Element) -> bool) -> usize {
    let export = building.export(style);
    let mut changed = 0;
    for object in &export.objects {
        assert_eq!(open_edges(object), 0, "{}", object.label.name);
        if wanted(&object.drawn) {
            let Some(drawn) = building.elements.iter().find(|e| e.global_id == object.label.id) else {
                continue;
            };
            changed += usize::from((volume(object) / drawn.volume() - 1.0).abs() > 1e-6);
        }
    }
    changed
}

#[test]
fn oblique_walls_openings_and_rooms_move_as_others_do() {
    let (straight, oblique) = (house(&HouseOptions::default()), oblique());
    let is_wall = |e: &Element| e.semantic == Semantic::Wall;
    let ends = Style { wall_ends: 1.0, ..Style::exact() };
    let moved = changed(&oblique, &ends, is_wall);
    assert_eq!(moved, changed(&straight, &ends, is_wall));
    assert!(moved >= 10, "{moved} walls");
    for style in [
        Style { openings_protruding: 1.0, ..Style::exact() },
        Style { openings_shallow: 1.0, ..Style::exact() },
    ] {
        assert_eq!(changed(&oblique, &style, |e| e.kind == Kind::Opening), 23);
    }
    for style in
        [Style { rooms_smaller: 1.0, ..Style::exact() }, Style { rooms_larger: 1.0, ..Style::exact() }]
    {
        assert_eq!(changed(&oblique, &style, |e| e.kind == Kind::Room), 8);
    }
    let floors = Style { floors_below: 1.0, ..Style::exact() };
    assert_eq!(changed(&oblique, &floors, |e| e.kind == Kind::Room), 8);
    assert_eq!(oblique.export(&floors).objects.len(), oblique.elements.len() + 8);
}

#[test]
fn oblique_walls_are_cut_on_the_grid() {
    let oblique = oblique();
    let export = oblique.export(&Style { walls_touching: 1.0, ..Style::exact() });
    let walls = export.objects.iter().filter(|o| o.label.class == "IfcWallStandardCase");
    let mut cut = 0;
    for wall in walls {
        let drawn = oblique.elements.iter().find(|e| e.global_id == wall.label.id).unwrap();
        assert_eq!(wall.drawn.sixfold_volume(), drawn.sixfold_volume(), "{}", drawn.name);
        assert_eq!(open_edges(wall), 0);
        cut += usize::from(wall.drawn.faces.len() > drawn.faces.len());
    }
    assert_eq!(cut, 14);
}

/// Corners move along their faces: where planes that meet obliquely part, all faces are still planar.
#[test]
fn faces_stay_planar() {
    let oblique = oblique();
    let style = Style {
        wall_ends: 1.0,
        openings_shallow: 1.0,
        rooms_larger: 1.0,
        floors_below: 1.0,
        ..Style::exact()
    };
    for object in &oblique.export(&style).objects {
        let [part] = &object.parts(Cut::Triangles)[..] else { panic!("one part") };
        for face in &object.drawn.faces {
            let (normal, _) = plane(&object.drawn, face);
            let size = length(normal);
            let height =
                |&i: &u32| (0..3).map(|k| normal[k] as f64 / size * part.points[i as usize][k]).sum::<f64>();
            let heights: Vec<f64> = face.loops.iter().flatten().map(height).collect();
            assert!(
                heights.iter().all(|h| (h - heights[0]).abs() < 1e-9),
                "{}: {heights:?}",
                object.label.name
            );
        }
    }
}

#[test]
fn what_excludes_each_other_takes_the_first() {
    let building = house(&HouseOptions::default());
    let both = Style { rooms_smaller: 1.0, rooms_larger: 1.0, ..Style::exact() };
    let one = Style { rooms_smaller: 1.0, ..Style::exact() };
    assert_eq!(building.export(&both).to_glb(), building.export(&one).to_glb());
    let both = Style { noisy_corners: 1.0, unwelded: 1.0, ..Style::exact() };
    let one = Style { noisy_corners: 1.0, ..Style::exact() };
    assert_eq!(building.export(&both).to_glb(), building.export(&one).to_glb());
}

/// How far corners are from where they were drawn at most, along any axis, metres.
fn farthest(building: &Building, style: &Style, wanted: impl Fn(&Element) -> bool) -> f64 {
    let (plain, moved) = (building.export(&Style::exact()), building.export(style));
    let mut farthest = 0.0_f64;
    for (plain, moved) in plain.objects.iter().zip(&moved.objects).filter(|(plain, _)| wanted(&plain.drawn)) {
        for (plain, moved) in plain.parts(Cut::Triangles).iter().zip(moved.parts(Cut::Triangles)) {
            let corners = |part: &Part<'_>| -> Vec<[f64; 3]> {
                let all = part.faces.iter().flat_map(|(_, rings)| rings.corners());
                all.map(|&corner| part.points[corner as usize]).collect()
            };
            for (p, q) in corners(plain).iter().zip(corners(&moved)) {
                farthest = (0..3).map(|i| (p[i] - q[i]).abs()).fold(farthest, f64::max);
            }
        }
    }
    farthest
}

#[test]
fn lengths_are_how_far_things_move() {
    let house = house(&HouseOptions::default());
    let is_room = |e: &Element| e.kind == Kind::Room;
    let is_solid = |e: &Element| e.kind == Kind::Solid;
    for gap in [1e-5, -1e-3, 0.02] {
        let rooms = Style { room_gap: gap, ..Style::exact() };
        assert!((farthest(&house, &rooms, is_room) - gap.abs()).abs() < 1e-9);
        assert_eq!(farthest(&house, &rooms, |e| !is_room(e)), 0.0);
        let solids = Style { solid_gap: gap, ..Style::exact() };
        assert!((farthest(&house, &solids, is_solid) - gap.abs()).abs() < 1e-9);
        assert_eq!(farthest(&house, &solids, |e| !is_solid(e)), 0.0);
        let sign = |changed: f64, drawn: f64| (changed - drawn) * gap < 0.0;
        let shrunk = house.export(&rooms);
        let all = shrunk.objects.iter().filter(|object| is_room(&object.drawn));
        assert!(all.into_iter().all(|room| sign(volume(room), room.drawn.volume())));
    }
    let jitter = Style { jitter: 1e-3, ..Style::exact() };
    assert!((0.99e-3..=1e-3 + 1e-12).contains(&farthest(&house, &jitter, |_| true)));
    let (welded, noisy) = (house.export(&jitter), Style { noise: 1e-3, ..Style::exact() });
    assert!(welded.objects.iter().all(|object| open_edges(object) == 0));
    assert!((0.99e-3..=1e-3 + 1e-12).contains(&farthest(&house, &noisy, |_| true)));
    assert!(house.export(&noisy).objects.iter().all(|object| open_edges(object) > 0));
    let none = Style { room_gap: f64::NAN, noise: f64::INFINITY, ..Style::exact() };
    assert_eq!(house.export(&none).to_glb(), house.to_glb());
}
