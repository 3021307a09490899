//! The closed shells of a mesh, and what lies inside them, as [`crate::shells`] defines it.
//!
//! Winding numbers are found by how often an oblique line from the point to infinity leaves the shell less how often it enters; where it passes an edge
//! closely, by adding up the solid angles of triangles (Van Oosterom and Strackee, 1983). The parity is found by how
//! often a line from the point to infinity pierces the shell, by the majority of three oblique lines that meet no edge.

use enfilade_importers::Mesh;

use super::triangle::{Corners, Line, Size, closest_point, pierce, sides};
use super::vector::{Bounds, cross, distance, dot, length, max_abs, sub};
use crate::components::components;
use crate::shells::{Inside, shells};
use crate::trace::Ray;

/// Directions for the parity, oblique to all that is built.
const OBLIQUE: [[f64; 3]; 9] = [
    [0.539_21, 0.623_57, 0.565_91],
    [-0.677_31, 0.412_77, 0.609_13],
    [0.318_19, -0.741_53, 0.590_67],
    [-0.452_97, -0.571_33, 0.684_41],
    [0.831_07, 0.237_91, -0.502_73],
    [-0.291_71, 0.823_49, -0.486_53],
    [0.613_57, -0.347_83, -0.708_91],
    [-0.719_39, -0.266_51, -0.641_47],
    [0.173_29, 0.386_17, 0.906_01],
];

/// The two axes across [`OBLIQUE`]'s first line: neither of unit length, nor at right angles to each other.
const SHADE: [[f64; 3]; 2] = [[OBLIQUE[0][2], 0.0, -OBLIQUE[0][0]], [0.0, OBLIQUE[0][2], -OBLIQUE[0][1]]];

/// Times the largest coordinate: what moves shadows at most, and much more. They are rounded twice, by an epsilon each; and the line that is followed is
/// the normalised one, off by half an epsilon for each axis, which over twice the largest coordinate moves its shadow by as many more.
const SHADOW_ERROR: f64 = 64.0 * f64::EPSILON;

/// Where a point's shadow is.
fn shadow(p: [f64; 3]) -> [f64; 2] {
    SHADE.map(|axis| dot(axis, p))
}

/// The box around a triangle's shadow: the least and the greatest along each axis.
fn shadow_of(corners: &Corners, error: f64) -> [[f64; 2]; 2] {
    let points = corners.map(shadow);
    [0, 1].map(|i| {
        let [a, b, c] = points.map(|p| p[i]);
        [a.min(b).min(c) - error, a.max(b).max(c) + error]
    })
}

/// What [`SHADE`] leaves of each triangle on the plane across it, and a little more; in strips, by where along the first axis it lies.
#[derive(Clone, Debug)]
struct Shadows {
    of: Vec<[[f64; 2]; 2]>,
    strips: Vec<Vec<u32>>,
    /// Where along the first axis they begin.
    first: f64,
    /// Strips for each unit of it.
    per: f64,
}

impl Shadows {
    /// Of the triangles within those bounds, as the points are whose lines are asked for.
    fn of(triangles: &[Corners], bounds: Bounds) -> Shadows {
        /// Triangles for each strip, and strips that each may lie in, taken together.
        const SHARE: usize = 8;
        let error = 2.0 * SHADOW_ERROR * max_abs(bounds.lo).max(max_abs(bounds.hi));
        let of: Vec<_> = triangles.iter().map(|corners| shadow_of(corners, error)).collect();
        let first = of.iter().fold(f64::INFINITY, |first, [[least, _], _]| first.min(*least));
        let last = of.iter().fold(f64::NEG_INFINITY, |last, [[_, most], _]| last.max(*most));
        let mut count = triangles.len().div_ceil(SHARE).max(1);
        loop {
            let mut shadows = Shadows {
                of: Vec::new(),
                strips: vec![Vec::new(); count],
                first,
                per: count as f64 / (last - first),
            };
            let covered = of.iter().map(|[[least, most], _]| shadows.strip(*least)..=shadows.strip(*most));
            let total: usize = covered.clone().map(|strips| strips.count()).sum();
            if total > SHARE * of.len() && count > 1 {
                count = count.div_ceil(2);
                continue;
            }
            let covered: Vec<_> = covered.collect();
            for (index, strips) in (0..).zip(covered) {
                strips.for_each(|strip| shadows.strips[strip].push(index));
            }
            shadows.of = of;
            return shadows;
        }
    }

    /// The strip of a place along the first axis, or the one nearest to it.
    fn strip(&self, u: f64) -> usize {
        // What is negative or no number becomes 0.
        (((u - self.first) * self.per) as usize).min(self.strips.len() - 1)
    }

