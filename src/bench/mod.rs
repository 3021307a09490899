//! Measuring: how fast, and how right.

mod cells;
mod error;
mod frozen;
mod speed;
mod tracers;

pub use cells::{CrossingOptions, Crossings, crossings};
pub use error::{ErrorOptions, ErrorReport, ErrorRow, OtherModel, error};
pub use frozen::{FrozenError, FrozenScene};
pub use speed::{SpeedOptions, SpeedReport, SpeedRow, speed};
pub use tracers::{Tracer, names};
