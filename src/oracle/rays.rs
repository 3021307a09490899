//! Random rays to verify with. A ray depends on the seed, its kind and its index alone.

use enfilade_importers::{Model, Semantic};

use super::random::Random;
use super::shell::Body;
use super::triangle::Corners;
use super::vector::{Bounds, add, length, scale, sub};
use super::{Truth, parallel};
use crate::trace::Ray;

/// Where rays start and what they aim at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RayKind {
    /// From inside a room, every closed room alike and evenly within it, but not from inside a carving solid; in all
    /// directions alike. Without rooms: as [`RayKind::Box`], but not from inside a carving solid.
    Room,
    /// From a sphere around the model, half at points of the model's box and a little around it, half at points of a
    /// triangle's box.
    Outside,
    /// From anywhere in the model's box, in all directions alike.
    Box,
    /// From anywhere in a carving solid's box, in all directions alike. Without solids: as [`RayKind::Box`].
    Solid,
    /// Hard cases, in equal parts: along an axis; at a vertex; at the middle of an edge; from a point on a surface,
    /// in any direction and along an axis; from one vertex at another; along an edge, a nanometre to a millimetre
    /// beside it. (A ray on the very line of an edge touches one corner after the other, and rounding decides about
    /// each of them by itself: no single ray need have such an answer.)
    Hard,
}

/// Points to try in one room before another one is tried.
const TRIES: usize = 64;

/// Rooms to try.
const ROOMS: usize = 8;

/// Makes rays.
#[derive(Debug)]
pub struct RaySource<'a> {
    truth: &'a Truth,
    rooms: Vec<Body>,
    seed: u64,
    bounds: Bounds,
}

impl<'a> RaySource<'a> {
    /// Rays around the triangles of `truth`; it knows no rooms yet.
    pub fn new(truth: &'a Truth, seed: u64) -> RaySource<'a> {
        RaySource { truth, rooms: Vec::new(), seed, bounds: truth.model_bounds() }
    }

    /// The same with the closed components of `model`'s ROOM elements as rooms. What is no closed mesh is no room.
    pub fn with_rooms(mut self, model: &Model) -> RaySource<'a> {
        let rooms: Vec<_> = model.elements.iter().filter(|e| e.semantic == Semantic::Room).collect();
        self.rooms = parallel::map(rooms.len(), |i| Body::of(&rooms[i].mesh)).into_iter().flatten().collect();
        self
    }

    /// How many rooms it knows.
    pub fn room_count(&self) -> usize {
        self.rooms.len()
    }

    /// Ray `index` of its kind.
    pub fn ray(&self, kind: RayKind, index: u64) -> Ray {
        let mut random = Random::new(self.seed, kind as u64, index);
        match kind {
            RayKind::Room => Ray::new(self.point_in_a_room(&mut random), random.direction()),
            RayKind::Outside => self.outside(&mut random),
            RayKind::Box => Ray::new(random.point(&self.bounds), random.direction()),
            RayKind::Solid => {
                let solids = &self.truth.solids;
                let bounds = solids.get(random.below(solids.len())).map_or(self.bounds, |s| s.1.bounds);
                Ray::new(random.point(&bounds), random.direction())
            }
            RayKind::Hard => self.hard(&mut random),
        }
    }

    fn point_in_a_room(&self, random: &mut Random) -> [f64; 3] {
        let is_air = |p| self.truth.solids_at(p).is_empty();
        for _ in 0..ROOMS {
            let room = self.rooms.get(random.below(self.rooms.len()));
            let bounds = room.map_or(self.bounds, |room| room.bounds);
            for _ in 0..TRIES {
                let p = random.point(&bounds);
                if room.is_none_or(|room| room.contains(p)) && is_air(p) {
                    return p;
                }
            }
        }
        random.point(&self.bounds)
    }

