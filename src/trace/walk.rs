//! One ray through a hierarchy of boxes to the nearest triangle.
//!
//! Boxes and a first look at the triangles are in f32, eight at a time, and *conservative*: boxes are inflated and
//! the triangle test is slack by [`SceneRecord::slack`](crate::format::records::SceneRecord::slack), which bounds all
//! rounding of coordinates, origin, direction and arithmetic (`docs/ARCHITECTURE.md`, "Exact hits from f32 boxes").
//! What passes, one or two triangles a ray, is decided in f64 on the source's own vertices, by the shear test of Woop,
//! Benthin and Wald (Watertight Ray/Triangle Intersection, JCGT 2(1), 2013): its edge functions are antisymmetric to
//! the last bit, so that a ray cannot slip between two triangles that share an edge. The answer is the same for
//! every kernel, bit for bit.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::NONE;
use super::cost::Count;
use super::kernel::Ask;
use super::lanes::Lanes;
use crate::format::records::{BlockRecord, LANES, Leaf, NodeRecord, RunRecord, SceneRecord, VolumeRecord};
use crate::format::{MAX_DEPTH, Views};

/// Room for the children that wait while one is visited, at every level of any hierarchy: a file's, under the node that
/// `closing` puts over it. `herd` puts all children of a node here before it takes one: that is the 1.
pub(super) const STACK: usize = (MAX_DEPTH as usize + 1) * (LANES - 1) + 1;

/// Least size of a direction's component in the box test: smaller ones move a ray by less than the slack.
pub(super) const LEAST: f32 = 1e-9;

/// As `array::map`, which is not always inlined: a tenth of a short ray's time.
#[inline(always)]
pub(super) fn each<T, U>([x, y, z]: [T; 3], to: impl Fn(T) -> U) -> [U; 3] {
    [to(x), to(y), to(z)]
}

/// 1 by each component of a direction, none of them 0.
#[inline(always)]
pub(super) fn inverse(direction: [f32; 3]) -> [f32; 3] {
    each(direction, |d| 1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d })
}

/// The tables that a walk reads.
pub(super) struct Walk<'a> {
    pub(super) nodes: &'a [NodeRecord],
    pub(super) blocks: &'a [BlockRecord],
    triangles: &'a [[u32; 3]],
    runs: &'a [RunRecord],
    run_of: &'a [u32],
    vertices: &'a [[f64; 3]],
    volumes: &'a [VolumeRecord],
    pub(super) scene: &'a SceneRecord,
}

impl<'a> Walk<'a> {
    /// The corners of a triangle.
    #[inline(always)]
    pub(super) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        each(self.triangles[triangle as usize], |v| DVec3::from(self.vertices[v as usize]))
    }

    /// The volume that a triangle is of, or none.
    fn volume_of(&self, triangle: u32) -> u32 {
        self.run_of.get(triangle as usize).map_or(NONE, |&run| self.runs[run as usize].volume)
    }

    /// Whether two triangles are of one element.
    pub(super) fn are_of_one(&self, one: u32, other: u32) -> bool {
        let element =
            |triangle: u32| self.run_of.get(triangle as usize).map(|&run| self.runs[run as usize].element);
        element(one) == element(other)
    }

    /// Whether a triangle is the one of a surface, or of the same element and in one plane with it there, as far as what is bent by roundings is one
    /// plane.
    pub(super) fn is_part_of(&self, triangle: u32, surface: &Surface, there: DVec3) -> bool {
        if triangle == surface.triangle {
            return true;
        }
        if triangle == NONE || !self.are_of_one(triangle, surface.triangle) {
            return false;
        }
        let [a, b, c] = self.corners(triangle);
        let normal = (b - a).cross(c - a);
        let size = normal.length();
        normal.dot(surface.normal).abs() >= (1.0 - PARALLEL) * size
            && normal.dot(there - a).abs() <= ONE_PLANE.max(surface.near) * size
    }

    /// Whether a triangle's normal looks the other way than `normal`, or there is no such triangle.
    fn looks_against(&self, triangle: u32, normal: DVec3) -> bool {
        let Some(&corners) = self.triangles.get(triangle as usize) else { return true };
        let [a, b, c] = each(corners, |v| DVec3::from(self.vertices[v as usize]));
        (b - a).cross(c - a).dot(normal) < 0.0
    }

    /// Whether a ray along `direction` comes to the triangle from the side that `outward` comes from.
    #[inline]
    pub(super) fn enters(&self, triangle: u32, outward: DVec3, direction: DVec3) -> bool {
        let [a, b, c] = self.corners(triangle);
        let normal = (b - a).cross(c - a);
        normal.dot(outward) * normal.dot(direction) > 0.0
    }

    #[inline]
    pub(super) fn new(tables: &'a Views) -> Walk<'a> {
        Walk {
            nodes: &tables.nodes,
            blocks: &tables.blocks,
            triangles: &tables.triangles,
            runs: &tables.runs,
            run_of: &tables.run_of,
            vertices: &tables.vertices,
            volumes: &tables.volumes,
            scene: &tables.scene[0],
        }
    }
}

