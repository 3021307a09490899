//! Small random models, degenerate on purpose.

use std::collections::BTreeSet;

use enfilade_importers::{Frame, Material, Model, ModelBuilder, NewElement, Semantic};
use proptest::prelude::*;

use super::shape::{Mesh, Shape};

/// Some elements, and how they stand to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// The elements, in order; some stand for two.
    pub pieces: Vec<Piece>,
    /// Sizes and distances are multiplied by this; gaps are not.
    pub scale: f64,
    /// Where the origin lies, metres.
    pub at: [f64; 3],
}

/// An element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Its meaning.
    pub semantic: Semantic,
    /// Its form.
    pub shape: Shape,
    /// The size of its box, metres before scaling.
    pub size: [f64; 3],
    /// Where it stands, metres before scaling, unless beside another.
    pub at: [f64; 3],
    /// Degrees about the vertical, and about the x axis before that; unless beside another.
    pub turn: [f64; 2],
    /// How it stands to that other.
    pub relation: Relation,
    /// Beside which other it stands: counted back from itself, round and round.
    pub other: usize,
    /// Along which axis, 0 to 2.
    pub axis: usize,
    /// What is odd about it.
    pub defect: Defect,
}

/// How an element stands to another, in that other's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Relation {
    /// Not at all.
    Free,
    /// The boxes touch by a whole face.
    Face,
    /// By an edge.
    Edge,
    /// By a corner.
    Vertex,
    /// By a part of a face: edges of one end inside a face of the other.
    TJunction,
    /// By an eighth, if both are alike.
    Overlap,
    /// It lies inside.
    Nested,
    /// It lies inside, with a face in the other's.
    NestedFace,
    /// It is the same once more.
    Twin,
    /// So many metres apart; they overlap if that is less than nothing.
    Gap(f64),
    /// It stands free, and a twin beside it is higher by so many metres and steeper by this share.
    Coplanar(f64, f64),
}

/// What is odd about a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Defect {
    /// Nothing.
    None,
    /// All triangles are turned.
    Inverted,
    /// Triangles whose bit is set are turned.
    Mixed(u32),
    /// A smaller copy of itself is left out inside.
    Cavity,
    /// It is there twice, side by side.
    TwoComponents,
}

/// How many classes [`Assembly::classes`] tells apart.
pub const CLASSES: usize = 30;

/// How local coordinates become the building's.
#[derive(Clone, Copy)]
struct Pose {
    at: [f64; 3],
    turn: [f64; 2],
}

impl Pose {
    fn apply(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [(sy, cy), (sp, cp)] = self.turn.map(sine_cosine);
        let (y, z) = (y * cp - z * sp, y * sp + z * cp);
        let (x, y) = (x * cy - y * sy, x * sy + y * cy);
        [x + self.at[0], y + self.at[1], z + self.at[2]]
    }
}

/// Exact at multiples of a right angle.
fn sine_cosine(degrees: f64) -> (f64, f64) {
    match degrees {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    }
}

impl Assembly {
    /// The elements' meaning and triangles.
    pub fn elements(&self) -> Vec<(Semantic, Mesh)> {
        let mut elements = Vec::new();
        let mut placed: Vec<(Pose, [f64; 3], [f64; 3], Shape)> = Vec::new();
        for (i, piece) in self.pieces.iter().enumerate() {
            let size = piece.size.map(|c| c * self.scale);
            let free = Pose { at: piece.at.map(|c| c * self.scale), turn: piece.turn };
            let (pose, low, size, shape) = match piece.relation {
                Relation::Free | Relation::Coplanar(..) => (free, [0.0; 3], size, piece.shape),
                _ if i == 0 => (free, [0.0; 3], size, piece.shape),
                relation => {
                    let (pose, low, other, shape) = placed[i - 1 - piece.other % i];
                    let (low, size) = beside(relation, piece.axis, low, other, size);
                    (pose, low, size, if relation == Relation::Twin { shape } else { piece.shape })
                }
            };
            placed.push((pose, low, size, shape));
            let in_place = |mesh: Mesh, low: [f64; 3]| -> Mesh {
                let move_point = |p: [f64; 3]| {
                    let p = pose.apply([0, 1, 2].map(|k| p[k] + low[k]));
                    [0, 1, 2].map(|k| p[k] + self.at[k])
                };
                mesh.into_iter().map(|t| t.map(move_point)).collect()
            };
            let mesh = piece.defect.of(shape.mesh(size), size);
            elements.push((piece.semantic, in_place(mesh, low)));
            if let Relation::Coplanar(by, share) = piece.relation {
                let steeper = [size[0], size[1], size[2] * (1.0 + share)];
                let higher = [low[0], low[1], low[2] + by];
                elements.push((piece.semantic, in_place(shape.mesh(steeper), higher)));
            }
        }
        elements
    }

