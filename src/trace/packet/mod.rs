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
mod bundle;
mod crossing;
mod detail;
mod eight;
mod lines;
mod links;
mod plates;
mod pyramid;

use super::entries::Entries;
use super::kernel::Ask;
use super::lanes::Lanes;
use super::quick::{CELLS as WALLS, COARSEST, Quick};
use super::ray::Ray;
use super::step::Step;
use crate::format::Views;
use crate::format::records::LANES;
pub(super) use answers::{Answers, BLOCK};
use answers::{Group, Pool};
#[cfg(target_arch = "x86_64")]
pub(super) use bundle::bundle;
use crossing::{Crossed, One};
use eight::Eight;
use lines::Lines;

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

/// What those of up to [`BLOCK`] rays meet that have no answer yet, if it is in no doubt. Each starts in the air of its cell, or has come there if
/// it has `moved` (ray i is bit i); where any will do, walls are looked for first, as `barred` has it, through a few dozen cells at most. Those that follow each other are looked at together, unless they are `scattered`.
#[inline(always)]
pub(super) fn packets<L: Entries>(
    ask: Ask,
    tables: &Views,
    rays: &[Ray],
    cells: &[u32],
    moved: u64,
    scattered: bool,
    answers: &mut Answers,
) {
    let (mut pool, mut ahead) = (Pool::NONE, Pool::NONE);
    for (ray, &cell) in cells.iter().enumerate().take(rays.len().min(BLOCK)) {
        if (cell as usize) < tables.steps.len() && answers.get(ray).is_none() {
            let pool = if moved >> ray & 1 != 0 { &mut ahead } else { &mut pool };
            pool.push(ray as u8, cell);
        }
    }
    if tables.scene[0].lattice_bits < COARSEST {
        return;
    }
    let block = Block { ask, tables, rays, scattered };
    if ask == Ask::Any {
        let mut again = Pool::NONE;
        let rest = block.run::<L>(pool, Pool::NONE, answers, Some(&mut again));
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
    let rest = block.run::<L>(pool, ahead, answers, None);
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
    rays: &'a [Ray],
    /// Those that follow each other start in different places.
    scattered: bool,
}

impl<'a> Block<'a> {
    #[inline(always)]
    fn ray(&self, number: u8) -> &'a Ray {
        &self.rays[usize::from(number) % BLOCK]
    }

    /// Takes the rays of a pool, which are where they start, and those `ahead` of them through their prisms, eight at a time, until few are
    /// under way: those. With `again` they are taken to walls only, and not far: each that those do not end is put there, where it is then.
    #[inline(always)]
    fn run<L: Entries>(
        &self,
        mut pool: Pool,
        ahead: Pool,
        answers: &mut Answers,
        mut again: Option<&mut Pool>,
    ) -> Pool {
        // Each ray passes each cell once. What is no partition may lead them further, but they are not followed.
        let mut left = BLOCK * self.tables.cells.len();
        let (mut starts, mut rounds) = (true, if again.is_some() { WALLS } else { usize::MAX });
        let mut next = ahead;
        if pool.len == 0 {
            (pool, next, starts) = (next, Pool::NONE, false);
        }
        while left > 0 && rounds > 0 && pool.len > 0 && (pool.len > FEW as usize || starts) {
            rounds -= 1;
            for first in (0..pool.len).step_by(LANES) {
                let count = (pool.len - first).min(LANES);
                let (mut numbers, mut cells) = ([pool.ray[first]; LANES], [pool.cell[first]; LANES]);
                for lane in 0..count {
                    (numbers[lane], cells[lane]) = (pool.ray[first + lane], pool.cell[first + lane]);
                }
                let mut own = [&self.rays[0]; LANES];
                for lane in 0..LANES {
                    own[lane] = self.ray(numbers[lane]);
                }
                let mut packet = Packet::<L>::new(self.tables, own);
                packet.eight.under_way &= ALL >> (LANES - count);
                let again = again.as_deref_mut();
                let group = Group { ask: self.ask, starts, numbers, cells, answers, next: &mut next, again };
                packet.run(group, self.scattered, &mut left);
            }
            (pool, next, starts) = (next, Pool::NONE, false);
        }
        pool
    }
}

/// Rays under way.
struct Packet<'a, L: Lanes> {
    eight: Eight<'a, L>,
    lines: Lines<L>,
}

impl<'a, L: Entries> Packet<'a, L> {
    /// Reads rays. Under way are those that `quick` would take, as far as it does not look where they go.
    #[inline(always)]
    fn new(tables: &'a Views, rays: [&'a Ray; LANES]) -> Self {
        let mut eight = Eight::new(tables, rays);
        let lines = Lines::new(&mut eight);
        Packet { eight, lines }
    }

    /// Takes the rays through prisms together as long as they are in one, and leave it one way; then out of those in which they are then.
    #[inline(always)]
    fn run(&mut self, mut group: Group<'_>, scattered: bool, left: &mut usize) {
        let tables = self.eight.tables;
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
        while self.eight.under_way != 0 && *left > 0 && most > 0 {
            (*left, most) = (*left - 1, most - 1);
            let step = &tables.steps[group.cells[0] as usize];
            let [floor, ceiling] = step.height;
            let (floor, ceiling) = (L::splat(floor), L::splat(ceiling));
            let all = self.eight.under_way;
            let crossed = if group.starts {
                self.lines.cross::<true>(step.corners.into(), &One(step), [floor, ceiling], all)
            } else {
                self.lines.cross::<false>(step.corners.into(), &One(step), [floor, ceiling], all)
            };
            if !step.is_some() || !self.together(step, &crossed, &mut group) {
                self.apart(&crossed, &mut group);
                return;
            }
            group.starts = false;
        }
        if let Some(again) = &mut group.again {
            for lane in lanes(self.eight.under_way) {
                again.push(group.numbers[lane], group.cells[lane]);
            }
        }
    }

    /// Ends the ways of all rays, or takes them all into the next prism, where they leave theirs the same way; whether they do.
    #[inline(always)]
    fn together(&mut self, step: &Step, crossed: &Crossed<L>, group: &mut Group<'_>) -> bool {
        let (tables, all) = (self.eight.tables, self.eight.under_way);
        let Some((edge, link)) = self.lines.way_out(tables, all, step, group.cells[0], crossed) else {
            return false;
        };
        if link & Step::PLATE != 0 {
            return self.eight.end(None, step, link & !Step::PLATE, group);
        }
        let exit = crossed.t.add(crossed.off);
        // What is too far is for others.
        if L::bits(exit.le(L::narrow(self.eight.limit))) & all != all {
            return false;
        }
        if group.again.is_none() {
            self.eight.pass_detail(None, step, edge, exit, group);
        }
        group.cells = [link; LANES];
        true
    }
}
