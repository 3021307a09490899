//! Many rays at once, into the caller's own buffers.

use super::kernel::Kernel;
use super::packet::Eight;
use super::quick::Quick;
use super::ray::{Brief, Hit, NONE, Ray};
use super::single::{Start, Want};
use crate::format::records::{CellRecord, LANES};
use crate::scene::Scene;

/// Rays that one task takes at a time.
const CHUNK: usize = 1024;

/// From where the rays of a batch start, if the caller knows: then nothing is looked up.
#[derive(Clone, Copy, Debug)]
pub enum Starts<'a> {
    /// Anywhere: origins are located first.
    Anywhere,
    /// In the air: all of this cell, as [`Start::Cell`].
    Cell(u32),
    /// In the air: the i-th ray of the i-th cell, as [`Start::Cell`].
    Cells(&'a [u32]),
}

impl<'a> Starts<'a> {
    fn of(self, index: usize) -> Start<'static> {
        match self {
            Starts::Anywhere => Start::Anywhere,
            Starts::Cell(cell) => Start::Cell(cell),
            Starts::Cells(cells) => Start::Cell(cells[index]),
        }
    }

    /// Those of some of the rays.
    fn part(self, first: usize, count: usize) -> Starts<'a> {
        match self {
            Starts::Cells(cells) => Starts::Cells(&cells[first..first + count]),
            other => other,
        }
    }
}

/// Calls `each` with the slices' chunks, on all threads of the current rayon pool.
fn for_each_chunk<A: Send>(
    rays: &[Ray],
    starts: Starts<'_>,
    answers: &mut [A],
    each: impl Fn(&[Ray], Starts<'_>, &mut [A]) + Sync,
) {
    assert_eq!(rays.len(), answers.len(), "as many answers as rays");
    if let Starts::Cells(cells) = starts {
        assert_eq!(rays.len(), cells.len(), "as many cells as rays");
    }
    let chunks = |(index, (rays, answers)): (usize, (&[Ray], &mut [A]))| {
        each(rays, starts.part(index * CHUNK, rays.len()), answers)
    };
    #[cfg(feature = "rayon")]
    {
        use rayon::prelude::*;
        if rays.len() > CHUNK {
            rays.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK)).enumerate().for_each(chunks);
            return;
        }
    }
    rays.chunks(CHUNK).zip(answers.chunks_mut(CHUNK)).enumerate().for_each(chunks);
}

impl Scene {
    /// What each ray meets first; `hits[i]` is the record of `rays[i]` (see [`Hit::answer`]): what [`Scene::trace_from`] answers.
    ///
    /// Rays that are neighbours in the slice are traced together: faster where they start in the same cells and go similar ways.
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

    fn trace_many_of(&self, starts: Starts<'_>, rays: &[Ray], hits: &mut [Hit], want: Want) {
        for_each_chunk(rays, starts, hits, |rays, starts, hits| {
            self.quick_many::<false>(self.kernel, starts, rays, |index, quick| {
                hits[index] = match quick {
                    Some(quick) => self.describe_quick(&rays[index], &quick, want),
                    None => self.trace_from(starts.of(index), &rays[index], want),
                };
            });
        });
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
        for_each_chunk(rays, starts, briefs, |rays, starts, briefs| {
            self.eights::<false>(kernel, starts, rays, |first, count, eight| {
                for lane in 0..count {
                    briefs[first + lane] = eight.brief(lane);
                }
                for lane in (0..count).filter(|lane| eight.known >> lane & 1 == 0) {
                    let index = first + lane;
                    briefs[index] = self.trace_brief_with(kernel, starts.of(index), &rays[index]);
                }
            });
        });
    }

    /// Whether anything stands in the way of each ray, see [`Scene::occluded`].
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded_many(&self, rays: &[Ray], occluded: &mut [bool]) {
        for_each_chunk(rays, Starts::Anywhere, occluded, |rays, starts, occluded| {
            self.quick_many::<true>(self.kernel, starts, rays, |index, quick| {
                occluded[index] = match quick {
                    Some(quick) => quick.found.triangle != NONE,
                    None => self.occluded(&rays[index]),
                };
            });
        });
    }

    /// Tells what each ray meets that is in no doubt.
    fn quick_many<const ANY: bool>(
        &self,
        kernel: Kernel,
        starts: Starts<'_>,
        rays: &[Ray],
        mut tell: impl FnMut(usize, Option<Quick>),
    ) {
        self.eights::<ANY>(kernel, starts, rays, |first, count, eight| {
            for lane in 0..count {
                tell(first + lane, eight.get(lane));
            }
        });
    }

    /// Tells what rays meet that is in no doubt, eight at a time: from the first of them on.
    fn eights<const ANY: bool>(
        &self,
        kernel: Kernel,
        starts: Starts<'_>,
        rays: &[Ray],
        mut tell: impl FnMut(usize, usize, &Eight),
    ) {
        // Rays of a camera or of a scanner start at the same point, one after the other.
        let mut last = ([f64::NAN; 3], NONE);
        let mut locate = |origin: [f64; 3]| {
            if last.0 != origin {
                last = (origin, self.free_cell(origin).unwrap_or(NONE));
            }
            last.1
        };
        let is_air = |cell: u32| {
            let cell = self.tables.cells.get(cell as usize);
            cell.is_some_and(|cell| cell.kind == CellRecord::AIR)
        };
        let mut eight = Eight::NONE;
        let mut known = NONE;
        for (group, rays) in rays.chunks(LANES).enumerate() {
            let first = group * LANES;
            let mut lanes = [&rays[0]; LANES];
            for (lane, ray) in rays.iter().enumerate() {
                lanes[lane] = ray;
                let cell = match starts {
                    Starts::Anywhere => NONE,
                    Starts::Cell(cell) => cell,
                    Starts::Cells(cells) => cells[first + lane],
                };
                if cell != known && is_air(cell) {
                    known = cell;
                }
                eight.cells[lane] = if cell == known && cell != NONE { cell } else { locate(ray.origin) };
            }
            kernel.packet::<ANY>(&self.tables, &lanes, rays.len(), &mut eight);
            tell(first, rays.len(), &eight);
        }
    }
}
