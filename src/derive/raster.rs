//! A plan as a grid of small squares.

use glam::DVec2;

/// Squares are no smaller than this, metres.
const STEP: f64 = 0.1;

/// No grid has more squares.
const MOST: f64 = 1e6;

/// A place in the plan as squares.
pub(super) struct Raster {
    low: DVec2,
    step: f64,
    size: [usize; 2],
    /// By square, x fastest: whether its middle is in the place.
    inside: Vec<bool>,
    /// Squares that were taken out of it.
    blocked: Vec<usize>,
}

/// Where two pieces of a place meet.
pub(super) struct Contact {
    pub(super) pieces: [u32; 2],
    /// The middle of their border there, metres.
    pub(super) middle: DVec2,
}

impl Raster {
    /// The squares whose middles are in any of some triangles; `None` if there are none.
    pub(super) fn new(triangles: &[[DVec2; 3]]) -> Option<Raster> {
        let corners = || triangles.iter().flatten();
        let low = corners().copied().reduce(DVec2::min)?;
        let high = corners().copied().reduce(DVec2::max)?;
        let extent = high - low;
        let step = STEP.max((extent.x * extent.y / MOST).sqrt()).max(extent.max_element() / MOST);
        if !step.is_finite() {
            return None;
        }
        // A row of squares around it, too.
        let low = low - step * 1.5;
        let size = [extent.x, extent.y].map(|length| (length / step) as usize + 4);
        let mut raster =
            Raster { low, step, size, inside: vec![false; size[0] * size[1]], blocked: Vec::new() };
        for triangle in triangles {
            raster.fill(triangle);
        }
        Some(raster)
    }

    pub(super) fn step(&self) -> f64 {
        self.step
    }

    fn middle(&self, i: usize) -> DVec2 {
        let [x, y] = [i % self.size[0], i / self.size[0]].map(|c| c as f64 + 0.5);
        self.low + DVec2::new(x, y) * self.step
    }

