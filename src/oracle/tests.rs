//! The grid against the brute force, and verdicts on answers right and wrong.

use enfilade_importers::{ElementId, Semantic};
use proptest::prelude::*;

use super::fixtures::{Shape, house, model, role_of};
use super::random::Random;
use super::triangle::Corners;
use super::vector::{add, scale, sub};
use super::*;
use crate::trace::{Answer, Hit, NONE};

fn truth(shapes: &[(Semantic, Shape)]) -> Truth {
    let model = model(shapes);
    Truth::new(&model, role_of(&model), &TruthOptions::default())
}

fn wall(lo: [f64; 3], hi: [f64; 3]) -> (Semantic, Shape) {
    (Semantic::Wall, Shape::cuboid(lo, hi))
}

fn hit(t: f64, element: u32) -> Answer {
    Answer::Hit(Hit { t, element, ..Hit::ESCAPED })
}

fn answer_of(truth: &TrueAnswer) -> Answer {
    match truth {
        TrueAnswer::Hit(nearest) => hit(nearest.t, nearest.element.0),
        TrueAnswer::Escaped => Answer::Escaped,
        TrueAnswer::InSolid(solids) => Answer::InSolid(solids[0].0),
    }
}

fn wrong(why: Why) -> Verdict {
    Verdict::Wrong { why }
}

/// Triangles of many sizes and shapes, by kind of mischief.
fn soup(kind: u32, count: usize, seed: u64) -> Shape {
    let mut random = Random::new(seed, 99, u64::from(kind));
    let mut shape = Shape::default();
    let cube = |random: &mut Random, size: f64| [0; 3].map(|_| random.between(-size, size));
    for i in 0..count {
        let corners: Corners = match kind {
            // Even, of sizes from a millimetre to the whole.
            0 => {
                let size = 10f64.powf(random.between(-3.0, 1.0));
                let at = cube(&mut random, 10.0);
                [0; 3].map(|_| add(at, cube(&mut random, size)))
            }
            // A building of a metre and strays up to a hundred million kilometres away.
            1 => {
                let far = if i % 10 == 0 { 10f64.powf(random.between(1.0, 11.0)) } else { 1.0 };
                let at = cube(&mut random, far);
                [0; 3].map(|_| add(at, cube(&mut random, 0.3 * far.sqrt())))
            }
            // Small integers: coplanar, on each other, sharing edges and corners.
            2 => [0; 3].map(|_| [0; 3].map(|_| random.below(4) as f64)),
            // Slivers across the whole, down to a nanometre wide.
            3 => {
                let (a, b) = (cube(&mut random, 5.0), cube(&mut random, 5.0));
                let width = 10f64.powf(random.between(-9.0, -1.0));
                [a, b, add(b, cube(&mut random, width))]
            }
            // A fan around one point, and one plane.
            4 => {
                let mut corners = [[0.0; 3], cube(&mut random, 3.0), cube(&mut random, 3.0)];
                if i % 2 == 0 {
                    corners[1][2] = 0.0;
                    corners[2][2] = 0.0;
                }
                corners
            }
            // Everything within a micrometre, far from the origin.
            _ => [0; 3].map(|_| add([700.0, -300.0, 0.125], cube(&mut random, 1e-6))),
        };
        shape.0.push(corners);
    }
    shape
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn grid_is_brute_force(kind in 0u32..6, count in 1usize..400, seed in any::<u64>()) {
        let shape = soup(kind, count, seed);
        prop_assume!(shape.0.iter().any(|[a, b, c]| vector::cross(sub(*b, *a), sub(*c, *a)) != [0.0; 3]));
        let truth = truth(&[(Semantic::Furniture, shape)]);
        let check = truth.check_grid(600, seed);
        prop_assert_eq!(check.different, 0, "{:?}", check.first_different);
        // Segments, by the same.
        let source = RaySource::new(&truth, seed);
        for index in 0..200 {
            let mut ray = source.ray([RayKind::Box, RayKind::Hard][index as usize % 2], index + 1000);
            let mut random = Random::new(seed, 5, index);
            ray.tmin = random.between(0.0, 2.0);
            ray.tmax = ray.tmin + random.between(-0.1, 4.0);
            prop_assert_eq!(&truth.nearest_by_brute_force(&[ray])[..], &[truth.nearest(&ray)]);
        }
    }

    /// What the walks pass on their way contains all that is near.
    #[test]
    fn walks_miss_nothing_near(kind in 0u32..6, count in 1usize..200, seed in any::<u64>()) {
        let shape = soup(kind, count, seed);
        prop_assume!(shape.0.iter().any(|[a, b, c]| vector::cross(sub(*b, *a), sub(*c, *a)) != [0.0; 3]));
        let truth = truth(&[(Semantic::Furniture, shape)]);
        let source = RaySource::new(&truth, seed);
        for index in 0..50 {
            let line = Line::new(&source.ray(RayKind::Box, index)).unwrap();
            let near = truth.near_line(&line, 0.0, 3.0);
            for t in [0.0, 0.4, 1.7, 3.0] {
                let p = line.at(t);
                let here = truth.grid.near_point(p);
                for (i, corners) in truth.soup.corners.iter().enumerate() {
                    if vector::distance(triangle::closest_point(corners, p), p) < 0.999e-3 {
                        prop_assert!(near.contains(&(i as u32)) && here.contains(&(i as u32)));
                    }
                }
            }
        }
    }
}

