//! Places in a room where a person could stand and look around.

use enfilade_importers::Semantic;
use glam::DVec3;

use crate::scene::{RoomView, Scene};
use crate::trace::{Hit, Place, Ray, Start, Want};

/// Height of the eyes over the floor, metres.
const EYES: f64 = 1.6;

/// In low rooms the eyes are at this share of the height.
const LOW_EYES: f64 = 0.6;

/// Rooms lower than this are no rooms to stand in (or to crouch), metres.
const LOWEST: f64 = 0.5;

/// How far to look around for things that are near, metres.
const AROUND: f64 = 1.0;

/// Things that lie this far above the floor of a room are not its floor, metres.
const STEP: f64 = 0.3;

/// Places are looked for on a grid of this many columns and rows.
const GRID: u32 = 9;

/// A place to stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    /// Where the eyes are.
    pub(super) eye: DVec3,
    /// The cell whose air that is.
    pub(super) cell: u32,
    /// Distance to the nearest thing that was found around the eyes, metres, at most [`AROUND`].
    pub(super) clearance: f64,
    /// Whether something lies overhead, however high.
    pub(super) is_covered: bool,
}

/// All places of a grid over the room number `index` where one can stand, row by row.
pub(super) fn places(scene: &Scene, index: u32) -> Vec<Stand> {
    let room = scene.room(index);
    let [lo, hi] = room.bounds();
    let at = |axis: usize, i: u32| lo[axis] + (hi[axis] - lo[axis]) * (f64::from(i) + 0.5) / f64::from(GRID);
    let grid = (0..GRID).flat_map(|y| (0..GRID).map(move |x| (x, y)));
    let column = Column { scene, room, index };
    grid.filter_map(|(x, y)| column.stand(at(0, x), at(1, y))).collect()
}

struct Column<'a> {
    scene: &'a Scene,
    room: RoomView<'a>,
    index: u32,
}

impl Column<'_> {
    /// The cell of a point in the air of the room. What is in a room whose label is not closed nobody can tell: there
    /// any air within its bounds counts.
    fn air(&self, point: DVec3) -> Option<u32> {
        match self.scene.locate(point.to_array()) {
            Place::Air { cell, room, .. } if room == Some(self.index) || !self.room.is_closed() => Some(cell),
            _ => None,
        }
    }

    fn stand(&self, x: f64, y: f64) -> Option<Stand> {
        /// Where along the height of the room to look for its air: in rooms over several storeys or under a roof not
        /// every height will do.
        const SHARES: [f64; 4] = [0.2, 0.5, 0.35, 0.75];
        let [lo, hi] = self.room.bounds();
        let height = hi[2] - lo[2];
        let low = lo[2] + height.min(EYES) * 0.6;
        let tries = std::iter::once(low).chain(SHARES.map(|share| lo[2] + share * height));
        let (probe, cell) =
            tries.map(|z| DVec3::new(x, y, z)).find_map(|p| self.air(p).map(|cell| (p, cell)))?;

        let floor = self.floor(probe, cell)?;
        let up = self.look(probe, cell, DVec3::Z, f64::INFINITY);
        let ceiling = (probe.z + up.t).min(hi[2]);
        let headroom = ceiling - floor;
        if headroom < LOWEST {
            return None;
        }
        let eye = DVec3::new(x, y, floor + EYES.min(headroom * LOW_EYES));
        let cell = self.air(eye)?;
        let clearance = self.clearance(eye, cell);
        Some(Stand { eye, cell, clearance, is_covered: up.t.is_finite() })
    }

    /// The height of the floor under a point in the air of the room: of what lies there, or of the room's own bottom
    /// where nothing does. `None` on top of furniture and the like.
    fn floor(&self, probe: DVec3, cell: u32) -> Option<f64> {
        let bottom = self.bottom(probe);
        let hit = self.look(probe, cell, -DVec3::Z, f64::INFINITY);
        let met = probe.z - hit.t;
        let is_floor = !matches!(
            Semantic::from_number(hit.semantic).unwrap_or_default(),
            Semantic::Furniture
                | Semantic::Equipment
                | Semantic::Railing
                | Semantic::DoorLeaf
                | Semantic::WindowFrame
                | Semantic::Wall
                | Semantic::Beam
                | Semantic::Other
        );
        if met <= bottom { Some(bottom) } else { (is_floor || met <= bottom + STEP).then_some(met) }
    }

    /// The lowest height of the room under a point in it.
    fn bottom(&self, probe: DVec3) -> f64 {
        const HALVINGS: u32 = 16;
        let lowest = self.room.bounds()[0][2];
        if !self.room.is_closed() {
            return lowest;
        }
        let is_in = |z: f64| self.scene.room_at([probe.x, probe.y, z]) == Some(self.index);
        let (mut outside, mut inside) = (lowest, probe.z);
        for _ in 0..HALVINGS {
            let middle = outside + (inside - outside) / 2.0;
            if is_in(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    }

    fn clearance(&self, eye: DVec3, cell: u32) -> f64 {
        const DIRECTIONS: u32 = 12;
        let level = (0..DIRECTIONS).map(|i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            DVec3::new(cos, sin, 0.0)
        });
        level
            .chain([DVec3::Z, -DVec3::Z])
            .map(|direction| self.look(eye, cell, direction, AROUND).t)
            .fold(AROUND, f64::min)
    }

    fn look(&self, from: DVec3, cell: u32, direction: DVec3, tmax: f64) -> Hit {
        let ray = Ray::segment(from.to_array(), direction.to_array(), 0.0, tmax);
        self.scene.trace_from(Start::Cell(cell), &ray, Want::LEAST)
    }
}
