//! What a ray meets as a record: the face, its element, cell and room.

use glam::DVec3;

use super::cells::Ended;
use super::doubt::Met;
use super::kernel::Ask;
use super::line::{Line, unit};
use super::path::{BLURRED, NEAR, Prisms};
use super::plate::Plate;
#[cfg(feature = "render")]
use super::plate::plate_of;
use super::quick::Quick;
use super::ray::{Brief, Hit, NONE, Ray};
use super::single::Want;
use super::walk::{Found, Walk, each};
use crate::scene::Scene;

impl Scene {
    /// The hit of a brief answer to `ray`, its triangle that of the answer; that of a ray that starts in a solid lacks the element.
    pub fn hit(&self, ray: &Ray, brief: &Brief, want: Want) -> Hit {
        let Brief { t, triangle, cell } = *brief;
        if triangle as usize >= self.tables.triangles.len() || cell as usize >= self.tables.cells.len() {
            return Hit { t, ..Hit::ESCAPED };
        }
        self.describe_quick(ray, &Quick { found: Found { t, triangle }, cell, source: NONE }, want)
    }

    /// What a ray meets that leaves a cell of air first through a face with this source, which is plain; `None` if that cannot be told by its plane.
    #[cfg(feature = "render")]
    pub(crate) fn hit_on_source(&self, ray: &Ray, cell: u32, source: u32, want: Want) -> Option<Hit> {
        let triangle = self.tables.plates.get(source as usize)?.triangle;
        if triangle == NONE { None } else { self.hit_on_plane(ray, cell, (triangle, source), want) }
    }

    /// What a ray meets that comes first, in a cell, to the plane of a triangle, which is of a source or of none; `None` if it runs along it.
    #[cfg(feature = "render")]
    pub(crate) fn hit_on_plane(
        &self,
        ray: &Ray,
        cell: u32,
        (triangle, source): (u32, u32),
        want: Want,
    ) -> Option<Hit> {
        /// A ray that comes to a plane with less than this sine is not told by it.
        const FLAT: f64 = 1e-6;
        let direction = unit(DVec3::from(ray.direction))?;
        let plate = plate_of(&self.tables.triangles, &self.tables.vertices, triangle);
        let normal = DVec3::from(plate.normal);
        let sine = normal.dot(direction);
        let t = (plate.offset - normal.dot(DVec3::from(ray.origin))) / sine;
        if sine.abs() < FLAT || !(t.is_finite() && t >= ray.tmin && t <= ray.tmax) {
            return None;
        }
        Some(self.describe_quick(ray, &Quick { found: Found { t, triangle }, cell, source }, want))
    }

    /// Whether a ray that comes to the plane of a source, or else of a triangle, at `t` meets the source or the triangle.
    #[cfg(feature = "render")]
    pub(crate) fn is_met(&self, ray: &Ray, t: f64, (triangle, source): (u32, u32)) -> bool {
        let Some(direction) = unit(DVec3::from(ray.direction)) else { return false };
        let (tmin, tmax) = (ray.tmin, ray.tmax);
        let line = Line { origin: DVec3::from(ray.origin), direction, tmin, tmax, start: tmin };
        if source != NONE {
            return self.very_triangle(&line, source, t).is_some();
        }
        let mut found = Found { t: f64::INFINITY, triangle: NONE };
        line.query(&self.tables, None).test(&Walk::new(&self.tables), triangle, &mut found);
        found.triangle != NONE
    }

    /// What the quick way found, as a record.
    pub(super) fn describe_quick(&self, ray: &Ray, quick: &Quick, want: Want) -> Hit {
        let &Quick { found, cell, source } = quick;
        let Some(direction) = unit(DVec3::from(ray.direction)) else { return Hit::ESCAPED };
        if found.triangle == NONE {
            return Hit::ESCAPED;
        }
        let (tmin, tmax) = (ray.tmin, ray.tmax);
        let line = Line { origin: DVec3::from(ray.origin), direction, tmin, tmax, start: tmin };
        if let Some(plate) = self.tables.plates.get(source as usize)
            && plate.triangle == found.triangle
            && let Some(room) = self.tables.room_of(cell)
        {
            return self.describe_plate(&line, plate, (found.t, source), (cell, room), want);
        }
        let mut hit = self.describe(&line, Ended { found, cell, in_matter: false }, want);
        if want.triangle
            && source != NONE
            && let Some(triangle) = self.very_triangle(&line, source, found.t)
        {
            hit.triangle = triangle;
        }
        hit
    }

    /// The same of a plain face, from its plate: as [`Scene::describe`] has it of the plate's triangle.
    #[inline(always)]
    fn describe_plate(
        &self,
        line: &Line,
        plate: &Plate,
        (t, source): (f64, u32),
        (cell, room): (u32, u32),
        want: Want,
    ) -> Hit {
        let normal = DVec3::from(plate.normal);
        let normal = if normal.dot(line.direction) > 0.0 { -normal } else { normal };
        let point = line.origin + line.direction * t;
        let mut triangle = plate.triangle;
        if want.triangle {
            let very = plate.told(point).or_else(|| self.very_triangle(line, source, t));
            triangle = very.unwrap_or(triangle);
        }
        let kind = if want.face { Prisms::new(&self.tables).kind(cell, plate.triangle) } else { None };
        Hit {
            // Not -0.
            t: t + 0.0,
            point: point.to_array(),
            normal: normal.to_array(),
            element: plate.element,
            semantic: kind.unwrap_or_else(|| self.semantic_of(plate.element)),
            material: plate.material,
            cell,
            room,
            triangle,
        }
    }