/// The nearest hit so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Distance, metres.
    pub(super) t: f64,
    /// The triangle, or [`NONE`].
    pub(super) triangle: u32,
}

/// The surface that a restarted ray starts on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// Hits on this triangle do not count.
    pub(super) triangle: u32,
    /// Its unit normal, either way.
    pub(super) normal: DVec3,
    /// How far, metres, the ray's origin may be off this surface and those that meet it there, by rounding.
    pub(super) near: f64,
    /// How far, metres, it may have been moved off its own plane besides.
    pub(super) aside: f64,
    /// Hits before this do not count, save on solids that the ray enters where it starts.
    pub(super) tmin: f64,
}

/// A plane no farther than [`Surface::near`] is met no farther behind than this many times as far, unless the ray runs
/// almost in it.
const BEHIND: f64 = 1e4;

impl Surface {
    /// How far, metres, behind the ray's origin anything is looked for.
    #[inline(always)]
    pub(super) fn behind(&self) -> f64 {
        BEHIND * self.near
    }
}

/// Normals at a smaller angle than the root of twice this belong to one plane.
const PARALLEL: f64 = 1e-10;

/// Two planes of one element no farther apart than this, metres, are one: a pane whose corners are rounded is bent by as much.
const ONE_PLANE: f64 = 1e-9;

/// A ray made ready for a walk.
pub(super) struct Query<'s> {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) tmin: f64,
    /// Of what it meets just at `tmin`, triangles before this one do not count.
    least: u32,
    tmax: f64,
    /// Where along the ray the f32 copy starts: its entry into the hull.
    start: f64,
    local: [f32; 3],
    toward: [f32; 3],
    inverse: [f32; 3],
    pub(super) surface: Option<&'s Surface>,
    root: u32,
}

impl<'s> Query<'s> {
    /// A ray from `origin` along the unit vector `direction`. Its f32 copy starts at `start` along it, where it is
    /// within the hull.
    #[inline]
    pub(super) fn new(
        origin: DVec3,
        direction: DVec3,
        (tmin, tmax): (f64, f64),
        start: f64,
        scene: &SceneRecord,
        root: u32,
        surface: Option<&'s Surface>,
    ) -> Self {
        let local = (origin + direction * start - DVec3::from(scene.center)).as_vec3().to_array();
        let toward = direction.as_vec3().to_array();
        let inverse = inverse(toward);
        Query { origin, direction, tmin, least: 0, tmax, start, local, toward, inverse, surface, root }
    }

    /// How far, metres, anything that the ray meets is from its origin along an axis at most.
    #[inline(always)]
    fn farthest(&self, scene: &SceneRecord) -> f64 {
        let [lo, hi] = scene.hull.map(|corner| DVec3::from(corner).abs());
        self.origin.abs().max_element() + lo.max(hi).max_element()
    }

    /// The f32 distance, from `local`, beyond which nothing is nearer than `t`.
    #[inline(always)]
    fn limit(&self, t: f64, slack: f32) -> f32 {
        let limit = (t - self.start) as f32;
        limit + limit.abs() * 1e-6 + slack
    }

