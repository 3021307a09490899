//! What generated buildings promise, on the house.

use std::collections::BTreeMap;

use super::lattice::{Point, metres, point_metres};
use super::*;
use crate::importers::Role;
use crate::splitmix::SplitMix64;

/// A random point in the box, off the grid on all axes.
fn point_in(random: &mut SplitMix64, [lo, hi]: [Point; 2]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let span = (hi[i] - lo[i]) as u64;
        metres(lo[i]) + (random.below(span) as f64 + 0.37) / f64::from(lattice::PER_METRE)
    })
}

/// An element's triangles in metres, for tests that share nothing with how the element was made.
struct Shape {
    triangles: Vec<[[f64; 3]; 3]>,
    bounds: [Point; 2],
}

impl Shape {
    fn of(element: &Element) -> Shape {
        let corners = |t: [u32; 3]| t.map(|i| point_metres(element.points[i as usize]));
        let triangles = element.faces.iter().flat_map(|f| element.triangles(f)).map(corners).collect();
        let bound = |pick: fn(i32, i32) -> i32| {
            [0, 1, 2].map(|axis| element.points.iter().map(|p| p[axis]).reduce(pick).unwrap())
        };
        Shape { triangles, bounds: [bound(i32::min), bound(i32::max)] }
    }

    /// How often the surface winds around a point: the sum of the solid angles of its triangles.
    fn winding(&self, p: [f64; 3]) -> f64 {
        if (0..3).any(|i| p[i] < metres(self.bounds[0][i]) || p[i] > metres(self.bounds[1][i])) {
            return 0.0;
        }
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let angle = |t: &[[f64; 3]; 3]| {
            let [a, b, c] = t.map(|q| [q[0] - p[0], q[1] - p[1], q[2] - p[2]]);
            let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
            2.0 * dot(a, cross).atan2(below)
        };
        self.triangles.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
    }

    /// Whether a point is inside; fails if the surface does not say clearly.
    fn holds(&self, p: [f64; 3]) -> bool {
        let winding = self.winding(p);
        let whole = winding.round();
        assert!((winding - whole).abs() < 1e-6 && (whole == 0.0 || whole == 1.0), "{winding} around {p:?}");
        whole == 1.0
    }
}

fn shapes(building: &Building, wanted: impl Fn(&Element) -> bool) -> Vec<(&Element, Shape)> {
    building.elements.iter().filter(|e| wanted(e)).map(|e| (e, Shape::of(e))).collect()
}

fn is_volume(element: &Element) -> bool {
    element.kind != Kind::Detail
}

fn all_houses() -> Vec<Building> {
    let mut options = vec![HouseOptions::default()];
    options.push(HouseOptions { furniture: false, ..HouseOptions::default() });
    options.push(HouseOptions { site: false, ..HouseOptions::default() });
    options.extend((1..9).map(|seed| HouseOptions { seed, ..HouseOptions::default() }));
    options.iter().map(house).collect()
}

/// All buildings, small and large, and random ones.
fn all_buildings() -> Vec<Building> {
    let mut all = all_houses();
    let bare = OfficeOptions { furniture: false, ..OfficeOptions::default() };
    all.extend([build1(&OfficeOptions::default()), build1(&bare), build2(&bare)]);
    all.extend([1, 2, 3].map(|storeys| tower(&TowerOptions { storeys, office: bare })));
    all.extend((0..24).map(|seed| random(&OfficeOptions { seed, ..bare })));
    all
}

/// Panics unless each directed edge occurs once, and its reverse too.
fn assert_closed<P: Ord + Copy + std::fmt::Debug>(rings: impl Iterator<Item = Vec<P>>, name: &str) {
    let mut edges: BTreeMap<(P, P), u32> = BTreeMap::new();
    for ring in rings {
        for (i, &p) in ring.iter().enumerate() {
            *edges.entry((p, ring[(i + 1) % ring.len()])).or_default() += 1;
        }
    }
    for (&(p, q), &count) in &edges {
        assert_eq!(count, 1, "{name}: edge {p:?} to {q:?}");
        assert!(edges.contains_key(&(q, p)), "{name}: edge {p:?} to {q:?} has no partner");
    }
}

