//! Whether a model is the building, up to what its form promises.

use std::collections::{BTreeMap, BTreeSet};

use enfilade::components::{Orientation, components};
use enfilade::importers::{Element, Model, Semantic, TagSource};

use super::algebra::Point;
use super::building::{Building, Face, Part, expected_looks};

/// What two models must share to be the same, whatever their form: all of an element but its place, its path, and
/// where its tags stood in the source.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub id: String,
    pub name: String,
    pub class: Option<String>,
    pub semantic: Semantic,
    pub tagged_by: TagSource,
    pub storey: Option<String>,
    /// By the numbers of the building's own points, the least first, and the material's name.
    pub triangles: BTreeSet<([usize; 3], String)>,
}

/// Checks that `model` is the building: `bounds` say for each part how far its coordinates may be off, metres. Gives
/// the elements in the building's order.
pub fn see(building: &Building, model: &Model, order: &[usize], bounds: &[f64]) -> Result<Vec<Seen>, String> {
    let ids: Vec<&str> = model.elements.iter().map(|e| e.id.as_str()).collect();
    let expected: Vec<&str> = order.iter().map(|part| building.parts[*part].id).collect();
    if ids != expected {
        return Err(format!("elements {ids:?}, expected {expected:?}"));
    }
    let counted: u64 = model.left_out.iter().filter(|l| l.reason.is_triangles()).map(|l| l.count).sum();
    if model.triangles_read != model.triangle_count() + counted {
        return Err(format!("{} triangles read, {counted} of them left out", model.triangles_read));
    }
    check_materials(building, model)?;
    let mut seen: Vec<Option<Seen>> = vec![None; order.len()];
    for (element, &part) in model.elements.iter().zip(order) {
        let found = see_part(building, model, element, &building.parts[part], bounds[part]);
        seen[part] = Some(found.map_err(|text| format!("{} ({}): {text}", element.id, element.name))?);
    }
    Ok(seen.into_iter().flatten().collect())
}

/// Checks that two models have the same cameras and lights; positions to `bound`, metres.
pub fn check_views(a: &Model, b: &Model, bound: f64) -> Result<(), String> {
    let near = |p: Point, q: Point, bound: f64| (0..3).all(|i| (p[i] - q[i]).abs() <= bound);
    let cameras = a.cameras.iter().zip(&b.cameras).all(|(a, b)| {
        // Fields of view are 32-bit floats in glTF.
        a.name == b.name
            && near(a.eye, b.eye, bound)
            && near(a.direction, b.direction, super::ROUNDING)
            && near(a.up, b.up, super::ROUNDING)
            && (a.vfov_degrees - b.vfov_degrees).abs() < 1e-5
    });
    let lights = a.lights.iter().zip(&b.lights).all(|(a, b)| {
        (&a.name, a.kind, a.color, a.intensity, a.range) == (&b.name, b.kind, b.color, b.intensity, b.range)
            && near(a.position, b.position, bound)
            && near(a.direction, b.direction, super::ROUNDING)
    });
    if a.cameras.len() != b.cameras.len() || a.lights.len() != b.lights.len() || !cameras || !lights {
        return Err(format!("{:?}, {:?}; expected {:?}, {:?}", a.cameras, a.lights, b.cameras, b.lights));
    }
    Ok(())
}

fn check_materials(building: &Building, model: &Model) -> Result<(), String> {
    let expected = expected_looks(building);
    let used: BTreeSet<usize> =
        model.elements.iter().flat_map(|e| &e.mesh.materials).map(|m| m.0 as usize).collect();
    for material in used.iter().map(|index| &model.materials[*index]) {
        if expected.get(&material.name) != Some(material) {
            return Err(format!("{material:?}, expected {:?}", expected.get(&material.name)));
        }
    }
    if used.len() != expected.len() {
        return Err(format!("{} materials are used, expected {}", used.len(), expected.len()));
    }
    Ok(())
}

