//! A building on its way to a file.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use super::super::building::{Building, Element, Kind};
use super::super::lattice::point_metres;
use super::super::write::{self, WriteError};
use super::Style;
use super::cut::{self, Joint};
use super::dice::Dice;
use super::ends::Contacts;
use super::floors;
use super::identity::{Label, labels};
use super::mesh::{Cut, Finish, Part};
use super::place::{Move, Placement, length};
use super::planes::shift;
use super::rooms::RoomShift;
use crate::importers::{Camera, Light, Material};

/// A building as a file is to hold it: in a style, its elements named, moved and in their order, but not yet cut into
/// triangles or polygons. [`Building::export`] makes it.
#[derive(Clone, Debug)]
pub struct Export<'a> {
    pub(in super::super) name: &'a str,
    pub(in super::super) objects: Vec<Object<'a>>,
    pub(in super::super) materials: &'a [Material],
    /// In metres, Z up, before the placement.
    pub(in super::super) lights: Vec<Light>,
    /// As the lights.
    pub(in super::super) cameras: Vec<Camera>,
    pub(in super::super) placement: Placement,
}

/// An element on its way to a file.
#[derive(Clone, Debug)]
pub struct Object<'a> {
    /// How it was drawn: its faces and what they are made of. They are cut as they were drawn, exactly, wherever their
    /// corners are now.
    pub drawn: Cow<'a, Element>,
    /// What it is called.
    pub label: Label,
    /// The object over it, by its index.
    pub above: Option<usize>,
    /// Where its corners are, metres, Z up, before the placement.
    points: Vec<[f64; 3]>,
    finish: Finish,
}

impl Object<'_> {
    /// Its mesh: one part, or one for each material.
    pub fn parts(&self, cut: Cut) -> Vec<Part<'_>> {
        self.finish.parts(&self.drawn, &self.points, cut)
    }

    /// What the node of its part `number` is called, as three.js calls them.
    pub fn part_name(&self, number: usize) -> String {
        format!("{}_{number}", self.label.node_name())
    }
}

impl Building {
    /// The building in a style, on its way to a file. The same building and style always make the same bytes.
    pub fn export(&self, style: &Style) -> Export<'_> {
        Exporter { building: self, style, dice: Dice::new(style.seed) }.export()
    }
}

impl Export<'_> {
    /// Writes the file as the name's end says: `.glb`, or `.obj` with its `.mtl` beside it. A file of that name is
    /// replaced, at once: whoever reads sees the old bytes or the new ones.
    ///
    /// # Errors
    /// Another ending, or the system refuses. Then no file of that name has changed, but with `.obj` the `.mtl` may
    /// have.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        write::write_export(self, path)
    }
}

struct Exporter<'a, 's> {
    building: &'a Building,
    style: &'s Style,
    dice: Dice,
}

