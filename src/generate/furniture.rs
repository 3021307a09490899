//! Furniture and sanitary ware, composed of boxes. Each piece is drawn in its own frame, metres: u from 0 to its
//! width, v from 0 at its back to its depth, z from 0 at the floor.

use super::lattice::Cuboid;
use super::palette::{
    BEECH, BLACK_GLASS, BLUE_FABRIC, CERAMIC, LACQUER, LINEN, PAPER, RED_WOOL, STEEL, STONE, WALNUT,
};

/// A piece: boxes painted one over the other, with their material; `None` takes away.
#[derive(Clone, Debug, Default)]
pub struct Piece {
    /// In units, in the piece's own frame.
    pub boxes: Vec<(Cuboid, Option<u32>)>,
}

impl Piece {
    /// Adds a box of a material, corners in metres.
    pub(super) fn add(mut self, lo: [f64; 3], hi: [f64; 3], material: u32) -> Piece {
        self.boxes.push((Cuboid::new(lo, hi), Some(material)));
        self
    }

    /// Takes a box away, corners in metres.
    pub(super) fn carve(mut self, lo: [f64; 3], hi: [f64; 3]) -> Piece {
        self.boxes.push((Cuboid::new(lo, hi), None));
        self
    }

    /// Four legs under a `w` by `d` top at height `h`, set back from its edges by `inset`.
    pub(super) fn legs(mut self, [w, d, h]: [f64; 3], inset: f64, thick: f64, material: u32) -> Piece {
        for u in [inset, w - inset - thick] {
            for v in [inset, d - inset - thick] {
                self = self.add([u, v, 0.0], [u + thick, v + thick, h], material);
            }
        }
        self
    }
}

/// A table: a top on four legs.
pub fn table([w, d, h]: [f64; 3], wood: u32) -> Piece {
    Piece::default().legs([w, d, h - 0.04], 0.0, 0.06, wood).add([0.0, 0.0, h - 0.04], [w, d, h], wood)
}

/// A chair, 0.42 by 0.45 m.
pub fn chair(wood: u32) -> Piece {
    let (w, d, seat) = (0.42, 0.45, 0.45);
    Piece::default().legs([w, d, seat], 0.0, 0.04, wood).add([0.0, 0.0, seat - 0.04], [w, d, seat], wood).add(
        [0.0, 0.0, seat],
        [w, 0.03, 0.88],
        wood,
    )
}

/// A sofa with `seats` cushions; an armchair with one. 0.9 m deep.
pub fn sofa(seats: u32) -> Piece {
    let (arm, seat) = (0.16, 0.62);
    let w = 2.0 * arm + f64::from(seats) * seat;
    let mut piece = Piece::default()
        .add([0.02, 0.02, 0.0], [w - 0.02, 0.86, 0.1], WALNUT)
        .add([0.0, 0.0, 0.1], [w, 0.9, 0.6], BLUE_FABRIC)
        .add([0.0, 0.0, 0.6], [w, 0.22, 0.82], BLUE_FABRIC)
        .carve([arm, 0.22, 0.28], [w - arm, 0.9, 0.6]);
    for i in 0..seats {
        let u = arm + f64::from(i) * seat;
        piece = piece.add([u + 0.01, 0.22, 0.28], [u + seat - 0.01, 0.92, 0.43], LINEN);
    }
    piece
}

/// An open shelf 0.3 m deep with `rows` boards, books on every second one.
pub fn shelf(w: f64, h: f64, rows: u32) -> Piece {
    let (d, board) = (0.3, 0.025);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], BEECH);
    let pitch = (h - board) / f64::from(rows);
    for row in 0..rows {
        let z = board + f64::from(row) * pitch;
        piece = piece.carve([board, 0.015, z], [w - board, d, z + pitch - board]);
        if row % 2 == 1 {
            let full = (w - 2.0 * board) * if row % 4 == 1 { 0.75 } else { 0.5 };
            let tall = (pitch - board) * 0.75;
            piece = piece.add([board, 0.015, z], [board + full, 0.2, z + tall], PAPER);
        }
    }
    piece
}

/// A chest with `columns` by `rows` fronts.
pub fn chest([w, d, h]: [f64; 3], columns: u32, rows: u32, front: u32) -> Piece {
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d - 0.02, h], BEECH);
    let (wide, high) = (w / f64::from(columns), h / f64::from(rows));
    for i in 0..columns {
        for j in 0..rows {
            let (u, z) = (f64::from(i) * wide, f64::from(j) * high);
            piece = piece.add([u + 0.01, d - 0.02, z + 0.01], [u + wide - 0.01, d, z + high - 0.01], front);
        }
    }
    piece
}

/// A bed, 2.05 m long, for one sleeper or two, its head at the back.
pub fn bed(w: f64, pillows: u32) -> Piece {
    let length = 2.05;
    let mut piece = Piece::default()
        .add([0.0, 0.0, 0.0], [w, 0.05, 0.95], WALNUT)
        .add([0.0, 0.05, 0.0], [w, length, 0.3], WALNUT)
        .add([0.03, 0.05, 0.3], [w - 0.03, length - 0.03, 0.48], LINEN)
        .add([0.02, 0.75, 0.3], [w - 0.02, length - 0.02, 0.52], RED_WOOL);
    let wide = (w - 0.06) / f64::from(pillows);
    for i in 0..pillows {
        let u = 0.03 + f64::from(i) * wide;
        piece = piece.add([u + 0.08, 0.1, 0.48], [u + wide - 0.08, 0.55, 0.6], LINEN);
    }
    piece
}

