//! Eight rays, as they are given, and what ends their ways.

use super::answers::Group;
use super::plates::dot;
use super::{ALL, lanes};
use crate::format::Views;
use crate::format::records::LANES;
use crate::trace::NONE;
use crate::trace::entries::Entries;
use crate::trace::herd::Near;
use crate::trace::lanes::{Lanes, Wide};
use crate::trace::quick::{GRAZING, Quick, UNIT};
use crate::trace::ray::Ray;
use crate::trace::step::Step;
use crate::trace::walk::Found;

/// Eight rays.
#[derive(Clone, Copy)]
pub(super) struct Eight<'a, L: Lanes> {
    pub(super) tables: &'a Views,
    pub(super) rays: [&'a Ray; LANES],
    /// Those that have neither ended nor come into doubt.
    pub(super) under_way: u32,
    /// As `Way` has them.
    pub(super) origin: [L::Wide; 3],
    pub(super) direction: [L::Wide; 3],
    pub(super) limit: L::Wide,
}

impl<'a, L: Entries> Eight<'a, L> {
    /// Reads rays. Under way are those that `quick` would take, as far as it does not look at their directions in the plan, nor where they go.
    #[inline(always)]
    pub(super) fn new(tables: &'a Views, rays: [&'a Ray; LANES]) -> Self {
        let mut rows = [[&[0.0; 4]; LANES]; 2];
        for (lane, ray) in rays.into_iter().enumerate() {
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
        Eight { tables, rays, under_way, origin: [ox, oy, oz], direction: [dx, dy, dz], limit }
    }

    /// Origins and directions along the lattice's axes, from its origin.
    #[inline(always)]
    pub(super) fn turned(&self) -> [[L::Wide; 3]; 2] {
        let scene = &self.tables.scene[0];
        let ([ox, oy, oz], [dx, dy, dz]) = (self.origin, self.direction);
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
        [[x, y, z], [along_x, along_y, dz]]
    }

    /// Ends the ways of those rays that meet detail of a simple prism, which all leave by an edge no later than at `exit`; of leaves only
    /// what is told to be near, if that is.
    #[inline(always)]
    pub(super) fn pass_detail(
        &mut self,
        near: Option<&[Near]>,
        step: &Step,
        edge: usize,
        exit: L,
        group: &mut Group<'_>,
    ) {
        let detail = (step.root, near);
        let touched = self.touched(detail, exit);
        if touched == 0 {
            return;
        }
        let found = self.detail(group.ask, touched, detail, self.passes(step, edge));
        for lane in lanes(touched) {
            if found.triangle[lane] != NONE {
                let met = Found { t: found.t[lane], triangle: found.triangle[lane] };
                let quick = Quick { found: met, cell: group.cells[lane], source: NONE };
                group.put(lane, quick, self.rays[lane].tmax);
                self.under_way &= !(1 << lane);
            }
        }
    }

    /// Ends the ways of all rays at the plane of a source, or at detail of the prism before it, of leaves only what is told to be near, if that
    /// is; whether that is in no doubt.
    #[inline(always)]
    pub(super) fn end(
        &mut self,
        near: Option<&[Near]>,
        step: &Step,
        source: u32,
        group: &mut Group<'_>,
    ) -> bool {
        let all = self.under_way;
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
        let detail = (step.root, near);
        let touched = if open == 0 { 0 } else { open & self.touched(detail, L::narrow(t.min(self.limit))) };
        group.put_plane(all, t, self.limit, plate.triangle, source);
        if touched != 0 {
            let met = t.store();
            let found = self.detail(group.ask, touched, detail, t);
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

    /// Where the rays pass an edge of a simple prism, or its floor or its ceiling: as `Way::passes` has it.
    #[inline(always)]
    fn passes(&self, step: &Step, edge: usize) -> L::Wide {
        let [[x, y, z], [ax, ay, az]] = self.turned();
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
}
