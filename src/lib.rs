//! enfilade: fast, accurate ray tracing of buildings.
#![deny(unsafe_code)]

#[cfg(feature = "compile")]
pub mod generate;
pub mod trace;

pub use enfilade_importers as importers;
