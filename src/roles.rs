//! What each component of each element does to the space: label air, carve it, stay as detail, or be left out.

use enfilade_importers::{Element, Model, Role, Semantic, Untagged};

use crate::components::Component;

/// The role that an element's tag asks for, before its mesh is looked at; `None` if it has no tag and its mesh
/// decides.
pub fn asked_role(element: &Element, untagged: Untagged) -> Option<Role> {
    match (element.semantic, untagged) {
        (Semantic::Unknown, Untagged::Solid) => Some(Role::Solid),
        (Semantic::Unknown, Untagged::Detail) => Some(Role::Detail),
        (semantic, _) => semantic.role(),
    }
}

/// The role of one component of an element: only closed components carve, whatever the tag says.
pub fn component_role(asked: Option<Role>, component: &Component) -> Role {
    match asked {
        Some(Role::Solid) | None => {
            if component.closed {
                Role::Solid
            } else {
                Role::Detail
            }
        }
        Some(role) => role,
    }
}

/// The role of every element for the truth of rays, which looks at components itself: what no tag names may carve.
pub fn roles(model: &Model, untagged: Untagged) -> Vec<Role> {
    model.elements.iter().map(|element| asked_role(element, untagged).unwrap_or(Role::Solid)).collect()
}
