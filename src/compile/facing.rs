//! Closed surfaces that hide their own backs.
//!
//! From outside of a closed surface that does not cross itself, its front is met before its back; a picture may leave the back out. That is told here of
//! components of meshes, furniture as well as walls, and is noted with their triangles.
//!
//! A component falls into *shells*: triangles joined across edges, in pairs. What has more than two triangles at an edge, as boxes that touch there, is paired by
//! the patches (triangles joined across edges of two) that come there twice, then by angle around the edge, so that matter is between the two of a pair. Each shell is judged by itself,
//! whatever the others do: lines wind around it once within, and not without, so that from outside of all of them nothing but fronts is met first. Where triangles
//! do not agree about the outside, they are turned to agree with their neighbours, for this alone.

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::Component;
use crate::format::records::Facing;
use crate::shells::{Edges, Patches, Use};
use crate::trace::crossings;

/// A surface that crosses itself by less than this, metres, does not count as crossing.
const DEEP: f64 = 1e-7;

/// So many pairs of triangles whose boxes meet are looked at, for each triangle of a shell; of a shell with more nothing is said.
const MOST_PAIRS: usize = 256;

/// So many times a triangle is looked at to tell what lies on either side of the patches of a shell.
const MOST_LOOKS: usize = 1 << 20;