/// A desk with drawers at one end, and a screen on it.
pub fn desk(w: f64, d: f64) -> Piece {
    let h = 0.74;
    let middle = (w - 0.4) / 2.0;
    Piece::default()
        .add([0.0, 0.04, 0.0], [0.04, d - 0.04, h - 0.03], BEECH)
        .add([w - 0.42, 0.04, 0.0], [w - 0.02, d - 0.06, h - 0.03], LACQUER)
        .add([0.0, 0.0, h - 0.03], [w, d, h], BEECH)
        .add([middle - 0.1, 0.12, h], [middle + 0.1, 0.19, h + 0.1], BLACK_GLASS)
        .add([middle - 0.28, 0.14, h + 0.1], [middle + 0.28, 0.17, h + 0.44], BLACK_GLASS)
}

/// A low sideboard with a television on it.
pub fn television(w: f64) -> Piece {
    let middle = w / 2.0;
    chest([w, 0.42, 0.5], 2, 1, LACQUER)
        .add([middle - 0.2, 0.12, 0.5], [middle + 0.2, 0.22, 0.56], BLACK_GLASS)
        .add([middle - 0.6, 0.15, 0.56], [middle + 0.6, 0.19, 1.26], BLACK_GLASS)
}

/// What is set into a kitchen worktop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counter {
    /// A sink with a tap.
    Sink,
    /// A hob over an oven.
    Hob,
}

/// Kitchen base units under a worktop, 0.6 m deep.
pub fn counter(w: f64, fronts: u32, counter: Counter) -> Piece {
    let (h, top) = (0.86, 0.9);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, 0.5, 0.1], WALNUT).add(
        [0.0, 0.0, 0.1],
        [w, 0.56, h],
        LACQUER,
    );
    let wide = w / f64::from(fronts);
    for i in 0..fronts {
        let u = f64::from(i) * wide;
        piece = piece.add([u + 0.01, 0.56, 0.12], [u + wide - 0.01, 0.58, h - 0.02], LACQUER);
    }
    piece = piece.add([0.0, 0.0, h], [w, 0.6, top], STONE);
    let middle = w / 2.0;
    match counter {
        Counter::Sink => piece
            .add([middle - 0.25, 0.1, 0.72], [middle + 0.25, 0.5, top], STEEL)
            .carve([middle - 0.23, 0.2, 0.74], [middle + 0.23, 0.48, top])
            .add([middle - 0.015, 0.05, top], [middle + 0.015, 0.18, top + 0.2], STEEL),
        Counter::Hob => {
            piece.add([middle - 0.29, 0.06, top], [middle + 0.29, 0.54, top + 0.008], BLACK_GLASS)
        }
    }
}

/// Kitchen wall units, hung at 1.45 m.
pub fn wall_units(w: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 1.45], [w, 0.35, 2.15], LACQUER)
}

/// A tall refrigerator, 0.6 by 0.64 m.
pub fn refrigerator() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [0.6, 0.58, 1.85], LACQUER)
        .add([0.01, 0.58, 0.06], [0.59, 0.63, 0.75], STEEL)
        .add([0.01, 0.58, 0.77], [0.59, 0.63, 1.84], STEEL)
}

/// A washing machine, 0.6 by 0.6 m.
pub fn washing_machine() -> Piece {
    Piece::default().add([0.0, 0.0, 0.0], [0.6, 0.58, 0.85], LACQUER).add(
        [0.15, 0.58, 0.22],
        [0.45, 0.6, 0.56],
        BLACK_GLASS,
    )
}

/// A bath tub, 1.7 by 0.75 m.
pub fn bath_tub() -> Piece {
    Piece::default()
        .add([0.0, 0.0, 0.0], [1.7, 0.75, 0.56], CERAMIC)
        .carve([0.08, 0.08, 0.14], [1.62, 0.67, 0.56])
}

/// A wash basin on a pedestal, with a tap.
pub fn wash_basin(w: f64, d: f64) -> Piece {
    let middle = w / 2.0;
    Piece::default()
        .add([middle - 0.09, 0.0, 0.0], [middle + 0.09, 0.2, 0.7], CERAMIC)
        .add([0.0, 0.0, 0.7], [w, d, 0.85], CERAMIC)
        .carve([0.06, 0.12, 0.74], [w - 0.06, d - 0.05, 0.85])
        .add([middle - 0.015, 0.04, 0.85], [middle + 0.015, 0.18, 0.95], STEEL)
}

/// A toilet with a cistern, 0.4 by 0.66 m.
pub fn toilet() -> Piece {
    Piece::default()
        .add([0.12, 0.0, 0.0], [0.28, 0.56, 0.2], CERAMIC)
        .add([0.02, 0.0, 0.2], [0.38, 0.66, 0.4], CERAMIC)
        .carve([0.09, 0.28, 0.26], [0.31, 0.6, 0.4])
        .add([0.02, 0.0, 0.4], [0.38, 0.18, 0.8], CERAMIC)
}
