//! The quick way of a ray: from prism to prism of air to the first triangle of detail or the first plain face, as long as
//! nothing is in doubt.
//!
//! It goes the way of `cells`, and what it answers is what that would answer, to rounding: a ray that starts well within a
//! prism, passes no edge of a face so near that one hardly aside would go another way, and ends at a *plain* face, behind
//! which the compiler proved that all over there are triangles of one plane, or at detail. Any other ray it leaves to
//! `cells`, from its start, and of rays that start on a surface those that meet anything near it. So it has no case but the common one. No file makes it long, as it enters no more prisms than there are;
//! that plain faces are plain is the file's word.

// Comparisons are written so that NaN is in doubt.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use glam::DVec3;

use super::NONE;
use super::kernel::Probe;
use super::lanes::{Lanes, Wide};
use super::locate::{beyond, rounding};
use super::path::{BLURRED, NEAR};
use super::ray::Ray;
use super::step::Step;
use super::walk::{Found, Query, Surface, Walk, inverse};
use crate::format::Views;
use crate::format::records::{CellRecord, CoverRecord, LANES, Leaf, PLAIN, SideRecord};

/// A direction whose squared length is no farther than this from 1 is unit: no rounding brings it nearer for sure.
pub(super) const UNIT: f64 = 1e-14;

/// Steeper rays, whose directions are shorter than this in the plan, are left to `cells`.
pub(super) const STEEPEST: f64 = 1e-3;

/// Lattices with fewer steps in a metre than 2 to this power reach too far for f32.
pub(super) const COARSEST: u32 = 15;

/// Where a ray runs at a plane more along it than this, its sine, rounding moves what it meets too far.
pub(super) const GRAZING: f64 = 1.0 / 64.0;

/// A ray from a surface is left to `cells` if it meets anything nearer than this, metres: more than cells are blurred, so that what it
/// starts on, and what meets that there, is not asked about.
const FROM_SURFACE: f64 = 4.0 * BLURRED;

/// What a ray met.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quick {
    /// Where, and the triangle, or one in its plane.
    pub(super) found: Found,
    /// The cell in which it met it.
    pub(super) cell: u32,
    /// The source of the face that it met; none if it met the very triangle, or nothing.
    pub(super) source: u32,
}

/// What the ray meets first, or something where the `probe` looks for any; `hint` is the cell in which it starts, or on whose `surface`.
/// `None` where there is doubt.
#[inline(always)]
pub(super) fn quick<L: Lanes, P: Probe>(
    tables: &Views,
    ray: &Ray,
    start: &Departure<'_>,
    probe: &mut P,
) -> Option<Quick> {
    let way = Way { scattered: start.scattered, surface: start.surface, ..Way::new(tables, ray)? };
    if start.surface.is_none() {
        way.run::<L>(start.cell, probe)
    } else {
        way.run_from_surface::<L>(start.cell, probe)
    }
}

/// From where a ray starts, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure<'a> {
    /// The cell.
    pub(super) cell: u32,
    /// What it starts on, if on anything.
    pub(super) surface: Option<&'a Surface>,
    /// Whether the ray before it went elsewhere: for how the answer is looked for, not for what it is.
    pub(super) scattered: bool,
}

/// A ray under way.
#[derive(Clone, Copy)]
pub(super) struct Way<'a> {
    tables: &'a Views,
    /// As the caller has it.
    origin: DVec3,
    direction: DVec3,
    pub(super) limit: f64,
    /// As `Departure` has them.
    surface: Option<&'a Surface>,
    scattered: bool,
    /// Along the lattice's axes, from its origin.
    from: DVec3,
    along: DVec3,
    /// 1 by the third component of `along`.
    steep: f64,
    /// The third Pluecker coordinate of its line in the plan, see `plan`.
    moment: f64,
    /// No corner may be nearer to the line than this, times the direction's length in the plan.
    blurred: f64,
}

/// Where a ray leaves a prism, and where that leads: a link of [`Step`].
#[derive(Clone, Copy)]
pub(super) struct Exit {
    pub(super) t: f64,
    pub(super) link: u32,
}

/// An edge of a footprint.
#[derive(Clone, Copy)]
struct Edge {
    /// Its first side.
    side: usize,
    a: [f32; 2],
    b: [f32; 2],
}

