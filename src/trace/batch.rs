//! Many rays at once, into the caller's own buffers.

use super::kernel::{Ask, Kernel};
use super::locate::Place;
use super::packet::{Answers, BLOCK};
use super::quick::Quick;
use super::ray::{Brief, Hit, NONE, Ray};
use super::single::{Start, Want, known};
use crate::scene::Scene;

/// Rays that one task takes at a time: of those that come in the order of their starts, and of others.
const IN_ORDER: usize = 1 << 10;
const SCATTERED: std::ops::RangeInclusive<usize> = 1 << 13..=1 << 18;

/// Rays are in order if at most one of so many starts elsewhere than the one before.
const RUN: usize = 4;

/// So many pairs of rays are looked at to tell.
const LOOKS: usize = 256;

/// With fewer cells, which stay in a processor's caches, rays that start in different ones are faster as they come.
const MANY_CELLS: usize = 1 << 10;

/// Rays are put in the order of at most so many places.
const PLACES: usize = 1 << 17;

/// From where the rays of a batch start, if the caller knows: then nothing is looked up.
#[derive(Clone, Copy, Debug)]
pub enum Starts<'a> {
    /// Anywhere: origins are located first.
    Anywhere,
    /// In the air: all of this cell, as [`Start::Cell`].
    Cell(u32),
    /// In the air: the i-th ray of the i-th cell, as [`Start::Cell`].
    Cells(&'a [u32]),
    /// On a surface: the i-th ray of the i-th hit, as [`Start::Hit`]. With [`Starts::Anywhere`] such a ray takes as long as eight to twelve others:
    /// in which air a point on a surface is has to be found out.
    Hits(&'a [Hit]),
}

impl<'a> Starts<'a> {
    pub(crate) fn of(self, index: usize) -> Start<'a> {
        match self {
            Starts::Hits(hits) => Start::Hit(&hits[index]),
            Starts::Anywhere => Start::Anywhere,
            Starts::Cell(cell) => Start::Cell(cell),
            Starts::Cells(cells) => Start::Cell(cells[index]),
        }
    }

    /// The cells of some of the rays, from the first on; none of those of which they are not known.
    #[inline(always)]
    fn fill(self, first: usize, cells: &mut [u32]) {
        match self {
            Starts::Anywhere | Starts::Hits(_) => cells.fill(NONE),
            Starts::Cell(cell) => cells.fill(cell),
            Starts::Cells(all) => cells.copy_from_slice(&all[first..first + cells.len()]),
        }
    }

    /// Those of some of the rays.
    fn part(self, first: usize, count: usize) -> Starts<'a> {
        match self {
            Starts::Cells(cells) => Starts::Cells(&cells[first..first + count]),
            Starts::Hits(hits) => Starts::Hits(&hits[first..first + count]),
            other => other,
        }
    }
}

/// Rays, and what is asked of them.
#[derive(Clone, Copy)]
struct Batch<'a> {
    ask: Ask,
    kernel: Kernel,
    starts: Starts<'a>,
    rays: &'a [Ray],
}

/// How a batch is answered: the answers are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plan {
    /// One ray after the other.
    One,
    /// Eight rays that follow each other at once, as long as they go together.
    Together,
    /// Eight rays at once, each its own way.
    Apart,
    /// The same in the order of the places at which they start.
    Sorted,
}

/// Calls `each` with blocks of so many items of the slices, on all threads of the current rayon pool.
fn for_each_block<A: Send>(
    rays: &[Ray],
    starts: Starts<'_>,
    answers: &mut [A],
    size: usize,
    each: impl Fn(&[Ray], Starts<'_>, &mut [A]) + Sync,
) {
    let block = |(index, (rays, answers)): (usize, (&[Ray], &mut [A]))| {
        each(rays, starts.part(index * size, rays.len()), answers)
    };
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        if rays.len() > size {
            rays.par_chunks(size).zip(answers.par_chunks_mut(size)).enumerate().for_each(block);
            return;
        }
    }
    rays.chunks(size).zip(answers.chunks_mut(size)).enumerate().for_each(block);
}

/// What is seldom needed, out of the way of what is.
#[cold]
#[inline(never)]
fn aside<A>(answer: impl FnOnce() -> A) -> A {
    answer()
}

/// Of how many threads the work is.
fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    1
}

