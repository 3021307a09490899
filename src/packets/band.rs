//! From packets to pixels.
//!
//! A packet is a rectangle of pixels. Where its four corners are on one side of a line, all of it is; else it is split, and its parts go on from
//! that line. The smallest packets are not split any more: which of their pixels are on which side is one bit a pixel.

use super::PacketCounts;
use super::shot::{Shot, Show};
use super::tree::{Node, Tree};
use crate::beam::SKY_COLOR;
use crate::beam::detail::Detail;
use crate::beam::kernels::{Flat, Tint};
use crate::beam::shade::{SKY, SOURCE, UNSURE};
use crate::beam::wide::{WIDE, Wide};

/// The edge of the packets that a picture is cut into at first, pixels.
pub(super) const LARGEST: i32 = 64;

/// Rows of a packet that is not split any more; it has [`WIDE`] columns.
const LEAF_ROWS: usize = 4;

/// Packets that come through more cells end in doubt: only files made to be slow do that.
const MOST_CELLS: u32 = 1 << 12;

/// A rectangle of pixels whose rays have come to one place of the tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    /// First column and row.
    from: [i32; 2],
    /// The column and the row after the last.
    to: [i32; 2],
    node: u32,
    /// How many cells they came through.
    cells: u32,
}

impl Packet {
    fn size(&self) -> [i32; 2] {
        [self.to[0] - self.from[0], self.to[1] - self.from[1]]
    }

    fn pixels(&self) -> u64 {
        let [columns, rows] = self.size();
        columns as u64 * rows as u64
    }

    fn is_leaf(&self) -> bool {
        let [columns, rows] = self.size();
        columns <= WIDE as i32 && rows <= LEAF_ROWS as i32
    }
}

/// Lot rows of a picture being made.
pub(crate) struct Band<'a, 's> {
    pub(super) shot: &'a Shot<'s>,
    pub(super) tree: &'a mut Tree,
    pub(super) detail: Detail<'a>,
    pub(super) pixels: &'a mut [u32],
    /// The first row.
    pub(super) top: i32,
    /// Where rays start in the tree.
    pub(super) root: u32,
    pub(super) stack: &'a mut Vec<Packet>,
    /// Parts of rows that rays must tell: the row, and from where up to where.
    pub(super) unsure: &'a mut Vec<[i32; 3]>,
    pub(super) counts: PacketCounts,
}

/// Lot pixels of a leaf, pixel i of row j as bit `16 j + i`, that have come to one place of the tree.
#[derive(Clone, Copy)]
struct Lot {
    bits: u64,
    node: u32,
    cells: u32,
}

impl Band<'_, '_> {
    /// Makes all pixels.
    #[inline(always)]
    pub(crate) fn run<W: Wide>(&mut self) {
        let width = self.shot.width as i32;
        let end = self.top + (self.pixels.len() / width as usize) as i32;
        for y in (self.top..end).step_by(LARGEST as usize) {
            for x in (0..width).step_by(LARGEST as usize) {
                let to = [(x + LARGEST).min(width), (y + LARGEST).min(end)];
                self.stack.push(Packet { from: [x, y], to, node: self.root, cells: 0 });
                while let Some(packet) = self.stack.pop() {
                    self.follow::<W>(packet);
                }
            }
        }
    }

