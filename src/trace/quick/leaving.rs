//! Where a ray leaves a prism of air, and where that leads.
//!
//! Of a simple prism all edges are looked at at once, in f32, with a margin for what that rounds; what it says of no doubt is so. The operations are
//! those of one lane, rounded one by one, on every kernel. Of other prisms sides, floor and ceiling are looked at in f64.

// Comparisons are written so that NaN is in doubt.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use glam::DVec3;

use super::Way;
use crate::format::Views;
use crate::format::records::{CellRecord, CoverRecord, LANES, SideRecord};
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::lanes::Lanes;
use crate::trace::path::{BLURRED, Prisms, outward};
use crate::trace::ray::Ray;
use crate::trace::step::{Step, link};

/// Where a ray leaves a prism, and where that leads.
///
/// Of three words that are written and read one by one: a processor that reads two at once which were written apart waits until both are in its
/// cache.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Exit {
    /// Where, metres along it: to rounding of f64 if `by` is from [`ANY`] on; else it leaves no later.
    t: f64,
    /// A link of [`Step`]; [`Step::OTHER`] in doubt.
    pub(in crate::trace) link: u32,
    /// The edge of a simple prism that it passes, or [`DOWN`], or [`UP`]; else from [`ANY`] on.
    by: u32,
}

/// In the place of an edge: the floor, the ceiling.
pub(in crate::trace) const DOWN: usize = LANES;
pub(in crate::trace) const UP: usize = LANES + 1;

/// In the place of an edge, from this on: where it leaves is told. Of a prism that is not simple, and beside the number of its side; after the last
/// come its floor and its ceiling.
const ANY: u32 = 1 << 31;

/// In the place of an edge: through what it leaves is not known; and for who asks, that all of a prism is to be looked at.
pub(super) const EXACT: u32 = u32::MAX;

/// From the border of a floor or a ceiling a ray passes it no nearer than this, metres: somewhat more than cells are blurred.
pub(super) const WITHIN: f32 = 1.25 * BLURRED as f32;

impl Exit {
    /// In doubt.
    pub(in crate::trace) const NONE: Exit = Exit { t: 0.0, link: Step::OTHER, by: EXACT };

    /// Through an edge of a simple prism, its floor or its ceiling, wherever that leads.
    #[inline(always)]
    pub(in crate::trace) fn through(by: u32) -> Exit {
        Exit { by, ..Exit::NONE }
    }

    /// Through an edge of a simple prism, its floor or its ceiling, there.
    #[inline(always)]
    pub(super) fn passing(t: f64, link: u32, by: usize) -> Exit {
        Exit { t, link, by: by as u32 }
    }

    /// Where a ray leaves the cell, to rounding of f64.
    #[inline(always)]
    pub(in crate::trace) fn exact_of(&self, tables: &Views, ray: &Ray, cell: u32) -> f64 {
        if self.by >= ANY { self.t } else { exact(tables, ray, cell, self.by) }
    }

    /// The edge of a simple prism that it passes, or [`DOWN`], or [`UP`]; `None` where it is a prism that is not simple.
    #[inline(always)]
    pub(super) fn by(&self) -> Option<usize> {
        (self.by < ANY).then_some(self.by as usize)
    }

    /// Whether it comes to a plain face of matter.
    #[inline(always)]
    pub(super) fn is_plain(&self) -> bool {
        self.link & Step::PLATE != 0 && self.link < Step::ROUGH
    }

    /// At a place that is told, through a side of a prism that is not simple, after the last its floor or its ceiling.
    fn at(t: f64, link: u32, side: usize) -> Exit {
        Exit { t, link, by: ANY | side as u32 }
    }

    /// Through an edge, the floor or the ceiling, about there.
    #[inline(always)]
    fn about(t: f32, off: f32, link: u32, by: usize) -> Exit {
        Exit::passing(f64::from(t) + f64::from(off), link, by)
    }

    /// It does not leave after.
    #[inline(always)]
    pub(in crate::trace) fn at_most(&self) -> f64 {
        self.t
    }
}

