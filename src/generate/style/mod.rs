//! Export styles: a building as real tools write it, one oddity at a time or many at once.
//!
//! A generated building is exact. Real exports are not: walls run into each other, rooms keep a distance of some
//! millimetres from their walls, names are missing, triangles stand twice. A [`Style`] says which of that to do to a
//! building on its way to a file; `docs/GENERATE.md` tells what each option imitates.
//!
//! How it works: `cut` and `floors` draw new bodies on the grid; `ends` and `rooms` say by how much which planes of
//! a body move, and `planes` moves them; `place` turns and moves the whole; `identity` names things; `mesh` cuts faces
//! into triangles or polygons as a file holds them. All chance comes from `dice`.

mod cut;
mod dice;
mod ends;
mod export;
mod floors;
mod identity;
mod mesh;
mod place;
mod planes;
mod rooms;

#[cfg(test)]
mod tests;

pub use export::Export;
pub(super) use export::Object;
pub(super) use mesh::{Cut, Part};
pub(super) use place::Placement;

use dice::Dice;

/// How a building is written: which oddities of real exports it gets.
///
/// Every option is independent of the others, and off in [`Style::exact`]. Most are *shares*, from 0 (never) to 1
/// (always): how likely it is that an element gets the oddity. Which elements those are follows from
/// [`Style::seed`] and the elements' identities alone. What lies outside 0..=1 counts as the nearest end. Some are lengths ([`Style::room_gap`]):
/// all elements get the oddity, by so much; what is no finite number counts as zero.
///
/// ```
/// use enfilade::generate::{HouseOptions, Style, house};
///
/// let house = house(&HouseOptions::default());
/// let mut style = Style::exact();
/// style.rooms_smaller = 1.0;
/// let glb: Vec<u8> = house.export(&style).to_glb();
/// assert_ne!(glb, house.to_glb());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Style {
    /// Where the random numbers start.
    pub seed: u64,

    /// Walls whose ends, where they meet other solids, run on into them: by a quarter of the wall's thickness up to
    /// all of it, but not through what they meet.
    pub wall_ends: f64,
    /// Walls cut into two bodies that touch: one element, two closed bodies, the cut's corners and faces on both sides
    /// the same.
    pub walls_touching: f64,
    /// Walls cut into two bodies that overlap by 20 mm: one element of two closed components.
    pub walls_lapped: f64,
    /// Walls cut in two by a single inner face, which belongs to both halves: edges with three faces. Such a wall is
    /// not closed.
    pub walls_inner_face: f64,
    /// Openings that stick out of their walls at both ends, by 10 to 150 mm.
    pub openings_protruding: f64,
    /// Openings that end within their wall, at one end or at both, by 5 mm to a quarter of the wall's thickness.
    pub openings_shallow: f64,
    /// Rooms that end 0.1 to 10 mm before their walls, floors and ceilings: by one distance for all sides, one for
    /// what is below and one for what is above.
    pub rooms_smaller: f64,
    /// Rooms that reach 0.1 to 10 mm into their walls, floors and ceilings.
    pub rooms_larger: f64,
    /// Rooms with a finish floor: a covering of 10 to 30 mm that lies on the slab, within the room's volume.
    pub floors: f64,
    /// Rooms with a finish floor on which the room's volume begins.
    pub floors_below: f64,

    /// Elements without a name.
    pub nameless: f64,
    /// Elements with the name of the first of their class.
    pub doubled_names: f64,
    /// Elements with the `global_id` of an earlier one.
    pub doubled_ids: f64,
    /// Openings that are left out.
    pub openings_missing: f64,
    /// Rooms that are left out.
    pub rooms_missing: f64,
    /// A space over all rooms of each storey, with the storey's name; in glTF the rooms' nodes are below it.
    pub storey_spaces: bool,

    /// Faces of the file (triangles in glTF, polygons in OBJ) that it has twice.
    pub doubled_faces: f64,
    /// Elements whose faces all look inward.
    pub inside_out: f64,
    /// Elements of whose faces about half look inward.
    pub mixed_winding: f64,
    /// Elements whose faces share no vertices; equal corners have equal coordinates.
    pub unwelded: f64,
    /// Elements whose faces share no vertices, and whose corners are each off by up to 1 micrometre along each axis:
    /// such an element is not closed.
    pub noisy_corners: f64,
    /// Elements of several materials that become a group with a child for each material. In OBJ, which has no groups
    /// of that kind, an object for each material, without identity.
    pub split_by_material: f64,

    /// By how far all faces of rooms end before where they were drawn, metres; if negative, how far they reach beyond. Added to what
    /// [`Style::rooms_smaller`] and [`Style::rooms_larger`] do. A room that cannot follow stays.
    pub room_gap: f64,
    /// The same of solids: walls, slabs, columns, roofs.
    pub solid_gap: f64,
    /// By how far each corner of each element is off at most, along each axis, metres, by chance: no face is quite planar, neighbours miss
    /// each other.
    pub jitter: f64,
    /// By how far each corner of each face is off at most, along each axis, metres, by chance: no element is closed. Added to what
    /// [`Style::noisy_corners`] does.
    pub noise: f64,

    /// Moves everything by a third of a metre and the like, and each corner of each element by up to 5 micrometres
    /// along each axis: no coordinate is a round number, and no face is quite planar.
    pub off_grid: bool,
    /// Turns everything by 23.7 degrees about the vertical, counter-clockwise seen from above.
    pub turned: bool,
    /// Places everything 5,400 km away: in glTF by the matrix of a node above all others, in OBJ by the coordinates.
    pub far: bool,
    /// The unit of coordinates: in glTF the node above all others has the scale, in OBJ nothing says so.
    pub unit: Unit,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unit {
    /// 1 m.
    #[default]
    Metre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
}

