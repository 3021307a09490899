//! Walks from cell to cell through random partitions, against the truth.
#![cfg(feature = "compile")]

use crate::common;

use common::enf;
use common::prisms::{Made, Style, make};
use enfilade::importers::Untagged;
use enfilade::lattice::{Plane, Point};
use enfilade::oracle::{RayKind, RaySource, Truth, TruthOptions};
use enfilade::partition::cells::{Cover, Label, NONE, Partition};
use enfilade::roles::roles;
use enfilade::verify::VerifyReport;
use enfilade::{
    Answer, CompileError, CompileOptions, Kernel, Place, Ray, Scene, Start, VerifyOptions, Want, compile,
    compile_partition, verify,
};
use enfilade_testing::Random;

const BOXES: Style = Style {
    cuts: [4, 4, 3],
    oblique: 0.0,
    sloped: 0.0,
    solid: 0.45,
    joins: 40,
    moved: 0.0,
    furniture: 30,
    around: 0,
    grain: 1 << 13,
    strips: 1,
};

/// Partitions that are just as the model is.
const EXACT: [(&str, Style); 6] = [
    ("boxes", BOXES),
    ("few numbers", Style { grain: 1 << 16, furniture: 0, ..BOXES }),
    ("triangles", Style { oblique: 0.6, ..BOXES }),
    ("slopes", Style { sloped: 0.8, ..BOXES }),
    ("far things", Style { oblique: 0.3, sloped: 0.3, around: 40, ..BOXES }),
    ("strips", Style { oblique: 0.3, sloped: 0.3, strips: 10, ..BOXES }),
];

/// Partitions whose model has all corners off the lattice, so that its solids overlap and have cracks between them.
const ROUNDED: [(&str, Style); 3] = [
    ("boxes off the lattice", Style { moved: 0.49, grain: 1, ..BOXES }),
    ("triangles off the lattice", Style { oblique: 0.6, moved: 0.49, grain: 1, ..BOXES }),
    (
        "slopes and triangles off the lattice",
        Style { oblique: 0.5, sloped: 0.7, moved: 0.49, grain: 1, ..BOXES },
    ),
];

fn random_made(style: &Style, seed: u64) -> Made {
    make(&mut Random::new(seed * 77 + 1), style)
}

fn compiled(made: &Made) -> Scene {
    compile_partition(&made.model, made.partition.clone(), &CompileOptions::default()).unwrap().scene()
}

fn whole(made: &Made) -> Scene {
    let mut options = CompileOptions::default();
    options.cells = false;
    compile(&made.model, &options).unwrap().scene()
}

fn truth(made: &Made) -> Truth {
    let roles = roles(&made.model, Untagged::default());
    Truth::new(&made.model, |e| roles[e.0 as usize], &TruthOptions::default())
}

fn verified(made: &Made, scene: &Scene, rays: u64, seed: u64) -> VerifyReport {
    let roles = roles(&made.model, Untagged::default());
    let mut options = VerifyOptions::default().with_rays(rays).with_grid_rays(100).with_seed(seed);
    options.cases = 1000;
    verify(&made.model, |e| roles[e.0 as usize], scene, &options).unwrap()
}

#[test]
fn exact_partitions_answer_right() {
    for (name, style) in EXACT {
        for seed in 0..2 {
            let made = random_made(&style, seed);
            let scene = compiled(&made);
            let report = verified(&made, &scene, 6000, seed);
            println!("{name} {seed}: {} cells, {:?}", scene.cells().len(), report.total);
            assert!(scene.cells().len() > 50 && report.total.hits > 1000);
            assert!(report.wrong.is_empty(), "{name} {seed}: {:?}", report.wrong);
            assert!(
                report.sight.different == 0 && report.sight.rays > 0,
                "{name} {seed}: {:?}",
                report.sight
            );
            assert!(report.excused <= enfilade::verify::MOST_EXCUSED, "{name} {seed}: {}", report.excused);
            assert!(report.forward.p99 <= 1e-9, "{name} {seed}: {:?}", report.forward);
        }
    }
}

#[test]
fn rounded_partitions_answer_right() {
    for (name, style) in ROUNDED {
        for seed in 0..2 {
            let made = random_made(&style, seed);
            let report = verified(&made, &compiled(&made), 6000, seed);
            println!("{name} {seed}: {:?}", report.total);
            assert!(report.wrong.is_empty(), "{name} {seed}: {:?}", report.wrong);
            assert!(
                report.sight.different == 0 && report.sight.rays > 0,
                "{name} {seed}: {:?}",
                report.sight
            );
            assert!(report.excused <= enfilade::verify::MOST_EXCUSED, "{name} {seed}: {}", report.excused);
            assert!(report.forward.p99 <= 1e-9, "{name} {seed}: {:?}", report.forward);
        }
    }
}

