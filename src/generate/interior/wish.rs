//! What stands where best.

use super::catalogue::Thing;

/// Where a group would best stand against a wall. Each number is what a metre of distance costs; negative: far is
/// better. All places differ a little by chance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wish {
    /// What it is worth to stand in a corner or beside something, in metres.
    pub corner: i32,
    /// From the nearest window.
    pub window: i32,
    /// From the nearest door.
    pub door: i32,
    /// From the wall's middle.
    pub middle: i32,
    /// What it is worth to look in a direction, in quarter turns, in metres.
    pub facing: Option<(u8, i32)>,
    /// How many metres chance is worth.
    pub chance: i32,
}

impl Wish {
    /// In a corner or beside something, away from windows: where cupboards stand.
    pub const STORAGE: Wish = Wish { corner: 3, window: -1, door: 0, middle: 0, facing: None, chance: 2 };
    /// In the light.
    pub const LIGHT: Wish = Wish { corner: 1, window: 2, door: 0, middle: 0, facing: None, chance: 1 };
    /// Near the door.
    pub const ENTRY: Wish = Wish { corner: 2, window: 0, door: 2, middle: 0, facing: None, chance: 1 };
    /// Anywhere in a corner.
    pub const CORNER: Wish = Wish { corner: 4, window: 0, door: 0, middle: 0, facing: None, chance: 4 };
    /// Amid a wall.
    pub const WALL: Wish = Wish { corner: 0, window: 0, door: 0, middle: 1, facing: None, chance: 3 };
}

/// A small thing to fill a room with.
#[derive(Clone, Copy, Debug)]
pub struct Filler {
    /// What it is.
    pub thing: Thing,
    /// How much floor in front of it is kept to use it, centimetres.
    pub front: i32,
    /// Where.
    pub wish: Wish,
    /// How many of it at most; in small rooms.
    pub most: u32,
}

impl Filler {
    /// A filler.
    pub const fn new(thing: Thing, front: i32, wish: Wish, most: u32) -> Filler {
        Filler { thing, front, wish, most }
    }
}
