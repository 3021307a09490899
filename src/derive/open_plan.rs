//! Where rooms meet in the air: lines along which what hangs together, and is as large as an open plan, is cut into several rooms.
//!
//! - *Gaps in a wall*: the wall ends, and goes on in the same line no farther away than the widest hole.
//! - *Mouths of corridors*: places narrower than a corridor may be, and long, that end in a much wider one.
//!   A corridor leads on, to somewhere else than it came from: a bay of a hall does not. What is narrow is what no disc fits into that is as wide (the opening of mathematical morphology, on a grid); where it ends, the
//!   shortest line from a corner to what is across closes it.

use std::collections::BTreeMap;

use glam::DVec2;

use super::raster::{Contact, Raster, distances};

/// Nothing is told apart by less floor than this, m2.
pub(super) const LEAST_PIECE: f64 = 3.0;
/// A wall before and after a gap is as long as this, metres.
const WALL: f64 = 0.4;
/// A gap is wider than this, metres: others are slits, which nobody passes.
const SLIT: f64 = 0.25;
/// Walls in one line: sine between them.
const IN_LINE: f64 = 0.05;
/// Two lines that close one gap, on either face of the wall, are no farther apart than this, metres.
const THICKEST: f64 = 0.8;
/// Corridors have at least this floor area, m2.
const LEAST_CORRIDOR: f64 = 10.0;
/// Corridors are so many times as long as wide.
const LONG: f64 = 2.0;
/// What a corridor ends in is so many times as wide.
const WIDER: f64 = 2.0;
/// Free-standing things smaller than this, m2, columns, are not what bounds a place.
const COLUMN: f64 = 1.5;
/// How far lines go on into matter, metres.
const INTO_WALL: f64 = 2e-3;

/// A straight piece of a border, what it bounds on its left; metres.
#[derive(Clone, Copy, Debug)]
struct Wall {
    from: DVec2,
    to: DVec2,
    /// Of unit length.
    way: DVec2,
    /// The wall that goes on where it ends, if only one does.
    next: Option<usize>,
}

/// A corner around which what is bounded turns: the walls that end and begin there.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: DVec2,
    before: usize,
    after: usize,
}

/// What hangs together in the plan.
pub(super) struct Place {
    /// Its triangles, counter-clockwise, metres.
    pub(super) triangles: Vec<[DVec2; 3]>,
    /// Its border, what it bounds on the left: from where to where, by names of the points, and metres.
    pub(super) border: Vec<([u32; 2], [DVec2; 2])>,
    /// Square metres.
    pub(super) area: f64,
}

/// How to cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cutting {
    /// The widest gap, metres.
    pub(super) widest_gap: f64,
    /// The widest corridor, metres.
    pub(super) widest_corridor: f64,
    /// The least area of an open plan, m2.
    pub(super) open_plan: f64,
}

/// A line along which to cut a place, metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) ends: [DVec2; 2],
    /// It closes a gap in a wall, as a door would.
    pub(super) is_gap: bool,
}

/// Lines along which to cut a place.
pub(super) fn cuts(place: &Place, how: Cutting) -> Vec<Cut> {
    if place.area < how.open_plan.max(2.0 * LEAST_PIECE) {
        return Vec::new();
    }
    let walls = walls(&place.border);
    let corners = corners(&walls);
    let Some(mut raster) = Raster::new(&place.triangles) else { return Vec::new() };
    let gaps = gaps(&walls, &corners, &raster, how.widest_gap);
    for &gap in &gaps {
        raster.block(gap);
    }
    let mouths = mouths(&walls, &corners, &raster, how);
    let cut = |is_gap: bool| move |[a, b]: [DVec2; 2]| Cut { ends: longer(a, b), is_gap };
    gaps.into_iter().map(cut(true)).chain(mouths.into_iter().map(cut(false))).collect()
}

/// A little into what it ends at.
fn longer(a: DVec2, b: DVec2) -> [DVec2; 2] {
    let way = (b - a).normalize_or_zero() * INTO_WALL;
    [a - way, b + way]
}

