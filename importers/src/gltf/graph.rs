//! The nodes that the file shows, each with its place in the world.

use std::collections::{HashMap, HashSet};

use gltf::json;

use super::document::Placement;
use super::transform::Affine;
use super::{fault, malformed};
use crate::error::ImportError;
use crate::limits::Budget;

/// Nodes may not be nested deeper: paths and metadata of ancestors grow with depth.
const MAX_DEPTH: u32 = 1024;

/// A node that the scene shows.
#[derive(Debug)]
pub(super) struct Visit {
    /// Its index in the file.
    pub node: usize,
    /// Index of its parent's visit.
    pub parent: Option<usize>,
    /// From the node's own axes to the scene's.
    pub world: Affine,
    /// Its part of a path: the name, or `node[12]`, made different from its siblings'.
    pub segment: String,
    /// 0 for roots.
    depth: u32,
}

/// What the file shows.
#[derive(Debug)]
pub(super) struct Graph {
    /// Nodes in the order of the file's tree, parents before children.
    pub visits: Vec<Visit>,
    /// For each node of the file whether it is among them.
    pub shown: Vec<bool>,
}

/// Walks the scene that the file shows: its default scene, or else its first, or else all nodes without a parent.
///
/// # Errors
/// A node that is reached twice, a cycle, too deep a chain, a transform that is none, or over the budget.
pub(super) fn walk(
    root: &json::Root,
    placements: &[Placement],
    budget: &mut Budget,
) -> Result<Graph, ImportError> {
    budget
        .take_items(root.nodes.len() as u64, size_of::<Visit>() * 2 + 64, "the scene's nodes")
        .map_err(|e| fault("nodes", e.into()))?;
    let mut graph = Graph { visits: Vec::new(), shown: vec![false; root.nodes.len()] };
    let scene = root.scene.map_or(0, |scene| scene.value());
    let roots: Vec<usize> = match root.scenes.get(scene) {
        Some(scene) => scene.nodes.iter().map(|node| node.value()).collect(),
        None => orphans(root),
    };
    // What is still to be visited, last first.
    let mut todo: Vec<(usize, Option<usize>, String)> = Vec::new();
    push_siblings(root, &roots, None, &mut todo);
    while let Some((node, parent, segment)) = todo.pop() {
        graph.visit(root, placements, node, parent, segment)?;
        let visit = graph.visits.len() - 1;
        if let Some(children) = &root.nodes[node].children {
            let children: Vec<usize> = children.iter().map(|child| child.value()).collect();
            push_siblings(root, &children, Some(visit), &mut todo);
        }
    }
    // Without scenes every node is below some root, unless it is its own ancestor.
    if root.scenes.is_empty()
        && let Some(node) = graph.shown.iter().position(|shown| !shown)
    {
        return Err(malformed(format!("nodes[{node}]"), "the node is its own ancestor"));
    }
    Ok(graph)
}

impl Graph {
    fn visit(
        &mut self,
        root: &json::Root,
        placements: &[Placement],
        node: usize,
        parent: Option<usize>,
        segment: String,
    ) -> Result<(), ImportError> {
        let error = |text: String| {
            let error = malformed(format!("nodes[{node}]"), text);
            match root.nodes[node].name.as_deref() {
                Some(name) if !name.is_empty() => error.of_element(name),
                _ => error,
            }
        };
        if self.shown[node] {
            return Err(error(self.why_twice(node, parent)));
        }
        self.shown[node] = true;
        let depth = parent.map_or(0, |parent| self.visits[parent].depth + 1);
        if depth > MAX_DEPTH {
            return Err(error(format!("nested deeper than {MAX_DEPTH} nodes")));
        }
        let own = placements.get(node).map_or(Ok(Affine::IDENTITY), Affine::of).map_err(error)?;
        let world = match parent {
            Some(parent) => self.visits[parent].world.after(&own).map_err(error)?,
            None => own,
        };
        self.visits.push(Visit { node, parent, world, segment, depth });
        Ok(())
    }

    fn why_twice(&self, node: usize, parent: Option<usize>) -> String {
        let mut ancestor = parent;
        while let Some(visit) = ancestor {
            if self.visits[visit].node == node {
                return "the node is its own ancestor".to_owned();
            }
            ancestor = self.visits[visit].parent;
        }
        "the node has two places in the scene: it is a child of two nodes, or twice of one".to_owned()
    }

    /// The ancestors of a visit, innermost first.
    pub fn ancestors(&self, visit: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(self.visits[visit].parent, |&visit| self.visits[visit].parent)
    }

    /// Names from the root down to a visit.
    pub fn path(&self, visit: usize) -> String {
        let mut segments = vec![self.visits[visit].segment.as_str()];
        segments.extend(self.ancestors(visit).map(|ancestor| self.visits[ancestor].segment.as_str()));
        segments.reverse();
        segments.join("/")
    }
}

