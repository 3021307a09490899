//! Snap rounding: segments between lattice points become links between lattice points that share nothing but ends.
//!
//! A *hot pixel* is the unit square, half-open as in [`in_pixel`](crate::lattice::in_pixel), about each end point and
//! about each crossing rounded to the lattice; its middle is a vertex. Every segment is led through the vertices of all
//! hot pixels that it meets, in their order along it. That is a round.
//!
//! **One round is enough for no link to cross another, or to pass through a vertex** (Hobby, *Practical segment
//! intersection with finite precision output*, 1999; Guibas and Marimont, *Rounding arrangements dynamically*, 1998): a
//! segment that misses a pixel is led past the pixel's middle on the same side, for no vertex on its way moved farther
//! than the pixel's own corner. But a link may then pass the pixel of a vertex, nearly touching it. So links are led
//! through hot pixels again, till none meets any but its own (Halperin and Packer, *Iterated snap rounding*, 2002): then
//! rounding the result once more changes nothing, and every vertex is at least half a unit from every link. Later rounds
//! make no new crossing and hence no new vertex, so that a link needs another look only if it is new.
//!
//! **The end.** Rounding to the lattice is monotone along each axis and leaves lattice points alone, so a vertex on a
//! link's way lies in the box about the link's ends. Ways are therefore monotone along both axes, their order is that of
//! their coordinates, without ties, and the lengths |dx| + |dy| of the links that take the place of one add up to its own:
//! it can be parted but so often. Since every round is sound in itself, a limit on rounds makes nothing wrong.
//!
//! **How far.** Each vertex that a round puts on a way lies within sqrt(1/2) of the link it was led off, and within 1/2
//! along each axis. Thus a way of k rounds and its segment lie within k sqrt(1/2) of each other (Hausdorff).
//! [`Snapped::displacement`] is what it really was.
//!
//! All decisions are made in integers.

mod check;
mod crossings;
mod pairs;
mod route;
mod sites;
#[cfg(test)]
mod tests;
mod tree;

pub use check::Flaw;

use crate::lattice::{LARGEST, Point};

/// What [`snap`] may spend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SnapLimits {
    /// Rounds after which links may pass through pixels of vertices: 1 keeps every way within half a unit of its
    /// segment along each axis. At least 1.
    pub rounds: u32,
    /// Pairs of segments that cross inside both.
    pub crossings: u64,
    /// Steps of all ways together, and of all links of a round.
    pub steps: u64,
    /// Comparisons of one segment with another, or with a box or a point: what bounds the time.
    pub tests: u64,
}

impl Default for SnapLimits {
    /// Rounds till nothing changes, in practice; memory of a few hundred megabytes; a minute or so.
    fn default() -> SnapLimits {
        SnapLimits { rounds: 100, crossings: 1 << 24, steps: 1 << 25, tests: 1 << 34 }
    }
}

/// Why segments were not rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SnapError {
    /// An end point is not on the lattice.
    #[error("segment {segment} ends at {}, {}, beyond the lattice", at.x, at.y)]
    Beyond {
        /// Index of the segment.
        segment: usize,
        /// Its end.
        at: Point,
    },
    /// More segments than an index counts.
    #[error("{0} segments are more than can be rounded together")]
    Segments(usize),
    /// [`SnapLimits::crossings`] is exceeded.
    #[error("edges cross more than {0} times")]
    Crossings(u64),
    /// [`SnapLimits::steps`] is exceeded.
    #[error("rounded edges have more than {0} steps")]
    Steps(u64),
    /// [`SnapLimits::tests`] is exceeded.
    #[error("edges lie so close that rounding them takes more than {0} comparisons")]
    Tests(u64),
}

