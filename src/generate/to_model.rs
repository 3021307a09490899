//! A building as a [`Model`], without a file in between.

use crate::importers::{Frame, ImportError, Model, ModelBuilder, NewElement};

use super::building::{Building, Element};
use super::write_obj::y_up;

impl Building {
    /// The model of the building: its elements, materials, lights and cameras in the order of
    /// [`Building::to_glb`], all meanings set by the program, so that it needs no tagging.
    ///
    /// # Errors
    /// Over the builder's default limits.
    pub fn to_model(&self) -> Result<Model, ImportError> {
        let mut builder = ModelBuilder::new(format!("{}.glb", self.name), Frame::GLTF);
        let materials: Vec<_> = self.materials.iter().map(|m| builder.material(m.clone())).collect();
        for (index, element) in self.elements.iter().enumerate() {
            let new = builder.element(self.new_element(index, element))?;
            builder.semantic(new, element.semantic);
            // As in the file: material by material.
            let mut faces: Vec<_> = element.faces.iter().collect();
            faces.sort_by_key(|face| face.material);
            for face in faces {
                for triangle in element.triangles(face) {
                    let corners = triangle.map(|i| y_up(element.points[i as usize]));
                    builder.triangle(new, corners, materials[face.material as usize])?;
                }
            }
        }
        for light in &self.lights {
            let mut light = light.clone();
            light.position = Frame::GLTF.point_to_source(light.position);
            light.direction = Frame::GLTF.direction_to_source(light.direction);
            builder.light(light);
        }
        for camera in &self.cameras {
            let mut camera = camera.clone();
            camera.eye = Frame::GLTF.point_to_source(camera.eye);
            camera.direction = Frame::GLTF.direction_to_source(camera.direction);
            camera.up = Frame::GLTF.direction_to_source(camera.up);
            builder.camera(camera);
        }
        builder.finish()
    }

    fn new_element(&self, index: usize, element: &Element) -> NewElement {
        let id_of = |link: Option<u32>| Some(self.elements.get(link? as usize)?.global_id.clone());
        NewElement {
            id: element.global_id.clone(),
            name: element.name.clone(),
            source_name: element.tagged_name(),
            other_names: vec![element.global_id.clone()],
            path: element.tagged_name(),
            place: format!("nodes[{index}]"),
            class: Some(element.class.clone()),
            storey: element.storey.clone(),
            host: id_of(element.host),
            filling: id_of(element.filling),
            opening: id_of(element.opening),
            extras: self.metadata(element),
            ..NewElement::default()
        }
    }
}
