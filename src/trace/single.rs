//! One ray.

use glam::DVec3;

use super::alone::alone;
use super::cells::{Ended, nearest};
use super::cost::{Cost, Costs};
use super::doubt::Met;
use super::kernel::{Ask, Kernel, Plain, Probe};
use super::lanes::Portable;
use super::line::{Line, surface_of};
use super::quick::{Quick, nothing, quick, quick_from};
use super::ray::{Answer, Brief, Hit, NONE, Ray};
use crate::scene::Scene;

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

impl Start<'_> {
    /// The cell in which it may be, or none.
    #[inline(always)]
    pub(super) fn hint(self) -> u32 {
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
}

/// Where a ray starts, once its place is known: farther from all solids than cells tell, if it starts there.
#[inline]
pub(super) fn known<'a>(start: Start<'a>, ray: &Ray, cell: Option<u32>) -> Start<'a> {
    match (start, cell) {
        (Start::Anywhere | Start::Cell(_), Some(cell)) if ray.tmin <= 0.0 => Start::Cell(cell),
        _ => start,
    }
}