/// The border as straight walls.
fn walls(border: &[([u32; 2], [DVec2; 2])]) -> Vec<Wall> {
    let mut out: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut into: BTreeMap<u32, u32> = BTreeMap::new();
    for (i, (ends, _)) in border.iter().enumerate() {
        out.entry(ends[0]).or_default().push(i);
        *into.entry(ends[1]).or_default() += 1;
    }
    let next = |i: usize| -> Option<usize> {
        let end = border[i].0[1];
        match out.get(&end).map(Vec::as_slice) {
            Some(&[only]) if into.get(&end) == Some(&1) => Some(only),
            _ => None,
        }
    };
    let way = |i: usize| (border[i].1[1] - border[i].1[0]).normalize_or_zero();
    let is_straight =
        |i: usize, j: usize| way(i).perp_dot(way(j)).abs() < 0.5 * IN_LINE && way(i).dot(way(j)) > 0.0;
    // Pieces that go on straight are one wall, from where one begins that the one before does not lead straight to; of a ring without a
    // beginning, from anywhere.
    let mut is_led_to = vec![false; border.len()];
    for i in 0..border.len() {
        if let Some(j) = next(i).filter(|&j| is_straight(i, j)) {
            is_led_to[j] = true;
        }
    }
    let mut wall_at = vec![None; border.len()];
    let mut is_seen = vec![false; border.len()];
    let mut walls = Vec::new();
    let mut lasts = Vec::new();
    let beginnings = (0..border.len()).filter(|&i| !is_led_to[i]);
    for beginning in beginnings.chain(0..border.len()) {
        let mut at = Some(beginning);
        // What turns little by little is a wall again and again.
        while let Some(first) = at.filter(|&i| !is_seen[i]) {
            let mut last = first;
            is_seen[first] = true;
            at = next(first).filter(|&j| is_straight(first, j));
            while let Some(j) = at.filter(|&j| !is_seen[j] && is_straight(first, j)) {
                (is_seen[j], last) = (true, j);
                at = next(j).filter(|&k| is_straight(j, k));
            }
            wall_at[first] = Some(walls.len());
            let (from, to) = (border[first].1[0], border[last].1[1]);
            walls.push(Wall { from, to, way: (to - from).normalize_or_zero(), next: None });
            lasts.push(last);
        }
    }
    for (wall, last) in walls.iter_mut().zip(lasts) {
        wall.next = next(last).and_then(|j| wall_at[j]);
    }
    walls
}

fn corners(walls: &[Wall]) -> Vec<Corner> {
    let mut corners: Vec<Corner> = walls
        .iter()
        .enumerate()
        .filter_map(|(before, wall)| {
            let after = wall.next?;
            (wall.way.perp_dot(walls[after].way) < -0.1).then_some(Corner { at: wall.to, before, after })
        })
        .collect();
    corners.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
    corners
}

/// The corners that are no farther from a point than `reach` along x; they ascend there.
fn near(corners: &[Corner], point: DVec2, reach: f64) -> &[Corner] {
    let reach = reach.max(0.0);
    let first = corners.partition_point(|corner| corner.at.x < point.x - reach);
    let end = corners.partition_point(|corner| corner.at.x <= point.x + reach);
    &corners[first..end]
}

/// By wall: whether it is of something small that stands free.
fn columns(walls: &[Wall]) -> Vec<bool> {
    let mut is_column = vec![false; walls.len()];
    let mut is_seen = vec![false; walls.len()];
    for first in 0..walls.len() {
        let (mut around, mut twice, mut at) = (Vec::new(), 0.0, Some(first));
        while let Some(i) = at.filter(|&i| !std::mem::replace(&mut is_seen[i], true)) {
            around.push(i);
            twice += (walls[i].from - walls[first].from).perp_dot(walls[i].to - walls[first].from);
            at = walls[i].next;
        }
        // What a place is around lies on the right of its border.
        if at == Some(first) && twice < 0.0 && -twice < 2.0 * COLUMN {
            around.into_iter().for_each(|i| is_column[i] = true);
        }
    }
    is_column
}

/// Gaps between walls in one line.
fn gaps(walls: &[Wall], corners: &[Corner], raster: &Raster, widest: f64) -> Vec<[DVec2; 2]> {
    let is_column = columns(walls);
    let length = |wall: usize| walls[wall].from.distance(walls[wall].to);
    let mut found: Vec<[DVec2; 2]> = Vec::new();
    for one in corners.iter().filter(|one| length(one.before) >= WALL && !is_column[one.before]) {
        let way = walls[one.before].way;
        let goes_on = |other: &&Corner| {
            let (gap, across) = (other.at - one.at, walls[other.after].way);
            let size = gap.length();
            (SLIT..=widest).contains(&size)
                && gap.dot(way) > 0.0
                && gap.perp_dot(way).abs() < IN_LINE * size
                && across.dot(way) > 0.0
                && across.perp_dot(way).abs() < IN_LINE
                && length(other.after) >= WALL
                && !is_column[other.after]
        };
        let nearest = near(corners, one.at, widest)
            .iter()
            .filter(goes_on)
            .min_by(|a, b| a.at.distance(one.at).total_cmp(&b.at.distance(one.at)));
        let Some(other) = nearest else { continue };
        let gap = [one.at, other.at];
        // The other face of the same wall has the same gap.
        let is_known = found.iter().any(|known| {
            let middles = (known[0] + known[1] - gap[0] - gap[1]) / 2.0;
            middles.length() <= THICKEST
        });
        if !is_known && raster.is_clear(gap) {
            found.push(gap);
        }
    }
    found
}

