//! What the fuzz targets share: what each input goes through, seeds to start from, and mutators that keep a file's
//! outer form right so that its inner one is reached. `docs/FUZZING.md` tells how to run the targets.
#![forbid(unsafe_code)]

pub mod ask;
pub mod enf;
pub mod glb;
pub mod json;
pub mod model;
pub mod numbers;
pub mod obj;
pub mod rules;
pub mod seeds;
pub mod truth;

use enfilade::importers::{ImportOptions, Limits};

/// The file's name in errors.
pub const FILE: &str = "fuzzed";

/// Memory that an import may take here, bytes: little, so that honest refusals are quick, and so that libFuzzer's own
/// limit, far above it, is passed only by what is not accounted for.
pub const MEMORY: u64 = 16 << 20;

/// Elements that a model may have here.
pub const ELEMENTS: u64 = 1000;

/// The limits of all targets.
pub fn limits() -> Limits {
    Limits::default().with_max_memory(MEMORY).with_max_elements(ELEMENTS)
}

/// Options with these limits.
pub fn options() -> ImportOptions {
    // It cannot be written as a literal outside its crate.
    let mut options = ImportOptions::default();
    options.limits = limits();
    options
}
