//! What is seen through: triangles of glass as layers over what is behind them, mixed once that is known.
//!
//! A layer hides nothing from the beams. Of each block of sixteen pixels of a row the layers are listed that lie over it; when a band is done, they are
//! mixed from near to far, as the rays of [`render`](crate::render::render) would meet them.

use std::cmp::Ordering;

use super::cover::Cover;
use super::kernels::{Deep, put};
use super::wide::{ALL, ROWS, WIDE, Wide};
use crate::format::records::MaterialRecord;
use crate::render::passage;
use crate::trace::NONE;

/// What a material lets pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pane {
    /// What it adds itself where it faces the lamp: the squares of red, green and blue, at most 255 each, times the share that it covers.
    own: [f32; 3],
    /// The share of each colour that passes.
    clear: [f32; 3],
}

impl Pane {
    /// Of a material that has this colour where it faces the lamp, if light passes it.
    pub(super) fn new(look: &MaterialRecord, color: [f32; 3]) -> Option<Pane> {
        let (cover, clear) = passage(look);
        (clear != [0.0; 3]).then(|| Pane { own: color.map(|c| cover * c * c), clear })
    }
}

/// Light that has come through some layers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Passed {
    /// From them, as squares of what a byte of the picture holds.
    sum: [f32; 3],
    /// The share of each colour that passes them all.
    through: [f32; 3],
}

impl Passed {
    /// Through none.
    pub(super) const ALL: Passed = Passed { sum: [0.0; 3], through: [1.0; 3] };

    /// Through one more, which the ray meets at an angle to its normal of this cosine.
    pub(super) fn pass(&mut self, pane: &Pane, cosine: f32) {
        for c in 0..3 {
            self.sum[c] += self.through[c] * pane.own[c] * cosine;
            self.through[c] *= pane.clear[c];
        }
    }

    /// The pixel where behind all of them is this one.
    pub(super) fn over(&self, behind: u32) -> u32 {
        let mut mixed = behind & OPAQUE;
        for c in 0..3 {
            let byte = (behind >> (8 * c) & 0xff) as f32;
            let root = (self.sum[c] + self.through[c] * byte * byte).sqrt();
            mixed |= ((root + 0.5).min(255.0) as u32) << (8 * c);
        }
        mixed
    }
}

/// What is not red, green or blue.
const OPAQUE: u32 = 0xff00_0000;

/// A triangle that is seen through.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layer {
    triangle: u32,
    /// How its `1 / t` grows with the column.
    slope: f32,
    /// How its distance grows along the ray through a pixel, as of a [`Shading`](super::shade::Shading).
    grows: [f32; 3],
    pane: Pane,
}

impl Layer {
    pub(super) fn new(triangle: u32, deep: &Deep, grows: [f32; 3], pane: Pane) -> Layer {
        Layer { triangle, slope: deep.near[0] as f32, grows, pane }
    }
}

/// A layer over some pixels of a block.
#[derive(Clone, Copy, Debug)]
struct Piece {
    layer: u32,
    /// The next of the block, or [`NONE`].
    next: u32,
    /// Its `1 / t` in the first pixel.
    near: f32,
    /// Pixel i as bit i.
    mask: u32,
}

/// The layers of a block, in the mean of a band, and of one block, that are kept; where there are more, rays tell the band's pixels under glass.
const MOST: usize = 64;
const MOST_OF_ONE: usize = 512;

/// The layers of a band of rows.
pub(crate) struct Layers {
    layers: Vec<Layer>,
    pieces: Vec<Piece>,
    /// Of each block of a row the first piece, or [`NONE`].
    firsts: Vec<u32>,
    /// The blocks that have any.
    under: Vec<u32>,
    /// There are more than are kept.
    is_full: bool,
    /// The pieces of a block from near to far.
    order: Vec<Ordered>,
}

/// A piece of a block.
#[derive(Clone, Copy, Debug)]
struct Ordered {
    layer: u32,
    triangle: u32,
    mask: u32,
    near: f32,
    slope: f32,
}

impl Ordered {
    /// How near it is at a pixel of the block.
    fn at(&self, pixel: u32) -> f32 {
        self.near + self.slope * pixel as f32
    }

    /// The nearer first at a pixel of the block.
    fn compare(&self, other: &Ordered, pixel: u32) -> Ordering {
        other.at(pixel).total_cmp(&self.at(pixel)).then(self.triangle.cmp(&other.triangle))
    }

