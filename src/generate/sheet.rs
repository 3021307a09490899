//! Sheets that a building is drawn on: each has a frame of its own, and lies somewhere in the world.

use super::lattice::Point;
use super::plan::{Paint, Plan};

/// How a sheet lies in the plane of the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Embedding {
    /// As it is drawn.
    Straight,
    /// Turned about its origin, counter-clockwise, and moved. Points whose coordinates are multiples of `turn.whole`
    /// fall on the grid; others are rounded.
    Turned {
        /// Where the sheet's origin goes.
        origin: [i32; 2],
        /// The angle.
        turn: Turn,
    },
    /// Rolled around a center: x is the radius, y counts facets from the first of `rim`.
    Round {
        /// The center.
        center: [i32; 2],
        /// Unit vectors to the ends of the facets, counter-clockwise.
        rim: Vec<[f64; 2]>,
    },
}

/// An angle whose sine and cosine are the fractions `sine / whole` and `cosine / whole`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// The numerator of its sine.
    pub sine: i32,
    /// The numerator of its cosine.
    pub cosine: i32,
    /// The denominator of both.
    pub whole: i32,
}

impl Turn {
    /// The largest denominator in use: a decimetre of the grid.
    const MOST: i32 = 101;

    /// The angle nearest to `degrees` among those with small denominators; never more than five degrees off, and
    /// mostly less than one.
    pub fn near(degrees: f64) -> Turn {
        let radians = degrees.to_radians();
        let (sine, cosine) = (libm::sin(radians), libm::cos(radians));
        let mut best = Turn { sine: 0, cosine: 1, whole: 1 };
        let fit = |t: &Turn| (f64::from(t.sine) * sine + f64::from(t.cosine) * cosine) / f64::from(t.whole);
        // All right triangles with whole sides m^2 - n^2, 2mn, m^2 + n^2, in all eight octants.
        for m in 1..=10 {
            for n in 0..m {
                let (a, b, whole) = (m * m - n * n, 2 * m * n, m * m + n * n);
                if whole > Turn::MOST {
                    continue;
                }
                for (sine, cosine) in [(a, b), (b, a)] {
                    for (sine, cosine) in [(sine, cosine), (sine, -cosine), (-sine, cosine), (-sine, -cosine)]
                    {
                        let turn = Turn { sine, cosine, whole };
                        if fit(&turn) > fit(&best) + 1e-12 {
                            best = turn;
                        }
                    }
                }
            }
        }
        best.reduced()
    }

    fn reduced(self) -> Turn {
        let gcd = super::flush::gcd(self.whole as u64, self.sine.unsigned_abs().into()).max(1) as i32;
        Turn { sine: self.sine / gcd, cosine: self.cosine / gcd, whole: self.whole / gcd }
    }
}

impl Embedding {
    /// A round sheet of `facets` facets from angle `from` to angle `to`, degrees.
    pub fn round(center: [i32; 2], facets: usize, [from, to]: [f64; 2]) -> Embedding {
        let facets = facets.max(1);
        let rim = (0..=facets).map(|i| {
            let degrees = from + (to - from) * i as f64 / facets as f64;
            // Quarter turns exactly: there the sheet adjoins others.
            match degrees.rem_euclid(360.0) {
                0.0 => [1.0, 0.0],
                90.0 => [0.0, 1.0],
                180.0 => [-1.0, 0.0],
                270.0 => [0.0, -1.0],
                _ => [libm::cos(degrees.to_radians()), libm::sin(degrees.to_radians())],
            }
        });
        Embedding::Round { center, rim: rim.collect() }
    }

    /// Where a plan point of the sheet lies.
    pub fn place(&self, [x, y]: [i32; 2]) -> [i32; 2] {
        match self {
            Embedding::Straight => [x, y],
            Embedding::Turned { origin, turn: Turn { sine, cosine, whole } } => {
                let [x, y, s, c, w] = [x, y, *sine, *cosine, *whole].map(i64::from);
                let round = |n: i64| (2 * n + w).div_euclid(2 * w) as i32;
                [origin[0] + round(x * c - y * s), origin[1] + round(x * s + y * c)]
            }
            Embedding::Round { center, rim } => {
                let last = rim.len() - 1;
                let [dx, dy] = rim[(y.max(0) as usize).min(last)].map(|c| (c * f64::from(x)).round() as i32);
                [center[0] + dx, center[1] + dy]
            }
        }
    }

    /// Where a point of the sheet lies.
    pub fn point(&self, [x, y, z]: Point) -> Point {
        let [x, y] = self.place([x, y]);
        [x, y, z]
    }

    /// A plan drawn on the sheet, in the world.
    pub fn plan(&self, paints: &[Paint], bottom: i32) -> Plan {
        let plan = match self {
            Embedding::Round { rim, .. } => Plan::of_rolled(paints, bottom, rim.len() as i32 - 1),
            _ => Plan::of_paints(paints, bottom),
        };
        plan.moved(|point| self.place(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_right_triangles() {
        for degrees in [0.0, 3.0, 16.0, 30.0, 45.0, 61.0, 90.0, 123.0, 180.0, 200.0, 300.0, -37.0] {
            let Turn { sine, cosine, whole } = Turn::near(degrees);
            assert_eq!(sine * sine + cosine * cosine, whole * whole, "{degrees}");
            let off = f64::from(sine).atan2(f64::from(cosine)).to_degrees() - degrees;
            let off = (off + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 5.0, "{degrees}: off by {off}");
        }
        assert_eq!(Turn::near(36.9), Turn { sine: 3, cosine: 4, whole: 5 });
        assert_eq!(Turn::near(90.0), Turn { sine: 1, cosine: 0, whole: 1 });
    }

    #[test]
    fn turned_multiples_are_exact() {
        let turned = Embedding::Turned { origin: [10, 20], turn: Turn { sine: 3, cosine: 4, whole: 5 } };
        assert_eq!(turned.place([0, 0]), [10, 20]);
        assert_eq!(turned.place([50, 0]), [50, 50]);
        assert_eq!(turned.place([0, 50]), [-20, 60]);
        let round = Embedding::round([0, 0], 4, [0.0, 180.0]);
        assert_eq!(round.place([100, 0]), [100, 0]);
        assert_eq!(round.place([100, 1]), [71, 71]);
        assert_eq!(round.place([100, 4]), [-100, 0]);
    }
}
