//! How rooms that are not convex are cut: how many cells rays cross, beside the base line.
#![cfg(all(feature = "compile", feature = "gltf"))]

use enfilade::bench::{CrossingOptions, Crossings, FrozenScene, crossings};
use enfilade::importers::gltf::read_slice;
use enfilade::importers::tagging::tag;
use enfilade::importers::{ImportOptions, Untagged};
use enfilade::partition::Convexification;
use enfilade::render::parse_cameras;
use enfilade::roles::roles;
use enfilade::{CompileOptions, Hit, Ray, VerifyOptions, compile, verify};

/// What rays cross in a frozen scene, cut by cost and by the base line; the answers are verified.
fn both(name: &str) -> [Crossings; 2] {
    let frozen = FrozenScene::by_name(name).unwrap();
    let mut model = read_slice(&frozen.glb().unwrap(), name, &ImportOptions::default()).unwrap();
    tag(&mut model, &ImportOptions::default()).unwrap();
    [Convexification::Cost, Convexification::Diagonals].map(|how| {
        let mut options = CompileOptions::default();
        options.convexification = how;
        let scene = compile(&model, &options).unwrap().scene();
        let roles = roles(&model, Untagged::default());
        let mut verifying = VerifyOptions::default().with_rays(2000).with_grid_rays(200);
        (verifying.solid_rays, verifying.hard_rays) = (500, 500);
        let trace = |rays: &[Ray], hits: &mut [Hit]| scene.trace_many(rays, hits, Default::default());
        let occluded = |rays: &[Ray]| enfilade::verify::sees(&scene, rays);
        let report = verify(&model, |e| roles[e.0 as usize], &(trace, occluded), &verifying).unwrap();
        assert!(report.passed(), "{name}, {how:?}: {:#?} {:?}", report.wrong, report.sight);
        let views = parse_cameras(&frozen.cameras, "scenes.toml", &scene.frame()).unwrap();
        let mut counting = CrossingOptions::default();
        counting.size = (64, 64);
        counting.random_rays = 1 << 13;
        let counted = crossings(&scene, &views, &counting);
        println!("{name}, {how:?}: {counted:?}");
        counted
    })
}

/// Fig. 10 of Maria, Horna and Aveneau: 2.67 times fewer.
#[test]
fn rays_cross_far_fewer_cells_of_a_room_with_round_walls() {
    let [by_cost, base] = both("round-room");
    assert!(by_cost.primary_rays == base.primary_rays && base.primary_rays > 4 * 60 * 60);
    assert!(2.5 * by_cost.primary < base.primary && 2.5 * by_cost.random < base.random);
}

#[test]
fn rays_cross_no_more_cells_than_by_the_base_line() {
    for name in ["house", "build1-cad", "random"] {
        let [by_cost, base] = both(name);
        assert!(by_cost.primary <= base.primary && by_cost.random <= base.random, "{name}");
        assert!(by_cost.primary <= 2.5, "{name}");
    }
}
