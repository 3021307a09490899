//! Every kernel against a naive f64 tracer of ten lines, on triangle soups made to be hard.

use enfilade::importers::{Frame, Material, Model, ModelBuilder, NewElement, Role, Semantic};
use enfilade::oracle::{Truth, TruthOptions};
use enfilade::{CompileOptions, Hit, Kernel, Ray, Start, Want, compile};
use proptest::prelude::*;

fn soup(triangles: &[[[f64; 3]; 3]]) -> Model {
    let mut builder = ModelBuilder::new("soup", Frame::default());
    let material = builder.material(Material::default());
    let element = builder.element(NewElement { name: "soup".into(), ..NewElement::default() }).unwrap();
    builder.semantic(element, Semantic::Furniture);
    for &corners in triangles {
        builder.triangle(element, corners, material).unwrap();
    }
    builder.finish().unwrap()
}

/// Moeller-Trumbore in f64 over everything.
fn naive(triangles: &[[[f64; 3]; 3]], origin: [f64; 3], direction: [f64; 3]) -> f64 {
    let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let d = direction.map(|c| c / dot(direction, direction).sqrt());
    let mut best = f64::INFINITY;
    for &[a, b, c] in triangles {
        let (e1, e2) = (sub(b, a), sub(c, a));
        let p = cross(d, e2);
        let det = dot(e1, p);
        let s = sub(origin, a);
        let (u, q) = (dot(s, p) / det, cross(s, e1));
        let v = dot(d, q) / det;
        let t = dot(e2, q) / det;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 {
            best = best.min(t);
        }
    }
    best
}

fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

fn compare(triangles: &[[[f64; 3]; 3]], rays: &[Ray]) -> usize {
    let scene_bytes = compile(&soup(triangles), &CompileOptions::default()).unwrap();
    let scene = scene_bytes.scene();
    let mut differing = 0;
    let mut reference: Vec<Hit> = Vec::new();
    for kernel in Kernel::available() {
        let scene = scene_bytes.scene().with_kernel(kernel);
        let hits: Vec<Hit> = rays.iter().map(|r| scene.trace_from(Start::Cell(0), r, Want::LEAST)).collect();
        if reference.is_empty() {
            reference = hits;
        } else {
            for (a, b) in reference.iter().zip(&hits) {
                assert!(a.t == b.t && a.triangle == b.triangle, "kernels differ: {a:?} {b:?}");
            }
        }
    }
    for (ray, hit) in rays.iter().zip(&reference) {
        let truth = naive(triangles, ray.origin, ray.direction);
        let same = hit.t == truth || (hit.t - truth).abs() <= 1e-9 * (1.0 + truth);
        differing += usize::from(!same);
        if hit.element != enfilade::NONE {
            assert!(scene.occluded(&Ray::segment(ray.origin, ray.direction, 0.0, hit.t * 1.000_001)));
        }
    }
    differing
}

#[test]
fn random_soups_of_all_sizes() {
    let mut state = 0x9E37_79B9_7F4A_7C15;
    for (count, size, extent) in
        [(1, 5.0, 10.0), (9, 5.0, 10.0), (300, 1.0, 10.0), (5000, 0.3, 100.0), (500, 1e-3, 0.1)]
    {
        let mut point = |scale: f64| [0; 3].map(|_| (random(&mut state) - 0.5) * scale);
        let triangles: Vec<[[f64; 3]; 3]> = (0..count)
            .map(|_| {
                let at = point(extent);
                [0; 3].map(|_| {
                    let p = point(size);
                    [at[0] + p[0], at[1] + p[1], at[2] + p[2]]
                })
            })
            .collect();
        let rays: Vec<Ray> = (0..4000).map(|_| Ray::new(point(extent * 1.5), point(1.0))).collect();
        // Random rays come within 1e-12 of an edge about never: no excuse.
        assert_eq!(compare(&triangles, &rays), 0, "{count} triangles");
    }
}

