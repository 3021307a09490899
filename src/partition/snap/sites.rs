//! Points and segments once each, with indices.

use super::Span;
use crate::lattice::Point;

/// The vertices, and the segments between them.
pub(super) struct Sites {
    /// Ascending, once each.
    pub(super) points: Vec<Point>,
    /// Segments between different points, as indices, the smaller first; ascending, once each.
    pub(super) pairs: Vec<[u32; 2]>,
    /// For each segment as given, which of `pairs` it is and whether from its first point to its second; `None` if its
    /// ends are one point.
    pub(super) given: Vec<Option<(u32, bool)>>,
}

/// Indexes the ends of the segments.
pub(super) fn collect(segments: &[[Point; 2]]) -> Sites {
    let ends: Vec<Point> = segments.iter().flatten().copied().collect();
    let (points, index) = unique(&ends, |p| {
        let bits = |c: i32| u64::from(c as u32 ^ (1 << 31));
        bits(p.x) << 32 | bits(p.y)
    });
    let mut proper = Vec::with_capacity(segments.len());
    for ends in index.chunks_exact(2) {
        if ends[0] != ends[1] {
            proper.push([ends[0].min(ends[1]), ends[0].max(ends[1])]);
        }
    }
    let (pairs, which) = unique(&proper, pair_key);
    let mut which = which.into_iter();
    let given = index
        .chunks_exact(2)
        .map(
            |ends| if ends[0] == ends[1] { None } else { which.next().map(|pair| (pair, ends[0] < ends[1])) },
        )
        .collect();
    Sites { points, pairs, given }
}

impl Sites {
    /// The segments' ends.
    pub(super) fn spans(&self) -> Vec<Span> {
        self.pairs.iter().map(|pair| pair.map(|v| self.points[v as usize])).collect()
    }

    /// Takes more points in.
    pub(super) fn add(&mut self, mut more: Vec<Point>) {
        more.sort_unstable();
        more.dedup();
        let mut points = Vec::with_capacity(self.points.len() + more.len());
        let mut index = Vec::with_capacity(self.points.len());
        let mut rest = more.into_iter().peekable();
        for &p in &self.points {
            while let Some(q) = rest.next_if(|&q| q <= p) {
                if q < p {
                    points.push(q);
                }
            }
            index.push(points.len() as u32);
            points.push(p);
        }
        points.extend(rest);
        self.points = points;
        // The order of the points that were there is the same, and so is that of the pairs.
        for v in self.pairs.iter_mut().flatten() {
            *v = index[*v as usize];
        }
    }
}

/// A number that orders pairs.
pub(super) fn pair_key(pair: &[u32; 2]) -> u64 {
    u64::from(pair[0]) << 32 | u64::from(pair[1])
}

/// The different items, in the order of their keys (different if the items are), and which of them each item is.
pub(super) fn unique<T: Copy>(items: &[T], key: impl Fn(&T) -> u64) -> (Vec<T>, Vec<u32>) {
    let mut sorted: Vec<(u64, u32)> =
        items.iter().enumerate().map(|(i, item)| (key(item), i as u32)).collect();
    sorted.sort_unstable();
    let mut different = Vec::new();
    let mut index = vec![0; items.len()];
    let mut last = None;
    for (k, i) in sorted {
        if last != Some(k) {
            different.push(items[i as usize]);
            last = Some(k);
        }
        index[i as usize] = different.len() as u32 - 1;
    }
    (different, index)
}
