//! What must hold whatever the model is.

mod sides;
mod space;
mod structure;

use crate::partition::cells::Partition;

pub use space::{Finding, Space, cosine};

/// Checks cells against each other, without the model: their volumes sum to the hull's, exactly; footprints are exactly convex;
/// no ceiling lies below its floor; what one side has of a neighbour, the neighbour's has of it; floors lie on ceilings without
/// gaps; unlabelled air is exterior where it hangs together with the hull's outside, void elsewhere.
///
/// `displacement` is what the partition reports as its [largest](crate::partition::PartitionReport::largest_displacement), metres:
/// what is no wider than that can do is rounding.
///
/// # Panics
/// If an index is not there, or a cell has no corners: [`Partition::check`] tells.
pub fn check_cells(partition: &Partition, displacement: f64) -> Vec<Finding> {
    structure::check(&Space::new(partition), partition.lattice.steps(displacement))
}
