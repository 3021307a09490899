//! Where ceiling lamps hang.

use crate::generate::lattice::{Point, units};

use super::region::{FAR, Region};
use super::{MOST_RECTS, Rect, Room};

/// From a lamp's middle to walls and columns, metres, if there is so much room.
const OFF_WALLS: f64 = 0.3;

/// Where `count` lamps hang: in rows over the largest rectangles of the room's plan, as many over each as its area
/// deserves, at least 0.3 m off walls and columns where that is possible. As many points as asked for, at the height
/// of the ceiling; none if the room has no area.
pub fn lamps(room: &Room, count: usize) -> Vec<Point> {
    if room.rects.len().saturating_add(room.solids.len()) > MOST_RECTS {
        return Vec::new();
    }
    let clear = Region::new(room.rects, room.solids);
    // Rows of lamps go on behind a column.
    let parts = parts(&Region::new(room.rects, &[]));
    let Some(largest) = clear.largest(|_| true).filter(|_| !parts.is_empty()) else { return Vec::new() };
    let mut points = Vec::new();
    for (part, share) in parts.iter().zip(shares(&parts, count)) {
        points.extend(rows(part, share));
    }
    let ceiling = room.ceiling.clamp(-FAR, FAR);
    let hung = points.into_iter().map(|p| beside_columns(&clear, p).unwrap_or_else(|| middle(&largest)));
    hung.map(|[x, y]| [x, y, ceiling]).collect()
}

/// Disjoint rectangles that fill most of a region, the largest first.
fn parts(region: &Region) -> Vec<Rect> {
    let least = region.area() / 50;
    let mut parts: Vec<Rect> = Vec::new();
    while parts.len() < 12 {
        let rest = region.without(parts.iter().copied());
        // A lamp needs some width; if the whole room has none, any will do.
        let wide = units(2.0 * OFF_WALLS);
        let part = rest.largest(|[w, h]| w >= wide && h >= wide);
        let part = if parts.is_empty() { part.or_else(|| rest.largest(|_| true)) } else { part };
        match part.filter(|part| area(part) > least) {
            Some(part) => parts.push(part),
            None => break,
        }
    }
    parts
}

fn area(rect: &Rect) -> i64 {
    let [w, h] = rect.size();
    i64::from(w) * i64::from(h)
}

fn middle(rect: &Rect) -> [i32; 2] {
    rect.doubled_middle().map(|c| c.div_euclid(2) as i32)
}

/// How many of `count` each rectangle gets, by its area (Sainte-Lague).
fn shares(parts: &[Rect], count: usize) -> Vec<usize> {
    let mut shares = vec![0; parts.len()];
    for _ in 0..count {
        let weight = |i: usize, shares: &[usize]| (i128::from(area(&parts[i])), 2 * shares[i] as i128 + 1);
        let best = (0..parts.len()).reduce(|best, i| {
            let ((a, n), (b, m)) = (weight(best, &shares), weight(i, &shares));
            if b * n > a * m { i } else { best }
        });
        if let Some(best) = best {
            shares[best] += 1;
        }
    }
    shares
}

/// Points in rows over a rectangle, about as far from each other along the rows as across.
fn rows(rect: &Rect, count: usize) -> Vec<[i32; 2]> {
    let [w, h] = rect.size().map(i64::from);
    let n = count as i64;
    let uneven = |rows: i64| (w / ((n + rows - 1) / rows) - h / rows).abs();
    let Some(rows) = (1..=n).min_by_key(|&rows| uneven(rows)) else { return Vec::new() };
    let mut points = Vec::new();
    for row in 0..rows {
        let in_row = n * (row + 1) / rows - n * row / rows;
        let y = spread(rect.lo[1], h, row, rows);
        points.extend((0..in_row).map(|i| [spread(rect.lo[0], w, i, in_row), y]));
    }
    points
}

/// The place of one of `count` on a line: in the middle of its share of it, but not too near the ends.
fn spread(from: i32, length: i64, i: i64, count: i64) -> i32 {
    let margin = i64::from(units(OFF_WALLS));
    let offset = if count > 1 && length / (2 * count) < margin && length > 2 * margin {
        margin + (length - 2 * margin) * i / (count - 1)
    } else {
        length * (2 * i + 1) / (2 * count)
    };
    from + offset as i32
}

