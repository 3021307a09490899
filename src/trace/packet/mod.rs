//! The quick way of eight rays at once.
//!
//! A lane is a ray: all of them are taken out of their prisms by the same instructions, in f32. Where that is in doubt, more so than
//! `quick` would be, the ray is asked about by `quick` itself; and what a face holds, or detail, is looked up by what `quick` uses. So it
//! answers the same, to the last bit, on every kernel.
//!
//! Rays of one prism that leave it through one face stay together, and nothing is done for one of them alone. Of others each link is looked
//! up by itself; those that go on are gathered until there are eight again. One scattered ray after the other would take longer: each of
//! its steps waits for the one before, and where it goes cannot be foreseen.
//!
//! No closure has lanes in it: not all of them are inlined, and what is not has no registers for them.

// Portable lanes do without.
#![cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]

mod answers;
mod apart;
mod crossing;
mod detail;
mod links;
mod plates;

use super::NONE;
use super::entries::Entries;
use super::kernel::Ask;
use super::lanes::{Lanes, Wide};
use super::quick::{CELLS as WALLS, COARSEST, DOWN, GRAZING, Quick, STEEPEST, UNIT, is_split};
use super::ray::Ray;
use super::step::Step;
use super::walk::Found;
use crate::format::Views;
use crate::format::records::LANES;
pub(super) use answers::{Answers, BLOCK};
use answers::{Group, Pool};
use crossing::{Crossed, One};
use plates::dot;

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

/// What up to [`BLOCK`] rays meet that is in no doubt, each starting in the air of its cell; where any will do, walls are looked for first, as
/// `barred` has it, through a few dozen cells at most. Those that follow each other are looked at together, unless they are `scattered`.
#[inline(always)]
pub(super) fn packets<L: Entries>(
    ask: Ask,
    tables: &Views,
    rays: &[&Ray],
    cells: &[u32],
    scattered: bool,
    answers: &mut Answers,
) {
    answers.clear();
    let mut pool = Pool::NONE;
    for (ray, &cell) in cells.iter().enumerate().take(rays.len().min(BLOCK)) {
        if (cell as usize) < tables.steps.len() {
            pool.push(ray as u8, cell);
        }
    }
    if tables.scene[0].lattice_bits < COARSEST {
        return;
    }
    let block = Block { ask, tables, rays, scattered };
    if ask == Ask::Any {
        let mut again = Pool::NONE;
        let rest = block.run::<L>(pool, answers, Some(&mut again));
        for (number, cell) in rest.iter() {
            let ray = block.ray(number);
            if L::is_walled(tables, ray, cell, L::leave(tables, ray, cell, false)) {
                answers.put(number, Quick::of(true, ray, cell));
            } else {
                again.push(number, cell);
            }
        }
        for (number, cell) in again.ray.iter().zip(&mut again.cell).take(again.len) {
            *cell = cells[usize::from(*number)];
        }
        pool = again;
    }
    let rest = block.run::<L>(pool, answers, None);
    for (number, cell) in rest.iter() {
        let ray = block.ray(number);
        let exit = L::leave(tables, ray, cell, false);
        if let Some(quick) = L::onward(ask, tables, ray, cell, exit, &mut ()) {
            answers.put(number, quick);
        }
    }
}

/// Rays that are asked about together.
struct Block<'a> {
    ask: Ask,
    tables: &'a Views,
    rays: &'a [&'a Ray],
    /// Those that follow each other start in different places.
    scattered: bool,
}

