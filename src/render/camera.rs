//! A pinhole camera: from where a picture is taken.

use glam::DVec3;

use crate::format::records::CameraRecord;
use crate::trace::Ray;

/// A camera in the internal frame (metres, Z up, offset taken off). Its axes are perpendicular and of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    vfov_degrees: f64,
}

/// The numbers make no camera.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A number is NaN, infinite, or too large to compute with.
    #[error("the camera's numbers are not finite")]
    NotFinite,
    /// Eye and target are one point, or the direction is zero.
    #[error("the camera looks nowhere: its eye is its target")]
    NoDirection,
    /// The field of view is none.
    #[error("the field of view is {0} degrees; it must be more than 0 and less than 180")]
    FieldOfView(f64),
}

/// Directions nearer to parallel than this do not tell which way is up.
const PARALLEL: f64 = 1e-9;

impl Camera {
    /// A camera at `eye` that looks at `target`, with `up_hint` upward in the picture as far as may be: what of it
    /// lies along the view is taken off. If nothing is left of it, Z is up, or Y for a view along Z.
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn look_at(
        eye: [f64; 3],
        target: [f64; 3],
        up_hint: [f64; 3],
        vfov_degrees: f64,
    ) -> Result<Camera, CameraError> {
        let direction = DVec3::from(target) - DVec3::from(eye);
        Camera::looking(eye, direction.to_array(), up_hint, vfov_degrees)
    }

    /// As [`Camera::look_at`], for a direction of any length.
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn looking(
        eye: [f64; 3],
        direction: [f64; 3],
        up_hint: [f64; 3],
        vfov_degrees: f64,
    ) -> Result<Camera, CameraError> {
        let (eye, up_hint) = (DVec3::from(eye), DVec3::from(up_hint));
        let direction = DVec3::from(direction);
        if !(eye.is_finite() && direction.is_finite() && up_hint.is_finite()) {
            return Err(CameraError::NotFinite);
        }
        if !(vfov_degrees > 0.0 && vfov_degrees < 180.0) {
            return Err(CameraError::FieldOfView(vfov_degrees));
        }
        let forward = unit(direction).ok_or(CameraError::NoDirection)?;
        let right = [up_hint, DVec3::Z, DVec3::Y]
            .into_iter()
            .filter_map(unit)
            .map(|up| forward.cross(up))
            .find(|right| right.length() > PARALLEL)
            // No direction is parallel to both Z and Y.
            .ok_or(CameraError::NotFinite)?
            .normalize();
        Ok(Camera { eye, forward, right, up: right.cross(forward), vfov_degrees })
    }

    /// A level camera, Z up, that looks along (`cos`, `sin`) of `azimuth` (radians). The numbers must make one.
    pub(super) fn level(eye: DVec3, azimuth: f64, vfov_degrees: f64) -> Camera {
        let forward = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0);
        Camera { eye, forward, right: forward.cross(DVec3::Z), up: DVec3::Z, vfov_degrees }
    }

    /// A camera of a scene.
    ///
    /// # Errors
    /// [`CameraError`].
    pub fn from_record(record: &CameraRecord) -> Result<Camera, CameraError> {
        Camera::looking(record.eye, record.direction, record.up, record.vfov)
    }

    /// Where it is, metres.
    pub fn eye(&self) -> [f64; 3] {
        self.eye.to_array()
    }

    /// Where it looks.
    pub fn forward(&self) -> [f64; 3] {
        self.forward.to_array()
    }

    /// To the right in the picture.
    pub fn right(&self) -> [f64; 3] {
        self.right.to_array()
    }

    /// Upward in the picture.
    pub fn up(&self) -> [f64; 3] {
        self.up.to_array()
    }

    /// The vertical field of view, degrees.
    pub fn vfov_degrees(&self) -> f64 {
        self.vfov_degrees
    }

    /// The camera made ready for a picture of `width` by `height` square pixels.
    pub fn pinhole(&self, width: u32, height: u32) -> Pinhole {
        let half = (self.vfov_degrees.to_radians() / 2.0).tan();
        let pixel = 2.0 * half / f64::from(height.max(1));
        let (across, down) = (self.right * pixel, self.up * -pixel);
        let corner = self.forward - across * (f64::from(width) / 2.0) - down * (f64::from(height) / 2.0);
        Pinhole { eye: self.eye, corner, across, down }
    }

    /// The ray through the centre of the pixel in column `x` and row `y` (from the top) of a picture of `width` by
    /// `height` square pixels. For many rays of one picture, see [`Camera::pinhole`].
    pub fn ray(&self, x: u32, y: u32, width: u32, height: u32) -> Ray {
        self.pinhole(width, height).ray(x, y)
    }
}

/// The direction of `v`; `None` if it is zero or not finite.
fn unit(v: DVec3) -> Option<DVec3> {
    let size = v.abs().max_element();
    // Scaled first: the square of a very long or very short vector is no number.
    (size > 0.0 && size.is_finite()).then(|| (v / size).normalize())
}