    /// The same as a model.
    pub fn model(&self) -> Model {
        model(&self.elements())
    }

    /// The same as a model, the last element being the first.
    pub fn reversed(&self) -> Model {
        let mut elements = self.elements();
        elements.reverse();
        model(&elements)
    }

    /// The kinds of degeneracy in it, and other things to count, so that a test can show that it meets them.
    pub fn classes(&self) -> BTreeSet<&'static str> {
        let mut classes = BTreeSet::new();
        for (i, piece) in self.pieces.iter().enumerate() {
            let relation = match piece.relation {
                Relation::Coplanar(_, 0.0) => "near-coplanar, apart",
                Relation::Coplanar(..) => "near-coplanar, steeper",
                Relation::Free => "free",
                _ if i == 0 => "free",
                Relation::Face => "touching by a face",
                Relation::Edge => "touching by an edge",
                Relation::Vertex => "touching by a vertex",
                Relation::TJunction => "T-junction",
                Relation::Overlap => "overlapping",
                Relation::Nested => "nested",
                Relation::NestedFace => "nested, sharing a face",
                Relation::Twin => "identical twice",
                Relation::Gap(gap) if gap > 0.0 => "sliver gap",
                Relation::Gap(_) => "sliver overlap",
            };
            classes.insert(relation);
            classes.extend(match piece.defect {
                Defect::None => None,
                Defect::Inverted => Some("inverted"),
                Defect::Mixed(_) => Some("mixed winding"),
                Defect::Cavity => Some("cavity"),
                Defect::TwoComponents => Some("two components"),
            });
            if piece.relation != Relation::Twin {
                classes.extend(match piece.shape {
                    Shape::Plate(..) => Some("thin plate"),
                    Shape::Steep(_) | Shape::SteepGable(_) => Some("nearly vertical"),
                    Shape::Tilted(_) => Some("nearly level"),
                    Shape::L | Shape::U | Shape::LyingL | Shape::LyingU => Some("concave"),
                    _ => None,
                });
                if piece.shape.is_sloped() {
                    classes.insert("sloped");
                }
            }
            if piece.relation == Relation::Free {
                classes.extend(match piece.turn[0] {
                    0.0 => Some("square"),
                    90.0 | 45.0 => Some("turned by 45 or 90 degrees"),
                    turn if turn % 45.0 < 1e-3 || turn % 45.0 > 44.999 => Some("turned a millionth off"),
                    _ => Some("turned anyhow"),
                });
                if piece.turn[1] != 0.0 {
                    classes.insert("pitched");
                }
            }
        }
        classes.extend((self.at[0].abs() > 1e5).then_some("far from the origin"));
        classes.extend((self.scale < 1.0).then_some("tiny"));
        classes.extend((self.scale > 1.0).then_some("huge"));
        classes
    }
}

/// Models have limits far from here.
const FITS: &str = "two dozen elements fit into a model";

/// The model of some elements.
fn model(elements: &[(Semantic, Mesh)]) -> Model {
    let mut builder = ModelBuilder::new("random", Frame::default());
    let material = builder.material(Material::default());
    for (i, (semantic, mesh)) in elements.iter().enumerate() {
        let new = NewElement { name: format!("{semantic:?}_{i}"), ..NewElement::default() };
        let element = builder.element(new).expect(FITS);
        builder.semantic(element, *semantic);
        for &corners in mesh {
            builder.triangle(element, corners, material).expect(FITS);
        }
    }
    builder.finish().expect(FITS)
}

