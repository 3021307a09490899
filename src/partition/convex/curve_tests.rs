//! Regions with curved walls, cut under hoods; and the base line.

use proptest::prelude::*;

use super::tests::{Drawn, STYLES, area, check, numbered, random_region};
use super::*;

/// What both ways of cutting make of a region; checked.
fn both(drawn: &Drawn) -> [Drawn; 2] {
    [Convexification::Cost, Convexification::Diagonals].map(|how| {
        let mut points = drawn.points.clone();
        let parts = cut(&drawn.loops, &mut points, how, true).unwrap();
        assert_eq!(points[..drawn.points.len()], drawn.points);
        let with = Drawn { loops: drawn.loops.clone(), points: points.clone() };
        check(&with, &parts);
        Drawn { loops: parts, points }
    })
}

fn cost(parts: &Drawn) -> f64 {
    expected_cost(&parts.loops, &parts.points)
}

/// Points of an arc from one angle to another, degrees, both included.
fn arc([x, y]: [f64; 2], radius: f64, [from, to]: [f64; 2], facets: usize) -> Vec<Point> {
    (0..=facets)
        .map(|k| {
            let angle = (from + (to - from) * k as f64 / facets as f64).to_radians();
            Point::new((x + radius * angle.cos()).round() as i32, (y + radius * angle.sin()).round() as i32)
        })
        .collect()
}

/// A region of an outer chain and holes, all given by their points.
fn region(chains: &[Vec<Point>]) -> Drawn {
    let (mut points, mut loops) = (Vec::new(), Vec::new());
    for chain in chains {
        let first = points.len() as u32;
        points.extend(chain);
        loops.push((first..points.len() as u32).collect());
    }
    Drawn { loops, points }
}

fn rectangle(w: i32, h: i32) -> Vec<Point> {
    vec![Point::new(0, 0), Point::new(w, 0), Point::new(w, h), Point::new(0, h)]
}

#[test]
fn a_wall_that_bulges_into_a_room_goes_under_a_hood() {
    const METRE: f64 = 65536.0;
    for facets in [8, 16, 32, 64] {
        // The western wall bulges.
        let mut room = rectangle((12.0 * METRE) as i32, (9.0 * METRE) as i32);
        room.extend(arc([0.0, 4.5 * METRE], 2.2 * METRE, [90.0, -90.0], facets));
        let [by_cost, base] = both(&region(&[room.clone()]));
        let free = by_cost.points.len() - base.points.len();
        assert!((2..=8).contains(&free), "{facets} facets: {free} corners of hoods");
        let without = expected_cost(&convex_parts(&region(&[room.clone()]).loops, &room).unwrap(), &room);
        let about = expected_cost(&[vec![0, 1, 2, 3]], &room);
        println!("{facets} facets: {} of {} or {without} of {about}", cost(&by_cost), cost(&base));
        let share = if facets < 32 { 0.8 } else { 0.5 };
        assert!(cost(&by_cost) < share * without.min(cost(&base)), "{facets} facets");
    }
}

#[test]
fn a_round_column_goes_under_a_hood() {
    const METRE: f64 = 65536.0;
    for facets in [6, 12, 32] {
        let mut column = arc([5.0 * METRE, 4.0 * METRE], 0.4 * METRE, [10.0, 370.0], facets);
        column.pop();
        column.reverse();
        let room = rectangle((12.0 * METRE) as i32, (9.0 * METRE) as i32);
        let [by_cost, base] = both(&region(&[room, column]));
        assert!(by_cost.points.len() >= base.points.len() + 4 || facets < 12, "{facets} facets");
        // Sums of the same, in another order.
        assert!(
            cost(&by_cost) <= cost(&base) * (1.0 + 1e-12),
            "{facets} facets: {} {}",
            cost(&by_cost),
            cost(&base)
        );
    }
}

#[test]
fn curves_that_leave_no_room_for_a_hood_have_none() {
    // Two columns that nearly touch each other, and one that nearly touches the wall.
    let column = |x: f64| {
        let mut circle = arc([x, 3000.0], 1000.0, [0.0, 360.0], 24);
        circle.pop();
        circle.reverse();
        circle
    };
    both(&region(&[rectangle(9000, 4010), column(2000.0), column(4010.0), column(7990.0)]));
    // A column whose facets are as short as the lattice can tell.
    let mut tiny = arc([20.0, 20.0], 5.0, [0.0, 360.0], 12);
    tiny.pop();
    tiny.reverse();
    tiny.dedup();
    both(&region(&[rectangle(40, 40), tiny]));
}

