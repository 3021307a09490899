//! A model whose openings stand as those of a scene do: the truth of a scene in which some were closed or opened.

use enfilade_importers::{Element, MaterialId, Model};

use crate::closing::Leaf;
use crate::scene::Scene;
use crate::trace::Hit;

/// The model without the leaves that are out of the scene, and with the scene's sheets as further elements, in the order of
/// [`Scene::closures`], which are detail. Their number is the difference in elements.
///
/// # Panics
/// If the scene was compiled from another model.
pub fn standing(mut model: Model, scene: &Scene) -> Model {
    let is_out = |opening: u32| scene.stand(opening).leaf == Leaf::Out;
    for element in scene.elements() {
        let filling = element.filling().filter(|_| is_out(element.index()));
        let own = element.opening().filter(|opening| is_out(*opening)).map(|_| element.index());
        for leaf in filling.into_iter().chain(own) {
            model.elements[leaf as usize].mesh = Default::default();
        }
    }
    for closure in scene.closures() {
        let mut sheet =
            Element { id: format!("sheet of {}", scene.element(closure.opening).id()), ..Element::default() };
        for corners in closure.triangles.clone().map(|triangle| scene.triangle(triangle)) {
            let first = sheet.mesh.positions.len() as u32;
            sheet.mesh.positions.extend(corners);
            sheet.mesh.triangles.push([first, first + 1, first + 2]);
            sheet.mesh.materials.push(MaterialId(0));
        }
        model.elements.push(sheet);
    }
    model
}

/// The model without the triangles that `is_hidden`, which gets the indices of an element and of a material: the truth of
/// [`Scene::without`]. And the indices of the elements that lack any of them: these are detail now, whatever role they had.
pub fn without(mut model: Model, is_hidden: impl Fn(u32, u32) -> bool) -> (Model, Vec<u32>) {
    let mut lacking = Vec::new();
    for (element, index) in model.elements.iter_mut().zip(0u32..) {
        let mesh = &mut element.mesh;
        let keep: Vec<bool> = mesh.materials.iter().map(|material| !is_hidden(index, material.0)).collect();
        let mut kept = keep.iter();
        mesh.triangles.retain(|_| kept.next().is_none_or(|&keep| keep));
        let mut kept = keep.iter();
        mesh.materials.retain(|_| kept.next().is_none_or(|&keep| keep));
        if keep.contains(&false) {
            lacking.push(index);
        }
    }
    (model, lacking)
}

/// Makes hits on sheets those on the elements that [`standing`] adds for them to a model of so many.
pub fn tell_sheets(scene: &Scene, elements: u32, hits: &mut [Hit]) {
    for hit in hits {
        if let Some(place) = scene.closure_at(hit.triangle) {
            hit.element = elements + place as u32;
        }
    }
}