/// A camera made ready for a picture of one size.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    eye: DVec3,
    /// From the eye to the upper left corner of the picture at distance 1.
    corner: DVec3,
    /// One pixel to the right.
    across: DVec3,
    /// One pixel downward.
    down: DVec3,
}

impl Pinhole {
    /// The eye; from it to the upper left corner of the picture, one pixel to the right, and one downward.
    pub(crate) fn parts(&self) -> [DVec3; 4] {
        [self.eye, self.corner, self.across, self.down]
    }

    /// The ray through the centre of the pixel in column `x` and row `y` (from the top). Its direction has not unit
    /// length.
    #[inline]
    pub fn ray(&self, x: u32, y: u32) -> Ray {
        let at = self.corner + self.across * (f64::from(x) + 0.5) + self.down * (f64::from(y) + 0.5);
        Ray::new(self.eye.to_array(), at.to_array())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    fn camera() -> Camera {
        Camera::look_at([1.0, 2.0, 3.0], [1.0, 12.0, 3.0], Z, 90.0).unwrap()
    }

    fn direction(camera: &Camera, x: u32, y: u32, width: u32, height: u32) -> DVec3 {
        let d = DVec3::from(camera.ray(x, y, width, height).direction);
        d / d.dot(camera.forward)
    }

    #[test]
    fn axes_of_a_view_to_the_north() {
        let camera = camera();
        assert_eq!(camera.forward(), [0.0, 1.0, 0.0]);
        assert_eq!(camera.right(), [1.0, 0.0, 0.0]);
        assert_eq!(camera.up(), Z);
    }

    #[test]
    fn corner_rays_and_field_of_view() {
        let camera = camera();
        // 90 degrees: the picture reaches from -1 to 1 in height, and twice that in width.
        let (width, height) = (200, 100);
        let near = |a: DVec3, b: [f64; 3]| assert!((a - DVec3::from(b)).length() < 1e-12, "{a} {b:?}");
        near(direction(&camera, 0, 0, width, height), [-1.99, 1.0, 0.99]);
        near(direction(&camera, width - 1, 0, width, height), [1.99, 1.0, 0.99]);
        near(direction(&camera, 0, height - 1, width, height), [-1.99, 1.0, -0.99]);
        near(direction(&camera, width - 1, height - 1, width, height), [1.99, 1.0, -0.99]);
        // The middle of an odd picture looks forward.
        near(direction(&camera, 50, 30, 101, 61), [0.0, 1.0, 0.0]);
        assert_eq!(camera.ray(0, 0, width, height).origin, camera.eye());
        let narrow = Camera::look_at([0.0; 3], [1.0, 0.0, 0.0], Z, 60.0).unwrap();
        let top = direction(&narrow, 0, 0, 1, 1000);
        assert!((top.z - (30f64).to_radians().tan() * 0.999).abs() < 1e-12);
    }

    #[test]
    fn up_parallel_to_the_view_is_replaced() {
        let down = Camera::look_at([0.0; 3], [0.0, 0.0, -1.0], Z, 50.0).unwrap();
        assert_eq!(down.up(), [0.0, 1.0, 0.0]);
        assert_eq!(down.right(), [1.0, 0.0, 0.0]);
        let level = Camera::look_at([0.0; 3], [0.0, 3.0, 0.0], [0.0, -1.0, 0.0], 50.0).unwrap();
        assert_eq!(level.up(), Z);
        let no_hint = Camera::look_at([0.0; 3], [0.0, 3.0, 0.0], [0.0; 3], 50.0).unwrap();
        assert_eq!(no_hint.up(), Z);
    }

    #[test]
    fn degenerate_cameras_are_errors() {
        let at = [1.0, 2.0, 3.0];
        assert_eq!(Camera::look_at(at, at, Z, 60.0), Err(CameraError::NoDirection));
        assert_eq!(Camera::look_at(at, [f64::NAN, 0.0, 0.0], Z, 60.0), Err(CameraError::NotFinite));
        assert_eq!(Camera::look_at(at, [0.0; 3], [f64::INFINITY; 3], 60.0), Err(CameraError::NotFinite));
        assert_eq!(Camera::look_at([f64::MAX; 3], [f64::MIN; 3], Z, 60.0), Err(CameraError::NotFinite));
        for vfov in [0.0, -5.0, 180.0, 400.0, f64::INFINITY] {
            assert_eq!(Camera::look_at(at, [0.0; 3], Z, vfov), Err(CameraError::FieldOfView(vfov)));
        }
        assert!(matches!(Camera::look_at(at, [0.0; 3], Z, f64::NAN), Err(CameraError::FieldOfView(_))));
        // Very short and very long views are fine.
        for far in [1e-200, 1e200] {
            assert_eq!(Camera::looking(at, [0.0, far, 0.0], Z, 60.0).unwrap().forward(), [0.0, 1.0, 0.0]);
        }
    }
}
