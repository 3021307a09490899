//! Strokes: straight links that stand for parts of chains, laid by distance and mended until the map is planar again.

use super::chains::{Chains, farthest_from, squared};
use super::near::Near;
use crate::lattice::{Point, orient};

/// Beyond so many splits one inside the other a part is split in the middle, which bounds the time for a chain.
const DEEPEST: u8 = 64;

/// Squared tolerances count in parts of 2 to this power.
const TOLERANCE_BITS: u32 = 16;

/// A straight link for a part of a chain.
#[derive(Clone, Copy)]
struct Stroke {
    chain: u32,
    /// Places in the chain where it starts and ends.
    from: u32,
    to: u32,
    /// Whether a vertex between does not lie on it: else the map is the same with it.
    moves: bool,
    /// Whether it still stands.
    stands: bool,
    /// Whether it waits for being checked.
    waits: bool,
    /// How many splits it lies inside of.
    depth: u8,
}

/// The farthest vertex of a part.
struct Farthest {
    place: u32,
    /// Its squared distance times the squared length between the part's ends.
    scaled: i128,
    length: i64,
}

pub(super) struct Strokes<'a> {
    points: &'a [Point],
    chains: &'a Chains,
    /// The tolerance, rounded up, and its square.
    reach: i64,
    limit: i128,
    strokes: Vec<Stroke>,
    /// Whether a vertex stays.
    stays: Vec<bool>,
    /// Strokes to be checked.
    open: Vec<u32>,
}

