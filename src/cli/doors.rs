//! Openings that a command closes or opens before it does its work.

use std::collections::BTreeMap;

use clap::{Args, ValueEnum};
use enfilade::Scene;
use enfilade::closing::{ClosingError, Leaf, Stand};
use enfilade::importers::{Role, Semantic};

use super::failure::Failure;
use super::input::Resources;

/// How doors and windows stand; as modelled where nothing is said.
#[derive(Args, Debug, Clone, Default)]
#[command(next_help_heading = "Doors and windows")]
pub struct Doors {
    /// Close an opening, whatever its leaf does: its id or that of what fills it (trace --elements lists them), or
    /// doors, windows, openings (without a filling), all. May be repeated.
    #[arg(long, value_name = "ID")]
    closed: Vec<String>,
    /// Open an opening: its leaf is taken out. Ids as above; what is named itself counts more than doors, windows and openings, and these
    /// more than all.
    #[arg(long = "open", value_name = "ID")]
    open: Vec<String>,
    /// Whether leaves stay where they were modelled; by default those of closed openings do, and those of opened ones do not.
    #[arg(long, value_enum, value_name = "WHERE")]
    leaf: Option<LeafIs>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum LeafIs {
    In,
    Out,
}

/// A sheet is tight if this share of its outline is on matter.
const TIGHT: f64 = 0.999;

impl Doors {
    /// Makes the openings of a scene stand as asked for, and warns of what stays open around a sheet.
    pub fn apply(&self, scene: &mut Scene, resources: &Resources) -> Result<(), Failure> {
        if self.closed.is_empty() && self.open.is_empty() {
            return match self.leaf {
                Some(_) => Err(Failure::usage("--leaf: of which openings? Say --closed or --open")),
                None => Ok(()),
            };
        }
        let stand = |open: bool| Stand {
            open,
            leaf: match self.leaf {
                Some(LeafIs::In) => Leaf::In,
                Some(LeafIs::Out) => Leaf::Out,
                None if open => Leaf::Out,
                None => Leaf::In,
            },
        };
        // All, then kinds of openings, then single ones: what is said last of an opening counts.
        let mut asked: [Asked; 3] = Default::default();
        for (id, open) in
            self.open.iter().map(|id| (id, true)).chain(self.closed.iter().map(|id| (id, false)))
        {
            if let Some(element) = scene.elements().find(|element| element.id() == id.as_str()) {
                let opening = match element.opening() {
                    Some(opening) if element.role() != Role::Air => opening,
                    _ => element.index(),
                };
                ask(scene, &mut asked[2], opening, stand(open))?;
            } else if let Some(is_meant) = group(id) {
                let level = usize::from(id != "all");
                for e in scene.elements().filter(|e| e.role() == Role::Air && is_meant(e.semantic())) {
                    ask(scene, &mut asked[level], e.index(), stand(open))?;
                }
            } else {
                let text = format!(
                    "no element has the id '{id}', which is no group either (doors, windows, openings, all)"
                );
                return Err(Failure::usage(text));
            }
        }
        let [all, kinds, named] = asked;
        let mut groups = all;
        groups.extend(kinds);
        let named: Vec<(u32, Stand)> = named.into_iter().collect();
        set_groups(scene, groups.into_iter().collect(), resources)?;
        scene.set_stands(&named).map_err(Failure::usage)?;
        let loose: Vec<_> = scene.closures().iter().filter(|closure| closure.sealed < TIGHT).collect();
        if let Some(worst) = loose.iter().min_by(|a, b| a.sealed.total_cmp(&b.sealed)) {
            resources.warn(&[format!(
                "air leads around {} of {} sheets that close openings: only {:.0} % of the outline of '{}' is on matter",
                loose.len(),
                scene.closures().len(),
                worst.sealed * 100.0,
                scene.element(worst.opening).id()
            )]);
        }
        Ok(())
    }
}

/// How openings are to stand, by their elements.
type Asked = BTreeMap<u32, Stand>;

/// Adds that an opening is to stand so, unless something else was asked for in the same breath.
fn ask(scene: &Scene, asked: &mut Asked, opening: u32, stand: Stand) -> Result<(), Failure> {
    match asked.insert(opening, stand) {
        Some(before) if before != stand => Err(Failure::usage(format!(
            "opening '{}' cannot be both open and closed",
            scene.element(opening).id()
        ))),
        _ => Ok(()),
    }
}

/// Groups stand as asked for as far as can be; what is named must.
fn set_groups(scene: &mut Scene, groups: Vec<(u32, Stand)>, resources: &Resources) -> Result<(), Failure> {
    let failed = scene.set_stands_where_possible(&groups).map_err(Failure::usage)?;
    let solid = failed.iter().filter(|(_, error)| matches!(error, ClosingError::SolidLeaf { .. }));
    let solid: Vec<u32> = solid.map(|(opening, _)| *opening).collect();
    // Their leaves stay, but closed they are.
    let with_leaf: Vec<(u32, Stand)> = groups
        .into_iter()
        .filter(|(opening, stand)| !stand.open && solid.binary_search(opening).is_ok())
        .map(|(opening, stand)| (opening, Stand { leaf: Leaf::In, ..stand }))
        .collect();
    let no_hole = failed.len() - solid.len()
        + scene.set_stands_where_possible(&with_leaf).map_err(Failure::usage)?.len();
    let mut warnings = Vec::new();
    if no_hole > 0 {
        warnings.push(format!(
            "{no_hole} openings are no holes with matter around them and air in them, and are left as they are"
        ));
    }
    if !solid.is_empty() {
        warnings.push(format!(
            "{} openings are filled by solids, which cannot be taken out and stay in",
            solid.len()
        ));
    }
    resources.warn(&warnings);
    Ok(())
}

/// The openings of a group, by their meaning.
fn group(name: &str) -> Option<fn(Semantic) -> bool> {
    Some(match name {
        "doors" => |semantic| semantic == Semantic::Door,
        "windows" => |semantic| semantic == Semantic::Window,
        "openings" => |semantic| semantic == Semantic::Opening,
        "all" => |semantic| matches!(semantic, Semantic::Door | Semantic::Window | Semantic::Opening),
        _ => return None,
    })
}
