//! What a ray meets, without any rounding.
//!
//! Coordinates of f64 are rational numbers, and so is where a line pierces a triangle's plane, as a share of the ray's direction as
//! it was given. Here they are taken as that: what is met first, what else is met at the very place, and whether that is on
//! an edge or a corner is decided as it is. So the error of the other ways to answer is known, that of
//! [`Truth::nearest`] included, and a tie is known from an error. Slow: some microseconds a triangle.
//!
//! f64 only leaves out triangles that are surely missed: those that the grid says stay clear of the line, and those of which it passes edges on
//! both sides by more than four times what rounding is bounded by. The direction was made unit there, which moves a side by less than that bound.

mod beside;

use std::cmp::Ordering;

use dashu_ratio::Relaxed;

use super::Truth;
use super::soup::{Nearest, first_t};
use super::triangle::{Corners, Line, Size, sides};
use super::vector::max_abs;
use crate::trace::Ray;

/// A vector of rational numbers.
type Vector = [Relaxed; 3];

/// Where on a triangle it is met.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum On {
    /// Within.
    Face,
    /// On an edge of it, between two corners.
    Edge,
    /// On a corner.
    Corner,
}

/// What a ray meets first, exactly.
#[derive(Clone, Debug)]
pub struct First {
    /// All triangles that it meets there, in the order of the model; each has the same `t`, that of [`First::t`].
    pub met: Vec<(Nearest, On)>,
    /// Where, metres along it: the nearest f64 or the one beside that.
    pub t: f64,
    /// Whether it runs in the plane of a triangle, and touches that before or there.
    pub grazes: bool,
    /// Where, in lengths of the direction as it was given.
    share: Relaxed,
    /// The squared length of the direction.
    square: Relaxed,
}

impl First {
    /// Whether there is another answer as right: it meets several triangles there, or one on its border, or runs along one.
    pub fn is_tie(&self) -> bool {
        self.grazes || self.met.len() > 1 || self.met.iter().any(|(_, on)| *on != On::Face)
    }

    /// How far, metres, `t` is behind the exact one; `t` is finite and not negative.
    pub fn off(&self, t: f64) -> f64 {
        off(t, self.t, &self.share, &self.square)
    }
}

/// How far `t` is behind a share of a direction of this squared length, `about` there.
fn off(t: f64, about: f64, share: &Relaxed, square: &Relaxed) -> f64 {
    let told = rational(t);
    let sum = &told + rational(about);
    if sum == Relaxed::ZERO {
        return 0.0;
    }
    // The difference of the squares is exact.
    ((&told * &told - share * share * square) / sum).to_f64().value()
}

/// The length of a share of a direction, to an ulp.
fn length(share: &Relaxed, direction: [f64; 3], square: &Relaxed) -> f64 {
    // By the largest component first, so that the root is of what f64 can hold.
    let largest = rational(max_abs(direction));
    let size = (square / (&largest * &largest)).to_f64().value().sqrt();
    let about = (share * largest).to_f64().value() * size;
    if about.is_finite() { (about - off(about, about, share, square)).max(0.0) } else { about }
}

/// A finite number; else 0.
fn rational(number: f64) -> Relaxed {
    Relaxed::try_from(number).unwrap_or(Relaxed::ZERO)
}

