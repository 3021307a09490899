//! Where the furniture of the house stands.

use crate::importers::Semantic;

use super::building::Kind;
use super::draft::Draft;
use super::furniture::{self as piece, Counter, Piece};
use super::joinery::standing;
use super::lattice::{Cuboid, Placement, Point, units};
use super::palette::{BEECH, LACQUER, LAMP_SHADE, WALNUT};

/// Which way a piece's front looks, as a number of quarter turns. Its origin is the right end of its back, seen
/// from the room.
#[derive(Clone, Copy)]
enum Front {
    North = 0,
    West = 1,
    South = 2,
    East = 3,
}

/// A flat lamp under the ceiling. The light itself shines a little below it.
pub fn lamp(draft: &mut Draft, room: &str, at: Point) {
    let name = format!("{room} lamp");
    let lamp = draft.element(Kind::Detail, Semantic::Equipment, "IfcLightFixture", &name);
    let half = units(0.2);
    let [x, y, z] = at;
    let shade = Cuboid { lo: [x - half, y - half, z - units(0.09)], hi: [x + half, y + half, z] };
    let boxes = [(shade, Some(LAMP_SHADE))];
    draft.detail(lamp, standing(&Placement { origin: [0; 3], turns: 0 }, &boxes));
}

/// Furniture for the house's rooms.
pub fn house(draft: &mut Draft) {
    let mut put = |class: Class, name: &str, x: f64, y: f64, front: Front, made: Piece| {
        let (semantic, ifc) = match class {
            Class::Sanitary => (Semantic::Equipment, "IfcFlowTerminal"),
            Class::Furniture => (Semantic::Furniture, "IfcFurnishingElement"),
        };
        let element = draft.element(Kind::Detail, semantic, ifc, name);
        let place = Placement { origin: [units(x), units(y), 0], turns: front as u8 };
        draft.detail(element, standing(&place, &made.boxes));
    };
    use Class::{Furniture, Sanitary};
    use Front::{East, North, South, West};

    put(Furniture, "Sofa", 0.40, 3.56, East, piece::sofa(3));
    put(Furniture, "Armchair", 4.50, 1.95, West, piece::sofa(1));
    put(Furniture, "Coffee table", 2.65, 1.85, West, piece::table([1.2, 0.65, 0.42], WALNUT));
    put(Furniture, "Television", 5.90, 4.60, South, piece::television(1.8));
    put(Furniture, "Bookshelf north", 6.30, 3.02, West, piece::shelf(1.1, 2.1, 4));
    put(Furniture, "Dining table", 1.18, 5.35, North, piece::table([1.6, 0.9, 0.75], BEECH));
    for (name, x, y, front) in [
        ("Dining chair 1", 1.35, 4.78, North),
        ("Dining chair 2", 2.15, 4.78, North),
        ("Dining chair 3", 1.77, 6.80, South),
        ("Dining chair 4", 2.57, 6.80, South),
    ] {
        put(Furniture, name, x, y, front, piece::chair(BEECH));
    }

    put(Furniture, "Kitchen counter north", 3.00, 9.64, South, piece::counter(2.64, 3, Counter::Sink));
    put(Furniture, "Kitchen counter west", 0.36, 9.04, East, piece::counter(1.5, 2, Counter::Hob));
    put(Furniture, "Kitchen wall units", 1.12, 9.64, South, piece::wall_units(0.76));
    put(Furniture, "Refrigerator", 3.60, 9.64, South, piece::refrigerator());

    put(Furniture, "Coat cupboard", 3.72, 7.40, East, piece::chest([1.0, 0.4, 2.0], 2, 1, WALNUT));
    put(Furniture, "Hall chest", 10.20, 4.84, North, piece::chest([1.0, 0.36, 0.8], 1, 2, WALNUT));

    put(Sanitary, "WC toilet", 6.70, 9.64, South, piece::toilet());
    put(Sanitary, "WC basin", 7.12, 8.25, West, piece::wash_basin(0.45, 0.34));
    put(Sanitary, "Bath tub", 5.82, 7.88, East, piece::bath_tub());
    put(Sanitary, "Bath basin", 8.30, 9.64, South, piece::wash_basin(0.6, 0.46));
    put(Sanitary, "Bath toilet", 7.24, 8.95, East, piece::toilet());
    put(Furniture, "Washing machine", 8.70, 7.70, West, piece::washing_machine());

    put(Furniture, "Child's bed", 11.60, 9.64, South, piece::bed(1.0, 1));
    put(Furniture, "Child's desk", 8.82, 9.35, East, piece::desk(1.3, 0.65));
    put(Furniture, "Child's chair", 10.05, 8.50, West, piece::chair(BEECH));
    put(Furniture, "Child's wardrobe", 11.64, 6.20, West, piece::chest([0.95, 0.58, 2.0], 2, 1, LACQUER));

    put(Furniture, "Desk", 6.60, 0.36, North, piece::desk(1.6, 0.75));
    put(Furniture, "Desk chair", 7.50, 1.72, South, piece::chair(WALNUT));
    put(Furniture, "Study shelf", 8.52, 1.90, West, piece::shelf(1.0, 2.1, 4));

    put(Furniture, "Double bed", 8.64, 2.85, East, piece::bed(1.8, 2));
    put(Furniture, "Nightstand north", 8.64, 3.36, East, piece::chest([0.45, 0.4, 0.45], 1, 1, LACQUER));
    put(Furniture, "Nightstand south", 8.64, 1.00, East, piece::chest([0.45, 0.4, 0.45], 1, 1, LACQUER));
    put(Furniture, "Wardrobe", 11.64, 4.60, South, piece::chest([1.6, 0.6, 2.2], 3, 1, LACQUER));
}

/// What a piece is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Furniture,
    Sanitary,
}