    /// Row by row: from where to where the triangle is at the middle of each.
    fn fill(&mut self, triangle: &[DVec2; 3]) {
        let corners = triangle.map(|p| (p - self.low) / self.step);
        let [from, to] =
            [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])];
        let row = |y: f64| (y.max(0.0) as usize).min(self.size[1]);
        for y in row(from.y)..row(to.y + 1.0) {
            let middle = y as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..3 {
                let (p, q) = (corners[i], corners[(i + 1) % 3]);
                if p.y.min(q.y) <= middle && middle <= p.y.max(q.y) {
                    let along = if p.y == q.y { 0.0 } else { (middle - p.y) / (q.y - p.y) };
                    let x = p.x + (q.x - p.x) * along;
                    (left, right) = (left.min(x), right.max(x));
                    if p.y == q.y {
                        (left, right) = (left.min(q.x), right.max(q.x));
                    }
                }
            }
            if left > right {
                continue;
            }
            // Squares whose middles are between.
            let column = |x: f64| (x.max(0.0) as usize).min(self.size[0]);
            let range = column((left - 0.5).ceil())..column((right - 0.5).floor() + 1.0);
            self.inside[y * self.size[0] + range.start..y * self.size[0] + range.end.max(range.start)]
                .fill(true);
        }
    }

    pub(super) fn is_inside(&self, i: usize) -> bool {
        self.inside[i]
    }

    /// The square that a point is in.
    pub(super) fn at(&self, point: DVec2) -> Option<usize> {
        let p = (point - self.low) / self.step;
        let is_on = p.x >= 0.0 && p.y >= 0.0 && p.x < self.size[0] as f64 && p.y < self.size[1] as f64;
        is_on.then(|| p.y as usize * self.size[0] + p.x as usize)
    }

    /// Whether a line between two points of the border is in the place, its ends left aside.
    pub(super) fn is_clear(&self, [a, b]: [DVec2; 2]) -> bool {
        let length = a.distance(b);
        let margin = (1.5 * self.step).min(0.25 * length);
        let steps = ((length - 2.0 * margin) / (0.5 * self.step)).ceil().max(1.0) as usize;
        (0..=steps).all(|i| {
            let along = margin + (length - 2.0 * margin) * i as f64 / steps as f64;
            self.at(a + (b - a) * (along / length)).is_some_and(|i| self.inside[i])
        })
    }

    /// Takes a line out of the place, so that nothing passes it.
    pub(super) fn block(&mut self, [a, b]: [DVec2; 2]) {
        let steps = (a.distance(b) / (0.25 * self.step)).ceil().max(1.0) as usize;
        let mut before: Option<usize> = None;
        for i in 0..=steps {
            let Some(i) = self.at(a + (b - a) * (i as f64 / steps as f64)) else { continue };
            // Not from corner to corner either.
            let between = before.map(|before| before / self.size[0] * self.size[0] + i % self.size[0]);
            for i in between.into_iter().chain([i]) {
                if std::mem::replace(&mut self.inside[i], false) {
                    self.blocked.push(i);
                }
            }
            before = Some(i);
        }
    }

    /// The place, and what is not of it within it where that is smaller than `least` square metres.
    pub(super) fn without_specks(&self, least: f64) -> Vec<bool> {
        let pieces = self.pieces(|i, j| self.inside[i] == self.inside[j]);
        let count = pieces.iter().max().map_or(0, |most| *most as usize + 1);
        let mut cells = vec![0u64; count];
        pieces.iter().for_each(|&piece| cells[piece as usize] += 1);
        let is_speck = |piece: u32| cells[piece as usize] as f64 * self.step * self.step < least;
        (0..pieces.len()).map(|i| self.inside[i] || is_speck(pieces[i])).collect()
    }

    /// Numbers of pieces: neighbours by a side that are `alike` are of one.
    pub(super) fn pieces(&self, alike: impl Fn(usize, usize) -> bool) -> Vec<u32> {
        let mut pieces = vec![u32::MAX; self.inside.len()];
        let mut count = 0;
        let mut waiting = Vec::new();
        for first in 0..pieces.len() {
            if pieces[first] != u32::MAX {
                continue;
            }
            pieces[first] = count;
            waiting.push(first);
            while let Some(i) = waiting.pop() {
                for j in self.beside(i) {
                    if pieces[j] == u32::MAX && alike(i, j) {
                        pieces[j] = count;
                        waiting.push(j);
                    }
                }
            }
            count += 1;
        }
        pieces
    }

    fn beside(&self, i: usize) -> impl Iterator<Item = usize> + use<> {
        let [width, height] = self.size;
        let (x, y) = (i % width, i / width);
        let beside = [
            (x > 0).then(|| i - 1),
            (x + 1 < width).then(|| i + 1),
            (y > 0).then(|| i - width),
            (y + 1 < height).then(|| i + width),
        ];
        beside.into_iter().flatten()
    }

    /// The pieces beside what was taken out, each once.
    pub(super) fn beside_blocked(&self, pieces: &[u32]) -> Vec<u32> {
        let mut beside: Vec<u32> =
            self.blocked.iter().flat_map(|&i| self.beside(i)).map(|i| pieces[i]).collect();
        beside.sort_unstable();
        beside.dedup();
        beside
    }

    /// Where pieces of kind 2 meet pieces of kind 1.
    pub(super) fn contacts(&self, pieces: &[u32], kind: impl Fn(usize) -> u8) -> Vec<Contact> {
        // A square of the one beside a square of the other; of several, the first.
        let touches = |i: usize| {
            let other = self.beside(i).find(|&j| kind(j) == 1)?;
            (kind(i) == 2).then(|| [pieces[i], pieces[other]])
        };
        let at: Vec<Option<[u32; 2]>> = (0..pieces.len()).map(touches).collect();
        let mut is_seen = vec![false; at.len()];
        let mut contacts = Vec::new();
        for first in 0..at.len() {
            let Some(own) = at[first].filter(|_| !is_seen[first]) else { continue };
            is_seen[first] = true;
            let (mut waiting, mut sum, mut count) = (vec![first], DVec2::ZERO, 0.0);
            while let Some(i) = waiting.pop() {
                sum += self.middle(i);
                count += 1.0;
                // By a corner, too: two steps by a side.
                for j in self.beside(i).flat_map(|j| self.beside(j).chain([j])) {
                    if at[j] == Some(own) && !std::mem::replace(&mut is_seen[j], true) {
                        waiting.push(j);
                    }
                }
            }
            contacts.push(Contact { pieces: own, middle: sum / count });
        }
        contacts
    }
}

