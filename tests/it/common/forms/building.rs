//! The building that all forms say: shapes in their own axes, and elements that place them.

use std::collections::BTreeMap;

use enfilade::importers::{
    Camera, Frame, ImportOptions, Light, LightKind, Material, Model, ModelBuilder, NewElement, tagging,
};

use super::algebra::{Place, Point, Turn};

/// A polygon of a shape, counter-clockwise seen from outside.
#[derive(Clone, Debug)]
pub struct Face {
    pub corners: Vec<usize>,
    /// Index of [`Building::looks`].
    pub look: usize,
    /// Its triangles; `None`: the fan around its first corner.
    cut: Option<Vec<[usize; 3]>>,
}

impl Face {
    fn fan(corners: impl Into<Vec<usize>>, look: usize) -> Face {
        Face { corners: corners.into(), look, cut: None }
    }

    pub fn is_fan(&self) -> bool {
        self.cut.is_none()
    }

    pub fn triangles(&self) -> Vec<[usize; 3]> {
        let c = &self.corners;
        let fan = || (2..c.len()).map(|i| [c[0], c[i - 1], c[i]]).collect();
        self.cut.clone().unwrap_or_else(fan)
    }

    /// Seen from the other side.
    pub fn turned_over(&self) -> Face {
        let mut corners = self.corners.clone();
        corners[1..].reverse();
        let cut = self.cut.as_ref().map(|cut| cut.iter().map(|[a, b, c]| [*a, *c, *b]).collect());
        Face { corners, look: self.look, cut }
    }
}

/// A closed mesh, metres, Z up.
#[derive(Clone, Debug)]
pub struct Shape {
    pub points: Vec<Point>,
    pub faces: Vec<Face>,
    /// How many closed bodies it is.
    pub bodies: usize,
}

/// An element.
#[derive(Clone, Debug)]
pub struct Part {
    pub id: &'static str,
    pub name: &'static str,
    pub class: Option<&'static str>,
    pub storey: Option<&'static str>,
    pub shape: usize,
    pub place: Place,
}

/// A material, and whether it has the [texture](super::texture).
#[derive(Clone, Debug)]
pub struct Look {
    pub material: Material,
    pub is_textured: bool,
}

/// All of it.
#[derive(Clone)]
pub struct Building {
    degrees: f64,
    pub shapes: Vec<Shape>,
    pub looks: Vec<Look>,
    pub parts: Vec<Part>,
    /// A camera and a spot light, which look along -Z with Y up in its axes. OBJ has neither.
    pub eye: Place,
    /// Where the origin of all placements is.
    pub far: Point,
}

/// The camera's field of view.
pub const VFOV_DEGREES: f64 = 60.0;

/// How many elements [`building`] has.
pub const PARTS: usize = 14;

/// The building, with some of its elements turned by `degrees` more, and moved to `far`.
///
/// Coordinates are multiples of 1/64 m, so that 32-bit floats hold them, save for what is turned and the column.
pub fn building(degrees: f64, far: Point) -> Building {
    let shapes = vec![
        block([8.0, 6.0, 0.25], 0, 1),
        block([4.0, 0.25, 2.75], 0, 0),
        extruded(&L_SHAPE, None, 0.5, 2),
        two_bodies(),
        extruded(&heptagon(), None, 2.5, 3),
        extruded(&U_SHAPE, Some(&U_CUT), 3.0, 4),
        ridge(),
        with_split_edge(),
    ];
    let about_z = |odd: f64| Turn::about([0.0, 0.0, 1.0], odd + degrees);
    let skew = Turn::about([1.0, -2.0, 0.5], 23.0 + degrees);
    let at = |x: f64, y: f64, z: f64| [x, y, z];
    let mirror_x = [-1.0, 1.0, 1.0];
    let part = |id, name, class, storey, shape, scale, turn, at| Part {
        id,
        name,
        class,
        storey,
        shape,
        place: Place { scale, turn, at },
    };
    let same = [1.0; 3];
    let (wall, slab, chair) = (Some("IfcWall"), Some("IfcSlab"), Some("IfcFurniture"));
    let (eg, og) = (Some("EG"), Some("Level 1 (OG)"));
    let thing = [-1.0, -2.0, -0.5];
    let parts = vec![
        part("0gP1$ground", "Baugrund", slab, None, 0, same, Turn::NONE, at(0.0, 0.0, -0.25)),
        part("1wN_north", "Basic Wall:Brick 24", wall, eg, 1, same, Turn::NONE, at(0.5, 5.75, 0.0)),
        part("2wE", "Wand Süd", wall, eg, 1, same, Turn::quarters(1), at(7.5, 0.5, 0.0)),
        part("3wX", "turned", wall, eg, 1, same, about_z(17.3), at(2.5, 1.5, 0.0)),
        part("4sL", "L", slab, eg, 2, same, Turn::NONE, at(1.0, 1.0, 3.0)),
        part("5room", "ROOM_Küche", None, eg, 1, [0.5, 8.0, 1.0], Turn::quarters(2), at(6.0, 4.0, 0.25)),
        part("6roomL", "bath-room", None, eg, 2, mirror_x, Turn::NONE, at(4.0, 0.5, 0.25)),
        part("7c", "Chair #1", chair, eg, 3, same, Turn::NONE, at(2.0, 2.0, 0.0)),
        part("8c", "Chair #2", chair, eg, 3, same, about_z(-133.7), at(3.0, 3.0, 0.0)),
        part("9c", "Chair #3", chair, eg, 3, mirror_x, about_z(61.1), at(4.0, 3.5, 0.0)),
        part("Ac", "", Some("IfcColumn"), og, 4, same, Turn::quarters(3), at(3.25, 1.5, 3.5)),
        part("Bb", "beam 日本", Some("IfcBeam"), og, 5, [1.0, 0.75, -1.25], skew, at(2.0, 4.0, 4.5)),
        part("Cr", "Dach", Some("IfcRoof"), og, 6, [1.0, 0.5, 2.0], Turn::NONE, at(0.0, 0.0, 6.0)),
        part("Dx", "Ding 7", None, og, 7, thing, Turn::NONE, at(6.5, 2.0, 5.0)),
    ];
    assert_eq!(parts.len(), PARTS);
    let eye = Place { scale: same, turn: skew, at: at(2.5, 1.5, 1.625) };
    Building { degrees, shapes, looks: looks(), parts, eye, far }
}

