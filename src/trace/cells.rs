//! From cell to cell: the walk of a ray through the prisms of a scene.
//!
//! In each prism of air the ray meets the prism's detail, or passes to the next through one face of its surface, or
//! ends where that face stands before matter (`meet`). Around the prisms, and in scenes that have none, all that can
//! be met is one hierarchy of boxes.
//!
//! - *Every prism is left once.* Sides in the plan have exact signs (`plan`), so that a ray crosses each prism at most
//!   once.
//! - *Rounding.* Cells are rounded to the lattice, and may differ from the model by a fraction of the tolerance. The way
//!   through them is that of the ray itself, or, where it starts near matter, of a parallel one that starts a few steps of
//!   the lattice away from it in the air. What is met, and where, is said by the source's triangles and the ray itself.
//! - *Where cells cannot tell, all triangles do.* A ray that passes an edge of a face so near that one hardly aside would go
//!   another way, one that misses the triangles of the matter it comes to, and one that starts in matter with no air
//!   near, is traced in the hierarchy of all triangles instead, from its start: cell 0's.
//! - *A hit is the nearest.* A cell's detail is all triangles that come within a margin of it; a hit counts up to
//!   where the ray leaves the cell, and [`NEAR`] farther, which the margin covers.

use super::NONE;
use super::kernel::Probe;
use super::line::Line;
use super::meet::{Surfaces, runs_along};
use super::path::{BEYOND, BLURRED, Exit, NEAR, Path, Prisms};
use super::walk::{Found, Query, Surface, Walk};
use crate::format::Views;
use crate::format::records::CellRecord;
use glam::DVec3;

/// The cell around the prisms.
const AROUND: u32 = 0;

/// What a ray met, and the cell that it met it in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub(super) found: Found,
    pub(super) cell: u32,
    /// The ray starts in a prism of matter, no air near.
    pub(super) in_matter: bool,
}

/// The cells cannot tell.
struct Unsure {
    /// The ray starts in a prism of matter, no air near.
    in_matter: bool,
    /// Something may stand in its way well before where it comes to a face.
    before: bool,
}

const UNSURE: Unsure = Unsure { in_matter: false, before: false };

/// What the ray meets first, `hint` being the cell where it may start.
#[inline]
pub(super) fn nearest<P: Probe>(
    tables: &Views,
    line: &Line,
    surface: Option<&Surface>,
    hint: u32,
    probe: &mut P,
) -> Ended {
    if tables.cells.len() == 1 {
        return among_all(tables, line, surface, probe);
    }
    match Crossing::new(tables, line, surface, probe).run(hint) {
        Ok(ended) => ended,
        Err(Unsure { in_matter, .. }) => {
            probe.unsure();
            Ended { in_matter, ..among_all(tables, line, surface, probe) }
        }
    }
}

/// What the ray meets first of all triangles.
#[inline]
pub(super) fn among_all<P: Probe>(
    tables: &Views,
    line: &Line,
    surface: Option<&Surface>,
    probe: &mut P,
) -> Ended {
    let mut query = line.query(tables, surface);
    query.aim(tables.cells[AROUND as usize].root, line.tmax);
    Ended { found: probe.first(&Walk::new(tables), &query), cell: AROUND, in_matter: false }
}

/// A ray under way.
struct Crossing<'a, 's, 'p, P> {
    walk: Walk<'a>,
    path: Path<'a>,
    surfaces: Surfaces<'a>,
    query: Query<'s>,
    /// Where it starts, and where it ends at the latest.
    first: f64,
    limit: f64,
    probe: &'p mut P,
}

impl<'a, 's, 'p, P: Probe> Crossing<'a, 's, 'p, P> {
    #[inline]
    fn new(tables: &'a Views, line: &Line, surface: Option<&'s Surface>, probe: &'p mut P) -> Self {
        let (walk, query) = (Walk::new(tables), line.query(tables, surface));
        let path = Path::new(Prisms::new(tables), line.origin, line.direction, line.start);
        let surfaces = Surfaces::new(tables);
        let first = line.tmin.max(line.start);
        Crossing { walk, path, surfaces, query, first, limit: line.tmax, probe }
    }

