//! What the generators make: a building as closed, labelled volumes with planar faces.

use std::collections::BTreeMap;

use crate::importers::{Camera, Light, Material, Semantic};

use super::lattice::{Point, metres};
use super::outline::flatten;
use super::plan::Plan;
use super::triangulate;

/// A generated building: elements that are closed volumes, on a grid of 1/1024 m, Z up.
///
/// The elements that are no [details](Kind::Detail) fill [`Building::hull`] exactly and overlap nowhere: every point
/// of the hull lies in one of them. Details stand in the air volumes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Building {
    /// Its name.
    pub name: String,
    /// Lower and upper corner of the box that the volumes fill, in units of 1/1024 m.
    pub hull: [Point; 2],
    /// The volumes and details.
    pub elements: Vec<Element>,
    /// What [`Face::material`] refers to.
    pub materials: Vec<Material>,
    /// Lights, metres, Z up.
    pub lights: Vec<Light>,
    /// Views that show the building well, metres, Z up.
    pub cameras: Vec<Camera>,
    /// What the volumes were made of.
    pub(super) space: Plan,
}

/// What fills a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// Air of a room.
    Room,
    /// Air of a hole in a wall.
    Opening,
    /// Air outside.
    Exterior,
    /// A wall, a slab...
    Solid,
    /// A thing in the air: a door's leaf, furniture. Details do not take part in filling the hull.
    Detail,
}

impl Kind {
    /// Whether it is a volume of air.
    pub const fn is_air(self) -> bool {
        matches!(self, Kind::Room | Kind::Opening | Kind::Exterior)
    }
}

/// One building element: a closed mesh of planar polygons, counter-clockwise seen from outside. It has no T-junctions:
/// every edge of a face is the whole edge of one other face, in the other direction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Element {
    /// What fills it.
    pub kind: Kind,
    /// What it is.
    pub semantic: Semantic,
    /// Its IFC class.
    pub class: String,
    /// Its name: unique among the elements of its class.
    pub name: String,
    /// 22 characters, from the seed, the class and the name.
    pub global_id: String,
    /// The storey's name.
    pub storey: Option<String>,
    /// The wall that an opening pierces, and that a door or window sits in.
    pub host: Option<u32>,
    /// The door or window that fills this opening.
    pub filling: Option<u32>,
    /// The opening that this door or window fills.
    pub opening: Option<u32>,
    /// More metadata.
    pub extras: BTreeMap<String, String>,
    /// Corners, units of 1/1024 m.
    pub points: Vec<Point>,
    /// Its surface.
    pub faces: Vec<Face>,
}

/// A planar polygon, which may have holes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Face {
    /// The outline, counter-clockwise seen from outside, then the holes, clockwise, as indices of
    /// [`Element::points`].
    pub loops: Vec<Vec<u32>>,
    /// Index in [`Building::materials`].
    pub material: u32,
    /// For a face of a solid that looks into air: the air volume.
    pub beyond: Option<u32>,
    /// Whether it can be seen: faces of solids towards air, and of details unless they lie flush on a solid.
    pub seen: bool,
}

impl Element {
    /// `IfcClass:Name`, as nodes and objects are called.
    pub fn tagged_name(&self) -> String {
        format!("{}:{}", self.class, self.name)
    }

    /// Six times its volume, in units of (1/1024 m)^3; exact.
    pub fn sixfold_volume(&self) -> i128 {
        self.faces.iter().flat_map(|face| &face.loops).map(|ring| self.loop_volume(ring)).sum()
    }

    /// Its volume in cubic metres.
    pub fn volume(&self) -> f64 {
        self.sixfold_volume() as f64 * metres(1).powi(3) / 6.0
    }

