//! What rooms are for, as the drawing needs it.

pub use super::interior::Use;
use super::palette;

impl Use {
    /// What its rooms are called.
    pub fn title(self) -> &'static str {
        match self {
            Use::Office => "Office",
            Use::OpenOffice => "Open office",
            Use::Meeting => "Meeting room",
            Use::Conference => "Conference room",
            Use::Corridor => "Corridor",
            Use::Hall => "Entrance hall",
            Use::Toilet => "Toilets",
            Use::Storage => "Storage",
            Use::Kitchenette => "Tea kitchen",
            Use::Server => "Server room",
            Use::Library => "Library",
            Use::Lounge => "Lounge",
            Use::Stair => "Stairwell",
            Use::Living => "Living room",
            Use::Kitchen => "Kitchen",
            Use::Bedroom => "Bedroom",
            Use::Bath => "Bath",
            Use::Attic => "Attic",
            Use::Classroom => "Classroom",
        }
    }

    /// The materials of its rooms' floors and walls.
    pub fn materials(self) -> [u32; 2] {
        match self {
            Use::Toilet | Use::Bath => [palette::BATH_TILES; 2],
            Use::Corridor | Use::Kitchenette | Use::Kitchen | Use::Storage | Use::Server => {
                [palette::FLOOR_TILES, palette::PLASTER]
            }
            Use::Hall | Use::Stair => [palette::STONE, palette::PLASTER],
            Use::Attic => [palette::OAK_FLOOR, palette::BEECH],
            _ => [palette::OAK_FLOOR, palette::PLASTER],
        }
    }

    /// Whether large rooms for it have columns.
    pub fn has_columns(self) -> bool {
        matches!(self, Use::Hall | Use::Conference | Use::OpenOffice | Use::Library)
    }
}
