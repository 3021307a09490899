//! Ways that are wrong in each way that is counted.

use super::*;
use crate::generate::{HouseOptions, Style, house};
use crate::render::room_views;
use crate::trace::{Kernel, Start, Starts, Want};
use crate::{CompileOptions, compile};

/// enfilade, with its answers and its rays on from them changed.
struct Changed<C, O> {
    scene: Arc<Scene>,
    change: C,
    onward: O,
}

impl<C, O> Way for Changed<C, O>
where
    C: Fn(usize, &mut Hit) + Sync,
    O: Fn(&Hit, &Ray, Hit) -> Hit + Sync,
{
    fn name(&self) -> &str {
        "changed"
    }
    fn trace(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.scene.trace_many(rays, hits, Want::LEAST);
        hits.iter_mut().enumerate().for_each(|(index, hit)| (self.change)(index, hit));
    }
    fn trace_onward(&self, from: &[Hit], rays: &[Ray], hits: &mut [Hit]) {
        self.scene.trace_many_of(Starts::Hits(from), rays, hits, Want::LEAST);
        for ((from, ray), hit) in from.iter().zip(rays).zip(hits) {
            *hit = (self.onward)(from, ray, *hit);
        }
    }
}

fn measured(names: &[&str], change: impl Fn(usize, &mut Hit) + Sync) -> ErrorReport {
    measured_onward(names, change, |_, _, hit| hit)
}

fn measured_onward(
    names: &[&str],
    change: impl Fn(usize, &mut Hit) + Sync,
    onward: impl Fn(&Hit, &Ray, Hit) -> Hit + Sync,
) -> ErrorReport {
    measured_on(&Style::exact(), names, change, onward)
}

fn measured_on(
    style: &Style,
    names: &[&str],
    change: impl Fn(usize, &mut Hit) + Sync,
    onward: impl Fn(&Hit, &Ray, Hit) -> Hit + Sync,
) -> ErrorReport {
    measured_with(style, names, None, change, onward)
}

fn measured_with(
    style: &Style,
    names: &[&str],
    flip: Option<Compare>,
    change: impl Fn(usize, &mut Hit) + Sync,
    onward: impl Fn(&Hit, &Ray, Hit) -> Hit + Sync,
) -> ErrorReport {
    let model = house(&HouseOptions::default()).export(style).to_model().unwrap();
    let scene = Arc::new(compile(&model, &CompileOptions::default()).unwrap().scene());
    assert_eq!(scene.elements().any(|element| element.is_derived()), style.openings_missing > 0.0);
    let views: Vec<Camera> = room_views(&scene, 1).into_iter().take(3).collect();
    let kernels = names.iter().map(|name| (*name).to_owned()).collect();
    let options = ErrorOptions { size: (24, 20), repeat: 1, kernels, flip, ..ErrorOptions::default() };
    let way = Changed { scene: Arc::clone(&scene), change, onward };
    let report = error(&scene, &model, &views, &[&way], &options).unwrap();
    assert_eq!((report.frames, report.pixels), (3, 3 * 24 * 20));
    report
}

fn errors(change: impl Fn(usize, &mut Hit) + Sync) -> Errors {
    measured(&[], change).rows[0].errors
}

#[test]
fn every_way_has_its_row_and_enfilade_no_errors() {
    let names = super::super::tracers::error_names();
    let report = measured(&names.iter().map(String::as_str).collect::<Vec<_>>(), |_, _| {});
    assert!(report.rows.len() == names.len() + 1 && report.passed());
    for row in &report.rows {
        let Errors { differing, wrong, leaks, forward, backward, .. } = row.errors;
        assert_eq!((wrong, leaks), (0, 0), "{row:?}");
        assert!(differing <= 2 && forward.largest < 1e-4 && backward.largest < 1e-3, "{row:?}");
        assert!(row.ns_per_ray > 0.0 && row.frame_ms > 0.0);
        if row.kernel.starts_with("enfilade") && row.kernel != "enfilade-f32-rays" {
            let (normals, image) = (row.errors.normals.unwrap(), row.errors.image.unwrap());
            assert!(row.errors.ulps.largest < 1e4 && normals.largest < 1e-12, "{row:?}");
            assert!(image.rmse < 1e-12 && image.visible == 0 && row.errors.double_hits == Some(0), "{row:?}");
        }
    }
    // What f32 makes of rays and triangles.
    let rounded = |name: &str| report.rows.iter().find(|row| row.kernel == name).unwrap().errors.forward;
    for name in ["obvhs-bvh2", "obvhs-cwbvh", "enfilade-f32-rays"] {
        assert!(rounded(name).largest > 1e-8, "{name}");
    }
    assert!(report.rows.iter().any(|row| row.kernel == "truth-f64" && row.errors.normals.is_none()));
}