/// Where a ray is that leaves a prism.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Begins {
    /// It starts within it.
    Within,
    /// It starts on a surface within it, or on one of its faces: beside no more than one of these.
    BesideFace,
    /// It came into it.
    Elsewhere,
}

/// An edge of a footprint.
#[derive(Clone, Copy)]
struct Edge {
    /// Its first side.
    side: usize,
    a: [f32; 2],
    b: [f32; 2],
}

/// What f32 says of the way out of a simple prism's footprint.
pub(super) struct Footprint<L> {
    /// The edge.
    pub(super) index: usize,
    /// The sides of the line that its ends are on, the first on its right.
    pub(super) right: f32,
    pub(super) left: f32,
    /// From each corner to the next, how far the ray's origin is within, and how fast it goes out, times its size.
    pub(super) inward: L,
    pub(super) across: L,
    /// From one end to the other along each axis.
    pub(super) size: L,
    /// Where, and how far one aside is from there, times that.
    t: f32,
    pub(super) slant: f32,
    /// Whether there is such an edge, and the ray starts within the footprint if it is to.
    pub(super) is_there: bool,
}

/// What f32 says of the way out of a simple prism.
struct Crossing {
    /// As if the edge, the floor or the ceiling had no parts.
    exit: Exit,
    passage: Passage,
    /// Through the floor or the ceiling, there in the plan, and so far from it one aside passes it at most.
    spot: [f32; 2],
    margin: f32,
    /// Through an edge, which part of it is not looked at.
    is_within: bool,
    /// In no doubt where there are no parts.
    is_clear: bool,
}

/// Whether a link leads to parts of an edge, a floor or a ceiling.
#[inline(always)]
pub(in crate::trace) fn is_split(link: u32) -> bool {
    link & (Step::PLATE | Step::SPLIT) == Step::SPLIT
}

/// The same, as far as parts of an edge need it.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Passage {
    /// The sides of the line that the edge's ends are on, the first on its right.
    pub(in crate::trace) sides: [f32; 2],
    /// Nearer to 0 than this they are in doubt.
    pub(in crate::trace) least: f32,
    pub(in crate::trace) height: f32,
    /// Farther than that from `height` one aside is not.
    pub(in crate::trace) blur: f32,
}

impl Passage {
    /// Where the part of a split edge leads that a ray leaves through; `None` in doubt.
    #[inline(always)]
    pub(in crate::trace) fn part<L: Lanes>(&self, tables: &Views, split: u32) -> Option<u32> {
        let [right, left] = self.sides;
        let mut is_between = (-right >= self.least) & (left >= self.least);
        let mut splits = tables.splits.get(split as usize..)?.iter();
        let part = loop {
            let split = splits.next()?;
            let starts = L::load(&split.starts);
            let sides = L::splat(right).add(L::splat(left - right).mul(starts));
            is_between &= L::bits(L::splat(self.least).le(sides.abs())) == 0xff;
            let passed = LANES as u32 - L::bits(L::splat(0.0).le(sides)).count_ones();
            if passed < LANES as u32 || split.more == 0 {
                break tables.parts.get((split.first + passed) as usize)?;
            }
        };
        let (over, over_next) = (self.height - part.top[0], self.height - part.top[1]);
        let is_clear = is_between & (over.abs() >= self.blur) & (over_next.abs() >= self.blur);
        is_clear.then(|| part.link[usize::from(over > 0.0) + usize::from(over_next > 0.0)])
    }
}