impl<'a> Way<'a> {
    #[inline(always)]
    pub(super) fn new(tables: &'a Views, ray: &Ray) -> Option<Self> {
        let scene = &tables.scene[0];
        let mut direction = DVec3::from(ray.direction);
        let squared = direction.length_squared();
        if !((squared - 1.0).abs() <= UNIT) {
            if !(squared > 1e-100 && squared < 1e100) {
                return None;
            }
            direction /= squared.sqrt();
        }
        if !(ray.tmin == 0.0 && ray.tmax >= 0.0) || scene.lattice_bits < COARSEST {
            return None;
        }
        let origin = DVec3::from(ray.origin);
        let (mut from, mut along) = (origin - DVec3::from(scene.lattice_origin), direction);
        let [cos, sin] = scene.lattice_turn;
        if sin != 0.0 {
            (from.x, from.y) = (from.x * cos + from.y * sin, from.y * cos - from.x * sin);
            (along.x, along.y) = (along.x * cos + along.y * sin, along.y * cos - along.x * sin);
        }
        let flat = along.x.abs() + along.y.abs();
        if !(flat >= STEEPEST) {
            return None;
        }
        Some(Way::of(tables, [origin, direction], [from, along], ray.tmax))
    }

    /// A ray, and the same along the lattice's axes.
    #[inline(always)]
    fn of(tables: &'a Views, [origin, direction]: [DVec3; 2], [from, along]: [DVec3; 2], limit: f64) -> Self {
        let moment = along.y * from.x - along.x * from.y;
        let blurred = BLURRED * (along.x.abs() + along.y.abs());
        let steep = 1.0 / along.z;
        Way {
            tables,
            origin,
            direction,
            limit,
            surface: None,
            scattered: false,
            from,
            along,
            steep,
            moment,
            blurred,
        }
    }

    #[inline(always)]
    fn run<L: Lanes>(&self, hint: u32, probe: &mut impl Probe) -> Option<Quick> {
        let exit = self.leave::<L, true>(hint)?;
        self.onward::<L>(hint, exit, probe)
    }

    /// The same of a ray that starts on the surface of a cell, or of what stands in it.
    #[inline(always)]
    fn run_from_surface<L: Lanes>(&self, hint: u32, probe: &mut impl Probe) -> Option<Quick> {
        // Away from it, and not along it.
        if !(self.direction.dot(self.surface?.normal) >= GRAZING && self.starts_beside::<L>(hint)?) {
            return None;
        }
        let exit = self.leave::<L, false>(hint)?;
        if !(exit.t >= FROM_SURFACE) {
            return None;
        }
        let quick = self.onward::<L>(hint, exit, probe)?;
        let is_clear = quick.found.t >= FROM_SURFACE && quick.found.triangle != self.surface?.triangle;
        (quick.found.triangle == NONE || is_clear).then_some(quick)
    }

    /// Whether the ray starts in a simple prism, or beside one face of it: where it starts beside more, what stands behind one of them
    /// may come before another by what cells are blurred.
    #[inline(always)]
    fn starts_beside<L: Lanes>(&self, cell: u32) -> Option<bool> {
        let (step, record) = (self.tables.steps.get(cell as usize)?, self.tables.cells.get(cell as usize)?);
        if !step.is_some() {
            return None;
        }
        let (inward, size) = step.inward::<L>([self.from.x, self.from.y]);
        let edges = (1u32 << step.corners) - 1;
        let rounding = f64::from(rounding(&self.tables.scene[0]));
        let mut beside = (edges & !beyond(inward, size, 2.0 * BLURRED + rounding)).count_ones();
        let mut is_in = beyond(inward, size, rounding - BLURRED) & edges == edges;
        for (plane, up) in [(record.floor, 1.0), (record.ceiling, -1.0)] {
            let [p, q] = self.tables.planes[plane as usize].slope;
            let (within, tilt) = (self.over(plane).0 * up, 1.0 + p.abs() + q.abs());
            beside += u32::from(!(within >= 2.0 * BLURRED * tilt));
            is_in &= within >= -BLURRED * tilt;
        }
        Some(is_in && beside <= 1)
    }

