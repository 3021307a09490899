//! Pictures of a small house, whose every pixel is known, and of real buildings.
#![cfg(all(feature = "compile", feature = "render"))]

use std::path::Path;

use enfilade::importers::{
    CancelToken, Frame, Limits, Material, MaterialId, Model, ModelBuilder, NewElement, Semantic, UpAxis,
    Watch,
};
use enfilade::render::{
    Camera, ColorMode, Picture, RenderError, RenderOptions, auto_view, cell_color, element_color,
    outside_view, ramp, render, room_color, room_views, semantic_color, srgb_bytes, write_exr, write_png,
};
use enfilade::{CompileOptions, NONE, Place, Ray, Scene, Start, Want, compile};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A model of boxes.
struct House {
    builder: ModelBuilder,
}

impl House {
    fn new() -> House {
        House { builder: ModelBuilder::new("house", Frame::default()) }
    }

    fn paint(&mut self, base_color: [f32; 3], alpha: f32, transmission: f32) -> MaterialId {
        self.builder.material(Material { base_color, alpha, transmission, ..Material::default() })
    }

    fn cuboid(&mut self, name: &str, semantic: Semantic, lo: [f64; 3], hi: [f64; 3], material: MaterialId) {
        let element = NewElement { name: name.into(), ..NewElement::default() };
        let element = self.builder.element(element).unwrap();
        self.builder.semantic(element, semantic);
        let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { lo[axis] } else { hi[axis] });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads {
            for triangle in [[a, b, c], [a, c, d]] {
                self.builder.triangle(element, triangle.map(corner), material).unwrap();
            }
        }
    }

    fn scene(self) -> Scene {
        let model: Model = self.builder.finish().unwrap();
        compile(&model, &CompileOptions::default()).unwrap().scene()
    }
}

/// A room of 6 x 4 x 3 m with a table, beside a closet of 1 x 4 x 3 m behind a wall, all under one roof.
fn house() -> House {
    let mut house = House::new();
    let white = house.paint([1.0; 3], 1.0, 0.0);
    let mut put = |name: &str, semantic, lo, hi| house.cuboid(name, semantic, lo, hi, white);
    put("slab", Semantic::Ground, [-0.2, -0.2, -0.2], [7.4, 4.2, 0.0]);
    put("ceiling", Semantic::Ceiling, [-0.2, -0.2, 3.0], [7.4, 4.2, 3.2]);
    put("west", Semantic::Wall, [-0.2, -0.2, 0.0], [0.0, 4.2, 3.0]);
    put("between", Semantic::Wall, [6.0, 0.0, 0.0], [6.2, 4.0, 3.0]);
    put("east", Semantic::Wall, [7.2, -0.2, 0.0], [7.4, 4.2, 3.0]);
    put("south", Semantic::Wall, [0.0, -0.2, 0.0], [7.2, 0.0, 3.0]);
    put("north", Semantic::Wall, [0.0, 4.0, 0.0], [7.2, 4.2, 3.0]);
    put("table", Semantic::Furniture, [1.0, 1.0, 0.0], [2.0, 2.0, 0.75]);
    put("closet", Semantic::Room, [6.2, 0.0, 0.0], [7.2, 4.0, 3.0]);
    put("living", Semantic::Room, [0.0, 0.0, 0.0], [6.0, 4.0, 3.0]);
    // A terrace on the roof: larger than any room, but under the sky.
    put("terrace", Semantic::Room, [-0.2, -0.2, 3.2], [7.4, 4.2, 6.2]);
    house
}

fn shot(scene: &Scene, camera: &Camera, size: u32, color: ColorMode) -> Picture {
    render(scene, camera, &RenderOptions::new(size, size, color)).unwrap()
}

fn near(a: [f32; 3], b: [f32; 3]) {
    assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-5), "{a:?} {b:?}");
}

