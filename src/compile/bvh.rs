//! The hierarchy of boxes around detail triangles: built by `obvhs` two children wide, made eight wide here.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;

use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::format::{MAX_DEPTH, Tables};
use crate::trace::NONE;

/// Nodes and leaves of one hierarchy; node 0 is the root, or if there is none leaf 0. A child with [`Leaf::BIT`] is the leaf of that number.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hierarchy {
    pub(super) nodes: Vec<NodeRecord>,
    /// Triangles of each leaf, one to eight.
    pub(super) leaves: Vec<Vec<u32>>,
    /// Longest chain of nodes.
    pub(super) depth: u32,
}

impl Hierarchy {
    /// Adds it to a scene's tables, `ids` being the scene's triangles that it was built over. Returns its root, [`NONE`] if
    /// it is empty.
    pub(super) fn append(self, ids: &[u32], tables: &mut Tables) -> u32 {
        let nodes = tables.nodes.len() as u32;
        let leaf = |triangles: Vec<u32>| tables.leaf(triangles.into_iter().map(|t| ids[t as usize]));
        let links: Vec<u32> = self.leaves.into_iter().map(leaf).collect();
        let root = if self.nodes.is_empty() { links.first().copied().unwrap_or(NONE) } else { nodes };
        tables.nodes.extend(self.nodes.into_iter().map(|mut node| {
            node.child.iter_mut().filter(|link| **link != NONE).for_each(|child| {
                *child = if *child & Leaf::BIT != 0 {
                    links[(*child & !Leaf::BIT) as usize]
                } else {
                    *child + nodes
                };
            });
            node
        }));
        root
    }
}

/// The slack of the f32 kernels, metres, for coordinates up to `radius` from the center and rays up to `diameter` long.
///
/// One rounding of a coordinate, a difference or a product is off by at most 2^-24 of it; a determinant of the triangle
/// test adds some twenty of them, and the box test fewer. 2^-19 is thirty-two.
pub(super) fn slack(radius: f64, diameter: f64) -> f32 {
    ((radius + diameter) * (-19f64).exp2()) as f32
}

/// The hierarchy over triangles given by their corners, boxes relative to `center`.
pub(super) fn build(triangles: &[[[f64; 3]; 3]], center: [f64; 3], slack: f32) -> Hierarchy {
    if triangles.is_empty() {
        return Hierarchy::default();
    }
    let center = DVec3::from(center);
    if triangles.len() <= LANES {
        let leaves = vec![(0..triangles.len() as u32).collect()];
        return Hierarchy { leaves, ..Hierarchy::default() };
    }
    let corners = |t: usize| triangles[t].map(|p| (DVec3::from(p) - center).as_vec3a());
    let rounded: Vec<Triangle> = (0..triangles.len())
        .map(|t| {
            let [v0, v1, v2] = corners(t);
            Triangle { v0, v1, v2 }
        })
        .collect();
    let binary = binary(&rounded);
    let mut hierarchy = Collapse { binary: &binary, slack, out: Hierarchy::default() }.run();
    if hierarchy.depth > MAX_DEPTH {
        // Only triangles laid out to spoil it nest so deeply: halves of a sorted list never do.
        let binary = halves(&rounded);
        hierarchy = Collapse { binary: &binary, slack, out: Hierarchy::default() }.run();
    }
    hierarchy
}

/// A binary tree of good quality: large triangles split beforehand, clustered (PLOC), improved by reinsertion. The steps
/// are those of `obvhs`' own medium build, one by one, because that one panics in debug builds on deep trees.
fn binary(triangles: &[Triangle]) -> Bvh2 {
    let mut boxes: Vec<Aabb> = triangles.iter().map(Triangle::aabb).collect();
    let mut indices: Vec<u32> = (0..triangles.len() as u32).collect();
    let areas = boxes.iter().map(Aabb::half_area);
    let largest = areas.clone().fold(0.0, f32::max);
    let average = areas.sum::<f32>() / triangles.len() as f32;
    split_aabbs_preset(&mut boxes, &mut indices, triangles, average, largest);
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let mut tree = builder.build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 3);
    if tree.depth(0) > DEEPEST_BINARY {
        return halves(triangles);
    }
    tree.uses_spatial_splits = true;
    ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    tree
}

/// Beyond this the clusters have gone wrong: triangles laid out to spoil them.
const DEEPEST_BINARY: usize = 96;

