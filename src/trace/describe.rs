//! What a ray meets as a record: the face, its element, cell and room.

use glam::DVec3;

use super::cells::Ended;
use super::doubt::Met;
use super::kernel::Ask;
use super::line::Line;
use super::path::{BLURRED, NEAR, Prisms};
use super::plate::Plate;
use super::quick::Quick;
use super::ray::{Brief, Hit, NONE, Ray};
use super::single::Want;
use super::walk::{Found, Walk, each};
use crate::scene::Scene;

/// A cell of air, and what is met there.
#[derive(Clone, Copy)]
pub(super) struct Spot {
    cell: u32,
    /// Or none.
    room: u32,
    semantic: u32,
}

impl Scene {
    /// The hit of a brief answer to `ray`, its triangle that of the answer; that of a ray that starts in a solid lacks the element.
    pub fn hit(&self, ray: &Ray, brief: &Brief, want: Want) -> Hit {
        let Brief { t, triangle, cell } = *brief;
        if triangle as usize >= self.tables.triangles.len() || cell as usize >= self.tables.cells.len() {
            return Hit { t, ..Hit::ESCAPED };
        }
        self.describe_quick(ray, &Quick { found: Found { t, triangle }, cell, source: NONE }, want)
    }

    /// What the quick way found, as a record.
    pub(super) fn describe_quick(&self, ray: &Ray, quick: &Quick, want: Want) -> Hit {
        let &Quick { found, cell, source } = quick;
        let Some(line) = Line::whole(ray) else { return Hit::ESCAPED };
        if found.triangle == NONE {
            return Hit::ESCAPED;
        }
        if let Some(plate) = self.tables.plates.get(source as usize)
            && plate.triangle == found.triangle
            && let Some(spot) = self.spot_of(cell, found.triangle, plate.element, want)
        {
            return self.describe_plate(&line, plate, (found.t, source), spot, want);
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

    /// What is told of a cell, if it is one of air, where a triangle of an element is met in it.
    #[inline(always)]
    pub(super) fn spot_of(&self, cell: u32, triangle: u32, element: u32, want: Want) -> Option<Spot> {
        let room = self.tables.room_of(cell)?;
        let kind = if want.face { Prisms::new(&self.tables).kind(cell, triangle) } else { None };
        Some(Spot { cell, room, semantic: kind.unwrap_or_else(|| self.semantic_of(element)) })
    }

    /// The same of a plain face, from its plate: as [`Scene::describe`] has it of the plate's triangle.
    #[inline(always)]
    pub(super) fn describe_plate(
        &self,
        line: &Line,
        plate: &Plate,
        (t, source): (f64, u32),
        Spot { cell, room, semantic }: Spot,
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
        Hit {
            // Not -0.
            t: t + 0.0,
            point: point.to_array(),
            normal: normal.to_array(),
            element: plate.element,
            semantic,
            material: plate.material,
            cell,
            room,
            triangle,
        }
    }

    /// The triangle of a source that the ray meets, where it meets its plane at `t`.
    #[inline(never)]
    pub(super) fn very_triangle(&self, line: &Line, source: u32, t: f64) -> Option<u32> {
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
