//! The quick way against the careful one, on all kernels.

use super::*;
use crate::format::records::CellRecord;
use crate::generate::{HouseOptions, Style, house};
use crate::samples::Sample;
use crate::splitmix::SplitMix64;
use crate::trace::lanes::Portable;
use crate::trace::line::surface_of;
use crate::trace::path::Prisms;
use crate::trace::{Hit, Kernel, Place, Start, Want};
use crate::{CompileOptions, Scene, compile};

/// Rays from the air of the zone, half of them through places in rooms, the cells in which they start.
fn rays(scene: &Scene, count: usize, seed: u64) -> Vec<(u32, Ray)> {
    let mut random = SplitMix64::new(seed);
    let [lo, hi] = scene.hull();
    let boxes: Vec<[[f64; 3]; 2]> = scene.rooms().map(|room| room.bounds()).chain([[lo, hi]]).collect();
    let mut rays = Vec::new();
    while rays.len() < count {
        let [lo, hi] = boxes[random.below(boxes.len() as u64) as usize];
        let from = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
        let to = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
        let Place::Air { cell, .. } = scene.locate(from) else { continue };
        let way = DVec3::from(to) - DVec3::from(from);
        let mut ray = Ray::new(from, way.to_array());
        if random.below(4) == 0 {
            ray.tmax = way.length();
        }
        rays.push((cell, ray));
    }
    rays
}

/// That it answers nearly all, and as the careful walk does: the same on all kernels. How many rays end at faces that are not plain.
fn check(name: &str, scene: &Scene, share: f64) -> u32 {
    let rays = rays(scene, 40_000, 5);
    let (mut quick, mut hits, mut others, mut far, mut rough, mut doubted) = (0, 0, 0, 0, 0, 0);
    let mut in_faces = vec![false; scene.tables.triangles.len()];
    scene.tables.surfaces.iter().for_each(|&triangle| in_faces[triangle as usize] = true);
    for (cell, ray) in &rays {
        let found: Vec<Option<Quick>> =
            Kernel::available().into_iter().map(|k| k.quick(&scene.tables, ray, *cell)).collect();
        let parts = |q: &Option<Quick>| q.map(|q| (q.found.t.to_bits(), q.found.triangle, q.cell, q.source));
        assert!(found.iter().all(|q| parts(q) == parts(&found[0])), "{name}: {ray:?} {found:?}");
        let barred: Vec<Option<bool>> =
            Kernel::available().into_iter().map(|k| k.barred(&scene.tables, ray, *cell)).collect();
        assert!(barred.iter().all(|b| *b == barred[0]), "{name}: {ray:?} {barred:?}");
        let careful = scene.careful(Start::Cell(*cell), ray, Want::LEAST);
        let is_met = careful.triangle != NONE;
        assert!(barred[0].is_none_or(|is_barred| is_barred == is_met), "{name}: {ray:?} {careful:?}");
        let Some(Quick { found, source, .. }) = found[0] else {
            doubted += u32::from(Way::new(&scene.tables, ray).is_some());
            check_in_doubt(name, scene, Start::Cell(*cell), ray, &careful);
            continue;
        };
        quick += 1;
        assert_eq!(found.triangle != NONE, is_met, "{name}: {ray:?} {found:?} {careful:?}");
        assert!(barred[0].is_some(), "{name}: {ray:?} {found:?}");
        far += u32::from(scene.trace_cost_from(Start::Cell(*cell), ray, Want::LEAST).1.cells > CELLS as u32);
        if found.triangle != NONE {
            hits += 1;
            rough += u32::from(source == NONE && in_faces[found.triangle as usize]);
            // The plane of a source's triangles is theirs to a micrometre.
            assert!((found.t - careful.t).abs() <= 1e-6 / GRAZING, "{name}: {ray:?} {found:?} {careful:?}");
            let whole = scene.trace_from(Start::Cell(*cell), ray, Want::default());
            // Flush with it another may stand.
            let is_other = whole.element != careful.element;
            assert!(is_other || whole.triangle == careful.triangle, "{name}: {ray:?} {whole:?} {careful:?}");
            others += u32::from(is_other);
        }
    }
    let answered = f64::from(quick) / rays.len() as f64;
    assert!(answered >= share && hits > quick / 4, "{name}: {answered} of the rays, {hits} hits of {quick}");
    assert!(others * 1000 < hits, "{name}: {others} of {hits} hits are of other elements");
    assert!(far > 0, "{name}: none goes farther than walls are looked for");
    assert!(doubted > 0, "{name}: none is in doubt");
    rough
}