#[test]
fn what_pixels_hold() {
    let scene = house().scene();
    // Straight at the west wall, from 2 m.
    let camera = Camera::look_at([2.0, 3.0, 1.5], [0.0, 3.0, 1.5], Z, 20.0).unwrap();
    let picture = shot(&scene, &camera, 33, ColorMode::Material);
    let middle = picture.pixel(16, 16);
    assert_eq!(middle.depth, 2.0);
    assert_eq!(middle.normal, [1.0, 0.0, 0.0]);
    assert_eq!(scene.element(middle.element).name(), "west");
    assert_eq!(middle.semantic, Semantic::Wall.number());
    assert_eq!(scene.room(middle.room).element().name(), "living");
    assert_eq!((middle.material, middle.cost), (0, 0));
    assert!(middle.triangle < scene.detail_triangle_count());
    // White, and facing the eye; a corner of the picture by its cosine.
    near(middle.color, [0.9; 3]);
    let ray = camera.ray(0, 0, 33, 33);
    let cosine = ray.direction[0].abs() / ray.direction.iter().map(|c| c * c).sum::<f64>().sqrt();
    near(picture.pixel(0, 0).color, [0.9 * cosine as f32; 3]);
    assert!((f64::from(picture.pixel(0, 0).depth) - 2.0 / cosine).abs() < 1e-6);
    assert_eq!((picture.in_solid(), picture.scale()), (None, None));

    for (mode, flat) in [
        (ColorMode::Semantic, semantic_color(Semantic::Wall.number())),
        (ColorMode::Element, element_color(middle.element)),
        (ColorMode::Room, room_color(middle.room)),
        (ColorMode::Cell, cell_color(middle.cell)),
    ] {
        near(shot(&scene, &camera, 33, mode).pixel(16, 16).color, flat);
    }
}

#[test]
fn left_is_left_and_up_is_up() {
    let scene = house().scene();
    // To the north, the west wall is on the left, the ceiling above.
    let camera = Camera::look_at([3.0, 2.0, 1.5], [3.0, 4.0, 1.5], Z, 100.0).unwrap();
    let picture = shot(&scene, &camera, 65, ColorMode::Material);
    let name = |x, y| scene.element(picture.pixel(x, y).element).name();
    assert_eq!((name(32, 0), name(32, 64)), ("ceiling", "slab"));
    let wide = Camera::look_at([3.0, 2.0, 1.5], [3.0, 4.0, 1.5], Z, 130.0).unwrap();
    let picture = shot(&scene, &wide, 65, ColorMode::Material);
    let name = |x, y| scene.element(picture.pixel(x, y).element).name();
    assert_eq!((name(0, 32), name(64, 32), name(32, 32)), ("west", "between", "north"));
}

#[test]
fn normals_are_in_the_axes_asked_for() {
    let scene = house().scene();
    let camera = Camera::look_at([3.0, 2.0, 1.5], [3.0, 2.0, 0.0], Z, 20.0).unwrap();
    let bytes = |frame: Frame| {
        let mut options = RenderOptions::new(1, 1, ColorMode::Normal);
        options.frame = frame;
        srgb_bytes(&render(&scene, &camera, &options).unwrap())
    };
    assert_eq!(bytes(Frame::default()), [128, 128, 255]);
    assert_eq!(bytes(Frame::GLTF), [128, 255, 128]);
}

#[test]
fn glass_shows_what_is_behind_it() {
    // Panes as two parallel sheets would be: boxes, so each is passed twice.
    let with = |alpha: f32, transmission: f32, tint: [f32; 3], panes: u32| {
        let mut house = House::new();
        let red = house.paint([1.0, 0.0, 0.0], 1.0, 0.0);
        let glass = house.paint(tint, alpha, transmission);
        house.cuboid("wall", Semantic::Wall, [-5.0, 5.0, -5.0], [5.0, 5.2, 5.0], red);
        for i in 0..panes {
            let y = 2.0 + 0.1 * f64::from(i);
            house.cuboid("pane", Semantic::Glass, [-5.0, y, -5.0], [5.0, y + 0.01, 5.0], glass);
        }
        let scene = house.scene();
        let camera = Camera::look_at([0.0; 3], [0.0, 1.0, 0.0], Z, 10.0).unwrap();
        let picture = shot(&scene, &camera, 1, ColorMode::Material);
        let pixel = *picture.pixel(0, 0);
        assert_eq!(pixel.depth, 2.0, "the first thing met fills the layers");
        assert_eq!(scene.element(pixel.element).name(), "pane");
        pixel.color
    };
    let blue = [0.0, 0.0, 1.0];
    // Alpha 0.25, twice: 3/4 of 3/4 of the wall, and 1/4 + 3/4 * 1/4 of the glass.
    near(with(0.25, 0.0, blue, 1), [0.9 * 0.5625, 0.0, 0.9 * 0.4375]);
    // Fully transmitting glass takes its own colour from the light, and still covers a tenth.
    let tint = [0.5, 1.0, 1.0];
    let cover = 0.9 * (0.1 + 0.9 * 0.1);
    let cover_red = 0.9 * (0.1 + 0.9 * 0.5 * 0.1) * 0.5;
    near(with(1.0, 1.0, tint, 1), [cover_red + 0.9 * 0.45 * 0.45, cover, cover]);
    // Opaque: the pane alone.
    near(with(1.0, 0.0, blue, 1), [0.0, 0.0, 0.9]);
    // A stack of panes ends after eight layers, with the ninth opaque.
    let left = 0.75f32.powi(8);
    near(with(0.25, 0.0, blue, 20), [0.0, 0.0, 0.9 * (1.0 - left) + 0.9 * left]);
}