#[test]
fn elements_are_closed_and_planar() {
    for building in all_buildings() {
        for element in &building.elements {
            let name = element.tagged_name();
            let at = |ring: &[u32]| ring.iter().map(|&i| element.points[i as usize]).collect::<Vec<Point>>();
            let faces = || element.faces.iter();
            assert_closed(faces().flat_map(|f| f.loops.iter().map(|ring| at(ring))), &name);
            assert_closed(faces().flat_map(|f| element.triangles(f)).map(|t| at(&t)), &name);
            assert_closed(faces().flat_map(|f| element.polygons(f)).map(|p| at(&p)), &name);
            for face in faces() {
                let normal = element.normal(face).map(i128::from);
                let height = |p: Point| (0..3).map(|i| normal[i] * i128::from(p[i])).sum::<i128>();
                let points = at(&face.loops.concat());
                assert!(points.iter().all(|&p| height(p) == height(points[0])), "{name} has a bent face");
            }
            assert!(element.sixfold_volume() > 0, "{name}");
            let mut points = element.points.clone();
            points.sort_unstable();
            points.dedup();
            assert_eq!(points.len(), element.points.len(), "{name} has a point twice");
        }
    }
}

#[test]
fn volumes_fill_the_hull_exactly() {
    for building in all_buildings() {
        let [lo, hi] = building.hull;
        let hull: i128 = (0..3).map(|i| i128::from(hi[i] - lo[i])).product();
        let volumes = building.elements.iter().filter(|e| is_volume(e));
        assert_eq!(volumes.map(Element::sixfold_volume).sum::<i128>(), 6 * hull);
    }
}

#[test]
fn every_point_lies_in_one_volume() {
    let building = house(&HouseOptions::default());
    let volumes = shapes(&building, is_volume);
    let mut random = SplitMix64::new(7);
    // Half of the points in and near the house, where the volumes are small.
    let near = [[-600, -2600, -300], [12900, 11500, 4000]];
    for i in 0..4000 {
        let p = point_in(&mut random, if i % 2 == 0 { building.hull } else { near });
        let inside: Vec<_> =
            volumes.iter().filter(|(_, shape)| shape.holds(p)).map(|(e, _)| &e.name).collect();
        assert_eq!(inside.len(), 1, "{p:?} lies in {inside:?}");
    }
}

#[test]
fn details_stand_in_air_and_apart() {
    for building in all_houses() {
        let solids = shapes(&building, |e| e.kind == Kind::Solid);
        let details = shapes(&building, |e| !is_volume(e));
        let mut random = SplitMix64::new(11);
        for (element, shape) in &details {
            let mut inside = 0;
            for _ in 0..300 {
                let p = point_in(&mut random, shape.bounds);
                if !shape.holds(p) {
                    continue;
                }
                inside += 1;
                for (other, others_shape) in solids.iter().chain(&details) {
                    let clash = !std::ptr::eq(*other, *element) && others_shape.holds(p);
                    assert!(!clash, "{} and {} share {p:?}", element.name, other.name);
                }
            }
            assert!(inside > 0, "{}: no point of its box was inside", element.name);
        }
    }
}

#[test]
fn the_house_is_one() {
    let building = house(&HouseOptions::default());
    let of_class = |class: &'static str| building.elements.iter().filter(move |e| e.class == class);
    assert_eq!(of_class("IfcSpace").count(), 8);
    assert_eq!(of_class("IfcOpeningElement").count(), 23);
    assert_eq!(of_class("IfcDoor").count() + of_class("IfcWindow").count(), 22);
    for room in of_class("IfcSpace") {
        let area = room.volume() / 2.6;
        assert!((2.0..40.0).contains(&area), "{}: {area} m2", room.name);
    }
    let faces = building.visible_faces();
    assert!((1150..=1250).contains(&faces), "{faces} faces can be seen");
    let bare = house(&HouseOptions { furniture: false, ..HouseOptions::default() });
    assert!(bare.elements.iter().all(|e| e.class != "IfcFurnishingElement"));
    assert!(bare.visible_faces() < faces);

    let mut ids: Vec<&str> = building.elements.iter().map(|e| e.global_id.as_str()).collect();
    let mut names: Vec<String> = building.elements.iter().map(Element::tagged_name).collect();
    ids.sort_unstable();
    ids.dedup();
    names.sort_unstable();
    names.dedup();
    assert_eq!((ids.len(), names.len()), (building.elements.len(), building.elements.len()));
}

#[test]
fn roles_of_meanings_and_kinds_agree() {
    for element in house(&HouseOptions::default()).elements {
        let expected = match element.kind {
            Kind::Room | Kind::Opening | Kind::Exterior => Role::Air,
            // A site is a volume here, but for tracing it is a surface like any terrain.
            Kind::Solid if element.class == "IfcSite" => Role::Detail,
            Kind::Solid => Role::Solid,
            Kind::Detail => Role::Detail,
        };
        assert_eq!(element.semantic.role(), Some(expected), "{}", element.name);
    }
}

