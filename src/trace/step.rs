//! What makes a cell simple: all that a ray's way through it needs, side by side, read off the sections when a scene is opened.

use bytemuck::{Pod, Zeroable};

use super::NONE;
use super::lanes::Lanes;
use super::path::Prisms;
use crate::format::Views;
use crate::format::records::{CellRecord, CoverRecord, LANES, PLAIN, SideRecord};

/// What a ray's way through a simple prism of air needs: 128 bytes, two lines of a cache. It says nothing that the sections of a scene do
/// not say.
///
/// Of cells that are no prisms of air with at most eight corners that turn, and at most 255 sides, the first of them starting at such a
/// corner: zeros.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Step {
    /// x of each corner of the footprint at which its border turns, as `SideRecord::start` has it; then of the first again.
    pub(crate) x: [f32; LANES],
    /// The same for y.
    pub(crate) y: [f32; LANES],
    /// Where the edge from each leads, a *link*; zeros for none. Then where the floor and the ceiling lead.
    pub(crate) links: [u32; LANES + 2],
    /// The side that starts at each corner, counted from the cell's first; then the number of its sides again.
    pub(crate) side: [u8; LANES],
    /// Heights of floor and ceiling, exact; NaN if one is sloped.
    pub(crate) height: [f32; 2],
    /// `CellRecord::root`.
    pub(crate) root: u32,
    /// `CellRecord::flags`.
    pub(crate) flags: u16,
    /// How many corners turn.
    pub(crate) corners: u8,
    /// 0 of cells that are not simple, else [`Step::LEVEL`] or [`Step::SLOPED`].
    kind: u8,
}

impl Step {
    /// The kind of simple cells whose floor and ceiling are level.
    const LEVEL: u8 = 1;
    /// The kind of simple cells one of whose floor and ceiling is sloped.
    const SLOPED: u8 = 2;
    /// Of cells that are not simple.
    pub(crate) const NONE: Step = Step {
        x: [0.0; LANES],
        y: [0.0; LANES],
        links: [0; LANES + 2],
        side: [0; LANES],
        height: [0.0; 2],
        root: 0,
        flags: 0,
        corners: 0,
        kind: 0,
    };
    /// The bit of a link that leads to matter, behind a face with the flag [`PLAIN`]; the others are the number of its source. A link with neither
    /// this bit nor [`Step::SPLIT`] is the number of a prism of air.
    pub(crate) const PLATE: u32 = 1 << 31;
    /// The bit of a link, unless it has [`Step::PLATE`], that leads to parts of an edge, or of a floor or a ceiling; the others are the number of
    /// their first [`Split`], or [`Tiles`].
    pub(crate) const SPLIT: u32 = 1 << 30;
    /// The bits of a link that leads to matter behind a face that is not plain; the others are the number of its source. No less than that are
    /// all links that say not where a ray's way goes on, nor in which plane it ends.
    pub(crate) const ROUGH: u32 = Step::PLATE | Step::SPLIT;
    /// The link of what has other parts: the sections tell.
    pub(crate) const PARTS: u32 = u32::MAX - 1;
    /// The link of what lies around the prisms.
    pub(crate) const AROUND: u32 = u32::MAX - 2;
    /// The link of matter without a source, of air with one, and of what is in doubt: left to the careful walk.
    pub(crate) const OTHER: u32 = u32::MAX;

    /// How far a point is within each edge, times the edge's size, and those sizes, from one end to the other along each axis; of lanes
    /// without an edge zeros. Rounded alike on all kernels.
    #[inline(always)]
    pub(super) fn inward<L: Lanes>(&self, [x, y]: [f64; 2]) -> (L, L) {
        inward(&self.x, &self.y, [x as f32, y as f32])
    }

    /// Whether the cell is simple, and its floor and its ceiling are level.
    #[inline(always)]
    pub(crate) fn is_level(&self) -> bool {
        self.kind == Step::LEVEL
    }

    /// Makes what asks take a level floor and ceiling for sloped ones: the answers are the same.
    #[cfg(all(feature = "compile", feature = "render"))]
    pub(crate) fn forget_that_it_is_level(&mut self) {
        if self.kind == Step::LEVEL {
            self.kind = Step::SLOPED;
        }
    }

    /// Whether the cell is simple, and its floor or its ceiling is sloped.
    #[inline(always)]
    pub(crate) fn is_sloped(&self) -> bool {
        self.kind == Step::SLOPED
    }

    /// Whether the cell is simple.
    #[inline(always)]
    pub(crate) fn is_some(&self) -> bool {
        self.kind != 0
    }
}

