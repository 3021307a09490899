//! A report as text, and as Markdown.

use std::fmt::Write;

use super::{SkipReport, SkipRow, Work};

/// The names of the columns of rays.
const RAYS: [&str; 13] = [
    "skipped",
    "when",
    "ns",
    "without",
    "times",
    "cells",
    "empty",
    "nodes",
    "blocks",
    "triangles",
    "planes",
    "without: cells, nodes, blocks, triangles, planes",
    "differing",
];

const FILES: [&str; 7] = ["skipped", "when", "ms", "without", "times", "bytes", "without"];

fn ray_cells(row: &SkipRow) -> Vec<String> {
    let mean = |number: f64| format!("{number:.2}");
    let Work { cells, nodes, blocks, tests, plain, .. } = row.without;
    let mut line = vec![
        row.skipped.to_owned(),
        row.when.to_owned(),
        format!("{:.1}", row.with.ns),
        format!("{:.1}", row.without.ns),
        mean(row.ratio()),
    ];
    let with = row.with;
    if with.cells == 0.0 {
        // Not counted.
        line.extend(["-"; 6].map(str::to_owned));
    } else {
        line.extend([with.cells, with.empty, with.nodes, with.blocks, with.tests, with.plain].map(mean));
    }
    line.push([cells, nodes, blocks, tests, plain].map(mean).join(", "));
    line.push(row.differing.to_string());
    line
}

fn file_cells(row: &SkipRow) -> Vec<String> {
    let ms = |ns: f64| format!("{:.3}", ns * 1e-6);
    vec![
        row.skipped.to_owned(),
        row.when.to_owned(),
        ms(row.with.ns),
        ms(row.without.ns),
        format!("{:.2}", row.ratio()),
        row.with.bytes.to_string(),
        row.without.bytes.to_string(),
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
        let mut out = self.head() + "\n";
        for table in self.tables() {
            out.push('\n');
            let widths: Vec<usize> = (0..table[0].len())
                .map(|column| table.iter().map(|line| line[column].len()).max().unwrap_or(0))
                .collect();
            for line in table {
                for (column, (text, width)) in line.iter().zip(&widths).enumerate() {
                    // Writing to a String cannot fail.
                    let _ = if column < 2 {
                        write!(out, "{text:<width$}  ")
                    } else {
                        write!(out, "{text:>width$}  ")
                    };
                }
                out.truncate(out.trim_end().len());
                out.push('\n');
            }
        }
        out
    }

    /// As tables in Markdown.
    pub fn markdown(&self) -> String {
        let mut out = self.head() + "\n";
        for table in self.tables() {
            out.push('\n');
            for (number, line) in table.iter().enumerate() {
                let _ = writeln!(out, "| {} |", line.join(" | "));
                if number == 0 {
                    let _ = writeln!(out, "|---|---|{}", "---:|".repeat(line.len() - 2));
                }
            }
        }
        out
    }
}
