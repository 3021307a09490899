//! The closed shells of a mesh, and what lies inside them.
//!
//! A *shell* is a connected component (over shared vertices) in which every edge has an even number of triangles,
//! where triangles on the same corners and of the same side count once. It
//! is *balanced* if every edge is passed as often one way as the other: then it has a whole winding number
//! everywhere, found by adding up the solid angles of its triangles (Van Oosterom and Strackee, 1983). Other shells
//! have an inside by parity only: how often a line from the point to infinity pierces them, by the majority of three
//! oblique lines that meet no edge.
//!
//! A point is inside a [`Body`], the closed shells of one element, if the windings of all balanced shells, and one for
//! each other shell whose inside it lies in, do not add up to zero. So a shell that is inside out, as a whole, makes no
//! difference; an inverted shell within another is a cavity; doubled shells, and shells that reach into each other, are
//! as solid as single ones.

use std::collections::{HashMap, HashSet};

use enfilade_importers::Mesh;

use super::triangle::{Corners, Line, Size, closest_point, pierce};
use super::vector::{Bounds, cross, distance, dot, length, sub};
use crate::trace::Ray;

/// Directions for the parity, oblique to all that is built.
const OBLIQUE: [[f64; 3]; 9] = [
    [0.539_21, 0.623_57, 0.565_91],
    [-0.677_31, 0.412_77, 0.609_13],
    [0.318_19, -0.741_53, 0.590_67],
    [-0.452_97, -0.571_33, 0.684_41],
    [0.831_07, 0.237_91, -0.502_73],
    [-0.291_71, 0.823_49, -0.486_53],
    [0.613_57, -0.347_83, -0.708_91],
    [-0.719_39, -0.266_51, -0.641_47],
    [0.173_29, 0.386_17, 0.906_01],
];

/// Lines that must agree by majority.
const VOTES: u32 = 3;

/// One closed component of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Shell {
    triangles: Vec<Corners>,
    bounds: Bounds,
    balanced: bool,
}

/// The closed shells of one element.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    shells: Vec<Shell>,
    pub(crate) bounds: Bounds,
}

impl Body {
    /// `None` if no component is closed.
    pub(crate) fn of(mesh: &Mesh) -> Option<Body> {
        let shells = closed_components(mesh);
        let bounds = shells.iter().fold(Bounds::EMPTY, |bounds, shell| bounds.union(shell.bounds));
        (!shells.is_empty()).then_some(Body { shells, bounds })
    }

    /// Whether `p` is inside. Close to the surface, within some roundings, either may be said.
    pub(crate) fn contains(&self, p: [f64; 3]) -> bool {
        if !self.bounds.contains(p) {
            return false;
        }
        let mut winding = 0;
        for shell in self.shells.iter().filter(|shell| shell.bounds.contains(p)) {
            winding += if shell.balanced { shell.winding(p) } else { i64::from(shell.is_odd(p)) };
        }
        winding != 0
    }

    /// The points of the surface's triangles that are nearest to `p`, for each triangle within `limit` of it: point,
    /// and the triangle's normal, of no particular length.
    pub(crate) fn surface_near(&self, p: [f64; 3], limit: f64) -> Vec<([f64; 3], [f64; 3])> {
        let near = |bounds: &Bounds| bounds.distance(p) <= limit;
        let mut found = Vec::new();
        if near(&self.bounds) {
            for shell in self.shells.iter().filter(|shell| near(&shell.bounds)) {
                for corners in &shell.triangles {
                    let [a, b, c] = *corners;
                    let outside = (0..3).any(|i| {
                        a[i].min(b[i]).min(c[i]) > p[i] + limit || a[i].max(b[i]).max(c[i]) < p[i] - limit
                    });
                    if !outside {
                        let q = closest_point(corners, p);
                        if distance(p, q) <= limit {
                            found.push((q, cross(sub(b, a), sub(c, a))));
                        }
                    }
                }
            }
        }
        found
    }
}

