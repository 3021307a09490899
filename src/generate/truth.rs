//! What is true of a generated building: its rooms and their faces, what each opening joins, and what lies where.
//!
//! All of it is taken from the plan of space that the building was made of, not from its meshes. Details, such as
//! furniture and door leaves, do not count: they stand in the air that is described here.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use crate::importers::Semantic;
use crate::splitmix::SplitMix64;

use super::building::{Building, Element, Kind};
use super::lattice::{PER_METRE, Point, metres};
use super::outline::crosses_rightward;
use super::patches::Facing;
use super::plan::{Plan, Top};
use super::sides::Sides;
use super::style::Style;
use super::write::{WriteError, replace};

/// What is true of a [`Building`]. Metres, Z up.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Truth {
    /// The building's name.
    pub name: String,
    /// Where the building as it was drawn stands in the file: takes (x, y, z, 1) to metres, Z up, row by row.
    pub place: [[f64; 4]; 3],
    /// Lower and upper corner of the box that the volumes fill, as it was drawn.
    pub hull: [[f64; 3]; 2],
    /// Volume of the hull: that of all volumes together.
    pub volume: f64,
    /// Rooms.
    pub rooms: Vec<RoomTruth>,
    /// Openings, doors and windows.
    pub openings: Vec<OpeningTruth>,
    /// The air outside.
    pub exterior: AirTruth,
    /// Points in the place of the file, none of them on a surface, and what holds them.
    pub points: Vec<PointTruth>,
}

/// A volume of air.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct AirTruth {
    /// Its global id.
    pub id: String,
    /// Its name.
    pub name: String,
    /// Cubic metres.
    pub volume: f64,
    /// Its surface by kind of face, square metres: `FLOOR`, `CEILING`, `WALLPAPER` in rooms; `TERRAIN`, `ROOFING`,
    /// `FACADE`, `HORIZON` (the hull) outside; `GATE_POST` in openings; `PORTAL` between two volumes of air.
    pub faces: BTreeMap<&'static str, f64>,
}

/// A room.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RoomTruth {
    /// As of all air.
    #[serde(flatten)]
    pub air: AirTruth,
    /// The storey's name.
    pub storey: Option<String>,
    /// Square metres one can stand on; a hole in the floor does not count.
    pub floor_area: f64,
}

/// An opening.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct OpeningTruth {
    /// As of all air.
    #[serde(flatten)]
    pub air: AirTruth,
    /// `DOOR`, `WINDOW` or `OPENING`.
    pub semantic: &'static str,
    /// Global id of what it pierces.
    pub host: Option<String>,
    /// Global id of the door or window in it.
    pub filling: Option<String>,
    /// The volumes of air that it joins, and the area of the portal to each, square metres.
    pub joins: Vec<PortalTruth>,
}

/// A portal, seen from one side.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PortalTruth {
    /// Global id of the air on the other side.
    pub id: String,
    /// Square metres.
    pub area: f64,
}

/// A point and what holds it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct PointTruth {
    /// Where it is.
    pub point: [f64; 3],
    /// Global id of the volume that holds it.
    pub id: String,
}

/// Points anywhere in the hull, and in each room.
const POINTS: usize = 300;
const POINTS_IN_ROOM: usize = 3;

impl Building {
    /// What is true of it.
    pub fn truth(&self) -> Truth {
        let contacts = contacts(&self.space);
        let air = |index: u32| self.air_truth(index, &contacts);
        let id = |index: Option<u32>| Some(self.elements.get(index? as usize)?.global_id.clone());
        let of_kind = |kind: Kind| {
            let all = self.elements.iter().enumerate();
            all.filter(move |(_, e)| e.kind == kind).map(|(i, e)| (i as u32, e))
        };
        let rooms = of_kind(Kind::Room).map(|(index, element)| {
            let air = air(index);
            let floor_area = air.faces.get("FLOOR").copied().unwrap_or(0.0);
            RoomTruth { air, storey: element.storey.clone(), floor_area }
        });
        let openings = of_kind(Kind::Opening).map(|(index, element)| OpeningTruth {
            air: air(index),
            semantic: element.semantic.name(),
            host: id(element.host),
            filling: id(element.filling),
            joins: self.portals(index, &contacts),
        });
        let exterior = of_kind(Kind::Exterior).map(|(index, _)| air(index)).next();
        let none =
            || AirTruth { id: String::new(), name: String::new(), volume: 0.0, faces: BTreeMap::new() };
        let size = [0, 1, 2].map(|i| f64::from(self.hull[1][i]) - f64::from(self.hull[0][i]));
        Truth {
            name: self.name.clone(),
            place: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
            hull: self.hull.map(|corner| corner.map(metres)),
            volume: size.iter().product::<f64>() * metres(1).powi(3),
            rooms: rooms.collect(),
            openings: openings.collect(),
            exterior: exterior.unwrap_or_else(none),
            points: self.points(),
        }
    }

