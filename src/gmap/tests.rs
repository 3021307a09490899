use proptest::prelude::*;

use super::*;
use crate::arbitrary::{Outcome, Step, maps, steps};

/// A prism, its map and its darts.
fn prism(sides: usize) -> (GMap, Vec<Dart>) {
    let mut map = GMap::new();
    let darts = map.add_prism(sides);
    (map, darts)
}

/// Two boxes with a face in common.
fn two_boxes() -> (GMap, Vec<Dart>, Vec<Dart>) {
    let mut map = GMap::new();
    let (a, b) = (map.add_prism(4), map.add_prism(4));
    // The first side of one is the first side of the other, seen from beyond: the other way round.
    let other = map.alpha(0, b[1]);
    assert_eq!(map.sew(3, a[1], other), Ok(8));
    (map, a, b)
}

/// Vertices, edges, faces, volumes.
fn counts(map: &GMap) -> [usize; 4] {
    Orbit::CELLS.map(|orbit| map.count(orbit))
}

#[test]
fn a_prism_is_a_ball() {
    for sides in 3..9 {
        let (map, darts) = prism(sides);
        assert_eq!(map.check(), Ok(()));
        assert_eq!(map.len(), 12 * sides);
        assert_eq!(counts(&map), [2 * sides, 3 * sides, sides + 2, 1]);
        assert_eq!(map.euler(), 1);
        let shape = map.shape(darts[0]);
        assert!(shape.is_ball(), "{shape:?}");
        assert_eq!((shape.vertices, shape.edges, shape.faces), (2 * sides, 3 * sides, sides + 2));
        assert!((0..3).all(|i| map.free(i).next().is_none()));
        assert_eq!(map.free(3).count(), map.len());
        // The upper face lies over the lower one: three edges from corner to corner.
        let over = map.walk(darts[0], &[2, 1, 0, 1, 2]);
        assert_eq!(over, darts[sides + 1]);
        assert_eq!(map.around_face(darts[0]).count(), sides);
        assert_eq!(map.orbit(Orbit::HalfFace, darts[0]).len(), 2 * sides);
        let even = map.orientation(Orbit::Volume, darts[0]).unwrap();
        assert_eq!(even.len(), map.len() / 2);
    }
}

#[test]
fn sewing_glues_whole_faces_and_unsewing_takes_them_apart() {
    let (mut map, a, b) = two_boxes();
    assert_eq!(map.check(), Ok(()));
    assert_eq!(counts(&map), [12, 20, 11, 2]);
    assert_eq!(map.count(Orbit::Component), 1);
    assert!(map.is_same(Orbit::Face, a[1], b[1]) && !map.is_same(Orbit::Volume, a[1], b[1]));
    assert!(map.orientation(Orbit::Component, a[0]).is_some());
    assert_eq!(map.unsew(3, a[1]), Ok(8));
    assert_eq!((map.check(), counts(&map)), (Ok(()), [16, 24, 12, 2]));
    assert_eq!(map.unsew(3, a[1]), Ok(0));
}

#[test]
fn what_does_not_fit_is_not_sewn() {
    let mut map = GMap::new();
    let (a, b) = (map.add_prism(4), map.add_prism(3));
    let before = map.clone();
    // Four edges on three.
    let error = map.sew(3, a[0], b[0]).unwrap_err();
    assert!(matches!(error, SewError::Different { involution: 0 | 1, .. }), "{error}");
    assert_eq!(map.sew(3, a[0], a[0]), Err(SewError::Itself(a[0], 3)));
    // A face folded onto itself.
    let beside = map.alpha(1, a[0]);
    assert!(matches!(map.sew(3, a[0], beside), Err(SewError::Itself(_, 3))));
    let error = map.sew(2, a[0], b[0]).unwrap_err();
    assert_eq!(error, SewError::NotFree { dart: a[0], involution: 2, other: map.alpha(2, a[0]) });
    assert!(error.to_string().contains("alpha 2"), "{error}");
    assert_eq!(map.sew(4, a[0], b[0]), Err(SewError::NoInvolution(4)));
    let stranger = Dart(1000);
    assert_eq!(map.sew(3, stranger, b[0]), Err(SewError::Unknown(stranger)));
    assert_eq!(map, before);
    // Checked, then done.
    let sewing = map.check_sew(3, a[1], b[1]).unwrap();
    assert_eq!((map == before, sewing.pairs().len(), sewing.involution()), (true, 8, 3));
    map.commit(&sewing);
    assert_eq!(map.alpha(3, a[1]), b[1]);
}