/// The places of things in the order of their keys, each less than `keys`; of equal ones as they are.
fn places_of(of: &[u32], keys: usize) -> Vec<u32> {
    let mut starts = vec![0u32; keys + 1];
    for &key in of {
        starts[key as usize + 1] += 1;
    }
    for key in 0..keys {
        starts[key + 1] += starts[key];
    }
    let mut order = vec![0; of.len()];
    for (&key, to) in of.iter().zip(&mut order) {
        let place = &mut starts[key as usize];
        *to = *place;
        *place += 1;
    }
    order
}

impl Scene {
    /// What each ray meets first; `hits[i]` is the record of `rays[i]` (see [`Hit::answer`]): what [`Scene::trace_from`] answers.
    ///
    /// Rays that are neighbours in the slice are traced together: faster where they start in the same cells and go similar ways. Of scenes of
    /// 1,024 cells and more, rays that start all over them are copied and put in order: at most 2^18 of them at a time on each thread, 21 MB.
    ///
    /// With the feature `rayon` the work is shared among the threads of the current pool: call it inside
    /// `ThreadPool::install` to use your own. The answers do not depend on it.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn trace_many(&self, rays: &[Ray], hits: &mut [Hit], want: Want) {
        self.trace_many_of(Starts::Anywhere, rays, hits, want);
    }

    /// What each ray from the air of one cell meets first, as [`Scene::trace_many`]: origins are not looked up.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn trace_many_from(&self, cell: u32, rays: &[Ray], hits: &mut [Hit], want: Want) {
        self.trace_many_of(Starts::Cell(cell), rays, hits, want);
    }

    /// What each ray meets first, as [`Scene::trace_many`], from starts that the caller knows.
    ///
    /// # Panics
    /// If the slices, that of `starts` too, differ in length.
    pub fn trace_many_of(&self, starts: Starts<'_>, rays: &[Ray], hits: &mut [Hit], want: Want) {
        self.many(
            Batch { ask: Ask::First, kernel: self.kernel, starts, rays },
            hits,
            |quick, ray| self.describe_quick(ray, quick, want),
            |start, ray| self.trace_with(self.kernel, start, ray, want),
        );
    }

    /// What each ray meets first, in brief: what [`Scene::trace_brief`] answers, as [`Scene::trace_many`].
    ///
    /// # Panics
    /// If the slices, that of `starts` too, differ in length.
    pub fn trace_brief_many(&self, starts: Starts<'_>, rays: &[Ray], briefs: &mut [Brief]) {
        self.trace_brief_many_with(self.kernel, starts, rays, briefs);
    }

    /// [`Scene::trace_brief_many`] on a kernel of choice.
    ///
    /// # Panics
    /// As that.
    pub fn trace_brief_many_with(
        &self,
        kernel: Kernel,
        starts: Starts<'_>,
        rays: &[Ray],
        briefs: &mut [Brief],
    ) {
        self.many(
            Batch { ask: Ask::First, kernel, starts, rays },
            briefs,
            |quick, _| quick.brief(),
            |start, ray| self.trace_brief_with(kernel, start, ray),
        );
    }

    #[cfg(all(test, feature = "compile"))]
    fn briefs_as(&self, plan: Plan, kernel: Kernel, starts: Starts<'_>, rays: &[Ray], briefs: &mut [Brief]) {
        self.many_as(
            plan,
            Batch { ask: Ask::First, kernel, starts, rays },
            briefs,
            |quick, _| quick.brief(),
            |start, ray| self.trace_brief_with(kernel, start, ray),
        );
    }

    /// Whether anything stands in the way of each ray, see [`Scene::occluded`].
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        self.occluded_many_of(Starts::Anywhere, rays, occluded);
    }

    /// Whether anything stands in the way of each ray, see [`Scene::occluded_from`], from starts that the caller knows.
    ///
    /// # Panics
    /// If the slices, that of `starts` too, differ in length.
    pub fn occluded_many_of(&self, starts: Starts<'_>, rays: &[Ray], occluded: &mut [bool]) {
        self.many(
            Batch { ask: Ask::Any, kernel: self.kernel, starts, rays },
            occluded,
            |quick, _| quick.found.triangle != NONE,
            |start, ray| self.occluded_from(start, ray),
        );
    }

    /// Where each point (internal frame, metres) lies: what [`Scene::locate`] answers. Points may come in any order.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn locate_many(&self, points: &[[f64; 3]], places: &mut [Place]) {
        assert_eq!(points.len(), places.len(), "as many places as points");
        let block = |(points, places): (&[[f64; 3]], &mut [Place])| {
            for (points, places) in points.chunks(BLOCK).zip(places.chunks_mut(BLOCK)) {
                let mut cells = [NONE; BLOCK];
                self.free_cells(points.iter().copied(), &mut cells);
                for ((&point, cell), place) in points.iter().zip(cells).zip(places) {
                    *place = self.place_of(point, cell);
                }
            }
        };
        #[cfg(feature = "rayon")]
        {
            use rayon::prelude::*;
            if points.len() > IN_ORDER {
                points.par_chunks(IN_ORDER).zip(places.par_chunks_mut(IN_ORDER)).for_each(block);
                return;
            }
        }
        block((points, places));
    }

    /// Answers all rays: `told` has the answer of a lane that is known, `alone` that of a ray by itself.
    fn many<A: Send>(
        &self,
        batch: Batch<'_>,
        answers: &mut [A],
        told: impl Fn(&Quick, &Ray) -> A + Sync,
        alone: impl Fn(Start<'_>, &Ray) -> A + Sync,
    ) {
        let Batch { starts, rays, .. } = batch;
        assert_eq!(rays.len(), answers.len(), "as many answers as rays");
        match starts {
            Starts::Cells(cells) => assert_eq!(rays.len(), cells.len(), "as many cells as rays"),
            Starts::Hits(hits) => assert_eq!(rays.len(), hits.len(), "as many hits as rays"),
            Starts::Anywhere | Starts::Cell(_) => {}
        }
        let is_large = rays.len() > *SCATTERED.start() && self.tables.cells.len() >= MANY_CELLS;
        let plan = if matches!(starts, Starts::Hits(_)) || self.is_one_cell() {
            // Packets go from cell to cell.
            Plan::One
        } else if !is_scattered(starts, rays) {
            Plan::Together
        } else if batch.ask == Ask::Any {
            // Most go through a cell or two and look at nothing there: putting them together takes longer.
            Plan::One
        } else if is_large {
            Plan::Sorted
        } else if batch.kernel == Kernel::PORTABLE {
            // It takes rays one by one anyway.
            Plan::One
        } else if self.start_outside(starts, rays) {
            // Most go out between other things: so do these.
            Plan::One
        } else {
            Plan::Apart
        };
        self.many_as(plan, batch, answers, told, alone);
    }

    /// Whether most rays start in outer air.
    fn start_outside(&self, starts: Starts<'_>, rays: &[Ray]) -> bool {
        // Of few where there are few rays: some have to be located.
        let looks = (rays.len() / BLOCK).clamp(1, LOOKS);
        let is_outside = |&index: &usize| {
            let origin = rays[index].origin;
            let told = match starts {
                Starts::Cells(cells) => cells[index],
                _ => self.free_cell(origin).unwrap_or(NONE),
            };
            self.tables.is_outer(told) || !self.tables.is_air(told) && !self.is_in_zone(origin)
        };
        2 * (0..looks).map(|look| look * rays.len() / looks).filter(is_outside).count() > looks
    }

    /// The same as planned.
    fn many_as<A: Send>(
        &self,
        plan: Plan,
        batch: Batch<'_>,
        answers: &mut [A],
        told: impl Fn(&Quick, &Ray) -> A + Sync,
        alone: impl Fn(Start<'_>, &Ray) -> A + Sync,
    ) {
        let Batch { ask, kernel, starts, rays } = batch;
        // Packets know nothing of surfaces.
        debug_assert!(plan == Plan::One || !matches!(starts, Starts::Hits(_)));
        let size = match plan {
            Plan::Sorted => (rays.len() / (2 * threads())).clamp(*SCATTERED.start(), *SCATTERED.end()),
            _ => IN_ORDER,
        };
        let otherwise = |starts: Starts<'_>, index: usize, ray: &Ray| aside(|| alone(starts.of(index), ray));
        for_each_block(rays, starts, answers, size, |rays, starts, answers| match plan {
            Plan::One if matches!(starts, Starts::Anywhere) && !self.is_one_cell() => {
                for (rays, answers) in rays.chunks(BLOCK).zip(answers.chunks_mut(BLOCK)) {
                    let mut cells = [NONE; BLOCK];
                    self.free_cells(rays.iter().map(|ray| ray.origin), &mut cells);
                    for ((ray, cell), to) in rays.iter().zip(cells).zip(answers) {
                        let cell = (cell != NONE).then_some(cell);
                        *to = alone(known(Start::Anywhere, ray, cell), ray);
                    }
                }
            }
            Plan::One => {
                for (index, (ray, to)) in rays.iter().zip(answers).enumerate() {
                    *to = alone(starts.of(index), ray);
                }
            }
            Plan::Together | Plan::Apart => {
                let cells = |first: usize, cells: &mut [u32]| starts.fill(first, cells);
                self.blocks(ask, kernel, plan, cells, rays, |index, quick| match quick {
                    Some(quick) => answers[index] = told(&quick, &rays[index]),
                    None => answers[index] = otherwise(starts, index, &rays[index]),
                });
            }
            Plan::Sorted => {
                let order = self.order(starts, rays);
                // Written in any order, and read one after the other: the other way around each would be waited for.
                let mut sorted = vec![Ray::new([0.0; 3], [0.0; 3]); rays.len()];
                let mut numbers = vec![(0u32, NONE); rays.len()];
                for (index, (ray, &place)) in rays.iter().zip(&order).enumerate() {
                    sorted[place as usize] = *ray;
                    let mut cell = [NONE];
                    starts.fill(index, &mut cell);
                    numbers[place as usize] = (index as u32, cell[0]);
                }
                let cells = |first: usize, cells: &mut [u32]| {
                    for (cell, &(_, told)) in cells.iter_mut().zip(&numbers[first..]) {
                        *cell = told;
                    }
                };
                self.blocks(ask, kernel, plan, cells, &sorted, |index, quick| {
                    let number = numbers[index].0 as usize;
                    match quick {
                        Some(quick) => answers[number] = told(&quick, &sorted[index]),
                        None => answers[number] = otherwise(starts, number, &sorted[index]),
                    }
                });
            }
        });
    }

    /// The prisms of air that hold points, at most [`BLOCK`] of them, where that is in no doubt; else [`NONE`].
    #[inline]
    fn free_cells(&self, points: impl ExactSizeIterator<Item = [f64; 3]>, cells: &mut [u32; BLOCK]) {
        let (mut padded, count) = ([[0.0; 4]; BLOCK], points.len());
        for (to, [x, y, z]) in padded.iter_mut().zip(points) {
            *to = [x, y, z, 0.0];
        }
        self.kernel.free_many(&self.tables, &padded[..count], &mut cells[..count]);
    }

    /// The rays in the order of the places at which they start.
    fn order(&self, starts: Starts<'_>, rays: &[Ray]) -> Vec<u32> {
        let count = match starts {
            Starts::Cells(_) => self.tables.cells.len(),
            _ => self.tables.airguess.len(),
        };
        let mut shift = 0;
        while count >> shift > PLACES {
            shift += 1;
        }
        let places = (count >> shift) + 2;
        let key = |place: usize| (place >> shift).min(places - 1) as u32;
        let keys: Vec<u32> = match starts {
            Starts::Cells(cells) => cells.iter().map(|&cell| key(cell as usize)).collect(),
            _ => rays.iter().map(|ray| key(self.cube(ray.origin).unwrap_or(usize::MAX))).collect(),
        };
        places_of(&keys, places)
    }

    /// Looks at rays, a block of them at a time; `cells` tells those from the i-th on, if the caller knows them. Tells a ray's number, and what
    /// it meets that is in no doubt.
    fn blocks(
        &self,
        ask: Ask,
        kernel: Kernel,
        plan: Plan,
        cells: impl Fn(usize, &mut [u32]),
        rays: &[Ray],
        mut tell: impl FnMut(usize, Option<Quick>),
    ) {
        let (mut answers, mut told) = (Answers::NONE, [NONE; BLOCK]);
        // Where the ray before started.
        let (mut known, mut last) = (NONE, ([f64::NAN; 3], NONE));
        let mut ahead = rays.chunks(BLOCK).skip(1);
        for (group, rays) in rays.chunks(BLOCK).enumerate() {
            let (first, count) = (group * BLOCK, rays.len());
            cells(first, &mut told[..count]);
            kernel.fetch(ahead.next().unwrap_or_default());
            let is_found = plan != Plan::Together && told[..count].iter().all(|&cell| cell == NONE);
            if is_found {
                self.free_cells(rays.iter().map(|ray| ray.origin), &mut told);
            }
            for (ray, cell) in rays.iter().zip(&mut told) {
                if is_found {
                    break;
                }
                if *cell != known {
                    known = if self.tables.is_air(*cell) { *cell } else { NONE };
                }
                if known == NONE && last.0 != ray.origin {
                    let hint = if plan == Plan::Apart { NONE } else { last.1 };
                    last = (ray.origin, self.free_cell_near(ray.origin, hint).unwrap_or(NONE));
                }
                *cell = if known == NONE { last.1 } else { known };
            }
            let scattered = plan != Plan::Together;
            kernel.packets(ask, &self.tables, rays, &mut told[..count], scattered, &mut answers);
            for ray in 0..count {
                if let Some(quick) = answers.get(ray) {
                    tell(first + ray, Some(quick));
                }
            }
            if !answers.are_all(count) {
                for ray in 0..count {
                    if answers.get(ray).is_none() {
                        tell(first + ray, None);
                    }
                }
            }
        }
    }
}

/// Whether rays that follow each other start in different places.
fn is_scattered(starts: Starts<'_>, rays: &[Ray]) -> bool {
    if rays.len() <= BLOCK {
        return false;
    }
    let differs = |index: usize| match starts {
        Starts::Anywhere => rays[index].origin != rays[index + 1].origin,
        Starts::Cell(_) | Starts::Hits(_) => false,
        Starts::Cells(cells) => cells[index] != cells[index + 1],
    };
    let pairs = rays.len() - 1;
    let looks = LOOKS.min(pairs);
    (0..looks).filter(|look| differs(look * pairs / looks)).count() * RUN > looks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_come_in_order_and_equal_ones_stay_as_they_are() {
        assert_eq!(places_of(&[3, 0, 3, 1, 0], 4), [3, 0, 4, 2, 1]);
        assert_eq!(places_of(&[], 1), [0u32; 0]);
    }
}

#[cfg(all(test, feature = "compile"))]
mod scene_tests {
    use glam::DVec3;

    use super::*;
    use crate::closing::{Leaf, Stand};
    use crate::importers::Semantic;
    use crate::samples::Sample;
    use crate::splitmix::SplitMix64;

    /// Rays and fans of rays from places in the air, as pictures have them: to anywhere, or within two millimetres of corners of triangles.
    /// Of some the direction is not unit, some end, within a millimetre of what they meet, some start farther on, and some are none.
    fn rays(scene: &Scene, count: usize, seed: u64) -> (Vec<Ray>, Vec<u32>) {
        let mut random = SplitMix64::new(seed);
        let [lo, hi] = scene.hull();
        let boxes: Vec<[[f64; 3]; 2]> = scene.rooms().map(|room| room.bounds()).chain([[lo, hi]]).collect();
        let (mut rays, mut cells) = (Vec::new(), Vec::new());
        while rays.len() < count {
            let [lo, hi] = boxes[random.below(boxes.len() as u64) as usize];
            let mut point = || DVec3::from([0, 1, 2].map(|i| random.between(lo[i], hi[i])));
            let (from, to, aside) = (point(), point(), point());
            let cell = match scene.locate(from.to_array()) {
                Place::Air { cell, .. } => cell,
                _ => continue,
            };
            let fan = [1, 8, 24][random.below(3) as usize];
            let mut step = (aside - to) * [0.002, 0.05][random.below(2) as usize];
            let mut to = to;
            if random.below(2) == 0 {
                let triangle = random.below(scene.detail_triangle_count().into()) as u32;
                let corner = scene.triangle(triangle)[random.below(3) as usize];
                to = DVec3::from(corner.map(|c| c + random.between(-0.002, 0.002)));
                step = step.normalize_or_zero() * 2e-4;
            }
            for i in 0..fan {
                let way = to + step * f64::from(i) - from;
                let mut ray = Ray::new(from.to_array(), way.to_array());
                match random.below(40) {
                    18..22 => {
                        let met = scene.trace_brief(Start::Anywhere, &ray).t;
                        ray.tmax = (met + random.between(-0.001, 0.001)).max(0.0);
                    }
                    0..10 => ray.direction = way.normalize_or_zero().to_array(),
                    10..14 => ray.tmax = way.length(),
                    14 => ray.tmin = 0.5,
                    15 => ray.direction = [0.0, 0.0, way.z],
                    16 => ray.direction[random.below(3) as usize] = f64::NAN,
                    17 => ray.tmax = 0.0,
                    _ => {}
                }
                rays.push(ray);
                // Also wrong ones.
                cells.push(if random.below(50) == 0 { random.below(40) as u32 } else { cell });
            }
        }
        (rays, cells)
    }

    #[test]
    fn points_are_located_as_single_ones_are() {
        let scene = Sample::Build1.scene();
        let mut random = SplitMix64::new(5);
        let [lo, hi] = scene.hull();
        let mut at = [0.0; 3];
        let points: Vec<[f64; 3]> = (0..20_000)
            .map(|i| {
                match i % 8 {
                    0 => at = [0, 1, 2].map(|axis| random.between(lo[axis] - 1.0, hi[axis] + 1.0)),
                    7 if i % 5 == 0 => at[i % 3] = f64::NAN,
                    _ => at = at.map(|c| c + random.between(-0.2, 0.2)),
                }
                at
            })
            .collect();
        let mut places = vec![Place::Outside; points.len()];
        scene.locate_many(&points, &mut places);
        let air = places.iter().filter(|place| matches!(place, Place::Air { .. })).count();
        assert!(air > points.len() / 4, "{air}");
        for (point, place) in points.iter().zip(&places) {
            assert_eq!(*place, scene.locate(*point), "{point:?}");
        }
    }

    fn bits(brief: &Brief) -> (u64, u32, u32) {
        (brief.t.to_bits(), brief.triangle, brief.cell)
    }

    /// That batches answer as single rays do, to the last bit, on all kernels and as each plan has it.
    fn check(name: &str, mut scene: Scene) {
        let (rays, cells) = rays(&scene, 12_000, 7);
        for kernel in Kernel::available() {
            for starts in [Starts::Cells(&cells), Starts::Anywhere] {
                let single: Vec<Brief> =
                    (0..rays.len()).map(|i| scene.trace_brief_with(kernel, starts.of(i), &rays[i])).collect();
                let met = single.iter().filter(|brief| brief.triangle != NONE).count();
                assert!(met > rays.len() / 2, "{name}: {met} hits");
                for plan in [Plan::One, Plan::Together, Plan::Apart, Plan::Sorted] {
                    let mut briefs = vec![Brief::ESCAPED; rays.len()];
                    scene.briefs_as(plan, kernel, starts, &rays, &mut briefs);
                    for (i, (brief, single)) in briefs.iter().zip(&single).enumerate() {
                        let what = (brief, single, &rays[i], cells[i]);
                        assert_eq!(bits(brief), bits(single), "{name} {} {plan:?}: {what:?}", kernel.name());
                    }
                }
            }
        }
        for kernel in Kernel::available() {
            scene = scene.with_kernel(kernel);
            let mut hits = vec![Hit::ESCAPED; rays.len()];
            scene.trace_many(&rays, &mut hits, Want::default());
            let mut occluded = vec![false; rays.len()];
            scene.occluded_many(&rays, &mut occluded);
            for (i, ray) in rays.iter().enumerate() {
                let hit = scene.trace_from(Start::Anywhere, ray, Want::default());
                assert_eq!(bytemuck::bytes_of(&hits[i]), bytemuck::bytes_of(&hit), "{name}: {ray:?}");
                assert_eq!(occluded[i], scene.occluded(ray), "{name}: {ray:?}");
            }
        }
        // As each plan has it: whole answers, whether there is one, and blocks that are not full.
        let single: Vec<Hit> = (0..rays.len())
            .map(|i| scene.trace_from(Start::Cell(cells[i]), &rays[i], Want::default()))
            .collect();
        for plan in [Plan::Together, Plan::Apart, Plan::Sorted] {
            let kernel = scene.kernel;
            let mut hits = vec![Hit::ESCAPED; rays.len()];
            scene.many_as(
                plan,
                Batch { ask: Ask::First, kernel, starts: Starts::Cells(&cells), rays: &rays },
                &mut hits,
                |quick, ray| scene.describe_quick(ray, quick, Want::default()),
                |start, ray| scene.trace_from(start, ray, Want::default()),
            );
            assert_eq!(
                bytemuck::cast_slice::<_, u8>(&hits),
                bytemuck::cast_slice::<_, u8>(&single),
                "{name}"
            );
            let answer = |starts: Starts<'_>, rays: &[Ray]| {
                let mut occluded = vec![false; rays.len()];
                scene.many_as(
                    plan,
                    Batch { ask: Ask::Any, kernel, starts, rays },
                    &mut occluded,
                    |quick, _| quick.found.triangle != NONE,
                    |start, ray| scene.occluded_from(start, ray),
                );
                occluded
            };
            let occluded = answer(Starts::Cells(&cells), &rays);
            for (i, ray) in rays.iter().enumerate() {
                let alone = scene.occluded_from(Start::Cell(cells[i]), ray);
                assert_eq!(occluded[i], alone, "{name} {plan:?}: {ray:?}");
            }
            for count in [1, 2, 7, 9, BLOCK - 1, BLOCK + 1, BLOCK + 2] {
                let one = answer(Starts::Cell(cells[0]), &rays[..count]);
                for (ray, is_met) in rays.iter().zip(one) {
                    let alone = scene.occluded_from(Start::Cell(cells[0]), ray);
                    assert_eq!(is_met, alone, "{name} {plan:?}, {count}: {ray:?}");
                }
            }
        }
        // On from what they met.
        let met: Vec<Hit> = rays
            .iter()
            .zip(&cells)
            .map(|(ray, &cell)| scene.trace_from(Start::Cell(cell), ray, Want::LEAST))
            .filter(|hit| hit.triangle != NONE)
            .collect();
        let on: Vec<Ray> = (0..)
            .zip(&met)
            .map(|(i, hit)| {
                let aside = DVec3::new(f64::from(i % 7), f64::from(i % 11), f64::from(i % 13)) / 13.0 - 0.4;
                Ray::new(hit.point, (DVec3::from(hit.normal) + aside).to_array())
            })
            .collect();
        let mut hits = vec![Hit::ESCAPED; on.len()];
        scene.trace_many_of(Starts::Hits(&met), &on, &mut hits, Want::LEAST);
        let mut occluded = vec![false; on.len()];
        scene.occluded_many_of(Starts::Hits(&met), &on, &mut occluded);
        for (i, ray) in on.iter().enumerate() {
            let start = Start::Hit(&met[i]);
            let single = scene.trace_from(start, ray, Want::LEAST);
            assert_eq!(bytemuck::bytes_of(&hits[i]), bytemuck::bytes_of(&single), "{name}: {ray:?}");
            assert_eq!(occluded[i], scene.occluded_from(start, ray), "{name}: {ray:?}");
        }
        // Some of one cell, and fewer than eight.
        for count in [1, 3, 7, 20] {
            for (rays, cells) in rays.chunks(count).zip(cells.chunks(count)).take(200) {
                let mut hits = vec![Hit::ESCAPED; rays.len()];
                scene.trace_many_from(cells[0], rays, &mut hits, Want::LEAST);
                for (ray, hit) in rays.iter().zip(&hits) {
                    let single = scene.trace_from(Start::Cell(cells[0]), ray, Want::LEAST);
                    assert_eq!(bytemuck::bytes_of(hit), bytemuck::bytes_of(&single), "{name}: {ray:?}");
                }
            }
        }
    }

    /// Rays from one place in the air of a cell: in a row, in squares of eight by eight, or each way within a cone, narrow or wide. Of some fans
    /// the rays end, or the directions are not unit, or one of the rays is none.
    fn fan(scene: &Scene, random: &mut SplitMix64) -> Option<(u32, Vec<Ray>)> {
        let [lo, hi] = scene.hull();
        let mut point = || DVec3::from([0, 1, 2].map(|i| random.between(lo[i], hi[i])));
        let (from, to, aside) = (point(), point(), point());
        let Place::Air { cell, .. } = scene.locate(from.to_array()) else { return None };
        let mut toward = (to - from).normalize_or_zero();
        match random.below(8) {
            0 => toward = DVec3::Z,
            1 => toward = DVec3::NEG_Z,
            2 => toward.z = 0.0,
            3 => {
                let triangle = random.below(scene.detail_triangle_count().into()) as u32;
                toward = (DVec3::from(scene.triangle(triangle)[0]) - from).normalize_or_zero();
            }
            _ => {}
        }
        let over = toward.cross(aside - from).normalize_or_zero();
        let across = over.cross(toward);
        let wide = 10f64.powf(random.between(-6.0, 0.3));
        let count = [9, 40, 64, 200, 256][random.below(5) as usize];
        let (kind, ends, size) =
            (random.below(3), random.below(4) == 0, [0.0, 1.0, 1e-3][random.below(3) as usize]);
        let mut fan = Vec::new();
        for i in 0..count {
            let [x, y] = match kind {
                0 => [f64::from(i), 0.0],
                1 => [f64::from(i / 64 * 8 + i % 8), f64::from(i % 64 / 8)],
                _ => [random.between(-20.0, 20.0), random.between(-20.0, 20.0)],
            };
            let way = toward + (across * (x - 20.0) + over * y) * wide / 32.0;
            let direction = if size == 0.0 { way.normalize() } else { way * size };
            let mut ray = Ray::new(from.to_array(), direction.to_array());
            if ends {
                let met = scene.trace_brief(Start::Cell(cell), &ray).t;
                ray.tmax = [met, met.next_down(), 2.0, met + 1.0][random.below(4) as usize].max(0.0);
            }
            fan.push(ray);
        }
        if random.below(20) == 0 {
            fan[random.below(count as u64) as usize].direction[1] = f64::NAN;
        }
        Some((cell, fan))
    }

    fn check_fans(name: &str, scene: &Scene) {
        let mut random = SplitMix64::new(11);
        let mut met = 0;
        for _ in 0..1500 {
            let Some((cell, fan)) = fan(scene, &mut random) else { continue };
            for kernel in Kernel::available() {
                let mut briefs = vec![Brief::ESCAPED; fan.len()];
                scene.trace_brief_many_with(kernel, Starts::Cell(cell), &fan, &mut briefs);
                for (ray, brief) in fan.iter().zip(&briefs) {
                    let single = scene.trace_brief_with(kernel, Start::Cell(cell), ray);
                    assert_eq!(bits(brief), bits(&single), "{name} {}: {cell} {ray:?}", kernel.name());
                    met += usize::from(brief.triangle != NONE);
                }
            }
            let mut occluded = vec![false; fan.len()];
            scene.occluded_many_of(Starts::Cell(cell), &fan, &mut occluded);
            for (ray, is_met) in fan.iter().zip(occluded) {
                assert_eq!(is_met, scene.occluded_from(Start::Cell(cell), ray), "{name}: {cell} {ray:?}");
            }
        }
        assert!(met > 50_000, "{name}: {met}");
    }

    #[test]
    fn fans_of_one_origin_answer_as_single_rays_do() {
        check_fans("house", Sample::House.scene());
        check_fans("build1", Sample::Build1.scene());
        check_fans("random", Sample::Random(1).scene());
        check_fans("random cad", Sample::Random(2).drawn(2));
    }

    #[test]
    fn batches_meet_what_closes_openings() {
        let mut scene = Sample::House.own();
        let openings: Vec<u32> = (0..scene.elements().len() as u32)
            .filter(|&element| scene.element(element).semantic() == Semantic::Opening)
            .collect();
        let shut = Stand { open: false, leaf: Leaf::Out };
        let stands: Vec<(u32, Stand)> = openings.into_iter().map(|opening| (opening, shut)).collect();
        let failed = scene.set_stands_where_possible(&stands).unwrap();
        assert!(failed.len() < stands.len());
        check("closed house", scene);
    }

    #[test]
    fn batches_answer_as_single_rays_do() {
        check("house", Sample::House.own());
        check("build1", Sample::Build1.own());
        check("tower", Sample::Tower(12).own());
        check("random", Sample::Random(1).own());
        check("random cad", Sample::Random(2).own_drawn(2));
        check("masked", Sample::Build1.scene().without(|element, _| element % 3 == 0));
    }

    #[test]
    fn rays_are_scattered_that_start_elsewhere_than_those_before() {
        let at = |i: usize| Ray::new([i as f64, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let (apart, runs): (Vec<Ray>, Vec<Ray>) = (0..40_000).map(|i| (at(i), at(i / 100))).unzip();
        assert!(is_scattered(Starts::Anywhere, &apart) && !is_scattered(Starts::Anywhere, &runs));
        assert!(
            is_scattered(Starts::Anywhere, &apart[..100]) && !is_scattered(Starts::Anywhere, &runs[..300])
        );
        // Of one cell, and so few that nothing is gained.
        assert!(!is_scattered(Starts::Cell(1), &apart) && !is_scattered(Starts::Anywhere, &apart[..BLOCK]));
        let cells: Vec<u32> = (0..40_000).map(|i| i / 50).collect();
        assert!(!is_scattered(Starts::Cells(&cells), &apart));
    }
}