impl Way<'_> {
    /// Where the ray leaves a prism of air, in which it starts, or which it came into.
    #[inline(always)]
    pub(super) fn leave<L: Entries>(&self, cell: u32, starts: bool) -> Exit {
        let Some(step) = self.tables.steps.get(cell as usize) else { return Exit::NONE };
        if !step.is_level() {
            return self.otherwise::<L>(cell, EXACT, starts);
        }
        let begins = if starts { Begins::Within } else { Begins::Elsewhere };
        self.through::<L>(cell, self.crossing::<L>(step, begins))
    }

    /// The same of a ray that starts on a surface within a prism of air, or on one of its faces.
    #[inline(always)]
    pub(super) fn leave_from_face<L: Entries>(&self, cell: u32) -> Exit {
        let Some(step) = self.tables.steps.get(cell as usize) else { return Exit::NONE };
        if step.is_level() {
            self.through::<L>(cell, self.crossing::<L>(step, Begins::BesideFace))
        } else if self.starts_beside::<L>(cell) {
            self.otherwise::<L>(cell, EXACT, false)
        } else {
            Exit::NONE
        }
    }

    /// Where what f32 says of the way out of a simple and level prism leads.
    #[inline(always)]
    fn through<L: Entries>(&self, cell: u32, crossing: Crossing) -> Exit {
        let exit = crossing.exit;
        if crossing.is_clear && !is_split(exit.link) && exit.link != Step::PARTS {
            return exit;
        }
        if crossing.is_within && is_split(exit.link) {
            let part = crossing.passage.part::<L>(self.tables, exit.link & !Step::SPLIT);
            return Exit { link: part.unwrap_or(Step::OTHER), ..exit };
        }
        if crossing.is_clear && is_split(exit.link) {
            let link = L::tile(self.tables, exit.link & !Step::SPLIT, crossing.spot, crossing.margin);
            if link != Step::PARTS {
                return Exit { link, ..exit };
            }
        }
        // Neither the link of an edge, a floor or a ceiling nor that of a part of a split edge tells.
        if crossing.is_within || crossing.is_clear {
            return self.otherwise::<L>(cell, exit.by, false);
        }
        Exit::NONE
    }

    #[inline(always)]
    fn otherwise<L: Entries>(&self, cell: u32, by: u32, starts: bool) -> Exit {
        // Taken apart, so that what others return stays in registers, too.
        let Exit { t, link, by } =
            L::otherwise(self.tables, self.ray, cell, by, starts).unwrap_or(Exit::NONE);
        Exit { t, link, by }
    }

    /// Where the ray's line in the plan leaves the footprint of a simple prism.
    #[inline(always)]
    pub(super) fn footprint<L: Lanes>(&self, step: &Step, starts: bool) -> Footprint<L> {
        let [fx, fy] = [self.from.x as f32, self.from.y as f32];
        let (x, y) = (L::load(&step.x).sub(L::splat(fx)), L::load(&step.y).sub(L::splat(fy)));
        let (along_x, along_y) = (L::splat(self.along.x as f32), L::splat(self.along.y as f32));
        let sides = along_x.mul(y).sub(along_y.mul(x));
        let (ex, ey) = (x.rotate().sub(x), y.rotate().sub(y));
        let size = ex.abs().add(ey.abs());
        let inward = ey.mul(x).sub(ex.mul(y));
        let across = along_x.mul(ey).sub(along_y.mul(ex));
        // From its right to its left.
        let left = L::bits(L::splat(0.0).le(sides));
        let leaves = !left & (left >> 1 | left << (LANES - 1)) & 0xff;
        // The last, should rounding have made several.
        let index = (leaves | 1).ilog2() as usize % LANES;
        let sides = sides.store();
        let (right, left) = (sides[index], sides[(index + 1) % LANES]);
        // Not the difference of the ends' sides, which are rounded as far as they are from the ray's origin.
        let per = 1.0 / across.store()[index];
        let t = inward.store()[index] * per;
        let slant = size.store()[index] * per;
        let mut is_there = leaves != 0;
        if starts {
            is_there &= (L::bits(L::splat(0.0).le(inward)) == 0xff) & (t >= 0.0);
        }
        Footprint { index, right, left, inward, across, size, t, slant, is_there }
    }

    /// Where the ray leaves a simple prism, as far as f32 tells. Whether through an edge is left to a processor's guess: it foresees that of rays
    /// that go similar ways, and what follows need not wait.
    #[inline(always)]
    fn crossing<L: Lanes>(&self, step: &Step, begins: Begins) -> Crossing {
        let [fx, fy, fz] = [self.from.x as f32, self.from.y as f32, self.from.z as f32];
        let [ax, ay, az] = [self.along.x as f32, self.along.y as f32, self.along.z as f32];
        let margin = BLURRED as f32 + self.rounding;
        let Footprint { index, right, left, inward, across, size, t, slant, mut is_there } =
            self.footprint::<L>(step, begins == Begins::Within);
        let [floor, ceiling] = step.height;
        match begins {
            Begins::Within => is_there &= (fz >= floor) & (fz <= ceiling),
            Begins::BesideFace => is_there &= self.is_beside_one(inward, size, [fz - floor, ceiling - fz]),
            Begins::Elsewhere => {}
        }
        // Its height where it leaves the footprint, beside how far that of one aside is from there.
        let height = fz + t * az;
        let blur = margin * (2.0 + slant * az.abs());
        let least = margin * (ax.abs() + ay.abs());
        let is_within = is_there & (height >= floor + blur) & (height <= ceiling - blur);
        let passage = Passage { sides: [right, left], least, height, blur };
        if is_within {
            let is_clear = (-right >= least) & (left >= least);
            let off = self.rounding * (2.0 + slant);
            let exit = Exit::about(t, off, step.links[index], index);
            return Crossing { exit, passage, spot: [0.0; 2], margin: 0.0, is_within, is_clear };
        }
        // Through the floor or the ceiling, well within their border: also of sides that it runs along and never comes to.
        let is_under = (az <= 0.0) & (height <= floor - blur);
        let is_over = (az >= 0.0) & (height >= ceiling + blur);
        let (plane, by) = if is_over { (ceiling, UP) } else { (floor, DOWN) };
        let steep = 1.0 / az;
        let (t, tilt) = ((plane - fz) * steep, 2.0 + steep.abs());
        let well = size.mul(L::splat(WITHIN + self.rounding * tilt));
        let is_well = L::bits(well.le(inward.sub(across.mul(L::splat(t))))) == 0xff;
        let is_clear = is_there & (is_under | is_over) & is_well;
        let exit = Exit::about(t, self.rounding * tilt, step.links[by], by);
        let (spot, margin) = ([fx + t * ax, fy + t * ay], margin * tilt);
        Crossing { exit, passage, spot, margin, is_within, is_clear }
    }

    /// Whether the ray starts in a simple and level prism beside one face at most, as [`Way::starts_beside`] has it: by how far it is within edges, times
    /// their size, and floor and ceiling.
    #[inline(always)]
    fn is_beside_one<L: Lanes>(&self, inward: L, size: L, heights: [f32; 2]) -> bool {
        let margins = self.margins();
        let [near, out] = [margins[0] as f32 + self.rounding, self.rounding - margins[1] as f32];
        // Lanes without an edge have no size.
        let mut beside = (!L::bits(size.mul(L::splat(near)).le(inward)) & 0xff).count_ones();
        let mut is_in = L::bits(size.mul(L::splat(out)).le(inward)) == 0xff;
        for height in heights {
            beside += u32::from(!(height >= near));
            is_in &= height >= out;
        }
        is_in & (beside <= 1)
    }

    /// Where the ray leaves the cell, to rounding of f64.
    #[inline(always)]
    pub(super) fn exact(&self, exit: &Exit, cell: u32) -> f64 {
        if exit.by >= ANY { exit.t } else { self.passes(cell, exit.by as usize) }
    }

    /// The outward normal of what the ray leaves a cell through, of any length, along the lattice's axes; `None` where that is not known.
    pub(super) fn outward(&self, exit: &Exit, cell: u32) -> Option<DVec3> {
        let (prisms, record) = (Prisms::new(self.tables), &self.tables.cells[cell as usize]);
        let (floor, ceiling) = (|| -prisms.upward(record.floor), || prisms.upward(record.ceiling));
        Some(match exit.by() {
            Some(DOWN) => floor(),
            Some(UP) => ceiling(),
            Some(corner) => {
                let (step, next) = (&self.tables.steps[cell as usize], (corner + 1) % LANES);
                outward([step.x[corner], step.y[corner]], [step.x[next], step.y[next]])
            }
            None => {
                let (sides, side) = (prisms.sides_of(record), (exit.by & !ANY) as usize);
                match side.checked_sub(sides.len()) {
                    None => outward(sides[side].start, sides[(side + 1) % sides.len()].start),
                    Some(0) => floor(),
                    Some(1) => ceiling(),
                    Some(_) => return None,
                }
            }
        })
    }

    /// Where the ray passes an edge of a simple prism, or its floor or its ceiling.
    #[inline(always)]
    pub(super) fn passes(&self, cell: u32, index: usize) -> f64 {
        let step = &self.tables.steps[cell as usize];
        if index >= LANES {
            if step.is_sloped() {
                let cell = &self.tables.cells[cell as usize];
                let (over, grows) = self.over(if index == DOWN { cell.floor } else { cell.ceiling });
                return -over / grows;
            }
            return (f64::from(step.height[index - LANES]) - self.from.z) * (1.0 / self.along.z);
        }
        let next = (index + 1) % LANES;
        let (a, b) = ([step.x[index], step.y[index]], [step.x[next], step.y[next]]);
        let per = 1.0 / (self.side(b) - self.side(a));
        self.meets(a, edge(a, b)) * per
    }

    /// The side of the line that a corner is on: negative on its right. Of corners as near to it as rounding can tell, the sign may
    /// be wrong; they are nearer than `blurred`.
    #[inline(always)]
    fn side(&self, [x, y]: [f32; 2]) -> f64 {
        let (from, along) = (self.from, self.along);
        along.x * f64::from(y) - along.y * f64::from(x) + (along.y * from.x - along.x * from.y)
    }

    /// How far along the ray its line in the plan crosses that of the edge, times how the sides of its ends differ.
    #[inline(always)]
    fn meets(&self, a: [f32; 2], [ex, ey]: [f64; 2]) -> f64 {
        (f64::from(a[0]) - self.from.x) * ey - (f64::from(a[1]) - self.from.y) * ex
    }

    /// The height over a plane where the ray starts, and by how much it grows.
    #[inline(always)]
    pub(super) fn over(&self, plane: u32) -> (f64, f64) {
        let plane = &self.tables.planes[plane as usize];
        let [p, q] = plane.slope;
        let (from, along) = (self.from, self.along);
        (from.z - p * from.x - q * from.y - plane.height, along.z - p * along.x - q * along.y)
    }

    /// Where the part of an edge leads that the ray leaves through: of its sides the last that starts on its right, and of the faces of that
    /// the one at its height there.
    #[inline(never)]
    pub(super) fn part(&self, cell: u32, step: &Step, index: usize) -> Option<u32> {
        let tables = self.tables;
        let record = &tables.cells[cell as usize];
        let first = record.first_side as usize;
        let sides = &tables.sides[first..first + record.sides as usize];
        let next = (index + 1) % LANES;
        let (mut a, mut b) = ([step.x[index], step.y[index]], [step.x[next], step.y[next]]);
        let [ex, ey] = edge(a, b);
        let per = 1.0 / (self.side(b) - self.side(a));
        let (t, slant) = (self.meets(a, [ex, ey]) * per, (ex.abs() + ey.abs()) * per);
        let mut side = usize::from(step.side[index]);
        let end = if index + 1 < LANES { usize::from(step.side[index + 1]) } else { sides.len() };
        for (part, number) in sides[side..end].iter().zip(side..).skip(1) {
            if self.side(part.start) >= 0.0 {
                b = part.start;
                break;
            }
            (side, a) = (number, part.start);
        }
        if !self.passes_between(a, b) {
            return None;
        }
        self.face(&sides[side], t, slant)
    }

    /// Whether the line leaves between two corners, and near neither of them.
    #[inline(always)]
    fn passes_between(&self, right: [f32; 2], left: [f32; 2]) -> bool {
        let blurred = BLURRED * (self.along.x.abs() + self.along.y.abs());
        -self.side(right) >= blurred && self.side(left) >= blurred
    }

    /// The face of a side at the ray's height there.
    #[inline(always)]
    fn face(&self, side: &SideRecord, t: f64, slant: f64) -> Option<u32> {
        let first = side.first_face as usize;
        let tables = self.tables;
        let faces = &tables.faces[first..first + side.faces as usize];
        let (last, others) = faces.split_last()?;
        let mut face = last;
        for other in others.iter().rev() {
            if other.top == NONE {
                face = other;
                continue;
            }
            let (over, grows) = self.over(other.top);
            let over = over + t * grows;
            if !(over.abs() >= BLURRED * (2.0 + slant * grows.abs())) {
                return None;
            }
            if over < 0.0 {
                face = other;
            }
        }
        Some(link(&tables.cells, face.cell, face.source, face.flags))
    }

    /// The same as `leave`, of any prism of air.
    #[inline(never)]
    fn leave_any<const FIRST: bool>(&self, cell: u32) -> Option<Exit> {
        let tables = self.tables;
        let record = &tables.cells[cell as usize];
        if record.kind != CellRecord::AIR {
            return None;
        }
        let first = record.first_side as usize;
        let sides = &tables.sides[first..first + record.sides as usize];
        let (mut into, mut out) = (None, None);
        let mut before = self.side(sides[0].start) >= 0.0;
        for (side, here) in sides.iter().enumerate() {
            let next = &sides[if side + 1 == sides.len() { 0 } else { side + 1 }];
            let after = self.side(next.start) >= 0.0;
            if before != after {
                let found = Some(Edge { side, a: here.start, b: next.start });
                if after { out = found } else { into = found }
            }
            before = after;
        }
        let (into, Edge { side, a, b }) = (into?, out?);
        if !self.passes_between(a, b) {
            return None;
        }
        let [ex, ey] = edge(a, b);
        let per = 1.0 / (self.side(b) - self.side(a));
        let t = self.meets(a, [ex, ey]) * per;
        let slant = (ex.abs() + ey.abs()) * per;
        let (floor, falls) = self.over(record.floor);
        let (ceiling, rises) = self.over(record.ceiling);
        if FIRST {
            let is_behind = self.meets(into.a, edge(into.a, into.b)) >= 0.0;
            if !(is_behind && t >= 0.0 && floor >= 0.0 && ceiling <= 0.0) {
                return None;
            }
        }
        // Over the floor and under the ceiling where it leaves the footprint, beside how far one aside is from there.
        let (over, under) = (floor + t * falls, -(ceiling + t * rises));
        let blur = |grows: f64| BLURRED * (2.0 + slant * grows.abs());
        let (blur_floor, blur_ceiling) = (blur(falls), blur(rises));
        if over >= blur_floor && under >= blur_ceiling {
            return Some(Exit::at(t, self.face(&sides[side], t, slant)?, side));
        }
        // Out of one of them, and well within the other there.
        let is_down = over <= -blur_floor;
        if is_down != (under >= blur_ceiling) || !(is_down || under <= -blur_ceiling) {
            return None;
        }
        let (height, grows) = if is_down { (floor, falls) } else { (ceiling, rises) };
        let t = -height / grows;
        let at = [self.from.x + t * self.along.x, self.from.y + t * self.along.y];
        let next = sides.iter().skip(1).chain(sides.first());
        let is_within = sides.iter().zip(next).all(|(a, b)| {
            let [ex, ey] = edge(a.start, b.start);
            let inward = ex * (at[1] - f64::from(a.start[1])) - ey * (at[0] - f64::from(a.start[0]));
            inward >= BLURRED * (ex.abs() + ey.abs())
        });
        if !is_within {
            return None;
        }
        Some(Exit::at(t, self.cover(cell, is_down, at, grows)?, sides.len() + usize::from(!is_down)))
    }

    /// Where the part of a floor or ceiling leads that the ray passes.
    #[inline(never)]
    pub(super) fn cover(&self, cell: u32, is_down: bool, at: [f64; 2], grows: f64) -> Option<u32> {
        let tables = self.tables;
        let record = &tables.cells[cell as usize];
        let first = record.first_cover as usize;
        let (below, above) = (record.below as usize, record.above as usize);
        let covers = if is_down { first..first + below } else { first + below..first + below + above };
        let covers: &[CoverRecord] = &tables.covers[covers];
        if let [only] = covers {
            return Some(link(&tables.cells, only.cell, only.source, only.flags));
        }
        let margin = BLURRED * (1.0 + 1.0 / grows.abs());
        for cover in covers {
            let cell = tables.cells.get(cover.cell as usize)?;
            let [lo, hi] = cell.bounds;
            if cell.kind == CellRecord::AROUND {
                return None;
            }
            if !(at[0] >= lo[0] && at[0] <= hi[0] && at[1] >= lo[1] && at[1] <= hi[1]) {
                continue;
            }
            let first = cell.first_side as usize;
            let sides = &tables.sides[first..first + cell.sides as usize];
            let (mut a, mut is_inside, mut is_beside) = (sides[sides.len() - 1].start, true, true);
            for side in sides {
                let b = side.start;
                let [ex, ey] = edge(a, b);
                let inward = ex * (at[1] - f64::from(a[1])) - ey * (at[0] - f64::from(a[0]));
                let margin = margin * (ex.abs() + ey.abs());
                is_inside &= inward >= margin;
                is_beside &= inward > -margin;
                a = b;
            }
            if is_inside {
                return Some(link(&tables.cells, cover.cell, cover.source, cover.flags));
            }
            if is_beside {
                return None;
            }
        }
        None
    }
}