#[test]
fn the_sky_is_light_and_has_no_element() {
    let scene = house().scene();
    let camera = Camera::look_at([0.0, -10.0, 20.0], [0.0, -20.0, 30.0], Z, 40.0).unwrap();
    for mode in ColorMode::ALL {
        let picture = shot(&scene, &camera, 4, mode);
        for pixel in picture.pixels() {
            assert!(pixel.has_escaped() && !pixel.is_in_solid());
            assert_eq!((pixel.element, pixel.semantic, pixel.material), (NONE, NONE, NONE));
            assert_eq!((pixel.room, pixel.depth, pixel.normal), (NONE, f32::INFINITY, [0.0; 3]));
        }
        let bytes = srgb_bytes(&picture);
        let (least, most) = (bytes.iter().min().unwrap(), bytes.iter().max().unwrap());
        assert!(*least > 200 && most - least < 20, "{mode}: {bytes:?}");
    }
}

#[test]
fn inside_a_solid_there_is_nothing_to_see() {
    let scene = house().scene();
    let camera = Camera::look_at([-0.1, 2.0, 1.5], [5.0, 2.0, 1.5], Z, 60.0).unwrap();
    for mode in ColorMode::ALL {
        let picture = shot(&scene, &camera, 40, mode);
        assert_eq!(scene.element(picture.in_solid().unwrap()).name(), "west");
        assert!(picture.pixels().iter().all(|p| p.is_in_solid() && p.element != NONE));
        let bytes = srgb_bytes(&picture);
        assert_eq!((&bytes[..3], &bytes[16 * 3..16 * 3 + 3]), (&[255, 0, 255][..], &[64, 0, 64][..]));
        assert_eq!(picture.scale(), None);
    }
    // On the wall's surface, within the tolerance, one looks out of it.
    let on = Camera::look_at([-0.0005, 2.0, 1.5], [5.0, 2.0, 1.5], Z, 60.0).unwrap();
    assert_eq!(shot(&scene, &on, 8, ColorMode::Material).in_solid(), None);
}

#[test]
fn ramps_of_depth_and_cost() {
    let scene = house().scene();
    let camera = Camera::look_at([3.0, 2.0, 1.5], [0.0, 1.0, 1.0], Z, 90.0).unwrap();
    let picture = shot(&scene, &camera, 64, ColorMode::Depth);
    let [far, near_end] = picture.scale().unwrap();
    let by_depth = |pick: fn(f32, f32) -> f32| picture.pixels().iter().map(|p| p.depth).reduce(pick).unwrap();
    assert_eq!((far as f32, near_end as f32), (by_depth(f32::max), by_depth(f32::min)));
    let nearest = picture.pixels().iter().find(|p| f64::from(p.depth) == near_end).unwrap();
    near(nearest.color, ramp(1.0));
    let mut options = RenderOptions::new(64, 64, ColorMode::Depth);
    options.depth_range = Some([0.0, 10.0]);
    let fixed = render(&scene, &camera, &options).unwrap();
    assert_eq!(fixed.scale(), Some([10.0, 0.0]));
    let pixel = fixed.pixel(30, 30);
    near(pixel.color, ramp(1.0 - f64::from(pixel.depth) / 10.0));

    let cost = shot(&scene, &camera, 64, ColorMode::Cost);
    assert!(cost.pixels().iter().all(|p| p.cost > 0));
    assert_eq!(cost.scale().unwrap()[0], 0.0);
    // Counting changes no answer.
    for (a, b) in cost.pixels().iter().zip(picture.pixels()) {
        assert_eq!((a.depth, a.triangle, a.room), (b.depth, b.triangle, b.room));
    }
}

