//! The loops over rows and pixels.

use glam::{DVec3, Vec3};

use super::cover::{Cover, starts};
use super::glass::{Layer, Layers};
use super::rows::Region;
use super::shade::Shading;
use super::sight::{Boxes, Places, Sight};
use super::simd;
use super::wide::{ALL, Columns, FARTHEST, Lines, ROWS, WIDE, Wide};
use crate::format::records::{BlockRecord, NodeRecord};
use crate::trace::Kernel;

/// What the CPU has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kernels(pub(crate) Kernel);

impl Kernels {
    /// The border in each row from the `first` on: the first column that is not left of a line, held between the row's own borders. The line is at `start`
    /// in row 0 and goes by `slope` a row. Returns the least and the greatest of them.
    #[inline]
    pub(super) fn split(
        self,
        borders: [&[i32]; 2],
        border: &mut [i32],
        first: i32,
        line: [f64; 2],
    ) -> [i32; 2] {
        simd::split(self.0, borders, border, first, line)
    }

    /// Fills what is free between the borders of rows, the first of which is the row `first` of the picture.
    #[inline]
    pub(super) fn fill<T: Tint>(self, borders: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, tint: &T) {
        simd::fill(self.0, borders, cover, first, tint);
    }

    /// Draws a triangle in some rows of the picture between their borders, of which there are more, so that eight can be read at once.
    #[inline]
    pub(super) fn draw<T: Tint>(
        self,
        borders: [&[i32]; 2],
        cover: &mut Cover<'_>,
        rows: [i32; 2],
        deep: &Deep,
        tint: &T,
    ) {
        simd::draw(self.0, borders, cover, rows, deep, tint);
    }

    /// Notes a triangle that is seen through as a layer, in the same rows.
    #[inline]
    pub(super) fn glaze(
        self,
        borders: [&[i32]; 2],
        cover: &mut Cover<'_>,
        rows: [i32; 2],
        deep: &Deep,
        layer: (Layer, &mut Layers),
    ) {
        simd::glaze(self.0, borders, cover, rows, deep, layer);
    }

    /// Mixes what is seen through layers into the pixels behind them.
    #[inline]
    pub(super) fn melt(
        self,
        layers: &mut Layers,
        cover: &mut Cover<'_>,
        square: &[f32; 5],
        unsure: &mut Vec<[i32; 3]>,
    ) {
        simd::melt(self.0, layers, cover, square, unsure);
    }

    /// Which of the children of a node show in a region, which has this frustum, and where.
    #[inline]
    pub(super) fn look_at_boxes(
        self,
        sight: &Sight,
        node: &NodeRecord,
        region: &Region,
        frustum: &[Vec3; 4],
    ) -> Boxes {
        simd::boxes(self.0, sight, node, region, frustum)
    }

    /// Which of the triangles of a block show in a region, which has this frustum, and where.
    #[inline]
    pub(super) fn look_at_triangles(
        self,
        sight: &Sight,
        block: &BlockRecord,
        region: &Region,
        frustum: &[Vec3; 4],
    ) -> (u32, Places) {
        simd::triangles(self.0, sight, block, region, frustum)
    }

    /// Whether detail is seen in all that is between the borders of rows, the first of which is the row `first` of the picture.
    #[inline]
    pub(super) fn is_taken(self, borders: [&[i32]; 2], cover: &Cover<'_>, first: i32) -> bool {
        is_taken(borders, cover, first)
    }
}

/// What the pixels of one surface become.
pub(crate) trait Tint {
    /// What is the same for all pixels of a row.
    fn row(&self, y: f32) -> [f32; 2];

    /// The same of eight rows, the first of them at `y`.
    #[inline(always)]
    fn rows(&self, y: f32) -> [[f32; 2]; ROWS] {
        let mut rows = [[0.0; 2]; ROWS];
        for (i, row) in rows.iter_mut().enumerate() {
            *row = self.row(y + i as f32);
        }
        rows
    }

    /// The pixels of some columns.
    fn pixels<W: Wide>(&self, row: [f32; 2], columns: W) -> W::Words;
}

/// All pixels become the same.
pub(crate) struct Flat(pub(crate) u32);

impl Tint for Flat {
    #[inline(always)]
    fn row(&self, _: f32) -> [f32; 2] {
        [0.0; 2]
    }

