//! Which triangles are drawn as one: those that make a flat, convex polygon.
//!
//! Models are made of quadrangles, cut into triangles to be written down. Along the cut each tile of a picture would be drawn twice, in part. So
//! triangles of one element and material are joined across their sides, the longest first, as long as what comes of it stays flat and convex.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::sync::OnceLock;

use glam::DVec3;

use crate::format::Views;

/// A polygon has no more corners.
pub(super) const MOST_CORNERS: usize = 8;

/// It is bent by no more than this, metres.
const BENT: f64 = 1e-6;

/// Elements of more triangles are drawn triangle by triangle: to join them takes longer than a picture.
const MOST_TRIANGLES: usize = 1 << 15;

/// The polygons of a scene: of each run of triangles when one of them is first drawn.
pub(crate) struct Joined {
    runs: Vec<OnceLock<Polygons>>,
}

/// The polygons of a run.
struct Polygons {
    /// Which each triangle is of, named by one of its triangles, and where that begins in `loops`: together, as each is a wait for the memory.
    of: Box<[[u32; 2]]>,
    /// Of each polygon the number of corners, and those.
    loops: Box<[u32]>,
}

/// Some triangles that are one polygon.
pub(super) struct Polygon<'a> {
    /// One of them, the same for all.
    pub(super) lead: u32,
    /// Counter-clockwise if the triangles are, at most [`MOST_CORNERS`].
    pub(super) corners: &'a [u32],
}

impl Joined {
    /// Of a scene with so many runs of triangles.
    pub(crate) fn new(runs: usize) -> Joined {
        Joined { runs: (0..runs).map(|_| OnceLock::new()).collect() }
    }

    /// The polygon that a triangle is of.
    #[inline]
    pub(super) fn of<'a>(&'a self, tables: &'a Views, triangle: u32) -> Polygon<'a> {
        let run = tables.run_of[triangle as usize] as usize;
        let first = tables.runs[run].first;
        let polygons = self.runs[run].get_or_init(|| {
            // Triangles behind those that rays meet say only what is inside of what.
            let met = (tables.scene[0].detail_triangles as usize).min(tables.triangles.len());
            let end = tables.runs.get(run + 1).map_or(met, |next| met.min(next.first as usize));
            let own = tables.triangles.get(first as usize..end).unwrap_or_default();
            Polygons::new(own, &tables.vertices)
        });
        match polygons.of.get((triangle - first) as usize) {
            Some(&[lead, start]) => Polygon { lead: first + lead, corners: polygons.corners(start) },
            None => Polygon { lead: triangle, corners: &tables.triangles[triangle as usize] },
        }
    }
}

impl Polygons {
    /// Of some triangles, each a polygon at first.
    fn new(triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> Polygons {
        let mut loops: Vec<Vec<u32>> = triangles.iter().map(|corners| corners.to_vec()).collect();
        let mut of: Vec<u32> = (0..triangles.len() as u32).collect();
        if triangles.len() <= MOST_TRIANGLES {
            for [from, to, one, other] in common_sides(triangles, vertices) {
                let [one, other] = [one, other].map(|triangle| root(&mut of, triangle));
                let [keeps, goes] = [one.min(other), one.max(other)];
                let joined = join([&loops[keeps as usize], &loops[goes as usize]], [from, to], vertices);
                if let Some(corners) = joined.filter(|_| one != other) {
                    loops[keeps as usize] = corners;
                    loops[goes as usize] = Vec::new();
                    of[goes as usize] = keeps;
                }
            }
        }
        let starts: Vec<u32> = loops
            .iter()
            .scan(0, |end, corners| Some(std::mem::replace(end, *end + 1 + corners.len() as u32)))
            .collect();
        let of = (0..triangles.len() as u32).map(|triangle| {
            let lead = root(&mut of, triangle);
            [lead, starts[lead as usize]]
        });
        let of = of.collect();
        let loops =
            loops.into_iter().flat_map(|corners| std::iter::once(corners.len() as u32).chain(corners));
        Polygons { of, loops: loops.collect() }
    }

    #[inline]
    fn corners(&self, start: u32) -> &[u32] {
        let (&count, rest) = self.loops[start as usize..].split_first().unwrap_or((&0, &[]));
        &rest[..count as usize]
    }
}

/// The polygon that a triangle is of: the end of its chain, which is made shorter.
fn root(of: &mut [u32], mut triangle: u32) -> u32 {
    while of[triangle as usize] != triangle {
        of[triangle as usize] = of[of[triangle as usize] as usize];
        triangle = of[triangle as usize];
    }
    triangle
}

/// Sides that two triangles have in common, with their ends and the triangles, the longest first: of a rectangle that is what it was cut along.
fn common_sides(triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<[u32; 4]> {
    let mut known: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * triangles.len());
    let mut common = Vec::new();
    for (triangle, corners) in (0..).zip(triangles) {
        for i in 0..3 {
            let [from, to] = [corners[i], corners[(i + 1) % 3]];
            if let Some(other) = known.remove(&[to, from]) {
                common.push([from, to, triangle, other]);
            } else {
                known.insert([from, to], triangle);
            }
        }
    }
    let place = |vertex: u32| DVec3::from(vertices[vertex as usize]);
    // Lengths are no numbers with a sign: their bits are in order.
    let length = |side: &[u32; 4]| (place(side[1]) - place(side[0])).length_squared().to_bits();
    common.sort_by_key(|side| (Reverse(length(side)), *side));
    common
}

/// The polygon that two are, which have a side in common: from one end to the other in one of them, and back in the other. None if it is bent, not convex, or
/// of too many corners.
fn join([one, other]: [&[u32]; 2], [from, to]: [u32; 2], vertices: &[[f64; 3]]) -> Option<Vec<u32>> {
    if one.len() + other.len() - 2 > MOST_CORNERS {
        return None;
    }
    let starts_at = |corners: &[u32], [a, b]: [u32; 2]| {
        (0..corners.len()).find(|&i| corners[i] == a && corners[(i + 1) % corners.len()] == b)
    };
    // The loop that has the side this way comes first.
    let (one, other, at, back) = match (starts_at(one, [from, to]), starts_at(other, [to, from])) {
        (Some(at), Some(back)) => (one, other, at, back),
        _ => (other, one, starts_at(other, [from, to])?, starts_at(one, [to, from])?),
    };
    // From the side's second end around the first polygon to its first end, and on around the second.
    let mut corners: Vec<u32> = (1..=one.len()).map(|i| one[(at + i) % one.len()]).collect();
    corners.extend((2..other.len()).map(|i| other[(back + i) % other.len()]));
    let places: Vec<DVec3> = corners.iter().map(|&vertex| DVec3::from(vertices[vertex as usize])).collect();
    is_flat_and_convex(&places).then_some(corners)
}

/// Whether a polygon is flat, and turns the same way at each corner, once around.
fn is_flat_and_convex(corners: &[DVec3]) -> bool {
    let count = corners.len();
    let [first, rest @ ..] = corners else { return false };
    let normal: DVec3 = rest.windows(2).map(|pair| (pair[0] - first).cross(pair[1] - first)).sum();
    let unit = normal.normalize_or_zero();
    let heights = || corners.iter().map(|corner| (corner - first).dot(unit));
    let (least, most) = heights().fold((0.0f64, 0.0f64), |(least, most), h| (least.min(h), most.max(h)));
    // Seen from the first corner the others follow each other: it goes around but once.
    let is_fan = rest.windows(2).all(|pair| (pair[0] - first).cross(pair[1] - first).dot(unit) > 0.0);
    let turns = (0..count).all(|i| {
        let [before, at, after] = [corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]];
        (at - before).cross(after - at).dot(unit) > 0.0
    });
    is_fan && turns && most - least <= BENT
}

