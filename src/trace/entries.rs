//! The ways into a kernel that needs instructions which not every CPU has.
//!
//! What `walk`, `alone`, `free`, `free_many`, `quick`, `barred` and those from surfaces do is compiled for those instructions within functions of their own, and only
//! there; the rest of the crate calls them through others, which a [`Kernel`](super::Kernel) leads to that is made only where the CPU has them. What
//! is seldom needed, or long, these call through [`Entries`], so that it does not stand within each of them.

use super::cost::Count;
use super::kernel::Ask;
use super::lanes::{Lanes, Portable};
use super::quick::{self, Exit, Quick};
use super::ray::Ray;
use super::step;
use super::walk::{Found, Opened, Surface};
use crate::format::Views;

/// Lanes for which what is seldom needed is compiled by itself.
pub(super) trait Entries: Lanes {
    /// Where a ray leaves a prism of air, in which it starts, or which it came into.
    fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit;

    /// The same of a simple prism whose floor or ceiling is sloped.
    fn sloped(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Option<Exit>;

    /// The same of a prism that is not simple and level, or through something of several parts, `by`.
    fn otherwise(tables: &Views, ray: &Ray, cell: u32, by: u32, starts: bool) -> Option<Exit>;

    /// Whether a ray that leaves a cell at `exit` is barred by a wall, as far as there is no doubt.
    fn is_walled(tables: &Views, ray: &Ray, cell: u32, exit: Exit) -> bool;

    /// Where the part of a floor or a ceiling leads that a point of the plan is in, by its tiles.
    fn tile(tables: &Views, first: u32, point: [f32; 2], margin: f32) -> u32;

    /// What a ray meets from a cell on, which it leaves at `exit`, that is in no doubt.
    fn onward<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        cell: u32,
        exit: Exit,
        count: &mut C,
    ) -> Option<Quick>;

    /// The same of a ray that starts on a surface.
    fn onward_from<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        surface: &Surface,
        cell: u32,
        exit: Exit,
        count: &mut C,
    ) -> Option<Quick>;

    /// What a ray meets of a hierarchy between two places along it.
    fn detail<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        surface: Option<&Surface>,
        opened: &Opened,
        range: (f64, f64),
        count: &mut C,
    ) -> Found;
}

impl Entries for Portable {
    #[inline(never)]
    fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
        quick::leave::<Portable>(tables, ray, cell, starts)
    }

    #[inline(never)]
    fn is_walled(tables: &Views, ray: &Ray, cell: u32, exit: Exit) -> bool {
        quick::is_walled::<Portable>(tables, ray, cell, exit)
    }

    #[inline(never)]
    fn sloped(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Option<Exit> {
        quick::sloped::<Portable>(tables, ray, cell, starts)
    }

    #[inline(never)]
    fn otherwise(tables: &Views, ray: &Ray, cell: u32, by: u32, starts: bool) -> Option<Exit> {
        quick::otherwise::<Portable>(tables, ray, cell, by, starts)
    }

    #[inline(never)]
    fn tile(tables: &Views, first: u32, point: [f32; 2], margin: f32) -> u32 {
        step::tile::<Portable>(tables, first, point, margin)
    }

    #[inline(never)]
    fn onward<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        cell: u32,
        exit: Exit,
        count: &mut C,
    ) -> Option<Quick> {
        quick::onward::<Portable, C>(ask, tables, ray, cell, exit, count)
    }

    #[inline(never)]
    fn onward_from<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        surface: &Surface,
        cell: u32,
        exit: Exit,
        count: &mut C,
    ) -> Option<Quick> {
        quick::onward_from::<Portable, C>(ask, tables, ray, surface, cell, exit, count)
    }

    #[inline(never)]
    fn detail<C: Count>(
        ask: Ask,
        tables: &Views,
        ray: &Ray,
        surface: Option<&Surface>,
        opened: &Opened,
        range: (f64, f64),
        count: &mut C,
    ) -> Found {
        quick::detail::<Portable, C>(ask, tables, ray, surface, opened, range, count)
    }
}

/// The same ways on any machine.
pub(super) mod portable {
    use crate::format::Views;
    use crate::trace::alone;
    use crate::trace::free;
    use crate::trace::kernel::Ask;
    use crate::trace::lanes::Portable;
    use crate::trace::line::Line;
    use crate::trace::quick::{self, Quick};
    use crate::trace::ray::Ray;
    use crate::trace::walk::Surface;

    /// What a ray meets of all triangles.
    #[inline(never)]
    pub(in crate::trace) fn alone(ask: Ask, tables: &Views, line: &Line) -> Quick {
        alone::alone::<Portable>(ask, tables, line, &mut ())
    }

    /// The prism of air that holds a point, where that is in no doubt, and whether no solid may hold it, too.
    #[inline(never)]
    pub(in crate::trace) fn free(tables: &Views, point: [f64; 3], hint: u32) -> Option<(u32, bool)> {
        free::free::<Portable>(tables, point, hint)
    }