/// The point, or if a column is too near the nearest place for a lamp around it.
fn beside_columns(clear: &Region, [x, y]: [i32; 2]) -> Option<[i32; 2]> {
    let fits = |[x, y]: [i32; 2], half: i32| clear.holds(&Rect { lo: [x, y], hi: [x, y] }.grown(half));
    if fits([x, y], units(OFF_WALLS)) {
        return Some([x, y]);
    }
    for half in [units(OFF_WALLS), units(OFF_WALLS) / 4, 1] {
        if half < units(OFF_WALLS) && fits([x, y], half) {
            return Some([x, y]);
        }
        for ring in 1..=16 {
            let step = units(0.125) * ring;
            let around = (-ring..=ring).flat_map(|i| {
                let along = units(0.125) * i;
                [[x + along, y - step], [x + along, y + step], [x - step, y + along], [x + step, y + along]]
            });
            let nearest = around
                .filter(|p| fits(*p, half))
                .min_by_key(|p| i64::from(p[0] - x).pow(2) + i64::from(p[1] - y).pow(2));
            if nearest.is_some() {
                return nearest;
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::interior::Use;

    fn room<'a>(rects: &'a [Rect], solids: &'a [Rect]) -> Room<'a> {
        let (keep_clear, windows) = (&[], &[]);
        Room {
            use_: Use::Office,
            rects,
            solids,
            floor: 0,
            ceiling: 2800,
            keep_clear,
            windows,
            fullness: 100,
            seed: 0,
        }
    }

    fn rect(west: i32, south: i32, east: i32, north: i32) -> Rect {
        Rect { lo: [west, south], hi: [east, north] }
    }

    #[test]
    fn lamps_share_the_room() {
        let corridor = [rect(0, 0, 12000, 2000)];
        let found = lamps(&room(&corridor, &[]), 4);
        assert_eq!(found, [[1500, 1000, 2800], [4500, 1000, 2800], [7500, 1000, 2800], [10500, 1000, 2800]]);
        let hall = [rect(0, 0, 8000, 6000)];
        let six = lamps(&room(&hall, &[]), 6);
        assert_eq!(six[0], [1333, 1500, 2800]);
        assert_eq!(six[5], [6666, 4500, 2800]);
        // One hangs over the larger arm of an L, the next over the other one.
        let l = [rect(0, 0, 8000, 3000), rect(0, 3000, 2000, 7000)];
        assert_eq!(lamps(&room(&l, &[]), 1), [[4000, 1500, 2800]]);
        assert_eq!(lamps(&room(&l, &[]), 3)[2], [1000, 5000, 2800]);
    }

    #[test]
    fn lamps_avoid_columns_and_walls() {
        let hall = [rect(0, 0, 8000, 6000)];
        let column = [rect(3800, 2800, 4200, 3200)];
        let [one] = lamps(&room(&hall, &column), 1)[..] else { panic!("one") };
        let at = Rect { lo: [one[0], one[1]], hi: [one[0], one[1]] };
        assert!(!at.grown(units(0.3)).overlaps(&column[0]), "{one:?}");
        assert!((one[0] - 4000).abs() + (one[1] - 3000).abs() < 1200);
        let many = lamps(&room(&hall, &[]), 400);
        assert_eq!(many.len(), 400);
        assert!(
            many.iter().all(|p| (307..=8000 - 307).contains(&p[0]) && (307..=6000 - 307).contains(&p[1]))
        );
    }

    #[test]
    fn rooms_of_any_size() {
        assert!(lamps(&room(&[], &[]), 5).is_empty());
        assert!(lamps(&room(&[rect(5, 5, 5, 9)], &[]), 5).is_empty());
        assert!(lamps(&room(&[rect(0, 0, 9, 9)], &[rect(-1, -1, 9, 9)]), 5).is_empty(), "all column");
        assert_eq!(lamps(&room(&[rect(0, 0, 3, 3)], &[]), 5).len(), 5);
        let all = [rect(i32::MIN, i32::MIN, i32::MAX, i32::MAX)];
        assert_eq!(lamps(&room(&all, &all[..0]), 7).len(), 7);
    }
}
