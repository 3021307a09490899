//! Exact arithmetic on sums of f64, for the few signs and quotients that plain f64 cannot settle.
//!
//! A number is an *expansion*: a sum of f64 that do not overlap, smallest first (Shewchuk, "Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates", 1997). Sums, differences and products are exact
//! as long as nothing overflows or underflows. This is the slow road, taken by far less than one triangle in a
//! thousand, so it allocates freely.

/// An exact sum of f64.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exact(Vec<f64>);

/// `a + b` rounded, and what the rounding lost.
#[inline]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// `a * b` rounded, and what the rounding lost.
#[inline]
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// A sum of two f64, the second less than half a unit in the last place of the first: about 106 bits.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Twice {
    high: f64,
    low: f64,
}

impl Twice {
    /// `a - b`, exactly.
    #[inline]
    pub(crate) fn difference(a: f64, b: f64) -> Twice {
        let (high, low) = two_sum(a, -b);
        Twice { high, low }
    }

    /// `self * other`, but for 2^-102 of it.
    #[inline]
    fn times(self, other: Twice) -> Twice {
        let (high, rest) = two_product(self.high, other.high);
        let (high, low) = two_sum(high, rest + (self.high * other.low + self.low * other.high));
        Twice { high, low }
    }

    /// `self + other`, but for 2^-102 of the larger of the two.
    #[inline]
    fn plus(self, other: Twice) -> Twice {
        let (sum, rest) = two_sum(self.high, other.high);
        let (high, low) = two_sum(sum, rest + (self.low + other.low));
        Twice { high, low }
    }

    #[inline]
    fn minus(self, other: Twice) -> Twice {
        self.plus(Twice { high: -other.high, low: -other.low })
    }
}

/// The sign of `d . (b x c)`, if twice the digits of f64 settle it.
pub(crate) fn side_in_twice(d: [f64; 3], b: [Twice; 3], c: [Twice; 3]) -> Option<i32> {
    let (mut sum, mut size) = (Twice { high: 0.0, low: 0.0 }, 0.0);
    for (axis, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let minor = b[i].times(c[j]).minus(b[j].times(c[i]));
        sum = sum.plus(minor.times(Twice { high: d[axis], low: 0.0 }));
        size += d[axis].abs() * ((b[i].high * c[j].high).abs() + (b[j].high * c[i].high).abs());
    }
    // What underflows is left to others, as is what is no number.
    let is_settled = sum.high.abs() > ERROR * size + LEAST && size.is_finite();
    is_settled.then_some(if sum.high > 0.0 { 1 } else { -1 })
}

/// Operations on [`Twice`] one after the other, fewer than sixteen, are off by so much of the products at most.
const ERROR: f64 = 1.0 / (1u128 << 96) as f64;

/// What underflows is left to others, as is what is no number.
const LEAST: f64 = 1e-200;

/// `(e x f) . a / (e x f) . d`, to within `most` and as much of it, if twice the digits of f64 settle it.
pub(crate) fn quotient_in_twice([e, f, a]: [[Twice; 3]; 3], d: [f64; 3], most: f64) -> Option<f64> {
    let (mut sums, mut sizes) = ([Twice { high: 0.0, low: 0.0 }; 2], [0.0; 2]);
    for (axis, i, j) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        let normal = e[i].times(f[j]).minus(e[j].times(f[i]));
        let size = (e[i].high * f[j].high).abs() + (e[j].high * f[i].high).abs();
        for (k, by) in [a[axis], Twice { high: d[axis], low: 0.0 }].into_iter().enumerate() {
            sums[k] = sums[k].plus(normal.times(by));
            sizes[k] += size * by.high.abs();
        }
    }
    let [numerator, denominator] = sums.map(|sum| sum.high);
    let t = numerator / denominator;
    let [off, of] = sizes.map(|size| ERROR * size + LEAST);
    let is_settled = of <= 0.25 * most * denominator.abs() && off <= 0.25 * most * denominator.abs();
    (is_settled && t.is_finite()).then_some(t)
}