    #[inline(always)]
    fn pixels<W: Wide>(&self, _: [f32; 2], _: W) -> W::Words {
        W::words(self.0)
    }
}

impl Tint for Shading {
    #[inline(always)]
    fn row(&self, y: f32) -> [f32; 2] {
        let grows = self.grows[1] * y + self.grows[2];
        let square = (self.square[3] * y + self.square[2]) * y + self.square[0];
        [grows, square]
    }

    #[inline(always)]
    fn pixels<W: Wide>(&self, [grows, square]: [f32; 2], columns: W) -> W::Words {
        /// Its root is no number that could be seen, and can be divided by.
        const DARK: f32 = 1e-12;
        let cosine = columns.mul_add(W::splat(self.grows[0]), W::splat(grows)).abs();
        let size = columns.mul_add(W::splat(self.square[4]), W::splat(self.square[1]));
        let size = size.mul_add(columns, W::splat(square));
        let bright = cosine.mul_add(size.inverse_root(), W::splat(DARK));
        let bright = bright.mul(bright.inverse_root());
        // No closures where lanes are worked with: they are functions by themselves, compiled for any CPU.
        let [red, green, blue] = self.color;
        W::bytes(bright.mul(W::splat(red)), bright.mul(W::splat(green)), bright.mul(W::splat(blue)))
    }
}

/// Where lines pass eight rows.
type LinesOf<W> = <<W as Wide>::Columns as Columns>::Lines;

#[inline(always)]
pub(super) fn split<W: Wide>(
    [lo, hi]: [&[i32]; 2],
    border: &mut [i32],
    first: i32,
    [slope, start]: [f64; 2],
) -> [i32; 2] {
    let (mut least, mut most) = (W::Columns::load(&[i32::MAX; ROWS]), W::Columns::load(&[i32::MIN; ROWS]));
    let (borders, rest) = border.as_chunks_mut::<ROWS>();
    let ((los, lo_rest), (his, hi_rest)) = (lo.as_chunks::<ROWS>(), hi.as_chunks::<ROWS>());
    let mut row = first;
    for ((border, lo), hi) in borders.iter_mut().zip(los).zip(his) {
        let column = LinesOf::<W>::new(slope, start, row).not_left();
        let column = column.min(W::Columns::load(hi)).max(W::Columns::load(lo));
        (least, most) = (least.min(column), most.max(column));
        *border = column.store();
        row += ROWS as i32;
    }
    if !rest.is_empty() {
        let count = rest.len();
        // The last row again and again, so that there are eight.
        let eight = |from: &[i32]| std::array::from_fn(|i| from[i.min(count - 1)]);
        let (lo, hi) = (W::Columns::load(&eight(lo_rest)), W::Columns::load(&eight(hi_rest)));
        let column = LinesOf::<W>::new(slope, start, row).not_left();
        let column = column.min(hi).max(lo).store();
        rest.copy_from_slice(&column[..count]);
        let column = W::Columns::load(&eight(&column));
        (least, most) = (least.min(column), most.max(column));
    }
    let (least, most) = (least.store(), most.store());
    [least.into_iter().fold(i32::MAX, i32::min), most.into_iter().fold(i32::MIN, i32::max)]
}

/// A line of the picture as a border of rows: the first column that is not left of it is `start + slope * row`, rounded up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    slope: f64,
    start: f64,
    /// Whether its positive side is the left one.
    is_left: bool,
}

impl Bound {
    /// All are on its positive side.
    pub(super) const NONE: Bound = Bound { slope: 0.0, start: -1e9, is_left: false };

    /// The border of a line's positive side. Where the line runs along the rows, it is `rows` that are bounded.
    #[inline(always)]
    pub(super) fn new(line: DVec3, rows: &mut [i32; 2]) -> Bound {
        let (slope, start) = (-line.y / line.x, -line.z / line.x);
        if slope.is_finite() && start.is_finite() {
            return Bound { slope, start, is_left: line.x < 0.0 };
        }
        let row = (-line.z / line.y).ceil().clamp(f64::from(rows[0]), f64::from(rows[1]));
        if line.y > 0.0 {
            rows[0] = row as i32;
        } else if line.y < 0.0 {
            rows[1] = row as i32;
        }
        Bound::NONE
    }
}

/// A triangle, ready to be drawn.
pub(super) struct Deep {
    /// Its sides, and where rays have left before.
    pub(super) bounds: Vec<Bound>,
    /// `1 / t`: how it grows with column and row, and in the first pixel.
    pub(super) near: [f64; 3],
    /// The greatest that it may be.
    pub(super) nearest: f64,
}

