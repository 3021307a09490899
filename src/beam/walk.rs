//! From the eye's cell through its portals to all that a picture shows.
//!
//! The rays of a region of the picture leave a convex cell through one of its planes each, the first that they come to. Vertical planes through the
//! eye and the footprint's corners split the region into one part a side; then a line each tells the rays that come to the floor or the ceiling
//! before. What leads to air goes on there; all else is shown.

use glam::{DVec2, DVec3};

use super::cut::Exits;
use super::fringe::{Fringe, Fringes, Past, between};
use super::hull::{Entries, Hull, Side};
use super::kernels::Kernels;
use super::outer::Outer;
use super::parting::{By, Part, Partings};
use super::rows::{Arena, Line, Region};
use super::screen::{Plane, Screen};
use crate::format::Views;
use crate::format::records::{CellRecord, CoverRecord, PLAIN, SideRecord};
use crate::trace::{NONE, Prisms};

/// Beams that are split more often end in doubt: only files made to be slow do that.
const MOST_TASKS: usize = 1 << 18;

/// The cell around the prisms.
pub(crate) const AROUND: u32 = 0;

/// What a region of a picture shows.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Seen {
    /// A wall, floor or ceiling of a cell: what it is by its number among the sources, whether
    /// that fills it, in one plane, and the cell of air before it.
    Face { source: u32, plane: Plane, is_plain: bool, cell: u32 },
    /// Nothing at all.
    Nothing,
    /// What cells do not tell.
    Unsure,
}

/// Some triangles.
#[derive(Clone, Copy)]
pub(crate) enum Triangles<'a> {
    /// All below a root.
    Below(u32),
    /// The same, in most of the picture.
    All(u32),
    /// Those around the prisms.
    Outer(&'a Outer),
}

/// What becomes of the parts of a picture.
pub(crate) trait Paint {
    /// Takes a region: no pixel comes twice, and each of the picture comes once.
    fn paint(&mut self, arena: &Arena, region: &Region, seen: &Seen);

    /// Takes what a region shows of the triangles of a cell before its rays leave through one of the planes, of which those count that may be left
    /// through. What is painted after that in the same place is behind.
    fn detail(&mut self, arena: &Arena, region: &Region, of: (u32, Triangles<'_>), exits: Exits<'_>);

    /// Takes pixels of a row, from one column up to another, of which rays are to tell what they show behind the detail so far, if any: a line passes them nearer than
    /// cells are rounded. They may come several times, and are painted besides.
    fn edge(&mut self, row: i32, columns: [i32; 2]);

    /// Whether all pixels of a region show detail before whatever comes now.
    fn is_hidden(&self, arena: &Arena, region: &Region) -> bool;
}

/// A region of the picture whose rays are in a cell.
struct Task {
    cell: u32,
    /// The cell that they came from, or [`NONE`].
    from: u32,
    region: Region,
    /// How much of the arena it needs.
    top: usize,
}

/// What is kept from picture to picture, to be used again.
pub(super) struct Space {
    arena: Arena,
    tasks: Vec<Task>,
    planes: Vec<Plane>,
    pub(super) cells: u64,
}

impl Space {
    pub(super) fn new() -> Space {
        Space { arena: Arena::new(), tasks: Vec::new(), planes: Vec::new(), cells: 0 }
    }
}

/// A picture under way.
pub(super) struct Walker<'a, P> {
    tables: &'a Views,
    prisms: Prisms<'a>,
    screen: &'a Screen,
    kernels: Kernels,
    space: &'a mut Space,
    paint: &'a mut P,
    known: &'a Known,
    /// What lies around the prisms.
    around: Around<'a>,
}

/// What is kept of the cells of a scene.
pub(crate) struct Known {
    pub(crate) partings: Partings,
    pub(crate) fringes: Fringes,
}

impl Known {
    /// Of so many.
    pub(crate) fn new(cells: usize) -> Known {
        Known { partings: Partings::new(cells), fringes: Fringes::new(cells) }
    }
}