/// Segments rounded until none crosses another.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Snapped {
    /// All end points and rounded crossings, ascending (by x, then y).
    pub vertices: Vec<Point>,
    /// Pairs of vertices, the smaller first, ascending: edges that meet nothing but at their ends.
    pub links: Vec<[u32; 2]>,
    /// Where each segment's way starts in `steps`, and the end of the last.
    starts: Vec<u32>,
    steps: Vec<Step>,
    /// Rounds in which a link was led through another vertex.
    pub rounds: u32,
    /// Whether no link meets the pixel of any vertex but its ends'. Not so only if [`SnapLimits::rounds`] came first.
    pub settled: bool,
    /// The largest distance between a segment and its way, lattice units.
    pub displacement: f64,
    /// Pairs of (different) segments that cross inside both.
    pub crossings: u64,
    /// Vertices that are no segment's end.
    pub added: usize,
    /// Segments whose way is not the segment itself.
    pub rerouted: usize,
}

/// A link on a segment's way, and the direction in which the way takes it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Step(u32);

impl Step {
    fn new(link: u32, forward: bool) -> Step {
        Step(link << 1 | u32::from(forward))
    }

    /// Index of the link.
    pub fn link(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether it leads from the link's first (smaller) vertex to its second.
    pub fn forward(self) -> bool {
        self.0 & 1 == 1
    }

    /// The same link the other way.
    pub fn back(self) -> Step {
        Step(self.0 ^ 1)
    }
}

impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.forward() { '+' } else { '-' }, self.link())
    }
}

impl Snapped {
    /// The way of a segment from its first end to its second; empty if they are one point.
    ///
    /// # Panics
    ///
    /// If there is no such segment.
    pub fn way(&self, segment: usize) -> &[Step] {
        &self.steps[self.starts[segment] as usize..self.starts[segment + 1] as usize]
    }

    /// The vertices from which and to which a step leads.
    pub fn ends(&self, step: Step) -> [u32; 2] {
        let [u, v] = self.links[step.link()];
        if step.forward() { [u, v] } else { [v, u] }
    }

    /// The vertex at a point. Every end of every segment has one.
    pub fn vertex(&self, at: Point) -> Option<u32> {
        self.vertices.binary_search(&at).ok().map(|i| i as u32)
    }
}

/// Rounds segments until none crosses another, within [`SnapLimits::default`].
///
/// Segments may repeat, overlap and touch. One whose ends are one point makes a vertex there, through which others are
/// led, and has an empty way.
///
/// # Errors
///
/// If an end is beyond the lattice or a limit is exceeded.
pub fn snap(segments: &[[Point; 2]]) -> Result<Snapped, SnapError> {
    snap_within(segments, &SnapLimits::default())
}

/// [`snap`] within other limits.
///
/// # Errors
///
/// If an end is beyond the lattice or a limit is exceeded.
pub fn snap_within(segments: &[[Point; 2]], limits: &SnapLimits) -> Result<Snapped, SnapError> {
    // Steps and ends of segments are counted in u32 with one bit to spare.
    if segments.len() > (u32::MAX / 4) as usize {
        return Err(SnapError::Segments(segments.len()));
    }
    let lattice = -LARGEST..=LARGEST;
    for (segment, ends) in segments.iter().enumerate() {
        for &at in ends {
            if !lattice.contains(&at.x) || !lattice.contains(&at.y) {
                return Err(SnapError::Beyond { segment, at });
            }
        }
    }
    let mut budget = Budget { limits: *limits, tests: limits.tests };
    let mut sites = sites::collect(segments);
    let (crossings, rounded) = crossings::find(&sites.spans(), &mut budget)?;
    let ends = sites.points.len();
    sites.add(rounded);
    let added = sites.points.len() - ends;
    let routes = route::route(&sites, &mut budget)?;
    Ok(routes.finish(sites, crossings, added))
}

/// What is left of the limits.
struct Budget {
    limits: SnapLimits,
    tests: u64,
}

impl Budget {
    fn unlimited() -> Budget {
        let limits = SnapLimits { rounds: u32::MAX, crossings: u64::MAX, steps: u64::MAX, tests: u64::MAX };
        Budget { limits, tests: u64::MAX }
    }

    /// Takes `count` tests off.
    fn test(&mut self, count: u64) -> Result<(), SnapError> {
        self.tests = self.tests.checked_sub(count).ok_or(SnapError::Tests(self.limits.tests))?;
        Ok(())
    }
}

/// A segment with its ends in ascending order.
type Span = [Point; 2];
