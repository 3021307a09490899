//! What is solid along a line.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, Model, Role};
use glam::DVec3;

use super::index::Index;

/// A box, metres, internal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
}

impl Bounds {
    /// Of nothing.
    pub(super) const EMPTY: Bounds = Bounds { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    pub(super) fn of(points: impl IntoIterator<Item = DVec3>) -> Bounds {
        points.into_iter().fold(Bounds::EMPTY, |b, p| Bounds { lo: b.lo.min(p), hi: b.hi.max(p) })
    }

    pub(super) fn union(self, other: &Bounds) -> Bounds {
        Bounds { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Whether a line may come to the box: quick, never wrongly no.
    pub(super) fn may_be_crossed(&self, start: DVec3, direction: DVec3) -> bool {
        let middle = (self.lo + self.hi) / 2.0 - start;
        let reach = (self.hi - self.lo) / 2.0;
        // Across each axis and the line: the box's shadow there, rounding aside.
        let off = middle.cross(direction).abs();
        let d = direction.abs();
        let most = DVec3::new(
            reach.y * d.z + reach.z * d.y,
            reach.z * d.x + reach.x * d.z,
            reach.x * d.y + reach.y * d.x,
        );
        let rounding = 1e-12 * (middle.abs().max_element() + reach.max_element()) + 1e-12;
        off.cmple(most * (1.0 + 1e-9) + rounding).all()
    }

    pub(super) fn grown(self, by: f64) -> Bounds {
        Bounds { lo: self.lo - by, hi: self.hi + by }
    }

    pub(super) fn meets(&self, other: &Bounds) -> bool {
        self.lo.cmple(other.hi).all() && other.lo.cmple(self.hi).all()
    }

    pub(super) fn holds(&self, p: DVec3) -> bool {
        self.lo.cmple(p).all() && p.cmple(self.hi).all()
    }

    pub(super) fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }
}

/// The solid elements of a model.
pub(super) struct Solids {
    solids: Vec<Solid>,
    index: Index,
}

/// A solid element.
struct Solid {
    element: ElementId,
    bounds: Bounds,
    /// Its triangles, their boxes, and a tree over these.
    corners: Vec<[DVec3; 3]>,
    boxes: Vec<Bounds>,
    index: Index,
}

impl Solids {
    pub(super) fn of(model: &Model, roles: &[Role]) -> Solids {
        let solid = |i: usize| -> Option<Solid> {
            let mesh = &model.elements[i].mesh;
            let bounds = Bounds::of(mesh.positions.iter().map(|&p| p.into()));
            if roles[i] != Role::Solid || bounds.is_empty() {
                return None;
            }
            let corners: Vec<[DVec3; 3]> =
                (0..mesh.triangles.len()).map(|triangle| mesh.corners(triangle).map(DVec3::from)).collect();
            let boxes: Vec<Bounds> = corners.iter().map(|corners| Bounds::of(*corners)).collect();
            let index = Index::new(&boxes);
            Some(Solid { element: ElementId(i as u32), bounds, corners, boxes, index })
        };
        let solids: Vec<Solid> =
            crate::parallel::map(model.elements.len(), solid).into_iter().flatten().collect();
        let boxes: Vec<Bounds> = solids.iter().map(|solid| solid.bounds).collect();
        Solids { solids, index: Index::new(&boxes) }
    }

    /// The solids that are straight above a place.
    pub(super) fn above(&self, place: DVec3) -> Near<'_> {
        self.near(&Bounds { lo: place, hi: DVec3::new(place.x, place.y, f64::INFINITY) })
    }

    /// The solids that come near a box, with all that they are: lines through it may meet the far side of one.
    pub(super) fn near(&self, bounds: &Bounds) -> Near<'_> {
        let mut near = Vec::new();
        self.index.within(bounds, |i| {
            if self.solids[i as usize].bounds.meets(bounds) {
                near.push(i);
            }
        });
        near.sort_unstable();
        Near { solids: near.into_iter().map(|i| &self.solids[i as usize]).collect() }
    }
}

/// Matter from one place to another of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) element: ElementId,
}

/// The solids near some place, in their order.
pub(super) struct Near<'a> {
    solids: Vec<&'a Solid>,
}