    /// Follows a packet as far as it stays whole.
    #[inline(always)]
    fn follow<W: Wide>(&mut self, mut packet: Packet) {
        self.counts.packets += 1;
        let middle = |axis: usize| f64::from(packet.from[axis] + packet.to[axis] - 1) * 0.5;
        let half = |axis: usize| f64::from(packet.to[axis] - 1 - packet.from[axis]) * 0.5;
        let ([x, y], [half_x, half_y]) = ([middle(0), middle(1)], [half(0), half(1)]);
        loop {
            match self.tree.nodes[packet.node as usize] {
                Node::Line { line: [u, v, w], sides } => {
                    let value = u * x + v * y + w;
                    let reach = [u.abs() * half_x, v.abs() * half_y];
                    if value >= reach[0] + reach[1] {
                        packet.node = sides[0];
                    } else if value < -reach[0] - reach[1] {
                        packet.node = sides[1];
                    } else if packet.is_leaf() {
                        return self.leaf::<W>(&packet);
                    } else {
                        return self.split(&packet, reach);
                    }
                }
                Node::Cell { next } => {
                    packet.node = next;
                    packet.cells += 1;
                    self.counts.cells += 1;
                    if packet.cells > MOST_CELLS {
                        return self.doubt::<W>(&packet);
                    }
                }
                Node::Detail { root, next } => {
                    let [columns, rows] = [0, 1].map(|axis| [packet.from[axis], packet.to[axis]]);
                    if !self.detail.reaches(columns, rows, root) {
                        packet.node = next;
                    } else if packet.is_leaf() {
                        return self.doubt::<W>(&packet);
                    } else {
                        return self.split(&packet, [1.0; 2]);
                    }
                }
                Node::Unknown(_) | Node::Part { .. } => self.tree.grow(self.shot, packet.node),
                Node::Face(face) => return self.face::<W>(&packet, face),
                Node::Sky => return self.sky::<W>(&packet),
                Node::Unsure => return self.doubt::<W>(&packet),
            }
        }
    }

    /// Splits a packet whose corners are on two sides of a line, which in half its width and height grows by `reach`.
    fn split(&mut self, packet: &Packet, reach: [f64; 2]) {
        self.counts.splits += 1;
        let size = packet.size();
        let grain = [WIDE as i32, LEAF_ROWS as i32];
        let may = [0, 1].map(|axis| size[axis] > grain[axis]);
        let must = [may[0] && (!may[1] || reach[0] * 2.0 >= reach[1]), may[1] && (!may[0] || reach[1] * 2.0 >= reach[0])];
        let middle = |axis: usize| {
            let half = (size[axis] / 2 + grain[axis] - 1) / grain[axis] * grain[axis];
            packet.from[axis] + half
        };
        let mut push = |from: [i32; 2], to: [i32; 2]| self.stack.push(Packet { from, to, ..*packet });
        let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
        match must {
            [true, true] => {
                let (x, y) = (middle(0), middle(1));
                push([x, y], [x1, y1]);
                push([x0, y], [x, y1]);
                push([x, y0], [x1, y]);
                push([x0, y0], [x, y]);
            }
            [true, false] => {
                let x = middle(0);
                push([x, y0], [x1, y1]);
                push([x0, y0], [x, y1]);
            }
            _ => {
                let y = middle(1);
                push([x0, y], [x1, y1]);
                push([x0, y0], [x1, y]);
            }
        }
    }