/// Rays of all kinds, and some between corners of cells and along their axes.
fn rays(made: &Made, count: u64, seed: u64) -> Vec<Ray> {
    let truth = truth(made);
    let source = RaySource::new(&truth, seed).with_rooms(&made.model);
    let kinds = [RayKind::Room, RayKind::Outside, RayKind::Box, RayKind::Hard];
    let mut rays: Vec<Ray> = (0..count).map(|i| source.ray(kinds[i as usize % 4], i)).collect();
    let mut random = Random::new(seed);
    let partition = &made.partition;
    let corner = |random: &mut Random| {
        let cell = &partition.cells[random.below(partition.cells.len())];
        let at = partition.footprint(cell).nth(random.below(cell.sections.len())).unwrap();
        let plane = partition.planes[if random.below(2) == 0 { cell.floor } else { cell.ceiling } as usize];
        let z = plane.height_f64(f64::from(at.x), f64::from(at.y));
        let local = [f64::from(at.x), f64::from(at.y), z];
        partition.lattice.metres(local)
    };
    for i in 0..count {
        let (from, to) = (corner(&mut random), corner(&mut random));
        let direction = [0, 1, 2].map(|axis| to[axis] - from[axis]);
        let direction = if direction == [0.0; 3] || i % 4 == 0 {
            *[[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
                .get(random.below(4))
                .unwrap()
        } else {
            direction
        };
        rays.push(Ray::new(from, direction));
    }
    rays
}

#[test]
fn cells_answer_most_rays_and_all_kernels_agree() {
    for (name, style) in EXACT.iter().chain(&ROUNDED) {
        let made = random_made(style, 11);
        let scene = compiled(&made);
        let (mut crossed, mut random, mut unsure) = (0, 0, 0);
        // Of the first, three of four are random rays.
        for (i, ray) in rays(&made, 1500, 3).into_iter().enumerate() {
            let (hit, cost) = scene.trace_cost_from(Start::Anywhere, &ray, Want::default());
            crossed += cost.cells;
            if i < 1500 && i % 4 != 3 && !matches!(hit.answer(), Answer::InSolid(_)) {
                (random, unsure) = (random + 1, unsure + cost.unsure.min(1));
            }
            for kernel in Kernel::available() {
                let other = scene.trace_with(kernel, Start::Anywhere, &ray, Want::default());
                assert_eq!(hit.answer(), other.answer(), "{name}: {ray:?}");
            }
            assert_eq!(scene.occluded(&ray), hit.answer() != Answer::Escaped, "{name}: {ray:?}");
            if let Answer::Hit(hit) = hit.answer() {
                let cell = &scene.cells()[hit.cell as usize];
                assert!(hit.cell == 0 || cell.kind == 1, "{name}: {ray:?}: {hit:?} in matter");
                assert!(hit.cell == 0 || hit.room == cell.room);
                let size = ray.direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                let across: f64 = (0..3).map(|i| ray.direction[i] * hit.normal[i]).sum::<f64>() / size;
                if across.abs() < 0.05 {
                    // Along a surface that is rounded, the cell may end before.
                    continue;
                }
                let near = |axis: usize| {
                    let c = made.partition.lattice.local(hit.point)[axis] * made.partition.lattice.step();
                    c >= cell.bounds[0][axis] - 2e-3 && c <= cell.bounds[1][axis] + 2e-3
                };
                assert!(hit.cell == 0 || (0..3).all(near), "{name}: {ray:?}: {hit:?} outside {cell:?}");
            }
        }
        println!("{name}: {crossed} cells crossed, of {random} random rays {unsure} by all triangles");
        assert!(crossed > 1000, "{name}");
        assert!(unsure * 20 <= random, "{name}: {unsure} of {random}");
    }
}

/// The parts of a ray answer as the ray does, and what lies before a hit is free.
#[test]
fn segments_end_where_they_end() {
    for (name, style) in &EXACT {
        let made = random_made(style, 5);
        let scene = compiled(&made);
        for ray in rays(&made, 400, 9) {
            let Answer::Hit(hit) = scene.trace(&ray) else { continue };
            if hit.t < 1e-3 {
                continue;
            }
            let until = |t: f64| Ray::segment(ray.origin, ray.direction, 0.0, t);
            assert_eq!(scene.trace(&until(hit.t + 1e-6)), Answer::Hit(hit), "{name}: {ray:?}");
            assert!(scene.occluded(&until(hit.t + 1e-6)), "{name}: {ray:?}");
            assert!(!scene.occluded(&until(hit.t - 1e-4)), "{name}: {ray:?}");
        }
    }
}

#[test]
fn rays_go_on_from_hits_as_without_cells() {
    let (mut same, mut all) = (0, 0);
    for (name, style) in &EXACT[..5] {
        let made = random_made(style, 2);
        let (scene, whole) = (compiled(&made), whole(&made));
        let mut random = Random::new(8);
        let truth = truth(&made);
        let source = RaySource::new(&truth, 4).with_rooms(&made.model);
        let kinds = [RayKind::Room, RayKind::Outside, RayKind::Box];
        for ray in (0..900).map(|i| source.ray(kinds[i as usize % 3], i)) {
            let first = whole.trace_from(Start::Anywhere, &ray, Want::LEAST);
            let mine = scene.trace_from(Start::Anywhere, &ray, Want::LEAST);
            if first.element != mine.element || (first.t - mine.t).abs() > 1e-9 || !mine.t.is_finite() {
                continue;
            }
            let along: f64 = (0..3).map(|i| ray.direction[i] * mine.normal[i]).sum();
            let mirrored = [0, 1, 2].map(|i| ray.direction[i] - 2.0 * along * mine.normal[i]);
            let mut diffuse = random.direction();
            if (0..3).map(|i| diffuse[i] * mine.normal[i]).sum::<f64>() < 0.0 {
                diffuse = diffuse.map(|c| -c);
            }
            for direction in [mirrored, diffuse] {
                let next = Ray::new(mine.point, direction);
                let (a, b) = (
                    scene.trace_from(Start::Hit(&mine), &next, Want::LEAST),
                    whole.trace_from(Start::Hit(&first), &next, Want::LEAST),
                );
                all += 1;
                let ok = a.t == b.t || (a.t - b.t).abs() <= 1e-7;
                if !ok {
                    println!("{name} {next:?}\n    {a:?}\n    {b:?}\n    {mine:?}");
                }
                same += u64::from(ok);
            }
        }
        println!("{name}: {same} of {all}");
    }
    // Those that begin or end in an edge may differ.
    assert!(all > 1500 && same * 100 >= all * 97, "{same} of {all}");
}

#[test]
fn points_are_in_the_cells_that_hold_them() {
    for (name, style) in EXACT.iter().chain(&ROUNDED) {
        let made = random_made(style, 7);
        let (scene, partition) = (compiled(&made), &made.partition);
        let mut random = Random::new(6);
        for _ in 0..3000 {
            let corner = |i: usize| partition.lattice.metres(partition.hull[i].map(f64::from));
            let point = random.point(corner(0), corner(1));
            let holders: Vec<u32> =
                (0..partition.cells.len() as u32).filter(|&i| holds(partition, i as usize, point)).collect();
            let [holder] = holders[..] else { panic!("{name}: {point:?} is in {holders:?}") };
            match scene.locate(point) {
                Place::Air { cell, .. } => assert_eq!(cell, holder + 1, "{name}: {point:?}"),
                Place::InSolid(element) => {
                    assert_eq!(scene.cells()[holder as usize + 1].element, element, "{name}: {point:?}");
                }
                Place::Outside => panic!("{name}: {point:?}"),
            }
        }
    }
}

/// Whether a cell holds a point, by the sides of its edges and the heights of its planes.
fn holds(partition: &Partition, cell: usize, point: [f64; 3]) -> bool {
    let cell = &partition.cells[cell];
    let [x, y, z] = partition.lattice.local(point);
    let over = |plane: u32| z - partition.planes[plane as usize].height_f64(x, y);
    let corners: Vec<Point> = partition.footprint(cell).collect();
    over(cell.floor) >= 0.0
        && over(cell.ceiling) < 0.0
        && (0..corners.len()).all(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
            let (ex, ey) = (f64::from(b.x) - f64::from(a.x), f64::from(b.y) - f64::from(a.y));
            ex * (y - f64::from(a.y)) - ey * (x - f64::from(a.x)) >= 0.0
        })
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_bytes_at_any_number_of_threads() {
    let made = random_made(&EXACT[4].1, 1);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            compile_partition(&made.model, made.partition.clone(), &CompileOptions::default()).unwrap()
        })
    };
    let (one, two) = (on(1), on(2));
    assert!(one.bytes == two.bytes);
    let out: u64 = one.report.triangles_out.iter().map(|row| row.count).sum();
    assert_eq!(one.report.triangles_in, out);
}

