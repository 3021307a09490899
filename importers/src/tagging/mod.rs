//! Tagging: from names, classes and metadata to meanings.
//!
//! [`tag`] gives every element of a model its [`Semantic`]. It asks, in this order, and the first answer counts:
//!
//! 1. the user's [`Rules`] ([`ImportOptions::rules`]);
//! 2. `extras.semantic`;
//! 3. the class (`extras.ifc_class`, or before the `:` in a name), by the shipped table ([`Rules::shipped`]);
//! 4. a semantic word in the name: `ROOM_kitchen`, `kitchen-room`, `WALL.001`.
//!
//! What stays without a tag falls to [`ImportOptions::untagged`]. `docs/TAGGING.md` explains all this to a modeller.

mod apply;
mod kin;
mod matcher;
mod rules;
mod words;

pub use rules::Rules;

use crate::error::{ImportError, ImportErrorKind};
use crate::import::ImportOptions;
use crate::model::{Element, Model, TagSource, Warning};
use crate::semantic::{Semantic, Untagged};
use apply::{RuleFinder, Subject};
use kin::Kin;

/// How many elements a message names.
const EXAMPLES: usize = 5;

/// Elements between two looks at the cancel token.
const STRIDE: usize = 1024;

/// Tags every element of `model`, save those that the program tagged ([`TagSource::Program`]). Elements that were
/// tagged before are tagged anew. Where a class of an ancestor or in a name decides, it becomes the element's
/// [`Element::class`]. What is odd goes to [`Model::warnings`], one warning for each kind.
///
/// # Errors
/// [`ImportErrorKind::Untagged`] if elements have no tag and the options make that an error;
/// [`ImportErrorKind::Cancelled`].
pub fn tag(model: &mut Model, options: &ImportOptions) -> Result<(), ImportError> {
    let shipped = Rules::shipped();
    let (tags, notes) = {
        let mut tagger = Tagger {
            user: options.rules.as_ref().map(RuleFinder::new),
            shipped: RuleFinder::new(&shipped),
            kin: Kin::new(model),
            notes: Notes::default(),
        };
        let mut tags = Vec::with_capacity(model.elements.len());
        for (index, element) in model.elements.iter().enumerate() {
            if index % STRIDE == 0 {
                options.watch.check().map_err(|e| ImportError::new(model.source.clone(), e))?;
            }
            tags.push(tagger.tag(model, element));
        }
        (tags, tagger.notes)
    };
    for (element, tag) in model.elements.iter_mut().zip(tags) {
        if let Some(tag) = tag {
            element.semantic = tag.semantic;
            element.tagged_by = tag.by;
            if let Some(class) = tag.class {
                element.class = Some(class);
            }
        }
    }
    notes.report(model);
    report_untagged(model, options.untagged)
}

/// How `element` got its meaning, in words for reports: `rule 3 of rules.toml`, `extras.semantic`, `class IfcWall`.
/// `rules` are those that [`ImportOptions::rules`] held, for their file's name.
pub fn describe(element: &Element, rules: Option<&Rules>) -> String {
    match element.tagged_by {
        TagSource::None => "no tag".to_owned(),
        TagSource::UserRule(number) => match rules.map(Rules::source) {
            Some(source) if !source.is_empty() => format!("rule {number} of {source}"),
            _ => format!("rule {number}"),
        },
        TagSource::Extras => "extras.semantic".to_owned(),
        TagSource::Class(number) => match &element.class {
            Some(class) => format!("class {class}"),
            None => format!("class, by rule {number} of the shipped table"),
        },
        TagSource::Name => "name".to_owned(),
        TagSource::Program => "program".to_owned(),
        TagSource::Derived => "found in the building".to_owned(),
    }
}

/// What was found for one element.
struct Tag {
    semantic: Semantic,
    by: TagSource,
    /// The class that decided, where it is not the element's own.
    class: Option<String>,
}

struct Tagger<'m, 'r> {
    user: Option<RuleFinder<'r>>,
    shipped: RuleFinder<'r>,
    kin: Kin<'m>,
    notes: Notes,
}

