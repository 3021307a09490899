//! A surface as pictures show it: what all rays that meet it first have in common.

use glam::DVec3;

use super::describe::Spot;
use super::line::Line;
use super::plate::{Plate, plate_of};
use super::quick::Quick;
use super::ray::{Hit, NONE, Ray};
use super::single::Want;
use super::walk::{Found, Walk};
use crate::scene::Scene;

/// A ray that comes to a plane with less than this sine is not told by it.
const FLAT: f64 = 1e-6;

/// The plane that all rays come to which leave a cell through one face, or meet one triangle in it.
pub(crate) struct Target<'s> {
    scene: &'s Scene,
    plate: Plate,
    /// Of the face, or none.
    source: u32,
    cell: u32,
    /// What is told of the cell, if it is one of air.
    spot: Option<Spot>,
    want: Want,
}

impl<'s> Target<'s> {
    /// What leaves a cell of air first through a face with this source; `None` if the face is not plain.
    pub(crate) fn source(scene: &'s Scene, cell: u32, source: u32, want: Want) -> Option<Target<'s>> {
        let plate = scene.tables.plates.get(source as usize).filter(|plate| plate.triangle != NONE)?;
        Some(Target::new(scene, *plate, cell, source, want))
    }

    /// What meets a triangle first in a cell.
    pub(crate) fn triangle(scene: &'s Scene, cell: u32, triangle: u32, want: Want) -> Option<Target<'s>> {
        let plate = plate_of(&scene.tables.triangles, &scene.tables.vertices, triangle);
        if plate.triangle == NONE {
            return None;
        }
        let record = scene.tables.record(triangle);
        let plate = plate.alone(record.element, record.material);
        Some(Target::new(scene, plate, cell, NONE, want))
    }

    fn new(scene: &'s Scene, plate: Plate, cell: u32, source: u32, want: Want) -> Target<'s> {
        let spot = scene.spot_of(cell, plate.triangle, plate.element, want);
        Target { scene, plate, source, cell, spot, want }
    }

    /// What one of the rays meets; `None` if it runs along the plane.
    #[inline]
    pub(crate) fn hit(&self, ray: &Ray) -> Option<Hit> {
        let line = Line::whole(ray)?;
        let normal = DVec3::from(self.plate.normal);
        let sine = normal.dot(line.direction);
        let t = (self.plate.offset - normal.dot(line.origin)) / sine;
        if sine.abs() < FLAT || !(t.is_finite() && t >= line.tmin && t <= line.tmax) {
            return None;
        }
        Some(match self.spot {
            Some(spot) => self.scene.describe_plate(&line, &self.plate, (t, self.source), spot, self.want),
            None => {
                let found = Found { t, triangle: self.plate.triangle };
                let quick = Quick { found, cell: self.cell, source: self.source };
                self.scene.describe_quick(ray, &quick, self.want)
            }
        })
    }

    /// Whether a ray that comes to the plane at `t` meets the surface itself.
    pub(crate) fn is_met(&self, ray: &Ray, t: f64) -> bool {
        let Some(line) = Line::whole(ray) else { return false };
        if self.source != NONE {
            return self.scene.very_triangle(&line, self.source, t).is_some();
        }
        let mut found = Found { t: f64::INFINITY, triangle: NONE };
        let tables = &self.scene.tables;
        line.query(tables, None).test(&Walk::new(tables), self.plate.triangle, &mut found);
        found.triangle != NONE
    }
}