#[test]
fn counted_rays_answer_as_others_do() {
    let scene = house().scene();
    for i in 0..1000 {
        let a = f64::from(i) * 0.1;
        let ray = Ray::new([3.0, 2.0, 1.0], [a.cos(), a.sin(), (a * 0.37).sin()]);
        for start in [Start::Anywhere, Start::Cell(0)] {
            let (hit, cost) = scene.trace_cost_from(start, &ray, Want::default());
            assert_eq!(hit, scene.trace_from(start, &ray, Want::default()));
            assert!(cost.cells >= 1, "{cost:?}");
            let steps = cost.nodes + cost.blocks + cost.tests + cost.cells + cost.unsure;
            assert_eq!(cost.total(), steps);
        }
    }
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_picture_at_any_number_of_threads() {
    let scene = house().scene();
    let camera = auto_view(&scene);
    let on = |threads: usize, mode| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        // A size that is no multiple of the tiles'.
        pool.install(|| render(&scene, &camera, &RenderOptions::new(101, 67, mode)).unwrap())
    };
    for mode in ColorMode::ALL {
        let one = on(1, mode);
        assert_eq!((one.width(), one.height(), one.pixels().len()), (101, 67, 101 * 67));
        assert_eq!(one, on(2, mode));
        assert_eq!(one, on(7, mode));
    }
}

#[test]
fn every_pixel_is_its_own_ray() {
    let scene = house().scene();
    let camera = auto_view(&scene);
    let picture = render(&scene, &camera, &RenderOptions::new(37, 21, ColorMode::Material)).unwrap();
    for y in 0..21 {
        for x in 0..37 {
            let hit = scene.trace(&camera.ray(x, y, 37, 21)).record();
            let pixel = picture.pixel(x, y);
            assert_eq!((pixel.depth, pixel.triangle), (hit.t as f32, hit.triangle), "{x} {y}");
        }
    }
}

#[test]
fn pictures_that_cannot_be_made() {
    let scene = house().scene();
    let camera = auto_view(&scene);
    let make = |options: &RenderOptions| render(&scene, &camera, options).unwrap_err();
    assert_eq!(make(&RenderOptions::new(0, 5, ColorMode::Material)), RenderError::Empty(0, 5));
    let huge = RenderOptions::new(u32::MAX, u32::MAX, ColorMode::Material);
    assert!(matches!(make(&huge), RenderError::OverBudget(_)));
    let mut small = RenderOptions::new(100, 100, ColorMode::Material);
    small.limits = Limits::default().with_max_memory(10_000);
    assert!(make(&small).to_string().contains("the picture"));
    let token = CancelToken::new();
    token.cancel();
    let mut cancelled = RenderOptions::new(10, 10, ColorMode::Material);
    cancelled.watch = Watch::default().with_cancel(token);
    assert!(matches!(make(&cancelled), RenderError::Cancelled(_)));
}

#[test]
fn png_holds_the_colours() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    let scene = house().scene();
    let options = RenderOptions::new(40, 30, ColorMode::Semantic);
    let picture = render(&scene, &outside_view(&scene), &options).unwrap();
    write_png(&picture, &path).unwrap();
    let read = image::open(&path).unwrap().to_rgb8();
    assert_eq!(read.dimensions(), (40, 30));
    assert_eq!(read.into_raw(), srgb_bytes(&picture));
    let error = write_png(&picture, &folder.path().join("none").join("a.png")).unwrap_err();
    assert!(error.to_string().contains("a.png"));
    assert_eq!(error.error.kind(), std::io::ErrorKind::NotFound);
}

/// Channels of an OpenEXR file, by name.
fn read_exr(path: &Path) -> (usize, usize, Vec<(String, exr::prelude::FlatSamples)>) {
    use exr::prelude::{ReadChannels, ReadLayers, read};
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let layer = image.from_file(path).unwrap().layer_data;
    let channels = layer.channel_data.list.into_iter();
    (layer.size.0, layer.size.1, channels.map(|c| (c.name.to_string(), c.sample_data)).collect())
}

