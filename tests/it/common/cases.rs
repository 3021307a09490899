//! How many random cases a test tries.

use proptest::test_runner::{Config, RngSeed};

/// So many, always the same; or as many as the environment asks for (`PROPTEST_CASES`), at random.
pub fn cases(few: u32) -> Config {
    let config = Config { failure_persistence: None, ..Config::default() };
    match std::env::var_os("PROPTEST_CASES") {
        // What does not count may be as much again.
        Some(_) => Config { max_global_rejects: config.cases, ..config },
        None => Config { cases: few, rng_seed: RngSeed::Fixed(1), ..config },
    }
}
