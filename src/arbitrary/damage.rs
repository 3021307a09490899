//! Generated buildings, and what exports do to them.

use proptest::prelude::*;

use crate::generate::{Building, OfficeOptions, Style, Unit, random};

/// Generated buildings, of one to four storeys, exact and with a known truth: [`crate::generate::random`] of any seed, unfurnished. They
/// do not shrink.
pub fn drawings() -> impl Strategy<Value = Building> {
    any::<u64>().no_shrink().prop_map(|seed| {
        let mut options = OfficeOptions::default();
        (options.seed, options.furniture) = (seed, false);
        random(&options)
    })
}

/// What an export may do to a building: some of the oddities, each done to none, some or all of the elements. Shrinks to
/// [`Style::exact`], one oddity after the other.
pub fn damage() -> impl Strategy<Value = Style> {
    let shares = prop::collection::vec(share(), Style::exact().shares_mut().len());
    let whole = prop::array::uniform4(prop::bool::weighted(0.25));
    let unit = prop_oneof![6 => Just(Unit::Metre), 1 => Just(Unit::Centimetre), 1 => Just(Unit::Millimetre)];
    (any::<u64>(), shares, whole, unit).prop_map(|(seed, shares, whole, unit)| {
        let mut style = Style::exact();
        style.seed = seed;
        for ((_, share), drawn) in style.shares_mut().into_iter().zip(shares) {
            *share = drawn;
        }
        [style.storey_spaces, style.off_grid, style.turned, style.far] = whole;
        style.unit = unit;
        style
    })
}

fn share() -> impl Strategy<Value = f64> {
    prop_oneof![6 => Just(0.0), 2 => 0.0..1.0f64, 1 => Just(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::{RngSeed, TestRunner};

    fn runner() -> TestRunner {
        TestRunner::new(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })
    }

    #[test]
    fn every_oddity_comes_up_and_goes_away() {
        let mut runner = runner();
        let names: Vec<&str> = Style::exact().shares_mut().into_iter().map(|(name, _)| name).collect();
        let mut met = vec![0; names.len()];
        for _ in 0..200 {
            let mut tree = damage().new_tree(&mut runner).unwrap();
            let mut style = tree.current();
            style
                .shares_mut()
                .iter()
                .zip(&mut met)
                .for_each(|((_, share), met)| *met += i32::from(**share > 0.0));
            while tree.simplify() {}
            assert_eq!(tree.current(), Style::exact());
        }
        assert!(met.iter().all(|&met| met > 20), "{names:?} {met:?}");
    }

    #[test]
    fn drawings_differ() {
        let mut runner = runner();
        let [one, other] = [(); 2].map(|()| drawings().new_tree(&mut runner).unwrap().current().to_glb());
        assert!(one != other);
    }
}
