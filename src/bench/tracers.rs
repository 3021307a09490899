//! Ways to answer rays, side by side: enfilade's kernels, its batches, and the library that builds the hierarchy of boxes,
//! by itself, on the same triangles; of a model, also scenes compiled otherwise, rays in f32, and the truth in f64.

use std::borrow::Borrow;
use std::sync::{Arc, Mutex, PoisonError};

use enfilade_importers::{Model, Untagged};
use glam::DVec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as SingleRay, RayHit};
use obvhs::triangle::Triangle;

use super::way::{Answered, Way};
use crate::beam::Beams;
use crate::compile::{CompileError, CompileOptions, compile};
use crate::oracle::Truth;
use crate::packets::Packets;
use crate::partition::Convexification;
use crate::render::{Camera, PictureWay};
use crate::scene::Scene;
use crate::trace::{Hit, Kernel, NONE, Place, Ray, Start, Starts, Want};

/// A way to answer rays that start in the air.
pub struct Tracer {
    name: String,
    kind: Kind,
}

enum Kind {
    Kernel(Kernel, Arc<Scene>),
    /// The same of rays that were rounded to f32.
    Narrow(Kernel, Arc<Scene>),
    Batch(Arc<Scene>),
    /// Whole pictures; of rays by themselves a batch.
    Pictures(Arc<Scene>, Mutex<Painter>),
    Truth(Arc<Truth>),
    Bvh2(Bvh2, Rounded),
    CwBvh(CwBvh, Rounded),
}

/// What makes pictures, and a picture that is painted again and again.
struct Painter {
    maker: Maker,
    pixels: Vec<u32>,
    hits: Vec<Hit>,
}

/// What makes pictures.
enum Maker {
    Beams(Box<Beams<Arc<Scene>>>),
    Packets(Box<Packets<Arc<Scene>>>),
    /// Beams, and what each pixel shows as its ray would tell it, held against rays on edges.
    Hits(Box<Beams<Arc<Scene>>>),
    /// Beams or rays, as [`PictureWay::of`] has it.
    Chosen(Box<Beams<Arc<Scene>>>),
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
        let element = self.scene.triangle_element(hit.primitive_id);
        Hit { t: f64::from(hit.t), element, triangle: hit.primitive_id, ..Hit::ESCAPED }
    }
}

/// The names of all ways that this machine has.
pub fn names() -> Vec<String> {
    let kernels = |prefix: &'static str| {
        Kernel::available().into_iter().map(move |kernel| format!("{prefix}{}", kernel.name()))
    };
    let others = [CHOSEN, HITS, "enfilade-batch", "obvhs-bvh2", "obvhs-cwbvh"].map(str::to_owned);
    kernels("enfilade-").chain(kernels(BEAMS)).chain(kernels(PACKETS)).chain(others).collect()
}

/// Ways that need the model, besides [`names`].
const OF_MODELS: [&str; 4] = [F32_RAYS, NO_CELLS, DIAGONALS, TRUTH];

/// Pictures in the way that takes the least time, by what scene, eye and size are.
const CHOSEN: &str = "enfilade-auto";
/// Pictures by beams that tell of each pixel what its ray would.
const HITS: &str = "enfilade-hits";
/// What names of ways that make pictures by beams begin with.
const BEAMS: &str = "enfilade-beams-";
/// The same by packets.
const PACKETS: &str = "enfilade-packets-";
const F32_RAYS: &str = "enfilade-f32-rays";
const NO_CELLS: &str = "enfilade-no-cells";
const DIAGONALS: &str = "enfilade-diagonals";
const TRUTH: &str = "truth-f64";

/// Whether answers of the way of this name are to be right: those of this library, but to rays that were rounded to f32, and those of the truth.
pub(super) fn is_exact(name: &str) -> bool {
    name == TRUTH || name.starts_with("enfilade-") && name != F32_RAYS
}

/// The names of all ways that this machine has for a scene whose model is known: [`names`], rays that are rounded to f32, the scene compiled without
/// cells, and with cells cut by diagonals, and the truth in f64.
pub fn error_names() -> Vec<String> {
    names().into_iter().chain(OF_MODELS.map(str::to_owned)).collect()
}

/// A ray as f32 has it.
pub(super) fn narrow(ray: &Ray) -> Ray {
    let round = |c: f64| f64::from(c as f32);
    Ray::segment(ray.origin.map(round), ray.direction.map(round), round(ray.tmin), round(ray.tmax))
}

