//! Hits tell the kind of the face that they lie on, if asked for it.
#![cfg(feature = "compile")]

use crate::common;

use std::collections::BTreeMap;

use enfilade::building::FaceKind;
use enfilade::importers::{ImportOptions, Role, Semantic, import};
use enfilade::sew::Part;
use enfilade::{CompileOptions, Hit, NONE, Ray, Scene, Start, Want, compile};
use enfilade_testing::Random;

/// What the face of a hit is called by what the scene says of its cell and its element.
fn expected(scene: &Scene, hit: &Hit) -> FaceKind {
    let air = Semantic::from_number(scene.cells()[hit.cell as usize].semantic.into()).unwrap();
    let element = scene.element(hit.element).semantic();
    let part = match hit.normal[2] {
        z if z > 1e-6 => Part::Floor,
        z if z < -1e-6 => Part::Ceiling,
        _ => Part::Side,
    };
    let look = scene.materials()[hit.material as usize];
    FaceKind::of_surface(air, element, part, look.alpha < 1.0 || look.transmission > 0.0)
}

#[test]
fn hits_tell_the_kinds_of_faces() {
    let model = import(&common::fixture("house.glb"), &ImportOptions::default()).unwrap();
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let [lo, hi] = scene.hull();
    let mut random = Random::new(4);
    let mut kinds: BTreeMap<FaceKind, u32> = BTreeMap::new();
    let mut detail = 0;
    let mut to_floor = None;
    for _ in 0..20_000 {
        let ray = Ray::new(random.point(lo, hi), random.direction());
        let plain = scene.trace_from(Start::Anywhere, &ray, Want::default());
        let hit = scene.trace_from(Start::Anywhere, &ray, Want::default().with_face());
        if hit.element == NONE || hit.t.is_nan() {
            assert_eq!(hit.semantic, plain.semantic);
            continue;
        }
        let element = scene.element(hit.element);
        assert_eq!(
            (plain.semantic, plain.t, plain.triangle),
            (element.semantic().number(), hit.t, hit.triangle)
        );
        match FaceKind::from_number(hit.semantic) {
            Some(kind) => {
                assert_eq!(kind, expected(&scene, &hit), "{ray:?} {hit:?} {}", element.id());
                *kinds.entry(kind).or_default() += 1;
                if kind == FaceKind::Floor {
                    to_floor = Some(ray);
                }
            }
            None => {
                assert_eq!(hit.semantic, element.semantic().number());
                assert_eq!(element.role(), Role::Detail, "{ray:?} {hit:?}: no face of {}", element.id());
                detail += 1;
            }
        }
    }
    println!("{kinds:?}, {detail} of detail");
    use FaceKind::*;
    assert!([Wallpaper, Facade, GatePost, Floor, Ceiling, Roofing].iter().all(|kind| kinds[kind] > 20));
    // Without cells there are no faces.
    let mut options = CompileOptions::default();
    options.cells = false;
    let whole = compile(&model, &options).unwrap().scene();
    let ray = to_floor.unwrap();
    let semantic = |scene: &Scene| scene.trace_from(Start::Anywhere, &ray, Want::LEAST.with_face()).semantic;
    assert_eq!((semantic(&scene), semantic(&whole)), (Floor.number(), Semantic::Ground.number()));
}
