//! From packets to pixels.
//!
//! A packet is a rectangle of pixels. Where its four corners are on one side of a line, all of it is; else it is split, and its parts go on from
//! that line. The smallest packets are not split any more: which of their pixels are on which side is one bit a pixel.

use super::PacketCounts;
use super::shot::{Shot, Show};
use super::tree::{Node, Tree};
use super::waiting::Waiting;
use crate::beam::SKY_COLOR;
use crate::beam::cover::Cover;
use crate::beam::cut::Exits;
use crate::beam::kernels::{Flat, Tint, put};
use crate::beam::rows::{Arena, Region};
use crate::beam::shade::{Canvas, SKY, SOURCE};
use crate::beam::walk::{AROUND, Paint, Seen, Triangles};
use crate::beam::wide::{ALL, WIDE, Wide};
use crate::trace::NONE;

/// The edge of the packets that a picture is cut into at first, pixels.
pub(super) const LARGEST: i32 = 128;

/// Rows of a packet that is not split any more; it has no more than [`WIDE`] columns.
const ROWS: usize = 4;

/// Columns and rows of a packet that is not split any more.
const GRAIN: [i32; 2] = [WIDE as i32, ROWS as i32];

/// Packets that come through more cells end in doubt: only files made to be slow do that.
const MOST_CELLS: u32 = 1 << 12;

/// A rectangle of pixels whose rays have come to one place of the tree. It starts at a multiple of [`WIDE`] columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packet {
    /// First column and row.
    from: [i32; 2],
    /// The column and the row after the last.
    to: [i32; 2],
    way: Way,
}

/// A place of the tree, and how rays came there.
#[derive(Clone, Copy, Debug)]
struct Way {
    node: u32,
    /// The cell before this one; or none.
    before: u32,
    /// How many cells they came through.
    cells: u32,
}

impl Way {
    /// Goes from a cell into another; whether that leads on. Into the cell that they came from it does not, nor without end.
    #[inline(always)]
    fn enter(&mut self, from: u32, to: u32, next: u32) -> bool {
        let leads_on = to != self.before && self.cells < MOST_CELLS;
        *self = Way { node: next, before: from, cells: self.cells + 1 };
        leads_on
    }
}

/// Some pixels of a packet that is split no more, pixel i of row j as bit `16 j + i`, that have come to one place of the tree.
#[derive(Clone, Copy)]
struct Lot {
    bits: u64,
    way: Way,
}

impl Packet {
    fn size(&self) -> [i32; 2] {
        [self.to[0] - self.from[0], self.to[1] - self.from[1]]
    }

    fn pixels(&self) -> u64 {
        let [columns, rows] = self.size();
        columns as u64 * rows as u64
    }

    /// The longer edge, pixels.
    fn edge(&self) -> u32 {
        let [columns, rows] = self.size();
        columns.max(rows) as u32
    }

    fn is_leaf(&self) -> bool {
        let [columns, rows] = self.size();
        columns <= GRAIN[0] && rows <= GRAIN[1]
    }

    /// All pixels of one that is split no more.
    fn bits(&self) -> u64 {
        let [columns, rows] = self.size();
        let row = u64::MAX >> (64 - columns as u32);
        (0..rows).fold(0, |bits, j| bits | row << (WIDE as i32 * j))
    }
}

/// Some rows of a picture being made.
pub(crate) struct Band<'a, 's, 'd> {
    pub(super) shot: &'a Shot<'s>,
    pub(super) tree: &'a mut Tree,
    pub(super) canvas: Canvas<'a, 'd>,
    pub(super) arena: &'a mut Arena,
    pub(super) waiting: &'a mut Waiting,
    /// Where rays start in the tree.
    pub(super) root: u32,
    pub(super) stack: &'a mut Vec<Packet>,
    pub(super) counts: PacketCounts,
}

