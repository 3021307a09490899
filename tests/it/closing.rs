//! Doors at run time: openings closed and opened, leaves in and out, against the truth of triangles.
#![cfg(feature = "compile")]

use enfilade::closing::{ClosingError, Leaf, Stand};
use enfilade::generate::{
    Building, HouseOptions, OfficeOptions, Style, TowerOptions, build1, house, random, tower,
};
use enfilade::graph::{OpeningNode, Side};
use enfilade::importers::{
    Frame, Material, MaterialId, Model, ModelBuilder, NewElement, Role, Semantic, UpAxis,
};
use enfilade::roles::roles;
use enfilade::verify::{standing, tell_sheets};
use enfilade::{Answer, CompileOptions, Hit, Place, Ray, Scene, Start, VerifyOptions, Want, compile, verify};

fn scene(model: &Model) -> Scene {
    compile(model, &CompileOptions::default()).unwrap().scene()
}

fn openings(scene: &Scene) -> Vec<OpeningNode> {
    scene.graph().openings.into_iter().filter(|opening| !opening.cells.is_empty()).collect()
}

/// No random ray is wrong by the model as the openings stand.
fn check(model: &Model, scene: &Scene, rays: u64, name: &str) {
    let truth = standing(model.clone(), scene);
    let elements = model.elements.len();
    let mut roles = roles(&truth, Default::default());
    roles[elements..].fill(Role::Detail);
    let trace = |rays: &[Ray], hits: &mut [Hit]| {
        scene.trace_many(rays, hits, Want::LEAST);
        tell_sheets(scene, elements as u32, hits);
    };
    let tracer = (trace, |rays: &[Ray]| enfilade::verify::sees(scene, rays));
    let options =
        VerifyOptions::default().with_rays(rays).with_grid_rays(200).with_tolerance(scene.tolerance());
    let report = verify(&truth, |e| roles[e.0 as usize], &tracer, &options).unwrap();
    assert!(report.passed(), "{name}: {:?} {:?} {:?}", report.total, report.wrong, report.sight);
}

/// Every opening another way.
fn mixed(openings: &[OpeningNode]) -> Vec<(u32, Stand)> {
    let ways = [Stand::CLOSED, Stand::FREE, Stand::SEALED, Stand::MODELLED];
    openings.iter().zip(ways.iter().cycle()).map(|(opening, way)| (opening.element, *way)).collect()
}

fn buildings() -> Vec<(&'static str, Building)> {
    let mut few_storeys = TowerOptions::default();
    few_storeys.storeys = 4;
    vec![
        ("house", house(&HouseOptions::default())),
        ("random", random(&OfficeOptions::default())),
        ("build1", build1(&OfficeOptions::default())),
        ("tower", tower(&few_storeys)),
    ]
}

#[test]
fn answers_are_those_of_the_model_as_it_stands() {
    for (name, building) in buildings() {
        for style in [Style::exact(), Style::cad(3)] {
            let model = building.export(&style).to_model().unwrap();
            let mut scene = scene(&model);
            let stands = mixed(&openings(&scene));
            scene.set_stands(&stands).unwrap();
            assert!(!scene.closures().is_empty());
            check(&model, &scene, 4_000, name);
        }
    }
}

/// Small numbers in turn, from 0 to 1.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Random rays from points of the air of rooms.
fn rays_from_rooms(scene: &Scene, count: usize, seed: u64) -> Vec<(u32, Ray)> {
    let mut number = numbers(seed);
    let rooms: Vec<_> = scene.rooms().map(|room| room.bounds()).collect();
    let mut rays = Vec::new();
    while rays.len() < count {
        let [lo, hi] = rooms[(number() * rooms.len() as f64) as usize];
        let point = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * number());
        let (z, turn) = (2.0 * number() - 1.0, std::f64::consts::TAU * number());
        let across = (1.0 - z * z).sqrt();
        if let Place::Air { room: Some(room), .. } = scene.locate(point) {
            rays.push((room, Ray::new(point, [across * turn.cos(), across * turn.sin(), z])));
        }
    }
    rays
}