impl Exact {
    /// `a - b`.
    pub(crate) fn difference(a: f64, b: f64) -> Exact {
        let mut exact = Exact::default();
        exact.add_f64(a);
        exact.add_f64(-b);
        exact
    }

    fn add_f64(&mut self, b: f64) {
        let mut carry = b;
        let mut kept = 0;
        for i in 0..self.0.len() {
            let (sum, lost) = two_sum(carry, self.0[i]);
            carry = sum;
            if lost != 0.0 {
                self.0[kept] = lost;
                kept += 1;
            }
        }
        self.0.truncate(kept);
        if carry != 0.0 {
            self.0.push(carry);
        }
    }

    /// `self + other`.
    pub(crate) fn plus(mut self, other: &Exact) -> Exact {
        for &term in &other.0 {
            self.add_f64(term);
        }
        self
    }

    /// `self - other`.
    pub(crate) fn minus(mut self, other: &Exact) -> Exact {
        for &term in &other.0 {
            self.add_f64(-term);
        }
        self
    }

    /// `self * factor`.
    pub(crate) fn times_f64(&self, factor: f64) -> Exact {
        let mut product = Exact::default();
        for &term in &self.0 {
            let (high, low) = two_product(term, factor);
            product.add_f64(low);
            product.add_f64(high);
        }
        product
    }

    /// `self * other`.
    pub(crate) fn times(&self, other: &Exact) -> Exact {
        let mut product = Exact::default();
        for &term in &other.0 {
            product = product.plus(&self.times_f64(term));
        }
        product
    }

    /// The nearest f64, to within an ulp.
    pub(crate) fn value(&self) -> f64 {
        self.0.iter().sum()
    }

    /// -1, 0 or 1. The last term outweighs all others.
    pub(crate) fn sign(&self) -> i32 {
        match self.0.last() {
            Some(&last) if last > 0.0 => 1,
            Some(&last) if last < 0.0 => -1,
            _ => 0,
        }
    }
}

/// A vector of exact numbers.
pub(crate) type Exact3 = [Exact; 3];

/// `a - b`.
pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> Exact3 {
    [0, 1, 2].map(|i| Exact::difference(a[i], b[i]))
}

/// `a x b`.
pub(crate) fn cross(a: &Exact3, b: &Exact3) -> Exact3 {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
}