/// What lies around the prisms.
#[derive(Clone, Copy)]
pub(super) enum Around<'a> {
    /// These; the eye is in the zone of the prisms.
    Outer(&'a Outer),
    /// These; the eye is outside of the zone, which rays enter through its sides.
    Entered(&'a Outer, &'a Hull),
    /// All triangles, whose root this is: there are no prisms, or the eye is between them.
    All(u32),
}

impl<'a, P: Paint> Walker<'a, P> {
    pub(super) fn new(
        tables: &'a Views,
        screen: &'a Screen,
        kernels: Kernels,
        space: &'a mut Space,
        paint: &'a mut P,
        (known, around): (&'a Known, Around<'a>),
    ) -> Self {
        Walker { tables, prisms: Prisms::new(tables), screen, kernels, space, paint, known, around }
    }

    /// Paints the band of rows from `first` up to `end` of a picture of this size, pixels, as seen from the cell `start`, which holds the eye, if one does.
    pub(super) fn band(&mut self, size: [u32; 2], [first, end]: [i32; 2], start: Option<u32>) {
        let region = self.space.arena.begin(size[0] as i32, first, end);
        self.space.tasks.clear();
        self.space.cells = 0;
        let Some(start) = start else {
            self.show(region, Seen::Unsure);
            return;
        };
        match self.around {
            Around::Entered(_, hull) => self.enter(region, hull),
            _ => self.push(start, NONE, region),
        }
        let mut count = 0;
        while let Some(task) = self.space.tasks.pop() {
            self.space.arena.forget(task.top);
            if task.from != NONE && self.paint.is_hidden(&self.space.arena, &task.region) {
                continue;
            }
            count += 1;
            if count > MOST_TASKS {
                self.show(task.region, Seen::Unsure);
                continue;
            }
            self.through(&task);
        }
        self.space.cells = count as u64;
    }

    fn push(&mut self, cell: u32, from: u32, region: Region) {
        let top = self.space.arena.top();
        self.space.tasks.push(Task { cell, from, region, top });
    }

    fn show(&mut self, region: Region, seen: Seen) {
        self.paint.paint(&self.space.arena, &region, &seen);
    }

    fn split(&mut self, region: Region, line: Line) -> (Option<Region>, Option<Region>) {
        self.space.arena.split(&self.kernels, region, line)
    }

    /// The same by a line of the cell that is looked at, which may be off by so much.
    fn split_off(
        &mut self,
        region: Region,
        line: Line,
        off: Option<Line>,
    ) -> (Option<Region>, Option<Region>) {
        if let Some(off) = off {
            let paint = &mut *self.paint;
            self.space.arena.near(&self.kernels, region, (line, off), &mut |row, columns| {
                paint.edge(row, columns);
            });
        }
        self.split(region, line)
    }

    /// Where rays that leave through one plane do so outside, and inside, of another.
    fn split_at(&mut self, region: Region, other: &Plane, exit: &Plane) -> (Option<Region>, Option<Region>) {
        self.split_off(region, other.beyond_at(exit), between(other, exit))
    }

    /// Where rays pass a corner on the left, and on the right.
    fn split_past(&mut self, region: Region, past: &Past) -> (Option<Region>, Option<Region>) {
        self.split_off(region, past.line, past.off)
    }

    /// The floor (`up` is -1) or ceiling (1) of a cell.
    fn level(&self, plane: u32, up: f64) -> Plane {
        self.screen.level(self.prisms.plane(plane), up)
    }

    /// The upright plane over a side, which goes from `a` to `b`.
    fn upright(&self, a: DVec2, b: DVec2) -> Plane {
        self.screen.upright(a, b)
    }

    /// What the rays of a region meet around the prisms. No triangle within is met by them, or they would not have come there.
    fn outside(&mut self, region: Region) {
        self.draw_around(&region, &[]);
        self.show(region, Seen::Nothing);
    }

