//! Polygons to triangles.

use std::collections::HashMap;

use earcut::Earcut;

use crate::obj::crossing::{Crossing, crosses_itself};

type Point = [f64; 3];

/// Polygons of more corners than this are not triangulated: the time for it may grow with the square.
const MOST_CORNERS: usize = 1 << 16;

/// Twice the area over the square of the extent: below it a polygon has no area but what rounding gives it.
const NO_AREA: f64 = 1e-12;

/// The triangles have the polygon's area to this, relative.
const AREA_TOLERANCE: f64 = 1e-9;

/// Where sides cross a little, as rounded coordinates may make them, ears are still better than a fan: to this,
/// relative.
const ROUGH_AREA_TOLERANCE: f64 = 1e-2;

/// Up to so many corners ears are cut even if sides cross: the time for it grows with the square then.
const FEW_CORNERS: usize = 512;

/// How a polygon was triangulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The triangles are the polygon.
    Exact,
    /// No triangulation is the polygon, as it crosses itself: the triangles are nearly it where it does so a
    /// little, else a fan around its first corner.
    Rough,
    /// It has no area: no triangles.
    NoArea,
    /// It has too many corners: no triangles.
    TooLarge,
}

/// Triangulates polygons one after the other, and keeps its buffers between them.
#[derive(Default)]
pub(super) struct Triangulator {
    earcut: Earcut<f64>,
    ring: Vec<u32>,
    plane: Vec<[f64; 2]>,
    ears: Vec<u32>,
}

impl Triangulator {
    /// Triangulates the polygon with these corners, concave or not, planar or nearly so. The triangles' corners are
    /// indices into `corners`, and they wind as the polygon does. Triangles stay as they are, quads are cut along
    /// the shorter diagonal that lies inside. Every corner is used, those on a straight side too, so that
    /// neighbours still meet edge to edge. The result depends on nothing but the corners.
    pub(super) fn triangulate(&mut self, corners: &[Point], triangles: &mut Vec<[u32; 3]>) -> Outcome {
        triangles.clear();
        if corners.len() == 3 {
            triangles.push([0, 1, 2]);
            return Outcome::Exact;
        }
        if corners.len() > MOST_CORNERS {
            return Outcome::TooLarge;
        }
        self.drop_repeated(corners);
        let Some(area) = self.project(corners) else { return Outcome::NoArea };
        let outcome = match self.ring.len() {
            // Beyond what any model has; the builder refuses the coordinates.
            _ if !area.is_finite() => Outcome::Rough,
            3 => {
                triangles.push([0, 1, 2]);
                Outcome::Exact
            }
            4 if self.cut_quad(corners, triangles) => Outcome::Exact,
            _ => self.cut_ears(area, triangles),
        };
        if triangles.is_empty() {
            self.fan(triangles);
        }
        for triangle in triangles.iter_mut() {
            *triangle = triangle.map(|v| self.ring[v as usize]);
        }
        outcome
    }

    /// Fills the ring with the corners that differ from the one before.
    fn drop_repeated(&mut self, corners: &[Point]) {
        self.ring.clear();
        for (index, corner) in corners.iter().enumerate() {
            if self.ring.last().is_none_or(|&last| corners[last as usize] != *corner) {
                self.ring.push(index as u32);
            }
        }
        while self.ring.len() > 1
            && corners[self.ring[0] as usize] == corners[self.ring[self.ring.len() - 1] as usize]
        {
            self.ring.pop();
        }
    }

    /// Projects the ring along the main axis of its normal (Newell's), so that it winds counter-clockwise. Gives the
    /// area in the projection, or `None` where there is none.
    fn project(&mut self, corners: &[Point]) -> Option<f64> {
        self.plane.clear();
        let origin = corners[*self.ring.first()? as usize];
        // Differences first: they keep their digits far from the model's origin.
        let relative = |v: u32| {
            let p = corners[v as usize];
            [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]
        };
        let mut normal = [0.0f64; 3];
        let mut extent = 0.0f64;
        for pair in self.ring.windows(2) {
            let (a, b) = (relative(pair[0]), relative(pair[1]));
            for axis in 0..3 {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                normal[axis] += a[u] * b[v] - a[v] * b[u];
                extent = extent.max(b[axis].abs());
            }
        }
        if extent > 1e100 {
            return Some(f64::INFINITY);
        }
        let largest = normal.iter().fold(0.0f64, |m, n| m.max(n.abs()));
        if largest <= NO_AREA * extent * extent {
            return None;
        }
        // Of axes that are as good as equal the last wins, whatever the rounding.
        let axis = (0..3).rev().find(|&axis| normal[axis].abs() >= 0.999_999 * largest)?;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
        self.plane.extend(self.ring.iter().map(|&c| [relative(c)[u], relative(c)[v]]));
        Some(normal[axis].abs() / 2.0)
    }

