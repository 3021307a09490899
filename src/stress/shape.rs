//! Closed shapes, and models of them.

use enfilade_importers::{Frame, ImportError, Material, Model, ModelBuilder, NewElement, Semantic};

/// The corners of a triangle.
pub(crate) type Corners = [[f64; 3]; 3];

/// A pile of triangles.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape(pub(crate) Vec<Corners>);

impl Shape {
    /// A box, wound outwards.
    pub(crate) fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Shape {
        let v = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut shape = Shape::default();
        for corners in quads {
            shape.quad(corners.map(v));
        }
        shape
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

    /// Two triangles; corners counter-clockwise seen from the front.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [[f64; 3]; 4]) {
        self.0.push([a, b, c]);
        self.0.push([a, c, d]);
    }

    /// The same with every corner elsewhere.
    pub(crate) fn map(mut self, place: impl Fn([f64; 3]) -> [f64; 3]) -> Shape {
        for p in self.0.iter_mut().flatten() {
            *p = place(*p);
        }
        self
    }

    /// The same elsewhere.
    #[cfg(test)]
    pub(crate) fn moved(self, by: [f64; 3]) -> Shape {
        self.map(|p| [0, 1, 2].map(|i| p[i] + by[i]))
    }
}

/// A model of one element a shape.
///
/// # Errors
/// Those of the builder: coordinates that are no numbers, too many triangles.
pub(crate) fn model(shapes: &[(Semantic, Shape)]) -> Result<Model, ImportError> {
    let mut builder = ModelBuilder::new("shapes", Frame::default());
    let material = builder.material(Material::default());
    for (index, (semantic, shape)) in shapes.iter().enumerate() {
        let new = NewElement { name: format!("{index}"), ..NewElement::default() };
        let element = builder.element(new)?;
        builder.semantic(element, *semantic);
        for corners in &shape.0 {
            builder.triangle(element, *corners, material)?;
        }
    }
    builder.finish()
}
