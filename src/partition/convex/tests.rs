//! Regions are drawn as sets of squares of a grid whose vertices are then moved: their boundaries have holes, touch at
//! vertices, and run straight or with small kinks.

use proptest::prelude::*;

use super::*;
use crate::lattice::double_area;

/// A small deterministic generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Below `n`.
    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 11) as usize % n
    }
}

/// A region: boundary chains and points.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) loops: Vec<Vec<u32>>,
    pub(super) points: Vec<Point>,
}

/// The largest connected set among the squares of a grid that are filled, as squares.
fn connected(filled: &[bool], width: usize) -> Vec<bool> {
    let mut best = vec![false; filled.len()];
    let mut seen = vec![false; filled.len()];
    let mut largest = 0;
    for start in 0..filled.len() {
        let mut set = Vec::new();
        let mut open = vec![start];
        while let Some(k) = open.pop() {
            if !filled[k] || std::mem::replace(&mut seen[k], true) {
                continue;
            }
            set.push(k);
            let (x, y) = (k % width, k / width);
            if x > 0 {
                open.push(k - 1);
            }
            if x + 1 < width {
                open.push(k + 1);
            }
            if y > 0 {
                open.push(k - width);
            }
            if k + width < filled.len() {
                open.push(k + width);
            }
        }
        if set.len() > largest {
            largest = set.len();
            best.fill(false);
            for k in set {
                best[k] = true;
            }
        }
    }
    best
}

/// The boundary of filled squares; `at` places the grid's vertices. Vertices in the middle of straight sides of squares
/// stay if `keep_straight`. At touching vertices the chains are linked by `touch`: staying or crossing over.
fn draw(
    filled: &[bool],
    width: usize,
    keep_straight: bool,
    touch: bool,
    at: impl Fn(usize, usize) -> Point,
) -> Drawn {
    let height = filled.len() / width;
    let is = |x: i64, y: i64| {
        x >= 0
            && y >= 0
            && (x as usize) < width
            && (y as usize) < height
            && filled[y as usize * width + x as usize]
    };
    let columns = width + 1;
    // Edges by start and direction: +x, +y, -x, -y; the region on the left.
    let mut edges = vec![[false; 4]; columns * (height + 1)];
    for y in 0..=height as i64 {
        for x in 0..=width as i64 {
            let v = y as usize * columns + x as usize;
            edges[v] = [
                is(x, y) && !is(x, y - 1),
                is(x - 1, y) && !is(x, y),
                is(x - 1, y - 1) && !is(x - 1, y),
                is(x, y - 1) && !is(x - 1, y - 1),
            ];
        }
    }
    let mut loops = Vec::new();
    for start in 0..edges.len() {
        for first in 0..4 {
            let (mut v, mut direction) = (start, first);
            let mut chain = Vec::new();
            let mut last = None;
            while std::mem::take(&mut edges[v][direction]) {
                if keep_straight || last != Some(direction) {
                    chain.push(v as u32);
                }
                last = Some(direction);
                v = match direction {
                    0 => v + 1,
                    1 => v + columns,
                    2 => v - 1,
                    _ => v - columns,
                };
                // Left stays in the wedge that was left; right crosses over where squares touch.
                let turns = if touch { [1, 0, 3] } else { [3, 0, 1] };
                if let Some(turn) = turns.iter().find(|t| edges[v][(direction + **t) % 4]) {
                    direction = (direction + turn) % 4;
                } else {
                    break;
                }
            }
            if chain.is_empty() {
                continue;
            }
            // The first vertex may be straight too.
            if !keep_straight && last == Some(first) {
                chain.remove(0);
            }
            loops.push(chain);
        }
    }
    let points = (0..edges.len()).map(|v| at(v % columns, v / columns)).collect();
    Drawn { loops, points }
}

pub(super) fn area(drawn: &Drawn, polygon: &[u32]) -> i128 {
    let corners: Vec<Point> = polygon.iter().map(|&v| drawn.points[v as usize]).collect();
    i128::from(double_area(&corners))
}

