//! Stand-in.
/// What a room is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Use {
    Office,
    OpenOffice,
    Meeting,
    Conference,
    Corridor,
    Hall,
    Toilet,
    Storage,
    Kitchenette,
    Server,
    Library,
    Lounge,
    Stair,
    Living,
    Kitchen,
    Bedroom,
    Bath,
    Attic,
    Classroom,
}
