//! What faces are called.

use enfilade_importers::Semantic;

use crate::sew::Part;

/// What a face separates. The numbers are those of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u32)]
#[non_exhaustive]
pub enum FaceKind {
    /// Air on both sides: light passes.
    Portal = 64,
    /// Room beside matter.
    Wallpaper = 65,
    /// The open beside matter.
    Facade = 66,
    /// Within a door, a window or an opening: the matter around it.
    GatePost = 67,
    /// Matter below a room.
    Floor = 68,
    /// Matter above a room.
    Ceiling = 69,
    /// Ground below the open.
    Terrain = 70,
    /// A roof below the open, or beside or above it.
    Roofing = 71,
    /// Matter that light passes, beside any air.
    Pane = 72,
    /// The hull's surface.
    Horizon = 73,
    /// Matter beside unlabelled air that does not reach the open.
    Lining = 74,
    /// Matter on both sides.
    Joint = 75,
}

impl FaceKind {
    /// All, in the order of their numbers.
    pub const ALL: [FaceKind; 12] = [
        FaceKind::Portal,
        FaceKind::Wallpaper,
        FaceKind::Facade,
        FaceKind::GatePost,
        FaceKind::Floor,
        FaceKind::Ceiling,
        FaceKind::Terrain,
        FaceKind::Roofing,
        FaceKind::Pane,
        FaceKind::Horizon,
        FaceKind::Lining,
        FaceKind::Joint,
    ];

    /// The kind with this number.
    pub fn from_number(number: u32) -> Option<FaceKind> {
        FaceKind::ALL.into_iter().find(|kind| kind.number() == number)
    }

    /// Its number.
    pub fn number(self) -> u32 {
        self as u32
    }

    /// Its word, as in reports.
    pub fn name(self) -> &'static str {
        match self {
            FaceKind::Portal => "PORTAL",
            FaceKind::Wallpaper => "WALLPAPER",
            FaceKind::Facade => "FACADE",
            FaceKind::GatePost => "GATE_POST",
            FaceKind::Floor => "FLOOR",
            FaceKind::Ceiling => "CEILING",
            FaceKind::Terrain => "TERRAIN",
            FaceKind::Roofing => "ROOFING",
            FaceKind::Pane => "PANE",
            FaceKind::Horizon => "HORIZON",
            FaceKind::Lining => "LINING",
            FaceKind::Joint => "JOINT",
        }
    }

    /// What a face between air and matter is called. `matter` is the meaning of the element whose surface it is,
    /// `part` what it is of the air.
    pub fn of_surface(air: Semantic, matter: Semantic, part: Part, is_glass: bool) -> FaceKind {
        if is_glass {
            return FaceKind::Pane;
        }
        match (air, part, matter) {
            (Semantic::Door | Semantic::Window | Semantic::Opening, ..) => FaceKind::GatePost,
            (Semantic::Void, ..) => FaceKind::Lining,
            (Semantic::Exterior, Part::Floor, Semantic::Ground) => FaceKind::Terrain,
            (Semantic::Exterior, _, Semantic::Roof) => FaceKind::Roofing,
            (Semantic::Exterior, ..) => FaceKind::Facade,
            (_, Part::Floor, _) => FaceKind::Floor,
            (_, Part::Ceiling, _) => FaceKind::Ceiling,
            (_, Part::Side, _) => FaceKind::Wallpaper,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with another kind is refused.
    #[test]
    fn numbers_are_those_of_files() {
        let numbers: Vec<u32> = FaceKind::ALL.iter().map(|kind| kind.number()).collect();
        assert_eq!(numbers, (64..=75).collect::<Vec<_>>());
    }

    #[test]
    fn faces_are_called_by_what_they_separate() {
        use FaceKind::*;
        let of = |air, matter, facing| FaceKind::of_surface(air, matter, facing, false);
        let (down, up, aside) = (Part::Floor, Part::Ceiling, Part::Side);
        for (air, matter, facing, kind) in [
            (Semantic::Room, Semantic::Wall, aside, Wallpaper),
            (Semantic::Room, Semantic::Column, aside, Wallpaper),
            (Semantic::Room, Semantic::Ground, down, Floor),
            (Semantic::Room, Semantic::Wall, down, Floor),
            (Semantic::Room, Semantic::Roof, up, Ceiling),
            (Semantic::Stairwell, Semantic::Wall, aside, Wallpaper),
            (Semantic::Exterior, Semantic::Wall, aside, Facade),
            (Semantic::Exterior, Semantic::Ground, aside, Facade),
            (Semantic::Exterior, Semantic::Ground, down, Terrain),
            (Semantic::Exterior, Semantic::Roof, down, Roofing),
            (Semantic::Exterior, Semantic::Roof, aside, Roofing),
            (Semantic::Door, Semantic::Wall, aside, GatePost),
            (Semantic::Window, Semantic::Wall, down, GatePost),
            (Semantic::Opening, Semantic::Ground, aside, GatePost),
            (Semantic::Void, Semantic::Wall, aside, Lining),
        ] {
            assert_eq!(of(air, matter, facing), kind, "{air:?} {matter:?} {facing:?}");
        }
        assert_eq!(FaceKind::of_surface(Semantic::Room, Semantic::Wall, aside, true), Pane);
    }

    #[test]
    fn numbers_lead_back() {
        for kind in FaceKind::ALL {
            assert_eq!(FaceKind::from_number(kind.number()), Some(kind));
        }
        assert_eq!(FaceKind::from_number(63), None);
        assert_eq!(FaceKind::from_number(76), None);
    }
}
