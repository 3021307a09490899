//! Whether volumes are convex prisms that fill the hull.

use super::{Code, Finding, known};
use crate::building::{Building, Volume};
use crate::lattice::{FINE, Point, orient};
use crate::partition::cells::{Label, NONE};
use crate::partition::convex::is_convex;
use crate::partition::six_volume;
use crate::sew::{Sewn, Way};

/// Vertices are f64, and no farther off planes than this by that, lattice steps.
const ROUNDING: f64 = 1e-3;

pub(super) fn check(building: &Building) -> Vec<Finding> {
    let mut findings = Vec::new();
    for volume in &building.volumes {
        let corners = building.footprints.get(volume.footprint.start as usize..volume.footprint.end as usize);
        if !corners.is_some_and(turns) {
            findings.push(about(building, volume, Code::G01, "its footprint is not convex".to_owned()));
        }
    }
    if !findings.is_empty() {
        return findings;
    }
    let cells = match building.cells() {
        Ok(cells) => cells,
        Err(error) => {
            let text = error.to_string();
            let volume = building.volumes.get(error.volume as usize);
            return vec![match volume {
                Some(volume) => about(building, volume, Code::G02, text),
                None => building.finding(Code::G02, None, [0.0; 3], 0.0, text),
            }];
        }
    };
    let sum: i128 = cells.cells.iter().map(|cell| six_volume(&cells, cell)).sum();
    let [x, y, z] = [0, 1, 2].map(|i| i128::from(building.hull[1][i]) - i128::from(building.hull[0][i]));
    let missing = 6 * i128::from(FINE) * x * y * z - sum;
    if missing != 0 && !building.volumes.is_empty() {
        let size = missing as f64 / 6.0 / FINE as f64 * building.lattice.step().powi(3);
        let at = building.lattice.metres([0, 1, 2].map(|i| f64::from(building.hull[0][i])));
        findings.push(building.finding(
            Code::G03,
            None,
            at,
            size,
            "volumes do not sum to the hull's".to_owned(),
        ));
    }
    if findings.is_empty() {
        findings.extend(off_hull(building));
    }
    findings.extend(off_planes(building));
    findings.extend(known::areas(building));
    findings
}

/// Whether a polygon is convex, counter-clockwise, and turns at each corner.
fn turns(corners: &[Point]) -> bool {
    let at = |i: usize| corners[i % corners.len()];
    is_convex(corners) && (0..corners.len()).all(|i| orient(at(i), at(i + 1), at(i + 2)) != 0)
}

/// The first face that is on the hull's surface and has something beyond it, or is not and has nothing.
fn off_hull(building: &Building) -> Option<Finding> {
    let is_off = |face: &&Sewn| (face.other == NONE) != is_on_hull(building, face.way);
    let face = building.topology.faces.iter().find(is_off)?;
    let at = building.topology.points[building.topology.vertex_of[face.dart.index()] as usize];
    let text = format!("a face of volumes {} and {} is not where the hull ends", face.one, face.other);
    Some(building.finding(Code::G03, None, building.lattice.metres(at), 0.0, text))
}

/// Whether a face lies on the hull's surface.
fn is_on_hull(building: &Building, way: Way) -> bool {
    let [lo, hi] = building.hull;
    match way {
        Way::Ceiling(plane) | Way::Floor(plane) => building.planes.get(plane as usize).is_some_and(|plane| {
            plane.is_level() && [lo[2], hi[2]].iter().any(|&z| plane.r == i64::from(z) * FINE)
        }),
        Way::Upright([a, b]) => (0..2).any(|axis| {
            let [p, q] = [a, b].map(|p| if axis == 0 { p.x } else { p.y });
            p == q && (p == lo[axis] || p == hi[axis])
        }),
    }
}

/// The vertex that is farthest off a plane of its faces, if that is farther than heights that were made one lie apart.
fn off_planes(building: &Building) -> Option<Finding> {
    let topology = &building.topology;
    let mut worst = (ROUNDING, None);
    for face in &topology.faces {
        for dart in topology.map.around_face(face.dart) {
            let at = topology.points[topology.vertex_of[dart.index()] as usize];
            let off = match face.way {
                Way::Ceiling(plane) | Way::Floor(plane) => {
                    let plane = &building.planes[plane as usize];
                    (at[2] - plane.height_f64(at[0], at[1])).abs() - topology.joined.1
                }
                Way::Upright([a, b]) => {
                    let [dx, dy] = [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
                    let cross = dx * (at[1] - f64::from(a.y)) - dy * (at[0] - f64::from(a.x));
                    cross.abs() / dx.hypot(dy)
                }
            };
            if off > worst.0 {
                worst = (off, Some((face, at)));
            }
        }
    }
    let (off, Some((face, at))) = worst else { return None };
    let size = off * building.lattice.step();
    let text = format!("a vertex of the face of volumes {} and {} is off its plane", face.one, face.other);
    Some(building.finding(Code::G04, None, building.lattice.metres(at), size, text))
}

fn about(building: &Building, volume: &Volume, code: Code, text: String) -> Finding {
    let element = match volume.label {
        Label::Air(element) | Label::Solid(element) => Some(element),
        Label::Exterior | Label::Void => None,
    };
    let vertex = building.topology.vertex_of.get(volume.dart.index()).copied().unwrap_or(0);
    let at = building.topology.points.get(vertex as usize).copied().unwrap_or_default();
    building.finding(code, element, building.lattice.metres(at), 0.0, text)
}
