//! Pictures by beams against those by rays, and what each pixel is written by.

use glam::DVec3;
use proptest::prelude::*;

use super::cut::Exits;
use super::fringe::Fringes;
use super::kernels::Kernels;
use super::rows::{Arena, Line, Region};
use super::screen::Screen;
use super::shade::Looks;
use super::walk::{Around, Known, Paint, Seen, Space, Triangles, Walker};
use super::{Beams, Differences, Surface};
use crate::format::records::Facing;
use crate::generate::{HouseOptions, RoundRoomOptions, Style, house, round_room};
use crate::importers::{Frame, Material, MaterialId, ModelBuilder, NewElement, Semantic, UpAxis};
use crate::packets::Packets;
use crate::render::{Camera, room_views};
use crate::samples::Sample;
use crate::trace::{Hit, Kernel, NONE, Place, Prisms, Ray, Starts, Want};
use crate::{CompileOptions, Scene, compile};

/// Even, so that no ray goes straight ahead, along planes that the eye is in the middle between.
pub(crate) const SIZE: [u32; 2] = [204, 132];

pub(crate) fn scenes() -> Vec<(String, &'static Scene)> {
    let (some, randoms) =
        ([Sample::House, Sample::Build1, Sample::RoundRoom, Sample::Tower(3)], (0..6).map(Sample::Random));
    some.into_iter().chain(randoms).map(|sample| (format!("{sample:?}"), sample.scene())).collect()
}

/// Level views, and from the same eyes up, down and askew.
pub(crate) fn views(scene: &Scene, most: usize) -> Vec<Camera> {
    let level = room_views(scene, 2);
    let step = level.len().div_ceil(most).max(1);
    let looks = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, -0.3, -0.9], [1.0, 0.0, 0.0]];
    let mut views = Vec::new();
    for (index, camera) in level.into_iter().step_by(step).enumerate() {
        let look = looks[index % looks.len()];
        views.push(Camera::looking(camera.eye(), look, [0.0, 0.0, 1.0], 100.0).unwrap());
        views.push(camera);
    }
    views
}

/// The rays of all pixels of a picture.
pub(super) fn rays(camera: &Camera, width: u32, height: u32) -> Vec<Ray> {
    let places = 0..(width * height) as usize;
    super::told::pixels(&camera.pinhole(width, height), width, places).map(|(_, ray)| ray).collect()
}

/// From eyes on edges, in planes and on corners of cells.
pub(crate) fn touching_views(scene: &Scene) -> Vec<Camera> {
    let prisms = Prisms::new(&scene.tables);
    let (mut eyes, mut views) = (Vec::new(), Vec::new());
    for cell in prisms.cells.iter().skip(1) {
        let sides = prisms.sides_of(cell);
        let [a, b] = [sides[0].start, sides[1].start].map(|c| glam::DVec2::from(c.map(f64::from)));
        let floor = prisms.height(cell.floor, a);
        let middle = (floor + prisms.height(cell.ceiling, a)) / 2.0;
        // On an edge, in a side's plane, on a corner.
        eyes.extend([a.extend(middle), ((a + b) / 2.0).extend(middle), a.extend(floor)]);
    }
    let step = (eyes.len() / 40).max(1);
    for (index, &eye) in eyes.iter().step_by(step).enumerate() {
        let eye = prisms.global(eye).to_array();
        if matches!(scene.locate(eye), Place::Air { .. }) {
            let way = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [0.3, 0.9, 0.2]][index % 4];
            views.push(Camera::looking(eye, way, [0.0, 0.0, 1.0], 90.0).unwrap());
        }
    }
    views
}

fn sum(beams: &mut Beams<&Scene>, views: &[Camera]) -> Differences {
    let [width, height] = SIZE;
    total(views, |camera| beams.differences(camera, width, height))
}

/// The differences of all views.
pub(crate) fn total(views: &[Camera], mut of: impl FnMut(&Camera) -> Differences) -> Differences {
    views.iter().fold(Differences::default(), |mut sum, camera| {
        let one = of(camera);
        sum.pixels += one.pixels;
        sum.unsure += one.unsure;
        sum.unwritten += one.unwritten;
        sum.ties += one.ties;
        sum.aside += one.aside;
        sum.flush += one.flush;
        sum.wrong.extend(one.wrong);
        sum
    })
}

#[test]
fn pixels_show_what_rays_meet() {
    for (name, scene) in scenes() {
        let sum = sum(&mut Beams::new(scene), &views(scene, 12));
        assert!(sum.pixels > 0, "{name}");
        assert_eq!(sum.unwritten, 0, "{name}");
        assert!(sum.unsure * 1000 <= sum.pixels, "{name}: {} unsure of {}", sum.unsure, sum.pixels);
        assert!(sum.ties * 50_000 <= sum.pixels, "{name}: {} ties of {}", sum.ties, sum.pixels);
        assert!(sum.wrong.is_empty(), "{name}: {} wrong, {:?}", sum.wrong.len(), sum.wrong[0]);
    }
}