/// Share of the nodes that are tried at other places of the tree.
const REINSERTED: f32 = 0.05;

struct Collapse<'a> {
    binary: &'a Bvh2,
    slack: f32,
    out: Hierarchy,
}

/// What a visit of a node costs, beside what a visit of a leaf does.
const NODE_COST: f32 = 1.0;
const LEAF_COST: f32 = 1.0;

/// For one node of the binary tree.
#[derive(Clone, Copy, Default)]
struct Plan {
    /// Triangles below it, up to what matters.
    count: u32,
    /// `cost[i]`: the least expected cost of what hangs below it as at most `i + 1` children of a wide node.
    cost: [f32; LANES],
    /// How many of those children come from its first half; 0 to make do with one child less.
    first: [u8; LANES],
    /// The same for its own eight children, if it becomes a wide node.
    own: u8,
}

impl Collapse<'_> {
    fn run(mut self) -> Hierarchy {
        let plans = self.plan();
        // (node of the binary tree, index of the wide node that it becomes, its depth)
        let mut todo = vec![(0u32, 0u32, 1u32)];
        self.out.nodes.push(NodeRecord::EMPTY);
        while let Some((root, index, depth)) = todo.pop() {
            self.out.depth = self.out.depth.max(depth);
            for (lane, child) in self.children(root, &plans).into_iter().enumerate() {
                let bounds = self.binary.nodes[child as usize].aabb;
                let link = if plans[child as usize].count as usize <= LANES {
                    self.leaf(child)
                } else {
                    self.out.nodes.push(NodeRecord::EMPTY);
                    let next = self.out.nodes.len() as u32 - 1;
                    todo.push((child, next, depth + 1));
                    next
                };
                let bounds = [bounds.min.to_array(), bounds.max.to_array()];
                self.out.nodes[index as usize].put(lane, link, bounds, self.slack);
            }
        }
        self.out
    }

    /// Which nodes of the binary tree become wide nodes and which leaves, so that the expected cost of a random ray is
    /// least: by dynamic programming from the leaves up (Ylitie, Karras, Laine, Efficient Incoherent Ray Traversal on
    /// GPUs Through Compressed Wide BVHs, HPG 2017, section 3.2).
    fn plan(&self) -> Vec<Plan> {
        let mut plans = vec![Plan::default(); self.binary.nodes.len()];
        let mut order = vec![0u32];
        let mut next = 0;
        while next < order.len() {
            let node = &self.binary.nodes[order[next] as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
            next += 1;
        }
        for &i in order.iter().rev() {
            let node = &self.binary.nodes[i as usize];
            let area = node.aabb.half_area();
            let mut plan = Plan::default();
            if node.is_leaf() {
                plan.count = node.prim_count;
                plan.cost = [area * LEAF_COST; LANES];
            } else {
                let first = node.first_index as usize;
                let (one, two) = (&plans[first], &plans[first + 1]);
                plan.count = one.count.saturating_add(two.count);
                // The least cost of `children` children, and how many of them the first half gets.
                let split = |children: usize| {
                    let costs =
                        (1..children).map(|k| (one.cost[k - 1] + two.cost[children - k - 1], k as u8));
                    costs.reduce(|best, this| if this.0 < best.0 { this } else { best }).unwrap_or_default()
                };
                let (own, of_own) = split(LANES);
                plan.own = of_own;
                let is_leaf = plan.count as usize <= LANES;
                plan.cost[0] = if is_leaf { area * LEAF_COST } else { area * NODE_COST + own };
                for children in 2..=LANES {
                    let (cost, first) = split(children);
                    let fewer = plan.cost[children - 2];
                    (plan.cost[children - 1], plan.first[children - 1]) =
                        if cost < fewer { (cost, first) } else { (fewer, 0) };
                }
            }
            plans[i as usize] = plan;
        }
        plans
    }

    /// Up to eight nodes of the binary tree that replace `root`.
    fn children(&self, root: u32, plans: &[Plan]) -> Vec<u32> {
        if plans[root as usize].count as usize <= LANES {
            return vec![root];
        }
        let mut children = Vec::with_capacity(LANES);
        let halves = |node: u32, all: usize, first: u8| {
            let index = self.binary.nodes[node as usize].first_index;
            [(index + 1, all - first as usize), (index, first as usize)]
        };
        let mut todo = Vec::from(halves(root, LANES, plans[root as usize].own));
        while let Some((node, all)) = todo.pop() {
            let first = plans[node as usize].first[all - 1];
            match (all, first) {
                (1, _) => children.push(node),
                (_, 0) => todo.push((node, all - 1)),
                _ => todo.extend(halves(node, all, first)),
            }
        }
        children
    }

    /// A leaf of all triangles below a node.
    fn leaf(&mut self, root: u32) -> u32 {
        let mut members = Vec::with_capacity(LANES);
        let mut todo = vec![root];
        while let Some(i) = todo.pop() {
            let node = &self.binary.nodes[i as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                members.extend_from_slice(
                    &self.binary.primitive_indices[first..first + node.prim_count as usize],
                );
            } else {
                todo.extend([node.first_index + 1, node.first_index]);
            }
        }
        members.sort_unstable();
        // A triangle that was split may have come together again.
        members.dedup();
        self.out.leaves.push(members);
        (self.out.leaves.len() as u32 - 1) | Leaf::BIT
    }
}

