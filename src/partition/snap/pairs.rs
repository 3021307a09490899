//! Pairs of segments that may meet, found by halving the plan where that pays.

use super::{Budget, SnapError, Span};
use crate::lattice::Point;

/// A rectangle of pixels, ends included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Area {
    low: [i32; 2],
    high: [i32; 2],
}

/// So few segments are compared each with each. (Measured: 8 to 24 make little difference.)
const FEW: usize = 12;
/// Segments of a rectangle that are looked at to choose where to cut it.
const SAMPLE: usize = 32;
/// Cuts in a row that may fail to pay off before the segments of a rectangle are compared each with each.
const PATIENCE: u32 = 2;
/// Among so few segments cuts that do not pay off are not tried.
const MANY: usize = 1000;
/// Cuts one in the other, at most.
const DEEPEST: u32 = 100;

impl Area {
    pub(super) fn holds(&self, p: Point) -> bool {
        (self.low[0]..=self.high[0]).contains(&p.x) && (self.low[1]..=self.high[1]).contains(&p.y)
    }

    fn cut(&self, axis: usize, at: i32) -> [Area; 2] {
        let (mut left, mut right) = (*self, *self);
        left.high[axis] = at - 1;
        right.low[axis] = at;
        [left, right]
    }
}

/// Whether the segment may meet pixels from `low` to `high`. Exact enough for long segments among small rectangles.
#[inline]
pub(super) fn reaches(&[a, b]: &Span, low: [i32; 2], high: [i32; 2]) -> bool {
    // A segment meets no pixel outside the box about its ends.
    let (bottom, top) = (a.y.min(b.y), a.y.max(b.y));
    if b.x < low[0] || a.x > high[0] || top < low[1] || bottom > high[1] {
        return false;
    }
    // A segment shorter than the rectangle along an axis rarely passes it by in a corner of that box.
    b.x - a.x <= high[0] - low[0] || top - bottom <= high[1] - low[1] || straddles(a, b, low, high)
}

/// Whether the line through `a` and `b` meets the closed rectangle of the pixels from `low` to `high`.
#[inline]
pub(super) fn straddles(a: Point, b: Point, low: [i32; 2], high: [i32; 2]) -> bool {
    let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    // From `a` to the middle, and the size, in half units: products stay below 2^53.
    let middle = |axis: usize, c: i32| i64::from(low[axis]) + i64::from(high[axis]) - 2 * i64::from(c);
    let size = |axis: usize| i64::from(high[axis]) - i64::from(low[axis]) + 1;
    (dx * middle(1, a.y) - dy * middle(0, a.x)).abs() <= dx.abs() * size(1) + dy.abs() * size(0)
}

/// Whether the boxes about two segments have no point in common.
pub(super) fn are_apart(&[a, b]: &Span, &[c, d]: &Span) -> bool {
    b.x < c.x || d.x < a.x || a.y.max(b.y) < c.y.min(d.y) || c.y.max(d.y) < a.y.min(b.y)
}

/// Calls `visit` with every two segments that meet one pixel, and with others. They may come several times, with
/// different rectangles; these do not overlap, and any pixel that both meet is in one with which they come.
pub(super) fn visit(
    spans: &[Span],
    budget: &mut Budget,
    mut visit: impl FnMut(&Area, u32, u32) -> Result<(), SnapError>,
) -> Result<(), SnapError> {
    let Some(first) = spans.first() else { return Ok(()) };
    let mut area = Area { low: [first[0].x, first[0].y], high: [first[0].x, first[0].y] };
    for p in spans.iter().flatten() {
        for (axis, c) in [p.x, p.y].into_iter().enumerate() {
            area.low[axis] = area.low[axis].min(c);
            area.high[axis] = area.high[axis].max(c);
        }
    }
    let mut search = Search { spans, budget, visit: &mut visit, lists: Vec::new(), right: Vec::new() };
    search.lists.extend(0..spans.len() as u32);
    search.area(area, 0, PATIENCE, DEEPEST)
}

