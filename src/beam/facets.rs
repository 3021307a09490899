//! The polygons of a whole scene, and boxes around them, for pictures in which all of them are drawn from near to far.
//!
//! The hierarchy that rays go through holds triangles, eight to a leaf, and large ones in several leaves. Pictures from outside took more time for looking at
//! those than for drawing what is seen. So each polygon is here once, as a child of a node, with all that is known of it in one place. To gather
//! them takes as long as a dozen pictures: it pays where there are many.

use glam::DVec3;

use super::backs::Backs;
use super::joined::{Joined, Once};
use super::shade::Looks;
use super::walk::AROUND;
#[cfg(feature = "compile")]
use crate::compile::over_boxes;
use crate::format::Views;
use crate::format::records::{LANES, Leaf, NodeRecord};
use crate::trace::NONE;

/// All polygons of a scene.
pub(crate) struct Facets {
    /// The root is the first; a child with [`Leaf::BIT`] is the polygon of that number.
    nodes: Vec<NodeRecord>,
    /// Of each node's children that are polygons.
    planes: Vec<Planes>,
    all: Vec<Facet>,
    /// In the internal frame, metres: those of a polygon follow each other.
    corners: Vec<DVec3>,
}

/// The planes of up to eight polygons.
#[derive(Clone, Copy)]
pub(super) struct Planes {
    /// Unit normals, to the side from which the corners go around counter-clockwise.
    pub(super) normal: [[f32; LANES]; 3],
    /// How far along them from the scene's center, metres.
    pub(super) away: [f32; LANES],
    /// Those that are left out where the eye is on their left, and on their right; child i as bit i.
    pub(super) backs: [u8; 2],
}

impl Planes {
    const NONE: Planes = Planes { normal: [[0.0; LANES]; 3], away: [0.0; LANES], backs: [0; 2] };
}

/// A polygon.
pub(super) struct Facet {
    /// Unit length.
    pub(super) normal: DVec3,
    /// Red, green and blue where it faces the lamp, at most 255 each.
    pub(super) color: [f32; 3],
    /// One of its triangles.
    pub(super) triangle: u32,
    /// Where its corners are.
    first: u32,
    count: u32,
}

impl Facets {
    /// Those of a scene. None where no hierarchy can be made: without the feature `compile`, or if it would be nested too deeply.
    pub(super) fn new(tables: &Views, joined: &Joined, looks: &Looks, backs: &Backs) -> Option<Facets> {
        if !cfg!(feature = "compile") {
            return None;
        }
        let center = DVec3::from(tables.scene[0].center);
        let (mut all, mut corners, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        let mut once = Once::new();
        once.begin(tables.triangles.len());
        for triangle in met(tables) {
            let polygon = joined.of(tables, triangle);
            if !once.insert(polygon.lead) {
                continue;
            }
            let first = corners.len();
            corners.extend(polygon.corners.iter().map(|&v| DVec3::from(tables.vertices[v as usize])));
            let own = &corners[first..];
            let normal: DVec3 =
                own[1..].windows(2).map(|pair| (pair[0] - own[0]).cross(pair[1] - own[0])).sum();
            let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            let [lo, hi] = own.iter().fold(start, |[lo, hi], corner| [lo.min(*corner), hi.max(*corner)]);
            bounds.push([lo, hi].map(|corner| (corner - center).as_vec3().to_array()));
            all.push(Facet {
                normal: normal.normalize_or_zero(),
                color: looks.of(tables, triangle),
                triangle,
                first: first as u32,
                count: own.len() as u32,
            });
        }
        let mut facets = Facets { nodes: over_boxes(&bounds)?, planes: Vec::new(), all, corners };
        let planes = |node: &NodeRecord| {
            let mut planes = Planes::NONE;
            for (lane, &link) in node.child.iter().enumerate() {
                if link == NONE || link & Leaf::BIT == 0 {
                    continue;
                }
                let (facet, corners) = facets.facet(link);
                for axis in 0..3 {
                    planes.normal[axis][lane] = facet.normal[axis] as f32;
                }
                planes.away[lane] = facet.normal.dot(corners[0] - center) as f32;
                let sides = backs.sides(tables, facet.triangle);
                for (backs, is_hidden) in planes.backs.iter_mut().zip(sides) {
                    *backs |= u8::from(is_hidden) << lane;
                }
            }
            planes
        };
        facets.planes = facets.nodes.iter().map(planes).collect();
        Some(facets)
    }

    /// The link of the root, if there is any polygon.
    pub(super) fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }

    #[inline(always)]
    pub(super) fn node(&self, link: u32) -> (&NodeRecord, &Planes) {
        (&self.nodes[link as usize], &self.planes[link as usize])
    }

    /// A polygon and its corners.
    #[inline(always)]
    pub(super) fn facet(&self, link: u32) -> (&Facet, &[DVec3]) {
        let facet = &self.all[(link & !Leaf::BIT) as usize];
        (facet, &self.corners[facet.first as usize..][..facet.count as usize])
    }

    /// Has what waits in the memory brought nearer.
    #[inline(always)]
    pub(super) fn fetch(&self, link: u32) {
        if link & Leaf::BIT == 0 {
            super::simd::fetch(&self.nodes[link as usize]);
        } else {
            super::simd::fetch(&self.all[(link & !Leaf::BIT) as usize]);
        }
    }
}

/// All triangles that rays are to meet, in order.
fn met(tables: &Views) -> Vec<u32> {
    let (mut stack, mut all) = (vec![tables.cells[AROUND as usize].root], Vec::new());
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
        // Others are no numbers.
        let is_met = |lane: &usize| leaf.mask() >> lane & 1 != 0 && !block.corner[0][*lane].is_nan();
        all.extend((0..LANES).filter(is_met).map(|lane| block.triangle[lane]));
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// Needs `obvhs`.
#[cfg(not(feature = "compile"))]
fn over_boxes(_: &[[[f32; 3]; 2]]) -> Option<Vec<NodeRecord>> {
    None
}
