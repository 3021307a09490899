//! The quick way of a ray: from prism to prism of air to the first triangle of detail or the first face of matter, as long as
//! nothing is in doubt.
//!
//! It goes the way of `cells`, and what it answers is what that would answer, to rounding: a ray that starts well within a
//! prism, passes no edge of a face so near that one hardly aside would go another way, and ends at detail, at a *plain* face, behind
//! which the compiler proved that all over there are triangles of one plane, or at another whose triangles it meets. Any other ray it leaves to
//! others, from its start: to all triangles, or, where the start itself is in doubt, to `cells`; and of rays that start on a surface those that meet
//! anything near it. So it has no case but the
//! common one. No file makes it long, as it enters no more prisms than there are; that plain faces are plain is the file's word.

// Comparisons are written so that NaN is in doubt.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod barred;
mod leaving;
mod rough;
mod sloped;
#[cfg(all(test, feature = "compile"))]
mod tests;

use glam::DVec3;

use super::NONE;
use super::cost::Count;
use super::entries::Entries;
use super::kernel::Ask;
use super::lanes::Lanes;
use super::path::{BEYOND, BLURRED, NEAR, Prisms};
use super::ray::{Brief, Ray};
use super::step::Step;
use super::walk::{Found, Opened, Query, Surface, Walk, inverse, open, walk};
use crate::format::Views;
use crate::format::records::Leaf;
pub(super) use barred::{CELLS, barred, barred_from, is_walled};
pub(super) use leaving::{DOWN, Exit, Passage, UP, is_split, otherwise};
use rough::rough;
pub(super) use sloped::sloped;

/// A direction whose squared length is no farther than this from 1 is unit: no rounding brings it nearer for sure.
pub(super) const UNIT: f64 = 1e-14;

/// Steeper rays, whose directions are shorter than this in the plan, are left to `cells`.
pub(super) const STEEPEST: f64 = 1e-3;

/// Lattices with fewer steps in a metre than 2 to this power reach too far for f32.
pub(super) const COARSEST: u32 = 15;

/// Where a ray runs at a plane more along it than this, its sine, rounding moves what it meets too far.
pub(super) const GRAZING: f64 = 1.0 / 64.0;

/// A ray away from a surface is left to `cells` if it runs more along it than this, its sine: what it starts on is off its plane by roundings, and what
/// cells are rounded by turns their faces.
const SKIMMING: f64 = 1.0 / 1024.0;

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

impl Quick {
    /// Whether there is anything in the way of a ray, for who wants to know no more.
    #[inline(always)]
    pub(super) fn of(is_barred: bool, ray: &Ray, cell: u32) -> Quick {
        let triangle = if is_barred { 0 } else { NONE };
        Quick { found: Found { t: ray.tmax, triangle }, cell, source: NONE }
    }

    /// The same in brief.
    #[inline(always)]
    pub(super) fn brief(&self) -> Brief {
        let Quick { found: Found { t, triangle }, cell, .. } = *self;
        // Part by part: what is made in memory of parts and then copied whole is waited for.
        let is_met = triangle != NONE;
        let Brief { t: far, cell: none, .. } = Brief::ESCAPED;
        Brief { t: if is_met { t } else { far }, triangle, cell: if is_met { cell } else { none } }
    }
}

/// What the ray meets first, which starts in the air of a cell. `None` where there is doubt.
#[inline(always)]
pub(super) fn quick<L: Entries, C: Count>(
    tables: &Views,
    ray: &Ray,
    cell: u32,
    count: &mut C,
) -> Option<Quick> {
    let way = Way::new(tables, ray)?;
    let exit = way.leave::<L>(cell, true);
    // Most end in the cell in which they start. Others are looked at elsewhere, so that nothing is kept for that.
    if !exit.is_plain() {
        return L::onward(Ask::First, tables, ray, cell, exit, count);
    }
    way.at_plate::<L>(cell, exit, count)
}

/// Where a ray leaves a prism of air, in which it starts, or which it came into.
#[inline(always)]
pub(super) fn leave<L: Entries>(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
    Way::new(tables, ray).map_or(Exit::NONE, |way| way.leave::<L>(cell, starts))
}

