//! The quick way of a ray: from prism to prism of air to the first triangle of detail or the first plain face, as long as
//! nothing is in doubt.
//!
//! It goes the way of `cells`, and what it answers is what that would answer, to rounding: a ray that starts well within a
//! prism, passes no edge of a face so near that one hardly aside would go another way, and ends at a *plain* face, behind
//! which the compiler proved that all over there are triangles of one plane, or at detail. Any other ray it leaves to
//! `cells`, from its start. So it has no case but the common one: no file that it could not be sure of makes it wrong, and none
//! makes it long, as it enters no more prisms than there are.

use glam::DVec3;

use super::NONE;
use super::kernel::Probe;
use super::lanes::Lanes;
use super::path::{BLURRED, NEAR};
use super::ray::Ray;
use super::walk::{Found, Query, Walk, inverse};
use crate::format::Views;
use crate::format::records::{BLOCK_BIT, CellRecord, CornersRecord, CoverRecord, LANES, PLAIN, SideRecord, Traits};

/// A direction whose squared length is no farther than this from 1 is unit: no rounding brings it nearer for sure.
const UNIT: f64 = 4.0 * f64::EPSILON;

/// Steeper rays, whose directions are shorter than this in the plan, are left to `cells`.
const STEEPEST: f64 = 1e-3;

/// Lattices with fewer steps in a metre than 2 to this power reach too far for f32.
const COARSEST: u32 = 15;

/// Where a ray runs at a plane more along it than this, its sine, rounding moves what it meets too far.
const GRAZING: f64 = 1.0 / 64.0;

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

/// What the ray meets first, or something where the `probe` looks for any; `hint` is the cell in which it starts. `None` where there
/// is doubt.
#[inline(always)]
pub(super) fn quick<L: Lanes, P: Probe>(
    tables: &Views,
    ray: &Ray,
    hint: u32,
    probe: &mut P,
) -> Option<Quick> {
    if tables.scene[0].traits & Traits::SLOPED == 0 {
        Way::<false>::new(tables, ray)?.run::<L>(hint, probe)
    } else {
        Way::<true>::new(tables, ray)?.run::<L>(hint, probe)
    }
}

/// A ray under way; `SLOPED` if floors and ceilings may be.
struct Way<'a, const SLOPED: bool> {
    tables: &'a Views,
    /// As the caller has it.
    origin: DVec3,
    direction: DVec3,
    limit: f64,
    /// Along the lattice's axes, from its origin.
    from: DVec3,
    along: DVec3,
    /// 1 by the third component of `along`.
    steep: f64,
    /// The third Pluecker coordinate of its line in the plan, see `plan`.
    moment: f64,
    /// No corner may be nearer to the line than this, times the direction's length in the plan.
    blurred: f64,
    /// The ray from the scene's center in f32, for boxes.
    boxes: Boxes,
}

/// A ray in f32 as the test of boxes takes it.
struct Boxes {
    inverse: [f32; 3],
    shift: [f32; 3],
}

/// Where a ray leaves a prism.
struct Exit {
    t: f64,
    cell: u32,
    source: u32,
    flags: u16,
}

/// The side of a footprint through which a line leaves it, and its ends.
struct Side {
    index: usize,
    a: [f32; 2],
    b: [f32; 2],
}

impl<'a, const SLOPED: bool> Way<'a, SLOPED> {
    #[inline(always)]
    fn new(tables: &'a Views, ray: &Ray) -> Option<Self> {
        let scene = &tables.scene[0];
        let mut direction = DVec3::from(ray.direction);
        let squared = direction.length_squared();
        // Written so that NaN is left to others, here and below.
        if !((squared - 1.0).abs() <= UNIT) {
            if !(squared > 1e-100 && squared < 1e100) {
                return None;
            }
            direction /= squared.sqrt();
        }
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
        let flat = along.x.abs() + along.y.abs();
        if !(flat >= STEEPEST) {
            return None;
        }
        let moment = along.y * from.x - along.x * from.y;
        let steep = 1.0 / along.z;
        let boxes = Boxes::new(origin - DVec3::from(scene.center), direction);
        let blurred = BLURRED * flat;
        Some(Way { tables, origin, direction, limit: ray.tmax, from, along, steep, moment, blurred, boxes })
    }

