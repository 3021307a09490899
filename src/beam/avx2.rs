//! Sixteen pixels in two registers, and the loops compiled for AVX2.
#![allow(unsafe_code)]

use std::arch::x86_64::{
    __m128i, __m256, __m256d, __m256i, _CMP_GT_OQ, _mm_and_si128, _mm_blendv_epi8, _mm_castsi128_ps,
    _mm_cmpeq_epi32, _mm_cmplt_epi32, _mm_cvtsi128_si32, _mm_loadu_si128, _mm_max_epi32, _mm_min_epi32,
    _mm_movemask_ps, _mm_set1_epi32, _mm_setr_epi32, _mm_setzero_si128, _mm_shuffle_epi32, _mm_sllv_epi32,
    _mm_storeu_si128, _mm_sub_epi32, _mm256_add_epi16, _mm256_add_pd, _mm256_add_ps, _mm256_and_si256,
    _mm256_andnot_ps, _mm256_blendv_pd, _mm256_blendv_ps, _mm256_castps_si256, _mm256_castsi256_ps,
    _mm256_ceil_pd, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_cvtpd_epi32, _mm256_fmadd_ps, _mm256_loadu_ps,
    _mm256_max_pd, _mm256_min_pd, _mm256_movemask_ps, _mm256_mul_pd, _mm256_mul_ps, _mm256_mulhrs_epi16,
    _mm256_or_si256, _mm256_rsqrt_ps, _mm256_set1_epi16, _mm256_set1_epi32, _mm256_set1_pd, _mm256_set1_ps,
    _mm256_setr_epi16, _mm256_setr_epi32, _mm256_setr_pd, _mm256_setr_ps, _mm256_slli_epi32,
    _mm256_srli_epi16, _mm256_storeu_ps, _mm256_storeu_si256, _mm256_sub_epi16,
};

