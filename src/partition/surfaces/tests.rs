use proptest::prelude::*;

use super::*;
use crate::lattice::Plane;
use crate::partition::cells::Cell;
use crate::partition::testing::*;

fn run(partition: &mut Partition, matter: &[MatterTriangle]) -> SurfaceReport {
    attach(partition, matter, &SurfaceOptions::default(), &Account::new(u64::MAX), &Watch::default())
}

fn scaled(corners: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    corners.map(|p| p.map(|c| c * METRE))
}

/// Two triangles of a quadrilateral, metres.
fn quad(corners: [[f64; 3]; 4]) -> Vec<[[f64; 3]; 3]> {
    let [a, b, c, d] = corners;
    vec![scaled([a, b, c]), scaled([a, c, d])]
}

/// All sources of what lies between two cells, seen from the first.
fn between(partition: &Partition, from: usize, to: usize) -> Vec<u32> {
    let Cell { sections, below, above, .. } = &partition.cells[from];
    let sections = &partition.sections[sections.start as usize..sections.end as usize];
    let faces = sections.iter().flat_map(|s| s.faces.clone()).map(|f| partition.faces[f as usize].cover);
    let covers = below.clone().chain(above.clone()).map(|c| partition.covers[c as usize]);
    faces.chain(covers).filter(|c| c.cell == to as u32).map(|c| c.source).collect()
}

fn cell_at(partition: &Partition, metres: [f64; 3]) -> usize {
    let p = DVec3::from(metres) * METRE;
    partition.cells.iter().position(|cell| is_in(partition, cell, p)).unwrap()
}

fn names(partition: &Partition, source: u32) -> &[(ElementId, u32)] {
    &partition.sources[source as usize].triangles
}

/// A room of 5 m x 4 m with walls of 30 cm, two of them 3 m high, and a door hole in the wall to the south; all authored as
/// overlapping boxes of which the floor lies under all walls.
fn room() -> (Stacks, Vec<MatterTriangle>) {
    let boxes = [
        ([-0.3, -0.3, -0.2], [5.3, 4.3, 0.0]), // floor
        ([-0.3, -0.3, 2.8], [5.3, 4.3, 3.0]),  // ceiling
        ([-0.3, -0.3, 0.0], [0.0, 4.3, 2.8]),  // west
        ([5.0, -0.3, 0.0], [5.3, 4.3, 2.8]),   // east
        ([-0.3, 4.0, 0.0], [5.3, 4.3, 2.8]),   // north
        ([-0.3, -0.3, 0.0], [2.0, 0.0, 2.8]),  // south, west of the door
        ([3.0, -0.3, 0.0], [5.3, 0.0, 2.8]),   // south, east of the door
        ([1.9, -0.3, 2.1], [3.1, 0.0, 2.8]),   // lintel
    ];
    let xs = [-1.0, -0.3, 0.0, 2.0, 3.0, 5.0, 5.3, 6.0];
    let ys = [-1.0, -0.3, 0.0, 4.0, 4.3, 5.0];
    let zs = [-1.0, -0.2, 0.0, 2.1, 2.8, 3.0, 4.0];
    let stacks = Stacks::boxes(&xs, &ys, &zs, |[i, j, k]| {
        let middle = [xs[i] + xs[i + 1], ys[j] + ys[j + 1], zs[k] + zs[k + 1]].map(|c| c / 2.0);
        let holds = |(low, high): &([f64; 3], [f64; 3])| {
            (0..3).all(|axis| low[axis] < middle[axis] && middle[axis] < high[axis])
        };
        match boxes.iter().position(holds) {
            Some(element) => solid(element as u32),
            None if holds(&([0.0; 3], [5.0, 4.0, 2.8])) => Label::Air(ElementId(20)),
            None => Label::Exterior,
        }
    });
    let matter = as_matter(&boxes.map(|(low, high)| box_triangles(low, high)));
    (stacks, matter)
}

