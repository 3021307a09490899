//! Small models in which the tracer and the truth once disagreed, or might: shells that overlap themselves, wound both
//! ways, without volume.
#![cfg(all(feature = "obj", feature = "compile"))]

use enfilade::importers::{ImportOptions, Model, Role, Untagged, obj};
use enfilade::oracle::{Truth, TruthOptions, Verdict};
use enfilade::roles::roles;
use enfilade::{Answer, CompileOptions, Hit, Place, Ray, VerifyOptions, VerifyReport, compile, verify};
use enfilade_testing::Random;

fn read(text: &str) -> Model {
    obj::read_text(text.as_bytes(), "small.obj", None, &ImportOptions::default()).unwrap()
}

/// Verifies rays from everywhere in the model.
fn report(model: &Model, rays: u64) -> VerifyReport {
    let scene = compile(model, &CompileOptions::default()).unwrap().scene();
    let roles = roles(model, Untagged::default());
    let mut options = VerifyOptions::default().with_rays(rays).with_grid_rays(rays);
    (options.solid_rays, options.hard_rays) = (rays, rays);
    let trace = |rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Default::default());
    let occluded = |rays: &[Ray]| enfilade::verify::sees(&scene, rays);
    verify(model, |element| roles[element.0 as usize], &(trace, occluded), &options).unwrap()
}

#[track_caller]
fn check(model: &Model, rays: u64) {
    let report = report(model, rays);
    assert_eq!((report.total.wrong, report.grid.different), (0, 0), "{:#?}", report.wrong);
    assert!(report.sight.different == 0 && report.sight.rays > 0, "{:#?}", report.sight);
}

/// Two faces on the same corners, back to back: a shell without volume, on which rays begin.
#[test]
fn membranes() {
    let corners = "v 2 1 1\nv 1 2 1\nv 1 1 2\nv 5 1 1\n";
    check(&read(&format!("{corners}f 1 4 3 2\n{corners}f 5 6 7 8\n")), 3000);
    check(&read(&format!("{corners}f 1 3 2\nf 1 2 3\n")), 3000);
}