/// Small enough for an interpreter that checks every access to memory (docs/STRESS.md): a room with a wall, a ground, a stool and a sheet of glass, by every kernel.
#[test]
fn every_kernel_draws_a_small_scene() {
    use crate::oracle::fixtures::{Shape, model};
    let mut model = model(&[
        (Semantic::Room, Shape::cuboid([0.0; 3], [4.0, 3.0, 2.5])),
        (Semantic::Wall, Shape::cuboid([-0.3, -0.2, 0.0], [0.0, 3.2, 2.5])),
        (Semantic::Ground, Shape::cuboid([0.0, 0.0, -0.3], [4.0, 3.0, 0.0])),
        (Semantic::Furniture, Shape::prism(5, 0.4, 0.5, 0.9)),
        (Semantic::Furniture, Shape::cuboid([2.0, 1.0, 0.5], [2.01, 2.0, 1.5])),
    ]);
    let glass = Material { alpha: 0.3, base_color: [0.2, 0.7, 0.9], ..Material::default() };
    model.materials.push(glass);
    let glass = MaterialId(model.materials.len() as u32 - 1);
    let pane = &mut model.elements.last_mut().unwrap().mesh;
    pane.materials = vec![glass; pane.triangles.len()];
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let camera = Camera::looking([2.5, 0.8, 1.4], [-1.0, -0.3, -0.25], [0.0, 0.0, 1.0], 60.0).unwrap();
    let [width, height] = [25u32, 13];
    let drawn = |kernel: Kernel| {
        let size = (width * height) as usize;
        let [mut surfaces, mut light, mut through] = [0, 1, 2].map(|_| vec![0u32; size]);
        let mut beams = Beams::new(&scene).with_kernel(kernel);
        beams.surfaces(&camera, width, &mut surfaces);
        beams.paint(&camera, width, &mut light);
        Beams::new(&scene).with_kernel(kernel).through_glass().paint(&camera, width, &mut through);
        let mut by_packets = vec![Hit::ESCAPED; size];
        Packets::new(&scene).with_kernel(kernel).hits(&camera, width, Want::LEAST, &mut by_packets);
        let met: Vec<u32> = by_packets.iter().map(|hit| hit.element).collect();
        [surfaces, light, through, met]
    };
    let portable = drawn(Kernel::PORTABLE);
    // The wall, the ground, the stool and the pane, the last with what is behind it.
    assert!((1..=4).all(|element| portable[3].contains(&element)), "{:?}", portable[3]);
    assert!(portable[1] != portable[2]);
    for kernel in Kernel::available() {
        let [surfaces, light, through, met] = drawn(kernel);
        assert!(surfaces == portable[0] && met == portable[3], "{kernel:?}");
        // Shades are rounded once more, or less.
        for (own, other) in [(light, &portable[1]), (through, &portable[2])] {
            let is_near = |(own, other): (&u32, &u32)| {
                own.to_le_bytes().iter().zip(other.to_le_bytes()).all(|(a, b)| a.abs_diff(b) <= 1)
            };
            assert!(own.iter().zip(other).all(is_near), "{kernel:?}");
        }
    }
}

/// Pictures are made of polygons, numbers of triangles.
#[test]
fn colours_are_those_of_what_pixels_show() {
    let pixels_of = |scene: &Scene, camera: &Camera| {
        let ([width, height], tables) = (SIZE, &scene.tables);
        let looks = Looks::new(tables);
        let (mut pixels, mut shown) =
            (vec![0u32; (width * height) as usize], vec![0; (width * height) as usize]);
        let mut beams = Beams::new(scene);
        beams.paint(camera, width, &mut pixels);
        beams.surfaces(camera, width, &mut shown);
        let pinhole = camera.pinhole(width, height);
        let is_other = |at: usize| {
            let triangle = match Surface::of(shown[at]) {
                Surface::Source(source) => tables.surfaces[tables.sources[source as usize].first as usize],
                Surface::Triangle(triangle) => triangle,
                Surface::Sky => return pixels[at] != super::SKY_COLOR,
                Surface::Unsure => return false,
            };
            let [a, b, c] = scene.triangle(triangle).map(DVec3::from);
            let ray = pinhole.ray(at as u32 % width, at as u32 / width);
            let direction = DVec3::from(ray.direction).normalize();
            let bright = (b - a).cross(c - a).normalize().dot(direction).abs().sqrt();
            let steps = |(c, byte): (&f32, u8)| (f64::from(byte) - f64::from(*c) * bright).abs();
            looks.of(tables, triangle).iter().zip(pixels[at].to_le_bytes()).map(steps).any(|off| off > 1.5)
        };
        ((0..pixels.len()).filter(|&at| is_other(at)).count(), pixels.len())
    };
    for (name, scene) in scenes().into_iter().take(7) {
        let (mut others, mut pixels) = (0, 0);
        for camera in views(scene, 8).iter().chain(&outside_views(scene)) {
            let (other, count) = pixels_of(scene, camera);
            (others, pixels) = (others + other, pixels + count);
        }
        assert_eq!(others, 0, "{name}: of {pixels}");
    }
}

#[test]
fn differences_are_seen() {
    let scene = Sample::House.scene();
    let [width, height] = SIZE;
    let camera = views(scene, 1)[1];
    let mut beams = Beams::new(scene);
    // What the beams of another view show is not what rays of this one meet.
    let mut pixels = vec![0; (width * height) as usize];
    beams.surfaces(&views(scene, 2)[3], width, &mut pixels);
    let differences = super::check::compare(scene, &camera, width, &pixels);
    assert!(differences.wrong.len() > 1000, "{}", differences.wrong.len());
}