#[test]
fn origins_out_of_the_grids_bounds_are_right_too() {
    let truth = truth(&[wall([0.0; 3], [1.0; 3])]);
    let ray = Ray::new([-1e9, 0.25, 0.5], [3.0, 0.0, 0.0]);
    assert_eq!(truth.nearest(&ray).map(|n| n.t), Some(1e9));
    assert_eq!(truth.nearest(&ray), truth.nearest_by_brute_force(&[ray])[0]);
    for origin in [[f64::MAX; 3], [1e300, 0.0, 0.0], [f64::INFINITY; 3]] {
        let ray = Ray::new(origin, [-1.0, -1.0, -1.0]);
        let judgement = truth.judge(&ray, &Answer::Escaped);
        assert!(judgement.verdict.is_right() || ray.is_valid());
    }
}

#[test]
fn a_ray_through_a_shared_edge_and_through_a_vertex() {
    let truth = truth(&[wall([0.0; 3], [1.0; 3])]);
    // The diagonal of the face x = 0, its corners, and the edges of the box.
    for (y, z) in [(0.5, 0.5), (0.0, 0.0), (1.0, 1.0), (0.3, 0.3), (0.0, 0.7), (1.0, 0.2)] {
        let ray = Ray::new([-2.0, y, z], [1.0, 0.0, 0.0]);
        assert_eq!(truth.nearest(&ray).map(|n| n.t), Some(2.0));
        let escaped = truth.judge(&ray, &Answer::Escaped).verdict;
        let on_the_rim = [0.0, 1.0].contains(&y) || [0.0, 1.0].contains(&z);
        assert_eq!(escaped.is_right(), on_the_rim, "{y} {z} {escaped:?}");
        assert_eq!(truth.judge(&ray, &hit(2.0, 0)).verdict, Verdict::Exact);
    }
}

#[test]
fn the_three_answers() {
    let truth = truth(&[wall([0.0; 3], [1.0; 3]), wall([0.5, 0.0, 0.0], [2.0, 1.0, 1.0])]);
    let at = |x: f64| truth.answer(&Ray::new([x, 0.4, 0.6], [1.0, 0.0, 0.0]));
    assert_eq!(at(-1.0), TrueAnswer::Hit(Nearest { t: 1.0, element: ElementId(0), triangle: 8 }));
    assert_eq!(at(0.25), TrueAnswer::InSolid(vec![ElementId(0)]));
    assert_eq!(at(0.75), TrueAnswer::InSolid(vec![ElementId(0), ElementId(1)]));
    assert_eq!(at(3.0), TrueAnswer::Escaped);
    let no_ray = Ray::new([0.5; 3], [0.0; 3]);
    assert_eq!(truth.answer(&no_ray), TrueAnswer::Escaped);
    assert_eq!(truth.judge(&no_ray, &Answer::Escaped).verdict, Verdict::Exact);
    assert!(!truth.judge(&no_ray, &hit(0.5, 0)).verdict.is_right());
    assert!(!truth.judge(&no_ray, &Answer::InSolid(0)).verdict.is_right());
}

