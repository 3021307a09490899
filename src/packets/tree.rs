//! What a picture shows, as a tree of straight lines.
//!
//! In each cell lines of the picture tell through which face a ray leaves: those past the footprint's corners tell the side, further ones whether the
//! floor or the ceiling comes before, and which of the side's faces. A face leads to the next cell or is shown. So cells and their faces are one tree, which
//! grows where rays come, once a picture; whoever waits at a place of it goes on from there.

use super::shot::Shot;
use crate::beam::fringe::{Fringe, Past, between};
use crate::beam::parting::Part;
use crate::beam::rows::Line;
use crate::beam::screen::Plane;
use crate::beam::shade::Shading;
use crate::beam::walk::{self as beam, To, corner};
use crate::format::records::{CellRecord, CoverRecord, SideRecord};
use crate::trace::NONE;

/// A place in the tree.
#[derive(Clone, Copy, Debug)]
pub(super) enum Node {
    /// On which side of the line `u x + v y + w = 0`, in columns and rows, a pixel is: where to go on where that is no less than 0, and
    /// where it is less. Where it is nearer to 0 than this one of the `offs`, or [`NONE`] of them, rays tell what is shown.
    Line { line: [f64; 3], off: u32, sides: [u32; 2] },
    /// From a cell, or [`NONE`], into another.
    Cell { from: u32, to: u32, next: u32 },
    /// Past these of the triangles in cells; where those go on that meet none.
    Detail { detail: u32, next: u32 },
    /// The same, where nobody came yet.
    Unknown { from: u32, to: u32 },
    /// To a part of the floor (`end` is 0) or the ceiling (1) of a cell, by the place in its own tree; nobody came there yet.
    Part { cell: u32, end: u32, at: u32 },
    /// This one of the faces.
    Face(u32),
    /// This one of the rough faces.
    Rough(u32),
    /// Nothing.
    Sky,
    /// What cells do not tell.
    Unsure,
}

/// A face that is of one colour, in one plane.
pub(super) struct Face {
    pub(super) source: u32,
    pub(super) shading: Shading,
}

/// A face that has to be asked for its triangles.
pub(super) struct Rough {
    pub(super) cell: u32,
    pub(super) source: u32,
    pub(super) plane: Plane,
}

/// Triangles in a cell, or around the prisms.
pub(super) struct Within {
    pub(super) cell: u32,
    /// Their root; none of those around the prisms.
    pub(super) root: u32,
    /// Which of the exits are the planes of the cell.
    pub(super) exits: std::ops::Range<usize>,
}

/// The place of what cells do not tell.
const UNSURE: u32 = 0;
/// The place of what lies around.
const AROUND: u32 = 1;

/// The tree of one picture.
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    /// How far lines may be off: as lines, in columns and rows.
    pub(super) offs: Vec<[f32; 3]>,
    pub(super) faces: Vec<Face>,
    pub(super) rough: Vec<Rough>,
    pub(super) details: Vec<Within>,
    pub(super) exits: Vec<Plane>,
    /// The first place in each cell, or [`NONE`] where nobody came.
    firsts: Vec<u32>,
    /// The cells that have one.
    known: Vec<u32>,
    planes: Vec<Plane>,
    columns: Vec<u32>,
}

/// A cell that is being looked at.
struct Inside<'a> {
    index: u32,
    sides: &'a [SideRecord],
    /// How far off its planes are.
    fringe: &'a Fringe,
    /// The floor and the ceiling.
    ends: [Plane; 2],
    /// Where those go on that leave through them.
    beyond: [u32; 2],
}

impl Tree {
    /// For a scene of so many cells.
    pub(super) fn new(cells: usize) -> Tree {
        let (nodes, faces, rough, details, exits) = Default::default();
        let (known, planes, columns, offs) = Default::default();
        Tree { nodes, offs, faces, rough, details, exits, firsts: vec![NONE; cells], known, planes, columns }
    }