/// What [`building`] was given: the rest is the same each time.
impl std::fmt::Debug for Building {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "building({:?}, {:?})", self.degrees, self.far)
    }
}

impl Building {
    /// The faces of a part: of its shape, turned over if it is a mirror image.
    pub fn faces(&self, part: &Part) -> Vec<Face> {
        let faces = &self.shapes[part.shape].faces;
        if part.place.mirrors() { faces.iter().map(Face::turned_over).collect() } else { faces.clone() }
    }

    /// Where the points of a part are, metres, Z up, without [`Building::far`].
    pub fn points(&self, part: &Part) -> Vec<Point> {
        let map = part.place.map();
        self.shapes[part.shape].points.iter().map(|p| map.point(*p)).collect()
    }

    /// The largest coordinate that computing with the building meets, with room for what forms add, metres.
    pub fn reach(&self) -> f64 {
        256.0 + self.far.iter().fold(0.0f64, |m, c| m.max(c.abs()))
    }

    /// The same through [`ModelBuilder`], without any file.
    pub fn model(&self) -> Model {
        let mut builder = ModelBuilder::new("building", Frame::default());
        let ids: Vec<_> = self.looks.iter().map(|look| builder.material(look.expected())).collect();
        for part in &self.parts {
            let text = |text: Option<&str>| text.map(str::to_owned);
            let element = builder.element(NewElement {
                id: part.id.to_owned(),
                name: part.name.to_owned(),
                class: text(part.class),
                storey: text(part.storey),
                path: part.id.to_owned(),
                ..NewElement::default()
            });
            let element = element.unwrap();
            let points = self.points(part);
            for face in self.faces(part) {
                for triangle in face.triangles() {
                    let corners = triangle.map(|v| [0, 1, 2].map(|i| points[v][i] + self.far[i]));
                    builder.triangle(element, corners, ids[face.look]).unwrap();
                }
            }
        }
        let column = |axis: usize| self.eye.turn.matrix.map(|row| row[axis]);
        let position = [0, 1, 2].map(|i| self.eye.at[i] + self.far[i]);
        let direction = column(2).map(|c| -c);
        let (name, up) = ("Auge".to_owned(), column(1));
        builder.camera(Camera {
            name: name.clone(),
            eye: position,
            direction,
            up,
            vfov_degrees: VFOV_DEGREES,
        });
        let (kind, range) = (LightKind::Spot { inner: 0.25, outer: 0.5 }, 12.5);
        let (color, intensity) = ([1.0, 0.5, 0.25], 640.0);
        builder.light(Light { name, kind, position, direction, color, intensity, range });
        let mut model = builder.finish().unwrap();
        tagging::tag(&mut model, &ImportOptions::default()).unwrap();
        model
    }
}

impl Look {
    /// The material with the texture's mean.
    pub fn expected(&self) -> Material {
        let mut material = self.material.clone();
        if self.is_textured {
            let [mean, opacity] = super::TEXTURE_MEANS;
            material.base_color = material.base_color.map(|c| c * mean as f32);
            material.alpha *= opacity as f32;
        }
        material
    }
}