    /// The same ray from now on looks at the hierarchy under `root`, no farther than `tmax`.
    #[inline(always)]
    pub(super) fn aim(&mut self, root: u32, tmax: f64) {
        self.root = root;
        self.tmax = tmax;
    }

    /// From now on only what it meets after `t` counts, and just there triangles from `least` on.
    #[inline(always)]
    pub(super) fn follow(&mut self, t: f64, least: u32) {
        (self.tmin, self.least) = (t, least);
    }

    /// Decides in f64 whether the ray meets the triangle nearer than `best`.
    #[inline(always)]
    pub(super) fn test(&self, walk: &Walk<'_>, index: u32, best: &mut Found) -> bool {
        let corners = each(walk.triangles[index as usize], |v| walk.vertices[v as usize]);
        let d = self.direction.to_array();
        let size = each(d, f64::abs);
        // Two axes across the ray and the one along which it mostly runs.
        let kz = if size[0] > size[1] && size[0] > size[2] {
            0
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        let sz = 1.0 / d[kz];
        let (sx, sy) = (d[kx] * sz, d[ky] * sz);
        // A sheared corner is at most twice as far across as the farthest point, and less than twice as deep: edge functions
        // farther from zero than `unsure` have the right sign.
        let farthest = self.farthest(walk.scene);
        let unsure = ROUNDING * (3.0 * farthest) * (12.0 * farthest);
        let o = self.origin.to_array();
        let sheared = each(corners, |p| {
            let z = p[kz] - o[kz];
            [p[kx] - o[kx] - sx * z, p[ky] - o[ky] - sy * z, sz * z]
        });
        let [a, b, c] = sheared;
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < -unsure || v < -unsure || w < -unsure) && (u > unsure || v > unsure || w > unsure) {
            return false;
        }
        let t = if u.abs() > unsure && v.abs() > unsure && w.abs() > unsure {
            (u * a[2] + v * b[2] + w * c[2]) / (u + v + w)
        } else {
            // A triangle that the ray passes no farther than this is met: the same for all that it comes to.
            let near = ROUNDING * farthest;
            match self.near_edge(near, &corners, &sheared, [u, v, w]) {
                Some(t) => t,
                None => return false,
            }
        };
        // Seen almost edge-on, rounding could put it anywhere; the triangle's own depth bounds it.
        let (nearest, farthest) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let t = t.max(nearest).min(farthest);
        // The negated form also turns away NaN.
        if !(t >= self.tmin && t <= best.t)
            || (t == best.t && index >= best.triangle)
            || (t == self.tmin && index < self.least)
        {
            return false;
        }
        if let Some(surface) = self.surface
            && !self.counts(walk, surface, corners, index, t)
        {
            return false;
        }
        *best = Found { t, triangle: index };
        true
    }