/// Nodes that are no node's child.
fn orphans(root: &json::Root) -> Vec<usize> {
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
        is_child[child.value()] = true;
    }
    (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
}

/// Puts siblings on the stack, first on top, with their parts of a path: where several share a name, the second
/// is `name[2]` and so on.
fn push_siblings(
    root: &json::Root,
    nodes: &[usize],
    parent: Option<usize>,
    todo: &mut Vec<(usize, Option<usize>, String)>,
) {
    let own_name = |node: usize| match root.nodes[node].name.as_deref() {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => format!("node[{node}]"),
    };
    let mut taken: HashSet<String> = nodes.iter().map(|&node| own_name(node)).collect();
    let mut met: HashMap<String, u64> = HashMap::new();
    let start = todo.len();
    for &node in nodes {
        let name = own_name(node);
        let count = met.entry(name.clone()).or_insert(0);
        *count += 1;
        let mut segment = name.clone();
        if *count > 1 {
            // A sibling may really be called `name[2]`.
            loop {
                segment = format!("{name}[{count}]");
                if taken.insert(segment.clone()) {
                    break;
                }
                *count += 1;
            }
        }
        todo.push((node, parent, segment));
    }
    todo[start..].reverse();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::document::parse;
    use crate::limits::Limits;

    fn walk_text(fields: &str) -> Result<Vec<String>, ImportError> {
        let text = format!(r#"{{"asset":{{"version":"2.0"}},{fields}}}"#);
        let mut budget = Budget::new(&Limits::default());
        let (document, placements) = parse(text.as_bytes(), &mut budget)?;
        let graph = walk(document.as_json(), &placements, &mut budget)?;
        Ok((0..graph.visits.len()).map(|visit| graph.path(visit)).collect())
    }

    #[test]
    fn the_default_scene_is_shown_else_the_first_else_all_roots() {
        let nodes = r#""nodes":[{"name":"a"},{"name":"b","children":[2]},{"name":"c"}]"#;
        let scenes = r#""scenes":[{"nodes":[0]},{"nodes":[1]}]"#;
        assert_eq!(walk_text(&format!(r#"{nodes},{scenes},"scene":1"#)).unwrap(), ["b", "b/c"]);
        assert_eq!(walk_text(&format!("{nodes},{scenes}")).unwrap(), ["a"]);
        assert_eq!(walk_text(nodes).unwrap(), ["a", "b", "b/c"]);
    }

    #[test]
    fn siblings_of_one_name_are_numbered() {
        let names = [r#""a""#, r#""a""#, r#""a[2]""#, r#""a""#, r#""""#, r#""Ü""#];
        let nodes: Vec<String> = names.iter().map(|name| format!(r#"{{"name":{name}}}"#)).collect();
        let fields = format!(r#""nodes":[{},{{}}]"#, nodes.join(","));
        let paths = walk_text(&fields).unwrap();
        assert_eq!(paths, ["a", "a[3]", "a[2]", "a[4]", "node[4]", "Ü", "node[6]"]);
    }

    #[test]
    fn cycles_and_second_parents_are_errors_that_name_the_node() {
        let cases = [
            (
                r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"name":"x","children":[0]}]"#,
                "nodes[0]",
            ),
            (r#""scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]"#, "nodes[0]"),
            (r#""nodes":[{},{"children":[2]},{"children":[1]}]"#, "nodes[1]"),
            (r#""nodes":[{"children":[2]},{"children":[2]},{}]"#, "nodes[2]"),
            (r#""nodes":[{"children":[1,1]},{}]"#, "nodes[1]"),
            (r#""scenes":[{"nodes":[0,0]}],"nodes":[{}]"#, "nodes[0]"),
            (r#""nodes":[{"rotation":[0,0,0,0]}]"#, "nodes[0]"),
            (r#""nodes":[{"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]"#, "nodes[0]"),
        ];
        for (fields, place) in cases {
            assert_eq!(walk_text(fields).unwrap_err().place, place, "{fields}");
        }
    }

    #[test]
    fn a_chain_of_a_million_nodes_is_an_error_and_no_overflow() {
        let nodes: Vec<String> = (1..1_000_000).map(|child| format!(r#"{{"children":[{child}]}}"#)).collect();
        let error = walk_text(&format!(r#""nodes":[{},{{}}]"#, nodes.join(","))).unwrap_err();
        assert_eq!(error.place, "nodes[1025]");
    }

    #[test]
    fn transforms_that_overflow_name_the_node() {
        let node = |i: u32| format!(r#"{{"scale":[1e38,1,1],"children":[{}]}}"#, i + 1);
        let nodes: Vec<String> = (0..12).map(node).collect();
        // 1e38 to the ninth is over what f64 holds.
        let error = walk_text(&format!(r#""nodes":[{},{{}}]"#, nodes.join(","))).unwrap_err();
        assert_eq!(error.place, "nodes[8]", "{error}");
    }
}
