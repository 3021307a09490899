//! Ways through furnished rooms, walked on a grid of their own.

use super::{Owned, Placed, Rect, boxes, outside, units};

fn is_movable(placed: &Placed) -> bool {
    placed.name.contains("hair") && !placed.name.starts_with("Armchair")
}

/// Panics unless one gets from each door to all that could be reached from it before, and from some door to all floor
/// from which things are used, by squares a little smaller than the way is wide, at the corners of a fine grid.
pub fn check_ways(owned: &Owned, placed: &[Placed], used: &[Rect]) {
    let width = units(owned.use_.walkway());
    // Who is so much wider in the empty room also gets through by the steps that the furnisher looks at.
    let bare = floor_grid(owned, &[], width + 2 * PITCH);
    let full = floor_grid(owned, placed, width - 2 * PITCH);
    let reached = |grid: &Grid, door: &Rect| {
        let start: Vec<usize> = grid.cells_in(door).into_iter().filter(|&c| grid.is_open(c)).collect();
        grid.reached(&start)
    };
    for door in &owned.keep_clear {
        let (before, after) = (reached(&bare, &door.grown(-PITCH)), reached(&full, door));
        for (i, other) in owned.keep_clear.iter().enumerate() {
            let at = |reached: &[bool], place: &Rect| full.cells_in(place).iter().any(|&c| reached[c]);
            assert!(
                !at(&before, &other.grown(-PITCH)) || at(&after, other),
                "door {i} is cut off from {door:?}"
            );
        }
    }
    let narrow = floor_grid(owned, placed, units(0.5) - 2 * PITCH);
    let wide = floor_grid(owned, &[], units(0.5) + 2 * PITCH);
    // By a door in a niche that is narrower than a person nobody comes in.
    let can_enter = |door: &Rect| wide.cells_in(&door.grown(-PITCH)).iter().any(|&cell| wide.is_open(cell));
    let walked: Vec<Vec<bool>> = owned.keep_clear.iter().map(|door| reached(&narrow, door)).collect();
    for place in used.iter().filter(|_| owned.keep_clear.iter().any(can_enter)) {
        let cells = narrow.cells_in(&place.grown(PITCH));
        let is_reached = walked.iter().any(|reached| cells.iter().any(|&c| reached[c]));
        assert!(is_reached, "nobody gets to {place:?}");
    }
}

/// Points of the floor every 1/16 m, and what is in the way.
#[derive(Clone)]
struct Grid {
    lo: [i32; 2],
    size: [usize; 2],
    half: i32,
    rects: Vec<Rect>,
    things: Vec<Rect>,
}

const PITCH: i32 = 64;

fn floor_grid(owned: &Owned, placed: &[Placed], width: i32) -> Grid {
    let things = placed.iter().filter(|p| !is_movable(p)).flat_map(boxes);
    let low = things.filter(|b| b.lo[2] - owned.floor < units(0.8)).map(|b| Rect::under(&b));
    let lo = [0, 1].map(|i| owned.rects.iter().map(|r| r.lo[i]).min().unwrap_or(0));
    let hi = [0, 1].map(|i| owned.rects.iter().map(|r| r.hi[i]).max().unwrap_or(0));
    Grid {
        lo,
        size: [0, 1].map(|i| ((hi[i] - lo[i]) / PITCH + 1) as usize),
        half: width / 2 - 1,
        rects: owned.rects.clone(),
        things: low.chain(owned.solids.iter().copied()).collect(),
    }
}

impl Grid {
    fn point(&self, cell: usize) -> [i32; 2] {
        let at = [cell % self.size[0], cell / self.size[0]];
        [0, 1].map(|i| self.lo[i] + at[i] as i32 * PITCH)
    }

    fn is_open(&self, cell: usize) -> bool {
        let p = self.point(cell);
        let person = Rect { lo: p, hi: p }.grown(self.half);
        outside(person, &self.rects).is_empty() && !self.things.iter().any(|t| t.overlaps(&person))
    }

    fn cells_in(&self, rect: &Rect) -> Vec<usize> {
        let within = |p: [i32; 2]| (0..2).all(|i| (rect.lo[i]..=rect.hi[i]).contains(&p[i]));
        (0..self.size[0] * self.size[1]).filter(|&c| within(self.point(c))).collect()
    }

    fn reached(&self, start: &[usize]) -> Vec<bool> {
        let mut reached = vec![false; self.size[0] * self.size[1]];
        let mut waiting = start.to_vec();
        start.iter().for_each(|&c| reached[c] = true);
        while let Some(cell) = waiting.pop() {
            let (x, y) = (cell % self.size[0], cell / self.size[0]);
            let mut beside = Vec::new();
            beside.extend((x > 0).then(|| cell - 1));
            beside.extend((x + 1 < self.size[0]).then_some(cell + 1));
            beside.extend((y > 0).then(|| cell - self.size[0]));
            beside.extend((y + 1 < self.size[1]).then_some(cell + self.size[0]));
            for next in beside {
                if !reached[next] && self.is_open(next) {
                    reached[next] = true;
                    waiting.push(next);
                }
            }
        }
        reached
    }
}
