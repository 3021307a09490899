//! Sixteen pixels in a register, and the loops compiled for AVX-512.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m256i, __m512, __m512d, __m512i, _CMP_GT_OQ, _MM_FROUND_NO_EXC, _MM_FROUND_TO_POS_INF,
    _mm_cvtsi128_si32, _mm_max_epi32, _mm_min_epi32, _mm_shuffle_epi32, _mm256_castsi256_si128,
    _mm256_cmplt_epi32_mask, _mm256_cmpneq_epi32_mask, _mm256_extracti128_si256, _mm256_loadu_si256,
    _mm256_mask_blend_epi32, _mm256_max_epi32, _mm256_min_epi32, _mm256_set1_epi32, _mm256_setzero_si256,
    _mm256_sllv_epi32, _mm256_storeu_si256, _mm256_sub_epi32, _mm512_abs_ps, _mm512_add_epi16, _mm512_add_pd,
    _mm512_add_ps, _mm512_and_si512, _mm512_castps_si512, _mm512_cmp_ps_mask, _mm512_cvtpd_epi32,
    _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_loadu_si512, _mm512_mask_max_pd, _mm512_mask_min_pd,
    _mm512_mask_storeu_epi32, _mm512_mask_storeu_ps, _mm512_max_pd, _mm512_min_pd, _mm512_mul_pd,
    _mm512_mul_ps, _mm512_mulhrs_epi16, _mm512_or_si512, _mm512_roundscale_pd, _mm512_rsqrt14_ps,
    _mm512_set1_epi16, _mm512_set1_epi32, _mm512_set1_pd, _mm512_set1_ps, _mm512_setr_pd, _mm512_setr_ps,
    _mm512_slli_epi32, _mm512_srli_epi16, _mm512_storeu_ps, _mm512_storeu_si512, _mm512_sub_epi16,
};

use super::simd::entries;
use super::wide::{Columns, FARTHEST, HALF_UP, Levels, Lines, MAGIC, OPAQUE, ROWS, WIDE, Wide};

/// Sixteen f32 in a register. Private to this module and used only inside the functions that `entries` compiles for it, which are called only
/// where the CPU has what they need: that is the SAFETY of every intrinsic here.
#[derive(Clone, Copy)]
struct Avx512(__m512);

/// Eight columns in a register. As [`Avx512`].
#[derive(Clone, Copy)]
struct Avx512Columns(__m256i);

/// Sixteenths, of 2^15, from pixel to pixel, for both halves of each word.
static SIXTEENTHS: [i16; 2 * WIDE] = {
    let mut all = [0; 2 * WIDE];
    let mut i = 0;
    while i < 2 * WIDE {
        all[i] = (i / 2 * 2048) as i16;
        i += 1;
    }
    all
};

impl Wide for Avx512 {
    type Columns = Avx512Columns;
    type Words = __m512i;

