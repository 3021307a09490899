//! A node's metadata.

use std::collections::BTreeMap;

use gltf::json;
use gltf::json::extras::RawValue;

/// `extras` of a node.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Extras {
    /// All keys; strings as they are, other values as JSON text without blanks.
    pub all: BTreeMap<String, String>,
    /// Identity in the tool that the model comes from.
    pub global_id: Option<String>,
    /// The name there.
    pub name: Option<String>,
    /// `IfcWall`...
    pub ifc_class: Option<String>,
    /// The storey's name.
    pub storey: Option<String>,
    /// Identity of what an opening pierces, or of what holds a door.
    pub host: Option<String>,
    /// Identity of what fills an opening.
    pub filling: Option<String>,
    /// Identity of the opening that a door fills.
    pub opening: Option<String>,
}

impl Extras {
    /// Reads a node's `extras`; what is no object is none.
    pub fn of(node: &json::Node) -> Extras {
        let Some(raw) = &node.extras else { return Extras::default() };
        let Ok(values) = serde_json::from_str::<BTreeMap<String, Box<RawValue>>>(raw.get()) else {
            return Extras::default();
        };
        let mut extras = Extras::default();
        for (key, value) in values {
            let text = value.get();
            let string = serde_json::from_str::<String>(text).ok();
            let known = match key.as_str() {
                "global_id" => Some(&mut extras.global_id),
                "name" => Some(&mut extras.name),
                "ifc_class" => Some(&mut extras.ifc_class),
                "storey" => Some(&mut extras.storey),
                "host_id" => Some(&mut extras.host),
                "filling_id" => Some(&mut extras.filling),
                "opening_id" => Some(&mut extras.opening),
                _ => None,
            };
            if let Some(known) = known {
                // Some tools number their objects.
                let number =
                    || text.starts_with(|c: char| c == '-' || c.is_ascii_digit()).then(|| text.to_owned());
                *known = string.clone().or_else(number).filter(|s| !s.is_empty());
            }
            extras.all.insert(key, string.unwrap_or_else(|| compact(text)));
        }
        extras
    }
}

/// Valid JSON text without the blanks between its parts. Numbers keep their digits and objects their order, which
/// parsing and writing again would not promise.
fn compact(text: &str) -> String {
    let mut in_string = false;
    let mut escaped = false;
    text.chars()
        .filter(|&c| {
            if in_string {
                if escaped {
                    escaped = false;
                } else if c == '\\' {
                    escaped = true;
                } else if c == '"' {
                    in_string = false;
                }
                true
            } else {
                in_string = c == '"';
                !matches!(c, ' ' | '\t' | '\n' | '\r')
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(extras: &str) -> Extras {
        let node = serde_json::from_str(&format!(r#"{{"extras":{extras}}}"#)).unwrap();
        Extras::of(&node)
    }

    #[test]
    fn strings_stay_and_other_values_become_compact_json() {
        let extras =
            of(r#"{"a":"x \"y\" \u00fc", "b": [1.50, {"z": " q \" ", "a": null}], "c": true, "d": ""}"#);
        let expected =
            [("a", "x \"y\" ü"), ("b", r#"[1.50,{"z":" q \" ","a":null}]"#), ("c", "true"), ("d", "")];
        let all: Vec<(&str, &str)> = extras.all.iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        assert_eq!(all, expected);
    }

    #[test]
    fn known_keys_are_strings_or_numbers() {
        let extras = of(r#"{"global_id":12,"name":"","ifc_class":null,"storey":"EG","host_id":["x"]}"#);
        assert_eq!(extras.global_id.as_deref(), Some("12"));
        assert_eq!((extras.name, extras.ifc_class, extras.host), (None, None, None));
        assert_eq!(extras.storey.as_deref(), Some("EG"));
    }

    #[test]
    fn what_is_no_object_is_none() {
        for extras in ["null", "3", "\"x\"", "[1]"] {
            assert_eq!(of(extras), Extras::default());
        }
    }
}
