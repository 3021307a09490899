//! The partition of small random buildings, degenerate on purpose: what must hold, holds.

mod building;
mod points;
mod solids;
mod space;
mod structure;
mod truth;
mod walk;

use building::Building;
use enfilade::importers::Untagged;
use enfilade::partition::partition;
use space::{Finding, Space};
use truth::{Meshes, Random};

/// All that is wrong with the partition of a building.
fn findings(building: &Building, seed: u64) -> Vec<Finding> {
    let model = building.model(false);
    let (partition, report) = match partition(&model, Untagged::default()) {
        Ok(made) => made,
        Err(error) => return vec![Finding { kind: "error", text: error.to_string() }],
    };
    let space = Space::new(&partition);
    let mut findings = structure::check(&space);
    let mut random = Random::new(seed);
    let meshes = Meshes::new(&model, &partition, &report, &mut random);
    findings.extend(points::check(&space, &meshes, &mut random));
    findings.extend(walk::check(&space, &meshes, &mut random));
    findings
}