impl Band<'_, '_, '_> {
    /// Makes all pixels.
    #[inline(always)]
    pub(crate) fn run<W: Wide>(&mut self) {
        let (width, top) = (self.canvas.cover.width as i32, self.canvas.cover.top);
        let way = Way { node: self.root, before: NONE, cells: 0 };
        let end = top + self.canvas.cover.height as i32;
        for y in (top..end).step_by(LARGEST as usize) {
            for x in (0..width).step_by(LARGEST as usize) {
                let to = [(x + LARGEST).min(width), (y + LARGEST).min(end)];
                self.stack.push(Packet { from: [x, y], to, way });
                while let Some(packet) = self.stack.pop() {
                    self.follow::<W>(packet);
                }
            }
        }
        self.draw();
    }

    /// Follows a packet as far as it stays whole.
    #[inline(always)]
    fn follow<W: Wide>(&mut self, mut packet: Packet) {
        self.counts.packets += 1;
        let middle = |axis: usize| f64::from(packet.from[axis] + packet.to[axis] - 1) * 0.5;
        let half = |axis: usize| f64::from(packet.to[axis] - 1 - packet.from[axis]) * 0.5;
        let ([x, y], [half_x, half_y]) = ([middle(0), middle(1)], [half(0), half(1)]);
        loop {
            match self.tree.nodes[packet.way.node as usize] {
                Node::Line { line: [u, v, w], off, sides } => {
                    let value = u * x + v * y + w;
                    let reach = [u.abs() * half_x, v.abs() * half_y];
                    let most = reach[0] + reach[1] + self.tree.off_at(off, [x, y], [half_x, half_y]);
                    if value >= most {
                        packet.way.node = sides[0];
                    } else if value < -most {
                        packet.way.node = sides[1];
                    } else if packet.is_leaf() {
                        return self.leaf::<W>(&packet);
                    } else {
                        return self.split::<W>(&packet, reach, [-(v * y + w) / u, -(u * x + w) / v]);
                    }
                }
                Node::Cell { from, to, next } => {
                    self.counts.cells += 1;
                    if !packet.way.enter(from, to, next) {
                        return self.doubt(&packet, None);
                    }
                }
                Node::Detail { detail, next } => {
                    self.detail(&packet, None, detail);
                    packet.way.node = next;
                }
                Node::Unknown { .. } | Node::Part { .. } => self.tree.grow(self.shot, packet.way.node),
                Node::Face(face) => {
                    let face = &self.tree.faces[face as usize];
                    self.counts.whole += packet.pixels();
                    return match self.shot.show {
                        Show::Light => all::<W>(&mut self.canvas.cover, &packet, &face.shading),
                        Show::Surfaces => {
                            all::<W>(&mut self.canvas.cover, &packet, &Flat(SOURCE | face.source));
                        }
                        Show::Sizes => all::<W>(&mut self.canvas.cover, &packet, &Flat(packet.edge())),
                    };
                }
                Node::Rough(rough) if self.shot.show != Show::Sizes => {
                    return self.rough(&packet, None, rough);
                }
                Node::Sky | Node::Rough(_) => {
                    self.counts.whole += packet.pixels();
                    let tint = self.around(packet.edge());
                    return all::<W>(&mut self.canvas.cover, &packet, &tint);
                }
                Node::Unsure => return self.doubt(&packet, None),
            }
        }
    }

    /// Splits a packet whose corners are on two sides of a line, which in half its width and height grows by `reach`, and which crosses the packet's
    /// middle row and column at `at`. Where the line runs mostly along one axis, the packet is split in two, near it; else in four.
    #[inline(always)]
    fn split<W: Wide>(&mut self, packet: &Packet, reach: [f64; 2], at: [f64; 2]) {
        self.counts.splits += 1;
        let size = packet.size();
        let [wide, high] = [0, 1].map(|axis| size[axis] > GRAIN[axis]);
        if (!wide && reach[1] <= reach[0]) || (!high && reach[0] <= reach[1]) {
            // Lengthwise through a strip: few of its parts would be whole.
            return self.leaves::<W>(packet);
        }
        let across = wide && (!high || reach[0] * 2.0 >= reach[1]);
        let down = high && (!wide || reach[1] * 2.0 >= reach[0]);
        let cut = |axis: usize| {
            let (grain, from) = (GRAIN[axis], packet.from[axis]);
            if across && down {
                return from + (size[axis] / 2 + grain - 1) / grain * grain;
            }
            // No less than one grain from either end; what is no number is 0.
            let parts = ((at[axis] - f64::from(from)) / f64::from(grain)) as i32;
            from + parts.clamp(1, (size[axis] - 1) / grain) * grain
        };
        let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
        let (x, y) = (if across { cut(0) } else { x1 }, if down { cut(1) } else { y1 });
        let stack = &mut *self.stack;
        let mut push = |from: [i32; 2], to: [i32; 2]| stack.push(Packet { from, to, ..*packet });
        if across && down {
            push([x, y], [x1, y1]);
        }
        if down {
            push([x0, y], [x, y1]);
        }
        if across {
            push([x, y0], [x1, y]);
        }
        push([x0, y0], [x, y]);
    }

    /// Splits a packet at once into the smallest.
    #[inline(always)]
    fn leaves<W: Wide>(&mut self, packet: &Packet) {
        let (from, to) = (packet.from, packet.to);
        for y in (from[1]..to[1]).step_by(ROWS) {
            for x in (from[0]..to[0]).step_by(WIDE) {
                let to = [(x + GRAIN[0]).min(to[0]), (y + GRAIN[1]).min(to[1])];
                self.counts.packets += 1;
                self.leaf::<W>(&Packet { from: [x, y], to, ..*packet });
            }
        }
    }

    /// Tells pixel by pixel what a packet that is split no more shows.
    #[inline(always)]
    fn leaf<W: Wide>(&mut self, packet: &Packet) {
        self.counts.leaves += 1;
        // Each has a pixel that no other has.
        let mut stack = [Lot { bits: 0, way: packet.way }; WIDE * ROWS];
        stack[0] = Lot { bits: packet.bits(), way: packet.way };
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let mut lot = stack[count];
            loop {
                match self.tree.nodes[lot.way.node as usize] {
                    Node::Line { line, off, sides } => {
                        if let Some(&off) = self.tree.offs.get(off as usize) {
                            let near = lot.bits & near::<W>(packet.from, line, off);
                            self.edges(packet, near);
                        }
                        let below = below::<W>(packet.from, line);
                        let parts = [lot.bits & !below, lot.bits & below];
                        if parts[1] == 0 {
                            lot.way.node = sides[0];
                        } else if parts[0] == 0 {
                            lot.way.node = sides[1];
                        } else {
                            stack[count] = Lot { bits: parts[1], way: Way { node: sides[1], ..lot.way } };
                            count += 1;
                            lot = Lot { bits: parts[0], way: Way { node: sides[0], ..lot.way } };
                        }
                        continue;
                    }
                    Node::Cell { from, to, next } => {
                        self.counts.cells += 1;
                        if lot.way.enter(from, to, next) {
                            continue;
                        }
                        self.doubt(packet, Some(lot.bits));
                    }
                    Node::Detail { detail, next } => {
                        self.detail(packet, Some(lot.bits), detail);
                        lot.way.node = next;
                        continue;
                    }
                    Node::Unknown { .. } | Node::Part { .. } => {
                        self.tree.grow(self.shot, lot.way.node);
                        continue;
                    }
                    Node::Face(face) => {
                        let face = &self.tree.faces[face as usize];
                        self.counts.apart += u64::from(lot.bits.count_ones());
                        let cover = &mut self.canvas.cover;
                        match self.shot.show {
                            Show::Light => some::<W>(cover, packet.from, lot.bits, &face.shading),
                            Show::Surfaces => {
                                some::<W>(cover, packet.from, lot.bits, &Flat(SOURCE | face.source));
                            }
                            Show::Sizes => some::<W>(cover, packet.from, lot.bits, &Flat(1)),
                        }
                    }
                    Node::Rough(rough) if self.shot.show != Show::Sizes => {
                        self.rough(packet, Some(lot.bits), rough);
                    }
                    Node::Sky | Node::Rough(_) => {
                        self.counts.apart += u64::from(lot.bits.count_ones());
                        let tint = self.around(1);
                        some::<W>(&mut self.canvas.cover, packet.from, lot.bits, &tint);
                    }
                    Node::Unsure => self.doubt(packet, Some(lot.bits)),
                }
                break;
            }
        }
    }

    /// What pixels become that show what lies around; those of sizes this one.
    fn around(&self, size: u32) -> Flat {
        Flat(match self.shot.show {
            Show::Light => SKY_COLOR,
            Show::Surfaces => SKY,
            Show::Sizes => size,
        })
    }

    /// A packet, or some pixels of a leaf, as rows.
    fn region(&mut self, packet: &Packet, bits: Option<u64>) -> Region {
        let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
        let rows = 0..(y1 - y0) as usize;
        self.arena.begin_with([x0, x1], y0, rows.map(|j| part(packet, bits, j)))
    }

    /// Notes that a packet, or some pixels of a leaf, may show triangles of a cell. Sizes are those of what is behind them.
    #[inline(never)]
    fn detail(&mut self, packet: &Packet, bits: Option<u64>, detail: u32) {
        if self.shot.show == Show::Sizes {
            return;
        }
        let first = (packet.from[1] - self.canvas.cover.top) as usize;
        let area = self.waiting.area(detail);
        for j in 0..(packet.to[1] - packet.from[1]) as usize {
            area.add(first + j, part(packet, bits, j));
        }
    }

    /// Draws the triangles of all cells that packets came to.
    #[inline(never)]
    fn draw(&mut self) {
        let Band { shot, tree, canvas, arena, waiting, .. } = self;
        let top = canvas.cover.top;
        for area in waiting.all() {
            let within = &tree.details[area.detail as usize];
            let exits = Exits(&tree.exits[within.exits.clone()]);
            let triangles = match within.root {
                NONE => Triangles::Outer(shot.outer),
                // From outside all triangles there are.
                root if within.cell == AROUND && exits.0.is_empty() => Triangles::All(root),
                root => Triangles::Below(root),
            };
            area.draw(|first, parts| {
                let there = || parts.iter().filter(|part| part[0] < part[1]);
                let lo = there().map(|part| part[0]).min().unwrap_or(0);
                let hi = there().map(|part| part[1]).max().unwrap_or(0);
                let region = arena.begin_with([lo, hi], top + first as i32, parts.iter().copied());
                canvas.detail(arena, &region, (within.cell, triangles), exits);
            });
        }
    }

    /// Shows a rough face: its own triangles, and rays where they do not fill it.
    #[inline(never)]
    fn rough(&mut self, packet: &Packet, bits: Option<u64>, rough: u32) {
        let region = self.region(packet, bits);
        let rough = &self.tree.rough[rough as usize];
        let seen = Seen::Face { source: rough.source, plane: rough.plane, is_plain: false, cell: rough.cell };
        self.canvas.paint(self.arena, &region, &seen);
    }

    /// Notes pixels of a leaf that are so near to an edge that rays tell what they show.
    #[inline]
    fn edges(&mut self, packet: &Packet, mut bits: u64) {
        if self.shot.show == Show::Sizes {
            return;
        }
        while bits != 0 {
            let bit = bits.trailing_zeros() as i32;
            bits &= bits - 1;
            let [x, y] = [bit % WIDE as i32, bit / WIDE as i32];
            let column = packet.from[0] + x;
            self.canvas.edges.push([packet.from[1] + y, column, column + 1]);
        }
    }

    /// Leaves a packet, or some pixels of a leaf, to rays.
    #[inline(never)]
    fn doubt(&mut self, packet: &Packet, bits: Option<u64>) {
        let region = self.region(packet, bits);
        self.canvas.paint(self.arena, &region, &Seen::Unsure);
    }
}

