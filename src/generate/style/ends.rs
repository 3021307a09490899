//! By how much the ends of walls and of openings are off.

use std::collections::{BTreeMap, BTreeSet};

use super::super::building::{Building, Element, Kind};
use super::super::lattice::Point;
use super::dice::Random;
use super::planes::{Plane, extent, plane, reach};
use crate::importers::Semantic;

/// How far an opening sticks out of its wall, metres.
const PROTRUDING: [f64; 2] = [0.010, 0.150];

/// What an opening lacks at least, metres, and at most, as a share of its depth.
const SHALLOW: (f64, f64) = (0.005, 0.25);

/// Where the volumes of a building touch: what the ends of walls and openings are told by.
pub struct Contacts {
    /// Upright faces of solids that look into no air: by plane, the solid and the box around the face.
    covered: BTreeMap<Plane, Vec<(u32, [Point; 2])>>,
    /// By opening, the planes of the solids' faces that look into it, seen from the opening.
    reveals: BTreeMap<u32, BTreeSet<Plane>>,
}

impl Contacts {
    pub fn of(building: &Building) -> Contacts {
        let mut contacts = Contacts { covered: BTreeMap::new(), reveals: BTreeMap::new() };
        let solids = building.elements.iter().zip(0u32..).filter(|(e, _)| e.kind == Kind::Solid);
        for (element, index) in solids {
            for face in &element.faces {
                let is_opening = |&air: &u32| building.elements[air as usize].kind == Kind::Opening;
                if let Some(opening) = face.beyond.filter(is_opening) {
                    let plane = opposite(plane(element, face));
                    contacts.reveals.entry(opening).or_default().insert(plane);
                } else if face.beyond.is_none() {
                    let plane = plane(element, face);
                    if plane.0[2] == 0 {
                        let corners = face.loops.iter().flatten().map(|&i| element.points[i as usize]);
                        contacts.covered.entry(plane).or_default().push((index, bounds(corners)));
                    }
                }
            }
        }
        contacts
    }

    /// How far the ends of a wall run into what they meet, metres, by plane.
    pub fn wall_ends(&self, building: &Building, index: u32, mut random: Random) -> BTreeMap<Plane, f64> {
        let wall = &building.elements[index as usize];
        let mut ends = BTreeMap::new();
        if wall.kind != Kind::Solid || wall.semantic != Semantic::Wall {
            return ends;
        }
        for (end, faces) in outermost(wall) {
            let across = [-end.0[1], end.0[0], 0];
            let is_upright = end.0[2] == 0;
            let is_covered = faces.iter().all(|&face| wall.faces[face].beyond.is_none());
            if !is_upright || !is_covered || extent(wall, end.0) < extent(wall, across) {
                continue;
            }
            let corners = faces
                .iter()
                .flat_map(|&f| wall.faces[f].loops.iter().flatten())
                .map(|&i| wall.points[i as usize]);
            let around = bounds(corners);
            let behind = self.covered.get(&opposite(end)).map_or(&[][..], Vec::as_slice);
            let met = behind.iter().filter(|(_, other)| overlap(&around, other));
            // No farther than through the thinnest thing that the end meets.
            let room = met
                .map(|&(other, _)| extent(&building.elements[other as usize], end.0))
                .reduce(f64::min)
                .map(|thinnest| thinnest.min(extent(wall, across)));
            if let Some(most) = room {
                ends.insert(end, most * random.between(0.25, 1.0));
            }
        }
        ends
    }

    /// The ends of an opening: its outermost planes that look at air.
    fn opening_ends(&self, building: &Building, index: u32) -> Vec<Plane> {
        let opening = &building.elements[index as usize];
        let none = BTreeSet::new();
        let reveals = self.reveals.get(&index).unwrap_or(&none);
        if opening.kind != Kind::Opening {
            return Vec::new();
        }
        outermost(opening).into_keys().filter(|plane| !reveals.contains(plane)).collect()
    }

    /// How far an opening sticks out, metres, by plane.
    pub fn protruding(&self, building: &Building, index: u32, mut random: Random) -> BTreeMap<Plane, f64> {
        let ends = self.opening_ends(building, index);
        ends.into_iter().map(|end| (end, random.between(PROTRUDING[0], PROTRUDING[1]))).collect()
    }

