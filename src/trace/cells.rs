//! From cell to cell: the walk of a ray through the prisms of a scene.
//!
//! In each prism of air the ray meets the prism's detail, or passes to the next through one face of its surface, or
//! ends where that face stands before matter (`meet`). Around the prisms, and in scenes that have none, all that can
//! be met is one hierarchy of boxes.
//!
//! - *Every prism is left once.* Sides in the plan have exact signs (`plan`), so that a ray crosses each prism at most
//!   once. Planes that meet in a line along the ray are the only place where rounding could lead in a circle: a walk
//!   of more steps than there are cells is begun again a nanometre aside, and counted.
//! - *Rounding.* Cells are rounded to the lattice. The way through them is that of a parallel ray: the ray itself, but where
//!   it starts in a prism of matter, or so near to it that rounding might let it run on the wrong side of a surface, one
//!   that starts beside it in the air, a few steps of the lattice away from matter. The triangles are met by the ray
//!   itself, or they are nearly met.
//! - *In matter*, where no air is near the start, all triangles of a prism's surface are tested, and the ray walks on
//!   until it meets one or is in the air.
//! - *A hit is the nearest.* A cell's detail is all triangles that come within a margin of it; a hit counts up to
//!   where the ray leaves the cell, and [`NEAR`] farther, which the margin covers.

use arrayvec::ArrayVec;
use glam::DVec3;

use super::NONE;
use super::begin::{ASIDE, aside};
use super::kernel::Probe;
use super::meet::{Nearly, Surfaces, is_near};
use super::path::{Exit, NEAR, Path, Prisms};
use super::single::Line;
use super::walk::{Found, Query, Surface, Walk};
use crate::format::Views;
use crate::format::records::CellRecord;

/// The cell around the prisms.
const AROUND: u32 = 0;

/// What a ray met, and the cell that it met it in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub(super) found: Found,
    pub(super) cell: u32,
    /// The ray starts in a prism of matter, no air within the tolerance.
    pub(super) in_matter: bool,
}

/// Why a walk ended without an answer.
enum Lost {
    /// It lost its way.
    Astray,
    /// It passes along matter, into which rounding has brought it: it must begin again so far aside.
    Along(DVec3),
}

/// So many prisms are tried to start in, where several meet at the start.
const MOST_TRIED: usize = 16;

/// Walks that pass along matter are begun again so often.
const MOST_ASIDE: usize = 8;

/// What the ray meets first, `hint` being the cell where it may start.
#[inline]
pub(super) fn nearest<P: Probe>(
    tables: &Views,
    line: &Line,
    surface: Option<Surface>,
    hint: u32,
    probe: &mut P,
) -> Ended {
    let walk = Walk::new(tables);
    let mut query = line.query(tables, surface);
    if tables.cells.len() == 1 {
        query.aim(tables.cells[0].root, line.tmax);
        return Ended { found: probe.first(&walk, &query), cell: AROUND, in_matter: false };
    }
    let mut ray = Crossing::new(tables, line, walk, query, probe);
    let mut way = DVec3::ZERO;
    for left in (0..MOST_ASIDE).rev() {
        match ray.run(hint) {
            Ok(ended) => return ended,
            Err(Lost::Along(push)) => {
                way += push;
                // Whether it is as far aside as it may be, or in a wedge that pushes it to and fro: the last walk ends.
                let may_push = left > 1 && way.length() + ray.clear < ray.surfaces.tolerance;
                ray.begin(line, way, may_push);
            }
            Err(Lost::Astray) => break,
        }
    }
    again(tables, line, surface, probe)
}

/// The same a nanometre aside: the first way that leads to an answer.
#[cold]
fn again<P: Probe>(tables: &Views, line: &Line, surface: Option<Surface>, probe: &mut P) -> Ended {
    let step = aside(line.origin + line.direction * line.start);
    for way in ASIDE.map(|way| way * step) {
        probe.restart();
        let aside = Line { origin: line.origin + way, ..*line };
        let query = aside.query(tables, surface);
        let mut ray = Crossing::new(tables, &aside, Walk::new(tables), query, probe);
        ray.may_push = false;
        if let Ok(mut ended) = ray.run(NONE) {
            let t = ended.found.t + way.dot(line.direction);
            ended.found.t = t.max(line.tmin).min(line.tmax);
            return ended;
        }
    }
    Ended { found: Found { t: line.tmax, triangle: NONE }, cell: AROUND, in_matter: false }
}

