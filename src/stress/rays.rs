//! Rays that are hard on numbers. A ray depends on the seed, its family and its index alone.

use glam::DVec3;
use serde::Serialize;

use crate::format::records::CellRecord;
use crate::oracle::{Random, Truth};
use crate::scene::Scene;
use crate::trace::{Prisms, Ray};

/// What is hard about a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Family {
    /// Nothing: from anywhere, anywhere.
    Anywhere,
    /// It goes through the corner of a triangle.
    Vertices,
    /// It goes through a point of an edge, half of them through its middle.
    Edges,
    /// It runs along an edge: on its line, or up to a millimetre beside it.
    AlongEdges,
    /// It runs in the plane of a cell's side, floor or ceiling.
    Borders,
    /// It comes to a triangle at an angle of a ten millionth of a radian, or less.
    Grazing,
    /// Components of its direction are zeros, of both signs; its origin may have coordinates of a corner.
    Zeros,
    /// Its direction is as long as f64 can tell, or as short, down to the smallest number.
    Lengths,
    /// It starts on a face, an edge or a corner.
    Surfaces,
    /// It begins, or ends, at what it meets: there, or a number before or behind.
    Limits,
}

impl Family {
    /// All of them.
    pub const ALL: [Family; 10] = [
        Family::Anywhere,
        Family::Vertices,
        Family::Edges,
        Family::AlongEdges,
        Family::Borders,
        Family::Grazing,
        Family::Zeros,
        Family::Lengths,
        Family::Surfaces,
        Family::Limits,
    ];

    /// Whether its rays start in the air, or wherever chance has it: not at something of the scene.
    pub(super) const fn starts_anywhere(self) -> bool {
        matches!(self, Family::Anywhere | Family::Vertices | Family::Edges | Family::Lengths)
    }

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Family::Anywhere => "anywhere",
            Family::Vertices => "vertices",
            Family::Edges => "edges",
            Family::AlongEdges => "along-edges",
            Family::Borders => "borders",
            Family::Grazing => "grazing",
            Family::Zeros => "zeros",
            Family::Lengths => "lengths",
            Family::Surfaces => "surfaces",
            Family::Limits => "limits",
        }
    }
}

/// Makes rays for one scene.
pub(super) struct Source<'a> {
    scene: &'a Scene,
    truth: &'a Truth,
    /// Where rays start, unless they start at something.
    bounds: [[f64; 3]; 2],
    seed: u64,
}

