//! Pictures by beams against pictures by rays.

use std::ops::Deref;

use glam::DVec3;

use super::screen;
use super::{Beams, Surface};
use crate::render::Camera;
use crate::scene::Scene;
use crate::trace::{Answer, Hit, NONE, Prisms, Ray, Target, Want};

/// A pixel whose ray is moved by so many pixels and then meets what the beam says is a tie.
const TIE: f64 = 1e-2;

/// The number of a pixel that nothing was written to.
pub(crate) const UNWRITTEN: u32 = u32::MAX - 2;

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
    /// Pixels that show a surface that is met within the tolerance of what the ray meets.
    pub flush: u64,
    /// Pixels that show something else, which the ray of an eye a nanometre aside meets: where eyes are moved to that lie in planes.
    pub aside: u64,
    /// Pixels that show something else, no tie: their columns and rows, what the beam shows, and which triangle the ray meets.
    pub wrong: Vec<([u32; 2], Surface, u32)>,
}

impl<S: Deref<Target = Scene>> Beams<S> {
    /// Compares the picture that `camera` takes with what the ray of each pixel meets.
    pub fn differences(&mut self, camera: &Camera, width: u32, height: u32) -> Differences {
        let mut pixels = vec![UNWRITTEN; width as usize * height as usize];
        self.surfaces(camera, width, &mut pixels);
        compare(&self.scene, camera, width, &pixels)
    }
}

/// What a picture of surfaces, so many pixels wide, differs in from what rays meet.
pub(crate) fn compare(scene: &Scene, camera: &Camera, width: u32, pixels: &[u32]) -> Differences {
    let height = pixels.len() as u32 / width;
    let pinhole = camera.pinhole(width, height);
    let mut differences = Differences { pixels: pixels.len() as u64, ..Differences::default() };
    let (mut places, mut rays) = (Vec::new(), Vec::new());
    for (place, &pixel) in (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).zip(pixels) {
        match Surface::of(pixel) {
            _ if pixel == UNWRITTEN => differences.unwritten += 1,
            Surface::Unsure => differences.unsure += 1,
            surface => {
                places.push((place, surface));
                rays.push(pinhole.ray(place[0], place[1]));
            }
        }
    }
    let mut hits = vec![Hit::ESCAPED; rays.len()];
    scene.trace_many(&rays, &mut hits, Want::default());
    let [_, _, across, down] = pinhole.parts();
    for ((&(place, surface), ray), hit) in places.iter().zip(&rays).zip(&hits) {
        if is_same(scene, surface, hit) {
            continue;
        }
        let direction = DVec3::from(ray.direction);
        let is_tie = || {
            (0..8).any(|turn| {
                let (sin, cos) = (f64::from(turn) * std::f64::consts::FRAC_PI_4).sin_cos();
                let aside = Ray::new(ray.origin, (direction + (across * cos + down * sin) * TIE).to_array());
                is_same(scene, surface, &scene.trace_from(crate::Start::Anywhere, &aside, Want::default()))
            })
        };
        if is_flush(scene, surface, ray, hit) {
            differences.flush += 1;
            continue;
        }
        if is_tie() {
            differences.ties += 1;
        } else if is_seen_aside(scene, surface, ray) {
            differences.aside += 1;
        } else {
            differences.wrong.push((place, surface, hit.triangle));
        }
    }
    differences
}

/// Whether a ray that starts where eyes are moved to, to any side, meets a surface.
fn is_seen_aside(scene: &Scene, surface: Surface, ray: &Ray) -> bool {
    let prisms = Prisms::new(&scene.tables);
    let (eye, aside) = (prisms.local(DVec3::from(ray.origin)), screen::aside(scene));
    (0..8u32).any(|part| {
        let to = |bit: u32| if part >> bit & 1 != 0 { 1.0 } else { -1.0 };
        let origin = prisms.global(eye + aside * DVec3::new(to(0), to(1), to(2)));
        let ray = Ray::new(origin.to_array(), ray.direction);
        is_same(scene, surface, &scene.trace_from(crate::Start::Anywhere, &ray, Want::default()))
    })
}

/// Whether a ray meets a surface's plane within the tolerance of what it meets.
fn is_flush(scene: &Scene, surface: Surface, ray: &Ray, hit: &Hit) -> bool {
    if !matches!(hit.answer(), Answer::Hit(_)) {
        return false;
    }
    let shown = match surface {
        Surface::Sky | Surface::Unsure => None,
        Surface::Source(source) => Target::source(scene, hit.cell, source, Want::LEAST),
        Surface::Triangle(triangle) => Target::triangle(scene, hit.cell, triangle, Want::LEAST),
    };
    shown.and_then(|target| target.hit(ray)).is_some_and(|shown| (shown.t - hit.t).abs() <= scene.tolerance())
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
        Surface::Triangle(triangle) => {
            triangle == hit.triangle || {
                let [a, b, c] = scene.triangle(triangle).map(DVec3::from);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                hit.element == scene.triangle_element(triangle)
                    && normal.dot(DVec3::from(hit.point) - a).abs() <= 1e-9
            }
        }
    }
}
