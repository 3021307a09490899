use super::*;
use crate::generate::{HouseOptions, Style, house};

fn report() -> SkipReport {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    skip(&model, &SkipOptions { rays: 3000, repeat: 1, ..SkipOptions::default() }).unwrap()
}

#[test]
fn what_is_skipped_changes_no_answer_and_is_less() {
    let report = report();
    assert_eq!(report.rays, 3000);
    for row in &report.rows {
        assert_eq!(row.differing, Some(0), "{}", row.skipped);
    }
    let [cells, plain, empty, level, careful, ..] = &report.rows[..] else { panic!("{:?}", report.rows) };
    let both = |row: &SkipRow| (row.with.steps.unwrap(), row.without.steps.unwrap());
    let all = |steps: Steps| steps.nodes + steps.blocks + steps.tests;
    let (with, without) = both(cells);
    assert!(all(without) > 1.5 * all(with), "{cells:?}");
    let (with, without) = both(plain);
    assert!(with.plain > 0.5 && without.plain == 0.0 && without.tests > with.tests, "{plain:?}");
    // Each empty cell costs a node then, and no cell is empty.
    let (with, without) = both(empty);
    assert!(with.empty > 0.001 && without.empty == 0.0, "{empty:?}");
    assert!((without.nodes - with.nodes - with.empty).abs() < 0.02, "{empty:?}");
    let (with, without) = both(level);
    assert_eq!((with.cells, with.tests), (without.cells, without.tests));
    // Every cell that it leaves is left as one between slopes then, but where it is in doubt.
    assert!(with.sloped == 0.0 && without.sloped > 0.9 * without.cells, "{level:?}");
    let held = |what: &str| report.held.iter().find(|row| row.what == what).unwrap();
    assert!(held("cells of air").skipped() > 95.0 && held("triangles").skipped() > 99.9, "{:?}", report.held);
    let sections = held("sections of the file");
    assert!(sections.taken > 10.0 && sections.skipped() > 10.0, "{sections:?}");
    let (with, without) = both(careful);
    assert!(without.tests > with.tests, "{careful:?}");
    let [map, checks] = &report.files[..] else { panic!("{:?}", report.files) };
    assert!(map.without.bytes > map.with.bytes && checks.with.bytes == Some(0));
}

#[test]
fn reports_are_told() {
    let report = report();
    let lines = |text: &str| text.lines().filter(|line| !line.is_empty()).count();
    assert_eq!(
        lines(&report.text()),
        1 + 1 + report.held.len() + 1 + report.rows.len() + 1 + report.files.len()
    );
    assert_eq!(
        lines(&report.markdown()),
        1 + 2 + report.held.len() + 2 + report.rows.len() + 2 + report.files.len()
    );
}

#[test]
fn one_ray_sees_nobody() {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let report = skip(&model, &SkipOptions { rays: 1, repeat: 1, ..SkipOptions::default() }).unwrap();
    assert!(
        report
            .rows
            .iter()
            .all(|row| row.with.ns.is_finite() && row.skipped != "which of several things is nearest")
    );
}