    #[inline(always)]
    fn splat(x: f32) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_set1_ps(x) })
    }
    #[inline(always)]
    fn count() -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe {
            _mm512_setr_ps(
                0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0,
            )
        })
    }
    #[inline(always)]
    fn load(from: &[f32; WIDE]) -> Self {
        // SAFETY: see `Avx512`; the array holds the sixteen that are read, and no alignment is needed.
        Avx512(unsafe { _mm512_loadu_ps(from.as_ptr()) })
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_add_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_mul_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_fmadd_ps(self.0, factor.0, more.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_abs_ps(self.0) })
    }
    #[inline(always)]
    fn inverse_root(self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512(unsafe { _mm512_rsqrt14_ps(self.0) })
    }
    #[inline(always)]
    fn greater(self, other: Self) -> u32 {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_cmp_ps_mask::<_CMP_GT_OQ>(self.0, other.0) }.into()
    }
    #[inline(always)]
    fn put(self, mask: u32, to: &mut [f32; WIDE]) {
        // SAFETY: see `Avx512`; the array has room for the sixteen, and no alignment is needed.
        unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask as u16, self.0) };
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; WIDE]) {
        // SAFETY: see `Avx512`; the array has room for the sixteen, and no alignment is needed.
        unsafe { _mm512_storeu_ps(to.as_mut_ptr(), self.0) };
    }
    #[inline(always)]
    fn words(x: u32) -> Self::Words {
        // SAFETY: see `Avx512`.
        unsafe { _mm512_set1_epi32(x as i32) }
    }
    #[inline(always)]
    fn bytes(red: Self, green: Self, blue: Self) -> Self::Words {
        // SAFETY: see `Avx512`.
        unsafe {
            let (magic, low) = (_mm512_set1_ps(MAGIC), _mm512_set1_epi32(0xff));
            let byte = |x: Self| _mm512_and_si512(_mm512_castps_si512(_mm512_add_ps(x.0, magic)), low);
            let green = _mm512_slli_epi32::<8>(byte(green));
            let blue = _mm512_slli_epi32::<16>(byte(blue));
            let opaque = _mm512_set1_epi32(OPAQUE as i32);
            _mm512_or_si512(_mm512_or_si512(byte(red), green), _mm512_or_si512(blue, opaque))
        }
    }
    #[inline(always)]
    fn levels(self, color: &[f32; 3]) -> Levels {
        let (mut red_blue, mut green) = ([0; WIDE], [0; WIDE]);
        // SAFETY: see `Avx512`; the arrays have room for the sixteen, and no alignment is needed.
        unsafe {
            let (half_up, low) = (_mm512_set1_ps(HALF_UP), _mm512_set1_epi32(0xffff));
            let factor = _mm512_mul_ps(self.0, _mm512_set1_ps(256.0));
            let r = _mm512_castps_si512(_mm512_fmadd_ps(factor, _mm512_set1_ps(color[0]), half_up));
            let g = _mm512_castps_si512(_mm512_fmadd_ps(factor, _mm512_set1_ps(color[1]), half_up));
            let b = _mm512_castps_si512(_mm512_fmadd_ps(factor, _mm512_set1_ps(color[2]), half_up));
            let r = _mm512_and_si512(r, low);
            let g = _mm512_and_si512(g, low);
            let r = _mm512_or_si512(r, _mm512_slli_epi32::<16>(b));
            let g = _mm512_or_si512(g, _mm512_set1_epi32(OPAQUE as i32));
            _mm512_storeu_si512(red_blue.as_mut_ptr().cast(), r);
            _mm512_storeu_si512(green.as_mut_ptr().cast(), g);
        }
        Levels { red_blue, green }
    }
    #[inline(always)]
    fn ramp(levels: &Levels, from: usize, to: usize) -> Self::Words {
        let (from, to) = (from % WIDE, to % WIDE);
        // SAFETY: see `Avx512`.
        unsafe {
            // Of 2^15, for both halves of each word.
            let by = _mm512_loadu_si512(SIXTEENTHS.as_ptr().cast());
            let red_blue = _mm512_set1_epi32(levels.red_blue[from] as i32);
            let green = _mm512_set1_epi32(levels.green[from] as i32);
            let by_red_blue = _mm512_sub_epi16(_mm512_set1_epi32(levels.red_blue[to] as i32), red_blue);
            let by_green = _mm512_sub_epi16(_mm512_set1_epi32(levels.green[to] as i32), green);
            let red_blue = _mm512_add_epi16(red_blue, _mm512_mulhrs_epi16(by_red_blue, by));
            let green = _mm512_add_epi16(green, _mm512_mulhrs_epi16(by_green, by));
            let upper = _mm512_set1_epi16(0xff00u16 as i16);
            _mm512_or_si512(_mm512_srli_epi16::<8>(red_blue), _mm512_and_si512(green, upper))
        }
    }
    #[inline(always)]
    fn put_words(words: Self::Words, mask: u32, to: &mut [u32; WIDE]) {
        // SAFETY: see `Avx512`; the array has room for the sixteen, and no alignment is needed.
        unsafe { _mm512_mask_storeu_epi32(to.as_mut_ptr().cast(), mask as u16, words) };
    }
    #[inline(always)]
    fn put_all(words: Self::Words, to: &mut [u32; WIDE]) {
        // SAFETY: see `Avx512`; the array has room for the sixteen, and no alignment is needed.
        unsafe { _mm512_storeu_si512(to.as_mut_ptr().cast(), words) };
    }
}

impl Columns for Avx512Columns {
    type Lines = Avx512Lines;

