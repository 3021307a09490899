//! Which part of an edge, of a floor or of a ceiling rays leave through.

use super::Packet;
use super::crossing::Crossed;
use crate::format::records::{CellRecord, LANES};
use crate::trace::lanes::Lanes;
use crate::trace::path::BLURRED;
use crate::trace::quick::link;
use crate::trace::step::{Part, Step};

/// Whether a link leads to parts of an edge.
#[inline(always)]
pub(super) fn is_split(link: u32) -> bool {
    link & (Step::PLATE | Step::SPLIT) == Step::SPLIT
}

impl<L: Lanes> Packet<'_, '_, L> {
    /// The link of the part of an edge that all rays leave through.
    #[inline(always)]
    pub(super) fn split_together(&self, first: u32, crossed: &Crossed<L>) -> Option<u32> {
        let ([fx, fy, _], [ax, ay, _]) = (self.from, self.along);
        let (zero, all) = (L::splat(0.0), self.under_way);
        let mut rest = self.tables.parts.get(first as usize..)?.iter();
        let mut part = rest.next()?;
        let (mut right, mut left) = (crossed.right, crossed.left);
        while part.last == 0 {
            let next = rest.next()?;
            let (x, y) = (L::splat(next.start[0]), L::splat(next.start[1]));
            let side = ax.mul_sub(y.sub(fy), ay.mul(x.sub(fx)));
            match L::bits(zero.le(side)) & all {
                0 => (part, right) = (next, side),
                bits if bits == all => {
                    left = side;
                    break;
                }
                _ => return None,
            }
        }
        let least = L::splat(BLURRED as f32 + self.rounding).mul(self.flat);
        let mut is_clear = L::and(least.le(zero.sub(right)), least.le(left));
        let mut face = 0;
        for top in part.top {
            let over = crossed.height.sub(L::splat(top));
            is_clear = L::and(is_clear, crossed.blur.le(over.abs()));
            match L::bits(zero.le(over)) & all {
                0 => break,
                bits if bits == all => face += 1,
                _ => return None,
            }
        }
        (L::bits(is_clear) & all == all).then_some(part.link[face])
    }

    /// The part of an edge that a ray leaves through, as `Way::split` has it: where it leads.
    #[inline(always)]
    pub(super) fn split(
        &self,
        lane: usize,
        first: u32,
        [mut right, mut left]: [f32; 2],
        height: f32,
        blur: f32,
    ) -> u32 {
        let (fx, fy) = (self.from[0].store()[lane], self.from[1].store()[lane]);
        let (ax, ay) = (self.along[0].store()[lane], self.along[1].store()[lane]);
        let parts: &[Part] = &self.tables.parts;
        let mut index = first as usize;
        let Some(mut part) = parts.get(index) else { return Step::OTHER };
        while part.last == 0 {
            index += 1;
            let Some(next) = parts.get(index) else { return Step::OTHER };
            let side = ax * (next.start[1] - fy) - ay * (next.start[0] - fx);
            if side >= 0.0 {
                left = side;
                break;
            }
            (part, right) = (next, side);
        }
        let least = (BLURRED as f32 + self.rounding) * (ax.abs() + ay.abs());
        let (over, over_next) = (height - part.top[0], height - part.top[1]);
        if -right >= least && left >= least && over.abs() >= blur && over_next.abs() >= blur {
            part.link[usize::from(over > 0.0) + usize::from(over_next > 0.0)]
        } else {
            Step::OTHER
        }
    }

    /// The link of the part of a floor or a ceiling that all rays pass.
    #[inline(always)]
    pub(super) fn cover_together(&self, cell: u32, is_down: bool, t: L) -> Option<u32> {
        let tables = self.tables;
        let (x, y) = (t.mul_add(self.along[0], self.from[0]), t.mul_add(self.along[1], self.from[1]));
        let lead = self.under_way.trailing_zeros() as usize % LANES;
        let (lead_x, lead_y) = (f64::from(x.store()[lead]), f64::from(y.store()[lead]));
        // Farther than that from the border no other part is near.
        let tilt = self.steep.abs().add(L::splat(2.0));
        let margin = L::splat(1.5 * (BLURRED as f32 + self.rounding)).mul(tilt);
        let record = &tables.cells[cell as usize];
        let first = record.first_cover as usize;
        let (below, above) = (record.below as usize, record.above as usize);
        let covers = if is_down { first..first + below } else { first + below..first + below + above };
        for cover in &tables.covers[covers] {
            let beyond = tables.cells.get(cover.cell as usize)?;
            let [lo, hi] = beyond.bounds;
            let is_near = lead_x >= lo[0] && lead_x <= hi[0] && lead_y >= lo[1] && lead_y <= hi[1];
            if beyond.kind == CellRecord::AROUND {
                return None;
            }
            if !is_near {
                continue;
            }
            let first = beyond.first_side as usize;
            let sides = &tables.sides[first..first + beyond.sides as usize];
            let last = sides.last()?.start;
            let (mut ax, mut ay) = (L::splat(last[0]), L::splat(last[1]));
            let mut inside = self.under_way;
            for side in sides {
                let (bx, by) = (L::splat(side.start[0]), L::splat(side.start[1]));
                let (ex, ey) = (bx.sub(ax), by.sub(ay));
                let inward = ex.mul_sub(y.sub(ay), ey.mul(x.sub(ax)));
                inside &= L::bits(margin.mul(ex.abs().add(ey.abs())).le(inward));
                if inside == 0 {
                    break;
                }
                (ax, ay) = (bx, by);
            }
            if inside == self.under_way {
                return link(tables, cover.cell, cover.source, cover.flags);
            }
            if inside != 0 {
                return None;
            }
        }
        None
    }
}
