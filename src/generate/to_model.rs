//! A building as a [`Model`], without a file in between.

use std::collections::BTreeMap;

use crate::importers::{Frame, ImportError, MaterialId, Model, ModelBuilder, NewElement};

use super::building::Building;
use super::style::{Cut, Export, Object, Part, Style};
use super::write_glb::rounded;

impl Building {
    /// The model of the building: [`Export::to_model`] in the style [`Style::exact`].
    ///
    /// # Errors
    /// As [`Export::to_model`].
    pub fn to_model(&self) -> Result<Model, ImportError> {
        self.export(&Style::exact()).to_model()
    }
}

impl Export<'_> {
    /// The model that [`Export::to_glb`] holds: its elements, materials, lights and cameras in the order of the
    /// file's tree, coordinates rounded as there; but all meanings set by the program, so that it needs no tagging.
    ///
    /// # Errors
    /// Over the builder's default limits, or nothing is left to make a model of.
    pub fn to_model(&self) -> Result<Model, ImportError> {
        let mut builder = ModelBuilder::new(format!("{}.glb", self.name), Frame::GLTF);
        let materials: Vec<_> = self.materials.iter().map(|m| builder.material(m.clone())).collect();
        let mut below: Vec<Vec<usize>> = vec![Vec::new(); self.objects.len()];
        for (index, object) in self.objects.iter().enumerate() {
            if let Some(above) = object.above {
                below[above].push(index);
            }
        }
        for index in (0..self.objects.len()).filter(|&index| self.objects[index].above.is_none()) {
            for &index in [index].iter().chain(&below[index]) {
                self.add(&mut builder, &materials, index)?;
            }
        }
        let metres = |p| self.placement.in_metres(self.placement.local(p));
        for light in &self.lights {
            let mut light = light.clone();
            light.position = metres(light.position);
            light.direction = Frame::GLTF.direction_to_source(light.direction);
            builder.light(light);
        }
        for camera in &self.cameras {
            let mut camera = camera.clone();
            camera.eye = metres(camera.eye);
            camera.direction = Frame::GLTF.direction_to_source(camera.direction);
            camera.up = Frame::GLTF.direction_to_source(camera.up);
            builder.camera(camera);
        }
        builder.finish()
    }

    fn add(
        &self,
        builder: &mut ModelBuilder,
        materials: &[MaterialId],
        index: usize,
    ) -> Result<(), ImportError> {
        let object = &self.objects[index];
        let parts = object.parts(Cut::Triangles);
        let mut new = self.new_element(object);
        new.place = format!("nodes[{index}]");
        if parts.len() > 1 {
            // The object's own node has no mesh, and so no mesh's name; its parts have.
            new.other_names.remove(0);
            let names = |number| [object.part_name(number), format!("{}_{number}", object.label.id)];
            new.other_names.extend((1..=parts.len()).flat_map(names));
        }
        let new = builder.element(new)?;
        builder.semantic(new, object.drawn.semantic);
        parts.iter().try_for_each(|part| {
            self.add_mesh(part, |corners, material| {
                builder.triangle(new, corners, materials[material as usize])
            })
        })
    }

    /// Hands on a mesh's triangles, material by material.
    fn add_mesh(
        &self,
        part: &Part<'_>,
        mut add: impl FnMut([[f64; 3]; 3], u32) -> Result<(), ImportError>,
    ) -> Result<(), ImportError> {
        let at =
            |p: [f64; 3]| self.placement.in_metres(self.placement.local(p).map(|c| f64::from(rounded(c))));
        let points: Vec<[f64; 3]> = part.points.iter().map(|&p| at(p)).collect();
        for (material, rings) in &part.faces {
            for ring in rings.iter() {
                // Faces were cut into triangles.
                if let &[a, b, c] = ring {
                    add([a, b, c].map(|i| points[i as usize]), *material)?;
                }
            }
        }
        Ok(())
    }

    /// The names of the nodes over an object, from the innermost to the outermost, and what it inherits.
    fn heritage(&self, object: &Object<'_>) -> (Vec<String>, BTreeMap<String, String>) {
        let mut names = Vec::new();
        let mut inherited = BTreeMap::new();
        let mut next = object.above;
        while let Some(above) = next.and_then(|above| self.objects.get(above)) {
            names.push(above.label.node_name());
            for (key, value) in handed_down(above) {
                inherited.entry(key).or_insert(value);
            }
            next = above.above;
        }
        if !self.placement.is_plain() {
            names.push(self.name.to_owned());
        }
        (names, inherited)
    }

    fn new_element(&self, object: &Object<'_>) -> NewElement {
        let label = &object.label;
        let (above, inherited) = self.heritage(object);
        let link = |key: &str| label.metadata.get(key).cloned();
        NewElement {
            id: label.id.clone(),
            name: if label.name.is_empty() { label.id.clone() } else { label.name.clone() },
            source_name: label.node_name(),
            path: path(&above, label.node_name()),
            other_names: [vec![label.id.clone()], above].concat(),
            class: Some(label.class.clone()),
            storey: object.drawn.storey.clone(),
            host: link("host_id"),
            filling: link("filling_id"),
            opening: link("opening_id"),
            extras: label.metadata.clone(),
            inherited,
            ..NewElement::default()
        }
    }
}

/// What the nodes below an object inherit of its metadata: all but what is its own.
fn handed_down(object: &Object<'_>) -> impl Iterator<Item = (String, String)> {
    let all = object.label.metadata.iter();
    all.filter(|(key, _)| !matches!(key.as_str(), "global_id" | "name")).map(|(k, v)| (k.clone(), v.clone()))
}

/// Names from the outermost node down to the element's own.
fn path(above: &[String], own: String) -> String {
    above.iter().rev().cloned().chain([own]).collect::<Vec<_>>().join("/")
}