    /// What lies around the prisms, as far as a region's rays come to it before some planes.
    fn draw_around(&mut self, region: &Region, before: &[Plane]) {
        let triangles = match self.around {
            Around::Outer(outer) | Around::Entered(outer, _) => Triangles::Outer(outer),
            Around::All(root) => Triangles::All(root),
        };
        self.paint.detail(&self.space.arena, region, (AROUND, triangles), Exits(before));
    }

    /// The rays of a region, which come from outside: into the zone of the prisms, or past it. They enter it through one of those sides
    /// that the eye is outside of, inside of all others.
    fn enter(&mut self, region: Region, hull: &Hull) {
        let sides = [0, 1, 2].into_iter().flat_map(|axis| [(axis, false), (axis, true)]);
        let planes: Vec<(Side, Plane)> = sides.map(|side| (side, self.side(side))).collect();
        let mut rest = vec![region];
        for (i, &(side, plane)) in planes.iter().enumerate().filter(|(_, (_, plane))| !plane.is_exit()) {
            let mut next = Vec::new();
            for region in std::mem::take(&mut rest) {
                let (mut entering, away) = self.split(region, plane.ahead());
                next.extend(away);
                for (k, (_, other)) in planes.iter().enumerate() {
                    let Some(region) = entering.filter(|_| k != i) else { continue };
                    // The other way round than for rays that leave.
                    let (inside, outside) = self.split(region, other.beyond_at(&plane));
                    next.extend(outside);
                    entering = inside;
                    if entering.is_none() {
                        break;
                    }
                }
                let Some(region) = entering else { continue };
                self.draw_around(&region, &[plane.turned()]);
                let entries = hull.of(side, &self.prisms);
                match entries.tree.len() {
                    0 => self.show(region, Seen::Unsure),
                    count => self.enter_part(&plane, entries, count - 1, region),
                }
            }
            rest = next;
        }
        rest.into_iter().for_each(|region| self.outside(region));
    }

    /// A side of the zone.
    fn side(&self, (axis, is_upper): Side) -> Plane {
        let sign = if is_upper { 1.0 } else { -1.0 };
        let away = self.screen.eye[axis] - self.prisms.zone[usize::from(is_upper)][axis];
        self.screen.plane(DVec3::AXES[axis] * sign, away * sign)
    }

    /// Rays that enter the zone through one of its sides, by the tree of its parts from one place on.
    fn enter_part(&mut self, plane: &Plane, entries: &Entries, at: usize, region: Region) {
        match entries.tree[at] {
            Part::Unsure => self.show(region, Seen::Unsure),
            Part::Cover(index) => {
                let cell = entries.cells[index as usize];
                match self.prisms.cells[cell as usize].kind {
                    CellRecord::AIR => self.push(cell, AROUND, region),
                    _ => self.show(region, Seen::Unsure),
                }
            }
            Part::Split { by, right, left } => {
                let (inner, outer) = self.split(region, self.splitting(by).beyond_at(plane));
                for (region, at) in [(outer, right), (inner, left)] {
                    if let Some(region) = region {
                        self.enter_part(plane, entries, at as usize, region);
                    }
                }
            }
        }
    }

    /// The plane that splits a surface.
    fn splitting(&self, by: By) -> Plane {
        match by {
            By::Upright([a, b]) => self.upright(a, b),
            By::Level(plane) => self.level(plane, 1.0),
        }
    }