/// Where lights and cameras are, and what the openings join: by points beside them.
#[test]
fn lights_cameras_and_openings_are_where_they_should_be() {
    let building = house(&HouseOptions::default());
    let air = shapes(&building, |e| e.kind.is_air());
    let details = shapes(&building, |e| !is_volume(e));
    let room_at = |p: [f64; 3]| air.iter().find(|(_, shape)| shape.holds(p)).map(|(e, _)| e.name.as_str());
    let mut lit = Vec::new();
    for light in &building.lights {
        let room = room_at(light.position).unwrap();
        assert_eq!(light.name, format!("{room} light"));
        lit.push(room);
    }
    lit.sort_unstable();
    lit.dedup();
    assert_eq!(lit.len(), 8, "one light a room");
    let views: Vec<_> = building.cameras.iter().map(|c| room_at(c.eye)).collect();
    // The latter stands beyond the garden.
    assert_eq!(views, [Some("Living room"), None]);
    for p in building.lights.iter().map(|l| l.position).chain(building.cameras.iter().map(|c| c.eye)) {
        assert!(details.iter().all(|(_, shape)| !shape.holds(p)));
    }

    let mut joins = Vec::new();
    for opening in building.elements.iter().filter(|e| e.kind == Kind::Opening) {
        let Shape { bounds: [lo, hi], .. } = Shape::of(opening);
        let middle = [0, 1, 2].map(|i| metres(lo[i] + hi[i]) / 2.0);
        let mut sides = Vec::new();
        for axis in 0..2 {
            for (end, step) in [(lo, -0.01), (hi, 0.01)] {
                let mut beside = middle;
                beside[axis] = metres(end[axis]) + step;
                sides.extend(room_at(beside));
            }
        }
        assert_eq!(sides.len(), 2, "{} joins {sides:?}", opening.name);
        if let Some(filling) = opening.filling {
            let filling = &building.elements[filling as usize];
            assert_eq!(
                (filling.host, opening.name.clone()),
                (opening.host, format!("{} opening", filling.name))
            );
            assert!(filling.opening.is_some_and(|o| std::ptr::eq(&building.elements[o as usize], opening)));
        }
        let host = &building.elements[opening.host.unwrap() as usize];
        assert!(
            host.faces
                .iter()
                .any(|f| { f.beyond.is_some_and(|b| std::ptr::eq(&building.elements[b as usize], opening)) })
        );
        sides.sort_unstable();
        joins.push((opening.name.trim_end_matches(" opening"), sides[0], sides[1]));
    }
    for expected in [
        ("Entrance", "EXTERIOR", "Hall"),
        ("Terrace door", "EXTERIOR", "Living room"),
        ("Passage", "Kitchen", "Living room"),
        ("Dining", "Hall", "Living room"),
        ("Kitchen", "Hall", "Kitchen"),
        ("WC", "Hall", "WC"),
        ("Bath", "Bath", "Hall"),
        ("Children", "Children's room", "Hall"),
        ("Study", "Hall", "Study"),
        ("Bedroom", "Bedroom", "Hall"),
        ("WC north", "EXTERIOR", "WC"),
        ("Living west", "EXTERIOR", "Living room"),
        ("Corridor east", "EXTERIOR", "Hall"),
    ] {
        assert!(joins.contains(&expected), "{expected:?} is not among {joins:?}");
    }
}

#[test]
fn the_model_holds_all_triangles() {
    let building = house(&HouseOptions::default());
    let model = building.to_model().unwrap();
    assert_eq!(
        (model.elements.len(), model.lights.len(), model.cameras.len()),
        (building.elements.len(), 8, 2)
    );
    assert!(model.left_out.is_empty() && model.warnings.is_empty(), "{:?}", model.warnings);
    for (made, drawn) in model.elements.iter().zip(&building.elements) {
        assert_eq!((made.id.as_str(), made.semantic), (drawn.global_id.as_str(), drawn.semantic));
        // The model's frame is the generator's: metres, Z up.
        let volume: f64 = (0..made.mesh.triangles.len())
            .map(|t| {
                let [a, b, c] = made.mesh.corners(t);
                a[0] * (b[1] * c[2] - b[2] * c[1])
                    + a[1] * (b[2] * c[0] - b[0] * c[2])
                    + a[2] * (b[0] * c[1] - b[1] * c[0])
            })
            .sum();
        assert!((volume / 6.0 - drawn.volume()).abs() < 1e-9 * drawn.volume().max(1.0), "{}", drawn.name);
        assert_eq!(made.mesh.positions.len(), drawn.points.len());
    }
    assert_eq!(model.lights[0].position, building.lights[0].position);
    assert_eq!(model.cameras[1].eye, building.cameras[1].eye);
}

