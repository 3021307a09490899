//! A report as text, and as Markdown.

use super::super::table::{aligned, markdown};
use super::{ErrorReport, ErrorRow};

/// A column: its name, and what a row has there.
type Column = (&'static str, fn(&ErrorRow) -> String);

/// What is wrong, beside the time.
const ANSWERS: &[Column] = &[
    ("way", |r| r.kernel.clone()),
    ("ns/ray", |r| format!("{:.1}", r.ns_per_ray)),
    ("frame ms", |r| format!("{:.3}", r.frame_ms)),
    ("differing", |r| r.errors.differing.to_string()),
    ("ties", |r| r.errors.ties.to_string()),
    ("beside", |r| r.errors.beside.to_string()),
    ("wrong", |r| r.errors.wrong.to_string()),
    ("ppm", |r| format!("{:.2}", r.errors.wrong_ppm)),
    ("leaks", |r| r.errors.leaks.to_string()),
    ("doubles", |r| r.errors.double_hits.map_or("-".to_owned(), |count| count.to_string())),
];

/// How far the distances of right answers are off, and how far aside these are.
const DISTANCES: &[Column] = &[
    ("way", |r| r.kernel.clone()),
    ("max fwd m", |r| short(r.errors.forward.largest)),
    ("mean", |r| short(r.errors.forward.mean)),
    ("rms", |r| short(r.errors.forward.rms)),
    ("max ulps", |r| short(r.errors.ulps.largest)),
    ("mean", |r| short(r.errors.ulps.mean)),
    ("rms", |r| short(r.errors.ulps.rms)),
    ("max back m", |r| short(r.errors.backward.largest)),
    ("mean", |r| short(r.errors.backward.mean)),
    ("rms", |r| short(r.errors.backward.rms)),
    ("back ulps", |r| short(r.errors.backward_ulps.largest)),
    ("mean", |r| short(r.errors.backward_ulps.mean)),
    ("rms", |r| short(r.errors.backward_ulps.rms)),
];

/// How far normals and pictures are off.
const LOOKS: &[Column] = &[
    ("way", |r| r.kernel.clone()),
    ("max rad", |r| or_dash(r.errors.normals.map(|normals| normals.largest))),
    ("mean", |r| or_dash(r.errors.normals.map(|normals| normals.mean))),
    ("rms", |r| or_dash(r.errors.normals.map(|normals| normals.rms))),
    ("rmse", |r| or_dash(r.errors.image.map(|image| image.rmse))),
    ("rel. mse", |r| or_dash(r.errors.image.map(|image| image.relative_mse))),
    ("visible", |r| r.errors.image.map_or("-".to_owned(), |image| image.visible.to_string())),
];

/// How far apart pictures look, where it was asked for.
const FLIP: Column = ("flip", |r| or_dash(r.errors.image.and_then(|image| image.flip)));

fn short(number: f64) -> String {
    format!("{number:.1e}")
}

fn or_dash(number: Option<f64>) -> String {
    number.map_or("-".to_owned(), short)
}

impl ErrorReport {
    fn head(&self) -> String {
        format!(
            "{}, {} thread(s), {} pixels of {} frames, {} of them with several exact answers, tolerance {} m",
            self.machine, self.threads, self.pixels, self.frames, self.tied, self.tolerance
        )
    }

    /// As aligned text: time beside what is wrong, then how far the distances of right answers are off, then normals and pictures.
    pub fn text(&self) -> String {
        let [answers, distances, looks] = self.tables().map(|lines| aligned(&lines, 1));
        format!("{}\n{answers}\n{distances}\n{looks}", self.head())
    }

    /// As three tables of Markdown.
    pub fn markdown(&self) -> String {
        let [answers, distances, looks] = self.tables().map(|lines| markdown(&lines, 1));
        format!("{}.\n\n{answers}\n{distances}\n{looks}", self.head())
    }

    /// The lines of the tables.
    fn tables(&self) -> [Vec<Vec<String>>; 3] {
        let is_compared =
            self.rows.iter().any(|row| row.errors.image.is_some_and(|image| image.flip.is_some()));
        let looks: Vec<Column> = LOOKS.iter().copied().chain(is_compared.then_some(FLIP)).collect();
        [self.lines(ANSWERS), self.lines(DISTANCES), self.lines(&looks)]
    }

    /// The names of columns, then what each row has there.
    fn lines(&self, columns: &[Column]) -> Vec<Vec<String>> {
        let names = columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        let row = |row: &ErrorRow| columns.iter().map(|(_, of)| of(row)).collect();
        std::iter::once(names).chain(self.rows.iter().map(row)).collect()
    }
}