/// That a ray which the quick way leaves in doubt is answered as the careful walk answers it.
fn check_in_doubt(name: &str, scene: &Scene, start: Start<'_>, ray: &Ray, careful: &Hit) {
    let is_met = careful.triangle != NONE;
    let is_same = |t: f64, triangle: u32| {
        (triangle != NONE) == is_met && (!is_met || (t - careful.t).abs() <= 1e-6 / GRAZING)
    };
    let (hit, brief) = (scene.trace_from(start, ray, Want::LEAST), scene.trace_brief(start, ray));
    assert!(is_same(hit.t, hit.triangle), "{name}: {start:?} {ray:?} {hit:?} {careful:?}");
    assert!(is_same(brief.t, brief.triangle), "{name}: {start:?} {ray:?} {brief:?} {careful:?}");
    assert_eq!(scene.occluded_from(start, ray), is_met, "{name}: {start:?} {ray:?} {careful:?}");
}

#[test]
fn it_answers_as_the_careful_walk_does() {
    check("house", Sample::House.scene(), 0.99);
    // With an attic under sloped roofs, a round end, an oblique wing; floors that reach over several storeys.
    check("build1", Sample::Build1.scene(), 0.99);
    check("tower", Sample::Tower(12).scene(), 0.99);
    // A third of the elements are not there, and faces of which they were a part are plain no more.
    let masked = Sample::Build1.scene().without(|element, _| element % 3 == 0);
    check("masked", &masked, 0.7);
    for seed in 1..4 {
        check(&format!("random {seed}"), Sample::Random(seed).scene(), 0.99);
        // Corners a hair aside each: hardly two triangles in one plane, so that most faces are not plain.
        let rough = check(&format!("random cad {seed}"), Sample::Random(seed).drawn(seed), 0.975);
        assert!(rough > 10_000, "{rough} at faces that are not plain");
    }
}

