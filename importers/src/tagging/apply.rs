//! Which rule of a set matches an element.

use std::cell::OnceCell;
use std::collections::HashMap;

use super::matcher::Matcher;
use super::rules::{Key, Rule, Rules};
use crate::model::{Element, MaterialId, Model};
use crate::semantic::Semantic;

/// Classes whose rules are remembered at once; bounds the memory of models where every element has its own.
const REMEMBERED: usize = 4096;

/// A set of rules, ready for many elements. What depends on the class alone is found once per class.
pub(super) struct RuleFinder<'r> {
    rules: &'r [Rule],
    /// Rules for plain class names, by the name in lower case.
    by_name: HashMap<String, Vec<u32>>,
    /// Rules whose class is an expression.
    by_pattern: Vec<u32>,
    /// Rules that ask for no class.
    classless: Vec<u32>,
    remembered: HashMap<String, Vec<u32>>,
}

/// An element and what rules may ask about it.
pub(super) struct Subject<'m> {
    model: &'m Model,
    pub element: &'m Element,
    /// Classes of the elements that fill this opening.
    fillings: &'m [&'m str],
    materials: OnceCell<Vec<&'m str>>,
}

impl<'r> RuleFinder<'r> {
    pub fn new(rules: &'r Rules) -> RuleFinder<'r> {
        let mut finder = RuleFinder {
            rules: &rules.rules,
            by_name: HashMap::new(),
            by_pattern: Vec::new(),
            classless: Vec::new(),
            remembered: HashMap::new(),
        };
        for (index, rule) in rules.rules.iter().enumerate() {
            let index = index as u32;
            match &rule.class {
                None => finder.classless.push(index),
                Some(Matcher::Pattern(_)) => finder.by_pattern.push(index),
                Some(Matcher::Names { names, .. }) => {
                    for name in names {
                        let rules = finder.by_name.entry(name.to_ascii_lowercase()).or_default();
                        if rules.last() != Some(&index) {
                            rules.push(index);
                        }
                    }
                }
            }
        }
        finder
    }

    /// The first rule that matches `subject` as an element of `class`: its number from 1, and its meaning.
    pub fn find(&mut self, subject: &Subject<'_>, class: Option<&str>) -> Option<(u32, Semantic)> {
        if let Some(class) = class {
            self.remember(class);
        }
        let classed = class.and_then(|c| self.remembered.get(c)).map_or(&[][..], Vec::as_slice);
        // Both lists rise: the smaller head is the next rule of the file.
        let (mut a, mut b) = (classed.iter().peekable(), self.classless.iter().peekable());
        loop {
            let next = match (a.peek(), b.peek()) {
                (Some(x), Some(y)) if x < y => a.next(),
                (_, Some(_)) => b.next(),
                (_, None) => a.next(),
            };
            let index = *next?;
            let rule = &self.rules[index as usize];
            if rule.others.iter().all(|(key, matcher)| subject.meets(key, matcher)) {
                return Some((index + 1, rule.semantic));
            }
        }
    }

    /// Finds the rules whose condition on the class holds for `class`, unless they are known.
    fn remember(&mut self, class: &str) {
        if self.remembered.contains_key(class) {
            return;
        }
        if self.remembered.len() >= REMEMBERED {
            self.remembered.clear();
        }
        let matches = |&&index: &&u32| {
            self.rules[index as usize].class.as_ref().is_some_and(|matcher| matcher.is_match(class))
        };
        let named = self.by_name.get(&class.to_ascii_lowercase()).map_or(&[][..], Vec::as_slice);
        let mut found: Vec<u32> =
            named.iter().filter(matches).chain(self.by_pattern.iter().filter(matches)).copied().collect();
        found.sort_unstable();
        self.remembered.insert(class.to_owned(), found);
    }
}

impl<'m> Subject<'m> {
    pub fn new(model: &'m Model, element: &'m Element, fillings: &'m [&'m str]) -> Subject<'m> {
        Subject { model, element, fillings, materials: OnceCell::new() }
    }

    fn meets(&self, key: &Key, matcher: &Matcher) -> bool {
        let element = self.element;
        let is_match = |text: &String| matcher.is_match(text);
        match key {
            Key::Name => is_match(&element.name) || is_match(&element.source_name),
            Key::OtherName => element.other_names.iter().any(is_match),
            Key::Material => self.materials().iter().any(|name| matcher.is_match(name)),
            Key::Filling => self.fillings.iter().any(|class| matcher.is_match(class)),
            Key::Path => is_match(&element.path),
            Key::Storey => element.storey.as_ref().is_some_and(is_match),
            Key::Id => is_match(&element.id),
            Key::Extras(name) => {
                element.extras.get(name).or_else(|| element.inherited.get(name)).is_some_and(is_match)
            }
        }
    }

    /// The names of the materials on the element's triangles, each material once.
    fn materials(&self) -> &[&'m str] {
        self.materials.get_or_init(|| {
            let mut ids: Vec<MaterialId> = self.element.mesh.materials.clone();
            ids.dedup();
            ids.sort_unstable();
            ids.dedup();
            ids.iter()
                .filter_map(|id| self.model.materials.get(id.0 as usize))
                .map(|m| m.name.as_str())
                .collect()
        })
    }
}