impl Kind {
    fn pictures(scene: &Arc<Scene>, maker: Maker) -> Kind {
        Kind::Pictures(Arc::clone(scene), Mutex::new(Painter { maker, pixels: Vec::new(), hits: Vec::new() }))
    }
}

impl Tracer {
    /// The way of one of [`error_names`], over the triangles of `scene`, which was compiled from `model`.
    ///
    /// # Errors
    /// Those of [`compile`].
    pub fn of_model(
        name: &str,
        scene: &Arc<Scene>,
        model: &Model,
        untagged: Untagged,
        truth: &Arc<Truth>,
    ) -> Result<Option<Tracer>, CompileError> {
        let mut options = CompileOptions::default();
        (options.tolerance, options.untagged) = (scene.tolerance(), untagged);
        let kind = match name {
            F32_RAYS => Kind::Narrow(Kernel::best(), Arc::clone(scene)),
            TRUTH => Kind::Truth(Arc::clone(truth)),
            NO_CELLS | DIAGONALS => {
                if name == NO_CELLS {
                    options.cells = false;
                } else {
                    options.convexification = Convexification::Diagonals;
                }
                Kind::Kernel(Kernel::best(), Arc::new(compile(model, &options)?.scene()))
            }
            _ => return Ok(Tracer::by_name(name, scene)),
        };
        Ok(Some(Tracer { name: name.to_owned(), kind }))
    }

    /// The way of this name, over the triangles of `scene`.
    pub fn by_name(name: &str, scene: &Arc<Scene>) -> Option<Tracer> {
        let kind = if name == "enfilade-batch" {
            Kind::Batch(Arc::clone(scene))
        } else if name == CHOSEN {
            Kind::pictures(scene, Maker::Chosen(Box::new(Beams::new(Arc::clone(scene)))))
        } else if name == HITS {
            Kind::pictures(scene, Maker::Hits(Box::new(Beams::new(Arc::clone(scene)))))
        } else if let Some(kernel) = name.strip_prefix(BEAMS) {
            let kernel = Kernel::by_name(kernel)?;
            let beams = Beams::new(Arc::clone(scene)).with_kernel(kernel);
            Kind::pictures(scene, Maker::Beams(Box::new(beams)))
        } else if let Some(kernel) = name.strip_prefix(PACKETS) {
            let kernel = Kernel::by_name(kernel)?;
            let packets = Packets::new(Arc::clone(scene)).with_kernel(kernel);
            Kind::pictures(scene, Maker::Packets(Box::new(packets)))
        } else if let Some(kernel) = name.strip_prefix("enfilade-") {
            Kind::Kernel(Kernel::by_name(kernel)?, Arc::clone(scene))
        } else {
            let rounded = Rounded::new(scene);
            if rounded.triangles.is_empty() {
                return None;
            }
            let params = BvhBuildParams::medium_build();
            let mut time = std::time::Duration::default();
            match name {
                "obvhs-bvh2" => {
                    Kind::Bvh2(build_bvh2_from_tris(&rounded.triangles, params, &mut time), rounded)
                }
                "obvhs-cwbvh" => {
                    Kind::CwBvh(build_cwbvh_from_tris(&rounded.triangles, params, &mut time), rounded)
                }
                _ => return None,
            }
        };
        Some(Tracer { name: name.to_owned(), kind })
    }

    /// Whether it makes whole pictures.
    pub(super) fn paints(&self) -> bool {
        matches!(self.kind, Kind::Pictures(..))
    }

    /// Rays each of which starts where the last one did, or not, as a caller would ask who knows that.
    fn trace_one_by_one<R: Borrow<Ray>>(
        kernel: Kernel,
        scene: &Scene,
        rays: impl Iterator<Item = R>,
        hits: &mut [Hit],
    ) {
        let (mut origin, mut start) = ([f64::NAN; 3], Start::Anywhere);
        for (ray, hit) in rays.zip(hits) {
            // Not copied: that is what would be timed.
            let ray = ray.borrow();
            if ray.origin != origin {
                origin = ray.origin;
                start = match scene.locate(origin) {
                    Place::Air { cell, .. } => Start::Cell(cell),
                    _ => Start::Anywhere,
                };
            }
            *hit = scene.trace_with(kernel, start, ray, Want::LEAST);
        }
    }
}

