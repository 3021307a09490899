//! Meshes of glTF: accessors, buffer views and primitives in any form.

use serde_json::{Value, json};

use super::algebra::Point;
use super::building::Face;
use super::numbers::{Code, Items, Numbers};

/// How a mesh is written.
#[derive(Clone, Debug)]
pub struct MeshForm {
    pub numbers: Numbers,
    pub layout: Layout,
    pub mode: Mode,
    pub indices: Indices,
    /// One primitive for each face, not for each material.
    pub by_face: bool,
    /// Corners of each triangle start at another one, and the triangles of a primitive are in another order.
    pub rolled: usize,
}

/// How items lie in their buffer view.
#[derive(Clone, Copy, Debug)]
pub enum Layout {
    Own,
    /// All accessors of this layout in one view, one after the other.
    Common,
    /// With so many words of another attribute before each, and of nothing behind.
    Interleaved {
        before: usize,
        behind: usize,
    },
    /// Every second one by a replacement; or all, without anything to replace.
    Sparse {
        has_base: bool,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    List,
    /// One strip, with triangles of no area between its pieces.
    Strip,
    /// A fan for each face that is one, for each triangle else.
    Fan,
}

#[derive(Clone, Copy, Debug)]
pub enum Indices {
    None,
    U8,
    U16,
    U32,
}

/// A written mesh. Its coordinates are `origin + step * number`.
#[derive(Clone, Debug)]
pub struct Mesh {
    pub index: usize,
    pub origin: Point,
    pub step: Point,
    /// How far a coordinate may be off, in the unit of the points, by what the number form can say.
    pub error: f64,
    /// Whether the numbers are just the coordinates.
    pub is_exact: bool,
}

/// Meshes, accessors, views and bytes of a file in the making.
#[derive(Default)]
pub struct MeshWriter {
    meshes: Vec<Value>,
    accessors: Vec<Value>,
    /// Views by their bytes and stride. The first is the common one.
    views: Vec<(Vec<u8>, Option<usize>)>,
}

impl MeshWriter {
    /// Adds a mesh.
    pub fn add(&mut self, points: &[Point], faces: &[Face], name: Option<String>, form: &MeshForm) -> Mesh {
        let code = Code::of(points, form.numbers);
        let groups: Vec<Vec<&Face>> = if form.by_face {
            faces.iter().map(|face| vec![face]).collect()
        } else {
            let mut looks: Vec<usize> = faces.iter().map(|face| face.look).collect();
            looks.sort_unstable();
            looks.dedup();
            looks.into_iter().map(|look| faces.iter().filter(|face| face.look == look).collect()).collect()
        };
        let mut shared = None;
        let mut primitives = Vec::new();
        for group in groups {
            for corners in sequences(&group, form) {
                let mut primitive = json!({ "material": group[0].look, "mode": mode_number(form.mode) });
                let positions = match form.indices {
                    Indices::None => {
                        let own: Vec<Point> = corners.iter().map(|v| points[*v]).collect();
                        self.points(&code.items(&own), form.layout)
                    }
                    width => {
                        primitive["indices"] = json!(self.indices(&corners, width, form.layout));
                        match &shared {
                            Some(shared) => Value::clone(shared),
                            None => shared.insert(self.points(&code.items(points), form.layout)).clone(),
                        }
                    }
                };
                primitive["attributes"] = positions;
                primitives.push(primitive);
            }
        }
        let mut mesh = json!({ "primitives": primitives });
        if let Some(name) = name {
            mesh["name"] = json!(name);
        }
        self.meshes.push(mesh);
        let is_exact = points.iter().all(|p| code.said(*p) == *p);
        Mesh {
            index: self.meshes.len() - 1,
            origin: code.origin,
            step: if code.is_normalized { code.step.map(|s| s * code.largest) } else { code.step },
            error: if is_exact { 0.0 } else { code.error },
            // A normalised number is divided by its type's largest and multiplied again.
            is_exact: is_exact && !code.is_normalized,
        }
    }

    /// The JSON of meshes, accessors and buffer views, and the one buffer.
    pub fn finish(self) -> (Value, Vec<u8>) {
        let (mut views, mut bin) = (Vec::new(), Vec::new());
        for (bytes, stride) in &self.views {
            bin.resize(usize::next_multiple_of(bin.len(), 4), 0);
            // A view has at least one byte.
            let length = bytes.len().max(1);
            let mut view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": length });
            if let Some(stride) = stride {
                view["byteStride"] = json!(stride);
            }
            views.push(view);
            bin.extend_from_slice(bytes);
            bin.resize(bin.len() + length - bytes.len(), 0);
        }
        (json!({ "meshes": self.meshes, "accessors": self.accessors, "bufferViews": views }), bin)
    }

    fn view(&mut self, bytes: Vec<u8>, stride: Option<usize>) -> usize {
        if self.views.is_empty() {
            self.views.push((Vec::new(), None));
        }
        self.views.push((bytes, stride));
        self.views.len() - 1
    }

