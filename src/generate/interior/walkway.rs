//! Whether a person still gets from every door to every other, and to each thing that is used.
//!
//! The floor is sampled at the middles of square cells. A middle is open if a square as wide as the walkway fits
//! around it. Open middles side by side are one step apart, and the squares of both lie in the floor.

use super::Rect;
use super::region::Region;

/// At most about as many cells; in larger rooms they are wider.
const CELLS: i64 = 1 << 15;

/// What a thing took of the floor.
#[derive(Debug)]
pub struct Taken {
    closed: Vec<usize>,
    /// How many places there were before.
    places: usize,
}

/// The floor that can be walked on.
#[derive(Clone, Debug)]
pub struct Walkway {
    lo: [i64; 2],
    pitch: i64,
    size: [usize; 2],
    /// Half the width of the walkway, units.
    half: i64,
    open: Vec<bool>,
    /// Doors that can be reached from each other in the empty room: cells of each.
    doors: Vec<Vec<Vec<usize>>>,
    /// What must stay within reach.
    places: Vec<Rect>,
}

impl Walkway {
    /// The empty room's. Doors are the floor in front of them.
    pub fn new(region: &Region, width: i32, doors: &[Rect]) -> Walkway {
        let bounds = region.bounds().unwrap_or(Rect { lo: [0; 2], hi: [0; 2] });
        let span = [0, 1].map(|axis| i64::from(bounds.hi[axis]) - i64::from(bounds.lo[axis]));
        let mut pitch = 128;
        while (span[0] / pitch + 1) * (span[1] / pitch + 1) > CELLS {
            pitch *= 2;
        }
        let size = span.map(|s| ((s + pitch - 1) / pitch) as usize);
        let half = i64::from(width) / 2;
        let mut walkway = Walkway {
            lo: bounds.lo.map(i64::from),
            pitch,
            size,
            half,
            open: Vec::new(),
            doors: Vec::new(),
            places: Vec::new(),
        };
        walkway.open = (0..size[0] * size[1])
            .map(|cell| {
                let [x, y] = walkway.middle(cell);
                region.holds(&Rect {
                    lo: [x - half, y - half].map(|c| c as i32),
                    hi: [x + half, y + half].map(|c| c as i32),
                })
            })
            .collect();
        let mut waiting: Vec<Vec<usize>> = doors.iter().map(|door| walkway.cells_in(door)).collect();
        waiting.iter_mut().for_each(|cells| cells.retain(|&cell| walkway.open[cell]));
        waiting.retain(|cells| !cells.is_empty());
        while let Some(first) = waiting.first() {
            let reached = walkway.reached(first);
            let (together, others) = waiting.into_iter().partition(|cells| cells.iter().any(|&c| reached[c]));
            walkway.doors.push(together);
            waiting = others;
        }
        walkway
    }

    fn middle(&self, cell: usize) -> [i64; 2] {
        let at = [cell % self.size[0], cell / self.size[0]];
        [0, 1].map(|axis| self.lo[axis] + at[axis] as i64 * self.pitch + self.pitch / 2)
    }

    /// The cells whose middles lie strictly inside a rectangle; at least one for each cell's width.
    fn cells_within(&self, lo: [i64; 2], hi: [i64; 2]) -> Vec<usize> {
        let [columns, rows] = [0, 1].map(|axis| {
            let index = |c: i64| c.clamp(0, self.size[axis] as i64) as usize;
            // The middle of cell i is at pitch * i + pitch / 2.
            let first = (lo[axis] - self.lo[axis] - self.pitch / 2).div_euclid(self.pitch) + 1;
            let last = (hi[axis] - self.lo[axis] - self.pitch / 2 - 1).div_euclid(self.pitch);
            index(first)..index(last + 1)
        });
        rows.flat_map(|row| columns.clone().map(move |column| row * self.size[0] + column)).collect()
    }

    /// The cells of a place: also those that it touches, where cells are wide.
    fn cells_in(&self, place: &Rect) -> Vec<usize> {
        let wider = if self.pitch > 128 { self.pitch / 2 } else { 0 };
        self.cells_within(place.lo.map(|c| i64::from(c) - wider), place.hi.map(|c| i64::from(c) + wider))
    }

