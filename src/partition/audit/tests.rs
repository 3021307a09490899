use glam::DVec3;
use proptest::prelude::*;

use super::*;
use crate::lattice::Plane;
use crate::partition::cells::Label;
use crate::partition::testing::*;

fn run(partition: &mut Partition, matter: &[MatterTriangle]) -> AuditReport {
    audit(partition, matter, &AuditOptions::default(), &Watch::default())
}

/// A block of matter, 4 m x 1 m x 3 m high, in air.
fn block() -> Partition {
    Stacks::boxes(&[-1.0, 0.0, 4.0, 5.0], &[-1.0, 0.0, 1.0, 2.0], &[-1.0, 0.0, 3.0, 4.0], |at| {
        if at == [1, 1, 1] { solid(0) } else { Label::Exterior }
    })
    .build()
}

fn scaled(corners: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    corners.map(|p| p.map(|c| c * METRE))
}

#[test]
fn matter_on_or_in_solid_cells_is_no_detail() {
    let mut partition = block();
    let inside = vec![scaled([[0.5, 0.5, 0.5], [3.0, 0.5, 0.5], [1.0, 0.2, 2.0]])];
    let matter = as_matter(&[box_triangles([0.0; 3], [4.0, 1.0, 3.0]), inside]);
    let report = run(&mut partition, &matter);
    assert_eq!(partition.detail, []);
    assert_eq!(report.detail, Tally::default());
    assert_eq!((report.triangles, report.flat), (13, 0));
}

#[test]
fn a_membrane_is_detail() {
    let mut partition = block();
    let sheet = [[1.0, -0.5, 0.0], [2.0, -0.5, 0.0], [2.0, -0.5, 2.0]];
    let back = [sheet[0], sheet[2], sheet[1]];
    let matter = as_matter(&[box_triangles([0.0; 3], [4.0, 1.0, 3.0]), vec![scaled(sheet), scaled(back)]]);
    partition.detail = vec![(ElementId(1), 1), (ElementId(7), 0)];
    let report = run(&mut partition, &matter);
    assert_eq!(partition.detail, [(ElementId(1), 0), (ElementId(1), 1), (ElementId(7), 0)]);
    assert_eq!(report.reasons.keys().copied().collect::<Vec<_>>(), [Exposure::NoMatter]);
    assert_eq!(report.elements[&ElementId(1)].triangles, 2);
    assert!((report.detail.exposed - 2.0).abs() < 1e-9 && (report.detail.area - 2.0).abs() < 1e-9);
}

#[test]
fn a_triangle_half_in_matter_and_half_out_is_detail() {
    let mut partition = block();
    // From x = 3 in the block to x = 5 out of it, 2 m2 of which the part beyond x = 4 is a quarter.
    let matter = as_matter(&[vec![scaled([[3.0, 0.5, 0.0], [5.0, 0.5, 1.0], [3.0, 0.5, 2.0]])]]);
    let report = run(&mut partition, &matter);
    assert_eq!(partition.detail, [(ElementId(0), 0)]);
    let tally = report.reasons[&Exposure::InPart];
    assert_eq!(tally.triangles, 1);
    // The tolerance moves the side by a third of a millimetre.
    assert!((tally.exposed - 0.5).abs() < 1e-3 && (tally.area - 2.0).abs() < 1e-9, "{tally:?}");
}

#[test]
fn what_reaches_out_of_the_hull_is_detail() {
    let mut partition = block();
    let matter = as_matter(&[vec![scaled([[3.0, 0.5, 1.0], [3.9, 0.5, 1.0], [3.5, 9.0, 1.0]])]]);
    let report = run(&mut partition, &matter);
    assert_eq!(report.reasons.keys().copied().collect::<Vec<_>>(), [Exposure::OutsideHull]);
}

