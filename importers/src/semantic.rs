//! What an element is, and what that makes of it.
//!
//! The numbers of [`Semantic`] are written into compiled scenes and ray records. They are documented in
//! `docs/FORMAT.md` and never change: new meanings get new numbers. Numbers from 64 on belong to *faces* (portal,
//! wallpaper, facade...), which name what a face separates.

use std::fmt;
use std::str::FromStr;

/// The meaning of an element, as its tag gives it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
#[non_exhaustive]
pub enum Semantic {
    /// No tag was found. The role follows from the mesh and from [`Untagged`].
    #[default]
    Unknown = 0,

    /// Air of a room.
    Room = 1,
    /// Air of the hole that a door fills.
    Door = 2,
    /// Air of the hole that a window fills.
    Window = 3,
    /// Air of a hole that nothing fills.
    Opening = 4,
    /// Air of a stairwell, over several storeys.
    Stairwell = 5,
    /// Air outside the building.
    Exterior = 6,
    /// Air that no label names and that does not reach the exterior. Made by the compiler, never by a tag.
    Void = 7,

    /// A wall.
    Wall = 16,
    /// A slab, a floor, a footing.
    Ground = 17,
    /// A ceiling, suspended or not.
    Ceiling = 18,
    /// A roof.
    Roof = 19,
    /// A column.
    Column = 20,
    /// A beam.
    Beam = 21,

    /// Furniture.
    Furniture = 32,
    /// Stairs and ramps.
    Stair = 33,
    /// Railings.
    Railing = 34,
    /// The leaf and the frame of a door (the solid thing; its hole is [`Semantic::Door`]).
    DoorLeaf = 35,
    /// The frame and the panes of a window (the solid thing; its hole is [`Semantic::Window`]).
    WindowFrame = 36,
    /// Glass of curtain walls and skylights.
    Glass = 37,
    /// Terrain and site.
    Site = 38,
    /// Pipes, ducts, sanitary ware, lamps, lifts.
    Equipment = 39,
    /// Cladding, flooring and other finishes.
    Covering = 40,
    /// A thing known by class, but of no class above (proxies).
    Other = 41,

    /// Annotations, grids, axes: left out.
    Annotation = 48,
}

/// What an element's triangles do to the space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u32)]
pub enum Role {
    /// A label of air: light passes, rays do not see its triangles.
    Air = 0,
    /// Carves space where its mesh is closed.
    Solid = 1,
    /// Exact triangles inside the air.
    Detail = 2,
    /// Left out.
    Ignore = 3,
}

/// What to make of elements that no tag names (`--untagged`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Untagged {
    /// Closed meshes are solid, others detail; a warning counts them.
    #[default]
    ByMesh,
    /// Solid (carving still needs a closed mesh).
    Solid,
    /// Detail.
    Detail,
    /// An error that names the first such elements.
    Error,
}

const TABLE: &[(Semantic, &str, Option<Role>)] = &[
    (Semantic::Unknown, "UNKNOWN", None),
    (Semantic::Room, "ROOM", Some(Role::Air)),
    (Semantic::Door, "DOOR", Some(Role::Air)),
    (Semantic::Window, "WINDOW", Some(Role::Air)),
    (Semantic::Opening, "OPENING", Some(Role::Air)),
    (Semantic::Stairwell, "STAIRWELL", Some(Role::Air)),
    (Semantic::Exterior, "EXTERIOR", Some(Role::Air)),
    (Semantic::Void, "VOID", Some(Role::Air)),
    (Semantic::Wall, "WALL", Some(Role::Solid)),
    (Semantic::Ground, "GROUND", Some(Role::Solid)),
    (Semantic::Ceiling, "CEILING", Some(Role::Solid)),
    (Semantic::Roof, "ROOF", Some(Role::Solid)),
    (Semantic::Column, "COLUMN", Some(Role::Solid)),
    (Semantic::Beam, "BEAM", Some(Role::Solid)),
    (Semantic::Furniture, "FURNITURE", Some(Role::Detail)),
    (Semantic::Stair, "STAIR", Some(Role::Detail)),
    (Semantic::Railing, "RAILING", Some(Role::Detail)),
    (Semantic::DoorLeaf, "DOOR_LEAF", Some(Role::Detail)),
    (Semantic::WindowFrame, "WINDOW_FRAME", Some(Role::Detail)),
    (Semantic::Glass, "GLASS", Some(Role::Detail)),
    (Semantic::Site, "SITE", Some(Role::Detail)),
    (Semantic::Equipment, "EQUIPMENT", Some(Role::Detail)),
    (Semantic::Covering, "COVERING", Some(Role::Detail)),
    (Semantic::Other, "OTHER", Some(Role::Detail)),
    (Semantic::Annotation, "ANNOTATION", Some(Role::Ignore)),
];

impl Semantic {
    /// All meanings, in the order of their numbers.
    pub fn all() -> impl Iterator<Item = Semantic> {
        TABLE.iter().map(|row| row.0)
    }

    /// The number that files and ray records carry.
    pub const fn number(self) -> u32 {
        self as u32
    }

    /// The meaning with this number, if there is one.
    pub fn from_number(number: u32) -> Option<Semantic> {
        TABLE.iter().map(|row| row.0).find(|s| s.number() == number)
    }

