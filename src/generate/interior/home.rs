//! Rooms of flats, and what is over them.

use crate::generate::lattice::units;

use super::Rect;
use super::catalogue::Thing;
use super::fitting::Fitting;
use super::group::{Group, table_with_chairs};
use super::service::counters;
use super::wish::{Filler, Wish};

/// A television opposite a sofa, a table to eat at in larger rooms.
pub fn living(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let (pattern, is_red) = (f.random.below(64) as u8, f.random.flip());
    let seats = if area >= 16 { 3 } else { 2 };
    let sofa = f.item(Thing::Sofa { seats });
    let table = f.item(Thing::Table { w: 110, d: 60, h: 42 });
    let [w, d] = sofa.size;
    let gap = units(0.4);
    let mut group = Group { size: [w, d + gap + table.size[1]], ..Group::default() };
    group.put(&sofa, [0, 0], 0);
    group.put(&table, [(w - table.size[0]) / 2, d + gap], 0);
    // One comes to the table's far side, or past it.
    group.used.push(Rect { lo: [0, d], hi: [w, group.size[1] + units(0.45)] });
    let facing = f.random.below(4) as u8;
    let middle = Wish { middle: 2, chance: 2, ..Wish::default() };
    f.against_wall(&group, &Wish { facing: Some((facing, 6)), ..middle });
    let opposite = Wish { facing: Some(((facing + 2) % 4, 6)), ..middle };
    f.add(Thing::Television { w: if area >= 14 { 180 } else { 140 } }, units(0.5), &opposite);
    if area >= 22 {
        let table = f.item(Thing::Table { w: 160, d: 90, h: 75 });
        let chair = f.item(Thing::WoodenChair);
        f.in_the_middle(&table_with_chairs(&table, &chair, [2, 0], units(0.6)), &[0, 1]);
    }
    f.fill(&[
        Filler::new(Thing::Bookcase { w: 100, pattern: pattern % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::ClubChair { is_red }, 40, Wish::CORNER, 1),
        Filler::new(Thing::Cupboard { w: 160, h: 75, doors: 3, is_dark: true }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::LargePlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::FloorLamp, 0, Wish::CORNER, 1),
        Filler::new(Thing::SideTable { w: 45, h: 55 }, 0, Wish::CORNER, 1),
        Filler::new(Thing::Picture { w: 120, h: 70, color: pattern }, 0, Wish::WALL, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: pattern / 3 }, 0, Wish::WALL, 2),
    ]);
}