fn see_part(
    building: &Building,
    model: &Model,
    element: &Element,
    part: &Part,
    bound: f64,
) -> Result<Seen, String> {
    let mesh = &element.mesh;
    let points = building.points(part);
    let points: Vec<Point> = points.iter().map(|p| [0, 1, 2].map(|i| p[i] + building.far[i])).collect();
    let offset = model.frame.offset;
    let found = mesh.positions.iter().map(|p| [0, 1, 2].map(|i| p[i] + offset[i]));
    let vertices = found.map(|p| nearest(&points, p, bound)).collect::<Result<Vec<usize>, String>>()?;
    let different: BTreeSet<&usize> = vertices.iter().collect();
    if different.len() != points.len() || vertices.len() != points.len() {
        return Err(format!("{} vertices, expected {}", vertices.len(), points.len()));
    }

    let mut triangles = BTreeSet::new();
    for (corners, material) in mesh.triangles.iter().zip(&mesh.materials) {
        let mut corners = corners.map(|v| vertices[v as usize]);
        let least = (0..3).min_by_key(|i| corners[*i]).unwrap_or(0);
        corners.rotate_left(least);
        if !triangles.insert((corners, model.materials[material.0 as usize].name.clone())) {
            return Err(format!("triangle {corners:?} is there twice"));
        }
    }
    check_faces(building, part, &points, &triangles)?;

    let bodies = components(mesh);
    let is_fine = |body: &enfilade::components::Component| {
        body.closed && body.orientation == Orientation::Consistent && body.signed_volume > 0.0
    };
    if bodies.len() != building.shapes[part.shape].bodies || !bodies.iter().all(is_fine) {
        return Err(format!("closed bodies that face outward: expected, found {bodies:?}"));
    }
    Ok(Seen {
        id: element.id.clone(),
        name: element.name.clone(),
        class: element.class.clone(),
        semantic: element.semantic,
        tagged_by: element.tagged_by.clone(),
        storey: element.storey.clone(),
        triangles,
    })
}

/// The point from which no coordinate of `p` is farther than `bound`.
fn nearest(points: &[Point], p: Point, bound: f64) -> Result<usize, String> {
    let off = |q: &Point| (0..3).fold(0.0f64, |m, i| m.max((p[i] - q[i]).abs()));
    let best = (0..points.len()).min_by(|a, b| off(&points[*a]).total_cmp(&off(&points[*b]))).unwrap_or(0);
    if off(&points[best]) <= bound {
        return Ok(best);
    }
    Err(format!("{p:?} is {:e} from {:?}, more than {bound:e}", off(&points[best]), points[best]))
}

/// Checks that the triangles are the faces' polygons, each cut into triangles somehow: of its corners and material,
/// all with its orientation, along its outline, and of its area.
fn check_faces(
    building: &Building,
    part: &Part,
    points: &[Point],
    triangles: &BTreeSet<([usize; 3], String)>,
) -> Result<(), String> {
    let faces = building.faces(part);
    let mut of_face: Vec<Vec<[usize; 3]>> = vec![Vec::new(); faces.len()];
    for (corners, look) in triangles {
        let is_in = |face: &Face| {
            building.looks[face.look].material.name == *look
                && corners.iter().all(|v| face.corners.contains(v))
        };
        let normal = area_vector(points, corners);
        let front = |face: &Face| dot(area_vector(points, &face.corners), normal) > 0.0;
        match faces.iter().position(|face| is_in(face) && front(face)) {
            Some(face) => of_face[face].push(*corners),
            None => return Err(format!("triangle {corners:?} of '{look}' is in no face, or turned over")),
        }
    }
    for (face, triangles) in faces.iter().zip(&of_face) {
        // Inner edges are there once each way, and cancel out.
        let mut edges: BTreeMap<(usize, usize), i32> = BTreeMap::new();
        for (a, b) in triangles.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]) {
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
        let n = face.corners.len();
        for (a, b) in (0..n).map(|i| (face.corners[i], face.corners[(i + 1) % n])) {
            *edges.entry((a.min(b), a.max(b))).or_default() -= if a < b { 1 } else { -1 };
        }
        let area = length(area_vector(points, &face.corners));
        let sum: f64 = triangles.iter().map(|t| length(area_vector(points, t))).sum();
        let is_cut = triangles.len() == n - 2 && edges.values().all(|count| *count == 0);
        if !is_cut || (sum - area).abs() > 1e-6 * area {
            return Err(format!("the triangles {triangles:?} are not the face {:?}", face.corners));
        }
    }
    Ok(())
}

/// Twice the area of a polygon, along its normal.
fn area_vector(points: &[Point], corners: &[usize]) -> Point {
    let from = points[corners[0]];
    let relative = |v: usize| [0, 1, 2].map(|i| points[v][i] - from[i]);
    let cross = |u: Point, v: Point| {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    };
    let each = corners.windows(2).map(|pair| cross(relative(pair[0]), relative(pair[1])));
    each.fold([0.0; 3], |sum, c| [0, 1, 2].map(|i| sum[i] + c[i]))
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(v: Point) -> f64 {
    dot(v, v).sqrt()
}
