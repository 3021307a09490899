//! Things that belong together, in a frame of their own.

use std::sync::Arc;

use crate::generate::lattice::{Placement, units};

use super::Rect;
use super::catalogue::Item;

/// A thing of a group.
#[derive(Clone, Debug)]
pub struct Part {
    /// What it is.
    pub item: Arc<Item>,
    /// Where it stands in the group.
    pub place: Placement,
    /// Whether whoever comes moves it out of the way: a chair.
    pub is_movable: bool,
}

/// Things and the floor that they need, units. Groups that stand against a wall have it at v = 0.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// The things.
    pub parts: Vec<Part>,
    /// Width and depth of what it fills.
    pub size: [i32; 2],
    /// Floor from which it is used, inside that or in front of it. Other groups may use it too, but not stand there.
    pub used: Vec<Rect>,
}

impl Group {
    /// One thing, used from a strip of the floor in front of it; from none if `front` is 0.
    pub fn alone(item: &Arc<Item>, front: i32) -> Group {
        Group::row(item, 1, front)
    }

    /// Things side by side, all alike.
    pub fn row(item: &Arc<Item>, count: i32, front: i32) -> Group {
        let [w, d] = item.size;
        let mut row = Group { size: [w * count, d], ..Group::default() };
        for i in 0..count {
            row.put(item, [i * w, 0], 0);
        }
        if front > 0 {
            row.used.push(Rect { lo: [0, d], hi: [w * count, d + front] });
        }
        row
    }

    /// One thing with free floor at both of its sides.
    pub fn with_sides(item: &Arc<Item>, side: i32, front: i32) -> Group {
        let [w, d] = item.size;
        let mut group = Group { size: [w + 2 * side, d], ..Group::default() };
        group.put(item, [side, 0], 0);
        group.used.push(Rect { lo: [0, d], hi: [w + 2 * side, d + front] });
        group
    }

    /// Two rows back to back.
    pub fn double_row(item: &Arc<Item>, count: i32, front: i32) -> Group {
        let row = Group::row(item, count, front);
        let [w, d] = row.size;
        let mut double = Group { size: [w, 2 * d], ..Group::default() };
        double.add(&row, [0, d], 0);
        double.add(&row, [0, 0], 2);
        double
    }

    /// Adds a thing: `lo` is the corner with the least coordinates of what it covers once it is turned.
    pub fn put(&mut self, item: &Arc<Item>, lo: [i32; 2], turns: u8) {
        let place = corner_at(item.size, lo, turns);
        self.parts.push(Part { item: Arc::clone(item), place, is_movable: false });
    }

    /// Adds a chair that is moved by whoever sits down.
    pub fn put_chair(&mut self, item: &Arc<Item>, lo: [i32; 2], turns: u8) {
        let place = corner_at(item.size, lo, turns);
        self.parts.push(Part { item: Arc::clone(item), place, is_movable: true });
    }

    /// Adds all of another group, turned.
    pub fn add(&mut self, other: &Group, lo: [i32; 2], turns: u8) {
        let place = corner_at(other.size, lo, turns);
        for part in &other.parts {
            self.parts.push(Part { place: within(&place, &part.place), ..part.clone() });
        }
        self.used.extend(other.used.iter().map(|rect| rect.placed(&place)));
    }

    /// Its size, turned.
    pub fn turned_size(&self, turns: u8) -> [i32; 2] {
        let [w, d] = self.size;
        if turns.is_multiple_of(2) { [w, d] } else { [d, w] }
    }

    /// How many faces it shows at most.
    pub fn faces(&self) -> u32 {
        self.parts.iter().map(|part| part.item.faces).sum()
    }
}

/// A table with chairs around it: `chairs` along u and along v on each side, and `around` it the floor that they need.
pub fn table_with_chairs(table: &Arc<Item>, chair: &Arc<Item>, chairs: [i32; 2], around: i32) -> Group {
    let [w, d] = table.size;
    let [chair_w, chair_d] = chair.size;
    let mut group = Group { size: [w + 2 * around, d + 2 * around], ..Group::default() };
    group.put(table, [around, around], 0);
    // Chairs stand a little under the table.
    let (near, far) = (around - chair_d + units(0.1), around - units(0.1));
    for i in 0..chairs[0] {
        let u = around + (2 * i + 1) * w / (2 * chairs[0]) - chair_w / 2;
        group.put_chair(chair, [u, near], 0);
        group.put_chair(chair, [u, far + d], 2);
    }
    for i in 0..chairs[1] {
        let v = around + (2 * i + 1) * d / (2 * chairs[1]) - chair_w / 2;
        group.put_chair(chair, [near, v], 3);
        group.put_chair(chair, [far + w, v], 1);
    }
    let [all_w, all_d] = group.size;
    group.used = vec![
        Rect { lo: [0, 0], hi: [all_w, around] },
        Rect { lo: [0, around + d], hi: [all_w, all_d] },
        Rect { lo: [0, 0], hi: [around, all_d] },
        Rect { lo: [around + w, 0], hi: [all_w, all_d] },
    ];
    group
}

/// Where a thing of a size stands so that, turned, it covers the plan from `lo` on.
pub fn corner_at([w, d]: [i32; 2], [x, y]: [i32; 2], turns: u8) -> Placement {
    let [x, y] = match turns % 4 {
        0 => [x, y],
        1 => [x + d, y],
        2 => [x + w, y + d],
        _ => [x, y + w],
    };
    Placement { origin: [x, y, 0], turns: turns % 4 }
}

/// A placement within a frame that is itself placed.
pub fn within(frame: &Placement, inner: &Placement) -> Placement {
    Placement { origin: frame.point(inner.origin), turns: (frame.turns + inner.turns) % 4 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turned_things_cover_the_plan_from_their_corner_on() {
        for turns in 0..4 {
            let place = corner_at([7, 3], [100, 200], turns);
            let covered = Rect { lo: [0, 0], hi: [7, 3] }.placed(&place);
            let [w, d] = if turns % 2 == 0 { [7, 3] } else { [3, 7] };
            assert_eq!(covered, Rect { lo: [100, 200], hi: [100 + w, 200 + d] }, "{turns} turns");
            // A corner of a thing in the frame, and the same corner by both placements at once.
            for inner_turns in 0..4 {
                let inner = corner_at([2, 1], [4, 1], inner_turns);
                let p = [2, 1, 5];
                assert_eq!(within(&place, &inner).point(p), place.point(inner.point(p)));
            }
        }
    }
}
