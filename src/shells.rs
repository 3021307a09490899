//! What is inside an element: the one definition that the compiler and the truth share.
//!
//! Closed components ([`crate::components`]) fall into *shells*: triangles connected across edges. A point is inside
//! the element if
//!
//! - the winding numbers of all shells whose triangles agree about the outside do not add up to zero: a shell that looks
//!   inward within another is a cavity, one that is inside out as a whole makes no difference, and shells that reach into
//!   each other, or a shell into itself, are as solid as single ones; or
//! - it is inside any one of the other shells, each by itself. Where a shell has no edge of more than two triangles, these
//!   are turned to agree with their neighbours, which can be done in just two ways, inside out of each other; then the
//!   winding number counts. Where it has, or has but one side like Klein's bottle, nothing tells how to turn them: the
//!   parity of crossings counts.

use enfilade_importers::Mesh;

use crate::components::{Component, Orientation};

/// How a shell takes part in what is inside its element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Inside {
    /// By its winding number, added to that of all others of this kind.
    Together,
    /// By itself, where its winding number is not zero.
    ByWinding,
    /// By itself, where lines to infinity cross it an odd number of times.
    ByParity,
}

/// Triangles of a closed component that are connected across edges.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shell {
    /// Ascending indices into the mesh.
    pub(crate) triangles: Vec<u32>,
    /// Which of them to turn over, so that they agree with their neighbours across edges of two triangles. Of
    /// [`Inside::ByWinding`] all agree then; whether about the outside or the inside is not said.
    pub(crate) turned: Vec<bool>,
    /// Its triangles by position in the above, in sets connected across edges of two triangles: all of them in one, save
    /// for [`Inside::ByParity`].
    pub(crate) patches: Vec<Vec<u32>>,
    /// How it takes part.
    pub(crate) inside: Inside,
}

impl Shell {
    /// The corners of its triangles in the mesh, those turned that are to be.
    pub(crate) fn corners<'a>(&'a self, mesh: &'a Mesh) -> impl Iterator<Item = [u32; 3]> + 'a {
        self.triangles.iter().zip(&self.turned).map(|(&t, &turned)| {
            let [a, b, c] = mesh.triangles[t as usize];
            if turned { [a, c, b] } else { [a, b, c] }
        })
    }
}

/// The shells of a closed component, in the order of their first triangles; of one whose triangles agree, all in one.
pub(crate) fn shells(mesh: &Mesh, component: &Component) -> Vec<Shell> {
    let all = &component.triangles;
    if component.orientation == Orientation::Consistent {
        return vec![agreeing(all.clone())];
    }
    let edges = Edges::of(mesh, all);
    let patches = edges.patches(all.len());
    let mut group_of_patch: Vec<usize> = (0..patches.len()).collect();
    for edge in edges.by_edge() {
        let groups = edge.iter().map(|e| root(&mut group_of_patch, patches.of[e.triangle as usize]));
        let groups: Vec<usize> = groups.collect();
        // The first patch of a group stays its root.
        let least = groups.iter().copied().min().unwrap_or(0);
        groups.into_iter().for_each(|group| group_of_patch[group] = least);
    }
    let mut number = vec![usize::MAX; patches.len()];
    let mut shells: Vec<Shell> = Vec::new();
    let mut at = vec![0; all.len()];
    let group: Vec<usize> = (0..all.len()).map(|t| root(&mut group_of_patch, patches.of[t])).collect();
    for (t, &group) in group.iter().enumerate() {
        if number[group] == usize::MAX {
            number[group] = shells.len();
            shells.push(Shell { inside: Inside::Together, ..agreeing(Vec::new()) });
        }
        let shell = &mut shells[number[group]];
        at[t] = shell.triangles.len() as u32;
        shell.triangles.push(all[t]);
        shell.turned.push(patches.turned[t]);
    }
    let mut agree = vec![true; shells.len()];
    let mut tell = vec![true; shells.len()];
    for edge in edges.by_edge() {
        let shell = number[group[edge[0].triangle as usize]];
        agree[shell] &= edge.iter().map(|e| if e.is_up { 1 } else { -1 }).sum::<i32>() == 0;
        let up = |e: &Use| e.is_up != patches.turned[e.triangle as usize];
        tell[shell] &= matches!(edge, [a, b] if up(a) != up(b));
    }
    for (shell, (agree, tell)) in shells.iter_mut().zip(agree.into_iter().zip(tell)) {
        if agree {
            *shell = agreeing(std::mem::take(&mut shell.triangles));
        } else {
            shell.inside = if tell { Inside::ByWinding } else { Inside::ByParity };
            shell.patches.clear();
        }
    }
    for patch in patches.members {
        let shell = &mut shells[number[group[patch[0] as usize]]];
        if shell.inside != Inside::Together {
            shell.patches.push(patch.into_iter().map(|t| at[t as usize]).collect());
        }
    }
    shells
}

