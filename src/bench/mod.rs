//! Measuring: how fast, and how right.

mod cells;
mod error;
mod frozen;
mod speed;
mod tracers;
mod way;

pub use cells::{CrossingOptions, Crossings, crossings};
pub use error::{ErrorFailure, ErrorOptions, ErrorReport, ErrorRow, Errors, ImageError, Spread, error};
pub use frozen::{FrozenError, FrozenScene};
pub use speed::{SpeedOptions, SpeedReport, SpeedRow, speed};
pub use tracers::{Tracer, error_names, names};
pub use way::Way;