#[test]
fn the_tolerance_is_that_of_the_options_and_one_step() {
    let options = AuditOptions::default();
    let moved = |by: f64, axis: usize| {
        let mut partition = block();
        let mut corners = [[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [2.0, 1.0, 2.0]];
        if axis == 2 {
            corners = [[1.0, 0.1, 3.0], [2.0, 0.1, 3.0], [2.0, 0.9, 3.0]];
        }
        corners.iter_mut().for_each(|p| p[axis] += by);
        run(&mut partition, &as_matter(&[vec![scaled(corners)]])).detail.triangles
    };
    let step = 1.0 / METRE;
    assert_eq!(moved(options.tolerance + 0.9 * step, 1), 0);
    assert_eq!(moved(options.tolerance + 1.1 * step, 1), 1);
    assert_eq!(moved(options.level + 0.9 * step, 2), 0);
    assert_eq!(moved(options.level + 1.1 * step, 2), 1);
}

#[test]
fn slivers_at_the_rim_do_not_count_but_narrow_triangles_do() {
    let beyond = AuditOptions::default().tolerance + 1.0 / METRE;
    // On the block's front, ending a little beyond its side.
    let on = |by: f64| scaled([[1.0, 0.0, 1.0], [4.0 + by, 0.0, 1.0], [4.0 + by, 0.0, 2.0]]);
    let exposed = |t: [[f64; 3]; 3]| run(&mut block(), &as_matter(&[vec![t]])).detail.triangles;
    assert_eq!(exposed(on(beyond + 4e-5)), 0);
    assert_eq!(exposed(on(beyond + 6e-5)), 1);
    let needle = scaled([[1.0, -0.5, 1.0], [3.0, -0.5, 1.0], [3.0, -0.5, 1.0 + 1e-6]]);
    assert_eq!(exposed(needle), 1);
    let report = run(&mut block(), &as_matter(&[vec![scaled([[1.0, -0.5, 1.0]; 3])]]));
    assert_eq!((report.flat, report.detail.triangles), (1, 0));
}

#[test]
fn an_acute_edge_does_not_reach_out() {
    // A wedge of matter that rises from nothing to 50 mm over 5 m: moved out by a third of a millimetre, its planes alone
    // would meet 35 mm before its edge.
    let rise = Plane::sloped([0.01, 0.0], [0.0; 3]).unwrap();
    let column = |wedge: bool| match wedge {
        true => vec![(Label::Exterior, level(0.0)), (solid(0), rise), (Label::Exterior, level(2.0))],
        false => vec![(Label::Exterior, level(0.0)), (Label::Exterior, level(2.0))],
    };
    let stacks = Stacks {
        xs: vec![-1.0, 0.0, 5.0, 6.0],
        ys: vec![-1.0, 0.0, 1.0, 2.0],
        bottom: -1.0,
        columns: (0..9).map(|c| column(c == 4)).collect(),
    };
    let off = [[-0.01, 0.2, 0.0], [-0.002, 0.2, 0.0], [-0.002, 0.8, 0.0]];
    let mut partition = stacks.build();
    let mut matter = matter_of(&partition);
    assert_eq!(run(&mut partition, &matter).detail.triangles, 0);
    matter.extend(as_matter(&[vec![scaled(off)]]));
    assert_eq!(run(&mut partition, &matter).reasons[&Exposure::NoMatter].triangles, 1);
}

#[test]
fn an_acute_corner_in_the_plan_does_not_reach_out() {
    // A needle of a footprint: 2 m long, 20 mm wide.
    let mut partition = block();
    let sections = partition.cells.iter().find(|c| !c.label.is_air()).unwrap().sections.clone();
    let needle = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.02]];
    for (section, at) in sections.clone().zip(needle) {
        partition.sections[section as usize].start = crate::lattice::Point::new(steps(at[0]), steps(at[1]));
    }
    partition.cells.retain(|c| !c.label.is_air());
    partition.cells[0].sections.end -= 1;
    let mut matter = matter_of(&partition);
    assert_eq!(run(&mut partition, &matter).detail.triangles, 0);
    matter.extend(as_matter(&[vec![scaled([[-0.02, 0.0, 1.0], [-0.002, 0.0, 1.0], [-0.002, 0.0, 2.0]])]]));
    assert_eq!(run(&mut partition, &matter).reasons[&Exposure::NoMatter].triangles, 1);
}

#[test]
fn one_triangle_over_thousands_of_cells() {
    // A floor of 60 x 60 tiles without one of them under two triangles.
    let ticks: Vec<f64> = (0..=62).map(f64::from).collect();
    let build = |hole: bool| {
        Stacks::boxes(&ticks, &ticks, &[-1.0, 0.0, 1.0], |[i, j, k]| {
            let is_floor = k == 0 && (1..61).contains(&i) && (1..61).contains(&j);
            if is_floor && !(hole && [i, j] == [20, 7]) { solid((i + 62 * j) as u32) } else { Label::Void }
        })
        .build()
    };
    let triangle = |corners: [[f64; 3]; 3]| scaled(corners);
    let floor = vec![
        triangle([[1.0, 1.0, 0.0], [61.0, 1.0, 0.0], [61.0, 61.0, 0.0]]),
        triangle([[1.0, 1.0, 0.0], [61.0, 61.0, 0.0], [1.0, 61.0, 0.0]]),
    ];
    let matter = as_matter(&[floor]);
    assert_eq!(run(&mut build(false), &matter).detail.triangles, 0);
    let mut partition = build(true);
    let report = run(&mut partition, &matter);
    assert_eq!(partition.detail, [(ElementId(0), 0)]);
    assert!((report.detail.exposed - 1.0).abs() < 2e-3, "{report:?}");
}