/// By square: how far, metres, its middle is from the nearest that `is_target`; infinite if none is. Exact on the grid (Felzenszwalb and
/// Huttenlocher, Distance Transforms of Sampled Functions, 2012).
pub(super) fn distances(raster: &Raster, is_target: impl Fn(usize) -> bool) -> Vec<f64> {
    let [width, height] = raster.size;
    let mut squares: Vec<f64> =
        (0..width * height).map(|i| if is_target(i) { 0.0 } else { f64::INFINITY }).collect();
    let mut line = Vec::new();
    for y in 0..height {
        line.clear();
        line.extend_from_slice(&squares[y * width..(y + 1) * width]);
        lower_envelope(&line, |x, square| squares[y * width + x] = square);
    }
    for x in 0..width {
        line.clear();
        line.extend((0..height).map(|y| squares[y * width + x]));
        lower_envelope(&line, |y, square| squares[y * width + x] = square);
    }
    squares.into_iter().map(|square| square.sqrt() * raster.step).collect()
}

/// For each place p: the least of f(q) + (p - q)^2 over all q.
fn lower_envelope(f: &[f64], mut set: impl FnMut(usize, f64)) {
    // The parabolas that are lowest somewhere, and from where on.
    let mut lowest: Vec<(usize, f64)> = Vec::new();
    for (q, &value) in f.iter().enumerate().filter(|(_, value)| value.is_finite()) {
        let square = |q: usize| (q * q) as f64;
        loop {
            let Some(&(p, from)) = lowest.last() else {
                lowest.push((q, f64::NEG_INFINITY));
                break;
            };
            let meet = ((value + square(q)) - (f[p] + square(p))) / (2.0 * (q - p) as f64);
            if meet > from {
                lowest.push((q, meet));
                break;
            }
            lowest.pop();
        }
    }
    let mut k = 0;
    for p in 0..f.len() {
        while k + 1 < lowest.len() && lowest[k + 1].1 < p as f64 {
            k += 1;
        }
        let least = lowest.get(k).map_or(f64::INFINITY, |&(q, _)| {
            let off = p as f64 - q as f64;
            f[q] + off * off
        });
        set(p, least);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(low: [f64; 2], high: [f64; 2]) -> [[DVec2; 3]; 2] {
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let [a, b, c, d] = [p(low[0], low[1]), p(high[0], low[1]), p(high[0], high[1]), p(low[0], high[1])];
        [[a, b, c], [a, c, d]]
    }

    #[test]
    fn distances_are_those_of_the_nearest() {
        let raster = Raster::new(&square([0.0, 0.0], [3.0, 2.0])).unwrap();
        let targets: Vec<usize> = vec![40, 333, 700];
        let found = distances(&raster, |i| targets.contains(&i));
        for i in (0..found.len()).step_by(7) {
            let by_hand = targets.iter().map(|&t| raster.middle(t).distance(raster.middle(i)));
            assert!((found[i] - by_hand.fold(f64::INFINITY, f64::min)).abs() < 1e-9);
        }
        assert!(distances(&raster, |_| false).iter().all(|d| d.is_infinite()));
    }

    #[test]
    fn what_is_blocked_is_two_pieces_and_columns_are_specks() {
        let mut raster = Raster::new(&square([0.0, 0.0], [4.0, 4.0])).unwrap();
        let inside = |raster: &Raster| {
            let pieces = raster.pieces(|i, j| raster.is_inside(i) == raster.is_inside(j));
            let mut own: Vec<u32> =
                (0..pieces.len()).filter(|&i| raster.is_inside(i)).map(|i| pieces[i]).collect();
            own.sort_unstable();
            own.dedup();
            own.len()
        };
        assert_eq!(inside(&raster), 1);
        let line = [DVec2::new(0.0, 0.3), DVec2::new(4.0, 3.1)];
        assert!(raster.is_clear(line));
        raster.block(line);
        assert_eq!(inside(&raster), 2);
        assert!(!raster.is_clear([DVec2::new(2.0, 0.0), DVec2::new(2.0, 4.0)]));
    }
}
