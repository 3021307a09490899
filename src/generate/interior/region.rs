//! The plan of a room: a union of rectangles without what stands in it, exactly.

use super::Rect;

/// Coordinates beyond this are cut off, so that sums of two of them stay far from overflow: 524 km.
pub const FAR: i32 = 1 << 29;

/// A part of the plane bounded by lines along the axes.
#[derive(Clone, Debug, Default)]
pub struct Region {
    added: Vec<Rect>,
    taken: Vec<Rect>,
    /// All coordinates of the rectangles on each axis, in order: they cut the plane into cells.
    cuts: [Vec<i32>; 2],
    /// For each cell, row by row, whether it is inside.
    inside: Vec<bool>,
    /// For each corner of a cell: how many cells inside are left of it and below.
    counts: Vec<u32>,
}

/// A straight piece of the boundary, with the region on its left: seen with the back to it, u runs along it to the
/// left and v into the region, as in a [`Placement`](crate::generate::lattice::Placement) with these turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wall {
    /// Where u is 0.
    pub start: [i32; 2],
    /// Units.
    pub length: i32,
    /// Quarter turns.
    pub turns: u8,
}

impl Region {
    /// What lies in a rectangle of `added` and in none of `taken`.
    pub fn new(added: &[Rect], taken: &[Rect]) -> Region {
        let near = |rects: &[Rect]| -> Vec<Rect> {
            let cut = |r: &Rect| Rect {
                lo: r.lo.map(|c| c.clamp(-FAR, FAR)),
                hi: r.hi.map(|c| c.clamp(-FAR, FAR)),
            };
            rects.iter().map(cut).filter(|r| !r.is_empty()).collect()
        };
        let (added, taken) = (near(added), near(taken));
        let cuts = [0, 1].map(|axis| {
            let mut cuts: Vec<i32> =
                added.iter().chain(&taken).flat_map(|r| [r.lo[axis], r.hi[axis]]).collect();
            cuts.sort_unstable();
            cuts.dedup();
            cuts
        });
        let size = [0, 1].map(|axis| cuts[axis].len().saturating_sub(1));
        let mut region =
            Region { added, taken, cuts, inside: vec![false; size[0] * size[1]], counts: Vec::new() };
        for (rects, value) in [(&region.added, true), (&region.taken, false)] {
            for rect in rects {
                let [columns, rows] = [0, 1].map(|axis| region.span(axis, rect.lo[axis], rect.hi[axis]));
                for row in rows {
                    region.inside[row * size[0]..][columns.clone()].fill(value);
                }
            }
        }
        region.counts = vec![0; (size[0] + 1) * (size[1] + 1)];
        let wide = size[0] + 1;
        for row in 0..size[1] {
            let mut left = 0;
            for column in 0..size[0] {
                left += u32::from(region.inside[row * size[0] + column]);
                region.counts[(row + 1) * wide + column + 1] = region.counts[row * wide + column + 1] + left;
            }
        }
        region
    }

    /// The region without more rectangles.
    pub fn without(&self, more: impl Iterator<Item = Rect>) -> Region {
        let taken: Vec<Rect> = self.taken.iter().copied().chain(more).collect();
        Region::new(&self.added, &taken)
    }

    fn columns(&self) -> usize {
        self.cuts[0].len().saturating_sub(1)
    }

    fn rows(&self) -> usize {
        self.cuts[1].len().saturating_sub(1)
    }

    /// The cells between two coordinates, those that they cut included.
    fn span(&self, axis: usize, lo: i32, hi: i32) -> std::ops::Range<usize> {
        let cuts = &self.cuts[axis];
        let first = cuts.partition_point(|&c| c <= lo).saturating_sub(1);
        let end = cuts.partition_point(|&c| c < hi).min(cuts.len().saturating_sub(1));
        first.min(end)..end
    }

    /// How many cells that a rectangle covers or cuts there are, and how many of them are inside.
    fn cells(&self, rect: &Rect) -> (usize, usize) {
        let [columns, rows] = [0, 1].map(|axis| self.span(axis, rect.lo[axis], rect.hi[axis]));
        let wide = self.columns() + 1;
        let count =
            |row: usize, column: usize| self.counts.get(row * wide + column).map_or(0, |&c| c as usize);
        let inside = count(rows.end, columns.end) + count(rows.start, columns.start)
            - count(rows.start, columns.end)
            - count(rows.end, columns.start);
        (columns.len() * rows.len(), inside)
    }

    /// Whether a rectangle that is not empty lies in the region; it may touch its boundary.
    pub fn holds(&self, rect: &Rect) -> bool {
        let in_bounds = (0..2).all(|axis| {
            let cuts = &self.cuts[axis];
            cuts.first().is_some_and(|&c| c <= rect.lo[axis])
                && cuts.last().is_some_and(|&c| c >= rect.hi[axis])
        });
        let (all, inside) = self.cells(rect);
        in_bounds && !rect.is_empty() && all == inside
    }

