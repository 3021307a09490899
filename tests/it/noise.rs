//! Models whose corners are off: rounded to a grid, shaken, elements moved apart, leaning as a whole; and with elements left out.
//! Whatever becomes of their cells, every answer is right.
#![cfg(all(feature = "compile", feature = "rayon"))]

use std::collections::HashMap;

use enfilade::generate::{HouseOptions, OfficeOptions, house, random};
use enfilade::importers::{Model, Untagged};
use enfilade::roles::roles;
use enfilade::{CompileOptions, VerifyOptions, compile, verify};
use enfilade_testing::Random;

/// What is done to a model.
#[derive(Clone, Copy, Debug)]
enum Noise {
    /// Corners go to a grid of so many metres.
    Grid(f64),
    /// Corners move by up to half of so many metres along each axis, as welded.
    Shaken(f64),
    /// The same of whole elements.
    Moved(f64),
    /// All leans by so many radians, and is turned.
    Leaning(f64),
    /// A third of the elements lose their triangles.
    Emptied,
    /// Single triangles are turned, of a third of the elements.
    Turned,
}

fn noisy(mut model: Model, noise: Noise, seed: u64) -> Model {
    let mut random = Random::new(seed);
    for element in &mut model.elements {
        let mut off = |size: f64| [0, 1, 2].map(|_| size * (random.unit() - 0.5));
        let mesh = &mut element.mesh;
        match noise {
            Noise::Grid(step) => {
                mesh.positions.iter_mut().flatten().for_each(|c| *c = (*c / step).round() * step);
            }
            Noise::Shaken(size) => {
                // What was one corner stays one.
                let mut known = HashMap::new();
                for p in &mut mesh.positions {
                    let by = *known.entry(p.map(f64::to_bits)).or_insert_with(|| off(size));
                    *p = [0, 1, 2].map(|i| p[i] + by[i]);
                }
            }
            Noise::Moved(size) => {
                let by = off(size);
                mesh.positions.iter_mut().for_each(|p| *p = [0, 1, 2].map(|i| p[i] + by[i]));
            }
            Noise::Leaning(angle) => {
                let turn = glam::DQuat::from_rotation_y(angle) * glam::DQuat::from_rotation_z(0.3);
                mesh.positions.iter_mut().for_each(|p| *p = (turn * glam::DVec3::from(*p)).to_array());
            }
            Noise::Emptied => {
                if random.unit() < 1.0 / 3.0 {
                    mesh.triangles.clear();
                    mesh.materials.clear();
                }
            }
            Noise::Turned => {
                if random.unit() < 1.0 / 3.0 {
                    let some = mesh.triangles.iter_mut().filter(|_| random.unit() < 0.5);
                    some.for_each(|triangle| triangle.swap(1, 2));
                }
            }
        }
    }
    model
}

#[test]
fn every_answer_is_right() {
    let mut options = OfficeOptions::default();
    (options.seed, options.furniture) = (3, false);
    // Of these the second is far larger; shaken, its floors are in thousands of planes.
    let models = [house(&HouseOptions::default()), random(&options)].map(|b| b.to_model().unwrap());
    let noises = [
        Noise::Grid(1e-3),
        Noise::Grid(1e-2),
        Noise::Shaken(2e-4),
        Noise::Shaken(2e-3),
        Noise::Moved(4e-3),
        Noise::Moved(2e-2),
        Noise::Leaning(0.01),
        Noise::Emptied,
        Noise::Turned,
    ];
    for (number, model) in models.iter().enumerate() {
        for (seed, noise) in noises.into_iter().enumerate() {
            if number > 0 && matches!(noise, Noise::Shaken(_) | Noise::Grid(1e-2) | Noise::Moved(4e-3)) {
                continue;
            }
            let model = noisy(model.clone(), noise, seed as u64);
            let compiled = compile(&model, &CompileOptions::default()).unwrap();
            let scene = compiled.scene();
            let roles = roles(&model, Untagged::default());
            let options = VerifyOptions::default().with_rays(2000).with_grid_rays(100);
            let report = verify(&model, |e| roles[e.0 as usize], &scene, &options).unwrap();
            assert!(
                report.passed(),
                "{number} {noise:?}: {:?} {:?} {:?}",
                report.excused,
                report.wrong,
                report.sight
            );
            assert!(scene.cells().len() > 50, "{number} {noise:?}");
            assert!(report.total.hits > 500, "{number} {noise:?}: {:?}", report.total);
        }
    }
}
