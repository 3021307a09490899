//! The plan of an office wing's storey: rooms on both sides of a corridor. Some take their neighbour's half along the
//! facade, which makes them L-, T- or U-shaped.
//!
//! Plans are in modules of about a decimetre, x along the corridor, y to the north; [`Storey`] holds rectangles and
//! nothing else, so that the same plan can be raised any number of times, anywhere.

use super::holes::Filling;
use super::joinery::Hinge;
use super::uses::Use;

/// A rectangle in modules: west, south, east, north.
pub type Modules = [i32; 4];

/// Thickness of outer walls, of the corridor's walls, and of partitions, modules.
pub const OUTER: i32 = 3;
const INNER: i32 = 2;
const PARTITION: i32 = 1;

/// Whose the half of a bay along the facade is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facade {
    /// The bay's own: it reaches from the corridor to the facade.
    Own,
    /// The room's to the west.
    West,
    /// The room's to the east.
    East,
    /// Of the rooms on both sides, which become one.
    Both,
}

/// What stands between the corridor and the facade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bay {
    /// Clear width, modules.
    pub width: i32,
    /// What the room is for; `None` above a hall of two storeys: no room, no door.
    pub room: Option<Use>,
    /// Whose its outer half is.
    pub facade: Facade,
    /// Whether something is built against its facade, so that it has no windows.
    pub is_blind: bool,
}

/// A wing's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// A wall without openings.
    Blind,
    /// A wall with a window at the end of the corridor.
    Window,
    /// A wall with a passage from the corridor.
    Passage,
    /// No wall: the wing adjoins another building's.
    Open,
}

/// A wing before it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Wing {
    /// The bays to the south and to the north of the corridor, from west to east.
    pub bays: [Vec<Bay>; 2],
    /// Clear depth of the rooms to the south and to the north.
    pub depth: [i32; 2],
    /// Clear width of the corridor.
    pub corridor: i32,
    /// The west and the east end.
    pub ends: [End; 2],
}

/// A room.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomPlan {
    /// What it is for.
    pub use_: Use,
    /// Its plan: overlapping or adjoining rectangles.
    pub rects: Vec<Modules>,
    /// The row of the bay that it belongs to, and its number in it; `None` for the corridor.
    pub bay: Option<(usize, usize)>,
}

/// A wall.
#[derive(Clone, Debug, PartialEq)]
pub struct WallPlan {
    /// Its name.
    pub name: String,
    /// Its plan.
    pub rect: Modules,
    /// Whether it is an outer wall.
    pub is_outer: bool,
}

/// A hole in a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct HolePlan {
    /// Its name.
    pub name: String,
    /// Index of its wall.
    pub wall: usize,
    /// Its plan, right through the wall.
    pub rect: Modules,
    /// Its heights over the floor, modules.
    pub heights: [i32; 2],
    /// The room that doors swing into lies in this direction: 0 north, 1 west, 2 south, 3 east.
    pub inside: u8,
    /// What closes it.
    pub filling: Filling,
}

/// A storey's plan.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Storey {
    /// The first is the corridor.
    pub rooms: Vec<RoomPlan>,
    /// Walls.
    pub walls: Vec<WallPlan>,
    /// Holes.
    pub holes: Vec<HolePlan>,
}

/// Height of doors and of windows' sills and heads, modules.
const DOOR: i32 = 21;
const SILL: i32 = 9;
const HEAD: i32 = 23;
/// Width of doors, modules.
const DOOR_WIDTH: i32 = 10;

impl Wing {
    /// Where the rows of rooms, the corridor and the end lie from south to north.
    fn rows(&self) -> Rows {
        let south = [OUTER, OUTER + self.depth[0]];
        let corridor = [south[1] + INNER, south[1] + INNER + self.corridor];
        let north = [corridor[1] + INNER, corridor[1] + INNER + self.depth[1]];
        Rows { rooms: [south, north], corridor }
    }

    /// Clear length of the corridor: as long as the longer row.
    fn clear_length(&self) -> i32 {
        let length = |bays: &Vec<Bay>| bays.iter().map(|b| b.width + PARTITION).sum::<i32>() - PARTITION;
        self.bays.iter().map(length).max().unwrap_or(0).max(DOOR_WIDTH)
    }

    fn thickness(&self, end: usize) -> i32 {
        if self.ends[end] == End::Open { 0 } else { OUTER }
    }

    /// Outer length and depth, modules.
    pub fn size(&self) -> [i32; 2] {
        let rows = self.rows();
        [self.thickness(0) + self.clear_length() + self.thickness(1), rows.rooms[1][1] + OUTER]
    }

