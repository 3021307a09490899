//! What rays of a command are not to meet.

use std::collections::BTreeSet;

use clap::Args;
use enfilade::Scene;
use enfilade::importers::Semantic;

use super::failure::Failure;

/// What rays pass as if it were not there.
#[derive(Args, Debug, Clone, Default)]
#[command(next_help_heading = "What rays meet")]
pub struct Hide {
    /// What rays are not to meet: a meaning (furniture, stair, wall...), `glass` (also panes, by their material), a class
    /// (IfcDoor), an element's id, or material:NAME. Several with commas between them; may be repeated.
    #[arg(long, value_name = "WHAT,...", value_delimiter = ',')]
    hide: Vec<String>,
}

/// Which elements and which materials are hidden, by their indices.
#[derive(Debug, Default)]
pub struct Hidden {
    elements: BTreeSet<u32>,
    materials: BTreeSet<u32>,
}

impl Hidden {
    /// Whether triangles of this element and material are.
    pub fn has(&self, element: u32, material: u32) -> bool {
        self.elements.contains(&element) || self.materials.contains(&material)
    }
}

impl Hide {
    /// The scene without what is hidden.
    pub fn apply(&self, scene: &mut Scene) -> Result<Hidden, Failure> {
        let hidden = self.hidden(scene)?;
        if !self.hide.is_empty() {
            *scene = scene.without(|element, material| hidden.has(element, material));
        }
        Ok(hidden)
    }

    fn hidden(&self, scene: &Scene) -> Result<Hidden, Failure> {
        let mut hidden = Hidden::default();
        for what in &self.hide {
            if let Some(name) = what.strip_prefix("material:") {
                let named = |index: &u32| scene.text(scene.materials()[*index as usize].name) == name;
                let found: Vec<u32> = (0..scene.materials().len() as u32).filter(named).collect();
                if found.is_empty() {
                    return Err(Failure::usage(format!("--hide: no material has the name '{name}'")));
                }
                hidden.materials.extend(found);
                continue;
            }
            let semantic = Semantic::all().find(|s| s.name().eq_ignore_ascii_case(what));
            let is_meant = |element: &enfilade::scene::ElementView<'_>| match semantic {
                Some(semantic) => element.semantic() == semantic,
                None => element.class().eq_ignore_ascii_case(what) || element.id() == what.as_str(),
            };
            let before = hidden.elements.len();
            hidden.elements.extend(scene.elements().filter(is_meant).map(|element| element.index()));
            if semantic == Some(Semantic::Glass) {
                let clear = |index: &u32| {
                    let material = &scene.materials()[*index as usize];
                    material.transmission > 0.0 || material.alpha < 1.0
                };
                hidden.materials.extend((0..scene.materials().len() as u32).filter(clear));
            } else if semantic.is_none() && hidden.elements.len() == before {
                return Err(Failure::usage(format!(
                    "--hide: '{what}' is no meaning, no class and no id of an element"
                )));
            }
        }
        Ok(hidden)
    }
}
