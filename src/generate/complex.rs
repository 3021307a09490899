//! Buildings of several wings: drawn storey by storey from the wings' plans.

use std::collections::BTreeMap;

use twox_hash::XxHash3_64;

use crate::importers::Semantic;

use super::building::{Building, Kind};
use super::draft::Draft;
use super::furnish;
use super::holes::{self, Filling, Hole};
use super::interior::{self, Furnisher, Room, Window};
use super::joinery::standing;
use super::lattice::{Cuboid, Rect, metres};
use super::palette::{self, Look};
use super::plan::{Paint, Plan, Slope, Top};
use super::sheet::{Embedding, Turn};
use super::stair::StairPlan;
use super::uses::Use;
use super::wing::{HolePlan, Modules, OUTER, RoomPlan, Storey, WallPlan, Wing, area};

/// A module of the drawing, units: a multiple of eight, so that roofs may slope by halves, quarters and eighths.
pub const MODULE: i32 = 104;
/// From floor to floor, modules.
pub const STOREY: i32 = 32;
/// Thickness of slabs, modules.
pub const SLAB: i32 = 3;
/// From floor to ceiling, modules.
pub const CLEAR: i32 = STOREY - SLAB;
/// Top of the ground around, modules.
const GROUND: i32 = -1;
/// Bottom of the world, modules.
const BOTTOM: i32 = -6;
/// Height of parapets and of an attic's eaves over its floor, modules.
const PARAPET: i32 = 5;
/// Width of the world's edge around the building, modules.
const AROUND: i32 = 100;

/// A roof.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roof {
    /// Flat, with a parapet.
    Flat,
    /// Two slopes of one in two, over an attic.
    Gable,
}

/// A wing in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedWing {
    /// Its name, in front of all names in it.
    pub name: String,
    /// Its plan on each storey, from the ground up; all of the same size.
    pub storeys: Vec<Wing>,
    /// Where its south-west corner lies, units.
    pub origin: [i32; 2],
    /// How it is turned.
    pub turn: Turn,
    /// What covers it.
    pub roof: Roof,
}

/// Half a round building against the west end of the first wing, at its corridor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Apse {
    /// Its outer radius, modules.
    pub radius: i32,
    /// How many facets its wall has.
    pub facets: i32,
}

/// A three-cornered foyer between the north facade of the first wing and the west end of another, whose south-west
/// corner lies on that facade.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Foyer {
    /// The other wing.
    pub wing: usize,
    /// Where the foyer's west corner lies on the facade, units along the first wing.
    pub west: i32,
}

/// A building of wings.
#[derive(Clone, Debug, PartialEq)]
pub struct Complex {
    /// Its name.
    pub name: String,
    /// The wings; the first is not turned and lies at the origin.
    pub wings: Vec<PlacedWing>,
    /// Passages through the first wing's north wall, on all storeys: from where to where along it, units.
    pub ways: Vec<[i32; 2]>,
    /// Foyers to oblique wings.
    pub foyers: Vec<Foyer>,
    /// A round end.
    pub apse: Option<Apse>,
    /// Point lights in all, shared among the rooms by their area; each has at least one.
    pub lights: usize,
    /// Put furniture, sanitary ware and lamps into the rooms.
    pub furniture: bool,
    /// How much furniture, per cent of what is usual.
    pub fullness: u32,
    /// Identities, furniture, and how far the doors stand open, follow from it.
    pub seed: u64,
}

impl PlacedWing {
    /// A module along the wing, units: a multiple of the turn's denominator, so that corners fall on the grid.
    pub fn module(&self) -> i32 {
        let whole = self.turn.whole;
        if whole == 1 { MODULE } else { whole * ((MODULE + whole / 2) / whole).max(1) }
    }

    /// Its outer length and depth, units.
    pub fn size(&self) -> [i32; 2] {
        self.storeys.first().map_or([0; 2], |wing| wing.size().map(|m| m * self.module()))
    }

    /// Where its roof begins, units.
    fn top(&self) -> i32 {
        self.storeys.len() as i32 * STOREY * MODULE
    }

    fn embedding(&self) -> Embedding {
        Embedding::Turned { origin: self.origin, turn: self.turn }
    }

    /// Where a point of its frame, units, lies.
    pub fn place(&self, point: [i32; 2]) -> [i32; 2] {
        self.embedding().place(point)
    }
}

