//! The base line: convex parts by diagonals, one after the other about the boundary.
//!
//! After Fernandez, Toth, Canovas and Pelegrin, "A practical algorithm for decomposing polygonal domains into convex polygons by diagonals"
//! (TOP 16, 2008), which Maria, Horna and Aveneau use: from a corner a convex chain is grown onward, then backward, and shortened until no reflex
//! corner is left inside of it; its closing diagonal cuts it off; at last diagonals whose ends stay convex without them go, in the order in
//! which they were drawn. Holes are bridged beforehand, from right to left, by the shortest diagonal from each to what is bridged already.
//!
//! A reflex corner keeps at most two diagonals, so that there are at most twice as many parts as reflex corners, and one. (One diagonal
//! for each is not always enough: a pentagon with one deep reflex corner between two far ones needs three parts.)

use super::region::Region;
use super::{RegionError, is_convex};
use crate::lattice::{Point, is_between, orient};

/// Cuts a region. Parts are chains of its vertices.
pub(super) fn cut(region: &Region) -> Result<Vec<Vec<u32>>, RegionError> {
    let nowhere = || RegionError::Crossing(region.points.first().copied().unwrap_or_default());
    // What hangs together: an outer chain with the holes in it.
    let area = |chain: &[u32]| -> i128 {
        let points: Vec<Point> = chain.iter().map(|&v| region.points[v as usize]).collect();
        i128::from(crate::lattice::double_area(&points))
    };
    let (outer, holes): (Vec<&Vec<u32>>, Vec<&Vec<u32>>) =
        region.chains.iter().partition(|chain| area(chain) > 0);
    let [outer] = outer[..] else { return Err(nowhere()) };
    let mut bridged = Bridged { region, chain: outer.clone(), diagonals: Vec::new() };
    bridged.all(holes).ok_or_else(nowhere)?;
    let Bridged { chain, diagonals, .. } = bridged;
    let mut cutting = Cutting { region, chain, parts: Vec::new(), diagonals };
    cutting.run().ok_or_else(nowhere)?;
    let parts = cutting.merged();
    let all: i128 = region.chains.iter().map(|chain| area(chain)).sum();
    let is_cut = parts.iter().map(|part| area(part)).sum::<i128>() == all
        && parts
            .iter()
            .all(|part| is_convex(&part.iter().map(|&v| region.points[v as usize]).collect::<Vec<_>>()));
    if is_cut { Ok(parts) } else { Err(nowhere()) }
}

/// Regions in which a hole and the rest have more pairs of corners are not cut in this way.
const MOST_PAIRS: usize = 1 << 22;

/// A boundary of one chain, in which bridges occur twice.
struct Bridged<'a> {
    region: &'a Region,
    chain: Vec<u32>,
    diagonals: Vec<[u32; 2]>,
}

