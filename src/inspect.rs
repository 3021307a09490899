//! What a model holds, before anything is compiled: elements by class, tag and role, closed or not and where not,
//! extent, units, offset, and what was left out and why.

use std::collections::BTreeMap;

use enfilade_importers::tagging::{self, Rules};
use enfilade_importers::{Element, Frame, Model, Role, Untagged, UpAxis};
use serde::Serialize;

use crate::components::{Component, Orientation, components};
use crate::parallel;
use crate::partition::PartitionReport;
use crate::roles::{asked_role, component_role};

/// What [`inspect`] found. Places are in the source's own frame and unit.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The program's version.
    pub version: &'static str,
    /// The source's file name.
    pub source: String,
    /// Metres in one unit of the source.
    pub unit: f64,
    /// Which axis of the source points up: `Y` or `Z`.
    pub up: &'static str,
    /// What is taken off inside, metres, Z up; zeros if nothing is.
    pub offset: [f64; 3],
    /// Lower and upper corner of the box around all triangles, source frame and unit.
    pub extent: [[f64; 3]; 2],
    /// Triangles read, left-out ones included.
    pub triangles_read: u64,
    /// Triangles of the elements.
    pub triangles: u64,
    /// Counts of materials, lights and cameras.
    pub materials: u64,
    /// Light sources.
    pub lights: u64,
    /// Cameras.
    pub cameras: u64,
    /// Elements by class, semantic and role.
    pub groups: Vec<Group>,
    /// Every element.
    pub elements: Vec<ElementInfo>,
    /// How space is cut into cells, if that was asked for: [`Inspection::add_partition`].
    pub partition: Option<PartitionReport>,
    /// What was left out, and why.
    pub left_out: Vec<LeftOutInfo>,
    /// What else a user should know.
    pub warnings: Vec<String>,
}

/// Elements of one class, semantic and role.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Group {
    /// The class; empty if none.
    pub class: String,
    /// The semantic word.
    pub semantic: &'static str,
    /// The role of the elements' first component.
    pub role: &'static str,
    /// Elements.
    pub elements: u64,
    /// Their triangles.
    pub triangles: u64,
    /// How many of them are closed in all components.
    pub closed: u64,
}

/// One element.
#[derive(Clone, Debug, Serialize)]
pub struct ElementInfo {
    /// Its index, as in `trace --elements`.
    pub index: u32,
    /// Identity.
    pub id: String,
    /// Name.
    pub name: String,
    /// Path in the source.
    pub path: String,
    /// Class; empty if none.
    pub class: String,
    /// Storey; empty if none.
    pub storey: String,
    /// Semantic word.
    pub semantic: &'static str,
    /// How the semantic was found.
    pub tagged_by: String,
    /// Role of its first component.
    pub role: &'static str,
    /// Triangles.
    pub triangles: u64,
    /// Connected components.
    pub components: u64,
    /// Components that are closed.
    pub closed_components: u64,
    /// Components whose triangles disagree about the outside.
    pub mixed_components: u64,
    /// Triangles that stand twice.
    pub doubled_triangles: u64,
    /// Open edges of all components.
    pub open_edges: u64,
    /// The first few open edges, source frame.
    pub open_at: Vec<[[f64; 3]; 2]>,
}

/// Something that was left out.
#[derive(Clone, Debug, Serialize)]
pub struct LeftOutInfo {
    /// The element's id; empty if it is about none.
    pub element: String,
    /// Where the source has it.
    pub place: String,
    /// Why.
    pub reason: &'static str,
    /// How many.
    pub count: u64,
}