    /// Cuts a quad along a diagonal that leaves two triangles that wind as it does: the shorter one if both do.
    fn cut_quad(&self, corners: &[Point], triangles: &mut Vec<[u32; 3]>) -> bool {
        let cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
        let fits = |cut: &[[u32; 3]; 2]| {
            let areas = cut.map(|t| self.area(t));
            areas[0].min(areas[1]) > NO_AREA * (areas[0] + areas[1])
        };
        let length = |a: usize, b: usize| {
            let (p, q) = (corners[self.ring[a] as usize], corners[self.ring[b] as usize]);
            (0..3).map(|axis| (p[axis] - q[axis]) * (p[axis] - q[axis])).sum::<f64>()
        };
        let cut = match (fits(&cuts[0]), fits(&cuts[1])) {
            (true, true) => {
                // Rounding must not choose between equal diagonals: a model in other units would be cut otherwise.
                // Far from the origin the roundings of the corners themselves are the larger part.
                let far =
                    self.ring.iter().flat_map(|&v| corners[v as usize]).fold(0.0f64, |m, c| m.max(c.abs()));
                let (first, second) = (length(0, 2), length(1, 3));
                let rounding = 1e-9 * first + 32.0 * f64::EPSILON * far * first.sqrt();
                cuts[usize::from(second < first - rounding)]
            }
            (true, false) => cuts[0],
            (false, true) => cuts[1],
            (false, false) => return false,
        };
        triangles.extend(cut);
        true
    }

    /// Cuts ears. No triangles if they are far from the polygon.
    fn cut_ears(&mut self, area: f64, triangles: &mut Vec<[u32; 3]>) -> Outcome {
        if self.ring.len() > FEW_CORNERS && crosses_itself(&self.plane) != Crossing::No {
            return Outcome::Rough;
        }
        self.earcut.earcut_slice(&self.plane, &[], &mut self.ears);
        triangles.extend(self.ears.chunks_exact(3).map(|t| [t[0], t[1], t[2]]));
        let mut sum = 0.0;
        for triangle in triangles.iter_mut() {
            let area = area_of(triangle.map(|v| self.plane[v as usize]));
            if area < 0.0 {
                triangle.swap(1, 2);
            }
            sum += area.abs();
        }
        let error = (sum - area).abs();
        if error <= AREA_TOLERANCE * area {
            self.put_back_straight_corners(triangles);
            return Outcome::Exact;
        }
        if error > ROUGH_AREA_TOLERANCE * area {
            triangles.clear();
        }
        Outcome::Rough
    }

    /// Ear cutting may drop corners on straight sides. Puts each back by cutting the triangle at its side in two.
    fn put_back_straight_corners(&self, triangles: &mut Vec<[u32; 3]>) {
        let count = self.ring.len();
        if triangles.len() + 2 >= count {
            return;
        }
        let mut used = vec![false; count];
        let mut sides = HashMap::new();
        for (index, t) in triangles.iter().enumerate() {
            for side in 0..3 {
                used[t[side] as usize] = true;
                sides.insert((t[side], t[(side + 1) % 3]), index);
            }
        }
        let Some(start) = used.iter().position(|&u| u) else { return };
        // For each corner the next one around that is used.
        let mut next_used = vec![start; count];
        for corner in (start..start + count - 1).rev().map(|c| c % count) {
            let next = (corner + 1) % count;
            next_used[corner] = if used[next] { next } else { next_used[next] };
        }
        let mut before = start;
        for corner in (start + 1..start + count).map(|c| c % count) {
            if used[corner] {
                before = corner;
                continue;
            }
            let side = (before as u32, next_used[corner] as u32);
            // Where there is no such side the corner is the tip of a spike, which has no area.
            let Some(index) = sides.remove(&side) else { continue };
            let Some(tip) = triangles[index].into_iter().find(|&v| v != side.0 && v != side.1) else {
                continue;
            };
            before = corner;
            let corner = corner as u32;
            triangles[index] = [side.0, corner, tip];
            sides.insert((side.0, corner), index);
            for new in [(corner, side.1), (side.1, tip)] {
                sides.insert(new, triangles.len());
            }
            triangles.push([corner, side.1, tip]);
        }
    }

