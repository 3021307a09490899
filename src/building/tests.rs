use std::collections::BTreeMap;
use std::ops::Range;

use super::*;
use crate::generate::{
    self, HouseOptions, OfficeOptions, Style, TowerOptions, build1, build2, build3, house, random, tower,
};
use crate::lattice::{Point, orient};
use crate::partition::cells::{Cell, Face as CellFace};
use crate::partition::{PartitionOptions, partition};
use crate::sew::Way as Lie;
use crate::validate::validate;
use crate::{CompileOptions, compile_building};

fn built(model: &Model) -> Building {
    let (partition, _) = partition(model, &PartitionOptions::default()).unwrap();
    Building::new(model, &partition).unwrap()
}

fn label(building: &Building, id: &str) -> Label {
    let found = building.elements.iter().position(|element| element.id == id);
    Label::Air(ElementId(found.unwrap_or_else(|| panic!("{id}")) as u32))
}

/// Every face's area by kind, every portal, all openings: as the generator has them.
fn check(name: &str, generated: &generate::Building) {
    let building = built(&generated.to_model().unwrap());
    let truth = generated.truth();
    // They are drawn on the lattice.
    let near = |found: f64, true_area: f64| (found - true_area).abs() <= 1e-9 * (1.0 + true_area);
    let openings = truth.openings.iter().map(|opening| &opening.air);
    let mut worst = 0.0f64;
    for air in truth.rooms.iter().map(|room| &room.air).chain(openings).chain([&truth.exterior]) {
        let found = building.areas(label(&building, &air.id));
        let names: BTreeMap<&'static str, f64> =
            found.iter().map(|(kind, area)| (kind.name(), *area)).collect();
        // The exterior as drawn ends where the open goes on, at portals, and on the ground, which is no matter.
        let is_matter = |kind: &&str| air.id != truth.exterior.id || ["FACADE", "ROOFING"].contains(kind);
        let kinds = |all: &BTreeMap<&'static str, f64>| -> Vec<&str> {
            all.keys().copied().filter(is_matter).collect()
        };
        assert_eq!(kinds(&names), kinds(&air.faces), "{name}: {}", air.name);
        for (kind, area) in air.faces.iter().filter(|(kind, _)| is_matter(kind)) {
            assert!(near(names[kind], *area), "{name}: {}: {kind} {} of {area}", air.name, names[kind]);
            worst = worst.max((names[kind] - area).abs());
        }
    }
    for opening in &truth.openings {
        let own = label(&building, &opening.air.id);
        let beyond: BTreeMap<Label, f64> =
            opening.joins.iter().map(|portal| (label(&building, &portal.id), portal.area)).collect();
        let found = building.neighbours(own);
        assert!(found.keys().eq(beyond.keys()), "{name}: {}", opening.air.name);
        assert!(found.iter().all(|(label, area)| near(*area, beyond[label])), "{name}: {found:?} {beyond:?}");
        let joined: Vec<Label> = beyond.into_keys().collect();
        if let [one, other] = joined[..] {
            let Label::Air(element) = own else { unreachable!() };
            assert!(building.openings_between(one, other).contains(&element), "{name}");
            assert!(building.openings_between(other, one).contains(&element), "{name}");
        }
    }
    assert_eq!(building.rooms().count(), truth.rooms.len(), "{name}");
    assert_eq!(building.openings().count(), truth.openings.len(), "{name}");
    println!("{name}: areas differ by {worst:.1e} m2");
}

fn plain(seed: u64) -> OfficeOptions {
    OfficeOptions { furniture: false, seed, ..OfficeOptions::default() }
}

fn bare() -> HouseOptions {
    HouseOptions { furniture: false, ..HouseOptions::default() }
}

#[test]
fn faces_of_a_house_are_as_drawn() {
    check("house", &house(&bare()));
}

#[test]
fn faces_of_an_office_are_as_drawn() {
    check("build1", &build1(&plain(0)));
}

#[test]
fn faces_of_a_larger_office_are_as_drawn() {
    check("build2", &build2(&plain(0)));
}

#[test]
fn faces_of_the_largest_office_are_as_drawn() {
    check("build3", &build3(&plain(0)));
}

#[test]
fn faces_of_a_tower_are_as_drawn() {
    check("tower", &tower(&TowerOptions { storeys: 3, office: plain(0) }));
}

#[test]
fn faces_of_random_buildings_are_as_drawn() {
    for seed in 0..6 {
        check(&format!("random {seed}"), &random(&plain(seed)));
    }
}

