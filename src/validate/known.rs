//! Whether what is known of darts, faces and volumes is what the map has.

use std::collections::HashSet;

use enfilade_importers::ElementId;

use super::{Code, Finding};
use crate::building::Building;
use crate::gmap::{Dart, Orbit};
use crate::lattice::{LARGEST, Point};
use crate::parallel;
use crate::partition::cells::{Label, NONE};
use crate::partition::check_frame;
use crate::sew::Way;

/// No more findings are listed than this.
const MOST: usize = 100;

/// The lattice is one, tables are as long as they must be, and every number of a volume, a dart or a face is of something. What
/// follows computes with them; so it comes first.
pub(super) fn numbers(building: &Building) -> Vec<Finding> {
    let map = &building.topology.map;
    let topology = &building.topology;
    let (volumes, planes) = (building.volumes.len(), building.planes.len());
    // Without a lattice there are no metres.
    let finding = |code, text| vec![building.finding(code, None, [0.0; 3], 0.0, text)];
    if let Err(what) = check_frame(&building.lattice, building.hull, &building.planes, false) {
        return finding(Code::G02, what);
    }
    let told = |text: String| finding(Code::T07, text);
    let is_beyond = |p: &Point| [p.x, p.y].iter().any(|c| c.unsigned_abs() > LARGEST as u32);
    if building.footprints.iter().any(is_beyond) {
        return told("a corner is beyond the lattice".to_owned());
    }
    let lengths = [
        (topology.vertex_of.len(), map.table_len(), "vertices of darts"),
        (topology.cell_of.len(), map.table_len(), "volumes of darts"),
        (building.faces.len(), topology.faces.len(), "names of faces"),
    ];
    if let Some((has, needs, what)) = lengths.into_iter().find(|(has, needs, _)| has != needs) {
        return told(format!("{has} {what}, {needs} needed"));
    }
    let is_element = |label: Label| match label {
        Label::Air(element) | Label::Solid(element) => (element.0 as usize) < building.elements.len(),
        Label::Exterior | Label::Void => true,
    };
    let is_volume = |volume: u32| (volume as usize) < volumes;
    if let Some(dart) = map.darts().find(|dart| {
        let vertex = topology.vertex_of[dart.index()] as usize;
        vertex >= topology.points.len() || !is_volume(topology.cell_of[dart.index()])
    }) {
        return told(format!("{dart}: its vertex or its volume is not there"));
    }
    if let Some(i) = building.volumes.iter().position(|volume| {
        let corners = volume.footprint.start as usize..volume.footprint.end as usize;
        let is_known = (volume.floor as usize) < planes
            && (volume.ceiling as usize) < planes
            && building.footprints.get(corners).is_some()
            && map.contains(volume.dart)
            && is_element(volume.label);
        !is_known
    }) {
        return told(format!("volume {i}: its label, a plane, a corner or its dart is not there"));
    }
    let is_source = |source: u32| source == NONE || (source as usize) < building.sources.len();
    let wrong = topology.faces.iter().zip(&building.faces).position(|(face, named)| {
        let lies = match face.way {
            Way::Ceiling(plane) | Way::Floor(plane) => (plane as usize) < planes,
            Way::Upright(ends) => !ends.iter().any(is_beyond) && ends[0] != ends[1],
        };
        let is_known = lies
            && is_volume(face.one)
            && (face.other == NONE || is_volume(face.other))
            && map.contains(face.dart)
            && face.sources.iter().all(|source| is_source(*source))
            && named.element.is_none_or(|element| (element.0 as usize) < building.elements.len());
        !is_known
    });
    match wrong {
        Some(i) => {
            told(format!("face {i}: a volume, its dart, its plane, a surface or its element is not there"))
        }
        None => Vec::new(),
    }
}

