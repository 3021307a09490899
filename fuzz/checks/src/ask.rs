//! Everything that a program may ask of an opened scene.

use std::hint::black_box;

use enfilade::beam::Beams;
use enfilade::closing::{ClosingError, Stand};
use enfilade::export::{cells_glb, faces_obj, graph_dot, graph_json};
use enfilade::packets::Packets;
use enfilade::render::Camera;
use enfilade::validate::validate;
use enfilade::{Answer, Hit, Kernel, NONE, Place, Ray, Scene, Start, Want};
use enfilade_testing::Random;

/// Rays of each kind.
const RAYS: usize = 12;

/// Where a scene comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// From the compiler: all kernels must give the same answers.
    Compiled,
    /// From a file that anybody may have made: its boxes need not hold its triangles, and kernels may differ.
    Opened,
}

/// Reads all tables of `scene`, locates points, traces rays, exports it, and traces rays again with its openings closed and opened. The
/// scene was opened, so all of it must end, and every index in an answer must be one of the scene's.
pub fn everything(scene: &mut Scene, origin: Origin) {
    tables(scene);
    exports(scene);
    traces(scene, origin);
    pictures(scene);
    if close(scene) {
        exports(scene);
        traces(scene, origin);
        pictures(scene);
    }
}

/// Pictures by beams and by packets, from anywhere.
fn pictures(scene: &Scene) {
    /// Columns and rows.
    const SIZE: [u32; 2] = [24, 17];
    let ([width, height], mut random) = (SIZE, Random::new(9));
    let (mut beams, mut packets) = (Beams::new(scene), Packets::new(scene));
    let mut pixels = vec![0; (width * height) as usize];
    let mut hits = vec![Hit::ESCAPED; pixels.len()];
    for _ in 0..4 {
        let ray = ray(scene, &mut random);
        let Ok(camera) = Camera::looking(ray.origin, ray.direction, [0.0, 0.0, 1.0], 75.0) else { continue };
        for by_beams in [true, false] {
            pixels.fill(0);
            if by_beams {
                beams.paint(&camera, width, &mut pixels);
                beams.hits(&camera, width, Want::default(), &mut hits);
            } else {
                packets.paint(&camera, width, &mut pixels);
                packets.hits(&camera, width, Want::default(), &mut hits);
            }
            assert!(pixels.iter().all(|pixel| pixel >> 24 == 0xff), "each is painted");
            for (index, hit) in (0..).zip(&hits) {
                record(scene, &camera.ray(index % width, index / width, width, height), hit);
            }
        }
    }
}

/// Its graph, and all that is written of it.
fn exports(scene: &Scene) {
    let graph = scene.graph();
    assert_eq!(graph.rooms.len(), scene.rooms().len());
    black_box(graph_json(scene, &graph).len() + graph_dot(scene, &graph).len());
    black_box(faces_obj(scene, None).len() + cells_glb(scene, 0.2).len());
}

/// Closes and opens what can be; false if nothing can.
fn close(scene: &mut Scene) -> bool {
    let ways = [Stand::SEALED, Stand::CLOSED, Stand::FREE];
    let mut any = false;
    for (element, stand) in (0..scene.element_count()).zip(ways.iter().cycle()) {
        let before = scene.closures().len();
        match scene.set_stands(&[(element, *stand)]) {
            Ok(()) => any = true,
            Err(ClosingError::NoElement(_)) => panic!("element {element} is there"),
            Err(_) => assert_eq!(scene.closures().len(), before),
        }
    }
    any
}

fn traces(scene: &Scene, origin: Origin) {
    if let Ok(Some(building)) = scene.building() {
        let (valid, report) = validate(building);
        assert_eq!(valid.is_some(), !report.is_fatal());
    }
    let mut random = Random::new(7);
    for _ in 0..RAYS {
        let ray = ray(scene, &mut random);
        place(scene, scene.locate(ray.origin));
        let is_hit = !matches!(scene.trace(&ray), Answer::Escaped);
        black_box((scene.occluded(&ray), is_hit));
        for start in [Start::Anywhere, Start::Cell(0)] {
            let mut answers = Vec::new();
            for kernel in Kernel::available() {
                let hit = scene.trace_with(kernel, start, &ray, Want::default());
                record(scene, &ray, &hit);
                go_on(scene, kernel, &ray, &hit);
                answers.push(hit.answer());
            }
            let agree = answers.windows(2).all(|pair| pair[0] == pair[1]);
            assert!(agree || origin == Origin::Opened, "{ray:?}: {answers:?}");
        }
        black_box(scene.trace_cost_from(Start::Anywhere, &ray, Want::LEAST));
    }
    let rays: Vec<Ray> = (0..RAYS).map(|_| ray(scene, &mut random)).collect();
    let mut hits = vec![Hit::ESCAPED; RAYS];
    scene.trace_many(&rays, &mut hits, Want::default());
    for (ray, hit) in rays.iter().zip(&hits) {
        record(scene, ray, hit);
        // To the last bit, of what the compiler made.
        let single = scene.trace_from(Start::Anywhere, ray, Want::default());
        let agree = hit.t.to_bits() == single.t.to_bits()
            && (hit.triangle, hit.cell, hit.room) == (single.triangle, single.cell, single.room);
        assert!(agree || origin == Origin::Opened, "{ray:?}: {hit:?} {single:?}");
    }
}

