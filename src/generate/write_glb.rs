//! A building as binary glTF 2.0: metres, Y up, one node and mesh an element, one primitive a material.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::importers::{Camera, Frame, Light};

use super::building::Building;
use super::style::{Cut, Export, Object, Part, Placement, Style};

impl Building {
    /// The bytes of a `.glb` file: [`Export::to_glb`] in the style [`Style::exact`].
    pub fn to_glb(&self) -> Vec<u8> {
        self.export(&Style::exact()).to_glb()
    }
}

impl Export<'_> {
    /// The bytes of a `.glb` file.
    ///
    /// Nodes are called `IfcClass:Name`; their extras hold `ifc_class`, `global_id`, `name`, `storey`, and for
    /// openings, doors and windows `host_id`, `filling_id`, `opening_id`. Lights are KHR_lights_punctual. A style with
    /// another place or unit has one root node, named after the building, whose matrix says so.
    pub fn to_glb(&self) -> Vec<u8> {
        let mut buffers = Buffers::default();
        let (mut nodes, meshes) = self.element_nodes(&mut buffers);
        let place = &self.placement;
        nodes.extend(self.lights.iter().enumerate().map(|(i, light)| light_node(i, light, place)));
        nodes.extend(self.cameras.iter().enumerate().map(|(i, camera)| camera_node(i, camera, place)));
        let mut is_below = vec![false; nodes.len()];
        nodes.iter().flat_map(|node| &node.children).for_each(|&child| is_below[child] = true);
        let mut shown: Vec<usize> = (0..nodes.len()).filter(|&node| !is_below[node]).collect();
        if !place.is_plain() {
            nodes.push(NodeJson {
                name: self.name.to_owned(),
                matrix: Some(place.matrix()),
                children: shown,
                ..NodeJson::default()
            });
            shown = vec![nodes.len() - 1];
        }
        let (positions, indices) = (buffers.positions.len(), buffers.indices.len());
        let view = |byte_offset, byte_length, byte_stride, target| ViewJson {
            buffer: 0,
            byte_offset,
            byte_length,
            byte_stride,
            target,
        };
        let root = RootJson {
            asset: AssetJson { version: "2.0", generator: "enfilade" },
            extensions_used: ["KHR_lights_punctual"],
            extensions: LightsExtension {
                lights: LightList { lights: self.lights.iter().map(light_json).collect() },
            },
            scene: 0,
            scenes: [SceneJson { name: self.name.to_owned(), nodes: shown }],
            nodes,
            cameras: self.cameras.iter().map(camera_json).collect(),
            meshes,
            materials: self.materials.iter().map(material_json).collect(),
            accessors: buffers.accessors,
            buffer_views: [
                view(0, positions, Some(12), ARRAY_BUFFER),
                view(positions, indices, None, ELEMENT_ARRAY_BUFFER),
            ],
            buffers: [BufferJson { byte_length: positions + indices }],
        };
        // Maps with text keys, text and finite numbers: nothing that JSON cannot hold.
        let json = serde_json::to_vec(&root).unwrap_or_default();
        let mut binary = buffers.positions;
        binary.extend(buffers.indices);
        container(json, binary)
    }

    /// The nodes of the objects in their order, then those of their parts, if they have several; and the meshes.
    fn element_nodes(&self, buffers: &mut Buffers) -> (Vec<NodeJson>, Vec<MeshJson>) {
        let mut nodes: Vec<NodeJson> = self.objects.iter().map(object_node).collect();
        let mut meshes = Vec::with_capacity(nodes.len());
        for (index, object) in self.objects.iter().enumerate() {
            if let Some(above) = object.above {
                nodes[above].children.push(index);
            }
            let parts = object.parts(Cut::Triangles);
            let is_split = parts.len() > 1;
            for (number, part) in (1..).zip(&parts) {
                let mesh = Some(meshes.len());
                let mut name = object.label.id.clone();
                if is_split {
                    name = format!("{name}_{number}");
                    let child = nodes.len();
                    nodes[index].children.push(child);
                    nodes.push(NodeJson { name: object.part_name(number), mesh, ..NodeJson::default() });
                } else {
                    nodes[index].mesh = mesh;
                }
                meshes.push(buffers.mesh(name, part, &self.placement));
            }
        }
        (nodes, meshes)
    }
}

