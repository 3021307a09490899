//! What lies around the prisms' zone: triangles that reach out of it, near ones together in boxes.

use glam::{DVec3, Vec3};

use crate::scene::Scene;
use crate::trace::Prisms;

/// Triangles of a box.
const TOGETHER: usize = 16;

/// Some triangles, and the box around them relative to the scene's center, rounded outward.
pub(crate) struct Group {
    pub(super) lo: Vec3,
    pub(super) hi: Vec3,
    pub(super) triangles: Vec<u32>,
}

/// The triangles that reach out of the zone of the prisms.
pub(crate) struct Outer(pub(crate) Vec<Group>);

impl Outer {
    /// Those of a scene, found by looking at all.
    pub(crate) fn new(scene: &Scene) -> Outer {
        let tables = &scene.tables;
        let prisms = Prisms::new(tables);
        let is_out = |vertex: &[f64; 3]| !prisms.hold(prisms.local(DVec3::from(*vertex)));
        let out: Vec<bool> = tables.vertices.iter().map(is_out).collect();
        let reaches_out =
            |&triangle: &u32| tables.triangles[triangle as usize].iter().any(|&vertex| out[vertex as usize]);
        let mut triangles: Vec<u32> = (0..scene.detail_triangle_count()).filter(reaches_out).collect();
        let [lo, hi] = scene.hull().map(DVec3::from);
        let place = |triangle: &u32| {
            let [a, b, c] = scene.triangle(*triangle).map(DVec3::from);
            interleaved(((a + b + c) / 3.0 - lo) / (hi - lo).max(DVec3::splat(f64::MIN_POSITIVE)))
        };
        triangles.sort_by_cached_key(|triangle| (place(triangle), *triangle));
        let center = DVec3::from(tables.scene[0].center);
        let group = |triangles: &[u32]| {
            let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for corner in triangles.iter().flat_map(|&triangle| scene.triangle(triangle)) {
                (least, most) = (least.min(DVec3::from(corner)), most.max(DVec3::from(corner)));
            }
            Group {
                lo: (least - center).as_vec3(),
                hi: (most - center).as_vec3(),
                triangles: triangles.to_vec(),
            }
        };
        Outer(triangles.chunks(TOGETHER).map(group).collect())
    }
}

/// The bits of three numbers from 0 to 1, in turns: what is near in space is mostly near in this order (Morton's).
fn interleaved(place: DVec3) -> u32 {
    let place = (place * 1023.0).clamp(DVec3::ZERO, DVec3::splat(1023.0));
    let [x, y, z] = place.to_array().map(|c| c as u32);
    (0..10).fold(0, |bits, bit| {
        let at = |c: u32, axis: u32| (c >> bit & 1) << (3 * bit + axis);
        bits | at(x, 0) | at(y, 1) | at(z, 2)
    })
}
