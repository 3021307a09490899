//! A ray among prisms: where it leaves one, which part of its surface it leaves through, and in which prism a point
//! lies.

use glam::DVec3;

use super::NONE;
use super::plan::PlanLine;
use crate::format::Views;
use crate::format::records::{CellRecord, CoverRecord, FaceRecord, PlaneRecord, SideRecord};

/// A point no farther than this outside of a prism counts as in it, metres: what rounding can move it.
pub(super) const NEAR: f64 = 1e-9;

/// So many steps of the lattice rounding may have moved surfaces.
const CLEAR: f64 = 4.0;

/// No coordinate on the lattice is more steps from its origin.
const LARGEST: f64 = (1 << 24) as f64;

/// The way out of a prism.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exit {
    /// Where, along the ray.
    pub(super) t: f64,
    /// The cell beyond.
    pub(super) cell: u32,
    /// What may be met there, or [`NONE`].
    pub(super) source: u32,
    /// Through which of the cell's planes.
    through: Through,
}

/// A plane of a prism.
#[derive(Clone, Copy, Debug)]
enum Through {
    Floor,
    Ceiling,
    /// The side with this index, of all sides.
    Side(u32),
    /// From outside of all prisms.
    Air,
}

impl Exit {
    /// Into a prism, from outside of all.
    pub(super) fn into_zone(t: f64, cell: u32) -> Exit {
        Exit { t, cell, source: NONE, through: Through::Air }
    }
}

/// The prisms of a scene.
#[derive(Clone, Copy)]
pub(super) struct Prisms<'a> {
    pub(super) cells: &'a [CellRecord],
    sides: &'a [SideRecord],
    faces: &'a [FaceRecord],
    covers: &'a [CoverRecord],
    planes: &'a [PlaneRecord],
    starts: &'a [u32],
    listed: &'a [u32],
    zone: [[f64; 3]; 2],
    step: [f64; 3],
    dims: [u32; 3],
    origin: [f64; 3],
    turn: [f64; 2],
    /// Bounds all coordinates from the lattice's origin, metres.
    reach: f64,
    /// So far rounding may have moved surfaces, metres.
    pub(super) clear: f64,
}

impl<'a> Prisms<'a> {
    #[inline]
    pub(super) fn new(tables: &'a Views) -> Prisms<'a> {
        let scene = &tables.scene[0];
        Prisms {
            cells: &tables.cells,
            sides: &tables.sides,
            faces: &tables.faces,
            covers: &tables.covers,
            planes: &tables.planes,
            starts: &tables.cellgrid,
            listed: &tables.gridcells,
            zone: scene.zone,
            step: scene.grid_step,
            dims: scene.grid_dims,
            origin: scene.lattice_origin,
            turn: scene.lattice_turn,
            reach: LARGEST * (-f64::from(scene.lattice_bits)).exp2(),
            clear: CLEAR * (-f64::from(scene.lattice_bits)).exp2(),
        }
    }

    /// A point of the internal frame along the lattice's axes from its origin.
    #[inline]
    fn local(&self, point: DVec3) -> DVec3 {
        DVec3::from(to_lattice(point.to_array(), self.origin, self.turn))
    }

    /// A direction along the lattice's axes in the internal frame.
    pub(super) fn turned_back(&self, direction: DVec3) -> DVec3 {
        let [cos, sin] = self.turn;
        let [x, y, z] = direction.to_array();
        DVec3::new(x * cos - y * sin, x * sin + y * cos, z)
    }

    /// The point of the internal frame at a point given along the lattice's axes.
    pub(super) fn internal(&self, point: DVec3) -> DVec3 {
        self.turned_back(point) + DVec3::from(self.origin)
    }

    /// A direction of the internal frame along the lattice's axes.
    #[inline]
    fn turned(&self, direction: DVec3) -> DVec3 {
        DVec3::from(to_lattice(direction.to_array(), [0.0; 3], self.turn))
    }

    #[inline(always)]
    fn sides_of(&self, cell: &CellRecord) -> &'a [SideRecord] {
        &self.sides[cell.first_side as usize..(cell.first_side + cell.sides) as usize]
    }

