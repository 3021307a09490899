//! Eight answers, side by side.

use crate::format::records::LANES;
use crate::trace::NONE;
use crate::trace::quick::Quick;
use crate::trace::ray::Brief;
use crate::trace::walk::Found;

/// Eight rays' cells, and what they meet. Lane i is bit i of masks.
pub(in crate::trace) struct Eight {
    /// In which they start; then, where those are that go on.
    pub(in crate::trace) cells: [u32; LANES],
    /// Those that are answered.
    pub(in crate::trace) known: u32,
    /// Infinite where nothing is met.
    pub(super) t: [f64; LANES],
    pub(super) triangle: [u32; LANES],
    /// None where nothing is met.
    pub(super) cell: [u32; LANES],
    pub(super) source: [u32; LANES],
}

impl Eight {
    pub(in crate::trace) const NONE: Eight = Eight {
        cells: [NONE; LANES],
        known: 0,
        t: [0.0; LANES],
        triangle: [NONE; LANES],
        cell: [NONE; LANES],
        source: [NONE; LANES],
    };

    /// The answer of a ray that has one.
    #[inline(always)]
    pub(in crate::trace) fn get(&self, lane: usize) -> Quick {
        let found = Found { t: self.t[lane], triangle: self.triangle[lane] };
        Quick { found, cell: self.cell[lane], source: self.source[lane] }
    }

    /// Whether a ray that has an answer meets anything.
    #[inline(always)]
    pub(in crate::trace) fn is_met(&self, lane: usize) -> bool {
        self.triangle[lane] != NONE
    }

    /// The answer of a ray that has one, in brief.
    #[inline(always)]
    pub(in crate::trace) fn brief(&self, lane: usize) -> Brief {
        Brief { t: self.t[lane], triangle: self.triangle[lane], cell: self.cell[lane] }
    }

    /// An answer; if it is farther than the ray's `limit`, that nothing is met.
    #[inline(always)]
    pub(super) fn put(&mut self, lane: usize, quick: &Quick, limit: f64) {
        self.known |= 1 << lane;
        let is_met = quick.found.triangle != NONE && quick.found.t <= limit;
        self.t[lane] = if is_met { quick.found.t } else { f64::INFINITY };
        self.triangle[lane] = if is_met { quick.found.triangle } else { NONE };
        self.cell[lane] = if is_met { quick.cell } else { NONE };
        self.source[lane] = quick.source;
    }
}