/// To which side each triangle of a component looks, in the component's order, if from outside of its shell one side hides the other.
pub(super) fn facing(mesh: &Mesh, component: &Component) -> Vec<Facing> {
    let count = component.triangles.len();
    let edges = Edges::of(mesh, &component.triangles);
    let patches = edges.patches(count);
    let corners: Vec<[DVec3; 3]> = (0..count)
        .map(|t| {
            let [a, b, c] = corners(mesh, component.triangles[t]);
            if patches.turned[t] { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    let around = Around { mesh, component, inward: component.signed_volume < 0.0 };
    let mut facing = vec![Facing::Any; count];
    for shell in shells(&around, &edges, &patches) {
        let side = match &shell.patches[..] {
            _ if !shell.is_closed => Facing::Any,
            [patch] if shell.is_plain => by_volume(&corners, &patches.members[*patch]),
            several => by_winding(&corners, &patches, several),
        };
        if side == Facing::Any || crosses_itself(mesh, component, &corners, &shell.triangles(&patches)) {
            continue;
        }
        for t in shell.triangles(&patches) {
            facing[t as usize] = if patches.turned[t as usize] { side.turned() } else { side };
        }
    }
    facing
}

/// Patches that are joined.
struct Shell {
    /// Their numbers, ascending.
    patches: Vec<usize>,
    /// Whether every edge of every triangle is one of a pair.
    is_closed: bool,
    /// Whether none is of more than two triangles.
    is_plain: bool,
}

impl Shell {
    /// Its triangles, by position in the component.
    fn triangles(&self, patches: &Patches) -> Vec<u32> {
        self.patches.iter().flat_map(|&patch| patches.members[patch].iter().copied()).collect()
    }
}

/// The shells of a component, by their first triangles.
fn shells(around: &Around<'_>, edges: &Edges, patches: &Patches) -> Vec<Shell> {
    /// Of an edge with more triangles nothing is said.
    const MOST: usize = 64;
    let mut shell_of: Vec<usize> = (0..patches.members.len()).collect();
    let mut is_closed = vec![true; patches.members.len()];
    let mut is_plain = is_closed.clone();
    let patch = |e: &Use| patches.of[e.triangle as usize];
    let turned = |e: &Use| Use { is_up: e.is_up != patches.turned[e.triangle as usize], ..*e };
    for edge in edges.by_edge() {
        let mut uses: Vec<Use> = edge.iter().map(turned).collect();
        if let [a, b] = &uses[..] {
            // No way to turn what is as Moebius' band agrees.
            is_closed[patch(a)] &= a.is_up != b.is_up;
            continue;
        }
        uses.iter().for_each(|e| is_plain[patch(e)] = false);
        // Both of a patch, if there are no more of it.
        uses.sort_by_key(patch);
        let is_pair = |uses: &[Use]| matches!(uses, [a, b] if a.is_up != b.is_up);
        let rest = uses.chunk_by(|a, b| patch(a) == patch(b)).filter(|uses| !is_pair(uses));
        let rest: Vec<Use> = rest.flatten().copied().collect();
        if 2 * rest.iter().filter(|e| e.is_up).count() != rest.len() || rest.len() > MOST {
            rest.iter().for_each(|e| is_closed[patch(e)] = false);
            continue;
        }
        for [a, b] in around.pairs(&rest) {
            let (a, b) = (root(&mut shell_of, patch(&a)), root(&mut shell_of, patch(&b)));
            // The first patch of a shell stays its root.
            shell_of[a.max(b)] = a.min(b);
        }
    }
    let mut shells: Vec<Shell> = Vec::new();
    let mut number = vec![usize::MAX; patches.members.len()];
    for patch in 0..patches.members.len() {
        let root = root(&mut shell_of, patch);
        if number[root] == usize::MAX {
            number[root] = shells.len();
            shells.push(Shell { patches: Vec::new(), is_closed: true, is_plain: true });
        }
        let shell = &mut shells[number[root]];
        shell.patches.push(patch);
        shell.is_closed &= is_closed[patch];
        shell.is_plain &= is_plain[patch];
    }
    shells
}

/// What is around the edges of a component.
struct Around<'a> {
    mesh: &'a Mesh,
    component: &'a Component,
    /// Whether triangles look into matter rather than out of it.
    inward: bool,
}

impl Around<'_> {
    fn place(&self, vertex: u32) -> DVec3 {
        DVec3::from(self.mesh.positions[vertex as usize])
    }

    /// The corner of a triangle that is not on its edge.
    fn third(&self, e: &Use) -> DVec3 {
        let triangle = self.mesh.triangles[self.component.triangles[e.triangle as usize] as usize];
        let third = triangle.into_iter().find(|&v| v != e.ends.0 && v != e.ends.1);
        self.place(third.unwrap_or(e.ends.0))
    }

    /// Pairs of triangles at an edge, as many of which pass it up as down, with matter between the two.
    fn pairs(&self, uses: &[Use]) -> Vec<[Use; 2]> {
        let Some(first) = uses.first() else { return Vec::new() };
        let from = self.place(first.ends.0);
        let axis = (self.place(first.ends.1) - from).normalize_or_zero();
        let aside = |e: &Use| {
            let to = self.third(e) - from;
            to - axis * axis.dot(to)
        };
        let across = aside(first);
        // Grows with the angle from the first, counterclockwise as seen against the edge: from 0 up to 4.
        let angle = |e: &Use| {
            let to = aside(e);
            let (x, y) = (across.dot(to), axis.dot(across.cross(to)));
            let part = y.abs() / (x.abs() + y.abs()).max(f64::MIN_POSITIVE);
            match (x >= 0.0, y >= 0.0) {
                (true, true) => part,
                (false, true) => 2.0 - part,
                (false, false) => 2.0 + part,
                (true, false) => 4.0 - part,
            }
        };
        // The front of a triangle that passes the edge up is on the side of greater angles: if it looks out of matter, that ends there. Where one ends and
        // one begins, it ends first.
        let begins = |e: &Use| e.is_up == self.inward;
        let mut sorted: Vec<(f64, bool, Use)> = uses.iter().map(|e| (angle(e), begins(e), *e)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
        // As brackets are paired, twice around.
        let (mut open, mut pairs) = (Vec::new(), Vec::new());
        let mut is_met = vec![false; sorted.len()];
        for i in (0..sorted.len()).chain(0..sorted.len()) {
            let (_, begins, e) = sorted[i];
            if is_met[i] {
                continue;
            }
            if begins {
                open.push(e);
            } else if let Some(begin) = open.pop() {
                pairs.push([begin, e]);
            } else {
                continue;
            }
            is_met[i] = true;
        }
        pairs
    }
}

fn root(parent: &mut [usize], mut at: usize) -> usize {
    while parent[at] != at {
        // Halves the path.
        parent[at] = parent[parent[at]];
        at = parent[at];
    }
    at
}

/// Of a closed surface of one patch.
fn by_volume(corners: &[[DVec3; 3]], patch: &[u32]) -> Facing {
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in patch.iter().flat_map(|&t| corners[t as usize]) {
        (lo, hi) = (lo.min(corner), hi.max(corner));
    }
    // Its middle as origin: volumes are small, and coordinates may be large.
    let origin = (lo + hi) / 2.0;
    let six = |&t: &u32| {
        let [a, b, c] = corners[t as usize].map(|corner| corner - origin);
        a.dot(b.cross(c))
    };
    let volume: f64 = patch.iter().map(six).sum();
    // What rounding may make of the volume of nothing.
    let nothing = 1e-12 * (hi - lo).element_product().abs() + f64::MIN_POSITIVE;
    if volume > nothing {
        Facing::Outward
    } else if volume < -nothing {
        Facing::Inward
    } else {
        Facing::Any
    }
}

/// Of a closed surface of several patches: if lines wind once around what is behind each of them, and not around what is before it.
fn by_winding(corners: &[[DVec3; 3]], patches: &Patches, several: &[usize]) -> Facing {
    let all: Vec<[DVec3; 3]> = several
        .iter()
        .flat_map(|&patch| patches.members[patch].iter().map(|&t| corners[t as usize]))
        .collect();
    if several.len() * all.len() > MOST_LOOKS {
        return Facing::Any;
    }
    let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &corner in all.iter().flatten() {
        (lo, hi) = (lo.min(corner), hi.max(corner));
    }
    // Far enough that rounding does not matter, near enough that thin parts are not stepped through.
    let step = ((hi - lo).length() * 1e-7).max(1e-6);
    let around = |point: DVec3| {
        let all = all.iter().map(|corners| corners.map(|corner| corner.to_array()));
        crossings(all, point.to_array()).winding
    };
    let sides = |&patch: &usize| {
        let normal = |t: u32| {
            let [a, b, c] = corners[t as usize];
            (b - a).cross(c - a)
        };
        // The first of equals.
        let largest = patches.members[patch]
            .iter()
            .copied()
            .reduce(|a, b| if normal(b).length_squared() > normal(a).length_squared() { b } else { a })?;
        let [a, b, c] = corners[largest as usize];
        let (middle, out) = ((a + b + c) / 3.0, normal(largest).normalize_or_zero() * step);
        Some([middle + out, middle - out].map(around))
    };
    let sides: Vec<_> = several.iter().map(sides).collect();
    let are = |front: i32, back: i32| sides.iter().all(|sides| *sides == Some([front, back]));
    if are(0, 1) {
        Facing::Outward
    } else if are(-1, 0) {
        Facing::Inward
    } else {
        Facing::Any
    }
}

fn corners(mesh: &Mesh, triangle: u32) -> [DVec3; 3] {
    mesh.triangles[triangle as usize].map(|v| DVec3::from(mesh.positions[v as usize]))
}

/// Whether any two of some triangles cross; also where that is not worth looking for.
fn crosses_itself(mesh: &Mesh, component: &Component, corners: &[[DVec3; 3]], of: &[u32]) -> bool {
    let boxes: Vec<[DVec3; 2]> = of
        .iter()
        .map(|&t| {
            let [a, b, c] = corners[t as usize];
            [a.min(b).min(c), a.max(b).max(c)]
        })
        .collect();
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [lo, hi] = boxes.iter().fold(start, |[lo, hi], other| [lo.min(other[0]), hi.max(other[1])]);
    // Along the longest axis.
    let axis = (hi - lo).max_position();
    let mut order: Vec<u32> = (0..of.len() as u32).collect();
    order.sort_by(|&a, &b| boxes[a as usize][0][axis].total_cmp(&boxes[b as usize][0][axis]).then(a.cmp(&b)));
    let (mut pairs, most) = (0, MOST_PAIRS * of.len());
    for (i, &a) in order.iter().enumerate() {
        let [lo, hi] = boxes[a as usize];
        for &b in &order[i + 1..] {
            let other = boxes[b as usize];
            if other[0][axis] > hi[axis] {
                break;
            }
            pairs += 1;
            if pairs > most {
                return true;
            }
            if other[0].cmpgt(hi).any() || other[1].cmplt(lo).any() {
                continue;
            }
            let [a, b] = [a, b].map(|t| of[t as usize] as usize);
            let [s, t] = [a, b].map(|t| mesh.triangles[component.triangles[t] as usize]);
            let (p, q) = (&corners[a], &corners[b]);
            if is_crossed((s, p), (t, q)) || is_crossed((t, q), (s, p)) {
                return true;
            }
        }
    }
    false
}

/// Whether an edge of one triangle goes through the other, given by their vertices and corners.
fn is_crossed((through, [a, b, c]): ([u32; 3], &[DVec3; 3]), (by, ends): ([u32; 3], &[DVec3; 3])) -> bool {
    let normal = (b - a).cross(c - a).normalize_or_zero();
    if normal == DVec3::ZERO {
        return false;
    }
    let away = ends.map(|end| normal.dot(end - a));
    (0..3).any(|i| {
        let j = (i + 1) % 3;
        let goes_through = away[i] > DEEP && away[j] < -DEEP || away[i] < -DEEP && away[j] > DEEP;
        if !goes_through || through.contains(&by[i]) || through.contains(&by[j]) {
            return false;
        }
        let at = ends[i] + (ends[j] - ends[i]) * (away[i] / (away[i] - away[j]));
        [[a, b], [b, c], [c, a]].iter().all(|[from, to]| {
            let inward = normal.cross(*to - *from).normalize_or_zero();
            inward.dot(at - *from) > -DEEP
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;
    use enfilade_importers::MaterialId;

    /// A box from one corner to another.
    fn cuboid(mesh: &mut Mesh, lo: [f64; 3], hi: [f64; 3], is_inward: bool) {
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let first = mesh.positions.len() as u32;
        for i in 0..8usize {
            mesh.positions.push([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] }));
        }
        for [a, b, c, d] in quads {
            for mut corners in [[a, b, c], [a, c, d]] {
                if is_inward {
                    corners.swap(1, 2);
                }
                mesh.triangles.push(corners.map(|corner| corner + first));
                mesh.materials.push(MaterialId(0));
            }
        }
    }

    /// Makes one vertex of those in the same place.
    fn weld(mesh: &mut Mesh) {
        let first = |p: &[f64; 3]| mesh.positions.iter().position(|q| q == p).unwrap() as u32;
        let same: Vec<u32> = mesh.positions.iter().map(first).collect();
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = same[*v as usize]);
    }

    /// Of each component, whose triangles all face alike.
    fn of(mesh: &Mesh) -> Vec<Facing> {
        let alike = |facing: Vec<Facing>| {
            assert!(facing.iter().all(|other| *other == facing[0]), "{facing:?}");
            facing[0]
        };
        components(mesh).iter().map(|component| alike(facing(mesh, component))).collect()
    }

    fn empty() -> Mesh {
        Mesh { positions: Vec::new(), triangles: Vec::new(), materials: Vec::new() }
    }

    #[test]
    fn boxes_face_outward_or_inward_and_open_ones_any_side() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1e6; 3], [1e6 + 1e-3; 3], true);
        assert_eq!(of(&mesh), [Facing::Outward, Facing::Inward]);
        mesh.triangles.remove(0);
        mesh.materials.remove(0);
        assert_eq!(of(&mesh), [Facing::Any, Facing::Inward]);
        mesh.triangles[0].swap(0, 1);
        assert_eq!(of(&mesh)[0], Facing::Any);
    }

    #[test]
    fn boxes_that_share_an_edge_face_outward_together() {
        for is_inward in [false, true] {
            let mut mesh = empty();
            cuboid(&mut mesh, [0.0; 3], [1.0; 3], is_inward);
            cuboid(&mut mesh, [1.0, 1.0, 0.0], [2.0, 2.0, 1.0], is_inward);
            weld(&mut mesh);
            let expected = if is_inward { Facing::Inward } else { Facing::Outward };
            assert_eq!(of(&mesh), [expected]);
        }
        // One of them is inside out: each is a surface by itself.
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1.0, 1.0, 0.0], [3.0, 3.0, 1.0], true);
        weld(&mut mesh);
        let components = components(&mesh);
        let expected: Vec<Facing> =
            [Facing::Outward, Facing::Inward].into_iter().flat_map(|facing| [facing; 12]).collect();
        assert_eq!(facing(&mesh, &components[0]), expected);
    }

    /// Boxes that share a whole face, twice there: all four triangles at its edges are of two boxes.
    #[test]
    fn boxes_that_share_a_face_face_outward_together() {
        for is_inward in [false, true] {
            let mut mesh = empty();
            cuboid(&mut mesh, [0.0; 3], [1.0; 3], is_inward);
            cuboid(&mut mesh, [1.0, 0.0, 0.0], [3.0, 1.0, 1.0], is_inward);
            cuboid(&mut mesh, [1.0, 1.0, 0.0], [3.0, 2.0, 1.0], is_inward);
            weld(&mut mesh);
            let expected = if is_inward { Facing::Inward } else { Facing::Outward };
            assert_eq!(of(&mesh), [expected]);
        }
    }

    #[test]
    fn triangles_that_do_not_agree_face_as_their_neighbours_say() {
        for is_inward in [false, true] {
            for turned in [1, 0b1010_0110_1001, 0xfff] {
                let mut mesh = empty();
                cuboid(&mut mesh, [0.0; 3], [1.0, 2.0, 3.0], is_inward);
                let is_turned = |t: usize| turned >> t & 1 != 0;
                (0..12).filter(|&t| is_turned(t)).for_each(|t| mesh.triangles[t].swap(0, 1));
                let expected: Vec<Facing> = (0..12)
                    .map(|t| if is_turned(t) != is_inward { Facing::Inward } else { Facing::Outward })
                    .collect();
                assert_eq!(facing(&mesh, &components(&mesh)[0]), expected);
            }
        }
    }

    #[test]
    fn closed_parts_of_what_is_open_face_outward() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [1.0; 3], false);
        cuboid(&mut mesh, [1.0; 3], [2.0; 3], false);
        mesh.triangles.pop();
        mesh.materials.pop();
        weld(&mut mesh);
        let components = components(&mesh);
        assert!(components.len() == 1 && !components[0].closed);
        let facing = facing(&mesh, &components[0]);
        assert!(facing[..12].iter().all(|facing| *facing == Facing::Outward));
        assert!(facing[12..].iter().all(|facing| *facing == Facing::Any));
    }

    /// Bars that reach into each other, with a corner in common: each hides its own back.
    #[test]
    fn what_crosses_others_faces_outward() {
        let mut mesh = empty();
        cuboid(&mut mesh, [0.0; 3], [3.0, 1.0, 1.0], false);
        cuboid(&mut mesh, [0.0; 3], [1.0, 0.5, 3.0], false);
        weld(&mut mesh);
        assert_eq!(of(&mesh), [Facing::Outward]);
    }

    #[test]
    fn what_crosses_itself_faces_any_side() {
        // A prism over a polygon that winds once around two corners and crosses itself: one end is inside out.
        let corners = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]];
        let mut mesh = empty();
        for z in [0.0, 1.0] {
            mesh.positions.extend(corners.map(|[x, y]| [x, y, z]));
        }
        let mut push = |corners: [u32; 3]| {
            mesh.triangles.push(corners);
            mesh.materials.push(MaterialId(0));
        };
        for i in 0..4u32 {
            let j = (i + 1) % 4;
            push([i, j, j + 4]);
            push([i, j + 4, i + 4]);
        }
        for (a, b, c) in [(0, 1, 2), (0, 2, 3)] {
            push([a, c, b]);
            push([a + 4, b + 4, c + 4]);
        }
        assert!(components(&mesh)[0].closed);
        assert_eq!(of(&mesh), [Facing::Any]);
    }
}