    /// Tells pixel by pixel what a packet that is split no more shows.
    #[inline(always)]
    fn leaf<W: Wide>(&mut self, packet: &Packet) {
        self.counts.leaves += 1;
        let [columns, rows] = packet.size();
        let row = u64::MAX >> (64 - columns as u32);
        let bits = (0..rows).fold(0, |bits, j| bits | row << (WIDE as i32 * j));
        // Each has a pixel that no other has.
        let mut stack = [Lot { bits: 0, node: 0, cells: 0 }; WIDE * LEAF_ROWS];
        stack[0] = Lot { bits, node: packet.node, cells: packet.cells };
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let mut some = stack[count];
            loop {
                match self.tree.nodes[some.node as usize] {
                    Node::Line { line, sides } => {
                        let below = below::<W>(packet.from, line);
                        let both = [some.bits & !below, some.bits & below];
                        if both[1] == 0 {
                            some.node = sides[0];
                        } else if both[0] == 0 {
                            some.node = sides[1];
                        } else {
                            stack[count] = Lot { bits: both[1], node: sides[1], ..some };
                            count += 1;
                            some = Lot { bits: both[0], node: sides[0], ..some };
                        }
                        continue;
                    }
                    Node::Cell { next } => {
                        some.node = next;
                        some.cells += 1;
                        self.counts.cells += 1;
                        if some.cells <= MOST_CELLS {
                            continue;
                        }
                        self.doubt_some::<W>(packet, some.bits);
                    }
                    Node::Detail { root, next } => {
                        let [columns, rows] = [0, 1].map(|axis| [packet.from[axis], packet.to[axis]]);
                        if !self.detail.reaches(columns, rows, root) {
                            some.node = next;
                            continue;
                        }
                        self.doubt_some::<W>(packet, some.bits);
                    }
                    Node::Unknown(_) | Node::Part { .. } => {
                        self.tree.grow(self.shot, some.node);
                        continue;
                    }
                    Node::Face(face) => {
                        let face = &self.tree.faces[face as usize];
                        self.counts.apart += u64::from(some.bits.count_ones());
                        let mut canvas = Canvas { pixels: self.pixels, top: self.top, width: self.shot.width };
                        match self.shot.show {
                            Show::Light => canvas.some::<W>(packet.from, some.bits, &face.shading),
                            Show::Surfaces => {
                                canvas.some::<W>(packet.from, some.bits, &Flat(SOURCE | face.source));
                            }
                            Show::Sizes => canvas.some::<W>(packet.from, some.bits, &Flat(1)),
                        }
                    }
                    Node::Sky => {
                        self.counts.apart += u64::from(some.bits.count_ones());
                        let tint = Flat(self.flat(SKY_COLOR, SKY, 1));
                        self.some::<W>(packet, some.bits, &tint);
                    }
                    Node::Unsure => self.doubt_some::<W>(packet, some.bits),
                }
                break;
            }
        }
    }

    /// What a pixel becomes that is the same everywhere.
    fn flat(&self, light: u32, surface: u32, size: u32) -> u32 {
        match self.shot.show {
            Show::Light => light,
            Show::Surfaces => surface,
            Show::Sizes => size,
        }
    }

    #[inline(always)]
    fn face<W: Wide>(&mut self, packet: &Packet, face: u32) {
        let face = &self.tree.faces[face as usize];
        self.counts.whole += packet.pixels();
        let mut canvas = Canvas { pixels: self.pixels, top: self.top, width: self.shot.width };
        match self.shot.show {
            Show::Light => canvas.all::<W>(packet, &face.shading),
            Show::Surfaces => canvas.all::<W>(packet, &Flat(SOURCE | face.source)),
            Show::Sizes => canvas.all::<W>(packet, &Flat(edge(packet))),
        }
    }

    #[inline(always)]
    fn sky<W: Wide>(&mut self, packet: &Packet) {
        self.counts.whole += packet.pixels();
        let tint = Flat(self.flat(SKY_COLOR, SKY, edge(packet)));
        let mut canvas = Canvas { pixels: self.pixels, top: self.top, width: self.shot.width };
        canvas.all::<W>(packet, &tint);
    }

    #[inline(always)]
    fn some<W: Wide>(&mut self, packet: &Packet, bits: u64, tint: &impl Tint) {
        let mut canvas = Canvas { pixels: self.pixels, top: self.top, width: self.shot.width };
        canvas.some::<W>(packet.from, bits, tint);
    }

    /// Leaves a packet to rays.
    #[inline(always)]
    fn doubt<W: Wide>(&mut self, packet: &Packet) {
        self.counts.rays += packet.pixels();
        let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
        self.unsure.extend((y0..y1).map(|row| [row, x0, x1]));
        if self.shot.show != Show::Light {
            let tint = Flat(self.flat(0, UNSURE, 0));
            let mut canvas = Canvas { pixels: self.pixels, top: self.top, width: self.shot.width };
            canvas.all::<W>(packet, &tint);
        }
    }

    /// Leaves pixels of a leaf to rays.
    #[inline(always)]
    fn doubt_some<W: Wide>(&mut self, packet: &Packet, bits: u64) {
        self.counts.rays += u64::from(bits.count_ones());
        let [x0, y0] = packet.from;
        for j in 0..LEAF_ROWS as i32 {
            let mut row = bits >> (WIDE as i32 * j) & 0xffff;
            while row != 0 {
                let from = row.trailing_zeros() as i32;
                let count = (row >> from).trailing_ones() as i32;
                self.unsure.push([y0 + j, x0 + from, x0 + from + count]);
                row &= !(((1 << count) - 1) << from);
            }
        }
        if self.shot.show != Show::Light {
            let tint = Flat(self.flat(0, UNSURE, 0));
            self.some::<W>(packet, bits, &tint);
        }
    }
}

