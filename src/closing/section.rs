//! Planes through cells: the convex polygon that a plane shares with a prism.

use glam::{DVec2, DVec3};

use crate::clip::keep_below;
use crate::format::records::CellRecord;
use crate::graph::{cut, footprint};
use crate::trace::Prisms;

/// What is not beyond a plane: `normal . p <= offset`, metres along the lattice's axes from its origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfSpace {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
}

impl HalfSpace {
    /// How far a point is beyond.
    pub(super) fn over(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }
}

/// The planes of a prism: floor, ceiling, sides.
pub(super) fn half_spaces(prisms: &Prisms<'_>, cell: &CellRecord) -> Vec<HalfSpace> {
    let flat = |plane: u32, up: f64| {
        let at = |p: DVec2| p.extend(prisms.height(plane, p));
        let [o, x, y] = [DVec2::ZERO, DVec2::X, DVec2::Y].map(at);
        let normal = (x - o).cross(y - o).normalize() * up;
        HalfSpace { normal, offset: normal.dot(o) }
    };
    let corners = footprint(prisms, cell);
    let upright = (0..corners.len()).filter_map(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        let normal = DVec3::new(b.y - a.y, a.x - b.x, 0.0).try_normalize()?;
        Some(HalfSpace { normal, offset: normal.dot(a.extend(0.0)) })
    });
    [flat(cell.floor, -1.0), flat(cell.ceiling, 1.0)].into_iter().chain(upright).collect()
}

/// A plane `normal . p = depth` with two axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) normal: DVec3,
    pub(super) depth: f64,
    axes: [DVec3; 2],
}

impl Plane {
    pub(super) fn new(normal: DVec3, depth: f64) -> Plane {
        let (mut across, mut up) = normal.any_orthonormal_pair();
        if normal.z.abs() < 0.99 {
            across = DVec3::Z.cross(normal).normalize();
            up = normal.cross(across);
        }
        Plane { normal, depth, axes: [across, up] }
    }

    /// Whether another is the same plane, to a micrometre.
    pub(super) fn is_that_of(&self, other: &Plane) -> bool {
        let turned = self.normal.dot(other.normal);
        turned.abs() > 1.0 - 1e-9 && (self.depth - turned.signum() * other.depth).abs() < 1e-6
    }

    pub(super) fn at(&self, point: DVec2) -> DVec3 {
        self.normal * self.depth + self.axes[0] * point.x + self.axes[1] * point.y
    }

    pub(super) fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.axes[0]), point.dot(self.axes[1]))
    }

    /// What of a convex polygon of this plane lies in all half-spaces.
    pub(super) fn within(
        &self,
        mut polygon: Vec<DVec2>,
        spaces: impl IntoIterator<Item = HalfSpace>,
    ) -> Vec<DVec2> {
        for space in spaces {
            polygon = cut(&polygon, |p| -space.over(self.at(p)));
            if polygon.is_empty() {
                break;
            }
        }
        polygon
    }
}

/// Where a plane crosses the polygon of a part of a surface: the two ends.
pub(super) fn crossing(corners: &[DVec3], plane: &Plane) -> Option<[DVec3; 2]> {
    let mut ends = [DVec3::ZERO; 2];
    let mut count = 0;
    for (i, &p) in corners.iter().enumerate() {
        let q = corners[(i + 1) % corners.len()];
        let (here, there) = (plane.normal.dot(p) - plane.depth, plane.normal.dot(q) - plane.depth);
        if (here < 0.0) != (there < 0.0) && count < 2 {
            ends[count] = p + (q - p) * (here / (here - there));
            count += 1;
        }
    }
    (count == 2).then_some(ends)
}

/// Whether a triangle comes into a prism whose planes are moved outward by `margin`; it may say so at sharp corners, too.
pub(super) fn touches(spaces: &[HalfSpace], corners: [DVec3; 3], margin: f64) -> bool {
    let (mut polygon, mut next) = (corners.to_vec(), Vec::new());
    spaces.iter().all(|space| keep_below(&mut polygon, &mut next, space.normal, space.offset + margin))
}
