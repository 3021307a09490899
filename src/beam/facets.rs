//! The polygons of a whole scene, and boxes around them, for pictures in which all triangles are drawn from near to far.
//!
//! The hierarchy that rays go through holds triangles, in parts where they are large, eight to a leaf. A picture has more of looking at those than of drawing
//! what they make: so here each polygon is there once, with all that drawing it takes in one place.

use glam::DVec3;

use super::backs::Hidden;
use super::joined::{Joined, Once};
use super::shade::Looks;
use crate::compile::hierarchy_over;
use crate::format::Views;
use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::trace::NONE;

/// The polygons below a root.
pub(crate) struct Facets {
    /// Node 0 is the root; a child with [`Leaf::BIT`] is a polygon.
    pub(super) nodes: Vec<NodeRecord>,
    /// Of each node's children that are polygons the planes.
    pub(super) planes: Vec<Planes>,
    all: Vec<Facet>,
    corners: Vec<[f64; 3]>,
}

/// The planes of some polygons, and which sides of them are never seen.
#[derive(Clone, Copy)]
pub(super) struct Planes {
    /// Unit normals.
    pub(super) normal: [[f32; LANES]; 3],
    /// How far along them from the scene's center, metres.
    pub(super) away: [f32; LANES],
    /// Those that are left out where the eye is on the left, and on the right; child i as bit i.
    pub(super) backs: [u8; 2],
    /// Children that are polygons.
    pub(super) which: u8,
}

impl Planes {
    const NONE: Planes = Planes { normal: [[0.0; LANES]; 3], away: [0.0; LANES], backs: [0; 2], which: 0 };
}

/// A polygon.
pub(super) struct Facet {
    /// Unit length.
    pub(super) normal: DVec3,
    pub(super) color: [f32; 3],
    /// One of its triangles.
    pub(super) triangle: u32,
    first: u32,
    count: u32,
}

impl Facets {
    /// Those below a root of a scene, in which no eye is within what hides backs.
    pub(super) fn new(tables: &Views, root: u32, joined: &Joined, looks: &Looks, hidden: &Hidden) -> Facets {
        let mut facets =
            Facets { nodes: Vec::new(), planes: Vec::new(), all: Vec::new(), corners: Vec::new() };
        let center = DVec3::from(tables.scene[0].center);
        let (mut once, mut bounds, mut planes) = (Once::new(), Vec::new(), Vec::new());
        once.begin(tables.triangles.len());
        for triangle in triangles_below(tables, root) {
            let polygon = joined.of(tables, triangle);
            if !once.insert(polygon.lead) {
                continue;
            }
            let first = facets.corners.len() as u32;
            facets.corners.extend(polygon.corners.iter().map(|&corner| tables.vertices[corner as usize]));
            let corners = &facets.corners[first as usize..];
            let from = DVec3::from(corners[0]);
            let normal: DVec3 = corners[1..]
                .windows(2)
                .map(|pair| (DVec3::from(pair[0]) - from).cross(DVec3::from(pair[1]) - from))
                .sum();
            let normal = normal.normalize_or_zero();
            let (mut lo, mut hi) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for &corner in corners {
                let corner = DVec3::from(corner) - center;
                (lo, hi) = (lo.min(corner), hi.max(corner));
            }
            bounds.push([lo.as_vec3().to_array(), hi.as_vec3().to_array()]);
            planes.push((normal, normal.dot(from - center), hidden.of(triangle)));
            let color = looks.of(tables, triangle);
            facets.all.push(Facet { normal, color, triangle, first, count: polygon.corners.len() as u32 });
        }
        facets.nodes = hierarchy_over(&bounds);
        facets.planes = facets
            .nodes
            .iter()
            .map(|node| {
                let mut all = Planes::NONE;
                for (lane, &child) in node.child.iter().enumerate().filter(|(_, child)| **child != NONE) {
                    if child & Leaf::BIT == 0 {
                        continue;
                    }
                    let (normal, away, [left, right]) = planes[(child & !Leaf::BIT) as usize];
                    all.which |= 1 << lane;
                    all.backs[0] |= u8::from(left) << lane;
                    all.backs[1] |= u8::from(right) << lane;
                    for axis in 0..3 {
                        all.normal[axis][lane] = normal[axis] as f32;
                    }
                    all.away[lane] = away as f32;
                }
                all
            })
            .collect();
        facets
    }

    #[inline(always)]
    pub(super) fn facet(&self, link: u32) -> &Facet {
        &self.all[(link & !Leaf::BIT) as usize]
    }

    #[inline(always)]
    pub(super) fn corners(&self, facet: &Facet) -> &[[f64; 3]] {
        &self.corners[facet.first as usize..][..facet.count as usize]
    }
}

/// All triangles below a root that rays are to meet, in order.
fn triangles_below(tables: &Views, root: u32) -> Vec<u32> {
    let (mut stack, mut all) = (vec![root], Vec::new());
    while let Some(link) = stack.pop() {
        if link == NONE {
            continue;
        }
        if link & Leaf::BIT == 0 {
            stack.extend(tables.nodes[link as usize].child);
            continue;
        }
        let leaf = Leaf::new(link);
        let block = &tables.blocks[leaf.block()];
        let lanes = (0..LANES).filter(|lane| leaf.mask() >> lane & 1 != 0);
        all.extend(lanes.filter(|&lane| !block.corner[0][lane].is_nan()).map(|lane| block.triangle[lane]));
    }
    all.sort_unstable();
    all.dedup();
    all
}