/// What was drawn already: forgotten at once, without a look at each.
pub(crate) struct Once {
    when: Vec<u32>,
    now: u32,
}

impl Once {
    pub(crate) fn new() -> Once {
        Once { when: Vec::new(), now: 0 }
    }

    /// Nothing yet, of so many.
    pub(super) fn begin(&mut self, count: usize) {
        if self.when.len() != count || self.now == u32::MAX {
            self.when.clear();
            self.when.resize(count, 0);
            self.now = 0;
        }
        self.now += 1;
    }

    /// Whether this is new.
    #[inline(always)]
    pub(super) fn insert(&mut self, at: u32) -> bool {
        std::mem::replace(&mut self.when[at as usize], self.now) != self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of the polygons that some triangles make.
    fn polygons(triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<Vec<u32>> {
        let polygons = Polygons::new(triangles, vertices);
        let of = |triangle: usize| {
            let [_, start] = polygons.of[triangle];
            polygons.corners(start).to_vec()
        };
        (0..triangles.len()).map(of).collect()
    }

    #[test]
    fn a_rectangle_is_one_and_a_bent_one_is_two() {
        let mut vertices = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let cut = [[0, 1, 2], [0, 2, 3]];
        assert_eq!(polygons(&cut, &vertices), vec![vec![2, 3, 0, 1]; 2]);
        // Wound the other way they are no polygon.
        assert_eq!(polygons(&[[0, 1, 2], [0, 3, 2]], &vertices), [[0, 1, 2], [0, 3, 2]]);
        vertices[3][2] = 1e-5;
        assert_eq!(polygons(&cut, &vertices), cut);
    }

    #[test]
    fn an_arrow_is_two() {
        let vertices = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 2.0, 0.0]];
        let cut = [[0, 1, 2], [0, 2, 3]];
        assert_eq!(polygons(&cut, &vertices), cut);
    }

    #[test]
    fn a_fan_is_one_polygon_as_far_as_it_has_few_corners() {
        let corner = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / 12.0;
            [angle.cos(), angle.sin(), 2.0]
        };
        let vertices: Vec<_> = (0..12).map(corner).collect();
        let fan: Vec<_> = (1..11).map(|i| [0, i, i + 1]).collect();
        let all = polygons(&fan, &vertices);
        assert!(all.iter().all(|corners| (3..=MOST_CORNERS).contains(&corners.len())));
        let mut different = all;
        different.dedup();
        assert!(different.len() <= 3, "{different:?}");
        let sides: usize = different.iter().map(Vec::len).sum();
        assert_eq!(sides, 12 + 2 * (different.len() - 1));
    }

    /// Around a hole: two polygons may have more than one side in common, and no polygon has a corner twice.
    #[test]
    fn what_goes_around_is_not_closed() {
        let ring = |r: f64| [[r, r, 0.0], [-r, r, 0.0], [-r, -r, 0.0], [r, -r, 0.0]];
        let vertices: Vec<_> = ring(1.0).into_iter().chain(ring(2.0)).collect();
        let side = |i: u32| [[i, i + 4, (i + 1) % 4 + 4], [i, (i + 1) % 4 + 4, (i + 1) % 4]];
        let triangles: Vec<_> = (0..4).flat_map(side).collect();
        for corners in polygons(&triangles, &vertices) {
            assert_eq!(corners.len(), 4, "{corners:?}");
        }
    }

    #[test]
    fn once_is_forgotten_when_it_begins_again() {
        let mut once = Once::new();
        for _ in 0..3 {
            once.begin(4);
            assert!(once.insert(2) && !once.insert(2) && once.insert(3));
        }
    }
}