#[test]
fn partitions_that_contradict_themselves_are_refused() {
    let made = random_made(&EXACT[3].1, 1);
    let refused = |change: &dyn Fn(&mut Partition)| {
        let mut partition = made.partition.clone();
        change(&mut partition);
        match compile_partition(&made.model, partition, &CompileOptions::default()) {
            Err(CompileError::Partition(what)) => what,
            other => panic!("{:?}", other.map(|_| ())),
        }
    };
    assert!(refused(&|p| p.cells[3].floor = 1 << 20).contains("cell 3"));
    assert!(refused(&|p| p.cells[3].sections.end = 1 << 20).contains("sections"));
    assert!(refused(&|p| p.cells[3].sections.end = p.cells[3].sections.start + 2).contains("prism"));
    assert!(refused(&|p| p.sections.swap(0, 1)).contains("footprint"));
    assert!(refused(&|p| p.sections[0].start.x = i32::MIN).contains("beyond the lattice"));
    assert!(refused(&|p| p.sections[0].faces.end = p.sections[0].faces.start).contains("face"));
    assert!(refused(&|p| p.faces[0].top = 1 << 20).contains("plane"));
    assert!(refused(&|p| p.faces[0].cover.cell = 1 << 20).contains("is not there"));
    assert!(refused(&|p| p.sources[0].triangles.clear()).contains("source 0"));
    assert!(refused(&|p| p.sources[0].triangles[0].1 = 1 << 20).contains("source 0"));
    assert!(refused(&|p| p.lattice.bits = 40).contains("lattice"));
    assert!(refused(&|p| p.planes[0] = Plane { p: 1 << 60, q: 0, r: 0 }).contains("steep"));
    assert!(refused(&|p| p.hull[1][0] = i32::MIN).contains("hull"));
    assert!(refused(&|p| p.detail.push((enfilade::importers::ElementId(NONE), 0))).contains("triangle"));
}

