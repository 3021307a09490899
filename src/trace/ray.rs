//! Rays in, answers out: plain arrays of numbers, ready for the caller's own buffers.

use bytemuck::{Pod, Zeroable};

/// No element, no room, no material, no cell: the index that stands for none in [`Hit`]. As a signed number: -1.
pub const NONE: u32 = u32::MAX;

/// A ray, or a segment of one, in the scene's internal frame (metres, Z up, offset taken off).
///
/// Points are `origin + t * d`, where `d` is `direction` normalised: the direction need not have unit length, and
/// `t`, `tmin` and `tmax` count metres. Only `tmin <= t <= tmax` counts. A ray whose numbers are not finite (`tmax`
/// may be infinite) or whose direction is zero meets nothing.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: [f64; 3],
    /// Least `t`, metres, at least 0.
    pub tmin: f64,
    /// Where it goes; any length but zero.
    pub direction: [f64; 3],
    /// Greatest `t`, metres; infinite for a whole ray.
    pub tmax: f64,
}

impl Ray {
    /// A whole ray.
    pub const fn new(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray { origin, tmin: 0.0, direction, tmax: f64::INFINITY }
    }

    /// The part of the ray between `tmin` and `tmax`, metres.
    pub const fn segment(origin: [f64; 3], direction: [f64; 3], tmin: f64, tmax: f64) -> Ray {
        Ray { origin, tmin, direction, tmax }
    }

    /// Whether the ray's numbers make it one: finite, a direction, `tmax` not NaN.
    pub fn is_valid(&self) -> bool {
        self.origin.iter().chain(&self.direction).all(|c| c.is_finite())
            && self.direction != [0.0; 3]
            && self.tmin.is_finite()
            && !self.tmax.is_nan()
    }
}

/// An answer in brief: how far, and what. [`Scene::hit`](crate::Scene::hit) tells the rest.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Brief {
    /// Distance along the normalised direction, metres; infinite for a ray that escaped, NaN for one that starts in a solid.
    pub t: f64,
    /// Index of a triangle in whose plane the hit lies, of the element and the material that was met; or [`NONE`].
    pub triangle: u32,
    /// Index of the cell in which the ray ended, 0 where it was not followed from cell to cell ([`Scene::hit`](crate::Scene::hit) finds it), or [`NONE`].
    pub cell: u32,
}

impl Brief {
    /// Of a ray that left through the hull.
    pub const ESCAPED: Brief = Brief { t: f64::INFINITY, triangle: NONE, cell: NONE };
}

/// Where a ray met the building.
///
/// As a record in a buffer it also stands for the other two answers, see [`Hit::ESCAPED`] and [`Hit::in_solid`].
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Hit {
    /// Distance along the normalised direction, metres, from the source's own triangle in f64.
    pub t: f64,
    /// The point, metres.
    pub point: [f64; 3],
    /// Geometric normal of the triangle, unit length, on the side from which the ray came.
    pub normal: [f64; 3],
    /// Index of the element.
    pub element: u32,
    /// Number of the element's [`Semantic`](enfilade_importers::Semantic) (under 64), or with [`Want::face`](super::Want::face) of the
    /// kind of the face (from 64), where the triangle is part of the surface of the cell in which the ray ended.
    pub semantic: u32,
    /// Index of the material.
    pub material: u32,
    /// Index of the cell in which the ray ended.
    pub cell: u32,
    /// Index of the room in which the ray ended, or [`NONE`].
    pub room: u32,
    /// Index of the triangle among the scene's detail triangles, or after all of the file's of a sheet that closes an opening
    /// ([`Scene::closed_by`](crate::Scene::closed_by)); or [`NONE`]. Without [`Want::triangle`](super::Want::triangle) it may be another in
    /// its plane.
    pub triangle: u32,
}

impl Hit {
    /// The record of a ray that left through the hull: `t` infinite, no element.
    pub const ESCAPED: Hit = Hit {
        t: f64::INFINITY,
        point: [f64::NAN; 3],
        normal: [0.0; 3],
        element: NONE,
        semantic: 0,
        material: NONE,
        cell: NONE,
        room: NONE,
        triangle: NONE,
    };

    /// The record of a ray that starts inside the solid `element`: `t` is NaN.
    pub const fn in_solid(element: u32, semantic: u32) -> Hit {
        Hit { t: f64::NAN, element, semantic, ..Hit::ESCAPED }
    }

    /// Which of the three answers the record stands for.
    pub fn answer(&self) -> Answer {
        if self.t.is_nan() {
            Answer::InSolid(self.element)
        } else if self.element == NONE {
            Answer::Escaped
        } else {
            Answer::Hit(*self)
        }
    }
}

/// The answer to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// It met an element.
    Hit(Hit),
    /// It left the hull, or its segment ended in the air.
    Escaped,
    /// It starts inside this solid element.
    InSolid(u32),
}

impl Answer {
    /// The answer as a record.
    pub fn record(&self) -> Hit {
        match *self {
            Answer::Hit(hit) => hit,
            Answer::Escaped => Hit::ESCAPED,
            Answer::InSolid(element) => Hit::in_solid(element, 0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_stand_for_answers() {
        assert_eq!(Hit::ESCAPED.answer(), Answer::Escaped);
        assert_eq!(Hit::in_solid(7, 16).answer(), Answer::InSolid(7));
        let hit = Hit { t: 1.0, element: 3, ..Hit::ESCAPED };
        assert!(matches!(hit.answer(), Answer::Hit(h) if h.element == 3));
        assert!(!Ray::new([0.0; 3], [0.0; 3]).is_valid());
        assert!(!Ray::new([f64::NAN; 3], [0.0, 0.0, 1.0]).is_valid());
    }
}
