//! What hangs on walls: z is the height over the floor.

use crate::generate::furniture::Piece;
use crate::generate::palette::{
    BEECH, BLACK_GLASS, BLUE_FABRIC, CERAMIC, CONCRETE, GREEN_PAINT, LACQUER, LINEN, PAPER, RED_WOOL, STEEL,
    WALNUT, WHITE_PAINT, ZINC,
};

/// A white board with a tray for pens.
pub fn whiteboard(w: f64) -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.95], [w, 0.03, 2.0], ZINC)
        .add([0.03, 0.02, 0.98], [w - 0.03, 0.03, 1.97], CERAMIC)
        .add([w * 0.2, 0.03, 0.95], [w * 0.8, 0.1, 0.97], ZINC)
}

/// A black board, green.
pub fn blackboard(w: f64) -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.85], [w, 0.05, 2.05], BEECH)
        .add([0.05, 0.04, 0.9], [w - 0.05, 0.05, 2.0], GREEN_PAINT)
        .add([0.0, 0.05, 0.85], [w, 0.12, 0.88], BEECH)
}

/// A picture in a frame, around 1.55 m high.
pub fn picture([w, h]: [f64; 2], color: u32) -> Piece {
    let (low, high) = (1.55 - h / 2.0, 1.55 + h / 2.0);
    Piece::default().add([0.0, 0.0, low], [w, 0.03, high], WALNUT).add(
        [0.05, 0.01, low + 0.05],
        [w - 0.05, 0.03, high - 0.05],
        color,
    )
}

/// A board with notes pinned to it.
pub fn notice_board(w: f64) -> Piece {
    let mut piece = Piece::default().add([0.0, 0.0, 1.0], [w, 0.025, 1.9], BEECH).add(
        [0.03, 0.01, 1.03],
        [w - 0.03, 0.025, 1.87],
        LINEN,
    );
    for (u, z, color) in [(0.15, 1.5, CERAMIC), (0.45, 1.3, PAPER), (0.7, 1.55, BLUE_FABRIC)] {
        piece = piece.add([w * u, 0.02, z], [w * u + 0.15, 0.025, z + 0.21], color);
    }
    piece
}

/// A clock.
pub fn clock() -> Piece {
    Piece::default().add([0.0, 0.0, 1.9], [0.3, 0.04, 2.2], BLACK_GLASS).add(
        [0.02, 0.03, 1.92],
        [0.28, 0.04, 2.18],
        CERAMIC,
    )
}

/// A large flat screen.
pub fn wall_screen(w: f64) -> Piece {
    let h = w * 9.0 / 16.0;
    Piece::default().add([w * 0.35, 0.0, 1.2], [w * 0.65, 0.04, 1.0 + h * 0.8], STEEL).add(
        [0.0, 0.04, 1.0],
        [w, 0.09, 1.0 + h],
        BLACK_GLASS,
    )
}

/// A canvas to project on, with its case.
pub fn canvas(w: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 2.15], [w, 0.1, 2.25], WHITE_PAINT).add(
        [0.08, 0.04, 0.95],
        [w - 0.08, 0.05, 2.15],
        CERAMIC,
    )
}

/// A radiator under a window; a gap is left to the floor, and to the wall, where a pipe bridges it.
pub fn radiator(w: f64, h: f64) -> Piece {
    Piece::default().add([0.0, 0.03, 0.12], [w, 0.1, 0.12 + h], LACQUER).add(
        [0.03, 0.0, 0.2],
        [0.05, 0.03, 0.24],
        STEEL,
    )
}

/// A fire extinguisher on its bracket.
pub fn extinguisher() -> Piece {
    Piece::default()
        .add([0.06, 0.0, 0.55], [0.1, 0.04, 1.05], STEEL)
        .add([0.0, 0.04, 0.5], [0.16, 0.2, 1.0], RED_WOOL)
        .add([0.05, 0.09, 1.0], [0.11, 0.15, 1.1], BLACK_GLASS)
}

/// A row of hooks with a coat.
pub fn hooks(w: f64) -> Piece {
    Piece::default()
        .add([0.0, 0.0, 1.6], [w, 0.02, 1.72], BEECH)
        .add([w * 0.2, 0.02, 1.64], [w * 0.2 + 0.02, 0.08, 1.67], STEEL)
        .add([w * 0.5, 0.02, 1.64], [w * 0.5 + 0.02, 0.08, 1.67], STEEL)
        .add([w * 0.8, 0.02, 1.64], [w * 0.8 + 0.02, 0.08, 1.67], STEEL)
}

/// A sign.
pub fn sign() -> Piece {
    Piece::default().add([0.0, 0.0, 1.7], [0.3, 0.015, 1.85], GREEN_PAINT)
}

/// A mirror over a basin.
pub fn mirror(w: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 1.1], [w, 0.02, 1.9], STEEL)
}

/// A box on the wall of a WC: towels, a drier.
pub fn dispenser() -> Piece {
    Piece::default().add([0.0, 0.0, 1.15], [0.28, 0.13, 1.5], STEEL).add(
        [0.06, 0.02, 1.13],
        [0.22, 0.1, 1.15],
        CONCRETE,
    )
}

/// An air conditioner high on the wall.
pub fn air_conditioner() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 1.95], [0.9, 0.22, 2.25], LACQUER)
        .carve([0.05, 0.17, 1.95], [0.85, 0.22, 2.0])
}

/// A shelf board on the wall with a few things on it.
pub fn wall_board(w: f64) -> Piece {
    Piece::default()
        .add([0.0, 0.0, 1.4], [w, 0.22, 1.43], BEECH)
        .add([0.05, 0.02, 1.43], [w * 0.45, 0.18, 1.66], PAPER)
        .add([w * 0.7, 0.05, 1.43], [w * 0.7 + 0.1, 0.15, 1.6], CERAMIC)
}
