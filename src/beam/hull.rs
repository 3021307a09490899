//! Into the zone of the prisms from outside: which cell a ray enters through each of the zone's six sides.

use std::sync::OnceLock;

use glam::DVec2;

use super::parting::{By, Part, plan_tree};
use super::walk::corner;
use crate::format::records::CellRecord;
use crate::trace::Prisms;

/// More parts than this are not told apart on one side.
const MOST_PARTS: usize = 1 << 14;

/// As [`parting`](super::parting) has it.
const DEEPEST: usize = 200;

/// A side of the zone: the axis across it, and whether it is the upper one.
pub(super) type Side = (usize, bool);

/// The cells along one side, and the tree that tells them apart.
pub(super) struct Entries {
    pub(super) cells: Vec<u32>,
    /// Its root last; empty where there are no cells.
    pub(super) tree: Box<[Part]>,
}

/// The cells along all sides of the zone, found when they are first looked for.
pub(super) struct Hull([OnceLock<Entries>; 6]);

impl Hull {
    pub(super) fn new() -> Hull {
        Hull(Default::default())
    }

    pub(super) fn of(&self, (axis, is_upper): Side, prisms: &Prisms<'_>) -> &Entries {
        self.0[2 * axis + usize::from(is_upper)].get_or_init(|| {
            if axis == 2 { level(prisms, is_upper) } else { upright(prisms, (axis, is_upper)) }
        })
    }
}

/// The cells along the bottom or the top of the zone.
fn level(prisms: &Prisms<'_>, is_upper: bool) -> Entries {
    let height = prisms.zone[usize::from(is_upper)][2];
    let is_level = |plane: u32| {
        let plane = prisms.plane(plane);
        plane.slope == [0.0; 2] && plane.height == height
    };
    let is_there = |cell: &CellRecord| {
        cell.kind != CellRecord::AROUND && is_level(if is_upper { cell.ceiling } else { cell.floor })
    };
    let cells = those(prisms, is_there);
    let tree = if cells.len() > MOST_PARTS { [Part::Unsure].into() } else { plan_tree(prisms, &cells) };
    Entries { cells, tree }
}

fn those(prisms: &Prisms<'_>, is_there: impl Fn(&CellRecord) -> bool) -> Vec<u32> {
    (0..).zip(prisms.cells).filter(|(_, cell)| is_there(cell)).map(|(index, _)| index).collect()
}

/// A part of an upright side: from where up to where along it, and the planes below and above it.
struct Piece {
    cell: u32,
    along: [f64; 2],
    planes: [u32; 2],
}

/// The cells along an upright side of the zone.
fn upright(prisms: &Prisms<'_>, (axis, is_upper): Side) -> Entries {
    let across = prisms.zone[usize::from(is_upper)][axis];
    let mut pieces = Vec::new();
    for (index, cell) in (0..).zip(prisms.cells).filter(|(_, cell)| cell.kind != CellRecord::AROUND) {
        let sides = prisms.sides_of(cell);
        for (i, side) in sides.iter().enumerate() {
            let (a, b) = (corner(side), corner(&sides[if i + 1 < sides.len() { i + 1 } else { 0 }]));
            if a[axis] == across && b[axis] == across {
                let (a, b) = (a[1 - axis], b[1 - axis]);
                let (along, planes) = ([a.min(b), a.max(b)], [cell.floor, cell.ceiling]);
                pieces.push(Piece { cell: index, along, planes });
            }
        }
    }
    let cells = pieces.iter().map(|piece| piece.cell).collect();
    let mut planting = Planting { prisms, axis, across, pieces: &pieces, parts: Vec::new() };
    if pieces.len() <= MOST_PARTS {
        planting.part(&(0..pieces.len()).collect::<Vec<_>>(), 0);
    } else {
        planting.parts.push(Part::Unsure);
    }
    Entries { tree: planting.parts.into(), cells }
}

/// A tree being made.
struct Planting<'a> {
    prisms: &'a Prisms<'a>,
    axis: usize,
    across: f64,
    pieces: &'a [Piece],
    parts: Vec<Part>,
}

impl Planting<'_> {
    /// The point of the plan so far along the side.
    fn point(&self, along: f64) -> DVec2 {
        if self.axis == 0 { DVec2::new(self.across, along) } else { DVec2::new(along, self.across) }
    }

    /// What splits the side: a vertical line so far along it (its inside is what comes before), or a plane (below it).
    fn by(&self, split: Split) -> By {
        match split {
            Split::Level(plane) => By::Level(plane),
            // Inward, what comes before on the left.
            Split::Upright(along) => {
                let (a, b) = (self.point(along), self.point(along) + self.inward());
                if (b - a).perp_dot(self.point(along - 1.0) - a) > 0.0 {
                    By::Upright([a, b])
                } else {
                    By::Upright([b, a])
                }
            }
        }
    }

    fn inward(&self) -> DVec2 {
        if self.axis == 0 { DVec2::X } else { DVec2::Y }
    }

    /// Whether a piece reaches inside, and outside, of what splits.
    fn reaches(&self, piece: &Piece, split: Split) -> [bool; 2] {
        match split {
            Split::Upright(along) => [piece.along[0] < along, piece.along[1] > along],
            Split::Level(plane) => {
                let [floor, ceiling] = piece.planes;
                let ends = piece.along.map(|along| self.point(along));
                let over = |a: u32, b: u32| {
                    a != b && ends.iter().any(|&at| self.prisms.height(a, at) > self.prisms.height(b, at))
                };
                [over(plane, floor), over(ceiling, plane)]
            }
        }
    }

    fn part(&mut self, pieces: &[usize], depth: usize) -> u32 {
        let part = match pieces {
            [piece] => Part::Cover(*piece as u32),
            _ if depth == DEEPEST => Part::Unsure,
            _ => match self.best(pieces) {
                None => Part::Unsure,
                Some(split) => {
                    let [left, right] = [0, 1].map(|side| {
                        let there = |&piece: &usize| self.reaches(&self.pieces[piece], split)[side];
                        let there: Vec<usize> = pieces.iter().copied().filter(there).collect();
                        self.part(&there, depth + 1)
                    });
                    Part::Split { by: self.by(split), right, left }
                }
            },
        };
        self.parts.push(part);
        self.parts.len() as u32 - 1
    }

    fn best(&self, pieces: &[usize]) -> Option<Split> {
        /// Of the borders of all pieces so many are looked at.
        const CHOICE: usize = 64;
        let borders = pieces.iter().flat_map(|&piece| {
            let Piece { along, planes, .. } = &self.pieces[piece];
            along.map(Split::Upright).into_iter().chain(planes.map(Split::Level))
        });
        let borders: Vec<Split> = borders.collect();
        let best = |step: usize| {
            let ranked = borders.iter().step_by(step).filter_map(|&split| {
                let (mut inside, mut outside) = (0, 0);
                for &piece in pieces {
                    let [is_in, is_out] = self.reaches(&self.pieces[piece], split);
                    (inside, outside) = (inside + usize::from(is_in), outside + usize::from(is_out));
                }
                let larger = inside.max(outside);
                (inside.min(outside) > 0 && larger < pieces.len())
                    .then_some((2 * (inside + outside) + larger, split))
            });
            ranked.min_by_key(|(rank, _)| *rank).map(|(_, split)| split)
        };
        // Odd, so that all four borders of pieces are looked at.
        let step = (borders.len() / CHOICE) | 1;
        best(step).or_else(|| if step == 1 || borders.len() > 1 << 12 { None } else { best(1) })
    }
}

#[derive(Clone, Copy)]
enum Split {
    Upright(f64),
    Level(u32),
}