    /// What the ray meets in the plane of a source's triangles; `None` if it runs along it, or starts behind it.
    #[inline(always)]
    fn plate(&self, source: u32) -> Option<Found> {
        // No such source: left to others.
        let plate = self.tables.plates.get(source as usize)?;
        let normal = DVec3::from(plate.normal);
        let toward = normal.dot(self.direction);
        let t = (plate.offset - normal.dot(self.origin)) / toward;
        // Not where it runs along it, nor where it starts in the matter by what cells are rounded.
        (toward.abs() >= GRAZING && t >= 0.0).then_some(Found { t, triangle: plate.triangle })
    }

    /// What the ray meets from a cell on that it leaves at `exit`.
    #[inline(always)]
    pub(super) fn onward<L: Lanes>(
        &self,
        mut cell: u32,
        mut exit: Exit,
        probe: &mut impl Probe,
    ) -> Option<Quick> {
        let tables = self.tables;
        // Each once.
        for _ in 0..tables.cells.len() {
            probe.cell();
            // What stands behind the face, if that ends the way.
            let (mut t, mut triangle, mut source) = (exit.t, NONE, NONE);
            let is_last = exit.link == Step::AROUND;
            if exit.link & Step::PLATE != 0 && !is_last {
                source = exit.link & !Step::PLATE;
                Found { t, triangle } = self.plate(source)?;
            }
            let root = self.root(cell);
            if root != NONE {
                let until = if t > exit.t { t } else { exit.t } + NEAR;
                let until = if until < self.limit { until } else { self.limit };
                if root & Leaf::BIT != 0 || self.touches::<L>(root, until, probe) {
                    let found = self.detail(root, [0.0, until], probe);
                    let is_nearer = triangle == NONE || (found.t, found.triangle) < (t, triangle);
                    if found.triangle != NONE && is_nearer {
                        (t, triangle, source) = (found.t, found.triangle, NONE);
                    }
                }
            }
            if triangle != NONE {
                let found = Found { t, triangle };
                return Some(if t <= self.limit {
                    Quick { found, cell, source }
                } else {
                    self.nothing(cell)
                });
            }
            if exit.t > self.limit + tables.scene[0].tolerance {
                return Some(self.nothing(cell));
            }
            if is_last {
                // Where cells say that it leaves them, or a little before: what it passed within them it did not meet.
                let found = self.detail(tables.cells[0].root, [exit.t - NEAR, self.limit], probe);
                return Some(if found.triangle == NONE {
                    self.nothing(0)
                } else {
                    Quick { found, cell: 0, source: NONE }
                });
            }
            cell = exit.link;
            exit = self.leave::<L, false>(cell)?;
        }
        None
    }

    /// Whether the ray comes to any of a node's boxes before `until`.
    #[inline(always)]
    pub(super) fn touches<L: Lanes>(&self, root: u32, until: f64, probe: &mut impl Probe) -> bool {
        probe.node();
        let slack = self.tables.scene[0].slack;
        let until = until as f32;
        let node = &self.tables.nodes[root as usize];
        let direction = self.direction;
        let inverse = inverse([direction.x as f32, direction.y as f32, direction.z as f32]);
        let local = self.origin - DVec3::from(self.tables.scene[0].center);
        let local = [local.x as f32, local.y as f32, local.z as f32];
        let (mut near, mut far) = (L::splat(-slack), L::splat(until + until * 1e-6 + slack));
        for axis in 0..3 {
            let ahead = inverse[axis] >= 0.0;
            let (enter, leave) =
                if ahead { (&node.lo[axis], &node.hi[axis]) } else { (&node.hi[axis], &node.lo[axis]) };
            let (inverse, shift) = (L::splat(inverse[axis]), L::splat(local[axis] * inverse[axis]));
            // Not the lesser and the greater: the box of a lane without a child is inside out.
            near = near.max(L::load(enter).mul_sub(inverse, shift));
            far = far.min(L::load(leave).mul_sub(inverse, shift));
        }
        L::bits(near.le(far)) != 0
    }

    #[inline(never)]
    pub(super) fn detail(&self, root: u32, [from, until]: [f64; 2], probe: &mut impl Probe) -> Found {
        let scene = &self.tables.scene[0];
        let surface = self.surface.copied();
        // Also what is behind it by no more than rounding: that is asked about.
        let first = from.max(0.0) - surface.map_or(0.0, |surface| surface.behind());
        let query = Query::new(self.origin, self.direction, (first, until), 0.0, scene, root, surface);
        probe.first(&Walk::new(self.tables), &query)
    }