#[test]
fn a_room_with_a_door_hole_has_all_its_surfaces() {
    let (stacks, matter) = room();
    let mut partition = stacks.build();
    let report = run(&mut partition, &matter);
    assert_eq!((report.false_faces, report.patched), (0, 0), "{report:?}");
    // Outside: 2 x 5.6 x 4.6 and 3.2 m of height around 20.4 m, less the hole; inside: 2 x 5 x 4 and 2.8 m around
    // 18 m, less the hole; in the hole: 30 cm around 2.1 + 1 + 2.1 m and its floor.
    let outside = 2.0 * 5.6 * 4.6 + 20.4 * 3.2 - 2.1;
    let inside = 2.0 * 20.0 + 18.0 * 2.8 - 2.1;
    assert!((report.area - outside - inside - 0.3 * 6.2).abs() < 1e-3, "{}", report.area);
    assert_eq!(report.planar, report.sources);
    // The floor of the room is the floor's upper side, from both sides.
    let (air, floor) = (cell_at(&partition, [2.5, 2.0, 1.0]), cell_at(&partition, [2.5, 2.0, -0.1]));
    for (a, b) in [(air, floor), (floor, air)] {
        let sources = between(&partition, a, b);
        assert_eq!(sources.len(), 1);
        let elements: Vec<u32> = names(&partition, sources[0]).iter().map(|n| n.0.0).collect();
        assert_eq!(elements, [0, 0]);
    }
    // The lintel's lower side closes the hole above; its box reaches into the walls beside.
    let (hole, lintel) = (cell_at(&partition, [2.5, -0.1, 1.0]), cell_at(&partition, [2.5, -0.1, 2.4]));
    let sources = between(&partition, hole, lintel);
    assert!(names(&partition, sources[0]).iter().all(|n| n.0.0 == 7));
}

#[test]
fn a_missing_wall_is_false_solid() {
    let (stacks, matter) = room();
    // The west wall has lost its side towards the room; the floor below and the ceiling above are whole.
    let without: Vec<MatterTriangle> = matter
        .iter()
        .copied()
        .filter(|t| !(t.element.0 == 2 && t.corners.iter().all(|p| p[0] == 0.0)))
        .collect();
    assert_eq!(without.len(), matter.len() - 2);
    let mut partition = stacks.build();
    let report = run(&mut partition, &without);
    // Four millimetres at the rim are within the reach of floor, ceiling and the walls beside.
    assert!((report.false_area - 4.0 * 2.8).abs() < 0.04, "{report:?}");
    assert_eq!(report.false_faces, 2);
    let largest = report.places[0];
    assert_eq!(largest.element, Some(ElementId(2)));
    assert!((DVec3::from(largest.at) - DVec3::new(0.0, 2.0, 1.05)).length() < 0.2, "{largest:?}");
    assert!((largest.area - 4.0 * 2.1).abs() < 0.03);
    assert!(report.places[0].area >= report.places[1].area);
}

#[test]
fn walls_without_a_surface_stay_walls() {
    let mut partition = room().0.build();
    let report = run(&mut partition, &[]);
    assert_eq!((report.false_faces, report.given_back), (report.faces, 0), "{report:?}");
    assert!((report.false_area - report.area).abs() < 1e-9);
    assert!(partition.sources.is_empty());
    assert!(partition.faces.iter().all(|f| f.cover.source == NONE));
}

#[test]
fn strips_without_a_surface_are_given_back_to_the_air() {
    // A strip of 1 cm along the west wall, from floor to ceiling, is matter by its label only.
    let xs = [-1.0, -0.3, 0.0, 0.01, 5.0, 5.3, 6.0];
    let ys = [-1.0, -0.3, 0.0, 4.0, 4.3, 5.0];
    let zs = [-1.0, -0.2, 0.0, 2.8, 3.0, 4.0];
    let stacks = Stacks::boxes(&xs, &ys, &zs, |[i, j, k]| match (i, j, k) {
        (2, 2, 2) => solid(2),
        (3, 2, 2) => Label::Air(ElementId(20)),
        (1..=4, 1..=3, 1..=3) => solid(0),
        _ => Label::Exterior,
    });
    let sides = [([-0.3, -0.3, -0.2], [5.3, 4.3, 3.0]), ([0.0, 0.0, 0.0], [5.0, 4.0, 2.8])];
    let matter_of_two = as_matter(&sides.map(|(low, high)| box_triangles(low, high)));
    let inner: Vec<MatterTriangle> = matter_of_two
        .into_iter()
        .map(|mut t| {
            // The inner box is the room's: it looks inward.
            if t.element.0 == 1 {
                t.corners.swap(1, 2);
            }
            t
        })
        .collect();
    let mut partition = stacks.build();
    let strip = cell_at(&partition, [0.005, 2.0, 1.0]);
    let report = run(&mut partition, &inner);
    assert_eq!((report.given_back, report.false_faces), (1, 0), "{report:?}");
    assert!((report.given_back_volume - 0.01 * 4.0 * 2.8).abs() < 1e-3, "{report:?}");
    assert_eq!(partition.cells[strip].label, Label::Air(ElementId(20)));
    // What lies behind it has its surface now.
    let wall = cell_at(&partition, [-0.1, 2.0, 1.0]);
    assert!(between(&partition, strip, wall).iter().all(|&source| source != NONE));
}

