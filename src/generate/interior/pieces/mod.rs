//! Furniture of public buildings, composed of boxes like the [house's](crate::generate::furniture): each piece in
//! its own frame, metres, its back at v = 0.

mod seating;
mod service;
mod storage;
mod wall;
mod work;

pub use seating::*;
pub use service::*;
pub use storage::*;
pub use wall::*;
pub use work::*;