    /// Whether no point inside a rectangle lies in the region.
    pub fn misses(&self, rect: &Rect) -> bool {
        let beside = (0..2).any(|axis| {
            let cuts = &self.cuts[axis];
            cuts.first().is_none_or(|&c| c >= rect.hi[axis])
                || cuts.last().is_none_or(|&c| c <= rect.lo[axis])
        });
        beside || rect.is_empty() || self.cells(rect).1 == 0
    }

    /// The smallest rectangle around it.
    pub fn bounds(&self) -> Option<Rect> {
        let ends = |axis: usize| Some((*self.cuts[axis].first()?, *self.cuts[axis].last()?));
        let ((x0, x1), (y0, y1)) = (ends(0)?, ends(1)?);
        Some(Rect { lo: [x0, y0], hi: [x1, y1] })
    }

    /// Its area, square units.
    pub fn area(&self) -> i64 {
        let size = |axis: usize, i: usize| i64::from(self.cuts[axis][i + 1]) - i64::from(self.cuts[axis][i]);
        let wide = self.columns();
        (0..self.inside.len())
            .filter(|&cell| self.inside[cell])
            .map(|cell| size(0, cell % wide) * size(1, cell / wide))
            .sum()
    }

    /// The straight pieces of its boundary.
    pub fn walls(&self) -> Vec<Wall> {
        let (wide, high) = (self.columns(), self.rows());
        let at = |column: usize, row: usize| column < wide && row < high && self.inside[row * wide + column];
        let mut walls = Vec::new();
        // Along x: the region above the line, then below it.
        for (turns, side) in [(0u8, 0usize), (2, 1)] {
            for line in 0..self.cuts[1].len() {
                let is_wall = |column: usize| {
                    let (above, below) = (at(column, line), line > 0 && at(column, line - 1));
                    if side == 0 { above && !below } else { below && !above }
                };
                for run in runs(wide, is_wall) {
                    let (x0, x1) = (self.cuts[0][run.start], self.cuts[0][run.end]);
                    let start = [if side == 0 { x0 } else { x1 }, self.cuts[1][line]];
                    walls.push(Wall { start, length: x1 - x0, turns });
                }
            }
        }
        // Along y: the region to the left of the line, then to the right.
        for (turns, side) in [(1u8, 0usize), (3, 1)] {
            for line in 0..self.cuts[0].len() {
                let is_wall = |row: usize| {
                    let (right, left) = (at(line, row), line > 0 && at(line - 1, row));
                    if side == 0 { left && !right } else { right && !left }
                };
                for run in runs(high, is_wall) {
                    let (y0, y1) = (self.cuts[1][run.start], self.cuts[1][run.end]);
                    let start = [self.cuts[0][line], if side == 0 { y0 } else { y1 }];
                    walls.push(Wall { start, length: y1 - y0, turns });
                }
            }
        }
        walls
    }

    /// The rectangle of the greatest area in the region among those of a size that `suits`.
    pub fn largest(&self, suits: impl Fn([i32; 2]) -> bool) -> Option<Rect> {
        let (wide, high) = (self.columns(), self.rows());
        let mut best: Option<(i64, Rect)> = None;
        // For each column, the row from which on it is inside without a break.
        let mut since: Vec<usize> = vec![0; wide];
        for row in 0..high {
            for column in 0..wide {
                if !self.inside[row * wide + column] {
                    since[column] = row + 1;
                }
            }
            // Rectangles whose top is this row's and that can grow to no side: on the stack, lower bottoms further up.
            let mut stack: Vec<(usize, usize)> = Vec::new();
            for column in 0..=wide {
                let bottom = if column < wide { since[column] } else { row + 1 };
                let mut left = column;
                while let Some(&(first, start)) = stack.last() {
                    if start >= bottom {
                        break;
                    }
                    stack.pop();
                    left = first;
                    let rect = Rect {
                        lo: [self.cuts[0][first], self.cuts[1][start]],
                        hi: [self.cuts[0][column], self.cuts[1][row + 1]],
                    };
                    let [w, h] = rect.size();
                    let area = i64::from(w) * i64::from(h);
                    if best.is_none_or(|(most, _)| area > most) && suits([w, h]) {
                        best = Some((area, rect));
                    }
                }
                if bottom <= row && stack.last().is_none_or(|&(_, start)| start > bottom) {
                    stack.push((left, bottom));
                }
            }
        }
        best.map(|(_, rect)| rect)
    }
}

/// The longest runs of numbers below `end` for which something holds.
fn runs(end: usize, holds: impl Fn(usize) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for i in (0..end).filter(|&i| holds(i)) {
        match runs.last_mut() {
            Some(run) if run.end == i => run.end = i + 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}