/// Up to nine parts of an edge of a simple prism's footprint that is split.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Split {
    /// Where the second part and each further one start, as a share of the edge; infinite where there are no more.
    pub(crate) starts: [f32; LANES],
    /// The number of its first part; the others follow.
    pub(crate) first: u32,
    /// 1 if there are more: the next begins with the last of these.
    pub(crate) more: u32,
}

/// What is over a part of an edge of a simple prism's footprint.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Part {
    /// Where the first and the second face over it end, exact; infinite where there are no more.
    pub(crate) top: [f32; 2],
    /// Where its faces lead, from the floor up.
    pub(crate) link: [u32; Part::FACES],
}

impl Part {
    /// At most so many faces.
    const FACES: usize = 3;
}

/// Up to eight parts of the floor or the ceiling of a simple prism.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Tiles {
    /// The least x and y of each in the plan, exact; of lanes without a part, or whose part has more corners than a shape, more than the greatest.
    pub(crate) lo: [[f32; LANES]; 2],
    /// The greatest.
    pub(crate) hi: [[f32; LANES]; 2],
    /// Where each leads.
    pub(crate) link: [u32; LANES],
    /// The number of its [`Shape`]; [`NONE`] if it is that box.
    pub(crate) shape: [u32; LANES],
    /// 1 if there are more in the next record.
    pub(crate) more: u32,
}

impl Tiles {
    const NONE: Tiles = Tiles {
        lo: [[f32::INFINITY; LANES]; 2],
        hi: [[f32::NEG_INFINITY; LANES]; 2],
        link: [Step::OTHER; LANES],
        shape: [NONE; LANES],
        more: 0,
    };
}

/// A convex part of a floor or a ceiling in the plan: its corners, counterclockwise, then the first again.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Shape {
    pub(crate) x: [f32; LANES],
    pub(crate) y: [f32; LANES],
}

impl Shape {
    /// Whether it holds a point, no nearer to its border than one aside by `margin` comes.
    #[inline(always)]
    fn holds<L: Lanes>(&self, [x, y]: [f32; 2], margin: L) -> bool {
        let (inward, size) = inward::<L>(&self.x, &self.y, [x, y]);
        // Of lanes without an edge both are 0.
        L::bits(margin.mul(size).le(inward)) == 0xff
    }
}

/// How far a point is within each edge from one corner to the next, times the edge's size, and those sizes, from one end to the other along each
/// axis; of lanes without an edge zeros. Rounded alike on all kernels.
#[inline(always)]
fn inward<L: Lanes>(x: &[f32; LANES], y: &[f32; LANES], point: [f32; 2]) -> (L, L) {
    let (corner_x, corner_y) = (L::load(x), L::load(y));
    let (ex, ey) = (corner_x.rotate().sub(corner_x), corner_y.rotate().sub(corner_y));
    let (px, py) = (L::splat(point[0]).sub(corner_x), L::splat(point[1]).sub(corner_y));
    (ex.mul(py).sub(ey.mul(px)), ex.abs().add(ey.abs()))
}

/// Where the part of a floor or a ceiling leads that a point of the plan is in, whose tiles are from the `first` on, if it is no nearer to the
/// part's border than one aside by `margin` comes. Else [`Step::PARTS`]: the sections tell.
#[inline(always)]
pub(super) fn tile<L: Lanes>(tables: &Views, first: u32, point: [f32; 2], margin: f32) -> u32 {
    let (x, y, margin) = (L::splat(point[0]), L::splat(point[1]), L::splat(margin));
    for tile in tables.tiles.get(first as usize..).unwrap_or_default() {
        // How far within each side.
        let [lo_x, lo_y] = [x.sub(L::load(&tile.lo[0])), y.sub(L::load(&tile.lo[1]))];
        let [hi_x, hi_y] = [L::load(&tile.hi[0]).sub(x), L::load(&tile.hi[1]).sub(y)];
        let within = lo_x.min(hi_x).min(lo_y.min(hi_y));
        let mut within = L::bits(margin.le(within));
        while within != 0 {
            let lane = within.trailing_zeros() as usize % LANES;
            within &= within - 1;
            let is_in = match tables.shapes.get(tile.shape[lane] as usize) {
                Some(shape) => shape.holds::<L>(point, margin),
                None => true,
            };
            if is_in {
                return tile.link[lane];
            }
        }
        if tile.more == 0 {
            break;
        }
    }
    Step::PARTS
}

