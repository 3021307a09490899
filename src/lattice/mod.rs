//! The lattice: the power-of-two grid on which the structure of a building is rounded once, and exact arithmetic on it.
//!
//! A coordinate is a small integer, at most 2^24 in size, so that it is exact in f32; sides of lines are exact in i64.
//! Heights of sloped planes at lattice points are integers too, in [`FINE`] parts of a lattice unit, so that planes
//! are compared exactly.

mod grid;
mod plane;
mod point;
mod site;

pub use grid::Lattice;
pub use plane::{FINE, FINE_BITS, Plane};
pub use point::{Point, double_area, in_pixel, is_between, orient, segment_meets_pixel};
pub use site::Site;
pub(crate) use site::gcd;

/// No coordinate is larger: what f32 counts exactly.
pub const LARGEST: i32 = 1 << 24;
