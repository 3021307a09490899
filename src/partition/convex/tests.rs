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
struct Drawn {
    loops: Vec<Vec<u32>>,
    points: Vec<Point>,
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

fn area(drawn: &Drawn, polygon: &[u32]) -> i128 {
    let corners: Vec<Point> = polygon.iter().map(|&v| drawn.points[v as usize]).collect();
    i128::from(double_area(&corners))
}

/// Everything that must hold of a cut, checked without its own code.
fn check(drawn: &Drawn, parts: &[Vec<u32>]) {
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

fn families(r: &mut Random, family: usize) -> Drawn {
    let turn = 23.7f64.to_radians();
    let turned = move |x: f64, y: f64| {
        Point::new(
            (x * turn.cos() - y * turn.sin()).round() as i32,
            (x * turn.sin() + y * turn.cos()).round() as i32,
        )
    };
    let straight = move |x: f64, y: f64| Point::new(x as i32, y as i32);
    let place: &dyn Fn(f64, f64) -> Point = if family % 2 == 0 { &straight } else { &turned };
    let (w, h) = match family / 2 {
        0 => (8, 8),
        1 => (21, 5),
        2 => (16, 12),
        _ => (60, 60),
    };
    let mut filled = vec![false; w * h];
    let mut rect = |x0: usize, y0: usize, x1: usize, y1: usize, v: bool| {
        for y in y0..y1.min(h) {
            for x in x0..x1.min(w) {
                filled[y * w + x] = v;
            }
        }
    };
    match family / 2 {
        // L, T, U-shaped rooms
        0 => {
            for _ in 0..3 {
                let (x, y) = (r.below(5), r.below(5));
                rect(x, y, x + 2 + r.below(4), y + 2 + r.below(4), true);
            }
        }
        // comb
        1 => {
            rect(0, 0, w, 1, true);
            for x in (0..w).step_by(2) {
                rect(x, 1, x + 1, 1 + r.below(4), true);
            }
        }
        // room with niches and columns
        2 => {
            rect(1, 1, w - 1, h - 1, true);
            for _ in 0..4 {
                let (x, y) = (2 + r.below(w - 4), 2 + r.below(h - 4));
                rect(x, y, x + 1, y + 1, false);
            }
            for _ in 0..6 {
                let k = r.below(w);
                rect(k, 0, k + 1, 1, true);
                let k = r.below(h);
                rect(w - 2, k, w, k + 1, r.below(2) == 0);
            }
        }
        // exterior about a lot
        _ => {
            rect(0, 0, w, h, true);
            for _ in 0..300 {
                let (x, y) = (1 + r.below(w - 4), 1 + r.below(h - 4));
                rect(x, y, x + 1 + r.below(3), y + 1 + r.below(2), false);
            }
        }
    }
    let xs: Vec<f64> = (0..=w)
        .scan(0.0, |s, _| {
            *s += (2000 + r.below(60000)) as f64;
            Some(*s)
        })
        .collect();
    let ys: Vec<f64> = (0..=h)
        .scan(0.0, |s, _| {
            *s += (2000 + r.below(60000)) as f64;
            Some(*s)
        })
        .collect();
    let filled = connected(&filled, w);
    draw(&filled, w, false, true, |x, y| place(xs[x], ys[y]))
}

#[test]
fn measure() {
    for family in 0..8 {
        let mut r = Random(88172645463325252 + family as u64 / 2);
        let count = if family < 6 { 400 } else { 3 };
        let (mut vs, mut parts, mut tri, mut hm, mut lnst, mut low) = (0, 0, 0, 0, 0, 0);
        let mut time = std::time::Duration::ZERO;
        let mut worst = std::time::Duration::ZERO;
        for _ in 0..count {
            let d = families(&mut r, family);
            vs += d.loops.iter().map(Vec::len).sum::<usize>();
            let t = std::time::Instant::now();
            let p = convex_parts(&d.loops, &d.points).unwrap();
            time += t.elapsed();
            worst = worst.max(t.elapsed());
            check(&d, &p);
            parts += p.len();
            let region = Region::new(&d.loops, &d.points).unwrap();
            let mut m = Parts::triangles(&region).unwrap();
            let c = |m: &Parts| m.first.iter().filter(|f| **f != parts::NOWHERE).count();
            tri += c(&m);
            m.dissolve();
            hm += c(&m);
            m.improve();
            lnst += c(&m);
            let reflex: usize = d
                .loops
                .iter()
                .map(|l| {
                    (0..l.len())
                        .filter(|&k| {
                            best::is_reflex(
                                d.points[l[k] as usize],
                                d.points[l[(k + 1) % l.len()] as usize],
                                d.points[l[(k + 2) % l.len()] as usize],
                            )
                        })
                        .count()
                })
                .sum();
            low += (reflex.div_ceil(2) + 2).saturating_sub(d.loops.len()).max(1);
        }
        println!(
            "family {family}: {count} regions, {vs} vertices, triangles {tri}, HM {hm}, HM+patch {lnst}, ours {parts}, bound {low}; {:?} each, worst {worst:?}",
            time / count
        );
    }
}
