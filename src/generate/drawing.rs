//! Drawing a building storey by storey from its wings' plans.

use std::collections::BTreeMap;

use twox_hash::XxHash3_64;

use crate::importers::Semantic;

use super::building::{Building, Kind};
use super::complex::{
    AROUND, BOTTOM, CLEAR, Complex, GROUND, MODULE, PlacedWing, Roof, SLAB, STOREY, room_areas, share,
};
use super::draft::Draft;
use super::furnish;
use super::holes::{self, Filling, Hole};
use super::interior::{self, Furnisher, Room, Window};
use super::joinery::standing;
use super::lattice::{Cuboid, Rect};
use super::palette::{self, Look};
use super::plan::Plan;
use super::stair::StairPlan;
use super::uses::Use;
use super::wing::{HolePlan, Modules, RoomPlan, Storey, WallPlan, Wing};

/// The names of storeys.
pub(super) fn storey_name(k: usize) -> String {
    if k == 0 { "Ground floor".to_owned() } else { format!("Storey {k}") }
}

/// Draws a building.
pub fn draw(complex: &Complex) -> Building {
    let mut drawing = Drawing::new(complex);
    for (index, wing) in complex.wings.iter().enumerate() {
        drawing.wing(index, wing);
    }
    if let Some(apse) = complex.apse {
        drawing.apse(apse);
    }
    for foyer in &complex.foyers {
        drawing.foyer(foyer);
    }
    drawing.cameras();
    drawing.draft.finish()
}