/// What edges, floors and ceilings of simple prisms are split into.
#[derive(Default)]
pub(crate) struct Splits {
    pub(crate) splits: Vec<Split>,
    pub(crate) parts: Vec<Part>,
    pub(crate) tiles: Vec<Tiles>,
    pub(crate) shapes: Vec<Shape>,
}

/// Where a face leads that has a cell and a source behind it.
#[inline(always)]
pub(super) fn link(cells: &[CellRecord], cell: u32, source: u32, flags: u16) -> u32 {
    let Some(next) = cells.get(cell as usize) else { return Step::OTHER };
    match next.kind {
        CellRecord::SOLID if source < Step::SPLIT - 3 => {
            source | if flags == PLAIN { Step::PLATE } else { Step::ROUGH }
        }
        CellRecord::AIR if source == NONE && cell < Step::SPLIT => cell,
        CellRecord::AROUND if source == NONE => Step::AROUND,
        _ => Step::OTHER,
    }
}

impl Splits {
    /// Where an edge leads that ends at a corner and is split into these sides.
    fn add(&mut self, prisms: &Prisms<'_>, sides: &[SideRecord], end: [f32; 2]) -> u32 {
        let (first, number) = (self.parts.len(), self.splits.len());
        let count = sides.len().saturating_sub(1).div_ceil(LANES).max(1);
        if number + count >= Step::SPLIT as usize || first + sides.len() >= u32::MAX as usize {
            return Step::PARTS;
        }
        let [ax, ay] = sides[0].start.map(f64::from);
        let (ex, ey) = (f64::from(end[0]) - ax, f64::from(end[1]) - ay);
        let share = |start: [f32; 2]| {
            ((f64::from(start[0]) - ax) * ex + (f64::from(start[1]) - ay) * ey) / (ex * ex + ey * ey)
        };
        for side in sides {
            let faces = prisms.faces_of(side);
            let mut part = Part { top: [f32::INFINITY; 2], link: [Step::OTHER; Part::FACES] };
            let tops = faces.iter().rev().skip(1).rev().map(|face| exact(prisms, face.top));
            let is_simple = faces.len() <= Part::FACES
                && tops.enumerate().all(|(face, top)| {
                    part.top[face] = top;
                    !top.is_nan()
                });
            if !is_simple {
                self.parts.truncate(first);
                return Step::PARTS;
            }
            for (to, face) in part.link.iter_mut().zip(faces) {
                *to = link(prisms.cells, face.cell, face.source, face.flags);
            }
            self.parts.push(part);
        }
        for block in 0..count {
            let part = block * LANES;
            let (first, more) = ((first + part) as u32, u32::from(block + 1 < count));
            let mut split = Split { starts: [f32::INFINITY; LANES], first, more };
            for (to, side) in split.starts.iter_mut().zip(&sides[part + 1..]) {
                *to = share(side.start) as f32;
            }
            self.splits.push(split);
        }
        Step::SPLIT | number as u32
    }
}

impl Splits {
    /// Where a floor or a ceiling leads that is split into these parts.
    fn tile(&mut self, prisms: &Prisms<'_>, covers: &[CoverRecord]) -> u32 {
        let (first, count) = (self.tiles.len(), covers.len().div_ceil(LANES));
        let cells = || covers.iter().map(|cover| prisms.cells.get(cover.cell as usize));
        let is_known = cells().all(|cell| cell.is_some_and(|cell| cell.kind != CellRecord::AROUND));
        if count == 0 || !is_known || first.max(self.shapes.len()) + covers.len() >= Step::SPLIT as usize {
            return Step::PARTS;
        }
        self.tiles.resize(first + count, Tiles::NONE);
        for ((place, cover), cell) in covers.iter().enumerate().zip(cells().flatten()) {
            let (tile, lane) = (&mut self.tiles[first + place / LANES], place % LANES);
            tile.more = u32::from((place / LANES + 1) * LANES < covers.len());
            let sides = prisms.sides_of(cell);
            if sides.len() > LANES {
                continue;
            }
            for side in sides {
                for axis in 0..2 {
                    tile.lo[axis][lane] = tile.lo[axis][lane].min(side.start[axis]);
                    tile.hi[axis][lane] = tile.hi[axis][lane].max(side.start[axis]);
                }
            }
            tile.link[lane] = link(prisms.cells, cover.cell, cover.source, cover.flags);
            let is_box = sides.iter().zip(sides.iter().cycle().skip(1)).all(|(side, next)| {
                let on = |axis: usize| {
                    let [c, d] = [side.start[axis], next.start[axis]];
                    c == d && (c == tile.lo[axis][lane] || c == tile.hi[axis][lane])
                };
                on(0) || on(1)
            });
            if !is_box {
                tile.shape[lane] = self.shapes.len() as u32;
                let corner =
                    |lane: usize, axis: usize| sides[if lane < sides.len() { lane } else { 0 }].start[axis];
                let [x, y] = [0, 1].map(|axis| std::array::from_fn(|lane| corner(lane, axis)));
                self.shapes.push(Shape { x, y });
            }
        }
        Step::SPLIT | first as u32
    }
}

