//! Time against error, drawn: each way a dot, and the front of those that no other is both faster and more accurate than.

use crate::plan::{Anchor, Color, Drawing, Shape};

use super::{ErrorReport, ErrorRow};

/// The sheet: width and height, and the frame within it. In the units of drawings, of which a sheet in print has a hundred to the metre.
const SHEET: [f64; 2] = [20.0, 11.0];
const FRAME: [[f64; 2]; 2] = [[2.2, 1.4], [13.2, 10.0]];

/// No error is drawn as less than this, metres.
const LEAST_ERROR: f64 = 1e-17;

const BLACK: Color = [20, 20, 20];
const GREY: Color = [215, 215, 215];
const FRONT: Color = [120, 120, 120];
const RIGHT: Color = [25, 95, 170];
const WRONG: Color = [200, 40, 40];

/// A scale of powers of ten.
struct Scale {
    /// The exponents at its ends, whole numbers.
    ends: [i32; 2],
    /// Where those are on the sheet.
    places: [f64; 2],
}

impl Scale {
    /// From the power of ten at or below the least of some numbers to that at or above the greatest.
    fn around(numbers: impl Iterator<Item = f64>, places: [f64; 2]) -> Scale {
        let [lo, hi] = numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], number| {
            let power = number.log10();
            [lo.min(power), hi.max(power)]
        });
        let [lo, hi] = if lo.is_finite() && hi.is_finite() { [lo.floor(), hi.ceil()] } else { [0.0, 1.0] };
        let (lo, hi) = (lo as i32, hi as i32);
        Scale { ends: [lo, hi.max(lo + 1)], places }
    }

    fn place(&self, number: f64) -> f64 {
        let [lo, hi] = self.ends.map(f64::from);
        let share = (number.log10() - lo) / (hi - lo);
        self.places[0] + share * (self.places[1] - self.places[0])
    }
}

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

fn text(at: [f64; 2], size: f64, anchor: Anchor, text: String) -> Shape {
    Shape::Text { at, size, anchor, color: BLACK, text }
}

fn lines(lines: Vec<Vec<[f64; 2]>>, color: Color, width: f64) -> Shape {
    Shape::Lines { lines, color, width }
}

/// A disc.
fn dot([x, y]: [f64; 2], radius: f64, fill: Color, title: String) -> Shape {
    let corners = (0..24).map(|i| f64::from(i) / 24.0 * std::f64::consts::TAU);
    let polygon = corners.map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()]).collect();
    Shape::Area { polygons: vec![polygon], fill, stroke: None, title }
}

impl ErrorReport {
    /// Nanoseconds a ray against the root of the mean square of the backward error, both in powers of ten, for
    /// [`plan_svg`](crate::plan::plan_svg) and [`plan_png`](crate::plan::plan_png). Ways that are wrong anywhere are red; a line leads along the
    /// Pareto front of the others.
    pub fn chart(&self, title: &str) -> Drawing {
        let [[left, bottom], [right, top]] = FRAME;
        let across = Scale::around(self.rows.iter().map(|row| row.ns_per_ray), [left, right]);
        let up = Scale::around(self.rows.iter().map(error_of), [bottom, top]);
        let place = |row: &ErrorRow| [across.place(row.ns_per_ray), up.place(error_of(row))];
        let mut shapes =
            vec![text([left, top + 0.4], 0.5, Anchor::Start, format!("{title}: error against time"))];
        for power in across.ends[0]..=across.ends[1] {
            for step in [1.0, 2.0, 5.0] {
                let time = step * 10f64.powi(power);
                let x = across.place(time);
                if x < right + 0.01 {
                    shapes.push(lines(vec![vec![[x, bottom], [x, top]]], GREY, 0.02));
                    shapes.push(text([x, bottom - 0.5], 0.4, Anchor::Middle, time.to_string()));
                }
            }
        }
        for power in up.ends[0]..=up.ends[1] {
            let y = up.place(10f64.powi(power));
            shapes.push(lines(vec![vec![[left, y], [right, y]]], GREY, 0.02));
            shapes.push(text([left - 0.9, y - 0.1], 0.4, Anchor::Middle, format!("1e{power}")));
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
        for (number, row) in self.rows.iter().enumerate() {
            let (at, errors) = (place(row), &row.errors);
            let color = if errors.wrong == 0 { RIGHT } else { WRONG };
            let name = format!("{} {}", number + 1, row.kernel);
            let wrong = if errors.wrong == 0 { String::new() } else { format!(", {} wrong", errors.wrong) };
            shapes.push(dot(at, 0.14, color, name.clone()));
            // Neighbours in the list, which are near each other here, too, above and below.
            let aside = if number % 2 == 0 { 0.2 } else { -0.45 };
            shapes.push(text([at[0], at[1] + aside], 0.4, Anchor::Middle, (number + 1).to_string()));
            let line = top - 0.3 - 0.62 * number as f64;
            shapes.push(dot([right + 0.4, line + 0.12], 0.12, color, String::new()));
            shapes.push(text([right + 0.7, line], 0.4, Anchor::Start, name + &wrong));
        }
        Drawing { bounds: [[0.0; 2], SHEET], shapes }
    }
}
