//! Lines in the plan over which two faces pass through each other, at least one of them sloped.

use super::account::{Account, Full, Meter};
use super::slabs::Slab;
use crate::lattice::{Plane, Point};

/// Buckets along each axis of the plan.
const BUCKETS: usize = 64;

/// The segments over which pieces of the slab's faces cross, rounded.
///
/// # Errors
/// If they take more memory than `account` has.
pub(super) fn crossings(
    slab: &Slab,
    hull: [[i32; 3]; 2],
    account: &Account,
) -> Result<Vec<[Point; 2]>, Full> {
    let is_sloped = |piece: &(u32, Vec<Point>)| !slab.faces[piece.0 as usize].plane.is_level();
    let mut buckets: Vec<Vec<u32>> = vec![Vec::new(); BUCKETS * BUCKETS];
    let grid = Buckets::over(hull);
    let boxes: Vec<[Point; 2]> = slab.pieces.iter().map(|(_, polygon)| bounds(polygon)).collect();
    for (i, piece) in slab.pieces.iter().enumerate().filter(|(_, piece)| is_sloped(piece)) {
        debug_assert!(!piece.1.is_empty());
        grid.each(boxes[i], |bucket| buckets[bucket].push(i as u32));
    }
    let mut found = Vec::new();
    let mut meter = Meter::new(account, size_of::<[Point; 2]>());
    for (i, piece) in slab.pieces.iter().enumerate() {
        let plane = slab.faces[piece.0 as usize].plane;
        grid.each(boxes[i], |bucket| {
            for &j in &buckets[bucket] {
                let (other, j) = (&slab.pieces[j as usize], j as usize);
                // Of two sloped pieces, once; and in one bucket only.
                if j == i
                    || (is_sloped(piece) && j < i)
                    || grid.first_common(boxes[i], boxes[j]) != Some(bucket)
                {
                    continue;
                }
                let other_plane = slab.faces[other.0 as usize].plane;
                found.extend(cross(&piece.1, plane, &other.1, other_plane));
            }
        });
        meter.reach(found.len())?;
    }
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

fn bounds(polygon: &[Point]) -> [Point; 2] {
    let first = polygon.first().copied().unwrap_or_default();
    polygon.iter().fold([first; 2], |[lo, hi], p| {
        [Point::new(lo.x.min(p.x), lo.y.min(p.y)), Point::new(hi.x.max(p.x), hi.y.max(p.y))]
    })
}

struct Buckets {
    lo: [i64; 2],
    size: [i64; 2],
}

impl Buckets {
    fn over(hull: [[i32; 3]; 2]) -> Buckets {
        let size = [0, 1].map(|i| (i64::from(hull[1][i]) - i64::from(hull[0][i])) / BUCKETS as i64 + 1);
        Buckets { lo: [0, 1].map(|i| i64::from(hull[0][i])), size }
    }

    fn of(&self, p: Point) -> [usize; 2] {
        let at = |c: i32, i: usize| {
            ((i64::from(c) - self.lo[i]) / self.size[i]).clamp(0, BUCKETS as i64 - 1) as usize
        };
        [at(p.x, 0), at(p.y, 1)]
    }

    fn each(&self, [lo, hi]: [Point; 2], mut with: impl FnMut(usize)) {
        let (from, to) = (self.of(lo), self.of(hi));
        for y in from[1]..=to[1] {
            for x in from[0]..=to[0] {
                with(y * BUCKETS + x);
            }
        }
    }

    /// The first bucket that two boxes have in common.
    fn first_common(&self, a: [Point; 2], b: [Point; 2]) -> Option<usize> {
        let meet = a[0].x <= b[1].x && b[0].x <= a[1].x && a[0].y <= b[1].y && b[0].y <= a[1].y;
        let (a, b) = (self.of(a[0]), self.of(b[0]));
        meet.then(|| a[1].max(b[1]) * BUCKETS + a[0].max(b[0]))
    }
}

/// Where two pieces of plane pass through each other over both polygons, convex but for roundings.
fn cross(a: &[Point], plane_a: Plane, b: &[Point], plane_b: Plane) -> Option<[Point; 2]> {
    if plane_a == plane_b {
        return None;
    }
    let off = |x: f64, y: f64| plane_a.height_f64(x, y) - plane_b.height_f64(x, y);
    let one_sided = |polygon: &[Point]| {
        let mut signs = polygon.iter().map(|p| off(f64::from(p.x), f64::from(p.y)));
        let first = signs.next().unwrap_or(0.0);
        first != 0.0 && signs.all(|s| s * first > 0.0)
    };
    if one_sided(a) || one_sided(b) {
        return None;
    }
    let common = intersection(a, b);
    let mut ends: Vec<[f64; 2]> = Vec::new();
    for i in 0..common.len() {
        let (p, q) = (common[i], common[(i + 1) % common.len()]);
        let (from, to) = (off(p[0], p[1]), off(q[0], q[1]));
        if (from < 0.0) != (to < 0.0) {
            let s = from / (from - to);
            ends.push([p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s]);
        }
    }
    let [p, q] = ends[..] else { return None };
    let round = |p: [f64; 2]| Point::new(p[0].round() as i32, p[1].round() as i32);
    let (p, q) = (round(p), round(q));
    (p != q).then(|| if p < q { [p, q] } else { [q, p] })
}

/// What two convex polygons have in common, by Sutherland and Hodgman (Reentrant polygon clipping, 1974).
fn intersection(a: &[Point], b: &[Point]) -> Vec<[f64; 2]> {
    let points = |polygon: &[Point]| -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = polygon.iter().map(|p| [f64::from(p.x), f64::from(p.y)]).collect();
        if crate::lattice::double_area(polygon) < 0 {
            points.reverse();
        }
        points
    };
    let (mut kept, by) = (points(a), points(b));
    for i in 0..by.len() {
        let (o, e) = (by[i], by[(i + 1) % by.len()]);
        let side = |p: [f64; 2]| (e[0] - o[0]) * (p[1] - o[1]) - (e[1] - o[1]) * (p[0] - o[0]);
        let mut next = Vec::with_capacity(kept.len() + 1);
        for j in 0..kept.len() {
            let (p, q) = (kept[j], kept[(j + 1) % kept.len()]);
            let (from, to) = (side(p), side(q));
            if from >= 0.0 {
                next.push(p);
            }
            if (from >= 0.0) != (to >= 0.0) {
                let s = from / (from - to);
                next.push([p[0] + (q[0] - p[0]) * s, p[1] + (q[1] - p[1]) * s]);
            }
        }
        kept = next;
    }
    kept
}