#[test]
fn true_answers_are_exact_and_shifts_are_told_apart() {
    let model = house();
    let truth = Truth::new(&model, role_of(&model), &TruthOptions::default());
    let source = RaySource::new(&truth, 3).with_rooms(&model);
    let mut close = 0;
    for index in 0..3000 {
        for kind in [RayKind::Room, RayKind::Outside, RayKind::Solid, RayKind::Hard] {
            let ray = source.ray(kind, index);
            let exact = truth.answer(&ray);
            let verdict = truth.judge(&ray, &answer_of(&exact)).verdict;
            assert!(matches!(verdict, Verdict::Exact | Verdict::InSolidAgreed), "{ray:?} {verdict:?}");
            let TrueAnswer::Hit(nearest) = exact else { continue };
            let e = nearest.element.0;
            if kind == RayKind::Room {
                // Two millimetres are two tolerances: right only where a shift across meets a steep surface.
                let far = truth.judge(&ray, &hit(nearest.t + 2e-3, e)).verdict;
                match far {
                    Verdict::Wrong { why } => assert_eq!(why, Why::WentThrough),
                    Verdict::Edge { delta } => assert!((0.0..=1e-3).contains(&delta)),
                    other => panic!("{ray:?} {other:?}"),
                }
                let near = truth.judge(&ray, &hit(nearest.t - 1e-6, e)).verdict;
                if let Verdict::Close { delta } = near {
                    assert!((delta - 1e-6).abs() < 1e-9);
                    close += 1;
                }
                assert!(near.is_right() || nearest.t < 1e-6, "{near:?}");
                assert_eq!(truth.judge(&ray, &hit(f64::NAN, e)).verdict, wrong(Why::OutsideSegment));
                assert!(!truth.judge(&ray, &hit(nearest.t, 10_000)).verdict.is_right());
                assert!(!truth.judge(&ray, &hit(nearest.t, NONE - 1)).verdict.is_right());
                assert_eq!(truth.judge(&ray, &Answer::Escaped).verdict, wrong(Why::Missed));
            }
        }
    }
    assert!(close > 2900);
}

#[test]
fn steep_hits_are_judged_across_the_ray() {
    // A floor met at a slope of 1 to 1000: 2 mm along the ray are 2 micrometres of height.
    let truth = truth(&[wall([0.0, 0.0, -1.0], [100.0, 10.0, 0.0])]);
    let ray = Ray::new([1.0, 5.0, 0.01], [1.0, 0.0, -1e-3]);
    let t = truth.nearest(&ray).unwrap().t;
    for off in [0.002, -0.002, 0.9, -0.9] {
        let Verdict::Edge { delta } = truth.judge(&ray, &hit(t + off, 0)).verdict else { panic!() };
        let expected = off.abs() * 1e-3;
        assert!(delta >= expected * 0.999 && delta <= expected * 1.01 + 2e-9, "{off}: {delta}");
    }
    assert_eq!(truth.judge(&ray, &hit(t + 1.1, 0)).verdict, wrong(Why::WentThrough));
    assert_eq!(truth.judge(&ray, &hit(t - 1.1, 0)).verdict, wrong(Why::TooEarly));
}