#[test]
fn eyes_in_planes_and_on_corners() {
    for (name, scene) in scenes().into_iter().take(6) {
        let views = touching_views(scene);
        assert!(views.len() > 5, "{name}: {} eyes", views.len());
        let sum = sum(&mut Beams::new(scene), &views);
        assert_eq!(sum.unwritten, 0, "{name}");
        // Eyes on walls are left to rays, and not those between rooms.
        assert!(sum.unsure < sum.pixels, "{name}: {} of {}", sum.unsure, sum.pixels);
        assert!(sum.wrong.is_empty(), "{name}: {} {:?}", sum.wrong.len(), sum.wrong[0]);
    }
}

#[test]
fn what_rays_are_to_tell() {
    let model = house(&HouseOptions::default()).export(&Style::default()).to_model().unwrap();
    let with = |tolerance: f64| {
        let options = CompileOptions { tolerance, ..CompileOptions::default() };
        compile(&model, &options).unwrap().scene()
    };
    let unsure = |scene: &Scene, eye: DVec3| {
        let camera = Camera::looking(eye.to_array(), [1.0, 0.2, 0.1], [0.0, 0.0, 1.0], 60.0).unwrap();
        let [width, height] = SIZE;
        let counts = Beams::new(scene).surfaces(&camera, width, &mut vec![0; (width * height) as usize]);
        counts.unsure == u64::from(width * height)
    };
    let scene = with(1e-3);
    let floor = scene.elements().position(|element| element.semantic() == Semantic::Ground).unwrap() as u32;
    let top = |&triangle: &u32| {
        let corners = scene.triangle(triangle).map(DVec3::from);
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let above = scene.locate((middle + DVec3::Z * 1e-3).to_array());
        let is_in_room = matches!(above, Place::Air { room: Some(_), .. });
        (scene.triangle_element(triangle) == floor && is_in_room).then_some(middle)
    };
    let on = (0..scene.detail_triangle_count()).find_map(|triangle| top(&triangle)).unwrap();
    assert!(unsure(&scene, on), "{on} is on a floor");
    assert!(unsure(&scene, on + DVec3::Z * 1e-9));
    assert!(!unsure(&scene, on + DVec3::Z * 1e-3));
    // Cells on a lattice that is coarser than the tolerance.
    let fine = with(1e-9);
    assert!(unsure(&fine, on + DVec3::Z * 1e-3), "2^-{} m", fine.tables.scene[0].lattice_bits);
}

#[test]
fn kernels_agree() {
    let [width, height] = SIZE;
    for (name, scene) in scenes().into_iter().take(5) {
        for camera in views(scene, 6) {
            let shown: Vec<Vec<u32>> = Kernel::available()
                .into_iter()
                .map(|kernel| {
                    let mut pixels = vec![0; (width * height) as usize];
                    Beams::new(scene).with_kernel(kernel).surfaces(&camera, width, &mut pixels);
                    pixels
                })
                .collect();
            assert!(shown.iter().all(|pixels| *pixels == shown[0]), "{name}");
        }
    }
}

/// Counts how often each pixel is painted.
struct Count {
    width: usize,
    counts: Vec<u32>,
}

impl Paint for Count {
    fn paint(&mut self, arena: &Arena, region: &Region, _: &Seen) {
        let [lo, hi] = arena.borders(region);
        for (row, (&lo, &hi)) in (region.rows[0]..).zip(lo.iter().zip(hi)) {
            for column in lo..hi {
                self.counts[row as usize * self.width + column as usize] += 1;
            }
        }
    }

    fn detail(&mut self, _: &Arena, _: &Region, _: (u32, Triangles<'_>), _: Exits<'_>) {}

    fn edge(&mut self, _: i32, _: [i32; 2]) {}

    fn is_hidden(&self, _: &Arena, _: &Region) -> bool {
        false
    }
}

#[test]
fn each_pixel_is_painted_once() {
    let [width, height] = SIZE;
    for (name, scene) in scenes() {
        let prisms = Prisms::new(&scene.tables);
        for camera in views(scene, 10) {
            let screen = Screen::new(&camera.pinhole(width, height), &prisms, DVec3::ONE);
            let Place::Air { cell, .. } = scene.locate(camera.eye()) else { continue };
            let mut count = Count { width: width as usize, counts: vec![0; (width * height) as usize] };
            let mut space = Space::new();
            let kernels = Kernels(Kernel::best());
            let known = Known::new(scene.tables.cells.len());
            let mut walker = Walker::new(
                &scene.tables,
                &screen,
                kernels,
                &mut space,
                &mut count,
                (&known, Around::All(NONE)),
            );
            for first in (0..height as i32).step_by(50) {
                walker.band([width, height], [first, (first + 50).min(height as i32)], Some(cell));
            }
            assert!(count.counts.iter().all(|&count| count == 1), "{name}");
        }
    }
}

/// How many threads share the work, and how it is cut into bands for them.
#[cfg(feature = "rayon")]
#[test]
fn threads_do_not_matter() {
    // Of what is drawn by hand pixels at edges are left to rays.
    let of =
        |scene: &'static Scene, count: usize| views(scene, count).into_iter().map(move |view| (scene, view));
    let (exact, drawn) = (Sample::House.scene(), Sample::House.drawn(1));
    let outside = (exact, crate::render::outside_view(exact));
    for (scene, camera) in of(exact, 6).chain(of(drawn, 4)).chain([outside]) {
        let [width, height] = [200, 611];
        let pictures = [1, 2, 3, 16].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut surfaces, mut pixels) =
                (vec![0; (width * height) as usize], vec![0; (width * height) as usize]);
            let mut beams = Beams::new(scene);
            pool.install(|| {
                beams.surfaces(&camera, width, &mut surfaces);
                beams.paint(&camera, width, &mut pixels);
            });
            (surfaces, pixels)
        });
        assert!(pictures.windows(2).all(|two| two[0] == two[1]));
    }
}