    /// The triangle of a source that the ray meets, where it meets its plane at `t`.
    #[inline(never)]
    fn very_triangle(&self, line: &Line, source: u32, t: f64) -> Option<u32> {
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let root = tables.sources.get(source as usize)?.root;
        let mut best = Found { t: f64::INFINITY, triangle: NONE };
        if root != NONE {
            let mut query = line.query(tables, None);
            query.aim(root, f64::INFINITY);
            best = self.kernel.run(Ask::First, &walk, &query);
        } else {
            let triangles = Prisms::new(tables).triangles_of(source);
            let point = line.origin + line.direction * t;
            let holder =
                tables.plates.get(source as usize).and_then(|plate| plate.holder(&walk, triangles, point));
            if holder.is_some() {
                return holder;
            }
            let query = line.query(tables, None);
            for &triangle in triangles {
                query.test(&walk, triangle, &mut best);
            }
        }
        (best.triangle != NONE).then_some(best.triangle)
    }

    /// What a ray meets as a record.
    pub(super) fn describe_met(&self, met: Met, want: Want) -> Hit {
        match met {
            Met::At(line, ended) => self.describe(&line, ended, want),
            Met::Nothing => Hit::ESCAPED,
            Met::InSolid(element) => Hit::in_solid(element, self.tables.elements[element as usize].semantic),
        }
    }

    #[inline]
    pub(super) fn describe(&self, line: &Line, Ended { found, cell, .. }: Ended, want: Want) -> Hit {
        let record = self.tables.record(found.triangle);
        let [a, b, c] = each(record.vertices, |v| DVec3::from(self.tables.vertices[v as usize]));
        let normal = (b - a).cross(c - a);
        let size = normal.length();
        let scale = if normal.dot(line.direction) > 0.0 { -1.0 / size } else { 1.0 / size };
        let normal = if scale.is_finite() { normal * scale } else { DVec3::ZERO };
        let point = line.origin + line.direction * found.t;
        let (cell, room) = match self.tables.room_of(cell) {
            Some(room) => (cell, room),
            _ if self.tables.cells.len() > 1 => self.air_before(point, normal),
            _ if want.room => (cell, self.room_before(line, found.t)),
            _ => (cell, NONE),
        };
        let kind = if want.face { Prisms::new(&self.tables).kind(cell, found.triangle) } else { None };
        Hit {
            // Not -0.
            t: found.t + 0.0,
            point: point.to_array(),
            normal: normal.to_array(),
            element: record.element,
            semantic: kind.unwrap_or_else(|| self.semantic_of(record.element)),
            material: record.material,
            cell,
            room,
            triangle: found.triangle,
        }
    }

    #[inline(always)]
    fn semantic_of(&self, element: u32) -> u32 {
        u32::from(self.tables.semantics[element as usize])
    }

    /// The cell of air before a surface that was not met on a walk through cells, and its room.
    fn air_before(&self, point: DVec3, normal: DVec3) -> (u32, u32) {
        /// Farther from a face than cells are blurred, as is what tells a cell soon.
        const AHEAD: f64 = 3.0 * BLURRED;
        let prisms = Prisms::new(&self.tables);
        let is_air = |&cell: &u32| self.tables.is_air(cell);
        let air = |point: DVec3| prisms.place(prisms.local(point), self.tolerance()).filter(is_air);
        // On the side from which it was met: an open surface has air on both. No farther: in small models the next cell may be as near as cells are blurred.
        let before = point + normal * (0.5 * self.tolerance());
        // Mostly the one a little farther on, which is found sooner: it holds this place, too.
        let ahead = (point + normal * AHEAD).to_array();
        let holds = |&(cell, _): &(u32, bool)| {
            prisms.nearly_holds(&prisms.cells[cell as usize], prisms.local(before), -NEAR)
        };
        let cell = self.kernel.free(&self.tables, ahead, NONE).filter(holds).map(|(cell, _)| cell);
        let cell = cell.or_else(|| air(before)).or_else(|| air(point)).unwrap_or(0);
        (cell, self.tables.cells[cell as usize].room)
    }

    /// The room in which the ray ends at `t`: labels may end a little before the surface, so also looked for a little
    /// before it.
    fn room_before(&self, line: &Line, t: f64) -> u32 {
        /// How far room labels may stay behind the surfaces around them, metres.
        const GAP: f64 = 0.05;
        [self.tolerance(), GAP]
            .iter()
            .map(|back| (line.origin + line.direction * (t - back).max(line.tmin)).to_array())
            .find_map(|point| self.room_at(point))
            .unwrap_or(NONE)
    }
}
