//! The lines of eight rays in f32.

use super::crossing::Crossed;
use super::eight::Eight;
use crate::format::Views;
use crate::format::records::LANES;
use crate::trace::entries::Entries;
use crate::trace::quick::{DOWN, STEEPEST, is_split};
use crate::trace::step::Step;

/// Lines along the lattice's axes, from its origin.
#[derive(Clone, Copy)]
pub(super) struct Lines<L> {
    pub(super) from: [L; 3],
    pub(super) along: [L; 3],
    /// The direction's length in the plan.
    pub(super) flat: L,
    /// 1 by the third component of `along`.
    pub(super) steep: L,
    /// How far a place in a level plane is off, by how far the line is, at most.
    pub(super) tilt: L,
    /// More than rounding moves a line, metres.
    pub(super) rounding: f32,
}

impl<L: Entries> Lines<L> {
    /// Those of rays; the steepest of these are not under way then.
    #[inline(always)]
    pub(super) fn new(eight: &mut Eight<'_, L>) -> Self {
        let [place, heading] = eight.turned();
        let from = [L::narrow(place[0]), L::narrow(place[1]), L::narrow(place[2])];
        let along = [L::narrow(heading[0]), L::narrow(heading[1]), L::narrow(heading[2])];
        let lines = Lines::through(from, along, eight.tables.airgrid[0].rounding);
        eight.under_way &= L::bits(L::splat(1.01 * STEEPEST as f32).le(lines.flat));
        lines
    }

    /// Those through points, in directions.
    #[inline(always)]
    pub(super) fn through(from: [L; 3], along: [L; 3], rounding: f32) -> Self {
        let flat = along[0].abs().add(along[1].abs());
        let steep = L::splat(1.0).div(along[2]);
        Lines { from, along, flat, steep, tilt: steep.abs().add(L::splat(2.0)), rounding }
    }

    /// The edge, [`DOWN`] or [`UP`], that all of some rays leave a simple prism by, and where it leads; `None` in doubt, and where none of
    /// that is the same for all.
    #[inline(always)]
    pub(super) fn way_out(
        &self,
        tables: &Views,
        all: u32,
        step: &Step,
        cell: u32,
        crossed: &Crossed<L>,
    ) -> Option<(usize, u32)> {
        let edges = crossed.edge;
        let edge = edges.store()[all.trailing_zeros() as usize % LANES];
        if all & !(crossed.known | crossed.through_side) != 0 || edges.differs(edge) & all != 0 {
            return None;
        }
        let edge = edge.to_bits() as usize;
        let mut link = *step.links.get(edge)?;
        if is_split(link) && edge < LANES {
            link = self.split_together(tables, all, link & !Step::SPLIT, crossed)?;
        } else if all & !crossed.known != 0 {
            return None;
        } else if edge >= LANES && (link == Step::PARTS || is_split(link)) {
            link = self.cover_together(tables, all, cell, edge == DOWN, crossed.t)?;
        }
        (link < Step::ROUGH).then_some((edge, link))
    }
}