    /// The same of many.
    #[inline(never)]
    pub(in crate::trace) fn free_many(tables: &Views, points: &[[f64; 4]], cells: &mut [u32]) {
        free::free_many::<Portable>(tables, points, cells);
    }

    /// What a ray from the air meets that is in no doubt.
    #[inline(never)]
    pub(in crate::trace) fn quick(tables: &Views, ray: &Ray, cell: u32) -> Option<Quick> {
        quick::quick::<Portable, _>(tables, ray, cell, &mut ())
    }

    /// The same of a ray from a surface.
    #[inline(never)]
    pub(in crate::trace) fn quick_from(
        tables: &Views,
        ray: &Ray,
        cell: u32,
        surface: &Surface,
    ) -> Option<Quick> {
        quick::quick_from::<Portable, _>(tables, ray, cell, surface, &mut ())
    }

    /// Whether anything is in the way of a ray from the air, where that is in no doubt.
    #[inline(never)]
    pub(in crate::trace) fn barred(tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
        quick::barred::<Portable>(tables, ray, cell)
    }

    /// The same of a ray from a surface.
    #[inline(never)]
    pub(in crate::trace) fn barred_from(
        tables: &Views,
        ray: &Ray,
        cell: u32,
        surface: &Surface,
    ) -> Option<bool> {
        quick::barred_from::<Portable>(tables, ray, cell, surface)
    }
}