    #[inline(always)]
    fn load(from: &[i32; ROWS]) -> Self {
        // SAFETY: see `Avx512`; the array holds the eight that are read, and no alignment is needed.
        Avx512Columns(unsafe { _mm256_loadu_si256(from.as_ptr().cast()) })
    }
    #[inline(always)]
    fn store(self) -> [i32; ROWS] {
        let mut out = [0; ROWS];
        // SAFETY: see `Avx512`; the array has room for the eight, and no alignment is needed.
        unsafe { _mm256_storeu_si256(out.as_mut_ptr().cast(), self.0) };
        out
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512Columns(unsafe { _mm256_min_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        // SAFETY: see `Avx512`.
        Avx512Columns(unsafe { _mm256_max_epi32(self.0, other.0) })
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        // SAFETY: see `Avx512`.
        unsafe { _mm256_cmplt_epi32_mask(self.0, other.0) }.into()
    }
    #[inline(always)]
    fn held(self, there: u32, other: i32) -> Self {
        // SAFETY: see `Avx512`.
        Avx512Columns(unsafe { _mm256_mask_blend_epi32(there as u8, _mm256_set1_epi32(other), self.0) })
    }
    #[inline(always)]
    fn least(self) -> i32 {
        // SAFETY: see `Avx512`.
        unsafe {
            let four = _mm_min_epi32(_mm256_castsi256_si128(self.0), _mm256_extracti128_si256::<1>(self.0));
            let two = _mm_min_epi32(four, _mm_shuffle_epi32::<0b01_00_11_10>(four));
            _mm_cvtsi128_si32(_mm_min_epi32(two, _mm_shuffle_epi32::<0b10_11_00_01>(two)))
        }
    }
    #[inline(always)]
    fn most(self) -> i32 {
        // SAFETY: see `Avx512`.
        unsafe {
            let four = _mm_max_epi32(_mm256_castsi256_si128(self.0), _mm256_extracti128_si256::<1>(self.0));
            let two = _mm_max_epi32(four, _mm_shuffle_epi32::<0b01_00_11_10>(four));
            _mm_cvtsi128_si32(_mm_max_epi32(two, _mm_shuffle_epi32::<0b10_11_00_01>(two)))
        }
    }
    #[inline(always)]
    fn up_to(self, end: Self, first: i32) -> ([u32; ROWS], u32) {
        let mut out = [0; ROWS];
        // SAFETY: see `Avx512`; the array has room for the eight, and no alignment is needed.
        unsafe {
            let (first, one) = (_mm256_set1_epi32(first), _mm256_set1_epi32(1));
            let (none, all) = (_mm256_setzero_si256(), _mm256_set1_epi32(WIDE as i32));
            let from = _mm256_min_epi32(_mm256_max_epi32(_mm256_sub_epi32(self.0, first), none), all);
            let to = _mm256_min_epi32(_mm256_max_epi32(_mm256_sub_epi32(end.0, first), from), all);
            let bits = _mm256_sub_epi32(_mm256_sllv_epi32(one, to), _mm256_sllv_epi32(one, from));
            _mm256_storeu_si256(out.as_mut_ptr().cast(), bits);
            (out, _mm256_cmpneq_epi32_mask(bits, none).into())
        }
    }
}

/// Eight f64 in a register. As [`Avx512`].
#[derive(Clone, Copy)]
struct Avx512Lines(__m512d);

impl Lines for Avx512Lines {
    type Columns = Avx512Columns;

    #[inline(always)]
    fn new(slope: f64, start: f64, first: i32) -> Self {
        // SAFETY: see `Avx512`.
        Avx512Lines(unsafe {
            let rows = _mm512_setr_pd(0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0);
            let rows = _mm512_add_pd(_mm512_set1_pd(f64::from(first)), rows);
            _mm512_add_pd(_mm512_set1_pd(start), _mm512_mul_pd(_mm512_set1_pd(slope), rows))
        })
    }
    #[inline(always)]
    fn splat(column: f64) -> Self {
        // SAFETY: see `Avx512`.
        Avx512Lines(unsafe { _mm512_set1_pd(column) })
    }
    #[inline(always)]
    fn narrow([left, right]: &mut [Self; 2], line: Self, is_left: bool) {
        // No branch: which side it is on cannot be guessed.
        let mask = 0u8.wrapping_sub(u8::from(is_left));
        // SAFETY: see `Avx512`.
        unsafe {
            left.0 = _mm512_mask_max_pd(left.0, !mask, left.0, line.0);
            right.0 = _mm512_mask_min_pd(right.0, mask, right.0, line.0);
        }
    }
    #[inline(always)]
    fn not_left(self) -> Avx512Columns {
        // SAFETY: see `Avx512`.
        Avx512Columns(unsafe {
            let column = _mm512_max_pd(self.0, _mm512_set1_pd(-FARTHEST));
            let column = _mm512_min_pd(column, _mm512_set1_pd(FARTHEST));
            _mm512_cvtpd_epi32(_mm512_roundscale_pd::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(column))
        })
    }
}

entries!(Avx512, "avx2,fma,bmi1,bmi2,popcnt,avx512f,avx512vl,avx512dq,avx512bw");