impl Shell {
    /// How often the shell goes around `p`; for balanced shells.
    fn winding(&self, p: [f64; 3]) -> i64 {
        // The solid angle of a triangle is twice the argument of a complex number. Instead of adding the arguments,
        // multiply the numbers, and count how often the product's argument passes from pi to -pi or back. That takes
        // no function whose last bits differ from one machine to the next.
        let (mut re, mut im) = (1.0f64, 0.0f64);
        let mut turns = 0i64;
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|corner| sub(corner, p));
            let (la, lb, lc) = (length(a), length(b), length(c));
            let y = dot(a, cross(b, c));
            let x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
            let size = x.abs().max(y.abs());
            if size == 0.0 || !size.is_finite() {
                // On a corner.
                continue;
            }
            let (x, y) = (x / size, y / size);
            let (new_re, new_im) = (re * x - im * y, re * y + im * x);
            let up = im >= 0.0 && y >= 0.0 && new_im < 0.0;
            let down = im < 0.0 && y < 0.0 && (new_im > 0.0 || new_im == 0.0 && new_re < 0.0);
            turns += i64::from(up) - i64::from(down);
            let norm = new_re.abs().max(new_im.abs());
            (re, im) = (new_re / norm, new_im / norm);
        }
        // The sum of the halved angles is 2 pi times the winding number, that is `turns` whole turns and a rest that is
        // near zero.
        turns
    }

    /// Whether lines from `p` to infinity pierce the shell an odd number of times, by majority.
    fn is_odd(&self, p: [f64; 3]) -> bool {
        let (mut odd, mut votes) = (0, 0);
        for direction in OBLIQUE {
            if let Some(line) = Line::new(&Ray::new(p, direction))
                && let Some(is_odd) = self.crossings(&line)
            {
                odd += u32::from(is_odd);
                votes += 1;
                if votes == VOTES {
                    break;
                }
            }
        }
        2 * odd > votes
    }

    /// Whether the line leaves through an odd number of triangles; `None` if it meets an edge.
    fn crossings(&self, line: &Line) -> Option<bool> {
        let mut odd = false;
        for corners in &self.triangles {
            let size = Size::of(corners);
            if let Some(t) = pierce(line, corners, size).filter(|&t| t > 0.0) {
                // A line through an edge pierces two triangles at once: too close to call.
                let at = line.at(t);
                let slack = 1e-12 * (size.reach + line.reach);
                let touches = (0..3).any(|i| {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    length(cross(sub(b, a), sub(at, a))) <= slack * length(sub(b, a))
                });
                if touches {
                    return None;
                }
                odd = !odd;
            }
        }
        Some(odd)
    }
}

/// The components of the mesh in which every edge has an even number of triangles, in the order of their first
/// triangles.
fn closed_components(mesh: &Mesh) -> Vec<Shell> {
    // Equal positions are one vertex, whatever the mesh says.
    let mut seen = HashMap::new();
    let vertices: Vec<u32> = mesh
        .positions
        .iter()
        .enumerate()
        .map(|(index, p)| *seen.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(index as u32))
        .collect();
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| vertices[v as usize])).collect();

    let mut parent: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for &[a, b, c] in &triangles {
        join(&mut parent, a, b);
        join(&mut parent, b, c);
    }
    let mut number = HashMap::new();
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for (index, triangle) in triangles.iter().enumerate() {
        let root = root(&mut parent, triangle[0]);
        let part = *number.entry(root).or_insert_with(|| {
            parts.push(Vec::new());
            parts.len() - 1
        });
        parts[part].push(index);
    }
    parts.iter().filter_map(|part| shell(mesh, &triangles, part)).collect()
}

/// The component as a shell, if it is closed.
fn shell(mesh: &Mesh, triangles: &[[u32; 3]], part: &[usize]) -> Option<Shell> {
    // Doubled triangles count once: they are a slip of the modeller's, and no hole.
    let mut known = HashSet::new();
    let part: Vec<usize> =
        part.iter().copied().filter(|&index| known.insert(rotated(triangles[index]))).collect();
    // Each edge once for each triangle: its ends in order, and which way it is passed.
    let mut edges: Vec<(u32, u32, i32)> = Vec::with_capacity(3 * part.len());
    for &index in &part {
        let t = triangles[index];
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            edges.push(if a < b { (a, b, 1) } else { (b, a, -1) });
        }
    }
    edges.sort_unstable();
    let mut balanced = true;
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if same.len() % 2 == 1 {
            return None;
        }
        balanced &= same.iter().map(|edge| edge.2).sum::<i32>() == 0;
    }
    let triangles: Vec<Corners> = part.iter().map(|&index| mesh.corners(index)).collect();
    let bounds = triangles.iter().fold(Bounds::EMPTY, |bounds, t| bounds.union(Bounds::of(t)));
    Some(Shell { triangles, bounds, balanced })
}

/// The same turn of corners, with the lowest first.
fn rotated(t: [u32; 3]) -> [u32; 3] {
    let lowest = (0..3).min_by_key(|&i| t[i]).unwrap_or(0);
    [t[lowest], t[(lowest + 1) % 3], t[(lowest + 2) % 3]]
}

