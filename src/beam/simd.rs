//! The loops of `kernels`, compiled for AVX2 and for AVX-512.
#![allow(unsafe_code)]

use super::kernels::{self, Cover, Deep, Tint};
use crate::trace::Kernel;

/// Compiles a function of `kernels` for both, and calls that of a kernel.
macro_rules! compiled {
    ($name:ident, $avx2:ident, $avx512:ident, <$($tint:ident)?>, ($($arg:ident: $type:ty),*) -> $result:ty) => {
        #[inline]
        pub(super) fn $name$(<$tint: Tint>)?(kernel: Kernel, $($arg: $type),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            match kernel.extensions() {
                // SAFETY: such a kernel is made only where the CPU has them.
                [_, true] => return unsafe { $avx512($($arg),*) },
                // SAFETY: as above.
                [true, _] => return unsafe { $avx2($($arg),*) },
                _ => {}
            }
            let _ = kernel;
            kernels::$name($($arg),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt,avx512f,avx512vl,avx512dq")]
        fn $avx512$(<$tint: Tint>)?($($arg: $type),*) -> $result {
            kernels::$name($($arg),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
        fn $avx2$(<$tint: Tint>)?($($arg: $type),*) -> $result {
            kernels::$name($($arg),*)
        }
    };
}

compiled!(split, split_avx2, split_avx512, <>,
    (borders: [&[i32]; 2], border: &mut [i32], first: i32, line: [f64; 2]) -> [i32; 2]);
compiled!(fill, fill_avx2, fill_avx512, <T>,
    (borders: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, tint: &T) -> ());
compiled!(draw, draw_avx2, draw_avx512, <T>,
    (borders: [&[i32]; 2], cover: &mut Cover<'_>, first: i32, deep: &Deep, tint: &T) -> u32);
