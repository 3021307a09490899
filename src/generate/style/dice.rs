//! Chance that is the same on every machine: it follows from a seed, the option and the element's identity, never
//! from the order in which things are asked.

use twox_hash::XxHash3_64;

use crate::splitmix::SplitMix64;

/// Draws random numbers by name.
#[derive(Clone, Copy, Debug)]
pub struct Dice {
    seed: u64,
}

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice { seed }
    }

    /// The random numbers of `option` for the element `key`.
    pub fn draw(&self, option: &str, key: &str) -> Random {
        let of_option = XxHash3_64::oneshot_with_seed(self.seed, option.as_bytes());
        Random(SplitMix64::new(XxHash3_64::oneshot_with_seed(of_option, key.as_bytes())))
    }

    /// Whether `option` touches the element `key`, if it is to touch a share of them: never at 0, always at 1.
    pub fn hits(&self, share: f64, option: &str, key: &str) -> bool {
        share > 0.0 && self.draw(option, key).fraction() < share
    }
}

/// Random numbers.
#[derive(Clone, Copy, Debug)]
pub struct Random(SplitMix64);

impl Random {
    /// At least 0 and less than 1.
    pub fn fraction(&mut self) -> f64 {
        self.0.unit()
    }

    /// At least `low` and at most `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.between(low, high)
    }

    /// A whole number from 0 to `count - 1`; 0 if `count` is 0.
    pub fn below(&mut self, count: usize) -> usize {
        self.0.below(count as u64) as usize
    }

    /// A vector with coordinates from `-most` to `most`.
    pub fn around(&mut self, most: f64) -> [f64; 3] {
        [0; 3].map(|_| self.between(-most, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_kept() {
        let dice = Dice::new(5);
        let hits = |share| (0..4000).filter(|i| dice.hits(share, "x", &i.to_string())).count();
        assert_eq!((hits(0.0), hits(f64::NAN), hits(1.0), hits(7.0)), (0, 0, 4000, 4000));
        assert!((900..1100).contains(&hits(0.25)), "{}", hits(0.25));
        assert_ne!(dice.draw("x", "1").0.bits(), dice.draw("y", "1").0.bits());
        assert_ne!(dice.draw("x", "1").0.bits(), dice.draw("x", "2").0.bits());
        assert_ne!(dice.draw("x", "1").0.bits(), Dice::new(6).draw("x", "1").0.bits());
    }

    #[test]
    fn the_numbers_never_change() {
        let mut random = Dice::new(1).draw("rooms-smaller", "2O2Fr$t4X7Zf8NOew3FLOH");
        assert_eq!(
            [random.0.bits(), random.0.bits()],
            [4_113_306_361_847_705_221, 17_628_473_440_703_471_844]
        );
        assert!((0..100).all(|_| random.around(0.5).iter().all(|c| c.abs() <= 0.5)));
    }
}
