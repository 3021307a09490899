//! What is measured: ways to answer rays.

use std::ops::AddAssign;

use crate::render::Camera;
use crate::trace::{Hit, Ray};

/// By what the pixels of pictures were answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answered {
    /// Pixels by exact beams.
    pub beams: u64,
    /// Pixels by packets.
    pub packets: u64,
    /// Pixels by a ray each: also those that beams and packets left to rays.
    pub rays: u64,
}

impl AddAssign for Answered {
    fn add_assign(&mut self, other: Answered) {
        self.beams += other.beams;
        self.packets += other.packets;
        self.rays += other.rays;
    }
}

/// A way to answer rays that start in the air: enfilade's own, or another library's.
pub trait Way: Sync {
    /// Its name.
    fn name(&self) -> &str;

    /// What each ray meets first: at least distance and element; [`Hit::ESCAPED`] for nothing. `hits` is as long as `rays`.
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]);

    /// The same of rays each of which starts on what one of `from` met; by default as all others.
    fn trace_onward(&self, from: &[Hit], rays: &[Ray], hits: &mut [Hit]) {
        let _ = from;
        self.trace(rays, hits);
    }

    /// The normal of what was met, of unit length, on either side; `None` if the way does not tell. Not a part of what is timed.
    fn normal(&self, hit: &Hit) -> Option<[f64; 3]> {
        (hit.normal != [0.0; 3]).then_some(hit.normal)
    }

    /// Makes the picture of a camera, so many pixels wide and high, as a whole; `None` if the way answers rays, which that of this picture may be. Returns what
    /// answered its pixels.
    fn picture(&self, camera: &Camera, size: (u32, u32)) -> Option<Answered> {
        let _ = (camera, size);
        None
    }

    /// What the rays of such a picture, `width` pixels wide, meet by what it shows, colours or hits. Not a part of what is timed.
    fn shown(&self, camera: &Camera, width: u32, hits: &mut [Hit]) {
        let _ = (camera, width, hits);
    }

    /// Whether it shares rays among threads by itself.
    fn is_batch(&self) -> bool {
        false
    }
}
