//! One condition of a rule: a regular expression, or plain names where the expression is no more than that.

use regex::{Regex, RegexBuilder};

/// Bytes that one compiled expression may use: the least of these that it fits in is what it costs. The largest is
/// enough for long alternations and Unicode classes, and bounds an expression's cache, too.
const SIZES: [usize; 3] = [8 << 10, 64 << 10, 256 << 10];
const SIZE_LIMIT: usize = SIZES[2];

/// Bytes that all expressions of a rules file may use together.
const SUM_LIMIT: usize = 64 << 20;

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

/// Compiles the conditions of one rules file, and counts what they cost.
#[derive(Clone, Debug)]
pub(super) struct Compiler {
    /// Bytes that further expressions may use.
    left: usize,
}

impl Compiler {
    /// With nothing compiled yet.
    pub fn new() -> Compiler {
        Compiler { left: SUM_LIMIT }
    }

    /// Compiles `pattern`.
    ///
    /// # Errors
    /// The message of the expression's parser, or that it is too large, alone or together with those before.
    pub fn compile(&mut self, pattern: &str) -> Result<Matcher, String> {
        if let Some((names, any_case)) = plain_names(pattern) {
            return Ok(Matcher::Names { names, any_case });
        }
        let mut error = String::new();
        for size in SIZES {
            if size > self.left {
                return Err(format!(
                    "the expressions of this file are too large together: over {} MiB",
                    SUM_LIMIT >> 20
                ));
            }
            let mut builder = RegexBuilder::new(pattern);
            match builder.size_limit(size).dfa_size_limit(SIZE_LIMIT).nest_limit(NEST_LIMIT).build() {
                Ok(regex) => {
                    self.left -= size;
                    return Ok(Matcher::Pattern(regex));
                }
                Err(too_big @ regex::Error::CompiledTooBig(_)) => error = too_big.to_string(),
                Err(other) => return Err(other.to_string()),
            }
        }
        Err(error)
    }
}

impl Matcher {
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
        let compile = |pattern: &str| Compiler::new().compile(pattern);
        assert!(compile("(").unwrap_err().contains("unclosed group"));
        assert!(compile(r"(?i)(\w{100}){100}").unwrap_err().contains("size limit"));
        assert!(compile(&"(".repeat(200)).is_err());
        assert!(compile(&format!("{}a{}", "(".repeat(200), ")".repeat(200))).is_err());
        assert!(compile(r"(?i)(^|[^\pL])(verglasung|glas|w\w*d)([^\pL]|$)").is_ok());
    }

    /// As many of the largest expressions as there may be conditions would take gigabytes.
    #[test]
    fn expressions_are_bounded_together() {
        let (mut compiler, mut taken) = (Compiler::new(), 0);
        let error = loop {
            match compiler.compile(&format!(r"{taken}\w{{5}}")) {
                Ok(_) => taken += 1,
                Err(error) => break error,
            }
        };
        assert_eq!(taken, SUM_LIMIT / SIZE_LIMIT);
        assert_eq!(error, "the expressions of this file are too large together: over 64 MiB");
        // Small ones are counted as such, names not at all.
        let mut compiler = Compiler::new();
        for i in 0..4096 {
            compiler.compile(&format!("(?i)small {i}")).unwrap();
            compiler.compile(&format!("^Name{i}$")).unwrap();
        }
        assert_eq!(compiler.left, SUM_LIMIT - 4096 * SIZES[0]);
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
            let quick = Compiler::new().compile(&pattern).unwrap();
            let is_quick = matches!(quick, Matcher::Names { .. });
            prop_assert!(is_quick);
            prop_assert_eq!(quick.is_match(&text), Regex::new(&pattern).unwrap().is_match(&text));
        }
    }
}
