//! Rules files: what they hold and how they are read.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use serde::Deserialize;
use toml::Spanned;

use super::matcher::{Compiler, Matcher};
use crate::error::{ImportError, ImportErrorKind};
use crate::semantic::Semantic;

/// Bytes of the longest rules file.
const MAX_TEXT: usize = 4 << 20;

/// Rules and conditions in one file, at most.
const MAX_RULES: usize = 4096;
const MAX_CONDITIONS: usize = 4096;

/// The shipped table's name in errors.
const SHIPPED_NAME: &str = "ifc.toml";

/// Rules that give elements a meaning, in their order: the first that matches an element decides. Cheap to clone.
///
/// ```
/// use enfilade_importers::tagging::Rules;
///
/// let text = "
///     [[rule]]
///     name = '(?i)terrace'
///     extras.predefined_type = '^FLOOR$'
///     semantic = 'GROUND'
/// ";
/// let rules = Rules::parse(text, "house.toml")?;
/// assert_eq!(rules.len(), 1);
///
/// let error = Rules::parse("[[rule]]\nname = '('\nsemantic = 'WALL'", "house.toml").unwrap_err();
/// assert!(error.to_string().starts_with("house.toml: line 2: rule 1, 'name': "));
/// # Ok::<(), enfilade_importers::ImportError>(())
/// ```
#[derive(Clone, Default)]
pub struct Rules {
    source: String,
    pub(super) rules: Arc<[Rule]>,
}

/// Conditions, and the meaning where all of them hold.
#[derive(Debug)]
pub(super) struct Rule {
    pub class: Option<Matcher>,
    /// Conditions on anything but the class.
    pub others: Vec<(Key, Matcher)>,
    pub semantic: Semantic,
}