impl<'a> Block<'a> {
    #[inline(always)]
    fn ray(&self, number: u8) -> &'a Ray {
        self.rays[usize::from(number) % BLOCK]
    }

    /// Takes the rays of a pool through their prisms, eight at a time, until few are under way: those. With `again` they
    /// are taken to walls only, and not far: each that those do not end is put there, where it is then.
    #[inline(always)]
    fn run<L: Entries>(&self, mut pool: Pool, answers: &mut Answers, mut again: Option<&mut Pool>) -> Pool {
        // Each ray passes each cell once. What is no partition may lead them further, but they are not followed.
        let mut left = BLOCK * self.tables.cells.len();
        let (mut starts, mut rounds) = (true, if again.is_some() { WALLS } else { usize::MAX });
        while left > 0 && rounds > 0 && pool.len > 0 && (pool.len > FEW as usize || starts) {
            rounds -= 1;
            let mut next = Pool::NONE;
            for first in (0..pool.len).step_by(LANES) {
                let count = (pool.len - first).min(LANES);
                let (mut numbers, mut cells) = ([pool.ray[first]; LANES], [pool.cell[first]; LANES]);
                for lane in 0..count {
                    (numbers[lane], cells[lane]) = (pool.ray[first + lane], pool.cell[first + lane]);
                }
                let mut own = [self.rays[0]; LANES];
                for lane in 0..LANES {
                    own[lane] = self.ray(numbers[lane]);
                }
                let mut packet = Packet::<L>::new(self.tables, &own);
                packet.under_way &= ALL >> (LANES - count);
                let again = again.as_deref_mut();
                let group = Group { ask: self.ask, starts, numbers, cells, answers, next: &mut next, again };
                packet.run(group, self.scattered, &mut left);
            }
            (pool, starts) = (next, false);
        }
        pool
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
    /// Reads rays. Under way are those that `quick` would take, as far as it does not look where they go.
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

    /// Takes the rays through prisms together as long as they are in one, and leave it one way; then out of those in which they are then.
    #[inline(always)]
    fn run(&mut self, mut group: Group<'_>, scattered: bool, left: &mut usize) {
        let tables = self.tables;
        let lead = group.cells[0];
        *left = left.saturating_sub(1);
        if scattered || group.cells.iter().fold(0, |differ, cell| differ | (cell ^ lead)) != 0 {
            let crossed = if group.starts {
                self.cross_own::<true>(&group.cells)
            } else {
                self.cross_own::<false>(&group.cells)
            };
            self.apart(&crossed, &mut group);
            return;
        }
        let mut most = if group.again.is_some() { WALLS } else { usize::MAX };
        while self.under_way != 0 && *left > 0 && most > 0 {
            (*left, most) = (*left - 1, most - 1);
            let step = &tables.steps[group.cells[0] as usize];
            let [floor, ceiling] = step.height;
            let (floor, ceiling) = (L::splat(floor), L::splat(ceiling));
            let crossed = if group.starts {
                self.cross::<true>(step.corners.into(), &One(step), floor, ceiling)
            } else {
                self.cross::<false>(step.corners.into(), &One(step), floor, ceiling)
            };
            if !step.is_some() || !self.together(step, &crossed, &mut group) {
                self.apart(&crossed, &mut group);
                return;
            }
            group.starts = false;
        }
        if let Some(again) = &mut group.again {
            for lane in lanes(self.under_way) {
                again.push(group.numbers[lane], group.cells[lane]);
            }
        }
    }

    /// Ends the ways of all rays, or takes them all into the next prism, where they leave theirs the same way; whether they do.
    #[inline(always)]
    fn together(&mut self, step: &Step, crossed: &Crossed<L>, group: &mut Group<'_>) -> bool {
        let all = self.under_way;
        let edges = crossed.edge;
        let edge = edges.store()[all.trailing_zeros() as usize];
        if all & !(crossed.known | crossed.through_side) != 0 || edges.differs(edge) & all != 0 {
            return false;
        }
        let edge = edge.to_bits() as usize;
        let mut link = step.links[edge];
        if is_split(link) && edge < LANES {
            match self.split_together(link & !Step::SPLIT, crossed) {
                Some(found) => link = found,
                None => return false,
            }
        } else if all & !crossed.known != 0 {
            return false;
        } else if edge >= LANES && (link == Step::PARTS || is_split(link)) {
            match self.cover_together(group.cells[0], edge == DOWN, crossed.t) {
                Some(found) => link = found,
                None => return false,
            }
        }
        if link >= Step::ROUGH {
            return false;
        }
        if link & Step::PLATE == 0 {
            let exit = crossed.t.add(crossed.off);
            // What is too far is for others.
            if L::bits(exit.le(L::narrow(self.limit))) & all != all {
                return false;
            }
            let touched = if group.again.is_some() { 0 } else { self.touched_one(step.root, exit) };
            if touched != 0 {
                let found = self.detail(group.ask, touched, step.root, self.passes(step, edge));
                for lane in lanes(touched) {
                    if found.triangle[lane] != NONE {
                        let met = Found { t: found.t[lane], triangle: found.triangle[lane] };
                        let quick = Quick { found: met, cell: group.cells[lane], source: NONE };
                        group.put(lane, quick, self.rays[lane].tmax);
                        self.under_way &= !(1 << lane);
                    }
                }
            }
            group.cells = [link; LANES];
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
        // Those of which detail may change the answer.
        let open = group.is_open(all, t.le(self.limit));
        if group.are_again(open) {
            return false;
        }
        let touched =
            if open == 0 { 0 } else { open & self.touched_one(step.root, L::narrow(t.min(self.limit))) };
        let met = t.store();
        for lane in lanes(all) {
            let found = Found { t: met[lane], triangle: plate.triangle };
            group.put(lane, Quick { found, cell: group.cells[lane], source }, self.rays[lane].tmax);
        }
        if touched != 0 {
            let found = self.detail(group.ask, touched, step.root, t);
            for lane in lanes(touched) {
                let found = Found { t: found.t[lane], triangle: found.triangle[lane] };
                if found.triangle != NONE && (found.t, found.triangle) < (met[lane], plate.triangle) {
                    let quick = Quick { found, cell: group.cells[lane], source: NONE };
                    group.put(lane, quick, self.rays[lane].tmax);
                }
            }
        }
        self.under_way = 0;
        true
    }
}
