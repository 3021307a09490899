//! The planes behind faces, worked out when a scene is opened.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::NONE;
use super::walk::{Walk, each};
use crate::format::Views;
use crate::format::records::{SourceRecord, TriangleRecord};

/// A triangle holds a point well if its border is at least so far away, metres: more than a source's triangles are off their plane, two micrometres,
/// seen at a sine of [`GRAZING`](super::quick::GRAZING).
const WELL: f64 = 2e-4;

/// The plane of a source's triangles: `normal . p = offset`, internal frame, metres; zeros where they lie in none. And what they look like, and which of
/// two of them is where, so that for what meets it no triangle is read.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(crate) struct Plate {
    /// Unit length.
    pub(crate) normal: [f64; 3],
    /// Metres.
    pub(crate) offset: f64,
    /// The triangle in whose plane the others lie, or none.
    pub(crate) triangle: u32,
    /// Index of its element, or none.
    pub(crate) element: u32,
    /// Index of its material, or none.
    pub(crate) material: u32,
    /// The other one of two triangles with a common side, which lie on different sides of it; the same if there is one alone. None of other sources.
    other: u32,
    /// Which of the two is where: a direction in the plane, across the common side and towards `triangle`, unit length; and how far along it the common side is.
    across: [f32; 4],
}

impl Plate {
    /// That of a source's triangles.
    pub(crate) fn of(tables: &Views, source: &SourceRecord) -> Plate {
        let plate = plate_of(&tables.triangles, &tables.vertices, source.plane);
        if plate.triangle == NONE {
            return plate;
        }
        let TriangleRecord { element, material, .. } = tables.record(plate.triangle);
        let plate = Plate { element, material, ..plate };
        let first = source.first as usize;
        match *tables.surfaces.get(first..first + source.count as usize).unwrap_or(&[]) {
            [only] if only == plate.triangle => Plate { other: only, ..plate },
            [one, two] if one == plate.triangle => plate.with_two(tables, two),
            [one, two] if two == plate.triangle => plate.with_two(tables, one),
            _ => plate,
        }
    }

    /// That of a triangle of an element, by itself.
    #[cfg(feature = "render")]
    pub(super) fn alone(self, element: u32, material: u32) -> Plate {
        Plate { element, material, other: self.triangle, ..self }
    }

    /// With another triangle beside its own, if these have a side in common, and lie on different sides of it.
    fn with_two(self, tables: &Views, other: u32) -> Plate {
        let corners = |triangle: u32| {
            tables.triangles[triangle as usize].map(|v| DVec3::from(tables.vertices[v as usize]))
        };
        let (own, others) = (corners(self.triangle), corners(other));
        let Some(apex) = (0..3).find(|&i| !others.contains(&own[i])) else { return self };
        let (a, b) = (own[(apex + 1) % 3], own[(apex + 2) % 3]);
        let Some(far) = others.iter().find(|&&p| p != a && p != b) else { return self };
        if !(others.contains(&a) && others.contains(&b)) {
            return self;
        }
        let along = (b - a).normalize_or_zero();
        let across = DVec3::from(self.normal).cross(along);
        let across = if across.dot(own[apex] - a) < 0.0 { -across } else { across };
        let at = across.dot(a);
        let is_apart = across.dot(own[apex] - a) >= WELL && across.dot(*far - a) <= -WELL;
        if !is_apart {
            return self;
        }
        Plate { other, across: [across.x as f32, across.y as f32, across.z as f32, at as f32], ..self }
    }

    /// The triangle that holds a point of a plain face, if there are one or two, and it is in no doubt which: of the side that they have in common alone, as
    /// plain faces are covered.
    #[inline(always)]
    pub(super) fn told(&self, point: DVec3) -> Option<u32> {
        /// How far f32 may be off, times coordinates.
        const ROUNDED: f64 = 2.0 * f32::EPSILON as f64;
        if self.other == NONE {
            return None;
        }
        if self.other == self.triangle {
            return Some(self.triangle);
        }
        let [x, y, z, at] = self.across.map(f64::from);
        let over = x * point.x + y * point.y + z * point.z - at;
        let sure = WELL + ROUNDED * (point.x.abs() + point.y.abs() + point.z.abs() + at.abs());
        let triangle = if over > 0.0 { self.triangle } else { self.other };
        (over.abs() >= sure).then_some(triangle)
    }

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
            let corners = each(walk.corners(triangle), |p| [p[x] - point[x], p[y] - point[y]]);
            // How far within each side it is, times at most the side's size, and that.
            let sides = each([0, 1, 2], |side: usize| {
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

/// The plane of a triangle, and no more; zeros for none.
pub(crate) fn plate_of(triangles: &[[u32; 3]], vertices: &[[f64; 3]], triangle: u32) -> Plate {
    let Some(corners) = triangles.get(triangle as usize) else {
        return Plate { triangle: NONE, element: NONE, material: NONE, other: NONE, ..Plate::zeroed() };
    };
    let [a, b, c] = corners.map(|v| DVec3::from(vertices[v as usize]));
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let (normal, offset) = (normal.to_array(), normal.dot(a));
    Plate { normal, offset, triangle, element: NONE, material: NONE, other: NONE, across: [0.0; 4] }
}
