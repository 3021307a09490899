use enfilade_importers::Semantic;

use super::*;
use crate::building::FaceKind;
use crate::generate::{HouseOptions, OfficeOptions, TowerOptions, build1, build2, house, random, tower};
use crate::importers::Model;
use crate::lattice::FINE;
use crate::oracle::fixtures::{Shape, model};
use crate::partition::cells::{Label, NONE};
use crate::partition::{PartitionOptions, partition};
use crate::sew::Way;

fn built(model: &Model) -> Building {
    let (partition, _) = partition(model, &PartitionOptions::default()).unwrap();
    Building::new(model, &partition).unwrap()
}

fn plain(seed: u64) -> OfficeOptions {
    OfficeOptions { furniture: false, seed, ..OfficeOptions::default() }
}

fn clean(name: &str, model: &Model) {
    let (valid, report) = validate(built(model));
    assert_eq!(report.findings, [], "{name}");
    assert!(valid.is_some(), "{name}");
}

#[test]
fn generated_buildings_have_nothing_wrong() {
    let bare = HouseOptions { furniture: false, ..HouseOptions::default() };
    clean("house", &house(&bare).to_model().unwrap());
    clean("build1", &build1(&plain(0)).to_model().unwrap());
    clean("build2", &build2(&plain(0)).to_model().unwrap());
    clean("tower", &tower(&TowerOptions { storeys: 3, office: plain(0) }).to_model().unwrap());
    for seed in 0..6 {
        clean(&format!("random {seed}"), &random(&plain(seed)).to_model().unwrap());
    }
}

#[test]
fn codes_have_names() {
    for code in Code::ALL {
        assert_eq!(Code::from_name(&code.name().to_lowercase()), Some(code));
        assert_eq!(format!("{code:?}"), code.name());
        assert!(!code.title().is_empty());
    }
    assert_eq!(Code::from_name("X99"), None);
}

type Box3 = (Semantic, [f64; 3], [f64; 3]);

/// A room of 4 by 3 by 2.5 m with walls 0.2 m thick, and a hole of 1 by 2 m in one of them, filled as `hole` says.
fn room(hole: &[Box3], has_ceiling: bool) -> Building {
    let mut boxes: Vec<Box3> = vec![
        (Semantic::Room, [0.0, 0.0, 0.0], [4.0, 3.0, 2.5]),
        (Semantic::Ground, [-0.2, -0.2, -0.3], [4.2, 3.2, 0.0]),
        (Semantic::Wall, [-0.2, 3.0, 0.0], [4.2, 3.2, 2.5]),
        (Semantic::Wall, [-0.2, 0.0, 0.0], [0.0, 3.0, 2.5]),
        (Semantic::Wall, [4.0, 0.0, 0.0], [4.2, 3.0, 2.5]),
        (Semantic::Wall, [-0.2, -0.2, 0.0], [1.0, 0.0, 2.5]),
        (Semantic::Wall, [2.0, -0.2, 0.0], [4.2, 0.0, 2.5]),
        (Semantic::Wall, [1.0, -0.2, 2.0], [2.0, 0.0, 2.5]),
    ];
    if has_ceiling {
        boxes.push((Semantic::Ground, [-0.2, -0.2, 2.5], [4.2, 3.2, 2.8]));
    }
    boxes.extend(hole);
    let shapes: Vec<_> = boxes.into_iter().map(|(tag, lo, hi)| (tag, Shape::cuboid(lo, hi))).collect();
    built(&model(&shapes))
}

const INNER: [[f64; 3]; 2] = [[1.0, -0.1, 0.0], [2.0, 0.0, 2.0]];
const OUTER: [[f64; 3]; 2] = [[1.0, -0.2, 0.0], [2.0, -0.1, 2.0]];
const HOLE: [[f64; 3]; 2] = [OUTER[0], INNER[1]];

fn codes(building: Building) -> Vec<Code> {
    let (valid, report) = validate(building);
    assert_eq!(valid.is_some(), !report.is_fatal());
    report.findings.iter().map(|finding| finding.code).collect()
}

fn filled(tag: Semantic, [lo, hi]: [[f64; 3]; 2]) -> Box3 {
    (tag, lo, hi)
}

