//! The building as glTF, in any form that the format has for it.

use std::path::{Path, PathBuf};

use serde_json::{Map as Object, Value, json};

use super::Written;
use super::algebra::{Content, Map, Place, Turn, is_short};
use super::building::{Building, Part};
use super::container::{self, Container};
use super::mesh::{Mesh, MeshForm, MeshWriter};

/// How a file as a whole is written.
#[derive(Clone, Debug)]
pub struct GltfForm {
    pub container: Container,
    /// Metres.
    pub unit: f64,
    pub y_up: bool,
    pub root: Root,
    pub storeys: Storeys,
    /// Parts of one shape are nodes on one mesh.
    pub is_shared: bool,
    /// Last element first.
    pub is_reversed: bool,
    /// Children before their parents in the list of nodes.
    pub nodes_backwards: bool,
    /// No list of scenes: all nodes without a parent are shown.
    pub has_scenes: bool,
    pub parts: Vec<PartForm>,
}

/// How the content comes to glTF's axes, to metres, and far away.
#[derive(Clone, Copy, Debug)]
pub enum Root {
    Parts,
    Matrix,
    /// One node to move, one for the unit, one for the axes.
    Nested,
}

/// How an element says its storey.
#[derive(Clone, Copy, Debug)]
pub enum Storeys {
    Extras,
    /// By a node above, an `IfcBuildingStorey` by its name...
    NamedNode,
    /// ...or by its metadata.
    ClassedNode,
    /// By metadata of a node above.
    Inherited,
}

/// How an element is written.
#[derive(Clone, Debug)]
pub struct PartForm {
    pub placing: Placing,
    pub class: ClassIn,
    pub is_named_in_extras: bool,
    pub mesh: MeshForm,
}

#[derive(Clone, Debug)]
pub enum Placing {
    /// The points are where they shall be.
    Baked,
    Parts,
    Matrix,
    /// Below a node that is scaled (mirrored, if negative), turned by quarters, and moved; its inverse is in the next.
    Nested {
        scale: f64,
        quarters: i32,
        at: [i8; 3],
    },
}

#[derive(Clone, Copy, Debug)]
pub enum ClassIn {
    Extras,
    NodeName,
    MeshName,
}

/// Writes the building into `folder`.
pub fn write(building: &Building, form: &GltfForm, folder: &Path) -> Written {
    let mut writer = Writer {
        building,
        form,
        content: Content { unit: form.unit, y_up: form.y_up },
        meshes: MeshWriter::default(),
        shared: Vec::new(),
        nodes: Vec::new(),
        root_is_exact: true,
        bounds: vec![0.0; building.parts.len()],
    };
    let mut order: Vec<usize> = (0..building.parts.len()).collect();
    if form.is_reversed {
        order.reverse();
    }
    let above = writer.root();
    let mut roots: Vec<usize> = above.first().copied().into_iter().collect();
    let mut storey: Option<(Option<&str>, usize)> = None;
    for &index in &order {
        let mut parent = above.last().copied();
        let part = &building.parts[index];
        if !matches!(form.storeys, Storeys::Extras) && part.storey.is_some() {
            let known = storey.filter(|known| known.0 == part.storey).map(|known| known.1);
            let node = known.unwrap_or_else(|| {
                let node = writer.storey(part.storey.unwrap_or_default());
                writer.attach(node, parent, &mut roots);
                node
            });
            storey = Some((part.storey, node));
            parent = Some(node);
        } else {
            storey = None;
        }
        let node = writer.part(index);
        writer.attach(node, parent, &mut roots);
    }
    let eye = writer.eye();
    writer.attach(eye, above.last().copied(), &mut roots);
    let bounds = std::mem::take(&mut writer.bounds);
    let path = writer.file(roots, folder);
    Written { path, options: Default::default(), frame: (1.0, true), bounds, order, cut: None }
}

struct Writer<'a> {
    building: &'a Building,
    form: &'a GltfForm,
    content: Content,
    meshes: MeshWriter,
    /// Meshes for several nodes: shape, name, and the mesh.
    shared: Vec<(usize, Option<String>, Mesh)>,
    nodes: Vec<Value>,
    root_is_exact: bool,
    /// By part, metres.
    bounds: Vec<f64>,
}