/// Looks at `model`. `untagged` and `rules` are those that it was imported with.
pub fn inspect(model: &Model, untagged: Untagged, rules: Option<&Rules>) -> Inspection {
    let frame = model.frame;
    let elements: Vec<ElementInfo> = describe_all(model, untagged, rules);
    let mut groups: BTreeMap<(String, &'static str, &'static str), (u64, u64, u64)> = BTreeMap::new();
    for e in &elements {
        let group = groups.entry((e.class.clone(), e.semantic, e.role)).or_default();
        group.0 += 1;
        group.1 += e.triangles;
        group.2 += u64::from(e.closed_components == e.components);
    }
    Inspection {
        version: env!("CARGO_PKG_VERSION"),
        source: model.source.clone(),
        unit: frame.unit,
        up: if frame.up == UpAxis::Y { "Y" } else { "Z" },
        offset: frame.offset,
        extent: extent(model, frame),
        triangles_read: model.triangles_read,
        triangles: model.triangle_count(),
        materials: model.materials.len() as u64,
        lights: model.lights.len() as u64,
        cameras: model.cameras.len() as u64,
        groups: groups
            .into_iter()
            .map(|((class, semantic, role), (elements, triangles, closed))| Group {
                class,
                semantic,
                role,
                elements,
                triangles,
                closed,
            })
            .collect(),
        elements,
        partition: None,
        left_out: model
            .left_out
            .iter()
            .map(|l| LeftOutInfo {
                element: l.element.map_or(String::new(), |e| model.elements[e.0 as usize].id.clone()),
                place: l.place.clone(),
                reason: l.reason.text(),
                count: l.count,
            })
            .collect(),
        warnings: warnings(model),
    }
}

impl Inspection {
    /// Adds what [`partition`](crate::partition::partition) says of the model.
    pub fn add_partition(&mut self, report: &PartitionReport, model: &Model) {
        self.partition = Some(report.to_source(&model.frame));
    }
}

/// The model's warnings as lines.
pub(crate) fn warnings(model: &Model) -> Vec<String> {
    let line = |w: &enfilade_importers::Warning| {
        if w.place.is_empty() { w.text.clone() } else { format!("{}: {}", w.place, w.text) }
    };
    model.warnings.iter().map(line).collect()
}

/// The box around all vertices in the source's frame: axes may be swapped and turned, so corners are compared again.
fn extent(model: &Model, frame: Frame) -> [[f64; 3]; 2] {
    let [a, b] = model.bounds().unwrap_or_default().map(|p| frame.point_to_source(p));
    [[0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))]
}

fn describe_all(model: &Model, untagged: Untagged, rules: Option<&Rules>) -> Vec<ElementInfo> {
    parallel::map(model.elements.len(), |index| {
        let element = &model.elements[index];
        ElementInfo {
            tagged_by: tagging::describe(element, rules),
            ..describe(index as u32, element, model.frame, untagged)
        }
    })
}

fn describe(index: u32, element: &Element, frame: Frame, untagged: Untagged) -> ElementInfo {
    let parts = components(&element.mesh);
    let asked = asked_role(element, untagged);
    let count = |test: &dyn Fn(&Component) -> bool| parts.iter().filter(|c| test(c)).count() as u64;
    ElementInfo {
        index,
        id: element.id.clone(),
        name: element.name.clone(),
        path: element.path.clone(),
        class: element.class.clone().unwrap_or_default(),
        storey: element.storey.clone().unwrap_or_default(),
        semantic: element.semantic.name(),
        tagged_by: String::new(),
        role: parts.first().map_or(Role::Detail, |c| component_role(asked, c)).name(),
        triangles: element.mesh.triangles.len() as u64,
        components: parts.len() as u64,
        closed_components: count(&|c| c.closed),
        mixed_components: count(&|c| c.orientation == Orientation::Mixed),
        doubled_triangles: parts.iter().map(|c| u64::from(c.doubled)).sum(),
        open_edges: parts.iter().map(|c| u64::from(c.open_edges)).sum(),
        open_at: parts
            .iter()
            .flat_map(|c| &c.open_at)
            .take(8)
            .map(|edge| edge.map(|p| frame.point_to_source(p)))
            .collect(),
    }
}
