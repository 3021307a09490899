//! Rooms that serve the others.

use crate::generate::lattice::units;

use super::Rect;
use super::catalogue::Thing;
use super::fitting::Fitting;
use super::group::{Group, table_with_chairs};
use super::spacing::Spacing;
use super::wish::{Filler, Wish};

/// From the wall to the front of a cubicle, centimetres.
const CUBICLE: u16 = 150;

/// Cubicles side by side, from a corner on: at u = 0 if `is_right`, else at the other end, is a wall of the room.
fn cubicles(f: &mut Fitting, count: i32, is_right: bool) -> Group {
    let side = f.item(Thing::CubicleSide { d: CUBICLE });
    let front = f.item(Thing::CubicleFront { w: 28 });
    let door = f.item(Thing::CubicleDoor { w: 62 });
    let toilet = f.item(Thing::WallToilet);
    let [thick, depth] = side.size;
    let inner = front.size[0] + door.size[0];
    let pitch = inner + thick;
    let mut group = Group { size: [count * pitch, depth], ..Group::default() };
    for i in 0..count {
        // The board on the side away from the corner.
        let (air, board) =
            if is_right { (i * pitch, i * pitch + inner) } else { (i * pitch + thick, i * pitch) };
        group.put(&side, [board, 0], 0);
        group.put(&toilet, [air + (inner - toilet.size[0]) / 2, 0], 0);
        let line = depth - front.size[1];
        let (front_u, door_u) = if is_right { (air, air + front.size[0]) } else { (air + door.size[0], air) };
        group.put(&front, [front_u, line], 0);
        if f.random.below(3) == 0 {
            group.put(&door, [door_u, line], 0);
        } else {
            // Open, along the board at its hinge.
            let [long, flat] = door.size;
            let (u, turns) = if is_right { (board - flat, 1) } else { (air, 3) };
            group.put(&door, [u, line + front.size[1] - long], turns);
        }
    }
    group.used.push(Rect { lo: [0, depth], hi: [count * pitch, depth + units(0.75)] });
    group
}

/// Cubicles, basins, urinals; in a small room one toilet and one basin.
pub fn toilet(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let away = Wish { corner: 2, door: -1, chance: 1, ..Wish::default() };
    // Cubicles begin at a corner, so their places along the wall are its ends.
    let mut stand = 0;
    if area >= 4 {
        let most = (area / 5).clamp(1, 8) as i32;
        'cubicles: for count in (1..=most).rev() {
            for is_right in f.random.shuffled([false, true]) {
                let group = cubicles(f, count, is_right);
                if group.faces() + 20 < f.budget() && f.in_corner(&group, is_right, &away) {
                    stand = count as u32;
                    break 'cubicles;
                }
            }
        }
    }
    if stand == 0 {
        let toilet = f.item(Thing::Toilet);
        f.against_wall(
            &Group::with_sides(&toilet, units(0.15), units(0.55)),
            &Wish { door: -1, middle: 1, ..away },
        );
    }
    let at_door = Wish { corner: 1, door: 1, chance: 1, ..Wish::default() };
    for count in [(stand + 1).min(4) as u8, 2, 1] {
        let basins = if stand == 0 { Thing::Basin } else { Thing::Basins { count } };
        let basin = f.item(basins);
        let mirror = f.item(Thing::Mirror { w: if stand == 0 { 50 } else { 70 * u16::from(count) } });
        let mut group = Group::alone(&basin, units(0.55));
        group.put(&mirror, [(basin.size[0] - mirror.size[0]) / 2, 0], 0);
        let is_enough = count == 1 || group.faces() < f.budget();
        if is_enough && f.against_wall(&group, &at_door) {
            break;
        }
    }
    f.fill(&[
        Filler::new(Thing::Dispenser, 0, Wish::ENTRY, 2),
        Filler::new(Thing::Urinal, 55, away, if area >= 6 { 3 } else { 0 }),
        Filler::new(Thing::Bin, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Mirror { w: 60 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Sign, 0, Wish::WALL, 1),
    ]);
}