#[test]
fn exr_holds_everything() {
    use exr::prelude::FlatSamples;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.exr");
    let scene = house().scene();
    // Escaped rays and hits; millimetres and Y up.
    let options = RenderOptions::new(45, 33, ColorMode::Material);
    let picture = render(&scene, &outside_view(&scene), &options).unwrap();
    assert!(
        picture.pixels().iter().any(|p| p.has_escaped()) && !picture.pixels().iter().all(|p| p.has_escaped())
    );
    let frame = Frame { unit: 0.001, up: UpAxis::Y, offset: [0.0; 3] };
    write_exr(&picture, &path, &frame).unwrap();
    let (width, height, channels) = read_exr(&path);
    assert_eq!((width, height), (45, 33));
    let names: Vec<&str> = channels.iter().map(|c| c.0.as_str()).collect();
    assert_eq!(
        names,
        ["B", "G", "N.X", "N.Y", "N.Z", "R", "Z", "cell", "element", "material", "room", "semantic"]
    );
    for (name, samples) in &channels {
        for (i, pixel) in picture.pixels().iter().enumerate() {
            let normal = frame.direction_to_source(pixel.normal.map(f64::from)).map(|c| c as f32);
            match samples {
                FlatSamples::F32(values) => {
                    let expected = match name.as_str() {
                        "R" => pixel.color[0],
                        "G" => pixel.color[1],
                        "B" => pixel.color[2],
                        "Z" => (f64::from(pixel.depth) / 0.001) as f32,
                        "N.X" => normal[0],
                        "N.Y" => normal[1],
                        _ => normal[2],
                    };
                    assert_eq!(values[i], expected, "{name} {i}");
                }
                FlatSamples::U32(values) => {
                    let expected = match name.as_str() {
                        "element" => pixel.element,
                        "material" => pixel.material,
                        "room" => pixel.room,
                        "cell" => pixel.cell,
                        _ => pixel.semantic,
                    };
                    assert_eq!(values[i], expected, "{name} {i}");
                }
                FlatSamples::F16(_) => panic!("{name} is no f32"),
            }
        }
    }
    // The same picture, the same bytes.
    let again = folder.path().join("again.exr");
    write_exr(&picture, &again, &frame).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), std::fs::read(&again).unwrap());
    let error = write_exr(&picture, &folder.path().join("none").join("a.exr"), &frame).unwrap_err();
    assert!(error.to_string().contains("a.exr"));

    // In a solid the depth is NaN, which must survive too.
    let inside = Camera::look_at([-0.1, 2.0, 1.5], [5.0, 2.0, 1.5], Z, 60.0).unwrap();
    write_exr(&shot(&scene, &inside, 4, ColorMode::Material), &path, &frame).unwrap();
    let depth = read_exr(&path).2.into_iter().find(|c| c.0 == "Z").unwrap().1;
    assert!(
        matches!(depth, FlatSamples::F32(values) if values.len() == 16 && values.iter().all(|v| v.is_nan()))
    );
}

#[test]
fn auto_view_stands_in_the_largest_room_under_a_roof() {
    let scene = house().scene();
    let camera = auto_view(&scene);
    let Place::Air { room: Some(room), .. } = scene.locate(camera.eye()) else { panic!("{camera:?}") };
    assert_eq!(scene.room(room).element().name(), "living");
    assert!((camera.eye()[2] - 1.6).abs() < 1e-3, "{camera:?}");
    assert_eq!((camera.forward()[2], camera.up()), (0.0, Z));
    let picture = shot(&scene, &camera, 64, ColorMode::Room);
    assert!(picture.pixels().iter().filter(|p| p.room == room).count() > 64 * 64 * 9 / 10);
    assert!(picture.pixels().iter().all(|p| p.depth > 0.29));
    assert_eq!(camera, auto_view(&scene));
}

#[test]
fn room_views_stand_near_the_middle_of_each_room() {
    let scene = house().scene();
    let views = room_views(&scene, 4);
    assert_eq!(views.len(), 12);
    for (views, room) in views.chunks(4).zip(scene.rooms()) {
        let [lo, hi] = room.bounds();
        for view in views {
            let eye = view.eye();
            assert_eq!(eye, views[0].eye());
            assert!((0..2).all(|i| (eye[i] - (lo[i] + hi[i]) / 2.0).abs() < 0.2), "{eye:?}");
            assert!((eye[2] - lo[2] - 1.6).abs() < 1e-3, "{eye:?}");
        }
        // The first into a corner, the others a quarter turn on each.
        let forward: Vec<[f64; 3]> = views.iter().map(Camera::forward).collect();
        let slope = (hi[1] - lo[1]) / (hi[0] - lo[0]);
        assert!((forward[0][1] / forward[0][0] - slope).abs() < 1e-9 && forward[0][0] > 0.0);
        for (a, b) in forward.iter().zip(&forward[1..]) {
            assert!((a[0] - b[1]).abs() < 1e-9 && (a[1] + b[0]).abs() < 1e-9 && b[2] == 0.0, "{a:?} {b:?}");
        }
    }
    assert!(room_views(&scene, 0).is_empty());
}

