//! Views that show a scene well, found without being told anything.

use std::f64::consts::TAU;

use enfilade_importers::Semantic;
use glam::DVec3;

use super::camera::Camera;
use super::stand::{Stand, places};
use crate::scene::{RoomView, Scene};
use crate::trace::{NONE, Ray, Start, Want};

/// The vertical field of view of pictures of rooms, degrees.
const INSIDE_FOV: f64 = 70.0;

/// The vertical field of view of pictures of whole buildings, degrees.
const OUTSIDE_FOV: f64 = 40.0;

/// Nothing may be nearer to the eyes than this where there is a choice, metres.
const CLEAR: f64 = 0.3;

/// A level view, from 1.6 m above the floor, of the largest room: by volume, or if no room has one, by its bounds.
/// Of the places in it where one can stand and the directions in which one can look, the one that shows most of the
/// room: far views, of the room itself, with many things in them. Roof terraces and courts, which are open to the
/// sky, count only if all rooms are, and rooms in which nobody can stand do not count. [`outside_view`] if there are
/// no rooms.
///
/// The same scene gives the same view.
pub fn auto_view(scene: &Scene) -> Camera {
    let mut rooms: Vec<(f64, u32)> =
        scene.rooms().zip(0..).map(|(room, index)| (size(&room), index)).collect();
    rooms.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut open_air = None;
    for (_, room) in rooms {
        let stands = clear_places(scene, room);
        if stands.is_empty() {
            continue;
        }
        if stands.iter().filter(|s| s.is_covered).count() * 2 >= stands.len() {
            return best_view(scene, room, &stands);
        }
        open_air = open_air.or(Some((room, stands)));
    }
    open_air.map_or_else(|| outside_view(scene), |(room, stands)| best_view(scene, room, &stands))
}

/// Sorts rooms by size: those with a volume first.
fn size(room: &RoomView<'_>) -> f64 {
    let [lo, hi] = room.bounds();
    let bounds: f64 = (0..3).map(|i| hi[i] - lo[i]).product();
    // A room without a volume counts less than any with one, but among its like by its bounds.
    room.volume().unwrap_or(-1.0 / bounds.max(f64::MIN_POSITIVE))
}

/// The places of a room that are clear of everything, or if there are none the clearest.
fn clear_places(scene: &Scene, room: u32) -> Vec<Stand> {
    let mut stands = places(scene, room);
    let clearest = stands.iter().map(|s| s.clearance).fold(0.0, f64::max);
    stands.retain(|s| s.clearance >= clearest.min(CLEAR));
    stands
}

/// The best view from some place of a room.
fn best_view(scene: &Scene, room: u32, stands: &[Stand]) -> Camera {
    let [lo, hi] = scene.room(room).bounds().map(DVec3::from);
    let half_far = (0.25 * (hi - lo).truncate().length()).clamp(1.5, 8.0);
    let mut best = (f64::NEG_INFINITY, Camera::level(DVec3::ZERO, 0.0, INSIDE_FOV));
    for stand in stands {
        let panorama = Panorama::new(scene, stand, room);
        for direction in 0..Panorama::DIRECTIONS {
            let score = panorama.score(direction, half_far);
            if score > best.0 {
                let azimuth = Panorama::azimuth(direction * Panorama::STRIDE);
                best = (score, Camera::level(stand.eye, azimuth, INSIDE_FOV));
            }
        }
    }
    best.1
}

/// What one sees from a place, all around.
struct Panorama {
    /// Column by column: distance (at most [`Panorama::FAR`]), whether it is in the room, element.
    samples: Vec<(f64, bool, u32)>,
}

impl Panorama {
    const COLUMNS: usize = 64;
    const ROWS: usize = 9;
    /// Directions to look in, and the columns from one to the next.
    const DIRECTIONS: usize = 16;
    const STRIDE: usize = Panorama::COLUMNS / Panorama::DIRECTIONS;
    /// Columns to each side of a direction that are in the picture: 34 degrees.
    const HALF: usize = 6;
    /// Farther is no better, metres.
    const FAR: f64 = 40.0;

    fn azimuth(column: usize) -> f64 {
        column as f64 / Panorama::COLUMNS as f64 * TAU
    }

    fn new(scene: &Scene, stand: &Stand, room: u32) -> Panorama {
        let mut samples = Vec::with_capacity(Panorama::COLUMNS * Panorama::ROWS);
        let top = (INSIDE_FOV / 2.0).to_radians().tan();
        for column in 0..Panorama::COLUMNS {
            let (sin, cos) = Panorama::azimuth(column).sin_cos();
            for row in 0..Panorama::ROWS {
                let z = top * ((row as f64 + 0.5) / Panorama::ROWS as f64 * 2.0 - 1.0);
                let ray = Ray::new(stand.eye.to_array(), [cos, sin, z]);
                let hit = scene.trace_from(Start::Cell(stand.cell), &ray, Want::default());
                samples.push((hit.t.min(Panorama::FAR), hit.room == room, hit.element));
            }
        }
        Panorama { samples }
    }