/// The functions `run`, `alone`, `free`, `free_many`, `quick`, `barred` and those from surfaces of a module that has `is_available`, on these lanes, and their
/// [`Entries`].
#[cfg(target_arch = "x86_64")]
macro_rules! entries {
    ($lanes:ty, $features:literal) => {
        use $crate::format::Views;
        use $crate::trace::alone;
        use $crate::trace::cost::Count;
        use $crate::trace::entries::Entries;
        use $crate::trace::free;
        use $crate::trace::kernel::Ask;
        use $crate::trace::line::Line;
        use $crate::trace::quick::{self, Exit, Quick};
        use $crate::trace::ray::Ray;
        use $crate::trace::step;
        use $crate::trace::walk::{self, Found, Opened, Query, Surface, Walk};

        #[target_feature(enable = $features)]
        fn run_here(ask: Ask, tables: &Walk<'_>, query: &Query<'_>) -> Found {
            walk::walk::<$lanes>(ask, tables, query, None, &mut ())
        }

        #[target_feature(enable = $features)]
        fn alone_here(ask: Ask, tables: &Views, line: &Line) -> Quick {
            alone::alone::<$lanes>(ask, tables, line, &mut ())
        }

        #[target_feature(enable = $features)]
        fn free_here(tables: &Views, point: [f64; 3], hint: u32) -> Option<(u32, bool)> {
            free::free::<$lanes>(tables, point, hint)
        }

        #[target_feature(enable = $features)]
        fn free_many_here(tables: &Views, points: &[[f64; 4]], cells: &mut [u32]) {
            free::free_many::<$lanes>(tables, points, cells);
        }

        #[target_feature(enable = $features)]
        fn quick_here(tables: &Views, ray: &Ray, cell: u32) -> Option<Quick> {
            quick::quick::<$lanes, _>(tables, ray, cell, &mut ())
        }

        #[target_feature(enable = $features)]
        fn quick_from_here(tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<Quick> {
            quick::quick_from::<$lanes, _>(tables, ray, cell, surface, &mut ())
        }

        #[target_feature(enable = $features)]
        fn barred_here(tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
            quick::barred::<$lanes>(tables, ray, cell)
        }

        #[target_feature(enable = $features)]
        fn barred_from_here(tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<bool> {
            quick::barred_from::<$lanes>(tables, ray, cell, surface)
        }

        #[target_feature(enable = $features)]
        fn leave_here(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
            quick::leave::<$lanes>(tables, ray, cell, starts)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn sloped_here(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Option<Exit> {
            quick::sloped::<$lanes>(tables, ray, cell, starts)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn otherwise_here(tables: &Views, ray: &Ray, cell: u32, by: u32, starts: bool) -> Option<Exit> {
            quick::otherwise::<$lanes>(tables, ray, cell, by, starts)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn tile_here(tables: &Views, first: u32, point: [f32; 2], margin: f32) -> u32 {
            step::tile::<$lanes>(tables, first, point, margin)
        }

        #[target_feature(enable = $features)]
        fn is_walled_here(tables: &Views, ray: &Ray, cell: u32, exit: Exit) -> bool {
            quick::is_walled::<$lanes>(tables, ray, cell, exit)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn onward_here<C: Count>(
            ask: Ask,
            tables: &Views,
            ray: &Ray,
            cell: u32,
            exit: Exit,
            count: &mut C,
        ) -> Option<Quick> {
            quick::onward::<$lanes, C>(ask, tables, ray, cell, exit, count)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn onward_from_here<C: Count>(
            ask: Ask,
            tables: &Views,
            ray: &Ray,
            surface: &Surface,
            cell: u32,
            exit: Exit,
            count: &mut C,
        ) -> Option<Quick> {
            quick::onward_from::<$lanes, C>(ask, tables, ray, surface, cell, exit, count)
        }

        #[target_feature(enable = $features)]
        #[inline(never)]
        fn detail_here<C: Count>(
            ask: Ask,
            tables: &Views,
            ray: &Ray,
            surface: Option<&Surface>,
            opened: &Opened,
            range: (f64, f64),
            count: &mut C,
        ) -> Found {
            quick::detail::<$lanes, C>(ask, tables, ray, surface, opened, range, count)
        }

        impl Entries for $lanes {
            #[inline(always)]
            fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
                // SAFETY: lanes of this type are used by the functions here only, for which that holds.
                unsafe { leave_here(tables, ray, cell, starts) }
            }

            #[inline(always)]
            fn is_walled(tables: &Views, ray: &Ray, cell: u32, exit: Exit) -> bool {
                // SAFETY: as in `leave`.
                unsafe { is_walled_here(tables, ray, cell, exit) }
            }

            #[inline(always)]
            fn sloped(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Option<Exit> {
                // SAFETY: as in `leave`.
                unsafe { sloped_here(tables, ray, cell, starts) }
            }

            #[inline(always)]
            fn otherwise(tables: &Views, ray: &Ray, cell: u32, by: u32, starts: bool) -> Option<Exit> {
                // SAFETY: as in `leave`.
                unsafe { otherwise_here(tables, ray, cell, by, starts) }
            }

            #[inline(always)]
            fn tile(tables: &Views, first: u32, point: [f32; 2], margin: f32) -> u32 {
                // SAFETY: as in `leave`.
                unsafe { tile_here(tables, first, point, margin) }
            }

            #[inline(always)]
            fn onward<C: Count>(
                ask: Ask,
                tables: &Views,
                ray: &Ray,
                cell: u32,
                exit: Exit,
                count: &mut C,
            ) -> Option<Quick> {
                // SAFETY: as in `leave`.
                unsafe { onward_here(ask, tables, ray, cell, exit, count) }
            }

            #[inline(always)]
            fn onward_from<C: Count>(
                ask: Ask,
                tables: &Views,
                ray: &Ray,
                surface: &Surface,
                cell: u32,
                exit: Exit,
                count: &mut C,
            ) -> Option<Quick> {
                // SAFETY: as in `leave`.
                unsafe { onward_from_here(ask, tables, ray, surface, cell, exit, count) }
            }

            #[inline(always)]
            fn detail<C: Count>(
                ask: Ask,
                tables: &Views,
                ray: &Ray,
                surface: Option<&Surface>,
                opened: &Opened,
                range: (f64, f64),
                count: &mut C,
            ) -> Found {
                // SAFETY: as in `leave`.
                unsafe { detail_here(ask, tables, ray, surface, opened, range, count) }
            }
        }

        /// The nearest hit, or some hit.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn run(ask: Ask, tables: &Walk<'_>, query: &Query<'_>) -> Found {
            debug_assert!(is_available());
            // SAFETY: a kernel that leads here is made only after `is_available` said yes.
            unsafe { run_here(ask, tables, query) }
        }

        /// What a ray meets of all triangles.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn alone(ask: Ask, tables: &Views, line: &Line) -> Quick {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { alone_here(ask, tables, line) }
        }

        /// The prism of air that holds a point, where that is in no doubt, and whether no solid may hold it, too.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn free(tables: &Views, point: [f64; 3], hint: u32) -> Option<(u32, bool)> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { free_here(tables, point, hint) }
        }

        /// The same of many.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn free_many(tables: &Views, points: &[[f64; 4]], cells: &mut [u32]) {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { free_many_here(tables, points, cells) }
        }

        /// What a ray from the air meets that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn quick(tables: &Views, ray: &Ray, cell: u32) -> Option<Quick> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { quick_here(tables, ray, cell) }
        }

        /// What a ray from a surface meets that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn quick_from(tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<Quick> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { quick_from_here(tables, ray, cell, surface) }
        }

        /// Whether anything is in the way of a ray from the air, where that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn barred(tables: &Views, ray: &Ray, cell: u32) -> Option<bool> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { barred_here(tables, ray, cell) }
        }

        /// The same of a ray from a surface.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn barred_from(tables: &Views, ray: &Ray, cell: u32, surface: &Surface) -> Option<bool> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { barred_from_here(tables, ray, cell, surface) }
        }
    };
}

#[cfg(target_arch = "x86_64")]
pub(super) use entries;