    /// Triangles that a line through that shadow may pierce or touch; of those that it passes by as much as roundings move it, all.
    fn over(&self, at: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let is_over = move |index: &usize| {
            let [u, v] = self.of[*index];
            at[0] >= u[0] && at[0] <= u[1] && at[1] >= v[0] && at[1] <= v[1]
        };
        self.strips[self.strip(at[0])].iter().map(|&index| index as usize).filter(is_over)
    }
}

/// Lines that must agree by majority.
const VOTES: u32 = 3;

/// One shell of a mesh, turned as [`crate::shells`] has it.
#[derive(Clone, Debug)]
pub(crate) struct Shell {
    triangles: Vec<Corners>,
    shadows: Shadows,
    bounds: Bounds,
    inside: Inside,
}

/// The closed shells of one element.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    shells: Vec<Shell>,
    pub(crate) bounds: Bounds,
}

impl Body {
    /// `None` if no component is closed.
    pub(crate) fn of(mesh: &Mesh) -> Option<Body> {
        let closed: Vec<_> = components(mesh).into_iter().filter(|component| component.closed).collect();
        let shells = closed.iter().flat_map(|component| shells(mesh, component)).map(|shell| {
            let corners = |t: [u32; 3]| t.map(|v| mesh.positions[v as usize]);
            let triangles: Vec<Corners> = shell.corners(mesh).map(corners).collect();
            let bounds = triangles.iter().fold(Bounds::EMPTY, |bounds, t| bounds.union(Bounds::of(t)));
            let shadows = Shadows::of(&triangles, bounds);
            Shell { triangles, shadows, bounds, inside: shell.inside }
        });
        let shells: Vec<Shell> = shells.collect();
        let bounds = shells.iter().fold(Bounds::EMPTY, |bounds, shell| bounds.union(shell.bounds));
        (!shells.is_empty()).then_some(Body { shells, bounds })
    }

    /// Whether `p` is inside. Close to the surface, within some roundings, either may be said.
    pub(crate) fn contains(&self, p: [f64; 3]) -> bool {
        if !self.bounds.contains(p) {
            return false;
        }
        let mut together = 0;
        for shell in self.shells.iter().filter(|shell| shell.bounds.contains(p)) {
            match shell.inside {
                Inside::Together => together += shell.winding(p),
                Inside::ByWinding if shell.winding(p) != 0 => return true,
                Inside::ByParity if shell.is_odd(p) => return true,
                Inside::ByWinding | Inside::ByParity => {}
            }
        }
        together != 0
    }

    /// The points of the surface's triangles that are nearest to `p`, for each triangle within `limit` of it: point,
    /// and the triangle's normal, of no particular length.
    pub(crate) fn surface_near(&self, p: [f64; 3], limit: f64) -> Vec<([f64; 3], [f64; 3])> {
        let near = |bounds: &Bounds| bounds.distance(p) <= limit;
        let mut found = Vec::new();
        if near(&self.bounds) {
            for shell in self.shells.iter().filter(|shell| near(&shell.bounds)) {
                for corners in &shell.triangles {
                    let [a, b, c] = *corners;
                    let outside = (0..3).any(|i| {
                        a[i].min(b[i]).min(c[i]) > p[i] + limit || a[i].max(b[i]).max(c[i]) < p[i] - limit
                    });
                    if !outside {
                        let q = closest_point(corners, p);
                        if distance(p, q) <= limit {
                            found.push((q, cross(sub(b, a), sub(c, a))));
                        }
                    }
                }
            }
        }
        found
    }
}

impl Shell {
    /// How often the shell goes around `p`, which is within its bounds; for shells whose triangles agree.
    fn winding(&self, p: [f64; 3]) -> i64 {
        self.winding_by_crossings(p).unwrap_or_else(|| self.winding_by_angles(p))
    }

    /// The same, if a line to infinity passes no edge closely; on the surface, of what is just ahead along that line.
    fn winding_by_crossings(&self, p: [f64; 3]) -> Option<i64> {
        if !self.bounds.contains(p) {
            return Some(0);
        }
        let line = Line::new(&Ray::new(p, OBLIQUE[0]))?;
        let mut turns = 0;
        for index in self.shadows.over(shadow(p)) {
            let corners = &self.triangles[index];
            let (sides, size) = (sides(&line, corners), Size::of(corners));
            let error = size.side_error(line.reach);
            let (is_left, is_right) =
                (sides.iter().all(|&side| side > error), sides.iter().all(|&side| side < -error));
            if is_left || is_right {
                // On the surface itself: what it enters or leaves there it is past.
                turns += if pierce(&line, corners, size)? <= 0.0 {
                    0
                } else if is_left {
                    1
                } else {
                    -1
                };
            } else if !(sides.iter().any(|&side| side > error) && sides.iter().any(|&side| side < -error)) {
                return None;
            }
        }
        Some(turns)
    }