#[test]
fn bands_do_not_matter() {
    let [width, _] = SIZE;
    let scene = Sample::Build1.scene();
    let mut beams = Beams::new(scene);
    for camera in views(scene, 4) {
        // More rows than a band has, so that the second band begins within.
        let height = super::TOLD as u32 + 77;
        let mut pixels = vec![0; (width * height) as usize];
        beams.surfaces(&camera, width, &mut pixels);
        let differences = super::check::compare(scene, &camera, width, &pixels);
        assert!(differences.wrong.is_empty(), "{:?}", differences.wrong[0]);
    }
}

#[test]
fn from_outside_and_from_within_a_solid() {
    let scene = Sample::House.scene();
    let [lo, hi] = scene.hull();
    let middle = [0, 1, 2].map(|i| (lo[i] + hi[i]) / 2.0);
    let eye = [lo[0] - 9.0, lo[1] - 7.0, hi[2] + 3.0];
    let outside = Camera::look_at(eye, middle, [0.0, 0.0, 1.0], 60.0).unwrap();
    let [width, height] = SIZE;
    let differences = Beams::new(scene).differences(&outside, width, height);
    assert_eq!((differences.unwritten, differences.unsure), (0, 0));
    assert!(differences.wrong.is_empty(), "{:?}", differences.wrong[0]);
    let mut pixels = vec![0; (width * height) as usize];
    // On a wall's surface, and deep in a wall: from there nothing is seen.
    let wall = scene.elements().position(|element| element.semantic() == Semantic::Wall).unwrap() as u32;
    let of_wall: Vec<u32> = (0..scene.detail_triangle_count())
        .filter(|&triangle| scene.triangle_element(triangle) == wall)
        .collect();
    let corners = of_wall.iter().flat_map(|&triangle| scene.triangle(triangle).map(DVec3::from));
    let middle = corners.clone().sum::<DVec3>() / corners.count() as f64;
    let [a, b, c] = scene.triangle(of_wall[0]).map(DVec3::from);
    let mut eyes = vec![(a + b + c) / 3.0];
    eyes.extend(matches!(scene.locate(middle.to_array()), Place::InSolid(_)).then_some(middle));
    assert_eq!(eyes.len(), 2, "the middle of the first wall is in it");
    for eye in eyes {
        let camera = Camera::looking(eye.to_array(), [1.0, 0.2, 0.1], [0.0, 0.0, 1.0], 60.0).unwrap();
        Beams::new(scene).paint(&camera, width, &mut pixels);
        assert!(pixels.iter().all(|&pixel| pixel >> 24 == 0xff));
    }
}

#[test]
fn numbers_say_what_pixels_show() {
    assert_eq!(Surface::of(7), Surface::Triangle(7));
    assert_eq!(Surface::of(super::shade::SOURCE | 9), Surface::Source(9));
    assert_eq!(Surface::of(super::shade::SKY), Surface::Sky);
    assert_eq!(Surface::of(super::shade::UNSURE), Surface::Unsure);
    assert_ne!(NONE, super::shade::UNSURE);
}

