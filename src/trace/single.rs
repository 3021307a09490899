//! One ray.

use glam::DVec3;

use super::alone::alone;
use super::begin::{Begin, aside};
use super::cells::{Ended, among_all, nearest};
use super::cost::{Cost, Costs};
use super::kernel::{Ask, Kernel, Plain, Probe};
use super::lanes::Portable;
use super::onward::is_at_start;
use super::path::{BLURRED, NEAR, Prisms};
use super::plate::Plate;
#[cfg(feature = "render")]
use super::plate::plate_of;
use super::quick::{Quick, is_clear_of, nothing, quick, quick_from, starts_clear, takes};
use super::ray::{Answer, Brief, Hit, NONE, Ray};
use super::walk::{EDGE_ON_SINE, Found, Query, Surface, Walk, each};
use crate::format::Views;
use crate::scene::Scene;

/// Planes nearer to the origin of a restarted ray than this, in metres per metre of coordinate, count as the one
/// that it starts on.
const ON_PLANE: f64 = 1e-11;

/// What a hit is off by, metres for each metre to it: of one far off more than its coordinates tell.
const OFF: f64 = 1e-14;

/// From where a ray starts, if the caller knows: then nothing is looked up.
#[derive(Clone, Copy, Debug)]
pub enum Start<'a> {
    /// Anywhere: the origin is located first.
    Anywhere,
    /// In the air: of this cell, if it is in it; else its cell is found.
    Cell(u32),
    /// On the surface of this hit, to the side from which its ray came, or through it: the surface itself is not met
    /// again. A ray that is followed from cell to cell begins in the hit's cell.
    Hit(&'a Hit),
}

/// What a ray meets.
enum Met {
    /// This, the ray being perhaps another than was asked, with an end farther on.
    At(Line, Ended),
    /// Nothing.
    Nothing,
    /// It starts inside this solid element.
    InSolid(u32),
}

impl Met {
    /// What a ray meets that ends at `tmax`.
    fn before(tmax: f64, line: Line, ended: Ended) -> Met {
        let is_met = ended.found.triangle != NONE && ended.found.t <= tmax;
        if is_met { Met::At(line, ended) } else { Met::Nothing }
    }
}

impl Start<'_> {
    /// The cell in which it may be, or none.
    #[inline(always)]
    fn hint(self) -> u32 {
        match self {
            Start::Anywhere => NONE,
            Start::Cell(cell) => cell,
            Start::Hit(hit) => hit.cell,
        }
    }
}

/// What of an answer is wanted beside distance, element and triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Want {
    /// [`Hit::room`] also where the ray does not end in a cell of its own: costs a look-up of the point.
    pub room: bool,
    /// In [`Hit::semantic`] the kind of the face that was met, where one was, instead of the element's meaning: costs a search
    /// among the faces of a cell.
    pub face: bool,
    /// In [`Hit::triangle`] the very triangle, not another in its plane, of the same element and material: costs a look at the
    /// triangles of a face, or a walk through their hierarchy. Of several on each other, one.
    pub triangle: bool,
}

impl Default for Want {
    fn default() -> Want {
        Want { room: true, face: false, triangle: true }
    }
}

impl Want {
    /// Only what costs nothing, and the cell, which is looked up where the ray was not followed from cell to cell: one from outside of them, or one that
    /// passes an edge so near that cells do not tell on which side.
    pub const LEAST: Want = Want { room: false, face: false, triangle: false };

    /// The same, and the kind of the face.
    pub const fn with_face(self) -> Want {
        Want { face: true, ..self }
    }
}

impl Scene {
    /// What the ray meets first.
    ///
    /// [`Answer::InSolid`] if it starts inside a solid, unless it leaves it within the tolerance: an origin on a
    /// surface counts as on the air side that the direction enters. A ray that is none ([`Ray::is_valid`]) escapes.
    ///
    /// What is no solid (furniture, a door's leaf, a pane) has no inside: from a point on its surface, as f64 rounds that, it may be met
    /// at once. A ray that goes on from a hit does not meet what it starts on ([`Start::Hit`]), nor does one with a [`Ray::tmin`].
    ///
    /// ```no_run
    /// use enfilade::{Answer, Ray, Scene};
    ///
    /// let scene = Scene::open("house.enf".as_ref())?;
    /// if let Answer::Hit(hit) = scene.trace(&Ray::new([2.0, 3.0, 1.6], [1.0, 0.0, 0.0])) {
    ///     println!("{} m to {}", hit.t, scene.element(hit.element).id());
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn trace(&self, ray: &Ray) -> Answer {
        self.trace_from(Start::Anywhere, ray, Want::default()).answer()
    }

    /// What the ray meets first, as a record, from a start that the caller knows.
    pub fn trace_from(&self, start: Start<'_>, ray: &Ray, want: Want) -> Hit {
        self.trace_with(self.kernel, start, ray, want)
    }

