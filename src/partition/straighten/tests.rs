//! Known maps, and random ones checked by brute force.

use proptest::prelude::*;

use super::*;

fn points(list: &[(i32, i32)]) -> Vec<Point> {
    list.iter().map(|&(x, y)| Point::new(x, y)).collect()
}

/// One class, all kept.
fn plain(vertices: &[(i32, i32)], links: &[[u32; 2]], tolerance: f64) -> Straightened {
    let vertices = points(vertices);
    let result = straighten(&vertices, links, &vec![0; links.len()], &vec![true; links.len()], tolerance);
    check(&vertices, links, &vec![0; links.len()], &vec![true; links.len()], tolerance, &result);
    result
}

fn path(from: u32, to: u32) -> Vec<[u32; 2]> {
    (from..to).map(|k| [k, k + 1]).collect()
}

/// The number of links that meet at each vertex.
fn degrees(links: impl Iterator<Item = [u32; 2]>, vertices: usize) -> Vec<u32> {
    let mut degrees = vec![0; vertices];
    for v in links.flatten() {
        degrees[v as usize] += 1;
    }
    degrees
}

/// Everything that must hold, by brute force and without the module's own code.
fn check(
    vertices: &[Point],
    links: &[[u32; 2]],
    class: &[u32],
    keep: &[bool],
    tolerance: f64,
    new: &Straightened,
) {
    // Vertices are old ones, in order.
    let mut old_of = Vec::new();
    let mut at = 0;
    for p in &new.vertices {
        at += vertices[at..].iter().position(|q| q == p).unwrap();
        old_of.push(at as u32);
        at += 1;
    }
    let new_links: Vec<[Point; 2]> = new.links.iter().map(|l| l.map(|v| new.vertices[v as usize])).collect();

    // No vertex lies on a link, no two links cross or run alike.
    for (k, &[a, b]) in new_links.iter().enumerate() {
        assert!(a != b);
        for &p in &new.vertices {
            assert!(orient(a, b, p) != 0 || !is_between(a, b, p), "{p:?} on {a:?} {b:?}");
        }
        for &[c, d] in &new_links[..k] {
            assert!([a, b] != [c, d] && [a, b] != [d, c]);
            let apart = |a, b, c, d| orient(a, b, c).signum() * orient(a, b, d).signum() < 0;
            assert!(!(apart(a, b, c, d) && apart(c, d, a, b)), "{a:?} {b:?} crosses {c:?} {d:?}");
        }
    }

    // Each new link stands for old ones that string its ends together, in order and direction.
    let mut parts: Vec<Vec<[u32; 2]>> = vec![Vec::new(); new.links.len()];
    for (k, step) in new.of.iter().enumerate() {
        assert_eq!(step.is_some(), keep[k]);
        if let Some(step) = step {
            let [a, b] = links[k];
            parts[step.link as usize].push(if step.forward { [a, b] } else { [b, a] });
        }
    }
    let kept = || (0..links.len()).filter(|&k| keep[k]).map(|k| links[k]);
    let old_degrees = degrees(kept(), vertices.len());
    let tolerance = tolerance.max(0.0);
    let mut removed = 0;
    let mut largest = 0.0f64;
    let mut passed = vec![0; vertices.len()];
    let mut first_step = std::collections::BTreeMap::new();
    for (link, (part, ends)) in parts.iter().zip(&new.links).enumerate() {
        let [start, end] = ends.map(|v| old_of[v as usize]);
        let mut chain = vec![start];
        while chain[chain.len() - 1] != end {
            let onward: Vec<u32> =
                part.iter().filter(|s| s[0] == chain[chain.len() - 1]).map(|s| s[1]).collect();
            assert_eq!(onward.len(), 1);
            chain.push(onward[0]);
        }
        assert_eq!(chain.len(), part.len() + 1);
        first_step.insert((start, link), chain[1]);
        first_step.insert((end, link), chain[chain.len() - 2]);

        let [a, b] = new_links[link];
        for &v in &chain[1..chain.len() - 1] {
            removed += 1;
            passed[v as usize] += 1;
            assert_eq!(old_degrees[v as usize], 2);
            let distance = distance(a, b, vertices[v as usize]);
            assert!(distance <= tolerance + 1e-6, "{distance} {tolerance}");
            largest = largest.max(distance);
        }
        // The old chain shrinks onto the link without passing a vertex.
        let round: Vec<Point> = chain.iter().map(|&v| vertices[v as usize]).collect();
        if round.len() > 2 {
            for (k, &p) in new.vertices.iter().enumerate() {
                if !ends.contains(&(k as u32)) {
                    assert_eq!(winding(&round, p), Some(0), "{p:?} swallowed by {a:?} {b:?}");
                }
            }
        }
    }
    assert_eq!(new.removed, removed);
    assert!((new.largest_displacement - largest).abs() < 1e-6);

    // What stays: every vertex with links but those passed, once each.
    let expected: Vec<u32> = (0..vertices.len() as u32)
        .filter(|&v| old_degrees[v as usize] > 0 && passed[v as usize] == 0)
        .collect();
    assert_eq!(old_of, expected);
    let new_degrees = degrees(new.links.iter().copied(), new.vertices.len());
    for (v, &old) in old_of.iter().enumerate() {
        assert_eq!(new_degrees[v], old_degrees[old as usize]);
        let about: Vec<usize> =
            (0..new.links.len()).filter(|&k| new.links[k].contains(&(v as u32))).collect();
        let turn = |ends: Vec<Point>| {
            // Links about the vertex by angle, starting with the lowest number.
            let o = new.vertices[v];
            let angle = |k: &usize| {
                let p = ends[*k];
                (f64::from(p.y) - f64::from(o.y)).atan2(f64::from(p.x) - f64::from(o.x))
            };
            let mut order: Vec<usize> = (0..about.len()).collect();
            order.sort_by(|s, t| angle(s).total_cmp(&angle(t)));
            let first = order.iter().position(|&k| k == 0).unwrap_or(0);
            order.rotate_left(first);
            order
        };
        let before = about.iter().map(|&k| vertices[first_step[&(old, k)] as usize]).collect();
        let after = about
            .iter()
            .map(|&k| {
                let [a, b] = new.links[k];
                new.vertices[if a == v as u32 { b } else { a } as usize]
            })
            .collect();
        assert_eq!(turn(before), turn(after), "order about {:?}", new.vertices[v]);
        // No vertex stays in the middle of a straight line.
        if let [a, b] = about[..] {
            let kinds = |k: usize| {
                let old = new.of.iter().position(|s| s.is_some_and(|s| s.link as usize == k)).unwrap();
                class[old]
            };
            if kinds(a) == kinds(b) {
                let far = |k: usize| new_links[k][usize::from(new_links[k][0] == new.vertices[v])];
                let (p, q, o) = (far(a), far(b), new.vertices[v]);
                assert!(orient(p, o, q) != 0 || !is_between(p, q, o));
            }
        }
    }
}

