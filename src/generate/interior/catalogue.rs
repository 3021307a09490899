//! The things that rooms are furnished with, and what is known of each before it stands anywhere.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::generate::furniture::{self as house, Counter, Piece};
use crate::generate::lattice::{Cuboid, units};
use crate::generate::palette::{
    BEECH, BLUE_FABRIC, CONCRETE, GRASS, GREEN_PAINT, LACQUER, PAPER, RED_WOOL, WALNUT,
};
use crate::importers::Semantic;

use super::count;
use super::pieces as piece;

/// A thing. Lengths are in centimetres, so that few different ones are ever made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)] // Each is what it is called; see the pieces for sizes.
pub enum Thing {
    WorkDesk { w: u16, d: u16, is_dark: bool },
    Divider { w: u16 },
    Pedestal,
    SwivelChair { is_red: bool, has_cross: bool },
    VisitorChair { is_red: bool },
    WoodenChair,
    ConferenceTable { w: u16, d: u16 },
    Table { w: u16, d: u16, h: u16 },
    SideTable { w: u16, h: u16 },
    SchoolTable,
    Lectern,
    FlipChart,
    Copier,
    Reception { w: u16 },
    Bench { seats: u8 },
    PlainBench { w: u16 },
    ClubChair { is_red: bool },
    Sofa { seats: u8 },
    SmallPlant,
    LargePlant,
    CoatStand,
    FloorLamp,
    Leaflets,
    Sculpture,
    Cupboard { w: u16, h: u16, doors: u8, is_dark: bool },
    FilingCabinet,
    FileShelf { w: u16, rows: u8, pattern: u8 },
    Bookcase { w: u16, pattern: u8 },
    Rack { w: u16, pattern: u8 },
    Cartons { count: u8 },
    Lockers { columns: u8 },
    Bin,
    Trunk { w: u16 },
    ServerRack { pattern: u8 },
    Whiteboard { w: u16 },
    Blackboard { w: u16 },
    Picture { w: u16, h: u16, color: u8 },
    NoticeBoard { w: u16 },
    Clock,
    WallScreen { w: u16 },
    Canvas { w: u16 },
    Radiator { w: u16, h: u16 },
    Extinguisher,
    Hooks { w: u16 },
    Sign,
    Mirror { w: u16 },
    Dispenser,
    AirConditioner,
    WallBoard { w: u16 },
    WallToilet,
    Toilet,
    Urinal,
    Basins { count: u8 },
    Basin,
    CubicleSide { d: u16 },
    CubicleFront { w: u16 },
    CubicleDoor { w: u16 },
    TeaCounter { w: u16 },
    SinkCounter { w: u16 },
    HobCounter { w: u16 },
    WallUnits { w: u16 },
    Dishwasher,
    Refrigerator,
    WaterCooler,
    VendingMachine,
    PowerCabinet,
    Trolley,
    Television { w: u16 },
    Bed { w: u16, pillows: u8 },
    Chest { w: u16, d: u16, h: u16, columns: u8, rows: u8 },
    BathTub,
    WashingMachine,
}

/// What IFC calls a thing.
#[derive(Clone, Copy)]
enum Class {
    Furniture,
    Sanitary,
    Appliance,
    Heater,
    Fire,
}

/// A thing as it is drawn.
#[derive(Debug)]
pub struct Item {
    /// What people call it.
    pub name: &'static str,
    /// What it is.
    pub semantic: Semantic,
    /// Its IFC class.
    pub class: &'static str,
    /// Its shape.
    pub piece: Piece,
    /// Its boxes of matter.
    pub boxes: Vec<Cuboid>,
    /// Width and depth, units.
    pub size: [i32; 2],
    /// Lowest and highest point.
    pub z: [i32; 2],
    /// How many faces it shows where it stands free.
    pub faces: u32,
    /// How many of them lie at its back, its right, its front and its left, seen from behind.
    pub at_sides: [u32; 4],
}

impl Item {
    /// Whether one walks past under it or beside it, as it is flat or high on the wall.
    pub fn is_hung(&self) -> bool {
        self.z[0] >= units(0.8) && self.size[1] <= units(0.25)
    }
}

/// Things that were drawn already.
#[derive(Debug, Default)]
pub struct Catalogue {
    items: BTreeMap<Thing, Arc<Item>>,
}

impl Catalogue {
    /// What a thing looks like.
    pub fn item(&mut self, thing: Thing) -> Arc<Item> {
        Arc::clone(self.items.entry(thing).or_insert_with(|| Arc::new(draw(thing))))
    }

    /// All things drawn so far.
    #[cfg(test)]
    pub fn drawn(&self) -> impl Iterator<Item = (Thing, &Item)> {
        self.items.iter().map(|(thing, item)| (*thing, &**item))
    }
}

