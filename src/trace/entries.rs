//! The ways into a kernel that needs instructions which not every CPU has.
//!
//! What `walk`, `free`, `quick`, `barred` and those from surfaces do is compiled for those instructions within functions of their own, and only there; the
//! rest of the crate calls them through others, which a [`Kernel`](super::Kernel) leads to that is made only where the CPU has them. What of `quick` is
//! seldom needed they call through [`Entries`], so that it does not stand within each of them.

use super::kernel::Probe;
use super::lanes::{Lanes, Portable};
use super::quick::{Exit, Quick, leave, onward};
use super::ray::Ray;
use crate::format::Views;

/// Lanes for which what is seldom needed is compiled by itself.
pub(super) trait Entries: Lanes {
    /// Where a ray leaves a prism of air, in which it starts, or which it came into.
    fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit;

    /// What a ray meets from a cell on, which it leaves at `exit`, that is in no doubt.
    fn onward<P: Probe>(tables: &Views, ray: &Ray, cell: u32, exit: Exit, probe: &mut P) -> Option<Quick>;
}

impl Entries for Portable {
    #[inline(never)]
    fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
        leave::<Portable>(tables, ray, cell, starts)
    }

    #[inline(never)]
    fn onward<P: Probe>(tables: &Views, ray: &Ray, cell: u32, exit: Exit, probe: &mut P) -> Option<Quick> {
        onward::<Portable, P>(tables, ray, cell, exit, probe)
    }
}

/// The functions `run`, `free`, `quick`, `barred` and those from surfaces of a module that has `is_available`, on these lanes, and their [`Entries`].
#[cfg(target_arch = "x86_64")]
macro_rules! entries {
    ($lanes:ty, $features:literal) => {
        use $crate::format::Views;
        use $crate::trace::entries::Entries;
        use $crate::trace::kernel::{Ask, Probe};
        use $crate::trace::locate;
        use $crate::trace::quick::{self, Exit, Quick};
        use $crate::trace::ray::Ray;
        use $crate::trace::walk::{self, Found, Query, Surface, Walk};

        #[target_feature(enable = $features)]
        fn run_here(ask: Ask, tables: &Walk<'_>, query: &Query) -> Found {
            walk::walk::<$lanes>(ask, tables, query, &mut ())
        }

        #[target_feature(enable = $features)]
        fn free_here(tables: &Views, point: [f64; 3], hint: u32) -> Option<u32> {
            locate::free::<$lanes>(tables, point, hint)
        }

        #[target_feature(enable = $features)]
        fn quick_here<P: Probe>(tables: &Views, ray: &Ray, cell: u32, probe: &mut P) -> Option<Quick> {
            quick::quick::<$lanes, P>(tables, ray, cell, probe)
        }

        #[target_feature(enable = $features)]
        fn barred_here<P: Probe>(tables: &Views, ray: &Ray, cell: u32, probe: &mut P) -> Option<bool> {
            quick::barred::<$lanes, P>(tables, ray, cell, probe)
        }

        #[target_feature(enable = $features)]
        fn barred_from_here<P: Probe>(
            tables: &Views,
            ray: &Ray,
            cell: u32,
            surface: &Surface,
            probe: &mut P,
        ) -> Option<bool> {
            quick::barred_from::<$lanes, P>(tables, ray, cell, surface, probe)
        }

        #[target_feature(enable = $features)]
        fn leave_here(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
            quick::leave::<$lanes>(tables, ray, cell, starts)
        }

        #[target_feature(enable = $features)]
        fn onward_here<P: Probe>(
            tables: &Views,
            ray: &Ray,
            cell: u32,
            exit: Exit,
            probe: &mut P,
        ) -> Option<Quick> {
            quick::onward::<$lanes, P>(tables, ray, cell, exit, probe)
        }

        impl Entries for $lanes {
            #[inline(always)]
            fn leave(tables: &Views, ray: &Ray, cell: u32, starts: bool) -> Exit {
                // SAFETY: lanes of this type are used by the functions here only, for which that holds.
                unsafe { leave_here(tables, ray, cell, starts) }
            }

            #[inline(always)]
            fn onward<P: Probe>(
                tables: &Views,
                ray: &Ray,
                cell: u32,
                exit: Exit,
                probe: &mut P,
            ) -> Option<Quick> {
                // SAFETY: as in `leave`.
                unsafe { onward_here(tables, ray, cell, exit, probe) }
            }
        }

        #[target_feature(enable = $features)]
        fn quick_from_here<P: Probe>(
            tables: &Views,
            ray: &Ray,
            cell: u32,
            surface: &Surface,
            probe: &mut P,
        ) -> Option<Quick> {
            quick::quick_from::<$lanes, P>(tables, ray, cell, surface, probe)
        }

        /// The nearest hit, or some hit.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn run(ask: Ask, tables: &Walk<'_>, query: &Query) -> Found {
            debug_assert!(is_available());
            // SAFETY: a kernel that leads here is made only after `is_available` said yes.
            unsafe { run_here(ask, tables, query) }
        }

        /// The prism of air that holds a point, where that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn free(tables: &Views, point: [f64; 3], hint: u32) -> Option<u32> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { free_here(tables, point, hint) }
        }

        /// What a ray from the air meets that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn quick<P: Probe>(tables: &Views, ray: &Ray, cell: u32, probe: &mut P) -> Option<Quick> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { quick_here(tables, ray, cell, probe) }
        }

        /// What a ray from a surface meets that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn quick_from<P: Probe>(
            tables: &Views,
            ray: &Ray,
            cell: u32,
            surface: &Surface,
            probe: &mut P,
        ) -> Option<Quick> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { quick_from_here(tables, ray, cell, surface, probe) }
        }

        /// Whether anything is in the way of a ray from the air, where that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn barred<P: Probe>(tables: &Views, ray: &Ray, cell: u32, probe: &mut P) -> Option<bool> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { barred_here(tables, ray, cell, probe) }
        }

        /// The same of a ray from a surface.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn barred_from<P: Probe>(
            tables: &Views,
            ray: &Ray,
            cell: u32,
            surface: &Surface,
            probe: &mut P,
        ) -> Option<bool> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { barred_from_here(tables, ray, cell, surface, probe) }
        }
    };
}

#[cfg(target_arch = "x86_64")]
pub(super) use entries;