/// What a ray meets from a cell on, which it leaves at `exit`.
#[inline(always)]
pub(super) fn onward<L: Entries, C: Count>(
    ask: Ask,
    tables: &Views,
    ray: &Ray,
    cell: u32,
    exit: Exit,
    count: &mut C,
) -> Option<Quick> {
    Way::new(tables, ray)?.onward::<L>(ask, cell, exit, count)
}

/// The same of a ray that starts on the surface of a cell, or of what stands in it.
#[inline(always)]
pub(super) fn quick_from<L: Entries, C: Count>(
    tables: &Views,
    ray: &Ray,
    cell: u32,
    surface: &Surface,
    count: &mut C,
) -> Option<Quick> {
    let way = Way::from_surface(tables, ray, surface)?;
    let exit = way.leave_surface::<L>(cell)?;
    let quick = if exit.is_plain() {
        way.at_plate::<L>(cell, exit, count)?
    } else {
        L::onward_from(Ask::First, tables, ray, surface, cell, exit, count)?
    };
    way.clear(quick)
}

/// Whether the quick way takes such a ray at all: one that it left in doubt is then in doubt for where it starts, or for what it comes to.
#[cold]
#[inline(never)]
pub(super) fn takes(tables: &Views, ray: &Ray) -> bool {
    Way::new(tables, ray).is_some()
}

/// Whether it is in no doubt that a ray that starts on a surface starts in the air of a cell: it goes away from that surface, and from each face of the cell that it starts beside,
/// and not along it. What rounding has put it behind it then meets at once.
#[cold]
#[inline(never)]
pub(super) fn starts_clear(tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> bool {
    let (Some(way), Some(record)) =
        (Way::from_surface(tables, ray, surface), tables.cells.get(cell as usize))
    else {
        return false;
    };
    // To no other face it comes sooner.
    let near = FROM_SURFACE;
    let [_, out] = way.margins();
    Prisms::new(tables).leaves_faces(record, [way.from, way.along], [near, out], SKIMMING)
}

/// Whether what a ray from a surface meets, if anything, is nothing near that.
#[inline(always)]
pub(super) fn is_clear_of(surface: &Surface, found: Found) -> bool {
    found.triangle == NONE || found.t >= FROM_SURFACE && found.triangle != surface.triangle
}

/// As [`onward`], of a ray that starts on a surface.
#[inline(always)]
pub(super) fn onward_from<L: Entries, C: Count>(
    ask: Ask,
    tables: &Views,
    ray: &Ray,
    surface: &Surface,
    cell: u32,
    exit: Exit,
    count: &mut C,
) -> Option<Quick> {
    Way { surface: Some(surface), ..Way::new(tables, ray)? }.onward::<L>(ask, cell, exit, count)
}

/// A ray under way. What is seldom asked of it is not told where it is, but works it out anew: so that it stays in registers.
#[derive(Clone, Copy)]
struct Way<'a> {
    tables: &'a Views,
    ray: &'a Ray,
    /// As the ray has them, save that the direction is unit.
    origin: DVec3,
    direction: DVec3,
    limit: f64,
    /// What it starts on, if on anything.
    surface: Option<&'a Surface>,
    /// Along the lattice's axes, from its origin.
    from: DVec3,
    along: DVec3,
    /// More than rounding to f32 moves a line, metres.
    rounding: f32,
}

impl<'a> Way<'a> {
    #[inline(always)]
    fn new(tables: &'a Views, ray: &'a Ray) -> Option<Self> {
        let (scene, direction) = (&tables.scene[0], unit(ray)?);
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
        if !(along.x.abs() + along.y.abs() >= STEEPEST) {
            return None;
        }
        let rounding = tables.airgrid[0].rounding;
        Some(Way { tables, ray, origin, direction, limit: ray.tmax, surface: None, from, along, rounding })
    }

