//! Cameras: the whole building from outside, and a room from one of its corners.

use super::complex::{AROUND, MODULE, PARAPET, Roof, STOREY};
use super::draft::Draft;
use super::drawing::Drawing;
use super::lattice::{Rect, metres};
use super::uses::Use;

/// From the front, a little less from the left, and from above, as a person on a hill would see a building.
const TOWARD: [f64; 3] = [-0.75, -1.0, 0.4];

/// The vertical field of view from outside, degrees.
const OUTSIDE: f64 = 40.0;

/// The vertical field of view in a room, degrees.
const INSIDE: f64 = 68.0;

/// How high the eyes are over the floor, metres.
const EYES: f64 = 1.6;

/// How far from both walls of a corner the eyes are, metres.
const FROM_CORNER: f64 = 0.55;

/// A camera that sees all of a box (metres), as near as it fits into a square picture.
pub(super) fn outside(draft: &mut Draft, name: &str, [lo, hi]: [[f64; 3]; 2]) {
    /// Air around the building, as share of the picture.
    const AIR: f64 = 0.06;
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let middle = [0, 1, 2].map(|i| (lo[i] + hi[i]) / 2.0);
    let size = dot(TOWARD, TOWARD).sqrt();
    let back = TOWARD.map(|c| c / size);
    // Level, and square to the way back.
    let flat = (back[0] * back[0] + back[1] * back[1]).sqrt();
    let right = [-back[1] / flat, back[0] / flat, 0.0];
    let up = [-back[0] * back[2] / flat, -back[1] * back[2] / flat, flat];
    let half = libm::tan((OUTSIDE / 2.0).to_radians()) * (1.0 - AIR);
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] });
    let needed = (0..8).map(|i| {
        let from = [0, 1, 2].map(|axis| corner(i)[axis] - middle[axis]);
        dot(from, right).abs().max(dot(from, up).abs()) / half + dot(from, back)
    });
    let distance = needed.fold(0.0, f64::max);
    let eye = [0, 1, 2].map(|i| middle[i] + back[i] * distance);
    draft.camera(name, eye, middle, OUTSIDE);
}

impl Drawing<'_> {
    /// The largest room of the first wing's ground floor, its corridor, and the whole from outside.
    pub(super) fn cameras(&mut self) {
        let Some(first) = self.complex.wings.first() else { return };
        let Some(wing) = first.storeys.first() else { return };
        let storey = wing.storey();
        let module = first.module();
        let rooms = storey.rooms.iter().filter(|room| !matches!(room.use_, Use::Corridor | Use::Stair));
        let rect = |room: &super::wing::RoomPlan| {
            let [west, south, east, north] = room.rects[0].map(|c| c * module);
            Rect { lo: [west, south], hi: [east, north] }
        };
        let area = |r: &Rect| i64::from(r.hi[0] - r.lo[0]) * i64::from(r.hi[1] - r.lo[1]);
        // The first of equals.
        let largest = rooms.map(rect).reduce(|best, r| if area(&r) > area(&best) { r } else { best });
        let place = |[x, y]: [i32; 2]| first.place([x, y]).map(metres);
        if let Some(rect) = largest {
            let [lo, hi] = [place(rect.lo), place(rect.hi)];
            let corners = [[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]];
            let middle = [0, 1].map(|axis| (lo[axis] + hi[axis]) / 2.0);
            let eyes = corners.map(|corner| {
                [0, 1].map(|axis| corner[axis] + FROM_CORNER * (middle[axis] - corner[axis]).signum())
            });
            let mut best = (f64::NEG_INFINITY, 0);
            for (i, &eye) in eyes.iter().enumerate() {
                let clear = self.draft.clearance([eye[0], eye[1], EYES]);
                best = if clear > best.0 { (clear, i) } else { best };
            }
            let ([x, y], [to_x, to_y]) = (eyes[best.1], eyes[(best.1 + 2) % 4]);
            self.draft.camera("Room", [x, y, EYES], [to_x, to_y, EYES - 0.5], INSIDE);
        }
        let [south, north] = wing.corridor_rows();
        let ([length, _], middle) = (first.size(), (south + north) * MODULE / 2);
        let at = |x: i32, z: f64| {
            let [x, y] = place([x, middle]);
            [x, y, z]
        };
        self.draft.camera("Corridor", at(8 * MODULE, EYES), at(length / 2, EYES - 0.2), INSIDE);

        let edge = AROUND * MODULE;
        let gable =
            self.complex.wings.iter().filter(|w| w.roof == Roof::Gable).map(|w| w.size()[1] / 4).max();
        let storeys = self.complex.wings.iter().map(|w| w.storeys.len()).max().unwrap_or(1) as i32;
        let top = (storeys * STOREY + PARAPET) * MODULE + gable.unwrap_or(0);
        let (lo, hi) = (self.hull.lo, self.hull.hi);
        let whole = [[lo[0] + edge, lo[1] + edge, 0], [hi[0] - edge, hi[1] - edge, top]];
        outside(&mut self.draft, "Outside", whole.map(|corner| corner.map(metres)));
    }
}
