//! The grid that generated buildings are drawn on: 1/1024 m, so that every coordinate is a small integer, exact in
//! f32, and areas and volumes are exact in integers.

/// Units of the grid in one metre.
pub const PER_METRE: i32 = 1024;

/// A point in units of the grid; x to the east, y to the north, z up.
pub type Point = [i32; 3];

/// The grid's nearest coordinate to `metres`; beyond 2,000 km the nearest that an `i32` holds.
pub fn units(metres: f64) -> i32 {
    (metres * f64::from(PER_METRE)).round() as i32
}

/// A coordinate of the grid in metres; exact.
pub fn metres(units: i32) -> f64 {
    f64::from(units) / f64::from(PER_METRE)
}

/// A point of the grid in metres; exact.
pub fn point_metres(p: Point) -> [f64; 3] {
    p.map(metres)
}

/// A box with sides along the axes, in units of the grid. Empty unless `lo` is below `hi` on all axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cuboid {
    /// The corner with the least coordinates.
    pub lo: Point,
    /// The corner with the greatest coordinates.
    pub hi: Point,
}

impl Cuboid {
    /// The box with two opposite corners given in metres, in any order.
    pub fn new(a: [f64; 3], b: [f64; 3]) -> Cuboid {
        Cuboid::between(a.map(units), b.map(units))
    }

    /// The box with two opposite corners, in any order.
    pub fn between(a: Point, b: Point) -> Cuboid {
        Cuboid { lo: [0, 1, 2].map(|i| a[i].min(b[i])), hi: [0, 1, 2].map(|i| a[i].max(b[i])) }
    }

    /// What it covers of the plan.
    pub fn plan(&self) -> Rect {
        Rect { lo: [self.lo[0], self.lo[1]], hi: [self.hi[0], self.hi[1]] }
    }

    /// Whether it holds no space.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|i| self.lo[i] >= self.hi[i])
    }
}

/// A rectangle of the plan with sides along the axes, in units of the grid. Empty unless `lo` is below `hi` on both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rect {
    /// The corner with the least coordinates.
    pub lo: [i32; 2],
    /// The corner with the greatest coordinates.
    pub hi: [i32; 2],
}

impl Rect {
    /// The rectangle with two opposite corners, in any order.
    pub fn between(a: [i32; 2], b: [i32; 2]) -> Rect {
        Rect { lo: [0, 1].map(|i| a[i].min(b[i])), hi: [0, 1].map(|i| a[i].max(b[i])) }
    }

    /// What a box covers of the plan.
    pub fn under(cuboid: &Cuboid) -> Rect {
        Rect { lo: [cuboid.lo[0], cuboid.lo[1]], hi: [cuboid.hi[0], cuboid.hi[1]] }
    }

    /// Whether it has no area.
    pub fn is_empty(&self) -> bool {
        self.lo[0] >= self.hi[0] || self.lo[1] >= self.hi[1]
    }

    /// Whether the insides of two rectangles, which are not empty, share a point.
    pub fn overlaps(&self, other: &Rect) -> bool {
        (0..2).all(|i| self.lo[i] < other.hi[i] && other.lo[i] < self.hi[i])
    }

    /// Its width and height; right below 2^31 units.
    pub fn size(&self) -> [i32; 2] {
        [0, 1].map(|i| self.hi[i].saturating_sub(self.lo[i]))
    }

    /// Twice its middle.
    pub fn doubled_middle(&self) -> [i64; 2] {
        [0, 1].map(|i| i64::from(self.lo[i]) + i64::from(self.hi[i]))
    }

    /// Where a rectangle of a thing's own frame is.
    pub fn placed(&self, place: &Placement) -> Rect {
        let at = |[u, v]: [i32; 2]| {
            let [x, y, _] = place.point([u, v, 0]);
            [x, y]
        };
        Rect::between(at(self.lo), at(self.hi))
    }

    /// Larger by `by` on all sides.
    pub fn grown(&self, by: i32) -> Rect {
        Rect { lo: self.lo.map(|c| c.saturating_sub(by)), hi: self.hi.map(|c| c.saturating_add(by)) }
    }
}

/// Where a thing drawn in its own frame stands: turned by quarter turns about the vertical, then moved.
///
/// In its own frame a thing that belongs to a wall has u along the wall, v from the wall into the room, and the
/// face of the wall at v = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// Where the thing's own origin goes.
    pub origin: Point,
    /// Quarter turns, counter-clockwise seen from above. With 0, v points north; 1: west; 2: south; 3: east.
    pub turns: u8,
}

impl Placement {
    /// Where a plan vector of the thing's own frame points.
    pub fn turn(&self, [u, v]: [i32; 2]) -> [i32; 2] {
        match self.turns % 4 {
            0 => [u, v],
            1 => [-v, u],
            2 => [-u, -v],
            _ => [v, -u],
        }
    }

    /// Where a point of the thing's own frame is.
    pub fn point(&self, [u, v, z]: Point) -> Point {
        let [x, y] = self.turn([u, v]);
        [self.origin[0] + x, self.origin[1] + y, self.origin[2] + z]
    }

    /// Where a box of the thing's own frame is.
    pub fn cuboid(&self, cuboid: &Cuboid) -> Cuboid {
        Cuboid::between(self.point(cuboid.lo), self.point(cuboid.hi))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metres_and_units() {
        assert_eq!(units(0.36), 369);
        assert_eq!(units(-0.3), -307);
        assert_eq!(metres(units(2.5)), 2.5);
        assert_eq!(metres(1), 0.0009765625);
    }

    #[test]
    fn quarter_turns_keep_the_orientation() {
        for turns in 0..4 {
            let place = Placement { origin: [10, 20, 30], turns };
            let (u, v) = (place.turn([1, 0]), place.turn([0, 1]));
            assert_eq!(u[0] * v[1] - u[1] * v[0], 1, "{turns} turns");
        }
        let west = Placement { origin: [100, 0, 0], turns: 1 };
        assert_eq!(west.point([5, 7, 9]), [93, 5, 9]);
        let cuboid = west.cuboid(&Cuboid { lo: [0, 0, 0], hi: [5, 7, 9] });
        assert_eq!(cuboid, Cuboid { lo: [93, 0, 0], hi: [100, 5, 9] });
        assert!(!cuboid.is_empty());
    }
}