/// From every room to every other and back: no way is longer than another, none goes through a window or a wall, and each goes from
/// one neighbour to the next.
#[test]
fn ways_lead_from_room_to_room() {
    let building = built(&house(&bare()).to_model().unwrap());
    let rooms: Vec<Label> = building.rooms().map(Label::Air).collect();
    let (walked, any) = (WayOptions::default(), WayOptions { windows: true, ..WayOptions::default() });
    let inside = WayOptions { outside: false, ..WayOptions::default() };
    let mut length = BTreeMap::new();
    for &from in &rooms {
        for &to in &rooms {
            let way = building.way(from, to, &walked).unwrap();
            assert_eq!((way.through[0], *way.through.last().unwrap()), (from, to));
            assert_eq!(way.portals.len() + 1, way.through.len());
            for pair in way.through.windows(2) {
                assert!(building.neighbours(pair[0]).contains_key(&pair[1]));
                assert_ne!(building.semantic(pair[1]), Semantic::Window);
            }
            let middles: Vec<glam::DVec3> = way.portals.iter().map(|&p| p.into()).collect();
            let sum: f64 = middles.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
            assert!((sum - way.length).abs() <= 1e-9);
            let back = building.way(to, from, &walked).unwrap();
            assert!((back.length - way.length).abs() <= 1e-9);
            assert!(building.way(from, to, &any).unwrap().length <= way.length);
            if let Some(inner) = building.way(from, to, &inside) {
                assert!(inner.length >= way.length);
                assert!(inner.through.iter().all(|&label| building.semantic(label) != Semantic::Exterior));
            }
            length.insert((from, to), way.length);
        }
    }
    assert!(length.values().any(|&length| length > 1.0));
    // Into matter, and where there is nothing, no way leads.
    let wall = building.labels().find(|label| !label.is_air()).unwrap();
    assert_eq!(building.way(rooms[0], wall, &walked), None);
    assert_eq!(building.way(wall, wall, &walked), None);
    assert_eq!(building.way(rooms[0], Label::Air(ElementId(u32::MAX)), &walked), None);
}

#[test]
fn rooms_are_on_their_storeys() {
    let generated = tower(&TowerOptions { storeys: 3, office: plain(0) });
    let (building, truth) = (built(&generated.to_model().unwrap()), generated.truth());
    let mut storeys: Vec<&str> = truth.rooms.iter().filter_map(|room| room.storey.as_deref()).collect();
    storeys.sort_unstable();
    storeys.dedup();
    assert!(storeys.len() >= 3);
    for storey in storeys {
        let is_there = |room: &&generate::RoomTruth| room.storey.as_deref() == Some(storey);
        let mut ids: Vec<&str> = truth.rooms.iter().filter(is_there).map(|room| &room.air.id[..]).collect();
        let found = building.rooms_of_storey(storey).map(|room| &building.elements[room.0 as usize].id[..]);
        let mut found: Vec<&str> = found.collect();
        ids.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, ids, "{storey}");
    }
    assert_eq!(building.rooms_of_storey("no such storey").count(), 0);
}

#[test]
fn glass_is_a_pane_and_keeps_its_material() {
    let mut model = house(&bare()).to_model().unwrap();
    let wall = model.elements.iter().position(|element| element.semantic == Semantic::Wall).unwrap();
    let glass = crate::importers::Material { transmission: 0.9, ..Default::default() };
    model.materials.push(glass);
    let number = MaterialId(model.materials.len() as u32 - 1);
    model.elements[wall].mesh.materials.fill(number);
    let building = built(&model);
    let of_wall = |face: &&Face| face.element == Some(ElementId(wall as u32));
    let faces: Vec<&Face> = building.faces.iter().filter(of_wall).collect();
    assert!(!faces.is_empty());
    assert!(faces.iter().all(|face| face.kind == FaceKind::Pane && face.material == Some(number)));
    assert_eq!(building.faces.iter().filter(|face| face.kind == FaceKind::Pane).count(), faces.len());
}

