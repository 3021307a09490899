//! Meshes that are closed but for how they were written: corners computed once for each face, edges with a vertex of
//! another face in their middle, boxes glued together with a face left inside.
//!
//! Only the partition uses them, so that such elements carve. What rays meet are the mesh's own triangles all the same,
//! and a ray that starts inside of such an element starts in no solid.

use std::collections::{HashMap, HashSet};

use enfilade_importers::Mesh;
use glam::DVec3;

use crate::components::rotated;

/// Corners no farther apart are one, metres; and edges that pass a corner this near have it in their middle. An element whose open parts the first
/// does not close, all of them, is tried with the next; what none closes is left as the first leaves it.
const WELDS: [f64; 4] = [1e-4, 3e-4, 1e-3, 4e-3];

/// Times that edges are split, each near its middle.
const ROUNDS: usize = 8;

/// More pairs of open edges and corners are not looked at.
const MOST_PAIRS: usize = 1 << 20;

/// Meshes of more triangles are left as they are: they have more faces than any volume pays for.
const MOST_TRIANGLES: usize = 1 << 17;

/// Meshes that reach farther than this are left as they are, metres: they are not of the building.
const FARTHEST: f64 = 1e5;

/// A mesh with other triangles, each of which is one of the source's or a part of it.
#[derive(Clone, Debug, Default)]
pub(super) struct Mended {
    pub(super) mesh: Mesh,
    /// The index of each triangle in the source.
    pub(super) source: Vec<u32>,
    /// Triangles of the source that close nothing: left inside, or narrower than what was welded.
    pub(super) inner: Vec<u32>,
}

/// The triangles `of` a mesh, welded, split where vertices lie on edges, without faces left inside.
pub(super) fn mend(mesh: &Mesh, of: &[u32]) -> Mended {
    let corners = of.iter().flat_map(|&t| mesh.corners(t as usize)).flatten();
    if of.len() > MOST_TRIANGLES || corners.into_iter().any(|c| c.abs() > FARTHEST) {
        let mut same = Mended { mesh: mesh.clone(), source: of.to_vec(), inner: Vec::new() };
        same.mesh.triangles = of.iter().map(|&t| mesh.triangles[t as usize]).collect();
        return same;
    }
    let first = mend_within(mesh, of, WELDS[0]);
    if first.is_closed() {
        return first;
    }
    // Farther than they must corners are not moved, nor for nothing.
    let others = WELDS[1..].iter().map(|&farthest| mend_within(mesh, of, farthest));
    others.into_iter().find(Mended::is_closed).unwrap_or(first)
}

impl Mended {
    fn is_closed(&self) -> bool {
        !self.mesh.triangles.is_empty() && edges(&self.mesh).values().all(|of| of.len() % 2 == 0)
    }
}

/// The same, of corners no farther apart than `farthest`.
fn mend_within(mesh: &Mesh, of: &[u32], farthest: f64) -> Mended {
    let mut mended = weld(mesh, of, farthest);
    for _ in 0..ROUNDS {
        if !split(&mut mended, farthest) {
            break;
        }
    }
    take_doubles(&mut mended);
    take_inner(&mut mended);
    mended.inner.sort_unstable();
    mended.inner.dedup();
    mended
}

/// Takes out triangles that welding has made those of others, corner by corner and looking the same way: a component would
/// pass over them. Rays may meet them nearer.
fn take_doubles(mended: &mut Mended) {
    let mut seen = HashSet::new();
    let is_double: Vec<bool> = mended.mesh.triangles.iter().map(|&t| !seen.insert(rotated(t))).collect();
    move_inside(mended, &is_double);
}

/// Moves the triangles that are marked to those that close nothing.
fn move_inside(mended: &mut Mended, taken: &[bool]) {
    let (old, sources) = (std::mem::take(&mut mended.mesh.triangles), std::mem::take(&mut mended.source));
    for ((triangle, source), taken) in old.into_iter().zip(sources).zip(taken) {
        if *taken {
            mended.inner.push(source);
        } else {
            mended.mesh.triangles.push(triangle);
            mended.source.push(source);
        }
    }
}

