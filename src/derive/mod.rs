//! What a model does not say and its building shows: the openings that its doors and windows fill, and its rooms.
//!
//! Exporters leave out opening elements and spaces by default. [`complete`] adds them to a model as elements of their own, tagged by
//! [`TagSource::Derived`](enfilade_importers::TagSource::Derived), so that all that comes after treats them as any other. `docs/GRAPH.md` tells how they are found.

mod floors;
mod holes;
mod index;
mod matter;
mod open_plan;
mod openings;
mod passage;
mod raster;
mod rooms;

use std::borrow::Cow;
use std::collections::BTreeMap;

use enfilade_importers::{Cancelled, Element, Mesh, Model, Semantic, TagSource};

use crate::lattice::Point;
use crate::partition::storeys::storeys;
use crate::partition::{PartitionError, PartitionOptions};
use crate::roles::roles;

/// What to add to a model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DeriveOptions {
    /// Openings of doors and windows that have none; and, if the model has no openings at all, holes in walls that nothing fills.
    /// Default: yes.
    pub openings: bool,
    /// Rooms, if the model has none at all. Default: yes.
    pub rooms: bool,
    /// A hole in a wall that is wider than this, metres, and has no sill joins what it lies between to one room. Default: 3.
    pub widest_hole: f64,
    /// Rooms have at least this floor area, square metres. Default: 0.7.
    pub least_area: f64,
    /// What hangs together and has more floor area than this, square metres, is cut at gaps in walls and where corridors come to halls.
    /// Default: 100.
    pub open_plan: f64,
    /// No corridor is wider than this, metres; 0 for none of these cuts. Default: 4.5.
    pub widest_corridor: f64,
}

impl DeriveOptions {
    /// Nothing is added.
    pub const NOTHING: DeriveOptions = DeriveOptions {
        openings: false,
        rooms: false,
        widest_hole: 3.0,
        least_area: 0.7,
        open_plan: 100.0,
        widest_corridor: 4.5,
    };
}

impl Default for DeriveOptions {
    fn default() -> DeriveOptions {
        DeriveOptions { openings: true, rooms: true, ..DeriveOptions::NOTHING }
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
    /// Openings added that neither a door nor a window fills, of all of them.
    pub unfilled: u64,
    /// Rooms added.
    pub rooms: u64,
    /// Why rooms could not be looked for.
    pub failed: Option<String>,
}

/// The model with what it lacks, as elements after its own; as it is, if it lacks nothing. `how` says what elements without a tag are taken for,
/// and what it may cost.
///
/// # Errors
/// [`Cancelled`]. Where rooms cannot be looked for, there are none, and the report says why.
pub fn complete<'m>(
    model: &'m Model,
    options: &DeriveOptions,
    how: &PartitionOptions,
) -> Result<(Cow<'m, Model>, DeriveReport), Cancelled> {
    let mut report = DeriveReport::default();
    let has =
        |model: &Model, is_meant: fn(Semantic) -> bool| model.elements.iter().any(|e| is_meant(e.semantic));
    let lacks_rooms = options.rooms && !has(model, |s| matches!(s, Semantic::Room | Semantic::Stairwell));
    let lacks_openings = options.openings
        && !has(model, |s| matches!(s, Semantic::Door | Semantic::Window | Semantic::Opening));
    let mut model = Cow::Borrowed(model);
    if options.openings {
        let openings = openings::missing(&model, how.untagged, &how.watch, &mut report);
        how.watch.check()?;
        add(&mut model, openings);
    }
    if lacks_rooms || lacks_openings {
        let roles = roles(&model, how.untagged);
        let floors = floors::floors(&model, &roles);
        if floors.len() < 2 {
            return Ok((model, report));
        }
        let mut cuts = Vec::new();
        let mut storeys = storeys(&model, &floors, &[], how);
        if let (Ok(whole), true) = (&storeys, lacks_rooms) {
            cuts = rooms::cuts(&model, &roles, whole, options);
            how.watch.check()?;
        }
        if cuts.iter().any(|cuts| !cuts.is_empty()) {
            let lines: Vec<Vec<[Point; 2]>> =
                cuts.iter().map(|lines| lines.iter().map(|line| line.ends).collect()).collect();
            // One at a time: each may take all the memory that there is.
            drop(storeys);
            storeys = self::storeys(&model, &floors, &lines, how);
            if !matches!(storeys, Ok(_) | Err(PartitionError::Cancelled(_))) {
                // Rooms are found that way, too, if fewer.
                cuts.clear();
                storeys = self::storeys(&model, &floors, &[], how);
            }
        }
        let storeys = match storeys {
            Ok(storeys) => storeys,
            Err(PartitionError::Cancelled(cancelled)) => return Err(cancelled),
            Err(failed) => {
                report.failed = Some(failed.to_string());
                return Ok((model, report));
            }
        };
        // As they were cut: what lies beyond all that carves is no level.
        let names = floors::names(&model, &storeys.levels());
        let found = rooms::find(&model, &roles, &storeys, &cuts, options);
        how.watch.check()?;
        let mut ids = Ids::of(&model);
        let mut elements = Vec::new();
        if lacks_rooms {
            elements.extend(named_rooms(found.rooms, &names, &mut ids));
            report.rooms = elements.len() as u64;
        }
        if lacks_openings {
            report.openings += found.holes.len() as u64;
            report.unfilled = found.holes.len() as u64;
            elements.extend(named_holes(&model, found.holes, &names, &mut ids));
        }
        add(&mut model, elements);
    }
    Ok((model, report))
}

