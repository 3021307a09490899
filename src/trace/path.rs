//! A ray among prisms: where it leaves one, which part of its surface it leaves through, and in which prism a point
//! lies.

use glam::{DVec2, DVec3};

use super::NONE;
use super::plan::PlanLine;
use crate::format::Views;
use crate::format::records::{
    CellRecord, CoverRecord, FaceRecord, PLAIN, PlaneRecord, SideRecord, SourceRecord,
};

/// A ray that ends is followed so many times the tolerance farther than that: what it meets before may stand behind a face of a cell that it comes to
/// only there, if it comes to the face at no less of an angle than one by this.
pub(super) const BEYOND: f64 = 64.0;

/// A point no farther than this outside of a prism counts as in it, metres: what rounding can move it.
pub(super) const NEAR: f64 = 1e-9;

/// So far, metres, cells may differ from the model: what the partition's audit lets pass, its straightening, and rounding.
/// Where a ray passes an edge of a face this near, cells do not tell on which side.
pub(crate) const BLURRED: f64 = 5e-4;

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
    /// Whether it is so near to an edge that a ray hardly aside may leave otherwise.
    pub(super) is_near_edge: bool,
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
        Exit { t, cell, source: NONE, through: Through::Air, is_near_edge: false }
    }
}

/// The prisms of a scene.
#[derive(Clone, Copy)]
pub(crate) struct Prisms<'a> {
    pub(crate) cells: &'a [CellRecord],
    sides: &'a [SideRecord],
    faces: &'a [FaceRecord],
    covers: &'a [CoverRecord],
    planes: &'a [PlaneRecord],
    sources: &'a [SourceRecord],
    surfaces: &'a [u32],
    starts: &'a [u32],
    listed: &'a [u32],
    pub(crate) zone: [[f64; 3]; 2],
    step: [f64; 3],
    dims: [u32; 3],
    origin: [f64; 3],
    turn: [f64; 2],
    /// Bounds all coordinates from the lattice's origin, metres.
    reach: f64,
}

impl<'a> Prisms<'a> {
    #[inline]
    pub(crate) fn new(tables: &'a Views) -> Prisms<'a> {
        let scene = &tables.scene[0];
        Prisms {
            cells: &tables.cells,
            sides: &tables.sides,
            faces: &tables.faces,
            covers: &tables.covers,
            planes: &tables.planes,
            sources: &tables.sources,
            surfaces: &tables.surfaces,
            starts: &tables.cellgrid,
            listed: &tables.gridcells,
            zone: scene.zone,
            step: scene.grid_step,
            dims: scene.grid_dims,
            origin: scene.lattice_origin,
            turn: scene.lattice_turn,
            reach: LARGEST * scene.lattice_step(),
        }
    }

    /// Those of a scene that is being compiled, without the grid over them.
    #[cfg(feature = "compile")]
    pub(crate) fn of(tables: &'a crate::format::Tables) -> Prisms<'a> {
        let scene = &tables.scene[0];
        Prisms {
            cells: &tables.cells,
            sides: &tables.sides,
            faces: &tables.faces,
            covers: &tables.covers,
            planes: &tables.planes,
            sources: &tables.sources,
            surfaces: &tables.surfaces,
            starts: &[],
            listed: &[],
            zone: scene.zone,
            step: scene.grid_step,
            dims: scene.grid_dims,
            origin: scene.lattice_origin,
            turn: scene.lattice_turn,
            reach: LARGEST * scene.lattice_step(),
        }
    }

    /// How far, metres, a surface of a cell commonly is from the model's: four steps of the lattice.
    pub(crate) fn rounding(&self) -> f64 {
        4.0 * self.reach / LARGEST
    }

    /// Whether a ray that comes to a face, with this normal of any length along the same axes as its direction, so far beyond its end is there, by more
    /// than cells are rounded, before the face: almost along it, it may have met what stands there.
    pub(super) fn ends_before(&self, outward: DVec3, direction: DVec3, beyond: f64) -> bool {
        beyond * outward.dot(direction).abs() >= self.rounding() * outward.length()
    }

    /// A point of the internal frame along the lattice's axes from its origin.
    #[inline]
    pub(crate) fn local(&self, point: DVec3) -> DVec3 {
        DVec3::from(to_lattice(point.to_array(), self.origin, self.turn))
    }

    /// A direction along the lattice's axes in the internal frame.
    pub(crate) fn turned_back(&self, direction: DVec3) -> DVec3 {
        let [cos, sin] = self.turn;
        let [x, y, z] = direction.to_array();
        DVec3::new(x * cos - y * sin, x * sin + y * cos, z)
    }

    /// A direction of the internal frame along the lattice's axes.
    #[inline]
    pub(crate) fn turned(&self, direction: DVec3) -> DVec3 {
        DVec3::from(to_lattice(direction.to_array(), [0.0; 3], self.turn))
    }

    #[inline(always)]
    pub(crate) fn sides_of(&self, cell: &CellRecord) -> &'a [SideRecord] {
        &self.sides[cell.first_side as usize..(cell.first_side + cell.sides) as usize]
    }

    /// The parts of a side, from the floor up.
    pub(crate) fn faces_of(&self, side: &SideRecord) -> &'a [FaceRecord] {
        &self.faces[side.first_face as usize..(side.first_face + side.faces) as usize]
    }