impl Way for Tracer {
    fn name(&self) -> &str {
        &self.name
    }

    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        match &self.kind {
            Kind::Kernel(kernel, scene) => Tracer::trace_one_by_one(*kernel, scene, rays.iter(), hits),
            Kind::Narrow(kernel, scene) => {
                Tracer::trace_one_by_one(*kernel, scene, rays.iter().map(narrow), hits)
            }
            Kind::Batch(scene) | Kind::Pictures(scene, _) => scene.trace_many(rays, hits, Want::LEAST),
            Kind::Truth(truth) => {
                for (ray, hit) in rays.iter().zip(hits) {
                    *hit = truth.nearest(ray).map_or(Hit::ESCAPED, |nearest| Hit {
                        t: nearest.t,
                        element: nearest.element.0,
                        triangle: nearest.triangle,
                        ..Hit::ESCAPED
                    });
                }
            }
            Kind::Bvh2(bvh, rounded) => rounded.trace(rays, hits, &bvh.primitive_indices, |ray, found| {
                bvh.ray_traverse(ray, found, |ray, place| {
                    rounded.triangles[bvh.primitive_indices[place] as usize].intersect(ray)
                })
            }),
            Kind::CwBvh(bvh, rounded) => rounded.trace(rays, hits, &bvh.primitive_indices, |ray, found| {
                bvh.ray_traverse(ray, found, |ray, place| {
                    rounded.triangles[bvh.primitive_indices[place] as usize].intersect(ray)
                })
            }),
        }
    }

    fn trace_onward(&self, from: &[Hit], rays: &[Ray], hits: &mut [Hit]) {
        let one_by_one = |kernel: Kernel, scene: &Scene, hits: &mut [Hit], as_told: fn(&Ray) -> Ray| {
            for ((from, ray), hit) in from.iter().zip(rays).zip(hits) {
                *hit = scene.trace_with(kernel, Start::Hit(from), &as_told(ray), Want::LEAST);
            }
        };
        match &self.kind {
            Kind::Kernel(kernel, scene) => one_by_one(*kernel, scene, hits, |ray| *ray),
            Kind::Narrow(kernel, scene) => one_by_one(*kernel, scene, hits, narrow),
            Kind::Batch(scene) | Kind::Pictures(scene, _) => {
                scene.trace_many_of(Starts::Hits(from), rays, hits, Want::LEAST);
            }
            _ => self.trace(rays, hits),
        }
    }

    fn normal(&self, hit: &Hit) -> Option<[f64; 3]> {
        match &self.kind {
            Kind::Bvh2(_, rounded) | Kind::CwBvh(_, rounded) => {
                let Triangle { v0, v1, v2 } = rounded.triangles.get(hit.triangle as usize)?;
                Some((*v1 - *v0).cross(*v2 - *v0).as_dvec3().try_normalize()?.to_array())
            }
            _ => (hit.normal != [0.0; 3]).then_some(hit.normal),
        }
    }

    fn picture(&self, camera: &Camera, size: (u32, u32)) -> Option<Answered> {
        let Kind::Pictures(scene, painter) = &self.kind else { return None };
        let mut painter = painter.lock().unwrap_or_else(PoisonError::into_inner);
        let Painter { maker, pixels, hits } = &mut *painter;
        let (width, count) = (size.0, u64::from(size.0) * u64::from(size.1));
        pixels.resize(count as usize, 0);
        let by_beams = |rays: u64| Answered { beams: count - rays, packets: 0, rays };
        match maker {
            Maker::Beams(beams) => Some(by_beams(beams.paint(camera, width, pixels).unsure)),
            Maker::Hits(beams) => {
                hits.resize(count as usize, Hit::ESCAPED);
                Some(by_beams(beams.hits(camera, width, Want::LEAST, hits).unsure))
            }
            Maker::Packets(packets) => {
                let rays = packets.paint(camera, width, pixels).rays;
                Some(Answered { beams: 0, packets: count - rays, rays })
            }
            Maker::Chosen(beams) => match PictureWay::of(scene, camera, size, true) {
                PictureWay::Beams => Some(by_beams(beams.paint(camera, width, pixels).unsure)),
                PictureWay::Rays => None,
            },
        }
    }

    fn shown(&self, camera: &Camera, width: u32, hits: &mut [Hit]) {
        if let Kind::Pictures(_, painter) = &self.kind {
            let mut painter = painter.lock().unwrap_or_else(PoisonError::into_inner);
            match &mut painter.maker {
                Maker::Beams(beams) | Maker::Chosen(beams) => {
                    beams.painted_hits(camera, width, Want::LEAST, hits);
                }
                Maker::Hits(beams) => {
                    beams.hits(camera, width, Want::LEAST, hits);
                }
                Maker::Packets(packets) => packets.painted_hits(camera, width, Want::LEAST, hits),
            }
        }
    }

    fn is_batch(&self) -> bool {
        matches!(self.kind, Kind::Batch(_) | Kind::Pictures(..))
    }
}
