//! The hierarchy of boxes around detail triangles: built by `obvhs` two children wide, made eight wide here.

use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::splits::split_aabbs_precise;
use obvhs::triangle::Triangle;

use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::format::{MAX_DEPTH, Tables};
use crate::trace::NONE;

/// Nodes and leaves of one hierarchy; node 0 is the root, or if there is none leaf 0. A child with [`Leaf::BIT`] is the leaf of that number, one with
/// [`SUBTREE`] the hierarchy of that number among those that it was built over.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hierarchy {
    pub(super) nodes: Vec<NodeRecord>,
    /// Triangles of each leaf, one to eight.
    pub(super) leaves: Vec<Vec<u32>>,
    /// Longest chain of nodes.
    pub(super) depth: u32,
    /// What a ray is expected to pay for it, beside others over the same.
    cost: f32,
}

/// Whether a hierarchy may be built over parts of triangles ([`parts_of`]): it can take [`MOST_PARTS`] times the memory, besides that for one over
/// whole ones, beside which its cost is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TriangleSplits {
    None,
    Parts,
}

impl TriangleSplits {
    /// Bytes that hierarchies of so many triangles take at most, for each, while they are built.
    pub(super) fn bytes_each(self) -> usize {
        let boxes = match self {
            TriangleSplits::None => 1,
            TriangleSplits::Parts => 1 + MOST_PARTS,
        };
        // Building one, a leaf of its own, and at most a node for four boxes.
        boxes * (2 * 160 + 32 + size_of::<NodeRecord>() / 4)
    }
}

/// The bit of a child that is another hierarchy.
const SUBTREE: u32 = 1 << 30;

/// Another hierarchy, or a leaf, as a part of one that is built over it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// A box around it, relative to the scene's center.
    bounds: [[f32; 3]; 2],
    /// Its longest chain of nodes.
    depth: u32,
}

impl Hierarchy {
    /// It as a part of another, built over these triangles with this slack around them; `None` if it is empty.
    pub(super) fn part(&self, triangles: &[[[f64; 3]; 3]], center: [f64; 3], slack: f32) -> Option<Part> {
        let around = |all: Option<[[f32; 3]; 2]>, [lo, hi]: [[f32; 3]; 2]| match all {
            Some(all) => {
                Some([[0, 1, 2].map(|i| all[0][i].min(lo[i])), [0, 1, 2].map(|i| all[1][i].max(hi[i]))])
            }
            None => Some([lo, hi]),
        };
        let bounds = match self.nodes.first() {
            Some(root) => (0..LANES)
                .filter(|&lane| root.child[lane] != NONE)
                .map(|lane| [root.lo.map(|axis| axis[lane]), root.hi.map(|axis| axis[lane])])
                .fold(None, around),
            None => {
                let corners = self.leaves.iter().flatten().flat_map(|&t| triangles[t as usize]);
                let local = corners.map(|p| (DVec3::from(p) - DVec3::from(center)).as_vec3().to_array());
                local.map(|p| [p.map(|c| c - slack), p.map(|c| c + slack)]).fold(None, around)
            }
        };
        bounds.map(|bounds| Part { bounds, depth: self.depth })
    }

    /// Gives its parts their roots in the scene's tables, to which it was added when there were `nodes` nodes.
    pub(super) fn link(count: usize, nodes: u32, roots: &[u32], tables: &mut Tables) {
        let own = &mut tables.nodes[nodes as usize..nodes as usize + count];
        for child in own.iter_mut().flat_map(|node| &mut node.child) {
            if *child != NONE && *child & (Leaf::BIT | SUBTREE) == SUBTREE {
                *child = roots[(*child & !SUBTREE) as usize];
            }
        }
    }

