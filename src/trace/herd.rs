//! Some of eight rays through one hierarchy of boxes, together: as `walk` for each of them, and with the same answers.
//!
//! Boxes and triangles are looked at one after the other, each by all rays at once: f32 first, with the error bounds of `walk`, then f64 as
//! [`Query::test`] has it. What that finds does not depend on the order in which triangles are tested, so the answers are those of `walk`
//! to the last bit.

// For packets, which portable lanes do without.
#![cfg_attr(not(target_arch = "x86_64"), allow(dead_code))]

use arrayvec::ArrayVec;
use glam::DVec3;

use super::NONE;
use super::kernel::Ask;
use super::lanes::{Lanes, Wide};
use super::walk::{EDGE_ON, Found, LEAST, Query, ROUNDING, STACK, Walk};
use crate::format::records::{LANES, Leaf, NodeRecord, SceneRecord};

/// Rays that start at their origins, with unit directions.
pub(super) struct Herd<L: Lanes> {
    pub(super) origin: [L::Wide; 3],
    pub(super) direction: [L::Wide; 3],
}

/// What each ray has met so far.
pub(super) struct Nearest {
    pub(super) t: [f64; LANES],
    pub(super) triangle: [u32; LANES],
}

/// Rays in f32, as boxes and blocks are.
#[derive(Clone, Copy)]
pub(super) struct Rounded<L> {
    /// From the scene's center.
    pub(super) local: [L; 3],
    toward: [L; 3],
    pub(super) inverse: [L; 3],
}

impl<L: Lanes> Rounded<L> {
    #[inline(always)]
    pub(super) fn new(scene: &SceneRecord, origin: &[L::Wide; 3], direction: &[L::Wide; 3]) -> Self {
        let (one, least) = (L::splat(1.0), L::splat(LEAST));
        let (mut local, mut toward, mut inverse) = ([one; 3], [one; 3], [one; 3]);
        for axis in 0..3 {
            local[axis] = L::narrow(origin[axis].sub(L::Wide::splat(scene.center[axis])));
            toward[axis] = L::narrow(direction[axis]);
            inverse[axis] = one.div(toward[axis].abs().max(least).flip(toward[axis]));
        }
        Rounded { local, toward, inverse }
    }

    /// Between where the rays are in a node's box, after `near` and before `far`.
    #[inline(always)]
    pub(super) fn span(&self, node: &NodeRecord, child: usize, mut near: L, mut far: L) -> (L, L) {
        for axis in 0..3 {
            let (lo, hi) = (L::splat(node.lo[axis][child]), L::splat(node.hi[axis][child]));
            let a = lo.sub(self.local[axis]).mul(self.inverse[axis]);
            let b = hi.sub(self.local[axis]).mul(self.inverse[axis]);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near, far)
    }
}

/// A leaf that some rays may come to.
#[derive(Clone, Copy)]
pub(super) struct Near {
    /// Its link, and the triangles, by their lanes, that they may meet.
    pub(super) leaf: u32,
    pub(super) triangles: u32,
    /// The node that has it, if any, and as which child.
    pub(super) node: u32,
    pub(super) child: u8,
    /// They come no sooner to it.
    pub(super) depth: f32,
}

/// No farther than what has been met, as `Query::limit` has it.
#[inline(always)]
fn limit<L: Lanes>(scene: &SceneRecord, met: L::Wide) -> L {
    let limit = L::narrow(met);
    limit.add(limit.abs().mul(L::splat(1.000_001e-6))).add(L::splat(scene.slack))
}

/// Rays under way through a hierarchy.
struct Course<'a, 'w, L: Lanes> {
    walk: &'a Walk<'w>,
    herd: &'a Herd<L>,
    rounded: Rounded<L>,
    /// The rays that look for something.
    active: u32,
    /// Nothing that matters is farther.
    limit: L,
    best: Nearest,
    /// The axis along which most rays run, see [`Query::test`]; those that do, and how they are sheared.
    axis: usize,
    sheared: u32,
    shear: [L::Wide; 3],
    /// Bounds of what each ray is off.
    farthest: L::Wide,
}

