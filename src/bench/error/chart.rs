//! Time against error, drawn: each way a dot, and the front of those that no other is both faster and more accurate than.

use crate::plan::{Anchor, Color, Drawing};

use super::super::plot::{GREY, Scale, dot, lines, text};
use super::{ErrorReport, ErrorRow};

/// The sheet: width and height, and the frame within it. In the units of drawings, of which a sheet in print has a hundred to the metre.
const SHEET: [f64; 2] = [20.0, 11.0];
const FRAME: [[f64; 2]; 2] = [[2.2, 1.4], [13.2, 10.0]];

/// No error is drawn as less than this, metres.
const LEAST_ERROR: f64 = 1e-17;

const FRONT: Color = [120, 120, 120];
const RIGHT: Color = [25, 95, 170];
const WRONG: Color = [200, 40, 40];

/// The error that is drawn: the root of the mean square of the backward error.
fn error_of(row: &ErrorRow) -> f64 {
    row.errors.backward.rms.max(LEAST_ERROR)
}

/// The numbers of the rows, fastest first, than which no other is both at least as fast and more accurate, nor as accurate and faster; none that
/// is wrong anywhere.
pub(super) fn front(rows: &[ErrorRow]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..rows.len()).filter(|&row| rows[row].errors.wrong == 0).collect();
    order.sort_by(|&a, &b| {
        let by_time = rows[a].ns_per_ray.total_cmp(&rows[b].ns_per_ray);
        by_time.then(error_of(&rows[a]).total_cmp(&error_of(&rows[b])))
    });
    let mut best = f64::INFINITY;
    order.retain(|&row| {
        let is_better = error_of(&rows[row]) < best;
        best = best.min(error_of(&rows[row]));
        is_better
    });
    order
}

/// How far below its middle a line of text stands.
const BASE: f64 = 0.13;

/// The times along the axis, and whether there is room for their names: those of powers of ten come first.
fn times(across: &Scale, [left, right]: [f64; 2]) -> Vec<(f64, Option<String>)> {
    /// As wide as a digit is, and between names.
    const DIGIT: f64 = 0.24;
    let mut named: Vec<[f64; 2]> = Vec::new();
    let steps = [1.0, 2.0, 5.0].into_iter().flat_map(|step| (-3..13).map(move |power| (step, power)));
    let times = steps.map(|(step, power)| step * 10f64.powi(power));
    let marks = times.map(|time| (across.place(time), time.to_string()));
    let within = marks.filter(|(x, _)| (left - 0.01..right + 0.01).contains(x));
    within
        .map(|(x, name)| {
            let half = 0.5 * DIGIT * (name.len() as f64 + 0.5);
            let is_free = named.iter().all(|[from, to]| x + half <= *from || x - half >= *to);
            (x, is_free.then(|| named.push([x - half, x + half])).map(|()| name))
        })
        .collect()
}

/// A place for a dot's number that neither a dot nor another number has: ways that are much alike lie on each other.
fn free_place([x, y]: [f64; 2], taken: &mut Vec<[f64; 2]>) -> [f64; 2] {
    /// As wide and high as two digits are.
    const SIZE: [f64; 2] = [0.5, 0.4];
    let around = [[0.0, 0.29], [0.0, -0.55], [0.55, -BASE], [-0.55, -BASE]];
    // Then farther over and under it: farther aside it would be another's.
    let farther = (1..=taken.len())
        .flat_map(|ring| [around[0], around[1]].map(|[dx, dy]| [dx, dy * (1.0 + ring as f64)]));
    let mut places = around.into_iter().chain(farther).map(|[dx, dy]| [x + dx, y + dy]);
    let is_free = |p: &[f64; 2]| {
        (FRAME[0][1]..FRAME[1][1]).contains(&p[1])
            && taken.iter().all(|q| (0..2).any(|i| (p[i] - q[i]).abs() >= SIZE[i]))
    };
    let place = places.find(is_free).unwrap_or([x, y]);
    taken.push(place);
    place
}

impl ErrorReport {
    /// Nanoseconds a ray against the root of the mean square of the backward error, both in powers of ten, for
    /// [`plan_svg`](crate::plan::plan_svg) and [`plan_png`](crate::plan::plan_png). Ways that are wrong anywhere are red; a line leads along the
    /// Pareto front of the others.
    pub fn chart(&self, title: &str) -> Drawing {
        let [[left, bottom], [right, top]] = FRAME;
        let across = Scale::powers(self.rows.iter().map(|row| row.ns_per_ray), [left, right]);
        let up = Scale::powers(self.rows.iter().map(error_of), [bottom, top]);
        let place = |row: &ErrorRow| [across.place(row.ns_per_ray), up.place(error_of(row))];
        let mut shapes =
            vec![text([left, top + 0.4], 0.5, Anchor::Start, format!("{title}: error against time"))];
        for (x, name) in times(&across, [left, right]) {
            shapes.push(lines(vec![vec![[x, bottom], [x, top]]], GREY, 0.02));
            shapes.extend(name.map(|name| text([x, bottom - 0.5], 0.4, Anchor::Middle, name)));
        }
        for (y, name) in up.marks() {
            shapes.push(lines(vec![vec![[left, y], [right, y]]], GREY, 0.02));
            shapes.push(text([left - 0.9, y - 0.1], 0.4, Anchor::Middle, name));
        }
        let middle = (left + right) / 2.0;
        shapes.push(text([middle, bottom - 1.1], 0.45, Anchor::Middle, "ns a ray".to_owned()));
        shapes.push(text([0.2, top + 0.4], 0.45, Anchor::Start, "error m".to_owned()));
        // Right and up from each of its ways to the next: what none of them dominates lies below.
        let mut path: Vec<[f64; 2]> = Vec::new();
        for place in front(&self.rows).into_iter().map(|row| place(&self.rows[row])) {
            path.extend(path.last().map(|last| [place[0], last[1]]));
            path.push(place);
        }
        if path.len() > 1 {
            shapes.push(lines(vec![path], FRONT, 0.05));
        }
        let dots = self.rows.iter().map(place);
        let mut labels: Vec<[f64; 2]> = dots.map(|[x, y]| [x, y - BASE]).collect();
        // As far apart as there is room.
        let step = ((top - bottom) / self.rows.len().max(1) as f64).min(0.62);
        for (number, row) in self.rows.iter().enumerate() {
            let (at, errors) = (place(row), &row.errors);
            let color = if errors.wrong == 0 { RIGHT } else { WRONG };
            let name = format!("{} {}", number + 1, row.kernel);
            let wrong = if errors.wrong == 0 { String::new() } else { format!(", {} wrong", errors.wrong) };
            shapes.push(dot(at, 0.14, color, name.clone()));
            let label = free_place(at, &mut labels);
            shapes.push(text(label, 0.4, Anchor::Middle, (number + 1).to_string()));
            let line = top - 0.3 - step * number as f64;
            shapes.push(dot([right + 0.4, line + 0.12], 0.12, color, String::new()));
            shapes.push(text([right + 0.7, line], 0.4, Anchor::Start, name + &wrong));
        }
        Drawing { bounds: [[0.0; 2], SHEET], shapes }
    }
}
