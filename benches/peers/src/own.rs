//! enfilade's own ways.

use std::sync::Arc;

use enfilade::{Answer, Brief, Kernel, Ray, Scene, Start, Starts};

use crate::way::{Met, Rays, Way};

/// Single rays on one of enfilade's kernels. The cell of a ray's origin is known, as it is for the rays of a frame, or the hit that it goes on from.
pub struct Single {
    pub scene: Arc<Scene>,
    pub kernel: Kernel,
}

impl Way for Single {
    fn name(&self) -> String {
        format!("enfilade, {}", self.kernel.name())
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        for (index, (ray, met)) in rays.exact.iter().zip(met).enumerate() {
            let brief = self.scene.trace_brief_with(self.kernel, rays.start(index), ray);
            *met = Met { t: brief.t, triangle: brief.triangle, padding: 0 };
        }
    }

    fn occluded(&self, rays: &Rays, answers: &mut [bool]) -> bool {
        // The scene has one kernel for these.
        if self.kernel != Kernel::best() {
            return false;
        }
        for (index, (ray, answer)) in rays.exact.iter().zip(answers).enumerate() {
            *answer = self.scene.occluded_from(rays.start(index), ray);
        }
        true
    }
}

/// Batches on the fastest kernel, on one thread; the cells of the origins of nearest hits are known, those of occlusion are not, hits that rays go on from
/// are.
pub struct Batch {
    pub scene: Arc<Scene>,
    pub pool: rayon::ThreadPool,
}

impl Way for Batch {
    fn name(&self) -> String {
        "enfilade, batch".to_owned()
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        // The same layout, and a cell in the place of the padding.
        let briefs: &mut [Brief] = bytemuck::cast_slice_mut(met);
        self.pool.install(|| self.scene.trace_brief_many(rays.starts(), &rays.exact, briefs));
    }

    fn occluded(&self, rays: &Rays, answers: &mut [bool]) -> bool {
        let starts = if rays.hits.is_empty() { Starts::Anywhere } else { rays.starts() };
        self.pool.install(|| self.scene.occluded_many_of(starts, &rays.exact, answers));
        true
    }
}

/// The whole answer: the origin is located, room and all.
pub struct Whole {
    pub scene: Arc<Scene>,
}

impl Way for Whole {
    fn name(&self) -> String {
        "enfilade, located".to_owned()
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        let trace = |ray: &Ray| match self.scene.trace(ray) {
            Answer::Hit(hit) => Met { t: hit.t, triangle: hit.triangle, padding: 0 },
            _ => Met::NOTHING,
        };
        for (ray, met) in rays.exact.iter().zip(met) {
            *met = trace(ray);
        }
    }
}

/// Single rays and batches in the scene left one cell: what all costs that has no cells.
pub struct Uncut {
    pub scene: Arc<Scene>,
    /// None for single rays.
    pub pool: Option<rayon::ThreadPool>,
}

impl Way for Uncut {
    fn goes_on(&self) -> bool {
        // The hits are those of another scene.
        false
    }

    fn name(&self) -> String {
        let how = if self.pool.is_some() { ", batch" } else { "" };
        format!("enfilade, no cells{how}")
    }

    fn nearest(&self, rays: &Rays, met: &mut [Met]) {
        let briefs: &mut [Brief] = bytemuck::cast_slice_mut(met);
        if let Some(pool) = &self.pool {
            pool.install(|| self.scene.trace_brief_many(Starts::Cell(0), &rays.exact, briefs));
            return;
        }
        for (ray, brief) in rays.exact.iter().zip(briefs) {
            *brief = self.scene.trace_brief(Start::Cell(0), ray);
        }
    }

    fn occluded(&self, rays: &Rays, answers: &mut [bool]) -> bool {
        if let Some(pool) = &self.pool {
            pool.install(|| self.scene.occluded_many(&rays.exact, answers));
            return true;
        }
        for (ray, answer) in rays.exact.iter().zip(answers) {
            *answer = self.scene.occluded_from(Start::Cell(0), ray);
        }
        true
    }
}
