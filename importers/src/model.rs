//! The model: what every reader returns and every later stage reads.

use std::collections::BTreeMap;

use crate::frame::Frame;
use crate::semantic::Semantic;

/// Index of an element in [`Model::elements`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub u32);

/// Index of a material in [`Model::materials`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// A building: elements with f64 triangles in the internal frame (metres, Z up, offset taken off).
///
/// Made by the readers or by a [`ModelBuilder`](crate::ModelBuilder), which keeps these true: every index is in
/// range, every coordinate is finite, no triangle has zero area, element ids are unique and not empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The file's name without its folder, or what the builder was told.
    pub source: String,
    /// XXH3-64 of the bytes of the source files, in the order in which they were read; 0 if there were none.
    pub source_hash: u64,
    /// From the source's frame to the internal one.
    pub frame: Frame,
    /// The building's elements, in the order of the source.
    pub elements: Vec<Element>,
    /// Materials. [`Model::elements`]' triangles refer to them; there is always at least one.
    pub materials: Vec<Material>,
    /// Light sources, in the internal frame.
    pub lights: Vec<Light>,
    /// Cameras, in the internal frame.
    pub cameras: Vec<Camera>,
    /// What did not become a triangle of an element, and why. With the elements' triangles it accounts for all
    /// [`Model::triangles_read`].
    pub left_out: Vec<LeftOut>,
    /// Triangles that the source holds, instances counted each.
    pub triangles_read: u64,
    /// What a user should know: odd, but no error.
    pub warnings: Vec<Warning>,
}

/// One building element: a mesh with a meaning.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Element {
    /// Identity, stable when the same model is exported again: `extras.global_id`, else the `#id` suffix of an OBJ
    /// object, else the path. Unique in the model.
    pub id: String,
    /// The name as the source has it, without class and id: may be empty.
    pub name: String,
    /// The element's own full name in the source (node or object), before class and id were split off.
    pub source_name: String,
    /// Other names that may carry a class or a semantic word, nearest first: the mesh's, then those of the groups
    /// or ancestors from the innermost to the outermost.
    pub other_names: Vec<String>,
    /// Names from the root down to the element, joined by `/`.
    pub path: String,
    /// Where the source has it: `nodes[12]`, `line 345`.
    pub place: String,
    /// The class (`IfcWall`...), from `extras.ifc_class` or before the `:` in a name.
    pub class: Option<String>,
    /// The meaning, as tagging found it; [`Semantic::Unknown`] before.
    pub semantic: Semantic,
    /// How the meaning was found.
    pub tagged_by: TagSource,
    /// The storey's name.
    pub storey: Option<String>,
    /// Identity of the element that this opening pierces (openings), or that holds it (doors and windows).
    pub host: Option<String>,
    /// Identity of the door or window that fills this opening.
    pub filling: Option<String>,
    /// Identity of the opening that this door or window fills.
    pub opening: Option<String>,
    /// The source's metadata of this element; values that are no strings as JSON text.
    pub extras: BTreeMap<String, String>,
    /// Metadata of ancestors, the nearest value of each key.
    pub inherited: BTreeMap<String, String>,
    /// The triangles.
    pub mesh: Mesh,
}

/// Triangles of one element, in the internal frame. Equal positions are one vertex; vertices are in the order of
/// their first use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices, metres.
    pub positions: Vec<[f64; 3]>,
    /// Corners of each triangle, counter-clockwise seen from the front, as indices of `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// The material of each triangle.
    pub materials: Vec<MaterialId>,
}

impl Mesh {
    /// The three corners of triangle `index`.
    ///
    /// # Panics
    /// If `index` is not less than `triangles.len()`.
    pub fn corners(&self, index: usize) -> [[f64; 3]; 3] {
        self.triangles[index].map(|v| self.positions[v as usize])
    }
}

/// How an element's meaning was found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum TagSource {
    /// It was not.
    #[default]
    None,
    /// A rule of the user's, by its number in the file, from 1.
    UserRule(u32),
    /// `extras.semantic`.
    Extras,
    /// The class, by a rule of the shipped table (its number, from 1).
    Class(u32),
    /// A semantic word in the name.
    Name,
    /// Set by the program through [`ModelBuilder`](crate::ModelBuilder).
    Program,
    /// The element is not in the source: it was found in the building, as an opening or a room.
    Derived,
}

