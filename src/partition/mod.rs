//! The partition of space into labelled convex prisms.
//!
//! `docs/PARTITION.md` tells the method. In short: the hull is cut at a few levels into *slabs*; in each slab the edges
//! of all faces that are not vertical are projected to the plan and rounded until nothing crosses ([`snap`]); over each
//! triangle of the plan the faces stand in order of height: a *column* with a stack of intervals; columns merge into
//! *cells*: prisms with a convex footprint, one floor plane and one ceiling plane.

pub mod cells;
pub mod convex;
pub mod straighten;