    /// A ray away from a surface that it starts on; `None` in doubt.
    #[inline(always)]
    fn from_surface(tables: &'a Views, ray: &'a Ray, surface: &'a Surface) -> Option<Self> {
        let way = Way { surface: Some(surface), ..Way::new(tables, ray)? };
        // Away from it, and not along it.
        (way.direction.dot(surface.normal) >= SKIMMING).then_some(way)
    }

    /// Where it leaves the cell, if it starts beside no other face of that, and does not leave it beside the surface.
    #[inline(always)]
    fn leave_surface<L: Entries>(&self, cell: u32) -> Option<Exit> {
        /// What f32 says to be no nearer than this, metres, is not looked at again. That is off by more only at an edge that the ray runs along almost, and then it
        /// is far, or the ray starts beside that very edge: in what is behind it nothing near counts either, and a plain face is not met so.
        const FAR: f64 = 0.25;
        let exit = self.leave_from_face::<L>(cell);
        let is_far = exit.at_most() >= FAR && exit.by().is_some();
        (is_far || exit.exact_of(self.tables, self.ray, cell) >= FROM_SURFACE).then_some(exit)
    }

    /// What it meets, if that is nothing near the surface.
    #[inline(always)]
    fn clear(&self, quick: Quick) -> Option<Quick> {
        let is_clear = self.surface.is_none_or(|surface| is_clear_of(surface, quick.found));
        is_clear.then_some(quick)
    }

    /// Whether a cell is left by the kernel for slopes.
    #[inline(always)]
    fn is_sloped(&self, cell: u32) -> bool {
        self.tables.steps.get(cell as usize).is_some_and(Step::is_sloped)
    }

    /// What the ray meets that leaves the cell in which it starts at `exit`, which comes to a plain face.
    #[inline(always)]
    fn at_plate<L: Entries>(&self, cell: u32, exit: Exit, count: &mut impl Count) -> Option<Quick> {
        debug_assert!(exit.is_plain());
        count.cell(|| self.is_sloped(cell));
        count.plain();
        let mut source = exit.link & !Step::PLATE;
        let mut end = self.plate(source)?;
        let (root, until) = (self.root(cell), self.until(end.t));
        if let Some(opened) = self.may_meet::<L>(root, until, count) {
            let found = self.detail::<L>(Ask::First, &opened, (0.0, until), count);
            if found.triangle != NONE && (found.t, found.triangle) < (end.t, end.triangle) {
                (end, source) = (found, NONE);
            }
        }
        Some(self.met(cell, end, source))
    }

    /// Nearer to a face than the first of these, metres, it starts beside that, farther behind it than the second not in the cell.
    #[inline(always)]
    fn margins(&self) -> [f64; 2] {
        // In small models another cell may be as near as cells are blurred.
        let out = BLURRED.min(self.tables.scene[0].tolerance.max(2.0 * f64::from(self.rounding)));
        [2.0 * BLURRED, out]
    }

