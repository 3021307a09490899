//! The grid itself: which step, where its origin lies, and rounding to it.

use super::{LARGEST, Point};

/// The power-of-two grid of one building.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Its origin, internal frame: whole metres.
    pub origin: [f64; 3],
    /// Steps in a metre are 2 to this power: from 13 to 16.
    pub bits: u32,
}

impl Lattice {
    /// Steps of a metre: 2 to this power at the finest.
    pub const FINEST: u32 = 16;
    /// Steps of a metre: 2 to this power at the coarsest.
    pub const COARSEST: u32 = 13;

    /// The finest lattice about the middle of the box `bounds` (lower, upper corner, metres, internal frame) that
    /// holds all of it; the coarsest, which then does not hold it, for a box beyond 4 km.
    pub fn about(bounds: [[f64; 3]; 2]) -> Lattice {
        let origin = [0, 1, 2].map(|i| ((bounds[0][i] + bounds[1][i]) / 2.0).round());
        let reach =
            (0..3).map(|i| (bounds[1][i] - origin[i]).max(origin[i] - bounds[0][i])).fold(0.0f64, f64::max);
        let fits = |bits: &u32| reach * f64::from(1u32 << bits) <= f64::from(LARGEST);
        let bits = (Lattice::COARSEST..=Lattice::FINEST).rev().find(fits).unwrap_or(Lattice::COARSEST);
        Lattice { origin, bits }
    }

    /// One step, metres.
    pub fn step(&self) -> f64 {
        1.0 / f64::from(1u32 << self.bits)
    }

    /// A length in steps, not rounded.
    pub fn steps(&self, metres: f64) -> f64 {
        metres * f64::from(1u32 << self.bits)
    }

    /// The coordinate along `axis` in steps from the origin, not rounded.
    pub fn local(&self, axis: usize, metres: f64) -> f64 {
        self.steps(metres - self.origin[axis])
    }

    /// The nearest lattice coordinate along `axis`; beyond the lattice, its end.
    pub fn round(&self, axis: usize, metres: f64) -> i32 {
        let largest = f64::from(LARGEST);
        self.local(axis, metres).round().clamp(-largest, largest) as i32
    }

    /// The plan point nearest to `p`.
    pub fn point(&self, p: [f64; 3]) -> Point {
        Point { x: self.round(0, p[0]), y: self.round(1, p[1]) }
    }

    /// The coordinate along `axis` of a lattice coordinate, metres, internal frame.
    pub fn metres(&self, axis: usize, coordinate: f64) -> f64 {
        self.origin[axis] + coordinate * self.step()
    }

    /// Whether `p` lies within the lattice.
    pub fn holds(&self, p: [f64; 3]) -> bool {
        (0..3).all(|axis| self.local(axis, p[axis]).abs() <= f64::from(LARGEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_follows_from_the_size() {
        let lattice = |half: f64| Lattice::about([[-half; 3], [half; 3]]);
        assert_eq!(lattice(255.0).bits, 16);
        assert_eq!(lattice(256.0).bits, 16);
        assert_eq!(lattice(256.1).bits, 15);
        assert_eq!(lattice(2048.0).bits, 13);
        assert_eq!(lattice(1e7).bits, 13);
        assert!(!lattice(1e7).holds([1e7, 0.0, 0.0]));
    }

    #[test]
    fn coordinates_are_exact_in_f32_and_come_back() {
        let lattice = Lattice::about([[100.25, -3.0, 0.0], [140.5, 9.0, 11.0]]);
        assert_eq!(lattice.origin, [120.0, 3.0, 6.0]);
        for x in [100.25, 100.3, 133.333_333, 140.5] {
            let c = lattice.round(0, x);
            assert_eq!(f64::from(c as f32), f64::from(c));
            assert!((lattice.metres(0, f64::from(c)) - x).abs() <= lattice.step() / 2.0);
        }
    }
}