    /// [`Scene::trace_from`] on a kernel of choice.
    pub fn trace_with(&self, kernel: Kernel, start: Start<'_>, ray: &Ray, want: Want) -> Hit {
        match self.quick(kernel, start, ray) {
            Ok(quick) => self.describe_quick(ray, &quick, want),
            Err(cell) => self.answer_in_doubt(
                known(start, ray, cell),
                ray,
                want,
                &mut Plain { kernel, ask: Ask::First },
            ),
        }
    }

    /// What the ray meets first, in brief: the fastest way to ask.
    ///
    /// ```no_run
    /// # use enfilade::{Place, Ray, Scene, Start};
    /// # let scene = Scene::open("house.enf".as_ref())?;
    /// let eye = [2.0, 3.0, 1.6];
    /// let Place::Air { cell, .. } = scene.locate(eye) else { return Ok(()) };
    /// let brief = scene.trace_brief(Start::Cell(cell), &Ray::new(eye, [1.0, 0.0, 0.0]));
    /// println!("{} m", brief.t);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn trace_brief(&self, start: Start<'_>, ray: &Ray) -> Brief {
        self.trace_brief_with(self.kernel, start, ray)
    }

    /// [`Scene::trace_brief`] on a kernel of choice.
    #[inline]
    pub fn trace_brief_with(&self, kernel: Kernel, start: Start<'_>, ray: &Ray) -> Brief {
        match self.quick(kernel, start, ray) {
            Ok(quick) => quick.brief(),
            Err(place) => {
                // Told in registers, so that the answer stays there in the other case, too.
                let (t, [triangle, cell]) = self.brief(kernel, known(start, ray, place), ray);
                Brief { t, triangle, cell }
            }
        }
    }

    /// The same where there is doubt.
    #[cold]
    #[inline(never)]
    fn brief(&self, kernel: Kernel, start: Start<'_>, ray: &Ray) -> (f64, [u32; 2]) {
        let none = Brief::ESCAPED;
        match self.meets_in_doubt(start, ray, &mut Plain { kernel, ask: Ask::First }) {
            // Not -0.
            Met::At(_, Ended { found, cell, .. }) => (found.t + 0.0, [found.triangle, cell]),
            Met::Nothing => (none.t, [none.triangle, none.cell]),
            Met::InSolid(_) => (f64::NAN, [none.triangle, none.cell]),
        }
    }

    /// What the quick way answers, or the cell in which the ray starts, if that is known.
    #[inline(always)]
    fn quick(&self, kernel: Kernel, start: Start<'_>, ray: &Ray) -> Result<Quick, Option<u32>> {
        if self.is_one_cell() {
            return self.alone(kernel, Ask::First, start, ray).ok_or(None);
        }
        // Cell 0 is around all others.
        if let Start::Cell(cell @ 1..) = start {
            if let Some(quick) = kernel.quick(&self.tables, ray, cell) {
                return Ok(quick);
            }
            if self.tables.is_air(cell) {
                return Err(Some(cell));
            }
        }
        if let Start::Hit(hit) = start {
            let surface = surface_of(hit, DVec3::from(ray.origin), ray.tmin);
            return kernel.quick_from(&self.tables, ray, hit.cell, &surface).ok_or(None);
        }
        // Around all others most start that are said to be in this cell.
        if let Start::Cell(_) = start
            && let Some(quick) = self.alone(kernel, Ask::First, start, ray)
        {
            return Ok(quick);
        }
        match self.free_cell(ray.origin) {
            Some(cell) => kernel.quick(&self.tables, ray, cell).ok_or(Some(cell)),
            None => self.alone(kernel, Ask::First, start, ray).ok_or(None),
        }
    }

    /// Whether there are no cells but that around them.
    #[inline(always)]
    pub(super) fn is_one_cell(&self) -> bool {
        self.tables.cells.len() == 1
    }

    /// What a ray meets of all triangles, first or at all, that starts outside of all prisms; `None` of others, and if it starts on a surface, or perhaps in
    /// a solid. Where there are prisms such a ray meets a building's outside, where they are large and hold much.
    #[inline(never)]
    pub(super) fn alone(&self, kernel: Kernel, ask: Ask, start: Start<'_>, ray: &Ray) -> Option<Quick> {
        // What comes by the hull meets nothing.
        let Some(line) = Line::new(&self.tables, ray) else { return Some(nothing(ray.tmax, 0)) };
        self.starts_alone(start, &line).then(|| kernel.alone(ask, &self.tables, &line))
    }

    /// Whether a ray starts outside of all prisms, on no surface, and surely in no solid.
    #[inline(always)]
    fn starts_alone(&self, start: Start<'_>, line: &Line) -> bool {
        let from = || (line.origin + line.direction * line.tmin).to_array();
        let is_outside = || self.is_one_cell() || !self.is_in_zone(from());
        match start {
            Start::Cell(_) => is_outside(),
            Start::Anywhere => is_outside() && !self.may_start_in_solid(line),
            Start::Hit(_) => false,
        }
    }

    /// The hit of a brief answer to `ray`, its triangle that of the answer; that of a ray that starts in a solid lacks the element.
    pub fn hit(&self, ray: &Ray, brief: &Brief, want: Want) -> Hit {
        let Brief { t, triangle, cell } = *brief;
        if triangle as usize >= self.tables.triangles.len() || cell as usize >= self.tables.cells.len() {
            return Hit { t, ..Hit::ESCAPED };
        }
        self.describe_quick(ray, &Quick { found: Found { t, triangle }, cell, source: NONE }, want)
    }

    /// What a ray meets that leaves a cell of air first through a face with this source, which is plain; `None` if that cannot be told by its plane.
    #[cfg(feature = "render")]
    pub(crate) fn hit_on_source(&self, ray: &Ray, cell: u32, source: u32, want: Want) -> Option<Hit> {
        let triangle = self.tables.plates.get(source as usize)?.triangle;
        if triangle == NONE { None } else { self.hit_on_plane(ray, cell, (triangle, source), want) }
    }

    /// What a ray meets that comes first, in a cell, to the plane of a triangle, which is of a source or of none; `None` if it runs along it.
    #[cfg(feature = "render")]
    pub(crate) fn hit_on_plane(
        &self,
        ray: &Ray,
        cell: u32,
        (triangle, source): (u32, u32),
        want: Want,
    ) -> Option<Hit> {
        /// A ray that comes to a plane with less than this sine is not told by it.
        const FLAT: f64 = 1e-6;
        let direction = unit(DVec3::from(ray.direction))?;
        let plate = plate_of(&self.tables.triangles, &self.tables.vertices, triangle);
        let normal = DVec3::from(plate.normal);
        let sine = normal.dot(direction);
        let t = (plate.offset - normal.dot(DVec3::from(ray.origin))) / sine;
        if sine.abs() < FLAT || !(t.is_finite() && t >= ray.tmin && t <= ray.tmax) {
            return None;
        }
        Some(self.describe_quick(ray, &Quick { found: Found { t, triangle }, cell, source }, want))
    }

    /// What the quick way found, as a record.
    pub(super) fn describe_quick(&self, ray: &Ray, quick: &Quick, want: Want) -> Hit {
        let &Quick { found, cell, source } = quick;
        let Some(direction) = unit(DVec3::from(ray.direction)) else { return Hit::ESCAPED };
        if found.triangle == NONE {
            return Hit::ESCAPED;
        }
        let (tmin, tmax) = (ray.tmin, ray.tmax);
        let line = Line { origin: DVec3::from(ray.origin), direction, tmin, tmax, start: tmin };
        if let Some(plate) = self.tables.plates.get(source as usize)
            && plate.triangle == found.triangle
            && let Some(room) = self.tables.room_of(cell)
        {
            return self.describe_plate(&line, plate, (found.t, source), (cell, room), want);
        }
        let mut hit = self.describe(&line, Ended { found, cell, in_matter: false }, want);
        if want.triangle
            && source != NONE
            && let Some(triangle) = self.very_triangle(&line, source, found.t)
        {
            hit.triangle = triangle;
        }
        hit
    }

    /// The same of a plain face, from its plate: as [`Scene::describe`] has it of the plate's triangle.
    #[inline(always)]
    fn describe_plate(
        &self,
        line: &Line,
        plate: &Plate,
        (t, source): (f64, u32),
        (cell, room): (u32, u32),
        want: Want,
    ) -> Hit {
        let normal = DVec3::from(plate.normal);
        let normal = if normal.dot(line.direction) > 0.0 { -normal } else { normal };
        let point = line.origin + line.direction * t;
        let mut triangle = plate.triangle;
        if want.triangle {
            let very = plate.told(point).or_else(|| self.very_triangle(line, source, t));
            triangle = very.unwrap_or(triangle);
        }
        let kind = if want.face { Prisms::new(&self.tables).kind(cell, plate.triangle) } else { None };
        Hit {
            // Not -0.
            t: t + 0.0,
            point: point.to_array(),
            normal: normal.to_array(),
            element: plate.element,
            semantic: kind.unwrap_or_else(|| self.semantic_of(plate.element)),
            material: plate.material,
            cell,
            room,
            triangle,
        }
    }

    /// The triangle of a source that the ray meets, where it meets its plane at `t`.
    #[inline(never)]
    fn very_triangle(&self, line: &Line, source: u32, t: f64) -> Option<u32> {
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let root = tables.sources.get(source as usize)?.root;
        let mut best = Found { t: f64::INFINITY, triangle: NONE };
        if root != NONE {
            let mut query = line.query(tables, None);
            query.aim(root, f64::INFINITY);
            best = self.kernel.run(Ask::First, &walk, &query);
        } else {
            let triangles = Prisms::new(tables).triangles_of(source);
            let point = line.origin + line.direction * t;
            let holder =
                tables.plates.get(source as usize).and_then(|plate| plate.holder(&walk, triangles, point));
            if holder.is_some() {
                return holder;
            }
            let query = line.query(tables, None);
            for &triangle in triangles {
                query.test(&walk, triangle, &mut best);
            }
        }
        (best.triangle != NONE).then_some(best.triangle)
    }

    /// As [`Scene::trace_from`], with what it took to find the answer, in vain or not. Slower: for pictures of the cost.
    pub fn trace_cost_from(&self, start: Start<'_>, ray: &Ray, want: Want) -> (Hit, Cost) {
        let mut cost = Cost::default();
        let (tables, cell) = (&self.tables, self.start_cell(start, ray));
        let by_all = |cost: &mut Cost| {
            let line = Line::new(tables, ray).filter(|line| self.starts_alone(start, line))?;
            Some(alone::<Portable>(Ask::First, tables, &line, cost))
        };
        let found = match (start, cell) {
            (Start::Hit(hit), Some(cell)) => {
                let surface = surface_of(hit, DVec3::from(ray.origin), ray.tmin);
                quick_from::<Portable, _>(tables, ray, cell, &surface, &mut cost)
            }
            (Start::Cell(told), Some(cell)) if !tables.is_air(told) => {
                by_all(&mut cost).or_else(|| quick::<Portable, _>(tables, ray, cell, &mut cost))
            }
            (_, Some(cell)) => quick::<Portable, _>(tables, ray, cell, &mut cost),
            (_, None) => by_all(&mut cost),
        };
        if let Some(found) = found {
            return (self.describe_quick(ray, &found, want), cost);
        }
        // What was done in vain is done, too.
        let hit = self.answer_in_doubt(known(start, ray, cell), ray, want, &mut cost);
        (hit, cost)
    }

    /// What it takes to answer some rays that start anywhere: with the feature `rayon` on the current pool.
    pub fn costs(&self, rays: &[Ray], want: Want) -> Costs {
        /// Rays that are counted together.
        const CHUNK: usize = 4096;
        let chunks: Vec<&[Ray]> = rays.chunks(CHUNK).collect();
        let parts = crate::parallel::map(chunks.len(), |chunk| {
            let mut costs = Costs::default();
            chunks[chunk]
                .iter()
                .for_each(|ray| costs.add(&self.trace_cost_from(Start::Anywhere, ray, want).1));
            costs
        });
        parts.iter().fold(Costs::default(), |mut all, part| {
            all.merge(part);
            all
        })
    }

    /// The cell of air in which a ray starts, as far as that is in no doubt.
    fn start_cell(&self, start: Start<'_>, ray: &Ray) -> Option<u32> {
        match start {
            Start::Cell(cell) if self.tables.is_air(cell) => Some(cell),
            Start::Anywhere | Start::Cell(_) => self.free_cell(ray.origin),
            Start::Hit(hit) => self.tables.is_air(hit.cell).then_some(hit.cell),
        }
    }

    /// The answer without the quick way.
    #[cfg(all(feature = "compile", any(test, feature = "render")))]
    pub(crate) fn careful(&self, start: Start<'_>, ray: &Ray, want: Want) -> Hit {
        let met = self.meets(start, ray, &mut Plain { kernel: self.kernel, ask: Ask::First });
        self.describe_met(met, want)
    }

    /// The same, with what it took.
    #[cfg(all(feature = "compile", feature = "render"))]
    pub(crate) fn careful_cost(&self, start: Start<'_>, ray: &Ray, want: Want) -> (Hit, Cost) {
        let mut cost = Cost::default();
        let met = self.meets(start, ray, &mut cost);
        (self.describe_met(met, want), cost)
    }

    /// The answer to a ray that the quick way left in doubt.
    #[inline]
    fn answer_in_doubt<P: Probe>(&self, start: Start<'_>, ray: &Ray, want: Want, probe: &mut P) -> Hit {
        let met = self.meets_in_doubt(start, ray, probe);
        self.describe_met(met, want)
    }

    /// What a ray meets as a record.
    fn describe_met(&self, met: Met, want: Want) -> Hit {
        match met {
            Met::At(line, ended) => self.describe(&line, ended, want),
            Met::Nothing => Hit::ESCAPED,
            Met::InSolid(element) => Hit::in_solid(element, self.tables.elements[element as usize].semantic),
        }
    }

    /// What a ray meets that the quick way left in doubt.
    #[inline]
    fn meets_in_doubt<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Met {
        self.meets_of_all(start, ray, probe).unwrap_or_else(|| self.meets(start, ray, probe))
    }

    /// What such a ray meets of all triangles, if what is in doubt is not where it starts: of ten of these the careful walk through cells is in doubt about nine, too, and takes
    /// longer to find that out than all triangles to tell.
    fn meets_of_all<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Option<Met> {
        let tables = &self.tables;
        if tables.cells.len() == 1 || !takes(tables, ray) {
            return None;
        }
        let Some(line) = Line::new(tables, ray) else { return Some(Met::Nothing) };
        match start {
            Start::Cell(cell) if tables.is_air(cell) => {
                let prisms = Prisms::new(tables);
                if !prisms.nearly_holds(&tables.cells[cell as usize], prisms.local(line.origin), 0.0) {
                    return None;
                }
                probe.unsure();
                Some(Met::before(ray.tmax, line, among_all(tables, &line, None, probe)))
            }
            Start::Hit(hit) => {
                let surface = surface_of(hit, line.origin, line.tmin);
                if !starts_clear(tables, ray, hit.cell, &surface) {
                    return None;
                }
                probe.unsure();
                // Without an end: that it has run into a solid is noticed where it comes out of that.
                let line = Line { tmax: f64::INFINITY, ..line };
                let ended = among_all(tables, &line, Some(&surface), probe);
                let is_told = is_clear_of(&surface, ended.found) && !self.is_back(&line, ended.found);
                is_told.then(|| Met::before(ray.tmax, line, ended))
            }
            _ => None,
        }
    }

    /// What a ray meets, `probe` running the walks.
    #[inline]
    fn meets<P: Probe>(&self, start: Start<'_>, ray: &Ray, probe: &mut P) -> Met {
        let tables = &self.tables;
        let Some(mut line) = Line::new(tables, ray) else { return Met::Nothing };
        let surface = surface(start, &line);
        if surface.is_some() {
            // Without an end: that it has run into a solid is noticed where it comes out of that.
            line.tmax = f64::INFINITY;
        }
        let away = surface.as_ref().filter(|surface| is_away(surface, &line));
        let onward = self.in_front(away, &line);
        let follow = |tmin: f64, probe: &mut P| {
            let mut ended = nearest(tables, &onward, surface.as_ref(), start.hint(), probe);
            // What comes to nothing tells by nothing else that it began in matter, as cells say.
            let start = || onward.origin + onward.direction * onward.tmin;
            let begins_in_matter =
                || ended.in_matter && ended.found.triangle == NONE && !self.is_beside_solids(start());
            let is_in_doubt =
                away.is_some() && (begins_in_matter() || self.came_through_matter(&onward, ended.found));
            ended.found.t = ended.found.t.max(tmin);
            (ended, is_in_doubt)
        };
        // One that starts anywhere is mostly not followed where it is in doubt that it begins there.
        let (mut followed, is_in_doubt) = if surface.is_some() {
            let (ended, is_in_doubt) = follow(line.tmin, probe);
            (Some(ended), is_in_doubt)
        } else {
            (None, matches!(start, Start::Anywhere) && self.may_start_in_solid(&line))
        };
        if is_in_doubt {
            let first = followed.map(|ended| ended.found);
            // By all triangles: where cells are rounded, a surface may be behind a ray that starts beside it.
            let again = |line: &Line, probe: &mut P| among_all(tables, line, surface.as_ref(), probe);
            match self.begin(&line, away, &mut |line| again(line, probe).found) {
                Begin::InSolid(_) if first.is_some_and(|first| is_at_start(&line, first.t)) => {}
                Begin::InSolid(element) => {
                    return Met::InSolid(element);
                }
                Begin::At(tmin) if tmin > line.tmin => {
                    line.tmin = tmin;
                    followed = Some(again(&line, probe));
                }
                Begin::At(_) => {
                    // Only where it passes a side that closely is it let past. Otherwise the hit stands, even on a solid's back: parts of one solid may overlap.
                    if let (Some(first), Some(away)) = (first, away)
                        && first.triangle != NONE
                        && self.is_at_side(away, &onward, first)
                        && self.comes_by_air(&onward, first.t)
                    {
                        followed = Some(self.past_edge(&onward, surface.as_ref(), first, probe));
                    }
                }
                Begin::Beside(way) => {
                    let mut way = away.map_or(way, |surface| self.up_to(surface, &line, way));
                    // Without an end: almost along a plane, it comes there much sooner or later than this ray.
                    let aside = Line { origin: line.origin + way, tmax: f64::INFINITY, ..line };
                    // Aside may be behind the surface, which it does not meet from there either.
                    let behind = surface
                        .as_ref()
                        .map(|surface| Surface { aside: way.dot(surface.normal).abs(), ..*surface });
                    let mut ended = among_all(tables, &aside, behind.as_ref(), probe);
                    if let Some(away) = away
                        && self.came_through_matter(&aside, ended.found)
                    {
                        // Into what meets the surface there: where the ray starts that is not met again, and from aside it is.
                        let met = among_all(tables, &aside, None, probe);
                        // From aside it may come through the surface itself, where there is no air before that.
                        let walk = Walk::new(tables);
                        if !walk.is_part_of(met.found.triangle, away, line.origin) {
                            ended = met;
                        } else if let Some((up, above)) = self.above(away, &line, probe) {
                            (way, ended) = (up, above);
                        } else if let Some(element) = self.solid_before(away, &line) {
                            return Met::InSolid(element);
                        }
                    }
                    // Back from the other ray's origin to this one's.
                    ended.found.t += way.dot(line.direction);
                    ended.found.t = self.in_its_plane(&line, ended.found).max(line.tmin);
                    followed = Some(ended);
                }
            }
        }
        let ended = followed.unwrap_or_else(|| follow(line.tmin, probe).0);
        if ended.in_matter
            && matches!(start, Start::Anywhere)
            && let Some(element) = self.solid_around(line.origin + line.direction * line.tmin)
        {
            return Met::InSolid(element);
        }
        Met::before(ray.tmax, line, ended)
    }

    /// What a ray meets that comes past the edge of what it does not come from within of, which it has met: what is behind that, or, where something else
    /// stands against it, enters that there.
    fn past_edge<P: Probe>(
        &self,
        line: &Line,
        surface: Option<&Surface>,
        edge: Found,
        probe: &mut P,
    ) -> Ended {
        /// More surfaces than this in an edge are not told apart.
        const MOST: usize = 64;
        let (tables, walk) = (&self.tables, Walk::new(&self.tables));
        let aside = aside(line.origin + line.direction * edge.t);
        let mut query = line.query(tables, None);
        query.aim(tables.cells[0].root, line.tmax);
        query.follow((edge.t - aside).max(line.tmin), 0);
        let is_of_solid = self.is_of_solid(edge.triangle);
        for _ in 0..MOST {
            let found = probe.nearest(&walk, &query);
            let enters = |triangle: u32| {
                let [a, b, c] = walk.corners(triangle);
                (b - a).cross(c - a).dot(line.direction) < 0.0
            };
            // What encloses nothing has no inside that it could come out of; but what it starts on it does not meet.
            let is_open = |triangle: u32| {
                let is_own = surface.is_some_and(|own| walk.is_part_of(triangle, own, line.origin));
                let may_be_met = is_of_solid || !walk.are_of_one(triangle, edge.triangle);
                may_be_met && !is_own && !self.is_of_solid(triangle)
            };
            if found.triangle == NONE
                || found.t > edge.t + aside
                || enters(found.triangle) && !walk.are_of_one(found.triangle, edge.triangle)
                || is_open(found.triangle)
            {
                return Ended { found, cell: 0, in_matter: false };
            }
            query.follow(found.t, found.triangle + 1);
        }
        among_all(tables, &Line { tmin: edge.t + aside, ..*line }, None, probe)
    }

    /// What a ray meets that goes away from a surface which is bent more than a ray beside it is told apart: from a little before that, where it meets
    /// nothing through matter; and the way there.
    #[cold]
    fn above<P: Probe>(&self, surface: &Surface, line: &Line, probe: &mut P) -> Option<(DVec3, Ended)> {
        /// Of how far before a surface a ray may start: no farther than it takes.
        const SHARES: [f64; 3] = [1.0 / 16.0, 0.25, 1.0];
        let most = self.most_before(surface, line);
        SHARES.iter().find_map(|share| {
            let way = surface.normal * (share * most);
            let above = Line { origin: line.origin + way, tmax: f64::INFINITY, ..*line };
            let ended = among_all(&self.tables, &above, None, probe);
            (!self.came_through_matter(&above, ended.found)).then_some((way, ended))
        })
    }

    /// The solid that a ray starts in which goes away from the back of that solid's own surface: rounding has let a ray come to that which ran along it.
    #[cold]
    fn solid_before(&self, surface: &Surface, line: &Line) -> Option<u32> {
        if surface.triangle as usize >= self.tables.triangles.len() {
            return None;
        }
        let start = line.origin + line.direction * line.tmin;
        let before = start + surface.normal * self.most_before(surface, line);
        let element = self.tables.record(surface.triangle).element;
        self.solid_at(before.to_array()).filter(|solid| *solid == element)
    }

    /// A way aside from where a ray starts, before the surface that it goes away from, no farther than to that surface: behind it no air begins, be the
    /// gap before it as narrow as it may.
    fn up_to(&self, surface: &Surface, line: &Line, way: DVec3) -> DVec3 {
        if surface.triangle as usize >= self.tables.triangles.len() {
            return way;
        }
        let [corner, ..] = Walk::new(&self.tables).corners(surface.triangle);
        let before = |point: DVec3| surface.normal.dot(point - corner);
        let start = line.origin + line.direction * line.tmin;
        let (here, there) = (before(start), before(start + way));
        if here >= 0.0 && there < 0.0 { way - surface.normal * there } else { way }
    }

    /// Where the ray itself meets the plane of what one beside it met; there, if it runs too much along it.
    fn in_its_plane(&self, line: &Line, found: Found) -> f64 {
        if found.triangle == NONE {
            return found.t;
        }
        let [a, b, c] = Walk::new(&self.tables).corners(found.triangle);
        let normal = (b - a).cross(c - a);
        let toward = normal.dot(line.direction);
        let is_along = toward.abs() <= EDGE_ON_SINE * normal.length();
        if is_along { found.t } else { normal.dot(a - line.origin) / toward }
    }

    /// Whether anything stands in the way of the ray between `tmin` and `tmax`. Stops at the first thing found.
    /// Glass stands in the way too. A ray that starts inside a solid is in its way, unless it leaves it for the air
    /// within the tolerance.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_from(Start::Anywhere, ray)
    }

    /// The same, from a start that the caller knows, as [`Scene::trace_from`] has it: from a hit to a lamp. There a ray that starts in a
    /// solid is not in its way, but for one that goes on from a hit which rounding has put into a solid beside.
    ///
    /// ```no_run
    /// # use enfilade::{Hit, Ray, Scene, Start};
    /// # fn lit(scene: &Scene, hit: &Hit, lamp: [f64; 3]) -> bool {
    /// let to_lamp = [0, 1, 2].map(|axis| lamp[axis] - hit.point[axis]);
    /// let faces = to_lamp.iter().zip(&hit.normal).map(|(a, b)| a * b).sum::<f64>() > 0.0;
    /// // Not what the lamp hangs on.
    /// let length = to_lamp.iter().map(|c| c * c).sum::<f64>().sqrt() - 0.01;
    /// faces && length > 0.0 && !scene.occluded_from(Start::Hit(hit), &Ray::segment(hit.point, to_lamp, 0.0, length))
    /// # }
    /// ```
    #[inline]
    pub fn occluded_from(&self, start: Start<'_>, ray: &Ray) -> bool {
        if self.is_one_cell()
            && let Some(quick) = self.alone(self.kernel, Ask::Any, start, ray)
        {
            return quick.found.triangle != NONE;
        }
        if let Start::Cell(cell @ 1..) = start
            && let Some(is_barred) = self.kernel.barred(&self.tables, ray, cell)
        {
            return is_barred;
        }
        self.is_occluded_from(start, ray)
    }

    /// The same, where that is no cell that is known, or in doubt there.
    #[inline(never)]
    fn is_occluded_from(&self, start: Start<'_>, ray: &Ray) -> bool {
        let (tables, kernel) = (&self.tables, self.kernel);
        if let Start::Hit(hit) = start {
            let surface = surface_of(hit, DVec3::from(ray.origin), ray.tmin);
            let is_barred = kernel.barred_from(tables, ray, hit.cell, &surface);
            // What is met first tells whether rounding has put it behind what it goes on from; any that is met does not.
            return is_barred.unwrap_or_else(|| self.brief(kernel, start, ray).0 != f64::INFINITY);
        }
        if let Start::Cell(cell) = start
            && tables.is_air(cell)
        {
            return self.is_occluded(start, ray);
        }
        let is_met = |quick: Quick| quick.found.triangle != NONE;
        // Around all others most start that are said to be in this cell.
        if let Start::Cell(_) = start
            && let Some(quick) = self.alone(kernel, Ask::Any, start, ray)
        {
            return is_met(quick);
        }
        let cell = self.free_cell(ray.origin);
        let is_barred = match cell {
            Some(cell) => kernel.barred(tables, ray, cell),
            None => self.alone(kernel, Ask::Any, start, ray).map(is_met),
        };
        is_barred.unwrap_or_else(|| self.is_occluded(known(start, ray, cell), ray))
    }

    /// The same where there is doubt, of a ray that starts on no surface that is known.
    #[cold]
    #[inline(never)]
    fn is_occluded(&self, start: Start<'_>, ray: &Ray) -> bool {
        let Some(line) = Line::new(&self.tables, ray) else { return false };
        let is_anywhere = matches!(start, Start::Anywhere);
        if is_anywhere && self.may_start_in_solid(&line) {
            return self.trace_from(start, ray, Want::LEAST).answer() != Answer::Escaped;
        }
        let probe = &mut Plain { kernel: self.kernel, ask: Ask::Any };
        if let Some(met) = self.meets_of_all(start, ray, probe) {
            return matches!(met, Met::At(..));
        }
        let ended = nearest(&self.tables, &line, None, start.hint(), probe);
        ended.found.triangle != NONE
            || (is_anywhere
                && ended.in_matter
                && self.solid_around(line.origin + line.direction * line.tmin).is_some())
    }

    #[inline]
    pub(super) fn describe(&self, line: &Line, Ended { found, cell, .. }: Ended, want: Want) -> Hit {
        let record = self.tables.record(found.triangle);
        let [a, b, c] = each(record.vertices, |v| DVec3::from(self.tables.vertices[v as usize]));
        let normal = (b - a).cross(c - a);
        let size = normal.length();
        let scale = if normal.dot(line.direction) > 0.0 { -1.0 / size } else { 1.0 / size };
        let normal = if scale.is_finite() { normal * scale } else { DVec3::ZERO };
        let point = line.origin + line.direction * found.t;
        let (cell, room) = match self.tables.room_of(cell) {
            Some(room) => (cell, room),
            _ if self.tables.cells.len() > 1 => self.air_before(point, normal),
            _ if want.room => (cell, self.room_before(line, found.t)),
            _ => (cell, NONE),
        };
        let kind = if want.face { Prisms::new(&self.tables).kind(cell, found.triangle) } else { None };
        Hit {
            // Not -0.
            t: found.t + 0.0,
            point: point.to_array(),
            normal: normal.to_array(),
            element: record.element,
            semantic: kind.unwrap_or_else(|| self.semantic_of(record.element)),
            material: record.material,
            cell,
            room,
            triangle: found.triangle,
        }
    }

    #[inline(always)]
    fn semantic_of(&self, element: u32) -> u32 {
        u32::from(self.tables.semantics[element as usize])
    }

    /// The cell of air before a surface that was not met on a walk through cells, and its room.
    fn air_before(&self, point: DVec3, normal: DVec3) -> (u32, u32) {
        /// Farther from a face than cells are blurred, as is what tells a cell soon.
        const AHEAD: f64 = 3.0 * BLURRED;
        let prisms = Prisms::new(&self.tables);
        let is_air = |&cell: &u32| self.tables.is_air(cell);
        let air = |point: DVec3| prisms.place(prisms.local(point), self.tolerance()).filter(is_air);
        // On the side from which it was met: an open surface has air on both. No farther: in small models the next cell may be as near as cells are blurred.
        let before = point + normal * (0.5 * self.tolerance());
        // Mostly the one a little farther on, which is found sooner: it holds this place, too.
        let ahead = (point + normal * AHEAD).to_array();
        let holds = |&(cell, _): &(u32, bool)| {
            prisms.nearly_holds(&prisms.cells[cell as usize], prisms.local(before), -NEAR)
        };
        let cell = self.kernel.free(&self.tables, ahead, NONE).filter(holds).map(|(cell, _)| cell);
        let cell = cell.or_else(|| air(before)).or_else(|| air(point)).unwrap_or(0);
        (cell, self.tables.cells[cell as usize].room)
    }

    /// The room in which the ray ends at `t`: labels may end a little before the surface, so also looked for a little
    /// before it.
    fn room_before(&self, line: &Line, t: f64) -> u32 {
        /// How far room labels may stay behind the surfaces around them, metres.
        const GAP: f64 = 0.05;
        [self.tolerance(), GAP]
            .iter()
            .map(|back| (line.origin + line.direction * (t - back).max(line.tmin)).to_array())
            .find_map(|point| self.room_at(point))
            .unwrap_or(NONE)
    }
}