    /// A normal of a plane, upward.
    fn upward(&self, plane: u32) -> DVec3 {
        let [p, q] = self.planes[plane as usize].slope;
        DVec3::new(-p, -q, 1.0)
    }

    /// All that may be met at the surface of a cell, with a normal there, outward; the same one several times.
    pub(super) fn sources_of(&self, cell: &CellRecord) -> impl Iterator<Item = (u32, DVec3)> + 'a {
        let first = cell.first_cover as usize;
        let middle = first + cell.below as usize;
        let of = |covers: &'a [CoverRecord], normal: DVec3| covers.iter().map(move |c| (c.source, normal));
        let below = of(&self.covers[first..middle], -self.upward(cell.floor));
        let above = of(&self.covers[middle..middle + cell.above as usize], self.upward(cell.ceiling));
        let (faces, sides) = (self.faces, self.sides_of(cell));
        let of_side = move |i: usize| {
            let normal = outward(sides[i].start, sides[(i + 1) % sides.len()].start);
            let first = sides[i].first_face as usize;
            faces[first..first + sides[i].faces as usize].iter().map(move |face| (face.source, normal))
        };
        let all = (0..sides.len()).flat_map(of_side).chain(below).chain(above);
        let mut last = NONE;
        all.filter(move |&(source, _)| source != NONE && std::mem::replace(&mut last, source) != source)
    }

    /// Whether `point` (from the lattice's origin) lies in the zone of the prisms.
    #[inline]
    pub(super) fn hold(&self, point: DVec3) -> bool {
        let p = point;
        (0..3).all(|axis| p[axis] >= self.zone[0][axis] && p[axis] <= self.zone[1][axis])
    }

    /// Between which `t` a ray from `origin`, along the lattice's axes, is in the zone, if it comes through it.
    fn zone_span(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            let [lo, hi] = [self.zone[0][axis], self.zone[1][axis]];
            if d == 0.0 {
                if o < lo || o > hi {
                    return None;
                }
                continue;
            }
            let (a, b) = ((lo - o) / d, (hi - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter < leave).then_some([enter, leave])
    }

    /// The prisms that may hold a point (from the lattice's origin).
    fn listed(&self, point: DVec3) -> &'a [u32] {
        let p = point;
        let mut index = 0usize;
        for axis in (0..3).rev() {
            let most = f64::from(self.dims[axis].saturating_sub(1));
            let cube = ((p[axis] - self.zone[0][axis]) / self.step[axis]).floor();
            // A point on the zone's upper side belongs to the last cube; NaN becomes 0.
            index = index * self.dims[axis] as usize + cube.max(0.0).min(most) as usize;
        }
        match (self.starts.get(index), self.starts.get(index + 1)) {
            (Some(&start), Some(&end)) => &self.listed[start as usize..end as usize],
            _ => &[],
        }
    }

    /// Calls `each` with every plane of the prism: its unit normal, outward, how far `point` is outside of it, metres,
    /// and whether there is matter at it.
    fn planes_of(&self, cell: &CellRecord, point: DVec3, mut each: impl FnMut(DVec3, f64, bool)) {
        let first = cell.first_cover as usize;
        let middle = first + cell.below as usize;
        let covers = [first..middle, middle..middle + cell.above as usize];
        for (plane, up, covers) in
            [(cell.floor, -1.0, covers[0].clone()), (cell.ceiling, 1.0, covers[1].clone())]
        {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            let scale = up / (1.0 + p * p + q * q).sqrt();
            let over = (point.z - p * point.x - q * point.y - height) * scale;
            let matter = self.covers[covers].iter().any(|cover| cover.source != NONE);
            each(DVec3::new(-p, -q, 1.0) * scale, over, matter);
        }
        let sides = self.sides_of(cell);
        for (i, side) in sides.iter().enumerate() {
            let a = side.start.map(f64::from);
            let b = sides[(i + 1) % sides.len()].start.map(f64::from);
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            let scale = 1.0 / (ex * ex + ey * ey).sqrt();
            let right = (ex * (a[1] - point.y) - ey * (a[0] - point.x)) * scale;
            let faces = &self.faces[side.first_face as usize..(side.first_face + side.faces) as usize];
            let matter = faces.iter().any(|face| face.source != NONE);
            each(DVec3::new(ey * scale, -ex * scale, 0.0), right, matter);
        }
    }

    /// How far, metres, `point` is outside of the prism's farthest plane; negative within it.
    fn outside(&self, cell: &CellRecord, point: DVec3) -> f64 {
        let mut most = f64::NEG_INFINITY;
        self.planes_of(cell, point, |_, over, _| most = most.max(over));
        most
    }

    /// Whether `point` is in the prism, and `clear` away from all matter at its surface.
    fn is_clear(&self, cell: &CellRecord, point: DVec3, clear: f64) -> bool {
        let mut is_clear = true;
        self.planes_of(cell, point, |_, over, matter| is_clear &= over <= if matter { -clear } else { 0.0 });
        is_clear
    }

    /// The way from `point` into the prism, and `clear` away from all matter at its surface, as far as it is wide enough;
    /// a little within all other planes.
    fn way_into(&self, cell: &CellRecord, point: DVec3, clear: f64) -> DVec3 {
        /// Planes at a corner push the point across each other: this brings it there but for some 2^-ROUNDS of the way.
        const ROUNDS: usize = 8;
        let mut to = point;
        for _ in 0..ROUNDS {
            let mut moved = to;
            // One plane after the other, so that each sees what those before have done.
            self.planes_of(cell, to, |normal, over, matter| {
                let done = normal.dot(moved - to);
                let wanted = if matter { clear } else { clear / 16.0 };
                if over + done > -wanted {
                    moved -= normal * (over + done + wanted);
                }
            });
            if moved == to {
                break;
            }
            to = moved;
        }
        to - point
    }

    /// The air prism that holds `point` (internal frame) or is nearest to it, and no farther than `margin`; else a solid
    /// one.
    pub(super) fn place(&self, point: DVec3, margin: f64) -> Option<u32> {
        let point = self.local(point);
        if !self.hold(point) {
            return None;
        }
        let best = |kind: u32| {
            let mut best: Option<(u32, f64)> = None;
            for &index in self.listed(point) {
                let cell = &self.cells[index as usize];
                let outside = if cell.kind == kind { self.outside(cell, point) } else { f64::INFINITY };
                if outside <= margin && best.is_none_or(|(_, least)| outside < least) {
                    best = Some((index, outside));
                }
            }
            best.map(|(index, _)| index)
        };
        best(CellRecord::AIR).or_else(|| best(CellRecord::SOLID))
    }
}