    /// Whether the ray starts in a prism of air, or beside one face of it: where it starts beside more, what stands behind one of them
    /// may come before another by what cells are blurred.
    #[inline(always)]
    fn starts_beside<L: Lanes>(&self, cell: u32) -> bool {
        let (Some(step), Some(record)) =
            (self.tables.steps.get(cell as usize), self.tables.cells.get(cell as usize))
        else {
            return false;
        };
        let ([near, out], rounding) = (self.margins(), f64::from(self.rounding));
        let (mut beside, mut is_in) = if step.is_some() {
            let (inward, size) = step.inward::<L>([self.from.x, self.from.y]);
            let edges = (1u32 << step.corners) - 1;
            let beside = (edges & !beyond(inward, size, near + rounding)).count_ones();
            (beside, beyond(inward, size, rounding - out) & edges == edges)
        } else {
            let at = [self.from.x, self.from.y];
            let edges = Prisms::new(self.tables).edges_beside(record, at, near + rounding, out);
            let Some(edges) = edges else { return false };
            edges
        };
        for (plane, up) in [(record.floor, 1.0), (record.ceiling, -1.0)] {
            let [p, q] = self.tables.planes[plane as usize].slope;
            let (within, tilt) = (self.over(plane).0 * up, 1.0 + p.abs() + q.abs());
            beside += u32::from(!(within >= near * tilt));
            is_in &= within >= -out * tilt;
        }
        is_in && beside <= 1
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

    /// What it meets where it leaves a cell at `exit`, if that ends its way, and the source of that if the very triangle is not known.
    #[inline(always)]
    fn end(&self, exit: &Exit, cell: u32, count: &mut impl Count) -> Option<(Found, u32)> {
        if exit.link >= Step::ROUGH {
            return rough(self.tables, self.ray, self.surface, cell, exit, count).map(|found| (found, NONE));
        }
        count.plain();
        let source = exit.link & !Step::PLATE;
        self.plate(source).map(|found| (found, source))
    }

    /// What the ray meets from a cell on, which it leaves at `exit`.
    #[inline(always)]
    fn onward<L: Entries>(
        &self,
        ask: Ask,
        mut cell: u32,
        mut here: Exit,
        count: &mut impl Count,
    ) -> Option<Quick> {
        let tables = self.tables;
        // The cell in which it ends, once it is followed farther than that.
        let mut past = NONE;
        // Each once.
        for _ in 0..tables.cells.len() {
            count.cell(|| self.is_sloped(cell));
            // What stands behind the face, if that ends the way.
            let (mut end, mut source) = (Found { t: f64::INFINITY, triangle: NONE }, NONE);
            let ends = here.link & Step::PLATE != 0 && here.link != Step::AROUND;
            if ends {
                let Some(known) = self.end(&here, cell, count) else {
                    // What comes after its end is no reason to doubt that, but for a face that it comes to almost along it.
                    let has_ended = here.link == Step::OTHER && past != NONE;
                    return has_ended.then(|| self.nothing(past));
                };
                (end, source) = known;
            }
            let root = self.root(cell);
            let until = self.until(if ends { end.t } else { here.at_most() });
            if let Some(opened) = self.may_meet::<L>(root, until, count) {
                let found = self.detail::<L>(ask, &opened, (0.0, until), count);
                // Before a face, or not behind where the ray leaves: there something of another cell may come first.
                let is_here = found.triangle != NONE
                    && (found.t, found.triangle) < (end.t, end.triangle)
                    && (ends || ask == Ask::Any || found.t <= self.exact(&here, cell) + NEAR);
                if is_here {
                    (end, source) = (found, NONE);
                }
            }
            if end.triangle != NONE {
                return Some(self.met(cell, end, source));
            }
            if here.at_most() > self.limit {
                let beyond = here.exact_of(tables, self.ray, cell) - self.limit;
                if beyond > BEYOND * tables.scene[0].tolerance {
                    return Some(self.nothing(cell));
                }
                if past == NONE && self.is_clear(&here, cell, beyond) {
                    past = cell;
                }
            }
            if here.link == Step::AROUND {
                // Where cells say that it leaves them, or a little before: what it passed within them it did not meet.
                let from = here.exact_of(tables, self.ray, cell) - NEAR;
                let opened = Opened::not_yet(tables.cells[0].root);
                let found = self.detail::<L>(ask, &opened, (from, self.limit), count);
                return Some(if found.triangle == NONE {
                    self.nothing(0)
                } else {
                    Quick { found, cell: 0, source: NONE }
                });
            }
            cell = here.link;
            here = self.leave::<L>(cell, false);
        }
        None
    }

    /// Whether a ray that leaves a cell so far beyond its end is there, by more than cells are rounded, before the face that it leaves through.
    #[cold]
    #[inline(never)]
    fn is_clear(&self, exit: &Exit, cell: u32, beyond: f64) -> bool {
        let prisms = Prisms::new(self.tables);
        beyond > self.tables.scene[0].tolerance
            && self.outward(exit, cell).is_some_and(|outward| prisms.ends_before(outward, self.along, beyond))
    }

    /// What ends the way, if the ray comes so far.
    #[inline(always)]
    fn met(&self, cell: u32, end: Found, source: u32) -> Quick {
        if end.t <= self.limit { Quick { found: end, cell, source } } else { self.nothing(cell) }
    }

    /// The detail of a root that it may meet before `until`.
    #[inline(always)]
    fn may_meet<L: Lanes>(&self, root: u32, until: f64, count: &mut impl Count) -> Option<Opened> {
        if root == NONE {
            count.empty();
            return None;
        }
        if root & Leaf::BIT != 0 {
            return Some(Opened::not_yet(root));
        }
        count.node();
        let scene = &self.tables.scene[0];
        let direction = self.direction.as_vec3().to_array();
        let local = (self.origin - DVec3::from(scene.center)).as_vec3().to_array();
        may_meet::<L>(self.tables, root, local, inverse(direction), until as f32)
    }

    /// The end of a search for detail before `t`.
    #[inline(always)]
    fn until(&self, t: f64) -> f64 {
        let until = t + NEAR;
        if until < self.limit { until } else { self.limit }
    }

    /// The root of the detail of a cell that the ray leaves.
    #[inline(always)]
    fn root(&self, cell: u32) -> u32 {
        let step = &self.tables.steps[cell as usize];
        if step.is_some() { step.root } else { self.tables.cells[cell as usize].root }
    }

    #[inline(always)]
    fn detail<L: Entries>(
        &self,
        ask: Ask,
        opened: &Opened,
        range: (f64, f64),
        count: &mut impl Count,
    ) -> Found {
        L::detail(ask, self.tables, self.ray, self.surface, opened, range, count)
    }

    #[inline(always)]
    fn nothing(&self, cell: u32) -> Quick {
        nothing(self.limit, cell)
    }
}

/// That a ray ends at `limit`, in a cell.
#[inline(always)]
pub(super) fn nothing(limit: f64, cell: u32) -> Quick {
    Quick { found: Found { t: limit, triangle: NONE }, cell, source: NONE }
}

/// The detail of a root, which is a node, that a ray may meet before `until`: from a place relative to the scene's center, 1 by its
/// direction.
#[inline(always)]
pub(super) fn may_meet<L: Lanes>(
    tables: &Views,
    root: u32,
    local: [f32; 3],
    inverse: [f32; 3],
    until: f32,
) -> Option<Opened> {
    let slack = tables.scene[0].slack;
    // A little more, for what f32 made of it.
    let range = [-slack, until + until * 2e-6 + slack];
    Opened::new(root, open::<L>(&tables.nodes[root as usize], local, inverse, range))
}

/// The edges (lane i is bit i) that a point is farther within than a margin: `inward` by each, times its `size`, from one end to the other
/// along each axis.
#[inline(always)]
fn beyond<L: Lanes>(inward: L, size: L, margin: f64) -> u32 {
    L::bits(size.mul(L::splat(margin as f32)).le(inward))
}

/// The ray's direction at unit length.
#[inline(always)]
fn unit(ray: &Ray) -> Option<DVec3> {
    let direction = DVec3::from(ray.direction);
    let squared = direction.length_squared();
    if (squared - 1.0).abs() <= UNIT {
        return Some(direction);
    }
    (squared > 1e-100 && squared < 1e100).then(|| direction / squared.sqrt())
}

/// What the ray meets of a hierarchy between two places along it.
#[inline(always)]
pub(super) fn detail<L: Lanes, C: Count>(
    ask: Ask,
    tables: &Views,
    ray: &Ray,
    surface: Option<&Surface>,
    opened: &Opened,
    (from, until): (f64, f64),
    count: &mut C,
) -> Found {
    let Some(direction) = unit(ray) else { return Found { t: until, triangle: NONE } };
    // Also what is behind it by no more than rounding: that is asked about.
    let first = from.max(0.0) - surface.map_or(0.0, |surface| surface.behind());
    let origin = DVec3::from(ray.origin);
    let query = Query::new(origin, direction, (first, until), 0.0, &tables.scene[0], opened.root, surface);
    walk::<L>(ask, &Walk::new(tables), &query, Some(opened), count)
}