/// What the rays of a mask (lane i is bit i) meet under `root` no farther than `until`, first or at all; the triangle is
/// [`NONE`] of those that meet nothing.
#[inline(always)]
pub(super) fn together<L: Lanes>(
    ask: Ask,
    walk: &Walk<'_>,
    herd: &Herd<L>,
    rays: u32,
    root: u32,
    until: L::Wide,
) -> Nearest {
    let rounded = Rounded::new(walk.scene, &herd.origin, &herd.direction);
    let mut course = Course::new(walk, herd, rounded, rays, until);
    course.run(ask, root);
    course.best
}

/// The same of the leaves that are near, the nearest of which come first.
#[inline(always)]
pub(super) fn leaves<L: Lanes>(
    ask: Ask,
    walk: &Walk<'_>,
    herd: &Herd<L>,
    rays: u32,
    near: &[Near],
    until: L::Wide,
) -> Nearest {
    let rounded = Rounded::new(walk.scene, &herd.origin, &herd.direction);
    let mut limit = limit::<L>(walk.scene, until);
    let mut course: Option<Course<'_, '_, L>> = None;
    let first = L::splat(-walk.scene.slack);
    for leaf in near {
        let mut there = rays;
        if let Some(node) = walk.nodes.get(leaf.node as usize) {
            let (from, to) = rounded.span(node, usize::from(leaf.child), first, limit);
            there &= L::bits(from.le(to));
        }
        if there == 0 {
            continue;
        }
        if course.is_none() {
            course = Some(Course::new(walk, herd, rounded, rays, until));
        }
        if let Some(course) = &mut course {
            course.leaf(ask, Leaf::new(leaf.leaf), leaf.triangles, there);
            limit = course.limit;
        }
    }
    match course {
        Some(course) => course.best,
        None => Nearest { t: until.store(), triangle: [NONE; LANES] },
    }
}

impl<'a, 'w, L: Lanes> Course<'a, 'w, L> {
    #[inline(always)]
    fn new(walk: &'a Walk<'w>, herd: &'a Herd<L>, rounded: Rounded<L>, rays: u32, until: L::Wide) -> Self {
        let scene = walk.scene;
        let size = [herd.direction[0].abs(), herd.direction[1].abs(), herd.direction[2].abs()];
        let along_x = !size[0].le(size[1]) & !size[0].le(size[2]);
        let along_y = !along_x & !size[1].le(size[2]);
        let axes = [rays & along_x, rays & along_y, rays & !along_x & !along_y];
        let axis =
            (1..3).fold(
                0,
                |most, axis| {
                    if axes[axis].count_ones() > axes[most].count_ones() { axis } else { most }
                },
            );
        let [kx, ky] = [(axis + 1) % 3, (axis + 2) % 3];
        let per = L::Wide::splat(1.0).div(herd.direction[axis]);
        let shear = [herd.direction[kx].mul(per), herd.direction[ky].mul(per), per];
        let most = herd.origin[0].abs().max(herd.origin[1].abs()).max(herd.origin[2].abs());
        let [lo, hi] = [DVec3::from(scene.hull[0]).abs(), DVec3::from(scene.hull[1]).abs()];
        let farthest = most.add(L::Wide::splat(lo.max(hi).max_element()));
        let best = Nearest { t: until.store(), triangle: [NONE; LANES] };
        let mut course = Course {
            walk,
            herd,
            rounded,
            active: rays,
            limit: L::splat(0.0),
            best,
            axis,
            sheared: axes[axis],
            shear,
            farthest,
        };
        course.tighten();
        course
    }

    #[inline(always)]
    fn tighten(&mut self) {
        self.limit = limit::<L>(self.walk.scene, L::Wide::load(&self.best.t));
    }

