//! Backs of closed surfaces, which their fronts hide: they are not drawn.

use std::ops::Range;

use glam::DVec3;

use super::shade::Looks;
use crate::format::Views;
use crate::format::records::{Facing, RunRecord};
use crate::trace::{NONE, crossings};

/// An eye that is farther than this outside of the box around some triangles, metres, is outside of what they enclose.
const CLEAR: f64 = 1e-6;

/// The triangles of a scene whose one side hides the other.
pub(crate) struct Backs {
    /// Of each run on which side of it the eye is where a triangle is left out: 1 where its corners go around to the left, -1 where to the right, 0 on none.
    hidden: Vec<i8>,
    /// Runs that have a hidden side, and follow each other: those of one element, since a surface may be of several materials; and the box around them.
    groups: Vec<(Range<u32>, [DVec3; 2])>,
    /// Of each block of triangles those that are left out where the eye is on the left, and on the right; triangle i as bit i.
    blocks: Vec<[u8; 2]>,
}

impl Backs {
    /// Of what is seen through, that has these looks, both sides show.
    pub(crate) fn new(tables: &Views, looks: &Looks) -> Backs {
        let side = |facing: u32| match Facing::of(facing) {
            Some(Facing::Outward) => -1,
            Some(Facing::Inward) => 1,
            _ => 0,
        };
        let same = |a: &RunRecord, b: &RunRecord| (a.element, a.facing) == (b.element, b.facing);
        let (mut groups, mut first, mut hidden) = (Vec::new(), 0, Vec::new());
        for group in tables.runs.chunk_by(same) {
            let runs = first..first + group.len() as u32;
            first = runs.end;
            let is_glass = group.iter().any(|run| looks.pane(run.material).is_some());
            let side = if is_glass { 0 } else { side(group[0].facing) };
            hidden.resize(first as usize, side);
            if side != 0 {
                let bounds = bounds(tables, &runs);
                groups.push((runs, bounds));
            }
        }
        let blocks = tables.blocks.iter().map(|block| {
            let mut masks = [0; 2];
            for (lane, &triangle) in block.triangle.iter().enumerate().filter(|(_, t)| **t != NONE) {
                match hidden[tables.run_of[triangle as usize] as usize] {
                    1 => masks[0] |= 1 << lane,
                    -1 => masks[1] |= 1 << lane,
                    _ => {}
                }
            }
            masks
        });
        Backs { groups, blocks: blocks.collect(), hidden }
    }

    /// What is left out as seen by an eye: in the internal frame, metres.
    pub(crate) fn seen_from(&self, tables: &Views, eye: DVec3) -> Hidden<'_> {
        let holds = |[lo, hi]: &[DVec3; 2]| eye.cmpge(lo - CLEAR).all() && eye.cmple(hi + CLEAR).all();
        let near = self.groups.iter().filter(|(_, bounds)| holds(bounds)).map(|(runs, _)| runs);
        Hidden {
            of: &self.hidden,
            blocks: &self.blocks,
            around: near.filter(|runs| encloses(tables, runs, eye)).cloned().collect(),
        }
    }
}

/// The box around the triangles of some runs.
fn bounds(tables: &Views, runs: &Range<u32>) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    corners(tables, runs)
        .flatten()
        .map(DVec3::from)
        .fold(start, |[lo, hi], corner| [lo.min(corner), hi.max(corner)])
}

/// The corners of the triangles of some runs.
fn corners(tables: &Views, runs: &Range<u32>) -> impl Iterator<Item = [[f64; 3]; 3]> {
    let end = tables.runs.get(runs.end as usize).map_or(tables.triangles.len(), |next| next.first as usize);
    let triangles = &tables.triangles[tables.runs[runs.start as usize].first as usize..end];
    triangles.iter().map(|corners| corners.map(|v| tables.vertices[v as usize]))
}

/// Whether an eye is inside of what the triangles of some runs enclose, or so near to them that it cannot be told.
fn encloses(tables: &Views, runs: &Range<u32>, eye: DVec3) -> bool {
    let aside = [DVec3::ZERO, DVec3::splat(CLEAR), DVec3::splat(-CLEAR)];
    aside.into_iter().any(|aside| crossings(corners(tables, runs), (eye + aside).to_array()).winding != 0)
}

/// Which backs one eye does not see.
#[derive(Clone, Debug)]
pub(crate) struct Hidden<'a> {
    of: &'a [i8],
    blocks: &'a [[u8; 2]],
    /// Runs that enclose the eye.
    around: Vec<Range<u32>>,
}

impl Hidden<'_> {
    /// Whether the eye is within any.
    #[cfg(all(test, feature = "compile"))]
    pub(super) fn is_within_any(&self) -> bool {
        !self.around.is_empty()
    }

    /// Of a block's triangles those that are left out where the eye is on the left, and on the right, if the eye is within none.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> [u32; 2] {
        if self.around.is_empty() { self.blocks[block].map(u32::from) } else { [0; 2] }
    }

    /// Whether a triangle of a run is left out, on that side of which the eye is where its corners go around to the left, or else on the other.
    #[inline(always)]
    pub(super) fn holds(&self, run: u32, is_left: bool) -> bool {
        let hidden = self.of.get(run as usize).copied().unwrap_or(0);
        hidden == if is_left { 1 } else { -1 } && !self.around.iter().any(|runs| runs.contains(&run))
    }
}
