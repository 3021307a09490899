//! Shapes for the tests of this folder and of `verify`.

use enfilade_importers::{ElementId, Model, Role, Semantic};

pub(crate) use crate::stress::shape::Shape;

impl Shape {
    /// The same, inside out.
    pub(crate) fn flipped(mut self) -> Shape {
        self.0.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// The same with triangle `index` turned over.
    pub(crate) fn with_flipped(mut self, index: usize) -> Shape {
        self.0[index].swap(1, 2);
        self
    }

    /// Both.
    pub(crate) fn and(mut self, other: Shape) -> Shape {
        self.0.extend(other.0);
        self
    }
}

/// A model of one element a shape.
pub(crate) fn model(shapes: &[(Semantic, Shape)]) -> Model {
    crate::stress::shape::model(shapes).unwrap()
}

/// The roles that the tags give; solid without a tag.
pub(crate) fn role_of(model: &Model) -> impl Fn(ElementId) -> Role + '_ {
    |e| model.elements[e.0 as usize].semantic.role().unwrap_or(Role::Solid)
}

/// Two rooms of 4 x 3 x 2.5 m side by side, with a doorway between them: floor, ceiling, walls whose corners meet
/// at T-junctions, a table, and the labels of the rooms and of the doorway.
pub(crate) fn house() -> Model {
    let wall = |lo, hi| (Semantic::Wall, Shape::cuboid(lo, hi));
    model(&[
        (Semantic::Ground, Shape::cuboid([-0.2, -0.2, -0.3], [8.4, 3.2, 0.0])),
        (Semantic::Ceiling, Shape::cuboid([-0.2, -0.2, 2.5], [8.4, 3.2, 2.8])),
        wall([-0.2, -0.2, 0.0], [0.0, 3.2, 2.5]),
        wall([8.2, -0.2, 0.0], [8.4, 3.2, 2.5]),
        wall([0.0, -0.2, 0.0], [8.2, 0.0, 2.5]),
        wall([0.0, 3.0, 0.0], [8.2, 3.2, 2.5]),
        wall([4.0, 0.0, 0.0], [4.2, 1.0, 2.5]),
        wall([4.0, 1.9, 0.0], [4.2, 3.0, 2.5]),
        wall([4.0, 1.0, 2.1], [4.2, 1.9, 2.5]),
        (Semantic::Furniture, Shape::prism(24, 0.4, 0.7, 0.75).moved([2.0, 1.5, 0.0])),
        (Semantic::Furniture, Shape::prism(7, 0.05, 0.0, 0.7).moved([2.0, 1.5, 0.0])),
        (Semantic::Room, Shape::cuboid([0.0, 0.0, 0.0], [4.0, 3.0, 2.5])),
        (Semantic::Room, Shape::cuboid([4.2, 0.0, 0.0], [8.2, 3.0, 2.5])),
        (Semantic::Door, Shape::cuboid([4.0, 1.0, 0.0], [4.2, 1.9, 2.1])),
    ])
}
