//! Whether the map is one of balls that fill a ball.

use super::{Code, Finding};
use crate::building::Building;
use crate::gmap::{Dart, Defect, GMap, Orbit};
use crate::parallel;
use crate::partition::cells::{Label, NONE};

/// No more findings of one code are listed than this.
const MOST: usize = 100;

/// What a map is like as a whole.
struct Whole {
    components: usize,
    is_orientable: bool,
    euler: i64,
}

impl Whole {
    fn of(map: &GMap) -> Whole {
        let first = map.darts().next();
        let orient = || first.is_none_or(|dart| map.orientation(Orbit::Component, dart).is_some());
        let ((components, is_orientable), euler) =
            parallel::both(|| (map.count(Orbit::Component), orient()), || map.euler());
        Whole { components, is_orientable, euler }
    }
}

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
    let (shapes, whole) = parallel::both(|| map.shapes(), || Whole::of(map));
    if shapes.len() != building.volumes.len() {
        let text = format!("{} volumes in the map, {} known", shapes.len(), building.volumes.len());
        findings.extend(map.darts().next().map(|dart| finding(Code::T05, dart, text)));
    }
    let no_balls = shapes.iter().filter(|(_, shape)| !shape.is_ball());
    let told =
        no_balls.take(MOST).map(|(dart, shape)| finding(Code::T04, *dart, format!("{dart}: {shape:?}")));
    findings.extend(told);
    if let Some(dart) = map.darts().next() {
        if whole.components != 1 {
            findings.push(finding(Code::T05, dart, "it has several components".to_owned()));
        }
        if !whole.is_orientable {
            findings.push(finding(Code::T05, dart, "it is not orientable".to_owned()));
        }
        if whole.euler != 1 {
            let text = format!("vertices - edges + faces - volumes is {}, of a ball 1", whole.euler);
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
