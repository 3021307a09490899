//! Walks from cell to cell through random partitions, against the truth.
#![cfg(feature = "compile")]

mod common;

use common::Random;
use common::prisms::{Made, Style, make};
use enfilade::importers::Untagged;
use enfilade::oracle::{TrueAnswer, Truth, TruthOptions};
use enfilade::roles::roles;
use enfilade::verify::{Case, Said, VerifyReport};
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

/// The cases of `report` that are wrong indeed: for which not even rays shifted by any of some hundred ways have the
/// given answer. (The search for witnesses that `verify` makes knows the edges that it must go around, but not all of the
/// places where a ray may start that begins at the corner of a solid.)
fn truly_wrong(made: &Made, report: &VerifyReport) -> Vec<Case> {
    let roles = roles(&made.model, Untagged::default());
    let truth = Truth::new(&made.model, |e| roles[e.0 as usize], &TruthOptions::default());
    let steps = [-4e-4, -5e-5, -5e-6, -3e-7, 0.0, 3e-7, 5e-6, 5e-5, 4e-4];
    let agrees = |said: &Said, exact: &TrueAnswer| match (said, exact) {
        (Said::Hit { t, element }, TrueAnswer::Hit(n)) => n.element.0 == *element && (n.t - t).abs() <= 1e-3,
        (Said::Escaped, TrueAnswer::Escaped) => true,
        (Said::InSolid(elements), TrueAnswer::InSolid(solids)) => {
            elements.iter().any(|&e| solids.iter().any(|s| s.0 == e))
        }
        _ => false,
    };
    let has_witness = |case: &&Case| {
        (0..729).any(|i| {
            let way = [i % 9, i / 9 % 9, i / 81].map(|k| steps[k]);
            let origin = [0, 1, 2].map(|axis| case.origin[axis] + way[axis]);
            agrees(&case.answered, &truth.answer(&Ray::new(origin, case.direction)))
        })
    };
    report.wrong.iter().filter(|case| !has_witness(case)).cloned().collect()
}

fn verified(made: &Made, scene: &Scene, rays: u64, seed: u64) -> VerifyReport {
    let roles = roles(&made.model, Untagged::default());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Want::LEAST);
    let mut options = VerifyOptions::default().with_rays(rays).with_grid_rays(100).with_seed(seed);
    options.cases = 1000;
    verify(&made.model, |e| roles[e.0 as usize], &tracer, &options).unwrap()
}

#[test]
fn explore() {
    let n: u64 = std::env::var("SEEDS").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
    for (name, style) in styles() {
        let mut sums = [0u64; 12];
        for seed in 0..n {
            let made = make(&mut Random(seed * 77 + 1), &style);
            let scene = compiled(&made);
            let whole = compile(&made.model, &CompileOptions::default()).unwrap().scene();
            for (k, (scene, name2)) in [(&scene, "MINE"), (&whole, "WHOLE")].into_iter().enumerate() {
                let report = verified(&made, scene, 20000, seed);
                let wrong = truly_wrong(&made, &report);
                let t = &report.total;
                for (i, v) in
                    [t.exact, t.edge, t.wrong, wrong.len() as u64, t.close + t.flush].into_iter().enumerate()
                {
                    sums[k + 2 * i] += v;
                }
                for case in wrong {
                    println!("{name} {seed} {name2} {case:?}");
                }
            }
        }
        println!("== {name}: exact, edge, wrong, truly, close {sums:?}");
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
                    let o = [o[0] + at(i), o[1] + at(j), o[2] + at([0, 1, 2][k])];
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
