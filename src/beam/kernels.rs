//! The loops over rows and pixels.

use glam::{DVec3, Vec3};

use super::cover::{Cover, Tile, starts};
use super::glass::{Layer, Layers};
use super::rows::Region;
use super::shade::Shading;
use super::sight::{Boxes, Places, Sight};
use super::simd;
use super::wide::{ALL, Columns, FARTHEST, Levels, Lines, ROWS, WIDE, Wide};
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

    /// Gives `take` those parts of rows from the `first` on, between their own borders, that are on the positive side of two lines. Hardly ever there are any.
    #[inline]
    pub(super) fn near(
        self,
        borders: [&[i32]; 2],
        first: i32,
        bounds: [Bound; 2],
        take: &mut dyn FnMut(i32, [i32; 2]),
    ) {
        simd::near(self.0, borders, first, bounds, take);
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

    /// Whether all pixels of some columns and rows of a picture show detail nearer than `near`, which is `1 / t`.
    #[inline]
    pub(super) fn hides(self, cover: &mut Cover<'_>, columns: [i32; 2], rows: [i32; 2], near: f32) -> bool {
        simd::hides(self.0, cover, columns, rows, near)
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

    /// Which of the triangles of a block show in a region, which has this frustum, and where; its backs are left out.
    #[inline]
    pub(super) fn look_at_triangles(
        self,
        sight: &Sight,
        block: &BlockRecord,
        backs: [u32; 2],
        region: &Region,
        frustum: &[Vec3; 4],
    ) -> (u32, Places) {
        simd::triangles(self.0, sight, block, backs, region, frustum)
    }
}

/// What the pixels of one surface become.
pub(crate) trait Tint {
    /// What is the same for all pixels of a row.
    fn row(&self, y: f32) -> [f32; 2];

    /// The same of eight rows, the first of them at `y`, twice.
    #[inline(always)]
    fn rows(&self, y: f32) -> [[f32; WIDE]; 2] {
        let mut rows = [[0.0; WIDE]; 2];
        for i in 0..WIDE {
            let [grows, square] = self.row(y + (i % ROWS) as f32);
            (rows[0][i], rows[1][i]) = (grows, square);
        }
        rows
    }

    /// The pixels of some columns.
    fn pixels<W: Wide>(&self, row: [f32; 2], columns: W) -> W::Words;

    /// Whether, in all rows from one to another and the columns `of` to each other, each sixteen pixels from one end to the other are as a ramp has them.
    fn is_even(&self, rows: [[f32; 2]; 2], of: [f32; 2]) -> bool;

    /// What pixels become from which ramps are made: each in its row and column.
    fn levels<W: Wide>(&self, rows: [W; 2], columns: W) -> Levels;
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

    #[inline(always)]
    fn is_even(&self, _: [[f32; 2]; 2], _: [f32; 2]) -> bool {
        false
    }

    #[inline(always)]
    fn levels<W: Wide>(&self, _: [W; 2], _: W) -> Levels {
        Levels { red_blue: [0; WIDE], green: [0; WIDE] }
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
        let bright = self.bright([W::splat(grows), W::splat(square)], columns);
        let [red, green, blue] = self.color;
        W::bytes(bright.mul(W::splat(red)), bright.mul(W::splat(green)), bright.mul(W::splat(blue)))
    }

    #[inline(always)]
    fn is_even(&self, rows: [[f32; 2]; 2], of: [f32; 2]) -> bool {
        // No closures where lanes are worked with: they are functions by themselves, compiled for any CPU.
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for [grows, _] in rows {
            for column in of {
                let grown = self.grows[0] * column + grows;
                (least, most) = (least.min(grown), most.max(grown));
            }
        }
        least.max(-most) >= self.steep
    }

    #[inline(always)]
    fn levels<W: Wide>(&self, rows: [W; 2], columns: W) -> Levels {
        self.bright(rows, columns).levels(&self.color)
    }
}

impl Shading {
    /// How bright each pixel is in its row and column, from 0 to 1.
    #[inline(always)]
    fn bright<W: Wide>(&self, [grows, square]: [W; 2], columns: W) -> W {
        /// Its root is no number that could be seen, and can be divided by.
        const DARK: f32 = 1e-12;
        let cosine = columns.mul_add(W::splat(self.grows[0]), grows).abs();
        let size = columns.mul_add(W::splat(self.square[4]), W::splat(self.square[1]));
        let size = size.mul_add(columns, square);
        let bright = cosine.mul_add(size.inverse_root(), W::splat(DARK));
        bright.mul(bright.inverse_root())
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
    [least.least(), most.most()]
}

#[inline(always)]
pub(super) fn near<W: Wide>(
    [lo, hi]: [&[i32]; 2],
    first: i32,
    bounds: [Bound; 2],
    take: &mut dyn FnMut(i32, [i32; 2]),
) {
    let ((los, lo_rest), (his, hi_rest)) = (lo.as_chunks::<ROWS>(), hi.as_chunks::<ROWS>());
    let mut row = first;
    for (lo, hi) in los.iter().zip(his) {
        if may_be_between::<W>(row, bounds) {
            take_between(row, [lo, hi], bounds, take);
        }
        row += ROWS as i32;
    }
    if !lo_rest.is_empty() && may_be_between::<W>(row, bounds) {
        take_between(row, [lo_rest, hi_rest], bounds, take);
    }
}

/// Whether in any of eight rows there is a column on the positive side of two lines.
#[inline(always)]
fn may_be_between<W: Wide>(row: i32, [one, other]: [Bound; 2]) -> bool {
    if one.is_left == other.is_left {
        return true;
    }
    let [from, to] = if one.is_left { [other, one] } else { [one, other] };
    let from = LinesOf::<W>::new(from.slope, from.start, row).not_left();
    let to = LinesOf::<W>::new(to.slope, to.start, row).not_left();
    from.less(to) != 0
}

/// Gives `take` what of some rows between their borders is on the positive side of two lines.
fn take_between(first: i32, [lo, hi]: [&[i32]; 2], bounds: [Bound; 2], take: &mut dyn FnMut(i32, [i32; 2])) {
    for (row, (&lo, &hi)) in (first..).zip(lo.iter().zip(hi)) {
        let part = bounds.iter().fold([lo, hi], |part, bound| bound.within(part, row));
        if part[0] < part[1] {
            take(row, part);
        }
    }
}

/// Rounded up; what cannot be told is held within what numbers there are.
#[inline(always)]
pub(super) fn up(x: f64) -> i32 {
    let down = x as i32;
    down.saturating_add(i32::from(f64::from(down) < x))
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

    /// Those of some columns of a row that are on the positive side.
    #[inline(always)]
    pub(super) fn within(&self, [from, to]: [i32; 2], row: i32) -> [i32; 2] {
        let column = up(self.start + self.slope * f64::from(row));
        if self.is_left { [from, to.min(column)] } else { [from.max(column), to] }
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
    /// Ramps of a row that are made ready together: between as many pixels as are side by side. For less than the least it is not worth it.
    const MOST: usize = WIDE - 1;
    const LEAST: usize = 3;
    let (width, blocks) = (cover.width, Cover::blocks(cover.width));
    let start = (first - cover.top) as usize;
    let lines = cover.pixels.chunks_mut(width).skip(start);
    for (below, ((line, &lo), &hi)) in (start..).zip(lines.zip(lo).zip(hi)) {
        if lo >= hi {
            continue;
        }
        let row = tint.row((cover.top + below as i32) as f32);
        let tiles = cover.drawn[below / ROWS].then(|| &cover.tiles[below / ROWS * blocks..][..blocks]);
        let mut span = Span { line, lo, hi, tiles, in_tile: below % ROWS };
        let (mut from, to) = (lo as usize / WIDE, (hi as usize).div_ceil(WIDE));
        while from < to {
            let until = to.min(from + MOST);
            let ends = [(from * WIDE) as f32, (until * WIDE) as f32];
            if until >= from + LEAST && tint.is_even([row; 2], ends) {
                let columns = W::count().mul_add(W::splat(WIDE as f32), W::splat(ends[0]));
                let levels = tint.levels::<W>([W::splat(row[0]), W::splat(row[1])], columns);
                span.put::<W>(from, until, &Ramps { levels, first: from });
            } else {
                span.put::<W>(from, until, &Tinted { tint, row });
            }
            from = until;
        }
    }
}

/// What the blocks of a row become.
trait Blocks {
    fn words<W: Wide>(&self, block: usize) -> W::Words;
}

/// By ramps, the first of them that of a block.
struct Ramps {
    levels: Levels,
    first: usize,
}

impl Blocks for Ramps {
    #[inline(always)]
    fn words<W: Wide>(&self, block: usize) -> W::Words {
        W::ramp(&self.levels, block - self.first, block - self.first + 1)
    }
}

/// Each pixel by itself.
struct Tinted<'t, T> {
    tint: &'t T,
    row: [f32; 2],
}

impl<T: Tint> Blocks for Tinted<'_, T> {
    #[inline(always)]
    fn words<W: Wide>(&self, block: usize) -> W::Words {
        self.tint.pixels(self.row, W::splat((block * WIDE) as f32).add(W::count()))
    }
}

/// Part of a row.
struct Span<'l> {
    line: &'l mut [u32],
    lo: i32,
    hi: i32,
    /// What its row of tiles shows, if it shows any detail, and which of its rows it is.
    tiles: Option<&'l [Tile]>,
    in_tile: usize,
}

