//! The quick way of eight rays at once, each in its own prism.
//!
//! A lane is a ray: all of them are taken out of their prisms by the same instructions, in f32. Where that is in doubt, more so than
//! `quick` would be, the ray is asked about by `quick` itself; and what a face holds, or detail, is looked up by what `quick` uses. So it
//! answers the same, to the last bit, on every kernel.
//!
//! Rays that leave one prism through one face stay together, and nothing is done for one of them alone; of others each link is looked up
//! by itself. No closure has lanes in it: not all of them are inlined, and what is not has no registers for them.

mod crossing;
mod detail;
mod eight;
mod links;
mod plates;

use super::NONE;
use super::entries::Entries;
use super::herd::Nearest;
use super::kernel::Probe;
use super::lanes::{Lanes, Wide};
use super::path::NEAR;
use super::quick::{COARSEST, DOWN, GRAZING, Passage, Quick, STEEPEST, UNIT, Way, is_split};
use super::ray::Ray;
use super::step::Step;
use super::walk::Found;
use crate::format::Views;
use crate::format::records::LANES;
use crossing::{Crossed, One, Own};
pub(super) use eight::Eight;
use plates::{Plates, dot};

/// Fewer rays are no packet.
const FEW: u32 = 2;

/// All rays.
const ALL: u32 = (1 << LANES) - 1;

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
pub(super) fn packet<L: Entries, P: Probe>(
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
            && let Some(exit) = way.leave::<L>(cell, false)
            && let Some(quick) = L::onward(tables, rays[lane], cell, exit, probe)
        {
            eight.put(lane, &quick, way.limit);
        }
    }
}

/// Rays under way.
struct Packet<'a, L: Lanes> {
    tables: &'a Views,
    rays: &'a [&'a Ray; LANES],
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

impl<'a, L: Entries> Packet<'a, L> {
    /// Reads rays. Under way are those that `Way::new` would take, as far as it does not look where they go.
    #[inline(always)]
    fn new(tables: &'a Views, rays: &'a [&'a Ray; LANES]) -> Self {
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
            rounding: tables.airgrid[0].rounding,
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
        let mut link = step.links[edge];
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
                let found = self.detail(probe.ask(), touched, step.root, self.passes(step, edge));
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
            let found = self.detail(probe.ask(), touched, step.root, t);
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
            let found = way.detail(step.root, 0.0, (met[lane] + NEAR).min(way.limit), probe);
            if found.triangle != NONE && (found.t, found.triangle) < (met[lane], plate.triangle) {
                eight.put(lane, &Quick { found, cell: eight.cells[lane], source: NONE }, way.limit);
            }
        }
        self.under_way = 0;
        true
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
        let (height, blur, least) = (crossed.height.store(), crossed.blur.store(), self.least().store());
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
                link = step.links[edge];
                if is_split(link) {
                    let sides = [right[lane], left[lane]];
                    let passage =
                        Passage { sides, least: least[lane], height: height[lane], blur: blur[lane] };
                    let part = passage.part::<L>(tables, link & !Step::SPLIT);
                    link = part.unwrap_or(Step::OTHER);
                } else if crossed.known & bit == 0 {
                    link = Step::OTHER;
                }
            }
            if link >= Step::AROUND {
                self.under_way &= !bit;
                alone |= bit;
                let Some(way) = self.way(lane) else { continue };
                let is_within = !FIRST || (crossed.known | crossed.through_side) & bit != 0;
                let exit = way.leave::<L>(cells[lane], !is_within);
                let Some(exit) = exit else { continue };
                if exit.link == Step::AROUND {
                    if let Some(quick) = L::onward(tables, self.rays[lane], cells[lane], exit, probe) {
                        eight.put(lane, &quick, way.limit);
                    }
                    continue;
                }
                self.under_way |= bit;
                link = exit.link;
                exits[lane] = way.exact(cells[lane], exit);
                until[lane] = (exits[lane] + exits[lane].abs() * 1e-6 + NEAR) as f32;
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
            met = self.detail(probe.ask(), touched, root, L::Wide::load(&met.t));
        }
        for lane in lanes(touched) {
            let (cell, bit) = (cells[lane], 1 << lane);
            let end = Found { t: t[lane], triangle: plates.triangle[lane] };
            let found = if is_herd {
                Found { t: met.t[lane], triangle: met.triangle[lane] }
            } else if let Some(way) = self.way(lane) {
                way.detail(way.root(cell), 0.0, (met.t[lane] + NEAR).min(way.limit), probe)
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
}
