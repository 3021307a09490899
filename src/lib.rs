//! enfilade: fast, accurate ray tracing of buildings.
#![deny(unsafe_code)]

pub mod trace;

pub use enfilade_importers as importers;
