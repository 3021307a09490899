//! What an object's or a group's name says: class, name, identity, storey.

/// A full name in its parts: `Class:name#id`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parts<'a> {
    /// What is before the first `:`, where that looks like an identifier.
    pub(super) class: Option<&'a str>,
    /// Without class and id.
    pub(super) name: &'a str,
    /// What is after the last `#`.
    pub(super) id: Option<&'a str>,
    /// With the class, without the id.
    pub(super) without_id: &'a str,
}

impl<'a> Parts<'a> {
    pub(super) fn of(full: &'a str) -> Parts<'a> {
        let (without_id, id) = match full.rsplit_once('#') {
            Some((rest, id)) if !id.is_empty() && !id.contains(char::is_whitespace) => {
                (rest.trim_end(), Some(id))
            }
            _ => (full, None),
        };
        let (class, name) = match without_id.split_once(':') {
            Some((class, name)) if is_identifier(class) => (Some(class), name.trim_start()),
            _ => (None, without_id),
        };
        Parts { class, name, id, without_id }
    }

    /// Whether the name is that of one tagged element, and not of a layer or a part.
    pub(super) fn is_tagged(&self) -> bool {
        self.class.is_some() || self.id.is_some()
    }
}

/// A letter, then letters, digits and underscores.
fn is_identifier(word: &str) -> bool {
    word.starts_with(|c: char| c.is_ascii_alphabetic())
        && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

/// Takes the storey off a `g` line's text: from a word that starts with `Storey:` or `IfcBuildingStorey:` to the
/// end of the line, as names of storeys have blanks. Gives what is before it, and the storey's name.
pub(super) fn split_storey(groups: &str) -> (&str, Option<&str>) {
    let starts_word = |start: &usize| groups[..*start].chars().next_back().is_none_or(char::is_whitespace);
    let found = ["Storey:", "IfcBuildingStorey:"].into_iter().filter_map(|prefix| {
        let start = groups.match_indices(prefix).map(|(start, _)| start).find(starts_word)?;
        Some((start, start + prefix.len()))
    });
    if let Some((start, end)) = found.min() {
        let storey = Parts::of(groups[end..].trim()).without_id;
        return (groups[..start].trim_end(), Some(storey).filter(|s| !s.is_empty()));
    }
    (groups, None)
}

/// The names of a `g` line: one if it is tagged as a whole (class or id: such names have blanks), else its words.
pub(super) fn group_names(groups: &str) -> Vec<&str> {
    if Parts::of(groups).is_tagged() { vec![groups] } else { groups.split_whitespace().collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn class_name_and_id_are_split() {
        let of = |full| {
            let p = Parts::of(full);
            (p.class, p.name, p.id, p.without_id)
        };
        assert_eq!(
            of("IfcWall:Basic Wall:a#2O2Fr$t4X7Zf8NOew3FLOH"),
            (Some("IfcWall"), "Basic Wall:a", Some("2O2Fr$t4X7Zf8NOew3FLOH"), "IfcWall:Basic Wall:a")
        );
        assert_eq!(of("IfcWall:"), (Some("IfcWall"), "", None, "IfcWall:"));
        assert_eq!(of("Basic Wall:7"), (None, "Basic Wall:7", None, "Basic Wall:7"));
        assert_eq!(of("a#b#c"), (None, "a#b", Some("c"), "a#b"));
        assert_eq!(of("a#"), (None, "a#", None, "a#"));
        assert_eq!(of("note # two words"), (None, "note # two words", None, "note # two words"));
        assert_eq!(of("#x"), (None, "", Some("x"), ""));
        assert_eq!(of("Küche#ö"), (None, "Küche", Some("ö"), "Küche"));
        assert_eq!(of("3D:x"), (None, "3D:x", None, "3D:x"));
        assert_eq!(of(""), (None, "", None, ""));
    }

    #[test]
    fn storeys_are_taken_off_group_lines() {
        assert_eq!(split_storey("Storey:Level 1"), ("", Some("Level 1")));
        assert_eq!(split_storey("wall IfcBuildingStorey:EG#id"), ("wall", Some("EG")));
        assert_eq!(split_storey("wall Storey:"), ("wall", None));
        assert_eq!(split_storey("MyStorey:1 b"), ("MyStorey:1 b", None));
        assert_eq!(split_storey(""), ("", None));
    }

    #[test]
    fn tagged_group_lines_are_one_name() {
        assert_eq!(group_names("Mesh1 Group1 Model"), ["Mesh1", "Group1", "Model"]);
        assert_eq!(group_names("IfcWall:Basic Wall"), ["IfcWall:Basic Wall"]);
        assert!(group_names("").is_empty());
    }
}