/// A triangle must be nearer by this share to be seen before another: surfaces that lie on each other show the one that comes first in
/// all their pixels, whatever f32 rounds.
const NEARER: f32 = 1.0 + 4e-7;

/// Which of the sixteen columns of a block are from one up to another.
#[inline(always)]
fn between(block: usize, lo: i32, hi: i32) -> u32 {
    let first = (block * WIDE) as i32;
    let from = (lo - first).clamp(0, WIDE as i32) as u32;
    let to = (hi - first).clamp(0, WIDE as i32) as u32;
    (ALL << from) & ALL & (ALL >> (WIDE as u32 - to))
}

/// Writes pixels of one block of a row.
#[inline(always)]
pub(crate) fn put<W: Wide>(line: &mut [u32], block: usize, words: W::Words, mask: u32) {
    let from = block * WIDE;
    match line.get_mut(from..).and_then(|part| part.first_chunk_mut::<WIDE>()) {
        Some(pixels) if mask == ALL => W::put_all(words, pixels),
        _ => put_some::<W>(line, block, words, mask),
    }
}

/// The same, where it cannot be guessed whether these are all.
#[inline(always)]
fn put_some<W: Wide>(line: &mut [u32], block: usize, words: W::Words, mask: u32) {
    let from = block * WIDE;
    if let Some(pixels) = line.get_mut(from..).and_then(|part| part.first_chunk_mut::<WIDE>()) {
        W::put_words(words, mask, pixels);
    } else if let Some(part) = line.get_mut(from..) {
        let mut pixels = [0; WIDE];
        pixels[..part.len()].copy_from_slice(part);
        W::put_words(words, mask, &mut pixels);
        part.copy_from_slice(&pixels[..part.len()]);
    }
}

#[inline(always)]
pub(super) fn fill<W: Wide, T: Tint>([lo, hi]: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, tint: &T) {
    let (width, blocks) = (cover.width, Cover::blocks(cover.width));
    let start = (first - cover.top) as usize;
    let lines = cover.pixels.chunks_mut(width).skip(start);
    for (below, ((line, &lo), &hi)) in (start..).zip(lines.zip(lo).zip(hi)) {
        if lo >= hi {
            continue;
        }
        let same = tint.row((cover.top + below as i32) as f32);
        let (from, to) = (lo as usize / WIDE, (hi as usize - 1) / WIDE);
        let mut columns = W::splat((from * WIDE) as f32).add(W::count());
        let step = W::splat(WIDE as f32);
        if cover.drawn[below / ROWS] {
            let tiles = &cover.tiles[below / ROWS * blocks..][..blocks];
            for (block, tile) in (from..=to).zip(&tiles[from..]) {
                let mask = between(block, lo, hi) & !u32::from(tile.shown[below % ROWS]);
                if mask != 0 {
                    put::<W>(line, block, tint.pixels(same, columns), mask);
                }
                columns = columns.add(step);
            }
            continue;
        }
        put::<W>(line, from, tint.pixels(same, columns), between(from, lo, hi));
        if from == to {
            continue;
        }
        let (whole, _) = line.as_chunks_mut::<WIDE>();
        for block in &mut whole[from + 1..to] {
            columns = columns.add(step);
            W::put_all(tint.pixels(same, columns), block);
        }
        columns = columns.add(step);
        put::<W>(line, to, tint.pixels(same, columns), between(to, lo, hi));
    }
}

pub(super) fn is_taken([lo, hi]: [&[i32]; 2], cover: &Cover<'_>, first: i32) -> bool {
    // The middle first: most that are not taken are not there.
    let middle = lo.len() / 2;
    if !is_row_taken(cover, first + middle as i32, [lo[middle], hi[middle]]) {
        return false;
    }
    (first..).zip(lo.iter().zip(hi)).all(|(row, (&lo, &hi))| is_row_taken(cover, row, [lo, hi]))
}

/// Whether detail is seen in all pixels of a row from one column up to another.
#[inline(always)]
fn is_row_taken(cover: &Cover<'_>, row: i32, [lo, hi]: [i32; 2]) -> bool {
    let below = (row - cover.top) as usize;
    if lo >= hi {
        return true;
    }
    if !cover.is_drawn(below) {
        return false;
    }
    for block in lo as usize / WIDE..(hi as usize).div_ceil(WIDE) {
        if between(block, lo, hi) & !cover.shown(below, block) != 0 {
            return false;
        }
    }
    true
}

