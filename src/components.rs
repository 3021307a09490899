//! The topology of an element's mesh as it came: connected components, closed or open, and where it is open.
//!
//! Vertices are equal if their positions are equal to the last bit (the model is welded that way). Two triangles
//! belong to one component if they share a vertex. A component is *closed* if every edge has an even number of
//! triangles, doubled triangles (same corners, same side) counted once; it is *consistent* if every edge is used as
//! often in one direction as in the other.

use std::collections::HashMap;

use enfilade_importers::Mesh;

/// Whether the triangles of a closed component agree about the outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orientation {
    /// All outward, or all inward.
    Consistent,
    /// Some outward, some inward.
    Mixed,
}

/// One connected component of a mesh.
#[derive(Clone, Debug)]
pub struct Component {
    /// Its different triangles, ascending indices into the mesh: of doubled ones the first.
    pub triangles: Vec<u32>,
    /// Whether it encloses a volume.
    pub closed: bool,
    /// Whether its triangles agree about the outside.
    pub orientation: Orientation,
    /// Triangles that stand on the same corners and side as an earlier one: left out above.
    pub doubled: u32,
    /// Edges with an odd number of triangles.
    pub open_edges: u32,
    /// The first few open edges, as points (internal frame).
    pub open_at: Vec<[[f64; 3]; 2]>,
    /// Lower and upper corner, metres.
    pub bounds: [[f64; 3]; 2],
    /// Volume by the divergence theorem, m3: negative if inward, meaningless if not closed or not consistent.
    pub signed_volume: f64,
}

/// How many open edges a component remembers with their place.
const REMEMBERED: usize = 8;

/// The connected components of `mesh`, ordered by their first triangle.
pub fn components(mesh: &Mesh) -> Vec<Component> {
    let mut parent: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for &[a, b, c] in &mesh.triangles {
        union(&mut parent, a, b);
        union(&mut parent, a, c);
    }
    let mut index_of_root: HashMap<u32, usize> = HashMap::new();
    let mut groups: Vec<Vec<u32>> = Vec::new();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let root = find(&mut parent, triangle[0]);
        let group = *index_of_root.entry(root).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(t as u32);
    }
    groups.into_iter().map(|triangles| describe(mesh, triangles)).collect()
}

fn describe(mesh: &Mesh, triangles: Vec<u32>) -> Component {
    let all = triangles.len();
    let triangles = different(mesh, triangles);
    // Directed edges as (lower vertex, upper vertex, +1 or -1).
    let mut edges: Vec<(u32, u32, i32)> = Vec::with_capacity(triangles.len() * 3);
    for [a, b, c] in triangles.iter().map(|&t| mesh.triangles[t as usize]) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push(if from < to { (from, to, 1) } else { (to, from, -1) });
        }
    }
    edges.sort_unstable();
    let (mut open_edges, mut open_at, mut consistent) = (0, Vec::new(), true);
    for run in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if run.len() % 2 == 1 {
            open_edges += 1;
            if open_at.len() < REMEMBERED {
                open_at.push([mesh.positions[run[0].0 as usize], mesh.positions[run[0].1 as usize]]);
            }
        }
        consistent &= run.iter().map(|e| e.2).sum::<i32>() == 0;
    }
    let first = mesh.corners(triangles[0] as usize)[0];
    let mut bounds = [first, first];
    let mut six_volumes = 0.0;
    for &t in &triangles {
        let corners = mesh.corners(t as usize);
        for p in corners {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(p[axis]);
                bounds[1][axis] = bounds[1][axis].max(p[axis]);
            }
        }
        let [a, b, c] = corners.map(|p| glam::DVec3::from(p) - glam::DVec3::from(first));
        six_volumes += a.dot(b.cross(c));
    }
    Component {
        closed: open_edges == 0,
        orientation: if consistent { Orientation::Consistent } else { Orientation::Mixed },
        doubled: (all - triangles.len()) as u32,
        open_edges,
        open_at,
        bounds,
        signed_volume: six_volumes / 6.0,
        triangles,
    }
}

/// The triangles without those that stand on the same corners and side as an earlier one.
fn different(mesh: &Mesh, triangles: Vec<u32>) -> Vec<u32> {
    let mut keyed: Vec<([u32; 3], u32)> =
        triangles.into_iter().map(|t| (rotated(mesh.triangles[t as usize]), t)).collect();
    keyed.sort_unstable();
    keyed.dedup_by_key(|(corners, _)| *corners);
    let mut kept: Vec<u32> = keyed.into_iter().map(|(_, t)| t).collect();
    kept.sort_unstable();
    kept
}

/// The triangle's corners with the least one first, order kept: equal for equal triangles of equal side.
pub(crate) fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a <= b && a <= c {
        [a, b, c]
    } else if b <= a && b <= c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

fn find(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}

fn union(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(parent, a), find(parent, b));
    // The lower root wins, so that the outcome does not depend on anything but the mesh.
    parent[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_importers::MaterialId;

    fn cube(at: f64, mesh: &mut Mesh) {
        let base = mesh.positions.len() as u32;
        for i in 0..8 {
            mesh.positions.push([at + f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)]);
        }
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads {
            mesh.triangles.push([base + a, base + b, base + c]);
            mesh.triangles.push([base + a, base + c, base + d]);
        }
        mesh.materials.resize(mesh.triangles.len(), MaterialId(0));
    }

    #[test]
    fn two_cubes_are_two_closed_components() {
        let mut mesh = Mesh::default();
        cube(0.0, &mut mesh);
        cube(5.0, &mut mesh);
        let parts = components(&mesh);
        assert_eq!(parts.len(), 2);
        for part in &parts {
            assert!(part.closed && part.orientation == Orientation::Consistent);
            assert_eq!(part.signed_volume, 1.0);
            assert_eq!(part.triangles.len(), 12);
        }
        assert_eq!(parts[1].bounds, [[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]);
    }

    #[test]
    fn missing_flipped_and_doubled_triangles_are_told_apart() {
        let mut mesh = Mesh::default();
        cube(0.0, &mut mesh);
        let mut open = mesh.clone();
        open.triangles.remove(3);
        let part = &components(&open)[0];
        assert!(!part.closed);
        assert_eq!((part.open_edges, part.open_at.len()), (3, 3));

        let mut flipped = mesh.clone();
        flipped.triangles[0].swap(0, 1);
        let part = &components(&flipped)[0];
        assert!(part.closed && part.orientation == Orientation::Mixed);

        let mut doubled = mesh.clone();
        let [a, b, c] = doubled.triangles[0];
        doubled.triangles.push([b, c, a]);
        let part = &components(&doubled)[0];
        assert!(part.closed && part.orientation == Orientation::Consistent);
        assert_eq!(part.doubled, 1);
    }
}
