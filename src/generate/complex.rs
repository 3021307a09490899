//! Buildings of several wings, before they are drawn.

use super::sheet::{Embedding, Turn};
use super::wing::{Wing, area};

/// A module of the drawing, units: a multiple of eight, so that roofs may slope by halves, quarters and eighths.
pub const MODULE: i32 = 104;
/// From floor to floor, modules.
pub const STOREY: i32 = 32;
/// Thickness of slabs, modules.
pub const SLAB: i32 = 3;
/// From floor to ceiling, modules.
pub const CLEAR: i32 = STOREY - SLAB;
/// Top of the ground around, modules.
pub(super) const GROUND: i32 = -1;
/// Bottom of the world, modules.
pub(super) const BOTTOM: i32 = -6;
/// Height of parapets and of an attic's eaves over its floor, modules.
pub(super) const PARAPET: i32 = 5;
/// Width of the world's edge around the building, modules.
pub(super) const AROUND: i32 = 100;

/// A roof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roof {
    /// Flat, with a parapet.
    Flat,
    /// Two slopes of one in two, over an attic.
    Gable,
}

/// A wing in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedWing {
    /// Its name, in front of all names in it.
    pub name: String,
    /// Its plan on each storey, from the ground up; all of the same size.
    pub storeys: Vec<Wing>,
    /// Where its south-west corner lies, units.
    pub origin: [i32; 2],
    /// How it is turned.
    pub turn: Turn,
    /// What covers it.
    pub roof: Roof,
}

/// Half a round building against the west end of the first wing, at its corridor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Apse {
    /// Its outer radius, modules.
    pub radius: i32,
    /// How many facets its wall has.
    pub facets: i32,
}

/// A three-cornered foyer between the north facade of the first wing and the west end of another, whose south-west
/// corner lies on that facade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foyer {
    /// The other wing.
    pub wing: usize,
    /// Where the foyer's west corner lies on the facade, units along the first wing.
    pub west: i32,
}

/// A building of wings.
#[derive(Clone, Debug, PartialEq)]
pub struct Complex {
    /// Its name.
    pub name: String,
    /// The wings; the first is not turned and lies at the origin.
    pub wings: Vec<PlacedWing>,
    /// Passages through the first wing's north wall, on all storeys: from where to where along it, units.
    pub ways: Vec<[i32; 2]>,
    /// Foyers to oblique wings.
    pub foyers: Vec<Foyer>,
    /// A round end.
    pub apse: Option<Apse>,
    /// Point lights in all, shared among the rooms by their area; each has at least one.
    pub lights: usize,
    /// Put furniture, sanitary ware and lamps into the rooms.
    pub furniture: bool,
    /// How much furniture, per cent of what is usual.
    pub fullness: u32,
    /// Identities, furniture, and how far the doors stand open, follow from it.
    pub seed: u64,
}

impl PlacedWing {
    /// A module along the wing, units: a multiple of the turn's denominator, so that corners fall on the grid.
    pub fn module(&self) -> i32 {
        let whole = self.turn.whole;
        if whole == 1 { MODULE } else { whole * ((MODULE + whole / 2) / whole).max(1) }
    }

    /// Its outer length and depth, units.
    pub fn size(&self) -> [i32; 2] {
        self.storeys.first().map_or([0; 2], |wing| wing.size().map(|m| m * self.module()))
    }

    /// Where its roof begins, units.
    pub(super) fn top(&self) -> i32 {
        self.storeys.len() as i32 * STOREY * MODULE
    }

    pub(super) fn embedding(&self) -> Embedding {
        Embedding::Turned { origin: self.origin, turn: self.turn }
    }

    /// Where a point of its frame, units, lies.
    pub fn place(&self, point: [i32; 2]) -> [i32; 2] {
        self.embedding().place(point)
    }
}

/// The areas of all rooms, square units, in the order in which they are drawn.
pub(super) fn room_areas(complex: &Complex) -> Vec<i64> {
    let mut areas = Vec::new();
    for placed in &complex.wings {
        let square = i64::from(placed.module()) * i64::from(placed.module());
        for wing in &placed.storeys {
            areas.extend(wing.storey().rooms.iter().map(|room| area(&room.rects) * square));
        }
        if placed.roof == Roof::Gable {
            // An attic is used little.
            areas.push(placed.size().map(i64::from).iter().product::<i64>() / 4);
        }
    }
    let storeys = complex.wings.first().map_or(0, |wing| wing.storeys.len());
    if let Some(apse) = complex.apse {
        let radius = i64::from(apse.radius * MODULE);
        areas.extend(std::iter::repeat_n(radius * radius * 3 / 2, storeys));
    }
    for foyer in &complex.foyers {
        let storeys = complex.wings.get(foyer.wing).map_or(0, |wing| wing.storeys.len()).min(storeys);
        areas.extend(std::iter::repeat_n(0, storeys));
    }
    areas
}

/// Shares `total` among rooms by their area: one for each, and of the rest the most to the largest.
pub(super) fn share(total: usize, areas: &[i64]) -> Vec<usize> {
    let rest = total.saturating_sub(areas.len()) as i64;
    let all: i64 = areas.iter().sum::<i64>().max(1);
    let mut shares: Vec<usize> =
        areas.iter().map(|a| 1 + (i128::from(*a) * i128::from(rest) / i128::from(all)) as usize).collect();
    let mut left = (areas.len() + rest as usize).saturating_sub(shares.iter().sum());
    let remainder = |i: usize| (i128::from(areas[i]) * i128::from(rest)) % i128::from(all);
    let mut order: Vec<usize> = (0..areas.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(remainder(i)), i));
    for i in order {
        if left == 0 {
            break;
        }
        shares[i] += 1;
        left -= 1;
    }
    shares
}