impl<'a> Strokes<'a> {
    pub fn new(points: &'a [Point], chains: &'a Chains, tolerance: f64) -> Strokes<'a> {
        // No lattice is larger; what is no number counts as 0.
        let tolerance = tolerance.max(0.0).min(f64::from(1 << 25));
        let limit = (tolerance * tolerance * f64::from(1 << TOLERANCE_BITS)) as i128;
        let stays = vec![false; points.len()];
        let reach = tolerance.ceil() as i64;
        Strokes { points, chains, reach, limit, strokes: Vec::new(), stays, open: Vec::new() }
    }

    fn at(&self, chain: u32, place: u32) -> Point {
        self.points[self.vertex(chain, place) as usize]
    }

    fn vertex(&self, chain: u32, place: u32) -> u32 {
        self.chains.get(chain as usize).vertices[place as usize]
    }

    /// Lays strokes along all chains, each by itself.
    pub fn lay_all(&mut self) {
        for k in 0..self.chains.len() as u32 {
            let chain = self.chains.get(k as usize);
            let last = chain.links.len() as u32;
            self.stays[chain.vertices[0] as usize] = true;
            self.stays[chain.vertices[last as usize] as usize] = true;
            if chain.is_closed() {
                // What is closed has no line between its ends.
                let middle = farthest_from(self.points, chain.vertices, 0) as u32;
                self.stays[chain.vertices[middle as usize] as usize] = true;
                self.lay(k, 0, middle, 0);
                self.lay(k, middle, last, 0);
            } else {
                self.lay(k, 0, last, 0);
            }
        }
    }

    /// Lays as few strokes along a part as the tolerance asks for; the places of vertices that stay between them.
    fn lay(&mut self, chain: u32, from: u32, to: u32, depth: u8) -> Vec<u32> {
        let mut places = Vec::new();
        let mut parts = vec![(from, to, depth)];
        while let Some((from, to, depth)) = parts.pop() {
            let mut moves = false;
            if to - from > 1 {
                let farthest = self.farthest(chain, from, to);
                if (farthest.scaled << TOLERANCE_BITS) > self.limit * i128::from(farthest.length) {
                    let place = if depth < DEEPEST { farthest.place } else { from + (to - from) / 2 };
                    let vertex = self.vertex(chain, place);
                    self.stays[vertex as usize] = true;
                    places.push(place);
                    let depth = depth.saturating_add(1);
                    parts.extend([(place, to, depth), (from, place, depth)]);
                    continue;
                }
                moves = farthest.scaled > 0;
            }
            if moves {
                self.open.push(self.strokes.len() as u32);
            }
            self.strokes.push(Stroke { chain, from, to, moves, stands: true, waits: moves, depth });
        }
        places
    }

    /// The vertex strictly inside a part that lies farthest from the segment between its ends, the first of several.
    fn farthest(&self, chain: u32, from: u32, to: u32) -> Farthest {
        let (a, b) = (self.at(chain, from), self.at(chain, to));
        let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
        let length = squared(a, b);
        let mut farthest = Farthest { place: from + 1, scaled: -1, length };
        for place in from + 1..to {
            let p = self.at(chain, place);
            let along = (i64::from(p.x) - i64::from(a.x)) * dx + (i64::from(p.y) - i64::from(a.y)) * dy;
            let scaled = if along <= 0 {
                i128::from(squared(a, p)) * i128::from(length)
            } else if along >= length {
                i128::from(squared(b, p)) * i128::from(length)
            } else {
                let side = i128::from(orient(a, b, p));
                side * side
            };
            if scaled > farthest.scaled {
                farthest = Farthest { place, scaled, length };
            }
        }
        farthest
    }

    /// Splits strokes until none swallows a vertex, crosses or doubles another.
    pub fn mend(&mut self) {
        if self.open.is_empty() {
            return;
        }
        let mut used: Vec<u32> = self.chains.iter().flat_map(|chain| chain.vertices).copied().collect();
        used.sort_unstable();
        used.dedup();
        let places = used.iter().map(|&v| self.points[v as usize]);
        let mut vertices = Near::over(places.clone());
        let mut links = Near::over(places);
        for v in used {
            vertices.insert(v, self.points[v as usize], self.points[v as usize]);
        }
        for (k, s) in self.strokes.iter().enumerate() {
            links.insert(k as u32, self.at(s.chain, s.from), self.at(s.chain, s.to));
        }
        // The last laid come first out: begin with the first.
        self.open.reverse();
        let mut near = Vec::new();
        while let Some(s) = self.open.pop() {
            self.strokes[s as usize].waits = false;
            if !self.strokes[s as usize].stands {
                continue;
            }
            if self.swallows(s, &vertices, &mut near) {
                self.split(s, &mut links);
                continue;
            }
            let [a, b] = self.segment(s);
            links.along(a, b, 0, &mut near);
            for &other in &near {
                if other == s || !self.strokes[other as usize].stands || !self.conflict(s, other) {
                    continue;
                }
                // Two that move nothing cannot conflict in a planar map.
                if self.strokes[s as usize].moves {
                    self.split(s, &mut links);
                    break;
                } else if self.strokes[other as usize].moves {
                    self.split(other, &mut links);
                }
            }
        }
    }

    fn segment(&self, s: u32) -> [Point; 2] {
        let Stroke { chain, from, to, .. } = self.strokes[s as usize];
        [self.at(chain, from), self.at(chain, to)]
    }

    fn ends_of(&self, s: u32) -> [u32; 2] {
        let Stroke { chain, from, to, .. } = self.strokes[s as usize];
        [self.vertex(chain, from), self.vertex(chain, to)]
    }

    /// Whether a vertex that stays, other than its ends, lies in the hull of what a stroke stands for.
    fn swallows(&self, s: u32, vertices: &Near, near: &mut Vec<u32>) -> bool {
        let stroke = self.strokes[s as usize];
        if !stroke.moves {
            return false;
        }
        let [a, b] = self.segment(s);
        vertices.along(a, b, self.reach, near);
        let ends = self.ends_of(s);
        near.retain(|&v| self.stays[v as usize] && !ends.contains(&v));
        if near.is_empty() {
            return false;
        }
        let hull = hull((stroke.from..=stroke.to).map(|place| self.at(stroke.chain, place)).collect());
        near.iter().any(|&v| {
            let p = self.points[v as usize];
            (0..hull.len()).all(|k| orient(hull[k], hull[(k + 1) % hull.len()], p) >= 0)
        })
    }

    /// Whether two strokes cross each other inside both, or run between the same vertices. Where one ends inside the
    /// other, that one swallows a vertex.
    fn conflict(&self, s: u32, t: u32) -> bool {
        let (ends, others) = (self.ends_of(s), self.ends_of(t));
        if ends == others || ends == [others[1], others[0]] {
            return true;
        }
        let ([a, b], [c, d]) = (self.segment(s), self.segment(t));
        orient(a, b, c).signum() * orient(a, b, d).signum() < 0
            && orient(c, d, a).signum() * orient(c, d, b).signum() < 0
    }

    /// Splits a stroke that moves something, and lets those be checked again that the new vertices concern.
    fn split(&mut self, s: u32, links: &mut Near) {
        let stroke = self.strokes[s as usize];
        let Stroke { chain, from, to, depth, .. } = stroke;
        self.strokes[s as usize].stands = false;
        let farthest = self.farthest(chain, from, to);
        let place = if depth < DEEPEST { farthest.place } else { from + (to - from) / 2 };
        let first = self.strokes.len();
        let vertex = self.vertex(chain, place);
        self.stays[vertex as usize] = true;
        let depth = depth.saturating_add(1);
        let mut places = vec![place];
        places.extend(self.lay(chain, from, place, depth));
        places.extend(self.lay(chain, place, to, depth));
        for k in first..self.strokes.len() {
            let [a, b] = self.segment(k as u32);
            links.insert(k as u32, a, b);
            // Those that move nothing may cross some that do.
            if !std::mem::replace(&mut self.strokes[k].waits, true) {
                self.open.push(k as u32);
            }
        }
        let mut near = Vec::new();
        for place in places {
            let p = self.at(chain, place);
            links.along(p, p, self.reach, &mut near);
            for &other in &near {
                let stroke = &mut self.strokes[other as usize];
                if stroke.stands && stroke.moves && !std::mem::replace(&mut stroke.waits, true) {
                    self.open.push(other);
                }
            }
        }
    }

    /// The largest distance of a vertex from the stroke that it was moved to.
    pub fn largest_displacement(&self) -> f64 {
        let moving = self.strokes.iter().filter(|s| s.stands && s.moves);
        moving
            .map(|s| {
                let farthest = self.farthest(s.chain, s.from, s.to);
                (farthest.scaled as f64 / farthest.length as f64).sqrt()
            })
            .fold(0.0, f64::max)
    }

    /// For each chain the places where strokes start and end, ascending.
    pub fn ends(&self) -> Vec<Vec<u32>> {
        let mut ends = vec![vec![0]; self.chains.len()];
        for s in self.strokes.iter().filter(|s| s.stands) {
            ends[s.chain as usize].push(s.to);
        }
        ends.iter_mut().for_each(|ends| ends.sort_unstable());
        ends
    }
}

/// The convex hull, counter-clockwise; of points on a line its two ends.
fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_unstable();
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull: Vec<Point> = Vec::new();
    let turn = |hull: &mut Vec<Point>, base: usize, p: Point| {
        while hull.len() > base + 1 && orient(hull[hull.len() - 2], hull[hull.len() - 1], p) <= 0 {
            hull.pop();
        }
        hull.push(p);
    };
    for &p in &points {
        turn(&mut hull, 0, p);
    }
    let base = hull.len() - 1;
    for &p in points.iter().rev().skip(1) {
        turn(&mut hull, base, p);
    }
    hull.pop();
    hull
}