/// What a condition looks at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Key {
    Name,
    OtherName,
    Material,
    Filling,
    Path,
    Storey,
    Id,
    Extras(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    rule: Vec<Spanned<RuleText>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RuleText {
    name: Option<Spanned<String>>,
    other_name: Option<Spanned<String>>,
    class: Option<Spanned<String>>,
    material: Option<Spanned<String>>,
    filling: Option<Spanned<String>>,
    path: Option<Spanned<String>>,
    storey: Option<Spanned<String>>,
    id: Option<Spanned<String>>,
    #[serde(default)]
    extras: BTreeMap<String, Spanned<String>>,
    semantic: Option<Spanned<String>>,
}

impl Rules {
    /// The rules in `text` (TOML); `file_name` is for errors and reports. `docs/TAGGING.md` describes the format.
    ///
    /// # Errors
    /// [`ImportErrorKind::Rules`], with the line as its place: no TOML, an unknown key, no regular expression or a
    /// too large one, no semantic word, too many rules.
    pub fn parse(text: &str, file_name: &str) -> Result<Rules, ImportError> {
        let fail = |at: Option<usize>, message: String| {
            let error = ImportError::new(file_name, ImportErrorKind::Rules(message));
            match at {
                Some(offset) => error.at(format!("line {}", line_of(text, offset))),
                None => error,
            }
        };
        if text.len() > MAX_TEXT {
            return Err(fail(None, format!("{} bytes are too long for a rules file", text.len())));
        }
        let file: File =
            toml::from_str(text).map_err(|e| fail(e.span().map(|s| s.start), e.message().to_owned()))?;
        if file.rule.len() > MAX_RULES {
            return Err(fail(None, format!("{} rules, over the limit of {MAX_RULES}", file.rule.len())));
        }
        let mut conditions = 0;
        let mut compiler = Compiler::new();
        let mut rules = Vec::with_capacity(file.rule.len());
        for (index, rule) in file.rule.into_iter().enumerate() {
            let number = index + 1;
            let start = rule.span().start;
            let rule = rule.into_inner();
            let mut compile = |key: &str, pattern: &Spanned<String>| {
                let at = pattern.span().start;
                compiler
                    .compile(pattern.as_ref())
                    .map_err(|message| fail(Some(at), format!("rule {number}, '{key}': {message}")))
            };
            let class = rule.class.as_ref().map(|pattern| compile("class", pattern)).transpose()?;
            let mut others = Vec::new();
            let keyed = [
                (Key::Id, &rule.id),
                (Key::Storey, &rule.storey),
                (Key::Filling, &rule.filling),
                (Key::Name, &rule.name),
                (Key::OtherName, &rule.other_name),
                (Key::Path, &rule.path),
                (Key::Material, &rule.material),
            ];
            for (key, pattern) in keyed {
                if let Some(pattern) = pattern {
                    let matcher = compile(&key.to_string(), pattern)?;
                    others.push((key, matcher));
                }
            }
            for (name, pattern) in &rule.extras {
                let key = Key::Extras(name.clone());
                let matcher = compile(&key.to_string(), pattern)?;
                others.push((key, matcher));
            }
            conditions += others.len() + usize::from(class.is_some());
            if conditions > MAX_CONDITIONS {
                return Err(fail(Some(start), format!("more than {MAX_CONDITIONS} conditions")));
            }
            let Some(word) = &rule.semantic else {
                return Err(fail(Some(start), format!("rule {number} has no 'semantic'")));
            };
            let semantic = parse_word(word.as_ref()).map_err(|message| {
                fail(Some(word.span().start), format!("rule {number}, 'semantic': {message}"))
            })?;
            rules.push(Rule { class, others, semantic });
        }
        Ok(Rules { source: file_name.to_owned(), rules: rules.into() })
    }

    /// The rules in the file at `path`.
    ///
    /// # Errors
    /// As [`Rules::parse`], or if the file cannot be read or is no UTF-8.
    pub fn load(path: &Path) -> Result<Rules, ImportError> {
        use std::io::Read;
        let name = path.display().to_string();
        let mut text = String::new();
        std::fs::File::open(path)
            // One byte over the limit, so that `parse` sees that the file is too long.
            .and_then(|file| file.take(MAX_TEXT as u64 + 1).read_to_string(&mut text))
            .map_err(|e| ImportError::new(name.clone(), e))?;
        Rules::parse(&text, &name)
    }

    /// The shipped table: a rule for every class of IFC2x3, IFC4 and IFC4x3 that can have geometry. Read once in a
    /// program's life.
    pub fn shipped() -> Rules {
        // It never changes, and takes far longer to read than a small model takes to tag.
        static SHIPPED: LazyLock<Rules> = LazyLock::new(|| {
            // The text is part of this crate, and a test parses it: it cannot fail.
            Rules::parse(Rules::shipped_text(), SHIPPED_NAME).unwrap_or_default()
        });
        SHIPPED.clone()
    }

    /// The text of the shipped table, to print, to edit and to load again as a rules file.
    pub const fn shipped_text() -> &'static str {
        include_str!("ifc.toml")
    }

    /// How many rules there are.
    pub fn len(&self) -> usize {
        self.rules.len()
    }

    /// Whether there is no rule.
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// The file's name, as errors and reports give it; empty for [`Rules::default`].
    pub fn source(&self) -> &str {
        &self.source
    }
}

impl fmt::Debug for Rules {
    /// The file and the count: compiled expressions tell a reader nothing.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Rules").field("source", &self.source).field("rules", &self.rules.len()).finish()
    }
}

impl fmt::Display for Key {
    /// As rules files write it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Key::Name => f.write_str("name"),
            Key::OtherName => f.write_str("other_name"),
            Key::Material => f.write_str("material"),
            Key::Filling => f.write_str("filling"),
            Key::Path => f.write_str("path"),
            Key::Storey => f.write_str("storey"),
            Key::Id => f.write_str("id"),
            Key::Extras(name) => write!(f, "extras.{name}"),
        }
    }
}

/// A rule may also say `UNKNOWN`, to take a tag away.
fn parse_word(word: &str) -> Result<Semantic, String> {
    if word.trim().eq_ignore_ascii_case(Semantic::Unknown.name()) {
        return Ok(Semantic::Unknown);
    }
    word.parse().map_err(|e: crate::semantic::UnknownWord| e.to_string())
}

