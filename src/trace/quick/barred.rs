//! Whether anything is in a ray's way: whatever it is.
//!
//! Walls first. A ray that comes to a face of matter within its limit is barred, whatever stands before that: so it is taken through its cells
//! without a look at what stands in them, and detail is asked about only where it comes to none. Most pairs of points in a building are parted by a
//! wall, and of those nothing else is ever looked at.

use super::{Exit, FROM_SURFACE, Way};
use crate::format::Views;
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::kernel::Ask;
use crate::trace::ray::Ray;
use crate::trace::step::Step;
use crate::trace::walk::Surface;

/// A ray is taken through no more cells without a look at their detail: in a long row of rooms that of the first could end its way.
pub(in crate::trace) const CELLS: usize = 8;

/// Whether anything is in the way of a ray that starts in the air of a cell. `None` where there is doubt.
#[inline(always)]
pub(in crate::trace) fn barred<L: Entries>(tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
    let way = Way::new(tables, ray)?;
    let exit = way.leave::<L>(cell, true);
    if way.is_walled::<L>(cell, exit, 0.0) {
        return Some(true);
    }
    let quick = L::onward(Ask::Any, tables, ray, cell, exit, &mut ())?;
    Some(quick.found.triangle != NONE)
}

/// The same of a ray that starts on the surface of a cell, or of what stands in it.
#[inline(always)]
pub(in crate::trace) fn barred_from<L: Entries>(
    tables: &Views,
    ray: &Ray,
    cell: u32,
    surface: &Surface,
) -> Option<bool> {
    let way = Way::from_surface(tables, ray, surface)?;
    let exit = way.leave_surface::<L>(cell)?;
    if way.is_walled::<L>(cell, exit, FROM_SURFACE) {
        return Some(true);
    }
    let quick = L::onward_from(Ask::Any, tables, ray, surface, cell, exit, &mut ())?;
    way.clear(quick).map(|quick| quick.found.triangle != NONE)
}

/// Whether a ray that leaves a cell at `exit` is barred by a wall, as far as there is no doubt.
#[inline(always)]
pub(in crate::trace) fn is_walled<L: Entries>(tables: &Views, ray: &Ray, cell: u32, exit: Exit) -> bool {
    Way::new(tables, ray).is_some_and(|way| way.is_walled::<L>(cell, exit, 0.0))
}

impl Way<'_> {
    /// Whether the ray, which leaves its cell at `exit`, comes to matter within its limit, and no nearer than `least`; where there is doubt
    /// it says no.
    #[inline(always)]
    fn is_walled<L: Entries>(&self, mut cell: u32, mut exit: Exit, least: f64) -> bool {
        for _ in 0..CELLS {
            if exit.link >= Step::PLATE {
                // Of more than a plane only where it is within the limit for sure.
                if exit.link >= Step::ROUGH && exit.at_most() > self.limit {
                    return false;
                }
                let end = self.end(&exit, cell, &mut ());
                return end.is_some_and(|(end, _)| end.t >= least && end.t <= self.limit);
            }
            // What is about there is for others.
            if exit.at_most() > self.limit {
                return false;
            }
            cell = exit.link;
            exit = self.leave::<L>(cell, false);
        }
        false
    }
}