fn root(parent: &mut [u32], of: u32) -> u32 {
    let mut at = of;
    while parent[at as usize] != at {
        // Halves the path.
        parent[at as usize] = parent[parent[at as usize] as usize];
        at = parent[at as usize];
    }
    at
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    // The smaller index stays root; with halved paths that is quick enough, and does not depend on any order.
    parent[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::fixtures::{Shape, model};
    use enfilade_importers::Semantic;
    use proptest::prelude::*;

    fn body(shape: Shape) -> Option<Body> {
        Body::of(&model(&[(Semantic::Wall, shape)]).elements[0].mesh)
    }

    fn unit() -> Shape {
        Shape::cuboid([0.0; 3], [1.0; 3])
    }

    fn inner() -> Shape {
        Shape::cuboid([0.25; 3], [0.75; 3])
    }

    const MIDDLE: [f64; 3] = [0.5; 3];
    const RIND: [f64; 3] = [0.1, 0.4, 0.6];
    const OUT: [f64; 3] = [1.2, 0.5, 0.5];

    #[test]
    fn boxes_of_all_kinds() {
        let inside = |shape: Shape| {
            let body = body(shape).unwrap();
            [MIDDLE, RIND, OUT].map(|p| body.contains(p))
        };
        assert_eq!(inside(unit()), [true, true, false]);
        assert_eq!(inside(unit().flipped()), [true, true, false], "inside out");
        assert_eq!(inside(unit().and(inner().flipped())), [false, true, false], "a cavity");
        assert_eq!(inside(unit().flipped().and(inner())), [false, true, false], "a cavity, inside out");
        assert_eq!(inside(unit().and(inner())), [true, true, false], "a box in a box");
        assert_eq!(inside(unit().and(unit())), [true, true, false], "doubled");
        assert_eq!(inside(unit().and(unit().flipped())), [false; 3], "membranes without volume");
        for i in 0..12 {
            assert_eq!(inside(unit().with_flipped(i)), [true, true, false], "triangle {i} turned over");
        }
        let badly_wound = unit().with_flipped(3).and(inner().with_flipped(5));
        assert_eq!(inside(badly_wound), [true, true, false], "nothing tells that the inner one is a cavity");
    }

    #[test]
    fn open_components_have_no_inside() {
        let mut open = unit();
        open.0.pop();
        assert!(body(open.clone()).is_none());
        let both = body(open.and(Shape::cuboid([5.0; 3], [6.0; 3]))).unwrap();
        assert!(both.contains([5.5; 3]) && !both.contains(MIDDLE));
        let mut doubled = unit();
        let [a, b, c] = doubled.0[0];
        doubled.0.push([b, c, a]);
        let doubled = body(doubled).unwrap();
        assert!(doubled.contains(MIDDLE) && doubled.shells[0].winding(MIDDLE) == 1, "one triangle twice");
        let mut membrane = unit();
        let across = [[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0]];
        membrane.0.extend([across, [across[1], across[0], across[2]]]);
        assert!(body(membrane).unwrap().contains(MIDDLE));
    }

    #[test]
    fn winding_counts_far_and_near() {
        let many = Shape::prism(4000, 10.0, -5.0, 5.0);
        let body = body(many).unwrap();
        assert!(body.shells[0].balanced);
        for p in [[0.0, 0.0, 4.999_999], [9.99, 0.0, 0.0], [1e-9, -1e-9, -4.999_999_999]] {
            assert_eq!(body.shells[0].winding(p), 1, "{p:?}");
        }
        for p in [[0.0, 0.0, 5.000_001], [10.01, 0.0, 0.0], [1e9, 0.0, 0.0], [0.0, 10.0, 5.1]] {
            assert_eq!(body.shells[0].winding(p), 0, "{p:?}");
        }
        assert_eq!(body.surface_near([0.0, 0.0, 4.9], 0.05).len(), 0);
        assert!(body.surface_near([0.0, 0.0, 4.9], 0.2).len() > 100);
    }

    proptest! {
        /// Both ways to tell agree, on a tilted prism and on one seen from any point.
        #[test]
        fn winding_agrees_with_parity(
            sides in 3usize..40,
            tilt in -0.9f64..0.9,
            p in proptest::array::uniform3(-1.5f64..1.5),
        ) {
            let mut shape = Shape::prism(sides, 1.0, -1.0, 1.0);
            for v in shape.0.iter_mut().flatten() {
                v[2] += tilt * v[0];
                v[1] += 0.3 * v[2] * v[2];
            }
            let body = body(shape).unwrap();
            let shell = &body.shells[0];
            prop_assume!(body.surface_near(p, 1e-9).is_empty());
            prop_assert_eq!(shell.winding(p).rem_euclid(2) == 1, shell.is_odd(p));
        }
    }
}
