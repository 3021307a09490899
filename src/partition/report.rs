//! What the partition did: counts, volumes, and where things lie that a user should know of.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, Frame, Model, Role, Semantic, Untagged, UpAxis};
use glam::DVec3;
use serde::Serialize;

use super::audit::AuditReport;
use super::bodies::NotCarved;
use super::cells::{Cell, Label, NONE, Partition};
use super::moved::Repair;
use super::surfaces::SurfaceReport;
use crate::lattice::{FINE, FINE_BITS, Lattice, Point, orient};
use crate::roles::asked_role;

/// Report of a partition. Lengths, areas and volumes are in metres; places too, in the internal frame, unless
/// [`PartitionReport::to_source`] has moved them to the source's.
#[derive(Clone, Debug, Default, Serialize)]
#[non_exhaustive]
pub struct PartitionReport {
    /// One step of the lattice.
    pub lattice_step: f64,
    /// Levels at which the hull was cut, its bottom and top included.
    pub levels: Vec<f64>,
    /// Triangles of the slabs' plans before merging.
    pub columns: u64,
    /// Intervals over them, by what fills them.
    pub pieces: BTreeMap<&'static str, u64>,
    /// Cells after merging, by what fills them.
    pub cells: BTreeMap<&'static str, u64>,
    /// Cubic metres by what fills them.
    pub volumes: BTreeMap<&'static str, f64>,
    /// What the cells' volumes sum to, less the hull's volume, in six-fold cubic lattice units by 2^-24: exactly 0.
    pub volume_difference: i128,
    /// Elements of solid role that carve, and of those that do not the number by reason.
    pub carved: u64,
    /// Components of elements that do not carve, by reason.
    pub not_carved: BTreeMap<NotCarved, u64>,
    /// The same, one by one: path of the element, and the reason.
    pub not_carved_elements: Vec<(String, NotCarved)>,
    /// Unlabelled air that does not reach the exterior, the largest first.
    pub voids: Vec<VoidPlace>,
    /// Thin air joined to the rooms beside it: cubic metres in all.
    pub slivers_volume: f64,
    /// The same by room: path of the element, cubic metres.
    pub slivers: Vec<(String, f64)>,
    /// What was rounded, straightened and made level, how often and how far.
    pub repairs: Vec<Repair>,
    /// Rounding and straightening together moved no edge farther in the plan, metres.
    pub largest_displacement: f64,
    /// How much of what rays can meet is detail.
    pub detail: DetailShare,
    /// What makes the surfaces between air and matter.
    pub surfaces: SurfaceReport,
    /// What of the bodies' triangles became detail after all.
    pub audit: AuditReport,
    /// Seconds of each stage.
    #[serde(skip)]
    pub stages: Vec<(&'static str, f64)>,
}

/// How much of what rays can meet is detail: in hierarchies of boxes, and not faces of cells or inside of matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DetailShare {
    /// Triangles that are detail.
    pub triangles: u64,
    /// Their area, m2.
    pub area: f64,
    /// All triangles that rays can meet.
    pub of_triangles: u64,
    /// Their area, m2.
    pub of_area: f64,
}

/// A connected piece of void.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VoidPlace {
    /// Cubic metres.
    pub volume: f64,
    /// The box around it.
    pub bounds: [[f64; 3]; 2],
    /// Cells.
    pub cells: u64,
}

/// Voids that are told of one by one.
const MOST_VOIDS: usize = 100;

/// The word for what fills a cell.
pub fn kind(label: Label, model: &Model) -> &'static str {
    match label {
        Label::Solid(_) => "solid",
        Label::Exterior => "exterior",
        Label::Void => "void",
        Label::Air(element) => match model.elements[element.0 as usize].semantic {
            Semantic::Door | Semantic::Window | Semantic::Opening => "opening",
            Semantic::Exterior => "exterior",
            _ => "room",
        },
    }
}

impl PartitionReport {
    /// Adds what can be read off the cells.
    pub(super) fn read(&mut self, partition: &Partition, model: &Model) {
        self.lattice_step = partition.lattice.step();
        let cubic_metres = cubic_metres(&partition.lattice);
        let mut sum = 0i128;
        for cell in &partition.cells {
            let kind = kind(cell.label, model);
            let volume = six_volume(partition, cell);
            sum += volume;
            *self.cells.entry(kind).or_default() += 1;
            *self.volumes.entry(kind).or_default() += volume as f64 * cubic_metres;
        }
        let size = [0, 1, 2].map(|i| i128::from(partition.hull[1][i]) - i128::from(partition.hull[0][i]));
        self.volume_difference = sum - ((size[0] * size[1] * size[2] * 6) << FINE_BITS);
        self.voids = voids(partition, cubic_metres);
    }

