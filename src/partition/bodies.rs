//! Bodies: the closed shells that carve space or label air, on the lattice.
//!
//! A body is what the closed components of one element bound together. Which components carve is decided one by one:
//! open ones do not, nor do those with too many faces for their volume (railings, proxies, handles), which would cut the
//! air around them into splinters; they stay detail, each with its reason.

use std::borrow::Cow;

use enfilade_importers::{ElementId, Mesh, Model, Role, Untagged};

use super::direction::direction;
use super::matter::MatterTriangle;
use super::mend::{Mended, mend};
use crate::compile::outward::{Outward, turn_outward};
use crate::components::{Component, components};
use crate::lattice::{Lattice, Point};
use crate::parallel;
use crate::roles::{asked_role, component_role};
use crate::shells::{Inside, Shell, shells};

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

impl NotCarved {
    /// The reason in words.
    pub fn text(self) -> &'static str {
        match self {
            NotCarved::Open => "open",
            NotCarved::TooManyFaces => "too many faces for their volume",
            NotCarved::Far => "far from the building",
            NotCarved::Flat => "without volume",
        }
    }
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
    /// Triangles inside of solid bodies that belong to none.
    pub(super) inner: Vec<MatterTriangle>,
    /// Elements whose mesh was mended.
    pub(super) mended: u64,
}

/// Closed components of an element that carve or label, before the lattice is known.
struct Shells<'m> {
    pieces: Pieces<'m>,
    is_solid: bool,
    closed: Vec<Closed>,
    bounds: [[f64; 3]; 2],
}

/// A closed component.
struct Closed {
    component: Component,
    shells: Vec<(Shell, Outward)>,
}

impl Closed {
    fn volume(&self) -> f64 {
        self.shells.iter().map(|(_, outward)| outward.volume).sum()
    }
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
        let lattice = Lattice::about(std::iter::empty(), [1.0, 0.0]);
        let (bodies, inner) = (Vec::new(), Vec::new());
        return Bodies { lattice, bounds: [[0; 3]; 2], bodies, detail, not_carved, inner, mended: 0 };
    };
    let (near, far): (Vec<_>, Vec<_>) = all.into_iter().partition(|s| is_near(s.bounds, middle));
    not_carved.extend(far.iter().map(|shells| (shells.pieces.id, NotCarved::Far)));
    for shells in far.iter().filter(|s| s.is_solid) {
        let triangles = shells.closed.iter().flat_map(|closed| &closed.component.triangles);
        detail.extend(triangles.map(|&t| (shells.pieces.id, shells.pieces.source_of(t))));
        detail.extend(shells.pieces.inner.iter().map(|&t| (shells.pieces.id, t)));
    }
    let reach = near.iter().flat_map(|s| s.bounds).flatten().fold(0.0f64, |reach, c| reach.max(c.abs()));
    let carving = near.iter().filter(|s| s.is_solid).map(|s| s.pieces.id.0);
    let turn = direction(model, carving, reach, 1.0 / f64::from(1u32 << Lattice::FINEST));
    // The hull is larger than the bodies, and on the lattice too, however that is turned.
    let margin = 2.0 * super::MARGIN;
    let points = near.iter().flat_map(|s| &s.pieces.mesh.positions);
    let points = points.flat_map(|p| [p.map(|c| c - margin), p.map(|c| c + margin)]);
    let lattice = Lattice::about(points, turn);
    let bodies: Vec<Body> = near.iter().flat_map(|shells| bodies_of(shells, &lattice)).collect();
    let mut bounds = [[i32::MAX; 3], [i32::MIN; 3]];
    for vertex in bodies.iter().flat_map(|body| &body.vertices) {
        for (axis, c) in [vertex.at.x, vertex.at.y, vertex.z].into_iter().enumerate() {
            bounds[0][axis] = bounds[0][axis].min(c);
            bounds[1][axis] = bounds[1][axis].max(c);
        }
    }
    let mut inner = Vec::new();
    for shells in near.iter().filter(|s| s.is_solid) {
        let mesh = &model.elements[shells.pieces.id.0 as usize].mesh;
        let corners = |t: u32| mesh.corners(t as usize).map(|p| lattice.local(p));
        inner.extend(shells.pieces.inner.iter().map(|&triangle| MatterTriangle {
            corners: corners(triangle),
            element: shells.pieces.id,
            triangle,
        }));
    }
    let mended = near.iter().filter(|s| s.pieces.source.is_some()).count() as u64;
    detail.sort_unstable();
    detail.dedup();
    not_carved.sort_unstable();
    Bodies { lattice, bounds, bodies, detail, not_carved, inner, mended }
}

