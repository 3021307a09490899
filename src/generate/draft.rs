//! A building being drawn: prisms of space painted with elements on one or more sheets, details put into the air, then
//! closed volumes made of it all.

use std::collections::{BTreeMap, BTreeSet};

use crate::importers::{Camera, Light, LightKind, Semantic};

use super::building::{Building, Element, Face, Kind, vector_area};
use super::compose::compose;
use super::flush::mark_flush_details;
use super::global_id::global_id;
use super::lattice::{Cuboid, Point, Rect, metres, point_metres};
use super::palette::{self, Look};
use super::patches::{Facing, Patch, Surface, patches};
use super::plan::{Column, Paint, Plan, Top, stack};
use super::sheet::Embedding;

/// A building being drawn. What is painted goes onto the sheet begun last, in its frame.
pub struct Draft {
    seed: u64,
    name: String,
    hull: Cuboid,
    storey: Option<String>,
    elements: Vec<Element>,
    looks: Vec<Look>,
    /// What fills the hull before anything is painted.
    world: Vec<([Top; 2], u32)>,
    sheets: Vec<Sheet>,
    /// Whether details and lights are given in the world's frame rather than the sheet's.
    in_world: bool,
    /// Pieces drawn by their outlines, in the world's frame.
    pieces: Vec<Plan>,
    details: Vec<(u32, Plan)>,
    lights: Vec<Light>,
    cameras: Vec<Camera>,
}

/// A sheet that is painted on.
struct Sheet {
    embedding: Embedding,
    rect: Rect,
    paints: Vec<Paint>,
    /// Painted over all others.
    last: Vec<Paint>,
}

impl Draft {
    /// The air outside: the first element.
    pub const EXTERIOR: u32 = 0;

    /// An empty building: the whole of `hull` is exterior.
    pub fn new(name: &str, seed: u64, hull: Cuboid) -> Draft {
        let mut draft = Draft {
            seed,
            name: name.to_owned(),
            hull,
            storey: None,
            elements: Vec::new(),
            looks: Vec::new(),
            world: Vec::new(),
            sheets: Vec::new(),
            in_world: false,
            pieces: Vec::new(),
            details: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
        };
        let exterior =
            draft.element(Kind::Exterior, Semantic::Exterior, "IfcExternalSpatialElement", "EXTERIOR");
        // The class stands for more than air outside, so the meaning is written out.
        draft.extra(exterior, "semantic", "EXTERIOR");
        draft.fill_world(exterior, [hull.lo[2], hull.hi[2]]);
        draft
    }

    /// Gives all of the hull between two heights to an element, before anything is painted over it.
    pub fn fill_world(&mut self, element: u32, heights: [i32; 2]) {
        self.world.push((heights.map(Top::Level), element));
    }

    /// Begins a sheet of this extent: no two sheets overlap in the world.
    pub fn begin_sheet(&mut self, embedding: Embedding, rect: Rect) {
        self.sheets.push(Sheet { embedding, rect, paints: Vec::new(), last: Vec::new() });
    }

    /// The frame of the sheet begun last.
    fn frame(&self) -> &Embedding {
        let sheet = self.sheets.last().filter(|_| !self.in_world);
        sheet.map_or(&Embedding::Straight, |sheet| &sheet.embedding)
    }

    /// Whether what follows of details and lights is given in the world's frame rather than the sheet's.
    pub fn in_world(&mut self, is_so: bool) {
        self.in_world = is_so;
    }

    /// Gives the elements that follow a storey.
    pub fn storey(&mut self, name: &str) {
        self.storey = Some(name.to_owned());
    }

    /// Adds an element without space yet.
    pub fn element(&mut self, kind: Kind, semantic: Semantic, class: &str, name: &str) -> u32 {
        let index = self.elements.len() as u32;
        self.elements.push(Element {
            kind,
            semantic,
            class: class.to_owned(),
            name: name.to_owned(),
            global_id: global_id(self.seed, &format!("{}/{class}:{name}", self.name)),
            storey: self.storey.clone(),
            host: None,
            filling: None,
            opening: None,
            extras: BTreeMap::new(),
            points: Vec::new(),
            faces: Vec::new(),
        });
        self.looks.push(Look::default());
        index
    }

    /// Sets what an element's faces are made of.
    pub fn look(&mut self, element: u32, look: Look) {
        self.looks[element as usize] = look;
    }

    /// Sets a word of metadata.
    pub fn extra(&mut self, element: u32, key: &str, value: &str) {
        self.elements[element as usize].extras.insert(key.to_owned(), value.to_owned());
    }

