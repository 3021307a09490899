//! Tracers that are right, right enough, and wrong in every way, on the house of the fixtures.
//!
//! The tracers here look at every triangle of a model of their own, which is the house or one that was tampered with.

use enfilade_importers::{CancelToken, MaterialId, Semantic};

use super::*;
use crate::oracle::fixtures::{Shape, house, model, role_of};
use crate::oracle::right::{Verdict, Why};
use crate::oracle::{TrueAnswer, TruthOptions};
use crate::trace::NONE;

/// A tracer by the truth about some model.
struct Plain {
    truth: Truth,
    model: Model,
}

impl Plain {
    fn of(model: Model) -> Plain {
        let truth = Truth::new(&model, role_of(&model), &TruthOptions::default());
        Plain { truth, model }
    }

    fn hit(&self, ray: &Ray) -> Hit {
        match self.truth.answer(ray) {
            TrueAnswer::Escaped => Hit::ESCAPED,
            TrueAnswer::InSolid(solids) => Hit::in_solid(solids[0].0, 0),
            TrueAnswer::Hit(nearest) => {
                let element = nearest.element.0;
                let [a, b, c] = self.model.elements[element as usize].mesh.corners(nearest.triangle as usize);
                let normal = glam::DVec3::from(b) - glam::DVec3::from(a);
                let normal = normal.cross(glam::DVec3::from(c) - glam::DVec3::from(a)).normalize();
                let direction = glam::DVec3::from(ray.direction).normalize();
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                let hit = Hit { t: nearest.t, element, normal: normal.to_array(), ..Hit::ESCAPED };
                at(ray, hit, nearest.t)
            }
        }
    }
}

/// The hit at another `t`.
fn at(ray: &Ray, hit: Hit, t: f64) -> Hit {
    let direction = glam::DVec3::from(ray.direction).normalize();
    Hit { t, point: (glam::DVec3::from(ray.origin) + direction * t).to_array(), ..hit }
}

fn options() -> VerifyOptions {
    VerifyOptions::default().with_rays(10_000).with_grid_rays(500)
}

fn check(tracer: impl Fn(&Ray) -> Hit + Sync) -> VerifyReport {
    check_with(&options(), tracer)
}

fn check_with(options: &VerifyOptions, tracer: impl Fn(&Ray) -> Hit + Sync) -> VerifyReport {
    let house = house();
    let all = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = tracer(ray));
    };
    verify(&house, role_of(&house), &all, options).unwrap()
}

fn moved(mut model: Model, by: impl Fn([f64; 3]) -> [f64; 3]) -> Model {
    for element in &mut model.elements {
        for p in &mut element.mesh.positions {
            *p = by(*p);
        }
    }
    model
}

#[test]
fn the_truth_passes() {
    let plain = Plain::of(house());
    let report = check(|ray| plain.hit(ray));
    assert!(report.passed());
    assert_eq!((report.total.rays, report.rooms), (10_000 + 200 + 500, 2));
    assert_eq!(report.total.exact + report.total.in_solid_agreed, report.total.rays);
    assert_eq!(report.total.hits + report.total.escaped + report.total.in_solid, report.total.rays);
    assert!(report.total.in_solid >= 200 && report.total.escaped > 100, "{:?}", report.total);
    assert_eq!((report.excused, report.forward.max, report.largest_backward), (0.0, 0.0, 0.0));
    assert_eq!(report.kinds.iter().map(|k| k.tally.rays).collect::<Vec<_>>(), [5000, 5000, 200, 500]);
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["kinds"][0]["kind"], "room");
    assert_eq!(json["total"]["wrong"], 0);
}

#[test]
fn a_tracer_in_f32_is_right() {
    let plain = Plain::of(house());
    let report = check(|ray| {
        let hit = plain.hit(ray);
        if hit.t.is_finite() { at(ray, hit, f64::from(hit.t as f32)) } else { hit }
    });
    assert!(report.passed(), "{:?}", report.wrong);
    assert!(report.total.close > 5000 && report.forward.max < 1e-6 && report.forward.max > 1e-9);

    // So is one whose vertices are f32, or moved by up to a fifth of a millimetre: only rays beside edges differ.
    for wobble in [0.0, 2e-4] {
        let tampered = moved(house(), |p| {
            p.map(|c| f64::from((c + wobble * (17.0 * c + p[0] + 2.0 * p[1] + 3.0 * p[2]).sin()) as f32))
        });
        let plain = Plain::of(tampered);
        let report = check(|ray| plain.hit(ray));
        let random: Vec<_> = report.kinds[..2].iter().map(|k| &k.tally).collect();
        assert_eq!(random[0].wrong + random[1].wrong, 0, "{:?}", report.wrong);
        assert!(report.total.edge > 0 && report.largest_backward <= 1e-3);
        assert!(!report.edges.is_empty() && report.edges[0].verdict.backward() <= 1e-3);
    }
}