    /// Where the ray meets a triangle that it passes near an edge of, by its edge functions.
    ///
    /// - It also meets it where it passes it as near as roundings tell, seen along the ray. So it cannot slip through where
    ///   a triangle is left out, between those on either side of that. How near is the same for all triangles: what it meets
    ///   is what a parallel ray meets that is no farther away, for that one would not pass what this one does.
    /// - Left out are triangles that it sees edge-on, as far as roundings tell: any point of them could be met, and those
    ///   around them decide.
    /// - Of a sliver, which is as narrow from all sides, the longest side as the ray sees it tells where.
    #[cold]
    #[inline(never)]
    fn near_edge(
        &self,
        near: f64,
        corners: &[[f64; 3]; 3],
        sheared: &[[f64; 3]; 3],
        [u, v, w]: [f64; 3],
    ) -> Option<f64> {
        let sides = [0, 1, 2].map(|i| Side::new(sheared[i], sheared[(i + 1) % 3]));
        let is_beside = (u > 0.0 || v > 0.0 || w > 0.0) && (u < 0.0 || v < 0.0 || w < 0.0);
        // Written so that a NaN is met.
        if is_beside && sides.iter().all(|side| side.distance() > near) {
            return None;
        }
        let longer =
            |one: usize, other: usize| if sides[other].square > sides[one].square { other } else { one };
        let longest = &sides[longer(longer(0, 1), 2)];
        let det = u + v + w;
        let [a, b, c] = corners.map(DVec3::from);
        let normal = (b - a).cross(c - a);
        let toward = normal.dot(self.direction).abs();
        let (length, sine) = (longest.square.sqrt(), toward / normal.length());
        // As wide as it is seen. So far aside its plane is as much nearer or farther as the ray runs along it; and weights are off by what is rounded, as
        // often as it is longer than wide.
        let width = det.abs() / length;
        let is_told_by_side = width <= SLIVER * near && sine > 0.1
            || width * width <= ROUNDED_WEIGHTS * near * length * sine && sine > EDGE_ON_SINE;
        if is_told_by_side {
            // So narrow that weights tell less well where than the side does.
            return Some(longest.depth());
        }
        // Half: what is left out is narrower than what its neighbours are met beside them, on either side.
        if det.abs() > 0.5 * near * longest.square.sqrt() {
            if is_beside {
                // Where it passes the nearest side: in the triangle's plane, which it may almost run along, it could be anywhere.
                let nearer = |one: usize, other: usize| {
                    if sides[other].distance() < sides[one].distance() { other } else { one }
                };
                return Some(sides[nearer(nearer(0, 1), 2)].depth());
            }
            let [a, b, c] = sheared.map(|corner| corner[2]);
            return Some((u * a + v * b + w * c) / det);
        }
        if toward <= EDGE_ON_SINE * normal.length() {
            return None;
        }
        // What is a point to the ray is at the depth of any of its corners.
        let share = longest.share();
        let [p, q] = longest.ends;
        Some(if share.is_finite() { p[2] + share * (q[2] - p[2]) } else { p[2] })
    }

    /// Whether a hit counts for a ray that starts on a surface. Where it starts in an edge, rounding may have put its
    /// origin behind the other side of that edge: what it enters there it meets, and what it leaves it does not. So with a solid that stands on
    /// the surface, face on face: no ray starts between them but by rounding.
    fn counts(&self, walk: &Walk<'_>, surface: &Surface, corners: [[f64; 3]; 3], index: u32, t: f64) -> bool {
        if index == surface.triangle {
            return false;
        }
        let [a, b, c] = corners.map(DVec3::from);
        let normal = (b - a).cross(c - a);
        let (size, outward) = (normal.length(), normal.dot(self.direction));
        let depth = (t * outward).abs();
        let is_in_plane = normal.dot(surface.normal).abs() >= (1.0 - PARALLEL) * size;
        // Met beside an edge, it is as far off its plane as that.
        let rounded = ROUNDING * self.farthest(walk.scene);
        let mut near = surface.near + rounded;
        let own = ONE_PLANE.max(near + surface.aside);
        if is_in_plane && depth <= own * size && walk.are_of_one(index, surface.triangle) {
            near = own;
        }
        if depth > near * size {
            return t >= surface.tmin;
        }
        let side = surface.normal * surface.normal.dot(self.direction).signum();
        if !is_in_plane && self.leaves_edge(&[a, b, c], normal, side, near) {
            return false;
        }
        let volume = walk.volume_of(index);
        // Back on the side from which its ray came, it meets what faces that, however the surface itself is wound.
        let is_against = if surface.normal.dot(self.direction) > 0.0 {
            normal.dot(surface.normal) < 0.0
        } else {
            walk.looks_against(surface.triangle, normal)
        };
        // Parts of one element may overlap in a plane: wound alike, they are one face there.
        let is_one_face =
            || walk.are_of_one(index, surface.triangle) && !walk.looks_against(surface.triangle, normal);
        let is_own = volume != NONE && (volume == walk.volume_of(surface.triangle) || is_one_face());
        if is_in_plane && (is_own || !is_against) {
            // In the plane itself, or behind it; or the other side of something that thin.
            return false;
        }
        match walk.volumes.get(volume as usize) {
            Some(volume)
                if volume.role == enfilade_importers::Role::Solid as u32 && volume.by_winding == 1 =>
            {
                // What it leaves it was in by so little only.
                outward < 0.0
            }
            _ => (t >= surface.tmin || depth <= rounded * size) && !is_in_plane,
        }
    }

