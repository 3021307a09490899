//! What a stress run found.

use std::fmt::Write;

use serde::Serialize;

#[cfg(feature = "render")]
use super::pictures::PictureRow;
use super::rays::Family;

/// Counts of rays and of what was bad about them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Counts {
    /// Rays, each answered by every kernel, alone, in batches, in brief and as segments.
    pub rays: u64,
    /// The exact answer.
    pub exact: u64,
    /// The exact surface, at a distance within the tolerance.
    pub close: u64,
    /// A surface flush with the exact one.
    pub flush: u64,
    /// One of several exact answers, or beside one: the ray meets several triangles at the very place, or one on its border, or runs in one's plane.
    pub ties: u64,
    /// The exact answer to a parallel ray beside, past an edge.
    pub beside: u64,
    /// Starts in a solid, as it should say.
    pub in_solid: u64,
    /// Right by exact arithmetic, though the truth in f64 says otherwise: its own error.
    pub oracle: u64,
    /// Wrong.
    pub wrong: u64,
    /// Escaped out of a closed room.
    pub leaks: u64,
    /// Answered otherwise by another kernel, in a batch, in brief, or as segments.
    pub unlike: u64,
    /// Rays that went on from what was met, as from a mirror.
    pub onward: u64,
    /// Of those, rays that met the very surface again.
    pub doubles: u64,
    /// Of those, wrong ones.
    pub wrong_onward: u64,
    /// Rays that panicked.
    pub panics: u64,
    /// The longest mean time of a ray in a block, all its ways and its judgement: microseconds. The one figure that is not the same in every run.
    pub slowest_us: f64,
}

impl Counts {
    pub(super) fn add(&mut self, other: &Counts) {
        self.rays += other.rays;
        self.exact += other.exact;
        self.close += other.close;
        self.flush += other.flush;
        self.ties += other.ties;
        self.beside += other.beside;
        self.in_solid += other.in_solid;
        self.oracle += other.oracle;
        self.wrong += other.wrong;
        self.leaks += other.leaks;
        self.unlike += other.unlike;
        self.onward += other.onward;
        self.doubles += other.doubles;
        self.wrong_onward += other.wrong_onward;
        self.panics += other.panics;
        self.slowest_us = self.slowest_us.max(other.slowest_us);
    }

    /// How many answers are bad; ties are not.
    pub fn bad(&self) -> u64 {
        self.wrong + self.leaks + self.unlike + self.doubles + self.wrong_onward + self.panics
    }
}

/// A bad answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StressCase {
    /// The trial.
    pub trial: String,
    /// The family.
    pub family: Family,
    /// The ray's index among those of its family.
    pub index: u64,
    /// Where the ray starts (internal frame, metres); no number if it panics to make it.
    pub origin: [f64; 3],
    /// Its direction.
    pub direction: [f64; 3],
    /// Its least and greatest `t`, metres.
    pub limits: [f64; 2],
    /// What is bad.
    pub what: String,
}

/// The rays of one family in one trial.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StressRow {
    /// The trial.
    pub trial: String,
    /// The family.
    pub family: Family,
    /// Triangles of the scene.
    pub triangles: u32,
    /// Its cells.
    pub cells: u64,
    /// What was found.
    #[serde(flatten)]
    pub counts: Counts,
}

/// What a stress run found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StressReport {
    /// The program's version.
    pub version: &'static str,
    /// Where random numbers started.
    pub seed: u64,
    /// All rays together.
    pub total: Counts,
    /// Trials that could not be compiled, and why.
    pub refused: Vec<(String, String)>,
    /// Trial by trial, family by family.
    pub rows: Vec<StressRow>,
    /// The first bad answers of each row.
    pub cases: Vec<StressCase>,
    /// Pictures, trial by trial, by beams and by packets.
    #[cfg(feature = "render")]
    pub pictures: Vec<PictureRow>,
}

impl StressReport {
    /// Whether nothing was bad.
    pub fn passed(&self) -> bool {
        self.total.bad() == 0 && self.bad_pictures() == 0 && self.refused.is_empty() && self.total.rays > 0
    }

    /// Bad pixels and pictures.
    fn bad_pictures(&self) -> u64 {
        #[cfg(feature = "render")]
        return self.pictures.iter().map(PictureRow::bad).sum();
        #[cfg(not(feature = "render"))]
        0
    }

    /// As text: the sums over trials, then over families, then what is bad.
    pub fn text(&self) -> String {
        let mut out = String::new();
        let mut sums = |title: &str, key: &dyn Fn(&StressRow) -> String| {
            let mut names: Vec<String> = Vec::new();
            for row in &self.rows {
                let name = key(row);
                if !names.contains(&name) {
                    names.push(name);
                }
            }
            // Writing to a String cannot fail.
            let _ = writeln!(
                out,
                "{title:<15} {:>11} {:>11} {:>8} {:>7} {:>9} {:>9} {:>9} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6}",
                "rays",
                "exact",
                "close",
                "flush",
                "ties",
                "beside",
                "in solid",
                "f64",
                "wrong",
                "leaks",
                "unlike",
                "doubles",
                "panics"
            );
            for name in names.into_iter().chain(["all".to_owned()]) {
                let mut c = Counts::default();
                self.rows
                    .iter()
                    .filter(|row| name == "all" || key(row) == name)
                    .for_each(|row| c.add(&row.counts));
                let _ = writeln!(
                    out,
                    "{name:<15} {:>11} {:>11} {:>8} {:>7} {:>9} {:>9} {:>9} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6}",
                    c.rays,
                    c.exact,
                    c.close,
                    c.flush,
                    c.ties,
                    c.beside,
                    c.in_solid,
                    c.oracle,
                    c.wrong + c.wrong_onward,
                    c.leaks,
                    c.unlike,
                    c.doubles,
                    c.panics
                );
            }
            out.push('\n');
        };
        sums("trial", &|row| row.trial.clone());
        sums("rays", &|row| row.family.name().to_owned());
        #[cfg(feature = "render")]
        out.push_str(&super::pictures::text(&self.pictures));
        for (trial, why) in &self.refused {
            let _ = writeln!(out, "{trial} could not be compiled: {why}");
        }
        for case in &self.cases {
            let StressCase { origin, direction, limits: [tmin, tmax], .. } = case;
            let _ = writeln!(
                out,
                "{} {} {}: {}\n    from {origin:?} along {direction:?}, {tmin} to {tmax}",
                case.trial,
                case.family.name(),
                case.index,
                case.what
            );
        }
        let bad = self.total.bad();
        let _ = match (bad, self.refused.len()) {
            _ if self.total.rays == 0 => writeln!(out, "failed: no rays were sent"),
            (0, 0) if self.bad_pictures() > 0 => {
                writeln!(out, "failed: {} bad pixels of pictures", self.bad_pictures())
            }
            (0, 0) => writeln!(out, "passed: {} rays, nothing bad", self.total.rays),
            (bad, refused) => writeln!(out, "failed: {bad} bad answers, {refused} trials not compiled"),
        };
        out
    }
}
