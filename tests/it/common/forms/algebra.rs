//! Placements, and the axes and units in which they are written down.

pub type Point = [f64; 3];

/// An affine map; rows of the linear part.
#[derive(Clone, Copy, Debug)]
pub struct Map {
    pub linear: [Point; 3],
    pub at: Point,
}

impl Map {
    pub const IDENTITY: Map =
        Map { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], at: [0.0; 3] };

    pub fn point(&self, p: Point) -> Point {
        let row = |i: usize| {
            let l = self.linear[i];
            l[0] * p[0] + l[1] * p[1] + l[2] * p[2] + self.at[i]
        };
        [row(0), row(1), row(2)]
    }

    /// First `inner`, then this.
    pub fn after(&self, inner: &Map) -> Map {
        let no_shift = Map { linear: self.linear, at: [0.0; 3] };
        let columns = [0, 1, 2].map(|j| no_shift.point([0, 1, 2].map(|i| inner.linear[i][j])));
        let linear = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
        Map { linear, at: self.point(inner.at) }
    }

    /// As glTF writes it: 16 numbers, column by column.
    pub fn columns(&self) -> [f64; 16] {
        let mut all = [0.0; 16];
        for j in 0..3 {
            for i in 0..3 {
                all[4 * j + i] = self.linear[i][j];
            }
            all[12 + j] = self.at[j];
        }
        all[15] = 1.0;
        all
    }

    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.linear.into_iter().flatten().chain(self.at)
    }
}

/// A turn, as a quaternion (x, y, z, w) of any length and as a matrix.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    pub quaternion: [f64; 4],
    pub matrix: [Point; 3],
}

impl Turn {
    pub const NONE: Turn = Turn { quaternion: [0.0, 0.0, 0.0, 1.0], matrix: Map::IDENTITY.linear };

    /// So many quarters of a turn about the vertical; the matrix is exact.
    pub fn quarters(count: i32) -> Turn {
        let half = f64::from(count.rem_euclid(4)) * std::f64::consts::FRAC_PI_4;
        let quaternion = match count.rem_euclid(4) {
            0 => [0.0, 0.0, 0.0, 1.0],
            2 => [0.0, 0.0, 1.0, 0.0],
            _ => [0.0, 0.0, half.sin(), half.cos()],
        };
        let (s, c) = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)][count.rem_euclid(4) as usize];
        Turn { quaternion, matrix: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// A turn about any axis by any angle, by Rodrigues' formula.
    pub fn about(axis: Point, degrees: f64) -> Turn {
        let length = axis.iter().map(|c| c * c).sum::<f64>().sqrt();
        let [x, y, z] = axis.map(|c| c / length);
        let (s, c) = degrees.to_radians().sin_cos();
        let (hs, hc) = (degrees.to_radians() / 2.0).sin_cos();
        let t = 1.0 - c;
        let matrix = [
            [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
            [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
            [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
        ];
        Turn { quaternion: [x * hs, y * hs, z * hs, hc], matrix }
    }
}

/// Scale, then turn, then shift.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub scale: Point,
    pub turn: Turn,
    pub at: Point,
}

impl Place {
    pub const HERE: Place = Place { scale: [1.0; 3], turn: Turn::NONE, at: [0.0; 3] };

    pub fn map(&self) -> Map {
        let linear = self.turn.matrix.map(|row| [0, 1, 2].map(|j| row[j] * self.scale[j]));
        Map { linear, at: self.at }
    }

    pub fn mirrors(&self) -> bool {
        self.scale.iter().product::<f64>() < 0.0
    }

    /// First scale and shift by `inner`, then this: still scale, turn, shift.
    pub fn after_scaling(&self, scale: Point, shift: Point) -> Place {
        let scale = [0, 1, 2].map(|i| self.scale[i] * scale[i]);
        Place { scale, turn: self.turn, at: self.map().point(shift) }
    }
}

/// Axes and unit of written coordinates. The building itself is in metres, Z up.
#[derive(Clone, Copy, Debug)]
pub struct Content {
    /// Metres.
    pub unit: f64,
    /// Y up as in glTF, or Z up.
    pub y_up: bool,
}

impl Content {
    pub fn axes(&self, p: Point) -> Point {
        if self.y_up { [p[0], p[2], -p[1]] } else { p }
    }

    pub fn point(&self, p: Point) -> Point {
        self.axes(p).map(|c| c / self.unit)
    }

    /// The same placement, of things written so, among things written so.
    pub fn place(&self, place: &Place) -> Place {
        let [x, y, z, w] = place.turn.quaternion;
        let [x, y, z] = self.axes([x, y, z]);
        // Row by row, then column by column: the matrix between two changes of axes.
        let rows = place.turn.matrix.map(|row| self.axes(row));
        let columns = [0, 1, 2].map(|j| self.axes([0, 1, 2].map(|i| rows[i][j])));
        let matrix = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i]));
        let scale = self.axes(place.scale);
        // A factor has no direction to change.
        let scale = if self.y_up { [scale[0], scale[1], -scale[2]] } else { scale };
        Place { scale, turn: Turn { quaternion: [x, y, z, w], matrix }, at: self.point(place.at) }
    }

    /// From what is written to glTF's own axes and unit.
    pub fn to_gltf(self) -> Map {
        let u = self.unit;
        let linear = if self.y_up {
            [[u, 0.0, 0.0], [0.0, u, 0.0], [0.0, 0.0, u]]
        } else {
            [[u, 0.0, 0.0], [0.0, 0.0, u], [0.0, -u, 0.0]]
        };
        Map { linear, at: [0.0; 3] }
    }
}

/// Whether a number is so short that sums and products of a few like it are exact in f64.
pub fn is_short(x: f64) -> bool {
    x.abs() < f64::from(1 << 23) && (x * 1024.0).fract() == 0.0
}