    /// Whether the ray starts beside an edge of a triangle, by `near`, that it leaves, and that the triangle goes from to behind the surface on
    /// which the ray starts: a face that goes on behind the end of a wall. `side` is the surface's normal on the side to which the ray goes.
    fn leaves_edge(&self, corners: &[DVec3; 3], normal: DVec3, side: DVec3, near: f64) -> bool {
        /// It does not leave an edge along which it runs, but for rounding.
        const ALONG: f64 = 1e-12;
        /// From an edge that ends straight at the surface the triangle goes behind that by rounding alone, a micrometre for each metre of it.
        const STRAIGHT: f64 = 1e-6;
        (0..3).any(|i| {
            let (from, way) = (corners[i], corners[(i + 1) % 3] - corners[i]);
            let inward = normal.cross(way);
            let size = inward.length();
            let off = (self.origin - from).dot(inward).abs();
            off <= near * size
                && inward.dot(self.direction) < -ALONG * size
                && inward.dot(side) < -STRAIGHT * size
        })
    }
}

/// A side of a triangle, sheared so that the ray is the third axis.
struct Side {
    ends: [[f64; 3]; 2],
    /// From its first to its second end, across the ray.
    way: [f64; 2],
    /// The square of its length across the ray.
    square: f64,
}

impl Side {
    fn new(p: [f64; 3], q: [f64; 3]) -> Side {
        let way = [q[0] - p[0], q[1] - p[1]];
        Side { ends: [p, q], way, square: way[0] * way[0] + way[1] * way[1] }
    }

    /// Where along it its line is nearest to the ray: 0 at its first end, 1 at its second; NaN if it is a point.
    fn share(&self) -> f64 {
        let [p, _] = self.ends;
        -(p[0] * self.way[0] + p[1] * self.way[1]) / self.square
    }

    /// The same, no farther than its ends.
    fn share_on_it(&self) -> f64 {
        let share = self.share();
        // A point has no share.
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }

    /// How far it passes the ray.
    fn distance(&self) -> f64 {
        let ([p, _], share) = (self.ends, self.share_on_it());
        let off = [p[0] + share * self.way[0], p[1] + share * self.way[1]];
        // Not `hypot`, whose last bits are another's on another machine.
        (off[0] * off[0] + off[1] * off[1]).sqrt()
    }

    /// How far along the ray it passes it.
    fn depth(&self) -> f64 {
        let ([p, q], share) = (self.ends, self.share_on_it());
        p[2] + share * (q[2] - p[2])
    }
}

/// A node that waits, and how near it is: one word, since a processor that reads together what was written apart waits until both are in its cache.
#[derive(Clone, Copy)]
struct Waiting(u64);

impl Waiting {
    #[inline(always)]
    fn new(node: u32, near: f32) -> Waiting {
        Waiting(u64::from(near.to_bits()) << 32 | u64::from(node))
    }

    #[inline(always)]
    fn node(self) -> u32 {
        self.0 as u32
    }

    #[inline(always)]
    fn near(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32)
    }
}

/// A hierarchy, and what a ray comes to in it as far as that is known.
pub(super) struct Opened {
    /// Where it begins.
    pub(super) root: u32,
    /// The children of that node that the ray comes to; 0 if they have not been looked at.
    hits: u32,
    /// No more than the f32 distance to each of them.
    near: [f32; LANES],
}

impl Opened {
    /// Nothing is known.
    #[inline(always)]
    pub(super) fn not_yet(root: u32) -> Opened {
        Opened { root, hits: 0, near: [0.0; LANES] }
    }

    /// What `open` says of its node; `None` if the ray comes to none of its children.
    #[inline(always)]
    pub(super) fn new<L: Lanes>(root: u32, (hits, near): (u32, L)) -> Option<Opened> {
        // Not by `then`: a closure that has lanes may stay a function of its own.
        if hits == 0 {
            return None;
        }
        Some(Opened { root, hits, near: near.store() })
    }
}

