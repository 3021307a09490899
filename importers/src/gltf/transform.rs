//! Node transforms in f64.

use super::document::Placement;

/// An affine map: `linear * p + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Affine {
    /// Rows of the linear part.
    pub linear: [[f64; 3]; 3],
    /// Where the origin goes.
    pub translation: [f64; 3],
}

impl Affine {
    /// Leaves everything where it is.
    pub const IDENTITY: Affine =
        Affine { linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], translation: [0.0; 3] };

    /// A node's own transform.
    ///
    /// # Errors
    /// In words: the matrix is not affine, the rotation is no rotation, or a number is not finite.
    pub fn of(placement: &Placement) -> Result<Affine, String> {
        if let Some(matrix) = &placement.matrix {
            return Affine::from_columns(matrix);
        }
        Affine::from_parts(
            placement.translation.unwrap_or([0.0; 3]),
            placement.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            placement.scale.unwrap_or([1.0; 3]),
        )
    }

    fn from_columns(m: &[f64; 16]) -> Result<Affine, String> {
        // Exporters that multiply matrices in f32 leave some dust in the last row.
        let last = [m[3], m[7], m[11], m[15] - 1.0];
        if last.iter().any(|x| x.abs() > 1e-6) {
            return Err(format!(
                "the matrix's last row is {}, {}, {}, {}: not affine",
                m[3], m[7], m[11], m[15]
            ));
        }
        Affine {
            linear: [[m[0], m[4], m[8]], [m[1], m[5], m[9]], [m[2], m[6], m[10]]],
            translation: [m[12], m[13], m[14]],
        }
        .checked()
    }

    /// Scale, then rotation (a quaternion x, y, z, w of any length), then translation.
    ///
    /// # Errors
    /// In words: the quaternion is zero, or a number is not finite.
    pub fn from_parts(translation: [f64; 3], rotation: [f64; 4], scale: [f64; 3]) -> Result<Affine, String> {
        // Divided by the largest part first, so that no square over- or underflows.
        let largest = rotation.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let [x, y, z, w] = rotation.map(|c| c / largest);
        let square = x * x + y * y + z * z + w * w;
        if !(square.is_finite() && square > 0.0) {
            return Err(format!("the quaternion {rotation:?} is no rotation"));
        }
        let s = 2.0 / square;
        let rows = [
            [1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)],
        ];
        let linear = rows.map(|row| [row[0] * scale[0], row[1] * scale[1], row[2] * scale[2]]);
        Affine { linear, translation }.checked()
    }

    fn checked(self) -> Result<Affine, String> {
        let finite = self.linear.iter().chain([&self.translation]).flatten().all(|x| x.is_finite());
        if finite { Ok(self) } else { Err("the transform is not finite".to_owned()) }
    }

    /// First `inner`, then this.
    ///
    /// # Errors
    /// In words: a number of the product is not finite.
    pub fn after(&self, inner: &Affine) -> Result<Affine, String> {
        let column = |j: usize| self.direction([inner.linear[0][j], inner.linear[1][j], inner.linear[2][j]]);
        let [a, b, c] = [column(0), column(1), column(2)];
        Affine {
            linear: [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]],
            translation: self.point(inner.translation),
        }
        .checked()
    }

    /// Where a point goes.
    #[inline]
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let d = self.direction(p);
        [d[0] + self.translation[0], d[1] + self.translation[1], d[2] + self.translation[2]]
    }

    /// Where a difference of two points goes.
    #[inline]
    pub fn direction(&self, d: [f64; 3]) -> [f64; 3] {
        self.linear.map(|row| row[0] * d[0] + row[1] * d[1] + row[2] * d[2])
    }

    /// Whether it turns right hands into left ones, so that triangles have to be turned over.
    pub fn mirrors(&self) -> bool {
        let [a, b, c] = self.linear;
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2] < 0.0
    }
}

/// `v` with length 1; `None` if it has none.
pub(super) fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let scaled = v.map(|c| c / largest);
    let length = (scaled[0] * scaled[0] + scaled[1] * scaled[1] + scaled[2] * scaled[2]).sqrt();
    (length.is_finite() && length > 0.0).then(|| scaled.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_matrix_agree() {
        let half = std::f64::consts::FRAC_PI_4;
        let parts = Affine::from_parts([1.0, 2.0, 3.0], [0.0, half.sin(), 0.0, half.cos()], [2.0, 3.0, 4.0]);
        let parts = parts.unwrap();
        // A quarter turn about Y takes x to -z and z to x.
        let expected = |p: [f64; 3]| [1.0 + 4.0 * p[2], 2.0 + 3.0 * p[1], 3.0 - 2.0 * p[0]];
        let columns = [0.0, 0.0, -2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 1.0];
        let matrix = Affine::from_columns(&columns).unwrap();
        for p in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-3.0, 5.0, 0.5]] {
            assert_eq!(matrix.point(p), expected(p));
            assert!(parts.point(p).iter().zip(expected(p)).all(|(a, b)| (a - b).abs() < 1e-14));
        }
        assert!(!parts.mirrors());
    }

    #[test]
    fn composition_is_one_after_the_other() {
        let a = Affine::from_parts([5e6, 0.0, -1.0], [0.1, 0.2, 0.3, 0.9], [1.0, 2.0, 0.5]).unwrap();
        let b = Affine::from_parts([1.0, 2.0, 3.0], [0.5, 0.0, 0.0, 0.5], [-1.0, 1.0, 1.0]).unwrap();
        let p = [0.25, -7.0, 11.0];
        let (once, twice) = (a.after(&b).unwrap().point(p), a.point(b.point(p)));
        assert!(once.iter().zip(twice).all(|(x, y)| (x - y).abs() < 1e-8));
        assert!(b.mirrors() && a.after(&b).unwrap().mirrors() && !b.after(&b).unwrap().mirrors());
        assert_eq!(a.after(&Affine::IDENTITY).unwrap(), a);
    }

    #[test]
    fn quaternions_of_any_length_count_as_unit() {
        let unit = Affine::from_parts([0.0; 3], [0.0, 0.6, 0.0, 0.8], [1.0; 3]).unwrap();
        for factor in [1e-200, 0.5, 1e200] {
            let scaled = [0.0, 0.6 * factor, 0.0, 0.8 * factor];
            let other = Affine::from_parts([0.0; 3], scaled, [1.0; 3]).unwrap();
            for (a, b) in unit.linear.iter().flatten().zip(other.linear.iter().flatten()) {
                assert!((a - b).abs() < 1e-15);
            }
        }
        assert!(Affine::from_parts([0.0; 3], [0.0; 4], [1.0; 3]).is_err());
    }

    #[test]
    fn what_is_not_affine_or_finite_is_refused() {
        let mut m = [0.0; 16];
        (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0);
        assert_eq!(Affine::from_columns(&m), Ok(Affine::IDENTITY));
        m[11] = -1.0;
        assert!(Affine::from_columns(&m).is_err());
        let huge = Affine::from_parts([1e308; 3], [0.0, 0.0, 0.0, 1.0], [1e200; 3]).unwrap();
        assert!(huge.after(&huge).is_err());
    }
}