proptest! {
    /// The pixels of a region near a line are found, and no others, by all kernels.
    #[test]
    fn pixels_near_lines_are_found(
        cut in [-3.0f64..3.0, -3.0f64..3.0, -200.0f64..200.0],
        line in [-3.0f64..3.0, -3.0f64..3.0, -200.0f64..200.0],
        off in [-0.02f64..0.02, -0.02f64..0.02, -1.0f64..3.0],
        flat in 0u8..4,
    ) {
        let (mut line, mut off) = (line, off);
        if flat == 0 {
            // Along the rows.
            (line[0], off[0]) = (0.0, 0.0);
        }
        for kernel in Kernel::available() {
            let (width, rows) = (61, [3, 40]);
            let mut arena = Arena::new();
            let all = arena.begin(width, rows[0], rows[1]);
            let (region, _) = arena.split(&Kernels(kernel), all, Line(cut));
            let Some(region) = region else { continue };
            let mut found = vec![false; width as usize * 40];
            arena.near(&Kernels(kernel), region, (Line(line), Line(off)), &mut |row, [from, to]| {
                (from..to).for_each(|x| found[(row * width + x) as usize] = true);
            });
            let at = |line: [f64; 3], x: i32, y: i32| line[0] * f64::from(x) + line[1] * f64::from(y) + line[2];
            let [lo, hi] = arena.borders(&region);
            for y in 0..40 {
                let row = (y - region.rows[0]) as usize;
                for x in 0..width {
                    let is_in = (region.rows[0]..region.rows[1]).contains(&y) && (lo[row]..hi[row]).contains(&x);
                    let apart = at(off, x, y) - at(line, x, y).abs();
                    if !is_in || apart.abs() > 1e-9 {
                        prop_assert_eq!(found[(y * width + x) as usize], is_in && apart > 0.0, "{:?} {} {}", kernel, x, y);
                    }
                }
            }
        }
    }

    #[test]
    fn lines_split_regions(lines in prop::collection::vec([-3.0f64..3.0, -3.0f64..3.0, -200.0f64..200.0], 1..6)) {
        let (width, rows) = (67, [5, 49]);
        for kernel in Kernel::available() {
            let mut arena = Arena::new();
            let mut regions = vec![arena.begin(width, rows[0], rows[1])];
            let mut known: Vec<Vec<(f64, bool)>> = vec![vec![]];
            for &line in &lines {
                let mut parts = (Vec::new(), Vec::new());
                for (region, told) in regions.iter().zip(&known) {
                    let (above, below) = arena.split(&Kernels(kernel), *region, Line(line));
                    for (part, side) in [(above, true), (below, false)] {
                        if let Some(part) = part {
                            parts.0.push(part);
                            parts.1.push(told.iter().copied().chain([(0.0, side)]).collect());
                        }
                    }
                }
                (regions, known) = parts;
            }
            let mut counts = vec![0; (width * rows[1]) as usize];
            for (region, told) in regions.iter().zip(&known) {
                let [lo, hi] = arena.borders(region);
                for (row, (&lo, &hi)) in (region.rows[0]..).zip(lo.iter().zip(hi)) {
                    for column in lo..hi {
                        prop_assert!(column >= region.columns[0] && column < region.columns[1]);
                        counts[(row * width + column) as usize] += 1;
                        for (line, &(_, side)) in lines.iter().zip(told) {
                            let value = line[0] * f64::from(column) + line[1] * f64::from(row) + line[2];
                            prop_assert!(value.abs() < 1e-9 || (value > 0.0) == side);
                        }
                    }
                }
            }
            let inside = &counts[(rows[0] * width) as usize..];
            prop_assert!(inside.iter().all(|&count| count == 1));
        }
    }
}

#[test]
fn hits_are_those_of_rays() {
    let [width, height] = SIZE;
    for (name, scene) in scenes().into_iter().take(6) {
        let mut beams = Beams::new(scene);
        for camera in views(scene, 4) {
            let (rays, want) = (rays(&camera, width, height), Want::default().with_face());
            let (mut by_beams, mut by_rays) =
                (vec![Hit::ESCAPED; rays.len()], vec![Hit::ESCAPED; rays.len()]);
            beams.hits(&camera, width, want, &mut by_beams);
            scene.trace_many_of(Starts::Anywhere, &rays, &mut by_rays, want);
            let (mut differing, mut others) = (Vec::new(), 0);
            for (beam, ray) in by_beams.iter().zip(&by_rays) {
                if !(beam.t == ray.t || (beam.t - ray.t).abs() < 1e-9)
                    || (0..3).any(|i| (beam.normal[i] - ray.normal[i]).abs() > 1e-9)
                {
                    differing.push((beam, ray));
                }
                // Of surfaces that lie on each other either is right.
                let all = |hit: &Hit| (hit.element, hit.cell, hit.room, hit.semantic, hit.material);
                others += u32::from(all(beam) != all(ray));
            }
            // On edges either of two answers is right.
            assert!(differing.len() <= 2, "{name}: {} differ, {:?}", differing.len(), differing[0]);
            assert!(others <= 20, "{name}: of {others} more than distance or normal differs");
        }
    }
}

#[test]
fn hits_of_the_smallest_pictures_are_those_of_rays() {
    let scene = Sample::House.scene();
    let (mut beams, mut packets) = (Beams::new(scene), Packets::new(scene));
    let camera = views(scene, 1)[1];
    let rest = Hit { t: -1.0, ..Hit::ESCAPED };
    for (width, height, more) in [(1, 1, 0), (1, 9, 0), (9, 1, 0), (7, 5, 3), (9, 0, 4), (0, 0, 4)] {
        let mut expected = vec![Hit::ESCAPED; (width * height) as usize];
        scene.trace_many(&rays(&camera, width, height), &mut expected, Want::default());
        let mut pictures = [vec![rest; expected.len() + more], vec![rest; expected.len() + more]];
        beams.hits(&camera, width, Want::default(), &mut pictures[0]);
        packets.hits(&camera, width, Want::default(), &mut pictures[1]);
        for hits in pictures {
            for (hit, ray) in hits.iter().zip(&expected) {
                assert!((hit.t - ray.t).abs() < 1e-9 && hit.element == ray.element, "{hit:?} {ray:?}");
            }
            // What is no whole row is left as it was.
            assert!(hits[expected.len()..].iter().all(|hit| hit.t == -1.0), "{width} x {height}");
        }
    }
}

