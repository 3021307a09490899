//! Cells of generated buildings against what is true of these, and limits of the partition itself.
#![cfg(feature = "compile")]

use std::collections::BTreeMap;

use enfilade::generate::{
    Building, HouseOptions, OfficeOptions, Style, TowerOptions, build1, house, random, tower,
};
use enfilade::importers::{CancelToken, ElementId, Limits, Model, Role, Untagged, Watch};
use enfilade::lattice::FINE;
use enfilade::oracle::{Truth, TruthOptions, Verdict};
use enfilade::partition::cells::{Cell, Label, NONE, Partition};
use enfilade::partition::{PartitionError, PartitionOptions, PartitionReport, partition, six_volume};
use enfilade::roles::roles;
use enfilade::{CompileError, CompileOptions, Place, Ray, Start, Want, compile};
use enfilade_testing::Random;

fn cut(model: &Model) -> (Partition, PartitionReport) {
    partition(model, &PartitionOptions::default()).unwrap()
}

/// A cell's footprint in steps of the lattice.
fn footprint(partition: &Partition, cell: &Cell) -> Vec<[f64; 2]> {
    partition.footprint(cell).map(|p| [f64::from(p.x), f64::from(p.y)]).collect()
}

fn area(polygon: &[[f64; 2]]) -> f64 {
    let next = |i: usize| polygon[(i + 1) % polygon.len()];
    (0..polygon.len()).map(|i| polygon[i][0] * next(i)[1] - polygon[i][1] * next(i)[0]).sum::<f64>() / 2.0
}

