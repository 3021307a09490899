//! The loops of `kernels`, compiled for what the CPU has.
#![allow(unsafe_code)]

use glam::Vec3;

use super::cover::Cover;
use super::glass::{Layer, Layers};
use super::kernels::{self, Bound, Deep, Kernels, Tint};
use super::rows::Region;
use super::sight::{Boxes, Places, Sight};
use super::wide::Portable;
#[cfg(target_arch = "x86_64")]
use super::{avx2, avx512};
use crate::format::records::{BlockRecord, NodeRecord};
use crate::packets::Band;
use crate::trace::Kernel;

/// The loops, compiled for sixteen pixels of this kind, with these features of the CPU.
#[cfg(target_arch = "x86_64")]
macro_rules! entries {
    ($wide:ty, $features:literal) => {
        #[target_feature(enable = $features)]
        pub(super) fn split(
            borders: [&[i32]; 2],
            border: &mut [i32],
            first: i32,
            line: [f64; 2],
        ) -> [i32; 2] {
            super::kernels::split::<$wide>(borders, border, first, line)
        }

        #[target_feature(enable = $features)]
        pub(super) fn near(
            borders: [&[i32]; 2],
            first: i32,
            bounds: [super::kernels::Bound; 2],
            take: &mut dyn FnMut(i32, [i32; 2]),
        ) {
            super::kernels::near::<$wide>(borders, first, bounds, take);
        }

        #[target_feature(enable = $features)]
        pub(super) fn fill<T: super::kernels::Tint>(
            borders: [&[i32]; 2],
            cover: &mut super::cover::Cover<'_>,
            first: i32,
            tint: &T,
        ) {
            super::kernels::fill::<$wide, T>(borders, cover, first, tint);
        }

        #[target_feature(enable = $features)]
        pub(super) fn draw<T: super::kernels::Tint>(
            borders: [&[i32]; 2],
            cover: &mut super::cover::Cover<'_>,
            rows: [i32; 2],
            deep: &super::kernels::Deep,
            tint: &T,
        ) {
            super::kernels::draw::<$wide, T>(borders, cover, rows, deep, tint);
        }

        #[target_feature(enable = $features)]
        pub(super) fn glaze(
            borders: [&[i32]; 2],
            cover: &mut super::cover::Cover<'_>,
            rows: [i32; 2],
            deep: &super::kernels::Deep,
            layer: (super::glass::Layer, &mut super::glass::Layers),
        ) {
            super::kernels::glaze::<$wide>(borders, cover, rows, deep, layer);
        }

        #[target_feature(enable = $features)]
        pub(super) fn melt(
            layers: &mut super::glass::Layers,
            cover: &mut super::cover::Cover<'_>,
            square: &[f32; 5],
            unsure: &mut Vec<[i32; 3]>,
        ) {
            super::kernels::melt::<$wide>(layers, cover, square, unsure);
        }

        #[target_feature(enable = $features)]
        pub(super) fn hides(
            cover: &mut super::cover::Cover<'_>,
            columns: [i32; 2],
            rows: [i32; 2],
            near: f32,
        ) -> bool {
            super::kernels::hides::<$wide>(cover, columns, rows, near)
        }

        #[target_feature(enable = $features)]
        pub(super) fn boxes(
            sight: &super::sight::Sight,
            node: &crate::format::records::NodeRecord,
            region: &super::rows::Region,
            frustum: &[glam::Vec3; 4],
        ) -> super::sight::Boxes {
            sight.of_boxes(node, region, frustum)
        }

        #[target_feature(enable = $features)]
        pub(super) fn triangles(
            sight: &super::sight::Sight,
            block: &crate::format::records::BlockRecord,
            backs: [u32; 2],
            region: &super::rows::Region,
            frustum: &[glam::Vec3; 4],
        ) -> (u32, super::sight::Places) {
            sight.of_triangles(block, backs, region, frustum)
        }

        #[target_feature(enable = $features)]
        pub(super) fn packets(band: &mut crate::packets::Band<'_, '_, '_>) {
            band.run::<$wide>();
        }

        #[cfg(test)]
        #[target_feature(enable = $features)]
        pub(super) fn check() {
            super::wide::tests::check::<$wide>();
        }
    };
}

#[cfg(target_arch = "x86_64")]
pub(super) use entries;

/// Calls a loop as it is compiled for a kernel.
macro_rules! by_kernel {
    ($kernel:expr, $name:ident, <$($tint:ident)?>, ($($argument:expr),*)) => {{
        #[cfg(target_arch = "x86_64")]
        match $kernel.extensions() {
            // SAFETY: such a kernel is made only where the CPU has what this is compiled for.
            [_, true] => return unsafe { avx512::$name($($argument),*) },
            // SAFETY: as above.
            [true, _] => return unsafe { avx2::$name($($argument),*) },
            _ => {}
        }
        let _ = $kernel;
        kernels::$name::<Portable $(, $tint)?>($($argument),*)
    }};
}

