//! Moving points by a unit or two so that air is convex where it was meant to be straight.
//!
//! Where a wall at an angle meets another, the point where they meet is rounded to one side of the other's line: seen
//! from one of its sides the line then has a reflex corner of a unit's depth, and a room would be cut there. No lattice
//! point may lie on the line, but one on the side of the matter is as good, and there the air is convex. Points are moved
//! only as far as all triangles around them keep their orientation, so that nothing ever crosses.

use std::collections::HashMap;

use super::moved::Moved;
use super::plan::{NONE, Plan};
use super::regions::Simple;
use super::stacks::Item;
use crate::lattice::{Point, orient};

/// A corner no deeper than this counts as a kink in a straight line, lattice units.
const KINK: f64 = 3.5;
/// Points are moved no farther than this along each axis.
const FARTHEST: i32 = 3;
/// Times that all points are looked at.
const PASSES: usize = 4;

/// Moves points; returns which.
pub(super) fn unkink(simple: &mut Simple) -> Moved {
    let stars = Stars::of(&simple.plan);
    let original = simple.plan.points.clone();
    let air = air(simple);
    let places = places();
    // Points near which something was moved since they were looked at.
    let mut is_stale = vec![true; stars.count() as usize];
    for _ in 0..PASSES {
        let mut moved = false;
        for v in 0..stars.count() {
            let Some(star) = stars.of_vertex(v) else { continue };
            if !std::mem::take(&mut is_stale[v as usize]) {
                continue;
            }
            let mut mover = Mover { simple, stars: &stars, air: &air, places: &places };
            if mover.kinks(v) > 0
                && let Some(to) = mover.best(v, star, original[v as usize])
            {
                simple.plan.points[v as usize] = to;
                moved = true;
                // What is best for a point follows from the kinks around it, and those from the points around them.
                for near in stars.around(&simple.plan, v) {
                    is_stale[near as usize] = true;
                    stars.around(&simple.plan, near).for_each(|far| is_stale[far as usize] = true);
                }
            }
        }
        if !moved {
            break;
        }
    }
    let mut all = Moved::default();
    for (from, to) in original.iter().zip(&simple.plan.points).filter(|(from, to)| from != to) {
        all.add(f64::from(to.x - from.x).hypot(f64::from(to.y - from.y)));
    }
    all
}

/// By kind of stack: numbers of the items that light passes; the same items have the same number.
fn air(simple: &Simple) -> Vec<Vec<u32>> {
    let mut numbers: HashMap<Item, u32> = HashMap::new();
    let mut air = Vec::with_capacity(simple.kinds.len());
    for stack in &simple.kinds {
        let passed = stack.iter().filter(|item| item.fill.is_none_or(|label| label.is_air()));
        let own: Vec<u32> = passed
            .map(|item| {
                let next = numbers.len() as u32;
                *numbers.entry(*item).or_insert(next)
            })
            .collect();
        air.push(own);
    }
    air
}

/// Where points may be moved to, the nearest first.
fn places() -> Vec<[i32; 2]> {
    let steps = -FARTHEST..=FARTHEST;
    let mut places: Vec<[i32; 2]> = steps.clone().flat_map(|x| steps.clone().map(move |y| [x, y])).collect();
    places.sort_unstable_by_key(|&[x, y]| (x * x + y * y, x, y));
    places
}

/// The triangles around each point, counter-clockwise, as (triangle, which corner the point is).
struct Stars {
    starts: Vec<u32>,
    corners: Vec<(u32, u32)>,
    /// Points at the hull's sides have no whole star.
    whole: Vec<bool>,
}

impl Stars {
    fn of(plan: &Plan) -> Stars {
        let count = plan.points.len();
        let mut first: Vec<(u32, u32)> = vec![(NONE, 0); count];
        let mut at_side = vec![false; count];
        for (t, corners) in plan.triangles.iter().enumerate() {
            for (i, &v) in corners.iter().enumerate() {
                first[v as usize] = (t as u32, i as u32);
                if plan.across[t][i] == NONE {
                    at_side[v as usize] = true;
                    at_side[corners[(i + 1) % 3] as usize] = true;
                }
            }
        }
        let mut stars = Stars {
            starts: vec![0],
            corners: Vec::with_capacity(plan.triangles.len() * 3),
            whole: Vec::new(),
        };
        for v in 0..count {
            let whole = !at_side[v] && first[v].0 != NONE;
            if whole {
                let (mut t, mut i) = first[v];
                loop {
                    stars.corners.push((t, i));
                    // Over the edge that ends in the point.
                    let next = plan.across[t as usize][(i as usize + 2) % 3];
                    let Some(j) = plan.triangles[next as usize].iter().position(|&w| w as usize == v) else {
                        break;
                    };
                    (t, i) = (next, j as u32);
                    if t == first[v].0 {
                        break;
                    }
                }
            }
            stars.whole.push(whole);
            stars.starts.push(stars.corners.len() as u32);
        }
        stars
    }

