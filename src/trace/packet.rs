//! The quick way of eight rays at once, each in its own prism.
//!
//! A lane is a ray: all of them are taken out of their prisms by the same instructions, in f32. Where that is in doubt, more so than
//! `quick` would be, the ray is asked about by `quick` itself; and what a face holds, or detail, is looked up by what `quick` uses. So it
//! answers the same, to the last bit, on every kernel.

use glam::DVec3;

use super::NONE;
use super::kernel::Probe;
use super::lanes::Lanes;
use super::path::{BLURRED, NEAR};
use super::quick::{GRAZING, Quick, STEEPEST, UNIT, Way};
use super::ray::Ray;
use super::step::Step;
use super::walk::{Found, LEAST, each};
use crate::format::Views;
use crate::format::records::{BLOCK_BIT, LANES, NodeRecord};

/// Fewer rays are no packet.
const FEW: u32 = 2;

/// A number of each ray.
type Each = [f64; LANES];

/// What rays meet. Lane i is bit i of masks.
#[derive(Clone, Copy)]
pub(super) struct Answers {
    /// Those that are answered.
    pub(super) known: u32,
    t: Each,
    triangle: [u32; LANES],
    cell: [u32; LANES],
    source: [u32; LANES],
}

impl Answers {
    pub(super) const NONE: Answers = Answers {
        known: 0,
        t: [0.0; LANES],
        triangle: [NONE; LANES],
        cell: [NONE; LANES],
        source: [NONE; LANES],
    };

    /// The answer of a ray, if it is known.
    #[inline(always)]
    pub(super) fn get(&self, lane: usize) -> Option<Quick> {
        let found = Found { t: self.t[lane], triangle: self.triangle[lane] };
        (self.known >> lane & 1 != 0).then_some(Quick {
            found,
            cell: self.cell[lane],
            source: self.source[lane],
        })
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, quick: &Quick) {
        self.known |= 1 << lane;
        (self.t[lane], self.triangle[lane]) = (quick.found.t, quick.found.triangle);
        (self.cell[lane], self.source[lane]) = (quick.cell, quick.source);
    }
}

/// What the first `count` rays meet that is in no doubt, each starting in its cell.
#[inline(always)]
pub(super) fn packet<L: Lanes, P: Probe>(
    tables: &Views,
    rays: &[&Ray; LANES],
    count: usize,
    cells: &mut [u32; LANES],
    answers: &mut Answers,
    probe: &mut P,
) {
    answers.known = 0;
    let mut packet = Packet::<L>::new(tables, rays, count);
    for (lane, &cell) in cells.iter().enumerate() {
        if cell as usize >= tables.steps.len() {
            packet.under_way &= !(1 << lane);
        }
    }
    if packet.under_way == 0 {
        return;
    }
    packet.step::<true, P>(cells, answers, probe);
    // Each once.
    for _ in 1..tables.cells.len() {
        if packet.under_way.count_ones() <= FEW {
            break;
        }
        packet.step::<false, P>(cells, answers, probe);
    }
    packet.finish(cells, answers, probe);
}

/// Rays under way.
struct Packet<'a, 'r, L> {
    tables: &'a Views,
    rays: &'r [&'r Ray; LANES],
    /// Those that have neither ended nor come into doubt.
    under_way: u32,
    /// As `Way` has it.
    origin: [Each; 3],
    direction: [Each; 3],
    limit: Each,
    /// Along the lattice's axes, from its origin.
    from: [[f32; LANES]; 3],
    along: [[f32; LANES]; 3],
    /// The direction's length in the plan.
    flat: L,
    /// 1 by the third component of `along`.
    steep: L,
    /// More than rounding moves a line, metres.
    rounding: f32,
}

/// Where rays leave their prisms.
struct Crossed<L> {
    /// Where that is in no doubt.
    known: u32,
    /// Through a side, which part of it is not looked at.
    through_side: u32,
    /// The sides of the line that the edge's ends are on.
    ends: [L; 2],
    height: L,
    /// Farther than that from `height` one aside is not.
    blur: L,
    /// The number of the edge, as bits; [`DOWN`] or [`UP`].
    edge: L,
    t: L,
    /// More than `t` is off.
    off: L,
}