#[test]
fn nothing_gets_through_sealed_openings() {
    for (name, building) in buildings() {
        let model = building.export(&Style::exact()).to_model().unwrap();
        let mut scene = scene(&model);
        let graph = scene.graph();
        let all: Vec<(u32, Stand)> = graph
            .openings
            .iter()
            .filter(|o| !o.cells.is_empty())
            .map(|o| (o.element, Stand::SEALED))
            .collect();
        scene.set_stands(&all).unwrap();
        for closure in scene.closures() {
            assert!(closure.sealed > 0.999, "{name}: {} {closure:?}", scene.element(closure.opening).path());
        }
        // Rooms that meet in the air are one.
        let mut one: Vec<usize> = (0..graph.rooms.len()).collect();
        let top = |one: &[usize], mut i: usize| {
            while one[i] != i {
                i = one[i];
            }
            i
        };
        for portal in graph.portals.iter().filter(|portal| portal.opening.is_none()) {
            if let [enfilade::graph::Place::Room(a), enfilade::graph::Place::Room(b)] = portal.places {
                let (a, b) = (top(&one, a as usize), top(&one, b as usize));
                one[a] = b;
            }
        }
        for (room, ray) in rays_from_rooms(&scene, 20_000, 7) {
            // Whether an opening leads from where the ray starts.
            let leads_here = |opening: u32| {
                let is_here = |side: &Side| matches!(side, Side::Room(other) if top(&one, *other as usize) == top(&one, room as usize));
                let own = graph.openings.iter().find(|own| own.element == opening);
                own.is_some_and(|own| own.sides.iter().any(is_here))
            };
            match scene.trace(&ray) {
                Answer::Hit(hit) => {
                    let sheet = scene.closed_by(hit.triangle);
                    let cell = &scene.cells()[hit.cell as usize];
                    let same = hit.room != enfilade::NONE
                        && top(&one, hit.room as usize) == top(&one, room as usize);
                    let opening = sheet.or((cell.element != enfilade::NONE).then_some(cell.element));
                    let fits = if sheet.is_some() {
                        opening.is_some_and(leads_here)
                    } else {
                        same || opening.is_some_and(leads_here)
                    };
                    assert!(fits, "{name}: {ray:?} from {room} to {hit:?}");
                }
                other => panic!("{name}: {ray:?} from {room}: {other:?}"),
            }
        }
    }
}

#[test]
fn openings_opened_again_leave_no_trace() {
    let model = house(&HouseOptions::default()).export(&Style::cad(1)).to_model().unwrap();
    let (plain, mut scene) = (scene(&model), scene(&model));
    let rays: Vec<Ray> = rays_from_rooms(&plain, 5_000, 3).into_iter().map(|(_, ray)| ray).collect();
    let answers = |scene: &Scene| {
        let mut hits = vec![Hit::ESCAPED; rays.len()];
        scene.trace_many(&rays, &mut hits, Want::default());
        hits
    };
    let (before, openings) = (answers(&plain), openings(&scene));
    let all = |stand| openings.iter().map(|o| (o.element, stand)).collect::<Vec<_>>();
    scene.set_stands(&all(Stand::SEALED)).unwrap();
    let sealed = answers(&scene);
    assert_ne!(sealed, before);
    // One by one, and all at once: the same.
    for opening in &openings {
        scene.set_open(opening.element, true, Leaf::Out).unwrap();
    }
    let free = answers(&scene);
    assert!(scene.closures().is_empty() && free != before && free != sealed);
    for opening in openings.iter().rev() {
        scene.set_open(opening.element, false, Leaf::Out).unwrap();
    }
    assert_eq!(answers(&scene), sealed);
    scene.set_stands(&all(Stand::MODELLED)).unwrap();
    assert_eq!(answers(&scene), before);
    assert!(openings.iter().all(|o| scene.stand(o.element) == Stand::MODELLED));
}

