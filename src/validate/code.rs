//! The codes of findings.

use serde::Serialize;

/// What a constraint is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// The map.
    Topological,
    /// Where its cells are.
    Geometric,
    /// What they mean.
    Semantic,
}

/// What can be found. Codes never change their meaning; new ones get new numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[non_exhaustive]
pub enum Code {
    /// An alpha is no involution.
    T01,
    /// alpha 0 alpha 2, alpha 0 alpha 3 or alpha 1 alpha 3 is no involution.
    T02,
    /// A volume is open: alpha 0, 1 or 2 of a dart is free.
    T03,
    /// A volume is no ball.
    T04,
    /// The map is not in one piece, not orientable, or has a wrong Euler characteristic.
    T05,
    /// A face has nothing beyond it by alpha 3, but is between two volumes; or the other way around.
    T06,
    /// What is known of darts, volumes and faces is not what the map has.
    T07,
    /// A footprint is not convex.
    G01,
    /// The map is not one of prisms: their parts are not where they say.
    G02,
    /// Volumes do not fill the hull.
    G03,
    /// A vertex is off a plane that it is in.
    G04,
    /// A face's area is not that of its corners.
    G05,
    /// A door, window or opening joins fewer than two volumes of air.
    S01,
    /// Air leaks from a room into the open, other than by a door, a window or an opening.
    S02,
    /// A room has no floor, or no ceiling.
    S03,
    /// A room that nothing joins to anything.
    S04,
    /// A face is not called what it separates.
    S05,
}

impl Code {
    /// All, in order.
    pub const ALL: [Code; 17] = [
        Code::T01,
        Code::T02,
        Code::T03,
        Code::T04,
        Code::T05,
        Code::T06,
        Code::T07,
        Code::G01,
        Code::G02,
        Code::G03,
        Code::G04,
        Code::G05,
        Code::S01,
        Code::S02,
        Code::S03,
        Code::S04,
        Code::S05,
    ];

    /// The code of this name, as `T01`.
    pub fn from_name(name: &str) -> Option<Code> {
        Code::ALL.into_iter().find(|code| code.name().eq_ignore_ascii_case(name))
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Code::T01 => "T01",
            Code::T02 => "T02",
            Code::T03 => "T03",
            Code::T04 => "T04",
            Code::T05 => "T05",
            Code::T06 => "T06",
            Code::T07 => "T07",
            Code::G01 => "G01",
            Code::G02 => "G02",
            Code::G03 => "G03",
            Code::G04 => "G04",
            Code::G05 => "G05",
            Code::S01 => "S01",
            Code::S02 => "S02",
            Code::S03 => "S03",
            Code::S04 => "S04",
            Code::S05 => "S05",
        }
    }

    /// What it is about.
    pub fn family(self) -> Family {
        match self.name().as_bytes()[0] {
            b'T' => Family::Topological,
            b'G' => Family::Geometric,
            _ => Family::Semantic,
        }
    }

    /// What the sizes of its findings are.
    pub fn unit(self) -> &'static str {
        match self {
            Code::G03 => "m3",
            Code::G04 => "m",
            Code::G05 | Code::S01 | Code::S02 | Code::S03 | Code::S04 | Code::S05 => "m2",
            _ => "",
        }
    }

    /// What it says.
    pub fn title(self) -> &'static str {
        match self {
            Code::T01 => "an alpha is no involution",
            Code::T02 => "a product of alphas is no involution",
            Code::T03 => "a volume is open",
            Code::T04 => "a volume is no ball",
            Code::T05 => "the map is not one orientable piece of the right Euler characteristic",
            Code::T06 => "alpha 3 of a face is free, but it is between two volumes; or the other way around",
            Code::T07 => "what is known of the map is not what it has",
            Code::G01 => "a footprint is not convex",
            Code::G02 => "a volume is no prism",
            Code::G03 => "volumes do not fill the hull",
            Code::G04 => "a vertex is off its plane",
            Code::G05 => "a face's area is not that of its corners",
            Code::S01 => "an opening does not join two volumes of air",
            Code::S02 => "a room leaks into the open",
            Code::S03 => "a room has no floor, or no ceiling",
            Code::S04 => "a room has no way out",
            Code::S05 => "a face is not called what it separates",
        }
    }
}
