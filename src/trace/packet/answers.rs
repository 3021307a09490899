//! What rays meet, and those that are under way.

use super::{ALL, lanes};
use crate::format::records::LANES;
use crate::trace::NONE;
use crate::trace::kernel::Ask;
use crate::trace::lanes::Wide;
use crate::trace::quick::{Quick, nothing};
use crate::trace::ray::Ray;
use crate::trace::walk::Found;

/// So many rays are looked at together at most.
pub(in crate::trace) const BLOCK: usize = 64;

/// What up to [`BLOCK`] rays meet. Ray i is bit i of masks.
pub(in crate::trace) struct Answers {
    known: u64,
    /// The parts of each, side by side: eight in a row are written at once.
    t: [f64; BLOCK],
    triangle: [u32; BLOCK],
    cell: [u32; BLOCK],
    source: [u32; BLOCK],
}

impl Answers {
    pub(in crate::trace) const NONE: Answers = Answers {
        known: 0,
        t: [0.0; BLOCK],
        triangle: [NONE; BLOCK],
        cell: [NONE; BLOCK],
        source: [NONE; BLOCK],
    };

    /// That of a ray, if it is in no doubt.
    #[inline(always)]
    pub(in crate::trace) fn get(&self, ray: usize) -> Option<Quick> {
        (self.known >> ray & 1 != 0).then(|| {
            let ray = ray % BLOCK;
            let found = Found { t: self.t[ray], triangle: self.triangle[ray] };
            Quick { found, cell: self.cell[ray], source: self.source[ray] }
        })
    }

    /// What rays meet one by one, each in its cell: for lanes that are arrays, with which eight at once are hardly faster, slower where they come
    /// apart, and a third of the time to compile the library.
    pub(in crate::trace) fn fill(
        &mut self,
        rays: &[Ray],
        cells: &[u32],
        mut quick: impl FnMut(&Ray, u32) -> Option<Quick>,
    ) {
        for (number, (ray, &cell)) in (0..BLOCK as u8).zip(rays.iter().zip(cells)) {
            if let Some(quick) = quick(ray, cell) {
                self.put(number, quick);
            }
        }
    }

    #[inline(always)]
    pub(in crate::trace) fn clear(&mut self) {
        self.known = 0;
    }

    /// Whether there are those of so many rays.
    #[inline(always)]
    pub(in crate::trace) fn are_all(&self, count: usize) -> bool {
        self.known.trailing_ones() as usize >= count
    }

    #[inline(always)]
    pub(super) fn put(&mut self, ray: u8, quick: Quick) {
        let Quick { found: Found { t, triangle }, cell, source } = quick;
        let at = usize::from(ray) % BLOCK;
        (self.t[at], self.triangle[at], self.cell[at], self.source[at]) = (t, triangle, cell, source);
        self.known |= 1 << at;
    }

    /// Those of eight in a row, which differ in the place only.
    #[inline(always)]
    fn put_row(&mut self, first: u8, t: [f64; LANES], triangle: u32, cell: u32, source: u32) {
        let first = usize::from(first) % BLOCK / LANES * LANES;
        let row = first..first + LANES;
        self.t[row.clone()].copy_from_slice(&t);
        self.triangle[row.clone()].fill(triangle);
        self.cell[row.clone()].fill(cell);
        self.source[row].fill(source);
        self.known |= 0xff << first;
    }
}

/// Rays under way, and the cells in which they are.
pub(super) struct Pool {
    pub(super) ray: [u8; BLOCK],
    pub(super) cell: [u32; BLOCK],
    pub(super) len: usize,
}

impl Pool {
    pub(super) const NONE: Pool = Pool { ray: [0; BLOCK], cell: [NONE; BLOCK], len: 0 };

    #[inline(always)]
    pub(super) fn push(&mut self, ray: u8, cell: u32) {
        (self.ray[self.len % BLOCK], self.cell[self.len % BLOCK]) = (ray, cell);
        self.len += 1;
    }

    /// The rays, and their cells.
    #[inline(always)]
    pub(super) fn iter(&self) -> impl Iterator<Item = (u8, u32)> + '_ {
        self.ray.iter().copied().zip(self.cell.iter().copied()).take(self.len)
    }
}

/// Eight of the rays, by lane, and where what becomes of them is noted.
pub(super) struct Group<'a> {
    pub(super) ask: Ask,
    /// They are where they started.
    pub(super) starts: bool,
    pub(super) numbers: [u8; LANES],
    pub(super) cells: [u32; LANES],
    pub(super) answers: &'a mut Answers,
    /// Those that go on by themselves.
    pub(super) next: &'a mut Pool,
    /// If walls only are looked for: those that they do not end, to be asked about again.
    pub(super) again: Option<&'a mut Pool>,
}

impl Group<'_> {
    /// Of rays that come to faces those of which detail may change the answer; `walled` are those that faces end.
    #[inline(always)]
    pub(super) fn is_open(&self, rays: u32, walled: u32) -> u32 {
        if self.ask == Ask::Any { rays & !walled } else { rays }
    }

    /// Whether any of these have to be asked about again: only walls are looked for, and not where they start, where detail is looked at.
    #[inline(always)]
    pub(super) fn are_again(&self, open: u32) -> bool {
        open != 0 && self.again.is_some() && !self.starts
    }

    /// Whether their numbers are eight in a row, from a multiple of eight on.
    #[inline(always)]
    fn is_row(&self) -> bool {
        const EACH: u64 = 0x0101_0101_0101_0101;
        let first = self.numbers[0];
        let row = 0x0706_0504_0302_0100 + EACH * u64::from(first);
        usize::from(first) % LANES == 0 && u64::from_le_bytes(self.numbers) == row
    }

    /// What ends the ways of some rays of one cell (lane i is bit i): a plane, there.
    #[inline(always)]
    pub(super) fn put_plane<W: Wide>(&mut self, rays: u32, t: W, limit: W, triangle: u32, source: u32) {
        let met = t.store();
        if rays & t.le(limit) == ALL && self.is_row() {
            self.answers.put_row(self.numbers[0], met, triangle, self.cells[0], source);
            return;
        }
        let limits = limit.store();
        for lane in lanes(rays) {
            let found = Found { t: met[lane], triangle };
            self.put(lane, Quick { found, cell: self.cells[lane], source }, limits[lane]);
        }
    }

    /// What ends the way of a ray that ends at `limit`.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, quick: Quick, limit: f64) {
        let is_met = quick.found.triangle != NONE && quick.found.t <= limit;
        self.answers.put(self.numbers[lane], if is_met { quick } else { nothing(limit, quick.cell) });
    }
}