impl<'a> Exporter<'a, '_> {
    fn export(&self) -> Export<'a> {
        let Exporter { building, style, dice } = *self;
        let way = Move::of(style);
        let contacts =
            (style.wall_ends > 0.0 || style.openings_protruding > 0.0 || style.openings_shallow > 0.0)
                .then(|| Contacts::of(building));
        let floors = self.floors();
        let mut objects = Vec::with_capacity(building.elements.len());
        // By element, its object.
        let mut found = vec![None; building.elements.len()];
        for (index, label) in labels(building, style, &dice).into_iter().enumerate() {
            let Some(label) = label else { continue };
            found[index] = Some(objects.len());
            let drawn = self.drawn(&building.elements[index]);
            let mut points = metres(&drawn);
            self.shift_ends(index as u32, &drawn, &mut points, contacts.as_ref());
            let raised =
                floors.get(&(index as u32)).filter(|floor| floor.is_below).map(|floor| floor.thickness);
            self.shift_room(&drawn, &mut points, raised);
            self.shift_solid(&drawn, &mut points);
            objects.push(self.object(drawn, label, points, &way));
        }
        for (&room, floor) in &floors {
            objects
                .push(self.extra(floors::finish_floor(building, room, &floor.faces, floor.thickness), &way));
        }
        if style.storey_spaces {
            for (name, rooms) in floors::storeys(building) {
                for &room in &rooms {
                    if let Some(object) = found[room as usize] {
                        let above = objects.len();
                        objects[object].above = Some(above);
                    }
                }
                objects.push(self.extra(floors::storey_space(building, name, &rooms), &way));
            }
        }
        Export {
            name: &building.name,
            objects,
            materials: &building.materials,
            lights: building.lights.iter().map(|light| way.light(light)).collect(),
            cameras: building.cameras.iter().map(|camera| way.camera(camera)).collect(),
            placement: Placement::of(style),
        }
    }

    fn hits(&self, share: f64, option: &str, element: &Element) -> bool {
        self.dice.hits(share, option, &element.global_id)
    }

    /// The element, cut in two if it is a wall to be cut.
    fn drawn(&self, element: &'a Element) -> Cow<'a, Element> {
        let joints = [
            (self.style.walls_touching, "walls-touching", Joint::Touching),
            (self.style.walls_lapped, "walls-lapped", Joint::Lapped),
            (self.style.walls_inner_face, "walls-inner-face", Joint::InnerFace),
        ];
        let is_wall = element.kind == Kind::Solid && element.semantic == crate::importers::Semantic::Wall;
        let joint =
            joints.into_iter().find(|&(share, option, _)| is_wall && self.hits(share, option, element));
        let halves = joint.and_then(|(_, _, joint)| {
            cut::in_two(element, joint, self.dice.draw("where walls are cut", &element.global_id))
        });
        halves.map_or(Cow::Borrowed(element), Cow::Owned)
    }

    /// Moves the ends of walls and openings.
    fn shift_ends(&self, index: u32, drawn: &Element, points: &mut [[f64; 3]], contacts: Option<&Contacts>) {
        let Some(contacts) = contacts else { return };
        let (building, style) = (self.building, self.style);
        let draw = |what: &str| self.dice.draw(what, &drawn.global_id);
        let mut steps = Vec::new();
        if self.hits(style.wall_ends, "wall-ends", drawn) {
            steps.push(contacts.wall_ends(building, index, draw("how far walls run")));
        }
        if self.hits(style.openings_protruding, "openings-protruding", drawn) {
            steps.push(contacts.protruding(building, index, draw("how far openings protrude")));
        }
        if self.hits(style.openings_shallow, "openings-shallow", drawn) {
            steps.push(contacts.shallow(building, index, draw("what openings lack")));
        }
        for planes in steps {
            // What cannot follow stays as it was drawn.
            let _ = shift(drawn, points, |plane| planes.get(plane).copied().unwrap_or(0.0));
        }
    }

    /// Moves the faces of a room off the walls, and its floor up by `raised`, units.
    fn shift_room(&self, drawn: &Element, points: &mut [[f64; 3]], raised: Option<i32>) {
        if drawn.kind != Kind::Room {
            return;
        }
        let random = self.dice.draw("how far rooms are off", &drawn.global_id);
        let off = if self.hits(self.style.rooms_smaller, "rooms-smaller", drawn) {
            RoomShift::off(-1.0, random)
        } else if self.hits(self.style.rooms_larger, "rooms-larger", drawn) {
            RoomShift::off(1.0, random)
        } else {
            RoomShift::default()
        };
        let off = off.farther(-length(self.style.room_gap));
        let on_floor = |shift: RoomShift| match raised.zip(floors::lowest(drawn)) {
            Some((thickness, lowest)) => shift.on_floor(lowest, thickness),
            None => shift,
        };
        // Where the walls are too close to be kept off, the floor at least.
        let whole = on_floor(off);
        if whole != RoomShift::default() && !shift(drawn, points, |plane| whole.of(plane)) {
            let floor = on_floor(RoomShift::default());
            let _ = shift(drawn, points, |plane| floor.of(plane));
        }
    }

    /// Moves the faces of a solid in or out. What cannot follow stays as it was drawn.
    fn shift_solid(&self, drawn: &Element, points: &mut [[f64; 3]]) {
        if drawn.kind == Kind::Solid {
            let step = -length(self.style.solid_gap);
            let _ = shift(drawn, points, |_| step);
        }
    }

    /// The rooms that get a finish floor.
    fn floors(&self) -> BTreeMap<u32, Floor> {
        let style = self.style;
        if !(style.floors > 0.0 || style.floors_below > 0.0) {
            return BTreeMap::new();
        }
        let all = floors::floor_faces(self.building).into_iter();
        all.filter_map(|(room, faces)| {
            let element = &self.building.elements[room as usize];
            let is_below = self.hits(style.floors_below, "floors-below", element);
            let is_wanted = is_below || self.hits(style.floors, "floors", element);
            let thickness = floors::thickness(self.dice.draw("how thick floors are", &element.global_id));
            is_wanted.then_some((room, Floor { faces, thickness, is_below }))
        })
        .collect()
    }

    /// An element that the building does not have.
    fn extra(&self, element: Element, way: &Move) -> Object<'a> {
        let label = Label {
            class: element.class.clone(),
            name: element.name.clone(),
            id: element.global_id.clone(),
            metadata: self.building.metadata(&element),
        };
        let points = metres(&element);
        self.object(Cow::Owned(element), label, points, way)
    }

    fn object(
        &self,
        drawn: Cow<'a, Element>,
        label: Label,
        mut points: Vec<[f64; 3]>,
        way: &Move,
    ) -> Object<'a> {
        let id = &drawn.global_id;
        way.corners(&mut points, || self.dice.draw("off-grid", id));
        let finish = Finish::of(self.style, &self.dice, id);
        Object { drawn, label, above: None, points, finish }
    }
}

/// A finish floor to be made.
struct Floor {
    /// The faces that it lies on: solid and face.
    faces: Vec<(u32, u32)>,
    /// Units.
    thickness: i32,
    /// Whether the room begins on it.
    is_below: bool,
}

fn metres(element: &Element) -> Vec<[f64; 3]> {
    element.points.iter().map(|&p| point_metres(p)).collect()
}
