//! What an element has from its relatives: a class from its ancestors, the things that fill it.

use std::collections::HashMap;

use super::words;
use crate::model::{Element, Model};
use crate::semantic::{Role, Semantic};

/// Names of relatives that are looked at per element, nearest first; bounds the cost of endless chains.
const MAX_NAMES: usize = 16;

/// Spaces and places hold other things. What lies below such a node is not of its kind.
const HOLDERS: &[&str] = &["ifcspace", "ifcsite", "ifcexternalspatialelement", "ifcspatialzone"];

/// The relations among a model's elements.
pub(super) struct Kin<'m> {
    /// How many elements lie directly below each path.
    children: HashMap<&'m str, u32>,
    /// The classes of what fills each opening, by the opening's identity.
    fillings: HashMap<&'m str, Vec<&'m str>>,
}

impl<'m> Kin<'m> {
    pub fn new(model: &'m Model) -> Kin<'m> {
        let mut kin = Kin { children: HashMap::new(), fillings: HashMap::new() };
        for element in &model.elements {
            if let Some(parent) = parent_path(element) {
                *kin.children.entry(parent).or_default() += 1;
            }
        }
        // An opening names what fills it, or the door names its opening, or both.
        let wanted: HashMap<&str, Vec<&str>> = {
            let mut wanted: HashMap<&str, Vec<&str>> = HashMap::new();
            for element in &model.elements {
                if let Some(filling) = &element.filling {
                    wanted.entry(filling).or_default().push(&element.id);
                }
            }
            wanted
        };
        for element in &model.elements {
            let openings = wanted.get(element.id.as_str()).into_iter().flatten().copied();
            // A door may be a node without a mesh over one for each material.
            let inherited = || element.inherited.get("opening_id").map(String::as_str);
            for opening in openings.chain(element.opening.as_deref().or_else(inherited)) {
                if let Some(class) = kin.class(element) {
                    kin.fillings.entry(opening).or_default().push(class);
                }
            }
        }
        kin
    }

    /// The classes of what fills the opening `element`.
    pub fn fillings(&self, element: &Element) -> &[&'m str] {
        self.fillings.get(element.id.as_str()).map_or(&[], Vec::as_slice)
    }

    /// The element's class: [`Kin::classes`]' first.
    pub fn class<'e>(&self, element: &'e Element) -> Option<&'e str> {
        self.classes(element).next()
    }

    /// [`Element::class`], unless it is that of a space around the element.
    pub fn own_class<'e>(&self, element: &'e Element) -> Option<&'e str> {
        element.class.as_deref().filter(|class| !self.is_borrowed(element, class))
    }

    /// The classes that the element, its ancestors and its names give, the surest first.
    pub fn classes<'e>(&self, element: &'e Element) -> impl Iterator<Item = &'e str> {
        let own = self.own_class(element);
        let inherited = element.inherited.get("ifc_class").map(String::as_str);
        let inherited = inherited.filter(|class| !is_holder(class) || self.stands_for_parent(element));
        let own_names = [element.name.as_str(), element.source_name.as_str()].into_iter();
        let named = own_names.filter_map(words::class_in);
        let others = element.other_names.iter().take(MAX_NAMES).map(String::as_str);
        let named_by_others = others.filter_map(|name| {
            let class = words::class_in(name)?;
            let is_own = !is_holder(class) || !is_ancestor(element, name) || self.stands_for_parent(element);
            is_own.then_some(class)
        });
        own.into_iter().chain(inherited).chain(named).chain(named_by_others)
    }

    /// The meaning that an ancestor's `extras.semantic` gives to all below it. Air gives none to other things in it.
    pub fn inherited_semantic(&self, element: &Element) -> Option<Semantic> {
        let semantic: Semantic = element.inherited.get("semantic")?.parse().ok()?;
        (!holds_others(semantic) || self.stands_for_parent(element)).then_some(semantic)
    }

    /// What the element lies in, as a word or a class, if the tag of that is not its own.
    pub fn holder<'e>(&self, element: &'e Element) -> Option<&'e str> {
        let semantic = element.inherited.get("semantic").filter(|word| word.parse().is_ok_and(holds_others));
        let class = [element.inherited.get("ifc_class"), element.class.as_ref()].into_iter().flatten();
        let holder = semantic.or_else(|| class.into_iter().find(|class| is_holder(class)))?;
        (!self.stands_for_parent(element)).then_some(holder)
    }

    /// The meaning of a semantic word in the element's names. Words of an ancestor count only if the element is all
    /// that it holds, or a part of it by name: in the group `kitchen-room` are chairs too.
    pub fn semantic_in_names(&self, element: &Element) -> Option<Semantic> {
        [element.name.as_str(), element.source_name.as_str()]
            .into_iter()
            .find_map(words::semantic_in)
            .or_else(|| {
                element.other_names.iter().take(MAX_NAMES).find_map(|name| {
                    let semantic = words::semantic_in(name)?;
                    let is_own = !is_ancestor(element, name)
                        || (is_parent(element, name) && self.stands_for_parent(element));
                    is_own.then_some(semantic)
                })
            })
    }

    /// Whether [`Element::class`] is that of a space or place above the element, which only holds it.
    fn is_borrowed(&self, element: &Element, class: &str) -> bool {
        is_holder(class)
            && element.extras.get("ifc_class").is_none_or(|own| own != class)
            && !element.source_name.starts_with(class)
            && element
                .other_names
                .iter()
                .take(MAX_NAMES)
                .any(|n| n.starts_with(class) && is_ancestor(element, n))
            && !self.stands_for_parent(element)
    }

    /// Whether the element is its parent's mesh rather than something in it: the only one below it, without a name
    /// of its own, or named after it (`Kitchen_1` below `Kitchen`).
    fn stands_for_parent(&self, element: &Element) -> bool {
        let Some(parent) = parent_path(element) else { return element.source_name.is_empty() };
        self.children.get(parent) == Some(&1)
            || element.source_name.is_empty()
            || element.other_names.iter().take(MAX_NAMES).any(|name| {
                !name.is_empty() && element.source_name.starts_with(name.as_str()) && is_parent(element, name)
            })
    }
}