#[test]
fn a_dropped_triangle_is_noticed() {
    let mut tampered = house();
    // Of the ceiling, half its lower side.
    let mesh = &mut tampered.elements[1].mesh;
    mesh.triangles.remove(0);
    mesh.materials.remove(0);
    let plain = Plain::of(tampered);
    let report = check(|ray| plain.hit(ray));
    assert!(!report.passed());
    let by = &report.total.wrong_by_kind;
    assert!(by[&Why::WentThrough] > 200, "{by:?}");
    assert_eq!(report.wrong.len(), 20);
    let case = &report.wrong[0];
    assert!(matches!(case.expected, Said::Hit { element: 1, .. }) && case.kind == RayKind::Room);
    assert_eq!(case.verdict, Verdict::Wrong { why: Why::WentThrough });
}

#[test]
fn segments_that_are_told_otherwise_than_their_rays_are_noticed() {
    let (house, plain) = (house(), Plain::of(house()));
    let trace = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = plain.hit(ray));
    };
    let report = |occluded: &(dyn Fn(&Hit, f64) -> bool + Sync)| {
        let all = |rays: &[Ray]| {
            let whole = |ray: &Ray| plain.hit(&Ray { tmax: f64::INFINITY, ..*ray });
            rays.iter().map(|ray| occluded(&whole(ray), ray.tmax)).collect::<Vec<bool>>()
        };
        verify(&house, role_of(&house), &(trace, all), &options()).unwrap()
    };
    let is_met = |hit: &Hit, tmax: f64| match hit.answer() {
        Answer::Escaped => false,
        Answer::InSolid(_) => true,
        Answer::Hit(hit) => hit.t <= tmax,
    };
    let right = report(&is_met);
    assert!(right.passed(), "{:?}", right.sight);
    let asked = right.sight.rays;
    assert!(asked > 9_000 && (asked / 3..asked * 2 / 3).contains(&right.sight.occluded), "{:?}", right.sight);
    let [free, barred] = [false, true].map(|said| report(&move |_, _| said));
    assert!(!free.passed() && free.total.wrong == 0);
    assert_eq!(free.sight.different, right.sight.occluded);
    assert_eq!(barred.sight.different, asked - right.sight.occluded);
    // Seldom, but by no more than a centimetre.
    let late = report(&|hit, tmax| is_met(hit, tmax - 0.01));
    assert!((100..asked / 3).contains(&late.sight.different), "{:?}", late.sight);
    let case = &late.sight.cases[0];
    assert!(case.occluded && late.sight.cases.len() == 20);
    let blind = verify(&house, role_of(&house), &trace, &options()).unwrap();
    assert!(blind.passed() && blind.sight == SightTally::default());
}

#[test]
fn shifted_distances_are_noticed() {
    let plain = Plain::of(house());
    let report = check(|ray| {
        let hit = plain.hit(ray);
        if hit.t.is_finite() { at(ray, hit, hit.t + 2e-3) } else { hit }
    });
    let room = &report.kinds[0].tally;
    // Rays that graze a surface are right by a ray beside them; they are the share that such slopes have.
    assert!(room.wrong > 3500 && room.edge == room.rays - room.wrong, "{room:?}");
    // Half of the tolerance is right everywhere, but where the segment is left.
    let report = check(|ray| {
        let hit = plain.hit(ray);
        if hit.t.is_finite() { at(ray, hit, hit.t + 0.5e-3) } else { hit }
    });
    assert_eq!(report.total.wrong, 0, "{:?}", report.wrong);
    assert!((report.forward.mean - 0.5e-3).abs() < 1e-12);
}

#[test]
fn wrong_elements_misses_and_phantoms_are_noticed() {
    let plain = Plain::of(house());
    // For what is wrong all is looked for that might make it right.
    let few = options().with_rays(2500);
    let report = check_with(&few, |ray| {
        let hit = plain.hit(ray);
        let element = if hit.element < 9 { (hit.element + 1) % 9 } else { hit.element };
        Hit { element, ..hit }
    });
    assert!(report.total.wrong_by_kind[&Why::OtherElement] > 1250);
    assert!(report.total.wrong_by_kind[&Why::NotInSolid] > 25);

    let report = check_with(&few, |_| Hit::ESCAPED);
    assert!(report.total.wrong_by_kind[&Why::Missed] > 2000);
    assert!(report.total.wrong_by_kind[&Why::StartsInSolid] >= 50);
    assert!(report.total.exact > 25, "those that do escape");

    let nearby = Hit { t: 0.5, element: 2, normal: [0.0; 3], ..Hit::ESCAPED };
    let report = check_with(&few, |ray| at(ray, nearby, 0.5));
    assert!(report.total.wrong > 2475 && report.total.wrong_by_kind[&Why::Phantom] > 25);

    let report = check_with(&few, |ray| Hit::in_solid(0, ray.origin[0].to_bits() as u32 % 7));
    assert!(report.total.wrong_by_kind[&Why::NotInSolid] > 2250);
}

