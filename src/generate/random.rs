//! Random buildings: the same seed always makes the same one.

use super::attach::{Attached, Outline};
use super::building::Building;
use super::complex::{Apse, Roof};
use super::drawing::draw;
use super::offices::OfficeOptions;
use super::uses::Use;
use super::wing::{Bay, End, Facade, Wing};
use crate::splitmix::SplitMix64;

/// A building of one to four storeys that follows from the options' seed: of one wing or more, with rooms of many sizes
/// and shapes, perhaps a round end, an attic, a wing turned by some angle.
pub fn random(options: &OfficeOptions) -> Building {
    let mut dice = Dice(SplitMix64::new(options.seed ^ 0x656E_6669_6C61_6465));
    let storeys = [1, 1, 1, 2, 2, 3, 4][dice.below(7)];
    let has_hall = storeys > 1 && dice.one_in(2);
    let has_attic = dice.one_in(3);
    let has_apse = dice.one_in(2);
    let has_wing = dice.one_in(2);
    let corridor = dice.between(16, 28);
    // An even depth in all, so that a ridge falls on the grid.
    let south = dice.between(50, 64);
    let north = dice.between(24, 36) * 2 - south % 2 - corridor % 2;
    let ends = [if has_apse { End::Passage } else { End::Window }, dice.pick(&[End::Window, End::Blind])];
    let goes_up = storeys > 1 || has_attic;
    let count = dice.between(3, 9) as usize;
    let uses = if dice.one_in(3) { &HOMES[..] } else { &OFFICES[..] };
    let mut rows = [dice.row(count, uses), dice.row(count, uses)];
    if goes_up {
        rows[0].insert(0, Bay { width: dice.between(24, 32), ..bay(Use::Stair) });
    }
    let hall = has_hall.then(|| {
        rows[0].push(Bay { width: dice.between(60, 120), ..bay(Use::Hall) });
        rows[0].len() - 1
    });
    // The way to another wing.
    let way = has_wing.then(|| {
        let place = rows[1].len();
        rows[1].push(Bay { width: 26, ..bay(Use::Corridor) });
        // What the other wing stands against.
        rows[1].extend([Bay { width: 60, ..bay(Use::Lounge) }, Bay { width: 100, ..bay(Use::OpenOffice) }]);
        place
    });
    // Far enough from the west end that a wing of any angle does not reach beyond it.
    if way.is_some() {
        rows[1].insert(0, Bay { width: 90, ..bay(Use::Conference) });
    }
    let way = way.map(|place| place + 1);
    let storey = |k: usize| {
        let mut bays = rows.clone();
        if let Some(hall) = hall.filter(|_| k == 1) {
            bays[0][hall].room = None;
        } else if let Some(hall) = hall.filter(|_| k > 1) {
            bays[0][hall].room = Some(Use::OpenOffice);
        }
        Wing { bays, depth: [south, north], corridor, ends }
    };
    let main: Vec<Wing> = (0..storeys).map(storey).collect();
    let [first, last] = [main[0].corridor_rows(), main[0].size()];
    let middle = (first[0] + first[1]) / 2;
    let most = middle.min(last[1] - middle) - 1;
    let apse =
        has_apse.then(|| Apse { radius: dice.between(most * 2 / 3, most), facets: dice.between(4, 40) });
    let attached = way.map(|bay| {
        let degrees = dice.pick(&[90.0, 75.0, 67.0, 60.0, 53.0, 45.0, 37.0, 30.0]);
        let count = dice.between(2, 7) as usize;
        let bays = [dice.row(count, uses), dice.row(count, uses)];
        let west = if degrees == 90.0 { End::Open } else { End::Passage };
        let depth = [dice.between(40, 52), dice.between(40, 52)];
        let wing = Wing { bays, depth, corridor: 20, ends: [west, End::Window] };
        Attached { name: "Side wing", storeys: vec![wing; storeys], bay, degrees }
    });
    let roof = if has_attic { Roof::Gable } else { Roof::Flat };
    let attached = attached.into_iter().collect();
    let mut outline = Outline { name: "Random", main, roof, attached, apse, lights: 0, fullness: 100 };
    outline.lights = storeys * 20 + dice.below(20);
    draw(&outline.complex(options.furniture, options.seed))
}

fn bay(use_: Use) -> Bay {
    Bay { width: 30, room: Some(use_), facade: Facade::Own, is_blind: false }
}

/// What rooms of offices are for, the most frequent several times.
const OFFICES: [Use; 10] = [
    Use::Office,
    Use::Office,
    Use::Office,
    Use::Meeting,
    Use::Toilet,
    Use::Storage,
    Use::Kitchenette,
    Use::Server,
    Use::Classroom,
    Use::Lounge,
];

/// What rooms of homes are for.
const HOMES: [Use; 6] = [Use::Living, Use::Kitchen, Use::Bedroom, Use::Bedroom, Use::Bath, Use::Storage];

/// What is drawn for a building.
struct Dice(SplitMix64);

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.0.below(end as u64) as usize
    }

    /// From `low` to `high`, both included.
    fn between(&mut self, low: i32, high: i32) -> i32 {
        low + self.below((high - low + 1).max(1) as usize) as i32
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// A row of rooms, of which some take a neighbour's half.
    fn row(&mut self, count: usize, uses: &[Use]) -> Vec<Bay> {
        let mut row: Vec<Bay> = (0..count)
            .map(|_| {
                let use_ = self.pick(uses);
                let width = match use_ {
                    Use::Meeting | Use::Classroom | Use::Lounge | Use::Living => self.between(40, 80),
                    _ => self.between(22, 44),
                };
                Bay { width, ..bay(use_) }
            })
            .collect();
        // Only between bays that keep their own: what a room takes, no other can.
        let mut i = 1;
        while i + 1 < row.len() {
            row[i].facade =
                self.pick(&[Facade::Own, Facade::Own, Facade::Own, Facade::West, Facade::East, Facade::Both]);
            i += if row[i].facade == Facade::Own { 1 } else { 2 };
        }
        row
    }
}
