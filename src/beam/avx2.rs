//! Sixteen pixels in two registers, and the loops compiled for AVX2.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m128i, __m256, __m256d, __m256i, _CMP_EQ_OQ, _CMP_GT_OQ, _mm_castsi128_ps, _mm_cmplt_epi32,
    _mm_loadu_si128, _mm_max_epi32, _mm_min_epi32, _mm_movemask_ps, _mm_storeu_si128, _mm256_add_pd,
    _mm256_add_ps, _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps, _mm256_castps_si256,
    _mm256_castsi256_ps, _mm256_ceil_pd, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtpd_epi32,
    _mm256_fmadd_ps, _mm256_loadu_ps, _mm256_max_pd, _mm256_min_pd, _mm256_movemask_ps, _mm256_mul_pd,
    _mm256_mul_ps, _mm256_or_si256, _mm256_rsqrt_ps, _mm256_set1_epi32, _mm256_set1_pd, _mm256_set1_ps,
    _mm256_setr_epi32, _mm256_setr_pd, _mm256_setr_ps, _mm256_setzero_ps, _mm256_slli_epi32,
    _mm256_storeu_ps, _mm256_storeu_si256,
};

use super::simd::entries;
use super::wide::{Columns, FARTHEST, MAGIC, OPAQUE, ROWS, WIDE, Wide};

/// Sixteen f32 in two registers. Private to this module and used only inside the functions that `entries` compiles for it, which are called only
/// where the CPU has what they need: that is the SAFETY of every intrinsic here.
#[derive(Clone, Copy)]
struct Avx2([__m256; 2]);

/// Eight columns in two registers. As [`Avx2`].
#[derive(Clone, Copy)]
struct Avx2Columns([__m128i; 2]);

impl Avx2 {
    /// All bits of each lane that is set in `mask`.
    #[inline(always)]
    fn lanes(mask: u32) -> [__m256; 2] {
        // SAFETY: see `Avx2`.
        unsafe {
            let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            [mask, mask >> 8].map(|mask| {
                let set = _mm256_and_si256(_mm256_set1_epi32(mask as i32), bits);
                _mm256_castsi256_ps(_mm256_cmpeq_epi32(set, bits))
            })
        }
    }