    #[inline(always)]
    pub(super) fn nothing(&self, cell: u32) -> Quick {
        Quick { found: Found { t: self.limit, triangle: NONE }, cell, source: NONE }
    }

    /// The side of the line that a corner is on: negative on its right. Of corners as near to it as rounding can tell, the sign may
    /// be wrong; they are nearer than `blurred`.
    #[inline(always)]
    fn side(&self, [x, y]: [f32; 2]) -> f64 {
        self.along.x * f64::from(y) - self.along.y * f64::from(x) + self.moment
    }

    /// The edge of a footprint through which the line leaves, and the sides of its ends: a loop that ends there, which a processor
    /// foresees that saw a ray through that edge.
    #[inline(always)]
    fn edge_by_edge(&self, step: &Step) -> Option<(usize, [f64; 2])> {
        let mut right = self.side([step.x[0], step.y[0]]);
        for index in 0..LANES {
            let next = (index + 1) % LANES;
            let left = self.side([step.x[next], step.y[next]]);
            if right < 0.0 && left >= 0.0 {
                return Some((index, [right, left]));
            }
            right = left;
        }
        None
    }

    /// The same, of corners that are numbers, without a choice that could be foreseen wrongly.
    #[inline(always)]
    fn edge_of_all<L: Lanes>(&self, x: L, y: L) -> Option<(usize, [f64; 2])> {
        let [along_x, along_y] = [L::Wide::splat(self.along.x), L::Wide::splat(self.along.y)];
        let sides = along_x.mul(y.widen()).sub(along_y.mul(x.widen())).add(L::Wide::splat(self.moment));
        let is_left = L::Wide::splat(0.0).le(sides);
        let leaves = !is_left & (is_left >> 1 | is_left << (LANES - 1)) & 0xff;
        if leaves == 0 {
            return None;
        }
        let index = leaves.trailing_zeros() as usize % LANES;
        let sides = sides.store();
        Some((index, [sides[index], sides[(index + 1) % LANES]]))
    }

    /// How far along the ray its line in the plan crosses that of the edge, times how the sides of its ends differ.
    #[inline(always)]
    fn crossing(&self, a: [f32; 2], [ex, ey]: [f64; 2]) -> f64 {
        (f64::from(a[0]) - self.from.x) * ey - (f64::from(a[1]) - self.from.y) * ex
    }

    /// The height over a plane where the ray starts, and by how much it grows.
    #[inline(always)]
    fn over(&self, plane: u32) -> (f64, f64) {
        let plane = &self.tables.planes[plane as usize];
        let [p, q] = plane.slope;
        let (from, along) = (self.from, self.along);
        (from.z - p * from.x - q * from.y - plane.height, along.z - p * along.x - q * along.y)
    }

    /// The root of the detail of a cell that the ray leaves.
    #[inline(always)]
    pub(super) fn root(&self, cell: u32) -> u32 {
        let step = &self.tables.steps[cell as usize];
        if step.is_some() { step.root } else { self.tables.cells[cell as usize].root }
    }

