//! Semantically tagged building models, from glTF 2.0 and Wavefront OBJ, as one [`Model`]: elements with f64
//! triangles in metres, Z up.
//!
//! ```no_run
//! use enfilade_importers::{ImportOptions, import};
//!
//! let model = import("house.glb".as_ref(), &ImportOptions::default())?;
//! for element in &model.elements {
//!     println!("{} {} {}", element.id, element.semantic, element.mesh.triangles.len());
//! }
//! # Ok::<(), enfilade_importers::ImportError>(())
//! ```
//!
//! [`Model`] and [`ModelBuilder`] need no parser: without the features `gltf`, `obj` and `rules` this crate holds
//! just them, for programs that make models of their own.
#![forbid(unsafe_code)]

mod builder;
mod error;
#[cfg(any(feature = "gltf", feature = "obj"))]
mod folder;
mod frame;
mod limits;
mod model;
mod semantic;
#[cfg(any(feature = "gltf", feature = "obj"))]
mod texture;
mod watch;

#[cfg(feature = "gltf")]
pub mod gltf;
mod import;
#[cfg(feature = "obj")]
pub mod obj;
#[cfg(feature = "rules")]
pub mod tagging;

pub use builder::{ModelBuilder, NewElement};
pub use error::{ImportError, ImportErrorKind};
pub use frame::{Frame, UpAxis};
#[cfg(all(feature = "rules", feature = "gltf", feature = "obj"))]
pub use import::import;
pub use import::{Format, ImportOptions};
pub use limits::{Budget, Limits, OverBudget};
pub use model::{
    Camera, Element, ElementId, LeftOut, LeftOutReason, Light, LightKind, Material, MaterialId, Mesh, Model,
    TagSource, Warning,
};
pub use semantic::{Role, Semantic, UnknownWord, Untagged};
pub use watch::{CancelToken, Cancelled, Watch};
