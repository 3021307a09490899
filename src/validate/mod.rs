//! Whether a building is one: three families of constraints, after Horna, Meneveaux, Damiand and Bertrand (*Consistency
//! constraints and 3D building reconstruction*, Computer-Aided Design 41(1), 2009).
//!
//! *Topological*: the map is one. *Geometric*: its volumes are convex prisms that fill the hull. *Semantic*: rooms, doors and windows
//! are where such things can be. What breaks the first two cannot be compiled; what breaks the third can, and is worth
//! knowing. `docs/VALIDATION.md` has each code.

mod code;
mod geometry;
mod known;
mod semantics;
#[cfg(test)]
mod tests;
mod topology;

use enfilade_importers::{ElementId, Frame};
use serde::Serialize;

use crate::building::Building;

pub use code::{Code, Family};

/// Something that is not as it should be.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Finding {
    /// What.
    pub code: Code,
    /// The element that it is about, as index.
    #[serde(serialize_with = "index")]
    pub element: Option<ElementId>,
    /// That element's identity.
    pub id: Option<String>,
    /// Where; metres, internal frame, until [`Report::to_source`].
    pub at: [f64; 3],
    /// How large, in the unit that [`Code::unit`] tells.
    pub size: f64,
    /// In words.
    pub text: String,
    /// From air to air, if it is a way: identities of elements, `the open`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<String>,
}

fn index<S: serde::Serializer>(element: &Option<ElementId>, to: S) -> Result<S::Ok, S::Error> {
    Serialize::serialize(&element.map(|element| element.0), to)
}

/// All findings, in the order of their codes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// What was found.
    pub findings: Vec<Finding>,
}

impl Report {
    /// Whether something was found that keeps the building from being compiled.
    pub fn is_fatal(&self) -> bool {
        self.findings.iter().any(|finding| finding.code.family() != Family::Semantic)
    }

    /// Without the findings of some codes.
    pub fn without(mut self, ignored: &[Code]) -> Report {
        self.findings.retain(|finding| !ignored.contains(&finding.code));
        self
    }

    /// The same, its places in the source's own frame and unit.
    pub fn to_source(mut self, frame: &Frame) -> Report {
        for finding in &mut self.findings {
            finding.at = frame.point_to_source(finding.at);
        }
        self
    }
}

/// What was validated: nothing topological or geometric was found in it.
#[derive(Clone, Debug)]
pub struct Validated<T>(T);

impl<T> Validated<T> {
    /// What it is.
    pub fn get(&self) -> &T {
        &self.0
    }

    /// What it is, no longer known to be valid.
    pub fn into_inner(self) -> T {
        self.0
    }
}

/// Validates a building; none comes back if it cannot be compiled.
pub fn validate(building: Building) -> (Option<Validated<Building>>, Report) {
    let report = examine(&building);
    let valid = if report.is_fatal() { None } else { Some(Validated(building)) };
    (valid, report)
}

/// All that is not as it should be. What depends on a sound map is not looked at in one that is none.
pub fn examine(building: &Building) -> Report {
    let mut findings = known::numbers(building);
    if findings.is_empty() {
        findings = topology::check(building);
    }
    if findings.is_empty() {
        findings.extend(known::darts(building));
    }
    if findings.is_empty() {
        findings.extend(geometry::check(building));
    }
    if findings.is_empty() {
        findings.extend(semantics::check(building));
        findings.extend(known::names(building));
    }
    findings.sort_by_key(|finding| finding.code);
    Report { findings }
}

impl Building {
    fn finding(
        &self,
        code: Code,
        element: Option<ElementId>,
        at: [f64; 3],
        size: f64,
        text: String,
    ) -> Finding {
        let id = element.and_then(|element| self.elements.get(element.0 as usize));
        Finding { code, element, id: id.map(|element| element.id.clone()), at, size, text, chain: Vec::new() }
    }
}