    fn count(&self) -> u32 {
        self.whole.len() as u32
    }

    /// The points that triangles join a point to; none of one at the hull's sides.
    fn around<'a>(&'a self, plan: &'a Plan, v: u32) -> impl Iterator<Item = u32> + 'a {
        let star = self.of_vertex(v).unwrap_or(&[]);
        star.iter().map(|&(t, i)| plan.triangles[t as usize][(i as usize + 1) % 3])
    }

    fn of_vertex(&self, v: u32) -> Option<&[(u32, u32)]> {
        let range = self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize;
        self.whole[v as usize].then(|| &self.corners[range])
    }
}

struct Mover<'a> {
    simple: &'a mut Simple,
    stars: &'a Stars,
    air: &'a [Vec<u32>],
    places: &'a [[i32; 2]],
}

impl Mover<'_> {
    /// How many kinks air has at a point.
    fn kinks(&self, v: u32) -> u32 {
        let Some(star) = self.stars.of_vertex(v) else { return 0 };
        let plan = &self.simple.plan;
        let n = star.len();
        let has = |k: usize, item: u32| {
            let kind = self.simple.kind[star[if k < n { k } else { k - n }].0 as usize];
            self.air[kind as usize].contains(&item)
        };
        let mut kinks = 0;
        for k in 0..n {
            let (t, i) = star[k];
            let kind = self.simple.kind[t as usize];
            if kind == self.simple.kind[star[(k + n - 1) % n].0 as usize] {
                continue;
            }
            for &item in &self.air[kind as usize] {
                // The sector of the item that starts with this triangle.
                if has(k + n - 1, item) {
                    continue;
                }
                let length = (1..n).take_while(|&step| has(k + step, item)).count();
                let (last, j) = star[(k + length) % n];
                let a = plan.points[plan.triangles[t as usize][(i as usize + 1) % 3] as usize];
                let b = plan.points[plan.triangles[last as usize][(j as usize + 2) % 3] as usize];
                kinks += u32::from(is_kink(b, plan.points[v as usize], a));
            }
        }
        kinks
    }

    /// Kinks at a point and at those that triangles join it to, if they are fewer than `most`.
    fn around(&self, v: u32, most: u32) -> Option<u32> {
        let mut kinks = 0;
        for near in std::iter::once(v).chain(self.stars.around(&self.simple.plan, v)) {
            kinks += self.kinks(near);
            if kinks >= most {
                return None;
            }
        }
        Some(kinks)
    }

    /// The place near its original one where there are fewest kinks, if fewer than now.
    fn best(&mut self, v: u32, star: &[(u32, u32)], original: Point) -> Option<Point> {
        let now = self.simple.plan.points[v as usize];
        let mut best = (self.around(v, u32::MAX)?, now);
        for &[x, y] in self.places {
            let place = Point::new(original.x + x, original.y + y);
            if place == now || !self.fits(star, place) {
                continue;
            }
            self.simple.plan.points[v as usize] = place;
            if let Some(kinks) = self.around(v, best.0) {
                best = (kinks, place);
                if kinks == 0 {
                    break;
                }
            }
        }
        self.simple.plan.points[v as usize] = now;
        (best.1 != now).then_some(best.1)
    }

    /// Whether all triangles of a star keep their orientation with their common point there.
    fn fits(&self, star: &[(u32, u32)], place: Point) -> bool {
        let plan = &self.simple.plan;
        star.iter().all(|&(t, i)| {
            let corners = plan.triangles[t as usize];
            let [a, b] = [1, 2].map(|k| plan.points[corners[(i as usize + k) % 3] as usize]);
            orient(place, a, b) > 0
        })
    }
}

/// Whether the corner from `from` over `at` to `to`, the inside on the left, is reflex, but nearly straight.
fn is_kink(from: Point, at: Point, to: Point) -> bool {
    let double = orient(from, at, to);
    let ahead = || {
        i64::from(at.x - from.x) * i64::from(to.x - at.x) + i64::from(at.y - from.y) * i64::from(to.y - at.y)
    };
    let length = || f64::from(to.x - from.x).hypot(f64::from(to.y - from.y));
    double < 0 && ahead() > 0 && (-double) as f64 <= KINK * length()
}
