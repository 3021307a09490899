//! Bodies: the closed shells that carve space or label air, on the lattice.
//!
//! A body is what the closed components of one element bound together. Which components carve is decided one by one:
//! open ones do not, nor do those with too many faces for their volume (railings, proxies, handles), which would cut the
//! air around them into splinters; they stay detail, each with its reason.

use enfilade_importers::{Element, ElementId, Model, Role, Untagged};

use crate::compile::outward::{Outward, turn_outward};
use crate::components::{Component, components};
use crate::lattice::{Lattice, Point};
use crate::roles::{asked_role, component_role};

/// Why a closed or open component of an element with a solid role does not carve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NotCarved {
    /// Its mesh is open.
    Open,
    /// It has more faces than its volume pays for.
    TooManyFaces,
    /// It lies beyond what the lattice holds, or far from everything else.
    Far,
    /// It encloses no volume.
    Flat,
}

/// A triangle of a body: corners as indices into the body's vertices, outward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner3 {
    pub(super) corners: [u32; 3],
    /// Its index in the element's mesh.
    pub(super) source: u32,
}

/// A vertex on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Vertex {
    pub(super) at: Point,
    pub(super) z: i32,
}

/// What the closed components of an element bound together.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub(super) element: ElementId,
    /// Whether it carves; else it labels air.
    pub(super) is_solid: bool,
    pub(super) vertices: Vec<Vertex>,
    /// The same, not rounded: lattice units.
    pub(super) exact: Vec<[f64; 3]>,
    pub(super) triangles: Vec<Corner3>,
    /// Whether the winding number tells inside from outside; else parity does.
    pub(super) by_winding: bool,
    /// m3.
    pub(super) volume: f64,
}

/// All bodies of a model, and what became of the rest of its components.
#[derive(Debug)]
pub(super) struct Bodies {
    pub(super) lattice: Lattice,
    /// The box around the bodies, lattice units.
    pub(super) bounds: [[i32; 3]; 2],
    pub(super) bodies: Vec<Body>,
    /// Triangles of components that rays meet and that do not carve.
    pub(super) detail: Vec<(ElementId, u32)>,
    /// Components of solid elements that do not carve.
    pub(super) not_carved: Vec<(ElementId, NotCarved)>,
}

/// Components of an element that carve or label, before the lattice is known.
struct Shells<'m> {
    element: &'m Element,
    id: ElementId,
    is_solid: bool,
    shells: Vec<(Component, Outward)>,
    bounds: [[f64; 3]; 2],
}

/// A component with more faces a cubic metre than this, and more than [`FEW_FACES`], does not carve.
const FACES_PER_CUBIC_METRE: f64 = 400.0;
/// A component with at most so many faces carves whatever its volume.
const FEW_FACES: usize = 24;
/// A volume below this is none, m3.
const LEAST_VOLUME: f64 = 1e-9;
/// A body farther than this from the middle of most of the building is far, metres.
const FAR: f64 = 1900.0;

/// The bodies of `model`.
pub(super) fn gather(model: &Model, untagged: Untagged) -> Bodies {
    let mut detail = Vec::new();
    let mut not_carved = Vec::new();
    let mut all: Vec<Shells<'_>> = Vec::new();
    for sorted in sort_components(model, untagged) {
        detail.extend(sorted.detail);
        not_carved.extend(sorted.not_carved);
        all.extend(sorted.shells);
    }
    let Some(middle) = middle(&all) else {
        let lattice = Lattice::about([[0.0; 3]; 2]);
        return Bodies { lattice, bounds: [[0; 3]; 2], bodies: Vec::new(), detail, not_carved };
    };
    let (near, far): (Vec<_>, Vec<_>) = all.into_iter().partition(|s| is_near(s.bounds, middle));
    for shells in far.iter().filter(|s| s.is_solid) {
        not_carved.push((shells.id, NotCarved::Far));
        let triangles = shells.shells.iter().flat_map(|(component, _)| &component.triangles);
        detail.extend(triangles.map(|&t| (shells.id, t)));
    }
    let first = near.first().map_or([[0.0; 3]; 2], |s| s.bounds);
    let bounds = near.iter().fold(first, |[lo, hi], s| {
        [[0, 1, 2].map(|i| lo[i].min(s.bounds[0][i])), [0, 1, 2].map(|i| hi[i].max(s.bounds[1][i]))]
    });
    // The hull is larger than the bodies, and on the lattice too.
    let lattice =
        Lattice::about([bounds[0].map(|c| c - super::MARGIN), bounds[1].map(|c| c + super::MARGIN)]);
    let bodies: Vec<Body> = near.iter().map(|shells| body(shells, &lattice)).collect();
    let bounds = [0, 1].map(|end| [0, 1, 2].map(|axis| lattice.round(axis, bounds[end][axis])));
    detail.sort_unstable();
    not_carved.sort_unstable();
    Bodies { lattice, bounds, bodies, detail, not_carved }
}

/// The components of one element, sorted by what becomes of them.
struct Sorted<'m> {
    shells: Option<Shells<'m>>,
    detail: Vec<(ElementId, u32)>,
    not_carved: Vec<(ElementId, NotCarved)>,
}

fn sort_components(model: &Model, untagged: Untagged) -> Vec<Sorted<'_>> {
    let sort = |(index, element)| sort_element(ElementId(index as u32), element, untagged);
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        model.elements.par_iter().enumerate().map(sort).collect()
    }
    #[cfg(not(feature = "rayon"))]
    model.elements.iter().enumerate().map(sort).collect()
}