    /// What lies below a cell's floor, and above its ceiling.
    pub(crate) fn covers_of(&self, cell: &CellRecord) -> (&'a [CoverRecord], &'a [CoverRecord]) {
        let first = cell.first_cover as usize;
        self.covers[first..first + (cell.below + cell.above) as usize].split_at(cell.below as usize)
    }

    /// What lies beyond each part of a cell's surface: the cell, the source, the number of the kind.
    pub(crate) fn beyond(&self, cell: &CellRecord) -> impl Iterator<Item = (u32, u32, u32)> + use<'a> {
        let own = *self;
        let faces = self.sides_of(cell).iter().flat_map(move |side| own.faces_of(side));
        let (below, above) = self.covers_of(cell);
        let covers = below.iter().chain(above).map(|cover| (cover.cell, cover.source, cover.kind.into()));
        faces.map(|face| (face.cell, face.source, u32::from(face.kind))).chain(covers)
    }

    /// The triangles of a surface; none of [`NONE`].
    pub(crate) fn triangles_of(&self, source: u32) -> &'a [u32] {
        let record = self.sources.get(source as usize);
        record.map_or(&[], |record| {
            &self.surfaces[record.first as usize..(record.first + record.count) as usize]
        })
    }

    /// The height of a plane over a point of the plan, both from the lattice's origin.
    pub(crate) fn height(&self, plane: u32, at: DVec2) -> f64 {
        let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
        p * at.x + q * at.y + height
    }

    /// A plane of floors or ceilings.
    #[cfg(feature = "render")]
    pub(crate) fn plane(&self, plane: u32) -> PlaneRecord {
        self.planes[plane as usize]
    }

    /// The height of a plane that is level.
    pub(super) fn level(&self, plane: u32) -> Option<f64> {
        let PlaneRecord { slope, height } = *self.planes.get(plane as usize)?;
        (slope == [0.0; 2]).then_some(height)
    }

    /// A point from the lattice's origin, along its axes, in the internal frame.
    pub(crate) fn global(&self, point: DVec3) -> DVec3 {
        self.turned_back(point) + DVec3::from(self.origin)
    }

    /// The number of the kind of the first face, of sides and then of floor and ceiling, that a triangle is part of, if it is one of
    /// the cell's own surface.
    pub(super) fn kind(&self, cell: u32, triangle: u32) -> Option<u32> {
        let mut beyond = self.beyond(&self.cells[cell as usize]);
        let found = beyond.find(|(_, source, _)| self.triangles_of(*source).binary_search(&triangle).is_ok());
        found.map(|(.., kind)| kind)
    }

    /// A normal of a plane, upward.
    pub(super) fn upward(&self, plane: u32) -> DVec3 {
        let [p, q] = self.planes[plane as usize].slope;
        DVec3::new(-p, -q, 1.0)
    }

    /// Whether `point` (from the lattice's origin) lies in the zone of the prisms.
    #[inline]
    pub(crate) fn hold(&self, point: DVec3) -> bool {
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

    /// The prisms that may reach to the stretch between two points (from the lattice's origin), some of them more than once.
    pub(crate) fn listed_along(&self, from: DVec3, to: DVec3) -> Vec<u32> {
        let cubes = |axis: usize| {
            let most = f64::from(self.dims[axis].saturating_sub(1));
            let cube =
                |c: f64| ((c - self.zone[0][axis]) / self.step[axis]).floor().max(0.0).min(most) as usize;
            cube(from[axis].min(to[axis]))..=cube(from[axis].max(to[axis]))
        };
        let mut listed = Vec::new();
        for z in cubes(2) {
            for y in cubes(1) {
                for x in cubes(0) {
                    let index = (z * self.dims[1] as usize + y) * self.dims[0] as usize + x;
                    if let (Some(&start), Some(&end)) = (self.starts.get(index), self.starts.get(index + 1)) {
                        listed.extend_from_slice(&self.listed[start as usize..end as usize]);
                    }
                }
            }
        }
        listed
    }

    /// Between which multiples of `along` from `origin` (along the lattice's axes, from its origin) a line is in the prism, as
    /// far as f64 tells; `None` if it is not.
    pub(crate) fn span(&self, cell: &CellRecord, origin: DVec3, along: DVec3) -> Option<[f64; 2]> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        // Inside of each plane it is at most 0.
        let mut cut = |over: f64, grows: f64| {
            if grows == 0.0 {
                return over <= 0.0;
            }
            let t = -over / grows;
            if grows > 0.0 {
                leave = leave.min(t)
            } else {
                enter = enter.max(t)
            }
            true
        };
        let mut plane = |plane: u32, up: f64| {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            cut(
                (origin.z - p * origin.x - q * origin.y - height) * up,
                (along.z - p * along.x - q * along.y) * up,
            )
        };
        let mut inside = plane(cell.floor, -1.0) && plane(cell.ceiling, 1.0);
        for [a, b] in edges(self.sides_of(cell)) {
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            inside &= cut(ex * (a[1] - origin.y) - ey * (a[0] - origin.x), ey * along.x - ex * along.y);
        }
        (inside && enter < leave).then_some([enter, leave])
    }

    /// Whether `point` (from the lattice's origin) is in the prism, or outside by no more than some `margin`.
    #[inline]
    pub(crate) fn nearly_holds(&self, cell: &CellRecord, point: DVec3, margin: f64) -> bool {
        let over = |plane: u32, up: f64| {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            (point.z - p * point.x - q * point.y - height) * up <= margin * (1.0 + p.abs() + q.abs())
        };
        over(cell.floor, -1.0) && over(cell.ceiling, 1.0) && self.nearly_holds_in_plan(cell, point, margin)
    }

    /// The same in the plan.
    #[inline]
    fn nearly_holds_in_plan(&self, cell: &CellRecord, point: DVec3, margin: f64) -> bool {
        edges(self.sides_of(cell)).all(|[a, b]| {
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            ex * (a[1] - point.y) - ey * (a[0] - point.x) <= margin * (ex.abs() + ey.abs())
        })
    }

    /// Whether `point` (from the lattice's origin), in the prism, is no farther than some `margin` from a face of it behind which triangles may stand
    /// out of that: a ray may start behind those.
    pub(super) fn is_beside_rough(&self, cell: &CellRecord, point: DVec3, margin: f64) -> bool {
        self.is_beside(cell, point, margin, |source, flags| source != NONE && flags & PLAIN == 0)
    }

    /// The same of any face behind which there are triangles.
    pub(super) fn is_beside_matter(&self, cell: &CellRecord, point: DVec3, margin: f64) -> bool {
        self.is_beside(cell, point, margin, |source, _| source != NONE)
    }

    /// Whether `point`, in the prism, is no farther than some `margin` from one of the faces that are asked for, by source and flags.
    fn is_beside(
        &self,
        cell: &CellRecord,
        point: DVec3,
        margin: f64,
        is_asked: impl Fn(u32, u16) -> bool,
    ) -> bool {
        // How far the point is over a plane, and how far aside that is at most for each metre.
        let over = |plane: u32| {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            (point.z - p * point.x - q * point.y - height, margin * (1.0 + p.abs() + q.abs()))
        };
        let is_near = |plane: u32| {
            let (over, margin) = over(plane);
            over.abs() <= margin
        };
        let covers = |covers: &[CoverRecord]| {
            covers.iter().any(|cover| {
                let beyond = &self.cells[cover.cell as usize];
                is_asked(cover.source, cover.flags) && self.nearly_holds_in_plan(beyond, point, margin)
            })
        };
        let (below, above) = self.covers_of(cell);
        if (is_near(cell.floor) && covers(below)) || (is_near(cell.ceiling) && covers(above)) {
            return true;
        }
        let sides = self.sides_of(cell);
        edges(sides).zip(sides).any(|([a, b], side)| {
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            let off = ex * (a[1] - point.y) - ey * (a[0] - point.x);
            let along = ex * (point.x - a[0]) + ey * (point.y - a[1]);
            let size = margin * (ex.abs() + ey.abs());
            if off.abs() > size || along < -size || along > ex * ex + ey * ey + size {
                return false;
            }
            let mut bottom = cell.floor;
            self.faces_of(side).iter().any(|face| {
                let top = if face.top == NONE { cell.ceiling } else { face.top };
                let ((above, low), (under, high)) = (over(bottom), over(top));
                bottom = top;
                is_asked(face.source, face.flags) && above >= -low && under <= high
            })
        })
    }

    /// Of how many edges of a prism of air a point of the plan is no farther within than `near`, and whether it is of none farther out than `out`; `None`
    /// of what is no such prism.
    #[cold]
    #[inline(never)]
    pub(super) fn edges_beside(
        &self,
        cell: &CellRecord,
        [x, y]: [f64; 2],
        near: f64,
        out: f64,
    ) -> Option<(u32, bool)> {
        if cell.kind != CellRecord::AIR {
            return None;
        }
        let sides = self.sides_of(cell);
        let [mut ax, mut ay] = sides.last()?.start.map(f64::from);
        let (mut beside, mut is_in) = (0, true);
        // Of the sides of a straight edge one counts.
        let mut before = [0.0; 2];
        let ends = sides.iter().chain(sides.first()).map(|side| side.start.map(f64::from));
        for (number, [bx, by]) in ends.enumerate() {
            let [ex, ey] = [bx - ax, by - ay];
            if number > 0 {
                let (inward, size) = (ex * (y - ay) - ey * (x - ax), ex.abs() + ey.abs());
                let turns = before[0] * ey != before[1] * ex;
                beside += u32::from(turns && inward < near * size);
                is_in &= inward >= -out * size;
            }
            (ax, ay, before) = (bx, by, [ex, ey]);
        }
        Some((beside, is_in))
    }

    /// Whether a ray that starts in a prism of air, or no farther than `out` behind its faces, goes away from each of those that it starts nearer to than `near`, at an
    /// angle whose sine is `least` or more. `from` and `along` are of the lattice's axes, the latter of unit length.
    pub(super) fn leaves_faces(
        &self,
        cell: &CellRecord,
        [from, along]: [DVec3; 2],
        [near, out]: [f64; 2],
        least: f64,
    ) -> bool {
        let is_left = |within: f64, grows: f64, size: f64| {
            within >= -out * size && (within >= near * size || grows >= least * size)
        };
        let leaves_level = |plane: u32, up: f64| {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            let over = |v: DVec3| (v.z - p * v.x - q * v.y) * up;
            is_left(over(from) - height * up, over(along), (1.0 + p * p + q * q).sqrt())
        };
        let leaves_edge = |edge: [[f64; 2]; 2]| {
            let [a, b] = edge;
            let grows = (b[0] - a[0]) * along.y - (b[1] - a[1]) * along.x;
            is_left(turn(edge, from), grows, length(edge))
        };
        cell.kind == CellRecord::AIR
            && leaves_level(cell.floor, 1.0)
            && leaves_level(cell.ceiling, -1.0)
            && edges(self.sides_of(cell)).all(leaves_edge)
    }

    /// How far, metres, `point` is outside of the prism's farthest plane; negative within it.
    #[cfg(feature = "render")]
    pub(crate) fn outside(&self, cell: &CellRecord, point: DVec3) -> f64 {
        self.over(cell, point).max(-inward(self.sides_of(cell), point))
    }

    /// How far, metres, `point` is under the prism's floor or over its ceiling; negative between them.
    fn over(&self, cell: &CellRecord, point: DVec3) -> f64 {
        let over = |plane: u32, up: f64| {
            let PlaneRecord { slope: [p, q], height } = self.planes[plane as usize];
            (point.z - p * point.x - q * point.y - height) * up / (1.0 + p * p + q * q).sqrt()
        };
        over(cell.floor, -1.0).max(over(cell.ceiling, 1.0))
    }

    /// The prism of air that holds `point` (from the lattice's origin) or is nearest to it, and no farther than `margin`;
    /// else one of matter.
    pub(crate) fn place(&self, point: DVec3, margin: f64) -> Option<u32> {
        if !self.hold(point) {
            return None;
        }
        let mut best: Option<(bool, f64, u32)> = None;
        for &index in self.listed(point) {
            let cell = &self.cells[index as usize];
            let [lo, hi] = cell.bounds.map(DVec3::from);
            if (point + margin).cmplt(lo).any() || (point - margin).cmpgt(hi).any() {
                continue;
            }
            // In the one or in the other: of two that meet there, the lower.
            let outside = self.over(cell, point).max(beyond(self.sides_of(cell), point));
            let rank = (cell.kind != CellRecord::AIR, outside, index);
            if outside <= margin && best.is_none_or(|best| rank < best) {
                best = Some(rank);
            }
        }
        best.map(|(_, _, index)| index)
    }
}