    fn fan(&self, triangles: &mut Vec<[u32; 3]>) {
        triangles.clear();
        triangles.extend((1..self.ring.len().saturating_sub(1) as u32).map(|v| [0, v, v + 1]));
    }

    fn area(&self, triangle: [u32; 3]) -> f64 {
        area_of(triangle.map(|v| self.plane[v as usize]))
    }
}

/// The area of a triangle in the plane, negative if it winds clockwise.
fn area_of([a, b, c]: [[f64; 2]; 3]) -> f64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obj::crossing::tests::KEYHOLE;
    use proptest::prelude::*;

    fn cut(corners: &[Point]) -> (Outcome, Vec<[u32; 3]>) {
        let mut triangles = Vec::new();
        let outcome = Triangulator::default().triangulate(corners, &mut triangles);
        (outcome, triangles)
    }

    fn flat(corners: &[[f64; 2]]) -> Vec<Point> {
        corners.iter().map(|c| [c[0], c[1], 5.0]).collect()
    }

    fn signed_area(corners: &[[f64; 2]]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
    }

    /// The triangles wind as the polygon, fill it, and have each of its sides exactly once and all else in pairs.
    fn check(corners: &[[f64; 2]], triangles: &[[u32; 3]]) {
        let area = signed_area(corners);
        let mut sum = 0.0;
        let mut sides = std::collections::BTreeMap::new();
        for t in triangles {
            let part = area_of(t.map(|v| corners[v as usize]));
            assert!(part * area >= 0.0, "{t:?} winds the other way");
            sum += part;
            for side in 0..3 {
                *sides.entry((t[side], t[(side + 1) % 3])).or_insert(0) += 1;
            }
        }
        assert!((sum - area).abs() <= 1e-9 * area.abs(), "{sum} is not {area}");
        assert_eq!(triangles.len(), corners.len() - 2);
        let count = corners.len() as u32;
        for v in 0..count {
            assert_eq!(sides.remove(&(v, (v + 1) % count)), Some(1), "side {v}");
        }
        for (&(a, b), &times) in &sides {
            assert_eq!((times, sides.get(&(b, a))), (1, Some(&1)), "diagonal {a} {b}");
        }
    }

    /// Whether `p` is in the polygon (even-odd).
    fn contains(corners: &[[f64; 2]], p: [f64; 2]) -> bool {
        let next = corners.iter().cycle().skip(1);
        let crossed = corners.iter().zip(next).filter(|(a, b)| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0]
        });
        crossed.count() % 2 == 1
    }

    const L_SHAPE: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];

    #[test]
    fn concave_polygons_keep_their_area_and_no_triangle_is_outside() {
        let comb: Vec<[f64; 2]> = (0..40)
            .map(|i| [f64::from(i / 2), if (i + 1) / 2 % 2 == 0 { 0.5 } else { 4.0 }])
            .chain([[20.0, 0.0], [0.0, 0.0]])
            .collect();
        for polygon in [&L_SHAPE[..], &comb] {
            for reverse in [false, true] {
                let mut polygon = polygon.to_vec();
                if reverse {
                    polygon.reverse();
                }
                for _ in 0..polygon.len() {
                    polygon.rotate_left(1);
                    let (outcome, triangles) = cut(&flat(&polygon));
                    assert_eq!(outcome, Outcome::Exact);
                    check(&polygon, &triangles);
                    for t in &triangles {
                        let [a, b, c] = t.map(|v| polygon[v as usize]);
                        let middle = [0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0);
                        assert!(contains(&polygon, middle), "{t:?} is outside");
                    }
                }
            }
        }
    }

    #[test]
    fn quads_are_cut_along_the_shorter_diagonal_that_is_inside() {
        assert_eq!(cut(&flat(&[[0.0, 0.0], [2.0, 0.0], [3.0, 1.0], [0.0, 1.0]])).1, [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(cut(&flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [-1.0, 1.0]])).1, [[0, 1, 2], [0, 2, 3]]);
        // A rectangle, whose diagonals are equal but for rounding.
        for angle in 0..100 {
            let (s, c) = f64::from(angle).sin_cos();
            let turned =
                [[0.0, 0.0], [3.3, 0.0], [3.3, 1.7], [0.0, 1.7]].map(|[x, y]| [c * x - s * y, s * x + c * y]);
            assert_eq!(cut(&flat(&turned)).1, [[0, 1, 2], [0, 2, 3]]);
            // Small, and as far away as models lie: the corners are rounded to 1e-9 m.
            let far = turned.map(|[x, y]| [0.1 * x + 458_123.6, 0.1 * y - 5_427_891.4]);
            assert_eq!(cut(&flat(&far)).1, [[0, 1, 2], [0, 2, 3]]);
        }
        // An arrow head: only the diagonal from the inner corner is inside.
        let arrow = [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [0.0, 4.0]];
        assert_eq!(cut(&flat(&arrow)).1, [[0, 1, 2], [0, 2, 3]]);
        let arrow = [[0.0, 4.0], [0.0, 0.0], [4.0, 0.0], [1.0, 1.0]];
        assert_eq!(cut(&flat(&arrow)).1, [[0, 1, 3], [1, 2, 3]]);
        // A corner on a straight side.
        let straight = [[0.0, 0.0], [1.0, 0.0], [9.0, 0.0], [1.0, 1.0]];
        assert_eq!(cut(&flat(&straight)).1, [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn corners_on_straight_sides_are_all_used() {
        let mut square = Vec::new();
        for [from, to] in
            [[[0., 0.], [3., 0.]], [[3., 0.], [3., 3.]], [[3., 3.], [0., 3.]], [[0., 3.], [0., 0.]]]
        {
            for step in 0..30 {
                let at = f64::from(step) / 30.0;
                square.push([0, 1].map(|i: usize| from[i] + at * (to[i] - from[i])));
            }
        }
        for start in [0, 7, 15, 45] {
            square.rotate_left(start);
            let (outcome, triangles) = cut(&flat(&square));
            assert_eq!(outcome, Outcome::Exact);
            check(&square, &triangles);
        }
        let triangle = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 3.0]];
        check(&triangle, &cut(&flat(&triangle)).1);
    }

    #[test]
    fn polygons_cut_open_to_a_hole_keep_the_hole() {
        let (outcome, triangles) = cut(&flat(&KEYHOLE));
        assert_eq!(outcome, Outcome::Exact);
        let area: f64 = triangles.iter().map(|t| area_of(t.map(|v| KEYHOLE[v as usize]))).sum();
        assert_eq!(area, 12.0);
        assert!(triangles.iter().all(|t| area_of(t.map(|v| KEYHOLE[v as usize])) > 0.0));
    }

    #[test]
    fn repeated_corners_are_dropped_and_zero_areas_refused() {
        let doubled: Vec<_> = L_SHAPE.iter().flat_map(|&c| [c, c, c]).collect();
        let (outcome, triangles) = cut(&flat(&doubled));
        assert_eq!((outcome, triangles.len()), (Outcome::Exact, 4));
        assert_eq!(cut(&flat(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])).1, [[0, 2, 3]]);
        let line = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3], [0.7, 0.7], [0.4, 0.4]];
        for nothing in [&line[..], &[[1.0, 1.0]; 7], &[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [1.0, 0.0]], &[]] {
            assert_eq!(cut(&flat(nothing)), (Outcome::NoArea, vec![]), "{nothing:?}");
        }
        assert_eq!(cut(&vec![[1.0; 3]; MOST_CORNERS + 1]).0, Outcome::TooLarge);
    }

    #[test]
    fn polygons_that_cross_themselves_become_fans() {
        let angle = |i: usize| i as f64 * 0.8 * std::f64::consts::PI;
        let star: Vec<[f64; 2]> = (0..5).map(|i| [angle(i).cos(), angle(i).sin()]).collect();
        assert_eq!(cut(&flat(&star)), (Outcome::Rough, vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]]));
        assert_eq!(
            cut(&[[1e300, 0.0, 0.0], [-1e300, 1.0, 0.0], [0.0, 1e300, 0.0], [5.0; 3]]).0,
            Outcome::Rough
        );
    }

    #[test]
    fn polygons_that_cross_themselves_a_little_are_nearly_right() {
        // A small tangle in a side.
        let mut looped = L_SHAPE.to_vec();
        looped.extend([[0.04, 2.02], [0.01, 2.0], [0.04, 2.04], [0.02, 2.04]]);
        looped.rotate_left(1);
        let (outcome, triangles) = cut(&flat(&looped));
        assert_eq!(outcome, Outcome::Rough);
        let area: f64 = triangles.iter().map(|t| area_of(t.map(|v| looped[v as usize]))).sum();
        assert!((area - signed_area(&looped)).abs() < 0.06, "{area}");
        let fan: f64 = (1..9).map(|v| area_of([looped[0], looped[v], looped[v + 1]]).abs()).sum();
        assert!(fan > 7.0, "a fan would be far off");
    }

    #[test]
    fn large_polygons_take_no_long() {
        // A spiral corridor of 20,000 corners, and a star of as many.
        let spiral = |inner: bool| {
            let half = (0..10_000).map(move |i| {
                let (angle, radius) = (f64::from(i) * 0.05, f64::from(i) + if inner { 0.0 } else { 40.0 });
                [radius * angle.cos(), radius * angle.sin()]
            });
            half.collect::<Vec<_>>()
        };
        let mut corridor = spiral(false);
        corridor.extend(spiral(true).into_iter().rev());
        let star: Vec<[f64; 2]> = (0..20_000)
            .map(|i| {
                let (angle, radius) =
                    (f64::from(i) * std::f64::consts::TAU / 2e4, 1.0 + f64::from(i % 2) * 0.3);
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        for polygon in [corridor, star] {
            let (outcome, triangles) = cut(&flat(&polygon));
            assert_eq!(outcome, Outcome::Exact);
            assert_eq!(triangles.len(), polygon.len() - 2);
        }
        // And one that crosses itself everywhere.
        let tangle: Vec<[f64; 2]> =
            (0..20_000u64).map(|i| [i * 7919 % 10_007, i * 104_729 % 9973].map(|v| v as f64)).collect();
        assert_eq!(cut(&flat(&tangle)).0, Outcome::Rough);
    }

    prop_compose! {
        /// A star-shaped polygon around the origin, concave mostly: 4 to 60 corners, radii over a factor of 20.
        fn star_shaped()(count in 4usize..60)(
            radii in prop::collection::vec(0.5f64..10.0, count),
            steps in prop::collection::vec(0.2f64..1.0, count),
            reverse in any::<bool>()
        ) -> Vec<[f64; 2]> {
            let total: f64 = steps.iter().sum();
            let mut at = 0.0;
            let mut corners: Vec<[f64; 2]> = radii.iter().zip(&steps).map(|(radius, step)| {
                at += step / total * std::f64::consts::TAU;
                [radius * at.cos(), radius * at.sin()]
            }).collect();
            if reverse { corners.reverse(); }
            corners
        }
    }

    proptest! {
        #[test]
        fn random_polygons_in_any_plane_are_exact(
            corners in star_shaped(),
            yaw in 0.0f64..6.3,
            pitch in -1.5f64..1.5,
            scale in -3i32..4,
            far in prop::sample::select(vec![0.0, 1e3, 5e6]),
        ) {
            let scale = 10f64.powi(scale);
            let (sy, cy) = yaw.sin_cos();
            let (sp, cp) = pitch.sin_cos();
            let (u, v) = ([cy, sy, 0.0], [-sy * cp, cy * cp, sp]);
            let in_space: Vec<Point> = corners
                .iter()
                .map(|[x, y]| [0, 1, 2].map(|i| far * scale + scale * (x * u[i] + y * v[i])))
                .collect();
            let (outcome, triangles) = cut(&in_space);
            prop_assert_eq!(outcome, Outcome::Exact);
            // Far away the corners are rounded to 1e-9 of their extent: the flat twin is not quite the polygon.
            if far < 1e6 {
                check(&corners, &triangles);
            } else {
                prop_assert_eq!(triangles.len(), corners.len() - 2);
            }
        }

        #[test]
        fn any_corners_at_all_do_no_harm(
            corners in prop::collection::vec(prop::array::uniform3(-3i8..4), 0..30)
        ) {
            let corners: Vec<Point> = corners.iter().map(|c| c.map(f64::from)).collect();
            let (_, triangles) = cut(&corners);
            prop_assert!(triangles.iter().flatten().all(|&v| (v as usize) < corners.len()));
        }
    }
}