/// The sides of a cell's footprint from its lowest corner on, each with what is beyond; made one where they lie on one line and have
/// the same beyond.
fn sections(partition: &Partition, cell: &Cell) -> Vec<(Point, Vec<CellFace>)> {
    let all = &partition.sections[cell.sections.start as usize..cell.sections.end as usize];
    let starts: Vec<Point> = all.iter().map(|section| section.start).collect();
    let count = starts.len();
    let faces = |i: usize| &partition.faces[all[i].faces.start as usize..all[i].faces.end as usize];
    let is_new = |i: usize| {
        let before = (i + count - 1) % count;
        orient(starts[before], starts[i], starts[(i + 1) % count]) != 0 || faces(before) != faces(i)
    };
    let mut kept: Vec<(Point, Vec<CellFace>)> =
        (0..count).filter(|&i| is_new(i)).map(|i| (starts[i], faces(i).to_vec())).collect();
    let first = (0..kept.len()).min_by_key(|&i| kept[i].0).unwrap();
    kept.rotate_left(first);
    kept
}

/// The cells that the map has are those that it was made of, but for parts of sides without height.
fn check_cells(name: &str, partition: &Partition, building: &Building) {
    let read = building.cells().unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(read.cells.len(), partition.cells.len());
    let mut thin = 0;
    for (number, (own, made)) in read.cells.iter().zip(&partition.cells).enumerate() {
        assert_eq!((own.label, own.floor, own.ceiling), (made.label, made.floor, made.ceiling), "{name}");
        let (a, b) = (sections(&read, own), sections(partition, made));
        if a != b {
            thin += 1;
            if thin < 4 {
                println!("  {name}: cell {number}\n    {a:?}\n    {b:?}");
            }
        }
        let covers = |partition: &Partition, range: &Range<u32>| {
            partition.covers[range.start as usize..range.end as usize].to_vec()
        };
        for (a, b) in [(&own.below, &made.below), (&own.above, &made.above)] {
            assert_eq!(covers(&read, a), covers(partition, b), "{name}: cell {number}");
        }
    }
    println!("{name}: {thin} of {} cells have parts of sides without height", partition.cells.len());
}

fn check_model(name: &str, model: &Model) {
    let (partition, _) = partition(model, &PartitionOptions::default()).unwrap();
    check_cells(name, &partition, &Building::new(model, &partition).unwrap());
}

#[test]
fn cells_are_read_off_the_map() {
    for seed in 0..6 {
        check_model(&format!("random {seed}"), &random(&plain(seed)).to_model().unwrap());
    }
    for seed in 0..12 {
        let style = Style::damage([0.1, 0.3, 0.7][seed as usize % 3], seed);
        check_model(&format!("damage {seed}"), &house(&bare()).export(&style).to_model().unwrap());
    }
}

#[test]
fn cells_of_real_buildings_are_read_off_the_map() {
    for (name, model) in crate::partition::testing::real_models() {
        check_model(&name, &model);
    }
}

/// Nothing in the map is decoration: with any one link gone or led elsewhere its cells are refused, or others.
#[test]
fn every_link_counts() {
    let model = house(&bare()).to_model().unwrap();
    let whole = built(&model);
    let cells = whole.cells().unwrap();
    let darts: Vec<Dart> = whole.topology.map.darts().collect();
    let mut random = crate::splitmix::SplitMix64::new(5);
    let (mut refused, mut changed) = ([0; 4], [0; 4]);
    for round in 0..800 {
        let i = round % 4;
        let mut building = whole.clone();
        let map = &mut building.topology.map;
        let [a, b] = [0, 1].map(|_| darts[random.below(darts.len() as u64) as usize]);
        let [c, d] = [a, b].map(|dart| map.alpha(i, dart));
        // The outside of the hull has no link to lose.
        if c == a || (round >= 400 && (d == b || b == a || b == c)) {
            continue;
        }
        map.unlink(i, a);
        if round >= 400 {
            map.unlink(i, b);
            map.link(i, a, b);
            map.link(i, c, d);
        }
        match building.cells() {
            Err(_) => refused[i] += 1,
            Ok(other) => {
                assert!(other != cells, "alpha {i} of {a:?}, {b:?}: nobody saw it");
                changed[i] += 1;
            }
        }
    }
    println!("refused {refused:?}, changed {changed:?}");
    assert!(refused.iter().all(|&count| count > 0));
}

