//! Rules files: parsed, and tried on a model with names of many kinds.

use enfilade::importers::tagging::{self, Rules};
use enfilade::importers::{Frame, ImportErrorKind, Material, Model, ModelBuilder, NewElement, TagSource};

use crate::{FILE, model, options};

/// Parses `input`, and tags a model by the rules if there are any.
pub fn check(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    match Rules::parse(text, FILE) {
        Err(error) => {
            model::check_error(&error);
            assert!(matches!(error.kind, ImportErrorKind::Rules(_)), "{error:?}");
            if let Some(line) = error.place.strip_prefix("line ") {
                let line: usize = line.parse().expect("a line is a number");
                assert!(line >= 1 && line <= text.matches('\n').count() + 1, "{error}");
            }
        }
        Ok(rules) if !rules.is_empty() => apply(rules),
        Ok(_) => {}
    }
}

fn apply(rules: Rules) {
    let count = rules.len();
    let mut tagged = named_model();
    let mut options = options();
    options.rules = Some(rules);
    if let Err(error) = tagging::tag(&mut tagged, &options) {
        panic!("no element without a tag is an error here: {error}");
    }
    for element in &tagged.elements {
        if let TagSource::UserRule(number) = element.tagged_by {
            assert!((1..=count).contains(&(number as usize)));
        }
        assert!(!tagging::describe(element, options.rules.as_ref()).is_empty());
    }
}

/// A triangle each for names as exporters write them, and others.
fn named_model() -> Model {
    const NAMES: [&str; 12] = [
        "",
        "Wall",
        "IfcWall:W1",
        "ROOM_kitchen",
        "kitchen-room",
        "Tür 1",
        "Fläche.001",
        "a/b c",
        "\u{1F3E0}",
        "窓",
        "Glas\u{0301}s",
        "-",
    ];
    let mut builder = ModelBuilder::new("named", Frame::default());
    let glass = builder.material(Material { name: "Glass".to_owned(), ..Material::default() });
    for name in NAMES {
        let new = NewElement {
            name: name.to_owned(),
            other_names: vec![format!("{name} mesh"), "group".to_owned()],
            path: format!("Site/trees/{name}"),
            class: name.contains('W').then(|| "IfcWall".to_owned()),
            storey: Some("Level 3".to_owned()),
            extras: [("predefined_type".to_owned(), "FLOOR".to_owned())].into(),
            ..NewElement::default()
        };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        builder
            .element(new)
            .and_then(|element| builder.triangle(element, corners, glass))
            .expect("the model is within all limits");
    }
    builder.finish().expect("the model has triangles")
}
