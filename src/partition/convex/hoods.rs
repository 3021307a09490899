//! Hoods over curved walls: what restrains their cuts to where they are.
//!
//! Each corner of a curve that bulges into a region is reflex, and needs a cut that runs across the whole region, or so it is with diagonals
//! alone (Maria, Horna, Aveneau 2014, section 6.2.1 and Fig. 10, which put a box around such walls). Here tangents of the curve, from point
//! to point of it, make a *hood*: what lies between hood and curve is cut by itself, in fans of short cuts, and what is left of the region has
//! as many reflex corners as the hood has. Corners of hoods are new points of the plan, inside the region: nobody else's border changes.

use std::collections::HashMap;

use crate::lattice::{Point, orient};

/// Fewer corners in a row are no curve.
const LEAST_CORNERS: usize = 3;

/// Corners of a curve turn by less than this: its cosine. 61 degrees: hexagons are curves, squares are not.
const GENTLE: f64 = 0.48;

/// A region with its curves under hoods.
pub(super) struct Hooded {
    /// The region's points, then those of the hoods.
    pub(super) points: Vec<Point>,
    /// The boundary of what is left of the region.
    pub(super) chains: Vec<Vec<u32>>,
    /// What lies between hoods and curves.
    pub(super) corners: Vec<Vec<u32>>,
}

/// Work that a region's hoods may take, edges looked at: some seconds.
const MOST_WORK: u64 = 1 << 30;

/// Whether a region has a curve at all.
pub(super) fn has_curve(loops: &[Vec<u32>], points: &[Point]) -> bool {
    loops.iter().any(|chain| {
        let n = chain.len();
        let bends = |k: usize| (0..LEAST_CORNERS).all(|j| is_bend(chain, k + j, points));
        (0..n).any(bends)
    })
}

/// Whether a chain turns gently away from the region at a place.
fn is_bend(chain: &[u32], place: usize, points: &[Point]) -> bool {
    let n = chain.len();
    let at = |k: usize| points[chain[k % n] as usize];
    let (a, b, c) = (at(place + n - 1), at(place), at(place + 1));
    orient(a, b, c) < 0 && matches!((unit(a, b), unit(b, c)), (Some(u), Some(v)) if dot(u, v) > GENTLE)
}

/// Puts hoods over the curves of a region, as `convex_parts` takes it, whose sides turn by no more than the angle of this cosine from one to
/// the next. `None` if there is none that fits.
pub(super) fn hooded(loops: &[Vec<u32>], points: &[Point], cosine: f64) -> Option<Hooded> {
    let mut visits: HashMap<u32, u32> = HashMap::new();
    loops.iter().flatten().for_each(|&v| *visits.entry(v).or_default() += 1);
    let mut site = Site { points: points.to_vec(), edges: Vec::new(), cosine, corners: Vec::new(), work: 0 };
    for chain in loops {
        site.edges.extend((0..chain.len()).map(|i| [chain[i], chain[(i + 1) % chain.len()]]));
    }
    let chains = loops.iter().map(|chain| site.chain(chain, &|v| visits[&v] > 1)).collect();
    let Site { points, corners, .. } = site;
    (!corners.is_empty()).then_some(Hooded { points, chains, corners })
}

/// Corners of hoods are moved out by so much at most, lattice units: roundings put them in by less.
const FARTHEST: i32 = 128;

type Vector = [f64; 2];

struct Site {
    points: Vec<Point>,
    /// All edges of the region, and those of hoods.
    edges: Vec<[u32; 2]>,
    cosine: f64,
    corners: Vec<Vec<u32>>,
    /// Edges looked at so far.
    work: u64,
}

/// A curve of a chain, from corner to corner along it.
struct Curve {
    corners: Vec<u32>,
    /// The tangent at each, of unit length.
    tangents: Vec<Vector>,
    /// What comes before the first and after the last; `None` if the curve closes, its first corner being its last one too.
    beside: Option<[u32; 2]>,
}

/// A step along a curve's hood: its first and last corner by their places in the curve, and the hood's corner between.
#[derive(Clone, Copy)]
struct Step {
    places: [usize; 2],
    peak: Point,
}

impl Site {
    fn at(&self, vertex: u32) -> Point {
        self.points[vertex as usize]
    }

