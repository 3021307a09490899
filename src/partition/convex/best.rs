//! The best cut of a polygon of moderate length.
//!
//! Dynamic programming over sub-polygons, as Keil (1985) and Keil and Snoeyink ("On the time bound for convex
//! decomposition of simple polygons", 2002) do, but with the total length of cuts as second goal, for which their
//! bookkeeping by narrowest pairs does not serve: here the convex part behind each diagonal is grown link by link.
//! Time grows with the square of the number of diagonals that may be needed.
//! Only diagonals with a reflex end can be needed: any other could be taken away again.

use crate::lattice::{Point, is_between, orient};

/// What a cut costs: the number of diagonals, then their total length in lattice units.
pub(super) type Cost = u64;

/// One diagonal. The lengths of all those of the longest polygon, at most 2^26 each, stay below.
const DIAGONAL: Cost = 1 << 40;
const NEVER: Cost = Cost::MAX;
const UNLINKED: u32 = u32::MAX;

/// The cost of one diagonal.
pub(super) fn cost(a: Point, b: Point) -> Cost {
    let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    DIAGONAL + ((dx * dx + dy * dy) as u64).isqrt()
}

/// Whether no cut of a polygon with as many reflex corners has fewer diagonals: one serves two corners at most.
pub(super) fn is_least(cost: Cost, reflex: usize) -> bool {
    (cost / DIAGONAL) as usize <= reflex.div_ceil(2)
}

/// Whether `b`'s corner of a chain is reflex.
pub(super) fn is_reflex(a: Point, b: Point, c: Point) -> bool {
    orient(a, b, c) < 0
}

/// Finds best cuts; its tables are used again from polygon to polygon.
///
/// Corners are known by their places in the polygon. A *link* is an edge or a diagonal from an earlier to a later
/// corner. About each corner, counter-clockwise, links lead to later corners in ascending order, then from earlier
/// corners in ascending order: so the links that may come before a link on a convex chain are the first few.
#[derive(Default)]
pub(super) struct Cutter {
    corners: Vec<Point>,
    /// Links by their later corner, then by their earlier one, which is what is noted.
    from: Vec<u16>,
    /// For each corner its first link in `from`, and the end.
    into: Vec<u32>,
    /// Links by their earlier corner, then by their later one.
    onward: Vec<Onward>,
    /// For each corner its first link in `onward`, and the end.
    out: Vec<u32>,
    /// Diagonals, the shortest sub-polygons first.
    diagonals: Vec<([u16; 2], u32)>,
    /// For a link the cost of what lies behind it, itself included.
    behind: Vec<Cost>,
    /// For a link the least cost of a convex chain that starts at the current part's first corner and ends with it, and
    /// the link before it on that chain.
    chain: Vec<(Cost, u32)>,
    /// Whether a corner lies on the part's side of the line that closes the current part.
    fits: Vec<bool>,
    reflex: Vec<bool>,
}

/// A link seen from its earlier corner.
#[derive(Clone, Copy)]
struct Onward {
    to: u16,
    link: u32,
    /// The links into the earlier corner from which the turn is convex end here.
    convex: u32,
}

impl Cutter {
    /// The longest polygon that is cut.
    pub const LONGEST: usize = 255;

    /// Finds the best cut of a polygon, given by its corners counter-clockwise; it may touch itself at corners, where
    /// each occurrence stands for one wedge, and run along both sides of an edge. `None` if there is no cut, which
    /// means that it is no polygon.
    pub fn cut(&mut self, corners: impl Iterator<Item = Point>) -> Option<Cost> {
        self.corners.clear();
        self.corners.extend(corners);
        let n = self.corners.len();
        if !(3..=Cutter::LONGEST).contains(&n) {
            return None;
        }
        self.link();
        for k in 0..self.diagonals.len() {
            let ([i, j], link) = self.diagonals[k];
            let (inner, _) = self.part(usize::from(i), usize::from(j));
            if inner != NEVER {
                let length = cost(self.corners[usize::from(i)], self.corners[usize::from(j)]);
                self.behind[link as usize] = inner + length;
            }
        }
        let (all, _) = self.part(0, n - 1);
        (all != NEVER).then_some(all)
    }

    /// The parts of the cut just found: corners by their places in the polygon, ascending, so that each part's last
    /// edge, from its last corner to its first, is the one that it shares with an earlier part; for the first part it
    /// is the polygon's own last edge.
    pub fn parts(&mut self) -> Vec<Vec<u16>> {
        let mut open = vec![(0, self.corners.len() - 1)];
        let mut parts = Vec::new();
        while let Some((i, j)) = open.pop() {
            // The tables of a part are overwritten by the next one's: fill them again.
            let (_, mut link) = self.part(i, j);
            let mut part = vec![j as u16];
            let mut to = j;
            while link != UNLINKED {
                let from = self.from[link as usize];
                part.push(from);
                if usize::from(from) + 1 < to {
                    open.push((usize::from(from), to));
                }
                to = usize::from(from);
                link = self.chain[link as usize].1;
            }
            part.reverse();
            parts.push(part);
        }
        parts
    }

