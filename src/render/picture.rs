//! A picture, with what each of its rays met.

use super::color::ColorMode;
use crate::beam::BeamCounts;
use crate::trace::{Hit, NONE};

/// What one ray met, and the colour made of it. Lengths are metres, axes internal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Radiance, linear RGB.
    pub color: [f32; 3],
    /// Distance along the ray (not along the axis of the camera): infinite where it escaped, NaN where it starts in
    /// a solid.
    pub depth: f32,
    /// The normal of the triangle on the side of the eye, unit length; zeros where there is none.
    pub normal: [f32; 3],
    /// Index of the element, or [`NONE`].
    pub element: u32,
    /// Number of the element's semantic, in pictures of [`ColorMode::Face`](super::ColorMode::Face) of the kind of the face where one
    /// was met; [`NONE`] where there is no element.
    pub semantic: u32,
    /// Index of the material, or [`NONE`].
    pub material: u32,
    /// Index of the room in which the ray ended, or [`NONE`].
    pub room: u32,
    /// Index of the cell in which the ray ended, or [`NONE`].
    pub cell: u32,
    /// Index of the triangle, or [`NONE`].
    pub triangle: u32,
    /// Steps that the tracer took: only counted in pictures of [`ColorMode::Cost`]; in those of [`ColorMode::Packet`] the edge of the packet, pixels; else 0.
    pub cost: u32,
}

impl Pixel {
    /// A pixel without colour.
    pub(super) fn new(hit: &Hit) -> Pixel {
        Pixel {
            color: [0.0; 3],
            depth: hit.t as f32,
            normal: hit.normal.map(|c| c as f32),
            element: hit.element,
            semantic: if hit.element == NONE { NONE } else { hit.semantic },
            material: hit.material,
            room: hit.room,
            cell: hit.cell,
            triangle: hit.triangle,
            cost: 0,
        }
    }

    /// Whether the ray left the hull.
    pub fn has_escaped(&self) -> bool {
        self.element == NONE
    }

    /// Whether the ray starts in a solid.
    pub fn is_in_solid(&self) -> bool {
        self.depth.is_nan()
    }
}

/// A picture: rows from the top, pixels from the left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) mode: ColorMode,
    pub(super) scale: Option<[f64; 2]>,
    pub(super) in_solid: Option<u32>,
    pub(super) beams: Option<BeamCounts>,
    pub(super) pixels: Vec<Pixel>,
}

impl Picture {
    /// What it took beams to tell what the pixels show, of which [`BeamCounts::unsure`] were left to rays; `None` where each pixel's ray was traced.
    pub fn beams(&self) -> Option<BeamCounts> {
        self.beams
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// What the colours show.
    pub fn mode(&self) -> ColorMode {
        self.mode
    }

    /// What the two ends of the [`ramp`](super::ramp) stand for: in a picture of depth the far end (dark) and the
    /// near one (light), metres; in one of cost the least and the most steps, of packets the smallest and the largest edge. `None` in others, and where nothing was
    /// met.
    pub fn scale(&self) -> Option<[f64; 2]> {
        self.scale
    }

    /// The solid element that holds the eye, if it does and no ray leaves it within the tolerance: then there is
    /// nothing to be seen.
    pub fn in_solid(&self) -> Option<u32> {
        self.in_solid
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[Pixel] {
        &self.pixels
    }

    /// The pixel in column `x` and row `y` (from the top).
    ///
    /// # Panics
    /// If it lies outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> &Pixel {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of {} x {}", self.width, self.height);
        &self.pixels[y as usize * self.width as usize + x as usize]
    }
}
