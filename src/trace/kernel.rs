//! Which instruction set a walk runs on. All give the same answers.

use super::cost::{Cost, Count};
use super::entries::portable;
use super::lanes::Portable;
use super::line::Line;
use super::packet::Answers;
use super::quick::Quick;
use super::ray::Ray;
use super::walk::{Found, Query, Surface, Walk, walk};
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512};
use crate::format::Views;

/// What is asked of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ask {
    /// What it meets first.
    First,
    /// Whether it meets anything: any hit will do.
    Any,
}

/// An instruction set that this CPU has. Made only by the functions below, which look.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Kernel(Set);

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Set {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Kernel {
    /// Runs anywhere.
    pub const PORTABLE: Kernel = Kernel(Set::Portable);

    /// AVX2, if the CPU has it.
    pub fn avx2() -> Option<Kernel> {
        #[cfg(target_arch = "x86_64")]
        if avx2::is_available() {
            return Some(Kernel(Set::Avx2));
        }
        None
    }

    /// AVX-512 (F, VL, DQ and BW), if the CPU has it.
    pub fn avx512() -> Option<Kernel> {
        #[cfg(target_arch = "x86_64")]
        if avx512::is_available() {
            return Some(Kernel(Set::Avx512));
        }
        None
    }

    /// The fastest that the CPU has, as measured: eight lanes are no faster for AVX-512's masks and wider f64 (`docs/ARCHITECTURE.md`).
    pub fn best() -> Kernel {
        Kernel::avx2().unwrap_or(Kernel::PORTABLE)
    }

    /// All that the CPU has, those first that ask least of it.
    pub fn available() -> Vec<Kernel> {
        std::iter::once(Kernel::PORTABLE).chain(Kernel::avx2()).chain(Kernel::avx512()).collect()
    }

    /// The kernel of this name, if the CPU has it.
    pub fn by_name(name: &str) -> Option<Kernel> {
        Kernel::available().into_iter().find(|k| k.name() == name)
    }

    /// Whether it may use what AVX2 has (and FMA, BMI), and what AVX-512 has.
    #[cfg(all(feature = "render", target_arch = "x86_64"))]
    pub(crate) const fn extensions(self) -> [bool; 2] {
        match self.0 {
            Set::Portable => [false, false],
            Set::Avx2 => [true, false],
            Set::Avx512 => [true, true],
        }
    }

    /// Its name: `portable`, `avx2`, `avx512`.
    pub const fn name(self) -> &'static str {
        match self.0 {
            Set::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => "avx512",
        }
    }

    /// The prism of air that holds a point, where that is in no doubt, and whether no solid may hold it, too; perhaps `hint`.
    #[inline]
    pub(super) fn free(self, tables: &Views, point: [f64; 3], hint: u32) -> Option<(u32, bool)> {
        match self.0 {
            Set::Portable => portable::free(tables, point, hint),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::free(tables, point, hint),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::free(tables, point, hint),
        }
    }

    /// The same of many points, of which the first three numbers count; [`NONE`](super::NONE) for none.
    #[inline]
    pub(super) fn free_many(self, tables: &Views, points: &[[f64; 4]], cells: &mut [u32]) {
        match self.0 {
            Set::Portable => portable::free_many(tables, points, cells),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::free_many(tables, points, cells),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::free_many(tables, points, cells),
        }
    }

    /// What a ray meets of all triangles.
    #[inline]
    pub(super) fn alone(self, ask: Ask, tables: &Views, line: &Line) -> Quick {
        match self.0 {
            Set::Portable => portable::alone(ask, tables, line),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::alone(ask, tables, line),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::alone(ask, tables, line),
        }
    }

    /// What a ray from the air of a cell meets first that is in no doubt.
    #[inline(always)]
    pub(super) fn quick(self, tables: &Views, ray: &Ray, cell: u32) -> Option<Quick> {
        match self.0 {
            Set::Portable => portable::quick(tables, ray, cell),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::quick(tables, ray, cell),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::quick(tables, ray, cell),
        }
    }

    /// The same of a ray from a surface.
    #[inline]
    pub(super) fn quick_from(self, tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<Quick> {
        match self.0 {
            Set::Portable => portable::quick_from(tables, ray, cell, surface),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::quick_from(tables, ray, cell, surface),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::quick_from(tables, ray, cell, surface),
        }
    }

    /// Whether anything is in the way of a ray from the air of a cell, where that is in no doubt.
    #[inline(always)]
    pub(super) fn barred(self, tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
        match self.0 {
            Set::Portable => portable::barred(tables, ray, cell),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::barred(tables, ray, cell),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::barred(tables, ray, cell),
        }
    }

    /// The same of a ray from a surface.
    #[inline]
    pub(super) fn barred_from(self, tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<bool> {
        match self.0 {
            Set::Portable => portable::barred_from(tables, ray, cell, surface),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::barred_from(tables, ray, cell, surface),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::barred_from(tables, ray, cell, surface),
        }
    }

    /// Fetches rays that are looked at next: they come in the order of memory, but a block at a time, too seldom for the processor to foresee that.
    #[inline]
    pub(super) fn fetch(self, rays: &[Ray]) {
        match self.0 {
            Set::Portable => {
                let _ = rays;
            }
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 | Set::Avx512 => rays.iter().for_each(avx2::fetch),
        }
    }

    /// What up to [`BLOCK`](super::packet::BLOCK) rays meet, each in the air of its cell; `scattered`, if those that follow each other start
    /// in different places.
    #[inline]
    pub(super) fn packets(
        self,
        ask: Ask,
        tables: &Views,
        rays: &[Ray],
        cells: &mut [u32],
        scattered: bool,
        answers: &mut Answers,
    ) {
        answers.clear();
        let lead = cells.first().and_then(|&cell| tables.steps.get(cell as usize));
        // Where rays start together in a cell that has slopes or many corners, nothing is told of eight at once.
        let are_alone = !scattered && lead.is_some_and(|step| !step.is_level());
        // With eight lanes AVX-512 is no faster than AVX2. Who has it has that.
        #[cfg(target_arch = "x86_64")]
        if !are_alone && self != Kernel::PORTABLE {
            let moved = if scattered { 0 } else { avx2::bundle(ask, tables, rays, cells, answers) };
            if !answers.are_all(rays.len()) {
                avx2::packets(ask, tables, rays, cells, moved, scattered, answers);
            }
            return;
        }
        let _ = are_alone;
        answers.fill(rays, cells, |ray, cell| match ask {
            Ask::First => self.quick(tables, ray, cell),
            Ask::Any => Some(Quick::of(self.barred(tables, ray, cell)?, ray, cell)),
        });
    }

    /// The nearest hit, or some hit.
    #[inline]
    pub(super) fn run(self, ask: Ask, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        match self.0 {
            Set::Portable => walk::<Portable>(ask, tables, query, None, &mut ()),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::run(ask, tables, query),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::run(ask, tables, query),
        }
    }
}

/// What runs the walks through hierarchies, and hears of the other steps of a ray.
pub(super) trait Probe: Count {
    /// The nearest hit.
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found;
    /// The nearest hit, or some hit for who wants to know only whether there is one.
    fn first(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found;
}

/// A kernel that counts nothing.
pub(super) struct Plain {
    pub(super) kernel: Kernel,
    pub(super) ask: Ask,
}

impl Count for Plain {}

impl Probe for Plain {
    #[inline]
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        self.kernel.run(Ask::First, tables, query)
    }
    #[inline]
    fn first(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        self.kernel.run(self.ask, tables, query)
    }
}

/// The portable kernel, whose steps are those of all, counted.
impl Probe for Cost {
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        walk::<Portable>(Ask::First, tables, query, None, self)
    }
    fn first(&mut self, tables: &Walk<'_>, query: &Query<'_>) -> Found {
        self.nearest(tables, query)
    }
}

#[cfg(all(test, feature = "compile"))]
mod tests {
    use enfilade_importers::Semantic;

    use super::*;
    use crate::oracle::fixtures::{Shape, model};
    use crate::{CompileOptions, Hit, Ray, Scene, Start, Starts, Want, compile};

    /// Small enough for an interpreter that checks every access to memory (docs/STRESS.md): all of a kernel's entries over a wall, the ground and a stool.
    #[test]
    fn every_entry_of_every_kernel_on_a_small_scene() {
        let model = model(&[
            (Semantic::Room, Shape::cuboid([0.0; 3], [4.0, 3.0, 2.5])),
            (Semantic::Wall, Shape::cuboid([4.0, -0.2, 0.0], [4.3, 3.2, 2.5])),
            (Semantic::Ground, Shape::cuboid([0.0, 0.0, -0.3], [4.0, 3.0, 0.0])),
            (Semantic::Furniture, Shape::prism(5, 0.4, 0.5, 0.9)),
        ]);
        let compiled = compile(&model, &CompileOptions::default()).unwrap();
        let rays: Vec<Ray> = (0..20)
            .map(|i| {
                let [a, b] = [f64::from(i) * 0.7, f64::from(i) * 1.9];
                Ray::new(
                    [1.0 + a.sin(), 1.5 + b.cos(), 1.2],
                    [a.cos().abs() + 0.1, 0.3 * a.sin(), 0.4 * b.sin() - 0.3],
                )
            })
            .collect();
        // An escape has no point, and NaN is no number.
        let bits = |hits: &[Hit]| bytemuck::cast_slice::<Hit, u8>(hits).to_vec();
        let answers = |kernel: Kernel| {
            let scene = Scene::from_bytes(&compiled.bytes).unwrap().with_kernel(kernel);
            let mut told: Vec<Hit> =
                rays.iter().map(|ray| scene.trace_from(Start::Anywhere, ray, Want::default())).collect();
            let mut batch = vec![Hit::ESCAPED; rays.len()];
            scene.trace_many(&rays, &mut batch, Want::default());
            assert!(bits(&batch) == bits(&told));
            let on: Vec<Ray> = told
                .iter()
                .filter(|hit| hit.t.is_finite())
                .map(|hit| {
                    Ray::new(hit.point, [hit.normal[0] + 0.1, hit.normal[1] - 0.2, hit.normal[2] + 0.3])
                })
                .collect();
            let from: Vec<Hit> = told.iter().copied().filter(|hit| hit.t.is_finite()).collect();
            let mut onward = vec![Hit::ESCAPED; on.len()];
            scene.trace_many_of(Starts::Hits(&from), &on, &mut onward, Want::LEAST);
            let mut occluded = vec![false; rays.len()];
            scene.occluded_many(&rays, &mut occluded);
            for (ray, from) in on.iter().zip(&from) {
                let hit = scene.trace_from(Start::Hit(from), ray, Want::LEAST);
                assert_eq!(scene.occluded_from(Start::Hit(from), ray), hit.t.is_finite());
            }
            assert!(occluded.iter().zip(&told).all(|(&occluded, hit)| occluded == hit.t.is_finite()));
            told.extend(onward);
            told
        };
        let portable = answers(Kernel::PORTABLE);
        assert!(portable.iter().filter(|hit| hit.t.is_finite()).count() > 10);
        for kernel in Kernel::available() {
            assert!(bits(&answers(kernel)) == bits(&portable), "{kernel:?}");
        }
    }
}