    /// Where the ray leaves a prism of air; if it is the `FIRST`, it must start in it.
    #[inline(always)]
    pub(super) fn leave<L: Lanes, const FIRST: bool>(&self, cell: u32) -> Option<Exit> {
        let step = self.tables.steps.get(cell as usize)?;
        if !step.is_some() {
            return self.leave_any::<FIRST>(cell);
        }
        let (x, y) = (L::load(&step.x), L::load(&step.y));
        let (index, [right, left]) =
            if self.scattered { self.edge_of_all(x, y)? } else { self.edge_by_edge(step)? };
        let next = (index + 1) % LANES;
        let (a, b) = ([step.x[index], step.y[index]], [step.x[next], step.y[next]]);
        let [ex, ey] = edge(a, b);
        let per = 1.0 / (left - right);
        let t = self.crossing(a, [ex, ey]) * per;
        let [floor, ceiling] = [f64::from(step.height[0]), f64::from(step.height[1])];
        if FIRST {
            let (ex, ey) = (x.rotate().sub(x), y.rotate().sub(y));
            let (px, py) = (L::splat(self.from.x as f32).sub(x), L::splat(self.from.y as f32).sub(y));
            let is_behind = L::bits(ey.mul(px).le(ex.mul(py))) == 0xff;
            if !(is_behind && t >= 0.0 && self.from.z >= floor && self.from.z <= ceiling) {
                return if floor.is_nan() || ceiling.is_nan() { self.leave_any::<FIRST>(cell) } else { None };
            }
        }
        // Its height where it leaves the footprint, beside how far that of one aside is from there.
        let height = self.from.z + t * self.along.z;
        let blur = BLURRED * (2.0 + (ex.abs() + ey.abs()) * per * self.along.z.abs());
        if height >= floor + blur && height <= ceiling - blur {
            let link = step.next[index];
            if link & (Step::PLATE | Step::SPLIT) == Step::SPLIT {
                return self.split(link & !Step::SPLIT, t, [right, left], height, blur);
            }
            if link == Step::PARTS {
                let (first, end) =
                    (step.side[index], if index + 1 < LANES { step.side[index + 1] } else { 0 });
                return self.part(cell, Edge { side: first.into(), a, b }, end.into(), t, per);
            }
            let is_clear = -right >= self.blurred && left >= self.blurred;
            return is_clear.then_some(Exit { t, link });
        }
        let (plane, vertical) = if height <= floor - blur {
            (floor, 0)
        } else if height >= ceiling + blur {
            (ceiling, 1)
        } else if floor.is_nan() || ceiling.is_nan() {
            return self.leave_any::<FIRST>(cell);
        } else {
            return None;
        };
        let t = (plane - self.from.z) * self.steep;
        let at = [self.from.x + t * self.along.x, self.from.y + t * self.along.y];
        // Well within the border there: also of sides that it runs along and never comes to.
        /// Somewhat more, for what f32 adds.
        const MARGIN: f32 = 1.25 * BLURRED as f32;
        let (inward, size) = step.inward::<L>(at);
        if L::bits(size.mul(L::splat(MARGIN)).le(inward)) != 0xff {
            return None;
        }
        match step.vertical[vertical] {
            Step::PARTS => self.cover(cell, vertical == 0, t, at, self.along.z),
            link => Some(Exit { t, link }),
        }
    }

    /// Where the ray passes an edge of a simple prism, or its floor or its ceiling: as `leave` has it.
    #[inline(always)]
    pub(super) fn passes(&self, step: &Step, index: usize) -> f64 {
        if index >= LANES {
            return (f64::from(step.height[index - LANES]) - self.from.z) * self.steep;
        }
        let next = (index + 1) % LANES;
        let (a, b) = ([step.x[index], step.y[index]], [step.x[next], step.y[next]]);
        let per = 1.0 / (self.side(b) - self.side(a));
        self.crossing(a, edge(a, b)) * per
    }

    /// The part of an edge that the ray leaves through, and the face of that, of those from the `first` on.
    #[inline(always)]
    fn split(
        &self,
        first: u32,
        t: f64,
        [mut right, mut left]: [f64; 2],
        height: f64,
        blur: f64,
    ) -> Option<Exit> {
        let mut rest = self.tables.parts.get(first as usize..)?.iter();
        let mut part = rest.next()?;
        while part.last == 0 {
            let next = rest.next()?;
            let side = self.side(next.start);
            if side >= 0.0 {
                left = side;
                break;
            }
            (part, right) = (next, side);
        }
        let over = height - f64::from(part.top[0]);
        let over_next = height - f64::from(part.top[1]);
        let is_clear =
            -right >= self.blurred && left >= self.blurred && over.abs() >= blur && over_next.abs() >= blur;
        let face = usize::from(over > 0.0) + usize::from(over_next > 0.0);
        is_clear.then_some(Exit { t, link: part.link[face] })
    }