    /// Adds it to a scene's tables, `ids` being the scene's triangles that it was built over. Returns its root, [`NONE`] if
    /// it is empty. Its parts have no roots yet.
    pub(super) fn append(self, ids: &[u32], tables: &mut Tables) -> u32 {
        let nodes = tables.nodes.len() as u32;
        let links = tables.add_leaves(self.leaves.iter().map(|leaf| leaf.iter().map(|&t| ids[t as usize])));
        let root = if self.nodes.is_empty() { links.first().copied().unwrap_or(NONE) } else { nodes };
        tables.nodes.extend(self.nodes.into_iter().map(|mut node| {
            node.child.iter_mut().filter(|link| **link != NONE).for_each(|child| {
                *child = match *child {
                    leaf if leaf & Leaf::BIT != 0 => links[(leaf & !Leaf::BIT) as usize],
                    part if part & SUBTREE != 0 => part,
                    node => node + nodes,
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

/// The hierarchy over triangles given by their corners, and over other hierarchies, boxes relative to `center`. `None` if it would be nested too
/// deeply: never without `parts`.
pub(super) fn build_over(
    triangles: &[[[f64; 3]; 3]],
    parts: &[Part],
    center: [f64; 3],
    slack: f32,
    splits: TriangleSplits,
) -> Option<Hierarchy> {
    build_with(triangles, parts, center, slack, splits, REINSERTED)
}

fn build_with(
    triangles: &[[[f64; 3]; 3]],
    parts: &[Part],
    center: [f64; 3],
    slack: f32,
    splits: TriangleSplits,
    reinserted: f32,
) -> Option<Hierarchy> {
    let below = parts.iter().map(|part| part.depth).max().unwrap_or(0);
    let mut hierarchy = if parts.is_empty() {
        build(triangles, center, slack, splits)
    } else if triangles.len() + parts.len() <= LANES {
        few(triangles, parts, center, slack)
    } else {
        // What is in no other hierarchy is mostly walls and what is outside, large and often oblique.
        let rounded = rounded(triangles, center);
        let boxes = match splits {
            TriangleSplits::None => whole(&rounded),
            TriangleSplits::Parts => parts_of(&rounded),
        };
        let binary = binary(&rounded, boxes, parts, reinserted);
        Collapse { binary: &binary, triangles: triangles.len() as u32, slack, out: Hierarchy::default() }
            .run()
    };
    hierarchy.depth += below;
    (hierarchy.depth <= MAX_DEPTH).then_some(hierarchy)
}

/// The nodes of a hierarchy over boxes by themselves, relative to the scene's center: each child is a node, or with [`Leaf::BIT`] a box. `None` if it would
/// be nested too deeply.
#[cfg(feature = "render")]
pub(crate) fn over_boxes(bounds: &[[[f32; 3]; 2]]) -> Option<Vec<NodeRecord>> {
    let parts: Vec<Part> = bounds.iter().map(|&bounds| Part { bounds, depth: 0 }).collect();
    let mut nodes = build_with(&[], &parts, [0.0; 3], 0.0, TriangleSplits::None, FEW_REINSERTED)?.nodes;
    for child in nodes.iter_mut().flat_map(|node| &mut node.child) {
        if *child != NONE && *child & (Leaf::BIT | SUBTREE) == SUBTREE {
            *child = *child & !SUBTREE | Leaf::BIT;
        }
    }
    Some(nodes)
}

/// One node over few triangles and parts, eight together at most.
fn few(triangles: &[[[f64; 3]; 3]], parts: &[Part], center: [f64; 3], slack: f32) -> Hierarchy {
    let mut node = NodeRecord::EMPTY;
    let mut leaves = Vec::new();
    for (lane, part) in parts.iter().enumerate() {
        node.put(lane, SUBTREE | lane as u32, part.bounds, slack);
    }
    if !triangles.is_empty() {
        let together = rounded(triangles, center).iter().fold(Aabb::INVALID, |all, t| all.union(&t.aabb()));
        let bounds = [together.min.to_array(), together.max.to_array()];
        node.put(parts.len(), Leaf::BIT, bounds, slack);
        leaves.push((0..triangles.len() as u32).collect());
    }
    Hierarchy { nodes: vec![node], leaves, depth: 1, cost: 0.0 }
}

fn rounded(triangles: &[[[f64; 3]; 3]], center: [f64; 3]) -> Vec<Triangle> {
    let center = DVec3::from(center);
    let triangle = |corners: &[[f64; 3]; 3]| {
        let [v0, v1, v2] = corners.map(|p| (DVec3::from(p) - center).as_vec3a());
        Triangle { v0, v1, v2 }
    };
    triangles.iter().map(triangle).collect()
}

/// The hierarchy over triangles given by their corners, boxes relative to `center`.
pub(super) fn build(
    triangles: &[[[f64; 3]; 3]],
    center: [f64; 3],
    slack: f32,
    splits: TriangleSplits,
) -> Hierarchy {
    if triangles.is_empty() {
        return Hierarchy::default();
    }
    if triangles.len() <= LANES {
        let leaves = vec![(0..triangles.len() as u32).collect()];
        return Hierarchy { leaves, ..Hierarchy::default() };
    }
    let rounded = rounded(triangles, center);
    let count = triangles.len() as u32;
    let collapse =
        |binary: &Bvh2| Collapse { binary, triangles: count, slack, out: Hierarchy::default() }.run();
    let mut hierarchy = collapse(&binary(&rounded, whole(&rounded), &[], REINSERTED));
    let split = (splits == TriangleSplits::Parts).then(|| parts_of(&rounded));
    if let Some(split) = split.filter(|split| split.0.len() > triangles.len()) {
        let of_parts = collapse(&binary(&rounded, split, &[], REINSERTED));
        if of_parts.cost < WORTH * hierarchy.cost {
            hierarchy = of_parts;
        }
    }
    if hierarchy.depth > MAX_DEPTH {
        // Only triangles laid out to spoil it nest so deeply: halves of a sorted list never do.
        hierarchy = collapse(&halves(&boxes_of(&rounded, &[])));
    }
    hierarchy
}

/// Boxes, each with the number of what it is around.
type Boxes = (Vec<Aabb>, Vec<u32>);

/// Those around triangles.
fn whole(triangles: &[Triangle]) -> Boxes {
    (triangles.iter().map(Triangle::aabb).collect(), (0..triangles.len() as u32).collect())
}

/// The same, large triangles with several around parts of them, where those are smaller together: of one that runs aslant through its box most of that
/// is empty. The boxes of the triangles come first. There are at most [`MOST_PARTS`] for each triangle.
fn parts_of(triangles: &[Triangle]) -> Boxes {
    /// Smaller than so many times the average they stay whole; the next, should that make too many parts.
    const SMALL: [f32; 3] = [0.5, 2.0, 8.0];
    /// Two parts have so many times less than the whole: so there is an end of it, of six parts a triangle at most with the least of `SMALL`.
    const LESS: f32 = 1.5;
    /// How often each part is looked at, and at how many places.
    const ROUNDS: u32 = 12;
    const PLACES: u32 = 12;
    let (boxes, indices) = whole(triangles);
    let average = boxes.iter().map(Aabb::half_area).sum::<f32>() / boxes.len().max(1) as f32;
    for small in SMALL.map(|small| average * small) {
        let (mut boxes, mut indices) = (boxes.clone(), indices.clone());
        split_aabbs_precise(&mut boxes, &mut indices, triangles, small, small, LESS, LESS, ROUNDS, PLACES);
        if boxes.len() <= MOST_PARTS * triangles.len() {
            return (boxes, indices);
        }
    }
    (boxes, indices)
}

/// See [`parts_of`].
const MOST_PARTS: usize = 2;

/// A hierarchy over parts of triangles is taken where it is expected to cost so many times what one over whole triangles does, or less: in buildings with
/// round and oblique things rays look at a third fewer blocks for it, in others it is but larger.
const WORTH: f32 = 0.97;

/// A binary tree of good quality: clustered (PLOC), improved by reinsertion. The steps are those of `obvhs`' own medium build, one by one, because that
/// one panics in debug builds on deep trees. The numbers of parts follow those of the triangles.
fn binary(triangles: &[Triangle], (mut boxes, mut indices): Boxes, parts: &[Part], reinserted: f32) -> Bvh2 {
    // Between the triangles and what they were split into besides: `obvhs` takes a leaf's number for its place among the indices.
    let whole = triangles.len();
    boxes.splice(whole..whole, boxes_of(&[], parts));
    indices.splice(whole..whole, whole as u32..(whole + parts.len()) as u32);
    let mut builder = PlocBuilder::with_capacity(boxes.len());
    let mut tree = builder.build(PlocSearchDistance::Medium, &boxes, indices, SortPrecision::U64, 3);
    if tree.depth(0) > DEEPEST_BINARY {
        return halves(&boxes_of(triangles, parts));
    }
    tree.uses_spatial_splits = true;
    let share = (SMALL_TREE / boxes.len() as f32).min(reinserted).max(FEW_REINSERTED);
    ReinsertionOptimizer::default().run(&mut tree, share, None);
    tree
}

/// Beyond this the clusters have gone wrong: triangles laid out to spoil them.
const DEEPEST_BINARY: usize = 96;

/// Share of the nodes that are tried at other places of the tree: of a small one in a file, where rays open an eighth fewer nodes of furnished rooms for
/// that than with `FEW_REINSERTED`; and of one that is made while somebody waits for a picture.
const REINSERTED: f32 = 1.0;
const FEW_REINSERTED: f32 = 0.05;

/// In trees over more boxes than this fewer nodes are tried: where all lie in each other, all places are looked at for each.
const SMALL_TREE: f32 = 4096.0;

struct Collapse<'a> {
    binary: &'a Bvh2,
    /// How many of what it was built over are triangles: the first. The others are parts.
    triangles: u32,
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
        self.out.cost = plans.first().map_or(0.0, |root| root.cost[0]);
        // (node of the binary tree, index of the wide node that it becomes, its depth)
        let mut todo = vec![(0u32, 0u32, 1u32)];
        self.out.nodes.push(NodeRecord::EMPTY);
        while let Some((root, index, depth)) = todo.pop() {
            self.out.depth = self.out.depth.max(depth);
            for (lane, child) in self.children(root, &plans).into_iter().enumerate() {
                let bounds = self.binary.nodes[child as usize].aabb;
                let link = if let Some(part) = self.part(child) {
                    SUBTREE | part
                } else if plans[child as usize].count as usize <= LANES {
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
                // A part is never in a leaf with others.
                plan.count = if self.part(i).is_some() { LANES as u32 + 1 } else { node.prim_count };
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

    /// The part that a leaf of the binary tree is.
    fn part(&self, node: u32) -> Option<u32> {
        let node = &self.binary.nodes[node as usize];
        let is_one = node.is_leaf() && node.prim_count == 1;
        is_one
            .then(|| self.binary.primitive_indices[node.first_index as usize].checked_sub(self.triangles))?
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

/// Boxes around triangles, then those around parts.
fn boxes_of(triangles: &[Triangle], parts: &[Part]) -> Vec<Aabb> {
    let of_part = |Part { bounds: [lo, hi], .. }: &Part| Aabb { min: (*lo).into(), max: (*hi).into() };
    triangles.iter().map(Triangle::aabb).chain(parts.iter().map(of_part)).collect()
}

/// A binary tree of halves along the longest axis: never deeper than the logarithm of the number of triangles.
fn halves(boxes: &[Aabb]) -> Bvh2 {
    use obvhs::bvh2::node::Bvh2Node;
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
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
    use crate::samples::Sample;

    #[test]
    fn triangles_laid_out_to_nest_stay_shallow() {
        // Each triangle three times the size of the last, all from one corner.
        let triangles: Vec<[[f64; 3]; 3]> = (0..4000)
            .map(|i| {
                let size = 1e-6 * 1.02f64.powi(i % 1500) * 3f64.powi(i % 7);
                [[0.0; 3], [size, 0.0, 0.0], [0.0, size, f64::from(i) * 1e-9]]
            })
            .collect();
        let hierarchy = build(&triangles, [0.0; 3], 1e-6, TriangleSplits::Parts);
        assert!(hierarchy.depth <= MAX_DEPTH, "{}", hierarchy.depth);
        let rounded: Vec<Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.map(|p| DVec3::from(p).as_vec3a());
                Triangle { v0, v1, v2 }
            })
            .collect();
        let binary = halves(&boxes_of(&rounded, &[]));
        let shallow = Collapse {
            binary: &binary,
            triangles: triangles.len() as u32,
            slack: 1e-6,
            out: Hierarchy::default(),
        };
        assert!(shallow.run().depth <= 12);
    }

    /// Long and thin ones, beside many small ones: parts are taken, few of them; of what lies along the axes none are.
    #[test]
    fn triangles_that_run_aslant_are_taken_in_parts() {
        let mut triangles: Vec<[[f64; 3]; 3]> = (0..300)
            .map(|i| {
                let at = f64::from(i) * 0.2;
                let end = [at + 9.0, 9.0 - at, 3.0];
                [[at, -at, 0.0], end, [end[0], end[1] + 0.1, end[2]]]
            })
            .collect();
        triangles.extend((0..3000).map(|i| {
            let at = f64::from(i) * 0.01;
            [[at, 0.0, 0.0], [at + 0.01, 0.0, 0.0], [at, 0.01, 0.0]]
        }));
        let rounded = rounded(&triangles, [0.0; 3]);
        let parts = parts_of(&rounded);
        assert!(parts.0.len() > 2 * 300 + 3000 && parts.0.len() <= MOST_PARTS * 3300, "{}", parts.0.len());
        assert!(parts.1[..3300].iter().copied().eq(0..3300));
        let collapse = |binary: &Bvh2| {
            Collapse { binary, triangles: 3300, slack: 1e-5, out: Hierarchy::default() }.run().cost
        };
        let whole = collapse(&binary(&rounded, whole(&rounded), &[], REINSERTED));
        let built = build(&triangles, [0.0; 3], 1e-5, TriangleSplits::Parts);
        let unsplit = build(&triangles, [0.0; 3], 1e-5, TriangleSplits::None);
        assert_eq!((unsplit.cost, unsplit.leaves.iter().flatten().count()), (whole, 3300));
        assert!(built.cost < 0.9 * whole, "{} of {whole}", built.cost);
        let mut found: Vec<u32> = built.leaves.iter().flatten().copied().collect();
        assert!(found.len() > triangles.len());
        found.sort_unstable();
        found.dedup();
        assert!(found.into_iter().eq(0..3300));
        let small = &rounded[300..];
        assert_eq!(parts_of(small).0.len(), small.len());
    }

    #[test]
    fn every_triangle_is_in_a_leaf_and_every_box_holds_its_triangles() {
        let triangles: Vec<[[f64; 3]; 3]> = (0..500)
            .map(|i| {
                let at = |k: i32| f64::from((i * 7919 + k * 104_729) % 1000) / 10.0;
                [[at(0), at(1), at(2)], [at(3), at(1), at(2)], [at(0), at(4), at(5)]]
            })
            .collect();
        let hierarchy = build(&triangles, [50.0; 3], 1e-4, TriangleSplits::Parts);
        let mut found = vec![false; triangles.len()];
        for &triangle in hierarchy.leaves.iter().flatten() {
            found[triangle as usize] = true;
        }
        assert!(found.iter().all(|&f| f));
    }

    /// The triangles under a link, each inside of the boxes on the way.
    fn under(
        nodes: &[NodeRecord],
        leaves: &[u32],
        link: u32,
        bounds: [[f32; 3]; 2],
        corners: &dyn Fn(u32) -> [[f32; 3]; 3],
        found: &mut Vec<u32>,
    ) {
        let [lo, hi] = bounds;
        if link & Leaf::BIT != 0 {
            let leaf = Leaf::new(link);
            for &triangle in &leaves[leaf.first()..leaf.first() + leaf.count()] {
                let corners = corners(triangle);
                // Of a triangle that was split no part is beside its box.
                let meets =
                    |i: usize| corners.iter().any(|p| p[i] <= hi[i]) && corners.iter().any(|p| p[i] >= lo[i]);
                assert!((0..3).all(meets), "triangle {triangle}");
                found.push(triangle);
            }
            return;
        }
        let node = &nodes[link as usize];
        for lane in (0..LANES).filter(|&lane| node.child[lane] != NONE) {
            let child = node.child[lane];
            assert!(child & Leaf::BIT != 0 || child > link, "nodes come before what is below them");
            let own = [node.lo.map(|axis| axis[lane]), node.hi.map(|axis| axis[lane])];
            assert!((0..3).all(|i| own[0][i] <= hi[i] && own[1][i] >= lo[i]), "a box beside its parent's");
            under(nodes, leaves, child, own, corners, found);
        }
    }

    const EVERYWHERE: [[f32; 3]; 2] = [[f32::MIN; 3], [f32::MAX; 3]];

    #[test]
    fn all_triangles_are_under_the_root_of_a_scenes_first_cell() {
        for scene in [Sample::House.scene(), Sample::Build1.scene()] {
            let tables = &scene.tables;
            let center = DVec3::from(tables.scene[0].center);
            let corners = |t: u32| scene.triangle(t).map(|p| (DVec3::from(p) - center).as_vec3().to_array());
            let mut found = Vec::new();
            under(&tables.nodes, &tables.leaves, tables.cells[0].root, EVERYWHERE, &corners, &mut found);
            found.sort_unstable();
            found.dedup();
            assert!(found.iter().copied().eq(0..scene.detail_triangle_count()));
        }
    }

    #[test]
    fn hierarchies_over_others_hold_all_that_those_hold() {
        let all: Vec<[[f64; 3]; 3]> = (0..900)
            .map(|i| {
                let at = |k: i32| f64::from((i * 7919 + k * 104_729) % 1000) / 10.0;
                // Some so large that they are split.
                let size = if i % 50 == 49 { 60.0 } else { 1.0 };
                [
                    [at(0), at(1), at(2)],
                    [at(0) + 2.0 * size, at(1), at(2)],
                    [at(0), at(1) + size, at(2) + size],
                ]
            })
            .collect();
        // Groups of these many triangles each as a hierarchy of its own; the rest is the upper one's.
        for groups in
            [vec![300, 5, 1, 40], vec![1, 1], vec![2; 7], vec![900], vec![898], vec![3; 100], vec![895, 1]]
        {
            let (mut first, mut built) = (0, Vec::new());
            for count in &groups {
                let ids: Vec<u32> = (first..first + count).collect();
                let own: Vec<_> = ids.iter().map(|&t| all[t as usize]).collect();
                let hierarchy = build(&own, [50.0; 3], 1e-4, TriangleSplits::Parts);
                let part = hierarchy.part(&own, [50.0; 3], 1e-4).unwrap();
                built.push((hierarchy, part, ids));
                first += count;
            }
            let rest: Vec<u32> = (first..if groups == [1, 1] { first + 3 } else { 900 }).collect();
            let own: Vec<_> = rest.iter().map(|&t| all[t as usize]).collect();
            let parts: Vec<Part> = built.iter().map(|(_, part, _)| *part).collect();
            let over = build_over(&own, &parts, [50.0; 3], 1e-4, TriangleSplits::Parts).unwrap();
            let (count, depth) = (over.nodes.len(), over.depth);
            assert!(depth > parts.iter().map(|part| part.depth).max().unwrap() && depth <= MAX_DEPTH);
            let mut tables = Tables::default();
            let root = over.append(&rest, &mut tables);
            let roots: Vec<u32> =
                built.into_iter().map(|(hierarchy, _, ids)| hierarchy.append(&ids, &mut tables)).collect();
            Hierarchy::link(count, 0, &roots, &mut tables);
            let mut found = Vec::new();
            let corners = |t: u32| all[t as usize].map(|p| p.map(|c| (c - 50.0) as f32));
            under(&tables.nodes, &tables.leaves, root, EVERYWHERE, &corners, &mut found);
            found.sort_unstable();
            found.dedup();
            assert_eq!(found.len() as u32, first + rest.len() as u32, "{groups:?}");
        }
        // Nested as deeply as is allowed, there is no room above.
        let deep = Part { bounds: [[0.0; 3], [1.0; 3]], depth: MAX_DEPTH };
        assert!(build_over(&all[..3], &[deep], [50.0; 3], 1e-4, TriangleSplits::Parts).is_none());
    }
}
