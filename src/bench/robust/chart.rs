//! What growing damage does, drawn: a panel for each figure, a line for each kind of damage.

use crate::plan::{Anchor, Color, Drawing, Shape};

use super::super::plot::{BLACK, GREY, Scale, dot, lines, text};
use super::{Damage, RobustReport, RobustRow};

/// A panel's frame, and how far panels are from each other, in the units of drawings.
const PANEL: [f64; 2] = [8.0, 4.6];
const STEP: [f64; 2] = [10.4, 7.2];
/// Panels in a row.
const ACROSS: usize = 3;
/// The lower left corner of the last row's first panel.
const CORNER: [f64; 2] = [1.6, 2.6];
/// Below that, the names of the lines.
const LEGEND: f64 = 0.5;

/// A panel: its title, whether it has a scale of powers of ten, and what is drawn of a row beside that of the building as it was drawn.
type Panel = (&'static str, bool, fn(&RobustRow, &RobustRow) -> f64);

/// Less is rounding, and drawn as this, metres.
const LEAST: f64 = 1e-8;

/// Shares are drawn in percent.
const PANELS: [Panel; 6] = [
    ("what openings join: found and right, %", false, |r, _| {
        r.joins_found.min(r.joins_right.unwrap_or(0.0)) * 100.0
    }),
    ("cells, times those as drawn", true, |r, d| r.cells as f64 / d.cells.max(1) as f64),
    ("time to compile, times that as drawn", true, |r, d| r.compile_seconds / d.compile_seconds),
    ("time of a ray, times that as drawn", true, |r, _| r.ns_per_ray / r.drawn_ns_per_ray),
    ("rays of another element, or none, %", false, |r, _| {
        (r.other_element + r.leaks + r.in_solid) as f64 * 100.0 / r.rays.max(1) as f64
    }),
    ("how far other rays are off, rms, m", true, |r, _| r.moved_rms.max(LEAST)),
];

const fn color(damage: Damage) -> Color {
    match damage {
        Damage::RoomGaps => [25, 95, 170],
        Damage::RoomOverlaps => [90, 165, 225],
        Damage::SolidGaps => [20, 125, 60],
        Damage::SolidOverlaps => [130, 185, 60],
        Damage::Jitter => [215, 120, 20],
        Damage::Noise => [200, 40, 40],
    }
}

impl RobustReport {
    /// A panel for each figure against how far things are off, for [`plan_svg`](crate::plan::plan_svg) and
    /// [`plan_png`](crate::plan::plan_png).
    pub fn chart(&self) -> Drawing {
        let rows = PANELS.len().div_ceil(ACROSS);
        let size = [STEP[0] * ACROSS as f64 + 0.4, STEP[1] * rows as f64 + 2.4];
        let rows_and_drawn = || self.rows.iter().chain([&self.drawn]);
        let wrong: u64 = rows_and_drawn().map(|row| row.wrong).sum();
        let verified: u64 = rows_and_drawn().map(|row| row.verified).sum();
        let title = format!(
            "{}: growing damage; {wrong} of {verified} answers wrong by the damaged model's own triangles",
            self.building
        );
        let mut shapes = vec![text([CORNER[0], size[1] - 0.8], 0.5, Anchor::Start, title)];
        for (number, panel) in PANELS.iter().enumerate() {
            let (row, column) = (rows - 1 - number / ACROSS, number % ACROSS);
            let corner = [CORNER[0] + STEP[0] * column as f64, CORNER[1] + STEP[1] * row as f64];
            self.panel(panel, corner, &mut shapes);
        }
        let mut damages: Vec<Damage> = self.rows.iter().filter_map(|row| row.damage).collect();
        damages.dedup();
        for (number, damage) in damages.into_iter().enumerate() {
            let x = CORNER[0] + 4.6 * number as f64;
            shapes.push(lines(vec![vec![[x, LEGEND], [x + 0.8, LEGEND]]], color(damage), 0.08));
            shapes.push(text([x + 1.0, LEGEND - 0.12], 0.42, Anchor::Start, damage.name().to_owned()));
        }
        Drawing { bounds: [[0.0; 2], size], shapes }
    }

    fn panel(&self, (title, is_log, figure): &Panel, [left, bottom]: [f64; 2], shapes: &mut Vec<Shape>) {
        let [right, top] = [left + PANEL[0], bottom + PANEL[1]];
        let across = Scale::powers(self.rows.iter().map(|row| row.size), [left, right]);
        let numbers = || self.rows.iter().map(|row| figure(row, &self.drawn));
        let up = if *is_log {
            Scale::powers(numbers(), [bottom, top])
        } else {
            let most = numbers().fold(0.0, f64::max);
            let round = [1.0, 2.0, 4.0, 10.0, 20.0, 40.0, 100.0].into_iter().find(|&round| most <= round);
            Scale::even([0.0, round.unwrap_or(most)], [bottom, top])
        };
        for (x, name) in across.marks() {
            shapes.push(lines(vec![vec![[x, bottom], [x, top]]], GREY, 0.02));
            shapes.push(text([x, bottom - 0.55], 0.4, Anchor::Middle, name));
        }
        for (y, name) in up.marks() {
            shapes.push(lines(vec![vec![[left, y], [right, y]]], GREY, 0.02));
            shapes.push(text([left - 0.75, y - 0.12], 0.4, Anchor::Middle, name));
        }
        shapes.push(lines(vec![vec![[left, top], [left, bottom], [right, bottom]]], BLACK, 0.03));
        shapes.push(text([left, top + 0.35], 0.45, Anchor::Start, (*title).to_owned()));
        shapes.push(text([(left + right) / 2.0, bottom - 1.1], 0.4, Anchor::Middle, "off by, m".to_owned()));
        for rows in self.rows.chunk_by(|a, b| a.damage == b.damage) {
            let Some(damage) = rows[0].damage else { continue };
            let places: Vec<[f64; 2]> =
                rows.iter().map(|row| [across.place(row.size), up.place(figure(row, &self.drawn))]).collect();
            for (place, row) in places.iter().zip(rows) {
                let told = format!("{}, {} m: {:.3}", damage.name(), row.size, figure(row, &self.drawn));
                shapes.push(dot(*place, 0.09, color(damage), told));
            }
            shapes.push(lines(vec![places], color(damage), 0.05));
        }
    }
}
