//! The quick way of eight rays at once, each in its own prism.
//!
//! A lane is a ray: all of them are taken out of their prisms by the same instructions, in f32. Where that is in doubt, more so than
//! `quick` would be, the ray is asked about by `quick` itself; and what a face holds, or detail, is looked up by what `quick` uses. So it
//! answers the same, to the last bit, on every kernel.
//!
//! Rays that leave one prism through one face stay together, and nothing is done for one of them alone; of others each link is looked up
//! by itself. No closure has lanes in it: not all of them are inlined, and what is not has no registers for them.

use super::NONE;
use super::herd::{Herd, Nearest, together};
use super::kernel::Probe;
use super::lanes::{Lanes, Wide};
use super::path::{BLURRED, NEAR};
use super::quick::{COARSEST, GRAZING, Quick, STEEPEST, UNIT, Way, link};
use super::ray::{Brief, Ray};
use super::step::{Part, Step};
use super::walk::{Found, LEAST, Walk};
use crate::format::Views;
use crate::format::records::{BLOCK_BIT, CellRecord, LANES, NodeRecord};

/// Fewer rays are no packet.
const FEW: u32 = 2;

/// All rays.
const ALL: u32 = (1 << LANES) - 1;

/// Eight rays' cells, and what they meet. Lane i is bit i of masks.
pub(super) struct Eight {
    /// In which they start; then, where those are that go on.
    pub(super) cells: [u32; LANES],
    /// Those that are answered.
    pub(super) known: u32,
    /// Infinite where nothing is met.
    t: [f64; LANES],
    triangle: [u32; LANES],
    /// None where nothing is met.
    cell: [u32; LANES],
    source: [u32; LANES],
}

