//! The suite in little, that it finds what is bad, and what it has found before.

use super::block::Stage;
use super::judge::Worth;
use super::*;
use crate::format::records::CellRecord;
use crate::scene::Scene;
use crate::splitmix::SplitMix64;
use crate::trace::{Answer, BLURRED, Hit, NONE, Prisms, Ray, Start, Want};
use enfilade_importers::Semantic;
use glam::DVec3;

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
fn rays_are_shared_by_what_they_cost() {
    let trials = trials(true, 1);
    let each = shares(1_000_000, &trials, 10);
    let of = |name: &str| each[trials.iter().position(|trial| trial.name == name).unwrap()];
    let (usual, rare) = (of("nested"), of("corridor-5000"));
    assert!(rare > 0 && (256 * (rare - 1) + 1..=256 * rare).contains(&usual), "{each:?}");
    assert!((usual..usual + 4).contains(&(4 * of("slivers"))), "{each:?}");
    let all = each.iter().sum::<u64>() * 10;
    assert!((1_000_000..1_001_000).contains(&all), "{all}");
    let alone = [corridor_of(trials)];
    assert_eq!(shares(1, &alone, 1), [1], "one ray anew");
}

/// The corridor is ten kilometres long, and its model has an offset taken off: what is inside of it was looked for where it had been.
#[test]
fn closed_rooms_are_where_their_models_are() {
    let corridor = corridor_of(trials(true, 1));
    let model = corridor.model().unwrap();
    assert!(model.frame.has_offset());
    let [lo, hi] = corridor.inside_of(&model).unwrap();
    let air = model.elements.iter().find(|element| element.semantic == Semantic::Room).unwrap();
    for p in &air.mesh.positions {
        assert!((0..3).all(|i| p[i] == lo[i] || p[i] == hi[i]), "{p:?} {lo:?} {hi:?}");
    }
}

/// Heights up to two steps of the lattice apart are one height, so that no cell is lower than three.
#[test]
fn flat_cells_are_some_steps_of_the_lattice_high() {
    staged("flat-cells", Family::Anywhere, |_, scene| {
        let step = scene.tables.scene[0].lattice_step();
        let air = scene.tables.cells.iter().filter(|cell| cell.kind == CellRecord::AIR);
        let height = |cell: &CellRecord| cell.bounds[1][2] - cell.bounds[0][2];
        let lowest = air.map(height).fold(f64::INFINITY, f64::min);
        assert!((2.5 * step..4.5 * step).contains(&lowest), "{lowest} with steps of {step}");
    });
}

fn corridor_of(trials: Vec<Trial>) -> Trial {
    trials.into_iter().find(|trial| trial.name == "corridor-5000").unwrap()
}

#[test]
fn what_is_refused_fails() {
    let report = stress(&StressOptions { trials: vec!["nothing".into()], ..StressOptions::default() });
    assert!(!report.unwrap().passed(), "nothing was sent");
}