    /// The chain with hoods for its curves.
    fn chain(&mut self, chain: &[u32], is_shared: &dyn Fn(u32) -> bool) -> Vec<u32> {
        let n = chain.len();
        let bends: Vec<bool> =
            (0..n).map(|i| is_bend(chain, i, &self.points) && !is_shared(chain[i])).collect();
        if bends.iter().all(|&bend| bend) {
            // From the corner farthest to the right on.
            let first = (0..n).max_by_key(|&i| (self.at(chain[i]), i)).unwrap_or(0);
            let corners: Vec<u32> = (0..=n).map(|k| chain[(first + k) % n]).collect();
            return match self.hood(corners, None) {
                // Its last corner is the first.
                Some(mut hood) => {
                    hood.pop();
                    hood
                }
                None => chain.to_vec(),
            };
        }
        // Begin where no curve does.
        let start = bends.iter().position(|&bend| !bend).unwrap_or(0);
        let mut result = Vec::with_capacity(n);
        let mut k = 0;
        while k < n {
            let place = |k: usize| (start + k) % n;
            let bent = (k..n).take_while(|&k| bends[place(k)]).count();
            if bent >= LEAST_CORNERS {
                let corners: Vec<u32> = (k..k + bent).map(|k| chain[place(k)]).collect();
                let beside = [chain[place(k + n - 1)], chain[place(k + bent)]];
                match self.hood(corners, Some(beside)) {
                    Some(hood) => result.extend(hood),
                    None => result.extend((k..k + bent).map(|k| chain[place(k)])),
                }
            } else {
                result.extend((k..(k + bent.max(1)).min(n)).map(|k| chain[place(k)]));
            }
            k += bent.max(1);
        }
        result
    }

    /// The hood of a curve, from its first corner to its last; adds its points, its edges and what lies under it.
    fn hood(&mut self, corners: Vec<u32>, beside: Option<[u32; 2]>) -> Option<Vec<u32>> {
        let curve = self.curve(corners, beside)?;
        let places = self.places(&curve)?;
        self.work += self.edges.len() as u64;
        if self.work > MOST_WORK {
            return None;
        }
        let near = self.near(&curve, &places);
        // Farther out until no corner that the hood touches is reflex any more.
        let out = (0..).map(|k| 1 << k).take_while(|&out| out <= FARTHEST);
        let steps = out.into_iter().find_map(|out| {
            let step = |&places| Some(Step { places, peak: self.peak(&curve, places, out)? });
            let steps: Option<Vec<Step>> = places.iter().map(step).collect();
            steps.filter(|steps| self.is_hood(&curve, steps, &near))
        })?;
        let mut hood = Vec::with_capacity(2 * steps.len() + 1);
        for Step { places: [from, to], peak } in steps {
            let id = self.points.len() as u32;
            self.points.push(peak);
            let mut under = curve.corners[from..=to].to_vec();
            under.push(id);
            self.corners.push(under);
            self.edges.extend([[curve.corners[from], id], [id, curve.corners[to]]]);
            hood.extend([curve.corners[from], id]);
        }
        hood.push(curve.corners[curve.corners.len() - 1]);
        Some(hood)
    }

    /// The tangents of a curve; `None` where corners lie too near for that.
    fn curve(&self, corners: Vec<u32>, beside: Option<[u32; 2]>) -> Option<Curve> {
        let last = corners.len() - 1;
        let points: Vec<Point> = corners.iter().map(|&v| self.at(v)).collect();
        let way = |i: usize| unit(points[i], points[i + 1]);
        let between = |u: Vector, v: Vector| normal([u[0] + v[0], u[1] + v[1]]);
        let mut tangents = Vec::with_capacity(corners.len());
        for i in 0..=last {
            tangents.push(match (i, beside) {
                (0, Some([before, _])) => unit(self.at(before), points[0])?,
                (0, None) => between(way(last - 1)?, way(0)?)?,
                (i, Some([_, after])) if i == last => unit(points[last], self.at(after))?,
                (i, None) if i == last => tangents[0],
                _ => between(way(i - 1)?, way(i)?)?,
            });
        }
        Some(Curve { corners, tangents, beside })
    }

    /// Steps along a curve, each as long as its tangents allow: their first and last corners, by their places.
    fn places(&self, curve: &Curve) -> Option<Vec<[usize; 2]>> {
        let last = curve.corners.len() - 1;
        let mut steps = Vec::new();
        let mut from = 0;
        while from < last {
            let mut to = from + 1;
            while to < last && dot(curve.tangents[from], curve.tangents[to + 1]) >= self.cosine {
                // No farther than half a turn.
                if cross(curve.tangents[from], curve.tangents[to + 1]) >= 0.0 {
                    break;
                }
                to += 1;
            }
            steps.push([from, to]);
            from = to;
        }
        (steps.len() < last).then_some(steps)
    }