/// Any bytes: opening fails, or tracing ends.
#[test]
fn damaged_cells_are_refused_or_harmless() {
    let made = random_made(&Style { cuts: [2, 2, 2], furniture: 20, ..EXACT[5].1 }, 3);
    let file =
        compile_partition(&made.model, made.partition.clone(), &CompileOptions::default()).unwrap().bytes;
    let names = [
        "scene",
        "cells",
        "sides",
        "faces",
        "covers",
        "planes",
        "sources",
        "surfaces",
        "cellgrid",
        "gridcells",
        "nodes",
    ];
    let sections: Vec<enf::Section> = names.iter().map(|name| enf::section(&file, name)).collect();
    let rays: Vec<Ray> = rays(&made, 40, 5);
    let mut random = Random::new(12);
    let (mut refused, mut opened) = (0, 0);
    for round in 0..1500 {
        let mut damaged = file.clone();
        for _ in 0..1 + random.below(3) {
            let section = &sections[random.below(sections.len())];
            let at = section.start + random.below(section.length / 4) * 4;
            let old = enf::u32_at(&damaged, at);
            let new = match random.below(6) {
                0 => random.bits() as u32,
                1 => NONE,
                2 => old.wrapping_add(1),
                3 => old.wrapping_sub(1),
                4 => old ^ 1 << random.below(32),
                // Another number of the same section.
                _ => enf::u32_at(&file, section.start + random.below(section.length / 4) * 4),
            };
            enf::put(&mut damaged, at, &new.to_le_bytes());
        }
        enf::seal(&mut damaged);
        let Ok(scene) = Scene::from_bytes(&damaged) else {
            refused += 1;
            continue;
        };
        opened += 1;
        let start = std::time::Instant::now();
        for ray in &rays {
            scene.locate(ray.origin);
            scene.occluded(ray);
            let hit = scene.trace_from(Start::Cell(random.below(40) as u32), ray, Want::default());
            if let Answer::Hit(hit) = hit.answer() {
                scene.trace_from(Start::Hit(&hit), &Ray::new(hit.point, hit.normal), Want::default());
            }
            scene.trace(ray);
        }
        assert!(start.elapsed() < std::time::Duration::from_secs(10), "round {round}");
    }
    println!("{refused} refused, {opened} opened");
    assert!(refused > 200 && opened > 200, "{refused} refused, {opened} opened");
}

