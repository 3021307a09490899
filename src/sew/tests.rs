use super::*;
use crate::generate::{
    Building, HouseOptions, OfficeOptions, Style, TowerOptions, build1, house, random, tower,
};
use crate::gmap::Orbit;
use crate::importers::Model;
use crate::partition::{PartitionOptions, partition};

/// Everything that a map of cells must be: each cell a volume and a ball, nothing open but towards the outside of the hull, and
/// that a box; faces on both sides of which there are the cells that say so.
fn check(name: &str, model: &Model) {
    let (partition, _) = partition(model, &PartitionOptions::default()).unwrap();
    let clock = std::time::Instant::now();
    let topology = sew(&partition).unwrap_or_else(|error| panic!("{name}: {error}"));
    let map = &topology.map;
    println!(
        "{name}: {} cells, {} faces, {} vertices, {} darts, {:?} joined, {:.3} s",
        partition.cells.len(),
        topology.faces.len(),
        topology.points.len(),
        map.len(),
        topology.joined,
        clock.elapsed().as_secs_f64()
    );
    assert_eq!(map.check(), Ok(()), "{name}");
    let volumes = map.index(Orbit::Volume);
    assert_eq!(volumes.len(), partition.cells.len(), "{name}");
    for volume in volumes.darts() {
        let cell = topology.cell_of[volume.index()];
        let shape = map.shape(*volume);
        assert!(shape.is_ball(), "{name}: cell {cell}: {shape:?}");
    }
    assert!((0..3).all(|i| map.free(i).next().is_none()), "{name}");
    assert_eq!(map.count(Orbit::Component), 1, "{name}");
    let any = map.darts().next().unwrap();
    assert!(map.orientation(Orbit::Component, any).is_some(), "{name}");
    // A ball of balls: vertices - edges + faces - volumes.
    assert_eq!(map.euler(), 1, "{name}");

    let mut outside = 0.0;
    for face in &topology.faces {
        assert_eq!(topology.cell_of[face.dart.index()], face.one, "{name}");
        let beyond = map.alpha(3, face.dart);
        match face.other {
            NONE => {
                assert_eq!(beyond, face.dart, "{name}");
                outside += topology.area(face.dart);
            }
            other => assert_eq!(topology.cell_of[beyond.index()], other, "{name}"),
        }
    }
    let [x, y, z] = [0, 1, 2].map(|i| f64::from(partition.hull[1][i]) - f64::from(partition.hull[0][i]));
    let hull = 2.0 * (x * y + y * z + z * x);
    assert!((outside - hull).abs() <= 1e-9 * hull, "{name}: {outside} of {hull}");
}

fn bare_house() -> Building {
    house(&HouseOptions { furniture: false, ..HouseOptions::default() })
}

#[test]
fn a_house_is_a_map() {
    check("house", &bare_house().to_model().unwrap());
}

#[test]
fn generated_buildings_are_maps() {
    let office = |seed: u64| OfficeOptions { furniture: false, seed, ..OfficeOptions::default() };
    check("build1", &build1(&office(0)).to_model().unwrap());
    check(
        "tower",
        &tower(&TowerOptions { office: office(0), ..TowerOptions::default() }).to_model().unwrap(),
    );
    for seed in 0..6 {
        check(&format!("random {seed}"), &random(&office(seed)).to_model().unwrap());
    }
}

#[test]
fn damaged_houses_are_maps() {
    let building = bare_house();
    for seed in 0..24 {
        let style = Style::damage([0.1, 0.3, 0.7][seed as usize % 3], seed);
        check(&format!("damage {seed}"), &building.export(&style).to_model().unwrap());
    }
}

#[test]
fn real_buildings_are_maps() {
    for (name, model) in crate::partition::testing::real_models() {
        check(&name, &model);
    }
}

#[test]
fn what_contradicts_itself_is_refused() {
    let model = bare_house().to_model().unwrap();
    let (whole, _) = partition(&model, &PartitionOptions::default()).unwrap();
    // A cell that does not know what lies above it.
    let mut partition = whole.clone();
    let cell =
        partition.cells.iter().find(|c| partition.covers[c.above.start as usize].cell != NONE).unwrap();
    let cover = cell.above.start as usize;
    partition.covers[cover].cell = NONE;
    let error = sew(&partition).unwrap_err();
    assert!(error.to_string().contains("faces"), "{error}");
    assert!(sew(&whole).is_ok());
}
