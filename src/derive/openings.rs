//! Openings for the doors and windows of a model that have none.

use std::collections::BTreeMap;

use enfilade_importers::{Element, ElementId, MaterialId, Mesh, Model, Role, Semantic, Untagged, Watch};
use glam::DVec3;

use super::holes::Hole;
use super::index::Index;
use super::matter::{Bounds, Solids};
use super::{DeriveReport, Ids, derived};
use crate::roles::roles;

/// A hole that has so much of another in it is the same: a frame and its panes.
const SAME: f64 = 0.5;

/// The openings that doors and windows should have and do not. Of a cancelled watch nothing is made.
pub(super) fn missing(
    model: &Model,
    untagged: Untagged,
    watch: &Watch,
    report: &mut DeriveReport,
) -> Vec<Element> {
    let roles = roles(model, untagged);
    let fillings = unopened(model, &roles);
    if fillings.is_empty() {
        return Vec::new();
    }
    let solids = Solids::of(model, &roles);
    let around = |i: usize| {
        watch.check().ok()?;
        let mesh = &model.elements[fillings[i].0 as usize].mesh;
        let corners: Vec<DVec3> = mesh.positions.iter().map(|&p| p.into()).collect();
        Hole::around(&corners, &solids)
    };
    let holes = crate::parallel::map(fillings.len(), around);
    let mut found: Vec<(ElementId, Hole)> = Vec::new();
    let openings = Openings::of(model);
    for (&filling, hole) in fillings.iter().zip(holes) {
        match hole {
            // A door that stands open is elsewhere, and its opening is there all the same.
            Some(hole) if openings.hold(hole.middle()) => {}
            Some(hole) => found.push((filling, hole)),
            None => report.without_hole.push(model.elements[filling.0 as usize].path.clone()),
        }
    }
    // Panes are of the frame around them; else the larger leads.
    found.sort_by(|a, b| {
        let rank = |(filling, hole): &(ElementId, Hole)| {
            (model.elements[filling.0 as usize].semantic == Semantic::Glass, -hole.volume())
        };
        let (a, b) = ((rank(a), a.0), (rank(b), b.0));
        a.0.0.cmp(&b.0.0).then(a.0.1.total_cmp(&b.0.1)).then(a.1.cmp(&b.1))
    });
    let boxes: Vec<Bounds> = found.iter().map(|(_, hole)| hole.bounds()).collect();
    let index = Index::new(&boxes);
    let mut is_kept = vec![false; found.len()];
    for (i, (_, hole)) in found.iter().enumerate() {
        let mut is_known = false;
        index.within(&boxes[i], |other| {
            let other = other as usize;
            is_known |= is_kept[other] && hole.share_in(&found[other].1) > SAME;
        });
        is_kept[i] = !is_known;
    }
    let mut kept: Vec<(ElementId, Hole)> =
        found.into_iter().zip(is_kept).filter(|(_, is_kept)| *is_kept).map(|(found, _)| found).collect();
    kept.sort_by_key(|(filling, _)| *filling);
    let mut ids = Ids::of(model);
    report.openings += kept.len() as u64;
    kept.iter().map(|(filling, hole)| opening(model, *filling, hole, &mut ids)).collect()
}

fn is_opening(element: &Element) -> bool {
    matches!(element.semantic, Semantic::Door | Semantic::Window | Semantic::Opening)
        && !element.mesh.triangles.is_empty()
}

/// The boxes around a model's openings.
struct Openings {
    boxes: Vec<Bounds>,
    index: Index,
}

impl Openings {
    fn of(model: &Model) -> Openings {
        let openings = model.elements.iter().filter(|element| is_opening(element));
        let around = |e: &Element| Bounds::of(e.mesh.positions.iter().map(|&p| p.into())).grown(1e-3);
        let boxes: Vec<Bounds> = openings.map(around).collect();
        let index = Index::new(&boxes);
        Openings { boxes, index }
    }

    /// Whether a point is in any of them.
    fn hold(&self, point: DVec3) -> bool {
        let mut any = false;
        self.index.within(&Bounds { lo: point, hi: point }, |i| any |= self.boxes[i as usize].holds(point));
        any
    }
}

