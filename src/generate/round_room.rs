//! A hall with round walls, as the room of Fig. 10 of Maria, Horna and Aveneau (GRAPP 2014): what it costs to cut such a room shows how well
//! that is done.

use crate::importers::Semantic;

use super::building::{Building, Kind};
use super::draft::Draft;
use super::lattice::{Cuboid, units};
use super::palette::{self, Look};

/// What [`round_room`] makes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct RoundRoomOptions {
    /// Identities follow from it.
    pub seed: u64,
}

/// Facets of the round walls in all.
const FACETS: usize = 64;
/// The hall inside, metres: west, south, east, north.
const HALL: [f64; 4] = [0.0, 0.0, 12.0, 9.0];
const WALL: f64 = 0.3;
const CEILING: f64 = 3.0;
const SLAB: f64 = 0.3;
/// Round stair towers that stand half in the hall: middle and radius, metres, and the direction of the wall that they stand in: degrees.
const TOWERS: [([f64; 2], f64, f64); 2] = [([0.0, 4.5], 2.2, 0.0), ([7.2, 9.0], 2.2, 270.0)];
/// The door: from where to where along the southern wall, and its head.
const DOOR: [f64; 2] = [8.6, 9.7];
const HEAD: f64 = 2.1;

/// A hall of 12 by 9 metres into which two towers of round masonry bulge, 32 facets each; one door.
///
/// Of a hall with a round wall that bulges outward there is nothing to cut: it is convex. Each corner of a wall that bulges inward is reflex.
pub fn round_room(options: &RoundRoomOptions) -> Building {
    let [west, south, east, north] = HALL;
    let (bottom, top) = (-SLAB, CEILING + SLAB);
    let around = 4.0;
    let hull =
        Cuboid::new([west - around, south - around, bottom], [east + around, north + around, top + 2.0]);
    let mut draft = Draft::new("Round room", options.seed, hull);
    draft.storey("Level 0");
    let concrete =
        Look { core: palette::CONCRETE, outside: palette::CONCRETE, top: palette::STONE, ..Look::default() };
    let mut solid = |semantic: Semantic, class: &str, name: &str, look: Look| {
        let element = draft.element(Kind::Solid, semantic, class, name);
        draft.look(element, look);
        element
    };
    let floor = solid(Semantic::Ground, "IfcSlab", "Floor slab", concrete);
    let roof = solid(Semantic::Roof, "IfcRoof", "Flat roof", concrete);
    let masonry = Look { outside: palette::MASONRY, core: palette::MASONRY, ..Look::default() };
    let walls = ["south", "east", "north", "west"]
        .map(|side| solid(Semantic::Wall, "IfcWallStandardCase", &format!("Outer wall {side}"), masonry));
    let towers = [1, 2].map(|k| solid(Semantic::Wall, "IfcWall", &format!("Round wall {k}"), masonry));
    let room = draft.element(Kind::Room, Semantic::Room, "IfcSpace", "Hall");
    draft.look(room, Look { floor: palette::STONE, walls: palette::PLASTER, ..Look::default() });
    let door = draft.element(Kind::Opening, Semantic::Door, "IfcOpeningElement", "Entrance opening");
    draft.look(door, Look { floor: palette::STONE, ceiling: palette::PLASTER, ..Look::default() });
    draft.fill(walls[0], door, None);

    let z = [bottom, 0.0, CEILING, top].map(units);
    let storey = |element: u32| [([z[0], z[1]], floor), ([z[1], z[2]], element), ([z[2], z[3]], roof)];
    let mut rectangle = |[x0, y0, x1, y1]: [f64; 4], layers: &[([i32; 2], u32)]| {
        let outline = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|p| p.map(units));
        draft.region(&outline, layers);
    };
    rectangle([west - WALL, south - WALL, DOOR[0], south], &storey(walls[0]));
    let mut at_door = storey(walls[0]).to_vec();
    at_door.push(([z[1], units(HEAD)], door));
    rectangle([DOOR[0], south - WALL, DOOR[1], south], &at_door);
    rectangle([DOOR[1], south - WALL, east + WALL, south], &storey(walls[0]));
    rectangle([east, south, east + WALL, north], &storey(walls[1]));
    rectangle([west - WALL, north, east + WALL, north + WALL], &storey(walls[2]));
    rectangle([west - WALL, south, west, north], &storey(walls[3]));

    // From the western tower's lower end about it, and so on, the hall on the left.
    let arcs = TOWERS.map(|(middle, radius, degrees)| arc(middle, radius, degrees));
    let mut hall = vec![[west, south], [east, south], [east, north]]
        .into_iter()
        .map(|p| p.map(units))
        .collect::<Vec<_>>();
    hall.extend(arcs[1].iter().rev());
    hall.push([west, north].map(units));
    hall.extend(arcs[0].iter().rev());
    draft.region(&hall, &storey(room));
    for (arc, tower) in arcs.iter().zip(towers) {
        draft.region(arc, &storey(tower));
    }
    draft.point_light("Hall light", [6.0, 4.0, 2.6].map(units), 400.0);
    draft.camera("Hall", [11.2, 0.8, 1.6], [4.0, 6.0, 1.4], 75.0);
    draft.camera("Tower", [2.0, 1.0, 1.6], [6.0, 8.0, 1.4], 75.0);
    draft.finish()
}

/// Half a circle of half the facets, counter-clockwise, about the direction into the hall.
fn arc([x, y]: [f64; 2], radius: f64, degrees: f64) -> Vec<[i32; 2]> {
    let facets = FACETS / TOWERS.len();
    (0..=facets)
        .map(|k| {
            let angle = (degrees - 90.0 + 180.0 * k as f64 / facets as f64).to_radians();
            [x + radius * libm::cos(angle), y + radius * libm::sin(angle)].map(units)
        })
        .collect()
}
