//! Planes over the plan, with integer coefficients.
//!
//! The height of a plane at a lattice point is an integer number of [`FINE`] parts of a lattice unit. One denominator
//! for all planes makes comparisons additions: no products of determinants as with planes through three points, and no
//! overflow. What it costs is the slope's rounding: 3 um of height at 100 m from where the plane was taken.

use super::Point;

/// Parts of a lattice unit in which heights count: 2 to this power.
pub const FINE_BITS: u32 = 24;

/// Parts of a lattice unit in which heights count.
pub const FINE: i64 = 1 << FINE_BITS;

/// The plane z = (p x + q y + r) / [`FINE`], lattice units. Horizontal if p and q are 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Plane {
    /// Slope along x.
    pub p: i64,
    /// Slope along y.
    pub q: i64,
    /// Height over the origin.
    pub r: i64,
}

impl Plane {
    /// No plane is steeper along either axis: what is counts as vertical. Bounds heights to 2^62.
    pub const STEEPEST: f64 = 4096.0;

    /// The horizontal plane at `z` lattice units.
    pub const fn level(z: i32) -> Plane {
        Plane { p: 0, q: 0, r: (z as i64) << FINE_BITS }
    }

    /// The plane with the slopes `along` (no larger than [`Plane::STEEPEST`]) through the height `z` over `(x, y)`, all
    /// in lattice units; `None` if it is too steep or not a number, or its heights over the lattice would not fit.
    pub fn sloped(along: [f64; 2], at: [f64; 3]) -> Option<Plane> {
        let fine = FINE as f64;
        if !along.iter().all(|s| s.abs() <= Plane::STEEPEST)
            || !at.iter().all(|c| c.abs() <= (1u64 << 25) as f64)
        {
            return None;
        }
        let [p, q] = along.map(|s| (s * fine).round());
        let r = (at[2] * fine - p * at[0] - q * at[1]).round();
        Some(Plane { p: p as i64, q: q as i64, r: r as i64 })
    }

    /// Whether it is horizontal.
    pub const fn is_level(&self) -> bool {
        self.p == 0 && self.q == 0
    }

    /// Its height over a lattice point, in [`FINE`] parts of a unit.
    pub fn height(&self, at: Point) -> i64 {
        self.p * i64::from(at.x) + self.q * i64::from(at.y) + self.r
    }

    /// Its height over any place, lattice units.
    pub fn height_f64(&self, x: f64, y: f64) -> f64 {
        (self.p as f64 * x + self.q as f64 * y + self.r as f64) / FINE as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_exact_and_fit() {
        assert_eq!(Plane::level(-5).height(Point::new(7, 9)), -5 * FINE);
        let far = 1 << 24;
        let steep = Plane::sloped([4096.0, -4096.0], [0.0, 0.0, f64::from(far)]).unwrap();
        for (x, y) in [(far, -far), (-far, far), (far, far)] {
            let exact = 4096 * (i128::from(x) - i128::from(y)) * i128::from(FINE)
                + i128::from(far) * i128::from(FINE);
            assert_eq!(i128::from(steep.height(Point::new(x, y))), exact);
        }
        assert!(Plane::sloped([4097.0, 0.0], [0.0; 3]).is_none());
        assert!(Plane::sloped([f64::NAN, 0.0], [0.0; 3]).is_none());
    }

    #[test]
    fn a_plane_passes_near_where_it_was_taken() {
        let at = [1234.5, -99_999.25, 17.125];
        let plane = Plane::sloped([0.123_456_789, -2.75], at).unwrap();
        assert!((plane.height_f64(at[0], at[1]) - at[2]).abs() < 1e-6);
    }
}