    /// Whether it is before another wherever both are, or on it.
    fn is_before(&self, other: &Ordered) -> bool {
        /// What f32 may round.
        const NEARER: f32 = 1.0 + 4e-7;
        let both = self.mask & other.mask;
        both == 0
            || [both.trailing_zeros(), both.ilog2()].into_iter().all(|i| self.at(i) * NEARER >= other.at(i))
    }
}

impl Layers {
    /// None.
    pub(crate) fn new() -> Layers {
        let (layers, pieces, firsts, under, order) = Default::default();
        Layers { layers, pieces, firsts, under, order, is_full: false }
    }

    /// As many blocks as rows have.
    pub(super) fn resize(&mut self, cover: &Cover<'_>) {
        // All that were in use are free again.
        self.firsts.resize(cover.height * Cover::blocks(cover.width), NONE);
    }

    /// A triangle, of which pieces come now.
    #[inline(always)]
    pub(super) fn begin(&mut self, layer: Layer) {
        // The last had no pieces, perhaps.
        if self.pieces.last().is_none_or(|piece| (piece.layer as usize + 1) < self.layers.len()) {
            self.layers.pop();
        }
        self.layers.push(layer);
    }

    /// The last triangle over pixels of a block, in the first of which it is so near: once each, though it may come again with another cell.
    #[inline(always)]
    pub(super) fn add(&mut self, block: usize, near: f32, mut mask: u32) {
        let layer = self.layers.len() as u32 - 1;
        let triangle = self.layers[layer as usize].triangle;
        let first = self.firsts[block];
        if self.is_full && first != NONE {
            return;
        }
        let (mut next, mut count) = (first, 0);
        while next != NONE {
            let piece = &self.pieces[next as usize];
            if self.layers[piece.layer as usize].triangle == triangle {
                mask &= !piece.mask;
            }
            next = piece.next;
            count += 1;
        }
        self.is_full |= self.pieces.len() >= MOST * self.firsts.len() || count >= MOST_OF_ONE;
        if first == NONE {
            // Also where there are too many: that there is glass must be known.
            self.under.push(block as u32);
        } else if self.is_full || mask == 0 {
            return;
        }
        self.firsts[block] = self.pieces.len() as u32;
        self.pieces.push(Piece { layer, next: first, near, mask });
    }

    /// Mixes all layers into the pixels behind them, and forgets them. The square of the rays' size is as [`square`](super::shade::square) has it;
    /// parts of rows that rays must tell are added to `unsure`.
    #[inline(always)]
    pub(super) fn melt<W: Wide>(
        &mut self,
        cover: &mut Cover<'_>,
        square: &[f32; 5],
        unsure: &mut Vec<[i32; 3]>,
    ) {
        let (width, blocks) = (cover.width, Cover::blocks(cover.width));
        let under = std::mem::take(&mut self.under);
        for &at in &under {
            let at = at as usize;
            let (below, first) = (at / blocks, at % blocks * WIDE);
            let mut next = std::mem::replace(&mut self.firsts[at], NONE);
            let end = width.min(first + WIDE);
            if self.is_full {
                unsure.push([cover.top + below as i32, first as i32, end as i32]);
                continue;
            }
            self.order.clear();
            let shown = cover.shown(below, at % blocks);
            let known = cover.near::<W>(below / ROWS * blocks + at % blocks)[below % ROWS];
            let mut near = [0.0; WIDE];
            W::load(&known).put(shown, &mut near);
            let known = W::load(&near);
            while next != NONE {
                let piece = &self.pieces[next as usize];
                let layer = &self.layers[piece.layer as usize];
                let Piece { layer: of, near, mask, .. } = *piece;
                let Layer { triangle, slope, .. } = *layer;
                self.order.push(Ordered { layer: of, triangle, mask, near, slope });
                next = piece.next;
            }
            let middle = (WIDE / 2) as u32;
            self.order.sort_unstable_by(|a, b| a.compare(b, middle));
            let rays = BlockRays::<W>::new(below as f32 + cover.top as f32, first, square);
            let (line, block) = (&mut cover.pixels[below * width..][..width], at % blocks);
            if self.is_order_everywhere() {
                self.mix(line, block, &rays, known, ALL);
                continue;
            }
            // Which is nearer changes within the block: as many pixels at a time as have the same order.
            let mut pixel = 0;
            while pixel < WIDE as u32 {
                self.order.sort_unstable_by(|a, b| a.compare(b, pixel));
                let from = pixel;
                pixel += 1;
                while pixel < WIDE as u32 && self.is_order_at(pixel) {
                    pixel += 1;
                }
                let of = (ALL << from) & ALL & (ALL >> (WIDE as u32 - pixel));
                self.mix(line, block, &rays, known, of);
            }
        }
        self.under = under;
        self.under.clear();
        self.layers.clear();
        self.pieces.clear();
        self.is_full = false;
    }

