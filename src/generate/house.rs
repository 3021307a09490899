//! A one-storey house of eight rooms: an L-shaped living room with a chimney and a dining end, kitchen, L-shaped
//! hall, WC, L-shaped bath, two bedrooms and a study; flat roof, terrace, garden.

use crate::importers::Semantic;

use super::building::{Building, Kind};
use super::draft::Draft;
use super::furnish;
use super::holes::{self, Filling, Hole};
use super::joinery::Hinge;
use super::lattice::{Cuboid, units};
use super::palette::{self, Look};
use super::sheet::Embedding;
use super::views;

/// What [`house`] makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct HouseOptions {
    /// Put furniture, sanitary ware and lamps into the rooms.
    pub furniture: bool,
    /// Lay a garden around the house; without it the exterior reaches down to the underside of the slabs.
    pub site: bool,
    /// Identities, and how far the doors stand open, follow from it.
    pub seed: u64,
}

impl Default for HouseOptions {
    fn default() -> HouseOptions {
        HouseOptions { furniture: true, site: true, seed: 0 }
    }
}

/// The house's outer size, metres.
const SIZE: [f64; 2] = [12.0, 10.0];
/// From floor to ceiling, metres.
const CEILING: f64 = 2.6;
/// Underside and top of the roof, metres.
const ROOF: [f64; 2] = [2.8, 3.0];
/// Underside of the slabs and the bottom of the world, metres.
const BOTTOM: f64 = -0.3;
/// Top of the garden, metres.
const GARDEN: f64 = -0.15;
/// Top of the terrace and the entrance step, metres.
const TERRACE: f64 = -0.02;
/// Heads of doors and windows, metres.
const HEAD: f64 = 2.1;

/// A rectangle of the plan, metres: west, south, east, north.
type Rect = [f64; 4];

struct RoomPlan {
    name: &'static str,
    rects: &'static [Rect],
    floor: u32,
    walls: u32,
}

const ROOMS: [RoomPlan; 8] = [
    RoomPlan {
        name: "Living room",
        rects: &[[0.36, 0.36, 6.30, 4.60], [0.36, 4.60, 3.60, 7.00]],
        floor: palette::OAK_FLOOR,
        walls: palette::PLASTER,
    },
    RoomPlan {
        name: "Kitchen",
        rects: &[[0.36, 7.12, 3.60, 9.64]],
        floor: palette::FLOOR_TILES,
        walls: palette::PLASTER,
    },
    RoomPlan {
        name: "Hall",
        rects: &[[3.72, 4.84, 5.70, 9.64], [5.70, 4.84, 11.64, 6.04]],
        floor: palette::FLOOR_TILES,
        walls: palette::PLASTER,
    },
    RoomPlan {
        name: "WC",
        rects: &[[5.82, 8.00, 7.12, 9.64]],
        floor: palette::BATH_TILES,
        walls: palette::BATH_TILES,
    },
    RoomPlan {
        name: "Bath",
        rects: &[[5.82, 6.16, 8.70, 7.88], [7.24, 7.88, 8.70, 9.64]],
        floor: palette::BATH_TILES,
        walls: palette::BATH_TILES,
    },
    RoomPlan {
        name: "Children's room",
        rects: &[[8.82, 6.16, 11.64, 9.64]],
        floor: palette::OAK_FLOOR,
        walls: palette::PLASTER,
    },
    RoomPlan {
        name: "Study",
        rects: &[[6.42, 0.36, 8.52, 4.60]],
        floor: palette::OAK_FLOOR,
        walls: palette::PLASTER,
    },
    RoomPlan {
        name: "Bedroom",
        rects: &[[8.64, 0.36, 11.64, 4.60]],
        floor: palette::OAK_FLOOR,
        walls: palette::PLASTER,
    },
];

