//! Ways to answer rays, side by side: enfilade's kernels, its batches, and the library that builds the hierarchy of boxes,
//! by itself, on the same triangles.

use std::sync::Arc;

use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as SingleRay, RayHit};
use obvhs::triangle::Triangle;

use crate::scene::Scene;
use crate::trace::{Hit, Kernel, NONE, Place, Ray, Start, Want};

/// A way to answer rays that start in the air.
pub struct Tracer {
    name: String,
    way: Way,
}

enum Way {
    Kernel(Kernel, Arc<Scene>),
    Batch(Arc<Scene>),
    Bvh2(Bvh2, Rounded),
    CwBvh(CwBvh, Rounded),
}

/// The scene's triangles in f32, relative to the middle of the hull.
struct Rounded {
    scene: Arc<Scene>,
    center: DVec3,
    triangles: Vec<Triangle>,
}

impl Rounded {
    fn new(scene: &Arc<Scene>) -> Rounded {
        let center = DVec3::from(scene.tables.scene[0].center);
        let triangles = (0..scene.detail_triangle_count()).map(|t| {
            let [v0, v1, v2] = scene.triangle(t).map(|p| (DVec3::from(p) - center).as_vec3a());
            Triangle { v0, v1, v2 }
        });
        Rounded { scene: Arc::clone(scene), center, triangles: triangles.collect() }
    }

    #[inline]
    fn ray(&self, ray: &Ray) -> SingleRay {
        let origin = (DVec3::from(ray.origin) - self.center).as_vec3a();
        let direction = DVec3::from(ray.direction).normalize().as_vec3a();
        SingleRay::new(origin, direction, ray.tmin as f32, ray.tmax.min(f64::from(f32::MAX)) as f32)
    }

    /// What each ray meets first, by the crate's own `traverse`; `order` leads from its primitives to ours.
    #[inline]
    fn trace(
        &self,
        rays: &[Ray],
        hits: &mut [Hit],
        order: &[u32],
        traverse: impl Fn(SingleRay, &mut RayHit) -> bool,
    ) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut found = RayHit::none();
            let is_hit = traverse(self.ray(ray), &mut found);
            if is_hit {
                found.primitive_id = order[found.primitive_id as usize];
            }
            *hit = self.record(found, is_hit && found.primitive_id != NONE);
        }
    }

    /// The hit as a record, as far as the crate gives it.
    #[inline]
    fn record(&self, hit: RayHit, is_hit: bool) -> Hit {
        if !is_hit {
            return Hit::ESCAPED;
        }
        let element = self.scene.tables.record(hit.primitive_id).element;
        Hit { t: f64::from(hit.t), element, triangle: hit.primitive_id, ..Hit::ESCAPED }
    }
}

/// The names of all ways that this machine has.
pub fn names() -> Vec<String> {
    let kernels = Kernel::available().into_iter().map(|k| format!("enfilade-{}", k.name()));
    kernels.chain(["enfilade-batch", "obvhs-bvh2", "obvhs-cwbvh"].map(str::to_owned)).collect()
}

impl Tracer {
    /// The way of this name, over the triangles of `scene`.
    pub fn by_name(name: &str, scene: &Arc<Scene>) -> Option<Tracer> {
        let way = if name == "enfilade-batch" {
            Way::Batch(Arc::clone(scene))
        } else if let Some(kernel) = name.strip_prefix("enfilade-") {
            Way::Kernel(Kernel::by_name(kernel)?, Arc::clone(scene))
        } else {
            let rounded = Rounded::new(scene);
            if rounded.triangles.is_empty() {
                return None;
            }
            let params = BvhBuildParams::medium_build();
            let mut time = std::time::Duration::default();
            match name {
                "obvhs-bvh2" => {
                    Way::Bvh2(build_bvh2_from_tris(&rounded.triangles, params, &mut time), rounded)
                }
                "obvhs-cwbvh" => {
                    Way::CwBvh(build_cwbvh_from_tris(&rounded.triangles, params, &mut time), rounded)
                }
                _ => return None,
            }
        };
        Some(Tracer { name: name.to_owned(), way })
    }

    /// Whether it has its own ways to share rays among threads.
    pub(super) fn is_batch(&self) -> bool {
        matches!(self.way, Way::Batch(_))
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What each ray meets first: distance and triangle, nothing else for sure.
    pub fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        match &self.way {
            Way::Kernel(kernel, scene) => {
                // As a caller would who knows that rays start where the last one did.
                let (mut origin, mut start) = ([f64::NAN; 3], Start::Anywhere);
                for (ray, hit) in rays.iter().zip(hits) {
                    if ray.origin != origin {
                        origin = ray.origin;
                        start = match scene.locate(origin) {
                            Place::Air { cell, .. } => Start::Cell(cell),
                            _ => Start::Anywhere,
                        };
                    }
                    *hit = scene.trace_with(*kernel, start, ray, Want::LEAST);
                }
            }
            Way::Batch(scene) => scene.trace_many(rays, hits, Want::LEAST),
            Way::Bvh2(bvh, rounded) => rounded.trace(rays, hits, &bvh.primitive_indices, |ray, found| {
                bvh.ray_traverse(ray, found, |ray, place| {
                    rounded.triangles[bvh.primitive_indices[place] as usize].intersect(ray)
                })
            }),
            Way::CwBvh(bvh, rounded) => rounded.trace(rays, hits, &bvh.primitive_indices, |ray, found| {
                bvh.ray_traverse(ray, found, |ray, place| {
                    rounded.triangles[bvh.primitive_indices[place] as usize].intersect(ray)
                })
            }),
        }
    }
}
