//! `docs/TAGGING.md` tells the truth: its rules parse and work, its tables hold.
#![cfg(feature = "rules")]

use enfilade_importers::tagging::{Rules, tag};
use enfilade_importers::{
    Element, Frame, ImportOptions, Material, ModelBuilder, NewElement, Role, Semantic, TagSource,
};

fn page() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/TAGGING.md");
    std::fs::read_to_string(path).unwrap()
}

/// The page's examples of rules.
fn examples() -> Vec<String> {
    let page = page();
    let mut blocks: Vec<String> = page.split("```toml\n").skip(1).map(str::to_owned).collect();
    for block in &mut blocks {
        block.truncate(block.find("```").unwrap());
    }
    assert_eq!(blocks.len(), 2);
    blocks
}

/// The cells of the table's rows whose head begins so.
fn tables(head: &str) -> Vec<Vec<String>> {
    let page = page();
    let rows: Vec<Vec<String>> = page
        .split("\n\n")
        .filter(|part| part.starts_with(head))
        .flat_map(|table| table.lines().skip(2))
        .map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().replace('`', "")).collect())
        .collect();
    assert!(!rows.is_empty());
    rows
}

fn tagged(new: NewElement, material: &str, options: &ImportOptions) -> Element {
    let mut builder = ModelBuilder::new("test", Frame::default());
    let material = builder.material(Material { name: material.into(), ..Material::default() });
    let element = builder.element(new).unwrap();
    builder.triangle(element, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material).unwrap();
    let mut model = builder.finish().unwrap();
    tag(&mut model, options).unwrap();
    model.elements.remove(0)
}

fn named(name: &str) -> NewElement {
    NewElement { name: name.into(), ..NewElement::default() }
}

#[test]
fn example_rules_do_what_they_say() {
    let rules = Rules::parse(&examples().concat(), "TAGGING.md").unwrap();
    assert_eq!(rules.len(), 9);
    let mut options = ImportOptions::default();
    options.rules = Some(rules);
    let extras = |key: &str, value: &str| [(key.to_owned(), value.to_owned())].into_iter().collect();
    let elements = [
        (NewElement { storey: Some("Level 3".into()), ..named("Roof Terrace") }, "", 1, "EXTERIOR"),
        (
            NewElement {
                class: Some("IfcBuildingElementProxy".into()),
                extras: extras("object_type", "Steel Column"),
                ..named("x")
            },
            "",
            2,
            "COLUMN",
        ),
        (named("x"), "Glas klar", 3, "GLASS"),
        (NewElement { path: "Site/trees/oak".into(), ..named("oak") }, "", 4, "SITE"),
        (NewElement { id: "2OrWItJ6zAwBNp0OUxK_l8".into(), ..named("x") }, "", 5, "ROOF"),
        (named("Door.003"), "", 6, "DOOR_LEAF"),
        (NewElement { extras: extras("Pset.Usage", "storage"), ..named("x") }, "", 8, "ROOM"),
        (NewElement { class: Some("IfcProxy".into()), ..named("Envelope") }, "", 9, "ANNOTATION"),
    ];
    for (new, material, number, word) in elements {
        let element = tagged(new, material, &options);
        assert_eq!((element.semantic.name(), element.tagged_by), (word, TagSource::UserRule(number)));
    }
}

#[test]
fn an_example_needs_a_filling() {
    let mut options = ImportOptions::default();
    options.rules = Some(Rules::parse(&examples().concat(), "TAGGING.md").unwrap());
    let mut builder = ModelBuilder::new("test", Frame::default());
    let material = builder.material(Material::default());
    for (id, class, filling) in
        [("o", "Opening", Some("d")), ("d", "FireDoor T30", None), ("p", "Opening", None)]
    {
        let new = NewElement {
            id: id.into(),
            class: Some(class.into()),
            filling: filling.map(str::to_owned),
            ..NewElement::default()
        };
        let element = builder.element(new).unwrap();
        builder.triangle(element, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], material).unwrap();
    }
    let mut model = builder.finish().unwrap();
    tag(&mut model, &options).unwrap();
    assert_eq!(model.elements[0].tagged_by, TagSource::UserRule(7));
    assert_eq!(model.elements[2].semantic, Semantic::Unknown);
}

#[test]
fn all_words_are_listed_with_their_roles() {
    let rows = tables("| Word | Role |");
    let words: Vec<&str> = rows.iter().map(|row| row[0].as_str()).collect();
    let all: Vec<&str> = Semantic::all()
        .filter(|s| !matches!(s, Semantic::Unknown | Semantic::Void))
        .map(Semantic::name)
        .collect();
    assert_eq!(words, all);
    for row in &rows {
        let semantic: Semantic = row[0].parse().unwrap();
        assert_eq!(semantic.role().map(Role::name), Some(row[1].as_str()), "{}", row[0]);
        for also in row[3].split(", ").filter(|word| !word.is_empty()) {
            assert_eq!(also.parse(), Ok(semantic), "{also}");
        }
    }
}

#[test]
fn example_names_mean_what_the_page_says() {
    let rows = tables("| Name | Tag |");
    assert_eq!(rows.len(), 19);
    for row in rows {
        let element = tagged(named(&row[0]), "", &ImportOptions::default());
        let expected = if row[1] == "none" { "UNKNOWN" } else { &row[1] };
        assert_eq!(element.semantic.name(), expected, "{}", row[0]);
    }
}

#[test]
fn every_key_of_rules_is_listed() {
    // The parser's own list, from its error.
    let error = Rules::parse("[[rule]]\nx = 'y'", "a.toml").unwrap_err().to_string();
    let known: Vec<&str> = error.split('`').skip(3).step_by(2).collect();
    let listed: Vec<String> = tables("| Key | Looks at |").into_iter().map(|row| row[0].clone()).collect();
    assert_eq!(known.len(), listed.len() + 1, "{error}");
    for key in known {
        let is_listed = listed.iter().any(|l| l == key || (key == "extras" && l == "extras.KEY"));
        assert!(is_listed || key == "semantic", "{key}");
    }
}
