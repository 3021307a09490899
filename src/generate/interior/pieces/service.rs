//! Sanitary ware, kitchens, and what serves a building.

use crate::generate::furniture::Piece;
use crate::generate::palette::{
    BLACK_GLASS, BLUE_FABRIC, CERAMIC, CONCRETE, LACQUER, STEEL, STONE, WHITE_PAINT, ZINC,
};

/// A toilet that hangs on the wall, 0.38 by 0.55 m, with a plate to flush.
pub fn wall_toilet() -> Piece {
    Piece::default()
        .add([0.05, 0.0, 0.12], [0.33, 0.3, 0.3], CERAMIC)
        .add([0.0, 0.0, 0.3], [0.38, 0.55, 0.4], CERAMIC)
        .carve([0.09, 0.2, 0.3], [0.29, 0.48, 0.4])
        .add([0.08, 0.0, 0.95], [0.3, 0.01, 1.1], STEEL)
}

/// A urinal, 0.36 by 0.34 m.
pub fn urinal() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.6], [0.36, 0.12, 1.25], CERAMIC)
        .add([0.0, 0.12, 0.6], [0.36, 0.34, 0.85], CERAMIC)
        .carve([0.06, 0.12, 0.68], [0.3, 0.29, 0.85])
}

/// A counter with wash basins, each 0.7 m wide, hung on the wall.
pub fn basins(count: u32) -> Piece {
    let w = 0.7 * f64::from(count);
    let mut piece = Piece::default().add([0.0, 0.0, 0.72], [w, 0.5, 0.86], CERAMIC);
    for i in 0..count {
        let u = 0.7 * f64::from(i);
        piece = piece.carve([u + 0.12, 0.14, 0.76], [u + 0.58, 0.44, 0.86]).add(
            [u + 0.33, 0.06, 0.86],
            [u + 0.37, 0.2, 0.98],
            STEEL,
        );
    }
    piece
}

/// A board between two cubicles, on two feet: `d` is how far it reaches from the wall.
pub fn cubicle_side(d: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 0.15], [0.03, d, 2.0], LACQUER).add(
        [0.0, d - 0.1, 0.0],
        [0.03, d - 0.05, 0.15],
        STEEL,
    )
}

/// A board of a cubicle's front, or its door.
pub fn cubicle_front(w: f64, is_door: bool) -> Piece {
    let piece = Piece::default().add([0.0, 0.0, 0.15], [w, 0.03, 2.0], CONCRETE);
    if !is_door {
        return piece;
    }
    piece.add([w - 0.12, 0.03, 1.0], [w - 0.06, 0.06, 1.03], STEEL)
}

/// A kitchen's base unit of two fronts with what stands on it.
pub fn tea_counter(w: f64) -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [w, 0.5, 0.1], ZINC)
        .add([0.0, 0.0, 0.1], [w, 0.58, 0.86], LACQUER)
        .add([w / 2.0 - 0.005, 0.57, 0.1], [w / 2.0 + 0.005, 0.58, 0.86], CONCRETE)
        .add([0.0, 0.0, 0.86], [w, 0.6, 0.9], STONE)
        .add([0.08, 0.1, 0.9], [0.4, 0.45, 1.3], BLACK_GLASS)
        .carve([0.13, 0.3, 0.97], [0.35, 0.45, 1.15])
        .add([w - 0.3, 0.12, 0.9], [w - 0.12, 0.3, 1.12], STEEL)
}

/// A dishwasher under a piece of worktop, 0.6 by 0.6 m.
pub fn dishwasher() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.6, 0.5, 0.1], ZINC)
        .add([0.0, 0.0, 0.1], [0.6, 0.57, 0.86], STEEL)
        .add([0.06, 0.57, 0.78], [0.54, 0.6, 0.8], STEEL)
        .add([0.0, 0.0, 0.86], [0.6, 0.6, 0.9], STONE)
}

/// A water dispenser with its bottle, 0.33 by 0.33 m.
pub fn water_cooler() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.33, 0.33, 0.95], WHITE_PAINT)
        .carve([0.05, 0.22, 0.62], [0.28, 0.33, 0.85])
        .add([0.04, 0.04, 0.95], [0.29, 0.29, 1.3], BLUE_FABRIC)
}

/// A vending machine, 0.9 by 0.8 m.
pub fn vending_machine() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.9, 0.8, 1.83], BLUE_FABRIC)
        .add([0.06, 0.77, 0.5], [0.62, 0.8, 1.7], BLACK_GLASS)
        .add([0.7, 0.8, 1.1], [0.84, 0.82, 1.4], STEEL)
        .carve([0.06, 0.7, 0.2], [0.62, 0.8, 0.4])
}

/// A cabinet of electric power, 0.8 by 0.4 m.
pub fn power_cabinet() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.8, 0.38, 1.9], CONCRETE)
        .add([0.02, 0.38, 0.1], [0.39, 0.4, 1.88], ZINC)
        .add([0.41, 0.38, 0.1], [0.78, 0.4, 1.88], ZINC)
        .add([0.33, 0.4, 1.0], [0.36, 0.43, 1.15], BLACK_GLASS)
}

/// A cleaner's trolley, 0.8 by 0.45 m.
pub fn trolley() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.08], [0.8, 0.45, 0.14], CONCRETE)
        .add([0.0, 0.02, 0.14], [0.04, 0.43, 1.0], STEEL)
        .add([0.4, 0.04, 0.14], [0.78, 0.41, 0.55], BLUE_FABRIC)
        .add([0.08, 0.06, 0.14], [0.36, 0.39, 0.5], ZINC)
        .carve([0.1, 0.08, 0.2], [0.34, 0.37, 0.5])
}