/// Rooms and openings that the compiler finds are elements of the scene, and none of the model.
#[test]
fn a_scene_in_which_openings_were_found_is_of_its_model() {
    let mut style = Style::exact();
    style.openings_missing = 1.0;
    let report = measured_on(&style, &["enfilade-portable"], |_, _| {}, |_, _, hit| hit);
    assert!(report.rows.iter().all(|row| row.errors.wrong == 0), "{report:?}");
}

#[test]
fn distances_that_are_off_are_told_as_far_as_they_are() {
    let near = errors(|_, hit| hit.t += 3e-4);
    assert_eq!((near.differing, near.wrong), (0, 0));
    for spread in [near.forward, near.backward] {
        assert!((spread.largest - 3e-4).abs() < 1e-9 && (spread.mean - 3e-4).abs() < 1e-9, "{spread:?}");
        assert!((spread.rms - 3e-4).abs() < 1e-9);
    }
    assert!(near.ulps.largest > 1e9 && near.backward_ulps.largest == near.ulps.largest);
    let far = errors(|index, hit| hit.t += if index % 10 == 0 { 0.02 } else { 0.0 });
    // A parallel ray within the tolerance may meet the same element so far off, at a step or an edge.
    assert!(far.wrong >= 100 && far.wrong + far.beside == 144 && far.leaks == 0, "{far:?}");
    assert!((far.wrong_ppm - far.wrong as f64 * 1e6 / 1440.0).abs() < 1e-6);
    assert!(far.forward.largest < 1e-12, "only of right ones");
}

#[test]
fn what_is_missed_or_another_element_is_told() {
    let missed = errors(|index, hit| {
        if index % 12 == 0 {
            *hit = Hit::ESCAPED;
        }
    });
    assert_eq!((missed.leaks, missed.differing), (120, 120));
    assert!(missed.wrong > 100 && missed.image.unwrap().rmse > 0.05, "{missed:?}");
    let other = errors(|_, hit| hit.element = if hit.element == 0 { 1 } else { 0 });
    assert!(other.wrong > 1000 && other.leaks == 0 && other.image.unwrap().visible > 1000, "{other:?}");
}

#[test]
fn normals_and_what_they_do_to_pictures_are_told() {
    let lean = |hit: &mut Hit| {
        let normal = DVec3::from(hit.normal);
        hit.normal = (normal + normal.any_orthonormal_vector() * 0.01).normalize().to_array();
    };
    let leaning = errors(|_, hit| lean(hit));
    let normals = leaning.normals.unwrap();
    assert!((normals.largest - 0.01f64.atan()).abs() < 1e-9 && normals.mean > 0.0099, "{normals:?}");
    let image = leaning.image.unwrap();
    assert!(image.rmse > 1e-4 && image.rmse < 0.01 && image.relative_mse > 0.0, "{image:?}");
    assert_eq!(leaning.differing, 0);
    // Which side a normal is on does not matter.
    let turned = errors(|_, hit| hit.normal = hit.normal.map(|c| -c));
    assert!(turned.normals.unwrap().largest < 1e-12 && turned.double_hits == Some(0));
    let none = errors(|_, hit| hit.normal = [0.0; 3]);
    assert_eq!((none.normals, none.image, none.double_hits), (None, None, None));
}

