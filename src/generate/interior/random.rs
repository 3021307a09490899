//! Random choices that are the same on every machine.

use crate::splitmix::SplitMix64;

/// What is drawn for a room.
#[derive(Clone, Debug)]
pub struct Random(SplitMix64);

impl Random {
    /// A sequence of its own for each seed.
    pub fn new(seed: u64) -> Random {
        Random(SplitMix64::new(seed))
    }

    /// A number below `end`; 0 if that is 0.
    pub fn below(&mut self, end: u32) -> u32 {
        // The high half of a product is even enough for small numbers.
        (((self.0.bits() >> 32) * u64::from(end)) >> 32) as u32
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
    }
}