    /// The corridor, from south to north.
    pub fn corridor_rows(&self) -> [i32; 2] {
        self.rows().corridor
    }

    /// The rooms of a row, from south to north.
    pub fn room_rows(&self, row: usize) -> [i32; 2] {
        self.rows().rooms[row]
    }

    /// Where a bay lies from west to east.
    pub fn bay_span(&self, row: usize, bay: usize) -> [i32; 2] {
        let before: i32 = self.bays[row][..bay].iter().map(|b| b.width + PARTITION).sum();
        let west = self.thickness(0) + before;
        // The last bay of the shorter row is as wide as is needed.
        let is_last = bay + 1 == self.bays[row].len();
        let east =
            if is_last { self.thickness(0) + self.clear_length() } else { west + self.bays[row][bay].width };
        [west, east]
    }

    /// The storey's plan.
    pub fn storey(&self) -> Storey {
        let rows = self.rows();
        let [length, depth] = self.size();
        let (west, east) = (self.thickness(0), length - self.thickness(1));
        let mut storey = Storey::default();
        let corridor = RoomPlan {
            use_: Use::Corridor,
            rects: vec![[west, rows.corridor[0], east, rows.corridor[1]]],
            bay: None,
        };
        storey.rooms.push(corridor);
        let outer = [
            storey.wall("Outer wall south", [0, 0, length, OUTER], true),
            storey.wall("Outer wall north", [0, depth - OUTER, length, depth], true),
        ];
        for (end, name) in [(0, "west"), (1, "east")] {
            self.end(&mut storey, end, name);
        }
        for row in 0..2 {
            self.row(&mut storey, row, outer[row]);
        }
        storey
    }

    fn end(&self, storey: &mut Storey, end: usize, name: &str) {
        let [length, depth] = self.size();
        if self.ends[end] == End::Open {
            return;
        }
        let [west, east] = if end == 0 { [0, OUTER] } else { [length - OUTER, length] };
        let wall = storey.wall(&format!("Outer wall {name}"), [west, OUTER, east, depth - OUTER], true);
        let corridor = self.rows().corridor;
        let middle = (corridor[0] + corridor[1]) / 2;
        let (half, heights, filling) = match self.ends[end] {
            End::Window => (self.corridor / 2 - 2, [SILL, HEAD], Filling::Window { panes: 1 }),
            End::Passage => (self.corridor / 2 - 1, [0, HEAD], Filling::Nothing),
            _ => return,
        };
        storey.holes.push(HolePlan {
            name: format!("Corridor {name}"),
            wall,
            rect: [west, middle - half, east, middle + half],
            heights,
            inside: if end == 0 { 3 } else { 1 },
            filling,
        });
    }

    /// The rooms on one side of the corridor.
    fn row(&self, storey: &mut Storey, row: usize, outer_wall: usize) {
        let side = ["south", "north"][row];
        let rows = self.rows();
        let [length, _] = self.size();
        let ends = [self.thickness(0), length - self.thickness(1)];
        let [y0, y1] = rows.rooms[row];
        let middle = (y0 + y1) / 2;
        // The half along the facade, the wall between the halves, and the half along the corridor.
        let (facade, cross, inner) = if row == 0 {
            ([y0, middle], [middle, middle + PARTITION], [middle + PARTITION, y1])
        } else {
            ([middle + PARTITION, y1], [middle, middle + PARTITION], [y0, middle])
        };
        let wall_rows = if row == 0 { [y1, rows.corridor[0]] } else { [rows.corridor[1], y0] };
        let corridor_wall = storey.wall(
            &format!("Corridor wall {side}"),
            [ends[0], wall_rows[0], ends[1], wall_rows[1]],
            false,
        );

        let bays = &self.bays[row];
        // The room of each bay: that of the bay before, where the two are one.
        let mut rooms: Vec<Option<usize>> = vec![None; bays.len()];
        for (i, bay) in bays.iter().enumerate() {
            let [x0, x1] = self.bay_span(row, i);
            let is_one_with = i >= 2 && bays[i - 1].facade == Facade::Both;
            if let (true, Some(first)) = (is_one_with, if i >= 2 { rooms[i - 2] } else { None }) {
                rooms[i] = Some(first);
                storey.rooms[first].rects.push([x0, y0, x1, y1]);
            } else if let Some(use_) = bay.room {
                let rect =
                    if bay.facade == Facade::Own { [x0, y0, x1, y1] } else { [x0, inner[0], x1, inner[1]] };
                storey.rooms.push(RoomPlan { use_, rects: vec![rect], bay: Some((row, i)) });
                rooms[i] = Some(storey.rooms.len() - 1);
            }
        }
        for (i, bay) in bays.iter().enumerate() {
            let [x0, x1] = self.bay_span(row, i);
            let name = |what: &str| format!("{what} {side} {}", i + 1);
            let (to_west, to_east) = match bay.facade {
                Facade::Own => (false, false),
                Facade::West => (true, false),
                Facade::East => (false, true),
                Facade::Both => (true, true),
            };
            if bay.facade != Facade::Own {
                let reach = [x0 - PARTITION * i32::from(to_west), x1 + PARTITION * i32::from(to_east)];
                storey.wall(&name("Cross wall"), [x0, cross[0], x1, cross[1]], false);
                let owner = if to_west { i.checked_sub(1) } else { Some(i + 1) };
                if let Some(room) = owner.and_then(|o| rooms.get(o).copied().flatten()) {
                    storey.rooms[room].rects.push([reach[0], facade[0], reach[1], facade[1]]);
                }
            }
            if let Some(next) = bays.get(i + 1) {
                // Between this bay and the next: only half a wall where a room goes around its end.
                let goes_around = to_east || matches!(next.facade, Facade::West | Facade::Both);
                let reach = match (goes_around, row) {
                    (false, _) => [y0, y1],
                    (true, 0) => [cross[0], y1],
                    (true, _) => [y0, cross[1]],
                };
                storey.wall(&name("Partition"), [x1, reach[0], x1 + PARTITION, reach[1]], false);
            }
            self.openings(storey, row, i, [corridor_wall, outer_wall]);
        }
    }

