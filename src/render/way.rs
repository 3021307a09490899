//! A walk: cameras along a way from camera to camera.

use glam::DVec3;

use super::camera::Camera;

/// More frames than this are no walk.
const MOST: usize = 1 << 20;

/// The cameras of a walk past `points`, in order: the eye goes straight from each to the next by at most `step` metres a frame, and looks from where
/// the one looks to where the next does, turning by at most `turn` radians a frame. All points are among them; at most a million frames are.
pub fn walk(points: &[Camera], step: f64, turn: f64) -> Vec<Camera> {
    let mut frames: Vec<Camera> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let away = DVec3::from(a.eye()).distance(DVec3::from(b.eye()));
        let angle = DVec3::from(a.forward()).angle_between(DVec3::from(b.forward()));
        let count = (away / step).max(angle / turn).ceil();
        let left = MOST.saturating_sub(frames.len());
        // What is no number is one frame.
        let count = (if count >= 1.0 { count as usize } else { 1 }).min(left);
        frames.extend(
            (1..=count).map(|i| if i == count { b } else { between(&a, &b, i as f64 / count as f64) }),
        );
    }
    frames
}

/// The camera so far, of 1, on the way from one to another.
fn between(a: &Camera, b: &Camera, share: f64) -> Camera {
    let mix = |from: [f64; 3], to: [f64; 3]| DVec3::from(from).lerp(DVec3::from(to), share).to_array();
    let vfov = a.vfov_degrees() + (b.vfov_degrees() - a.vfov_degrees()) * share;
    let eye = mix(a.eye(), b.eye());
    // Half-way around there may be no direction: by the left then.
    let (from, to) = (DVec3::from(a.forward()), DVec3::from(b.forward()));
    let angle = from.angle_between(to);
    let axis = from.cross(to).try_normalize().unwrap_or(DVec3::from(a.up()));
    let forward = glam::DQuat::from_axis_angle(axis, angle * share) * from;
    Camera::looking(eye, forward.to_array(), mix(a.up(), b.up()), vfov).unwrap_or(*a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(eye: [f64; 3], way: [f64; 3]) -> Camera {
        Camera::looking(eye, way, [0.0, 0.0, 1.0], 60.0).unwrap()
    }

    #[test]
    fn steps_and_turns_are_small() {
        let points = [
            camera([0.0, 0.0, 1.6], [1.0, 0.0, 0.0]),
            camera([3.0, 0.0, 1.6], [1.0, 0.0, 0.0]),
            camera([3.0, 0.0, 1.6], [-1.0, 0.0, 0.0]),
            camera([3.0, 0.0, 1.6], [0.0, 1.0, 0.0]),
        ];
        let frames = walk(&points, 0.25, 0.1);
        assert!(points.iter().all(|point| frames.contains(point)));
        assert_eq!(frames.len(), 1 + 12 + 32 + 16);
        for pair in frames.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            assert!(DVec3::from(a.eye()).distance(DVec3::from(b.eye())) <= 0.25 + 1e-9);
            assert!(DVec3::from(a.forward()).angle_between(DVec3::from(b.forward())) <= 0.1 + 1e-6);
            assert!(b.forward()[2].abs() < 1e-9 && b.up()[2] > 0.999, "level");
        }
    }

    #[test]
    fn ways_of_no_length() {
        let point = camera([1.0, 2.0, 3.0], [0.0, 1.0, 0.0]);
        assert_eq!(walk(&[], 1.0, 1.0), []);
        assert_eq!(walk(&[point], 1.0, 1.0), [point]);
        assert_eq!(walk(&[point, point], 0.0, 0.0).len(), 2);
        let far = camera([1e9, 2.0, 3.0], [0.0, 1.0, 0.0]);
        assert_eq!(walk(&[point, far], 1e-3, 1.0).len(), MOST);
    }
}
