//! Pictures of the trials, from where their rays start.

use std::collections::HashMap;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;

use super::judge::{Judge, Worth};
use super::rays::{Family, Source};
use super::report::Counts;
use crate::beam::{Beams, Surface, UNWRITTEN};
use crate::packets::Packets;
use crate::render::{Camera, Pinhole};
use crate::trace::{Answer, Hit, Kernel, Ray, Want};

/// Columns and rows: odd, so that a ray goes straight ahead.
const SIZE: [u32; 2] = [49, 33];

/// Vertical field of view, degrees.
const VIEW: f64 = 75.0;

/// Of the pixels of a picture that do not show what their ray meets so many are judged at first, and all if one of these is wrong: each may take
/// the truth a tenth of a second.
const JUDGED: usize = 48;

/// Metres for each metre and one by which what a picture and a ray meet may be off to be the same.
const SAME: f64 = 1e-9;

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
    /// Pixels that show what their ray meets.
    pub same: u64,
    /// Of the others, those that show exactly what is there.
    pub exact: u64,
    /// Those that show one of several things that are right.
    pub ties: u64,
    /// Those that show a surface, or one flush with it, within the tolerance of where it is.
    pub close: u64,
    /// Those that show what is right for a ray beside, within the tolerance.
    pub beside: u64,
    /// Those that show that the eye is in a solid, which it is.
    pub in_solid: u64,
    /// Pixels that do not show what their ray meets and were not judged: of a picture with more than 48 of them so many are, spread evenly, and the
    /// others only if one of these is wrong.
    pub unjudged: u64,
    /// Pixels that show something else.
    pub wrong: u64,
    /// Pixels that nothing was written to.
    pub unwritten: u64,
    /// Pictures that panicked.
    pub panics: u64,
    /// The first pictures with wrong pixels: family, index and kernel, what the first such pixel shows, and which ray is its.
    pub cases: Vec<String>,
}

/// A picture: what each pixel shows, and which hit that is.
struct Taken {
    surfaces: Vec<u32>,
    hits: Vec<Hit>,
}

/// Where pictures of one camera are compared: what its rays meet, and what was judged before, since kernels hardly ever differ.
struct View<'a> {
    judge: &'a Judge<'a>,
    pinhole: Pinhole,
    rays: Vec<Hit>,
    /// By pixel, element and the bits of the distance.
    judged: HashMap<(usize, u32, u64), Result<Counts, String>>,
}

impl PictureRow {
    /// Pixels and pictures that are bad; ties are not.
    pub fn bad(&self) -> u64 {
        self.wrong + self.unwritten + self.panics
    }

    fn merge(&mut self, part: PictureRow, most: usize) {
        self.pictures += part.pictures;
        self.pixels += part.pixels;
        self.to_rays += part.to_rays;
        self.same += part.same;
        self.exact += part.exact;
        self.ties += part.ties;
        self.close += part.close;
        self.beside += part.beside;
        self.in_solid += part.in_solid;
        self.unjudged += part.unjudged;
        self.wrong += part.wrong;
        self.unwritten += part.unwritten;
        self.panics += part.panics;
        self.cases.extend(part.cases);
        self.cases.truncate(most);
    }

    fn add(&mut self, which: &str, camera: &Camera, view: &mut View<'_>, taken: Option<Taken>, most: usize) {
        self.pictures += 1;
        let Some(taken) = taken else {
            self.panics += 1;
            self.cases.push(format!("{which}: a panic from {:?} along {:?}", camera.eye(), camera.forward()));
            return;
        };
        self.pixels += taken.surfaces.len() as u64;
        let mut others = Vec::new();
        for (index, (&surface, hit)) in taken.surfaces.iter().zip(&taken.hits).enumerate() {
            if surface == UNWRITTEN {
                self.unwritten += 1;
            } else if Surface::of(surface) == Surface::Unsure {
                self.to_rays += 1;
            } else if is_same(hit, &view.rays[index]) {
                self.same += 1;
            } else {
                others.push(index);
            }
        }
        let step = others.len().div_ceil(JUDGED).max(1);
        let (sample, rest): (Vec<_>, Vec<_>) = (0..others.len()).partition(|number| number % step == 0);
        let (mut wrong, mut first) = (0, None);
        let mut judge = |part: &[usize]| {
            for &number in part {
                let index = others[number];
                match view.judged(index, &taken.hits[index]) {
                    Ok(counts) => {
                        self.exact += counts.exact + counts.oracle;
                        self.ties += counts.ties;
                        self.close += counts.close + counts.flush;
                        self.beside += counts.beside;
                        self.in_solid += counts.in_solid;
                    }
                    Err(what) => {
                        wrong += 1;
                        first.get_or_insert_with(|| (index, what.clone()));
                    }
                }
            }
            wrong
        };
        // All of them once one of the sample is wrong, so that what is wrong in a picture is counted, not sampled.
        if judge(&sample) > 0 {
            judge(&rest);
        } else {
            self.unjudged += rest.len() as u64;
        }
        self.wrong += wrong;
        // One pixel tells of all that are wrong in a picture.
        if let Some((index, what)) = first
            && self.cases.len() < most
        {
            let [x, y] = place(index);
            self.cases.push(format!("{which}: {wrong} pixels; in column {x}, row {y}, {what}"));
        }
    }
}

