//! How far a picture is off that shades what was met by a light at the camera.

use glam::DVec3;
use serde::Serialize;

use crate::trace::Ray;

/// The shade of nothing.
pub(super) const NOTHING: f64 = 0.0;

/// What is added to squares that are divided by, so that dark pixels do not count for all.
const DARK: f64 = 0.01;

/// How far a picture is off. Shades are between 0 and 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ImageError {
    /// Pixels that were compared.
    pub pixels: u64,
    /// The root of the mean square error.
    pub rmse: f64,
    /// The mean of squared errors, each divided by the square of the exact shade and a hundredth.
    pub relative_mse: f64,
    /// Pixels that are off by more than one of 255 steps.
    pub visible: u64,
}

/// Errors of pixels being summed.
#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    count: u64,
    squares: f64,
    relative: f64,
    visible: u64,
}

impl Sum {
    pub(super) fn add(&mut self, told: f64, exact: f64) {
        let square = (told - exact) * (told - exact);
        self.count += 1;
        self.squares += square;
        self.relative += square / (exact * exact + DARK);
        self.visible += u64::from((told - exact).abs() > 1.0 / 255.0);
    }

    pub(super) fn error(&self) -> ImageError {
        let count = self.count.max(1) as f64;
        ImageError {
            pixels: self.count,
            rmse: (self.squares / count).sqrt(),
            relative_mse: self.relative / count,
            visible: self.visible,
        }
    }
}

/// The shade of an element's surface with this unit normal: the part of the light that it throws back, of its own, times the cosine.
pub(in crate::bench) fn shade(element: u32, normal: DVec3, ray: &Ray) -> f64 {
    let direction = DVec3::from(ray.direction);
    let cosine = (normal.dot(direction) / direction.length()).abs();
    // Neighbours in the order of the model differ.
    let reflectance = 0.3 + 0.6 * f64::from(element.wrapping_mul(0x9E37_79B9) >> 8) / f64::from(1u32 << 24);
    reflectance * cosine
}