fn draw(thing: Thing) -> Item {
    let (name, class, piece) = make(thing);
    let (semantic, class) = match class {
        Class::Furniture => (Semantic::Furniture, "IfcFurnishingElement"),
        Class::Sanitary => (Semantic::Equipment, "IfcFlowTerminal"),
        Class::Appliance => (Semantic::Equipment, "IfcElectricAppliance"),
        Class::Heater => (Semantic::Equipment, "IfcSpaceHeater"),
        Class::Fire => (Semantic::Equipment, "IfcFireSuppressionTerminal"),
    };
    let boxes: Vec<Cuboid> = piece
        .boxes
        .iter()
        .filter(|(cuboid, material)| material.is_some() && !cuboid.is_empty())
        .map(|b| b.0)
        .collect();
    let end = |axis: usize| boxes.iter().map(|b| b.hi[axis]).max().unwrap_or(0);
    let [left, back, low] = [0, 1, 2].map(|axis| boxes.iter().map(|b| b.lo[axis]).min().unwrap_or(0));
    let count::Faces { all, outermost: [least, most] } = count::faces(&piece.boxes);
    let feet = if low == 0 { least[2] } else { 0 };
    Item {
        name,
        semantic,
        class,
        size: [end(0), end(1)],
        z: [low, end(2)],
        faces: all - feet,
        at_sides: [
            if back == 0 { least[1] } else { 0 },
            most[0],
            most[1],
            if left == 0 { least[0] } else { 0 },
        ],
        boxes,
        piece,
    }
}

