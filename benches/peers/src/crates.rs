//! Peers from crates.io.

use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::BHShape;
use glam::Vec3A;
use nalgebra::{Point3, Vector3};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

use crate::way::{Met, Rays, Single, Way};

enum Hierarchy {
    Binary(Bvh2),
    Wide(CwBvh),
}

/// `obvhs`: its binary or its compressed eight-wide hierarchy.
pub struct Obvhs {
    name: &'static str,
    hierarchy: Hierarchy,
    /// In the hierarchy's order, so that its leaves need no look-up.
    triangles: Vec<Triangle>,
}

/// Both hierarchies of `obvhs`, by the slowest build that it recommends for moderate scenes.
pub fn obvhs(soup: &[[[f32; 3]; 3]]) -> [Obvhs; 2] {
    let triangles: Vec<Triangle> =
        soup.iter().map(|t| t.map(Vec3A::from)).map(|[v0, v1, v2]| Triangle { v0, v1, v2 }).collect();
    let ordered =
        |order: &[u32]| order.iter().map(|&index| triangles[index as usize]).collect::<Vec<Triangle>>();
    let mut time = std::time::Duration::default();
    let binary = build_bvh2_from_tris(&triangles, BvhBuildParams::medium_build(), &mut time);
    let wide = build_cwbvh_from_tris(&triangles, BvhBuildParams::medium_build(), &mut time);
    [
        Obvhs {
            name: "obvhs, Bvh2",
            triangles: ordered(&binary.primitive_indices),
            hierarchy: Hierarchy::Binary(binary),
        },
        Obvhs {
            name: "obvhs, CwBvh",
            triangles: ordered(&wide.primitive_indices),
            hierarchy: Hierarchy::Wide(wide),
        },
    ]
}

impl Way for Obvhs {
    fn name(&self) -> String {
        self.name.to_owned()
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        for (single, met) in rays.singles.iter().zip(met) {
            let &Single { origin, tmin, direction, tmax } = single;
            let ray = Ray::new(origin.into(), direction.into(), tmin, tmax.min(f32::MAX));
            let mut found = RayHit::none();
            let hit = |ray: &Ray, place: usize| self.triangles[place].intersect(ray);
            let (is_hit, order) = match &self.hierarchy {
                Hierarchy::Binary(bvh) => (bvh.ray_traverse(ray, &mut found, hit), &bvh.primitive_indices),
                Hierarchy::Wide(bvh) => (bvh.ray_traverse(ray, &mut found, hit), &bvh.primitive_indices),
            };
            *met = match order.get(found.primitive_id as usize) {
                Some(&triangle) if is_hit => Met { t: f64::from(found.t), triangle, padding: 0 },
                _ => Met::NOTHING,
            };
        }
    }
}

struct Shape {
    corners: [Point3<f32>; 3],
    triangle: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> Aabb<f32, 3> {
        let [a, b, c] = &self.corners;
        Aabb::empty().grow(a).grow(b).grow(c)
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

/// The crate `bvh`: its iterator from near to far, left once no box is nearer than the hit.
pub struct Bvh {
    bvh: bvh::bvh::Bvh<f32, 3>,
    shapes: Vec<Shape>,
}

impl Bvh {
    pub fn new(soup: &[[[f32; 3]; 3]]) -> Bvh {
        let shape = |(corners, triangle): (&[[f32; 3]; 3], u32)| Shape {
            corners: corners.map(Point3::from),
            triangle,
            node: 0,
        };
        let mut shapes: Vec<Shape> = soup.iter().zip(0..).map(shape).collect();
        Bvh { bvh: bvh::bvh::Bvh::build(&mut shapes), shapes }
    }
}

impl Way for Bvh {
    fn name(&self) -> String {
        "bvh".to_owned()
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        for (single, met) in rays.singles.iter().zip(met) {
            let ray = bvh::ray::Ray::new(single.origin.into(), Vector3::from(single.direction));
            *met = Met::NOTHING;
            for shape in self.bvh.nearest_traverse_iterator(&ray, &self.shapes) {
                let near = ray.intersection_slice_for_aabb(&shape.aabb());
                if near.is_some_and(|(near, _)| f64::from(near) > met.t) {
                    break;
                }
                let [a, b, c] = &shape.corners;
                // The crate culls triangles from behind: both ways round.
                for t in [ray.intersects_triangle(a, b, c), ray.intersects_triangle(a, c, b)] {
                    let t = t.distance;
                    if t >= single.tmin && t <= single.tmax && f64::from(t) < met.t {
                        *met = Met { t: f64::from(t), triangle: shape.triangle, padding: 0 };
                    }
                }
            }
        }
    }
}