/// Joins corners that lie no farther than `farthest` from each other to the first of them.
fn weld(mesh: &Mesh, of: &[u32], farthest: f64) -> Mended {
    let mut mended = Mended::default();
    let mut cubes: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let mut number: HashMap<u32, u32> = HashMap::new();
    let positions = &mut mended.mesh.positions;
    let mut welded = |v: u32| {
        *number.entry(v).or_insert_with(|| {
            let p = DVec3::from(mesh.positions[v as usize]);
            let cube = (p / farthest).floor().to_array().map(|c| c as i64);
            let near = (0..27).flat_map(|i: i64| {
                let by = [i % 3, i / 3 % 3, i / 9].map(|c| c - 1);
                let other = [0, 1, 2].map(|axis| cube[axis].saturating_add(by[axis]));
                cubes.get(&other).map_or(&[][..], Vec::as_slice).iter().copied()
            });
            let same = near.filter(|&w| DVec3::from(positions[w as usize]).distance(p) <= farthest).min();
            same.unwrap_or_else(|| {
                let new = positions.len() as u32;
                positions.push(p.to_array());
                cubes.entry(cube).or_default().push(new);
                new
            })
        })
    };
    let corners: Vec<[u32; 3]> = of.iter().map(|&t| mesh.triangles[t as usize].map(&mut welded)).collect();
    for (&source, [a, b, c]) in of.iter().zip(corners) {
        if a != b && b != c && c != a {
            mended.mesh.triangles.push([a, b, c]);
            mended.source.push(source);
        } else {
            mended.inner.push(source);
        }
    }
    mended
}

/// Which triangles each edge has, the edge's lower corner first.
fn edges(mesh: &Mesh) -> HashMap<[u32; 2], Vec<u32>> {
    let mut edges: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([from.min(to), from.max(to)]).or_default().push(t as u32);
        }
    }
    edges
}

/// Splits the triangles at open edges where another open edge ends on them. Whether any was.
fn split(mended: &mut Mended, farthest: f64) -> bool {
    let mut open: Vec<[u32; 2]> =
        edges(&mended.mesh).into_iter().filter(|(_, of)| of.len() % 2 == 1).map(|(edge, _)| edge).collect();
    open.sort_unstable();
    let mut ends: Vec<u32> = open.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    if open.len().saturating_mul(ends.len()) > MOST_PAIRS {
        return false;
    }
    let at = |v: u32| DVec3::from(mended.mesh.positions[v as usize]);
    // One point an edge and a round: the parts are looked at in the next.
    let mut cuts: HashMap<[u32; 2], u32> = HashMap::new();
    for edge in open {
        let (a, way) = (at(edge[0]), at(edge[1]) - at(edge[0]));
        let length = way.length();
        let on = ends.iter().copied().filter(|v| !edge.contains(v)).filter_map(|v| {
            let along = (at(v) - a).dot(way) / length;
            let off = (at(v) - a - way * (along / length)).length();
            (off <= farthest && along > farthest && along < length - farthest)
                .then_some((along - length / 2.0, v))
        });
        // The one nearest to the middle, of equals the first.
        if let Some((_, v)) = on.min_by(|x, y| x.0.abs().total_cmp(&y.0.abs()).then(x.1.cmp(&y.1))) {
            cuts.insert(edge, v);
        }
    }
    if cuts.is_empty() {
        return false;
    }
    let old = std::mem::take(&mut mended.mesh.triangles);
    let sources = std::mem::take(&mut mended.source);
    for ([a, b, c], source) in old.into_iter().zip(sources) {
        let cut = [[a, b, c], [b, c, a], [c, a, b]].into_iter().find_map(|[p, q, r]| {
            let v = *cuts.get(&[p.min(q), p.max(q)])?;
            (v != r).then_some([[p, v, r], [v, q, r]])
        });
        let parts = cut.map_or(vec![[a, b, c]], |parts| parts.to_vec());
        mended.source.resize(mended.source.len() + parts.len(), source);
        mended.mesh.triangles.extend(parts);
    }
    true
}