use super::simd::entries;
use super::wide::{Columns, FARTHEST, HALF_UP, Levels, Lines, MAGIC, OPAQUE, ROWS, WIDE, Wide};

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
            let (low, high) = (
                _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128),
                _mm256_setr_epi32(256, 512, 1024, 2048, 4096, 8192, 16384, 32768),
            );
            let mask = _mm256_set1_epi32(mask as i32);
            [
                _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(mask, low), low)),
                _mm256_castsi256_ps(_mm256_cmpeq_epi32(_mm256_and_si256(mask, high), high)),
            ]
        }
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
        let [low, high] = Avx2::halves(from);
        // SAFETY: see `Avx2`; each half of the array holds the eight that are read, and no alignment is needed.
        Avx2(unsafe { [_mm256_loadu_ps(low), _mm256_loadu_ps(high)] })
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        Avx2(unsafe { [_mm256_add_ps(a, c), _mm256_add_ps(b, d)] })
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        Avx2(unsafe { [_mm256_mul_ps(a, c), _mm256_mul_ps(b, d)] })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, more: Self) -> Self {
        let ([a, b], [c, d], [e, f]) = (self.0, factor.0, more.0);
        // SAFETY: see `Avx2`.
        Avx2(unsafe { [_mm256_fmadd_ps(a, c, e), _mm256_fmadd_ps(b, d, f)] })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let [low, high] = self.0;
        // SAFETY: see `Avx2`.
        unsafe {
            let sign = _mm256_set1_ps(-0.0);
            Avx2([_mm256_andnot_ps(sign, low), _mm256_andnot_ps(sign, high)])
        }
    }
    #[inline(always)]
    fn inverse_root(self) -> Self {
        let [low, high] = self.0;
        // SAFETY: see `Avx2`.
        Avx2(unsafe { [_mm256_rsqrt_ps(low), _mm256_rsqrt_ps(high)] })
    }
    #[inline(always)]
    fn greater(self, other: Self) -> u32 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        unsafe {
            let low = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(a, c)) as u32;
            let high = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GT_OQ>(b, d)) as u32;
            low | high << 8
        }
    }
    #[inline(always)]
    fn put(self, mask: u32, to: &mut [f32; WIDE]) {
        let ([a, b], [low, high]) = (self.0, Avx2::lanes(mask));
        let [to_low, to_high] = Avx2::halves_mut(to);
        // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
        unsafe {
            _mm256_storeu_ps(to_low, _mm256_blendv_ps(_mm256_loadu_ps(to_low), a, low));
            _mm256_storeu_ps(to_high, _mm256_blendv_ps(_mm256_loadu_ps(to_high), b, high));
        }
    }
    #[inline(always)]
    fn store(self, to: &mut [f32; WIDE]) {
        let [low, high] = Avx2::halves_mut(to);
        // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
        unsafe {
            _mm256_storeu_ps(low, self.0[0]);
            _mm256_storeu_ps(high, self.0[1]);
        }
    }
    #[inline(always)]
    fn words(x: u32) -> Self::Words {
        // SAFETY: see `Avx2`.
        [unsafe { _mm256_set1_epi32(x as i32) }; 2]
    }
    #[inline(always)]
    fn bytes(red: Self, green: Self, blue: Self) -> Self::Words {
        let ([r, s], [g, h], [b, c]) = (red.0, green.0, blue.0);
        [bytes([r, g, b]), bytes([s, h, c])]
    }
    #[inline(always)]
    fn levels(self, color: &[f32; 3]) -> Levels {
        let (mut red_blue, mut green) = ([0; WIDE], [0; WIDE]);
        for half in 0..2 {
            let (to_red_blue, to_green) = (&mut red_blue[8 * half..][..8], &mut green[8 * half..][..8]);
            // SAFETY: see `Avx2`; each half of the arrays has room for eight, and no alignment is needed.
            unsafe {
                let (half_up, low) = (_mm256_set1_ps(HALF_UP), _mm256_set1_epi32(0xffff));
                let factor = _mm256_mul_ps(self.0[half], _mm256_set1_ps(256.0));
                let r = _mm256_castps_si256(_mm256_fmadd_ps(factor, _mm256_set1_ps(color[0]), half_up));
                let g = _mm256_castps_si256(_mm256_fmadd_ps(factor, _mm256_set1_ps(color[1]), half_up));
                let b = _mm256_castps_si256(_mm256_fmadd_ps(factor, _mm256_set1_ps(color[2]), half_up));
                let r = _mm256_or_si256(_mm256_and_si256(r, low), _mm256_slli_epi32::<16>(b));
                let g = _mm256_or_si256(_mm256_and_si256(g, low), _mm256_set1_epi32(OPAQUE as i32));
                _mm256_storeu_si256(to_red_blue.as_mut_ptr().cast(), r);
                _mm256_storeu_si256(to_green.as_mut_ptr().cast(), g);
            }
        }
        Levels { red_blue, green }
    }
    #[inline(always)]
    fn ramp(levels: &Levels, from: usize, to: usize) -> Self::Words {
        ramp(levels, from, to)
    }
    #[inline(always)]
    fn put_words([a, b]: Self::Words, mask: u32, to: &mut [u32; WIDE]) {
        // SAFETY: see `Avx2`.
        let numbers = unsafe { [_mm256_castsi256_ps(a), _mm256_castsi256_ps(b)] };
        Avx2(numbers).put(mask, bytemuck::cast_mut(to));
    }
    #[inline(always)]
    fn put_all([a, b]: Self::Words, to: &mut [u32; WIDE]) {
        let (low, high) = to.split_at_mut(8);
        // SAFETY: see `Avx2`; each half of the array has room for eight, and no alignment is needed.
        unsafe {
            _mm256_storeu_si256(low.as_mut_ptr().cast(), a);
            _mm256_storeu_si256(high.as_mut_ptr().cast(), b);
        }
    }
}

/// As [`Wide::bytes`], of eight.
#[inline(always)]
fn bytes([red, green, blue]: [__m256; 3]) -> __m256i {
    // SAFETY: see `Avx2`.
    unsafe {
        let (magic, low) = (_mm256_set1_ps(MAGIC), _mm256_set1_epi32(0xff));
        let red = _mm256_and_si256(_mm256_castps_si256(_mm256_add_ps(red, magic)), low);
        let green = _mm256_and_si256(_mm256_castps_si256(_mm256_add_ps(green, magic)), low);
        let blue = _mm256_and_si256(_mm256_castps_si256(_mm256_add_ps(blue, magic)), low);
        let (green, blue) = (_mm256_slli_epi32::<8>(green), _mm256_slli_epi32::<16>(blue));
        let opaque = _mm256_set1_epi32(OPAQUE as i32);
        _mm256_or_si256(_mm256_or_si256(red, green), _mm256_or_si256(blue, opaque))
    }
}