/// Whether other things lie in what has this meaning.
fn holds_others(semantic: Semantic) -> bool {
    semantic.role() == Some(Role::Air) || semantic == Semantic::Site
}

fn is_holder(class: &str) -> bool {
    HOLDERS.iter().any(|holder| holder.eq_ignore_ascii_case(class))
}

/// The path without the element's own name; `None` if it lies below nothing.
fn parent_path(element: &Element) -> Option<&str> {
    let path = element.path.as_str();
    // The name may hold slashes; and the path may end in something that stands for a missing name.
    let above = match path.strip_suffix(element.source_name.as_str()) {
        Some("") => return None,
        Some(above) if above.ends_with('/') => above.strip_suffix('/'),
        _ => path.rsplit_once('/').map(|(above, _)| above),
    };
    above.filter(|above| !above.is_empty())
}

/// Whether `name` is that of the node directly above the element.
fn is_parent(element: &Element, name: &str) -> bool {
    parent_path(element)
        .and_then(|path| path.strip_suffix(name))
        .is_some_and(|above| above.is_empty() || above.ends_with('/'))
}

/// Whether `name` is that of a node above the element, not that of its mesh.
fn is_ancestor(element: &Element, name: &str) -> bool {
    // Only whole parts of the path count, and a name may hold slashes of its own.
    !name.is_empty()
        && parent_path(element).is_some_and(|path| {
            path.match_indices(name).any(|(at, _)| {
                let end = at + name.len();
                (at == 0 || path[..at].ends_with('/')) && (end == path.len() || path[end..].starts_with('/'))
            })
        })
}
