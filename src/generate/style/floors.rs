//! Bodies that a building does not have but an export may: finish floors, and spaces over the rooms of a storey.

use std::collections::BTreeMap;

use super::super::building::{Building, Element, Face, Kind};
use super::super::global_id::global_id;
use super::super::lattice::Point;
use super::dice::Random;
use crate::importers::Semantic;

/// Thickness of a finish floor, units: 10.7 to 29.3 mm.
const THICKNESS: [usize; 2] = [11, 30];

/// The solids' faces that are the floor of each room: element and face, by room.
pub fn floor_faces(building: &Building) -> BTreeMap<u32, Vec<(u32, u32)>> {
    let mut floors: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    let solids = building.elements.iter().zip(0..).filter(|(e, _)| e.kind == Kind::Solid);
    for (solid, index) in solids {
        for (face, number) in solid.faces.iter().zip(0..) {
            let Some(room) = face.beyond else { continue };
            let room_element = &building.elements[room as usize];
            let is_floor = room_element.kind == Kind::Room && {
                let normal = solid.normal(face);
                let height = solid.points[face.loops[0][0] as usize][2];
                normal[0] == 0 && normal[1] == 0 && normal[2] > 0 && Some(height) == lowest(room_element)
            };
            if is_floor {
                floors.entry(room).or_default().push((index, number));
            }
        }
    }
    floors
}

/// The height of a body's lowest corner, units.
pub fn lowest(element: &Element) -> Option<i32> {
    element.points.iter().map(|p| p[2]).min()
}

/// How thick a room's finish floor is, units.
pub fn thickness(mut random: Random) -> i32 {
    (THICKNESS[0] + random.below(THICKNESS[1] - THICKNESS[0] + 1)) as i32
}

/// The finish floor of a room: a slab over each of its floor's faces, with that face's material.
pub fn finish_floor(building: &Building, room: u32, faces: &[(u32, u32)], thickness: i32) -> Element {
    let room = &building.elements[room as usize];
    let mut floor =
        new_like(room, Kind::Solid, Semantic::Ground, "IfcCovering", &format!("{} floor", room.name));
    floor.extras.insert("predefined_type".to_owned(), "FLOORING".to_owned());
    for &(solid, face) in faces {
        let solid = &building.elements[solid as usize];
        let face = &solid.faces[face as usize];
        let corners: Vec<Point> = face.loops.iter().flatten().map(|&i| solid.points[i as usize]).collect();
        // Loops that touch share a corner.
        let mut known: BTreeMap<Point, u32> = BTreeMap::new();
        for &corner in &corners {
            let next = floor.points.len() as u32 + 2 * known.len() as u32;
            known.entry(corner).or_insert(next);
        }
        let mut added: Vec<(u32, Point)> = known.iter().map(|(&p, &i)| (i, p)).collect();
        added.sort_unstable();
        floor.points.extend(added.iter().flat_map(|&(_, [x, y, z])| [[x, y, z], [x, y, z + thickness]]));

        let low = |i: &u32| known[&solid.points[*i as usize]];
        let new = |loops| Face { loops, material: face.material, beyond: None, seen: false };
        let top = face.loops.iter().map(|ring| ring.iter().map(|i| low(i) + 1).collect()).collect();
        let bottom = face.loops.iter().map(|ring| ring.iter().rev().map(low).collect()).collect();
        floor.faces.extend([new(top), new(bottom)]);
        for ring in &face.loops {
            for (i, from) in ring.iter().enumerate() {
                let [a, b] = [from, &ring[(i + 1) % ring.len()]].map(low);
                floor.faces.push(new(vec![vec![a, b, b + 1, a + 1]]));
            }
        }
    }
    floor
}

/// The storeys that have rooms, each with its rooms, in the order of their first rooms.
pub fn storeys(building: &Building) -> Vec<(&str, Vec<u32>)> {
    let mut storeys: Vec<(&str, Vec<u32>)> = Vec::new();
    let mut known: BTreeMap<&str, usize> = BTreeMap::new();
    for (room, index) in building.elements.iter().zip(0..).filter(|(e, _)| e.kind == Kind::Room) {
        let Some(name) = room.storey.as_deref() else { continue };
        let place = *known.entry(name).or_insert_with(|| {
            storeys.push((name, Vec::new()));
            storeys.len() - 1
        });
        storeys[place].1.push(index);
    }
    storeys
}

/// The space over the rooms of a storey: a body of all their bodies.
pub fn storey_space(building: &Building, name: &str, rooms: &[u32]) -> Element {
    let first = &building.elements[rooms[0] as usize];
    let mut space = new_like(first, Kind::Room, Semantic::Room, "IfcSpace", name);
    for &room in rooms {
        let room = &building.elements[room as usize];
        let before = space.points.len() as u32;
        space.points.extend(&room.points);
        space.faces.extend(room.faces.iter().map(|face| Face {
            loops: face.loops.iter().map(|ring| ring.iter().map(|i| before + i).collect()).collect(),
            ..face.clone()
        }));
    }
    space
}

/// A new element without a mesh, on the storey of `other`, whose identity follows from that of `other`.
fn new_like(other: &Element, kind: Kind, semantic: Semantic, class: &str, name: &str) -> Element {
    Element {
        kind,
        semantic,
        class: class.to_owned(),
        name: name.to_owned(),
        global_id: global_id(0, &format!("{}/{class}:{name}", other.global_id)),
        storey: other.storey.clone(),
        host: None,
        filling: None,
        opening: None,
        extras: BTreeMap::new(),
        points: Vec::new(),
        faces: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{HouseOptions, house};
    use super::*;

    #[test]
    fn floors_cover_their_rooms() {
        let building = house(&HouseOptions::default());
        let floors = floor_faces(&building);
        assert_eq!(floors.len(), 8);
        for (&room, faces) in &floors {
            let floor = finish_floor(&building, room, faces, 20);
            let room = &building.elements[room as usize];
            // All rooms of the house are as high everywhere, but for the hearth in the living room, which stands
            // above the floor.
            let height = i128::from(super::super::super::lattice::units(2.6));
            let covered = floor.sixfold_volume() / 20;
            let volume = room.sixfold_volume() / height;
            assert!((covered - volume).abs() * 100 <= volume, "{}: {covered} of {volume}", room.name);
            assert!(floor.faces.iter().all(|face| face.material == floor.faces[0].material));
        }
    }

    #[test]
    fn a_storey_is_the_sum_of_its_rooms() {
        let building = house(&HouseOptions::default());
        let storeys = storeys(&building);
        let [(name, rooms)] = &storeys[..] else { panic!("{storeys:?}") };
        let space = storey_space(&building, name, rooms);
        let sum: i128 = rooms.iter().map(|&r| building.elements[r as usize].sixfold_volume()).sum();
        assert_eq!((rooms.len(), space.sixfold_volume()), (8, sum));
    }
}
