//! Which of many convex footprints overlap a given one: exactly, in integers.

use crate::lattice::{Point, orient};

/// Convex polygons in a grid of buckets.
pub(super) struct Overlaps<'a> {
    polygons: &'a [Vec<Point>],
    boxes: Vec<[Point; 2]>,
    lo: [i64; 2],
    size: [i64; 2],
    counts: [usize; 2],
    buckets: Vec<Vec<u32>>,
}

impl<'a> Overlaps<'a> {
    /// Of counter-clockwise convex polygons.
    pub(super) fn new(polygons: &'a [Vec<Point>]) -> Overlaps<'a> {
        let boxes: Vec<[Point; 2]> = polygons.iter().map(|p| bounds(p)).collect();
        let all = boxes.iter().flatten().copied().collect::<Vec<Point>>();
        let [lo, hi] = bounds(&all);
        let across = ((polygons.len() as f64).sqrt() as usize).clamp(1, 256);
        let size =
            [(lo.x, hi.x), (lo.y, hi.y)].map(|(l, h)| (i64::from(h) - i64::from(l)) / across as i64 + 1);
        let mut overlaps = Overlaps {
            polygons,
            boxes,
            lo: [i64::from(lo.x), i64::from(lo.y)],
            size,
            counts: [across; 2],
            buckets: vec![Vec::new(); across * across],
        };
        for i in 0..polygons.len() {
            let [from, to] = overlaps.range(overlaps.boxes[i]);
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    overlaps.buckets[y * across + x].push(i as u32);
                }
            }
        }
        overlaps
    }

    fn range(&self, ends: [Point; 2]) -> [[usize; 2]; 2] {
        let bucket = |c: i32, i: usize| {
            let bucket = (i64::from(c) - self.lo[i]) / self.size[i];
            bucket.clamp(0, self.counts[i] as i64 - 1) as usize
        };
        ends.map(|p| [bucket(p.x, 0), bucket(p.y, 1)])
    }

    /// Calls `with` with the index of every polygon that has area in common with a counter-clockwise convex `polygon`.
    pub(super) fn each(&self, polygon: &[Point], mut with: impl FnMut(usize)) {
        let own = bounds(polygon);
        let [from, to] = self.range(own);
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                for &i in &self.buckets[y * self.counts[0] + x] {
                    let other = self.boxes[i as usize];
                    let meet = own[0].x < other[1].x
                        && other[0].x < own[1].x
                        && own[0].y < other[1].y
                        && other[0].y < own[1].y;
                    // In the first bucket only that both reach.
                    let [first, _] =
                        self.range([Point::new(own[0].x.max(other[0].x), own[0].y.max(other[0].y)), own[1]]);
                    if meet && first == [x, y] && overlap(polygon, &self.polygons[i as usize]) {
                        with(i as usize);
                    }
                }
            }
        }
    }
}

fn bounds(polygon: &[Point]) -> [Point; 2] {
    let first = polygon.first().copied().unwrap_or_default();
    polygon.iter().fold([first; 2], |[lo, hi], p| {
        [Point::new(lo.x.min(p.x), lo.y.min(p.y)), Point::new(hi.x.max(p.x), hi.y.max(p.y))]
    })
}

/// Whether two counter-clockwise convex polygons have area in common: if they have none, an edge of one of them
/// separates them.
fn overlap(a: &[Point], b: &[Point]) -> bool {
    let separates = |by: &[Point], other: &[Point]| {
        (0..by.len()).any(|i| {
            let (from, to) = (by[i], by[(i + 1) % by.len()]);
            from != to && other.iter().all(|&p| orient(from, to, p) <= 0)
        })
    };
    !separates(a, b) && !separates(b, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn triangle(c: [i32; 6]) -> Vec<Point> {
        let mut t = vec![Point::new(c[0], c[1]), Point::new(c[2], c[3]), Point::new(c[4], c[5])];
        if orient(t[0], t[1], t[2]) < 0 {
            t.swap(1, 2);
        }
        t
    }

    /// Area in common, by clipping in rational steps of f64: small integers, so that zero is told safely.
    fn common_area(a: &[Point], b: &[Point]) -> f64 {
        let mut kept: Vec<[f64; 2]> = a.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
        for i in 0..b.len() {
            let (o, e) = (b[i], b[(i + 1) % b.len()]);
            let (ox, oy) = (f64::from(o.x), f64::from(o.y));
            let (dx, dy) = (f64::from(e.x) - ox, f64::from(e.y) - oy);
            let side = |p: [f64; 2]| dx * (p[1] - oy) - dy * (p[0] - ox);
            let mut next = Vec::new();
            for j in 0..kept.len() {
                let (p, q) = (kept[j], kept[(j + 1) % kept.len()]);
                let (s, t) = (side(p), side(q));
                if s >= 0.0 {
                    next.push(p);
                }
                if (s >= 0.0) != (t >= 0.0) {
                    let w = s / (s - t);
                    next.push([p[0] + (q[0] - p[0]) * w, p[1] + (q[1] - p[1]) * w]);
                }
            }
            kept = next;
        }
        let n = kept.len();
        (0..n).map(|i| kept[i][0] * kept[(i + 1) % n][1] - kept[(i + 1) % n][0] * kept[i][1]).sum::<f64>()
            / 2.0
    }

    proptest! {
        #[test]
        fn found_as_by_clipping(triangles in prop::collection::vec(prop::array::uniform6(-6i32..7), 1..8), one in prop::array::uniform6(-6i32..7)) {
            let all: Vec<Vec<Point>> =
                triangles.into_iter().map(triangle).filter(|t| orient(t[0], t[1], t[2]) > 0).collect();
            let one = triangle(one);
            prop_assume!(!all.is_empty() && orient(one[0], one[1], one[2]) > 0);
            let mut found = Vec::new();
            Overlaps::new(&all).each(&one, |i| found.push(i));
            found.sort_unstable();
            let expected: Vec<usize> = (0..all.len()).filter(|&i| common_area(&all[i], &one) > 1e-9).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
