//! What things are kept in.

use crate::generate::furniture::Piece;
use crate::generate::palette::{
    BEECH, BLACK_GLASS, BLUE_FABRIC, CONCRETE, GREEN_PAINT, LACQUER, LINEN, PAPER, RED_WOOL, STEEL, WALNUT,
    ZINC,
};

/// A cupboard with doors flush in its front, and their handles.
pub fn cupboard([w, d, h]: [f64; 3], doors: u32, front: u32) -> Piece {
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], BEECH);
    let wide = w / f64::from(doors);
    let grip = (h - 0.5).min(0.9);
    for i in 0..doors {
        let u = f64::from(i) * wide;
        piece = piece.add([u + 0.02, d - 0.02, 0.06], [u + wide - 0.02, d, h - 0.03], front);
        let handle = if i % 2 == 0 { u + wide - 0.08 } else { u + 0.05 };
        piece = piece.add([handle, d, grip], [handle + 0.03, d + 0.03, grip + 0.18], STEEL);
    }
    piece
}

/// A cabinet of four drawers for files, 0.42 by 0.62 m.
pub fn filing_cabinet() -> Piece {
    let (w, d, h) = (0.42, 0.6, 1.32);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], ZINC);
    for i in 0..4 {
        let z = 0.02 + 0.325 * f64::from(i);
        piece = piece.add([0.12, d, z + 0.22], [0.3, d + 0.02, z + 0.25], STEEL);
    }
    piece
}

/// An open shelf 0.32 m deep with `rows` boards and files on them; how full it is follows from `pattern`.
pub fn file_shelf(w: f64, rows: u32, pattern: u32) -> Piece {
    let (d, board, pitch) = (0.32, 0.025, 0.37);
    let h = board + pitch * f64::from(rows);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], BEECH);
    // Shares of a board, and what stands there; the rest is empty.
    let boards: [&[(f64, u32)]; 6] = [
        &[(0.3, BLACK_GLASS), (0.25, CONCRETE), (0.2, BLUE_FABRIC)],
        &[(0.55, BLUE_FABRIC), (0.15, PAPER)],
        &[],
        &[(0.25, CONCRETE), (0.35, BLACK_GLASS)],
        &[(0.2, RED_WOOL), (0.3, CONCRETE)],
        &[(0.4, LINEN)],
    ];
    for row in 0..rows {
        let z = board + f64::from(row) * pitch;
        piece = piece.carve([board, 0.02, z], [w - board, d, z + pitch - board]);
        let mut u = board;
        for &(share, color) in boards[((pattern * 5 + row) % 6) as usize] {
            let wide = share * (w - 2.0 * board);
            piece = piece.add([u, 0.02, z], [u + wide, 0.29, z + 0.32], color);
            u += wide;
        }
    }
    piece
}

/// A bookcase from the floor to 2.12 m, `w` by 0.3 m, full of books on every board.
pub fn bookcase(w: f64, pattern: u32) -> Piece {
    let (d, board, pitch, rows) = (0.3, 0.025, 0.35, 6);
    let h = board + pitch * f64::from(rows);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [w, d, h], WALNUT);
    let colors = [PAPER, GREEN_PAINT, RED_WOOL, BLUE_FABRIC, LINEN];
    for row in 0..rows {
        let z = board + f64::from(row) * pitch;
        piece = piece.carve([board, 0.02, z], [w - board, d, z + pitch - board]);
        let pick = (pattern * 5 + row * 2) as usize;
        let full = (w - 2.0 * board) * [0.8, 1.0, 0.9, 0.55, 1.0][pick % 5];
        let middle = board + full * [0.4, 0.65][pick % 2];
        let [low, high] = [[0.25, 0.29], [0.28, 0.23], [0.22, 0.26]][pick % 3];
        let color = |i: usize| colors[(pick + row as usize + i) % 5];
        piece = piece.add([board, 0.02, z], [middle, 0.24, z + low], color(0));
        piece = piece.add([middle, 0.02, z], [board + full, 0.22, z + high], color(2));
    }
    piece
}