impl Near<'_> {
    /// The triangles that reach into a box, in the order of their elements.
    pub(super) fn within(&self, bounds: &Bounds) -> Vec<[DVec3; 3]> {
        let mut found = Vec::new();
        for solid in &self.solids {
            let mut own = Vec::new();
            solid.index.within(bounds, |i| {
                if solid.boxes[i as usize].meets(bounds) {
                    own.push(i);
                }
            });
            own.sort_unstable();
            found.extend(own.into_iter().map(|i| solid.corners[i as usize]));
        }
        found
    }

    /// Where the line from `start` along `direction` (of unit length) crosses surfaces, in turn: with the element, and 1 where it enters it by the
    /// surface's front, -1 where it leaves.
    fn crossings(&self, start: DVec3, direction: DVec3) -> Vec<(ElementId, f64, i32)> {
        let mut crossings = Vec::new();
        for solid in self.solids.iter().filter(|solid| solid.bounds.may_be_crossed(start, direction)) {
            let first = crossings.len();
            solid.crossings(start, direction, &mut crossings);
            crossings[first..].sort_by(|a, b| a.1.total_cmp(&b.1).then(a.2.cmp(&b.2)));
        }
        crossings.into_iter().map(|(element, t, _, sign)| (element, t, sign)).collect()
    }

    /// The matter along a line, by element. An element whose surfaces do not agree about its inside has it between each two.
    pub(super) fn spans(&self, start: DVec3, direction: DVec3) -> Vec<Span> {
        let mut spans = Vec::new();
        for run in self.crossings(start, direction).chunk_by(|a, b| a.0 == b.0) {
            // An edge of two triangles that is crossed exactly, and doubled faces, count once.
            let mut own: Vec<(f64, i32)> = Vec::new();
            for &(_, t, sign) in run {
                match own.last() {
                    Some(last) if t - last.0 < 1e-7 && last.1 == sign => {}
                    _ => own.push((t, sign)),
                }
            }
            let element = run[0].0;
            let agree = own.chunks(2).all(|pair| pair.len() == 2 && pair[0].1 == 1 && pair[1].1 == -1);
            let sum: i32 = own.iter().map(|crossing| crossing.1).sum();
            if agree || sum != 0 {
                spans.extend(own.chunks_exact(2).map(|pair| Span {
                    from: pair[0].0,
                    to: pair[1].0,
                    element,
                }));
                continue;
            }
            let (mut winding, mut from) = (0, 0.0);
            for (t, sign) in own {
                let before = winding;
                winding += sign;
                if before == 0 {
                    from = t;
                } else if winding == 0 {
                    spans.push(Span { from, to: t, element });
                }
            }
        }
        spans
    }

    /// How far it is from `start` to the first surface along `direction` (of unit length).
    pub(super) fn first(&self, start: DVec3, direction: DVec3) -> Option<f64> {
        let crossings = self.crossings(start, direction).into_iter().map(|crossing| crossing.1);
        crossings.filter(|t| *t >= 0.0).min_by(f64::total_cmp)
    }
}

impl Solid {
    /// Adds where a line crosses its surface: with the triangle, and which way.
    fn crossings(&self, start: DVec3, direction: DVec3, crossings: &mut Vec<(ElementId, f64, u32, i32)>) {
        self.index.along(start, direction, |i| {
            let [a, b, c] = self.corners[i as usize];
            let normal = (b - a).cross(c - a);
            let slant = normal.dot(direction);
            if slant.abs() <= 1e-9 * normal.length() {
                return;
            }
            let t = normal.dot(a - start) / slant;
            let point = start + direction * t;
            let side = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal);
            if side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0 {
                crossings.push((self.element, t, i, if slant < 0.0 { 1 } else { -1 }));
            }
        });
    }
}

/// Spans that overlap or have no more than `gap` between them, as one; with how much each element has of it.
pub(super) fn united(mut spans: Vec<Span>, gap: f64) -> Vec<([f64; 2], BTreeMap<ElementId, f64>)> {
    spans.sort_by(|a, b| a.from.total_cmp(&b.from).then(a.element.cmp(&b.element)));
    let mut united: Vec<([f64; 2], BTreeMap<ElementId, f64>)> = Vec::new();
    for span in spans {
        let joins = united.last().is_some_and(|last| span.from <= last.0[1] + gap);
        if !joins {
            united.push(([span.from, span.to], BTreeMap::new()));
        }
        let Some((range, elements)) = united.last_mut() else { continue };
        range[1] = range[1].max(span.to);
        *elements.entry(span.element).or_default() += span.to - span.from;
    }
    united
}