/// Everything that must hold of a cut, checked without its own code.
pub(super) fn check(drawn: &Drawn, parts: &[Vec<u32>]) {
    let mut edges: Vec<(u32, u32)> = Vec::new();
    for part in parts {
        let n = part.len();
        let corner = |k: usize| drawn.points[part[k % n] as usize];
        assert!(area(drawn, part) > 0);
        for k in 0..n {
            assert!(orient(corner(k), corner(k + 1), corner(k + 2)) >= 0, "{drawn:?} {parts:?}");
            // All of the part lies on the left of each side: corners that turn left could wind twice.
            for other in 0..n {
                assert!(orient(corner(k), corner(k + 1), corner(other)) >= 0);
            }
            edges.push((part[k], part[(k + 1) % n]));
        }
    }
    let all: i128 = drawn.loops.iter().map(|chain| area(drawn, chain)).sum();
    assert_eq!(parts.iter().map(|part| area(drawn, part)).sum::<i128>(), all);
    // Each edge has its other side in another part, or is one of the boundary.
    edges.sort_unstable();
    assert!(edges.windows(2).all(|w| w[0] != w[1]));
    let mut rim: Vec<(u32, u32)> =
        edges.iter().copied().filter(|&(a, b)| edges.binary_search(&(b, a)).is_err()).collect();
    let mut boundary: Vec<(u32, u32)> = drawn
        .loops
        .iter()
        .flat_map(|chain| (0..chain.len()).map(|k| (chain[k], chain[(k + 1) % chain.len()])))
        .collect();
    rim.sort_unstable();
    boundary.sort_unstable();
    assert_eq!(rim, boundary);
}

pub(super) fn numbered(points: &[(i32, i32)], loops: &[&[u32]]) -> Drawn {
    Drawn {
        loops: loops.iter().map(|l| l.to_vec()).collect(),
        points: points.iter().map(|&(x, y)| Point::new(x, y)).collect(),
    }
}

/// Cuts and checks; the number of parts.
fn count(points: &[(i32, i32)], loops: &[&[u32]]) -> usize {
    let drawn = numbered(points, loops);
    let parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
    check(&drawn, &parts);
    parts.len()
}

#[test]
fn known_regions_are_cut_into_the_fewest_parts() {
    // A square with a vertex in the middle of a side.
    assert_eq!(count(&[(0, 0), (2, 0), (4, 0), (4, 4), (0, 4)], &[&[0, 1, 2, 3, 4]]), 1);
    // An L.
    assert_eq!(count(&[(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)], &[&[0, 1, 2, 3, 4, 5]]), 2);
    // A plus: two cuts join two reflex corners each.
    let plus =
        [(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)];
    assert_eq!(count(&plus, &[&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]]), 3);
    // A frame.
    let frame = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 3), (6, 3), (6, 6), (3, 6)];
    assert_eq!(count(&frame, &[&[0, 1, 2, 3], &[7, 6, 5, 4]]), 4);
    // A hole that touches the outer chain at a vertex, as two chains and as one, linked either way.
    let pinched = [(0, 0), (4, 0), (8, 0), (8, 8), (0, 8), (6, 4), (2, 4)];
    let parts = count(&pinched, &[&[0, 1, 2, 3, 4], &[1, 6, 5]]);
    assert_eq!(count(&pinched, &[&[0, 1, 6, 5, 1, 2, 3, 4]]), parts);
    assert_eq!(parts, 3);
    // Two squares that touch at a vertex.
    let eight = [(0, 0), (2, 0), (2, 2), (0, 2), (4, 2), (4, 4), (2, 4)];
    assert_eq!(count(&eight, &[&[0, 1, 2, 4, 5, 6, 2, 3]]), 2);
}

#[test]
fn parts_are_fat_where_there_is_a_choice() {
    // A T: the foot may be cut off along its top or by two slanted cuts; the short cut is best.
    let tee = [(0, 4), (4, 4), (4, 0), (5, 0), (5, 4), (9, 4), (9, 6), (0, 6)];
    let drawn = numbered(&tee, &[&[0, 1, 2, 3, 4, 5, 6, 7]]);
    let mut parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
    check(&drawn, &parts);
    parts.iter_mut().for_each(|part| part.sort_unstable());
    parts.sort_unstable();
    assert_eq!(parts, [vec![0, 1, 4, 5, 6, 7], vec![1, 2, 3, 4]]);
}