impl<'m> Tagger<'m, '_> {
    /// `None` for an element that the program tagged.
    fn tag(&mut self, model: &'m Model, element: &'m Element) -> Option<Tag> {
        if matches!(element.tagged_by, TagSource::Program | TagSource::Derived) {
            return None;
        }
        let found = |semantic, by| Some(Tag { semantic, by, class: None });
        let fillings = self.kin.fillings(element).to_vec();
        let subject = Subject::new(model, element, &fillings);
        if let Some(user) = &mut self.user
            && let Some((number, semantic)) = user.find(&subject, self.kin.class(element))
        {
            return found(semantic, TagSource::UserRule(number));
        }
        if let Some(semantic) = self.own_semantic(element) {
            return found(semantic, TagSource::Extras);
        }
        // What the element says of itself goes before what its ancestors say.
        let own_class = self.kin.own_class(element);
        if let Some((number, semantic)) = own_class.and_then(|class| self.shipped.find(&subject, Some(class)))
        {
            return found(semantic, TagSource::Class(number));
        }
        if let Some(semantic) = self.kin.inherited_semantic(element) {
            return found(semantic, TagSource::Extras);
        }
        for class in self.kin.classes(element).filter(|&class| Some(class) != own_class) {
            if let Some((number, semantic)) = self.shipped.find(&subject, Some(class)) {
                let class = Some(class.to_owned());
                return Some(Tag { semantic, by: TagSource::Class(number), class });
            }
        }
        if let Some(semantic) = self.kin.semantic_in_names(element) {
            // In capitals it is a tag, and meant; `Door.001` may well be a leaf.
            let is_meant = std::iter::once(&element.source_name)
                .chain(&element.other_names)
                .any(|name| name.contains(semantic.name()));
            if matches!(semantic, Semantic::Door | Semantic::Window) && !is_meant {
                self.notes.named_as_air.add(element, semantic.name());
            }
            return found(semantic, TagSource::Name);
        }
        if let Some(holder) = self.kin.holder(element) {
            self.notes.in_holder.add(element, holder);
        }
        found(Semantic::Unknown, TagSource::None)
    }

    /// The meaning by the element's own `extras.semantic`. One that is no word is noted, and says nothing.
    fn own_semantic(&mut self, element: &Element) -> Option<Semantic> {
        let word = element.extras.get("semantic").filter(|word| !word.trim().is_empty())?;
        match word.parse() {
            Ok(semantic) => Some(semantic),
            Err(_) => {
                self.notes.bad_words.add(element, word);
                None
            }
        }
    }
}

/// Odd things seen on the way, each kind counted.
#[derive(Default)]
struct Notes {
    bad_words: Note,
    in_holder: Note,
    named_as_air: Note,
}

/// How often something was seen, and where first.
#[derive(Default)]
struct Note {
    count: u64,
    example: Option<(String, String, String)>,
}

impl Note {
    fn add(&mut self, element: &Element, detail: &str) {
        self.count += 1;
        self.example.get_or_insert_with(|| {
            (element.place.clone(), shown_name(element).to_owned(), shortened(detail))
        });
    }

    /// A warning whose text `text` makes of the count, the element's name and the detail.
    fn report(self, model: &mut Model, text: impl FnOnce(u64, &str, &str) -> String) {
        if let Some((place, name, detail)) = self.example {
            model.warnings.push(Warning { place, text: text(self.count, &name, &detail) });
        }
    }
}

impl Notes {
    fn report(self, model: &mut Model) {
        self.bad_words.report(model, |count, name, word| {
            format!(
                "extras.semantic of {} is no semantic word and was passed over (element '{name}': '{word}')",
                elements(count)
            )
        });
        self.in_holder.report(model, |count, name, word| {
            format!(
                "{} without a tag did not take that of the space or site above, as other things may lie in one \
                 (element '{name}' below {word})",
                elements(count)
            )
        });
        self.named_as_air.report(model, |count, name, word| {
            format!(
                "{} are the air of doors and windows, which rays do not see, by a word in their names (element \
                 '{name}': {word}); leaves and frames are DOOR_LEAF and WINDOW_FRAME",
                elements(count)
            )
        });
    }
}

/// Counts what has no tag: a warning, or an error if `untagged` says so.
fn report_untagged(model: &mut Model, untagged: Untagged) -> Result<(), ImportError> {
    let without_tag = || model.elements.iter().filter(|e| e.semantic == Semantic::Unknown);
    let Some(first) = without_tag().next() else { return Ok(()) };
    let count = without_tag().count();
    let mut examples: Vec<String> =
        without_tag().take(EXAMPLES).map(|e| format!("'{}'", shown_name(e))).collect();
    if count > EXAMPLES {
        examples.push("...".to_owned());
    }
    let place = first.place.clone();
    let text = format!("{} without a tag ({})", elements(count as u64), examples.join(", "));
    let becomes = match untagged {
        Untagged::Error => {
            let name = shown_name(first);
            return Err(ImportError::new(model.source.clone(), ImportErrorKind::Untagged(text))
                .at(place)
                .of_element(name));
        }
        Untagged::ByMesh => "solid where the mesh is closed, detail elsewhere",
        Untagged::Solid => "solid",
        Untagged::Detail => "detail",
    };
    model.warnings.push(Warning { place, text: format!("{text}: {becomes}") });
    Ok(())
}

fn elements(count: u64) -> String {
    if count == 1 { "1 element".to_owned() } else { format!("{count} elements") }
}

/// The name by which a user finds the element.
fn shown_name(element: &Element) -> String {
    shortened(if element.source_name.is_empty() { &element.id } else { &element.source_name })
}

/// The beginning of a text that the source made.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 80;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