    /// Begins anew, and says where rays start.
    pub(super) fn begin(&mut self, shot: &Shot<'_>) -> u32 {
        for cell in self.known.drain(..) {
            self.firsts[cell as usize] = NONE;
        }
        self.nodes.clear();
        self.offs.clear();
        self.faces.clear();
        self.rough.clear();
        self.details.clear();
        self.exits.clear();
        self.nodes.extend([Node::Unsure, Node::Sky]);
        let around = match shot.start {
            // From outside all triangles are asked.
            Some(beam::AROUND) => Some(shot.prisms.cells[beam::AROUND as usize].root),
            _ if shot.outer.0.is_empty() => None,
            _ => Some(NONE),
        };
        if let Some(root) = around {
            self.details.push(Within { cell: beam::AROUND, root, exits: 0..0 });
            self.nodes[AROUND as usize] = Node::Detail { detail: 0, next: 2 };
            self.nodes.push(Node::Sky);
        }
        match shot.start {
            Some(beam::AROUND) => AROUND,
            Some(cell) => self.push(Node::Unknown { from: NONE, to: cell }),
            None => UNSURE,
        }
    }

    /// A line that may be off by so much, and where to go on.
    fn line(&mut self, Line(line): Line, off: Option<Line>, sides: [u32; 2]) -> Node {
        let off = off.map_or(NONE, |Line(off)| {
            self.offs.push(off.map(|c| c as f32));
            self.offs.len() as u32 - 1
        });
        Node::Line { line, off, sides }
    }

    fn push_line(&mut self, line: Line, off: Option<Line>, sides: [u32; 2]) -> u32 {
        let node = self.line(line, off, sides);
        self.push(node)
    }

    /// The most that a line may be off by, which this one of the `offs` says, at the pixels around the middle of a packet, no farther than half its size.
    #[inline(always)]
    pub(super) fn off_at(&self, off: u32, [x, y]: [f64; 2], [half_x, half_y]: [f64; 2]) -> f64 {
        let Some(off) = self.offs.get(off as usize) else { return 0.0 };
        let [u, v, w] = off.map(f64::from);
        (u * x + v * y + w + u.abs() * half_x + v.abs() * half_y).max(0.0)
    }

