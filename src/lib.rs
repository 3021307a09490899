//! enfilade: fast, accurate ray tracing of buildings.
//!
//! A model of a building, one mesh per element with a tag, is imported ([`importers`]), compiled (`compile`) to a scene
//! file, opened as a [`Scene`] and traced ([`trace`]). Pictures come from `render`, the truth from `oracle`, and `verify`
//! compares answers with it.
//!
//! ```no_run
//! # #[cfg(all(feature = "gltf", feature = "obj", feature = "compile", feature = "render"))]
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use enfilade::importers::{ImportOptions, import};
//! use enfilade::render::{RenderOptions, auto_view, render, write_png};
//! use enfilade::{Answer, CompileOptions, Ray, compile};
//!
//! let model = import("house.glb".as_ref(), &ImportOptions::default())?;
//! let scene = compile(&model, &CompileOptions::default())?.scene();
//! match scene.trace(&Ray::new([2.0, 3.0, 1.6], [1.0, 0.0, 0.0])) {
//!     Answer::Hit(hit) => println!("{} m to {}", hit.t, scene.element(hit.element).id()),
//!     Answer::Escaped => println!("out into the open"),
//!     Answer::InSolid(element) => println!("starts inside {}", scene.element(element).id()),
//! }
//! let picture = render(&scene, &auto_view(&scene), &RenderOptions::default())?;
//! write_png(&picture, "house.png".as_ref())?;
//! # Ok(())
//! # }
//! # #[cfg(not(all(feature = "gltf", feature = "obj", feature = "compile", feature = "render")))]
//! # fn main() {}
//! ```
//!
//! **Frames.** Everything here is in the internal frame: metres, Z up, the offset of a far model taken off.
//! [`Scene::frame`] leads to the model's own frame and back. (The command line does that for its users.)
//!
//! **Right.** An answer is right if it is the exact answer to some parallel ray at most the tolerance away, by default
//! 1 mm; the truth is the nearest hit with the model's own triangles, in f64. `oracle::right` has it in full.
//!
//! **Many rays** go from the caller's slice to the caller's slice ([`Scene::trace_many`]), with the feature `rayon` on
//! the current pool, eight at a time: give rays that go together one after the other. Where many rays start in the same air,
//! [`Scene::trace_many_from`] looks it up but once, and [`Scene::trace_brief_many`] is the fastest way to ask; rays that go on from a hit start
//! at [`Start::Hit`]. A [`Scene`] is immutable: share it among threads by reference.
//!
//! **Long calls** take options with limits on memory, a progress callback and a token to cancel them
//! ([`importers::Limits`], [`importers::Watch`]). The library prints nothing and has no globals, and no file makes it
//! panic.
//!
//! Without default features there are [`scene`], [`trace`] and [`mod@format`]: to open compiled scenes, to locate points and
//! to trace rays.
#![deny(unsafe_code)]

// The README's program compiles, too.
#[cfg(all(doctest, feature = "gltf", feature = "obj", feature = "compile", feature = "render"))]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(any(feature = "proptest", all(test, feature = "compile")))]
pub mod arbitrary;
#[cfg(feature = "render")]
pub mod beam;
#[cfg(all(feature = "compile", feature = "render"))]
pub mod bench;
#[cfg(feature = "compile")]
pub mod building;
mod clip;
pub mod closing;
#[cfg(feature = "compile")]
pub mod compile;
#[cfg(feature = "compile")]
pub mod components;
#[cfg(feature = "compile")]
pub mod derive;
#[cfg(feature = "compile")]
pub mod export;
pub mod format;
#[cfg(feature = "compile")]
pub mod generate;
#[cfg(feature = "compile")]
pub mod gmap;
pub mod graph;
#[cfg(feature = "compile")]
pub mod inspect;
#[cfg(feature = "compile")]
pub mod lattice;
mod mask;
#[cfg(feature = "compile")]
pub mod oracle;
#[cfg(feature = "render")]
pub mod packets;
mod parallel;
#[cfg(feature = "compile")]
pub mod partition;
#[cfg(feature = "render")]
pub mod plan;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "compile")]
pub mod roles;
#[cfg(all(test, feature = "compile"))]
mod samples;
pub mod scene;
#[cfg(feature = "compile")]
pub mod sew;
#[cfg(feature = "compile")]
mod shells;
#[cfg(feature = "compile")]
mod splitmix;
#[cfg(feature = "compile")]
pub mod stress;
pub mod trace;
#[cfg(feature = "compile")]
pub mod validate;
#[cfg(feature = "compile")]
pub mod verify;

#[cfg(feature = "compile")]
pub use compile::{CompileError, CompileOptions, Compiled, compile, compile_building, compile_partition};
pub use enfilade_importers as importers;
pub use scene::{OpenError, Scene};
pub use trace::{Answer, Brief, Cost, Costs, Hit, Kernel, NONE, Place, Ray, Start, Starts, Want};
#[cfg(feature = "compile")]
pub use verify::{VerifyOptions, VerifyReport, verify};