/// The components of one element, sorted by what becomes of them.
#[derive(Default)]
struct Sorted<'m> {
    shells: Vec<Shells<'m>>,
    detail: Vec<(ElementId, u32)>,
    not_carved: Vec<(ElementId, NotCarved)>,
}

fn sort_components<'m>(model: &'m Model, untagged: Untagged) -> Vec<Sorted<'m>> {
    parallel::map(model.elements.len(), |index| {
        let (id, element) = (ElementId(index as u32), &model.elements[index]);
        let asked = asked_role(element, untagged);
        let mut sorted = Sorted::default();
        let open = sort_mesh(&mut sorted, Pieces::whole(id, &element.mesh), asked);
        // Labels too: rooms are written by the same tools.
        if !open.is_empty() {
            let Mended { mesh, source, inner } = mend(&element.mesh, &open);
            let pieces = Pieces { id, mesh: Cow::Owned(mesh), source: Some(source), inner };
            sort_mesh(&mut sorted, pieces, asked);
        }
        sorted
    })
}

/// A mesh whose components are to be sorted.
struct Pieces<'m> {
    id: ElementId,
    /// The element's own, or a mended one.
    mesh: Cow<'m, Mesh>,
    /// The index of each of its triangles in the element's mesh, if it is not that.
    source: Option<Vec<u32>>,
    /// Triangles of the element's mesh that were left inside.
    inner: Vec<u32>,
}

impl<'m> Pieces<'m> {
    fn whole(id: ElementId, mesh: &'m Mesh) -> Pieces<'m> {
        Pieces { id, mesh: Cow::Borrowed(mesh), source: None, inner: Vec::new() }
    }

    /// The index in the element's mesh of one of the triangles.
    fn source_of(&self, triangle: u32) -> u32 {
        self.source.as_ref().map_or(triangle, |source| source[triangle as usize])
    }
}

/// Sorts the components of a mesh. Returns the triangles of those that are open and may be mended; if it was mended
/// already, they are detail.
fn sort_mesh<'m>(sorted: &mut Sorted<'m>, pieces: Pieces<'m>, asked: Option<Role>) -> Vec<u32> {
    let (id, mesh) = (pieces.id, pieces.mesh.as_ref());
    let asks_solid = matches!(asked, Some(Role::Solid));
    let may_mend = pieces.source.is_none() && matches!(asked, Some(Role::Solid | Role::Air));
    let mut open = Vec::new();
    let mut closed: Vec<Closed> = Vec::new();
    let mut is_solid = false;
    let mut leave = |component: &Component, why: Option<NotCarved>| {
        sorted.detail.extend(component.triangles.iter().map(|&t| (id, pieces.source_of(t))));
        sorted.not_carved.extend(why.map(|why| (id, why)));
    };
    for component in components(mesh) {
        if !component.closed && may_mend {
            open.extend(component.triangles);
            continue;
        }
        match component_role(asked, &component) {
            Role::Ignore => {}
            Role::Detail => leave(&component, asks_solid.then_some(NotCarved::Open)),
            Role::Air if !component.closed => {}
            role @ (Role::Air | Role::Solid) => {
                is_solid = role == Role::Solid;
                let turned = |shell: Shell| {
                    let outward = turn_outward(mesh, &shell, component.bounds);
                    (shell, outward)
                };
                let shells = shells(mesh, &component).into_iter().map(turned).collect();
                closed.push(Closed { component, shells });
            }
        }
    }
    // A cavity belongs to the shell around it: with cavities, all or none of the element's components carve.
    let whole: f64 = closed.iter().map(Closed::volume).sum();
    let has_cavity = closed.iter().any(|closed| (closed.volume() < 0.0) != (whole < 0.0));
    if is_solid {
        if has_cavity {
            let faces: usize = closed.iter().map(|closed| face_count(mesh, closed)).sum();
            if let Some(why) = too_costly(faces, whole) {
                closed.iter().for_each(|closed| leave(&closed.component, Some(why)));
                closed.clear();
            }
        } else {
            closed.retain(|closed| {
                let why = too_costly(face_count(mesh, closed), closed.volume());
                if why.is_some() {
                    leave(&closed.component, why);
                }
                why.is_none()
            });
        }
    }
    match closed.first() {
        Some(first) => {
            let bounds = closed.iter().fold(first.component.bounds, |[lo, hi], closed| {
                let [from, to] = closed.component.bounds;
                [[0, 1, 2].map(|i| lo[i].min(from[i])), [0, 1, 2].map(|i| hi[i].max(to[i]))]
            });
            sorted.shells.push(Shells { pieces, is_solid, closed, bounds });
        }
        None if asks_solid => sorted.detail.extend(pieces.inner.iter().map(|&t| (id, t))),
        None => {}
    }
    open
}