/// What a building knows beside its links, changed in one place: either that is found, or the scene is another.
#[test]
fn every_attribute_counts() {
    type Change<'a> = &'a dyn Fn(&mut Building, usize);
    let model = house(&bare()).to_model().unwrap();
    let whole = built(&model);
    let compiled = |building: Building| {
        let valid = validate(building).0?;
        compile_building(&model, valid, &CompileOptions::default()).ok().map(|compiled| compiled.bytes)
    };
    let bytes = compiled(whole.clone()).unwrap();
    let changes: Vec<(&str, Change<'_>)> = vec![
        ("lattice origin", &|b, _| b.lattice.origin[0] += 1.0),
        ("lattice turn", &|b, _| b.lattice.turn = [0.8, 0.6]),
        ("lattice bits", &|b, _| b.lattice.bits -= 1),
        ("hull", &|b, i| b.hull[i % 2][i / 2 % 3] += 1),
        ("slope", &|b, i| at(&mut b.planes, i).p += 1 << 10),
        ("height", &|b, i| at(&mut b.planes, i).r += 1 << 24),
        ("vertex", &|b, i| *at(&mut b.topology.vertex_of, i) ^= 1),
        ("cell", &|b, i| *at(&mut b.topology.cell_of, i) ^= 1),
        ("point", &|b, i| at(&mut b.topology.points, i)[i % 3] += 1.0),
        ("first side", &|b, i| at(&mut b.topology.faces, i).one ^= 1),
        ("other side", &|b, i| at(&mut b.topology.faces, i).other ^= 1),
        ("face's dart", &|b, i| {
            let dart = at(&mut b.topology.faces, i + 1).dart;
            at(&mut b.topology.faces, i).dart = dart;
        }),
        ("way", &|b, i| match &mut at(&mut b.topology.faces, i).way {
            Lie::Ceiling(plane) | Lie::Floor(plane) => *plane ^= 1,
            Lie::Upright(ends) => ends[0].x += 1,
        }),
        ("surface", &|b, i| {
            let source = &mut at(&mut b.topology.faces, i).sources[i % 2];
            *source = source.wrapping_add(1);
        }),
        ("label", &|b, i| {
            let label = at(&mut b.volumes, i + 1).label;
            let own = &mut at(&mut b.volumes, i).label;
            *own = if *own == label { Label::Void } else { label };
        }),
        ("floor", &|b, i| at(&mut b.volumes, i).floor ^= 1),
        ("ceiling", &|b, i| at(&mut b.volumes, i).ceiling ^= 1),
        ("footprint", &|b, i| at(&mut b.volumes, i).footprint.start += 1),
        ("volume's dart", &|b, i| {
            let dart = at(&mut b.volumes, i + 1).dart;
            at(&mut b.volumes, i).dart = dart;
        }),
        ("corner", &|b, i| at(&mut b.footprints, i).x += 1),
        ("kind", &|b, i| {
            let kind = &mut at(&mut b.faces, i).kind;
            *kind = next(*kind);
        }),
        ("element", &|b, i| {
            let element = &mut at(&mut b.faces, i).element;
            *element = Some(ElementId(element.map_or(0, |element| element.0 ^ 1)));
        }),
        ("material", &|b, i| {
            let material = &mut at(&mut b.faces, i).material;
            *material = Some(MaterialId(material.map_or(0, |material| material.0 ^ 1)));
        }),
        ("area", &|b, i| at(&mut b.faces, i).area += 1e-6),
        ("triangle", &|b, i| at(&mut b.sources, i).triangles[0].1 ^= 1),
        ("plane of triangles", &|b, i| {
            let plane = &mut at(&mut b.sources, i).plane;
            *plane = plane.map_or(Some(0), |_| None);
        }),
        ("detail", &|b, i| at(&mut b.detail, i).1 ^= 1),
        ("meaning", &|b, i| at(&mut b.elements, i).semantic = Semantic::Annotation),
        ("name", &|b, i| at(&mut b.elements, i).name.push('x')),
    ];
    let mut random = crate::splitmix::SplitMix64::new(8);
    for (what, change) in changes {
        let (mut refused, mut changed) = (0, 0);
        for _ in 0..6 {
            let mut building = whole.clone();
            change(&mut building, random.below(1 << 30) as usize);
            if building == whole {
                continue;
            }
            match compiled(building) {
                None => refused += 1,
                Some(other) => {
                    // What rays cannot meet at a face is not kept.
                    let may_be_dropped = ["surface", "triangle", "plane of triangles"].contains(&what);
                    assert!(other != bytes || may_be_dropped, "{what}: nobody saw it");
                    changed += u32::from(other != bytes);
                }
            }
        }
        println!("{what}: refused {refused}, changed {changed}");
        assert!(refused + changed > 0, "{what}");
    }
}

/// Another kind.
fn next(kind: FaceKind) -> FaceKind {
    FaceKind::from_number(64 + (kind.number() - 63) % 12).unwrap()
}

/// One of some, the number of which is taken around.
fn at<T>(items: &mut [T], i: usize) -> &mut T {
    let count = items.len();
    &mut items[i % count]
}