/// A building being drawn.
pub(super) struct Drawing<'a> {
    pub(super) complex: &'a Complex,
    pub(super) draft: Draft,
    pub(super) hull: Cuboid,
    /// Lights for each room, in the order in which rooms are drawn.
    pub(super) lights: std::vec::IntoIter<usize>,
    /// How many rooms have been numbered on each storey.
    pub(super) numbers: BTreeMap<usize, usize>,
    pub(super) furnisher: Furnisher,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(complex: &'a Complex) -> Drawing<'a> {
        let mut corners: Vec<[i32; 2]> = Vec::new();
        for wing in &complex.wings {
            let [l, d] = wing.size();
            corners.extend([[0, 0], [l, 0], [l, d], [0, d]].map(|p| wing.place(p)));
        }
        if let (Some(apse), Some(wing)) = (complex.apse, complex.wings.first()) {
            corners.push([wing.origin[0] - apse.radius * MODULE, wing.origin[1]]);
        }
        let bound = |axis: usize, pick: fn(i32, i32) -> i32| {
            corners.iter().map(|c| c[axis]).reduce(pick).unwrap_or(0)
        };
        let storeys = complex.wings.iter().map(|w| w.storeys.len()).max().unwrap_or(1) as i32;
        let gable = complex
            .wings
            .iter()
            .filter(|w| w.roof == Roof::Gable)
            .map(|w| w.size()[1] / 2)
            .max()
            .unwrap_or(0);
        let edge = AROUND * MODULE;
        let hull = Cuboid {
            lo: [bound(0, i32::min) - edge, bound(1, i32::min) - edge, BOTTOM * MODULE],
            hi: [
                bound(0, i32::max) + edge,
                bound(1, i32::max) + edge,
                (storeys * STOREY + 40) * MODULE + gable,
            ],
        };
        let mut draft = Draft::new(&complex.name, complex.seed, hull);
        let ground = draft.element(Kind::Solid, Semantic::Site, "IfcSite", "Site");
        draft.look(
            ground,
            Look { top: palette::GRASS, outside: palette::GRASS, core: palette::GRASS, ..Look::default() },
        );
        draft.fill_world(ground, [hull.lo[2], GROUND * MODULE]);
        let lights = share(complex.lights, &room_areas(complex)).into_iter();
        Drawing { complex, draft, hull, lights, numbers: BTreeMap::new(), furnisher: Furnisher::new() }
    }

    /// A name no other room of the building has.
    pub(super) fn room_name(&mut self, storey: usize, use_: Use) -> String {
        let number = self.numbers.entry(storey).or_insert(0);
        *number += 1;
        format!("{} {storey}.{number:03}", use_.title())
    }

    pub(super) fn wing(&mut self, index: usize, placed: &PlacedWing) {
        let [length, depth] = placed.size();
        let footprint = Rect { lo: [0; 2], hi: [length, depth] };
        self.draft.begin_sheet(placed.embedding(), footprint);
        // The air of each bay of the storey below: a hall goes on above.
        let mut below: BTreeMap<(usize, usize), u32> = BTreeMap::new();
        for (k, wing) in placed.storeys.iter().enumerate() {
            self.draft.storey(&storey_name(k));
            let floor = Floor { placed, wing, plan: wing.storey(), k, z: k as i32 * STOREY * MODULE };
            let slab = self.slab(&format!("{} slab {k}", placed.name), footprint, floor.z);
            let walls = self.walls(&floor);
            let rooms = self.rooms(&floor);
            self.halls(&floor, &below);
            let bays = floor.plan.rooms.iter().zip(&rooms);
            below = bays.filter_map(|(room, &element)| Some((room.bay?, element))).collect();
            self.holes(&floor, &walls);
            self.stairs(&floor, slab);
            if index == 0 {
                self.ways(&floor, &walls);
            }
        }
        match placed.roof {
            Roof::Flat => self.flat_roof(placed, footprint),
            Roof::Gable => self.gable_roof(placed, footprint),
        }
    }

    /// A slab whose top is at `z`.
    pub(super) fn slab(&mut self, name: &str, rect: Rect, z: i32) -> u32 {
        let slab = self.slab_without_extent(name, z);
        self.draft.paint(slab, upright(rect, [z - SLAB * MODULE, z]));
        slab
    }

    pub(super) fn slab_without_extent(&mut self, name: &str, z: i32) -> u32 {
        self.slab_of(name, Semantic::Ground, if z == 0 { "BASESLAB" } else { "FLOOR" })
    }

    /// The slab over an uppermost storey, without extent.
    pub(super) fn roof_slab(&mut self, name: &str) -> u32 {
        self.slab_of(name, Semantic::Roof, "ROOF")
    }

    fn slab_of(&mut self, name: &str, semantic: Semantic, predefined_type: &str) -> u32 {
        let slab = self.draft.element(Kind::Solid, semantic, "IfcSlab", name);
        let look = Look {
            core: palette::CONCRETE,
            outside: palette::CONCRETE,
            top: palette::STONE,
            ..Look::default()
        };
        self.draft.look(slab, look);
        self.draft.extra(slab, "predefined_type", predefined_type);
        slab
    }

    pub(super) fn wall(&mut self, name: &str, is_outer: bool) -> u32 {
        let wall = self.draft.element(Kind::Solid, Semantic::Wall, "IfcWallStandardCase", name);
        self.draft.extra(wall, "is_external", if is_outer { "true" } else { "false" });
        wall
    }

    pub(super) fn walls(&mut self, floor: &Floor<'_>) -> Vec<u32> {
        let draw = |wall: &WallPlan| {
            let element = self.wall(&floor.name(&wall.name), wall.is_outer);
            self.draft.paint(element, upright(floor.rect(&wall.rect), floor.heights()));
            element
        };
        floor.plan.walls.iter().map(draw).collect()
    }

    pub(super) fn rooms(&mut self, floor: &Floor<'_>) -> Vec<u32> {
        let mut elements = Vec::new();
        for (index, room) in floor.plan.rooms.iter().enumerate() {
            let name = self.room_name(floor.k, room.use_);
            let space = self.space(&name, room.use_);
            elements.push(space);
            let rects: Vec<Rect> = room.rects.iter().map(|r| floor.rect(r)).collect();
            for &rect in &rects {
                self.draft.paint(space, upright(rect, floor.heights()));
            }
            let mut solids = self.columns(&name, room, floor);
            if floor.goes_up() && room.use_ == Use::Stair {
                solids.extend(floor.stair(room).map(|stair| floor.rect(&stair.flights())));
            }
            let doors = floor.plan.clear_of_doors(index);
            let clear = doors.iter().map(|r| floor.rect(r)).chain(self.clear_of_ways(floor)).collect();
            let windows = floor.plan.windows_of(index).map(|hole| floor.window(hole)).collect();
            self.furnish(&Furnished {
                name: &name,
                use_: room.use_,
                rects,
                solids,
                clear,
                windows,
                heights: floor.heights(),
            });
        }
        elements
    }

    /// The air of a room, without extent yet.
    pub(super) fn space(&mut self, name: &str, use_: Use) -> u32 {
        let space = self.draft.element(Kind::Room, Semantic::Room, "IfcSpace", name);
        let [floor, walls] = use_.materials();
        self.draft.look(space, Look { floor, walls, ..Look::default() });
        space
    }

    /// Columns in a large room: returns their plans.
    pub(super) fn columns(&mut self, name: &str, room: &RoomPlan, floor: &Floor<'_>) -> Vec<Rect> {
        /// From one column to the next, modules.
        const SPACING: i32 = 48;
        let [west, south, east, north] = room.rects[0];
        if !room.use_.has_columns() || room.rects.len() > 1 || east - west < SPACING + 20 {
            return Vec::new();
        }
        let count = (east - west) / SPACING;
        let middle = (south + north) / 2;
        let above = floor.placed.storeys.get(floor.k + 1);
        let is_tall =
            room.bay.is_some_and(|(row, bay)| above.is_some_and(|w| w.bays[row][bay].room.is_none()));
        let top = floor.heights()[1] + if is_tall { STOREY * MODULE } else { 0 };
        let draw = |i: i32| {
            let x = west + (east - west) * i / (count + 1);
            let rect = floor.rect(&[x - 2, middle - 2, x + 2, middle + 2]);
            let name = format!("{name} column {i}");
            let column = self.draft.element(Kind::Solid, Semantic::Column, "IfcColumn", &name);
            self.draft.look(column, Look { core: palette::CONCRETE, ..Look::default() });
            self.draft.paint_last(column, upright(rect, [floor.z, top]));
            rect
        };
        (1..=count).map(draw).collect()
    }

    /// The upper halves of halls: above a room where this storey has none.
    pub(super) fn halls(&mut self, floor: &Floor<'_>, below: &BTreeMap<(usize, usize), u32>) {
        for row in 0..2 {
            for (i, bay) in floor.wing.bays[row].iter().enumerate() {
                if let (None, Some(&hall)) = (bay.room, below.get(&(row, i))) {
                    let ([x0, x1], [y0, y1]) = (floor.wing.bay_span(row, i), floor.wing.room_rows(row));
                    let heights = [floor.z - SLAB * MODULE, floor.heights()[1]];
                    self.draft.paint(hall, upright(floor.rect(&[x0, y0, x1, y1]), heights));
                }
            }
        }
    }

    pub(super) fn holes(&mut self, floor: &Floor<'_>, walls: &[u32]) {
        for plan in &floor.plan.holes {
            // The front door of a hall is on the ground.
            if floor.k > 0 && plan.name.starts_with("Entrance") {
                continue;
            }
            let space = upright(floor.rect(&plan.rect), plan.heights.map(|h| floor.z + h * MODULE));
            let name = floor.name(&plan.name);
            self.pierce(&name, space, plan.inside, plan.filling, walls[plan.wall]);
        }
    }

    pub(super) fn pierce(&mut self, name: &str, space: Cuboid, inside: u8, filling: Filling, wall: u32) {
        let hole = Hole { name, space, inside, filling, threshold: palette::FLOOR_TILES };
        holes::pierce(&mut self.draft, &hole, wall, self.complex.seed);
    }

    /// Flights up from this storey, and the holes of those from below through its slab.
    pub(super) fn stairs(&mut self, floor: &Floor<'_>, slab: u32) {
        for room in floor.plan.rooms.iter().filter(|room| room.use_ == Use::Stair) {
            let Some(stair) = floor.stair(room) else { continue };
            let name = |what: &str| floor.name(&format!("{what} {}", room.rects[0][0]));
            if floor.k > 0 {
                self.stairwell(&name("Stairwell"), floor.rect(&stair.well()), floor.z, slab);
            }
            if floor.goes_up() {
                let flights = self.draft.element(Kind::Detail, Semantic::Stair, "IfcStair", &name("Stair"));
                let boxes = stair.boxes(STOREY).into_iter().map(|(rect, [z0, z1])| {
                    let cuboid = upright(floor.rect(&rect), [z0, z1].map(|z| floor.z + z * MODULE));
                    (cuboid, Some(palette::STONE))
                });
                self.draft.detail(flights, Plan::of_boxes(&boxes.collect::<Vec<_>>()));
            }
        }
    }

    /// A hole through the slab whose top is at `z`.
    pub(super) fn stairwell(&mut self, name: &str, rect: Rect, z: i32, slab: u32) {
        let opening = self.draft.element(Kind::Opening, Semantic::Opening, "IfcOpeningElement", name);
        self.draft.paint(opening, upright(rect, [z - SLAB * MODULE, z]));
        self.draft.fill(slab, opening, None);
    }

    /// A ceiling lamp and its light.
    pub(super) fn lamp(&mut self, name: &str, at: [i32; 3]) {
        /// Candela: a luminaire of about 1,500 lumen.
        const BRIGHTNESS: f32 = 120.0;
        self.draft.point_light(&format!("{name} light"), [at[0], at[1], at[2] - 3 * MODULE], BRIGHTNESS);
        if self.complex.furniture {
            furnish::lamp(&mut self.draft, name, at);
        }
    }

    /// Hangs a room's lamps and puts its furniture in.
    pub(super) fn furnish(&mut self, furnished: &Furnished<'_>) {
        let Furnished { name, use_, heights: [floor, ceiling], .. } = *furnished;
        let seed = XxHash3_64::oneshot_with_seed(self.complex.seed, name.as_bytes());
        let room = Room {
            use_,
            rects: &furnished.rects,
            solids: &furnished.solids,
            floor,
            ceiling,
            keep_clear: &furnished.clear,
            windows: &furnished.windows,
            fullness: self.complex.fullness,
            seed,
        };
        let lights = self.lights.next().unwrap_or(1);
        for (i, at) in interior::lamps(&room, lights).into_iter().enumerate() {
            self.lamp(&format!("{name} {}", i + 1), at);
        }
        if !self.complex.furniture {
            return;
        }
        for placed in self.furnisher.furnish(&room) {
            let name = format!("{name} {}", placed.name);
            let element = self.draft.element(Kind::Detail, placed.semantic, placed.class, &name);
            self.draft.detail(element, standing(&placed.place, &placed.piece.boxes));
        }
    }
}