    /// The same, wherever `p` is.
    fn winding_by_angles(&self, p: [f64; 3]) -> i64 {
        // The solid angle of a triangle is twice the argument of a complex number. Instead of adding the arguments,
        // multiply the numbers, and count how often the product's argument passes from pi to -pi or back. That takes
        // no function whose last bits differ from one machine to the next.
        let (mut re, mut im) = (1.0f64, 0.0f64);
        let mut turns = 0i64;
        for corners in &self.triangles {
            let [a, b, c] = corners.map(|corner| sub(corner, p));
            let (la, lb, lc) = (length(a), length(b), length(c));
            let y = dot(a, cross(b, c));
            let x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
            let size = x.abs().max(y.abs());
            if size == 0.0 || !size.is_finite() {
                // On a corner.
                continue;
            }
            let (x, y) = (x / size, y / size);
            let (new_re, new_im) = (re * x - im * y, re * y + im * x);
            let up = im >= 0.0 && y >= 0.0 && new_im < 0.0;
            let down = im < 0.0 && y < 0.0 && (new_im > 0.0 || new_im == 0.0 && new_re < 0.0);
            turns += i64::from(up) - i64::from(down);
            let norm = new_re.abs().max(new_im.abs());
            (re, im) = (new_re / norm, new_im / norm);
        }
        // The sum of the halved angles is 2 pi times the winding number, that is `turns` whole turns and a rest that is
        // near zero.
        turns
    }

    /// Whether lines from `p` to infinity pierce the shell an odd number of times, by majority.
    fn is_odd(&self, p: [f64; 3]) -> bool {
        let (mut odd, mut votes) = (0, 0);
        for direction in OBLIQUE {
            if let Some(line) = Line::new(&Ray::new(p, direction))
                && let Some(is_odd) = self.crossings(&line)
            {
                odd += u32::from(is_odd);
                votes += 1;
                if votes == VOTES {
                    break;
                }
            }
        }
        2 * odd > votes
    }