    #[inline(always)]
    fn run<L: Lanes>(&self, hint: u32, probe: &mut impl Probe) -> Option<Quick> {
        let tables = self.tables;
        let cells: &[CellRecord] = &tables.cells;
        let (mut cell, mut record) = (hint, cells.get(hint as usize)?);
        if record.kind != CellRecord::AIR {
            return None;
        }
        let mut exit = self.leave::<L, true>(cell, record)?;
        // Each once.
        for _ in 0..cells.len() {
            probe.cell();
            // What stands behind the face, if that ends the way.
            let mut met: Option<Quick> = None;
            if exit.source != NONE {
                if exit.flags != PLAIN {
                    return None;
                }
                let plate = &tables.plates[exit.source as usize];
                let normal = DVec3::from(plate.normal);
                let toward = normal.dot(self.direction);
                let t = (plate.offset - normal.dot(self.origin)) / toward;
                // Not where it runs along it, nor where it starts in the matter by what cells are rounded.
                if !(toward.abs() >= GRAZING && t >= 0.0) {
                    return None;
                }
                let triangle = tables.sources[exit.source as usize].plane;
                met = Some(Quick { found: Found { t, triangle }, cell, source: exit.source });
            }
            if record.root != NONE {
                let until = match met {
                    Some(met) if met.found.t > exit.t => met.found.t,
                    _ => exit.t,
                };
                let until = if until + NEAR < self.limit { until + NEAR } else { self.limit };
                if record.root & BLOCK_BIT != 0 || self.touches::<L>(record.root, until, probe) {
                    let found = self.detail(record.root, until, probe);
                    let is_nearer = |met: Quick| (found.t, found.triangle) < (met.found.t, met.found.triangle);
                    if found.triangle != NONE && met.is_none_or(is_nearer) {
                        met = Some(Quick { found, cell, source: NONE });
                    }
                }
            }
            if let Some(met) = met {
                return Some(if met.found.t <= self.limit { met } else { self.nothing(cell) });
            }
            if exit.t > self.limit + tables.scene[0].tolerance {
                return Some(self.nothing(cell));
            }
            cell = exit.cell;
            record = &cells[cell as usize];
            // Matter without a surface, or the open around all prisms.
            if record.kind != CellRecord::AIR {
                return None;
            }
            exit = self.leave::<L, false>(cell, record)?;
        }
        None
    }

    /// Whether the ray comes to any of a node's boxes before `until`.
    #[inline(always)]
    fn touches<L: Lanes>(&self, root: u32, until: f64, probe: &mut impl Probe) -> bool {
        probe.node();
        let slack = self.tables.scene[0].slack;
        let until = until as f32;
        let node = &self.tables.nodes[root as usize];
        let (mut near, mut far) = (L::splat(-slack), L::splat(until + until * 1e-6 + slack));
        for axis in 0..3 {
            let (inverse, shift) = (L::splat(self.boxes.inverse[axis]), L::splat(self.boxes.shift[axis]));
            let lo = L::load(&node.lo[axis]).mul_sub(inverse, shift);
            let hi = L::load(&node.hi[axis]).mul_sub(inverse, shift);
            near = near.max(lo.min(hi));
            far = far.min(lo.max(hi));
        }
        L::bits(near.le(far)) != 0
    }

    #[inline(never)]
    fn detail(&self, root: u32, until: f64, probe: &mut impl Probe) -> Found {
        let scene = &self.tables.scene[0];
        let query = Query::new(self.origin, self.direction, (0.0, until), 0.0, scene, root, None);
        probe.first(&Walk::new(self.tables), &query)
    }

    #[inline(always)]
    fn nothing(&self, cell: u32) -> Quick {
        Quick { found: Found { t: self.limit, triangle: NONE }, cell, source: NONE }
    }

    /// The side of the line that a corner is on: negative on its right. Of corners as near to it as rounding can tell, the sign may
    /// be wrong; they are nearer than `blurred`.
    #[inline(always)]
    fn side(&self, [x, y]: [f32; 2]) -> f64 {
        self.along.x * f64::from(y) - self.along.y * f64::from(x) + self.moment
    }

    /// How far along the ray its line in the plan crosses that of the edge, times how the sides of its ends differ.
    #[inline(always)]
    fn crossing(&self, a: [f32; 2], [ex, ey]: [f64; 2]) -> f64 {
        (f64::from(a[0]) - self.from.x) * ey - (f64::from(a[1]) - self.from.y) * ex
    }

    /// The height over a plane where the ray starts, and by how much it grows.
    #[inline(always)]
    fn over(&self, plane: u32) -> (f64, f64) {
        let plane = &self.tables.planes[plane as usize];
        let [p, q] = plane.slope;
        if SLOPED {
            let (from, along) = (self.from, self.along);
            (from.z - p * from.x - q * from.y - plane.height, along.z - p * along.x - q * along.y)
        } else {
            (self.from.z - plane.height, self.along.z)
        }
    }

