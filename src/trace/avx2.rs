//! Eight f32 in an AVX2 register, and the kernels compiled for it.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256, __m256d, _CMP_LE_OQ, _MM_HINT_T0, _mm_prefetch, _mm256_add_pd, _mm256_add_ps, _mm256_and_ps,
    _mm256_andnot_pd, _mm256_andnot_ps, _mm256_blendv_pd, _mm256_blendv_ps, _mm256_castps_si256,
    _mm256_castsi256_ps, _mm256_cmp_pd, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtpd_ps, _mm256_div_pd,
    _mm256_div_ps, _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_loadu_pd, _mm256_loadu_ps, _mm256_max_pd,
    _mm256_max_ps, _mm256_min_pd, _mm256_min_ps, _mm256_movemask_pd, _mm256_movemask_ps, _mm256_mul_pd,
    _mm256_mul_ps, _mm256_or_ps, _mm256_permute2f128_pd, _mm256_permute2f128_ps, _mm256_permutevar8x32_ps,
    _mm256_set_m128, _mm256_set1_epi32, _mm256_set1_pd, _mm256_set1_ps, _mm256_setr_epi32, _mm256_shuffle_ps,
    _mm256_sqrt_pd, _mm256_storeu_pd, _mm256_storeu_ps, _mm256_sub_pd, _mm256_sub_ps, _mm256_unpackhi_pd,
    _mm256_unpackhi_ps, _mm256_unpacklo_pd, _mm256_unpacklo_ps, _mm256_xor_ps,
};

use super::entries::entries;
use super::lanes::{Lanes, Wide};
use super::packet::{self, Answers};
use crate::format::records::LANES;

/// Eight f32 in a register. Private to this module and used only inside the functions that `entries` compiles for it, so that
/// it exists only where the CPU has AVX2 and FMA: that is the SAFETY of every intrinsic here.
#[derive(Clone, Copy)]
struct Avx2(__m256);

/// Eight f64 in two registers. As [`Avx2`], which is the SAFETY of every intrinsic here too.
#[derive(Clone, Copy)]
struct Avx2Wide(__m256d, __m256d);

impl Wide for Avx2Wide {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see `Avx2Wide`.
        let x = unsafe { _mm256_set1_pd(x) };
        Avx2Wide(x, x)
    }
    #[inline(always)]
    fn load(from: &[f64; LANES]) -> Self {
        let (first, second) = from.split_at(LANES / 2);
        // SAFETY: see `Avx2Wide`; each half holds the four that are read, and no alignment is needed.
        unsafe { Avx2Wide(_mm256_loadu_pd(first.as_ptr()), _mm256_loadu_pd(second.as_ptr())) }
    }
    #[inline(always)]
    fn store(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see `Avx2Wide`; the array has room for the eight, and no alignment is needed.
        unsafe {
            _mm256_storeu_pd(out.as_mut_ptr(), self.0);
            _mm256_storeu_pd(out.as_mut_ptr().add(LANES / 2), self.1);
        }
        out
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_add_pd(self.0, other.0), _mm256_add_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_sub_pd(self.0, other.0), _mm256_sub_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_mul_pd(self.0, other.0), _mm256_mul_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_div_pd(self.0, other.0), _mm256_div_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_sqrt_pd(self.0), _mm256_sqrt_pd(self.1)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            Avx2Wide(_mm256_andnot_pd(sign, self.0), _mm256_andnot_pd(sign, self.1))
        }
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_min_pd(self.0, other.0), _mm256_min_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe { Avx2Wide(_mm256_max_pd(self.0, other.0), _mm256_max_pd(self.1, other.1)) }
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        // SAFETY: see `Avx2Wide`.
        unsafe {
            let first = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0));
            let second = _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(self.1, other.1));
            (first | second << (LANES / 2)) as u32
        }
    }
    #[inline(always)]
    fn le_select(self, other: Self, one: Self, another: Self) -> Self {
        // SAFETY: see `Avx2Wide`.
        unsafe {
            let first = _mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0);
            let second = _mm256_cmp_pd::<_CMP_LE_OQ>(self.1, other.1);
            Avx2Wide(_mm256_blendv_pd(another.0, one.0, first), _mm256_blendv_pd(another.1, one.1, second))
        }
    }
    #[inline(always)]
    fn columns([r0, r1, r2, r3, r4, r5, r6, r7]: [&[f64; 4]; LANES]) -> [Self; 4] {
        let [a0, a1, a2, a3] = columns([r0, r1, r2, r3]);
        let [b0, b1, b2, b3] = columns([r4, r5, r6, r7]);
        [Avx2Wide(a0, b0), Avx2Wide(a1, b1), Avx2Wide(a2, b2), Avx2Wide(a3, b3)]
    }
}