impl Writer<'_> {
    fn node(&mut self, node: Value) -> usize {
        self.nodes.push(node);
        self.nodes.len() - 1
    }

    fn attach(&mut self, node: usize, parent: Option<usize>, roots: &mut Vec<usize>) {
        match parent {
            None => roots.push(node),
            Some(parent) => {
                let parent = self.nodes[parent].as_object_mut().unwrap();
                let children = parent.entry("children").or_insert_with(|| json!([]));
                children.as_array_mut().unwrap().push(json!(node));
            }
        }
    }

    /// The nodes above all others, outermost first; none where the content is glTF's own.
    fn root(&mut self) -> Vec<usize> {
        let axes = Content { unit: 1.0, ..self.content }.to_gltf();
        let far = Content { unit: 1.0, y_up: true }.point(self.building.far);
        // Without a list of roots their order is that of their numbers: one root has no order.
        let is_plain = self.form.unit == 1.0 && self.form.y_up && self.building.far == [0.0; 3];
        if is_plain && self.form.has_scenes {
            return Vec::new();
        }
        // Minus a quarter of a turn about X.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let quaternion = if self.form.y_up { [0.0, 0.0, 0.0, 1.0] } else { [-half, 0.0, 0.0, half] };
        let scale = [self.form.unit; 3];
        self.root_is_exact = is_short(self.form.unit) && self.building.far.into_iter().all(is_short);
        match self.form.root {
            Root::Parts => {
                self.root_is_exact &= self.form.y_up;
                let place = Place { scale, turn: Turn { quaternion, matrix: axes.linear }, at: far };
                let mut node = json!({ "name": "all" });
                put_parts(&mut node, &place);
                vec![self.node(node)]
            }
            Root::Matrix => {
                let map = Map { at: far, ..self.content.to_gltf() };
                vec![self.node(json!({ "matrix": map.columns() }))]
            }
            Root::Nested => {
                let outer = self.node(json!({ "translation": far }));
                let middle = self.node(json!({ "name": "unit", "scale": scale }));
                let inner = self.node(json!({ "name": "axes", "matrix": axes.columns() }));
                self.attach(middle, Some(outer), &mut Vec::new());
                self.attach(inner, Some(middle), &mut Vec::new());
                vec![outer, middle, inner]
            }
        }
    }

    fn storey(&mut self, name: &str) -> usize {
        let node = match self.form.storeys {
            Storeys::NamedNode => json!({ "name": format!("IfcBuildingStorey:{name}") }),
            Storeys::ClassedNode => {
                json!({ "name": "level", "extras": { "ifc_class": "IfcBuildingStorey", "name": name } })
            }
            _ => json!({ "name": "level", "extras": { "storey": name } }),
        };
        self.node(node)
    }

    /// The node of an element, or the one above it that places it.
    fn part(&mut self, index: usize) -> usize {
        let (building, content) = (self.building, self.content);
        let part = &building.parts[index];
        let form = &self.form.parts[index];
        let is_baked = matches!(form.placing, Placing::Baked);
        let place = if is_baked { Place::HERE } else { content.place(&part.place) };
        let mesh = self.mesh(part, form, is_baked);
        // What the mesh's numbers say, and then the element's place.
        let whole = place.after_scaling(mesh.step, mesh.origin);

        let mut node = Object::new();
        self.describe(&mut node, part, form);
        node.insert("mesh".to_owned(), json!(mesh.index));
        let mut node = Value::Object(node);
        let mut above = None;
        let mut maps = vec![whole.map()];
        let mut quaternion = Turn::NONE.quaternion;
        match form.placing {
            Placing::Baked | Placing::Parts => {
                quaternion = whole.turn.quaternion;
                put_parts(&mut node, &whole);
            }
            Placing::Matrix => node["matrix"] = json!(whole.map().columns()),
            Placing::Nested { scale, quarters, at } => {
                let outer = Place {
                    scale: [scale, scale.abs(), scale.abs()],
                    turn: Turn::quarters(quarters),
                    at: at.map(f64::from),
                };
                let inner = inverse(&outer).after(&whole.map());
                let mut json = json!({ "name": "frame 7" });
                put_parts(&mut json, &outer);
                above = Some(json);
                node["matrix"] = json!(inner.columns());
                quaternion = outer.turn.quaternion;
                maps.extend([outer.map(), inner]);
            }
        }
        let node = self.node(node);
        let top = match above {
            None => node,
            Some(above) => {
                let above = self.node(above);
                self.attach(node, Some(above), &mut Vec::new());
                above
            }
        };

        let is_exact = self.root_is_exact
            && maps.iter().flat_map(Map::numbers).chain(quaternion).all(is_short)
            && mesh.is_exact
            && part.place.map().numbers().all(is_short);
        let stretch =
            if is_baked { 1.0 } else { part.place.scale.iter().fold(0.0f64, |m, s| m.max(s.abs())) };
        // A point's three coordinates are off by so much each, and turned into one another.
        let numbers = mesh.error * self.form.unit * stretch * 3f64.sqrt();
        self.bounds[index] = numbers + if is_exact { 0.0 } else { super::ROUNDING * building.reach() };
        top
    }

    /// The node of the camera and the light. Their own axes stay what they are, whatever is up in the content.
    fn eye(&mut self) -> usize {
        let eye = &self.building.eye;
        let columns = [0, 1, 2].map(|j| self.content.axes(eye.turn.matrix.map(|row| row[j])));
        let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
        let map = Map { linear, at: self.content.point(eye.at) };
        self.node(json!({
            "name": "Auge", "camera": 0, "matrix": map.columns(),
            "extensions": { "KHR_lights_punctual": { "light": 0 } }
        }))
    }

    fn mesh(&mut self, part: &Part, form: &PartForm, is_baked: bool) -> Mesh {
        let (building, content) = (self.building, self.content);
        let name = match (form.class, part.class) {
            (ClassIn::MeshName, Some(class)) => Some(format!("{class}:mesh")),
            _ => None,
        };
        if is_baked {
            let points: Vec<_> = building.points(part).into_iter().map(|p| content.point(p)).collect();
            return self.meshes.add(&points, &building.faces(part), name, &form.mesh);
        }
        let known = self.shared.iter().find(|mesh| mesh.0 == part.shape && mesh.1 == name);
        if let (Some(mesh), true) = (known, self.form.is_shared) {
            return mesh.2.clone();
        }
        let shape = &building.shapes[part.shape];
        let points: Vec<_> = shape.points.iter().map(|p| content.point(*p)).collect();
        let mesh = self.meshes.add(&points, &shape.faces, name.clone(), &form.mesh);
        self.shared.push((part.shape, name, mesh.clone()));
        mesh
    }

    fn describe(&self, node: &mut Object<String, Value>, part: &Part, form: &PartForm) {
        let mut extras = json!({ "global_id": part.id, "unused": [1, { "x": null }] });
        let prefix = match (form.class, part.class) {
            (ClassIn::NodeName, Some(class)) => format!("{class}:"),
            (ClassIn::Extras, Some(class)) => {
                extras["ifc_class"] = json!(class);
                String::new()
            }
            _ => String::new(),
        };
        // An empty name in the metadata is none.
        if form.is_named_in_extras && !part.name.is_empty() {
            extras["name"] = json!(part.name);
            node.insert("name".to_owned(), json!(format!("{prefix}object 12")));
        } else {
            node.insert("name".to_owned(), json!(format!("{prefix}{}", part.name)));
        }
        if let (Storeys::Extras, Some(storey)) = (self.form.storeys, part.storey) {
            extras["storey"] = json!(storey);
        }
        node.insert("extras".to_owned(), extras);
    }

    fn file(mut self, mut roots: Vec<usize>, folder: &Path) -> PathBuf {
        if self.form.nodes_backwards {
            let last = self.nodes.len() - 1;
            for node in &mut self.nodes {
                if let Some(children) = node.get_mut("children") {
                    for child in children.as_array_mut().unwrap() {
                        *child = json!(last - child.as_u64().unwrap() as usize);
                    }
                }
            }
            self.nodes.reverse();
            roots.iter_mut().for_each(|root| *root = last - *root);
        }
        let (mut json, bin) = self.meshes.finish();
        json["nodes"] = json!(self.nodes);
        if self.form.has_scenes {
            json["scenes"] = json!([{ "nodes": [] }, { "nodes": roots }]);
            json["scene"] = json!(1);
        }
        container::put_looks(&mut json, self.building);
        container::write(json, bin, self.form.container, folder)
    }
}

fn put_parts(node: &mut Value, place: &Place) {
    // What changes nothing is as good as not said.
    if place.at != [0.0; 3] {
        node["translation"] = json!(place.at);
    }
    if place.turn.quaternion != Turn::NONE.quaternion {
        node["rotation"] = json!(place.turn.quaternion);
    }
    if place.scale != [1.0; 3] {
        node["scale"] = json!(place.scale);
    }
}

/// The inverse of a placement whose turn is one by quarters.
fn inverse(place: &Place) -> Map {
    let r = place.turn.matrix;
    let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|j| r[j][i] / place.scale[i]));
    let at = Map { linear, at: [0.0; 3] }.point(place.at).map(|c| -c);
    Map { linear, at }
}
