//! EXT_mesh_gpu_instancing: one node, many copies of its mesh.

use gltf::json;

use super::accessors::{Accessors, Vectors};
use super::transform::Affine;
use super::{fault, malformed};
use crate::error::ImportError;
use crate::limits::Budget;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// Whether a node has the extension.
pub(super) fn is_on(node: &json::Node) -> bool {
    node.extensions.as_ref().is_some_and(|extensions| extensions.others.contains_key(NAME))
}

/// The accessors that place a node's instances.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instances {
    node: usize,
    translation: Option<usize>,
    rotation: Option<usize>,
    scale: Option<usize>,
    /// How many.
    pub count: u32,
}

/// The instances of node `index`, if it has the extension.
///
/// # Errors
/// The extension is malformed, or its accessors differ in length or do not exist.
pub(super) fn of(
    node: &json::Node,
    index: usize,
    accessors: &Accessors<'_>,
) -> Result<Option<Instances>, ImportError> {
    let Some(extension) = node.extensions.as_ref().and_then(|extensions| extensions.others.get(NAME)) else {
        return Ok(None);
    };
    let attribute = |name: &str| -> Result<Option<(usize, u32)>, ImportError> {
        let Some(value) = extension.get("attributes").and_then(|attributes| attributes.get(name)) else {
            return Ok(None);
        };
        let accessor = value.as_u64().and_then(|index| usize::try_from(index).ok());
        let Some(accessor) = accessor else {
            return Err(malformed(place(index, name), format!("{value} is no accessor")));
        };
        let count = accessors.count(accessor).map_err(|error| error.at(place(index, name)))?;
        Ok(Some((accessor, count)))
    };
    let parts = [attribute("TRANSLATION")?, attribute("ROTATION")?, attribute("SCALE")?];
    let mut counts = parts.iter().flatten().map(|(_, count)| *count);
    let Some(count) = counts.next() else {
        // Only attributes of some application: nothing says how many.
        return Ok(None);
    };
    if let Some(other) = counts.find(|other| *other != count) {
        let text = format!("TRANSLATION, ROTATION and SCALE differ in length: {count} and {other}");
        return Err(malformed(place(index, ""), text));
    }
    let [translation, rotation, scale] = parts.map(|part| part.map(|(accessor, _)| accessor));
    Ok(Some(Instances { node: index, translation, rotation, scale, count }))
}

impl Instances {
    /// The instances' transforms within their node.
    ///
    /// # Errors
    /// The accessors cannot be read, a transform is none, or over the budget.
    pub fn transforms(
        &self,
        accessors: &Accessors<'_>,
        budget: &mut Budget,
    ) -> Result<Vec<Affine>, ImportError> {
        let vectors = |accessor: Option<usize>, budget: &mut Budget| {
            accessor.map(|accessor| accessors.points(accessor, budget)).transpose()
        };
        let translations = vectors(self.translation, budget)?;
        let scales = vectors(self.scale, budget)?;
        let rotations = self.rotation.map(|accessor| accessors.rotations(accessor, budget)).transpose()?;
        budget
            .take_items(u64::from(self.count), size_of::<Affine>(), "instances")
            .map_err(|e| fault(place(self.node, ""), e.into()))?;
        let get = |vectors: &Option<Vectors<3>>, index: u32| vectors.as_ref().and_then(|v| v.get(index));
        let mut transforms = Vec::with_capacity(self.count as usize);
        for index in 0..self.count {
            let affine = Affine::from_parts(
                get(&translations, index).unwrap_or([0.0; 3]),
                rotations.as_ref().and_then(|r| r.get(index)).unwrap_or([0.0, 0.0, 0.0, 1.0]),
                get(&scales, index).unwrap_or([1.0; 3]),
            );
            let affine = affine.map_err(|text| {
                malformed(place(self.node, ""), format!("instance {}: {text}", u64::from(index) + 1))
            })?;
            transforms.push(affine);
        }
        Ok(transforms)
    }
}

fn place(node: usize, attribute: &str) -> String {
    let place = format!("nodes[{node}].extensions.{NAME}");
    if attribute.is_empty() { place } else { format!("{place}.attributes.{attribute}") }
}
