//! Whether a polygon in the plane crosses itself.

/// Corners nearer to a side than this share of the polygon's extent are on it: touching is no crossing.
const TOUCH: f64 = 1e-12;

/// Pairs of boxes that may be looked at: these, and so many for each side. All pairs of 2,000 sides are within.
const FREE_PAIRS: usize = 1_000_000;
const PAIRS_PER_SIDE: usize = 1024;

/// The answer of [`crosses_itself`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// No two sides cross. They may touch, as where a polygon is cut open to a hole in it.
    No,
    /// Two sides cross.
    Yes,
    /// It would take too long to find out.
    Unknown,
}

/// Whether two sides of the ring cross in their inside. Ear cutting takes cubic time on rings that do, and has no
/// right answer for them.
///
/// Looks for pairs of sides whose boxes overlap, down a tree of boxes around runs of 2, 4, 8... successive sides.
pub(super) fn crosses_itself(ring: &[[f64; 2]]) -> Crossing {
    let count = ring.len();
    let side = |index: usize| [ring[index], ring[(index + 1) % count]];
    let mut levels = vec![(0..count).map(|i| Box2::around(side(i))).collect::<Vec<_>>()];
    while let Some(boxes) = levels.last().filter(|boxes| boxes.len() > 1) {
        let joined = boxes.chunks(2).map(|pair| pair.iter().copied().reduce(Box2::join).unwrap_or(pair[0]));
        levels.push(joined.collect());
    }
    let Some(&whole) = levels.last().and_then(|top| top.first()) else { return Crossing::No };
    let extent = (whole.hi[0] - whole.lo[0]).max(whole.hi[1] - whole.lo[1]);
    let touch = TOUCH * extent * extent;

    let mut pairs_left = FREE_PAIRS.saturating_add(count.saturating_mul(PAIRS_PER_SIDE));
    let mut stack = vec![(levels.len() - 1, 0, 0)];
    while let Some((level, a, b)) = stack.pop() {
        if pairs_left == 0 {
            return Crossing::Unknown;
        }
        pairs_left -= 1;
        if a != b && !levels[level][a].overlaps(&levels[level][b]) {
            continue;
        }
        if level == 0 {
            if a != b && cross(side(a), side(b), touch) {
                return Crossing::Yes;
            }
            continue;
        }
        let below = levels[level - 1].len();
        let halves = |node: usize| (2 * node..2 * node + 2).filter(move |&half| half < below);
        for a in halves(a) {
            // Of a node with itself each pair of halves once.
            stack.extend(halves(b).filter(|&b| a <= b).map(|b| (level - 1, a, b)));
        }
    }
    Crossing::No
}

#[derive(Clone, Copy)]
struct Box2 {
    lo: [f64; 2],
    hi: [f64; 2],
}

impl Box2 {
    fn around([a, b]: [[f64; 2]; 2]) -> Box2 {
        Box2 { lo: [a[0].min(b[0]), a[1].min(b[1])], hi: [a[0].max(b[0]), a[1].max(b[1])] }
    }

    fn join(self, other: Box2) -> Box2 {
        let lo = [self.lo[0].min(other.lo[0]), self.lo[1].min(other.lo[1])];
        let hi = [self.hi[0].max(other.hi[0]), self.hi[1].max(other.hi[1])];
        Box2 { lo, hi }
    }

    fn overlaps(&self, other: &Box2) -> bool {
        (0..2).all(|axis| self.lo[axis] <= other.hi[axis] && other.lo[axis] <= self.hi[axis])
    }
}

/// Whether two segments cross in their inside, and by more than `touch`.
fn cross([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2], touch: f64) -> bool {
    let turn = |a: [f64; 2], b: [f64; 2], p: [f64; 2]| {
        let turn = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        if turn.abs() <= touch { 0.0 } else { turn.signum() }
    };
    turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A square with a square hole, cut open along one line, there and back.
    pub(in crate::obj) const KEYHOLE: [[f64; 2]; 10] = [
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ];

    fn circle(count: usize, step: usize) -> Vec<[f64; 2]> {
        let angle = |i: usize| (i * step % count) as f64 / count as f64 * std::f64::consts::TAU;
        (0..count).map(|i| [angle(i).cos(), angle(i).sin()]).collect()
    }

    #[test]
    fn stars_cross_and_circles_do_not() {
        assert_eq!(crosses_itself(&circle(5, 2)), Crossing::Yes);
        assert_eq!(crosses_itself(&circle(5, 1)), Crossing::No);
        assert_eq!(crosses_itself(&circle(20_000, 1)), Crossing::No);
        assert_eq!(crosses_itself(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Crossing::Yes);
    }

    #[test]
    fn touching_is_no_crossing() {
        assert_eq!(crosses_itself(&KEYHOLE), Crossing::No);
        // A corner on another side.
        let pinched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        assert_eq!(crosses_itself(&pinched), Crossing::No);
    }

    #[test]
    fn work_is_bounded() {
        // Long parallel sides at 45 degrees: each overlaps all others in both axes.
        let count = 40_002;
        let ring: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let (end, shift) = (if i % 4 < 2 { 0.0 } else { 1e6 }, i as f64);
                [end + shift, end - shift]
            })
            .collect();
        assert_eq!(crosses_itself(&ring), Crossing::Unknown);
    }
}