    fn air_truth(&self, index: u32, contacts: &Contacts) -> AirTruth {
        let element = &self.elements[index as usize];
        let mut faces = BTreeMap::new();
        for (&(_, beyond, facing), area) in
            contacts.range((index, None, Facing::Up)..).take_while(|(c, _)| c.0 == index)
        {
            let beyond = beyond.map(|b| &self.elements[b as usize]);
            *faces.entry(face_name(element.kind, beyond, facing)).or_insert(0.0) += area;
        }
        AirTruth {
            id: element.global_id.clone(),
            name: element.name.clone(),
            volume: element.volume(),
            faces,
        }
    }

    /// The portals of an air volume, in the order of what is behind them.
    fn portals(&self, index: u32, contacts: &Contacts) -> Vec<PortalTruth> {
        let mut portals: BTreeMap<u32, f64> = BTreeMap::new();
        for (&(_, beyond, _), area) in
            contacts.range((index, None, Facing::Up)..).take_while(|(c, _)| c.0 == index)
        {
            if let Some(beyond) = beyond.filter(|&b| self.elements[b as usize].kind.is_air()) {
                *portals.entry(beyond).or_insert(0.0) += area;
            }
        }
        let id = |index: u32| self.elements[index as usize].global_id.clone();
        portals.into_iter().map(|(beyond, area)| PortalTruth { id: id(beyond), area }).collect()
    }

    fn points(&self) -> Vec<PointTruth> {
        let mut random = SplitMix64::new(SEED_OF_POINTS);
        let mut found = Vec::new();
        let mut add = |doubled: [i64; 3], label: u32| {
            let point = doubled.map(|c| c as f64 / (2.0 * f64::from(PER_METRE)));
            found.push(PointTruth { point, id: self.elements[label as usize].global_id.clone() });
        };
        let finder = Finder::new(&self.space);
        for _ in 0..POINTS {
            let point = odd_point(&mut random, self.hull);
            if let Some(label) = finder.label(point) {
                add(point, label);
            }
        }
        for (index, element) in self.elements.iter().enumerate().filter(|(_, e)| e.kind == Kind::Room) {
            let bound = |pick: fn(i32, i32) -> i32| {
                [0, 1, 2].map(|axis| element.points.iter().map(|p| p[axis]).reduce(pick).unwrap_or(0))
            };
            let bounds = [bound(i32::min), bound(i32::max)];
            // A room fills a good part of its bounds; a few tries in vain do not matter.
            let tries = (0..40).map(|_| odd_point(&mut random, bounds));
            let inside = tries.filter(|&point| finder.label(point) == Some(index as u32));
            inside.take(POINTS_IN_ROOM).for_each(|point| add(point, index as u32));
        }
        found
    }
}

impl Truth {
    /// The same truth, of a file written in this style: [`Truth::place`] and [`Truth::points`] follow it. What a style
    /// does to single elements is not part of the truth.
    pub fn styled(mut self, style: &Style) -> Truth {
        let moved = |p: [f64; 3]| style.place(p);
        let origin = moved([0.0; 3]);
        for (axis, unit) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().enumerate() {
            let end = style.direction(unit);
            for row in 0..3 {
                self.place[row][axis] = end[row];
            }
        }
        for row in 0..3 {
            self.place[row][3] = origin[row];
        }
        self.points.iter_mut().for_each(|p| p.point = moved(p.point));
        self
    }