    /// A bay's door to the corridor and its windows.
    fn openings(&self, storey: &mut Storey, row: usize, bay: usize, [corridor_wall, outer_wall]: [usize; 2]) {
        let side = ["south", "north"][row];
        let [x0, x1] = self.bay_span(row, bay);
        let into_room = if row == 0 { 2 } else { 0 };
        let width = x1 - x0;
        if let Some(use_) = self.bays[row][bay].room {
            let [_, south, _, north] = storey.walls[corridor_wall].rect;
            let (wide, heights, filling) = use_.door(bay);
            let wide = wide.min(width - 2).max(4);
            // Near the end of the wall, the hinge at its corner, alternately.
            let from = match (width > wide + 4, bay % 2) {
                (false, _) => x0 + (width - wide) / 2,
                (true, 0) => x0 + 2,
                (true, _) => x1 - 2 - wide,
            };
            storey.holes.push(HolePlan {
                name: format!("Door {side} {}", bay + 1),
                wall: corridor_wall,
                rect: [from, south, from + wide, north],
                heights,
                inside: into_room,
                filling,
            });
        }
        let [_, south, _, north] = storey.walls[outer_wall].rect;
        let into_room = if row == 0 { 0 } else { 2 };
        let use_ = self.bays[row][bay].room;
        if self.bays[row][bay].is_blind {
            return;
        }
        if use_ == Some(Use::Hall) {
            let middle = (x0 + x1) / 2;
            storey.holes.push(HolePlan {
                name: format!("Entrance {side} {}", bay + 1),
                wall: outer_wall,
                rect: [middle - 10, south, middle + 10, north],
                heights: [0, HEAD],
                inside: into_room,
                filling: Filling::Terrace,
            });
            return;
        }
        // A window for each stretch of three metres.
        let count = (width / 32).max(1);
        for k in 0..count {
            let (from, to) = (x0 + width * k / count, x0 + width * (k + 1) / count);
            let margin = if to - from > 24 { 5 } else { (to - from) / 5 };
            if to - from - 2 * margin < 5 {
                continue;
            }
            let panes = ((to - from - 2 * margin) / 9).clamp(1, 3);
            let heights = if use_ == Some(Use::Toilet) { [15, HEAD] } else { [SILL, HEAD] };
            storey.holes.push(HolePlan {
                name: format!("Window {side} {}.{}", bay + 1, k + 1),
                wall: outer_wall,
                rect: [from + margin, south, to - margin, north],
                heights,
                inside: into_room,
                filling: Filling::Window { panes },
            });
        }
    }
}

impl Use {
    /// Width and heights of a room's door, and what closes it.
    fn door(self, bay: usize) -> (i32, [i32; 2], Filling) {
        let hinge = if bay.is_multiple_of(2) { Hinge::Low } else { Hinge::High };
        match self {
            Use::Hall | Use::Corridor => (24, [0, HEAD], Filling::Nothing),
            Use::Conference | Use::Library => (16, [0, DOOR], Filling::Terrace),
            _ => (DOOR_WIDTH, [0, DOOR], Filling::Door(hinge)),
        }
    }
}