/// What two convex, counter-clockwise polygons have in common.
fn common(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let mut rest = a.to_vec();
    for (i, p) in b.iter().enumerate() {
        let q = b[(i + 1) % b.len()];
        let side = |r: &[f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let mut kept = Vec::new();
        for (k, r) in rest.iter().enumerate() {
            let s = &rest[(k + 1) % rest.len()];
            let (from, to) = (side(r), side(s));
            if from >= 0.0 {
                kept.push(*r);
            }
            if (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0) {
                let share = from / (from - to);
                kept.push([r[0] + share * (s[0] - r[0]), r[1] + share * (s[1] - r[1])]);
            }
        }
        rest = kept;
    }
    area(&rest)
}

/// By element of air: volume, and area of its floors on matter.
fn rooms(model: &Model, partition: &Partition) -> BTreeMap<String, [f64; 2]> {
    let step = partition.lattice.step();
    let mut rooms: BTreeMap<String, [f64; 2]> = BTreeMap::new();
    for cell in &partition.cells {
        let Label::Air(element) = cell.label else { continue };
        let entry = rooms.entry(model.elements[element.0 as usize].id.clone()).or_default();
        entry[0] += six_volume(partition, cell) as f64 / 6.0 / FINE as f64 * step.powi(3);
        let own = footprint(partition, cell);
        let floor = &partition.planes[cell.floor as usize];
        let rise = [floor.p, floor.q].map(|c| c as f64 / FINE as f64);
        let slanted = (1.0 + rise[0] * rise[0] + rise[1] * rise[1]).sqrt();
        for cover in &partition.covers[cell.below.start as usize..cell.below.end as usize] {
            if cover.cell != NONE && !partition.cells[cover.cell as usize].label.is_air() {
                let below = footprint(partition, &partition.cells[cover.cell as usize]);
                entry[1] += common(&own, &below) * slanted * step * step;
            }
        }
    }
    rooms
}

/// How far, m3 and m2, volumes and floor areas of rooms are off the truth, at most, for each square metre of a room's
/// surface and for each metre around its floor.
fn worst(building: &Building, found: &BTreeMap<String, [f64; 2]>) -> [f64; 2] {
    building.truth().rooms.iter().fold([0.0f64; 2], |[volume, area], room| {
        let [v, a] = *found.get(&room.air.id).unwrap_or_else(|| panic!("{} has no cell", room.air.name));
        let surface: f64 = room.air.faces.values().sum();
        let around = room.floor_area.sqrt().max(1.0);
        [volume.max((v - room.air.volume).abs() / surface), area.max((a - room.floor_area).abs() / around)]
    })
}

/// One of each kind, without furniture.
fn buildings() -> Vec<Building> {
    let office = |seed| {
        let mut options = OfficeOptions::default();
        (options.furniture, options.seed) = (false, seed);
        options
    };
    let mut options = HouseOptions::default();
    options.furniture = false;
    let mut all = vec![house(&options), build1(&office(0))];
    all.extend((0..6).map(|seed| random(&office(seed))));
    let mut options = TowerOptions::default();
    (options.storeys, options.office) = (3, office(0));
    all.push(tower(&options));
    all
}

/// Rooms are as they were drawn, nothing that could carve is detail, and no air is without a name.
#[test]
fn exact_buildings_have_the_rooms_that_were_drawn() {
    for building in buildings() {
        let model = building.to_model().unwrap();
        let (partition, report) = cut(&model);
        // To the lattice: oblique wings are rounded to it.
        let [volume, area] = worst(&building, &rooms(&model, &partition));
        let step = partition.lattice.step();
        assert!(volume <= step && area <= 4.0 * step, "{}: {volume} m, {area} m", building.name);
        assert_eq!(report.volume_difference, 0);
        assert!(report.not_carved.is_empty() && report.voids.is_empty(), "{}: {report:?}", building.name);
        assert_eq!((report.audit.detail.triangles, report.surfaces.false_faces), (0, 0), "{}", building.name);
        let roles = roles(&model, Untagged::default());
        let is_detail = |(element, _): &(ElementId, u32)| roles[element.0 as usize] == Role::Detail;
        assert!(partition.detail.iter().all(is_detail), "{}", building.name);
    }
}

/// However a tool writes the house, its rooms are those that were drawn, as far as the style leaves them.
#[test]
fn rooms_of_styled_buildings() {
    let mut options = HouseOptions::default();
    options.furniture = false;
    let building = house(&options);
    let names: Vec<_> = Style::exact().shares_mut().into_iter().map(|(name, _)| name).collect();
    for name in names {
        // Identities are doubled, and rooms left out, on purpose.
        if ["doubled-ids", "rooms-missing"].contains(&name) {
            continue;
        }
        let mut style = Style::exact();
        style.seed = 1;
        *style.shares_mut().into_iter().find(|(other, _)| *other == name).unwrap().1 = 1.0;
        let model = building.export(&style).to_model().unwrap();
        let (partition, report) = cut(&model);
        let [volume, area] = worst(&building, &rooms(&model, &partition));
        assert!(report.not_carved.is_empty(), "{name}: {:?}", report.not_carved);
        let [most_volume, most_area] = match name {
            // What is left of a hole beyond a shallow opening joins the room; a recess of a quarter of a wall.
            "openings-shallow" => [0.005, 0.05],
            // By at most 10 mm, where nothing solid is in the way: in openings.
            "rooms-larger" => [0.01, 0.05],
            // At most 30 mm of the room's height, over a third of its surface.
            "floors" | "floors-below" => [0.01, 1e-9],
            _ => [1e-6, 1e-5],
        };
        assert!(volume <= most_volume && area <= most_area, "{name}: {volume} m, {area} m");
    }
}

/// What would need more memory than allowed is compiled as one cell, with a warning.
#[test]
fn partitions_keep_to_their_budget() {
    let mut options = HouseOptions::default();
    options.furniture = false;
    let model = house(&options).to_model().unwrap();
    let small = Limits::default().with_max_memory(100_000);
    let error = partition(&model, &PartitionOptions::default().with_limits(small)).unwrap_err();
    assert!(matches!(error, PartitionError::TooLarge(100_000)), "{error}");
    let mut options = CompileOptions::default();
    let whole = compile(&model, &options).unwrap().report;
    // Less than the cells take, more than all the rest.
    options.limits = Limits::default().with_max_memory(2_500_000);
    let report = compile(&model, &options).unwrap().report;
    assert!(whole.cells > 1 && report.cells == 1, "{} {}", whole.cells, report.cells);
    assert!(report.warnings.iter().any(|w| w.contains("--max-memory")), "{:?}", report.warnings);
}

/// Over parts of triangles they take more memory, which is not always there.
#[test]
fn hierarchies_keep_to_their_budget() {
    let model = house(&HouseOptions::default()).to_model().unwrap();
    let mut options = CompileOptions::default();
    options.cells = false;
    let usual = compile(&model, &options).unwrap();
    options.limits = Limits::default().with_max_memory(usual.report.peak_budget_bytes - 1);
    let less = compile(&model, &options).unwrap();
    assert!(less.report.peak_budget_bytes < usual.report.peak_budget_bytes * 2 / 3);
    let [usual, less] = [usual.scene(), less.scene()];
    let mut random = Random::new(3);
    for _ in 0..500 {
        let ray = Ray::new(random.point([0.0, 0.0, 0.0], [12.0, 10.0, 3.0]), random.direction());
        let [one, other] =
            [&usual, &less].map(|scene| scene.trace_from(Start::Anywhere, &ray, Want::LEAST).answer());
        assert_eq!(format!("{one:?}"), format!("{other:?}"));
    }
}

#[test]
fn partitions_can_be_cancelled() {
    let model = house(&HouseOptions::default()).to_model().unwrap();
    let cancel = CancelToken::new();
    let token = cancel.clone();
    let watch = Watch::default().with_cancel(cancel).with_progress(move |stage, _| {
        if stage == "columns" {
            token.cancel();
        }
    });
    let error = partition(&model, &PartitionOptions::default().with_watch(watch.clone())).unwrap_err();
    assert!(matches!(error, PartitionError::Cancelled(_)), "{error}");
    let mut options = CompileOptions::default();
    options.watch = watch;
    assert!(matches!(compile(&model, &options), Err(CompileError::Cancelled(_))));
}

/// What is open is matter for the cells, once mended, and none for rays: those that start inside of it leave it through its
/// surface, however near that is and however flat they go.
#[test]
fn rays_from_inside_open_floors_leave_through_their_surface() {
    let mut options = HouseOptions::default();
    options.furniture = false;
    let mut style = Style::exact();
    (style.seed, style.floors, style.noisy_corners) = (1, 1.0, 1.0);
    let model = house(&options).export(&style).to_model().unwrap();
    let scene = compile(&model, &CompileOptions::default()).unwrap().scene();
    let with_roles = roles(&model, Untagged::default());
    let truth = Truth::new(&model, |e| with_roles[e.0 as usize], &TruthOptions::default());
    let floors: Vec<_> =
        model.elements.iter().filter(|e| e.class.as_deref() == Some("IfcCovering")).collect();
    assert!(floors.len() >= 6, "{}", floors.len());
    let mut random = enfilade_testing::Random::new(1);
    let mut from_below = 0;
    for floor in floors {
        let points = &floor.mesh.positions;
        let top = points.iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
        let bound = |i: usize| points.iter().map(move |p| p[i]);
        let box_of = [0, 1]
            .map(|i| [bound(i).fold(f64::INFINITY, f64::min), bound(i).fold(f64::NEG_INFINITY, f64::max)]);
        for _ in 0..2000 {
            let [x, y] = box_of.map(|[lo, hi]| lo + (hi - lo) * random.unit());
            let depth = 1e-4 + 4.5e-4 * random.unit();
            let (turn, rise) = (std::f64::consts::TAU * random.unit(), 0.02 + 0.4 * random.unit());
            let ray = Ray::new([x, y, top - depth], [turn.cos(), turn.sin(), rise]);
            let answer = scene.trace(&ray);
            let judged = truth.judge(&ray, &answer);
            assert!(judged.verdict.is_right(), "{ray:?}: {answer:?}, {judged:?}");
            // As those who have looked up where it starts.
            if let Place::Air { cell, .. } = scene.locate(ray.origin) {
                let answer = scene.trace_from(Start::Cell(cell), &ray, Want::default()).answer();
                let judged = truth.judge(&ray, &answer);
                assert!(judged.verdict.is_right(), "{ray:?} from cell {cell}: {answer:?}, {judged:?}");
            }
            from_below += u32::from(matches!(judged.verdict, Verdict::Exact));
        }
    }
    assert!(from_below > 10_000, "{from_below}");
}