    /// The prism of air in which the ray starts.
    #[inline]
    fn start(&self, hint: u32) -> Result<u32, Unsure> {
        let prisms = self.path.prisms;
        let point = self.path.at(self.first);
        let is_air = |cell: &&CellRecord| cell.kind == CellRecord::AIR;
        let hinted = prisms.cells.get(hint as usize).filter(is_air);
        let is_hinted = |margin: f64| hinted.is_some_and(|cell| prisms.nearly_holds(cell, point, margin));
        if self.query.surface.is_some() {
            // From the surface that it starts on, the ray does not come back to that. In small models another cell may be as near as cells are blurred.
            let margin = BLURRED.min(self.surfaces.tolerance.max(prisms.rounding()));
            return if is_hinted(margin) { Ok(hint) } else { self.find(point) };
        }
        let cell = if is_hinted(NEAR) { hint } else { self.find(point)? };
        // By what cells are rounded it may be behind that face, and come through it where no cell tells.
        let is_beside = prisms.is_beside_matter(&prisms.cells[cell as usize], point, prisms.rounding());
        if is_beside { Err(UNSURE) } else { Ok(cell) }
    }

    /// The prism of air at a point.
    fn find(&self, point: DVec3) -> Result<u32, Unsure> {
        // What rounding can do, no more: a ray that starts farther inside of something open leaves it through its surface,
        // and flat along that what it meets behind would be off by many times as much.
        let margin = self.path.prisms.rounding().min(self.surfaces.tolerance);
        let cell = self.path.prisms.place(point, margin).ok_or(UNSURE)?;
        match self.path.prisms.cells[cell as usize] {
            CellRecord { kind: CellRecord::AIR, .. } => Ok(cell),
            CellRecord { flags, .. } => Err(Unsure { in_matter: flags & CellRecord::HIDDEN == 0, ..UNSURE }),
        }
    }

    /// What it meets first.
    fn run(&mut self, hint: u32) -> Result<Ended, Unsure> {
        let mut past = None;
        match (self.follow(hint, &mut past), past) {
            // It had ended; what comes after is no reason to doubt that.
            (Err(Unsure { before: false, .. }), Some(cell)) => {
                let found = Found { t: self.limit, triangle: NONE };
                Ok(Ended { found, cell, in_matter: false })
            }
            (ended, _) => ended,
        }
    }

    /// The same; `past` becomes the cell in which the ray ends, once it is followed farther than that.
    fn follow(&mut self, hint: u32, past: &mut Option<u32>) -> Result<Ended, Unsure> {
        let inside = self.path.prisms.hold(self.path.at(self.first));
        let mut cell = if inside { self.start(hint)? } else { AROUND };
        let cells = self.path.prisms.cells;
        let nothing = Found { t: self.limit, triangle: NONE };
        let mut outside = !inside;
        // Each cell once, and around them before and after.
        for _ in 0..cells.len() + 2 {
            let record = &cells[cell as usize];
            let exit = match record.kind {
                CellRecord::AROUND => {
                    let entry = if outside { self.entry()? } else { None };
                    outside = false;
                    match (self.around(record, entry), entry) {
                        (Some(found), _) => return Ok(Ended { found, cell, in_matter: false }),
                        (None, Some((t, cell))) => Exit::into_zone(t, cell),
                        (None, None) => return Ok(Ended { found: nothing, cell, in_matter: false }),
                    }
                }
                CellRecord::AIR => {
                    self.probe.cell(|| false);
                    let exit = self.path.leave(record).ok_or(UNSURE)?;
                    let best = self.at_face(record, &exit)?;
                    if let Some(found) = self.with_detail(record, &exit, best) {
                        let found = if found.t <= self.limit { found } else { nothing };
                        return Ok(Ended { found, cell, in_matter: false });
                    }
                    exit
                }
                _ => return Err(UNSURE),
            };
            // Where cells say that the ray is too far, the triangles may say that it is not yet.
            let beyond = exit.t - self.limit;
            if beyond > self.surfaces.tolerance && (past.is_some() || self.is_clear(record, &exit, beyond)) {
                if beyond > BEYOND * self.surfaces.tolerance {
                    return Ok(Ended { found: nothing, cell, in_matter: false });
                }
                past.get_or_insert(cell);
            }
            cell = exit.cell;
        }
        Err(UNSURE)
    }