    /// What the rays of a region do in a cell.
    fn through(&mut self, task: &Task) {
        let prisms = self.prisms;
        let cell = &prisms.cells[task.cell as usize];
        if cell.kind != CellRecord::AIR {
            self.outside(task.region);
            return;
        }
        let fringe = self.known.fringes.of(self.tables, task.cell);
        let sides = prisms.sides_of(cell);
        let holds_eye = task.from == NONE;
        let settle = |plane: Plane| if holds_eye { plane.around_eye() } else { plane };
        let floor = settle(self.level(cell.floor, -1.0)).off_by(fringe.of(sides.len()));
        let ceiling = settle(self.level(cell.ceiling, 1.0)).off_by(fringe.of(sides.len() + 1));
        let mut planes = std::mem::take(&mut self.space.planes);
        planes.clear();
        for (index, side) in sides.iter().enumerate() {
            let next = &sides[if index + 1 < sides.len() { index + 1 } else { 0 }];
            planes.push(settle(self.upright(corner(side), corner(next))).off_by(fringe.of(index)));
        }
        planes.extend([floor, ceiling]);
        if cell.root != NONE {
            self.paint.detail(
                &self.space.arena,
                &task.region,
                (task.cell, Triangles::Below(cell.root)),
                Exits(&planes),
            );
        }
        planes.truncate(sides.len());
        let inside = In { task, cell, sides, planes: &planes, ends: [floor, ceiling], fringe };
        if planes.iter().all(Plane::is_exit) {
            self.all_around(&inside);
        } else {
            self.ahead(&inside);
        }
        self.space.planes = planes;
    }

    /// The corner at which a side begins.
    fn past(&self, inside: &In<'_>, side: usize) -> Past {
        Past::new(self.screen, inside.sides, side, inside.fringe)
    }

    /// The eye is over the footprint, below or in it: a plane through the first corner halves what can be seen, and on each half the sides follow
    /// each other.
    fn all_around(&mut self, inside: &In<'_>) {
        let count = inside.sides.len();
        let past = self.past(inside, 0);
        let (zero, (left, right)) = (past.way, self.split_past(inside.task.region, &past));
        let mut rest = left;
        for side in 0..count {
            let Some(region) = rest else { break };
            let next = if side + 1 < count { side + 1 } else { 0 };
            let past = self.past(inside, next);
            if next == 0 || zero.perp_dot(past.way) <= 0.0 {
                self.column(inside, side, region);
                break;
            }
            let (beyond, before) = self.split_past(region, &past);
            before.into_iter().for_each(|before| self.column(inside, side, before));
            rest = beyond;
        }
        let mut rest = right;
        for side in (0..count).rev() {
            let Some(region) = rest else { break };
            let past = self.past(inside, side);
            if side == 0 || zero.perp_dot(past.way) >= 0.0 {
                self.column(inside, side, region);
                break;
            }
            let (before, beyond) = self.split_past(region, &past);
            before.into_iter().for_each(|before| self.column(inside, side, before));
            rest = beyond;
        }
    }

    /// The eye is beside the footprint: rays leave through those sides that face away from it.
    fn ahead(&mut self, inside: &In<'_>) {
        let count = inside.sides.len();
        let is_exit = |side: usize| inside.planes[side % count].is_exit();
        let Some(first) = (0..count).find(|&side| is_exit(side) && !is_exit(side + count - 1)) else {
            self.show(inside.task.region, Seen::Unsure);
            return;
        };
        let mut region = inside.task.region;
        for side in first..first + count {
            let next = (side + 1) % count;
            if !is_exit(next) {
                self.column(inside, side % count, region);
                return;
            }
            let past = self.past(inside, next);
            let (beyond, before) = self.split_past(region, &past);
            before.into_iter().for_each(|before| self.column(inside, side % count, before));
            let Some(beyond) = beyond else { return };
            region = beyond;
        }
    }