#[test]
fn closed_boxes_leak_nowhere() {
    // A fan of 64 thin triangles around one corner on each side of a cube: rays from inside through the corners,
    // edges and everything else must all hit.
    let mut triangles = Vec::new();
    for side in 0..6usize {
        let axis = side / 2;
        let w = if side % 2 == 0 { -1.0 } else { 1.0 };
        let at = |u: f64, v: f64| {
            let mut p = [0.0; 3];
            p[axis] = w;
            p[(axis + 1) % 3] = u;
            p[(axis + 2) % 3] = v;
            p
        };
        let ring: Vec<(f64, f64)> = (0..64)
            .map(|i| {
                let (edge, along) = (i / 16, f64::from(i % 16) / 8.0 - 1.0);
                [(along, -1.0), (1.0, along), (-along, 1.0), (-1.0, -along)][edge as usize]
            })
            .collect();
        for i in 0..64 {
            let (a, b) = (ring[i], ring[(i + 1) % 64]);
            triangles.push([at(0.1234, 0.377), at(a.0, a.1), at(b.0, b.1)]);
        }
    }
    let mut state = 77;
    let mut rays = Vec::new();
    for corners in &triangles {
        for corner in corners {
            let origin = [0; 3].map(|_| (random(&mut state) - 0.5) * 1.9);
            rays.push(Ray::new(
                origin,
                [corner[0] - origin[0], corner[1] - origin[1], corner[2] - origin[2]],
            ));
            rays.push(Ray::new([0.0; 3], *corner));
        }
        let middle = [0, 1, 2].map(|i| (corners[1][i] + corners[2][i]) / 2.0);
        rays.push(Ray::new([0.0; 3], middle));
    }
    let scene = compile(&soup(&triangles), &CompileOptions::default()).unwrap().scene();
    for kernel in Kernel::available() {
        let scene_bytes = compile(&soup(&triangles), &CompileOptions::default()).unwrap();
        let scene = scene_bytes.scene().with_kernel(kernel);
        for ray in &rays {
            let hit = scene.trace_from(Start::Cell(0), ray, Want::LEAST);
            assert!(hit.t.is_finite(), "{} leaks: {ray:?}", kernel.name());
        }
    }
    // Restarted from the hit, a ray along the normal crosses the box to the other side.
    for ray in &rays {
        let hit = scene.trace_from(Start::Cell(0), ray, Want::LEAST);
        if hit.point.iter().filter(|c| c.abs() > 0.999).count() > 1 {
            // On an edge of the box the normal runs within the next side.
            continue;
        }
        let back = Ray::new(hit.point, hit.normal);
        let other = scene.trace_from(Start::Hit(&hit), &back, Want::LEAST);
        assert!((other.t - 2.0).abs() < 1e-9, "{other:?}");
    }
}

proptest! {
    #[test]
    fn any_soup_of_lattice_points(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(-4i8..=4)), 1..60),
        targets in prop::collection::vec((prop::array::uniform3(-40i8..=40), prop::array::uniform3(-4i8..=4)), 20),
    ) {
        let triangles: Vec<[[f64; 3]; 3]> =
            corners.iter().map(|t| t.map(|p| p.map(f64::from))).collect();
        let flat = |[a, b, c]: [[f64; 3]; 3]| {
            let (u, v) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
            (0..3).all(|i| u[(i + 1) % 3] * v[(i + 2) % 3] == u[(i + 2) % 3] * v[(i + 1) % 3])
        };
        let triangles: Vec<_> = triangles.into_iter().filter(|&t| !flat(t)).collect();
        prop_assume!(!triangles.is_empty());
        // From points off the lattice to beside lattice points, along no line or plane of the lattice.
        const ASIDE: [f64; 3] = [0.000_123, 0.000_217, 0.000_331];
        let rays: Vec<Ray> = targets
            .iter()
            .map(|(o, p)| {
                let origin = [f64::from(o[0]) * 0.3 + 0.017, f64::from(o[1]) * 0.3 + 0.031, f64::from(o[2]) * 0.3 + 0.0457];
                Ray::new(origin, [0, 1, 2].map(|i| f64::from(p[i]) - origin[i] + ASIDE[i]))
            })
            .collect();
        prop_assert_eq!(compare(&triangles, &rays), 0);
    }
}

