//! Which instruction set a walk runs on. All give the same answers.

use super::cost::Cost;
use super::lanes::Portable;
use super::locate::free;
use super::packet::Answers;
use super::quick::{Quick, barred, barred_from, quick, quick_from};
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

    /// AVX-512 (F, VL and DQ), if the CPU has it.
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

    /// The prism of air that holds a point, where that is in no doubt; perhaps `hint`.
    #[inline]
    pub(super) fn free(self, tables: &Views, point: [f64; 3], hint: u32) -> Option<u32> {
        match self.0 {
            Set::Portable => free::<Portable>(tables, point, hint),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::free(tables, point, hint),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::free(tables, point, hint),
        }
    }

    /// What a ray from the air of a cell meets first that is in no doubt.
    #[inline]
    pub(super) fn quick(self, tables: &Views, ray: &Ray, cell: u32) -> Option<Quick> {
        let probe = &mut Plain { kernel: self, ask: Ask::First };
        match self.0 {
            Set::Portable => quick::<Portable, _>(tables, ray, cell, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::quick(tables, ray, cell, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::quick(tables, ray, cell, probe),
        }
    }

    /// The same of a ray from a surface.
    #[inline]
    pub(super) fn quick_from(
        self,
        tables: &Views,
        ray: &Ray,
        cell: u32,
        surface: &Surface,
    ) -> Option<Quick> {
        let probe = &mut Plain { kernel: self, ask: Ask::First };
        match self.0 {
            Set::Portable => quick_from::<Portable, _>(tables, ray, cell, surface, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::quick_from(tables, ray, cell, surface, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::quick_from(tables, ray, cell, surface, probe),
        }
    }

    /// Whether anything is in the way of a ray from the air of a cell, where that is in no doubt.
    #[inline]
    pub(super) fn barred(self, tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
        let probe = &mut Plain { kernel: self, ask: Ask::Any };
        match self.0 {
            Set::Portable => barred::<Portable, _>(tables, ray, cell, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::barred(tables, ray, cell, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::barred(tables, ray, cell, probe),
        }
    }

    /// The same of a ray from a surface.
    #[inline]
    pub(super) fn barred_from(
        self,
        tables: &Views,
        ray: &Ray,
        cell: u32,
        surface: &Surface,
    ) -> Option<bool> {
        let probe = &mut Plain { kernel: self, ask: Ask::Any };
        match self.0 {
            Set::Portable => barred_from::<Portable, _>(tables, ray, cell, surface, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::barred_from(tables, ray, cell, surface, probe),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::barred_from(tables, ray, cell, surface, probe),
        }
    }

    /// What up to [`BLOCK`](super::packet::BLOCK) rays meet, each in the air of its cell; `scattered`, if those that follow each other start
    /// in different places.
    #[inline]
    pub(super) fn packets(
        self,
        ask: Ask,
        tables: &Views,
        rays: &[&Ray],
        cells: &[u32],
        scattered: bool,
        answers: &mut Answers,
    ) {
        let probe = &mut Plain { kernel: self, ask };
        match self.0 {
            Set::Portable => {
                let _ = scattered;
                answers.fill(rays, cells, |ray, cell| quick::<Portable, _>(tables, ray, cell, probe));
            }
            // With eight lanes AVX-512 is no faster. Who has it has AVX2.
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 | Set::Avx512 => avx2::packets(tables, rays, cells, scattered, answers, probe),
        }
    }

    /// The nearest hit, or some hit.
    #[inline]
    pub(super) fn run(self, ask: Ask, tables: &Walk<'_>, query: &Query) -> Found {
        match self.0 {
            Set::Portable => walk::<Portable>(ask, tables, query, &mut ()),
            #[cfg(target_arch = "x86_64")]
            Set::Avx2 => avx2::run(ask, tables, query),
            #[cfg(target_arch = "x86_64")]
            Set::Avx512 => avx512::run(ask, tables, query),
        }
    }
}

/// What runs the walks through hierarchies, and hears of the other steps of a ray.
pub(super) trait Probe {
    /// What is asked.
    fn ask(&self) -> Ask;
    /// The nearest hit.
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query) -> Found;
    /// The nearest hit, or some hit for who wants to know only whether there is one.
    fn first(&mut self, tables: &Walk<'_>, query: &Query) -> Found;
    /// A node was opened, but not in a walk.
    fn node(&mut self) {}
    /// A prism was entered.
    fn cell(&mut self) {}
    /// A triangle was tested in f64.
    fn test(&mut self) {}
    /// A walk from cell to cell could not tell, and all triangles are asked.
    fn unsure(&mut self) {}
}

/// A kernel that counts nothing.
pub(super) struct Plain {
    pub(super) kernel: Kernel,
    pub(super) ask: Ask,
}

impl Probe for Plain {
    #[inline]
    fn ask(&self) -> Ask {
        self.ask
    }

    #[inline]
    fn nearest(&mut self, tables: &Walk<'_>, query: &Query) -> Found {
        self.kernel.run(Ask::First, tables, query)
    }
    #[inline]
    fn first(&mut self, tables: &Walk<'_>, query: &Query) -> Found {
        self.kernel.run(self.ask, tables, query)
    }
}

/// The portable kernel, whose steps are those of all, counted.
impl Probe for Cost {
    fn ask(&self) -> Ask {
        Ask::First
    }

    fn nearest(&mut self, tables: &Walk<'_>, query: &Query) -> Found {
        walk::<Portable>(Ask::First, tables, query, self)
    }
    fn first(&mut self, tables: &Walk<'_>, query: &Query) -> Found {
        self.nearest(tables, query)
    }
    fn node(&mut self) {
        self.nodes = self.nodes.saturating_add(1);
    }
    fn cell(&mut self) {
        self.cells = self.cells.saturating_add(1);
    }
    fn test(&mut self) {
        self.tests = self.tests.saturating_add(1);
    }
    fn unsure(&mut self) {
        self.unsure = self.unsure.saturating_add(1);
    }
}