    /// Adds bytes to the common view; gives its index and where they start.
    fn in_common(&mut self, bytes: &[u8]) -> (usize, usize) {
        if self.views.is_empty() {
            self.views.push((Vec::new(), None));
        }
        let common = &mut self.views[0].0;
        common.resize(common.len().next_multiple_of(4), 0xAB);
        let start = common.len();
        common.extend_from_slice(bytes);
        (0, start)
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn indices(&mut self, corners: &[usize], width: Indices, layout: Layout) -> usize {
        let (component, bytes): (u32, Vec<u8>) = match width {
            Indices::U8 => (5121, corners.iter().map(|v| *v as u8).collect()),
            Indices::U16 => (5123, corners.iter().flat_map(|v| (*v as u16).to_le_bytes()).collect()),
            _ => (5125, corners.iter().flat_map(|v| (*v as u32).to_le_bytes()).collect()),
        };
        let (view, offset) = match layout {
            Layout::Common => self.in_common(&bytes),
            _ => (self.view(bytes, None), 0),
        };
        self.accessor(json!({
            "bufferView": view, "byteOffset": offset, "componentType": component, "type": "SCALAR",
            "count": corners.len()
        }))
    }

    /// The attributes of a primitive with these points.
    fn points(&mut self, items: &Items, layout: Layout) -> Value {
        let count = items.bytes.len();
        let size = items.bytes[0].len();
        let padded = size.next_multiple_of(4);
        let values = |extreme: fn(f64, f64) -> f64| {
            [0, 1, 2].map(|i| items.values.iter().map(|v| v[i]).reduce(extreme).unwrap_or(0.0))
        };
        let mut accessor = json!({
            "componentType": items.component, "normalized": items.is_normalized, "type": "VEC3",
            "count": count, "min": values(f64::min), "max": values(f64::max)
        });
        // Items at a stride, each after `before` bytes.
        let strided = |before: usize, stride: usize| {
            let item = |bytes: &Vec<u8>| {
                let mut all = vec![0x3F; before];
                all.extend_from_slice(bytes);
                all.resize(stride, 0xFF);
                all
            };
            items.bytes.iter().flat_map(item).collect::<Vec<u8>>()
        };
        let stride_of = |stride| (stride != size).then_some(stride);
        let mut other = None;
        match layout {
            // What has a stride cannot lie with what has none.
            Layout::Common if padded == size => {
                let (view, offset) = self.in_common(&items.bytes.concat());
                accessor["bufferView"] = json!(view);
                accessor["byteOffset"] = json!(offset);
            }
            Layout::Own | Layout::Common => {
                accessor["bufferView"] = json!(self.view(strided(0, padded), stride_of(padded)));
            }
            Layout::Interleaved { before, behind } => {
                // Three floats make a normal.
                let stride = 12 * before + padded + 4 * behind;
                let view = self.view(strided(12 * before, stride), stride_of(stride));
                accessor["bufferView"] = json!(view);
                accessor["byteOffset"] = json!(12 * before);
                if before > 0 {
                    other = Some(self.accessor(json!({
                        "bufferView": view, "componentType": 5126, "type": "VEC3", "count": count
                    })));
                }
            }
            Layout::Sparse { has_base } => {
                let is_replaced = |index: &usize| !has_base || index % 2 == 1;
                let replaced: Vec<usize> = (0..count).filter(is_replaced).collect();
                if has_base {
                    let mut base = strided(0, padded);
                    replaced.iter().for_each(|index| base[index * padded..][..size].fill(0x7F));
                    accessor["bufferView"] = json!(self.view(base, stride_of(padded)));
                }
                if !replaced.is_empty() {
                    let indices = replaced.iter().flat_map(|v| (*v as u16).to_le_bytes()).collect();
                    let values = replaced.iter().flat_map(|v| items.bytes[*v].clone()).collect();
                    accessor["sparse"] = json!({
                        "count": replaced.len(),
                        "indices": { "bufferView": self.view(indices, None), "componentType": 5123 },
                        "values": { "bufferView": self.view(values, None) }
                    });
                }
            }
        }
        let positions = self.accessor(accessor);
        match other {
            None => json!({ "POSITION": positions }),
            Some(normals) => json!({ "POSITION": positions, "NORMAL": normals }),
        }
    }
}

fn mode_number(mode: Mode) -> u32 {
    match mode {
        Mode::List => 4,
        Mode::Strip => 5,
        Mode::Fan => 6,
    }
}

/// The corners of each primitive that a group of faces makes.
fn sequences(faces: &[&Face], form: &MeshForm) -> Vec<Vec<usize>> {
    let mut triangles: Vec<[usize; 3]> = faces.iter().flat_map(|face| face.triangles()).collect();
    let count = triangles.len();
    triangles.rotate_left(form.rolled % count);
    triangles.iter_mut().for_each(|triangle| triangle.rotate_left(form.rolled % 3));
    match form.mode {
        Mode::List => vec![triangles.concat()],
        Mode::Strip => vec![strip(faces)],
        Mode::Fan => {
            let fans = faces.iter().filter(|face| face.is_fan()).map(|face| face.corners.clone());
            let others = faces.iter().filter(|face| !face.is_fan());
            let others = others.flat_map(|face| face.triangles()).map(|t| t.to_vec());
            fans.chain(others).collect()
        }
    }
}

/// One strip over all faces: quads in one piece, others by their triangles.
fn strip(faces: &[&Face]) -> Vec<usize> {
    let mut all: Vec<usize> = Vec::new();
    for face in faces {
        let pieces: Vec<Vec<usize>> = match face.corners[..] {
            // Cut along the same diagonal as the fan.
            [a, b, c, d] if face.is_fan() => vec![vec![b, c, a, d]],
            _ => face.triangles().iter().map(|t| t.to_vec()).collect(),
        };
        for piece in pieces {
            if let Some(&last) = all.last() {
                // Each piece starts at an even number, so that it winds as it is written.
                let even = all.len().is_multiple_of(2);
                all.extend(std::iter::repeat_n(last, if even { 1 } else { 2 }));
                all.push(piece[0]);
            }
            all.extend(piece);
        }
    }
    all
}
