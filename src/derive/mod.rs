//! What a model does not say and its building shows: the openings that its doors and windows fill, and its rooms.
//!
//! Exporters leave out opening elements and spaces by default. [`complete`] adds them to a model as elements of their own, tagged by
//! [`TagSource::Derived`](enfilade_importers::TagSource::Derived), so that all that comes after treats them as any other. `docs/GRAPH.md` tells how they are found.

mod holes;
mod matter;
mod openings;

use std::borrow::Cow;
use std::collections::BTreeMap;

use enfilade_importers::{Element, Model, Untagged};

/// What to add to a model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeriveOptions {
    /// Openings of doors and windows that have none. Default: yes.
    pub openings: bool,
}

impl DeriveOptions {
    /// Nothing is added.
    pub const NOTHING: DeriveOptions = DeriveOptions { openings: false };
}

impl Default for DeriveOptions {
    fn default() -> DeriveOptions {
        DeriveOptions { openings: true }
    }
}

/// What was added to a model, and what was not found.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct DeriveReport {
    /// Openings added.
    pub openings: u64,
    /// Doors and windows around which there is no hole in anything solid: their paths.
    pub without_hole: Vec<String>,
}

/// The model with what it lacks, as elements after its own; as it is, if it lacks nothing.
pub fn complete<'m>(
    model: &'m Model,
    untagged: Untagged,
    options: &DeriveOptions,
) -> (Cow<'m, Model>, DeriveReport) {
    let mut report = DeriveReport::default();
    let mut model = Cow::Borrowed(model);
    if options.openings {
        let openings = openings::missing(&model, untagged, &mut report);
        add(&mut model, openings);
    }
    (model, report)
}

fn add(model: &mut Cow<'_, Model>, elements: Vec<Element>) {
    if elements.is_empty() {
        return;
    }
    let model = model.to_mut();
    let by_id: BTreeMap<String, usize> =
        model.elements.iter().zip(0..).map(|(element, i)| (element.id.clone(), i)).collect();
    for element in elements {
        if let Some(&filling) = element.filling.as_ref().and_then(|id| by_id.get(id)) {
            model.elements[filling].opening = Some(element.id.clone());
        }
        model.elements.push(element);
    }
}
