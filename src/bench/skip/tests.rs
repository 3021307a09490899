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
        assert_eq!(row.differing, 0, "{}", row.skipped);
    }
    let [cells, plain, empty, level, careful, ..] = &report.rows[..] else { panic!("{:?}", report.rows) };
    let steps = |work: &Work| work.nodes + work.blocks + work.tests;
    assert!(steps(&cells.without) > 1.5 * steps(&cells.with), "{cells:?}");
    assert!(plain.with.plain > 0.5 && plain.without.plain == 0.0, "{plain:?}");
    assert!(plain.without.tests > plain.with.tests);
    // Each empty cell costs a node then, and no cell is empty.
    assert!(empty.with.empty > 0.001 && empty.without.empty == 0.0, "{empty:?}");
    assert!((empty.without.nodes - empty.with.nodes - empty.with.empty).abs() < 0.02, "{empty:?}");
    assert_eq!((level.with.cells, level.with.tests), (level.without.cells, level.without.tests));
    assert!(careful.without.tests > careful.with.tests, "{careful:?}");
    let [map, checks] = &report.files[..] else { panic!("{:?}", report.files) };
    assert!(map.without.bytes > map.with.bytes && checks.with.bytes == 0);
}

#[test]
fn reports_are_told() {
    let report = report();
    let lines = |text: &str| text.lines().filter(|line| !line.is_empty()).count();
    assert_eq!(lines(&report.text()), 1 + 1 + report.rows.len() + 1 + report.files.len());
    assert_eq!(lines(&report.markdown()), 1 + 2 + report.rows.len() + 2 + report.files.len());
}