#[test]
fn openings_join_two() {
    assert_eq!(codes(room(&[filled(Semantic::Door, HOLE)], true)), []);
    let half = [filled(Semantic::Door, INNER), filled(Semantic::Wall, OUTER)];
    let (_, report) = validate(room(&half, true));
    let [finding] = &report.findings[..] else { panic!("{report:?}") };
    assert_eq!((finding.code, finding.element), (Code::S01, Some(ElementId(9))));
    // Of the door's two sides one is open.
    assert!((finding.size - 2.0).abs() < 1e-3, "{finding:?}");
    assert!((0.9..2.1).contains(&finding.at[0]) && finding.at[1].abs() < 0.11, "{finding:?}");
}

#[test]
fn leaks_are_shown() {
    for hole in [vec![], vec![filled(Semantic::Wall, [[1.0, -0.2, 0.0], [2.0, 0.0, 1.9]])]] {
        let (_, report) = validate(room(&hole, true));
        let [finding] = &report.findings[..] else { panic!("{report:?}") };
        assert_eq!((finding.code, finding.chain.len()), (Code::S02, 2));
        let area = if hole.is_empty() { 2.0 } else { 0.1 };
        assert!((finding.size - area).abs() < 1e-3, "{finding:?}");
    }
    // A hole whose half is a door leaks no more.
    assert_eq!(codes(room(&[filled(Semantic::Window, OUTER)], true)), []);
}

#[test]
fn rooms_have_floors_and_ceilings() {
    let door = [filled(Semantic::Door, HOLE)];
    assert_eq!(codes(room(&door, false)), [Code::S02, Code::S03]);
}

#[test]
fn rooms_have_ways_out() {
    assert_eq!(codes(room(&[filled(Semantic::Wall, HOLE)], true)), [Code::S04]);
    assert_eq!(codes(room(&[filled(Semantic::Window, HOLE)], true)), []);
}