#[test]
fn broken_numbers_do_no_harm() {
    let mut partition = block();
    let nan = f64::NAN;
    let broken = vec![
        [[nan, 0.0, 0.0], [METRE, 0.0, 0.0], [METRE, METRE, 0.0]],
        [[f64::INFINITY, 0.0, 0.0], [METRE, 0.0, 0.0], [METRE, METRE, 0.0]],
        [[1e300, 0.0, 0.0], [METRE, -1e300, 0.0], [METRE, METRE, 1e300]],
    ];
    let report = run(&mut partition, &as_matter(&[broken]));
    assert_eq!(report.triangles, 3);
}

/// Which of 27 boxes of random sizes are matter, and of which element.
fn grids() -> impl Strategy<Value = (Vec<Vec<f64>>, Vec<Option<u32>>)> {
    let ticks = prop::collection::vec(0.01f64..3.0, 5).prop_map(|widths| {
        let mut at = -4.0;
        let after = widths.into_iter().map(|w| {
            at += w;
            at
        });
        std::iter::once(-4.0).chain(after.collect::<Vec<_>>()).collect::<Vec<f64>>()
    });
    (
        prop::collection::vec(ticks, 3),
        prop::collection::vec(prop_oneof![Just(None), (0u32..4).prop_map(Some)], 27),
    )
}

fn grid(ticks: &[Vec<f64>], labels: &[Option<u32>]) -> Partition {
    Stacks::boxes(&ticks[0], &ticks[1], &ticks[2], |at| {
        // The outermost layer is air.
        let inner = at.map(|i| i.checked_sub(1).filter(|i| *i < 3));
        let [Some(i), Some(j), Some(k)] = inner else { return Label::Exterior };
        labels[i + 3 * j + 9 * k].map_or(Label::Void, solid)
    })
    .build()
}

/// The distance of a point from a box, by axis.
fn apart(partition: &Partition, cell: usize, p: DVec3) -> DVec3 {
    let points: Vec<DVec3> =
        cell_triangles(partition, &partition.cells[cell]).into_iter().flatten().map(DVec3::from).collect();
    let bounds = Bounds::of(&points);
    (bounds.low - p).max(p - bounds.high).max(DVec3::ZERO)
}