    fn outside(&self, random: &mut Random) -> Ray {
        let radius = 0.75 * length(self.bounds.size()) + 1.0;
        let origin = add(self.bounds.center(), scale(random.direction(), radius));
        let around = match self.triangle(random) {
            Some(corners) if random.below(2) == 0 => Bounds::of(&corners),
            _ => self.bounds.grown(0.05 * length(self.bounds.size())),
        };
        Ray::new(origin, or_up(sub(random.point(&around), origin)))
    }

    fn hard(&self, random: &mut Random) -> Ray {
        let start = random.point(&self.bounds);
        let Some(corners) = self.triangle(random) else { return Ray::new(start, random.direction()) };
        let [a, b, c] = corners;
        let on_surface = |random: &mut Random| {
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            add(a, add(scale(sub(b, a), u), scale(sub(c, a), v)))
        };
        match random.below(7) {
            0 => Ray::new(start, axis(random)),
            1 => Ray::new(start, or_up(sub(a, start))),
            2 => Ray::new(start, or_up(sub(scale(add(a, b), 0.5), start))),
            3 => Ray::new(on_surface(random), random.direction()),
            4 => Ray::new(on_surface(random), axis(random)),
            5 => {
                let other = self.triangle(random).unwrap_or(corners)[random.below(3)];
                Ray::new(a, or_up(sub(other, a)))
            }
            _ => {
                let beside = scale(random.direction(), 10f64.powf(random.between(-9.0, -3.0)));
                Ray::new(add(sub(a, sub(b, a)), beside), or_up(sub(b, a)))
            }
        }
    }

    fn triangle(&self, random: &mut Random) -> Option<Corners> {
        let corners = &self.truth.soup.corners;
        corners.get(random.below(corners.len())).copied()
    }
}

fn axis(random: &mut Random) -> [f64; 3] {
    let mut direction = [0.0; 3];
    direction[random.below(3)] = if random.below(2) == 0 { 1.0 } else { -1.0 };
    direction
}

/// A direction must not be zero.
fn or_up(direction: [f64; 3]) -> [f64; 3] {
    if direction == [0.0; 3] { [0.0, 0.0, 1.0] } else { direction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::TruthOptions;
    use crate::oracle::fixtures::{house, role_of};

    #[test]
    fn rays_start_where_they_should() {
        let model = house();
        let truth = Truth::new(&model, role_of(&model), &TruthOptions::default());
        let source = RaySource::new(&truth, 7).with_rooms(&model);
        assert_eq!(source.room_count(), 2);
        let mut left = 0;
        for index in 0..2000 {
            let p = source.ray(RayKind::Room, index).origin;
            let x_ok = (0.0..=4.0).contains(&p[0]) || (4.2..=8.2).contains(&p[0]);
            assert!(x_ok && (0.0..=3.0).contains(&p[1]) && (0.0..=2.5).contains(&p[2]), "{p:?}");
            assert!(truth.solids_at(p).is_empty());
            left += usize::from(p[0] < 4.1);
            let out = source.ray(RayKind::Outside, index);
            assert!(!truth.model_bounds().contains(out.origin));
            assert_eq!(out, RaySource::new(&truth, 7).ray(RayKind::Outside, index));
            for kind in [RayKind::Box, RayKind::Solid, RayKind::Hard] {
                assert!(source.ray(kind, index).is_valid());
            }
        }
        assert!((800..1200).contains(&left));
        let solid = (0..2000).filter(|&i| !truth.solids_at(source.ray(RayKind::Solid, i).origin).is_empty());
        assert_eq!(solid.count(), 2000, "boxes fill their boxes");
    }

    #[test]
    fn nothing_to_aim_at() {
        let model = house();
        let truth = Truth::new(&model, |_| enfilade_importers::Role::Ignore, &TruthOptions::default());
        let source = RaySource::new(&truth, 7);
        for kind in [RayKind::Room, RayKind::Outside, RayKind::Box, RayKind::Solid, RayKind::Hard] {
            assert!(source.ray(kind, 3).is_valid());
        }
    }
}
