//! Furnishing any room: what stands in it follows from what it is for, its plan, its doors and windows, and a seed.
//!
//! A [`Furnisher`] puts furniture into a [`Room`] whose plan is a union of rectangles, and [`lamps`] says where its
//! ceiling lamps hang. Both work in units of the [lattice](super::lattice) and know nothing of how buildings are
//! drawn: what comes out is pieces and where they stand.
//!
//! What holds for every room: each box of each piece lies in the room, on its floor or above it, and under its
//! ceiling; no two boxes of two pieces overlap; nothing stands where the floor must be kept clear, and nothing
//! higher than its sill in front of a window; from each door one gets to all doors that could be reached from it in
//! the empty room, and to the front of every piece that is used.
//!
//! How it works: the plan becomes a [`region`] with walls. A program for each use ([`work`], [`public`],
//! [`service`], [`home`]) draws [groups](group) of [things](catalogue), a desk with its chair, a table with chairs
//! around it, and asks the [`fitting`] to put them where they fit, best places first. Then small things are added
//! until the room shows as many faces as is usual for its use.

mod catalogue;
mod count;
mod fitting;
mod group;
mod home;
mod lamps;
mod pieces;
mod public;
mod random;
mod region;
mod service;
mod spacing;
mod uses;
mod walkway;
mod wish;
mod work;

#[cfg(test)]
mod tests;

use crate::importers::Semantic;

use super::furniture::Piece;
use super::lattice::{Placement, Rect, units};

pub use lamps::lamps;
pub use uses::Use;

/// Between the tops of pieces and the ceiling: there lamps hang.
const HEADROOM: f64 = 0.3;

/// How far the space in front of a window reaches.
const BEFORE_WINDOW: f64 = 0.45;

/// Rooms of more rectangles than this stay empty.
const MOST_RECTS: usize = 256;

/// A window in one of the room's walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// One end, in the plan, on the wall's face in the room.
    pub from: [i32; 2],
    /// The other end; on the same line along an axis.
    pub to: [i32; 2],
    /// Height of the sill, in the frame of [`Room::floor`].
    pub sill: i32,
}

impl Window {
    /// The floor in front of it on both sides of the wall.
    fn front(&self) -> Rect {
        let Rect { mut lo, mut hi } = Rect::between(self.from, self.to);
        let across = usize::from(self.is_along_x());
        let depth = units(BEFORE_WINDOW);
        (lo[across], hi[across]) = (lo[across].saturating_sub(depth), hi[across].saturating_add(depth));
        Rect { lo, hi }
    }

    fn is_along_x(&self) -> bool {
        let span = [0, 1].map(|i| i64::from(self.from[i]).abs_diff(i64::from(self.to[i])));
        span[0] >= span[1]
    }
}

/// A room to furnish. Its plan is in units of the lattice, in any frame whose axes are parallel to its walls.
#[derive(Clone, Copy, Debug)]
pub struct Room<'a> {
    /// What it is for.
    pub use_: Use,
    /// Its plan: the union of rectangles, which may overlap or adjoin.
    pub rects: &'a [Rect],
    /// What is no part of it: columns, shafts, flights of stairs. Pieces may stand beside it.
    pub solids: &'a [Rect],
    /// Height of its floor, units.
    pub floor: i32,
    /// Height of its ceiling, where it is lowest.
    pub ceiling: i32,
    /// Floor on which nothing stands, and which one can walk to: in front of each door and of stairs.
    pub keep_clear: &'a [Rect],
    /// Its windows.
    pub windows: &'a [Window],
    /// How full it is, per cent of what is usual for its use ([`Use::density`]).
    pub fullness: u32,
    /// All choices follow from it.
    pub seed: u64,
}

/// A piece and where it stands.
#[derive(Clone, Debug)]
pub struct Placed {
    /// Its name, unique in its room: "Desk 2", or "Desk" if there is one only.
    pub name: String,
    /// What it is.
    pub semantic: Semantic,
    /// Its IFC class.
    pub class: &'static str,
    /// Its shape.
    pub piece: Piece,
    /// Where it stands.
    pub place: Placement,
    /// How many of its faces can be seen: those that lie neither on the floor nor flush on a wall.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests hold the budgets to it"))]
    pub faces: u32,
}

/// Furnishes rooms. It remembers what things look like, so one of it for many rooms is fastest; what it makes of a
/// room does not depend on the rooms before.
#[derive(Debug, Default)]
pub struct Furnisher {
    catalogue: catalogue::Catalogue,
}

impl Furnisher {
    /// A new one.
    pub fn new() -> Furnisher {
        Furnisher::default()
    }

    /// What stands in a room. The same room always gets the same.
    pub fn furnish(&mut self, room: &Room) -> Vec<Placed> {
        self.fitted(room).map_or_else(Vec::new, fitting::Fitting::finish)
    }

    fn fitted<'a>(&'a mut self, room: &'a Room<'a>) -> Option<fitting::Fitting<'a>> {
        let mut fitting = fitting::Fitting::new(&mut self.catalogue, room)?;
        match room.use_ {
            Use::Office => work::office(&mut fitting),
            Use::OpenOffice => work::open_office(&mut fitting),
            Use::Meeting => work::meeting(&mut fitting),
            Use::Conference => work::conference(&mut fitting),
            Use::Classroom => work::classroom(&mut fitting),
            Use::Corridor => public::corridor(&mut fitting),
            Use::Hall => public::hall(&mut fitting),
            Use::Stair => public::stair(&mut fitting),
            Use::Lounge => public::lounge(&mut fitting),
            Use::Library => public::library(&mut fitting),
            Use::Toilet => service::toilet(&mut fitting),
            Use::Storage => service::storage(&mut fitting),
            Use::Kitchenette => service::kitchenette(&mut fitting),
            Use::Server => service::server(&mut fitting),
            Use::Living => home::living(&mut fitting),
            Use::Kitchen => home::kitchen(&mut fitting),
            Use::Bedroom => home::bedroom(&mut fitting),
            Use::Bath => home::bath(&mut fitting),
            Use::Attic => home::attic(&mut fitting),
        }
        Some(fitting)
    }
}