fn derived(id: String, name: String, class: &str, semantic: Semantic, mesh: Mesh) -> Element {
    Element {
        path: id.clone(),
        id,
        source_name: name.clone(),
        name,
        class: Some(class.to_owned()),
        semantic,
        tagged_by: TagSource::Derived,
        mesh,
        ..Element::default()
    }
}

/// Rooms by storey and number.
fn named_rooms(rooms: Vec<rooms::FoundRoom>, names: &[String], ids: &mut Ids) -> Vec<Element> {
    let mut numbers = vec![0; names.len()];
    let room = |room: rooms::FoundRoom| {
        let storey = &names[room.storey];
        numbers[room.storey] += 1;
        let number = numbers[room.storey];
        let id = ids.unused(format!("room:{}.{number}", room.storey));
        let name = format!("{storey} {number}");
        Element { storey: Some(storey.clone()), ..derived(id, name, "IfcSpace", Semantic::Room, room.mesh) }
    };
    rooms.into_iter().map(room).collect()
}

fn named_holes(model: &Model, holes: Vec<rooms::FoundHole>, names: &[String], ids: &mut Ids) -> Vec<Element> {
    let mut numbers = vec![0; names.len()];
    let hole = |hole: rooms::FoundHole| {
        let storey = &names[hole.storey];
        numbers[hole.storey] += 1;
        let number = numbers[hole.storey];
        let id = ids.unused(format!("opening:{}.{number}", hole.storey));
        let name = format!("{storey} opening {number}");
        Element {
            storey: Some(storey.clone()),
            host: hole.host.map(|host| model.elements[host.0 as usize].id.clone()),
            ..derived(id, name, "IfcOpeningElement", Semantic::Opening, hole.mesh)
        }
    };
    holes.into_iter().map(hole).collect()
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

/// The ids that a model has.
struct Ids(BTreeMap<String, u32>);

impl Ids {
    fn of(model: &Model) -> Ids {
        Ids(model.elements.iter().map(|element| (element.id.clone(), 0)).collect())
    }

    /// `id`, or with a number after it if there is one like it.
    fn unused(&mut self, id: String) -> String {
        let mut own = id.clone();
        while self.0.contains_key(&own) {
            let count = self.0.entry(id.clone()).or_default();
            *count += 1;
            own = format!("{id}~{count}");
        }
        self.0.insert(own.clone(), 0);
        own
    }
}
