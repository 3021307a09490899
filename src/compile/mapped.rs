//! From a partition to the building's map, and from the map to the cells that the scene is made of.

use std::time::Instant;

use enfilade_importers::{Budget, Model};

use super::{CompileError, CompileOptions, Stage};
use crate::building::{Building, NamedCells};
use crate::format::MapTables;
use crate::format::map::{DartRecord, MapFaceRecord};
use crate::partition::cells::Partition;
use crate::validate::{Report, Validated, validate};

/// Bytes of the map for each part of a cell's surface that the partition knows: some ten darts, with all that is kept of each
/// while the map is made.
const BYTES_A_PART: usize = 1024;

/// The building that a model is, its space being cut by `partition`, which is no longer needed then.
pub(super) fn building(
    model: &Model,
    partition: Partition,
    options: &CompileOptions,
) -> Result<(Building, Stage), CompileError> {
    options.watch.check()?;
    let start = Instant::now();
    let parts = (partition.faces.len() + partition.covers.len()) as u64;
    Budget::new(&options.limits).take_items(parts, BYTES_A_PART, "the map of the building")?;
    let building =
        Building::new(model, &partition).map_err(|error| CompileError::Partition(error.to_string()))?;
    let stage = Stage { name: "map", seconds: start.elapsed().as_secs_f64() };
    options.watch.report(stage.name, 1.0);
    Ok((building, stage))
}

/// The building, if a scene can be made of it, and all that is not as it should be.
pub(super) fn valid(
    building: Building,
    options: &CompileOptions,
) -> Result<(Validated<Building>, Report, Stage), CompileError> {
    options.watch.check()?;
    let start = Instant::now();
    let (valid, report) = validate(building);
    let stage = Stage { name: "validation", seconds: start.elapsed().as_secs_f64() };
    options.watch.report(stage.name, 1.0);
    let Some(valid) = valid else {
        let first = report.findings.first();
        let what = first.map_or(String::new(), |first| format!("{}: {}", first.code.name(), first.text));
        return Err(CompileError::Partition(what));
    };
    Ok((valid, report, stage))
}

/// The map of a building as sections of a file.
pub(super) fn stored(
    building: &Validated<Building>,
    options: &CompileOptions,
) -> Result<MapTables, CompileError> {
    let building = building.get();
    let mut budget = Budget::new(&options.limits);
    let darts = building.topology.map.table_len() as u64;
    budget.take_items(darts, 2 * size_of::<DartRecord>(), "the stored map of the building")?;
    let faces = building.faces.len() as u64;
    budget.take_items(faces, 2 * size_of::<MapFaceRecord>(), "the stored map of the building")?;
    Ok(building.to_tables())
}

/// The cells of a building.
pub(super) fn cells(
    building: &Validated<Building>,
    options: &CompileOptions,
) -> Result<(NamedCells, Stage), CompileError> {
    options.watch.check()?;
    let start = Instant::now();
    let cells = building.get().named_cells().map_err(|error| CompileError::Partition(error.to_string()))?;
    let stage = Stage { name: "cells of the map", seconds: start.elapsed().as_secs_f64() };
    options.watch.report(stage.name, 1.0);
    Ok((cells, stage))
}
