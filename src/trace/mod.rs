//! Rays through a scene: where a point lies, what a ray meets, whether one point sees another.

mod alone;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod batch;
mod begin;
mod cells;
mod columns;
mod cost;
mod describe;
mod doubt;
mod entries;
mod finder;
mod free;
mod guess;
mod herd;
mod kernel;
mod lanes;
mod line;
mod locate;
mod meet;
mod onward;
mod packet;
mod path;
mod plan;
mod plate;
mod quick;
mod ray;
mod single;
mod step;
#[cfg(feature = "render")]
mod target;
mod through;
mod walk;

#[cfg(all(target_arch = "x86_64", feature = "render"))]
pub(crate) use avx2::fetch;
pub use batch::Starts;
pub(crate) use columns::Columns;
pub use cost::{Cost, Costs};
pub(crate) use finder::{AirGrid, Finder};
pub(crate) use guess::Guess;
pub use kernel::Kernel;
pub use locate::Place;
#[cfg(any(feature = "compile", feature = "render"))]
pub(crate) use locate::crossings;
#[cfg(feature = "compile")]
pub(crate) use locate::height;
pub(crate) use path::Prisms;
#[cfg(feature = "compile")]
pub(crate) use path::{BLURRED, to_lattice};
pub(crate) use plate::Plate;
#[cfg(feature = "compile")]
pub(crate) use plate::plate_of;
pub use ray::{Answer, Brief, Hit, NONE, Ray};
pub use single::{Start, Want};
pub(crate) use step::{Part, Shape, Split, Splits, Step, Tiles, step_of};
#[cfg(feature = "render")]
pub(crate) use target::Target;
