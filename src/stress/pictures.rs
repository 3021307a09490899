//! Pictures of the trials, from where their rays start.

use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;

use super::rays::{Family, Source};
use crate::Scene;
use crate::beam::{Beams, Differences};
use crate::packets::Packets;
use crate::render::Camera;
use crate::trace::Kernel;

/// Columns and rows: odd, so that a ray goes straight ahead.
const SIZE: [u32; 2] = [49, 33];

/// Vertical field of view, degrees.
const VIEW: f64 = 75.0;

/// What is found in all pictures of a trial that are made one way, by every kernel.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct PictureRow {
    /// The trial.
    pub trial: String,
    /// How they are made: `beams` or `packets`.
    pub way: &'static str,
    /// Pictures.
    pub pictures: u64,
    /// Their pixels.
    pub pixels: u64,
    /// Pixels left to rays.
    pub to_rays: u64,
    /// Pixels that show something else than their ray meets, which one a hundredth of a pixel aside meets.
    pub ties: u64,
    /// Pixels that show a surface within the tolerance of what their ray meets.
    pub flush: u64,
    /// Pixels that show something else than what the eye touches, or what it touches.
    pub touching: u64,
    /// Pixels that show what the ray of an eye a nanometre aside meets.
    pub aside: u64,
    /// Pixels that show something else.
    pub wrong: u64,
    /// Pixels that nothing was written to.
    pub unwritten: u64,
    /// Pictures that panicked.
    pub panics: u64,
    /// The first wrong pixels: what ray is theirs, and what they show.
    pub cases: Vec<String>,
}

impl PictureRow {
    /// Pixels and pictures that are bad; ties are not.
    pub fn bad(&self) -> u64 {
        self.wrong + self.unwritten + self.panics
    }

    fn add(&mut self, camera: &Camera, found: Option<Differences>, most: usize) {
        self.pictures += 1;
        let Some(found) = found else {
            self.panics += 1;
            self.cases.push(format!("a panic from {:?} along {:?}", camera.eye(), camera.forward()));
            return;
        };
        self.pixels += found.pixels;
        self.to_rays += found.unsure;
        self.ties += found.ties;
        self.flush += found.flush;
        self.touching += found.touching;
        self.aside += found.aside;
        self.wrong += found.wrong.len() as u64;
        self.unwritten += found.unwritten;
        let pinhole = camera.pinhole(SIZE[0], SIZE[1]);
        for ([x, y], surface, met) in found.wrong {
            if self.cases.len() < most {
                let ray = pinhole.ray(x, y);
                let case = format!(
                    "{surface:?} instead of triangle {met}: from {:?} along {:?}",
                    ray.origin, ray.direction
                );
                self.cases.push(case);
            }
        }
    }
}

/// The rows as a table, and what is bad.
pub(super) fn text(rows: &[PictureRow]) -> String {
    let mut out = String::new();
    if rows.is_empty() {
        return out;
    }
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "{:<15} {:<8} {:>9} {:>11} {:>8} {:>7} {:>9} {:>9} {:>6} {:>6} {:>9} {:>6}",
        "pictures",
        "way",
        "pictures",
        "pixels",
        "to rays",
        "ties",
        "flush",
        "touching",
        "aside",
        "wrong",
        "unwritten",
        "panics"
    );
    for row in rows {
        let _ = writeln!(
            out,
            "{:<15} {:<8} {:>9} {:>11} {:>8} {:>7} {:>9} {:>9} {:>6} {:>6} {:>9} {:>6}",
            row.trial,
            row.way,
            row.pictures,
            row.pixels,
            row.to_rays,
            row.ties,
            row.flush,
            row.touching,
            row.aside,
            row.wrong,
            row.unwritten,
            row.panics
        );
    }
    for row in rows {
        for case in &row.cases {
            let _ = writeln!(out, "{} {}: {case}", row.trial, row.way);
        }
    }
    out.push('\n');
    out
}

/// Makes so many pictures for each family, the first from where its ray `first` starts, in that ray's direction.
pub(super) fn pictures(
    (trial, scene): (&str, &Scene),
    source: &Source<'_>,
    families: &[Family],
    (first, count): (u64, u64),
    most: usize,
) -> [PictureRow; 2] {
    let row = |way| PictureRow { trial: trial.to_owned(), way, ..PictureRow::default() };
    let mut rows = [row("beams"), row("packets")];
    let [width, height] = SIZE;
    let cameras: Vec<Camera> = families
        .iter()
        .flat_map(|&family| (first..first.saturating_add(count)).map(move |index| (family, index)))
        .filter_map(|(family, index)| {
            let ray = source.ray(family, index);
            // Straight up, where the ray goes: another direction is up.
            let up = if ray.direction[2].abs() > 0.9 * ray.direction[0].abs().max(ray.direction[1].abs()) {
                [1.0, 0.1, 0.0]
            } else {
                [0.0, 0.0, 1.0]
            };
            Camera::looking(ray.origin, ray.direction, up, VIEW).ok()
        })
        .collect();
    for kernel in Kernel::available() {
        let (mut beams, mut packets) =
            (Beams::new(scene).with_kernel(kernel), Packets::new(scene).with_kernel(kernel));
        for camera in &cameras {
            let found = catch_unwind(AssertUnwindSafe(|| beams.differences(camera, width, height)));
            rows[0].add(camera, found.ok(), most);
            let found = catch_unwind(AssertUnwindSafe(|| packets.differences(camera, width, height)));
            rows[1].add(camera, found.ok(), most);
        }
    }
    rows
}
