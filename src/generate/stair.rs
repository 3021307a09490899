//! Stairs of two flights side by side, with a landing between them.

use super::wing::Modules;

/// A stair in a room, modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StairPlan {
    /// The room.
    room: Modules,
    /// Whether one comes from the north.
    from_north: bool,
}

/// Depth of the floor in front of the flights, and of the landing between them, modules.
const FLOOR: i32 = 13;
const LANDING: i32 = 12;
/// A step's tread and rise, modules.
const TREAD: i32 = 3;
const RISE: i32 = 2;
/// Between the two flights, modules.
const EYE: i32 = 2;

impl StairPlan {
    /// A stair in a room that is entered from the north or from the south; `None` if there is no place for it.
    pub fn new(room: Modules, from_north: bool) -> Option<StairPlan> {
        let [west, south, east, north] = room;
        let fits = east - west >= 2 * 9 + EYE && north - south >= FLOOR + LANDING + 8 * TREAD;
        fits.then_some(StairPlan { room, from_north })
    }

    /// The rectangle from `near` to `far` modules from the end at which one comes in, of the west half or the east
    /// half or both.
    fn across(&self, [near, far]: [i32; 2], [west, east]: [i32; 2]) -> Modules {
        let [_, south, _, north] = self.room;
        if self.from_north {
            [west, north - far, east, north - near]
        } else {
            [west, south + near, east, south + far]
        }
    }

    /// What is open in the slab above.
    pub fn well(&self) -> Modules {
        let [west, south, east, north] = self.room;
        self.across([FLOOR, north - south], [west, east])
    }

    /// What the flights and the landing stand on.
    pub fn flights(&self) -> Modules {
        self.well()
    }

    /// The steps and the landing for a rise of `rise` modules: rectangles, and from where to where they reach in height.
    pub fn boxes(&self, rise: i32) -> Vec<(Modules, [i32; 2])> {
        let [west, south, east, north] = self.room;
        let depth = north - south;
        let width = (east - west - EYE) / 2;
        let steps = rise / (2 * RISE);
        let landing = FLOOR + TREAD * (steps - 1).min((depth - FLOOR - LANDING) / TREAD);
        let mut boxes = vec![(self.across([landing, depth], [west, east]), [rise / 2 - 2 * RISE, rise / 2])];
        for i in 1..steps {
            let top = i * RISE;
            let near = FLOOR + (i - 1) * TREAD;
            boxes.push((
                self.across([near, near + TREAD], [west, west + width]),
                [(top - 2 * RISE).max(0), top],
            ));
            // Down from the floor above, on the other side.
            let top = rise - i * RISE;
            boxes.push((self.across([near, near + TREAD], [east - width, east]), [top - 2 * RISE, top]));
        }
        boxes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_rise_evenly_and_stay_in_the_well() {
        let stair = StairPlan::new([0, 0, 26, 52], true).unwrap();
        let boxes = stair.boxes(32);
        let mut tops: Vec<i32> = boxes.iter().map(|(_, z)| z[1]).collect();
        tops.sort_unstable();
        // Fifteen steps between two floors.
        assert_eq!(tops, (1..16).map(|i| 2 * i).collect::<Vec<_>>());
        let well = stair.well();
        for (rect, z) in &boxes {
            assert!(
                rect[0] >= well[0] && rect[2] <= well[2] && rect[1] >= well[1] && rect[3] <= well[3],
                "{rect:?}"
            );
            assert!(z[0] >= 0 && z[0] < z[1]);
        }
        assert_eq!(StairPlan::new([0, 0, 15, 52], true), None);
    }
}
