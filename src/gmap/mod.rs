//! Generalized maps of dimension 3.
//!
//! A 3-dimensional generalized map is a set of *darts* with four involutions, alpha 0 to alpha 3 (Lienhardt,
//! "N-dimensional generalized combinatorial maps and cellular quasi-manifolds", 1994; Damiand and Lienhardt,
//! "Combinatorial Maps", 2014). A dart is one vertex of one edge of one face of one volume; alpha i leads to the dart
//! that differs in the vertex, edge, face or volume alone. A dart that alpha i leads to itself is *i-free*: there is
//! nothing beyond.
//!
//! For all darts alpha 0 alpha 2, alpha 0 alpha 3 and alpha 1 alpha 3 must be involutions as well: what is glued is
//! glued along whole edges and faces. [`GMap::sew`], removal and insertion keep that; [`GMap::link`] does not ask.
//! [`GMap::check`] tells.
//!
//! There are no coordinates and no meanings here: those belong to whoever owns the map, by dart or by cell
//! ([`GMap::index`]).

mod build;
mod check;
mod dart;
mod edit;
mod marks;
mod orbit;
mod sew;
#[cfg(test)]
mod tests;

pub use check::{Defect, Shape};
pub use dart::{Dart, GMap};
pub use edit::EditError;
pub use marks::Marks;
pub use orbit::{CellIndex, Orbit};
pub use sew::{SewError, Sewing};