impl Bridged<'_> {
    /// Bridges all holes, each by the shortest diagonal to what is bridged already; `None` if one cannot be seen, or there are too many corners.
    fn all(&mut self, mut holes: Vec<&Vec<u32>>) -> Option<()> {
        // The one that reaches farthest to the right first: nothing but what is bridged already is between it and that.
        let right = |hole: &[u32]| hole.iter().map(|&v| self.region.points[v as usize]).max();
        holes.sort_by_key(|hole| std::cmp::Reverse(right(hole)));
        for at in 0..holes.len() {
            let (hole, rest) = (holes[at], &holes[at..]);
            if hole.len() * self.chain.len() > MOST_PAIRS {
                return None;
            }
            let mut pairs: Vec<(i64, u32, u32)> = Vec::with_capacity(hole.len() * self.chain.len());
            for (i, &v) in (0..).zip(hole) {
                for (k, &w) in (0..).zip(&self.chain) {
                    let [p, q] = [v, w].map(|v| self.region.points[v as usize]);
                    let (dx, dy) = (i64::from(p.x) - i64::from(q.x), i64::from(p.y) - i64::from(q.y));
                    pairs.push((dx * dx + dy * dy, i, k));
                }
            }
            pairs.sort_unstable();
            let free = |&(_, i, k): &(i64, u32, u32)| self.is_free(rest, hole, i as usize, k as usize);
            let (_, i, k) = pairs.into_iter().find(free)?;
            let (i, k) = (i as usize, k as usize);
            let around = (0..=hole.len()).map(|j| hole[(i + j) % hole.len()]);
            let bridge: Vec<u32> = around.chain([self.chain[k]]).collect();
            self.diagonals.push([self.chain[k], hole[i]]);
            self.chain.splice(k + 1..k + 1, bridge);
        }
        Some(())
    }

    /// Whether the diagonal from place `i` of a hole to place `k` of the chain lies inside the region and crosses no bridge.
    fn is_free(&self, holes: &[&Vec<u32>], hole: &[u32], i: usize, k: usize) -> bool {
        let at = |v: u32| self.region.points[v as usize];
        let (a, b) = (at(hole[i]), at(self.chain[k]));
        let wedge = |chain: &[u32], k: usize, to: Point| {
            let n = chain.len();
            in_wedge(at(chain[(k + n - 1) % n]), at(chain[k]), at(chain[(k + 1) % n]), to)
        };
        let chains = holes.iter().map(|hole| &hole[..]).chain([&self.chain[..]]);
        a != b
            && wedge(hole, i, b)
            && wedge(&self.chain, k, a)
            && chains.into_iter().all(|chain| {
                (0..chain.len()).all(|j| !blocks([a, b], [at(chain[j]), at(chain[(j + 1) % chain.len()])]))
            })
    }
}

/// Whether from `at`, between `before` and `after` of a chain with the region on its left, `to` lies in the region's open wedge.
fn in_wedge(before: Point, at: Point, after: Point, to: Point) -> bool {
    if orient(before, at, after) > 0 {
        orient(at, after, to) > 0 && orient(at, to, before) > 0
    } else {
        orient(at, before, to) < 0 || orient(at, to, after) < 0
    }
}

/// Whether an edge crosses the open segment from `a` to `b`, or has an end on it.
fn blocks([a, b]: [Point; 2], [p, q]: [Point; 2]) -> bool {
    let side = |r: Point| orient(a, b, r).signum();
    let on = |r: Point| r != a && r != b && side(r) == 0 && is_between(a, b, r);
    on(p) || on(q) || (side(p) * side(q) < 0 && orient(p, q, a).signum() * orient(p, q, b).signum() < 0)
}

struct Cutting<'a> {
    region: &'a Region,
    /// What is not cut off yet.
    chain: Vec<u32>,
    parts: Vec<Vec<u32>>,
    /// In the order in which they were drawn.
    diagonals: Vec<[u32; 2]>,
}

