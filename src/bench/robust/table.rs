//! A report as text, and as Markdown.

use super::super::table::{aligned, markdown};
use super::{RobustReport, RobustRow};

/// A column: its name, and what a row has there, beside the row of the building as it was drawn.
type Column = (&'static str, fn(&RobustRow, &RobustRow) -> String);

const COLUMNS: &[Column] = &[
    ("damage", |r, _| r.damage.map_or("as drawn", super::Damage::name).to_owned()),
    ("m", |r, _| if r.damage.is_some() { format!("{:e}", r.size) } else { "-".to_owned() }),
    ("joins found %", |r, _| percent(r.joins_found)),
    ("right %", |r, _| r.joins_right.map_or("-".to_owned(), percent)),
    ("leaky", |r, _| r.leaky_pairs.to_string()),
    ("volumes off %", |r, _| format!("{:.3}", r.volume_error[0] * 100.0)),
    ("void m3", |r, _| format!("{:.3}", r.void_volume)),
    ("cells", |r, _| r.cells.to_string()),
    ("compile s", |r, _| format!("{:.3}", r.compile_seconds)),
    ("times", |r, d| format!("{:.2}", r.compile_seconds / d.compile_seconds)),
    ("ns/ray", |r, _| format!("{:.0}", r.ns_per_ray)),
    ("times", |r, _| format!("{:.2}", r.ns_per_ray / r.drawn_ns_per_ray)),
    ("other %", |r, _| share(r.other_element, r.rays)),
    ("leaks %", |r, _| share(r.leaks, r.rays)),
    ("in solid %", |r, _| share(r.in_solid, r.rays)),
    ("moved m", |r, _| format!("{:.1e}", r.moved_rms)),
    ("wrong", |r, _| r.wrong.to_string()),
];

fn percent(share: f64) -> String {
    format!("{:.1}", share * 100.0)
}

fn share(some: u64, all: u64) -> String {
    format!("{:.3}", some as f64 * 100.0 / all.max(1) as f64)
}

impl RobustReport {
    fn head(&self) -> String {
        let drawn = &self.drawn;
        format!(
            "{}, {}, compiled on {} thread(s), rays on one, tolerance {} m, {} rays, {} verified",
            self.building, self.machine, self.threads, self.tolerance, drawn.rays, drawn.verified
        )
    }

    /// The lines of the table, the first of them its names.
    fn cells(&self) -> Vec<Vec<String>> {
        let names = COLUMNS.iter().map(|column| column.0.to_owned()).collect();
        let rows = [&self.drawn].into_iter().chain(&self.rows);
        let rows = rows.map(|row| COLUMNS.iter().map(|column| column.1(row, &self.drawn)).collect());
        [names].into_iter().chain(rows).collect()
    }

    /// As aligned text.
    pub fn text(&self) -> String {
        self.head() + "\n" + &aligned(&self.cells(), 1)
    }

    /// As a table in Markdown.
    pub fn markdown(&self) -> String {
        self.head() + "\n\n" + &markdown(&self.cells(), 1)
    }
}
