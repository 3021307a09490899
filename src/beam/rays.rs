//! Pixels of which cells do not tell what they show: by a ray each.

use glam::DVec3;

use super::SKY_COLOR;
use super::fringe::Edges;
use super::glass::Passed;
use super::shade::{Looks, Show};
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Ray, Start, Starts, Want};

/// What is seen from inside a solid: nothing.
const IN_SOLID: u32 = 0xff80_8080;

/// Layers that a ray may pass; the next one counts as opaque.
const LAYERS: usize = 64;

/// Rays that are traced together.
const TOGETHER: usize = 4096;

/// The rays of a picture.
pub(crate) struct Rays<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) camera: &'a Camera,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) looks: &'a Looks,
    /// Where they start.
    pub(crate) starts: Starts<'a>,
}

impl Rays<'_> {
    /// Tells what pixels show that cells do not tell, parts of rows, and then those at edges beside which something else is shown: their colours, if it is these that
    /// are made. Returns how many they are.
    pub(crate) fn tell(&self, unsure: &[[i32; 3]], edges: Edges, pixels: &mut [u32], show: Show) -> u64 {
        let count = |parts: &[[i32; 3]]| parts.iter().map(|[_, lo, hi]| (hi - lo) as u64).sum::<u64>();
        if show == Show::Light {
            self.shade(unsure, pixels, SKY_COLOR);
        }
        let asked = edges.asked(pixels, self.width as usize, show);
        if show == Show::Light {
            self.shade(&asked, pixels, SKY_COLOR);
        }
        count(unsure) + count(&asked)
    }

    /// Shades parts of rows, each a row and from where up to where.
    pub(super) fn shade(&self, parts: &[[i32; 3]], pixels: &mut [u32], sky: u32) {
        let pinhole = self.camera.pinhole(self.width, self.height);
        let places = parts.iter().flat_map(|&[row, lo, hi]| (lo..hi).map(move |column| [column, row]));
        let mut places = places.peekable();
        let (mut rays, mut at, mut hits) = (Vec::new(), Vec::new(), Vec::new());
        while places.peek().is_some() {
            rays.clear();
            at.clear();
            for [column, row] in places.by_ref().take(TOGETHER) {
                rays.push(pinhole.ray(column as u32, row as u32));
                at.push(row as usize * self.width as usize + column as usize);
            }
            hits.clear();
            hits.resize(rays.len(), Hit::ESCAPED);
            self.scene.trace_many_of(self.starts, &rays, &mut hits, Want { triangle: true, ..Want::LEAST });
            for ((&at, ray), hit) in at.iter().zip(&rays).zip(&hits) {
                pixels[at] = self.seen(ray, hit, sky);
            }
        }
    }

    /// What is seen where a ray met this first: through glass, if that is looked through.
    fn seen(&self, ray: &Ray, first: &Hit, sky: u32) -> u32 {
        let (mut layers, mut passed) = (0, Passed::ALL);
        // Of glass it passes what it is told of.
        let mut passes = |hit: &Hit| {
            layers += 1;
            let pane = if layers <= LAYERS { self.looks.pane(hit.material) } else { None };
            pane.inspect(|pane| passed.pass(pane, cosine(ray, hit) as f32)).is_some()
        };
        let mut last = *first;
        // From inside of a solid nothing is seen, also of one of glass.
        if first.triangle != NONE && passes(first) {
            let want = Want { triangle: true, ..Want::LEAST };
            last = self.scene.trace_beyond(Start::Anywhere, ray, want, first, passes);
        }
        passed.over(if last.element == NONE { sky } else { self.pixel(ray, &last) })
    }

    fn pixel(&self, ray: &Ray, hit: &Hit) -> u32 {
        if hit.triangle == NONE {
            return IN_SOLID;
        }
        let bright = cosine(ray, hit).sqrt() as f32;
        let color = self.looks.of(&self.scene.tables, hit.triangle);
        let [red, green, blue] = color.map(|c| (c * bright).round().clamp(0.0, 255.0) as u32);
        red | green << 8 | blue << 16 | 0xff00_0000
    }
}

/// The cosine of the angle between a ray and the normal of what it met.
fn cosine(ray: &Ray, hit: &Hit) -> f64 {
    DVec3::from(ray.direction).normalize_or_zero().dot(DVec3::from(hit.normal)).abs()
}