/// The darts of a volume are known to be its own, those of a vertex to be at one place, and a face to be between the two
/// volumes that it is between. The map is sound.
pub(super) fn darts(building: &Building) -> Vec<Finding> {
    let topology = &building.topology;
    let map = &topology.map;
    let told = |dart: Dart, text: String| {
        let at = topology.points[topology.vertex_of[dart.index()] as usize];
        building.finding(Code::T07, None, building.lattice.metres(at), 0.0, text)
    };
    if !building.is_gathered() {
        let text = "volumes and faces by label are not those there are".to_owned();
        return vec![building.finding(Code::T07, None, [0.0; 3], 0.0, text)];
    }
    let (volumes, vertices) = parallel::both(|| map.index(Orbit::Volume), || map.index(Orbit::Vertex));
    let mut number = vec![NONE; volumes.len()];
    for (volume, i) in building.volumes.iter().zip(0..) {
        number[volumes.of(volume.dart) as usize] = i;
    }
    let vertex = |dart: Dart| topology.vertex_of[dart.index()];
    let wrong = map.darts().filter(|&dart| {
        let first = vertices.darts()[vertices.of(dart) as usize];
        topology.cell_of[dart.index()] != number[volumes.of(dart) as usize] || vertex(dart) != vertex(first)
    });
    let mut findings: Vec<Finding> = wrong
        .take(MOST)
        .map(|dart| told(dart, format!("{dart}: it is not of the volume, or not at the place, that is said")))
        .collect();
    let volume = |dart: Dart| number[volumes.of(dart) as usize];
    let wrong = topology.faces.iter().filter(|face| {
        let beyond = map.alpha(3, face.dart);
        let other = if beyond == face.dart { NONE } else { volume(beyond) };
        (face.one, face.other) != (volume(face.dart), other)
    });
    let text =
        |face: &crate::sew::Sewn| format!("a face is said to be of volumes {} and {}", face.one, face.other);
    findings.extend(wrong.take(MOST - findings.len()).map(|face| told(face.dart, text(face))));
    findings
}

/// Areas are those of the corners, but for roundings.
pub(super) fn areas(building: &Building) -> Option<Finding> {
    let step = building.lattice.step();
    let off = |face: usize| {
        let own = building.topology.area(building.topology.faces[face].dart) * step * step;
        let off = (own - building.faces[face].area).abs();
        // So that no number counts as far off.
        if off <= 1e-9 * (1.0 + own) { 0.0 } else { off.max(f64::MIN_POSITIVE) }
    };
    let (face, off) = (0..building.faces.len())
        .map(|face| (face, off(face)))
        .reduce(|worst, next| if next.1 > worst.1 { next } else { worst })?;
    let text = format!("face {face} is said to have {} m2", building.faces[face].area);
    let at = building.middle(face as u32).to_array();
    (off > 0.0).then(|| building.finding(Code::G05, building.faces[face].element, at, off, text))
}

/// Faces are called what they separate, and are of elements whose surface is there.
pub(super) fn names(building: &Building) -> Vec<Finding> {
    let sources = building.sources.iter().zip(0u32..);
    let shown: HashSet<(u32, ElementId)> = sources
        .flat_map(|(source, i)| source.triangles.iter().map(move |triangle| (i, triangle.0)))
        .collect();
    let mut findings = Vec::new();
    for (number, (sewn, face)) in building.topology.faces.iter().zip(&building.faces).enumerate() {
        let is_right = match building.surface(sewn) {
            Some((_, matter, is_first)) => {
                let source = sewn.sources[if is_first { 0 } else { 1 }];
                let is_shown =
                    |element| matter == Label::Solid(element) || shown.contains(&(source, element));
                // What a material lets through the model knows.
                let may_be = |is_glass| face.kind == building.kind(sewn, face.element, is_glass);
                face.element.is_none_or(is_shown)
                    && (may_be(false) || (face.material.is_some() && may_be(true)))
            }
            None => {
                face.kind == building.kind(sewn, None, false)
                    && face.element.is_none()
                    && face.material.is_none()
            }
        };
        if !is_right && findings.len() < MOST {
            let at = building.middle(number as u32).to_array();
            let text = format!("face {number} is called {}", face.kind.name());
            findings.push(building.finding(Code::S05, face.element, at, face.area, text));
        }
    }
    findings
}