    /// The part of an edge that the ray leaves through: of the sides up to `end`, or the last of all if that is 0, the last that starts
    /// on its right, and of the faces of that the one at its height there.
    #[inline(never)]
    fn part(&self, cell: u32, edge_: Edge, end: usize, t: f64, per: f64) -> Option<Exit> {
        let tables = self.tables;
        let record = &tables.cells[cell as usize];
        let first = record.first_side as usize;
        let sides = &tables.sides[first..first + record.sides as usize];
        let end = if end == 0 { sides.len() } else { end };
        let [ex, ey] = edge(edge_.a, edge_.b);
        let slant = (ex.abs() + ey.abs()) * per;
        let Edge { side: mut index, mut a, mut b } = edge_;
        for (side, number) in sides[index..end].iter().zip(index..).skip(1) {
            if self.side(side.start) >= 0.0 {
                b = side.start;
                break;
            }
            (index, a) = (number, side.start);
        }
        if !(-self.side(a) >= self.blurred && self.side(b) >= self.blurred) {
            return None;
        }
        self.face(&sides[index], t, slant)
    }

    /// The face of a side at the ray's height there.
    #[inline(always)]
    fn face(&self, side: &SideRecord, t: f64, slant: f64) -> Option<Exit> {
        let first = side.first_face as usize;
        let faces = &self.tables.faces[first..first + side.faces as usize];
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
        self.link(t, face.cell, face.source, face.flags)
    }

    #[inline(always)]
    fn link(&self, t: f64, cell: u32, source: u32, flags: u16) -> Option<Exit> {
        let link = link(self.tables, cell, source, flags)?;
        Some(Exit { t, link })
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
        let (right, left) = (self.side(a), self.side(b));
        if !(-right >= self.blurred && left >= self.blurred) {
            return None;
        }
        let [ex, ey] = edge(a, b);
        let per = 1.0 / (left - right);
        let t = self.crossing(a, [ex, ey]) * per;
        let slant = (ex.abs() + ey.abs()) * per;
        let (floor, falls) = self.over(record.floor);
        let (ceiling, rises) = self.over(record.ceiling);
        if FIRST {
            let is_behind = self.crossing(into.a, edge(into.a, into.b)) >= 0.0;
            if !(is_behind && t >= 0.0 && floor >= 0.0 && ceiling <= 0.0) {
                return None;
            }
        }
        // Over the floor and under the ceiling where it leaves the footprint, beside how far one aside is from there.
        let (over, under) = (floor + t * falls, -(ceiling + t * rises));
        let blur = |grows: f64| BLURRED * (2.0 + slant * grows.abs());
        let (blur_floor, blur_ceiling) = (blur(falls), blur(rises));
        if over >= blur_floor && under >= blur_ceiling {
            return self.face(&sides[side], t, slant);
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
        if is_within { self.cover(cell, is_down, t, at, grows) } else { None }
    }

    /// The part of a floor or ceiling that the ray passes.
    #[inline(never)]
    fn cover(&self, cell: u32, is_down: bool, t: f64, at: [f64; 2], grows: f64) -> Option<Exit> {
        let tables = self.tables;
        let record = &tables.cells[cell as usize];
        let first = record.first_cover as usize;
        let (below, above) = (record.below as usize, record.above as usize);
        let covers = if is_down { first..first + below } else { first + below..first + below + above };
        let covers: &[CoverRecord] = &tables.covers[covers];
        if let [only] = covers {
            return self.link(t, only.cell, only.source, only.flags);
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
                return self.link(t, cover.cell, cover.source, cover.flags);
            }
            if is_beside {
                return None;
            }
        }
        None
    }
}

/// Where a face leads that has a cell and a source behind it.
#[inline(always)]
pub(super) fn link(tables: &Views, cell: u32, source: u32, flags: u16) -> Option<u32> {
    let kind = tables.cells[cell as usize].kind;
    match kind {
        CellRecord::AIR if source == NONE => Some(cell),
        CellRecord::AROUND if source == NONE => Some(Step::AROUND),
        CellRecord::SOLID if source != NONE && flags == PLAIN => Some(Step::PLATE | source),
        _ => None,
    }
}

