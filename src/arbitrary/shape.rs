//! Closed solids of a few faces, in a box from the origin.

/// Triangles, counter-clockwise seen from outside.
pub type Mesh = Vec<[[f64; 3]; 3]>;

/// What a solid looks like, in a box from the origin: its width along x, depth along y, height along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// All of the box.
    Box,
    /// A prism over an L.
    L,
    /// A prism over a U.
    U,
    /// A prism over a triangle.
    Triangle,
    /// An L whose extrusion runs along y.
    LyingL,
    /// A U whose extrusion runs along y.
    LyingU,
    /// A roof: a lying triangle.
    Gable,
    /// A box under a lean-to.
    Wedge,
    /// A box whose top is shifted by half its width.
    Sheared,
    /// Three corners below, one above.
    Tetrahedron,
    /// Four corners below, one above their middle.
    Pyramid,
    /// A box whose top is shifted by so many metres: nearly vertical sides.
    Steep(f64),
    /// A roof whose gables lean by so many metres.
    SteepGable(f64),
    /// A box whose top rises by so many metres.
    Tilted(f64),
    /// A board of this thickness across an axis.
    Plate(f64, usize),
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const L: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.4, 0.3], [0.4, 1.0], [0.0, 1.0]];
const U: [[f64; 2]; 8] =
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.7, 1.0], [0.7, 0.25], [0.2, 0.25], [0.2, 1.0], [0.0, 1.0]];
const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.4, 1.0]];

impl Shape {
    /// Whether it has faces that are neither level nor vertical.
    pub fn is_sloped(self) -> bool {
        use Shape::{Gable, Pyramid, Sheared, Tetrahedron, Wedge};
        matches!(self, Gable | Wedge | Sheared | Tetrahedron | Pyramid)
    }

    /// The solid in the box from the origin to `size`.
    pub fn mesh(self, size: [f64; 3]) -> Mesh {
        let [w, d, h] = size;
        match self {
            Shape::Box => loft(&SQUARE, size, |[x, y]| [x, y, h]),
            Shape::L => loft(&L, size, |[x, y]| [x, y, h]),
            Shape::U => loft(&U, size, |[x, y]| [x, y, h]),
            Shape::Triangle => loft(&TRIANGLE, size, |[x, y]| [x, y, h]),
            Shape::LyingL => lay(loft(&L, [w, h, d], |[x, y]| [x, y, d]), d),
            Shape::LyingU => lay(loft(&U, [w, h, d], |[x, y]| [x, y, d]), d),
            Shape::Gable => lay(loft(&TRIANGLE, [w, h, d], |[x, y]| [x, y, d]), d),
            Shape::Wedge => loft(&SQUARE, size, |[x, y]| [x, y, h * (0.4 + 0.6 * x / w)]),
            Shape::Sheared => loft(&SQUARE, [w / 1.5, d, h], |[x, y]| [x + w / 3.0, y, h]),
            Shape::Tetrahedron => {
                let [a, b, c, t] = [[0.0; 3], [w, 0.0, 0.0], [0.3 * w, d, 0.0], [0.4 * w, 0.3 * d, h]];
                vec![[a, c, b], [a, b, t], [b, c, t], [c, a, t]]
            }
            Shape::Pyramid => {
                let corners = SQUARE.map(|[x, y]| [x * w, y * d, 0.0]);
                let top = [w / 2.0, d / 2.0, h];
                let mut mesh: Mesh = (0..4).map(|i| [corners[i], corners[(i + 1) % 4], top]).collect();
                mesh.extend([[corners[0], corners[2], corners[1]], [corners[0], corners[3], corners[2]]]);
                mesh
            }
            Shape::Steep(run) => loft(&SQUARE, size, |[x, y]| [x + run, y, h]),
            Shape::SteepGable(run) => lay(loft(&TRIANGLE, [w, h, d], |[x, y]| [x, y, d + run * y / h]), d),
            Shape::Tilted(rise) => loft(&SQUARE, size, |[x, y]| [x, y, h + rise * x / w]),
            Shape::Plate(thickness, axis) => {
                let size = [0, 1, 2].map(|i| if i == axis { thickness } else { size[i] });
                loft(&SQUARE, size, |[x, y]| [x, y, size[2]])
            }
        }
    }
}

/// A solid between an outline at height 0 and where `top` puts its corners.
fn loft(outline: &[[f64; 2]], size: [f64; 3], top: impl Fn([f64; 2]) -> [f64; 3]) -> Mesh {
    let low: Vec<[f64; 3]> = outline.iter().map(|[x, y]| [x * size[0], y * size[1], 0.0]).collect();
    let high: Vec<[f64; 3]> = low.iter().map(|p| top([p[0], p[1]])).collect();
    let mut mesh = Mesh::new();
    for [a, b, c] in ears(outline) {
        mesh.push([low[a], low[c], low[b]]);
        mesh.push([high[a], high[b], high[c]]);
    }
    for i in 0..low.len() {
        let j = (i + 1) % low.len();
        mesh.extend([[low[i], low[j], high[j]], [low[i], high[j], high[i]]]);
    }
    mesh
}

/// What stood along z lies along y; what was along y stands.
fn lay(mesh: Mesh, depth: f64) -> Mesh {
    mesh.into_iter().map(|t| t.map(|[x, y, z]| [x, depth - z, y])).collect()
}

/// A counter-clockwise outline cut into triangles.
fn ears(outline: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let side = |a: usize, b: usize, c: usize| {
        let [p, q, r] = [a, b, c].map(|i| outline[i]);
        (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
    };
    let mut left: Vec<usize> = (0..outline.len()).collect();
    let mut triangles = Vec::new();
    while left.len() > 3 {
        let n = left.len();
        let ear = (0..n).find(|&i| {
            let [a, b, c] = [left[i], left[(i + 1) % n], left[(i + 2) % n]];
            let holds = |p: usize| side(a, b, p) >= 0.0 && side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0;
            side(a, b, c) > 0.0 && left.iter().all(|&p| [a, b, c].contains(&p) || !holds(p))
        });
        let i = ear.expect("every outline has an ear");
        triangles.push([left[i], left[(i + 1) % n], left[(i + 2) % n]]);
        left.remove((i + 1) % n);
    }
    triangles.push([left[0], left[1], left[2]]);
    triangles
}