    #[inline(always)]
    fn run(&mut self, ask: Ask, root: u32) {
        let first = L::splat(-self.walk.scene.slack);
        let lead = (self.active.trailing_zeros() as usize).min(LANES - 1);
        let mut stack = ArrayVec::<(u32, L), STACK>::new();
        let (mut current, mut rays) = (root, self.active);
        loop {
            if current & Leaf::BIT != 0 {
                self.leaf(ask, Leaf::new(current), u32::MAX, rays);
                if self.active == 0 {
                    return;
                }
            } else {
                let node = &self.walk.nodes[current as usize];
                let bottom = stack.len();
                for child in 0..LANES {
                    if node.child[child] == NONE {
                        continue;
                    }
                    let (near, far) = self.rounded.span(node, child, first, self.limit);
                    if L::bits(near.le(far)) & rays == 0 {
                        continue;
                    }
                    // Of a ray that does not come to the box, where it would be farther than all.
                    let near = L::select(near.le(far), near, L::splat(f32::INFINITY));
                    let key = near.store()[lead];
                    let mut place = stack.len();
                    stack.push((node.child[child], near));
                    // The nearest on top.
                    while place > bottom && stack[place - 1].1.store()[lead] < key {
                        stack.swap(place - 1, place);
                        place -= 1;
                    }
                }
            }
            loop {
                let Some((node, near)) = stack.pop() else { return };
                rays = L::bits(near.le(self.limit)) & self.active;
                if rays != 0 {
                    current = node;
                    break;
                }
            }
        }
    }

    /// Looks at triangles of a leaf, by their lanes: as `walk` does, in its `candidates`.
    #[inline(always)]
    fn leaf(&mut self, ask: Ask, leaf: Leaf, triangles: u32, rays: u32) {
        let block = &self.walk.blocks[leaf.block()];
        let slack = self.walk.scene.slack;
        let ([ox, oy, oz], [dx, dy, dz]) = (self.rounded.local, self.rounded.toward);
        let zero = L::splat(0.0);
        for lane in leaf.lanes() {
            let triangle = block.triangle[lane];
            if triangle == NONE || triangles >> lane & 1 == 0 {
                continue;
            }
            let at = [block.corner[0][lane], block.corner[1][lane], block.corner[2][lane]];
            let e1 = [block.edge1[0][lane], block.edge1[1][lane], block.edge1[2][lane]];
            let e2 = [block.edge2[0][lane], block.edge2[1][lane], block.edge2[2][lane]];
            let n1 = e1[0].abs() + e1[1].abs() + e1[2].abs();
            let n2 = e2[0].abs() + e2[1].abs() + e2[2].abs();
            let (slack1, slack2) = (L::splat(n1 * slack), L::splat(n2 * slack));
            let slack12 = L::splat(n1 * (n2 * slack));
            let edge_on = L::splat(n1 * n2 * EDGE_ON);
            let e1 = [L::splat(e1[0]), L::splat(e1[1]), L::splat(e1[2])];
            let e2 = [L::splat(e2[0]), L::splat(e2[1]), L::splat(e2[2])];
            let px = dy.mul_sub(e2[2], dz.mul(e2[1]));
            let py = dz.mul_sub(e2[0], dx.mul(e2[2]));
            let pz = dx.mul_sub(e2[1], dy.mul(e2[0]));
            let det = e1[0].mul_add(px, e1[1].mul_add(py, e1[2].mul(pz)));
            let size = det.abs();
            let (sx, sy, sz) = (ox.sub(L::splat(at[0])), oy.sub(L::splat(at[1])), oz.sub(L::splat(at[2])));
            let u = sx.mul_add(px, sy.mul_add(py, sz.mul(pz))).flip(det);
            let qx = sy.mul_sub(e1[2], sz.mul(e1[1]));
            let qy = sz.mul_sub(e1[0], sx.mul(e1[2]));
            let qz = sx.mul_sub(e1[1], sy.mul(e1[0]));
            let v = dx.mul_add(qx, dy.mul_add(qy, dz.mul(qz))).flip(det);
            let t = e2[0].mul_add(qx, e2[1].mul_add(qy, e2[2].mul(qz))).flip(det);
            let inside = L::and(zero.sub(slack2).le(u), zero.sub(slack1).le(v));
            let inside = L::and(inside, u.add(v).le(size.add(slack1).add(slack2)));
            let ahead = zero.sub(slack12).le(t);
            let near = t.le(size.mul(self.limit).add(slack12));
            let met = L::or(L::and(inside, L::and(ahead, near)), size.le(edge_on));
            let met = L::bits(met) & rays & self.active;
            if met != 0 {
                self.test(ask, triangle, met);
            }
        }
    }