    /// How much of the room one sees in a direction; more is better. At the distance `half_far` (metres) a sight is
    /// worth half of what one at infinity is.
    fn score(&self, direction: usize, half_far: f64) -> f64 {
        /// Nearer things stand in the way, metres.
        const NEAR: f64 = 0.8;
        /// With this many things in it a view is about two thirds as varied as can be.
        const MANY: f64 = 10.0;
        let middle = direction * Panorama::STRIDE + Panorama::COLUMNS;
        let columns = (middle - Panorama::HALF..=middle + Panorama::HALF).map(|c| c % Panorama::COLUMNS);
        let (mut count, mut far, mut near, mut same) = (0.0, 0.0, 0.0, 0.0);
        let mut elements = Vec::new();
        for column in columns {
            for &(t, is_same, element) in &self.samples[column * Panorama::ROWS..][..Panorama::ROWS] {
                count += 1.0;
                // The sky is no sight: it counts as if in the middle.
                far += if element == NONE { 0.5 } else { t / (t + half_far) };
                near += f64::from(u8::from(t < NEAR));
                same += f64::from(u8::from(is_same));
                elements.push(element);
            }
        }
        elements.sort_unstable();
        elements.dedup();
        let variety = 1.0 - (-(elements.len() as f64) / MANY).exp();
        (2.0 * far + same - 2.0 * near) / count + variety
    }
}

/// Level views from 1.6 m above the floor near the middle of each room, `per_room` of them all around, the first
/// along the diagonal of the room's bounds. Rooms in which
/// nobody can stand are left out. The same scene gives the same views.
pub fn room_views(scene: &Scene, per_room: u32) -> Vec<Camera> {
    let mut views = Vec::new();
    for (room, index) in scene.rooms().zip(0..) {
        let [lo, hi] = room.bounds().map(DVec3::from);
        let middle = lo + (hi - lo) / 2.0;
        let away = |stand: &Stand| (stand.eye - middle).truncate().length();
        let nearest =
            clear_places(scene, index).into_iter().reduce(|a, b| if away(&b) < away(&a) { b } else { a });
        if let Some(stand) = nearest {
            // Into a corner first: off the axes, along which walls run.
            let corner = (hi.y - lo.y).atan2(hi.x - lo.x);
            let azimuth = |i: u32| corner + f64::from(i) / f64::from(per_room) * TAU;
            views.extend((0..per_room).map(|i| Camera::level(stand.eye, azimuth(i), INSIDE_FOV)));
        }
    }
    views
}

/// A view of the whole from outside: from the front, the side and above, as near as it fits into a square picture.
/// Terrain does not count unless there is nothing else.
pub fn outside_view(scene: &Scene) -> Camera {
    /// Where the eye is, seen from the middle: to the south, a little less to the east, and above.
    const TOWARD: DVec3 = DVec3::new(0.75, -1.0, 0.65);
    /// Air around the building, as share of the picture.
    const AIR: f64 = 0.04;
    let (up, toward) = ([0.0, 0.0, 1.0], -TOWARD);
    let [lo, hi] = scene.hull().map(DVec3::from);
    let middle = lo + (hi - lo) / 2.0;
    // Only a hull whose numbers overflow makes no camera; nothing can be seen of it.
    let Ok(camera) = Camera::looking(middle.to_array(), toward.to_array(), up, OUTSIDE_FOV) else {
        return Camera::level(DVec3::ZERO, 0.0, OUTSIDE_FOV);
    };
    let [forward, right, above] = [camera.forward(), camera.right(), camera.up()].map(DVec3::from);
    let half = (OUTSIDE_FOV / 2.0).to_radians().tan() * (1.0 - AIR);

    // Seen from `middle` less `back` along the view, a point is in the picture if its offsets to the right and above
    // are at most half (its distance along the view + back). So the points that reach farthest out at each side of
    // the picture give the narrowest wedge around all; the eye is where both wedges, across and upward, hold them.
    let mut reach = [[f64::NEG_INFINITY; 2]; 2];
    for_each_corner(scene, |corner| {
        let from = corner - middle;
        let along = half * from.dot(forward);
        for (reach, side) in reach.iter_mut().zip([from.dot(right), from.dot(above)]) {
            reach[0] = reach[0].max(side - along);
            reach[1] = reach[1].max(-side - along);
        }
    });
    let shift = reach.map(|[more, less]| (more - less) / 2.0);
    let back = reach.map(|[more, less]| (more + less) / (2.0 * half));
    let eye = middle + right * shift[0] + above * shift[1] - forward * back[0].max(back[1]);
    Camera::looking(eye.to_array(), toward.to_array(), up, OUTSIDE_FOV).unwrap_or(camera)
}

/// Calls `each` with the corners of all triangles but those of terrain; of all if there are no others; with those of
/// the hull if there are none.
fn for_each_corner(scene: &Scene, mut each: impl FnMut(DVec3)) {
    let is_site: Vec<bool> = scene.elements().map(|e| e.semantic() == Semantic::Site).collect();
    let detail = 0..scene.detail_triangle_count();
    let is_of_site = |triangle: u32| is_site[scene.tables.record(triangle).element as usize];
    let is_all_site = detail.clone().all(is_of_site);
    for triangle in detail.clone().filter(|&triangle| is_all_site || !is_of_site(triangle)) {
        scene.triangle(triangle).into_iter().for_each(|corner| each(DVec3::from(corner)));
    }
    if detail.is_empty() {
        let hull = scene.hull();
        (0..8).for_each(|i| each(DVec3::from([0, 1, 2].map(|axis| hull[i >> axis & 1][axis]))));
    }
}
