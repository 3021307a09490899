//! What faces are called: the numbers of kinds of faces in files.

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
        let first = FaceKind::Portal.number();
        FaceKind::ALL.get(number.checked_sub(first)? as usize).copied()
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_files_and_lead_back() {
        let numbers: Vec<u32> = FaceKind::ALL.iter().map(|kind| kind.number()).collect();
        assert_eq!(numbers, (64..=75).collect::<Vec<_>>());
        for kind in FaceKind::ALL {
            assert_eq!(FaceKind::from_number(kind.number()), Some(kind));
        }
        assert_eq!(FaceKind::from_number(63), None);
        assert_eq!(FaceKind::from_number(76), None);
    }
}
