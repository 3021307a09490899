//! What is solid along a line.

use std::collections::BTreeMap;

use enfilade_importers::{ElementId, Model, Role};
use glam::DVec3;

/// A triangle of a solid element.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    pub(super) corners: [DVec3; 3],
    pub(super) element: ElementId,
    lo: DVec3,
    hi: DVec3,
}

/// A box, metres, internal frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) lo: DVec3,
    pub(super) hi: DVec3,
}

impl Bounds {
    pub(super) fn of(points: impl IntoIterator<Item = DVec3>) -> Bounds {
        let empty = Bounds { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };
        points.into_iter().fold(empty, |b, p| Bounds { lo: b.lo.min(p), hi: b.hi.max(p) })
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

/// The boxes of a model's solid elements.
pub(super) struct Solids<'m> {
    model: &'m Model,
    boxes: Vec<(ElementId, Bounds)>,
}

impl<'m> Solids<'m> {
    pub(super) fn of(model: &'m Model, roles: &[Role]) -> Solids<'m> {
        let solid = model.elements.iter().zip(0..).filter(|(_, i)| roles[*i as usize] == Role::Solid);
        let boxes =
            solid.map(|(e, i)| (ElementId(i), Bounds::of(e.mesh.positions.iter().map(|&p| p.into()))));
        Solids { model, boxes: boxes.filter(|(_, bounds)| !bounds.is_empty()).collect() }
    }

    /// The triangles of all solids that are straight above a place.
    pub(super) fn above(&self, place: DVec3) -> Near {
        let column = Bounds { lo: place, hi: DVec3::new(place.x, place.y, f64::INFINITY) };
        self.gather(&column, |facet| facet.meets(&column))
    }

    /// All triangles of the solids that come near a box: lines through it may meet the far side of one.
    pub(super) fn near(&self, bounds: &Bounds) -> Near {
        self.gather(bounds, |_| true)
    }

    fn gather(&self, bounds: &Bounds, is_wanted: impl Fn(&Bounds) -> bool) -> Near {
        let mut facets = Vec::new();
        for (element, _) in self.boxes.iter().filter(|(_, own)| own.meets(bounds)) {
            let mesh = &self.model.elements[element.0 as usize].mesh;
            for triangle in 0..mesh.triangles.len() {
                let corners = mesh.corners(triangle).map(DVec3::from);
                let own = Bounds::of(corners);
                if is_wanted(&own) {
                    facets.push(Facet { corners, element: *element, lo: own.lo, hi: own.hi });
                }
            }
        }
        Near { facets }
    }
}

/// Matter from one place to another of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) element: ElementId,
}

/// The triangles of the solids near some place.
pub(super) struct Near {
    facets: Vec<Facet>,
}

impl Near {
    /// The triangles that reach into a box.
    pub(super) fn within<'a>(&'a self, bounds: &'a Bounds) -> impl Iterator<Item = &'a Facet> + 'a {
        self.facets.iter().filter(|f| bounds.meets(&Bounds { lo: f.lo, hi: f.hi }))
    }

    /// Where the line from `start` along `direction` (of unit length) crosses surfaces, in turn: with the element, and 1 where it enters it by the
    /// surface's front, -1 where it leaves.
    fn crossings(&self, start: DVec3, direction: DVec3) -> Vec<(ElementId, f64, i32)> {
        let mut crossings = Vec::new();
        for facet in &self.facets {
            if !may_cross(facet, start, direction) {
                continue;
            }
            let [a, b, c] = facet.corners;
            let normal = (b - a).cross(c - a);
            let slant = normal.dot(direction);
            if slant.abs() <= 1e-9 * normal.length() {
                continue;
            }
            let t = normal.dot(a - start) / slant;
            let point = start + direction * t;
            let side = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal);
            if side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0 {
                crossings.push((facet.element, t, if slant < 0.0 { 1 } else { -1 }));
            }
        }
        crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        crossings
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

/// Whether a line may come near the box of a triangle: quick, never wrongly no.
fn may_cross(facet: &Facet, start: DVec3, direction: DVec3) -> bool {
    let middle = (facet.lo + facet.hi) / 2.0 - start;
    let reach = (facet.hi - facet.lo) / 2.0;
    // The box's shadow across the line: its distance from the line against its half diagonal.
    let off = middle - direction * middle.dot(direction);
    off.length_squared() <= reach.length_squared() * (1.0 + 1e-9) + 1e-18
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
