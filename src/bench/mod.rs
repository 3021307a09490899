//! Measuring: how fast, and how right.

mod tracers;

pub use tracers::{Tracer, names};