/// In the place of an edge: the floor, the ceiling.
const DOWN: usize = LANES;
const UP: usize = LANES + 1;

impl<'a, 'r, L: Lanes> Packet<'a, 'r, L> {
    #[inline(always)]
    fn new(tables: &'a Views, rays: &'r [&'r Ray; LANES], count: usize) -> Self {
        let scene = &tables.scene[0];
        let mut under_way = 0;
        let (mut origin, mut direction, mut limit) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3], [0.0; LANES]);
        for (lane, ray) in rays.iter().enumerate() {
            for axis in 0..3 {
                origin[axis][lane] = ray.origin[axis];
                direction[axis][lane] = ray.direction[axis];
            }
            limit[lane] = ray.tmax;
            under_way |= u32::from(lane < count && ray.tmin == 0.0 && ray.tmax >= 0.0) << lane;
        }
        under_way &= unit(&mut direction);
        let mut from = [[0.0f32; LANES]; 3];
        let mut along = from;
        let [cos, sin] = scene.lattice_turn;
        let [x0, y0, z0] = scene.lattice_origin;
        for lane in 0..LANES {
            let (x, y) = (origin[0][lane] - x0, origin[1][lane] - y0);
            from[0][lane] = (x * cos + y * sin) as f32;
            from[1][lane] = (y * cos - x * sin) as f32;
            from[2][lane] = (origin[2][lane] - z0) as f32;
            let (x, y) = (direction[0][lane], direction[1][lane]);
            along[0][lane] = (x * cos + y * sin) as f32;
            along[1][lane] = (y * cos - x * sin) as f32;
            along[2][lane] = direction[2][lane] as f32;
        }
        let flat = L::load(&along[0]).abs().add(L::load(&along[1]).abs());
        under_way &= L::bits(L::splat(1.01 * STEEPEST as f32).le(flat));
        let [lo, hi] = scene.zone;
        let reach = lo.iter().chain(&hi).fold(0.0, |reach: f64, c| reach.max(c.abs()));
        Packet {
            tables,
            rays,
            under_way,
            origin,
            direction,
            limit,
            from,
            along,
            flat,
            steep: L::splat(1.0).div(L::load(&along[2])),
            // Sixteen roundings.
            rounding: (reach * (-20f64).exp2()) as f32,
        }
    }

    /// The lanes of a mask.
    #[inline(always)]
    fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
        std::iter::from_fn(move || {
            (mask != 0).then(|| {
                let lane = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                lane
            })
        })
    }

    /// A ray by itself.
    #[inline(always)]
    fn way(&self, lane: usize) -> Option<Way<'a>> {
        Way::new(self.tables, self.rays[lane])
    }

    /// Takes the rays out of their prisms: some of them end there.
    #[inline(always)]
    fn step<const FIRST: bool, P: Probe>(
        &mut self,
        cells: &mut [u32; LANES],
        answers: &mut Answers,
        probe: &mut P,
    ) {
        let tables = self.tables;
        let steps = &tables.steps;
        let lead = cells[self.under_way.trailing_zeros() as usize];
        let mut is_one = true;
        for (lane, cell) in cells.iter_mut().enumerate() {
            if self.under_way >> lane & 1 == 0 {
                *cell = lead;
            }
            is_one &= *cell == lead;
        }
        let mut links = [0; LANES];
        let crossed;
        if is_one {
            let step = &steps[lead as usize];
            let corner = |k: usize| (L::splat(step.x[k % LANES]), L::splat(step.y[k % LANES]));
            let [floor, ceiling] = step.height;
            crossed = self.cross::<FIRST>(step.corners.into(), corner, L::splat(floor), L::splat(ceiling));
            let edges = crossed.edge.store();
            let mut table = [Step::PARTS; 2 * LANES];
            table[..LANES].copy_from_slice(&step.next);
            (table[DOWN], table[UP]) = (step.vertical[0], step.vertical[1]);
            for lane in 0..LANES {
                links[lane] = table[edges[lane].to_bits() as usize % (2 * LANES)];
            }
        } else {
            let record = |lane: usize| &steps[cells[lane] as usize];
            let rows = |of: fn(&Step) -> &[f32; LANES]| {
                let mut rows = [L::splat(0.0); LANES];
                for (lane, row) in rows.iter_mut().enumerate() {
                    *row = L::load(of(record(lane)));
                }
                L::transpose(rows)
            };
            let (x, y) = (rows(|step| &step.x), rows(|step| &step.y));
            let mut heights = [[0.0; LANES]; 2];
            let mut count = 0;
            for lane in 0..LANES {
                let step = record(lane);
                (heights[0][lane], heights[1][lane]) = (step.height[0], step.height[1]);
                count = step.corners.max(count);
            }
            let corner = |k: usize| (x[k % LANES], y[k % LANES]);
            crossed = self.cross::<FIRST>(count.into(), corner, L::load(&heights[0]), L::load(&heights[1]));
            let edges = crossed.edge.store();
            for lane in 0..LANES {
                let (step, edge) = (record(lane), edges[lane].to_bits() as usize);
                links[lane] =
                    if edge < LANES { step.next[edge] } else { step.vertical[usize::from(edge == UP)] };
            }
        }
        // What matters of detail is before this.
        let mut until = crossed.t.add(crossed.off).store();
        // Where a face ends the way.
        let mut plates = Plates::new();
        let ends = each([crossed.ends[0], crossed.ends[1], self.flat], L::store);
        let (height, blur) = (crossed.height.store(), crossed.blur.store());
        for lane in Self::lanes(self.under_way) {
            let bit = 1 << lane;
            let mut is_known = crossed.known & bit != 0;
            if crossed.through_side & bit != 0 && links[lane] & (Step::PLATE | Step::SPLIT) == Step::SPLIT {
                let sides = each(ends, |sides| sides[lane]);
                let link = self.split(lane, links[lane] & !Step::SPLIT, sides, height[lane], blur[lane]);
                is_known = link.is_some();
                links[lane] = link.unwrap_or(Step::OTHER);
            }
            if !is_known || links[lane] >= Step::AROUND {
                let Some(way) = self.way(lane) else {
                    self.under_way &= !bit;
                    continue;
                };
                let cell = cells[lane];
                let exit = if !FIRST || (crossed.known | crossed.through_side) & bit != 0 {
                    way.leave::<L, false>(cell)
                } else {
                    way.leave::<L, true>(cell)
                };
                let Some(exit) = exit else {
                    self.under_way &= !bit;
                    continue;
                };
                if exit.link == Step::AROUND {
                    self.under_way &= !bit;
                    if let Some(quick) = way.onward::<L>(cell, exit, probe) {
                        answers.put(lane, &quick);
                    }
                    continue;
                }
                links[lane] = exit.link;
                until[lane] = (exit.t + exit.t.abs() * 1e-6 + NEAR) as f32;
            }
            if links[lane] & Step::PLATE != 0 && !plates.add(tables, lane, links[lane] & !Step::PLATE) {
                self.under_way &= !bit;
            }
        }
        let mut ends = [f64::INFINITY; LANES];
        if plates.lanes != 0 {
            let sure = plates.meet(&self.origin, &self.direction, &mut ends);
            self.under_way &= sure | !plates.lanes;
            for lane in 0..LANES {
                until[lane] = if ends[lane] < f64::INFINITY { ends[lane] as f32 } else { until[lane] };
            }
        }
        for lane in 0..LANES {
            until[lane] = until[lane].min(self.limit[lane] as f32);
        }
        let touched = if self.under_way == 0 { 0 } else { self.touched(cells, is_one, &until, probe) };
        for lane in Self::lanes(touched) {
            let (cell, bit) = (cells[lane], 1 << lane);
            let Some(way) = self.way(lane) else { continue };
            let end = Found { t: ends[lane], triangle: plates.triangle[lane] };
            let t = if plates.lanes & bit != 0 {
                end.t
            } else {
                let Some(exit) = way.leave::<L, false>(cell) else {
                    self.under_way &= !bit;
                    continue;
                };
                exit.t
            };
            let found = way.detail(way.root(cell), [0.0, (t + NEAR).min(way.limit)], probe);
            if found.triangle != NONE && (found.t, found.triangle) < (end.t, end.triangle) {
                (ends[lane], plates.triangle[lane], plates.source[lane]) = (found.t, found.triangle, NONE);
                plates.lanes |= bit;
            }
        }
        let ended = plates.lanes & self.under_way;
        for lane in Self::lanes(ended) {
            let triangle = if ends[lane] <= self.limit[lane] { plates.triangle[lane] } else { NONE };
            (answers.t[lane], answers.triangle[lane]) = (ends[lane], triangle);
            (answers.cell[lane], answers.source[lane]) = (cells[lane], plates.source[lane]);
        }
        answers.known |= ended;
        self.under_way &= !ended;
        *cells = links;
    }

    /// The part of an edge that a ray leaves through, as `Way::split` has it: where it leads.
    #[inline(always)]
    fn split(
        &self,
        lane: usize,
        first: u32,
        [mut right, mut left, flat]: [f32; 3],
        height: f32,
        blur: f32,
    ) -> Option<u32> {
        let ([fx, fy, _], [ax, ay, _]) =
            (each(self.from.each_ref(), |v| v[lane]), each(self.along.each_ref(), |v| v[lane]));
        let mut rest = self.tables.parts.get(first as usize..)?.iter();
        let mut part = rest.next()?;
        while part.last == 0 {
            let next = rest.next()?;
            let side = ax * (next.start[1] - fy) - ay * (next.start[0] - fx);
            if side >= 0.0 {
                left = side;
                break;
            }
            (part, right) = (next, side);
        }
        let least = (BLURRED as f32 + self.rounding) * flat;
        let (over, over_next) = (height - part.top[0], height - part.top[1]);
        let is_clear = -right >= least && left >= least && over.abs() >= blur && over_next.abs() >= blur;
        let face = usize::from(over > 0.0) + usize::from(over_next > 0.0);
        is_clear.then_some(part.link[face])
    }

    /// The rays that are left, each by itself.
    #[inline(always)]
    fn finish<P: Probe>(&self, cells: &[u32; LANES], answers: &mut Answers, probe: &mut P) {
        for lane in Self::lanes(self.under_way) {
            if let Some(way) = self.way(lane)
                && let Some(exit) = way.leave::<L, false>(cells[lane])
                && let Some(quick) = way.onward::<L>(cells[lane], exit, probe)
            {
                answers.put(lane, &quick);
            }
        }
    }

    /// Where the rays leave prisms whose footprints have up to `count` corners.
    #[inline(always)]
    fn cross<const FIRST: bool>(
        &self,
        count: usize,
        corner: impl Fn(usize) -> (L, L),
        floor: L,
        ceiling: L,
    ) -> Crossed<L> {
        let zero = L::splat(0.0);
        let [fx, fy, fz] = load(&self.from);
        let [ax, ay, az]: [L; 3] = load(&self.along);
        let rounding = L::splat(self.rounding);
        let margin = L::splat(BLURRED as f32 + self.rounding);
        let at = |k: usize| {
            let (x, y) = corner(k);
            let (dx, dy) = (x.sub(fx), y.sub(fy));
            (dx, dy, ax.mul_sub(dy, ay.mul(dx)))
        };
        let (mut dx, mut dy, mut side) = at(0);
        let mut is_left = zero.le(side);
        let mut inside = is_left;
        if FIRST {
            inside = L::and(floor.add(rounding).le(fz), fz.le(ceiling.sub(rounding)));
        }
        let (mut edge, mut right, mut left) = (zero, zero, zero);
        let (mut from_x, mut from_y, mut to_x, mut to_y) = (zero, zero, zero, zero);
        for k in 0..count {
            let (next_x, next_y, next) = at(k + 1);
            let is_next_left = zero.le(next);
            let here = L::and_not(is_left, is_next_left);
            edge = L::select(here, L::splat(f32::from_bits(k as u32)), edge);
            (from_x, from_y) = (L::select(here, dx, from_x), L::select(here, dy, from_y));
            (to_x, to_y) = (L::select(here, next_x, to_x), L::select(here, next_y, to_y));
            (right, left) = (L::select(here, side, right), L::select(here, next, left));
            if FIRST {
                let (ex, ey) = (next_x.sub(dx), next_y.sub(dy));
                let inward = ey.mul_sub(dx, ex.mul(dy));
                inside = L::and(inside, rounding.mul(ex.abs().add(ey.abs())).le(inward));
            }
            (dx, dy, side, is_left) = (next_x, next_y, next, is_next_left);
        }
        let (ex, ey) = (to_x.sub(from_x), to_y.sub(from_y));
        let per = L::splat(1.0).div(left.sub(right));
        let mut t = from_x.mul_sub(ey, from_y.mul(ex)).mul(per);
        let slant = ex.abs().add(ey.abs()).mul(per);
        let height = t.mul_add(az, fz);
        let blur = margin.mul(slant.mul_add(az.abs(), L::splat(2.0)));
        let mut ahead = zero.le(t);
        if FIRST {
            ahead = L::and(ahead, inside);
        }
        let within = L::and(floor.add(blur).le(height), height.le(ceiling.sub(blur)));
        let least = margin.mul(self.flat);
        let clear = L::and(least.le(zero.sub(right)), least.le(left));
        let within = L::and(within, ahead);
        let through_side = L::bits(within);
        let mut known = L::bits(L::and(within, clear));
        let mut off = rounding.mul(slant.add(L::splat(2.0)));
        let (down, up) = (height.le(floor.sub(blur)), ceiling.add(blur).le(height));
        let vertical = L::and(L::or(down, up), ahead);
        if L::bits(vertical) & self.under_way != 0 {
            let plane = L::select(down, floor, ceiling);
            let steeply = plane.sub(fz).mul(self.steep);
            let (px, py) = (steeply.mul(ax), steeply.mul(ay));
            // The same as there, of how much rounding moves the place.
            let tilt = self.steep.abs().add(L::splat(2.0));
            let margin = rounding.mul_add(tilt, L::splat(1.5 * BLURRED as f32));
            let mut inside = vertical;
            let at = |k: usize| {
                let (x, y) = corner(k);
                (x.sub(fx).sub(px), y.sub(fy).sub(py))
            };
            let (mut dx, mut dy) = at(0);
            for k in 0..count {
                let (next_x, next_y) = at(k + 1);
                let (ex, ey) = (next_x.sub(dx), next_y.sub(dy));
                let inward = ey.mul_sub(dx, ex.mul(dy));
                inside = L::and(inside, margin.mul(ex.abs().add(ey.abs())).le(inward));
                (dx, dy) = (next_x, next_y);
            }
            known |= L::bits(inside);
            let number = |number: usize| L::splat(f32::from_bits(number as u32));
            edge = L::select(vertical, L::select(down, number(DOWN), number(UP)), edge);
            t = L::select(vertical, steeply, t);
            off = L::select(vertical, rounding.mul(tilt), off);
        }
        Crossed { known, through_side, ends: [right, left], height, blur, edge, t, off }
    }

    /// The rays that come to a box of the detail of their cells before `until`.
    #[inline(always)]
    fn touched<P: Probe>(
        &self,
        cells: &[u32; LANES],
        is_one: bool,
        until: &[f32; LANES],
        probe: &mut P,
    ) -> u32 {
        let tables = self.tables;
        let root = |lane: usize| {
            let step = &tables.steps[cells[lane] as usize];
            if step.is_some() { step.root } else { tables.cells[cells[lane] as usize].root }
        };
        if is_one {
            return match root(0) {
                NONE => 0,
                root if root & BLOCK_BIT != 0 => self.under_way,
                root => self.under_way & self.touched_boxes(&tables.nodes[root as usize], until),
            };
        }
        let mut touched = 0;
        for lane in Self::lanes(self.under_way) {
            let root = root(lane);
            let is_touched = root != NONE
                && (root & BLOCK_BIT != 0
                    || self.way(lane).is_some_and(|way| {
                        way.touches::<L>(root, f64::from(until[lane]) * (1.0 + 1e-6) + NEAR, probe)
                    }));
            touched |= u32::from(is_touched) << lane;
        }
        touched
    }

    /// The rays that come to any of a node's boxes before `until`.
    #[inline(always)]
    fn touched_boxes(&self, node: &NodeRecord, until: &[f32; LANES]) -> u32 {
        let scene = &self.tables.scene[0];
        let (mut local, mut toward) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        for axis in 0..3 {
            for lane in 0..LANES {
                local[axis][lane] = (self.origin[axis][lane] - scene.center[axis]) as f32;
                toward[axis][lane] = self.direction[axis][lane] as f32;
            }
        }
        let local = load::<L>(&local);
        let inverse = each(load::<L>(&toward), |d| L::splat(1.0).div(d.abs().max(L::splat(LEAST)).flip(d)));
        let slack = L::splat(scene.slack);
        let until = L::load(until);
        let until = until.mul_add(L::splat(2e-6), until).add(slack);
        let mut touched = 0;
        for child in 0..LANES {
            if node.child[child] == NONE {
                continue;
            }
            let (mut near, mut far) = (L::splat(0.0).sub(slack), until);
            for axis in 0..3 {
                let (lo, hi) = (L::splat(node.lo[axis][child]), L::splat(node.hi[axis][child]));
                let a = lo.sub(local[axis]).mul(inverse[axis]);
                let b = hi.sub(local[axis]).mul(inverse[axis]);
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            touched |= L::bits(near.le(far));
        }
        touched
    }
}

