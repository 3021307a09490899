//! What people work at and with.

use crate::generate::furniture::Piece;
use crate::generate::palette::{BEECH, BLACK_GLASS, CONCRETE, LACQUER, PAPER, STEEL, WALNUT, WHITE_PAINT};

/// A desk with a screen and a keyboard, for someone who sits at its front.
pub fn work_desk(w: f64, d: f64, top: u32) -> Piece {
    let (h, thick, middle) = (0.74, 0.025, w / 2.0);
    let under = h - thick;
    Piece::default()
        .add([0.04, 0.05, 0.0], [0.08, d - 0.05, under], STEEL)
        .add([w - 0.08, 0.05, 0.0], [w - 0.04, d - 0.05, under], STEEL)
        .add([0.0, 0.0, under], [w, d, h], top)
        .add([middle - 0.03, 0.14, h], [middle + 0.03, 0.17, h + 0.14], BLACK_GLASS)
        .add([middle - 0.27, 0.17, h + 0.1], [middle + 0.27, 0.2, h + 0.43], BLACK_GLASS)
        .add([middle - 0.22, d - 0.3, h], [middle + 0.22, d - 0.15, h + 0.02], CONCRETE)
}

/// Two desks' upright divider, 0.04 m thick.
pub fn divider(w: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 0.0], [w, 0.04, 1.15], crate::generate::palette::BLUE_FABRIC)
}

/// Drawers that roll under a desk, 0.42 by 0.55 m.
pub fn pedestal() -> Piece {
    let (w, d, h) = (0.42, 0.55, 0.58);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], CONCRETE);
    for z in [0.03, 0.21, 0.39] {
        piece = piece.add([0.01, d - 0.02, z], [w - 0.01, d, z + 0.16], LACQUER);
    }
    piece
}

/// A table that many sit around: a top on two boards.
pub fn conference_table(w: f64, d: f64) -> Piece {
    let (h, inset) = (0.74, (w * 0.15).min(0.7));
    let mut piece = Piece::default();
    for u in [inset, w - inset - 0.08] {
        piece = piece.add([u, d * 0.25, 0.0], [u + 0.08, d * 0.75, h - 0.04], STEEL);
    }
    piece.add([0.0, 0.0, h - 0.04], [w, d, h], WALNUT)
}

/// A speaker's desk, 0.6 by 0.5 m, whose front is the speaker's side.
pub fn lectern() -> Piece {
    Piece::default()
        .add([0.05, 0.05, 0.0], [0.55, 0.25, 1.0], WALNUT)
        .add([0.0, 0.0, 1.0], [0.6, 0.5, 1.05], WALNUT)
        .add([0.0, 0.0, 1.05], [0.6, 0.03, 1.15], WALNUT)
}

/// A stand with sheets of paper, 0.7 by 0.6 m.
pub fn flip_chart() -> Piece {
    Piece::default()
        .add([0.05, 0.5, 0.0], [0.09, 0.54, 0.8], STEEL)
        .add([0.61, 0.5, 0.0], [0.65, 0.54, 0.8], STEEL)
        .add([0.33, 0.0, 0.0], [0.37, 0.04, 1.75], STEEL)
        .add([0.33, 0.04, 1.7], [0.37, 0.5, 1.75], STEEL)
        .add([0.0, 0.5, 0.8], [0.7, 0.54, 1.8], WHITE_PAINT)
        .add([0.04, 0.54, 0.85], [0.66, 0.55, 1.74], PAPER)
}

/// A copier on its cupboard, 0.65 by 0.65 m.
pub fn copier() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.65, 0.62, 0.85], LACQUER)
        .add([0.04, 0.62, 0.1], [0.61, 0.64, 0.38], CONCRETE)
        .add([0.04, 0.62, 0.42], [0.61, 0.64, 0.7], CONCRETE)
        .carve([0.06, 0.08, 0.72], [0.65, 0.62, 0.8])
        .add([0.0, 0.0, 0.85], [0.65, 0.6, 1.05], CONCRETE)
        .add([0.02, 0.02, 1.05], [0.63, 0.56, 1.12], LACQUER)
        .add([0.4, 0.6, 0.93], [0.63, 0.65, 1.0], BLACK_GLASS)
}

/// The desk of a reception: a front with a shelf above a desk at which someone sits behind it. Its back is the
/// visitors' side.
pub fn reception(w: f64) -> Piece {
    let (d, thick) = (0.8, 0.05);
    Piece::default()
        .add([0.0, 0.12, 0.0], [w, 0.12 + thick, 1.1], WALNUT)
        .add([0.0, 0.12, 0.0], [thick, d, 1.1], WALNUT)
        .add([w - thick, 0.12, 0.0], [w, d, 1.1], WALNUT)
        .add([thick, 0.12 + thick, 0.7], [w - thick, d, 0.74], BEECH)
        .add([0.0, 0.0, 1.1], [w, 0.4, 1.14], LACQUER)
        .add([w / 2.0 - 0.25, 0.3, 0.78], [w / 2.0 + 0.25, 0.33, 1.06], BLACK_GLASS)
        .add([w / 2.0 - 0.03, 0.33, 0.74], [w / 2.0 + 0.03, 0.36, 0.95], BLACK_GLASS)
}

/// A table for two pupils.
pub fn school_table() -> Piece {
    let (w, d, h) = (1.3, 0.55, 0.74);
    Piece::default().legs([w, d, h - 0.03], 0.03, 0.04, STEEL).add([0.0, 0.0, h - 0.03], [w, d, h], BEECH)
}