#[test]
fn planes_that_are_met_twice_are_told() {
    let again = |from: &Hit, _: &Ray, hit: Hit| {
        if from.element.is_multiple_of(2) { Hit { t: 1e-7, ..*from } } else { hit }
    };
    let report = measured_onward(&[], |_, _| {}, again);
    let doubles = report.rows[0].errors.double_hits.unwrap();
    assert!(doubles > 100 && doubles < report.pixels, "{doubles}");
    // Near, but another plane; and the same plane, but far.
    let corner = |from: &Hit, _: &Ray, _: Hit| Hit {
        t: 1e-7,
        normal: DVec3::from(from.normal).any_orthonormal_vector().to_array(),
        ..*from
    };
    assert_eq!(measured_onward(&[], |_, _| {}, corner).rows[0].errors.double_hits, Some(0));
    let far = |from: &Hit, _: &Ray, _: Hit| Hit { t: 0.1, ..*from };
    assert_eq!(measured_onward(&[], |_, _| {}, far).rows[0].errors.double_hits, Some(0));
}

/// Of rays at the corners of triangles: what else is met there is a tie, and what is beside is not.
#[test]
fn ties_are_no_errors() {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let roles = roles(&model, Untagged::default());
    let truth = Truth::new(&model, |e| roles[e.0 as usize], &TruthOptions::default());
    let judge = Judge { truth: &truth, model: &model };
    let [lo, hi] = scene.rooms().next().unwrap().bounds();
    let eye = [0, 1, 2].map(|axis| (lo[axis] + hi[axis]) / 2.0);
    let (mut told, mut past, mut off) = (Score::default(), Score::default(), Score::default());
    for triangle in 0..scene.detail_triangle_count().min(2000) {
        for corner in scene.triangle(triangle) {
            let ray = Ray::new(eye, [0, 1, 2].map(|axis| corner[axis] - eye[axis]));
            let exact = truth.first(&ray);
            let Some(first) = exact.as_ref().filter(|first| first.is_tie()) else { continue };
            let hit = scene.trace_with(Kernel::best(), Start::Anywhere, &ray, Want::LEAST);
            judge.add(&mut told, &ray, exact.as_ref(), &hit, Some(hit.normal));
            // As if the ray had passed it by no more than rounding, or by half a millimetre.
            let direction = DVec3::from(ray.direction).normalize();
            for (sum, aside) in [(&mut past, 1e-12), (&mut off, 4e-4)] {
                for way in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let across = (way - direction * way.dot(direction)).normalize() * aside;
                    let beside = Ray::new((DVec3::from(eye) + across).to_array(), ray.direction);
                    let Some(nearest) = truth.nearest(&beside) else { continue };
                    if first.met.iter().any(|(met, _)| met.element == nearest.element) {
                        continue;
                    }
                    let element = nearest.element.0;
                    judge.add(
                        sum,
                        &ray,
                        exact.as_ref(),
                        &Hit { t: nearest.t, element, ..Hit::ESCAPED },
                        None,
                    );
                }
            }
        }
    }
    let (told, past, off) = (told.errors(), past.errors(), off.errors());
    assert_eq!(told.wrong, 0, "{told:?}");
    assert!(told.backward.largest <= truth.tolerance());
    assert!(past.ties > 5 && past.ties == past.differing, "{past:?}");
    assert!(off.beside > 5 && off.ties == 0 && off.wrong * 10 < off.beside, "{off:?}");
}

#[test]
fn without_pixels_there_is_no_report() {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let scene = Arc::new(compile(&model, &CompileOptions::default()).unwrap().scene());
    let none = error(&scene, &model, &[], &[], &ErrorOptions::default());
    assert!(matches!(none, Err(ErrorFailure::NoPixels)));
}

fn row(kernel: &str, ns_per_ray: f64, rms: f64, wrong: u64) -> ErrorRow {
    let backward = Spread { largest: rms, mean: rms, rms };
    let errors = Errors { backward, wrong, differing: wrong, ..Errors::default() };
    ErrorRow { kernel: kernel.to_owned(), frame_ms: 1.0, ns_per_ray, errors }
}

fn report_of(rows: Vec<ErrorRow>) -> ErrorReport {
    let machine = "a machine".to_owned();
    ErrorReport { version: "0", machine, threads: 1, tolerance: 1e-3, frames: 1, pixels: 100, tied: 3, rows }
}

