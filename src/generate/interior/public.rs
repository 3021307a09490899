//! Rooms that all pass through or meet in.

use crate::generate::lattice::units;

use super::Rect;
use super::catalogue::Thing;
use super::fitting::Fitting;
use super::group::{Group, table_with_chairs};
use super::spacing::Spacing;
use super::wish::{Filler, Wish};

/// Along a way: anywhere on its walls.
const ALONG: Wish = Wish { corner: 0, window: 0, door: 0, middle: 0, facing: None, chance: 20 };
/// In a niche or at the end.
const NICHE: Wish = Wish { corner: 3, window: 0, door: -1, middle: 0, facing: None, chance: 4 };

/// What hangs on a corridor's walls, and little that stands where it is wide enough.
pub fn corridor(f: &mut Fitting) {
    f.radiators();
    let pattern = f.random.below(64) as u8;
    f.add(Thing::Extinguisher, 0, &ALONG);
    f.fill(&[
        Filler::new(Thing::NoticeBoard { w: 120 }, 0, ALONG, 1),
        Filler::new(Thing::Picture { w: 120, h: 70, color: pattern }, 0, ALONG, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: pattern / 3 }, 0, ALONG, 2),
        Filler::new(Thing::Clock, 0, ALONG, 1),
        Filler::new(Thing::Sign, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Bench { seats: 2 }, 0, ALONG, 1),
        Filler::new(Thing::PlainBench { w: 140 }, 0, ALONG, 1),
        Filler::new(Thing::Copier, 60, NICHE, 1),
        Filler::new(Thing::Lockers { columns: 3 }, 60, NICHE, 1),
        Filler::new(Thing::WaterCooler, 40, NICHE, 1),
        Filler::new(Thing::SmallPlant, 0, NICHE, 1),
        Filler::new(Thing::LargePlant, 0, NICHE, 1),
        Filler::new(Thing::Bin, 0, NICHE, 1),
    ]);
}

/// A reception, seats for those who wait, and what decorates an entrance.
pub fn hall(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let pattern = f.random.below(64) as u8;
    if area >= 20 {
        let desk = f.item(Thing::Reception { w: if area >= 45 { 320 } else { 200 } });
        let chair = f.item(Thing::SwivelChair { is_red: false, has_cross: true });
        let [w, d] = desk.size;
        let seat = units(1.0);
        // Whoever works there has the wall behind.
        let mut group = Group { size: [w, d + seat], ..Group::default() };
        group.put(&desk, [0, seat], 2);
        group.put_chair(&chair, [(w - chair.size[0]) / 2, seat - chair.size[1] - units(0.05)], 0);
        group.used.push(Rect { lo: [0, 0], hi: [w, seat] });
        group.used.push(Rect { lo: [0, seat + d], hi: [w, seat + d + units(0.8)] });
        f.against_wall(&group, &Wish { door: 1, middle: 1, chance: 3, ..Wish::default() });
    }
    if area >= 15 {
        seats(f, &Wish { window: 1, corner: 1, chance: 3, ..Wish::default() });
    }
    f.fill(&[
        Filler::new(Thing::LargePlant, 0, Wish::CORNER, 2),
        Filler::new(Thing::Leaflets, 50, Wish::ENTRY, 1),
        Filler::new(Thing::Sculpture, 0, Wish::CORNER, 1),
        Filler::new(Thing::Bench { seats: 3 }, 50, ALONG, 1),
        Filler::new(Thing::PlainBench { w: 160 }, 40, ALONG, 1),
        Filler::new(Thing::NoticeBoard { w: 120 }, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Picture { w: 160, h: 100, color: pattern }, 0, ALONG, 2),
        Filler::new(Thing::VendingMachine, 80, NICHE, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
        Filler::new(Thing::Bin, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Extinguisher, 0, Wish::ENTRY, 1),
    ]);
}

/// A sofa at a wall with a low table, and an armchair at its side.
fn seats(f: &mut Fitting, wish: &Wish) -> bool {
    let seats = 2 + f.random.below(2) as u8;
    let is_red = f.random.below(3) == 0;
    let sofa = f.item(Thing::Sofa { seats });
    let table = f.item(Thing::Table { w: 110, d: 60, h: 42 });
    let armchair = f.item(Thing::ClubChair { is_red });
    let [w, d] = sofa.size;
    let gap = units(0.4);
    // One comes to the table's far side, or past it.
    let reach = d + gap + table.size[1] + units(0.45);
    let with_armchair = |is_right: bool| {
        let arm_d = armchair.size[1];
        let mut group = Group { size: [w + gap + arm_d, d + gap + table.size[1]], ..Group::default() };
        let (sofa_u, arm_u, turns) = if is_right { (0, w + gap, 1) } else { (arm_d + gap, 0, 3) };
        group.put(&sofa, [sofa_u, 0], 0);
        group.put(&table, [sofa_u + (w - table.size[0]) / 2, d + gap], 0);
        group.put(&armchair, [arm_u, d + units(0.1)], turns);
        group.used.push(Rect { lo: [sofa_u, d], hi: [sofa_u + w, reach] });
        group
    };
    let mut alone = Group { size: [w, d + gap + table.size[1]], ..Group::default() };
    alone.put(&sofa, [0, 0], 0);
    alone.put(&table, [(w - table.size[0]) / 2, d + gap], 0);
    alone.used.push(Rect { lo: [0, d], hi: [w, reach] });
    let is_right = f.random.flip();
    let groups = [with_armchair(is_right), with_armchair(!is_right), alone];
    groups.iter().any(|group| group.faces() <= f.budget() && f.against_wall(group, wish))
}

/// A stairwell must stay free.
pub fn stair(f: &mut Fitting) {
    f.radiators();
    let pattern = f.random.below(64) as u8;
    f.fill(&[
        Filler::new(Thing::Sign, 0, Wish::ENTRY, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: pattern }, 0, ALONG, 1),
        Filler::new(Thing::Extinguisher, 0, ALONG, 1),
    ]);
}