/// Points a little off all faces of an element, outside.
fn beside(element: &Element) -> Vec<[f64; 3]> {
    let mut points = Vec::new();
    for face in &element.faces {
        let n = element.normal(face).map(|c| c as f64);
        let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
        for triangle in element.triangles(face) {
            let corners = triangle.map(|i| point_metres(element.points[i as usize]));
            for weights in [[0.34, 0.35, 0.31], [0.8, 0.09, 0.11], [0.1, 0.83, 0.07], [0.06, 0.12, 0.82]] {
                points.push(
                    [0, 1, 2].map(|i| {
                        (0..3).map(|k| weights[k] * corners[k][i]).sum::<f64>() + n[i] / length * 2e-4
                    }),
                );
            }
        }
    }
    points
}

#[test]
fn the_truth_is_what_the_meshes_say() {
    let bare = OfficeOptions { furniture: false, ..OfficeOptions::default() };
    let mut all = vec![
        house(&HouseOptions::default()),
        build1(&bare),
        tower(&TowerOptions { storeys: 3, office: bare }),
    ];
    all.extend((0..8).map(|seed| random(&OfficeOptions { seed, ..bare })));
    for building in &all {
        let truth = building.truth();
        let volumes = shapes(building, is_volume);
        let at = |p: [f64; 3]| volumes.iter().find(|(_, shape)| shape.holds(p)).map(|(e, _)| *e);
        let air: f64 = truth
            .rooms
            .iter()
            .map(|r| &r.air)
            .chain(truth.openings.iter().map(|o| &o.air))
            .chain([&truth.exterior])
            .map(|a| a.volume)
            .sum();
        let solid: f64 =
            building.elements.iter().filter(|e| e.kind == Kind::Solid).map(Element::volume).sum();
        assert!((air + solid - truth.volume).abs() < 1e-9 * truth.volume, "{}", building.name);

        // Each opening joins the volumes of air that points beside its faces lie in.
        assert_eq!(
            truth.openings.len(),
            building.elements.iter().filter(|e| e.kind == Kind::Opening).count()
        );
        for opening in &truth.openings {
            let element = building.elements.iter().find(|e| e.global_id == opening.air.id).unwrap();
            let found: BTreeMap<&str, ()> = beside(element)
                .into_iter()
                .filter_map(&at)
                .filter(|e| e.kind.is_air())
                .map(|e| (e.global_id.as_str(), ()))
                .collect();
            let told: BTreeMap<&str, ()> = opening.joins.iter().map(|p| (p.id.as_str(), ())).collect();
            assert_eq!(told, found, "{}: {}", building.name, opening.air.name);
            // A window in an outer wall joins the room and the outside, a door two rooms.
            assert_eq!(told.len(), 2, "{}: {}", building.name, opening.air.name);
        }

        // The faces of a room are all of its surface, floor area and all.
        for room in &truth.rooms {
            let (element, shape) = volumes.iter().find(|(e, _)| e.global_id == room.air.id).unwrap();
            let area = |t: &[[f64; 3]; 3]| {
                let [u, v] = [1, 2].map(|k| [0, 1, 2].map(|i| t[k][i] - t[0][i]));
                let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt() / 2.0
            };
            let surface: f64 = shape.triangles.iter().map(area).sum();
            let told: f64 = room.air.faces.values().sum();
            assert!(
                (surface - told).abs() < 1e-9 * surface,
                "{}: {} {surface} {told}",
                building.name,
                element.name
            );
            assert!(room.floor_area > 0.0 && room.air.faces["PORTAL"] > 0.0, "{}", element.name);
        }

        assert!(truth.points.len() >= 300 + 2 * truth.rooms.len(), "{}", truth.points.len());
        for point in truth.points.iter().step_by(7) {
            assert_eq!(at(point.point).map(|e| &e.global_id), Some(&point.id), "{:?}", point.point);
        }
    }
}

#[test]
fn office_buildings_are_those_of_the_paper() {
    let rooms = |b: &Building| b.elements.iter().filter(|e| e.kind == Kind::Room).count();
    let first = build1(&OfficeOptions::default());
    let second = build2(&OfficeOptions::default());
    assert_eq!([rooms(&first), rooms(&second)], [46, 135]);
    assert_eq!([first.lights.len(), second.lights.len()], [55, 199]);
    let near = |faces: usize, wanted: usize| faces * 10 > wanted * 9 && faces * 10 < wanted * 11;
    assert!(near(first.visible_faces(), 8557), "{}", first.visible_faces());
    assert!(near(second.visible_faces(), 29_937), "{}", second.visible_faces());
}
