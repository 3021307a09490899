//! What a compilation did: timings, counts that add up, repairs.

use std::collections::BTreeMap;

use enfilade_importers::{Frame, Model, Role, TagSource};
use serde::Serialize;

use super::compact::Graph;
use super::geometry::Gathered;
use super::{CompileOptions, Counted};
use crate::derive::{DeriveOptions, DeriveReport};
use crate::format::Tables;
use crate::format::records::Traits;
use crate::partition::PartitionReport;
pub use crate::partition::Repair;

/// Report of a compilation, the same as `enfilade compile --json` prints.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The program.
    pub tool: &'static str,
    /// Its version.
    pub version: &'static str,
    /// The source's file name.
    pub source: String,
    /// XXH3-64 of the source, as 16 hexadecimal digits.
    pub source_hash: String,
    /// The options that matter for the scene's bytes.
    pub options: BTreeMap<&'static str, String>,
    /// Metres in one unit of the source.
    pub unit: f64,
    /// What was taken off, internal frame, metres.
    pub offset: [f64; 3],
    /// Hull: lower and upper corner, internal frame, metres.
    pub hull: [[f64; 3]; 2],
    /// What the scene holds.
    pub traits: Vec<&'static str>,
    /// Triangles read from the source. Equals the sum of the counts in `triangles_out`.
    pub triangles_in: u64,
    /// Where they went.
    pub triangles_out: Vec<Count>,
    /// What else was left out, and why.
    pub left_out: Vec<Count>,
    /// Elements by role of their components.
    pub roles: Vec<RoleCount>,
    /// Elements.
    pub elements: u64,
    /// Rooms.
    pub rooms: u64,
    /// Cells.
    pub cells: u64,
    /// How many prisms, sections and faces they are; `None` if there are no prisms.
    pub graph: Option<Graph>,
    /// Closed components that carve.
    pub solid_components: u64,
    /// Components of solid elements that are open, and stay detail.
    pub open_solid_components: u64,
    /// What was changed on the way.
    pub repairs: Vec<Repair>,
    /// Longest chain of nodes in the hierarchy of boxes.
    pub hierarchy_depth: u32,
    /// What was found in the building and is not in the model; nothing where a caller did not ask for it.
    pub derived: DeriveReport,
    /// How the space was cut into cells, places in the source's own frame; `None` if it is one cell.
    pub partition: Option<PartitionReport>,
    /// Parts of cells' surfaces that mean the same to rays as the one beside them, and became one with it.
    pub joined_faces: u64,
    /// What validation found, by code; `enfilade validate` tells where. Empty for a building that its caller has validated.
    pub findings: BTreeMap<&'static str, u64>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Time of each stage.
    pub stages: Vec<Stage>,
    /// Bytes of the compiled scene.
    pub bytes: u64,
    /// Most memory accounted for at once, bytes, beside the model's own.
    pub peak_budget_bytes: u64,
}

/// A number of triangles or other things.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Count {
    /// Of what.
    pub what: String,
    /// How many.
    pub count: u64,
}

/// How many elements have components of a role, and their triangles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RoleCount {
    /// The role.
    pub role: &'static str,
    /// Elements whose first component has it.
    pub elements: u64,
    /// Triangles of those elements.
    pub triangles: u64,
}

/// Time of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stage {
    /// Its name.
    pub name: &'static str,
    /// Wall-clock time.
    pub seconds: f64,
}

impl Report {
    /// Counts what validation has found.
    pub(super) fn add_findings(&mut self, found: &crate::validate::Report) {
        for finding in &found.findings {
            *self.findings.entry(finding.code.name()).or_default() += 1;
        }
    }

    /// Adds what cutting the space into cells has done.
    pub(super) fn add_partition(&mut self, partition: &PartitionReport, frame: &Frame) {
        let stages = partition.stages.iter().map(|&(name, seconds)| Stage { name, seconds });
        self.stages.splice(0..0, stages);
        self.repairs.extend(partition.repairs.iter().cloned());
        self.partition = Some(partition.to_source(frame));
    }

    /// What the file itself says about how it was made: no time, path, thread count or machine.
    pub(super) fn provenance(&self) -> String {
        let value = serde_json::json!({
            "tool": self.tool,
            "version": self.version,
            "source": self.source,
            "source_hash": self.source_hash,
            "options": self.options,
            "triangles_in": self.triangles_in,
            "triangles_out": self.triangles_out,
            "left_out": self.left_out,
            "repairs": self.repairs,
            "warnings": self.warnings,
        });
        value.to_string()
    }
}