/// A surface's look. Colours are linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name as the source has it; empty if it has none, and for surfaces without a material.
    pub name: String,
    /// Base colour, linear RGB in 0..=1; the texture's mean colour is multiplied in.
    pub base_color: [f32; 3],
    /// Opacity in 0..=1; 1 is opaque. The texture's mean alpha is multiplied in.
    pub alpha: f32,
    /// 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Perceptual roughness in 0..=1.
    pub roughness: f32,
    /// Emitted radiance, linear RGB, strength multiplied in.
    pub emissive: [f32; 3],
    /// Index of refraction.
    pub ior: f32,
    /// Share of the light that goes through, in 0..=1 (KHR_materials_transmission, or `Tf`/`illum` of MTL).
    pub transmission: f32,
}

impl Default for Material {
    fn default() -> Material {
        Material {
            name: String::new(),
            base_color: [0.7; 3],
            alpha: 1.0,
            metallic: 0.0,
            roughness: 1.0,
            emissive: [0.0; 3],
            ior: 1.5,
            transmission: 0.0,
        }
    }
}

impl Material {
    /// Whether light passes: transmission, or alpha under 1.
    pub fn is_see_through(&self) -> bool {
        self.transmission > 0.0 || self.alpha < 1.0
    }
}

/// A light source (KHR_lights_punctual), in the internal frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// The name as the source has it.
    pub name: String,
    /// What kind it is.
    pub kind: LightKind,
    /// Where it is, metres. Unused for directional lights.
    pub position: [f64; 3],
    /// Where it shines to, unit length. Unused for point lights.
    pub direction: [f64; 3],
    /// Linear RGB in 0..=1.
    pub color: [f32; 3],
    /// Candela for point and spot lights, lux for directional ones.
    pub intensity: f32,
    /// Distance at which it ends, metres; infinite if the source gives none.
    pub range: f64,
}

/// Kinds of light sources.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LightKind {
    /// Shines in all directions from a point.
    Point,
    /// Shines from infinity.
    Directional,
    /// Shines from a point into a cone.
    Spot {
        /// Half angle of the full-intensity cone, radians.
        inner: f32,
        /// Half angle of the whole cone, radians.
        outer: f32,
    },
}

/// A pinhole camera, in the internal frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// The name as the source has it.
    pub name: String,
    /// Where it is, metres.
    pub eye: [f64; 3],
    /// Where it looks, unit length.
    pub direction: [f64; 3],
    /// What is up in the picture, unit length, perpendicular to `direction`.
    pub up: [f64; 3],
    /// Vertical field of view, degrees.
    pub vfov_degrees: f64,
}

/// Something of the source that did not become a triangle of an element.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// The element, if it became one.
    pub element: Option<ElementId>,
    /// Where the source has it.
    pub place: String,
    /// Why.
    pub reason: LeftOutReason,
    /// How many triangles ([`LeftOutReason::is_triangles`]), or how many of the things that the reason names.
    pub count: u64,
}

/// Why something was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum LeftOutReason {
    /// Triangles of zero area: two equal corners, or three on a line.
    Degenerate,
    /// Point primitives.
    Points,
    /// Line primitives, counted as segments.
    Lines,
    /// Polygons whose corners cannot be triangulated (all on a line, fewer than three).
    BadPolygon,
    /// Triangles of nodes that are not in the scene that the file shows.
    NotInScene,
    /// A camera that is no pinhole (orthographic).
    Camera,
}

impl LeftOutReason {
    /// Whether [`LeftOut::count`] counts triangles.
    pub const fn is_triangles(self) -> bool {
        matches!(self, LeftOutReason::Degenerate | LeftOutReason::NotInScene)
    }

    /// The reason in words.
    pub const fn text(self) -> &'static str {
        match self {
            LeftOutReason::Degenerate => "triangles of zero area",
            LeftOutReason::Points => "points",
            LeftOutReason::Lines => "line segments",
            LeftOutReason::BadPolygon => "polygons without area",
            LeftOutReason::NotInScene => "triangles of nodes outside the scene",
            LeftOutReason::Camera => "cameras that are no pinholes",
        }
    }
}

/// Something odd that a user should know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Where the source has it, or what it is about; may be empty.
    pub place: String,
    /// What is odd.
    pub text: String,
}

impl Model {
    /// Triangles of all elements.
    pub fn triangle_count(&self) -> u64 {
        self.elements.iter().map(|e| e.mesh.triangles.len() as u64).sum()
    }

    /// The box around all vertices (internal frame), as lower and upper corner; `None` without vertices.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut points = self.elements.iter().flat_map(|e| &e.mesh.positions);
        let first = *points.next()?;
        let mut bounds = [first, first];
        for p in points {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(p[axis]);
                bounds[1][axis] = bounds[1][axis].max(p[axis]);
            }
        }
        Some(bounds)
    }
}
