//! enfilade: fast, accurate ray tracing of buildings.
//!
//! A model is imported ([`importers`]), compiled ([`compile`]) to a scene file, opened as a [`Scene`] and traced
//! ([`trace`]); pictures come from `render`, the truth from `oracle`, and `verify` compares the two. Everything works in
//! the internal frame: metres, Z up, the offset of a far model taken off ([`Scene::frame`] leads back).
//!
//! ```no_run
//! use enfilade::{Answer, Ray, Scene};
//!
//! let scene = Scene::open("house.enf".as_ref())?;
//! match scene.trace(&Ray::new([2.0, 3.0, 1.6], [1.0, 0.0, 0.0])) {
//!     Answer::Hit(hit) => println!("{} m to {}", hit.t, scene.element(hit.element).id()),
//!     Answer::Escaped => println!("out into the open"),
//!     Answer::InSolid(element) => println!("inside {}", scene.element(element).id()),
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The library prints nothing, has no globals, and takes the caller's rayon pool.
#![deny(unsafe_code)]

#[cfg(all(feature = "compile", feature = "render"))]
pub mod bench;
#[cfg(feature = "compile")]
pub mod compile;
#[cfg(feature = "compile")]
pub mod components;
pub mod format;
#[cfg(feature = "compile")]
pub mod generate;
#[cfg(feature = "compile")]
pub mod inspect;
#[cfg(feature = "compile")]
pub mod oracle;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "compile")]
pub mod roles;
pub mod scene;
pub mod trace;
#[cfg(feature = "compile")]
pub mod verify;

#[cfg(feature = "compile")]
pub use compile::{CompileError, CompileOptions, Compiled, compile};
pub use enfilade_importers as importers;
pub use scene::{OpenError, Scene};
pub use trace::{Answer, Cost, Hit, Kernel, NONE, Place, Ray, Start, Want};
#[cfg(feature = "compile")]
pub use verify::{VerifyOptions, VerifyReport, verify};
