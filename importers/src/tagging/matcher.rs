//! One condition of a rule: a regular expression, or plain names where the expression is no more than that.

use regex::{Regex, RegexBuilder};

/// Bytes that one compiled expression, and its cache, may use each. Enough for long alternations and Unicode
/// classes; bounds what a rules file can cost.
const SIZE_LIMIT: usize = 256 << 10;

/// Depth of groups in an expression.
const NEST_LIMIT: u32 = 50;

/// A test of a text.
#[derive(Clone, Debug)]
pub(super) enum Matcher {
    /// `^Name$` or `^(A|B|C)$`: the text is one of these names. Most conditions on classes are, and a table of names
    /// is found faster than any expression runs.
    Names {
        /// The names, in ASCII letters, digits and `_`.
        names: Vec<String>,
        /// Whether letters match in any case.
        any_case: bool,
    },
    /// Any other expression; unanchored.
    Pattern(Regex),
}

impl Matcher {
    /// Compiles `pattern`.
    ///
    /// # Errors
    /// The message of the expression's parser, or that it is too large.
    pub fn new(pattern: &str) -> Result<Matcher, String> {
        if let Some((names, any_case)) = plain_names(pattern) {
            return Ok(Matcher::Names { names, any_case });
        }
        RegexBuilder::new(pattern)
            .size_limit(SIZE_LIMIT)
            .dfa_size_limit(SIZE_LIMIT)
            .nest_limit(NEST_LIMIT)
            .build()
            .map(Matcher::Pattern)
            .map_err(|e| e.to_string())
    }

    /// Whether `text` meets the condition.
    pub fn is_match(&self, text: &str) -> bool {
        match self {
            Matcher::Names { names, any_case: true } => names.iter().any(|n| n.eq_ignore_ascii_case(text)),
            Matcher::Names { names, any_case: false } => names.iter().any(|n| n == text),
            Matcher::Pattern(regex) => regex.is_match(text),
        }
    }
}

/// The names that `pattern` spells out, and whether it has the flag `i`, if it is `^Name$` or `^(A|B)$` after
/// optional flags `(?i)`, `(?x)`, `(?ix)`.
fn plain_names(pattern: &str) -> Option<(Vec<String>, bool)> {
    let (flags, body) = match pattern.strip_prefix("(?") {
        Some(rest) => rest.split_once(')')?,
        None => ("", pattern),
    };
    let (any_case, extended) = match flags {
        "" => (false, false),
        "i" => (true, false),
        "x" => (false, true),
        "ix" | "xi" => (true, true),
        _ => return None,
    };
    let body: String =
        if extended { body.chars().filter(|c| !c.is_whitespace()).collect() } else { body.to_owned() };
    let body = body.strip_prefix('^')?.strip_suffix('$')?;
    let names: Vec<String> = match body.strip_prefix('(') {
        Some(group) => {
            let group = group.strip_suffix(')')?;
            group.strip_prefix("?:").unwrap_or(group).split('|').map(str::to_owned).collect()
        }
        None => vec![body.to_owned()],
    };
    let is_name = |n: &String| !n.is_empty() && n.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    names.iter().all(is_name).then_some((names, any_case))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn plain_names_are_seen() {
        let names = |p: &str| plain_names(p).map(|(n, any_case)| (n.join(","), any_case));
        assert_eq!(names("^IfcWall$"), Some(("IfcWall".into(), false)));
        assert_eq!(names("(?i)^(IfcWall|IfcBeam)$"), Some(("IfcWall,IfcBeam".into(), true)));
        assert_eq!(names("(?ix) ^ (?: A\n | B_2 ) $"), Some(("A,B_2".into(), true)));
        for other in [
            "IfcWall", "^IfcWall", "^A|B$", "^(A|B$", "^(A||B)$", "(?i:^A$)", "^A.$", "(?s)^A$", "^$", "^()$",
        ] {
            assert_eq!(names(other), None, "{other}");
        }
    }

    #[test]
    fn bad_and_huge_expressions_are_refused() {
        assert!(Matcher::new("(").unwrap_err().contains("unclosed group"));
        assert!(Matcher::new(r"(?i)(\w{100}){100}").unwrap_err().contains("size limit"));
        assert!(Matcher::new(&"(".repeat(200)).is_err());
        assert!(Matcher::new(&format!("{}a{}", "(".repeat(200), ")".repeat(200))).is_err());
        assert!(Matcher::new(r"(?i)(^|[^\pL])(verglasung|glas|w\w*d)([^\pL]|$)").is_ok());
    }

    proptest! {
        /// The quick way answers as the expression would (for ASCII texts; `(?i)` of the expression also folds two
        /// foreign letters into `k` and `s`).
        #[test]
        fn names_match_as_expressions_do(
            names in proptest::collection::vec("[a-cS_]{1,3}", 1..4),
            text in "[a-cA-CsS_ \n]{0,4}",
            flags in prop_oneof![Just(""), Just("(?i)"), Just("(?x)"), Just("(?ix)")],
        ) {
            let pattern = format!("{flags}^({})$", names.join("|"));
            let quick = Matcher::new(&pattern).unwrap();
            let is_quick = matches!(quick, Matcher::Names { .. });
            prop_assert!(is_quick);
            prop_assert_eq!(quick.is_match(&text), Regex::new(&pattern).unwrap().is_match(&text));
        }
    }
}
