//! Random choices that are the same on every machine.

/// SplitMix64.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A sequence of its own for each seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 if that is 0.
    pub fn below(&mut self, end: u32) -> u32 {
        // The high half of a product is even enough for small numbers.
        (((self.bits() >> 32) * u64::from(end)) >> 32) as u32
    }

    /// Heads or tails.
    pub fn flip(&mut self) -> bool {
        self.below(2) == 1
    }

    /// The things in a random order.
    pub fn shuffled<T, const N: usize>(&mut self, mut things: [T; N]) -> [T; N] {
        for i in (1..N).rev() {
            things.swap(i, self.below(i as u32 + 1) as usize);
        }
        things
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_in_range_and_all_occur() {
        let mut random = Random::new(3);
        let mut seen = [0; 5];
        (0..500).for_each(|_| seen[random.below(5) as usize] += 1);
        assert!(seen.iter().all(|&n| (60..140).contains(&n)), "{seen:?}");
        assert_eq!(random.below(0), 0);
        let mut order = random.shuffled([4, 3, 2, 1, 0]);
        order.sort_unstable();
        assert_eq!(order, [0, 1, 2, 3, 4]);
        // The reference values of SplitMix64 for seed 0.
        let mut zero = Random::new(0);
        assert_eq!([zero.bits(), zero.bits()], [0xE220_A839_7B1D_CDAF, 0x6E78_9E6A_A1B9_65F4]);
    }
}