impl Eight {
    pub(super) const NONE: Eight = Eight {
        cells: [NONE; LANES],
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

    /// The same in brief, known or not.
    #[inline(always)]
    pub(super) fn brief(&self, lane: usize) -> Brief {
        Brief { t: self.t[lane], triangle: self.triangle[lane], cell: self.cell[lane] }
    }

    /// An answer; if it is farther than the ray's `limit`, that nothing is met.
    #[inline(always)]
    fn put(&mut self, lane: usize, quick: &Quick, limit: f64) {
        self.known |= 1 << lane;
        let is_met = quick.found.triangle != NONE && quick.found.t <= limit;
        self.t[lane] = if is_met { quick.found.t } else { f64::INFINITY };
        self.triangle[lane] = if is_met { quick.found.triangle } else { NONE };
        self.cell[lane] = if is_met { quick.cell } else { NONE };
        self.source[lane] = quick.source;
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

/// What the first `count` rays meet that is in no doubt, each starting in its cell.
#[inline(always)]
pub(super) fn packet<L: Lanes, P: Probe>(
    tables: &Views,
    rays: &[&Ray; LANES],
    count: usize,
    eight: &mut Eight,
    probe: &mut P,
) {
    eight.known = 0;
    let mut packet = Packet::<L>::new(tables, rays);
    packet.under_way &= ALL >> (LANES - count);
    if eight.cells.iter().fold(0, |most, &cell| cell.max(most)) as usize >= tables.steps.len() {
        for (lane, &cell) in eight.cells.iter().enumerate() {
            packet.under_way &= !(u32::from(cell as usize >= tables.steps.len()) << lane);
        }
    }
    if packet.under_way == 0 || tables.scene[0].lattice_bits < COARSEST {
        return;
    }
    packet.step::<true, P>(eight, probe);
    // Each once.
    for _ in 1..tables.cells.len() {
        if packet.under_way.count_ones() <= FEW {
            break;
        }
        packet.step::<false, P>(eight, probe);
    }
    for lane in lanes(packet.under_way) {
        let cell = eight.cells[lane];
        if let Some(way) = packet.way(lane)
            && let Some(exit) = way.leave::<L, false>(cell)
            && let Some(quick) = way.onward::<L>(cell, exit, probe)
        {
            eight.put(lane, &quick, way.limit);
        }
    }
}

/// Rays under way.
struct Packet<'a, 'r, L: Lanes> {
    tables: &'a Views,
    rays: &'r [&'r Ray; LANES],
    /// Those that have neither ended nor come into doubt.
    under_way: u32,
    /// As `Way` has them.
    origin: [L::Wide; 3],
    direction: [L::Wide; 3],
    limit: L::Wide,
    /// Along the lattice's axes, from its origin.
    place: [L::Wide; 3],
    heading: [L::Wide; 3],
    /// The same.
    from: [L; 3],
    along: [L; 3],
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
    right: L,
    left: L,
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

/// The corners of rays' prisms.
trait Corners<L> {
    fn at(&self, corner: usize) -> (L, L);
}

/// All in one.
struct One<'a>(&'a Step);

impl<L: Lanes> Corners<L> for One<'_> {
    #[inline(always)]
    fn at(&self, corner: usize) -> (L, L) {
        (L::splat(self.0.x[corner % LANES]), L::splat(self.0.y[corner % LANES]))
    }
}

/// Each in its own.
struct Own<L> {
    x: [L; LANES],
    y: [L; LANES],
}

impl<L: Lanes> Corners<L> for Own<L> {
    #[inline(always)]
    fn at(&self, corner: usize) -> (L, L) {
        (self.x[corner % LANES], self.y[corner % LANES])
    }
}

/// Whether a link leads to parts of an edge.
#[inline(always)]
fn is_split(link: u32) -> bool {
    link & (Step::PLATE | Step::SPLIT) == Step::SPLIT
}

/// a . b, rounded as `DVec3::dot`.
#[inline(always)]
fn dot<W: Wide>(a: &[W; 3], b: &[W; 3]) -> W {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

impl<'a, 'r, L: Lanes> Packet<'a, 'r, L> {
    /// Reads rays. Under way are those that `Way::new` would take, as far as it does not look where they go.
    #[inline(always)]
    fn new(tables: &'a Views, rays: &'r [&'r Ray; LANES]) -> Self {
        let scene = &tables.scene[0];
        let mut rows = [[&[0.0; 4]; LANES]; 2];
        for (lane, &ray) in rays.iter().enumerate() {
            let [first, second]: &[[f64; 4]; 2] = bytemuck::cast_ref(ray);
            (rows[0][lane], rows[1][lane]) = (first, second);
        }
        let [ox, oy, oz, tmin] = L::Wide::columns(rows[0]);
        let [mut dx, mut dy, mut dz, limit] = L::Wide::columns(rows[1]);
        let zero = L::Wide::splat(0.0);
        let mut under_way = tmin.le(zero) & zero.le(tmin) & zero.le(limit);
        let (one, most) = (L::Wide::splat(1.0), L::Wide::splat(UNIT));
        let squared = dot(&[dx, dy, dz], &[dx, dy, dz]);
        let off = squared.sub(one).abs();
        if off.le(most) != ALL {
            let size = off.le_select(most, one, squared.sqrt());
            (dx, dy, dz) = (dx.div(size), dy.div(size), dz.div(size));
            under_way &= L::Wide::splat(1e-99).le(squared) & squared.le(L::Wide::splat(1e99));
        }
        let [x0, y0, z0] = scene.lattice_origin;
        let (mut x, mut y) = (ox.sub(L::Wide::splat(x0)), oy.sub(L::Wide::splat(y0)));
        let z = oz.sub(L::Wide::splat(z0));
        let (mut along_x, mut along_y) = (dx, dy);
        let [cos, sin] = scene.lattice_turn;
        if sin != 0.0 {
            let (cos, sin) = (L::Wide::splat(cos), L::Wide::splat(sin));
            (x, y) = (x.mul(cos).add(y.mul(sin)), y.mul(cos).sub(x.mul(sin)));
            (along_x, along_y) = (dx.mul(cos).add(dy.mul(sin)), dy.mul(cos).sub(dx.mul(sin)));
        }
        let along = [L::narrow(along_x), L::narrow(along_y), L::narrow(dz)];
        let flat = along[0].abs().add(along[1].abs());
        under_way &= L::bits(L::splat(1.01 * STEEPEST as f32).le(flat));
        let [lo, hi] = scene.zone;
        let reach = lo.iter().chain(&hi).fold(0.0, |reach: f64, c| reach.max(c.abs()));
        Packet {
            tables,
            rays,
            under_way,
            origin: [ox, oy, oz],
            direction: [dx, dy, dz],
            limit,
            place: [x, y, z],
            heading: [along_x, along_y, dz],
            from: [L::narrow(x), L::narrow(y), L::narrow(z)],
            along,
            flat,
            steep: L::splat(1.0).div(along[2]),
            // Sixteen roundings.
            rounding: (reach * (-20f64).exp2()) as f32,
        }
    }

    /// A ray by itself.
    #[inline(always)]
    fn way(&self, lane: usize) -> Option<Way<'a>> {
        Way::new(self.tables, self.rays[lane])
    }

    /// Takes the rays out of their prisms: some of them end there.
    #[inline(always)]
    fn step<const FIRST: bool, P: Probe>(&mut self, eight: &mut Eight, probe: &mut P) {
        let tables = self.tables;
        let steps = &tables.steps;
        let lead = eight.cells[self.under_way.trailing_zeros() as usize];
        if self.under_way != ALL {
            for (lane, cell) in eight.cells.iter_mut().enumerate() {
                *cell = if self.under_way >> lane & 1 == 0 { lead } else { *cell };
            }
        }
        let is_one = eight.cells.iter().fold(0, |differ, cell| differ | (cell ^ lead)) == 0;
        let crossed;
        if is_one {
            let step = &steps[lead as usize];
            let [floor, ceiling] = step.height;
            let (floor, ceiling) = (L::splat(floor), L::splat(ceiling));
            crossed = self.cross::<FIRST>(step.corners.into(), &One(step), floor, ceiling);
            if self.together(step, &crossed, eight, probe) {
                return;
            }
        } else {
            let mut rows = [[L::splat(0.0); LANES]; 2];
            let mut heights = [[0.0; LANES]; 2];
            let mut count = 0;
            for (lane, &cell) in eight.cells.iter().enumerate() {
                let step = &steps[cell as usize];
                (rows[0][lane], rows[1][lane]) = (L::load(&step.x), L::load(&step.y));
                (heights[0][lane], heights[1][lane]) = (step.height[0], step.height[1]);
                count = step.corners.max(count);
            }
            let own = Own { x: L::transpose(rows[0]), y: L::transpose(rows[1]) };
            let (floor, ceiling) = (L::load(&heights[0]), L::load(&heights[1]));
            crossed = self.cross::<FIRST>(count.into(), &own, floor, ceiling);
        }
        self.apart::<FIRST, P>(&crossed, is_one, eight, probe);
    }

    /// Ends the ways of all rays, or takes them all into the next prism, where they leave theirs the same way; whether they do.
    #[inline(always)]
    fn together<P: Probe>(
        &mut self,
        step: &Step,
        crossed: &Crossed<L>,
        eight: &mut Eight,
        probe: &mut P,
    ) -> bool {
        let all = self.under_way;
        let edges = crossed.edge;
        let edge = edges.store()[all.trailing_zeros() as usize];
        if all & !(crossed.known | crossed.through_side) != 0 || edges.differs(edge) & all != 0 {
            return false;
        }
        let edge = edge.to_bits() as usize;
        let mut link = if edge < LANES { step.next[edge] } else { step.vertical[usize::from(edge == UP)] };
        if is_split(link) {
            match self.split_together(link & !Step::SPLIT, crossed) {
                Some(found) => link = found,
                None => return false,
            }
        } else if all & !crossed.known != 0 {
            return false;
        } else if link == Step::PARTS && edge >= LANES {
            match self.cover_together(eight.cells[0], edge == DOWN, crossed.t) {
                Some(found) => link = found,
                None => return false,
            }
        }
        if link >= Step::AROUND {
            return false;
        }
        if link & Step::PLATE == 0 {
            let exit = crossed.t.add(crossed.off);
            // What is too far is for others.
            if L::bits(exit.le(L::narrow(self.limit))) & all != all {
                return false;
            }
            let touched = self.touched_one(step.root, exit);
            if touched.count_ones() > FEW {
                let found = self.detail::<P>(touched, step.root, self.passes(step, edge));
                for lane in lanes(touched) {
                    if found.triangle[lane] != NONE {
                        let met = Found { t: found.t[lane], triangle: found.triangle[lane] };
                        let quick = Quick { found: met, cell: eight.cells[lane], source: NONE };
                        eight.put(lane, &quick, self.rays[lane].tmax);
                        self.under_way &= !(1 << lane);
                    }
                }
            } else if touched != 0 {
                return false;
            }
            eight.cells = [link; LANES];
            return true;
        }
        let source = link & !Step::PLATE;
        let Some(plate) = self.tables.plates.get(source as usize) else { return false };
        let [nx, ny, nz] = plate.normal;
        let normal = [L::Wide::splat(nx), L::Wide::splat(ny), L::Wide::splat(nz)];
        let toward = dot(&normal, &self.direction);
        let t = L::Wide::splat(plate.offset).sub(dot(&normal, &self.origin)).div(toward);
        let sure = L::Wide::splat(GRAZING).le(toward.abs()) & L::Wide::splat(0.0).le(t);
        if sure & all != all {
            return false;
        }
        let touched = self.touched_one(step.root, L::narrow(t.min(self.limit)));
        let met = t.store();
        if t.le(self.limit) == ALL && all == ALL {
            (eight.t, eight.known) = (met, ALL);
            (eight.triangle, eight.source) = ([plate.triangle; LANES], [source; LANES]);
            eight.cell = eight.cells;
        } else {
            for lane in lanes(all) {
                let found = Found { t: met[lane], triangle: plate.triangle };
                eight.put(lane, &Quick { found, cell: eight.cells[lane], source }, self.rays[lane].tmax);
            }
        }
        if touched.count_ones() > FEW {
            let found = self.detail::<P>(touched, step.root, t);
            for lane in lanes(touched) {
                let found = Found { t: found.t[lane], triangle: found.triangle[lane] };
                if found.triangle != NONE && (found.t, found.triangle) < (met[lane], plate.triangle) {
                    let quick = Quick { found, cell: eight.cells[lane], source: NONE };
                    eight.put(lane, &quick, self.rays[lane].tmax);
                }
            }
            self.under_way = 0;
            return true;
        }
        for lane in lanes(touched) {
            let Some(way) = self.way(lane) else {
                eight.known &= !(1 << lane);
                continue;
            };
            let found = way.detail(step.root, [0.0, (met[lane] + NEAR).min(way.limit)], probe);
            if found.triangle != NONE && (found.t, found.triangle) < (met[lane], plate.triangle) {
                eight.put(lane, &Quick { found, cell: eight.cells[lane], source: NONE }, way.limit);
            }
        }
        self.under_way = 0;
        true
    }

    /// Where the rays pass an edge of a simple prism, or its floor or its ceiling: as `Way::passes` has it.
    #[inline(always)]
    fn passes(&self, step: &Step, edge: usize) -> L::Wide {
        let ([x, y, z], [ax, ay, az]) = (self.place, self.heading);
        if edge >= LANES {
            let height = L::Wide::splat(f64::from(step.height[edge - LANES]));
            return height.sub(z).mul(L::Wide::splat(1.0).div(az));
        }
        let next = (edge + 1) % LANES;
        let a = [L::Wide::splat(f64::from(step.x[edge])), L::Wide::splat(f64::from(step.y[edge]))];
        let b = [L::Wide::splat(f64::from(step.x[next])), L::Wide::splat(f64::from(step.y[next]))];
        let moment = ay.mul(x).sub(ax.mul(y));
        let right = ax.mul(a[1]).sub(ay.mul(a[0])).add(moment);
        let left = ax.mul(b[1]).sub(ay.mul(b[0])).add(moment);
        let (ex, ey) = (b[0].sub(a[0]), b[1].sub(a[1]));
        let crossing = a[0].sub(x).mul(ey).sub(a[1].sub(y).mul(ex));
        crossing.mul(L::Wide::splat(1.0).div(left.sub(right)))
    }

    /// What some rays meet of detail before `t`.
    #[inline(always)]
    fn detail<P: Probe>(&self, rays: u32, root: u32, t: L::Wide) -> Nearest {
        let herd = Herd::<L> { origin: self.origin, direction: self.direction };
        let until = t.add(L::Wide::splat(NEAR)).min(self.limit);
        if P::ANY {
            together::<L, true>(&Walk::new(self.tables), &herd, rays, root, until)
        } else {
            together::<L, false>(&Walk::new(self.tables), &herd, rays, root, until)
        }
    }

    /// The link of the part of an edge that all rays leave through.
    #[inline(always)]
    fn split_together(&self, first: u32, crossed: &Crossed<L>) -> Option<u32> {
        let ([fx, fy, _], [ax, ay, _]) = (self.from, self.along);
        let (zero, all) = (L::splat(0.0), self.under_way);
        let mut rest = self.tables.parts.get(first as usize..)?.iter();
        let mut part = rest.next()?;
        let (mut right, mut left) = (crossed.right, crossed.left);
        while part.last == 0 {
            let next = rest.next()?;
            let (x, y) = (L::splat(next.start[0]), L::splat(next.start[1]));
            let side = ax.mul_sub(y.sub(fy), ay.mul(x.sub(fx)));
            match L::bits(zero.le(side)) & all {
                0 => (part, right) = (next, side),
                bits if bits == all => {
                    left = side;
                    break;
                }
                _ => return None,
            }
        }
        let least = L::splat(BLURRED as f32 + self.rounding).mul(self.flat);
        let mut is_clear = L::and(least.le(zero.sub(right)), least.le(left));
        let mut face = 0;
        for top in part.top {
            let over = crossed.height.sub(L::splat(top));
            is_clear = L::and(is_clear, crossed.blur.le(over.abs()));
            match L::bits(zero.le(over)) & all {
                0 => break,
                bits if bits == all => face += 1,
                _ => return None,
            }
        }
        (L::bits(is_clear) & all == all).then_some(part.link[face])
    }

    /// The link of the part of a floor or a ceiling that all rays pass.
    #[inline(always)]
    fn cover_together(&self, cell: u32, is_down: bool, t: L) -> Option<u32> {
        let tables = self.tables;
        let (x, y) = (t.mul_add(self.along[0], self.from[0]), t.mul_add(self.along[1], self.from[1]));
        let lead = self.under_way.trailing_zeros() as usize % LANES;
        let (lead_x, lead_y) = (f64::from(x.store()[lead]), f64::from(y.store()[lead]));
        // Farther than that from the border no other part is near.
        let tilt = self.steep.abs().add(L::splat(2.0));
        let margin = L::splat(1.5 * (BLURRED as f32 + self.rounding)).mul(tilt);
        let record = &tables.cells[cell as usize];
        let first = record.first_cover as usize;
        let (below, above) = (record.below as usize, record.above as usize);
        let covers = if is_down { first..first + below } else { first + below..first + below + above };
        for cover in &tables.covers[covers] {
            let beyond = tables.cells.get(cover.cell as usize)?;
            let [lo, hi] = beyond.bounds;
            let is_near = lead_x >= lo[0] && lead_x <= hi[0] && lead_y >= lo[1] && lead_y <= hi[1];
            if beyond.kind == CellRecord::AROUND {
                return None;
            }
            if !is_near {
                continue;
            }
            let first = beyond.first_side as usize;
            let sides = &tables.sides[first..first + beyond.sides as usize];
            let last = sides.last()?.start;
            let (mut ax, mut ay) = (L::splat(last[0]), L::splat(last[1]));
            let mut inside = self.under_way;
            for side in sides {
                let (bx, by) = (L::splat(side.start[0]), L::splat(side.start[1]));
                let (ex, ey) = (bx.sub(ax), by.sub(ay));
                let inward = ex.mul_sub(y.sub(ay), ey.mul(x.sub(ax)));
                inside &= L::bits(margin.mul(ex.abs().add(ey.abs())).le(inward));
                if inside == 0 {
                    break;
                }
                (ax, ay) = (bx, by);
            }
            if inside == self.under_way {
                return link(tables, cover.cell, cover.source, cover.flags);
            }
            if inside != 0 {
                return None;
            }
        }
        None
    }

    /// Ends the ways of some rays, and takes the others into the next prisms.
    #[inline(always)]
    fn apart<const FIRST: bool, P: Probe>(
        &mut self,
        crossed: &Crossed<L>,
        is_one: bool,
        eight: &mut Eight,
        probe: &mut P,
    ) {
        let tables = self.tables;
        let cells = eight.cells;
        let edges = crossed.edge.store();
        let [right, left] = [crossed.right.store(), crossed.left.store()];
        let (height, blur) = (crossed.height.store(), crossed.blur.store());
        // What matters of detail is before this.
        let mut until = crossed.t.add(crossed.off).store();
        let mut links = [0; LANES];
        // Those whose way out was looked for by itself.
        let (mut alone, mut exits) = (0, [0.0; LANES]);
        let mut plates = Plates::new();
        for lane in lanes(self.under_way) {
            let bit = 1 << lane;
            let (step, edge) = (&tables.steps[cells[lane] as usize], edges[lane].to_bits() as usize);
            let mut link = Step::OTHER;
            if (crossed.known | crossed.through_side) & bit != 0 {
                link = if edge < LANES { step.next[edge] } else { step.vertical[usize::from(edge == UP)] };
                if is_split(link) {
                    let sides = [right[lane], left[lane]];
                    link = self.split(lane, link & !Step::SPLIT, sides, height[lane], blur[lane]);
                } else if crossed.known & bit == 0 {
                    link = Step::OTHER;
                }
            }
            if link >= Step::AROUND {
                self.under_way &= !bit;
                alone |= bit;
                let Some(way) = self.way(lane) else { continue };
                let is_within = !FIRST || (crossed.known | crossed.through_side) & bit != 0;
                let exit = if is_within {
                    way.leave::<L, false>(cells[lane])
                } else {
                    way.leave::<L, true>(cells[lane])
                };
                let Some(exit) = exit else { continue };
                if exit.link == Step::AROUND {
                    if let Some(quick) = way.onward::<L>(cells[lane], exit, probe) {
                        eight.put(lane, &quick, way.limit);
                    }
                    continue;
                }
                self.under_way |= bit;
                link = exit.link;
                exits[lane] = exit.t;
                until[lane] = (exit.t + exit.t.abs() * 1e-6 + NEAR) as f32;
            }
            if link & Step::PLATE != 0 && !plates.add(tables, lane, link & !Step::PLATE) {
                self.under_way &= !bit;
            }
            links[lane] = link;
        }
        let limits = L::narrow(self.limit);
        let mut until = L::load(&until).min(limits);
        let mut t = [f64::INFINITY; LANES];
        if plates.lanes != 0 {
            let (sure, met) = plates.meet(&self.origin, &self.direction);
            self.under_way &= sure | !plates.lanes;
            // Where there is no plate the way out counts.
            let (met, nearest) = (met.store(), L::narrow(met.min(self.limit)).store());
            let mut ends = until.store();
            for lane in lanes(plates.lanes) {
                (t[lane], ends[lane]) = (met[lane], nearest[lane]);
            }
            until = L::load(&ends);
        }
        let mut touched = self.touched(&cells, is_one, until, probe);
        // Where each leaves, and what it meets before.
        let mut met = Nearest { t, triangle: [NONE; LANES] };
        for lane in lanes(touched & !plates.lanes) {
            let (cell, bit) = (cells[lane], 1 << lane);
            if alone & bit == 0 {
                let Some(way) = self.way(lane) else {
                    self.under_way &= !bit;
                    touched &= !bit;
                    continue;
                };
                exits[lane] = way.passes(&tables.steps[cell as usize], edges[lane].to_bits() as usize);
            }
            met.t[lane] = exits[lane];
        }
        let is_herd = is_one && touched.count_ones() > FEW;
        if is_herd {
            let step = &tables.steps[cells[0] as usize];
            let root = if step.is_some() { step.root } else { tables.cells[cells[0] as usize].root };
            met = self.detail::<P>(touched, root, L::Wide::load(&met.t));
        }
        for lane in lanes(touched) {
            let (cell, bit) = (cells[lane], 1 << lane);
            let end = Found { t: t[lane], triangle: plates.triangle[lane] };
            let found = if is_herd {
                Found { t: met.t[lane], triangle: met.triangle[lane] }
            } else if let Some(way) = self.way(lane) {
                way.detail(way.root(cell), [0.0, (met.t[lane] + NEAR).min(way.limit)], probe)
            } else {
                self.under_way &= !bit;
                continue;
            };
            if found.triangle != NONE && (found.t, found.triangle) < (end.t, end.triangle) {
                (t[lane], plates.triangle[lane], plates.source[lane]) = (found.t, found.triangle, NONE);
                plates.lanes |= bit;
            }
        }
        let ended = plates.lanes & self.under_way;
        for lane in lanes(ended) {
            let found = Found { t: t[lane], triangle: plates.triangle[lane] };
            let quick = Quick { found, cell: cells[lane], source: plates.source[lane] };
            eight.put(lane, &quick, self.rays[lane].tmax);
        }
        self.under_way &= !ended;
        // Where cells say that a ray is too far, the triangles may say that it is not yet.
        let is_near = L::bits(crossed.t.add(crossed.off).le(limits)) & !alone;
        for lane in lanes(self.under_way & !is_near) {
            let bit = 1 << lane;
            let Some(way) = self.way(lane) else {
                self.under_way &= !bit;
                continue;
            };
            if alone & bit == 0 {
                let step = &tables.steps[cells[lane] as usize];
                exits[lane] = way.passes(step, edges[lane].to_bits() as usize);
            }
            if exits[lane] > way.limit + tables.scene[0].tolerance {
                eight.put(lane, &way.nothing(cells[lane]), way.limit);
                self.under_way &= !bit;
            }
        }
        eight.cells = links;
    }

    /// The part of an edge that a ray leaves through, as `Way::split` has it: where it leads.
    #[inline(always)]
    fn split(&self, lane: usize, first: u32, [mut right, mut left]: [f32; 2], height: f32, blur: f32) -> u32 {
        let (fx, fy) = (self.from[0].store()[lane], self.from[1].store()[lane]);
        let (ax, ay) = (self.along[0].store()[lane], self.along[1].store()[lane]);
        let parts: &[Part] = &self.tables.parts;
        let mut index = first as usize;
        let Some(mut part) = parts.get(index) else { return Step::OTHER };
        while part.last == 0 {
            index += 1;
            let Some(next) = parts.get(index) else { return Step::OTHER };
            let side = ax * (next.start[1] - fy) - ay * (next.start[0] - fx);
            if side >= 0.0 {
                left = side;
                break;
            }
            (part, right) = (next, side);
        }
        let least = (BLURRED as f32 + self.rounding) * (ax.abs() + ay.abs());
        let (over, over_next) = (height - part.top[0], height - part.top[1]);
        if -right >= least && left >= least && over.abs() >= blur && over_next.abs() >= blur {
            part.link[usize::from(over > 0.0) + usize::from(over_next > 0.0)]
        } else {
            Step::OTHER
        }
    }

    /// Where the rays leave prisms whose footprints have up to `count` corners.
    #[inline(always)]
    fn cross<const FIRST: bool>(
        &self,
        count: usize,
        corners: &impl Corners<L>,
        floor: L,
        ceiling: L,
    ) -> Crossed<L> {
        let zero = L::splat(0.0);
        let [fx, fy, fz] = self.from;
        let [ax, ay, az] = self.along;
        let rounding = L::splat(self.rounding);
        let margin = L::splat(BLURRED as f32 + self.rounding);
        let (x, y) = corners.at(0);
        let (mut dx, mut dy) = (x.sub(fx), y.sub(fy));
        let mut side = ax.mul_sub(dy, ay.mul(dx));
        let mut is_left = zero.le(side);
        let mut inside = is_left;
        if FIRST {
            inside = L::and(floor.add(rounding).le(fz), fz.le(ceiling.sub(rounding)));
        }
        let (mut edge, mut right, mut left) = (zero, zero, zero);
        let (mut from_x, mut from_y, mut to_x, mut to_y) = (zero, zero, zero, zero);
        for k in 0..count {
            let (x, y) = corners.at(k + 1);
            let (next_x, next_y) = (x.sub(fx), y.sub(fy));
            let next = ax.mul_sub(next_y, ay.mul(next_x));
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
        // Not the difference of the ends' sides, which are rounded as far as they are from the ray's origin.
        let per = L::splat(1.0).div(ax.mul_sub(ey, ay.mul(ex)));
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
            let (x, y) = corners.at(0);
            let (mut dx, mut dy) = (x.sub(fx).sub(px), y.sub(fy).sub(py));
            for k in 0..count {
                let (x, y) = corners.at(k + 1);
                let (next_x, next_y) = (x.sub(fx).sub(px), y.sub(fy).sub(py));
                let (ex, ey) = (next_x.sub(dx), next_y.sub(dy));
                let inward = ey.mul_sub(dx, ex.mul(dy));
                inside = L::and(inside, margin.mul(ex.abs().add(ey.abs())).le(inward));
                (dx, dy) = (next_x, next_y);
            }
            known |= L::bits(inside);
            let floor = L::splat(f32::from_bits(DOWN as u32));
            let ceiling = L::splat(f32::from_bits(UP as u32));
            edge = L::select(vertical, L::select(down, floor, ceiling), edge);
            t = L::select(vertical, steeply, t);
            off = L::select(vertical, rounding.mul(tilt), off);
        }
        Crossed { known, through_side, right, left, height, blur, edge, t, off }
    }

    /// The rays that come to a box of the detail of their cells before `until`.
    #[inline(always)]
    fn touched<P: Probe>(&self, cells: &[u32; LANES], is_one: bool, until: L, probe: &mut P) -> u32 {
        let tables = self.tables;
        if is_one {
            let step = &tables.steps[cells[0] as usize];
            let root = if step.is_some() { step.root } else { tables.cells[cells[0] as usize].root };
            return self.touched_one(root, until);
        }
        let until = until.store();
        let mut touched = 0;
        for lane in lanes(self.under_way) {
            let step = &tables.steps[cells[lane] as usize];
            let root = if step.is_some() { step.root } else { tables.cells[cells[lane] as usize].root };
            if root == NONE {
                continue;
            }
            let until = f64::from(until[lane]) * (1.0 + 1e-6) + NEAR;
            let is_touched = root & BLOCK_BIT != 0
                || self.way(lane).is_some_and(|way| way.touches::<L>(root, until, probe));
            touched |= u32::from(is_touched) << lane;
        }
        touched
    }

    /// The same where that of all is one.
    #[inline(always)]
    fn touched_one(&self, root: u32, until: L) -> u32 {
        match root {
            NONE => 0,
            root if root & BLOCK_BIT != 0 => self.under_way,
            root => self.under_way & self.touched_boxes(&self.tables.nodes[root as usize], until),
        }
    }

    /// The rays that come to any of a node's boxes before `until`.
    #[inline(always)]
    fn touched_boxes(&self, node: &NodeRecord, until: L) -> u32 {
        let scene = &self.tables.scene[0];
        let (one, least) = (L::splat(1.0), L::splat(LEAST));
        let (mut local, mut inverse) = ([one; 3], [one; 3]);
        for axis in 0..3 {
            local[axis] = L::narrow(self.origin[axis].sub(L::Wide::splat(scene.center[axis])));
            let toward = L::narrow(self.direction[axis]);
            inverse[axis] = one.div(toward.abs().max(least).flip(toward));
        }
        let slack = L::splat(scene.slack);
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

/// The planes behind faces that end the ways of some rays.
struct Plates {
    /// Of which.
    lanes: u32,
    normal: [[f64; LANES]; 3],
    offset: [f64; LANES],
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

    /// Where the rays meet them, and where that is in no doubt: as `Way::plate` has it. Elsewhere NaN or infinite.
    #[inline(always)]
    fn meet<W: Wide>(&self, origin: &[W; 3], direction: &[W; 3]) -> (u32, W) {
        let normal = [W::load(&self.normal[0]), W::load(&self.normal[1]), W::load(&self.normal[2])];
        let toward = dot(&normal, direction);
        let t = W::load(&self.offset).sub(dot(&normal, origin)).div(toward);
        (W::splat(GRAZING).le(toward.abs()) & W::splat(0.0).le(t), t)
    }
}
