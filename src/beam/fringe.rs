//! Pixels so near to an edge of a cell that rays tell what they show: cells are rounded to the lattice, and walls that lean by less than the tolerance to
//! upright ones.
//!
//! How far a cell is off what it was cut around is measured once, when a beam first comes there. Where that is nothing, as in models whose corners are on
//! the lattice, lines of the picture are exact, and no pixel is near enough.

use std::sync::OnceLock;

use glam::{DVec2, DVec3};

use super::rows::{Line, free_parts};
use super::screen::{Off, Plane, Screen};
use super::shade::{Show, UNSURE};
use super::walk::corner;
use crate::format::Views;
use crate::format::records::{CellRecord, PLAIN, PlaneRecord, SideRecord, SourceRecord};
use crate::trace::{NONE, Prisms};

/// What cells are off by less, metres, is rounding.
const EXACT: f64 = 1e-8;

/// A line of a cell may stand for an edge where planes meet that are not this cell's: that is off by no more than so many times as far as these, if they meet at an
/// angle of 60 to 120 degrees; at right angles by the root of two. Flatter and sharper ones may be off by more.
const AT_EDGES: f64 = 2.0;

/// How far the planes of each cell are off.
pub(crate) struct Fringes {
    /// Metres, by a cell's own faces alone.
    own: Vec<OnceLock<f64>>,
    /// By those of the cells around it, too.
    all: Vec<OnceLock<Fringe>>,
}

impl Fringes {
    /// Of so many cells.
    pub(crate) fn new(cells: usize) -> Fringes {
        Fringes { own: vec![OnceLock::new(); cells], all: vec![OnceLock::new(); cells] }
    }

    /// All of them exact.
    #[cfg(test)]
    pub(super) fn exact(cells: usize) -> Fringes {
        let exact = vec![OnceLock::from(Fringe::default()); cells];
        Fringes { all: exact, ..Fringes::new(cells) }
    }

    /// How far the planes of a cell of air are off what it was cut around; those of other cells are exact. Where a wall of it ends at a portal, the wall
    /// that it ends at may be that of the cell beyond.
    pub(crate) fn of(&self, tables: &Views, cell: u32) -> &Fringe {
        self.all[cell as usize].get_or_init(|| {
            let cells = &tables.cells;
            let record = &cells[cell as usize];
            if record.kind != CellRecord::AIR {
                return Fringe::default();
            }
            let (prisms, mut has_faces) = (Prisms::new(tables), false);
            let own = |cell: u32| *self.own[cell as usize].get_or_init(|| off(tables, &cells[cell as usize]));
            let mut most = own(cell);
            for (beyond, source, _) in prisms.beyond(record) {
                has_faces |= source != NONE;
                if source == NONE && cells[beyond as usize].kind == CellRecord::AIR {
                    most = most.max(own(beyond));
                }
            }
            // Between portals all that matters is told where they lead.
            if has_faces && most > 0.0 { Fringe::new(most, &prisms, record) } else { Fringe::default() }
        })
    }
}

