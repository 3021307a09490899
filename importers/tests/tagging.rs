//! How elements get their meaning: each way, and which goes before which.
#![cfg(feature = "rules")]

use std::collections::BTreeMap;

use enfilade_importers::tagging::{Rules, describe, tag};
use enfilade_importers::{
    CancelToken, Element, Frame, ImportErrorKind, ImportOptions, Material, Model, ModelBuilder, NewElement,
    Semantic, TagSource, Untagged, Watch,
};
use proptest::prelude::*;

fn map(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect()
}

/// A model of these elements, a triangle each, of the materials `brick` and `glass` in turn.
fn model_of(elements: Vec<NewElement>) -> Model {
    let mut builder = ModelBuilder::new("test.glb", Frame::default());
    let materials = ["brick", "glass"]
        .map(|name| builder.material(Material { name: name.into(), ..Material::default() }));
    for (index, new) in elements.into_iter().enumerate() {
        let element = builder.element(new).unwrap();
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        builder.triangle(element, corners, materials[index % 2]).unwrap();
    }
    builder.finish().unwrap()
}

fn tagged(elements: Vec<NewElement>, options: &ImportOptions) -> Model {
    let mut model = model_of(elements);
    tag(&mut model, options).unwrap();
    model
}

fn with_rules(text: &str) -> ImportOptions {
    let mut options = ImportOptions::default();
    options.rules = Some(Rules::parse(text, "my.toml").unwrap());
    options
}

/// The tags of one element.
fn one(new: NewElement, options: &ImportOptions) -> Element {
    tagged(vec![new], options).elements.remove(0)
}

fn named(name: &str) -> NewElement {
    NewElement { name: name.into(), ..NewElement::default() }
}

/// An element that every way would give another meaning.
fn contradictory() -> NewElement {
    NewElement {
        name: "COLUMN_x".into(),
        class: Some("IfcBeam".into()),
        extras: map(&[("semantic", "roof"), ("ifc_class", "IfcBeam")]),
        ..NewElement::default()
    }
}

#[test]
fn the_order_of_the_ways() {
    let none = ImportOptions::default();
    let rule = with_rules("[[rule]]\nname = '^COLUMN'\nsemantic = 'STAIR'");

    let element = one(contradictory(), &rule);
    assert_eq!((element.semantic, element.tagged_by), (Semantic::Stair, TagSource::UserRule(1)));

    let element = one(contradictory(), &none);
    assert_eq!((element.semantic, element.tagged_by), (Semantic::Roof, TagSource::Extras));

    let mut new = contradictory();
    new.extras.remove("semantic");
    let element = one(new.clone(), &none);
    assert_eq!(element.semantic, Semantic::Beam);
    assert!(matches!(element.tagged_by, TagSource::Class(_)));

    new.class = None;
    new.extras.clear();
    let element = one(new, &none);
    assert_eq!((element.semantic, element.tagged_by), (Semantic::Column, TagSource::Name));

    let element = one(named("x"), &none);
    assert_eq!((element.semantic, element.tagged_by), (Semantic::Unknown, TagSource::None));
}

#[test]
fn what_the_program_tagged_stays() {
    let mut builder = ModelBuilder::new("test", Frame::default());
    let material = builder.material(Material::default());
    let element = builder.element(contradictory()).unwrap();
    builder.semantic(element, Semantic::Furniture);
    builder.triangle(element, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material).unwrap();
    let mut model = builder.finish().unwrap();
    tag(&mut model, &with_rules("[[rule]]\nsemantic = 'WALL'")).unwrap();
    let element = &model.elements[0];
    assert_eq!((element.semantic, element.tagged_by.clone()), (Semantic::Furniture, TagSource::Program));
    assert_eq!(describe(element, None), "program");
}