#[test]
fn a_ray_goes_on_from_a_sheet_on_either_side() {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let mut scene = scene(&model);
    for opening in openings(&scene) {
        scene.set_open(opening.element, false, Leaf::Out).unwrap();
        let [from, to] = opening.ends.map(glam::DVec3::from);
        let ray = Ray::new(from.to_array(), (to - from).to_array());
        let Answer::Hit(hit) = scene.trace(&ray) else { panic!("{opening:?}") };
        assert_eq!(scene.closed_by(hit.triangle), Some(opening.element));
        assert!(hit.t > 0.0 && hit.t < from.distance(to), "{hit:?}");
        let filling = scene.element(opening.element).filling();
        assert_eq!(hit.element, filling.unwrap_or(opening.element));
        for direction in [ray.direction, ray.direction.map(|c| -c)] {
            let next = scene.trace_from(Start::Hit(&hit), &Ray::new(hit.point, direction), Want::LEAST);
            assert_ne!(scene.closed_by(next.triangle), Some(opening.element), "{next:?}");
        }
    }
}

#[test]
fn what_cannot_be_closed_is_said() {
    let model = house(&HouseOptions::default()).export(&Style::exact()).to_model().unwrap();
    let mut scene = scene(&model);
    let wall = scene.elements().find(|e| e.semantic() == Semantic::Wall).unwrap().index();
    assert!(matches!(scene.set_open(wall, false, Leaf::In), Err(ClosingError::NoOpening(_))));
    assert_eq!(scene.set_open(9_999_999, false, Leaf::In), Err(ClosingError::NoElement(9_999_999)));
    let door = openings(&scene)[0].element;
    // Nothing is changed if one of many fails.
    let both = [(door, Stand::CLOSED), (wall, Stand::CLOSED)];
    assert!(scene.set_stands(&both).is_err());
    assert_eq!(scene.stand(door), Stand::MODELLED);
    assert!(scene.closures().is_empty());
    // By what fills it.
    let leaf = scene.element(door).filling().unwrap();
    scene.set_open(leaf, false, Leaf::In).unwrap();
    assert_eq!(scene.stand(door), Stand::CLOSED);
    let mut options = CompileOptions::default();
    options.cells = false;
    let mut plain = compile(&model, &options).unwrap().scene();
    assert!(matches!(plain.set_open(door, false, Leaf::In), Err(ClosingError::NoAir(_))));
    plain.set_open(door, true, Leaf::Out).unwrap();
    check(&model, &plain, 2_000, "without cells");
}

/// A model of boxes.
struct Boxes(ModelBuilder, MaterialId);

impl Boxes {
    /// Two rooms of 6 by 4 m, with floor, roof and walls around; between them, from y = 4 to 4.3 m, whatever comes.
    fn two_rooms() -> Boxes {
        let mut builder = ModelBuilder::new("boxes", Frame { up: UpAxis::Z, ..Frame::default() });
        let material = builder.material(Material::default());
        let mut boxes = Boxes(builder, material);
        boxes.add("floor", Semantic::Ground, [-0.3, -0.3, -0.3], [6.3, 8.6, 0.0], None);
        boxes.add("roof", Semantic::Roof, [-0.3, -0.3, 3.0], [6.3, 8.6, 3.3], None);
        boxes.add("south", Semantic::Wall, [-0.3, -0.3, 0.0], [6.3, 0.0, 3.0], None);
        boxes.add("north", Semantic::Wall, [-0.3, 8.3, 0.0], [6.3, 8.6, 3.0], None);
        boxes.add("west", Semantic::Wall, [-0.3, 0.0, 0.0], [0.0, 8.3, 3.0], None);
        boxes.add("east", Semantic::Wall, [6.0, 0.0, 0.0], [6.3, 8.3, 3.0], None);
        boxes.add("one", Semantic::Room, [0.0, 0.0, 0.0], [6.0, 4.0, 3.0], None);
        boxes.add("other", Semantic::Room, [0.0, 4.3, 0.0], [6.0, 8.3, 3.0], None);
        boxes
    }