/// The line, from 1, of the byte at `offset`.
fn line_of(text: &str, offset: usize) -> usize {
    let offset = offset.min(text.len());
    text.as_bytes()[..offset].iter().filter(|&&b| b == b'\n').count() + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn error(text: &str) -> String {
        Rules::parse(text, "my.toml").expect_err("an error").to_string()
    }

    #[test]
    fn errors_name_file_line_rule_and_key() {
        let rule = "[[rule]]\nname = 'a'\nsemantic = 'WALL'\n\n";
        let cases = [
            (
                "[[rule]]\nnmae = 'x'\nsemantic = 'WALL'".to_owned(),
                "my.toml: line 2: unknown field `nmae`, expected",
            ),
            ("[[rules]]\nname = 'x'".to_owned(), "my.toml: line 1: unknown field `rules`, expected `rule`"),
            (format!("{rule}[[rule]]\nid = '('"), "my.toml: line 6: rule 2, 'id': regex parse error"),
            (
                format!("{rule}[[rule]]\nextras.a = '['\n"),
                "my.toml: line 6: rule 2, 'extras.a': regex parse error",
            ),
            (format!("{rule}[[rule]]\nid = 'x'"), "my.toml: line 5: rule 2 has no 'semantic'"),
            (
                format!("{rule}[[rule]]\nsemantic = 'KITCHEN'"),
                "my.toml: line 6: rule 2, 'semantic': 'KITCHEN' is no semantic word",
            ),
            ("[[rule]]\nsemantic = 'VOID'".to_owned(), "my.toml: line 2: rule 1, 'semantic': 'VOID' is no"),
            (
                "[[rule]]\nname = 3\nsemantic = 'WALL'".to_owned(),
                "my.toml: line 2: invalid type: integer `3`",
            ),
            ("[[rule]]\nname = 'a'\nname = 'b'".to_owned(), "my.toml: line 3: duplicate key"),
            ("[[rule]\n".to_owned(), "my.toml: line 1: "),
            (
                "[[rule]]\nname = '(a{200}){200}'\nsemantic = 'WALL'".to_owned(),
                "my.toml: line 2: rule 1, 'name': Compiled regex exceeds size limit",
            ),
        ];
        for (text, expected) in cases {
            let message = error(&text);
            assert!(message.starts_with(expected), "{text}\n-> {message}");
        }
    }

    #[test]
    fn too_much_is_refused() {
        assert!(error(&" ".repeat(MAX_TEXT + 1)).contains("too long"));
        assert!(error(&"[[rule]]\nsemantic='WALL'\n".repeat(MAX_RULES + 1)).contains("over the limit"));
        let two = "[[rule]]\nname='a'\nid='b'\nsemantic='WALL'\n";
        assert!(error(&two.repeat(MAX_CONDITIONS / 2 + 1)).contains("conditions"));
        assert!(error(&format!("rule = {}", "[".repeat(100_000))).starts_with("my.toml"));
    }

    #[test]
    fn files_are_loaded_and_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "[[rule]]\nsemantic = 'other'\n").unwrap();
        let rules = Rules::load(&path).unwrap();
        assert_eq!((rules.len(), rules.source()), (1, path.to_str().unwrap()));
        std::fs::write(&path, "[[rule]]\nsemantic = 'x'\n").unwrap();
        let message = Rules::load(&path).unwrap_err().to_string();
        assert!(message.contains("a.toml: line 2: rule 1"), "{message}");
        let missing = Rules::load(&folder.path().join("b.toml")).unwrap_err();
        assert!(matches!(missing.kind, ImportErrorKind::Io(_)));
        assert!(missing.file.ends_with("b.toml"));
    }

    #[test]
    fn an_empty_file_has_no_rules() {
        assert!(Rules::parse("# nothing yet\n", "my.toml").unwrap().is_empty());
    }

    #[test]
    fn the_shipped_table_parses() {
        let parsed = Rules::parse(Rules::shipped_text(), SHIPPED_NAME);
        assert_eq!(parsed.map(|r| r.len()).map_err(|e| e.to_string()), Ok(Rules::shipped().len()));
        // Every rule of it names its classes, which is what makes it quick.
        for rule in Rules::shipped().rules.iter() {
            assert!(matches!(rule.class, Some(Matcher::Names { any_case: true, .. })), "{rule:?}");
            assert!(rule.semantic.role().is_some());
        }
    }
}
