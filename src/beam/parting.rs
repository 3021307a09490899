//! Which part of a floor or a ceiling a ray leaves through: by lines of the plan, in a tree.
//!
//! Floors and ceilings of several parts, each the footprint of a cell beyond, are split along the edges of these, those first that split the fewest
//! of them. All is exact, on the lattice. The tree of a floor is made when it is first looked at.

use std::sync::OnceLock;

use glam::DVec2;

use super::walk::corner;
use crate::format::records::CoverRecord;
use crate::trace::Prisms;

/// Of the edges of all parts so many are looked at, evenly chosen, before all are.
const CHOICE: usize = 32;

/// A tree has no more nodes than this for each part: edges that all split many parts would make it grow without end.
const MOST_NODES: usize = 64;

/// Nor is it deeper than this.
const DEEPEST: usize = 200;

/// So many edges by so many covers are looked at where few of them are not enough.
const MOST_PAIRS: usize = 1 << 22;

/// What a surface is split by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum By {
    /// The upright plane through two points of the plan.
    Upright([DVec2; 2]),
    /// This one of the planes.
    Level(u32),
}

/// A part of a floor or a ceiling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    /// Split; the parts on the right of a line, or over a plane, and on the left, or below, as places in the tree.
    Split { by: By, right: u32, left: u32 },
    /// This one of the covers.
    Cover(u32),
    /// Nothing says what is there.
    Unsure,
}

/// The trees of all floors and ceilings.
pub(crate) struct Partings {
    ends: Vec<OnceLock<Box<[Part]>>>,
}

impl Partings {
    /// Of so many cells.
    pub(crate) fn new(cells: usize) -> Partings {
        Partings { ends: (0..2 * cells).map(|_| OnceLock::new()).collect() }
    }

    /// The tree of a cell's floor, or ceiling, which these cover, its root last.
    pub(crate) fn of(
        &self,
        cell: u32,
        is_ceiling: bool,
        prisms: &Prisms<'_>,
        covers: &[CoverRecord],
    ) -> &[Part] {
        let index = 2 * cell as usize + usize::from(is_ceiling);
        self.ends[index].get_or_init(|| {
            let cells: Vec<u32> = covers.iter().map(|cover| cover.cell).collect();
            plan_tree(prisms, &cells)
        })
    }
}

/// The tree that tells the footprints of some cells apart, which do not overlap; its root last.
pub(crate) fn plan_tree(prisms: &Prisms<'_>, cells: &[u32]) -> Box<[Part]> {
    if cells.is_empty() { [].into() } else { Planting::new(prisms, cells).tree() }
}

/// A tree being made.
struct Planting {
    footprints: Vec<Vec<DVec2>>,
    parts: Vec<Part>,
    most: usize,
}

impl Planting {
    fn new(prisms: &Prisms<'_>, cells: &[u32]) -> Planting {
        let footprint =
            |&cell: &u32| prisms.sides_of(&prisms.cells[cell as usize]).iter().map(corner).collect();
        Planting {
            footprints: cells.iter().map(footprint).collect(),
            parts: Vec::new(),
            most: MOST_NODES.saturating_mul(cells.len()),
        }
    }

    fn tree(mut self) -> Box<[Part]> {
        let all: Vec<u32> = (0..self.footprints.len() as u32).collect();
        self.part(&all, 0);
        self.parts.into()
    }

    /// Adds the tree of some covers; returns its root's place, the last.
    fn part(&mut self, covers: &[u32], depth: usize) -> u32 {
        let part = match covers {
            [cover] => Part::Cover(*cover),
            _ if depth == DEEPEST || self.parts.len() > self.most => Part::Unsure,
            _ => match self.line(covers) {
                None => Part::Unsure,
                Some(line) => {
                    let [right, left] = [-1.0, 1.0].map(|side| {
                        let there: Vec<u32> =
                            covers.iter().copied().filter(|&cover| self.reaches(cover, line, side)).collect();
                        self.part(&there, depth + 1)
                    });
                    Part::Split { by: By::Upright(line), right, left }
                }
            },
        };
        self.parts.push(part);
        self.parts.len() as u32 - 1
    }

    /// Whether a cover reaches to the left (`side` is 1) or to the right (-1) of a line.
    fn reaches(&self, cover: u32, [a, b]: [DVec2; 2], side: f64) -> bool {
        self.footprints[cover as usize].iter().any(|&corner| (b - a).perp_dot(corner - a) * side > 0.0)
    }

    /// The line that splits the fewest of some covers and parts some from others; the most even of those.
    fn line(&self, covers: &[u32]) -> Option<[DVec2; 2]> {
        let edges: Vec<[DVec2; 2]> = covers
            .iter()
            .flat_map(|&cover| {
                let corners = &self.footprints[cover as usize];
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).map(|(&a, &b)| [a, b])
            })
            .collect();
        let step = edges.len().div_ceil(CHOICE).max(1);
        let few = self.best(covers, edges.iter().step_by(step));
        if few.is_some() || edges.len().saturating_mul(covers.len()) > MOST_PAIRS {
            return few;
        }
        self.best(covers, edges.iter())
    }

    fn best<'e>(&self, covers: &[u32], edges: impl Iterator<Item = &'e [DVec2; 2]>) -> Option<[DVec2; 2]> {
        let rank = |line: [DVec2; 2]| {
            let [right, left] = [-1.0, 1.0]
                .map(|side| covers.iter().filter(|&&cover| self.reaches(cover, line, side)).count());
            let larger = right.max(left);
            // What is on both sides counts as much as what is left to be done of the larger.
            (right.min(left) > 0 && larger < covers.len()).then_some(2 * (right + left) + larger)
        };
        let ranked = edges.filter_map(|&line| rank(line).map(|rank| (rank, line)));
        ranked.min_by_key(|(rank, _)| *rank).map(|(_, line)| line)
    }
}
