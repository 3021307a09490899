//! What fills a point by the meshes as they came, without the partition.

use std::collections::BTreeSet;

use enfilade::components::{Orientation, components};
use enfilade::importers::{ElementId, Model, Role, Semantic, Untagged};
use enfilade::oracle::{Truth, TruthOptions};
use enfilade::partition::cells::Label;
use enfilade::partition::{PartitionReport, cells::Partition};
use enfilade::roles::roles;

/// The meshes, ready to be asked.
pub struct Meshes<'a> {
    pub model: &'a Model,
    solids: Truth,
    airs: Truth,
    roles: Vec<Role>,
    /// Unknown where triangles disagree about the outside.
    volumes: Vec<Option<f64>>,
    /// Elements with components that did not carve.
    demoted: BTreeSet<ElementId>,
    /// For each opening, whether it wins against rooms; `None` if that is not clear.
    wins: Vec<Option<bool>>,
    /// No point nearer to a surface is looked at, metres.
    pub margin: f64,
}

/// Near-vertical faces may be moved by 2 mm, nearly level ones by 1 mm, coplanar ones by 0.3 mm.
const MARGIN: f64 = 2.5e-3;
/// Points of an opening's air that tell how much of it rooms take.
const SAMPLES: u32 = 400;
/// Points tried for these.
const MOST_TRIED: u32 = 8000;

impl<'a> Meshes<'a> {
    pub fn new(
        model: &'a Model,
        partition: &Partition,
        report: &PartitionReport,
        random: &mut Random,
    ) -> Meshes<'a> {
        let roles = roles(model, Untagged::default());
        let of = |role: Role| {
            let roles = roles.clone();
            let only =
                move |e: ElementId| if roles[e.0 as usize] == role { Role::Solid } else { Role::Ignore };
            Truth::new(model, only, &TruthOptions::default())
        };
        let volume = |e: &enfilade::importers::Element| {
            let mesh: Vec<_> = (0..e.mesh.triangles.len()).map(|t| e.mesh.corners(t)).collect();
            let is_mixed = components(&e.mesh).iter().any(|c| c.orientation == Orientation::Mixed);
            (!is_mixed).then(|| volume(&mesh).abs())
        };
        let mut meshes = Meshes {
            model,
            solids: of(Role::Solid),
            airs: of(Role::Air),
            volumes: model.elements.iter().map(volume).collect(),
            demoted: report
                .not_carved_elements
                .iter()
                .filter_map(|(path, _)| model.elements.iter().position(|e| e.path == *path))
                .map(|index| ElementId(index as u32))
                .collect(),
            wins: Vec::new(),
            margin: MARGIN + 4.0 * partition.lattice.step() + report.largest_displacement,
            roles,
        };
        meshes.wins = (0..model.elements.len()).map(|e| meshes.opening_wins(e, random)).collect();
        meshes
    }

    fn is(&self, e: ElementId, kinds: &[Semantic]) -> bool {
        kinds.contains(&self.model.elements[e.0 as usize].semantic)
    }

    fn is_opening(&self, e: ElementId) -> bool {
        self.is(e, &[Semantic::Door, Semantic::Window, Semantic::Opening])
    }

    /// Whether an element labels a room.
    pub fn is_room(&self, e: ElementId) -> bool {
        self.is(e, &[Semantic::Room, Semantic::Stairwell])
    }

    /// Whether rooms would take more than 70 % of an opening's air.
    fn opening_wins(&self, e: usize, random: &mut Random) -> Option<bool> {
        let id = ElementId(e as u32);
        if !self.is_opening(id) {
            return Some(false);
        }
        let points = &self.model.elements[e].mesh.positions;
        let [lo, hi] = points.iter().fold([points[0]; 2], |[lo, hi], p| {
            [[0, 1, 2].map(|i| lo[i].min(p[i])), [0, 1, 2].map(|i| hi[i].max(p[i]))]
        });
        let (mut air, mut taken) = (0, 0);
        for _ in 0..MOST_TRIED {
            if air == SAMPLES {
                break;
            }
            let p = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
            let airs = self.airs.solids_at(p);
            if airs.contains(&id) && self.solids_at(p).is_empty() {
                air += 1;
                taken += i32::from(airs.iter().any(|&other| self.is_room(other)));
            }
        }
        match (air, f64::from(taken) / f64::from(air)) {
            (0..100, _) => None,
            (_, share) if share > 0.85 => Some(true),
            (_, share) if share < 0.55 => Some(false),
            _ => None,
        }
    }

    /// The solids that a point is inside of.
    pub fn solids_at(&self, p: [f64; 3]) -> Vec<ElementId> {
        self.solids.solids_at(p)
    }

    /// What may fill a point; nothing if that is not clear. Exterior stands for void too.
    pub fn labels_at(&self, p: [f64; 3]) -> Vec<Label> {
        let solids = self.solids_at(p);
        if solids.iter().any(|e| self.demoted.contains(e)) {
            return Vec::new();
        }
        if let Some(&first) = solids.first() {
            return vec![Label::Solid(first)];
        }
        let airs = self.airs.solids_at(p);
        if airs.iter().any(|e| self.demoted.contains(e)) {
            return Vec::new();
        }
        let pick = |wins: &dyn Fn(ElementId) -> bool| -> Vec<Label> {
            let rank = |&&e: &&ElementId| match () {
                () if self.is_opening(e) && wins(e) => 1,
                () if self.is_room(e) => 2,
                () if self.is_opening(e) => 3,
                () => 4,
            };
            let Some(best) = airs.iter().map(|e| rank(&e)).min() else { return vec![Label::Exterior] };
            let best: Vec<ElementId> = airs.iter().filter(|e| rank(e) == best).copied().collect();
            let least = best.iter().filter_map(|e| self.volumes[e.0 as usize]).fold(f64::INFINITY, f64::min);
            // Twins are equal but for roundings.
            let is_small = |volume: f64| volume <= least * (1.0 + 1e-9);
            let small = best.iter().filter(|e| self.volumes[e.0 as usize].is_none_or(is_small));
            small.map(|&e| Label::Air(e)).collect()
        };
        let of = |e: ElementId| self.wins[e.0 as usize];
        let mut labels = pick(&|e| of(e) == Some(true));
        if airs.iter().any(|&e| of(e).is_none()) {
            // Any of the unclear ones may win.
            labels.extend(pick(&|e| of(e) != Some(false)));
            labels.extend(airs.iter().map(|&e| Label::Air(e)));
        }
        labels
    }

    /// The distance of a point from the nearest surface that carves or labels.
    pub fn distance(&self, p: [f64; 3]) -> f64 {
        self.nearest(p, |e| matches!(self.roles[e.0 as usize], Role::Solid | Role::Air))
    }

    /// The distance of a point from the nearest surface that carves.
    pub fn distance_to_solids(&self, p: [f64; 3]) -> f64 {
        self.nearest(p, |e| self.roles[e.0 as usize] == Role::Solid)
    }

    /// The distance of a point from an element's surface.
    pub fn distance_to(&self, p: [f64; 3], element: ElementId) -> f64 {
        self.nearest(p, |e| e == element)
    }

    fn nearest(&self, p: [f64; 3], of: impl Fn(ElementId) -> bool) -> f64 {
        let elements = self.model.elements.iter().enumerate().filter(|(e, _)| of(ElementId(*e as u32)));
        elements
            .flat_map(|(_, element)| (0..element.mesh.triangles.len()).map(|t| element.mesh.corners(t)))
            .map(|corners| distance(corners, p))
            .fold(f64::INFINITY, f64::min)
    }
}