struct Search<'a, V> {
    spans: &'a [Span],
    budget: &'a mut Budget,
    visit: &'a mut V,
    /// The segments of each rectangle that is being searched, one list after the other.
    lists: Vec<u32>,
    right: Vec<u32>,
}

impl<V: FnMut(&Area, u32, u32) -> Result<(), SnapError>> Search<'_, V> {
    /// Searches the rectangle with the last of the lists, which starts at `from`, by at most `deepest` cuts one in the
    /// other.
    fn area(&mut self, area: Area, from: usize, patience: u32, deepest: u32) -> Result<(), SnapError> {
        let count = self.lists.len() - from;
        if count <= FEW || deepest == 0 {
            return self.compare(&area, from);
        }
        let Some((axis, at, pays)) = self.choose(&area, from) else { return self.compare(&area, from) };
        let patience = match (pays, patience) {
            (true, _) => PATIENCE,
            (false, 0) => return self.compare(&area, from),
            (false, _) if count < MANY => return self.compare(&area, from),
            (false, _) => patience - 1,
        };
        self.budget.test(count as u64)?;
        let [left, right] = area.cut(axis, at);
        let end = self.lists.len();
        for i in from..end {
            let id = self.lists[i];
            let span = &self.spans[id as usize];
            if reaches(span, left.low, left.high) {
                self.lists.push(id);
            }
            if reaches(span, right.low, right.high) {
                self.right.push(id);
            }
        }
        let middle = self.lists.len();
        self.lists.append(&mut self.right);
        self.area(right, middle, patience, deepest - 1)?;
        self.lists.truncate(middle);
        self.area(left, end, patience, deepest - 1)?;
        self.lists.truncate(end);
        Ok(())
    }

    /// Where to cut: the axis, the first pixel of the right side, and whether that saves comparisons.
    fn choose(&self, area: &Area, from: usize) -> Option<(usize, i32, bool)> {
        let list = &self.lists[from..];
        let stride = list.len().div_ceil(SAMPLE);
        let mut sample = [[Point::default(); 2]; SAMPLE];
        let mut size = 0;
        for &id in list.iter().step_by(stride) {
            sample[size] = self.spans[id as usize];
            size += 1;
        }
        let sample = &sample[..size];
        let mut best: Option<(usize, usize, i32)> = None;
        for axis in 0..2 {
            if area.low[axis] == area.high[axis] {
                continue;
            }
            let at = median(area, axis, sample);
            let [left, right] = area.cut(axis, at);
            let l = sample.iter().filter(|s| reaches(s, left.low, left.high)).count();
            let r = sample.iter().filter(|s| reaches(s, right.low, right.high)).count();
            let cost = l * l + r * r;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, at));
            }
        }
        let (cost, axis, at) = best?;
        Some((axis, at, 10 * cost < 9 * size * size))
    }

    fn compare(&mut self, area: &Area, from: usize) -> Result<(), SnapError> {
        let list = &self.lists[from..];
        let count = list.len() as u64;
        self.budget.test(count * count.saturating_sub(1) / 2)?;
        for (i, &s) in list.iter().enumerate() {
            for &t in &list[i + 1..] {
                (self.visit)(area, s, t)?;
            }
        }
        Ok(())
    }
}

/// The middle one of the ends that lie in the rectangle, or its own middle; never its lowest pixel.
fn median(area: &Area, axis: usize, sample: &[Span]) -> i32 {
    let mut ends = [0; 2 * SAMPLE];
    let mut count = 0;
    for &p in sample.iter().flatten() {
        if area.holds(p) {
            ends[count] = [p.x, p.y][axis];
            count += 1;
        }
    }
    let at = if count == 0 {
        // Half of at most 2^25.
        area.low[axis] + (area.high[axis] - area.low[axis]) / 2
    } else {
        *ends[..count].select_nth_unstable(count / 2).1
    };
    at.max(area.low[axis] + 1)
}