#[test]
fn outside_view_fits() {
    let scene = house().scene();
    let picture = shot(&scene, &outside_view(&scene), 100, ColorMode::Material);
    let met: Vec<(usize, usize)> = (0..100)
        .flat_map(|y| (0..100).map(move |x| (x, y)))
        .filter(|&(x, y)| !picture.pixel(x as u32, y as u32).has_escaped())
        .collect();
    let least = |of: fn(&(usize, usize)) -> usize| met.iter().map(of).min().unwrap();
    let most = |of: fn(&(usize, usize)) -> usize| met.iter().map(of).max().unwrap();
    let (left, right, top, bottom) = (least(|p| p.0), most(|p| p.0), least(|p| p.1), most(|p| p.1));
    // A margin all around, and in one direction no more than that.
    assert!(left >= 1 && right <= 98 && top >= 1 && bottom <= 98, "{left} {right} {top} {bottom}");
    assert!((left <= 4 && right >= 95) || (top <= 4 && bottom >= 95), "{left} {right} {top} {bottom}");
}

#[test]
fn scenes_without_rooms_are_seen_from_outside() {
    let mut house = House::new();
    let white = house.paint([1.0; 3], 1.0, 0.0);
    house.cuboid("block", Semantic::Unknown, [0.0; 3], [2.0, 1.0, 1.0], white);
    let scene = house.scene();
    assert_eq!(auto_view(&scene), outside_view(&scene));
    assert!(room_views(&scene, 4).is_empty());
    let picture = shot(&scene, &auto_view(&scene), 32, ColorMode::Element);
    assert!(picture.pixels().iter().filter(|p| !p.has_escaped()).count() > 200);
}

#[cfg(feature = "gltf")]
#[test]
fn views_of_real_buildings_show_rooms() {
    use enfilade::importers::{ImportOptions, import};
    let Some(folder) = std::env::var_os("ENFILADE_BUILDINGS") else {
        println!("SKIPPED: ENFILADE_BUILDINGS is not set");
        return;
    };
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "glb"));
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let name = file.display();
        let model = import(&file, &ImportOptions::default()).unwrap();
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        let camera = auto_view(&scene);
        let Place::Air { room: Some(room), .. } = scene.locate(camera.eye()) else {
            panic!("{name}: {camera:?}")
        };
        let picture = shot(&scene, &camera, 96, ColorMode::Material);
        let share = |test: &dyn Fn(&enfilade::render::Pixel) -> bool| {
            picture.pixels().iter().filter(|p| test(p)).count() as f64 / picture.pixels().len() as f64
        };
        assert!(share(&|p| p.room == room) > 0.4, "{name}: the room is seen");
        assert!(share(&|p| p.has_escaped()) < 0.2, "{name}: from within");
        assert!(share(&|p| p.depth < 1.0) < 0.2, "{name}: nothing stands in the way");
        let bytes = srgb_bytes(&picture);
        let mean = bytes.iter().map(|&b| f64::from(b)).sum::<f64>() / bytes.len() as f64;
        assert!((60.0..230.0).contains(&mean), "{name}: neither black nor white: {mean}");

        let outside = shot(&scene, &outside_view(&scene), 96, ColorMode::Material);
        let met = outside.pixels().iter().filter(|p| !p.has_escaped()).count();
        assert!(met > 96 * 96 / 10, "{name}: {met} pixels");

        let rooms = scene.rooms().filter(|room| room.is_closed()).count();
        let views = room_views(&scene, 1);
        assert!(views.len() * 10 >= rooms * 9, "{name}: {} views of {rooms} rooms", views.len());
        for view in &views {
            assert!(matches!(scene.locate(view.eye()), Place::Air { .. }), "{name}: {view:?}");
        }
    }
}