/// How far a cell of air is off by its own faces.
fn off(tables: &Views, cell: &CellRecord) -> f64 {
    let prisms = Prisms::new(tables);
    let (sides, step) = (prisms.sides_of(cell), tables.scene[0].lattice_step());
    let ends = [cell.floor, cell.ceiling].map(|plane| prisms.plane(plane));
    let over =
        |plane: &PlaneRecord, p: DVec2| p.extend(plane.slope[0] * p.x + plane.slope[1] * p.y + plane.height);
    let at = |plane: &PlaneRecord, side: usize| over(plane, corner(&sides[side % sides.len()]));
    let (mut most, mut is_off) = (0.0f64, false);
    // What a face is cut around, and the face's corners, or those of what it is part of.
    let mut look = |source: u32, flags: u16, corners: &mut dyn Iterator<Item = DVec3>| {
        if source == NONE {
            return;
        }
        let SourceRecord { first, count, plane, .. } = tables.sources[source as usize];
        let corners_of = |triangle: u32| {
            tables.triangles[triangle as usize]
                .map(|v| prisms.local(DVec3::from(tables.vertices[v as usize])))
        };
        // Where what is met ends may be off, too.
        let few = &tables.surfaces[first as usize..][..count.min(SourceRecord::FEW) as usize];
        let is_on_lattice = |p: DVec3| (p - (p / step).round() * step).abs().max_element() <= EXACT;
        is_off |= !few.iter().all(|&triangle| corners_of(triangle).into_iter().all(is_on_lattice));
        // Off a triangle that is a line it is no number, which is neither less nor more than others.
        let off_plane = |triangle: u32, corner: DVec3| {
            let [a, b, c] = corners_of(triangle);
            (corner - a).dot((b - a).cross(c - a).normalize()).abs()
        };
        if flags & PLAIN != 0 && plane != NONE {
            most = corners.fold(most, |most, corner| most.max(off_plane(plane, corner)));
            return;
        }
        // Of a face that is not in one plane that of one of its triangles says nothing: that of the nearest tells.
        let nearest = |corner: DVec3| {
            few.iter().map(|&triangle| off_plane(triangle, corner)).fold(tables.scene[0].tolerance, f64::min)
        };
        most = corners.map(nearest).fold(most.max(prisms.rounding()), f64::max);
    };
    for (index, side) in sides.iter().enumerate() {
        for face in prisms.faces_of(side) {
            let ends = ends.iter();
            let mut corners = ends.flat_map(|end| [at(end, index), at(end, index + 1)]);
            look(face.source, face.flags, &mut corners);
        }
    }
    // Each of the parts of a floor or a ceiling as if it were all of the box around it: of many parts and sides there are no pairs.
    let corners = || sides.iter().map(corner);
    let (lo, hi) =
        corners().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), c| (lo.min(c), hi.max(c)));
    let (below, above) = prisms.covers_of(cell);
    for (end, covers) in ends.iter().zip([below, above]) {
        let around = [lo, hi, DVec2::new(lo.x, hi.y), DVec2::new(hi.x, lo.y)].map(|p| over(end, p));
        for cover in covers {
            look(cover.source, cover.flags, &mut around.into_iter());
        }
    }
    if most > EXACT || is_off { most.max(0.5 * step) } else { 0.0 }
}

/// How far the planes of a cell are off what it was cut around.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fringe {
    /// Its faces, metres.
    off: f64,
    /// Each of its planes, those of its sides first, then its floor's and its ceiling's; none if all are exact.
    planes: Box<[Meets]>,
}

/// What rays meet in a plane of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Meets {
    Faces,
    /// Nothing: all go on.
    Portals,
    Both,
}

impl Meets {
    /// By whether rays go on through each part of the plane.
    fn of(parts: impl Iterator<Item = bool>) -> Meets {
        let (mut any, mut all) = (false, true);
        for goes_on in parts {
            any |= goes_on;
            all &= goes_on;
        }
        match (any, all) {
            (_, true) => Meets::Portals,
            (true, _) => Meets::Both,
            _ => Meets::Faces,
        }
    }
}

impl Fringe {
    /// Of a cell whose faces are off by so much, metres.
    fn new(off: f64, prisms: &Prisms<'_>, cell: &CellRecord) -> Fringe {
        let goes_on = |beyond: u32, source: u32| {
            source == NONE && prisms.cells[beyond as usize].kind != CellRecord::SOLID
        };
        let sides = prisms
            .sides_of(cell)
            .iter()
            .map(|side| Meets::of(prisms.faces_of(side).iter().map(|face| goes_on(face.cell, face.source))));
        let (below, above) = prisms.covers_of(cell);
        let ends = [below, above]
            .into_iter()
            .map(|covers| Meets::of(covers.iter().map(|cover| goes_on(cover.cell, cover.source))));
        Fringe { off, planes: sides.chain(ends).collect() }
    }

    /// How far its faces are off, metres.
    #[cfg(test)]
    pub(super) fn of_faces(&self) -> f64 {
        self.off
    }

    /// What stands for an edge where planes meet that are not this cell's, as where a wall ends beyond a portal.
    fn at_border(&self) -> f64 {
        AT_EDGES * self.off
    }

    /// A plane at which one face of the cell ends and another begins.
    pub(crate) fn of_border(&self) -> Off {
        Off { at_edges: self.at_border(), faces: 0.0 }
    }

    /// The plane of this one of the cell's sides, or, after these, of its floor and its ceiling.
    pub(crate) fn of(&self, plane: usize) -> Off {
        match self.planes.get(plane) {
            None => Off::default(),
            Some(Meets::Faces) => Off { at_edges: self.off, faces: self.off },
            Some(Meets::Both) => Off { at_edges: self.at_border(), faces: self.off },
            Some(Meets::Portals) => self.of_border(),
        }
    }