#[test]
fn a_ray_in_the_plane_of_a_triangle_does_not_meet_it_anywhere() {
    // A wall's upright face, turned, off the grid, and the slab on it; the ray runs up in the face.
    let origin = [-0.236_478_377_007_524_2, 4.932_513_851_564_961, -5.424_996_974_234_070_5];
    let at = |p: [f64; 3]| [0, 1, 2].map(|i| origin[i] + p[i]);
    let top = 0.670_309_474_234_067_6;
    let (near, far) = (
        at([-0.138_912_247_969_192_74, -0.546_966_976_378_696_4, top]),
        at([1.017_337_752_030_807_3, 4.005_767_398_621_304, top]),
    );
    let low = at([0.017_337_752_030_807_257, 0.068_267_398_621_303_6, 0.060_934_474_234_067_615]);
    let wall = [far, low, near];
    let slab = [at([-5.0, -5.0, top]), at([5.0, -5.0, top]), at([0.0, 7.0, top])];
    let scene = compile(&soup(&[wall, slab]), &CompileOptions::default()).unwrap().scene();
    let hit = scene.trace_from(Start::Cell(0), &Ray::new(origin, [0.0, 0.0, 1.0]), Want::LEAST);
    assert_eq!((hit.triangle, hit.t), (1, top), "not somewhere on the wall");
}

/// Whether the truth calls what the scene says of the ray right.
fn is_right(triangles: &[[[f64; 3]; 3]], ray: &Ray) -> bool {
    let model = soup(triangles);
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let truth = Truth::new(&model, |_| Role::Detail, &TruthOptions::default());
    truth.judge(ray, &scene.trace(ray)).verdict.is_right()
}

#[test]
fn slivers_that_face_the_ray_are_met_and_triangles_seen_edge_on_are_not() {
    let meet = |triangles: &[[[f64; 3]; 3]], ray: &Ray| {
        let scene = compile(&soup(triangles), &CompileOptions::default()).unwrap().scene();
        let hit = scene.trace_from(Start::Cell(0), ray, Want::LEAST);
        assert!(is_right(triangles, ray));
        (hit.t, hit.triangle)
    };
    // So far from the origin that the last bit of a coordinate is worth 1.4e-14 m.
    let width = 3.0 * 1.421_085_471_520_200_4e-14;
    for tilt in [0.0, 0.5, -2.0] {
        let depth = |x: f64| 100.0 + tilt * (x - 100.0);
        let at = |x: f64, y: f64| [x, y, depth(x)];
        let sliver = [at(100.0, 100.0), at(101.0, 100.0), at(100.5, 100.0 + width)];
        let ray = Ray::new([100.4, 100.0 + width / 3.0, 90.0], [0.0, 0.0, 1.0]);
        let (t, _) = meet(&[sliver], &ray);
        assert!((t - (10.0 + tilt * 0.4)).abs() < 1e-9, "{t}");
        // Between two walls, of which the ray meets neither.
        let below = [at(100.0, 100.0), at(101.0, 100.0), at(100.5, 99.0)];
        let above = [at(100.0, 100.0), at(100.5, 100.0 + width), at(100.2, 101.0)];
        let (t, _) = meet(&[below, sliver, above], &ray);
        assert!((t - (10.0 + tilt * 0.4)).abs() < 1e-9, "{t}");
    }
    // As narrow to the ray, but a metre deep.
    let deep = [[100.0, 100.0, 100.0], [101.0, 100.0, 100.0], [100.5, 100.0 + width, 101.0]];
    let (t, _) = meet(&[deep], &Ray::new([100.4, 100.0 + width / 3.0, 90.0], [0.0, 0.0, 1.0]));
    assert_eq!(t, f64::INFINITY);
}