    /// Whether of each two pieces that of the less place in their order is the nearer wherever both are.
    fn is_order_everywhere(&self) -> bool {
        let order = &self.order;
        (0..order.len()).all(|i| order[i + 1..].iter().all(|other| order[i].is_before(other)))
    }

    /// Whether those pieces that are over a pixel are in their order, from near to far.
    fn is_order_at(&self, pixel: u32) -> bool {
        let over = self.order.iter().filter(|piece| piece.mask >> pixel & 1 != 0);
        over.map(|piece| -piece.at(pixel)).is_sorted()
    }

    /// Mixes the layers in their order into some of the pixels of a block: where they are nearer than what these show.
    #[inline(always)]
    fn mix<W: Wide>(&self, line: &mut [u32], block: usize, rays: &BlockRays<W>, known: W, of: u32) {
        let (mut sum, mut through, mut any) = ([[0.0; WIDE]; 3], [[1.0; WIDE]; 3], 0);
        for piece in &self.order {
            let Layer { slope, grows, pane, .. } = &self.layers[piece.layer as usize];
            let near = W::count().mul_add(W::splat(*slope), W::splat(piece.near));
            let mask = piece.mask & of & near.greater(known);
            any |= mask;
            let grown = W::splat(grows[1] * rays.row + grows[2]);
            let cosine = rays.columns.mul_add(W::splat(grows[0]), grown).abs().mul(rays.inverse_size);
            for c in 0..3 {
                let (all, passing) = (W::load(&sum[c]), W::load(&through[c]));
                passing.mul(cosine).mul_add(W::splat(pane.own[c]), all).put(mask, &mut sum[c]);
                passing.mul(W::splat(pane.clear[c])).put(mask, &mut through[c]);
            }
        }
        let from = block * WIDE;
        let end = line.len().min(from + WIDE);
        let mut bytes = [[0.0; WIDE]; 3];
        for (i, pixel) in line[from..end].iter().enumerate() {
            for c in 0..3 {
                bytes[c][i] = (pixel >> (8 * c) & 0xff) as f32;
            }
        }
        // No closures where lanes are worked with.
        let red = mixed::<W>(&sum[0], &through[0], &bytes[0]);
        let green = mixed::<W>(&sum[1], &through[1], &bytes[1]);
        let blue = mixed::<W>(&sum[2], &through[2], &bytes[2]);
        put::<W>(line, block, W::bytes(red, green, blue), any);
    }
}

/// The rays of a block of pixels.
struct BlockRays<W> {
    row: f32,
    columns: W,
    inverse_size: W,
}

impl<W: Wide> BlockRays<W> {
    /// Those of the pixels from a column on. The square of their size is as [`square`](super::shade::square) has it.
    #[inline(always)]
    fn new(row: f32, first: usize, square: &[f32; 5]) -> BlockRays<W> {
        let columns = W::splat(first as f32).add(W::count());
        let size = columns.mul_add(W::splat(square[4]), W::splat(square[1]));
        let size = size.mul_add(columns, W::splat((square[3] * row + square[2]) * row + square[0]));
        BlockRays { row, columns, inverse_size: size.inverse_root() }
    }
}

/// What layers and what comes through them are together, from 0 to 255.
#[inline(always)]
fn mixed<W: Wide>(sum: &[f32; WIDE], through: &[f32; WIDE], byte: &[f32; WIDE]) -> W {
    /// Its root is nothing that could be seen, and can be divided by.
    const DARK: f32 = 1e-6;
    let byte = W::load(byte);
    let square = byte.mul(byte).mul_add(W::load(through), W::load(sum)).add(W::splat(DARK));
    square.mul(square.inverse_root())
}