/// The doors and windows that no opening is there for.
fn unopened(model: &Model, roles: &[Role]) -> Vec<ElementId> {
    let openings: BTreeMap<&str, &Element> =
        model.elements.iter().filter(|e| is_opening(e)).map(|e| (e.id.as_str(), e)).collect();
    let filled: std::collections::BTreeSet<&str> =
        openings.values().filter_map(|opening| opening.filling.as_deref()).collect();
    let boxes = Openings::of(model);
    let mut unopened = Vec::new();
    for (element, i) in model.elements.iter().zip(0..) {
        let is_filling =
            matches!(element.semantic, Semantic::DoorLeaf | Semantic::WindowFrame | Semantic::Glass);
        if !is_filling || roles[i as usize] != Role::Detail || element.mesh.triangles.is_empty() {
            continue;
        }
        let is_known = element.opening.as_deref().is_some_and(|id| openings.contains_key(id))
            || filled.contains(element.id.as_str());
        let bounds = Bounds::of(element.mesh.positions.iter().map(|&p| p.into()));
        if !is_known && !boxes.hold((bounds.lo + bounds.hi) / 2.0) {
            unopened.push(ElementId(i));
        }
    }
    unopened
}

impl Hole {
    fn size(&self) -> [f64; 3] {
        self.range.map(|[lo, hi]| hi - lo)
    }

    fn middle(&self) -> DVec3 {
        (0..3).map(|axis| self.axes[axis] * ((self.range[axis][0] + self.range[axis][1]) / 2.0)).sum()
    }

    fn volume(&self) -> f64 {
        self.size().iter().product()
    }

    fn corner(&self, at: [usize; 3]) -> DVec3 {
        (0..3).map(|axis| self.axes[axis] * self.range[axis][at[axis]]).sum()
    }

    /// The box around it.
    fn bounds(&self) -> Bounds {
        Bounds::of((0..8).map(|i| self.corner([i & 1, i >> 1 & 1, i >> 2])))
    }

    /// The share of it that lies in another, as their boxes along that one's axes say.
    fn share_in(&self, other: &Hole) -> f64 {
        let corners: Vec<DVec3> = (0..8).map(|i| self.corner([i & 1, i >> 1 & 1, i >> 2])).collect();
        let mut share = 1.0;
        for (axis, [lo, hi]) in other.axes.iter().zip(other.range) {
            let own = corners.iter().map(|corner| corner.dot(*axis));
            let [from, to] = own.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], c| [a.min(c), b.max(c)]);
            share *= ((to.min(hi) - from.max(lo)) / (to - from).max(1e-9)).clamp(0.0, 1.0);
        }
        share
    }

    fn mesh(&self) -> Mesh {
        // Corner i has the far end along axis k where bit k of i is set.
        let positions = (0..8).map(|i| self.corner([i & 1, i >> 1 & 1, i >> 2]).to_array()).collect();
        let mut triangles = Vec::with_capacity(12);
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        // Axes may be left-handed.
        let is_right = self.axes[0].cross(self.axes[1]).dot(self.axes[2]) > 0.0;
        for [a, b, c, d] in quads {
            let both = if is_right { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            triangles.extend(both);
        }
        let materials = vec![MaterialId(0); triangles.len()];
        Mesh { positions, triangles, materials }
    }
}

fn opening(model: &Model, filling: ElementId, hole: &Hole, ids: &mut Ids) -> Element {
    let filling = &model.elements[filling.0 as usize];
    let semantic = if filling.semantic == Semantic::DoorLeaf { Semantic::Door } else { Semantic::Window };
    Element {
        place: filling.place.clone(),
        path: format!("{}/opening", filling.path),
        storey: filling.storey.clone(),
        host: Some(model.elements[hole.host.0 as usize].id.clone()),
        filling: Some(filling.id.clone()),
        ..derived(
            ids.unused(format!("opening:{}", filling.id)),
            filling.name.clone(),
            "IfcOpeningElement",
            semantic,
            hole.mesh(),
        )
    }
}