#[test]
fn half_a_wall_is_false_solid_by_half() {
    let (stacks, mut matter) = room();
    // Only the lower triangle of the west wall's side is there.
    let place = matter.iter().position(|t| t.element.0 == 2 && t.corners.iter().all(|p| p[0] == 0.0));
    matter.remove(place.unwrap());
    let mut partition = stacks.build();
    let report = run(&mut partition, &matter);
    // The wall's side is 4.6 m long, of which 4 m are in the room.
    assert!(report.false_area > 4.0 && report.false_area < 7.2, "{report:?}");
    let air = cell_at(&partition, [1.0, 2.0, 1.0]);
    let wall = cell_at(&partition, [-0.1, 2.0, 1.0]);
    assert_eq!(between(&partition, air, wall).iter().filter(|s| **s != NONE).count(), 1);
}

#[test]
fn a_roof_and_its_attic_have_their_slopes() {
    let [low, high] = [0.0, 0.2].map(|z| Plane::sloped([0.6, 0.0], [0.0, 0.0, z * METRE]).unwrap());
    let stack = |c: usize| {
        let end = (Label::Exterior, level(6.0));
        match c {
            4 => vec![(Label::Air(ElementId(9)), low), (solid(0), high), end],
            _ => vec![end],
        }
    };
    let mut partition = Stacks {
        xs: vec![-1.0, 0.0, 4.0, 5.0],
        ys: vec![-1.0, 0.0, 3.0, 4.0],
        bottom: -0.5,
        columns: (0..9).map(stack).collect(),
    }
    .build();
    let matter = matter_of(&partition);
    assert_eq!(matter.len(), 12);
    let report = run(&mut partition, &matter);
    assert_eq!((report.false_faces, report.patched), (0, 0), "{report:?}");
    let slope = 1.36f64.sqrt();
    let sides = 2.0 * 4.0 * 0.2 + 2.0 * 3.0 * 0.2;
    assert!((report.area - 2.0 * 12.0 * slope - sides).abs() < 1e-3, "{report:?}");
    let roof = cell_at(&partition, [2.0, 1.0, 1.3]);
    for at in [[2.0, 1.0, 1.0], [2.0, 1.0, 2.0]] {
        let air = cell_at(&partition, at);
        let sources = between(&partition, air, roof);
        assert_eq!(names(&partition, sources[0]).len(), 2);
        assert!(partition.sources[sources[0] as usize].plane.is_some());
    }
}

/// Matter below z = 0 for x > 0, in air.
fn ledge() -> Partition {
    Stacks::boxes(&[-1.0, 0.0, 1.0], &[0.0, 1.0], &[-1.0, 0.0, 1.0], |at| {
        if at == [1, 0, 0] { solid(0) } else { Label::Void }
    })
    .build()
}

#[test]
fn a_leaning_side_within_the_reach_makes_an_upright_face() {
    let top = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let leaning = |by: f64| quad([[-by, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-by, 1.0, -1.0]]);
    let mut partition = ledge();
    let report = run(&mut partition, &as_matter(&[top.clone(), leaning(1.9e-3)]));
    assert_eq!((report.false_faces, report.patched), (0, 0), "{report:?}");
    let mut partition = ledge();
    let report = run(&mut partition, &as_matter(&[top, leaning(4e-3)]));
    assert_eq!(report.false_faces, 1);
    assert!((report.false_area - 0.5).abs() < 0.02, "{report:?}");
}

#[test]
fn edge_on_triangles_make_a_step_of_a_millimetre() {
    // The right part is a millimetre lower; the source has one tilted face over both, and no upright one.
    let mut partition = Stacks {
        xs: vec![0.0, 1.0, 2.0],
        ys: vec![0.0, 1.0],
        bottom: -1.0,
        columns: vec![
            vec![(solid(0), level(0.0)), (Label::Void, level(1.0))],
            vec![(solid(0), level(-1e-3)), (Label::Void, level(1.0))],
        ],
    }
    .build();
    let matter = as_matter(&[quad([[0.0, 0.0, 0.0], [2.0, 0.0, -1e-3], [2.0, 1.0, -1e-3], [0.0, 1.0, 0.0]])]);
    let report = run(&mut partition, &matter);
    assert_eq!(report.faces, 3);
    assert_eq!((report.false_faces, report.patched), (0, 1), "{report:?}");
    assert!(partition.sources.iter().all(|s| s.plane.is_some()));
}

