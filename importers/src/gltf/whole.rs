//! Elements whose mesh lies in several nodes.
//!
//! Many converters write one node for each material: a node without mesh that carries the element's identity, over
//! nodes that carry none. Each of those alone is an open sheet; together they are the element.

use std::collections::HashMap;

use gltf::json;

use super::extras::Extras;
use super::graph::{Graph, Visit};
use super::instancing;
use crate::semantic::class_in;

/// Classes of nodes that hold elements rather than being one, in lower case. What lies below them is never a part of them.
const STRUCTURES: &[&str] = &[
    "ifcproject",
    "ifcprojectlibrary",
    "ifcbuilding",
    "ifcbuildingstorey",
    "ifcfacility",
    "ifcfacilitypart",
    "ifcfacilitypartcommon",
    "ifcbridge",
    "ifcbridgepart",
    "ifcroad",
    "ifcroadpart",
    "ifcrailway",
    "ifcrailwaypart",
    "ifcmarinefacility",
    "ifcmarinepart",
    "ifcexternalspatialelement",
    "ifcspatialzone",
    "ifczone",
    "ifcgroup",
    "ifcsystem",
    "ifcbuildingsystem",
    "ifcbuiltsystem",
    "ifcdistributionsystem",
    "ifcdistributioncircuit",
    "ifcstructuralanalysismodel",
    "ifcelementassembly",
];

/// Below these are their own parts, and what stands in them as well.
const HOLDERS: &[&str] = &["ifcspace", "ifcsite"];

/// Which nodes are parts of which element.
#[derive(Debug, Default)]
pub(super) struct Wholes {
    /// The nodes with meshes that together are the element of a node without one, by visit, in the tree's order.
    parts: HashMap<usize, Vec<usize>>,
    /// By visit: whether it is such a part.
    is_part: Vec<bool>,
}

/// A node whose parts may lie below it.
#[derive(Clone, Debug)]
struct Owner {
    visit: usize,
    /// In lower case.
    class: String,
    semantic: Option<String>,
}

impl Wholes {
    /// Finds the parts of all shown nodes.
    pub fn find(root: &json::Root, graph: &Graph) -> Wholes {
        let mut wholes = Wholes { parts: HashMap::new(), is_part: vec![false; graph.visits.len()] };
        let mut owners: Vec<Owner> = Vec::new();
        // By visit: the owner of what lies below it.
        let mut below: Vec<Option<usize>> = Vec::with_capacity(graph.visits.len());
        for (visit, shown) in graph.visits.iter().enumerate() {
            let node = &root.nodes[shown.node];
            let above = shown.parent.and_then(|parent| below[parent]);
            let may_own = node.mesh.is_none() && node.children.as_ref().is_some_and(|c| !c.is_empty());
            if above.is_none() && !may_own {
                below.push(None);
                continue;
            }
            let extras = Extras::of(node);
            let class = class_of(root, node, &extras);
            let semantic = extras.all.get("semantic");
            if let Some(above) = above
                && extras.global_id.is_none()
                && class.as_ref().is_none_or(|class| *class == owners[above].class)
                && semantic.is_none_or(|semantic| Some(semantic) == owners[above].semantic.as_ref())
            {
                let owner = &owners[above];
                let is_own = !HOLDERS.contains(&owner.class.as_str())
                    || is_named_after(root, graph, shown, owner.visit);
                if node.mesh.is_some() && is_own && !instancing::is_on(node) {
                    wholes.is_part[visit] = true;
                    wholes.parts.entry(owner.visit).or_default().push(visit);
                }
                below.push(Some(above));
                continue;
            }
            let owner = class.filter(|class| may_own && !STRUCTURES.contains(&class.as_str()));
            below.push(owner.filter(|_| extras.global_id.is_some()).map(|class| {
                owners.push(Owner { visit, class, semantic: semantic.cloned() });
                owners.len() - 1
            }));
        }
        wholes
    }

    /// The visits that together are the element of this one; none if it has no such parts. To be asked for once.
    pub fn take_parts(&mut self, visit: usize) -> Vec<usize> {
        self.parts.remove(&visit).unwrap_or_default()
    }

    /// Whether this node's mesh is a part of another's element.
    pub fn is_part(&self, visit: usize) -> bool {
        self.is_part[visit]
    }
}

/// The class that a node gives itself, by its metadata, its name or its mesh's, in lower case.
fn class_of(root: &json::Root, node: &json::Node, extras: &Extras) -> Option<String> {
    let mesh_name = || node.mesh.and_then(|mesh| root.meshes[mesh.value()].name.as_deref());
    let named = |name: Option<&str>| name.and_then(class_in).map(str::to_ascii_lowercase);
    let own = extras.ifc_class.as_ref().map(|class| class.to_ascii_lowercase());
    own.or_else(|| named(node.name.as_deref())).or_else(|| named(mesh_name()))
}

/// Whether a node directly below `owner` has no name, or the owner's and a number: `Kitchen_1` below `Kitchen`.
fn is_named_after(root: &json::Root, graph: &Graph, shown: &Visit, owner: usize) -> bool {
    let name = |node: usize| root.nodes[node].name.as_deref().unwrap_or_default();
    let above = name(graph.visits[owner].node);
    let own = name(shown.node);
    let is_number = |rest: &str| {
        let digits = rest.trim_start_matches(['_', '-', '.', ' ', ':']);
        rest.is_empty() || (digits.len() < rest.len() && digits.chars().all(|c| c.is_ascii_digit()))
    };
    let after = || own.strip_prefix(above).is_some_and(is_number);
    shown.parent == Some(owner) && (own.is_empty() || (!above.is_empty() && after()))
}
