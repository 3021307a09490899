//! Whether a surface is at the eye.
//!
//! A picture from a surface shows it on one side and what is before it on the other; which pixels show what is told by the last bits of where the eye is, and rays
//! tell by exact arithmetic.

use glam::{DVec3, Vec3};

use super::sight::away;
use super::walk::AROUND;
use crate::format::records::{LANES, Leaf};
use crate::scene::Scene;
use crate::trace::NONE;

/// Whether a triangle that rays meet comes within `margin` of an eye, metres.
pub(super) fn is_touched(scene: &Scene, eye: DVec3, margin: f64) -> bool {
    let (tables, record) = (&scene.tables, &scene.tables.scene[0]);
    let middle = (eye - DVec3::from(record.center)).as_vec3();
    // Boxes hold what f32 rounds of corners, but not of the eye.
    let reach = (margin * 1.01) as f32 + 4.0 * f32::EPSILON * middle.abs().max_element() + record.slack;
    let mut stack: Vec<u32> = Vec::new();
    let root = tables.cells[AROUND as usize].root;
    stack.extend((root != NONE).then_some(root));
    while let Some(link) = stack.pop() {
        if link & Leaf::BIT == 0 {
            let node = &tables.nodes[link as usize];
            let near = away(node, middle);
            let is_near = |lane: &usize| near[*lane] <= reach * reach && node.child[*lane] != u32::MAX;
            stack.extend((0..LANES).filter(is_near).map(|lane| node.child[lane]));
            continue;
        }
        let leaf = Leaf::new(link);
        let block = &tables.blocks[leaf.block()];
        for lane in leaf.lanes() {
            // Triangles that rays are not to meet are no numbers.
            let is_met = !Vec3::from(block.corner.map(|c| c[lane])).is_nan();
            if is_met && distance(corners(scene, block.triangle[lane]), eye) <= margin {
                return true;
            }
        }
    }
    false
}

fn corners(scene: &Scene, triangle: u32) -> [DVec3; 3] {
    scene.tables.triangles[triangle as usize].map(|v| DVec3::from(scene.tables.vertices[v as usize]))
}

/// How far a point is from a triangle: from one of its sides, or along the perpendicular if its foot lies within. The truth's own
/// (`oracle::triangle`) is not in a library without the compiler.
fn distance(corners: [DVec3; 3], point: DVec3) -> f64 {
    let from = corners.map(|corner| corner - point);
    let ways = [0, 1, 2].map(|i| corners[(i + 1) % 3] - corners[i]);
    let normal = ways[0].cross(ways[1]);
    let mut least = f64::INFINITY;
    for i in 0..3 {
        let length = ways[i].length_squared();
        let share = if length > 0.0 { (-from[i].dot(ways[i]) / length).clamp(0.0, 1.0) } else { 0.0 };
        least = least.min((from[i] + ways[i] * share).length());
    }
    // Inside of the three upright planes over its sides.
    let is_over = (0..3).all(|i| normal.dot(from[i].cross(ways[i])) >= 0.0);
    let height = normal.dot(from[0]).abs() / normal.length();
    if is_over && height < least { height } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_from_a_triangle() {
        let corners = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        let of = |x: f64, y: f64, z: f64| distance(corners, DVec3::new(x, y, z));
        assert_eq!(of(1.0, 1.0, 0.5), 0.5);
        assert_eq!(of(1.0, 1.0, -0.5), 0.5);
        assert_eq!(of(2.0, 2.0, 0.0), 0.0);
        assert_eq!(of(-3.0, -4.0, 0.0), 5.0);
        assert_eq!(of(1.0, -0.25, 0.0), 0.25);
        assert_eq!(of(3.0, 3.0, 0.0), 2f64.sqrt());
        assert_eq!(of(7.0, 0.0, 4.0), 5.0);
        // A needle, and a point.
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(distance(line, DVec3::new(0.5, 0.0, 2.0)), 2.0);
        assert_eq!(distance([DVec3::X; 3], DVec3::ZERO), 1.0);
    }
}