#[test]
fn every_condition_of_a_rule_counts() {
    let element = || NewElement {
        id: "3Ux0vH".into(),
        name: "Panel 7".into(),
        source_name: "IfcPlate:Panel 7".into(),
        other_names: vec!["mesh_7".into()],
        path: "House/Level 1/IfcPlate:Panel 7".into(),
        class: Some("IfcPlate".into()),
        storey: Some("Level 1".into()),
        extras: map(&[("fire_rating", "F90")]),
        inherited: map(&[("phase", "new"), ("fire_rating", "F30")]),
        ..NewElement::default()
    };
    let meets = [
        "name = '^Panel'",
        "name = '^IfcPlate:'",
        "other_name = '^mesh_7$'",
        "class = '^IfcPlate$'",
        "class = 'Plate'",
        "class = '(?i)^(ifcwall|ifcplate)$'",
        "material = '^brick$'",
        "path = '/Level 1/'",
        "storey = '1$'",
        "id = '^3Ux0vH$'",
        "extras.fire_rating = '^F90$'",
        "extras.phase = '^new$'",
        "extras.'phase' = 'e'",
        "name = 'Panel'\nid = '3'\nstorey = '1'",
        "",
    ];
    for conditions in meets {
        let options = with_rules(&format!("[[rule]]\n{conditions}\nsemantic = 'RAILING'"));
        assert_eq!(one(element(), &options).tagged_by, TagSource::UserRule(1), "{conditions}");
    }
    let meets_not = [
        "name = 'panel'",
        "other_name = 'Panel'",
        "class = '^plate'",
        "class = '^ifcplate$'",
        "material = 'glass'",
        "filling = '.'",
        "path = '^Level'",
        "storey = '2'",
        "id = '4'",
        "extras.fire_rating = 'F30'",
        "extras.phases = '.'",
        "name = 'Panel'\nid = '4'\nstorey = '1'",
    ];
    for conditions in meets_not {
        let options = with_rules(&format!("[[rule]]\n{conditions}\nsemantic = 'RAILING'"));
        assert_eq!(one(element(), &options).semantic, Semantic::Covering, "{conditions}");
    }
}

#[test]
fn the_first_rule_wins_and_may_take_a_tag_away() {
    let options = with_rules(
        "
        [[rule]]
        name = 'b'
        semantic = 'GROUND'
        [[rule]]
        class = '^IfcWall$'
        semantic = 'UNKNOWN'
        [[rule]]
        name = '[ab]'
        semantic = 'ROOF'
        [[rule]]
        class = 'Wall'
        semantic = 'COLUMN'",
    );
    let wall = |name: &str, class: &str| NewElement { class: Some(class.into()), ..named(name) };
    let model = tagged(
        vec![wall("b", "IfcWall"), wall("a", "IfcWall"), named("a2"), wall("c", "IfcWallStandardCase")],
        &options,
    );
    let tags: Vec<_> =
        model.elements.iter().map(|e| (e.semantic, describe(e, options.rules.as_ref()))).collect();
    assert_eq!(
        tags,
        [
            (Semantic::Ground, "rule 1 of my.toml".to_owned()),
            (Semantic::Unknown, "rule 2 of my.toml".to_owned()),
            (Semantic::Roof, "rule 3 of my.toml".to_owned()),
            (Semantic::Column, "rule 4 of my.toml".to_owned()),
        ]
    );
    assert_eq!(describe(&model.elements[0], None), "rule 1");
    // What lost its tag is among the untagged.
    assert_eq!(model.warnings.len(), 1);
    assert!(model.warnings[0].text.starts_with("1 element without a tag ('a'): solid where"));
}

#[test]
fn openings_are_named_after_what_fills_them_told_by_either() {
    let opening = |id: &str, filling: Option<&str>| NewElement {
        id: id.into(),
        class: Some("IfcOpeningElement".into()),
        filling: filling.map(str::to_owned),
        ..NewElement::default()
    };
    let thing = |id: &str, class: &str, opening: Option<&str>| NewElement {
        id: id.into(),
        class: Some(class.into()),
        opening: opening.map(str::to_owned),
        ..NewElement::default()
    };
    let model = tagged(
        vec![
            opening("o1", Some("d1")),
            thing("d1", "IfcDoor", None),
            opening("o2", None),
            thing("w2", "IfcWindowStandardCase", Some("o2")),
            opening("o3", None),
            opening("o4", Some("missing")),
            opening("o5", Some("c5")),
            thing("c5", "IfcCurtainWall", Some("o5")),
            thing("d6", "IFCDOOR", Some("o6")),
            opening("o6", Some("d6")),
        ],
        &ImportOptions::default(),
    );
    let of = |id: &str| model.elements.iter().find(|e| e.id == id).unwrap().semantic;
    assert_eq!(of("o1"), Semantic::Door);
    assert_eq!(of("o2"), Semantic::Window);
    assert_eq!(of("o3"), Semantic::Opening);
    assert_eq!(of("o4"), Semantic::Opening);
    assert_eq!(of("o5"), Semantic::Opening);
    assert_eq!(of("o6"), Semantic::Door);
    assert_eq!(of("d1"), Semantic::DoorLeaf);
    assert_eq!(of("w2"), Semantic::WindowFrame);
}