fn looks() -> Vec<Look> {
    let named = |name: &str, base_color| Material { name: name.into(), base_color, ..Material::default() };
    let plain = |material| Look { material, is_textured: false };
    let glass =
        Material { alpha: 0.25, transmission: 0.75, ior: 1.25, ..named("Glas grün", [0.5, 1.0, 0.5]) };
    let metal = Material { metallic: 1.0, roughness: 0.125, ..named("steel", [0.5, 0.5, 0.625]) };
    let lamp = Material { emissive: [2.0, 1.5, 0.25], ..named("lamp", [0.0, 0.25, 1.0]) };
    vec![
        plain(named("plaster 01", [0.75, 0.75, 0.5])),
        Look { material: named("tiles", [1.0, 0.5, 0.25]), is_textured: true },
        plain(metal),
        plain(glass),
        plain(lamp),
    ]
}

/// A box from the origin on; its top has another look.
fn block([x, y, z]: Point, look: usize, top: usize) -> Shape {
    extruded(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], None, z, look).with_look(1, top)
}

/// Reflex corner first: the fan around it is the polygon.
const L_SHAPE: [[f64; 2]; 6] = [[1.0, 1.25], [1.0, 3.0], [0.0, 3.0], [0.0, 0.0], [2.5, 0.0], [2.5, 1.25]];

/// No fan is this polygon.
const U_SHAPE: [[f64; 2]; 8] =
    [[0.0, 0.0], [0.5, 0.0], [0.5, 0.25], [0.125, 0.25], [0.125, 0.5], [0.5, 0.5], [0.5, 0.75], [0.0, 0.75]];
const U_CUT: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 3], [0, 3, 7], [3, 4, 7], [4, 5, 6], [4, 6, 7]];

fn heptagon() -> [[f64; 2]; 7] {
    std::array::from_fn(|i| {
        let angle = std::f64::consts::TAU * i as f64 / 7.0;
        [0.4 * angle.cos(), 0.4 * angle.sin()]
    })
}

/// A prism over an outline. Bottom, top, sides.
fn extruded(outline: &[[f64; 2]], cut: Option<&[[usize; 3]]>, height: f64, look: usize) -> Shape {
    let n = outline.len();
    let level = |z: f64| outline.iter().map(move |p| [p[0], p[1], z]);
    let points = level(0.0).chain(level(height)).collect();
    let floor = Face { corners: (0..n).collect(), look, cut: cut.map(<[_]>::to_vec) };
    let raised = cut.map(|cut| cut.iter().map(|t| t.map(|v| v + n)).collect());
    let top = Face { corners: (n..2 * n).collect(), look, cut: raised };
    let side = |i: usize| Face::fan([i, (i + 1) % n, n + (i + 1) % n, n + i], look);
    let faces = [floor.turned_over(), top].into_iter().chain((0..n).map(side)).collect();
    Shape { points, faces, bodies: 1 }
}

impl Shape {
    fn with_look(mut self, face: usize, look: usize) -> Shape {
        self.faces[face].look = look;
        self
    }
}

/// A chair: a seat, and a back above it that does not touch it.
fn two_bodies() -> Shape {
    let mut seat = block([0.5, 0.5, 0.4375], 2, 4);
    let back = block([0.5, 0.0625, 0.5], 2, 2);
    let base = seat.points.len();
    seat.points.extend(back.points.iter().map(|p| [p[0], p[1] + 0.4375, p[2] + 0.5]));
    seat.faces.extend(back.faces.iter().map(|face| Face {
        corners: face.corners.iter().map(|v| v + base).collect(),
        look: face.look,
        cut: None,
    }));
    Shape { bodies: 2, ..seat }
}

/// A gabled roof: triangles, and a floor of another look.
fn ridge() -> Shape {
    let points = [[0, 0, 0], [8, 0, 0], [8, 12, 0], [0, 12, 0], [0, 6, 1], [8, 6, 1]];
    let faces = vec![
        Face::fan([0, 3, 2, 1], 0),
        Face::fan([0, 1, 5, 4], 1),
        Face::fan([2, 3, 4, 5], 1),
        Face::fan([0, 4, 3], 0),
        Face::fan([1, 2, 5], 3),
    ];
    Shape { points: points.map(|p| p.map(f64::from)).to_vec(), faces, bodies: 1 }
}

/// A box with a corner in the middle of an edge: a straight corner of the two faces there.
fn with_split_edge() -> Shape {
    let mut shape = block([1.0, 0.75, 0.5], 3, 2);
    shape.points.push([0.5, 0.0, 0.5]);
    shape.faces[1] = Face::fan([8, 5, 6, 7, 4], 2);
    shape.faces[2] = Face::fan([8, 4, 0, 1, 5], 3);
    shape
}

/// The materials by name.
pub fn expected_looks(building: &Building) -> BTreeMap<String, Material> {
    building.looks.iter().map(|look| (look.material.name.clone(), look.expected())).collect()
}
