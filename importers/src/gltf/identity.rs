//! What nodes are called, what they are, and what they inherit.

use std::collections::BTreeMap;
use std::rc::Rc;

use gltf::json;

use super::extras::Extras;
use super::fault;
use super::graph::Graph;
use crate::builder::NewElement;
use crate::error::ImportError;
use crate::limits::Budget;

/// What a node hands down to those below it.
#[derive(Clone, Debug, Default)]
struct Heritage {
    /// Metadata of the node and its ancestors, the nearest value of each key.
    extras: Rc<BTreeMap<String, String>>,
    /// The name of the nearest `IfcBuildingStorey`.
    storey: Option<Rc<str>>,
}

/// Tells what each shown node is. Nodes are asked for in the graph's order.
#[derive(Debug)]
pub(super) struct Identities<'a> {
    root: &'a json::Root,
    graph: &'a Graph,
    /// By visit; of nodes with children, once they were asked for.
    heritage: Vec<Option<Heritage>>,
}

impl<'a> Identities<'a> {
    pub fn new(root: &'a json::Root, graph: &'a Graph) -> Identities<'a> {
        Identities { root, graph, heritage: vec![None; graph.visits.len()] }
    }

    /// What the element of a visited node is called and is, all but its triangles; and notes what its children
    /// inherit. `is_element` is whether the node is one: it has a mesh, or parts that do.
    ///
    /// # Errors
    /// Over the budget.
    pub fn visit(
        &mut self,
        visit: usize,
        is_element: bool,
        budget: &mut Budget,
    ) -> Result<NewElement, ImportError> {
        let index = self.graph.visits[visit].node;
        let node = &self.root.nodes[index];
        let parent = self.graph.visits[visit].parent;
        let above = parent.and_then(|parent| self.heritage[parent].clone()).unwrap_or_default();
        let has_children = node.children.as_ref().is_some_and(|children| !children.is_empty());
        if !is_element && !has_children {
            return Ok(NewElement::default());
        }

        let extras = Extras::of(node);
        let node_name = node.name.as_deref().unwrap_or_default();
        let (prefix, rest) = split_class(node_name);
        let name = extras.name.as_deref().unwrap_or(rest);
        let mesh_name = node.mesh.and_then(|mesh| self.root.meshes[mesh.value()].name.as_deref());
        let class = extras
            .ifc_class
            .as_deref()
            .or(prefix)
            .or_else(|| mesh_name.and_then(|mesh_name| split_class(mesh_name).0));

        if has_children {
            let below = hand_down(&above, &extras, class, name, budget)
                .map_err(|error| error.at(format!("nodes[{index}]")))?;
            self.heritage[visit] = Some(below);
        }
        if !is_element {
            return Ok(NewElement::default());
        }
        let path = self.graph.path(visit);
        let ancestors = self.graph.ancestors(visit).map(|ancestor| self.graph.visits[ancestor].node);
        let ancestor_names = ancestors.filter_map(|node| self.root.nodes[node].name.as_deref());
        let inherited_storey = || above.extras.get("storey").filter(|storey| !storey.is_empty()).cloned();
        Ok(NewElement {
            id: extras.global_id.unwrap_or_else(|| path.clone()),
            name: name.to_owned(),
            source_name: node_name.to_owned(),
            other_names: mesh_name
                .into_iter()
                .chain(ancestor_names)
                .filter(|name| !name.is_empty())
                .map(str::to_owned)
                .collect(),
            class: class.map(str::to_owned),
            storey: extras
                .storey
                .or_else(|| above.storey.as_deref().map(str::to_owned))
                .or_else(inherited_storey),
            path,
            place: format!("nodes[{index}]"),
            host: extras.host,
            filling: extras.filling,
            opening: extras.opening,
            extras: extras.all,
            inherited: BTreeMap::clone(&above.extras),
        })
    }

    /// Adds what a part of an element says of itself, where the element says nothing: names, metadata, links.
    pub fn add_part(&self, visit: usize, element: &mut NewElement) {
        let node = &self.root.nodes[self.graph.visits[visit].node];
        let mesh_name = node.mesh.and_then(|mesh| self.root.meshes[mesh.value()].name.as_deref());
        for name in node.name.as_deref().into_iter().chain(mesh_name).filter(|name| !name.is_empty()) {
            // Few parts have an element; one that has very many is not worth a table.
            if !element.other_names.iter().rev().take(64).any(|known| known == name) {
                element.other_names.push(name.to_owned());
            }
        }
        let extras = Extras::of(node);
        for (key, value) in extras.all.into_iter().filter(|(key, _)| key != "name") {
            element.extras.entry(key).or_insert(value);
        }
        for (link, part) in [
            (&mut element.host, extras.host),
            (&mut element.filling, extras.filling),
            (&mut element.opening, extras.opening),
            (&mut element.storey, extras.storey),
        ] {
            if link.is_none() {
                *link = part;
            }
        }
    }
}

/// What children of a node with these properties inherit.
fn hand_down(
    above: &Heritage,
    extras: &Extras,
    class: Option<&str>,
    name: &str,
    budget: &mut Budget,
) -> Result<Heritage, ImportError> {
    let mut below = above.clone();
    if class == Some("IfcBuildingStorey") && !name.is_empty() {
        below.storey = Some(name.into());
    }
    // Identity and name are the ancestor's own.
    let own = extras.all.iter().filter(|(key, _)| !matches!(key.as_str(), "global_id" | "name"));
    if own.clone().next().is_some() {
        let entries = above.extras.iter().chain(own.clone());
        let bytes: usize = entries.map(|(key, value)| key.len() + value.len() + 64).sum();
        budget.take(bytes as u64, "inherited metadata").map_err(|e| fault("", e.into()))?;
        let extras = Rc::make_mut(&mut below.extras);
        extras.extend(own.map(|(key, value)| (key.clone(), value.clone())));
    }
    Ok(below)
}

/// The class before the first `:`, if what stands there could be one, and the rest of the name.
fn split_class(name: &str) -> (Option<&str>, &str) {
    match name.split_once(':') {
        Some((class, rest)) if is_identifier(class) => (Some(class), rest.trim_start()),
        _ => (None, name),
    }
}

/// Letters, digits and `_`, a letter first.
fn is_identifier(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_is_an_identifier_before_a_colon() {
        assert_eq!(split_class("IfcWall:Basic Wall:Brick"), (Some("IfcWall"), "Basic Wall:Brick"));
        assert_eq!(split_class("IfcSpace:"), (Some("IfcSpace"), ""));
        assert_eq!(split_class("Basic Wall:Brick"), (None, "Basic Wall:Brick"));
        assert_eq!(split_class(":x"), (None, ":x"));
        assert_eq!(split_class("1st:x"), (None, "1st:x"));
        assert_eq!(split_class("Tür"), (None, "Tür"));
    }
}