fn make(thing: Thing) -> (&'static str, Class, Piece) {
    use Class::{Appliance, Fire, Furniture, Heater, Sanitary};
    use Thing as T;
    let m = |cm: u16| f64::from(cm) / 100.0;
    let n = |count: u8| u32::from(count);
    let fabric = |is_red: bool| if is_red { RED_WOOL } else { BLUE_FABRIC };
    let wood = |is_dark: bool| if is_dark { WALNUT } else { BEECH };
    match thing {
        T::WorkDesk { w, d, is_dark } => ("Desk", Furniture, piece::work_desk(m(w), m(d), wood(is_dark))),
        T::Divider { w } => ("Divider", Furniture, piece::divider(m(w))),
        T::Pedestal => ("Pedestal", Furniture, piece::pedestal()),
        T::SwivelChair { is_red, has_cross } => {
            ("Office chair", Furniture, piece::swivel_chair(fabric(is_red), has_cross))
        }
        T::VisitorChair { is_red } => ("Chair", Furniture, piece::visitor_chair(fabric(is_red))),
        T::WoodenChair => ("Chair", Furniture, house::chair(BEECH)),
        T::ConferenceTable { w, d } => ("Conference table", Furniture, piece::conference_table(m(w), m(d))),
        T::Table { w, d, h } => ("Table", Furniture, house::table([m(w), m(d), m(h)], BEECH)),
        T::SideTable { w, h } => ("Side table", Furniture, piece::side_table(m(w), m(h))),
        T::SchoolTable => ("School table", Furniture, piece::school_table()),
        T::Lectern => ("Lectern", Furniture, piece::lectern()),
        T::FlipChart => ("Flip chart", Furniture, piece::flip_chart()),
        T::Copier => ("Copier", Appliance, piece::copier()),
        T::Reception { w } => ("Reception", Furniture, piece::reception(m(w))),
        T::Bench { seats } => ("Bench", Furniture, piece::bench(n(seats))),
        T::PlainBench { w } => ("Bench", Furniture, piece::plain_bench(m(w))),
        T::ClubChair { is_red } => ("Armchair", Furniture, piece::club_chair(fabric(is_red))),
        T::Sofa { seats } => ("Sofa", Furniture, house::sofa(n(seats))),
        T::SmallPlant => ("Plant", Furniture, piece::plant(false)),
        T::LargePlant => ("Plant", Furniture, piece::plant(true)),
        T::CoatStand => ("Coat stand", Furniture, piece::coat_stand()),
        T::FloorLamp => ("Floor lamp", Appliance, piece::floor_lamp()),
        T::Leaflets => ("Leaflets", Furniture, piece::leaflets()),
        T::Sculpture => ("Sculpture", Furniture, piece::sculpture()),
        T::Cupboard { w, h, doors, is_dark } => {
            let front = if is_dark { WALNUT } else { LACQUER };
            ("Cupboard", Furniture, piece::cupboard([m(w), 0.42, m(h)], n(doors), front))
        }
        T::FilingCabinet => ("Filing cabinet", Furniture, piece::filing_cabinet()),
        T::FileShelf { w, rows, pattern } => {
            ("Shelf", Furniture, piece::file_shelf(m(w), n(rows), n(pattern)))
        }
        T::Bookcase { w, pattern } => ("Bookcase", Furniture, piece::bookcase(m(w), n(pattern))),
        T::Rack { w, pattern } => ("Rack", Furniture, piece::rack(m(w), n(pattern))),
        T::Cartons { count } => ("Cartons", Furniture, piece::cartons(n(count))),
        T::Lockers { columns } => ("Lockers", Furniture, piece::lockers(n(columns))),
        T::Bin => ("Bin", Furniture, piece::bin(0.36)),
        T::Trunk { w } => ("Trunk", Furniture, piece::trunk(m(w))),
        T::ServerRack { pattern } => ("Server rack", Appliance, piece::server_rack(n(pattern))),
        T::Whiteboard { w } => ("Whiteboard", Furniture, piece::whiteboard(m(w))),
        T::Blackboard { w } => ("Blackboard", Furniture, piece::blackboard(m(w))),
        T::Picture { w, h, color } => {
            let colors = [BLUE_FABRIC, GRASS, RED_WOOL, PAPER, GREEN_PAINT, CONCRETE];
            let color = colors[usize::from(color) % colors.len()];
            ("Picture", Furniture, piece::picture([m(w), m(h)], color))
        }
        T::NoticeBoard { w } => ("Notice board", Furniture, piece::notice_board(m(w))),
        T::Clock => ("Clock", Furniture, piece::clock()),
        T::WallScreen { w } => ("Screen", Appliance, piece::wall_screen(m(w))),
        T::Canvas { w } => ("Canvas", Furniture, piece::canvas(m(w))),
        T::Radiator { w, h } => ("Radiator", Heater, piece::radiator(m(w), m(h))),
        T::Extinguisher => ("Extinguisher", Fire, piece::extinguisher()),
        T::Hooks { w } => ("Hooks", Furniture, piece::hooks(m(w))),
        T::Sign => ("Sign", Furniture, piece::sign()),
        T::Mirror { w } => ("Mirror", Furniture, piece::mirror(m(w))),
        T::Dispenser => ("Dispenser", Sanitary, piece::dispenser()),
        T::AirConditioner => ("Air conditioner", Appliance, piece::air_conditioner()),
        T::WallBoard { w } => ("Wall shelf", Furniture, piece::wall_board(m(w))),
        T::WallToilet => ("Toilet", Sanitary, piece::wall_toilet()),
        T::Toilet => ("Toilet", Sanitary, house::toilet()),
        T::Urinal => ("Urinal", Sanitary, piece::urinal()),
        T::Basins { count } => ("Basins", Sanitary, piece::basins(n(count))),
        T::Basin => ("Basin", Sanitary, house::wash_basin(0.5, 0.4)),
        T::CubicleSide { d } => ("Cubicle side", Furniture, piece::cubicle_side(m(d))),
        T::CubicleFront { w } => ("Cubicle front", Furniture, piece::cubicle_front(m(w), false)),
        T::CubicleDoor { w } => ("Cubicle door", Furniture, piece::cubicle_front(m(w), true)),
        T::TeaCounter { w } => ("Counter", Furniture, piece::tea_counter(m(w))),
        T::SinkCounter { w } => {
            ("Sink", Furniture, house::counter(m(w), u32::from(w / 60).max(1), Counter::Sink))
        }
        T::HobCounter { w } => {
            ("Cooker", Furniture, house::counter(m(w), u32::from(w / 60).max(1), Counter::Hob))
        }
        T::WallUnits { w } => ("Wall units", Furniture, house::wall_units(m(w))),
        T::Dishwasher => ("Dishwasher", Appliance, piece::dishwasher()),
        T::Refrigerator => ("Refrigerator", Appliance, house::refrigerator()),
        T::WaterCooler => ("Water cooler", Appliance, piece::water_cooler()),
        T::VendingMachine => ("Vending machine", Appliance, piece::vending_machine()),
        T::PowerCabinet => ("Power cabinet", Appliance, piece::power_cabinet()),
        T::Trolley => ("Trolley", Furniture, piece::trolley()),
        T::Television { w } => ("Television", Furniture, house::television(m(w))),
        T::Bed { w, pillows } => ("Bed", Furniture, house::bed(m(w), n(pillows))),
        T::Chest { w, d, h, columns, rows } => {
            let piece = house::chest([m(w), m(d), m(h)], n(columns), n(rows), LACQUER);
            (if h > 150 { "Wardrobe" } else { "Chest" }, Furniture, piece)
        }
        T::BathTub => ("Bath tub", Sanitary, house::bath_tub()),
        T::WashingMachine => ("Washing machine", Appliance, house::washing_machine()),
    }
}
