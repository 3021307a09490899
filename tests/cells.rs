//! Walks from cell to cell through random partitions, against the truth.
#![cfg(feature = "compile")]

mod common;

use common::Random;
use common::prisms::{Made, Style, make};
use enfilade::importers::Untagged;
use enfilade::oracle::{Truth, TruthOptions};
use enfilade::roles::roles;
use enfilade::{
    Answer, CompileOptions, Hit, Kernel, Place, Ray, Scene, Start, VerifyOptions, Want, compile,
    compile_partition, verify,
};

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
};

/// The kinds of partitions that every test goes through.
fn styles() -> Vec<(&'static str, Style)> {
    vec![
        ("boxes", BOXES),
        ("few numbers", Style { grain: 1 << 16, furniture: 0, ..BOXES }),
        ("boxes off the lattice", Style { moved: 0.49, grain: 1, ..BOXES }),
        ("triangles", Style { oblique: 0.6, ..BOXES }),
        ("triangles off the lattice", Style { oblique: 0.6, moved: 0.49, grain: 1, ..BOXES }),
        ("slopes", Style { sloped: 0.8, ..BOXES }),
        (
            "slopes and triangles off the lattice",
            Style { oblique: 0.5, sloped: 0.7, moved: 0.49, grain: 1, ..BOXES },
        ),
        ("far things", Style { oblique: 0.3, sloped: 0.3, around: 40, ..BOXES }),
    ]
}

fn compiled(made: &Made) -> Scene {
    compile_partition(&made.model, &made.partition, &CompileOptions::default()).unwrap().scene()
}

fn check(name: &str, seed: u64, made: &Made, rays: u64) {
    let scene = compiled(made);
    let roles = roles(&made.model, Untagged::default());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Want::LEAST);
    let options = VerifyOptions::default().with_rays(rays).with_grid_rays(200).with_seed(seed);
    let report = verify(&made.model, |e| roles[e.0 as usize], &tracer, &options).unwrap();
    println!(
        "{name} {seed}: {} cells, {:?}, forward {:?}",
        scene.cells().len(),
        report.total,
        report.forward
    );
    assert_eq!(report.total.wrong, 0, "{name} {seed}: {:?}", report.wrong);
}

#[test]
fn random_partitions_answer_right() {
    for (name, style) in styles() {
        for seed in 0..6 {
            check(name, seed, &make(&mut Random(seed * 77 + 1), &style), 6000);
        }
    }
}

#[test]
fn explore() {
    let n: u64 = std::env::var("SEEDS").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
    for (name, style) in styles() {
        let (mut mine, mut theirs) = (0, 0);
        let mut sums = [0u64; 4];
        for seed in 0..n {
            let made = make(&mut Random(seed * 77 + 1), &style);
            let roles = roles(&made.model, Untagged::default());
            let scene = compiled(&made);
            let whole = compile(&made.model, &CompileOptions::default()).unwrap().scene();
            let options = VerifyOptions::default().with_rays(20000).with_grid_rays(20).with_seed(seed);
            let run = |scene: &Scene| {
                verify(
                    &made.model,
                    |e| roles[e.0 as usize],
                    &|rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Want::LEAST),
                    &options,
                )
                .unwrap()
            };
            let (a, b) = (run(&scene), run(&whole));
            mine += a.total.wrong;
            theirs += b.total.wrong;
            sums[0] += a.total.exact;
            sums[1] += b.total.exact;
            sums[2] += a.total.edge;
            sums[3] += b.total.edge;
            for case in a.wrong {
                println!("{name} {seed} MINE {case:?}");
            }
            for case in b.wrong {
                println!("{name} {seed} WHOLE {case:?}");
            }
        }
        println!(
            "== {name}: wrong {mine} {theirs} exact {} {} edge {} {}",
            sums[0], sums[1], sums[2], sums[3]
        );
    }
}

#[test]
fn one() {
    let Ok(spec) = std::env::var("ONE") else { return };
    let v: Vec<f64> = spec.split(',').map(|x| x.trim().parse().unwrap()).collect();
    let (_, style) = styles()[v[0] as usize];
    let made = make(&mut Random(v[1] as u64 * 77 + 1), &style);
    let roles = roles(&made.model, Untagged::default());
    let truth = Truth::new(&made.model, |e| roles[e.0 as usize], &TruthOptions::default());
    let ray = Ray::new([v[2], v[3], v[4]], [v[5], v[6], v[7]]);
    let (mine, whole) = (compiled(&made), compile(&made.model, &CompileOptions::default()).unwrap().scene());
    for scene in [&whole, &mine] {
        let a = scene.trace(&ray);
        println!("{a:?}\n  {:?}", truth.judge(&ray, &a));
        println!("  cost {:?}", scene.trace_cost_from(Start::Anywhere, &ray, Want::default()).1);
        for i in 0..9 {
            for j in 0..9 {
                for k in 0..3 {
                    let at = |i: i32| [-5e-4, -1e-4, -2e-5, -5e-6, 0.0, 5e-6, 2e-5, 1e-4, 5e-4][i as usize];
                    let o = ray.origin;
                    let o = [o[0] + at(i), o[1] + at(j), o[2] + at([2, 3, 4][k])];
                    println!(
                        "   shift {} {} {k} {:?}",
                        at(i),
                        at(j),
                        truth.answer(&Ray::new(o, ray.direction))
                    );
                }
            }
        }
        if let Answer::Hit(h) = a {
            println!("  corners {:?}", scene.triangle(h.triangle));
        }
    }
}
