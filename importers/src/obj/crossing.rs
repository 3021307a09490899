//! Whether a polygon in the plane crosses itself.

/// Corners nearer to a side than this share of the polygon's extent are on it: touching is no crossing.
const TOUCH: f64 = 1e-12;

/// Pairs of sides that may be looked at: these, and so many for each side. All pairs of 2,800 sides are within.
const FREE_PAIRS: usize = 4_000_000;
const PAIRS_PER_SIDE: usize = 256;

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
pub(super) fn crosses_itself(ring: &[[f64; 2]]) -> Crossing {
    let count = ring.len();
    let side = |index: usize| [ring[index], ring[(index + 1) % count]];
    // Sweep along the axis in which the sides are shorter.
    let along = |axis: usize| (0..count).map(|i| (side(i)[1][axis] - side(i)[0][axis]).abs()).sum::<f64>();
    let axis = usize::from(along(1) < along(0));
    let low = |index: usize, axis: usize| side(index)[0][axis].min(side(index)[1][axis]);
    let high = |index: usize, axis: usize| side(index)[0][axis].max(side(index)[1][axis]);
    let extent = |axis: usize| {
        let (lo, hi) =
            ring.iter().fold((f64::MAX, f64::MIN), |(lo, hi), p| (lo.min(p[axis]), hi.max(p[axis])));
        hi - lo
    };
    let extent = extent(0).max(extent(1));
    let touch = TOUCH * extent * extent;

    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&a, &b| low(a, axis).total_cmp(&low(b, axis)).then(a.cmp(&b)));
    let mut active: Vec<usize> = Vec::new();
    let mut pairs_left = FREE_PAIRS.saturating_add(count.saturating_mul(PAIRS_PER_SIDE));
    for index in order {
        let start = low(index, axis);
        active.retain(|&other| high(other, axis) >= start);
        if active.len() > pairs_left {
            return Crossing::Unknown;
        }
        pairs_left -= active.len();
        let (lo, hi) = (low(index, 1 - axis), high(index, 1 - axis));
        for &other in &active {
            if low(other, 1 - axis) <= hi
                && high(other, 1 - axis) >= lo
                && cross(side(index), side(other), touch)
            {
                return Crossing::Yes;
            }
        }
        active.push(index);
    }
    Crossing::No
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
mod tests {
    use super::*;

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
        // A square with a square hole, cut open along one line, there and back.
        let keyhole = [
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
        assert_eq!(crosses_itself(&keyhole), Crossing::No);
        // A corner on another side.
        let pinched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        assert_eq!(crosses_itself(&pinched), Crossing::No);
    }

    #[test]
    fn work_is_bounded() {
        // Long parallel sides at 45 degrees: each overlaps all others in both axes.
        let count = 40_000;
        let ring: Vec<[f64; 2]> = (0..count)
            .map(|i| {
                let (end, shift) = (if i % 4 < 2 { 0.0 } else { 1e6 }, i as f64);
                [end + shift, end - shift]
            })
            .collect();
        assert_eq!(crosses_itself(&ring), Crossing::Unknown);
    }
}