    /// Decides in f64 which rays meet a triangle nearer than what they have met.
    #[inline(always)]
    fn test(&mut self, ask: Ask, triangle: u32, rays: u32) {
        let walk = self.walk;
        let (mut met, mut alone) = (0, rays & !self.sheared);
        if rays & self.sheared != 0 {
            let corners = walk.corners(triangle);
            let [kx, ky, kz] = [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis];
            let [sx, sy, sz] = self.shear;
            let origin = &self.herd.origin;
            let zero = L::Wide::splat(0.0);
            let mut at = [[zero; 3]; 3];
            for (to, corner) in at.iter_mut().zip(corners) {
                let corner = corner.to_array();
                let z = L::Wide::splat(corner[kz]).sub(origin[kz]);
                *to = [
                    L::Wide::splat(corner[kx]).sub(origin[kx]).sub(sx.mul(z)),
                    L::Wide::splat(corner[ky]).sub(origin[ky]).sub(sy.mul(z)),
                    sz.mul(z),
                ];
            }
            let [a, b, c] = at;
            let u = c[0].mul(b[1]).sub(c[1].mul(b[0]));
            let v = a[0].mul(c[1]).sub(a[1].mul(c[0]));
            let w = b[0].mul(a[1]).sub(b[1].mul(a[0]));
            let unsure = L::Wide::splat(ROUNDING)
                .mul(L::Wide::splat(3.0).mul(self.farthest))
                .mul(L::Wide::splat(12.0).mul(self.farthest));
            let under = zero.sub(unsure);
            let negative = !under.le(u) | !under.le(v) | !under.le(w);
            let positive = !u.le(unsure) | !v.le(unsure) | !w.le(unsure);
            let clear = !u.abs().le(unsure) & !v.abs().le(unsure) & !w.abs().le(unsure);
            let through = rays & self.sheared & !(negative & positive);
            alone |= through & !clear;
            let through = through & clear;
            if through != 0 {
                let sum = u.mul(a[2]).add(v.mul(b[2])).add(w.mul(c[2]));
                let t = sum.div(u.add(v).add(w));
                let (nearest, farthest) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
                let t = t.max(nearest).min(farthest);
                let ahead = through & zero.le(t) & t.le(L::Wide::load(&self.best.t));
                let mut rest = ahead;
                let t = t.store();
                while rest != 0 {
                    let lane = rest.trailing_zeros() as usize;
                    rest &= rest - 1;
                    if t[lane] == self.best.t[lane] && triangle >= self.best.triangle[lane] {
                        continue;
                    }
                    (self.best.t[lane], self.best.triangle[lane]) = (t[lane], triangle);
                    met |= 1 << lane;
                }
            }
        }
        while alone != 0 {
            let lane = alone.trailing_zeros() as usize;
            alone &= alone - 1;
            let mut best = Found { t: self.best.t[lane], triangle: self.best.triangle[lane] };
            let (origin, direction) =
                (self.vector(&self.herd.origin, lane), self.vector(&self.herd.direction, lane));
            if alone_test(walk, origin, direction, triangle, &mut best) {
                (self.best.t[lane], self.best.triangle[lane]) = (best.t, best.triangle);
                met |= 1 << lane;
            }
        }
        if met != 0 {
            if ask == Ask::Any {
                self.active &= !met;
            }
            self.tighten();
        }
    }

    #[inline(always)]
    fn vector(&self, of: &[L::Wide; 3], lane: usize) -> DVec3 {
        DVec3::new(of[0].store()[lane], of[1].store()[lane], of[2].store()[lane])
    }
}

/// The same of one ray.
#[inline(never)]
fn alone_test(walk: &Walk<'_>, origin: DVec3, direction: DVec3, triangle: u32, best: &mut Found) -> bool {
    let query = Query::new(origin, direction, (0.0, best.t), 0.0, walk.scene, NONE, None);
    query.test(walk, triangle, best)
}
