//! Whether the map is one of balls that fill a ball.

use super::{Code, Finding};
use crate::building::Building;
use crate::gmap::{Dart, Defect, Orbit};
use crate::partition::cells::{Label, NONE};

/// No more findings of one code are listed than this.
const MOST: usize = 100;

pub(super) fn check(building: &Building) -> Vec<Finding> {
    let map = &building.topology.map;
    let finding = |code: Code, dart: Dart, text: String| {
        let volume = building.topology.cell_of.get(dart.index()).and_then(|&cell| building.label(cell));
        let element = match volume {
            Some(Label::Air(element) | Label::Solid(element)) => Some(element),
            _ => None,
        };
        let vertex = building.topology.vertex_of.get(dart.index()).copied().unwrap_or(0);
        let at = building.topology.points.get(vertex as usize).copied().unwrap_or_default();
        building.finding(code, element, building.lattice.metres(at), 0.0, text)
    };
    let mut findings: Vec<Finding> = map
        .defects()
        .take(MOST)
        .map(|defect| {
            let code = if matches!(defect, Defect::NotAnInvolution { .. }) { Code::T01 } else { Code::T02 };
            finding(code, defect.dart(), defect.to_string())
        })
        .collect();
    let open = (0..3).flat_map(|i| map.free(i).map(move |dart| (i, dart)));
    findings.extend(
        open.take(MOST).map(|(i, dart)| finding(Code::T03, dart, format!("{dart}: alpha {i} is free"))),
    );
    if !findings.is_empty() {
        // What follows walks along alphas.
        return findings;
    }
    let shapes = map.shapes();
    if shapes.len() != building.volumes.len() {
        let text = format!("{} volumes in the map, {} known", shapes.len(), building.volumes.len());
        findings.extend(map.darts().next().map(|dart| finding(Code::T05, dart, text)));
    }
    let no_balls = shapes.iter().filter(|(_, shape)| !shape.is_ball());
    let told =
        no_balls.take(MOST).map(|(dart, shape)| finding(Code::T04, *dart, format!("{dart}: {shape:?}")));
    findings.extend(told);
    if let Some(dart) = map.darts().next() {
        if map.count(Orbit::Component) != 1 {
            findings.push(finding(Code::T05, dart, "it has several components".to_owned()));
        }
        if map.orientation(Orbit::Component, dart).is_none() {
            findings.push(finding(Code::T05, dart, "it is not orientable".to_owned()));
        }
        let euler = map.euler();
        if euler != 1 {
            let text = format!("vertices - edges + faces - volumes is {euler}, of a ball 1");
            findings.push(finding(Code::T05, dart, text));
        }
    }
    let wrong =
        building.topology.faces.iter().filter(|face| map.is_free(3, face.dart) != (face.other == NONE));
    findings.extend(wrong.take(MOST).map(|face| {
        let text = format!("{}: a face of volumes {} and {}", face.dart, face.one, face.other);
        finding(Code::T06, face.dart, text)
    }));
    findings
}
