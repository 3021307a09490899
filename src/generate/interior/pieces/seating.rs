//! What people sit on, and what stands around it.

use crate::generate::furniture::Piece;
use crate::generate::palette::{
    BEECH, BLACK_GLASS, BLUE_FABRIC, CONCRETE, GRASS, LACQUER, LAMP_SHADE, PAPER, RED_WOOL, STEEL, STONE,
    WALNUT,
};

/// An office chair, 0.5 by 0.5 m, on a plate or on a cross.
pub fn swivel_chair(fabric: u32, has_cross: bool) -> Piece {
    let (w, d) = (0.5, 0.5);
    let foot = if has_cross {
        Piece::default().add([0.02, 0.22, 0.0], [w - 0.02, 0.28, 0.06], BLACK_GLASS).add(
            [0.22, 0.02, 0.0],
            [0.28, d - 0.02, 0.06],
            BLACK_GLASS,
        )
    } else {
        Piece::default().add([0.07, 0.07, 0.0], [w - 0.07, d - 0.07, 0.06], BLACK_GLASS)
    };
    foot.add([0.22, 0.22, 0.06], [0.28, 0.28, 0.43], STEEL).add([0.0, 0.0, 0.43], [w, d, 0.51], fabric).add(
        [0.03, 0.0, 0.51],
        [w - 0.03, 0.06, 0.98],
        fabric,
    )
}

/// An upholstered chair on a foot, 0.5 by 0.52 m.
pub fn visitor_chair(fabric: u32) -> Piece {
    Piece::default()
        .add([0.05, 0.06, 0.0], [0.45, 0.46, 0.02], STEEL)
        .add([0.22, 0.23, 0.02], [0.28, 0.29, 0.4], STEEL)
        .add([0.0, 0.0, 0.4], [0.5, 0.52, 0.47], fabric)
        .add([0.0, 0.0, 0.47], [0.5, 0.06, 0.86], fabric)
}

/// A row of seats on one beam, each 0.55 m wide.
pub fn bench(seats: u32) -> Piece {
    let w = f64::from(seats) * 0.55;
    let mut piece = Piece::default().add([0.0, 0.22, 0.36], [w, 0.28, 0.42], STEEL);
    for u in [0.15, w - 0.21] {
        piece = piece.add([u, 0.22, 0.0], [u + 0.06, 0.28, 0.36], STEEL);
    }
    for i in 0..seats {
        let u = f64::from(i) * 0.55;
        piece = piece.add([u + 0.02, 0.0, 0.42], [u + 0.53, 0.5, 0.47], BLUE_FABRIC).add(
            [u + 0.02, 0.0, 0.47],
            [u + 0.53, 0.05, 0.85],
            BLUE_FABRIC,
        );
    }
    piece
}

/// A wooden bench without a back.
pub fn plain_bench(w: f64) -> Piece {
    let mut piece = Piece::default().add([0.0, 0.0, 0.4], [w, 0.36, 0.45], BEECH);
    for u in [0.1, w - 0.16] {
        piece = piece.add([u, 0.04, 0.0], [u + 0.06, 0.32, 0.4], BEECH);
    }
    piece
}

/// A low armchair, 0.75 by 0.72 m.
pub fn club_chair(fabric: u32) -> Piece {
    let (w, d) = (0.75, 0.72);
    Piece::default()
        .add([0.0, 0.0, 0.0], [w, d, 0.62], fabric)
        .add([0.0, 0.0, 0.62], [w, 0.16, 0.76], fabric)
        .carve([0.14, 0.16, 0.4], [w - 0.14, d, 0.62])
}

/// A small table on one foot.
pub fn side_table(w: f64, h: f64) -> Piece {
    let middle = w / 2.0;
    Piece::default()
        .add([middle - 0.2, middle - 0.2, 0.0], [middle + 0.2, middle + 0.2, 0.02], STEEL)
        .add([middle - 0.03, middle - 0.03, 0.02], [middle + 0.03, middle + 0.03, h - 0.03], STEEL)
        .add([0.0, 0.0, h - 0.03], [w, w, h], LACQUER)
}

/// A plant in a pot: 0.45 m wide and 0.7 m high if small, else 0.7 m wide and 1.5 m high.
pub fn plant(is_large: bool) -> Piece {
    if !is_large {
        return Piece::default()
            .add([0.1, 0.1, 0.0], [0.35, 0.35, 0.28], CONCRETE)
            .add([0.2, 0.0, 0.28], [0.25, 0.45, 0.6], GRASS)
            .add([0.0, 0.2, 0.28], [0.45, 0.25, 0.7], GRASS);
    }
    Piece::default()
        .add([0.16, 0.16, 0.0], [0.54, 0.54, 0.42], CONCRETE)
        .add([0.32, 0.32, 0.42], [0.38, 0.38, 0.8], WALNUT)
        .add([0.12, 0.12, 0.75], [0.58, 0.58, 1.0], GRASS)
        .add([0.0, 0.25, 0.85], [0.7, 0.48, 1.2], GRASS)
        .add([0.22, 0.0, 0.95], [0.5, 0.7, 1.3], GRASS)
        .add([0.25, 0.25, 1.3], [0.45, 0.45, 1.5], GRASS)
}

/// A pole with four hooks, 0.5 by 0.5 m.
pub fn coat_stand() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.5, 0.5, 0.03], STEEL)
        .add([0.23, 0.23, 0.03], [0.27, 0.27, 1.75], STEEL)
        .add([0.08, 0.235, 1.6], [0.42, 0.265, 1.63], STEEL)
        .add([0.235, 0.0, 1.66], [0.265, 0.5, 1.69], STEEL)
        .add([0.1, 0.27, 0.75], [0.4, 0.37, 1.6], RED_WOOL)
}

/// A lamp on a pole, 0.36 by 0.36 m.
pub fn floor_lamp() -> Piece {
    Piece::default()
        .add([0.05, 0.05, 0.0], [0.31, 0.31, 0.03], STEEL)
        .add([0.165, 0.165, 0.03], [0.195, 0.195, 1.4], STEEL)
        .add([0.0, 0.0, 1.4], [0.36, 0.36, 1.65], LAMP_SHADE)
}

/// A stand with leaflets on three steps, 0.6 by 0.4 m.
pub fn leaflets() -> Piece {
    let mut piece = Piece::default();
    for (i, z) in [0.5, 0.85, 1.2].into_iter().enumerate() {
        let d = 0.4 - 0.12 * i as f64;
        let low = if i == 0 { 0.0 } else { z - 0.35 };
        piece = piece.add([0.0, 0.0, low], [0.6, d, z], LACQUER).add(
            [0.05, d - 0.1, z],
            [0.55, d - 0.06, z + 0.2],
            PAPER,
        );
    }
    piece
}

/// A round column's like: a sculpture on a block.
pub fn sculpture() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.5, 0.5, 0.9], STONE)
        .add([0.1, 0.1, 0.9], [0.4, 0.4, 1.1], WALNUT)
        .add([0.18, 0.05, 1.1], [0.32, 0.35, 1.4], WALNUT)
        .add([0.08, 0.18, 1.4], [0.45, 0.3, 1.6], WALNUT)
}