    /// Whether a ray that leaves a cell so far beyond its end is, where it ends, farther from the face than that is rounded: almost along the face it
    /// may have met what stands there.
    #[inline]
    fn is_clear(&self, record: &CellRecord, exit: &Exit, beyond: f64) -> bool {
        let prisms = &self.path.prisms;
        let outward = prisms.turned_back(self.path.outward(record, exit));
        prisms.ends_before(outward, self.query.direction, beyond)
    }

    /// Where the ray comes to the prisms, if it does, and which it enters.
    fn entry(&self) -> Result<Option<(f64, u32)>, Unsure> {
        match self.path.zone_span() {
            Some([enter, leave]) if leave >= self.first => {
                let t = enter.max(self.first);
                let zone = self.path.prisms.zone.map(DVec3::from);
                let cell = self.find(self.path.at(t).max(zone[0]).min(zone[1]));
                cell.map(|cell| Some((t, cell))).map_err(|_| UNSURE)
            }
            _ => Ok(None),
        }
    }

    /// What the ray meets around the prisms, before it comes to them.
    fn around(&mut self, record: &CellRecord, entry: Option<(f64, u32)>) -> Option<Found> {
        let until = entry.map_or(self.limit, |(t, _)| self.limit.min(t + NEAR));
        let found = self.detail(record.root, until);
        (found.triangle != NONE).then_some(found)
    }

    #[inline]
    fn detail(&mut self, root: u32, until: f64) -> Found {
        if root == NONE {
            return Found { t: until, triangle: NONE };
        }
        self.query.aim(root, until);
        self.probe.first(&self.walk, &self.query)
    }

    /// What the ray meets where it leaves a prism of air, if there is matter.
    #[inline]
    fn at_face(&mut self, record: &CellRecord, exit: &Exit) -> Result<Option<Found>, Unsure> {
        // Also beyond the limit: a ray along an edge is near it all the way.
        if exit.is_near_edge {
            return Err(UNSURE);
        }
        if self.path.prisms.cells[exit.cell as usize].kind != CellRecord::SOLID {
            return Ok(None);
        }
        if exit.source == NONE {
            return Err(UNSURE);
        }
        let outward = self.path.prisms.turned_back(self.path.outward(record, exit));
        if runs_along(&self.path.prisms, self.surfaces.tolerance, outward, self.query.direction) {
            return Err(Unsure { before: true, ..UNSURE });
        }
        let (surfaces, walk) = (&mut self.surfaces, &self.walk);
        let found = surfaces.behind(exit.source, (exit.t, outward), walk, &mut self.query, self.probe);
        found.map(Some).ok_or(UNSURE)
    }

    /// The nearer of `best` and the detail of the cell, if there is any.
    #[inline]
    fn with_detail(&mut self, record: &CellRecord, exit: &Exit, best: Option<Found>) -> Option<Found> {
        if record.root == NONE {
            self.probe.empty();
            return best;
        }
        let until = best.map_or(exit.t, |best| best.t.max(exit.t));
        let detail = self.detail(record.root, self.limit.min(until + NEAR));
        match best {
            Some(best) if (best.t, best.triangle) <= (detail.t, detail.triangle) => Some(best),
            _ => (detail.triangle != NONE).then_some(detail),
        }
    }
}
