//! What is seen through glass in pictures by beams, against all triangles that each ray crosses, and against rays.

use glam::DVec3;

use super::glass::Passed;
use super::rays::Rays;
use super::shade::Looks;
use super::tests::{SIZE, outside_views, rays, views};
use super::{Beams, SKY_COLOR};
use crate::generate::{HouseOptions, Style, house};
use crate::importers::{Material, MaterialId, Mesh, Model, Semantic};
use crate::render::Camera;
use crate::trace::{Kernel, Ray};
use crate::{CompileOptions, Scene, compile};

fn model() -> Model {
    house(&HouseOptions::default()).export(&Style::default()).to_model().unwrap()
}

fn scene(model: &Model) -> Scene {
    compile(model, &CompileOptions::default()).unwrap().scene()
}

/// What one sees through glass, by all triangles that a ray crosses.
struct Crossed<'a> {
    scene: &'a Scene,
    looks: Looks,
    corners: Vec<[DVec3; 3]>,
}

impl<'a> Crossed<'a> {
    fn new(scene: &'a Scene) -> Crossed<'a> {
        let triangles = 0..scene.detail_triangle_count();
        let corners = triangles.map(|t| scene.triangle(t).map(DVec3::from)).collect();
        Crossed { scene, looks: Looks::through_glass(&scene.tables), corners }
    }

    /// The picture of a camera: of each triangle, the planes through its edges and the eye are worked out once.
    fn picture(&self, camera: &Camera, [width, height]: [u32; 2]) -> Vec<u32> {
        let eye = DVec3::from(camera.eye());
        let around = |&[a, b, c]: &[DVec3; 3]| {
            let normal = (b - a).cross(c - a);
            (normal, normal.dot(a - eye), [[a, b], [b, c], [c, a]].map(|[p, q]| (p - eye).cross(q - eye)))
        };
        let seen: Vec<_> = self.corners.iter().map(around).collect();
        rays(camera, width, height).iter().map(|ray| self.see(&seen, ray)).collect()
    }

    /// The pixel of a ray from the eye: of each triangle its normal, the eye's distance from its plane by the normal's length, and the planes
    /// through its edges and the eye.
    fn see(&self, seen: &[(DVec3, f64, [DVec3; 3])], ray: &Ray) -> u32 {
        let way = DVec3::from(ray.direction).normalize();
        let crossing = |(triangle, &(normal, height, edges)): (usize, &(DVec3, f64, [DVec3; 3]))| {
            let [u, v] = [edges[0], edges[1]].map(|edge| way.dot(edge));
            if u * v < 0.0 {
                return None;
            }
            let w = way.dot(edges[2]);
            let is_within = u >= 0.0 && v >= 0.0 && w >= 0.0 || u <= 0.0 && v <= 0.0 && w <= 0.0;
            let t = height / normal.dot(way);
            let is_met = t > 0.0 && is_within;
            is_met.then(|| {
                let material = self.scene.tables.record(triangle as u32).material;
                (t, material, triangle as u32, normal.normalize().dot(way).abs())
            })
        };
        let mut crossed: Vec<_> = seen.iter().enumerate().filter_map(crossing).collect();
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut passed = Passed::ALL;
        for (_, material, triangle, cosine) in crossed {
            let Some(pane) = self.looks.pane(material) else {
                let color = self.looks.of(&self.scene.tables, triangle);
                let [red, green, blue] = color.map(|c| (f64::from(c) * cosine.sqrt()).round() as u32);
                return passed.over(red | green << 8 | blue << 16 | 0xff00_0000);
            };
            passed.pass(pane, cosine as f32);
        }
        passed.over(SKY_COLOR)
    }
}

/// Where two pictures differ by more than two of 255 steps, and how.
fn unlike(a: &[u32], b: &[u32]) -> Vec<(usize, u32, u32)> {
    let differs = |a: u32, b: u32| (0..4).any(|i| a.to_le_bytes()[i].abs_diff(b.to_le_bytes()[i]) > 2);
    let pairs = a.iter().zip(b).enumerate().filter(|(_, (a, b))| differs(**a, **b));
    pairs.map(|(at, (a, b))| (at, *a, *b)).collect()
}

/// A picture by beams through glass, and how many of its pixels were left to rays.
fn by_beams(scene: &Scene, kernel: Kernel, camera: &Camera, [width, height]: [u32; 2]) -> (Vec<u32>, u64) {
    let mut pixels = vec![0; (width * height) as usize];
    let counts = Beams::new(scene).with_kernel(kernel).through_glass().paint(camera, width, &mut pixels);
    (pixels, counts.unsure)
}

#[test]
fn what_is_behind_glass_is_seen() {
    let size = SIZE.map(|size| size / 3);
    let scene = scene(&model());
    let crossed = Crossed::new(&scene);
    let mut views = views(&scene, 8);
    views.extend(outside_views(&scene));
    let (mut opaque, mut glazed, mut all) = (vec![0; (size[0] * size[1]) as usize], 0, 0);
    for camera in &views {
        let expected = crossed.picture(camera, size);
        for kernel in Kernel::available() {
            let (pixels, left) = by_beams(&scene, kernel, camera, size);
            let unlike = unlike(&pixels, &expected);
            // Edges, and where surfaces lie on each other.
            assert!(unlike.len() <= 2 && left == 0, "{camera:?} {left} {unlike:x?}");
            all += unlike.len();
        }
        Beams::new(&scene).paint(camera, size[0], &mut opaque);
        glazed += unlike(&opaque, &expected).len();
    }
    assert!(glazed > 500 && all * 1000 < glazed, "{all} unlike, {glazed} glazed");
}

/// By polygons that are gathered after some pictures from outside.
#[test]
fn what_is_behind_glass_is_seen_in_later_pictures() {
    let size = SIZE.map(|size| size / 3);
    let scene = scene(&model());
    let crossed = Crossed::new(&scene);
    let views = outside_views(&scene);
    let mut opaque = vec![0; (size[0] * size[1]) as usize];
    for kernel in Kernel::available() {
        let mut beams = Beams::new(&scene).with_kernel(kernel).through_glass();
        for camera in views.iter().cycle().take(super::Many::few(&scene) as usize) {
            beams.paint(camera, size[0], &mut opaque);
        }
        let (mut glazed, mut pixels) = (0, opaque.clone());
        for camera in &views {
            let expected = crossed.picture(camera, size);
            let counts = beams.paint(camera, size[0], &mut pixels);
            let others = unlike(&pixels, &expected);
            assert!(others.len() <= 2 && counts.unsure == 0, "{camera:?} {others:x?}");
            Beams::new(&scene).paint(camera, size[0], &mut opaque);
            glazed += unlike(&opaque, &expected).len();
        }
        assert!(beams.many.facets.is_some() && glazed > 50, "{glazed} glazed");
        // Through glass other sides show: what was gathered for that is of no use without it, nor the other way.
        assert!(beams.through_glass().many.facets.is_none());
    }
}

/// The house with so many large panes of glass through all of it, behind each other.
fn with_sheets(count: u32) -> Model {
    let mut model = model();
    let all = model.elements.iter().flat_map(|element| &element.mesh.positions).map(|p| DVec3::from(*p));
    let (lo, hi) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let glass = Material { alpha: 0.3, base_color: [0.2, 0.7, 0.9], ..Material::default() };
    model.materials.push(glass);
    let glass = MaterialId(model.materials.len() as u32 - 1);
    let (mut sheets, mut mesh) = (model.elements[0].clone(), Mesh::default());
    for i in 0..count {
        let x = lo.x + (hi.x - lo.x) * (f64::from(i) + 0.37) / f64::from(count);
        let reach = hi - lo;
        // Not quite upright, and not along any wall.
        let corners = [
            [0.0, lo.y - 2.0 * reach.y, lo.z - 0.5],
            [0.11, hi.y + 2.0 * reach.y, lo.z - 0.4],
            [0.2, lo.y, hi.z + 4.0 * reach.z],
        ];
        mesh.positions.extend(corners.map(|[aside, y, z]| [x + aside, y, z]));
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        mesh.materials.push(glass);
    }
    (sheets.id, sheets.semantic, sheets.mesh) = ("sheets".into(), Semantic::Furniture, mesh);
    model.elements.push(sheets);
    model
}

/// Each sheet is in many cells, and counts once.
#[test]
fn a_pane_in_many_cells_counts_once() {
    let size = SIZE.map(|size| size / 3);
    let scene = scene(&with_sheets(20));
    let crossed = Crossed::new(&scene);
    for camera in views(&scene, 6).iter().chain(&outside_views(&scene)[..2]) {
        let expected = crossed.picture(camera, size);
        let (pixels, left) = by_beams(&scene, Kernel::best(), camera, size);
        let unlike = unlike(&pixels, &expected);
        assert!(unlike.len() <= 2 && left == 0, "{camera:?} {left} {} {:x?}", unlike.len(), unlike[0]);
    }
}

#[test]
fn more_layers_than_are_kept_are_left_to_rays() {
    let size = SIZE.map(|size| size / 3);
    let scene = scene(&with_sheets(1500));
    let crossed = Crossed::new(&scene);
    let mut all_left = 0;
    for camera in &views(&scene, 4) {
        let expected = crossed.picture(camera, size);
        let (pixels, left) = by_beams(&scene, Kernel::best(), camera, size);
        let unlike = unlike(&pixels, &expected);
        assert!(unlike.len() <= 4, "{camera:?} {left} {} {:x?}", unlike.len(), unlike[0]);
        all_left += left;
    }
    assert!(all_left > 1000, "{all_left}");
}

/// Walls of cells, too, may be of glass: they are left to rays.
#[test]
fn walls_of_glass_are_seen_through_by_rays() {
    let mut model = model();
    let walls = model.elements.iter().filter(|element| element.semantic == Semantic::Wall);
    let materials: Vec<MaterialId> = walls.flat_map(|wall| wall.mesh.materials.clone()).collect();
    for material in materials {
        model.materials[material.0 as usize].alpha = 0.4;
    }
    let scene = scene(&model);
    let crossed = Crossed::new(&scene);
    let [width, height] = SIZE;
    for camera in &views(&scene, 4) {
        let (pixels, left) = by_beams(&scene, Kernel::best(), camera, SIZE);
        let mut by_rays = vec![0; pixels.len()];
        let parts: Vec<[i32; 3]> = (0..height as i32).map(|row| [row, 0, width as i32]).collect();
        let rays = Rays {
            scene: &scene,
            camera,
            looks: &crossed.looks,
            width,
            height,
            starts: crate::trace::Starts::Anywhere,
        };
        rays.shade(&parts, &mut by_rays, SKY_COLOR);
        let unlike = unlike(&pixels, &by_rays);
        assert!(unlike.len() <= 2, "{camera:?} {} {:x?}", unlike.len(), unlike[0]);
        assert!(left > 0);
    }
}
