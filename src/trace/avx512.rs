//! Eight f32 in a register of which AVX-512 has masks, eight f64 in one, and the kernels compiled for them.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256, __m512d, __mmask8, _CMP_LE_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps,
    _mm256_castps_si256, _mm256_cmp_ps_mask, _mm256_cmpneq_epi32_mask, _mm256_div_ps, _mm256_fmadd_ps,
    _mm256_fmsub_ps, _mm256_loadu_pd, _mm256_loadu_ps, _mm256_mask_blend_ps, _mm256_max_ps, _mm256_min_ps,
    _mm256_mul_ps, _mm256_permutevar8x32_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32,
    _mm256_storeu_ps, _mm256_sub_ps, _mm256_xor_ps, _mm512_abs_pd, _mm512_add_pd, _mm512_castpd256_pd512,
    _mm512_cmp_pd_mask, _mm512_cvtpd_ps, _mm512_div_pd, _mm512_insertf64x4, _mm512_loadu_pd,
    _mm512_mask_blend_pd, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd, _mm512_permutex2var_pd,
    _mm512_set1_pd, _mm512_setr_epi64, _mm512_sqrt_pd, _mm512_storeu_pd, _mm512_sub_pd, _mm512_unpackhi_pd,
    _mm512_unpacklo_pd,
};

use super::avx2;
use super::entries::entries;
use super::lanes::{Lanes, Wide};
use crate::format::records::LANES;

/// Eight f32 in a register. Private to this module and used only inside the functions that `entries` compiles for it, so that it
/// exists only where the CPU has what [`is_available`] asks for: that is the SAFETY of every intrinsic here.
#[derive(Clone, Copy)]
struct Avx512(__m256);

/// Eight f64 in a register. As [`Avx512`], which is the SAFETY of every intrinsic here too.
#[derive(Clone, Copy)]
struct Avx512Wide(__m512d);

impl Wide for Avx512Wide {
    #[inline(always)]
    fn splat(x: f64) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_set1_pd(x) })
    }
    #[inline(always)]
    fn load(from: &[f64; LANES]) -> Self {
        // SAFETY: see `Avx512Wide`; the array holds the eight that are read, and no alignment is needed.
        Avx512Wide(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see `Avx512Wide`; the array has room for the eight, and no alignment is needed.
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_add_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_sub_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_mul_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_div_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        Avx512Wide(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> u32 {
        // SAFETY: see `Avx512Wide`.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0) }.into()
    }
    #[inline(always)]
    fn le_select(self, other: Self, one: Self, another: Self) -> Self {
        // SAFETY: see `Avx512Wide`.
        unsafe {
            let mask = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(self.0, other.0);
            Avx512Wide(_mm512_mask_blend_pd(mask, another.0, one.0))
        }
    }
    #[inline(always)]
    fn columns([r0, r1, r2, r3, r4, r5, r6, r7]: [&[f64; 4]; LANES]) -> [Self; 4] {
        let (a, b, c, d) = (two(r0, r4), two(r1, r5), two(r2, r6), two(r3, r7));
        // SAFETY: see `Avx512Wide`.
        unsafe {
            // Of each pair of rows the even and the odd, then those of two pairs.
            let (ab_even, ab_odd) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
            let (cd_even, cd_odd) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
            let first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
            let second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
            [
                Avx512Wide(_mm512_permutex2var_pd(ab_even, first, cd_even)),
                Avx512Wide(_mm512_permutex2var_pd(ab_odd, first, cd_odd)),
                Avx512Wide(_mm512_permutex2var_pd(ab_even, second, cd_even)),
                Avx512Wide(_mm512_permutex2var_pd(ab_odd, second, cd_odd)),
            ]
        }
    }
}

/// Two rows in a register.
#[inline(always)]
fn two(low: &[f64; 4], high: &[f64; 4]) -> __m512d {
    // SAFETY: see `Avx512Wide`; each array holds the four that are read, and no alignment is needed.
    unsafe {
        let (low, high) = (_mm256_loadu_pd(low.as_ptr()), _mm256_loadu_pd(high.as_ptr()));
        _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high)
    }
}

impl Lanes for Avx512 {
    type Wide = Avx512Wide;
    type Mask = __mmask8;

    #[inline(always)]
    fn narrow(wide: Avx512Wide) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_cvtpd_ps(wide.0) })
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_set1_ps(x) })
    }
    #[inline(always)]
    fn load(from: &[f32; LANES]) -> Self {
        // SAFETY: see `Avx512`; the array holds the eight floats that are read, and no alignment is needed.
        Avx512(unsafe { _mm256_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn store(self) -> [f32; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: see `Avx512`; the array has room for the eight floats, and no alignment is needed.
        unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
        out
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_sub_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_div_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_fmadd_ps(self.0, factor.0, more.0) })
    }
    #[inline(always)]
    fn mul_sub(self, factor: Self, less: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_fmsub_ps(self.0, factor.0, less.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
    }
    #[inline(always)]
    fn rotate(self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_permutevar8x32_ps(self.0, _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0)) })
    }
    #[inline(always)]
    fn flip(self, sign: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_xor_ps(self.0, _mm256_and_ps(_mm256_set1_ps(-0.0), sign.0)) })
    }
    #[inline(always)]
    fn le(self, other: Self) -> __mmask8 {
        // SAFETY: see `Avx512`.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn and(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn or(a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    fn and_not(a: __mmask8, b: __mmask8) -> __mmask8 {
        !a & b
    }
    #[inline(always)]
    fn select(mask: __mmask8, a: Self, b: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm256_mask_blend_ps(mask, b.0, a.0) })
    }
    #[inline(always)]
    fn differs(self, other: f32) -> u32 {
        // SAFETY: see `Avx512`.
        unsafe {
            _mm256_cmpneq_epi32_mask(_mm256_castps_si256(self.0), _mm256_set1_epi32(other.to_bits() as i32))
        }
        .into()
    }
    #[inline(always)]
    fn bits(mask: __mmask8) -> u32 {
        mask.into()
    }
    #[inline(always)]
    fn transpose([r0, r1, r2, r3, r4, r5, r6, r7]: [Self; LANES]) -> [Self; LANES] {
        // SAFETY: see `Avx512`.
        let [c0, c1, c2, c3, c4, c5, c6, c7] =
            unsafe { avx2::transpose([r0.0, r1.0, r2.0, r3.0, r4.0, r5.0, r6.0, r7.0]) };
        [Avx512(c0), Avx512(c1), Avx512(c2), Avx512(c3), Avx512(c4), Avx512(c5), Avx512(c6), Avx512(c7)]
    }
}

/// Whether this CPU can run the kernels of this module.
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx512f")
        && std::arch::is_x86_feature_detected!("avx512vl")
        && std::arch::is_x86_feature_detected!("avx512dq")
        && std::arch::is_x86_feature_detected!("avx512bw")
        && avx2::is_available()
}

entries!(Avx512, "avx2,fma,bmi1,bmi2,popcnt,avx512f,avx512vl,avx512dq");