    /// Rays that leave through one side, unless they come to the floor or the ceiling before.
    fn column(&mut self, inside: &In<'_>, side: usize, region: Region) {
        let plane = inside.planes[side];
        let mut rest = Some(region);
        let (below, above) = self.prisms.covers_of(inside.cell);
        for (end, covers) in [below, above].into_iter().enumerate() {
            let Some(region) = rest else { return };
            if !inside.ends[end].is_exit() {
                continue;
            }
            let (first, later) = self.split_at(region, &inside.ends[end], &plane);
            if let Some(first) = first {
                self.cover(inside, end, covers, first);
            }
            rest = later;
        }
        let Some(mut region) = rest else { return };
        let faces = self.prisms.faces_of(&inside.sides[side]);
        for (index, face) in faces.iter().enumerate() {
            let to = To::new(face.cell, face.source, face.flags);
            if index + 1 == faces.len() || face.top == NONE {
                self.leave(inside, &plane, to, region);
                return;
            }
            let top = self.level(face.top, 1.0).off_by(inside.fringe.of_border());
            let (above, under) = self.split_at(region, &top, &plane);
            under.into_iter().for_each(|under| self.leave(inside, &plane, to, under));
            let Some(above) = above else { return };
            region = above;
        }
    }

    /// Rays that leave through a floor or a ceiling, which these cover.
    fn cover(&mut self, inside: &In<'_>, end: usize, covers: &[CoverRecord], region: Region) {
        let plane = &inside.ends[end];
        if let [cover] = covers {
            self.leave(inside, plane, To::new(cover.cell, cover.source, cover.flags), region);
            return;
        }
        let tree = self.known.partings.of(inside.task.cell, end == 1, &self.prisms, covers);
        self.part(inside, plane, (tree, tree.len() - 1), covers, region);
    }

    /// The same, by the tree of its parts from one place on.
    fn part(
        &mut self,
        inside: &In<'_>,
        plane: &Plane,
        (tree, at): (&[Part], usize),
        covers: &[CoverRecord],
        region: Region,
    ) {
        match tree[at] {
            Part::Unsure => self.show(region, Seen::Unsure),
            Part::Cover(cover) => {
                let cover = &covers[cover as usize];
                self.leave(inside, plane, To::new(cover.cell, cover.source, cover.flags), region);
            }
            Part::Split { by, right, left } => {
                let by = self.splitting(by).off_by(inside.fringe.of_border());
                let (outer, inner) = self.split_at(region, &by, plane);
                for (region, at) in [(outer, right), (inner, left)] {
                    if let Some(region) = region {
                        self.part(inside, plane, (tree, at as usize), covers, region);
                    }
                }
            }
        }
    }

    /// Rays that leave a cell through one part of its surface.
    fn leave(&mut self, inside: &In<'_>, plane: &Plane, to: To, region: Region) {
        let (cell, To { cell: beyond, source, is_plain }) = (inside.task.cell, to);
        let next = &self.prisms.cells[beyond as usize];
        let seen = match next.kind {
            CellRecord::SOLID if source != NONE && next.flags & CellRecord::HIDDEN == 0 => {
                Seen::Face { source, plane: *plane, is_plain, cell }
            }
            CellRecord::AIR if source == NONE && beyond != inside.task.from => {
                self.push(beyond, cell, region);
                return;
            }
            CellRecord::AROUND if source == NONE => {
                self.outside(region);
                return;
            }
            _ => Seen::Unsure,
        };
        self.show(region, seen);
    }
}

/// What is beyond a part of a cell's surface.
#[derive(Clone, Copy)]
pub(crate) struct To {
    pub(crate) cell: u32,
    /// Between air and matter: what rays meet there, or none.
    pub(crate) source: u32,
    /// Whether that fills the part, in one plane.
    pub(crate) is_plain: bool,
}

impl To {
    pub(crate) fn new(cell: u32, source: u32, flags: u16) -> To {
        To { cell, source, is_plain: flags & PLAIN != 0 }
    }
}

/// A cell, and the region whose rays are in it.
struct In<'a> {
    task: &'a Task,
    cell: &'a CellRecord,
    sides: &'a [SideRecord],
    planes: &'a [Plane],
    ends: [Plane; 2],
    fringe: &'a Fringe,
}

pub(crate) fn corner(side: &SideRecord) -> DVec2 {
    DVec2::from(side.start.map(f64::from))
}