fn vector(v: [f64; 3]) -> Vector {
    v.map(rational)
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn times(a: &Vector, b: &Vector) -> Vector {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn along(a: &Vector, b: &Vector) -> Relaxed {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn sign(number: &Relaxed) -> Ordering {
    number.cmp(&Relaxed::ZERO)
}

/// A ray in rational numbers.
struct Exactly {
    origin: Vector,
    direction: Vector,
    square: Relaxed,
}

/// What a line and a triangle have in common.
enum Common {
    Nothing,
    /// A point: its place along the line, and on the triangle.
    Point(Relaxed, On),
    /// The line is in the triangle's plane, or the triangle in a line: perhaps more, perhaps nothing.
    Plane,
}

impl Exactly {
    fn new(ray: &Ray) -> Exactly {
        let direction = vector(ray.direction);
        let square = along(&direction, &direction);
        Exactly { origin: vector(ray.origin), direction, square }
    }

    fn common(&self, corners: &Corners) -> Common {
        let [a, b, c] = corners.map(|corner| minus(&vector(corner), &self.origin));
        let across = times(&b, &c);
        // The sides of the edges that the line passes on.
        let sides = [
            along(&self.direction, &across),
            along(&self.direction, &times(&c, &a)),
            along(&self.direction, &times(&a, &b)),
        ];
        let count = |which: Ordering| sides.iter().filter(|side| sign(side) == which).count();
        let (left, right, on) = (count(Ordering::Greater), count(Ordering::Less), count(Ordering::Equal));
        if left > 0 && right > 0 {
            return Common::Nothing;
        }
        let on = match on {
            0 => On::Face,
            1 => On::Edge,
            2 => On::Corner,
            _ => return Common::Plane,
        };
        let [u, v, w] = sides;
        Common::Point(along(&a, &across) / (u + v + w), on)
    }

    /// Between which places along the line it is in a triangle in whose plane it lies, if it comes to that.
    fn along_plane(&self, corners: &Corners) -> Option<[Relaxed; 2]> {
        let from = corners.map(|corner| minus(&vector(corner), &self.origin));
        let normal = times(&minus(&from[1], &from[0]), &minus(&from[2], &from[0]));
        let across = times(&normal, &self.direction);
        let sides = [0, 1, 2].map(|i| along(&across, &from[i]));
        let places = [0, 1, 2].map(|i| along(&self.direction, &from[i]) / &self.square);
        let crossed = [(0, 1), (1, 2), (2, 0)].into_iter().filter_map(|(i, j)| {
            match (sign(&sides[i]), sign(&sides[j])) {
                (Ordering::Equal, _) => Some(places[i].clone()),
                // As the start of the next edge.
                (_, Ordering::Equal) => None,
                (a, b) if a == b => None,
                _ => {
                    let share = &sides[i] / (&sides[i] - &sides[j]);
                    Some(&places[i] + share * (&places[j] - &places[i]))
                }
            }
        });
        let crossed: Vec<Relaxed> = crossed.collect();
        Some([crossed.iter().min()?.clone(), crossed.iter().max()?.clone()])
    }

    /// Whether a place along the line is within the ray's segment.
    fn is_within(&self, share: &Relaxed, tmin: f64, tmax: f64) -> bool {
        if sign(share) == Ordering::Less {
            return false;
        }
        let square = share * share * &self.square;
        let least = rational(tmin);
        square >= &least * &least
            && (tmax == f64::INFINITY || {
                let most = rational(tmax);
                tmax >= 0.0 && square <= &most * &most
            })
    }
}

/// Whether f64 is sure that a line misses a triangle.
fn is_missed(line: &Line, corners: &Corners, size: Size) -> bool {
    let sides = sides(line, corners);
    // What vanishes in f64 as well.
    let error = 4.0 * size.side_error(line.reach) + f64::MIN_POSITIVE;
    sides.iter().all(|side| side.is_finite())
        && sides.iter().any(|side| *side > error)
        && sides.iter().any(|side| *side < -error)
}

impl Truth {
    /// What the ray meets first, exactly; `None` for nothing, or for what is no ray. What it starts inside of does not count, as for
    /// [`Truth::nearest`].
    pub fn first(&self, ray: &Ray) -> Option<First> {
        let line = Line::new(ray)?;
        let exactly = Exactly::new(ray);
        // What f64 takes for the nearest tells how far to look; if there is nothing that far, as far as the ray goes.
        let near = self.nearest(ray).map(|nearest| nearest.t + 2.0 * self.tolerance.max(1e-3));
        let near =
            near.and_then(|to| self.first_until(&exactly, &line, ray, to).filter(|first| first.t <= to));
        near.or_else(|| self.first_until(&exactly, &line, ray, ray.tmax))
    }

    fn first_until(&self, exactly: &Exactly, line: &Line, ray: &Ray, to: f64) -> Option<First> {
        let tmin = first_t(ray);
        let mut met: Vec<(u32, On)> = Vec::new();
        let mut best: Option<Relaxed> = None;
        let mut beside = Vec::new();
        for index in self.near_line(line, tmin, to) {
            let corners = &self.soup.corners[index as usize];
            if is_missed(line, corners, self.soup.sizes[index as usize]) {
                continue;
            }
            match exactly.common(corners) {
                Common::Nothing => {}
                Common::Plane => beside.extend(exactly.along_plane(corners)),
                Common::Point(share, on) => {
                    if !exactly.is_within(&share, tmin, ray.tmax) {
                        continue;
                    }
                    let order = best.as_ref().map_or(Ordering::Less, |best| share.cmp(best));
                    match order {
                        Ordering::Less => {
                            best = Some(share);
                            met = vec![(index, on)];
                        }
                        Ordering::Equal => met.push((index, on)),
                        Ordering::Greater => {}
                    }
                }
            }
        }
        let share = best?;
        let t = length(&share, ray.direction, &exactly.square);
        let grazes = beside
            .iter()
            .any(|[least, most]| *least <= share && (exactly.is_within(most, tmin, f64::INFINITY)));
        let met = met.into_iter().map(|(index, on)| (self.soup.at(index, t), on)).collect();
        Some(First { met, t, grazes, share, square: exactly.square.clone() })
    }
}

#[cfg(test)]
mod tests {
    use enfilade_importers::{Model, Role, Semantic};
    use proptest::prelude::*;

    use super::super::fixtures::{Shape, model};
    use super::super::vector::cross;
    use super::super::{RayKind, RaySource, TruthOptions};
    use super::*;
    use crate::splitmix::SplitMix64;

    fn truth_of(model: &Model) -> Truth {
        Truth::new(model, |_| Role::Detail, &TruthOptions::default())
    }

    fn truth(triangles: &[Corners]) -> Truth {
        truth_of(&model(&[(Semantic::Furniture, Shape(triangles.to_vec()))]))
    }

    const FLOOR: [Corners; 2] = [
        [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]],
        [[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]],
    ];

    fn met(truth: &Truth, ray: Ray) -> Option<Vec<(u32, On)>> {
        Some(truth.first(&ray)?.met.iter().map(|(nearest, on)| (nearest.triangle, *on)).collect())
    }

    #[test]
    fn ties_are_told() {
        let truth = truth(&FLOOR);
        let down = |x: f64, y: f64| Ray::new([x, y, 3.0], [0.0, 0.0, -7.0]);
        assert_eq!(met(&truth, down(1.0, 1.0)), Some(vec![(0, On::Face)]));
        assert!(!truth.first(&down(1.0, 1.0)).unwrap().is_tie());
        assert_eq!(met(&truth, down(2.0, 2.0)), Some(vec![(0, On::Edge), (1, On::Edge)]));
        assert_eq!(met(&truth, down(2.0, 2.0f64.next_up())), Some(vec![(1, On::Face)]));
        assert_eq!(met(&truth, down(4.0, 0.0)), Some(vec![(0, On::Corner), (1, On::Corner)]));
        assert!(truth.first(&down(4.0, 0.0)).unwrap().is_tie());
        assert_eq!(met(&truth, down(-1e-300, 1.0)), None);
        assert_eq!(met(&truth, Ray::new([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0])), None, "in its plane");
    }

    #[test]
    fn what_it_runs_in_is_told() {
        let wall = [[3.0, -9.0, -9.0], [3.0, 9.0, -9.0], [3.0, 0.0, 9.0]];
        let ray = |x: f64, y: f64, way: f64| Ray::new([x, y, 0.0], [way, 0.0, 0.0]);
        let behind = wall.map(|[_, y, z]| [-2.0, y, z]);
        let truth = truth(&[FLOOR[0], FLOOR[1], wall, behind]);
        let first = truth.first(&ray(-1.0, 1.0, 1.0)).unwrap();
        assert!(first.grazes && first.is_tie() && first.t == 4.0);
        // At its corner, and past it; the floor behind where it starts, and behind what it meets.
        assert!(truth.first(&ray(-1.0, 4.0, 1.0)).unwrap().grazes);
        assert!(!truth.first(&ray(-1.0, 4.0f64.next_up(), 1.0)).unwrap().is_tie());
        assert!(!truth.first(&ray(-1.0, 1.0, -1.0)).unwrap().is_tie());
        assert!(!truth.first(&ray(-3.0, 1.0, 1.0)).unwrap().is_tie());
        // Two on each other.
        assert!(
            self::truth(&[FLOOR[0], FLOOR[0]])
                .first(&Ray::new([1.0, 1.0, 3.0], [0.0, 0.0, -1.0]))
                .unwrap()
                .is_tie()
        );
    }

    #[test]
    fn lengths_of_any_size() {
        let truth = truth(&FLOOR);
        for height in [1e-320, 1e-170, 1e-3, 1e160, 1e300] {
            for size in [1e-310, 1e-200, 1.0, 1e200, 1e308] {
                let first = truth.first(&Ray::new([1.0, 1.0, height], [0.0, 0.0, -size])).unwrap();
                assert_eq!((first.t, first.off(height)), (height, 0.0));
                assert_eq!(first.off(2.0 * height), height);
            }
        }
        // Sides beyond all measure.
        let far = Ray::new([-1.7e308, 0.0, 0.0], [1.0, 1e-309, 1e-309]);
        let wall = [[0.0, -1.0, -1.0], [0.0, 3.0, -1.0], [0.0, -1.0, 3.0]];
        assert!(self::truth(&[wall]).first(&far).is_some());
    }

    #[test]
    fn segments_end_exactly() {
        let truth = truth(&FLOOR);
        // Its direction is not unit: 5 long.
        let ray = |tmin: f64, tmax: f64| Ray { tmin, tmax, ..Ray::new([1.0, 4.0, 4.0], [0.0, -3.0, -4.0]) };
        let is_met = |tmin, tmax| truth.first(&ray(tmin, tmax)).is_some();
        assert!(is_met(0.0, 5.0) && is_met(5.0, 5.0) && is_met(5.0, f64::INFINITY) && is_met(-1.0, 9.0));
        assert!(!is_met(0.0, 5.0f64.next_down()) && !is_met(5.0f64.next_up(), 9.0) && !is_met(0.0, -1.0));
    }

    #[test]
    fn errors_are_told_to_the_last_digit() {
        let first = truth(&FLOOR).first(&Ray::new([1.0, 4.0, 4.0], [0.0, -3.0, -4.0])).unwrap();
        assert_eq!((first.t, first.off(5.0)), (5.0, 0.0));
        assert_eq!(first.off(5.0f64.next_up()), 5.0f64.next_up() - 5.0);
        // The length of this one is no rational number.
        let first = truth(&FLOOR).first(&Ray::new([1.0, 1.0, 3.0], [0.0, 1.0, -3.0])).unwrap();
        let exact = 10.0f64.sqrt();
        // What f64 leaves off the root of 10, by its square.
        let left = -exact.mul_add(exact, -10.0) / (2.0 * exact);
        assert!((first.off(exact) + left).abs() < 1e-30, "{} {left}", first.off(exact));
        assert!((first.off(exact + 0.5) - 0.5).abs() < 1e-12);
    }

    /// A share in whole numbers, numerator and denominator, and what is met there.
    type Whole = ([i128; 2], Vec<(u32, On)>);

    /// In whole numbers: (sides, numerator and denominator of the share).
    fn whole(ray: &[[i128; 3]; 2], corners: &[[i128; 3]; 3]) -> ([i128; 3], [i128; 2]) {
        let [o, d] = ray;
        let minus = |a: &[i128; 3]| [0, 1, 2].map(|i| a[i] - o[i]);
        let cross = |a: [i128; 3], b: [i128; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot = |a: [i128; 3], b: [i128; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [a, b, c] = [0, 1, 2].map(|i| minus(&corners[i]));
        let sides = [dot(*d, cross(b, c)), dot(*d, cross(c, a)), dot(*d, cross(a, b))];
        let (mut over, mut under) = (dot(a, cross(b, c)), sides.iter().sum::<i128>());
        if under < 0 {
            (over, under) = (-over, -under);
        }
        (sides, [over, under])
    }

    fn small() -> impl Strategy<Value = [i8; 3]> {
        proptest::array::uniform3(-4i8..5)
    }

    proptest! {
        /// Where coordinates are small whole numbers, whole numbers know the answer; ties are frequent there.
        #[test]
        fn it_agrees_with_whole_numbers(
            triangles in proptest::collection::vec(proptest::array::uniform3(small()), 1..30),
            origin in small(),
            direction in small(),
        ) {
            let float = |p: &[i8; 3]| p.map(f64::from);
            // What has no area no model has.
            let is_flat = |t: &[[i8; 3]; 3]| {
                let [e, f] = [1, 2].map(|k| [0, 1, 2].map(|i| f64::from(t[k][i]) - f64::from(t[0][i])));
                cross(e, f) == [0.0; 3]
            };
            let triangles: Vec<_> = triangles.into_iter().filter(|t| !is_flat(t)).collect();
            prop_assume!(!triangles.is_empty());
            let truth = truth(&triangles.iter().map(|t| [0, 1, 2].map(|i| float(&t[i]))).collect::<Vec<_>>());
            let ray = [origin, direction].map(|p| p.map(i128::from));
            let mut best: Option<Whole> = None;
            for (index, corners) in triangles.iter().zip(0u32..).map(|(t, i)| (i, [0, 1, 2].map(|k| t[k].map(i128::from)))) {
                let (sides, share) = whole(&ray, &corners);
                let zeros = sides.iter().filter(|side| **side == 0).count();
                let is_between = sides.iter().any(|side| *side > 0) && sides.iter().any(|side| *side < 0);
                if is_between || zeros == 3 || share[0] < 0 {
                    continue;
                }
                let on = [On::Face, On::Edge, On::Corner][zeros];
                match &mut best {
                    Some((least, met)) if share[0] * least[1] == least[0] * share[1] => met.push((index, on)),
                    Some((least, _)) if share[0] * least[1] > least[0] * share[1] => {}
                    _ => best = Some((share, vec![(index, on)])),
                }
            }
            let ray = Ray::new(float(&origin), float(&direction));
            if direction == [0; 3] {
                prop_assert!(truth.first(&ray).is_none());
                return Ok(());
            }
            prop_assert_eq!(met(&truth, ray), best.as_ref().map(|best| best.1.clone()));
            if let Some(([over, under], _)) = best {
                let length = direction.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
                let t = truth.first(&ray).unwrap().t;
                prop_assert!((t - over as f64 / under as f64 * length).abs() <= 1e-15 * (1.0 + t));
            }
        }
    }

    /// What the truth in f64 says is as far away as this says, to its own bound; where it is not, there is a tie, or a ray beside this one by some
    /// roundings meets something there.
    #[test]
    fn the_truth_in_f64_is_within_its_bound() {
        let shapes: Vec<_> = (0..12)
            .map(|i| {
                let lo = [f64::from(i % 4) * 2.1, f64::from(i / 4) * 3.3, 0.1 * f64::from(i)];
                let prism = Shape::prism(3 + i as usize, 0.7, lo[2], lo[2] + 2.0);
                (Semantic::Wall, prism.and(Shape::cuboid(lo, lo.map(|c| c + 1.3))))
            })
            .collect();
        let truth = truth_of(&model(&shapes));
        let source = RaySource::new(&truth, 3);
        let agrees = |near: &Option<Nearest>, first: &Option<First>| match (near, first) {
            (Some(near), Some(first)) => first.off(near.t).abs() <= 1e-10 * (1.0 + near.t),
            (None, None) => true,
            _ => false,
        };
        let (mut hits, mut ties, mut beside) = (0, 0, 0);
        for kind in [RayKind::Box, RayKind::Outside, RayKind::Hard] {
            for index in 0..2000 {
                let ray = source.ray(kind, index);
                let (near, first) = (truth.nearest(&ray), truth.first(&ray));
                hits += u32::from(near.is_some());
                if agrees(&near, &first) {
                    // Of what it meets in one place, to that bound, as at corners, either may be named.
                    let is_met = near.zip(first.as_ref()).is_none_or(|(near, first)| {
                        first
                            .met
                            .iter()
                            .any(|(met, _)| (met.element, met.triangle) == (near.element, near.triangle))
                    });
                    assert!(is_met || kind == RayKind::Hard, "{index} {ray:?} {near:?} {first:?}");
                    continue;
                }
                assert_eq!(kind, RayKind::Hard, "{index} {ray:?} {near:?} {first:?}");
                if first.as_ref().is_some_and(First::is_tie) {
                    ties += 1;
                    continue;
                }
                beside += 1;
                let mut random = SplitMix64::new(index);
                let mut rays = (0..400).map(|i| {
                    let by = [1e-14, 1e-13, 1e-12][i % 3];
                    Ray { origin: ray.origin.map(|c| c + by * random.between(-1.0, 1.0)), ..ray }
                });
                assert!(
                    rays.any(|ray| agrees(&near, &truth.first(&ray))),
                    "{index} {ray:?} {near:?} {first:?}"
                );
            }
        }
        assert!(hits > 2000 && (ties + beside) * 10 < hits, "{ties} ties and {beside} others of {hits}");
    }
}