/// Makes directions unit that are not, as `Way::new` does; which of them it can.
#[inline(always)]
fn unit(direction: &mut [Each; 3]) -> u32 {
    let (mut squared, mut is_unit) = ([0.0; LANES], true);
    for lane in 0..LANES {
        let [x, y, z] = each([0, 1, 2], |axis: usize| direction[axis][lane]);
        squared[lane] = x * x + y * y + z * z;
        is_unit &= (squared[lane] - 1.0).abs() <= UNIT;
    }
    if is_unit {
        return u32::MAX;
    }
    let (mut size, mut can) = ([1.0; LANES], 0);
    for lane in 0..LANES {
        let root = squared[lane].sqrt();
        size[lane] = if (squared[lane] - 1.0).abs() <= UNIT { 1.0 } else { root };
    }
    for (lane, &squared) in squared.iter().enumerate() {
        can |= u32::from(squared > 1e-100 && squared < 1e100) << lane;
    }
    for axis in direction {
        for lane in 0..LANES {
            axis[lane] /= size[lane];
        }
    }
    can
}

/// Three components of each ray.
#[inline(always)]
fn load<L: Lanes>(v: &[[f32; LANES]; 3]) -> [L; 3] {
    [L::load(&v[0]), L::load(&v[1]), L::load(&v[2])]
}