    /// Adds how much of the model is detail.
    pub(super) fn share(&mut self, partition: &Partition, model: &Model, untagged: Untagged) {
        let area = |element: ElementId, triangle: u32| {
            let [a, b, c] =
                model.elements[element.0 as usize].mesh.corners(triangle as usize).map(DVec3::from);
            (b - a).cross(c - a).length() / 2.0
        };
        for &(element, triangle) in &partition.detail {
            self.detail.triangles += 1;
            self.detail.area += area(element, triangle);
        }
        for (index, element) in model.elements.iter().enumerate() {
            if matches!(asked_role(element, untagged), None | Some(Role::Solid | Role::Detail)) {
                let count = element.mesh.triangles.len() as u32;
                self.detail.of_triangles += u64::from(count);
                self.detail.of_area += (0..count).map(|t| area(ElementId(index as u32), t)).sum::<f64>();
            }
        }
    }

    /// The same with all places in the source's own frame and unit.
    pub fn to_source(&self, frame: &Frame) -> PartitionReport {
        let mut report = self.clone();
        let up = if frame.up == UpAxis::Y { 1 } else { 2 };
        for level in &mut report.levels {
            *level = frame.point_to_source([0.0, 0.0, *level])[up];
        }
        for void in &mut report.voids {
            let [a, b] = void.bounds.map(|corner| frame.point_to_source(corner));
            void.bounds = [[0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))];
        }
        for place in &mut report.surfaces.places {
            place.at = frame.point_to_source(place.at);
        }
        report
    }
}

/// What a unit of [`six_volume`] is, m3.
pub(super) fn cubic_metres(lattice: &Lattice) -> f64 {
    lattice.step().powi(3) / 6.0 / FINE as f64
}

/// Six times the volume of a cell, in cubic lattice units by 2^-24: exact.
pub fn six_volume(partition: &Partition, cell: &Cell) -> i128 {
    let (floor, ceiling) = (&partition.planes[cell.floor as usize], &partition.planes[cell.ceiling as usize]);
    let corners: Vec<Point> = partition.footprint(cell).collect();
    let mut volume = 0;
    for pair in corners.windows(2).skip(1) {
        let triangle = [corners[0], pair[0], pair[1]];
        let height: i128 =
            triangle.iter().map(|&p| i128::from(ceiling.height(p)) - i128::from(floor.height(p))).sum();
        volume += i128::from(orient(triangle[0], triangle[1], triangle[2])) * height;
    }
    volume
}

/// The connected pieces of void, the largest first.
fn voids(partition: &Partition, cubic_metres: f64) -> Vec<VoidPlace> {
    let mut seen = vec![false; partition.cells.len()];
    let mut places = Vec::new();
    for first in 0..partition.cells.len() {
        if seen[first] || partition.cells[first].label != Label::Void {
            continue;
        }
        seen[first] = true;
        let mut waiting = vec![first];
        let mut place =
            VoidPlace { volume: 0.0, bounds: [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], cells: 0 };
        while let Some(c) = waiting.pop() {
            let cell = &partition.cells[c];
            place.cells += 1;
            place.volume += six_volume(partition, cell) as f64 * cubic_metres;
            for p in partition.footprint(cell) {
                for plane in [cell.floor, cell.ceiling] {
                    let z = partition.planes[plane as usize].height(p) as f64 / FINE as f64;
                    let at = partition.lattice.metres([f64::from(p.x), f64::from(p.y), z]);
                    for (axis, c) in at.into_iter().enumerate() {
                        place.bounds[0][axis] = place.bounds[0][axis].min(c);
                        place.bounds[1][axis] = place.bounds[1][axis].max(c);
                    }
                }
            }
            for beyond in partition.neighbours(cell) {
                if beyond != NONE
                    && partition.cells[beyond as usize].label == Label::Void
                    && !std::mem::replace(&mut seen[beyond as usize], true)
                {
                    waiting.push(beyond as usize);
                }
            }
        }
        places.push(place);
    }
    places.sort_by(|a, b| {
        b.volume
            .total_cmp(&a.volume)
            .then(a.bounds[0].partial_cmp(&b.bounds[0]).unwrap_or(std::cmp::Ordering::Equal))
    });
    places.truncate(MOST_VOIDS);
    places
}