/// The edges of a footprint.
#[inline]
fn edges(sides: &[SideRecord]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    let next = sides.iter().skip(1).chain(sides.first());
    sides.iter().zip(next).map(|(a, b)| [a, b].map(|side| side.start.map(f64::from)))
}

/// How far, metres, `point` is inside of the nearest of a footprint's sides; negative outside.
fn inward(sides: &[SideRecord], point: DVec3) -> f64 {
    edges(sides).map(|edge| turn(edge, point) / length(edge)).fold(f64::INFINITY, f64::min)
}

/// How far, metres, `point` is outside of the farthest of a footprint's sides, or 0 within: roots are for those it is outside of only.
fn beyond(sides: &[SideRecord], point: DVec3) -> f64 {
    edges(sides).fold(0.0, |most, edge| {
        let turn = turn(edge, point);
        if turn < 0.0 { f64::max(most, -turn / length(edge)) } else { most }
    })
}

/// Twice the area of the triangle of an edge and a point, positive inside of it.
fn turn([a, b]: [[f64; 2]; 2], point: DVec3) -> f64 {
    (b[0] - a[0]) * (point.y - a[1]) - (b[1] - a[1]) * (point.x - a[0])
}

fn length([a, b]: [[f64; 2]; 2]) -> f64 {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    (x * x + y * y).sqrt()
}