/// The height of a plane that is level, if f32 has it; else NaN. On the lattice it is.
fn exact(prisms: &Prisms<'_>, plane: u32) -> f32 {
    match prisms.level(plane) {
        Some(height) if f64::from(height as f32) == height => height as f32,
        _ => f32::NAN,
    }
}

/// The step of a cell; what its edges are split into is added to `splits`.
pub(crate) fn step_of(prisms: &Prisms<'_>, cell: &CellRecord, splits: &mut Splits) -> Step {
    let sides = prisms.sides_of(cell);
    let count = sides.len();
    if cell.kind != CellRecord::AIR || count < 3 || count > usize::from(u8::MAX) {
        return Step::NONE;
    }
    let mut step = Step { root: cell.root, flags: cell.flags, ..Step::NONE };
    let mut corners = 0;
    for (index, side) in sides.iter().enumerate() {
        let before = sides[(index + count - 1) % count].start.map(f64::from);
        let here = side.start.map(f64::from);
        let after = sides[(index + 1) % count].start.map(f64::from);
        // Exact: coordinates on the lattice have 25 bits.
        let turns =
            (here[0] - before[0]) * (after[1] - here[1]) != (here[1] - before[1]) * (after[0] - here[0]);
        if !turns {
            if corners == 0 {
                return Step::NONE;
            }
            step.links[corners - 1] = Step::PARTS;
            continue;
        }
        if corners == LANES {
            return Step::NONE;
        }
        [step.x[corners], step.y[corners]] = side.start;
        step.side[corners] = index as u8;
        step.links[corners] = match prisms.faces_of(side) {
            [only] => link(prisms.cells, only.cell, only.source, only.flags),
            _ => Step::PARTS,
        };
        corners += 1;
    }
    step.corners = corners as u8;
    for corner in 0..corners {
        if step.links[corner] == Step::PARTS {
            let start = usize::from(step.side[corner]);
            let end = if corner + 1 < corners { step.side[corner + 1].into() } else { count };
            let next = sides[if end == count { 0 } else { end }].start;
            step.links[corner] = splits.add(prisms, &sides[start..end], next);
        }
    }
    for lane in corners..LANES {
        (step.x[lane], step.y[lane], step.side[lane]) = (step.x[0], step.y[0], count as u8);
    }
    let (below, above) = prisms.covers_of(cell);
    for (end, plane, covers) in [(0, cell.floor, below), (1, cell.ceiling, above)] {
        step.links[LANES + end] = match covers {
            [only] => link(prisms.cells, only.cell, only.source, only.flags),
            covers => splits.tile(prisms, covers),
        };
        step.height[end] = exact(prisms, plane);
    }
    let is_sloped = step.height[0].is_nan() || step.height[1].is_nan();
    step.kind = if is_sloped { Step::SLOPED } else { Step::LEVEL };
    step
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::generate::{self, OfficeOptions, Style, build1};
    use crate::samples::Sample;
    use crate::splitmix::SplitMix64;
    use crate::trace::lanes::Portable;
    use crate::{CompileOptions, compile};

    /// Of a corridor with doors on both sides, too, whose walls fall into more parts than one record has.
    #[test]
    fn split_edges_have_the_parts_of_their_sides() {
        let scene = Sample::Build1.scene();
        let (tables, prisms) = (&scene.tables, Prisms::new(&scene.tables));
        let mut most = 0;
        for (cell, step) in tables.cells.iter().zip(tables.steps.iter()) {
            for corner in 0..usize::from(step.corners) {
                let link = step.links[corner];
                if link & (Step::PLATE | Step::SPLIT) != Step::SPLIT {
                    continue;
                }
                let next = (corner + 1) % usize::from(step.corners);
                let [from, to] = [corner, next].map(|c| [f64::from(step.x[c]), f64::from(step.y[c])]);
                let sides = prisms.sides_of(cell);
                let end = if next == 0 { sides.len() } else { step.side[next].into() };
                let sides = &sides[step.side[corner].into()..end];
                most = most.max(sides.len());
                let mut split = (link & !Step::SPLIT) as usize;
                let first = tables.splits[split].first as usize;
                for (part, side) in sides.iter().enumerate() {
                    if part > 0 {
                        let record = tables.splits[split];
                        let share = f64::from(record.starts[(part - 1) % LANES]);
                        for axis in 0..2 {
                            let at = from[axis] + share * (to[axis] - from[axis]);
                            assert!((at - f64::from(side.start[axis])).abs() < 1e-5, "{side:?} {record:?}");
                        }
                        assert_eq!(record.more == 1, part + LANES - (part - 1) % LANES < sides.len());
                        if part % LANES == 0 && record.more == 1 {
                            split += 1;
                            assert_eq!(tables.splits[split].first as usize, first + part);
                        }
                    }
                    let lowest = prisms.faces_of(side)[0];
                    let leads = super::link(prisms.cells, lowest.cell, lowest.source, lowest.flags);
                    assert_eq!(tables.parts[first + part].link[0], leads);
                }
                let record = tables.splits[split];
                let used = (1..sides.len()).map(|part| (part - 1) % LANES + 1).next_back().unwrap_or(0);
                assert!(record.more == 0 && record.starts[used..].iter().all(|start| start.is_infinite()));
            }
        }
        assert!(most > LANES + 1, "{most} parts");
    }

    /// A point well within one part leads where that does; one near a border, or in none, is left to the sections.
    #[test]
    fn tiles_lead_where_the_parts_of_floors_and_ceilings_do() {
        let office = OfficeOptions { seed: 2, ..OfficeOptions::default() };
        let mut random = SplitMix64::new(4);
        let (mut boxes, mut shapes, mut none) = (0, 0, 0);
        for building in [build1(&office), generate::random(&office)] {
            let model = building.export(&Style::exact()).to_model().unwrap();
            let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
            let (tables, prisms) = (&scene.tables, Prisms::new(&scene.tables));
            for (cell, step) in tables.cells.iter().zip(tables.steps.iter()) {
                let (below, above) = prisms.covers_of(cell);
                for (covers, link) in [(below, step.links[LANES]), (above, step.links[LANES + 1])] {
                    if link & Step::ROUGH != Step::SPLIT {
                        continue;
                    }
                    let first = link & !Step::SPLIT;
                    for _ in 0..150 {
                        let [lo, hi] = cell.bounds;
                        let point = [0, 1].map(|axis| random.between(lo[axis], hi[axis]) as f32);
                        let margin = random.between(0.0, 0.05) as f32;
                        // How far it is within each part, along the axes.
                        let within = |cover: &CoverRecord| {
                            let sides = prisms.sides_of(&prisms.cells[cover.cell as usize]);
                            let next = sides.iter().cycle().skip(1);
                            let within = sides.iter().zip(next).map(|(side, next)| {
                                let [a, b] = [side, next].map(|side| side.start.map(f64::from));
                                let [ex, ey] = [b[0] - a[0], b[1] - a[1]];
                                let [px, py] = [f64::from(point[0]) - a[0], f64::from(point[1]) - a[1]];
                                (ex * py - ey * px) / (ex.abs() + ey.abs())
                            });
                            within.fold(f64::INFINITY, f64::min)
                        };
                        let (best, cover) = covers
                            .iter()
                            .map(|cover| (within(cover), cover))
                            .max_by(|a, b| a.0.total_cmp(&b.0))
                            .unwrap();
                        let leads = super::link(prisms.cells, cover.cell, cover.source, cover.flags);
                        let said = tile::<Portable>(tables, first, point, margin);
                        if best >= f64::from(margin) + 1e-4 {
                            assert!(said == leads || said == Step::PARTS, "{said:x} {leads:x} {cover:?}");
                            let sides = prisms.cells[cover.cell as usize].sides as usize;
                            assert!(said == leads || sides > LANES, "{sides} sides: {point:?} {cover:?}");
                            let mut lanes =
                                (0..covers.len()).map(|at| (first as usize + at / LANES, at % LANES));
                            let is_box = lanes.any(|(at, lane)| {
                                let tile = &tables.tiles[at];
                                tile.link[lane] == leads && tile.shape[lane] == NONE
                            });
                            if is_box { boxes += 1 } else { shapes += 1 }
                        } else if best < f64::from(margin) - 1e-4 {
                            assert_eq!(said, Step::PARTS, "{point:?} {margin} {best} {cover:?}");
                            none += 1;
                        }
                    }
                }
            }
        }
        assert!(boxes > 100 && shapes > 100 && none > 100, "{boxes} {shapes} {none}");
    }
}