    /// Where the tangents at both ends of a step meet, and a few steps of the lattice farther out.
    fn peak(&self, curve: &Curve, [from, to]: [usize; 2], push: i32) -> Option<Point> {
        let (a, b) = (self.at(curve.corners[from]), self.at(curve.corners[to]));
        let (u, v) = (curve.tangents[from], curve.tangents[to]);
        let way = [f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y)];
        let along = cross(way, v) / cross(u, v);
        let out = normal([-way[1], way[0]])?;
        let at = |c: i32, axis: usize| {
            let x = (f64::from(c) + u[axis] * along + out[axis] * f64::from(push)).round();
            (x.abs() <= f64::from(crate::lattice::LARGEST)).then_some(x as i32)
        };
        Some(Point { x: at(a.x, 0)?, y: at(a.y, 1)? })
    }

    /// The edges that come near to a curve or its hood, however far out that is.
    fn near(&self, curve: &Curve, places: &[[usize; 2]]) -> Vec<[u32; 2]> {
        let peaks = places.iter().filter_map(|&places| self.peak(curve, places, FARTHEST));
        let all: Vec<Point> = curve.corners.iter().map(|&v| self.at(v)).chain(peaks).collect();
        let bounds = |pick: fn(&Point) -> i32| {
            let (lo, hi) = (all.iter().map(pick).min(), all.iter().map(pick).max());
            [lo.unwrap_or(0) - FARTHEST, hi.unwrap_or(0) + FARTHEST]
        };
        let (x, y) = (bounds(|p| p.x), bounds(|p| p.y));
        let is_near = |&&[a, b]: &&[u32; 2]| {
            let (a, b) = (self.at(a), self.at(b));
            a.x.max(b.x) >= x[0] && a.x.min(b.x) <= x[1] && a.y.max(b.y) >= y[0] && a.y.min(b.y) <= y[1]
        };
        self.edges.iter().filter(is_near).copied().collect()
    }

    /// Whether the steps make a hood: over the curve, inside the region, without reflex corners where it touches the curve.
    fn is_hood(&self, curve: &Curve, steps: &[Step], near: &[[u32; 2]]) -> bool {
        let corner = |place: usize| self.at(curve.corners[place]);
        let beside = |k: usize| curve.beside.map(|ids| self.at(ids[k]));
        let last = steps[steps.len() - 1];
        let starts = beside(0).unwrap_or(last.peak);
        let ends = beside(1).unwrap_or(steps[0].peak);
        let peaks = || steps.iter().map(|step| step.peak);
        let touched = steps.iter().map(|step| corner(step.places[0])).chain([corner(last.places[1])]);
        let around = std::iter::once(starts).chain(peaks()).zip(touched).zip(peaks().chain([ends]));
        if around.into_iter().any(|((before, here), after)| orient(before, here, after) < 0) {
            return false;
        }
        steps.iter().enumerate().all(|(k, step)| {
            let ([from, to], peak) = (step.places, step.peak);
            let (a, b) = (corner(from), corner(to));
            let is_under = |v: u32| orient(a, peak, self.at(v)) < 0 && orient(peak, b, self.at(v)) < 0;
            if orient(a, b, peak) <= 0 || !curve.corners[from + 1..to].iter().all(|&v| is_under(v)) {
                return false;
            }
            let sides = [(curve.corners[from], [a, peak]), (curve.corners[to], [peak, b])];
            let is_free = near.iter().all(|ids| {
                let edge = ids.map(|v| self.at(v));
                // What begins or ends where a side does is told by the angles above.
                sides.iter().all(|&(id, side)| ids.contains(&id) || !meet(side, edge))
                    && ids
                        .iter()
                        .all(|v| curve.corners[from..=to].contains(v) || !holds([a, peak, b], self.at(*v)))
            });
            // The hood's other sides lie over other parts of the curve.
            let others = steps[k + 1..].iter().flat_map(|other| {
                let [c, d] = other.places.map(corner);
                [[c, other.peak], [other.peak, d]]
            });
            let is_simple = others.into_iter().all(|that| {
                sides.iter().all(|(_, side)| side.iter().any(|p| that.contains(p)) || !meet(*side, that))
            });
            is_free && is_simple
        })
    }
}

/// Whether two closed segments have a point in common.
fn meet([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let sides = |p: Point, q: Point, r: Point, s: Point| orient(p, q, r).signum() * orient(p, q, s).signum();
    let (one, other) = (sides(a, b, c, d), sides(c, d, a, b));
    if one > 0 || other > 0 {
        return false;
    }
    let apart = |axis: fn(Point) -> i32| {
        axis(a).max(axis(b)) < axis(c).min(axis(d)) || axis(c).max(axis(d)) < axis(a).min(axis(b))
    };
    !apart(|p| p.x) && !apart(|p| p.y)
}

/// Whether a triangle, clockwise, holds a point, its border included.
fn holds([a, b, c]: [Point; 3], p: Point) -> bool {
    orient(a, b, p) <= 0 && orient(b, c, p) <= 0 && orient(c, a, p) <= 0
}

fn dot(u: Vector, v: Vector) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

fn cross(u: Vector, v: Vector) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn normal(v: Vector) -> Option<Vector> {
    let length = dot(v, v).sqrt();
    (length > 0.0).then(|| [v[0] / length, v[1] / length])
}

fn unit(from: Point, to: Point) -> Option<Vector> {
    normal([f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y)])
}
