//! Triangles of bodies by how they lie: level, sloped, nearly vertical, vertical; and the planes they share.
//!
//! - A triangle that rises by no more than a millimetre is *level*, at the height that most area near it has.
//! - A *sloped* one takes the plane of the largest triangle near whose plane its corners lie, over the whole model, so that
//!   a roof and the attic under it share one plane.
//! - One that is so steep that it runs no farther than two millimetres is a *sheet*: it is replaced by a level piece at
//!   its lower or upper edge, so that matter shrinks and labels grow. Its own plane would explode on strips one unit wide.
//!   So is one steeper than planes can be ([`Plane::STEEPEST`]): where it rises by more than 8 m, by more than those two
//!   millimetres, up to 5 cm over 200 m.
//!   One that *leans* on a sloped face, as a gable does, is replaced by a piece along that slope.
//! - A *vertical* one has no area in the plan. It only closes what roundings part, and is treated as a sheet for that.

use std::collections::BTreeMap;

use glam::DVec3;

use super::bodies::{Bodies, Body, Corner3, Vertex};
use crate::lattice::{Lattice, Plane, orient};

/// How a triangle lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Lie {
    /// In this level or sloped plane.
    Flat(Plane),
    /// Nearly vertical: replaced by a level piece.
    Sheet,
    /// Without area in the plan.
    Vertical,
}

/// A triangle on the lattice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) body: u32,
    /// Whether the body carves; else it labels air.
    pub(super) is_solid: bool,
    pub(super) corners: [Vertex; 3],
    pub(super) lie: Lie,
    /// How far it runs in the plan, lattice units, if it is a sheet.
    pub(super) run: f32,
    /// Whether it is a sheet or vertical, and shares an edge that is not level with a triangle that is neither.
    pub(super) leans: bool,
}

impl Triangle {
    /// Lowest and highest corner.
    pub(super) fn rise(&self) -> [i32; 2] {
        let z = self.corners.map(|v| v.z);
        [z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2])]
    }

    /// Twice the area in the plan; positive if it looks up.
    pub(super) fn double_area(&self) -> i64 {
        orient(self.corners[0].at, self.corners[1].at, self.corners[2].at)
    }
}

/// A triangle that rises by no more counts as level, metres.
const TILT: f64 = 1e-3;
/// A triangle that runs no farther is a sheet, metres.
const RUN: f64 = 2e-3;
/// Corners no farther from a plane than this lie in it, metres.
const COPLANAR: f64 = 3e-4;
/// Level heights no farther apart than this may be one, lattice units: roundings of one height.
const SAME_LEVEL: i32 = 2;

/// All triangles of the bodies. Moves the heights of vertices of level triangles to their level.
pub(super) fn lay(bodies: &mut Bodies) -> Vec<Triangle> {
    let lattice = bodies.lattice;
    let levels = Levels::of(&bodies.bodies, &lattice);
    for body in &mut bodies.bodies {
        levels.settle(body);
    }
    let mut triangles = Vec::new();
    let mut sloped = Vec::new();
    for (b, body) in bodies.bodies.iter().enumerate() {
        for t in &body.triangles {
            let corners = t.corners.map(|v| body.vertices[v as usize]);
            let exact = t.corners.map(|v| DVec3::from(body.exact[v as usize]));
            let mut triangle = Triangle {
                body: b as u32,
                is_solid: body.is_solid,
                corners,
                lie: Lie::Vertical,
                run: 0.0,
                leans: false,
            };
            if triangle.double_area() != 0 {
                if let Some(z) = levels.of_triangle(corners) {
                    triangle.lie = Lie::Flat(Plane::level(z));
                } else {
                    let normal = (exact[1] - exact[0]).cross(exact[2] - exact[0]);
                    let slope = normal.truncate().length() / normal.z.abs();
                    let [low, high] = triangle.rise();
                    let run = f64::from(high - low) / slope;
                    if slope.is_nan() || slope > Plane::STEEPEST || run <= lattice.steps(RUN) {
                        triangle.lie = Lie::Sheet;
                        triangle.run = if run.is_finite() { run as f32 } else { 0.0 };
                    } else {
                        sloped.push(Sloped { index: triangles.len(), exact, normal });
                    }
                }
            }
            triangles.push(triangle);
        }
    }
    share_planes(sloped, &lattice, &mut triangles);
    lean(&bodies.bodies, levels.tilt, &mut triangles);
    triangles
}

/// Finds the steep triangles that lean on faces.
fn lean(bodies: &[Body], tilt: i32, triangles: &mut [Triangle]) {
    let mut rest = triangles;
    for body in bodies {
        let (own, others) = rest.split_at_mut(body.triangles.len());
        rest = others;
        let slopes = |t: &Corner3| {
            [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
                let (a, b) = (t.corners[i], t.corners[j]);
                let (p, q) = (body.vertices[a as usize], body.vertices[b as usize]);
                ((p.z - q.z).abs() > tilt && p.at != q.at).then_some([a.min(b), a.max(b)])
            })
        };
        let is_flat = |t: &Triangle| matches!(t.lie, Lie::Flat(_));
        let flat = own.iter().zip(&body.triangles).filter(|(t, _)| is_flat(t));
        let mut edges: Vec<[u32; 2]> = flat.flat_map(|(_, corners)| slopes(corners)).flatten().collect();
        edges.sort_unstable();
        if edges.is_empty() {
            continue;
        }
        for (t, corners) in own.iter_mut().zip(&body.triangles).filter(|(t, _)| !is_flat(t)) {
            t.leans = slopes(corners).iter().flatten().any(|edge| edges.binary_search(edge).is_ok());
        }
    }
}

