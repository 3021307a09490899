//! Triangles in cells: rasterised, with depth, into the region of the picture whose rays are in the cell.
//!
//! In the camera's own coordinates, in which the ray through column `x` and row `y` is `(x, y, 1)`, the plane through the eye and an edge is the cross product
//! of its ends: a line of the picture, of equal size and opposite sign on the other side. A triangle is where three of them are positive, so that
//! nothing is clipped, not even behind the eye; and `1 / t` is linear.

use glam::{DMat3, DVec3, Vec3};

use super::kernels::{Bound, Deep};
use super::outer::{Group, Outer};
use super::rows::{Arena, Region};
use super::screen::{Plane, Screen};
use crate::format::Views;
use crate::format::records::{BlockRecord, LANES, Leaf, NodeRecord};
use crate::trace::NONE;

/// Boxes are this much larger, metres: what f32 rounds.
const SLACK: f32 = 1e-3;

/// A corner that is this much farther outside of a cell, metres, is outside.
const OUTSIDE: f64 = 1e-6;

/// What rounding may do to where a corner is in the picture, pixels.
const ROUNDED: f64 = 1e-6;

/// A corner nearer than this in front of the eye, in units of the ray, has no place in the picture.
const FRONT: f64 = 1e-6;

/// The triangles of a scene as a picture sees them.
pub(crate) struct Detail<'a> {
    tables: &'a Views,
    /// Along the internal frame's axes.
    pub(super) screen: Screen,
    /// From a point relative to the eye to the camera's coordinates.
    camera: DMat3,
    /// The eye relative to the scene's center.
    eye: Vec3,
    stack: Vec<u32>,
}

/// A triangle, ready to be drawn.
pub(crate) struct Drawn {
    pub(super) triangle: u32,
    /// The rows that it may reach.
    pub(super) rows: [i32; 2],
    /// Along the internal frame's axes, unit length.
    pub(super) normal: DVec3,
    pub(super) deep: Deep,
}

impl Drawn {
    /// Of nothing yet.
    fn new() -> Drawn {
        let deep = Deep { bounds: [Bound::NONE; Deep::BOUNDS], count: 0, near: [0.0; 3] };
        Drawn { triangle: u32::MAX, rows: [0; 2], normal: DVec3::ZERO, deep }
    }
}

impl<'a> Detail<'a> {
    pub(crate) fn new(tables: &'a Views, screen: Screen) -> Detail<'a> {
        let camera = DMat3::from_cols(screen.across, screen.down, screen.first).inverse();
        let eye = (screen.eye - DVec3::from(tables.scene[0].center)).as_vec3();
        Detail { tables, screen, camera, eye, stack: Vec::new() }
    }

    /// Gives `draw` all triangles below `root` that may show in a region, as far as they are within the planes through which the region's rays leave.
    pub(super) fn draw(&mut self, region: &Region, root: u32, exits: &[Plane], mut draw: impl FnMut(&Drawn)) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        self.stack.clear();
        // A scene may have no triangles at all.
        self.stack.extend((root != NONE).then_some(root));
        while let Some(link) = self.stack.pop() {
            if link & Leaf::BIT == 0 {
                let node = &self.tables.nodes[link as usize];
                let seen = reaches(node, self.eye, &frustum);
                self.push_nearest_last(node, seen);
                continue;
            }
            let leaf = Leaf::new(link);
            let block = &self.tables.blocks[leaf.block()];
            // Triangles that rays are not to meet are no numbers: they reach nowhere.
            let mut seen = leaf.mask() & triangles_reach(block, self.eye, &frustum);
            while seen != 0 {
                let lane = seen.trailing_zeros() as usize;
                seen &= seen - 1;
                if self.triangle(block.triangle[lane], region, exits, &mut drawn) {
                    draw(&drawn);
                }
            }
        }
    }

    /// Puts those children of a node that are seen on the stack, so that the nearest comes first: it hides others.
    fn push_nearest_last(&mut self, node: &NodeRecord, mut seen: u32) {
        let mut away = [0.0f32; LANES];
        for axis in 0..3 {
            let eye = self.eye[axis];
            for lane in 0..LANES {
                let out = (node.lo[axis][lane] - eye).max(eye - node.hi[axis][lane]).max(0.0);
                away[lane] += out * out;
            }
        }
        let bottom = self.stack.len();
        let mut order = [0.0f32; LANES];
        while seen != 0 {
            let lane = seen.trailing_zeros() as usize;
            seen &= seen - 1;
            if node.child[lane] == u32::MAX {
                continue;
            }
            let mut at = self.stack.len() - bottom;
            self.stack.push(node.child[lane]);
            while at > 0 && order[at - 1] < away[lane] {
                order[at] = order[at - 1];
                self.stack.swap(bottom + at, bottom + at - 1);
                at -= 1;
            }
            order[at] = away[lane];
        }
    }

    /// The same of what lies around the prisms.
    pub(super) fn draw_outer(
        &self,
        region: &Region,
        outer: &Outer,
        exits: &[Plane],
        mut draw: impl FnMut(&Drawn),
    ) {
        let (frustum, mut drawn) = (self.frustum(region), Drawn::new());
        let is_seen = |group: &&Group| {
            frustum.iter().all(|normal| {
                let far = Vec3::select(normal.cmpgt(Vec3::ZERO), group.hi, group.lo);
                normal.dot(far - self.eye) >= -SLACK
            })
        };
        for group in outer.0.iter().filter(is_seen) {
            for &triangle in &group.triangles {
                if self.triangle(triangle, region, exits, &mut drawn) {
                    draw(&drawn);
                }
            }
        }
    }