#[test]
fn links_alone_may_break_a_map_and_checks_say_where() {
    let (mut map, a, b) = two_boxes();
    map.unlink(3, a[1]);
    let defects: Vec<Defect> = map.defects().collect();
    // Its neighbours in the face by alpha 0 and 1, those beyond, and the two themselves from either end.
    assert!(defects.iter().all(|d| matches!(d, Defect::NotGlued { second: 3, .. })), "{defects:?}");
    assert!(!defects.is_empty() && map.check().is_err());
    map.link(3, a[1], map.alpha(0, b[1]));
    assert_eq!(map.check(), Ok(()));
    map.alpha[2][a[0].index()] = b[0].0;
    assert!(matches!(map.check(), Err(Defect::NotAnInvolution { involution: 2, .. })));
}

#[test]
fn a_face_that_is_removed_makes_one_volume_of_two() {
    let (mut map, a, _) = two_boxes();
    assert_eq!(map.remove(2, a[1]), Ok(16));
    assert_eq!(map.check(), Ok(()));
    assert_eq!(counts(&map), [12, 20, 10, 1]);
    let shape = map.shape(a[0]);
    assert!(shape.is_ball(), "{shape:?}");
    assert!(!map.contains(a[1]));
    // Edges between coplanar faces go next, then vertices: a box is left.
    let seam = [map.walk(a[0], &[]), a[5]];
    assert!(seam.iter().all(|&d| map.contains(d)));
    let mut edges = Vec::new();
    for edge in map.index(Orbit::Edge).darts() {
        // Of the removed face's four edges each now lies between two faces that were coplanar.
        let vertices = [*edge, map.alpha(0, *edge)].map(|d| map.orbit(Orbit::VertexOfVolume, d).len() / 2);
        if vertices == [4, 4] {
            edges.push(*edge);
        }
    }
    assert_eq!(edges.len(), 4);
    for edge in edges {
        map.remove(1, edge).unwrap();
    }
    assert_eq!((map.check(), counts(&map)), (Ok(()), [12, 16, 6, 1]));
    let corners: Vec<Dart> = map.index(Orbit::Vertex).darts().to_vec();
    let between: Vec<Dart> =
        corners.into_iter().filter(|&d| map.orbit(Orbit::VertexOfVolume, d).len() == 4).collect();
    assert_eq!(between.len(), 4);
    for corner in between {
        map.remove(0, corner).unwrap();
    }
    assert_eq!((map.check(), counts(&map)), (Ok(()), [8, 12, 6, 1]));
    let any = map.darts().next().unwrap();
    assert!(map.shape(any).is_ball());
}

#[test]
fn crowded_cells_stay() {
    let (mut map, a, _) = two_boxes();
    let before = map.clone();
    // A corner of a box has three edges, and an edge of the face in common four faces.
    assert!(matches!(map.remove(0, a[0]), Err(EditError::Crowded { first: 1, second: 2, .. })));
    assert!(matches!(map.remove(1, a[1]), Err(EditError::Crowded { first: 2, second: 3, .. })));
    assert_eq!(map.remove(3, a[0]), Err(EditError::Dimension(3)));
    assert_eq!(map, before);
}

