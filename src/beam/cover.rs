//! The rows of a picture being made, and how near what they show of triangles is.

use super::wide::{ROWS, WIDE};

/// How near what some rows show is, kept from picture to picture.
pub(crate) struct Depths {
    near: Vec<[f32; WIDE]>,
    touched: Vec<bool>,
    rows: Vec<bool>,
    tiles: Vec<Tile>,
}

impl Depths {
    pub(crate) fn new() -> Depths {
        let (near, touched, rows, tiles) = Default::default();
        Depths { near, touched, rows, tiles }
    }

    /// Begins with the rows from `top` on of a picture so wide, which `pixels` are.
    pub(crate) fn cover<'a>(&'a mut self, width: usize, top: i32, pixels: &'a mut [u32]) -> Cover<'a> {
        let (rows, blocks) = (pixels.len() / width, Cover::blocks(width));
        // What is near holds only where it is touched.
        self.near.resize(rows * blocks, [0.0; WIDE]);
        self.touched.clear();
        self.touched.resize(rows * blocks, false);
        self.rows.clear();
        self.rows.resize(rows, false);
        self.tiles.clear();
        self.tiles.resize(rows.div_ceil(ROWS) * blocks, Tile::FREE);
        let Depths { near, touched, rows, tiles } = self;
        Cover { width, top, pixels, near, touched, rows, tiles }
    }
}

/// Rows of a picture being made, each from left to right in blocks of [`WIDE`] pixels, of which the last may not be whole.
pub(crate) struct Cover<'a> {
    pub(crate) width: usize,
    /// The first row.
    pub(crate) top: i32,
    pub(crate) pixels: &'a mut [u32],
    /// `1 / t` of the detail that each pixel shows, 0 where it shows none, by block; holds only where that shows any.
    pub(crate) near: &'a mut [[f32; WIDE]],
    /// Whether each block shows any detail.
    pub(crate) touched: &'a mut [bool],
    /// Whether each row does.
    pub(crate) rows: &'a mut [bool],
    pub(super) tiles: &'a mut [Tile],
}

/// What is known of the blocks of [`ROWS`] rows that lie on each other.
#[derive(Clone, Copy)]
pub(super) struct Tile {
    /// The least of all `1 / t`, or less; negative if they were drawn on since.
    pub(super) far: f32,
    /// All of them show this plane or what is nearer: how its `1 / t` grows with column and row, and in the first pixel.
    plane: [f32; 3],
}

impl Tile {
    /// Nothing is shown.
    const FREE: Tile = Tile { far: 0.0, plane: [0.0; 3] };

    /// Whether all pixels show what is nearer than a plane.
    #[inline(always)]
    pub(super) fn is_before(&self, plane: [f32; 3]) -> bool {
        let by = [plane[0] - self.plane[0], plane[1] - self.plane[1], plane[2] - self.plane[2]];
        by[2] + (WIDE - 1) as f32 * by[0].max(0.0) + (ROWS - 1) as f32 * by[1].max(0.0) <= 0.0
            && self.far != 0.0
    }

    /// Notes that part of a plane is drawn; all of it, if `farthest` is known.
    #[inline(always)]
    pub(super) fn draw(&mut self, plane: [f32; 3], farthest: Option<f32>) {
        /// What f32 may round.
        const FARTHER: f32 = 1.0 - 4e-7;
        match farthest {
            // What was nearer somewhere is still.
            Some(farthest) => {
                if self.plane == Tile::FREE.plane {
                    self.plane = plane;
                }
                self.far = -self.far.abs().max(farthest * FARTHER);
            }
            None => self.far = -self.far.abs(),
        }
    }
}

