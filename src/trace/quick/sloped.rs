//! Where a ray leaves a simple prism whose floor or ceiling is sloped: an attic, the air under a flight of stairs.
//!
//! The footprint is looked at as that of others is, in f32 in lanes; heights are those of the planes, in f64.

// Comparisons are written so that NaN is in doubt.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use super::leaving::{Footprint, Passage, WITHIN, is_split};
use super::{DOWN, Exit, UP, Way};
use crate::format::Views;
use crate::trace::entries::Entries;
use crate::trace::path::BLURRED;
use crate::trace::ray::Ray;
use crate::trace::step::Step;

/// Where a ray leaves such a prism, in which it starts, or which it came into.
#[inline(always)]
pub(in crate::trace) fn sloped<L: Entries>(
    tables: &Views,
    ray: &Ray,
    cell: u32,
    starts: bool,
) -> Option<Exit> {
    Way::new(tables, ray)?.leave_sloped::<L>(cell, starts)
}

impl Way<'_> {
    #[inline(always)]
    fn leave_sloped<L: Entries>(&self, cell: u32, starts: bool) -> Option<Exit> {
        let tables = self.tables;
        let (step, record) = (&tables.steps[cell as usize], &tables.cells[cell as usize]);
        let Footprint { index, right, left, inward, across, size, slant, is_there, .. } =
            self.footprint::<L>(step, starts);
        let (floor, falls) = self.over(record.floor);
        let (ceiling, rises) = self.over(record.ceiling);
        if !is_there || (starts && !(floor >= 0.0 && ceiling <= 0.0)) {
            return None;
        }
        // Over the floor and under the ceiling where it leaves the footprint, beside how far one aside is from there.
        let t = self.passes(cell, index);
        let (over, under) = (floor + t * falls, -(ceiling + t * rises));
        let (margin, aside) = (BLURRED as f32 + self.rounding, f64::from(slant));
        let blur_floor = f64::from(margin) * (2.0 + aside * falls.abs());
        let blur_ceiling = f64::from(margin) * (2.0 + aside * rises.abs());
        if over >= blur_floor && under >= blur_ceiling {
            let link = step.links[index];
            let [ax, ay, az] = [self.along.x as f32, self.along.y as f32, self.along.z as f32];
            let least = margin * (ax.abs() + ay.abs());
            let link = if is_split(link) {
                let height = (self.from.z + t * self.along.z) as f32;
                let blur = margin * (2.0 + slant * az.abs());
                Passage { sides: [right, left], least, height, blur }
                    .part::<L>(tables, link & !Step::SPLIT)?
            } else if link == Step::PARTS {
                self.part(cell, step, index)?
            } else if -right >= least && left >= least {
                link
            } else {
                return None;
            };
            return Some(Exit::passing(t, link, index));
        }
        // Out of one of them, and well within the other there. Of a level one that is not asked: where the ray passes it within the footprint, the other is
        // on its other side. So packets have it, which know of no slopes.
        let is_level = [step.height[0], step.height[1]].map(|height| !height.is_nan());
        let is_down = over <= -blur_floor && (is_level[0] || under >= blur_ceiling);
        let is_up = under <= -blur_ceiling && (is_level[1] || over >= blur_floor);
        if !(is_down || is_up) {
            return None;
        }
        let (height, grows, by) = if is_down { (floor, falls, DOWN) } else { (ceiling, rises, UP) };
        let t = -height / grows;
        let tilt = (2.0 + 1.0 / grows.abs()) as f32;
        let well = size.mul(L::splat(WITHIN + self.rounding * tilt));
        if L::bits(well.le(inward.sub(across.mul(L::splat(t as f32))))) != 0xff {
            return None;
        }
        let at = [self.from.x + t * self.along.x, self.from.y + t * self.along.y];
        let mut link = step.links[by];
        if is_split(link) {
            let spot = [at[0] as f32, at[1] as f32];
            link = L::tile(tables, link & !Step::SPLIT, spot, margin * tilt);
        }
        if link == Step::PARTS {
            link = self.cover(cell, is_down, at, grows)?;
        }
        Some(Exit::passing(t, link, by))
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::super::leaving::{EXACT, slowly};
    use super::*;
    use crate::Place;
    use crate::samples::Sample;
    use crate::splitmix::SplitMix64;
    use crate::trace::lanes::Portable;

    /// Under the roofs of attics.
    #[test]
    fn in_lanes_rays_leave_as_they_do_in_f64() {
        let scene = Sample::Build1.scene();
        let tables = &scene.tables;
        let attics: Vec<usize> =
            (0..tables.steps.len()).filter(|&cell| tables.steps[cell].is_sloped()).collect();
        let mut random = SplitMix64::new(12);
        let (mut all, mut same, mut through) = (0, 0, [0; 3]);
        while all < 20_000 {
            let cell = attics[random.below(attics.len() as u64) as usize];
            // Prisms lie along the lattice's axes, which are turned against the scene's.
            let (origin, [cos, sin]) = (tables.scene[0].lattice_origin, tables.scene[0].lattice_turn);
            let [lo, hi] = tables.cells[cell].bounds;
            let at = [0, 1, 2].map(|axis| random.between(lo[axis], hi[axis]));
            let from = [
                origin[0] + at[0] * cos - at[1] * sin,
                origin[1] + at[0] * sin + at[1] * cos,
                origin[2] + at[2],
            ];
            if !matches!(scene.locate(from), Place::Air { cell: found, .. } if found as usize == cell) {
                continue;
            }
            let way = [0, 1, 2].map(|_| random.between(-1.0, 1.0));
            let (cell, starts) = (cell as u32, random.below(2) == 0);
            // Where it only came into the cell it started anywhere before.
            let back = if starts { 0.0 } else { random.between(0.0, 4.0) };
            let ray = Ray::new([0, 1, 2].map(|axis| from[axis] - back * way[axis]), way);
            let Some(slow) = slowly(tables, &ray, cell, EXACT, starts) else { continue };
            all += 1;
            let Some(exit) = sloped::<Portable>(tables, &ray, cell, starts) else { continue };
            same += 1;
            assert_eq!(exit.link, slow.link, "{ray:?} {cell}");
            let t = exit.exact_of(tables, &ray, cell);
            assert!((t - slow.at_most()).abs() < 1e-9 && t == exit.at_most(), "{t} {}", slow.at_most());
            through[match exit.by().unwrap() {
                DOWN => 0,
                UP => 1,
                _ => 2,
            }] += 1;
        }
        assert!(same * 100 > all * 99, "{same} of {all}");
        assert!(through.iter().all(|&count| count > 1000), "{through:?}");
    }
}
