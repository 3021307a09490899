//! The planes behind faces, worked out when a scene is opened.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::NONE;
use super::walk::Walk;

/// A triangle holds a point well if its border is at least so far away, metres: more than a source's triangles are off their plane, two micrometres,
/// seen at a sine of [`GRAZING`](super::quick::GRAZING).
const WELL: f64 = 2e-4;

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

impl Plate {
    /// The first of a source's triangles that holds a point of this plane well.
    pub(super) fn holder(&self, walk: &Walk<'_>, triangles: &[u32], point: DVec3) -> Option<u32> {
        let size = DVec3::from(self.normal).abs();
        // The two axes in which it looks largest.
        let (x, y) = if size.z >= size.x.max(size.y) {
            (0, 1)
        } else if size.x >= size.y {
            (1, 2)
        } else {
            (2, 0)
        };
        let mut triangles = triangles.iter().copied();
        triangles.find(|&triangle| {
            let corners = walk.corners(triangle).map(|p| [p[x] - point[x], p[y] - point[y]]);
            // How far within each side it is, times at most the side's size, and that.
            let sides = [0, 1, 2].map(|side| {
                let ([ax, ay], [bx, by]) = (corners[side], corners[(side + 1) % 3]);
                // Nor does a triangle that is a point hold any.
                let well = WELL * ((bx - ax).abs() + (by - ay).abs()) + f64::MIN_POSITIVE;
                (ax * by - ay * bx, well)
            });
            sides.iter().all(|&(within, well)| within >= well)
                || sides.iter().all(|&(within, well)| -within >= well)
        })
    }
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
