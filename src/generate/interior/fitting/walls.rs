//! Where things fit along the walls.

use crate::generate::lattice::{Placement, units};

use super::super::Rect;
use super::super::catalogue::Thing;
use super::super::group::Group;
use super::super::region::{FAR, Wall};
use super::super::wish::Wish;
use super::Fitting;

impl Fitting<'_> {
    /// Puts a group with its back to the wall where it fits best.
    pub fn against_wall(&mut self, group: &Group, wish: &Wish) -> bool {
        let mut places = Vec::new();
        for wall in 0..self.walls.len() {
            let wall = self.walls[wall];
            let room = wall.length - group.size[0];
            if room < 0 {
                continue;
            }
            let (touching, between) = self.offsets(&wall, group.size, room);
            for (offsets, touches) in [(touching, true), (between, false)] {
                for offset in offsets {
                    let score = self.score(&wall, group.size, offset, wish, touches);
                    places.push((score, along(&wall, offset)));
                }
            }
        }
        places.sort_by_key(|&(score, place)| (std::cmp::Reverse(score), place.turns, place.origin));
        places.iter().any(|(_, place)| self.put(group, place))
    }

    /// Puts a group into a corner of the room: that on its right, seen from behind it, if `is_right`, where u = 0; else
    /// that on its left.
    pub fn in_corner(&mut self, group: &Group, is_right: bool, wish: &Wish) -> bool {
        let mut places = Vec::new();
        for wall in 0..self.walls.len() {
            let wall = self.walls[wall];
            let room = wall.length - group.size[0];
            let offset = if is_right { 0 } else { room };
            // Where the wall ends at an edge that juts into the room, there is no corner.
            let end = if is_right { -1 } else { wall.length };
            let beyond = Rect { lo: [end, 0], hi: [end + 1, group.size[1]] }.placed(&along(&wall, 0));
            if room >= 0 && self.region.misses(&beyond) {
                places.push((self.score(&wall, group.size, offset, wish, true), along(&wall, offset)));
            }
        }
        places.sort_by_key(|&(score, place)| (std::cmp::Reverse(score), place.turns, place.origin));
        places.iter().any(|(_, place)| self.put(group, place))
    }

    /// Offsets along a wall: where a group of a size would touch a corner or something, and others.
    fn offsets(&self, wall: &Wall, [w, d]: [i32; 2], room: i32) -> (Vec<i32>, Vec<i32>) {
        let mut ends = vec![0, wall.length];
        let strip = Rect { lo: [0, 0], hi: [wall.length, d.max(1)] }.placed(&along(wall, 0));
        let stands = self.stands.iter().map(|s| Rect::under(&s.bounds));
        let fronts = self.window_fronts.iter().map(|(front, _)| *front);
        for rect in stands.chain(self.room.keep_clear.iter().copied()).chain(fronts) {
            if !rect.is_empty() && rect.overlaps(&strip) {
                let near = Rect {
                    lo: [0, 1].map(|i| rect.lo[i].max(strip.lo[i])),
                    hi: [0, 1].map(|i| rect.hi[i].min(strip.hi[i])),
                };
                ends.extend(from_start(wall, &near));
            }
        }
        ends.sort_unstable();
        ends.dedup();
        let mut touching: Vec<i32> = ends.iter().flat_map(|&end| [end, end - w]).collect();
        let mut between: Vec<i32> = ends.windows(2).map(|pair| (pair[0] + pair[1] - w) / 2).collect();
        let step = units(0.25).max(room / 32);
        between.extend((1..).map(|i| i * step).take_while(|&offset| offset < room));
        for offsets in [&mut touching, &mut between] {
            offsets.retain(|offset| (0..=room).contains(offset));
            offsets.sort_unstable();
            offsets.dedup();
        }
        (touching, between)
    }

    fn score(&mut self, wall: &Wall, [w, _]: [i32; 2], offset: i32, wish: &Wish, touches: bool) -> i64 {
        let [x, y, _] = along(wall, offset).point([w / 2, 0, 0]);
        let doors = self.room.keep_clear.iter().map(Rect::doubled_middle);
        let windows = self.room.windows.iter().map(|w| Rect::between(w.from, w.to).doubled_middle());
        let to_door = nearest([x, y], doors);
        let to_window = nearest([x, y], windows);
        let to_middle = (i64::from(offset) + i64::from(w / 2) - i64::from(wall.length / 2)).abs();
        let faces =
            wish.facing.map_or(0, |(turns, worth)| if turns == wall.turns { i64::from(worth) } else { 0 });
        let chance = i64::from(self.random.below(1024 * wish.chance.max(0) as u32 + 256));
        1024 * (faces + if touches { i64::from(wish.corner) } else { 0 }) + chance
            - i64::from(wish.window) * to_window
            - i64::from(wish.door) * to_door
            - i64::from(wish.middle) * to_middle
    }

    /// Hangs a radiator under each window that leaves room for one.
    pub fn radiators(&mut self) {
        let windows = self.room.windows;
        for window in windows {
            let span = Rect::between(window.from, window.to);
            let sill = i64::from(window.sill) - i64::from(self.floor);
            let h = if sill >= i64::from(units(0.85)) { 60 } else { 35 };
            if sill < i64::from(units(0.55)) {
                continue;
            }
            for wall in 0..self.walls.len() {
                let wall = self.walls[wall];
                let along_x = wall.turns.is_multiple_of(2);
                let across = usize::from(along_x);
                let apart = span.lo[across].abs_diff(wall.start[across]);
                let [from, to] = from_start(&wall, &span);
                let [from, to] = [from.clamp(0, wall.length), to.clamp(0, wall.length)];
                if along_x != window.is_along_x() || apart > 64 || to - from < units(0.4) {
                    continue;
                }
                let cm = ((to - from) / 1024 * 100 + (to - from) % 1024 * 100 / 1024).min(200) / 20 * 20;
                let item = self.item(Thing::Radiator { w: cm as u16, h });
                let offset = from + (to - from - item.size[0]) / 2;
                self.put(&Group::alone(&item, 0), &along(&wall, offset));
            }
        }
    }
}

/// The placement of something `offset` along a wall.
fn along(wall: &Wall, offset: i32) -> Placement {
    let start = Placement { origin: [wall.start[0], wall.start[1], 0], turns: wall.turns };
    Placement { origin: start.point([offset, 0, 0]), ..start }
}

/// From where to where along a wall a rectangle reaches.
fn from_start(wall: &Wall, rect: &Rect) -> [i32; 2] {
    let axis = usize::from(!wall.turns.is_multiple_of(2));
    let [lo, hi] = [rect.lo[axis], rect.hi[axis]].map(|c| c.clamp(-FAR, FAR) - wall.start[axis]);
    // u points to +x, +y, -x, -y.
    if wall.turns < 2 { [lo, hi] } else { [-hi, -lo] }
}

/// The distance from a point to the nearest of some points given in doubled coordinates, along the axes; 0 if there
/// is none.
fn nearest(p: [i32; 2], doubled: impl Iterator<Item = [i64; 2]>) -> i64 {
    let distance = |q: [i64; 2]| (0..2).map(|i| (q[i] / 2 - i64::from(p[i])).abs()).sum::<i64>();
    doubled.map(distance).min().unwrap_or(0)
}