/// Whether a ray goes away from the surface that it starts on: not through it, be that into a solid.
#[inline]
pub(super) fn is_away(surface: &Surface, line: &Line) -> bool {
    line.direction.dot(surface.normal) > 0.0
}

/// Where a ray starts, once its place is known: farther from all solids than cells tell, if it starts there.
#[inline]
pub(super) fn known<'a>(start: Start<'a>, ray: &Ray, cell: Option<u32>) -> Start<'a> {
    match (start, cell) {
        (Start::Anywhere | Start::Cell(_), Some(cell)) if ray.tmin <= 0.0 => Start::Cell(cell),
        _ => start,
    }
}

/// A vector whose squared length is no farther than this from one has unit length: no rounding brings it nearer for
/// sure.
const UNIT: f64 = 4.0 * f64::EPSILON;

/// The vector at unit length, whatever its length was; `None` if that cannot be.
#[inline]
fn unit(vector: DVec3) -> Option<DVec3> {
    let squared = vector.length_squared();
    if (squared - 1.0).abs() <= UNIT {
        return Some(vector);
    }
    let unit = if squared > 1e-200 && squared < 1e200 {
        vector / squared.sqrt()
    } else {
        // The square of a very long or very short vector is no number: scaled first.
        (vector / vector.abs().max_element()).normalize()
    };
    unit.is_finite().then_some(unit)
}

