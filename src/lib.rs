//! enfilade: fast, accurate ray tracing of buildings.
#![deny(unsafe_code)]

#[cfg(feature = "compile")]
pub mod oracle;
pub mod trace;
#[cfg(feature = "compile")]
pub mod verify;

pub use enfilade_importers as importers;