/// What breaks the map or its places is told by its code; what nearly does is not.
#[test]
fn what_is_broken_is_told() {
    let mut boxes = vec![filled(Semantic::Door, HOLE)];
    // Around a column air is a ring, but no volume of it is.
    boxes.push((Semantic::Column, [2.0, 1.0, 0.0], [2.3, 1.3, 2.5]));
    let whole = room(&boxes, true);
    let broken = |change: &dyn Fn(&mut Building)| {
        let mut building = whole.clone();
        change(&mut building);
        let mut codes = codes(building);
        codes.dedup();
        codes
    };
    assert_eq!(broken(&|_| ()), []);
    let place = whole.topology.faces.iter().position(|face| face.other != NONE).unwrap();
    let face = whole.topology.faces[place];
    let beyond = whole.topology.map.alpha(3, face.dart);

    // What leads to itself is an involution, what does not lead back is none.
    assert_eq!(broken(&|b| b.topology.map.break_alpha(3, face.dart, face.dart)), [Code::T01, Code::T02]);
    let hull = whole.topology.faces.iter().find(|face| face.other == NONE).unwrap();
    assert_eq!(broken(&|b| b.topology.map.break_alpha(3, hull.dart, hull.dart)), []);

    // A link of one dart, and of all of a face.
    assert_eq!(broken(&|b| b.topology.map.unlink(3, face.dart)), [Code::T02]);
    let unsewn = |i: usize| broken(&|b| assert!(b.topology.map.unsew(i, face.dart).is_ok()));
    assert_eq!(unsewn(3), [Code::T06]);
    assert_eq!(unsewn(2), [Code::T03]);

    // Two edges of a volume, sewn crosswise: its surface is no longer one of a ball.
    let crossed = broken(&|b| {
        let map = &mut b.topology.map;
        let far = map.walk(face.dart, &[0, 1, 0, 1]);
        let others = [face.dart, far].map(|dart| map.alpha(2, dart));
        for dart in [face.dart, far] {
            map.unsew(2, dart).unwrap();
        }
        map.sew(2, face.dart, far).unwrap();
        map.sew(2, others[0], others[1]).unwrap();
    });
    assert!(crossed.contains(&Code::T04), "{crossed:?}");

    // A volume twice; the order of volumes does not matter to the map.
    assert_eq!(broken(&|b| b.volumes.push(b.volumes[0].clone())), [Code::T05]);

    // A dart of another volume, and another dart of the same side of a face.
    assert_eq!(broken(&|b| b.topology.cell_of[face.dart.index()] = face.other), [Code::T07]);
    assert_eq!(broken(&|b| b.topology.faces[place].dart = beyond), [Code::T07]);
    assert_eq!(broken(&|b| b.volumes.truncate(b.volumes.len() - 1)), [Code::T07]);
    let next = whole.topology.map.walk(face.dart, &[0, 1]);
    assert_eq!(broken(&|b| b.topology.faces[place].dart = next), []);

    // Corners that change places; corners from another one on.
    let corners = whole.volumes[0].footprint.clone();
    let [a, b] = [corners.start as usize, corners.start as usize + 1];
    assert_eq!(broken(&|building| building.footprints.swap(a, b)), [Code::G01]);
    assert_eq!(broken(&|building| building.footprints[a..corners.end as usize].rotate_left(1)), []);

    // Convex, but not where the map has its corners.
    assert_eq!(broken(&|building| building.footprints[a].x -= 1), [Code::G02]);
    assert_eq!(broken(&|b| b.volumes[0].floor = b.volumes[0].ceiling), [Code::G02]);
    assert_eq!(broken(&|b| b.lattice.bits = 60), [Code::G02]);

    assert_eq!(broken(&|b| b.hull[1][0] += 1), [Code::G03]);

    // A plane that is moved takes no vertices along; the hull's own would be none of the hull's.
    let of_hull = |plane: u32| {
        let ways = [Way::Ceiling(plane), Way::Floor(plane)];
        whole.topology.faces.iter().any(|face| face.other == NONE && ways.contains(&face.way))
    };
    let inner = (0..whole.planes.len() as u32).find(|plane| !of_hull(*plane)).unwrap() as usize;
    assert_eq!(broken(&|b| b.planes[inner].r += FINE), [Code::G04]);
    assert_eq!(broken(&|b| b.planes[inner].r += FINE / 10_000), []);
    assert_eq!(broken(&|b| b.topology.points[0][2] += 0.5)[0], Code::G04);

    assert_eq!(broken(&|b| b.faces[place].area += 1e-6), [Code::G05]);
    assert_eq!(broken(&|b| b.faces[place].area += 1e-12), []);

    // Any material may be glass: only the model knows.
    let wall = whole.faces.iter().position(|face| face.kind == FaceKind::Wallpaper).unwrap();
    assert_eq!(broken(&|b| b.faces[wall].kind = FaceKind::Facade), [Code::S05]);
    assert_eq!(broken(&|b| b.faces[wall].kind = FaceKind::Pane), []);
    assert_eq!(broken(&|b| b.faces[wall].element = None), []);
    assert_eq!(broken(&|b| b.faces[wall].element = Some(ElementId(0))), [Code::S05]);
}

/// The room has a niche that no label names; so has another, which stands in the open. These two have nothing to do with each other.
#[test]
fn voids_are_apart() {
    let niche = filled(Semantic::Wall, OUTER);
    assert_eq!(codes(room(&[niche], true)), [Code::S04]);
    let wall = |lo, hi| (Semantic::Wall, lo, hi);
    let other = [
        niche,
        (Semantic::Room, [6.0, 0.0, 0.0], [8.0, 3.0, 2.5]),
        wall([8.0, 0.8, 0.8], [9.2, 1.0, 2.2]),
        wall([8.0, 2.0, 0.8], [9.2, 2.2, 2.2]),
        wall([8.0, 1.0, 0.8], [9.2, 2.0, 1.0]),
        wall([8.0, 1.0, 2.0], [9.2, 2.0, 2.2]),
        wall([9.0, 1.0, 1.0], [9.2, 2.0, 2.0]),
    ];
    let building = room(&other, true);
    assert_eq!(building.volumes_of(Label::Void).len(), 2);
    let (_, report) = validate(building);
    let found: Vec<(Code, u32)> = report.findings.iter().map(|f| (f.code, f.element.unwrap().0)).collect();
    assert_eq!(found, [(Code::S02, 10), (Code::S03, 10), (Code::S04, 0)]);
}