#[test]
fn what_is_inserted_can_be_removed() {
    let (map, a, _) = two_boxes();
    let mut split = map.clone();
    let vertex = split.insert_vertex(a[1]).unwrap();
    assert_eq!((split.check(), counts(&split)), (Ok(()), [13, 21, 11, 2]));
    split.remove(0, vertex).unwrap();
    assert_eq!(counts(&split), counts(&map));
    assert!(map.darts().all(|d| (0..4).all(|i| split.alpha(i, d) == map.alpha(i, d))));

    let mut split = map.clone();
    let opposite = split.walk(a[1], &[0, 1, 0]);
    let edge = split.insert_edge(a[1], opposite).unwrap();
    assert_eq!((split.check(), counts(&split)), (Ok(()), [12, 21, 12, 2]));
    assert_eq!(split.alpha(1, a[1]), edge);
    split.remove(1, edge).unwrap();
    assert!(map.darts().all(|d| (0..4).all(|i| split.alpha(i, d) == map.alpha(i, d))));
    // Not twice from one corner, nor to the same corner's other side, nor into another face.
    for other in [a[1], map.alpha(1, a[1]), a[0]] {
        assert_eq!(split.insert_edge(a[1], other), Err(EditError::NotCorners(a[1], other)));
    }

    // A box cut at half its height: new vertices on the rising edges, edges between them, a face.
    let (map, darts) = prism(4);
    let mut split = map.clone();
    let middles: Vec<Dart> = (1..5)
        .map(|k| {
            let rising = split.walk(darts[k], &[1]);
            split.insert_vertex(rising).unwrap()
        })
        .collect();
    let mut path = Vec::new();
    for k in 0..4 {
        // From the middle of this wall's start, upper side, to that of its end.
        let here = split.alpha(1, middles[k]);
        let there = split.walk(here, &[0, 1, 0, 1, 0]);
        let edge = split.insert_edge(split.alpha(1, here), split.alpha(1, there)).unwrap();
        path.push(edge);
    }
    assert_eq!((split.check(), counts(&split)), (Ok(()), [12, 20, 10, 1]));
    let face = split.insert_face(&path).unwrap();
    assert_eq!((split.check(), counts(&split)), (Ok(()), [12, 20, 11, 2]));
    assert!(split.shape(face).is_ball() && split.shape(split.alpha(3, face)).is_ball());
    split.remove(2, face).unwrap();
    assert_eq!((split.check(), counts(&split)), (Ok(()), [12, 20, 10, 1]));
}

#[test]
fn paths_that_are_none_are_refused() {
    let (mut map, darts) = prism(4);
    let before = map.clone();
    assert_eq!(map.insert_face(&[]), Err(EditError::NoPath));
    let [first, opposite] = [darts[1], darts[3]];
    assert_eq!(map.insert_face(&[first, opposite]), Err(EditError::NotAPath(first, opposite)));
    let other = map.alpha(2, first);
    assert!(matches!(map.insert_face(&[first, other]), Err(EditError::Twice(_))));
    assert_eq!(map, before);
}

#[test]
fn open_faces_are_not_split_across_their_gap() {
    let mut map = GMap::new();
    let face = map.add_face(4);
    map.unsew(1, face).unwrap();
    let before = map.clone();
    let corners: Vec<Dart> = map.darts().collect();
    for &a in &corners {
        for &b in &corners {
            let mut split = map.clone();
            match split.insert_edge(a, b) {
                Ok(_) => {
                    assert!(split.orientation(Orbit::Component, face).is_some(), "{a} {b}");
                    assert_eq!(split.count(Orbit::HalfFace), 2, "{a} {b}");
                }
                Err(_) => assert!(split == before),
            }
        }
    }
    // Half an edge: from one of its corners no way leads on.
    map.unsew(0, corners[3]).unwrap();
    for &b in &corners {
        assert!(map.clone().insert_edge(corners[1], b).is_err(), "{b}");
    }
}

#[test]
#[should_panic(expected = "was sewn since")]
fn what_was_sewn_meanwhile_is_not_torn_apart() {
    let mut map = GMap::new();
    let (a, b, c) = (map.add_prism(4), map.add_prism(4), map.add_prism(4));
    let sewing = map.check_sew(3, a[1], b[1]).unwrap();
    map.sew(3, a[1], c[1]).unwrap();
    map.commit(&sewing);
}

