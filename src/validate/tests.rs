use enfilade_importers::Semantic;

use super::*;
use crate::generate::{HouseOptions, OfficeOptions, TowerOptions, build1, house, random, tower};
use crate::importers::Model;
use crate::lattice::FINE;
use crate::oracle::fixtures::{Shape, model};
use crate::partition::cells::Label;
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

#[test]
fn what_the_map_breaks_is_told() {
    let whole = room(&[filled(Semantic::Door, HOLE)], true);
    let first =
        |building: &Building| building.topology.faces.iter().position(|face| face.other != u32::MAX).unwrap();
    let broken = |change: &dyn Fn(&mut Building)| {
        let mut building = whole.clone();
        change(&mut building);
        codes(building)
    };
    let face = whole.topology.faces[first(&whole)];
    assert_eq!(broken(&|_| ()), []);
    assert!(broken(&|b| b.topology.map.unlink(1, face.dart)).contains(&Code::T02));
    assert!(broken(&|b| b.topology.map.unlink(1, face.dart)).contains(&Code::T03));
    assert_eq!(
        broken(&|b| {
            b.topology.map.unsew(3, face.dart).unwrap();
        }),
        [Code::T06]
    );
    assert!(
        broken(&|b| {
            b.topology.map.unsew(2, face.dart).unwrap();
        })
        .contains(&Code::T03)
    );
    // A volume that is not known.
    assert!(broken(&|b| b.volumes.truncate(b.volumes.len() - 1)).contains(&Code::T05));
    let corners = whole.volumes[0].footprint.clone();
    let [a, b] = [corners.start as usize, corners.start as usize + 1];
    assert_eq!(broken(&|building| building.footprints.swap(a, b)), [Code::G01]);
    // Convex, but not where the map has its corners.
    assert_eq!(broken(&|building| building.footprints[a].x -= 1), [Code::G02]);
    let floor = whole.volumes[0].floor;
    assert_eq!(broken(&|b| b.volumes[0].floor = b.volumes[0].ceiling), [Code::G02]);
    // A plane that is moved by a step takes no vertices along; the hull's own would be none of the hull's.
    let inner = (0..whole.planes.len() as u32).find(|plane| {
        *plane != floor
            && whole
                .topology
                .faces
                .iter()
                .all(|face| face.other != u32::MAX || face.way != Way::Ceiling(*plane))
    });
    let inner = inner.unwrap() as usize;
    assert_eq!(broken(&|b| b.planes[inner].r += FINE), [Code::G04]);
    assert_eq!(broken(&|b| b.planes[inner].r += FINE / 10_000), []);
    assert!(broken(&|b| b.topology.points[0][2] += 0.5).contains(&Code::G04));
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