    /// Gives `draw` those of some triangles that may show in a region.
    pub(super) fn draw_listed(&self, region: &Region, triangles: &[u32], mut draw: impl FnMut(&Drawn)) {
        let mut drawn = Drawn::new();
        for &triangle in triangles {
            if self.triangle(triangle, region, &[], &mut drawn) {
                draw(&drawn);
            }
        }
    }

    /// The planes through the eye and the borders of a region's box, inward.
    fn frustum(&self, region: &Region) -> [Vec3; 4] {
        let Screen { first, across, down, .. } = self.screen;
        let ([x0, x1], [y0, y1]) = (region.columns.map(f64::from), region.rows.map(f64::from));
        let inward = |along: DVec3, at: DVec3, toward: DVec3| {
            let normal = along.cross(at).normalize_or_zero();
            if normal.dot(toward) < 0.0 { -normal } else { normal }.as_vec3()
        };
        [
            inward(down, first + across * (x0 - 0.5), across),
            inward(down, first + across * (x1 - 0.5), -across),
            inward(across, first + down * (y0 - 0.5), down),
            inward(across, first + down * (y1 - 0.5), -down),
        ]
    }

    /// Makes a triangle ready to be drawn, unless nothing of it is seen in the region.
    fn triangle(&self, triangle: u32, region: &Region, exits: &[Plane], drawn: &mut Drawn) -> bool {
        let corners = self.tables.triangles[triangle as usize];
        let world = corners.map(|v| DVec3::from(self.tables.vertices[v as usize]) - self.screen.eye);
        let [a, b, c] = world.map(|v| self.camera * v);
        let mut rows = region.rows;
        if a.z > FRONT && b.z > FRONT && c.z > FRONT {
            let [inverse_a, inverse_b, inverse_c] = [a, b, c].map(|v| 1.0 / v.z);
            let [ya, yb, yc] = [a.y * inverse_a, b.y * inverse_b, c.y * inverse_c];
            rows[0] = rows[0].max(up(ya.min(yb).min(yc) - ROUNDED));
            rows[1] = rows[1].min(up(ya.max(yb).max(yc) + ROUNDED));
            let [xa, xb, xc] = [a.x * inverse_a, b.x * inverse_b, c.x * inverse_c];
            let columns = [up(xa.min(xb).min(xc) - ROUNDED), up(xa.max(xb).max(xc) + ROUNDED)];
            if rows[0] >= rows[1]
                || columns[0] >= columns[1]
                || columns[0] >= region.columns[1]
                || columns[1] <= region.columns[0]
            {
                return false;
            }
        } else if a.z <= 0.0 && b.z <= 0.0 && c.z <= 0.0 {
            return false;
        }
        let sides = [b.cross(c), c.cross(a), a.cross(b)];
        let size = a.dot(sides[0]);
        if size == 0.0 {
            return false;
        }
        let sign = size.signum();
        let near = (sides[0] + sides[1] + sides[2]) / size;
        let bounds = &mut drawn.deep.bounds;
        for (bound, side) in bounds.iter_mut().zip(sides) {
            *bound = Bound::new(side * sign, &mut rows);
        }
        let mut count = 3;
        for exit in exits.iter().filter(|exit| exit.is_exit()) {
            let grows = DVec3::from(exit.grows);
            let limit = OUTSIDE * exit.size;
            if [a, b, c].iter().any(|&v| exit.away + grows.dot(v) > limit) {
                if count == Deep::BOUNDS {
                    break;
                }
                bounds[count] = Bound::new(near + grows / exit.away, &mut rows);
                count += 1;
            }
        }
        if rows[0] >= rows[1] {
            return false;
        }
        drawn.triangle = triangle;
        drawn.rows = rows;
        drawn.normal = (world[1] - world[0]).cross(world[2] - world[0]).normalize_or_zero();
        drawn.deep.count = count;
        drawn.deep.near = near.to_array();
        true
    }
}

/// Rounded up; what cannot be told is held within what numbers there are.
#[inline(always)]
fn up(x: f64) -> i32 {
    let down = x as i32;
    down.saturating_add(i32::from(f64::from(down) < x))
}

/// The triangles of a block that reach into all of the half-spaces, triangle i as bit i.
#[inline(always)]
fn triangles_reach(block: &BlockRecord, eye: Vec3, frustum: &[Vec3; 4]) -> u32 {
    let mut inside = [true; LANES];
    for normal in frustum {
        let limit = normal.dot(eye) - SLACK;
        for lane in 0..LANES {
            let along = |of: &[[f32; LANES]; 3]| {
                normal.x * of[0][lane] + normal.y * of[1][lane] + normal.z * of[2][lane]
            };
            let most = along(&block.edge1).max(along(&block.edge2)).max(0.0);
            inside[lane] &= along(&block.corner) + most >= limit;
        }
    }
    (0..LANES).fold(0, |bits, lane| bits | u32::from(inside[lane]) << lane)
}

/// The children of a node that reach into all of the half-spaces, child i as bit i.
#[inline(always)]
fn reaches(node: &NodeRecord, eye: Vec3, frustum: &[Vec3; 4]) -> u32 {
    let mut inside = [true; LANES];
    for normal in frustum {
        let limit = normal.dot(eye) - SLACK;
        for lane in 0..LANES {
            let mut far = 0.0;
            for axis in 0..3 {
                let n = normal[axis];
                far += if n > 0.0 { n * node.hi[axis][lane] } else { n * node.lo[axis][lane] };
            }
            inside[lane] &= far >= limit;
        }
    }
    (0..LANES).fold(0, |bits, lane| bits | u32::from(inside[lane]) << lane)
}

/// The borders of those rows of a region that `rows` holds, and more.
pub(super) fn borders_of<'a>(arena: &'a Arena, region: &Region, rows: [i32; 2]) -> [&'a [i32]; 2] {
    arena.borders_and_more(&region.within(rows))
}
