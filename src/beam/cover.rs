//! The rows of a picture being made, and how near what they show of triangles is.

use super::wide::{ALL, ROWS, WIDE, Wide};

/// `1 / t` of the pixels of a tile, each row one line of the memory.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Nears([[f32; WIDE]; ROWS]);

/// What some rows show of triangles, kept from picture to picture.
pub(crate) struct Depths {
    tiles: Vec<Tile>,
    near: Vec<Nears>,
    planes: Vec<[f64; 3]>,
    drawn: Vec<bool>,
}

impl Depths {
    pub(crate) fn new() -> Depths {
        let (tiles, near, planes, drawn) = Default::default();
        Depths { tiles, near, planes, drawn }
    }

    /// Begins with the rows from `top` on of a picture so wide, which `pixels` are.
    pub(crate) fn cover<'a>(&'a mut self, width: usize, top: i32, pixels: &'a mut [u32]) -> Cover<'a> {
        let (height, blocks) = (pixels.len() / width, Cover::blocks(width));
        let (rows, count) = (height.div_ceil(ROWS), height.div_ceil(ROWS) * blocks);
        let Depths { tiles, near, planes, drawn } = self;
        if tiles.len() == count && drawn.len() == rows {
            // Only where there was anything.
            let drawn = tiles.chunks_mut(blocks).zip(drawn).filter(|(_, drawn)| **drawn);
            drawn.for_each(|(tiles, drawn)| {
                tiles.fill(Tile::FREE);
                *drawn = false;
            });
        } else {
            tiles.clear();
            tiles.resize(count, Tile::FREE);
            drawn.clear();
            drawn.resize(rows, false);
        }
        // What these say holds only where tiles say so.
        near.resize(count, Nears([[0.0; WIDE]; ROWS]));
        planes.resize(count, [0.0; 3]);
        Cover { width, height, top, pixels, tiles, near, planes, drawn: &mut self.drawn }
    }
}

/// Rows of a picture being made, each from left to right in blocks of [`WIDE`] pixels, of which the last may not be whole; the blocks of [`ROWS`] rows
/// that lie on each other are a tile.
pub(crate) struct Cover<'a> {
    pub(crate) width: usize,
    /// How many rows.
    pub(crate) height: usize,
    /// The first row.
    pub(crate) top: i32,
    pub(crate) pixels: &'a mut [u32],
    /// Row by row of tiles.
    pub(super) tiles: &'a mut [Tile],
    /// `1 / t` of the detail that each pixel of a tile shows; holds only where it shows any, and not where its plane tells.
    near: &'a mut [Nears],
    /// The one plane of which a tile shows a triangle in all pixels, if that [`Tile::is_plane`]: as [`Tile::plane`], exactly.
    planes: &'a mut [[f64; 3]],
    /// Whether each row of tiles shows any detail.
    pub(super) drawn: &'a mut [bool],
}

/// What is known of a tile.
#[derive(Clone, Copy)]
pub(super) struct Tile {
    /// Which pixels of each row show detail, pixel i as bit i.
    pub(super) shown: [u16; ROWS],
    /// The least of all `1 / t`, or less; negative if they were drawn on since.
    pub(super) far: f32,
    /// All of them show this plane or what is nearer: how its `1 / t` grows with column and row, and in the first pixel.
    plane: [f32; 3],
    /// All of them show one plane, which is told in the place of each of them.
    is_plane: bool,
}

impl Tile {
    /// Nothing is shown.
    const FREE: Tile = Tile { shown: [0; ROWS], far: 0.0, plane: [0.0; 3], is_plane: false };

    /// Whether all pixels show what is nearer than a plane, whose greatest `1 / t` in it this is, or more.
    #[inline(always)]
    pub(super) fn hides(&self, nearest: f32, plane: [f32; 3]) -> bool {
        nearest <= self.far.abs() || self.is_before(plane)
    }

    /// Whether all pixels show what is nearer than a plane.
    #[inline(always)]
    fn is_before(&self, plane: [f32; 3]) -> bool {
        let by = [plane[0] - self.plane[0], plane[1] - self.plane[1], plane[2] - self.plane[2]];
        by[2] + (WIDE - 1) as f32 * by[0].max(0.0) + (ROWS - 1) as f32 * by[1].max(0.0) <= 0.0
            && self.far != 0.0
    }

