//! The two frames: the source's own, and enfilade's internal one.
//!
//! Inside, everything is in metres, Z up, with an offset taken off where the model lies far from its origin. The
//! axes are only permuted, and the offset is a whole number of metres, so that going from one frame to the other
//! and back loses nothing but the rounding of the unit's factor.

/// Which axis points up in the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// Y up, right-handed, as glTF: source (x, y, z) is internal (x, -z, y).
    Y,
    /// Z up, right-handed, as IFC and most CAD tools: the internal axes.
    Z,
}

/// How the source's frame maps to the internal one (metres, Z up, offset taken off).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Metres in one unit of the source: 1 for glTF, 0.001 for a model in millimetres. Finite and positive.
    pub unit: f64,
    /// Which axis points up in the source.
    pub up: UpAxis,
    /// What was taken off the internal coordinates, in whole metres, internal axes; zeros where nothing was.
    pub offset: [f64; 3],
}

impl Default for Frame {
    fn default() -> Frame {
        Frame { unit: 1.0, up: UpAxis::Z, offset: [0.0; 3] }
    }
}

impl Frame {
    /// The frame of glTF: metres, Y up, no offset yet.
    pub const GLTF: Frame = Frame { unit: 1.0, up: UpAxis::Y, offset: [0.0; 3] };

    /// Whether an offset was taken off.
    pub fn has_offset(&self) -> bool {
        self.offset != [0.0; 3]
    }

    /// A direction (no unit, no offset) of the source, in internal axes. Length is kept.
    pub fn direction_to_internal(&self, d: [f64; 3]) -> [f64; 3] {
        match self.up {
            UpAxis::Y => [d[0], -d[2], d[1]],
            UpAxis::Z => d,
        }
    }

    /// A direction (no unit, no offset) of the internal frame, in the source's axes. Length is kept.
    pub fn direction_to_source(&self, d: [f64; 3]) -> [f64; 3] {
        match self.up {
            UpAxis::Y => [d[0], d[2], -d[1]],
            UpAxis::Z => d,
        }
    }

    /// A point of the source, in metres and internal axes, with the offset taken off.
    pub fn point_to_internal(&self, p: [f64; 3]) -> [f64; 3] {
        let q = self.direction_to_internal(p);
        [
            q[0] * self.unit - self.offset[0],
            q[1] * self.unit - self.offset[1],
            q[2] * self.unit - self.offset[2],
        ]
    }

    /// A point of the internal frame, in the source's unit and axes.
    pub fn point_to_source(&self, p: [f64; 3]) -> [f64; 3] {
        self.direction_to_source([
            (p[0] + self.offset[0]) / self.unit,
            (p[1] + self.offset[1]) / self.unit,
            (p[2] + self.offset[2]) / self.unit,
        ])
    }

    /// A box of the internal frame (lower and upper corner), in the source's unit and axes.
    pub fn box_to_source(&self, bounds: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let [a, b] = bounds.map(|corner| self.point_to_source(corner));
        [[0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))]
    }

    /// A length of the source in metres.
    pub fn length_to_internal(&self, length: f64) -> f64 {
        length * self.unit
    }

    /// Metres as a length of the source.
    pub fn length_to_source(&self, metres: f64) -> f64 {
        metres / self.unit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let frame = Frame { unit: 0.25, up: UpAxis::Y, offset: [1000.0, -2.0, 3.0] };
        let p = [4100.0, 20.5, -3.25];
        assert_eq!(frame.point_to_internal(p), [25.0, 2.8125, 2.125]);
        assert_eq!(frame.point_to_source(frame.point_to_internal(p)), p);
        let d = [1.0, 2.0, 3.0];
        assert_eq!(frame.direction_to_source(frame.direction_to_internal(d)), d);
        // Y up stays right-handed: x cross y = z.
        let x = frame.direction_to_internal([1.0, 0.0, 0.0]);
        let y = frame.direction_to_internal([0.0, 1.0, 0.0]);
        let z = frame.direction_to_internal([0.0, 0.0, 1.0]);
        let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
        assert_eq!(cross, z);
    }
}