    /// By how much the line [past](Screen::past) the corner at which a side begins may be another at a pixel, as a line; `None` if it is exact. It grows with how fast the
    /// pixel's ray goes toward the corner, and is negative where that goes away from it.
    fn past(&self, screen: &Screen, sides: &[SideRecord], side: usize, way: DVec2) -> Option<Line> {
        if self.planes.is_empty() {
            return None;
        }
        let before = if side == 0 { sides.len() - 1 } else { side - 1 };
        let meeting = [before, side].map(|side| {
            let next = if side + 1 < sides.len() { side + 1 } else { 0 };
            (corner(&sides[next]) - corner(&sides[side]), self.planes[side] == Meets::Faces)
        });
        let off = match meeting {
            [(one, true), (other, true)] => meeting_off(self.off, [one, other], way),
            // A wall may end there that is not this cell's.
            _ => [self.at_border(); 2],
        };
        Some(past_by(screen, way, off))
    }
}

/// How far the corner of two walls, which go these ways, is off across a way, and along it, if each is off by so much.
fn meeting_off(off: f64, walls: [DVec2; 2], way: DVec2) -> [f64; 2] {
    /// The sine of the angle at which they are taken to meet at least: what is flatter is a corner because it is rounded to one.
    const SHARP: f64 = 0.5;
    let [one, other] = walls.map(DVec2::normalize_or_zero);
    let (ahead, sine) = (way.normalize_or_zero(), one.perp_dot(other).abs());
    // A wall moved along its normal moves the corner along the other one.
    let share = |of: f64, by: f64| off * (of.abs() + by.abs()) / sine.max(SHARP);
    let across = share(one.perp_dot(ahead), other.perp_dot(ahead));
    let along = share(one.dot(ahead), other.dot(ahead));
    let least = if sine < SHARP { AT_EDGES * off } else { 0.0 };
    [across.max(least), along.max(least)]
}

/// By how much the line past a corner, to which this is the way, may be another at a pixel, if that is so far off across the way and along it.
fn past_by(screen: &Screen, way: DVec2, [across, along]: [f64; 2]) -> Line {
    // As seen from the eye it is the farther off the nearer it may be.
    let nearer = (along / way.length()).min(0.9);
    Line(screen.along((way.normalize_or_zero() * (across / (1.0 - nearer))).extend(0.0)))
}

/// A corner of a cell as a picture sees it.
pub(crate) struct Past {
    /// The way to it, seen from above.
    pub(crate) way: DVec2,
    /// Rays to the left of it are on this line's positive side.
    pub(crate) line: Line,
    /// By how much that may be another, as a line; `None` if it is exact.
    pub(crate) off: Option<Line>,
}

impl Past {
    /// The corner at which one of these sides of a cell begins.
    pub(crate) fn new(screen: &Screen, sides: &[SideRecord], side: usize, fringe: &Fringe) -> Past {
        let (way, line) = screen.past(corner(&sides[side]));
        Past { way, line, off: fringe.past(screen, sides, side, way) }
    }
}

/// By how much the line where two planes meet, as [`Plane::beyond_at`] has it, may be another at a pixel, as a line; `None` if it is exact. It is negative at pixels
/// whose rays come to neither plane: that line is not there. The eye is farther from each than that is off.
///
/// Moved by `d` along its normal a plane changes that line, at each pixel, by `d` times the normal's size, times how the other plane grows there: no matter at which angle
/// they meet, how far away, and from where that is seen.
pub(crate) fn between(one: &Plane, other: &Plane) -> Option<Line> {
    if one.off.at_edges == 0.0 && other.off.at_edges == 0.0 {
        return None;
    }
    // What a ray comes to grows nearer along it.
    let share = |of: &Plane, to: &Plane| -(of.off.at_edges * of.size).copysign(to.away);
    let [by_one, by_other] = [share(one, other), share(other, one)];
    Some(Line([0, 1, 2].map(|i| by_one * other.grows[i] + by_other * one.grows[i])))
}

/// Pixels of a picture so near to an edge that rays are to tell what they show: parts of rows.
#[derive(Debug, Default)]
pub(crate) struct Edges {
    /// Row, and from where up to where; they may overlap.
    parts: Vec<[i32; 3]>,
    /// How many there were when they last were put together.
    together: usize,
}

impl Edges {
    /// Adds those from one column of a row up to another that are not taken.
    pub(crate) fn add(&mut self, row: i32, columns: [i32; 2], is_taken: impl Fn(i32) -> bool) {
        free_parts(row, columns, is_taken, |part| self.push(part));
    }

