//! Parts of a picture as scanline intervals: in each row the pixels from one column up to another.
//!
//! A region is convex, so that one interval a row holds it. A straight line splits it into a left and a right part whose border is one more column a row,
//! kept once: what one part has not the other has, and each pixel of the region is in exactly one of them, however the line is rounded.

use super::kernels::{Bound, Kernels};
use super::wide::ROWS;

/// A straight line of the picture, `u x + v y + w = 0` in columns and rows; its positive side is where that is no less than 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line(pub(crate) [f64; 3]);

/// A part of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Region {
    /// First row, and the row after the last.
    pub(super) rows: [i32; 2],
    /// No pixel is left of the first of these columns, none at or right of the second.
    pub(super) columns: [i32; 2],
    /// Where in the arena the borders of the first row of the band would be: the left one, whose column belongs to the region, and the right
    /// one, whose column does not.
    lo: usize,
    hi: usize,
}

impl Region {
    /// The least and the greatest of what a line is at the pixels of the rectangle around it.
    fn values(&self, Line([u, v, w]): Line) -> [f64; 2] {
        let ends = |c: f64, [from, to]: [i32; 2]| {
            let (a, b) = (c * f64::from(from), c * f64::from(to - 1));
            (a.min(b), a.max(b))
        };
        let ((least_x, most_x), (least_y, most_y)) = (ends(u, self.columns), ends(v, self.rows));
        [least_x + least_y + w, most_x + most_y + w]
    }

    /// The same in some of its rows only.
    pub(super) fn within(self, rows: [i32; 2]) -> Region {
        Region { rows, ..self }
    }
}

/// The borders of regions, those of a later region after those of an earlier one, and some more rows, so that eight from any on can be read.
pub(crate) struct Arena {
    columns: Vec<i32>,
    /// The first row of the band.
    first: i32,
}

impl Arena {
    pub(crate) fn new() -> Arena {
        Arena { columns: vec![0; ROWS], first: 0 }
    }

    /// Begins anew with a region of all pixels of the band of rows from `first` up to `end`.
    pub(super) fn begin(&mut self, width: i32, first: i32, end: i32) -> Region {
        self.first = first;
        let count = (end - first).max(0) as usize;
        self.columns.clear();
        self.columns.resize(count, 0);
        self.columns.resize(2 * count, width);
        self.columns.resize(2 * count + ROWS, 0);
        Region { rows: [first, end], columns: [0, width], lo: 0, hi: count }
    }

    /// Begins anew with the region of the rows from the `first` on that holds in each the pixels from one column up to another, and none left or
    /// right of `columns`.
    pub(crate) fn begin_with(
        &mut self,
        columns: [i32; 2],
        first: i32,
        borders: impl ExactSizeIterator<Item = [i32; 2]>,
    ) -> Region {
        self.first = first;
        let count = borders.len();
        self.columns.clear();
        self.columns.resize(2 * count + ROWS, 0);
        let (lo, hi) = self.columns.split_at_mut(count);
        for ((lo, hi), border) in lo.iter_mut().zip(hi).zip(borders) {
            [*lo, *hi] = border;
        }
        Region { rows: [first, first + count as i32], columns, lo: 0, hi: count }
    }

    /// How much of it is in use.
    pub(super) fn top(&self) -> usize {
        self.columns.len() - ROWS
    }

    /// Forgets all borders made since it was so full.
    pub(super) fn forget(&mut self, top: usize) {
        self.columns.truncate(top + ROWS);
    }

    fn range(&self, at: usize, rows: [i32; 2]) -> std::ops::Range<usize> {
        let offset = at.wrapping_add((rows[0] - self.first) as usize);
        offset..offset + (rows[1] - rows[0]) as usize
    }

    /// The left and the right borders of a region, row by row.
    pub(super) fn borders(&self, region: &Region) -> [&[i32]; 2] {
        [region.lo, region.hi].map(|at| &self.columns[self.range(at, region.rows)])
    }

    /// The same, and what comes after: at least seven more.
    pub(super) fn borders_and_more(&self, region: &Region) -> [&[i32]; 2] {
        let offset = (region.rows[0] - self.first) as usize;
        [&self.columns[region.lo.wrapping_add(offset)..], &self.columns[region.hi.wrapping_add(offset)..]]
    }

