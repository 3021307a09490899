//! Where the triangles of cells are still to be drawn.
//!
//! Packets come to a cell's triangles one by one, most of them small. What they show of these is drawn once for all of them, at last: a triangle hides
//! the faces behind the cell, whichever is written first.

use crate::trace::NONE;

/// The parts of a band's rows whose rays are in cells with triangles.
pub(super) struct Waiting {
    /// Rows of the band.
    rows: usize,
    /// The area of each of the tree's details; or none.
    areas: Vec<u32>,
    /// The areas, of which so many are in use.
    known: Vec<Area>,
    count: usize,
}

/// The parts of rows whose rays are in one cell, none of which overlap.
pub(super) struct Area {
    /// Which of the tree's details.
    pub(super) detail: u32,
    /// Of each row the part that came last: from which column up to which.
    last: Vec<[i32; 2]>,
    /// Those that came before and do not touch it: row, and from where up to where.
    more: Vec<[i32; 3]>,
}

impl Waiting {
    pub(super) fn new() -> Waiting {
        Waiting { rows: 0, areas: Vec::new(), known: Vec::new(), count: 0 }
    }

    /// Begins with a band of so many rows, in which no packet came to any of so many details.
    pub(super) fn begin(&mut self, rows: usize) {
        self.rows = rows;
        self.areas.clear();
        self.count = 0;
    }

    /// The area of one of the tree's details.
    pub(super) fn area(&mut self, detail: u32) -> &mut Area {
        let index = detail as usize;
        if self.areas.len() <= index {
            self.areas.resize(index + 1, NONE);
        }
        if self.areas[index] == NONE {
            self.areas[index] = self.count as u32;
            if self.known.len() == self.count {
                self.known.push(Area { detail, last: Vec::new(), more: Vec::new() });
            }
            let area = &mut self.known[self.count];
            area.detail = detail;
            area.last.clear();
            area.last.resize(self.rows, [0; 2]);
            area.more.clear();
            self.count += 1;
        }
        &mut self.known[self.areas[index] as usize]
    }

    /// All areas, in the order in which packets came there.
    pub(super) fn all(&mut self) -> &mut [Area] {
        &mut self.known[..self.count]
    }
}

impl Area {
    /// Adds a part of a row, from one column up to another.
    #[inline]
    pub(super) fn add(&mut self, row: usize, part: [i32; 2]) {
        let last = &mut self.last[row];
        if last[1] == part[0] && last[0] < last[1] {
            last[1] = part[1];
        } else if part[0] < part[1] {
            if last[0] < last[1] {
                self.more.push([row as i32, last[0], last[1]]);
            }
            *last = part;
        }
    }

    /// Gives `draw` all parts, of each row one at a time: the first row that has any, and the parts from there on. Parts that are not there are empty.
    pub(super) fn draw(&mut self, mut draw: impl FnMut(usize, &[[i32; 2]])) {
        let is_there = |part: &[i32; 2]| part[0] < part[1];
        self.more.sort_by_key(|[row, ..]| *row);
        while let Some(first) = self.last.iter().position(is_there) {
            let end = self.last.iter().rposition(is_there).map_or(first, |last| last + 1);
            draw(first, &self.last[first..end]);
            self.last.fill([0; 2]);
            let (last, mut before) = (&mut self.last, -1);
            self.more.retain(|&[row, lo, hi]| {
                let is_first = row != before;
                if is_first {
                    last[row as usize] = [lo, hi];
                    before = row;
                }
                !is_first
            });
        }
    }
}