#[test]
fn wrong_words_warn_once_and_fall_through() {
    let mut elements: Vec<NewElement> = (0..50)
        .map(|i| NewElement {
            class: Some("IfcWall".into()),
            place: format!("nodes[{i}]"),
            extras: map(&[("semantic", "kitchen")]),
            ..named(&format!("w{i}"))
        })
        .collect();
    elements.push(NewElement {
        extras: map(&[("semantic", "  ")]),
        class: Some("IfcSlab".into()),
        ..named("s")
    });
    let model = tagged(elements, &ImportOptions::default());
    assert!(model.elements[..50].iter().all(|e| e.semantic == Semantic::Wall));
    assert_eq!(model.elements[50].semantic, Semantic::Ground);
    assert_eq!(model.warnings.len(), 1);
    assert_eq!(model.warnings[0].place, "nodes[0]");
    assert_eq!(
        model.warnings[0].text,
        "extras.semantic of 50 elements is no semantic word and was passed over (element 'w0': 'kitchen')"
    );
}

#[test]
fn untagged_elements_are_counted_or_refused() {
    let elements = || -> Vec<NewElement> {
        (0..7).map(|i| NewElement { place: format!("nodes[{i}]"), ..named(&format!("Cube.{i}")) }).collect()
    };
    for (untagged, becomes) in [
        (Untagged::ByMesh, "solid where the mesh is closed, detail elsewhere"),
        (Untagged::Solid, "solid"),
        (Untagged::Detail, "detail"),
    ] {
        let mut options = ImportOptions::default();
        options.untagged = untagged;
        let model = tagged(elements(), &options);
        let texts: Vec<&str> = model.warnings.iter().map(|w| w.text.as_str()).collect();
        let list = "'Cube.0', 'Cube.1', 'Cube.2', 'Cube.3', 'Cube.4', ...";
        assert_eq!(texts, [format!("7 elements without a tag ({list}): {becomes}")]);
    }
    let mut options = ImportOptions::default();
    options.untagged = Untagged::Error;
    let error = tag(&mut model_of(elements()), &options).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::Untagged(_)));
    let message = error.to_string();
    assert!(
        message.starts_with("test.glb: nodes[0]: element 'Cube.0': 7 elements without a tag ("),
        "{message}"
    );
    assert!(tag(&mut model_of(vec![named("WALL")]), &options).is_ok());
}

#[test]
fn cancelling_stops_it() {
    let token = CancelToken::new();
    token.cancel();
    let mut options = ImportOptions::default();
    options.watch = Watch::default().with_cancel(token);
    let error = tag(&mut model_of(vec![named("WALL")]), &options).unwrap_err();
    assert!(matches!(error.kind, ImportErrorKind::Cancelled(_)));
}

