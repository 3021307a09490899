//! Which element and which material a surface shows.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, MaterialId, Model};

use crate::partition::cells::Source;

/// An element and a material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Look {
    pub(super) element: ElementId,
    pub(super) material: MaterialId,
}

/// What the triangles of a source show, most area first.
#[derive(Clone, Debug, Default)]
pub(super) struct Looks(Vec<Look>);

impl Looks {
    pub(super) fn of(model: &Model, source: &Source) -> Looks {
        let mut areas: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for &(element, triangle) in &source.triangles {
            let mesh = &model.elements[element.0 as usize].mesh;
            let key = [element.0, mesh.materials[triangle as usize].0];
            *areas.entry(key).or_default() += area(mesh.corners(triangle as usize));
        }
        let mut looks: Vec<([u32; 2], f64)> = areas.into_iter().collect();
        looks.sort_by(|a, b| b.1.total_cmp(&a.1));
        let look = |&([element, material], _): &([u32; 2], f64)| Look {
            element: ElementId(element),
            material: MaterialId(material),
        };
        Looks(looks.iter().map(look).collect())
    }

    /// What a face shows behind which there is `body`: a surface holds triangles beside the face, too, so that the body's own count
    /// first.
    pub(super) fn before(&self, body: Option<ElementId>) -> Option<Look> {
        let own = self.0.iter().find(|look| Some(look.element) == body);
        own.or(self.0.first()).copied()
    }
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(glam::DVec3::from);
    (b - a).cross(c - a).length() / 2.0
}