#[test]
fn a_leak_along_an_edge_is_noticed() {
    // The triangles of the outer side of one wall shrink by 3 mm: rays pass between them.
    let mut tampered = house();
    let wall = &mut tampered.elements[2].mesh;
    let mut positions = Vec::new();
    for t in 0..wall.triangles.len() {
        let corners = wall.corners(t);
        let middle = [0, 1, 2].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        for p in corners {
            positions.push([0, 1, 2].map(|i| p[i] + 0.003 * (middle[i] - p[i])));
        }
    }
    wall.triangles = (0..wall.triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    wall.materials = vec![MaterialId(0); wall.triangles.len()];
    wall.positions = positions;
    let plain = Plain::of(tampered);
    let report = check(|ray| plain.hit(ray));
    assert!(report.total.wrong > 0);
    let leaks = report.wrong.iter().filter(|case| matches!(case.expected, Said::Hit { element: 2, .. }));
    assert!(leaks.count() > 0, "{:?}", report.wrong);
}

#[test]
fn records_that_contradict_themselves_are_noticed() {
    let plain = Plain::of(house());
    let breaks: [fn(Hit) -> Hit; 4] = [
        |hit| Hit { point: [hit.point[0], hit.point[1] + 0.01, hit.point[2]], ..hit },
        |hit| Hit { normal: hit.normal.map(|c| -c), ..hit },
        |hit| Hit { normal: [0.0; 3], ..hit },
        |hit| Hit { point: [f64::NAN; 3], ..hit },
    ];
    for broken in breaks {
        let report = check(|ray| {
            let hit = plain.hit(ray);
            if hit.t.is_finite() { broken(hit) } else { hit }
        });
        assert!(report.total.wrong_by_kind[&Why::BadRecord] > 5000);
    }
    // Labels of air cannot be hit.
    let report = check(|ray| {
        let hit = plain.hit(ray);
        if hit.t.is_finite() { Hit { element: 11, ..hit } } else { hit }
    });
    assert!(report.total.wrong_by_kind[&Why::OtherElement] > 5000);
    let report = check(|_| Hit { element: NONE, ..Hit::in_solid(NONE, 0) });
    assert_eq!(report.total.wrong, report.total.rays);
}

#[test]
fn the_same_report_at_any_number_of_threads_and_another_for_another_seed() {
    let house = house();
    let plain = Plain::of(house.clone());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| {
            *hit = plain.hit(ray);
            hit.t *= 1.0 + 1e-5;
        });
    };
    let run = |seed| verify(&house, role_of(&house), &tracer, &options().with_seed(seed)).unwrap();
    let first = run(4);
    #[cfg(feature = "rayon")]
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert_eq!(pool.install(|| run(4)), first);
    }
    assert_ne!(run(5).forward, first.forward);
}

#[test]
fn cancelled_and_reported() {
    let house = house();
    let plain = Plain::of(house.clone());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = plain.hit(ray));
    };
    let token = CancelToken::new();
    let stop = token.clone();
    let watch = Watch::default().with_cancel(token).with_progress(move |stage, done| {
        assert!(stage == "verify" && (0.0..=1.0).contains(&done));
        stop.cancel();
    });
    let result = verify(&house, role_of(&house), &tracer, &options().with_watch(watch));
    assert_eq!(result.unwrap_err(), Cancelled);
    let last = std::sync::Arc::new(std::sync::Mutex::new(0.0f64));
    let seen = last.clone();
    let watch = Watch::default().with_progress(move |_, done| {
        let mut last = seen.lock().unwrap();
        *last = last.max(done);
    });
    verify(&house, role_of(&house), &tracer, &options().with_watch(watch)).unwrap();
    assert_eq!(*last.lock().unwrap(), 1.0);
}

#[test]
fn inside_out_and_badly_wound_houses_verify() {
    let mut inverted = house();
    for (index, element) in inverted.elements.iter_mut().enumerate() {
        for (t, triangle) in element.mesh.triangles.iter_mut().enumerate() {
            if index % 2 == 0 || t % 5 == 0 {
                triangle.swap(0, 1);
            }
        }
    }
    let plain = Plain::of(house());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = plain.hit(ray));
    };
    let report = verify(&inverted, role_of(&inverted), &tracer, &options()).unwrap();
    assert_eq!(report.total.wrong, 0, "{:?}", report.wrong);
    assert!(report.total.in_solid_agreed >= 200);
}

#[test]
fn a_model_without_rooms_or_anything_to_see() {
    let label = model(&[(Semantic::Room, Shape::cuboid([0.0; 3], [1.0; 3]))]);
    let escape = |_: &[Ray], hits: &mut [Hit]| hits.fill(Hit::ESCAPED);
    let report = verify(&label, role_of(&label), &escape, &options()).unwrap();
    assert!(report.passed() && report.triangles == 0 && report.total.exact == report.total.rays);
    let one = model(&[(Semantic::Wall, Shape::cuboid([0.0; 3], [1.0; 3]))]);
    let plain = Plain::of(one.clone());
    let tracer = |rays: &[Ray], hits: &mut [Hit]| {
        rays.iter().zip(hits).for_each(|(ray, hit)| *hit = plain.hit(ray));
    };
    let report = verify(&one, role_of(&one), &tracer, &options()).unwrap();
    assert_eq!((report.total.wrong, report.rooms), (0, 0));
}