#[inline(always)]
pub(super) fn draw<W: Wide, T: Tint>(
    borders: [&[i32]; 2],
    cover: &mut Cover<'_>,
    rows: [i32; 2],
    deep: &Deep,
    tint: &T,
) {
    follow::<W>(borders, cover.top, rows, deep, &mut Drawing { cover, deep, tint });
}

#[inline(always)]
pub(super) fn glaze<W: Wide>(
    borders: [&[i32]; 2],
    cover: &mut Cover<'_>,
    rows: [i32; 2],
    deep: &Deep,
    (layer, layers): (Layer, &mut Layers),
) {
    layers.begin(layer);
    follow::<W>(borders, cover.top, rows, deep, &mut Glazing { cover, deep, layers });
}

#[inline(always)]
pub(super) fn melt<W: Wide>(
    layers: &mut Layers,
    cover: &mut Cover<'_>,
    square: &[f32; 5],
    unsure: &mut Vec<[i32; 3]>,
) {
    layers.melt::<W>(cover, square, unsure);
}

/// What becomes of a triangle in the rows of tiles.
trait Ink {
    /// Those rows of one row of tiles that are `there`, row i after `row` as bit i, between their borders.
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, borders: [[i32; ROWS]; 2]);
}

/// Follows a triangle through some rows of the picture, the first of all being `top`.
#[inline(always)]
fn follow<W: Wide>([lo, hi]: [&[i32]; 2], top: i32, rows: [i32; 2], deep: &Deep, ink: &mut impl Ink) {
    let mut row = rows[0];
    while row < rows[1] {
        // As many as are in one row of tiles.
        let count = (ROWS as i32 - (row - top) % ROWS as i32).min(rows[1] - row);
        let from = (row - rows[0]) as usize;
        let mut borders = [LinesOf::<W>::splat(-FARTHEST), LinesOf::<W>::splat(FARTHEST)];
        for bound in &deep.bounds {
            LinesOf::<W>::narrow(
                &mut borders,
                LinesOf::<W>::new(bound.slope, bound.start, row),
                bound.is_left,
            );
        }
        let (Some(lo), Some(hi)) = (lo[from..].first_chunk(), hi[from..].first_chunk()) else { return };
        let lo = borders[0].not_left().max(W::Columns::load(lo));
        let hi = borders[1].not_left().min(W::Columns::load(hi));
        // Rows after the last are not of this triangle.
        let there = lo.less(hi) & (u32::MAX >> (32 - count));
        if there != 0 {
            ink.tiles::<W>(row, there, [lo.store(), hi.store()]);
        }
        row += count;
    }
}

/// Draws a triangle.
struct Drawing<'d, 'c, T> {
    cover: &'d mut Cover<'c>,
    deep: &'d Deep,
    tint: &'d T,
}

impl<T: Tint> Ink for Drawing<'_, '_, T> {
    #[inline(always)]
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, borders: [[i32; ROWS]; 2]) {
        draw_tiles::<W, T>(self.cover, row, there, borders, self.deep, self.tint);
    }
}

/// Notes a triangle as a layer.
struct Glazing<'d, 'c> {
    cover: &'d mut Cover<'c>,
    deep: &'d Deep,
    layers: &'d mut Layers,
}

impl Ink for Glazing<'_, '_> {
    #[inline(always)]
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, [lo, hi]: [[i32; ROWS]; 2]) {
        let Glazing { cover, deep, layers } = self;
        let (blocks, below) = (Cover::blocks(cover.width), (row - cover.top) as usize);
        let step = W::splat(deep.near[0] as f32);
        for i in (0..ROWS).filter(|i| there >> i & 1 != 0) {
            let start = deep.near[1] * f64::from(row + i as i32) + deep.near[2];
            for block in lo[i] as usize / WIDE..=(hi[i] as usize - 1) / WIDE {
                let first = (deep.near[0] * (block * WIDE) as f64 + start) as f32;
                let mut mask = between(block, lo[i], hi[i]);
                let (below, shown) = (below + i, cover.shown(below + i, block));
                if shown != 0 {
                    let near = W::count().mul_add(step, W::splat(first));
                    let known = cover.near::<W>(below / ROWS * blocks + block);
                    mask &= near.greater(W::load(&known[below % ROWS])) | !shown;
                }
                if mask != 0 {
                    layers.add(below * blocks + block, first, mask);
                }
            }
        }
    }
}

