//! Sets of darts.

use super::dart::{Dart, GMap};

/// A set of darts of one map, one bit each.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    bits: Vec<u64>,
}

impl Marks {
    /// No dart of `map` is marked.
    pub fn new(map: &GMap) -> Marks {
        Marks { bits: vec![0; map.table_len().div_ceil(64)] }
    }

    /// Whether a dart is marked. Darts that the map got later are not.
    pub fn contains(&self, dart: Dart) -> bool {
        self.bits.get(dart.index() / 64).is_some_and(|word| word >> (dart.index() % 64) & 1 == 1)
    }

    /// Marks a dart; returns whether it was not.
    pub fn insert(&mut self, dart: Dart) -> bool {
        let (word, bit) = (dart.index() / 64, 1u64 << (dart.index() % 64));
        if word >= self.bits.len() {
            self.bits.resize(word + 1, 0);
        }
        let is_new = self.bits[word] & bit == 0;
        self.bits[word] |= bit;
        is_new
    }

    /// Takes a dart's mark off; returns whether it had one.
    pub fn remove(&mut self, dart: Dart) -> bool {
        let had = self.contains(dart);
        if had {
            self.bits[dart.index() / 64] &= !(1u64 << (dart.index() % 64));
        }
        had
    }

    /// Takes all marks off.
    pub fn clear(&mut self) {
        self.bits.fill(0);
    }

    /// How many darts are marked.
    pub fn len(&self) -> usize {
        self.bits.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether none is.
    pub fn is_empty(&self) -> bool {
        self.bits.iter().all(|word| *word == 0)
    }
}
