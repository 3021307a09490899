//! The triangles of the bodies that carve, as the source has them.

use enfilade_importers::ElementId;
use glam::DVec3;

use super::halfspaces::Bounds;

/// A triangle of a body that carves, as the source has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatterTriangle {
    /// Its corners, counter-clockwise seen from the air; lattice units, not rounded.
    pub corners: [[f64; 3]; 3],
    /// The element that it belongs to.
    pub element: ElementId,
    /// Its index in the element's mesh.
    pub triangle: u32,
}

impl MatterTriangle {
    /// Element and index in its mesh.
    pub fn name(&self) -> (ElementId, u32) {
        (self.element, self.triangle)
    }

    pub(super) fn points(&self) -> [DVec3; 3] {
        self.corners.map(DVec3::from)
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of(&self.points())
    }

    /// The unit normal, towards the air; `None` without area.
    pub(super) fn normal(&self) -> Option<DVec3> {
        let [a, b, c] = self.points();
        (b - a).cross(c - a).try_normalize()
    }

    pub(super) fn area(&self) -> f64 {
        let [a, b, c] = self.points();
        (b - a).cross(c - a).length() / 2.0
    }
}
