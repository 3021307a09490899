//! The participating triangles, flat.

use enfilade_importers::{ElementId, Model, Role};

use super::triangle::{self, Corners, Line, Size};
use super::vector::Bounds;
use crate::trace::Ray;

/// A hit of the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Metres along the normalised direction.
    pub t: f64,
    /// The element.
    pub element: ElementId,
    /// The triangle's index in the element's mesh.
    pub triangle: u32,
}

/// All triangles that a ray can hit, in the order of elements and of triangles within them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Soup {
    pub(crate) corners: Vec<Corners>,
    pub(crate) sizes: Vec<Size>,
    /// The first triangle of each element of the model, and the end.
    pub(crate) first: Vec<u32>,
    pub(crate) bounds: Option<Bounds>,
}

/// The best hit so far: by `t`, then by the triangle's number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Best {
    pub(crate) t: f64,
    pub(crate) index: u32,
}

impl Best {
    pub(crate) const NONE: Best = Best { t: f64::INFINITY, index: u32::MAX };

    pub(crate) fn offer(&mut self, t: f64, index: u32) {
        if t < self.t || (t == self.t && index < self.index) {
            *self = Best { t, index };
        }
    }
}

impl Soup {
    pub(crate) fn new(model: &Model, role: impl Fn(ElementId) -> Role) -> Soup {
        let mut soup = Soup::default();
        let mut bounds = Bounds::EMPTY;
        for (index, element) in model.elements.iter().enumerate() {
            soup.first.push(soup.corners.len() as u32);
            if !participates(role(ElementId(index as u32))) {
                continue;
            }
            for triangle in 0..element.mesh.triangles.len() {
                let corners = element.mesh.corners(triangle);
                bounds = bounds.union(Bounds::of(&corners));
                soup.sizes.push(Size::of(&corners));
                soup.corners.push(corners);
            }
        }
        soup.first.push(soup.corners.len() as u32);
        soup.bounds = (!bounds.is_empty()).then_some(bounds);
        soup
    }

    pub(crate) fn len(&self) -> usize {
        self.corners.len()
    }

    /// `t` where the line pierces triangle `index`.
    pub(crate) fn pierce(&self, line: &Line, index: u32) -> Option<f64> {
        let i = index as usize;
        triangle::pierce(line, &self.corners[i], self.sizes[i])
    }

    /// [`Soup::pierce`], within the ray's own `tmin` and `tmax`.
    pub(crate) fn hit(&self, line: &Line, ray: &Ray, index: u32) -> Option<f64> {
        self.pierce(line, index).filter(|t| (first_t(ray)..=ray.tmax).contains(t))
    }

    pub(crate) fn element(&self, index: u32) -> ElementId {
        ElementId(self.first.partition_point(|&first| first <= index) as u32 - 1)
    }

    pub(crate) fn nearest(&self, best: Best) -> Option<Nearest> {
        (best.index != u32::MAX).then(|| self.at(best.index, best.t))
    }

    /// Triangle `index` as met at `t`.
    pub(crate) fn at(&self, index: u32, t: f64) -> Nearest {
        let element = self.element(index);
        Nearest { t, element, triangle: index - self.first[element.0 as usize] }
    }
}

/// The least `t` that counts.
pub(crate) fn first_t(ray: &Ray) -> f64 {
    ray.tmin.max(0.0)
}

/// Whether rays see an element of this role.
pub(crate) fn participates(role: Role) -> bool {
    matches!(role, Role::Solid | Role::Detail)
}