impl Unit {
    /// Metres in one unit.
    pub const fn metres(self) -> f64 {
        match self {
            Unit::Metre => 1.0,
            Unit::Centimetre => 0.01,
            Unit::Millimetre => 0.001,
        }
    }

    /// What several of it are called.
    pub(super) const fn plural(self) -> &'static str {
        match self {
            Unit::Metre => "metres",
            Unit::Centimetre => "centimetres",
            Unit::Millimetre => "millimetres",
        }
    }
}

impl Style {
    /// The building as it is: every option off.
    pub fn exact() -> Style {
        Style::default()
    }

    /// The usual mix of a drawing tool's export: everything a little off, in names, rooms and walls, nothing broken
    /// beyond what such files are.
    pub fn cad(seed: u64) -> Style {
        Style {
            seed,
            wall_ends: 0.8,
            walls_touching: 0.05,
            walls_lapped: 0.05,
            openings_protruding: 0.4,
            openings_shallow: 0.1,
            rooms_smaller: 0.6,
            rooms_larger: 0.1,
            floors: 0.2,
            floors_below: 0.4,
            nameless: 0.2,
            doubled_names: 0.3,
            openings_missing: 0.05,
            mixed_winding: 0.03,
            doubled_faces: 0.002,
            unwelded: 1.0,
            off_grid: true,
            ..Style::default()
        }
    }

    /// All oddities, each with probability `p`: every share is `p`, and each option that is for the whole building is
    /// on with probability `p`, by the seed. What is no probability counts as the nearest one.
    pub fn damage(p: f64, seed: u64) -> Style {
        let mut style = Style { seed, ..Style::default() };
        style.shares_mut().into_iter().for_each(|(_, share)| *share = p);
        let dice = Dice::new(seed);
        let is_on = |option: &str| dice.hits(p, "damage", option);
        style.storey_spaces = is_on("storey-spaces");
        style.off_grid = is_on("off-grid");
        style.turned = is_on("turned");
        style.far = is_on("far");
        if is_on("unit") {
            let is_small = dice.draw("damage", "which unit").fraction() < 0.5;
            style.unit = if is_small { Unit::Millimetre } else { Unit::Centimetre };
        }
        style
    }

    /// All options that are lengths, with the names that the command line gives them.
    pub fn lengths_mut(&mut self) -> [(&'static str, &mut f64); 4] {
        [
            ("room-gap", &mut self.room_gap),
            ("solid-gap", &mut self.solid_gap),
            ("jitter", &mut self.jitter),
            ("noise", &mut self.noise),
        ]
    }

    /// All options that are shares, with the names that the command line gives them.
    pub fn shares_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
        vec![
            ("wall-ends", &mut self.wall_ends),
            ("walls-touching", &mut self.walls_touching),
            ("walls-lapped", &mut self.walls_lapped),
            ("walls-inner-face", &mut self.walls_inner_face),
            ("openings-protruding", &mut self.openings_protruding),
            ("openings-shallow", &mut self.openings_shallow),
            ("rooms-smaller", &mut self.rooms_smaller),
            ("rooms-larger", &mut self.rooms_larger),
            ("floors", &mut self.floors),
            ("floors-below", &mut self.floors_below),
            ("nameless", &mut self.nameless),
            ("doubled-names", &mut self.doubled_names),
            ("doubled-ids", &mut self.doubled_ids),
            ("openings-missing", &mut self.openings_missing),
            ("rooms-missing", &mut self.rooms_missing),
            ("doubled-faces", &mut self.doubled_faces),
            ("inside-out", &mut self.inside_out),
            ("mixed-winding", &mut self.mixed_winding),
            ("unwelded", &mut self.unwelded),
            ("noisy-corners", &mut self.noisy_corners),
            ("split-by-material", &mut self.split_by_material),
        ]
    }
}
