//! Pixels so near to an edge of a cell that rays tell what they show: cells are rounded to the lattice, and walls that lean by less than the tolerance to
//! upright ones.
//!
//! How far a cell is off what it was cut around is measured once, when a beam first comes there. Where that is nothing, as in models whose corners are on
//! the lattice, lines of the picture are exact, and no pixel is near enough.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec2, DVec3};

use super::rows::{Line, free_parts};
use super::screen::{Off, Plane, Screen};
use super::shade::{Show, UNSURE};
use super::walk::corner;
use crate::format::Views;
use crate::format::records::{CellRecord, PLAIN, PlaneRecord, SourceRecord};
use crate::trace::{NONE, Prisms};

/// What cells are off by less, metres, is rounding.
const EXACT: f64 = 1e-8;

/// An edge where something else ends than the planes that meet there tell is off by no more than so many times as far as what ends, if its faces meet at an angle of 60
/// to 120 degrees: at right angles by the root of two. Flatter and sharper ones may be off by more.
const AT_EDGES: f64 = 2.0;

/// How far cells are off, metres, as bits of f32; or, where nobody came yet, [`NONE`].
struct Measured(Vec<AtomicU32>);

impl Measured {
    fn new(cells: usize) -> Measured {
        Measured((0..cells).map(|_| AtomicU32::new(NONE)).collect())
    }

    /// What `measure` says of a cell, which is asked once, or several times at once.
    fn of(&self, cell: u32, measure: impl FnOnce() -> f64) -> f64 {
        let known = &self.0[cell as usize];
        let bits = match known.load(Ordering::Relaxed) {
            NONE => {
                let bits = (measure() as f32).to_bits();
                known.store(bits, Ordering::Relaxed);
                bits
            }
            bits => bits,
        };
        f64::from(f32::from_bits(bits))
    }
}

/// How far each cell's faces are off.
pub(crate) struct Fringes {
    /// By its own faces alone.
    own: Measured,
    /// By those of the cells around it, too.
    all: Measured,
}

impl Fringes {
    /// Of so many cells.
    pub(crate) fn new(cells: usize) -> Fringes {
        Fringes { own: Measured::new(cells), all: Measured::new(cells) }
    }

    /// All of them exact.
    #[cfg(test)]
    pub(super) fn exact(cells: usize) -> Fringes {
        let fringes = Fringes::new(cells);
        fringes.all.0.iter().for_each(|cell| cell.store(0, Ordering::Relaxed));
        fringes
    }

    /// How far the faces of a cell of air are off what it was cut around, metres; 0 if they are not, and of other cells. Where a wall of it ends at a portal, the wall
    /// that it ends at may be that of the cell beyond.
    pub(crate) fn of(&self, tables: &Views, cell: u32) -> f64 {
        self.all.of(cell, || {
            let cells = &tables.cells;
            if cells[cell as usize].kind != CellRecord::AIR {
                return 0.0;
            }
            let (prisms, mut has_faces) = (Prisms::new(tables), false);
            let mut most = self.own.of(cell, || off(tables, &cells[cell as usize]));
            for (beyond, source, _) in prisms.beyond(&cells[cell as usize]) {
                has_faces |= source != NONE;
                if source == NONE && cells[beyond as usize].kind == CellRecord::AIR {
                    most = most.max(self.own.of(beyond, || off(tables, &cells[beyond as usize])));
                }
            }
            // Between portals all that matters is told where they lead.
            if has_faces { most } else { 0.0 }
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
        // Of a face that is not in one plane that of one of its triangles says nothing.
        if flags & PLAIN == 0 || plane == NONE {
            most = most.max(prisms.rounding());
            return;
        }
        let [a, b, c] = corners_of(plane);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        most = corners.fold(most, |most, corner| most.max((corner - a).dot(normal).abs()));
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

/// How far the planes of a cell are off what it was cut around, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fringe(f64);

impl Fringe {
    /// Of a cell whose faces are off by so much, as [`Fringes::of`].
    pub(crate) fn new(off: f64) -> Fringe {
        Fringe(off)
    }

    /// Whether all are exact.
    pub(crate) fn is_none(self) -> bool {
        self.0 == 0.0
    }

    /// An edge that stands for one where other planes meet.
    fn at_border(self) -> f64 {
        AT_EDGES * self.0
    }

    /// A plane at which one face of the cell ends and another begins.
    pub(crate) fn of_border(self) -> Off {
        Off { at_edges: self.at_border(), faces: 0.0 }
    }

    /// The plane of a side or an end of the cell, by what rays meet there: [`NONE`] where they go on. Where they do, another plane may end that of a face beside it.
    pub(crate) fn of(self, sources: impl IntoIterator<Item = u32>) -> Off {
        if self.is_none() {
            return Off::default();
        }
        let (mut any, mut all) = (false, true);
        for goes_on in sources.into_iter().map(|source| source == NONE) {
            any |= goes_on;
            all &= goes_on;
        }
        Off { at_edges: if any { self.at_border() } else { self.0 }, faces: if all { 0.0 } else { self.0 } }
    }

    /// By how much the line [past](Screen::past) a corner may be another at a pixel, as a line; `None` if it is exact. The sides that meet there go this way, and
    /// are off by so much. It is the longer the farther from the eye a pixel's ray has come when it passes the corner, and negative at those that go away from it.
    pub(crate) fn past(self, screen: &Screen, way: DVec2, sides: [(DVec2, f64); 2]) -> Option<Line> {
        /// The sine of the angle at which walls meet at least, so that they tell where.
        const SHARP: f64 = 0.5;
        if self.is_none() {
            return None;
        }
        let (ahead, [(one, one_off), (other, other_off)]) = (way.normalize_or_zero(), sides);
        let sine = one.perp_dot(other).abs() / (one.length() * other.length());
        let is_told = sine >= SHARP && one_off.max(other_off) <= self.0;
        let off = if is_told {
            // A side moved along its normal moves the corner along the other side; what matters is how far across the way.
            let across = |side: DVec2| side.normalize().perp_dot(ahead).abs();
            (one_off * across(other) + other_off * across(one)) / sine
        } else {
            self.at_border()
        };
        // Moved along the way, too, a corner near the eye is passed in another direction.
        let off = off * (1.0 + (self.at_border() / way.length()).min(1.0));
        Some(Line(screen.along((ahead * off).extend(0.0))))
    }
}

/// By how much the line where two planes meet, as [`Plane::beyond_at`] has it, may be another at a pixel, as a line; `None` if it is exact. It is negative at pixels
/// whose rays come to neither plane: that line is not there.
///
/// Moved by `d` along its unit normal a plane changes that line, at each pixel, by `d` times how the other plane grows there: no matter at which angle they
/// meet, how far away, and from where that is seen.
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
            let offs = sides.map(|side| (side, off));
            let (way, line) = SCREEN.past(corner);
            let past = Fringe::new(off).past(&SCREEN, way, offs).unwrap();
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