    fn push(&mut self, node: Node) -> u32 {
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// Looks at a place where nobody came yet.
    #[cold]
    #[inline(never)]
    pub(super) fn grow(&mut self, shot: &Shot<'_>, at: u32) {
        self.nodes[at as usize] = match self.nodes[at as usize] {
            Node::Unknown { from, to } => Node::Cell { from, to, next: self.first(shot, to) },
            Node::Part { cell, end, at } => self.part(shot, cell, end, at),
            known => known,
        };
    }

    /// The first place in a cell.
    fn first(&mut self, shot: &Shot<'_>, cell: u32) -> u32 {
        let known = self.firsts[cell as usize];
        if known != NONE {
            return known;
        }
        let first = self.enter(shot, cell);
        self.firsts[cell as usize] = first;
        self.known.push(cell);
        first
    }

    fn enter(&mut self, shot: &Shot<'_>, index: u32) -> u32 {
        let prisms = &shot.prisms;
        let cell = &prisms.cells[index as usize];
        if cell.kind != CellRecord::AIR {
            return UNSURE;
        }
        let (sides, fringe) = (prisms.sides_of(cell), shot.fringe(index));
        let ends = [self::end(shot, index, 0), self::end(shot, index, 1)];
        let mut planes = std::mem::take(&mut self.planes);
        planes.clear();
        for (index, side) in sides.iter().enumerate() {
            let next = &sides[if index + 1 < sides.len() { index + 1 } else { 0 }];
            planes.push(shot.screen.upright(corner(side), corner(next)).off_by(fringe.of(planes.len())));
        }
        if shot.start == Some(index) {
            planes.iter_mut().for_each(|plane| *plane = plane.around_eye());
        }
        let (below, above) = prisms.covers_of(cell);
        let beyond = [self.cover(shot, index, 0, below), self.cover(shot, index, 1, above)];
        let inside = Inside { index, sides, fringe, ends, beyond };
        let next = if planes.iter().all(Plane::is_exit) {
            self.all_around(shot, &inside, &planes)
        } else {
            self.ahead(shot, &inside, &planes)
        };
        let next = match cell.root {
            NONE => next,
            root => {
                let first = self.exits.len();
                self.exits.extend(planes.iter().chain(&ends));
                self.details.push(Within { cell: index, root, exits: first..self.exits.len() });
                self.push(Node::Detail { detail: self.details.len() as u32 - 1, next })
            }
        };
        self.planes = planes;
        next
    }

    /// The eye is over the footprint, below or in it: a line past the first corner halves what can be seen, and on each half the sides follow
    /// each other.
    fn all_around(&mut self, shot: &Shot<'_>, inside: &Inside<'_>, planes: &[Plane]) -> u32 {
        let count = inside.sides.len();
        let way = |side: usize| shot.screen.past(corner(&inside.sides[side])).0;
        let Past { way: zero, line, off } = Past::new(&shot.screen, inside.sides, 0, inside.fringe);
        let last = (1..count).find(|&side| zero.perp_dot(way(side)) <= 0.0).unwrap_or(count) - 1;
        let first = (1..count).rev().find(|&side| zero.perp_dot(way(side)) >= 0.0).unwrap_or(0);
        let left = self.columns(shot, inside, planes, 0..=last);
        let right = self.columns(shot, inside, planes, first..=count - 1);
        self.push_line(line, off, [left, right])
    }

    /// The eye is beside the footprint: rays leave through those sides that face away from it.
    fn ahead(&mut self, shot: &Shot<'_>, inside: &Inside<'_>, planes: &[Plane]) -> u32 {
        let count = inside.sides.len();
        let is_exit = |side: usize| planes[side % count].is_exit();
        let Some(first) = (0..count).find(|&side| is_exit(side) && !is_exit(side + count - 1)) else {
            return UNSURE;
        };
        let more = (1..count).take_while(|more| is_exit(first + more)).count();
        self.columns(shot, inside, planes, first..=first + more)
    }

    /// Through one of some sides that follow each other counter-clockwise, as seen from the eye within half a turn: the line past the corner in the middle
    /// halves them.
    fn columns(
        &mut self,
        shot: &Shot<'_>,
        inside: &Inside<'_>,
        planes: &[Plane],
        sides: std::ops::RangeInclusive<usize>,
    ) -> u32 {
        let mut columns = std::mem::take(&mut self.columns);
        columns.clear();
        let first = *sides.start();
        columns.extend(sides.map(|side| self.column(shot, inside, planes, side % inside.sides.len())));
        let node = self.halves(shot, inside, &columns, first);
        self.columns = columns;
        node
    }

    fn halves(&mut self, shot: &Shot<'_>, inside: &Inside<'_>, columns: &[u32], first: usize) -> u32 {
        if let [column] = columns {
            return *column;
        }
        let middle = columns.len() / 2;
        let right = self.halves(shot, inside, &columns[..middle], first);
        let left = self.halves(shot, inside, &columns[middle..], first + middle);
        let side = (first + middle) % inside.sides.len();
        let Past { line, off, .. } = Past::new(&shot.screen, inside.sides, side, inside.fringe);
        self.push_line(line, off, [left, right])
    }

    /// Through one side, unless floor or ceiling come before.
    fn column(&mut self, shot: &Shot<'_>, inside: &Inside<'_>, planes: &[Plane], side: usize) -> u32 {
        let plane = &planes[side];
        let faces = shot.prisms.faces_of(&inside.sides[side]);
        let mut node = UNSURE;
        for (index, face) in faces.iter().enumerate().rev() {
            let to = To::new(face.cell, face.source, face.flags);
            let here = self.leave(shot, inside.index, plane, to);
            node = if index + 1 == faces.len() || face.top == NONE {
                here
            } else {
                let top = shot.screen.level(shot.prisms.plane(face.top), 1.0);
                let top = top.off_by(inside.fringe.of_border());
                self.push_line(top.beyond_at(plane), between(&top, plane), [node, here])
            };
        }
        for (end, beyond) in inside.ends.iter().zip(inside.beyond).rev() {
            if end.is_exit() {
                node = self.push_line(end.beyond_at(plane), between(end, plane), [beyond, node]);
            }
        }
        node
    }

    /// Through a floor or a ceiling, which these cover.
    fn cover(&mut self, shot: &Shot<'_>, cell: u32, end: u32, covers: &[CoverRecord]) -> u32 {
        if let [cover] = covers {
            return self.leave(
                shot,
                cell,
                &self::end(shot, cell, end),
                To::new(cover.cell, cover.source, cover.flags),
            );
        }
        let tree = shot.known.partings.of(cell, end == 1, &shot.prisms, covers);
        self.push(Node::Part { cell, end, at: tree.len() as u32 - 1 })
    }

    /// A place in the tree of a floor or a ceiling.
    fn part(&mut self, shot: &Shot<'_>, cell: u32, end: u32, at: u32) -> Node {
        let (below, above) = shot.prisms.covers_of(&shot.prisms.cells[cell as usize]);
        let covers = if end == 0 { below } else { above };
        let plane = self::end(shot, cell, end);
        match shot.known.partings.of(cell, end == 1, &shot.prisms, covers)[at as usize] {
            Part::Unsure => Node::Unsure,
            Part::Cover(cover) => {
                let cover = &covers[cover as usize];
                let to = To::new(cover.cell, cover.source, cover.flags);
                let place = self.leave(shot, cell, &plane, to);
                self.nodes[place as usize]
            }
            Part::Split { by, right, left } => {
                let by = shot.splitting(by).off_by(shot.fringe(cell).of_border());
                let sides = [right, left].map(|at| self.push(Node::Part { cell, end, at }));
                self.line(by.beyond_at(&plane), between(&by, &plane), sides)
            }
        }
    }

    /// Out of a cell through one part of its surface.
    fn leave(&mut self, shot: &Shot<'_>, cell: u32, plane: &Plane, to: To) -> u32 {
        let beyond = &shot.prisms.cells[to.cell as usize];
        match beyond.kind {
            CellRecord::SOLID if to.source != NONE && beyond.flags & CellRecord::HIDDEN == 0 => {
                if !to.is_plain {
                    self.rough.push(Rough { cell, source: to.source, plane: *plane });
                    return self.push(Node::Rough(self.rough.len() as u32 - 1));
                }
                self.faces.push(Face { source: to.source, shading: shot.shading(to.source, plane) });
                self.push(Node::Face(self.faces.len() as u32 - 1))
            }
            CellRecord::AIR if to.source == NONE && to.cell != cell => match self.firsts[to.cell as usize] {
                NONE => self.push(Node::Unknown { from: cell, to: to.cell }),
                next => self.push(Node::Cell { from: cell, to: to.cell, next }),
            },
            CellRecord::AROUND if to.source == NONE => AROUND,
            _ => UNSURE,
        }
    }
}

/// The plane of a cell's floor (`end` is 0) or ceiling (1).
fn end(shot: &Shot<'_>, cell: u32, end: u32) -> Plane {
    let record = &shot.prisms.cells[cell as usize];
    let (plane, up) = if end == 0 { (record.floor, -1.0) } else { (record.ceiling, 1.0) };
    let off = shot.fringe(cell).of(shot.prisms.sides_of(record).len() + end as usize);
    let plane = shot.screen.level(shot.prisms.plane(plane), up).off_by(off);
    if shot.start == Some(cell) { plane.around_eye() } else { plane }
}