/// From which column up to which a row of a packet, or of some pixels of a leaf, is.
#[inline(always)]
fn part(packet: &Packet, bits: Option<u64>, row: usize) -> [i32; 2] {
    let first = packet.from[0];
    match bits {
        None => [first, packet.to[0]],
        // A convex part: no pixel is missing between others.
        Some(bits) => {
            let bits = (bits >> (WIDE * row)) as u32 & ALL;
            let from = first + bits.trailing_zeros().min(WIDE as u32) as i32;
            [from, from + bits.count_ones() as i32]
        }
    }
}

/// What f32 may round of where a line is within a leaf, as a share of the most that it changes by.
const ROUNDED: f32 = 1e-6;

/// Which of the pixels of a leaf that starts at `from` are where a line is less than 0. The same bits by every kernel.
#[inline(always)]
fn below<W: Wide>(from: [i32; 2], [u, v, w]: [f64; 3]) -> u64 {
    // The first pixel's in f64: what f32 then adds is small.
    let first = u * f64::from(from[0]) + v * f64::from(from[1]) + w;
    let along = W::count().mul(W::splat(u as f32));
    // Nearer to 0 than this, f32 does not tell: a line through pixels runs along a plane that the eye is in, and all of its planes are to be on one side of it.
    let near = W::splat((u.abs() * WIDE as f64 + v.abs() * ROWS as f64) as f32 * ROUNDED);
    let (mut bits, mut doubt) = (0, 0);
    for j in 0..ROWS {
        let value = along.add(W::splat((first + v * j as f64) as f32));
        bits |= u64::from(W::splat(0.0).greater(value)) << (WIDE * j);
        doubt |= u64::from(near.greater(value.abs())) << (WIDE * j);
    }
    if doubt == 0 { bits } else { exactly_below(first, [u, v], (bits, doubt)) }
}

