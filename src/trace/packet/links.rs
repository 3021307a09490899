//! Which part of an edge, of a floor or of a ceiling rays leave through.

use super::crossing::{Crossed, SURE};
use super::lines::Lines;
use crate::format::Views;
use crate::format::records::{CellRecord, LANES};
use crate::trace::entries::Entries;
use crate::trace::path::BLURRED;
use crate::trace::step::link;

impl<L: Entries> Lines<L> {
    /// The link of the part of a split edge that all rays leave through.
    #[inline(always)]
    pub(super) fn split_together(
        &self,
        tables: &Views,
        all: u32,
        split: u32,
        crossed: &Crossed<L>,
    ) -> Option<u32> {
        let zero = L::splat(0.0);
        let mut splits = tables.splits.get(split as usize..)?.iter();
        let (right, left, least) = (crossed.right, crossed.left, self.least());
        let across = left.sub(right);
        let mut is_clear = L::and(least.le(zero.sub(right)), least.le(left));
        let part = 'part: loop {
            let split = splits.next()?;
            for (passed, start) in (0..).zip(split.starts) {
                let side = across.mul_add(L::splat(start), right);
                is_clear = L::and(is_clear, least.le(side.abs()));
                match L::bits(zero.le(side)) & all {
                    0 => {}
                    bits if bits == all => break 'part split.first + passed,
                    _ => return None,
                }
            }
            if split.more == 0 {
                break split.first + LANES as u32;
            }
        };
        let part = tables.parts.get(part as usize)?;
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

    /// The link of the part of a floor or a ceiling that all rays pass.
    #[inline(always)]
    pub(super) fn cover_together(
        &self,
        tables: &Views,
        all: u32,
        cell: u32,
        is_down: bool,
        t: L,
    ) -> Option<u32> {
        let (x, y) = (t.mul_add(self.along[0], self.from[0]), t.mul_add(self.along[1], self.from[1]));
        let lead = all.trailing_zeros() as usize % LANES;
        let (lead_x, lead_y) = (f64::from(x.store()[lead]), f64::from(y.store()[lead]));
        // Farther than that from the border no other part is near.
        let margin = L::splat(1.5 * (BLURRED as f32 + SURE * self.rounding)).mul(self.tilt);
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
            let mut inside = all;
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
            if inside == all {
                return Some(link(&tables.cells, cover.cell, cover.source, cover.flags));
            }
            if inside != 0 {
                return None;
            }
        }
        None
    }
}