#[test]
fn names_give_classes_and_words() {
    let tags = |new: NewElement| {
        let element = one(new, &ImportOptions::default());
        (element.semantic, describe(&element, None))
    };
    assert_eq!(tags(named("IfcWall/Wall 1")), (Semantic::Wall, "class IfcWall".into()));
    assert_eq!(tags(named("IfcDoor.003")), (Semantic::DoorLeaf, "class IfcDoor".into()));
    // The name after the class was split off, the full name, the mesh's name.
    let split = NewElement { source_name: "IfcBuilding:ROOM_12#0aB".into(), ..named("ROOM_12") };
    assert_eq!(tags(split), (Semantic::Room, "name".into()));
    let full =
        NewElement { source_name: "ROOM:kitchen".into(), class: Some("ROOM".into()), ..named("kitchen") };
    assert_eq!(tags(full), (Semantic::Room, "name".into()));
    let mesh = NewElement { other_names: vec!["wall-brick".into()], ..named("Cube.001") };
    assert_eq!(tags(mesh), (Semantic::Wall, "name".into()));
    let mesh = NewElement { other_names: vec!["IfcSlab/Floor".into()], ..named("Cube.001") };
    assert_eq!(tags(mesh), (Semantic::Ground, "class IfcSlab".into()));
    // A class that the table does not know hides nothing.
    let odd = NewElement {
        class: Some("Sofa".into()),
        inherited: map(&[("ifc_class", "IfcFurniture")]),
        ..named("Sofa:3")
    };
    assert_eq!(tags(odd), (Semantic::Furniture, "class IfcFurniture".into()));
    let container = NewElement { class: Some("IfcBuildingStorey".into()), ..named("WALL_7") };
    assert_eq!(tags(container), (Semantic::Wall, "name".into()));
}

/// Nodes below a node: their path and the names above them, as readers give them.
fn below(parent: &str, name: &str) -> NewElement {
    NewElement {
        source_name: name.into(),
        other_names: vec![format!("{name} mesh"), parent.into(), "House".into()],
        path: format!("House/{parent}/{name}"),
        ..named(name)
    }
}

#[test]
fn ancestors_give_their_kind_to_their_parts() {
    let inherit = |key: &str, value: &str, parent: &str, name: &str| NewElement {
        inherited: map(&[(key, value)]),
        ..below(parent, name)
    };
    let model = tagged(
        vec![
            inherit("ifc_class", "IfcStair", "Stair", "tread"),
            inherit("ifc_class", "IfcStair", "Stair", "riser"),
            inherit("semantic", "WALL", "Walls", "north"),
            inherit("semantic", "WALL", "Walls", "south"),
            // The mesh of a room, in one piece or in several; its own class goes first.
            inherit("ifc_class", "IfcSpace", "Bath", "mesh"),
            inherit("semantic", "ROOM", "Hall", "Hall_1"),
            inherit("semantic", "ROOM", "Hall", "Hall_2"),
            NewElement { class: Some("IfcDoor".into()), ..inherit("semantic", "WALL", "Walls", "door") },
        ],
        &ImportOptions::default(),
    );
    let tags: Vec<Semantic> = model.elements.iter().map(|e| e.semantic).collect();
    use Semantic::{DoorLeaf, Room, Stair, Wall};
    assert_eq!(tags, [Stair, Stair, Wall, Wall, Room, Room, Room, DoorLeaf]);
    assert_eq!(describe(&model.elements[0], None), "class IfcStair");
    assert_eq!(describe(&model.elements[2], None), "extras.semantic");
    assert!(model.warnings.is_empty());
}

#[test]
fn things_in_a_room_are_no_air() {
    let in_room = |pairs: &[(&str, &str)], name: &str| NewElement {
        inherited: map(pairs),
        ..below("kitchen-room", name)
    };
    let model = tagged(
        vec![
            in_room(&[("semantic", "ROOM")], "Table"),
            in_room(&[("ifc_class", "IfcSpace")], "Chair"),
            // The class that a reader took from the name of the node above.
            NewElement { class: Some("IfcSpace".into()), ..below("IfcSpace:Bath", "Tub") },
            NewElement { class: Some("IfcSpace".into()), ..below("IfcSpace:Bath", "Sink") },
            in_room(&[("ifc_class", "IfcSite")], "IfcWall:a"),
            in_room(&[], "Lamp"),
            in_room(&[], "WALL.001"),
        ],
        &ImportOptions::default(),
    );
    let tags: Vec<Semantic> = model.elements.iter().map(|e| e.semantic).collect();
    use Semantic::{Unknown, Wall};
    assert_eq!(tags, [Unknown, Unknown, Unknown, Unknown, Wall, Unknown, Wall]);
    let texts: Vec<&str> = model.warnings.iter().map(|w| w.text.as_str()).collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(texts[0].starts_with("4 elements without a tag did not take that of the space"), "{}", texts[0]);
    assert!(texts[0].ends_with("(element 'Table' below ROOM)"), "{}", texts[0]);
    assert!(texts[1].starts_with("5 elements without a tag ("), "{}", texts[1]);
}