/// The distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
fn distance([a, b, c]: [[f64; 3]; 3], p: [f64; 3]) -> f64 {
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = |a: [f64; 3], d: [f64; 3], s: f64| [a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]];
    let to = |q: [f64; 3]| dot(sub(p, q), sub(p, q)).sqrt();
    let (ab, ac, ap) = (sub(b, a), sub(c, a), sub(p, a));
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return to(a);
    }
    let bp = sub(p, b);
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    if d3 >= 0.0 && d4 <= d3 {
        return to(b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return to(along(a, ab, d1 / (d1 - d3)));
    }
    let cp = sub(p, c);
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    if d6 >= 0.0 && d5 <= d6 {
        return to(c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return to(along(a, ac, d2 / (d2 - d6)));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return to(along(b, sub(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6))));
    }
    let whole = va + vb + vc;
    to(along(along(a, ab, vb / whole), ac, vc / whole))
}

/// The volume inside a closed mesh, by the divergence theorem; less than nothing if it is inside out.
fn volume(mesh: &[[[f64; 3]; 3]]) -> f64 {
    let six = |[a, b, c]: &[[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.iter().map(six).sum::<f64>() / 6.0
}

/// Numbers without order, the same on every machine.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub fn direction(&mut self) -> [f64; 3] {
        let (z, turn) = (self.between(-1.0, 1.0), self.between(0.0, std::f64::consts::TAU));
        let across = (1.0 - z * z).sqrt();
        [across * turn.cos(), across * turn.sin(), z]
    }
}