#[test]
fn stairs_seen_along_their_risers_are_tight() {
    // Steps in profile, and below them the stair's underside: closed along any ray that comes down on the treads.
    let steps = 12;
    let mut random = enfilade_testing::Random::new(3);
    for round in 0..40 {
        // Turned somehow, and somewhere: no riser is parallel to an axis.
        let x = glam::DVec3::from(random.direction()).normalize();
        let y = x.cross(glam::DVec3::from(random.direction())).normalize();
        let z = x.cross(y);
        let far = [0.0, 10.0, 300.0][round % 3];
        let origin = glam::DVec3::from(random.point([-far; 3], [far; 3]));
        let at = |p: [f64; 3]| (origin + x * p[0] + y * p[1] + z * p[2]).to_array();
        let mut triangles = Vec::new();
        let mut quad = |corners: [[f64; 3]; 4]| {
            let [a, b, c, d] = corners.map(at);
            triangles.extend([[a, b, c], [a, c, d]]);
        };
        for i in 0..steps {
            let (low, high) = (f64::from(i) * 0.3, f64::from(i + 1) * 0.3);
            let (step, next) = (f64::from(i) * 0.17, f64::from(i + 1) * 0.17);
            quad([[low, 0.0, step], [high, 0.0, step], [high, 1.0, step], [low, 1.0, step]]);
            quad([[high, 0.0, step], [high, 0.0, next], [high, 1.0, next], [high, 1.0, step]]);
        }
        let end = f64::from(steps) * 0.3;
        let top = f64::from(steps) * 0.17;
        quad([[end, 0.0, top], [end + 1.0, 0.0, top], [end + 1.0, 1.0, top], [end, 1.0, top]]);
        let scene = compile(&soup(&triangles), &CompileOptions::default()).unwrap().scene();
        for _ in 0..400 {
            let riser = f64::from(1 + random.below(steps as usize - 1) as u32) * 0.3;
            let beside = [0.0, 1e-15, 1e-14, 1e-13][random.below(4)] * random.between(-1.0, 1.0);
            let target = at([riser + beside, random.between(0.1, 0.9), 0.0]);
            let start = at([riser + beside, random.between(0.1, 0.9), 5.0]);
            let down = [0, 1, 2].map(|i| target[i] - start[i]);
            let hit = scene.trace_from(Start::Cell(0), &Ray::new(start, down), Want::LEAST);
            assert!(hit.t.is_finite(), "round {round}: through a stair {far} m away, beside {beside}");
        }
    }
}

#[test]
fn a_triangle_seen_almost_edge_on_is_not_met_beyond_its_end() {
    // A stair's stringer, a metre long, at a millionth to the ray; the ray passes 150 nm beyond its end.
    let stringer = [
        [6.502_718_925_476_074, 1.299_999_952_316_284_2, 1.671_102_046_966_552_7],
        [7.590_000_152_587_891, 0.300_000_011_920_928_96, 1.699_608_922_004_699_7],
        [6.469_999_790_191_65, 1.299_999_952_316_284_2, 1.725_267_529_487_609_9],
    ];
    let origin = [6.389_999_791_113_186, 1.300_000_101_334_195_7, 1.857_705_124_559_057_5];
    let ray = Ray::new(origin, [0.039_999_961_853_027_344, 0.0, -0.066_218_852_996_826_17]);
    let scene = compile(&soup(&[stringer]), &CompileOptions::default()).unwrap().scene();
    assert_eq!(scene.trace_from(Start::Cell(0), &ray, Want::LEAST).t, f64::INFINITY);
}
