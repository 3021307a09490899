//! Pictures by beams against pictures by rays.

use glam::DVec3;

use super::{Beams, Surface};
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Hit, NONE, Prisms, Ray, Want};

/// A pixel whose ray is moved by so many pixels and then meets what the beam says is a tie.
const TIE: f64 = 1e-2;

/// How a picture by beams differs from that by rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    /// Pixels.
    pub pixels: u64,
    /// Pixels of which cells do not tell, left to rays.
    pub unsure: u64,
    /// Pixels that nothing was written to.
    pub unwritten: u64,
    /// Pixels that show something else than the ray meets, which one within a hundredth of a pixel meets.
    pub ties: u64,
    /// Pixels that show something else, no tie: their columns and rows, what the beam shows, and which triangle the ray meets.
    pub wrong: Vec<([u32; 2], Surface, u32)>,
}

impl Beams<'_> {
    /// Compares the picture that `camera` takes with what the ray of each pixel meets.
    pub fn differences(&mut self, camera: &Camera, width: u32, height: u32) -> Differences {
        const UNWRITTEN: u32 = u32::MAX - 2;
        let mut pixels = vec![UNWRITTEN; width as usize * height as usize];
        self.surfaces(camera, width, &mut pixels);
        let pinhole = camera.pinhole(width, height);
        let rays: Vec<Ray> =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pinhole.ray(x, y)).collect();
        let mut hits = vec![Hit::ESCAPED; rays.len()];
        self.scene.trace_many(&rays, &mut hits, Want::default());
        let mut differences = Differences { pixels: pixels.len() as u64, ..Differences::default() };
        let [_, _, across, down] = pinhole.parts();
        for ((index, (&pixel, ray)), hit) in pixels.iter().zip(&rays).enumerate().zip(&hits) {
            if pixel == UNWRITTEN {
                differences.unwritten += 1;
                continue;
            }
            let surface = Surface::of(pixel);
            if surface == Surface::Unsure {
                differences.unsure += 1;
                continue;
            }
            if is_same(self.scene, surface, hit) {
                continue;
            }
            let direction = DVec3::from(ray.direction);
            let is_tie = (0..8).any(|turn| {
                let (sin, cos) = (f64::from(turn) * std::f64::consts::FRAC_PI_4).sin_cos();
                let aside = Ray::new(ray.origin, (direction + (across * cos + down * sin) * TIE).to_array());
                is_same(self.scene, surface, &self.scene.trace_from(crate::Start::Anywhere, &aside, Want::default()))
            });
            if is_tie {
                differences.ties += 1;
            } else {
                let place = [index as u32 % width, index as u32 / width];
                differences.wrong.push((place, surface, hit.triangle));
            }
        }
        differences
    }
}

/// Whether what a ray meets is part of a surface.
fn is_same(scene: &Scene, surface: Surface, hit: &Hit) -> bool {
    match surface {
        Surface::Sky => hit.element == NONE,
        Surface::Unsure => false,
        Surface::Source(source) => {
            let triangles = Prisms::new(&scene.tables).triangles_of(source);
            triangles.contains(&hit.triangle)
        }
        Surface::Triangle(triangle) => triangle == hit.triangle || {
            let [a, b, c] = scene.triangle(triangle).map(DVec3::from);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            hit.element == scene.triangle_element(triangle)
                && normal.dot(DVec3::from(hit.point) - a).abs() <= 1e-9
        },
    }
}