#[test]
fn what_bounds_no_region_is_refused() {
    let refused = |points: &[(i32, i32)], loops: &[&[u32]]| {
        let drawn = numbered(points, loops);
        convex_parts(&drawn.loops, &drawn.points).unwrap_err()
    };
    let square = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 3), (6, 3), (6, 6), (3, 6)];
    assert_eq!(refused(&square, &[&[0, 1]]), RegionError::ShortChain(2));
    assert_eq!(refused(&square, &[&[0, 1, 9]]), RegionError::NoSuchVertex(9));
    let same = RegionError::SamePlace(Point::new(0, 0));
    assert_eq!(refused(&[(0, 0), (2, 0), (2, 2), (0, 0)], &[&[0, 1, 2, 3]]), same);
    assert!(matches!(refused(&square, &[&[0, 1, 2, 1]]), RegionError::EdgeTwice(..)));
    assert!(matches!(refused(&square, &[&[0, 1, 1, 2]]), RegionError::EdgeTwice(..)));
    // A clockwise chain; a hole that turns the wrong way; chains that cross; an edge through a vertex.
    assert!(matches!(refused(&square, &[&[3, 2, 1, 0]]), RegionError::Crossing(_)));
    assert!(matches!(refused(&square, &[&[0, 1, 2, 3], &[4, 5, 6, 7]]), RegionError::Crossing(_)));
    let crossed = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 3), (12, 3), (6, 6)];
    assert!(matches!(refused(&crossed, &[&[0, 1, 2, 3], &[6, 5, 4]]), RegionError::Crossing(_)));
    let through = [(0, 0), (9, 0), (9, 9), (0, 9), (3, 0), (6, 3), (3, 6)];
    assert!(matches!(refused(&through, &[&[0, 1, 2, 3], &[6, 5, 4]]), RegionError::Crossing(_)));
}

#[test]
fn only_convex_polygons_pass_for_convex() {
    let is =
        |points: &[(i32, i32)]| is_convex(&points.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>());
    assert!(is(&[(0, 0), (2, 0), (4, 0), (4, 4)]));
    assert!(!is(&[(0, 0), (4, 4), (4, 0)]));
    assert!(!is(&[(0, 0), (4, 0)]));
    assert!(!is(&[(0, 0), (4, 0), (2, 0)]));
    assert!(!is(&[(0, 0), (4, 0), (2, 0), (2, 3)]));
    // A star that winds twice turns left at every corner.
    assert!(!is(&[(0, 3), (-2, -3), (3, 1), (-3, 1), (2, -3)]));
    assert!(is(&[(0, 3), (-3, 1), (-2, -3), (2, -3), (3, 1)]));
}

#[test]
fn a_large_region_with_many_holes_takes_little_time() {
    let (width, spacing) = (150, 1000);
    let mut random = Random(88_172_645_463_325_252);
    let mut filled = vec![true; width * width];
    for _ in 0..2000 {
        let (x, y) = (1 + random.below(width - 4), 1 + random.below(width - 3));
        for k in 0..1 + random.below(3) {
            filled[y * width + x + k] = false;
        }
    }
    let filled = connected(&filled, width);
    let moves: Vec<i32> = (0..2 * (width + 1) * (width + 1)).map(|_| random.below(3) as i32 - 1).collect();
    let drawn = draw(&filled, width, false, true, |x, y| {
        let at = 2 * (y * (width + 1) + x);
        Point::new(spacing * x as i32 + moves[at], spacing * y as i32 + moves[at + 1])
    });
    let vertices: usize = drawn.loops.iter().map(Vec::len).sum();
    assert!(vertices > 4000 && drawn.loops.len() > 500, "{vertices} {}", drawn.loops.len());
    let start = std::time::Instant::now();
    let parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
    println!(
        "{vertices} vertices, {} chains: {} parts, {:?}",
        drawn.loops.len(),
        parts.len(),
        start.elapsed()
    );
    // It takes a tenth of a second; what grows with the square of the size would take many.
    assert!(start.elapsed().as_secs() < 3);
    check(&drawn, &parts);
    // Every reflex corner alone would make nearly as many parts as there are vertices.
    assert!(2 * parts.len() < vertices, "{} parts of {vertices} vertices", parts.len());
}

