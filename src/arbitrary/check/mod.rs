//! What must hold whatever the model is.

mod sides;
mod space;
mod structure;

use crate::building::Building;
use crate::gmap::Orbit;
use crate::partition::cells::{NONE, Partition};

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

/// Checks a building's map: its involutions; that it is one ball, cut into as many balls as there are volumes; that nothing
/// is free but alpha 3 at the hull.
pub fn check_building(building: &Building) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut find = |kind, text| findings.push(Finding { kind, text });
    let map = &building.topology.map;
    if let Err(defect) = map.check() {
        find("no map", defect.to_string());
    }
    let volumes = map.index(Orbit::Volume);
    if volumes.len() != building.volumes.len() {
        find("volumes", format!("{} in the map, {} known", volumes.len(), building.volumes.len()));
    }
    let pieces = map.count(Orbit::Component);
    if (pieces, map.euler()) != (1, 1) {
        find("no ball", format!("{pieces} components of Euler characteristic {}", map.euler()));
    }
    for (dart, shape) in map.shapes() {
        if !shape.is_ball() {
            find("volume that is no ball", format!("at {dart}: {shape:?}"));
        }
    }
    let hull = building.topology.faces.iter().filter(|face| face.other == NONE);
    let of_hull: usize = hull.map(|face| 2 * map.around_face(face.dart).count()).sum();
    let free = [0, 1, 2, 3].map(|i| map.free(i).count());
    if free != [0, 0, 0, of_hull] {
        find("free darts", format!("{free:?}, of the hull {of_hull}"));
    }
    findings
}