    /// Where the line comes into the footprint and where it leaves it; `None` if it misses it.
    #[inline(always)]
    fn sides<L: Lanes>(&self, corners: &CornersRecord, sides: &[SideRecord]) -> Option<[Side; 2]> {
        if !corners.is_some() {
            return self.sides_of_many(sides);
        }
        let (x, y) = (L::load(&corners.x), L::load(&corners.y));
        let (dx, dy) = (L::splat(self.along.x as f32), L::splat(self.along.y as f32));
        let moment = L::splat(self.moment as f32);
        // The sides with their signs turned. What f32 adds is far less than `blurred`.
        let turned = x.mul_sub(dy, y.mul_add(dx, moment));
        let left = L::bits(turned.le(L::splat(0.0)));
        let next_left = (left >> 1) | (left << (LANES - 1));
        let (out, into) = (!left & next_left & 0xff, left & !next_left & 0xff);
        if out == 0 || into == 0 {
            return None;
        }
        let at = |bits: u32| {
            let index = bits.trailing_zeros() as usize % LANES;
            let next = (index + 1) % LANES;
            let a = [corners.x[index], corners.y[index]];
            Side { index, a, b: [corners.x[next], corners.y[next]] }
        };
        let mut out = at(out);
        // Of the sides that stand on that edge, the last that starts on the line's right.
        let first = usize::from(corners.side[out.index]);
        let end = if out.index == LANES - 1 { sides.len() } else { corners.side[out.index + 1].into() };
        out.index = first;
        for (side, index) in sides[first..end].iter().zip(first..).skip(1) {
            if self.side(side.start) >= 0.0 {
                out.b = side.start;
                break;
            }
            (out.index, out.a) = (index, side.start);
        }
        Some([at(into), out])
    }

    #[inline(never)]
    fn sides_of_many(&self, sides: &[SideRecord]) -> Option<[Side; 2]> {
        let mut found = [None, None];
        let is_left = |side: &SideRecord| self.side(side.start) >= 0.0;
        let mut before = is_left(&sides[0]);
        for index in 0..sides.len() {
            let next = &sides[if index + 1 == sides.len() { 0 } else { index + 1 }];
            let after = is_left(next);
            if before != after {
                found[usize::from(after)] = Some(Side { index, a: sides[index].start, b: next.start });
            }
            before = after;
        }
        let [into, out] = found;
        Some([into?, out?])
    }

    /// Whether a point of the plan lies in the footprint, no nearer to its border than cells tell apart.
    #[inline(always)]
    fn is_within<L: Lanes>(
        &self,
        corners: &CornersRecord,
        sides: &[SideRecord],
        [px, py]: [f64; 2],
    ) -> bool {
        if !corners.is_some() {
            let next = sides.iter().skip(1).chain(sides.first());
            return sides.iter().zip(next).all(|(a, b)| {
                let [ex, ey] = edge(a.start, b.start);
                let (ax, ay) = (f64::from(a.start[0]), f64::from(a.start[1]));
                ex * (py - ay) - ey * (px - ax) >= BLURRED * (ex.abs() + ey.abs())
            });
        }
        /// Somewhat more, for what f32 adds.
        const MARGIN: f32 = 1.25 * BLURRED as f32;
        let (x, y) = (L::load(&corners.x), L::load(&corners.y));
        let (ex, ey) = (x.rotate().sub(x), y.rotate().sub(y));
        let (px, py) = (L::splat(px as f32).sub(x), L::splat(py as f32).sub(y));
        let inward = ex.mul_sub(py, ey.mul(px));
        let least = ex.abs().add(ey.abs()).mul(L::splat(MARGIN));
        L::bits(least.le(inward)) == 0xff
    }

