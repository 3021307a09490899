//! Buildings on demand, whose truth is known.
//!
//! A generated [`Building`] is made of closed, tagged volumes that fill a box of space exactly and overlap nowhere:
//! rooms, openings, walls, slabs, the exterior; and of details that stand in its air: doors, windows, furniture.
//! The same options give the same bytes on every machine.
//!
//! ```
//! use enfilade::generate::{HouseOptions, house};
//!
//! let house = house(&HouseOptions::default());
//! let rooms = house.elements.iter().filter(|e| e.class == "IfcSpace");
//! assert_eq!(rooms.count(), 8);
//! let glb: Vec<u8> = house.to_glb();
//! assert!(glb.starts_with(b"glTF"));
//! ```
//!
//! How it works: [`house`] paints labels into boxes of space (`draft`, `plan`); where labels meet there are faces,
//! joined to polygons with holes (`patches`, `outline`); the writers cut these up (`triangulate`).

mod attach;
mod building;
mod complex;
mod compose;
mod draft;
mod drawing;
mod flush;
mod foyer;
mod furnish;
mod furniture;
mod global_id;
mod holes;
mod house;
mod interior;
mod joinery;
mod lattice;
mod offices;
mod outline;
mod palette;
mod patches;
mod plan;
mod random;
mod roofs;
mod round_end;
mod round_room;
mod sheet;
mod sides;
mod specimens;
mod stair;
mod style;
mod to_model;
mod triangulate;
mod truth;
mod uses;
mod views;
mod wing;
mod write;
mod write_glb;
mod write_obj;

#[cfg(test)]
mod tests;

pub use building::{Building, Element, Face, Kind};
pub use house::{HouseOptions, house};
pub use lattice::{PER_METRE, Point, metres};
pub use offices::{OfficeOptions, TowerOptions, build1, build2, build3, tower};
pub use random::random;
pub use round_room::{RoundRoomOptions, round_room};
pub use specimens::{Specimen, specimens};
pub use style::{Export, Style, Unit};
pub use truth::{AirTruth, OpeningTruth, PointTruth, PortalTruth, RoomTruth, Truth};
pub use write::{WriteError, write};