/// How a region is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Style {
    Straight,
    Kinked,
    Turned,
    Wild,
}

pub(super) const STYLES: [Style; 4] = [Style::Straight, Style::Kinked, Style::Turned, Style::Wild];

/// A region of random squares, about `share` in 256 of them filled.
pub(super) fn random_region(seed: u64, width: usize, share: u64, style: Style, spacing: i32) -> Drawn {
    let mut random = Random(seed | 1);
    for _ in 0..4 {
        random.next();
    }
    let filled: Vec<bool> = (0..width * width).map(|_| random.next() >> 40 & 255 < share).collect();
    let filled = connected(&filled, width);
    let reach = match style {
        Style::Straight | Style::Turned => 0,
        Style::Kinked => 1,
        Style::Wild => spacing / 4,
    };
    let mut moved = || random.below(2 * reach as usize + 1) as i32 - reach;
    let corners: Vec<Point> = (0..(width + 1) * (width + 1))
        .map(|v| {
            let (x, y) = ((v % (width + 1)) as i32, (v / (width + 1)) as i32);
            Point::new(spacing * x + moved(), spacing * y + moved())
        })
        .collect();
    let turn = |p: Point| {
        let (sin, cos) = 23.7f64.to_radians().sin_cos();
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        Point::new((x * cos - y * sin).round() as i32, (x * sin + y * cos).round() as i32)
    };
    let keep_straight = random.below(2) == 0;
    let touch = random.below(2) == 0;
    draw(&filled, width, keep_straight, touch, |x, y| {
        let p = corners[y * (width + 1) + x];
        if style == Style::Turned { turn(p) } else { p }
    })
}

/// The fewest parts, by trying every diagonal.
fn fewest(corners: &[Point], places: &[usize]) -> usize {
    let polygon: Vec<Point> = places.iter().map(|&k| corners[k]).collect();
    if is_convex(&polygon) {
        return 1;
    }
    let n = places.len();
    let mut least = usize::MAX;
    for i in 0..n {
        for j in i + 2..n {
            if (i, j) != (0, n - 1) && sees_by_halves(&polygon, i, j) {
                let near = fewest(corners, &places[i..=j]);
                let far: Vec<usize> = places[..=i].iter().chain(&places[j..]).copied().collect();
                least = least.min(near.saturating_add(fewest(corners, &far)));
            }
        }
    }
    least
}

/// Whether the open segment between two corners lies inside, by its crossings and its middle.
fn sees_by_halves(polygon: &[Point], i: usize, j: usize) -> bool {
    let double: Vec<Point> = polygon.iter().map(|p| Point::new(2 * p.x, 2 * p.y)).collect();
    let (a, b) = (double[i], double[j]);
    let n = double.len();
    let clear = (0..n).all(|k| {
        let (p, q) = (double[k], double[(k + 1) % n]);
        let crosses = orient(a, b, p).signum() * orient(a, b, q).signum() < 0
            && orient(p, q, a).signum() * orient(p, q, b).signum() < 0;
        let touches = orient(a, b, p) == 0 && crate::lattice::is_between(a, b, p);
        !crosses && !touches
    });
    clear && a != b && winding(&double, Point::new((a.x + b.x) / 2, (a.y + b.y) / 2)) == Some(1)
}

/// How often a chain winds about a point; `None` on the chain.
fn winding(chain: &[Point], p: Point) -> Option<i32> {
    let mut count = 0;
    for k in 0..chain.len() {
        let (a, b) = (chain[k], chain[(k + 1) % chain.len()]);
        let side = orient(a, b, p);
        if side == 0 && (p == a || p == b || crate::lattice::is_between(a, b, p)) {
            return None;
        }
        if a.y <= p.y && p.y < b.y && side > 0 {
            count += 1;
        }
        if b.y <= p.y && p.y < a.y && side < 0 {
            count -= 1;
        }
    }
    Some(count)
}