impl<'a> Source<'a> {
    pub(super) fn new(
        scene: &'a Scene,
        truth: &'a Truth,
        inside: Option<[[f64; 3]; 2]>,
        seed: u64,
    ) -> Source<'a> {
        let bounds = inside.or(truth.bounds()).unwrap_or([[-1.0; 3], [1.0; 3]]);
        Source { scene, truth, bounds, seed }
    }

    /// Ray `index` of a family.
    pub(super) fn ray(&self, family: Family, index: u64) -> Ray {
        let mut random = Random::new(self.seed, family as u64, index);
        let random = &mut random;
        let start = self.start(random);
        let [a, b, c] = self.triangle(random);
        let to = |target: DVec3| ray(start, target - start);
        match family {
            Family::Anywhere => ray(start, DVec3::from(random.direction())),
            Family::Vertices => to(a),
            Family::Edges => {
                let share = if random.below(2) == 0 { 0.5 } else { random.unit() };
                to(a + (b - a) * share)
            }
            Family::AlongEdges => {
                let before = [0.0, 0.5, 1.0, 3.0][random.below(4)];
                let beside = match random.below(2) {
                    0 => DVec3::ZERO,
                    _ => DVec3::from(random.direction()) * 10f64.powf(random.between(-15.0, -3.0)),
                };
                ray(a - (b - a) * before + beside, b - a)
            }
            Family::Borders => self.along_border(random),
            Family::Grazing => {
                let point = on_face([a, b, c], random);
                let (Some(normal), Some(way)) =
                    ((b - a).cross(c - a).try_normalize(), (point - a).try_normalize())
                else {
                    return to(point);
                };
                let angle = 1e-7 * 10f64.powf(-8.0 * random.unit().powi(2));
                let turn = if random.below(2) == 0 { angle } else { -angle };
                let direction = way - normal * turn;
                let back = random.between(0.01, 1.0) * self.size();
                ray(point - direction * back, direction)
            }
            Family::Zeros => {
                let mut direction = random.direction();
                for _ in 0..1 + random.below(2) {
                    direction[random.below(3)] = if random.below(2) == 0 { 0.0 } else { -0.0 };
                }
                let mut start = start;
                for axis in 0..3 {
                    if random.below(3) == 0 {
                        start[axis] = a[axis];
                    }
                }
                ray(start, DVec3::from(direction))
            }
            Family::Lengths => {
                let power = match random.below(3) {
                    // To where squares are no numbers any more, and to where numbers end.
                    0 => random.between(-323.0, -290.0),
                    1 => random.between(290.0, 308.0),
                    _ => random.between(-200.0, 200.0),
                };
                ray(start, DVec3::from(random.direction()) * 10f64.powf(power))
            }
            Family::Surfaces => {
                let from = match random.below(3) {
                    0 => on_face([a, b, c], random),
                    1 => a + (b - a) * random.unit(),
                    _ => a,
                };
                let direction = match random.below(3) {
                    0 => DVec3::from(random.direction()),
                    1 => axis(random),
                    _ => self.triangle(random)[0] - from,
                };
                ray(from, direction)
            }
            Family::Limits => {
                let mut ray =
                    if random.below(2) == 0 { ray(start, DVec3::from(random.direction())) } else { to(a) };
                let Some(met) = self.truth.nearest(&ray) else { return ray };
                let near = [met.t, met.t.next_down(), met.t.next_up()][random.below(3)];
                match random.below(3) {
                    0 => ray.tmin = near,
                    1 => ray.tmax = near,
                    _ => (ray.tmin, ray.tmax) = (met.t, met.t),
                }
                ray
            }
        }
    }

    fn start(&self, random: &mut Random) -> DVec3 {
        let [lo, hi] = self.bounds;
        DVec3::from([0, 1, 2].map(|i| random.between(lo[i], hi[i])))
    }

    fn size(&self) -> f64 {
        let [lo, hi] = self.bounds.map(DVec3::from);
        (hi - lo).length()
    }

    fn triangle(&self, random: &mut Random) -> [DVec3; 3] {
        let count = self.scene.detail_triangle_count();
        let mut corners = match random.below(count as usize) {
            _ if count == 0 => [self.bounds[0]; 3],
            index => self.scene.triangle(index as u32),
        };
        corners.rotate_left(random.below(3));
        corners.map(DVec3::from)
    }

    /// A ray in the plane of a border of a cell, from within the cell or a little farther off.
    fn along_border(&self, random: &mut Random) -> Ray {
        let tables = &self.scene.tables;
        let cell = &tables.cells[random.below(tables.cells.len())];
        let (prisms, origin) = (Prisms::new(tables), DVec3::from(tables.scene[0].lattice_origin));
        let [lo, hi] = cell.bounds.map(DVec3::from);
        let middle = DVec3::from([0, 1, 2].map(|i| random.between(lo[i], hi[i])));
        if cell.kind == CellRecord::AROUND {
            return ray(middle, axis(random));
        }
        let (mut from, mut direction) = (middle, DVec3::from(random.direction()));
        let sides = prisms.sides_of(cell);
        if sides.is_empty() || random.below(2) == 0 {
            // Level ones in the plane of its floor or its ceiling, as boxes have it.
            from.z = [lo.z, hi.z][random.below(2)];
            direction.z = 0.0;
        } else {
            let place = random.below(sides.len());
            let [a, b] = [place, (place + 1) % sides.len()].map(|side| sides[side].start.map(f64::from));
            let share = random.between(-0.5, 1.5);
            (from.x, from.y) = (a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share);
            let turn = if random.below(2) == 0 { 1.0 } else { -1.0 };
            (direction.x, direction.y) = (turn * (b[0] - a[0]), turn * (b[1] - a[1]));
            if random.below(2) == 0 {
                direction.z = 0.0;
            }
        }
        ray(prisms.turned_back(from) + origin, prisms.turned_back(direction))
    }
}

/// A direction must not be zero.
fn ray(origin: DVec3, direction: DVec3) -> Ray {
    let direction = if direction == DVec3::ZERO { DVec3::Z } else { direction };
    Ray::new(origin.to_array(), direction.to_array())
}

fn on_face([a, b, c]: [DVec3; 3], random: &mut Random) -> DVec3 {
    let (mut u, mut v) = (random.unit(), random.unit());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    a + (b - a) * u + (c - a) * v
}

fn axis(random: &mut Random) -> DVec3 {
    let mut direction = DVec3::ZERO;
    direction[random.below(3)] = if random.below(2) == 0 { 1.0 } else { -1.0 };
    direction
}
