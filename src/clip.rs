//! Convex polygons in space, cut by planes.

use glam::DVec3;

/// Keeps of a polygon what is not beyond the plane `normal . p = offset`; `next` is room for the corners. Whether anything is left.
pub(crate) fn keep_below(
    polygon: &mut Vec<DVec3>,
    next: &mut Vec<DVec3>,
    normal: DVec3,
    offset: f64,
) -> bool {
    next.clear();
    let over = |p: DVec3| normal.dot(p) - offset;
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (here, there) = (over(p), over(q));
        if here <= 0.0 {
            next.push(p);
        }
        if (here <= 0.0) != (there <= 0.0) {
            next.push(p + (q - p) * (here / (here - there)).clamp(0.0, 1.0));
        }
    }
    std::mem::swap(polygon, next);
    !polygon.is_empty()
}