/// Cells have upright walls: where a building leans a little, their edges are a pixel's fraction off.
#[test]
fn pictures_and_hits_on_the_edges_of_leaning_walls_are_those_of_rays() {
    let ([width, height], mut off) = (SIZE, 0);
    let bare = HouseOptions { furniture: false, ..HouseOptions::default() };
    for [x, y] in [[4e-4, -3e-4], [-7e-4, 9e-4]] {
        let mut model = house(&bare).export(&Style::default()).to_model().unwrap();
        for p in model.elements.iter_mut().flat_map(|element| &mut element.mesh.positions) {
            *p = [p[0] + x * p[2], p[1] + y * p[2], p[2] + y * p[0]];
        }
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        let (mut beams, mut packets) = (Beams::new(&scene), crate::packets::Packets::new(&scene));
        let mut unasked = Beams::new(&scene);
        unasked.kept.known.fringes = Fringes::exact(scene.tables.cells.len());
        for camera in views(&scene, 12) {
            let rays = rays(&camera, width, height);
            let mut by_rays = vec![Hit::ESCAPED; rays.len()];
            scene.trace_many_of(Starts::Anywhere, &rays, &mut by_rays, Want::default());
            let is_off = |(one, other): &(&Hit, &Hit)| {
                one.t != other.t && (one.t - other.t).abs() > 1e-9 * (1.0 + other.t)
                    || one.element != other.element
            };
            let mut hits = by_rays.clone();
            beams.hits(&camera, width, Want::default(), &mut hits);
            assert_eq!(hits.iter().zip(&by_rays).filter(is_off).count(), 0, "{camera:?}");
            packets.hits(&camera, width, Want::default(), &mut hits);
            assert_eq!(hits.iter().zip(&by_rays).filter(is_off).count(), 0, "{camera:?}");
            let count = |hits: &[Hit]| hits.iter().zip(&by_rays).filter(is_off).count();
            beams.painted_hits(&camera, width, Want::default(), &mut hits);
            assert_eq!(count(&hits), 0, "{camera:?}");
            packets.painted_hits(&camera, width, Want::default(), &mut hits);
            assert_eq!(count(&hits), 0, "{camera:?}");
            unasked.painted_hits(&camera, width, Want::default(), &mut hits);
            off += count(&hits);
        }
    }
    assert!(off > 5, "the house does not lean enough for this test: {off}");
}

/// What is on the lattice is exact: no ray is asked. What is drawn by hand is not, nor is what leans.
#[test]
fn cells_are_off_where_their_walls_are() {
    let off = |scene: &Scene| {
        let fringes = Fringes::new(scene.tables.cells.len());
        let of = |cell: u32| fringes.of(&scene.tables, cell);
        let all: Vec<f64> = (0..scene.tables.cells.len() as u32).map(|cell| of(cell).of_faces()).collect();
        // Measured once.
        assert!((0..).zip(&all).all(|(cell, &off)| of(cell).of_faces() == off));
        all
    };
    assert!(off(Sample::House.scene()).iter().all(|&off| off == 0.0));
    let drawn = Sample::House.drawn(1);
    let step = drawn.tables.scene[0].lattice_step();
    let all = off(drawn);
    assert!(all.iter().all(|&off| off == 0.0 || (0.5 * step..=1e-3).contains(&off)), "{all:?}");
    assert!(all.iter().filter(|&&off| off > 0.0).count() > all.len() / 3, "{all:?}");
}