/// Which of the pixels of a leaf that starts at `from` are where one line is nearer to 0 than another one says. The same bits by every kernel.
#[inline(always)]
fn near<W: Wide>(from: [i32; 2], [u, v, w]: [f64; 3], [off_u, off_v, off_w]: [f32; 3]) -> u64 {
    let first = u * f64::from(from[0]) + v * f64::from(from[1]) + w;
    let along = W::count().mul(W::splat(u as f32));
    let off_first = off_u * from[0] as f32 + off_v * from[1] as f32 + off_w;
    let off_along = W::count().mul(W::splat(off_u));
    let mut bits = 0;
    for j in 0..ROWS {
        let value = along.add(W::splat((first + v * j as f64) as f32));
        let off = off_along.add(W::splat(off_first + off_v * j as f32));
        bits |= u64::from(off.greater(value.abs())) << (WIDE * j);
    }
    bits
}

/// The same as [`below`], where those that are in doubt are told in f64.
#[cold]
#[inline(never)]
fn exactly_below(first: f64, [u, v]: [f64; 2], (mut bits, mut doubt): (u64, u64)) -> u64 {
    while doubt != 0 {
        let bit = doubt.trailing_zeros() as usize;
        doubt &= doubt - 1;
        let value = u * (bit % WIDE) as f64 + v * (bit / WIDE) as f64 + first;
        bits = bits & !(1 << bit) | u64::from(value < 0.0) << bit;
    }
    bits
}