/// A ray from a hit, mirrored and through.
fn go_on(scene: &Scene, kernel: Kernel, ray: &Ray, hit: &Hit) {
    let Answer::Hit(first) = hit.answer() else { return };
    let turned = [0, 1, 2].map(|axis| ray.direction[axis] + 2.0 * first.normal[axis]);
    for direction in [ray.direction, turned] {
        let next = Ray::new(first.point, direction);
        record(scene, &next, &scene.trace_with(kernel, Start::Hit(&first), &next, Want::default()));
    }
}

/// A ray by one of many ways: anywhere in the hull, far outside, to a vertex, along an axis, a segment, none at all.
fn ray(scene: &Scene, random: &mut Random) -> Ray {
    let [lo, hi] = scene.hull();
    let share = |random: &mut Random| random.below(1025) as f64 / 1024.0;
    let point = |random: &mut Random| [0, 1, 2].map(|axis| lo[axis] + (hi[axis] - lo[axis]) * share(random));
    let corner = |random: &mut Random| match scene.detail_triangle_count() {
        0 => point(random),
        count => scene.triangle(random.below(count as usize) as u32)[random.below(3)],
    };
    let to = |from: [f64; 3], to: [f64; 3]| [0, 1, 2].map(|axis| to[axis] - from[axis]);
    let from = match random.below(4) {
        0 => corner(random),
        1 => point(random).map(|c| c * 3.0 + 1.0),
        _ => point(random),
    };
    let direction = match random.below(4) {
        0 => *random.pick(&[[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]),
        1 => to(from, corner(random)),
        _ => to(from, point(random)),
    };
    match random.below(8) {
        0 => Ray::segment(from, direction, share(random), 2.0),
        1 => Ray::segment(from, direction, 1e300, f64::INFINITY),
        _ => Ray::new(from, direction),
    }
}

fn place(scene: &Scene, place: Place) {
    match place {
        Place::InSolid(element) => assert!(element < scene.element_count()),
        Place::Air { cell, room, .. } => {
            assert!((cell as usize) < scene.cells().len());
            assert!(room.is_none_or(|room| (room as usize) < scene.rooms().len()));
        }
        Place::Outside => {}
    }
}

/// Checks that an answer's indices are the scene's, and its distance the ray's.
fn record(scene: &Scene, ray: &Ray, hit: &Hit) {
    match hit.answer() {
        Answer::Escaped => {}
        Answer::InSolid(element) => assert!(element < scene.element_count()),
        Answer::Hit(hit) => {
            assert!(hit.element < scene.element_count());
            let is_sheet = scene.closed_by(hit.triangle).is_some_and(|own| own < scene.element_count());
            assert!(hit.triangle < scene.detail_triangle_count() || is_sheet);
            assert!((hit.material as usize) < scene.materials().len());
            assert!((hit.cell as usize) < scene.cells().len());
            assert!(hit.room == NONE || (hit.room as usize) < scene.rooms().len());
            assert!(hit.t.is_finite() && hit.t >= ray.tmin.max(0.0) && hit.t <= ray.tmax, "{ray:?} {hit:?}");
            assert!(hit.point.iter().chain(&hit.normal).all(|c| c.is_finite()), "{ray:?} {hit:?}");
        }
    }
}

/// Reads every text and record.
fn tables(scene: &Scene) {
    black_box((scene.frame(), scene.tolerance(), scene.traits(), scene.provenance().len()));
    for e in scene.elements() {
        black_box([e.id(), e.name(), e.path(), e.class(), e.storey()].map(str::len));
        black_box((e.semantic(), e.role(), e.triangle_count()));
        for other in [e.host(), e.filling(), e.opening()].into_iter().flatten() {
            black_box(scene.element(other).index());
        }
    }
    for room in scene.rooms() {
        black_box((room.element().index(), room.bounds(), room.volume(), room.floor_area()));
    }
    let names = scene.materials().iter().map(|m| m.name);
    let names = names.chain(scene.lights().iter().map(|l| l.name));
    for name in names.chain(scene.cameras().iter().map(|c| c.name)) {
        black_box(scene.text(name).len());
    }
    for triangle in 0..scene.detail_triangle_count() {
        black_box(scene.triangle(triangle));
    }
}