    /// Whether no pixel shows any detail.
    #[inline(always)]
    pub(super) fn is_free(&self) -> bool {
        self.shown == [0; ROWS]
    }

    /// Notes that part of a plane is drawn; all of it, if `farthest` is known.
    #[inline(always)]
    pub(super) fn draw(&mut self, plane: [f32; 3], farthest: Option<f32>) {
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

/// What f32 may round.
const FARTHER: f32 = 1.0 - 4e-7;

impl Cover<'_> {
    /// Blocks in a row.
    pub(crate) fn blocks(width: usize) -> usize {
        width.div_ceil(WIDE)
    }

    /// Which pixels of a block show detail, pixel i as bit i; the row is one of those from the first on.
    #[inline(always)]
    pub(crate) fn shown(&self, below: usize, block: usize) -> u32 {
        self.tiles[below / ROWS * Cover::blocks(self.width) + block].shown[below % ROWS].into()
    }

    /// Whether a row may show any detail; it is one of those from the first on.
    #[inline(always)]
    pub(crate) fn is_drawn(&self, below: usize) -> bool {
        self.drawn[below / ROWS]
    }

    /// Whether detail is seen in a pixel.
    pub(crate) fn is_taken(&self, row: i32, column: i32) -> bool {
        let shown = self.shown((row - self.top) as usize, column as usize / WIDE);
        shown >> (column as usize % WIDE) & 1 != 0
    }

    /// Whether the detail that is seen in a pixel is as near as this, which is `1 / t`, or nearer, but for what f32 rounds.
    pub(super) fn is_as_near(&self, row: i32, column: i32, near: f64) -> bool {
        /// What f32 may round.
        const ROUNDED: f64 = 1e-6;
        if !self.is_taken(row, column) {
            return false;
        }
        let [row, column] = [row - self.top, column].map(|at| at as usize);
        let at = row / ROWS * Cover::blocks(self.width) + column / WIDE;
        let [row, column] = [row % ROWS, column % WIDE];
        let shown = if self.tiles[at].is_plane {
            let [across, down, first] = self.planes[at];
            across * column as f64 + down * row as f64 + first
        } else {
            f64::from(self.near[at].0[row][column])
        };
        shown >= near * (1.0 - ROUNDED)
    }

    /// All pixels of a tile that was free become one plane, of which this is the least `1 / t` in it.
    #[inline(always)]
    pub(super) fn lay(&mut self, tile: usize, plane: [f64; 3], farthest: f64) {
        let [across, down, first] = [plane[0] as f32, plane[1] as f32, plane[2] as f32];
        self.tiles[tile] = Tile {
            shown: [ALL as u16; ROWS],
            far: farthest as f32 * FARTHER,
            plane: [across, down, first],
            is_plane: true,
        };
        self.planes[tile] = plane;
    }

    /// How near each pixel of a tile is that shows detail.
    #[inline(always)]
    pub(super) fn near<W: Wide>(&mut self, tile: usize) -> &mut [[f32; WIDE]; ROWS] {
        self.parts::<W>(tile).1
    }

    /// A tile, how near each of its pixels is that shows detail, and the pixels of all.
    #[inline(always)]
    pub(super) fn parts<W: Wide>(&mut self, at: usize) -> (&mut Tile, &mut [[f32; WIDE]; ROWS], &mut [u32]) {
        let (tile, Nears(near)) = (&mut self.tiles[at], &mut self.near[at]);
        if tile.is_plane {
            tile.is_plane = false;
            let step = W::splat(self.planes[at][0] as f32);
            let starts = starts(self.planes[at]);
            for i in 0..ROWS {
                W::count().mul_add(step, W::splat(starts[i])).store(&mut near[i]);
            }
        }
        (tile, near, self.pixels)
    }

    /// Whether all pixels of some columns and rows show detail nearer than `near`, which is `1 / t`.
    #[inline(always)]
    pub(super) fn hides<W: Wide>(&mut self, columns: [i32; 2], rows: [i32; 2], near: f32) -> bool {
        let blocks = Cover::blocks(self.width);
        let rows = rows.map(|row| (row - self.top) as usize);
        let columns = columns.map(|column| column as usize);
        let (from, to) = (rows[0] / ROWS, (rows[1] - 1) / ROWS);
        let (left, right) = (columns[0] / WIDE, (columns[1] - 1) / WIDE);
        // Not `..=`, which says at each step anew whether it was the last.
        for row in from..to + 1 {
            for block in left..right + 1 {
                let at = row * blocks + block;
                let mut far = self.tiles[at].far;
                if far.abs() < near && far.is_sign_negative() {
                    far = self.farthest(row, block);
                    self.tiles[at].far = far;
                }
                if far.abs() < near && !self.hides_in_tile::<W>([row, block], columns, rows, near) {
                    return false;
                }
            }
        }
        true
    }

    /// The same in one tile, pixel by pixel.
    #[inline(always)]
    fn hides_in_tile<W: Wide>(
        &self,
        [row, block]: [usize; 2],
        columns: [usize; 2],
        rows: [usize; 2],
        near: f32,
    ) -> bool {
        let (first, top) = (block * WIDE, row * ROWS);
        let columns = columns.map(|column| column.clamp(first, first + WIDE) - first);
        let rows = rows.map(|row| row.clamp(top, top + ROWS) - top);
        let at = row * Cover::blocks(self.width) + block;
        let tile = &self.tiles[at];
        if tile.is_plane {
            let [across, down, start] = self.planes[at];
            let least = |by: f64, [from, to]: [usize; 2]| (by * from as f64).min(by * (to - 1) as f64);
            return (start + least(across, columns) + least(down, rows)) as f32 * FARTHER >= near;
        }
        let mask = (ALL << columns[0]) & (ALL >> (WIDE - columns[1]));
        let near = W::splat(near);
        for i in rows[0]..rows[1] {
            let open = near.greater(W::load(&self.near[at].0[i])) | !u32::from(tile.shown[i]);
            if mask & open != 0 {
                return false;
            }
        }
        true
    }

    /// The least `1 / t` of a tile that is not told by its plane.
    fn farthest(&self, row: usize, block: usize) -> f32 {
        let tile = row * Cover::blocks(self.width) + block;
        // What is right of the picture, or below, hides nothing.
        let count = (self.width - block * WIDE).min(WIDE);
        let all = (ALL >> (WIDE - count)) as u16;
        let rows = (self.height - row * ROWS).min(ROWS);
        let mut least = [f32::INFINITY; WIDE];
        for (shown, near) in self.tiles[tile].shown[..rows].iter().zip(&self.near[tile].0) {
            if *shown != all {
                return 0.0;
            }
            for (least, &near) in least.iter_mut().zip(near) {
                *least = if near < *least { near } else { *least };
            }
        }
        least[..count].iter().copied().fold(f32::INFINITY, f32::min)
    }
}

/// `1 / t` of a plane in the first pixel of eight rows, as f32 has it: the plane as [`Tile::plane`].
#[inline(always)]
pub(super) fn starts([_, down, first]: [f64; 3]) -> [f32; ROWS] {
    let mut starts = [0.0; ROWS];
    for (i, start) in starts.iter_mut().enumerate() {
        *start = (first + down * i as f64) as f32;
    }
    starts
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::beam::kernels::{Bound, Deep, Flat, Kernels};
    use crate::beam::wide::Portable;
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

    fn near(cover: &mut Cover<'_>, x: usize, y: usize) -> f32 {
        let tile = y / ROWS * Cover::blocks(SIZE[0]) + x / WIDE;
        let is_shown = cover.is_taken(TOP + y as i32, x as i32);
        if is_shown { cover.near::<Portable>(tile)[y % ROWS][x % WIDE] } else { 0.0 }
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
                        let near = near(&mut single, at % SIZE[0], at / SIZE[0]);
                        if single.pixels[at] != 0 && near > best[at] * (1.0 + 4e-7) {
                            (best[at], expected[at]) = (near, number);
                        }
                    }
                    draw(kernel, &mut cover, &deep, number);
                    for &(x, y, width, height, limit) in &places {
                        let (x1, y1) = ((x + width).min(SIZE[0]), (y + height).min(SIZE[1]));
                        let rows = [TOP + y as i32, TOP + y1 as i32];
                        let hides = Kernels(kernel).hides(&mut cover, [x as i32, x1 as i32], rows, limit);
                        let pixels = (y..y1).flat_map(|y| (x..x1).map(move |x| (x, y)));
                        let all = pixels.into_iter().all(|(x, y)| near(&mut cover, x, y) >= limit * (1.0 - 1e-6));
                        prop_assert!(!hides || all);
                    }
                }
                prop_assert_eq!(&*cover.pixels, &expected[..]);
            }
        }
    }
}