/// Where two walls are flush, their edge is rounded to the lattice: beside it one of them is shown where the ray meets the other, as far away.
#[test]
fn pictures_and_hits_beside_the_edge_of_two_flush_walls_are_those_of_rays() {
    let mut model = ModelBuilder::new("walls", Frame { up: UpAxis::Z, ..Frame::default() });
    let material = model.material(Material::default());
    let mut add = |id: &str, semantic: Semantic, lo: [f64; 3], hi: [f64; 3]| {
        let element = model.element(NewElement { name: id.into(), ..NewElement::default() }).unwrap();
        model.semantic(element, semantic);
        let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] });
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            model.triangle(element, [a, b, c].map(corner), material).unwrap();
            model.triangle(element, [a, c, d].map(corner), material).unwrap();
        }
    };
    let edges = [1.234_567_8, 2.345_678_9, 3.456_789_1, 4.669_201_6];
    add("floor", Semantic::Ground, [-0.3, -0.3, -0.3], [6.3, 4.3, 0.0]);
    add("roof", Semantic::Roof, [-0.3, -0.3, 3.0], [6.3, 4.3, 3.3]);
    add("west", Semantic::Wall, [-0.3, 0.0, 0.0], [0.0, 4.0, 3.0]);
    add("east", Semantic::Wall, [6.0, 0.0, 0.0], [6.3, 4.0, 3.0]);
    add("south", Semantic::Wall, [-0.3, -0.3, 0.0], [6.3, 0.0, 3.0]);
    add("room", Semantic::Room, [0.0, 0.0, 0.0], [6.0, 4.0, 3.0]);
    let ends: Vec<f64> = std::iter::once(-0.3).chain(edges).chain([6.3]).collect();
    for (i, ends) in ends.windows(2).enumerate() {
        add(&format!("north {i}"), Semantic::Wall, [ends[0], 4.0, 0.0], [ends[1], 4.3, 3.0]);
    }
    let scene = compile(&model.finish().unwrap(), &CompileOptions::default()).unwrap().scene();
    assert!(scene.cells().len() > 5);
    let (mut beams, mut packets) = (Beams::new(&scene), Packets::new(&scene));
    let mut unasked = Beams::new(&scene);
    unasked.kept.known.fringes = Fringes::exact(scene.tables.cells.len());
    for (far, [width, height]) in [(3.0, [31, 9]), (3e-3, [999, 3])] {
        for edge in edges {
            let mut rounded = 0;
            for off in -8..=8 {
                // The column in the middle looks at where the wall's edge is, and so many micrometres beside.
                let eye = [edge + 1e-6 * f64::from(off) + 1e-7, 4.0 - far, 1.5];
                let camera = Camera::looking(eye, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 60.0).unwrap();
                let rays = rays(&camera, width, height);
                let mut by_rays = vec![Hit::ESCAPED; rays.len()];
                scene.trace_many_of(Starts::Anywhere, &rays, &mut by_rays, Want::LEAST);
                let elements = |hits: &[Hit]| hits.iter().map(|hit| hit.element).collect::<Vec<_>>();
                let mut hits = by_rays.clone();
                unasked.painted_hits(&camera, width, Want::LEAST, &mut hits);
                rounded += hits.iter().zip(&by_rays).filter(|(a, b)| a.element != b.element).count();
                beams.hits(&camera, width, Want::LEAST, &mut hits);
                assert_eq!(elements(&hits), elements(&by_rays), "{far} {edge} {off}");
                packets.hits(&camera, width, Want::LEAST, &mut hits);
                assert_eq!(elements(&hits), elements(&by_rays), "{far} {edge} {off}");
                beams.painted_hits(&camera, width, Want::LEAST, &mut hits);
                assert_eq!(elements(&hits), elements(&by_rays), "painted: {far} {edge} {off}");
                packets.painted_hits(&camera, width, Want::LEAST, &mut hits);
                assert_eq!(elements(&hits), elements(&by_rays), "painted: {far} {edge} {off}");
            }
            assert!(rounded > 0, "{edge}, {far} m away: it is not rounded");
        }
    }
}

