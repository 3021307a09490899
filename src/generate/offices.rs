//! Office buildings like those of the paper's Table 1, and towers.

use super::attach::{Attached, Outline};
use super::building::Building;
use super::complex::{Apse, Roof};
use super::drawing::draw;
use super::uses::Use;
use super::wing::{Bay, End, Facade, Wing};

/// What all office buildings have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct OfficeOptions {
    /// Put furniture, sanitary ware and lamps into the rooms.
    pub furniture: bool,
    /// Identities, furniture, and how far the doors stand open, follow from it.
    pub seed: u64,
}

impl Default for OfficeOptions {
    fn default() -> OfficeOptions {
        OfficeOptions { furniture: true, seed: 0 }
    }
}

fn bay(width: i32, use_: Use) -> Bay {
    Bay { width, room: Some(use_), facade: Facade::Own, is_blind: false }
}

fn shaped(width: i32, use_: Use, facade: Facade) -> Bay {
    Bay { facade, ..bay(width, use_) }
}

/// A row of offices, of three widths.
fn offices(count: i32) -> impl Iterator<Item = Bay> {
    (0..count).map(|i| bay(34 + i * 2 % 3 * 3, Use::Office))
}

/// One storey of 46 rooms: a wing under a gable roof with an attic, a round end, and an oblique wing.
pub fn build1(options: &OfficeOptions) -> Building {
    use Facade::{Both, East, West};
    let south = vec![
        bay(70, Use::Conference),
        bay(34, Use::Office),
        shaped(26, Use::Storage, West),
        bay(36, Use::Office),
        bay(110, Use::Hall),
        bay(36, Use::Office),
        shaped(28, Use::Server, Both),
        bay(36, Use::Office),
        bay(30, Use::Toilet),
        bay(30, Use::Toilet),
        bay(26, Use::Stair),
    ];
    let north = vec![
        bay(40, Use::Meeting),
        shaped(30, Use::Storage, East),
        bay(36, Use::OpenOffice),
        shaped(30, Use::Kitchenette, West),
        bay(36, Use::Office),
        bay(44, Use::Office),
        bay(26, Use::Corridor),
        bay(40, Use::Office),
        bay(40, Use::Office),
        bay(40, Use::Library),
        bay(70, Use::Library),
    ];
    let main =
        Wing { bays: [south, north], depth: [52, 46], corridor: 24, ends: [End::Passage, End::Window] };
    let wing = Wing {
        bays: [offices(10).collect(), offices(10).collect()],
        depth: [46, 46],
        corridor: 20,
        ends: [End::Passage, End::Window],
    };
    let attached = vec![Attached { name: "Oblique wing", storeys: vec![wing], bay: 6, degrees: 53.0 }];
    let apse = Some(Apse { radius: 56, facets: 16 });
    let outline = Outline {
        name: "Build1",
        main: vec![main],
        roof: Roof::Gable,
        attached,
        apse,
        lights: 55,
        fullness: 58,
    };
    draw(&outline.complex(options.furniture, options.seed))
}

/// The wings of a storey of [`build2`]: the main wing, and those that stand against it. With `is_upper_half`, that over
/// the entrance hall of two storeys.
fn storey_of_build2(is_upper_half: bool) -> [Wing; 4] {
    use Facade::{Both, East, West};
    let hall = bay(120, Use::Hall);
    let south = [
        vec![bay(52, Use::Meeting), bay(26, Use::Stair), bay(30, Use::Toilet), bay(30, Use::Toilet)],
        vec![bay(36, Use::Office), shaped(26, Use::Storage, West), bay(38, Use::Office)],
        // Two rooms for one, where a storey lacks the hall's.
        vec![
            bay(36, Use::Office),
            shaped(28, Use::Server, if is_upper_half { Facade::Own } else { Both }),
            bay(36, Use::Office),
        ],
        vec![Bay { room: hall.room.filter(|_| !is_upper_half), ..hall }],
        vec![bay(40, Use::Office), shaped(26, Use::Storage, East), bay(40, Use::OpenOffice)],
        vec![shaped(26, Use::Storage, West), bay(36, Use::Office), bay(70, Use::Classroom)],
        vec![bay(30, Use::Toilet), bay(30, Use::Toilet), bay(26, Use::Stair), bay(80, Use::Conference)],
    ];
    let north = [
        vec![bay(60, Use::Lounge), bay(30, Use::Kitchenette), bay(36, Use::Office), bay(36, Use::Office)],
        vec![bay(26, Use::Corridor), bay(36, Use::Office), bay(36, Use::Office), bay(80, Use::Library)],
        vec![bay(36, Use::Office), bay(36, Use::Office), bay(36, Use::Office), bay(36, Use::Office)],
        vec![bay(26, Use::Corridor), bay(50, Use::Meeting), bay(40, Use::Office), bay(40, Use::Office)],
        vec![bay(36, Use::Office), bay(36, Use::Office), bay(26, Use::Corridor), bay(36, Use::Office)],
        vec![bay(36, Use::Office)],
    ];
    let main = Wing {
        bays: [south.concat(), north.concat()],
        depth: [54, 50],
        corridor: 26,
        ends: [End::Passage, End::Window],
    };
    let side = |first: Vec<Bay>, last: Vec<Bay>, count: i32, ends: [End; 2]| Wing {
        bays: [first.into_iter().chain(offices(count)).collect(), offices(count).chain(last).collect()],
        depth: [48, 48],
        corridor: 20,
        ends,
    };
    [
        main,
        side(
            vec![bay(50, Use::OpenOffice)],
            vec![bay(26, Use::Stair), bay(28, Use::Toilet)],
            13,
            [End::Open, End::Window],
        ),
        side(vec![bay(60, Use::Conference)], vec![bay(30, Use::Kitchenette)], 12, [End::Open, End::Window]),
        side(
            vec![bay(40, Use::Meeting)],
            vec![bay(26, Use::Stair), bay(28, Use::Toilet)],
            15,
            [End::Passage, End::Window],
        ),
    ]
}