    /// Links an opening with the element that it pierces and the door or window that fills it.
    pub fn fill(&mut self, host: u32, opening: u32, filling: Option<u32>) {
        self.elements[opening as usize].host = Some(host);
        self.elements[opening as usize].filling = filling;
        if let Some(filling) = filling {
            self.elements[filling as usize].host = Some(host);
            self.elements[filling as usize].opening = Some(opening);
        }
    }

    /// Gives a box of space to an element, and takes it from whatever had it.
    pub fn paint(&mut self, element: u32, cuboid: Cuboid) {
        self.paint_prism((cuboid, Some(element)).into());
    }

    /// Gives a prism, whose sides may slope, to an element.
    pub fn paint_prism(&mut self, paint: Paint) {
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.paints.push(paint);
        }
    }

    /// As [`Draft::paint`], over all that is painted on the sheet before and after.
    pub fn paint_last(&mut self, element: u32, cuboid: Cuboid) {
        if let Some(sheet) = self.sheets.last_mut() {
            sheet.last.push((cuboid, Some(element)).into());
        }
    }

    /// Draws a region of the world by its outline, counter-clockwise, that no sheet covers: of what is painted over
    /// it, the last counts.
    pub fn region(&mut self, outline: &[[i32; 2]], painted: &[([i32; 2], u32)]) {
        let rect = Rect { lo: [0; 2], hi: [1; 2] };
        let over = self.world.iter().copied().chain(painted.iter().map(|&(z, e)| (z.map(Top::Level), e)));
        let paints: Vec<Paint> =
            over.map(|(sides, element)| Paint { rect, sides, label: Some(element) }).collect();
        let bottom = self.hull.lo[2];
        let count = outline.len() as u32;
        let edges = (0..count).map(|i| [i, (i + 1) % count]).collect();
        let layers = stack(bottom, paints.iter(), [rect.lo, rect.hi]);
        self.pieces.push(Plan { points: outline.to_vec(), bottom, columns: vec![Column { edges, layers }] });
    }

    /// Adds a part to a detail. The labels of `plan` are materials.
    pub fn detail(&mut self, element: u32, plan: Plan) {
        let plan = plan.moved(|point| self.frame().place(point));
        self.details.push((element, plan));
    }

    /// Adds a part to a detail, of prisms whose labels are materials.
    pub fn detail_of(&mut self, element: u32, paints: &[Paint], bottom: i32) {
        self.details.push((element, self.frame().plan(paints, bottom)));
    }

    /// Adds a point light of white light.
    pub fn point_light(&mut self, name: &str, at: Point, candela: f32) {
        self.lights.push(Light {
            name: name.to_owned(),
            kind: LightKind::Point,
            position: point_metres(self.frame().point(at)),
            direction: [0.0, 0.0, -1.0],
            color: palette::LAMP_LIGHT,
            intensity: candela,
            range: f64::INFINITY,
        });
    }

    /// How far, in the plan, the nearest detail is from a point; only what reaches up to less than half a metre below it
    /// counts. Metres.
    pub fn clearance(&self, [x, y, z]: [f64; 3]) -> f64 {
        const BELOW: f64 = 0.5;
        let of_detail = |plan: &Plan| {
            let high = plan.columns.iter().flat_map(|column| &column.layers).any(|layer| match layer.top {
                Top::Level(top) => layer.label.is_some() && metres(top) > z - BELOW,
                Top::Slope(_) => true,
            });
            let bound = |axis: usize, pick: fn(i32, i32) -> i32| {
                plan.points.iter().map(|p| p[axis]).reduce(pick).map_or(f64::INFINITY, metres)
            };
            let beyond =
                |axis: usize, c: f64| (bound(axis, i32::min) - c).max(c - bound(axis, i32::max)).max(0.0);
            let [dx, dy] = [beyond(0, x), beyond(1, y)];
            if high { (dx * dx + dy * dy).sqrt() } else { f64::INFINITY }
        };
        self.details.iter().map(|(_, plan)| of_detail(plan)).fold(f64::INFINITY, f64::min)
    }

    /// Adds an upright camera; points in metres, not one over the other.
    pub fn camera(&mut self, name: &str, eye: [f64; 3], target: [f64; 3], vfov_degrees: f64) {
        let direction = unit([target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]]);
        let right = unit([direction[1], -direction[0], 0.0]);
        let up = unit([
            right[1] * direction[2] - right[2] * direction[1],
            right[2] * direction[0] - right[0] * direction[2],
            right[0] * direction[1] - right[1] * direction[0],
        ]);
        self.cameras.push(Camera { name: name.to_owned(), eye, direction, up, vfov_degrees });
    }

    /// Makes the volumes.
    pub fn finish(mut self) -> Building {
        let plan = self.space();
        let of_volumes = patches(&plan, &|own, beyond, facing| Some(self.surface(own, beyond, facing)));
        let mut found: Vec<Vec<Patch>> = vec![Vec::new(); self.elements.len()];
        for patch in of_volumes {
            found[patch.surface.element as usize].push(patch);
        }
        for (element, plan) in &self.details {
            // Where two materials of one detail meet there is no face.
            let of_detail = patches(plan, &|material, beyond, _| {
                beyond.is_none().then_some(Surface { element: *element, material, beyond: None })
            });
            found[*element as usize].extend(of_detail);
        }
        for (element, patches) in self.elements.iter_mut().zip(found) {
            close(element, patches);
        }
        mark_flush_details(&mut self.elements);
        Building {
            name: self.name,
            hull: [self.hull.lo, self.hull.hi],
            elements: self.elements,
            materials: palette::materials(),
            lights: self.lights,
            cameras: self.cameras,
            space: plan,
        }
    }

    /// The plan of all space in the hull.
    fn space(&mut self) -> Plan {
        let bottom = self.hull.lo[2];
        let world = Rect { lo: [self.hull.lo[0], self.hull.lo[1]], hi: [self.hull.hi[0], self.hull.hi[1]] };
        let filled = |rect: Rect| {
            self.world.iter().map(move |&(sides, element)| Paint { rect, sides, label: Some(element) })
        };
        let sheets = self.sheets.iter().map(|sheet| {
            let paints: Vec<Paint> =
                filled(sheet.rect).chain(sheet.paints.iter().chain(&sheet.last).copied()).collect();
            sheet.embedding.plan(&paints, bottom)
        });
        let mut pieces: Vec<Plan> = sheets.collect();
        pieces.append(&mut self.pieces.clone());
        let rest = stack(bottom, filled(world).collect::<Vec<_>>().iter(), [world.lo, world.hi]);
        compose(pieces, world, bottom, &rest)
    }

    /// The material of a face of the volume `own` that looks at `beyond`, and what it is joined with.
    fn surface(&self, own: u32, beyond: Option<u32>, facing: Facing) -> Surface {
        let look = self.looks[own as usize];
        let is_air = |e: u32| self.elements[e as usize].kind.is_air();
        if is_air(own) {
            return Surface { element: own, material: palette::AIR, beyond: None };
        }
        let beyond = beyond.filter(|&e| is_air(e));
        let material = beyond.map_or(look.core, |air| {
            let around = self.looks[air as usize];
            match (self.elements[air as usize].kind, facing) {
                (Kind::Exterior, Facing::Up) => look.top,
                (Kind::Exterior, _) => look.outside,
                (_, Facing::Up) => around.floor,
                (_, Facing::Down) => around.ceiling,
                (_, Facing::Aside) => look.inside.unwrap_or(around.walls),
            }
        });
        Surface { element: own, material, beyond }
    }
}