/// Takes out faces that close nothing: of patches between edges of three triangles and more, the smallest, as long as fewer
/// edges are open without them. A flat face is smaller than any other surface on its edges.
fn take_inner(mended: &mut Mended) {
    let edges = edges(&mended.mesh);
    let mut count: HashMap<[u32; 2], usize> = edges.iter().map(|(edge, of)| (*edge, of.len())).collect();
    let mut odd = count.values().filter(|count| *count % 2 == 1).count();
    if odd == 0 || !edges.values().any(|of| of.len() > 2) {
        return;
    }
    let triangles = &mended.mesh.triangles;
    let sides = |t: u32| {
        let [a, b, c] = triangles[t as usize];
        [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
    };
    let mut patch = vec![u32::MAX; triangles.len()];
    let mut patches: Vec<(f64, Vec<u32>)> = Vec::new();
    for first in 0..triangles.len() as u32 {
        if patch[first as usize] != u32::MAX {
            continue;
        }
        let index = patches.len() as u32;
        patch[first as usize] = index;
        let (mut members, mut next) = (vec![first], 0);
        while next < members.len() {
            for edge in sides(members[next]) {
                if let [one, other] = edges[&edge][..] {
                    for t in [one, other] {
                        if patch[t as usize] == u32::MAX {
                            patch[t as usize] = index;
                            members.push(t);
                        }
                    }
                }
            }
            next += 1;
        }
        let area = |&t: &u32| {
            let [a, b, c] = mended.mesh.corners(t as usize).map(DVec3::from);
            (b - a).cross(c - a).length()
        };
        patches.push((members.iter().map(area).sum(), members));
    }
    patches.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1[0].cmp(&b.1[0])));
    let mut taken = vec![false; triangles.len()];
    for (_, members) in patches {
        let mut border: Vec<[u32; 2]> = members.iter().flat_map(|&t| sides(t)).collect();
        border.sort_unstable();
        // Each edge, how many triangles it has, and how many without the patch.
        let own: Vec<([u32; 2], usize, usize)> = border
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], count[&run[0]], count[&run[0]].saturating_sub(run.len())))
            .collect();
        let is_inner = own.iter().all(|&(_, all, rest)| rest >= 2 || (all, rest) == (2, 0));
        let closes = own.iter().filter(|(_, all, rest)| rest % 2 == 0 && all % 2 == 1).count();
        let opens = own.iter().filter(|(_, all, rest)| rest % 2 == 1 && all % 2 == 0).count();
        if is_inner && closes > opens {
            for &(edge, _, rest) in &own {
                count.insert(edge, rest);
            }
            members.iter().for_each(|&t| taken[t as usize] = true);
            odd = odd + opens - closes;
        }
        if odd == 0 {
            break;
        }
    }
    move_inside(mended, &taken);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::components;

    /// A box from its corners, as quads: bottom, top, and four sides.
    fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Vec<[[f64; 3]; 4]> {
        let at = |x: usize, y: usize, z: usize| {
            let pick = |axis: usize, k: usize| if k == 0 { lo[axis] } else { hi[axis] };
            [pick(0, x), pick(1, y), pick(2, z)]
        };
        vec![
            [at(0, 0, 0), at(0, 1, 0), at(1, 1, 0), at(1, 0, 0)],
            [at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)],
            [at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1)],
            [at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1)],
            [at(1, 1, 0), at(0, 1, 0), at(0, 1, 1), at(1, 1, 1)],
            [at(0, 1, 0), at(0, 0, 0), at(0, 0, 1), at(0, 1, 1)],
        ]
    }

    /// Equal corners are one vertex, to the last bit.
    fn mesh(quads: &[[[f64; 3]; 4]]) -> Mesh {
        let mut mesh = Mesh::default();
        for quad in quads {
            let v = quad.map(|p| match mesh.positions.iter().position(|q| *q == p) {
                Some(index) => index as u32,
                None => {
                    mesh.positions.push(p);
                    mesh.positions.len() as u32 - 1
                }
            });
            mesh.triangles.extend([[v[0], v[1], v[2]], [v[0], v[2], v[3]]]);
        }
        mesh
    }

    /// The volume of the one closed component that mending makes.
    fn volume(mesh: &Mesh) -> (f64, Mended) {
        assert!(components(mesh).iter().any(|component| !component.closed), "nothing to mend");
        let all: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        let mended = mend(mesh, &all);
        let parts = components(&mended.mesh);
        assert!(
            parts.len() == 1 && parts[0].closed,
            "{} parts, {} open edges",
            parts.len(),
            parts[0].open_edges
        );
        assert_eq!(mended.source.len(), mended.mesh.triangles.len());
        (parts[0].signed_volume, mended)
    }

    #[test]
    fn corners_computed_for_each_face() {
        let mut quads = cuboid([0.0; 3], [4.0, 0.3, 2.5]);
        for (i, p) in quads.iter_mut().flatten().enumerate() {
            p[i % 3] += 1e-6 * (i % 7) as f64;
        }
        let (volume, mended) = volume(&mesh(&quads));
        assert!((volume - 3.0).abs() < 1e-4 && mended.inner.is_empty(), "{volume}");
    }

    #[test]
    fn corners_are_joined_no_farther_than_it_takes() {
        for (off, most) in [(2e-5, 1e-4), (9e-5, 3e-4), (2.5e-4, 1e-3), (1e-3, 4e-3)] {
            let mut quads = cuboid([0.0; 3], [4.0, 0.3, 2.5]);
            for (i, p) in quads.iter_mut().flatten().enumerate() {
                p[i % 3] += off * ((i % 5) as f64 / 2.0 - 1.0);
            }
            // As near as its thickness.
            let thin = cuboid([9.0, 0.0, 0.0], [9.0 + 2.0 * most, 1.0, 1.0]);
            let (volume, mended) = volume(&mesh(&quads));
            assert!((volume - 3.0).abs() < 20.0 * off && mended.mesh.positions.len() == 8, "{off}: {volume}");
            let all: Vec<u32> = (0..12).collect();
            assert_eq!(mend(&mesh(&thin), &all).mesh.positions.len(), 8);
        }
    }

    #[test]
    fn vertices_in_the_middle_of_edges() {
        // The long side is two quads, the top still one.
        let mut quads = cuboid([0.0; 3], [4.0, 0.3, 2.5]);
        let side = quads.remove(2);
        let (bottom, top) = ([1.5, 0.0, 0.0], [1.5, 0.0, 2.5]);
        quads.extend([[side[0], bottom, top, side[3]], [bottom, side[1], side[2], top]]);
        let (volume, mended) = volume(&mesh(&quads));
        assert!((volume - 3.0).abs() < 1e-9 && mended.inner.is_empty(), "{volume}");
        // Of twelve triangles and two more, one on the top and one below are parts of two.
        assert_eq!((mended.mesh.triangles.len(), mended.source.iter().max()), (16, Some(&13)));
    }

    #[test]
    fn faces_left_inside() {
        let mut quads = cuboid([0.0; 3], [1.0, 0.3, 2.5]);
        for x in [1.0, 2.0] {
            let mut next = cuboid([x, 0.0, 0.0], [x + 1.0, 0.3, 2.5]);
            next.remove(5);
            quads.extend(next);
        }
        let (volume, mended) = volume(&mesh(&quads));
        assert!((volume - 2.25).abs() < 1e-9, "{volume}");
        assert_eq!(mended.inner, [6, 7, 18, 19]);
    }

    #[test]
    fn faces_written_twice() {
        let once = cuboid([0.0; 3], [4.0, 0.3, 2.5]);
        let mut quads = once.clone();
        quads.extend([once[2], once[4]]);
        for (i, p) in quads.iter_mut().flatten().enumerate() {
            p[i % 3] += 1e-6 * (i % 7) as f64;
        }
        let (volume, mended) = volume(&mesh(&quads));
        assert!((volume - 3.0).abs() < 1e-4, "{volume}");
        assert_eq!((mended.source, mended.inner), ((0..12).collect(), vec![12, 13, 14, 15]));
    }

    #[test]
    fn what_is_open_stays_open() {
        let mut quads = cuboid([0.0; 3], [1.0; 3]);
        quads.pop();
        let open = mesh(&quads);
        let mended = mend(&open, &(0..10).collect::<Vec<_>>());
        assert_eq!((mended.mesh.triangles, mended.inner), (open.triangles, vec![]));
    }
}