proptest! {
    #[test]
    fn parts_are_convex_and_fill_the_region(
        seed in any::<u64>(), width in 2usize..12, share in 90u64..250, style in prop::sample::select(&STYLES[..]),
    ) {
        let drawn = random_region(seed, width, share, style, 100);
        let parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
        check(&drawn, &parts);
        prop_assert_eq!(&parts, &convex_parts(&drawn.loops, &drawn.points).unwrap());
        // The way of large regions holds for all, and the best cut is never worse.
        let region = Region::new(&drawn.loops, &drawn.points).unwrap();
        let mut pieces = Parts::triangles(&region).unwrap();
        pieces.dissolve();
        pieces.improve();
        let pieces = pieces.take(&region.ids);
        check(&drawn, &pieces);
        prop_assert!(parts.len() <= pieces.len());
    }

    #[test]
    fn every_point_lies_in_as_many_parts_as_in_the_region(
        seed in any::<u64>(), width in 2usize..6, share in 90u64..250, style in 0usize..3,
    ) {
        let style = [Style::Straight, Style::Kinked, Style::Wild][style];
        let drawn = random_region(seed, width, share, style, 4);
        let parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
        // In half units.
        let double = |chain: &Vec<u32>| -> Vec<Point> {
            let twice = |v: &u32| Point::new(2 * drawn.points[*v as usize].x, 2 * drawn.points[*v as usize].y);
            chain.iter().map(twice).collect()
        };
        let (loops, parts): (Vec<_>, Vec<_>) =
            (drawn.loops.iter().map(double).collect(), parts.iter().map(double).collect());
        let reach = 8 * width as i32 + 4;
        for p in (-4..reach).flat_map(|y| (-4..reach).map(move |x| Point::new(x, y))) {
            let sum = |chains: &[Vec<Point>]| -> Option<i32> { chains.iter().map(|c| winding(c, p)).sum() };
            if let Some(inside) = sum(&parts) {
                prop_assert_eq!(Some(inside), sum(&loops));
            }
        }
    }

    #[test]
    fn small_polygons_are_cut_into_the_fewest_parts(
        seed in any::<u64>(), share in 90u64..250, style in prop::sample::select(&STYLES[..]),
    ) {
        let drawn = random_region(seed, 3, share, style, 100);
        let region = Region::new(&drawn.loops, &drawn.points).unwrap();
        // Half of them, and those with more corners take too long to try.
        if region.chains.len() != 1 || region.chains[0].len() > 10 {
            return Ok(());
        }
        let corners: Vec<Point> = region.chains[0].iter().map(|&v| region.points[v as usize]).collect();
        let places: Vec<usize> = (0..corners.len()).collect();
        let parts = convex_parts(&drawn.loops, &drawn.points).unwrap();
        prop_assert_eq!(parts.len(), fewest(&corners, &places));
    }
}

#[test]
fn random_regions_have_holes_touching_chains_straight_runs_and_kinks() {
    let (mut holes, mut touching, mut straight, mut reflex_by_one, mut large) = (0, 0, 0, 0, 0);
    let total = 2000;
    for seed in 0..total {
        let mut random = Random(seed * 7919 + 1);
        for _ in 0..4 {
            random.next();
        }
        let style = STYLES[random.below(4)];
        let (width, share) = (2 + random.below(10), 90 + random.below(160) as u64);
        let drawn = random_region(random.next(), width, share, style, 100);
        let Ok(region) = Region::new(&drawn.loops, &drawn.points) else { continue };
        let visits: usize = drawn.loops.iter().map(Vec::len).sum();
        let turns: Vec<i64> = region
            .chains
            .iter()
            .flat_map(|c| (0..c.len()).map(|k| [c[k], c[(k + 1) % c.len()], c[(k + 2) % c.len()]]))
            .map(|corner| {
                let [a, b, c] = corner.map(|v| region.points[v as usize]);
                orient(a, b, c)
            })
            .collect();
        holes += u32::from(region.chains.len() > 1);
        touching += u32::from(region.points.len() < visits);
        straight += u32::from(turns.contains(&0));
        reflex_by_one += u32::from(turns.iter().any(|&t| (-400..0).contains(&t)));
        large += u32::from(visits > 48);
    }
    let counts = [holes, touching, straight, reflex_by_one, large];
    println!("of {total}: holes, touching, straight, kinked, large {counts:?}");
    assert!(counts.iter().all(|&c| 20 * u64::from(c) >= total), "{counts:?}");
}