/// `a . b`.
pub(crate) fn dot(a: &Exact3, b: &Exact3) -> Exact {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

/// `a . b` for a plain `b`.
pub(crate) fn dot_f64(a: &Exact3, b: [f64; 3]) -> Exact {
    a[0].times_f64(b[0]).plus(&a[1].times_f64(b[1])).plus(&a[2].times_f64(b[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn keeps_what_f64_loses() {
        let tiny = 2f64.powi(-80);
        let sum = Exact::difference(1.0, -tiny).minus(&Exact::difference(1.0, 0.0));
        assert_eq!((sum.sign(), sum.value()), (1, tiny));
        let third = Exact::difference(0.1, 0.3);
        let square = third.times(&third);
        assert_eq!(square.clone().minus(&third.times(&third)).sign(), 0);
        assert!((square.value() - 0.04).abs() < 1e-16);
    }

    proptest! {
        /// Corners almost on a line through the origin along `d`, and on it.
        #[test]
        fn twice_the_digits_have_the_right_sign(
            d in proptest::array::uniform3(-1.0f64..1.0), along in proptest::array::uniform2(-9.0f64..9.0),
            off in proptest::array::uniform6(-1.0f64..1.0), size in -110i32..3,
        ) {
            let point = |i: usize| [0, 1, 2].map(|axis| d[axis] * along[i] + off[3 * i + axis] * 2f64.powi(size));
            let (b, c) = (point(0), point(1));
            let exactly = |p: [f64; 3]| difference(p, [0.1, 0.2, 0.3]);
            let twice = |p: [f64; 3]| [0, 1, 2].map(|axis| Twice::difference(p[axis], [0.1, 0.2, 0.3][axis]));
            let exact = dot_f64(&cross(&exactly(b), &exactly(c)), d).sign();
            if let Some(sign) = side_in_twice(d, twice(b), twice(c)) {
                prop_assert_eq!(sign, exact);
            }
            let plain = |p: [f64; 3]| [0, 1, 2].map(|axis| Twice::difference(p[axis], 0.0));
            let exact = dot_f64(&cross(&difference(b, [0.0; 3]), &difference(c, [0.0; 3])), d).sign();
            let told = side_in_twice(d, plain(b), plain(c));
            prop_assert!(told.is_none_or(|sign| sign == exact));
            // Hardly ever is more needed.
            prop_assert!(told.is_some() || exact == 0 || size < -20);
        }

        /// Where a line almost along a triangle's plane meets it.
        #[test]
        fn quotients_are_as_near_as_they_say(
            e in proptest::array::uniform3(-3.0f64..3.0), f in proptest::array::uniform3(-3.0f64..3.0),
            a in proptest::array::uniform3(-9.0f64..9.0), shares in proptest::array::uniform2(-1.0f64..1.0),
            off in proptest::array::uniform3(-1.0f64..1.0), size in -60i32..0,
        ) {
            let d = [0, 1, 2].map(|i| e[i] * shares[0] + f[i] * shares[1] + off[i] * 2f64.powi(size));
            let twice = |p: [f64; 3]| p.map(|c| Twice::difference(c, 0.0));
            let exactly = |p: [f64; 3]| difference(p, [0.0; 3]);
            let normal = cross(&exactly(e), &exactly(f));
            let exact = dot(&normal, &exactly(a)).value() / dot_f64(&normal, d).value();
            const MOST: f64 = 1e-10;
            let told = quotient_in_twice([twice(e), twice(f), twice(a)], d, MOST);
            if let Some(t) = told {
                prop_assert!((t - exact).abs() <= MOST * (1.0 + exact.abs()), "{} {}", t, exact);
            }
            let is_thin = normal.iter().all(|c| c.value().abs() < 1e-3);
            prop_assert!(told.is_some() || size < -40 || is_thin);
        }

        #[test]
        fn what_underflows_is_left_to_others(d in proptest::array::uniform3(-1.0f64..1.0)) {
            let tiny = [0, 1, 2].map(|_| Twice::difference(1e-180, 0.0));
            prop_assert_eq!(side_in_twice(d, tiny, tiny), None);
            let huge = [0, 1, 2].map(|i| Twice::difference(1e200 * (i as f64 + 1.0), 0.0));
            prop_assert_eq!(side_in_twice(d, huge, [huge[2], huge[0], huge[1]]), None);
            prop_assert_eq!(quotient_in_twice([tiny, tiny, tiny], d, 1e-10), None);
        }

        /// Small integers over a power of two: i128 knows the exact answer.
        #[test]
        fn determinants_match_integers(m in proptest::array::uniform9(-(1i64 << 36)..(1i64 << 36))) {
            let f = |i: usize| m[i] as f64 / 1024.0;
            let row = |r: usize| difference([f(3 * r), f(3 * r + 1), f(3 * r + 2)], [0.0; 3]);
            let exact = dot(&cross(&row(0), &row(1)), &row(2));
            let i = |k: usize| i128::from(m[k]);
            let det = (i(1) * i(5) - i(2) * i(4)) * i(6)
                + (i(2) * i(3) - i(0) * i(5)) * i(7)
                + (i(0) * i(4) - i(1) * i(3)) * i(8);
            prop_assert_eq!(exact.sign(), det.signum() as i32);
            let value = det as f64 / (1024.0f64 * 1024.0 * 1024.0);
            prop_assert!((exact.value() - value).abs() <= value.abs() * 1e-15);
        }
    }
}
