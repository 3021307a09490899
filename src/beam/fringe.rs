//! Pixels so near to an edge of a cell that rays tell what they show: cells are rounded to the lattice, and walls that lean by less than the tolerance to
//! upright ones.
//!
//! How far a cell is off what it was cut around is measured once, when a beam first comes there. Where that is nothing, as in models whose corners are on
//! the lattice, lines of the picture are exact, and no pixel is near enough.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::DVec3;

use super::screen::{Plane, Screen};
use super::walk::corner;
use crate::format::Views;
use crate::format::records::{CellRecord, PLAIN, PlaneRecord};
use crate::trace::{NONE, Prisms};

/// What cells are off by less, metres, is rounding.
const EXACT: f64 = 1e-8;

/// An edge, where two faces meet, is off by no more than so many times as far as these are: at right angles by the root of two.
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

/// How far each cell's edges are off.
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

    /// How far the edges of a cell of air are off what it was cut around, metres; 0 if they are not, and of other cells. Where a wall of it ends at a portal, the wall
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
    let at = |plane: &PlaneRecord, side: usize| {
        let start = corner(&sides[side % sides.len()]);
        start.extend(plane.slope[0] * start.x + plane.slope[1] * start.y + plane.height)
    };
    let (mut most, mut is_off) = (0.0f64, false);
    // What a face is cut around, and the face's corners, or those of what it is part of.
    let mut look = |source: u32, flags: u16, corners: &mut dyn Iterator<Item = DVec3>| {
        if source == NONE {
            return;
        }
        let source = &tables.sources[source as usize];
        let triangle = tables.triangles[tables.surfaces[source.first as usize] as usize];
        let triangle = triangle.map(|v| prisms.local(DVec3::from(tables.vertices[v as usize])));
        let [a, b, c] = triangle;
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return };
        // Of a face that is not in one plane that of one of its triangles says nothing.
        if flags & PLAIN != 0 {
            most = corners.fold(most, |most, corner| most.max((corner - a).dot(normal).abs()));
        } else {
            most = most.max(prisms.rounding());
        }
        // Where what is met ends may be off, too.
        is_off |= triangle.iter().any(|p| (*p - (*p / step).round() * step).abs().max_element() > EXACT);
    };
    for (index, side) in sides.iter().enumerate() {
        for face in prisms.faces_of(side) {
            let ends = ends.iter();
            let mut corners = ends.flat_map(|end| [at(end, index), at(end, index + 1)]);
            look(face.source, face.flags, &mut corners);
        }
    }
    let (below, above) = prisms.covers_of(cell);
    for (end, covers) in ends.iter().zip([below, above]) {
        for cover in covers {
            look(cover.source, cover.flags, &mut (0..sides.len()).map(|side| at(end, side)));
        }
    }
    if most > EXACT || is_off { (AT_EDGES * most).max(step) } else { 0.0 }
}

/// How far off a line of the picture may be, by how far from the eye what it is the picture of is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fringe(f64);

impl Fringe {
    /// Of a cell that is off by this, metres, in a picture so many pixels wide and high.
    pub(crate) fn new(screen: &Screen, size: [u32; 2], off: f64) -> Fringe {
        if off == 0.0 {
            return Fringe::default();
        }
        // What is a metre away, seen at an angle to the picture's axis, is the larger the farther from there.
        let [width, height] = size.map(f64::from);
        let away = screen.across.cross(screen.down).normalize_or_zero().dot(screen.first).abs();
        let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
        let ray = |[x, y]: [f64; 2]| screen.first + screen.across * x + screen.down * y;
        let longest = corners.map(|at| ray(at).length_squared()).into_iter().fold(0.0, f64::max);
        let pixel = screen.across.length().min(screen.down.length());
        Fringe(off * longest / (away * pixel))
    }

    /// Whether no line is off.
    #[inline]
    pub(crate) fn is_none(self) -> bool {
        self.0 == 0.0
    }

    /// Pixels by which a line is off past a corner at this distance, metres.
    #[inline]
    pub(crate) fn past(self, distance: f64) -> f64 {
        self.0 / distance
    }

    /// The same where two planes meet: no nearer to the eye than the farther one.
    #[inline]
    pub(crate) fn between(self, one: &Plane, other: &Plane) -> f64 {
        let distance = |plane: &Plane| plane.away.abs() / plane.size;
        self.past(distance(one).max(distance(other)))
    }
}
