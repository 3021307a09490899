//! Eight f32 in an AVX2 register, and the kernels compiled for it.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256, _CMP_LE_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_andnot_ps, _mm256_cmp_ps, _mm256_div_ps,
    _mm256_fmadd_ps, _mm256_fmsub_ps, _mm256_loadu_ps, _mm256_max_ps, _mm256_min_ps, _mm256_movemask_ps,
    _mm256_mul_ps, _mm256_or_ps, _mm256_permutevar8x32_ps, _mm256_set1_ps, _mm256_setr_epi32,
    _mm256_storeu_ps, _mm256_sub_ps, _mm256_xor_ps,
};

use super::kernel::Probe;
use super::lanes::{Lanes, Mask};
use super::quick::{self, Quick};
use super::ray::Ray;
use super::walk::{Found, Query, Walk, walk};
use crate::format::Views;
use crate::format::records::LANES;

/// Eight f32 in a register. Private to this module and used only inside `walk_avx2` and `occluded_avx2`, so that it
/// exists only where the CPU has AVX2 and FMA: that is the SAFETY of every intrinsic here.
#[derive(Clone, Copy)]
struct Avx2(__m256);

impl Lanes for Avx2 {
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
    fn le(self, other: Self) -> Mask<Self> {
        // SAFETY: see `Avx2`.
        Mask(Avx2(unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }))
    }
    #[inline(always)]
    fn and(a: Mask<Self>, b: Mask<Self>) -> Mask<Self> {
        // SAFETY: see `Avx2`.
        Mask(Avx2(unsafe { _mm256_and_ps(a.0.0, b.0.0) }))
    }
    #[inline(always)]
    fn or(a: Mask<Self>, b: Mask<Self>) -> Mask<Self> {
        // SAFETY: see `Avx2`.
        Mask(Avx2(unsafe { _mm256_or_ps(a.0.0, b.0.0) }))
    }
    #[inline(always)]
    fn bits(mask: Mask<Self>) -> u32 {
        // SAFETY: see `Avx2`.
        unsafe { _mm256_movemask_ps(mask.0.0) as u32 }
    }
}

/// Whether this CPU can run the kernels of this module.
pub(super) fn is_available() -> bool {
    std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma")
}

#[target_feature(enable = "avx2,fma")]
fn walk_avx2<const ANY: bool>(tables: &Walk<'_>, query: &Query) -> Found {
    walk::<Avx2, ANY>(tables, query, &mut ())
}

#[target_feature(enable = "avx2,fma")]
fn quick_avx2<P: Probe>(tables: &Views, ray: &Ray, hint: u32, probe: &mut P) -> Option<Quick> {
    quick::quick::<Avx2, P>(tables, ray, hint, probe)
}

/// What a ray meets that is in no doubt.
///
/// # Panics
/// If the CPU lacks AVX2 or FMA (debug builds).
#[inline]
pub(super) fn quick<P: Probe>(tables: &Views, ray: &Ray, hint: u32, probe: &mut P) -> Option<Quick> {
    debug_assert!(is_available());
    // SAFETY: as in `run`.
    unsafe { quick_avx2(tables, ray, hint, probe) }
}

/// The nearest hit, or with `ANY` some hit.
///
/// # Panics
/// If the CPU lacks AVX2 or FMA (debug builds).
#[inline]
pub(super) fn run<const ANY: bool>(tables: &Walk<'_>, query: &Query) -> Found {
    debug_assert!(is_available());
    // SAFETY: a `Kernel::Avx2` is made by `Kernel::available` and `Kernel::best` only, after `is_available` said yes.
    unsafe { walk_avx2::<ANY>(tables, query) }
}