/// From around the building, and from the air around it between its parts.
pub(crate) fn outside_views(scene: &Scene) -> Vec<Camera> {
    let [lo, hi] = scene.hull().map(DVec3::from);
    let (middle, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
    let ways = [[1.7, 1.2, 0.6], [-1.3, 0.4, 2.5], [0.1, -1.6, 0.2], [0.0, 0.3, 3.0]];
    let at = |way: [f64; 3]| {
        Camera::look_at(
            (middle + half * DVec3::from(way)).to_array(),
            middle.to_array(),
            [0.0, 0.1, 1.0],
            60.0,
        )
    };
    let mut views: Vec<Camera> = ways.into_iter().map(|way| at(way).unwrap()).collect();
    // Beside the ground floor's walls.
    for way in [[1.02, 0.3, -0.6], [-0.4, -1.03, -0.5]] {
        let eye = middle + half * DVec3::from(way);
        views.push(Camera::look_at(eye.to_array(), middle.to_array(), [0.0, 0.0, 1.0], 90.0).unwrap());
    }
    views
}

#[test]
fn where_the_air_around_is_cut_up_all_triangles_show_what_rays_meet() {
    for (name, scene) in scenes() {
        let views = outside_views(scene);
        for kernel in Kernel::available() {
            let mut beams = Beams::new(scene).with_kernel(kernel);
            beams.kept.is_cut_up = true;
            for camera in views.iter().take(2) {
                let (mut hits, mut expected) = (vec![Hit::ESCAPED; 1200], vec![Hit::ESCAPED; 1200]);
                beams.hits(camera, 40, Want::default(), &mut hits);
                let rays = rays(camera, 40, 30);
                scene.trace_many(&rays, &mut expected, Want::default());
                let is_same = |(a, b): &(&Hit, &Hit)| {
                    a.element == b.element && (a.t == b.t || (a.t - b.t).abs() < 1e-9)
                };
                let same = hits.iter().zip(&expected).filter(is_same).count();
                assert!(same >= 1198, "{name}: {same} of 1200 hits are those of rays");
            }
            let sum = sum(&mut beams, &views);
            assert_eq!(sum.unwritten, 0, "{name}");
            assert!(sum.ties * 20_000 <= sum.pixels, "{name}: {} ties of {}", sum.ties, sum.pixels);
            assert!(sum.wrong.is_empty(), "{name}: {} wrong, {:?}", sum.wrong.len(), sum.wrong[0]);
        }
    }
}

/// Of many pictures the later ones are drawn from polygons that were gathered before, the first cell by cell or from all triangles.
#[test]
fn many_pictures_from_outside_are_as_the_first() {
    for (name, scene) in scenes() {
        let views = outside_views(scene);
        for (kernel, is_cut_up) in
            Kernel::available().into_iter().flat_map(|kernel| [(kernel, true), (kernel, false)])
        {
            let new = || {
                let mut beams = Beams::new(scene).with_kernel(kernel);
                beams.kept.is_cut_up = is_cut_up;
                beams
            };
            let first = |camera: &Camera| {
                let mut pixels = vec![0u32; (SIZE[0] * SIZE[1]) as usize];
                let counts = new().paint(camera, SIZE[0], &mut pixels);
                (pixels, counts)
            };
            let mut beams = new();
            let mut pixels = vec![0u32; (SIZE[0] * SIZE[1]) as usize];
            for camera in views.iter().cycle().take(super::Many::few(scene) as usize) {
                beams.paint(camera, SIZE[0], &mut pixels);
            }
            assert!(beams.many.facets.is_none(), "{name}");
            for camera in &views {
                let counts = beams.paint(camera, SIZE[0], &mut pixels);
                let (expected, as_first) = first(camera);
                // Where surfaces lie on each other either may be seen.
                let others = pixels.iter().zip(&expected).filter(|(a, b)| a != b).count();
                assert!(others * 10_000 <= pixels.len(), "{name}: {others} pixels differ");
                if is_cut_up {
                    assert_eq!([counts.cells, counts.unsure], [as_first.cells, as_first.unsure], "{name}");
                    assert_eq!(counts.triangles == 0, as_first.triangles == 0, "{name}");
                }
            }
            assert!(beams.many.facets.is_some(), "{name}");
        }
    }
}

#[test]
fn within_closed_furniture_its_inside_is_seen() {
    seen_from_within_furniture(Sample::House.scene());
}

/// Of some furniture triangles are turned: those are of closed surfaces all the same, some with their front outward, some with their back.
#[test]
fn furniture_whose_triangles_do_not_agree_hides_its_backs() {
    let mut model = house(&HouseOptions::default()).export(&Style::default()).to_model().unwrap();
    let furniture = model.elements.iter_mut().filter(|element| element.semantic == Semantic::Furniture);
    for (i, triangle) in furniture.flat_map(|element| &mut element.mesh.triangles).enumerate() {
        if i * i % 7 < 3 {
            triangle.swap(1, 2);
        }
    }
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let looks = |facing: Facing| {
        let runs = scene.tables.runs.iter().filter(|run| run.facing == facing as u32);
        runs.filter(|run| scene.element(run.element).semantic() == Semantic::Furniture).count()
    };
    assert!(looks(Facing::Outward) > 5 && looks(Facing::Inward) > 5);
    seen_from_within_furniture(&scene);
    let mut beams = Beams::new(&scene);
    let sum = sum(&mut beams, &views(&scene, 12));
    assert_eq!((sum.unwritten, sum.wrong.len()), (0, 0));
}

fn seen_from_within_furniture(scene: &Scene) {
    let looks = super::shade::Looks::new(&scene.tables);
    let backs = super::backs::Backs::new(&scene.tables, &looks);
    let [width, height] = SIZE;
    let (mut beams, mut within) = (Beams::new(scene), 0);
    for element in 0..scene.elements().count() as u32 {
        let triangles = (0..scene.detail_triangle_count()).filter(|&t| scene.triangle_element(t) == element);
        let corners: Vec<DVec3> = triangles.flat_map(|t| scene.triangle(t)).map(DVec3::from).collect();
        let eye = corners.iter().sum::<DVec3>() / corners.len() as f64;
        if corners.is_empty() || !matches!(scene.locate(eye.to_array()), Place::Air { .. }) {
            continue;
        }
        within += u32::from(backs.seen_from(&scene.tables, eye).is_within_any());
        let camera = Camera::looking(eye.to_array(), [0.8, 0.5, -0.1], [0.0, 0.0, 1.0], 100.0).unwrap();
        let differences = beams.differences(&camera, width, height);
        assert_eq!(differences.unwritten, 0);
        assert!(differences.wrong.is_empty(), "{element}: {:?}", differences.wrong[0]);
    }
    assert!(within > 3, "{within}");
}

/// A triangle that reaches out of a cell through more of its sides than a few.
#[test]
fn what_reaches_out_of_a_round_room_is_seen_in_it_only() {
    let mut model = round_room(&RoundRoomOptions::default()).export(&Style::default()).to_model().unwrap();
    let all = model.elements.iter().flat_map(|element| &element.mesh.positions).map(|p| DVec3::from(*p));
    let (lo, hi) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let (middle, size) = ((lo + hi) / 2.0, (hi - lo).max_element());
    let mut curtain = model.elements[0].clone();
    (curtain.id, curtain.semantic) = ("curtain".into(), Semantic::Furniture);
    let corners = [[-3.0, 0.07, -2.0], [3.0, 0.09, -2.0], [0.3, 0.08, 4.0]];
    curtain.mesh.positions = corners.map(|corner| (middle + DVec3::from(corner) * size).to_array()).to_vec();
    curtain.mesh.triangles = vec![[0, 1, 2]];
    curtain.mesh.materials.truncate(1);
    model.elements.push(curtain);
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let sum = sum(&mut Beams::new(&scene), &views(&scene, 12));
    assert_eq!(sum.unwritten, 0);
    assert!(sum.wrong.is_empty(), "{} wrong, {:?}", sum.wrong.len(), sum.wrong[0]);
}