    /// The parts of a region on the positive and on the negative side of a line.
    pub(super) fn split(
        &mut self,
        kernels: &Kernels,
        region: Region,
        line: Line,
    ) -> (Option<Region>, Option<Region>) {
        let Line([u, v, w]) = line;
        let ([x0, x1], [y0, y1]) = (region.columns, region.rows);
        let [least, most] = region.values(line);
        if least >= 0.0 {
            return (Some(region), None);
        }
        if most < 0.0 {
            return (None, Some(region));
        }
        let (slope, start) = (-v / u, -w / u);
        if !(slope.is_finite() && start.is_finite()) {
            return split_by_rows(region, v, w);
        }
        let top = self.top();
        let count = (y1 - y0) as usize;
        let (lo, hi) = (self.range(region.lo, region.rows), self.range(region.hi, region.rows));
        self.columns.resize(top + count + ROWS, 0);
        let (old, new) = self.columns.split_at_mut(top);
        let new = &mut new[..count];
        let (lo, hi) = (&old[lo], &old[hi]);
        let [least, most] = kernels.split([lo, hi], new, y0, [slope, start]);
        let border = top.wrapping_sub((y0 - self.first) as usize);
        // Rows of which a part has nothing are left out at both ends.
        let left = trimmed(lo, new, y0).map(|rows| Region {
            rows,
            columns: [x0, x1.min(most)],
            hi: border,
            ..region
        });
        let right = trimmed(new, hi, y0).map(|rows| Region {
            rows,
            columns: [x0.max(least), x1],
            lo: border,
            ..region
        });
        if u > 0.0 { (right, left) } else { (left, right) }
    }

    /// Gives `take` the pixels of a region at which one line is as near to 0 as another one says: the row, and from which column up to which.
    pub(super) fn near(
        &self,
        kernels: &Kernels,
        region: Region,
        (line, off): (Line, Line),
        take: &mut dyn FnMut(i32, [i32; 2]),
    ) {
        let by = |sign: f64| Line([0, 1, 2].map(|i| off.0[i] + sign * line.0[i]));
        let lines = [by(1.0), by(-1.0)];
        if lines.iter().any(|&line| region.values(line)[1] < 0.0) {
            return;
        }
        let mut rows = region.rows;
        let bounds = lines.map(|Line(line)| Bound::new(line.into(), &mut rows));
        if rows[0] < rows[1] {
            kernels.near(self.borders(&region.within(rows)), rows[0], bounds, take);
        }
    }
}

/// Gives `add` those parts of a row, from one column up to another, that are not taken: the row, and from where up to where.
pub(super) fn free_parts(
    row: i32,
    [from, to]: [i32; 2],
    is_taken: impl Fn(i32) -> bool,
    mut add: impl FnMut([i32; 3]),
) {
    let mut free = from;
    for column in from..to {
        if is_taken(column) {
            if free < column {
                add([row, free, column]);
            }
            free = column + 1;
        }
    }
    if free < to {
        add([row, free, to]);
    }
}

/// The rows, the first being `first`, from the first to the last that is not empty.
fn trimmed(lo: &[i32], hi: &[i32], first: i32) -> Option<[i32; 2]> {
    let holds = |(lo, hi): (&i32, &i32)| lo < hi;
    let start = lo.iter().zip(hi).position(holds)?;
    let end = lo.iter().zip(hi).rposition(holds)?;
    Some([first + start as i32, first + end as i32 + 1])
}

/// The parts of a region on the two sides of a line along the rows.
fn split_by_rows(region: Region, v: f64, w: f64) -> (Option<Region>, Option<Region>) {
    let [y0, y1] = region.rows;
    let row = (-w / v).ceil().clamp(f64::from(y0), f64::from(y1));
    // A line that is none, of a plane that is none, leaves all on one side.
    let row = if row.is_nan() { y0 } else { row as i32 };
    let part = |rows: [i32; 2]| (rows[0] < rows[1]).then_some(Region { rows, ..region });
    let (upper, lower) = (part([y0, row]), part([row, y1]));
    if v < 0.0 { (upper, lower) } else { (lower, upper) }
}