/// Where a ray leaves a prism, that is not simple and level if `by` is `EXACT`, else through something of several parts.
#[inline(always)]
pub(in crate::trace) fn otherwise<L: Entries>(
    tables: &Views,
    ray: &Ray,
    cell: u32,
    by: u32,
    starts: bool,
) -> Option<Exit> {
    // By functions of their own, which find their way anew: so that none pays for what another keeps.
    if by == EXACT && tables.steps[cell as usize].is_sloped() {
        L::sloped(tables, ray, cell, starts)
    } else {
        slowly(tables, ray, cell, by, starts)
    }
}

/// The same in f64.
#[inline(never)]
pub(super) fn slowly(tables: &Views, ray: &Ray, cell: u32, by: u32, starts: bool) -> Option<Exit> {
    let way = Way::new(tables, ray)?;
    if by == EXACT {
        return if starts { way.leave_any::<true>(cell) } else { way.leave_any::<false>(cell) };
    }
    let step = &tables.steps[cell as usize];
    let t = way.passes(cell, by as usize);
    let link = if (by as usize) < LANES {
        way.part(cell, step, by as usize)?
    } else {
        let at = [way.from.x + t * way.along.x, way.from.y + t * way.along.y];
        way.cover(cell, by as usize == DOWN, at, way.along.z)?
    };
    Some(Exit::passing(t, link, by as usize))
}

/// Where a ray passes an edge of a simple prism, or its floor or its ceiling.
#[inline(never)]
fn exact(tables: &Views, ray: &Ray, cell: u32, by: u32) -> f64 {
    Way::new(tables, ray).map_or(f64::NAN, |way| way.passes(cell, by as usize))
}

/// From one corner to another. Not by `array::map`, which is not always inlined.
#[inline(always)]
fn edge(a: [f32; 2], b: [f32; 2]) -> [f64; 2] {
    [f64::from(b[0]) - f64::from(a[0]), f64::from(b[1]) - f64::from(a[1])]
}