/// Four rows, their columns.
#[inline(always)]
fn columns([r0, r1, r2, r3]: [&[f64; 4]; 4]) -> [__m256d; 4] {
    // SAFETY: see `Avx2Wide`; each array holds the four that are read, and no alignment is needed.
    unsafe {
        let (a, b) = (_mm256_loadu_pd(r0.as_ptr()), _mm256_loadu_pd(r1.as_ptr()));
        let (c, d) = (_mm256_loadu_pd(r2.as_ptr()), _mm256_loadu_pd(r3.as_ptr()));
        // Of each pair of rows the even and the odd, then the halves.
        let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab_even, cd_even),
            _mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd),
            _mm256_permute2f128_pd::<0x31>(ab_even, cd_even),
            _mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd),
        ]
    }
}

/// Eight rows, their columns.
///
/// # Safety
/// The CPU must have AVX.
#[inline(always)]
pub(super) unsafe fn transpose([r0, r1, r2, r3, r4, r5, r6, r7]: [__m256; LANES]) -> [__m256; LANES] {
    // SAFETY: the caller's.
    unsafe {
        // Pairs of lanes of two rows, then fours of four, then eights of all.
        let low = |a: __m256, b: __m256| _mm256_unpacklo_ps(a, b);
        let high = |a: __m256, b: __m256| _mm256_unpackhi_ps(a, b);
        let (a0, a1) = (low(r0, r1), high(r0, r1));
        let (a2, a3) = (low(r2, r3), high(r2, r3));
        let (a4, a5) = (low(r4, r5), high(r4, r5));
        let (a6, a7) = (low(r6, r7), high(r6, r7));
        let first = |a: __m256, b: __m256| _mm256_shuffle_ps::<0x44>(a, b);
        let last = |a: __m256, b: __m256| _mm256_shuffle_ps::<0xee>(a, b);
        let (b0, b1, b2, b3) = (first(a0, a2), last(a0, a2), first(a1, a3), last(a1, a3));
        let (b4, b5, b6, b7) = (first(a4, a6), last(a4, a6), first(a5, a7), last(a5, a7));
        let lower = |a: __m256, b: __m256| _mm256_permute2f128_ps::<0x20>(a, b);
        let upper = |a: __m256, b: __m256| _mm256_permute2f128_ps::<0x31>(a, b);
        [
            lower(b0, b4),
            lower(b1, b5),
            lower(b2, b6),
            lower(b3, b7),
            upper(b0, b4),
            upper(b1, b5),
            upper(b2, b6),
            upper(b3, b7),
        ]
    }
}

impl Lanes for Avx2 {
    type Wide = Avx2Wide;
    /// Lanes of all ones or all zeros.
    type Mask = Avx2;

