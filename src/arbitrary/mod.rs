//! Strategies for property tests, and what must hold of what they make (feature `proptest`).
//!
//! [`assemblies`] are small models that are degenerate on purpose; [`steps`] and [`maps`] make generalized maps by whatever is done
//! to one; [`drawings`] are generated buildings, and [`damage`] what a tool's export may do to one. [`check_cells`] finds what
//! a partition may never be; what its map may never be, [`examine`](crate::validate::examine) finds.
//!
//! All of it shrinks: to few elements, few steps, no damage.
//!
//! ```
//! use enfilade::arbitrary::{assemblies, check_cells};
//! use enfilade::partition::{PartitionOptions, partition};
//! use proptest::prelude::*;
//!
//! proptest!(ProptestConfig::with_cases(4), |(assembly in assemblies())| {
//!     let (cells, report) = partition(&assembly.model(), &PartitionOptions::default()).unwrap();
//!     let findings = check_cells(&cells, report.largest_displacement);
//!     prop_assert!(findings.is_empty(), "{findings:?}");
//! });
//! ```

mod assembly;
mod check;
mod damage;
mod maps;
mod shape;

pub use assembly::{Assembly, CLASSES, Defect, Piece, Relation, assemblies};
pub use check::{Finding, Space, check_cells, cosine};
pub use damage::{damage, drawings};
pub use maps::{Outcome, Step, maps, steps};
pub use shape::{Mesh, Shape};
