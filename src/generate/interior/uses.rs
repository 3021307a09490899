//! What rooms are for.

/// What a room is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Use {
    /// One desk to a few.
    Office,
    /// Islands of desks.
    OpenOffice,
    /// A table with chairs around it.
    Meeting,
    /// A large table, or rows of chairs before a lectern.
    Conference,
    /// A way between rooms: little, on its walls.
    Corridor,
    /// An entrance hall: a reception, seats.
    Hall,
    /// Cubicles and basins; one toilet if it is small.
    Toilet,
    /// Racks.
    Storage,
    /// A tea kitchen with a table.
    Kitchenette,
    /// Cabinets of servers.
    Server,
    /// Rows of bookcases, and tables to read at.
    Library,
    /// Sofas around low tables.
    Lounge,
    /// A stairwell: next to nothing.
    Stair,
    /// A flat's living room.
    Living,
    /// A flat's kitchen.
    Kitchen,
    /// A flat's bedroom.
    Bedroom,
    /// A flat's bathroom.
    Bath,
    /// What is kept under a roof.
    Attic,
    /// Tables in rows before a blackboard.
    Classroom,
}

/// How many faces the furniture of a room shows: as many in any room, and as many for each square metre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Density {
    /// In any room.
    pub base: u32,
    /// For 100 m2 of floor.
    pub per_100_m2: u32,
}

impl Use {
    /// All of them.
    #[cfg(test)]
    pub const ALL: [Use; 19] = [
        Use::Office,
        Use::OpenOffice,
        Use::Meeting,
        Use::Conference,
        Use::Corridor,
        Use::Hall,
        Use::Toilet,
        Use::Storage,
        Use::Kitchenette,
        Use::Server,
        Use::Library,
        Use::Lounge,
        Use::Stair,
        Use::Living,
        Use::Kitchen,
        Use::Bedroom,
        Use::Bath,
        Use::Attic,
        Use::Classroom,
    ];

    /// How dense its furniture is. Rooms in which it finds no place stay below, and small ones can lie above: a
    /// toilet needs its basin.
    pub const fn density(self) -> Density {
        let (base, per_100_m2) = match self {
            Use::Office => (0, 825),
            Use::OpenOffice => (0, 900),
            Use::Meeting => (20, 800),
            Use::Conference => (40, 800),
            Use::Corridor => (0, 225),
            Use::Hall => (30, 300),
            Use::Toilet => (40, 420),
            Use::Storage => (10, 1000),
            Use::Kitchenette => (50, 500),
            Use::Server => (10, 700),
            Use::Library => (0, 1800),
            Use::Lounge => (20, 500),
            Use::Stair => (10, 60),
            Use::Living => (20, 550),
            Use::Kitchen => (40, 600),
            Use::Bedroom => (20, 550),
            Use::Bath => (30, 500),
            Use::Attic => (0, 350),
            Use::Classroom => (20, 900),
        };
        Density { base, per_100_m2 }
    }

    /// The number of faces that the furniture of a room of `area` square units should show.
    pub fn target(self, area: i64) -> u32 {
        let Density { base, per_100_m2 } = self.density();
        let faces = i128::from(area.max(0)) * i128::from(per_100_m2) / (100 * 1024 * 1024);
        u32::try_from(faces).unwrap_or(u32::MAX).saturating_add(base).min(MOST_FACES)
    }

    /// Width of the way from door to door, metres. That to a piece is 0.5 m wide.
    pub const fn walkway(self) -> f64 {
        match self {
            Use::Corridor | Use::Hall | Use::Stair => 0.9,
            _ => 0.5,
        }
    }
}

/// Rooms of far more than a thousand square metres get no more than this.
const MOST_FACES: u32 = 12_000;
