//! Custom tagging rules: what each element is, before and after a rule of one's own.
//!
//! ```sh
//! cargo run --release --example rules -- fixtures/house.glb
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use enfilade::importers::tagging::Rules;
use enfilade::importers::{ImportOptions, Model, import};

/// Everything that is no wall, slab or room of the house is furniture, and columns are walls.
const RULES: &str = r#"
[[rule]]
class = '^Ifc(FlowTerminal|LightFixture)$'
semantic = "FURNITURE"

[[rule]]
class = '^IfcColumn'
semantic = "WALL"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which model?")?;
    for (semantic, [before, after]) in compare(Path::new(&path))? {
        println!("{semantic:<14} {before:>5} {after:>5}");
    }
    Ok(())
}

/// For each semantic word how many elements have it, by the shipped rules and with the ones above before them.
pub fn compare(path: &Path) -> Result<BTreeMap<&'static str, [usize; 2]>, Box<dyn Error>> {
    let plain = import(path, &ImportOptions::default())?;
    let mut options = ImportOptions::default();
    options.rules = Some(Rules::parse(RULES, "example rules")?);
    let ruled = import(path, &options)?;
    let mut counts = BTreeMap::new();
    for (i, model) in [plain, ruled].iter().enumerate() {
        count(model, i, &mut counts);
    }
    Ok(counts)
}

fn count(model: &Model, column: usize, counts: &mut BTreeMap<&'static str, [usize; 2]>) {
    for element in &model.elements {
        counts.entry(element.semantic.name()).or_insert([0, 0])[column] += 1;
    }
}