#[test]
fn averted_triangles_serve_where_nothing_else_does() {
    let side = quad([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, -1.0]]);
    let top = quad([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let averted: Vec<_> = side.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let elements = |matter: &[MatterTriangle]| {
        let mut partition = ledge();
        let report = run(&mut partition, matter);
        assert_eq!(report.false_faces, 0, "{report:?}");
        let (air, wall) = (cell_at(&partition, [-0.5, 0.5, -0.5]), cell_at(&partition, [0.5, 0.5, -0.5]));
        let source = between(&partition, air, wall)[0];
        let elements: Vec<u32> = names(&partition, source).iter().map(|n| n.0.0).collect();
        (elements, report.patched)
    };
    // A side that looks the right way suffices.
    assert_eq!(elements(&as_matter(&[top.clone(), averted.clone(), side])), (vec![2, 2], 0));
    let (found, patched) = elements(&as_matter(&[top, averted]));
    assert!(found.ends_with(&[1, 1]));
    assert_eq!(patched, 1);
}

#[test]
fn lists_are_shared_and_tell_planes() {
    let (stacks, matter) = room();
    let mut partition = stacks.build();
    run(&mut partition, &matter);
    let mut lists: Vec<_> = partition.sources.iter().map(|s| s.triangles.clone()).collect();
    for list in &lists {
        assert!(!list.is_empty() && list.is_sorted_by(|a, b| a < b));
    }
    let count = lists.len();
    lists.sort();
    lists.dedup();
    assert_eq!(lists.len(), count);
    // Two triangles that differ by 2 um are not one plane, by half a micrometre they are.
    for (by, planar) in [(2e-6, None), (5e-7, Some(1))] {
        let small = scaled([[0.0, 0.0, by], [1.0, 0.0, by], [1.0, 0.9, by]]);
        let large = scaled([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
        let matter = as_matter(&[vec![small, large]]);
        assert_eq!(source(&matter, &[0, 1], 1e-6 * METRE).plane, planar);
    }
}

#[test]
fn broken_numbers_do_no_harm() {
    let (stacks, mut matter) = room();
    let nan = f64::NAN;
    let broken = [
        [[nan, 0.0, 0.0], [METRE, 0.0, 0.0], [METRE, METRE, 0.0]],
        [[f64::INFINITY, 0.0, 0.0], [METRE, 0.0, 0.0], [METRE, METRE, 0.0]],
        [[0.0, 0.0, 0.0], [METRE, nan, 0.0], [METRE, METRE, 0.0]],
        [[0.0, 0.0, 0.0]; 3],
        [[-1e300, -1e300, 0.0], [1e300, -1e300, 0.0], [METRE, 1e300, 0.0]],
    ];
    let found = run(&mut stacks.build(), &matter);
    for (triangle, corners) in broken.into_iter().enumerate() {
        matter.push(MatterTriangle { corners, element: ElementId(30), triangle: triangle as u32 });
    }
    let report = run(&mut stacks.build(), &matter);
    assert_eq!((report.faces, report.false_faces), (found.faces, 0));
}

/// The box of a cell of a grid of boxes.
fn bounds(partition: &Partition, cell: usize) -> Bounds {
    let corners = cell_triangles(partition, &partition.cells[cell]).into_iter().flatten();
    Bounds::of(&corners.map(DVec3::from).collect::<Vec<_>>())
}

fn grids() -> impl Strategy<Value = Partition> {
    let ticks = prop::collection::vec(0.01f64..3.0, 4).prop_map(|widths| {
        let mut ticks = vec![-4.0];
        widths.iter().for_each(|w| ticks.push(ticks[ticks.len() - 1] + w));
        ticks
    });
    let labels = prop::collection::vec(prop_oneof![Just(Label::Void), (0u32..4).prop_map(solid)], 64);
    (prop::collection::vec(ticks, 3), labels).prop_map(|(ticks, labels)| {
        Stacks::boxes(&ticks[0], &ticks[1], &ticks[2], |[i, j, k]| labels[i + 4 * j + 16 * k]).build()
    })
}

proptest! {
    #[test]
    fn every_exposed_triangle_is_behind_the_surface_that_it_makes(partition in grids()) {
        let mut partition = partition;
        let matter = matter_of(&partition);
        let report = run(&mut partition, &matter);
        prop_assert_eq!((report.false_faces, report.patched), (0, 0));
        let find = |p: DVec3| partition.cells.iter().position(|c| is_in(&partition, c, p));
        let mut area = 0.0;
        for t in &matter {
            // Each cell's sides are its neighbours', so that a point is as good as all.
            let middle = t.points().iter().sum::<DVec3>() / 3.0;
            let off = t.normal().unwrap() * 2.0;
            let (Some(air), Some(wall)) = (find(middle + off), find(middle - off)) else { continue };
            if !partition.cells[air].label.is_air() {
                continue;
            }
            area += t.area() / METRE / METRE;
            for (a, b) in [(air, wall), (wall, air)] {
                let sources = between(&partition, a, b);
                prop_assert_eq!(sources.len(), 1);
                prop_assert!(names(&partition, sources[0]).contains(&t.name()));
            }
        }
        prop_assert!((report.area - area).abs() <= 1e-6 * (1.0 + area), "{} {}", report.area, area);
        // Boxes are at least a centimetre thick, so that all triangles of a list are in one plane and look one way.
        for source in &partition.sources {
            let find = |name: &(ElementId, u32)| matter.iter().find(|t| t.name() == *name).unwrap();
            let first = find(&source.triangles[0]);
            for t in source.triangles.iter().map(find) {
                let (own, same) = (t.normal().unwrap(), first.normal().unwrap());
                prop_assert!(own.dot(same) > 1.0 - 1e-12);
                prop_assert!(same.dot(t.points()[0] - first.points()[0]).abs() < 1e-6);
            }
            prop_assert!(source.plane.is_some());
        }
        // Nothing else has a source.
        for (c, cell) in partition.cells.iter().enumerate() {
            for other in 0..partition.cells.len() {
                let differ = cell.label.is_air() != partition.cells[other].label.is_air();
                prop_assert!(between(&partition, c, other).iter().all(|&s| differ != (s == NONE)));
            }
        }
    }

    #[test]
    fn a_triangle_taken_away_leaves_its_area_false(
        partition in grids(), pick in any::<prop::sample::Index>(),
    ) {
        let mut partition = partition;
        let mut matter = matter_of(&partition);
        let find = |p: DVec3| partition.cells.iter().position(|c| is_in(&partition, c, p));
        let exposed: Vec<usize> = (0..matter.len())
            .filter(|&t| {
                let middle = matter[t].points().iter().sum::<DVec3>() / 3.0;
                let air = find(middle + matter[t].normal().unwrap() * 2.0);
                air.is_some_and(|c| partition.cells[c].label.is_air())
            })
            .collect();
        prop_assume!(!exposed.is_empty());
        let taken = matter.remove(exposed[pick.index(exposed.len())]);
        let report = run(&mut partition, &matter);
        let [a, b, c] = taken.points();
        let round = (b - a).length() + (c - b).length() + (a - c).length();
        let (area, rim) = (taken.area() / METRE / METRE, 2.2e-3 * round / METRE);
        prop_assert!(report.false_area <= area + 1e-9, "{} {}", report.false_area, area);
        prop_assert!(report.false_area >= area - rim, "{} {}", report.false_area, area);
        prop_assert_eq!(report.false_faces, u32::from(report.false_area > 0.0));
        for place in &report.places {
            let p = DVec3::from(place.at) * METRE;
            prop_assert!(distance(&taken.corners, p) < 1.0);
            prop_assert!(bounds(&partition, place.air as usize).dilated(DVec3::ONE).meets(&Bounds::of(&[p])));
        }
    }

    #[test]
    fn what_moved_by_less_than_the_reach_is_still_found(
        partition in grids(), moves in prop::collection::vec(prop::array::uniform3(-1e-3f64..1e-3), 64),
    ) {
        let mut partition = partition;
        let mut matter = matter_of(&partition);
        // Each element moves as a whole, by up to a millimetre along each axis.
        for t in &mut matter {
            let by = moves[t.element.0 as usize];
            t.corners.iter_mut().for_each(|p| (0..3).for_each(|axis| p[axis] += by[axis] * METRE));
        }
        let report = run(&mut partition, &matter);
        prop_assert_eq!(report.false_faces, 0, "{:?}", report);
    }
}

#[cfg(feature = "rayon")]
#[test]
fn threads_do_not_matter() {
    let ticks: Vec<f64> = (0..=12).map(f64::from).collect();
    let build = || {
        Stacks::boxes(&ticks, &ticks, &ticks, |[i, j, k]| {
            if (i * 7 + j * 5 + k * 3) % 4 == 0 { solid(i as u32) } else { Label::Void }
        })
        .build()
    };
    let mut matter = matter_of(&build());
    matter.iter_mut().step_by(5).for_each(|t| t.corners[0][0] += 0.4 * METRE);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut partition = build();
        (pool.install(|| run(&mut partition, &matter)), partition)
    };
    let one = on(1);
    assert!(one.0.false_faces > 10);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
}
