//! The planes behind faces, worked out when a scene is opened.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::NONE;

/// The plane of a source's triangles: `normal . p = offset`, internal frame, metres. Zeros where they lie in none.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Plate {
    /// Unit length.
    pub(crate) normal: [f64; 3],
    /// Metres.
    pub(crate) offset: f64,
    /// The triangle in whose plane the others lie, or none.
    pub(crate) triangle: u32,
    /// Zero.
    reserved: u32,
}

/// The plane of a triangle; zeros for none.
pub(crate) fn plate_of(triangles: &[[u32; 3]], vertices: &[[f64; 3]], triangle: u32) -> Plate {
    let Some(corners) = triangles.get(triangle as usize) else {
        return Plate { triangle: NONE, ..Plate::zeroed() };
    };
    let [a, b, c] = corners.map(|v| DVec3::from(vertices[v as usize]));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    Plate { normal: normal.to_array(), offset: normal.dot(a), triangle, reserved: 0 }
}