/// A ray under way.
struct Crossing<'a, 'p, P> {
    walk: Walk<'a>,
    path: Path<'a>,
    surfaces: Surfaces<'a>,
    query: Query,
    /// Where it starts, and where it ends at the latest.
    first: f64,
    limit: f64,
    /// How far from matter rounding cannot reach, metres.
    clear: f64,
    /// Whether it may begin again farther from matter.
    may_push: bool,
    probe: &'p mut P,
}

impl<'a, 'p, P: Probe> Crossing<'a, 'p, P> {
    #[inline]
    fn new(tables: &'a Views, line: &Line, walk: Walk<'a>, query: Query, probe: &'p mut P) -> Self {
        let path = Path::new(Prisms::new(tables), line.origin, line.direction, line.start);
        let surfaces = Surfaces::new(tables);
        let clear = path.prisms.clear.min(surfaces.tolerance / 4.0);
        let first = line.tmin.max(line.start);
        Crossing { walk, path, surfaces, query, first, limit: line.tmax, clear, may_push: true, probe }
    }

    /// Makes the path one that is `way` aside.
    #[cold]
    fn begin(&mut self, line: &Line, way: DVec3, may_push: bool) {
        self.path = Path::new(self.path.prisms, line.origin, line.direction, line.start).moved(way);
        self.may_push = may_push;
    }

    /// The prism in which the ray starts, its path moved aside where needed.
    #[inline]
    fn start(&mut self, hint: u32) -> Result<u32, Lost> {
        let clear = self.clear;
        if self.path.is_clear_in(hint, self.first, clear) {
            return Ok(hint);
        }
        let found = self.path.find(self.first);
        match found {
            Some(cell) if self.path.is_clear_in(cell, self.first, clear) => Ok(cell),
            _ => self.start_aside(hint, found, clear),
        }
    }

    #[cold]
    fn start_aside(&mut self, hint: u32, found: Option<u32>, clear: f64) -> Result<u32, Lost> {
        let mut tried = ArrayVec::<u32, MOST_TRIED>::new();
        while !tried.is_full()
            && let Some((way, cell)) =
                self.path.aside(self.first, hint, clear, self.surfaces.tolerance, &tried)
        {
            let moved = self.path.moved(way);
            // A prism too narrow for that is left as it is.
            if moved.is_clear_in(cell, self.first, 0.0) {
                self.path = moved;
                return Ok(cell);
            }
            tried.push(cell);
        }
        found.ok_or(Lost::Astray)
    }

    /// What it meets first.
    fn run(&mut self, hint: u32) -> Result<Ended, Lost> {
        let inside = self.path.prisms.hold(self.path.at(self.first));
        let mut cell = if inside { self.start(hint)? } else { AROUND };
        let cells = self.path.prisms.cells;
        let in_matter = cells[cell as usize].kind == CellRecord::SOLID;
        let nothing = Found { t: self.limit, triangle: NONE };
        let mut outside = !inside;
        // Each cell once, and around them before and after.
        for _ in 0..cells.len() + 2 {
            let record = &cells[cell as usize];
            let exit = match record.kind {
                CellRecord::AROUND => {
                    let entry = if outside { self.entry() } else { None };
                    outside = false;
                    match (self.around(record, entry), entry) {
                        (Some(found), _) => return Ok(Ended { found, cell, in_matter }),
                        (None, Some((t, cell))) => Exit::into_zone(t, cell),
                        (None, None) => return Ok(Ended { found: nothing, cell, in_matter }),
                    }
                }
                kind => {
                    self.probe.cell();
                    let exit = self.path.leave(record).ok_or(Lost::Astray)?;
                    let best = if kind == CellRecord::AIR {
                        self.at_face(record, &exit)?
                    } else {
                        self.in_matter(record, exit.t)
                    };
                    if let Some(found) = self.with_detail(record, &exit, best) {
                        let found = if found.t <= self.limit { found } else { nothing };
                        return Ok(Ended { found, cell, in_matter });
                    }
                    exit
                }
            };
            // Where cells say that the ray is too far, the triangles may say that it is not yet.
            if exit.t > self.limit + self.surfaces.tolerance {
                return Ok(Ended { found: nothing, cell, in_matter });
            }
            cell = exit.cell;
        }
        Err(Lost::Astray)
    }

