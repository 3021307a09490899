//! Measuring: how fast, and how right.

mod speed;
mod tracers;

pub use speed::{SpeedOptions, SpeedReport, SpeedRow, speed};
pub use tracers::{Tracer, names};