impl Span<'_> {
    /// Writes what is free of some of its blocks.
    #[inline(always)]
    fn put<W: Wide>(&mut self, from: usize, until: usize, source: &impl Blocks) {
        let (lo, hi) = (self.lo, self.hi);
        // Of the first and the last not all, perhaps.
        let inner = [from.max((lo as usize).div_ceil(WIDE)), until.min(hi as usize / WIDE)];
        if from < inner[0] {
            self.put_some::<W>(from, source);
        }
        let (whole, _) = self.line.as_chunks_mut::<WIDE>();
        if let Some(whole) = whole.get_mut(inner[0]..inner[1]) {
            let tiles = self.tiles.and_then(|tiles| tiles.get(inner[0]..inner[1]));
            match tiles {
                None => {
                    for (block, to) in (inner[0]..).zip(whole) {
                        W::put_all(source.words::<W>(block), to);
                    }
                }
                Some(tiles) => {
                    for ((block, to), tile) in (inner[0]..).zip(whole).zip(tiles) {
                        let shown = u32::from(tile.shown[self.in_tile]);
                        if shown == 0 {
                            W::put_all(source.words::<W>(block), to);
                        } else if shown != ALL {
                            W::put_words(source.words::<W>(block), ALL & !shown, to);
                        }
                    }
                }
            }
        }
        let last = inner[0].max(inner[1]);
        if last < until {
            self.put_some::<W>(last, source);
        }
    }

    /// Writes what is free of a block that is not all within.
    #[inline(always)]
    fn put_some<W: Wide>(&mut self, block: usize, source: &impl Blocks) {
        let shown = self.tiles.map_or(0, |tiles| tiles[block].shown[self.in_tile].into());
        let mask = between(block, self.lo, self.hi) & !shown;
        if mask != 0 {
            put_some::<W>(self.line, block, source.words::<W>(block), mask);
        }
    }
}