    /// Where the ray comes to the prisms, and which it enters.
    fn entry(&self) -> Option<(f64, u32)> {
        let [enter, leave] = self.path.zone_span()?;
        if leave < self.first {
            return None;
        }
        let t = enter.max(self.first);
        self.path.find(t).map(|cell| (t, cell))
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
    fn at_face(&mut self, record: &CellRecord, exit: &Exit) -> Result<Option<Found>, Lost> {
        if exit.source == NONE || self.path.prisms.cells[exit.cell as usize].kind != CellRecord::SOLID {
            return Ok(None);
        }
        // Not only up to where the segment ends: what it would meet after that is met, and not missed.
        let mut best = Found { t: f64::INFINITY, triangle: NONE };
        let outward = self.path.prisms.turned_back(self.path.outward(record, exit));
        self.meet_near(exit.source, exit.t, outward, &mut best);
        if best.triangle != NONE { Ok(Some(best)) } else { self.missed(record, exit) }
    }

    /// Makes `best` what the ray meets of a source near a face, if that is nearer, and if the ray comes to it from where
    /// the air is: from the other side, along the face, only a ray comes that rounding has put into the matter.
    #[inline]
    fn meet_near(&mut self, source: u32, t: f64, outward: DVec3, best: &mut Found) {
        let (walk, tolerance) = (&self.walk, self.surfaces.tolerance);
        let takes = |found: &Found, query: &Query| {
            is_near(found, t, tolerance, walk, query) && walk.enters(found.triangle, outward, query.direction)
        };
        self.surfaces.meet(source, walk, &mut self.query, best, self.probe, takes);
    }

    /// What the ray meets near a face whose own triangles it misses.
    #[cold]
    fn missed(&mut self, record: &CellRecord, exit: &Exit) -> Result<Option<Found>, Lost> {
        let mut best = Found { t: f64::INFINITY, triangle: NONE };
        for (source, outward) in self.path.prisms.sources_of(record) {
            let outward = self.path.prisms.turned_back(outward);
            self.meet_near(source, exit.t, outward, &mut best);
        }
        if best.triangle != NONE {
            return Ok(Some(best));
        }
        let at = (exit.t, self.path.prisms.internal(self.path.at(exit.t)));
        let outward = self.path.outward(record, exit);
        let normal = self.path.prisms.turned_back(outward);
        match self.surfaces.nearly_met(exit.source, at, normal, &self.walk, &self.query) {
            Nearly::Met(found) => Ok(Some(found)),
            Nearly::Grazed(_) if self.may_push => Err(Lost::Along(outward.normalize_or_zero() * -self.clear)),
            Nearly::Grazed(found) => Ok(Some(found)),
            Nearly::Nothing => Ok(None),
        }
    }

    /// What the ray meets from within of the surface of a prism of matter, up to where it leaves it.
    #[cold]
    fn in_matter(&mut self, record: &CellRecord, t: f64) -> Option<Found> {
        let (walk, tolerance) = (&self.walk, self.surfaces.tolerance);
        let takes = |found: &Found, query: &Query| found.t <= t || is_near(found, t, tolerance, walk, query);
        let mut best = Found { t: self.limit, triangle: NONE };
        for (source, _) in self.path.prisms.sources_of(record) {
            self.surfaces.meet(source, walk, &mut self.query, &mut best, self.probe, takes);
        }
        (best.triangle != NONE).then_some(best)
    }

    /// The nearer of `best` and the detail of the cell, if there is any.
    #[inline]
    fn with_detail(&mut self, record: &CellRecord, exit: &Exit, best: Option<Found>) -> Option<Found> {
        if record.root == NONE {
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