#[test]
fn rays_that_graze_an_edge() {
    // A post before a wall; the ray passes beside the post, or touches it, by down to a billionth of a metre.
    let truth = truth(&[wall([0.0, 0.0, 0.0], [0.3, 0.3, 3.0]), wall([-5.0, 4.0, 0.0], [5.0, 4.2, 3.0])]);
    for direction in [[0.0, 1.0, 0.0], [0.1, 0.8, 0.05], [-0.2, 1.0, 0.3]] {
        for off in [1e-8, 1e-6, -1e-8, -1e-6, 3e-5, -3e-5, 0.7e-3, -0.7e-3, 1.1e-3, -1.1e-3] {
            // Aimed beside the silhouette, which is one of the edges at x = 0.3.
            let unit = vector::unit(direction);
            let across = vector::unit(vector::cross(unit, [0.0, 0.0, 1.0]));
            let corner = if direction[0] < 0.0 { [0.3, 0.3, 1.5] } else { [0.3, 0.0, 1.5] };
            let target = add(corner, scale(across, off));
            let ray = Ray::new(sub(target, scale(unit, 1.0)), direction);
            let exact = truth.nearest(&ray).unwrap();
            assert_eq!(exact.element.0, u32::from(off > 0.0), "{direction:?} {off}");
            // The answer of a ray on the other side of the edge.
            let other = Ray::new(add(ray.origin, scale(across, -1.02 * off)), direction);
            let other = truth.nearest(&other).unwrap();
            assert_ne!(other.element, exact.element);
            match truth.judge(&ray, &hit(other.t, other.element.0)).verdict {
                Verdict::Edge { delta } => {
                    assert!(off.abs() < 1e-3);
                    assert!(delta >= off.abs() * 0.999 && delta <= 1e-3, "{off} {delta}");
                }
                verdict => {
                    assert!(off.abs() > 1e-3 && !verdict.is_right(), "{direction:?} {off} {verdict:?}")
                }
            }
        }
    }
}

#[test]
fn cracks_are_found_and_their_absence_too() {
    // Two walls side by side with a crack of 20 nm; a wall behind.
    let cracked = |gap: f64| {
        truth(&[
            wall([-2.0, 0.0, 0.0], [0.0, 0.2, 3.0]),
            wall([gap, 0.0, 0.0], [2.0, 0.2, 3.0]),
            wall([-2.0, 4.0, 0.0], [2.0, 4.2, 3.0]),
        ])
    };
    let ray = Ray::new([0.8e-3, -1.0, 1.5], [0.0, 1.0, 0.0]);
    let through = hit(5.0, 2);
    let verdict = cracked(2e-8).judge(&ray, &through).verdict;
    assert!(matches!(verdict, Verdict::Edge { delta } if (0.79e-3..0.81e-3).contains(&delta)), "{verdict:?}");
    // Without a crack a tracer that leaks is wrong, even for a ray right at the joint.
    for x in [0.0, 1e-12, 1e-6, -1e-6, 0.8e-3] {
        let ray = Ray::new([x, -1.0, 1.5], [0.0, 1.0, 0.0]);
        assert_eq!(cracked(0.0).judge(&ray, &through).verdict, wrong(Why::WentThrough));
        assert_eq!(cracked(0.0).judge(&ray, &Answer::Escaped).verdict, wrong(Why::Missed));
    }
    // So is one that leaks through an edge between two triangles of one face.
    let one = truth(&[wall([0.0; 3], [1.0; 3])]);
    for off in [0.0, 1e-12, 1e-9, -1e-7] {
        let ray = Ray::new([-1.0, 0.5, 0.5 + off], [1.0, 0.0, 0.0]);
        assert_eq!(one.judge(&ray, &hit(2.0, 0)).verdict, wrong(Why::WentThrough));
    }
}

#[test]
fn flush_and_coplanar_surfaces() {
    let stacked = |gap: f64| {
        truth(&[
            wall([0.0; 3], [1.0; 3]),
            (Semantic::Covering, Shape::cuboid([0.2, 0.2, 1.0 + gap], [0.8, 0.8, 1.01])),
        ])
    };
    let down = Ray::new([0.5, 0.4, 3.0], [0.0, 0.0, -1.0]);
    let up = Ray::new([0.5, 0.4, 1.008], [0.0, 0.0, -1.0]);
    // Onto the covering's underside from within it, and the wall beneath.
    let flush = stacked(0.5e-3);
    assert_eq!(flush.judge(&up, &hit(1.008 - 1.0005, 1)).verdict, Verdict::Exact);
    let verdict = flush.judge(&up, &hit(0.008, 0)).verdict;
    assert!(matches!(verdict, Verdict::Flush { gap } if (gap - 0.5e-3).abs() < 1e-9), "{verdict:?}");
    let apart = stacked(1.2e-3);
    assert_eq!(apart.judge(&up, &hit(0.008, 0)).verdict, wrong(Why::WentThrough));
    let touching = stacked(0.0);
    assert_eq!(touching.judge(&up, &hit(0.008, 0)).verdict, Verdict::Exact);
    assert_eq!(touching.judge(&up, &hit(0.008, 1)).verdict, Verdict::Exact);
    // On top, the covering hides the wall by a centimetre.
    assert_eq!(touching.judge(&down, &hit(2.0, 0)).verdict, wrong(Why::WentThrough));
    assert_eq!(touching.judge(&down, &hit(1.99, 0)).verdict, wrong(Why::OtherElement));
}