/// The shell of triangles that agree.
fn agreeing(triangles: Vec<u32>) -> Shell {
    let count = triangles.len();
    let patches = vec![(0..count as u32).collect()];
    Shell { triangles, turned: vec![false; count], patches, inside: Inside::Together }
}

/// A triangle's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Use {
    /// The vertices, the lower one first.
    pub(crate) ends: (u32, u32),
    /// The triangle, by its position in the component.
    pub(crate) triangle: u32,
    /// Whether it passes the edge from the lower vertex to the upper one.
    pub(crate) is_up: bool,
}

impl Use {
    fn same_edge(&self, other: &Use) -> bool {
        self.ends == other.ends
    }
}

/// The edges of all triangles, equal ones side by side.
pub(crate) struct Edges(Vec<Use>);

impl Edges {
    pub(crate) fn of(mesh: &Mesh, triangles: &[u32]) -> Edges {
        let mut edges = Vec::with_capacity(3 * triangles.len());
        for (t, &index) in (0..).zip(triangles) {
            let [a, b, c] = mesh.triangles[index as usize];
            for (from, to) in [(a, b), (b, c), (c, a)] {
                edges.push(Use { ends: (from.min(to), from.max(to)), triangle: t, is_up: from < to });
            }
        }
        edges.sort_unstable();
        Edges(edges)
    }

    /// The uses of each edge.
    pub(crate) fn by_edge(&self) -> impl Iterator<Item = &[Use]> {
        self.0.chunk_by(Use::same_edge)
    }

    /// The sets of triangles that are connected across edges of two triangles, each turned like its first.
    pub(crate) fn patches(&self, count: usize) -> Patches {
        // Neighbours, and whether both pass the edge the same way.
        let mut neighbours = vec![Vec::new(); count];
        for edge in self.by_edge() {
            if let &[a, b] = edge {
                neighbours[a.triangle as usize].push((b.triangle, a.is_up == b.is_up));
                neighbours[b.triangle as usize].push((a.triangle, a.is_up == b.is_up));
            }
        }
        let none = usize::MAX;
        let mut patches = Patches { of: vec![none; count], turned: vec![false; count], members: Vec::new() };
        for first in 0..count {
            if patches.of[first] != none {
                continue;
            }
            let number = patches.len();
            patches.of[first] = number;
            let mut patch = vec![first as u32];
            let mut next = 0;
            while let Some(&t) = patch.get(next) {
                next += 1;
                for &(other, same_way) in &neighbours[t as usize] {
                    if patches.of[other as usize] == none {
                        patches.of[other as usize] = number;
                        patches.turned[other as usize] = patches.turned[t as usize] != same_way;
                        patch.push(other);
                    }
                }
            }
            patches.members.push(patch);
        }
        patches
    }
}

/// What [`Edges::patches`] found.
pub(crate) struct Patches {
    /// The patch of each triangle.
    pub(crate) of: Vec<usize>,
    /// Whether to turn each triangle.
    pub(crate) turned: Vec<bool>,
    /// The triangles of each patch.
    pub(crate) members: Vec<Vec<u32>>,
}

impl Patches {
    fn len(&self) -> usize {
        self.members.len()
    }
}