/// Draws a triangle in those rows of one row of tiles that are `there`, row i after `row` as bit i, between their borders.
#[inline(always)]
fn draw_tiles<W: Wide, T: Tint>(
    cover: &mut Cover<'_>,
    row: i32,
    there: u32,
    [mut lo, mut hi]: [[i32; ROWS]; 2],
    deep: &Deep,
    tint: &T,
) {
    // The columns of any row, and those of all.
    let (mut left, mut right) = (i32::MAX, 0);
    let [mut inner_left, mut inner_right] = [0, i32::MAX];
    for i in 0..ROWS {
        let is_there = there >> i & 1 != 0;
        lo[i] = if is_there { lo[i] } else { i32::MAX };
        hi[i] = if is_there { hi[i] } else { 0 };
        left = left.min(lo[i]);
        right = right.max(hi[i]);
        inner_left = inner_left.max(lo[i]);
        inner_right = inner_right.min(hi[i]);
    }
    let (width, blocks) = (cover.width, Cover::blocks(cover.width));
    let below = (row - cover.top) as usize;
    let (tiles, above) = (below / ROWS * blocks, below % ROWS);
    cover.drawn[below / ROWS] = true;
    let start = deep.near[1] * f64::from(row) + deep.near[2];
    // Where in a tile it is nearest.
    let ahead = deep.near[0].max(0.0) * (WIDE - 1) as f64 + deep.near[1].max(0.0) * (ROWS - 1) as f64;
    let behind = deep.near[0].min(0.0) * (WIDE - 1) as f64 + deep.near[1].min(0.0) * (ROWS - 1) as f64;
    // From the first row of the tile on.
    let before = deep.near[1] * above as f64;
    let slopes = [deep.near[0] as f32, deep.near[1] as f32];
    let step = W::splat(slopes[0]);
    let rows = tint.rows(row as f32);
    let borders = [W::Columns::load(&lo), W::Columns::load(&hi)];
    for block in left as usize / WIDE..=(right as usize - 1) / WIDE {
        let (first, at) = (block * WIDE, tiles + block);
        let corner = deep.near[0] * first as f64 + start;
        let tile = &mut cover.tiles[at];
        let nearest = (corner + ahead).min(deep.nearest) as f32;
        let plane = [slopes[0], slopes[1], (corner - before) as f32];
        if nearest <= tile.far.abs() || tile.is_before(plane) {
            continue;
        }
        let columns = W::splat(first as f32).add(W::count());
        let fills = inner_left <= first as i32 && inner_right >= (first + WIDE) as i32;
        if fills && tile.is_free() {
            cover.lay(at, [deep.near[0], deep.near[1], corner], corner + behind);
            let lines = cover.pixels[below * width..].chunks_mut(width);
            for (line, same) in lines.zip(rows) {
                put::<W>(line, block, tint.pixels(same, columns), ALL);
            }
            continue;
        }
        tile.draw(plane, fills.then_some((corner + behind) as f32));
        let (is_free, mut shown) = (tile.is_free(), tile.shown);
        let (known, pixels) = cover.near_and_pixels::<W>(at);
        let (masks, mut rest) = borders[0].up_to(borders[1], first as i32);
        let starts = starts([deep.near[0], deep.near[1], corner]);
        // No branches but these: what a row of a triangle's edge does cannot be guessed.
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % ROWS;
            rest &= rest - 1;
            let in_tile = (above + i) % ROWS;
            let near = W::count().mul_add(step, W::splat(starts[i]));
            let (mut mask, known, shown) = (masks[i], &mut known[in_tile], &mut shown[in_tile]);
            if is_free {
                // Where it is not shown, it does not count.
                near.store(known);
            } else {
                mask &= near.greater(W::load(known).mul(W::splat(NEARER))) | !u32::from(*shown);
                if mask == 0 {
                    continue;
                }
                near.put(mask, known);
            }
            *shown |= mask as u16;
            let line = &mut pixels[(below + i) * width..][..width];
            put_some::<W>(line, block, tint.pixels(rows[i], columns), mask);
        }
        cover.tiles[at].shown = shown;
    }
}