#[test]
fn origins_at_the_surface_of_a_solid() {
    let truth = truth(&[wall([0.0; 3], [1.0; 3]), wall([3.0, 0.0, 0.0], [4.0, 1.0, 1.0])]);
    let judge = |x: f64, dx: f64, answer: Answer| {
        truth.judge(&Ray::new([x, 0.4, 0.6], [dx, 0.1, 0.0]), &answer).verdict
    };
    let slant = 1.01f64.sqrt();
    // Half a millimetre inside, leaving: in the solid, or on the air side, where t counts from the origin or from the
    // surface.
    assert_eq!(judge(0.9995, 1.0, Answer::InSolid(0)), Verdict::InSolidAgreed);
    for t in [2.0005 * slant, 2.0 * slant] {
        assert!(matches!(judge(0.9995, 1.0, hit(t, 1)), Verdict::InSolidEdge { .. }));
    }
    assert_eq!(judge(0.9995, 1.0, hit(2.003 * slant, 1)), wrong(Why::StartsInSolid));
    assert_eq!(judge(0.9995, 1.0, Answer::Escaped), wrong(Why::StartsInSolid));
    assert_eq!(judge(0.9995, 1.0, Answer::InSolid(1)), wrong(Why::NotInSolid));
    assert!(matches!(judge(0.9995, -1.0, hit(0.0, 0)), Verdict::InSolidEdge { .. }));
    // Half a millimetre outside.
    assert_eq!(judge(1.0005, 1.0, hit(1.9995 * slant, 1)), Verdict::Exact);
    let edge = judge(1.0005, 1.0, Answer::InSolid(0));
    assert!(
        matches!(edge, Verdict::InSolidEdge { delta } if (0.5e-3..0.501e-3).contains(&delta)),
        "{edge:?}"
    );
    // Too far inside or outside for any excuse.
    assert_eq!(judge(0.998, 1.0, hit(2.002 * slant, 1)), wrong(Why::StartsInSolid));
    assert_eq!(judge(1.002, 1.0, Answer::InSolid(0)), wrong(Why::NotInSolid));
    assert_eq!(judge(0.5, 1.0, hit(0.5 * slant, 0)), wrong(Why::StartsInSolid));
    // Along the surface, half a millimetre inside: out sideways, past the rim.
    let along = Ray::new([0.5, 0.4, 0.9995], [1.0, 0.0, 0.0]);
    assert!(matches!(truth.judge(&along, &Answer::Escaped).verdict, Verdict::InSolidEdge { .. }));
    let behind = truth.judge(&along, &hit(2.5, 1)).verdict;
    assert_eq!(
        behind,
        wrong(Why::StartsInSolid),
        "above the surface the ray passes over the other box as well"
    );
}