/// Walls of full height: name, plan, whether they are outer walls.
const WALLS: [(&str, Rect, bool); 14] = [
    ("Outer wall south", [0.0, 0.0, 12.0, 0.36], true),
    ("Outer wall north", [0.0, 9.64, 12.0, 10.0], true),
    ("Outer wall west", [0.0, 0.36, 0.36, 9.64], true),
    ("Outer wall east", [11.64, 0.36, 12.0, 9.64], true),
    ("Wall living-hall", [3.60, 4.60, 11.64, 4.84], false),
    ("Wall dining-hall", [3.60, 4.84, 3.72, 9.64], false),
    ("Wall dining-kitchen", [0.36, 7.00, 3.60, 7.12], false),
    ("Wall living-study", [6.30, 0.36, 6.42, 4.60], false),
    ("Wall study-bedroom", [8.52, 0.36, 8.64, 4.60], false),
    ("Wall hall-bath", [5.70, 6.04, 5.82, 9.64], false),
    ("Wall corridor", [5.82, 6.04, 11.64, 6.16], false),
    ("Wall bath-children", [8.70, 6.16, 8.82, 9.64], false),
    ("Wall WC-bath east", [7.12, 8.00, 7.24, 9.64], false),
    ("Wall WC-bath south", [5.82, 7.88, 7.24, 8.00], false),
];

struct HolePlan {
    name: &'static str,
    /// Index in [`WALLS`].
    wall: usize,
    /// From where to where along the wall, metres.
    along: [f64; 2],
    sill: f64,
    /// The room that doors swing into lies in this direction: 0 north, 1 west, 2 south, 3 east.
    inside: u8,
    filling: Filling,
}

const fn door(name: &'static str, wall: usize, along: [f64; 2], inside: u8, hinge: Hinge) -> HolePlan {
    HolePlan { name, wall, along, sill: 0.0, inside, filling: Filling::Door(hinge) }
}

const fn window(name: &'static str, wall: usize, along: [f64; 2], sill: f64, panes: i32) -> HolePlan {
    // The first four walls are the outer ones: south, north, west, east.
    let inside = [0, 2, 3, 1][wall];
    HolePlan { name, wall, along, sill, inside, filling: Filling::Window { panes } }
}

const HOLES: [HolePlan; 23] = [
    HolePlan {
        name: "Entrance",
        wall: 1,
        along: [4.20, 5.21],
        sill: 0.0,
        inside: 2,
        filling: Filling::Entrance,
    },
    HolePlan {
        name: "Terrace door",
        wall: 0,
        along: [1.20, 3.00],
        sill: 0.0,
        inside: 0,
        filling: Filling::Terrace,
    },
    HolePlan {
        name: "Passage",
        wall: 6,
        along: [1.00, 2.40],
        sill: 0.0,
        inside: 0,
        filling: Filling::Nothing,
    },
    door("Dining", 5, [5.30, 6.20], 1, Hinge::High),
    door("Kitchen", 5, [7.60, 8.50], 3, Hinge::Low),
    door("WC", 9, [8.40, 9.20], 1, Hinge::Low),
    door("Bath", 10, [7.30, 8.20], 0, Hinge::High),
    door("Children", 10, [9.20, 10.10], 0, Hinge::Low),
    door("Study", 4, [6.90, 7.80], 2, Hinge::Low),
    door("Bedroom", 4, [9.00, 9.90], 2, Hinge::High),
    window("Living south", 0, [3.80, 5.60], 0.9, 2),
    window("Study south", 0, [7.00, 8.00], 0.9, 1),
    window("Bedroom south", 0, [9.40, 10.80], 0.9, 2),
    window("Kitchen north", 1, [1.20, 2.60], 1.1, 2),
    window("WC north", 1, [6.20, 6.80], 1.4, 1),
    window("Bath north", 1, [7.60, 8.40], 1.4, 1),
    window("Children north", 1, [9.60, 10.80], 0.9, 2),
    window("Living west", 2, [1.40, 3.40], 0.9, 3),
    window("Dining west", 2, [5.20, 6.60], 0.9, 2),
    window("Kitchen west", 2, [7.90, 9.10], 1.1, 2),
    window("Bedroom east", 3, [1.60, 3.20], 0.9, 2),
    window("Corridor east", 3, [5.10, 5.80], 0.9, 1),
    window("Children east", 3, [7.20, 8.60], 0.9, 2),
];