/// A coordinate as the file has it: exact for those on the grid, which have no more than 24 bits up to 16 km.
pub(super) fn rounded(c: f64) -> f32 {
    // No negative zero.
    c as f32 + 0.0
}

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Header, JSON chunk and binary chunk, each padded to four bytes.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut glb = b"glTF".to_vec();
    let number = |glb: &mut Vec<u8>, n: usize| glb.extend((n as u32).to_le_bytes());
    number(&mut glb, 2);
    number(&mut glb, 12 + 8 + json.len() + 8 + binary.len());
    number(&mut glb, json.len());
    glb.extend(b"JSON");
    glb.extend(json);
    number(&mut glb, binary.len());
    glb.extend(b"BIN\0");
    glb.extend(binary);
    glb
}

/// The two buffer views being filled, and the accessors into them.
#[derive(Default)]
struct Buffers {
    positions: Vec<u8>,
    indices: Vec<u8>,
    accessors: Vec<AccessorJson>,
}

impl Buffers {
    /// All primitives of a mesh share its corners.
    fn mesh(&mut self, name: String, part: &Part<'_>, place: &Placement) -> MeshJson {
        let points: Vec<[f32; 3]> = part.points.iter().map(|&p| place.local(p).map(rounded)).collect();
        let bound = |pick: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|axis| f64::from(points.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0.0)))
        };
        let position = self.accessor(AccessorJson {
            buffer_view: 0,
            byte_offset: self.positions.len(),
            component_type: FLOAT,
            count: points.len(),
            kind: "VEC3",
            min: Some(bound(f32::min)),
            max: Some(bound(f32::max)),
        });
        self.positions.extend(points.iter().flatten().flat_map(|c| c.to_le_bytes()));
        let primitives = part
            .faces
            .iter()
            .map(|(material, rings)| PrimitiveJson {
                attributes: AttributesJson { position },
                indices: self.corners(rings.corners(), points.len()),
                material: *material,
                mode: 4,
            })
            .collect();
        MeshJson { name, primitives }
    }

    fn corners(&mut self, corners: &[u32], points: usize) -> usize {
        // 65535 itself stands for a restart.
        let is_short = points <= usize::from(u16::MAX);
        let byte_offset = self.indices.len();
        if is_short {
            self.indices.extend(corners.iter().flat_map(|&c| (c as u16).to_le_bytes()));
        } else {
            self.indices.extend(corners.iter().flat_map(|c| c.to_le_bytes()));
        }
        self.indices.resize(self.indices.len().next_multiple_of(4), 0);
        self.accessor(AccessorJson {
            buffer_view: 1,
            byte_offset,
            component_type: if is_short { UNSIGNED_SHORT } else { UNSIGNED_INT },
            count: corners.len(),
            kind: "SCALAR",
            min: None,
            max: None,
        })
    }

    fn accessor(&mut self, accessor: AccessorJson) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}

fn object_node(object: &Object<'_>) -> NodeJson {
    let extras = object.label.metadata.clone();
    NodeJson { name: object.label.node_name(), extras, ..NodeJson::default() }
}

fn light_node(index: usize, light: &Light, place: &Placement) -> NodeJson {
    NodeJson {
        name: light.name.clone(),
        translation: Some(place.local(light.position)),
        extensions: Some(LightsExtension { lights: LightLink { light: index } }),
        ..NodeJson::default()
    }
}

/// A glTF camera looks along its node's -z, with y up.
fn camera_node(index: usize, camera: &Camera, place: &Placement) -> NodeJson {
    let eye = place.local(camera.eye);
    let back = Frame::GLTF.direction_to_source(camera.direction).map(|c| -c);
    let up = Frame::GLTF.direction_to_source(camera.up);
    let right = [
        up[1] * back[2] - up[2] * back[1],
        up[2] * back[0] - up[0] * back[2],
        up[0] * back[1] - up[1] * back[0],
    ];
    let mut matrix = [0.0; 16];
    for (column, vector) in matrix.chunks_exact_mut(4).zip([right, up, back, eye]) {
        column[..3].copy_from_slice(&vector.map(|c| c + 0.0));
    }
    matrix[15] = 1.0;
    NodeJson { name: camera.name.clone(), camera: Some(index), matrix: Some(matrix), ..NodeJson::default() }
}