/// Looks at eight boxes or triangles, by a function as it is compiled for a kernel; the last is what it does.
macro_rules! look_by_kernel {
    ($kernel:expr, $name:ident, $look:ident, ($sight:expr, $($argument:expr),*)) => {{
        #[cfg(target_arch = "x86_64")]
        match $kernel.extensions() {
            // SAFETY: such a kernel is made only where the CPU has what this is compiled for.
            [_, true] => return unsafe { avx512::$name($sight, $($argument),*) },
            // SAFETY: as above.
            [true, _] => return unsafe { avx2::$name($sight, $($argument),*) },
            _ => {}
        }
        let _ = $kernel;
        $sight.$look($($argument),*)
    }};
}

/// Has the processor fetch what is looked at later: a box and its triangles lie anywhere in memory.
#[inline(always)]
pub(super) fn fetch<T>(of: &T) {
    #[cfg(target_arch = "x86_64")]
    crate::trace::fetch(of);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = of;
}

#[inline]
pub(super) fn hides(
    kernel: Kernel,
    cover: &mut Cover<'_>,
    columns: [i32; 2],
    rows: [i32; 2],
    near: f32,
) -> bool {
    by_kernel!(kernel, hides, <>, (cover, columns, rows, near))
}

#[inline]
pub(super) fn boxes(
    kernel: Kernel,
    sight: &Sight,
    node: &NodeRecord,
    region: &Region,
    frustum: &[Vec3; 4],
) -> Boxes {
    look_by_kernel!(kernel, boxes, of_boxes, (sight, node, region, frustum))
}

#[inline]
pub(super) fn triangles(
    kernel: Kernel,
    sight: &Sight,
    block: &BlockRecord,
    backs: [u32; 2],
    region: &Region,
    frustum: &[Vec3; 4],
) -> (u32, Places) {
    look_by_kernel!(kernel, triangles, of_triangles, (sight, block, backs, region, frustum))
}

#[inline]
pub(super) fn split(
    kernel: Kernel,
    borders: [&[i32]; 2],
    border: &mut [i32],
    first: i32,
    line: [f64; 2],
) -> [i32; 2] {
    by_kernel!(kernel, split, <>, (borders, border, first, line))
}

#[inline]
pub(super) fn near(
    kernel: Kernel,
    borders: [&[i32]; 2],
    first: i32,
    bounds: [Bound; 2],
    take: &mut dyn FnMut(i32, [i32; 2]),
) {
    by_kernel!(kernel, near, <>, (borders, first, bounds, take));
}

#[inline]
pub(super) fn fill<T: Tint>(
    kernel: Kernel,
    borders: [&[i32]; 2],
    cover: &mut Cover<'_>,
    first: i32,
    tint: &T,
) {
    by_kernel!(kernel, fill, <T>, (borders, cover, first, tint));
}

#[inline]
pub(super) fn draw<T: Tint>(
    kernel: Kernel,
    borders: [&[i32]; 2],
    cover: &mut Cover<'_>,
    rows: [i32; 2],
    deep: &Deep,
    tint: &T,
) {
    by_kernel!(kernel, draw, <T>, (borders, cover, rows, deep, tint));
}

#[inline]
pub(super) fn glaze(
    kernel: Kernel,
    borders: [&[i32]; 2],
    cover: &mut Cover<'_>,
    rows: [i32; 2],
    deep: &Deep,
    layer: (Layer, &mut Layers),
) {
    by_kernel!(kernel, glaze, <>, (borders, cover, rows, deep, layer));
}

pub(super) fn melt(
    kernel: Kernel,
    layers: &mut Layers,
    cover: &mut Cover<'_>,
    square: &[f32; 5],
    unsure: &mut Vec<[i32; 3]>,
) {
    by_kernel!(kernel, melt, <>, (layers, cover, square, unsure));
}

/// Makes a band of rows by packets.
pub(crate) fn packets(kernels: Kernels, band: &mut Band<'_, '_, '_>) {
    #[cfg(target_arch = "x86_64")]
    match kernels.0.extensions() {
        // SAFETY: such a kernel is made only where the CPU has what this is compiled for.
        [_, true] => return unsafe { avx512::packets(band) },
        // SAFETY: as above.
        [true, _] => return unsafe { avx2::packets(band) },
        _ => {}
    }
    let _ = kernels;
    band.run::<Portable>();
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn pixels_side_by_side() {
        for kernel in Kernel::available() {
            match kernel.extensions() {
                // SAFETY: such a kernel is made only where the CPU has what this is compiled for.
                [_, true] => unsafe { avx512::check() },
                // SAFETY: as above.
                [true, _] => unsafe { avx2::check() },
                _ => {}
            }
        }
    }
}
