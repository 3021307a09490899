//! Where what stands in a cell comes to an end at the cell's planes: these are rounded, so that rays tell what pixels there show.

use glam::{DMat3, DVec3};

use super::kernels::{Bound, up};
use super::screen::Plane;

/// What rounding may do to where a corner is in the picture, pixels.
pub(super) const ROUNDED: f64 = 1e-6;

/// The planes through which rays leave a cell.
#[derive(Clone, Copy)]
pub(crate) struct Exits<'e>(pub(crate) &'e [Plane]);

impl Exits<'_> {
    /// None.
    pub(crate) const NONE: Exits<'static> = Exits(&[]);
}

/// How far outside of a plane the nearest and the farthest of some corners are, in the camera's coordinates: metres times the length of the plane's normal.
#[inline(always)]
pub(super) fn outside(plane: &Plane, corners: &[DVec3]) -> [f64; 2] {
    let each = corners.iter().map(|&corner| beyond(plane, corner));
    each.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], of| [least.min(of), most.max(of)])
}

#[inline(always)]
fn beyond(plane: &Plane, corner: DVec3) -> f64 {
    plane.away + DVec3::from(plane.grows).dot(corner)
}

/// Where in a picture a polygon is no farther from a plane than that is off.
pub(super) struct Cut {
    /// The rows that it may reach.
    pub(super) rows: [i32; 2],
    /// Were the plane so much farther out, the polygon would not end before; and farther in, it would.
    bounds: [Bound; 2],
}

/// A polygon in the camera's coordinates.
pub(super) struct Cutting<'c> {
    pub(super) corners: &'c [DVec3],
    /// How its `1 / t` grows.
    pub(super) near: DVec3,
    /// Whether all of it is in front of the eye.
    pub(super) is_before: bool,
    /// The rows that it may reach.
    pub(super) rows: [i32; 2],
    /// Turns what is along the world's axes to these coordinates.
    pub(super) camera: &'c DMat3,
}

impl Cutting<'_> {
    /// Where it comes to an end, sooner or later, at a plane that may be off, and of which its corners are as far outside as [`outside`] says.
    pub(super) fn at(&self, exit: &Plane, [least, most]: [f64; 2]) -> Option<Cut> {
        let reach = exit.off.faces * exit.size;
        if most <= -reach || least >= reach {
            return None;
        }
        let grows = DVec3::from(exit.grows);
        // What hardly leans to the plane, and does not come to it from farther within, is on a wall that is in this plane: it ends where that does.
        if least >= -reach && is_along([self.near, grows].map(|grows| self.camera.transpose() * grows)) {
            return None;
        }
        let mut rows = if self.is_before { self.rows_within(exit, reach) } else { self.rows };
        if rows[0] >= rows[1] {
            return None;
        }
        // Where the polygon is outside of the plane, were that so much farther in.
        let beyond = |by: f64| self.near * (exit.away + by) + grows;
        let bounds = [Bound::new(-beyond(-reach), &mut rows), Bound::new(beyond(reach), &mut rows)];
        (rows[0] < rows[1]).then_some(Cut { rows, bounds })
    }

    /// The rows that hold those points of it that are no farther from a plane than this; all of its corners are before the eye.
    fn rows_within(&self, exit: &Plane, reach: f64) -> [i32; 2] {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut add = |corner: DVec3| {
            let row = corner.y / corner.z;
            (least, most) = (least.min(row), most.max(row));
        };
        for (i, &a) in self.corners.iter().enumerate() {
            let b = self.corners[if i + 1 < self.corners.len() { i + 1 } else { 0 }];
            let [from, to] = [a, b].map(|corner| beyond(exit, corner));
            if from.abs() <= reach {
                add(a);
            }
            for end in [-reach, reach] {
                if (from < end) != (to < end) {
                    add(a + (b - a) * ((end - from) / (to - from)));
                }
            }
        }
        [self.rows[0].max(up(least - ROUNDED)), self.rows[1].min(up(most + ROUNDED))]
    }
}

/// Whether two planes meet at a small angle, if at all: by their normals.
fn is_along(normals: [DVec3; 2]) -> bool {
    /// The cosine of 30 degrees.
    const ALONG: f64 = 0.866;
    let [one, other] = normals.map(DVec3::normalize_or_zero);
    one.dot(other).abs() >= ALONG
}

impl Cut {
    /// From which column of a row up to which it is, of those from one up to another: within the bounds of the polygon, and within the planes of all cuts of it.
    pub(super) fn part(&self, row: i32, columns: [i32; 2], (sides, all): (&[Bound], &[Cut])) -> [i32; 2] {
        let columns = self.bounds.iter().fold(columns, |part, bound| bound.within(part, row));
        // Hardly ever there is any pixel.
        if columns[0] >= columns[1] {
            return columns;
        }
        let all = all.iter().map(|cut| &cut.bounds[0]);
        sides.iter().chain(all).fold(columns, |part, side| side.within(part, row))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::screen::Off;
    use super::*;

    const SIZE: i32 = 48;

    proptest! {
        /// Of the pixels that show a triangle, a cut has those, and in its rows no others, whose rays meet it no farther from the plane than that is off.
        #[test]
        fn a_cut_is_where_the_plane_may_be(
            corners in prop::array::uniform3((-20.0f64..70.0, -20.0f64..70.0, 1.0f64..9.0)),
            normal in [-1.0f64..1.0, -1.0f64..1.0, -20.0f64..20.0],
            away in 0.5f64..90.0,
            off in 0.01f64..9.0,
        ) {
            // The camera's coordinates are those of the world.
            let corners = corners.map(|(x, y, z)| DVec3::new(x * z, y * z, z));
            let size = DVec3::from(normal).length();
            let plane = Plane { size, grows: normal, away: -away, off: Off { at_edges: 0.0, faces: off } };
            let sides = [0, 1, 2].map(|i| corners[i].cross(corners[(i + 1) % 3]));
            let all: DVec3 = sides.into_iter().sum();
            let size = corners[0].dot(all);
            prop_assume!(size.abs() > 1e-3 && plane.size > 1e-3);
            let (near, mut rows) = (all / size, [0, SIZE]);
            let sides = sides.map(|side| side * size.signum());
            let bounds = sides.map(|side| Bound::new(side, &mut rows));
            let ends = outside(&plane, &corners);
            let camera = &DMat3::IDENTITY;
            let polygon = Cutting { corners: &corners, near, is_before: true, rows, camera };
            let cut = polygon.at(&plane, ends);
            let lies_along = is_along([near, DVec3::from(normal)]) && ends[0] >= -off * plane.size;
            prop_assume!(!lies_along);
            for row in 0..SIZE {
                let is_of_rows = |cut: &&Cut| (cut.rows[0]..cut.rows[1]).contains(&row);
                let [from, to] =
                    cut.as_ref().filter(is_of_rows).map_or([0, 0], |cut| cut.part(row, [0, SIZE], (&bounds, &[])));
                for column in 0..SIZE {
                    let ray = DVec3::new(f64::from(column), f64::from(row), 1.0);
                    let t = 1.0 / near.dot(ray);
                    let outside = (t * DVec3::from(normal).dot(ray) - away) / plane.size;
                    // How far inside of what is a cut this pixel is.
                    let inside = sides.iter().map(|side| side.dot(ray)).fold(off - outside.abs(), f64::min);
                    if inside.abs() > 1e-6 {
                        prop_assert_eq!((from..to).contains(&column), inside > 0.0, "{} {} {}", column, row, inside);
                    }
                }
            }
        }
    }
}