    /// Adds those from one column of a row up to another.
    pub(crate) fn push(&mut self, part: [i32; 3]) {
        /// Fewer may wait.
        const FEW: usize = 1 << 16;
        let [row, from, to] = part;
        match self.parts.last_mut() {
            Some([last, _, end]) if (*last, *end) == (row, from) => *end = to,
            _ if from < to => self.parts.push(part),
            _ => {}
        }
        // Lines that pass the same pixels again and again fill no memory.
        if self.parts.len() > FEW.max(2 * self.together) {
            self.put_together();
        }
    }

    /// Adds all of others, which are forgotten there.
    pub(crate) fn append(&mut self, others: &mut Edges) {
        self.parts.append(&mut others.parts);
        others.together = 0;
    }

    /// Sorts the parts, so that none overlap.
    fn put_together(&mut self) {
        self.parts.sort_unstable();
        self.parts.dedup_by(|next, last| {
            let overlaps = next[0] == last[0] && next[1] <= last[2];
            if overlaps {
                last[2] = last[2].max(next[2]);
            }
            overlaps
        });
        self.together = self.parts.len();
    }

    /// Those of the pixels of a picture so many wide, which is made but for them, beside which something else is shown, each once, as parts of rows: colours that
    /// differ by a step are one. Where numbers are told they become [`UNSURE`]; those that are already are not among them.
    pub(crate) fn asked(mut self, pixels: &mut [u32], width: usize, show: Show) -> Vec<[i32; 3]> {
        self.put_together();
        let at = |row: i32, column: i32| row as usize * width + column as usize;
        let is_asked = |&[row, column, _]: &[i32; 3]| {
            let at = at(row, column);
            (show == Show::Light || pixels[at] != UNSURE) && is_border(pixels, width, at, show)
        };
        let each = self.parts.iter().flat_map(|&[row, from, to]| (from..to).map(move |x| [row, x, x + 1]));
        let asked: Vec<[i32; 3]> = each.filter(is_asked).collect();
        if show != Show::Light {
            asked.iter().for_each(|&[row, column, _]| pixels[at(row, column)] = UNSURE);
        }
        asked
    }
}

/// Whether a pixel beside this one shows something else.
fn is_border(pixels: &[u32], width: usize, at: usize, show: Show) -> bool {
    let own = pixels[at];
    let is_same = |beside: usize| {
        let other = pixels[beside];
        let differs = |(a, b): (u8, u8)| a.abs_diff(b) > 1;
        own == other
            || show == Show::Light && !own.to_le_bytes().into_iter().zip(other.to_le_bytes()).any(differs)
    };
    !around(width, pixels.len(), at).all(is_same)
}