    /// The open cells that can be reached from open cells.
    fn reached(&self, from: &[usize]) -> Vec<bool> {
        let [wide, high] = self.size;
        let mut reached = vec![false; self.open.len()];
        let mut waiting: Vec<usize> = from.to_vec();
        from.iter().for_each(|&cell| reached[cell] = true);
        while let Some(cell) = waiting.pop() {
            let (column, row) = (cell % wide, cell / wide);
            let beside = [
                (column > 0, cell.wrapping_sub(1)),
                (column + 1 < wide, cell + 1),
                (row > 0, cell.wrapping_sub(wide)),
                (row + 1 < high, cell + wide),
            ];
            for (exists, next) in beside {
                if exists && self.open[next] && !reached[next] {
                    reached[next] = true;
                    waiting.push(next);
                }
            }
        }
        reached
    }

    /// Puts things on the floor, each with the places from which they are used, if all doors and places stay within
    /// reach; else nothing changes.
    pub fn take(&mut self, things: &[Rect], places: &[Rect]) -> Option<Taken> {
        let mut taken = Taken { closed: Vec::new(), places: self.places.len() };
        for thing in things {
            let lo = thing.lo.map(|c| i64::from(c) - self.half);
            let hi = thing.hi.map(|c| i64::from(c) + self.half);
            for cell in self.cells_within(lo, hi) {
                if std::mem::replace(&mut self.open[cell], false) {
                    taken.closed.push(cell);
                }
            }
        }
        self.places.extend(places);
        if (taken.closed.is_empty() && places.is_empty()) || self.is_connected() {
            return Some(taken);
        }
        self.give_back(taken);
        None
    }

    /// Undoes what was taken last.
    pub fn give_back(&mut self, taken: Taken) {
        self.places.truncate(taken.places);
        taken.closed.into_iter().for_each(|cell| self.open[cell] = true);
    }

    fn is_connected(&self) -> bool {
        let mut walked = vec![false; self.open.len()];
        for doors in &self.doors {
            let start: Vec<usize> = doors[0].iter().copied().filter(|&cell| self.open[cell]).collect();
            let reached = self.reached(&start);
            if doors.iter().any(|cells| !cells.iter().any(|&cell| reached[cell])) {
                return false;
            }
            walked.iter_mut().zip(reached).for_each(|(walked, reached)| *walked |= reached);
        }
        // Without doors nobody comes in; then each place needs some floor that one can stand on.
        let within = if self.doors.is_empty() { &self.open } else { &walked };
        self.places.iter().all(|place| self.cells_in(place).iter().any(|&cell| within[cell]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::lattice::units;

    fn rect(west: f64, south: f64, east: f64, north: f64) -> Rect {
        Rect { lo: [west, south].map(units), hi: [east, north].map(units) }
    }

    #[test]
    fn a_barrier_is_refused() {
        let region = Region::new(&[rect(0.0, 0.0, 4.0, 3.0)], &[]);
        let doors = [rect(0.0, 1.0, 0.9, 2.0), rect(3.1, 1.0, 4.0, 2.0)];
        let mut walkway = Walkway::new(&region, units(0.5), &doors);
        assert!(walkway.take(&[rect(1.8, 0.0, 2.2, 2.7)], &[]).is_none(), "only 0.3 m are left");
        assert!(walkway.take(&[rect(1.8, 0.0, 2.2, 2.2)], &[]).is_some());
        assert!(walkway.take(&[rect(1.8, 2.5, 2.2, 3.0)], &[]).is_none(), "the gap is shut");
        // A place behind a barrier.
        assert!(walkway.take(&[rect(2.6, 0.5, 3.0, 0.9)], &[rect(5.0, 0.0, 6.0, 1.0)]).is_none(), "outside");
        assert!(walkway.take(&[rect(2.6, 0.5, 3.0, 0.9)], &[rect(3.0, 0.4, 3.6, 0.9)]).is_some());
    }

    #[test]
    fn doors_apart_from_the_beginning_are_no_hindrance() {
        let region = Region::new(&[rect(0.0, 0.0, 2.0, 2.0), rect(3.0, 0.0, 5.0, 2.0)], &[]);
        let doors = [rect(0.0, 0.0, 0.9, 0.9), rect(3.0, 0.0, 3.9, 0.9)];
        let mut walkway = Walkway::new(&region, units(0.5), &doors);
        assert!(walkway.take(&[rect(1.5, 1.5, 2.0, 2.0)], &[rect(1.0, 1.5, 1.5, 2.0)]).is_some());
        let mut nowhere = Walkway::new(&Region::default(), units(0.5), &doors);
        assert!(nowhere.take(&[rect(0.0, 0.0, 1.0, 1.0)], &[]).is_some());
        assert!(nowhere.take(&[], &[rect(0.0, 0.0, 1.0, 1.0)]).is_none());
    }
}