/// Lamps: room by its index in [`ROOMS`], place in plan, metres, and candela: bulbs of 500 to 2,000 lumen.
const LAMPS: [(usize, [f64; 2], f32); 8] = [
    (0, [2.90, 2.90], 160.0),
    (1, [1.98, 8.20], 110.0),
    (2, [4.70, 6.40], 95.0),
    (3, [6.47, 8.80], 40.0),
    (4, [7.90, 7.20], 80.0),
    (5, [10.20, 7.90], 80.0),
    (6, [7.47, 2.60], 95.0),
    (7, [10.10, 2.60], 80.0),
];

/// The house. The same options always give the same building.
pub fn house(options: &HouseOptions) -> Building {
    let hull = Cuboid::new([-7.0, -8.5, BOTTOM], [SIZE[0] + 7.0, SIZE[1] + 7.0, 7.0]);
    let mut draft = Draft::new("House", options.seed, hull);
    draft.storey("Ground floor");
    draft.begin_sheet(Embedding::Straight, hull.plan());
    if options.site {
        let garden = draft.element(Kind::Solid, Semantic::Site, "IfcSite", "Garden");
        draft.look(garden, Look { top: palette::GRASS, outside: palette::GRASS, ..Look::default() });
        let ends = [hull.lo, hull.hi].map(|p| [p[0], p[1]]);
        let z = [units(BOTTOM), units(GARDEN)];
        draft.paint(garden, Cuboid::between([ends[0][0], ends[0][1], z[0]], [ends[1][0], ends[1][1], z[1]]));
    }
    shell(&mut draft);
    let walls = WALLS.map(|(name, rect, is_outer)| wall(&mut draft, name, rect, is_outer));
    for room in &ROOMS {
        let space = draft.element(Kind::Room, Semantic::Room, "IfcSpace", room.name);
        draft.look(space, Look { floor: room.floor, walls: room.walls, ..Look::default() });
        for &rect in room.rects {
            draft.paint(space, upright(rect, [0.0, CEILING]));
        }
        if room.name == "Living room" {
            chimney(&mut draft, space);
        }
    }
    for hole in &HOLES {
        pierce(&mut draft, hole, walls[hole.wall], options.seed);
    }
    for (room, [x, y], candela) in LAMPS {
        let at = [x, y, CEILING].map(units);
        draft.point_light(&format!("{} light", ROOMS[room].name), [at[0], at[1], units(2.35)], candela);
        if options.furniture {
            furnish::lamp(&mut draft, ROOMS[room].name, at);
        }
    }
    if options.furniture {
        furnish::house(&mut draft);
    }
    draft.camera("Living room", [5.2, 0.75, 1.6], [2.0, 5.2, 1.05], 62.0);
    views::outside(&mut draft, "Garden", [[-0.5, -2.3, 0.0], [SIZE[0], 11.2, ROOF[1]]]);
    draft.finish()
}

fn upright([west, south, east, north]: Rect, [low, high]: [f64; 2]) -> Cuboid {
    Cuboid::new([west, south, low], [east, north, high])
}

