//! Small buildings, each with one thing that is hard about buildings or their exports.

use super::attach::{Attached, Outline};
use super::building::Building;
use super::complex::{Apse, Roof};
use super::drawing::draw;
use super::style::{Style, Unit};
use super::uses::Use;
use super::wing::{Bay, End, Facade, Wing};

/// A small building with one thing that is hard.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Specimen {
    /// What is hard, in words joined by hyphens: the name of its file.
    pub name: String,
    /// The building: no furniture, a few rooms.
    pub building: Building,
    /// How it is written.
    pub style: Style,
}

/// All of them. Those that are hard by their shape are written as they are; the others are all one building, of three
/// rooms on a corridor, written in one style each: every option of [`Style`] by itself, and its mixtures.
pub fn specimens() -> Vec<Specimen> {
    let mut all = shapes();
    let plain = building(Shape::default());
    let mut add = |name: &str, style: Style| {
        all.push(Specimen { name: name.to_owned(), building: plain.clone(), style });
    };
    add("plain", Style::exact());
    let options: Vec<&str> = Style::exact().shares_mut().into_iter().map(|(name, _)| name).collect();
    for (i, name) in options.iter().enumerate() {
        let mut style = Style::exact();
        // Of doubled identities one must be left to be doubled, and of doubled faces some are single.
        let share = if name.starts_with("doubled") { 0.5 } else { 1.0 };
        if let Some((_, option)) = style.shares_mut().into_iter().nth(i) {
            *option = share;
        }
        add(name, style);
    }
    let with = |change: fn(&mut Style)| {
        let mut style = Style::exact();
        change(&mut style);
        style
    };
    add("storey-spaces", with(|style| style.storey_spaces = true));
    add("off-grid", with(|style| style.off_grid = true));
    add("turned", with(|style| style.turned = true));
    add("far", with(|style| style.far = true));
    add("millimetres", with(|style| style.unit = Unit::Millimetre));
    add("cad", Style::cad(1));
    add("damaged", Style::damage(0.3, 1));
    all
}

/// A building before it is drawn.
struct Shape {
    storeys: usize,
    south: Vec<Bay>,
    north: Vec<Bay>,
    roof: Roof,
    apse: Option<Apse>,
    wing: Option<f64>,
}

impl Default for Shape {
    fn default() -> Shape {
        Shape {
            storeys: 1,
            south: vec![bay(30, Use::Office), bay(24, Use::Storage)],
            north: vec![bay(55, Use::Office)],
            roof: Roof::Flat,
            apse: None,
            wing: None,
        }
    }
}

fn bay(width: i32, use_: Use) -> Bay {
    Bay { width, room: Some(use_), facade: Facade::Own, is_blind: false }
}

fn building(shape: Shape) -> Building {
    let end = if shape.apse.is_some() { End::Passage } else { End::Window };
    let wing = |k: usize| {
        let mut bays = [shape.south.clone(), shape.north.clone()];
        // A hall of the ground floor goes on above.
        for bay in bays.iter_mut().flatten().filter(|bay| k > 0 && bay.room == Some(Use::Hall)) {
            bay.room = None;
        }
        Wing { bays, depth: [50, 40], corridor: 16, ends: [end, End::Blind] }
    };
    let side = |degrees: f64| Attached {
        name: "Side wing",
        storeys: vec![Wing {
            bays: [vec![bay(30, Use::Office)], vec![bay(30, Use::Office)]],
            depth: [34, 34],
            corridor: 20,
            ends: [End::Passage, End::Window],
        }],
        bay: 1,
        degrees,
    };
    let outline = Outline {
        name: "Specimen",
        main: (0..shape.storeys).map(wing).collect(),
        roof: shape.roof,
        attached: shape.wing.into_iter().map(side).collect(),
        apse: shape.apse,
        lights: 0,
        fullness: 100,
    };
    draw(&outline.complex(false, 0))
}

/// Those that are hard by their shape.
fn shapes() -> Vec<Specimen> {
    let shaped = |facade: Facade| Bay { facade, ..bay(24, Use::Storage) };
    let office = || bay(30, Use::Office);
    let row = |south: Vec<Bay>| Shape { south, ..Shape::default() };
    let shapes = [
        ("room-l", row(vec![office(), shaped(Facade::West)])),
        ("room-t", row(vec![shaped(Facade::East), office(), shaped(Facade::West)])),
        ("room-u", row(vec![office(), shaped(Facade::Both), office()])),
        ("columns", row(vec![bay(150, Use::OpenOffice)])),
        ("stairwell", Shape { storeys: 2, south: vec![bay(26, Use::Stair), office()], ..Shape::default() }),
        ("hall-of-two-storeys", Shape { storeys: 2, south: vec![bay(70, Use::Hall)], ..Shape::default() }),
        ("round-wall", Shape { apse: Some(Apse { radius: 50, facets: 12 }), ..Shape::default() }),
        (
            "oblique-wing",
            Shape {
                north: vec![office(), bay(26, Use::Corridor), bay(60, Use::Office)],
                wing: Some(37.0),
                ..Shape::default()
            },
        ),
        (
            "attic",
            Shape { south: vec![bay(26, Use::Stair), office()], roof: Roof::Gable, ..Shape::default() },
        ),
    ];
    let specimen = |(name, shape): (&str, Shape)| Specimen {
        name: name.to_owned(),
        building: building(shape),
        style: Style::exact(),
    };
    shapes.into_iter().map(specimen).collect()
}
