//! Holes in walls, with what fills them.

use twox_hash::XxHash3_64;

use crate::importers::Semantic;

use super::building::Kind;
use super::draft::Draft;
use super::joinery::{self, AJAR, Ajar, Hinge, Leaf};
use super::lattice::{Cuboid, Placement};
use super::palette::{self, Look};

/// What closes a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filling {
    /// A passage.
    Nothing,
    /// A window of so many panes side by side.
    Window {
        /// Panes.
        panes: i32,
    },
    /// A front door of one leaf.
    Entrance,
    /// A glazed door of two leaves.
    Terrace,
    /// A door of one leaf.
    Door(Hinge),
}

/// A hole in a wall.
#[derive(Clone, Copy, Debug)]
pub struct Hole<'a> {
    /// What it and its filling are called.
    pub name: &'a str,
    /// Right through the wall, units.
    pub space: Cuboid,
    /// The room that doors swing into lies in this direction: 0 north, 1 west, 2 south, 3 east.
    pub inside: u8,
    /// What closes it.
    pub filling: Filling,
    /// Material underfoot, unless it is a window.
    pub threshold: u32,
}

/// Makes a hole in a wall and fills it. How far doors stand open follows from `seed`.
pub fn pierce(draft: &mut Draft, plan: &Hole<'_>, wall: u32, seed: u64) {
    let semantic = match plan.filling {
        Filling::Nothing => Semantic::Opening,
        Filling::Window { .. } => Semantic::Window,
        _ => Semantic::Door,
    };
    let opening =
        draft.element(Kind::Opening, semantic, "IfcOpeningElement", &format!("{} opening", plan.name));
    let is_window = matches!(plan.filling, Filling::Window { .. });
    let floor = if is_window { palette::STONE } else { plan.threshold };
    draft.look(opening, Look { floor, ceiling: palette::PLASTER, ..Look::default() });
    draft.paint(opening, plan.space);

    let hole = hole_frame(&plan.space, plan.inside);
    let ajar = |most: usize| -> Ajar {
        let pick = XxHash3_64::oneshot_with_seed(seed, plan.name.as_bytes()) % (most as u64 + 1);
        AJAR[pick as usize]
    };
    let leaf = |hinge, ajar, glazed, paint| Leaf { hinge, ajar, glazed, paint };
    let parts = match plan.filling {
        Filling::Nothing => None,
        Filling::Window { panes } => {
            Some((Semantic::WindowFrame, "IfcWindow", joinery::window(&hole, panes)))
        }
        Filling::Entrance => {
            let leaves = [leaf(Hinge::Low, AJAR[0], false, palette::GREEN_PAINT)];
            Some((Semantic::DoorLeaf, "IfcDoor", joinery::door(&hole, &leaves)))
        }
        Filling::Terrace => {
            let leaves = [
                leaf(Hinge::Low, AJAR[0], true, palette::WHITE_PAINT),
                leaf(Hinge::High, ajar(2), true, palette::WHITE_PAINT),
            ];
            Some((Semantic::DoorLeaf, "IfcDoor", joinery::door(&hole, &leaves)))
        }
        Filling::Door(hinge) => {
            let leaves = [leaf(hinge, ajar(3), false, palette::WHITE_PAINT)];
            Some((Semantic::DoorLeaf, "IfcDoor", joinery::door(&hole, &leaves)))
        }
    };
    let filling = parts.map(|(semantic, class, plans)| {
        let filling = draft.element(Kind::Detail, semantic, class, plan.name);
        plans.into_iter().for_each(|part| draft.detail(filling, part));
        filling
    });
    draft.fill(wall, opening, filling);
}

/// The hole's own frame, in which v points to `inside`.
fn hole_frame(space: &Cuboid, inside: u8) -> joinery::Hole {
    let Cuboid { lo, hi } = *space;
    let [x, y] = match inside {
        0 => [lo[0], hi[1]],
        1 => [lo[0], lo[1]],
        2 => [hi[0], lo[1]],
        _ => [hi[0], hi[1]],
    };
    let size = [0, 1, 2].map(|i| hi[i] - lo[i]);
    let (width, depth) = if inside.is_multiple_of(2) { (size[0], size[1]) } else { (size[1], size[0]) };
    joinery::Hole { place: Placement { origin: [x, y, lo[2]], turns: inside }, width, depth, height: size[2] }
}
