//! Shapes for the tests of this folder and of `verify`.

use enfilade_importers::{ElementId, Frame, Material, Model, ModelBuilder, NewElement, Role, Semantic};

use super::triangle::Corners;

/// A pile of triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape(pub(crate) Vec<Corners>);

impl Shape {
    /// A box, wound outwards.
    pub(crate) fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Shape {
        let v = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut shape = Shape::default();
        for [a, b, c, d] in quads {
            shape.0.push([v(a), v(b), v(c)]);
            shape.0.push([v(a), v(c), v(d)]);
        }
        shape
    }

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

    /// A closed tube of `sides` sides around the z axis, wound outwards.
    pub(crate) fn prism(sides: usize, radius: f64, low: f64, high: f64) -> Shape {
        let at = |i: usize, z: f64| {
            let angle = std::f64::consts::TAU * (i % sides) as f64 / sides as f64;
            [radius * angle.cos(), radius * angle.sin(), z]
        };
        let mut shape = Shape::default();
        for i in 0..sides {
            let (a, b, c, d) = (at(i, low), at(i + 1, low), at(i + 1, high), at(i, high));
            shape.0.extend([[a, b, c], [a, c, d], [[0.0, 0.0, low], b, a], [[0.0, 0.0, high], d, c]]);
        }
        shape
    }
}

/// A model of one element a shape.
pub(crate) fn model(shapes: &[(Semantic, Shape)]) -> Model {
    let mut builder = ModelBuilder::new("test", Frame::default());
    let material = builder.material(Material::default());
    for (index, (semantic, shape)) in shapes.iter().enumerate() {
        let new = NewElement { name: format!("{index}"), ..NewElement::default() };
        let element = builder.element(new).unwrap();
        builder.semantic(element, *semantic);
        for corners in &shape.0 {
            builder.triangle(element, *corners, material).unwrap();
        }
    }
    builder.finish().unwrap()
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

impl Shape {
    /// The same elsewhere.
    pub(crate) fn moved(mut self, by: [f64; 3]) -> Shape {
        for p in self.0.iter_mut().flatten() {
            *p = super::vector::add(*p, by);
        }
        self
    }
}