/// How much area lies level at which height.
struct Levels {
    tilt: i32,
    /// Twice the area by height.
    area: BTreeMap<i32, i128>,
}

impl Levels {
    fn of(bodies: &[Body], lattice: &Lattice) -> Levels {
        let mut levels = Levels { tilt: lattice.steps(TILT).round() as i32, area: BTreeMap::new() };
        for body in bodies {
            for t in &body.triangles {
                let corners = t.corners.map(|v| body.vertices[v as usize]);
                let area = orient(corners[0].at, corners[1].at, corners[2].at).unsigned_abs();
                let [low, high] = rise(corners);
                if area > 0 && high - low <= levels.tilt {
                    *levels.area.entry(low + (high - low) / 2).or_default() += i128::from(area);
                }
            }
        }
        levels
    }

    /// The height of a level triangle: the commonest near it. `None` if it is not level.
    fn of_triangle(&self, corners: [Vertex; 3]) -> Option<i32> {
        let [low, high] = rise(corners);
        if high - low > self.tilt {
            return None;
        }
        let near = self.area.range(low - SAME_LEVEL..=high + SAME_LEVEL);
        // The lowest of equals.
        near.fold(None, |best: Option<(i32, i128)>, (&z, &area)| match best {
            Some((_, most)) if most >= area => best,
            _ => Some((z, area)),
        })
        .map(|(z, _)| z)
    }

    /// Moves the vertices of level triangles to their level; the largest triangle decides.
    fn settle(&self, body: &mut Body) {
        let mut settled: Vec<(u64, i32)> = vec![(0, 0); body.vertices.len()];
        for t in &body.triangles {
            let corners = t.corners.map(|v| body.vertices[v as usize]);
            let area = orient(corners[0].at, corners[1].at, corners[2].at).unsigned_abs();
            if area == 0 {
                continue;
            }
            let Some(z) = self.of_triangle(corners) else { continue };
            for v in t.corners {
                let slot = &mut settled[v as usize];
                if area > slot.0 || (area == slot.0 && z < slot.1) {
                    *slot = (area, z);
                }
            }
        }
        for (vertex, (area, z)) in body.vertices.iter_mut().zip(settled) {
            if area > 0 {
                vertex.z = z;
            }
        }
    }
}

fn rise(corners: [Vertex; 3]) -> [i32; 2] {
    let z = corners.map(|v| v.z);
    [z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2])]
}

/// A triangle that needs a sloped plane.
struct Sloped {
    index: usize,
    exact: [DVec3; 3],
    normal: DVec3,
}

/// Gives every sloped triangle a plane: of the triangles from the largest to the smallest, one whose corners lie in a plane
/// already taken takes that.
fn share_planes(mut sloped: Vec<Sloped>, lattice: &Lattice, triangles: &mut [Triangle]) {
    sloped.sort_by(|a, b| {
        b.normal.length_squared().total_cmp(&a.normal.length_squared()).then(a.index.cmp(&b.index))
    });
    let tolerance = lattice.steps(COPLANAR);
    let mut taken: Vec<Taken> = Vec::new();
    let mut by_normal: BTreeMap<[i32; 3], Vec<u32>> = BTreeMap::new();
    let mut by_body: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for s in &sloped {
        let body = triangles[s.index].body;
        let unit = s.normal.normalize_or_zero() * s.normal.z.signum();
        let key = (unit * 64.0).round().as_ivec3().to_array();
        let fits = |&&plane: &&u32| taken[plane as usize].holds(&s.exact, tolerance);
        let own = by_body.get(&body).and_then(|planes| planes.iter().find(fits));
        let found = own.copied().or_else(|| {
            let near = (0..27).map(|i| [key[0] + i % 3 - 1, key[1] + i / 3 % 3 - 1, key[2] + i / 9 - 1]);
            near.filter_map(|key| by_normal.get(&key)).flatten().find(fits).copied()
        });
        let plane = found.or_else(|| {
            let along = [-s.normal.x / s.normal.z, -s.normal.y / s.normal.z];
            let middle = (s.exact[0] + s.exact[1] + s.exact[2]) / 3.0;
            let plane = Plane::sloped(along, middle.to_array())?;
            taken.push(Taken { plane, unit });
            by_normal.entry(key).or_default().push(taken.len() as u32 - 1);
            Some(taken.len() as u32 - 1)
        });
        match plane {
            Some(plane) => {
                triangles[s.index].lie = Lie::Flat(taken[plane as usize].plane);
                let own = by_body.entry(body).or_default();
                if !own.contains(&plane) {
                    own.push(plane);
                }
            }
            None => triangles[s.index].lie = Lie::Sheet,
        }
    }
}

/// A plane that a triangle has taken.
struct Taken {
    plane: Plane,
    unit: DVec3,
}

impl Taken {
    fn holds(&self, corners: &[DVec3; 3], tolerance: f64) -> bool {
        // Vertical distance times the cosine of the slope.
        let off = |p: &DVec3| (p.z - self.plane.height_f64(p.x, p.y)).abs() * self.unit.z.abs();
        corners.iter().all(|p| off(p) <= tolerance)
    }
}