/// The boxes of a node that a ray comes to between two places along it, and where it comes to each: from a place relative to the scene's
/// center, 1 by its direction.
#[inline(always)]
pub(super) fn open<L: Lanes>(
    node: &NodeRecord,
    local: [f32; 3],
    inverse: [f32; 3],
    [first, last]: [f32; 2],
) -> (u32, L) {
    let sides = [&node.lo, &node.hi];
    let (mut near, mut far) = (L::splat(first), L::splat(last));
    for axis in 0..3 {
        // Not the lesser and the greater: the box of a lane without a child is inside out.
        let back = usize::from(inverse[axis] < 0.0);
        let (enter, leave) = (L::load(&sides[back][axis]), L::load(&sides[1 - back][axis]));
        let (inverse, shift) = (L::splat(inverse[axis]), L::splat(local[axis] * inverse[axis]));
        near = near.max(enter.mul_sub(inverse, shift));
        far = far.min(leave.mul_sub(inverse, shift));
    }
    (L::bits(near.le(far)), near)
}

/// The nearest hit, or some hit, in the hierarchy that the query aims at.
#[inline(always)]
pub(super) fn walk<L: Lanes>(
    ask: Ask,
    walk: &Walk<'_>,
    query: &Query<'_>,
    opened: Option<&Opened>,
    count: &mut impl Count,
) -> Found {
    let mut best = Found { t: query.tmax, triangle: NONE };
    if query.root == NONE {
        return best;
    }
    let slack = walk.scene.slack;
    let first = query.limit(query.tmin, slack) - 4.0 * slack;
    let first = first.max(-slack);
    let mut limit = query.limit(best.t, slack);
    let mut stack = ArrayVec::<Waiting, STACK>::new();
    let mut current = query.root;
    let mut opened = opened.filter(|opened| opened.hits != 0);
    loop {
        if current & Leaf::BIT == 0 {
            let node = &walk.nodes[current as usize];
            let (mut hits, near) = match opened.take() {
                Some(opened) => (opened.hits, L::load(&opened.near)),
                None => {
                    count.node();
                    open::<L>(node, query.local, query.inverse, [first, limit])
                }
            };
            if hits != 0 {
                let first_hit = hits.trailing_zeros() as usize;
                hits &= hits - 1;
                if hits == 0 {
                    current = node.child[first_hit];
                    continue;
                }
                // The nearest first; the others on the stack, the farthest first.
                let near = near.store();
                let mut nearest = Waiting::new(node.child[first_hit], near[first_hit]);
                let bottom = stack.len();
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    let mut entry = Waiting::new(node.child[lane], near[lane]);
                    if entry.near() < nearest.near() {
                        std::mem::swap(&mut entry, &mut nearest);
                    }
                    let mut place = stack.len();
                    stack.push(entry);
                    while place > bottom && stack[place - 1].near() < entry.near() {
                        stack[place] = stack[place - 1];
                        place -= 1;
                        stack[place] = entry;
                    }
                }
                current = nearest.node();
                continue;
            }
        } else {
            count.block();
            let leaf = Leaf::new(current);
            let block = &walk.blocks[leaf.block()];
            let found = candidates::<L>(block, query, limit, slack);
            let mut lanes = L::bits(found.met) & leaf.mask();
            if lanes != 0 {
                let t = found.t.store();
                while lanes != 0 {
                    // The nearest first, as far as f32 can tell: it often rules the others out.
                    let mut lane = lanes.trailing_zeros() as usize;
                    let mut others = lanes & (lanes - 1);
                    while others != 0 {
                        let other = others.trailing_zeros() as usize;
                        others &= others - 1;
                        lane = if t[other] < t[lane] { other } else { lane };
                    }
                    lanes &= !(1 << lane);
                    if t[lane] > limit {
                        continue;
                    }
                    count.test();
                    if query.test(walk, block.triangle[lane], &mut best) {
                        if ask == Ask::Any {
                            return best;
                        }
                        limit = query.limit(best.t, slack);
                    }
                }
            }
        }
        loop {
            let Some(waiting) = stack.pop() else { return best };
            if waiting.near() <= limit {
                current = waiting.node();
                break;
            }
        }
    }
}

