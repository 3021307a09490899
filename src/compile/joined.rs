//! The shells of a component: triangles joined across edges, in pairs.
//!
//! What has more than two triangles at an edge, as boxes that touch there, is paired by the patches (triangles joined across edges of two) that come there
//! twice, then by angle around the edge, so that matter is between the two of a pair.

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::Component;
use crate::shells::{Edges, Patches, Use, root};

/// Patches that are joined.
pub(super) struct Shell {
    /// Their numbers, ascending.
    pub(super) patches: Vec<usize>,
    /// Whether every edge of every triangle is one of a pair.
    pub(super) is_closed: bool,
    /// Whether none is of more than two triangles.
    pub(super) is_plain: bool,
}

impl Shell {
    /// Its triangles, by position in the component.
    pub(super) fn triangles(&self, patches: &Patches) -> Vec<u32> {
        self.patches.iter().flat_map(|&patch| patches.members[patch].iter().copied()).collect()
    }
}

/// The shells of a component, by their first triangles.
pub(super) fn shells(mesh: &Mesh, component: &Component, edges: &Edges, patches: &Patches) -> Vec<Shell> {
    /// Of an edge with more triangles nothing is said.
    const MOST: usize = 64;
    let around = Around { mesh, component, inward: component.signed_volume < 0.0 };
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