/// The mouths of corridors.
fn mouths(walls: &[Wall], corners: &[Corner], raster: &Raster, how: Cutting) -> Vec<[DVec2; 2]> {
    let radius = how.widest_corridor / 2.0;
    let free = raster.without_specks(COLUMN);
    let room = distances(raster, |i| !free[i]);
    let wide = distances(raster, |i| room[i] >= radius);
    // 0 no place, 1 wide, 2 narrow.
    let kind: Vec<u8> = (0..free.len())
        .map(|i| match raster.is_inside(i) {
            false => 0,
            true if wide[i] <= radius => 1,
            true => 2,
        })
        .collect();
    let pieces = raster.pieces(|i, j| kind[i] != 0 && kind[i] == kind[j]);
    let count = pieces.iter().max().map_or(0, |most| *most as usize + 1);
    let (mut cells, mut sum, mut most) = (vec![0u64; count], vec![0.0; count], vec![0.0f64; count]);
    for (i, &piece) in pieces.iter().enumerate() {
        let piece = piece as usize;
        cells[piece] += 1;
        sum[piece] += room[i];
        most[piece] = most[piece].max(room[i]);
    }
    // In a strip the mean distance from its border is a fourth of its width.
    let width = |piece: usize| 4.0 * sum[piece] / cells[piece] as f64;
    let is_corridor = |piece: usize| {
        let area = cells[piece] as f64 * raster.step() * raster.step();
        area >= LEAST_CORRIDOR && area >= LONG * width(piece) * width(piece)
    };
    let mut contacts = raster.contacts(&pieces, |i| kind[i]);
    contacts.retain(|contact| {
        let [narrow, hall] = contact.pieces.map(|piece| piece as usize);
        is_corridor(narrow) && 2.0 * most[hall] >= WIDER * width(narrow)
    });
    // A corridor leads on: to another hall, to the same one elsewhere, or through a gap in a wall.
    let mut ends: BTreeMap<u32, usize> = BTreeMap::new();
    for piece in contacts.iter().map(|contact| contact.pieces[0]).chain(raster.beside_blocked(&pieces)) {
        *ends.entry(piece).or_default() += 1;
    }
    let leads_on = |contact: &&Contact| ends.get(&contact.pieces[0]).is_some_and(|ends| *ends > 1);
    let closed = contacts.iter().filter(leads_on).filter_map(|contact| {
        let here = 2.0 * raster.at(contact.middle).map_or(0.0, |i| room[i]);
        mouth(walls, corners, raster, contact.middle, here)
    });
    closed.collect()
}

/// The shortest line from a corner to another, or to a wall, that passes near a point where a corridor is `width` wide.
fn mouth(
    walls: &[Wall],
    corners: &[Corner],
    raster: &Raster,
    point: DVec2,
    width: f64,
) -> Option<[DVec2; 2]> {
    // A disc that comes to the corridor from the hall reaches into it, and columns may stand beside it.
    let lengths = 0.7 * width..=1.2 * width + 0.3;
    let aside = width / 2.0 + 0.8;
    let mut best: Option<(f64, [DVec2; 2])> = None;
    let mut offer = |line: [DVec2; 2]| {
        let (length, off) = (line[0].distance(line[1]), ((line[0] + line[1]) / 2.0).distance(point));
        let score = length + off;
        let fits = off <= aside && lengths.contains(&length);
        if fits && best.is_none_or(|best| score < best.0) && raster.is_clear(line) {
            best = Some((score, line));
        }
    };
    let reach = lengths.end() / 2.0 + aside;
    let around = near(corners, point, reach);
    let around: Vec<&Corner> = around.iter().filter(|corner| corner.at.distance(point) <= reach).collect();
    let walls: Vec<&Wall> = walls.iter().filter(|wall| foot(wall, point).distance(point) <= reach).collect();
    for (i, one) in around.iter().enumerate() {
        for other in &around[i + 1..] {
            offer([one.at, other.at]);
        }
        for wall in &walls {
            let foot = foot(wall, one.at);
            if foot != wall.from && foot != wall.to {
                offer([one.at, foot]);
            }
        }
    }
    best.map(|best| best.1)
}