#[test]
fn what_is_rounded_or_anothers_may_be_wrong() {
    let others = || {
        vec![
            row("enfilade-f32-rays", 1.0, 1e-7, 3),
            row("obvhs-bvh2", 1.0, 1e-7, 1),
            row("Embree", 1.0, 0.0, 1),
        ]
    };
    assert!(report_of(others()).passed());
    for name in ["enfilade-batch", "enfilade-beams-portable", "enfilade-auto", "truth-f64"] {
        assert!(report_of([others(), vec![row(name, 1.0, 0.0, 0)]].concat()).passed());
        assert!(!report_of([others(), vec![row(name, 1.0, 0.0, 1)]].concat()).passed(), "{name}");
    }
}

#[test]
fn the_front_has_those_that_none_is_better_than() {
    let rows = [
        row("slow and exact", 900.0, 0.0, 0),
        row("fast and rough", 50.0, 1e-7, 0),
        row("slower and rougher", 60.0, 1e-6, 0),
        row("between", 100.0, 1e-12, 0),
        row("as accurate, but slower", 110.0, 1e-12, 0),
        row("fastest, but wrong", 10.0, 1e-15, 1),
        row("as fast, but rougher", 100.0, 1e-9, 0),
    ];
    assert_eq!(chart::front(&rows), [1, 3, 0]);
    assert_eq!(chart::front(&rows[5..6]), [0usize; 0]);
}

#[test]
fn reports_are_drawn_and_written() {
    let rows =
        vec![row("one", 50.0, 1e-7, 0), row("two & more", 1234.5, 0.0, 0), row("three", 20.0, 1e-9, 7)];
    let report = report_of(rows);
    let svg = crate::plan::plan_svg(&report.chart("a house"));
    for part in
        ["a house", "ns a ray", ">10<", ">2000<", "1e-17", "1e-7", "2 two &amp; more", "3 three, 7 wrong"]
    {
        assert!(svg.contains(part), "{part}: {svg}");
    }
    // No way, one way, ways without errors.
    for count in [0, 1] {
        let few = report_of(report.rows[..count].to_vec());
        assert!(!crate::plan::plan_png(&few.chart("few"), 300).unwrap().is_empty());
        assert!(few.text().starts_with("a machine, 1 thread(s), 100 pixels of 1 frames, 3 of them"));
    }
    let text = report.text();
    let line = text.lines().find(|line| line.starts_with("two & more")).unwrap();
    assert_eq!(line.split_whitespace().nth(3), Some("1234.5"), "{line}");
    // Columns are aligned.
    let lengths: Vec<usize> = text.lines().skip(1).take(4).map(str::len).collect();
    assert!(lengths.iter().all(|length| *length == lengths[0]), "{text}");
    let markdown = report.markdown();
    assert_eq!(markdown.matches("| three | ").count(), 3);
    let row = markdown.lines().find(|line| line.starts_with("| three")).unwrap();
    let head = markdown.lines().find(|line| line.starts_with("| way")).unwrap();
    assert_eq!(row.matches('|').count(), head.matches('|').count());
}

#[test]
fn pictures_are_compared_frame_by_frame() {
    /// The share of bytes that differ.
    fn differing(size: (u32, u32), told: &[u8], exact: &[u8]) -> f64 {
        assert!(size == (24, 20) && told.len() == 3 * 24 * 20 && exact.len() == told.len());
        told.iter().zip(exact).filter(|(told, exact)| told != exact).count() as f64 / told.len() as f64
    }
    let compared = |change: &(dyn Fn(usize, &mut Hit) + Sync)| {
        let report = measured_with(&Style::exact(), &[], Some(differing), change, |_, _, hit| hit);
        let text = report.text();
        assert!(text.contains("flip"), "{text}");
        report.rows[0].errors.image.unwrap().flip.unwrap()
    };
    assert_eq!(compared(&|_, _| {}), 0.0);
    // One pixel of twelve is black; of some of them nothing was met.
    let black = compared(&|index, hit| {
        if index % 12 == 0 {
            *hit = Hit::ESCAPED;
        }
    });
    assert!(black > 0.05 && black <= 1.0 / 12.0, "{black}");
    assert!(!measured(&[], |_, _| {}).text().contains("flip"), "nobody asked");
}