/// The lower corner and the size of a box that stands so to the box of size `other` at `low`.
fn beside(
    relation: Relation,
    axis: usize,
    low: [f64; 3],
    other: [f64; 3],
    size: [f64; 3],
) -> ([f64; 3], [f64; 3]) {
    let shifted = |by: [f64; 3]| [0, 1, 2].map(|k| low[k] + by[k]);
    let along = |by: f64, rest: [f64; 3]| [0, 1, 2].map(|k| if k == axis { by } else { rest[k] });
    match relation {
        Relation::Free | Relation::Coplanar(..) | Relation::Twin => (low, other),
        Relation::Face => (shifted(along(other[axis], [0.0; 3])), along(size[axis], other)),
        Relation::Edge => {
            let flush = (axis + 1) % 3;
            (shifted([0, 1, 2].map(|k| if k == flush { 0.0 } else { other[k] })), size)
        }
        Relation::Vertex => (shifted(other), size),
        Relation::TJunction => (shifted(along(other[axis], other.map(|c| c * 0.3))), size),
        Relation::Overlap => (shifted(other.map(|c| c * 0.5)), size),
        Relation::Nested => (shifted(other.map(|c| c * 0.25)), other.map(|c| c * 0.5)),
        Relation::NestedFace => (shifted(along(0.0, other.map(|c| c * 0.25))), other.map(|c| c * 0.5)),
        Relation::Gap(gap) => (shifted(along(other[axis] + gap, [0.0; 3])), along(size[axis], other)),
    }
}

impl Defect {
    fn of(self, mut mesh: Mesh, size: [f64; 3]) -> Mesh {
        match self {
            Defect::None => {}
            Defect::Inverted => mesh.iter_mut().for_each(|t| t.swap(1, 2)),
            Defect::Mixed(bits) => {
                mesh.iter_mut()
                    .enumerate()
                    .filter(|(i, _)| bits >> (i % 32) & 1 == 1)
                    .for_each(|(_, t)| t.swap(1, 2));
            }
            Defect::Cavity => {
                // Small, and about a point inside all shapes.
                let centre = [0.3 * size[0], 0.2 * size[1], 0.15 * size[2]];
                let small = |p: [f64; 3]| [0, 1, 2].map(|k| centre[k] + 0.1 * (p[k] - centre[k]));
                let cavity: Mesh = mesh.iter().map(|&[a, b, c]| [a, c, b].map(small)).collect();
                mesh.extend(cavity);
            }
            Defect::TwoComponents => {
                let copy: Mesh = mesh.iter().map(|t| t.map(|[x, y, z]| [x + 1.5 * size[0], y, z])).collect();
                mesh.extend(copy);
            }
        }
        mesh
    }
}

/// Random assemblies of one to twelve pieces: solids, rooms, openings; touching in every way, overlapping, nested, slivered, turned,
/// sloped, near-coplanar, far from the origin, tiny and huge.
pub fn assemblies() -> impl Strategy<Value = Assembly> {
    let scale = prop_oneof![8 => Just(1.0), 1 => Just(0.02), 1 => Just(100.0)];
    let at = prop_oneof![
        7 => Just([0.0; 3]),
        1 => Just([4_321_987.25, 3_210_123.5, 112.0]),
        1 => Just([-4_321_987.3, 3_210_123.7, 0.1]),
    ];
    (prop::collection::vec(pieces(), 1..=12), scale, at).prop_map(|(pieces, scale, at)| Assembly {
        pieces,
        scale,
        at,
    })
}

fn pieces() -> impl Strategy<Value = Piece> {
    let size = prop::array::uniform3(length());
    let at = prop::array::uniform3(place());
    let turn = (prop_oneof![8 => Just(0.0), 5 => angle()], prop_oneof![8 => Just(0.0), 1 => angle()]);
    (semantic(), shape(), size, at, turn, relation(), (0usize..12, 0usize..3), defect()).prop_map(
        |(semantic, shape, size, at, turn, relation, (other, axis), defect)| Piece {
            semantic,
            shape: match relation {
                Relation::Coplanar(..) if !shape.is_sloped() => Shape::Wedge,
                _ => shape,
            },
            size,
            at,
            turn: [turn.0, turn.1],
            relation,
            other,
            axis,
            defect,
        },
    )
}

