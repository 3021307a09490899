//! A ray that no cell is walked through for: in a scene that was left one cell, and from outside of all prisms. All that it can meet is in one hierarchy.

use super::cost::Count;
use super::kernel::Ask;
use super::lanes::Lanes;
use super::line::Line;
use super::quick::{Quick, nothing};
use super::walk::{Found, Walk, walk};
use crate::NONE;
use crate::format::Views;

/// What a ray meets of all triangles, first or at all, that starts on no surface and in no solid.
#[inline(always)]
pub(super) fn alone<L: Lanes>(ask: Ask, tables: &Views, line: &Line, count: &mut impl Count) -> Quick {
    let query = line.query(tables, None);
    let found = walk::<L>(ask, &Walk::new(tables), &query, None, count);
    if found.triangle == NONE {
        return nothing(line.tmax, 0);
    }
    // Not -0.
    Quick { found: Found { t: found.t + 0.0, ..found }, cell: 0, source: NONE }
}