/// As [`Wide::ramp`].
#[inline(always)]
fn ramp(levels: &Levels, from: usize, to: usize) -> [__m256i; 2] {
    let (from, to) = (from % WIDE, to % WIDE);
    // SAFETY: see `Avx2`.
    unsafe {
        // Of 2^15, for both halves of each word.
        let first = _mm256_setr_epi16(
            0, 0, 2048, 2048, 4096, 4096, 6144, 6144, 8192, 8192, 10240, 10240, 12288, 12288, 14336, 14336,
        );
        let second = _mm256_add_epi16(first, _mm256_set1_epi16(16384));
        let red_blue = _mm256_set1_epi32(levels.red_blue[from] as i32);
        let green = _mm256_set1_epi32(levels.green[from] as i32);
        let by_red_blue = _mm256_sub_epi16(_mm256_set1_epi32(levels.red_blue[to] as i32), red_blue);
        let by_green = _mm256_sub_epi16(_mm256_set1_epi32(levels.green[to] as i32), green);
        let upper = _mm256_set1_epi16(0xff00u16 as i16);
        let r = _mm256_add_epi16(red_blue, _mm256_mulhrs_epi16(by_red_blue, first));
        let s = _mm256_add_epi16(red_blue, _mm256_mulhrs_epi16(by_red_blue, second));
        let g = _mm256_and_si256(_mm256_add_epi16(green, _mm256_mulhrs_epi16(by_green, first)), upper);
        let h = _mm256_and_si256(_mm256_add_epi16(green, _mm256_mulhrs_epi16(by_green, second)), upper);
        [_mm256_or_si256(_mm256_srli_epi16::<8>(r), g), _mm256_or_si256(_mm256_srli_epi16::<8>(s), h)]
    }
}

/// As [`Columns::up_to`], of four.
#[inline(always)]
fn up_to(from: __m128i, to: __m128i, first: i32) -> __m128i {
    // SAFETY: see `Avx2`.
    unsafe {
        let (first, one) = (_mm_set1_epi32(first), _mm_set1_epi32(1));
        let (none, all) = (_mm_setzero_si128(), _mm_set1_epi32(WIDE as i32));
        let from = _mm_min_epi32(_mm_max_epi32(_mm_sub_epi32(from, first), none), all);
        let to = _mm_min_epi32(_mm_max_epi32(_mm_sub_epi32(to, first), from), all);
        _mm_sub_epi32(_mm_sllv_epi32(one, to), _mm_sllv_epi32(one, from))
    }
}

impl Columns for Avx2Columns {
    type Lines = Avx2Lines;

    #[inline(always)]
    fn load(from: &[i32; ROWS]) -> Self {
        let (low, high) = (from[..4].as_ptr(), from[4..].as_ptr());
        // SAFETY: see `Avx2`; each half of the array holds the four that are read, and no alignment is needed.
        Avx2Columns(unsafe { [_mm_loadu_si128(low.cast()), _mm_loadu_si128(high.cast())] })
    }
    #[inline(always)]
    fn store(self) -> [i32; ROWS] {
        let mut out = [0; ROWS];
        let (low, high) = out.split_at_mut(4);
        // SAFETY: see `Avx2`; each half of the array has room for four, and no alignment is needed.
        unsafe {
            _mm_storeu_si128(low.as_mut_ptr().cast(), self.0[0]);
            _mm_storeu_si128(high.as_mut_ptr().cast(), self.0[1]);
        }
        out
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        Avx2Columns(unsafe { [_mm_min_epi32(a, c), _mm_min_epi32(b, d)] })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        Avx2Columns(unsafe { [_mm_max_epi32(a, c), _mm_max_epi32(b, d)] })
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        let ([a, b], [c, d]) = (self.0, other.0);
        // SAFETY: see `Avx2`.
        unsafe {
            let low = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(a, c))) as u32;
            let high = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmplt_epi32(b, d))) as u32;
            low | high << 4
        }
    }
    #[inline(always)]
    fn held(self, there: u32, other: i32) -> Self {
        let [a, b] = self.0;
        // SAFETY: see `Avx2`.
        Avx2Columns(unsafe {
            let (there, other) = (_mm_set1_epi32(there as i32), _mm_set1_epi32(other));
            let (low, high) = (_mm_setr_epi32(1, 2, 4, 8), _mm_setr_epi32(16, 32, 64, 128));
            let low = _mm_cmpeq_epi32(_mm_and_si128(there, low), low);
            let high = _mm_cmpeq_epi32(_mm_and_si128(there, high), high);
            [_mm_blendv_epi8(other, a, low), _mm_blendv_epi8(other, b, high)]
        })
    }
    #[inline(always)]
    fn least(self) -> i32 {
        // SAFETY: see `Avx2`.
        unsafe {
            let four = _mm_min_epi32(self.0[0], self.0[1]);
            let two = _mm_min_epi32(four, _mm_shuffle_epi32::<0b01_00_11_10>(four));
            _mm_cvtsi128_si32(_mm_min_epi32(two, _mm_shuffle_epi32::<0b10_11_00_01>(two)))
        }
    }
    #[inline(always)]
    fn most(self) -> i32 {
        // SAFETY: see `Avx2`.
        unsafe {
            let four = _mm_max_epi32(self.0[0], self.0[1]);
            let two = _mm_max_epi32(four, _mm_shuffle_epi32::<0b01_00_11_10>(four));
            _mm_cvtsi128_si32(_mm_max_epi32(two, _mm_shuffle_epi32::<0b10_11_00_01>(two)))
        }
    }
    #[inline(always)]
    fn up_to(self, end: Self, first: i32) -> ([u32; ROWS], u32) {
        let mut out = [0; ROWS];
        let (low, high) = out.split_at_mut(4);
        // SAFETY: see `Avx2`; each half of the array has room for four, and no alignment is needed.
        unsafe {
            let (low_bits, high_bits) =
                (up_to(self.0[0], end.0[0], first), up_to(self.0[1], end.0[1], first));
            _mm_storeu_si128(low.as_mut_ptr().cast(), low_bits);
            _mm_storeu_si128(high.as_mut_ptr().cast(), high_bits);
            let zero = _mm_setzero_si128();
            let low_none = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(low_bits, zero)));
            let high_none = _mm_movemask_ps(_mm_castsi128_ps(_mm_cmpeq_epi32(high_bits, zero)));
            (out, (low_none | high_none << 4) as u32 ^ 0xff)
        }
    }
}