/// From one corner to another. Not by `array::map`, which is not always inlined.
#[inline(always)]
fn edge(a: [f32; 2], b: [f32; 2]) -> [f64; 2] {
    [f64::from(b[0]) - f64::from(a[0]), f64::from(b[1]) - f64::from(a[1])]
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::generate::{
        Building, HouseOptions, OfficeOptions, Style, TowerOptions, build1, house, random, tower,
    };
    use crate::splitmix::SplitMix64;
    use crate::trace::kernel::Ask;
    use crate::trace::single::surface_of;
    use crate::trace::{Kernel, Place, Start, Want};
    use crate::{CompileOptions, Scene, compile};

    fn scene(building: &Building, style: &Style) -> Scene {
        compile(&building.export(style).to_model().unwrap(), &CompileOptions::default()).unwrap().scene()
    }

    fn from<'a>(cell: u32, surface: Option<&'a Surface>) -> Departure<'a> {
        Departure { cell, surface, scattered: false }
    }

    /// Rays from the air of the zone, half of them through places in rooms, the cells in which they start.
    fn rays(scene: &Scene, count: usize, seed: u64) -> Vec<(u32, Ray)> {
        let mut random = SplitMix64::new(seed);
        let [lo, hi] = scene.hull();
        let boxes: Vec<[[f64; 3]; 2]> = scene.rooms().map(|room| room.bounds()).chain([[lo, hi]]).collect();
        let mut rays = Vec::new();
        while rays.len() < count {
            let [lo, hi] = boxes[random.below(boxes.len() as u64) as usize];
            let from = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
            let to = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
            let Place::Air { cell, .. } = scene.locate(from) else { continue };
            let way = DVec3::from(to) - DVec3::from(from);
            let mut ray = Ray::new(from, way.to_array());
            if random.below(4) == 0 {
                ray.tmax = way.length();
            }
            rays.push((cell, ray));
        }
        rays
    }

    /// That it answers nearly all, and as the careful walk does: the same on all kernels.
    fn check(name: &str, scene: &Scene, share: f64) {
        let rays = rays(scene, 40_000, 5);
        let (mut quick, mut hits) = (0, 0);
        for (cell, ray) in &rays {
            let found: Vec<Option<Quick>> = Kernel::available()
                .into_iter()
                .map(|k| k.quick(Ask::First, &scene.tables, ray, &from(*cell, None)))
                .collect();
            let parts =
                |q: &Option<Quick>| q.map(|q| (q.found.t.to_bits(), q.found.triangle, q.cell, q.source));
            assert!(found.iter().all(|q| parts(q) == parts(&found[0])), "{name}: {ray:?} {found:?}");
            let scattered = scene.kernel.quick(
                Ask::First,
                &scene.tables,
                ray,
                &Departure { scattered: true, ..from(*cell, None) },
            );
            assert_eq!(parts(&scattered), parts(&found[0]), "{name}: {ray:?}");
            let any = scene.kernel.quick(Ask::Any, &scene.tables, ray, &from(*cell, None));
            let Some(Quick { found, .. }) = found[0] else { continue };
            quick += 1;
            let careful = scene.careful(Start::Cell(*cell), ray, Want::LEAST);
            assert_eq!(
                found.triangle == NONE,
                careful.triangle == NONE,
                "{name}: {ray:?} {found:?} {careful:?}"
            );
            assert_eq!(
                any.map(|any| any.found.triangle == NONE),
                Some(found.triangle == NONE),
                "{name}: {ray:?}"
            );
            if found.triangle != NONE {
                hits += 1;
                // The plane of a source's triangles is theirs to a micrometre.
                assert!(
                    (found.t - careful.t).abs() <= 1e-6 / GRAZING,
                    "{name}: {ray:?} {found:?} {careful:?}"
                );
            }
        }
        let answered = f64::from(quick) / rays.len() as f64;
        assert!(
            answered >= share && hits > quick / 4,
            "{name}: {answered} of the rays, {hits} hits of {quick}"
        );
    }

    #[test]
    fn it_answers_as_the_careful_walk_does() {
        check("house", &scene(&house(&HouseOptions::default()), &Style::exact()), 0.98);
        let office = |seed| OfficeOptions { seed, ..OfficeOptions::default() };
        // With an attic under sloped roofs, a round end, an oblique wing; floors that reach over several storeys.
        check("build1", &scene(&build1(&office(0)), &Style::exact()), 0.98);
        check(
            "tower",
            &scene(&tower(&TowerOptions { office: office(0), ..TowerOptions::default() }), &Style::exact()),
            0.9,
        );
        for seed in 1..4 {
            check(&format!("random {seed}"), &scene(&random(&office(seed)), &Style::exact()), 0.9);
            // Corners a hair aside each: hardly two triangles in one plane, and not many rays are left to it.
            check(&format!("random cad {seed}"), &scene(&random(&office(seed)), &Style::cad(seed)), 0.1);
        }
    }

    /// The same of rays from what others met, to the side that they came from, and flat along it.
    fn check_from_surfaces(name: &str, scene: &Scene, share: f64) {
        let mut random = SplitMix64::new(11);
        let (mut quick, mut all) = (0, 0);
        for (cell, ray) in rays(scene, 20_000, 6) {
            let hit = scene.trace_from(Start::Cell(cell), &ray, Want::LEAST);
            let normal = DVec3::from(hit.normal);
            if hit.triangle == NONE {
                continue;
            }
            let mut way = DVec3::from([0, 1, 2].map(|_| random.between(-1.0, 1.0)));
            way *= way.dot(normal).signum();
            match random.below(8) {
                0 => way -= normal * way.dot(normal) * 0.999,
                1 => way = -way,
                _ => {}
            }
            let mut onward = Ray::new(hit.point, way.to_array());
            if random.below(4) == 0 {
                onward.tmax = random.between(0.0, 4.0);
            }
            let surface = surface_of(&hit, DVec3::from(onward.origin), onward.tmin);
            let ask = |kernel: Kernel| {
                kernel.quick(Ask::First, &scene.tables, &onward, &from(hit.cell, Some(&surface)))
            };
            let found: Vec<Option<Quick>> = Kernel::available().into_iter().map(ask).collect();
            let parts =
                |q: &Option<Quick>| q.map(|q| (q.found.t.to_bits(), q.found.triangle, q.cell, q.source));
            assert!(found.iter().all(|q| parts(q) == parts(&found[0])), "{name}: {onward:?} {found:?}");
            let careful = scene.careful(Start::Hit(&hit), &onward, Want::LEAST);
            assert_eq!(
                scene.occluded_from(Start::Hit(&hit), &onward),
                careful.triangle != NONE,
                "{name}: {hit:?} {onward:?} {careful:?}"
            );
            all += 1;
            let Some(Quick { found, .. }) = found[0] else { continue };
            quick += 1;
            let is_same = found.triangle == NONE || (found.t - careful.t).abs() <= 1e-6 / GRAZING;
            assert!(
                (found.triangle == NONE) == (careful.triangle == NONE) && is_same,
                "{name}: {hit:?} {onward:?} {found:?} {careful:?}"
            );
        }
        assert!(f64::from(quick) >= share * f64::from(all) && all > 10_000, "{name}: {quick} of {all} rays");
    }

    #[test]
    fn from_surfaces_it_answers_as_the_careful_walk_does() {
        check_from_surfaces("house", &scene(&house(&HouseOptions::default()), &Style::exact()), 0.7);
        let office = |seed| OfficeOptions { seed, ..OfficeOptions::default() };
        check_from_surfaces("build1", &scene(&build1(&office(0)), &Style::exact()), 0.7);
        for seed in 1..3 {
            check_from_surfaces(
                &format!("random {seed}"),
                &scene(&random(&office(seed)), &Style::exact()),
                0.6,
            );
            check_from_surfaces(
                &format!("cad {seed}"),
                &scene(&random(&office(seed)), &Style::cad(seed)),
                0.0,
            );
        }
    }

    #[test]
    fn what_is_no_ray_or_starts_elsewhere_is_left_to_others() {
        let scene = scene(&house(&HouseOptions::default()), &Style::exact());
        let (cell, ray) = rays(&scene, 1, 3)[0];
        let quick = |cell: u32, ray: Ray| {
            scene.kernel.quick(Ask::First, &scene.tables, &ray, &from(cell, None)).is_some()
        };
        for component in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!quick(cell, Ray { origin: [component, 0.0, 0.0], ..ray }));
            assert!(!quick(cell, Ray { direction: [0.0, component, 0.0], ..ray }));
        }
        assert!(!quick(cell, Ray { direction: [0.0; 3], ..ray }));
        assert!(!quick(cell, Ray { tmax: f64::NAN, ..ray }) && !quick(cell, Ray { tmin: 0.1, ..ray }));
        assert!(!quick(0, ray) && !quick(NONE, ray));
        let other = (0..scene.cells().len() as u32).filter(|&other| other != cell);
        assert!(other.into_iter().all(|other| !quick(other, ray)), "a ray starts in one cell only");
    }
}
