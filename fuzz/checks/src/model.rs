//! What a model that was read must keep, and what every model goes through then: tagging, compilation, rays.

use std::collections::HashSet;

use enfilade::importers::{ImportError, Model, tagging};
use enfilade::{CompileOptions, compile};

use crate::ask::{self, Origin};
use crate::{limits, options};

/// Elements and triangles of models that go on to rays: larger ones only make the fuzzer slow.
const MOST_ELEMENTS: usize = 32;
const MOST_TRIANGLES: u64 = 2000;

/// An error must say something of something.
pub fn check_error(error: &ImportError) {
    assert!(!error.file.is_empty(), "{error:?}");
    assert!(error.to_string().len() > error.file.len() + 2, "{error:?}");
}

/// Checks a model as a reader returned it, tags and compiles it, opens the scene and asks it everything.
pub fn go_on(mut model: Model) {
    check(&model);
    if model.elements.len() > MOST_ELEMENTS || model.triangle_count() > MOST_TRIANGLES {
        return;
    }
    // The shipped table takes longer to parse than a small file to read: not every time.
    if model.source_hash.is_multiple_of(64)
        && let Err(error) = tagging::tag(&mut model, &options())
    {
        panic!("a model without tags is no error: {error}");
    }
    let mut options = CompileOptions::default();
    options.limits = limits();
    if let Ok(compiled) = compile(&model, &options) {
        ask::everything(&mut compiled.scene(), Origin::Compiled);
    }
}

/// The promises of [`Model`].
pub fn check(model: &Model) {
    assert!(!model.elements.is_empty() && !model.materials.is_empty());
    let mut ids = HashSet::new();
    for element in &model.elements {
        assert!(!element.id.is_empty() && ids.insert(element.id.as_str()), "id '{}'", element.id);
        let mesh = &element.mesh;
        assert!(!mesh.triangles.is_empty(), "element '{}' has no triangles", element.id);
        assert_eq!(mesh.triangles.len(), mesh.materials.len());
        assert!(mesh.positions.iter().flatten().all(|c| c.is_finite()), "element '{}'", element.id);
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
        assert!(mesh.triangles.iter().all(|[a, b, c]| a != b && b != c && c != a));
        assert!(mesh.materials.iter().all(|m| (m.0 as usize) < model.materials.len()));
    }
    let left_out: u64 = model.left_out.iter().filter(|l| l.reason.is_triangles()).map(|l| l.count).sum();
    assert_eq!(model.triangle_count() + left_out, model.triangles_read, "triangles are lost");
    for material in &model.materials {
        let numbers =
            [material.alpha, material.metallic, material.roughness, material.ior, material.transmission];
        let numbers = material.base_color.iter().chain(&material.emissive).chain(&numbers);
        assert!(numbers.clone().all(|c| c.is_finite()), "{material:?}");
    }
    for light in &model.lights {
        assert!(light.position.iter().chain(&light.direction).all(|c| c.is_finite()), "{light:?}");
    }
    for camera in &model.cameras {
        let numbers = camera.eye.iter().chain(&camera.direction).chain(&camera.up);
        assert!(numbers.clone().all(|c| c.is_finite()), "{camera:?}");
        assert!(camera.vfov_degrees > 0.0 && camera.vfov_degrees < 180.0, "{camera:?}");
    }
}

#[cfg(test)]
mod tests {
    use enfilade::arbitrary::assemblies;
    use proptest::test_runner::{Config, RngSeed, TestRunner};

    use super::*;

    #[test]
    fn what_degenerate_models_compile_to_can_be_asked_everything() {
        let config =
            Config { cases: 60, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..Config::default() };
        let every = |assembly: enfilade::arbitrary::Assembly| {
            let compiled = compile(&assembly.model(), &CompileOptions::default()).unwrap();
            ask::everything(&mut compiled.scene(), Origin::Compiled);
            Ok(())
        };
        TestRunner::new(config).run(&assemblies(), every).unwrap();
    }
}
