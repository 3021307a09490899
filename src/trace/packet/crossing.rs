//! Where rays leave their prisms.

use super::lines::Lines;
use crate::format::records::LANES;
use crate::trace::entries::Entries;
use crate::trace::lanes::Lanes;
use crate::trace::path::BLURRED;
use crate::trace::quick::{DOWN, UP};
use crate::trace::step::Step;

/// Where rays leave their prisms.
pub(super) struct Crossed<L> {
    /// Where that is in no doubt.
    pub(super) known: u32,
    /// Through a side, which part of it is not looked at.
    pub(super) through_side: u32,
    /// The sides of the line that the edge's ends are on.
    pub(super) right: L,
    pub(super) left: L,
    pub(super) height: L,
    /// Farther than that from `height` one aside is not.
    pub(super) blur: L,
    /// The number of the edge, as bits; [`DOWN`] or [`UP`].
    pub(super) edge: L,
    pub(super) t: L,
    /// More than `t` is off.
    pub(super) off: L,
}

/// How many times as much as rounding moves a line it may be off: `quick`, which takes that once, is then in no doubt either.
pub(super) const SURE: f32 = 4.0;

/// The corners of rays' prisms.
pub(super) trait Corners<L> {
    fn at(&self, corner: usize) -> (L, L);
}

/// All in one.
pub(super) struct One<'a>(pub(super) &'a Step);

impl<L: Lanes> Corners<L> for One<'_> {
    #[inline(always)]
    fn at(&self, corner: usize) -> (L, L) {
        (L::splat(self.0.x[corner % LANES]), L::splat(self.0.y[corner % LANES]))
    }
}

/// Each in its own.
pub(super) struct Own<L> {
    pub(super) x: [L; LANES],
    pub(super) y: [L; LANES],
}

impl<L: Lanes> Corners<L> for Own<L> {
    #[inline(always)]
    fn at(&self, corner: usize) -> (L, L) {
        (self.x[corner % LANES], self.y[corner % LANES])
    }
}

impl<L: Entries> Lines<L> {
    /// No corner may be nearer to a line than this.
    #[inline(always)]
    pub(super) fn margin(&self) -> L {
        L::splat(BLURRED as f32 + SURE * self.rounding)
    }

    /// The same times the direction's length in the plan.
    #[inline(always)]
    pub(super) fn least(&self) -> L {
        self.margin().mul(self.flat)
    }

    /// Where the rays leave prisms whose footprints have up to `count` corners; floors and ceilings matter of those that are under way.
    #[inline(always)]
    pub(super) fn cross<const FIRST: bool>(
        &self,
        count: usize,
        corners: &impl Corners<L>,
        [floor, ceiling]: [L; 2],
        under_way: u32,
    ) -> Crossed<L> {
        let zero = L::splat(0.0);
        let [fx, fy, fz] = self.from;
        let [ax, ay, az] = self.along;
        let rounding = L::splat(self.rounding);
        let margin = self.margin();
        let (x, y) = corners.at(0);
        let (mut dx, mut dy) = (x.sub(fx), y.sub(fy));
        // Rounded as by `quick`, so that both look at the same edge.
        let mut side = ax.mul(dy).sub(ay.mul(dx));
        let mut is_left = zero.le(side);
        let mut inside = is_left;
        if FIRST {
            inside = L::and(floor.add(rounding).le(fz), fz.le(ceiling.sub(rounding)));
        }
        let (mut edge, mut right, mut left) = (zero, zero, zero);
        let (mut from_x, mut from_y, mut to_x, mut to_y) = (zero, zero, zero, zero);
        for k in 0..count {
            let (x, y) = corners.at(k + 1);
            let (next_x, next_y) = (x.sub(fx), y.sub(fy));
            let next = ax.mul(next_y).sub(ay.mul(next_x));
            let is_next_left = zero.le(next);
            let here = L::and_not(is_left, is_next_left);
            edge = L::select(here, L::splat(f32::from_bits(k as u32)), edge);
            (from_x, from_y) = (L::select(here, dx, from_x), L::select(here, dy, from_y));
            (to_x, to_y) = (L::select(here, next_x, to_x), L::select(here, next_y, to_y));
            (right, left) = (L::select(here, side, right), L::select(here, next, left));
            if FIRST {
                let (ex, ey) = (next_x.sub(dx), next_y.sub(dy));
                let inward = ey.mul_sub(dx, ex.mul(dy));
                inside = L::and(inside, rounding.mul(ex.abs().add(ey.abs())).le(inward));
            }
            (dx, dy, side, is_left) = (next_x, next_y, next, is_next_left);
        }
        let (ex, ey) = (to_x.sub(from_x), to_y.sub(from_y));
        // Not the difference of the ends' sides, which are rounded as far as they are from the ray's origin.
        let per = L::splat(1.0).div(ax.mul_sub(ey, ay.mul(ex)));
        let mut t = from_x.mul_sub(ey, from_y.mul(ex)).mul(per);
        let slant = ex.abs().add(ey.abs()).mul(per);
        let height = t.mul_add(az, fz);
        let blur = margin.mul(slant.mul_add(az.abs(), L::splat(2.0)));
        let mut ahead = zero.le(t);
        if FIRST {
            ahead = L::and(ahead, inside);
        }
        let within = L::and(floor.add(blur).le(height), height.le(ceiling.sub(blur)));
        let least = self.least();
        let clear = L::and(least.le(zero.sub(right)), least.le(left));
        let within = L::and(within, ahead);
        let through_side = L::bits(within);
        let mut known = L::bits(L::and(within, clear));
        let mut off = rounding.mul(slant.add(L::splat(2.0)));
        let (down, up) = (height.le(floor.sub(blur)), ceiling.add(blur).le(height));
        let (down, up) = (L::and(az.le(zero), down), L::and(zero.le(az), up));
        let vertical = L::and(L::or(down, up), ahead);
        if L::bits(vertical) & under_way != 0 {
            let plane = L::select(down, floor, ceiling);
            let steeply = plane.sub(fz).mul(self.steep);
            let (px, py) = (steeply.mul(ax), steeply.mul(ay));
            // The same as there, of how much rounding moves the place.
            let tilt = self.tilt;
            let margin = L::splat(SURE * self.rounding).mul_add(tilt, L::splat(1.5 * BLURRED as f32));
            let mut inside = vertical;
            let (x, y) = corners.at(0);
            let (mut dx, mut dy) = (x.sub(fx).sub(px), y.sub(fy).sub(py));
            for k in 0..count {
                let (x, y) = corners.at(k + 1);
                let (next_x, next_y) = (x.sub(fx).sub(px), y.sub(fy).sub(py));
                let (ex, ey) = (next_x.sub(dx), next_y.sub(dy));
                let inward = ey.mul_sub(dx, ex.mul(dy));
                inside = L::and(inside, margin.mul(ex.abs().add(ey.abs())).le(inward));
                (dx, dy) = (next_x, next_y);
            }
            known |= L::bits(inside);
            let floor = L::splat(f32::from_bits(DOWN as u32));
            let ceiling = L::splat(f32::from_bits(UP as u32));
            edge = L::select(vertical, L::select(down, floor, ceiling), edge);
            t = L::select(vertical, steeply, t);
            off = L::select(vertical, rounding.mul(tilt), off);
        }
        Crossed { known, through_side, right, left, height, blur, edge, t, off }
    }
}
