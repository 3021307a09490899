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
    slabs: Slabs,
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
        let slabs = Slabs::of(groups.iter().map(|(_, bounds)| bounds));
        Backs { groups, slabs, blocks: blocks.collect(), hidden }
    }

    /// Whether an eye that is in nothing closed sees none of a triangle where it is on that side of it from which its corners go around to the left, and on
    /// the other.
    pub(super) fn sides(&self, tables: &Views, triangle: u32) -> [bool; 2] {
        sides(&self.hidden, tables.run_of[triangle as usize])
    }

    /// What is left out as seen by an eye: in the internal frame, metres.
    pub(crate) fn seen_from<'a>(&'a self, tables: &'a Views, eye: DVec3) -> Hidden<'a> {
        let holds = |[lo, hi]: &[DVec3; 2]| eye.cmpge(lo - CLEAR).all() && eye.cmple(hi + CLEAR).all();
        let near = self.slabs.at(eye).iter().map(|&group| &self.groups[group as usize]);
        let near = near.filter(|(_, bounds)| holds(bounds)).map(|(runs, _)| runs);
        Hidden {
            tables,
            of: &self.hidden,
            blocks: &self.blocks,
            around: near.filter(|runs| encloses(tables, runs, eye)).cloned().collect(),
        }
    }
}

/// Boxes by where along an axis they are, so that those around a point are found without looking at all.
struct Slabs {
    /// The longest axis, where along it the slabs begin, and how thick each is.
    axis: usize,
    first: f64,
    thick: f64,
    boxes: Vec<Vec<u32>>,
}

impl Slabs {
    /// About as many as the square root of how many boxes there are, so that neither looking for them nor keeping them takes long.
    fn of<'b>(boxes: impl ExactSizeIterator<Item = &'b [DVec3; 2]> + Clone) -> Slabs {
        let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [lo, hi] = boxes.clone().fold(start, |[lo, hi], other| [lo.min(other[0]), hi.max(other[1])]);
        let count = (boxes.len() as f64).sqrt().ceil();
        let axis = (hi - lo).max_position();
        let (first, thick) = (lo[axis] - CLEAR, ((hi - lo)[axis] + 2.0 * CLEAR) / count);
        let mut slabs = Slabs { axis, first, thick, boxes: vec![Vec::new(); count as usize] };
        for (number, [lo, hi]) in (0..).zip(boxes) {
            let [from, to] = [lo[axis] - CLEAR, hi[axis] + CLEAR].map(|along| slabs.slab(along));
            // Runs without triangles have no box.
            slabs.boxes.get_mut(from..=to).into_iter().flatten().for_each(|slab| slab.push(number));
        }
        slabs
    }

    /// The slab that is there, or the nearest.
    fn slab(&self, along: f64) -> usize {
        (((along - self.first) / self.thick) as usize).min(self.boxes.len().saturating_sub(1))
    }

    /// All boxes that may hold a point, and perhaps others.
    fn at(&self, point: DVec3) -> &[u32] {
        self.boxes.get(self.slab(point[self.axis])).map_or(&[], Vec::as_slice)
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
        let end =
            tables.runs.get(run as usize + 1).map_or(tables.triangles.len(), |next| next.first as usize);
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
#[derive(Clone)]
pub(crate) struct Hidden<'a> {
    tables: &'a Views,
    of: &'a [i8],
    blocks: &'a [[u8; 2]],
    /// Runs that enclose the eye.
    around: Vec<Range<u32>>,
}

impl Hidden<'_> {
    /// Whether the eye is within any.
    pub(super) fn is_within_any(&self) -> bool {
        !self.around.is_empty()
    }

    /// Of a block's triangles those that are left out where the eye is on the left, and on the right.
    #[inline(always)]
    pub(super) fn of_block(&self, block: usize) -> [u32; 2] {
        if self.around.is_empty() { self.blocks[block].map(u32::from) } else { self.but_around(block) }
    }

    /// The same, where the eye is within some.
    fn but_around(&self, block: usize) -> [u32; 2] {
        let mut masks = [0; 2];
        for (lane, &triangle) in
            self.tables.blocks[block].triangle.iter().enumerate().filter(|(_, t)| **t != NONE)
        {
            let of = self.of(triangle);
            masks = [masks[0] | u32::from(of[0]) << lane, masks[1] | u32::from(of[1]) << lane];
        }
        masks
    }

    /// Whether a triangle is left out on that side of which the eye is where its corners go around to the left, and on the other.
    pub(super) fn of(&self, triangle: u32) -> [bool; 2] {
        let run = self.tables.run_of[triangle as usize];
        if self.around.iter().any(|runs| runs.contains(&run)) {
            return [false; 2];
        }
        sides(self.of, run)
    }
}

/// Whether the triangles of a run are left out where the eye is on their left, and on their right.
fn sides(hidden: &[i8], run: u32) -> [bool; 2] {
    let hidden = hidden.get(run as usize).copied().unwrap_or(0);
    [hidden == 1, hidden == -1]
}