#[test]
fn origins_between_two_solids_that_touch() {
    let shapes = [wall([0.0; 3], [1.0; 3]), wall([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])];
    let truth = truth(&shapes);
    let judge = |x: f64, dx: f64, answer: Answer| {
        truth.judge(&Ray::new([x, 0.4, 0.6], [dx, 0.1, 0.0]), &answer).verdict
    };
    for x in [1.0, 0.9996, 1.0004] {
        for dx in [1.0, -1.0] {
            // In either, or at the surface of the one that is entered; but never through to the other end of it.
            assert!(judge(x, dx, Answer::InSolid(0)).is_right());
            assert!(judge(x, dx, Answer::InSolid(1)).is_right());
            assert!(judge(x, dx, hit(0.0, u32::from(dx > 0.0))).is_right());
            assert_eq!(judge(x, dx, hit(1.005, u32::from(dx > 0.0))), wrong(Why::StartsInSolid));
            assert_eq!(judge(x, dx, Answer::Escaped), wrong(Why::StartsInSolid));
        }
    }
    // Along the joint nothing is entered: the ray goes on to the end, or starts in either solid.
    for x in [1.0, 1.0 - 1e-16, 1.0 + 1e-15] {
        let along = Ray::new([x, 0.4, 0.6], [0.0, 1.0, 0.0]);
        let right = |answer| truth.judge(&along, &answer).verdict.is_right();
        assert!(right(Answer::InSolid(0)) && right(Answer::InSolid(1)) && right(hit(0.6, 0)));
        assert!(!right(hit(0.602, 0)) && !right(hit(0.3, 0)));
    }
    // A slope of a thousandth enters.
    let slanted = Ray::new([1.0, 0.4, 0.6], [1e-3, 1.0, 0.0]);
    assert!(!truth.judge(&slanted, &hit(0.6 * (1.0 + 5e-7), 1)).verdict.is_right());
    // Leaving a solid into the air, its own surface is not met.
    for x in [0.0, 4e-4] {
        assert!(!judge(x, -1.0, hit(x, 0)).is_right(), "{x}");
        assert!(judge(x, -1.0, Answer::Escaped).is_right());
    }
}

#[test]
fn detail_and_open_meshes_do_not_carve() {
    let mut open = Shape::cuboid([0.0; 3], [1.0; 3]);
    open.0.pop();
    let shapes = [(Semantic::Wall, open), (Semantic::Furniture, Shape::cuboid([2.0; 3], [3.0; 3]))];
    let truth = truth(&shapes);
    for p in [[0.5, 0.5, 0.5], [2.5, 2.5, 2.5]] {
        let answer = truth.answer(&Ray::new(p, [0.0, 0.0, 1.0]));
        assert!(matches!(answer, TrueAnswer::Hit(n) if n.t == 0.5));
        let element = u32::from(p[0] > 1.0);
        let ray = Ray::new(p, [0.0, 0.0, 1.0]);
        assert_eq!(truth.judge(&ray, &Answer::InSolid(element)).verdict, wrong(Why::NotInSolid));
    }
}

/// A ray hardly off a sheet, which it comes through far off; on both sides are steps that it passes as narrowly.
#[test]
fn starts_at_open_surfaces_count_as_beyond_them() {
    let quad = |corners: [[f64; 3]; 4]| {
        let [a, b, c, d] = corners;
        Shape(vec![[a, b, c], [a, c, d]])
    };
    let upright = |x: f64| quad([[x, -1.0, -1.0], [x, 1.0, -1.0], [x, 1.0, 3.0], [x, -1.0, 3.0]]);
    let level =
        |[from, to]: [f64; 2], z: f64| quad([[from, -1.0, z], [to, -1.0, z], [to, 1.0, z], [from, 1.0, z]]);
    let steps = level([0.0, 1.0], 0.2).and(level([-1.0, -9e-7], 0.1));
    let ceiling = level([-1.0, 1.0], 2.0);
    let around = |sheet: Shape, semantic: Semantic| {
        let rest = [(Semantic::Stair, steps.clone()), (Semantic::Ground, ceiling.clone())];
        truth(&[vec![(semantic, sheet)], rest.to_vec()].concat())
    };
    let ray = Ray::new([-1e-6, 0.1, 0.0], [2e-6, 0.0, 1.0]);
    let beyond = hit(2.0, 2);
    let sheet = around(upright(0.0), Semantic::Wall);
    assert!(matches!(sheet.answer(&ray), TrueAnswer::Hit(n) if n.element == ElementId(0) && n.t > 0.49));
    assert!(
        matches!(sheet.judge(&ray, &beyond).verdict, Verdict::Edge { delta } if (delta - 1e-6).abs() < 1e-9)
    );
    // Through nothing else, to nothing else, and not from farther away.
    assert_eq!(sheet.judge(&ray, &hit(2.5, 2)).verdict, wrong(Why::WentThrough));
    assert_eq!(sheet.judge(&ray, &Answer::Escaped).verdict, wrong(Why::Missed));
    let steeper = Ray::new([-3e-3, 0.1, 0.0], [6e-3, 0.0, 1.0]);
    let exact = 2.0 * (1.0 + 3.6e-5f64).sqrt();
    assert_eq!(sheet.judge(&steeper, &hit(exact, 2)).verdict, wrong(Why::WentThrough));
    // What encloses something is entered.
    let solid = around(Shape::cuboid([0.0, -1.0, -1.0], [0.5, 1.0, 1.5]), Semantic::Wall);
    assert_eq!(solid.judge(&ray, &beyond).verdict, wrong(Why::WentThrough));
}