    /// Where the ray leaves the prism; if it is the `FIRST`, it must start in it.
    #[inline(always)]
    fn leave<L: Lanes, const FIRST: bool>(&self, cell: u32, record: &CellRecord) -> Option<Exit> {
        let tables = self.tables;
        let first = record.first_side as usize;
        let sides = &tables.sides[first..first + record.sides as usize];
        let corners = &tables.corners[cell as usize];
        let [into, Side { index, a, b }] = self.sides::<L>(corners, sides)?;
        let (right, left) = (self.side(a), self.side(b));
        if !(-right >= self.blurred && left >= self.blurred) {
            return None;
        }
        let [ex, ey] = edge(a, b);
        let per = 1.0 / (left - right);
        let t = self.crossing(a, [ex, ey]) * per;
        let slant = (ex.abs() + ey.abs()) * per;
        let (floor, falls) = self.over(record.floor);
        let (ceiling, rises) = self.over(record.ceiling);
        if FIRST {
            // It came in before it starts.
            let is_behind = self.crossing(into.a, edge(into.a, into.b)) >= 0.0;
            if !(is_behind && t >= 0.0 && floor >= 0.0 && ceiling <= 0.0) {
                return None;
            }
        }
        // Over the floor and under the ceiling where it leaves the footprint, beside how far one aside is from there.
        let (over, under) = (floor + t * falls, -(ceiling + t * rises));
        let blur = |grows: f64| BLURRED * (2.0 + slant * grows.abs());
        let (blur_floor, blur_ceiling) = (blur(falls), blur(rises));
        if over >= blur_floor && under >= blur_ceiling {
            let side = &sides[index];
            let first = side.first_face as usize;
            let faces = &tables.faces[first..first + side.faces as usize];
            let mut face = &faces[faces.len() - 1];
            for other in faces[..faces.len() - 1].iter().rev() {
                let (over, grows) = self.over(other.top);
                let over = over + t * grows;
                if !(over.abs() >= blur(grows)) {
                    return None;
                }
                if over < 0.0 {
                    face = other;
                }
            }
            return Some(Exit { t, cell: face.cell, source: face.source, flags: face.flags });
        }
        let is_down = over <= -blur_floor;
        if !(is_down || under <= -blur_ceiling) || (SLOPED && is_down != (under >= blur_ceiling)) {
            return None;
        }
        let (height, grows) = if is_down { (floor, falls) } else { (ceiling, rises) };
        let t = if SLOPED { -height / grows } else { -height * self.steep };
        // Well within the border there: also of sides that it runs along and never comes to.
        let at = [self.from.x + t * self.along.x, self.from.y + t * self.along.y];
        if !self.is_within::<L>(corners, sides, at) {
            return None;
        }
        let first = record.first_cover as usize;
        let (below, above) = (record.below as usize, record.above as usize);
        let covers = if is_down { first..first + below } else { first + below..first + below + above };
        match &tables.covers[covers] {
            [only] => Some(Exit { t, cell: only.cell, source: only.source, flags: only.flags }),
            covers => self.cover(covers, t, at, grows),
        }
    }

    /// The part of a floor or ceiling that the ray passes.
    #[inline(never)]
    fn cover(&self, covers: &[CoverRecord], t: f64, at: [f64; 2], grows: f64) -> Option<Exit> {
        let tables = self.tables;
        let margin = BLURRED * (1.0 + 1.0 / grows.abs());
        for cover in covers {
            let cell = tables.cells.get(cover.cell as usize)?;
            let [lo, hi] = cell.bounds;
            if cell.kind == CellRecord::AROUND {
                return None;
            }
            if !(at[0] >= lo[0] && at[0] <= hi[0] && at[1] >= lo[1] && at[1] <= hi[1]) {
                continue;
            }
            let first = cell.first_side as usize;
            let sides = &tables.sides[first..first + cell.sides as usize];
            let (mut a, mut is_inside, mut is_beside) = (sides[sides.len() - 1].start, true, true);
            for side in sides {
                let b = side.start;
                let [ex, ey] = edge(a, b);
                let inward = ex * (at[1] - f64::from(a[1])) - ey * (at[0] - f64::from(a[0]));
                let margin = margin * (ex.abs() + ey.abs());
                is_inside &= inward >= margin;
                is_beside &= inward > -margin;
                a = b;
            }
            if is_inside {
                return Some(Exit { t, cell: cover.cell, source: cover.source, flags: cover.flags });
            }
            if is_beside {
                return None;
            }
        }
        None
    }
}

/// From one corner to another. Not by `array::map`, which is not always inlined.
#[inline(always)]
fn edge(a: [f32; 2], b: [f32; 2]) -> [f64; 2] {
    [f64::from(b[0]) - f64::from(a[0]), f64::from(b[1]) - f64::from(a[1])]
}

impl Boxes {
    #[inline(always)]
    fn new(origin: DVec3, direction: DVec3) -> Boxes {
        let inverse = inverse(direction.as_vec3().to_array());
        let local = origin.as_vec3().to_array();
        let shift = [local[0] * inverse[0], local[1] * inverse[1], local[2] * inverse[2]];
        Boxes { inverse, shift }
    }
}