    /// How far the planes of a shallow opening move, metres: inward.
    pub fn shallow(&self, building: &Building, index: u32, mut random: Random) -> BTreeMap<Plane, f64> {
        let mut ends = self.opening_ends(building, index);
        // At one end of two, or at both.
        let one = random.below(2 * ends.len());
        if one < ends.len() {
            ends = vec![ends[one]];
        }
        let opening = &building.elements[index as usize];
        let lacking = |end: Plane, random: &mut Random| {
            let most = extent(opening, end.0) * SHALLOW.1;
            -random.between(SHALLOW.0.min(most), most)
        };
        ends.into_iter().map(|end| (end, lacking(end, &mut random))).collect()
    }
}

/// The planes of a body that have all of it on one side, with their faces.
fn outermost(element: &Element) -> BTreeMap<Plane, Vec<usize>> {
    let mut planes: BTreeMap<Plane, Vec<usize>> = BTreeMap::new();
    for (index, face) in element.faces.iter().enumerate() {
        planes.entry(plane(element, face)).or_default().push(index);
    }
    let mut tops: BTreeMap<[i64; 3], i64> = BTreeMap::new();
    planes.retain(|(normal, height), _| {
        *tops.entry(*normal).or_insert_with(|| reach(element, *normal)[1]) == *height
    });
    planes
}

fn opposite((normal, height): Plane) -> Plane {
    (normal.map(|c| -c), -height)
}

fn bounds(points: impl Iterator<Item = Point>) -> [Point; 2] {
    points.fold([[i32::MAX; 3], [i32::MIN; 3]], |[lo, hi], p| {
        [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
    })
}

/// Whether the boxes around two faces of one upright plane have more than an edge in common.
fn overlap([a, b]: &[Point; 2], [c, d]: &[Point; 2]) -> bool {
    let common = [0, 1, 2].map(|i| b[i].min(d[i]) - a[i].max(c[i]));
    common[2] > 0 && common[0] >= 0 && common[1] >= 0 && common[0].max(common[1]) > 0
}

#[cfg(test)]
mod tests {
    use super::super::super::lattice::units;
    use super::super::super::{HouseOptions, house};
    use super::super::dice::Dice;
    use super::*;

    fn index(building: &Building, name: &str) -> u32 {
        building.elements.iter().position(|e| e.name == name).unwrap() as u32
    }

    #[test]
    fn walls_end_where_they_meet_solids() {
        let building = house(&HouseOptions::default());
        let contacts = Contacts::of(&building);
        let ends = |name| contacts.wall_ends(&building, index(&building, name), Dice::new(1).draw("x", name));
        // Between two outer walls, at both ends; 0.12 m thick.
        let between = ends("Wall dining-kitchen");
        let planes: Vec<_> = between.keys().copied().collect();
        assert_eq!(planes.len(), 2);
        assert!(planes.contains(&([-1, 0, 0], -i64::from(units(0.36)))));
        assert!(between.values().all(|&by| (0.03..=0.1204).contains(&by)), "{between:?}");
        // Its western end looks into the dining room in part; only the eastern one is covered.
        assert!(ends("Wall living-hall").keys().all(|(normal, _)| *normal == [1, 0, 0]));
        // The outer walls in the south and north have their ends outside.
        assert!(ends("Outer wall south").is_empty());
        assert_eq!(ends("Outer wall west").len(), 2);
        assert!(ends("Floor slab").is_empty());
    }

    #[test]
    fn openings_have_two_ends() {
        let building = house(&HouseOptions::default());
        let contacts = Contacts::of(&building);
        for (opening, i) in building.elements.iter().zip(0..).filter(|(e, _)| e.kind == Kind::Opening) {
            let ends = contacts.opening_ends(&building, i);
            let [(a, _), (b, _)] = ends[..] else { panic!("{}: {ends:?}", opening.name) };
            assert_eq!(a, b.map(|c| -c));
            let host = &building.elements[opening.host.unwrap() as usize];
            assert!(extent(opening, a) <= extent(host, a) && a[2] == 0);
            let random = Dice::new(2).draw("y", &opening.name);
            assert!(contacts.protruding(&building, i, random).values().all(|by| (0.01..=0.15).contains(by)));
            let shallow = contacts.shallow(&building, i, random);
            assert!(matches!(shallow.len(), 1 | 2));
            assert!(shallow.values().all(|by| -by >= 0.005 && -by <= 0.25 * extent(opening, a)));
        }
    }
}
