//! Rays that leave prisms each its own way.

use super::answers::Group;
use super::crossing::{Crossed, Own};
use super::plates::Plates;
use super::{Packet, lanes};
use crate::format::records::{LANES, Leaf};
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::herd::Rounded;
use crate::trace::kernel::Ask;
use crate::trace::lanes::Wide;
use crate::trace::path::{BEYOND, NEAR};
use crate::trace::quick::{Exit, Passage, Quick, is_split, may_meet, nothing};
use crate::trace::step::Step;
use crate::trace::walk::{Found, Opened};

impl<L: Entries> Packet<'_, L> {
    /// Takes the rays out of their prisms, where they cross them so: ends the ways of some there, and puts the others into the pool, or
    /// among those that are asked about again.
    #[inline(always)]
    pub(super) fn apart(&self, crossed: &Crossed<L>, group: &mut Group<'_>) {
        let (ask, starts) = (group.ask, group.starts);
        let tables = self.eight.tables;
        let steps: &[Step] = &tables.steps;
        let cells = group.cells;
        // Where each leads, and the root of its detail.
        let edges = crossed.edge.store();
        let (mut links, mut roots) = ([Step::OTHER; LANES], [NONE; LANES]);
        let (mut split, mut parts, mut simple) = (0, 0, 0);
        for lane in 0..LANES {
            let step = &steps[cells[lane] as usize];
            let link = step.links[(edges[lane].to_bits() as usize).min(LANES + 1)];
            (links[lane], roots[lane]) = (link, step.root);
            let is_edge = (edges[lane].to_bits() as usize) < LANES;
            split |= u32::from(is_split(link) && is_edge) << lane;
            parts |= u32::from(link >= Step::ROUGH || is_split(link) && !is_edge) << lane;
            simple |= u32::from(step.is_some()) << lane;
        }
        let mut ready = self.eight.under_way & simple & crossed.known & !split & !parts;
        let splits = self.eight.under_way & simple & crossed.through_side & split;
        if splits != 0 {
            ready |= self.parts(splits, crossed, &mut links);
        }
        // The others by themselves.
        let (mut alone, mut exits) = (0, [Exit::NONE; LANES]);
        let ends = crossed.t.add(crossed.off);
        let mut until = ends.store();
        for lane in lanes(self.eight.under_way & !ready) {
            let exit = L::leave(tables, self.eight.rays[lane], cells[lane], starts);
            if exit.link >= Step::ROUGH {
                if let Some(again) = &mut group.again {
                    // Also by a face that is not plain.
                    let ray = self.eight.rays[lane];
                    if L::is_walled(tables, ray, cells[lane], exit) {
                        group.answers.put(group.numbers[lane], Quick::of(true, ray, cells[lane]));
                    } else {
                        again.push(group.numbers[lane], cells[lane]);
                    }
                } else if let Some(quick) =
                    L::onward(ask, tables, self.eight.rays[lane], cells[lane], exit, &mut ())
                {
                    group.answers.put(group.numbers[lane], quick);
                }
                continue;
            }
            (alone, ready) = (alone | 1 << lane, ready | 1 << lane);
            (links[lane], exits[lane], until[lane]) = (exit.link, exit, exit.at_most() as f32);
            if simple >> lane & 1 == 0 {
                roots[lane] = tables.cells[cells[lane] as usize].root;
            }
        }
        let mut ended = 0;
        for lane in 0..LANES {
            ended |= (links[lane] >> 31) << lane;
        }
        ended &= ready;
        let mut plates = Plates::new();
        for lane in lanes(ended) {
            if !plates.add(tables, lane, links[lane] & !Step::PLATE) {
                ready &= !(1 << lane);
            }
        }
        let (sure, met) = plates.meet(&self.eight.origin, &self.eight.direction);
        ready &= sure | !ended;
        ended &= ready;
        let mut t = met.store();
        let nearest = L::narrow(met.min(self.eight.limit)).store();
        let limits = L::narrow(self.eight.limit);
        let mut roots_there = 0;
        for lane in 0..LANES {
            until[lane] = if ended >> lane & 1 != 0 { nearest[lane] } else { until[lane] };
            roots_there |= u32::from(roots[lane] != NONE) << lane;
        }
        roots_there &= ready;
        // Where cells say that a ray is too far, the triangles may say that it is not yet.
        let mut is_near = L::bits(ends.le(limits)) & !alone;
        if ask == Ask::Any {
            for lane in lanes(alone) {
                is_near |= u32::from(exits[lane].at_most() <= self.eight.rays[lane].tmax) << lane;
            }
            let walled = ended & met.le(self.eight.limit);
            roots_there &= !walled;
            if let Some(again) = &mut group.again {
                let passing = ready & !ended & is_near;
                if starts {
                    roots_there &= !passing;
                } else {
                    for lane in lanes(ready & !walled & !passing) {
                        again.push(group.numbers[lane], cells[lane]);
                    }
                    (ready, roots_there) = (walled | passing, 0);
                    ended &= ready;
                }
            }
        }
        if roots_there != 0 {
            let scene = &tables.scene[0];
            let rounded = Rounded::<L>::new(scene, &self.eight.origin, &self.eight.direction);
            let locals = [rounded.local[0].store(), rounded.local[1].store(), rounded.local[2].store()];
            let inverses =
                [rounded.inverse[0].store(), rounded.inverse[1].store(), rounded.inverse[2].store()];
            let until = L::load(&until).min(limits).store();
            for lane in lanes(roots_there) {
                let root = roots[lane];
                let opened = if root & Leaf::BIT != 0 {
                    Opened::not_yet(root)
                } else {
                    let local = [locals[0][lane], locals[1][lane], locals[2][lane]];
                    let inverse = [inverses[0][lane], inverses[1][lane], inverses[2][lane]];
                    match may_meet::<L>(tables, root, local, inverse, until[lane]) {
                        Some(opened) => opened,
                        None => continue,
                    }
                };
                let (ray, is_end) = (self.eight.rays[lane], ended >> lane & 1 != 0);
                let end = if is_end {
                    Found { t: t[lane], triangle: plates.triangle[lane] }
                } else {
                    Found { t: f64::INFINITY, triangle: NONE }
                };
                let before = if is_end {
                    end.t
                } else if alone >> lane & 1 != 0 {
                    exits[lane].exact_of(tables, ray, cells[lane])
                } else {
                    Exit::through(edges[lane].to_bits()).exact_of(tables, ray, cells[lane])
                };
                let before = (before + NEAR).min(ray.tmax);
                let found = L::detail(ask, tables, ray, None, &opened, (0.0, before), &mut ());
                if found.triangle != NONE && (found.t, found.triangle) < (end.t, end.triangle) {
                    (t[lane], plates.triangle[lane], plates.source[lane]) = (found.t, found.triangle, NONE);
                    ended |= 1 << lane;
                }
            }
        }
        for lane in lanes(ended) {
            let found = Found { t: t[lane], triangle: plates.triangle[lane] };
            let quick = Quick { found, cell: cells[lane], source: plates.source[lane] };
            group.put(lane, quick, self.eight.rays[lane].tmax);
        }
        let onward = ready & !ended;
        for lane in lanes(onward & !is_near) {
            let ray = self.eight.rays[lane];
            let exit =
                if alone >> lane & 1 != 0 { exits[lane] } else { Exit::through(edges[lane].to_bits()) };
            if exit.exact_of(tables, ray, cells[lane]) > ray.tmax + BEYOND * tables.scene[0].tolerance {
                group.answers.put(group.numbers[lane], nothing(ray.tmax, cells[lane]));
                links[lane] = NONE;
            }
        }
        for lane in lanes(onward) {
            if links[lane] != NONE {
                group.next.push(group.numbers[lane], links[lane]);
            }
        }
    }

    /// Where the rays leave prisms of their own.
    #[inline(always)]
    pub(super) fn cross_own<const FIRST: bool>(&self, cells: &[u32; LANES]) -> Crossed<L> {
        let mut rows = [[L::splat(0.0); LANES]; 2];
        let mut heights = [[0.0; LANES]; 2];
        let mut count = 0;
        for (lane, &cell) in cells.iter().enumerate() {
            let step = &self.eight.tables.steps[cell as usize];
            (rows[0][lane], rows[1][lane]) = (L::load(&step.x), L::load(&step.y));
            (heights[0][lane], heights[1][lane]) = (step.height[0], step.height[1]);
            count = step.corners.max(count);
        }
        let own = Own { x: L::transpose(rows[0]), y: L::transpose(rows[1]) };
        let heights = [L::load(&heights[0]), L::load(&heights[1])];
        self.lines.cross::<FIRST>(count.into(), &own, heights, self.eight.under_way)
    }

    /// The links of the parts of split edges that rays leave through; those of which that is in no doubt.
    #[inline(always)]
    fn parts(&self, splits: u32, crossed: &Crossed<L>, links: &mut [u32; LANES]) -> u32 {
        let [right, left] = [crossed.right.store(), crossed.left.store()];
        let (height, blur, least) =
            (crossed.height.store(), crossed.blur.store(), self.lines.least().store());
        let mut ready = 0;
        for lane in lanes(splits) {
            let passage = Passage {
                sides: [right[lane], left[lane]],
                least: least[lane],
                height: height[lane],
                blur: blur[lane],
            };
            let part = passage.part::<L>(self.eight.tables, links[lane] & !Step::SPLIT);
            let link = part.unwrap_or(Step::OTHER);
            links[lane] = link;
            ready |= u32::from(link < Step::ROUGH) << lane;
        }
        ready
    }
}
