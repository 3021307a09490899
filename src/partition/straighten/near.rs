//! What lies near a place of the plan: a grid of rectangles, each with a list.

use crate::lattice::Point;

const NONE: u32 = u32::MAX;

/// Where the tiles are.
#[derive(Clone, Copy)]
struct Tiles {
    low: [i64; 2],
    size: [i64; 2],
    columns: i64,
    rows: i64,
}

/// Things by the tiles that they meet.
pub(super) struct Near {
    tiles: Tiles,
    /// For each tile its latest entry.
    latest: Vec<u32>,
    /// A thing and the entry before.
    entries: Vec<(u32, u32)>,
}

impl Near {
    /// An empty grid over `points`, with about as many tiles as there are points.
    pub fn over(points: impl Iterator<Item = Point>) -> Near {
        let mut low = [i64::MAX; 2];
        let mut high = [i64::MIN; 2];
        let mut count = 0;
        for p in points {
            for (axis, c) in [i64::from(p.x), i64::from(p.y)].into_iter().enumerate() {
                low[axis] = low[axis].min(c);
                high[axis] = high[axis].max(c);
            }
            count += 1;
        }
        if count == 0 {
            (low, high) = ([0; 2], [0; 2]);
        }
        // As many columns as rows, so that what is drawn out, the plan or what it holds, meets no more of them.
        let across = (count as u64).isqrt() as i64;
        let extent = [high[0] - low[0], high[1] - low[1]];
        let size = extent.map(|extent| extent / across.max(1) + 1);
        let (columns, rows) = (extent[0] / size[0] + 1, extent[1] / size[1] + 1);
        let latest = vec![NONE; (columns * rows) as usize];
        Near { tiles: Tiles { low, size, columns, rows }, latest, entries: Vec::new() }
    }

    /// Notes a thing along the segment from `a` to `b`.
    pub fn insert(&mut self, thing: u32, a: Point, b: Point) {
        self.tiles.visit(a, b, 0, |tile| {
            self.entries.push((thing, self.latest[tile]));
            self.latest[tile] = self.entries.len() as u32 - 1;
        });
    }

    /// Lists the things noted in the tiles that come within `reach` of the segment from `a` to `b`, each once, in
    /// ascending order.
    pub fn along(&self, a: Point, b: Point, reach: i64, things: &mut Vec<u32>) {
        things.clear();
        self.tiles.visit(a, b, reach, |tile| {
            let mut entry = self.latest[tile];
            while entry != NONE {
                let (thing, before) = self.entries[entry as usize];
                things.push(thing);
                entry = before;
            }
        });
        things.sort_unstable();
        things.dedup();
    }
}

impl Tiles {
    /// Visits at least the tiles that come within `reach`, by both axes, of the segment from `a` to `b`, which lies
    /// within them.
    fn visit(&self, a: Point, b: Point, reach: i64, mut visit: impl FnMut(usize)) {
        let local = |p: Point| [i64::from(p.x) - self.low[0], i64::from(p.y) - self.low[1]];
        let (mut a, mut b) = (local(a), local(b));
        if a[1] > b[1] {
            std::mem::swap(&mut a, &mut b);
        }
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let row = |y: i64| (y.div_euclid(self.size[1])).clamp(0, self.rows - 1);
        let column = |x: i64| (x.div_euclid(self.size[0])).clamp(0, self.columns - 1);
        for r in row(a[1] - reach)..=row(b[1] + reach) {
            // The segment's part that comes within reach of the row, by x.
            let (mut from, mut to) = (a[0], b[0]);
            if dy > 0 {
                let bottom = (r * self.size[1] - reach).clamp(a[1], b[1]);
                let top = ((r + 1) * self.size[1] + reach).clamp(a[1], b[1]);
                from = a[0] + (dx * (bottom - a[1])).div_euclid(dy);
                to = a[0] + (dx * (top - a[1])).div_euclid(dy);
            }
            // Rounding down took off less than one.
            let (from, to) = (from.min(to) - reach, from.max(to) + 1 + reach);
            for c in column(from)..=column(to) {
                visit((r * self.columns + c) as usize);
            }
        }
    }
}