/// A run of counters, and a table if there is room.
pub fn kitchen(f: &mut Fitting) {
    f.radiators();
    counters(
        f,
        &[
            Thing::Refrigerator,
            Thing::SinkCounter { w: 120 },
            Thing::HobCounter { w: 60 },
            Thing::Dishwasher,
            Thing::SinkCounter { w: 60 },
        ],
    );
    let chair = f.item(Thing::WoodenChair);
    for (w, per_side) in [(140, 2), (80, 1)] {
        let table = f.item(Thing::Table { w, d: 80, h: 75 });
        let group = table_with_chairs(&table, &chair, [per_side, 0], units(0.6));
        if group.faces() <= f.budget() && f.in_the_middle(&group, &[0, 1]) {
            break;
        }
    }
    f.fill(&[
        Filler::new(Thing::Cupboard { w: 80, h: 195, doors: 2, is_dark: false }, 60, Wish::STORAGE, 1),
        Filler::new(Thing::WallBoard { w: 90 }, 0, Wish::WALL, 2),
        Filler::new(Thing::Bin, 0, Wish::CORNER, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: 1 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}

/// A bed with what stands at its sides, and a wardrobe.
pub fn bedroom(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let (pattern, is_red) = (f.random.below(64) as u8, f.random.flip());
    let head = Wish { middle: 2, door: -1, chance: 2, ..Wish::default() };
    let nightstand = f.item(Thing::Chest { w: 45, d: 40, h: 45, columns: 1, rows: 1 });
    let mut has_bed = false;
    for (w, pillows) in [(180, 2), (160, 2), (140, 2)] {
        if has_bed || area < 11 {
            break;
        }
        let bed = f.item(Thing::Bed { w, pillows });
        let beside = units(0.6);
        let mut group = Group { size: [bed.size[0] + 2 * beside, bed.size[1]], ..Group::default() };
        group.put(&bed, [beside, 0], 0);
        group.put(&nightstand, [beside - nightstand.size[0], 0], 0);
        group.put(&nightstand, [beside + bed.size[0], 0], 0);
        let [all, long] = group.size;
        for lo in [0, beside + bed.size[0]] {
            let hi = if lo == 0 { beside } else { all };
            group.used.push(Rect { lo: [lo, nightstand.size[1]], hi: [hi, long] });
        }
        has_bed = f.against_wall(&group, &head);
    }
    for w in [100, 90, 80] {
        if !has_bed {
            let bed = f.item(Thing::Bed { w, pillows: 1 });
            let group = Group::alone(&bed, units(0.4));
            has_bed = f.against_wall(&group, &Wish::CORNER);
        }
    }
    for (w, columns) in [(200, 4), (150, 3), (100, 2)] {
        if f.add(Thing::Chest { w, d: 60, h: 205, columns, rows: 1 }, units(0.6), &Wish::STORAGE) {
            break;
        }
    }
    f.fill(&[
        Filler::new(Thing::Chest { w: 100, d: 45, h: 80, columns: 1, rows: 3 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::WorkDesk { w: 120, d: 60, is_dark: false }, 70, Wish::LIGHT, 1),
        Filler::new(Thing::ClubChair { is_red }, 40, Wish::CORNER, 1),
        Filler::new(Thing::Bookcase { w: 60, pattern: pattern % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::FloorLamp, 0, Wish::CORNER, 1),
        Filler::new(Thing::WallBoard { w: 90 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Picture { w: 90, h: 60, color: pattern }, 0, Wish::WALL, 2),
    ]);
}

/// A tub, a toilet and a basin, as far as they fit.
pub fn bath(f: &mut Fitting) {
    f.radiators();
    let basin = f.item(Thing::Basin);
    let mirror = f.item(Thing::Mirror { w: 50 });
    let mut wash = Group::alone(&basin, units(0.55));
    wash.put(&mirror, [(basin.size[0] - mirror.size[0]) / 2, 0], 0);
    let toilet = f.item(Thing::Toilet);
    let seat = Group::with_sides(&toilet, units(0.15), units(0.5));
    let tub = f.item(Thing::BathTub);
    if f.square_metres() >= 4 {
        f.against_wall(&Group::alone(&tub, units(0.5)), &Wish { door: -1, ..Wish::CORNER });
    }
    f.against_wall(&seat, &Wish::CORNER);
    f.against_wall(&wash, &Wish { corner: 1, chance: 2, ..Wish::default() });
    f.fill(&[
        Filler::new(Thing::WashingMachine, 50, Wish::CORNER, 1),
        Filler::new(Thing::Chest { w: 45, d: 35, h: 180, columns: 1, rows: 2 }, 40, Wish::STORAGE, 1),
        Filler::new(Thing::WallBoard { w: 60 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Hooks { w: 60 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Bin, 0, Wish::CORNER, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
    ]);
}

/// What is out of use: trunks, cartons, old furniture.
pub fn attic(f: &mut Fitting) {
    let pattern = f.random.below(60) as u8;
    f.fill(&[
        Filler::new(Thing::Trunk { w: 100 }, 40, Wish::CORNER, 1),
        Filler::new(Thing::Trunk { w: 80 }, 40, Wish::CORNER, 1),
        Filler::new(Thing::Cartons { count: 1 + pattern % 3 }, 0, Wish::CORNER, 2),
        Filler::new(Thing::Cartons { count: 1 }, 0, Wish::CORNER, 2),
        Filler::new(Thing::Chest { w: 100, d: 45, h: 80, columns: 1, rows: 3 }, 40, Wish::STORAGE, 1),
        Filler::new(Thing::Chest { w: 100, d: 60, h: 205, columns: 2, rows: 1 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::FloorLamp, 0, Wish::CORNER, 1),
        Filler::new(Thing::WoodenChair, 0, Wish::CORNER, 2),
        Filler::new(Thing::Rack { w: 100, pattern: pattern % 15 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::PlainBench { w: 100 }, 0, Wish::ENTRY, 1),
    ]);
}