    #[inline(always)]
    fn both(self, other: Self, f: impl Fn(__m256, __m256) -> __m256) -> Self {
        Avx2([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }

    #[inline(always)]
    fn halves(to: &[f32; WIDE]) -> [*const f32; 2] {
        [to[..8].as_ptr(), to[8..].as_ptr()]
    }

    #[inline(always)]
    fn halves_mut(to: &mut [f32; WIDE]) -> [*mut f32; 2] {
        let (low, high) = to.split_at_mut(8);
        [low.as_mut_ptr(), high.as_mut_ptr()]
    }
}

impl Wide for Avx2 {
    type Columns = Avx2Columns;
    type Words = [__m256i; 2];

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Avx2`.
        Avx2([unsafe { _mm256_set1_ps(x) }; 2])
    }
    #[inline(always)]
    fn count() -> Self {
        // SAFETY: see `Avx2`.
        unsafe {
            Avx2([
                _mm256_setr_ps(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0),
                _mm256_setr_ps(8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0),
            ])
        }
    }
    #[inline(always)]
    fn load(from: &[f32; WIDE]) -> Self {
        // SAFETY: see `Avx2`; each half of the array holds the eight that are read, and no alignment is needed.
        Avx2(Avx2::halves(from).map(|half| unsafe { _mm256_loadu_ps(half) }))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        self.both(other, |a, b| unsafe { _mm256_add_ps(a, b) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        self.both(other, |a, b| unsafe { _mm256_mul_ps(a, b) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, more.0);
        // SAFETY: see `Avx2`.
        Avx2(unsafe { [_mm256_fmadd_ps(a, c, e), _mm256_fmadd_ps(b, d, f)] })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(self.0.map(|a| unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }))
    }
    #[inline(always)]
    fn inverse_root(self) -> Self {
        // SAFETY: see `Avx2`.
        Avx2(self.0.map(|a| unsafe { _mm256_rsqrt_ps(a) }))
    }
    #[inline(always)]
    fn greater(self, other: Self) -> u32 {
        // SAFETY: see `Avx2`.
        let bits = |i: usize| unsafe {
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(self.0[i], other.0[i])) as u32
        };
        bits(0) | bits(1) << 8
    }
    #[inline(always)]
    fn zero(self) -> u32 {
        // SAFETY: see `Avx2`.
        let bits = |i: usize| unsafe {
            _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0[i], _mm256_setzero_ps())) as u32
        };
        bits(0) | bits(1) << 8
    }
    #[inline(always)]
    fn put(self, mask: u32, to: &mut [f32; WIDE]) {
        let lanes = Avx2::lanes(mask);
        for (i, half) in Avx2::halves_mut(to).into_iter().enumerate() {
            // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
            unsafe { _mm256_storeu_ps(half, _mm256_blendv_ps(_mm256_loadu_ps(half), self.0[i], lanes[i])) };
        }
    }
    #[inline(always)]
    fn put_or_zero(self, mask: u32, to: &mut [f32; WIDE]) {
        let lanes = Avx2::lanes(mask);
        for (i, half) in Avx2::halves_mut(to).into_iter().enumerate() {
            // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
            unsafe { _mm256_storeu_ps(half, _mm256_and_ps(self.0[i], lanes[i])) };
        }
    }
    #[inline(always)]
    fn words(x: u32) -> Self::Words {
        // SAFETY: see `Avx2`.
        [unsafe { _mm256_set1_epi32(x as i32) }; 2]
    }
    #[inline(always)]
    fn bytes(red: Self, green: Self, blue: Self) -> Self::Words {
        // SAFETY: see `Avx2`.
        [0, 1].map(|i| unsafe {
            let (magic, low) = (_mm256_set1_ps(MAGIC), _mm256_set1_epi32(0xff));
            let byte = |x: Self| _mm256_and_si256(_mm256_castps_si256(_mm256_add_ps(x.0[i], magic)), low);
            let green = _mm256_slli_epi32::<8>(byte(green));
            let blue = _mm256_slli_epi32::<16>(byte(blue));
            let opaque = _mm256_set1_epi32(OPAQUE as i32);
            _mm256_or_si256(_mm256_or_si256(byte(red), green), _mm256_or_si256(blue, opaque))
        })
    }
    #[inline(always)]
    fn put_words(words: Self::Words, mask: u32, to: &mut [u32; WIDE]) {
        // SAFETY: see `Avx2`.
        let words = words.map(|words| unsafe { _mm256_castsi256_ps(words) });
        Avx2(words).put(mask, bytemuck::cast_mut(to));
    }
    #[inline(always)]
    fn put_all(words: Self::Words, to: &mut [u32; WIDE]) {
        let (low, high) = to.split_at_mut(8);
        for (half, words) in [low, high].into_iter().zip(words) {
            // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
            unsafe { _mm256_storeu_si256(half.as_mut_ptr().cast(), words) };
        }
    }
}

impl Avx2Columns {
    #[inline(always)]
    fn both(self, other: Self, f: impl Fn(__m128i, __m128i) -> __m128i) -> Self {
        Avx2Columns([f(self.0[0], other.0[0]), f(self.0[1], other.0[1])])
    }
}

impl Columns for Avx2Columns {
    #[inline(always)]
    fn not_left(slope: f64, start: f64, first: i32) -> Self {
        let columns = |rows: __m256d| {
            // SAFETY: see `Avx2`.
            unsafe {
                let rows = _mm256_add_pd(_mm256_set1_pd(f64::from(first)), rows);
                let column = _mm256_add_pd(_mm256_set1_pd(start), _mm256_mul_pd(_mm256_set1_pd(slope), rows));
                // Of a NaN and a number the number.
                let column = _mm256_max_pd(column, _mm256_set1_pd(-FARTHEST));
                let column = _mm256_min_pd(column, _mm256_set1_pd(FARTHEST));
                _mm256_cvtpd_epi32(_mm256_ceil_pd(column))
            }
        };
        // SAFETY: see `Avx2`.
        let rows = unsafe { [_mm256_setr_pd(0.0, 1.0, 2.0, 3.0), _mm256_setr_pd(4.0, 5.0, 6.0, 7.0)] };
        Avx2Columns(rows.map(columns))
    }
    #[inline(always)]
    fn load(from: &[i32; ROWS]) -> Self {
        let halves = [from[..4].as_ptr(), from[4..].as_ptr()];
        // SAFETY: see `Avx2`; each half of the array holds the four that are read, and no alignment is needed.
        Avx2Columns(halves.map(|half| unsafe { _mm_loadu_si128(half.cast()) }))
    }
    #[inline(always)]
    fn store(self) -> [i32; ROWS] {
        let mut out = [0; ROWS];
        let (low, high) = out.split_at_mut(4);
        for (half, columns) in [low, high].into_iter().zip(self.0) {
            // SAFETY: see `Avx2`; each half of the array has room for four, and no alignment is needed.
            unsafe { _mm_storeu_si128(half.as_mut_ptr().cast(), columns) };
        }
        out
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        self.both(other, |a, b| unsafe { _mm_min_epi32(a, b) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx2`.
        self.both(other, |a, b| unsafe { _mm_max_epi32(a, b) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        let bits = |i: usize| {
            // SAFETY: see `Avx2`.
            unsafe { _mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(self.0[i], other.0[i]))) as u32 }
        };
        bits(0) | bits(1) << 4
    }
}

entries!(Avx2, "avx2,fma,bmi1,bmi2,popcnt");