#[test]
fn the_base_line_needs_two_diagonals_for_a_deep_corner() {
    let points = [(-1, 10), (-5, 0), (5, 0), (1, 10), (0, 1)];
    let drawn = numbered(&points, &[&[0, 1, 2, 3, 4]]);
    let [by_cost, base] = both(&drawn);
    assert_eq!((by_cost.loops.len(), base.loops.len()), (3, 3));
}

proptest! {
    #[test]
    fn the_base_line_has_two_parts_for_each_reflex_corner_and_one_at_most(
        seed in any::<u64>(), width in 2usize..9, share in 90u64..250, style in prop::sample::select(&STYLES[..]),
    ) {
        let drawn = random_region(seed, width, share, style, 100);
        let region = Region::new(&drawn.loops, &drawn.points).unwrap();
        let outer = region.chains.iter().filter(|chain| {
            let chain: Vec<u32> = chain.iter().map(|&v| region.ids[v as usize]).collect();
            area(&drawn, &chain) > 0
        });
        // What touches itself may be several, and of few squares there may be none.
        if outer.count() != 1 {
            return Ok(());
        }
        let parts = diagonals::cut(&region).unwrap();
        let parts: Vec<Vec<u32>> =
            parts.into_iter().map(|part| part.into_iter().map(|v| region.ids[v as usize]).collect()).collect();
        check(&drawn, &parts);
        let reflex = |chain: &Vec<u32>| {
            let at = |k: usize| region.points[chain[k % chain.len()] as usize];
            (0..chain.len()).filter(|&k| orient(at(k), at(k + 1), at(k + 2)) < 0).count()
        };
        if let [chain] = &region.chains[..] {
            prop_assert!(parts.len() <= 2 * reflex(chain) + 1, "{} of {}", parts.len(), reflex(chain));
        }
    }

    #[test]
    fn random_rooms_with_round_walls_are_cut(
        columns in prop::collection::vec((500.0..9500.0f64, 500.0..6500.0f64, 60.0..900.0f64, 5usize..40, 0.0..360.0f64), 0..6),
        bulge in prop::option::of((1000.0..3000.0f64, 6usize..40, 60.0..120.0f64)),
        scale in prop::sample::select(&[1.0f64, 0.05, 200.0][..]),
    ) {
        let mut outer = rectangle((10_000.0 * scale) as i32, (7_000.0 * scale) as i32);
        if let Some((radius, facets, half)) = bulge {
            let x = -radius * half.to_radians().cos();
            outer.extend(arc([x * scale, 3_500.0 * scale], radius * scale, [half, -half], facets));
        }
        let mut chains = vec![outer];
        let mut taken: Vec<(f64, f64, f64)> = bulge.map(|(radius, _, half)| (-radius * half.to_radians().cos(), 3_500.0, radius)).into_iter().collect();
        for (x, y, radius, facets, turn) in columns {
            let apart = |&(a, b, r): &(f64, f64, f64)| (x - a).hypot(y - b) > radius + r + 40.0;
            if x - radius < 30.0 || x + radius > 9_970.0 || y - radius < 30.0 || y + radius > 6_970.0 || !taken.iter().all(apart) {
                continue;
            }
            taken.push((x, y, radius));
            let mut circle = arc([x * scale, y * scale], radius * scale, [turn, turn + 360.0], facets);
            circle.pop();
            circle.reverse();
            chains.push(circle);
        }
        let distinct: std::collections::BTreeSet<Point> = chains.iter().flatten().copied().collect();
        if distinct.len() < chains.iter().map(Vec::len).sum() {
            return Ok(());
        }
        let drawn = region(&chains);
        if Region::new(&drawn.loops, &drawn.points).is_err() || convex_parts(&drawn.loops, &drawn.points).is_err() {
            return Ok(());
        }
        let [by_cost, _] = both(&drawn);
        let plain = convex_parts(&drawn.loops, &drawn.points).unwrap();
        prop_assert!(cost(&by_cost) <= expected_cost(&plain, &drawn.points));
    }
}