/// A point, metres in the internal frame, along the axes of the lattice from its origin.
#[inline]
pub(crate) fn to_lattice(p: [f64; 3], origin: [f64; 3], [cos, sin]: [f64; 2]) -> [f64; 3] {
    let [x, y, z] = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
    [x * cos + y * sin, y * cos - x * sin, z]
}

/// A normal of the side over the edge between two corners, outward.
#[inline]
fn outward(from: [f32; 2], to: [f32; 2]) -> DVec3 {
    let [a, b] = [from, to].map(|p| p.map(f64::from));
    DVec3::new(b[1] - a[1], a[0] - b[0], 0.0)
}

/// A ray among the prisms.
pub(super) struct Path<'a> {
    pub(super) prisms: Prisms<'a>,
    /// Where the ray enters the hull, or starts, from the lattice's origin.
    origin: DVec3,
    direction: DVec3,
    /// `t` there.
    start: f64,
    plan: PlanLine,
}

impl<'a> Path<'a> {
    #[inline]
    pub(super) fn new(prisms: Prisms<'a>, origin: DVec3, direction: DVec3, start: f64) -> Path<'a> {
        // Not the ray's own origin, which may be far outside and have few digits left.
        let local = prisms.local(origin + direction * start);
        let direction = prisms.turned(direction);
        let plan = PlanLine::new(local, direction, prisms.reach);
        Path { prisms, origin: local, direction, start, plan }
    }

    /// Between which `t` it is in the zone of the prisms, if it comes through it.
    pub(super) fn zone_span(&self) -> Option<[f64; 2]> {
        Some(self.prisms.zone_span(self.origin, self.direction)?.map(|t| t + self.start))
    }

    /// The parallel path that is `way` aside.
    pub(super) fn moved(&self, way: DVec3) -> Path<'a> {
        let origin = self.origin + way;
        let plan = PlanLine::new(origin, self.direction, self.prisms.reach);
        Path { origin, plan, ..*self }
    }