fn distance(a: Point, b: Point, p: Point) -> f64 {
    let f = |c: i32| f64::from(c);
    let (dx, dy) = (f(b.x) - f(a.x), f(b.y) - f(a.y));
    let (px, py) = (f(p.x) - f(a.x), f(p.y) - f(a.y));
    let t = ((px * dx + py * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    (px - t * dx).hypot(py - t * dy)
}

/// How often a closed chain winds about a point; `None` on the chain.
fn winding(chain: &[Point], p: Point) -> Option<i32> {
    let mut count = 0;
    for k in 0..chain.len() {
        let (a, b) = (chain[k], chain[(k + 1) % chain.len()]);
        let side = orient(a, b, p);
        if side == 0 && (p == a || p == b || is_between(a, b, p)) {
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

#[test]
fn a_wall_with_kinks_where_dropped_links_met_it_becomes_straight() {
    // A line with kinks of one unit; from each second vertex a link that goes.
    let n = 40u32;
    let mut vertices: Vec<Point> =
        (0..=n as i32).map(|k| Point::new(1000 * k, if k == 0 || k == 40 { 0 } else { k % 3 - 1 })).collect();
    let mut links = path(0, n);
    for k in (2..n).step_by(2) {
        links.push([k, vertices.len() as u32]);
        vertices.push(Point::new(1000 * k as i32 + 300, 5000));
    }
    let keep: Vec<bool> = (0..links.len()).map(|k| k < n as usize).collect();
    let class = vec![0; links.len()];
    let new = straighten(&vertices, &links, &class, &keep, 3.3);
    check(&vertices, &links, &class, &keep, 3.3, &new);
    assert_eq!(new.vertices, points(&[(0, 0), (40_000, 0)]));
    assert_eq!(new.links, [[0, 1]]);
    assert_eq!((new.removed, new.largest_displacement), (39, 1.0));
    assert_eq!(new.of[7], Some(Step { link: 0, forward: true }));
    assert_eq!(new.of[40], None);

    // Where the links stay, so do their ends.
    let new = straighten(&vertices, &links, &class, &vec![true; links.len()], 3.3);
    check(&vertices, &links, &class, &vec![true; links.len()], 3.3, &new);
    assert_eq!(new.removed, 20);

    // Another class begins at vertex 10.
    let class: Vec<u32> = (0..links.len()).map(|k| u32::from(k >= 10)).collect();
    let new = straighten(&vertices, &links, &class, &keep, 3.3);
    check(&vertices, &links, &class, &keep, 3.3, &new);
    assert_eq!(new.vertices.len(), 3);
}

#[test]
fn a_chain_keeps_the_bend_that_goes_about_a_vertex() {
    let vertices = [(0, 0), (50, 3), (100, 0), (50, 1), (50, -20)];
    let bent = plain(&vertices, &[[0, 1], [1, 2], [3, 4]], 5.0);
    assert_eq!(bent.removed, 0);
    // Below the line nothing is in the way.
    let vertices = [(0, 0), (50, 3), (100, 0), (50, -1), (50, -20)];
    let straight = plain(&vertices, &[[0, 1], [1, 2], [3, 4]], 5.0);
    assert_eq!(straight.removed, 1);
    // A vertex on the new line is in the way too.
    let vertices = [(0, 0), (50, 3), (100, 0), (50, 0), (50, -20)];
    assert_eq!(plain(&vertices, &[[0, 1], [1, 2], [3, 4]], 5.0).removed, 0);
}

#[test]
fn close_chains_do_not_cross() {
    // Two chains that rise beside each other, the lower by 3, the upper by 4.
    let vertices = [(0, 1), (100, 5), (200, 1), (0, 0), (100, 3), (200, 0)];
    let links = [[0, 1], [1, 2], [3, 4], [4, 5]];
    for (tolerance, removed) in [(2.9, 0), (3.0, 1), (3.9, 1), (4.0, 2), (1e6, 2)] {
        assert_eq!(plain(&vertices, &links, tolerance).removed, removed);
    }
    // Where the lower one must keep its bend, the upper one keeps its own.
    let (vertices, class, keep) = (points(&vertices), [0, 0, 0, 1], [true; 4]);
    let new = straighten(&vertices, &links, &class, &keep, 4.0);
    check(&vertices, &links, &class, &keep, 4.0, &new);
    assert_eq!(new.removed, 0);
    // Both between the same two ends: one stays bent.
    let vertices = [(0, 0), (100, 1), (200, 0), (100, -1)];
    let new = plain(&vertices, &[[0, 1], [1, 2], [2, 3], [3, 0]], 5.0);
    assert_eq!((new.links.len(), new.removed), (3, 1));
}

#[test]
fn closed_chains_keep_three_vertices_at_least() {
    // A square with a vertex in the middle of each side; links run either way.
    let vertices = [(0, 0), (50, 1), (100, 0), (99, 50), (100, 100), (50, 99), (0, 100), (0, 50)];
    let links = [[0, 1], [2, 1], [2, 3], [3, 4], [5, 4], [5, 6], [6, 7], [7, 0]];
    let new = plain(&vertices, &links, 2.0);
    assert_eq!(new.vertices, points(&[(0, 0), (100, 0), (100, 100), (0, 100)]));
    assert_eq!(plain(&vertices, &links, 1e9).links.len(), 3);
    assert_eq!(plain(&vertices, &links, f64::INFINITY).links.len(), 3);
    // Exactly straight vertices go without a tolerance.
    for tolerance in [0.0, -1.0, f64::NAN] {
        assert_eq!(plain(&vertices, &links, tolerance).removed, 1);
    }
    // A loop at a junction.
    let vertices = [(0, 0), (-50, 0), (30, 1), (60, 0), (30, -1)];
    let new = plain(&vertices, &[[0, 1], [0, 2], [2, 3], [3, 4], [4, 0]], 5.0);
    assert_eq!((new.links.len(), new.removed), (4, 1));
}

#[test]
fn nothing_comes_of_nothing() {
    let new = straighten(&[], &[], &[], &[], 1.0);
    assert_eq!((new.vertices.len(), new.links.len(), new.removed), (0, 0, 0));
    let new = straighten(&points(&[(0, 0), (1, 0)]), &[[0, 1]], &[0], &[false], 1.0);
    assert_eq!((new.vertices.len(), new.of), (0, vec![None]));
}

/// A small deterministic generator.
struct Random(u64);

impl Random {
    fn below(&mut self, n: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 33) as u32 % n
    }
}

/// A planar map: the boundaries between differently coloured squares of a grid, and some links inside one colour, most
/// of which go; its vertices are moved.
struct Map {
    vertices: Vec<Point>,
    links: Vec<[u32; 2]>,
    class: Vec<u32>,
    keep: Vec<bool>,
}

fn random_map(seed: u64, width: u32, colours: u32, inner: u32, spacing: i32, reach: i32) -> Map {
    let mut random = Random(seed | 1);
    for _ in 0..8 {
        random.below(2);
    }
    let columns = width + 1;
    let mut map = Map { vertices: Vec::new(), links: Vec::new(), class: Vec::new(), keep: Vec::new() };
    for v in 0..columns * columns {
        let mut moved = || random.below(2 * reach as u32 + 1) as i32 - reach;
        let (x, y) = ((v % columns) as i32, (v / columns) as i32);
        map.vertices.push(Point::new(spacing * x + moved(), spacing * y + moved()));
    }
    // The first colour is the commonest, and lies all about.
    let colour: Vec<u32> =
        (0..width * width).map(|_| random.below(2 * colours).saturating_sub(colours)).collect();
    let of = |x: i64, y: i64| {
        let inside = |c: i64| (0..i64::from(width)).contains(&c);
        if inside(x) && inside(y) { colour[(y * i64::from(width) + x) as usize] } else { 0 }
    };
    for v in 0..columns * columns {
        let (x, y) = (i64::from(v % columns), i64::from(v / columns));
        for (right, sides) in [(true, [of(x, y), of(x, y - 1)]), (false, [of(x, y), of(x - 1, y)])] {
            let is_in = if right { v % columns < width } else { v / columns < width };
            let [low, high] = [sides[0].min(sides[1]), sides[0].max(sides[1])];
            if is_in && (low != high || random.below(256) < inner) {
                let other = if right { v + 1 } else { v + columns };
                map.links.push(if random.below(2) == 0 { [v, other] } else { [other, v] });
                // Here and there a class of its own.
                map.class.push(low * colours + high + 100 * u32::from(random.below(16) == 0));
                map.keep.push(low != high || random.below(4) == 0);
            }
        }
    }
    map
}

proptest! {
    #[test]
    fn random_maps_stay_planar_and_the_same(
        seed in any::<u64>(), width in 1u32..9, colours in 2u32..5, inner in 0u32..128, reach in 0i32..24,
        tolerance in prop_oneof![Just(0.0), 0.0..5.0f64, 5.0..80.0f64, 80.0..2000.0f64],
    ) {
        let map = random_map(seed, width, colours, inner, 100, reach);
        let new = straighten(&map.vertices, &map.links, &map.class, &map.keep, tolerance);
        check(&map.vertices, &map.links, &map.class, &map.keep, tolerance, &new);
        prop_assert_eq!(&new, &straighten(&map.vertices, &map.links, &map.class, &map.keep, tolerance));
        // Doing it again changes less and less, and never the map.
        let (class, keep) = (vec![0; new.links.len()], vec![true; new.links.len()]);
        let again = straighten(&new.vertices, &new.links, &class, &keep, tolerance);
        check(&new.vertices, &new.links, &class, &keep, tolerance, &again);
    }
}

#[test]
fn many_links_take_little_time() {
    // Long parallel lines, five units apart, with kinks of a unit, and cross links that go.
    let (lines, length) = (100, 1000);
    let mut random = Random(7);
    let mut map = Map { vertices: Vec::new(), links: Vec::new(), class: Vec::new(), keep: Vec::new() };
    for line in 0..lines {
        for k in 0..length {
            let v = map.vertices.len() as u32;
            map.vertices.push(Point::new(2000 * k, 5 * line + random.below(3) as i32 - 1));
            if k > 0 {
                map.links.push([v - 1, v]);
                map.keep.push(true);
            }
            if line > 0 && k % 7 == 0 {
                map.links.push([v - length as u32, v]);
                map.keep.push(k % 70 == 0);
            }
        }
    }
    map.class = vec![0; map.links.len()];
    let start = std::time::Instant::now();
    let new = straighten(&map.vertices, &map.links, &map.class, &map.keep, 3.3);
    println!("{} links: {} in {:?}", map.links.len(), new.links.len(), start.elapsed());
    assert!(start.elapsed().as_secs() < 3);
    assert!(10 * new.links.len() < map.links.len());

    // A net of short links with short chains.
    let map = random_map(5, 290, 3, 16, 100, 20);
    let start = std::time::Instant::now();
    let new = straighten(&map.vertices, &map.links, &map.class, &map.keep, 30.0);
    println!("{} links: {} in {:?}", map.links.len(), new.links.len(), start.elapsed());
    assert!(start.elapsed().as_secs() < 3);
    assert!(new.removed > 1000);
}

#[test]
fn random_maps_put_every_rule_to_the_test() {
    // How often does the distance alone decide otherwise than the whole; how often are there closed chains, dropped
    // links, several classes at a vertex of two links.
    let (mut mended, mut closed, mut dropped, mut classes) = (0, 0, 0, 0);
    let total = 1000;
    for seed in 0..total {
        let mut random = Random(seed * 7919 + 1);
        let (width, colours) = (1 + random.below(8), 2 + random.below(3));
        let map =
            random_map(seed * 104_729 + 5, width, colours, random.below(128), 100, random.below(24) as i32);
        let chains = Chains::trace(&map.vertices, &map.links, &map.class, &map.keep);
        let tolerance = f64::from(random.below(200));
        let mut strokes = Strokes::new(&map.vertices, &chains, tolerance);
        strokes.lay_all();
        let before = strokes.ends();
        strokes.mend();
        mended += u32::from(before != strokes.ends());
        closed += u32::from(chains.iter().any(|chain| chain.is_closed()));
        dropped += u32::from(map.keep.contains(&false));
        let kept: Vec<usize> = (0..map.links.len()).filter(|&k| map.keep[k]).collect();
        let degrees = degrees(kept.iter().map(|&k| map.links[k]), map.vertices.len());
        classes += u32::from(
            chains.iter().any(|chain| degrees[chain.vertices[0] as usize] == 2 && !chain.is_closed()),
        );
    }
    let counts = [mended, closed, dropped, classes];
    println!("of {total}: mended, closed, dropped, classes {counts:?}");
    assert!(counts.iter().all(|&c| 20 * u64::from(c) >= total), "{counts:?}");
}
