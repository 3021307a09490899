//! Three f64 as a vector.

pub(crate) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn scale(a: [f64; 3], s: f64) -> [f64; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Swapping `a` and `b` changes the signs of the result, and not one other bit.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    length(sub(a, b))
}

pub(crate) fn max_abs(a: [f64; 3]) -> f64 {
    a[0].abs().max(a[1].abs()).max(a[2].abs())
}

/// `a` with unit length; zeros if it has none.
pub(crate) fn unit(a: [f64; 3]) -> [f64; 3] {
    let largest = max_abs(a);
    if largest == 0.0 || !largest.is_finite() {
        return [0.0; 3];
    }
    let a = scale(a, 1.0 / largest);
    scale(a, 1.0 / length(a))
}

/// Two unit vectors at right angles to the unit vector `d` and to each other.
pub(crate) fn basis(d: [f64; 3]) -> [[f64; 3]; 2] {
    let least = (0..3).min_by(|&i, &j| d[i].abs().total_cmp(&d[j].abs())).unwrap_or(0);
    let mut helper = [0.0; 3];
    helper[least] = 1.0;
    let u = unit(cross(d, helper));
    [u, cross(d, u)]
}

/// A box: lower and upper corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) lo: [f64; 3],
    pub(crate) hi: [f64; 3],
}

impl Bounds {
    /// Holds nothing.
    pub(crate) const EMPTY: Bounds = Bounds { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

    pub(crate) fn of(points: &[[f64; 3]]) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for p in points {
            bounds.add(*p);
        }
        bounds
    }

    pub(crate) fn add(&mut self, p: [f64; 3]) {
        *self = self.union(Bounds { lo: p, hi: p });
    }

    pub(crate) fn union(self, other: Bounds) -> Bounds {
        Bounds {
            lo: [0, 1, 2].map(|i| self.lo[i].min(other.lo[i])),
            hi: [0, 1, 2].map(|i| self.hi[i].max(other.hi[i])),
        }
    }

    pub(crate) fn intersection(self, other: Bounds) -> Bounds {
        Bounds {
            lo: [0, 1, 2].map(|i| self.lo[i].max(other.lo[i])),
            hi: [0, 1, 2].map(|i| self.hi[i].min(other.hi[i])),
        }
    }

    pub(crate) fn grown(self, by: f64) -> Bounds {
        Bounds { lo: self.lo.map(|c| c - by), hi: self.hi.map(|c| c + by) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        (0..3).any(|i| self.lo[i] > self.hi[i])
    }

    pub(crate) fn contains(&self, p: [f64; 3]) -> bool {
        (0..3).all(|i| self.lo[i] <= p[i] && p[i] <= self.hi[i])
    }

    pub(crate) fn size(&self) -> [f64; 3] {
        sub(self.hi, self.lo)
    }

    pub(crate) fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| 0.5 * self.lo[i] + 0.5 * self.hi[i])
    }

    /// Distance from `p` to the box; 0 inside.
    pub(crate) fn distance(&self, p: [f64; 3]) -> f64 {
        length([0, 1, 2].map(|i| (self.lo[i] - p[i]).max(p[i] - self.hi[i]).max(0.0)))
    }
}