impl View<'_> {
    /// What a pixel that shows something else than its ray meets is worth, or what is wrong.
    fn judged(&mut self, index: usize, hit: &Hit) -> &Result<Counts, String> {
        let View { judge, pinhole, rays, judged } = self;
        judged.entry((index, hit.element, hit.t.to_bits())).or_insert_with(|| {
            let [x, y] = place(index);
            let (ray, answer) = (pinhole.ray(x, y), hit.answer());
            let worth = judge.worth(&ray, &answer);
            if let Worth::Wrong(judgement) = &worth {
                let met = rays[index].answer();
                return Err(format!(
                    "{answer:?}, {:?}; its ray meets {met:?}, the truth is {:?}\n    from {:?} along {:?}",
                    judgement.verdict, judgement.truth, ray.origin, ray.direction
                ));
            }
            let mut counts = Counts::default();
            worth.count(&mut counts);
            Ok(counts)
        })
    }
}

/// Column and row of a pixel.
fn place(index: usize) -> [u32; 2] {
    [index as u32 % SIZE[0], index as u32 / SIZE[0]]
}

/// Whether two answers are the same but for rounding.
fn is_same(hit: &Hit, other: &Hit) -> bool {
    match (hit.answer(), other.answer()) {
        (Answer::Hit(hit), Answer::Hit(other)) => {
            hit.element == other.element && (hit.t - other.t).abs() <= SAME * (1.0 + other.t.abs())
        }
        (one, other) => one == other,
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
        "{:<15} {:<8} {:>9} {:>11} {:>8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>9} {:>6}",
        "pictures",
        "way",
        "pictures",
        "pixels",
        "to rays",
        "same",
        "exact",
        "ties",
        "close",
        "beside",
        "in solid",
        "unjudged",
        "wrong",
        "unwritten",
        "panics"
    );
    for row in rows {
        let _ = writeln!(
            out,
            "{:<15} {:<8} {:>9} {:>11} {:>8} {:>10} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>9} {:>6}",
            row.trial,
            row.way,
            row.pictures,
            row.pixels,
            row.to_rays,
            row.same,
            row.exact,
            row.ties,
            row.close,
            row.beside,
            row.in_solid,
            row.unjudged,
            row.wrong,
            row.unwritten,
            row.panics
        );
    }
    for row in rows {
        for case in &row.cases {
            let _ = writeln!(out, "{} {} {case}", row.trial, row.way);
        }
    }
    out.push('\n');
    out
}

/// The camera for a ray of a family: there, in that direction, if one can stand there.
pub(super) fn camera(source: &Source<'_>, family: Family, index: u64) -> Option<Camera> {
    let ray = source.ray(family, index);
    // Straight up, where the ray goes: another direction is up.
    let up = if ray.direction[2].abs() > 0.9 * ray.direction[0].abs().max(ray.direction[1].abs()) {
        [1.0, 0.1, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    Camera::looking(ray.origin, ray.direction, up, VIEW).ok()
}

/// Makes so many pictures for each family, the first from where its ray `first` starts, in that ray's direction.
pub(super) fn pictures(
    (trial, judge): (&str, &Judge<'_>),
    source: &Source<'_>,
    families: &[Family],
    (first, count): (u64, u64),
    most: usize,
) -> [PictureRow; 2] {
    let new = || {
        ["beams", "packets"].map(|way| PictureRow { trial: trial.to_owned(), way, ..PictureRow::default() })
    };
    let parts = crate::parallel::map(families.len(), |number| {
        let (family, mut rows) = (families[number], new());
        of_family(&mut rows, judge, source, family, (first, count), most);
        rows
    });
    let mut rows = new();
    for part in parts {
        rows.iter_mut().zip(part).for_each(|(row, part)| row.merge(part, most));
    }
    rows
}

/// The same of one family.
fn of_family(
    rows: &mut [PictureRow; 2],
    judge: &Judge<'_>,
    source: &Source<'_>,
    family: Family,
    (first, count): (u64, u64),
    most: usize,
) {
    let (scene, [width, height]) = (judge.scene, SIZE);
    let count_pixels = width as usize * height as usize;
    let mut ways: Vec<(Kernel, Beams<_>, Packets<_>)> = Kernel::available()
        .into_iter()
        .map(|kernel| {
            (kernel, Beams::new(scene).with_kernel(kernel), Packets::new(scene).with_kernel(kernel))
        })
        .collect();
    let blank = || Taken { surfaces: vec![UNWRITTEN; count_pixels], hits: vec![Hit::ESCAPED; count_pixels] };
    for index in first..first.saturating_add(count) {
        let Some(camera) = camera(source, family, index) else { continue };
        let pinhole = camera.pinhole(width, height);
        let rays: Vec<Ray> = (0..count_pixels).map(place).map(|[x, y]| pinhole.ray(x, y)).collect();
        let mut view =
            View { judge, pinhole, rays: vec![Hit::ESCAPED; count_pixels], judged: HashMap::new() };
        scene.trace_many(&rays, &mut view.rays, Want::default());
        for (kernel, beams, packets) in &mut ways {
            let which = format!("{} {index} {}", family.name(), kernel.name());
            let taken = catch_unwind(AssertUnwindSafe(|| {
                let mut taken = blank();
                beams.surfaces(&camera, width, &mut taken.surfaces);
                beams.hits(&camera, width, Want::default(), &mut taken.hits);
                taken
            }));
            rows[0].add(&which, &camera, &mut view, taken.ok(), most);
            let taken = catch_unwind(AssertUnwindSafe(|| {
                let mut taken = blank();
                packets.surfaces(&camera, width, &mut taken.surfaces);
                packets.hits(&camera, width, Want::default(), &mut taken.hits);
                taken
            }));
            rows[1].add(&which, &camera, &mut view, taken.ok(), most);
        }
    }
}