#[test]
fn segments_end_where_they_should() {
    // Furniture does not carve, so that segments may start within.
    let shape = Shape::cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]);
    let solid = truth(&[(Semantic::Wall, shape.clone())]);
    let truth = truth(&[(Semantic::Furniture, shape)]);
    let judge = |tmin: f64, tmax: f64, answer: Answer| {
        truth.judge(&Ray::segment([0.0, 0.4, 0.6], [2.0, 0.0, 0.0], tmin, tmax), &answer).verdict
    };
    assert_eq!(judge(0.0, 1.0, hit(1.0, 0)), Verdict::Exact);
    assert_eq!(judge(0.0, 0.9, Answer::Escaped), Verdict::Exact);
    assert_eq!(judge(0.0, 0.9, hit(1.0, 0)), wrong(Why::OutsideSegment));
    assert_eq!(judge(1.5, 9.0, hit(2.0, 0)), Verdict::Exact);
    assert_eq!(judge(1.5, 9.0, hit(1.0, 0)), wrong(Why::OutsideSegment));
    // Within the tolerance of an end either is right.
    assert!(matches!(judge(0.0, 1.0005, Answer::Escaped), Verdict::Edge { delta } if delta < 0.501e-3));
    assert!(matches!(judge(0.9995, 9.0, hit(2.0, 0)), Verdict::Edge { delta } if delta < 0.501e-3));
    assert!(!judge(0.0, 1.0015, Answer::Escaped).is_right());
    assert!(!judge(0.9985, 9.0, hit(2.0, 0)).is_right());

    // Into a gap between two solids, of less than the tolerance: each end may be moved into that by itself.
    let walls = [[1.0, 2.0], [2.0004, 3.0]]
        .map(|[from, to]| (Semantic::Wall, Shape::cuboid([from, 0.0, 0.0], [to, 1.0, 1.0])));
    let walls = self::truth(&walls);
    for (length, is_right) in [(0.0004, true), (0.0008, true), (0.0015, true), (0.002, false)] {
        let segment = Ray::segment([1.9995, 0.4, 0.6], [2.0, 0.0, 0.0], 0.0, length);
        let verdict = walls.judge(&segment, &Answer::Escaped).verdict;
        assert_eq!(verdict.is_right(), is_right, "{length}: {verdict:?}");
    }

    // In a solid it matters where a segment starts, not where its origin is.
    let inside = Ray::segment([0.0, 0.4, 0.6], [2.0, 0.0, 0.0], 1.5, 9.0);
    assert_eq!(solid.judge(&inside, &Answer::InSolid(0)).verdict, Verdict::InSolidAgreed);
    assert_eq!(solid.judge(&inside, &hit(2.0, 0)).verdict, wrong(Why::StartsInSolid));
    let out = Ray::segment([1.5, 0.4, 0.6], [2.0, 0.0, 0.0], 0.75, 9.0);
    assert_eq!(solid.judge(&out, &Answer::Escaped).verdict, Verdict::Exact);
    assert_eq!(solid.judge(&out, &Answer::InSolid(0)).verdict, wrong(Why::NotInSolid));
}
