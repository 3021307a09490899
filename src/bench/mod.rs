//! Measuring: how fast, how right, what is skipped, and what becomes of it in buildings that are drawn badly.

mod cells;
mod error;
mod frozen;
mod plot;
mod robust;
mod skip;
mod sources;
mod speed;
mod table;
mod tracers;
mod way;

pub use cells::{CrossingOptions, Crossings, crossings};
pub use error::{
    Compare, ErrorFailure, ErrorOptions, ErrorReport, ErrorRow, Errors, ImageError, Spread, error,
};
pub use frozen::{FrozenError, FrozenScene};
pub use robust::{Damage, RobustError, RobustOptions, RobustReport, RobustRow, robust};
pub use skip::{SkipError, SkipOptions, SkipReport, SkipRow, Steps, Work, skip};
pub use sources::{SourceOptions, SourceReport, SourceRow, sources};
pub use speed::{SpeedOptions, SpeedReport, SpeedRow, speed};
pub use tracers::{Tracer, error_names, names};
pub use way::{Answered, Way};
