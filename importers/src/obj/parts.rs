//! Which faces belong together: parts of a file between its `o` and `g` lines, and the elements that they form.
//!
//! `tobj` takes `o` and `g` for the same and forgets all but the last of them. So the guard keeps this table, and
//! `tobj` sees only the number of a part.
//!
//! Where an `o` line is in force, the object is the element and its groups are other names of it; where none is,
//! the group is the element. An object is split into one element per group only where the groups are plainly the
//! elements: it is the file's only object, or two or more of its groups carry a class or an id while the object
//! carries none.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;

use crate::builder::NewElement;
use crate::limits::{Budget, OverBudget};
use crate::obj::names::{Parts as Name, group_names, split_storey};

/// What an `o` or `g` line gave.
#[derive(Clone, Debug, Default)]
pub(super) struct Named {
    pub(super) text: String,
    pub(super) line: u64,
}

/// Faces, lines and points under one object and one set of groups, without an `o` or `g` line between.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// Index in the table's objects.
    object: Option<usize>,
    /// Index in the table's groups.
    groups: Option<usize>,
    /// The line of the first thing in it.
    line: u64,
    /// Faces that `tobj` was given.
    pub(super) faces: u64,
}

/// An `o` or `g` line in force, and its place in the table once something is under it.
#[derive(Clone, Debug)]
struct InForce {
    named: Named,
    index: Option<usize>,
    /// Vertices read when the last thing was put under it; `None` before.
    vertices: Option<u64>,
    /// The line that gave the same name again, if one did since.
    again: Option<u64>,
}

impl InForce {
    fn new(text: &str, line: u64) -> InForce {
        InForce { named: Named { text: text.to_owned(), line }, index: None, vertices: None, again: None }
    }

    /// Whether a line gives the name in force again. An id says that it is the same thing; else the next face
    /// shows it, by [`InForce::settle`].
    fn is_again(in_force: &mut Option<InForce>, text: &str, line: u64) -> bool {
        match in_force {
            Some(in_force) if in_force.named.text == text => {
                in_force.again = Some(line).filter(|_| Name::of(text).id.is_none());
                true
            }
            _ => false,
        }
    }

    /// Whether the line that gave the name again began another thing. Exporters repeat the line at each change of
    /// material; but two things of one name next to each other each have vertices of their own.
    fn settle(&mut self, vertices: u64) -> bool {
        match self.again.take() {
            Some(line) if self.vertices.is_some_and(|then| then != vertices) => {
                *self = InForce::new(&self.named.text, line);
                true
            }
            _ => false,
        }
    }
}

/// The parts of a file, in its order.
#[derive(Debug, Default)]
pub(super) struct PartTable {
    objects: Vec<Named>,
    groups: Vec<Named>,
    parts: Vec<Part>,
    object: Option<InForce>,
    group: Option<InForce>,
    current: Option<usize>,
    /// Objects that nothing was under, and the first of them.
    unused: u64,
    first_unused: Option<Named>,
}

/// An element to be: what the builder wants to know, and its parts.
#[derive(Debug)]
pub(super) struct Planned {
    pub(super) new: NewElement,
    pub(super) parts: Range<usize>,
}

impl PartTable {
    /// An `o` line.
    pub(super) fn object(&mut self, text: &str, line: u64) {
        if InForce::is_again(&mut self.object, text, line) {
            return;
        }
        let old = self.object.replace(InForce::new(text, line));
        self.note_unused(old);
        // Groups end with their object, but a storey goes on until the next group line.
        if let Some(group) = self.group.take()
            && let (before, Some(_)) = split_storey(&group.named.text)
        {
            let storey = group.named.text[before.len()..].trim_start();
            self.group = Some(InForce::new(storey, group.named.line));
        }
        self.current = None;
    }

    /// A `g` line.
    pub(super) fn groups(&mut self, text: &str, line: u64) {
        if !InForce::is_again(&mut self.group, text, line) {
            self.group = Some(InForce::new(text, line));
            self.current = None;
        }
    }

    /// The part that something at `line` belongs to, after `vertices` vertices.
    pub(super) fn current(
        &mut self,
        line: u64,
        vertices: u64,
        budget: &mut Budget,
    ) -> Result<usize, OverBudget> {
        for in_force in [&mut self.object, &mut self.group].into_iter().flatten() {
            if in_force.settle(vertices) {
                self.current = None;
            }
        }
        let part = match self.current {
            Some(part) => part,
            None => {
                let mut enter = |in_force: &mut Option<InForce>, table: &mut Vec<Named>| {
                    let Some(named) = in_force else { return Ok(None) };
                    if named.index.is_none() {
                        // The name here, and in the element as name, id, path.
                        budget.take(256 + 5 * named.named.text.len() as u64, "names")?;
                        named.index = Some(table.len());
                        table.push(named.named.clone());
                    }
                    Ok(named.index)
                };
                let object = enter(&mut self.object, &mut self.objects)?;
                let groups = enter(&mut self.group, &mut self.groups)?;
                budget.take(256, "parts")?;
                self.parts.push(Part { object, groups, line, faces: 0 });
                self.current = Some(self.parts.len() - 1);
                self.parts.len() - 1
            }
        };
        for in_force in [&mut self.object, &mut self.group].into_iter().flatten() {
            in_force.vertices = Some(vertices);
        }
        Ok(part)
    }

    pub(super) fn part_mut(&mut self, part: usize) -> &mut Part {
        &mut self.parts[part]
    }

    /// The name in force, for errors.
    pub(super) fn name_in_force(&self) -> Option<&str> {
        let named = |n: &InForce| !n.named.text.is_empty();
        let name = self.object.as_ref().filter(|n| named(n)).or(self.group.as_ref().filter(|n| named(n)));
        name.map(|n| n.named.text.as_str())
    }

