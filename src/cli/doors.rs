//! Openings that a command closes or opens before it does its work.

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
    /// Open an opening: its leaf is taken out. Ids as above; what is named itself counts more than groups.
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
        let (mut groups, mut named) = (Vec::new(), Vec::new());
        let asked = self.open.iter().map(|id| (id, true)).chain(self.closed.iter().map(|id| (id, false)));
        for (id, open) in asked {
            if let Some(element) = scene.elements().find(|element| element.id() == id.as_str()) {
                named.push((element.index(), stand(open)));
            } else if let Some(is_meant) = group(id) {
                let openings = scene.elements().filter(|e| e.role() == Role::Air && is_meant(e.semantic()));
                groups.extend(openings.map(|opening| (opening.index(), stand(open))));
            } else {
                let text = format!(
                    "no element has the id '{id}', which is no group either (doors, windows, openings, all)"
                );
                return Err(Failure::usage(text));
            }
        }
        self.set(scene, groups, named, resources)?;
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

    /// Groups are closed as far as can be; what is named must be.
    fn set(
        &self,
        scene: &mut Scene,
        mut groups: Vec<(u32, Stand)>,
        named: Vec<(u32, Stand)>,
        resources: &Resources,
    ) -> Result<(), Failure> {
        let (mut no_hole, mut solid) = (0, 0);
        loop {
            let failed = match scene.set_stands(&groups) {
                Ok(()) => break,
                Err(failed) => failed,
            };
            let id = match &failed {
                ClosingError::NoAir(opening) | ClosingError::NoMatter(opening) => {
                    no_hole += 1;
                    opening
                }
                ClosingError::SolidLeaf { opening, .. } => {
                    solid += 1;
                    opening
                }
                _ => return Err(Failure::usage(&failed)),
            };
            let before = groups.len();
            groups.retain(|(opening, _)| scene.element(*opening).id() != id.as_str());
            if groups.len() == before {
                return Err(Failure::usage(&failed));
            }
        }
        if no_hole > 0 {
            resources
                .warn(&[format!("{no_hole} openings are no holes with matter around them and air in them, and are left as they are")]);
        }
        if solid > 0 {
            resources.warn(&[format!("{solid} openings are filled by solids, which cannot be taken out")]);
        }
        scene.set_stands(&named).map_err(Failure::usage)
    }
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