/// A binary tree of halves along the longest axis: never deeper than the logarithm of the number of triangles.
fn halves(triangles: &[Triangle]) -> Bvh2 {
    use obvhs::bvh2::node::Bvh2Node;
    let boxes: Vec<Aabb> = triangles.iter().map(Triangle::aabb).collect();
    let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
    let around = |part: &[u32]| part.iter().fold(Aabb::INVALID, |all, &t| all.union(&boxes[t as usize]));
    let mut nodes = vec![Bvh2Node::new(around(&order), 0, 0)];
    let mut todo = vec![(0usize, 0usize, order.len())];
    while let Some((index, start, end)) = todo.pop() {
        let bounds = nodes[index].aabb;
        if end - start == 1 {
            nodes[index] = Bvh2Node::new(bounds, 1, start as u32);
            continue;
        }
        let size: Vec3A = bounds.diagonal();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let middle = (start + end) / 2;
        order[start..end].sort_by(|&a, &b| {
            boxes[a as usize].center()[axis].total_cmp(&boxes[b as usize].center()[axis]).then(a.cmp(&b))
        });
        let first = nodes.len();
        nodes.push(Bvh2Node::new(around(&order[start..middle]), 0, 0));
        nodes.push(Bvh2Node::new(around(&order[middle..end]), 0, 0));
        nodes[index] = Bvh2Node::new(bounds, 0, first as u32);
        todo.extend([(first, start, middle), (first + 1, middle, end)]);
    }
    Bvh2 { nodes, primitive_indices: order, ..Bvh2::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_laid_out_to_nest_stay_shallow() {
        // Each triangle three times the size of the last, all from one corner.
        let triangles: Vec<[[f64; 3]; 3]> = (0..4000)
            .map(|i| {
                let size = 1e-6 * 1.02f64.powi(i % 1500) * 3f64.powi(i % 7);
                [[0.0; 3], [size, 0.0, 0.0], [0.0, size, f64::from(i) * 1e-9]]
            })
            .collect();
        let hierarchy = build(&triangles, [0.0; 3], 1e-6);
        assert!(hierarchy.depth <= MAX_DEPTH, "{}", hierarchy.depth);
        let rounded: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.map(|p| DVec3::from(p).as_vec3a());
                Triangle { v0, v1, v2 }
            })
            .collect();
        let binary = halves(&rounded);
        let shallow = Collapse { binary: &binary, slack: 1e-6, out: Hierarchy::default() };
        assert!(shallow.run().depth <= 12);
    }

    #[test]
    fn every_triangle_is_in_a_leaf_and_every_box_holds_its_triangles() {
        let triangles: Vec<[[f64; 3]; 3]> = (0..500)
            .map(|i| {
                let at = |k: i32| f64::from((i * 7919 + k * 104_729) % 1000) / 10.0;
                [[at(0), at(1), at(2)], [at(3), at(1), at(2)], [at(0), at(4), at(5)]]
            })
            .collect();
        let hierarchy = build(&triangles, [50.0; 3], 1e-4);
        let mut found = vec![false; triangles.len()];
        for &triangle in hierarchy.leaves.iter().flatten() {
            found[triangle as usize] = true;
        }
        assert!(found.iter().all(|&f| f));
    }
}