/// A tube, square across, that runs once around and into itself: its ends overlap.
fn spiral(turned: &[usize]) -> Model {
    let mut text = String::new();
    let rings = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, -0.25]];
    let out = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
    for ([x, y], [u, v]) in rings.iter().zip(out) {
        for (away, z) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            text += &format!("v {} {z} {}\n", x + away * u, y + away * v);
        }
    }
    let mut faces = Vec::new();
    let count = rings.len();
    for i in 0..count - 1 {
        for k in 0..4 {
            let [a, b] = [k, (k + 1) % 4].map(|k| 4 * i + k + 1);
            faces.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    let last = 4 * (count - 1);
    faces.extend([[1, 3, 2], [1, 4, 3], [last + 1, last + 2, last + 3], [last + 1, last + 3, last + 4]]);
    for (i, [a, b, c]) in faces.into_iter().enumerate() {
        text += &if turned.contains(&i) { format!("f {a} {c} {b}\n") } else { format!("f {a} {b} {c}\n") };
    }
    read(&text)
}

#[test]
fn what_overlaps_itself_is_solid_however_it_is_wound() {
    for turned in [&[][..], &[0], &[7, 8, 30], &[1, 2, 3, 4, 5, 6, 7]] {
        let model = spiral(turned);
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        // In the model's frame, Y up: where the tube runs into its own start, beside it, and in the hole it goes around.
        let at = |p: [f64; 3]| scene.locate(scene.frame().point_to_internal(p));
        assert_eq!(at([-0.5, 0.5, -0.6]), Place::InSolid(0), "{turned:?}");
        assert_eq!(at([2.0, 0.5, -0.5]), Place::InSolid(0), "{turned:?}");
        assert!(matches!(at([2.0, 0.5, 2.0]), Place::Air { .. }), "{turned:?}");
        check(&model, 2000);
    }
}

/// A shell that looks inward within another is a cavity, but one by itself where its own triangles disagree.
#[test]
fn only_shells_that_agree_make_cavities() {
    let cube = |half: f64, first: usize, turned: &[usize]| {
        let mut text = String::new();
        for i in 0..8 {
            let c = [i & 1, i >> 1 & 1, i >> 2].map(|bit| half * f64::from(2 * bit - 1));
            text += &format!("v {} {} {}\n", c[0], c[1], c[2]);
        }
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        for (i, [a, b, c]) in faces.enumerate() {
            let [b, c] = if turned.contains(&i) { [c, b] } else { [b, c] };
            text += &format!("f {} {} {}\n", first + a, first + b, first + c);
        }
        text
    };
    let all: Vec<usize> = (0..12).collect();
    for (outer, inner, is_air) in [
        (&[][..], &all[..], true),
        (&all[..], &[][..], true),
        (&[][..], &[][..], false),
        (&[][..], &all[1..], false),
        (&[3][..], &all[..], false),
        (&[3][..], &[5][..], false),
    ] {
        let model = read(&(cube(2.0, 1, outer) + &cube(1.0, 9, inner)));
        let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
        assert_eq!(matches!(scene.locate([0.1; 3]), Place::Air { .. }), is_air, "{outer:?} {inner:?}");
        assert_eq!(scene.locate([1.5; 3]), Place::InSolid(0));
        check(&model, 1000);
    }
}

/// Closed shells on few points of a small grid: they overlap, share corners and edges, and are wound at random.
#[test]
fn random_shells_wound_at_random() {
    let mut random = Random::new(9);
    for round in 0..150 {
        let mut text = String::new();
        let mut points = 0;
        for element in 0..1 + random.below(2) {
            text += &format!("o {element}\n");
            // Coordinates off each other's planes by chance only.
            let size = 3 + random.below(4);
            for _ in 0..7 {
                let [x, y, z] = [0; 3].map(|_| random.below(size));
                text += &format!("v {x} {y} {z}\n");
            }
            for _ in 0..1 + random.below(4) {
                let mut corners = [0; 4].map(|_| 0);
                for i in 0..4 {
                    corners[i] = loop {
                        let corner = points + 1 + random.below(7);
                        if !corners[..i].contains(&corner) {
                            break corner;
                        }
                    };
                }
                let [a, b, c, d] = corners;
                for [i, j, k] in [[a, c, b], [a, b, d], [b, c, d], [c, a, d]] {
                    let [j, k] = if random.one_in(4) { [k, j] } else { [j, k] };
                    text += &format!("f {i} {j} {k}\n");
                }
            }
            points += 7;
        }
        if let Ok(model) = obj::read_text(text.as_bytes(), "small.obj", None, &ImportOptions::default()) {
            let report = report(&model, 40);
            assert_eq!(
                (report.total.wrong, report.grid.different),
                (0, 0),
                "{round}\n{text}\n{:#?}",
                report.wrong
            );
        }
    }
}

/// Corners in a line but for their roundings: a triangle at which no ray can be aimed.
#[test]
fn slivers_narrower_than_any_ray_can_tell() {
    let third = "v 2 1 1\nv 3 3 1\nv 1.6666666666666667 0.3333333333333333 1\n";
    check(&read(&format!("{third}f 1 2 3\n")), 3000);
    // One of two faces, far from the origin.
    let far = "v 302 101 1\nv 303 103 1\nv 301.6666666666667 100.33333333333333 1\nv 305 101 4\n";
    check(&read(&format!("{far}f 1 2 3\nf 1 4 2\n")), 3000);
}

/// A ray along an edge of triangles that it sees from the side: by less than a ray can be aimed it meets one of them, which
/// runs along with it for two kilometres, anywhere.
#[test]
fn triangles_that_run_along_with_a_ray() {
    let text = "v 1 2 7 0 0 0\nv 0 02222 3\nv 1 2 1\nv 1 1 2\nv 5 1 1\no W\nf 1 4 3 2\nf 1 2 6\nv 1 1 1\nv 0 1 1\nv 1 2 1\nv 1 1 2\nv 5 1 1\no W\nf 1 4 2 3 7 6\nf 3 4 8 7\n";
    let model = read(text);
    let compiled = compile(&model, &CompileOptions::default()).unwrap();
    let roles = roles(&model, Untagged::default());
    let truth = Truth::new(&model, |element| roles[element.0 as usize], &TruthOptions::default());
    let ray = Ray::new([0.9999999993355574, 2.999999978770476, -3331.9999999982224], [-1.0, -1.0, 2221.0]);
    let judged = truth.judge(&ray, &compiled.scene().trace(&ray));
    assert!(judged.verdict.is_right(), "{judged:?}");
}

/// A ray that starts below one level sheet and meets another far off: moved across and along at once, by less than the
/// tolerance, it starts above the first; moved by one of the two alone it does not, or meets the second elsewhere.
#[test]
fn witnesses_may_be_moved_across_and_along() {
    let model = read(
        "v -9 0 9\nv 9 0 9\nv 0 0 -9\no floor\nf 1 2 3\nv -9 1 9\nv 9 1 9\nv 0 1 -9\no table\nf 4 5 6\n",
    );
    let truth = Truth::new(&model, |_| Role::Detail, &TruthOptions::default());
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let verdict = |rise: f64, depth: f64| {
        let ray = Ray::new([0.0, 0.0, -depth], [(1.0 - rise * rise).sqrt(), 0.0, rise]);
        // The answer of one who starts above the floor.
        let late = scene.trace(&Ray { tmin: 0.01, ..ray });
        assert!(matches!(late, Answer::Hit(hit) if hit.element == 1));
        truth.judge(&ray, &late).verdict
    };
    for (rise, depth) in [(1.0 / 3.0, 0.45e-3), (0.5, 0.7e-3), (0.25, 0.35e-3)] {
        let near = verdict(rise, depth);
        assert!(matches!(near, Verdict::Edge { delta } if delta > 0.6e-3), "{rise} {depth}: {near:?}");
        // No shift will do, but the start counts as above the floor as long as that is near.
        let start = verdict(rise, 0.95e-3);
        assert!(matches!(start, Verdict::Edge { delta } if (delta - 0.95e-3).abs() < 1e-9), "{start:?}");
        assert!(!verdict(rise, 1.05e-3).is_right(), "{rise} {depth}");
    }
}

/// A ray that starts on a triangle kilometres long and millimetres wide: its start counts as beyond it.
#[test]
fn starts_on_long_slivers() {
    let model = read("v 3331 2 1\nv -3326 -1 -2\nv -3332 -1 -2\nf 1 2 3\n");
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let truth = Truth::new(&model, |_| Role::Detail, &TruthOptions::default());
    let ray = Ray::new(
        [-1572.6346500434138, -0.20877654913418286, -1.2087765491341829],
        [0.6041367277271263, 0.37625593731770773, -0.7024601653078509],
    );
    let judged = truth.judge(&ray, &scene.trace(&ray));
    assert!(judged.verdict.is_right(), "{judged:?}");
    check(&model, 3000);
}

/// A wall whose back leans by hardly more than what counts as upright: as steep as a plane gets. Its cells can be opened.
#[test]
fn walls_that_hardly_lean_have_cells() {
    for (height, lean) in [(2.5, 0.00205), (2.5, 0.01), (8.0, 0.00205)] {
        let hexahedron = |x: [f64; 2], tops: [f64; 2]| {
            let mut text = String::new();
            for (y, x) in [(0.0, x), (height, tops)] {
                for [x, z] in [[x[0], 0.0], [x[1], 0.0], [x[1], 3.0], [x[0], 3.0]] {
                    text += &format!("v {x} {y} {z}\n");
                }
            }
            let faces = ["1 2 3 4", "5 8 7 6", "1 5 6 2", "2 6 7 3", "3 7 8 4", "4 8 5 1"];
            (text, faces.map(|face| face.split(' ').map(|v| v.parse().unwrap()).collect::<Vec<i32>>()))
        };
        let mut text = String::new();
        for (name, x, tops) in [("ROOM_1", [0.0, 4.0], [0.0, 4.0]), ("WALL_1", [4.0, 4.3], [4.0, 4.3 + lean])]
        {
            let (vertices, faces) = hexahedron(x, tops);
            text += &format!("o {name}\n{vertices}");
            for face in faces {
                text += &format!("f {} {} {} {}\n", face[0] - 9, face[1] - 9, face[2] - 9, face[3] - 9);
            }
        }
        let model = read(&text);
        let compiled = compile(&model, &CompileOptions::default()).unwrap();
        assert_eq!(compiled.report.warnings, [""; 0]);
        assert!(compiled.report.cells > 5, "{}", compiled.report.cells);
        check(&model, 3000);
    }
}