/// Eight f64 in two registers. As [`Avx2`].
#[derive(Clone, Copy)]
struct Avx2Lines([__m256d; 2]);

impl Lines for Avx2Lines {
    type Columns = Avx2Columns;

    #[inline(always)]
    fn new(slope: f64, start: f64, first: i32) -> Self {
        // SAFETY: see `Avx2`.
        unsafe {
            let (first, slope) = (_mm256_set1_pd(f64::from(first)), _mm256_set1_pd(slope));
            let start = _mm256_set1_pd(start);
            let low = _mm256_add_pd(first, _mm256_setr_pd(0.0, 1.0, 2.0, 3.0));
            let high = _mm256_add_pd(first, _mm256_setr_pd(4.0, 5.0, 6.0, 7.0));
            Avx2Lines([
                _mm256_add_pd(start, _mm256_mul_pd(slope, low)),
                _mm256_add_pd(start, _mm256_mul_pd(slope, high)),
            ])
        }
    }
    #[inline(always)]
    fn splat(column: f64) -> Self {
        // SAFETY: see `Avx2`.
        Avx2Lines([unsafe { _mm256_set1_pd(column) }; 2])
    }
    #[inline(always)]
    fn narrow([left, right]: &mut [Self; 2], line: Self, is_left: bool) {
        // No branch: which side it is on cannot be guessed.
        let far = if is_left { f64::NEG_INFINITY } else { f64::INFINITY };
        let ([a, b], [c, d], [e, f]) = (left.0, right.0, line.0);
        // SAFETY: see `Avx2`.
        unsafe {
            let mask = _mm256_set1_pd(far);
            // A line that does not count is as far out as can be.
            let (none, all) = (_mm256_set1_pd(f64::NEG_INFINITY), _mm256_set1_pd(f64::INFINITY));
            // The sign of `mask` is set where the line is on the left.
            left.0 = [
                _mm256_max_pd(a, _mm256_blendv_pd(e, none, mask)),
                _mm256_max_pd(b, _mm256_blendv_pd(f, none, mask)),
            ];
            right.0 = [
                _mm256_min_pd(c, _mm256_blendv_pd(all, e, mask)),
                _mm256_min_pd(d, _mm256_blendv_pd(all, f, mask)),
            ];
        }
    }
    #[inline(always)]
    fn not_left(self) -> Avx2Columns {
        let [low, high] = self.0;
        // SAFETY: see `Avx2`.
        Avx2Columns(unsafe {
            let (least, most) = (_mm256_set1_pd(-FARTHEST), _mm256_set1_pd(FARTHEST));
            let low = _mm256_min_pd(_mm256_max_pd(low, least), most);
            let high = _mm256_min_pd(_mm256_max_pd(high, least), most);
            [_mm256_cvtpd_epi32(_mm256_ceil_pd(low)), _mm256_cvtpd_epi32(_mm256_ceil_pd(high))]
        })
    }
}

entries!(Avx2, "avx2,fma,bmi1,bmi2,popcnt");