    /// As JSON.
    pub fn to_json(&self) -> String {
        // Numbers and texts only: there is nothing that could not be written.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }

    /// Writes it beside a model: `NAME.truth.json` for `NAME.glb`. A file of that name is replaced at once.
    ///
    /// # Errors
    /// [`WriteError::Io`].
    pub fn write(&self, model: &Path) -> Result<(), WriteError> {
        replace(&model.with_extension("truth.json"), self.to_json().as_bytes())
    }
}

/// Square metres in which a label meets another (`None`: the hull's border), by where the face looks.
type Contacts = BTreeMap<(u32, Option<u32>, Facing), f64>;

/// All contacts of a plan.
fn contacts(plan: &Plan) -> Contacts {
    let square = metres(1) * metres(1);
    let mut contacts = Contacts::new();
    let mut add = |own: Option<u32>, beyond: Option<u32>, facing, area: f64| {
        if let Some(own) = own {
            *contacts.entry((own, beyond, facing)).or_insert(0.0) += area;
        }
    };
    for column in &plan.columns {
        let doubled: i64 = column
            .edges
            .iter()
            .map(|&[u, v]| {
                let [p, q] = [u, v].map(|i| plan.points[i as usize].map(i64::from));
                p[0] * q[1] - p[1] * q[0]
            })
            .sum();
        let label = |i: usize| column.layers.get(i).and_then(|layer| layer.label);
        for above in 0..=column.layers.len() {
            let below = above.checked_sub(1);
            let (under, over) = (below.and_then(label), label(above));
            if under != over {
                let steepness = below.map_or(1.0, |i| steepness(column.layers[i].top));
                let area = doubled as f64 / 2.0 * steepness * square;
                add(under, over, Facing::Up, area);
                add(over, under, Facing::Down, area);
            }
        }
    }
    for ([u, v], spans) in Sides::of(plan).iter() {
        let [p, q] = [u, v].map(|i| plan.points[i as usize].map(f64::from));
        let length = ((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1])).sqrt();
        for span in spans {
            let height = span.high[0] - span.low[0] + span.high[1] - span.low[1];
            add(span.label, span.other, Facing::Aside, length * f64::from(height) / 2.0 * square);
        }
    }
    contacts
}

/// Area of a plane for each unit of its plan's.
fn steepness(top: Top) -> f64 {
    match top {
        Top::Level(_) => 1.0,
        Top::Slope(slope) => {
            let [a, b] = slope.run.map(|r| f64::from(r) / f64::from(slope.per));
            (1.0 + a * a + b * b).sqrt()
        }
    }
}

/// What the face of an air volume is called.
fn face_name(own: Kind, beyond: Option<&Element>, facing: Facing) -> &'static str {
    let Some(beyond) = beyond else { return "HORIZON" };
    match (own, facing, beyond.semantic) {
        _ if beyond.kind.is_air() => "PORTAL",
        (Kind::Opening, ..) => "GATE_POST",
        (Kind::Room, Facing::Down, _) => "FLOOR",
        (Kind::Room, Facing::Up, _) => "CEILING",
        (Kind::Room, Facing::Aside, _) => "WALLPAPER",
        (_, Facing::Down, Semantic::Ground | Semantic::Site) => "TERRAIN",
        (_, _, Semantic::Roof) => "ROOFING",
        _ => "FACADE",
    }
}

/// Finds what holds a point.
struct Finder<'a> {
    plan: &'a Plan,
    /// Edges with their columns.
    edges: Vec<([[i64; 2]; 2], usize)>,
}

impl Finder<'_> {
    fn new(plan: &Plan) -> Finder<'_> {
        let of_column = |(i, column): (usize, &super::plan::Column)| {
            let ends = |e: &[u32; 2]| e.map(|p| plan.points[p as usize].map(i64::from));
            column.edges.iter().map(|e| (ends(e), i)).collect::<Vec<_>>()
        };
        Finder { plan, edges: plan.columns.iter().enumerate().flat_map(of_column).collect() }
    }

    /// The label at a point, given in doubled units, all odd: so it lies on no plane along an axis; and on no other,
    /// as far as the drawing has them.
    fn label(&self, [x, y, z]: [i64; 3]) -> Option<u32> {
        let mut inside: Vec<usize> = Vec::new();
        for &([p, q], column) in &self.edges {
            if crosses_rightward(p, q, [x, y]) {
                match inside.iter().position(|&c| c == column) {
                    Some(place) => {
                        inside.swap_remove(place);
                    }
                    None => inside.push(column),
                }
            }
        }
        let column = &self.plan.columns[*inside.first()?];
        let is_below = |top: &Top| match top {
            Top::Level(height) => z < 2 * i64::from(*height),
            Top::Slope(s) => {
                let height = i64::from(s.run[0]) * x + i64::from(s.run[1]) * y + 2 * s.rise;
                z * i64::from(s.per) < height
            }
        };
        column.layers.iter().find(|layer| is_below(&layer.top))?.label
    }
}

const SEED_OF_POINTS: u64 = 0x7275_7468;

/// A random point in the box in doubled units, odd on all axes.
fn odd_point(random: &mut SplitMix64, [lo, hi]: [Point; 2]) -> [i64; 3] {
    [0, 1, 2].map(|axis| {
        let span = (i64::from(hi[axis]) - i64::from(lo[axis])).max(1) as u64;
        2 * (i64::from(lo[axis]) + random.below(span) as i64) + 1
    })
}
