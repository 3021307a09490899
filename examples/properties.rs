//! Property tests with enfilade's strategies: a program of one's own, here the longest free path from a point, is tried on models that
//! are degenerate on purpose and on damaged exports of generated buildings.
//!
//!     cargo run --release --example properties --features proptest
//!     cargo run --release --example properties --features proptest -- 1000

use std::error::Error;
use std::io::{self, Write};

use enfilade::arbitrary::{assemblies, check_cells, damage, drawings};
use enfilade::building::Building;
use enfilade::importers::Model;
use enfilade::partition::{PartitionOptions, partition};
use enfilade::validate::examine;
use enfilade::{Answer, CompileOptions, Ray, Scene, compile};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};

/// What is to be tested: the longest of the six ways along the axes from a point until something is met, metres; infinite if there is
/// nothing, `None` in matter.
fn longest_way(scene: &Scene, point: [f64; 3]) -> Option<f64> {
    let ways = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let ways = ways.into_iter().flat_map(|way| [way, way.map(|c| -c)]);
    let mut longest = 0.0f64;
    for way in ways {
        match scene.trace(&Ray::new(point, way)) {
            Answer::Hit(hit) => longest = longest.max(hit.t),
            Answer::Escaped => longest = f64::INFINITY,
            Answer::InSolid(_) => return None,
        }
    }
    Some(longest)
}

/// What must hold of it: from halfway along a way nothing is met before its end.
fn holds(model: &Model, point: [f64; 3]) -> Result<(), TestCaseError> {
    let fail = |error: &dyn Error| TestCaseError::fail(error.to_string());
    let scene = compile(model, &CompileOptions::default()).map_err(|e| fail(&e))?.scene();
    let Some(longest) = longest_way(&scene, point) else { return Ok(()) };
    let back = Ray::new(point, [0.0, 0.0, -1.0]);
    if let Answer::Hit(hit) = scene.trace(&back) {
        prop_assert!(hit.t <= longest);
        let half = [point[0], point[1], point[2] - hit.t / 2.0];
        if let Answer::Hit(rest) = scene.trace(&Ray::new(half, [0.0, 0.0, -1.0])) {
            prop_assert!((rest.t - hit.t / 2.0).abs() < 2e-3, "{} after {}", rest.t, hit.t);
        }
    }
    Ok(())
}

/// Tries as many models as the first word says, and writes what held.
///
/// # Errors
/// The smallest model of which something does not hold; a word that is no number.
pub fn run(mut args: impl Iterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let cases = args.next().map_or(Ok(50), |number| number.parse())?;
    let config = Config { failure_persistence: None, ..Config::with_cases(cases) };

    let points = prop::array::uniform3(0.1..8.0f64);
    TestRunner::new(config.clone()).run(&(assemblies(), points.clone()), |(assembly, point)| {
        let model = assembly.model();
        // Not only what is built on enfilade: what enfilade makes can be checked, too.
        let (cells, report) = partition(&model, &PartitionOptions::default())
            .map_err(|error| TestCaseError::fail(error.to_string()))?;
        let findings = check_cells(&cells, report.largest_displacement);
        prop_assert!(findings.is_empty(), "{findings:?}");
        let building =
            Building::new(&model, &cells).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let report = examine(&building);
        prop_assert!(!report.is_fatal(), "{:?}", report.findings);
        holds(&model, point)
    })?;
    writeln!(out, "{cases} degenerate models: it holds")?;

    let cases = cases.div_ceil(10);
    let config = Config { cases, ..config };
    TestRunner::new(config).run(&(drawings(), damage(), points), |(drawing, style, point)| {
        let model = drawing.export(&style).to_model().map_err(|e| TestCaseError::fail(e.to_string()))?;
        holds(&model, point)
    })?;
    writeln!(out, "{cases} damaged exports: it holds")?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut io::stdout().lock())
}