/// The planes behind faces that end the ways of some rays.
struct Plates {
    /// Of which.
    lanes: u32,
    normal: [Each; 3],
    offset: Each,
    triangle: [u32; LANES],
    source: [u32; LANES],
}

impl Plates {
    #[inline(always)]
    fn new() -> Self {
        Plates {
            lanes: 0,
            normal: [[0.0; LANES]; 3],
            offset: [0.0; LANES],
            triangle: [NONE; LANES],
            source: [NONE; LANES],
        }
    }

    /// That of a source; whether there is such a source.
    #[inline(always)]
    fn add(&mut self, tables: &Views, lane: usize, source: u32) -> bool {
        let Some(plate) = tables.plates.get(source as usize) else { return false };
        for axis in 0..3 {
            self.normal[axis][lane] = plate.normal[axis];
        }
        self.offset[lane] = plate.offset;
        (self.triangle[lane], self.source[lane]) = (plate.triangle, source);
        self.lanes |= 1 << lane;
        true
    }

    /// Where the rays meet them, and whether that is in no doubt: as `Way::plate` has it.
    #[inline(always)]
    fn meet(&self, origin: &[Each; 3], direction: &[Each; 3], ends: &mut Each) -> u32 {
        let mut sure = [false; LANES];
        for lane in 0..LANES {
            let [n, o, d] =
                [&self.normal, origin, direction].map(|v| DVec3::new(v[0][lane], v[1][lane], v[2][lane]));
            let toward = n.dot(d);
            let t = (self.offset[lane] - n.dot(o)) / toward;
            sure[lane] = toward.abs() >= GRAZING && t >= 0.0;
            // Of others NaN: no plane.
            ends[lane] = if sure[lane] { t } else { f64::INFINITY };
        }
        let mut bits = 0;
        for (lane, &sure) in sure.iter().enumerate() {
            bits |= u32::from(sure) << lane;
        }
        bits
    }
}