/// Sofas around low tables, some small tables with chairs.
pub fn lounge(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let (pattern, is_red) = (f.random.below(64) as u8, f.random.flip());
    for _ in 0..(1 + area / 18).min(12) {
        if !seats(f, &Wish { window: 1, corner: 1, chance: 4, ..Wish::default() }) {
            break;
        }
    }
    let table = f.item(Thing::SideTable { w: 80, h: 74 });
    let chair = f.item(Thing::VisitorChair { is_red });
    let group = table_with_chairs(&table, &chair, [1, 0], units(0.65));
    let left = f.budget().saturating_sub(60) / group.faces().max(1);
    f.rows(&group, &[0, 1], &Spacing::spread([units(0.4), units(0.3)], units(0.2)), left);
    f.fill(&[
        Filler::new(Thing::LargePlant, 0, Wish::CORNER, 2),
        Filler::new(Thing::FloorLamp, 0, Wish::CORNER, 1),
        Filler::new(Thing::ClubChair { is_red }, 40, Wish::CORNER, 2),
        Filler::new(Thing::Leaflets, 50, Wish::ENTRY, 1),
        Filler::new(Thing::VendingMachine, 80, Wish::STORAGE, 1),
        Filler::new(Thing::WaterCooler, 40, Wish::STORAGE, 1),
        Filler::new(Thing::Picture { w: 120, h: 70, color: pattern }, 0, Wish::WALL, 2),
        Filler::new(Thing::Bookcase { w: 80, pattern: pattern % 8 }, 50, Wish::STORAGE, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}

/// Bookcases along the walls and back to back in rows, and tables to read at near the windows.
pub fn library(f: &mut Fitting) {
    f.radiators();
    let area = f.square_metres();
    let pattern = f.random.below(64) as u8;
    if area >= 14 {
        let table = f.item(Thing::Table { w: if area >= 30 { 200 } else { 120 }, d: 80, h: 74 });
        let chair = f.item(Thing::WoodenChair);
        let per_side = if area >= 30 { 3 } else { 1 };
        let group = table_with_chairs(&table, &chair, [per_side, 0], units(0.6));
        let light = Wish { window: 3, chance: 1, ..Wish::default() };
        let mut inset = Group { size: group.size, ..Group::default() };
        inset.add(&group, [0, units(0.1)], 0);
        inset.size[1] += units(0.1);
        f.against_wall(&inset, &light);
    }
    let enough = f.target() * 3 / 5;
    let turns = if f.random.flip() { [0, 1] } else { [1, 0] };
    for count in [5, 4, 3, 2, 1] {
        let case = f.item(Thing::Bookcase { w: 100, pattern: (pattern + count as u8) % 8 });
        let group = Group::double_row(&case, count, units(0.6));
        let left = enough.saturating_sub(f.faces()) / group.faces().max(1);
        f.rows(&group, &turns, &Spacing::spread([units(0.9), units(0.9)], units(0.85)), left);
    }
    f.fill(&[
        Filler::new(Thing::Bookcase { w: 100, pattern: pattern % 8 }, 60, Wish::STORAGE, 3),
        Filler::new(Thing::Bookcase { w: 100, pattern: (pattern + 3) % 8 }, 60, Wish::STORAGE, 3),
        Filler::new(Thing::Bookcase { w: 60, pattern: (pattern + 5) % 8 }, 60, Wish::STORAGE, 2),
        Filler::new(Thing::ClubChair { is_red: false }, 50, Wish::LIGHT, 1),
        Filler::new(Thing::SmallPlant, 0, Wish::LIGHT, 1),
        Filler::new(Thing::FloorLamp, 0, Wish::LIGHT, 1),
        Filler::new(Thing::Picture { w: 50, h: 70, color: pattern }, 0, Wish::WALL, 1),
        Filler::new(Thing::Clock, 0, Wish::WALL, 1),
    ]);
}
