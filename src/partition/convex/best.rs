//! The best cut of a polygon of moderate length.
//!
//! Dynamic programming over sub-polygons, as Keil (1985) and Keil and Snoeyink ("On the time bound for convex
//! decomposition of simple polygons", 2002) do, but with the total length of cuts as second goal, for which their
//! bookkeeping by narrowest pairs does not serve: here the convex part behind each diagonal is grown link by link.
//! Only diagonals with a reflex end can be needed: any other could be taken away again.

use crate::lattice::{Point, is_between, orient};

/// What a cut costs: the number of diagonals, then their total length in lattice units.
pub(super) type Cost = u64;

/// One diagonal; lengths of as many as fit the longest polygon stay below.
const DIAGONAL: Cost = 1 << 40;
const NEVER: Cost = Cost::MAX;
const UNLINKED: u16 = u16::MAX;

/// The cost of one diagonal.
pub(super) fn cost(a: Point, b: Point) -> Cost {
    let (dx, dy) = (i64::from(b.x) - i64::from(a.x), i64::from(b.y) - i64::from(a.y));
    DIAGONAL + ((dx * dx + dy * dy) as u64).isqrt()
}

/// The least number of diagonals that a polygon with as many reflex corners needs, as a cost.
pub(super) fn least(reflex: usize) -> Cost {
    (reflex.div_ceil(2) as u64) << 40
}

/// Whether `b`'s corner of a chain is reflex.
pub(super) fn is_reflex(a: Point, b: Point, c: Point) -> bool {
    orient(a, b, c) < 0
}

/// Finds best cuts; its tables are used again from polygon to polygon.
#[derive(Default)]
pub(super) struct Cutter {
    corners: Vec<Point>,
    /// Diagonals and edges by their later end: the earlier ends, ascending.
    into: Vec<Vec<u16>>,
    diagonals: Vec<[u16; 2]>,
    /// For a link the cost of what lies behind it, itself included.
    behind: Vec<Cost>,
    /// For a link the least cost of a convex chain from the current part's start that ends with it, and the corner
    /// before it on that chain.
    chain: Vec<Cost>,
    before: Vec<u16>,
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
        self.behind.clear();
        self.behind.resize(n * n, NEVER);
        self.chain.resize(n * n, NEVER);
        self.before.resize(n * n, UNLINKED);
        self.link();
        for k in 0..self.diagonals.len() {
            let [i, j] = self.diagonals[k].map(usize::from);
            let inner = self.part(i, j);
            if inner != NEVER {
                self.behind[i * n + j] = inner + cost(self.corners[i], self.corners[j]);
            }
        }
        let all = self.part(0, n - 1);
        (all != NEVER).then_some(all)
    }

    /// The parts of the cut just found: corners by their places in the polygon, ascending, so that each part's last
    /// edge, from its last corner to its first, is the one that it shares with an earlier part; for the first part it
    /// is the polygon's own last edge.
    pub fn parts(&mut self) -> Vec<Vec<u16>> {
        let n = self.corners.len();
        let mut open = vec![(0, n - 1)];
        let mut parts = Vec::new();
        while let Some((i, j)) = open.pop() {
            // The tables of a sub-polygon are overwritten by the next one: fill them again.
            self.part(i, j);
            let mut part = vec![j as u16];
            let mut a = self.last(i, j);
            let mut b = j;
            while a != UNLINKED {
                part.push(a);
                let from = usize::from(a);
                if from + 1 < b {
                    open.push((from, b));
                }
                a = if from == i { UNLINKED } else { self.before[from * n + b] };
                b = from;
            }
            part.reverse();
            parts.push(part);
        }
        parts
    }

    /// Finds the diagonals that may be needed, shortest chains first.
    fn link(&mut self) {
        let corners = &self.corners;
        let n = corners.len();
        self.into.resize_with(n.max(self.into.len()), Vec::new);
        for into in &mut self.into {
            into.clear();
        }
        let reflex: Vec<bool> =
            (0..n).map(|k| is_reflex(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n])).collect();
        self.diagonals.clear();
        for i in 0..n {
            // The edge from n - 1 to 0 closes the polygon and is no link.
            if i + 1 < n {
                self.into[i + 1].push(i as u16);
                self.behind[i * n + i + 1] = 0;
            }
            for j in i + 2..n {
                if (reflex[i] || reflex[j]) && (i, j) != (0, n - 1) && sees(corners, i, j) {
                    self.into[j].push(i as u16);
                    self.diagonals.push([i as u16, j as u16]);
                }
            }
        }
        for into in &mut self.into {
            into.sort_unstable();
        }
        self.diagonals.sort_unstable_by_key(|&[i, j]| (j - i, i));
    }

    /// The least cost of the sub-polygon from corner `i` to `j`, whose first part lies along the line from `j` to `i`.
    fn part(&mut self, i: usize, j: usize) -> Cost {
        let n = self.corners.len();
        let corners = &self.corners;
        let (pi, pj) = (corners[i], corners[j]);
        for b in i + 1..=j {
            let pb = corners[b];
            let fits = b == j || orient(pj, pi, pb) >= 0;
            for &a in &self.into[b] {
                let a = usize::from(a);
                if a < i {
                    continue;
                }
                let mut least = (NEVER, UNLINKED);
                let behind = self.behind[a * n + b];
                if fits && behind != NEVER {
                    if a == i {
                        // From i straight to j is no part.
                        if b != j {
                            least = (behind, UNLINKED);
                        }
                    } else {
                        let pa = corners[a];
                        for &c in &self.into[a] {
                            let at = usize::from(c) * n + a;
                            if usize::from(c) >= i
                                && self.chain[at] < least.0
                                && orient(corners[usize::from(c)], pa, pb) >= 0
                            {
                                least = (self.chain[at], c);
                            }
                        }
                        if least.0 != NEVER {
                            least.0 += behind;
                        }
                    }
                }
                self.chain[a * n + b] = least.0;
                self.before[a * n + b] = least.1;
            }
        }
        match self.last(i, j) {
            UNLINKED => NEVER,
            a => self.chain[usize::from(a) * n + j],
        }
    }

    /// The corner before `j` on the best chain from `i` to `j` that closes convexly, by the tables that
    /// [`Cutter::part`] left.
    fn last(&self, i: usize, j: usize) -> u16 {
        let n = self.corners.len();
        let mut least = (NEVER, UNLINKED);
        for &a in &self.into[j] {
            let cost = self.chain[usize::from(a) * n + j];
            if usize::from(a) > i
                && cost < least.0
                && orient(self.corners[usize::from(a)], self.corners[j], self.corners[i]) >= 0
            {
                least = (cost, a);
            }
        }
        least.1
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