/// Makes an element's mesh of its faces. Points that are a corner of no face of the element are left out; all others
/// stay in every loop that goes through them, so that faces meet along whole edges.
fn close(element: &mut Element, patches: Vec<Patch>) {
    let mut corners = BTreeSet::new();
    for ring in patches.iter().flat_map(|patch| &patch.loops) {
        for i in 0..ring.len() {
            let [before, at, after] = [0, 1, 2].map(|k| ring[(i + k) % ring.len()]);
            if vector_area(&[before, at, after]) != [0; 3] {
                corners.insert(at);
            }
        }
    }
    let mut indices: BTreeMap<Point, u32> = BTreeMap::new();
    for patch in patches {
        let points = &mut element.points;
        let mut index = |p: Point| {
            *indices.entry(p).or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            })
        };
        let mut kept = |ring: Vec<Point>| -> Vec<u32> {
            ring.into_iter().filter(|p| corners.contains(p)).map(&mut index).collect()
        };
        let loops = patch.loops.into_iter().map(&mut kept).collect();
        let Surface { material, beyond, .. } = patch.surface;
        let seen = beyond.is_some() || element.kind == Kind::Detail;
        element.faces.push(Face { loops, material, beyond, seen });
    }
}

/// The vector of length 1 in the direction of `v`. Only operations that round the same everywhere.
fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c / length + 0.0)
}