/// Racks along the walls and in rows.
pub fn storage(f: &mut Fitting) {
    let pattern = f.random.below(60) as u8;
    let enough = f.target() * 3 / 5;
    for count in [5, 3, 2] {
        let rack = f.item(Thing::Rack { w: 120, pattern: pattern % 15 });
        let group = Group::double_row(&rack, count, units(0.6));
        let left = enough.saturating_sub(f.faces()) / group.faces().max(1);
        f.rows(&group, &[0, 1], &Spacing::spread([units(0.9), units(0.9)], units(1.1)), left);
    }
    f.fill(&[
        Filler::new(Thing::Rack { w: 120, pattern: (pattern + 4) % 15 }, 50, Wish::STORAGE, 4),
        Filler::new(Thing::Rack { w: 100, pattern: (pattern + 8) % 15 }, 50, Wish::STORAGE, 4),
        Filler::new(Thing::Cupboard { w: 100, h: 195, doors: 2, is_dark: false }, 60, Wish::STORAGE, 1),
        Filler::new(Thing::Cartons { count: 1 + pattern % 3 }, 0, Wish::CORNER, 2),
        Filler::new(Thing::Cartons { count: 1 + pattern / 3 % 3 }, 0, Wish::CORNER, 2),
        Filler::new(Thing::Trolley, 0, Wish::CORNER, 1),
        Filler::new(Thing::Hooks { w: 80 }, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Bin, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Sign, 0, Wish::ENTRY, 1),
    ]);
}

/// A run of counters with a refrigerator, and a table if there is room.
pub fn kitchenette(f: &mut Fitting) {
    f.radiators();
    counters(
        f,
        &[
            Thing::Refrigerator,
            Thing::SinkCounter { w: 120 },
            Thing::Dishwasher,
            Thing::TeaCounter { w: 120 },
        ],
    );
    let chair = f.item(Thing::VisitorChair { is_red: true });
    for (w, per_side) in [(160, 2), (80, 1)] {
        let table = f.item(Thing::Table { w, d: 80, h: 74 });
        let group = table_with_chairs(&table, &chair, [per_side, 0], units(0.6));
        if group.faces() < f.budget() && f.in_the_middle(&group, &[0, 1]) {
            break;
        }
    }
    f.fill(&[
        Filler::new(Thing::WaterCooler, 40, Wish::STORAGE, 1),
        Filler::new(Thing::VendingMachine, 70, Wish::STORAGE, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::CORNER, 1),
        Filler::new(Thing::Bin, 0, Wish::CORNER, 2),
        Filler::new(Thing::NoticeBoard { w: 100 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: 4 }, 0, Wish::WALL, 1),
        Filler::new(Thing::WallBoard { w: 90 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}

/// Kitchen units side by side in this order or the other one, as many of them as a wall takes, and units on the wall
/// over the lower ones.
pub fn counters(f: &mut Fitting, things: &[Thing]) {
    let at_wall = Wish { corner: 3, chance: 1, ..Wish::default() };
    for count in (1..=things.len()).rev() {
        let mut items: Vec<_> = things[..count].iter().map(|&thing| f.item(thing)).collect();
        if f.random.flip() {
            items.reverse();
        }
        let units_item = f.item(Thing::WallUnits { w: 60 });
        for with_units in [true, false] {
            let mut group = Group::default();
            for item in &items {
                let [w, d] = item.size;
                let at = group.size[0];
                group.put(item, [at, 0], 0);
                group.size = [at + w, d.max(group.size[1])];
                for i in 0..(w / units_item.size[0]) {
                    if with_units && item.z[1] < units(1.35) {
                        group.put(&units_item, [at + i * units_item.size[0], 0], 0);
                    }
                }
            }
            let [w, d] = group.size;
            group.used.push(Rect { lo: [0, d], hi: [w, d + units(0.7)] });
            if f.against_wall(&group, &at_wall) {
                return;
            }
        }
    }
}

/// Rows of cabinets with space in front and behind, and what powers and cools them.
pub fn server(f: &mut Fitting) {
    let pattern = f.random.below(60) as u8;
    let enough = f.target() * 4 / 5;
    for count in [6, 4, 3, 2, 1] {
        let rack = f.item(Thing::ServerRack { pattern: (pattern + count as u8) % 12 });
        let mut group = Group::row(&rack, count, units(0.8));
        let w = group.size[0];
        group.used.push(Rect { lo: [0, -units(0.6)], hi: [w, 0] });
        let left = enough.saturating_sub(f.faces()) / group.faces().max(1);
        let turns = if f.random.flip() { [0, 1] } else { [2, 3] };
        f.rows(&group, &turns, &Spacing::spread([units(0.8), units(0.9)], units(0.85)), left);
    }
    f.fill(&[
        Filler::new(Thing::PowerCabinet, 70, Wish::STORAGE, 2),
        Filler::new(Thing::ServerRack { pattern: pattern % 12 }, 80, Wish::STORAGE, 2),
        Filler::new(Thing::AirConditioner, 0, Wish::WALL, 2),
        Filler::new(Thing::Extinguisher, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Sign, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Cartons { count: 2 }, 0, Wish::CORNER, 1),
    ]);
}