/// Slabs, roof, terrace and its columns.
fn shell(draft: &mut Draft) {
    let concrete =
        Look { core: palette::CONCRETE, outside: palette::CONCRETE, top: palette::STONE, ..Look::default() };
    let mut slab = |name: &str, kind: &str, rect: Rect, z: [f64; 2]| {
        let slab = draft.element(Kind::Solid, Semantic::Ground, "IfcSlab", name);
        draft.look(slab, concrete);
        draft.extra(slab, "predefined_type", kind);
        draft.paint(slab, upright(rect, z));
    };
    let footprint = [0.0, 0.0, SIZE[0], SIZE[1]];
    slab("Floor slab", "BASESLAB", footprint, [BOTTOM, 0.0]);
    slab("Ceiling slab", "FLOOR", footprint, [CEILING, ROOF[0]]);
    slab("Terrace", "PAVING", [-0.5, -2.3, 6.6, 0.0], [BOTTOM, TERRACE]);
    slab("Entrance step", "PAVING", [3.7, 10.0, 5.7, 11.2], [BOTTOM, TERRACE]);

    let roof = draft.element(Kind::Solid, Semantic::Roof, "IfcRoof", "Flat roof");
    let look =
        Look { core: palette::CONCRETE, outside: palette::ZINC, top: palette::GRAVEL, ..Look::default() };
    draft.look(roof, look);
    let edge = draft.element(Kind::Solid, Semantic::Roof, "IfcRoof", "Roof edge");
    draft.look(
        edge,
        Look { core: palette::ZINC, outside: palette::ZINC, top: palette::ZINC, ..Look::default() },
    );
    // The roof overhangs by half a metre, and covers the terrace; a low rim runs around it.
    let overhang = [[-0.5, -0.5, 12.5, 10.5], [-0.5, -2.5, 6.8, 0.0]];
    for rect in overhang {
        draft.paint(roof, upright(rect, ROOF));
        draft.paint(edge, upright(rect, [ROOF[1], ROOF[1] + 0.12]));
    }
    let rim = 0.15;
    for [west, south, east, north] in [overhang[0], [-0.5, -2.5, 6.8, 0.5]] {
        let within = [west + rim, south + rim, east - rim, north - rim];
        draft.paint(Draft::EXTERIOR, upright(within, [ROOF[1], ROOF[1] + 0.12]));
    }
    for (name, x) in [("Column west", -0.2), ("Column middle", 3.0), ("Column east", 6.2)] {
        let column = draft.element(Kind::Solid, Semantic::Column, "IfcColumn", name);
        draft
            .look(column, Look { outside: palette::WHITE_PAINT, core: palette::CONCRETE, ..Look::default() });
        draft.paint(column, upright([x, -2.15, x + 0.24, -1.91], [TERRACE, ROOF[0]]));
    }
}

fn wall(draft: &mut Draft, name: &str, rect: Rect, is_outer: bool) -> u32 {
    let wall = draft.element(Kind::Solid, Semantic::Wall, "IfcWallStandardCase", name);
    draft.extra(wall, "is_external", if is_outer { "true" } else { "false" });
    draft.paint(wall, upright(rect, [0.0, CEILING]));
    wall
}

/// A brick chimney through the roof, with a hearth in the living room.
fn chimney(draft: &mut Draft, living: u32) {
    let chimney = draft.element(Kind::Solid, Semantic::Wall, "IfcWall", "Chimney");
    let brick = Look {
        outside: palette::MASONRY,
        top: palette::MASONRY,
        inside: Some(palette::MASONRY),
        ..Look::default()
    };
    draft.look(chimney, brick);
    draft.paint(chimney, upright([5.70, 1.90, 6.30, 2.90], [0.0, 4.4]));
    draft.paint(living, upright([5.70, 2.10, 6.10, 2.70], [0.15, 0.75]));
}

/// Makes a hole in a wall and fills it.
fn pierce(draft: &mut Draft, plan: &HolePlan, wall: u32, seed: u64) {
    let (_, [west, south, east, north], _) = WALLS[plan.wall];
    let [from, to] = plan.along;
    let along_x = plan.inside.is_multiple_of(2);
    let rect = if along_x { [from, south, to, north] } else { [west, from, east, to] };
    let space = upright(rect, [plan.sill, HEAD]);
    let HolePlan { name, inside, filling, .. } = *plan;
    let hole = Hole { name, space, inside, filling, threshold: palette::OAK_FLOOR };
    holes::pierce(draft, &hole, wall, seed);
}
