//! Coordinates as the numbers of glTF accessors: floats, and integers of KHR_mesh_quantization.

use super::algebra::Point;

/// How coordinates are written.
#[derive(Clone, Copy, Debug)]
pub enum Numbers {
    Float,
    /// As integers (KHR_mesh_quantization). 8 bits only where they hold the very coordinates, else 16.
    Integer {
        few_bits: bool,
        is_signed: bool,
        is_normalized: bool,
    },
}

/// Points as numbers of one kind.
pub struct Items {
    pub component: u32,
    pub is_normalized: bool,
    /// Bytes of the three numbers of each point.
    pub bytes: Vec<Vec<u8>>,
    pub values: Vec<Point>,
}

/// How coordinates become numbers: `origin + step * number`.
pub struct Code {
    pub component: u32,
    pub is_normalized: bool,
    pub origin: Point,
    pub step: Point,
    pub lowest: f64,
    pub largest: f64,
    pub error: f64,
}

impl Code {
    pub fn of(points: &[Point], numbers: Numbers) -> Code {
        let Numbers::Integer { few_bits, is_signed, is_normalized } = numbers else {
            let most = points.iter().flatten().fold(0.0f64, |m, c| m.max(c.abs()));
            // Half of the distance to the next 32-bit float.
            let error = most * f64::from(f32::EPSILON) / 2.0;
            let (lowest, largest) = (f64::NEG_INFINITY, f64::INFINITY);
            let (origin, step) = ([0.0; 3], [1.0; 3]);
            return Code { component: 5126, is_normalized: false, origin, step, lowest, largest, error };
        };
        let with = |bits: i32| {
            let largest = 2f64.powi(if is_signed { bits - 1 } else { bits }) - 1.0;
            let lowest = if is_signed { -largest } else { 0.0 };
            let component = match (bits, is_signed) {
                (8, true) => 5120,
                (8, false) => 5121,
                (_, true) => 5122,
                (_, false) => 5123,
            };
            let mut code = Code {
                component,
                is_normalized,
                origin: [0.0; 3],
                step: [1.0; 3],
                lowest,
                largest,
                error: 0.0,
            };
            for axis in 0..3 {
                let of_axis = || points.iter().map(|p| p[axis]);
                let low = of_axis().fold(f64::INFINITY, f64::min);
                let extent = of_axis().fold(f64::NEG_INFINITY, f64::max) - low;
                // A power of two, so that coordinates that are short stay so.
                let step = 2f64.powi((extent.max(1e-3) / (largest - lowest)).log2().ceil() as i32);
                code.step[axis] = step;
                code.origin[axis] = low - lowest * step;
                code.error = code.error.max(step / 2.0);
            }
            code
        };
        let coarse = with(8);
        let fits = few_bits && points.iter().all(|p| coarse.said(*p) == *p);
        if fits { coarse } else { with(16) }
    }

    fn numbers(&self, p: Point) -> Point {
        let number = |i: usize| {
            let exact = (p[i] - self.origin[i]) / self.step[i];
            if self.component == 5126 {
                f64::from(exact as f32)
            } else {
                exact.round().clamp(self.lowest, self.largest)
            }
        };
        [number(0), number(1), number(2)]
    }

    /// The coordinates that the numbers say.
    pub fn said(&self, p: Point) -> Point {
        let numbers = self.numbers(p);
        [0, 1, 2].map(|i| self.origin[i] + self.step[i] * numbers[i])
    }

    pub fn items(&self, points: &[Point]) -> Items {
        let number = |n: f64| match self.component {
            5120 => (n as i8).to_le_bytes().to_vec(),
            5121 => (n as u8).to_le_bytes().to_vec(),
            5122 => (n as i16).to_le_bytes().to_vec(),
            5123 => (n as u16).to_le_bytes().to_vec(),
            _ => (n as f32).to_le_bytes().to_vec(),
        };
        let values: Vec<Point> = points.iter().map(|p| self.numbers(*p)).collect();
        let bytes = values.iter().map(|v| v.iter().flat_map(|n| number(*n)).collect()).collect();
        Items { component: self.component, is_normalized: self.is_normalized, bytes, values }
    }
}