/// Whether the two ends of a dart's edge are one.
fn is_folded(map: &GMap, dart: Dart) -> bool {
    let mut seen = vec![dart];
    let mut next = 0;
    while let Some(&dart) = seen.get(next) {
        for i in [2, 3] {
            let other = map.alpha(i, dart);
            if !seen.contains(&other) {
                seen.push(other);
            }
        }
        next += 1;
    }
    seen.contains(&map.alpha(0, dart))
}

/// Whether a dart's half of a face is glued to itself: folded along a line through two of its corners, or through edges.
fn is_face_folded(map: &GMap, dart: Dart) -> bool {
    let other = map.alpha(3, dart);
    other != dart && map.orbit(Orbit::HalfFace, dart).contains(&other)
}

/// Two parts that it makes are one, glued to each other: there is an edge more, and no face.
#[test]
fn an_edge_along_the_fold_of_a_face_parts_nothing() {
    let mut map = GMap::new();
    map.add_prism(4);
    let steps = [Step::Vertex(370_322), Step::Sew(3, 548_455, 124_682), Step::Remove(2, 427_750)];
    for step in steps.into_iter().chain([Step::Remove(1, 109_298)]) {
        assert!(!matches!(step.apply(&mut map), Outcome::Refused));
    }
    let before = map.clone();
    assert!(map.darts().any(|d| is_face_folded(&map, d)) && !map.darts().any(|d| is_folded(&map, d)));
    let Outcome::Inserted(1, edge) = Step::Edge(296_294, 126_106).apply(&mut map) else { panic!("refused") };
    assert_eq!((map.check(), map.euler()), (Ok(()), before.euler() - 1));
    map.remove(1, edge).unwrap();
    assert!(map.darts().all(|d| (0..4).all(|i| map.alpha(i, d) == before.alpha(i, d))));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// After whatever steps, refused or done, the map is one; refused ones change nothing; what is inserted leaves the Euler
    /// characteristic as it was, and can be removed again.
    #[test]
    fn maps_stay_maps(steps in prop::collection::vec(steps(), 1..40)) {
        let mut map = GMap::new();
        map.add_prism(4);
        for step in steps {
            if map.is_empty() {
                map.add_prism(3);
                continue;
            }
            let before = map.clone();
            // What is glued to itself may have edges that are folded in the middle, of which half an edge is left, and faces: an edge along the fold
            // makes two faces of one that are one again.
            let is_folded = map.darts().any(|d| is_folded(&map, d));
            let has_folds = is_folded || map.darts().any(|d| is_face_folded(&map, d));
            match step.apply(&mut map) {
                Outcome::Refused => {
                    prop_assert!(map == before, "{:?} was refused and changed the map", step);
                }
                Outcome::Done => match step {
                    Step::Prism(_) => prop_assert_eq!(map.euler(), before.euler() + 1),
                    Step::Remove(..) => prop_assert!(map.len() < before.len()),
                    _ => prop_assert_eq!(map.len(), before.len()),
                },
                Outcome::Inserted(dimension, new) => {
                    prop_assert!(has_folds || map.euler() == before.euler());
                    // And back. A vertex in a folded edge is not between two edges.
                    let mut again = map.clone();
                    if dimension > 0 || !is_folded {
                        prop_assert_eq!(again.remove(dimension, new), Ok(map.len() - before.len()));
                        prop_assert!(before.darts().all(|d| (0..4).all(|i| again.alpha(i, d) == before.alpha(i, d))));
                    }
                }
            }
            prop_assert_eq!(map.check(), Ok(()), "after {:?}", step);
            let alone: Vec<_> = map.index(Orbit::Volume).darts().iter().map(|&d| (d, map.shape(d))).collect();
            prop_assert_eq!(map.shapes(), alone);
            prop_assert_eq!(map.darts().count(), map.len());
        }
    }

    /// As those of the library's users.
    #[test]
    fn arbitrary_maps_are_maps(map in maps()) {
        prop_assert_eq!(map.check(), Ok(()));
    }
}