/// The same of rays from what others met, to the side that they came from, and flat along it.
fn check_from_surfaces(name: &str, scene: &Scene, share: f64) {
    let mut random = SplitMix64::new(11);
    let (mut quick, mut all, mut doubted) = (0, 0, 0);
    for (cell, ray) in rays(scene, 20_000, 6) {
        let hit = scene.trace_from(Start::Cell(cell), &ray, Want::LEAST);
        let normal = DVec3::from(hit.normal);
        if hit.triangle == NONE {
            continue;
        }
        let mut way = DVec3::from([0, 1, 2].map(|_| random.between(-1.0, 1.0)));
        way *= way.dot(normal).signum();
        match random.below(8) {
            0 => way -= normal * way.dot(normal) * 0.999,
            1 => way = -way,
            _ => {}
        }
        let mut onward = Ray::new(hit.point, way.to_array());
        if random.below(4) == 0 {
            onward.tmax = random.between(0.0, 4.0);
        }
        let surface = surface_of(&hit, DVec3::from(onward.origin), onward.tmin);
        let ask = |kernel: Kernel| kernel.quick_from(&scene.tables, &onward, hit.cell, &surface);
        let found: Vec<Option<Quick>> = Kernel::available().into_iter().map(ask).collect();
        let parts = |q: &Option<Quick>| q.map(|q| (q.found.t.to_bits(), q.found.triangle, q.cell, q.source));
        assert!(found.iter().all(|q| parts(q) == parts(&found[0])), "{name}: {onward:?} {found:?}");
        let careful = scene.careful(Start::Hit(&hit), &onward, Want::LEAST);
        for kernel in Kernel::available() {
            let barred = kernel.barred_from(&scene.tables, &onward, hit.cell, &surface);
            let is_met = careful.triangle != NONE;
            assert!(barred.is_none_or(|is_barred| is_barred == is_met), "{name}: {hit:?} {onward:?}");
            assert!(barred.is_some() || found[0].is_none(), "{name}: {hit:?} {onward:?}");
        }
        assert_eq!(
            scene.occluded_from(Start::Hit(&hit), &onward),
            careful.triangle != NONE,
            "{name}: {hit:?} {onward:?} {careful:?}"
        );
        all += 1;
        let Some(Quick { found, .. }) = found[0] else {
            doubted += u32::from(starts_clear(&scene.tables, &onward, hit.cell, &surface));
            check_in_doubt(name, scene, Start::Hit(&hit), &onward, &careful);
            continue;
        };
        quick += 1;
        let is_same = found.triangle == NONE || (found.t - careful.t).abs() <= 1e-6 / GRAZING;
        assert!(
            (found.triangle == NONE) == (careful.triangle == NONE) && is_same,
            "{name}: {hit:?} {onward:?} {found:?} {careful:?}"
        );
    }
    assert!(f64::from(quick) >= share * f64::from(all) && all > 10_000, "{name}: {quick} of {all} rays");
    assert!(doubted > 0, "{name}: none is in doubt that surely starts before its surface");
}

/// Rays from places in and beside simple and level cells, at their faces, edges and corners: what tells soon beside how many faces these are against what
/// looks at each.
#[test]
fn what_a_place_is_beside_is_told_alike() {
    let mut random = SplitMix64::new(12);
    let (mut clear, mut not) = (0, 0);
    for scene in [Sample::House.scene(), Sample::Build1.scene()] {
        let (tables, prisms) = (&scene.tables, Prisms::new(&scene.tables));
        let [cos, sin] = tables.scene[0].lattice_turn;
        let origin = DVec3::from(tables.scene[0].lattice_origin);
        for (cell, (step, record)) in (0..).zip(tables.steps.iter().zip(tables.cells.iter())) {
            if !step.is_level() || record.kind != CellRecord::AIR {
                continue;
            }
            let sides = prisms.sides_of(record);
            for _ in 0..60 {
                let at = |number: u64| sides[number as usize % sides.len()].start.map(f64::from);
                let first = random.below(sides.len() as u64);
                let ([a, b], share) = ([at(first), at(first + 1)], random.between(-0.1, 1.1));
                let inward = [a[1] - b[1], b[0] - a[0]];
                let length = inward[0].hypot(inward[1]);
                let off = random.between(-2e-3, 4e-3);
                let plan = [0, 1].map(|i| a[i] + share * (b[i] - a[i]) + off * inward[i] / length);
                let [floor, ceiling] = [step.height[0], step.height[1]].map(f64::from);
                let height = match random.below(3) {
                    0 => floor + random.between(-2e-3, 4e-3),
                    1 => ceiling - random.between(-2e-3, 4e-3),
                    _ => random.between(floor, ceiling),
                };
                let turned = DVec3::new(plan[0] * cos - plan[1] * sin, plan[0] * sin + plan[1] * cos, height);
                let way = [(); 3].map(|()| random.between(-1.0, 1.0));
                let ray = Ray::new((origin + turned).to_array(), way);
                let Some(way) = Way::new(tables, &ray) else { continue };
                let exit = way.leave_from_face::<Portable>(cell);
                let starts = way.starts_beside::<Portable>(cell);
                // It may be in doubt for other reasons, and is by what f32 rounds.
                assert!(starts || exit.link == Step::OTHER, "{cell} {ray:?}");
                let [near, out] = way.margins();
                let least = 4.0 * f64::from(way.rounding);
                let told =
                    |by: f64| prisms.edges_beside(record, [way.from.x, way.from.y], near + by, out - by);
                let (some, more) = (told(-least).unwrap(), told(least).unwrap());
                let heights = [way.from.z - floor, ceiling - way.from.z];
                let levels = |by: f64| heights.iter().filter(|height| **height < near + by).count() as u32;
                let is_out = heights.iter().any(|height| *height < -out - least) || !some.1;
                if more.1
                    && more.0 + levels(least) <= 1
                    && heights.iter().all(|height| *height > -out + least)
                {
                    assert!(starts, "{cell} {ray:?}");
                    clear += 1;
                }
                if is_out || some.0 + levels(-least) > 1 {
                    assert!(!starts, "{cell} {ray:?}");
                    not += 1;
                }
            }
        }
    }
    assert!(clear > 1000 && not > 1000, "{clear} {not}");
}

