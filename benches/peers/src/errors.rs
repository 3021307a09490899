//! The peers among the ways whose errors are measured.
//!
//! They get rays as a caller has them, in f64: what rounding them to f32 takes, and looking up whose triangle was met, is part of their time here, as it is for
//! the crates that `bench error` has by itself.

use std::sync::Arc;

use enfilade::bench::{ErrorOptions, ErrorReport, Way as Judged, error, error_names};
use enfilade::{Hit, Ray, Scene};
use glam::DVec3;

use crate::embree::{Built, Embree, One, Quality};
use crate::scenes::Measured;
use crate::way::{Met, Rays, Way, soup};
use crate::{Arguments, crates};

/// So many rays are rounded at a time: they stay in the nearest cache.
const BLOCK: usize = 256;

/// A peer, on a scene's triangles.
struct Peer<W> {
    name: String,
    scene: Arc<Scene>,
    way: W,
}

impl<W: Way> Peer<W> {
    fn new(scene: &Arc<Scene>, way: W) -> Peer<W> {
        Peer { name: way.name(), scene: Arc::clone(scene), way }
    }
}

impl<W: Way + Sync> Judged for Peer<W> {
    fn name(&self) -> &str {
        &self.name
    }

    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        let mut met = [Met::NOTHING; BLOCK];
        for (rays, hits) in rays.chunks(BLOCK).zip(hits.chunks_mut(BLOCK)) {
            self.way.nearest(&Rays::rounded(&self.scene, rays), &mut met[..rays.len()]);
            for (met, hit) in met.iter().zip(hits) {
                *hit = Hit::ESCAPED;
                if met.t.is_finite() && met.triangle < self.scene.detail_triangle_count() {
                    (hit.t, hit.triangle) = (met.t, met.triangle);
                    hit.element = self.scene.triangle_element(met.triangle);
                }
            }
        }
    }

    /// Of the triangle as it was rounded.
    fn normal(&self, hit: &Hit) -> Option<[f64; 3]> {
        if hit.triangle >= self.scene.detail_triangle_count() {
            return None;
        }
        let center = crate::way::center(&self.scene);
        let [a, b, c] = self.scene.triangle(hit.triangle).map(|p| (DVec3::from(p) - center).as_vec3());
        Some((b - a).cross(c - a).as_dvec3().try_normalize()?.to_array())
    }
}

/// Measures all ways, and the peers, on one scene.
pub fn errors(
    measured: &Measured,
    embree: Option<&Arc<Embree>>,
    arguments: &Arguments,
) -> anyhow::Result<ErrorReport> {
    let scene = &measured.scene;
    let soup = soup(scene);
    let mut peers: Vec<Box<dyn Judged>> = Vec::new();
    if let Some(embree) = embree {
        for robust in [false, true] {
            let built = Built::new(embree, &soup, Quality::High, robust);
            peers.push(Box::new(Peer::new(scene, One(Arc::new(built)))));
        }
    }
    peers.push(Box::new(Peer::new(scene, crates::Bvh::new(&soup))));
    let is_wanted = |name: &str| {
        arguments.ways.is_empty() || arguments.ways.iter().any(|part| name.contains(part.as_str()))
    };
    let others: Vec<&dyn Judged> =
        peers.iter().map(|peer| &**peer).filter(|peer| is_wanted(peer.name())).collect();
    let mut options = ErrorOptions::default();
    options.size = (arguments.size, arguments.size);
    options.repeat = arguments.repeat as u32;
    options.kernels = error_names().into_iter().filter(|name| is_wanted(name)).collect();
    #[cfg(feature = "flip")]
    {
        options.flip = Some(flip);
    }
    Ok(error(scene, &measured.model, &measured.views, &others, &options)?)
}

/// The mean of FLIP between two pictures, on a screen as its authors see one.
#[cfg(feature = "flip")]
fn flip((width, height): (u32, u32), told: &[u8], exact: &[u8]) -> f64 {
    use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

    let [exact, told] = [exact, told].map(|picture| FlipImageRgb8::with_data(width, height, picture));
    let map = nv_flip::flip(exact, told, DEFAULT_PIXELS_PER_DEGREE);
    f64::from(FlipPool::from_image(&map).mean())
}