/// The point of a wall nearest to another.
fn foot(wall: &Wall, point: DVec2) -> DVec2 {
    let length = wall.from.distance(wall.to);
    let along = (point - wall.from).dot(wall.way);
    if along <= 0.0 {
        wall.from
    } else if along >= length {
        wall.to
    } else {
        wall.from + wall.way * along
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A place made of boxes on a grid of metres that do not overlap: from x, y to x, y.
    fn place(boxes: &[[i32; 4]]) -> Place {
        let is_in = |x: i32, y: i32| boxes.iter().any(|b| x >= b[0] && x < b[2] && y >= b[1] && y < b[3]);
        let name = |x: i32, y: i32| (y * 1000 + x) as u32;
        let point = |x: i32, y: i32| DVec2::new(f64::from(x), f64::from(y));
        let (mut triangles, mut border, mut area) = (Vec::new(), Vec::new(), 0.0);
        for y in 0..60 {
            for x in (0..60).filter(|&x| is_in(x, y)) {
                area += 1.0;
                let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
                let [a, b, c, d] = corners.map(|(x, y)| point(x, y));
                triangles.extend([[a, b, c], [a, c, d]]);
                for (i, (dx, dy)) in [(0, -1), (1, 0), (0, 1), (-1, 0)].into_iter().enumerate() {
                    if !is_in(x + dx, y + dy) {
                        let ends = [corners[i], corners[(i + 1) % 4]];
                        border.push((ends.map(|(x, y)| name(x, y)), ends.map(|(x, y)| point(x, y))));
                    }
                }
            }
        }
        Place { triangles, border, area }
    }

    const HOW: Cutting = Cutting { widest_gap: 3.0, widest_corridor: 4.5, open_plan: 100.0 };

    fn spans(cuts: &[Cut]) -> Vec<[i32; 4]> {
        let mut spans: Vec<[i32; 4]> = cuts
            .iter()
            .map(|Cut { ends: [a, b], .. }| {
                let (lo, hi) = (a.min(*b), a.max(*b));
                [lo.x, lo.y, hi.x, hi.y].map(|c| c.round() as i32)
            })
            .collect();
        spans.sort_unstable();
        spans
    }

    #[test]
    fn a_gap_in_a_wall_is_closed_once() {
        // Two rooms, and a hole of 2 m in the wall between them, which is thicker than what counts as one: on either face.
        let rooms = [[0, 0, 10, 5], [4, 5, 6, 6], [0, 6, 10, 12]];
        assert_eq!(spans(&cuts(&place(&rooms), HOW)), [[4, 5, 6, 5], [4, 6, 6, 6]]);
        // In what is no open plan, none.
        assert!(cuts(&place(&rooms), Cutting { open_plan: 120.0, ..HOW }).is_empty());
        // No gap: the wall does not go on beyond it.
        assert!(cuts(&place(&[[0, 0, 10, 9], [8, 9, 10, 14]]), HOW).is_empty());
        // Wider than a hole.
        assert!(cuts(&place(&[[0, 0, 12, 5], [4, 5, 8, 6], [0, 6, 12, 12]]), HOW).is_empty());
    }

    #[test]
    fn columns_are_no_walls() {
        // A hall of 16 by 16 m with a column of 1 m2 every 4 m.
        let mut boxes = Vec::new();
        for y in 0..16 {
            for x in 0..16 {
                if x % 4 != 3 || y % 4 != 3 || x == 15 || y == 15 {
                    boxes.push([x, y, x + 1, y + 1]);
                }
            }
        }
        assert!(cuts(&place(&boxes), HOW).is_empty());
        // Walls of 2 m in their places are walls.
        let mut split = vec![[0, 0, 12, 6], [0, 7, 12, 13]];
        split.extend([[2, 6, 4, 7], [6, 6, 8, 7], [10, 6, 12, 7]]);
        assert!(!cuts(&place(&split), HOW).is_empty());
    }

    #[test]
    fn round_walls_have_no_long_straight_ones() {
        let count = 720;
        let at = |i: u32| DVec2::from_angle(f64::from(i) / f64::from(count) * std::f64::consts::TAU) * 8.0;
        let border: Vec<([u32; 2], [DVec2; 2])> =
            (0..count).map(|i| ([i, (i + 1) % count], [at(i), at((i + 1) % count)])).collect();
        let walls = walls(&border);
        assert!(walls.len() > 60, "{}", walls.len());
        assert!(walls.iter().all(|wall| wall.from.distance(wall.to) < 1.0 && wall.next.is_some()));
    }

    #[test]
    fn a_corridor_ends_where_it_comes_to_a_hall() {
        // Along the side of two halls: from its own corner to the wall across.
        let plan = place(&[[0, 0, 12, 12], [12, 0, 28, 3], [28, 0, 40, 12]]);
        let found = cuts(&plan, HOW);
        assert_eq!(spans(&found), [[12, 0, 12, 3], [28, 0, 28, 3]]);
        // A bay of a hall is none, however long, nor is what is no open plan.
        assert!(cuts(&place(&[[0, 0, 12, 12], [12, 0, 15, 3]]), HOW).is_empty());
        assert!(cuts(&place(&[[0, 0, 12, 12], [12, 0, 30, 3]]), HOW).is_empty());
        assert!(cuts(&place(&[[0, 0, 7, 7], [7, 0, 20, 3]]), HOW).is_empty());
    }
}
