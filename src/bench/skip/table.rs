//! A report as text, and as Markdown.

use super::super::table::{aligned, markdown};
use super::{SkipReport, SkipRow, Steps, Work};

/// The names of the columns of rays.
const RAYS: [&str; 8] = ["skipped", "when", "ns", "without", "times", STEPS, STEPS_WITHOUT, "differing"];

/// What is told of steps, with the skip and without.
const STEPS: &str = "cells/empty/nodes/blocks/triangles/planes";
const STEPS_WITHOUT: &str = "the same without";

const FILES: [&str; 7] = ["skipped", "when", "ms", "without", "times", "bytes checked", "without"];

fn steps(work: &Work) -> String {
    let Some(Steps { cells, empty, nodes, blocks, tests, plain }) = work.steps else { return "-".to_owned() };
    [cells, empty, nodes, blocks, tests, plain].map(|mean| format!("{mean:.2}")).join("/")
}

fn ray_cells(row: &SkipRow) -> Vec<String> {
    vec![
        row.skipped.to_owned(),
        row.when.to_owned(),
        format!("{:.1}", row.with.ns),
        format!("{:.1}", row.without.ns),
        format!("{:.2}", row.ratio()),
        steps(&row.with),
        steps(&row.without),
        row.differing.map_or("-".to_owned(), |count| count.to_string()),
    ]
}

fn file_cells(row: &SkipRow) -> Vec<String> {
    let ms = |ns: f64| format!("{:.3}", ns * 1e-6);
    let bytes = |work: &Work| work.bytes.unwrap_or(0).to_string();
    vec![
        row.skipped.to_owned(),
        row.when.to_owned(),
        ms(row.with.ns),
        ms(row.without.ns),
        format!("{:.2}", row.ratio()),
        bytes(&row.with),
        bytes(&row.without),
    ]
}

impl SkipReport {
    fn head(&self) -> String {
        let ([air, empty], [walls, plain]) = (self.cells, self.faces);
        format!(
            "{}, one thread; traits: {}; {empty} of {air} cells of air are empty, {plain} of {walls} faces to matter plain; {} random rays",
            self.machine,
            self.traits.join(", "),
            self.rays
        )
    }

    /// The lines of the two tables, the first of each its names.
    fn tables(&self) -> [Vec<Vec<String>>; 2] {
        let names = |names: &[&str]| vec![names.iter().map(|&name| name.to_owned()).collect::<Vec<String>>()];
        let (mut rays, mut files) = (names(&RAYS), names(&FILES));
        rays.extend(self.rows.iter().map(ray_cells));
        files.extend(self.files.iter().map(file_cells));
        [rays, files]
    }

    /// As aligned text.
    pub fn text(&self) -> String {
        let [rays, files] = self.tables().map(|table| aligned(&table, 2));
        format!("{}\n\n{rays}\n{files}", self.head())
    }

    /// As tables in Markdown.
    pub fn markdown(&self) -> String {
        let [rays, files] = self.tables().map(|table| markdown(&table, 2));
        format!("{}\n\n{rays}\n{files}", self.head())
    }
}
