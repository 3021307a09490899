//! The grid itself: which step, where its origin lies, how it is turned, and rounding to it.

use super::{LARGEST, Point};

/// The power-of-two grid of one building.
///
/// It stands upright, turned about the vertical with the building: on a grid along its walls their corners lie on
/// straight lines again after rounding, and no room is cut for a unit's kink.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Its origin, internal frame: whole metres.
    pub origin: [f64; 3],
    /// The direction of its first axis in the internal frame's plan: cosine and sine. `[1, 0]` if it is not turned.
    pub turn: [f64; 2],
    /// Steps in a metre are 2 to this power: from 13 to 16.
    pub bits: u32,
}

impl Lattice {
    /// Steps of a metre: 2 to this power at the finest.
    pub const FINEST: u32 = 16;
    /// Steps of a metre: 2 to this power at the coarsest.
    pub const COARSEST: u32 = 13;

    /// The finest lattice turned by `turn` (cosine, sine) that holds all `points` (metres, internal frame), about
    /// their middle; the coarsest, which then does not hold them, if they lie beyond 4 km.
    pub fn about(points: impl Iterator<Item = [f64; 3]>, turn: [f64; 2]) -> Lattice {
        let mut bounds: Option<[[f64; 3]; 2]> = None;
        for p in points {
            let p = turned(p, turn);
            let [lo, hi] = bounds.get_or_insert([p, p]);
            for axis in 0..3 {
                lo[axis] = lo[axis].min(p[axis]);
                hi[axis] = hi[axis].max(p[axis]);
            }
        }
        let [lo, hi] = bounds.unwrap_or_default();
        let middle = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) / 2.0);
        let origin = turned(middle, [turn[0], -turn[1]]).map(f64::round);
        let centre = turned(origin, turn);
        let reach = (0..3).map(|i| (hi[i] - centre[i]).max(centre[i] - lo[i])).fold(0.0f64, f64::max);
        let fits = |bits: &u32| reach * f64::from(1u32 << bits) <= f64::from(LARGEST);
        let bits = (Lattice::COARSEST..=Lattice::FINEST).rev().find(fits).unwrap_or(Lattice::COARSEST);
        Lattice { origin, turn, bits }
    }

    /// One step, metres.
    pub fn step(&self) -> f64 {
        1.0 / f64::from(1u32 << self.bits)
    }

    /// A length in steps, not rounded.
    pub fn steps(&self, metres: f64) -> f64 {
        metres * f64::from(1u32 << self.bits)
    }

    /// A point of the internal frame in steps along the lattice's axes, not rounded.
    pub fn local(&self, p: [f64; 3]) -> [f64; 3] {
        turned([0, 1, 2].map(|i| p[i] - self.origin[i]), self.turn).map(|c| self.steps(c))
    }

    /// A direction of the internal frame along the lattice's axes: of the same length.
    pub fn local_direction(&self, d: [f64; 3]) -> [f64; 3] {
        turned(d, self.turn)
    }

    /// The lattice coordinates nearest to a point given in steps; beyond the lattice, its end.
    pub fn round(local: [f64; 3]) -> [i32; 3] {
        let largest = f64::from(LARGEST);
        local.map(|c| c.round().clamp(-largest, largest) as i32)
    }

    /// The plan point nearest to a point given in steps.
    pub fn point(local: [f64; 3]) -> Point {
        let [x, y, _] = Lattice::round(local);
        Point { x, y }
    }

    /// The point of the internal frame, metres, at `local` steps.
    pub fn metres(&self, local: [f64; 3]) -> [f64; 3] {
        let p = turned(local.map(|c| c * self.step()), [self.turn[0], -self.turn[1]]);
        [0, 1, 2].map(|i| p[i] + self.origin[i])
    }

    /// The height in the internal frame, metres, of `z` steps.
    pub fn height(&self, z: f64) -> f64 {
        self.origin[2] + z * self.step()
    }

    /// Whether a point of the internal frame lies within the lattice.
    pub fn holds(&self, p: [f64; 3]) -> bool {
        self.local(p).iter().all(|c| c.abs() <= f64::from(LARGEST))
    }
}

/// The coordinates of `p` along axes turned by `turn`.
fn turned([x, y, z]: [f64; 3], [cos, sin]: [f64; 2]) -> [f64; 3] {
    [x * cos + y * sin, y * cos - x * sin, z]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_follows_from_the_size() {
        let lattice = |half: f64| Lattice::about([[-half; 3], [half; 3]].into_iter(), [1.0, 0.0]);
        assert_eq!(lattice(255.0).bits, 16);
        assert_eq!(lattice(256.0).bits, 16);
        assert_eq!(lattice(256.1).bits, 15);
        assert_eq!(lattice(2048.0).bits, 13);
        assert_eq!(lattice(1e7).bits, 13);
        assert!(!lattice(1e7).holds([1e7, 0.0, 0.0]));
    }

    #[test]
    fn coordinates_are_exact_in_f32_and_come_back() {
        for turn in [[1.0, 0.0], [0.8, 0.6]] {
            let corners = [[100.25, -3.0, 0.0], [140.5, 9.0, 11.0]];
            let lattice = Lattice::about(corners.into_iter(), turn);
            for p in [corners[0], corners[1], [133.333_333, 4.567, 8.9]] {
                let rounded = Lattice::round(lattice.local(p));
                for c in rounded {
                    assert_eq!(f64::from(c as f32), f64::from(c));
                }
                let back = lattice.metres(rounded.map(f64::from));
                for axis in 0..3 {
                    assert!((back[axis] - p[axis]).abs() <= lattice.step());
                }
            }
        }
        let straight = Lattice::about([[100.25, -3.0, 0.0], [140.5, 9.0, 11.0]].into_iter(), [1.0, 0.0]);
        assert_eq!(straight.origin, [120.0, 3.0, 6.0]);
    }
}