fn too_costly(faces: usize, volume: f64) -> Option<NotCarved> {
    if volume.abs() < LEAST_VOLUME {
        return Some(NotCarved::Flat);
    }
    let most = (FACES_PER_CUBIC_METRE * volume.abs()).max(FEW_FACES as f64);
    (faces as f64 > most).then_some(NotCarved::TooManyFaces)
}

/// How many planar faces a component has: triangles of one plane, told by their quantised planes, count once.
fn face_count(mesh: &Mesh, closed: &Closed) -> usize {
    let origin = glam::DVec3::from(closed.component.bounds[0]);
    let triangles = closed.shells.iter().flat_map(|(_, outward)| &outward.triangles);
    let mut planes: Vec<[i64; 4]> = triangles
        .map(|t| {
            let [a, b, c] = t.map(|v| glam::DVec3::from(mesh.positions[v as usize]));
            let normal = (b - a).cross(c - a).normalize_or_zero();
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

/// The bodies of an element: the shells that agree bound one together, each other shell one by itself.
fn bodies_of(shells: &Shells<'_>, lattice: &Lattice) -> Vec<Body> {
    let all = || shells.closed.iter().flat_map(|closed| &closed.shells);
    let (together, others): (Vec<_>, Vec<_>) = all().partition(|(shell, _)| shell.inside == Inside::Together);
    let groups = [together].into_iter().chain(others.into_iter().map(|shell| vec![shell]));
    let mut index = vec![u32::MAX; shells.pieces.mesh.positions.len()];
    groups.filter(|group| !group.is_empty()).map(|group| body(shells, &group, lattice, &mut index)).collect()
}

/// `index` is for every vertex of the mesh, and is left as it came: `u32::MAX` for all.
fn body(shells: &Shells<'_>, group: &[&(Shell, Outward)], lattice: &Lattice, index: &mut [u32]) -> Body {
    let mesh = &shells.pieces.mesh;
    let mut body = Body {
        element: shells.pieces.id,
        is_solid: shells.is_solid,
        vertices: Vec::new(),
        exact: Vec::new(),
        triangles: Vec::new(),
        by_winding: group.iter().all(|(shell, _)| shell.inside != Inside::ByParity),
        volume: group.iter().map(|(_, outward)| outward.volume).sum(),
    };
    for (shell, outward) in group {
        for (&source, corners) in shell.triangles.iter().zip(&outward.triangles) {
            let corners = corners.map(|v| {
                let slot = &mut index[v as usize];
                if *slot == u32::MAX {
                    *slot = body.vertices.len() as u32;
                    let exact = lattice.local(mesh.positions[v as usize]);
                    let [x, y, z] = Lattice::round(exact);
                    body.exact.push(exact);
                    body.vertices.push(Vertex { at: Point::new(x, y), z });
                }
                *slot
            });
            body.triangles.push(Corner3 { corners, source: shells.pieces.source_of(source) });
        }
    }
    let corners = group.iter().flat_map(|(_, outward)| outward.triangles.iter().flatten());
    corners.for_each(|&v| index[v as usize] = u32::MAX);
    if body.volume < 0.0 {
        body.triangles.iter_mut().for_each(|t| t.corners.swap(1, 2));
        body.volume = -body.volume;
    }
    body
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::components::rotated;
    use crate::generate::{HouseOptions, Style, house};

    /// However damaged a model is, each triangle that rays can meet is of a body, inside of one, or detail; but for exact
    /// copies of others.
    #[test]
    fn no_triangle_is_lost() {
        let building = house(&HouseOptions::default());
        for seed in 0..12 {
            let style = Style::damage([0.1, 0.3, 0.7][seed as usize % 3], seed);
            let model = building.export(&style).to_model().unwrap();
            let bodies = gather(&model, Untagged::default());
            let mut known: BTreeSet<(ElementId, u32)> = bodies.detail.iter().copied().collect();
            for body in bodies.bodies.iter().filter(|body| body.is_solid) {
                known.extend(body.triangles.iter().map(|t| (body.element, t.source)));
            }
            known.extend(bodies.inner.iter().map(|t| t.name()));
            assert!(bodies.mended > 0 || seed % 3 == 0, "{seed}");
            for (index, element) in model.elements.iter().enumerate() {
                if !matches!(asked_role(element, Untagged::default()), Some(Role::Solid | Role::Detail)) {
                    continue;
                }
                let id = ElementId(index as u32);
                let mut copies = BTreeSet::new();
                for (t, &corners) in element.mesh.triangles.iter().enumerate() {
                    let is_first = copies.insert(rotated(corners));
                    assert!(
                        !is_first || known.contains(&(id, t as u32)),
                        "seed {seed}: {} triangle {t}",
                        element.path
                    );
                }
            }
        }
    }
}