/// The first of the set that `at` is in: each knows its parent, and the first is its own.
pub(crate) fn root(parent: &mut [usize], mut at: usize) -> usize {
    while parent[at] != at {
        // Halves the path.
        parent[at] = parent[parent[at]];
        at = parent[at];
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;
    use enfilade_importers::MaterialId;

    /// The shells of a mesh of tetrahedra, each on four of the points; `turn` turns some triangles over.
    fn of(tetrahedra: &[[u32; 4]], turn: &[usize]) -> Vec<Shell> {
        let mut triangles: Vec<[u32; 3]> = tetrahedra
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]])
            .collect();
        turn.iter().for_each(|&t| triangles[t].swap(1, 2));
        let points = 1 + triangles.iter().flatten().copied().max().unwrap();
        let mesh = Mesh {
            positions: (0..points).map(|i| [f64::from(i), f64::from(i * i), f64::from(i * i * i)]).collect(),
            materials: vec![MaterialId(0); triangles.len()],
            triangles,
        };
        let components = components(&mesh);
        assert!(components.len() == 1 && components[0].closed);
        shells(&mesh, &components[0])
    }

    fn kinds(shells: &[Shell]) -> Vec<(usize, Inside)> {
        shells.iter().map(|shell| (shell.triangles.len(), shell.inside)).collect()
    }

    #[test]
    fn what_agrees_counts_together() {
        assert_eq!(kinds(&of(&[[0, 1, 2, 3]], &[])), [(4, Inside::Together)]);
        // Inside out.
        assert_eq!(kinds(&of(&[[0, 1, 2, 3]], &[0, 1, 2, 3])), [(4, Inside::Together)]);
    }

    #[test]
    fn neighbours_tell_how_to_turn() {
        for turn in [&[0][..], &[2], &[0, 3], &[1, 2, 3]] {
            let shells = of(&[[0, 1, 2, 3]], turn);
            assert_eq!(kinds(&shells), [(4, Inside::ByWinding)]);
            let is_turned = |t: &usize| shells[0].turned[*t];
            let all = (0..4).filter(|t| turn.contains(t) != is_turned(t)).count();
            assert!(all == 0 || all == 4, "{turn:?}: {:?}", shells[0].turned);
            assert_eq!(shells[0].patches.len(), 1);
        }
    }

    #[test]
    fn shells_that_share_a_corner_are_apart() {
        let two = [[0, 1, 2, 3], [3, 4, 5, 6]];
        assert_eq!(kinds(&of(&two, &[])), [(8, Inside::Together)]);
        assert_eq!(kinds(&of(&two, &[5])), [(4, Inside::Together), (4, Inside::ByWinding)]);
        assert_eq!(kinds(&of(&two, &[0, 5])), [(4, Inside::ByWinding), (4, Inside::ByWinding)]);
    }

    #[test]
    fn shells_that_share_an_edge_are_one() {
        let two = [[0, 1, 2, 3], [2, 3, 4, 5]];
        assert_eq!(kinds(&of(&two, &[])), [(8, Inside::Together)]);
        let shells = of(&two, &[0]);
        assert_eq!(kinds(&shells), [(8, Inside::ByParity)]);
        assert_eq!(shells[0].patches.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
    }

    #[test]
    fn what_has_one_side_has_no_winding() {
        // The projective plane on six vertices: every edge has two triangles, and no way to turn them agrees.
        let faces = [
            [0, 1, 2],
            [0, 2, 3],
            [0, 3, 4],
            [0, 4, 5],
            [0, 5, 1],
            [1, 2, 4],
            [2, 3, 5],
            [3, 4, 1],
            [4, 5, 2],
            [5, 1, 3],
        ];
        let mesh = Mesh {
            positions: (0..6).map(|i| [f64::from(i), f64::from(i * i), f64::from(i * i * i)]).collect(),
            triangles: faces.to_vec(),
            materials: vec![MaterialId(0); faces.len()],
        };
        let components = components(&mesh);
        assert!(components[0].closed);
        assert_eq!(kinds(&shells(&mesh, &components[0])), [(10, Inside::ByParity)]);
    }
}