fn light_json(light: &Light) -> LightJson {
    LightJson { name: light.name.clone(), kind: "point", color: light.color, intensity: light.intensity }
}

fn camera_json(camera: &Camera) -> CameraJson {
    let yfov = camera.vfov_degrees * (std::f64::consts::PI / 180.0);
    CameraJson {
        name: camera.name.clone(),
        kind: "perspective",
        perspective: PerspectiveJson { yfov, znear: 0.05 },
    }
}

fn material_json(material: &crate::importers::Material) -> MaterialJson {
    let [r, g, b] = material.base_color;
    MaterialJson {
        name: material.name.clone(),
        pbr_metallic_roughness: SurfaceJson {
            base_color_factor: [r, g, b, material.alpha],
            metallic_factor: material.metallic,
            roughness_factor: material.roughness,
        },
        alpha_mode: (material.alpha < 1.0).then_some("BLEND"),
    }
}

// The parts of glTF that are written, their fields in a fixed order. (A map of serde_json changes its order with a
// feature that any crate may turn on.)

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct RootJson {
    asset: AssetJson,
    extensions_used: [&'static str; 1],
    extensions: LightsExtension<LightList>,
    scene: usize,
    scenes: [SceneJson; 1],
    nodes: Vec<NodeJson>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    cameras: Vec<CameraJson>,
    meshes: Vec<MeshJson>,
    materials: Vec<MaterialJson>,
    accessors: Vec<AccessorJson>,
    buffer_views: [ViewJson; 2],
    buffers: [BufferJson; 1],
}

#[derive(Serialize)]
struct AssetJson {
    version: &'static str,
    generator: &'static str,
}

#[derive(Serialize)]
struct LightsExtension<T> {
    #[serde(rename = "KHR_lights_punctual")]
    lights: T,
}

#[derive(Serialize)]
struct LightList {
    lights: Vec<LightJson>,
}

#[derive(Serialize)]
struct LightLink {
    light: usize,
}

#[derive(Serialize)]
struct LightJson {
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    color: [f32; 3],
    intensity: f32,
}

#[derive(Serialize)]
struct SceneJson {
    name: String,
    nodes: Vec<usize>,
}

#[derive(Default, Serialize)]
struct NodeJson {
    name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    children: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    matrix: Option<[f64; 16]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    translation: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extensions: Option<LightsExtension<LightLink>>,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    extras: BTreeMap<String, String>,
}

#[derive(Serialize)]
struct CameraJson {
    name: String,
    #[serde(rename = "type")]
    kind: &'static str,
    perspective: PerspectiveJson,
}

#[derive(Serialize)]
struct PerspectiveJson {
    yfov: f64,
    znear: f64,
}

#[derive(Serialize)]
struct MeshJson {
    name: String,
    primitives: Vec<PrimitiveJson>,
}

#[derive(Serialize)]
struct PrimitiveJson {
    attributes: AttributesJson,
    indices: usize,
    material: u32,
    mode: u32,
}

#[derive(Serialize)]
struct AttributesJson {
    #[serde(rename = "POSITION")]
    position: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct MaterialJson {
    name: String,
    pbr_metallic_roughness: SurfaceJson,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha_mode: Option<&'static str>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct SurfaceJson {
    base_color_factor: [f32; 4],
    metallic_factor: f32,
    roughness_factor: f32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct AccessorJson {
    buffer_view: usize,
    byte_offset: usize,
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f64; 3]>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct ViewJson {
    buffer: usize,
    byte_offset: usize,
    byte_length: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    byte_stride: Option<usize>,
    target: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BufferJson {
    byte_length: usize,
}
