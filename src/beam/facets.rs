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
    nodes: Vec<Node>,
    /// Those of a node one after the other.
    all: Vec<Facet>,
    /// Those of the polygons that have more than [`FEW`], in the internal frame, metres: one polygon's follow each other.
    corners: Vec<DVec3>,
}

/// A node, and the planes of those of its children that are polygons.
#[repr(align(64))]
pub(super) struct Node {
    pub(super) boxes: NodeRecord,
    pub(super) planes: Planes,
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

/// Corners that a polygon keeps with itself.
const FEW: usize = 4;

/// A polygon: two lines of the memory, fetched ahead, and nothing else is needed to draw most.
#[derive(Clone, Copy)]
#[repr(align(128))]
pub(super) struct Facet {
    /// Its corners, in the internal frame, metres, if these are no more.
    few: [DVec3; FEW],
    /// Unit length.
    normal: [f32; 3],
    /// Red, green and blue where it faces the lamp, at most 255 each.
    pub(super) color: [f32; 3],
    /// One of its triangles.
    pub(super) triangle: u32,
    /// How many corners it has, whether it is left out where the eye is on its left, and on its right, whether one sees through it, and where its corners are.
    packed: u32,
}

const _: () = assert!(size_of::<Facet>() == 128);

impl Facet {
    const COUNT: u32 = 0xf;
    const LEFT: u32 = 1 << 4;
    const RIGHT: u32 = 1 << 5;
    const GLASS: u32 = 1 << 6;
    const FIRST: u32 = 7;

    /// Unit length, to seven digits.
    #[inline(always)]
    pub(super) fn normal(&self) -> DVec3 {
        DVec3::from(self.normal.map(f64::from))
    }

    /// Whether an eye that is in nothing closed sees none of it from its left, and from its right.
    #[inline(always)]
    pub(super) fn backs(&self) -> [bool; 2] {
        [self.packed & Facet::LEFT != 0, self.packed & Facet::RIGHT != 0]
    }

    /// Whether one sees through it.
    #[inline(always)]
    pub(super) fn is_glass(&self) -> bool {
        self.packed & Facet::GLASS != 0
    }

    fn count(&self) -> usize {
        (self.packed & Facet::COUNT) as usize
    }
}

impl Facets {
    /// Those of a scene. None where no hierarchy can be made: without the feature `compile`, or if it would be nested too deeply.
    pub(super) fn new(tables: &Views, joined: &Joined, looks: &Looks, backs: &Backs) -> Option<Facets> {
        if !cfg!(feature = "compile") {
            return None;
        }
        let center = DVec3::from(tables.scene[0].center);
        let (mut polygons, mut bounds, mut once) = (Vec::new(), Vec::new(), Once::new());
        once.begin(tables.triangles.len());
        for triangle in met(tables) {
            let polygon = joined.of(tables, triangle);
            if !once.insert(polygon.lead) {
                continue;
            }
            let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            let of = |v: &u32| DVec3::from(tables.vertices[*v as usize]);
            let [lo, hi] =
                polygon.corners.iter().map(of).fold(start, |[lo, hi], at| [lo.min(at), hi.max(at)]);
            bounds.push([lo, hi].map(|corner| (corner - center).as_vec3().to_array()));
            polygons.push(triangle);
        }
        let (mut all, mut corners) = (Vec::with_capacity(polygons.len()), Vec::new());
        let mut node = |mut boxes: NodeRecord| {
            let mut planes = Planes::NONE;
            for (lane, link) in boxes.child.iter_mut().enumerate() {
                if *link == NONE || *link & Leaf::BIT == 0 {
                    continue;
                }
                let triangle = polygons[(*link & !Leaf::BIT) as usize];
                *link = Leaf::BIT | all.len() as u32;
                let own = joined.of(tables, triangle).corners.iter();
                let own: Vec<DVec3> = own.map(|&v| DVec3::from(tables.vertices[v as usize])).collect();
                let normal: DVec3 =
                    own[1..].windows(2).map(|pair| (pair[0] - own[0]).cross(pair[1] - own[0])).sum();
                let normal = normal.normalize_or_zero();
                let sides = backs.sides(tables, triangle);
                for (axis, of) in planes.normal.iter_mut().enumerate() {
                    of[lane] = normal[axis] as f32;
                }
                planes.away[lane] = normal.dot(own[0] - center) as f32;
                for (backs, is_hidden) in planes.backs.iter_mut().zip(sides) {
                    *backs |= u8::from(is_hidden) << lane;
                }
                let mut few = [DVec3::ZERO; FEW];
                few.iter_mut().zip(&own).for_each(|(few, corner)| *few = *corner);
                let is_glass = looks.pane_of(tables, triangle).is_some();
                let flags =
                    [Facet::LEFT, Facet::RIGHT, Facet::GLASS].iter().zip([sides[0], sides[1], is_glass]);
                let flags = flags.fold(own.len() as u32, |all, (&bit, is)| all | if is { bit } else { 0 });
                let first =
                    u32::try_from(corners.len()).ok().filter(|first| first >> (32 - Facet::FIRST) == 0)?;
                if own.len() > FEW {
                    corners.extend(&own);
                }
                all.push(Facet {
                    few,
                    normal: normal.as_vec3().to_array(),
                    color: looks.of(tables, triangle),
                    triangle,
                    packed: flags | first << Facet::FIRST,
                });
            }
            Some(Node { boxes, planes })
        };
        let nodes = over_boxes(&bounds)?.into_iter().map(&mut node).collect::<Option<_>>()?;
        Some(Facets { nodes, all, corners })
    }

    /// The link of the root, if there is any polygon.
    pub(super) fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }

    #[inline(always)]
    pub(super) fn node(&self, link: u32) -> &Node {
        &self.nodes[link as usize]
    }

    /// A polygon and its corners.
    #[inline(always)]
    pub(super) fn facet(&self, link: u32) -> (&Facet, &[DVec3]) {
        let facet = &self.all[(link & !Leaf::BIT) as usize];
        let count = facet.count();
        let corners = match facet.few.get(..count) {
            Some(few) => few,
            None => &self.corners[(facet.packed >> Facet::FIRST) as usize..][..count],
        };
        (facet, corners)
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