/// Whether detail is seen in all that is between the borders of rows, the first of which is the row `first` of the picture.
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
pub(super) fn hides<W: Wide>(cover: &mut Cover<'_>, columns: [i32; 2], rows: [i32; 2], near: f32) -> bool {
    cover.hides::<W>(columns, rows, near)
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
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, borders: [W::Columns; 2]);
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
            ink.tiles::<W>(row, there, [lo, hi]);
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
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, borders: [W::Columns; 2]) {
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
    fn tiles<W: Wide>(&mut self, row: i32, there: u32, [lo, hi]: [W::Columns; 2]) {
        let (lo, hi) = (lo.store(), hi.store());
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

/// The first columns of eight rows of a tile, and those after the last.
const ENDS: [f32; WIDE] = {
    let mut ends = [0.0; WIDE];
    let mut i = ROWS;
    while i < WIDE {
        ends[i] = WIDE as f32;
        i += 1;
    }
    ends
};

/// Rows of a tile for which ramps are made ready.
const RAMPS: u32 = 4;

/// Draws a triangle in those rows of one row of tiles that are `there`, row i after `row` as bit i, between their borders.
#[inline(always)]
fn draw_tiles<W: Wide, T: Tint>(
    cover: &mut Cover<'_>,
    row: i32,
    there: u32,
    [lo, hi]: [W::Columns; 2],
    deep: &Deep,
    tint: &T,
) {
    let borders = [lo.held(there, i32::MAX), hi.held(there, 0)];
    // The columns of any row, and those of all.
    let (left, right) = (borders[0].least(), borders[1].most());
    let (inner_left, inner_right) = (borders[0].most(), borders[1].least());
    let (width, blocks) = (cover.width, Cover::blocks(cover.width));
    let below = (row - cover.top) as usize;
    let (tiles, above) = (below / ROWS * blocks, below % ROWS);
    let start = deep.near[1] * f64::from(row) + deep.near[2];
    // Where in a tile it is nearest.
    let ahead = deep.near[0].max(0.0) * (WIDE - 1) as f64 + deep.near[1].max(0.0) * (ROWS - 1) as f64;
    // From the first row of the tile on.
    let before = deep.near[1] * above as f64;
    let slopes = [deep.near[0] as f32, deep.near[1] as f32];
    let of = [left as usize / WIDE, (right as usize).div_ceil(WIDE)];
    // Most rows of tiles show nothing of what is drawn late: what takes time comes after.
    let mut from = of[0];
    loop {
        let Some(tile) = cover.tiles[tiles..].get(from).filter(|_| from < of[1]) else { return };
        let corner = deep.near[0] * (from * WIDE) as f64 + start;
        let nearest = (corner + ahead).min(deep.nearest) as f32;
        if !tile.hides(nearest, [slopes[0], slopes[1], (corner - before) as f32]) {
            break;
        }
        from += 1;
    }
    cover.drawn[below / ROWS] = true;
    let behind = deep.near[0].min(0.0) * (WIDE - 1) as f64 + deep.near[1].min(0.0) * (ROWS - 1) as f64;
    let step = W::splat(slopes[0]);
    let rows = tint.rows(row as f32);
    let wide = [W::load(&rows[0]), W::load(&rows[1])];
    let outer = [[rows[0][0], rows[1][0]], [rows[0][ROWS - 1], rows[1][ROWS - 1]]];
    let ends = W::load(&ENDS);
    let is_even = tint.is_even(outer, [(from * WIDE) as f32, (of[1] * WIDE) as f32]);
    for block in from..of[1] {
        let (first, at) = (block * WIDE, tiles + block);
        let corner = deep.near[0] * first as f64 + start;
        let tile = &mut cover.tiles[at];
        let nearest = (corner + ahead).min(deep.nearest) as f32;
        let plane = [slopes[0], slopes[1], (corner - before) as f32];
        if tile.hides(nearest, plane) {
            continue;
        }
        let columns = W::splat(first as f32).add(W::count());
        let fills = inner_left <= first as i32 && inner_right >= (first + WIDE) as i32;
        let is_free = tile.is_free();
        if fills && is_free {
            cover.lay(at, [deep.near[0], deep.near[1], corner], corner + behind);
            let lines = cover.pixels[below * width..].chunks_mut(width).take(ROWS);
            if is_even {
                let levels = tint.levels::<W>(wide, W::splat(first as f32).add(ends));
                for (i, line) in lines.enumerate() {
                    put::<W>(line, block, W::ramp(&levels, i, ROWS + i), ALL);
                }
            } else {
                for (i, line) in lines.enumerate() {
                    put::<W>(line, block, tint.pixels([rows[0][i], rows[1][i]], columns), ALL);
                }
            }
            continue;
        }
        tile.draw(plane, fills.then_some((corner + behind) as f32));
        let (tile, known, pixels) = cover.parts::<W>(at);
        let (masks, mut rest) = borders[0].up_to(borders[1], first as i32);
        let starts = starts([deep.near[0], deep.near[1], corner]);
        // To make ramps ready takes as long as a few rows without.
        let is_even = is_even && rest.count_ones() >= RAMPS;
        let levels = if is_even {
            tint.levels::<W>(wide, W::splat(first as f32).add(ends))
        } else {
            Levels { red_blue: [0; WIDE], green: [0; WIDE] }
        };
        // No branches but these: what a row of a triangle's edge does cannot be guessed.
        while rest != 0 {
            let i = rest.trailing_zeros() as usize % ROWS;
            rest &= rest - 1;
            let in_tile = (above + i) % ROWS;
            let near = W::count().mul_add(step, W::splat(starts[i]));
            let (mut mask, known, shown) = (masks[i], &mut known[in_tile], &mut tile.shown[in_tile]);
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
            let words = if is_even {
                W::ramp(&levels, i, ROWS + i)
            } else {
                tint.pixels([rows[0][i], rows[1][i]], columns)
            };
            put_some::<W>(line, block, words, mask);
        }
    }
}
