//! Answers to rays in small models of any shape, compared with the truth.

use enfilade::importers::{Model, Semantic, Untagged, obj};
use enfilade::roles::roles;
use enfilade::{CompileOptions, VerifyOptions, compile, verify};

use crate::{FILE, limits, model, options};

/// Triangles of models that are verified: the truth looks at each of them for each ray.
const MOST_TRIANGLES: u64 = 64;

/// Coordinates of models that are verified, metres. Far beyond it the tolerance is no longer many roundings.
const FARTHEST: f64 = 1e5;

/// Reads `input` as OBJ, compiles it, and verifies rays in it.
pub fn check(input: &[u8]) {
    let Ok(mut read) = obj::read_text(input, FILE, None, &options()) else { return };
    let far = |model: &Model| model.bounds().is_none_or(|b| b.iter().flatten().any(|c| c.abs() > FARTHEST));
    if read.triangle_count() > MOST_TRIANGLES || far(&read) {
        return;
    }
    model::check(&read);
    // By a letter, as tagging takes longer than all the rest.
    for element in &mut read.elements {
        element.semantic = match element.source_name.chars().next() {
            Some('R') => Semantic::Room,
            Some('W') => Semantic::Wall,
            Some('F') => Semantic::Furniture,
            _ => Semantic::Unknown,
        };
    }
    let mut options = CompileOptions::default();
    options.limits = limits();
    let Ok(compiled) = compile(&read, &options) else { return };
    let (scene, roles) = (compiled.scene(), roles(&read, Untagged::default()));
    let mut options = VerifyOptions::default().with_rays(24).with_grid_rays(24);
    (options.solid_rays, options.hard_rays) = (24, 24);
    let trace =
        |rays: &[enfilade::Ray], hits: &mut [enfilade::Hit]| scene.trace_many(rays, hits, Default::default());
    let occluded = |rays: &[enfilade::Ray]| enfilade::verify::sees(&scene, rays);
    match verify(&read, |element| roles[element.0 as usize], &(trace, occluded), &options) {
        Ok(report) => {
            assert_eq!(report.grid.different, 0, "{:?}", report.grid);
            assert_eq!(report.total.wrong, 0, "{:#?}", report.wrong);
            assert_eq!(report.sight.different, 0, "{:#?}", report.sight);
        }
        Err(_) => unreachable!("nobody cancels"),
    }
}