/// A ray that meets the hull.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    pub(super) tmin: f64,
    pub(super) tmax: f64,
    /// Where it enters the hull, or `tmin`.
    pub(super) start: f64,
}

impl Line {
    /// `None` for a ray that is none, or that does not meet the hull.
    #[inline]
    pub(super) fn new(tables: &Views, ray: &Ray) -> Option<Line> {
        if !ray.is_valid() {
            return None;
        }
        let direction = unit(DVec3::from(ray.direction))?;
        let origin = DVec3::from(ray.origin);
        let scene = &tables.scene[0];
        let (lo, hi) = (DVec3::from(scene.hull[0]), DVec3::from(scene.hull[1]));
        let tmin = ray.tmin.max(0.0);
        let line = Line { origin, direction, tmin, tmax: ray.tmax, start: tmin };
        if tmin == 0.0 && origin.cmpge(lo).all() && origin.cmple(hi).all() {
            return Some(line);
        }
        let (mut enter, mut leave) = (tmin, ray.tmax);
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                if o < lo[axis] || o > hi[axis] {
                    return None;
                }
                continue;
            }
            let (a, b) = ((lo[axis] - o) / d, (hi[axis] - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        // The hull has a margin around all triangles, so that rounding here loses none of them.
        (enter <= leave).then_some(Line { start: enter, ..line })
    }

    #[inline(always)]
    pub(super) fn query<'s>(&self, tables: &Views, surface: Option<&'s Surface>) -> Query<'s> {
        let scene = &tables.scene[0];
        let root = tables.cells[0].root;
        let tmin = surface.map_or(self.tmin, |surface| self.tmin - surface.behind());
        let range = (tmin, self.tmax);
        Query::new(self.origin, self.direction, range, self.start, scene, root, surface)
    }
}

/// What a restarted ray starts on.
#[inline]
pub(super) fn surface(start: Start<'_>, line: &Line) -> Option<Surface> {
    let Start::Hit(hit) = start else { return None };
    Some(surface_of(hit, line.origin, line.tmin))
}

/// The same of a ray from its hit.
#[inline]
pub(super) fn surface_of(hit: &Hit, origin: DVec3, tmin: f64) -> Surface {
    let near = (ON_PLANE * (1.0 + origin.abs().max_element())).max(OFF * hit.t);
    Surface { triangle: hit.triangle, normal: DVec3::from(hit.normal), near, aside: 0.0, tmin }
}
