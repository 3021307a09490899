//! What the tests of both crates and the fuzz targets share. It uses nothing of the crates it helps to test.
#![forbid(unsafe_code)]

pub mod glb;
mod random;
pub mod wall;

pub use random::Random;