fn semantic() -> impl Strategy<Value = Semantic> {
    use Semantic::{Door, Exterior, Ground, Opening, Roof, Room, Stairwell, Wall, Window};
    prop_oneof![
        4 => prop::sample::select(vec![Wall, Ground, Roof]),
        3 => Just(Room),
        2 => prop::sample::select(vec![Door, Window, Opening]),
        1 => prop::sample::select(vec![Stairwell, Exterior]),
    ]
}

fn length() -> impl Strategy<Value = f64> {
    prop_oneof![
        (1u32..=16).prop_map(|n| f64::from(n) * 0.25),
        (1u32..=40).prop_map(|n| f64::from(n) * 0.1),
        0.1..5.0f64,
    ]
}

fn place() -> impl Strategy<Value = f64> {
    prop_oneof![
        (0u32..=24).prop_map(|n| f64::from(n) * 0.25),
        (0u32..=60).prop_map(|n| f64::from(n) * 0.1),
        0.0..6.0f64,
    ]
}

fn angle() -> impl Strategy<Value = f64> {
    let off = 1e-6f64.to_degrees();
    prop_oneof![
        2 => Just(90.0),
        2 => Just(45.0),
        2 => prop::sample::select(vec![off, 90.0 + off, 45.0 + off]),
        3 => 0.1..179.9f64,
    ]
}

/// From one lattice unit to a millimetre.
fn sliver() -> impl Strategy<Value = f64> {
    let unit = 1.0 / 65536.0;
    prop_oneof![
        2 => prop::sample::select(vec![0.5 * unit, unit, 2.0 * unit, 3.5 * unit]),
        1 => prop::sample::select(vec![1e-4, 2e-4, 5e-4, 1e-3]),
        1 => unit..1e-3f64,
    ]
}

fn shape() -> impl Strategy<Value = Shape> {
    let steep = prop_oneof![1e-4..3e-3f64, Just(1e-3), Just(2e-3)];
    let tilt = prop_oneof![sliver(), 1e-4..2e-3f64];
    let thickness = prop_oneof![1e-4..1e-3f64, Just(1e-4), Just(1e-3)];
    use Shape::{Gable, L, LyingL, LyingU, Pyramid, Sheared, Tetrahedron, Triangle, U, Wedge};
    prop_oneof![
        8 => Just(Shape::Box),
        3 => prop::sample::select(vec![L, U, Triangle]),
        4 => prop::sample::select(vec![LyingL, LyingU, Gable, Wedge, Sheared, Tetrahedron, Pyramid]),
        1 => steep.clone().prop_map(Shape::Steep),
        1 => steep.prop_map(Shape::SteepGable),
        1 => tilt.prop_map(Shape::Tilted),
        1 => (thickness, 0usize..3).prop_map(|(thickness, axis)| Shape::Plate(thickness, axis)),
    ]
}

fn relation() -> impl Strategy<Value = Relation> {
    use Relation::{Edge, Face, Nested, NestedFace, Overlap, TJunction, Twin, Vertex};
    let steeper = prop_oneof![Just(1e-6), Just(1e-5), Just(1e-4)];
    prop_oneof![
        5 => Just(Relation::Free),
        9 => prop::sample::select(vec![Face, Edge, Vertex, TJunction, Overlap, Nested, NestedFace, Twin]),
        1 => sliver().prop_map(Relation::Gap),
        1 => sliver().prop_map(|gap| Relation::Gap(-gap)),
        1 => sliver().prop_map(|by| Relation::Coplanar(by, 0.0)),
        1 => steeper.prop_map(|share| Relation::Coplanar(0.0, share)),
    ]
}

fn defect() -> impl Strategy<Value = Defect> {
    prop_oneof![
        16 => Just(Defect::None),
        1 => Just(Defect::Inverted),
        1 => any::<u32>().prop_map(Defect::Mixed),
        1 => Just(Defect::Cavity),
        1 => Just(Defect::TwoComponents),
    ]
}
