//! The ways into a kernel that needs instructions which not every CPU has.
//!
//! What `walk`, `free`, `quick` and `packet` do is compiled for those instructions within four functions, and only there; the rest of the
//! crate calls them through four others, which a [`Kernel`](super::Kernel) leads to that is made only where the CPU has them.

/// The functions `run`, `free`, `quick` and `packet` of a module that has `is_available`, on these lanes.
macro_rules! entries {
    ($lanes:ty, $features:literal) => {
        use $crate::format::Views;
        use $crate::format::records::LANES as COUNT;
        use $crate::trace::kernel::{Ask, Probe};
        use $crate::trace::locate;
        use $crate::trace::packet::{self, Eight};
        use $crate::trace::quick::{self, Departure, Quick};
        use $crate::trace::ray::Ray;
        use $crate::trace::walk::{self, Found, Query, Walk};

        #[target_feature(enable = $features)]
        fn run_here(ask: Ask, tables: &Walk<'_>, query: &Query) -> Found {
            walk::walk::<$lanes>(ask, tables, query, &mut ())
        }

        #[target_feature(enable = $features)]
        fn free_here(tables: &Views, point: [f64; 3], hint: u32) -> Option<u32> {
            locate::free::<$lanes>(tables, point, hint)
        }

        #[target_feature(enable = $features)]
        fn quick_here<P: Probe>(
            tables: &Views,
            ray: &Ray,
            start: &Departure<'_>,
            probe: &mut P,
        ) -> Option<Quick> {
            quick::quick::<$lanes, P>(tables, ray, start, probe)
        }

        #[target_feature(enable = $features)]
        fn packet_here<P: Probe>(
            tables: &Views,
            rays: &[&Ray; COUNT],
            count: usize,
            eight: &mut Eight,
            probe: &mut P,
        ) {
            packet::packet::<$lanes, P>(tables, rays, count, eight, probe)
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

        /// What a ray meets that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn quick<P: Probe>(
            tables: &Views,
            ray: &Ray,
            start: &Departure<'_>,
            probe: &mut P,
        ) -> Option<Quick> {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { quick_here(tables, ray, start, probe) }
        }

        /// What rays meet that is in no doubt.
        ///
        /// # Panics
        /// If the CPU lacks the instructions (debug builds).
        #[inline]
        pub(super) fn packet<P: Probe>(
            tables: &Views,
            rays: &[&Ray; COUNT],
            count: usize,
            eight: &mut Eight,
            probe: &mut P,
        ) {
            debug_assert!(is_available());
            // SAFETY: as in `run`.
            unsafe { packet_here(tables, rays, count, eight, probe) }
        }
    };
}

pub(super) use entries;