/// A point, metres in the internal frame, along the axes of the lattice from its origin.
#[inline]
pub(crate) fn to_lattice(p: [f64; 3], origin: [f64; 3], [cos, sin]: [f64; 2]) -> [f64; 3] {
    let [x, y, z] = [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
    [x * cos + y * sin, y * cos - x * sin, z]
}

/// A normal of the side over the edge between two corners, outward.
#[inline]
pub(super) fn outward(from: [f32; 2], to: [f32; 2]) -> DVec3 {
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
        let (slant, by_corner) = match span {
            _ if self.plan.vertical => (0.0, inward(sides, self.origin) < BLURRED),
            Some(span) => (span.slant, span.nearest < BLURRED * self.plan.length),
            None => return None,
        };
        // Whether a ray `BLURRED` aside crosses a plane on the other side of where it leaves the footprint.
        let is_near =
            |over: f64, grows: f64| (over + t * grows).abs() < BLURRED * (2.0 + slant * grows.abs());
        let mut is_near_edge = by_corner
            || (!self.plan.vertical && (is_near(floor, floor_grows) || is_near(ceiling, ceiling_grows)));
        if down || up {
            let (t_down, t_up) = (-floor / floor_grows, -ceiling / ceiling_grows);
            let first = cell.first_cover as usize;
            let middle = first + cell.below as usize;
            let (t, grows, covers, through) = if down && !(up && t_up < t_down) {
                (t_down, floor_grows, &self.prisms.covers[first..middle], Through::Floor)
            } else {
                let covers = &self.prisms.covers[middle..middle + cell.above as usize];
                (t_up, ceiling_grows, covers, Through::Ceiling)
            };
            is_near_edge |= down && up && (t_down - t_up).abs() * grows.abs() < 4.0 * BLURRED;
            let cover = self.cover(covers, t, BLURRED * (1.0 + self.plan.length / grows.abs()))?;
            // By a side, too, that it runs along and never comes to.
            let is_near_edge = is_near_edge || inward(sides, self.origin + self.direction * t) < BLURRED;
            return Some(Exit {
                t: t + self.start,
                cell: cover.cell,
                source: cover.source,
                through,
                is_near_edge,
            });
        }
        // Vertical, and its planes say neither up nor down: no prism.
        let index = side?;
        let side = &sides[index];
        let first = side.first_face as usize;
        let faces = &self.prisms.faces[first..first + side.faces as usize];
        let (last, others) = faces.split_last()?;
        let mut face = last;
        for other in others.iter().rev() {
            if other.top == NONE {
                face = other;
                continue;
            }
            let (over, grows) = self.over(other.top);
            is_near_edge |= is_near(over, grows);
            if over + t * grows < 0.0 {
                face = other;
            }
        }
        let through = Through::Side(cell.first_side + index as u32);
        Some(Exit { t: t + self.start, cell: face.cell, source: face.source, through, is_near_edge })
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

    /// The part of a floor or ceiling that the ray passes, `t` from its start, if it is so far inside of its border.
    #[inline]
    fn cover(&self, covers: &[CoverRecord], t: f64, margin: f64) -> Option<CoverRecord> {
        if let [only] = covers {
            return Some(*only);
        }
        let point = self.origin + self.direction * t;
        let mut around = None;
        for cover in covers {
            let cell = self.prisms.cells.get(cover.cell as usize)?;
            if cell.kind == CellRecord::AROUND {
                around = Some(*cover);
                continue;
            }
            let [lo, hi] = cell.bounds;
            let may_hold = point.x >= lo[0] && point.x <= hi[0] && point.y >= lo[1] && point.y <= hi[1];
            if may_hold {
                let inward = inward(self.prisms.sides_of(cell), point);
                if inward >= margin {
                    return Some(*cover);
                }
                if inward >= -margin {
                    return None;
                }
            }
        }
        // Around the prisms: only where none of them is.
        around
    }
}