/// The longest edge of a triangle.
fn longest(corners: &[[f64; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(DVec3::from);
    (b - a).length().max((c - b).length()).max((a - c).length())
}

proptest! {
    #[test]
    fn a_cell_taken_away_leaves_exactly_its_exposed_triangles(
        (ticks, labels) in grids(), pick in any::<prop::sample::Index>(),
    ) {
        let mut partition = grid(&ticks, &labels);
        let matter = matter_of(&partition);
        let report = run(&mut partition, &matter);
        prop_assert_eq!(report.detail.triangles, 0);
        let solids: Vec<usize> =
            (0..partition.cells.len()).filter(|&c| !partition.cells[c].label.is_air()).collect();
        prop_assume!(!solids.is_empty());
        let taken = solids[pick.index(solids.len())];
        let label = std::mem::replace(&mut partition.cells[taken].label, Label::Void);
        let report = run(&mut partition, &matter);
        let own = cell_triangles(&partition, &partition.cells[taken]);
        let expected: Vec<(ElementId, u32)> = matter
            .iter()
            .filter(|t| label == Label::Solid(t.element) && own.contains(&t.corners))
            .filter(|t| {
                // On the surface of no other cell.
                let middle = t.points().iter().sum::<DVec3>() / 3.0;
                !solids.iter().any(|&s| s != taken && is_in(&partition, &partition.cells[s], middle))
            })
            .map(MatterTriangle::name)
            .collect();
        prop_assert_eq!(&partition.detail, &expected);
        prop_assert_eq!(report.detail.triangles as usize, expected.len());
    }

    #[test]
    fn sampled_points_agree(
        (ticks, labels) in grids(),
        triangles in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-4.0f64..4.0)), 1..12),
        flat in 0..4usize,
    ) {
        let mut partition = grid(&ticks, &labels);
        let mut triangles: Vec<_> = triangles.into_iter().map(scaled).collect();
        if flat < 3 {
            // In the plane of some box's side.
            triangles.iter_mut().for_each(|t| t.iter_mut().for_each(|p| p[flat] = ticks[flat][2] * METRE));
        }
        let matter = as_matter(&[triangles]);
        run(&mut partition, &matter);
        let options = AuditOptions::default();
        let solids: Vec<usize> =
            (0..partition.cells.len()).filter(|&c| !partition.cells[c].label.is_air()).collect();
        for t in matter.iter().filter(|t| t.area() > 0.0) {
            let points = points_on(&t.corners, 30);
            let is_far = |p: &&DVec3, least: f64| {
                solids.iter().all(|&s| apart(&partition, s, **p).length() > least * METRE)
            };
            // Twice the wider tolerance is beyond any corner of what was moved out; about a sample of a triangle that is
            // wide enough lies more than a sliver.
            let is_wide = 2.0 * t.area() / longest(&t.corners) > 0.02 * METRE;
            if is_wide && points.iter().any(|p| is_far(&p, 2.0 * options.level)) {
                prop_assert!(partition.detail.contains(&t.name()));
            }
            let far = points.iter().filter(|p| is_far(p, options.tolerance)).count();
            let far = far as f64 / points.len() as f64;
            let report = run(&mut partition.clone(), &[*t]);
            let exposed = report.detail.exposed * METRE * METRE / t.area();
            // The sampling errs by what lies along a few lines across the triangle; parts too narrow are not reported.
            let narrow = 4.0 * 1e-3 * METRE * longest(&t.corners) / t.area();
            prop_assert!((far - exposed).abs() <= 0.15 + narrow, "{} against {}", far, exposed);
            prop_assert_eq!(report.detail.triangles == 1, partition.detail.contains(&t.name()));
            if far == 0.0 {
                prop_assert!(exposed <= 0.01 + narrow, "{} between samples", exposed);
            }
        }
    }

    #[test]
    fn sampled_points_agree_under_sloped_planes(
        slopes in prop::collection::vec(prop::array::uniform2(-0.4f64..0.4), 4),
        fill in prop::collection::vec(any::<bool>(), 8),
        triangles in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-2.0f64..2.0)), 1..8),
    ) {
        // 2 x 2 columns, each with two sloped planes about z = -0.5 and z = 0.5, no farther apart than to cross nowhere.
        let columns = (0..4)
            .map(|c| {
                let middle = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]][c].map(|m| m * METRE);
                let [low, high] = [-0.5, 0.5].map(|z| {
                    Plane::sloped(slopes[c], [middle[0], middle[1], z * METRE]).unwrap()
                });
                let fill = |i: usize| if fill[2 * c + i] { solid(c as u32) } else { Label::Void };
                vec![(fill(0), low), (Label::Void, high), (fill(1), level(2.0))]
            })
            .collect();
        let ticks = vec![-2.0, 0.0, 2.0];
        let mut partition = Stacks { xs: ticks.clone(), ys: ticks, bottom: -2.0, columns }.build();
        let mut matter = matter_of(&partition);
        prop_assert_eq!(run(&mut partition, &matter).detail.triangles, 0);
        matter = as_matter(&[triangles.into_iter().map(scaled).collect()]);
        let report = run(&mut partition, &matter);
        let solids: Vec<_> = partition.cells.iter().filter(|c| !c.label.is_air()).collect();
        let mut exposed = 0.0;
        for t in &matter {
            let points = points_on(&t.corners, 24);
            let out = points.iter().filter(|&&p| !solids.iter().any(|c| is_in(&partition, c, p))).count();
            exposed += t.area() * out as f64 / points.len() as f64;
        }
        let all: f64 = matter.iter().map(MatterTriangle::area).sum();
        prop_assert!(
            (exposed - report.detail.exposed * METRE * METRE).abs() <= 0.05 * all + 8e-3 * METRE * METRE,
            "{} of {} against {}", exposed, all, report.detail.exposed * METRE * METRE
        );
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
    // Some stick out.
    matter.iter_mut().step_by(5).for_each(|t| t.corners[0][0] += 0.4 * METRE);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut partition = build();
        let report = pool.install(|| run(&mut partition, &matter));
        (report, partition.detail)
    };
    let one = on(1);
    assert!(one.0.detail.triangles > 100);
    assert_eq!(one, on(2));
    assert_eq!(one, on(3));
}
