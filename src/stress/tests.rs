//! The suite in little, and that it finds what is bad.

use super::*;

#[test]
fn every_trial_is_compiled_and_nothing_bad_is_found() {
    let report = stress(&StressOptions { rays: 21_000, ..StressOptions::default() }).unwrap();
    assert!(report.passed(), "{}", report.text());
    assert!(report.total.rays >= 21_000 && report.total.onward > 1000);
    let cut = report.rows.iter().filter(|row| row.cells > 1).count();
    assert!(cut * 2 > report.rows.len(), "cells in {cut} of {} trials", report.rows.len());
}
