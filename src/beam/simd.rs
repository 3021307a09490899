//! The loops of `kernels`, compiled for AVX2 and for AVX-512.
#![allow(unsafe_code)]

use super::kernels::{self, Deep, Depths};
use super::shade::Shading;
use crate::trace::Kernel;

/// `kernels::split`.
#[inline]
pub(super) fn split(
    kernel: Kernel,
    borders: [&[i32]; 2],
    border: &mut [i32],
    first: i32,
    line: [f64; 2],
) -> [i32; 2] {
    #[cfg(target_arch = "x86_64")]
    match kernel.extensions() {
        // SAFETY: such a kernel is made only where the CPU has them.
        [_, true] => return unsafe { split_avx512(borders, border, first, line) },
        // SAFETY: as above.
        [true, _] => return unsafe { split_avx2(borders, border, first, line) },
        _ => {}
    }
    let _ = kernel;
    kernels::split(borders, border, first, line)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn split_avx512(borders: [&[i32]; 2], border: &mut [i32], first: i32, line: [f64; 2]) -> [i32; 2] {
    kernels::split(borders, border, first, line)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn split_avx2(borders: [&[i32]; 2], border: &mut [i32], first: i32, line: [f64; 2]) -> [i32; 2] {
    kernels::split(borders, border, first, line)
}

/// `kernels::shade`.
#[inline]
pub(super) fn shade(
    kernel: Kernel,
    borders: [&[i32]; 2],
    pixels: &mut [u32],
    place: [i32; 2],
    shading: &Shading,
) {
    #[cfg(target_arch = "x86_64")]
    match kernel.extensions() {
        // SAFETY: such a kernel is made only where the CPU has them.
        [_, true] => return unsafe { shade_avx512(borders, pixels, place, shading) },
        // SAFETY: as above.
        [true, _] => return unsafe { shade_avx2(borders, pixels, place, shading) },
        _ => {}
    }
    let _ = kernel;
    kernels::shade(borders, pixels, place, shading);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn shade_avx512(borders: [&[i32]; 2], pixels: &mut [u32], place: [i32; 2], shading: &Shading) {
    kernels::shade(borders, pixels, place, shading);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn shade_avx2(borders: [&[i32]; 2], pixels: &mut [u32], place: [i32; 2], shading: &Shading) {
    kernels::shade(borders, pixels, place, shading);
}

/// `kernels::draw`.
#[inline]
pub(super) fn draw(
    kernel: Kernel,
    borders: [&[i32]; 2],
    depths: &mut Depths<'_>,
    place: [i32; 2],
    deep: &Deep,
    shading: &Shading,
) -> u32 {
    #[cfg(target_arch = "x86_64")]
    match kernel.extensions() {
        // SAFETY: such a kernel is made only where the CPU has them.
        [_, true] => return unsafe { draw_avx512(borders, depths, place, deep, shading) },
        // SAFETY: as above.
        [true, _] => return unsafe { draw_avx2(borders, depths, place, deep, shading) },
        _ => {}
    }
    let _ = kernel;
    kernels::draw(borders, depths, place, deep, shading)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn draw_avx512(borders: [&[i32]; 2], depths: &mut Depths<'_>, place: [i32; 2], deep: &Deep, shading: &Shading) -> u32 {
    kernels::draw(borders, depths, place, deep, shading)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn draw_avx2(borders: [&[i32]; 2], depths: &mut Depths<'_>, place: [i32; 2], deep: &Deep, shading: &Shading) -> u32 {
    kernels::draw(borders, depths, place, deep, shading)
}

/// `kernels::shade_behind`.
#[inline]
pub(super) fn shade_behind(
    kernel: Kernel,
    borders: [&[i32]; 2],
    depths: &mut Depths<'_>,
    place: [i32; 2],
    shading: &Shading,
) {
    #[cfg(target_arch = "x86_64")]
    match kernel.extensions() {
        // SAFETY: such a kernel is made only where the CPU has them.
        [_, true] => return unsafe { shade_behind_avx512(borders, depths, place, shading) },
        // SAFETY: as above.
        [true, _] => return unsafe { shade_behind_avx2(borders, depths, place, shading) },
        _ => {}
    }
    let _ = kernel;
    kernels::shade_behind(borders, depths, place, shading)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f,avx512vl,avx512dq")]
fn shade_behind_avx512(borders: [&[i32]; 2], depths: &mut Depths<'_>, place: [i32; 2], shading: &Shading) {
    kernels::shade_behind(borders, depths, place, shading)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn shade_behind_avx2(borders: [&[i32]; 2], depths: &mut Depths<'_>, place: [i32; 2], shading: &Shading) {
    kernels::shade_behind(borders, depths, place, shading)
}