/// Fills what is free of a packet.
#[inline(always)]
fn all<W: Wide>(cover: &mut Cover<'_>, packet: &Packet, tint: &impl Tint) {
    let ([x0, y0], [x1, y1]) = (packet.from, packet.to);
    let first = W::splat(x0 as f32).add(W::count());
    let step = W::splat(WIDE as f32);
    for row in y0..y1 {
        let below = (row - cover.top) as usize;
        let same = tint.row(row as f32);
        let mut columns = first;
        let drawn = cover.is_drawn(below);
        let line = below * cover.width..(below + 1) * cover.width;
        if !drawn && (x1 as usize).is_multiple_of(WIDE) {
            let (whole, _) = cover.pixels[line][x0 as usize..x1 as usize].as_chunks_mut::<WIDE>();
            for block in whole {
                W::put_all(tint.pixels(same, columns), block);
                columns = columns.add(step);
            }
            continue;
        }
        for block in x0 as usize / WIDE..(x1 as usize).div_ceil(WIDE) {
            let free = ALL & !cover.shown(below, block);
            if free != 0 {
                put::<W>(&mut cover.pixels[line.clone()], block, tint.pixels(same, columns), free);
            }
            columns = columns.add(step);
        }
    }
}

/// Fills what is free of some pixels of a leaf that starts at `from`.
#[inline(always)]
fn some<W: Wide>(cover: &mut Cover<'_>, from: [i32; 2], bits: u64, tint: &impl Tint) {
    let columns = W::splat(from[0] as f32).add(W::count());
    let block = from[0] as usize / WIDE;
    for j in 0..ROWS {
        let mut mask = (bits >> (WIDE * j)) as u32 & ALL;
        if mask == 0 {
            continue;
        }
        let row = from[1] + j as i32;
        let below = (row - cover.top) as usize;
        mask &= !cover.shown(below, block);
        let line = &mut cover.pixels[below * cover.width..(below + 1) * cover.width];
        put::<W>(line, block, tint.pixels(tint.row(row as f32), columns), mask);
    }
}
