//! Crossings of segments, rounded.

use super::{Budget, SnapError, Span, pairs};
use crate::lattice::{Point, orient};

/// How many pairs of segments cross inside both, and the middles of the pixels in which they do, in no order, some
/// repeated, without some that are ends. Segments that touch or overlap do so at an end of one: a vertex anyway.
pub(super) fn find(spans: &[Span], budget: &mut Budget) -> Result<(u64, Vec<Point>), SnapError> {
    let limit = budget.limits.crossings;
    let (mut count, mut found) = (0, Vec::new());
    pairs::visit(spans, budget, |area, s, t| {
        let [s, t] = [s, t].map(|i| &spans[i as usize]);
        if let Some(at) = crossing(s, t)
            && area.holds(at)
        {
            count += 1;
            if count > limit {
                return Err(SnapError::Crossings(limit));
            }
            if !s.contains(&at) && !t.contains(&at) {
                found.push(at);
            }
        }
        Ok(())
    })?;
    Ok((count, found))
}

/// The middle of the pixel in which two segments cross inside both.
pub(super) fn crossing(&[a, b]: &Span, &[c, d]: &Span) -> Option<Point> {
    if pairs::are_apart(&[a, b], &[c, d]) {
        return None;
    }
    let (from, to) = (orient(a, b, c), orient(a, b, d));
    if !(from < 0 && to > 0 || from > 0 && to < 0) {
        return None;
    }
    let (left, right) = (orient(c, d, a), orient(c, d, b));
    if !(left < 0 && right > 0 || left > 0 && right < 0) {
        return None;
    }
    // c + (d - c) share / whole, with a positive whole below 2^52.
    let whole = (from - to).abs();
    let share = from.abs();
    Some(Point { x: along(c.x, d.x, share, whole), y: along(c.y, d.y, share, whole) })
}

/// `from + (to - from) share / whole` rounded, halves up: the integer in whose half-open pixel it lies.
fn along(from: i32, to: i32, share: i64, whole: i64) -> i32 {
    let run = i64::from(to) - i64::from(from);
    // Both are below 2^53 and so exact, and the run is at most 2^25: off by less than 2^-26.
    let near = run as f64 * (share as f64 / whole as f64) + 0.5;
    let low = near.floor();
    let steps = if (1e-6..1.0 - 1e-6).contains(&(near - low)) {
        low as i64
    } else {
        let (run, share, whole) = (i128::from(run), i128::from(share), i128::from(whole));
        (2 * run * share + whole).div_euclid(2 * whole) as i64
    };
    // Between the ends, hence an i32.
    (i64::from(from) + steps) as i32
}
