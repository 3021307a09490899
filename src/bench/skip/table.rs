//! A report as text, and as Markdown.

use super::super::table::{aligned, markdown};
use super::{HeldRow, SkipReport, SkipRow, Steps, Work};

/// The names of the columns of rays.
const RAYS: [&str; 8] = ["skipped", "when", "ns", "without", "times", STEPS, STEPS_WITHOUT, "differing"];

/// What is told of steps, with the skip and without.
const STEPS: &str = "cells/empty/sloped/nodes/blocks/triangles/planes";
const STEPS_WITHOUT: &str = "the same without";

/// Of what there is.
const HELD: [&str; 5] = ["in the scene", "trait", "all", "a ray takes", "left out %"];

const FILES: [&str; 7] = ["skipped", "when", "ms", "without", "times", "bytes checked", "without"];

fn steps(work: &Work) -> String {
    let Some(Steps { cells, empty, nodes, blocks, tests, plain, sloped }) = work.steps else {
        return "-".to_owned();
    };
    [cells, empty, sloped, nodes, blocks, tests, plain].map(|mean| format!("{mean:.2}")).join("/")
}

fn held_cells(row: &HeldRow) -> Vec<String> {
    // Of what is whole there are no hundredths.
    let taken = if row.taken.fract() == 0.0 { row.taken.to_string() } else { format!("{:.2}", row.taken) };
    vec![
        row.what.to_owned(),
        row.of_trait.unwrap_or("-").to_owned(),
        row.all.to_string(),
        taken,
        if row.all == 0 { "-".to_owned() } else { format!("{:.2}", row.skipped()) },
    ]
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

    /// The lines of the three tables, the first of each its names.
    fn tables(&self) -> [Vec<Vec<String>>; 3] {
        let names = |names: &[&str]| vec![names.iter().map(|&name| name.to_owned()).collect::<Vec<String>>()];
        let (mut held, mut rays, mut files) = (names(&HELD), names(&RAYS), names(&FILES));
        held.extend(self.held.iter().map(held_cells));
        rays.extend(self.rows.iter().map(ray_cells));
        files.extend(self.files.iter().map(file_cells));
        [held, rays, files]
    }

    /// As aligned text.
    pub fn text(&self) -> String {
        let [held, rays, files] = self.tables().map(|table| aligned(&table, 2));
        format!("{}\n\n{held}\n{rays}\n{files}", self.head())
    }

    /// As tables in Markdown.
    pub fn markdown(&self) -> String {
        let [held, rays, files] = self.tables().map(|table| markdown(&table, 2));
        format!("{}\n\n{held}\n{rays}\n{files}", self.head())
    }
}