    fn add(&mut self, id: &str, semantic: Semantic, lo: [f64; 3], hi: [f64; 3], opening: Option<&str>) {
        let element =
            NewElement { name: id.into(), opening: opening.map(Into::into), ..NewElement::default() };
        let element = self.0.element(element).unwrap();
        self.0.semantic(element, semantic);
        let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { hi[axis] } else { lo[axis] });
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        for [a, b, c, d] in quads.map(|quad: [usize; 4]| quad.map(corner)) {
            self.0.triangle(element, [a, b, c], self.1).unwrap();
            self.0.triangle(element, [a, c, d], self.1).unwrap();
        }
    }

    fn scene(self) -> Scene {
        scene(&self.0.finish().unwrap())
    }
}

/// Closes some openings; returns where their sheets stand along y.
fn depths(scene: &mut Scene, ids: &[&str]) -> Vec<f64> {
    let all: Vec<(u32, Stand)> =
        scene.elements().filter(|e| ids.contains(&e.id())).map(|e| (e.index(), Stand::SEALED)).collect();
    scene.set_stands(&all).unwrap();
    assert!(scene.closures().iter().all(|closure| closure.sealed > 0.999), "{:?}", scene.closures());
    scene.closures().iter().map(|closure| scene.triangle(closure.triangles.start)[0][1]).collect()
}

#[test]
fn sheets_of_one_hole_meet_whatever_their_openings_depth() {
    for label in [[4.0, 4.3], [4.1, 4.3], [4.0, 4.2]] {
        let mut boxes = Boxes::two_rooms();
        boxes.add("a", Semantic::Wall, [0.0, 4.0, 0.0], [1.0, 4.3, 3.0], None);
        boxes.add("b", Semantic::Wall, [4.0, 4.0, 0.0], [6.0, 4.3, 3.0], None);
        boxes.add("lintel", Semantic::Wall, [1.0, 4.0, 2.0], [4.0, 4.3, 3.0], None);
        boxes.add("sill", Semantic::Wall, [2.0, 4.0, 0.0], [4.0, 4.3, 1.0], None);
        boxes.add("door", Semantic::Door, [1.0, 4.0, 0.0], [2.0, 4.3, 2.0], None);
        boxes.add("window", Semantic::Window, [2.0, label[0], 1.0], [4.0, label[1], 2.0], None);
        let mut scene = boxes.scene();
        let depths = depths(&mut scene, &["door", "window"]);
        assert!(depths.len() == 2 && (depths[0] - depths[1]).abs() < 1e-6, "{label:?}: {depths:?}");
        let mut number = numbers(11);
        for _ in 0..50_000 {
            let from = [6.0 * number(), 4.0 * number(), 3.0 * number()];
            let to = [6.0 * number(), 4.3 + 4.0 * number(), 3.0 * number()];
            let way = [0, 1, 2].map(|i| to[i] - from[i]);
            let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
            assert!(scene.occluded(&Ray::segment(from, way, 0.0, length)), "{label:?}: {from:?} {to:?}");
        }
    }
}

#[test]
fn a_sheet_stands_in_the_plane_of_a_leaf_within_the_hole_only() {
    for (leaf, expected) in [([4.05, 4.09], 4.07), ([3.9, 3.95], 4.15), ([3.2, 4.05], 4.15)] {
        let mut boxes = Boxes::two_rooms();
        boxes.add("a", Semantic::Wall, [0.0, 4.0, 0.0], [1.0, 4.3, 3.0], None);
        boxes.add("b", Semantic::Wall, [2.0, 4.0, 0.0], [6.0, 4.3, 3.0], None);
        boxes.add("lintel", Semantic::Wall, [1.0, 4.0, 2.0], [2.0, 4.3, 3.0], None);
        boxes.add("door", Semantic::Door, [1.0, 4.0, 0.0], [2.0, 4.3, 2.0], None);
        boxes.add("leaf", Semantic::DoorLeaf, [1.0, leaf[0], 0.0], [2.0, leaf[1], 2.0], Some("door"));
        let depths = depths(&mut boxes.scene(), &["door"]);
        assert!((depths[0] - expected).abs() < 1e-4, "{leaf:?}: {depths:?}");
    }
}
