//! Volumes and areas of cells, metres.

use glam::{DVec2, DVec3};

use crate::format::records::{CellRecord, CoverRecord};
use crate::trace::Prisms;

/// Twice the area of a polygon, and six times its area times its centroid, from its first corner.
fn moments(corners: &[DVec2]) -> (f64, DVec2) {
    let Some(&first) = corners.first() else { return (0.0, DVec2::ZERO) };
    corners.windows(2).fold((0.0, DVec2::ZERO), |(area, moment), pair| {
        let [a, b] = [pair[0] - first, pair[1] - first];
        (area + a.perp_dot(b), moment + (a + b) * a.perp_dot(b))
    })
}

/// Area of a polygon whose corners go counter-clockwise.
pub(crate) fn area(corners: &[DVec2]) -> f64 {
    moments(corners).0 / 2.0
}

/// The corners of a footprint, from the lattice's origin, along its axes.
pub(crate) fn footprint(prisms: &Prisms<'_>, cell: &CellRecord) -> Vec<DVec2> {
    prisms.sides_of(cell).iter().map(|side| DVec2::from(side.start.map(f64::from))).collect()
}

/// The volume of a prism.
pub(super) fn volume(prisms: &Prisms<'_>, cell: &CellRecord) -> f64 {
    let corners = footprint(prisms, cell);
    let (twice, moment) = moments(&corners);
    if twice <= 0.0 {
        return 0.0;
    }
    // Its height is linear over the footprint: that over the centroid counts.
    let middle = corners[0] + moment / (3.0 * twice);
    let height = prisms.height(cell.ceiling, middle) - prisms.height(cell.floor, middle);
    (height * twice / 2.0).max(0.0)
}

/// The corners of a prism, internal frame.
pub(super) fn corners(prisms: &Prisms<'_>, cell: &CellRecord) -> Vec<DVec3> {
    let corners = footprint(prisms, cell).into_iter();
    let both =
        |p: DVec2| [cell.floor, cell.ceiling].map(|plane| prisms.global(p.extend(prisms.height(plane, p))));
    corners.flat_map(both).collect()
}

/// For each cell that covers a prism's floor, or its ceiling: how much of its footprint.
pub(super) fn covered(prisms: &Prisms<'_>, own: &[DVec2], covers: &[CoverRecord]) -> Vec<Vec<DVec2>> {
    let share = |cover: &CoverRecord| {
        let other = &prisms.cells[cover.cell as usize];
        // A single one covers all, or stands for several of one meaning that together do.
        if covers.len() == 1 || other.kind == CellRecord::AROUND {
            return own.to_vec();
        }
        clipped(own.to_vec(), &footprint(prisms, other))
    };
    covers.iter().map(share).collect()
}

/// What a convex polygon shares with another; both counter-clockwise.
pub(crate) fn clipped(mut polygon: Vec<DVec2>, by: &[DVec2]) -> Vec<DVec2> {
    for (i, &a) in by.iter().enumerate() {
        let b = by[(i + 1) % by.len()];
        polygon = cut(&polygon, |p| (b - a).perp_dot(p - a));
        if polygon.is_empty() {
            break;
        }
    }
    polygon
}

/// What of a convex polygon lies where a linear function is not negative.
pub(crate) fn cut(polygon: &[DVec2], over: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut left = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at, ahead) = (over(p), over(q));
        if at >= 0.0 {
            left.push(p);
        }
        if (at < 0.0) != (ahead < 0.0) && at != 0.0 && ahead != 0.0 {
            // From the same end for both neighbours.
            let (low, high, from, to) = if at < ahead { (at, ahead, p, q) } else { (ahead, at, q, p) };
            left.push(from + (to - from) * (low / (low - high)));
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, size: f64) -> Vec<DVec2> {
        [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
            .map(|(u, v)| DVec2::new(x + u * size, y + v * size))
            .to_vec()
    }

    #[test]
    fn polygons_share_what_lies_in_both() {
        let (one, other) = (square(0.0, 0.0, 2.0), square(1.0, -1.0, 2.0));
        assert_eq!(area(&one), 4.0);
        assert_eq!(area(&clipped(one.clone(), &other)), 1.0);
        assert_eq!(area(&clipped(one.clone(), &square(2.0, 0.0, 1.0))), 0.0);
        assert!(clipped(one.clone(), &square(5.0, 5.0, 1.0)).is_empty());
        let triangle = [DVec2::ZERO, DVec2::new(4.0, 0.0), DVec2::new(0.0, 4.0)];
        assert_eq!(area(&clipped(one, &triangle)), 4.0);
    }
}