/// The bays of the main wing's north row from which the other wings are entered, and how these are turned.
const WAYS_OF_BUILD2: [(&str, usize, f64); 3] =
    [("West wing", 4, 90.0), ("Middle wing", 12, 90.0), ("Oblique wing", 18, 37.0)];

fn like_build2(
    name: &'static str,
    storeys: usize,
    [lights, fullness]: [usize; 2],
    options: &OfficeOptions,
) -> Building {
    let plans: Vec<[Wing; 4]> = (0..storeys).map(|k| storey_of_build2(k == 1)).collect();
    let of = |index: usize| plans.iter().map(|plan| plan[index].clone()).collect::<Vec<_>>();
    let attached = WAYS_OF_BUILD2.iter().enumerate().map(|(i, &(name, bay, degrees))| Attached {
        name,
        storeys: of(i + 1),
        bay,
        degrees,
    });
    let attached = attached.collect();
    let apse = Some(Apse { radius: 60, facets: 24 });
    let outline =
        Outline { name, main: of(0), roof: Roof::Flat, attached, apse, lights, fullness: fullness as u32 };
    draw(&outline.complex(options.furniture, options.seed))
}

/// One storey of 135 rooms: four wings, one of them oblique, and a round end.
pub fn build2(options: &OfficeOptions) -> Building {
    like_build2("Build2", 1, [199, 89], options)
}

/// Thirteen storeys of 135 rooms, with an entrance hall over two of them.
pub fn build3(options: &OfficeOptions) -> Building {
    like_build2("Build3", 13, [2557, 82], options)
}

/// What [`tower`] makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct TowerOptions {
    /// From 1 to [`TowerOptions::MOST_STOREYS`].
    pub storeys: usize,
    /// As in all office buildings.
    pub office: OfficeOptions,
}

impl TowerOptions {
    /// More are not built.
    pub const MOST_STOREYS: usize = 200;
}

impl Default for TowerOptions {
    fn default() -> TowerOptions {
        TowerOptions { storeys: 12, office: OfficeOptions::default() }
    }
}

/// A tower with a round side, columns, two stairwells, and an entrance hall over two storeys.
///
/// Fewer storeys than one count as one, more than [`TowerOptions::MOST_STOREYS`] as these.
pub fn tower(options: &TowerOptions) -> Building {
    let storeys = options.storeys.clamp(1, TowerOptions::MOST_STOREYS);
    let storey = |k: usize| {
        let hall = Bay { room: Some(Use::Hall).filter(|_| k == 0), ..bay(110, Use::Hall) };
        let middle = if k < 2 { hall } else { bay(110, Use::OpenOffice) };
        let south = [vec![bay(26, Use::Stair), bay(36, Use::Office)], vec![middle], offices(2).collect()];
        let north = vec![
            bay(28, Use::Toilet),
            bay(28, Use::Toilet),
            bay(24, Use::Kitchenette),
            bay(50, Use::Meeting),
            bay(36, Use::Office),
            shaped(26, Use::Storage, Facade::West),
            bay(26, Use::Stair),
        ];
        Wing {
            bays: [south.concat(), north],
            depth: [54, 52],
            corridor: 24,
            ends: [End::Passage, End::Window],
        }
    };
    let main: Vec<Wing> = (0..storeys).map(storey).collect();
    let rooms: usize = main.iter().map(|wing| wing.storey().rooms.len() + 1).sum();
    let outline = Outline {
        name: "Tower",
        main,
        roof: Roof::Flat,
        attached: Vec::new(),
        apse: Some(Apse { radius: 66, facets: 32 }),
        lights: rooms * 3 / 2,
        fullness: 100,
    };
    draw(&outline.complex(options.office.furniture, options.office.seed))
}
