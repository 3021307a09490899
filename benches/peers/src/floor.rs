//! What no renderer goes below: shading one plane over the whole picture, without any visibility; and a plain fill of memory.

use std::time::Instant;

/// Seconds for each.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// One plane, lit from the eye, over all pixels.
    pub shading: f64,
    /// As many pixels set to one value.
    pub fill: f64,
}

/// A picture of eight-bit RGBA, `size` pixels wide and high, drawn again and again into one warm buffer: the medians of `repeat`
/// runs, one way after the other.
pub fn measure(size: usize, repeat: usize) -> Floor {
    let mut picture = vec![0u32; size * size];
    let mut times = [Vec::new(), Vec::new()];
    for run in 0..repeat.max(1) {
        let start = Instant::now();
        shade(&mut picture, size);
        times[0].push(start.elapsed().as_secs_f64());
        std::hint::black_box(&mut picture);
        let start = Instant::now();
        picture.fill(run as u32);
        times[1].push(start.elapsed().as_secs_f64());
        std::hint::black_box(&mut picture);
    }
    let [shading, fill] = times.map(|mut times| super::median(&mut times));
    Floor { shading, fill }
}

/// Shades the plane over a picture `size` pixels wide.
pub fn shade(picture: &mut [u32], size: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            // SAFETY: the CPU has it.
            #[allow(unsafe_code)]
            return unsafe { shade_avx512(picture, size) };
        }
        if std::arch::is_x86_feature_detected!("avx2") {
            // SAFETY: the CPU has it.
            #[allow(unsafe_code)]
            return unsafe { shade_avx2(picture, size) };
        }
    }
    shade_rows(picture, size);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx512bw,fma")]
fn shade_avx512(picture: &mut [u32], size: usize) {
    shade_rows(picture, size);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn shade_avx2(picture: &mut [u32], size: usize) {
    shade_rows(picture, size);
}

/// The cosine between a plane's normal and the direction of each pixel, as grey.
#[inline(always)]
fn shade_rows(picture: &mut [u32], size: usize) {
    let normal = [0.3f32, -0.2, 0.93];
    let step = 1.4 / size as f32;
    for (y, row) in picture.chunks_exact_mut(size).enumerate() {
        let v = y as f32 * step - 0.7;
        // Of the pixel's direction (u, v, 1) and of the normal.
        let (across, square) = (normal[1] * v + normal[2], v * v + 1.0);
        for (x, pixel) in row.iter_mut().enumerate() {
            let u = x as i32 as f32 * step - 0.7;
            let cosine = (normal[0] * u + across) / (u * u + square).sqrt();
            // Rounded by adding 2^23: conversions are not done side by side.
            let grey = (cosine.max(0.0) * 255.0 + 8_388_608.0).to_bits() & 0xff;
            *pixel = (grey * 0x01_01_01) | 0xff00_0000;
        }
    }
}