#[test]
fn doors_by_name_are_air_and_said_to_be() {
    let model =
        tagged(vec![named("Door.001"), named("Door.002"), named("DOOR_LEAF")], &ImportOptions::default());
    let tags: Vec<Semantic> = model.elements.iter().map(|e| e.semantic).collect();
    assert_eq!(tags, [Semantic::Door, Semantic::Door, Semantic::DoorLeaf]);
    assert_eq!(model.warnings.len(), 1);
    assert!(model.warnings[0].text.starts_with("2 elements are the air of doors and windows"));
    // In capitals it is meant.
    let model = tagged(vec![named("DOOR_kitchen_hall"), named("hall-WINDOW.001")], &ImportOptions::default());
    let tags: Vec<Semantic> = model.elements.iter().map(|e| e.semantic).collect();
    assert_eq!(tags, [Semantic::Door, Semantic::Window]);
    assert!(model.warnings.is_empty());
}

#[test]
fn strange_names_do_no_harm() {
    let long = format!("ROOM_{}", "é-".repeat(10_000));
    for name in ["", "/", "//", ":", "ROOM/", "é", "_é_", "é12", "Ⅻ", "#", "IfcSpace", long.as_str()] {
        for parent in ["", "/", "é", "a/b"] {
            let new = NewElement {
                other_names: vec![parent.into(), name.into()],
                path: format!("{parent}/{name}"),
                inherited: map(&[("ifc_class", name), ("semantic", name)]),
                ..named(name)
            };
            tag(&mut model_of(vec![new.clone(), new]), &with_rules("[[rule]]\npath='b'\nsemantic='WALL'"))
                .unwrap();
        }
    }
}

/// Elements that depend on each other, and on names, classes and metadata.
fn any_element() -> impl Strategy<Value = NewElement> {
    let pick = |words: &'static [&'static str]| proptest::sample::select(words).prop_map(str::to_owned);
    let class = proptest::option::of(pick(&[
        "IfcWall",
        "IfcOpeningElement",
        "IfcDoor",
        "IfcWindow",
        "IfcSpace",
        "Odd",
    ]));
    let id = pick(&["a", "b", "c", "d", "e", "f", "g", "h"]);
    let relation =
        || proptest::option::of(proptest::sample::select(&["a", "b", "c", "d"][..]).prop_map(str::to_owned));
    let name = pick(&["ROOM_1", "Cube", "kitchen-room", "Door.001", "IfcSlab/x", ""]);
    let parent = pick(&["Hall", "kitchen-room", "IfcSpace:Bath"]);
    let inherited = proptest::option::of(pick(&["ROOM", "WALL", "odd"]));
    (class, id, relation(), relation(), name, parent, inherited).prop_map(
        |(class, id, filling, opening, name, parent, inherited)| NewElement {
            id,
            class,
            filling,
            opening,
            inherited: inherited.map(|word| ("semantic".to_owned(), word)).into_iter().collect(),
            ..below(&parent, &name)
        },
    )
}

proptest! {
    /// The order of the elements changes no tag.
    #[test]
    fn tags_do_not_depend_on_the_order(
        elements in proptest::collection::vec(any_element(), 1..12),
        seed in any::<u64>(),
    ) {
        let mut elements = elements;
        // Equal ids are told apart by their order, on purpose: keep one of each.
        elements.sort_by(|a, b| a.id.cmp(&b.id));
        elements.dedup_by(|a, b| a.id == b.id);
        let mut shuffled = elements.clone();
        shuffled.sort_by_key(|e| {
            use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
            BuildHasherDefault::<DefaultHasher>::default().hash_one((seed, &e.id))
        });
        let options = with_rules("[[rule]]\nname='Cube'\nfilling='Door'\nsemantic='RAILING'");
        let tags = |elements: Vec<NewElement>| -> BTreeMap<String, (Semantic, TagSource)> {
            let model = tagged(elements, &options);
            model.elements.into_iter().map(|e| (e.id, (e.semantic, e.tagged_by))).collect()
        };
        prop_assert_eq!(tags(elements), tags(shuffled));
    }
}