#[test]
fn from_surfaces_it_answers_as_the_careful_walk_does() {
    // A quarter of them go through the surface, or flat along it.
    check_from_surfaces("house", Sample::House.scene(), 0.76);
    check_from_surfaces("build1", Sample::Build1.scene(), 0.76);
    for seed in 1..3 {
        check_from_surfaces(&format!("random {seed}"), Sample::Random(seed).scene(), 0.76);
        check_from_surfaces(&format!("cad {seed}"), Sample::Random(seed).drawn(seed), 0.59);
    }
}

#[test]
fn what_is_no_ray_or_starts_elsewhere_is_left_to_others() {
    let scene = Sample::House.scene();
    let (cell, ray) = rays(scene, 1, 3)[0];
    let quick = |cell: u32, ray: Ray| scene.kernel.quick(&scene.tables, &ray, cell).is_some();
    for component in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!quick(cell, Ray { origin: [component, 0.0, 0.0], ..ray }));
        assert!(!quick(cell, Ray { direction: [0.0, component, 0.0], ..ray }));
    }
    assert!(!quick(cell, Ray { direction: [0.0; 3], ..ray }));
    assert!(!quick(cell, Ray { tmax: f64::NAN, ..ray }) && !quick(cell, Ray { tmin: 0.1, ..ray }));
    assert!(!quick(0, ray) && !quick(NONE, ray));
    let other = (0..scene.cells().len() as u32).filter(|&other| other != cell);
    assert!(other.into_iter().all(|other| !quick(other, ray)), "a ray starts in one cell only");
}

#[test]
fn plates_tell_what_their_triangles_would() {
    for (name, scene) in [("house", Sample::House.scene()), ("tower", Sample::Tower(12).scene())] {
        let (tables, walk) = (&scene.tables, Walk::new(&scene.tables));
        let (mut plates, mut told) = (0, 0);
        for (cell, ray) in rays(scene, 20_000, 8) {
            let Some(quick) = scene.kernel.quick(tables, &ray, cell) else { continue };
            if quick.source == NONE || quick.found.triangle == NONE {
                continue;
            }
            let want = Want { room: true, face: true, triangle: false };
            let hit = scene.describe_quick(&ray, &quick, want);
            let by_triangle = scene.describe_quick(&ray, &Quick { source: NONE, ..quick }, want);
            assert_eq!(hit, by_triangle, "{name}: {ray:?}");
            assert_eq!(hit.normal.map(f64::to_bits), by_triangle.normal.map(f64::to_bits), "{name}: {ray:?}");
            let want = Want { face: false, ..want };
            let least = [quick, Quick { source: NONE, ..quick }]
                .map(|quick| scene.describe_quick(&ray, &quick, want));
            assert_eq!(least[0], least[1], "{name}: {ray:?}");
            plates += 1;
            // The very triangle, where one is told, is the one that is found by looking at all of them.
            let (plate, point) = (&tables.plates[quick.source as usize], DVec3::from(hit.point));
            let Some(triangle) = plate.told(point) else { continue };
            told += 1;
            let triangles = Prisms::new(tables).triangles_of(quick.source);
            assert!(triangles.contains(&triangle), "{name}: {ray:?}");
            if let Some(holder) = plate.holder(&walk, triangles, point) {
                assert_eq!(triangle, holder, "{name}: {ray:?}");
            }
            let very = scene.describe_quick(&ray, &quick, Want::default());
            assert_eq!(very, Hit { triangle, semantic: very.semantic, ..hit }, "{name}: {ray:?}");
        }
        assert!(plates > 5_000 && told > plates / 3, "{name}: {told} of {plates}");
    }
}