/// Options as words.
fn describe(derive: &DeriveOptions) -> String {
    match (derive.openings, derive.rooms) {
        (false, false) => "nothing".to_owned(),
        (true, false) => "openings".to_owned(),
        (openings, true) => {
            let what = if openings { "all" } else { "rooms" };
            format!(
                "{what}, holes up to {} m, rooms from {} m2, open plans from {} m2, corridors up to {} m",
                derive.widest_hole, derive.least_area, derive.open_plan, derive.widest_corridor
            )
        }
    }
}

pub(super) fn make(
    model: &Model,
    options: &CompileOptions,
    gathered: &Gathered,
    tables: &Tables,
    counted: &Counted,
) -> Report {
    let scene = &tables.scene[0];
    let found = model.elements.iter().filter(|element| element.tagged_by == TagSource::Derived);
    let derived: u64 = found.map(|element| element.mesh.triangles.len() as u64).sum();
    let mut out = vec![
        Count { what: "detail".to_owned(), count: counted.detail },
        Count { what: "air labels".to_owned(), count: gathered.label_triangles - derived },
        Count { what: "ignored elements".to_owned(), count: gathered.ignored_triangles },
    ];
    let cells = &tables.cells[1..];
    if !cells.is_empty() {
        out.insert(0, Count { what: "faces of cells".to_owned(), count: counted.faces });
        let hidden = u64::from(gathered.detail_triangles) - counted.detail - counted.faces;
        out.push(Count { what: "inside solid matter".to_owned(), count: hidden });
    }
    if gathered.doubled_triangles > 0 {
        out.push(Count { what: "doubled triangles".to_owned(), count: gathered.doubled_triangles });
    }
    let mut reasons: BTreeMap<_, u64> = BTreeMap::new();
    for left_out in &model.left_out {
        *reasons.entry(left_out.reason).or_default() += left_out.count;
    }
    let mut left_out = Vec::new();
    for (reason, count) in reasons {
        let row = Count { what: reason.text().to_owned(), count };
        if reason.is_triangles() { out.push(row) } else { left_out.push(row) }
    }
    let mut roles: BTreeMap<Role, (u64, u64)> = BTreeMap::new();
    for (record, element) in tables.elements.iter().zip(&model.elements) {
        let entry = roles.entry(Role::from_number(record.role).unwrap_or(Role::Detail)).or_default();
        entry.0 += 1;
        entry.1 += element.mesh.triangles.len() as u64;
    }
    let untagged = format!("{:?}", options.untagged).to_lowercase();
    Report {
        tool: "enfilade",
        version: env!("CARGO_PKG_VERSION"),
        source: model.source.clone(),
        source_hash: format!("{:016x}", model.source_hash),
        options: BTreeMap::from([
            ("cells", options.cells.to_string()),
            ("convexification", format!("{:?}", options.convexification).to_lowercase()),
            ("tolerance", format!("{}", options.tolerance)),
            ("topology", options.topology.to_string()),
            ("untagged", untagged),
            ("derive", describe(&options.derive)),
        ]),
        unit: scene.unit,
        offset: scene.offset,
        hull: scene.hull,
        traits: Traits(scene.traits).names(),
        triangles_in: model.triangles_read,
        derived: DeriveReport::default(),
        triangles_out: out,
        left_out,
        roles: roles
            .into_iter()
            .map(|(role, (elements, triangles))| RoleCount { role: role.name(), elements, triangles })
            .collect(),
        elements: tables.elements.len() as u64,
        rooms: tables.rooms.len() as u64,
        cells: tables.cells.len() as u64,
        graph: Graph::of(tables),
        solid_components: gathered.solids,
        open_solid_components: gathered.open_solids,
        repairs: vec![Repair {
            what: "triangles of closed components turned outward",
            count: gathered.turned,
            largest_displacement: 0.0,
        }],
        hierarchy_depth: counted.depth,
        partition: None,
        joined_faces: 0,
        findings: BTreeMap::new(),
        warnings: crate::inspect::warnings(model),
        stages: Vec::new(),
        bytes: 0,
        peak_budget_bytes: 0,
    }
}