fn sort_element(id: ElementId, element: &Element, untagged: Untagged) -> Sorted<'_> {
    let mut sorted = Sorted { shells: None, detail: Vec::new(), not_carved: Vec::new() };
    let asked = asked_role(element, untagged);
    let asks_solid = matches!(asked, Some(Role::Solid));
    let mut shells = Vec::new();
    let mut is_solid = false;
    let mut leave = |component: &Component, why: Option<NotCarved>| {
        sorted.detail.extend(component.triangles.iter().map(|&t| (id, t)));
        sorted.not_carved.extend(why.map(|why| (id, why)));
    };
    for component in components(&element.mesh) {
        match component_role(asked, &component) {
            Role::Ignore => {}
            Role::Detail => leave(&component, asks_solid.then_some(NotCarved::Open)),
            Role::Air if !component.closed => {}
            role @ (Role::Air | Role::Solid) => {
                is_solid = role == Role::Solid;
                let outward = turn_outward(&element.mesh, &component);
                shells.push((component, outward));
            }
        }
    }
    // A cavity belongs to the shell around it: with cavities, all or none of the element's components carve.
    let whole: f64 = shells.iter().map(|(_, outward)| outward.volume).sum();
    let has_cavity = shells.iter().any(|(_, outward)| (outward.volume < 0.0) != (whole < 0.0));
    if is_solid {
        if has_cavity {
            let faces: usize = shells.iter().map(|(c, o)| face_count(element, c, o)).sum();
            if let Some(why) = too_costly(faces, whole) {
                shells.iter().for_each(|(component, _)| leave(component, Some(why)));
                shells.clear();
            }
        } else {
            shells.retain(|(component, outward)| {
                let why = too_costly(face_count(element, component, outward), outward.volume);
                if why.is_some() {
                    leave(component, why);
                }
                why.is_none()
            });
        }
    }
    if let Some(first) = shells.first() {
        let bounds = shells.iter().fold(first.0.bounds, |[lo, hi], (c, _)| {
            [[0, 1, 2].map(|i| lo[i].min(c.bounds[0][i])), [0, 1, 2].map(|i| hi[i].max(c.bounds[1][i]))]
        });
        sorted.shells = Some(Shells { element, id, is_solid, shells, bounds });
    }
    sorted
}

fn too_costly(faces: usize, volume: f64) -> Option<NotCarved> {
    if volume.abs() < LEAST_VOLUME {
        return Some(NotCarved::Flat);
    }
    let most = (FACES_PER_CUBIC_METRE * volume.abs()).max(FEW_FACES as f64);
    (faces as f64 > most).then_some(NotCarved::TooManyFaces)
}

/// How many planar faces a component has: triangles of one plane, told by their quantised planes, count once.
fn face_count(element: &Element, component: &Component, outward: &Outward) -> usize {
    let mesh = &element.mesh;
    let mut planes: Vec<[i64; 4]> = outward
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| glam::DVec3::from(mesh.positions[v as usize]));
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let origin = glam::DVec3::from(component.bounds[0]);
            let quantised = (normal * 512.0).round().as_i64vec3();
            [quantised.x, quantised.y, quantised.z, (normal.dot(a - origin) * 500.0).round() as i64]
        })
        .collect();
    planes.sort_unstable();
    planes.dedup();
    planes.len()
}

/// The middle of the building, where most of it is: the median of its bodies' middles.
fn middle(all: &[Shells<'_>]) -> Option<[f64; 3]> {
    if all.is_empty() {
        return None;
    }
    Some([0, 1, 2].map(|axis| {
        let mut middles: Vec<f64> =
            all.iter().map(|s| (s.bounds[0][axis] + s.bounds[1][axis]) / 2.0).collect();
        middles.sort_unstable_by(f64::total_cmp);
        middles[middles.len() / 2]
    }))
}

fn is_near(bounds: [[f64; 3]; 2], middle: [f64; 3]) -> bool {
    (0..3).all(|axis| bounds[0][axis] > middle[axis] - FAR && bounds[1][axis] < middle[axis] + FAR)
}

fn body(shells: &Shells<'_>, lattice: &Lattice) -> Body {
    let mesh = &shells.element.mesh;
    let mut index = vec![u32::MAX; mesh.positions.len()];
    let mut body = Body {
        element: shells.id,
        is_solid: shells.is_solid,
        vertices: Vec::new(),
        exact: Vec::new(),
        triangles: Vec::new(),
        by_winding: shells.shells.iter().all(|(_, outward)| outward.by_winding),
        volume: shells.shells.iter().map(|(_, outward)| outward.volume).sum(),
    };
    for (component, outward) in &shells.shells {
        for (&source, corners) in component.triangles.iter().zip(&outward.triangles) {
            let corners = corners.map(|v| {
                let slot = &mut index[v as usize];
                if *slot == u32::MAX {
                    *slot = body.vertices.len() as u32;
                    let p = mesh.positions[v as usize];
                    body.exact.push([0, 1, 2].map(|axis| lattice.local(axis, p[axis])));
                    body.vertices.push(Vertex { at: lattice.point(p), z: lattice.round(2, p[2]) });
                }
                *slot
            });
            body.triangles.push(Corner3 { corners, source });
        }
    }
    if body.volume < 0.0 {
        body.triangles.iter_mut().for_each(|t| t.corners.swap(1, 2));
        body.volume = -body.volume;
    }
    body
}