    /// The name of a part's object or group, for errors.
    pub(super) fn name_of(&self, part: usize) -> Option<&str> {
        let part = &self.parts[part];
        let object = part.object.map(|o| &self.objects[o].text);
        object.or(part.groups.map(|g| &self.groups[g].text)).map(String::as_str).filter(|n| !n.is_empty())
    }

    /// After the end: how many objects nothing was under, and the first of them.
    pub(super) fn unused(&mut self) -> (u64, Option<&Named>) {
        let last = self.object.take();
        self.note_unused(last);
        (self.unused, self.first_unused.as_ref())
    }

    fn note_unused(&mut self, old: Option<InForce>) {
        if let Some(old) = old
            && old.index.is_none()
            && !old.named.text.is_empty()
        {
            self.unused += 1;
            self.first_unused.get_or_insert(old.named);
        }
    }

    /// The elements, in the order of the file. Every part is in one of them.
    pub(super) fn elements(&self) -> Vec<Planned> {
        let split = self.objects_to_split();
        let mut planned: Vec<Planned> = Vec::new();
        let mut last_key = None;
        let mut paths: HashMap<String, u32> = HashMap::new();
        for (index, part) in self.parts.iter().enumerate() {
            let by_group = part.object.is_none_or(|o| split[o]);
            let key = (part.object, part.groups.filter(|_| by_group));
            match planned.last_mut() {
                Some(last) if last_key == Some(key) => {
                    last.parts.end = index + 1;
                    if !by_group {
                        self.add_groups(&mut last.new, part);
                    }
                }
                _ => {
                    let mut new = self.describe(part, by_group);
                    number_path(&mut new.path, &mut paths);
                    planned.push(Planned { new, parts: index..index + 1 });
                    last_key = Some(key);
                }
            }
        }
        planned
    }

    /// For each object, whether its groups are the elements.
    fn objects_to_split(&self) -> Vec<bool> {
        let mut names: Vec<BTreeSet<&str>> = vec![BTreeSet::new(); self.objects.len()];
        let mut only_one = self.objects.len() == 1;
        for part in self.parts.iter().filter(|p| p.faces > 0) {
            let groups = part.groups.map_or("", |g| split_storey(&self.groups[g].text).0);
            match part.object {
                Some(object) if !groups.is_empty() => {
                    names[object].insert(groups);
                }
                Some(_) => {}
                None => only_one = false,
            }
        }
        let split = |(object, groups): (&Named, &BTreeSet<&str>)| {
            let tagged = groups.iter().filter(|g| Name::of(g).is_tagged()).count();
            !Name::of(&object.text).is_tagged() && groups.len() >= 2 && (only_one || tagged >= 2)
        };
        self.objects.iter().zip(&names).map(split).collect()
    }

    /// The element that starts with `part`.
    fn describe(&self, part: &Part, by_group: bool) -> NewElement {
        let object = part.object.map(|o| &self.objects[o]);
        let groups = part.groups.map(|g| &self.groups[g]);
        let mut new = NewElement::default();
        let (full, line) = match (by_group, object, groups) {
            (false, Some(object), _) => (object.text.as_str(), object.line),
            (_, object, Some(groups)) => {
                let (before, _) = split_storey(&groups.text);
                // A group line that names nothing but a storey is that object's, or an element of that name.
                match (before.is_empty(), object) {
                    (true, Some(object)) => (object.text.as_str(), object.line),
                    (true, None) => (groups.text.as_str(), groups.line),
                    (false, _) => (before, groups.line),
                }
            }
            (_, Some(object), None) => (object.text.as_str(), object.line),
            (_, None, None) => ("", part.line),
        };
        let name = Name::of(full);
        new.source_name = full.to_owned();
        new.name = name.name.to_owned();
        new.id = name.id.unwrap_or_default().to_owned();
        new.class = name.class.map(str::to_owned);
        new.place = format!("line {line}");
        let own = if name.without_id.is_empty() { "unnamed" } else { name.without_id };
        new.path = match object {
            Some(object) if by_group && object.text != full && !object.text.is_empty() => {
                format!("{}/{own}", Name::of(&object.text).without_id)
            }
            _ => own.to_owned(),
        };
        if by_group {
            let words = group_names(full);
            if words.len() > 1 {
                new.other_names.extend(words.into_iter().map(str::to_owned));
            }
            new.other_names
                .extend(object.filter(|o| !o.text.is_empty() && o.text != full).map(|o| o.text.clone()));
        }
        self.add_groups(&mut new, part);
        new
    }

    /// Adds what a part's groups say of its element: other names, the storey, a class if the name has none.
    fn add_groups(&self, new: &mut NewElement, part: &Part) {
        let Some(groups) = part.groups else { return };
        let (before, storey) = split_storey(&self.groups[groups].text);
        if new.storey.is_none() {
            new.storey = storey.map(str::to_owned);
        }
        for name in group_names(before) {
            // Few groups have an element; one that has very many is not worth a table.
            let known = new.source_name == name || new.other_names.iter().rev().take(64).any(|n| n == name);
            if !known {
                new.other_names.push(name.to_owned());
            }
            if new.class.is_none() {
                new.class = Name::of(name).class.map(str::to_owned);
            }
        }
    }
}

/// Gives the second element of one path the number `[2]`, and so on.
fn number_path(path: &mut String, taken: &mut HashMap<String, u32>) {
    let count = taken.entry(path.clone()).or_insert(0);
    *count += 1;
    if *count > 1 {
        path.push_str(&format!("[{count}]"));
    }
}