/// The pixels beside one of a picture so many pixels wide, which has so many.
pub(super) fn around(width: usize, count: usize, index: usize) -> impl Iterator<Item = usize> + Clone {
    let left = (!index.is_multiple_of(width)).then(|| index - 1);
    let right = (!(index + 1).is_multiple_of(width)).then(|| index + 1);
    let below = Some(index + width).filter(|&below| below < count);
    [left, right, index.checked_sub(width), below].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A picture by an eye in the origin.
    const SCREEN: Screen = Screen {
        eye: DVec3::ZERO,
        first: DVec3::new(0.9, 0.5, 0.45),
        across: DVec3::new(0.0, -0.02, 0.001),
        down: DVec3::new(0.001, 0.0, -0.02),
    };

    fn at(Line([u, v, w]): Line, [x, y]: [f64; 2]) -> f64 {
        u * x + v * y + w
    }

    fn pixels() -> impl Iterator<Item = [f64; 2]> {
        (0..50).flat_map(|y| (0..50).map(move |x| [f64::from(x), f64::from(y)]))
    }

    proptest! {
        /// Where a line is farther from 0 than what it may be off by, planes that are off by no more leave no pixel on its other side.
        #[test]
        fn planes_that_are_off_keep_what_is_no_edge(
            normals in prop::array::uniform2([-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0]),
            (pixel, t) in ([0.0f64..49.0, 0.0f64..49.0], 1.0f64..9.0),
            offs in prop::array::uniform2(0.0f64..0.5),
            shares in prop::array::uniform2(prop::sample::select(vec![-1.0, 0.4, 1.0])),
        ) {
            let normals = normals.map(DVec3::from);
            // They meet where this pixel's ray is at t.
            let away = normals.map(|normal| -t * at(Line(SCREEN.along(normal)), pixel));
            let sizes = normals.map(DVec3::length);
            prop_assume!(sizes.iter().all(|size| *size > 0.1));
            // The eye stays on the same side of both.
            prop_assume!([0, 1].iter().all(|&i| away[i].abs() > offs[i] * sizes[i]));
            let plane = |i: usize, share: f64| {
                SCREEN.plane(normals[i], away[i] + share * offs[i] * sizes[i]).off_by(Off { at_edges: offs[i], faces: 0.0 })
            };
            let [exit, other] = [plane(0, 0.0), plane(1, 0.0)];
            let [moved_exit, moved_other] = [plane(0, shares[0]), plane(1, shares[1])];
            let (line, off) = (other.beyond_at(&exit), between(&other, &exit).unwrap());
            let moved = moved_other.beyond_at(&moved_exit);
            for pixel in pixels() {
                // Of a ray that comes to none of them nothing is said: it leaves through others.
                let comes_to = |plane: &Plane| at(Line(plane.grows), pixel) * plane.away < 0.0;
                if comes_to(&exit) && comes_to(&other) && at(line, pixel).abs() > at(off, pixel) * (1.0 + 1e-9) {
                    prop_assert_eq!(at(line, pixel) > 0.0, at(moved, pixel) > 0.0, "{:?}", pixel);
                }
            }
        }

        /// The same of a line past the corner of two upright planes.
        #[test]
        fn sides_that_are_off_keep_what_is_past_no_corner(
            corner in [1.0f64..9.0, -5.0f64..5.0],
            turns in prop::array::uniform2(0.0f64..6.2),
            off in 0.0f64..0.05,
            shares in prop::array::uniform2(prop::sample::select(vec![-1.0, 0.4, 1.0])),
        ) {
            let (corner, sides) = (DVec2::from(corner), turns.map(DVec2::from_angle));
            let sine = sides[0].perp_dot(sides[1]);
            prop_assume!(sine.abs() > 0.5 && off > 0.0);
            let (way, line) = SCREEN.past(corner);
            let past = past_by(&SCREEN, way, meeting_off(off, sides, way));
            // Each of the sides along its normal.
            let moved = corner + (sides[1] * shares[0] - sides[0] * shares[1]) * (off / sine);
            let (_, moved) = SCREEN.past(moved);
            for pixel in pixels() {
                let ahead = SCREEN.along(way.extend(0.0));
                if at(Line(ahead), pixel) > 0.0 && at(line, pixel).abs() > at(past, pixel) * (1.0 + 1e-9) {
                    prop_assert_eq!(at(line, pixel) > 0.0, at(moved, pixel) > 0.0, "{:?}", pixel);
                }
            }
        }
    }

    #[test]
    fn pixels_that_come_again_and_again_fill_no_memory() {
        let mut edges = Edges::default();
        for round in 0..1000 {
            (0..300).for_each(|row| edges.push([row, round % 7, 9 + round % 5]));
            assert!(edges.parts.len() < 100_000, "{}", edges.parts.len());
        }
        edges.put_together();
        assert_eq!(edges.parts, (0..300).map(|row| [row, 0, 13]).collect::<Vec<_>>());
    }

    #[test]
    fn pixels_at_edges_are_asked_once_where_something_else_is_beside() {
        let mut pixels = vec![7; 40];
        pixels[10..20].fill(8);
        let shown = pixels.clone();
        let edges = || {
            let mut edges = Edges::default();
            edges.add(1, [2, 7], |column| column == 4);
            edges.add(1, [3, 6], |column| column == 4);
            edges.push([3, 1, 3]);
            edges.push([3, 3, 5]);
            edges.add(0, [9, 9], |_| true);
            edges
        };
        let asked = edges().asked(&mut pixels, 10, Show::Surfaces);
        assert_eq!(asked, [2, 3, 5, 6].map(|column| [1, column, column + 1]));
        let unsure = (0..40).filter(|&at| pixels[at] == UNSURE).collect::<Vec<_>>();
        assert_eq!(unsure, [12, 13, 15, 16]);
        // As colours they are one; and so many steps farther they are two.
        pixels.copy_from_slice(&shown);
        assert_eq!(edges().asked(&mut pixels, 10, Show::Light), [[0; 3]; 0]);
        pixels[10..20].fill(9);
        assert_eq!(edges().asked(&mut pixels, 10, Show::Light).len(), 4);
        assert!(pixels.iter().all(|&pixel| pixel == 7 || pixel == 9));
    }
}
