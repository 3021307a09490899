//! How far a picture is off that shades what was met by a light at the camera.

use glam::DVec3;
use serde::Serialize;

use crate::render::to_srgb;
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
    /// How far apart the pictures look, by [`ErrorOptions::flip`](super::ErrorOptions::flip), the mean of the frames.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip: Option<f64>,
}

/// How far apart two pictures of so many columns and rows look, 0 to 1: the one that was told, and the exact one, a byte each of red, green and blue a
/// pixel, in sRGB.
pub type Compare = fn(size: (u32, u32), told: &[u8], exact: &[u8]) -> f64;

/// The shades of a picture's pixels, as they were told, and exactly.
#[derive(Clone, Default)]
pub(super) struct Shades([Vec<u8>; 2]);

impl Shades {
    /// Adds a pixel; one of which nothing is told is as it should be.
    pub(super) fn add(&mut self, shades: Option<[f64; 2]>) {
        for (picture, shade) in self.0.iter_mut().zip(shades.unwrap_or_default()) {
            picture.extend([(to_srgb(shade as f32) * 255.0).round() as u8; 3]);
        }
    }

    /// Adds the pixels that come next.
    pub(super) fn append(&mut self, next: Shades) {
        self.0.iter_mut().zip(next.0).for_each(|(picture, next)| picture.extend(next));
    }

    /// How far apart they look.
    pub(super) fn compared(&self, size: (u32, u32), compare: Compare) -> f64 {
        let [told, exact] = &self.0;
        compare(size, told, exact)
    }
}

/// Errors of pixels being summed.
#[derive(Clone, Copy, Default)]
pub(super) struct Sum {
    count: u64,
    squares: f64,
    relative: f64,
    visible: u64,
    flip: Option<(f64, u32)>,
}

impl Sum {
    /// Adds how far apart a frame and the exact one look.
    pub(super) fn add_compared(&mut self, compared: f64) {
        let (sum, frames) = self.flip.unwrap_or_default();
        self.flip = Some((sum + compared, frames + 1));
    }

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
            flip: self.flip.map(|(sum, frames)| sum / f64::from(frames)),
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