/// A storey of a wing, being drawn.
pub(super) struct Floor<'a> {
    pub(super) placed: &'a PlacedWing,
    pub(super) wing: &'a Wing,
    pub(super) plan: Storey,
    pub(super) k: usize,
    /// Height of its floor, units.
    pub(super) z: i32,
}

impl Floor<'_> {
    pub(super) fn name(&self, what: &str) -> String {
        format!("{} {what} {}", self.placed.name, self.k)
    }

    pub(super) fn rect(&self, rect: &Modules) -> Rect {
        let [west, south, east, north] = rect.map(|c| c * self.placed.module());
        Rect { lo: [west, south], hi: [east, north] }
    }

    /// Floor and ceiling.
    pub(super) fn heights(&self) -> [i32; 2] {
        [self.z, self.z + CLEAR * MODULE]
    }

    /// Whether stairs lead on from here.
    pub(super) fn goes_up(&self) -> bool {
        self.k + 1 < self.placed.storeys.len() || self.placed.roof == Roof::Gable
    }

    pub(super) fn stair(&self, room: &RoomPlan) -> Option<StairPlan> {
        let (row, _) = room.bay?;
        StairPlan::new(room.rects[0], row == 0)
    }

    /// A window as its room sees it.
    pub(super) fn window(&self, hole: &HolePlan) -> Window {
        let Rect { lo, hi } = self.rect(&hole.rect);
        let (from, to) = match hole.inside {
            0 => ([lo[0], hi[1]], hi),
            1 => (lo, [lo[0], hi[1]]),
            2 => (lo, [hi[0], lo[1]]),
            _ => ([hi[0], lo[1]], hi),
        };
        Window { from, to, sill: self.z + hole.heights[0] * MODULE }
    }
}

/// A room to be furnished.
pub(super) struct Furnished<'a> {
    pub(super) name: &'a str,
    pub(super) use_: Use,
    pub(super) rects: Vec<Rect>,
    pub(super) solids: Vec<Rect>,
    pub(super) clear: Vec<Rect>,
    pub(super) windows: Vec<Window>,
    pub(super) heights: [i32; 2],
}

/// A box over a rectangle of the plan, between two heights.
pub(super) fn upright(rect: Rect, [low, high]: [i32; 2]) -> Cuboid {
    Cuboid { lo: [rect.lo[0], rect.lo[1], low], hi: [rect.hi[0], rect.hi[1], high] }
}
