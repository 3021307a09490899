//! From where pictures are taken.

use enfilade::Scene;
use enfilade::render::{Camera, CameraError, room_views};
use glam::DVec3;

/// Two level views from the middle of each room; where these are more than `most`, as many of them, evenly spread.
pub fn inside(scene: &Scene, most: usize) -> Vec<Camera> {
    let views = room_views(scene, 2);
    let count = views.len().min(most);
    (0..count).map(|i| views[i * views.len() / count]).collect()
}

/// Four views from around the hull, a little from above, towards its middle.
///
/// # Errors
/// If the hull has no extent.
pub fn outside(scene: &Scene) -> Result<Vec<Camera>, CameraError> {
    /// Off the axes, along which walls run.
    const ANGLES: [f64; 4] = [20.0, 110.0, 200.0, 290.0];
    /// Of the hull's half diagonal: how far away in the plan, and how far above the middle.
    const AWAY: f64 = 1.5;
    const ABOVE: f64 = 0.3;
    const VFOV: f64 = 60.0;
    let [lo, hi] = scene.hull().map(DVec3::from);
    let (middle, half) = (lo + (hi - lo) / 2.0, (hi - lo).length() / 2.0);
    let camera = |angle: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        let eye = middle + half * DVec3::new(AWAY * cos, AWAY * sin, ABOVE);
        Camera::look_at(eye.to_array(), middle.to_array(), [0.0, 0.0, 1.0], VFOV)
    };
    ANGLES.into_iter().map(camera).collect()
}