/// A slab that is a cross, one room on it along one of its bars, and one below it along the other.
fn rooms_on_a_cross() -> enfilade::importers::Model {
    use enfilade::importers::{Frame, Material, ModelBuilder, NewElement, Semantic};
    let mut builder = ModelBuilder::new("cross", Frame::default());
    let material = builder.material(Material::default());
    let mut add = |name: &str, semantic, boxes: &[[[f64; 2]; 2]], rise: [f64; 2]| {
        let new = NewElement { name: name.to_owned(), ..NewElement::default() };
        let element = builder.element(new).unwrap();
        builder.semantic(element, semantic);
        let mut quad = |p: [[f64; 3]; 4]| {
            builder.triangle(element, [p[0], p[1], p[2]], material).unwrap();
            builder.triangle(element, [p[0], p[2], p[3]], material).unwrap();
        };
        let mut edges = Vec::new();
        for [[x, y], [u, v]] in boxes {
            let corners = [[*x, *y], [*u, *y], [*u, *v], [*x, *v]];
            quad(corners.map(|[x, y]| [x, y, rise[1]]));
            quad([0, 3, 2, 1].map(|i| [corners[i][0], corners[i][1], rise[0]]));
            edges.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
        }
        // Not between two of them.
        for &[a, b] in edges.iter().filter(|[a, b]| !edges.contains(&[*b, *a])) {
            quad([
                [a[0], a[1], rise[0]],
                [b[0], b[1], rise[0]],
                [b[0], b[1], rise[1]],
                [a[0], a[1], rise[1]],
            ]);
        }
    };
    let arm = |x: f64, y: f64| [[x, y], [x + 2.0, y + 2.0]];
    let cross = [arm(2.0, 2.0), arm(0.0, 2.0), arm(4.0, 2.0), arm(2.0, 0.0), arm(2.0, 4.0)];
    add("slab", Semantic::Ground, &cross, [0.0, 0.5]);
    add("along", Semantic::Room, &[[[0.0, 2.0], [6.0, 4.0]]], [0.5, 3.0]);
    add("across", Semantic::Room, &[[[2.0, 0.0], [4.0, 6.0]]], [-2.5, 0.0]);
    builder.finish().unwrap()
}

#[test]
fn matter_that_means_the_same_is_one_face() {
    let options = enfilade::generate::HouseOptions::default();
    let model = enfilade::generate::house(&options).to_model().unwrap();
    let (partition, _) = enfilade::partition::partition(&model, &Default::default()).unwrap();
    let cells = enfilade::building::Building::new(&model, &partition).unwrap().cells().unwrap();
    let compiled = compile_partition(&model, partition, &CompileOptions::default()).unwrap();
    let count = |name: &str| {
        let section = enf::section(&compiled.bytes, name);
        section.length / section.item
    };
    let joined = cells.sections.len() + cells.covers.len() - count("sides") - count("covers");
    assert_eq!(joined as u64, compiled.report.joined_faces);
    assert!(joined > 0);
    // Floors of several parts that are all one slab's.
    let all_one = |range: &std::ops::Range<u32>| {
        let covers = &cells.covers[range.start as usize..range.end as usize];
        let meaning = |cover: &Cover| match cells.cells.get(cover.cell as usize).map(|cell| cell.label) {
            Some(Label::Solid(element)) if cover.source != NONE => Some((element, cover.source)),
            _ => None,
        };
        let first = meaning(&covers[0]);
        if first.is_some() && covers.iter().all(|c| meaning(c) == first) { covers.len() - 1 } else { 0 }
    };
    let floors: usize = cells.cells.iter().map(|cell| all_one(&cell.below) + all_one(&cell.above)).sum();
    assert_eq!(cells.covers.len() - count("covers"), floors);
}

/// A ray down along a wall that it never comes to is as near to the floor's edge as one that does.
#[test]
fn rays_along_sides_are_near_their_edges() {
    let model = rooms_on_a_cross();
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    for (y, is_near) in [(2.0001, true), (2.001, false), (3.9998, true), (3.0, false)] {
        for x in [1.0, 3.0, 5.0] {
            let ray = Ray::new([x, y, 1.5], [1e-5, 0.0, -1.0]);
            let (hit, cost) = scene.trace_cost_from(Start::Anywhere, &ray, Want::default());
            assert!(matches!(hit.answer(), Answer::Hit(_)));
            assert_eq!(cost.unsure, u32::from(is_near), "{x} {y}");
        }
    }
}
