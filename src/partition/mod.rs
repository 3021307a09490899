//! The partition of space into labelled convex prisms.
//!
//! `docs/PARTITION.md` tells the method. In short: the hull is cut at a few levels into *slabs*; in each slab the edges
//! of all faces that are not vertical are projected to the plan and rounded until nothing crosses ([`snap`]); over each
//! triangle of the plan the faces stand in order of height: a *column* with a stack of intervals; columns merge into
//! *cells*: prisms with a convex footprint, one floor plane and one ceiling plane.

pub mod audit;
mod bodies;
mod boxes;
pub mod cells;
mod columns;
mod convex;
mod crossings;
mod faces;
mod labels;
pub mod matter;
mod plan;
mod shapes;
mod slabs;
pub mod surfaces;
#[cfg(test)]
mod testing;