    /// What a loop adds: the cone of its fan over the origin. Since the faces' loops are planar, it does not matter
    /// where in the plane a fan has its middle.
    fn loop_volume(&self, ring: &[u32]) -> i128 {
        let at = |&i: &u32| self.points[i as usize].map(i128::from);
        let fan = ring.windows(2).skip(1).map(|w| [at(&ring[0]), at(&w[0]), at(&w[1])]);
        fan.map(|[a, b, c]| {
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        })
        .sum()
    }

    /// A face's outward normal; of any length but zero.
    pub fn normal(&self, face: &Face) -> [i64; 3] {
        vector_area(&face.loops[0].iter().map(|&i| self.points[i as usize]).collect::<Vec<_>>())
    }

    /// A face's triangles, as indices of [`Element::points`]. None has zero area; they keep all corners, so that the
    /// triangles of an element are a closed mesh too.
    pub fn triangles(&self, face: &Face) -> Vec<[u32; 3]> {
        let corners: Vec<u32> = face.loops.iter().flatten().copied().collect();
        let cut = triangulate::triangles(&self.flat_loops(face));
        cut.into_iter().map(|triangle| triangle.map(|i| corners[i as usize])).collect()
    }

    /// A face as polygons without holes and without corners on straight lines: itself if it is one, else its convex
    /// parts.
    pub fn polygons(&self, face: &Face) -> Vec<Vec<u32>> {
        let flat = self.flat_loops(face);
        if triangulate::is_plain(&flat) {
            return face.loops.clone();
        }
        let corners: Vec<u32> = face.loops.iter().flatten().copied().collect();
        let parts = triangulate::convex_parts(&flat);
        parts.into_iter().map(|part| part.into_iter().map(|i| corners[i as usize]).collect()).collect()
    }

    /// A face's loops in coordinates of its plane.
    pub(super) fn flat_loops(&self, face: &Face) -> Vec<Vec<[i64; 2]>> {
        let normal = self.normal(face);
        let flat = |ring: &Vec<u32>| ring.iter().map(|&i| flatten(self.points[i as usize], normal)).collect();
        face.loops.iter().map(flat).collect()
    }
}

impl Building {
    /// The number of opaque faces that can be seen from air, as polygons with holes before they are cut for a file:
    /// for each solid element, what one air volume sees of one of its planes in one material counts once; so does
    /// each plane of a detail, unless it lies flush on a solid.
    pub fn visible_faces(&self) -> usize {
        let opaque = |face: &&Face| !self.materials[face.material as usize].is_see_through();
        self.elements.iter().flat_map(|e| &e.faces).filter(|face| face.seen).filter(opaque).count()
    }

    /// All that a file says of an element besides its mesh: [`Element::extras`], and `ifc_class`, `global_id`,
    /// `name`, `storey`, `host_id`, `filling_id`, `opening_id` as far as it has them.
    pub fn metadata(&self, element: &Element) -> BTreeMap<String, String> {
        let id = |link: Option<u32>| Some(&self.elements.get(link? as usize)?.global_id);
        let known = [
            ("ifc_class", Some(&element.class)),
            ("global_id", Some(&element.global_id)),
            ("name", Some(&element.name)),
            ("storey", element.storey.as_ref()),
            ("host_id", id(element.host)),
            ("filling_id", id(element.filling)),
            ("opening_id", id(element.opening)),
        ];
        let known = known.into_iter().filter_map(|(key, value)| Some((key.to_owned(), value?.clone())));
        element.extras.clone().into_iter().chain(known).collect()
    }
}

/// The sum of the cross products around a loop: twice its area along its normal.
pub(super) fn vector_area(ring: &[Point]) -> [i64; 3] {
    let mut area = [0i64; 3];
    let Some(&origin) = ring.first() else { return area };
    for pair in ring.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|p| [0, 1, 2].map(|i| i64::from(p[i]) - i64::from(origin[i])));
        area[0] += a[1] * b[2] - a[2] * b[1];
        area[1] += a[2] * b[0] - a[0] * b[2];
        area[2] += a[0] * b[1] - a[1] * b[0];
    }
    area
}