    /// The point at `t`, from the lattice's origin.
    pub(super) fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * (t - self.start)
    }

    /// The height over a plane where the ray starts, and by how much it grows.
    #[inline(always)]
    fn over(&self, plane: u32) -> (f64, f64) {
        let PlaneRecord { slope: [p, q], height } = self.prisms.planes[plane as usize];
        let (o, d) = (self.origin, self.direction);
        (o.z - p * o.x - q * o.y - height, d.z - p * d.x - q * d.y)
    }

    /// Where and how the ray leaves a prism that its line crosses: the outgoing face search of the paper's Algorithm 1,
    /// for floors and ceilings that may slope and have parts. `None` if the line misses the prism's footprint, which
    /// no prism that is entered from another does.
    #[inline]
    pub(super) fn leave(&self, cell: &CellRecord) -> Option<Exit> {
        let sides = self.prisms.sides_of(cell);
        let span = self.plan.span(sides);
        let (side, t) = match (self.plan.vertical, span) {
            (true, _) => (None, f64::INFINITY),
            (false, Some(span)) => (Some(span.side), span.leave),
            (false, None) => return None,
        };
        let (floor, floor_grows) = self.over(cell.floor);
        let (ceiling, ceiling_grows) = self.over(cell.ceiling);
        let down = floor_grows < 0.0 && floor + t * floor_grows < 0.0;
        let up = ceiling_grows > 0.0 && ceiling + t * ceiling_grows > 0.0;
        if down || up {
            let (t_down, t_up) = (-floor / floor_grows, -ceiling / ceiling_grows);
            let first = cell.first_cover as usize;
            let middle = first + cell.below as usize;
            let (t, covers, through) = if down && !(up && t_up < t_down) {
                (t_down, &self.prisms.covers[first..middle], Through::Floor)
            } else {
                (t_up, &self.prisms.covers[middle..middle + cell.above as usize], Through::Ceiling)
            };
            let cover = self.cover(covers, t)?;
            return Some(Exit { t: t + self.start, cell: cover.cell, source: cover.source, through });
        }
        // Vertical, and its planes say neither up nor down: no prism.
        let index = side?;
        let side = &sides[index];
        let first = side.first_face as usize;
        let faces = &self.prisms.faces[first..first + side.faces as usize];
        let (last, others) = faces.split_last()?;
        let is_below = |face: &&FaceRecord| {
            face.top == NONE || {
                let (over, grows) = self.over(face.top);
                over + t * grows < 0.0
            }
        };
        let face = others.iter().find(is_below).unwrap_or(last);
        let through = Through::Side(cell.first_side + index as u32);
        Some(Exit { t: t + self.start, cell: face.cell, source: face.source, through })
    }

    /// A normal of the plane through which the ray leaves a prism, outward, of any length.
    #[inline]
    pub(super) fn outward(&self, cell: &CellRecord, exit: &Exit) -> DVec3 {
        match exit.through {
            Through::Floor => -self.prisms.upward(cell.floor),
            Through::Ceiling => self.prisms.upward(cell.ceiling),
            Through::Side(index) => {
                let sides = self.prisms.sides_of(cell);
                let i = (index - cell.first_side) as usize;
                outward(sides[i].start, sides[(i + 1) % sides.len()].start)
            }
            Through::Air => DVec3::ZERO,
        }
    }

    /// The part of a floor or ceiling that the ray passes, `t` from its start: the one whose cell's footprint the line
    /// crosses there, or most nearly there.
    fn cover(&self, covers: &[CoverRecord], t: f64) -> Option<CoverRecord> {
        if let [only] = covers {
            return Some(*only);
        }
        let at = if self.plan.vertical { 0.0 } else { t };
        let mut best: Option<(CoverRecord, f64)> = None;
        for cover in covers {
            let cell = self.prisms.cells.get(cover.cell as usize).filter(|c| c.kind != CellRecord::AROUND);
            let depth = match cell {
                Some(cell) => match self.plan.span(self.prisms.sides_of(cell)) {
                    Some(span) => (at - span.enter).min(span.leave - at),
                    None => continue,
                },
                // Around the prisms: only where none of them is.
                None => -NEAR,
            };
            if best.is_none_or(|(_, most)| depth > most) {
                best = Some((*cover, depth));
            }
        }
        best.map(|(cover, _)| cover)
    }

    /// Whether the ray is in the air of `cell` at `t`, `clear` away from matter.
    #[inline]
    pub(super) fn is_clear_in(&self, cell: u32, t: f64, clear: f64) -> bool {
        self.prisms.cells.get(cell as usize).is_some_and(|record| {
            record.kind == CellRecord::AIR
                && self.prisms.is_clear(record, self.at(t), clear)
                && self.is_member(record, t)
        })
    }

    /// Whether a walk that comes to `t` may be in the cell there: its line crosses the footprint, and is between floor and
    /// ceiling as [`Path::leave`] has it.
    fn is_member(&self, cell: &CellRecord, t: f64) -> bool {
        let t = t - self.start;
        let is_below = |plane: u32| {
            let (over, grows) = self.over(plane);
            let over = over + t * grows;
            over < 0.0 || (over == 0.0 && grows < 0.0)
        };
        !is_below(cell.floor)
            && is_below(cell.ceiling)
            && self.plan.span(self.prisms.sides_of(cell)).is_some()
    }

    /// The prism in which the ray is at `t`, in the zone: on a border that in which the walk may be, air rather than matter,
    /// and that which the ray enters rather than the one that it leaves.
    pub(super) fn find(&self, t: f64) -> Option<u32> {
        let zone = self.prisms.zone.map(DVec3::from);
        let point = self.at(t).max(zone[0]).min(zone[1]);
        let ahead = point + self.direction * (2.0 * NEAR);
        let mut best: Option<(u32, (bool, bool, bool))> = None;
        for &index in self.prisms.listed(point) {
            let cell = &self.prisms.cells[index as usize];
            let is_here = self.prisms.outside(cell, point) <= NEAR
                && self.plan.span(self.prisms.sides_of(cell)).is_some();
            if !is_here {
                continue;
            }
            let is_left = self.prisms.outside(cell, ahead) > NEAR / 2.0;
            let rank = (!self.is_member(cell, t), cell.kind != CellRecord::AIR, is_left);
            if best.is_none_or(|(_, least)| rank < least) {
                best = Some((index, rank));
            }
        }
        best.map(|(index, _)| index)
    }

    /// The way aside, no longer than `margin`, to a parallel ray that starts in the air at `t`, `clear` away from matter;
    /// and the prism that it starts in: `hint`, or the nearest, or of several on whose border the ray starts the one
    /// that it enters. Not one that was `tried`.
    #[cold]
    pub(super) fn aside(
        &self,
        t: f64,
        hint: u32,
        clear: f64,
        margin: f64,
        tried: &[u32],
    ) -> Option<(DVec3, u32)> {
        let point = self.at(t);
        let ahead = point + self.direction * (2.0 * NEAR);
        let mut best: Option<(u32, (bool, f64, bool))> = None;
        for &index in self.prisms.listed(point) {
            let cell = &self.prisms.cells[index as usize];
            let outside = self.prisms.outside(cell, point);
            if cell.kind != CellRecord::AIR || outside > margin || tried.contains(&index) {
                continue;
            }
            let is_left = self.prisms.outside(cell, ahead) > NEAR / 2.0;
            let rank = (index != hint, if outside <= NEAR { 0.0 } else { outside }, is_left);
            if best.is_none_or(|(_, least)| rank < least) {
                best = Some((index, rank));
            }
        }
        let (index, _) = best?;
        let way = self.prisms.way_into(&self.prisms.cells[index as usize], point, clear);
        Some((if way.length() <= 2.0 * margin { way } else { DVec3::ZERO }, index))
    }
}
