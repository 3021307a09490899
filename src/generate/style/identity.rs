//! What elements are called in a file, and which are left out.

use std::collections::BTreeMap;

use super::super::building::{Building, Kind};
use super::Style;
use super::dice::Dice;

/// What a file says of an element besides its mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The class.
    pub class: String,
    /// The name; empty if it has none.
    pub name: String,
    /// The identity, which another element may have too.
    pub id: String,
    /// Metadata, class, name and identity among them.
    pub metadata: BTreeMap<String, String>,
}

impl Label {
    /// What the node is called: `IfcClass:Name`, or `IfcClass:identity` without a name.
    pub fn node_name(&self) -> String {
        format!("{}:{}", self.class, if self.name.is_empty() { &self.id } else { &self.name })
    }

    /// What the object of an OBJ file is called, without its identity.
    pub fn object_name(&self) -> String {
        format!("{}:{}", self.class, self.name)
    }
}

/// The labels of a building's elements in their order; `None` for those that are left out.
pub fn labels(building: &Building, style: &Style, dice: &Dice) -> Vec<Option<Label>> {
    let elements = &building.elements;
    let is_kept: Vec<bool> = elements
        .iter()
        .map(|element| {
            let (share, option) = match element.kind {
                Kind::Opening => (style.openings_missing, "openings-missing"),
                Kind::Room => (style.rooms_missing, "rooms-missing"),
                _ => return true,
            };
            !dice.hits(share, option, &element.global_id)
        })
        .collect();
    let ids: Vec<&str> = elements
        .iter()
        .enumerate()
        .map(|(index, element)| {
            let own = element.global_id.as_str();
            if index == 0 || !dice.hits(style.doubled_ids, "doubled-ids", own) {
                return own;
            }
            &elements[dice.draw("whose id", own).below(index)].global_id
        })
        .collect();
    let mut first_names: BTreeMap<&str, &str> = BTreeMap::new();
    for element in elements {
        first_names.entry(&element.class).or_insert(&element.name);
    }
    let label = |(index, element): (usize, &super::super::building::Element)| {
        let own = element.global_id.as_str();
        let mut metadata = building.metadata(element);
        let name = if dice.hits(style.nameless, "nameless", own) {
            ""
        } else if dice.hits(style.doubled_names, "doubled-names", own) {
            first_names[element.class.as_str()]
        } else {
            &element.name
        };
        metadata.insert("name".to_owned(), name.to_owned());
        metadata.insert("global_id".to_owned(), ids[index].to_owned());
        let links =
            [("host_id", element.host), ("filling_id", element.filling), ("opening_id", element.opening)];
        for (key, link) in links {
            let Some(other) = link.map(|other| other as usize).filter(|&other| other < elements.len()) else {
                continue;
            };
            if is_kept[other] {
                metadata.insert(key.to_owned(), ids[other].to_owned());
            } else {
                metadata.remove(key);
            }
        }
        is_kept[index].then(|| Label {
            class: element.class.clone(),
            name: name.to_owned(),
            id: ids[index].to_owned(),
            metadata,
        })
    };
    elements.iter().enumerate().map(label).collect()
}

#[cfg(test)]
mod tests {
    use super::super::super::{HouseOptions, house};
    use super::*;

    fn labels_of(change: impl Fn(&mut Style)) -> Vec<Option<Label>> {
        let mut style = Style::exact();
        change(&mut style);
        labels(&house(&HouseOptions::default()), &style, &Dice::new(style.seed))
    }

    #[test]
    fn exact_labels_are_the_buildings_own() {
        let building = house(&HouseOptions::default());
        for (label, element) in labels_of(|_| ()).into_iter().zip(&building.elements) {
            let label = label.unwrap();
            assert_eq!(label.metadata, building.metadata(element));
            assert_eq!(
                (label.node_name(), label.object_name()),
                (element.tagged_name(), element.tagged_name())
            );
            assert_eq!(label.id, element.global_id);
        }
    }

    #[test]
    fn links_follow_identities_and_end_with_what_they_name() {
        let missing = labels_of(|style| style.openings_missing = 1.0);
        let doors = missing.iter().flatten().filter(|l| l.class == "IfcDoor");
        assert!(doors.clone().count() == 9);
        assert!(
            doors
                .clone()
                .all(|l| !l.metadata.contains_key("opening_id") && l.metadata.contains_key("host_id"))
        );
        let doubled = labels_of(|style| style.doubled_ids = 0.5);
        let ids: Vec<&String> = doubled.iter().flatten().map(|l| &l.id).collect();
        assert!(
            doubled
                .iter()
                .flatten()
                .filter_map(|l| l.metadata.get("host_id"))
                .all(|host| ids.contains(&host))
        );
        let mut different = ids.clone();
        different.sort_unstable();
        different.dedup();
        assert!(different.len() < ids.len() * 3 / 4);
    }

    #[test]
    fn the_nameless_are_called_by_class_and_identity() {
        let label = labels_of(|style| style.nameless = 1.0).remove(5).unwrap();
        assert_eq!(label.node_name(), format!("{}:{}", label.class, label.id));
        assert_eq!(label.object_name(), format!("{}:", label.class));
        assert_eq!(label.metadata["name"], "");
        let doubled = labels_of(|style| style.doubled_names = 1.0);
        let walls = doubled.iter().flatten().filter(|l| l.class == "IfcWallStandardCase");
        assert!(walls.count() == 14);
        assert!(doubled.iter().flatten().all(|l| l.class != "IfcSpace" || l.name == "Living room"));
    }
}
