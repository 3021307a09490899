//! The volumes of a building written as a file of tagged meshes, read again and sewn again: the same map.
//!
//! `PROPTEST_CASES` says how many buildings are tried; without it, a few, always the same.
#![cfg(all(feature = "compile", feature = "obj"))]

use crate::common::cases;
mod outline;

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use cases::cases;
use enfilade::arbitrary::assemblies;
use enfilade::building::Building;
use enfilade::generate::{HouseOptions, OfficeOptions, build1, house};
use enfilade::gmap::{Dart, GMap};
use enfilade::importers::{ImportOptions, Model, Semantic, UpAxis, obj, tagging};
use enfilade::partition::cells::NONE;
use enfilade::partition::{PartitionOptions, partition};
use enfilade::sew::{Part, Sewn, VolumesError, sew_volumes};
use outline::{Outline, Side};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

fn built(model: &Model) -> Building {
    let (cells, _) = partition(model, &PartitionOptions::default()).unwrap();
    Building::new(model, &cells).unwrap()
}

/// The model as an OBJ file.
fn written(model: &Model) -> String {
    let (mut text, mut first) = (String::new(), 1);
    for element in &model.elements {
        writeln!(text, "o {}_{}", element.semantic.name(), element.id).unwrap();
        for [x, y, z] in &element.mesh.positions {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for (triangle, material) in element.mesh.triangles.iter().zip(&element.mesh.materials) {
            let [a, b, c] = triangle.map(|v| v + first);
            writeln!(text, "usemtl {}\nf {a} {b} {c}", model.materials[material.0 as usize].name).unwrap();
        }
        first += element.mesh.positions.len() as u32;
    }
    text
}

fn read(text: &str) -> Model {
    let mut options = ImportOptions::default();
    options.up = Some(UpAxis::Z);
    let mut model = obj::read_text(text.as_bytes(), "volumes.obj", None, &options).unwrap();
    tagging::tag(&mut model, &options).unwrap();
    model
}

/// What came of a building's volumes.
#[derive(Clone, Debug, PartialEq)]
enum Outcome {
    Same,
    Different(String),
    /// They are no meshes that can be told apart. Where planes are rounded so that a volume has no height, its floor lies on its ceiling: of
    /// several such volumes on each other no mesh tells the order, a diagonal of the one may lie on an edge of the other; what
    /// is narrower than the digits of an f64 has no triangles, and corners nearer than that are one.
    NoMeshes,
}

/// Writes a building's volumes, reads and sews them, and compares the map with the building's own.
fn outcome(building: &Building) -> Outcome {
    let model = building.to_model().unwrap();
    let model = read(&written(&model));
    // The volume that an element was, and its tag.
    let number =
        |element: usize| -> u32 { model.elements[element].name.rsplit('_').next().unwrap().parse().unwrap() };
    for (index, element) in model.elements.iter().enumerate() {
        let was = match building.semantic(building.volumes[number(index) as usize].label) {
            Semantic::Void => Semantic::Exterior,
            semantic => semantic,
        };
        if element.semantic != was {
            return Outcome::Different(format!("{} is {}", element.name, element.semantic));
        }
    }
    let topology = &building.topology;
    let sides = |face: &Sewn| if face.other == NONE { 1 } else { 2 };
    let triangles = |face: &Sewn| sides(face) * (topology.map.around_face(face.dart).count() - 2);
    let has_all_triangles =
        model.triangle_count() as usize == topology.faces.iter().map(triangles).sum::<usize>();
    let positions = model.elements.iter().flat_map(|element| &element.mesh.positions);
    let apart: HashSet<[u64; 3]> = positions.map(|p| p.map(f64::to_bits)).collect();
    let is_whole = has_all_triangles && apart.len() == topology.points.len();
    let again = match sew_volumes(&model) {
        Ok(again) => again,
        Err(VolumesError::Crowded { .. } | VolumesError::Edge { triangles: 4.., .. }) => {
            return Outcome::NoMeshes;
        }
        Err(_) if !is_whole => return Outcome::NoMeshes,
        Err(error) => return Outcome::Different(error.to_string()),
    };
    if let Err(defect) = again.map.check() {
        return Outcome::Different(defect.to_string());
    }
    let material = |dart: Dart| {
        let mesh = &model.elements[again.element_of[dart.index()].0 as usize].mesh;
        let material = mesh.materials[again.triangle_of[dart.index()] as usize];
        model.materials[material.0 as usize].name.as_str()
    };
    let side = |corners: &[Dart]| match material(corners[0]) {
        "floor" => Side::Below,
        "ceiling" => Side::Above,
        _ => Side::upright(corners.iter().map(|c| building.lattice.local(again.point_of[c.index()]))),
    };
    let number = |dart: Dart| number(again.element_of[dart.index()].0 as usize);
    match own_outline(building, topology.map.clone()).is_isomorphic(&Outline::of(
        again.map.clone(),
        number,
        side,
    )) {
        Ok(()) => Outcome::Same,
        Err(_) if !is_whole => Outcome::NoMeshes,
        Err(what) => Outcome::Different(what),
    }
}

/// The outline of a building's map, or of what became of it.
fn own_outline(building: &Building, map: GMap) -> Outline {
    let topology = &building.topology;
    let hull: HashMap<Dart, Part> = topology
        .faces
        .iter()
        .filter(|face| face.other == NONE)
        .flat_map(|face| topology.map.around_face(face.dart).map(|dart| (dart, face.way.part(true))))
        .collect();
    let point = |dart: &Dart| topology.points[topology.vertex_of[dart.index()] as usize];
    let side = |corners: &[Dart]| match corners.iter().find_map(|dart| hull.get(dart)) {
        Some(Part::Floor) => Side::Below,
        Some(Part::Ceiling) => Side::Above,
        _ => Side::upright(corners.iter().map(point)),
    };
    Outline::of(map, |dart| topology.cell_of[dart.index()], side)
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn volumes_are_sewn_to_the_same_map(assembly in assemblies()) {
        let outcome = outcome(&built(&assembly.model()));
        prop_assume!(outcome != Outcome::NoMeshes);
        prop_assert_eq!(outcome, Outcome::Same);
    }
}

#[test]
fn most_random_buildings_have_volumes_that_are_meshes() {
    let mut runner = TestRunner::new(cases(0));
    let count = 60;
    let mut none = 0;
    for _ in 0..count {
        let assembly = assemblies().new_tree(&mut runner).unwrap().current();
        none += i32::from(outcome(&built(&assembly.model())) == Outcome::NoMeshes);
    }
    println!("{none} of {count} have volumes that are no meshes");
    assert!(none * 8 < count);
}

#[test]
fn generated_buildings_are_sewn_to_the_same_map() {
    let options = OfficeOptions::default();
    for building in [house(&HouseOptions::default()), build1(&options)] {
        let model = building.to_model().unwrap();
        assert_eq!(outcome(&built(&model)), Outcome::Same, "{}", building.name);
    }
}

/// A map that is another is told from it.
#[test]
fn other_maps_are_not_the_same() {
    let building = built(&house(&HouseOptions::default()).to_model().unwrap());
    let topology = &building.topology;
    let outline = |map: GMap| own_outline(&building, map);
    let own = outline(topology.map.clone());
    assert_eq!(own.is_isomorphic(&outline(topology.map.clone())), Ok(()));
    for face in topology.faces.iter().filter(|face| face.other != NONE).step_by(50) {
        let mut torn = topology.map.clone();
        torn.unsew(3, face.dart).unwrap();
        assert!(own.is_isomorphic(&outline(torn)).is_err(), "{face:?}");
    }
}