/// An open steel rack, `w` by 0.5 m and 2 m high, with cartons on its boards.
pub fn rack(w: f64, pattern: u32) -> Piece {
    let (d, h, post) = (0.5, 2.0, 0.04);
    let mut piece = Piece::default();
    for u in [0.0, w - post] {
        piece = piece.add([u, 0.0, 0.0], [u + post, d, h], ZINC);
        piece = piece.carve([u, post, 0.0], [u + post, d - post, h]);
    }
    for row in 0..4u32 {
        let z = 0.1 + 0.5 * f64::from(row);
        piece = piece.add([0.0, 0.0, z], [w, d, z + 0.03], ZINC);
        let pick = pattern + row;
        if pick % 5 == 4 {
            continue;
        }
        let from = 0.06 + 0.1 * f64::from(pick % 3);
        let to = (from + [0.35, 0.5, 0.7, 0.4][(pick % 4) as usize]).min(w - 0.06);
        let color = [BEECH, LINEN, CONCRETE][(pick % 3) as usize];
        piece = piece.add([from, 0.05, z + 0.03], [to, 0.45, z + 0.33], color);
    }
    piece
}

/// Cartons put one on the other, at most 0.6 by 0.5 m.
pub fn cartons(count: u32) -> Piece {
    let sizes = [[0.6, 0.5, 0.4], [0.5, 0.4, 0.3], [0.35, 0.3, 0.25]];
    let mut piece = Piece::default();
    let mut z = 0.0;
    for (i, [w, d, h]) in sizes.into_iter().take(count.max(1) as usize).enumerate() {
        let lo = 0.04 * i as f64;
        piece = piece.add([lo, lo, z], [lo + w, lo + d, z + h], BEECH);
        z += h;
    }
    piece
}

/// Steel lockers, each 0.4 m wide, two above each other, 1.8 m high and 0.5 m deep.
pub fn lockers(columns: u32) -> Piece {
    let (d, h) = (0.5, 1.8);
    let mut piece = Piece::default().add([0.0, 0.0, 0.0], [f64::from(columns) * 0.4, d, h], ZINC);
    for i in 0..columns {
        for (z, top) in [(0.1, 0.93), (0.96, 1.77)] {
            let u = f64::from(i) * 0.4;
            let front = if i % 2 == 0 { BLUE_FABRIC } else { CONCRETE };
            piece = piece.add([u + 0.02, d - 0.02, z], [u + 0.38, d, top], front);
        }
    }
    piece
}

/// A waste basket, 0.3 by 0.3 m.
pub fn bin(h: f64) -> Piece {
    Piece::default().add([0.0, 0.0, 0.0], [0.3, 0.3, h], CONCRETE).carve([0.02, 0.02, 0.02], [0.28, 0.28, h])
}

/// A trunk with a lid.
pub fn trunk(w: f64) -> Piece {
    Piece::default()
        .add([0.02, 0.02, 0.0], [w - 0.02, 0.5, 0.45], WALNUT)
        .add([0.0, 0.0, 0.45], [w, 0.52, 0.55], WALNUT)
        .add([w / 2.0 - 0.06, 0.5, 0.36], [w / 2.0 + 0.06, 0.52, 0.45], STEEL)
}

/// A cabinet of servers, 0.6 by 1 m and 2 m high.
pub fn server_rack(pattern: u32) -> Piece {
    let (w, d, h) = (0.6, 1.0, 2.0);
    let mut piece = Piece::default()
        .add([0.0, 0.0, 0.0], [w, d, h], BLACK_GLASS)
        .carve([0.05, d - 0.06, 0.1], [w - 0.05, d, h - 0.08]);
    let heights = [0.09, 0.18, 0.27, 0.09];
    let mut z = 0.14;
    for i in 0..(4 + pattern % 3) {
        let tall = heights[((i + pattern) % 4) as usize];
        let color = [ZINC, STEEL, LACQUER][((i * 2 + pattern) % 3) as usize];
        piece = piece.add([0.05, d - 0.06, z], [w - 0.05, d - 0.03, z + tall], color);
        z += tall + [0.02, 0.11][((i + pattern) % 2) as usize];
    }
    piece
}
