//! Rooms where people work, meet and learn.

use crate::generate::lattice::units;

use super::Rect;
use super::catalogue::Thing;
use super::fitting::Fitting;
use super::group::{Group, table_with_chairs};
use super::spacing::Spacing;
use super::wish::{Filler, Wish};

/// What offices are filled with: what is kept in them, then small things.
fn office_fillers(pattern: u8) -> [Filler; 14] {
    let is_dark = pattern % 2 == 1;
    [
        Filler::new(Thing::FileShelf { w: 80, rows: 5, pattern: pattern % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::FileShelf { w: 100, rows: 3, pattern: (pattern + 3) % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::Cupboard { w: 100, h: 195, doors: 2, is_dark }, 60, Wish::STORAGE, 2),
        Filler::new(Thing::Cupboard { w: 160, h: 75, doors: 3, is_dark }, 60, Wish::LIGHT, 1),
        Filler::new(Thing::FilingCabinet, 60, Wish::STORAGE, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::LargePlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::CoatStand, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Whiteboard { w: 150 }, 0, Wish::WALL, 1),
        Filler::new(Thing::NoticeBoard { w: 120 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Picture { w: 90, h: 60, color: pattern }, 0, Wish::WALL, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: pattern / 3 }, 0, Wish::WALL, 1),
        Filler::new(Thing::WallBoard { w: 90 }, 0, Wish::WALL, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]
}

/// A desk whose back is at v = 0, with a chair in front of it and drawers under one of its ends.
fn workplace(f: &mut Fitting, [w, d]: [u16; 2], is_dark: bool, has_cross: bool) -> Group {
    let is_red = f.random.below(3) == 0;
    let desk = f.item(Thing::WorkDesk { w, d, is_dark });
    let chair = f.item(Thing::SwivelChair { is_red, has_cross });
    let pedestal = f.item(Thing::Pedestal);
    let [w, d] = desk.size;
    let seat = units(0.9);
    let mut group = Group { size: [w, d + seat], ..Group::default() };
    group.put(&desk, [0, 0], 0);
    group.put_chair(&chair, [(w - chair.size[0]) / 2, d - units(0.05)], 2);
    let end = if f.random.flip() { units(0.1) } else { w - units(0.1) - pedestal.size[0] };
    group.put(&pedestal, [end, units(0.1)], 0);
    group.used.push(Rect { lo: [0, d], hi: [w, d + seat] });
    group
}

/// A workplace with its back to the room's middle: who sits there looks into the room, and visitors sit opposite.
fn facing_room(f: &mut Fitting, w: u16, is_dark: bool, visitors: i32) -> Group {
    let place = workplace(f, [w, 80], is_dark, visitors > 0);
    let chair = f.item(Thing::VisitorChair { is_red: false });
    let [w, d] = place.size;
    let mut group = Group { size: [w, d], ..Group::default() };
    group.add(&place, [0, 0], 2);
    for i in 0..visitors {
        let u = (2 * i + 1) * w / (2 * visitors) - chair.size[0] / 2;
        group.put_chair(&chair, [u, d + units(0.1)], 2);
    }
    if visitors > 0 {
        group.used.push(Rect { lo: [0, d], hi: [w, d + units(0.75)] });
    }
    group
}

/// Two rows of workplaces face to face, `pairs` long along u.
fn island(f: &mut Fitting, w: u16, pairs: i32, has_divider: bool) -> Group {
    let is_dark = f.random.below(4) == 0;
    let divider = f.item(Thing::Divider { w });
    let gap = if has_divider { divider.size[1] } else { 0 };
    let mut group = Group::default();
    for i in 0..pairs {
        for is_far in [false, true] {
            let place = workplace(f, [w, 80], is_dark, false);
            let [w, d] = place.size;
            let lo = [i * w, if is_far { d + gap } else { 0 }];
            group.add(&place, lo, if is_far { 0 } else { 2 });
            group.size = [pairs * w, 2 * d + gap];
            if has_divider && !is_far {
                group.put(&divider, [i * w, d], 0);
            }
        }
    }
    group
}

/// The same turned by a quarter: it stands at the wall with its end.
fn end_on(group: &Group) -> Group {
    let mut turned = Group { size: group.turned_size(1), ..Group::default() };
    turned.add(group, [0, 0], 1);
    turned
}

/// One desk to some, as the room has space for, and what is kept in an office.
pub fn office(f: &mut Fitting) {
    if f.square_metres() > 70 {
        return open_office(f);
    }
    f.radiators();
    desks(f);
}

fn desks(f: &mut Fitting) {
    let area = f.square_metres();
    let is_dark = f.random.below(3) == 0;
    // Light falls on desks from the side: their ends are at the window, or they stand across the room.
    let near_window = Wish { corner: 2, window: 2, door: -1, chance: 1, ..Wish::default() };
    let most = (f.target().saturating_sub(30) / 62).clamp(1, 60);
    let wanted = (most - f.random.below(most.div_ceil(3))).max(1);
    let mut desks = 0;
    while desks < wanted {
        let width = if area < 10 { 140 } else { 160 };
        let pair = wanted - desks >= 2;
        let mut put = false;
        if pair && f.random.below(4) != 0 {
            let island = island(f, width, 1, false);
            put = f.against_wall(&end_on(&island), &near_window);
            desks += 2 * u32::from(put);
        }
        if !put && (wanted > 1 || f.random.below(3) != 0) {
            let visitors = (area / 14).min(2) as i32;
            let group = facing_room(f, width, is_dark, if wanted == 1 { visitors } else { 0 });
            put = f.against_wall(&group, &near_window);
            desks += u32::from(put);
        }
        for width in [160, 140, 120] {
            if !put {
                let group = workplace(f, [width, if width == 120 { 70 } else { 80 }], is_dark, wanted == 1);
                let group = Group { size: [group.size[0], group.used[0].lo[1]], ..group };
                put = f.against_wall(&group, &near_window);
                desks += u32::from(put);
            }
        }
        if !put {
            break;
        }
    }
    f.add(Thing::Bin, 0, &Wish::LIGHT);
    let pattern = f.random.below(64) as u8;
    for (w, rows) in [(100, 5), (80, 5), (80, 3)] {
        let shelf = Thing::FileShelf { w, rows, pattern: pattern % 8 };
        if area >= 10 && f.add(shelf, units(0.5), &Wish::STORAGE) {
            break;
        }
    }
    if area >= 24 {
        small_table(f, is_dark);
    }
    f.fill(&office_fillers(pattern));
}

/// A table with four chairs.
fn small_table(f: &mut Fitting, is_red: bool) {
    let table = f.item(Thing::Table { w: 90, d: 90, h: 74 });
    let chair = f.item(Thing::VisitorChair { is_red });
    let group = table_with_chairs(&table, &chair, [1, 1], units(0.65));
    if group.faces() + 40 < f.budget() {
        f.in_the_middle(&group, &[0]);
    }
}

/// Islands of desks in rows.
pub fn open_office(f: &mut Fitting) {
    f.radiators();
    let enough = f.target() * 3 / 4;
    let turns = if f.random.flip() { [0, 1] } else { [1, 0] };
    // Two islands at least, if they are not to be tiny.
    let longest = (enough / 250).clamp(1, 3) as i32 + i32::from(f.random.flip());
    let has_divider = f.random.flip();
    let mut has_islands = false;
    for pairs in (1..=longest).rev() {
        let group = island(f, 160, pairs, has_divider);
        for _ in 0..4 {
            let left = enough.saturating_sub(f.faces()) / group.faces().max(1);
            if f.rows(&group, &turns, &Spacing::spread([units(1.3), units(0.5)], units(0.5)), left) == 0 {
                break;
            }
            has_islands = true;
        }
    }
    if !has_islands {
        return desks(f);
    }
    let pattern = f.random.below(64) as u8;
    f.add(Thing::Copier, units(0.7), &Wish::ENTRY);
    f.add(Thing::WaterCooler, units(0.5), &Wish::ENTRY);
    f.fill(&office_fillers(pattern));
}

/// A table as large as the room, chairs around it, and a screen or a board to look at.
pub fn meeting(f: &mut Fitting) {
    f.radiators();
    let is_red = f.random.flip();
    let chair = f.item(Thing::VisitorChair { is_red });
    let at_end = Wish { middle: 3, window: -1, ..Wish::default() };
    let [first, second] = f.random.shuffled([Thing::WallScreen { w: 140 }, Thing::Whiteboard { w: 180 }]);
    f.add(first, 0, &at_end);
    let sizes = [
        (840, 180),
        (720, 160),
        (600, 150),
        (480, 140),
        (360, 130),
        (280, 120),
        (200, 100),
        (140, 90),
        (90, 90),
    ];
    let passed_over = f.random.below(3);
    for (w, d) in sizes {
        let table = f.item(Thing::ConferenceTable { w, d });
        let per_side = table.size[0] / units(0.68);
        let ends = i32::from(d >= 120);
        let group = table_with_chairs(&table, &chair, [per_side, ends], units(0.7));
        // Not always the largest one that there is room for.
        let is_small = w <= 140;
        if !is_small && (group.faces() > f.budget() || f.random.below(3) < passed_over) {
            continue;
        }
        if f.in_the_middle(&group, &long_way(f)) {
            break;
        }
    }
    f.add(second, 0, &at_end);
    let pattern = f.random.below(64) as u8;
    f.fill(&[
        Filler::new(
            Thing::Cupboard { w: 160, h: 75, doors: 3, is_dark: pattern % 2 == 1 },
            50,
            Wish::STORAGE,
            1,
        ),
        Filler::new(Thing::FlipChart, 0, Wish::CORNER, 1),
        Filler::new(Thing::LargePlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::VisitorChair { is_red }, 40, Wish::WALL, 2),
        Filler::new(Thing::Picture { w: 120, h: 70, color: pattern }, 0, Wish::WALL, 2),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
        Filler::new(Thing::Bin, 0, Wish::CORNER, 1),
        Filler::new(Thing::CoatStand, 0, Wish::ENTRY, 1),
    ]);
}

/// Turns that lay a long group along the room's longer side.
fn long_way(f: &Fitting) -> [u8; 2] {
    let [w, h] = f.bounds().size();
    if w >= h { [0, 1] } else { [1, 0] }
}

/// Which way an audience looks: along the room, away from the doors.
fn audience(f: &mut Fitting) -> u8 {
    let bounds = f.bounds();
    let [w, h] = bounds.size();
    let axis = usize::from(h > w);
    let doors: Vec<i64> = f.room.keep_clear.iter().map(|door| door.doubled_middle()[axis]).collect();
    let at_high = if doors.is_empty() {
        f.random.flip()
    } else {
        2 * doors.iter().map(|c| c / doors.len() as i64).sum::<i64>() < 2 * bounds.doubled_middle()[axis]
    };
    // North, west, south, east are 0 to 3.
    match (axis, at_high) {
        (0, true) => 3,
        (0, false) => 1,
        (_, true) => 0,
        (_, false) => 2,
    }
}

/// A large table in small ones; else rows of chairs before a lectern and a canvas.
pub fn conference(f: &mut Fitting) {
    if f.square_metres() < 36 {
        return meeting(f);
    }
    f.radiators();
    let is_red = f.random.flip();
    let look = audience(f);
    let back = (look + 2) % 4;
    let front_wall = Wish { facing: Some((back, 100)), middle: 4, ..Wish::default() };
    for w in [350, 250, 180] {
        if f.add(Thing::Canvas { w }, 0, &front_wall) {
            break;
        }
    }
    let lectern = f.item(Thing::Lectern);
    let mut stage = Group { size: [units(0.6), units(1.3)], ..Group::default() };
    // Its front is the speaker's side.
    stage.put(&lectern, [0, units(0.8)], 2);
    stage.used.push(Rect { lo: [0, 0], hi: [units(0.6), units(0.8)] });
    f.against_wall(&stage, &Wish { facing: Some((back, 100)), middle: 4, chance: 1, ..Wish::default() });
    let chair = f.item(Thing::VisitorChair { is_red });
    let enough = f.target() * 17 / 20;
    let audience = Spacing { gap: [units(1.0), units(0.45)], margin: units(0.7), is_audience: true };
    let longest = (4 + f.random.below(5)) as i32;
    for seats in [longest, 4, 2] {
        let row = Group::row(&chair, seats, units(0.42));
        let left = enough.saturating_sub(f.faces()) / row.faces().max(1);
        if f.rows(&row, &[look], &audience, left) > 0 {
            break;
        }
    }
    let pattern = f.random.below(64) as u8;
    f.fill(&[
        Filler::new(Thing::LargePlant, 0, Wish::CORNER, 1),
        Filler::new(Thing::FlipChart, 0, Wish { facing: Some((back, 20)), ..Wish::CORNER }, 1),
        Filler::new(Thing::VisitorChair { is_red: false }, 40, Wish::WALL, 4),
        Filler::new(Thing::Cupboard { w: 160, h: 75, doors: 3, is_dark: false }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::Picture { w: 120, h: 70, color: pattern }, 0, Wish::WALL, 2),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}

/// Tables in rows before a blackboard and a desk.
pub fn classroom(f: &mut Fitting) {
    f.radiators();
    let look = audience(f);
    let back = (look + 2) % 4;
    let front_wall = Wish { facing: Some((back, 100)), middle: 4, ..Wish::default() };
    for w in [380, 280, 180] {
        if f.add(Thing::Blackboard { w }, 0, &front_wall) {
            break;
        }
    }
    let desk = facing_room(f, 140, false, 0);
    f.against_wall(&desk, &Wish { facing: Some((back, 100)), window: 2, ..Wish::default() });
    let table = f.item(Thing::SchoolTable);
    let chair = f.item(Thing::WoodenChair);
    let mut pair = Group { size: [table.size[0], table.size[1] + units(0.6)], ..Group::default() };
    let w = table.size[0];
    pair.put(&table, [0, units(0.6)], 0);
    for i in 0..2 {
        pair.put_chair(&chair, [w / 4 + i * w / 2 - chair.size[0] / 2, units(0.3)], 0);
    }
    pair.used.push(Rect { lo: [0, 0], hi: [w, units(0.6)] });
    let enough = f.target() * 17 / 20;
    let audience = Spacing { gap: [units(0.65), units(0.3)], margin: units(0.5), is_audience: true };
    let left = enough.saturating_sub(f.faces()) / pair.faces().max(1);
    f.rows(&pair, &[look], &audience, left);
    let pattern = f.random.below(64) as u8;
    f.fill(&[
        Filler::new(Thing::Cupboard { w: 100, h: 195, doors: 2, is_dark: false }, 60, Wish::STORAGE, 2),
        Filler::new(Thing::FileShelf { w: 100, rows: 5, pattern: pattern % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::NoticeBoard { w: 120 }, 0, Wish::WALL, 2),
        Filler::new(Thing::Picture { w: 90, h: 60, color: pattern }, 0, Wish::WALL, 3),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::Bin, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}