impl Storey {
    /// The floor in front of a room's doors and passages, on both sides of their walls.
    pub fn clear_of_doors(&self, room: usize) -> Vec<Modules> {
        let doors = self.holes.iter().filter(|hole| hole.heights[0] == 0);
        doors.map(|hole| grown(hole, 11)).filter(|rect| self.rooms[room].meets(rect)).collect()
    }

    /// The windows of a room.
    pub fn windows_of(&self, room: usize) -> impl Iterator<Item = &HolePlan> {
        let windows = self.holes.iter().filter(|hole| hole.heights[0] > 0);
        windows.filter(move |hole| self.rooms[room].meets(&grown(hole, 1)))
    }

    fn wall(&mut self, name: &str, rect: Modules, is_outer: bool) -> usize {
        self.walls.push(WallPlan { name: name.to_owned(), rect, is_outer });
        self.walls.len() - 1
    }
}

/// A hole's plan and so much more on both sides of the wall.
fn grown(hole: &HolePlan, by: i32) -> Modules {
    let [west, south, east, north] = hole.rect;
    if hole.inside.is_multiple_of(2) {
        [west, south - by, east, north + by]
    } else {
        [west - by, south, east + by, north]
    }
}

impl RoomPlan {
    /// Whether a rectangle reaches into the room.
    fn meets(&self, rect: &Modules) -> bool {
        self.rects.iter().any(|r| r[0] < rect[2] && rect[0] < r[2] && r[1] < rect[3] && rect[1] < r[3])
    }
}

/// Stretches from south to north.
struct Rows {
    rooms: [[i32; 2]; 2],
    corridor: [i32; 2],
}

/// The area that rectangles cover together, square modules.
pub fn area(rects: &[Modules]) -> i64 {
    let cuts = |pick: fn(&Modules) -> [i32; 2]| {
        let mut cuts: Vec<i32> = rects.iter().flat_map(pick).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let (xs, ys) = (cuts(|r| [r[0], r[2]]), cuts(|r| [r[1], r[3]]));
    let mut area = 0;
    for x in xs.windows(2) {
        for y in ys.windows(2) {
            if rects.iter().any(|r| r[0] <= x[0] && x[1] <= r[2] && r[1] <= y[0] && y[1] <= r[3]) {
                area += i64::from(x[1] - x[0]) * i64::from(y[1] - y[0]);
            }
        }
    }
    area
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wing(facades: &[Facade]) -> Wing {
        let bay = |&facade: &Facade| Bay { width: 35, room: Some(Use::Office), facade, is_blind: false };
        Wing {
            bays: [facades.iter().map(bay).collect(), vec![bay(&Facade::Own)]],
            depth: [52, 45],
            corridor: 22,
            ends: [End::Window, End::Open],
        }
    }

    #[test]
    fn rooms_and_walls_cover_the_footprint_once() {
        use Facade::*;
        for facades in [
            vec![Own, Own, Own],
            vec![Own, West, Own],
            vec![Own, East, Own],
            vec![Own, Both, Own],
            vec![East, Own, West],
            vec![Own, Both, Own, Own, West, East, Own, Both, Own],
        ] {
            let wing = wing(&facades);
            let storey = wing.storey();
            let [length, depth] = wing.size();
            let rooms: i64 = storey.rooms.iter().map(|r| area(&r.rects)).sum();
            let walls: i64 = storey.walls.iter().map(|w| area(&[w.rect])).sum();
            assert_eq!(rooms + walls, i64::from(length) * i64::from(depth), "{facades:?}");
            let all: Vec<Modules> = storey
                .rooms
                .iter()
                .flat_map(|r| r.rects.clone())
                .chain(storey.walls.iter().map(|w| w.rect))
                .collect();
            assert_eq!(area(&all), rooms + walls, "{facades:?}: overlaps");
        }
    }

    #[test]
    fn rooms_take_the_shapes_of_letters() {
        use Facade::*;
        let corners = |facades: &[Facade], room: usize| wing(facades).storey().rooms[room].rects.len();
        assert_eq!(corners(&[Own, West], 1), 2, "L");
        assert_eq!(corners(&[East, Own, West], 2), 3, "T");
        assert_eq!(corners(&[Own, Both, Own], 1), 3, "U");
        assert_eq!(wing(&[Own, Both, Own]).storey().rooms.len(), 4, "corridor, U, the bay within, north");
    }
}
