//! Random numbers by index: the same for any number of threads.

use crate::splitmix::SplitMix64;

/// Started from a seed and the index of what the numbers are for.
#[derive(Clone, Debug)]
pub(crate) struct Random(SplitMix64);

impl Random {
    /// The numbers of thing `index` of stream `stream`.
    pub(crate) fn new(seed: u64, stream: u64, index: u64) -> Random {
        let bits = |seed: u64| SplitMix64::new(seed).bits();
        let of_stream = bits(seed) ^ stream.wrapping_mul(0xd6e8_feb8_6659_fd93);
        Random(SplitMix64::new(bits(bits(of_stream) ^ index)))
    }

    /// In 0..1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// In `0..count`; 0 if `count` is 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        ((u128::from(self.0.bits()) * count as u128) >> 64) as usize
    }

    /// Unit length, all directions alike.
    pub(crate) fn direction(&mut self) -> [f64; 3] {
        loop {
            let v = [0; 3].map(|_| self.between(-1.0, 1.0));
            let square = super::vector::dot(v, v);
            // More than half of the tries end here.
            if square <= 1.0 && square > 1e-6 {
                return super::vector::scale(v, 1.0 / square.sqrt());
            }
        }
    }

    /// In the box, evenly.
    pub(crate) fn point(&mut self, bounds: &super::vector::Bounds) -> [f64; 3] {
        [0, 1, 2].map(|i| self.between(bounds.lo[i], bounds.hi[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_and_repeatable() {
        let mut sum = [0.0; 3];
        let mut counts = [0; 7];
        for index in 0..20_000 {
            let mut random = Random::new(1, 2, index);
            let d = random.direction();
            assert_eq!(d, Random::new(1, 2, index).direction());
            assert_ne!(d, Random::new(1, 3, index).direction());
            assert_ne!(d, Random::new(2, 2, index).direction());
            assert!((super::super::vector::length(d) - 1.0).abs() < 1e-12);
            sum = super::super::vector::add(sum, d);
            counts[random.below(7)] += 1;
        }
        assert!(sum.iter().all(|s| s.abs() < 400.0), "{sum:?}");
        assert!(counts.iter().all(|&c| (2600..3100).contains(&c)), "{counts:?}");
    }
}
