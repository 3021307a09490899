//! Straightening the shared chains of a planar map.
//!
//! Where links between equal columns go, vertices remain that only they needed: a wall's line has a kink of one lattice
//! unit wherever another storey's edge crossed it. Chains between junctions are simplified (Douglas and Peucker,
//! "Algorithms for the reduction of the number of points required to represent a digitized line or its caricature",
//! Cartographica 10(2), 1973). A chain is one object, so that both its sides get the same new line.
//!
//! The map stays the same map: a straight link stands for a part of a chain only if no vertex that stays lies in the
//! convex hull of that part, and if it neither crosses nor doubles another link; all that is decided exactly. Then each
//! part can shrink onto its link inside its hull without passing a vertex, so that no face is turned over or
//! swallowed. Where it does not hold, the part is split at its farthest vertex, which stays.

mod chains;
mod near;
mod strokes;
#[cfg(test)]
mod tests;

use crate::lattice::{Point, is_between, orient};

use chains::Chains;
use strokes::Strokes;

/// A new link, as an old one runs along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Index of the new link.
    pub link: u32,
    /// Whether the old link runs from the new link's first vertex to its second, rather than back.
    pub forward: bool,
}

/// A planar map with straightened chains.
#[derive(Clone, Debug, PartialEq)]
pub struct Straightened {
    /// Vertices that are still used, in the order of the old ones.
    pub vertices: Vec<Point>,
    /// Links; none crosses, overlaps or doubles another.
    pub links: Vec<[u32; 2]>,
    /// For each old link what stands for it; `None` if it was not to be kept.
    pub of: Vec<Option<Step>>,
    /// The largest distance of a removed vertex from the link that stands for its links, lattice units.
    pub largest_displacement: f64,
    /// Vertices of kept links that were removed.
    pub removed: u32,
}

/// Straightens the chains of a planar map, after dropping the links that are not to be kept.
///
/// `links` must not cross, touch or double each other but at shared vertices. A vertex is removed only if exactly two
/// kept links meet there and have the same `class`; exactly straight vertices of that kind always are. No removed
/// vertex lies farther than `tolerance` lattice units from its new link. A closed chain keeps at least three vertices.
/// The result depends on the arguments alone.
///
/// # Panics
///
/// If `class` or `keep` has another length than `links`, or a link names a vertex that does not exist.
pub fn straighten(
    vertices: &[Point],
    links: &[[u32; 2]],
    class: &[u32],
    keep: &[bool],
    tolerance: f64,
) -> Straightened {
    assert!(class.len() == links.len() && keep.len() == links.len());
    let chains = Chains::trace(vertices, links, class, keep);
    let mut strokes = Strokes::new(vertices, &chains, tolerance);
    strokes.lay_all();
    strokes.mend();
    let largest_displacement = strokes.largest_displacement();
    let used = chains.iter().map(|chain| chain.links.len()).sum::<usize>();
    let straight = join_straight(vertices, &chains, strokes.ends());
    assemble(vertices, &chains, &straight, links.len(), used, largest_displacement)
}

/// Joins neighbouring strokes that lie on one line: the ends of strokes along each chain, less those.
fn join_straight(vertices: &[Point], chains: &Chains, ends: Vec<Vec<u32>>) -> Vec<Vec<u32>> {
    let mut joined = ends;
    for (chain, ends) in chains.iter().zip(&mut joined) {
        let at = |end: u32| vertices[chain.vertices[end as usize] as usize];
        let mut kept: Vec<u32> = Vec::with_capacity(ends.len());
        for (k, &end) in ends.iter().enumerate() {
            if let (Some(&before), Some(&after)) = (kept.last(), ends.get(k + 1)) {
                let (a, b, c) = (at(before), at(end), at(after));
                if orient(a, b, c) == 0 && is_between(a, c, b) {
                    continue;
                }
            }
            kept.push(end);
        }
        *ends = kept;
    }
    joined
}

fn assemble(
    vertices: &[Point],
    chains: &Chains,
    ends: &[Vec<u32>],
    old_links: usize,
    used: usize,
    largest_displacement: f64,
) -> Straightened {
    let mut number = vec![None; vertices.len()];
    let mut total = vec![false; vertices.len()];
    for (chain, ends) in chains.iter().zip(ends) {
        for &v in chain.vertices {
            total[v as usize] = true;
        }
        for &end in ends {
            number[chain.vertices[end as usize] as usize] = Some(0);
        }
    }
    let mut result = Straightened {
        vertices: Vec::new(),
        links: Vec::with_capacity(used),
        of: vec![None; old_links],
        largest_displacement,
        removed: 0,
    };
    for (v, number) in number.iter_mut().enumerate() {
        match number {
            Some(number) => {
                *number = result.vertices.len() as u32;
                result.vertices.push(vertices[v]);
            }
            None => result.removed += u32::from(total[v]),
        }
    }
    for (chain, ends) in chains.iter().zip(ends) {
        let new = |end: u32| number[chain.vertices[end as usize] as usize].unwrap_or_default();
        for ends in ends.windows(2) {
            let link = result.links.len() as u32;
            result.links.push([new(ends[0]), new(ends[1])]);
            for step in &chain.links[ends[0] as usize..ends[1] as usize] {
                result.of[step.link as usize] = Some(Step { link, forward: step.forward });
            }
        }
    }
    result
}