    /// The word for it in capitals, as tags, rules and reports write it: `ROOM`, `DOOR_LEAF`...
    pub fn name(self) -> &'static str {
        TABLE.iter().find(|row| row.0 == self).map_or("UNKNOWN", |row| row.1)
    }

    /// The role that the meaning gives; `None` for [`Semantic::Unknown`], whose role follows from the mesh.
    pub fn role(self) -> Option<Role> {
        TABLE.iter().find(|row| row.0 == self).and_then(|row| row.2)
    }
}

impl Role {
    /// The word for it, as reports write it.
    pub const fn name(self) -> &'static str {
        match self {
            Role::Air => "air",
            Role::Solid => "solid",
            Role::Detail => "detail",
            Role::Ignore => "ignore",
        }
    }

    /// The role with this number, if there is one.
    pub const fn from_number(number: u32) -> Option<Role> {
        match number {
            0 => Some(Role::Air),
            1 => Some(Role::Solid),
            2 => Some(Role::Detail),
            3 => Some(Role::Ignore),
            _ => None,
        }
    }
}

impl fmt::Display for Semantic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The word is none of the known meanings.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{0}' is no semantic word (ROOM, WALL, GROUND, DOOR...)")]
pub struct UnknownWord(pub String);

impl FromStr for Semantic {
    type Err = UnknownWord;

    /// Any case; `-` and blanks count as `_`. `VOID` and `UNKNOWN` are no tags. A few everyday words are taken for
    /// the meaning they plainly name: `SLAB` and `FLOOR` for `GROUND`, `IGNORE` for `ANNOTATION`...
    /// (`docs/TAGGING.md` has them all).
    fn from_str(word: &str) -> Result<Semantic, UnknownWord> {
        let upper: String = word
            .trim()
            .chars()
            .map(|c| if c == '-' || c == ' ' { '_' } else { c.to_ascii_uppercase() })
            .collect();
        let upper = match upper.as_str() {
            "SLAB" | "FLOOR" | "FOOTING" | "FOUNDATION" => "GROUND",
            "DOORWAY" => "DOOR",
            "PILLAR" => "COLUMN",
            "HANDRAIL" | "GUARDRAIL" => "RAILING",
            "IGNORE" | "GRID" => "ANNOTATION",
            "OUTSIDE" => "EXTERIOR",
            "TERRAIN" => "SITE",
            "STAIRS" | "STAIRCASE" | "RAMP" => "STAIR",
            other => other,
        };
        TABLE
            .iter()
            .find(|row| row.1 == upper && !matches!(row.0, Semantic::Unknown | Semantic::Void))
            .map(|row| row.0)
            .ok_or_else(|| UnknownWord(word.trim().to_owned()))
    }
}

/// The IFC class with which `name` begins, as some tools write it (`IfcWall/Wall 1`, `IfcDoor.003`, `IfcSlab`).
#[cfg(any(feature = "gltf", feature = "rules"))]
pub(crate) fn class_in(name: &str) -> Option<&str> {
    let name = name.trim_start();
    let end = name.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(name.len());
    let class = &name[..end];
    let is_ifc = class.len() > 3 && class.as_bytes()[..3].eq_ignore_ascii_case(b"ifc");
    is_ifc.then_some(class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_names_and_words_agree() {
        for s in Semantic::all() {
            assert_eq!(Semantic::from_number(s.number()), Some(s));
            let parsed = s.name().parse::<Semantic>();
            if matches!(s, Semantic::Unknown | Semantic::Void) {
                assert!(parsed.is_err());
            } else {
                assert_eq!(parsed, Ok(s));
                assert!(s.role().is_some());
            }
        }
        let mut numbers: Vec<u32> = Semantic::all().map(Semantic::number).collect();
        numbers.dedup();
        assert_eq!(numbers.len(), TABLE.len());
        assert!(numbers.iter().all(|&n| n < 64), "64 and up belong to faces");
        assert_eq!("door leaf".parse(), Ok(Semantic::DoorLeaf));
        assert_eq!("Slab".parse(), Ok(Semantic::Ground));
        assert!("kitchen".parse::<Semantic>().is_err());
    }

    #[test]
    fn published_numbers_never_change() {
        let expected = [
            ("UNKNOWN", 0),
            ("ROOM", 1),
            ("DOOR", 2),
            ("WINDOW", 3),
            ("OPENING", 4),
            ("STAIRWELL", 5),
            ("EXTERIOR", 6),
            ("VOID", 7),
            ("WALL", 16),
            ("GROUND", 17),
            ("CEILING", 18),
            ("ROOF", 19),
            ("COLUMN", 20),
            ("BEAM", 21),
            ("FURNITURE", 32),
            ("STAIR", 33),
            ("RAILING", 34),
            ("DOOR_LEAF", 35),
            ("WINDOW_FRAME", 36),
            ("GLASS", 37),
            ("SITE", 38),
            ("EQUIPMENT", 39),
            ("COVERING", 40),
            ("OTHER", 41),
            ("ANNOTATION", 48),
        ];
        let actual: Vec<_> = Semantic::all().map(|s| (s.name(), s.number())).collect();
        assert_eq!(actual, expected);
    }
}