/// The lanes of a group whose triangle the ray may meet before `limit`: all that it meets, and those that it misses
/// by less than the slack. After Moeller and Trumbore (Fast, Minimum Storage Ray/Triangle Intersection, 1997), with an
/// error bound on each side: |e| times the slack bounds the error of u and v, |e1||e2| times it that of t.
#[inline(always)]
fn candidates<L: Lanes>(block: &BlockRecord, query: &Query<'_>, limit: f32, slack: f32) -> Candidates<L> {
    let load = |v: &[[f32; LANES]; 3]| [L::load(&v[0]), L::load(&v[1]), L::load(&v[2])];
    let (corner, e1, e2) = (load(&block.corner), load(&block.edge1), load(&block.edge2));
    let d = each(query.toward, |d| L::splat(d));
    let o = each(query.local, |o| L::splat(o));
    let zero = L::splat(0.0);
    let slack = L::splat(slack);

    let p = cross(d, e2);
    let det = dot(e1, p);
    let size = det.abs();
    let s = [o[0].sub(corner[0]), o[1].sub(corner[1]), o[2].sub(corner[2])];
    let q = cross(s, e1);
    let u = dot(s, p).flip(det);
    let v = dot(d, q).flip(det);
    let t = dot(e2, q).flip(det);

    let n1 = e1[0].abs().add(e1[1].abs()).add(e1[2].abs());
    let n2 = e2[0].abs().add(e2[1].abs()).add(e2[2].abs());
    let (slack1, slack2) = (n1.mul(slack), n2.mul(slack));
    let slack12 = n1.mul(slack2);

    let inside_u = zero.sub(slack2).le(u);
    let inside_v = zero.sub(slack1).le(v);
    let inside_w = u.add(v).le(size.add(slack1).add(slack2));
    let ahead = zero.sub(slack12).le(t);
    let near = t.le(size.mul(L::splat(limit)).add(slack12));
    let met = L::and(L::and(L::and(inside_u, inside_v), L::and(inside_w, ahead)), near);
    // Seen edge-on the sign of the determinant is not sure, and nothing above is.
    let edge_on = size.le(n1.mul(n2).mul(L::splat(EDGE_ON)));
    // Less by the bound of its error, which holds edge-on too.
    let least = t.sub(slack12).div(size);
    Candidates { met: L::or(met, edge_on), t: least }
}

/// What [`candidates`] found.
struct Candidates<L: Lanes> {
    /// Lanes whose triangle the ray may meet.
    met: L::Mask,
    /// No more than the distance to each.
    t: L,
}

/// As near as anything is told apart, for each metre of coordinates: 1e-11 m at 100 m. The distance of a side from the ray
/// is off by some roundings of the coordinates, 2^-50 of them, so that hardly any answer hangs on those.
pub(super) const ROUNDING: f64 = 1.0 / (1u64 << 43) as f64;

/// A triangle that is not as many times as wide as what is told apart is met at the depth of its longest side.
const SLIVER: f64 = 1e4;

/// What weights are off by where they are that of points, of what is told apart.
const ROUNDED_WEIGHTS: f64 = 1.0 / 64.0;

/// Sine of the angle between a ray and a plane below which roundings aside the ray are too much along it.
pub(super) const EDGE_ON_SINE: f64 = 1.0 / 1024.0;

/// Bounds the relative error of a block's determinants: a few roundings of 2^-24 each.
pub(super) const EDGE_ON: f32 = 1.0 / (1u32 << 20) as f32;

#[inline(always)]
fn cross<L: Lanes>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [
        a[1].mul_sub(b[2], a[2].mul(b[1])),
        a[2].mul_sub(b[0], a[0].mul(b[2])),
        a[0].mul_sub(b[1], a[1].mul(b[0])),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2].mul(b[2])))
}
