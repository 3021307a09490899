//! enfilade: fast, accurate ray tracing of buildings.
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
