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
    /// The runs of an element that has some with a hidden side, since a surface may be of several materials, and its triangles may look to either side; and the
    /// box around those that have.
    groups: Vec<(Range<u32>, [DVec3; 2])>,
    /// Of each block of triangles those that are left out where the eye is on the left, and on the right; triangle i as bit i.
    blocks: Vec<[u8; 2]>,
}

impl Backs {
    /// Of what is seen through, that has these looks, both sides show.
    pub(crate) fn new(tables: &Views, looks: &Looks) -> Backs {
        let (mut groups, mut first, mut hidden) = (Vec::new(), 0, Vec::new());
        for group in tables.runs.chunk_by(|a, b| a.element == b.element) {
            let runs = first..first + group.len() as u32;
            first = runs.end;
            let closed = || group.iter().filter(|run| side(run.facing) != 0);
            let is_glass = closed().any(|run| looks.pane(run.material).is_some());
            hidden.extend(group.iter().map(|run| if is_glass { 0 } else { side(run.facing) }));
            if !is_glass && closed().next().is_some() {
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

/// On which side of it the eye is where a triangle that looks so is left out: 1 where its corners go around to the left, -1 where to the right, 0 on none.
fn side(facing: u32) -> i8 {
    match Facing::of(facing) {
        Some(Facing::Outward) => -1,
        Some(Facing::Inward) => 1,
        _ => 0,
    }
}

/// The box around those triangles of some runs that have a hidden side.
fn bounds(tables: &Views, runs: &Range<u32>) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    corners(tables, runs)
        .flatten()
        .map(DVec3::from)
        .fold(start, |[lo, hi], corner| [lo.min(corner), hi.max(corner)])
}

/// The corners of those triangles of some runs that have a hidden side, turned so that all look outward.
fn corners(tables: &Views, runs: &Range<u32>) -> impl Iterator<Item = [[f64; 3]; 3]> {
    runs.clone().filter(|&run| side(tables.runs[run as usize].facing) != 0).flat_map(move |run| {
        let end = tables.runs.get(run as usize + 1).map_or(tables.triangles.len(), |next| next.first as usize);
        let RunRecord { first, facing, .. } = tables.runs[run as usize];
        let is_inward = side(facing) > 0;
        tables.triangles[first as usize..end].iter().map(move |corners| {
            let [a, b, c] = corners.map(|v| tables.vertices[v as usize]);
            if is_inward { [a, c, b] } else { [a, b, c] }
        })
    })
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
