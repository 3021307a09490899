use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::*;
use crate::lattice::{in_pixel, is_between, orient, segment_meets_pixel};

fn p(x: i32, y: i32) -> Point {
    Point::new(x, y)
}

fn seg(x0: i32, y0: i32, x1: i32, y1: i32) -> [Point; 2] {
    [p(x0, y0), p(x1, y1)]
}

/// The points of a segment's way.
fn way(snapped: &Snapped, segments: &[[Point; 2]], i: usize) -> Vec<Point> {
    let mut points = vec![segments[i][0]];
    for &step in snapped.way(i) {
        let [from, to] = snapped.ends(step).map(|v| snapped.vertices[v as usize]);
        assert_eq!(points.last(), Some(&from), "the way of {i} is not connected");
        points.push(to);
    }
    assert_eq!(points.last(), Some(&segments[i][1]), "the way of {i} ends elsewhere");
    points
}

/// Rounds and proves the result.
fn proven(segments: &[[Point; 2]], limits: &SnapLimits) -> Snapped {
    let snapped = snap_within(segments, limits).unwrap();
    assert_eq!(snapped.check(), Ok(()));
    snapped
}

/// Where two segments cross inside both, as x / w and y / w with positive w.
fn crossing([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<[i128; 3]> {
    let cross = |ux: i128, uy: i128, vx: i128, vy: i128| ux * vy - uy * vx;
    let wide = |p: Point| (i128::from(p.x), i128::from(p.y));
    let ((ax, ay), (bx, by), (cx, cy), (dx, dy)) = (wide(a), wide(b), wide(c), wide(d));
    let mut w = cross(bx - ax, by - ay, dx - cx, dy - cy);
    let mut s = cross(cx - ax, cy - ay, dx - cx, dy - cy);
    let mut t = cross(cx - ax, cy - ay, bx - ax, by - ay);
    if w < 0 {
        (w, s, t) = (-w, -s, -t);
    }
    let inside = w > 0 && 0 < s && s < w && 0 < t && t < w;
    inside.then(|| [ax * w + (bx - ax) * s, ay * w + (by - ay) * s, w])
}

/// The method stated again, comparing all with all: the vertices, and each segment's way after so many rounds.
fn slow(segments: &[[Point; 2]], rounds: u32) -> (BTreeSet<Point>, Vec<Vec<Point>>) {
    let mut vertices: BTreeSet<Point> = segments.iter().flatten().copied().collect();
    for (i, &s) in segments.iter().enumerate() {
        for &t in &segments[..i] {
            if let Some(at) = crossing(s, t) {
                let near = |c: i128| (2 * c + at[2]).div_euclid(2 * at[2]) as i32;
                let vertex = p(near(at[0]), near(at[1]));
                assert!(in_pixel(vertex, at));
                vertices.insert(vertex);
            }
        }
    }
    let mut ways: Vec<Vec<Point>> =
        segments.iter().map(|&[a, b]| if a == b { vec![a] } else { vec![a, b] }).collect();
    for _ in 0..rounds {
        let mut changed = false;
        for way in &mut ways {
            let mut next = vec![way[0]];
            for leg in way.windows(2) {
                let (a, b) = (leg[0], leg[1]);
                let mut met: Vec<Point> =
                    vertices.iter().copied().filter(|&v| v != a && segment_meets_pixel(a, b, v)).collect();
                // In order of their feet on the line.
                let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
                met.sort_by_key(|m| i64::from(m.x) * dx + i64::from(m.y) * dy);
                assert_eq!(met.last(), Some(&b));
                next.extend(met);
            }
            changed |= next.len() > way.len();
            *way = next;
        }
        if !changed {
            break;
        }
    }
    (vertices, ways)
}

/// Whether two segments meet elsewhere than at common ends, told from what points they share.
fn meet(s: [Point; 2], t: [Point; 2]) -> bool {
    let on = |[a, b]: [Point; 2], p: Point| orient(a, b, p) == 0 && is_between(a, b, p);
    crossing(s, t).is_some() || t.iter().any(|&p| on(s, p)) || s.iter().any(|&p| on(t, p))
}

/// Everything that must hold, told anew for each.
fn verify(segments: &[[Point; 2]], limits: &SnapLimits) -> Result<Snapped, TestCaseError> {
    let snapped = proven(segments, limits);
    let (vertices, ways) = slow(segments, limits.rounds);
    prop_assert_eq!(&snapped.vertices, &vertices.iter().copied().collect::<Vec<_>>());
    let mut links = BTreeSet::new();
    let (mut farthest, mut rerouted) = (0.0f64, 0);
    for (i, slow_way) in ways.iter().enumerate() {
        prop_assert_eq!(&way(&snapped, segments, i), slow_way);
        rerouted += usize::from(slow_way.len() > 2);
        let [a, b] = segments[i];
        for leg in slow_way.windows(2) {
            links.insert([leg[0].min(leg[1]), leg[0].max(leg[1])]);
        }
        for &q in slow_way {
            farthest = farthest.max(distance(q, a, b));
        }
        // The other way round: places on the segment from the way.
        for k in 0..=16 {
            let s = f64::from(k) / 16.0;
            let at = [a.x, a.y].map(f64::from);
            let place = [at[0] + s * (f64::from(b.x) - at[0]), at[1] + s * (f64::from(b.y) - at[1])];
            let near = slow_way
                .windows(2)
                .map(|leg| distance_f64(place, leg[0], leg[1]))
                .fold(if a == b { 0.0 } else { f64::INFINITY }, f64::min);
            prop_assert!(near <= snapped.displacement + 1e-6, "{near} > {}", snapped.displacement);
        }
    }
    prop_assert!((farthest - snapped.displacement).abs() < 1e-6);
    prop_assert!(snapped.displacement <= f64::from(snapped.rounds) * 0.5f64.sqrt() + 1e-9);
    prop_assert_eq!(snapped.rerouted, rerouted);
    let expected: Vec<[Point; 2]> = links.into_iter().collect();
    let found: Vec<[Point; 2]> =
        snapped.links.iter().map(|link| link.map(|v| snapped.vertices[v as usize])).collect();
    prop_assert_eq!(&found, &expected);
    for (i, &s) in found.iter().enumerate() {
        for &t in &found[..i] {
            prop_assert!(!meet(s, t), "{s:?} meets {t:?}");
        }
        for &v in &snapped.vertices {
            prop_assert!(orient(s[0], s[1], v) != 0 || !is_between(s[0], s[1], v), "{v:?} lies on {s:?}");
            if snapped.settled {
                prop_assert!(s.contains(&v) || !segment_meets_pixel(s[0], s[1], v));
            }
        }
    }
    if snapped.settled {
        // Rounding the result again changes nothing.
        let again = snap(&found).unwrap();
        prop_assert_eq!(again.rounds, 0);
        prop_assert_eq!(&again.links.len(), &found.len());
    }
    let mut different: Vec<[Point; 2]> =
        segments.iter().map(|&[a, b]| [a.min(b), a.max(b)]).filter(|s| s[0] != s[1]).collect();
    different.sort();
    different.dedup();
    let crossings = (0..different.len())
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .filter(|&(i, j)| crossing(different[i], different[j]).is_some());
    prop_assert_eq!(snapped.crossings, crossings.count() as u64);
    Ok(snapped)
}

fn distance(q: Point, a: Point, b: Point) -> f64 {
    distance_f64([f64::from(q.x), f64::from(q.y)], a, b)
}

fn distance_f64(q: [f64; 2], a: Point, b: Point) -> f64 {
    let [dx, dy] = [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
    let [ex, ey] = [q[0] - f64::from(a.x), q[1] - f64::from(a.y)];
    let square = dx * dx + dy * dy;
    let s = if square == 0.0 { 0.0 } else { ((ex * dx + ey * dy) / square).clamp(0.0, 1.0) };
    (ex - s * dx).hypot(ey - s * dy)
}

fn all() -> SnapLimits {
    SnapLimits::default()
}

fn one_round() -> SnapLimits {
    SnapLimits { rounds: 1, ..SnapLimits::default() }
}

#[test]
fn nothing_gives_nothing() {
    let snapped = proven(&[], &all());
    assert_eq!((snapped.vertices.len(), snapped.links.len(), snapped.settled), (0, 0, true));
}

#[test]
fn a_cross_gets_its_middle() {
    // They cross at (2.5, 2.5), which the pixel about (3, 3) holds.
    let segments = [seg(0, 0, 5, 5), seg(5, 0, 0, 5)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(way(&snapped, &segments, 0), [p(0, 0), p(3, 3), p(5, 5)]);
    assert_eq!(way(&snapped, &segments, 1), [p(5, 0), p(3, 3), p(0, 5)]);
    assert_eq!((snapped.crossings, snapped.added, snapped.rounds, snapped.rerouted), (1, 1, 1, 2));
    assert!((snapped.displacement - 0.5f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_tee_splits_the_bar() {
    let segments = [seg(10, 0, -10, 0), seg(3, 0, 3, 7)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(way(&snapped, &segments, 0), [p(10, 0), p(3, 0), p(-10, 0)]);
    assert_eq!((snapped.crossings, snapped.added, snapped.links.len()), (0, 0, 3));
}

#[test]
fn overlaps_share_links() {
    let segments = [seg(0, 0, 6, 3), seg(8, 4, 2, 1), seg(0, 0, 6, 3), seg(6, 3, 0, 0), seg(4, 2, 4, 2)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(snapped.links.len(), 4);
    assert_eq!(snapped.way(0), snapped.way(2));
    let back: Vec<Step> = snapped.way(0).iter().rev().map(|s| s.back()).collect();
    assert_eq!(snapped.way(3), back);
    assert!(snapped.way(4).is_empty());
    assert_eq!(snapped.vertex(p(4, 2)), Some(2));
    assert_eq!(snapped.vertex(p(4, 3)), None);
}

#[test]
fn a_star_through_one_pixel_has_one_middle() {
    // Its lines, 30 degrees apart, cross pairwise at different places of the pixel about the origin.
    let directions = [(1000, 0), (866, 500), (500, 866), (0, 1000), (-500, 866), (-866, 500)];
    let segments: Vec<[Point; 2]> =
        directions.iter().zip(0..).map(|(&(x, y), i)| seg(x, y, -4 * x, -4 * y + i % 2)).collect();
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!((snapped.crossings, snapped.added, snapped.links.len()), (15, 1, 12));
    assert!((0..6).all(|i| way(&snapped, &segments, i)[1] == p(0, 0)));
}

#[test]
fn long_pairs_one_unit_apart() {
    let far = LARGEST;
    // They cross at a slope of 2^-25, near x = 0, and both pass many pixels of the other's rounded crossing row.
    let segments = [seg(-far, 0, far, 1), seg(-far, 1, far, 0), seg(-far, -1, far, 0), seg(-far, 2, far, 2)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(snapped.crossings, 1);
    let turned =
        [seg(-far, -far, far, far - 1), seg(-far, -far + 1, far, far), seg(-far + 1, -far, far, far)];
    let snapped = verify(&turned, &all()).unwrap();
    assert!(snapped.displacement < 0.8, "{}", snapped.displacement);
}

#[test]
fn vertices_within_half_a_unit_attract() {
    // At x = 5 the line is at y = 1/2: on the lower side of the pixel about (5, 1), which that holds; on the upper side
    // of that about (5, 0), which that does not. But it passes through that before.
    let line = seg(0, 0, 10, 1);
    let segments = [line, seg(5, 1, 5, 4)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(way(&snapped, &segments, 0), [p(0, 0), p(5, 1), p(10, 1)]);
    let segments = [line, seg(5, 0, 5, -4), seg(6, 0, 6, -4), seg(5, 1, 5, 4)];
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!(way(&snapped, &segments, 0), [p(0, 0), p(5, 0), p(5, 1), p(10, 1)]);
}

#[test]
fn later_rounds_part_vertices_and_links() {
    // The line is above the pixel about (5, 0), but no more once it is led through (2, 0).
    let segments = [seg(0, 0, 8, 1), seg(2, 0, 2, -3), seg(5, 0, 5, -3)];
    let once = verify(&segments, &one_round()).unwrap();
    assert_eq!(way(&once, &segments, 0), [p(0, 0), p(2, 0), p(8, 1)]);
    assert!(!once.settled);
    let settled = verify(&segments, &all()).unwrap();
    assert_eq!(way(&settled, &segments, 0), [p(0, 0), p(2, 0), p(5, 0), p(8, 1)]);
    assert_eq!((once.rounds, settled.rounds, settled.settled), (1, 2, true));
    assert!(once.displacement < settled.displacement);
}

#[test]
fn all_in_one_line() {
    let segments: Vec<[Point; 2]> =
        (0..60).map(|i| seg(7 * i % 50 * 3, 7 * i % 50 * 2, 11 * i % 53 * 3, 11 * i % 53 * 2)).collect();
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!((snapped.links.len(), snapped.crossings), (snapped.vertices.len() - 1, 0));
}

#[test]
fn a_grid_of_lines_crosses_everywhere() {
    let mut segments = Vec::new();
    for i in 0..40 {
        segments.push(seg(-100, 50 * i, 2100, 50 * i + 13));
        segments.push(seg(50 * i, -100, 50 * i + 17, 2100));
    }
    let snapped = verify(&segments, &all()).unwrap();
    assert_eq!((snapped.crossings, snapped.added), (1600, 1600));
    assert_eq!(snapped.links.len(), 2 * 40 * 41);
}

#[test]
fn limits_hold() {
    let lines: Vec<[Point; 2]> =
        (0..100).flat_map(|i| [seg(-1, 3 * i, 300, 3 * i), seg(3 * i, -1, 3 * i, 300)]).collect();
    let snapped = snap(&lines).unwrap();
    let steps: usize = (0..lines.len()).map(|i| snapped.way(i).len()).sum();
    let within = |change: fn(&mut SnapLimits, u64), value: u64| {
        let mut limits = all();
        change(&mut limits, value);
        snap_within(&lines, &limits)
    };
    let crossings = |limits: &mut SnapLimits, value| limits.crossings = value;
    assert_eq!(within(crossings, snapped.crossings).as_ref(), Ok(&snapped));
    assert_eq!(within(crossings, snapped.crossings - 1), Err(SnapError::Crossings(snapped.crossings - 1)));
    let by_steps = |limits: &mut SnapLimits, value| limits.steps = value;
    assert_eq!(within(by_steps, steps as u64).as_ref(), Ok(&snapped));
    assert_eq!(within(by_steps, steps as u64 - 1), Err(SnapError::Steps(steps as u64 - 1)));
    assert_eq!(within(|limits, value| limits.tests = value, 1000), Err(SnapError::Tests(1000)));
}

#[test]
fn ends_beyond_the_lattice_are_refused() {
    let far = LARGEST + 1;
    assert!(snap(&[seg(0, 0, 1, 1), seg(LARGEST, -LARGEST, -LARGEST, LARGEST)]).is_ok());
    assert_eq!(
        snap(&[seg(0, 0, 1, 1), seg(0, 0, 0, -far)]),
        Err(SnapError::Beyond { segment: 1, at: p(0, -far) })
    );
    assert!(snap(&[seg(i32::MIN, i32::MAX, 0, 0)]).is_err());
}

#[test]
fn the_check_finds_flaws() {
    let with = |vertices: &[Point], links: &[[u32; 2]]| {
        let base = snap(&[]).unwrap();
        Snapped { vertices: vertices.to_vec(), links: links.to_vec(), ..base }.check()
    };
    let square = [p(0, 0), p(0, 4), p(4, 0), p(4, 4)];
    assert_eq!(with(&square, &[[0, 1], [0, 2], [0, 3], [1, 3], [2, 3]]), Ok(()));
    assert_eq!(with(&square, &[[0, 3], [1, 2]]), Err(Flaw::Meet(0, 1)));
    assert_eq!(with(&[p(0, 0), p(0, 4), p(0, 2)], &[]), Err(Flaw::Vertices(2)));
    assert_eq!(with(&square, &[[0, 2], [0, 1]]), Err(Flaw::Links(1)));
    assert_eq!(with(&square, &[[0, 2], [2, 1]]), Err(Flaw::Links(1)));
    assert_eq!(with(&square, &[[0, 4]]), Err(Flaw::Links(0)));
    // A vertex on a link, with and without a link of its own; links that overlap, from a common end and not.
    let row = [p(0, 0), p(2, 1), p(4, 2), p(5, 9), p(6, 3)];
    assert_eq!(with(&row, &[[0, 2]]), Err(Flaw::OnLink { vertex: 1, link: 0 }));
    assert_eq!(with(&row, &[[0, 2], [1, 3]]), Err(Flaw::Meet(0, 1)));
    assert_eq!(with(&row, &[[0, 1], [0, 2]]), Err(Flaw::Meet(0, 1)));
    assert_eq!(with(&row, &[[0, 2], [1, 4]]), Err(Flaw::Meet(0, 1)));
    assert_eq!(with(&row, &[[0, 4], [1, 2]]), Err(Flaw::Meet(0, 1)));
    assert_eq!(with(&row, &[[0, 1], [1, 2], [2, 4]]), Ok(()));
}

fn points(size: i32) -> impl Strategy<Value = Point> {
    (-size..=size, -size..=size).prop_map(|(x, y)| p(x, y))
}

fn segments(size: i32, count: usize) -> impl Strategy<Value = Vec<[Point; 2]>> {
    prop::collection::vec([points(size), points(size)], 0..count)
}

/// Long segments and short ones near them, ends moved by a unit or two.
fn mixed(count: usize) -> impl Strategy<Value = Vec<[Point; 2]>> {
    let long = prop::collection::vec([points(LARGEST - 100), points(LARGEST - 100)], 1..6);
    let near = prop::collection::vec(
        (0usize..6, 0.0..1.0f64, points(2), 0.0..1.0f64, points(2), any::<bool>()),
        0..count,
    );
    (long, near).prop_map(|(mut all, near)| {
        for (of, s, move_s, t, move_t, tiny) in near {
            let [a, b] = all[of % all.len()];
            let at = |s: f64, by: Point| {
                let c = |a: i32, b: i32| (f64::from(a) + s * (f64::from(b) - f64::from(a))).round() as i32;
                p(
                    (c(a.x, b.x) + by.x).clamp(-LARGEST, LARGEST),
                    (c(a.y, b.y) + by.y).clamp(-LARGEST, LARGEST),
                )
            };
            all.push([at(s, move_s), at(if tiny { s } else { t }, move_t)]);
        }
        all
    })
}

/// Segments from near one point, or through it, in all directions.
fn fans() -> impl Strategy<Value = Vec<[Point; 2]>> {
    (points(LARGEST / 4), prop::collection::vec((points(2), points(1 << 20), any::<bool>()), 1..25)).prop_map(
        |(middle, rays)| {
            let add = |a: Point, b: Point, k: i32| p(a.x + k * b.x, a.y + k * b.y);
            rays.into_iter()
                .map(|(off, to, through)| {
                    let from = add(middle, off, 1);
                    [if through { add(from, to, -1) } else { from }, add(from, to, 1)]
                })
                .collect()
        },
    )
}

/// Turned rectangles on a grid, that meet and miss their neighbours by a unit.
fn walls() -> impl Strategy<Value = Vec<[Point; 2]>> {
    (0.0..1.6f64, 3.0..3e5f64, prop::collection::vec((0..4i32, 0..4i32, 1..4i32, 1..4i32, points(1)), 1..9))
        .prop_map(|(angle, unit, walls)| {
            let (sin, cos) = angle.sin_cos();
            let turn =
                |x: f64, y: f64| p((cos * x - sin * y).round() as i32, (sin * x + cos * y).round() as i32);
            let mut all = Vec::new();
            for (x, y, w, d, off) in walls {
                let left = f64::from(x) * unit + f64::from(off.x);
                let low = f64::from(y) * unit + f64::from(off.y);
                let (right, high) = (left + f64::from(w) * unit, low + f64::from(d) * unit);
                let corners = [turn(left, low), turn(right, low), turn(right, high), turn(left, high)];
                all.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
            }
            all
        })
}

proptest! {
    #[test]
    fn small_segments_are_rounded_right(segments in segments(20, 60)) {
        verify(&segments, &all())?;
    }

    #[test]
    fn one_round_suffices_for_no_crossing(segments in segments(30, 40)) {
        verify(&segments, &one_round())?;
    }

    #[test]
    fn two_rounds_too(segments in segments(100, 40)) {
        verify(&segments, &SnapLimits { rounds: 2, ..all() })?;
    }

    #[test]
    fn large_segments_are_rounded_right(segments in segments(LARGEST, 25)) {
        verify(&segments, &all())?;
    }

    #[test]
    fn short_ones_near_long_ones_are_rounded_right(segments in mixed(30)) {
        verify(&segments, &all())?;
    }

    #[test]
    fn fans_are_rounded_right(segments in fans()) {
        verify(&segments, &all())?;
    }

    #[test]
    fn walls_are_rounded_right(segments in walls()) {
        verify(&segments, &all())?;
    }

    #[test]
    fn closed_chains_stay_closed(corners in prop::collection::vec(points(12), 1..30)) {
        let segments: Vec<[Point; 2]> =
            (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]).collect();
        let snapped = proven(&segments, &all());
        let mut balance: BTreeMap<u32, i32> = BTreeMap::new();
        for i in 0..segments.len() {
            for &step in snapped.way(i) {
                let [from, to] = snapped.ends(step);
                *balance.entry(from).or_default() -= 1;
                *balance.entry(to).or_default() += 1;
            }
        }
        prop_assert!(balance.values().all(|&sum| sum == 0));
    }

    #[test]
    fn order_and_direction_do_not_matter(
        segments in segments(15, 30), turned in prop::collection::vec(any::<bool>(), 30), first in 0usize..30,
    ) {
        let mut other: Vec<[Point; 2]> = segments
            .iter()
            .zip(turned)
            .map(|(&[a, b], turned)| if turned { [b, a] } else { [a, b] })
            .collect();
        let first = first.min(other.len());
        other.rotate_left(first);
        let (snapped, same) = (snap(&segments).unwrap(), snap(&other).unwrap());
        prop_assert_eq!(snapped.vertices, same.vertices);
        prop_assert_eq!(snapped.links, same.links);
        prop_assert_eq!(snapped.displacement, same.displacement);
    }

    /// Links that nobody rounded: the check finds a flaw just where comparing all with all does.
    #[test]
    fn the_check_is_right(segments in segments(12, 14)) {
        let sites = sites::collect(&segments);
        let links = sites.pairs.clone();
        let spans = sites.spans();
        let lone = |v: &Point| segments.iter().any(|s| s.contains(v));
        let bad = spans.iter().enumerate().any(|(i, &s)| {
            spans[..i].iter().any(|&t| meet(s, t))
                || sites.points.iter().any(|v| lone(v) && orient(s[0], s[1], *v) == 0 && is_between(s[0], s[1], *v))
        });
        let claimed = Snapped { vertices: sites.points.clone(), links, ..snap(&[]).unwrap() };
        prop_assert_eq!(claimed.check().is_err(), bad);
    }
}

/// So many that the plan is cut, at every depth: against comparing all with all.
#[test]
fn many_segments_are_rounded_right() {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut random = |size: i32| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        ((state >> 33) % (2 * size as u64 + 1)) as i32 - size
    };
    let mut all = Vec::new();
    for i in 0..1500 {
        // From everywhere to one corner, short and long.
        let (place, length) = [(1_000_000, 2_000), (30_000, 3_000), (200, 40)][i % 3];
        let (x, y) = (random(place), random(place));
        all.push(seg(x, y, x + random(length), y + random(length)));
    }
    for _ in 0..20 {
        all.push(seg(random(1_000_000), random(1_000_000), random(1_000_000), random(1_000_000)));
    }
    let snapped = verify(&all, &SnapLimits::default()).unwrap();
    assert!(snapped.crossings > 500 && snapped.rounds > 1, "{} {}", snapped.crossings, snapped.rounds);
}