    /// Whether the line leaves through an odd number of triangles; `None` if it meets an edge.
    fn crossings(&self, line: &Line) -> Option<bool> {
        let mut odd = false;
        for corners in &self.triangles {
            let size = Size::of(corners);
            if let Some(t) = pierce(line, corners, size).filter(|&t| t > 0.0) {
                // A line through an edge pierces two triangles at once: too close to call.
                let at = line.at(t);
                let slack = 1e-12 * (size.reach + line.reach);
                let touches = (0..3).any(|i| {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    length(cross(sub(b, a), sub(at, a))) <= slack * length(sub(b, a))
                });
                if touches {
                    return None;
                }
                odd = !odd;
            }
        }
        Some(odd)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::fixtures::{Shape, model};
    use enfilade_importers::Semantic;
    use proptest::prelude::*;

    fn body(shape: Shape) -> Option<Body> {
        Body::of(&model(&[(Semantic::Wall, shape)]).elements[0].mesh)
    }

    fn unit() -> Shape {
        Shape::cuboid([0.0; 3], [1.0; 3])
    }

    fn inner() -> Shape {
        Shape::cuboid([0.25; 3], [0.75; 3])
    }

    const MIDDLE: [f64; 3] = [0.5; 3];
    const RIND: [f64; 3] = [0.1, 0.4, 0.6];
    const OUT: [f64; 3] = [1.2, 0.5, 0.5];

    #[test]
    fn boxes_of_all_kinds() {
        let inside = |shape: Shape| {
            let body = body(shape).unwrap();
            [MIDDLE, RIND, OUT].map(|p| body.contains(p))
        };
        assert_eq!(inside(unit()), [true, true, false]);
        assert_eq!(inside(unit().flipped()), [true, true, false], "inside out");
        assert_eq!(inside(unit().and(inner().flipped())), [false, true, false], "a cavity");
        assert_eq!(inside(unit().flipped().and(inner())), [false, true, false], "a cavity, inside out");
        assert_eq!(inside(unit().and(inner())), [true, true, false], "a box in a box");
        assert_eq!(inside(unit().and(unit())), [true, true, false], "doubled");
        assert_eq!(inside(unit().and(unit().flipped())), [false; 3], "membranes without volume");
        for i in 0..12 {
            assert_eq!(inside(unit().with_flipped(i)), [true, true, false], "triangle {i} turned over");
        }
        let badly_wound = unit().with_flipped(3).and(inner().with_flipped(5));
        assert_eq!(inside(badly_wound), [true, true, false], "nothing tells that the inner one is a cavity");
    }

    #[test]
    fn open_components_have_no_inside() {
        let mut open = unit();
        open.0.pop();
        assert!(body(open.clone()).is_none());
        let both = body(open.and(Shape::cuboid([5.0; 3], [6.0; 3]))).unwrap();
        assert!(both.contains([5.5; 3]) && !both.contains(MIDDLE));
        let mut doubled = unit();
        let [a, b, c] = doubled.0[0];
        doubled.0.push([b, c, a]);
        let doubled = body(doubled).unwrap();
        assert!(doubled.contains(MIDDLE) && doubled.shells[0].winding(MIDDLE) == 1, "one triangle twice");
        let mut membrane = unit();
        let across = [[0.0; 3], [1.0; 3], [1.0, 0.0, 0.0]];
        membrane.0.extend([across, [across[1], across[0], across[2]]]);
        assert!(body(membrane).unwrap().contains(MIDDLE));
    }

    #[test]
    fn winding_counts_far_and_near() {
        let many = Shape::prism(4000, 10.0, -5.0, 5.0);
        let body = body(many).unwrap();
        assert_eq!(body.shells[0].inside, Inside::Together);
        for p in [[0.0, 0.0, 4.999_999], [9.99, 0.0, 0.0], [1e-9, -1e-9, -4.999_999_999]] {
            assert_eq!(body.shells[0].winding(p), 1, "{p:?}");
        }
        for p in [[0.0, 0.0, 5.000_001], [10.01, 0.0, 0.0], [1e9, 0.0, 0.0], [0.0, 10.0, 5.1]] {
            assert_eq!(body.shells[0].winding(p), 0, "{p:?}");
        }
        assert_eq!(body.surface_near([0.0, 0.0, 4.9], 0.05).len(), 0);
        assert!(body.surface_near([0.0, 0.0, 4.9], 0.2).len() > 100);
    }

    #[test]
    fn crossings_and_angles_tell_the_same() {
        let body = |shape: Shape| body(shape).unwrap();
        let bodies = [
            body(unit().and(inner().flipped())),
            body(unit().flipped()),
            body(unit().and(unit())),
            body(unit().and(Shape::cuboid([0.5; 3], [1.5; 3]))),
            body(Shape::prism(60, 0.9, 0.1, 0.8)),
        ];
        // Where a national grid puts it.
        const FAR: [f64; 3] = [458_123.4, 5_427_891.7, 112.3];
        let moved = |shape: Shape| {
            Shape(shape.0.into_iter().map(|t| t.map(|p| [0, 1, 2].map(|i| p[i] + FAR[i]))).collect())
        };
        let far = body(moved(Shape::prism(60, 0.9, 0.1, 0.8)));
        let mut random = crate::splitmix::SplitMix64::new(5);
        let (mut told, mut on, mut turns) = (0, 0, [0; 5]);
        for i in 0..4000 {
            let mut p = [0; 3].map(|_| random.between(-0.5, 2.0));
            if i % 4 == 0 {
                // On planes of faces, and near them.
                p[i / 4 % 3] = [0.0, 1.0, 0.25, 0.5][i / 12 % 4]
                    + random.between(-1.0, 1.0) * 10f64.powi(-(i as i32 % 20));
            }
            let there = [0, 1, 2].map(|i| p[i] + FAR[i]);
            if let Some(by_crossings) = far.shells[0].winding_by_crossings(there) {
                assert_eq!(by_crossings, far.shells[0].winding_by_angles(there), "{there:?}");
            }
            for body in &bodies {
                for shell in &body.shells {
                    // On the surface: just ahead.
                    let is_on = !body.surface_near(p, 0.0).is_empty();
                    let at = if is_on { [0, 1, 2].map(|i| p[i] + 1e-9 * OBLIQUE[0][i]) } else { p };
                    on += i32::from(is_on);
                    let by_angles = shell.winding_by_angles(at);
                    turns[(by_angles + 2) as usize] += 1;
                    if let Some(by_crossings) = shell.winding_by_crossings(p) {
                        assert_eq!(by_crossings, by_angles, "{p:?}");
                        told += 1;
                    }
                }
            }
        }
        let all: i32 = turns.iter().sum();
        assert!(told * 20 > all * 19, "{told} of {all}");
        assert!(on > 40, "{on}");
        assert!(turns[1] > 300 && turns[2] > 3000 && turns[3] > 300, "{turns:?}");
    }

    proptest! {
        /// Both ways to tell agree, on a tilted prism and on one seen from any point.
        #[test]
        fn winding_agrees_with_parity(
            sides in 3usize..40,
            tilt in -0.9f64..0.9,
            p in proptest::array::uniform3(-1.5f64..1.5),
        ) {
            let mut shape = Shape::prism(sides, 1.0, -1.0, 1.0);
            for v in shape.0.iter_mut().flatten() {
                v[2] += tilt * v[0];
                v[1] += 0.3 * v[2] * v[2];
            }
            let body = body(shape).unwrap();
            let shell = &body.shells[0];
            prop_assume!(body.surface_near(p, 1e-9).is_empty());
            prop_assert_eq!(shell.winding(p).rem_euclid(2) == 1, shell.is_odd(p));
        }
    }
}