impl Cover<'_> {
    /// Blocks in a row.
    pub(crate) fn blocks(width: usize) -> usize {
        width.div_ceil(WIDE)
    }

    /// Whether detail is seen in a pixel.
    pub(crate) fn is_taken(&self, row: i32, column: i32) -> bool {
        let block = (row - self.top) as usize * Cover::blocks(self.width) + column as usize / WIDE;
        self.touched[block] && self.near[block][column as usize % WIDE] != 0.0
    }

    /// Whether all pixels of some columns and rows show detail nearer than `near`, which is `1 / t`.
    pub(super) fn hides(&mut self, columns: [i32; 2], rows: [i32; 2], near: f32) -> bool {
        let blocks = Cover::blocks(self.width);
        let (from, to) = ((rows[0] - self.top) as usize / ROWS, (rows[1] - 1 - self.top) as usize / ROWS);
        let (left, right) = (columns[0] as usize / WIDE, (columns[1] - 1) as usize / WIDE);
        for row in from..=to {
            for block in left..=right {
                let mut far = self.tiles[row * blocks + block].far;
                if far.abs() < near && far.is_sign_negative() {
                    far = self.farthest(row, block);
                    self.tiles[row * blocks + block].far = far;
                }
                if far.abs() < near {
                    return false;
                }
            }
        }
        true
    }

    /// The least `1 / t` of a tile.
    fn farthest(&self, tile: usize, block: usize) -> f32 {
        let blocks = Cover::blocks(self.width);
        let rows = tile * ROWS..((tile + 1) * ROWS).min(self.rows.len());
        let mut least = [f32::INFINITY; WIDE];
        for row in rows {
            let at = row * blocks + block;
            if !self.touched[at] {
                return 0.0;
            }
            for (least, &near) in least.iter_mut().zip(&self.near[at]) {
                *least = if near < *least { near } else { *least };
            }
        }
        // What is right of the picture hides nothing.
        let count = (self.width - block * WIDE).min(WIDE);
        least[..count].iter().copied().fold(f32::INFINITY, f32::min)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::beam::kernels::{Bound, Deep, Flat, Kernels};
    use crate::trace::Kernel;

    const SIZE: [usize; 2] = [75, 41];
    const TOP: i32 = 16;

    /// A triangle with corners in the picture, and how near it is at each.
    fn deep(corners: [[f64; 2]; 3], near: [f64; 3]) -> Option<([i32; 2], Deep)> {
        let [a, b, c] = [0, 1, 2].map(|i| DVec3::new(corners[i][0], corners[i][1], 1.0) / near[i]);
        let sides = [b.cross(c), c.cross(a), a.cross(b)];
        let size = a.dot(sides[0]);
        let plane = (sides[0] + sides[1] + sides[2]) / size;
        let mut rows = [TOP, TOP + SIZE[1] as i32];
        let bounds = sides.map(|side| Bound::new(side * size.signum(), &mut rows)).to_vec();
        let nearest = near.into_iter().fold(0.0, f64::max) * (1.0 + 1e-6);
        let is_there = size != 0.0 && plane.is_finite() && rows[0] < rows[1];
        is_there.then(|| (rows, Deep { bounds, near: plane.to_array(), nearest }))
    }

    /// All rows reach from end to end.
    fn draw(kernel: Kernel, cover: &mut Cover<'_>, (rows, deep): &([i32; 2], Deep), number: u32) {
        let (lo, hi) = (vec![0; SIZE[1] + ROWS], vec![SIZE[0] as i32; SIZE[1] + ROWS]);
        Kernels(kernel).draw([&lo, &hi], cover, *rows, deep, &Flat(number));
    }

    fn near(cover: &Cover<'_>, x: usize, y: usize) -> f32 {
        let block = y * Cover::blocks(SIZE[0]) + x / WIDE;
        if cover.touched[block] { cover.near[block][x % WIDE] } else { 0.0 }
    }

    fn triangle() -> impl Strategy<Value = ([[f64; 2]; 3], [f64; 3])> {
        let corner = || [-40.0f64..110.0, -20.0f64..90.0];
        ([corner(), corner(), corner()], [0.02f64..0.1, 0.02f64..0.1, 0.02f64..0.1])
    }

    proptest! {
        /// What tiles know hides no pixel that shows: as if each triangle was drawn alone, and the nearest kept.
        #[test]
        fn tiles_hide_only_what_is_hidden(
            triangles in prop::collection::vec(triangle(), 1..24),
            places in prop::collection::vec((0..SIZE[0], 0..SIZE[1], 1usize..30, 1usize..20, 0.02f32..0.1), 8),
        ) {
            for kernel in Kernel::available() {
                let (mut depths, mut alone) = (Depths::new(), Depths::new());
                let count = SIZE[0] * SIZE[1];
                let (mut pixels, mut expected, mut best) = (vec![0; count], vec![0; count], vec![0.0f32; count]);
                let mut cover = depths.cover(SIZE[0], TOP, &mut pixels);
                for (number, &(corners, nears)) in (1..).zip(&triangles) {
                    let Some(deep) = deep(corners, nears) else { continue };
                    let mut own = vec![0; count];
                    let mut single = alone.cover(SIZE[0], TOP, &mut own);
                    draw(kernel, &mut single, &deep, number);
                    for at in 0..count {
                        let near = near(&single, at % SIZE[0], at / SIZE[0]);
                        if single.pixels[at] != 0 && near > best[at] * (1.0 + 4e-7) {
                            (best[at], expected[at]) = (near, number);
                        }
                    }
                    draw(kernel, &mut cover, &deep, number);
                    for &(x, y, width, height, limit) in &places {
                        let (x1, y1) = ((x + width).min(SIZE[0]), (y + height).min(SIZE[1]));
                        let rows = [TOP + y as i32, TOP + y1 as i32];
                        let hides = cover.hides([x as i32, x1 as i32], rows, limit);
                        let pixels = (y..y1).flat_map(|y| (x..x1).map(move |x| (x, y)));
                        let all = pixels.into_iter().all(|(x, y)| near(&cover, x, y) >= limit * (1.0 - 1e-6));
                        prop_assert!(!hides || all);
                    }
                }
                prop_assert_eq!(&*cover.pixels, &expected[..]);
            }
        }
    }
}
