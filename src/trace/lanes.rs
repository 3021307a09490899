//! Eight f32 side by side: one trait, so that each kernel is written once for all instruction sets.

use crate::format::records::LANES;

/// Eight f32. Comparisons with NaN are false.
pub(crate) trait Lanes: Copy {
    /// As many f64.
    type Wide: Wide;
    /// Of each lane yes or no; it ends as bits.
    type Mask: Copy;
    /// Rounded.
    fn narrow(wide: Self::Wide) -> Self;
    /// All lanes `x`.
    fn splat(x: f32) -> Self;
    /// The lanes of an array.
    fn load(from: &[f32; LANES]) -> Self;
    /// The lanes as an array.
    fn store(self) -> [f32; LANES];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// `self * factor + more`, rounded once or twice.
    fn mul_add(self, factor: Self, more: Self) -> Self;
    /// `self * factor - less`, rounded once or twice.
    fn mul_sub(self, factor: Self, less: Self) -> Self;
    /// The lesser of each; of a NaN and a number either.
    fn min(self, other: Self) -> Self;
    /// The greater of each; of a NaN and a number either.
    fn max(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// Each lane has what the next one had, the last what the first had.
    fn rotate(self) -> Self;
    /// `self` with its sign flipped where `sign` is negative (or -0).
    fn flip(self, sign: Self) -> Self;
    /// One bit a lane: whether `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// Both masks.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Either mask.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// The second mask where the first is not.
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `a` where the mask is, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Lane i is bit i: whether its bits are not those of `other`.
    fn differs(self, other: f32) -> u32;
    /// Lane i is bit i.
    fn bits(mask: Self::Mask) -> u32;
    /// Lane j of the i-th has what lane i of the j-th had.
    fn transpose(rows: [Self; LANES]) -> [Self; LANES];
}

/// Eight f64 side by side, as [`Lanes`] are f32: every operation is rounded as that of two numbers is.
pub(crate) trait Wide: Copy {
    /// All lanes `x`.
    fn splat(x: f64) -> Self;
    /// The lanes of an array.
    fn load(from: &[f64; LANES]) -> Self;
    /// The lanes as an array.
    fn store(self) -> [f64; LANES];
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// `other` where it is less or a lane is NaN.
    fn min(self, other: Self) -> Self;
    /// `other` where it is greater or a lane is NaN.
    fn max(self, other: Self) -> Self;
    /// Lane i is bit i: whether `self <= other`.
    fn le(self, other: Self) -> u32;
    /// Where `self <= other` one, else another.
    fn le_select(self, other: Self, one: Self, another: Self) -> Self;
    /// The i-th has of each row what is at i.
    fn columns(rows: [&[f64; 4]; LANES]) -> [Self; 4];
}

/// Any machine.
#[derive(Clone, Copy)]
pub(crate) struct Portable([f32; LANES]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut out = self.0;
        for (x, y) in out.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        Portable(out)
    }
}

/// Any machine.
#[derive(Clone, Copy)]
pub(crate) struct PortableWide([f64; LANES]);

impl PortableWide {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0;
        for (x, y) in out.iter_mut().zip(other.0) {
            *x = f(*x, y);
        }
        PortableWide(out)
    }
}

impl Wide for PortableWide {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        PortableWide([x; LANES])
    }
    #[inline(always)]
    fn load(from: &[f64; LANES]) -> Self {
        PortableWide(*from)
    }
    #[inline(always)]
    fn store(self) -> [f64; LANES] {
        self.0
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.zip(self, |a, _| a.abs())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        let mut bits = 0;
        for lane in 0..LANES {
            bits |= u32::from(self.0[lane] <= other.0[lane]) << lane;
        }
        bits
    }
    #[inline(always)]
    fn le_select(self, other: Self, one: Self, another: Self) -> Self {
        let mut out = another;
        for lane in 0..LANES {
            if self.0[lane] <= other.0[lane] {
                out.0[lane] = one.0[lane];
            }
        }
        out
    }
    #[inline(always)]
    fn columns(rows: [&[f64; 4]; LANES]) -> [Self; 4] {
        let mut out = [PortableWide([0.0; LANES]); 4];
        for (lane, row) in rows.iter().enumerate() {
            for (column, x) in out.iter_mut().zip(row.iter()) {
                column.0[lane] = *x;
            }
        }
        out
    }
}

impl Lanes for Portable {
    type Wide = PortableWide;
    /// Lanes of all ones or all zeros.
    type Mask = Portable;

    #[inline(always)]
    fn narrow(wide: PortableWide) -> Self {
        let mut out = [0.0; LANES];
        for (to, x) in out.iter_mut().zip(wide.0) {
            *to = x as f32;
        }
        Portable(out)
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Portable([x; LANES])
    }
    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        Portable(*from)
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        self.0
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        self.mul(factor).add(more)
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, less: Self) -> Self {
        self.mul(factor).sub(less)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.zip(self, |a, _| a.abs())
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        let [first, rest @ ..] = self.0;
        let mut out = [first; LANES];
        out[..LANES - 1].copy_from_slice(&rest);
        Portable(out)
    }
    #[inline(always)]
    fn flip(self, sign: Self) -> Self {
        self.zip(sign, |a, s| f32::from_bits(a.to_bits() ^ (s.to_bits() & 0x8000_0000)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.zip(other, |a, b| f32::from_bits(if a <= b { u32::MAX } else { 0 }))
    }
    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a.zip(b, |a, b| f32::from_bits(a.to_bits() & b.to_bits()))
    }
    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a.zip(b, |a, b| f32::from_bits(a.to_bits() | b.to_bits()))
    }
    #[inline(always)]
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a.zip(b, |a, b| f32::from_bits(!a.to_bits() & b.to_bits()))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        let mut out = b;
        for lane in 0..LANES {
            if mask.0[lane].to_bits() != 0 {
                out.0[lane] = a.0[lane];
            }
        }
        out
    }
    #[inline(always)]
    fn differs(self, other: f32) -> u32 {
        let mut bits = 0;
        for lane in 0..LANES {
            bits |= u32::from(self.0[lane].to_bits() != other.to_bits()) << lane;
        }
        bits
    }
    #[inline(always)]
    fn transpose(rows: [Self; LANES]) -> [Self; LANES] {
        let mut out = rows;
        for (row, from) in rows.iter().enumerate() {
            for (lane, to) in out.iter_mut().enumerate() {
                to.0[row] = from.0[lane];
            }
        }
        out
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        let mut bits = 0;
        for lane in 0..LANES {
            bits |= (mask.0[lane].to_bits() >> 31) << lane;
        }
        bits
    }
}