/// The longer edge of a packet, pixels.
fn edge(packet: &Packet) -> u32 {
    let [columns, rows] = packet.size();
    columns.max(rows) as u32
}

/// Which of the pixels of a leaf that starts at `from` are where a line is less than 0. The same bits by every kernel.
#[inline(always)]
fn below<W: Wide>(from: [i32; 2], [u, v, w]: [f64; 3]) -> u64 {
    // The first pixel's in f64: what f32 then adds is small.
    let first = u * f64::from(from[0]) + v * f64::from(from[1]) + w;
    let along = W::count().mul(W::splat(u as f32));
    let mut bits = 0;
    for j in 0..LEAF_ROWS {
        let value = along.add(W::splat((first + v * j as f64) as f32));
        bits |= u64::from(W::splat(0.0).greater(value)) << (WIDE * j);
    }
    bits
}

/// The pixels of a band.
struct Canvas<'a> {
    pixels: &'a mut [u32],
    top: i32,
    width: u32,
}

impl Canvas<'_> {
    #[inline(always)]
    fn at(&self, column: i32, row: i32) -> usize {
        (row - self.top) as usize * self.width as usize + column as usize
    }

    /// Fills a packet.
    #[inline(always)]
    fn all<W: Wide>(&mut self, packet: &Packet, tint: &impl Tint) {
        let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
        let first = W::splat(x0 as f32).add(W::count());
        let step = W::splat(WIDE as f32);
        for row in y0..y1 {
            let (from, to) = (self.at(x0, row), self.at(x1, row));
            let (whole, rest) = self.pixels[from..to].as_chunks_mut::<WIDE>();
            let same = tint.row(row as f32);
            let mut columns = first;
            for block in whole {
                W::put_all(tint.pixels(same, columns), block);
                columns = columns.add(step);
            }
            if !rest.is_empty() {
                let mut block = [0; WIDE];
                W::put_all(tint.pixels(same, columns), &mut block);
                rest.copy_from_slice(&block[..rest.len()]);
            }
        }
    }

    /// Fills some pixels of a leaf that starts at `from`.
    #[inline(always)]
    fn some<W: Wide>(&mut self, from: [i32; 2], bits: u64, tint: &impl Tint) {
        let columns = W::splat(from[0] as f32).add(W::count());
        for j in 0..LEAF_ROWS {
            let mask = (bits >> (WIDE * j)) as u32 & 0xffff;
            if mask == 0 {
                continue;
            }
            let row = from[1] + j as i32;
            let words = tint.pixels(tint.row(row as f32), columns);
            let rest = self.at(from[0], row)..;
            let rest = &mut self.pixels[rest];
            if let Some(block) = rest.first_chunk_mut::<WIDE>() {
                W::put_words(words, mask, block);
            } else {
                let mut block = [0; WIDE];
                W::put_all(words, &mut block);
                for (i, pixel) in rest.iter_mut().enumerate() {
                    if mask >> i & 1 != 0 {
                        *pixel = block[i];
                    }
                }
            }
        }
    }
}
