//! Which way to make a picture, by what the scene, its eye and its size are.

use super::Camera;
use crate::beam::sees_by_rays;
use crate::scene::Scene;
use crate::trace::Place;

/// Ways to make a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureWay {
    /// Exact beams ([`Beams`](crate::beam::Beams)), and rays where they do not tell.
    Beams,
    /// A ray for each pixel.
    Rays,
}

/// A picture with fewer pixels is made sooner by rays than its beams are split.
const FEW: u64 = 256;

/// Of so many triangles a pixel, or more, rays meet the first sooner than all are drawn, or even looked at.
const CROWD: u64 = 4;

impl PictureWay {
    /// The one that takes the least time for the picture that `camera` takes of `scene`, so many pixels wide and high, if what
    /// the way needs to know of the scene is kept for many pictures, or found for this one.
    ///
    /// Beams need cells that are finer than the tolerance, and an eye in the air that touches no surface: from within a solid each ray must see for itself
    /// whether it leaves it within the tolerance. A picture of a few pixels takes rays less than the lines of the cells take beams, and so does one of
    /// fewer pixels than the triangles that are looked at: all of them where nothing is kept, or where the eye is outside, in no cell of a room. Packets
    /// ([`Packets`](crate::packets::Packets)) are never chosen: beams took less time, or at most a tenth more, in each scene that was measured.
    pub fn of(scene: &Scene, camera: &Camera, (width, height): (u32, u32), is_kept: bool) -> PictureWay {
        if sees_by_rays(scene, camera) {
            return PictureWay::Rays;
        }
        let is_outside = match scene.locate(camera.eye()) {
            Place::InSolid(_) => return PictureWay::Rays,
            Place::Air { room, .. } => room.is_none(),
            Place::Outside => true,
        };
        let pixels = u64::from(width) * u64::from(height);
        let triangles = u64::from(scene.detail_triangle_count());
        let is_crowded = (is_outside || !is_kept) && pixels.saturating_mul(CROWD) < triangles;
        if pixels < FEW || is_crowded { PictureWay::Rays } else { PictureWay::Beams }
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use super::*;
    use crate::render::{outside_view, room_views};
    use crate::samples::Sample;

    #[test]
    fn small_pictures_and_eyes_in_solids_take_rays() {
        let scene = Sample::House.scene();
        let inside = room_views(scene, 1)[0];
        let of =
            |camera: &Camera, size: u32, is_kept: bool| PictureWay::of(scene, camera, (size, size), is_kept);
        assert_eq!(of(&inside, 15, true), PictureWay::Rays);
        assert_eq!(of(&inside, 16, true), PictureWay::Beams);
        // All triangles are looked at once.
        let few = f64::from(scene.detail_triangle_count() / CROWD as u32).sqrt() as u32;
        assert!(few > 16);
        assert_eq!(of(&inside, few - 1, false), PictureWay::Rays);
        assert_eq!(of(&inside, few - 1, true), PictureWay::Beams);
        assert_eq!(of(&inside, few + 1, false), PictureWay::Beams);
        let outside = outside_view(scene);
        assert_eq!(of(&outside, few - 1, true), PictureWay::Rays);
        assert_eq!(of(&outside, few + 1, true), PictureWay::Beams);
        // In the middle of a wall.
        let [lo, hi] = scene.hull();
        let mut eye = inside.eye();
        let solid = (0..10_000).map(|i| lo[0] + (hi[0] - lo[0]) * f64::from(i) / 1e4).find(|&x| {
            eye[0] = x;
            matches!(scene.locate(eye), Place::InSolid(_))
        });
        eye[0] = solid.unwrap();
        let camera = Camera::look_at(eye, inside.eye(), [0.0, 0.0, 1.0], 60.0).unwrap();
        assert_eq!(of(&camera, 512, true), PictureWay::Rays);
    }
}