/// Calls `with` with a stage of a trial and the first seed.
fn staged<T>(name: &str, family: Family, with: impl FnOnce(&Stage<'_>, &Scene) -> T) -> T {
    staged_with(1, name, family, with)
}

/// The same with a seed of choice.
fn staged_with<T>(seed: u64, name: &str, family: Family, with: impl FnOnce(&Stage<'_>, &Scene) -> T) -> T {
    // The long mode has some more.
    let mut all = [false, true].into_iter().flat_map(|long| trials(long, seed));
    let trial = all.find(|trial| trial.name == name).unwrap();
    let model = trial.model().unwrap();
    let options = CompileOptions { tolerance: trial.tolerance, ..CompileOptions::default() };
    let (scene, inside) = (compile(&model, &options).unwrap().scene(), trial.inside_of(&model));
    let roles = roles(&model, Untagged::default());
    let tolerance = TruthOptions::default().with_tolerance(trial.tolerance);
    let truth = Truth::new(&model, |element| roles[element.0 as usize], &tolerance);
    let stage = Stage {
        trial: &trial.name,
        judge: Judge { scene: &scene, truth: &truth },
        source: Source::new(&scene, &truth, inside, seed),
        is_closed: inside.is_some() && family.starts_anywhere(),
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
    seeded(1, trial, family, index);
}

/// The same with a seed of choice.
#[track_caller]
fn seeded(seed: u64, trial: &str, family: Family, index: u64) {
    staged_with(seed, trial, family, |stage, _| {
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
    // Aside of where it starts is behind another, which a witness leaves.
    seeded(1187, "needles", Family::Surfaces, 524);
}

#[test]
fn a_ray_from_a_corner_that_rounding_put_into_a_wall_went_through_it() {
    seeded(3, "scaled-1e1", Family::AlongEdges, 228);
    seeded(3, "scaled-1e3", Family::AlongEdges, 288);
    seeded(2, "scaled-1e-3", Family::AlongEdges, 56);
}

#[test]
fn a_ray_from_a_wall_ran_on_inside_the_floor() {
    seeded(3, "scaled-1e1", Family::Grazing, 708);
    seeded(4, "scaled-1e3", Family::Grazing, 3844);
}

#[test]
fn a_ray_from_a_board_met_the_back_of_one_that_stands_out_less() {
    seeded(3, "near-coplanar", Family::Edges, 844);
    seeded(3, "near-coplanar", Family::Zeros, 1320);
}

#[test]
fn a_ray_from_a_face_that_is_planar_to_nanometres_met_its_other_triangle_from_behind() {
    seeded(3, "house-cad", Family::AlongEdges, 2656);
}

#[test]
fn a_ray_from_far_met_the_corner_again_that_it_went_on_from() {
    seeded(3, "scaled-1e6", Family::Limits, 1972);
}

#[test]
fn a_ray_that_begins_on_the_bottom_of_the_lowest_solid_went_through_it() {
    seeded(2, "turned-1", Family::Limits, 926);
    seeded(4, "scaled-1e1", Family::Limits, 4889);
}

#[test]
fn a_ray_from_a_crack_between_a_damaged_wall_and_a_slab_went_through_the_slab() {
    seeded(5, "house-damaged", Family::AlongEdges, 3872);
    seeded(5, "house-damaged", Family::Borders, 864);
    seeded(5, "house-damaged", Family::Borders, 3592);
}

/// Its face leans, so that the cell's is centimetres farther along so flat a ray, in another cell.
#[test]
fn a_segment_ended_before_the_cell_behind_whose_face_it_met_something() {
    staged("near-vertical", Family::Anywhere, |_, scene| {
        let origin = [2.943033026946771, 1.8247066231022901, 1.710761157283652];
        let direction = [-0.0050263931479914686, -0.965032218098322, 0.2620831040035862];
        let Answer::Hit(hit) = scene.trace(&Ray::new(origin, direction)) else { panic!() };
        for further in [1e-6, 1e-4, 2e-3, 1e-2] {
            let segment = Ray::segment(origin, direction, 0.0, hit.t + further);
            assert!(scene.occluded(&segment), "{further}");
            assert!(matches!(scene.trace(&segment), Answer::Hit(met) if met.t == hit.t), "{further}");
        }
        assert!(!scene.occluded(&Ray::segment(origin, direction, 0.0, hit.t - 1e-6)));
    });
}

/// Also where the grid over solids ends, or another of its cubes begins.
#[test]
fn what_may_be_in_a_solid_is_never_denied() {
    for name in ["turned-1", "scaled-1e1", "house-cad"] {
        staged_with(2, name, Family::Anywhere, |stage, scene| {
            let margin = 1e-6 * stage.judge.truth.tolerance();
            let mut held = 0;
            let is_solid = |role: u32| role == enfilade_importers::Role::Solid as u32;
            for volume in scene.tables.volumes.iter().filter(|volume| is_solid(volume.role)) {
                for triangle in volume.first_triangle..volume.first_triangle + volume.triangle_count {
                    let [a, b, c] = scene.triangle(triangle).map(glam::DVec3::from);
                    let normal = (b - a).cross(c - a).normalize_or_zero();
                    for side in [-0.5, 0.5] {
                        let point = (a + b + c) / 3.0 + normal * (side * margin);
                        assert!(scene.may_be_in_solid(point.to_array(), margin), "{name}: {point:?}");
                        held += 1;
                    }
                }
            }
            assert!(held > 500, "{name}: {held}");
        });
    }
}

/// Behind a ceiling that noise has bent no cell is in no doubt; the ray had ended before.
#[test]
fn a_segment_that_ends_before_matter_is_not_in_doubt_about_it() {
    seeded(6, "house-damaged", Family::Zeros, 810);
    seeded(6, "house-damaged", Family::Surfaces, 3038);
    seeded(6, "house-damaged", Family::Surfaces, 3240);
}

#[test]
fn a_ray_from_the_corner_of_an_opening_ran_on_inside_the_wall() {
    seeded(21, "tilted-1", Family::Surfaces, 7848);
    seeded(32, "tilted-1", Family::Surfaces, 3560);
    seeded(21, "house-damaged", Family::AlongEdges, 6908);
}

#[test]
fn a_ray_from_a_pane_met_the_back_of_the_wall_along_whose_opening_it_ran() {
    seeded(5, "scaled-1e-3", Family::AlongEdges, 4436);
    seeded(6, "scaled-1e-3", Family::AlongEdges, 4768);
    seeded(21, "scaled-1e-3", Family::AlongEdges, 2100);
}

/// From a door's leaf, along the side of the wall's opening, which rounding had put it behind.
#[test]
fn a_ray_in_doubt_where_it_ends_was_not_where_it_starts() {
    seeded(323, "moved-1e3", Family::Grazing, 8096);
}

/// Where a ceiling slopes down to the floor: the one way was in doubt which of the two it leaves through, the other looked at the level floor alone.
#[test]
fn a_ray_and_one_in_a_batch_told_a_floor_by_unlike_planes() {
    staged_with(5, "near-vertical", Family::Anywhere, |stage, _| {
        let found = stage.block(Family::Anywhere, 0..1024);
        assert!(found.counts.bad() == 0 && found.counts.rays == 1024, "{:?}", found.cases);
    });
}

#[cfg(feature = "render")]
#[test]
fn pictures_from_hard_places_show_what_rays_meet() {
    let names = ["scaled-1e1", "turned-0", "thin-walls", "slivers", "needles"].map(str::to_owned);
    let options = StressOptions { rays: 1, pictures: 1, trials: names.to_vec(), ..StressOptions::default() };
    let report = stress(&options).unwrap();
    let ways: Vec<_> = report.pictures.iter().map(|row| (row.trial.as_str(), row.way)).collect();
    assert!(ways.contains(&("turned-0", "beams")) && ways.contains(&("turned-0", "packets")), "{ways:?}");
    for row in &report.pictures {
        assert!(row.pixels > 10_000 && row.to_rays < row.pixels, "{row:?}");
        assert_eq!(row.bad(), 0, "{row:?}");
    }
    assert!(report.text().contains("unwritten"), "{}", report.text());
}

/// Makes one picture by each way and kernel, in which pixels were wrong once.
#[cfg(feature = "render")]
#[track_caller]
fn pictured(seed: u64, trial: &str, family: Family, index: u64) {
    let (trials, families) = (vec![trial.to_owned()], vec![family]);
    let options =
        StressOptions { seed, rays: 1, first: index, pictures: 1, trials, families, ..Default::default() };
    let report = stress(&options).unwrap();
    let rows: Vec<_> = report.pictures.iter().filter(|row| row.trial == trial).collect();
    assert!(rows.len() == 2 && rows.iter().all(|row| row.pixels > 1000), "{rows:?}");
    rows.iter().for_each(|row| assert_eq!(row.bad(), 0, "{row:?}"));
}

#[cfg(feature = "render")]
#[test]
fn a_picture_from_between_parts_of_nanometres_saw_through_one() {
    pictured(21, "flat-cells", Family::Grazing, 0);
    pictured(21, "round-1000", Family::Surfaces, 0);
}

#[cfg(feature = "render")]
#[test]
fn rays_left_over_by_a_picture_from_an_edge_began_behind_it() {
    pictured(21, "turned-0", Family::AlongEdges, 2);
}

#[cfg(feature = "render")]
#[test]
fn a_picture_from_a_wall_that_cells_round_showed_what_is_behind_it() {
    pictured(22, "house-damaged", Family::Zeros, 0);
    pictured(22, "tilted-1", Family::Surfaces, 4);
}

#[cfg(feature = "render")]
#[test]
fn a_single_pixel_saw_past_the_corner_of_a_building() {
    pictured(41, "turned-0", Family::Grazing, 15);
}

#[cfg(feature = "render")]
#[test]
fn packets_told_pixels_on_a_line_apart_by_what_f32_rounds() {
    pictured(22, "thin-walls", Family::Borders, 6);
    pictured(22, "near-vertical", Family::Borders, 6);
}

#[cfg(feature = "render")]
#[test]
fn a_picture_of_a_building_of_thousands_of_kilometres_left_out_what_was_near() {
    pictured(22, "scaled-1e6", Family::AlongEdges, 0);
}

#[test]
fn a_ray_that_goes_on_met_a_plane_again_whose_edge_it_passes_beside() {
    seeded(33, "scaled-1e3", Family::Vertices, 1032);
}

#[test]
fn a_ray_from_the_pane_that_it_started_on_met_its_other_triangle() {
    seeded(6, "house-damaged", Family::Zeros, 51472);
}

#[test]
fn a_ray_that_could_not_be_moved_out_of_a_corner_ran_on_inside_the_wall() {
    seeded(33, "house-cad", Family::AlongEdges, 1512);
}

/// Nor is a ray in doubt that meets something where it goes on from, or a face as near to that as rounding.
#[test]
fn a_ray_from_a_corner_meets_what_is_there() {
    seeded(41, "flat-cells", Family::Vertices, 4212);
    seeded(41, "turned-0", Family::Vertices, 2452);
    seeded(41, "near-coplanar", Family::Surfaces, 2068);
}

/// It was answered by a ray 12 mm beside, in a building of thousands of kilometres, which comes to a level plane 0.7 m later.
#[test]
fn a_segment_along_an_edge_did_not_come_as_far_as_its_ray() {
    seeded(52, "scaled-1e6", Family::AlongEdges, 3994);
}

/// Down from the underside of a solid's corner, another triangle of that underside was met at once.
#[test]
fn a_ray_on_from_an_edge_met_the_plane_that_it_left() {
    seeded(1018, "tilted-0", Family::AlongEdges, 1672);
}

/// In the corner of a door's frame that no volume is known of, the lintel was behind where the ray starts, by 1e-21.
#[test]
fn a_ray_on_from_an_edge_went_through_the_other_face_of_that() {
    seeded(130, "scaled-1e-3", Family::Surfaces, 2932);
}

/// Aside of where they start there was air, and what they enter at once was taken for the surface that they leave, as it is no farther away than that.
#[test]
fn rays_on_from_edges_went_through_what_is_nearer_than_they_were_moved() {
    seeded(165, "house-cad", Family::AlongEdges, 144);
    seeded(153, "house-cad", Family::AlongEdges, 9864);
    seeded(1063, "house-damaged", Family::Borders, 7584);
}

/// Along a wall and past the edge of what lies at its foot, by less than a millionth of the tolerance: those beside begin in the wall.
#[test]
fn what_is_beside_where_a_ray_along_a_wall_ends_was_said_to_be_wrong() {
    seeded(150, "scaled-1e-3", Family::Grazing, 604);
    seeded(152, "turned-1", Family::Grazing, 8381);
}

/// From the corner of an opening's top into that, along the opening's side: rounding said that it leaves the top there.
#[test]
fn a_ray_on_from_an_openings_corner_met_the_plane_that_it_left() {
    seeded(1059, "turned-0", Family::AlongEdges, 2248);
}

/// The end of a wall that is a tenth of a nanometre thick, almost along which the ray runs.
#[test]
fn a_sliver_seen_almost_edge_on_was_met_micrometres_too_early() {
    seeded(1057, "near-coplanar", Family::Edges, 6563);
}

/// A door's leaf stands in its opening without a gap: past the edge of the wall, which the ray does not come from within of, it enters the leaf there.
#[test]
fn a_ray_past_the_edge_of_a_wall_went_through_what_stands_against_it() {
    for trial in ["scaled-1e-3", "turned-0"] {
        seeded(1034, trial, Family::Surfaces, 9648);
    }
}

/// Out of the crack between a wall and a door's frame by the side of the floor there, and along the top of the same floor: half a metre behind that side.
#[test]
fn a_ray_along_a_floor_went_through_what_stands_on_it() {
    seeded(165, "house-cad", Family::Borders, 6100);
    seeded(167, "house-cad", Family::Borders, 4756);
}

/// Back through a slab's underside, which roundings bend by a millionth, almost along it: aside, the slab was entered by the other triangle of that side.
#[test]
fn a_ray_on_from_a_bent_side_met_the_rest_of_that_side() {
    seeded(205, "house-cad", Family::AlongEdges, 3792);
    seeded(1092, "house-cad", Family::AlongEdges, 5548);
    seeded(214, "house-cad", Family::Grazing, 9040);
}

/// From a board's underside, a tenth of a nanometre over a floor: beside, it began in the board, and came to the floor later than from anywhere before.
#[test]
fn a_ray_on_from_a_narrow_gap_began_behind_the_surface_that_it_left() {
    seeded(149, "near-coplanar", Family::Grazing, 2812);
}

/// The board stands a millionth of a metre out, less than cells tell, and the ray runs along the wall.
#[test]
fn a_ray_along_a_wall_passed_the_edge_of_a_board_on_it() {
    seeded(51, "near-coplanar", Family::Edges, 4658);
    seeded(53, "near-coplanar", Family::Edges, 63);
    seeded(51, "near-vertical", Family::Edges, 2713);
}

#[test]
fn a_needle_met_from_within_another_had_no_witness() {
    seeded(34, "needles", Family::Surfaces, 4990);
}

#[test]
fn a_ray_from_a_bent_floor_passed_it_and_its_segment_did_not() {
    seeded(6, "house-damaged", Family::Surfaces, 8878);
}

#[cfg(feature = "render")]
#[test]
fn a_ray_a_little_above_hundreds_of_edges_was_no_witness() {
    pictured(31, "round-1000", Family::Grazing, 0);
}

#[test]
fn rays_of_no_length_and_from_corners_are_right_by_witnesses_that_rounding_moves() {
    seeded(55, "near-coplanar", Family::Limits, 1986);
    seeded(56, "near-coplanar", Family::Grazing, 2012);
    seeded(61, "near-coplanar", Family::Edges, 940);
}

#[test]
fn a_ray_that_starts_far_from_its_origin_in_a_corner_went_through_a_slab() {
    seeded(64, "scaled-1e6", Family::Limits, 4534);
}

#[test]
fn a_ray_on_from_a_corner_ran_on_inside_the_wall_that_has_it() {
    seeded(66, "tilted-1", Family::Vertices, 4712);
}

#[test]
fn a_ray_that_went_on_beside_a_corner_met_the_plane_again_that_it_left() {
    seeded(68, "tilted-1", Family::Grazing, 2632);
}

#[test]
fn a_ray_past_the_edges_of_stairs_is_right_by_a_witness_that_is_hardly_beside_it() {
    seeded(70, "tilted-0", Family::AlongEdges, 3027);
}

#[test]
fn a_ray_on_from_a_concave_edge_went_through_the_slab_and_met_what_that_lies_on() {
    seeded(72, "tilted-1", Family::Edges, 1380);
}

#[test]
fn a_ray_from_the_edge_of_a_wall_met_a_face_that_goes_on_behind_that() {
    seeded(73, "house-cad", Family::AlongEdges, 1020);
    seeded(73, "house-cad", Family::AlongEdges, 2240);
}

#[test]
fn a_segment_that_ends_almost_along_a_face_was_not_looked_at_behind_that() {
    seeded(70, "tilted-1", Family::AlongEdges, 919);
}

#[test]
fn a_ray_along_a_face_that_meets_its_edge_is_right_by_a_witness_through_that_very_edge() {
    seeded(1001, "scaled-1e-3", Family::Grazing, 1049);
    seeded(1002, "turned-0", Family::AlongEdges, 7916);
}

#[test]
fn a_ray_from_between_boards_a_picometre_apart_met_again_what_it_left() {
    seeded(94, "near-coplanar", Family::Surfaces, 6372);
}

#[test]
fn a_ray_on_down_a_wall_met_a_slab_beside_it_that_only_a_ray_within_the_wall_meets() {
    seeded(1113, "scaled-1e5", Family::Grazing, 2880);
    seeded(1113, "scaled-1e6", Family::Grazing, 2880);
}

#[test]
fn a_ray_on_down_along_a_bent_ceiling_met_its_back_from_within_the_slab() {
    seeded(230, "house-cad", Family::Borders, 6236);
}

/// Each starts in a solid and leaves it within the tolerance, but its segment ends before that.
#[test]
fn a_segment_that_ended_in_the_solid_that_its_ray_leaves_at_once_had_that_in_its_way() {
    for (seed, index) in [(239, 3476), (239, 6936), (241, 4925), (1128, 9891)] {
        seeded(seed, "scaled-1e2", Family::Borders, index);
    }
    seeded(243, "scaled-1e2", Family::Anywhere, 5387);
}

/// It starts behind the face of what is open, by what cells are rounded, and comes through that almost along it.
#[test]
fn a_segment_from_just_behind_an_open_face_was_not_stopped_by_that() {
    seeded(232, "house-damaged", Family::Borders, 180);
}

#[test]
fn a_ray_on_from_a_walls_bent_side_met_it_from_within() {
    seeded(241, "turned-3", Family::Surfaces, 7404);
}

/// Its end is a few millimetres before it leaves a cell, in the next of which it comes near an edge; it starts on the edge of a wall.
#[test]
fn a_segment_met_where_it_starts_what_its_ray_does_not() {
    seeded(249, "turned-0", Family::Surfaces, 4946);
}

/// It would leave the solid into a gap narrower than it is long, and ends before that.
#[test]
fn a_segment_that_ends_before_a_narrow_gap_was_said_to_be_wrong() {
    seeded(250, "house-cad", Family::Limits, 10017);
}

/// Up within it, to where its front is flush with the wall's: half a millimetre below the edge of the wall's opening, by which it was let past both.
#[test]
fn a_ray_from_within_a_frame_does_not_pass_its_front() {
    seeded(1139, "turned-5", Family::Zeros, 3964);
}

/// From the back of its underside, which a ray along that had come to: it starts in the slab, and was told to leave that by its side.
#[test]
fn a_ray_on_from_the_back_of_a_bent_slab_ran_on_inside_of_it() {
    seeded(275, "house-cad", Family::AlongEdges, 8916);
}

/// Where walls are thinner than cells are blurred in houses, the cell behind one is as near to what stands before it.
#[test]
fn a_ray_on_from_a_hit_asks_no_cell_that_is_only_near() {
    staged_with(1, "scaled-1e-3", Family::Anywhere, |_, scene| {
        let (prisms, tolerance) = (Prisms::new(&scene.tables), scene.tolerance());
        let mut random = SplitMix64::new(3);
        let rooms: Vec<[[f64; 3]; 2]> = scene.rooms().map(|room| room.bounds()).collect();
        let mut asked = 0;
        for round in 0..20_000 {
            let [lo, hi] = rooms[round % rooms.len()];
            let [from, to] = [0, 1].map(|_| DVec3::from([0, 1, 2].map(|i| random.between(lo[i], hi[i]))));
            let hit = scene.trace_from(
                Start::Anywhere,
                &Ray::new(from.to_array(), (to - from).to_array()),
                Want::default(),
            );
            if hit.triangle == NONE || hit.cell == 0 {
                continue;
            }
            let (normal, way) = (DVec3::from(hit.normal), (to - from).normalize());
            let onward = Ray::new(hit.point, (way - 2.0 * way.dot(normal) * normal).to_array());
            let told = scene.trace_from(Start::Hit(&hit), &onward, Want::default());
            let local = prisms.local(hit.point.into());
            for (cell, record) in (0..).zip(prisms.cells).filter(|(_, record)| record.kind == CellRecord::AIR)
            {
                let is_near = |margin: f64| prisms.nearly_holds(record, local, margin);
                if is_near(BLURRED) && !is_near(2.0 * tolerance) {
                    let other = scene.trace_from(Start::Hit(&Hit { cell, ..hit }), &onward, Want::default());
                    assert!(
                        (told.t - other.t).abs() <= tolerance || told.t == other.t,
                        "{onward:?} {told:?} {other:?}"
                    );
                    asked += 1;
                }
            }
        }
        assert!(asked > 1000, "{asked}");
    });
}

#[test]
fn a_ray_from_a_wall_between_another_and_a_ceiling_escaped_through_these() {
    seeded(1178, "house-damaged", Family::Surfaces, 4620);
    seeded(1178, "house-damaged", Family::AlongEdges, 5732);
}

#[test]
fn a_ray_that_met_nothing_was_looked_for_at_the_edge_of_that() {
    seeded(1181, "scaled-1e-3", Family::Edges, 424);
}

#[test]
fn a_ray_within_an_open_wall_went_through_its_other_side() {
    for index in [5296, 5872, 9132] {
        seeded(1184, "house-damaged", Family::Borders, index);
    }
}

#[test]
fn a_ray_from_a_wall_met_behind_it_the_corner_that_it_had_passed() {
    seeded(332, "house-cad", Family::AlongEdges, 5036);
}

#[test]
fn a_ray_from_a_doorways_corner_went_up_through_its_lintel() {
    seeded(1227, "turned-5", Family::Surfaces, 9760);
}

/// What it met is thin, and ends at the corner from which the ray goes on.
#[test]
fn a_ray_that_goes_on_met_what_ends_behind_it() {
    seeded(423, "house-damaged", Family::AlongEdges, 4784);
}

#[test]
fn a_ray_from_one_part_of_a_wall_met_its_plane_again_where_another_part_laps_over_it() {
    seeded(439, "house-damaged", Family::Vertices, 3960);
}