    /// Finds the links.
    fn link(&mut self) {
        let corners = &self.corners;
        let n = corners.len();
        self.reflex.clear();
        let reflex = |k: usize| is_reflex(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
        self.reflex.extend((0..n).map(reflex));
        self.from.clear();
        self.into.clear();
        self.diagonals.clear();
        self.behind.clear();
        for j in 0..n {
            self.into.push(self.from.len() as u32);
            for i in 0..j {
                // The edge from n - 1 to 0 closes the polygon and is no link.
                let edge = i + 1 == j;
                let needed = || (i, j) != (0, n - 1) && (self.reflex[i] || self.reflex[j]);
                if edge || (needed() && sees(corners, i, j)) {
                    if !edge {
                        self.diagonals.push(([i as u16, j as u16], self.from.len() as u32));
                    }
                    self.from.push(i as u16);
                    self.behind.push(if edge { 0 } else { NEVER });
                }
            }
        }
        self.into.push(self.from.len() as u32);
        self.diagonals.sort_unstable_by_key(|&([i, j], _)| (j - i, i));
        self.chain.clear();
        self.chain.resize(self.from.len(), (NEVER, UNLINKED));

        // The same by earlier corners.
        self.out.clear();
        self.out.resize(n + 1, 0);
        for &from in &self.from {
            self.out[usize::from(from) + 1] += 1;
        }
        for k in 0..n {
            self.out[k + 1] += self.out[k];
        }
        let mut place = self.out.clone();
        self.onward.clear();
        self.onward.resize(self.from.len(), Onward { to: 0, link: 0, convex: 0 });
        for to in 0..n {
            for link in self.into[to]..self.into[to + 1] {
                let a = usize::from(self.from[link as usize]);
                let before = &self.from[self.into[a] as usize..self.into[a + 1] as usize];
                let turns_left = |c: &u16| orient(corners[usize::from(*c)], corners[a], corners[to]) >= 0;
                let convex = self.into[a] + before.partition_point(turns_left) as u32;
                self.onward[place[a] as usize] = Onward { to: to as u16, link, convex };
                place[a] += 1;
            }
        }
    }

    /// The least cost of the sub-polygon from corner `i` to `j`, whose first part has the edge from `j` to `i`, and the
    /// last link of that part.
    fn part(&mut self, i: usize, j: usize) -> (Cost, u32) {
        let corners = &self.corners;
        let (pi, pj) = (corners[i], corners[j]);
        self.fits.clear();
        self.fits.resize(i + 1, false);
        self.fits.extend(corners[i + 1..j].iter().map(|&b| orient(pj, pi, b) >= 0));
        self.fits.push(true);
        let onward = |a: usize| &self.onward[self.out[a] as usize..self.out[a + 1] as usize];
        for on in onward(i) {
            let to = usize::from(on.to);
            if to > j {
                break;
            }
            // From i straight to j is no part.
            let begins = to != j && self.fits[to];
            self.chain[on.link as usize] =
                (if begins { self.behind[on.link as usize] } else { NEVER }, UNLINKED);
        }
        for a in i + 1..j {
            let mut before = self.into[a];
            let mut least = (NEVER, UNLINKED);
            for on in onward(a) {
                let to = usize::from(on.to);
                if to > j {
                    break;
                }
                while before < on.convex {
                    let (cost, _) = self.chain[before as usize];
                    if usize::from(self.from[before as usize]) >= i && cost < least.0 {
                        least = (cost, before);
                    }
                    before += 1;
                }
                let behind = self.behind[on.link as usize];
                let goes = self.fits[to] && least.0 != NEVER && behind != NEVER;
                self.chain[on.link as usize] =
                    if goes { (least.0 + behind, least.1) } else { (NEVER, UNLINKED) };
            }
        }
        let mut least = (NEVER, UNLINKED);
        for link in self.into[j]..self.into[j + 1] {
            let from = usize::from(self.from[link as usize]);
            let (cost, _) = self.chain[link as usize];
            if from > i && cost < least.0 && orient(corners[from], pj, pi) >= 0 {
                least = (cost, link);
            }
        }
        least
    }
}

/// Whether the open segment between two corners lies inside the polygon.
fn sees(corners: &[Point], i: usize, j: usize) -> bool {
    let n = corners.len();
    let (a, b) = (corners[i], corners[j]);
    let in_wedge = |k: usize, to: Point| {
        let (before, at, after) = (corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
        if orient(before, at, after) > 0 {
            orient(at, after, to) > 0 && orient(at, to, before) > 0
        } else {
            orient(at, before, to) < 0 || orient(at, to, after) < 0
        }
    };
    if a == b || !in_wedge(i, b) || !in_wedge(j, a) {
        return false;
    }
    let mut earlier = orient(a, b, corners[n - 1]).signum();
    for k in 0..n {
        let p = corners[k];
        let side = orient(a, b, p).signum();
        if side == 0 && is_between(a, b, p) {
            return false;
        }
        if side * earlier < 0 {
            let q = corners[(k + n - 1) % n];
            if orient(p, q, a).signum() * orient(p, q, b).signum() < 0 {
                return false;
            }
        }
        earlier = side;
    }
    true
}
