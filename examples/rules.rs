//! Tagging rules of one's own: imports a model without and with them, and prints how many elements of each meaning
//! there are. `docs/TAGGING.md` says what rules can look at.
//!
//!     cargo run --release --example rules -- fixtures/house.glb
//!     cargo run --release --example rules -- fixtures/house.glb my-rules.toml

use std::collections::BTreeMap;
use std::error::Error;
use std::io::{self, Write};
use std::path::PathBuf;

use enfilade::importers::tagging::{self, Rules};
use enfilade::importers::{ImportOptions, Model, Semantic, import};

const USAGE: &str = "usage: rules MODEL [RULES.toml]";

/// The rules if no file is named. The first that matches an element decides; elements that none matches keep what the
/// shipped table and their names say.
const OURS: &str = r#"
# Terraces and steps are part of the garden, not of the building.
[[rule]]
class = '^IfcSlab$'
name = '(?i)terrace|step'
semantic = "SITE"

# Sanitary ware counts as furniture.
[[rule]]
class = '^IfcFlowTerminal$'
semantic = "FURNITURE"

# Lamps are no matter for this study.
[[rule]]
class = '^IfcLightFixture$'
semantic = "ANNOTATION"
"#;

/// How many elements of each meaning there are.
fn count(model: &Model) -> BTreeMap<Semantic, usize> {
    let mut counts = BTreeMap::new();
    for element in &model.elements {
        *counts.entry(element.semantic).or_default() += 1;
    }
    counts
}

/// Does what the words of a command line say, and writes the table to `out`.
pub fn run(words: impl IntoIterator<Item = String>, out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let files: Vec<PathBuf> = words.into_iter().map(PathBuf::from).collect();
    let (path, rules) = match files.as_slice() {
        [model] => (model, Rules::parse(OURS, "rules.rs")?),
        [model, rules] => (model, Rules::load(rules)?),
        _ => return Err(USAGE.into()),
    };

    let before = import(path, &ImportOptions::default())?;
    let mut options = ImportOptions::default();
    options.rules = Some(rules.clone());
    let after = import(path, &options)?;

    let (old, new) = (count(&before), count(&after));
    writeln!(out, "{:<14} {:>6} {:>6}", "semantic", "before", "after")?;
    for semantic in Semantic::all() {
        let [was, is] = [&old, &new].map(|counts| counts.get(&semantic).copied().unwrap_or(0));
        if was + is > 0 {
            writeln!(out, "{:<14} {was:>6} {is:>6}", semantic.name())?;
        }
    }

    // Which rule was it?
    for (a, b) in before.elements.iter().zip(&after.elements) {
        if a.semantic != b.semantic {
            let why = tagging::describe(b, Some(&rules));
            writeln!(out, "{}: {} -> {} ({why})", b.name, a.semantic.name(), b.semantic.name())?;
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    run(std::env::args().skip(1), &mut io::stdout().lock())
}