/// Rays to places in the hull from anywhere around it, and along its edges; of some the end is near what they meet.
fn rays_from_outside(scene: &Scene, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = SplitMix64::new(seed);
    let [lo, hi] = scene.hull();
    let mut rays = Vec::new();
    while rays.len() < count {
        let far = [0.001, 1.0, 100.0][random.below(3) as usize];
        let mut from = [0, 1, 2].map(|i| random.between(lo[i] - far, hi[i] + far));
        if random.below(8) == 0 {
            let axis = random.below(3) as usize;
            from[axis] = [lo[axis], hi[axis]][random.below(2) as usize];
        }
        if (0..3).all(|i| from[i] > lo[i] && from[i] < hi[i]) {
            continue;
        }
        let to = [0, 1, 2].map(|i| random.between(lo[i], hi[i]));
        let mut ray = Ray::new(from, (DVec3::from(to) - DVec3::from(from)).to_array());
        match random.below(8) {
            0 => ray.direction[random.below(3) as usize] = 0.0,
            1 => ray.tmax = random.between(0.0, 2.0 * far),
            2 => ray.tmax = scene.careful(Start::Anywhere, &ray, Want::LEAST).t + random.between(-1e-3, 1e-3),
            3 => ray.tmin = random.between(0.0, far),
            _ => {}
        }
        rays.push(ray);
    }
    rays
}

/// The same of a ray that is told to start in cell 0: on all kernels, whether anything is met, and when what it takes is counted.
fn check_from_around(name: &str, scene: &Scene, ray: &Ray) {
    let start = Start::Cell(0);
    let careful = scene.careful(start, ray, Want::default());
    let is_met = careful.triangle != NONE;
    let bits = |hit: &Hit| bytemuck::bytes_of(hit).to_vec();
    let hit = scene.trace_from(start, ray, Want::default());
    assert_eq!(hit.triangle != NONE, is_met, "{name}: {ray:?} {hit:?} {careful:?}");
    let is_same = !is_met || (hit.t - careful.t).abs() <= 1e-6 / GRAZING;
    assert!(is_same, "{name}: {ray:?} {hit:?} {careful:?}");
    for kernel in Kernel::available() {
        let other = scene.trace_with(kernel, start, ray, Want::default());
        assert!(bits(&hit) == bits(&other), "{name}: {ray:?} {hit:?} {other:?}");
    }
    let counted = scene.trace_cost_from(start, ray, Want::default()).0;
    assert!(bits(&hit) == bits(&counted), "{name}: {ray:?} {hit:?} {counted:?}");
    assert_eq!(scene.occluded_from(start, ray), is_met, "{name}: {ray:?} {careful:?}");
}

