//! The suite in little, that it finds what is bad, and what it has found before.

use super::block::Stage;
use super::judge::Worth;
use super::*;
use crate::scene::Scene;
use crate::trace::{Answer, Hit, Ray, Start, Want};

#[test]
fn every_trial_is_compiled_and_nothing_bad_is_found() {
    let report = stress(&StressOptions { rays: 21_000, ..StressOptions::default() }).unwrap();
    assert!(report.passed(), "{}", report.text());
    assert!(report.total.rays >= 21_000 && report.total.onward > 1000);
    let cut = report.rows.iter().filter(|row| row.cells > 1).count();
    assert!(cut * 2 > report.rows.len(), "cells in {cut} of {} trials", report.rows.len());
}

#[cfg(feature = "rayon")]
#[test]
fn the_same_report_at_any_number_of_threads() {
    let options = StressOptions { rays: 3000, trials: vec!["nested".into()], ..StressOptions::default() };
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut report = pool.install(|| stress(&options)).unwrap();
        report.total.slowest_us = 0.0;
        report.rows.iter_mut().for_each(|row| row.counts.slowest_us = 0.0);
        report
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn rays_are_sent_anew_by_their_index() {
    let run = |first: u64, rays: u64| {
        let (trials, families) = (vec!["near-coplanar".into()], vec![Family::AlongEdges]);
        let report =
            stress(&StressOptions { trials, families, first, rays, ..StressOptions::default() }).unwrap();
        let mut counts = report.total;
        counts.slowest_us = 0.0;
        counts
    };
    let mut parts = run(0, 1027);
    parts.add(&run(1027, 73));
    assert_eq!(parts, run(0, 1100));
    assert_ne!(run(0, 200), run(200, 200));
}

#[test]
fn what_is_refused_fails() {
    let report = stress(&StressOptions { trials: vec!["nothing".into()], ..StressOptions::default() });
    assert!(!report.unwrap().passed(), "nothing was sent");
}

/// Calls `with` with a stage of a trial.
fn staged<T>(name: &str, family: Family, with: impl FnOnce(&Stage<'_>, &Scene) -> T) -> T {
    let trial = trials(false, 1).into_iter().find(|trial| trial.name == name).unwrap();
    let model = trial.model().unwrap();
    let options = CompileOptions { tolerance: trial.tolerance, ..CompileOptions::default() };
    let scene = compile(&model, &options).unwrap().scene();
    let roles = roles(&model, Untagged::default());
    let tolerance = TruthOptions::default().with_tolerance(trial.tolerance);
    let truth = Truth::new(&model, |element| roles[element.0 as usize], &tolerance);
    let stage = Stage {
        trial: &trial.name,
        judge: Judge { scene: &scene, truth: &truth },
        source: Source::new(&scene, &truth, trial.inside, 1),
        is_closed: trial.inside.is_some() && family.starts_anywhere(),
        most: 3,
    };
    with(&stage, &scene)
}

#[test]
fn wrong_answers_are_told() {
    staged("nested", Family::Anywhere, |stage, scene| {
        let (mut wrong, mut hits) = (0, 0);
        for index in 0..300 {
            let ray = stage.source.ray(Family::Anywhere, index);
            let Answer::Hit(hit) = scene.trace_from(Start::Anywhere, &ray, Want::LEAST).answer() else {
                continue;
            };
            hits += 1;
            let others = [
                Answer::Escaped,
                Answer::InSolid(hit.element),
                Answer::Hit(Hit { t: hit.t + 0.01, ..hit }),
                Answer::Hit(Hit { t: hit.t * 0.5, ..hit }),
                Answer::Hit(Hit { t: f64::NAN, ..hit }),
                Answer::Hit(Hit { element: hit.element + 7, ..hit }),
            ];
            let is_wrong = |answer: &Answer| matches!(stage.judge.worth(&ray, answer), Worth::Wrong(_));
            wrong += others.iter().filter(|answer| is_wrong(answer)).count();
            assert!(!is_wrong(&Answer::Hit(hit)), "{ray:?} {hit:?}");
            // What is too short for the tolerance is right, and no exact answer.
            let near = stage.judge.worth(&ray, &Answer::Hit(Hit { t: hit.t + 2e-4, ..hit }));
            assert!(matches!(near, Worth::Close | Worth::Beside), "{ray:?}");
        }
        // A ray that comes to a wall at a small angle meets it a centimetre on for one a millimetre beside.
        assert!(hits > 200 && 50 * wrong >= 49 * 6 * hits, "{wrong} of {hits}");
    });
}

#[test]
fn limits_are_granted_at_what_is_met_and_no_farther() {
    staged("nested", Family::Anywhere, |stage, scene| {
        let ray = Ray::new([0.5, 4.0, 1.0], [1.0, 0.0, 0.0]);
        let Answer::Hit(hit) = scene.trace_from(Start::Anywhere, &ray, Want::LEAST).answer() else {
            panic!()
        };
        let worth = |tmax: f64| stage.judge.worth(&Ray { tmax, ..ray }, &Answer::Escaped);
        assert!(matches!(worth(hit.t - 1e-3), Worth::Exact));
        assert!(matches!(worth(hit.t), Worth::Tie));
        assert!(matches!(worth(hit.t + 1e-2), Worth::Wrong(_)));
    });
}

/// Sends one ray, which was answered badly once.
#[track_caller]
fn once(trial: &str, family: Family, index: u64) {
    staged(trial, family, |stage, _| {
        let found = stage.block(family, index..index + 1);
        assert!(found.counts.bad() == 0 && found.counts.rays == 1, "{:?}", found.cases);
    });
}

#[test]
fn a_ray_past_a_slab_met_it_where_it_had_left_it() {
    once("corridor-100", Family::Grazing, 44);
}

#[test]
fn a_ray_from_a_ceiling_over_a_wall_went_through_the_wall() {
    once("nested", Family::AlongEdges, 608);
}

#[test]
fn a_ray_on_a_surface_was_told_beside_it_and_met_it_again() {
    once("near-coplanar", Family::Zeros, 28);
}

#[test]
fn a_ray_from_something_thin_met_its_other_side() {
    once("near-coplanar", Family::Anywhere, 4);
}

#[test]
fn a_sliver_was_met_far_from_where_it_is() {
    once("near-coplanar", Family::Edges, 5690);
}

#[test]
fn a_ray_from_an_edge_of_a_solid_went_through_it() {
    once("needles", Family::Surfaces, 3458);
    once("near-vertical", Family::Surfaces, 4694);
}

#[test]
fn a_mirrored_ray_ran_on_inside_the_surface() {
    once("flat-cells", Family::Grazing, 3064);
}

#[test]
fn a_needle_is_right_by_rational_witnesses() {
    once("needles", Family::Vertices, 20);
    once("needles", Family::Vertices, 40);
}