impl Cutting<'_> {
    fn at(&self, v: u32) -> Point {
        self.region.points[v as usize]
    }

    /// Cuts parts off until nothing is left; `None` if no corner is a start.
    fn run(&mut self) -> Option<()> {
        let (mut start, mut failed) = (0, 0);
        while self.chain.len() > 3 {
            let n = self.chain.len();
            if failed > n {
                return None;
            }
            match self.part(start % n) {
                Some((first, count)) => {
                    let part: Vec<u32> = (0..count).map(|k| self.chain[(first + k) % n]).collect();
                    if count == n {
                        self.parts.push(part);
                        self.chain.clear();
                        return Some(());
                    }
                    let rest: Vec<u32> =
                        (0..=n - count + 1).map(|k| self.chain[(first + count - 1 + k) % n]).collect();
                    self.diagonals.push([part[count - 1], part[0]]);
                    self.parts.push(part);
                    self.chain = rest;
                    (start, failed) = (0, 0);
                }
                None => (start, failed) = (start + 1, failed + 1),
            }
        }
        let last = std::mem::take(&mut self.chain);
        self.parts.push(last);
        Some(())
    }

    /// The convex part grown from a place, onward and then backward: its first place and how many corners it has.
    fn part(&self, start: usize) -> Option<(usize, usize)> {
        let n = self.chain.len();
        let at = |k: usize| self.at(self.chain[k % n]);
        let turns = |a: usize, b: usize, c: usize| orient(at(a), at(b), at(c)) >= 0;
        let (mut first, mut count) = (start, 2);
        // Onward: at its end, at its new corner, at its start.
        while count < n && {
            let (last, next) = (first + count - 1, first + count);
            turns(last - 1, last, next) && turns(last, next, first) && turns(next, first, first + 1)
        } {
            count += 1;
        }
        count = self.shortened(first, count, true)?;
        // Backward.
        let mut before = count;
        while before < n && {
            let (new, last) = (first + n - 1, first + before - 1);
            turns(new, first + n, first + n + 1)
                && turns(last, new, first + n)
                && turns(last + n - 1, last + n, new)
        } {
            first = (first + n - 1) % n;
            before += 1;
        }
        if before > count {
            let grown = self.shortened(first, before, false)?;
            first = (first + before - grown) % n;
            count = grown;
        }
        (count >= 3 && self.is_part(first, count)).then_some((first, count))
    }

    /// As many of the part's corners as leave no other corner inside, counted from its first or its last.
    fn shortened(&self, first: usize, mut count: usize, from_first: bool) -> Option<usize> {
        let n = self.chain.len();
        if count == n {
            return Some(count);
        }
        let mut first = first;
        while count > 2 {
            let part: Vec<Point> = (0..count).map(|k| self.at(self.chain[(first + k) % n])).collect();
            let rest = (count..n).map(|k| self.at(self.chain[(first + k) % n]));
            let inside = |p: Point| {
                !part.contains(&p) && (0..count).all(|i| orient(part[i], part[(i + 1) % count], p) >= 0)
            };
            if !rest.into_iter().any(inside) {
                break;
            }
            count -= 1;
            if !from_first {
                first = (first + 1) % n;
            }
        }
        Some(count)
    }

    /// Whether the diagonal that closes a part lies inside of what is left.
    fn is_part(&self, first: usize, count: usize) -> bool {
        let n = self.chain.len();
        let at = |k: usize| self.at(self.chain[k % n]);
        let part: Vec<Point> = (0..count).map(|k| at(first + k)).collect();
        if !is_convex(&part) {
            return false;
        }
        if count == n {
            return true;
        }
        let (a, b) = (first + count - 1, first);
        at(a) != at(b)
            && in_wedge(at(a + n - 1), at(a), at(a + 1), at(b))
            && in_wedge(at(b + n - 1), at(b), at(b + 1), at(a))
            && (0..n).all(|k| !blocks([at(a), at(b)], [at(k), at(k + 1)]))
    }

    /// The parts, those of them together that are convex without the diagonal between them.
    fn merged(self) -> Vec<Vec<u32>> {
        let mut parts = self.parts;
        for [a, b] in self.diagonals {
            let place = |part: &[u32], from: u32, to: u32| {
                (0..part.len()).find(|&i| part[i] == from && part[(i + 1) % part.len()] == to)
            };
            let one = parts.iter().enumerate().find_map(|(k, part)| Some((k, place(part, a, b)?)));
            let other = parts.iter().enumerate().find_map(|(k, part)| Some((k, place(part, b, a)?)));
            let (Some((one, i)), Some((other, j))) = (one, other) else { continue };
            if one == other {
                continue;
            }
            let (p, q) = (&parts[one], &parts[other]);
            // From b around the one to a, and on around the other.
            let joined: Vec<u32> = (1..p.len())
                .map(|k| p[(i + k) % p.len()])
                .chain((1..q.len()).map(|k| q[(j + k) % q.len()]))
                .collect();
            let corners: Vec<Point> = joined.iter().map(|&v| self.region.points[v as usize]).collect();
            if is_convex(&corners) {
                parts[one] = joined;
                parts.swap_remove(other);
            }
        }
        parts
    }
}