/// All kernels against the careful walk, of rays that start anywhere; how many were answered quickly.
fn check_from_outside(name: &str, scene: &Scene) -> f64 {
    let rays = rays_from_outside(scene, 20_000, 8);
    let (mut quick, mut hits, mut others, mut placed, mut told) = (0, 0, 0, 0, 0);
    for ray in &rays {
        let careful = scene.careful(Start::Anywhere, ray, Want::default());
        let is_met = careful.triangle != NONE;
        for kernel in Kernel::available() {
            let hit = scene.trace_with(kernel, Start::Anywhere, ray, Want::default());
            assert_eq!(hit.triangle != NONE, is_met, "{name}: {ray:?} {hit:?} {careful:?}");
            // Planes of sources are those of their triangles to a micrometre.
            let is_same = !is_met || (hit.t - careful.t).abs() <= 1e-6 / GRAZING;
            assert!(is_same, "{name}: {ray:?} {hit:?} {careful:?}");
            // Flush with it another may stand.
            others += u32::from(is_met && hit.element != careful.element && kernel == scene.kernel);
            // Its cell is before what was met, if there are cells; that of the careful walk may be another which meets it there.
            if is_met && hit.cell != 0 {
                let (prisms, cell) = (Prisms::new(&scene.tables), &scene.tables.cells[hit.cell as usize]);
                let before = DVec3::from(hit.point) + DVec3::from(hit.normal) * (0.5 * scene.tolerance());
                let is_held = prisms.nearly_holds(cell, prisms.local(before), scene.tolerance());
                assert!(cell.kind == CellRecord::AIR && is_held, "{name}: {ray:?} {hit:?}");
                placed += 1;
            }
            let brief = scene.trace_brief_with(kernel, Start::Anywhere, ray);
            assert!(
                brief.t.to_bits() == hit.t.to_bits() || brief.t.is_nan() && hit.t.is_nan(),
                "{name}: {ray:?}"
            );
        }
        assert_eq!(scene.occluded(ray), is_met || careful.t.is_nan(), "{name}: {ray:?} {careful:?}");
        if !careful.t.is_nan() {
            told += u32::from(scene.alone(scene.kernel, Ask::First, Start::Cell(0), ray).is_some());
            check_from_around(name, scene, ray);
        }
        hits += u32::from(is_met);
        quick += u32::from(scene.alone(scene.kernel, Ask::First, Start::Anywhere, ray).is_some());
    }
    assert!(hits > 5_000 && others * 200 < hits, "{name}: {hits} hits, {others} otherwise");
    assert!(told >= quick, "{name}: {told} rays told to start in cell 0, {quick} that are not");
    assert!(placed > hits / 2 || scene.cells().len() == 1, "{name}: {placed} of {hits} hits in cells");
    f64::from(quick) / rays.len() as f64
}

#[test]
fn rays_from_outside_are_answered_as_the_careful_walk_does() {
    for (name, scene) in [
        ("house", Sample::House.scene()),
        ("build1", Sample::Build1.scene()),
        ("random cad", Sample::Random(0).drawn(1)),
    ] {
        // Others start farther on, in cells, or where a solid may be.
        let share = check_from_outside(name, scene);
        assert!(share > 0.8, "{name}: {share}");
    }
}

#[test]
fn scenes_left_one_cell_are_answered_as_the_careful_walk_does() {
    let options = CompileOptions { cells: false, ..CompileOptions::default() };
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let scene = compile(&model, &options).unwrap().scene();
    check_from_outside("uncut", &scene);
    let bits = |hit: &Hit| bytemuck::bytes_of(hit).to_vec();
    let rays = rays(&scene, 20_000, 7);
    for (_, ray) in &rays {
        for start in [Start::Cell(0), Start::Anywhere] {
            let careful = scene.careful(start, ray, Want::default());
            for kernel in Kernel::available() {
                let hit = scene.trace_with(kernel, start, ray, Want::default());
                assert!(bits(&hit) == bits(&careful), "{ray:?} {hit:?} {careful:?}");
            }
            let is_met = careful.triangle != NONE || careful.t.is_nan();
            assert_eq!(scene.occluded_from(start, ray), is_met, "{ray:?} {careful:?}");
        }
    }
    let all: Vec<Ray> = rays.iter().map(|(_, ray)| *ray).collect();
    let mut many = vec![Hit::ESCAPED; all.len()];
    scene.trace_many(&all, &mut many, Want::default());
    for (ray, hit) in all.iter().zip(&many) {
        assert!(bits(hit) == bits(&scene.careful(Start::Anywhere, ray, Want::default())), "{ray:?}");
    }
}