/// The names of storeys.
fn storey_name(k: usize) -> String {
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
struct Drawing<'a> {
    complex: &'a Complex,
    draft: Draft,
    hull: Cuboid,
    /// Lights for each room, in the order in which rooms are drawn.
    lights: std::vec::IntoIter<usize>,
    /// How many rooms have been numbered on each storey.
    numbers: BTreeMap<usize, usize>,
    furnisher: Furnisher,
}

impl<'a> Drawing<'a> {
    fn new(complex: &'a Complex) -> Drawing<'a> {
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
    fn room_name(&mut self, storey: usize, use_: Use) -> String {
        let number = self.numbers.entry(storey).or_insert(0);
        *number += 1;
        format!("{} {storey}.{number:03}", use_.title())
    }

    fn wing(&mut self, index: usize, placed: &PlacedWing) {
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
    fn slab(&mut self, name: &str, rect: Rect, z: i32) -> u32 {
        let slab = self.slab_without_extent(name, z);
        self.draft.paint(slab, upright(rect, [z - SLAB * MODULE, z]));
        slab
    }

    fn slab_without_extent(&mut self, name: &str, z: i32) -> u32 {
        let slab = self.draft.element(Kind::Solid, Semantic::Ground, "IfcSlab", name);
        let look = Look {
            core: palette::CONCRETE,
            outside: palette::CONCRETE,
            top: palette::STONE,
            ..Look::default()
        };
        self.draft.look(slab, look);
        self.draft.extra(slab, "predefined_type", if z == 0 { "BASESLAB" } else { "FLOOR" });
        slab
    }

    fn wall(&mut self, name: &str, is_outer: bool) -> u32 {
        let wall = self.draft.element(Kind::Solid, Semantic::Wall, "IfcWallStandardCase", name);
        self.draft.extra(wall, "is_external", if is_outer { "true" } else { "false" });
        wall
    }

    fn walls(&mut self, floor: &Floor<'_>) -> Vec<u32> {
        let draw = |wall: &WallPlan| {
            let element = self.wall(&floor.name(&wall.name), wall.is_outer);
            self.draft.paint(element, upright(floor.rect(&wall.rect), floor.heights()));
            element
        };
        floor.plan.walls.iter().map(draw).collect()
    }

    fn rooms(&mut self, floor: &Floor<'_>) -> Vec<u32> {
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
    fn space(&mut self, name: &str, use_: Use) -> u32 {
        let space = self.draft.element(Kind::Room, Semantic::Room, "IfcSpace", name);
        let [floor, walls] = use_.materials();
        self.draft.look(space, Look { floor, walls, ..Look::default() });
        space
    }

    /// Columns in a large room: returns their plans.
    fn columns(&mut self, name: &str, room: &RoomPlan, floor: &Floor<'_>) -> Vec<Rect> {
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
    fn halls(&mut self, floor: &Floor<'_>, below: &BTreeMap<(usize, usize), u32>) {
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

    fn holes(&mut self, floor: &Floor<'_>, walls: &[u32]) {
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

    fn pierce(&mut self, name: &str, space: Cuboid, inside: u8, filling: Filling, wall: u32) {
        let hole = Hole { name, space, inside, filling, threshold: palette::FLOOR_TILES };
        holes::pierce(&mut self.draft, &hole, wall, self.complex.seed);
    }

    /// Flights up from this storey, and the holes of those from below through its slab.
    fn stairs(&mut self, floor: &Floor<'_>, slab: u32) {
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
    fn stairwell(&mut self, name: &str, rect: Rect, z: i32, slab: u32) {
        let opening = self.draft.element(Kind::Opening, Semantic::Opening, "IfcOpeningElement", name);
        self.draft.paint(opening, upright(rect, [z - SLAB * MODULE, z]));
        self.draft.fill(slab, opening, None);
    }

    /// Passages from the first wing to those that stand against its north facade.
    fn ways(&mut self, floor: &Floor<'_>, walls: &[u32]) {
        let Some(north) = floor.plan.walls.iter().position(|wall| wall.name == "Outer wall north") else {
            return;
        };
        for (i, &[west, east]) in self.complex.ways.iter().enumerate() {
            let [_, south, _, north_side] = floor.plan.walls[north].rect.map(|c| c * MODULE);
            let rect = Rect { lo: [west, south], hi: [east, north_side] };
            let space = upright(rect, [floor.z, floor.z + 23 * MODULE]);
            self.pierce(&floor.name(&format!("Way {}", i + 1)), space, 0, Filling::Nothing, walls[north]);
        }
    }

    /// The floor in front of ways between wings.
    fn clear_of_ways(&self, floor: &Floor<'_>) -> Vec<Rect> {
        let [_, depth] = floor.placed.size();
        let before = 12 * floor.placed.module();
        if floor.placed.origin == [0, 0] {
            let inside = depth - OUTER * MODULE;
            let way = |&[west, east]: &[i32; 2]| Rect { lo: [west, inside - before], hi: [east, inside] };
            return self.complex.ways.iter().map(way).collect();
        }
        let [south, north] = floor.wing.corridor_rows().map(|m| m * floor.placed.module());
        vec![Rect { lo: [0, south], hi: [before, north] }]
    }

    /// The slab over the uppermost storey, gravel, and a parapet.
    fn flat_roof(&mut self, placed: &PlacedWing, footprint: Rect) {
        let top = placed.top();
        self.slab(&format!("{} roof slab", placed.name), footprint, top);
        let roof = self.roof(&format!("{} roof", placed.name));
        self.draft.paint(roof, upright(footprint, [top, top + MODULE]));
        let parapet = self.wall(&format!("{} parapet", placed.name), true);
        let ([l, d], t) = (footprint.hi, OUTER * placed.module());
        for rect in [[0, 0, l, t], [0, d - t, l, d], [0, t, t, d - t], [l - t, t, l, d - t]] {
            let rect = Rect { lo: [rect[0], rect[1]], hi: [rect[2], rect[3]] };
            self.draft.paint(parapet, upright(rect, [top, top + PARAPET * MODULE]));
        }
    }

    fn roof(&mut self, name: &str) -> u32 {
        let roof = self.draft.element(Kind::Solid, Semantic::Roof, "IfcRoof", name);
        let look =
            Look { core: palette::CONCRETE, outside: palette::ZINC, top: palette::GRAVEL, ..Look::default() };
        self.draft.look(roof, look);
        roof
    }

    /// An attic under two slopes of one in two, between gable walls.
    fn gable_roof(&mut self, placed: &PlacedWing, footprint: Rect) {
        let (top, [l, d], t) = (placed.top(), footprint.hi, OUTER * MODULE);
        let slab = self.slab(&format!("{} attic slab", placed.name), footprint, top);
        self.draft.storey("Attic");
        let under = |raised: i32| {
            let eaves = 2 * i64::from(top + PARAPET * MODULE + raised);
            [
                Top::Slope(Slope { run: [0, 1], rise: eaves, per: 2 }),
                Top::Slope(Slope { run: [0, -1], rise: eaves + i64::from(d), per: 2 }),
            ]
        };
        let (inside, outside) = (under(0), under(3 * MODULE));
        let halves = [[0, d / 2], [d / 2, d]];
        let roof = self.roof(&format!("{} roof", placed.name));
        let tiles = Look {
            core: palette::BEECH,
            outside: palette::MASONRY,
            top: palette::MASONRY,
            ..Look::default()
        };
        self.draft.look(roof, tiles);
        let name = self.room_name(placed.storeys.len(), Use::Attic);
        let attic = self.space(&name, Use::Attic);
        let sides =
            ["south", "north"].map(|side| self.wall(&format!("{} attic wall {side}", placed.name), true));
        let gables = ["west", "east"].map(|end| self.wall(&format!("{} gable {end}", placed.name), true));
        for (half, &[y0, y1]) in halves.iter().enumerate() {
            let mut paint = |label: u32, [x0, x1]: [i32; 2], [y0, y1]: [i32; 2], sides: [Top; 2]| {
                let rect = Rect { lo: [x0, y0], hi: [x1, y1] };
                self.draft.paint_prism(Paint { rect, sides, label: Some(label) });
            };
            let up_to_roof = [Top::Level(top), inside[half]];
            paint(attic, [0, l], [y0, y1], up_to_roof);
            paint(gables[0], [0, t], [y0, y1], up_to_roof);
            paint(gables[1], [l - t, l], [y0, y1], up_to_roof);
            let side = if half == 0 { [0, t] } else { [d - t, d] };
            paint(sides[half], [0, l], side, up_to_roof);
            paint(roof, [0, l], [y0, y1], [inside[half], outside[half]]);
        }
        for (end, [x0, x1]) in [[0, t], [l - t, l]].into_iter().enumerate() {
            let rect = Rect { lo: [x0, d / 2 - 8 * MODULE], hi: [x1, d / 2 + 8 * MODULE] };
            let name = format!("{} gable window {}", placed.name, ["west", "east"][end]);
            let space = upright(rect, [top + 9 * MODULE, top + 20 * MODULE]);
            self.pierce(&name, space, [3, 1][end], Filling::Window { panes: 2 }, gables[end]);
        }
        let mut clear = Vec::new();
        if let Some(wing) = placed.storeys.last() {
            let (k, z) = (placed.storeys.len(), top);
            let floor = Floor { placed, wing, plan: wing.storey(), k, z };
            for room in floor.plan.rooms.iter().filter(|room| room.use_ == Use::Stair) {
                if let Some(stair) = floor.stair(room) {
                    let well = floor.rect(&stair.well());
                    self.stairwell(&floor.name(&format!("Stairwell {}", room.rects[0][0])), well, z, slab);
                    clear.push(floor.rect(&room.rects[0]));
                }
            }
        }
        // Where one can stand.
        let low = 30 * MODULE;
        let rects = vec![Rect { lo: [t, low], hi: [l - t, d - low] }];
        let attic = Furnished {
            name: &name,
            use_: Use::Attic,
            rects,
            solids: Vec::new(),
            clear,
            windows: Vec::new(),
            heights: [top, top + PARAPET * MODULE + low / 2],
        };
        self.furnish(&attic);
    }

    /// A round end, as high as the first wing.
    fn apse(&mut self, apse: Apse) {
        let Some(first) = self.complex.wings.first() else { return };
        let Some(wing) = first.storeys.first() else { return };
        let [south, north] = wing.corridor_rows();
        let middle = (south + north) * MODULE / 2;
        let center = first.place([0, middle]);
        let embedding = Embedding::round(center, apse.facets.max(2) as usize, [90.0, 270.0]);
        let facets = apse.facets.max(2);
        let (outer, inner) = (apse.radius * MODULE, (apse.radius - OUTER) * MODULE);
        let ring = |r: [i32; 2], u: [i32; 2]| Rect { lo: [r[0], u[0]], hi: [r[1], u[1]] };
        let all = ring([0, outer], [0, facets]);
        self.draft.begin_sheet(embedding, all);
        for k in 0..first.storeys.len() {
            self.draft.storey(&storey_name(k));
            let z = k as i32 * STOREY * MODULE;
            let heights = [z, z + CLEAR * MODULE];
            self.slab(&format!("Apse slab {k}"), all, z);
            let wall = self.wall(&format!("Apse wall {k}"), true);
            self.draft.paint(wall, upright(ring([inner, outer], [0, facets]), heights));
            let name = self.room_name(k, Use::Conference);
            let room = self.space(&name, Use::Conference);
            self.draft.paint(room, upright(ring([0, inner], [0, facets]), heights));
            for facet in (1..facets - 1).step_by(2) {
                let sill = [z + 9 * MODULE, z + 23 * MODULE];
                self.round_window(&format!("Apse window {facet}.{k}"), wall, [inner, outer], facet, sill);
            }
            // The largest square within, less its corners.
            let half = inner * 6 / 10;
            let [x, y] = center;
            let rects = vec![Rect { lo: [x - half, y - half], hi: [x - 2, y + half] }];
            let clear = vec![Rect { lo: [x - 12 * MODULE, y - 10 * MODULE], hi: [x, y + 10 * MODULE] }];
            let use_ = Use::Conference;
            let (solids, windows) = (Vec::new(), Vec::new());
            let furnished = Furnished { name: &name, use_, rects, solids, clear, windows, heights };
            self.draft.in_world(true);
            self.furnish(&furnished);
            self.draft.in_world(false);
        }
        let top = first.top();
        self.slab("Apse roof slab", all, top);
        let roof = self.roof("Apse roof");
        self.draft.paint(roof, upright(all, [top, top + MODULE]));
    }

    /// A window as wide as a facet of a round wall.
    fn round_window(
        &mut self,
        name: &str,
        wall: u32,
        [inner, outer]: [i32; 2],
        facet: i32,
        [z0, z1]: [i32; 2],
    ) {
        let opening = self.draft.element(
            Kind::Opening,
            Semantic::Window,
            "IfcOpeningElement",
            &format!("{name} opening"),
        );
        let look = Look { floor: palette::STONE, ceiling: palette::PLASTER, ..Look::default() };
        self.draft.look(opening, look);
        let part = |r: [i32; 2], z: [i32; 2]| upright(Rect { lo: [r[0], facet], hi: [r[1], facet + 1] }, z);
        self.draft.paint(opening, part([inner, outer], [z0, z1]));
        let window = self.draft.element(Kind::Detail, Semantic::WindowFrame, "IfcWindow", name);
        let middle = (inner + outer) / 2;
        let rail = 72;
        let frame = [[z0, z0 + rail], [z1 - rail, z1]].map(|z| part([middle - 36, middle + 36], z));
        let paints = frame.map(|cuboid| (cuboid, Some(palette::WHITE_PAINT)).into());
        self.draft.detail_of(window, &paints, z0);
        let pane = part([middle - 10, middle + 10], [z0 + rail, z1 - rail]);
        self.draft.detail_of(window, &[(pane, Some(palette::GLASS)).into()], z0 + rail);
        self.draft.fill(wall, opening, Some(window));
    }

    fn foyer(&mut self, foyer: &Foyer) {
        let (Some(first), Some(wing)) = (self.complex.wings.first(), self.complex.wings.get(foyer.wing))
        else {
            return;
        };
        let facade = first.size()[1];
        let [_, depth] = wing.size();
        let (near, far) = (wing.origin, wing.place([0, depth]));
        let far_inside = wing.place([0, depth - OUTER * wing.module()]);
        let (west, west_inside) = ([foyer.west, facade], [foyer.west + 2 * OUTER * MODULE, facade]);
        let (inside, wall_outline) = ([west_inside, near, far_inside], [west, west_inside, far_inside, far]);
        let storeys = first.storeys.len().min(wing.storeys.len());
        let (mut room_layers, mut wall_layers) = (Vec::new(), Vec::new());
        for k in 0..storeys {
            self.draft.storey(&storey_name(k));
            let z = k as i32 * STOREY * MODULE;
            let heights = [z, z + CLEAR * MODULE];
            let slab = self.slab_without_extent(&format!("{} foyer slab {k}", wing.name), z);
            let wall = self.wall(&format!("{} foyer wall {k}", wing.name), true);
            let name = self.room_name(k, Use::Corridor);
            let room = self.space(&name, Use::Corridor);
            let below = ([z - SLAB * MODULE, z], slab);
            room_layers.extend([below, (heights, room)]);
            wall_layers.extend([below, (heights, wall)]);
            // Where its middle is, hangs its lamp.
            let middle = [0, 1].map(|axis| inside.iter().map(|p| p[axis]).sum::<i32>() / 3);
            let lamps = self.lights.next().unwrap_or(1);
            self.draft.in_world(true);
            for i in 0..lamps {
                let at = [middle[0] + i as i32 * 4 * MODULE, middle[1], heights[1]];
                self.lamp(&format!("{name} {}", i + 1), at);
            }
            self.draft.in_world(false);
        }
        let top = storeys as i32 * STOREY * MODULE;
        let slab = self.slab_without_extent(&format!("{} foyer roof slab", wing.name), top);
        let roof = self.roof(&format!("{} foyer roof", wing.name));
        // As high as the parapets around: else these would touch in a line, between air on both sides.
        let above = [([top - SLAB * MODULE, top], slab), ([top, top + PARAPET * MODULE], roof)];
        room_layers.extend(above);
        wall_layers.extend(above);
        self.draft.region(&inside, &room_layers);
        self.draft.region(&wall_outline, &wall_layers);
    }

    /// A ceiling lamp and its light.
    fn lamp(&mut self, name: &str, at: [i32; 3]) {
        /// Candela: a luminaire of about 1,500 lumen.
        const BRIGHTNESS: f32 = 120.0;
        self.draft.point_light(&format!("{name} light"), [at[0], at[1], at[2] - 3 * MODULE], BRIGHTNESS);
        if self.complex.furniture {
            furnish::lamp(&mut self.draft, name, at);
        }
    }

    fn cameras(&mut self) {
        let Some(first) = self.complex.wings.first() else { return };
        let Some(wing) = first.storeys.first() else { return };
        let [south, north] = wing.corridor_rows();
        let ([length, depth], middle) = (first.size(), (south + north) * MODULE / 2);
        let at = |x: i32, y: i32, z: f64| {
            let [x, y] = first.place([x, y]);
            [metres(x), metres(y), z]
        };
        self.draft.camera("Corridor", at(8 * MODULE, middle, 1.6), at(length / 2, middle, 1.4), 60.0);
        let high = metres(self.hull.hi[2]);
        let outside = at(-60 * MODULE, -90 * MODULE, high * 0.8);
        self.draft.camera("Outside", outside, at(length / 3, depth / 2, high * 0.2), 50.0);
    }

    /// Hangs a room's lamps and puts its furniture in.
    fn furnish(&mut self, furnished: &Furnished<'_>) {
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
struct Floor<'a> {
    placed: &'a PlacedWing,
    wing: &'a Wing,
    plan: Storey,
    k: usize,
    /// Height of its floor, units.
    z: i32,
}

impl Floor<'_> {
    fn name(&self, what: &str) -> String {
        format!("{} {what} {}", self.placed.name, self.k)
    }

    fn rect(&self, rect: &Modules) -> Rect {
        let [west, south, east, north] = rect.map(|c| c * self.placed.module());
        Rect { lo: [west, south], hi: [east, north] }
    }

    /// Floor and ceiling.
    fn heights(&self) -> [i32; 2] {
        [self.z, self.z + CLEAR * MODULE]
    }

    /// Whether stairs lead on from here.
    fn goes_up(&self) -> bool {
        self.k + 1 < self.placed.storeys.len() || self.placed.roof == Roof::Gable
    }

    fn stair(&self, room: &RoomPlan) -> Option<StairPlan> {
        let (row, _) = room.bay?;
        StairPlan::new(room.rects[0], row == 0)
    }

    /// A window as its room sees it.
    fn window(&self, hole: &HolePlan) -> Window {
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
struct Furnished<'a> {
    name: &'a str,
    use_: Use,
    rects: Vec<Rect>,
    solids: Vec<Rect>,
    clear: Vec<Rect>,
    windows: Vec<Window>,
    heights: [i32; 2],
}

/// A box over a rectangle of the plan, between two heights.
fn upright(rect: Rect, [low, high]: [i32; 2]) -> Cuboid {
    Cuboid { lo: [rect.lo[0], rect.lo[1], low], hi: [rect.hi[0], rect.hi[1], high] }
}

/// The areas of all rooms, square units, in the order in which they are drawn.
fn room_areas(complex: &Complex) -> Vec<i64> {
    let mut areas = Vec::new();
    for placed in &complex.wings {
        let square = i64::from(placed.module()) * i64::from(placed.module());
        for wing in &placed.storeys {
            areas.extend(wing.storey().rooms.iter().map(|room| area(&room.rects) * square));
        }
        if placed.roof == Roof::Gable {
            // An attic is used little.
            areas.push(placed.size().map(i64::from).iter().product::<i64>() / 4);
        }
    }
    let storeys = complex.wings.first().map_or(0, |wing| wing.storeys.len());
    if let Some(apse) = complex.apse {
        let radius = i64::from(apse.radius * MODULE);
        areas.extend(std::iter::repeat_n(radius * radius * 3 / 2, storeys));
    }
    for foyer in &complex.foyers {
        let storeys = complex.wings.get(foyer.wing).map_or(0, |wing| wing.storeys.len()).min(storeys);
        areas.extend(std::iter::repeat_n(0, storeys));
    }
    areas
}

/// Shares `total` among rooms by their area: one for each, and of the rest the most to the largest.
fn share(total: usize, areas: &[i64]) -> Vec<usize> {
    let rest = total.saturating_sub(areas.len()) as i64;
    let all: i64 = areas.iter().sum::<i64>().max(1);
    let mut shares: Vec<usize> =
        areas.iter().map(|a| 1 + (i128::from(*a) * i128::from(rest) / i128::from(all)) as usize).collect();
    let mut left = (areas.len() + rest as usize).saturating_sub(shares.iter().sum());
    let remainder = |i: usize| (i128::from(areas[i]) * i128::from(rest)) % i128::from(all);
    let mut order: Vec<usize> = (0..areas.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse(remainder(i)), i));
    for i in order {
        if left == 0 {
            break;
        }
        shares[i] += 1;
        left -= 1;
    }
    shares
}