    #[inline(always)]
    fn narrow(wide: Avx2Wide) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_set_m128(_mm256_cvtpd_ps(wide.1), _mm256_cvtpd_ps(wide.0)) })
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        // SAFETY: see `Avx2`; the array holds the eight floats that are read, and no alignment is needed.
        Avx2(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see `Avx2`; the array has room for the eight floats, and no alignment is needed.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_fmadd_ps(self.0, factor.0, more.0) })
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, less: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_fmsub_ps(self.0, factor.0, less.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_permutevar8x32_ps(self.0, _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0)) })
    }
    #[inline(always)]
    fn flip(self, sign: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), sign.0)) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) })
    }
    #[inline(always)]
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_and_ps(a.0, b.0) })
    }
    #[inline(always)]
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_or_ps(a.0, b.0) })
    }
    #[inline(always)]
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_andnot_ps(a.0, b.0) })
    }
    #[inline(always)]
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(unsafe { _mm256_blendv_ps(b.0, a.0, mask.0) })
    }
    #[inline(always)]
    fn differs(self, other: f32) -> u32 {
        // SAFETY: see `Avx2`.
        unsafe {
            let (one, other) = (_mm256_castps_si256(self.0), _mm256_set1_epi32(other.to_bits() as i32));
            let same = _mm256_castsi256_ps(_mm256_cmpeq_epi32(one, other));
            !_mm256_movemask_ps(same) as u32 & ((1 << LANES) - 1)
        }
    }
    #[inline(always)]
    fn transpose([r0, r1, r2, r3, r4, r5, r6, r7]: [Self; LANES]) -> [Self; LANES] {
        // SAFETY: see `Avx2`.
        let [c0, c1, c2, c3, c4, c5, c6, c7] =
            unsafe { transpose([r0.0, r1.0, r2.0, r3.0, r4.0, r5.0, r6.0, r7.0]) };
        [Avx2(c0), Avx2(c1), Avx2(c2), Avx2(c3), Avx2(c4), Avx2(c5), Avx2(c6), Avx2(c7)]
    }
    #[inline(always)]
    fn bits(mask: Self::Mask) -> u32 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_movemask_ps(mask.0) as u32 }
    }
}

/// Whether this CPU can run the kernels of this module. All that have AVX2 have the others, so far.
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx2")
        && std::arch::is_x86_feature_detected!("fma")
        && std::arch::is_x86_feature_detected!("bmi1")
        && std::arch::is_x86_feature_detected!("bmi2")
        && std::arch::is_x86_feature_detected!("popcnt")
}

entries!(Avx2, "avx2,fma,bmi1,bmi2,popcnt");

#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn packets_here(
    ask: Ask,
    tables: &Views,
    rays: &[Ray],
    cells: &[u32],
    moved: u64,
    scattered: bool,
    answers: &mut Answers,
) {
    packet::packets::<Avx2>(ask, tables, rays, cells, moved, scattered, answers)
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
fn bundle_here(ask: Ask, tables: &Views, rays: &[Ray], cells: &mut [u32], answers: &mut Answers) -> u64 {
    packet::bundle::<Avx2>(ask, tables, rays, cells, answers)
}

/// Has the processor fetch what is looked at soon, where it cannot foresee that.
#[inline(always)]
pub(crate) fn fetch<T>(of: &T) {
    /// A line of the cache, bytes.
    const LINE: usize = 64;
    for at in (0..size_of::<T>()).step_by(LINE) {
        // SAFETY: it is part of every x86-64, and reads nothing; all of it is within `of`.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(of).cast::<i8>().add(at)) };
    }
}

/// What rays of one origin meet together, see [`packet::bundle`].
///
/// # Panics
/// If the CPU lacks the instructions (debug builds).
#[inline]
pub(super) fn bundle(
    ask: Ask,
    tables: &Views,
    rays: &[Ray],
    cells: &mut [u32],
    answers: &mut Answers,
) -> u64 {
    debug_assert!(is_available());
    // SAFETY: as in `run`.
    unsafe { bundle_here(ask, tables, rays, cells, answers) }
}

/// What rays meet that is in no doubt.
///
/// # Panics
/// If the CPU lacks the instructions (debug builds).
#[inline]
pub(super) fn packets(
    ask: Ask,
    tables: &Views,
    rays: &[Ray],
    cells: &[u32],
    moved: u64,
    scattered: bool,
    answers: &mut Answers,
) {
    debug_assert!(is_available());
    // SAFETY: as in `run`.
    unsafe { packets_here(ask, tables, rays, cells, moved, scattered, answers) }
}
